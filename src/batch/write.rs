//! Text as the formats of rows write it. Called by whatever writes a row; knows no columns.

use super::buffer::Buffer;
use super::request::RowFormat;
use crate::table::cell_text;

/// Writes a text with the quotes or escapes that it needs.
#[inline]
pub(super) fn text(out: &mut Buffer, bytes: &[u8], format: RowFormat) {
    match format {
        RowFormat::Csv if bytes.iter().all(|byte| is_bare(*byte, b',')) => out.extend(bytes),
        RowFormat::Tsv if bytes.iter().all(|byte| is_bare(*byte, b'\t')) => out.extend(bytes),
        _ => escaped(out, bytes, format),
    }
}

/// Whether a byte can stand in a field as it is.
#[inline]
fn is_bare(byte: u8, separator: u8) -> bool {
    byte.is_ascii() && byte != separator && !matches!(byte, b'"' | b'\n' | b'\r')
}

#[cold]
fn escaped(out: &mut Buffer, bytes: &[u8], format: RowFormat) {
    let text = cell_text(bytes);
    let separator = match format {
        RowFormat::JsonLines => return out.extend(serde_json::Value::from(text.as_ref()).to_string().as_bytes()),
        RowFormat::Csv => ',',
        RowFormat::Tsv => '\t',
    };
    if text.contains([separator, '"', '\n', '\r']) {
        out.extend(b"\"");
        out.extend(text.replace('"', "\"\"").as_bytes());
        out.extend(b"\"");
    } else {
        out.extend(text.as_bytes());
    }
}

/// The header row of the columns written; JSON lines have none.
pub(super) fn header(names: &[String], format: RowFormat) -> Vec<u8> {
    let separator = match format {
        RowFormat::JsonLines => return Vec::new(),
        RowFormat::Csv => b",",
        RowFormat::Tsv => b"\t",
    };
    let mut out = Buffer::default();
    for (index, name) in names.iter().enumerate() {
        if index > 0 {
            out.extend(separator);
        }
        text(&mut out, name.as_bytes(), format);
    }
    out.extend(b"\n");
    out.written().to_vec()
}
