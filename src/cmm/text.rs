//! Bytes as text, whatever encoding an office program chose. Called by every reader of small files and blocks.

use std::borrow::Cow;

/// The text of `bytes`: UTF-16 if it starts with that byte order mark, else UTF-8, else Latin-1, which no text is too
/// strange for. Byte order marks are left out.
#[must_use]
pub fn decode(bytes: &[u8]) -> Cow<'_, str> {
    let utf16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units = bytes.chunks(2).map(|pair| unit([pair[0], pair.get(1).copied().unwrap_or(0)]));
        char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect::<String>()
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes).into(),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes).into(),
        [0xef, 0xbb, 0xbf, rest @ ..] | rest => match std::str::from_utf8(rest) {
            Ok(text) => text.into(),
            Err(_) => rest.iter().map(|byte| char::from(*byte)).collect::<String>().into(),
        },
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
        }
        assert_eq!(decode(b"\xff\xfea"), "a");
        assert_eq!(decode(b""), "");
    }
}
