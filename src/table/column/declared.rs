//! A column whose role, unit and companions are known from the contract or the dictionary. Nothing is guessed here.

use super::nominal::near;
use super::{Column, Companion, Nominal, Problem, Stated, UnitFrom, evaluated};
use crate::deviation::DeviationValue;
use crate::deviation::plausible::Reach;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::quantity::{Angle, Unit, shown};
use crate::table::cell::{Cell, Content};
use crate::table::companions::Companions;
use crate::table::field::{Beside as Role, Field, ValueKind};
use crate::table::grid::unit_of;
use crate::table::number::DecimalMark;
use crate::table::want::Want;

/// What is known of a column.
#[derive(Debug, Clone)]
pub(crate) struct Declared {
    /// The error, or the size of a space or tooth.
    pub(crate) field: Field,
    /// Whether each row is a part, not a space or tooth.
    pub(crate) is_of_part: bool,
    pub(crate) title: String,
    pub(crate) place: usize,
    pub(crate) unit: Unit,
    pub(crate) unit_from: UnitFrom,
    /// Whether its name says that it holds deviations.
    pub(crate) is_deviation: bool,
    /// The decimal mark; `None` as long as no number has decimals.
    pub(crate) mark: Option<DecimalMark>,
    /// Role and place of each companion, and the unit in its heading.
    pub(crate) beside: Vec<(Role, usize, Option<Unit>)>,
}

impl Column {
    /// Makes the column from what is known of it.
    ///
    /// # Errors
    /// A nominal value that is missing, or contradicts what the column holds.
    pub(crate) fn declared(of: &Declared, want: &Want) -> Result<Self, Diagnostics> {
        let kind = of.field.kind().filter(|_| of.is_of_part);
        let module = want.module.filter(|_| of.is_of_part);
        let given = kind.and_then(|kind| want.given(kind));
        let holds = given.and_then(|given| given.holds);
        if of.is_deviation && holds == Some(ValueKind::Measured) {
            let message = format!("`{}` holds deviations by its name, and measured values by the spec", of.title);
            return Err(Diagnostic::error(Code::BadTable, message).help("correct the one that is wrong").into());
        }
        let mut beside = Companions::default();
        for (role, place, unit) in &of.beside {
            beside.set(*role, Some(Companion { place: *place, unit: unit.unwrap_or(of.unit) }));
        }
        let mut column = Self {
            field: of.field,
            kind,
            title: of.title.clone(),
            place: of.place,
            unit: of.unit,
            unit_from: of.unit_from,
            holds: if of.is_deviation { Some(ValueKind::Deviation) } else { holds },
            nominal: Nominal::None,
            evaluated: Stated::None,
            stated: None,
            farthest: Reach::possible(module),
            module,
            tolerance: None,
            mark: of.mark.unwrap_or(DecimalMark::Point),
            mark_is_open: of.mark.is_none(),
            beside,
        };
        if column.field.is_angle() && matches!(of.unit, Unit::Length(_)) {
            column.evaluated = evaluated(given.and_then(|given| given.length), want, &of.title)?;
        } else {
            column.take_declared_nominal(want)?;
        }
        Ok(column)
    }

    fn take_declared_nominal(&mut self, want: &Want) -> Result<(), Diagnostics> {
        if self.holds == Some(ValueKind::Deviation) {
            return Ok(());
        }
        let given = self.field.kind().and_then(|kind| want.given(kind)?.nominal.clone());
        let given = match self.kind {
            Some(_) => given.transpose()?,
            // the place of a space or tooth gives its nominal value, unless a nominal value or a deviation stands beside it
            None if self.beside.get(Role::Nominal).or(self.beside.get(Role::Deviation)).is_none() => return Ok(()),
            None => {
                let over_pin = want.over_pin.filter(|_| self.field == Field::OverPin).map(DeviationValue::Length);
                given.and_then(Result::ok).or(over_pin)
            }
        };
        if self.beside.get(Role::Nominal).is_some() {
            (self.nominal, self.stated) = (Nominal::Beside, given);
        } else if let Some(nominal) = given {
            self.farthest = near(nominal, self.farthest);
            self.nominal = Nominal::Fixed(nominal);
        } else if self.holds == Some(ValueKind::Measured) {
            let message = format!("`{}` holds measured values, and nothing tells their nominal value", self.title);
            let help = "give it in the spec, or a column of nominal values: nominal = \"…\"";
            return Err(Diagnostic::error(Code::MissingKey, message).help(help).into());
        }
        Ok(())
    }

    /// The deviation that a cell means; `None` if the cell says that there is no value.
    ///
    /// # Errors
    /// If the cell holds anything but a number and perhaps its unit, or contradicts what stands beside it.
    pub(crate) fn value(&self, cell: &Cell, beside: Companions<&Cell>) -> Result<Option<DeviationValue>, Problem> {
        if cell.is_missing() {
            return Ok(None);
        }
        self.is_number_alone(cell, self.unit_of_row(beside.get(Role::Unit).copied())?)?;
        for role in [Role::Nominal, Role::Deviation] {
            if let Some(cell) = beside.get(role).filter(|cell| !cell.is_missing()) {
                self.is_number_alone(cell, self.unit_beside(role))?;
            }
        }
        self.read(cell, beside)
    }

    /// Checks that a cell holds a number with the table's decimal mark, and no unit other than `unit`.
    fn is_number_alone(&self, cell: &Cell, unit: Unit) -> Result<(), Problem> {
        let bad = |what: String| Err(Problem::new(format!("`{}` {what}", shown(&cell.text()))));
        let without_unit =
            || bad(format!("has no unit, and no heading gives it: the other cells are in {}", unit.symbol()));
        let text = match &cell.content {
            Content::Text(text) => text,
            Content::Number(_) if self.unit_from == UnitFrom::Cells => return without_unit(),
            _ => return Ok(()),
        };
        let has = |mark: DecimalMark| text.contains(char::from(mark.byte()));
        let other = if self.mark == DecimalMark::Point { DecimalMark::Comma } else { DecimalMark::Point };
        if self.mark_is_open && (has(self.mark) || has(other)) {
            return bad(
                "has decimals, and no number before it tells the decimal mark: say it, decimal = \"comma\"".to_owned()
            );
        }
        if has(other) {
            return bad(format!("has a {}, and the table's numbers have a decimal {}", other.word(), self.mark.word()));
        }
        if matches!(unit, Unit::Angle(_)) && text.parse::<Angle>().is_ok() && text.contains(['°', '′', '\'']) {
            return Ok(());
        }
        let end = text.rfind(|c: char| c.is_numeric() || c == '.' || c == ',').map_or(0, |at| at + 1);
        let end = (end..=text.len()).find(|at| text.is_char_boundary(*at)).unwrap_or(text.len());
        let (number, behind) = (&text[..end], text[end..].trim());
        if number.ends_with(char::from(self.mark.byte())) {
            return bad("ends in its decimal mark: digits may be missing".to_owned());
        }
        if number.contains(|c: char| {
            c.is_alphabetic() && !matches!(c, 'e' | 'E') || matches!(c, '±' | '/' | '(' | '<' | '>' | '~' | '=' | '*')
        }) {
            return bad("is not a number alone".to_owned());
        }
        let own = unit_of(behind, self.field.is_angle());
        match own {
            _ if behind.is_empty() && self.unit_from == UnitFrom::Cells => without_unit(),
            _ if behind.is_empty() => Ok(()),
            Some(own) if own == unit => Ok(()),
            Some(own) => {
                let by_key = format!(", by its key: unit = \"{}\" in its entry says otherwise", own.symbol());
                let by_key = if self.unit_from == UnitFrom::Key { &*by_key } else { "" };
                bad(format!("is in {}, and the column in {}{by_key}", own.symbol(), unit.symbol()))
            }
            None => bad("is not a number alone".to_owned()),
        }
    }
}
