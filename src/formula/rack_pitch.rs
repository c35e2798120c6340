#![doc = include_str!("rack_pitch.md")]
//!
//! Derived in [`mesh::relations`](crate::mesh::relations), section 4.
//!
//! # Example
//! Table 1 of the paper, with α_n = 19.9° (the paper does not print it):
//! ```
//! use rackmesh::formula::{Model, RackPitch};
//! use rackmesh::quantity::Angle;
//!
//! let formula = RackPitch::new(&"19.9".parse()?, &Angle::ZERO)?;
//! for (pitch_error, printed) in [("+0.01", "0.014"), ("-0.02", "0.028"), ("+0.03", "0.041")] {
//!     let delta_cd = formula.delta_cd(&pitch_error.parse()?, Model::Exact)?;
//!     assert_eq!(format!("{:.3}", delta_cd.mm()), printed);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::flank_step::FlankStep;
use super::{Model, Sensitivity, domain};
use crate::quantity::{Angle, DomainError, Length, Rational};

/// The formula for one pressure angle and helix angle; see the [module](self).
#[derive(Debug, Clone)]
pub struct RackPitch(FlankStep);

impl RackPitch {
    /// Prepares the formula: α_n and β_r.
    ///
    /// # Errors
    /// [`DomainError`] if an angle is outside its domain.
    pub fn new(normal_pressure_angle: &Angle, rack_helix_angle: &Angle) -> Result<Self, DomainError> {
        FlankStep::new(normal_pressure_angle, rack_helix_angle, &domain::RACK_HELIX_ANGLE).map(Self)
    }

    /// mm of ΔCD per mm of error.
    pub(super) fn gain(&self, model: Model) -> &Rational {
        self.0.gain(model)
    }

    /// α_n and the helix angle.
    pub(super) fn geometry(&self) -> (&Angle, &Angle, Option<&Length>) {
        self.0.geometry()
    }

    /// ΔCD of the pitch error Δp; never negative.
    ///
    /// # Errors
    /// [`DomainError::Overflow`] if the result is beyond the range of `f64`.
    pub fn delta_cd(&self, pitch_error: &Length, model: Model) -> Result<Length, DomainError> {
        self.0.delta_cd(pitch_error, model)
    }

    /// The largest |Δp| whose ΔCD does not exceed `delta_cd`; read again as printed, it still does not.
    ///
    /// # Errors
    /// [`DomainError`] if `delta_cd` is negative, or the result is beyond the range of `f64`.
    pub fn largest_error(&self, delta_cd: &Length, model: Model) -> Result<Length, DomainError> {
        self.0.largest_error(delta_cd, model)
    }

    /// ∂ΔCD/∂Δp, ∂ΔCD/∂α_n and (exact model) ∂ΔCD/∂β_r at this error.
    ///
    /// # Errors
    /// [`DomainError::Overflow`] if one of them is beyond the range of `f64`.
    pub fn sensitivities(&self, pitch_error: &Length, model: Model) -> Result<Vec<Sensitivity>, DomainError> {
        self.0.sensitivities(pitch_error, model)
    }
}
