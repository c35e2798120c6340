//! What a budget asks for and what comes of it; computes nothing.

use thiserror::Error;

use crate::deviation::{DeviationKind, DeviationValue, Extent};
use crate::evaluation::EvaluationError;
use crate::formula::{Law, Model, PartDeviation, Sensitivity};
use crate::judge::bound::{Basis, NoBound, Note};
use crate::judge::{Combined, Interval, Limit};
use crate::quantity::Length;

/// How tolerances add up.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Summation {
    /// The worst case.
    WorstCase,
    /// The statistical sum.
    Rss,
    /// A fraction of random assemblies.
    Simulation(RandomAssemblies),
}

impl Summation {
    /// `worst`, `rss` or `simulation`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::WorstCase => "worst",
            Self::Rss => "rss",
            Self::Simulation(_) => "simulation",
        }
    }
}

/// What decides the size of a free tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Freedom {
    /// A weight: ΔCD in this ratio.
    Weight(f64),
    /// A relative cost: ΔCD where the sum of costs is smallest.
    Cost(f64),
}

/// A tolerance that is sought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Free {
    /// The law of its error.
    pub law: Law,
    /// What decides its size.
    pub freedom: Freedom,
    /// On which teeth the error may be.
    pub extent: Extent,
}

impl Free {
    /// The tolerance of this size.
    pub(super) fn within(&self, value: DeviationValue) -> PartDeviation {
        PartDeviation::within(self.law, value).with_extent(self.extent)
    }
}

/// One error of a budget.
#[derive(Debug, Clone, Copy)]
pub enum Entry {
    /// Its tolerance is fixed: the error lies within plus and minus its value.
    Fixed(PartDeviation),
    /// Its tolerance is sought.
    Free(Free),
}

impl Entry {
    /// The kind of error.
    #[must_use]
    pub fn kind(&self) -> DeviationKind {
        match self {
            Self::Fixed(error) => error.kind(),
            Self::Free(free) => free.law.kind(),
        }
    }
}

/// A budget's demand.
#[derive(Debug, Clone)]
pub struct Request {
    /// The errors.
    pub entries: Vec<Entry>,
    /// The limit of the combined ΔCD.
    pub limit: Limit,
    /// Limits of single errors' ΔCD.
    pub own_limits: Vec<(DeviationKind, Limit)>,
    /// How tolerances add up.
    pub rule: Summation,
    /// The formulas' reading.
    pub model: Model,
    /// What is known of the pair.
    pub basis: Basis,
}

/// One error of a finished budget.
#[derive(Debug, Clone)]
pub struct Line {
    /// The error with its tolerance.
    pub error: PartDeviation,
    /// Its ΔCD.
    pub delta_cd: Length,
    /// What it can do alone, wherever it is.
    pub range: Interval,
    /// Whether the tolerance was given.
    pub is_fixed: bool,
    /// Whether the error's own limit, not the budget, stops it.
    pub at_own_limit: bool,
    /// Its part of the sum of what the errors do alone, or of the squares of it.
    pub share: f64,
    /// ∂ΔCD/∂input at the tolerance.
    pub sensitivities: Vec<Sensitivity>,
}

/// A finished budget.
#[derive(Debug, Clone)]
pub struct Budget {
    /// One per error.
    pub lines: Vec<Line>,
    /// The tolerances combined as `eval` does.
    pub combined: Combined<Interval>,
    /// What their bound rests on.
    pub notes: Vec<Note>,
    /// The fraction of random assemblies that conforms, if it was simulated.
    pub conforming: Option<f64>,
    /// Errors without which the fixed tolerances would leave something: empty if the budget is feasible.
    pub broken_by: Vec<DeviationKind>,
}

impl Budget {
    /// Whether the limit is met.
    #[must_use]
    pub fn is_feasible(&self) -> bool {
        self.broken_by.is_empty()
    }
}

/// Why there is no budget at all.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BudgetError {
    /// The limit does not allow ΔCD to be zero, or allows nothing else.
    #[error(
        "the limit of ΔCD leaves nothing to distribute: the pair without errors must lie inside it, with room to the sides that the errors move ΔCD to"
    )]
    NoRoom,
    /// Tolerances of every tooth have no bound.
    #[error(transparent)]
    NoBound(#[from] NoBound),
    /// Nothing stops the free tolerances.
    #[error(
        "the limit does not stop the free tolerances as long as the pair meshes: give it an upper end, or a nearer one"
    )]
    Unbounded,
    /// The limit of ΔCD has no end.
    #[error("a budget needs a limit of the combined ΔCD")]
    NoLimit,
    /// A formula or a combination has no result.
    #[error(transparent)]
    NoResult(#[from] EvaluationError),
}

named! {
    /// How errors spread within their tolerances.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    #[non_exhaustive]
    pub enum ToleranceDistribution {
        /// Every value alike: all that is known is the tolerance.
        #[default]
        Uniform = "uniform",
        /// Normal with a standard deviation of a third of the tolerance; parts beyond it are sorted out.
        Normal = "normal",
        /// Triangular with its peak at nominal.
        Triangular = "triangular",
    }
}

impl ToleranceDistribution {
    /// The one that is called so, or the usual one.
    #[must_use]
    pub fn of_name(name: &str) -> Self {
        [Self::Normal, Self::Triangular].into_iter().find(|spread| spread.name() == name).unwrap_or_default()
    }
}

/// Random assemblies, some of which must conform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomAssemblies {
    /// The fraction of assemblies that must conform, above 0 and at most 1.
    pub conforming: f64,
    /// How errors spread.
    pub spread: ToleranceDistribution,
    /// The number of assemblies.
    pub draws: u32,
    /// The seed.
    pub seed: u64,
}

impl RandomAssemblies {
    /// What 3 σ leave of a normal distribution: 99.73 %.
    pub const CONFORMING: f64 = 0.9973;
    /// So many that 1 % of one tolerance is seen in the tail of 0.27 %.
    pub const DRAWS: u32 = 1_000_000;
}

/// Tolerances and the scale that they stand for.
#[derive(Debug, Clone)]
pub(super) struct Allocated {
    pub(super) scale: f64,
    pub(super) errors: Vec<PartDeviation>,
}
