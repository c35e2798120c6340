#![doc = include_str!("ideal_pin.md")]
//!
//! # Example
//! ```
//! use rackmesh::formula::ideal_pin;
//!
//! let diameter = ideal_pin::diameter("2".parse()?, "20 deg".parse()?, None)?;
//! assert_eq!(format!("{:.3}", diameter.mm()), "3.343");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::{domain, femtometres};
use crate::quantity::{Angle, DomainError, Length};
use crate::trig;

/// The ideal pin diameter d_p' = (π m_n − s_n) / cos α_n; s_n = π m_n / 2 if `None`.
///
/// # Errors
/// [`DomainError`] if an input is outside its domain, or the result is beyond the largest length.
pub fn diameter(
    normal_module: Length,
    normal_pressure_angle: Angle,
    tooth_thickness: Option<Length>,
) -> Result<Length, DomainError> {
    domain::NORMAL_PRESSURE_ANGLE.check_angle(normal_pressure_angle)?;
    let fm = space_width_fm(normal_module, tooth_thickness)? / trig::sin_cos_of(normal_pressure_angle).1;
    Ok(Length::nearest(fm, "the pin diameter d_p'")?)
}

/// The width of the tooth space at the pitch line, π m_n − s_n, in fm.
pub(super) fn space_width_fm(normal_module: Length, tooth_thickness: Option<Length>) -> Result<f64, DomainError> {
    let pitch = domain::normal_pitch_fm(normal_module)?;
    Ok(match tooth_thickness {
        None => 0.5 * pitch,
        Some(thickness) => pitch - femtometres(domain::checked_thickness(thickness, pitch)?),
    })
}

/// ∂(π m_n − s_n)/∂m_n: π, or π/2 if the tooth thickness follows the module.
pub(super) fn space_per_module(thickness_is_given: bool) -> f64 {
    if thickness_is_given { std::f64::consts::PI } else { 0.5 * std::f64::consts::PI }
}
