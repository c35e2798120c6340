#![doc = include_str!("roller_change.md")]
//!
//! # Example
//! ```
//! use rackmesh::formula::roller_change;
//!
//! let difference = roller_change::difference("4".parse()?, "3.5".parse()?, "20 deg".parse()?)?;
//! assert_eq!(format!("{:.3}", difference.mm()), "-0.981");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::over_pin::one_and_cosecant;
use super::{domain, femtometres};
use crate::quantity::{Angle, DomainError, Length};

/// ΔM = (D_2 − D_1)/2 · (1 + 1/sin α_n) when the roller D_1 = `from` is replaced by D_2 = `to`.
///
/// # Errors
/// [`DomainError`] if an input is outside its domain, or the result is beyond the largest length.
pub fn difference(from: Length, to: Length, normal_pressure_angle: Angle) -> Result<Length, DomainError> {
    domain::PIN_DIAMETER.check_length(from)?;
    domain::PIN_DIAMETER.check_length(to)?;
    domain::NORMAL_PRESSURE_ANGLE.check_angle(normal_pressure_angle)?;
    let fm = 0.5 * femtometres(to - from) * one_and_cosecant(normal_pressure_angle);
    Ok(Length::nearest(fm, "the difference ΔM")?)
}
