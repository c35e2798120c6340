//! What a sample of racks says about all racks: quantiles and shares with intervals that hold for any distribution. It draws
//! and solves nothing.

use super::counts::Counts;
use crate::quantity::of_femtometres;
use crate::statistics::{beta_cdf, beta_quantile};

/// Confidence of intervals of quantiles and shares.
pub const CONFIDENCE: f64 = 0.95;

/// A quantile with its distribution-free confidence interval from order statistics.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Quantile {
    /// The share of racks at or below.
    pub share: f64,
    /// The estimate, mm.
    pub value_mm: f64,
    /// Lower end of the 95 % confidence interval, mm; `None` if there are too few racks for one.
    pub lower_mm: Option<f64>,
    /// Upper end, mm.
    pub upper_mm: Option<f64>,
}

/// Quantiles of a count. A value is the middle of its bin; the ends of an interval are the ends of their bins that make it
/// wider.
///
/// The interval's ends are the order statistics X_(l) and X_(u) with P(B < l) ≤ 2.5 % and P(B ≥ u) ≤ 2.5 % for a
/// binomial B(n, p): it holds whatever the distribution (David and Nagaraja, *Order Statistics*, 7.1).
pub(super) fn quantiles(counts: &Counts, shares: &[f64]) -> Vec<Quantile> {
    let racks = counts.racks();
    let quantile = |&p: &f64| {
        let (lower, upper) = ranks(racks, p);
        let rank = ((racks as f64 * p).ceil().max(1.0) as u64).min(racks);
        Some(Quantile {
            share: p,
            value_mm: of_femtometres(0.5 * counts.at_rank(rank)?.twice_middle_fm() as f64),
            lower_mm: counts.at_rank(lower).map(|span| of_femtometres(span.first_fm as f64)),
            upper_mm: counts.at_rank(upper).map(|span| of_femtometres(span.last_fm as f64)),
        })
    };
    shares.iter().filter_map(quantile).collect()
}

/// The ranks, from 1, of the ends of a quantile's interval; 0 and n + 1 are those of no value.
fn ranks(racks: u64, p: f64) -> (u64, u64) {
    let (tail, n) = (0.5 * (1.0 - CONFIDENCE), racks as f64);
    // P(B ≤ k)
    let cdf = |k: f64| {
        if k < 0.0 {
            0.0
        } else if k >= n {
            1.0
        } else {
            1.0 - beta_cdf(p, k + 1.0, n - k)
        }
    };
    let first = |holds: &dyn Fn(f64) -> bool| {
        let (mut low, mut high) = (0, racks.saturating_add(1));
        while low < high {
            let middle = u64::midpoint(low, high);
            if holds(middle as f64) { high = middle } else { low = middle + 1 }
        }
        low
    };
    // the smallest count that is rarely exceeded, and the largest that is rarely not reached
    let upper = first(&|k| 1.0 - cdf(k - 1.0) <= tail);
    let lower = first(&|k| cdf(k - 1.0) > tail).saturating_sub(1);
    (lower, upper)
}

/// A share of `inside` out of `of` with its 95 % confidence interval (Clopper and Pearson).
#[must_use]
pub fn share(inside: u64, of: u64) -> (f64, f64, f64) {
    let tail = 0.5 * (1.0 - CONFIDENCE);
    let (x, n) = (inside as f64, of as f64);
    let lower = if inside == 0 { 0.0 } else { beta_quantile(tail, x, n - x + 1.0) };
    let upper = if inside == of { 1.0 } else { beta_quantile(1.0 - tail, x + 1.0, n - x) };
    (x / n, lower, upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(values: impl IntoIterator<Item = f64>) -> Counts {
        let mut counts = Counts::default();
        values.into_iter().for_each(|value| counts.count(value).unwrap());
        counts
    }

    /// By the normal distribution the ranks are n p ± 1.96 √(n p (1 − p)).
    #[test]
    fn ranks_of_many_racks_are_those_of_the_normal_distribution() {
        for n in [1e6, 1e8, 1e10] {
            for p in [0.01, 0.5, 0.99] {
                let (lower, upper) = ranks(n as u64, p);
                let deviation = (n * p * (1.0 - p)).sqrt();
                let away = |rank: u64| (rank as f64 - n * p) / deviation;
                assert!(
                    (away(lower) + 1.96).abs() < 0.02 && (away(upper) - 1.96).abs() < 0.02,
                    "{n} {p} {lower} {upper}"
                );
            }
        }
    }

    #[test]
    fn intervals_of_quantiles_are_the_order_statistics_of_the_tables() {
        // n = 10, median: X_(2) to X_(9), with 97.9 % confidence
        let values = counted((1..=10).map(f64::from));
        let [median, high]: [Quantile; 2] = quantiles(&values, &[0.5, 0.99]).try_into().unwrap();
        assert_eq!((median.value_mm, median.lower_mm, median.upper_mm), (5.0, Some(2.0), Some(9.0)));
        assert_eq!((high.value_mm, high.upper_mm), (10.0, None));
        // one of 97.5 %: the tail beyond it is 2.5 % to the last digit
        let one = quantiles(&counted([7.0]), &[0.975])[0];
        assert_eq!((one.value_mm, one.lower_mm, one.upper_mm), (7.0, Some(7.0), None));
        // n = 100, median: X_(40) to X_(61)
        let values = counted((1..=100).map(f64::from));
        let median = quantiles(&values, &[0.5])[0];
        assert_eq!((median.lower_mm, median.upper_mm), (Some(40.0), Some(61.0)));
    }

    #[test]
    fn shares_have_the_interval_of_clopper_and_pearson() {
        // none of 10: 0 to 1 − 0.025^(1/10) = 0.3085
        let (value, lower, upper) = share(0, 10);
        assert_eq!((value, lower), (0.0, 0.0));
        assert!((upper - 0.308_5).abs() < 5e-5, "{upper}");
        let (_, lower, upper) = share(5, 10);
        assert!((lower - 0.187_1).abs() < 5e-5 && (upper - 0.812_9).abs() < 5e-5, "{lower} {upper}");
    }
}
