//! What workers take of a table, one after the other: chunks of text, or rows that were read already. Made by the readers
//! of files; asked by the run of a batch.

use std::io;
use std::sync::Arc;

use super::block::Block;
use super::chunk::{ChunkContent, Chunker};
use super::parquet::{OpenGroup, ParquetTable, RowRange};
use super::rows::{Rows, Setup, Wanted};
use super::split::next_record;
use crate::diagnostic::Diagnostic;

/// What the number of a row's place counts.
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

pub(crate) type Blocks = Box<dyn Iterator<Item = io::Result<Block>> + Send>;
type MakeBlocks = Box<dyn FnOnce(Rows) -> Blocks + Send>;

/// The rows of a table, not yet read.
pub(crate) enum Pieces {
    /// Text, in chunks.
    Stream { setup: Setup, chunks: Chunker, lines: u64 },
    /// Rows that are made when it is known what is wanted of them.
    Later { setup: Setup, make: MakeBlocks },
    /// The rows of a Parquet file, which workers read side by side.
    Parquet { setup: Setup, file: ParquetTable },
    /// Rows that are there.
    Blocks(Vec<Block>),
}

/// What a worker takes: bytes or rows of a file to be read, or a block.
#[derive(Default)]
pub(crate) struct Piece {
    bytes: Vec<u8>,
    holds: Holds,
    /// The group of rows that the worker has open.
    open: Option<OpenGroup>,
    pub(crate) block: Block,
    /// Records before it.
    pub(crate) records_before: u64,
}

/// What of a piece is to be read.
#[derive(Default)]
enum Holds {
    /// Nothing: its block is there.
    #[default]
    Block,
    /// Its bytes.
    Bytes(ChunkContent),
    /// Rows of a Parquet file.
    Rows(Arc<ParquetTable>, RowRange),
}

/// The rows of a table, ready to be read.
pub(crate) struct Queue {
    source: Source,
    /// Records so far; of text, counted where parts have no name.
    records: u64,
    /// Lines before the first row.
    pub(crate) lines: u64,
}

enum Source {
    Chunks(Chunker),
    Blocks(Blocks),
    Parquet(Arc<ParquetTable>, std::vec::IntoIter<RowRange>),
}

impl Pieces {
    pub(crate) fn later(setup: Setup, make: impl FnOnce(Rows) -> Blocks + Send + 'static) -> Self {
        Self::Later { setup, make: Box::new(make) }
    }

    /// The reader of rows that workers share, and what they take.
    pub(crate) fn open(self, wanted: Wanted) -> (Option<Rows>, Queue) {
        let queue = |source, lines| Queue { source, records: 0, lines };
        match self {
            Self::Stream { setup, chunks, lines } => {
                (Some(Rows::new(setup, wanted)), queue(Source::Chunks(chunks), lines))
            }
            Self::Later { setup, make } => {
                let rows = Rows::new(setup, wanted);
                let blocks = make(rows.clone());
                (Some(rows), queue(Source::Blocks(blocks), 0))
            }
            Self::Parquet { setup, file } => {
                let ranges = file.ranges().into_iter();
                (Some(Rows::new(setup, wanted)), queue(Source::Parquet(Arc::new(file), ranges), 0))
            }
            Self::Blocks(blocks) => (None, queue(Source::Blocks(Box::new(blocks.into_iter().map(Ok))), 0)),
        }
    }
}

impl Queue {
    /// Bytes read so far, after unpacking.
    pub(crate) fn bytes_read(&self) -> u64 {
        match &self.source {
            Source::Chunks(chunks) => chunks.bytes_read(),
            Source::Blocks(_) | Source::Parquet(..) => 0,
        }
    }

    /// Whether lines count from the start of a piece, and not of the file.
    pub(crate) fn is_relative(&self) -> bool {
        matches!(self.source, Source::Chunks(_))
    }

    /// The next piece; `false` at the end.
    pub(crate) fn next(&mut self, rows: Option<&Rows>, piece: &mut Piece) -> io::Result<bool> {
        piece.records_before = self.records;
        match &mut self.source {
            Source::Chunks(chunks) => {
                let Some(holds) = chunks.next(&mut piece.bytes)? else { return Ok(false) };
                piece.holds = Holds::Bytes(holds);
                if let Some(rows) = rows.filter(|rows| !rows.has_id()) {
                    self.records += records_in(&piece.bytes, holds, rows.separator());
                }
                Ok(true)
            }
            Source::Blocks(blocks) => match blocks.next() {
                Some(block) => {
                    piece.block = block?;
                    piece.holds = Holds::Block;
                    self.records += piece.block.record_count;
                    Ok(true)
                }
                None => Ok(false),
            },
            Source::Parquet(file, ranges) => {
                let Some(range) = ranges.next() else { return Ok(false) };
                piece.records_before = range.before;
                piece.holds = Holds::Rows(Arc::clone(file), range);
                Ok(true)
            }
        }
    }
}

impl Piece {
    /// Reads the piece, if that is not done yet.
    pub(crate) fn read(&mut self, rows: Option<&Rows>) -> io::Result<()> {
        match (&self.holds, rows) {
            (Holds::Bytes(holds), Some(rows)) => rows.chunk(&mut self.bytes, *holds, &mut self.block),
            (Holds::Rows(file, range), Some(rows)) => {
                let places = rows.places(file.columns().iter().filter(|column| column.is_read()).count());
                let fields = file.read(&mut self.open, *range, &places).map_err(|problem| as_io(&problem))?;
                rows.stored(&fields, range.before, &mut self.block);
            }
            _ => {}
        }
        Ok(())
    }
}

/// How many records there are in a chunk.
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

/// An error of reading, as one that is raised later.
pub(crate) fn as_io(problem: &Diagnostic) -> io::Error {
    io::Error::other(problem.message.clone())
}
