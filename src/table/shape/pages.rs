//! A table of characteristics for each part, below a line that names it:
//! ```text
//! Teil 421
//! Merkmal;Soll;Ist
//! Rollenmaß [mm];25,000;25,012
//!
//! Teil 422
//! Merkmal;Soll;Ist
//! Rollenmaß [mm];25,000;24,998
//! ```
//! Called by [`shape`](super::shape).

use std::borrow::Cow;
use std::collections::HashSet;

use super::headings::is_part_name;
use crate::table::cell::{Cell, Record};
use crate::table::names::{Role, role};

/// A word for parts, and the name behind it.
struct PartLine {
    word: String,
    name: String,
}

/// The records with the name of its part behind each characteristic, below one header; what else stands between these is a
/// line of words. Other records as they are.
pub(super) fn with_part_of_page(records: &[Record]) -> Cow<'_, [Record]> {
    let Some(header) = records.iter().find(|record| is_header(record)) else { return records.into() };
    let starts: Vec<usize> = (0..records.len()).filter(|at| texts(&records[*at]) == texts(header)).collect();
    let above = |page: usize| &records[page.checked_sub(1).map_or(0, |before| starts[before] + 1)..starts[page]];
    let words = above(0).iter().flat_map(part_lines).map(|line| line.word);
    let name_of = |word: &str, page: usize| {
        above(page).iter().rev().flat_map(part_lines).find(|line| line.word == word).map(|line| line.name)
    };
    let names_of = |word: String| {
        let names: Option<Vec<String>> = (0..starts.len()).map(|page| name_of(&word, page)).collect();
        // the number of a drawing is that of all parts
        names.filter(|names| names.iter().collect::<HashSet<_>>().len() == names.len())
    };
    let Some(names) = words.into_iter().find_map(names_of).filter(|names| names.len() > 1) else {
        return records.into();
    };
    let mut rows = records[..starts[0]].to_vec();
    rows.push(with_cell(header, "part"));
    let ends = starts.iter().skip(1).copied().chain([records.len()]);
    for ((start, end), name) in starts.iter().zip(ends).zip(&names) {
        let is_row = |record: &Record| record.cells.len() == header.cells.len() && record.numbers() > 0;
        rows.extend(records[start + 1..end].iter().map(|record| {
            // the end of one page, and the head of the next
            let in_one = || Record { cells: vec![Cell::of_text(&record.in_words(), record.span())], ..record.clone() };
            if is_row(record) { with_cell(record, name) } else { in_one() }
        }));
    }
    rows.into()
}

/// Whether a record names characteristics and their values, and no column of parts.
fn is_header(record: &Record) -> bool {
    let roles: Vec<_> = record.cells.iter().filter_map(|cell| role(&cell.text())).collect();
    record.numbers() == 0
        && roles.contains(&Role::Name)
        && roles.contains(&Role::Measured)
        && !roles.contains(&Role::Part)
}

/// What a line says of parts: `Teil 421`, `Seriennummer: 421`, or two cells.
fn part_lines(record: &Record) -> Vec<PartLine> {
    let line = |word: &str, name: &str| {
        let (word, name) = (word.trim(), name.trim());
        (is_part_name(word) && !name.is_empty()).then(|| PartLine { word: word.to_owned(), name: name.to_owned() })
    };
    let within = |cell: &Cell| {
        let text = cell.text();
        let (word, name) = text.split_once([':', '=']).or_else(|| text.trim().rsplit_once(' '))?;
        line(word, name)
    };
    let beside = record.cells.windows(2).filter_map(|pair| line(pair[0].text().trim_end_matches(':'), &pair[1].text()));
    record.cells.iter().filter_map(within).chain(beside).collect()
}

fn texts(record: &Record) -> Vec<Cow<'_, str>> {
    record.cells.iter().map(Cell::text).collect()
}

fn with_cell(record: &Record, text: &str) -> Record {
    let cells = record.cells.iter().cloned().chain([Cell::of_text(text, 0..0)]);
    Record { cells: cells.collect(), ..record.clone() }
}
