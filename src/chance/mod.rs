#![doc = include_str!("method.md")]
//!
//! [`simulate_part`] draws a part's errors and gear data from their distributions and gives the distribution of each
//! ΔCD; it is called by the command line and the batch engine. [`simulate`] does the same for any [`Simulated`] model,
//! which is how the worked examples of JCGM 101 are tested. Nothing here reads files or prints.

mod histogram;
mod part;
pub mod racks;
mod random;
mod sobol;

pub use part::{PartSimulation, simulate_part};
pub(crate) use random::{Random, Ziggurat};
pub use sobol::{Estimate, RESAMPLES};

use thiserror::Error;

use crate::parallel;
use crate::uncertainty::{Distribution, Influence, Linear, Uncertainty, UncertaintyError};
use histogram::Histogram;

/// Draws per block; JCGM 101 asks for 10⁴ at least.
pub const BLOCK: u64 = 10_000;
/// Draws that are evaluated at a time: columns of this length stay in the fastest memory.
const CHUNK: usize = 250;
/// Blocks after which an adaptive simulation gives up refining.
const MOST_BLOCKS: u64 = 10_000;
/// Blocks of the first round.
const FIRST_BLOCKS: u64 = 10;
/// The probability of the intervals.
pub const PROBABILITY: f64 = 0.95;
/// The seed where none is given.
pub const DEFAULT_SEED: u64 = 1;
/// Significant digits of u where none are given, as JCGM 101 recommends.
pub const DEFAULT_DIGITS: u32 = 2;
/// The most draws that may be asked for.
pub const MOST_DRAWS: u64 = 2_000_000_000;

/// How to simulate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// The seed; the same one gives the same result.
    pub seed: u64,
    /// The number of draws; `None` for as many as the digits need.
    pub draws: Option<u64>,
    /// Significant digits of the standard uncertainty that shall hold, 1 to 4.
    pub digits: u32,
    /// Threads; `None` for one per core. Does not change the result.
    pub threads: Option<usize>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { seed: DEFAULT_SEED, draws: None, digits: DEFAULT_DIGITS, threads: None }
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
    /// The result held against the lower limit.
    pub low: usize,
    /// The result held against the upper limit.
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
    /// All that is asked of the distribution.
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

/// What a simulation gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The seed.
    pub seed: u64,
    /// Draws made.
    pub draws: u64,
    /// Digits asked for.
    pub digits: u32,
    /// Whether an adaptive simulation reached its digits; `None` if the number of draws was given.
    pub reached: Option<bool>,
    /// One per result.
    pub results: Vec<Simulation>,
    /// The share of the draws inside each band.
    pub inside: Vec<f64>,
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
    /// Whether neither does.
    pub validated: bool,
}

/// Holds a linear result against a simulated one, to `digits` digits of the standard uncertainty.
#[must_use]
pub fn validate(linear: &Linear, simulation: &Simulation, digits: u32) -> Validation {
    let half = linear.half_width_mm(PROBABILITY);
    let (low, high) = simulation.symmetric;
    let distances = half.map(|half| ((linear.value_mm - half - low).abs(), (linear.value_mm + half - high).abs()));
    let tolerance = tolerance(simulation.standard, digits);
    let validated = distances.is_some_and(|(low, high)| low <= tolerance && high <= tolerance);
    Validation { linear_half_width: half, distances, tolerance, validated }
}

/// Simulates `model` for draws of `variables`.
///
/// # Errors
/// [`MonteCarloError`] if the settings are out of range or a draw has no result.
pub fn simulate(
    model: &impl Simulated,
    variables: &Variables,
    bands: &[Band],
    settings: &Settings,
) -> Result<Outcome, MonteCarloError> {
    let check = |what, value, least, most| {
        if (least..=most).contains(&value) {
            Ok(())
        } else {
            Err(MonteCarloError::Setting { what, value, least, most })
        }
    };
    check("the number of digits", u64::from(settings.digits), 1, 4)?;
    if let Some(draws) = settings.draws {
        check("the number of draws", draws, 1, MOST_DRAWS)?;
    }
    let run = SimulationRun { model, variables, bands, settings, ziggurat: Ziggurat::new() };
    let pilot = run.pilot()?;
    let mut total = Tally::new(&pilot, bands.len());
    let mut blocks = Vec::new();
    let wanted = settings.draws.map(|draws| draws.div_ceil(BLOCK));
    let mut done = 0;
    let reached = loop {
        let upto = wanted.unwrap_or(if done == 0 { FIRST_BLOCKS } else { (2 * done).min(MOST_BLOCKS) });
        run.blocks(done, upto, &pilot, &mut total, &mut blocks);
        done = upto;
        if total.outside > 0 {
            let share = total.outside as f64 / (done * BLOCK) as f64;
            return Err(MonteCarloError::OutsideDomain { share });
        }
        if wanted.is_some() {
            break None;
        }
        if run.settled(&blocks, &pilot) {
            break Some(true);
        }
        if done >= MOST_BLOCKS {
            break Some(false);
        }
    };
    let draws = (done * BLOCK) as f64;
    let results = total
        .histograms
        .into_iter()
        .enumerate()
        .map(|(output, histogram)| {
            let (mean, standard) = moments(blocks.iter().map(|block| &block[output]), pilot[output].center);
            Simulation::of(histogram, mean, standard, draws)
        })
        .collect();
    let inside = total.inside.iter().map(|&count| count as f64 / draws).collect();
    Ok(Outcome { seed: settings.seed, draws: done * BLOCK, digits: settings.digits, reached, results, inside })
}

/// What the first block says about a result: where its values lie.
#[derive(Debug, Clone, Copy)]
struct Pilot {
    center: f64,
    low: f64,
    high: f64,
}

/// What a block says about a result, about the pilot's centre: sum, sum of squares, and the ends of the 95 % interval.
#[derive(Debug, Clone, Copy, Default)]
struct BlockSums {
    sum: f64,
    squares: f64,
    ends: (f64, f64),
}

/// Counts, of which the order does not matter.
#[derive(Debug)]
struct Tally {
    histograms: Vec<Histogram>,
    inside: Vec<u64>,
    outside: u64,
}

impl Tally {
    fn new(pilot: &[Pilot], bands: usize) -> Self {
        let histograms = pilot.iter().map(|pilot| Histogram::new(pilot.low, pilot.high)).collect();
        Self { histograms, inside: vec![0; bands], outside: 0 }
    }

    fn add(&mut self, other: &Self) {
        for (mine, theirs) in self.histograms.iter_mut().zip(&other.histograms) {
            mine.add(theirs);
        }
        for (mine, theirs) in self.inside.iter_mut().zip(&other.inside) {
            *mine += theirs;
        }
        self.outside += other.outside;
    }
}

/// Fills the columns of `inputs` with draws.
fn draw(variables: &Variables, random: &mut Random, ziggurat: &Ziggurat, inputs: &mut [Vec<f64>], scratch: &mut [f64]) {
    for ((value, uncertainty), column) in variables.variables.iter().zip(inputs.iter_mut()) {
        let (value, u) = (*value, uncertainty.standard);
        match uncertainty.distribution {
            // correlated variables are scaled after they are combined
            Distribution::Normal if variables.factor.is_some() && uncertainty.dof.is_infinite() => {
                column.fill_with(|| random.normal(ziggurat));
            }
            Distribution::Normal if uncertainty.dof.is_finite() => {
                column.fill_with(|| value + u * random.student(uncertainty.dof));
            }
            _ => column.fill_with(|| value + random.spread(uncertainty, ziggurat)),
        }
    }
    let Some(factor) = &variables.factor else { return };
    let rows = factor.chunks_exact(variables.variables.len());
    // from the last to the first, so that a column is still as drawn when another needs it
    for (i, row) in rows.enumerate().rev() {
        let (value, uncertainty) = variables.variables[i];
        if uncertainty.distribution != Distribution::Normal || uncertainty.dof.is_finite() {
            continue;
        }
        scratch.fill(0.0);
        for (&weight, drawn) in row[..=i].iter().zip(inputs.iter()) {
            if weight != 0.0 {
                for (sum, z) in scratch.iter_mut().zip(drawn) {
                    *sum += weight * z;
                }
            }
        }
        for (x, z) in inputs[i].iter_mut().zip(scratch.iter()) {
            *x = value + uncertainty.standard * z;
        }
    }
}

/// Mean and standard deviation of all blocks, added up in their order.
fn moments<'a>(blocks: impl Iterator<Item = &'a BlockSums>, center: f64) -> (f64, f64) {
    let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for block in blocks {
        let count = BLOCK as f64;
        n += count;
        sum += block.sum;
        squares += block.squares;
    }
    let mean = sum / n;
    (center + mean, ((squares - n * mean * mean) / (n - 1.0)).max(0.0).sqrt())
}

struct SimulationRun<'a, M> {
    model: &'a M,
    variables: &'a Variables,
    bands: &'a [Band],
    settings: &'a Settings,
    ziggurat: Ziggurat,
}

impl<M: Simulated> SimulationRun<'_, M> {
    /// Draws and evaluates a block, and shows the results of each chunk.
    fn block(&self, block: u64, columns: &mut Columns, mut see: impl FnMut(&[Vec<f64>])) {
        let mut random = Random::of_block(self.settings.seed, block);
        let Columns { inputs, outputs, scratch } = columns;
        for _ in 0..BLOCK / CHUNK as u64 {
            draw(self.variables, &mut random, &self.ziggurat, inputs, scratch);
            self.model.evaluate(inputs, outputs);
            see(outputs);
        }
    }

    /// Where the values of the first block lie.
    fn pilot(&self) -> Result<Vec<Pilot>, MonteCarloError> {
        let mut ends = vec![(f64::INFINITY, f64::NEG_INFINITY); self.model.outputs()];
        let mut outside = 0_u32;
        self.block(0, &mut Columns::new(self), |outputs| {
            for (end, column) in ends.iter_mut().zip(outputs) {
                for &value in column {
                    outside += u32::from(!value.is_finite());
                    *end = (end.0.min(value), end.1.max(value));
                }
            }
        });
        if outside > 0 {
            return Err(MonteCarloError::OutsideDomain { share: f64::from(outside) / BLOCK as f64 });
        }
        let pilot = ends.into_iter().map(|(low, high)| {
            let width = high - low;
            Pilot { center: 0.5 * (low + high), low: low - width, high: high + width }
        });
        Ok(pilot.collect())
    }

    /// Makes the blocks from `from` to before `upto`, on all threads.
    fn blocks(&self, from: u64, upto: u64, pilot: &[Pilot], total: &mut Tally, sums: &mut Vec<Vec<BlockSums>>) {
        let count = usize::try_from(upto - from).unwrap_or(usize::MAX);
        let threads = self.settings.threads.unwrap_or_else(parallel::cores);
        let (made, workers) = parallel::map(
            threads,
            count,
            || Worker::new(self, pilot),
            |worker, index| worker.block(self, from + index as u64, pilot),
        );
        for worker in &workers {
            total.add(&worker.tally);
        }
        sums.extend(made);
    }

    /// JCGM 101, 7.9.4: whether means, deviations and interval ends of the blocks agree to the digits of every result.
    fn settled(&self, blocks: &[Vec<BlockSums>], pilot: &[Pilot]) -> bool {
        let (count, n) = (blocks.len() as f64, BLOCK as f64);
        (0..pilot.len()).all(|output| {
            let (_, standard) = moments(blocks.iter().map(|block| &block[output]), pilot[output].center);
            // a result that does not vary has nothing to settle
            if standard == 0.0 {
                return true;
            }
            let tolerance = tolerance(standard, self.settings.digits) / 5.0;
            let statistics = |block: &BlockSums| {
                let mean = block.sum / n;
                [mean, ((block.squares - n * mean * mean) / (n - 1.0)).max(0.0).sqrt(), block.ends.0, block.ends.1]
            };
            (0..4).all(|which| {
                let values = || blocks.iter().map(|block| statistics(&block[output])[which]);
                let first = statistics(&blocks[0][output])[which];
                let mean = first + values().map(|value| value - first).sum::<f64>() / count;
                let squares: f64 = values().map(|value| value - mean).map(|d| d * d).sum();
                2.0 * (squares / (count * (count - 1.0))).sqrt() <= tolerance
            })
        })
    }
}

/// Memory for a chunk: a column for each variable and each result, and one more.
struct Columns {
    inputs: Vec<Vec<f64>>,
    outputs: Vec<Vec<f64>>,
    scratch: Vec<f64>,
}

impl Columns {
    fn new<M: Simulated>(run: &SimulationRun<'_, M>) -> Self {
        let columns = |count| vec![vec![0.0; CHUNK]; count];
        let inputs = columns(run.variables.variables.len());
        Self { inputs, outputs: columns(run.model.outputs()), scratch: vec![0.0; CHUNK] }
    }
}

/// One thread's memory and counts.
struct Worker {
    columns: Columns,
    /// A block's values of each result, where the ends of its interval are asked for.
    kept: Vec<Vec<f64>>,
    tally: Tally,
}

impl Worker {
    fn new<M: Simulated>(run: &SimulationRun<'_, M>, pilot: &[Pilot]) -> Self {
        let is_adaptive = run.settings.draws.is_none();
        Self {
            columns: Columns::new(run),
            kept: vec![Vec::new(); if is_adaptive { pilot.len() } else { 0 }],
            tally: Tally::new(pilot, run.bands.len()),
        }
    }

    fn block<M: Simulated>(&mut self, run: &SimulationRun<'_, M>, block: u64, pilot: &[Pilot]) -> Vec<BlockSums> {
        let Self { columns, kept, tally } = self;
        let mut sums = vec![BlockSums::default(); pilot.len()];
        kept.iter_mut().for_each(Vec::clear);
        run.block(block, columns, |outputs| {
            for (output, column) in outputs.iter().enumerate() {
                let center = pilot[output].center;
                let (mut sum, mut squares) = (0.0, 0.0);
                for value in column {
                    let d = value - center;
                    sum += d;
                    squares += d * d;
                }
                sums[output].sum += sum;
                sums[output].squares += squares;
                // a value that is no number makes the sum none
                if !sum.is_finite() {
                    tally.outside += column.iter().filter(|value| !value.is_finite()).count() as u64;
                }
                tally.histograms[output].count(column);
                if let Some(kept) = kept.get_mut(output) {
                    kept.extend_from_slice(column);
                }
            }
            for (band, inside) in run.bands.iter().zip(&mut tally.inside) {
                let pairs = outputs[band.low].iter().zip(&outputs[band.high]);
                *inside += pairs.filter(|(low, high)| **low >= band.lower && **high <= band.upper).count() as u64;
            }
        });
        for (sums, kept) in sums.iter_mut().zip(kept) {
            sums.ends = ends(kept);
        }
        sums
    }
}

/// The ends of the symmetric 95 % interval of a block's values.
fn ends(values: &mut [f64]) -> (f64, f64) {
    /// 2.5 % of a block.
    const RANK: usize = 250;
    let last = values.len() - 1 - RANK;
    let (_, low, above) = values.select_nth_unstable_by(RANK, f64::total_cmp);
    let low = *low;
    let (_, high, _) = above.select_nth_unstable_by(last - RANK - 1, f64::total_cmp);
    (low, *high)
}

#[cfg(test)]
mod tests;
