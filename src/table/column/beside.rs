//! What stands beside a value: the deviation and the tolerances that the value is compared with, and to how many digits.

use super::{Column, Nominal, Problem, SMALLEST_DIGIT};
use crate::deviation::DeviationValue;
use crate::quantity::{Decimal, Unit};
use crate::table::cell::{Cell, Content, Record};
use crate::table::companions::Companions;
use crate::table::field::Beside as Role;
use crate::table::grid::{unit_in, unit_of};
use crate::table::number::{normalise, quantity};

impl Column {
    /// What stands beside its value in a record.
    pub(crate) fn beside_in<'r>(&self, record: &'r Record) -> Companions<&'r Cell> {
        self.beside.map(|companion| record.cells.get(companion.place))
    }

    /// The quantity in a companion's cell; `None` if there is none.
    pub(super) fn quantity_beside(
        &self,
        beside: &Companions<&Cell>,
        role: Role,
    ) -> Result<Option<DeviationValue>, Problem> {
        let cell = beside.get(role).filter(|cell| !cell.is_missing());
        cell.map(|cell| self.quantity_in(cell, self.unit_beside(role))).transpose()
    }

    /// The widest tolerance beside a value, mm or degrees: a limit of size, or an allowance from nominal.
    fn widest(&self, beside: &Companions<&Cell>) -> Result<f64, Problem> {
        let fixed = if let Nominal::Fixed(nominal) = self.nominal { Some(nominal) } else { None };
        let nominal = self.quantity_beside(beside, Role::Nominal)?.or(fixed).map_or(0.0, DeviationValue::base);
        let mut widest = self.tolerance.unwrap_or(0.0);
        for role in [Role::Upper, Role::Lower] {
            // tolerances only show whether the unit is right: one that is no number shows nothing
            let Ok(Some(tolerance)) = self.quantity_beside(beside, role) else { continue };
            let size = tolerance.base();
            let is_limit = nominal != 0.0 && size.abs() > nominal.abs() / 2.0;
            widest = widest.max(if is_limit { (size - nominal).abs() } else { size.abs() });
        }
        Ok(widest)
    }

    /// Whether a value is compared with the deviation beside it. A measured value of a space is not: its nominal value may be
    /// unknown.
    pub(crate) fn checks_deviation(&self) -> bool {
        self.deviates() || self.kind.is_some() || !self.is_of_space()
    }

    /// Compares a deviation with the deviation and the tolerances beside its value. Returns the deviation beside it where that has
    /// more digits.
    pub(super) fn checked(
        &self,
        cell: &Cell,
        mut deviation: DeviationValue,
        beside: &Companions<&Cell>,
    ) -> Result<DeviationValue, Problem> {
        /// A deviation of so many times its tolerance is in the wrong unit.
        const TIMES: f64 = 100.0;
        let stated = self.quantity_beside(beside, Role::Deviation)?;
        if let Some(stated) = stated.filter(|_| self.checks_deviation()) {
            let apart = (stated.base() - deviation.base()).abs();
            if apart > self.rounding(cell, beside) {
                return Err(Problem::new(format!("the deviation beside it is {stated}, and this one is {deviation}")));
            }
            let digit = self.digit_beside(beside, Role::Deviation);
            let is_finer =
                |digit: f64| digit < self.digit(cell, self.unit) && apart > (0.5 * digit).max(SMALLEST_DIGIT);
            if digit.is_some_and(is_finer) {
                // the value lost these digits when it was rounded
                deviation = stated;
            }
        }
        let widest = self.widest(beside)?;
        if widest > 0.0 && deviation.base().abs() > TIMES * widest {
            return Err(Problem::new(format!(
                "a deviation of {deviation} is more than {TIMES} times the tolerance beside it: check the units"
            )));
        }
        Ok(deviation)
    }

    /// Whether the deviation beside a value has more digits than the value, so that it may count instead.
    pub(crate) fn has_finer_deviation(&self, cell: &Cell, beside: &Companions<&Cell>) -> bool {
        let digit = self.digit_beside(beside, Role::Deviation);
        digit.is_some_and(|digit| digit < self.digit(cell, self.unit))
    }

    /// One step of the last digit of a companion, mm or degrees.
    pub(super) fn digit_beside(&self, beside: &Companions<&Cell>, role: Role) -> Option<f64> {
        Some(self.digit(beside.get(role)?, self.unit_beside(role)))
    }

    /// How far a deviation may be from measured minus nominal because each is rounded to its last digit, mm or degrees. A number
    /// with far fewer digits than the others is taken as written without its last zeros, and as exact as they are.
    pub(super) fn rounding(&self, cell: &Cell, beside: &Companions<&Cell>) -> f64 {
        /// A deviation with finer digits than this, mm or degrees, was computed.
        const FINE: f64 = 1e-3;
        /// A number whose last digit is so many times the finest one is written without its last zeros.
        const FEWER: f64 = 15.0;
        let value = Some(self.digit(cell, self.unit));
        // a nominal value of 0 is exact
        let is_zero = matches!(self.quantity_beside(beside, Role::Nominal), Ok(Some(nominal)) if nominal.is_zero());
        let nominal = self.digit_beside(beside, Role::Nominal).filter(|_| !is_zero);
        let deviation = self.digit_beside(beside, Role::Deviation);
        let all = [value, nominal, deviation.map(|digit| digit.max(FINE))].into_iter().flatten();
        let finest = all.fold(f64::INFINITY, f64::min);
        let each = [value, nominal, deviation].into_iter().flatten();
        each.map(|digit| 0.5 * if digit > FEWER * finest { finest } else { digit }).sum::<f64>().max(SMALLEST_DIGIT)
    }

    /// One step of the last digit that is written, mm or degrees.
    pub(crate) fn digit(&self, cell: &Cell, unit: Unit) -> f64 {
        const MOST: usize = 12;
        let own = unit_in(&cell.text()).and_then(|symbol| unit_of(&symbol, self.field.is_angle()));
        let exponent = match &cell.content {
            Content::Text(text) => normalise(text, self.mark).map_or(0, |number| {
                let fraction = number.split_once('.').map_or("", |(_, fraction)| fraction);
                let decimals = fraction.bytes().take_while(u8::is_ascii_digit).take(MOST).count();
                -i32::try_from(decimals).unwrap_or(0)
            }),
            Content::Number(number) => number.exponent.min(0),
            Content::Measured(measured) => measured.0.exponent.min(0),
            Content::Empty | Content::Other(_) | Content::Unlike(_) => 0,
        };
        let digit = Decimal { negative: false, digits: 1, exponent };
        quantity(digit, own.unwrap_or(unit)).map_or(1.0, DeviationValue::base)
    }
}
