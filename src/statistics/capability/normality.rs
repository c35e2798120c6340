//! Whether the values of a batch look normally distributed, which capability indices suppose. Called with the values
//! themselves; it says what it finds and refuses nothing.

use crate::statistics::normal_cdf;

/// Whether values look normally distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Normality {
    /// The Anderson-Darling statistic A², not adjusted for the number of values; the p-value is that of the adjusted one.
    pub anderson_darling: f64,
    /// The probability of a statistic at least as large if the values are normal.
    pub p_value: f64,
    /// Skewness, 0 for a normal distribution.
    pub skewness: f64,
    /// Kurtosis less 3, 0 for a normal distribution.
    pub excess_kurtosis: f64,
}

impl Normality {
    /// Tests values, which it sorts, with their mean and standard deviation s.
    ///
    /// A² = −n − (1/n) Σ (2i − 1) (ln Φ(z_i) + ln Φ(−z_{n+1−i})), z_i = (x_i − x̄) / s from the smallest to the largest
    /// (D'Agostino and Stephens, *Goodness-of-Fit Techniques*, 1986, section 4.8).
    #[must_use]
    pub fn of_values(values: &mut [f64], mean: f64, deviation: f64) -> Self {
        /// Beyond so many standard deviations Φ is 0 or 1 to the last digit; up to there it is above 0 and below 1.
        const FURTHEST: f64 = 37.0;
        values.sort_unstable_by(f64::total_cmp);
        let n = values.len() as f64;
        let z = |value: &f64| ((value - mean) / deviation).clamp(-FURTHEST, FURTHEST);
        let both = values.iter().zip(values.iter().rev());
        let terms = both.enumerate().map(|(index, (low, high))| {
            (2.0 * index as f64 + 1.0) * (libm::log(normal_cdf(z(low))) + libm::log(normal_cdf(-z(high))))
        });
        let statistic = -n - terms.sum::<f64>() / n;
        let mut moments = [0.0; 3];
        for value in values {
            let off = *value - mean;
            let mut power = off;
            for moment in &mut moments {
                power *= off;
                *moment += power / n;
            }
        }
        Self::with_statistic(n, statistic, moments)
    }

    /// With the p-value of D'Agostino and Stephens, *Goodness-of-Fit Techniques* (1986), table 4.9, of the adjusted
    /// statistic A*² = A² (1 + 0.75/n + 2.25/n²), for mean and deviation estimated from the values.
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
            anderson_darling: statistic,
            p_value: p_value.clamp(0.0, 1.0),
        }
    }

    /// Whether normality is rejected at the 5 % level.
    #[must_use]
    pub fn rejected(&self) -> bool {
        self.p_value < 0.05
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        // for ten values the statistic counts by a tenth more, and stays as it is
        let ten = Normality::with_statistic(10.0, 0.5, [4.0, 8.0, 48.0]);
        assert!((ten.p_value - p_value(0.5 * 1.0975)).abs() < 1e-12 && ten.anderson_darling == 0.5);
        assert!((ten.skewness - 1.0).abs() < 1e-12 && ten.excess_kurtosis.abs() < 1e-12);
    }

    /// NAG Library, example of g08ckf: A² and its adjusted value; R's package nortest, ad.test of the fuel consumptions
    /// in its data set mtcars (finnstats.com, 9 November 2021): A² and p.
    const NAG: [f64; 26] = [
        0.313_113_2,
        0.252_041_2,
        1.578_884_1,
        1.441_671_2,
        -0.824_604_3,
        -1.646_668_5,
        0.794_318_4,
        1.287_491_5,
        -0.834_725_0,
        0.335_250_5,
        0.943_446_7,
        2.109_952_0,
        -0.280_165_4,
        -0.784_300_9,
        0.621_818_7,
        2.096_380_9,
        1.717_040_3,
        -0.135_014_2,
        0.798_276_3,
        -0.298_097_7,
        1.228_304_3,
        1.557_609_0,
        -0.482_875_7,
        2.607_075_4,
        0.121_399_6,
        0.143_162_1,
    ];
    const MTCARS: [f64; 32] = [
        21.0, 21.0, 22.8, 21.4, 18.7, 18.1, 14.3, 24.4, 22.8, 19.2, 17.8, 16.4, 17.3, 15.2, 10.4, 10.4, 14.7, 32.4,
        30.4, 33.9, 21.5, 15.5, 15.2, 13.3, 19.2, 27.3, 26.0, 30.4, 15.8, 19.7, 15.0, 21.4,
    ];
    /// Two samples of the R package cmstatr's tests, with the significance levels that STAT17 gives.
    const STAT17: [([f64; 18], f64); 2] = [
        (
            [
                79.910_962_176_193_7,
                77.944_743_634_638_8,
                79.717_168_019_752,
                87.354_746_086_054_7,
                76.240_476_919_241_3,
                75.702_691_130_024_6,
                79.595_270_928_029_8,
                76.783_378_498_015_5,
                77.579_147_206_783_1,
                78.416_452_333_926_8,
                79.281_939_881_874_5,
                77.634_648_193_096_4,
                81.218_293_774_324_1,
                81.182_643_173_073_1,
                86.056_176_259_346_1,
                82.183_778_488_449_5,
                80.756_492_065_088_4,
                79.361_498_022_548_8,
            ],
            0.0840,
        ),
        (
            [
                137.4438, 139.5395, 150.89, 141.4474, 141.8203, 151.8821, 143.9245, 132.9732, 136.6419, 138.1723,
                148.7668, 143.283, 143.5429, 141.7023, 137.4732, 152.338, 144.1589, 128.5218,
            ],
            0.465,
        ),
    ];

    fn of(values: &[f64]) -> Normality {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        Normality::of_values(&mut values.to_vec(), mean, (squares / (n - 1.0)).sqrt())
    }

    #[test]
    fn published_examples() {
        let adjusted = |found: &Normality, n: f64| found.anderson_darling * (1.0 + 0.75 / n + 2.25 / (n * n));
        let near =
            |found: f64, printed: f64, within: f64| assert!((found - printed).abs() < within, "{found} {printed}");
        let nag = of(&NAG);
        near(nag.anderson_darling, 0.165_956, 5e-7);
        near(adjusted(&nag, 26.0), 0.171_296, 5e-7);
        near(nag.p_value, 0.931_155, 1e-6);
        let mtcars = of(&MTCARS);
        near(mtcars.anderson_darling, 0.57968, 5e-6);
        near(mtcars.p_value, 0.1207, 5e-5);
        for (values, printed) in STAT17 {
            // CMH-17-1G: A* = (1 + 4/n − 25/n²) A², 1 / (1 + exp(−0.48 + 0.78 ln A* + 4.58 A*))
            let a = of(&values).anderson_darling * (1.0 + 4.0 / 18.0 - 25.0 / 324.0);
            let level = 1.0 / (1.0 + libm::exp(-0.48 + 0.78 * libm::log(a) + 4.58 * a));
            near(level / printed, 1.0, 1e-3);
        }
    }

    /// Half of the values at ±1: both halves have the same z. And one value far out, whose tail is beyond all digits.
    #[test]
    fn by_hand_and_far_out() {
        let found = of(&[-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0]);
        let z = 0.9_f64.sqrt();
        // Σ (2i − 1) of the lower half is 25, of the upper one 75
        let (below, above) = (libm::log(normal_cdf(-z)), libm::log(normal_cdf(z)));
        let statistic = -10.0 - 2.0 * (25.0 * below + 75.0 * above) / 10.0;
        assert!((found.anderson_darling - statistic).abs() < 1e-12, "{found:?}");
        assert!((found.excess_kurtosis + 2.0).abs() < 1e-12 && found.skewness.abs() < 1e-12);
        let mut values = vec![0.0; 5000];
        values[0] = 1.0;
        let far = of(&values);
        assert!(far.anderson_darling.is_finite() && far.p_value == 0.0 && far.rejected(), "{far:?}");
    }
}
