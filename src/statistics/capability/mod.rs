#![doc = include_str!("method.md")]
//!
//! Called by `batch` with the ΔCD of its parts; judges no single part and reads no file.

mod normality;

pub use normality::Normality;

use super::{chi_square_quantile, normal_quantile};

/// Fewer parts give no indices: with ten the 95 % interval of Pp already reaches from 0.55 to 1.45 of its value.
pub const FEWEST_PARTS: usize = 10;

/// With fewer parts the indices are preliminary.
pub const PRELIMINARY_PARTS: usize = 50;

/// Confidence of all intervals.
pub const CONFIDENCE: f64 = 0.95;

/// An index with its confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Index {
    /// The estimate.
    pub value: f64,
    /// Lower end of its 95 % confidence interval.
    #[cfg_attr(feature = "report", serde(rename = "lower_95"))]
    pub lower: f64,
    /// Upper end.
    #[cfg_attr(feature = "report", serde(rename = "upper_95"))]
    pub upper: f64,
}

/// What the measuring uncertainty does to the indices.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Gauge {
    /// The standard uncertainty u of a value from measuring, mm.
    #[cfg_attr(feature = "report", serde(rename = "standard_uncertainty_mm"))]
    pub uncertainty_mm: f64,
    /// Its share of the observed variance, u² / s².
    pub variance_share: f64,
    /// 6 u / (U − L); `None` unless both limits are given.
    pub tolerance_share: Option<f64>,
    /// Standard deviation of the parts alone, √(s² − u²), mm; `None` if u exceeds s.
    #[cfg_attr(feature = "report", serde(rename = "part_standard_deviation_mm"))]
    pub part_deviation_mm: Option<f64>,
    /// Ppk of the parts alone; `None` without a part deviation above 0, or without limits.
    pub part_ppk: Option<f64>,
}

impl Gauge {
    /// From the standard uncertainty and the standard deviation of values whose mean is `margin_mm` inside the nearer limit. The
    /// limits are `width_mm` apart.
    #[must_use]
    pub fn of(uncertainty_mm: f64, deviation_mm: f64, margin_mm: f64, width_mm: Option<f64>) -> Self {
        let parts_alone = deviation_mm * deviation_mm - uncertainty_mm * uncertainty_mm;
        let part_deviation_mm = (parts_alone >= 0.0).then(|| parts_alone.sqrt());
        let spreads = part_deviation_mm.filter(|deviation| *deviation > 0.0);
        Self {
            uncertainty_mm,
            variance_share: (uncertainty_mm / deviation_mm) * (uncertainty_mm / deviation_mm),
            tolerance_share: width_mm.map(|width| 6.0 * uncertainty_mm / width),
            part_deviation_mm,
            part_ppk: spreads.filter(|_| margin_mm.is_finite()).map(|deviation| margin_mm / (3.0 * deviation)),
        }
    }
}

/// An index of the spread and one of the margin, as far as the limits allow.
pub type Indices = (Option<Index>, Option<Index>);

/// Cp and Cpk of so many parts in the order of production, from their mean moving range. `None` as for [`performance`].
#[must_use]
pub fn short_term(
    parts: u64,
    mean_mm: f64,
    moving_range_mm: f64,
    lower_mm: Option<f64>,
    upper_mm: Option<f64>,
) -> Indices {
    let ranges = parts as f64 - 1.0;
    let dof = if ranges >= 1.0 { moving_range_dof(ranges) } else { 1.0 };
    indices(parts, mean_mm, moving_range_mm / D2_SQUARED.sqrt(), dof, (lower_mm, upper_mm))
}

/// Pp and Ppk of so many parts, from their mean and standard deviation and limits in mm. The values themselves are not needed. Pp is
/// `None` unless both limits are given; both are with fewer than [`FEWEST_PARTS`] parts, without limits, or without spread.
#[must_use]
pub fn performance(
    parts: u64,
    mean_mm: f64,
    deviation_mm: f64,
    lower_mm: Option<f64>,
    upper_mm: Option<f64>,
) -> Indices {
    indices(parts, mean_mm, deviation_mm, parts as f64 - 1.0, (lower_mm, upper_mm))
}

fn indices(
    parts: u64,
    mean_mm: f64,
    deviation_mm: f64,
    dof: f64,
    (lower_mm, upper_mm): (Option<f64>, Option<f64>),
) -> Indices {
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
    (spread, Some(margin_index(margin, deviation_mm, parts as f64, dof)))
}

/// d_2² of ranges of two values.
const D2_SQUARED: f64 = 4.0 / std::f64::consts::PI;

/// The degrees of freedom of a standard deviation that varies as much as the mean of so many moving ranges over d_2.
///
/// Of independent normal values, moving ranges have the mean 2σ/√π and the variance (2 − 4/π) σ², neighbouring ones
/// the covariance (4/π)(√3/2 + π/12 − 1) σ²; Var(s)/σ² = 1/(2ν).
fn moving_range_dof(ranges: f64) -> f64 {
    let variance = 2.0 - D2_SQUARED;
    let covariance = D2_SQUARED * (0.75_f64.sqrt() + std::f64::consts::PI / 12.0 - 1.0);
    let relative = (ranges * variance + 2.0 * (ranges - 1.0) * covariance) / (ranges * ranges * D2_SQUARED);
    0.5 / relative
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

    #[test]
    fn indices_by_hand() {
        // fifty parts at ±1 µm in turn: s = √(50/49) µm, and every moving range is 2 µm
        let s = 0.001 * (50.0_f64 / 49.0).sqrt();
        let (pp, ppk) = performance(50, 0.0, s, Some(-0.006), Some(0.004));
        assert!((pp.unwrap().value - 0.010 / (6.0 * s)).abs() < 1e-12);
        assert!((ppk.unwrap().value - 0.004 / (3.0 * s)).abs() < 1e-12);
        let within = 0.002 / (2.0 / std::f64::consts::PI.sqrt());
        let (cp, cpk) = short_term(50, 0.0, 0.002, Some(-0.006), Some(0.004));
        assert!((cp.unwrap().value - 0.010 / (6.0 * within)).abs() < 1e-12);
        assert!((cpk.unwrap().value - 0.004 / (3.0 * within)).abs() < 1e-12);
        assert!(cp.unwrap().lower < cp.unwrap().value && cp.unwrap().value < cp.unwrap().upper);
    }

    #[test]
    fn indices_start_at_ten_parts_and_above_the_rounding() {
        assert_eq!(performance(9, 0.0, 0.01, None, Some(0.05)), (None, None));
        assert!(performance(10, 0.0, 0.01, None, Some(0.05)).1.is_some());
        assert_eq!(performance(90, 0.01, 0.0, None, Some(0.05)), (None, None));
        assert_eq!(performance(90, 0.01, 0.01, None, None), (None, None));
        assert_eq!(
            (short_term(0, 0.0, 0.01, None, Some(0.05)), short_term(1, 0.0, 0.01, None, None)),
            Default::default()
        );
        // values near 4 are rounded by as much as this
        let rounding = 16.0 * f64::EPSILON;
        assert_eq!(performance(10, 4.0, rounding, None, Some(5.0)), (None, None));
        assert!(performance(10, 4.0, rounding.next_up(), None, Some(5.0)).1.is_some());
    }

    #[test]
    fn one_sided_limits_have_no_spread_index() {
        for (lower, upper) in [(None, Some(0.016)), (Some(0.004), None)] {
            let (pp, ppk) = performance(60, 0.01, 0.002, lower, upper);
            assert_eq!(pp, None);
            assert!((ppk.unwrap().value - 1.0).abs() < 1e-12);
        }
        let ppk = performance(1_000_000_000, 0.01, 0.01, None, Some(0.05)).1.unwrap();
        assert!(ppk.lower < ppk.value && ppk.upper - ppk.lower < 1e-3, "{ppk:?}");
    }

    #[test]
    fn the_interval_of_pp_is_that_of_chi_square() {
        let pp = performance(30, 0.0, 0.01, Some(-0.05), Some(0.05)).0.unwrap();
        // χ²(29): 16.047 and 45.722
        assert!((pp.lower / pp.value - (16.047_f64 / 29.0).sqrt()).abs() < 1e-4);
        assert!((pp.upper / pp.value - (45.722_f64 / 29.0).sqrt()).abs() < 1e-4);
    }

    /// One range is half-normal, with the relative variance π/2 − 1; many are worth six tenths as many degrees of
    /// freedom.
    #[test]
    fn degrees_of_freedom_of_moving_ranges() {
        assert!((moving_range_dof(1.0) - 0.5 / (std::f64::consts::FRAC_PI_2 - 1.0)).abs() < 1e-12);
        assert!((moving_range_dof(1e6) / 1e6 - 0.605).abs() < 1e-3);
    }

    #[test]
    fn the_gauge_share_is_a_share_of_the_variance() {
        let gauge = Gauge::of(0.003, 0.01, 0.05, Some(0.1));
        assert!((gauge.variance_share - 0.09).abs() < 1e-12);
        assert!((gauge.tolerance_share.unwrap() - 0.18).abs() < 1e-12);
        let alone = 0.01 * 0.91_f64.sqrt();
        assert!((gauge.part_deviation_mm.unwrap() - alone).abs() < 1e-15);
        assert!((gauge.part_ppk.unwrap() - 0.05 / (3.0 * alone)).abs() < 1e-12);
        assert_eq!(Gauge::of(0.003, 0.01, f64::INFINITY, None).part_ppk, None);
    }

    #[test]
    fn a_gauge_that_explains_all_of_the_spread_leaves_no_capability_of_the_parts() {
        let gauge = Gauge::of(0.002, 0.002, 0.01, None);
        assert_eq!((gauge.part_deviation_mm, gauge.part_ppk, gauge.variance_share), (Some(0.0), None, 1.0));
        assert_eq!(Gauge::of(0.003, 0.002, 0.01, None).part_deviation_mm, None);
    }
}
