//! An error of a part together with the formula that maps it to ΔCD. Built by the spec layer, evaluated by the decision
//! module; holds no number that the formulas do not.

use super::{Model, PinionPitch, RackLead, RackPitch, Sensitivity, over_roller, pinion_radial};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::quantity::{Angle, DomainError, Length};

/// One error of a rack or pinion and, where it needs one, its prepared formula.
#[derive(Debug, Clone)]
#[non_exhaustive]
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
    /// A permissible deviation in place of a measured one: the error is any from minus to plus this.
    Within(Box<PartError>),
}

impl PartError {
    /// The kind of error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Within(error) => error.kind(),
            Self::RackOverRoller(_) => ErrorKind::RackOverRoller,
            Self::RackPitch(..) => ErrorKind::RackPitch,
            Self::RackLead(..) => ErrorKind::RackLead,
            Self::PinionRadial(_) => ErrorKind::PinionRadial,
            Self::PinionPitch(..) => ErrorKind::PinionPitch,
        }
    }

    /// Whether the value is a permissible deviation, whose sign is not known.
    #[must_use]
    pub const fn is_tolerance(&self) -> bool {
        matches!(self, Self::Within(_))
    }

    /// The error itself: of a permissible deviation, that of its largest magnitude.
    #[must_use]
    pub fn largest(&self) -> &Self {
        if let Self::Within(error) = self { error.largest() } else { self }
    }

    /// The formula without the value.
    #[must_use]
    pub fn formula(&self) -> PartFormula {
        match self {
            Self::Within(error) => error.formula(),
            Self::RackOverRoller(_) => PartFormula::RackOverRoller,
            Self::RackPitch(_, formula) => PartFormula::RackPitch(formula.clone()),
            Self::RackLead(_, formula) => PartFormula::RackLead(formula.clone()),
            Self::PinionRadial(_) => PartFormula::PinionRadial,
            Self::PinionPitch(_, formula) => PartFormula::PinionPitch(formula.clone()),
        }
    }

    /// The error's value; of a permissible deviation, its largest magnitude.
    #[must_use]
    pub fn value(&self) -> ErrorValue {
        match self {
            Self::Within(error) => error.value(),
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
            Self::Within(error) => error.delta_cd(model),
            Self::RackOverRoller(error) => Ok(over_roller::delta_cd(error)),
            Self::RackPitch(error, formula) => formula.delta_cd(error, model),
            Self::RackLead(error, formula) => formula.delta_cd(error, model),
            Self::PinionRadial(error) => Ok(pinion_radial::delta_cd(error)),
            Self::PinionPitch(error, formula) => formula.delta_cd(error, model),
        }
    }

    /// The gear data of its formula: α_n, the helix angle of its part, and the face width; `None` if it needs none.
    pub(crate) fn geometry(&self) -> Option<(&Angle, &Angle, Option<&Length>)> {
        match self {
            Self::Within(error) => error.geometry(),
            Self::RackOverRoller(_) | Self::PinionRadial(_) => None,
            Self::RackPitch(_, formula) => Some(formula.geometry()),
            Self::RackLead(_, formula) => Some(formula.geometry()),
            Self::PinionPitch(_, formula) => Some(formula.geometry()),
        }
    }

    /// ∂ΔCD/∂input by the error and by the gear data of its formula.
    ///
    /// # Errors
    /// [`DomainError`] if the error is outside its formula's domain or a derivative overflows.
    pub fn sensitivities(&self, model: Model) -> Result<Vec<Sensitivity>, DomainError> {
        match self {
            Self::Within(error) => error.sensitivities(model),
            Self::RackOverRoller(_) | Self::PinionRadial(_) => Ok(vec![Sensitivity::OF_SHIFT]),
            Self::RackPitch(error, formula) => formula.sensitivities(error, model),
            Self::RackLead(error, formula) => formula.sensitivities(error, model),
            Self::PinionPitch(error, formula) => formula.sensitivities(error, model),
        }
    }
}

/// The formula of one kind of error, prepared for a gear, without an error's value.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum PartFormula {
    /// Over-roller error of the rack.
    RackOverRoller,
    /// Pitch error of the rack.
    RackPitch(RackPitch),
    /// Lead angle error of the rack.
    RackLead(RackLead),
    /// Radial error of the pinion.
    PinionRadial,
    /// Single pitch deviation of the pinion.
    PinionPitch(PinionPitch),
}

impl PartFormula {
    /// The kind of error.
    #[must_use]
    pub const fn kind(&self) -> ErrorKind {
        match self {
            Self::RackOverRoller => ErrorKind::RackOverRoller,
            Self::RackPitch(_) => ErrorKind::RackPitch,
            Self::RackLead(_) => ErrorKind::RackLead,
            Self::PinionRadial => ErrorKind::PinionRadial,
            Self::PinionPitch(_) => ErrorKind::PinionPitch,
        }
    }

    /// An error of this kind; `None` if the value is an angle where a length is needed, or the other way
    /// round.
    #[must_use]
    pub fn of(&self, value: &ErrorValue) -> Option<PartError> {
        Some(match (self, value) {
            (Self::RackOverRoller, ErrorValue::Length(error)) => PartError::RackOverRoller(error.clone()),
            (Self::RackPitch(formula), ErrorValue::Length(error)) => {
                PartError::RackPitch(error.clone(), formula.clone())
            }
            (Self::RackLead(formula), ErrorValue::Angle(error)) => PartError::RackLead(error.clone(), formula.clone()),
            (Self::PinionRadial, ErrorValue::Length(error)) => PartError::PinionRadial(error.clone()),
            (Self::PinionPitch(formula), ErrorValue::Length(error)) => {
                PartError::PinionPitch(error.clone(), formula.clone())
            }
            _ => return None,
        })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::CATALOGUE;

    /// Each kind's formula has a page, and the page is about it.
    #[test]
    fn every_formula_is_documented_under_its_name() {
        for kind in ErrorKind::ALL {
            let page = CATALOGUE.iter().find(|page| page.name == formula_name(kind));
            assert!(page.is_some_and(|page| page.text.contains("ΔCD")), "{kind:?}");
        }
    }
}
