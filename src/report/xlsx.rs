//! Rows of a report as an Excel workbook. Called by the command line. A row goes to a temporary file at once, so that
//! memory does not depend on how many there are.

use std::io::{self, Write};

use rust_xlsxwriter::utility::cell_autofit_width;
use rust_xlsxwriter::{Format, Workbook, Worksheet, XlsxError};

use crate::diagnostic::harmless;

/// Rows of a sheet.
const MOST_ROWS: u32 = 1_048_576;

/// A workbook with one sheet: the first row is its header, cells that are numbers are numbers, all others are text.
pub struct Book {
    workbook: Workbook,
    rows: u32,
    /// How wide the widest cell of each column is, in pixels.
    widths: Vec<u32>,
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
        Ok(Self { workbook, rows: 0, widths: Vec::new() })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// If a sheet holds no more rows, not so many columns or no text so long, or the temporary file cannot be written.
    pub fn push(&mut self, row: &[&str]) -> io::Result<()> {
        if self.rows == MOST_ROWS {
            return Err(io::Error::other("a sheet has 1,048,576 rows, and there are more: write .csv or .parquet"));
        }
        let header = Format::new().set_bold();
        let page = self.workbook.worksheet_from_index(0).map_err(io::Error::other)?;
        self.widths.resize(self.widths.len().max(row.len()), 0);
        for ((column, cell), width) in (0..).zip(row).zip(&mut self.widths) {
            let format = (self.rows == 0).then_some(&header);
            write(page, (self.rows, column), cell, format).map_err(io::Error::other)?;
            *width = cell_autofit_width(cell).max(*width);
        }
        self.rows += 1;
        Ok(())
    }

    /// Writes the workbook.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn save(mut self, out: impl Write + Send) -> io::Result<()> {
        let page = self.workbook.worksheet_from_index(0).map_err(io::Error::other)?;
        for (column, width) in (0..).zip(self.widths) {
            page.set_column_width_pixels(column, width).map_err(io::Error::other)?;
        }
        self.workbook.save_to_writer(out).map_err(|error| match error {
            XlsxError::IoError(error) => error,
            error => io::Error::other(error),
        })
    }
}

fn write(page: &mut Worksheet, at: (u32, u16), cell: &str, header: Option<&Format>) -> Result<(), XlsxError> {
    let (row, column) = at;
    // names such as `007` and `+1` are no numbers
    let is_name = cell.starts_with('+') || has_leading_zero(cell);
    let number = cell.parse::<f64>().ok().filter(|number| number.is_finite() && !is_name);
    match (header, number) {
        (Some(bold), _) => page.write_string_with_format(row, column, harmless(cell), bold)?,
        (None, Some(number)) => page.write_number(row, column, number)?,
        (None, None) if cell.is_empty() => page,
        (None, None) => page.write_string(row, column, harmless(cell))?,
    };
    Ok(())
}

fn has_leading_zero(cell: &str) -> bool {
    cell.len() > 1 && cell.starts_with('0') && !cell.starts_with("0.") && !cell.starts_with("0e")
}
