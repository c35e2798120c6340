//! Rows to columns: each record of a table with a row per part, space or tooth becomes a row of a [`Block`]. A line of
//! plain numbers is read in one pass over its bytes; every other record is cut into cells first. Made once per table;
//! workers share it.

mod extremes;
mod stored;

pub(crate) use extremes::Extremes;
pub(crate) use stored::stored_record;

use std::borrow::Cow;
use std::mem::discriminant;
use std::ops::Range;

use super::block::{Block, Contradiction, Span, line_of, span_end};
use super::cell::{Cell, Content, Record};
use super::chunk::{ChunkContent, LONGEST_RECORD};
use super::column::{Column, Nominal, PlainNumbers, Problem};
use super::encoding::text;
use super::grid::{Separator, bare_unit, only_units};
use super::lines::{Beside, of_all_values};
use super::names::{
    Role, heading, is_of_parts, is_total, is_value_heading, names_value, role, says_largest, split_unit,
};
use super::reading::AsideReading;
use super::rejection::{self, Rejection, STRUCK, rejection};
use super::shape::{PartNames, Remarks, has_digit, is_numbered, stated_units};
use super::split::{Field, next_record};
use super::strangers::Others;
use super::understand::Understood;
use super::unknown::speaks_of_value;
use super::want::Want;
use crate::deviation::DeviationValue;
use crate::quantity::{Decimal, Unit, shown};

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
        if let Some(id) = setup.id {
            *row.fields.get_mut(id)? = PlainField::Id;
        } else if let Some(field) = row.fields.iter_mut().find(|field| matches!(field, PlainField::Skipped)) {
            *field = PlainField::Label;
        }
        (setup.is_even && !row.fields.is_empty()).then_some(row)
    }
}

impl Rows {
    pub(crate) fn new(setup: Setup, wanted: Wanted) -> Self {
        let mut rows = Self { setup, wanted, plain_columns: None, plain: None };
        let is_plain = rows.setup.index.is_none() && rows.wanted.copied.is_empty() && rows.setup.watched.is_empty();
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

    /// The rows of a chunk of text; the chunk's bytes become the block's text.
    pub(crate) fn chunk(&self, chunk: &mut Vec<u8>, holds: ChunkContent, block: &mut Block) {
        block.clear(self.setup.columns.iter().map(Column::nothing));
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
        if matches!(block.text[unread.start], b'\n' | b'\r') {
            return None;
        }
        let start = block.rows();
        let next = self.plain_fields(row, unread, block);
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
        let Block { text, values, names, .. } = block;
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
                let says_what = matches!(field, PlainField::Id | PlainField::Label);
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
        let text_of = |place: usize| record.cells.get(place).map(Cell::text).unwrap_or_default();
        if let Some(place) = self.setup.id {
            let name = block.append(text_of(place).as_bytes());
            block.names.push(name);
        }
        for place in &self.wanted.copied {
            let copied = block.append(text_of(*place).as_bytes());
            block.copied.push(copied);
        }
        for (number, column) in self.needed() {
            let cell = record.cells.get(column.place).cloned().unwrap_or_default();
            let value = column.read(&cell, column.beside.map(|companion| record.cells.get(companion.place)));
            put(block, number, column, &cell, value);
        }
        if let Some(index) = self.setup.index {
            take_index(block, record.cells.get(index));
        }
    }

    /// Why nothing from a record on can be trusted.
    fn contradiction(&self, record: &Record) -> Option<Contradiction> {
        if only_units(&record.cells).is_some() && !self.repeats_units(record) || self.states_other_unit(record) {
            let column = self.setup.columns.first().map(|column| &column.title);
            let message = format!("the units change: {}", record.in_words());
            return Some(contradiction(record, column, message, "write every table with one unit by itself"));
        }
        let is_value = |place: &&usize| {
            let is_nameless = self.setup.titles.get(**place).is_some_and(String::is_empty);
            let is_value = |cell: &Cell| cell.is_number() || is_nameless && speaks_of_value(&cell.text());
            record.cells.get(**place).is_some_and(is_value)
        };
        if let Some(watched) = self.setup.watched.iter().find(is_value) {
            let message = "it holds a number here, and nothing tells what it measures".to_owned();
            let help = "say in the spec what it is, under [batch.columns], or leave it out with --ignore";
            return Some(contradiction(record, self.setup.titles.get(*watched), message, help));
        }
        self.other_header(record)
            .or_else(|| self.other_nominal(record))
            .or_else(|| self.error_as_part(record))
            .or_else(|| self.value_in_remark(record))
            .or_else(|| self.said_of_all(record))
    }

    /// A line of words that says of all values that they do not count, or what else they are: `Sollwerte`.
    fn said_of_all(&self, record: &Record) -> Option<Contradiction> {
        let mut cells = record.cells.iter().filter(|cell| !cell.is_empty());
        let (Some(cell), None) = (cells.next(), cells.next()) else { return None };
        let line = AsideReading { line: record.line, text: cell.text().into_owned() };
        of_all_values(&line, &self.setup.columns, &self.setup.want)
            .filter(|said| !said.is_ignored(&self.setup.want))?;
        let message = format!("it says of all values that they are none of parts: {}", shown(&line.text));
        let help = "take the line out of the table, with the rows of which it speaks; or leave it out with --ignore";
        Some(contradiction(record, None, message, help))
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

    /// A remark that speaks of a value, which may correct the one that is read.
    fn value_in_remark(&self, record: &Record) -> Option<Contradiction> {
        let Setup { columns, titles, names, want, .. } = &self.setup;
        let beside = Beside { columns, width: titles.len(), of_parts: Some(names), measured: None };
        let value = |Remarks { place, has_digits, .. }: &Remarks| {
            if *has_digits {
                return None;
            }
            let cell = record.cells.get(*place).filter(|cell| has_digit(&cell.text()))?;
            let value = beside.value_in_remark(cell, &format!("column {}", place + 1), record.line)?;
            let is_left_out = value.is_ignored(want) || Others::of(columns, want).leaves_out(&value);
            (!is_left_out).then(|| (*place, cell.text()))
        };
        let (place, text) = self.setup.remarks.iter().find_map(value)?;
        let message = format!("a remark that may be a measured value: {}", shown(&text));
        let help = "correct the value that it speaks of, or leave the column out with --ignore";
        Some(contradiction(record, titles.get(place), message, help))
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
        let is_wrong = record.cells.iter().skip(width).any(is_beyond) || is_even && record.cells.len() < width;
        is_wrong.then(|| format!("the row has {} fields and the header has {width}", record.cells.len()))
    }

    /// Another header among the rows: its columns are not those that are read.
    fn other_header(&self, record: &Record) -> Option<Contradiction> {
        let is_name = |cell: &&Cell| {
            self.setup.titles.iter().any(|title| *title == cell.text()) || heading(&cell.text(), &[]).is_some()
        };
        let names_column = |cell: &Cell| {
            self.setup.columns.iter().any(|column| column.title == cell.text()) || names_value(&cell.text(), &[])
        };
        let cells = || record.cells.iter().filter(|cell| !cell.is_missing());
        // `Teil` below `Teil` begins another table, whatever stands beside it
        let is_named_again = || {
            let title = self.setup.id.and_then(|id| Some((self.setup.titles.get(id)?, record.cells.get(id)?)));
            title.is_some_and(|(title, cell)| !cell.is_empty() && cell.text() == *title) && cells().count() > 1
        };
        let is_other = record.numbers() == 0
            && (cells().any(names_column) && cells().filter(is_name).count() > 1 || is_named_again())
            && !self.repeats_header(record);
        let message = || format!("other names begin here: {}", record.in_words());
        is_other.then(|| contradiction(record, None, message(), "give tables with other columns one by one"))
    }

    /// A row of nominal values that are not those of the columns.
    fn other_nominal(&self, record: &Record) -> Option<Contradiction> {
        let name = self.label(record)?;
        if !may_be_statistic(name.as_bytes()) || role(&name) != Some(Role::Nominal) {
            return None;
        }
        let other = self.setup.columns.iter().find(|column| {
            let cell = record.cells.get(column.place).filter(|cell| !cell.is_missing());
            cell.is_some_and(|cell| column.quantity(cell).ok() != column.nominal_of_every_part())
        })?;
        let message = format!("the nominal value here is not the column's: {}", record.in_words());
        let help = "give the nominal value in the spec, or in a column beside the values";
        Some(contradiction(record, Some(&other.title), message, help))
    }

    /// A line such as `rack_pitch;0.2` below the parts, which names no part.
    fn error_as_part(&self, record: &Record) -> Option<Contradiction> {
        let id = self.setup.id?;
        let name = record.cells.get(id)?.text();
        let is_word = name.len() > 1 && may_be_statistic(name.as_bytes()) && !is_of_parts(&name);
        if !is_word || record.numbers() == 0 || !is_value_heading(&name, &[]) {
            return None;
        }
        let message = format!("an error stands here where parts have their names: {}", record.in_words());
        let help = "write a table with a row per part, or one with a row per error";
        Some(contradiction(record, self.setup.titles.get(id), message, help))
    }

    /// Whether a record is the header again.
    fn repeats_header(&self, record: &Record) -> bool {
        let same = |(cell, title): (&Cell, &String)| cell.text().trim() == title.trim();
        record.cells.len() == self.setup.titles.len() && record.cells.iter().zip(&self.setup.titles).all(same)
    }

    /// Whether a row of units says of every column what is known of it.
    fn repeats_units(&self, record: &Record) -> bool {
        let is_that_of = |cell: &Cell, column: &Column| column.has_unit(&cell.text());
        if record.cells.len() < self.setup.titles.len() && !self.setup.is_even {
            // between blanks, a unit has no place but its order
            let cells = record.cells.iter().filter(|cell| !cell.is_missing());
            let mut columns: Vec<&Column> = self.setup.columns.iter().collect();
            columns.sort_by_key(|column| column.place);
            return cells.clone().count() == columns.len()
                && cells.zip(columns).all(|(cell, column)| is_that_of(cell, column));
        }
        self.setup.columns.iter().all(|column| {
            let cell = record.cells.get(column.place).filter(|cell| !cell.is_missing());
            cell.is_none_or(|cell| is_that_of(cell, column))
        })
    }

    /// Whether a line without numbers states a unit that no column has, of length or angle as some have: `Werte in mm`.
    fn states_other_unit(&self, record: &Record) -> bool {
        let columns = &self.setup.columns;
        let is_below_units =
            |column: &Column| record.cells.get(column.place).is_some_and(|cell| column.has_unit(&cell.text()));
        if record.numbers() > 0 || self.repeats_header(record) || columns.iter().any(is_below_units) {
            return false;
        }
        let is_other = |unit: Unit| {
            let is_alike = |column: &&Column| discriminant(&column.unit) == discriminant(&unit);
            columns.iter().any(|column| is_alike(&column)) && columns.iter().all(|column| column.unit != unit)
        };
        record.cells.iter().filter(|cell| !has_digit(&cell.text())).any(|cell| {
            let text = cell.text();
            let of_heading = split_unit(&text).1.and_then(|unit| Unit::from_symbol(&unit));
            let alone = Unit::from_symbol(bare_unit(&text));
            let stated = stated_units(&text).into_iter().filter(|stated| stated.is_clear).map(|stated| stated.unit);
            of_heading.into_iter().chain(alone).chain(stated).any(is_other)
        })
    }

    /// What a record says that it is: its name, or what stands first in it and is no value.
    fn label<'r>(&self, record: &'r Record) -> Option<Cow<'r, str>> {
        let is_value = |place: usize| self.setup.columns.iter().any(|column| column.place == place);
        let own = self.setup.id.or(self.setup.index);
        let mut places = own.into_iter().chain((0..record.cells.len()).filter(|place| !is_value(*place)));
        places.find_map(|place| record.cells.get(place).filter(|cell| !cell.is_empty())).map(Cell::text)
    }

    /// Whether a record is the header or the units again, or a mean below the parts.
    fn is_aside(&self, record: &Record) -> bool {
        let name = self.setup.id.or(self.setup.index).and_then(|place| record.cells.get(place)).map(Cell::text);
        let has_numbers = record.numbers() > 0;
        let is_words = !self.setup.is_even && !has_numbers && record.cells.len() != self.setup.titles.len();
        let is_part = |name: &str| is_numbered(name) || self.setup.names.may_have(name);
        let is_counted = || {
            self.setup
                .id
                .zip(self.setup.index)
                .and_then(|(_, index)| record.cells.get(index)?.text().parse::<i64>().ok())
        };
        let is_excluded = |name: &str| {
            may_be_statistic(name.as_bytes())
                && (self.setup.names.exclude(name) && !self.is_measured(record)
                    || self.setup.names.have_spread(name) && self.is_spread(record))
        };
        let is_of_teeth = |cell: &Cell| {
            let text = cell.text();
            is_called_of_parts(&text) || is_total(&text) || says_largest(&text)
        };
        (self.label(record).is_some_and(|label| is_called_of_parts(&label)) || name.as_deref().is_some_and(is_excluded))
            && is_counted().is_none()
            || self.setup.index.and_then(|index| record.cells.get(index)).is_some_and(is_of_teeth)
            || self.is_page(record)
            || is_words && !name.as_ref().is_some_and(|name| is_part(name)) && !self.holds_value(record)
            || (!has_numbers && (self.repeats_header(record) || only_units(&record.cells).is_some()))
    }

    /// Whether a record says where a page ends, and holds at most a count that is no value.
    fn is_page(&self, record: &Record) -> bool {
        let filled: Vec<&Cell> = record.cells.iter().filter(|cell| !cell.is_missing()).collect();
        let is_count = |cell: &&Cell| {
            cell.text().parse::<u64>().is_ok() && !self.setup.columns.iter().any(|column| column.may_hold(cell))
        };
        filled
            .split_first()
            .is_some_and(|(first, others)| others.iter().all(is_count) && self.setup.names.have_no(&first.text()))
    }

    /// Whether a record holds a value near the nominal one, as no count or temperature is; in a row of
    /// several errors it may have any digits.
    fn is_measured(&self, record: &Record) -> bool {
        let columns = &self.setup.columns;
        let cell = |column: &Column| record.cells.get(column.place).filter(|cell| cell.is_number());
        let is_row = columns.len() > 1 && columns.iter().all(|column| cell(column).is_some());
        let is_near = |column: &Column| {
            let is_value = |cell: &Cell| (is_row || cell.has_two_decimals()) && column.may_hold(cell);
            matches!(column.nominal, Nominal::Fixed(_)) && cell(column).is_some_and(is_value)
        };
        columns.iter().any(is_near)
    }

    /// Whether what a record holds is by how much measured values differ, and none of them.
    fn is_spread(&self, record: &Record) -> bool {
        let cells = self.setup.columns.iter().filter_map(|column| Some((column, record.cells.get(column.place)?)));
        let mut filled = cells.filter(|(_, cell)| !cell.is_missing()).peekable();
        filled.peek().is_some() && filled.all(|(column, cell)| column.may_spread_by(cell))
    }

    /// Whether a line of words holds what may be a value.
    fn holds_value(&self, record: &Record) -> bool {
        let aside = AsideReading { line: record.line, text: record.in_words() };
        let Setup { columns, titles, .. } = &self.setup;
        let beside = Beside { columns, width: titles.len(), of_parts: None, measured: None };
        beside.value_in(&aside, false).is_some_and(|unknown| !unknown.is_ignored(&self.setup.want))
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
        block.line_count = memchr::memchr_iter(b'\n', &block.text).count() as u64;
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
        self.refuse(1, raw, block, &start, message);
    }
}

/// A record that contradicts how the table is read, in a column or as a whole.
fn contradiction(record: &Record, column: Option<&String>, message: String, help: &'static str) -> Contradiction {
    Contradiction { line: record.line, column: column.cloned().unwrap_or_default(), message, help }
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
            let help = match problem {
                Problem::OtherMark(_) => Some(
                    "write every number with the same decimal mark; if all have this one, say so: --decimal comma or --decimal point",
                ),
                Problem::OpenMark(_) => Some(
                    "say which mark counts: --decimal comma or --decimal point, or in the spec [batch] decimal = \"comma\"",
                ),
                _ => None,
            };
            if let Some(help) = help {
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
pub(crate) fn take_index(block: &mut Block, cell: Option<&Cell>) {
    let text = cell.map(Cell::text).unwrap_or_default();
    // spreadsheets and programs write 4 as 4,0
    let whole = text.trim().trim_end_matches('0').strip_suffix(['.', ',']).unwrap_or(text.trim());
    let number = whole.parse().ok();
    block.index.push(number);
    if number.is_none() {
        let message =
            if text.is_empty() { "the cell is empty".to_owned() } else { "it is not a whole number".to_owned() };
        block.fault(None, false, &shown(&text), message);
    }
}

/// The cells of a record, as [`grid`](super::grid) cuts them.
fn cells(bytes: &[u8], fields: &[Field]) -> Vec<Cell> {
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

/// Whether a row is called by what is made of the parts', or by what is wanted of them.
fn is_called_of_parts(name: &str) -> bool {
    may_be_statistic(name.as_bytes()) && is_of_parts(name)
}

/// A quick look: such names end in no digit, and begin with a letter or end in one that is not plain.
#[inline]
fn may_be_statistic(name: &[u8]) -> bool {
    let Some((first, last)) = name.first().zip(name.last()) else { return false };
    let is_letter = first.is_ascii_alphabetic() || *first == b' ' || !first.is_ascii() || !last.is_ascii();
    is_letter && !last.is_ascii_digit() && (name.len() > 1 || matches!(first, b's' | b'S' | b'R' | b'n' | b'N'))
}
