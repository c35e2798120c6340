//! Operating centre distance of a rack and pinion, predicted from their manufacturing errors.

#[cfg(feature = "cli")]
pub mod cli;
pub mod decision;
pub mod deviation;
pub mod diagnostic;
pub mod formula;
pub mod quantity;
#[cfg(feature = "report")]
pub mod report;
#[cfg(feature = "spec")]
pub mod spec;
pub mod trig;
