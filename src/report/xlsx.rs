//! Rows of a report as an Excel workbook. A row goes to a temporary file at once, so that memory does not depend on the number
//! of rows.

use std::fs::File;
use std::io::{self, BufWriter, Cursor, Read, Seek, SeekFrom, Write};

use rust_xlsxwriter::utility::{cell_autofit_width, column_number_to_name};
use rust_xlsxwriter::{Format, Workbook, XlsxError};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

use super::{escape, row_heading};
use crate::diagnostic::{harmless, harmless_lines};

/// Rows of a sheet, and characters of a cell.
const MOST_ROWS: u32 = 1_048_576;
const MOST_CHARACTERS: usize = 32_767;
/// Where the sheet of rows stands in the file, and how its second row begins.
const SHEET: &str = "xl/worksheets/sheet1.xml";
const SECOND_ROW: &str = "<row r=\"2\"";

/// A workbook with a sheet of rows: the first is the header, cells that are numbers are numbers, all others are text. A
/// second sheet has the notes.
///
/// The library writes a workbook of the header and one row, which the rows then replace: by itself it holds all rows in memory, or
/// panics where its own temporary file cannot be written.
pub struct Book {
    workbook: Workbook,
    rows: u32,
    columns: Vec<BookColumn>,
    /// The rows below the header, as they stand in the sheet.
    below: BufWriter<File>,
    /// How many columns behind the first one are those of a table, whose headings stay.
    pub copied: usize,
}

/// A column of a workbook.
struct BookColumn {
    /// Its letters.
    name: String,
    /// How wide its widest cell is, in pixels.
    width: u32,
    /// The format of numbers: results in mm are shown to 0.1 µm.
    style: String,
    /// Whether its cells are names of parts.
    is_name: bool,
}

impl Book {
    /// A workbook whose sheet has no rows yet; they wait in the file `below`, which is empty.
    ///
    /// # Errors
    /// If a sheet cannot have this name.
    pub fn new(sheet: &str, below: File) -> io::Result<Self> {
        let mut workbook = Workbook::new();
        let page = workbook.add_worksheet();
        page.set_name(sheet).and_then(|page| page.set_freeze_panes(1, 0)).map_err(io::Error::other)?;
        Ok(Self { workbook, rows: 0, columns: Vec::new(), below: BufWriter::new(below), copied: 0 })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// If a sheet holds no more rows, not so many columns or no text so long, or the temporary file cannot be written.
    pub fn push(&mut self, row: &[&str]) -> io::Result<()> {
        if row.iter().any(|cell| cell.chars().count() > MOST_CHARACTERS) {
            return Err(io::Error::other("a cell of a workbook has 32,767 characters at most: write .csv or .parquet"));
        }
        if self.rows == MOST_ROWS {
            return Err(io::Error::other("a sheet has 1,048,576 rows, and there are more: write .csv or .parquet"));
        }
        self.rows += 1;
        if self.rows == 1 {
            return self.header(row);
        }
        self.cells(row)
            .map_err(|error| io::Error::new(error.kind(), format!("the temporary file of its rows: {error}")))
    }

    /// Writes a row below the header.
    fn cells(&mut self, row: &[&str]) -> io::Result<()> {
        let place = self.rows;
        write!(self.below, "<row r=\"{place}\">")?;
        for (cell, BookColumn { name, width, style, is_name }) in row.iter().zip(&mut self.columns) {
            if cell.is_empty() {
                continue;
            }
            *width = cell_autofit_width(cell).max(*width);
            match number(cell, *is_name) {
                Some(number) => write!(self.below, "<c r=\"{name}{place}\"{style}><v>{number:?}</v></c>")?,
                None => write!(
                    self.below,
                    "<c r=\"{name}{place}\" t=\"inlineStr\"><is><t xml:space=\"preserve\">{}</t></is></c>",
                    escape(&harmless(cell))
                )?,
            }
        }
        self.below.write_all(b"</row>")
    }

    /// Writes the header, with results in words, and the row that the rows replace.
    fn header(&mut self, names: &[&str]) -> io::Result<()> {
        /// The room for a filter's button.
        const BUTTON: u32 = 18;
        let (heading, length, other) =
            (Format::new().set_bold().set_text_wrap(), Format::new().set_num_format("0.0000"), Format::new());
        let page = self.workbook.worksheet_from_index(0).map_err(io::Error::other)?;
        for (place, name) in (0..).zip(names) {
            let is_copied = (1..=self.copied).contains(&usize::from(place));
            let text = if is_copied { (*name).to_owned() } else { row_heading(name) };
            let format = if !is_copied && name.ends_with("_mm") { &length } else { &other };
            page.write_string_with_format(0, place, harmless_lines(&text), &heading)
                .and_then(|page| page.write_number_with_format(1, place, 1.0, format))
                .map_err(io::Error::other)?;
            let width = text.lines().map(cell_autofit_width).max().unwrap_or(0) + BUTTON;
            let (is_name, style) = (*name == "part_id", String::new());
            self.columns.push(BookColumn { name: column_number_to_name(place), width, style, is_name });
        }
        let mut sheet = String::new();
        let mut made = ZipArchive::new(Cursor::new(self.workbook.save_to_buffer().map_err(io::Error::other)?))?;
        made.by_name(SHEET)?.read_to_string(&mut sheet)?;
        for column in &mut self.columns {
            let cell =
                sheet.split_once(&format!("<c r=\"{}2\"", column.name)).and_then(|(_, cell)| cell.split_once('>'));
            column.style = cell.map(|(style, _)| style.to_owned()).unwrap_or_default();
        }
        Ok(())
    }

    /// Writes the workbook, with a sheet of notes.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn save(mut self, notes: &[String], out: impl Write) -> io::Result<()> {
        self.end(notes).map_err(io::Error::other)?;
        let mut made = ZipArchive::new(Cursor::new(self.workbook.save_to_buffer().map_err(io::Error::other)?))?;
        let mut below = self.below.into_inner()?;
        let length = below.stream_position()?;
        below.seek(SeekFrom::Start(0))?;
        let options = SimpleFileOptions::default().large_file(length > u64::from(u32::MAX) / 2);
        let mut book = ZipWriter::new_stream(out);
        for place in 0..made.len() {
            let mut part = made.by_index(place)?;
            let name = part.name()?.into_owned();
            let mut text = String::new();
            part.read_to_string(&mut text)?;
            book.start_file(&*name, options).map_err(plain)?;
            match text.split_once(SECOND_ROW).zip(self.columns.last()).filter(|_| name == SHEET) {
                Some(((before, sample), BookColumn { name: last, .. })) => {
                    let extent = |row: u32| format!("<dimension ref=\"A1:{last}{row}\"/>");
                    book.write_all(before.replacen(&extent(2), &extent(self.rows), 1).as_bytes())?;
                    io::copy(&mut below, &mut book)?;
                    let behind = sample.split_once("</row>").map_or("", |(_, behind)| behind);
                    book.write_all(behind.as_bytes())?;
                }
                None => book.write_all(text.as_bytes())?,
            }
        }
        book.finish().map_err(plain)?;
        Ok(())
    }

    fn end(&mut self, notes: &[String]) -> Result<(), XlsxError> {
        const PIXELS_OF_NOTES: u32 = 900;
        let page = self.workbook.worksheet_from_index(0)?;
        for (place, column) in (0..).zip(&self.columns) {
            page.set_column_width_pixels(place, column.width)?;
        }
        if let Some((last_row, last)) = self.rows.checked_sub(1).zip(self.columns.len().checked_sub(1)) {
            page.autofilter(0, 0, last_row, u16::try_from(last).unwrap_or(u16::MAX))?;
        }
        if !notes.is_empty() {
            let format = Format::new().set_text_wrap();
            let page = self.workbook.add_worksheet();
            page.set_name("notes")?.set_column_width_pixels(0, PIXELS_OF_NOTES)?;
            for (row, note) in (0..).zip(notes) {
                page.write_string_with_format(row, 0, harmless(note), &format)?;
            }
        }
        Ok(())
    }
}

/// The error of the file itself, which names it.
fn plain(error: ZipError) -> io::Error {
    match error {
        ZipError::Io(error) => error,
        error => io::Error::other(error),
    }
}

/// The number of a cell. Text stays: what begins with `+` or a zero (`007`), a whole number beyond the 15 digits that a workbook
/// keeps, and a part's name that would be shown otherwise (`1.50`, `1e5`).
fn number(cell: &str, is_name: bool) -> Option<f64> {
    const MOST_DIGITS: usize = 15;
    let is_long = cell.len() > MOST_DIGITS && cell.bytes().all(|byte| byte.is_ascii_digit() || byte == b'-');
    let is_text = cell.starts_with('+') || has_leading_zero(cell) || is_long;
    let number = cell.parse::<f64>().ok().filter(|number| number.is_finite() && !is_text)?;
    (!is_name || number.to_string() == cell).then_some(number)
}

fn has_leading_zero(cell: &str) -> bool {
    cell.len() > 1 && cell.starts_with('0') && !cell.starts_with("0.") && !cell.starts_with("0e")
}
