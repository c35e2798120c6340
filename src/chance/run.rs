//! A simulation block by block, on all threads. Counts do not depend on the order of blocks; sums are added in their order.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use super::histogram::Histogram;
use super::{
    BLOCK, Band, MOST_DRAWS, MonteCarloError, Outcome, Random, Settings, Simulated, Simulation, Variables, Ziggurat,
    tolerance,
};
use crate::parallel;
use crate::uncertainty::Distribution;

/// Draws that are evaluated at a time: columns of this length stay in the fastest memory.
const CHUNK: usize = 250;
/// Blocks of the first round.
const FIRST_BLOCKS: u64 = 10;

/// Sees how much of a simulation is done, 0 to 1; `None` before that is known.
pub(crate) type Watch<'a> = dyn Fn(Option<f64>) + Sync + 'a;

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
    simulate_watched(model, variables, bands, settings, &|_| {})
}

/// The same, with a look at how much is done: of an adaptive simulation, of the blocks that the spread of those made so far asks for.
pub(crate) fn simulate_watched(
    model: &impl Simulated,
    variables: &Variables,
    bands: &[Band],
    settings: &Settings,
    watch: &Watch<'_>,
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
    check("the most draws without a number", settings.most_draws, 2 * BLOCK, MOST_DRAWS)?;
    let most = settings.most_draws / BLOCK;
    let run = SimulationRun { model, variables, bands, settings, ziggurat: Ziggurat::new() };
    let pilot = run.pilot()?;
    let mut total = Tally::new(&pilot, bands.len());
    let mut blocks = Vec::new();
    let wanted = settings.draws.map(|draws| draws.div_ceil(BLOCK));
    let (mut done, mut expected) = (0, wanted);
    let excess = loop {
        let next = if done == 0 { FIRST_BLOCKS } else { 2 * done };
        let upto = wanted.unwrap_or(next.min(most));
        let seen = |made: u64| watch(expected.map(|all| (done + made) as f64 / all as f64));
        run.blocks(done..upto, &pilot, &mut total, &mut blocks, &seen);
        done = upto;
        if total.outside > 0 {
            let share = total.outside as f64 / (done * BLOCK) as f64;
            return Err(MonteCarloError::OutsideDomain { share });
        }
        if wanted.is_some() {
            break None;
        }
        let excess = run.excess(&blocks, &pilot);
        if excess <= 1.0 || done >= most {
            break Some(excess);
        }
        expected = Some(blocks_for(done, excess, most));
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
    Ok(Outcome { seed: settings.seed, draws: done * BLOCK, digits: settings.digits, excess, results, inside })
}

/// The range of a result's values in the first block.
#[derive(Debug, Clone, Copy)]
struct Pilot {
    center: f64,
    low: f64,
    high: f64,
}

/// Sums of a block about the pilot's centre for a result: sum, sum of squares, and the ends of the 95 % interval.
#[derive(Debug, Clone, Copy, Default)]
struct BlockSums {
    sum: f64,
    squares: f64,
    ends: (f64, f64),
}

/// Counts, which do not depend on an order.
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
    // from the last to the first, so that a column still has its draws when another one needs them
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
    fn blocks(
        &self,
        range: Range<u64>,
        pilot: &[Pilot],
        total: &mut Tally,
        sums: &mut Vec<Vec<BlockSums>>,
        seen: &(impl Fn(u64) + Sync),
    ) {
        let count = usize::try_from(range.end - range.start).unwrap_or(usize::MAX);
        let made = AtomicU64::new(0);
        let threads = self.settings.threads.unwrap_or_else(parallel::cores);
        let (made, workers) = parallel::map(
            threads,
            count,
            || Worker::new(self, pilot),
            |worker, index| {
                let sums = worker.block(self, range.start + index as u64, pilot);
                seen(1 + made.fetch_add(1, Ordering::Relaxed));
                sums
            },
        );
        for worker in &workers {
            total.add(&worker.tally);
        }
        sums.extend(made);
    }

    /// JCGM 101, 7.9.4: how many times its tolerance the least certain of means, deviations and interval ends of the blocks is off;
    /// at most 1 where they agree to the digits of every result.
    fn excess(&self, blocks: &[Vec<BlockSums>], pilot: &[Pilot]) -> f64 {
        let (count, n) = (blocks.len() as f64, BLOCK as f64);
        let of_output = |output: usize| {
            let (_, standard) = moments(blocks.iter().map(|block| &block[output]), pilot[output].center);
            // a result that does not vary has nothing to settle
            if standard == 0.0 {
                return 0.0;
            }
            let tolerance = tolerance(standard, self.settings.digits) / 5.0;
            let statistics = |block: &BlockSums| {
                let mean = block.sum / n;
                [mean, ((block.squares - n * mean * mean) / (n - 1.0)).max(0.0).sqrt(), block.ends.0, block.ends.1]
            };
            let error = |which: usize| {
                let values = || blocks.iter().map(|block| statistics(&block[output])[which]);
                let first = statistics(&blocks[0][output])[which];
                let mean = first + values().map(|value| value - first).sum::<f64>() / count;
                let squares: f64 = values().map(|value| value - mean).map(|d| d * d).sum();
                2.0 * (squares / (count * (count - 1.0))).sqrt() / tolerance
            };
            (0..4).map(error).fold(0.0, largest)
        };
        (0..pilot.len()).map(of_output).fold(0.0, largest)
    }
}

/// The larger one, or what is no number.
fn largest(one: f64, other: f64) -> f64 {
    if other.is_nan() || other > one { other } else { one }
}

/// The blocks after which an adaptive simulation is settled, or ends at the `most`, if `done` leave it off by `excess` times the
/// tolerance: errors shrink with the root of the number, which doubles.
fn blocks_for(done: u64, excess: f64, most: u64) -> u64 {
    let needed = done as f64 * excess * excess;
    let mut upto = done;
    while (upto as f64) < needed && upto < most {
        upto = (2 * upto).min(most);
    }
    upto
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
                // a NaN makes the sum NaN
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
