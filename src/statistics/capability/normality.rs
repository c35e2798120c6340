//! Whether the values of a batch look normally distributed, which capability indices suppose. Called with how many of
//! them lie where; it says what it finds and refuses nothing.

use crate::statistics::{normal_cdf, normal_density};

/// Whether values look normally distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Normality {
    /// The Anderson-Darling statistic A*² (mean and deviation estimated from the values).
    pub anderson_darling: f64,
    /// The probability of a statistic at least as large if the values are normal.
    pub p_value: f64,
    /// Skewness, 0 for a normal distribution.
    pub skewness: f64,
    /// Kurtosis less 3, 0 for a normal distribution.
    pub excess_kurtosis: f64,
}

impl Normality {
    /// Of values counted in groups, from the lowest group to the highest: its ends and count. Within a group they are
    /// taken as spread evenly. `None` if a group is wider than a quarter of the standard deviation.
    ///
    /// A² = n ∫ (F_n − F)² / (F (1 − F)) dF, with the empirical distribution F_n rising linearly within a group; below
    /// and above all groups the integral is −ln(1 − F) − F and −ln F − (1 − F).
    #[must_use]
    pub fn of_groups(groups: &[(f64, f64, u64)], mean: f64, deviation: f64) -> Option<Self> {
        let (first, last) = (groups.first()?, groups.last()?);
        let n = groups.iter().map(|(.., count)| *count).sum::<u64>() as f64;
        if groups.iter().any(|(low, high, _)| high - low > 0.25 * deviation) {
            return None;
        }
        let standardised = |value: f64| (value - mean) / deviation;
        let tail = |z: f64| {
            // the probability beyond, and the logarithm of what is not
            let beyond = normal_cdf(-z);
            -libm::log1p(-beyond) - beyond
        };
        let (mut moments, mut statistic, mut below) = ([0.0; 3], 0.0, 0.0);
        statistic += tail(-standardised(first.0)) + tail(standardised(last.1));
        let mut end = first.0;
        for (low, high, count) in groups {
            let share = *count as f64 / n;
            statistic += distance(standardised(end), standardised(*low), below, below);
            statistic += distance(standardised(*low), standardised(*high), below, below + share);
            below += share;
            end = *high;
            let d = 0.5 * (low + high) - mean;
            for (moment, power) in moments.iter_mut().zip([d * d, d * d * d, d * d * d * d]) {
                *moment += share * power;
            }
        }
        Some(Self::with_statistic(n, n * statistic, moments))
    }

    /// With the p-value of D'Agostino and Stephens, *Goodness-of-Fit Techniques* (1986), table 4.9, for mean and
    /// deviation estimated from the values.
    fn with_statistic(n: f64, statistic: f64, [m2, m3, m4]: [f64; 3]) -> Self {
        let a = statistic * (1.0 + 0.75 / n + 2.25 / (n * n));
        let p_value = if a >= 0.6 {
            libm::exp(1.2937 - 5.709 * a + 0.0186 * a * a)
        } else if a >= 0.34 {
            libm::exp(0.9177 - 4.279 * a - 1.38 * a * a)
        } else if a >= 0.2 {
            1.0 - libm::exp(-8.318 + 42.796 * a - 59.938 * a * a)
        } else {
            1.0 - libm::exp(-13.436 + 101.14 * a - 223.73 * a * a)
        };
        // beyond 153 the fitted parabola turns and rises again: the probability is nothing there
        let p_value = if a > 100.0 { 0.0 } else { p_value };
        Self {
            skewness: m3 / (m2 * m2.sqrt()),
            excess_kurtosis: m4 / (m2 * m2) - 3.0,
            anderson_darling: a,
            p_value: p_value.clamp(0.0, 1.0),
        }
    }

    /// Whether normality is rejected at the 5 % level.
    #[must_use]
    pub fn rejected(&self) -> bool {
        self.p_value < 0.05
    }
}

/// ∫ (G − F)² / (F (1 − F)) dF from z_0 to z_1, where G rises linearly in z from `from` to `to`, by Gauss's rule on
/// pieces of a quarter of a standard deviation.
fn distance(z_0: f64, z_1: f64, from: f64, to: f64) -> f64 {
    // abscissae and weights of three points on -1 to 1: 0, ±√(3/5); 8/9, 5/9
    const POINTS: [(f64, f64); 3] =
        [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
    /// Beyond so many standard deviations F is 0 or 1 to the last digit; up to there it is above 0 and below 1.
    const FURTHEST: f64 = 37.0;
    let (low, high) = (z_0.clamp(-FURTHEST, FURTHEST), z_1.clamp(-FURTHEST, FURTHEST));
    if high <= low {
        return 0.0;
    }
    let pieces = ((high - low) / 0.25).ceil().max(1.0) as usize;
    let half = 0.5 * (high - low) / pieces as f64;
    let mut sum = 0.0;
    for piece in 0..pieces {
        let middle = low + half * (2.0 * piece as f64 + 1.0);
        for (at, weight) in POINTS {
            let z = middle + half * at;
            let g = from + (to - from) * (z - z_0) / (z_1 - z_0);
            let (below, above) = (normal_cdf(z), normal_cdf(-z));
            // the smaller of both carries the digits
            let gap = if z < 0.0 { g - below } else { above - (1.0 - g) };
            sum += half * weight * gap * gap / (below * above) * normal_density(z);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::normal_quantile;

    fn p_value(statistic: f64) -> f64 {
        Normality::with_statistic(f64::INFINITY, statistic, [1.0, 0.0, 3.0]).p_value
    }

    /// D'Agostino and Stephens, table 4.7: the points of A*² for mean and deviation estimated from the values.
    #[test]
    fn printed_points_of_the_statistic() {
        for (statistic, p, within) in [
            (0.341, 0.5, 6e-3),
            (0.470, 0.25, 4e-3),
            (0.561, 0.15, 3e-3),
            (0.631, 0.10, 2e-3),
            (0.752, 0.05, 1e-3),
            (0.873, 0.025, 1e-3),
            (1.035, 0.01, 1e-3),
            (1.159, 0.005, 1e-3),
        ] {
            assert!((p_value(statistic) - p).abs() < within, "{statistic} {}", p_value(statistic));
        }
        // the lower pieces, which meet each other and the upper ones
        assert!((p_value(0.15) - 0.963).abs() < 1e-3 && (p_value(0.27) - 0.678).abs() < 1e-3);
        assert!((p_value(0.2) - p_value(0.2_f64.next_down())).abs() < 2e-4);
        assert!((p_value(0.34) - p_value(0.34_f64.next_down())).abs() < 4e-3);
        assert!((p_value(0.6) - p_value(0.6_f64.next_down())).abs() < 3e-3);
        assert!(p_value(100.0) > 0.0 && p_value(400.0) == 0.0);
        let five_percent = Normality { skewness: 0.0, excess_kurtosis: 0.0, anderson_darling: 0.752, p_value: 0.05 };
        assert!(!five_percent.rejected());
        // for ten values the statistic counts by a tenth more
        let ten = Normality::with_statistic(10.0, 0.5, [4.0, 8.0, 48.0]);
        assert!((ten.anderson_darling - 0.5 * 1.0975).abs() < 1e-12);
        assert!((ten.skewness - 1.0).abs() < 1e-12 && ten.excess_kurtosis.abs() < 1e-12);
    }

    /// Of a distribution function that is c from F_0 to F_1:
    /// ∫ (c − F)²/(F (1 − F)) dF = c² ln(F_1/F_0) − (1 − c)² ln((1 − F_1)/(1 − F_0)) − (F_1 − F_0).
    #[test]
    fn the_distance_of_a_step() {
        for (z_0, z_1) in [(-3.0, 2.0), (-6.0, -4.0), (4.0, 6.0), (0.5, 0.6)] {
            for c in [0.0, 0.3, 1.0] {
                let (below_0, below_1) = (normal_cdf(z_0), normal_cdf(z_1));
                let above = normal_cdf(-z_1) / normal_cdf(-z_0);
                let expected = c * c * libm::log(below_1 / below_0)
                    - (1.0 - c) * (1.0 - c) * libm::log(above)
                    - (below_1 - below_0);
                let found = distance(z_0, z_1, c, c);
                assert!(
                    (found - expected).abs() < 1e-7 * expected.abs().max(1e-3),
                    "{z_0} {z_1} {c}: {found} {expected}"
                );
            }
        }
    }

    /// Rising from one share to another; and far out on either side, where only the smaller of F and 1 − F has digits.
    /// Each integral was taken with thirty digits.
    #[test]
    fn the_distance_of_a_slope_and_of_the_tails() {
        for (z_0, z_1, from, to, expected) in [
            (-0.5, 1.0, 0.25, 0.875, 3.155_262_810_671_1e-3),
            (-2.0, -0.75, 0.0, 0.125, 4.287_770_482_763_5e-3),
            (0.5, 2.5, 0.75, 1.0, 6.692_302_269_659_7e-3),
            (-20.0, -10.0, 0.0, 0.0, 2.903_104_859_080_5e-47),
            (-12.0, -9.0, 0.0, 0.0, 6.368_558_934_122_3e-39),
        ] {
            let (found, mirrored) = (distance(z_0, z_1, from, to), distance(-z_1, -z_0, 1.0 - to, 1.0 - from));
            // an integrand that falls to a tenth within a piece is taken less well, and is nothing beside the rest
            let within = if z_1 < -5.0 { 1e-2 } else { 1e-6 };
            assert!((found / expected - 1.0).abs() < within, "{z_0} {z_1}: {found} {expected}");
            assert!((mirrored / found - 1.0).abs() < 1e-12, "{z_0} {z_1}: {found} {mirrored}");
        }
        assert!(distance(-1e3, -30.0, 0.0, 0.0) < 1e-190 && distance(30.0, 1e3, 1.0, 1.0) < 1e-190);
    }

    /// Ten values all but equal to the mean: both tails are ln 2 − 1/2. And groups of a quarter of a deviation are
    /// narrow.
    #[test]
    fn one_narrow_group() {
        let group = [(-1e-9, 1e-9, 10)];
        let found = Normality::of_groups(&group, 0.0, 1.0).unwrap().anderson_darling;
        assert!((found - 10.0 * 2.0 * (std::f64::consts::LN_2 - 0.5) * 1.0975).abs() < 1e-6, "{found}");
        assert!(Normality::of_groups(&[(0.0, 0.5, 10)], 0.25, 2.0).is_some());
        assert!(Normality::of_groups(&[(0.0, 0.51, 10)], 0.25, 2.0).is_none());
    }

    /// The statistic as its definition gives it.
    fn by_values(values: &[f64], mean: f64, deviation: f64) -> Normality {
        let n = values.len() as f64;
        let moments = [2, 3, 4].map(|k| {
            let power = |value: &f64| (0..k).fold(1.0, |product, _| product * (value - mean));
            values.iter().map(power).sum::<f64>() / n
        });
        let z = |value: f64| (value - mean) / deviation;
        let terms = values.iter().zip(values.iter().rev()).zip(0_u32..).map(|((low, high), i)| {
            (2.0 * f64::from(i) + 1.0) * libm::log(normal_cdf(z(*low)) * normal_cdf(-z(*high)))
        });
        Normality::with_statistic(n, -n - terms.sum::<f64>() / n, moments)
    }

    #[test]
    fn groups_say_what_the_values_say() {
        // a normal and a skewed sample: the groups are a thousandth of a standard deviation wide
        for (skewed, rejected) in [(false, false), (true, true)] {
            let values: Vec<f64> = (0..500)
                .map(|i| {
                    let z = 3.5 + normal_quantile((f64::from(i) + 0.5) / 500.0);
                    if skewed { z * z } else { z }
                })
                .collect();
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let deviation = (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0)).sqrt();
            let by_values = by_values(&values, mean, deviation);
            let width = 1e-3 * deviation;
            let mut groups: Vec<(f64, f64, u64)> = Vec::new();
            for value in &values {
                let low = (value / width).floor() * width;
                match groups.last_mut() {
                    Some((last, _, count)) if *last == low => *count += 1,
                    _ => groups.push((low, low + width, 1)),
                }
            }
            let by_groups = Normality::of_groups(&groups, mean, deviation).expect("the groups are narrow");
            let near =
                |a: f64, b: f64, within: f64| assert!((a - b).abs() < within, "{skewed}: {by_values:?} {by_groups:?}");
            near(by_values.anderson_darling, by_groups.anderson_darling, 2e-2);
            near(by_values.skewness, by_groups.skewness, 1e-3);
            near(by_values.excess_kurtosis, by_groups.excess_kurtosis, 1e-3);
            assert_eq!((by_values.rejected(), by_groups.rejected()), (rejected, rejected), "{skewed}");
        }
        assert_eq!(Normality::of_groups(&[(0.0, 1.0, 50)], 0.5, 1.0), None);
        assert_eq!(Normality::of_groups(&[], 0.5, 1.0), None);
    }
}
