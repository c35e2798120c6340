//! Rows to columns: each record of a table with a row per part, space or tooth becomes a row of a [`Block`]. A line of
//! plain numbers is read in one pass over its bytes; every other record is cut into cells first. Made once per table;
//! workers share it.

mod aside;
mod contract;
mod contradiction;
mod extremes;
mod stored;

pub(crate) use extremes::Extremes;
pub(crate) use stored::stored_record;

use std::ops::Range;
use std::sync::Arc;

use super::block::{Block, Contradiction, Span, Unsettled, line_of, span_end};
use super::cell::{Cell, Content, Record};
use super::chunk::{ChunkContent, LONGEST_RECORD};
use super::column::{Column, PlainNumbers, Problem};
use super::contract::Contract;
use super::encoding::text;
use super::grid::Separator;
use super::reading::AsideReading;
use super::rejection::{self, Rejection, STRUCK, rejection};
use super::shape::{PartNames, Remarks};
use super::split::{Field, next_record};
use super::understand::Understood;
use super::unknown::speaks_of_value;
use super::want::Want;
use crate::deviation::DeviationValue;
use crate::quantity::{Decimal, shown};
use aside::may_be_statistic;

/// A column of which plain numbers say all.
#[derive(Debug, Clone, Copy)]
struct PlainColumn {
    number: usize,
    place: usize,
    numbers: PlainNumbers,
}

/// What a field of a line of plain numbers is.
#[derive(Debug, Clone, Copy)]
enum PlainField {
    Skipped,
    /// Left out by the rule of that number.
    LeftOut(usize),
    /// Without a heading: nothing may stand there.
    Nameless,
    Id,
    /// The first that is no value, where parts have no names.
    Label,
    Value(PlainColumn),
}

/// How a line of plain numbers is read.
#[derive(Debug, Clone)]
struct PlainRow {
    fields: Vec<PlainField>,
    /// The decimal mark; while it is open, none, so that a number with decimals is looked at twice.
    mark: u8,
}

/// Reads rows.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    setup: Setup,
    wanted: Wanted,
    /// The columns that are needed; `None` where plain numbers do not say all of a row.
    plain_columns: Option<Vec<PlainColumn>>,
    /// `None` where a line of plain numbers does not say all.
    plain: Option<PlainRow>,
}

/// How a table's rows are read.
#[derive(Debug, Clone)]
pub(crate) struct Setup {
    pub(crate) columns: Vec<Column>,
    /// The names of all columns of the file.
    pub(crate) titles: Vec<String>,
    /// The field of the part's name.
    pub(crate) id: Option<usize>,
    /// The field of the number of a space or tooth.
    pub(crate) index: Option<usize>,
    pub(crate) separator: u8,
    /// Whether a row has as many cells as the header, as in a text with separators.
    pub(crate) is_even: bool,
    /// The fields that hold no numbers as far as the table was looked at, and would be measurements if they did.
    pub(crate) watched: Vec<usize>,
    /// The fields that may hold remarks.
    pub(crate) remarks: Vec<Remarks>,
    pub(crate) names: PartNames,
    /// What the user leaves out.
    pub(crate) want: Want,
    /// The contract by which rows are read, if there is one.
    pub(crate) contract: Option<Arc<Contract>>,
}

/// What is wanted of rows besides their values.
#[derive(Debug, Clone, Default)]
pub(crate) struct Wanted {
    /// Which columns are needed.
    pub(crate) needed: Vec<bool>,
    /// The fields that are copied.
    pub(crate) copied: Vec<usize>,
    /// Whether rows are kept as they stand.
    pub(crate) keeps_raw: bool,
}

impl Setup {
    pub(crate) fn of(understood: &Understood, want: &Want) -> Self {
        let Understood { shape, columns, mark, separator, .. } = understood;
        let mut columns = columns.clone();
        for column in &mut columns {
            column.mark_is_open = mark.is_none();
        }
        Self {
            columns,
            titles: shape.header.iter().map(|cell| cell.text().into_owned()).collect(),
            id: shape.ids.as_ref().map(|ids| ids.place),
            index: shape.index.as_ref().map(|index| index.place),
            separator: separator.map_or(b',', Separator::byte),
            is_even: matches!(separator, Some(Separator::Character(_))),
            watched: shape.watched(want),
            remarks: shape.remarks(want),
            names: shape.part_names(),
            want: want.clone(),
            contract: None,
        }
    }

    /// Of a closed table; `separator` is that of a text with one.
    pub(crate) fn by_contract(
        contract: Arc<Contract>,
        columns: Vec<Column>,
        titles: Vec<String>,
        id: Option<usize>,
        separator: Option<u8>,
        want: &Want,
    ) -> Self {
        Self {
            columns,
            titles,
            id,
            index: None,
            separator: separator.unwrap_or(b','),
            is_even: separator.is_some(),
            watched: Vec::new(),
            remarks: Vec::new(),
            names: PartNames::default(),
            want: want.clone(),
            contract: Some(contract),
        }
    }
}

impl PlainRow {
    /// `None` if lines are not made of the fields of a header.
    fn of(setup: &Setup, columns: &[PlainColumn]) -> Option<Self> {
        let first = setup.columns.first().filter(|column| !column.mark_is_open);
        let mark = first.map_or(0, |column| column.mark.byte());
        let mut row = Self { fields: vec![PlainField::Skipped; setup.titles.len()], mark };
        for column in columns {
            *row.fields.get_mut(column.place)? = PlainField::Value(*column);
        }
        if let Some(contract) = &setup.contract {
            contract.plain_fields(&mut row.fields);
        }
        if let Some(id) = setup.id {
            *row.fields.get_mut(id)? = PlainField::Id;
        } else if setup.contract.is_some() {
            // rows without names are told by their values alone
        } else if let Some(field) = row.fields.iter_mut().find(|field| matches!(field, PlainField::Skipped)) {
            *field = PlainField::Label;
        }
        (setup.is_even && !row.fields.is_empty()).then_some(row)
    }
}

impl Rows {
    pub(crate) fn new(setup: Setup, wanted: Wanted) -> Self {
        let mut rows = Self { setup, wanted, plain_columns: None, plain: None };
        if rows.setup.contract.is_some() {
            // what nobody reads is not owned
            rows.wanted.needed = vec![true; rows.setup.columns.len()];
        }
        let has_status = rows.setup.contract.as_ref().is_some_and(|contract| contract.status().is_some());
        let is_plain =
            !has_status && rows.setup.index.is_none() && rows.wanted.copied.is_empty() && rows.setup.watched.is_empty();
        let column = |(number, column): (usize, &Column)| {
            Some(PlainColumn { number, place: column.place, numbers: column.plain()? })
        };
        rows.plain_columns = rows.needed().map(column).collect::<Option<_>>().filter(|_| is_plain);
        rows.plain = rows.plain_columns.as_ref().and_then(|columns| PlainRow::of(&rows.setup, columns));
        rows
    }

    /// The columns that are needed, and their numbers.
    fn needed(&self) -> impl Iterator<Item = (usize, &Column)> {
        self.setup.columns.iter().enumerate().filter(|(number, _)| self.wanted.needed[*number])
    }

    /// Whether parts have names.
    pub(crate) fn has_id(&self) -> bool {
        self.setup.id.is_some()
    }

    pub(crate) fn separator(&self) -> u8 {
        self.setup.separator
    }

    /// The rows of a chunk of text behind so many lines; the chunk's bytes become the block's text.
    pub(crate) fn chunk(&self, chunk: &mut Vec<u8>, holds: ChunkContent, lines: u64, block: &mut Block) {
        block.clear(self.setup.columns.iter().map(Column::nothing));
        block.line_count = lines;
        std::mem::swap(&mut block.text, chunk);
        match holds {
            ChunkContent::Records => self.records(block),
            ChunkContent::Piece { first, last } => self.piece(first, last, block),
        }
    }

    /// The same without the fast case.
    #[cfg(test)]
    pub(super) fn without_plain_lines(self) -> Self {
        Self { plain: None, ..self }
    }

    fn records(&self, block: &mut Block) {
        // what is added to the text stands behind what is read
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
                self.row(&record, raw, block);
            }
            block.line_count += found.lines;
            at = found.next;
        }
    }

    /// Reads the line at the start of `unread` if it is made of as many fields as the header, with plain numbers where values
    /// are read, all in quotes or not; the place behind it. Nothing is left in the block if it is not.
    #[inline]
    fn plain_row(&self, row: &PlainRow, unread: Range<usize>, block: &mut Block) -> Option<usize> {
        // a line without a character is no record
        let first = block.text[unread.start];
        if matches!(first, b'\n' | b'\r')
            || self.setup.contract.as_ref().is_some_and(|contract| contract.may_cover(first))
        {
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
            at += usize::from(quoted);
            if let PlainField::Value(column) = field {
                let (number, end) = Decimal::plain(bytes, at, row.mark)?;
                if !values[column.number].push(column.numbers.deviation(number)?) {
                    return None;
                }
                at = end;
            } else {
                let start = at;
                while let Some(&byte) = bytes.get(at) {
                    if byte == b'\n' || byte == b'\r' || byte == if quoted { b'"' } else { self.setup.separator } {
                        break;
                    }
                    at += 1;
                }
                let text = &bytes[start..at];
                // a remark that is new may hold a value, or say that the part does not count
                if self.setup.remarks.iter().any(|remarks| remarks.place == index && remarks.is_new(text)) {
                    return None;
                }
                match (&self.setup.contract, field) {
                    (Some(_), PlainField::LeftOut(rule)) => {
                        let span = Span { start: span_end(start), end: span_end(at) };
                        unsettled.push(Unsettled { rule: *rule, place: index, span });
                    }
                    (Some(_), PlainField::Nameless) if !text.trim_ascii().is_empty() => return None,
                    (Some(_), PlainField::Id) if !Contract::is_plain_name(text) => return None,
                    _ => {}
                }
                let says_what = self.setup.contract.is_none() && matches!(field, PlainField::Id | PlainField::Label);
                if says_what
                    && (text.is_empty() || matches!(text[0], b'=' | b'*' | b'`' | b'~') || may_be_statistic(text))
                {
                    return None;
                }
                if matches!(field, PlainField::Id) {
                    names.push(Span { start: span_end(start), end: span_end(at) });
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

    /// A record of a file that has cells of its own, or of a short `text`.
    pub(crate) fn record(&self, record: &Record, text: Option<&str>, block: &mut Block) {
        if block.contradiction.is_some() {
            return;
        }
        if block.values.is_empty() {
            block.start_columns(self.setup.columns.iter().map(Column::nothing));
        }
        block.record_count += 1;
        let raw = match text {
            _ if !self.wanted.keeps_raw => Span::default(),
            Some(text) => block.append(&record.line_in(text)),
            None => block.append(&line_of(record.cells.iter().map(Cell::text))),
        };
        self.row(record, raw, block);
    }

    /// A record with its cells found: a part, or why it is none.
    fn row(&self, record: &Record, raw: Span, block: &mut Block) {
        if let Some(contract) = &self.setup.contract {
            return self.owned_row(contract, record, raw, block);
        }
        if record.cells.iter().all(Cell::is_empty) {
            block.blank_lines += 1;
            return;
        }
        if let Some(contradiction) = self.contradiction(record) {
            block.contradiction.get_or_insert(contradiction);
            return;
        }
        if record.says_nothing() || self.is_aside(record) {
            let words = Cell::of_text(&record.in_words(), 0..0);
            rejection::add(&mut block.rejections, rejection("a line", [&words], false));
            block.asides.push(AsideReading { line: record.line, text: record.in_words() });
            let is_statistic = record.numbers() > 0 && self.statistic(record).is_some();
            block.statistics.extend(is_statistic.then(|| record.clone()));
            return;
        }
        if let Some(message) = self.misfit(record) {
            return self.refuse(record.line, raw, block, &record.in_words(), message);
        }
        self.values_of(record, raw, block);
    }

    /// A record that is a part: its name and its values.
    fn values_of(&self, record: &Record, raw: Span, block: &mut Block) {
        start(record.line, raw, block);
        rejection::add(&mut block.rejections, self.rejections(record));
        if let Some(place) = self.setup.id {
            let name = block.append(record.cell(place).text().as_bytes());
            block.names.push(name);
        }
        for place in &self.wanted.copied {
            let copied = block.append(record.cell(*place).text().as_bytes());
            block.copied.push(copied);
        }
        for (number, column) in self.needed() {
            let cell = record.cell(column.place);
            put(block, number, column, cell, column.read(cell, column.beside_in(record)));
        }
        if let Some(index) = self.setup.index {
            take_index(block, record.cell(index));
        }
    }

    /// What new remarks say against the part of a record, or its name that is struck through.
    fn rejections(&self, record: &Record) -> impl Iterator<Item = Rejection> {
        let name = self.setup.id.and_then(|id| Some((self.setup.titles.get(id)?, record.cells.get(id)?)));
        let struck = name.filter(|(_, name)| name.text().starts_with(STRUCK));
        let struck = struck.and_then(|(title, name)| rejection(title, [name], false));
        let said = self.setup.remarks.iter().filter_map(|remarks| {
            let cell = record.cells.get(remarks.place).filter(|cell| remarks.is_new(cell.text().as_bytes()))?;
            rejection(self.setup.titles.get(remarks.place)?, [cell], remarks.are_verdicts)
        });
        said.chain(struck)
    }

    /// Why the cells of a record are not those of a row.
    fn misfit(&self, record: &Record) -> Option<String> {
        if let Some(line) = swallowed(record, self.setup.separator) {
            return Some(format!("a cell holds a line break and then `{line}`: a quote may be missing"));
        }
        let (width, is_even) = (self.setup.titles.len(), self.setup.is_even);
        // beside a sheet's table, words are remarks and numbers are values
        let is_value = |cell: &Cell| cell.is_number() || speaks_of_value(&cell.text());
        let is_beyond = |cell: &Cell| if is_even { !cell.is_empty() } else { is_value(cell) };
        let is_wrong = record.cells.iter().skip(width).any(is_beyond)
            || is_even && record.cells.len() < width
            || record.cells.len() > width && self.has_decimal_comma(record);
        is_wrong.then(|| format!("the row has {} fields and the header has {width}", record.cells.len()))
    }

    /// Whether commas between cells have cut a number, so that a name or a fraction stands behind a whole one: `24.998,0,412,JS`.
    fn has_decimal_comma(&self, record: &Record) -> bool {
        let is_value = |place: usize| self.setup.columns.iter().any(|column| column.place == place);
        let is_whole = |cell: &Cell| !cell.is_empty() && cell.is_whole();
        let is_cut = |column: &Column| {
            let (cell, next) = (record.cell(column.place), record.cell(column.place + 1));
            let is_fraction = next.text().starts_with('0') && next.text().len() > 1;
            is_whole(cell) && is_whole(next) && (is_fraction || !is_value(column.place + 1))
        };
        self.setup.separator == b',' && self.setup.columns.iter().any(is_cut)
    }

    /// A record that is no row of values at all: a row without them, so that columns stay as long as each other.
    fn refuse(&self, line: u64, raw: Span, block: &mut Block, text: &str, message: String) {
        start(line, raw, block);
        if self.setup.id.is_some() {
            block.names.push(Span::default());
        }
        block.copied.extend(std::iter::repeat_n(Span::default(), self.wanted.copied.len()));
        for (number, _) in self.needed() {
            block.values[number].push_nothing();
        }
        if self.setup.index.is_some() {
            block.index.push(None);
        }
        block.fault(None, false, &shown(text), message);
    }

    /// A piece of a record that is too long: one refused row, however many pieces.
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
        Err(problem) => {
            if let Problem::Mark { help, .. } = problem {
                block.contradiction.get_or_insert_with(|| Contradiction {
                    line: block.lines.last().copied().unwrap_or(0),
                    column: column.title.clone(),
                    message: problem.message(),
                    help,
                });
            }
            problem.message()
        }
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

/// The number of a space or tooth in the last row.
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
    let cell = |field: &Field| Cell::of_text(text(&field.content(bytes)).trim(), 0..0);
    fields.iter().map(cell).collect()
}

/// A line with separators inside a cell, as a quote too many leaves it there.
fn swallowed(record: &Record, separator: u8) -> Option<String> {
    let cell = record.cells.iter().find(|cell| matches!(&cell.content, Content::Text(text) if text.contains('\n')))?;
    let text = cell.text();
    let line = text.lines().skip(1).find(|line| line.contains(char::from(separator)))?;
    Some(shown(line))
}
