//! A block of lines for each part, one behind the other:
//! ```text
//! Teil: 418
//! Rollenmaß: 25,011 mm
//!
//! Teil: 419
//! Rollenmaß: 25,018 mm
//! ```
//! Called by [`shape`](super::shape).

use std::borrow::Cow;

use super::headings::is_part_name;
use crate::table::cell::{Cell, Record};
use crate::table::names::names_value;
use crate::table::want::Want;

/// The lines of such blocks put together: one for each name, with a value for each part behind it; other records as they are.
pub(super) fn with_parts_side_by_side<'r>(records: &'r [Record], want: &Want) -> Cow<'r, [Record]> {
    let is_start = |record: &Record| {
        record.cells.len() == 2
            && is_part_name(&record.cells[0].text())
            && !record.cells[0].text().trim_end_matches(':').contains(':')
            && !names_value(&record.cells[1].text(), &want.own)
    };
    let Some(first) = records.iter().position(is_start) else { return records.into() };
    let blocks: Vec<&[Record]> = records[first..].chunk_by(|_, next| !is_start(next)).collect();
    let starts_alike = |block: &&[Record]| name(&block[0]) == name(&records[first]);
    let is_twice = |block: &&[Record]| (1..block.len()).any(|at| find(&block[..at], &name(&block[at])).is_some());
    // numbers without a name say not beside which others they stand
    let is_nameless = |record: &Record| !record.filled().is_empty() && record.filled().iter().all(Cell::is_number);
    let has_nameless = records[first..].iter().any(is_nameless);
    if has_nameless || blocks.len() < 2 || !blocks.iter().all(starts_alike) || blocks.iter().any(is_twice) {
        return records.into();
    }
    let mut merged = records[..first].to_vec();
    for record in blocks.concat() {
        let name = name(&record);
        let in_blocks: Vec<_> = blocks.iter().map(|block| find(block, &name)).collect();
        let is_of_parts = in_blocks.iter().flatten().count() > 1 || names_value(&name, &want.own);
        if !is_of_parts {
            merged.push(record.clone());
        } else if find(&merged[first..], &name).is_none() {
            let values = in_blocks.iter().map(|found| found.map_or_else(Cell::default, value));
            merged.push(record.with_cells(record.cells.first().cloned().into_iter().chain(values)));
        }
    }
    merged.into()
}

fn name(record: &Record) -> Cow<'_, str> {
    record.cell(0).text()
}

/// The record of that name.
fn find<'r>(records: &'r [Record], of: &str) -> Option<&'r Record> {
    records.iter().find(|record| name(record) == of)
}

/// What stands behind the name of a line, as one cell.
fn value(record: &Record) -> Cell {
    match record.cells.as_slice() {
        [_, cell] => cell.clone(),
        cells => {
            let text = cells.iter().skip(1).map(Cell::text).collect::<Vec<_>>().join(" ");
            Cell::of_text(&text, record.span())
        }
    }
}
