//! Cells as files: texts in every dialect and encoding, workbooks, Parquet, and Q-DAS files.

use std::io::Write as _;
use std::sync::Arc;

use proptest::prelude::*;
use proptest::sample::select;

use super::grid::{Cell, Grid};
use super::parts::{Nominal, Number, Parts};

/// What stands between the cells of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Between {
    Mark(char),
    Blanks,
    /// A table as Markdown writes it.
    Markdown,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Code {
    Utf8,
    Utf8Mark,
    Utf16Little,
    Utf16Big,
    Windows1252,
    ShiftJis,
}

/// How numbers are written.
#[derive(Debug, Clone, Copy)]
pub struct Figures {
    /// The decimal mark.
    pub mark: char,
    /// What groups thousands; the other mark where it is that of the decimals.
    pub group: Option<char>,
    pub minus: char,
    pub plus: bool,
    pub is_wide: bool,
}

/// How a text is written.
#[derive(Debug, Clone)]
pub struct Dialect {
    pub between: Between,
    pub figures: Figures,
    pub quotes_all: bool,
    pub line_end: &'static str,
    pub ends_with_line: bool,
    pub code: Code,
    pub is_packed: bool,
    /// Whether the first line says what the separator is.
    pub states_separator: bool,
    /// Lines above the table.
    pub preamble: usize,
}

prop_compose! {
    pub fn figures()(
        mark in select(vec!['.', ',']),
        group in select(vec![None, None, Some('.'), Some(' '), Some('\u{a0}'), Some('\u{2009}'), Some('\'')]),
        minus in select(vec!['-', '-', '\u{2212}']),
        plus in any::<bool>(),
        is_wide in select(vec![false, false, false, false, false, false, false, true]),
    ) -> Figures {
        Figures { mark, group, minus, plus, is_wide }
    }
}

prop_compose! {
    /// Any dialect.
    pub fn dialect()(
        between in select(vec![
            Between::Mark(';'),
            Between::Mark(','),
            Between::Mark('\t'),
            Between::Mark('|'),
            Between::Blanks,
            Between::Markdown,
        ]),
        figures in figures(),
        quotes_all in any::<bool>(),
        line_end in select(vec!["\n", "\r\n", "\r"]),
        ends_with_line in any::<bool>(),
        code in select(vec![
            Code::Utf8,
            Code::Utf8Mark,
            Code::Utf16Little,
            Code::Utf16Big,
            Code::Windows1252,
            Code::ShiftJis,
        ]),
        is_packed in any::<bool>(),
        states_separator in any::<bool>(),
        preamble in 0..4_usize,
    ) -> Dialect {
        Dialect {
            between, figures, quotes_all, line_end, ends_with_line, code, is_packed, states_separator, preamble,
        }
    }
}

impl Figures {
    /// Plain numbers with a decimal point.
    pub const PLAIN: Self = Self { mark: '.', group: None, minus: '-', plus: false, is_wide: false };

    /// A number as it is written.
    pub fn text(self, number: Number) -> String {
        let plain = number.plain();
        let unsigned = plain.trim_start_matches('-');
        let (whole, decimals) = unsigned.split_once('.').unwrap_or((unsigned, ""));
        let group = match self.group {
            Some('.') if self.mark == '.' => Some(','),
            group => group,
        };
        let mut text = String::new();
        if number.digits < 0 {
            text.push(self.minus);
        } else if self.plus && number.digits > 0 {
            text.push('+');
        }
        for (index, digit) in whole.chars().enumerate() {
            let ends_group = index > 0 && (whole.len() - index) % 3 == 0;
            text.extend(group.filter(|_| ends_group));
            text.push(digit);
        }
        if !decimals.is_empty() {
            text.push(self.mark);
            text.push_str(decimals);
        }
        let wide = |c: char| if c.is_ascii_digit() { char::from_u32(c as u32 + 0xfee0).unwrap() } else { c };
        if self.is_wide { text.chars().map(wide).collect() } else { text }
    }

    /// A cell as it is written.
    pub fn cell(self, cell: &Cell) -> String {
        match cell {
            Cell::Empty => String::new(),
            Cell::Text(text) => text.clone(),
            Cell::Number(number) => self.text(*number),
            Cell::United(number, unit) => format!("{} {unit}", self.text(*number)),
        }
    }
}

/// Whether nothing tells a table's decimal mark: some number could be either, and no other number settles it. Rule 4 of the
/// reader has such a table refused.
pub fn is_ambiguous(grid: &Grid, figures: Figures) -> bool {
    let numbers = grid.cells.iter().flatten().filter_map(|cell| match cell {
        Cell::Number(number) | Cell::United(number, _) => Some(figures.text(*number)),
        Cell::Empty | Cell::Text(_) => None,
    });
    let numbers: Vec<_> = numbers.collect();
    numbers.iter().any(|text| could_be_either(text)) && !numbers.iter().any(|text| settles(text))
}

fn marks(text: &str) -> Vec<char> {
    text.chars().filter(|c| matches!(c, '.' | ',')).collect()
}

/// One mark with three digits behind it and one to three before it, of which the first is no zero.
fn could_be_either(text: &str) -> bool {
    let is_other_group = |c: char| matches!(c, ' ' | '\u{a0}' | '\u{2009}' | '\'');
    let digits = text.trim_start_matches(['+', '-', '\u{2212}']);
    let Some((whole, decimals)) = digits.split_once(['.', ',']) else { return false };
    marks(text).len() == 1
        && !text.contains(is_other_group)
        && decimals.chars().count() == 3
        && (1..=3).contains(&whole.chars().count())
        && !whole.starts_with(['0', '\u{ff10}'])
}

fn settles(text: &str) -> bool {
    !marks(text).is_empty() && !could_be_either(text)
}

impl Dialect {
    /// As a program writes a table.
    pub const PLAIN: Self = Self {
        between: Between::Mark(';'),
        figures: Figures::PLAIN,
        quotes_all: false,
        line_end: "\n",
        ends_with_line: true,
        code: Code::Utf8,
        is_packed: false,
        states_separator: false,
        preamble: 0,
    };

    /// The same dialect where it can be written: a blank or a comma in a number would end a cell.
    fn possible(&self) -> Self {
        let mut dialect = self.clone();
        if dialect.between == Between::Blanks && dialect.figures.group == Some(' ') {
            dialect.figures.group = None;
        }
        dialect
    }

    fn line(&self, cells: &[Cell], widths: &[usize]) -> String {
        let cells = cells.iter().map(|cell| self.figures.cell(cell));
        match self.between {
            Between::Mark(mark) => {
                cells.map(|cell| self.quoted(&cell, mark)).collect::<Vec<_>>().join(&mark.to_string())
            }
            Between::Markdown => format!("| {} |", cells.collect::<Vec<_>>().join(" | ")),
            Between::Blanks => {
                let shown = |(cell, width): (String, &usize)| {
                    let cell = if cell.is_empty() { "-".to_owned() } else { cell };
                    format!("{cell}{}", " ".repeat(width + 2 - cell.chars().count()))
                };
                cells.zip(widths).map(shown).collect::<String>().trim_end().to_owned()
            }
        }
    }

    fn quoted(&self, cell: &str, mark: char) -> String {
        if self.quotes_all || cell.contains([mark, '"', '\n', '\r']) {
            format!("\"{}\"", cell.replace('"', "\"\""))
        } else {
            cell.to_owned()
        }
    }

    /// A table as text.
    pub fn text(&self, grid: &Grid) -> String {
        let dialect = self.possible();
        let columns = grid.cells.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            let cell = |row: &Vec<Cell>| row.get(column).map_or(0, |cell| dialect.figures.cell(cell).chars().count());
            grid.cells.iter().map(cell).max().unwrap_or(0).max(1)
        };
        let widths: Vec<_> = (0..columns).map(width).collect();
        let mut lines: Vec<String> = Vec::new();
        if let (Between::Mark(mark), true) = (dialect.between, dialect.states_separator) {
            lines.push(format!("sep={mark}"));
        } else {
            let preamble = ["Messprotokoll", "Auftrag: A-17", ""];
            lines.extend(preamble.iter().take(dialect.preamble).map(|line| (*line).to_owned()));
        }
        for (index, row) in grid.cells.iter().enumerate() {
            lines.push(dialect.line(row, &widths));
            if index == 0 && dialect.between == Between::Markdown {
                lines.push(format!("|{}", "---|".repeat(columns)));
            }
        }
        let mut text = lines.join(dialect.line_end);
        if dialect.ends_with_line {
            text.push_str(dialect.line_end);
        }
        text
    }

    /// A table as a file.
    pub fn file(&self, grid: &Grid) -> Vec<u8> {
        let bytes = self.code.bytes(&self.text(grid));
        if self.is_packed { packed(&bytes) } else { bytes }
    }
}

impl Code {
    /// A text in this code, or in UTF-8 where the code lacks a character.
    pub fn bytes(self, text: &str) -> Vec<u8> {
        let utf16 = |to_bytes: fn(u16) -> [u8; 2]| {
            std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(to_bytes).collect::<Vec<u8>>()
        };
        let coded = |code: &'static encoding_rs::Encoding| {
            let (bytes, _, lacks) = code.encode(text);
            if lacks { text.as_bytes().to_vec() } else { bytes.into_owned() }
        };
        match self {
            Self::Utf8 => text.as_bytes().to_vec(),
            Self::Utf8Mark => format!("\u{feff}{text}").into_bytes(),
            Self::Utf16Little => utf16(u16::to_le_bytes),
            Self::Utf16Big => utf16(u16::to_be_bytes),
            Self::Windows1252 => coded(encoding_rs::WINDOWS_1252),
            // a short text of few Japanese characters is not told from another 8-bit code
            Self::ShiftJis if text.chars().filter(|c| ('ァ'..='ヶ').contains(c)).count() < 4 => {
                text.as_bytes().to_vec()
            }
            Self::ShiftJis => coded(encoding_rs::SHIFT_JIS),
        }
    }
}

/// Bytes as gzip packs them.
pub fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn double(number: Number) -> f64 {
    number.plain().parse().unwrap()
}

/// A workbook; its numbers are numbers, or texts as they are written. The margin is the empty rows and columns before them.
pub fn workbook(grid: &Grid, texts: Option<Figures>, margin: u16) -> Vec<u8> {
    let mut book = rust_xlsxwriter::Workbook::new();
    let sheet = book.add_worksheet();
    for (row, cells) in (u32::from(margin)..).zip(&grid.cells) {
        for (column, cell) in (margin..).zip(cells) {
            match (cell, texts) {
                (Cell::Empty, _) => {}
                (Cell::Number(number), None) => drop(sheet.write_number(row, column, double(*number)).unwrap()),
                (cell, figures) => {
                    let text = figures.unwrap_or(Figures::PLAIN).cell(cell);
                    let _ = sheet.write_string(row, column, text).unwrap();
                }
            }
        }
    }
    book.save_to_buffer().unwrap()
}

/// How Parquet holds numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stored {
    Double,
    Decimal,
    Text,
}

/// A Parquet file of a table with a row per part.
pub fn parquet(grid: &Grid, stored: Stored) -> Vec<u8> {
    use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
    use parquet::file::writer::SerializedFileWriter;

    let columns = grid.cells[0].len();
    let cells = |column: usize| grid.cells[1..].iter().map(move |row| row[column].clone()).collect::<Vec<_>>();
    let fields = (0..columns).map(|column| Arc::new(field(&grid.cells[0][column], &cells(column), stored)));
    let schema = parquet::schema::types::Type::group_type_builder("parts").with_fields(fields.collect());
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema.build().unwrap()), Arc::default()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for column in 0..columns {
        let cells = cells(column);
        let levels: Vec<i16> = cells.iter().map(|cell| i16::from(*cell != Cell::Empty)).collect();
        let there = cells.iter().filter(|cell| **cell != Cell::Empty);
        let mut open = group.next_column().unwrap().unwrap();
        if decimals(&cells).is_none() || stored == Stored::Text {
            let texts: Vec<_> = there.map(|cell| ByteArray::from(Figures::PLAIN.cell(cell).as_str())).collect();
            open.typed::<ByteArrayType>().write_batch(&texts, Some(&levels), None).unwrap();
        } else if stored == Stored::Decimal {
            let numbers: Vec<_> = there.filter_map(number).map(|number| number.digits).collect();
            open.typed::<Int64Type>().write_batch(&numbers, Some(&levels), None).unwrap();
        } else {
            let numbers: Vec<_> = there.filter_map(number).map(double).collect();
            open.typed::<DoubleType>().write_batch(&numbers, Some(&levels), None).unwrap();
        }
        open.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
    bytes
}

fn number(cell: &Cell) -> Option<Number> {
    if let Cell::Number(number) = cell { Some(*number) } else { None }
}

/// The decimals of a column of numbers; `None` if it holds anything else.
fn decimals(cells: &[Cell]) -> Option<usize> {
    let mut found = None;
    for cell in cells.iter().filter(|cell| **cell != Cell::Empty) {
        found = Some(number(cell)?.decimals);
    }
    found
}

fn field(title: &Cell, cells: &[Cell], stored: Stored) -> parquet::schema::types::Type {
    use parquet::basic::{ConvertedType, Repetition, Type as Physical};

    let (physical, converted) = match (decimals(cells), stored) {
        (None, _) | (_, Stored::Text) => (Physical::BYTE_ARRAY, ConvertedType::UTF8),
        (_, Stored::Double) => (Physical::DOUBLE, ConvertedType::NONE),
        (_, Stored::Decimal) => (Physical::INT64, ConvertedType::DECIMAL),
    };
    let title = Figures::PLAIN.cell(title);
    let builder = parquet::schema::types::Type::primitive_type_builder(&title, physical)
        .with_repetition(Repetition::OPTIONAL)
        .with_converted_type(converted);
    let builder = match (converted, decimals(cells)) {
        (ConvertedType::DECIMAL, Some(scale)) => builder.with_precision(18).with_scale(i32::try_from(scale).unwrap()),
        _ => builder,
    };
    builder.build().unwrap()
}

/// A Q-DAS file; `is_binary` writes the values of a part on a line, without keys.
pub fn qdas(parts: &Parts, mark: char, is_binary: bool) -> String {
    let figures = Figures { mark, ..Figures::PLAIN };
    let mut text = format!("K0100 {}\r\nK1001/1 4711\r\nK1002/1 Zahnstange\r\n", parts.errors.len());
    for (index, error) in (1..).zip(&parts.errors) {
        text += &format!("K2001/{index} {index}\r\nK2002/{index} {}\r\n", error.title.text);
        if let Some(Nominal { digits, .. }) = error.nominal {
            text += &format!("K2101/{index} {}\r\n", figures.text(error.number(digits)));
        }
        text += &format!("K2142/{index} {}\r\n", error.unit.spelling);
    }
    for part in 0..parts.count {
        let values: Vec<_> = parts.errors.iter().map(|error| figures.text(error.value(part))).collect();
        if is_binary {
            let values: Vec<_> =
                values.iter().map(|value| format!("{value}\u{14}0\u{14}12.03.2026/10:17:00")).collect();
            text += &format!("{}\r\n", values.join("\u{f}"));
        } else {
            for (index, value) in (1..).zip(values) {
                text += &format!("K0001/{index} {value}\r\nK0002/{index} 0\r\n");
            }
        }
        if let Some(name) = parts.names.get(part) {
            text += &format!("K0014/0 {name}\r\n");
        }
    }
    text
}
