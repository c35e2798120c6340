//! The closed formulas: what one manufacturing error does to the operating centre distance.
//!
//! One file per formula of the paper *Effects of Gear Manufacturing Errors on Rack and Pinion
//! Steering Meshing*, sections 2.1 and 2.2, each with its equation, symbols, units, domain and
//! source. The ΔCD formulas come with their inverse (the largest error that stays within a ΔCD) and
//! their sensitivities (∂ΔCD/∂input). The decision module evaluates and combines them; they take
//! validated quantities and know nothing of files or tables.
//!
//! | error | ΔCD | module |
//! |---|---|---|
//! | rack over-roller error | `M - M_nom` | [`over_roller`] |
//! | rack pitch error | `\|Δp\| cos β_r / (2 tan α_n)` | [`rack_pitch`] |
//! | rack lead angle error | `k \|sin Δβ\| / (2 cos β_r tan α_n)` | [`rack_lead`] |
//! | pinion radial error | `r - r_nom` | [`pinion_radial`] |
//! | pinion single pitch error | `\|f_p\| cos β_p / (2 tan α_n)` | [`pinion_pitch`] |
//!
//! The exact ones are derived in [`mesh::relations`](crate::mesh::relations).
//!
//! # Accuracy
//! Inputs are exact ([`Length`], [`Angle`](crate::quantity::Angle)), trigonometric functions have 50
//! correct digits, and a result is carried as a decimal number of 40
//! significant digits. So the `f64` that leaves is the true value rounded once (0.5 ulp, over the
//! whole domain), and a result that is a short decimal in exact arithmetic — `|Δp| · 3/4` at
//! α_n = β_r = 30° — is that decimal, and equals a limit of the same decimals.

pub mod domain;
pub mod ideal_pin;
pub mod over_pin;
pub mod over_roller;
pub mod pinion_pitch;
pub mod pinion_radial;
pub mod rack_lead;
pub mod rack_pitch;
pub mod roller_change;

mod catalogue;
mod flank_step;
mod part_error;
mod prepared;

pub use catalogue::{CATALOGUE, FormulaPage};
pub use part_error::{PartError, PartFormula, formula_name, formula_text};
pub use pinion_pitch::PinionPitch;
pub use prepared::{Fixed, Prepared};
pub use rack_lead::RackLead;
pub use rack_pitch::RackPitch;

use std::fmt;

use crate::quantity::{DomainError, Length, QuantityError, Rational};

/// Which reading of a formula to use, where the paper's differs from the exact one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Model {
    /// Exact for rigid teeth: the pressure angle is taken in the plane in which the error was measured.
    #[default]
    Exact,
    /// The formula as the paper prints it.
    Paper,
}

impl Model {
    /// `exact` or `paper`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Paper => "paper",
        }
    }
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// An input of a formula, as sensitivities name it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Input {
    /// The error itself (mm, or degrees for a lead error).
    Error,
    /// Normal pressure angle α_n (degrees).
    NormalPressureAngle,
    /// Helix angle β of the part that has the error (degrees).
    HelixAngle,
    /// Face width k (mm).
    FaceWidth,
    /// Normal module m_n (mm).
    NormalModule,
    /// Tooth thickness s_n (mm).
    ToothThickness,
    /// Pin diameter d_p (mm).
    PinDiameter,
    /// Datum distance K (mm).
    Datum,
}

impl Input {
    /// What an error calls the derivative by this input.
    const fn sensitivity_name(self) -> &'static str {
        match self {
            Self::Error => "the sensitivity to the error itself",
            Self::NormalPressureAngle => "the sensitivity to the normal pressure angle α_n",
            Self::HelixAngle => "the sensitivity to the helix angle β",
            Self::FaceWidth => "the sensitivity to the face width k",
            Self::NormalModule => "the sensitivity to the normal module m_n",
            Self::ToothThickness => "the sensitivity to the tooth thickness s_n",
            Self::PinDiameter => "the sensitivity to the pin diameter d_p",
            Self::Datum => "the sensitivity to the datum distance K",
        }
    }
}

/// One partial derivative of a formula's result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivity {
    /// The input that varies.
    pub input: Input,
    /// ∂result/∂input, in mm per mm or mm per degree. `None` at a kink, where there is no
    /// derivative: |Δp| and |sin Δβ| at zero error.
    pub value: Option<f64>,
}

impl Sensitivity {
    /// The derivative of an over-roller or radial error: ΔCD is the error.
    const OF_SHIFT: Self = Self { input: Input::Error, value: Some(1.0) };

    fn new(input: Input, value: &Rational) -> Result<Self, DomainError> {
        let value = value.to_f64();
        if value.is_infinite() {
            return Err(QuantityError::Overflow { what: input.sensitivity_name() }.into());
        }
        Ok(Self { input, value: Some(value) })
    }

    /// The derivative by the error of a formula that contains its magnitude: `slope` with the error's
    /// sign.
    fn of_magnitude(error: &Rational, slope: &Rational) -> Result<Self, DomainError> {
        if error.is_zero() {
            Ok(Self { input: Input::Error, value: None })
        } else if error.is_negative() {
            Self::new(Input::Error, &-slope)
        } else {
            Self::new(Input::Error, slope)
        }
    }
}

/// Significant decimal digits of a result before it is rounded to an `f64`: far beyond an `f64`'s 17,
/// and as far below the 50 to which the functions are known, so that a result that is a shorter
/// decimal comes out as that decimal.
const RESULT_DIGITS: u16 = 40;

/// A formula's result in mm, as a decimal of [`RESULT_DIGITS`] digits; `what` names it if it overflows.
fn result_mm(value: &Rational, what: &'static str) -> Result<Length, DomainError> {
    Ok(Length::from_exact_mm(value.round_significant(RESULT_DIGITS), what)?)
}

/// The first number from `start` down to 0 of which `within` holds. An inverse that was rounded to
/// [`RESULT_DIGITS`] may lie above the true one by less than the last of them, and where it is a short
/// decimal that is enough to exceed the bound: then the next `f64` below does not.
fn largest_within(start: f64, within: impl Fn(f64) -> bool) -> f64 {
    let mut value = start;
    while value > 0.0 && !within(value) {
        value = value.next_down();
    }
    value
}

/// Degrees are the unit of angles here, radians that of derivatives: ∂/∂degree = π/180 ∂/∂radian.
fn per_degree(per_radian: &Rational) -> Rational {
    crate::trig::precise::radians(per_radian)
}
