//! What kind of file a table is in, told by its bytes and not by its name. Called by the command line with every file.

use std::fs::File;
use std::io::{self, Cursor, Read, Seek as _};
use std::sync::Arc;

use super::Table;
use super::cell::{Cell, Content, Record};
use super::encoding::{decode, peek, unpacked};
use super::names::{Field, Holds, is_value_heading};
use super::parquet::{Batch, ColumnKind, ColumnValues, Number, ParquetTable};
use super::pieces::{Pieces, Place};
use super::qdas::{Characteristic, Qdas, QdasTable};
use super::reading::NotUsed;
use super::rows::Rows;
use super::text::{Text, as_io, setup, unreadable};
use super::understand::{Understood, in_words, understand_records};
use super::want::{Given, Want};
use super::workbook::{Shown, Workbook};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::quantity::{Angle, Decimal, Length, Unit};

/// Where the bytes of a table are.
pub enum Source {
    /// A file, of which no more is read than is needed.
    File(File),
    /// Bytes that come once.
    Stream(Box<dyn Read + Send>),
}

/// A file that was recognised, and not yet read.
pub enum Container {
    /// Text.
    #[doc(hidden)]
    Text(TextContainer),
    /// An Excel workbook.
    Workbook(Box<Workbook>),
    /// A file of statistics software.
    Qdas(Box<Qdas>),
    /// A Parquet file.
    #[doc(hidden)]
    Parquet(ParquetContainer),
}

/// A Parquet file before its columns are found.
pub struct ParquetContainer(ParquetTable);

/// A text before it is understood.
pub struct TextContainer(Text);

/// Files that are read as a whole are refused beyond this size.
const LARGEST_FILE: usize = 64 << 20;
/// Rows of a sheet from which its columns are understood.
const HEAD: usize = 400;
/// What a Parquet file starts with.
const PARQUET: &[u8; 4] = b"PAR1";
/// Rows that are handed on together.
const TOGETHER: usize = 1024;

impl Source {
    /// Bytes that are there.
    #[must_use]
    pub fn bytes(bytes: Vec<u8>) -> Self {
        Self::Stream(Box::new(Cursor::new(bytes)))
    }
}

impl Container {
    /// Recognises a file by its first bytes; `name` is what messages call it.
    ///
    /// # Errors
    /// If it cannot be read, or is a file that holds no table.
    pub fn open(name: &str, source: Source, want: &Want) -> Result<Self, Diagnostics> {
        let failed = |error: &io::Error| unreadable(name, error);
        let bytes: Box<dyn Read + Send> = match source {
            Source::File(mut file) => {
                let mut mark = [0; 4];
                // a pipe has no place to go back to, and no Parquet file either
                if file.stream_position().is_ok() {
                    let count = file.read(&mut mark).map_err(|error| failed(&error))?;
                    file.rewind().map_err(|error| failed(&error))?;
                    if mark[..count] == *PARQUET {
                        return Ok(Self::Parquet(ParquetContainer(ParquetTable::of_file(name, file)?)));
                    }
                }
                Box::new(file)
            }
            Source::Stream(stream) => stream,
        };
        let peeked = peek(unpacked(bytes).map_err(|error| failed(&error))?, 512).map_err(|error| failed(&error))?;
        match Kind::of(&peeked.start) {
            Kind::Workbook => Ok(Self::Workbook(Box::new(Workbook::open(name, whole(name, peeked.bytes)?)?))),
            Kind::Parquet => {
                let table = ParquetTable::of_bytes(name, whole(name, peeked.bytes)?)?;
                Ok(Self::Parquet(ParquetContainer(table)))
            }
            Kind::Foreign(what, help) => {
                Err(Diagnostic::error(Code::BadTable, format!("{name} is {what}")).help(help).into())
            }
            Kind::Text => {
                let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase()).unwrap_or_default();
                if matches!(ending.as_str(), "xlsx" | "xlsm" | "parquet") {
                    let message = format!("{name} is not what its name says: it is no .{ending} file");
                    return Err(Diagnostic::error(Code::BadTable, message)
                        .help("give it the ending of what it is")
                        .into());
                }
                if want.sheet.is_some() || want.range != super::workbook::CellRange::default() {
                    let message = format!("--sheet and --range are for Excel workbooks, and {name} is none");
                    return Err(Diagnostic::error(Code::Usage, message)
                        .help("save it as .xlsx, or leave them out")
                        .into());
                }
                let mut text = Text::open(name, peeked.bytes, want.encoding)?;
                if text.is_qdas()? {
                    let text = text.whole(LARGEST_FILE)?;
                    return Ok(Self::Qdas(Box::new(super::qdas::read(&[(name, &text)])?)));
                }
                Ok(Self::Text(TextContainer(text)))
            }
        }
    }

    /// A Q-DAS file of definitions (`.dfd`) with that of its values (`.dfx`).
    ///
    /// # Errors
    /// If one of them cannot be read, or makes no sense.
    pub fn qdas_pair(definitions: (&str, Source), values: (&str, Source)) -> Result<Self, Diagnostics> {
        let mut texts = Vec::new();
        for (name, source) in [definitions, values] {
            let bytes: Box<dyn Read + Send> = match source {
                Source::File(file) => Box::new(file),
                Source::Stream(stream) => stream,
            };
            texts.push((name, decode(&whole(name, bytes)?).into_owned()));
        }
        let files: Vec<_> = texts.iter().map(|(name, text)| (*name, text.as_str())).collect();
        Ok(Self::Qdas(Box::new(super::qdas::read(&files)?)))
    }

    /// What the file says of its characteristics, if it is of a format that does.
    #[must_use]
    pub fn qdas(&self) -> Option<&Qdas> {
        match self {
            Self::Qdas(qdas) => Some(qdas),
            _ => None,
        }
    }

    /// Finds the columns.
    ///
    /// # Errors
    /// If there is no table, or it can be read in more than one way. Columns that are not understood are no error here:
    /// they are in [`Table::strangers`].
    pub fn table(self, name: &str, want: &Want) -> Result<Table, Diagnostics> {
        match self {
            Self::Text(text) => text.0.table(want),
            Self::Workbook(book) => workbook_table(*book, want),
            Self::Qdas(qdas) => qdas_table(name, *qdas, want),
            Self::Parquet(table) => parquet_table(name, &table.0, want),
        }
    }
}

enum Kind {
    Text,
    Workbook,
    Parquet,
    /// What it is, and what to do.
    Foreign(&'static str, &'static str),
}

impl Kind {
    fn of(start: &[u8]) -> Self {
        let save = "save the table as .xlsx or .csv";
        let lower = String::from_utf8_lossy(start).trim_start().to_lowercase();
        match start {
            [b'P', b'K', 3, 4, ..] => Self::Workbook,
            [b'P', b'A', b'R', b'1', ..] => Self::Parquet,
            [0xd0, 0xcf, 0x11, 0xe0, ..] => Self::Foreign("a workbook of the old Excel format (.xls)", save),
            [b'%', b'P', b'D', b'F', ..] => Self::Foreign("a PDF", "copy the table out of it, or export it as .csv"),
            _ if lower.starts_with("<html") || lower.starts_with("<!doctype") || lower.starts_with("<table") => {
                Self::Foreign("a web page, whatever its name says", save)
            }
            _ if lower.starts_with("<?xml") => Self::Foreign("XML", save),
            _ => Self::Text,
        }
    }
}

/// All bytes of a file that is read as a whole.
fn whole(name: &str, bytes: Box<dyn Read + Send>) -> Result<Vec<u8>, Diagnostic> {
    let mut all = Vec::new();
    bytes.take(LARGEST_FILE as u64 + 1).read_to_end(&mut all).map_err(|error| unreadable(name, &error))?;
    if all.len() > LARGEST_FILE {
        let problem = unreadable(name, &format!("it is larger than {} MiB", LARGEST_FILE >> 20));
        return Err(problem.help("export the table as CSV, which is read at any size"));
    }
    Ok(all)
}

fn workbook_table(mut book: Workbook, want: &Want) -> Result<Table, Diagnostics> {
    let sheets = book.candidates(want.sheet.as_deref())?;
    let known = |record: &Record| record.cells.iter().filter(|cell| is_value_heading(&cell.text(), &want.own)).count();
    let mut chosen = None;
    let mut others: Vec<&String> = Vec::new();
    for sheet in &sheets {
        let head = book.head(sheet, want.range, HEAD)?;
        if head.iter().any(|record| known(record) > 0) || (sheets.len() == 1 && !head.is_empty()) {
            if chosen.is_none() {
                chosen = Some((sheet.clone(), head));
            } else if head.iter().any(|record| record.numbers() > 0) {
                others.push(sheet);
            }
        }
    }
    if let (Some((first, _)), false) = (&chosen, others.is_empty()) {
        let each: Vec<_> = std::iter::once(first).chain(others).map(|sheet| format!("`{sheet}`")).collect();
        let message = format!("{} sheets have columns that are known: {}", each.len(), each.join(", "));
        return Err(Diagnostic::error(Code::AmbiguousBlock, message)
            .help("say which is meant with --sheet; each is read by itself")
            .into());
    }
    let Some((sheet, head)) = chosen else {
        let listed = sheets.iter().map(|sheet| format!("`{sheet}`")).collect::<Vec<_>>().join(", ");
        return Err(Diagnostic::error(Code::BadTable, "no sheet of the workbook has a column that is known")
            .help(format!("its sheets are {listed}; say which with --sheet, and where with --range"))
            .into());
    };
    let records = book.records(&sheet, want.range);
    let name = records.name.clone();
    let source = Arc::new(crate::diagnostic::Source::new(name.clone(), ""));
    let mut rest = records.records;
    let mut all: Vec<Record> = Vec::new();
    for _ in 0..head.len() {
        all.extend(rest.next().transpose()?);
    }
    let mut understood = understand_records(&source, &all, want)?;
    let in_rows = understood.shape.orientation == super::want::Orientation::Rows && !understood.shape.header.is_empty();
    if !in_rows {
        for record in rest.by_ref() {
            all.push(record?);
        }
        understood = understand_records(&source, &all, want)?;
    }
    if let Some(refused) = records.shown.iter().find_map(|shown| shown_otherwise(&name, shown, &understood, in_rows)) {
        return Err(refused.into());
    }
    let mut table = Table::new(&name, "workbook", &understood, want);
    table.place = Place::SheetRow;
    if let Some(hidden) = records.hidden.filter(|hidden| hidden.rows + hidden.columns > 0) {
        table.reading.notes.push(format!(
            "{name}: {} hidden rows and {} hidden columns are read like the others",
            hidden.rows, hidden.columns
        ));
    }
    if !in_rows {
        table.pieces = Pieces::blocks(vec![super::gathered::gathered(&understood)]);
        return Ok(table);
    }
    table.header_raw = super::block::line_of(table.titles.iter().map(String::as_str));
    // the table may end before the sheet does, if all of it was looked at
    let is_all = all.len() < HEAD;
    let range = understood.shape.data.start..if is_all { understood.shape.data.end } else { all.len() };
    let head: Vec<Record> = all.drain(range).collect();
    let records = head.into_iter().map(Ok).chain(rest.filter(move |_| !is_all));
    table.pieces = Pieces::streamed_later(setup(understood, b',', false, want), move |rows: &Rows| {
        Box::new(together(rows.clone(), records.map(|record| record.map_err(|problem| as_io(&problem)))))
    });
    Ok(table)
}

/// The refusal of numbers that are shown with another unit than the one they are read in, by their number format.
fn shown_otherwise(name: &str, shown: &Shown, understood: &Understood, in_rows: bool) -> Option<Diagnostic> {
    let unit = Unit::from_symbol(&shown.text);
    if unit.is_none() && !shown.text.contains(['%', '<', '>']) {
        return None;
    }
    let columns = understood.columns.iter().filter(|column| !in_rows || column.place == shown.column);
    let other = columns.into_iter().find(|column| unit != Some(column.unit))?;
    let (row, text, read_in) = (shown.row, &shown.text, other.unit.symbol());
    let message = format!(
        "{name}, row {row}: numbers of `{}` are shown with `{text}` by their format, and would be read in {read_in}",
        other.title
    );
    Some(Diagnostic::error(Code::BadTable, message).help("let the number format and the heading say the same unit"))
}

fn qdas_table(name: &str, qdas: Qdas, want: &Want) -> Result<Table, Diagnostics> {
    let left_out: Vec<_> = qdas.left_out.clone();
    let want = &with_nominals(&qdas, want)?;
    let table: QdasTable = qdas.table(&want.own);
    let mark = table.mark().map_err(|text| {
        let message = format!("{name} has values with decimal points and with commas: one of them is `{text}`");
        Diagnostic::error(Code::BadTable, message).help("write every value with the same mark")
    })?;
    let source = Arc::new(crate::diagnostic::Source::new(name, ""));
    let mut head = vec![table.header(&want.own)];
    head.extend((0..table.len().min(HEAD)).filter_map(|row| table.record(row)));
    let mut understood = understand_records(&source, &head, want).map_err(|Diagnostics(mut problems)| {
        let codes: Vec<_> =
            left_out.iter().map(|left_out| format!("{} ({} times)", left_out.code, left_out.count)).collect();
        if let (Some(problem), false) = (problems.first_mut(), codes.is_empty()) {
            problem.message =
                format!("{}; values with these attributes do not count: {}", problem.message, codes.join(", "));
        }
        Diagnostics(problems)
    })?;
    for column in &mut understood.columns {
        let facts = table.facts(column.place);
        let tolerance = facts.iter().filter_map(|facts| facts.widest(column.unit)).reduce(f64::max);
        *column = column.clone().with_tolerance(tolerance);
    }
    understood.mark = mark;
    let mut found = Table::new(name, "Q-DAS", &understood, want);
    found.reading.header_line = None;
    for left_out in left_out {
        let meaning = left_out.meaning().map_or_else(String::new, |meaning| format!(" ({meaning})"));
        let note = format!(
            "{name}: attribute {}{meaning}: {}, the first in line {}",
            left_out.code,
            if left_out.count == 1 {
                "1 value does not count".to_owned()
            } else {
                format!("{} values do not count", left_out.count)
            },
            left_out.first_line
        );
        found.reading.notes.push(note);
        found
            .reading
            .not_used
            .push(NotUsed { title: format!("values with attribute {}", left_out.code), why: "they do not count" });
    }
    found.header_raw = super::block::line_of(found.titles.iter().map(String::as_str));
    let count = table.len();
    let records = (0..count).filter_map(move |row| table.record(row)).map(Ok);
    found.pieces = Pieces::streamed_later(setup(understood, b',', false, want), move |rows: &Rows| {
        Box::new(together(rows.clone(), records))
    });
    Ok(found)
}

/// What is wanted, with the nominal values of a Q-DAS file (K2101): a characteristic that has one holds measured values,
/// whatever its name says.
fn with_nominals(qdas: &Qdas, want: &Want) -> Result<Want, Diagnostics> {
    let mut want = want.clone();
    for characteristic in &qdas.characteristics {
        let Some(kind) = Qdas::error_of(characteristic, &want.own) else { continue };
        let is_deviation = want.given(kind).is_some_and(|given| given.holds == Some(Holds::Deviation));
        let nominal = nominal_of(characteristic, kind, &want).filter(|nominal| !nominal.is_zero() && !is_deviation);
        let Some(nominal) = nominal else { continue };
        let known = want.given.iter().position(|given| given.kind == kind);
        let at = known.unwrap_or_else(|| {
            want.given.push(Given { kind, unit: None, holds: None, nominal: None, length: None });
            want.given.len() - 1
        });
        let given = &mut want.given[at];
        match &given.nominal {
            Some(Ok(stated)) if *stated != nominal => {
                let message = format!(
                    "the nominal value of {kind} is {} in the file (K2101 of `{}`) and {} in the spec or another characteristic",
                    in_words(nominal),
                    characteristic.name,
                    in_words(*stated)
                );
                return Err(Diagnostic::error(Code::BadTable, message).help("correct the one that is wrong").into());
            }
            _ => given.nominal = Some(Ok(nominal)),
        }
        given.holds = given.holds.or(Some(Holds::Measured));
    }
    Ok(want)
}

/// The nominal value of a characteristic in its unit, or that of the spec.
fn nominal_of(characteristic: &Characteristic, kind: DeviationKind, want: &Want) -> Option<DeviationValue> {
    let number = Decimal::parse(characteristic.nominal.as_deref()?).ok()?;
    let in_spec = want.given(kind).and_then(|given| given.unit);
    let default = || if Field::Error(kind).is_angle() { "°" } else { "mm" };
    let unit = characteristic.unit.as_deref().map_or(in_spec, Unit::from_symbol);
    match unit.or_else(|| characteristic.unit.is_none().then(|| Unit::from_symbol(default())).flatten())? {
        Unit::Length(unit) => Length::of_number(number, unit).ok().map(DeviationValue::Length),
        Unit::Angle(unit) => Angle::of_number(number, unit).ok().map(DeviationValue::Angle),
    }
}

fn parquet_table(name: &str, file: &ParquetTable, want: &Want) -> Result<Table, Diagnostics> {
    let is_read = |kind: ColumnKind| !matches!(kind, ColumnKind::Nested | ColumnKind::Unread);
    let wanted: Vec<usize> = (0..file.columns().len()).filter(|index| is_read(file.columns()[*index].kind)).collect();
    let titles = wanted.iter().map(|index| Content::of_text(&file.columns()[*index].name).into());
    let mut head = vec![Record::new(titles.collect(), 0)];
    if let Some(first) = file.read(&wanted)?.next() {
        head.extend(records_of(first?).into_iter().take(HEAD));
    }
    let source = Arc::new(crate::diagnostic::Source::new(name, ""));
    let understood = understand_records(&source, &head, want)?;
    let mut table = Table::new(name, "Parquet", &understood, want);
    table.reading.header_line = None;
    table.place = Place::Record;
    table.header_raw = super::block::line_of(table.titles.iter().map(String::as_str));
    for column in file.columns().iter().filter(|column| !is_read(column.kind)) {
        table.reading.not_used.push(NotUsed { title: column.name.clone(), why: "its type is no number" });
    }
    let batches = file.read(&wanted)?;
    let records = batches.flat_map(|batch| match batch {
        Ok(batch) => records_of(batch).into_iter().map(Ok).collect::<Vec<_>>(),
        Err(problem) => vec![Err(as_io(&problem))],
    });
    table.pieces = Pieces::streamed_later(setup(understood, b',', false, want), move |rows: &Rows| {
        Box::new(together(rows.clone(), records))
    });
    Ok(table)
}

/// The rows of a batch of columns.
fn records_of(batch: Batch) -> Vec<Record> {
    let Batch { first_row, rows, columns } = batch;
    let start = |row: usize| Record::new(Vec::with_capacity(columns.len()), first_row + row as u64);
    let mut records: Vec<Record> = (0..rows).map(start).collect();
    for column in columns {
        match column {
            ColumnValues::Numbers(numbers) => push(
                &mut records,
                numbers.into_iter().map(|number| match number {
                    Number::Missing => Content::Empty,
                    Number::Finite(number) => Content::Number(number),
                    Number::NotFinite => Content::Other("no finite number".to_owned()),
                }),
            ),
            ColumnValues::Texts(texts) => {
                push(&mut records, texts.into_iter().map(|text| Content::of_text(&text.unwrap_or_default())));
            }
            ColumnValues::Others(texts) => {
                push(&mut records, texts.into_iter().map(|text| text.map_or(Content::Empty, Content::Other)));
            }
        }
    }
    records
}

fn push(records: &mut [Record], cells: impl Iterator<Item = Content>) {
    for (record, content) in records.iter_mut().zip(cells) {
        record.cells.push(Cell::from(content));
    }
}

/// Records as blocks, some rows at a time.
fn together(
    rows: Rows,
    mut records: impl Iterator<Item = io::Result<Record>> + Send,
) -> impl Iterator<Item = io::Result<super::Block>> + Send {
    let mut failed = None;
    std::iter::from_fn(move || {
        if let Some(error) = failed.take() {
            return Some(Err(error));
        }
        let mut block = super::Block::default();
        for record in records.by_ref().take(TOGETHER) {
            match record {
                Ok(record) => rows.record(&record, None, &mut block),
                Err(error) => {
                    failed = Some(error);
                    break;
                }
            }
        }
        match (block.record_count, failed.take()) {
            (0, None) => None,
            (0, Some(error)) => Some(Err(error)),
            (_, error) => {
                failed = error;
                Some(Ok(block))
            }
        }
    })
}
