//! Rows to columns: each record of a table with a row per part, space or tooth becomes a row of a [`Block`]. A line of plain numbers
//! is read in one pass over its bytes; every other record is cut into cells first. A table has one reader, which workers share.

mod contract;
mod stored;

pub(crate) use contract::Doubtful;
pub(crate) use stored::stored_record;

use std::ops::Range;
use std::sync::Arc;

use super::block::{Block, Span, Unsettled, line_of, span_end};
use super::cell::{Cell, Content, Record};
use super::chunk::{ChunkContent, LONGEST_RECORD};
use super::column::{Column, PlainNumbers, Problem};
use super::contract::Contract;
use super::encoding::text;
use super::split::{Field, at_quote, next_record};
use crate::deviation::{DeviationValue, DeviationValues};
use crate::quantity::{Decimal, shown};

/// A column whose plain numbers say all of its values.
#[derive(Debug, Clone, Copy)]
struct PlainColumn {
    number: usize,
    place: usize,
    numbers: PlainNumbers,
}

/// What a field of a line of plain numbers is.
#[derive(Debug, Clone)]
enum PlainField {
    Skipped,
    /// Left out by the rule of that number.
    LeftOut(usize),
    /// Without a heading: nothing may stand there.
    Nameless,
    Id,
    Value(Box<PlainColumn>),
}

/// How a line of plain numbers is read.
#[derive(Debug, Clone)]
struct PlainRow {
    fields: Vec<PlainField>,
    /// The decimal mark; 0 while it is open, so that a number with decimals is read as a record.
    mark: u8,
}

/// Reads rows.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    setup: Setup,
    wanted: Wanted,
    /// The columns of values; `None` where plain numbers are not all that is read of a row.
    plain_columns: Option<Vec<PlainColumn>>,
    /// How a line of plain numbers is read in one pass; `None` where that is not possible.
    plain: Option<PlainRow>,
}

/// How a table's rows are read.
#[derive(Debug, Clone)]
pub(crate) struct Setup {
    pub(crate) columns: Vec<Column>,
    /// The headings of all columns of the file.
    pub(crate) titles: Vec<String>,
    /// The field of the part's name.
    pub(crate) id: Option<usize>,
    /// The field of the number of a space or tooth.
    pub(crate) index: Option<usize>,
    pub(crate) separator: u8,
    /// Whether a row has as many cells as the header, as in a text with separators.
    pub(crate) is_even: bool,
    /// The contract by which rows are read.
    pub(crate) contract: Arc<Contract>,
}

/// What is wanted of rows besides their values.
#[derive(Debug, Clone, Default)]
pub(crate) struct Wanted {
    /// The fields that are copied.
    pub(crate) copied: Vec<usize>,
    /// Whether rows are kept as they stand.
    pub(crate) keeps_raw: bool,
}

impl PlainRow {
    /// `None` if lines do not have the fields of a header.
    fn of(setup: &Setup, columns: &[PlainColumn]) -> Option<Self> {
        let first = setup.columns.first().filter(|column| !column.mark_is_open);
        let mark = first.map_or(0, |column| column.mark.byte());
        let mut row = Self { fields: vec![PlainField::Skipped; setup.titles.len()], mark };
        for column in columns {
            *row.fields.get_mut(column.place)? = PlainField::Value(Box::new(*column));
        }
        setup.contract.plain_fields(&mut row.fields);
        if let Some(id) = setup.id {
            *row.fields.get_mut(id)? = PlainField::Id;
        }
        (setup.is_even && !row.fields.is_empty()).then_some(row)
    }
}

impl Rows {
    pub(crate) fn new(setup: Setup, wanted: Wanted) -> Self {
        let has_status = setup.contract.status().is_some();
        let is_plain = !has_status && setup.index.is_none() && wanted.copied.is_empty();
        let column = |(number, column): (usize, &Column)| {
            Some(PlainColumn { number, place: column.place, numbers: column.plain()? })
        };
        let columns = setup.columns.iter().enumerate().map(column).collect::<Option<Vec<_>>>().filter(|_| is_plain);
        let plain = columns.as_ref().and_then(|columns| PlainRow::of(&setup, columns));
        Self { setup, wanted, plain_columns: columns, plain }
    }

    /// Whether parts have names.
    pub(crate) fn has_id(&self) -> bool {
        self.setup.id.is_some()
    }

    pub(crate) fn separator(&self) -> u8 {
        self.setup.separator
    }

    /// Reads the rows of a chunk of text. The file has `lines` lines before it. The bytes of the chunk become the block's text.
    pub(crate) fn chunk(&self, chunk: &mut Vec<u8>, holds: ChunkContent, lines: u64, block: &mut Block) {
        block.clear(self.setup.columns.iter().map(Column::nothing));
        block.line_count = lines;
        std::mem::swap(&mut block.text, chunk);
        match holds {
            ChunkContent::Records => self.records(block),
            ChunkContent::Piece { first, last } => self.piece(first, last, block),
        }
    }

    /// The same reader without the quick way for lines of plain numbers.
    #[cfg(test)]
    pub(super) fn without_plain_lines(self) -> Self {
        Self { plain: None, ..self }
    }

    fn records(&self, block: &mut Block) {
        // text that is appended stands behind the bytes of the chunk
        let length = block.text.len();
        let mut fields = Vec::new();
        let mut at = 0;
        while at < length && block.contradiction.is_none() {
            if let Some(plain) = &self.plain
                && let Some(next) = self.plain_row(plain, at..length, block)
            {
                (block.record_count, block.line_count) = (block.record_count + 1, block.line_count + 1);
                start(block.line_count, Span { start: span_end(at), end: span_end(next) }, block);
                at = next;
                continue;
            }
            let mut blank = 0;
            let found = next_record(&block.text[..length], at, self.setup.separator, &mut fields, &mut blank);
            block.blank_lines += blank;
            let Some(found) = found else {
                block.line_count += blank;
                break;
            };
            let line = block.line_count + found.lines_before + 1;
            block.record_count += 1;
            let raw = Span { start: span_end(found.start), end: span_end(found.next) };
            if found.open {
                let message = "a quote is not closed, so the rest of the table is in one field".to_owned();
                self.refuse(line, raw, block, "", message);
            } else {
                let record = Record::new(cells(&block.text, &fields), line);
                self.owned_row(&record, raw, block);
            }
            block.line_count += found.lines;
            at = found.next;
        }
    }

    /// Reads the line at the start of `unread` in one pass, and returns the place behind it. `None`, with the block as it was, if the
    /// line has not as many fields as the header, or something other than a plain number where a value is read. Fields may be in
    /// quotes.
    #[inline]
    fn plain_row(&self, row: &PlainRow, unread: Range<usize>, block: &mut Block) -> Option<usize> {
        // a line without a character is no record
        let first = block.text[unread.start];
        if matches!(first, b'\n' | b'\r') || self.setup.contract.may_cover(first) {
            return None;
        }
        let start = block.rows();
        block.unsettled.clear();
        let next = self.plain_fields(row, unread, block);
        if next.is_some() && !block.unsettled.is_empty() {
            block.settle_left_out(block.line_count + 1);
        }
        if next.is_none() {
            for values in &mut block.values {
                values.truncate(start);
            }
            block.names.truncate(start);
        }
        next
    }

    #[inline]
    fn plain_fields(&self, row: &PlainRow, unread: Range<usize>, block: &mut Block) -> Option<usize> {
        let Block { text, values, names, unsettled, .. } = block;
        let (bytes, mut at) = (&text[..unread.end], unread.start);
        let last = row.fields.len() - 1;
        for (index, field) in row.fields.iter().enumerate() {
            let quoted = bytes.get(at) == Some(&b'"');
            if let PlainField::Value(column) = field {
                // where a number ends must not wait for a quote, which most do not have
                let (value, end) = match Decimal::short(bytes, at, row.mark) {
                    Some((number, end)) => (column.numbers.deviation(number)?, end),
                    None => other_number(column, bytes, at + usize::from(quoted), row.mark)?,
                };
                if !values[column.number].push(value) {
                    return None;
                }
                at = end;
            } else {
                at += usize::from(quoted);
                let start = at;
                while let Some(&byte) = bytes.get(at) {
                    if byte == b'\n' || byte == b'\r' || byte == if quoted { b'"' } else { self.setup.separator } {
                        break;
                    }
                    at += 1;
                }
                let text = &bytes[start..at];
                if !quoted && at_quote(bytes, start).is_some() {
                    return None;
                }
                let span = Span { start: span_end(start), end: span_end(at) };
                match field {
                    PlainField::LeftOut(rule) => unsettled.push(Unsettled { rule: *rule, place: index, span }),
                    PlainField::Nameless if !text.trim_ascii().is_empty() => return None,
                    PlainField::Id if !Contract::is_plain_name(text) => return None,
                    PlainField::Id => names.push(span),
                    _ => {}
                }
            }
            if quoted {
                if bytes.get(at) != Some(&b'"') {
                    return None;
                }
                at += 1;
            }
            if index < last {
                if bytes.get(at) != Some(&self.setup.separator) {
                    return None;
                }
                at += 1;
            }
        }
        match bytes.get(at) {
            Some(b'\n') => Some(at + 1),
            Some(b'\r') if bytes.get(at + 1) == Some(&b'\n') => Some(at + 2),
            None => Some(at),
            Some(_) => None,
        }
    }

    /// Reads a record of a file with cells, or of a text that is read as a whole.
    pub(crate) fn record(&self, record: &Record, block: &mut Block) {
        if block.contradiction.is_some() {
            return;
        }
        if block.values.is_empty() {
            block.start_columns(self.setup.columns.iter().map(Column::nothing));
        }
        block.record_count += 1;
        let raw = if self.wanted.keeps_raw {
            block.append(&line_of(record.cells.iter().map(Cell::text)))
        } else {
            Span::default()
        };
        self.owned_row(record, raw, block);
    }

    /// Rejects a record. It becomes a row without values, so that all columns have as many rows.
    fn refuse(&self, line: u64, raw: Span, block: &mut Block, text: &str, message: String) {
        start(line, raw, block);
        if self.setup.id.is_some() {
            block.names.push(Span::default());
        }
        block.copied.extend(std::iter::repeat_n(Span::default(), self.wanted.copied.len()));
        block.values.iter_mut().for_each(DeviationValues::push_nothing);
        if self.setup.index.is_some() {
            block.index.push(None);
        }
        block.fault(None, false, &shown(text), message);
    }

    /// Reads a piece of a record that is too long. All pieces together are one rejected row.
    fn piece(&self, first: bool, last: bool, block: &mut Block) {
        let raw = Span { start: 0, end: span_end(block.text.len()) };
        (block.is_rest, block.goes_on) = (!first, !last);
        if !first {
            if self.wanted.keeps_raw {
                block.raw.push(raw);
            }
            return;
        }
        block.record_count = 1;
        let start = text(&block.text[..block.text.len().min(200)]).into_owned();
        let limit = LONGEST_RECORD >> 10;
        let message = format!("the row is longer than {limit} KiB: a quote may not be closed, or a line end missing");
        self.refuse(block.line_count + 1, raw, block, &start, message);
    }
}

/// The deviation of a plain number that is long, or stands in quotes, and the place behind it.
#[inline(never)]
fn other_number(column: &PlainColumn, bytes: &[u8], at: usize, mark: u8) -> Option<(DeviationValue, usize)> {
    let (number, end) = Decimal::plain(bytes, at, mark)?;
    Some((column.numbers.deviation(number)?, end))
}

/// Begins a row.
pub(crate) fn start(line: u64, raw: Span, block: &mut Block) {
    block.lines.push(line);
    block.records.push(block.record_count);
    block.raw.push(raw);
}

/// Puts what a cell means into the block's last row.
pub(crate) fn put(
    block: &mut Block,
    number: usize,
    column: &Column,
    cell: &Cell,
    value: Result<Option<DeviationValue>, Problem>,
) {
    let is_missing = matches!(value, Ok(None));
    let fault = match value {
        Ok(Some(value)) if block.values[number].push(value) => return,
        Ok(Some(value)) => format!("{value} is of another dimension than the values of the column"),
        Ok(None) => missing(column, cell),
        Err(problem) => problem.message,
    };
    block.values[number].push_nothing();
    block.fault(Some(number), is_missing, &shown(&cell.text()), fault);
}

fn missing(column: &Column, cell: &Cell) -> String {
    let name = column.kind.map_or(column.field.key(), |kind| kind.name());
    let text = cell.text();
    let written = if text.is_empty() { String::new() } else { format!(" (`{}`)", shown(&text)) };
    format!("there is no value for {name}{written}: a part is judged by all its values")
}

/// Reads the number of the space or tooth of the last row.
pub(crate) fn take_index(block: &mut Block, cell: &Cell) {
    let text = cell.text();
    // spreadsheets and programs write 4 as 4,0
    let whole = text.trim().trim_end_matches('0').strip_suffix(['.', ',']).unwrap_or(text.trim());
    let number = whole.parse().ok();
    block.index.push(number);
    if number.is_none() {
        let message = if text.is_empty() { "the cell is empty" } else { "it is not a whole number" };
        block.fault(None, false, &shown(&text), message.to_owned());
    }
}

/// The cells of a record, as [`grid`](super::grid) cuts them.
pub(crate) fn cells(bytes: &[u8], fields: &[Field]) -> Vec<Cell> {
    let cell = |field: &Field| Cell::of_text(text(&field.content(bytes)).trim());
    fields.iter().map(cell).collect()
}

/// A line with separators inside a cell, as a surplus quote leaves it there.
fn swallowed(record: &Record, separator: u8) -> Option<String> {
    let cell = record.cells.iter().find(|cell| matches!(&cell.content, Content::Text(text) if text.contains('\n')))?;
    let text = cell.text();
    let line = text.lines().skip(1).find(|line| line.contains(char::from(separator)))?;
    Some(shown(line))
}
