//! The rows of a table in pieces, which workers take one after the other: chunks of text, stored columns, or rows that are read
//! already. The readers of files make them; the run of a batch takes them.

use std::io;
use std::iter::Peekable;

use super::block::Block;
use super::cell::Record;
use super::chunk::{ChunkContent, Chunker};
use super::contract::Contract;
use super::parquet::{ParquetTable, ROWS_TOGETHER, StoredRows};
use super::rows::{Rows, Setup, Wanted};
use super::split::{count_line_ends, next_record};
use crate::deviation::DeviationValues;
use crate::diagnostic::Diagnostic;

/// Records in a piece.
const TOGETHER: usize = 1024;

/// What the number of a row counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Place {
    /// Lines of a text.
    #[default]
    Line,
    /// Rows of a sheet.
    SheetRow,
    /// Records of a file without lines.
    Record,
}

impl Place {
    /// The place in words, where it is not a line.
    pub(crate) fn in_words(self, number: u64) -> Option<String> {
        match self {
            Self::Line => None,
            Self::SheetRow => Some(format!("row {number}")),
            Self::Record => Some(format!("record {number}")),
        }
    }
}

/// The rows of a table, not yet read.
pub(crate) struct Pieces {
    /// How they are read.
    setup: Setup,
    queue: Queue,
}

/// What a worker takes at a time: bytes or stored columns that are to be read, or a block that is read.
#[derive(Default)]
pub(crate) struct Piece {
    bytes: Vec<u8>,
    holds: Holds,
    pub(crate) block: Block,
    /// Records of the table before the piece.
    pub(crate) records_before: u64,
    /// Lines before its bytes.
    lines_before: u64,
}

/// What is still to be read of a piece.
#[derive(Default)]
enum Holds {
    /// Nothing: its block is read.
    #[default]
    Block,
    /// Its bytes.
    Bytes(ChunkContent),
    /// Stored columns.
    Stored(StoredRows),
}

/// The pieces of a table, in order.
pub(crate) struct Queue {
    source: Source,
    /// Records before the next piece. In text they are counted only where parts have no names.
    records: u64,
    /// Lines of text before the next piece.
    lines: u64,
}

/// Records of a file.
type Records = Box<dyn Iterator<Item = Result<Record, Diagnostic>> + Send>;

enum Source {
    /// Text of any length.
    Chunks(Chunker),
    /// Records.
    Records(Peekable<Records>),
    /// The rows of a Parquet file.
    Parquet(ParquetTable),
}

impl Pieces {
    /// The pieces of a closed table. A `give_` function gives the rows later.
    pub(crate) fn of_setup(setup: Setup) -> Self {
        let none: Records = Box::new(std::iter::empty());
        let queue = Queue { source: Source::Records(none.peekable()), records: 0, lines: 0 };
        Self { setup, queue }
    }

    /// The contract of the table.
    pub(crate) fn contract(&self) -> &Contract {
        &self.setup.contract
    }

    /// Gives the rows as chunks of text. The file has `lines` lines before them.
    pub(crate) fn give_chunks(&mut self, mut chunks: Chunker, lines: u64) {
        chunks.separator = self.setup.separator;
        self.setup.is_even = true;
        self.queue.lines = lines;
        self.queue.source = Source::Chunks(chunks);
    }

    /// Gives the rows as records.
    pub(crate) fn give_records(&mut self, records: impl Iterator<Item = Result<Record, Diagnostic>> + Send + 'static) {
        let records: Records = Box::new(records);
        self.queue.source = Source::Records(records.peekable());
    }

    /// Gives the rows of a Parquet file.
    pub(crate) fn give_file(&mut self, file: ParquetTable) {
        self.queue.source = Source::Parquet(file);
    }

    /// The reader of rows, which workers share, and the queue of pieces.
    pub(crate) fn open(self, wanted: Wanted) -> (Rows, Queue) {
        (Rows::new(self.setup, wanted), self.queue)
    }
}

impl Queue {
    /// Bytes read so far, after unpacking.
    pub(crate) fn bytes_read(&self) -> u64 {
        if let Source::Chunks(chunks) = &self.source { chunks.bytes_read } else { 0 }
    }

    /// The next piece; `false` at the end.
    pub(crate) fn next(&mut self, rows: &Rows, piece: &mut Piece) -> io::Result<bool> {
        piece.records_before = self.records;
        piece.holds = Holds::Block;
        match &mut self.source {
            Source::Chunks(chunks) => {
                let Some(holds) = chunks.next(&mut piece.bytes)? else { return Ok(false) };
                (piece.holds, piece.lines_before) = (Holds::Bytes(holds), self.lines);
                self.lines += match holds {
                    ChunkContent::Records => count_line_ends(&piece.bytes),
                    ChunkContent::Piece { .. } => memchr::memchr_iter(b'\n', &piece.bytes).count() as u64,
                };
                if !rows.has_id() {
                    self.records += records_in(&piece.bytes, holds, rows.separator());
                }
            }
            Source::Records(records) => {
                if let Some(Err(problem)) = records.next_if(Result::is_err) {
                    return Err(as_io(&problem));
                }
                piece.block = Block::default();
                for record in std::iter::from_fn(|| records.next_if(Result::is_ok)).take(TOGETHER).flatten() {
                    rows.record(&record, &mut piece.block);
                }
                self.records += piece.block.record_count;
                return Ok(piece.block.record_count > 0);
            }
            Source::Parquet(file) => {
                let places = rows.places(file.columns.iter().filter(|column| column.is_read()).count());
                let stored = file.next(&places, ROWS_TOGETHER).map_err(|problem| as_io(&problem))?;
                let Some(stored) = stored else { return Ok(false) };
                piece.records_before = stored.before;
                piece.holds = Holds::Stored(stored);
            }
        }
        Ok(true)
    }
}

impl Piece {
    /// Reads the piece into its block, unless that is done.
    pub(crate) fn read(&mut self, rows: &Rows) {
        match &self.holds {
            Holds::Bytes(holds) => rows.chunk(&mut self.bytes, *holds, self.lines_before, &mut self.block),
            Holds::Stored(stored) => rows.stored(&stored.columns, stored.before, &mut self.block),
            Holds::Block => {}
        }
        self.block.ends = self.block.values.iter().map(DeviationValues::ends).collect();
    }
}

/// How many records a chunk has.
fn records_in(bytes: &[u8], holds: ChunkContent, separator: u8) -> u64 {
    if let ChunkContent::Piece { first, .. } = holds {
        return u64::from(first);
    }
    let (mut fields, mut at, mut lines, mut count) = (Vec::new(), 0, 0, 0);
    while let Some(record) = next_record(bytes, at, separator, &mut fields, &mut lines) {
        at = record.next;
        count += 1;
    }
    count
}

/// A diagnostic as an error of reading.
fn as_io(problem: &Diagnostic) -> io::Error {
    io::Error::other(problem.message.clone())
}
