#![doc = include_str!("over_roller.md")]
//!
//! Derived in [`mesh::relations`](crate::mesh::relations), section 4.
//!
//! # Example
//! Table 3 of the paper:
//! ```
//! use rackmesh::formula::over_roller;
//! use rackmesh::quantity::Length;
//!
//! let (measured, nominal): (Length, Length) = ("25.0100".parse()?, "25.0000".parse()?);
//! assert_eq!(over_roller::delta_cd(&(&measured - &nominal)).mm(), 0.010);
//! # Ok::<(), rackmesh::quantity::QuantityError>(())
//! ```

use super::Sensitivity;
use crate::quantity::Length;

/// ΔCD of the over-roller error `M - M_nom`: the same length.
#[must_use]
pub fn delta_cd(error: &Length) -> Length {
    error.clone()
}

/// The over-roller error that moves the centre distance by `delta_cd`: the same length.
#[must_use]
pub fn largest_error(delta_cd: &Length) -> Length {
    delta_cd.clone()
}

/// ∂ΔCD/∂(M - M_nom) = 1.
#[must_use]
pub fn sensitivities() -> Vec<Sensitivity> {
    vec![Sensitivity::OF_SHIFT]
}
