//! What is wrong with a part.
//!
//! For the formulas, one value per kind of error ([`ErrorKind`]).

mod kind;

pub use kind::{ErrorKind, ErrorValue};
