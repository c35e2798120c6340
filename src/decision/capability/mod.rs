#![doc = include_str!("method.md")]
//!
//! Called by `batch` with the ΔCD of its parts; judges no single part and reads no file.

mod normality;

pub use normality::Normality;

use thiserror::Error;

use super::Limit;
use super::statistics::{chi_square_quantile, normal_quantile};
use crate::quantity::Length;

/// Fewer parts give no indices: with ten the 95 % interval of Pp already reaches from 0.55 to 1.45 of its value.
pub const FEWEST_PARTS: usize = 10;

/// With fewer parts the indices are preliminary.
pub const PRELIMINARY_PARTS: usize = 50;

/// Confidence of all intervals.
pub const CONFIDENCE: f64 = 0.95;

/// An index with its confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Index {
    /// The estimate.
    pub value: f64,
    /// Lower end of its 95 % confidence interval.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
}

/// What the measuring uncertainty does to the indices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gauge {
    /// Its share of the observed variance, u² / s².
    pub variance_share: f64,
    /// 6 u / (U − L); `None` unless both limits are given.
    pub tolerance_share: Option<f64>,
    /// Standard deviation of the parts alone, √(s² − u²), mm; `None` if u exceeds s.
    pub part_deviation_mm: Option<f64>,
    /// Ppk of the parts alone; `None` without a part deviation above 0, or without limits.
    pub part_ppk: Option<f64>,
}

impl Gauge {
    /// Of values with a standard uncertainty and standard deviation, that are `margin_mm` within the nearer of limits
    /// `width_mm` apart.
    #[must_use]
    pub fn of(uncertainty_mm: f64, deviation_mm: f64, margin_mm: f64, width_mm: Option<f64>) -> Self {
        let parts_alone = deviation_mm * deviation_mm - uncertainty_mm * uncertainty_mm;
        let part_deviation_mm = (parts_alone >= 0.0).then(|| parts_alone.sqrt());
        let spreads = part_deviation_mm.filter(|deviation| *deviation > 0.0);
        Self {
            variance_share: (uncertainty_mm / deviation_mm) * (uncertainty_mm / deviation_mm),
            tolerance_share: width_mm.map(|width| 6.0 * uncertainty_mm / width),
            part_deviation_mm,
            part_ppk: spreads.filter(|_| margin_mm.is_finite()).map(|deviation| margin_mm / (3.0 * deviation)),
        }
    }
}

/// The capability of a batch.
#[derive(Debug, Clone, PartialEq)]
pub struct Capability {
    /// Number of parts.
    pub parts: usize,
    /// Parts per subgroup; 1 if the short-term deviation comes from moving ranges.
    pub subgroup: usize,
    /// Mean, mm.
    pub mean_mm: f64,
    /// Standard deviation of all parts s, mm.
    pub overall_deviation_mm: f64,
    /// Standard deviation of short duration σ̂_w, mm.
    pub within_deviation_mm: f64,
    /// Cp; `None` unless both limits are given.
    pub cp: Option<Index>,
    /// Cpk.
    pub cpk: Index,
    /// Pp; `None` unless both limits are given.
    pub pp: Option<Index>,
    /// Ppk.
    pub ppk: Index,
    /// The normality indication.
    pub normality: Normality,
    /// What the measuring uncertainty does; `None` if none is given.
    pub gauge: Option<Gauge>,
    /// Share of the parts outside the limits, as counted.
    pub outside: f64,
}

impl Capability {
    /// Remarks that the indices need: too few parts, no normal distribution, a coarse gauge.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        if self.parts < PRELIMINARY_PARTS {
            remarks.push(format!(
                "{} parts make the indices preliminary: {PRELIMINARY_PARTS} or more are customary",
                self.parts
            ));
        }
        if self.normality.rejected() {
            remarks.push(format!(
                "the values are not normally distributed (Anderson-Darling A*² {:.2}, p {:.2e}): the indices do not give the share outside",
                self.normality.anderson_darling, self.normality.p_value
            ));
        }
        if let Some(gauge) = &self.gauge {
            if gauge.part_deviation_mm.is_none() {
                remarks.push("the given uncertainty exceeds the spread of the values: it is overstated".to_owned());
            } else if gauge.variance_share > 0.1 {
                remarks.push(format!("{:.0} % of the variance is measuring uncertainty", 100.0 * gauge.variance_share));
            }
        }
        remarks
    }
}

/// Why a batch has no capability indices.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CapabilityError {
    /// Too few parts.
    #[error(
        "{parts} parts are too few for capability indices: at least {FEWEST_PARTS} are needed, {PRELIMINARY_PARTS} or more are customary"
    )]
    TooFewParts {
        /// How many there are.
        parts: usize,
    },
    /// All values are the same.
    #[error("all {parts} values are the same, so there is no spread to compare with the limits")]
    NoSpread {
        /// How many there are.
        parts: usize,
    },
    /// The limit has no end.
    #[error("the limit has neither a lower nor an upper end")]
    NoLimit,
    /// A value that is not finite.
    #[error("value {index} is not a finite number")]
    NotFinite {
        /// Which one, from 0.
        index: usize,
    },
    /// Subgroups that do not fit.
    #[error(
        "subgroups of {subgroup} parts do not fit {parts} parts: at least two whole subgroups of at least 2 are needed"
    )]
    Subgroup {
        /// Parts per subgroup.
        subgroup: usize,
        /// How many there are.
        parts: usize,
    },
}

/// The capability of `values_mm`, in the order of production, against `limit`.
///
/// `subgroup` parts at a time belong together; 1 (single parts) takes moving ranges. `uncertainty_mm` is the standard
/// uncertainty of a value, if it is known. An incomplete last subgroup counts for Pp and Ppk only.
///
/// # Errors
/// [`CapabilityError`] if there are fewer than [`FEWEST_PARTS`] values, they are all the same, or not finite, or the
/// limit or subgroups make no sense.
pub fn capability(
    values_mm: &[f64],
    limit: &Limit,
    subgroup: usize,
    uncertainty_mm: Option<f64>,
) -> Result<Capability, CapabilityError> {
    let parts = values_mm.len();
    if let Some(index) = values_mm.iter().position(|value| !value.is_finite()) {
        return Err(CapabilityError::NotFinite { index });
    }
    if parts < FEWEST_PARTS {
        return Err(CapabilityError::TooFewParts { parts });
    }
    if subgroup == 0 || parts / 2 < subgroup {
        return Err(CapabilityError::Subgroup { subgroup, parts });
    }
    let (lower, upper) = (limit.lower.as_ref().map(Length::mm), limit.upper.as_ref().map(Length::mm));
    if lower.is_none() && upper.is_none() {
        return Err(CapabilityError::NoLimit);
    }
    let n = count(parts);
    let mean = mean(values_mm);
    let overall = (sum_of_squares(values_mm, mean) / (n - 1.0)).sqrt();
    let (within, within_dof) = if subgroup == 1 { moving_range(values_mm) } else { pooled(values_mm, subgroup) };
    // a spread below the rounding of the values is none
    let rounding = 4.0 * f64::EPSILON * mean.abs();
    if overall <= rounding || within <= rounding {
        return Err(CapabilityError::NoSpread { parts });
    }
    let width = lower.zip(upper).map(|(lower, upper)| upper - lower);
    let margin =
        lower.map_or(f64::INFINITY, |lower| mean - lower).min(upper.map_or(f64::INFINITY, |upper| upper - mean));
    let outside = values_mm
        .iter()
        .filter(|value| lower.is_some_and(|lower| **value < lower) || upper.is_some_and(|upper| **value > upper))
        .count();
    let gauge = uncertainty_mm.map(|u| Gauge::of(u, overall, margin, width));
    Ok(Capability {
        parts,
        subgroup,
        mean_mm: mean,
        overall_deviation_mm: overall,
        within_deviation_mm: within,
        cp: width.map(|width| spread_index(width, within, within_dof)),
        cpk: margin_index(margin, within, n, within_dof),
        pp: width.map(|width| spread_index(width, overall, n - 1.0)),
        ppk: margin_index(margin, overall, n, n - 1.0),
        normality: Normality::of(values_mm, mean, overall),
        gauge,
        outside: count(outside) / n,
    })
}

/// An index of the spread and one of the margin, as far as the limits allow.
pub type Indices = (Option<Index>, Option<Index>);

/// Cp and Cpk of so many parts in the order of production of which the mean moving range is known; as [`performance`].
#[must_use]
pub fn short_term(
    parts: u64,
    mean_mm: f64,
    moving_range_mm: f64,
    lower_mm: Option<f64>,
    upper_mm: Option<f64>,
) -> Indices {
    let ranges = count(usize::try_from(parts).unwrap_or(usize::MAX)) - 1.0;
    let dof = if ranges >= 1.0 { moving_range_dof(ranges) } else { 1.0 };
    indices(parts, mean_mm, moving_range_mm / D2_SQUARED.sqrt(), dof, (lower_mm, upper_mm))
}

/// Pp and Ppk of so many parts of which mean and standard deviation are known, against limits in mm; for batches whose
/// values are not kept. The first is `None` unless both limits are given; both are with fewer than [`FEWEST_PARTS`]
/// parts, without limits, or without spread.
#[must_use]
pub fn performance(
    parts: u64,
    mean_mm: f64,
    deviation_mm: f64,
    lower_mm: Option<f64>,
    upper_mm: Option<f64>,
) -> Indices {
    let dof = count(usize::try_from(parts).unwrap_or(usize::MAX)) - 1.0;
    indices(parts, mean_mm, deviation_mm, dof, (lower_mm, upper_mm))
}

fn indices(
    parts: u64,
    mean_mm: f64,
    deviation_mm: f64,
    dof: f64,
    (lower_mm, upper_mm): (Option<f64>, Option<f64>),
) -> Indices {
    let n = count(usize::try_from(parts).unwrap_or(usize::MAX));
    let margin = lower_mm
        .map_or(f64::INFINITY, |lower| mean_mm - lower)
        .min(upper_mm.map_or(f64::INFINITY, |upper| upper - mean_mm));
    // a spread below the rounding of the values is none
    let spreads = deviation_mm > 4.0 * f64::EPSILON * mean_mm.abs();
    if parts < FEWEST_PARTS as u64 || margin.is_infinite() || !spreads {
        return (None, None);
    }
    let width = lower_mm.zip(upper_mm).map(|(lower, upper)| upper - lower);
    let spread = width.map(|width| spread_index(width, deviation_mm, dof));
    (spread, Some(margin_index(margin, deviation_mm, n, dof)))
}

#[allow(clippy::cast_precision_loss)] // far below 2⁵³ parts
fn count(parts: usize) -> f64 {
    parts as f64
}

fn mean(values: &[f64]) -> f64 {
    // about the first value, so that values far from 0 lose nothing
    let first = values[0];
    first + values.iter().map(|value| value - first).sum::<f64>() / count(values.len())
}

fn sum_of_squares(values: &[f64], mean: f64) -> f64 {
    values.iter().map(|value| (value - mean) * (value - mean)).sum()
}

/// The mean moving range over d_2, with the degrees of freedom of a standard deviation that varies as much.
///
/// Of independent normal values, moving ranges have the mean 2σ/√π and the variance (2 − 4/π) σ², neighbouring ones
/// the covariance (4/π)(√3/2 + π/12 − 1) σ²; Var(s)/σ² = 1/(2ν).
fn moving_range(values: &[f64]) -> (f64, f64) {
    let ranges = count(values.len() - 1);
    let mean_range = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>() / ranges;
    (mean_range / D2_SQUARED.sqrt(), moving_range_dof(ranges))
}

/// d_2² of ranges of two values.
const D2_SQUARED: f64 = 4.0 / std::f64::consts::PI;

fn moving_range_dof(ranges: f64) -> f64 {
    let variance = 2.0 - D2_SQUARED;
    let covariance = D2_SQUARED * (0.75_f64.sqrt() + std::f64::consts::PI / 12.0 - 1.0);
    let relative = (ranges * variance + 2.0 * (ranges - 1.0) * covariance) / (ranges * ranges * D2_SQUARED);
    0.5 / relative
}

fn pooled(values: &[f64], subgroup: usize) -> (f64, f64) {
    let groups = values.chunks_exact(subgroup);
    let dof = count(groups.len() * (subgroup - 1));
    let squares: f64 = groups.map(|group| sum_of_squares(group, mean(group))).sum();
    ((squares / dof).sqrt(), dof)
}

fn spread_index(width: f64, deviation: f64, dof: f64) -> Index {
    let value = width / (6.0 * deviation);
    let end = |p: f64| value * (chi_square_quantile(p, dof) / dof).sqrt();
    Index { value, lower: end(0.5 * (1.0 - CONFIDENCE)), upper: end(0.5 * (1.0 + CONFIDENCE)) }
}

fn margin_index(margin: f64, deviation: f64, n: f64, dof: f64) -> Index {
    let value = margin / (3.0 * deviation);
    let half = normal_quantile(0.5 * (1.0 + CONFIDENCE)) * (1.0 / (9.0 * n) + value * value / (2.0 * dof)).sqrt();
    Index { value, lower: value - half, upper: value + half }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(lower: &str, upper: &str) -> Limit {
        Limit { lower: Some(lower.parse().unwrap()), upper: Some(upper.parse().unwrap()) }
    }

    /// The quantiles of a normal distribution at (i − 1/2)/n, in an order without trend.
    fn normal_values(n: usize, mean: f64, deviation: f64) -> Vec<f64> {
        (0..n)
            .map(|i| {
                let shuffled = (i * 37) % n;
                mean + deviation * normal_quantile((count(shuffled) + 0.5) / count(n))
            })
            .collect()
    }

    #[test]
    fn indices_by_hand() {
        // x̄ = 0, Σ x² = 50 × 1 µm²: s = √(50/49) µm; every moving range is 2 µm
        let values: Vec<f64> = (0..50).map(|i| if i % 2 == 0 { 0.001 } else { -0.001 }).collect();
        let result = capability(&values, &limit("-0.006", "0.004"), 1, None).unwrap();
        let s = 0.001 * (50.0_f64 / 49.0).sqrt();
        assert!((result.overall_deviation_mm - s).abs() < 1e-15);
        assert!((result.pp.unwrap().value - 0.010 / (6.0 * s)).abs() < 1e-12);
        assert!((result.ppk.value - 0.004 / (3.0 * s)).abs() < 1e-12);
        let within = 0.002 / (2.0 / std::f64::consts::PI.sqrt());
        assert!((result.cp.unwrap().value - 0.010 / (6.0 * within)).abs() < 1e-12);
        assert!((result.cpk.value - 0.004 / (3.0 * within)).abs() < 1e-12);
        assert!(result.normality.rejected(), "two values only are no normal distribution");
        assert_eq!(result.outside, 0.0);
    }

    #[test]
    fn a_gauge_that_explains_all_of_the_spread_leaves_no_capability_of_the_parts() {
        let gauge = Gauge::of(0.002, 0.002, 0.01, None);
        assert_eq!((gauge.part_deviation_mm, gauge.part_ppk, gauge.variance_share), (Some(0.0), None, 1.0));
        assert_eq!(Gauge::of(0.003, 0.002, 0.01, None).part_deviation_mm, None);
    }

    #[test]
    fn indices_without_the_values_are_those_with_them() {
        let values = normal_values(200, 0.003, 0.01);
        let whole = capability(&values, &limit("-0.04", "0.05"), 1, None).unwrap();
        let (pp, ppk) = performance(200, whole.mean_mm, whole.overall_deviation_mm, Some(-0.04), Some(0.05));
        assert_eq!((pp, ppk), (whole.pp, Some(whole.ppk)));
        assert_eq!(performance(9, 0.0, 0.01, None, Some(0.05)), (None, None));
        assert_eq!(performance(90, 0.01, 0.0, None, Some(0.05)), (None, None));
        let (pp, ppk) = performance(1_000_000_000, 0.01, 0.01, None, Some(0.05));
        assert_eq!(pp, None);
        let ppk = ppk.unwrap();
        assert!(ppk.lower < ppk.value && ppk.upper - ppk.lower < 1e-3, "{ppk:?}");
    }

    #[test]
    fn subgroups_pool_their_deviations() {
        // two levels, each subgroup of 2 has the deviation √2/2 · 2 µm = √2 µm about its own mean
        let values: Vec<f64> = (0..20).map(|i| f64::from(i / 10) * 0.1 + f64::from(i % 2) * 0.002).collect();
        let result = capability(&values, &limit("-1", "1"), 2, None).unwrap();
        assert!((result.within_deviation_mm - 0.002 / 2.0_f64.sqrt()).abs() < 1e-15);
        assert!(result.overall_deviation_mm > 0.05);
        assert_eq!(
            capability(&values, &limit("-1", "1"), 11, None),
            Err(CapabilityError::Subgroup { subgroup: 11, parts: 20 })
        );
    }

    /// Two subgroups are enough, three parts each leave two degrees of freedom each.
    #[test]
    fn the_fewest_subgroups_and_larger_ones() {
        let values: Vec<f64> = (0..12).map(|i| f64::from(i % 3) * 0.002).collect();
        for subgroup in [3, 6] {
            let result = capability(&values, &limit("-1", "1"), subgroup, None).unwrap();
            // each three consecutive parts have the squares 4 + 0 + 4 µm²
            let within = if subgroup == 3 { 4.0 * 8e-6 / 8.0 } else { 2.0 * 16e-6 / 10.0 };
            assert!((result.within_deviation_mm - f64::sqrt(within)).abs() < 1e-15, "{subgroup}");
        }
        let no_fit = capability(&values, &limit("-1", "1"), usize::MAX, None);
        assert_eq!(no_fit, Err(CapabilityError::Subgroup { subgroup: usize::MAX, parts: 12 }));
        // no spread within the subgroups is none, though they differ
        let levels: Vec<f64> = (0..12).map(|i| f64::from(i / 6)).collect();
        let no_spread = capability(&levels, &limit("-1", "2"), 6, None);
        assert_eq!(no_spread, Err(CapabilityError::NoSpread { parts: 12 }));
    }

    /// A value on a limit is inside it.
    #[test]
    fn the_share_outside_is_counted() {
        let mut values = vec![0.0; 20];
        values[..6].copy_from_slice(&[-1.0, 1.0, -1.5, -1.25, 1.25, 2.0]);
        assert_eq!(capability(&values, &limit("-1", "1"), 1, None).unwrap().outside, 4.0 / 20.0);
        let upper = Limit { lower: None, upper: Some("1".parse().unwrap()) };
        assert_eq!(capability(&values, &upper, 1, None).unwrap().outside, 2.0 / 20.0);
    }

    /// Spread far from zero is spread: squares of the values themselves would have lost it.
    #[test]
    fn values_far_from_zero_lose_nothing() {
        let far = normal_values(200, 1e6, 1e-3);
        let near: Vec<f64> = far.iter().map(|value| value - 1e6).collect();
        let deviation =
            |values: &[f64]| capability(values, &limit("-2e6", "2e6"), 1, None).unwrap().overall_deviation_mm;
        assert!((deviation(&far) / deviation(&near) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn indices_start_at_ten_parts_and_above_the_rounding() {
        let ten = normal_values(10, 0.0, 1.0);
        assert!(capability(&ten, &limit("-5", "5"), 1, None).is_ok());
        assert!(performance(10, 0.0, 1.0, None, Some(5.0)).1.is_some());
        // values near 4 are rounded by as much as this
        let rounding = 16.0 * f64::EPSILON;
        assert_eq!(performance(10, 4.0, rounding, None, Some(5.0)), (None, None));
        assert!(performance(10, 4.0, rounding.next_up(), None, Some(5.0)).1.is_some());
    }

    #[test]
    fn remarks_that_the_indices_need() {
        let of = |parts, u| capability(&normal_values(parts, 0.0, 0.01), &limit("-0.05", "0.05"), 1, Some(u)).unwrap();
        assert_eq!(of(50, 0.001).remarks(), Vec::<String>::new());
        assert!(of(49, 0.001).remarks()[0].starts_with("49 parts make the indices preliminary"));
        // 0.4² of the variance, and exactly a tenth, which is still usual
        assert_eq!(of(400, 0.004).remarks(), ["16 % of the variance is measuring uncertainty"]);
        let mut tenth = of(400, 0.001);
        tenth.gauge = tenth.gauge.map(|gauge| Gauge { variance_share: 0.1, ..gauge });
        assert_eq!(tenth.remarks(), Vec::<String>::new());
    }

    #[test]
    fn a_gauge_that_explains_everything_leaves_no_spread_of_the_parts() {
        let gauge = Gauge::of(0.003, 0.003, 0.05, Some(0.1));
        assert_eq!((gauge.part_deviation_mm, gauge.part_ppk), (Some(0.0), None));
    }

    #[test]
    fn the_interval_of_pp_is_that_of_chi_square() {
        let values = normal_values(30, 0.0, 0.01);
        let result = capability(&values, &limit("-0.05", "0.05"), 1, None).unwrap();
        let pp = result.pp.unwrap();
        // χ²(29): 16.047 and 45.722
        assert!((pp.lower / pp.value - (16.047_f64 / 29.0).sqrt()).abs() < 1e-4);
        assert!((pp.upper / pp.value - (45.722_f64 / 29.0).sqrt()).abs() < 1e-4);
        assert!(result.cp.unwrap().lower < result.cp.unwrap().value);
    }

    #[test]
    fn one_sided_limits_have_no_spread_index() {
        let values = normal_values(60, 0.01, 0.002);
        let upper = Limit { lower: None, upper: Some("0.016".parse().unwrap()) };
        let result = capability(&values, &upper, 1, None).unwrap();
        assert!(result.pp.is_none() && result.cp.is_none());
        assert!((result.ppk.value - 0.006 / (3.0 * result.overall_deviation_mm)).abs() < 1e-9);
        assert_eq!(capability(&values, &Limit::default(), 1, None), Err(CapabilityError::NoLimit));
    }

    #[test]
    fn normal_values_look_normal_and_others_do_not() {
        assert!(!capability(&normal_values(200, 0.0, 1.0), &limit("-5", "5"), 1, None).unwrap().normality.rejected());
        let skewed: Vec<f64> = normal_values(200, 0.0, 1.0).iter().map(|x| libm::exp(*x)).collect();
        let normality = capability(&skewed, &limit("-5", "5"), 1, None).unwrap().normality;
        assert!(normality.rejected() && normality.skewness > 1.0);
    }

    #[test]
    fn the_gauge_share_is_a_share_of_the_variance() {
        let values = normal_values(100, 0.0, 0.01);
        let result = capability(&values, &limit("-0.05", "0.05"), 1, Some(0.003)).unwrap();
        let s = result.overall_deviation_mm;
        let gauge = result.gauge.unwrap();
        assert!((gauge.variance_share - 9e-6 / (s * s)).abs() < 1e-12);
        assert!((gauge.tolerance_share.unwrap() - 0.18).abs() < 1e-12);
        assert!(gauge.part_ppk.unwrap() > result.ppk.value);
        let coarse = capability(&values, &limit("-0.05", "0.05"), 1, Some(0.02)).unwrap();
        assert_eq!(coarse.gauge.unwrap().part_deviation_mm, None);
        assert!(coarse.remarks().iter().any(|remark| remark.contains("overstated")));
    }

    #[test]
    fn what_has_no_capability_says_why() {
        let limit = limit("-1", "1");
        assert_eq!(capability(&[0.0; 9], &limit, 1, None), Err(CapabilityError::TooFewParts { parts: 9 }));
        assert_eq!(capability(&[0.1; 30], &limit, 1, None), Err(CapabilityError::NoSpread { parts: 30 }));
        let mut values = normal_values(30, 0.0, 1.0);
        values[7] = f64::NAN;
        assert_eq!(capability(&values, &limit, 1, None), Err(CapabilityError::NotFinite { index: 7 }));
    }
}
