//! Where records and fields end: the grammar of separated values.
//!
//! A field that starts with a quote ends at the next single quote (two stand for one). What follows it up to the separator belongs
//! to the field as it is; blanks before the first quote do not. Quotes elsewhere are plain characters. A record ends at a line feed,
//! a carriage return, or both. Lines without a character are no records. Apart from the blanks, these are the rules of the `csv`
//! crate, with which the tests compare.

use std::borrow::Cow;

/// Where a field's bytes are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Field {
    pub(crate) start: usize,
    pub(crate) end: usize,
    /// Whether it starts with a quote.
    pub(crate) quoted: bool,
}

impl Field {
    /// The bytes that the field stands for.
    pub(crate) fn content<'a>(&self, bytes: &'a [u8]) -> Cow<'a, [u8]> {
        let raw = &bytes[self.start..self.end];
        if !self.quoted {
            return raw.into();
        }
        let close = behind_quote(raw, 1);
        let (inside, behind) = raw.split_at(close.unwrap_or(raw.len()));
        let inside = &inside[1..inside.len() - usize::from(close.is_some())];
        // of quotes inside, two stand for one
        let mut quotes = 0;
        let is_content = |byte: &&u8| {
            quotes += usize::from(**byte == b'"');
            **byte != b'"' || quotes % 2 == 1
        };
        inside.iter().filter(is_content).chain(behind).copied().collect()
    }
}

/// One record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Record {
    /// The first byte of the first field.
    pub(crate) start: usize,
    /// The byte behind the line end.
    pub(crate) next: usize,
    /// Line ends before the record's first byte.
    pub(crate) lines_before: u64,
    /// Line ends in all, that of the record included.
    pub(crate) lines: u64,
    /// Whether a quote was not closed.
    pub(crate) open: bool,
    /// Whether a line end closed it. Otherwise more bytes may belong to it.
    pub(crate) closed: bool,
}

/// The next record from `at` on, with its fields; `None` if nothing but line ends is left (their number goes
/// to `lines`).
pub(crate) fn next_record(
    bytes: &[u8],
    at: usize,
    separator: u8,
    fields: &mut Vec<Field>,
    lines: &mut u64,
) -> Option<Record> {
    fields.clear();
    let mut at = at;
    let mut lines_before = 0;
    while let Some(length) = line_end(bytes, at) {
        at += length;
        lines_before += 1;
    }
    *lines = lines_before;
    if at >= bytes.len() {
        return None;
    }
    let start = at;
    let mut inner_lines = 0;
    loop {
        at = at_quote(bytes, at).unwrap_or(at);
        let field = at;
        let quoted = bytes.get(at) == Some(&b'"');
        let mut open = false;
        if quoted {
            let end = behind_quote(bytes, at + 1);
            open = end.is_none();
            let end = end.unwrap_or(bytes.len());
            inner_lines += count_line_ends(&bytes[at + 1..end]);
            at = end;
        }
        // most fields are short: byte by byte is as fast as any other way
        while let Some(&byte) = bytes.get(at) {
            if byte == separator || byte == b'\n' || byte == b'\r' {
                break;
            }
            at += 1;
        }
        fields.push(Field { start: field, end: at, quoted });
        if bytes.get(at) == Some(&separator) {
            at += 1;
            continue;
        }
        let length = line_end(bytes, at);
        // a carriage return at the very end may be followed by a line feed that was not read yet
        let closed = length.is_some() && !(length == Some(1) && bytes[at] == b'\r' && at + 1 == bytes.len());
        let next = at + length.unwrap_or(0);
        let lines = lines_before + inner_lines + u64::from(length.is_some());
        return Some(Record { start, next, lines_before, lines, open, closed });
    }
}

/// The place of a quote that stands behind blanks.
pub(crate) fn at_quote(bytes: &[u8], at: usize) -> Option<usize> {
    let blanks = bytes[at..].iter().take_while(|byte| **byte == b' ').count();
    (blanks > 0 && bytes.get(at + blanks) == Some(&b'"')).then_some(at + blanks)
}

/// The place behind the quote that closes a field whose inside starts at `at`; `None` if there is none.
fn behind_quote(bytes: &[u8], mut at: usize) -> Option<usize> {
    loop {
        let quote = at + memchr::memchr(b'"', &bytes[at..])?;
        if bytes.get(quote + 1) != Some(&b'"') {
            return Some(quote + 1);
        }
        at = quote + 2;
    }
}

/// The length of the line end at `at`, if there is one.
fn line_end(bytes: &[u8], at: usize) -> Option<usize> {
    match bytes.get(at)? {
        b'\r' if bytes.get(at + 1) == Some(&b'\n') => Some(2),
        b'\r' | b'\n' => Some(1),
        _ => None,
    }
}

/// Lines that end within some bytes.
pub(crate) fn count_line_ends(bytes: &[u8]) -> u64 {
    if memchr::memchr(b'\r', bytes).is_none() {
        return memchr::memchr_iter(b'\n', bytes).count() as u64;
    }
    let mut count = 0;
    for at in memchr::memchr2_iter(b'\n', b'\r', bytes) {
        // the line feed of a pair was counted with its carriage return
        count += u64::from(bytes[at] == b'\r' || at == 0 || bytes[at - 1] != b'\r');
    }
    count
}

/// Whether every record is one line that ends in a line feed: no quotes, and no carriage return but before a
/// line feed.
pub(crate) fn is_plain(bytes: &[u8]) -> bool {
    memchr::memchr(b'"', bytes).is_none()
        && memchr::memchr_iter(b'\r', bytes).all(|at| bytes.get(at + 1) == Some(&b'\n'))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Every record, and the number of lines.
    fn records(bytes: &[u8]) -> (Vec<Vec<Vec<u8>>>, u64) {
        let (mut all, mut fields) = (Vec::new(), Vec::new());
        let (mut at, mut lines) = (0, 0);
        let mut blank = 0;
        while let Some(record) = next_record(bytes, at, b',', &mut fields, &mut blank) {
            all.push(fields.iter().map(|field| field.content(bytes).into_owned()).collect());
            at = record.next;
            lines += record.lines;
        }
        (all, lines + blank)
    }

    fn by_csv(bytes: &[u8]) -> Vec<Vec<Vec<u8>>> {
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(bytes);
        reader.byte_records().map(|record| record.unwrap().iter().map(<[u8]>::to_vec).collect()).collect()
    }

    #[test]
    fn as_the_csv_crate_splits() {
        for text in [
            "a,b\n1,2\n",
            "a,b\r\n\r\n1,2",
            "a\rb\rc",
            "\"a\nb\",\"c\"\"d\"\n,\n",
            "\"\",x\"y\"\n\"a\"b,c\n",
            "a,\"b\"x\"y\n",
            "\n\n\n",
            ",,\n",
            "\"open\n1,2\n",
            "",
        ] {
            assert_eq!(records(text.as_bytes()).0, by_csv(text.as_bytes()), "{text:?}");
        }
    }

    #[test]
    fn blanks_before_a_quote_are_none_of_the_field() {
        let fields = |text: &str| records(text.as_bytes()).0;
        assert_eq!(fields("R1, \"25,0\",  \"4\"\"\n\"\n \"a\"\n"), by_csv(b"R1,\"25,0\",\"4\"\"\n\"\n\"a\"\n"));
        assert_eq!(fields(" a, b\"c\" ,"), by_csv(b" a, b\"c\" ,"));
    }

    #[test]
    fn lines_are_counted_inside_quotes_too() {
        assert_eq!(records(b"a\r\n\"x\ny\r\nz\rw\"\n\nb").1, 6);
    }

    proptest! {
        #[test]
        fn as_the_csv_crate_splits_anything(text in "[a,\"\n\r;é]{0,40}") {
            prop_assert_eq!(records(text.as_bytes()).0, by_csv(text.as_bytes()));
        }
    }
}
