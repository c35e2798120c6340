//! Rows of named cells that are not parts, such as designs, in the formats for rows of parts. The command line calls it.

use std::io;

use super::columns::{ColumnKind, ResultCell, ResultColumns};
use super::ledger::RowSink;
use super::number::Decimals;
use super::request::RowFormat;
use super::write;

/// Writes rows of these columns, the header before the first of them.
#[derive(Debug)]
pub struct CellRows {
    names: Vec<String>,
    kinds: Vec<ColumnKind>,
    json_starts: Vec<Vec<u8>>,
    format: RowFormat,
    wrote_header: bool,
}

impl CellRows {
    /// A writer for columns with these names and kinds.
    #[must_use]
    pub fn new(columns: &[(String, ColumnKind)], format: RowFormat) -> Self {
        let (names, kinds): (Vec<_>, Vec<_>) = columns.iter().cloned().unzip();
        let json_starts = write::json_starts(names.iter().map(String::as_str));
        Self { names, kinds, json_starts, format, wrote_header: false }
    }

    /// Writes rows, each with a cell for each column; numbers have all their digits.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn write<'a>(
        &mut self,
        rows: impl Iterator<Item = Vec<ResultCell<'a>>>,
        sink: &mut RowSink<'_>,
    ) -> io::Result<()> {
        let sink = match sink {
            RowSink::Columns(sink) => {
                let mut columns = ResultColumns::new(self.kinds.iter().copied(), 0);
                rows.for_each(|row| columns.push(row.into_iter(), Decimals::Full));
                return sink.take(columns);
            }
            RowSink::Text(sink) => sink,
        };
        let is_first = !std::mem::replace(&mut self.wrote_header, true);
        let mut out = if is_first { write::header(&self.names, self.format) } else { Vec::new() };
        for row in rows {
            for (index, (cell, start)) in row.iter().zip(&self.json_starts).enumerate() {
                write::start(&mut out, index, start, self.format);
                write::cell(&mut out, cell, self.format, Decimals::Full);
            }
            write::end(&mut out, self.format);
        }
        sink.write(&out)
    }
}
