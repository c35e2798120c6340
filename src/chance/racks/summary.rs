//! What many racks came to: how each quantity of their curves is distributed, and how many keep a limit.

use super::counts::{Bin, Counts};
use super::quantiles::quantiles;
use super::range::RackRange;
use super::study::RacksStudy;
use super::{Quantile, share};
use crate::judge::Verdict;
use crate::quantity::of_femtometres;

/// The shares whose quantiles are computed.
const SHARES: [f64; 7] = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99];
/// Bins of a histogram.
const BINS: u32 = 20;

/// ΔCD along the stroke, over all racks.
#[derive(Debug, Clone, PartialEq)]
pub struct RacksSummary {
    /// Of the mean along the stroke.
    pub mean: RackStatistics,
    /// Of the largest less the smallest ΔCD.
    pub peak_to_peak: RackStatistics,
    /// Of the smallest ΔCD.
    pub smallest: RackStatistics,
    /// Of the largest ΔCD.
    pub largest: RackStatistics,
    /// The racks that stay within the limits along the whole stroke; `None` without limits.
    pub inside: Option<Inside>,
    /// Fail if any rack leaves the limits, `None` without limits, and where racks are missing and none of the others
    /// fails.
    pub verdict: Option<Verdict>,
    /// The racks that were asked for and are not there.
    pub missing: Vec<RackRange>,
}

/// How one quantity is distributed over the racks.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct RackStatistics {
    /// The mean, mm.
    pub mean_mm: f64,
    /// The standard deviation, mm; `None` of a single rack.
    pub standard_deviation_mm: Option<f64>,
    /// How far a quantile may be off, mm: half the width of the bins that lengths are counted in; 0 where quantiles are
    /// exact.
    pub quantile_error_mm: f64,
    /// Quantiles of some shares, mm.
    pub quantiles: Vec<Quantile>,
    /// Bins of the same width from the smallest to the largest value.
    pub histogram: Vec<Bin>,
}

/// A count of racks and the share of all that it stands for, with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Inside {
    /// The count.
    pub racks: u64,
    /// The share.
    pub share: f64,
    /// Lower end of its confidence interval.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
}

impl RacksSummary {
    /// Of a study; `None` if it has no racks.
    #[must_use]
    pub fn of(study: &RacksStudy) -> Option<Self> {
        let racks = study.racks();
        if racks == 0 {
            return None;
        }
        let missing = study.missing();
        let inside = study.inside.map(|inside| {
            let (share, lower, upper) = share(inside, racks);
            Inside { racks: inside, share, lower, upper }
        });
        let verdict = match inside {
            Some(inside) if inside.racks < racks => Some(Verdict::Fail),
            Some(_) if missing.is_empty() => Some(Verdict::Pass),
            _ => None,
        };
        Some(Self {
            mean: RackStatistics::of(&study.mean),
            peak_to_peak: RackStatistics::of(&study.peak_to_peak),
            smallest: RackStatistics::of(&study.smallest),
            largest: RackStatistics::of(&study.largest),
            inside,
            verdict,
            missing,
        })
    }
}

impl RackStatistics {
    fn of(counts: &Counts) -> Self {
        let moments = counts.moments();
        Self {
            mean_mm: moments.mean_fm().map_or(f64::NAN, of_femtometres),
            standard_deviation_mm: moments.standard_deviation_fm().map(of_femtometres),
            quantile_error_mm: counts.quantile_error_mm(),
            quantiles: quantiles(counts, &SHARES),
            histogram: counts.histogram(BINS),
        }
    }
}
