//! Bytes of a table, whatever file they come in: unpacked, in UTF-8 or an 8-bit code, with the header read.
//!
//! The command line opens files and hands them to [`Input::open`]; readers of other formats hand their rows
//! to [`Input::of_rows`]. Nothing here knows what the columns mean.

use std::io::{self, Read};
use std::sync::Arc;

use super::chunk::Chunker;
use super::split::{self, Field};
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::shown;

/// How a table is written, where the user says so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Dialect {
    /// The separator; found from the header unless given.
    pub separator: Option<u8>,
    /// Whether numbers have a decimal comma.
    pub decimal_comma: bool,
}

/// The code of a file's text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    /// UTF-8, or an 8-bit code that has ASCII in it: the rows go through as they are.
    Bytes,
    /// UTF-16, recoded to UTF-8 as it is read.
    Utf16 { big_endian: bool },
}

impl Encoding {
    /// Bytes as they stood in the file.
    pub(super) fn original(self, bytes: &[u8]) -> std::borrow::Cow<'_, [u8]> {
        let Self::Utf16 { big_endian } = self else { return bytes.into() };
        let text = String::from_utf8_lossy(bytes);
        let units = text.encode_utf16();
        units.flat_map(|unit| if big_endian { unit.to_be_bytes() } else { unit.to_le_bytes() }).collect()
    }

    /// The mark that files of this encoding start with.
    pub(super) fn mark(self) -> &'static [u8] {
        match self {
            Self::Bytes => b"",
            Self::Utf16 { big_endian: true } => b"\xfe\xff",
            Self::Utf16 { big_endian: false } => b"\xff\xfe",
        }
    }
}

/// Text of a field: UTF-8, or else Windows-1252, which is Latin-1 with the places that it leaves free.
pub(super) fn text(bytes: &[u8]) -> std::borrow::Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => encoding_rs::WINDOWS_1252.decode_without_bom_handling(bytes).0,
    }
}

/// The first record of a table.
#[derive(Debug, Clone)]
pub struct Header {
    /// What messages call the table.
    pub name: Arc<str>,
    /// The names of the columns.
    pub columns: Vec<String>,
    /// The separator.
    pub separator: u8,
    /// Whether numbers have a decimal comma.
    pub decimal_comma: bool,
    /// The header as it stands in the file, with its line end.
    pub(super) raw: Vec<u8>,
    pub(super) encoding: Encoding,
}

impl Header {
    /// The columns as a message lists them, as many as it has room for; one without a name (the margin of a sheet) is
    /// none to choose.
    pub(super) fn names(&self) -> String {
        const MOST: usize = 30;
        let named = || self.columns.iter().filter(|name| !name.is_empty());
        let mut list = named().take(MOST).map(|name| shown(name)).collect::<Vec<_>>().join(", ");
        if let more @ 1.. = named().count().saturating_sub(MOST) {
            list += &format!(" and {more} more");
        }
        list
    }
}

/// Where a record is, in words: the place of a record by its number and line.
type Place = Arc<dyn Fn(u64) -> String + Send + Sync>;

/// A table whose header has been read.
pub struct Input {
    /// The header.
    pub header: Header,
    pub(super) chunks: Chunker,
    /// Lines up to the first record.
    pub(super) lines: u64,
    pub(super) place: Option<Place>,
}

/// A header longer than this is none.
const LARGEST_HEADER: usize = 1 << 16;

impl Input {
    /// Reads the header of a table from bytes; `name` is what messages call it. gzip and zstd are unpacked,
    /// byte order marks and UTF-16 without one recognised.
    ///
    /// # Errors
    /// If the bytes cannot be read, or there is no header.
    pub fn open(name: &str, bytes: Box<dyn Read + Send>, dialect: Dialect) -> Result<Self, Diagnostic> {
        let unreadable =
            |error: &io::Error| Diagnostic::error(Code::FileAccess, format!("cannot read {name}: {error}"));
        let bytes = unpacked(bytes).map_err(|error| unreadable(&error))?;
        let (bytes, encoding) = recoded(bytes).map_err(|error| unreadable(&error))?;
        let mut chunks = Chunker::new(bytes);
        let mut start = chunks.start(LARGEST_HEADER).map_err(|error| unreadable(&error))?.to_vec();
        // the end of the text is a line end, too
        if start.len() < LARGEST_HEADER {
            start.push(b'\n');
        }
        let mut fields = Vec::new();
        let mut lines = 0;
        let mut separator = dialect.separator;
        let mut at = 0;
        if let Some((stated, length)) = stated_separator(&start) {
            separator = separator.or(Some(stated));
            (at, lines) = (length, 1);
        }
        let separator = separator.unwrap_or_else(|| find_separator(&start[at..]));
        let mut blank = 0;
        let record = split::next_record(&start, at, separator, &mut fields, &mut blank);
        let Some(record) = record else {
            return Err(Diagnostic::error(Code::BadTable, format!("{name} has no rows, and no header"))
                .help("the first row names the columns: part_id,rack_over_roller,…"));
        };
        if record.open || !record.closed {
            let message = format!("{name} does not start with a row of column names");
            return Err(Diagnostic::error(Code::BadTable, message).help(if record.open {
                "a quote is not closed"
            } else {
                "the first line is longer than 64 KiB"
            }));
        }
        let next = record.next.min(chunks.buffered());
        let raw = start[..record.next].to_vec();
        chunks.skip(next);
        let columns = names(&start, &fields);
        let header =
            Header { name: name.into(), columns, separator, decimal_comma: dialect.decimal_comma, raw, encoding };
        Ok(Self { header, chunks, lines: lines + record.lines, place: None })
    }

    /// A table from rows of text: a header, rows, and what messages call the place of the row with a number
    /// (from 1).
    pub fn of_rows(
        name: &str,
        columns: Vec<String>,
        rows: impl Iterator<Item = io::Result<Vec<String>>> + Send + 'static,
        place: impl Fn(u64) -> String + Send + Sync + 'static,
    ) -> Self {
        let raw = row_bytes(&columns);
        let header = Header {
            name: name.into(),
            columns,
            separator: b',',
            decimal_comma: false,
            raw,
            encoding: Encoding::Bytes,
        };
        let bytes = RowBytes { rows, pending: Vec::new(), at: 0 };
        Self { header, chunks: Chunker::new(Box::new(bytes)), lines: 1, place: Some(Arc::new(place)) }
    }
}

fn names(bytes: &[u8], fields: &[Field]) -> Vec<String> {
    let mut scratch = Vec::new();
    fields.iter().map(|field| text(field.content(bytes, &mut scratch)).trim().to_owned()).collect()
}

/// `sep=;` on a line of its own, as spreadsheets write it: the separator, and the line's length.
fn stated_separator(start: &[u8]) -> Option<(u8, usize)> {
    let rest = start.strip_prefix(b"sep=")?;
    match rest {
        [separator, b'\n', ..] => Some((*separator, 6)),
        [separator, b'\r', b'\n', ..] => Some((*separator, 7)),
        _ => None,
    }
}

/// The separator of a header: tabs and semicolons are in no column's name, commas may be.
fn find_separator(start: &[u8]) -> u8 {
    let text = start.trim_ascii_start();
    let mut quoted = false;
    let mut seen = [false; 256];
    for byte in text {
        match byte {
            b'"' => quoted = !quoted,
            b'\n' | b'\r' if !quoted => break,
            byte if !quoted => seen[usize::from(*byte)] = true,
            _ => {}
        }
    }
    [b'\t', b';', b',', b'|'].into_iter().find(|separator| seen[usize::from(*separator)]).unwrap_or(b',')
}

/// A reader that starts with bytes that were read already.
fn again(start: Vec<u8>, rest: Box<dyn Read + Send>) -> Box<dyn Read + Send> {
    Box::new(io::Cursor::new(start).chain(rest))
}

/// The first bytes of a reader, as many as there are up to `count`.
fn first(reader: &mut dyn Read, count: usize) -> io::Result<Vec<u8>> {
    let mut start = Vec::with_capacity(count);
    reader.take(count as u64).read_to_end(&mut start)?;
    Ok(start)
}

fn unpacked(mut bytes: Box<dyn Read + Send>) -> io::Result<Box<dyn Read + Send>> {
    let start = first(&mut *bytes, 4)?;
    let packed = start.clone();
    let bytes = again(start, bytes);
    Ok(match packed.as_slice() {
        [0x1f, 0x8b, ..] => Box::new(flate2::read::MultiGzDecoder::new(bytes)),
        [0x28, 0xb5, 0x2f, 0xfd] => Box::new(Zstd { frames: Frames::Between(bytes) }),
        _ => bytes,
    })
}

/// Frame after frame of zstd.
struct Zstd {
    frames: Frames,
}

enum Frames {
    Between(Box<dyn Read + Send>),
    In(Box<ruzstd::decoding::StreamingDecoder<Box<dyn Read + Send>, ruzstd::decoding::FrameDecoder>>),
    Done,
}

impl Read for Zstd {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        loop {
            match std::mem::replace(&mut self.frames, Frames::Done) {
                Frames::Done => return Ok(0),
                Frames::Between(mut bytes) => {
                    let start = first(&mut *bytes, 4)?;
                    if start.is_empty() {
                        return Ok(0);
                    }
                    // a window of 8 MiB is what the format asks every decoder for
                    let decoder = ruzstd::decoding::StreamingDecoder::new(again(start, bytes));
                    self.frames = Frames::In(Box::new(decoder.map_err(io::Error::other)?));
                }
                Frames::In(mut decoder) => {
                    let count = decoder.read(out)?;
                    if count > 0 {
                        self.frames = Frames::In(decoder);
                        return Ok(count);
                    }
                    self.frames = Frames::Between(decoder.into_inner());
                }
            }
        }
    }
}

/// Recodes UTF-16 to UTF-8; takes a UTF-8 byte order mark away.
fn recoded(mut bytes: Box<dyn Read + Send>) -> io::Result<(Box<dyn Read + Send>, Encoding)> {
    let start = first(&mut *bytes, 4)?;
    let (skip, encoding) = match start.as_slice() {
        [0xef, 0xbb, 0xbf, ..] => (3, Encoding::Bytes),
        [0xff, 0xfe, ..] => (2, Encoding::Utf16 { big_endian: false }),
        [0xfe, 0xff, ..] => (2, Encoding::Utf16 { big_endian: true }),
        // a header starts with two characters of ASCII
        [a, 0, b, 0] if *a != 0 && *b != 0 => (0, Encoding::Utf16 { big_endian: false }),
        [0, a, 0, b] if *a != 0 && *b != 0 => (0, Encoding::Utf16 { big_endian: true }),
        _ => (0, Encoding::Bytes),
    };
    let bytes = again(start[skip..].to_vec(), bytes);
    Ok(match encoding {
        Encoding::Bytes => (bytes, encoding),
        Encoding::Utf16 { big_endian } => {
            let code = if big_endian { encoding_rs::UTF_16BE } else { encoding_rs::UTF_16LE };
            let decoder = code.new_decoder_without_bom_handling();
            let read = Recoded { bytes, decoder, raw: vec![0; 1 << 13], from: 0, to: 0, ended: false, finished: false };
            (Box::new(read), encoding)
        }
    })
}

struct Recoded {
    bytes: Box<dyn Read + Send>,
    decoder: encoding_rs::Decoder,
    raw: Vec<u8>,
    from: usize,
    to: usize,
    /// Whether the bytes are at their end.
    ended: bool,
    /// Whether the decoder was told so, which it bears only once.
    finished: bool,
}

impl Read for Recoded {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        while !self.finished {
            if self.from == self.to && !self.ended {
                self.from = 0;
                self.to = self.bytes.read(&mut self.raw)?;
                self.ended = self.to == 0;
            }
            let (state, read, written, _) = self.decoder.decode_to_utf8(&self.raw[self.from..self.to], out, self.ended);
            self.from += read;
            self.finished = self.ended && state == encoding_rs::CoderResult::InputEmpty;
            if written > 0 || out.is_empty() {
                return Ok(written);
            }
        }
        Ok(0)
    }
}

/// Rows as bytes of a table.
struct RowBytes<R> {
    rows: R,
    pending: Vec<u8>,
    at: usize,
}

impl<R: Iterator<Item = io::Result<Vec<String>>>> Read for RowBytes<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if self.at == self.pending.len() {
            match self.rows.next() {
                None => return Ok(0),
                Some(row) => (self.pending, self.at) = (row_bytes(&row?), 0),
            }
        }
        let count = out.len().min(self.pending.len() - self.at);
        out[..count].copy_from_slice(&self.pending[self.at..self.at + count]);
        self.at += count;
        Ok(count)
    }
}

/// A row as a line; an empty one still is a row.
fn row_bytes(cells: &[String]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (index, cell) in cells.iter().enumerate() {
        if index > 0 {
            bytes.push(b',');
        }
        let needs_quotes = cell.contains([',', '"', '\n', '\r']) || (cells.len() == 1 && cell.is_empty());
        if needs_quotes {
            bytes.push(b'"');
            bytes.extend(cell.replace('"', "\"\"").bytes());
            bytes.push(b'"');
        } else {
            bytes.extend(cell.bytes());
        }
    }
    bytes.push(b'\n');
    bytes
}
