//! Reports that name each dimension in a line above its axes:
//! ```text
//! DIM OVER_ROLLER= 2D DISTANCE FROM POINT PNT1 TO POINT PNT2  UNITS=MM
//! AX    NOMINAL      +TOL      -TOL      MEAS       DEV    OUTTOL
//! M     25.0000    0.0300    0.0300   25.0131    0.0131    0.0000
//! ```
//! Called by [`shape`](super::shape).

use std::borrow::Cow;

use super::characteristics::{is_axis, is_direction};
use crate::table::cell::{Cell, Record};
use crate::table::names::names_value;
use crate::table::want::Want;

/// The records with each axis called by its dimension, and below one header: `OVER_ROLLER`, or `CIR1 X` where a dimension has
/// several axes. Where headers differ, the records as they are.
pub(super) fn with_dimension_names<'r>(records: &'r [Record], want: &Want) -> Cow<'r, [Record]> {
    let mut headers = records.iter().filter(|record| is_header(record));
    let first = headers.next().filter(|first| headers.all(|header| header.repeats(first)));
    let Some(header) = first.filter(|_| records.iter().any(|record| dimension(record).is_some())) else {
        return records.into();
    };
    let mut named: Vec<Record> = Vec::with_capacity(records.len());
    for block in records.chunk_by(|_, next| dimension(next).is_none()) {
        let name = dimension(&block[0]);
        let is_axis_of = |record: &Record| {
            let is_own = |cell: &Cell| !is_direction(cell) && names_value(&cell.text(), &want.own);
            name.is_some() && record.numbers() > 1 && !is_own(&record.cells[0])
        };
        let axes = block.iter().filter(|record| is_axis_of(record)).count();
        for record in block {
            match &name {
                _ if record.line == header.line => named.push(called(record, "dimension")),
                _ if is_header(record) => {}
                Some(_) if axes > 0 && dimension(record).is_some() => named.extend(units(record)),
                Some(name) if is_axis_of(record) && axes > 1 => {
                    named.push(called(record, &format!("{name} {}", record.cells[0].text())));
                }
                Some(name) if is_axis_of(record) => named.push(called(record, name)),
                _ => named.push(record.clone()),
            }
        }
    }
    named.into()
}

/// The name of the dimension that a line begins.
fn dimension(record: &Record) -> Option<String> {
    let line = record.in_words();
    let mut words = line.split_whitespace();
    let name = words.next().filter(|word| *word == "DIM").and_then(|_| words.next())?;
    Some(name.trim_end_matches('=').to_owned())
}

/// What the line of a dimension says of units: `UNITS=MM`.
fn units(record: &Record) -> Option<Record> {
    let line = record.in_words();
    let text = &line[line.find("UNITS")?..];
    Some(record.with_cells([Cell::of_text(text, record.span())]))
}

/// Whether a record is the header of axes.
fn is_header(record: &Record) -> bool {
    is_axis(&record.cell(0).text()) && record.numbers() == 0
}

/// A record with another text in its first cell.
fn called(record: &Record, first: &str) -> Record {
    let mut record = record.clone();
    record.cells[0] = Cell::of_text(first, record.cells[0].span.clone());
    record
}
