#![doc = include_str!("roller_change.md")]
//!
//! # Example
//! ```
//! use rackmesh::formula::roller_change;
//!
//! let difference = roller_change::difference(&"4".parse()?, &"3.5".parse()?, &"20 deg".parse()?)?;
//! assert_eq!(format!("{:.3}", difference.mm()), "-0.981");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::over_pin::one_and_cosecant;
use super::{Input, Sensitivity, domain, per_degree, result_mm};
use crate::quantity::{Angle, DomainError, Length, Rational};
use crate::trig::precise;

/// ΔM = (D_2 − D_1)/2 · (1 + 1/sin α_n) when the roller D_1 = `from` is replaced by D_2 = `to`.
///
/// # Errors
/// [`DomainError`] if an input is outside its domain, or the result is beyond the range of `f64`.
pub fn difference(from: &Length, to: &Length, normal_pressure_angle: &Angle) -> Result<Length, DomainError> {
    check(from, to, normal_pressure_angle)?;
    let factor = one_and_cosecant(normal_pressure_angle.exact_degrees());
    result_mm(&(&half_difference(from, to) * &factor), "the difference ΔM")
}

/// ∂ΔM/∂D_2 (as pin diameter; ∂ΔM/∂D_1 is its negative) and ∂ΔM/∂α_n.
///
/// # Errors
/// [`DomainError`] if an input is outside its domain, or a derivative is beyond the range of `f64`.
pub fn sensitivities(
    from: &Length,
    to: &Length,
    normal_pressure_angle: &Angle,
) -> Result<Vec<Sensitivity>, DomainError> {
    check(from, to, normal_pressure_angle)?;
    let alpha = normal_pressure_angle.exact_degrees();
    let by_diameter = &one_and_cosecant(alpha) / &Rational::integer(2);
    let by_alpha = -&(&(&half_difference(from, to) * &precise::cos(alpha)) / &precise::sin(alpha).square());
    Ok(vec![
        Sensitivity::new(Input::PinDiameter, &by_diameter)?,
        Sensitivity::new(Input::NormalPressureAngle, &per_degree(&by_alpha))?,
    ])
}

fn check(from: &Length, to: &Length, normal_pressure_angle: &Angle) -> Result<(), DomainError> {
    domain::PIN_DIAMETER.check_length(from)?;
    domain::PIN_DIAMETER.check_length(to)?;
    domain::NORMAL_PRESSURE_ANGLE.check_angle(normal_pressure_angle)
}

fn half_difference(from: &Length, to: &Length) -> Rational {
    (to - from).exact_mm() / &Rational::integer(2)
}
