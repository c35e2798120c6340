//! Tables with a row per characteristic whose parts have several columns each, below their merged names:
//! ```text
//! ;418;;419;
//! Merkmal;Soll;Ist;Soll;Ist
//! Rollenmaß [mm];25;25,011;25;25,018
//! ```
//! Called by [`shape`](super::shape).

use std::borrow::Cow;

use crate::table::cell::{Cell, Record};
use crate::table::names::{Role, names_value, role};
use crate::table::want::Want;

/// The columns of parts.
struct Groups {
    /// The record with their names.
    names: usize,
    /// Where each begins.
    starts: Vec<usize>,
    /// Columns of each.
    width: usize,
}

/// The records with a row for each part of a characteristic, and its name in a column of its own; other records as they are.
pub(super) fn with_part_in_each_row<'r>(records: &'r [Record], want: &Want) -> Cow<'r, [Record]> {
    let Some(groups) = (1..records.len()).find_map(|header| groups(records, header, want)) else {
        return records.into();
    };
    let (names, header) = (&records[groups.names], &records[groups.names + 1]);
    let lead = groups.starts[0];
    let row_of = |record: &Record, start: usize, part: Cell| {
        let cells = record.cells[..lead].iter().chain(&record.cells[start..start + groups.width]);
        Record { cells: cells.cloned().chain([part]).collect(), ..record.clone() }
    };
    let mut rows = records[..groups.names].to_vec();
    rows.push(row_of(header, lead, Cell::of_text("part", 0..0)));
    for record in &records[groups.names + 2..] {
        let is_whole = record.cells.len() == header.cells.len();
        if is_whole && !record.cells[lead..].iter().all(Cell::is_empty) {
            rows.extend(groups.starts.iter().map(|start| row_of(record, *start, names.cells[*start].clone())));
        } else if !is_whole && record.numbers() > 0 {
            // nothing tells of which part its values are
            return records.into();
        } else {
            rows.push(record.clone());
        }
    }
    rows.into()
}

/// The columns of parts of a header below their names: as many for each part, with the same titles.
fn groups(records: &[Record], header: usize, want: &Want) -> Option<Groups> {
    let (above, titles) = (&records[header - 1].cells, &records[header].cells);
    let is_named = |place: &usize| *place > 0 && !above[*place].is_empty();
    let starts: Vec<usize> = (0..above.len()).filter(is_named).collect();
    let [first, second, ..] = starts[..] else { return None };
    let width = second - first;
    let is_even = starts.windows(2).all(|pair| pair[1] - pair[0] == width);
    let is_whole = titles.len() == first + width * starts.len() && above.len() <= titles.len();
    if width < 2 || !is_even || !is_whole {
        return None;
    }
    let titles_of =
        |start: usize| titles.get(start..start + width).map(|titles| titles.iter().map(Cell::text).collect::<Vec<_>>());
    let group = titles_of(first)?;
    let values = group.iter().filter(|title| role(title) == Some(Role::Measured)).count();
    let is_part = |start: &usize| {
        let name = above[*start].text();
        !names_value(&name, &want.own) && role(&name).is_none() && titles_of(*start).as_ref() == Some(&group)
    };
    let has_no_part = titles[..first].iter().all(|title| role(&title.text()) != Some(Role::Part));
    let is_table = values == 1 && has_no_part && starts.iter().all(is_part);
    is_table.then_some(Groups { names: header - 1, starts, width })
}
