//! Excel workbooks: any bytes are read or refused.

use rackmesh::cmm::xlsx::{CellRange, Workbook};

/// Reads the input as a workbook, its first rows.
pub fn check(data: &[u8]) {
    let Ok(book) = Workbook::open("fuzz.xlsx", data.to_vec()) else { return };
    let Some(sheet) = book.sheets().first().cloned() else { return };
    let Ok(rows) = book.rows(Some(&sheet), CellRange::default(), &|_| false) else { return };
    for row in rows.rows.take(1000) {
        if row.is_err() {
            break;
        }
    }
}
