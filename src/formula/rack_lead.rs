#![doc = include_str!("rack_lead.md")]
//!
//! Derived in [`mesh::relations`](crate::mesh::relations), section 6.
//!
//! # Example
//! Table 2 of the paper, with α_n = 19.9° and k = 19.7 mm (the paper prints neither):
//! ```
//! use rackmesh::formula::{Model, RackLead};
//! use rackmesh::quantity::Angle;
//!
//! let formula = RackLead::new(&"19.9".parse()?, &Angle::ZERO, &"19.7".parse()?)?;
//! for (lead_error, printed) in [("0.25 deg", "0.119"), ("-0.5 deg", "0.237")] {
//!     let delta_cd = formula.delta_cd(&lead_error.parse()?, Model::Paper)?;
//!     assert_eq!(format!("{:.3}", delta_cd.mm()), printed);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::{Input, Model, Sensitivity, domain, largest_within, per_degree, result_mm};
use crate::quantity::{Angle, DomainError, Length, Rational};
use crate::trig::precise;

/// The formula for one pressure angle, helix angle and face width; see the [module](self).
#[derive(Debug, Clone)]
pub struct RackLead {
    /// k / (2 tan α_n), the paper's factor of |tan Δβ|
    paper: Rational,
    /// k / (2 cos β_r tan α_n), the exact factor of |sin Δβ|
    exact: Rational,
    pressure_angle: Angle,
    helix_angle: Angle,
    face_width: Length,
}

impl RackLead {
    /// Prepares the formula: α_n, β_r and k.
    ///
    /// # Errors
    /// [`DomainError`] if an angle or the face width is outside its domain.
    pub fn new(
        normal_pressure_angle: &Angle,
        rack_helix_angle: &Angle,
        face_width: &Length,
    ) -> Result<Self, DomainError> {
        domain::NORMAL_PRESSURE_ANGLE.check_angle(normal_pressure_angle)?;
        domain::RACK_HELIX_ANGLE.check_angle(rack_helix_angle)?;
        domain::FACE_WIDTH.check_length(face_width)?;
        let twice_tan = &Rational::integer(2) * &precise::tan(normal_pressure_angle.exact_degrees());
        let paper = face_width.exact_mm() / &twice_tan;
        let exact = if rack_helix_angle.is_zero() {
            paper.clone()
        } else {
            &paper / &precise::cos(rack_helix_angle.exact_degrees())
        };
        Ok(Self {
            paper,
            exact,
            pressure_angle: normal_pressure_angle.clone(),
            helix_angle: rack_helix_angle.clone(),
            face_width: face_width.clone(),
        })
    }

    /// The angle of a helix slope deviation f_Hβ over the evaluation length L: Δβ = atan(f_Hβ / L).
    ///
    /// # Errors
    /// [`DomainError`] if the length is not above 0.
    pub fn error_from_slope(helix_slope_deviation: &Length, length: &Length) -> Result<Angle, DomainError> {
        domain::EVALUATION_LENGTH.check_length(length)?;
        let angle = precise::atan(&(helix_slope_deviation.exact_mm() / length.exact_mm()));
        Ok(Angle::from_exact_degrees(angle, "the lead angle error")?)
    }

    /// α_n, β_r and k.
    pub(super) fn geometry(&self) -> (&Angle, &Angle, Option<&Length>) {
        (&self.pressure_angle, &self.helix_angle, Some(&self.face_width))
    }

    /// mm of ΔCD per unit of |sin Δβ| (exact model) or |tan Δβ| (paper).
    pub(super) fn gain(&self, model: Model) -> &Rational {
        match model {
            Model::Exact => &self.exact,
            Model::Paper => &self.paper,
        }
    }

    /// ΔCD of the lead angle error Δβ; never negative.
    ///
    /// # Errors
    /// [`DomainError`] if Δβ is outside its domain, or the result is beyond the range of `f64`.
    pub fn delta_cd(&self, lead_error: &Angle, model: Model) -> Result<Length, DomainError> {
        result_mm(&self.exact_delta_cd(lead_error, model)?, "ΔCD")
    }

    /// ΔCD in mm, of any size, after a check of Δβ.
    fn exact_delta_cd(&self, lead_error: &Angle, model: Model) -> Result<Rational, DomainError> {
        domain::LEAD_ERROR.check_angle(lead_error)?;
        let error = lead_error.abs();
        let ratio = match model {
            Model::Exact => precise::sin(error.exact_degrees()),
            Model::Paper => precise::tan(error.exact_degrees()),
        };
        Ok(self.gain(model) * &ratio)
    }

    /// The largest |Δβ| whose ΔCD does not exceed `delta_cd`; read again as printed, it still does not.
    ///
    /// # Errors
    /// [`DomainError`] if `delta_cd` is negative, or if no lead error reaches it (exact model: the sine is
    /// below 1).
    pub fn largest_error(&self, delta_cd: &Length, model: Model) -> Result<Angle, DomainError> {
        domain::PUSHING_DELTA_CD.check_length(delta_cd)?;
        let ratio = delta_cd.exact_mm() / self.gain(model);
        let angle = match model {
            Model::Exact if ratio >= 1 => {
                return Err(DomainError::NeverReached {
                    error: "lead angle error below 90°",
                    delta_cd: delta_cd.clone(),
                    largest: result_mm(self.gain(model), "ΔCD")?,
                });
            }
            Model::Exact => precise::asin(&ratio).unwrap_or(Rational::integer(90)),
            Model::Paper => precise::atan(&ratio),
        };
        let nearest = angle.round_significant(super::RESULT_DIGITS).to_f64_toward_zero();
        // 90° itself is no lead error, and has no ΔCD
        let largest = largest_within(nearest, |degrees| {
            let reached = Angle::from_degrees(degrees).map(|error| self.delta_cd(&error, model));
            reached.is_ok_and(|reached| reached.is_ok_and(|reached| reached <= *delta_cd))
        });
        Ok(Angle::from_degrees(largest)?)
    }

    /// ∂ΔCD/∂Δβ, ∂ΔCD/∂α_n, ∂ΔCD/∂k and (exact model) ∂ΔCD/∂β_r at this error.
    ///
    /// # Errors
    /// [`DomainError`] if Δβ is outside its domain, or a derivative is beyond the range of `f64`.
    pub fn sensitivities(&self, lead_error: &Angle, model: Model) -> Result<Vec<Sensitivity>, DomainError> {
        let delta_cd = &self.exact_delta_cd(lead_error, model)?;
        let cos_error = precise::cos(lead_error.exact_degrees());
        // d(sin)/dΔβ = cos Δβ, d(tan)/dΔβ = 1/cos² Δβ
        let by_error = match model {
            Model::Exact => self.gain(model) * &cos_error,
            Model::Paper => self.gain(model) / &cos_error.square(),
        };
        // d(1/tan α)/dα = -(1/tan α) / (sin α cos α)
        let alpha = self.pressure_angle.exact_degrees();
        let by_alpha = -&(delta_cd / &(&precise::sin(alpha) * &precise::cos(alpha)));
        let mut all = vec![
            Sensitivity::of_magnitude(lead_error.exact_degrees(), &per_degree(&by_error))?,
            Sensitivity::new(Input::NormalPressureAngle, &per_degree(&by_alpha))?,
            Sensitivity::new(Input::FaceWidth, &(delta_cd / self.face_width.exact_mm()))?,
        ];
        if model == Model::Exact {
            // d(1/cos β)/dβ = tan β / cos β
            let by_beta = delta_cd * &precise::tan(self.helix_angle.exact_degrees());
            all.push(Sensitivity::new(Input::HelixAngle, &per_degree(&by_beta))?);
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With k/(2 tan 45°) = 10 mm an error of 30° reaches 5 mm exactly, and is allowed.
    #[test]
    fn the_largest_error_may_reach_the_limit() {
        let lead = RackLead::new(&"45".parse().unwrap(), &Angle::ZERO, &Length::from_mm(20.0).unwrap()).unwrap();
        let largest = lead.largest_error(&Length::from_mm(5.0).unwrap(), Model::Exact).unwrap();
        assert_eq!(largest, Angle::from_degrees(30.0).unwrap());
    }

    /// The paper's model knows no helix, so it has no derivative by it.
    #[test]
    fn the_helix_angle_counts_in_the_exact_model_only() {
        let lead = RackLead::new(&"20".parse().unwrap(), &"15".parse().unwrap(), &Length::from_mm(20.0).unwrap());
        let inputs = |model| {
            let all = lead.as_ref().unwrap().sensitivities(&"0.1".parse().unwrap(), model).unwrap();
            all.iter().map(|sensitivity| sensitivity.input).collect::<Vec<_>>()
        };
        assert!(inputs(Model::Exact).contains(&Input::HelixAngle));
        assert!(!inputs(Model::Paper).contains(&Input::HelixAngle));
    }
}
