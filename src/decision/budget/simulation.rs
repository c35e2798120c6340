//! Random assemblies: which fraction conforms.
//!
//! Each error is drawn from its distribution within plus and minus its tolerance, independently of the others. An
//! assembly conforms if the range of its ΔCD — over-roller and radial errors always, pitch and lead errors between
//! nothing and their value — lies inside the limit, which is what `eval` judges of measured parts. The draws are the
//! same for every set of tolerances and depend on the seed and the number of errors only, so that fractions can be
//! compared and repeated; blocks of draws have generators of their own, so that the number of threads does not matter.

use super::{BudgetError, Entry, Request};
use crate::decision::monte_carlo::{BLOCK, Random, Ziggurat};
use crate::deviation::ErrorKind;
use crate::formula::{Law, Model, PartError};
use crate::parallel;
use crate::quantity::Length;

/// How errors spread within their tolerances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Spread {
    /// Every value alike: all that is known is the tolerance.
    #[default]
    Uniform,
    /// Normal with a standard deviation of a third of the tolerance; parts beyond it are sorted out.
    Normal,
    /// Triangular with its peak at nominal.
    Triangular,
}

impl Spread {
    /// `uniform`, `normal` or `triangular`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Normal => "normal",
            Self::Triangular => "triangular",
        }
    }
}

/// What is simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simulation {
    /// The fraction of assemblies that must conform, above 0 and at most 1.
    pub conforming: f64,
    /// How errors spread.
    pub spread: Spread,
    /// The number of assemblies.
    pub draws: u32,
    /// The seed.
    pub seed: u64,
}

impl Simulation {
    /// What 3 σ leave of a normal distribution: 99.73 %.
    pub const CONFORMING: f64 = 0.9973;
    /// So many that 1 % of one tolerance is seen in the tail of 0.27 %.
    pub const DRAWS: u32 = 1_000_000;
}

/// What came of a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simulated {
    /// What was simulated.
    pub settings: Simulation,
    /// The fraction that conforms.
    pub conforming: f64,
}

/// The draws for one request.
#[derive(Debug)]
pub(super) struct Assembly {
    settings: Simulation,
    model: Model,
    lower_mm: f64,
    upper_mm: f64,
    kinds: Vec<ErrorKind>,
    /// Per block, per error: draws in −1 … +1.
    blocks: Vec<Vec<Vec<f64>>>,
}

impl Assembly {
    pub(super) fn new(request: &Request, settings: &Simulation) -> Self {
        let kinds: Vec<ErrorKind> = request.entries.iter().map(Entry::kind).collect();
        let draws = u64::from(settings.draws.max(1));
        let ziggurat = Ziggurat::new();
        let blocks = (0..draws.div_ceil(BLOCK))
            .map(|block| {
                let mut random = Random::of_block(settings.seed, block);
                let count = BLOCK.min(draws - block * BLOCK);
                let column = || (0..count).map(|_| draw(&mut random, &ziggurat, settings.spread)).collect();
                std::iter::repeat_with(column).take(kinds.len()).collect()
            })
            .collect();
        Self {
            settings: *settings,
            model: request.model,
            lower_mm: request.limit.lower.map_or(f64::NEG_INFINITY, Length::mm),
            upper_mm: request.limit.upper.map_or(f64::INFINITY, Length::mm),
            kinds,
            blocks,
        }
    }

    /// How many assemblies must conform.
    pub(super) fn needed(&self) -> u64 {
        let share = self.settings.conforming * f64::from(self.settings.draws);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most the number of draws")]
        let needed = share.ceil() as u64;
        needed
    }

    /// How many assemblies with these tolerances conform.
    pub(super) fn count(&self, errors: &[PartError]) -> u64 {
        let tolerances: Vec<(Law, f64)> =
            errors.iter().map(|error| (error.law(), error.value().abs().base())).collect();
        let count = |(): &mut (), index: usize| self.count_block(&self.blocks[index], &tolerances);
        parallel::map(parallel::cores(), self.blocks.len(), || (), count).0.into_iter().sum()
    }

    fn count_block(&self, block: &[Vec<f64>], tolerances: &[(Law, f64)]) -> u64 {
        let draws = block.first().map_or(0, Vec::len);
        let (mut lower, mut upper) = (vec![0.0; draws], vec![0.0; draws]);
        for ((kind, column), (law, tolerance)) in self.kinds.iter().zip(block).zip(tolerances) {
            if *tolerance == 0.0 {
                continue;
            }
            let always = kind.always_acts();
            for ((u, lower), upper) in column.iter().zip(&mut lower).zip(&mut upper) {
                let delta_cd = law.delta_cd_mm(u * tolerance, self.model);
                *upper += delta_cd;
                if always {
                    *lower += delta_cd;
                }
            }
        }
        let inside = lower.iter().zip(&upper).filter(|(low, high)| **low >= self.lower_mm && **high <= self.upper_mm);
        inside.count() as u64
    }

    pub(super) fn outcome(&self, errors: &[PartError]) -> Simulated {
        #[expect(clippy::cast_precision_loss, reason = "at most 2³²")]
        let conforming = self.count(errors) as f64 / f64::from(self.settings.draws.max(1));
        Simulated { settings: self.settings, conforming }
    }
}

/// A draw in −1 … +1.
fn draw(random: &mut Random, ziggurat: &Ziggurat, spread: Spread) -> f64 {
    match spread {
        Spread::Uniform => 2.0 * random.uniform() - 1.0,
        Spread::Triangular => random.uniform() - random.uniform(),
        Spread::Normal => loop {
            let value = random.normal(ziggurat) / 3.0;
            if value.abs() <= 1.0 {
                break value;
            }
        },
    }
}

/// The errors at the largest scale at which they conform; those of scale 0 do.
pub(super) fn largest_scale(
    at: impl Fn(f64) -> Result<Vec<PartError>, BudgetError>,
    conforms: impl Fn(&[PartError]) -> bool,
) -> Result<Vec<PartError>, BudgetError> {
    const LARGEST_MM: f64 = 1e3;
    /// The interval of the scale becomes this narrow, relative to itself: far below the 1 % that must be felt.
    const NARROW: f64 = 1e-9;
    let (mut low, mut high) = (0.0, 1e-3);
    let mut best = at(low)?;
    loop {
        let errors = at(high)?;
        if !conforms(&errors) {
            break;
        }
        if high > LARGEST_MM {
            return Err(BudgetError::Unbounded);
        }
        (low, high, best) = (high, 2.0 * high, errors);
    }
    while high - low > NARROW * high {
        let middle = 0.5 * (low + high);
        let errors = at(middle)?;
        if conforms(&errors) {
            (low, best) = (middle, errors);
        } else {
            high = middle;
        }
        if high < 1e-12 {
            break;
        }
    }
    Ok(best)
}
