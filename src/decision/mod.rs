//! From ΔCD values to a verdict: combining errors, and judging against limits.
//!
//! The command line calls [`evaluate`]; it takes errors with their formulas
//! ([`PartError`](crate::formula::PartError)) and limits, and gives an [`Evaluation`], which the report
//! module writes. Sums and comparisons are exact: a result equal to a limit in decimal arithmetic is
//! inside it. Nothing here reads files or prints.

pub mod budget;
pub mod capability;
pub mod class;
pub mod class_mesh;
mod evaluation;
pub mod grade;
mod limit;
mod measured;
pub mod monte_carlo;
mod prediction;
pub mod rule;
mod stack;
pub mod statistics;
pub mod uncertainty;

#[cfg(feature = "batch")]
pub(crate) use evaluation::overall;
pub use evaluation::{Contribution, Evaluation, EvaluationError, JudgedBy, LimitCheck, Unjudged, evaluate};
pub use limit::{Limit, LimitTarget, Limits, Verdict};
pub use measured::{Effect, Feature, MeasuredPart, MeasuredRow};
pub use prediction::{Predicted, Prediction};
pub use rule::Rule;
pub use stack::{Combined, Interval, Stack};
