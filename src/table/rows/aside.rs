//! Records between the rows that are no parts: the header or the units again, a mean below the parts, a page's end.

use std::borrow::Cow;

use super::super::cell::{Cell, Record};
use super::super::column::{Column, Nominal};
use super::super::grid::only_units;
use super::super::lines::Beside;
use super::super::names::{WordList, is_of_parts, is_total, near, says_largest, says_which, statistic_word};
use super::super::reading::AsideReading;
use super::super::shape::{has_digit, is_numbered};
use super::{Rows, Setup};

impl Rows {
    /// What a record says that it is: its name, or what stands first in it and is no value.
    pub(super) fn label<'r>(&self, record: &'r Record) -> Option<Cow<'r, str>> {
        let is_value = |place: usize| self.setup.columns.iter().any(|column| column.place == place);
        let own = self.setup.id.or(self.setup.index);
        let mut places = own.into_iter().chain((0..record.cells.len()).filter(|place| !is_value(*place)));
        places.find_map(|place| record.cells.get(place).filter(|cell| !cell.is_empty())).map(Cell::text)
    }

    /// Whether a record is the header or the units again, or a mean below the parts.
    pub(super) fn is_aside(&self, record: &Record) -> bool {
        let Setup { id, index, titles, names, is_even, .. } = &self.setup;
        let name = id.or(*index).and_then(|place| record.cells.get(place)).map(Cell::text);
        let has_numbers = record.numbers() > 0;
        let is_words = !is_even && !has_numbers && record.cells.len() != titles.len();
        // what stands above closing rows
        let is_side = |cell: &Cell| cell.is_empty() || says_which(&cell.text());
        let is_part = |name: &str| is_numbered(name) || names.may_have(name);
        let is_counted = || id.is_some() && index.is_some_and(|index| record.cell(index).text().parse::<i64>().is_ok());
        let is_excluded = |name: &str| {
            may_be_statistic(name.as_bytes())
                && (names.exclude(name) && !self.is_measured(record)
                    || names.have_spread(name) && self.is_spread(record))
        };
        (self.label(record).is_some_and(|label| is_called_of_parts(&label)) || name.as_deref().is_some_and(is_excluded))
            && !is_counted()
            || index.is_some_and(|index| is_of_teeth(&record.cell(index).text()))
            || index.is_some_and(|index| has_grades(record, index))
            || index.is_some() && id.is_none_or(|id| record.cell(id).is_empty()) && record.cells.iter().all(is_side)
            || self.is_page(record)
            || is_words && !name.as_ref().is_some_and(|name| is_part(name)) && !self.holds_value(record)
            || (!has_numbers && (self.repeats_header(record) || only_units(&record.cells).is_some()))
    }

    /// Whether a record says where a page ends, and holds at most a count that is no value.
    pub(super) fn is_page(&self, record: &Record) -> bool {
        let mut filled = record.cells.iter().filter(|cell| !cell.is_missing());
        let is_count = |cell: &Cell| {
            cell.text().parse::<u64>().is_ok() && !self.setup.columns.iter().any(|column| column.may_hold(cell))
        };
        filled.next().is_some_and(|first| self.setup.names.have_no(&first.text())) && filled.all(is_count)
    }

    /// Whether a record holds a value near the nominal one, as no count or temperature is; in a row of
    /// several errors it may have any digits.
    pub(super) fn is_measured(&self, record: &Record) -> bool {
        let columns = &self.setup.columns;
        let is_row = columns.len() > 1 && columns.iter().all(|column| record.cell(column.place).is_number());
        let is_near = |column: &Column| {
            let cell = record.cell(column.place);
            let is_value = || cell.is_number() && (is_row || cell.has_two_decimals()) && column.may_hold(cell);
            matches!(column.nominal, Nominal::Fixed(_)) && is_value()
        };
        columns.iter().any(is_near)
    }

    /// Whether what a record holds is by how much measured values differ, and none of them.
    pub(super) fn is_spread(&self, record: &Record) -> bool {
        let is_filled = |column: &&Column| !record.cell(column.place).is_missing();
        let mut filled = self.setup.columns.iter().filter(is_filled).peekable();
        filled.peek().is_some() && filled.all(|column| column.may_spread_by(record.cell(column.place)))
    }

    /// Whether a line of words holds what may be a value.
    pub(super) fn holds_value(&self, record: &Record) -> bool {
        let aside = AsideReading { line: record.line, text: record.in_words() };
        let Setup { columns, titles, .. } = &self.setup;
        let beside = Beside { columns, width: titles.len(), of_parts: None, measured: None };
        beside.value_in(&aside, false).is_some_and(|unknown| !unknown.is_ignored(&self.setup.want))
    }

    /// Whether a record is the header again.
    pub(super) fn repeats_header(&self, record: &Record) -> bool {
        let same = |(cell, title): (&Cell, &String)| cell.text().trim() == title.trim();
        record.cells.len() == self.setup.titles.len() && record.cells.iter().zip(&self.setup.titles).all(same)
    }

    /// Whether a row of units says of every column what is known of it.
    pub(super) fn repeats_units(&self, record: &Record) -> bool {
        let is_that_of = |cell: &Cell, column: &Column| cell.is_missing() || column.has_unit(&cell.text());
        if record.cells.len() < self.setup.titles.len() && !self.setup.is_even {
            // between blanks, a unit has no place but its order
            let cells = record.cells.iter().filter(|cell| !cell.is_missing());
            let mut columns: Vec<&Column> = self.setup.columns.iter().collect();
            columns.sort_by_key(|column| column.place);
            return cells.clone().count() == columns.len()
                && cells.zip(columns).all(|(cell, column)| is_that_of(cell, column));
        }
        self.setup.columns.iter().all(|column| is_that_of(record.cell(column.place), column))
    }
}

/// Whether a record has the grades of what is measured of each tooth: `Qualität;5;5`.
fn has_grades(record: &Record, index: usize) -> bool {
    const COARSEST: u8 = 12;
    let is_grade = |cell: &Cell| cell.text().parse::<u8>().is_ok_and(|grade| grade <= COARSEST);
    let mut numbers = record.cells.iter().filter(|cell| cell.is_number());
    WordList::Grade.has(&record.cell(index).text()) && numbers.all(is_grade)
}

/// Whether a row is called by what is made of the parts', or by what is wanted of them.
pub(super) fn is_called_of_parts(name: &str) -> bool {
    may_be_statistic(name.as_bytes()) && is_of_parts(statistic_word(name))
}

/// The same of what stands in place of the number of a tooth, where a row may be a total or the largest of them.
pub(super) fn is_of_teeth(name: &str) -> bool {
    let is_named = || !has_digit(name) && (!near(name).is_empty() || name.ends_with("max"));
    is_called_of_parts(name) || is_total(name) || says_largest(name) || is_named()
}

/// A quick look: such names end in no digit, and begin with a letter or a sign, or end in one that is not plain; or they are `6s`
/// and the like.
#[inline]
pub(super) fn may_be_statistic(name: &[u8]) -> bool {
    let Some((first, last)) = name.first().zip(name.last()).filter(|(_, last)| !last.is_ascii_digit()) else {
        return false;
    };
    let is_letter = first.is_ascii_alphabetic() || matches!(first, b' ' | b'+' | b'-') || !first.is_ascii();
    let is_spread = || first.is_ascii_digit() && (name.len() == 2 && *last == b's' || name.ends_with(b"igma"));
    (is_letter || !last.is_ascii() || is_spread())
        && (name.len() > 1 || matches!(first, b's' | b'S' | b'R' | b'n' | b'N'))
}
