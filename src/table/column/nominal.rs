//! What is taken from a measured value: the nominal one of the spec, of the table or of its row.

use super::{Column, Nominal, Problem, SMALLEST_DIGIT, has_tolerance_behind, unit_of};
use crate::deviation::DeviationValue;
use crate::deviation::plausible::Reach;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::quantity::{Angle, Length, Unit};
use crate::table::cell::Cell;
use crate::table::companions::Companions;
use crate::table::names::{Field, Role, ValueKind, WordList, says_deviation, split_unit, split_wanted};
use crate::table::number::DecimalMark;
use crate::table::shape::Measurement;
use crate::table::want::{Want, ignore_option};

impl Column {
    /// A deviation beside a measured value whose nominal one nothing tells is that from 0, or from a size that parts have.
    pub(super) fn has_value_of_deviation(&self, measurement: &Measurement) -> Result<(), Diagnostic> {
        let Some(measured) = measurement.beside.get(Role::Measured) else { return Ok(()) };
        let unit = measured.unit.as_deref().and_then(|symbol| unit_of(symbol, self.field.is_angle()));
        let unit = unit.unwrap_or(self.unit);
        let is_of = |value: &Cell, deviation: &Cell| {
            let rounding = 0.5 * (self.digit(value, unit) + self.digit(deviation, self.unit));
            let nominal = self.quantity_in(value, unit).and_then(|value| Ok(value.less(self.quantity(deviation)?)));
            nominal.is_ok_and(|nominal| nominal.abs().base() <= rounding || nominal.is_size(self.module))
        };
        let pairs = measured.cells.iter().zip(&measurement.value.cells);
        let mut both = pairs.filter(|(value, deviation)| !value.is_missing() && !deviation.is_missing());
        let Some((value, deviation)) = both.find(|(value, deviation)| !is_of(value, deviation)) else { return Ok(()) };
        let (value, deviation) = (value.text(), deviation.text());
        let message = format!(
            "`{}`: {value} is measured, {deviation} is its deviation, and no size of a part lies between them",
            self.title
        );
        Err(Diagnostic::error(Code::BadTable, message).help("correct the one that is wrong, or give the nominal value"))
    }

    /// What stands beside a value as wanted is its nominal one if it is 0 or the spec gives one that it is held against, or else
    /// if it is a size that parts have; a requirement needs a tolerance as well. Anything else may be a limit.
    pub(super) fn has_clear_nominal(&self, measurement: &Measurement) -> Result<(), Diagnostic> {
        let wanted = measurement.beside.get(Role::Nominal).filter(|_| self.stated.is_none());
        let Some((wanted, kind)) = wanted.zip(self.kind) else { return Ok(()) };
        let is_requirement = WordList::Requirement.has(&wanted.title);
        let is_size = |cell: &Cell| {
            let size = self.quantity_in(cell, self.unit_beside(Role::Nominal)).ok();
            size.is_none_or(DeviationValue::is_zero)
                || size.is_some_and(|size| size.is_size(self.module)) && !says_deviation(&self.title) && !is_requirement
                || is_requirement && has_tolerance_behind(&cell.text())
        };
        let Some(open) = wanted.cells.iter().find(|cell| !cell.is_missing() && !is_size(cell)) else { return Ok(()) };
        let message =
            format!("`{}`: {} `{}` may be the nominal value or a limit", self.title, wanted.title, open.text());
        let help = format!(
            "call the column limit, or leave it out: {}; or give the nominal value in the spec: [errors] {} = {{ nominal = … }}",
            ignore_option(&wanted.title),
            kind.key()
        );
        Err(Diagnostic::error(Code::BadTable, message).help(help))
    }

    /// Two nominal values beside an error of a part that are not the same.
    pub(in crate::table) fn differing_nominals<'m>(&self, measurement: &'m Measurement) -> Option<[&'m Cell; 2]> {
        let nominals = measurement.beside.get(Role::Nominal).filter(|_| self.kind.is_some())?;
        let size = |cell: &Cell| Some(self.quantity_in(cell, self.unit_beside(Role::Nominal)).ok()?.base());
        let mut cells = nominals.cells.iter().filter(|cell| !cell.is_missing());
        let first = cells.next()?;
        let is_other = |cell: &&Cell| {
            size(first).zip(size(cell)).is_some_and(|(first, size)| (first - size).abs() > SMALLEST_DIGIT)
        };
        Some([first, cells.find(is_other)?])
    }

    /// Holds the nominal value in a column's name against its own: `Rollenmaß 25±0,03`.
    pub(super) fn has_size_of_title(&self, want: &Want) -> Result<(), Diagnostic> {
        let (name, _) = split_unit(&self.title);
        let size = split_wanted(&name).and_then(|wanted| wanted.nominal).filter(|_| !want.is_own(&self.title));
        let Some(size) = size else { return Ok(()) };
        // where numbers have no mark, as those of a workbook, a title has either
        let is_own = |mark: DecimalMark| {
            let said = self.with_mark(mark).quantity(&Cell::of_text(size, 0..0)).ok();
            said.is_some() && said == self.nominal_of_every_part()
        };
        if DecimalMark::ALL.into_iter().any(is_own) {
            return Ok(());
        }
        let message = format!("`{}` says that the nominal value is {size}, and nothing else says so", self.title);
        Err(Diagnostic::error(Code::BadTable, message).help("give the same nominal value in the spec"))
    }

    /// Decides what is taken from a value: what stands beside it, or what the spec says. Of a space or tooth, the spec says
    /// it only where the deviation stands beside the value; any other is taken from its nominal place later.
    pub(super) fn take_nominal(&mut self, measurement: &Measurement, want: &Want) -> Result<(), Diagnostics> {
        if self.kind.is_some() {
            self.module = want.module;
            self.farthest = Reach::possible(want.module);
        }
        let is_over_pin = self.kind.is_none() && self.field == Field::OverPin;
        let over_pin = want.over_pin.filter(|_| is_over_pin).map(DeviationValue::Length);
        let given = self.field.kind().and_then(|kind| want.given(kind)?.nominal.clone());
        if self.beside.get(Role::Nominal).is_some() {
            self.stated = given.clone().and_then(Result::ok).or(over_pin);
        }
        if self.holds == Some(ValueKind::Deviation) {
            return Ok(());
        }
        if self.beside.get(Role::Nominal).is_some() {
            self.nominal = Nominal::Beside;
            return Ok(());
        }
        let in_spec = match self.kind {
            Some(_) => given.transpose()?,
            None if self.beside.get(Role::Deviation).is_some() => given.and_then(Result::ok).or(over_pin),
            None => None,
        };
        let in_row = measurement.nominal_in_row.as_ref().and_then(|cell| self.quantity(cell).ok());
        let in_row =
            in_row.filter(|size| self.kind.is_some() && !says_deviation(&self.title) && size.is_size(self.module));
        if let Some(nominal) = in_spec.or(in_row) {
            self.farthest = near(nominal, self.farthest);
            self.nominal = Nominal::Fixed(nominal);
        } else if let Some(kind) = self.kind
            && self.holds == Some(ValueKind::Measured)
            && !want.only_shown
        {
            let message =
                format!("`{}` holds measured values, and nothing tells the nominal value of {kind}", self.title);
            return Err(Diagnostic::error(Code::MissingKey, message)
                .help(format!(
                    "give it in the spec: [errors] {} = {{ nominal = … }}; or a column of nominal values",
                    kind.key()
                ))
                .into());
        }
        Ok(())
    }

    /// The nominal value that every part has; 0 of deviations.
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
            return self.stated.ok_or_else(|| Problem::Bad("there is no nominal value beside it".to_owned()));
        };
        match self.stated {
            Some(stated) if !self.agrees(stated, nominal, beside) => {
                Err(Problem::Bad(format!("the nominal value is {nominal} in the table and {stated} in the spec")))
            }
            Some(stated) => Ok(stated),
            None => Ok(nominal),
        }
    }

    /// Holds the nominal value beside a deviation against the spec's; a deviation may have that of its own, 0.
    pub(super) fn holds_from_nominal(&self, beside: &Companions<&Cell>) -> Result<(), Problem> {
        let is_size = |nominal: DeviationValue| !nominal.is_zero();
        if self.stated.is_some() && self.quantity_beside(beside, Role::Nominal)?.is_some_and(is_size) {
            self.nominal_beside(beside)?;
        }
        Ok(())
    }

    /// Whether the nominal values of the spec and of a cell are the same but for the cell's last digit.
    fn agrees(&self, stated: DeviationValue, nominal: DeviationValue, beside: &Companions<&Cell>) -> bool {
        let half = self.digit_beside(beside, Role::Nominal).map_or(0.0, |digit| SMALLEST_DIGIT.min(digit / 2.0));
        stated == nominal || (stated.base() - nominal.base()).abs() <= half
    }

    /// Whether a measured value is near a nominal one.
    pub(crate) fn is_near(&self, value: DeviationValue, nominal: DeviationValue) -> bool {
        self.less(value, nominal).is_ok()
    }

    /// A measured value less its nominal one, if they are near each other.
    pub(super) fn less(&self, value: DeviationValue, nominal: DeviationValue) -> Result<DeviationValue, Problem> {
        let deviation = value.less(nominal);
        if near(nominal, self.farthest).is_exceeded_by(deviation) {
            return Err(Problem::Far(format!("{value} is far from the nominal value {nominal}")));
        }
        Ok(deviation)
    }
}

/// How far a measured value may be from its nominal one: a tenth of it, and no further than any deviation.
pub(super) fn near(nominal: DeviationValue, possible: Reach) -> Reach {
    match nominal {
        DeviationValue::Length(nominal) if !nominal.is_zero() => {
            possible.within(Length::from_fm((nominal.abs().fm() / 10).max(1)))
        }
        _ => possible,
    }
}
