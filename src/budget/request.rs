//! The demand and the result of a budget; computes nothing.

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
    /// Random assemblies, a fraction of which must conform.
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
    /// A weight: ΔCD is in proportion to it.
    Weight(f64),
    /// A relative cost, inverse to the tolerance: ΔCD is chosen so that the sum of costs is smallest.
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
    /// The error with a tolerance of this size.
    pub(super) fn within(&self, value: DeviationValue) -> PartDeviation {
        PartDeviation::within(self.law, value).with_extent(self.extent)
    }
}

/// One error of a budget.
#[derive(Debug, Clone, Copy)]
pub enum Entry {
    /// Its tolerance is fixed: the error lies within ± its value.
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
    /// The model of the formulas.
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
    /// The range of its ΔCD alone, on any teeth that its extent allows.
    pub range: Interval,
    /// Whether the tolerance was given.
    pub is_fixed: bool,
    /// Whether the error's own limit stops the tolerance, in place of the limit of ΔCD.
    pub at_own_limit: bool,
    /// Its share of the sum of the errors' ΔCD alone, or of the sum of their squares.
    pub share: f64,
    /// ∂ΔCD/∂input at the tolerance.
    pub sensitivities: Vec<Sensitivity>,
}

/// A finished budget.
#[derive(Debug, Clone)]
pub struct Budget {
    /// One per error.
    pub lines: Vec<Line>,
    /// The combined ΔCD of the tolerances, as by `eval`.
    pub combined: Combined<Interval>,
    /// The assumptions of the bound.
    pub notes: Vec<Note>,
    /// The fraction of random assemblies that conforms, if they were simulated.
    pub conforming: Option<f64>,
    /// Errors without which the fixed tolerances leave something to the free ones; empty if the budget is feasible.
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
    /// The pair without errors breaks the limit of ΔCD, or leaves no room in it.
    #[error(
        "the limit of ΔCD leaves nothing to distribute: the pair without errors must lie inside it, with room to the sides that the errors move ΔCD to"
    )]
    NoRoom,
    /// Tolerances of every tooth have no bound.
    #[error(transparent)]
    NoBound(#[from] NoBound),
    /// The limit does not stop the free tolerances.
    #[error(
        "the limit does not stop the free tolerances as long as the pair meshes: give it an upper end, or a nearer one"
    )]
    Unbounded,
    /// The limit of ΔCD has neither a lower nor an upper end.
    #[error("a budget needs a limit of the combined ΔCD")]
    NoLimit,
    /// A formula or a combination has no result.
    #[error(transparent)]
    NoResult(#[from] EvaluationError),
}

named! {
    /// The distribution of an error within its tolerance.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    #[non_exhaustive]
    pub enum ToleranceDistribution {
        /// All values within the tolerance are equally probable.
        #[default]
        Uniform = "uniform",
        /// Normal, with a standard deviation of a third of the tolerance; parts outside the tolerance are sorted out.
        Normal = "normal",
        /// Triangular with its peak at nominal.
        Triangular = "triangular",
    }
}

impl ToleranceDistribution {
    /// The distribution of this name; uniform for any other name.
    #[must_use]
    pub fn of_name(name: &str) -> Self {
        [Self::Normal, Self::Triangular].into_iter().find(|spread| spread.name() == name).unwrap_or_default()
    }
}

/// Random assemblies, a fraction of which must conform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomAssemblies {
    /// The fraction of assemblies that must conform, above 0 and at most 1.
    pub conforming: f64,
    /// The distribution of each error.
    pub spread: ToleranceDistribution,
    /// The number of assemblies.
    pub draws: u32,
    /// The seed.
    pub seed: u64,
}

impl RandomAssemblies {
    /// The usual fraction: 99.73 %, that of a normal distribution within ± 3 σ.
    pub const CONFORMING: f64 = 0.9973;
    /// The usual number of assemblies: enough that 1 % more of one tolerance shows in the tail of 0.27 %.
    pub const DRAWS: u32 = 1_000_000;
}

/// Tolerances and their scale.
#[derive(Debug, Clone)]
pub(super) struct Allocated {
    pub(super) scale: f64,
    pub(super) errors: Vec<PartDeviation>,
}
