//! What a sample of racks says of all of them: quantiles and shares with intervals that hold for any distribution.
//! Called with the results; it draws and solves nothing.

use crate::quantity::tidy;
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

/// Quantiles of values; at least one is needed.
///
/// The interval's ends are the order statistics X_(l) and X_(u) with P(B < l) ≤ 2.5 % and P(B ≥ u) ≤ 2.5 % for a
/// binomial B(n, p): it holds whatever the distribution (David and Nagaraja, *Order Statistics*, 7.1).
#[must_use]
pub fn quantiles(values: &[f64], shares: &[f64]) -> Vec<Quantile> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let tail = 0.5 * (1.0 - CONFIDENCE);
    let n = sorted.len() as f64;
    // P(B ≤ k)
    let cdf = |k: f64, p: f64| {
        if k < 0.0 {
            0.0
        } else if k >= n {
            1.0
        } else {
            1.0 - beta_cdf(p, k + 1.0, n - k)
        }
    };
    shares
        .iter()
        .filter(|_| !sorted.is_empty())
        .map(|&p| {
            let first = |holds: &dyn Fn(f64) -> bool| {
                let (mut low, mut high) = (0, sorted.len() + 1);
                while low < high {
                    let middle = usize::midpoint(low, high);
                    if holds(middle as f64) { high = middle } else { low = middle + 1 }
                }
                low
            };
            // the smallest count that is exceeded rarely, and the largest that is rarely fallen short of
            let upper = first(&|k| 1.0 - cdf(k - 1.0, p) <= tail);
            let lower = first(&|k| cdf(k - 1.0, p) > tail).saturating_sub(1);
            let rank = ((n * p).ceil().max(1.0) as usize).min(sorted.len());
            let at = |rank: usize| rank.checked_sub(1).and_then(|index| sorted.get(index)).copied().map(tidy);
            Quantile { share: p, value_mm: tidy(sorted[rank - 1]), lower_mm: at(lower), upper_mm: at(upper) }
        })
        .collect()
}

/// A share of `inside` out of `of` with its 95 % confidence interval (Clopper and Pearson).
#[must_use]
pub fn share(inside: usize, of: usize) -> (f64, f64, f64) {
    let tail = 0.5 * (1.0 - CONFIDENCE);
    let (x, n) = (inside as f64, of as f64);
    let lower = if inside == 0 { 0.0 } else { beta_quantile(tail, x, n - x + 1.0) };
    let upper = if inside == of { 1.0 } else { beta_quantile(1.0 - tail, x + 1.0, n - x) };
    (x / n, lower, upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_of_quantiles_are_the_order_statistics_of_the_tables() {
        // n = 10, median: X_(2) to X_(9), with 97.9 % confidence
        let values: Vec<f64> = (1..=10).map(f64::from).collect();
        let [median, high]: [Quantile; 2] = quantiles(&values, &[0.5, 0.99]).try_into().unwrap();
        assert_eq!((median.value_mm, median.lower_mm, median.upper_mm), (5.0, Some(2.0), Some(9.0)));
        assert_eq!((high.value_mm, high.upper_mm), (10.0, None));
        // one of 97.5 %: the tail beyond it is 2.5 % to the last digit
        let one = quantiles(&[7.0], &[0.975])[0];
        assert_eq!((one.value_mm, one.lower_mm, one.upper_mm), (7.0, Some(7.0), None));
        // n = 100, median: X_(40) to X_(61)
        let values: Vec<f64> = (1..=100).map(f64::from).collect();
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
