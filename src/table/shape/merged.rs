//! Tables with a row per characteristic whose parts have several columns each, below their merged names:
//! ```text
//! ;418;;419;
//! Merkmal;Soll;Ist;Soll;Ist
//! Rollenmaß [mm];25;25,011;25;25,018
//! ```
//! Called by [`shape`](super::shape).

use std::borrow::Cow;

use super::headings::{is_of_no_part, is_part_name};
use crate::table::cell::{Cell, Record};
use crate::table::names::{Role, WordList, names_value, role};
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

/// The records with a heading of two rows in one: `Abmaße` above `oben` and `unten`, `Messwerte` above the names of parts.
pub(super) fn with_heading_in_one_row(records: &[Record]) -> Cow<'_, [Record]> {
    let joined = |at: usize| Some((at, joined(&records[at], &records[at + 1])?));
    let Some((at, heading)) = (0..records.len().saturating_sub(1)).find_map(joined) else { return records.into() };
    let rest = records[at + 2..].iter().cloned();
    records[..at].iter().cloned().chain([heading]).chain(rest).collect()
}

/// A heading of characteristics with what stands below it, if that goes on only where a cell is merged over several.
fn joined(above: &Record, below: &Record) -> Option<Record> {
    let is_name = |cell: &Cell| role(&cell.text()) == Some(Role::Name);
    // parts that are called 1, 2, 3
    let numbers = below.cells.iter().filter(|cell| cell.is_number()).map(|cell| cell.text().parse().ok());
    let numbers: Option<Vec<u32>> = numbers.collect();
    let are_next =
        numbers.is_some_and(|numbers| numbers.windows(2).all(|pair| Some(pair[1]) == pair[0].checked_add(1)));
    let are_names = below.numbers() == 0 || below.cells[0].is_empty() && below.numbers() > 1 && are_next;
    let goes_on = below.filled().len() > 1 && are_names && below.cells.len() <= above.cells.len();
    if !goes_on || above.numbers() > 0 || !above.cells.iter().any(is_name) {
        return None;
    }
    let is_open = |place: usize| above.cells.get(place).is_some_and(Cell::is_empty);
    let mut group = Cell::default();
    let joined = above.cells.iter().enumerate().map(|(place, upper)| {
        let lower = below.cell(place);
        if !upper.is_empty() {
            group = if is_open(place + 1) { upper.clone() } else { Cell::default() };
        }
        if lower.is_empty() {
            return Some(upper.clone());
        }
        // oben, or the name of a part
        let whole = format!("{} {}", group.text(), lower.text());
        let is_said = role(&whole).is_some_and(Role::is_beside_value);
        // what stands below `Sollwerte` or `Kunde` is no value of a part
        let group = group.text();
        let is_of_values =
            role(&group) == Some(Role::Measured) || WordList::UnitSubject.has(&group) || is_part_name(&group);
        match (is_said, is_of_values) {
            (true, _) => Some(Cell::of_text(&whole, lower.span.clone())),
            (false, true) => Some(lower.clone()),
            (false, false) => None,
        }
    });
    let cells: Vec<Cell> = joined.collect::<Option<_>>()?;
    Some(above.with_cells(cells))
}

/// The records with a row for each part of a characteristic, and its name in a column of its own; other records as they are.
pub(super) fn with_part_in_each_row<'r>(records: &'r [Record], want: &Want) -> Cow<'r, [Record]> {
    let Some(groups) = (1..records.len()).find_map(|header| groups(records, header, want)) else {
        return with_parts_of_blocks(records, want).map_or(records.into(), Cow::Owned);
    };
    let (names, header) = (&records[groups.names], &records[groups.names + 1]);
    let lead = groups.starts[0];
    let row_of = |record: &Record, start: usize, part: &Cell| {
        row_of_part(record, lead, &record.cells[start..start + groups.width], part)
    };
    let mut rows = records[..groups.names].to_vec();
    rows.push(row_of(header, lead, &Cell::of_text("part", 0..0)));
    for record in &records[groups.names + 2..] {
        let is_whole = record.cells.len() == header.cells.len();
        if is_whole && !record.cells[lead..].iter().all(Cell::is_empty) {
            rows.extend(groups.starts.iter().map(|start| row_of(record, *start, &names.cells[*start])));
        } else if !is_whole && record.numbers() > 0 {
            // nothing tells of which part its values are
            return records.into();
        } else {
            rows.push(record.clone());
        }
    }
    rows.into()
}

/// A characteristic with the values of one part, and its name behind them.
fn row_of_part(record: &Record, lead: usize, values: &[Cell], part: &Cell) -> Record {
    record.with_cells(record.cells[..lead].iter().chain(values).chain([part]).cloned())
}

/// The records with the names of parts in their header, where a line above has them: `No.;1;2` above `Design value;;`.
pub(super) fn with_names_above(records: &[Record]) -> Cow<'_, [Record]> {
    const NEAR: usize = 3;
    let named = |at: usize| {
        let header = records[at].filled();
        let is_number = |below: &Record| below.cells.get(header.len()).is_some_and(Cell::is_number);
        let is_open =
            is_number(records.get(at + 1)?) && header.iter().any(|cell| role(&cell.text()) == Some(Role::Name));
        let has_names = |above: &Record| {
            let (word, names) = above.filled().split_at_checked(header.len()).unwrap_or_default();
            word.last().is_some_and(|cell| is_part_name(&cell.text()))
                && !names.is_empty()
                && !names.iter().any(Cell::is_empty)
        };
        let above = (at.saturating_sub(NEAR)..at).find(|above| is_open && has_names(&records[*above]))?;
        Some((at, above))
    };
    let Some((at, above)) = (1..records.len()).find_map(named) else { return records.into() };
    let mut records = records.to_vec();
    let width = records[at].filled().len();
    let names = records[above].cells.split_off(width);
    records[at].cells.splice(width.., names);
    records.into()
}

/// The columns of parts of a header below their names: as many for each part, with the same titles.
fn groups(records: &[Record], header: usize, want: &Want) -> Option<Groups> {
    let (above, titles) = (&records[header - 1].cells, &records[header].cells);
    let starts: Vec<usize> = (1..above.len()).filter(|place| !above[*place].is_empty()).collect();
    let [first, second, ..] = starts[..] else { return None };
    let width = second - first;
    let is_even = starts.windows(2).all(|pair| pair[1] - pair[0] == width);
    let is_whole = titles.len() == first + width * starts.len() && above.len() <= titles.len();
    if width < 2 || !is_even || !is_whole {
        return None;
    }
    let (lead, titles) = titles.split_at(first);
    let mut groups = titles.chunks(width).map(|group| group.iter().map(Cell::text).collect::<Vec<_>>());
    let group = groups.next()?;
    let values = group.iter().filter(|title| role(title) == Some(Role::Measured)).count();
    let is_part = |name: &str| !names_value(name, &want.own) && role(name).is_none();
    let is_table = values == 1
        && lead.iter().all(|title| role(&title.text()) != Some(Role::Part))
        && groups.all(|other| other == group)
        && starts.iter().all(|start| is_part(&above[*start].text()));
    is_table.then_some(Groups { names: header - 1, starts, width })
}

/// The same of parts in several blocks below each other, `Merkmal;T1;T2` and `Merkmal;T3;T4`: a row for each value, with its part
/// behind it. `None` if there is one block, or if not every cell is that of one part.
fn with_parts_of_blocks(records: &[Record], want: &Want) -> Option<Vec<Record>> {
    let is_counter = |cell: &Cell| !cell.is_number() || cell.is_whole();
    let is_header = |record: &Record| {
        record.cells.iter().all(is_counter)
            && record.cells.first().is_some_and(|cell| role(&cell.text()) == Some(Role::Name))
    };
    let headers: Vec<&Record> = records.iter().filter(|record| is_header(record)).collect();
    let first = *headers.first().filter(|_| headers.len() > 1)?;
    let lead = first.cells.iter().take_while(|cell| role(&cell.text()).is_some()).count();
    let texts = |cells: &[Cell]| cells.iter().map(|cell| cell.text().into_owned()).collect::<Vec<_>>();
    let is_part = |title: &String| {
        !is_of_no_part(title) && !names_value(title, &want.own) && role(title).is_none() && !title.is_empty()
    };
    let of_value = [Some(Role::Measured), Some(Role::Deviation), Some(Role::Part)];
    let leads = texts(&first.cells[..lead]);
    let is_block = |header: &&Record| header.cells.len() > lead && texts(&header.cells[..lead]) == leads;
    let mut parts: Vec<String> =
        headers.iter().flat_map(|header| texts(header.filled().get(lead..).unwrap_or_default())).collect();
    let is_plain = leads.iter().all(|title| !of_value.contains(&role(title))) && parts.iter().all(is_part);
    let count = parts.len();
    parts.sort();
    parts.dedup();
    if !is_plain || parts.len() < count || !headers.iter().all(is_block) {
        return None;
    }
    let (start, last) = (records.iter().position(is_header)?, headers[headers.len() - 1].line);
    let says_value = |record: &Record| {
        let has_value = record.cells.iter().skip(lead).any(|cell| !cell.is_empty());
        has_value || names_value(&record.cells[0].text(), &want.own)
    };
    let mut rows = records[..start].to_vec();
    let [value, part] = ["value", "part"].map(|title| Cell::of_text(title, 0..0));
    rows.push(row_of_part(first, lead, &[value], &part));
    let mut parts = &first.filled()[lead..];
    for record in &records[start..] {
        let width = lead + parts.len();
        if is_header(record) {
            parts = &record.filled()[lead..];
        } else if record.cells.len() >= width && record.filled().len() <= width && says_value(record) {
            let values = record.cells[lead..width].chunks(1).zip(parts);
            rows.extend(values.map(|(value, part)| row_of_part(record, lead, value, part)));
        } else if record.numbers() > 0 || record.line < last && !record.says_nothing() {
            // nothing tells of which part its values are, or of what the next block is
            return None;
        } else {
            rows.push(record.clone());
        }
    }
    Some(rows)
}
