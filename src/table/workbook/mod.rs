//! Excel workbooks (`.xlsx`).
//!
//! The command line reads the file and calls [`Workbook::open`]; `head` gives the first rows of a sheet, so that one can be chosen,
//! and `records` streams it. A number comes out as the shortest decimal of its double, which is the number typed in; a date or an
//! error is never a number.

mod check;
mod comments;
mod format;
mod merged;
mod parts;
mod range;
mod sheet;
mod xml;

pub(crate) use comments::Comment;
pub use range::{CellRange, NoCellRange};

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::sync::{Arc, mpsc};
use std::time::SystemTime;

use calamine::{DataRef, ExcelDateTime, Reader as _, SheetType, Xlsx, XlsxError};

use super::cell::{Cell, Content, Record, head_rows};
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::listed;
use check::{Checked, check, no_workbook};
use comments::Run;
use format::{Style, raised, struck};
use merged::MergedCells;
use parts::parts_of_archive;
use sheet::SheetXml;

/// Characters of a text at most: the format's own limit.
const LONGEST_TEXT: usize = 32_767;
/// Parts of the file at most: the sheets, and what they refer to.
const MOST_PARTS: u64 = 20_000;
/// The last place of a cell in a row, unless the row has many cells.
const FARTHEST: usize = 1024;
/// The last place of a cell in a row with many cells: so many times the number of its filled cells.
const FARTHEST_TIMES: usize = 4;

/// Bytes that are read from any place, in a file or in memory.
trait Stored: Read + Seek + Send {}

impl<S: Read + Seek + Send> Stored for S {}

type Book = Xlsx<Box<dyn Stored>>;

/// The length of a file, and when it was changed.
type FileState = (u64, Option<SystemTime>);

/// What was found of the workbook in a file.
#[derive(Clone)]
#[doc(hidden)]
pub struct KnownWorkbook {
    state: FileState,
    checked: Arc<Checked>,
}

/// A workbook that is checked and open.
pub struct Workbook {
    name: String,
    book: Book,
    /// That of its file; `None` if it is in memory.
    state: Option<FileState>,
    checked: Arc<Checked>,
    /// The width of the widest row that was looked at.
    widest: usize,
}

/// The rows of a sheet as they stand.
pub(crate) struct SheetRecords {
    /// File and sheet, for messages.
    pub(crate) name: String,
    /// Hidden rows, columns and sheets that hold values, in words; `None` if there are none.
    pub(crate) hidden: Option<String>,
    /// Comments, text boxes, prompts and the like.
    pub(crate) comments: Vec<Comment>,
    /// Each row that is not empty, in order; a row ends with its last cell that is not empty.
    pub(crate) records: Box<dyn Iterator<Item = Result<Record, Diagnostic>> + Send>,
}

impl Workbook {
    /// Opens a workbook, which stays where it is stored; messages call it `name`.
    ///
    /// # Errors
    /// If it is not a workbook, or unpacks to more than any sheet holds.
    pub fn open(name: &str, source: impl Read + Seek + Send + 'static) -> Result<Self, Diagnostic> {
        Self::open_checked(name, source, None)
    }

    /// Opens the workbook in a file. What was found of the file before is not looked for again, unless the file was changed.
    pub(crate) fn open_file(name: &str, file: File, known: Option<KnownWorkbook>) -> Result<Self, Diagnostic> {
        let metadata = file.metadata().map_err(|error| Diagnostic::unreadable(name, &error))?;
        let state = (metadata.len(), metadata.modified().ok());
        let known = known.filter(|known| known.state == state && state.1.is_some()).map(|known| known.checked);
        Ok(Self { state: Some(state), ..Self::open_checked(name, BufReader::new(file), known)? })
    }

    fn open_checked(
        name: &str,
        source: impl Read + Seek + Send + 'static,
        known: Option<Arc<Checked>>,
    ) -> Result<Self, Diagnostic> {
        let mut source: Box<dyn Stored> = Box::new(source);
        let count = parts_of_archive(&mut source).map_err(|error| Diagnostic::unreadable(name, &error))?;
        if let Some(count) = count.filter(|count| *count > MOST_PARTS) {
            let problem = format!("it has {count} parts, and at most {MOST_PARTS} are read");
            return Err(
                Diagnostic::unreadable(name, &problem).help("save the table as a workbook of its own, or as .csv")
            );
        }
        let checked = known.map_or_else(|| check(name, &mut source).map(Arc::new), Ok)?;
        let book = Xlsx::new(source).map_err(|error| no_workbook(name, &error))?;
        Ok(Self { name: name.to_owned(), book, state: None, checked, widest: 0 })
    }

    /// What was found of its file.
    pub(crate) fn known(&self) -> Option<KnownWorkbook> {
        Some(KnownWorkbook { state: self.state?, checked: Arc::clone(&self.checked) })
    }

    /// The names of its sheets, without charts.
    #[must_use]
    pub fn sheets(&self) -> Vec<String> {
        let sheets = self.book.sheets_metadata().iter().filter(|sheet| sheet.typ == SheetType::WorkSheet);
        sheets.map(|sheet| sheet.name.clone()).collect()
    }

    /// The names of the other sheets, charts included, each with a digest of what it stores.
    pub(crate) fn others(&self, sheet: &str) -> Vec<(String, u32)> {
        let names = self.book.sheets_metadata().iter().map(|sheet| &sheet.name).filter(|name| *name != sheet);
        names.map(|name| (name.clone(), self.checked.digests.get(name).copied().unwrap_or_default())).collect()
    }

    /// The sheets to read: all of them, or the named one.
    ///
    /// # Errors
    /// If there is none of that name.
    pub(crate) fn candidates(&self, wanted: Option<&str>) -> Result<Vec<String>, Diagnostic> {
        let sheets = self.sheets();
        match wanted {
            None => Ok(sheets),
            Some(wanted) if sheets.iter().any(|name| name == wanted) => Ok(vec![wanted.to_owned()]),
            Some(wanted) => {
                let message = format!("{} has no sheet `{wanted}`", self.name);
                Err(Diagnostic::error(Code::BadTable, message).help(format!("its sheets are {}", listed(&sheets))))
            }
        }
    }

    /// What the XML of a sheet says.
    fn xml(&self, sheet: &str) -> Arc<SheetXml> {
        self.checked.sheets.get(sheet).cloned().unwrap_or_else(|| Arc::new(SheetXml::missing()))
    }

    /// What messages call a sheet.
    pub(crate) fn called(&self, sheet: &str) -> String {
        named(&self.name, sheet)
    }

    /// The first rows of a sheet that are not empty, `most` of them at most, and fewer where they are wide.
    ///
    /// # Errors
    /// If the sheet cannot be read.
    pub(crate) fn head(&mut self, sheet: &str, range: CellRange, most: usize) -> Result<Vec<Record>, Diagnostic> {
        let (mut head, mut widest) = (Vec::new(), self.widest);
        let xml = self.xml(sheet);
        each_row(&mut self.book, &xml, sheet, range, &mut |record| {
            widest = widest.max(record.cells.len());
            head.push(record);
            head.len() < most.min(head_rows(widest))
        })
        .map_err(|problem| Diagnostic::unreadable(&named(&self.name, sheet), &problem))?;
        self.widest = widest;
        Ok(head)
    }

    /// All rows of a sheet that are not empty.
    ///
    /// A thread of its own reads them, some rows ahead, fewer if they are wide: the reader of cells borrows the workbook.
    pub(crate) fn records(mut self, sheet: &str, range: CellRange) -> SheetRecords {
        /// Rows that are sent together.
        const TOGETHER: usize = 64;
        let name = named(&self.name, sheet);
        let xml = self.xml(sheet);
        let hidden = xml.hidden(range);
        let comments = [&self.checked.comments[..], &xml.beside].concat();
        let (sender, receiver) = mpsc::sync_channel(1);
        let together = TOGETHER.min(head_rows(self.widest));
        let (sheet, place) = (sheet.to_owned(), name.clone());
        std::thread::spawn(move || {
            let mut rows = Vec::with_capacity(together);
            // sending fails once nobody needs more rows
            let read = each_row(&mut self.book, &xml, &sheet, range, &mut |record| {
                rows.push(Ok(record));
                rows.len() < together || sender.send(std::mem::take(&mut rows)).is_ok()
            });
            rows.extend(read.err().map(|problem| Err(Diagnostic::unreadable(&place, &problem))));
            let _ = sender.send(rows);
        });
        SheetRecords { name, hidden, comments, records: Box::new(receiver.into_iter().flatten()) }
    }
}

fn named(file: &str, sheet: &str) -> String {
    format!("{file}, sheet `{sheet}`")
}

/// Calls `take` with each row that is not empty, until it returns false.
fn each_row(
    book: &mut Book,
    xml: &SheetXml,
    sheet: &str,
    range: CellRange,
    take: &mut dyn FnMut(Record) -> bool,
) -> Result<(), String> {
    if let Some(problem) = &xml.problem {
        return Err(problem.clone());
    }
    let mut merged = xml.merged.clone();
    let mut reader = book.worksheet_cells_reader(sheet).map_err(|error| error.to_string())?;
    let styles: Vec<Option<Style>> = reader.styles().iter().map(Style::of).collect();
    merged.begin()?;
    let mut whole = |line: u64, mut cells: Vec<Cell>, merged: &mut MergedCells| {
        let row = u32::try_from(line.saturating_sub(1)).unwrap_or(u32::MAX);
        merged.fill(row, range.columns.0, &mut cells);
        take(Record::new(cells, line))
    };
    let (mut of_line, mut cells, mut filled) = (0, Vec::<Cell>::new(), 0);
    loop {
        let (cell, style) = match reader.next_cell_with_style_id() {
            Ok(Some(cell)) => cell,
            Ok(None) => break,
            // an error value of a newer Excel is no value either
            Err(XlsxError::CellError(_)) => continue,
            Err(error) => return Err(error.to_string()),
        };
        let (row, column) = cell.get_position();
        let line = u64::from(row) + 1;
        if line != of_line {
            let before = std::mem::take(&mut cells);
            if !before.is_empty() && !whole(of_line, before, &mut merged) {
                return Ok(());
            }
            (of_line, filled) = (line, 0);
        }
        if row > range.rows.1 {
            break;
        }
        if is_too_long(cell.get_value()) {
            return Err(format!("row {line}: a text is longer than {LONGEST_TEXT} characters"));
        }
        let content = match () {
            () if !range.has_row(row) || !range.has_column(column) => Content::Empty,
            () if xml.without_result.contains(&(row, column)) => Content::Other(WITHOUT_RESULT.into()),
            () => content(cell.get_value()),
        };
        let run = xml.odd_runs.get(&(row, column)).copied();
        let content = match run {
            Some(Run::Struck) => struck(content),
            Some(Run::Raised) => raised(content),
            None => content,
        };
        let content = match styles.get(style) {
            Some(Some(style)) if run != Some(Run::Struck) => style.seen(content),
            None if style > 0 => return Err(format!("row {line}: a cell has a style that the workbook lacks")),
            _ => content,
        };
        if content != Content::Empty {
            let index = (column - range.columns.0) as usize;
            filled += 1;
            if index > FARTHEST.max(FARTHEST_TIMES * filled) {
                let column = column + 1;
                return Err(format!(
                    "row {line}: a cell stands in column {column}, far from all others: choose a --range"
                ));
            }
            if cells.len() <= index {
                cells.resize(index + 1, Cell::default());
            }
            cells[index] = content.into();
            merged.take(row, column, &cells[index])?;
        }
    }
    if !cells.is_empty() {
        whole(of_line, cells, &mut merged);
    }
    Ok(())
}

/// Whether a text is longer than the format allows.
fn is_too_long(value: &DataRef<'_>) -> bool {
    let text = match value {
        DataRef::String(text) => text.as_str(),
        DataRef::SharedString(text) => text,
        _ => return false,
    };
    text.len() > LONGEST_TEXT && text.chars().count() > LONGEST_TEXT
}

/// The text in place of a formula's result that is missing.
const WITHOUT_RESULT: &str = "=…";

fn content(value: &DataRef<'_>) -> Content {
    match value {
        DataRef::Empty => Content::Empty,
        DataRef::Int(number) => Content::Number(crate::quantity::Decimal::of_i128(i128::from(*number), 0)),
        DataRef::Float(number) => Content::of_f64(*number),
        DataRef::String(text) => Content::of_text(text),
        DataRef::SharedString(text) => Content::of_text(text),
        DataRef::Error(error) => Content::Text(error.to_string().as_str().into()),
        DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => Content::Other(text.as_str().into()),
        DataRef::Bool(value) => Content::Other(value.to_string().into()),
        DataRef::DateTime(date) => Content::Other(shown_date(date).into()),
    }
}

/// A date, a time or a duration as a message shows it.
fn shown_date(date: &ExcelDateTime) -> String {
    if date.is_duration() {
        return format!("{} h", date.as_f64() * 24.0);
    }
    let (year, month, day, hour, minute, second, _) = date.to_ymd_hms_milli();
    let days = date.as_f64();
    let time = format!("{hour:02}:{minute:02}:{second:02}");
    match () {
        // a time of no day
        () if days < 1.0 => time,
        () if days.fract() == 0.0 => format!("{year}-{month:02}-{day:02}"),
        () => format!("{year}-{month:02}-{day:02} {time}"),
    }
}

#[cfg(test)]
mod tests;
