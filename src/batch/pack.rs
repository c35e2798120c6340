//! Packed output. Each chunk of rows is a gzip member or zstd frame of its own, so that workers pack side by
//! side; unpackers read one after the other as one file.

use std::borrow::Cow;
use std::io::{self, Write as _};

/// How output is packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Packing {
    /// As it is.
    #[default]
    None,
    /// gzip.
    Gzip,
    /// Zstandard.
    Zstd,
}

impl Packing {
    /// The packing that a file's name asks for, and the name without it.
    #[must_use]
    pub fn of_name(name: &str) -> (Self, &str) {
        match name.rsplit_once('.') {
            Some((stem, end)) if end.eq_ignore_ascii_case("gz") => (Self::Gzip, stem),
            Some((stem, end)) if end.eq_ignore_ascii_case("zst") => (Self::Zstd, stem),
            _ => (Self::None, name),
        }
    }

    /// Packs bytes; without bytes it writes nothing.
    pub(super) fn pack(self, bytes: &[u8]) -> io::Result<Cow<'_, [u8]>> {
        if bytes.is_empty() {
            return Ok(Cow::Borrowed(bytes));
        }
        Ok(match self {
            Self::None => Cow::Borrowed(bytes),
            Self::Gzip => {
                let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
                encoder.write_all(bytes)?;
                Cow::Owned(encoder.finish()?)
            }
            Self::Zstd => {
                Cow::Owned(ruzstd::encoding::compress_to_vec(bytes, ruzstd::encoding::CompressionLevel::Fastest))
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_tells_the_packing() {
        assert_eq!(Packing::of_name("out.csv.gz"), (Packing::Gzip, "out.csv"));
        assert_eq!(Packing::of_name("OUT.CSV.ZST"), (Packing::Zstd, "OUT.CSV"));
        assert_eq!(Packing::of_name("µgz"), (Packing::None, "µgz"));
    }
}
