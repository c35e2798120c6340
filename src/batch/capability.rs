//! The spread of one result of a batch, compared with its limits.

use super::Statistics;
use crate::statistics::capability::{Gauge, Index, Indices, Normality, performance, short_term};

/// Indices, normality and the share of measuring, as far as values and limits allow.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Capability {
    /// The spread of successive parts.
    pub cp: Option<Index>,
    /// Their margin.
    pub cpk: Option<Index>,
    /// The spread of all parts.
    pub pp: Option<Index>,
    /// Their margin.
    pub ppk: Option<Index>,
    /// Whether values that have limits are normally distributed.
    pub normality: Option<Normality>,
    /// The share of measuring in the spread, where uncertainties are given.
    pub gauge: Option<Gauge>,
}

impl Capability {
    /// The capability of values against a lower and an upper limit, mm; the quantity has these limits in all.
    #[must_use]
    pub fn of(
        statistics: &Statistics,
        (lower_mm, upper_mm): (Option<f64>, Option<f64>),
        whole_mm: (Option<f64>, Option<f64>),
    ) -> Self {
        let count = statistics.count();
        let (mean, deviation) = (statistics.mean_mm(), statistics.standard_deviation_mm());
        let indices = |spread: Option<f64>, of: fn(u64, f64, f64, Option<f64>, Option<f64>) -> Indices| {
            mean.zip(spread).map_or((None, None), |(mean, spread)| of(count, mean, spread, lower_mm, upper_mm))
        };
        let (pp, ppk) = indices(deviation, performance);
        let (cp, cpk) = indices(statistics.moving_range_mm(), short_term);
        let gauge = mean.zip(deviation).zip(statistics.gauge_mm()).filter(|((_, s), _)| *s > 0.0);
        let gauge = gauge.map(|((mean, deviation), uncertainty)| {
            let margins = [lower_mm.map(|lower| mean - lower), upper_mm.map(|upper| upper - mean)];
            let margin = margins.into_iter().flatten().fold(f64::INFINITY, f64::min);
            Gauge::of(uncertainty, deviation, margin, whole_mm.0.zip(whole_mm.1).map(|(lower, upper)| upper - lower))
        });
        let is_limited = lower_mm.is_some() || upper_mm.is_some();
        Self { cp, cpk, pp, ppk, normality: if is_limited { statistics.normality() } else { None }, gauge }
    }
}
