//! Rows of a report as an Excel workbook.

use rust_xlsxwriter::{Format, Workbook, XlsxError};

/// A workbook with one sheet: the first row is its header, cells that are numbers are numbers.
///
/// # Errors
/// If there are more rows or columns, or longer texts, than a sheet holds.
pub fn workbook(sheet: &str, rows: &[Vec<String>]) -> Result<Vec<u8>, XlsxError> {
    let mut book = Workbook::new();
    let header = Format::new().set_bold();
    let page = book.add_worksheet();
    page.set_name(sheet)?;
    page.set_freeze_panes(1, 0)?;
    for (index, row) in (0..).zip(rows) {
        for (column, cell) in (0..).zip(row) {
            // a name such as `007` is no number
            let number = cell.parse::<f64>().ok().filter(|number| number.is_finite() && !has_leading_zero(cell));
            match number {
                _ if index == 0 => page.write_string_with_format(index, column, cell, &header)?,
                Some(number) => page.write_number(index, column, number)?,
                None if cell.is_empty() => continue,
                None => page.write_string(index, column, cell)?,
            };
        }
    }
    page.autofit();
    book.save_to_buffer()
}

fn has_leading_zero(cell: &str) -> bool {
    cell.len() > 1 && cell.starts_with('0') && !cell.starts_with("0.") && !cell.starts_with("0e")
}
