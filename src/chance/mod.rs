#![doc = include_str!("method.md")]
//!
//! [`simulate_part`] draws a part's errors and gear data from their distributions and gives the distribution of each
//! ΔCD, for the command line and batches. [`simulate`] does the same for any [`Simulated`] model; the worked examples of JCGM
//! 101 are tested by it. Nothing here reads files or prints.

mod histogram;
mod part;
pub mod racks;
mod random;
mod run;
mod sobol;

#[cfg(feature = "cli")]
pub(crate) use part::simulate_part_watched;
pub use part::{PartSimulation, simulate_part};
pub(crate) use random::{Random, Ziggurat};
pub use run::simulate;
pub(crate) use run::{Watch, simulate_watched};
pub use sobol::{Estimate, RESAMPLES};

use thiserror::Error;

use crate::uncertainty::{Influence, Linear, Uncertainty, UncertaintyError};
use histogram::Histogram;

/// Draws per block; JCGM 101 asks for 10⁴ at least.
pub const BLOCK: u64 = 10_000;
/// The probability of the intervals.
pub const PROBABILITY: f64 = 0.95;
/// The seed where none is given.
pub const DEFAULT_SEED: u64 = 1;
/// Significant digits of u where none are given, as JCGM 101 recommends.
pub const DEFAULT_DIGITS: u32 = 2;
/// The most draws that may be asked for.
pub const MOST_DRAWS: u64 = 2_000_000_000;

/// The most draws of an adaptive simulation: a part with an uncertain gear takes some 3 µs a draw on a core.
pub const MOST_ADAPTIVE: u64 = 1_600_000;
/// The most draws of an adaptive simulation of one of many parts.
pub const MOST_ADAPTIVE_OF_MANY: u64 = 100_000;

/// How to simulate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// The seed; the same one gives the same result.
    pub seed: u64,
    /// The number of draws; `None` for as many as the digits need.
    pub draws: Option<u64>,
    /// The most draws where no number is given, 20 000 or more.
    pub most_draws: u64,
    /// Significant digits of the standard uncertainty that must be stable, 1 to 4.
    pub digits: u32,
    /// Threads; `None` for one per core. Does not change the result.
    pub threads: Option<usize>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { seed: DEFAULT_SEED, draws: None, most_draws: MOST_ADAPTIVE, digits: DEFAULT_DIGITS, threads: None }
    }
}

/// A function of random variables, evaluated for many draws at a time.
pub trait Simulated: Sync {
    /// The number of results.
    fn outputs(&self) -> usize;
    /// Evaluates every draw: `inputs` has a column per variable, `outputs` one per result, all of the same length.
    fn evaluate(&self, inputs: &[Vec<f64>], outputs: &mut [Vec<f64>]);
}

/// The variables that are drawn.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Variables {
    /// Best estimate and uncertainty of each.
    pub variables: Vec<(f64, Uncertainty)>,
    /// Cholesky factor of the correlation matrix, by rows; correlated variables are jointly normal.
    pub factor: Option<Vec<f64>>,
}

/// Two results and the limits that the draws are counted against: `low` at least `lower` and `high` at most `upper`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// The result compared with the lower limit.
    pub low: usize,
    /// The result compared with the upper limit.
    pub high: usize,
    /// The lower limit; −∞ if there is none.
    pub lower: f64,
    /// The upper limit; ∞ if there is none.
    pub upper: f64,
}

/// The distribution of one result.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    /// Mean.
    pub mean: f64,
    /// Standard deviation: the standard uncertainty.
    pub standard: f64,
    /// The 95 % interval with 2.5 % on either side.
    pub symmetric: (f64, f64),
    /// The shortest 95 % interval.
    pub shortest: (f64, f64),
    /// Standard errors of both ends of the symmetric interval, from the number of draws.
    pub end_errors: (f64, f64),
    /// The smallest and largest value drawn.
    pub extremes: (f64, f64),
    histogram: Histogram,
}

impl Simulation {
    /// The distribution from its moments and counts.
    fn of(histogram: Histogram, mean: f64, standard: f64, draws: f64) -> Self {
        let tail = 0.5 * (1.0 - PROBABILITY);
        let symmetric = (histogram.quantile(tail), histogram.quantile(1.0 - tail));
        // the standard error of a quantile is √(p (1 − p)/n) over the density there
        let error = |p: f64| {
            const BESIDE: f64 = 0.005;
            let per_probability = (histogram.quantile(p + BESIDE) - histogram.quantile(p - BESIDE)) / (2.0 * BESIDE);
            (p * (1.0 - p) / draws).sqrt() * per_probability
        };
        Self {
            mean,
            standard,
            symmetric,
            shortest: histogram.shortest(PROBABILITY),
            end_errors: (error(tail), error(1.0 - tail)),
            extremes: histogram.extremes,
            histogram,
        }
    }
}

/// The result of a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The seed.
    pub seed: u64,
    /// Draws made.
    pub draws: u64,
    /// Digits asked for.
    pub digits: u32,
    /// How many times δ/5 an adaptive simulation is off, with the tolerance δ of its digits: at most 1 where it reached them;
    /// `None` if the number of draws was given.
    pub excess: Option<f64>,
    /// One per result.
    pub results: Vec<Simulation>,
    /// The share of the draws inside each band.
    pub inside: Vec<f64>,
}

impl Outcome {
    /// Whether an adaptive simulation reached its digits, to the fifth of their tolerance that a validation needs (JCGM 101, 8.2);
    /// `None` if the number of draws was given.
    #[must_use]
    pub fn reached(&self) -> Option<bool> {
        self.excess.map(|excess| excess <= 1.0)
    }

    /// The digits of u that an adaptive simulation holds to their tolerance (JCGM 101, 7.9.4); `None` if the number of draws was given.
    #[must_use]
    pub fn stable_digits(&self) -> Option<u32> {
        self.excess.map(|excess| self.digits_within(excess / 5.0))
    }

    /// The digits that an adaptive simulation with these draws reaches.
    #[must_use]
    pub fn reachable_digits(&self) -> Option<u32> {
        self.excess.map(|excess| self.digits_within(excess))
    }

    /// The digits left of those asked for, if these are off by so many times their tolerance: one digit less allows ten times more.
    fn digits_within(&self, excess: f64) -> u32 {
        let within = |digits: &u32| excess <= libm::pow(10.0, f64::from(self.digits - digits));
        (1..=self.digits).rev().find(within).unwrap_or(0)
    }

    /// The number of draws that would reach the digits, to two digits upwards; `None` where they are reached, the number was given, or
    /// it is more than [`MOST_DRAWS`].
    #[must_use]
    pub fn needed_draws(&self) -> Option<u64> {
        // errors shrink with the root of the number
        let needed = self.excess.filter(|excess| *excess > 1.0).map(|excess| self.draws as f64 * excess * excess)?;
        let unit = libm::pow(10.0, libm::floor(libm::log10(needed)) - 1.0);
        let rounded = (needed / unit).ceil() * unit;
        (rounded <= MOST_DRAWS as f64).then_some(rounded as u64)
    }
}

/// Why there is no simulation.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MonteCarloError {
    /// Nothing is uncertain.
    #[error("nothing has an uncertainty, so there is nothing to simulate")]
    NothingUncertain,
    /// A number of draws or digits outside its range.
    #[error("{what} is {value}; it must be from {least} to {most}")]
    Setting {
        /// Which one.
        what: &'static str,
        /// The number.
        value: u64,
        /// The smallest allowed.
        least: u64,
        /// The largest allowed.
        most: u64,
    },
    /// A correlated variable that is not normal.
    #[error("{} is correlated, so it must be normal with infinite degrees of freedom to be simulated", .0.key())]
    CorrelatedNotNormal(Influence),
    /// Too few degrees of freedom for a variance.
    #[error("{} has {dof} degrees of freedom; below 3 its distribution has no standard deviation to simulate", .source_of.key())]
    TooFewFreedom {
        /// Of what.
        source_of: Influence,
        /// The number.
        dof: f64,
    },
    /// Values were drawn that a formula cannot take.
    #[error("{share:.1e} of the draws have no ΔCD: an uncertainty reaches beyond what its quantity may be")]
    OutsideDomain {
        /// The share.
        share: f64,
    },
    /// The inputs make no sense.
    #[error(transparent)]
    Input(#[from] UncertaintyError),
}

/// The tolerance δ of `digits` significant digits of `u`: half a unit of the last one (JCGM 101, 7.9.2).
#[must_use]
pub fn tolerance(u: f64, digits: u32) -> f64 {
    if u <= 0.0 {
        return 0.0;
    }
    0.5 * libm::pow(10.0, libm::floor(libm::log10(u)) - f64::from(digits) + 1.0)
}

/// Whether a linear result agrees with a simulated one (JCGM 101, clause 8).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Validation {
    /// Half-width U of the linear 95 % interval; `None` where there is none.
    pub linear_half_width: Option<f64>,
    /// d_low and d_high: distances of the ends of both intervals.
    pub distances: Option<(f64, f64)>,
    /// δ, which neither may exceed.
    pub tolerance: f64,
    /// Whether neither exceeds δ.
    pub validated: bool,
    /// Whether twice the standard errors of the simulated ends leave that without doubt.
    pub is_sure: bool,
}

impl Validation {
    /// Whether the linear result is validated; `None` where a simulation that did not reach its digits leaves it in doubt.
    #[must_use]
    pub fn by(&self, outcome: &Outcome) -> Option<bool> {
        (self.is_sure || outcome.reached() != Some(false)).then_some(self.validated)
    }
}

/// Compares a linear result with a simulated one, to `digits` digits of the standard uncertainty.
#[must_use]
pub fn validate(linear: &Linear, simulation: &Simulation, digits: u32) -> Validation {
    let half = linear.half_width_mm(PROBABILITY);
    let (low, high) = simulation.symmetric;
    let distances = half.map(|half| ((linear.value_mm - half - low).abs(), (linear.value_mm + half - high).abs()));
    let tolerance = tolerance(simulation.standard, digits);
    let validated = distances.is_some_and(|(low, high)| low <= tolerance && high <= tolerance);
    let (of_low, of_high) = simulation.end_errors;
    let is_sure = distances.is_none_or(|(low, high)| {
        let ends = [(low, 2.0 * of_low), (high, 2.0 * of_high)];
        let exceeds = ends.iter().any(|(distance, error)| distance - error > tolerance);
        exceeds || ends.iter().all(|(distance, error)| distance + error <= tolerance)
    });
    Validation { linear_half_width: half, distances, tolerance, validated, is_sure }
}

#[cfg(test)]
mod tests;
