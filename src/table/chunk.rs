//! A table in chunks that end where a record ends, so that workers can take one each.
//!
//! Chunks have the same size however the bytes arrive. A record that does not fit is handed on in pieces, so that its bytes are not
//! lost.

use std::io::{self, Read};

use super::split;

/// Bytes in a chunk. With a chunk and its results per worker, memory stays below 16 MiB.
const CHUNK: usize = 1 << 16;

/// The longest record, in bytes.
pub(crate) const LONGEST_RECORD: usize = 1 << 18;

/// What a chunk holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ChunkContent {
    /// Whole records.
    Records,
    /// A piece of a record that is too long; whether it is its first or its last.
    Piece { first: bool, last: bool },
}

/// Reads a table in chunks.
pub(crate) struct Chunker {
    reader: Box<dyn Read + Send>,
    /// Bytes that are read and not handed on.
    pending: Vec<u8>,
    ended: bool,
    /// The place that is reached within a record that is too long.
    overlong: Option<Overlong>,
    /// Bytes read so far, after unpacking.
    pub(crate) bytes_read: u64,
    /// What stands between fields.
    pub(crate) separator: u8,
}

/// Where in a record its bytes so far end.
#[derive(Debug, Clone, Copy)]
enum Overlong {
    FieldStart,
    Quoted,
    /// Behind a quote that closes a field, or is the first of two that stand for one.
    AfterQuote,
    Unquoted,
    AfterReturn,
}

impl Chunker {
    pub(crate) fn new(reader: Box<dyn Read + Send>) -> Self {
        Self { reader, pending: Vec::new(), ended: false, overlong: None, bytes_read: 0, separator: b',' }
    }

    /// The first bytes, without handing them on.
    pub(crate) fn start(&mut self, count: usize) -> io::Result<&[u8]> {
        self.fill(count)?;
        Ok(&self.pending[..self.pending.len().min(count)])
    }

    /// The bytes, all of them if there are no more than so many, as the last that are handed on.
    pub(crate) fn all(&mut self, most: usize) -> io::Result<Vec<u8>> {
        self.fill(most + 1)?;
        Ok(std::mem::take(&mut self.pending))
    }

    /// All bytes that are not handed on, read or not.
    pub(crate) fn into_reader(self) -> Box<dyn Read + Send> {
        Box::new(io::Cursor::new(self.pending).chain(self.reader))
    }

    /// Drops bytes that [`start`](Self::start) gave.
    pub(crate) fn skip(&mut self, count: usize) {
        self.pending.drain(..count);
    }

    /// Reads until so many bytes are pending, or the input ends.
    fn fill(&mut self, count: usize) -> io::Result<()> {
        let before = self.pending.len();
        let missing = count.saturating_sub(before);
        if self.ended || missing == 0 {
            return Ok(());
        }
        let read = self.reader.by_ref().take(missing as u64).read_to_end(&mut self.pending);
        self.bytes_read += (self.pending.len() - before) as u64;
        self.ended = read? < missing;
        Ok(())
    }

    /// The next chunk into `chunk`; `None` at the end.
    pub(crate) fn next(&mut self, chunk: &mut Vec<u8>) -> io::Result<Option<ChunkContent>> {
        if let Some(state) = self.overlong {
            return self.piece(chunk, state, false).map(Some);
        }
        let mut size = CHUNK;
        loop {
            self.fill(size)?;
            if self.pending.is_empty() {
                return Ok(None);
            }
            if self.ended {
                // the last record needs no line end
                self.hand_on(chunk, self.pending.len());
                return Ok(Some(ChunkContent::Records));
            }
            if let Some(length) = self.whole_records() {
                self.hand_on(chunk, length);
                return Ok(Some(ChunkContent::Records));
            }
            if size >= LONGEST_RECORD {
                return self.piece(chunk, Overlong::FieldStart, true).map(Some);
            }
            size = (2 * size).min(LONGEST_RECORD);
        }
    }

    /// How many of the pending bytes are whole records.
    fn whole_records(&self) -> Option<usize> {
        let bytes = self.pending.as_slice();
        if let Some(end) = memchr::memrchr(b'\n', bytes)
            && split::is_plain(&bytes[..=end])
        {
            return Some(end + 1);
        }
        let (mut fields, mut at, mut lines) = (Vec::new(), 0, 0);
        while let Some(record) = split::next_record(bytes, at, self.separator, &mut fields, &mut lines) {
            if !record.closed {
                break;
            }
            at = record.next;
        }
        (at > 0).then_some(at)
    }

    /// Hands on the first pending bytes.
    fn hand_on(&mut self, chunk: &mut Vec<u8>, length: usize) {
        chunk.clear();
        chunk.extend_from_slice(&self.pending[length..]);
        std::mem::swap(chunk, &mut self.pending);
        chunk.truncate(length);
    }

    /// The next piece of a record that is too long.
    fn piece(&mut self, chunk: &mut Vec<u8>, mut state: Overlong, first: bool) -> io::Result<ChunkContent> {
        self.fill(CHUNK)?;
        let mut end = None;
        for (at, &byte) in self.pending.iter().enumerate() {
            state = match (state, byte) {
                (Overlong::AfterReturn, _) => {
                    end = Some(if byte == b'\n' { at + 1 } else { at });
                    break;
                }
                (Overlong::Quoted, b'"') => Overlong::AfterQuote,
                (Overlong::FieldStart | Overlong::AfterQuote, b'"') | (Overlong::Quoted, _) => Overlong::Quoted,
                (_, b'\n') => {
                    end = Some(at + 1);
                    break;
                }
                (_, b'\r') => Overlong::AfterReturn,
                (Overlong::FieldStart, b' ') => Overlong::FieldStart,
                _ if byte == self.separator => Overlong::FieldStart,
                _ => Overlong::Unquoted,
            };
        }
        let last = end.is_some() || self.ended;
        let length = end.unwrap_or(self.pending.len());
        self.hand_on(chunk, length);
        self.overlong = (!last).then_some(state);
        Ok(ChunkContent::Piece { first, last })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives one byte at a time, as a slow pipe does.
    struct Trickle(io::Cursor<Vec<u8>>);

    impl Read for Trickle {
        fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
            let count = out.len().min(1);
            self.0.read(&mut out[..count])
        }
    }

    fn chunks(bytes: &[u8], trickle: bool) -> Vec<(Vec<u8>, ChunkContent)> {
        let cursor = io::Cursor::new(bytes.to_vec());
        let mut chunker = Chunker::new(if trickle { Box::new(Trickle(cursor)) } else { Box::new(cursor) });
        let (mut all, mut chunk) = (Vec::new(), Vec::new());
        while let Some(holds) = chunker.next(&mut chunk).unwrap() {
            all.push((chunk.clone(), holds));
        }
        all
    }

    #[test]
    fn chunks_end_where_records_end_however_the_bytes_arrive() {
        let lines: String = (0..40_000).map(|line| ["P", &line.to_string(), ",1.0\n"].concat()).collect();
        let quoted: String = (0..40_000).map(|line| ["\"P\n", &line.to_string(), "\",1.0\r"].concat()).collect();
        for text in [lines, quoted] {
            let whole = chunks(text.as_bytes(), false);
            assert!(whole.len() > 3);
            let last = text.as_bytes()[text.len() - 1];
            assert!(whole.iter().all(|(chunk, _)| chunk.last() == Some(&last) && chunk.len() <= CHUNK));
            assert_eq!(whole.iter().flat_map(|(chunk, _)| chunk.clone()).collect::<Vec<_>>(), text.as_bytes());
            assert_eq!(chunks(text.as_bytes(), true), whole);
        }
    }

    #[test]
    fn a_record_that_is_too_long_comes_in_pieces_and_the_next_is_whole() {
        let long = format!("a,b\nP1,{}\r\nP2,2\n", "x".repeat(3 * LONGEST_RECORD));
        let quoted = format!("a,b\nP1,\"{}\"\"\n\"\nP2,2\n", "x\n".repeat(2 * LONGEST_RECORD));
        for text in [long, quoted] {
            let all = chunks(text.as_bytes(), false);
            assert_eq!(all[0].0, b"a,b\n");
            assert_eq!(all[1].1, ChunkContent::Piece { first: true, last: false });
            assert_eq!(
                all.iter().filter(|(_, holds)| matches!(holds, ChunkContent::Piece { last: true, .. })).count(),
                1
            );
            assert_eq!(all.last().unwrap(), &(b"P2,2\n".to_vec(), ChunkContent::Records));
            assert!(all.iter().all(|(chunk, _)| chunk.len() <= LONGEST_RECORD));
            assert_eq!(all.iter().flat_map(|(chunk, _)| chunk.clone()).collect::<Vec<_>>(), text.as_bytes());
        }
    }
}
