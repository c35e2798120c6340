//! Records from which on nothing can be trusted: another header, other units, a value where none was read so far.

use std::mem::discriminant;

use super::super::block::Contradiction;
use super::super::cell::{Cell, Record};
use super::super::column::{Column, is_limit};
use super::super::grid::{bare_unit, only_units};
use super::super::lines::{Beside, of_all_values};
use super::super::names::{Role, WordList, heading, is_of_parts, is_value_heading, names_value, role, split_unit};
use super::super::reading::AsideReading;
use super::super::shape::{Remarks, has_digit, stated_units};
use super::super::strangers::Others;
use super::super::understand::said_of_other;
use super::super::unknown::speaks_of_value;
use super::aside::may_be_statistic;
use super::{Rows, Setup};
use crate::quantity::{Unit, shown};

impl Rows {
    /// Why nothing from a record on can be trusted.
    pub(super) fn contradiction(&self, record: &Record) -> Option<Contradiction> {
        if only_units(&record.cells).is_some() && !self.repeats_units(record) || self.states_other_unit(record) {
            let column = self.setup.columns.first().map(|column| &column.title);
            let message = format!("the units change: {}", record.in_words());
            return Some(contradiction(record, column, message, "write every table with one unit by itself"));
        }
        let is_value = |place: &&usize| {
            let is_nameless = self.setup.titles.get(**place).is_some_and(String::is_empty);
            let cell = record.cell(**place);
            cell.is_number() || is_nameless && speaks_of_value(&cell.text())
        };
        if let Some(watched) = self.setup.watched.iter().find(is_value) {
            let message = "it holds a number here, and nothing tells what it measures".to_owned();
            let help = "say in the spec what it is, under [batch.columns], or leave it out with --ignore";
            return Some(contradiction(record, self.setup.titles.get(*watched), message, help));
        }
        self.other_header(record)
            .or_else(|| self.other_nominal(record))
            .or_else(|| self.error_as_part(record))
            .or_else(|| self.value_in_remark(record))
            .or_else(|| self.other_part(record))
            .or_else(|| self.said_of_all(record))
    }

    /// A line of words that says of all values that they do not count, or what else they are: `Sollwerte`.
    fn said_of_all(&self, record: &Record) -> Option<Contradiction> {
        let mut cells = record.cells.iter().filter(|cell| !cell.is_empty());
        let (Some(cell), None) = (cells.next(), cells.next()) else { return None };
        let line = AsideReading { line: record.line, text: cell.text().into_owned() };
        of_all_values(&line, &self.setup.columns, &self.setup.want)
            .filter(|said| !said.is_ignored(&self.setup.want))?;
        let message = format!("it says of all values that they are none of parts: {}", shown(&line.text));
        let help = "take the line out of the table, with the rows of which it speaks; or leave it out with --ignore";
        Some(contradiction(record, None, message, help))
    }

    /// A remark that speaks of a value, which may correct the one that is read.
    fn value_in_remark(&self, record: &Record) -> Option<Contradiction> {
        let Setup { columns, titles, names, want, .. } = &self.setup;
        let beside = Beside { columns, width: titles.len(), of_parts: Some(names), measured: None };
        let value = |Remarks { place, has_digits, .. }: &Remarks| {
            if *has_digits {
                return None;
            }
            let cell = Some(record.cell(*place)).filter(|cell| has_digit(&cell.text()))?;
            let value = beside.value_in_remark(cell, &format!("column {}", place + 1), record.line)?;
            let is_left_out = value.is_ignored(want) || Others::of(columns, want).leaves_out(&value);
            (!is_left_out).then(|| (*place, cell.text()))
        };
        let (place, text) = self.setup.remarks.iter().find_map(value)?;
        let message = format!("a remark that may be a measured value: {}", shown(&text));
        let help = "correct the value that it speaks of, or leave the column out with --ignore";
        Some(contradiction(record, titles.get(place), message, help))
    }

    /// A cell that says that a row is the other part, where none did so far.
    fn other_part(&self, record: &Record) -> Option<Contradiction> {
        let Setup { columns, titles, want, .. } = &self.setup;
        let places = self.setup.remarks.iter().filter(|remarks| remarks.says_part).map(|remarks| remarks.place);
        let mut refused = places.filter_map(|place| {
            let text = record.cell(place).text();
            Some((place, said_of_other(columns, titles.get(place)?, &text, &text, want)?.message))
        });
        let (place, message) = refused.next()?;
        let help = "give the rows of each part by themselves, or leave the column out with --ignore";
        Some(contradiction(record, titles.get(place), message, help))
    }

    /// Another header among the rows: its columns are not those that are read.
    fn other_header(&self, record: &Record) -> Option<Contradiction> {
        let is_name = |cell: &&Cell| {
            self.setup.titles.iter().any(|title| *title == cell.text()) || heading(&cell.text(), &[]).is_some()
        };
        let names_column = |cell: &Cell| {
            self.setup.columns.iter().any(|column| column.title == cell.text()) || names_value(&cell.text(), &[])
        };
        let cells = || record.cells.iter().filter(|cell| !cell.is_missing());
        // `Teil` below `Teil` begins another table, whatever stands beside it
        let is_named_again = || {
            let title = self.setup.id.and_then(|id| Some((self.setup.titles.get(id)?, record.cells.get(id)?)));
            title.is_some_and(|(title, cell)| !cell.is_empty() && cell.text() == *title) && cells().count() > 1
        };
        let is_other = record.numbers() == 0
            && (cells().any(names_column) && cells().filter(is_name).count() > 1 || is_named_again())
            && !self.repeats_header(record);
        let message = || format!("other names begin here: {}", record.in_words());
        is_other.then(|| contradiction(record, None, message(), "give tables with other columns one by one"))
    }

    /// A row of nominal values that are not those of the columns.
    fn other_nominal(&self, record: &Record) -> Option<Contradiction> {
        let name = self.label(record)?;
        if !may_be_statistic(name.as_bytes()) || role(&name) != Some(Role::Nominal) {
            return None;
        }
        let other = self.setup.columns.iter().find(|column| {
            let cell = record.cell(column.place);
            let is_said = !cell.is_missing() && !is_limit(&cell.text());
            is_said && column.quantity(cell).ok() != column.nominal_of_every_part()
        })?;
        let message = format!("the nominal value here is not the column's: {}", record.in_words());
        let help = "give the nominal value in the spec, or in a column beside the values";
        Some(contradiction(record, Some(&other.title), message, help))
    }

    /// A line such as `rack_pitch;0.2` or `Korrektur;0,1` below the parts, which names no part.
    fn error_as_part(&self, record: &Record) -> Option<Contradiction> {
        let id = self.setup.id?;
        let name = record.cell(id).text();
        let is_word = name.len() > 1 && may_be_statistic(name.as_bytes()) && !is_of_parts(&name);
        if !is_word || record.numbers() == 0 || !(is_value_heading(&name, &[]) || WordList::Correction.has(&name)) {
            return None;
        }
        let message =
            format!("an error or a correction stands here where parts have their names: {}", record.in_words());
        let help = "write a table with a row per part, or one with a row per error";
        Some(contradiction(record, self.setup.titles.get(id), message, help))
    }

    /// Whether a line without numbers states a unit that no column has, of length or angle as some have: `Werte in mm`.
    fn states_other_unit(&self, record: &Record) -> bool {
        let columns = &self.setup.columns;
        let is_below_units = |column: &Column| column.has_unit(&record.cell(column.place).text());
        if record.numbers() > 0 || self.repeats_header(record) || columns.iter().any(is_below_units) {
            return false;
        }
        let is_other = |unit: Unit| {
            let is_alike = |column: &&Column| discriminant(&column.unit) == discriminant(&unit);
            columns.iter().any(|column| is_alike(&column)) && columns.iter().all(|column| column.unit != unit)
        };
        record.cells.iter().filter(|cell| !has_digit(&cell.text())).any(|cell| {
            let text = cell.text();
            let of_heading = split_unit(&text).1.and_then(|unit| Unit::from_symbol(&unit));
            let alone = Unit::from_symbol(bare_unit(&text));
            let stated = stated_units(&text).into_iter().filter(|stated| stated.is_clear).map(|stated| stated.unit);
            of_heading.into_iter().chain(alone).chain(stated).any(is_other)
        })
    }
}

/// A record that contradicts how the table is read, in a column or as a whole.
pub(super) fn contradiction(
    record: &Record,
    column: Option<&String>,
    message: String,
    help: &'static str,
) -> Contradiction {
    Contradiction { line: record.line, column: column.cloned().unwrap_or_default(), message, help }
}
