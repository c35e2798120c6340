//! What many racks came to: how each quantity of their curves is distributed, and how many keep a limit.

use super::{Quantile, RackResult, quantiles, share};
use crate::judge::{Limit, Verdict};
use crate::quantity::{Length, tidy};

/// The shares whose quantiles are computed.
const SHARES: [f64; 7] = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99];
/// Bins of a histogram.
const BINS: usize = 20;

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
    /// Whether the run ended before the last rack.
    pub is_interrupted: bool,
}

/// How one quantity is distributed over the racks.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct RackStatistics {
    /// The mean, mm.
    pub mean_mm: f64,
    /// The standard deviation, mm.
    pub standard_deviation_mm: f64,
    /// Quantiles of some shares, mm.
    pub quantiles: Vec<Quantile>,
    /// Bins of the same width from the smallest to the largest value.
    pub histogram: Vec<Bin>,
}

/// A bin of a histogram.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Bin {
    /// Where it starts, mm.
    pub from_mm: f64,
    /// Where it ends, mm.
    pub to_mm: f64,
    /// How many racks are in it.
    pub racks: usize,
}

/// A count of racks and the share of all that it stands for, with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Inside {
    /// The count.
    pub racks: usize,
    /// The share.
    pub share: f64,
    /// Lower end of its confidence interval.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
}

impl RacksSummary {
    /// Of the racks that were solved of those `asked` for, held against a limit if there is one.
    #[must_use]
    pub fn of(results: &[RackResult], asked: usize, limit: Option<&Limit>) -> Self {
        let statistics = |of: fn(&RackResult) -> f64| RackStatistics::of(&results.iter().map(of).collect::<Vec<_>>());
        let is_interrupted = results.len() < asked;
        let inside = limit.map(|limit| {
            let racks = results.iter().filter(|result| result.is_inside(limit)).count();
            let (share, lower, upper) = share(racks, results.len());
            Inside { racks, share, lower, upper }
        });
        let verdict = match inside {
            Some(inside) if inside.racks < results.len() => Some(Verdict::Fail),
            Some(_) if !is_interrupted => Some(Verdict::Pass),
            _ => None,
        };
        Self {
            mean: statistics(|result| result.mean_mm),
            peak_to_peak: statistics(RackResult::peak_to_peak_mm),
            smallest: statistics(|result| result.min_mm),
            largest: statistics(|result| result.max_mm),
            inside,
            verdict,
            is_interrupted,
        }
    }
}

impl RackResult {
    /// Whether it stays within the limits along the whole stroke.
    fn is_inside(&self, limit: &Limit) -> bool {
        limit.lower.map(Length::mm).is_none_or(|lower| lower <= tidy(self.min_mm))
            && limit.upper.map(Length::mm).is_none_or(|upper| tidy(self.max_mm) <= upper)
    }
}

impl RackStatistics {
    fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean_mm = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|value| (value - mean_mm) * (value - mean_mm)).sum();
        Self {
            mean_mm,
            standard_deviation_mm: (squares / (n - 1.0).max(1.0)).sqrt(),
            quantiles: quantiles(values, &SHARES),
            histogram: histogram(values),
        }
    }
}

fn histogram(values: &[f64]) -> Vec<Bin> {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let width = (high - low) / BINS as f64;
    if width.is_nan() || width <= 0.0 {
        return vec![Bin { from_mm: tidy(low), to_mm: tidy(high), racks: values.len() }];
    }
    let edge = |bin: usize| tidy(low + width * bin as f64);
    let mut bins: Vec<_> = (0..BINS).map(|bin| Bin { from_mm: edge(bin), to_mm: edge(bin + 1), racks: 0 }).collect();
    for value in values {
        bins[(((value - low) / width) as usize).min(BINS - 1)].racks += 1;
    }
    bins
}
