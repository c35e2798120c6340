#![doc = include_str!("ideal_pin.md")]
//!
//! # Example
//! ```
//! use rackmesh::formula::ideal_pin;
//!
//! let diameter = ideal_pin::diameter(&"2".parse()?, &"20 deg".parse()?, None)?;
//! assert_eq!(format!("{:.3}", diameter.mm()), "3.343");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::{Input, Sensitivity, domain, per_degree, result_mm};
use crate::quantity::{Angle, DomainError, Length, Rational};
use crate::trig::precise;

/// The ideal pin diameter d_p' = (π m_n − s_n) / cos α_n; s_n = π m_n / 2 if `None`.
///
/// # Errors
/// [`DomainError`] if an input is outside its domain, or the result is beyond the range of `f64`.
pub fn diameter(
    normal_module: &Length,
    normal_pressure_angle: &Angle,
    tooth_thickness: Option<&Length>,
) -> Result<Length, DomainError> {
    result_mm(&exact_diameter(normal_module, normal_pressure_angle, tooth_thickness)?, "the pin diameter d_p'")
}

/// d_p' in mm, of any size, after a check of every input.
fn exact_diameter(
    normal_module: &Length,
    normal_pressure_angle: &Angle,
    tooth_thickness: Option<&Length>,
) -> Result<Rational, DomainError> {
    domain::NORMAL_PRESSURE_ANGLE.check_angle(normal_pressure_angle)?;
    let space = space_width(normal_module, tooth_thickness)?;
    Ok(&space / &precise::cos(normal_pressure_angle.exact_degrees()))
}

/// ∂d_p'/∂m_n, ∂d_p'/∂α_n and, if a tooth thickness is given, ∂d_p'/∂s_n.
///
/// # Errors
/// [`DomainError`] if an input is outside its domain, or a derivative is beyond the range of `f64`.
pub fn sensitivities(
    normal_module: &Length,
    normal_pressure_angle: &Angle,
    tooth_thickness: Option<&Length>,
) -> Result<Vec<Sensitivity>, DomainError> {
    let diameter = exact_diameter(normal_module, normal_pressure_angle, tooth_thickness)?;
    let alpha = normal_pressure_angle.exact_degrees();
    let cos = precise::cos(alpha);
    let by_module = &space_per_module(tooth_thickness) / &cos;
    let mut all = vec![
        Sensitivity::new(Input::NormalModule, &by_module)?,
        Sensitivity::new(Input::NormalPressureAngle, &per_degree(&(&diameter * &precise::tan(alpha))))?,
    ];
    if tooth_thickness.is_some() {
        all.push(Sensitivity::new(Input::ToothThickness, &-&(&Rational::ONE / &cos))?);
    }
    Ok(all)
}

/// The width of the tooth space at the pitch line, π m_n − s_n, in mm.
pub(super) fn space_width(normal_module: &Length, tooth_thickness: Option<&Length>) -> Result<Rational, DomainError> {
    let pitch = domain::normal_pitch(normal_module)?;
    let thickness = domain::tooth_thickness(normal_module, tooth_thickness)?;
    Ok(&pitch - &thickness)
}

/// ∂(π m_n − s_n)/∂m_n: half of π if the tooth thickness follows the module.
pub(super) fn space_per_module(tooth_thickness: Option<&Length>) -> Rational {
    match tooth_thickness {
        Some(_) => Rational::pi().clone(),
        None => Rational::pi() / &Rational::integer(2),
    }
}
