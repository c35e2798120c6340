//! Excel workbooks (`.xlsx`).
//!
//! The command line reads the file and calls [`Workbook::open`]; `head` gives the first rows of a sheet, so that one can be chosen,
//! and `records` streams it. A number comes out as the shortest decimal of its double, which is the number typed in; a date or an
//! error is never a number. A workbook is unpacked once to count its bytes before anything is parsed, so that a small file that
//! unpacks to a huge one is refused.

mod comments;
mod format;
mod merged;
mod parts;
mod range;
mod sheet;
mod xml;

pub(crate) use comments::Comment;
pub use range::{CellRange, NoCellRange};

use std::collections::{HashMap, HashSet};
use std::io::{self, Read, Seek};
use std::sync::mpsc;

use calamine::{DataRef, ExcelDateTime, Reader as _, SheetType, Xlsx, XlsxError};

use super::cell::{Cell, Content, Record, head_rows};
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::listed;
use comments::{Run, comments, conditional, odd_runs, odd_styles};
use format::{Style, raised, struck};
use merged::MergedCells;
use parts::{SheetPart, parts_of_archive, sheet_parts};
use sheet::{Known, SheetReader, SheetXml};
use xml::{ODD, each_tag, is_odd};

/// Bytes of a sheet at most: enough for a million rows of twenty columns.
const LARGEST_SHEET: u64 = 768 << 20;
/// Bytes at most of what is kept in memory as a whole: texts, styles, names.
const LARGEST_OTHER: u64 = 96 << 20;

/// Characters of a text at most: the format's own limit.
const LONGEST_TEXT: usize = 32_767;
/// Parts of the file at most: the sheets, and what they refer to.
const MOST_PARTS: u64 = 20_000;
/// Sheets at most. Each is looked into, unless one is chosen.
const MOST_SHEETS: usize = 1000;
/// The last place of a cell in a row, unless the row has many cells.
const FARTHEST: usize = 1024;
/// The last place of a cell in a row with many cells: so many times the number of its filled cells.
const FARTHEST_TIMES: usize = 4;

/// Bytes that are read from any place, in a file or in memory.
trait Stored: Read + Seek + Send {}

impl<S: Read + Seek + Send> Stored for S {}

type Book = Xlsx<Box<dyn Stored>>;

/// A workbook that is checked and open.
pub struct Workbook {
    name: String,
    book: Book,
    checked: Checked,
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
        let mut source: Box<dyn Stored> = Box::new(source);
        let count = parts_of_archive(&mut source).map_err(|error| Diagnostic::unreadable(name, &error))?;
        if let Some(count) = count.filter(|count| *count > MOST_PARTS) {
            let problem = format!("it has {count} parts, and at most {MOST_PARTS} are read");
            return Err(
                Diagnostic::unreadable(name, &problem).help("save the table as a workbook of its own, or as .csv")
            );
        }
        let checked = check(name, &mut source)?;
        let book = Xlsx::new(source).map_err(|error| no_workbook(name, &error))?;
        Ok(Self { name: name.to_owned(), book, checked, widest: 0 })
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
    fn xml(&self, sheet: &str) -> SheetXml {
        self.checked.sheets.get(sheet).cloned().unwrap_or_else(SheetXml::missing)
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
        each_row(&mut self.book, xml, sheet, range, &mut |record| {
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
    /// A thread of its own reads them, a few rows ahead, fewer if they are wide: the reader of cells borrows the workbook.
    pub(crate) fn records(mut self, sheet: &str, range: CellRange) -> SheetRecords {
        const AHEAD: usize = 64;
        let name = named(&self.name, sheet);
        let mut xml = self.checked.sheets.remove(sheet).unwrap_or_else(SheetXml::missing);
        let hidden = xml.hidden(range);
        let comments = [std::mem::take(&mut self.checked.comments), std::mem::take(&mut xml.beside)].concat();
        let (sender, receiver) = mpsc::sync_channel(AHEAD.min(head_rows(self.widest)));
        let (sheet, place) = (sheet.to_owned(), name.clone());
        std::thread::spawn(move || {
            // sending fails once nobody needs more rows
            let read = each_row(&mut self.book, xml, &sheet, range, &mut |record| sender.send(Ok(record)).is_ok());
            if let Err(problem) = read {
                let _ = sender.send(Err(Diagnostic::unreadable(&place, &problem)));
            }
        });
        SheetRecords { name, hidden, comments, records: Box::new(receiver.into_iter()) }
    }
}

fn named(file: &str, sheet: &str) -> String {
    format!("{file}, sheet `{sheet}`")
}

/// Calls `take` with each row that is not empty, until it returns false.
fn each_row(
    book: &mut Book,
    xml: SheetXml,
    sheet: &str,
    range: CellRange,
    take: &mut dyn FnMut(Record) -> bool,
) -> Result<(), String> {
    if let Some(problem) = xml.problem {
        return Err(problem);
    }
    let mut merged = xml.merged;
    let mut reader = book.worksheet_cells_reader(sheet).map_err(|error| error.to_string())?;
    let styles: Vec<Option<Style>> = reader.styles().iter().map(Style::of).collect();
    merged.begin()?;
    let mut whole = |mut record: Record, merged: &mut MergedCells| {
        let row = u32::try_from(record.line.saturating_sub(1)).unwrap_or(u32::MAX);
        merged.fill(row, range.columns.0, &mut record);
        take(record)
    };
    let (mut record, mut filled) = (Record::default(), 0);
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
        if is_too_long(cell.get_value()) {
            return Err(format!("row {line}: a text is longer than {LONGEST_TEXT} characters"));
        }
        let content = match () {
            () if !range.has_row(row) || !range.has_column(column) => Content::Empty,
            () if xml.without_result.contains(&(row, column)) => Content::Other(WITHOUT_RESULT.to_owned()),
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

/// The text in place of a formula's result that is missing.
const WITHOUT_RESULT: &str = "=…";

fn content(value: &DataRef<'_>) -> Content {
    match value {
        DataRef::Empty => Content::Empty,
        DataRef::Int(number) => Content::Number(crate::quantity::Decimal::of_i128(i128::from(*number), 0)),
        DataRef::Float(number) => Content::of_f64(*number),
        DataRef::String(text) => Content::of_text(text),
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
    /// What the XML of each sheet says, by its name.
    sheets: HashMap<String, SheetXml>,
    /// A digest of what each sheet stores.
    digests: HashMap<String, u32>,
    /// The comments on cells of any sheet.
    comments: Vec<Comment>,
}

/// Unpacks every part that is read later, to count its bytes. Hardly any are kept.
fn check(file: &str, source: &mut dyn Stored) -> Result<Checked, Diagnostic> {
    let broken = |error: &dyn std::fmt::Display| no_workbook(file, error);
    let mut archive = zip::ZipArchive::new(source).map_err(|error| broken(&error))?;
    let (mut workbook, mut relations, mut texts, mut styles) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut parts = Vec::new();
    for index in 0..archive.len() {
        let stored = archive.by_index(index).map_err(|error| broken(&error))?;
        let part = stored.name().map_err(|error| broken(&error))?.to_ascii_lowercase();
        if [".xml", ".rels", ".vml"].into_iter().any(|suffix| part.ends_with(suffix)) {
            parts.push((part.starts_with("xl/worksheets/") && part.strip_suffix(".xml").is_some(), part, index));
        }
    }
    // shared texts and styles come before the sheets, which refer to them
    parts.sort();
    if let Some([(_, part, _), _]) = parts.array_windows().find(|[(_, one, _), (_, other, _)]| one == other) {
        return Err(Diagnostic::unreadable(file, &format!("it has two parts {part}")));
    }
    let (mut sheets, mut digests): (HashMap<String, SheetXml>, HashMap<String, u32>) = (HashMap::new(), HashMap::new());
    let (mut known, mut other, mut found) = (Known::default(), 0, Vec::new());
    let mut is_known = false;
    for (is_sheet, part, index) in parts {
        if is_sheet && !is_known {
            known = Known { odd_runs: odd_runs(&texts), conditional: conditional(&styles) };
            is_known = true;
        }
        let stored = archive.by_index(index).map_err(|error| broken(&error))?;
        digests.insert(part.clone(), stored.crc32());
        let most = if is_sheet { LARGEST_SHEET } else { LARGEST_OTHER - other };
        let (mut sheet, mut xml) = (SheetReader::new(&known), Vec::new());
        let into: &mut dyn io::Write = match part.as_str() {
            _ if is_sheet => &mut sheet,
            // pivot tables hold copies of cells
            _ if part.starts_with("xl/") && !part.starts_with("xl/pivot") => &mut xml,
            _ => &mut io::sink(),
        };
        let size = io::copy(&mut stored.take(most + 1), into).map_err(|error| broken(&error))?;
        if size > most {
            return Err(Diagnostic::unreadable(
                file,
                &format!("its part {part} unpacks to more than {} MiB", most >> 20),
            ));
        }
        if is_sheet {
            sheets.insert(part, sheet.sheet);
            continue;
        }
        other += size;
        let mut has_odd = false;
        each_tag(&xml, |tag, _| has_odd |= is_odd(tag));
        if has_odd {
            return Err(Diagnostic::unreadable(file, &format!("its part {part} has {ODD}")));
        }
        match part.as_str() {
            "xl/workbook.xml" => workbook = xml,
            "xl/_rels/workbook.xml.rels" => relations = xml,
            "xl/sharedstrings.xml" => texts = xml,
            "xl/styles.xml" => styles = xml,
            _ => found.extend(comments(&xml)),
        }
    }
    if let Some(odd) = odd_styles(&styles) {
        return Err(Diagnostic::unreadable(file, &format!("it has {odd}")));
    }
    let mut checked = Checked { sheets: HashMap::new(), digests, comments: found };
    checked
        .name_sheets(sheet_parts(&workbook, &relations), sheets)
        .map_err(|problem| Diagnostic::unreadable(file, &problem))?;
    Ok(checked)
}

impl Checked {
    /// Gives the name of its sheet to what is known of each part.
    ///
    /// # Errors
    /// If there are too many sheets, or two of one name or in one part.
    fn name_sheets(&mut self, listed: Vec<SheetPart>, mut sheets: HashMap<String, SheetXml>) -> Result<(), String> {
        if listed.len() > MOST_SHEETS {
            let help = "save the sheet with the measured values as a workbook of its own, or as .csv";
            return Err(format!("it has {} sheets, and at most {MOST_SHEETS} are read: {help}", listed.len()));
        }
        let digests = std::mem::take(&mut self.digests);
        // the texts of a sheet are stored elsewhere, and belong to its digest
        let of_texts = digests.get("xl/sharedstrings.xml").copied().unwrap_or_default();
        let mut parts = HashSet::new();
        for SheetPart { part, name, is_hidden } in listed {
            let digest = digests.get(&part).copied().unwrap_or_default();
            if self.digests.insert(name.clone(), digest.wrapping_mul(31).wrapping_add(of_texts)).is_some() {
                return Err(format!("it has two sheets `{name}`"));
            }
            // each part is read once
            if digests.contains_key(&part) && !parts.insert(part.clone()) {
                return Err(format!("its sheet `{name}` is stored in {part}, like a sheet before it"));
            }
            if let Some(mut sheet) = sheets.remove(&part) {
                sheet.is_hidden = is_hidden;
                self.sheets.insert(name, sheet);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
