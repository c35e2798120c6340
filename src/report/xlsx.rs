//! Rows of a report as an Excel workbook. Called by the command line. A row goes to a temporary file at once, so that
//! memory does not depend on how many there are.

use std::io::{self, Write};

use rust_xlsxwriter::utility::cell_autofit_width;
use rust_xlsxwriter::{Format, Workbook, Worksheet, XlsxError};

use super::row_heading;
use crate::diagnostic::{harmless, harmless_lines};

/// Rows of a sheet.
const MOST_ROWS: u32 = 1_048_576;

/// A workbook with a sheet of rows: the first is the header, cells that are numbers are numbers, all others are text. A
/// second sheet has the notes.
pub struct Book {
    workbook: Workbook,
    rows: u32,
    columns: Vec<BookColumn>,
    /// How many columns behind the first one are those of a table, whose headings stay.
    pub copied: usize,
}

/// A column of a workbook.
struct BookColumn {
    /// How wide its widest cell is, in pixels.
    width: u32,
    /// Whether it holds results in mm, which are shown to 0.1 µm.
    is_length: bool,
}

impl Book {
    /// A workbook whose sheet has no rows yet.
    ///
    /// # Errors
    /// If there is no temporary file.
    pub fn new(sheet: &str) -> io::Result<Self> {
        let mut workbook = Workbook::new();
        let page = workbook.add_worksheet_with_constant_memory().map_err(io::Error::other)?;
        page.set_name(sheet).and_then(|page| page.set_freeze_panes(1, 0)).map_err(io::Error::other)?;
        Ok(Self { workbook, rows: 0, columns: Vec::new(), copied: 0 })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// If a sheet holds no more rows, not so many columns or no text so long, or the temporary file cannot be written.
    pub fn push(&mut self, row: &[&str]) -> io::Result<()> {
        if self.rows == MOST_ROWS {
            return Err(io::Error::other("a sheet has 1,048,576 rows, and there are more: write .csv or .parquet"));
        }
        if self.rows == 0 {
            self.header(row).map_err(io::Error::other)?;
        }
        let lengths = Format::new().set_num_format("0.0000");
        let page = self.workbook.worksheet_from_index(0).map_err(io::Error::other)?;
        for ((place, cell), column) in (0..).zip(row).zip(&mut self.columns).filter(|_| self.rows > 0) {
            let format = column.is_length.then_some(&lengths);
            write(page, (self.rows, place), cell, format).map_err(io::Error::other)?;
            column.width = cell_autofit_width(cell).max(column.width);
        }
        self.rows += 1;
        Ok(())
    }

    /// Writes the header: of results in words.
    fn header(&mut self, names: &[&str]) -> Result<(), XlsxError> {
        /// What opens a filter.
        const BUTTON: u32 = 18;
        let format = Format::new().set_bold().set_text_wrap();
        let page = self.workbook.worksheet_from_index(0)?;
        for (place, name) in (0..).zip(names) {
            let is_copied = (1..=self.copied).contains(&usize::from(place));
            let heading = if is_copied { (*name).to_owned() } else { row_heading(name) };
            page.write_string_with_format(0, place, harmless_lines(&heading), &format)?;
            let width = heading.lines().map(cell_autofit_width).max().unwrap_or(0) + BUTTON;
            self.columns.push(BookColumn { width, is_length: !is_copied && name.ends_with("_mm") });
        }
        Ok(())
    }

    /// Writes the workbook, with a sheet of notes.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn save(mut self, notes: &[String], out: impl Write + Send) -> io::Result<()> {
        self.end(notes).and_then(|()| self.workbook.save_to_writer(out)).map_err(|error| match error {
            XlsxError::IoError(error) => error,
            error => io::Error::other(error),
        })
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

fn write(page: &mut Worksheet, at: (u32, u16), cell: &str, format: Option<&Format>) -> Result<(), XlsxError> {
    let (row, column) = at;
    // names such as `007` and `+1` are no numbers
    let is_name = cell.starts_with('+') || has_leading_zero(cell);
    let number = cell.parse::<f64>().ok().filter(|number| number.is_finite() && !is_name);
    match (number, format) {
        (Some(number), Some(format)) => page.write_number_with_format(row, column, number, format)?,
        (Some(number), None) => page.write_number(row, column, number)?,
        (None, _) if cell.is_empty() => page,
        (None, _) => page.write_string(row, column, harmless(cell))?,
    };
    Ok(())
}

fn has_leading_zero(cell: &str) -> bool {
    cell.len() > 1 && cell.starts_with('0') && !cell.starts_with("0.") && !cell.starts_with("0e")
}
