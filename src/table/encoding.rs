//! From the bytes of a file to text: unpacks them and finds their encoding. Called by whoever opens a table.
//!
//! A table of any length is recoded to UTF-8 as it is read. Text in UTF-8, Latin-1 or Windows-1252 stays as it is: digits and
//! separators are the same bytes in all three, and a cell is recoded when its text is asked for.

use std::borrow::Cow;
use std::io::{self, BufRead as _, BufReader, Read};

use encoding_rs::{
    BIG5, EUC_JP, EUC_KR, Encoding as Code, GB18030, SHIFT_JIS, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1250, WINDOWS_1251,
    WINDOWS_1252,
};
use ruzstd::decoding::{FrameDecoder, StreamingDecoder};

/// The encoding of a file's text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Encoding {
    code: &'static Code,
}

impl Encoding {
    /// UTF-8; also of files that are no text.
    pub(crate) const PLAIN: Self = Self { code: UTF_8 };

    /// The encoding of that name: `utf-8`, `utf-16le`, `windows-1252`, `latin1`, `shift_jis`, and what browsers know.
    ///
    /// # Errors
    /// If no encoding has that name.
    pub fn named(name: &str) -> Result<Self, String> {
        let code = Code::for_label(name.trim().as_bytes()).map(|code| Self { code });
        code.ok_or_else(|| "write a name such as utf-8, utf-16le, windows-1252, shift_jis or gb18030".to_owned())
    }

    /// Other encodings in which the text may be, with the text in each. There are none unless this one is Windows-1252 and the text
    /// is not UTF-8.
    pub(crate) fn others(self, bytes: &[u8]) -> impl Iterator<Item = (&'static str, Cow<'_, str>)> {
        let is_open = self.code == WINDOWS_1252 && !is_utf8(bytes);
        let codes = [GB18030, BIG5, SHIFT_JIS, EUC_JP, EUC_KR, WINDOWS_1250, WINDOWS_1251].into_iter();
        codes.filter(move |_| is_open).map(|code| (code.name(), code.decode_without_bom_handling(bytes).0))
    }

    /// Whether the text is recoded to UTF-8 as it is read.
    fn is_recoded(self) -> bool {
        self.code != UTF_8 && self.code != WINDOWS_1252
    }

    /// Its name in the WHATWG standard: `UTF-8`, `windows-1252`.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.code.name()
    }

    /// Recoded bytes as they stand in the file.
    pub(crate) fn original(self, bytes: &[u8]) -> Cow<'_, [u8]> {
        if !self.is_recoded() {
            return bytes.into();
        }
        let text = String::from_utf8_lossy(bytes);
        match self.code {
            code if code == UTF_16BE => text.encode_utf16().flat_map(u16::to_be_bytes).collect(),
            code if code == UTF_16LE => text.encode_utf16().flat_map(u16::to_le_bytes).collect(),
            code => code.encode(&text).0.into_owned().into(),
        }
    }

    /// The byte order mark that files of this encoding start with.
    pub(crate) fn mark(self) -> &'static [u8] {
        match self.code {
            code if code == UTF_16BE => b"\xfe\xff",
            code if code == UTF_16LE => b"\xff\xfe",
            _ => b"",
        }
    }

    /// The encoding of a text by its first bytes, and the length of its byte order mark.
    fn detect(start: &[u8]) -> (Self, usize) {
        match start {
            [0xef, 0xbb, 0xbf, ..] => (Self::PLAIN, 3),
            [0xff, 0xfe, ..] => (Self { code: UTF_16LE }, 2),
            [0xfe, 0xff, ..] => (Self { code: UTF_16BE }, 2),
            // a table starts with two characters of ASCII
            [a, 0, b, 0, ..] if *a != 0 && *b != 0 => (Self { code: UTF_16LE }, 0),
            [0, a, 0, b, ..] if *a != 0 && *b != 0 => (Self { code: UTF_16BE }, 0),
            _ if is_utf8(start) => (Self::PLAIN, 0),
            _ if is_shift_jis(start) => (Self { code: SHIFT_JIS }, 0),
            _ => (Self { code: WINDOWS_1252 }, 0),
        }
    }
}

/// Whether the start of a text is UTF-8; its last character may be cut off.
fn is_utf8(start: &[u8]) -> bool {
    std::str::from_utf8(start).map_or_else(|error| error.error_len().is_none(), |_| true)
}

/// Whether the start of a text is Shift-JIS: every byte is valid in it, and two or more are first bytes of a pair that are control
/// characters in Latin-1.
fn is_shift_jis(start: &[u8]) -> bool {
    let whole = start.iter().rposition(|byte| *byte == b'\n').map_or(start, |end| &start[..end]);
    let leads = whole.iter().filter(|byte| (0x81..=0x9f).contains(*byte)).count();
    leads >= 2 && SHIFT_JIS.decode_without_bom_handling_and_without_replacement(whole).is_some()
}

/// The text of a cell: UTF-8, or else Windows-1252, which is Latin-1 with more characters.
pub(crate) fn text(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => WINDOWS_1252.decode_without_bom_handling(bytes).0,
    }
}

/// The text of a whole file.
#[must_use]
pub fn decode(bytes: &[u8]) -> Cow<'_, str> {
    let (encoding, mark) = Encoding::detect(bytes);
    let bytes = &bytes[mark..];
    if encoding.is_recoded() { encoding.code.decode_without_bom_handling(bytes).0 } else { text(bytes) }
}

/// The first bytes of a reader, as many as there are up to `count`.
fn first(reader: &mut dyn Read, count: usize) -> io::Result<Vec<u8>> {
    let mut start = Vec::with_capacity(count);
    reader.take(count as u64).read_to_end(&mut start)?;
    Ok(start)
}

/// A reader whose first bytes are known.
pub(crate) struct Peeked {
    /// The first bytes.
    pub(crate) start: Vec<u8>,
    /// All bytes, the first ones included.
    pub(crate) bytes: Box<dyn Read + Send>,
}

/// Reads the first bytes and puts them back.
pub(crate) fn peek(mut bytes: Box<dyn Read + Send>, count: usize) -> io::Result<Peeked> {
    let start = first(&mut *bytes, count)?;
    Ok(Peeked { bytes: Box::new(io::Cursor::new(start.clone()).chain(bytes)), start })
}

/// Unpacks gzip and zstd.
pub(crate) fn unpacked(bytes: Box<dyn Read + Send>) -> io::Result<Box<dyn Read + Send>> {
    let Peeked { start, bytes } = peek(bytes, 4)?;
    Ok(match start.as_slice() {
        [0x1f, 0x8b, ..] => Box::new(flate2::read::MultiGzDecoder::new(bytes)),
        [0x28, 0xb5, 0x2f, 0xfd] => Box::new(ZstdFrames::new(BufReader::new(bytes))?),
        _ => bytes,
    })
}

/// A frame of zstd.
type ZstdFrame = StreamingDecoder<BufReader<Box<dyn Read + Send>>, FrameDecoder>;

/// The frames of zstd, one after the other; `None` behind the last.
struct ZstdFrames(Option<Box<ZstdFrame>>);

impl ZstdFrames {
    fn new(mut bytes: BufReader<Box<dyn Read + Send>>) -> io::Result<Self> {
        let is_over = bytes.fill_buf()?.is_empty();
        let frame = (!is_over).then(|| StreamingDecoder::new(bytes).map(Box::new)).transpose();
        frame.map(Self).map_err(io::Error::other)
    }
}

impl Read for ZstdFrames {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        while let Some(mut frame) = self.0.take() {
            let count = frame.read(out)?;
            if count > 0 {
                self.0 = Some(frame);
                return Ok(count);
            }
            *self = Self::new(frame.into_inner())?;
        }
        Ok(0)
    }
}

/// Recodes a table to UTF-8 where it must be, and removes a byte order mark. `told` is the encoding that the user names.
pub(crate) fn recoded(
    bytes: Box<dyn Read + Send>,
    told: Option<Encoding>,
) -> io::Result<(Box<dyn Read + Send>, Encoding)> {
    const LOOKED_AT: usize = 1 << 16;
    let mut peeked = peek(bytes, LOOKED_AT)?;
    let (found, mark) = Encoding::detect(&peeked.start);
    first(&mut peeked.bytes, mark)?;
    let encoding = told.unwrap_or(found);
    if !encoding.is_recoded() {
        return Ok((peeked.bytes, encoding));
    }
    let decoder = encoding.code.new_decoder_without_bom_handling();
    let raw = vec![0; 1 << 13];
    let read = Recoded { bytes: peeked.bytes, decoder, raw, text: String::new(), at: 0, ended: false };
    Ok((Box::new(read), encoding))
}

struct Recoded {
    bytes: Box<dyn Read + Send>,
    decoder: encoding_rs::Decoder,
    raw: Vec<u8>,
    /// Recoded text, of which the bytes before `at` are handed on. A caller may have room for less than a character.
    text: String,
    at: usize,
    ended: bool,
}

impl Read for Recoded {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        while self.at == self.text.len() && !self.ended {
            let count = self.bytes.read(&mut self.raw)?;
            self.ended = count == 0;
            self.text.clear();
            self.at = 0;
            self.text.reserve(self.decoder.max_utf8_buffer_length(count).unwrap_or(0));
            // there is room for all of it
            let _ = self.decoder.decode_to_string(&self.raw[..count], &mut self.text, self.ended);
        }
        let rest = &self.text.as_bytes()[self.at..];
        let count = rest.len().min(out.len());
        out[..count].copy_from_slice(&rest[..count]);
        self.at += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_encoding_of_an_office() {
        for bytes in [
            "12,5 µm".as_bytes(),
            b"\xef\xbb\xbf12,5 \xc2\xb5m",
            b"12,5 \xb5m",
            b"\xff\xfe1\x002\x00,\x005\x00 \x00\xb5\x00m\x00",
            b"\xfe\xff\x001\x002\x00,\x005\x00 \x00\xb5\x00m",
        ] {
            assert_eq!(decode(bytes), "12,5 µm");
            let mut text = String::new();
            let (mut read, encoding) = recoded(Box::new(io::Cursor::new(bytes.to_vec())), None).unwrap();
            let mut raw = Vec::new();
            read.read_to_end(&mut raw).unwrap();
            text.push_str(&super::text(&raw));
            assert_eq!(text, "12,5 µm", "{}", encoding.name());
        }
        assert_eq!(decode(b""), "");
    }

    #[test]
    fn a_reader_with_little_room_gets_everything() {
        let bytes: Vec<u8> = "部品 µm".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let (mut read, _) = recoded(Box::new(io::Cursor::new(bytes)), Encoding::named("utf-16le").ok()).unwrap();
        let mut all = Vec::new();
        let mut byte = [0];
        while read.read(&mut byte).unwrap() == 1 {
            all.push(byte[0]);
        }
        assert_eq!(text(&all), "部品 µm");
    }

    #[test]
    fn japanese_and_german_are_told_apart() {
        let (japanese, german) = ("部品番号,ラックピッチ誤差 [μm]\nP1,12.5\n", "Teil;Länge;Maß über Rolle – größer\n");
        let bytes = SHIFT_JIS.encode(japanese).0;
        assert_eq!(decode(&bytes), japanese);
        assert_eq!(Encoding::detect(&bytes).0.name(), "Shift_JIS");
        assert_eq!(Encoding::detect(&bytes).0.original(japanese.as_bytes()), bytes);
        assert_eq!(decode(&WINDOWS_1252.encode(german).0), german);
    }
}
