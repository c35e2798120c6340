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

use super::characteristics::is_axis;
use super::has_digit;
use super::headings::is_part_name;
use crate::table::cell::{Cell, Record};
use crate::table::grid::unit_in;
use crate::table::names::{Role, WordList, part_said, role};
use crate::table::rejection::says_rejected;

/// A word for parts, and the name behind it.
pub(crate) struct PartLine {
    pub(crate) word: String,
    pub(crate) name: String,
}

/// The records with the name of its part behind each characteristic, below one header; the head of a page is a line of words,
/// and a part without characteristics has the first one, without a value. Other records as they are, also where headers differ.
pub(super) fn with_part_of_page(records: &[Record]) -> Cow<'_, [Record]> {
    let mut headers = records.iter().filter(|record| is_header(record));
    let Some(header) = headers.next() else { return records.into() };
    let is_again = |record: &Record| record.repeats(header);
    let pages = headers.try_fold(1, |pages, header| is_again(header).then_some(pages + 1));
    if pages.is_none_or(|pages| pages < 2) {
        return records.into();
    }
    let is_row = |record: &Record| record.cells.len() == header.cells.len() && record.numbers() > 0;
    let above = records.iter().take_while(|record| !is_again(record));
    let mut words = above.clone().flat_map(part_lines).map(|line| line.word);
    let Some(word) = words.find(|word| are_apart(records, word)) else { return records.into() };
    let Some(first) = records.iter().skip(above.count()).find(|record| is_row(record)) else { return records.into() };
    let is_start = |record: &Record| named(record, &word).is_some();
    let start = records.iter().position(is_start).unwrap_or(0);
    let mut rows = records[..start].to_vec();
    rows.push(with_cell(header, "part"));
    for page in records[start..].chunk_by(|_, next| !is_start(next)) {
        let part = named(&page[0], &word).unwrap_or_default();
        let is_same = |row: &Record| {
            row.cells.len() > header.cells.len() && row.cells.last().is_some_and(|cell| cell.text() == part)
        };
        if !page.iter().any(is_row) && !rows.iter().any(is_same) {
            rows.push(with_cell(&without_value(first, header, &page[0]), &part));
        }
        let head = page.iter().position(is_again).unwrap_or(1);
        let in_one_cell = |record: &Record| record.with_cells([Cell::of_text(&record.in_words(), record.span())]);
        rows.extend(page[..head].iter().map(in_one_cell));
        let below = page[head..].iter().filter(|record| !is_again(record));
        rows.extend(below.map(|record| if is_row(record) { with_cell(record, &part) } else { record.clone() }));
    }
    rows.into()
}

/// The records with the name of its part behind each characteristic, where a row that has nothing else names it: `Teil 1;;`. The
/// first may stand above the header.
pub(super) fn with_part_of_section(records: &[Record]) -> Cow<'_, [Record]> {
    let Some(start) = records.iter().position(is_header) else { return records.into() };
    let (header, below) = (&records[start], &records[start + 1..]);
    let above = records[..start].iter().rev().find_map(part_alone).filter(|line| has_digit(&line.name));
    let right_below = below.first().and_then(part_alone);
    let Some(first) = right_below.as_ref().or(above.as_ref()) else { return records.into() };
    let named = |record: &Record| part_alone(record).filter(|line| line.word == first.word).map(|line| line.name);
    let names: Vec<String> = records.iter().filter_map(named).collect();
    // a part of which nothing is said would be lost
    let is_filled = |pair: &[Record]| named(&pair[0]).is_none() || named(&pair[1]).is_none();
    let is_above_filled = records[..start].iter().filter_map(named).count() <= usize::from(right_below.is_none());
    let is_last_filled = below.last().is_some_and(|last| named(last).is_none());
    let are_filled = is_above_filled && below.windows(2).all(is_filled) && is_last_filled;
    if names.len() < 2 || !are_filled || names.iter().collect::<HashSet<_>>().len() < names.len() {
        return records.into();
    }
    let mut part = first.name.clone();
    let mut rows = records[..start].to_vec();
    rows.push(with_cell(header, "part"));
    for record in below {
        match named(record) {
            Some(name) => part = name,
            None if record.filled().len() > 1 => rows.push(with_cell(record, &part)),
            None => rows.push(record.clone()),
        }
    }
    rows.into()
}

/// A characteristic without its value, which stands for all of a page.
fn without_value(characteristic: &Record, header: &Record, page: &Record) -> Record {
    let is_kept = |heading: &Cell| matches!(role(&heading.text()), Some(Role::Name | Role::Unit));
    let cells = characteristic.cells.iter().zip(&header.cells);
    page.with_cells(cells.map(|(cell, heading)| if is_kept(heading) { cell.clone() } else { Cell::default() }))
}

/// Whether the lines with a word for parts name several, one behind the other; the number of a drawing is that of all.
fn are_apart(records: &[Record], word: &str) -> bool {
    let mut names: Vec<String> = records.iter().filter_map(|record| named(record, word)).collect();
    names.dedup();
    names.len() > 1 && names.iter().collect::<HashSet<_>>().len() == names.len()
}

/// The name that a line has behind a word for parts.
fn named(record: &Record, word: &str) -> Option<String> {
    part_lines(record).into_iter().find(|line| line.word == word).map(|line| line.name)
}

/// Whether a record names characteristics and their values, and no column of parts.
fn is_header(record: &Record) -> bool {
    if record.numbers() > 0 {
        return false;
    }
    let roles: Vec<_> = record.cells.iter().filter_map(|cell| role(&cell.text())).collect();
    let has_names = roles.contains(&Role::Name) || record.cells.first().is_some_and(|cell| is_axis(&cell.text()));
    has_names && roles.contains(&Role::Measured) && !roles.contains(&Role::Part)
}

/// What a line says of parts: `Teil 421`, `Seriennummer: 421`, or two cells.
fn part_lines(record: &Record) -> Vec<PartLine> {
    let within = |cell: &Cell| part_line(&cell.text());
    let beside = |pair: &[Cell]| named_by(pair[0].text().trim_end_matches(':'), &pair[1].text());
    record.cells.iter().filter_map(within).chain(record.cells.windows(2).filter_map(beside)).collect()
}

/// The part that a record names, if it says nothing else: a word for parts, and one word behind it that is no value and no verdict.
fn part_alone(record: &Record) -> Option<PartLine> {
    let text = record.in_words().replace([':', '='], " ");
    let (word, name) = text.trim().rsplit_once(' ')?;
    let line = named_by(word, name).filter(|line| line.name == name && record.filled().len() <= 2)?;
    let cell = Cell::of_text(name, 0..0);
    let is_value =
        cell.is_missing() || cell.has_decimals() || unit_in(name).is_some() || name.starts_with(['+', '-', '\u{2212}']);
    let is_verdict = WordList::Approval.has(name) || WordList::Disapproval.is_claimed_in(name) || says_rejected(name);
    (!is_value && !is_verdict).then_some(line)
}

/// What a text says of a part: `Teil 421`, `Teil 421   Seite 1`, `Messung von Teil 421`.
pub(crate) fn part_line(text: &str) -> Option<PartLine> {
    const MOST_WORDS: usize = 3;
    let (word, name) = text.split_once([':', '=']).or_else(|| text.trim().rsplit_once(' '))?;
    let words: Vec<&str> = text.split_whitespace().collect();
    let first = |count: usize| named_by(&words[..count].join(" "), words[count]).filter(|line| has_digit(&line.name));
    let behind = |pair: &[&str]| named_by(pair[0], pair[1]).filter(|line| has_digit(&line.name));
    let first = (1..words.len().min(MOST_WORDS + 1)).find_map(first);
    named_by(word, name).or(first).or_else(|| words.windows(2).take(MOST_WORDS).find_map(behind))
}

fn named_by(word: &str, name: &str) -> Option<PartLine> {
    // what else the line says stands behind the name
    let name = name.trim().split([',', ';']).flat_map(|name| name.split("  ")).next().unwrap_or_default().trim();
    let word = word.trim();
    // Rack 421
    let is_part = is_part_name(word) || !word.contains(' ') && part_said(word).is_some();
    (is_part && !name.is_empty()).then(|| PartLine { word: word.to_owned(), name: name.to_owned() })
}

fn with_cell(record: &Record, text: &str) -> Record {
    record.with_cells(record.cells.iter().cloned().chain([Cell::of_text(text, 0..0)]))
}
