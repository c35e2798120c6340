//! What of another sheet than the one that is read may be a measurement, and which sheets hold nothing but statistics and limits.

use super::{Others, Sorted, sort};
use crate::table::cell::{Cell, Record};
use crate::table::column::Column;
use crate::table::grid::Separator;
use crate::table::lines::{Beside, of_part};
use crate::table::measured::MeasuredValues;
use crate::table::names::{WordList, is_again, is_context, is_of_parts, is_statistic, may_be_of_parts};
use crate::table::shape::{aside, has_digit, is_part_name, shape};
use crate::table::understand::Understood;
use crate::table::unknown::Unknown;
use crate::table::want::Want;

/// What of another sheet may be a measurement: columns, or else the first line that would be one beside the table that is read.
/// A number below a name for context is none, and in a sheet that is called a repetition each is one.
pub(crate) fn of_sheet(file: &str, sheet: &str, records: &[Record], understood: &Understood, want: &Want) -> Sorted {
    let others = &Others::of(&understood.columns, want);
    let list = listed_statistics(records);
    let columns = shape(records, Separator::TAB, want).map(|shape| sort(file, &shape, understood, want, others));
    let mut sorted = columns.ok().filter(|_| list.is_none()).unwrap_or_default();
    if let Some(record) = records.iter().find(|record| is_again(sheet) && record.numbers() > 0) {
        let again = Unknown::line(sheet, record.line, record.cells.clone()).unread();
        sorted.take(file, &again, want, &Others::default());
    }
    let (names, measured) = (understood.shape.part_names(), MeasuredValues::of(understood));
    let beside = Beside { columns: &understood.columns, width: 0, of_parts: Some(&names), measured: Some(&measured) };
    let is_denied = |unknown: &&Unknown| measured.are_denied_by(&unknown.title, &unknown.cells[0]);
    if let Some(unknown) = list.iter().flatten().find(is_denied) {
        sorted.take(file, unknown, want, &Others::default());
    }
    let is_context = |text: &str| (is_context(text) || is_statistic(text)) && !is_part_name(text);
    let is_other = |place: usize| heading_of(records, place).is_some_and(|cell| is_context(&cell.text()));
    let is_kept = |place: usize, cell: &Cell| {
        !cell.is_number() || list.is_none() && (!is_other(place) || measured.may_have(cell))
    };
    // rows of more parts, which go on without names
    let goes_on = |record: &&Record| {
        let reads = |column: &Column| column.reads(record.cell(column.place));
        let name = understood.shape.ids.as_ref().map(|ids| record.cell(ids.place).text());
        understood.has_row_per_part()
            && name.is_some_and(|name| names.may_have(&name))
            && understood.columns.iter().all(reads)
    };
    if let Some(row) = records.first().filter(goes_on).filter(|_| sorted.strangers.is_empty()) {
        let row = Unknown::line(sheet, row.line, row.cells.clone()).unread();
        sorted.take(file, &row, want, &Others::default());
    }
    for record in records {
        if !sorted.strangers.is_empty() {
            break;
        }
        let cells = || record.cells.iter().enumerate().filter(|(place, cell)| is_kept(*place, cell));
        let line = |cells: Vec<Cell>| aside(&Record { cells, ..record.clone() });
        let value = beside.value_in(&line(cells().map(|(_, cell)| cell.clone()).collect()), false);
        // a number beside the name of a part, below what says nothing: z1
        let says_nothing =
            |heading: &Cell| heading.is_number() || heading.text().len() == 1 || has_digit(&heading.text());
        let may_be = |place: usize| heading_of(records, place).is_none_or(says_nothing);
        let is_value =
            |place: usize, cell: &Cell| may_be(place) && understood.columns.iter().any(|column| column.reads(cell));
        let is_remark = |cell: &Cell| cell.text().contains(' ');
        let of_parts =
            cells().filter(|(place, cell)| if cell.is_number() { is_value(*place, cell) } else { !is_remark(cell) });
        let value =
            value.or_else(|| of_part(&line(of_parts.map(|(_, cell)| cell.clone()).collect()), &understood.shape));
        if let Some(unknown) = value {
            sorted.take(file, &unknown, want, &Others::default());
        }
    }
    sorted
}

/// The first cell of a column that is not empty.
fn heading_of(records: &[Record], place: usize) -> Option<&Cell> {
    records.iter().find_map(|record| record.cells.get(place).filter(|cell| !cell.is_empty()))
}

/// The numbers of a sheet, each below the name of its row or column, if all of these are names of statistics, nominal values or limits
/// of parts.
pub(crate) fn listed_statistics(records: &[Record]) -> Option<Vec<Unknown>> {
    let mut found = Vec::new();
    for record in records {
        let row = record.cells.iter().find(|cell| !cell.is_empty());
        for (place, number) in record.cells.iter().enumerate().filter(|(_, cell)| cell.is_number()) {
            let mut names = [row, heading_of(records, place)].into_iter().flatten().map(Cell::text);
            let name = names.find(|name| may_be_of_parts(name) || WordList::PartCount.has(name))?;
            found.push(Unknown::line(&name, record.line, vec![number.clone()]).unread());
        }
    }
    found.iter().any(|unknown| is_of_parts(&unknown.title)).then_some(found)
}
