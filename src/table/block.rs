//! Some rows of a table as columns: the seam between whatever a table was and whoever evaluates it. Filled by the readers;
//! read by the evaluators of parts and of teeth.

use std::collections::HashSet;
use std::ops::Range;

use super::encoding::text;
use super::ledger::{Tally, join};
use super::reading::{AsideReading, Reading};
use crate::deviation::{DeviationValue, DeviationValues};

/// Bytes of a block's text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Span {
    pub(crate) start: u32,
    pub(crate) end: u32,
}

/// A cell that a rule leaves out, of a row that may yet be read otherwise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unsettled {
    pub(crate) rule: usize,
    pub(crate) place: usize,
    pub(crate) span: Span,
}

/// A row that is rejected, and that may be no part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Odd {
    pub(crate) line: u64,
    /// The row as a line.
    pub(crate) text: String,
    /// What stands where parts have their name; the first cell where they have none.
    pub(crate) name: String,
    /// Whether that is none of a part's.
    pub(crate) is_no_name: bool,
    /// Whether something else than a number stands in the place of a value.
    pub(crate) has_text: bool,
    /// Whether every value can be read.
    pub(crate) could_be_part: bool,
}

/// Why a row is no part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The row, from 0.
    pub row: usize,
    /// The column of the table that is to blame, if one is.
    pub column: Option<usize>,
    /// Whether there is no value, in place of a bad one.
    pub is_missing: bool,
    /// What stands there, if that is what is wrong.
    pub text: String,
    /// What is wrong.
    pub message: String,
}

/// A cell that contradicts how the table is read, so that nothing after it can be trusted.
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

/// Some rows of a table.
#[derive(Debug, Default)]
pub struct Block {
    /// By column of the table; one that nobody needs is empty. Where a row has a fault, the value is
    /// nothing that was measured.
    pub(crate) values: Vec<DeviationValues>,
    /// By row.
    pub(crate) faults: Vec<Fault>,
    /// Numbers of spaces or teeth.
    pub(crate) index: Vec<Option<i64>>,
    /// What the spans point into.
    pub(crate) text: Vec<u8>,
    /// The name of each part; empty if they have none.
    pub(crate) names: Vec<Span>,
    /// The rows as they stand in the file.
    pub(crate) raw: Vec<Span>,
    /// The cells that are copied, row by row.
    pub(crate) copied: Vec<Span>,
    /// The line of each row, from 1.
    pub(crate) lines: Vec<u64>,
    /// The record of each row from the start of the block, from 1.
    pub(crate) records: Vec<u64>,
    /// Records that are no parts: a header again, a mean.
    pub(crate) asides: Vec<AsideReading>,
    /// The least and the greatest value of each column.
    pub(crate) ends: Vec<Option<[DeviationValue; 2]>>,
    /// What each rule of a contract left out, by its number.
    pub(crate) left_out: Vec<Tally>,
    /// Lines that a rule left out, and that could be parts: the number of the rule among those for lines, and the line.
    pub(crate) doubtful: Vec<(usize, u64, String)>,
    /// Rows that are rejected, and that may be no parts.
    pub(crate) odd: Vec<Odd>,
    /// What is left out of the row that is being read.
    pub(crate) unsettled: Vec<Unsettled>,
    /// The rows of parts that a measuring program rejects.
    pub(crate) failed: Vec<usize>,
    /// Records in all.
    pub(crate) record_count: u64,
    /// Lines of the table up to the block's end.
    pub(crate) line_count: u64,
    pub(crate) blank_lines: u64,
    pub(crate) contradiction: Option<Contradiction>,
    /// Whether it is the rest of a row that is too long to be one, for whoever keeps rejected rows.
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

    /// Takes what is left out of a row that is read.
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

    /// Adds what rows say besides their values to how their table was read.
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

    /// Columns for such values, without any so far.
    pub(crate) fn start_columns(&mut self, like: impl Iterator<Item = DeviationValue>) {
        self.values = like.map(|like| DeviationValues::repeated(like, 0)).collect();
    }

    /// Forgets everything but its room: the next block has about as many rows. The columns are for such values.
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

    /// Appends text.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> Span {
        let start = span_end(self.text.len());
        self.text.extend_from_slice(bytes);
        Span { start, end: span_end(self.text.len()) }
    }

    /// Begins rows without text; of the table, `before` rows come before the first of all.
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

/// A place in a text; a block's is far below 4 GiB.
pub(crate) fn span_end(at: usize) -> u32 {
    u32::try_from(at).unwrap_or(u32::MAX)
}

/// Texts as a line of cells between commas, for whoever keeps the rows of files without lines.
pub(crate) fn line_of(cells: impl Iterator<Item = impl AsRef<str>>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // there is always room in memory
    for cell in cells {
        let _ = writer.write_field(cell.as_ref());
    }
    let _ = writer.write_record(None::<&[u8]>);
    writer.into_inner().unwrap_or_default()
}
