//! The worst that errors can do, and the verdict of limits on it.
//!
//! [`bound`] computes ranges of ΔCD that no placement of the errors leaves, [`reached`] finds placements that come near their
//! ends. A [`Stack`] says how errors combine, a [`Limit`] what the sum may be, a [`Rule`] how a verdict treats uncertainty.
//! A [`Prediction`] has the formulas' ΔCD of deviations per tooth, a [`MeasuredPart`] that of measured ones; [`strokes`] finds
//! the strokes at which deviated teeth can carry. [`mod@class`], [`class_mesh`] and [`grade`] say what ΔCD a class of a standard
//! allows, by the formulas and by the mesh, and which grade a part reaches. Sums and comparisons are exact: a result equal
//! to a limit in decimal arithmetic is inside it.
//!
//! Every command that gives a verdict calls it; it knows nothing of files or words of a report.

pub mod bound;
pub mod class;
pub mod class_mesh;
pub mod grade;
mod limit;
mod measured;
mod prediction;
pub mod reached;
pub mod rule;
mod stack;
pub mod strokes;

pub use bound::Combined;
pub use limit::{Limit, LimitTarget, Limits, NearestEnd, Verdict};
pub use measured::{Effect, Feature, MeasuredPart, MeasuredRow};
pub use prediction::{PlacedError, Predicted, Prediction};
pub use rule::{Rule, RuleError};
pub use stack::{Interval, Stack};
