//! The summary of many racks: how each quantity of their curves is distributed, and how many keep a limit.

use super::counts::{Bin, Counts};
use super::quantiles::quantiles;
use super::range::RackRange;
use super::study::RacksStudy;
use super::yoke::{N, YokeStudy};
use super::{CONFIDENCE, Quantile, share};
use crate::function::{Setting, Shared, Target};
use crate::judge::Verdict;
use crate::quantity::{of_femtometres, tidy};

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
    /// The figures of a yoke on the racks, if there is one.
    pub yoke: Option<YokeSummary>,
    /// Fail if a rack leaves the limits; `None` without limits, and where no rack fails but some are missing or not judged.
    pub verdict: Option<Verdict>,
    /// The racks that were asked for and are not there.
    pub missing: Vec<RackRange>,
}

/// The figures of a yoke, over all racks.
#[derive(Debug, Clone, PartialEq)]
pub struct YokeSummary {
    /// Racks with known settings that keep the window.
    pub racks: u64,
    /// The racks among them that no setting suits; `None` if there are no such racks.
    pub without: Option<Inside>,
    /// The settings that suit the most racks.
    pub shared: Option<SharedPlug>,
    /// Of the fluctuation of the pinion's torque, in N m where its fields say mm.
    pub fluctuation: Option<RackStatistics>,
    /// Of the least lift-off force, in N where its fields say mm.
    pub lift_off: Option<RackStatistics>,
    /// Racks that were judged by each limit, in the order of [`Target::ALL`].
    pub judged: [u64; Target::ALL.len()],
    /// The racks that keep each limit, of those; `None` if none was judged by it.
    pub limits: [Option<Inside>; Target::ALL.len()],
}

/// One plug for all racks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharedPlug {
    /// The settings that suit the most racks.
    pub setting: Shared,
    /// The number of these racks. The interval holds for a setting at this place, whatever racks it was found by.
    pub suits: Inside,
    /// Where the setting that suits the most of all such racks is, with 95 % confidence; `None` if so few racks do not tell.
    ///
    /// Let F_a and F_b be the shares of racks whose settings start below, and end below, a place: the place suits the share
    /// F_a − F_b. Both are known to ε = √(ln(4/0.05) / 2n) everywhere (Dvoretzky, Kiefer and Wolfowitz, with Massart's constant),
    /// so the best place suits a share of these racks that is at most 4 ε below the largest one.
    pub confidence: Option<Setting>,
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
        let inside = study.inside.map(|inside| Inside::of(inside, racks));
        let yokes = study.yoke.iter().flat_map(YokeStudy::judged).map(|(kept, broken)| (kept, kept + broken));
        let judged: Vec<_> = study.inside.map(|inside| (inside, racks)).into_iter().chain(yokes).collect();
        let verdict = if judged.iter().any(|(kept, of)| kept < of) {
            Some(Verdict::Fail)
        } else if !judged.is_empty() && judged.iter().all(|(kept, _)| *kept == racks) && missing.is_empty() {
            Some(Verdict::Pass)
        } else {
            None
        };
        Some(Self {
            mean: RackStatistics::of(&study.mean),
            peak_to_peak: RackStatistics::of(&study.peak_to_peak),
            smallest: RackStatistics::of(&study.smallest),
            largest: RackStatistics::of(&study.largest),
            inside,
            yoke: study.yoke.as_ref().map(YokeSummary::of),
            verdict,
            missing,
        })
    }

    /// The verdict on ΔCD alone.
    #[must_use]
    pub fn on_delta_cd(&self) -> Option<Verdict> {
        let is_inside = self.inside?.share >= 1.0;
        if is_inside { self.missing.is_empty().then_some(Verdict::Pass) } else { Some(Verdict::Fail) }
    }
}

impl Inside {
    fn of(racks: u64, all: u64) -> Self {
        let (share, lower, upper) = share(racks, all);
        Self { racks, share, lower, upper }
    }
}

impl YokeSummary {
    fn of(study: &YokeStudy) -> Self {
        let known = study.known();
        let any = |counts: &Counts| (counts.racks() > 0).then(|| RackStatistics::of(counts));
        Self {
            racks: known,
            without: (known > 0).then(|| Inside::of(study.without, known)),
            shared: study.shared().map(|setting| SharedPlug::of(study, setting)),
            fluctuation: any(&study.fluctuation),
            lift_off: any(&study.lift_off).map(|of| of.times(N)),
            judged: study.by_limit().map(|(kept, broken)| kept + broken),
            limits: study.by_limit().map(|(kept, broken)| (kept + broken > 0).then(|| Inside::of(kept, kept + broken))),
        }
    }
}

impl SharedPlug {
    fn of(study: &YokeStudy, setting: Shared) -> Self {
        let known = study.known() as f64;
        let known_to = (libm::log(4.0 / (1.0 - CONFIDENCE)) / (2.0 * known)).sqrt();
        let least = (setting.parts as f64 - 4.0 * known_to * known).ceil();
        let confidence = if least >= 1.0 { study.shared_by(least as u64) } else { None };
        Self { setting, suits: Inside::of(setting.parts, study.known()), confidence }
    }
}

impl RackStatistics {
    /// In another unit.
    fn times(mut self, factor: f64) -> Self {
        let quantiles = self.quantiles.iter_mut().flat_map(|of| {
            let ends = of.lower_mm.iter_mut().chain(&mut of.upper_mm);
            std::iter::once(&mut of.value_mm).chain(ends)
        });
        let bins = self.histogram.iter_mut().flat_map(|bin| [&mut bin.from_mm, &mut bin.to_mm]);
        let moments = [&mut self.mean_mm, &mut self.quantile_error_mm];
        let all = moments.into_iter().chain(&mut self.standard_deviation_mm).chain(quantiles).chain(bins);
        all.for_each(|value| *value = tidy(*value * factor));
        self
    }

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
