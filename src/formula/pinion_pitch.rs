#![doc = include_str!("pinion_pitch.md")]
//!
//! Derived in [`mesh::relations`](crate::mesh::relations), section 4.
//!
//! # Example
//! The formula is that of the rack's pitch error, so Table 1 of the paper holds for it too
//! (α_n = 19.9°, not printed in the paper, and β_p = 0):
//! ```
//! use rackmesh::formula::{Model, PinionPitch};
//! use rackmesh::quantity::Angle;
//!
//! let formula = PinionPitch::new(&"19.9".parse()?, &Angle::ZERO)?;
//! let delta_cd = formula.delta_cd(&"-0.02".parse()?, Model::Exact)?;
//! assert_eq!(format!("{:.3}", delta_cd.mm()), "0.028");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::flank_step::FlankStep;
use super::{Model, Sensitivity, domain};
use crate::quantity::{Angle, DomainError, Length, Rational};

/// The formula for one pressure angle and helix angle; see the [module](self).
#[derive(Debug, Clone)]
pub struct PinionPitch(FlankStep);

impl PinionPitch {
    /// Prepares the formula: α_n and β_p.
    ///
    /// # Errors
    /// [`DomainError`] if an angle is outside its domain.
    pub fn new(normal_pressure_angle: &Angle, pinion_helix_angle: &Angle) -> Result<Self, DomainError> {
        FlankStep::new(normal_pressure_angle, pinion_helix_angle, &domain::PINION_HELIX_ANGLE).map(Self)
    }

    /// mm of ΔCD per mm of error.
    pub(super) fn gain(&self, model: Model) -> &Rational {
        self.0.gain(model)
    }

    /// α_n and the helix angle.
    pub(super) fn geometry(&self) -> (&Angle, &Angle, Option<&Length>) {
        self.0.geometry()
    }

    /// ΔCD of the single pitch deviation f_p; never negative.
    ///
    /// # Errors
    /// [`DomainError::Overflow`] if the result is beyond the range of `f64`.
    pub fn delta_cd(&self, pitch_error: &Length, model: Model) -> Result<Length, DomainError> {
        self.0.delta_cd(pitch_error, model)
    }

    /// The largest |f_p| whose ΔCD does not exceed `delta_cd`; read again as printed, it still does not.
    ///
    /// # Errors
    /// [`DomainError`] if `delta_cd` is negative, or the result is beyond the range of `f64`.
    pub fn largest_error(&self, delta_cd: &Length, model: Model) -> Result<Length, DomainError> {
        self.0.largest_error(delta_cd, model)
    }

    /// ∂ΔCD/∂f_p, ∂ΔCD/∂α_n and (exact model) ∂ΔCD/∂β_p at this error.
    ///
    /// # Errors
    /// [`DomainError::Overflow`] if one of them is beyond the range of `f64`.
    pub fn sensitivities(&self, pitch_error: &Length, model: Model) -> Result<Vec<Sensitivity>, DomainError> {
        self.0.sensitivities(pitch_error, model)
    }
}
