//! Excel workbooks (`.xlsx`).
//!
//! The command line reads the file and calls [`Workbook::open`]; `head` shows how a sheet starts, so that
//! one is chosen, and `records` streams it. Cells come out as they are held: a number as the shortest
//! decimal that is the same double, which is what was typed in, and neither a date nor an error is ever a number.
//! A workbook is unpacked once to count its bytes before anything is parsed, so that a small file that unpacks to a
//! huge one is refused.

mod comments;
mod format;
mod hidden;
mod merged;
mod range;
mod xml;

pub(crate) use comments::Comment;
pub(crate) use format::{Shown, Style};
pub use range::{CellRange, NoCellRange};

use std::collections::{HashMap, HashSet};
use std::io::{self, Cursor, Read as _};
use std::sync::mpsc;

use calamine::{DataRef, ExcelDateTime, Reader as _, SheetType, Xlsx, XlsxError};

use super::cell::{Cell, Content, Record};
use crate::diagnostic::{Code, Diagnostic};
use comments::{comments, once_each, struck_through};
use format::shown_by_style;
use hidden::{SheetXml, sheet_parts};
use merged::MergedCells;

/// Bytes of a sheet at most: a full one, a million rows of twenty columns.
const LARGEST_SHEET: u64 = 768 << 20;
/// Bytes at most of what is kept in memory as a whole: texts, styles, names.
const LARGEST_OTHER: u64 = 96 << 20;

/// Characters of a text at most: the format's own limit.
const LONGEST_TEXT: usize = 32_767;
/// How far right of a row's other cells one may stand; beyond, as many times as there are of them.
const FARTHEST: usize = 1024;
const FARTHEST_TIMES: usize = 4;

type Book = Xlsx<Cursor<Vec<u8>>>;

/// A workbook that was checked and opened.
pub struct Workbook {
    name: String,
    book: Book,
    checked: Checked,
}

/// The rows of a sheet as they stand.
pub(crate) struct SheetRecords {
    /// File and sheet, for messages.
    pub(crate) name: String,
    /// What is hidden in the range and holds values all the same, in words; `None` if nothing is, as far as is known.
    pub(crate) hidden: Option<String>,
    /// What numbers of the range are shown with.
    pub(crate) shown: Vec<Shown>,
    /// The comments on cells of the workbook.
    pub(crate) comments: Vec<Comment>,
    /// Each row that is not empty, the first one first; a row ends with its last cell that is not empty.
    pub(crate) records: Box<dyn Iterator<Item = Result<Record, Diagnostic>> + Send>,
}

impl Workbook {
    /// Opens a workbook from its bytes; `name` is what messages call it.
    ///
    /// # Errors
    /// If it is no workbook, or unpacks to more than any sheet holds.
    pub fn open(name: &str, bytes: Vec<u8>) -> Result<Self, Diagnostic> {
        let checked = check(name, &bytes)?;
        let book = Xlsx::new(Cursor::new(bytes)).map_err(|error| no_workbook(name, &error))?;
        Ok(Self { name: name.to_owned(), book, checked })
    }

    /// The names of its sheets that have cells.
    #[must_use]
    pub fn sheets(&self) -> Vec<String> {
        let sheets = self.book.sheets_metadata().iter().filter(|sheet| sheet.typ != SheetType::ChartSheet);
        sheets.map(|sheet| sheet.name.clone()).collect()
    }

    /// The sheets to look at: all of them, or the one that is named.
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
    fn xml(&self, sheet: &str) -> Option<&SheetXml> {
        let index = self.sheets().iter().position(|name| name == sheet)?;
        self.checked.sheets.get(index)?.as_ref()
    }

    /// What messages call a sheet.
    pub(crate) fn called(&self, sheet: &str) -> String {
        named(&self.name, sheet)
    }

    /// The first rows of a sheet that are not empty, `most` of them.
    ///
    /// # Errors
    /// If the sheet cannot be read.
    pub(crate) fn head(&mut self, sheet: &str, range: CellRange, most: usize) -> Result<Vec<Record>, Diagnostic> {
        let mut head = Vec::new();
        let merged = self.xml(sheet).map(|xml| xml.merged.clone()).unwrap_or_default();
        each_row(&mut self.book, (&self.checked.struck, merged), sheet, range, &mut |record| {
            head.push(record);
            head.len() < most
        })
        .map_err(|problem| Diagnostic::unreadable(&named(&self.name, sheet), &problem))?;
        Ok(head)
    }

    /// All rows of a sheet that are not empty.
    ///
    /// They are read on a thread of its own, a few rows ahead: the workbook's reader cannot be kept beside the workbook.
    pub(crate) fn records(mut self, sheet: &str, range: CellRange) -> SheetRecords {
        const AHEAD: usize = 64;
        let name = named(&self.name, sheet);
        // whoever reads the cells says what is wrong with the sheet
        let styles = self.book.worksheet_cells_reader(sheet).map(|cells| shown_by_style(cells.styles()));
        let styles = styles.unwrap_or_default();
        let xml = self.xml(sheet).cloned().unwrap_or_default();
        let (shown, hidden) = (xml.shown(&styles, range), xml.hidden(range));
        let comments = [std::mem::take(&mut self.checked.comments), xml.beside].concat();
        let (sender, receiver) = mpsc::sync_channel(AHEAD);
        let (sheet, place) = (sheet.to_owned(), name.clone());
        std::thread::spawn(move || {
            // the other end hangs up when it has seen enough
            let known = (&self.checked.struck, xml.merged);
            let read = each_row(&mut self.book, known, &sheet, range, &mut |record| sender.send(Ok(record)).is_ok());
            if let Err(problem) = read {
                let _ = sender.send(Err(Diagnostic::unreadable(&place, &problem)));
            }
        });
        SheetRecords { name, hidden, shown, comments, records: Box::new(receiver.into_iter()) }
    }
}

fn named(file: &str, sheet: &str) -> String {
    format!("{file}, sheet `{sheet}`")
}

/// The names of sheets as a message lists them.
pub(super) fn listed(sheets: &[String]) -> String {
    sheets.iter().map(|sheet| format!("`{sheet}`")).collect::<Vec<_>>().join(", ")
}

/// Calls `take` with each row that is not empty, until it returns false.
fn each_row(
    book: &mut Book,
    (struck, mut merged): (&HashSet<String>, MergedCells),
    sheet: &str,
    range: CellRange,
    take: &mut dyn FnMut(Record) -> bool,
) -> Result<(), String> {
    let mut reader = book.worksheet_cells_reader(sheet).map_err(|error| error.to_string())?;
    merged.begin()?;
    let mut whole = |mut record: Record, merged: &mut MergedCells| {
        let row = u32::try_from(record.line.saturating_sub(1)).unwrap_or(u32::MAX);
        merged.fill(row, range.columns.0, &mut record);
        take(record)
    };
    let (mut record, mut filled) = (Record::default(), 0);
    loop {
        let cell = match reader.next_cell_with_formula() {
            Ok(Some(cell)) => cell,
            Ok(None) => break,
            // an error that has no name in the first versions of the format is no value either
            Err(XlsxError::CellError(_)) => continue,
            Err(error) => return Err(error.to_string()),
        };
        let (row, column) = cell.pos;
        let line = u64::from(row) + 1;
        if line != record.line {
            let before = std::mem::replace(&mut record, Record::new(Vec::new(), line));
            filled = 0;
            if !before.cells.is_empty() && !whole(before, &mut merged) {
                return Ok(());
            }
        }
        if row > range.rows.1 {
            break;
        }
        if is_too_long(&cell.value) || cell.formula.as_ref().is_some_and(|text| text.len() > 4 * LONGEST_TEXT) {
            return Err(format!("row {line}: a text is longer than {LONGEST_TEXT} characters"));
        }
        let content = match cell.formula {
            _ if !range.has_row(row) || !range.has_column(column) => Content::Empty,
            Some(formula) if cell.value == DataRef::Empty => Content::Other(format!("={formula}")),
            _ => content(&cell.value, struck),
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
            if record.cells.len() <= index {
                record.cells.resize(index + 1, Cell::default());
            }
            record.cells[index] = content.into();
            merged.take(row, column, &record.cells[index])?;
        }
    }
    if !record.cells.is_empty() {
        whole(record, &mut merged);
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

/// What stands before and behind a text that is struck through.
const STRUCK: &str = "~~";

fn content(value: &DataRef<'_>, struck: &HashSet<String>) -> Content {
    match value {
        DataRef::Empty => Content::Empty,
        DataRef::Int(number) => Content::Number(crate::quantity::Decimal::of_i128(i128::from(*number), 0)),
        DataRef::Float(number) => Content::of_f64(*number),
        DataRef::String(text) => Content::of_text(text),
        DataRef::SharedString(text) if struck.contains(*text) => Content::of_text(&format!("{STRUCK}{text}{STRUCK}")),
        DataRef::SharedString(text) => Content::of_text(text),
        DataRef::Error(error) => Content::Text(error.to_string()),
        DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => Content::Other(text.clone()),
        DataRef::Bool(value) => Content::Other(value.to_string()),
        DataRef::DateTime(date) => Content::Other(shown_date(date)),
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

fn no_workbook(name: &str, error: &dyn std::fmt::Display) -> Diagnostic {
    Diagnostic::unreadable(name, &format!("it is no Excel workbook ({error})"))
}

/// What is found while a workbook is unpacked.
struct Checked {
    /// What the XML of each sheet says, in their order; none where that cannot be known.
    sheets: Vec<Option<SheetXml>>,
    /// The comments on cells of any sheet.
    comments: Vec<Comment>,
    /// The texts of cells of which a run is struck through.
    struck: HashSet<String>,
}

/// Unpacks every part that will be read, counting bytes and keeping hardly any.
fn check(name: &str, bytes: &[u8]) -> Result<Checked, Diagnostic> {
    let broken = |error: &dyn std::fmt::Display| no_workbook(name, error);
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| broken(&error))?;
    let (mut workbook, mut relations, mut texts) = (Vec::new(), Vec::new(), Vec::new());
    let mut sheets: HashMap<String, SheetXml> = HashMap::new();
    let (mut other, mut found) = (0, Vec::new());
    for index in 0..archive.len() {
        let file = archive.by_index(index).map_err(|error| broken(&error))?;
        let part = file.name().map_err(|error| broken(&error))?.to_ascii_lowercase();
        let is_read = |suffix: &str| part.strip_suffix(suffix).is_some();
        if ![".xml", ".rels", ".vml"].into_iter().any(is_read) {
            continue;
        }
        let is_sheet = part.starts_with("xl/worksheets/");
        let most = if is_sheet { LARGEST_SHEET } else { LARGEST_OTHER - other };
        let (mut sheet, mut noted) = (SheetXml::default(), Vec::new());
        let into: &mut dyn io::Write = match part.as_str() {
            "xl/workbook.xml" => &mut workbook,
            "xl/_rels/workbook.xml.rels" => &mut relations,
            "xl/sharedstrings.xml" => &mut texts,
            _ if is_sheet => &mut sheet,
            // what pivot tables hold are cells
            _ if part.starts_with("xl/") && !part.starts_with("xl/pivot") => &mut noted,
            _ => &mut io::sink(),
        };
        let size = io::copy(&mut file.take(most + 1), into).map_err(|error| broken(&error))?;
        if size > most {
            return Err(Diagnostic::unreadable(
                name,
                &format!("its part {part} unpacks to more than {} MiB", most >> 20),
            ));
        }
        if is_sheet {
            sheets.insert(part, sheet);
        } else {
            other += size;
            found.extend(comments(&noted));
        }
    }
    once_each(&mut found);
    let sheets = sheet_parts(&workbook, &relations).iter().map(|part| sheets.get(part).cloned()).collect();
    Ok(Checked { sheets, comments: found, struck: struck_through(&texts) })
}

#[cfg(test)]
mod tests;
