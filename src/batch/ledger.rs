//! Where the results of a run go, and the counts and statistics that are kept, table after table. Tables of parts and tables of
//! teeth share it.

use std::io::{self, Write};

use super::columns::ResultColumns;
use super::outcome::{Outcome, PartSink, Quantity};
use super::pack::Packing;
use crate::table::Encoding;

/// Where results go.
#[derive(Default)]
pub struct Sinks<'a> {
    /// The rows.
    pub rows: Option<RowSink<'a>>,
    /// The rejected rows.
    pub rejects: Option<Sink<'a>>,
    /// Every part and every rejected row, where they are [listed](super::Request::lists_parts).
    pub parts: Option<&'a mut dyn PartSink>,
}

/// Where rows go.
pub enum RowSink<'a> {
    /// Text.
    Text(Sink<'a>),
    /// Columns, for a plan whose rows are [`RowFormat::Columns`](super::RowFormat::Columns).
    Columns(&'a mut dyn ColumnSink),
}

/// Takes rows in columns.
pub trait ColumnSink: Send {
    /// Takes the next rows.
    ///
    /// # Errors
    /// If they cannot be written.
    fn take(&mut self, rows: ResultColumns) -> io::Result<()>;
}

impl Sinks<'_> {
    /// Flushes the writers.
    pub(super) fn flush(self) -> io::Result<()> {
        let rows = if let Some(RowSink::Text(sink)) = self.rows { sink.writer.flush() } else { Ok(()) };
        let rejects = self.rejects.map_or(Ok(()), |sink| sink.writer.flush());
        rows.and(rejects)
    }
}

/// A writer, and how what goes there is packed.
pub struct Sink<'a> {
    /// Where the bytes go.
    pub writer: &'a mut (dyn Write + Send),
    /// How they are packed.
    pub packing: Packing,
}

impl Sink<'_> {
    /// Packs bytes and writes them.
    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.writer.write_all(&self.packing.pack(bytes)?)
    }
}

/// The output and the counts of a run, table after table.
pub(super) struct Ledger<'a> {
    pub(super) sinks: Sinks<'a>,
    pub(super) outcome: Outcome,
    /// The header of the rejected rows written last.
    rejects_header: Option<Vec<u8>>,
    wrote_header: bool,
}

impl<'a> Ledger<'a> {
    /// An empty ledger, with statistics of these quantities.
    pub(super) fn new(sinks: Sinks<'a>, quantities: Vec<Quantity>) -> Self {
        let outcome = Outcome { quantities, ..Outcome::default() };
        Self { sinks, outcome, rejects_header: None, wrote_header: false }
    }

    /// Writes the header before the first row, or before the first rejected row with another header.
    pub(super) fn start(
        &mut self,
        names: impl FnOnce() -> Vec<u8>,
        encoding: Encoding,
        header: &[u8],
    ) -> io::Result<()> {
        if let Some(RowSink::Text(rows)) = self.sinks.rows.as_mut().filter(|_| !self.wrote_header) {
            rows.write(&names())?;
            self.wrote_header = true;
        }
        if let Some(rejects) = &mut self.sinks.rejects
            && self.rejects_header.as_deref() != Some(header)
        {
            let mark = if self.rejects_header.is_none() { encoding.mark() } else { b"" };
            let start = [mark, &encoding.original(header)].concat();
            rejects.write(&start)?;
            self.rejects_header = Some(header.to_vec());
        }
        Ok(())
    }

    /// Whether the run ended before the end of the input: in strict mode at the first rejected row.
    pub(super) fn is_over(&self, is_strict: bool) -> bool {
        self.outcome.interrupted || (is_strict && self.outcome.counts.rejected > 0)
    }

    /// Ends the run and returns its outcome.
    pub(super) fn finish(mut self, is_strict: bool) -> (Outcome, io::Result<()>) {
        self.outcome.is_cut |= self.is_over(is_strict);
        (self.outcome, self.sinks.flush())
    }
}
