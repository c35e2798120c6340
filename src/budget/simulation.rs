//! Random assemblies: the fraction that conforms.
//!
//! Each error is drawn from its distribution within ± its tolerance, independently of the others. An assembly conforms if the
//! worst case of its errors lies inside the limit, as `eval` judges it. If a tolerance is of each tooth, a drawn size or lead
//! is on every tooth, and a drawn pitch deviation is the largest, of any sign, on every tooth. With another extent the drawn
//! error has that extent.
//!
//! The draws depend only on the seed and the number of errors. They are the same for every set of tolerances, so that
//! fractions can be compared and repeated. Each block of draws has a generator of its own, so that the number of threads does
//! not change the result.

use super::request::{Allocated, BudgetError, RandomAssemblies, Request, ToleranceDistribution};
use crate::chance::{BLOCK, Random, Ziggurat};
use crate::deviation::{DeviationKind, Extent};
use crate::formula::PartDeviation;
use crate::judge::bound::{Basis, NoBound, Range, Scales};
use crate::parallel;
use crate::quantity::Length;

/// The draws for one request.
#[derive(Debug)]
pub(super) struct Assembly {
    settings: RandomAssemblies,
    limit: Range,
    basis: Basis,
    /// The draws of each error of each block, in −1 … +1.
    blocks: Vec<Vec<Vec<f64>>>,
}

impl Assembly {
    pub(super) fn new(request: &Request, settings: &RandomAssemblies) -> Self {
        let draws = u64::from(settings.draws.max(1));
        let ziggurat = Ziggurat::new();
        let blocks = (0..draws.div_ceil(BLOCK))
            .map(|block| {
                let mut random = Random::of_block(settings.seed, block);
                let count = BLOCK.min(draws - block * BLOCK);
                let column = || (0..count).map(|_| draw(&mut random, &ziggurat, settings.spread)).collect();
                std::iter::repeat_with(column).take(request.entries.len()).collect()
            })
            .collect();
        let limit = Range {
            lower: request.limit.lower.map_or(f64::NEG_INFINITY, Length::mm),
            upper: request.limit.upper.map_or(f64::INFINITY, Length::mm),
        };
        Self { settings: *settings, limit, basis: request.basis.clone(), blocks }
    }

    /// How many assemblies must conform.
    pub(super) fn needed(&self) -> u64 {
        let share = self.settings.conforming * f64::from(self.settings.draws);

        share.ceil() as u64
    }

    /// How many assemblies with these tolerances conform.
    pub(super) fn count(&self, errors: &[PartDeviation]) -> Result<u64, NoBound> {
        let drawn: Vec<_> = errors.iter().map(|error| error.measured().with_extent(drawn_extent(error))).collect();
        let scales = self.basis.scales(&drawn)?;
        let count = |(): &mut (), index: usize| self.count_block(&self.blocks[index], &scales);
        Ok(parallel::map(parallel::cores(), self.blocks.len(), || (), count).0.into_iter().sum())
    }

    fn count_block(&self, block: &[Vec<f64>], scales: &Scales) -> u64 {
        /// Tolerance for the rounding errors of a sum that meets a limit exactly, mm.
        const ROUNDING_MM: f64 = 1e-12;
        let draws = block.first().map_or(0, Vec::len);
        let mut shares = vec![0.0; block.len()];
        let mut inside = 0;
        for draw in 0..draws {
            for (share, column) in shares.iter_mut().zip(block) {
                *share = column[draw];
            }
            let range = scales.total(&shares);
            if range.lower >= self.limit.lower - ROUNDING_MM && range.upper <= self.limit.upper + ROUNDING_MM {
                inside += 1;
            }
        }
        inside
    }

    /// The fraction of assemblies with these tolerances that conforms.
    pub(super) fn conforming(&self, errors: &[PartDeviation]) -> Result<f64, NoBound> {
        Ok(self.count(errors)? as f64 / f64::from(self.settings.draws.max(1)))
    }
}

/// The extent of a drawn error: with a tolerance of each tooth, a size or lead is on all teeth, and a pitch deviation is the
/// largest on each.
const fn drawn_extent(tolerance: &PartDeviation) -> Extent {
    match (tolerance.extent(), tolerance.kind()) {
        (Extent::Each, DeviationKind::RackPitch | DeviationKind::PinionPitch) => Extent::Each,
        (Extent::Each, _) => Extent::All,
        (extent, _) => extent,
    }
}

/// A draw in −1 … +1.
fn draw(random: &mut Random, ziggurat: &Ziggurat, spread: ToleranceDistribution) -> f64 {
    match spread {
        ToleranceDistribution::Uniform => 2.0 * random.uniform() - 1.0,
        ToleranceDistribution::Triangular => random.uniform() - random.uniform(),
        ToleranceDistribution::Normal => loop {
            let value = random.normal(ziggurat) / 3.0;
            if value.abs() <= 1.0 {
                break value;
            }
        },
    }
}

/// The errors at the largest scale at which they conform; at scale 0 they do.
///
/// # Errors
/// [`BudgetError::Unbounded`] if they conform at every scale that has a bound.
pub(super) fn largest_scale(
    at: impl Fn(f64) -> Result<Vec<PartDeviation>, BudgetError>,
    conforms: impl Fn(&[PartDeviation]) -> Result<bool, NoBound>,
) -> Result<Allocated, BudgetError> {
    const LARGEST_MM: f64 = 1e3;
    /// The search ends when the interval of the scale is this narrow, relative to its upper end.
    const NARROW: f64 = 1e-10;
    /// A scale below the smallest length, mm, at which the search ends.
    const NOTHING_MM: f64 = 1e-13;
    // errors that conform, or whether the limit stops them; otherwise errors as large have no bound
    let tried = |scale: f64| match at(scale) {
        Ok(errors) => Ok(match conforms(&errors) {
            Ok(true) => Ok(Allocated { scale, errors }),
            stopped => Err(stopped.is_ok()),
        }),
        // no error has as large a ΔCD
        Err(BudgetError::Unbounded) => Ok(Err(false)),
        Err(error) => Err(error),
    };
    let mut best = Allocated { scale: 0.0, errors: at(0.0)? };
    let mut high = 1e-3;
    let mut is_stopped = loop {
        match tried(high)? {
            Ok(_) if high > LARGEST_MM => return Err(BudgetError::Unbounded),
            Ok(allocated) => (best, high) = (allocated, 2.0 * high),
            Err(is_stopped) => break is_stopped,
        }
    };
    while high - best.scale > NARROW * high && high > NOTHING_MM {
        let middle = 0.5 * (best.scale + high);
        match tried(middle)? {
            Ok(allocated) => best = allocated,
            Err(stopped) => (high, is_stopped) = (middle, stopped),
        }
    }
    if is_stopped { Ok(best) } else { Err(BudgetError::Unbounded) }
}
