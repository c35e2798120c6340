//! The measurements of a table with a row per characteristic: the cells of a row by the part and the field that they belong to.

use std::collections::HashMap;
use std::ops::Range;

use super::Characteristics;
use super::roles::names_one_part;
use crate::table::cell::{Cell, Record};
use crate::table::column::is_limit;
use crate::table::companions::Companions;
use crate::table::grid::{bare_unit, differ, is_unit};
use crate::table::names::{Field, Role, ValueKind, split_unit};
use crate::table::shape::headings::Named;
use crate::table::shape::{Measurement, NoShape, Series, distinct};
use crate::table::unknown::Unknown;
use crate::table::want::Want;

/// What the cells of a row are, by the part and the field that they belong to.
pub(super) struct Reading<'a> {
    found: &'a Characteristics<'a>,
    want: &'a Want,
    pub(super) parts: Vec<Cell>,
    /// The index of each part by its name, where a column names it.
    indices: HashMap<String, usize>,
    pub(super) lines: Vec<u64>,
    /// Whether a row has a unit beside its value.
    has_units: bool,
}

impl<'a> Reading<'a> {
    pub(super) fn new(found: &'a Characteristics<'a>, want: &'a Want) -> Self {
        let has_unit = |place| found.column(place).any(|cell| is_unit(&cell.text()));
        let has_units = found.place(Role::Unit).is_some_and(has_unit);
        let first = found.rows.first().map_or(found.header.line, |row| row.line);
        let (mut parts, mut indices, mut lines) = (Vec::new(), HashMap::new(), Vec::new());
        if let Some(place) = found.place(Role::Part) {
            for row in &found.rows {
                indices.entry(row.cell(place).text().into_owned()).or_insert_with(|| {
                    lines.push(row.line);
                    parts.push(row.cell(place).clone());
                    parts.len() - 1
                });
            }
        } else if found.parts.is_empty() {
            (parts, lines) = (vec![Cell::default()], vec![first]);
        } else {
            parts = found.parts.iter().map(|place| found.header.cells[*place].clone()).collect();
            lines = vec![first; parts.len()];
        }
        Self { found, want, parts, indices, lines, has_units }
    }

    /// Rows of which the name is not known.
    pub(super) fn unknown(&self, name: &Cell, rows: &[&Record]) -> Unknown {
        let is_value =
            |place: usize| place != self.found.name && self.found.roles.get(place) != Some(&Some(Role::Part));
        let cells = rows.iter().flat_map(|row| row.cells.iter().enumerate());
        let mut cells: Vec<Cell> = cells.filter(|(place, _)| is_value(*place)).map(|(_, cell)| cell.clone()).collect();
        if !cells.iter().any(Cell::is_number) {
            // where a separator is lost, the value stands behind the name
            cells.extend(name.text().split_whitespace().next_back().map(|last| Cell::of_text(last, 0..0)));
        }
        let unit = self.unit_of_rows(rows).ok().flatten();
        // behind the name of a part stands a value of it
        let is_unread = names_one_part(&name.text()) && cells.iter().any(Cell::is_number);
        Unknown { unit, is_unread, ..Unknown::line(&name.text(), rows[0].line, cells).measured(true) }
    }

    /// The parts that a row has values of: its own, or all.
    fn parts_of(&self, record: &Record) -> Range<usize> {
        let name = self.found.place(Role::Part).map(|place| record.cell(place).text());
        let own = name.and_then(|name| self.indices.get(name.as_ref()).copied());
        own.map_or(0..self.parts.len(), |part| part..part + 1)
    }

    /// The cells of a role, one per part: of its column, or of the parts'; `None` if there is none.
    fn series(&self, role: Role, rows: &[&Record], title: &Cell, field: Field) -> Result<Option<Series>, NoShape> {
        let of_part = |part: usize| self.found.parts.get(part).copied().filter(|_| role == Role::Measured);
        let column = self.found.place(role);
        let mut cells = vec![None; self.parts.len()];
        for record in rows {
            for part in self.parts_of(record) {
                let Some(place) = of_part(part).or(column) else { return Ok(None) };
                if cells[part].replace(record.value(place)).is_some() {
                    return Err(NoShape::Twice { heading: title.clone(), field, may_tell: self.may_tell(rows) });
                }
            }
        }
        let cells: Vec<Cell> = cells.into_iter().map(Option::unwrap_or_default).collect();
        let unit = column.and_then(|place| split_unit(&self.found.title(place)).1);
        let series = Series { title: title.text().into_owned(), place: column.unwrap_or(0), unit, cells };
        let is_there = of_part(0).is_some() || series.cells.iter().any(|cell| !cell.is_missing());
        Ok(is_there.then_some(series))
    }

    /// The columns without a role that may tell of which parts rows are, where none is known to: no two rows have the same there.
    fn may_tell(&self, rows: &[&Record]) -> Vec<String> {
        let differs = |place: &usize| {
            let cells = rows.iter().map(|row| row.cell(*place)).filter(|cell| !cell.is_missing());
            self.found.roles[*place].is_none() && distinct(cells) == rows.len()
        };
        let is_told = self.found.place(Role::Part).is_some() || !self.found.parts.is_empty();
        let places = (0..self.found.roles.len()).filter(|place| !is_told && differs(place));
        places.map(|place| self.found.title(place)).collect()
    }

    /// The values of one characteristic.
    pub(super) fn measurement(&self, named: &Named, rows: &[&Record], title: &Cell) -> Result<Measurement, NoShape> {
        let unit_of_row = self.unit_of_rows(rows)?;
        if differ(named.series.unit.as_deref(), unit_of_row.as_deref()) {
            return Err(NoShape::Units { record: rows[0].clone() });
        }
        // where others have a unit beside them, none is assumed
        let missing = || self.has_units.then(String::new);
        let unit = named.series.unit.clone().or(unit_of_row).or_else(missing);
        // the unit in the heading of a column is that of its numbers
        let united = |series: Series| Series { unit: series.unit.clone().or_else(|| unit.clone()), ..series };
        let of_role = |role: Role| Ok(self.series(role, rows, title, named.field)?.map(united));
        let (measured, deviation) = (of_role(Role::Measured)?, of_role(Role::Deviation)?);
        let mut beside = Companions::default();
        let headed = |series: Series| Series { title: self.found.title(series.place), ..series };
        for role in [Role::Nominal, Role::Upper, Role::Lower, Role::Uncertainty] {
            beside.set(role, of_role(role)?.map(headed));
        }
        // what is wanted of a deviation is a limit: `max. 10 µm`
        let are_limits = |wanted: &Series| wanted.cells.iter().all(|cell| cell.is_missing() || is_limit(&cell.text()));
        if let Some(limit) = beside.get(Role::Nominal).filter(|wanted| are_limits(wanted)).cloned() {
            beside.set(Role::Nominal, None);
            beside.set(Role::Upper, Some(limit));
        }
        let nothing = || vec![Cell::default(); self.parts.len()];
        // the value and its nominal, or else the deviation
        let given = named.field.kind().and_then(|kind| self.want.given(kind));
        let in_spec = given.is_some_and(|given| given.nominal.is_some());
        let (value, deviation, holds) = match (measured, deviation) {
            (Some(measured), deviation) if beside.get(Role::Nominal).is_some() || (in_spec && deviation.is_some()) => {
                (measured, deviation, Some(ValueKind::Measured))
            }
            (None, Some(deviation)) if self.found.place(Role::Measured).is_some() && says_zero(&deviation) => {
                // a report that nobody filled in
                (Series { cells: nothing(), ..deviation }, None, Some(ValueKind::Deviation))
            }
            (measured, Some(deviation)) => {
                beside.set(Role::Measured, measured.map(headed));
                (deviation, None, Some(ValueKind::Deviation))
            }
            (measured, None) => {
                // without values, any unit will do
                let unit = unit.clone().filter(|unit| !unit.is_empty());
                let unit = unit.or_else(|| Some(if named.field.is_angle() { "°" } else { "mm" }.to_owned()));
                let empty = || Series { unit, cells: nothing(), ..named.series.clone() };
                (measured.unwrap_or_else(empty), None, named.holds)
            }
        };
        let has_value = value.cells.iter().any(|cell| !cell.is_missing());
        if has_value && differ(value.unit.as_deref(), unit.as_deref()) {
            return Err(NoShape::Units { record: rows[0].clone() });
        }
        if named.aspect != Role::Measured {
            return Err(NoShape::twice(title, named.field));
        }
        beside.set(Role::Deviation, deviation.map(headed));
        Ok(Measurement { holds, value, beside, ..Measurement::of(named.field) })
    }

    /// The unit in the column of units, which is the same for every row of a characteristic.
    fn unit_of_rows(&self, rows: &[&Record]) -> Result<Option<String>, NoShape> {
        let Some(place) = self.found.place(Role::Unit) else { return Ok(None) };
        let unit_of = |record: &Record| {
            let cell = Some(record.cell(place)).filter(|cell| !cell.is_missing())?;
            Some(bare_unit(&cell.text()).to_owned())
        };
        let unit = unit_of(rows[0]);
        match rows.iter().find(|record| unit_of(record) != unit) {
            Some(record) => Err(NoShape::Units { record: (*record).clone() }),
            None => Ok(unit),
        }
    }
}

/// Whether no digit of its numbers is other than 0.
fn says_zero(series: &Series) -> bool {
    !series.cells.iter().any(|cell| cell.text().contains(|c: char| ('1'..='9').contains(&c)))
}
