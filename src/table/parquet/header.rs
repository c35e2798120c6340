//! The sizes of a column's pages by their headers, which are checked before anything is unpacked. A header is a record in Thrift's
//! compact form, of which two numbers are read.

use ::parquet::file::metadata::ColumnChunkMetaData;
use bytes::Bytes;

/// Bytes of an unpacked page at most. Writers make pages of about 1 MiB.
pub(super) const LARGEST_PAGE: usize = 16 << 20;
/// Bytes in which a header is looked for: a few, and then as many as statistics of long texts take.
const WINDOWS: [usize; 2] = [1 << 12, 1 << 20];
/// How deep records of a header may be nested.
const DEEPEST: u8 = 8;
/// The byte that ends a record, in place of a field's type.
const END: u8 = 0;

/// What a header says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Header {
    /// Its own bytes.
    length: usize,
    /// Bytes of the page, unpacked and packed.
    unpacked: usize,
    packed: usize,
}

/// Checks that every page of a column in a group has a header and is not too large. `bytes` reads a range of the file.
///
/// # Errors
/// What is wrong with the first page that has none or is too large.
pub(super) fn check(chunk: &ColumnChunkMetaData, bytes: &dyn Fn(u64, usize) -> Option<Bytes>) -> Result<(), String> {
    let start = chunk.dictionary_page_offset().unwrap_or(chunk.data_page_offset());
    let [Some(start), Some(size)] = [start, chunk.compressed_size()].map(|number| u64::try_from(number).ok()) else {
        return Err("a column has no place".to_owned());
    };
    let (mut at, end) = (start, start.saturating_add(size));
    while at < end {
        let left = usize::try_from(end - at).unwrap_or(usize::MAX);
        let header = WINDOWS.into_iter().find_map(|window| header(&bytes(at, window.min(left))?));
        let header = header.ok_or("a page has no header")?;
        if header.unpacked > LARGEST_PAGE {
            return Err(format!(
                "a page of `{}` unpacks to {} MiB, and at most {} MiB are read",
                chunk.column_descr().name(),
                header.unpacked >> 20,
                LARGEST_PAGE >> 20
            ));
        }
        at = at.saturating_add((header.length + header.packed) as u64);
    }
    Ok(())
}

/// The header at the start of some bytes; `None` if they hold no complete header.
fn header(bytes: &[u8]) -> Option<Header> {
    let mut reader = Thrift { bytes, at: 0 };
    let mut found = Header::default();
    let mut id = 0;
    loop {
        match (reader.field(&mut id)?, id) {
            (END, _) => break,
            (5, 2) => found.unpacked = usize::try_from(reader.signed()?).ok()?,
            (5, 3) => found.packed = usize::try_from(reader.signed()?).ok()?,
            (kind, _) => reader.skip(kind, 0)?,
        }
    }
    Some(Header { length: reader.at, ..found })
}

/// Bytes in Thrift's compact form.
struct Thrift<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl Thrift<'_> {
    fn byte(&mut self) -> Option<u8> {
        let byte = *self.bytes.get(self.at)?;
        self.at += 1;
        Some(byte)
    }

    fn unsigned(&mut self) -> Option<u64> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(number);
            }
        }
        None
    }

    fn signed(&mut self) -> Option<i64> {
        let number = self.unsigned()?;
        Some((number >> 1).cast_signed() ^ -(number & 1).cast_signed())
    }

    /// The type of the next field, whose number is `id` from now on; [`END`] at the end of a record.
    fn field(&mut self, id: &mut i64) -> Option<u8> {
        let byte = self.byte()?;
        if byte == END {
            return Some(END);
        }
        *id = if byte >> 4 == 0 { self.signed()? } else { id.checked_add(i64::from(byte >> 4))? };
        Some(byte & 0xf).filter(|&kind| kind != END)
    }

    /// Passes over a value of a type.
    fn skip(&mut self, kind: u8, depth: u8) -> Option<()> {
        if depth > DEEPEST {
            return None;
        }
        match kind {
            1 | 2 => {}
            3 => self.at += 1,
            4..=6 => _ = self.unsigned()?,
            7 => self.at += 8,
            8 => {
                let length = usize::try_from(self.unsigned()?).ok()?;
                self.at = self.at.checked_add(length)?;
            }
            9 | 10 => {
                let byte = self.byte()?;
                let count = if byte >> 4 == 15 { self.unsigned()? } else { u64::from(byte >> 4) };
                // each takes a byte at least
                (count <= self.bytes.len() as u64).then_some(())?;
                for _ in 0..count {
                    self.skip(byte & 0xf, depth + 1)?;
                    (self.at <= self.bytes.len()).then_some(())?;
                }
            }
            12 => {
                let mut id = 0;
                loop {
                    match self.field(&mut id)? {
                        END => break,
                        kind => self.skip(kind, depth + 1)?,
                    }
                }
            }
            _ => return None,
        }
        (self.at <= self.bytes.len()).then_some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_of_a_page() {
        // type, 300 bytes unpacked, 64 packed, a record with a number and a text, the end
        let bytes = [0x15, 0x04, 0x15, 0xd8, 0x04, 0x15, 0x80, 0x01, 0x2c, 0x15, 0x02, 0x18, 0x02, 1, 2, 0, 0, 9, 9];
        assert_eq!(header(&bytes), Some(Header { length: 17, unpacked: 300, packed: 64 }));
        for length in 0..17 {
            assert_eq!(header(&bytes[..length]), None, "{length}");
        }
        assert_eq!(header(&[0x19, 0xfc, 0xff, 0xff, 0xff, 0xff, 0x0f]), None);
        assert_eq!(header(&[0x1c; 40]), None);
    }
}
