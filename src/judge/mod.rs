//! What errors do at worst, and what limits say of it.
//!
//! [`bound`] computes ranges of ΔCD that no placement of the errors leaves, [`reached`] finds placements that come near their
//! ends; a [`Stack`] is how errors combine, a [`Limit`] what the sum may be, a [`Rule`] how much uncertainty a verdict bears.
//! A [`Prediction`] is what the formulas say of deviations per tooth, a [`MeasuredPart`] of measured ones; [`strokes`] are those
//! at which deviated teeth can carry. [`mod@class`], [`class_mesh`] and [`grade`] say what a class of a standard comes to, by the
//! formulas and by the mesh, and which grade a part obtains.
//! Sums and comparisons are exact: a result equal to a limit in decimal arithmetic is inside it.
//!
//! Called by whoever gives a verdict; knows nothing of files or words of a report.

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
