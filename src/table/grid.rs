//! A text cut into records and cells, once for each separator that it may have. Called by
//! [`understand`](super::understand); knows no names.

use std::ops::Range;

use super::cell::{Cell, Record};
use super::fixed::placed;
use super::number::{Marks, marks};
use super::split::{Field, next_record};
use crate::quantity::Unit;

/// What stands between the cells of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    /// A character: a tab as spreadsheets copy it, a semicolon, a comma, a bar.
    Character(u8),
    /// Two or more blanks.
    AlignedBlanks,
    /// Single blanks.
    Blanks,
    /// One value per line.
    Lines,
    /// Words: each line says what was measured.
    Sentences,
}

impl Separator {
    /// Tabs.
    pub const TAB: Self = Self::Character(b'\t');
    /// Commas.
    pub const COMMA: Self = Self::Character(b',');

    /// The byte between the fields of a row; a tab where that is no single one.
    pub(crate) const fn byte(self) -> u8 {
        match self {
            Self::Character(byte) => byte,
            Self::AlignedBlanks | Self::Blanks | Self::Lines | Self::Sentences => b'\t',
        }
    }

    /// In words.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Character(b'\t') => "tabs".to_owned(),
            Self::Character(b';') => "semicolons".to_owned(),
            Self::Character(b'|') => "vertical bars".to_owned(),
            Self::Character(b',') => "commas".to_owned(),
            Self::Character(byte) => format!("`{}`", char::from(byte)),
            Self::AlignedBlanks => "aligned blanks".to_owned(),
            Self::Blanks => "blanks".to_owned(),
            Self::Lines => "one value per line".to_owned(),
            Self::Sentences => "sentences".to_owned(),
        }
    }
}

/// The separators that the text may have, the surest first.
pub(crate) fn separators(text: &str) -> Vec<Separator> {
    let marks = [b'\t', b';', b'|', b','].into_iter().filter(|mark| text.contains(char::from(*mark)));
    let mut found: Vec<_> = marks.map(Separator::Character).collect();
    if text.lines().any(|line| line.trim().contains("  ")) {
        found.push(Separator::AlignedBlanks);
    }
    found.extend([Separator::Lines, Separator::Blanks, Separator::Sentences]);
    found
}

/// The records of `text`; those of a character stand as the streaming reader cuts them, so that the number of a record
/// means the same to both.
///
/// # Errors
/// If a quote is not closed: its line.
pub(crate) fn records(text: &str, separator: Separator) -> Result<Vec<Record>, u64> {
    match separator {
        Separator::Character(byte) => separated(text, byte),
        Separator::AlignedBlanks => Ok(placed(by_line(text, separator))),
        separator => Ok(by_line(text, separator)),
    }
}

fn trimmed(text: &str, span: Range<usize>) -> Cell {
    let cell = &text[span.clone()];
    let start = span.start + cell.len() - cell.trim_start().len();
    let trimmed = cell.trim();
    Cell::of_text(trimmed, start..start + trimmed.len())
}

fn separated(text: &str, separator: u8) -> Result<Vec<Record>, u64> {
    let bytes = text.as_bytes();
    let (mut records, mut fields) = (Vec::new(), Vec::new());
    let (mut at, mut lines, mut blank, mut open_quote) = (0, 0, 0, None);
    while let Some(found) = next_record(bytes, at, separator, &mut fields, &mut blank) {
        let cells = fields
            .iter()
            .map(|field| {
                if field.quoted {
                    let content = String::from_utf8_lossy(&field.content(bytes)).into_owned();
                    // a word that is divided at the end of a line is one word
                    let content = content.replace("-\r\n", "-").replace("-\n", "-");
                    let words: Vec<_> = content.split_whitespace().collect();
                    Cell::of_text(&words.join(" "), field.start..field.end)
                } else {
                    trimmed(text, field.start..field.end)
                }
            })
            .collect();
        // rows inside a quote are rows that it swallows
        let is_row = |line: &[u8]| line.contains(&separator);
        let swallows =
            |field: &Field| field.quoted && bytes[field.start..field.end].split(|b| *b == b'\n').skip(1).any(is_row);
        if found.open || fields.iter().any(swallows) {
            open_quote.get_or_insert(lines + found.lines_before + 1);
        }
        records.push(Record { cells, line: lines + found.lines_before + 1, start: found.start });
        lines += found.lines;
        at = found.next;
    }
    open_quote.map_or(Ok(records), Err)
}

fn by_line(text: &str, separator: Separator) -> Vec<Record> {
    let mut records = Vec::new();
    let mut start = 0;
    for (index, whole) in text.split_inclusive('\n').enumerate() {
        let line_start = start;
        let line = trimmed(text, start..start + whole.len());
        start += whole.len();
        if line.is_empty() {
            continue;
        }
        let cells = match separator {
            Separator::Lines => vec![unquoted(line)],
            Separator::Sentences => vec![line],
            Separator::AlignedBlanks => aligned(text, &line.span),
            _ => joined(text, &tokens(text, &line.span)),
        };
        records.push(Record { cells, line: index as u64 + 1, start: line_start });
    }
    records
}

/// A line that is one cell in quotes, without them.
fn unquoted(line: Cell) -> Cell {
    let text = line.text();
    match text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).filter(|inner| !inner.contains('"')) {
        Some(inner) => Cell::of_text(inner.trim(), line.span.clone()),
        None => line,
    }
}

/// Cells between runs of two or more blanks.
fn aligned(text: &str, span: &Range<usize>) -> Vec<Cell> {
    let mut cells = Vec::new();
    let mut start = span.start;
    while start < span.end {
        let end = text[start..span.end].find("  ").map_or(span.end, |length| start + length);
        cells.push(trimmed(text, start..end));
        start = span.end - text[end..span.end].trim_start().len();
    }
    cells
}

/// Cells between single blanks.
fn tokens(text: &str, span: &Range<usize>) -> Vec<Cell> {
    let mut cells = Vec::new();
    let mut start = span.start;
    // a name and its value may be joined by a mark, pitch=12, and a time has one: 9:12
    let is_digit = |c: char| c.is_ascii_digit();
    let breaks = |token: Range<usize>, c: char| {
        let is_last = token.end + c.len_utf8() == span.end;
        let token = text[token].trim_start_matches(['[', '(']);
        let is_inside = token.starts_with(is_digit) && token.ends_with(is_digit) && !is_last;
        matches!(c, '=' | ':' | '\u{ff1a}') && !is_inside
    };
    let characters = text[span.clone()].char_indices().map(|(offset, c)| (span.start + offset, c));
    for (at, c) in characters.chain([(span.end, ' ')]) {
        // blanks other than the plain one and the tab stand inside numbers
        if matches!(c, ' ' | '\t' | '\r' | '\u{3000}') || breaks(start..at, c) {
            if start < at {
                cells.push(trimmed(text, start..at));
            }
            start = at + c.len_utf8();
        }
    }
    // a sentence may end with a unit
    if let Some(last) = cells.last_mut() {
        let word = &text[last.span.clone()];
        let bare = without_end(word);
        // a question leaves the value open
        if !word.contains('?') && is_unit(bare) && !is_unit(word) {
            *last = trimmed(text, last.span.start..last.span.start + bare.len());
        }
    }
    cells
}

/// A text without the mark at the end of a sentence.
pub(crate) fn without_end(text: &str) -> &str {
    text.trim_end_matches(['.', ',', ';', ':', '!', '?', '。'])
}

/// Whether a text is a unit of length or angle, in brackets or not.
pub(crate) fn is_unit(text: &str) -> bool {
    Unit::from_symbol(bare_unit(text)).is_some()
}

/// The first of some cells, if all that say something are units.
pub(crate) fn only_units(cells: &[Cell]) -> Option<&Cell> {
    let mut cells = cells.iter().filter(|cell| !cell.is_missing());
    let first = cells.next().filter(|first| is_unit(&first.text()))?;
    cells.all(|cell| is_unit(&cell.text())).then_some(first)
}

/// A unit without its brackets.
pub(crate) fn bare_unit(text: &str) -> &str {
    text.trim().trim_matches(['[', ']', '(', ')']).trim()
}

/// Tokens put together again: a sign and its number, a number and its unit, groups of thousands, words of a label.
fn joined(text: &str, tokens: &[Cell]) -> Vec<Cell> {
    let is_sign = |text: &str| matches!(text, "+" | "-" | "\u{2212}" | "\u{2013}" | "<" | ">" | "≤" | "≥");
    let mut cells: Vec<Cell> = Vec::new();
    let has_number = tokens.iter().any(Cell::is_number);
    for (at, token) in tokens.iter().enumerate() {
        let next = token.text();
        let join = cells.last().is_some_and(|last| {
            let before = last.text();
            let signed = is_sign(&before) && token.is_number();
            let is_word = next == "um" && (is_date(&before) || is_time(&tokens[at + 1..]));
            let united = is_unit(&next) && !is_word && (marks(&before) != Marks::None || next.starts_with(['[', '(']));
            let worded = has_number
                && marks(&before) == Marks::None
                && marks(&next) == Marks::None
                && !is_sign(&next)
                && cells.len() == 1;
            signed || united || worded
        });
        match cells.last_mut() {
            Some(last) if join => *last = trimmed(text, last.span.start..token.span.end),
            _ => cells.push(token.clone()),
        }
    }
    cells
}

/// Whether a word is a day, behind which `um` is a word: `11.03.2026 um`.
pub(crate) fn is_date(word: &str) -> bool {
    word.split('.').count() == 3 && word.split('.').all(|part| part.parse::<u16>().is_ok())
}

/// Whether a word is a time of day: `9:12`, `14:22:05`.
pub(crate) fn is_clock(word: &str) -> bool {
    let is_part = |part: &str| matches!(part.len(), 1..=2) && part.parse::<u8>().is_ok();
    word.contains(':') && word.split(':').all(is_part)
}

/// Whether tokens begin with a time of day: `9:12`, `9 Uhr`.
fn is_time(tokens: &[Cell]) -> bool {
    let is_hour = |first: &Cell| first.text().starts_with(|c: char| c.is_ascii_digit());
    tokens.first().is_some_and(is_hour)
        && (tokens[0].text().contains(':') || tokens.get(1).is_some_and(|unit| unit.text().starts_with("Uhr")))
}

/// The unit behind a number; a sentence may end there: `195 µm.`
pub(crate) fn unit_in(text: &str) -> Option<String> {
    let text = without_end(text);
    let last = text.rfind(|c: char| c.is_numeric() || matches!(c, '.' | ','))?;
    let unit = text[last..].trim_start_matches(|c: char| c.is_numeric() || matches!(c, '.' | ',')).trim();
    (!unit.is_empty()).then(|| unit.to_owned())
}

/// Whether two units are both there and are not the same.
pub(crate) fn differ(one: Option<&str>, other: Option<&str>) -> bool {
    let Some((one, other)) = one.zip(other) else { return false };
    let (one, other) = (bare_unit(one), bare_unit(other));
    one != other && (Unit::from_symbol(one).is_none() || Unit::from_symbol(one) != Unit::from_symbol(other))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(text: &str, separator: Separator) -> Vec<Vec<String>> {
        let records = records(text, separator).unwrap();
        records.into_iter().map(|record| record.cells.iter().map(|cell| cell.text().into_owned()).collect()).collect()
    }

    #[test]
    fn cells_of_every_separator() {
        let semicolons = Separator::Character(b';');
        assert_eq!(cells("a\tb\r\n1,5\t\n", Separator::TAB), [vec!["a", "b"], vec!["1,5", ""]]);
        assert_eq!(
            cells("\"pitch\n[µm]\";\"1,5\"\n12° 30' 15\";2", semicolons),
            [vec!["pitch [µm]", "1,5"], vec!["12° 30' 15\"", "2"]]
        );
        assert_eq!(cells("a b   c\n1     - 2 um", Separator::AlignedBlanks), [vec!["a b", "c"], vec!["1", "- 2 um"]]);
        assert_eq!(cells("rack pitch: - 12,5 µm 13 µm", Separator::Blanks), [vec!["rack pitch", "- 12,5 µm", "13 µm"]]);
        assert_eq!(cells("a \"b\" c\n\n", Separator::Lines), [vec!["a \"b\" c"]]);
        assert_eq!(cells("\"a\"\n \"25,013\"\r\n\"b\" c\n", Separator::Lines), [["a"], ["25,013"], ["\"b\" c"]]);
    }
}
