//! Sobol indices: the share of each input in the variance of a result, alone and with all others. Used for random racks, whose
//! inputs are groups of random numbers. It knows no gear, and draws only for its bootstrap.
//!
//! Let A and B be N samples of all inputs, and A_i the sample A with input i of B:
//!
//! - alone, the first-order index S_i = Σ f(B) (f(A_i) − f(A)) / N V, by Saltelli et al. 2010, f(B) less its mean;
//! - with all others, the total index T_i = Σ (f(A) − f(A_i))² / 2 N V, by Jansen 1999.
//!
//! V is the variance of f over A and B. Where nothing interacts T_i = S_i, and all S_i together are 1. Confidence intervals are
//! percentiles of the indices of samples drawn again from these (bootstrap), in [`PARTS`] parts at most.

use super::PROBABILITY;
use super::random::Random;

/// Parts that the bootstrap draws from, so that memory and time do not depend on the number of samples.
pub(super) const PARTS: u64 = 1000;
/// Resamples of the bootstrap.
pub const RESAMPLES: usize = 1000;
/// The stream of the bootstrap's random numbers.
const BOOTSTRAP: u64 = u64::MAX;

/// An estimate with its confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// The lower end.
    pub lower: f64,
    /// The upper end.
    pub upper: f64,
}

/// The indices of an input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SobolIndices {
    /// The share of the variance that it makes alone.
    pub(super) first_order: Estimate,
    /// The share that is left when all others are known: alone and with others.
    pub(super) total: Estimate,
}

/// Sums over some samples, from which indices follow.
#[derive(Debug, Clone, Default)]
pub(super) struct Sums {
    samples: f64,
    /// Of f(A) and f(B), and of their squares.
    values: f64,
    squares: f64,
    /// For each input of f(B) (f(A_i) − f(A)), of f(A_i) − f(A), and of its square.
    inputs: Vec<[f64; 3]>,
}

impl Sums {
    /// Counts a sample: f(A), f(B), and f(A_i) for each input.
    pub(super) fn add(&mut self, a: f64, b: f64, mixed: impl Iterator<Item = f64>) {
        let inputs = mixed.map(|mixed| [b * (mixed - a), mixed - a, (mixed - a) * (mixed - a)]).collect();
        self.join(&Self { samples: 1.0, values: a + b, squares: a * a + b * b, inputs });
    }

    fn join(&mut self, other: &Self) {
        self.samples += other.samples;
        self.values += other.values;
        self.squares += other.squares;
        self.inputs.resize(other.inputs.len(), [0.0; 3]);
        for (own, other) in self.inputs.iter_mut().zip(&other.inputs) {
            for (own, other) in own.iter_mut().zip(other) {
                *own += other;
            }
        }
    }

    fn of<'a>(parts: impl Iterator<Item = &'a Self>) -> Self {
        let mut all = Self::default();
        parts.for_each(|part| all.join(part));
        all
    }

    /// First-order and total index of each input; `None` where the result is the same up to rounding.
    fn indices(&self) -> Option<Vec<[f64; 2]>> {
        /// The least variance, as a share of the mean square, that is not rounding.
        const ROUNDING: f64 = 1e-12;
        let n = self.samples;
        let (mean, square) = (self.values / (2.0 * n), self.squares / (2.0 * n));
        let variance = square - mean * mean;
        let of = |[product, change, squared]: &[f64; 3]| {
            [(product - mean * change) / (n * variance), squared / (2.0 * n * variance)]
        };
        (variance > ROUNDING * square).then(|| self.inputs.iter().map(of).collect())
    }
}

/// The indices of each input by the sums over parts of the samples, all of one size; `None` where the result is the same
/// whatever the inputs, or there are too few parts for an interval.
pub(super) fn indices(parts: &[Sums], seed: u64) -> Option<Vec<SobolIndices>> {
    const FEWEST: usize = 10;
    let values = Sums::of(parts.iter()).indices().filter(|_| parts.len() >= FEWEST)?;
    let mut random = Random::of_block(seed, BOOTSTRAP);
    let resample = |_| {
        // a uniform number is below 1
        let drawn = (0..parts.len()).map(|_| &parts[(random.uniform() * parts.len() as f64) as usize]);
        Sums::of(drawn).indices()
    };
    let again: Vec<_> = (0..RESAMPLES).filter_map(resample).collect();
    let estimate = |input: usize, which: usize| {
        let mut drawn: Vec<f64> = again.iter().map(|indices| indices[input][which]).collect();
        drawn.sort_by(f64::total_cmp);
        let at = |share: f64| drawn[(share * (drawn.len() - 1) as f64).round() as usize];
        let outside = 0.5 * (1.0 - PROBABILITY);
        Estimate { value: values[input][which], lower: at(outside), upper: at(1.0 - outside) }
    };
    let of = |input| SobolIndices { first_order: estimate(input, 0), total: estimate(input, 1) };
    (!again.is_empty()).then(|| (0..values.len()).map(of).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trig;

    /// The indices of a function of uniform numbers, by so many samples in parts of 16.
    fn of(function: impl Fn(&[f64]) -> f64, inputs: usize, samples: u64) -> Vec<SobolIndices> {
        let part = |part: u64| {
            let (mut sums, mut random) = (Sums::default(), Random::of_block(7, part));
            for _ in 0..16 {
                let mut drawn = || (0..inputs).map(|_| random.uniform()).collect::<Vec<_>>();
                let (a, b) = (drawn(), drawn());
                let mixed = |input: usize| {
                    let mut mixed = a.clone();
                    mixed[input] = b[input];
                    function(&mixed)
                };
                sums.add(function(&a), function(&b), (0..inputs).map(mixed));
            }
            sums
        };
        indices(&(0..samples / 16).map(part).collect::<Vec<_>>(), 1).unwrap()
    }

    /// Estimates are close, their intervals hold the true values in about 19 of 20 cases, and are as wide as the errors.
    fn hold(found: &[SobolIndices], first_order: &[f64], total: &[f64], close: f64) {
        let mut outside = 0;
        for (found, (first_order, total)) in found.iter().zip(first_order.iter().zip(total)) {
            for (estimate, known) in [(found.first_order, first_order), (found.total, total)] {
                assert!((estimate.value - known).abs() < close, "{known}: {estimate:?}");
                outside += usize::from(!(estimate.lower..=estimate.upper).contains(known));
                assert!(estimate.upper - estimate.lower < 4.0 * close, "{estimate:?}");
            }
        }
        assert!(outside <= 1, "{outside}: {found:?}");
    }

    #[test]
    fn the_ishigami_function_has_its_known_indices() {
        let function = |x: &[f64]| {
            let [x, y, z] = [0, 1, 2].map(|input| std::f64::consts::PI * (2.0 * x[input] - 1.0));
            let sine = trig::sin(y);
            trig::sin(x) + 7.0 * sine * sine + 0.1 * (z * z) * (z * z) * trig::sin(x)
        };
        let found = of(function, 3, 1 << 14);
        hold(&found, &[0.3139, 0.4424, 0.0], &[0.5576, 0.4424, 0.2437], 0.02);
        // shifted and stretched, the shares are the same
        let moved = of(|x| 3e-3 * function(x) + 0.02, 3, 1 << 14);
        for (a, b) in found.iter().zip(&moved) {
            assert!((a.first_order.value - b.first_order.value).abs() < 1e-9);
            assert!((a.total.upper - b.total.upper).abs() < 1e-9);
        }
    }

    #[test]
    fn the_g_function_has_its_known_indices() {
        let weights = [0.0, 1.0, 4.5, 9.0, 99.0];
        let function =
            |x: &[f64]| weights.iter().zip(x).map(|(a, x)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a)).product::<f64>();
        // V_i = 1 / 3 (1 + a_i)², V = Π (1 + V_i) − 1
        let own = weights.map(|a: f64| 1.0 / (3.0 * (1.0 + a) * (1.0 + a)));
        let all: f64 = own.iter().map(|own| 1.0 + own).product();
        let first_order = own.map(|own| own / (all - 1.0));
        let total = own.map(|own| own * all / (1.0 + own) / (all - 1.0));
        hold(&of(function, 5, 1 << 14), &first_order, &total, 0.025);
    }

    #[test]
    fn what_does_not_vary_has_no_indices() {
        let part = || {
            let mut sums = Sums::default();
            sums.add(0.1, 0.1, [0.1, 0.1].into_iter());
            sums
        };
        assert_eq!(indices(&(0..50).map(|_| part()).collect::<Vec<_>>(), 1), None);
        assert_eq!(indices(&[], 1), None);
    }
}
