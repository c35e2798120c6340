//! What errors can do at worst. [`bound`] computes ranges of ΔCD that no placement of the errors leaves, [`reached`] finds
//! placements that come near their ends.
//!
//! Called by whoever gives a verdict; knows nothing of files, limits or words of a report.

pub mod bound;
pub mod reached;
pub mod strokes;
