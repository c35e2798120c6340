//! The nominal value that is subtracted from a measured value: of the spec, of the table or of its row.

use super::{Column, Nominal, Problem, SMALLEST_DIGIT};
use crate::deviation::DeviationValue;
use crate::deviation::plausible::Reach;
use crate::quantity::{Angle, Length, Unit};
use crate::table::cell::Cell;
use crate::table::companions::Companions;
use crate::table::field::Beside as Role;

impl Column {
    /// The nominal value that every part has: 0 of deviations; `None` if each row has its own.
    pub(crate) fn nominal_of_every_part(&self) -> Option<DeviationValue> {
        match (self.nominal, self.unit) {
            (Nominal::Fixed(nominal), _) => Some(nominal),
            (Nominal::None, Unit::Length(_)) => Some(DeviationValue::Length(Length::ZERO)),
            (Nominal::None, Unit::Angle(_)) => Some(DeviationValue::Angle(Angle::ZERO)),
            (Nominal::Beside, _) => None,
        }
    }

    pub(super) fn nominal_beside(&self, beside: &Companions<&Cell>) -> Result<DeviationValue, Problem> {
        let Some(nominal) = self.quantity_beside(beside, Role::Nominal)? else {
            return self.stated.ok_or_else(|| Problem::new("there is no nominal value beside it".to_owned()));
        };
        match self.stated {
            Some(stated) if !self.agrees(stated, nominal, beside) => {
                Err(Problem::new(format!("the nominal value is {nominal} in the table and {stated} in the spec")))
            }
            Some(stated) => Ok(stated),
            None => Ok(nominal),
        }
    }

    /// Compares the nominal value beside a deviation with the spec's. 0 agrees too: it is the nominal value of a deviation.
    pub(super) fn holds_from_nominal(&self, beside: &Companions<&Cell>) -> Result<(), Problem> {
        let is_size = |nominal: DeviationValue| !nominal.is_zero();
        if self.stated.is_some() && self.quantity_beside(beside, Role::Nominal)?.is_some_and(is_size) {
            self.nominal_beside(beside)?;
        }
        Ok(())
    }

    /// Whether the nominal values of the spec and of a cell are equal, but for the rounding of the cell's last digit.
    fn agrees(&self, stated: DeviationValue, nominal: DeviationValue, beside: &Companions<&Cell>) -> bool {
        let half = self.digit_beside(beside, Role::Nominal).map_or(0.0, |digit| SMALLEST_DIGIT.min(digit / 2.0));
        stated == nominal || (stated.base() - nominal.base()).abs() <= half
    }

    /// Measured minus nominal, if the two are near each other.
    pub(super) fn less(&self, value: DeviationValue, nominal: DeviationValue) -> Result<DeviationValue, Problem> {
        let deviation = value.less(nominal);
        if near(nominal, self.farthest).is_exceeded_by(deviation) {
            return Err(Problem::new(format!(
                "{value} is far from the nominal value {nominal}: check the unit and the decimal mark, or whether it is a deviation"
            )));
        }
        Ok(deviation)
    }
}

/// How far a measured value may be from its nominal one: a tenth of the nominal value, and no further than `possible`.
pub(super) fn near(nominal: DeviationValue, possible: Reach) -> Reach {
    match nominal {
        DeviationValue::Length(nominal) if !nominal.is_zero() => {
            possible.within(Length::from_fm((nominal.abs().fm() / 10).max(1)))
        }
        _ => possible,
    }
}
