//! Separators of cells, text cut into cells by them, and units as cells write them. Knows no headings.

use super::cell::{Cell, MOST_CELLS, Record};
use super::encoding::text;
use super::fixed::{aligned, placed};
use super::split::next_record;
use crate::quantity::Unit;

/// What stands between the cells of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    /// A character: a tab as spreadsheets copy it, a semicolon, a comma, a bar.
    Character(u8),
    /// Two or more blanks.
    AlignedBlanks,
    /// One value per line.
    Lines,
}

impl Separator {
    /// The byte between the fields of a row; a tab where no single byte stands there.
    pub(crate) const fn byte(self) -> u8 {
        match self {
            Self::Character(byte) => byte,
            Self::AlignedBlanks | Self::Lines => b'\t',
        }
    }

    /// The byte that a text names: itself, or `tab`.
    ///
    /// # Errors
    /// If it is not one character, or one that numbers or names contain.
    pub fn byte_of(text: &str) -> Result<u8, String> {
        match text.as_bytes() {
            b"tab" | b"\\t" => Ok(b'\t'),
            [byte]
                if byte.is_ascii()
                    && !byte.is_ascii_alphanumeric()
                    && !matches!(byte, b'"' | b'\n' | b'\r' | b'.' | b'-') =>
            {
                Ok(*byte)
            }
            _ => Err("write one character such as ; or the word tab".to_owned()),
        }
    }

    /// The word that declares it; `None` if no word does. A text without tabs has one value per line if tabs separate its cells.
    pub(crate) fn word(self) -> Option<String> {
        match self {
            Self::Character(b'\t') | Self::Lines => Some("tab".to_owned()),
            Self::Character(byte) => Some(char::from(byte).to_string()),
            Self::AlignedBlanks => None,
        }
    }

    /// Its name in messages.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Character(b'\t') => "tabs".to_owned(),
            Self::Character(b';') => "semicolons".to_owned(),
            Self::Character(b'|') => "vertical bars".to_owned(),
            Self::Character(b',') => "commas".to_owned(),
            Self::Character(byte) => format!("`{}`", char::from(byte)),
            Self::AlignedBlanks => "aligned blanks".to_owned(),
            Self::Lines => "one value per line".to_owned(),
        }
    }
}

/// The records of a text whose cells stand between two or more blanks, behind so many lines. Ends like [`separated`].
pub(crate) fn aligned_records(text: &str, lines: u64) -> Vec<Record> {
    let (mut records, mut lines_of, mut count) = (Vec::new(), Vec::new(), 0);
    for (line, number) in text.lines().zip(lines + 1..) {
        if count > MOST_CELLS {
            break;
        }
        let cells = aligned(line);
        if !cells.is_empty() {
            count += cells.len();
            lines_of.push(line);
            records.push(Record::new(cells.into_iter().map(|(_, cell)| cell).collect(), number));
        }
    }
    placed(records, &lines_of)
}

/// The records of a text whose cells stand between such bytes, and where each ends. `is_all`: the text is complete, so that its last
/// record needs no line end. Nothing is cut behind [`MOST_CELLS`].
pub(crate) fn separated(bytes: &[u8], separator: u8, is_all: bool, lines: u64) -> (Vec<Record>, Vec<usize>) {
    let (mut found, mut ends, mut fields) = (Vec::new(), Vec::new(), Vec::new());
    let (mut at, mut blank, mut line, mut count) = (0, 0, lines, 0);
    while count <= MOST_CELLS
        && let Some(record) = next_record(bytes, at, separator, &mut fields, &mut blank)
    {
        if !record.closed && !is_all {
            break;
        }
        count += fields.len();
        let cells = fields.iter().map(|field| Cell::of_text(text(&field.content(bytes)).trim())).collect();
        found.push(Record::new(cells, line + record.lines_before + 1));
        (at, line) = (record.next, line + record.lines);
        ends.push(at);
    }
    (found, ends)
}

/// Whether a text is a unit of length or angle, in brackets or not.
pub(crate) fn is_unit(text: &str) -> bool {
    Unit::from_symbol(bare_unit(text)).is_some()
}

/// The first unit among some cells, if each of them is a unit or has no value.
pub(crate) fn only_units(cells: &[Cell]) -> Option<&Cell> {
    let mut cells = cells.iter().filter(|cell| !cell.is_missing());
    let first = cells.next().filter(|first| is_unit(&first.text()))?;
    cells.all(|cell| is_unit(&cell.text())).then_some(first)
}

/// A unit without its brackets.
pub(crate) fn bare_unit(text: &str) -> &str {
    text.trim().trim_matches(['[', ']', '(', ')']).trim()
}

/// The unit that a symbol names: of a length, or, for an angle, of an angle or of the length in which f_Hβ is given.
pub(crate) fn unit_of(symbol: &str, is_angle: bool) -> Option<Unit> {
    // `my` is the German name of µ
    let symbol = match bare_unit(symbol) {
        "my" | "µ m" | "0,001 mm" | "0.001 mm" | "0,001mm" | "0.001mm" => "µm",
        "0,01 mm" | "0.01 mm" => "1/100 mm",
        symbol => symbol,
    };
    if is_angle { Unit::of_angle(symbol).or_else(|| Unit::of_length(symbol)) } else { Unit::of_length(symbol) }
}

/// The unit behind a number. A full stop or the like may follow it: `195 µm.`
pub(crate) fn unit_in(text: &str) -> Option<String> {
    let text = text.trim_end_matches(['.', ',', ';', ':', '!', '?', '。']);
    let last = text.rfind(|c: char| c.is_numeric() || matches!(c, '.' | ','))?;
    let unit = text[last..].trim_start_matches(|c: char| c.is_numeric() || matches!(c, '.' | ',')).trim();
    (!unit.is_empty()).then(|| unit.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_aligned_text() {
        let records = aligned_records("a b   c\n1     - 2 um\n", 0);
        let cells = |record: &Record| record.cells.iter().map(|cell| cell.text().into_owned()).collect::<Vec<_>>();
        assert_eq!(records.iter().map(cells).collect::<Vec<_>>(), [["a b", "c"], ["1", "- 2 um"]]);
    }
}
