//! An error of a part together with the formula that maps it to ΔCD.

use super::{Model, PinionPitch, RackLead, RackPitch, over_roller, pinion_radial};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::quantity::{Angle, DomainError, Length};

/// One error of a rack or pinion and, where it needs one, its prepared formula.
#[derive(Debug, Clone)]
pub enum PartError {
    /// Over-roller error of the rack.
    RackOverRoller(Length),
    /// Pitch error of the rack.
    RackPitch(Length, RackPitch),
    /// Lead angle error of the rack.
    RackLead(Angle, RackLead),
    /// Radial error of the pinion.
    PinionRadial(Length),
    /// Single pitch deviation of the pinion.
    PinionPitch(Length, PinionPitch),
}

impl PartError {
    /// The kind of error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::RackOverRoller(_) => ErrorKind::RackOverRoller,
            Self::RackPitch(..) => ErrorKind::RackPitch,
            Self::RackLead(..) => ErrorKind::RackLead,
            Self::PinionRadial(_) => ErrorKind::PinionRadial,
            Self::PinionPitch(..) => ErrorKind::PinionPitch,
        }
    }

    /// The error's value.
    #[must_use]
    pub fn value(&self) -> ErrorValue {
        match self {
            Self::RackOverRoller(error)
            | Self::PinionRadial(error)
            | Self::RackPitch(error, _)
            | Self::PinionPitch(error, _) => ErrorValue::Length(error.clone()),
            Self::RackLead(error, _) => ErrorValue::Angle(error.clone()),
        }
    }

    /// ΔCD of this error.
    ///
    /// # Errors
    /// [`DomainError`] if the error is outside its formula's domain or the result overflows.
    pub fn delta_cd(&self, model: Model) -> Result<Length, DomainError> {
        match self {
            Self::RackOverRoller(error) => Ok(over_roller::delta_cd(error)),
            Self::RackPitch(error, formula) => formula.delta_cd(error, model),
            Self::RackLead(error, formula) => formula.delta_cd(error, model),
            Self::PinionRadial(error) => Ok(pinion_radial::delta_cd(error)),
            Self::PinionPitch(error, formula) => formula.delta_cd(error, model),
        }
    }
}

/// The equation of an error's ΔCD, in one line.
#[must_use]
pub fn formula_text(kind: ErrorKind, model: Model) -> &'static str {
    match (kind, model) {
        (ErrorKind::RackOverRoller, _) => "M - M_nom",
        (ErrorKind::RackPitch, Model::Exact) => "|Δp| cos β_r / (2 tan α_n)",
        (ErrorKind::RackPitch, Model::Paper) => "|Δp| / (2 tan α_n)",
        (ErrorKind::RackLead, Model::Exact) => "k |sin Δβ| / (2 cos β_r tan α_n)",
        (ErrorKind::RackLead, Model::Paper) => "k |tan Δβ| / (2 tan α_n)",
        (ErrorKind::PinionRadial, _) => "r - r_nom",
        (ErrorKind::PinionPitch, Model::Exact) => "|f_p| cos β_p / (2 tan α_n)",
        (ErrorKind::PinionPitch, Model::Paper) => "|f_p| / (2 tan α_n)",
    }
}

/// The name under which [`CATALOGUE`](super::CATALOGUE) documents the formula of a kind of error.
#[must_use]
pub fn formula_name(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::RackOverRoller => "rack-over-roller",
        ErrorKind::RackPitch => "rack-pitch",
        ErrorKind::RackLead => "rack-lead",
        ErrorKind::PinionRadial => "pinion-radial",
        ErrorKind::PinionPitch => "pinion-pitch",
    }
}
