//! The unit of a column's numbers, and who tells it.

use std::mem::discriminant;

use super::{Column, Problem};
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::{AngleUnit, LengthUnit, Unit, shown};
use crate::table::cell::{Cell, Content};
use crate::table::grid::{bare_unit, unit_in};
use crate::table::names::{Field, Role, split_unit};
use crate::table::number::DecimalMark;
use crate::table::shape::{Measurement, Series};
use crate::table::want::{Want, ignore_option, mapping};

/// Where the unit of a column is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum UnitFrom {
    /// The table: a heading, a row of units, the cells.
    Table,
    /// A column of units beside the values.
    Beside,
    /// The spec.
    Spec,
    /// A column that is called by its key has that of a spec.
    Key,
}

impl Column {
    /// Whether a text is the unit of its numbers.
    pub(crate) fn has_unit(&self, text: &str) -> bool {
        unit_of(text, self.field.is_angle()) == Some(self.unit)
    }

    /// The unit of a row's value: the column's, or where only a column of units tells it and nothing else stands beside the
    /// value, what that says here.
    pub(crate) fn unit_of_row(&self, cell: Option<&Cell>) -> Result<Unit, Problem> {
        let Some(cell) = cell else { return Ok(self.unit) };
        let text = cell.text();
        if self.has_unit(&text) || cell.is_missing() && self.unit_from != UnitFrom::Beside {
            return Ok(self.unit);
        }
        let is_own = self.unit_from == UnitFrom::Beside && self.beside.iter().count() == 1;
        let own = unit_of(&text, self.field.is_angle()).filter(|unit| discriminant(unit) == discriminant(&self.unit));
        own.filter(|_| is_own).ok_or_else(|| {
            Problem::Bad(format!(
                "the unit beside it is `{}`, and the column's is {}",
                shown(&text),
                self.unit.symbol()
            ))
        })
    }

    /// The unit of a companion's numbers.
    pub(super) fn unit_beside(&self, role: Role) -> Unit {
        self.beside.get(role).map_or(self.unit, |companion| companion.unit)
    }

    /// Whether a length has another unit behind it than the column's.
    pub(super) fn is_in_other_unit(&self, text: &str) -> bool {
        let unit = unit_in(text).and_then(|unit| unit_of(&unit, self.field.is_angle()));
        unit.is_some_and(|unit| matches!(unit, Unit::Length(_)) && unit != self.unit)
    }
}

/// The unit of a column: of its heading or cells, of the spec, or that of its key.
pub(super) fn unit(
    measurement: &Measurement,
    kind: Option<DeviationKind>,
    want: &Want,
    mark: DecimalMark,
) -> Result<(Unit, UnitFrom), Diagnostic> {
    let value = &measurement.value;
    let is_angle = measurement.field.is_angle();
    let dimension = |symbol: &str| unit_of(symbol, is_angle);
    let beside =
        measurement.beside.get(Role::Unit).and_then(|units| units.cells.iter().find(|cell| !cell.is_missing()));
    let beside = beside.map(Cell::text);
    let unit_from = if value.unit.is_none() && beside.is_some() { UnitFrom::Beside } else { UnitFrom::Table };
    let stated = kind.and_then(|kind| want.stated_unit(kind, &value.title));
    let unknown = |symbol: &str| unknown_unit(&value.title, symbol, is_angle);
    let symbol = value.unit.as_deref().or(beside.as_deref());
    let written = symbol.map(|symbol| dimension(symbol).ok_or_else(|| unknown(symbol))).transpose()?;
    match (stated, written) {
        (Some(stated), Some(written)) if stated != written => {
            let message =
                format!("`{}`: the table says {} and the spec {}", value.title, written.symbol(), stated.symbol());
            return Err(Diagnostic::error(Code::BadTable, message).help("correct the one that is wrong"));
        }
        (_, Some(written)) => return Ok((written, unit_from)),
        (Some(stated), None) => return Ok((stated, UnitFrom::Spec)),
        (None, None) => {}
    }
    let default = if is_angle { Unit::Angle(AngleUnit::Degree) } else { Unit::Length(LengthUnit::Millimetre) };
    let numbers = value.cells.iter().filter(|cell| cell.is_number());
    let carries = |cell: &Cell| matches!(&cell.content, Content::Text(text) if !text.trim_end().ends_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | ',') || ('\u{ff10}'..='\u{ff19}').contains(&c)));
    // f_Hβ in µm: the cells tell that it is no angle
    let in_cells =
        || numbers.clone().next().and_then(|cell| unit_in(&cell.text())).and_then(|symbol| dimension(&symbol));
    let of_slope = in_cells().filter(|unit| is_angle && matches!(unit, Unit::Length(_)));
    // a cell that is no measure says nothing of the unit
    if numbers.clone().any(carries) && numbers.clone().all(|cell| carries(cell) || !cell.is_measure()) {
        return Ok((of_slope.unwrap_or(default), UnitFrom::Table));
    }
    let is_of_tooth = kind.is_none() && is_key(&value.title, of_tooth(measurement.field));
    let by_key =
        is_of_tooth || is_key(&value.title, measurement.field) || want.is_own(&value.title) || !want.fields.is_empty();
    if by_key {
        return Ok((default, UnitFrom::Key));
    }
    if let Some(stated) = measurement.stated_unit.or_else(|| behind_nominal(measurement)) {
        return Ok((stated, UnitFrom::Table));
    }
    let message =
        format!("`{}` is {}, and nothing tells the unit of its numbers", value.title, measurement.field.key());
    let units = if is_angle { ["deg", "arcmin"] } else { ["mm", "um"] };
    let units = fitting(measurement, kind, want, mark, units);
    let in_spec = kind.map(|kind| {
        let column = mapping(kind.key(), Some(kind), &value.title, Some(units[0]));
        let other = units.get(1).map_or_else(String::new, |other| format!(", or unit = \"{other}\""));
        format!("; or say it in the spec: [batch.columns] {column}{other}")
    });
    let help = behind_name(&value.title, &units) + &in_spec.unwrap_or_default();
    Err(Diagnostic::error(Code::BadTable, message).help(help))
}

/// The unit behind every nominal value beside the values: `25.000 ±0.050 mm`.
fn behind_nominal(measurement: &Measurement) -> Option<Unit> {
    let nominals = measurement.beside.get(Role::Nominal)?.cells.iter().filter(|cell| !cell.is_missing());
    let mut units = nominals.map(|cell| unit_of(&unit_in(&cell.text())?, measurement.field.is_angle()));
    let unit = units.next()??;
    units.all(|other| other == Some(unit)).then_some(unit)
}

/// Of two units, those in which the numbers of a measurement may be its values; both if there is none.
pub(crate) fn fitting<'u>(
    measurement: &Measurement,
    kind: Option<DeviationKind>,
    want: &Want,
    mark: DecimalMark,
    units: [&'u str; 2],
) -> Vec<&'u str> {
    let numbers = || measurement.value.cells.iter().filter(|cell| cell.is_number());
    let fits = |symbol: &&str| {
        let value = Series { unit: Some((*symbol).to_owned()), ..measurement.value.clone() };
        let column = Column::new(&Measurement { value, ..measurement.clone() }, kind, want, mark);
        column.is_ok_and(|column| numbers().all(|cell| column.may_hold(cell)))
    };
    let fitting: Vec<&str> = units.into_iter().filter(fits).collect();
    if fitting.is_empty() { units.to_vec() } else { fitting }
}

/// The advice to write one of some units behind a name.
pub(crate) fn behind_name(title: &str, units: &[&str]) -> String {
    let headings: Vec<_> = units.iter().map(|unit| format!("`{title} [{unit}]`")).collect();
    format!("write the unit behind the name: {}", headings.join(" or "))
}

/// The unit that a symbol is of a length, or of an angle or the length that f_Hβ is.
pub(crate) fn unit_of(symbol: &str, is_angle: bool) -> Option<Unit> {
    // where a unit stands, `my` is the German name of µ
    let symbol = match bare_unit(symbol) {
        "my" | "µ m" | "0,001 mm" | "0.001 mm" | "0,001mm" | "0.001mm" => "µm",
        "0,01 mm" | "0.01 mm" => "1/100 mm",
        symbol => symbol,
    };
    if is_angle { Unit::of_angle(symbol).or_else(|| Unit::of_length(symbol)) } else { Unit::of_length(symbol) }
}

/// Whether a title is the key of a field, with nothing but case changed.
fn is_key(title: &str, field: Field) -> bool {
    let (name, _) = split_unit(title);
    let title = name.trim().to_lowercase();
    let key = field.key();
    title == key || title.strip_suffix("_deviation").is_some_and(|stem| stem == key)
}

/// What an error of a part is called in a table of its teeth or spaces.
fn of_tooth(field: Field) -> Field {
    match field {
        Field::Error(DeviationKind::PinionRadial) => Field::Radial,
        Field::Error(DeviationKind::RackLead) => Field::Lead,
        field => field,
    }
}

pub(super) fn unknown_unit(title: &str, symbol: &str, is_angle: bool) -> Diagnostic {
    if symbol.is_empty() {
        let message = format!("`{title}` has no unit beside it, and others have");
        return Diagnostic::error(Code::BadTable, message).help("write the unit of every value");
    }
    let (what, units) = if is_angle { ("an angle", AngleUnit::NAMES) } else { ("a length", LengthUnit::NAMES) };
    let message = format!("`{title}`: `{}` is not a unit of {what}", shown(symbol));
    // the micro sign of code page 850
    let help = if symbol.contains('æ') {
        "the file is in code page 850, as DOS programs write it: save it as UTF-8".to_owned()
    } else {
        format!("write {units}; or leave it out: {}", ignore_option(title))
    };
    Diagnostic::error(Code::BadTable, message).help(help)
}
