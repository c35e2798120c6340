#![doc = include_str!("method.md")]
//!
//! Called by the command line and the batch engine with the errors of a part and their uncertainties. Random draws are the
//! business of [`chance`](crate::chance), verdicts that of [`rule`](crate::judge::rule). [`Linear::folded`] names the errors
//! whose result is folded at zero.

mod coverage;
mod distribution;
pub(super) mod gear;
mod inputs;
mod propagation;
mod result;
mod teeth;
#[cfg(test)]
pub(super) mod tests;

pub use crate::formula::Influence;
pub use coverage::{COVERAGE, coverage_factor, effective_dof};
pub use distribution::{Distribution, Uncertainty};
pub use inputs::{Uncertainties, UncertaintyError, Unstated};
#[cfg(feature = "spec")]
pub(crate) use propagation::WITHIN;
pub use propagation::{Point, Propagator, UncertainPart, propagate};
pub use result::{EndWeights, InputContribution, Linear, Propagation, Spread, Spreads};
pub use teeth::{TeethSensitivity, VariedTeeth, teeth_sensitivities};

/// A magnitude whose error is nearer to zero than this many standard uncertainties is not linear: at three, the ends of
/// a 95 % interval are off by 0.0005 u, which two digits do not show.
pub const FOLD: f64 = 3.0;
