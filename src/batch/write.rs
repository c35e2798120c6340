//! Text in the formats of rows. Everything that writes a row calls it; it knows no columns.

use super::columns::ResultCell;
use super::number::Decimals;
use super::request::RowFormat;
use crate::diagnostic::{harmless, is_formula};
use crate::quantity::{Places, plain};
use crate::table::cell_text;

/// Writes a text with the quotes or escapes that it needs.
#[inline]
pub(super) fn text(out: &mut Vec<u8>, bytes: &[u8], format: RowFormat) {
    match format {
        RowFormat::Csv if bytes.iter().all(|byte| is_bare(*byte, b',')) => out.extend_from_slice(bytes),
        RowFormat::Tsv if bytes.iter().all(|byte| is_bare(*byte, b'\t')) => out.extend_from_slice(bytes),
        format => escaped(out, bytes, format),
    }
}

/// Whether a byte can stand in a field as it is.
#[inline]
fn is_bare(byte: u8, separator: u8) -> bool {
    matches!(byte, b' '..=b'~') && byte != separator && byte != b'"'
}

#[cold]
fn escaped(out: &mut Vec<u8>, bytes: &[u8], format: RowFormat) {
    let mut text = cell_text(bytes);
    if matches!(format, RowFormat::SafeCsv | RowFormat::SafeTsv) && is_formula(&text) {
        text.to_mut().insert(0, '\'');
    }
    let written = match format.separator().map(char::from) {
        None => serde_json::Value::from(text.as_ref()).to_string().into(),
        Some(separator) if text.bytes().any(|byte| char::from(byte) == separator || byte == b'"') => {
            format!("\"{}\"", text.replace('"', "\"\"")).into()
        }
        Some(_) => text,
    };
    out.extend_from_slice(harmless(&written).as_bytes());
}

/// The text before each value of a line of JSON.
pub(super) fn json_starts<'n>(names: impl Iterator<Item = &'n str>) -> Vec<Vec<u8>> {
    let start = |(index, name)| {
        let name = serde_json::Value::from(name).to_string();
        format!("{}{}:", if index == 0 { '{' } else { ',' }, harmless(&name))
    };
    names.enumerate().map(start).map(String::into_bytes).collect()
}

/// The text before the value of the column with that index; for JSON lines `json_start`: `{"name":` or `,"name":`.
#[inline]
pub(super) fn start(out: &mut Vec<u8>, index: usize, json_start: &[u8], format: RowFormat) {
    match format.separator() {
        None => out.extend_from_slice(json_start),
        Some(separator) if index > 0 => out.push(separator),
        Some(_) => {}
    }
}

/// The end of a row.
#[inline]
pub(super) fn end(out: &mut Vec<u8>, format: RowFormat) {
    out.extend_from_slice(if format == RowFormat::JsonLines { b"}\n" } else { b"\n" });
}

/// The value of a column.
#[expect(clippy::inline_always, reason = "with that of `rows::cell`, a tenth of the time of a table")]
#[inline(always)]
pub(super) fn cell(out: &mut Vec<u8>, cell: &ResultCell<'_>, format: RowFormat, decimals: Decimals) {
    match (cell, decimals) {
        (ResultCell::Length(length), Decimals::Places(places)) => Places::new(places.into()).write(out, *length),
        (ResultCell::Length(length), Decimals::Full) => out.extend_from_slice(plain(length.mm()).as_bytes()),
        (ResultCell::Text(bytes), _) => text(out, bytes, format),
        (ResultCell::Number(number), decimals) => out.extend_from_slice(decimals.text(*number).as_bytes()),
        (ResultCell::Flag(flag), _) => out.extend_from_slice(flag.to_string().as_bytes()),
        (ResultCell::Nothing, _) if format == RowFormat::JsonLines => out.extend_from_slice(b"null"),
        (ResultCell::Nothing, _) => {}
    }
}

/// The header row of the columns written; JSON lines have none.
pub(super) fn header(names: &[String], format: RowFormat) -> Vec<u8> {
    let mut out = Vec::new();
    if matches!(format, RowFormat::JsonLines | RowFormat::Columns) {
        return out;
    }
    for (index, name) in names.iter().enumerate() {
        start(&mut out, index, b"", format);
        text(&mut out, name.as_bytes(), format);
    }
    end(&mut out, format);
    out
}
