#![doc = include_str!("over_pin.md")]
//!
//! # Example
//! A rack of module 2.5 mm whose reference plane lies 21.5 mm above the datum, over a 5 mm pin:
//! ```
//! use rackmesh::formula::over_pin::OverPin;
//!
//! let over_pin = OverPin {
//!     normal_module: "2.5".parse()?,
//!     normal_pressure_angle: "20 deg".parse()?,
//!     tooth_thickness: None,
//!     pin_diameter: "5".parse()?,
//!     datum: "21.5".parse()?,
//! };
//! assert_eq!(format!("{:.3}", over_pin.measure()?.mm()), "25.915");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::{Influence, Sensitivity, domain, femtometres, ideal_pin};
use crate::deviation::plausible::{self, Doubt};
use crate::quantity::{Angle, DomainError, Length};
use crate::trig;

/// The inputs of the formula; see the [module](self).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OverPin {
    /// m_n
    pub normal_module: Length,
    /// α_n
    pub normal_pressure_angle: Angle,
    /// s_n; π m_n / 2 if `None`
    pub tooth_thickness: Option<Length>,
    /// d_p
    pub pin_diameter: Length,
    /// K
    pub datum: Length,
}

impl OverPin {
    /// The width of the tooth space, π m_n − s_n, in fm, after a check of every input.
    fn checked_space_fm(&self) -> Result<f64, DomainError> {
        domain::NORMAL_PRESSURE_ANGLE.check_angle(self.normal_pressure_angle)?;
        domain::PIN_DIAMETER.check_length(self.pin_diameter)?;
        domain::DATUM.check_length(self.datum)?;
        ideal_pin::space_width_fm(self.normal_module, self.tooth_thickness)
    }

    /// The measure M over the pin.
    ///
    /// # Errors
    /// [`DomainError`] if an input is outside its domain, or the result is beyond the largest length.
    pub fn measure(&self) -> Result<Length, DomainError> {
        let space = self.checked_space_fm()?;
        let alpha = self.normal_pressure_angle;
        // the apex of the flanks lies below the reference plane, the top of the pin above the apex
        let depth = space / (2.0 * trig::tan_of(alpha));
        let height = 0.5 * femtometres(self.pin_diameter) * one_and_cosecant(alpha);
        let above_reference_plane = Length::nearest(height - depth, "the measure M over the pin")?;
        Ok(Length::sum([self.datum, above_reference_plane], "the measure M over the pin")?)
    }

    /// Doubts that the pin rests on the flanks: the contact has to lie near the reference plane and below the tips.
    #[must_use]
    pub fn doubted_pin(&self, addendum: Option<Length>) -> Option<Doubt> {
        let alpha = self.normal_pressure_angle;
        let ideal = ideal_pin::diameter(self.normal_module, alpha, self.tooth_thickness).ok()?;
        let (sin, cos) = trig::sin_cos_of(alpha);
        let touches_at_mm = 0.5 * (self.pin_diameter.mm() - ideal.mm()) * cos * cos / sin;
        plausible::pin(
            self.pin_diameter,
            ideal,
            touches_at_mm / self.normal_module.mm(),
            addendum.map(|tips| tips.mm() / self.normal_module.mm()),
        )
    }

    /// ∂M/∂K, ∂M/∂d_p, ∂M/∂m_n, ∂M/∂α_n and, if a tooth thickness is given, ∂M/∂s_n.
    ///
    /// # Errors
    /// [`DomainError`] if an input is outside its domain.
    pub fn sensitivities(&self) -> Result<Vec<Sensitivity>, DomainError> {
        let space_mm = self.checked_space_fm()? / 1e12;
        let alpha = self.normal_pressure_angle;
        let (sin, cos) = trig::sin_cos_of(alpha);
        let by_space = -0.5 / trig::tan_of(alpha);
        let by_module = by_space * ideal_pin::space_per_module(self.tooth_thickness.is_some());
        // d(-1/tan)/dα = 1/sin², d(1/sin)/dα = -cos/sin²
        let by_alpha = 0.5 * (space_mm - self.pin_diameter.mm() * cos) / (sin * sin);
        let mut all = vec![
            Sensitivity::new(Influence::Datum, 1.0),
            Sensitivity::new(Influence::Roller, 0.5 * one_and_cosecant(alpha)),
            Sensitivity::new(Influence::NormalModule, by_module),
            Sensitivity::by_angle(Influence::NormalPressureAngle, by_alpha),
        ];
        if self.tooth_thickness.is_some() {
            all.push(Sensitivity::new(Influence::ToothThickness, -by_space));
        }
        Ok(all)
    }
}

/// 1 + 1/sin α: how far a pin's top lies above the apex of the flanks that carry it, in radii.
pub(super) fn one_and_cosecant(alpha: Angle) -> f64 {
    1.0 + 1.0 / trig::sin_cos_of(alpha).0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Measures over a pin in a rack manufacturer's table: α = 20°, the height H counted to the tips.
    #[test]
    fn printed_measures_of_racks() {
        for (module, pin, height, printed) in [
            (1.5, 3.0, 17.0, "18.149"),
            (2.5, 5.0, 24.0, "25.915"),
            (4.0, 8.0, 39.0, "42.064"),
            // the table prints 52.396, a misprint: it fits neither the formula nor the values beside it
            (6.0, 12.0, 49.0, "53.596"),
            (8.0, 16.0, 79.0, "85.128"),
        ] {
            let mm = |value| Length::from_mm(value).unwrap();
            let over_pin = OverPin {
                normal_module: mm(module),
                normal_pressure_angle: "20".parse().unwrap(),
                tooth_thickness: None,
                pin_diameter: mm(pin),
                datum: mm(height - module),
            };
            assert_eq!(format!("{:.3}", over_pin.measure().unwrap().mm()), printed, "m = {module}");
        }
    }
}
