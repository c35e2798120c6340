//! A block: some rows of a table as columns of values. The readers of all formats fill it; the evaluators of parts and of teeth
//! read it.

use std::collections::HashSet;
use std::ops::Range;

use super::encoding::text;
use super::ledger::{Tally, join};
use super::reading::{AsideReading, Reading};
use crate::deviation::{DeviationValue, DeviationValues};
use crate::diagnostic::{Code, Diagnostic};

/// A range of bytes in a block's text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Span {
    pub(crate) start: u32,
    pub(crate) end: u32,
}

/// A cell that a rule leaves out, in a row that is not read to its end yet.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unsettled {
    pub(crate) rule: usize,
    pub(crate) place: usize,
    pub(crate) span: Span,
}

/// A rejected row that is perhaps no part, such as a mean.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Odd {
    pub(crate) line: u64,
    /// The cells of the row, joined by semicolons.
    pub(crate) text: String,
    /// The cell in the column of names; the first cell where parts have no names.
    pub(crate) name: String,
    /// Whether no part can have this name.
    pub(crate) is_no_name: bool,
    /// Whether a column of values has a cell that is not empty.
    pub(crate) has_text: bool,
    /// Whether every value can be read.
    pub(crate) could_be_part: bool,
}

/// Why a row is rejected.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The row, from 0.
    pub row: usize,
    /// The column of the table that is at fault, if a single one is.
    pub column: Option<usize>,
    /// Whether the value is missing. Otherwise it is wrong.
    pub is_missing: bool,
    /// The text of the cell, if the cell is at fault.
    pub text: String,
    /// What is wrong.
    pub message: String,
}

/// A cell that contradicts how the table is read. It ends the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Contradiction {
    /// The line.
    pub line: u64,
    /// The column.
    pub column: String,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: &'static str,
}

impl Contradiction {
    /// The same of a table of that name, where it is all that is read.
    pub(crate) fn of(&self, name: &str) -> Diagnostic {
        let message = format!("{name}, line {}: {}", self.line, self.message);
        Diagnostic::error(Code::BadTable, message).help(self.help)
    }
}

/// Some rows of a table.
#[derive(Debug, Default)]
pub struct Block {
    /// The values of each column; empty for a column that nobody needs. Where a row has a fault, its value is a placeholder.
    pub(crate) values: Vec<DeviationValues>,
    /// What is wrong with rows, in their order.
    pub(crate) faults: Vec<Fault>,
    /// The number of the space or tooth of each row.
    pub(crate) index: Vec<Option<i64>>,
    /// The bytes that the spans refer to.
    pub(crate) text: Vec<u8>,
    /// The name of each part; empty if parts have no names.
    pub(crate) names: Vec<Span>,
    /// Each row as it stands in the file.
    pub(crate) raw: Vec<Span>,
    /// The cells that are copied, row by row.
    pub(crate) copied: Vec<Span>,
    /// The line of each row, from 1.
    pub(crate) lines: Vec<u64>,
    /// The number of each row's record in the block, from 1.
    pub(crate) records: Vec<u64>,
    /// Records that are no parts: a repeated heading, a mean.
    pub(crate) asides: Vec<AsideReading>,
    /// The least and the greatest value of each column.
    pub(crate) ends: Vec<Option<[DeviationValue; 2]>>,
    /// What each rule of the contract left out, in order of the rules' numbers.
    pub(crate) left_out: Vec<Tally>,
    /// Lines that a rule left out although they could be parts: the rule's number among the rules for lines, the number of the
    /// line, and its text.
    pub(crate) doubtful: Vec<(usize, u64, String)>,
    /// Rejected rows that are perhaps no parts.
    pub(crate) odd: Vec<Odd>,
    /// The cells that rules leave out of the row that is being read.
    pub(crate) unsettled: Vec<Unsettled>,
    /// The rows of parts that a measuring program rejects.
    pub(crate) failed: Vec<usize>,
    /// Records in all.
    pub(crate) record_count: u64,
    /// Lines of the table up to the block's end.
    pub(crate) line_count: u64,
    pub(crate) blank_lines: u64,
    pub(crate) contradiction: Option<Contradiction>,
    /// Whether the block holds more bytes of the overlong row in the block before it. They are kept with the rejected rows.
    pub(crate) is_rest: bool,
    /// Whether its last row goes on in the next block.
    pub(crate) goes_on: bool,
}

impl Block {
    /// How many rows there are.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.lines.len()
    }

    /// Counts the cells that rules leave out of a row, once the row is read.
    pub(crate) fn settle_left_out(&mut self, line: u64) {
        let unsettled = std::mem::take(&mut self.unsettled);
        for Unsettled { rule, place, span } in &unsettled {
            let text = text(&self.text[span.start as usize..span.end as usize]);
            tally(&mut self.left_out, *rule).add(line, *place, text.trim());
        }
        self.unsettled = unsettled;
    }

    /// What a rule left out in these rows.
    pub(crate) fn tally(&mut self, rule: usize) -> &mut Tally {
        tally(&mut self.left_out, rule)
    }

    /// Adds the lines that are no parts, and what rules left out, to the account of how the table was read.
    pub(crate) fn tell(&self, reading: &mut Reading) {
        reading.asides.extend(self.asides.iter().cloned());
        join(&mut reading.left_out, &self.left_out);
    }

    /// The values of a column.
    #[must_use]
    pub fn values(&self, column: usize) -> &DeviationValues {
        const NONE: &DeviationValues = &DeviationValues::Lengths(Vec::new());
        self.values.get(column).unwrap_or(NONE)
    }

    /// What is wrong with rows, in their order.
    #[must_use]
    pub fn faults(&self) -> &[Fault] {
        &self.faults
    }

    /// The rows that have a fault.
    pub(crate) fn rejected_rows(&self) -> HashSet<usize> {
        self.faults.iter().map(|fault| fault.row).collect()
    }

    pub(crate) fn bytes(&self, span: Span) -> &[u8] {
        &self.text[span.start as usize..span.end as usize]
    }

    /// A row as it stands in the file, if rows are kept.
    pub(crate) fn raw(&self, row: usize) -> Option<&[u8]> {
        self.raw.get(row).map(|span| self.bytes(*span))
    }

    /// A cell that is copied.
    pub(crate) fn copied(&self, row: usize, number: usize) -> Option<&[u8]> {
        let each = self.copied.len() / self.rows().max(1);
        self.copied.get(row * each + number).map(|span| self.bytes(*span))
    }

    /// The name of a part, if it has one.
    pub(crate) fn name(&self, row: usize) -> Option<std::borrow::Cow<'_, str>> {
        self.name_bytes(row).map(text)
    }

    /// The bytes of a part's name.
    pub(crate) fn name_bytes(&self, row: usize) -> Option<&[u8]> {
        self.names.get(row).map(|span| self.bytes(*span).trim_ascii())
    }

    /// Starts empty columns, one for values of the kind of each in `like`.
    pub(crate) fn start_columns(&mut self, like: impl Iterator<Item = DeviationValue>) {
        self.values = like.map(|like| DeviationValues::repeated(like, 0)).collect();
    }

    /// Empties the block and keeps its memory, because the next block has about as many rows. The columns are for values of the
    /// kind of each in `like`.
    pub(crate) fn clear(&mut self, like: impl Iterator<Item = DeviationValue>) {
        let Self { mut text, mut names, mut raw, mut lines, mut records, .. } = std::mem::take(self);
        let rows = lines.len();
        text.clear();
        for spans in [&mut names, &mut raw] {
            spans.clear();
        }
        for numbers in [&mut lines, &mut records] {
            numbers.clear();
        }
        let values = like.map(|like| DeviationValues::with_room(like, rows)).collect();
        *self = Self { values, text, names, raw, lines, records, ..Self::default() };
    }

    /// Appends bytes to the text.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> Span {
        let start = span_end(self.text.len());
        self.text.extend_from_slice(bytes);
        Span { start, end: span_end(self.text.len()) }
    }

    /// Adds rows of a file without lines. The table has `before` rows before row 0.
    pub(crate) fn plain_rows(&mut self, rows: Range<usize>, before: u64) {
        let (first, count) = (self.record_count, rows.len());
        self.record_count += count as u64;
        self.records.extend(first + 1..=self.record_count);
        self.lines.extend(before + rows.start as u64 + 1..=before + rows.end as u64);
        self.raw.extend(std::iter::repeat_n(Span::default(), count));
    }

    /// Adds a fault of the last row.
    pub(crate) fn fault(&mut self, column: Option<usize>, is_missing: bool, text: &str, message: String) {
        let row = self.rows().saturating_sub(1);
        self.faults.push(Fault { row, column, is_missing, text: text.to_owned(), message });
    }
}

fn tally(tallies: &mut Vec<Tally>, rule: usize) -> &mut Tally {
    if tallies.len() <= rule {
        tallies.resize(rule + 1, Tally::default());
    }
    &mut tallies[rule]
}

/// A place in a block's text in 32 bits: the text is far shorter than 4 GiB.
pub(crate) fn span_end(at: usize) -> u32 {
    u32::try_from(at).unwrap_or(u32::MAX)
}

/// Texts as a line of CSV, in which a rejected row of a file without lines is kept.
pub(crate) fn line_of(cells: impl Iterator<Item = impl AsRef<str>>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // writing to memory does not fail
    for cell in cells {
        let _ = writer.write_field(cell.as_ref());
    }
    let _ = writer.write_record(None::<&[u8]>);
    writer.into_inner().unwrap_or_default()
}
