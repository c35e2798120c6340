#![doc = include_str!("pinion_radial.md")]
//!
//! Derived in [`mesh::relations`](crate::mesh::relations), section 4.
//!
//! # Example
//! ```
//! use rackmesh::formula::pinion_radial;
//! use rackmesh::quantity::Length;
//!
//! let (measured, nominal): (Length, Length) = ("8.512".parse()?, "8.5".parse()?);
//! assert_eq!(pinion_radial::delta_cd(&(&measured - &nominal)).mm(), 0.012);
//! # Ok::<(), rackmesh::quantity::QuantityError>(())
//! ```

use super::Sensitivity;
use crate::quantity::Length;

/// ΔCD of the radial error `r - r_nom`: the same length.
#[must_use]
pub fn delta_cd(error: &Length) -> Length {
    error.clone()
}

/// The radial error that moves the centre distance by `delta_cd`: the same length.
#[must_use]
pub fn largest_error(delta_cd: &Length) -> Length {
    delta_cd.clone()
}

/// ∂ΔCD/∂(r - r_nom) = 1.
#[must_use]
pub fn sensitivities() -> Vec<Sensitivity> {
    vec![Sensitivity::OF_SHIFT]
}
