//! A cell as its file holds it, before anybody knows what its column means. Made by every reader of files.

use std::borrow::Cow;
use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use super::number::{is_missing, is_number};
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::{Decimal, Unit};

/// A text of a cell. A short one, as most are, needs no memory of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum CellText {
    /// Its length and its bytes.
    Short(u8, [u8; SHORT]),
    Long(Box<str>),
}

/// Bytes of a short text at most: as many as leave a cell three words.
const SHORT: usize = 22;

impl From<&str> for CellText {
    fn from(text: &str) -> Self {
        let mut bytes = [0; SHORT];
        match (bytes.get_mut(..text.len()), u8::try_from(text.len())) {
            (Some(start), Ok(length)) => {
                start.copy_from_slice(text.as_bytes());
                Self::Short(length, bytes)
            }
            _ => Self::Long(text.into()),
        }
    }
}

impl Deref for CellText {
    type Target = str;

    fn deref(&self) -> &str {
        match self {
            Self::Short(length, bytes) => std::str::from_utf8(&bytes[..usize::from(*length)]).unwrap_or_default(),
            Self::Long(text) => text,
        }
    }
}

/// What a cell holds.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) enum Content {
    /// Nothing.
    #[default]
    Empty,
    /// Text as it is written, numbers of text files included: which character is the decimal mark is still open.
    Text(CellText),
    /// A number that its file holds as one, taken as its shortest decimal.
    Number(Decimal),
    /// A date, a time, a truth value or a formula without a result, as a message shows it: no measured value. A formula begins with
    /// `=`.
    Other(Box<str>),
    /// A number that its file shows with a unit.
    Measured(Box<(Decimal, String)>),
    /// A cell that a person sees otherwise than the file holds it: struck through, hidden, or shown as something else; in words.
    Unlike(Box<str>),
}

impl Content {
    /// A number as its shortest decimal. One that is not finite becomes text, which cannot be read as a number.
    pub(crate) fn of_f64(value: f64) -> Self {
        Decimal::of_f64(value).map_or_else(|| Self::Text(value.to_string().as_str().into()), Self::Number)
    }

    /// A text without the blanks around it; empty if nothing is left.
    pub(crate) fn of_text(text: &str) -> Self {
        let text = text.trim();
        // spreadsheets write a number that is to stay text so: ="25.060"
        let bare = text.strip_prefix("=\"").and_then(|text| text.strip_suffix('"'));
        let bare = bare.filter(|text| !text.contains('"')).map_or(text, str::trim);
        // Markdown sets these marks around bold text and code
        let within = |mark: &str| bare.strip_prefix(mark)?.strip_suffix(mark).filter(|text| !text.contains(mark));
        match within("**").or_else(|| within("`")).map_or(bare, str::trim) {
            "" => Self::Empty,
            text => Self::Text(text.into()),
        }
    }
}

impl fmt::Display for Content {
    /// As a message shows it; a number without an exponent where that is not long.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const LONGEST: usize = 24;
        let number = match self {
            Self::Empty => return Ok(()),
            Self::Text(text) => return f.write_str(text),
            Self::Other(text) | Self::Unlike(text) => return f.write_str(text),
            Self::Measured(measured) => return write!(f, "{} {}", Self::Number(measured.0), measured.1),
            Self::Number(number) => number,
        };
        let sign = if number.negative { "-" } else { "" };
        let places = usize::try_from(number.exponent.unsigned_abs()).unwrap_or(usize::MAX);
        let digits = number.digits.to_string();
        if number.exponent >= 0 && places < LONGEST - digits.len() {
            write!(f, "{sign}{digits}{}", "0".repeat(places))
        } else if number.exponent < 0 && places < LONGEST {
            let digits = format!("{digits:0>width$}", width = places + 1);
            let (whole, decimals) = digits.split_at(digits.len() - places);
            write!(f, "{sign}{whole}.{decimals}")
        } else {
            write!(f, "{sign}{digits}e{}", number.exponent)
        }
    }
}

impl From<Content> for Cell {
    /// A cell of a file that is no text.
    fn from(content: Content) -> Self {
        Self { content }
    }
}

/// A cell.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Cell {
    pub(crate) content: Content,
}

/// A row of cells, which its copies share, and the number of its line, sheet row or record, from 1.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Record {
    pub(crate) cells: Arc<[Cell]>,
    pub(crate) line: u64,
}

impl Cell {
    /// A cell of text.
    pub(crate) fn of_text(text: &str) -> Self {
        Self { content: Content::of_text(text) }
    }

    /// What a person sees there.
    pub(crate) fn text(&self) -> Cow<'_, str> {
        match &self.content {
            Content::Empty => "".into(),
            Content::Text(text) => Cow::Borrowed(text),
            Content::Other(text) | Content::Unlike(text) => Cow::Borrowed(text),
            content @ (Content::Number(_) | Content::Measured(_)) => content.to_string().into(),
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.content == Content::Empty
    }

    /// Whether it says that there is no value, or is empty.
    pub(crate) fn is_missing(&self) -> bool {
        match &self.content {
            Content::Empty => true,
            Content::Text(text) => is_missing(text),
            Content::Number(_) | Content::Measured(_) | Content::Other(_) | Content::Unlike(_) => false,
        }
    }

    /// Whether a person sees something else than the file holds.
    pub(crate) fn is_unlike(&self) -> bool {
        matches!(self.content, Content::Unlike(_))
    }

    /// Whether it is a number, or a formula without a result, which may be one. `1/1000 mm` is a unit.
    pub(crate) fn is_number(&self) -> bool {
        match &self.content {
            Content::Text(text) => is_number(text) && !(text.starts_with("1/") && Unit::from_symbol(text).is_some()),
            Content::Number(_) | Content::Measured(_) => true,
            Content::Other(text) => text.starts_with('='),
            Content::Empty | Content::Unlike(_) => false,
        }
    }
}

impl Record {
    /// A record of a file without text.
    pub(crate) fn new(cells: Vec<Cell>, line: u64) -> Self {
        Self { cells: cells.into(), line }
    }

    /// The cell at a place; an empty one where it has none.
    pub(crate) fn cell(&self, place: usize) -> &Cell {
        static EMPTY: Cell = Cell { content: Content::Empty };
        self.cells.get(place).unwrap_or(&EMPTY)
    }

    /// How many of its cells are numbers.
    pub(crate) fn numbers(&self) -> usize {
        self.cells.iter().filter(|cell| cell.is_number()).count()
    }

    /// Its cells up to the last that is not empty.
    pub(crate) fn filled(&self) -> &[Cell] {
        let end = self.cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
        &self.cells[..end]
    }

    /// Its cells in one line of text.
    pub(crate) fn in_words(&self) -> String {
        let texts: Vec<_> = self.cells.iter().map(Cell::text).filter(|text| !text.is_empty()).collect();
        texts.join(" ")
    }

    /// Whether there is nothing to read: its cells are empty, or lines drawn with `-`, `=` and the like.
    pub(crate) fn says_nothing(&self) -> bool {
        let is_line = |text: &str| text.len() > 1 && text.chars().all(|c| matches!(c, '-' | ':' | '=' | '_' | '+'));
        self.cells.iter().filter(|cell| !cell.is_empty()).all(|cell| is_line(&cell.text()))
    }
}

/// Cells of a table that is read as a whole, at most: some thousand parts with some hundred values each.
pub(crate) const MOST_CELLS: usize = 600_000;

/// How many cells records have.
pub(crate) fn cells_in(records: &[Record]) -> usize {
    records.iter().map(|record| record.cells.len()).sum()
}

/// Refuses a table that is read as a whole if it has more than [`MOST_CELLS`]; returns how many it has.
pub(crate) fn refuse_many(name: &str, cells: usize) -> Result<usize, Diagnostic> {
    if cells <= MOST_CELLS {
        return Ok(cells);
    }
    let message = format!("{name} has more than {MOST_CELLS} cells, and its parts are not in rows of their own");
    Err(Diagnostic::error(Code::BadTable, message).help("split it, or write a row per part"))
}

/// The first rows of a table of that width, from which its columns are found: fewer where they are wide.
pub(crate) fn head_rows(width: usize) -> usize {
    const MOST_ROWS: usize = 400;
    const MOST_CELLS: usize = 1 << 16;
    (MOST_CELLS / width.max(1)).clamp(1, MOST_ROWS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_are_shown_as_they_are_written() {
        for (value, text) in [
            (25.0131, "25.0131"),
            (-0.002, "-0.002"),
            (100.0, "100"),
            (1e17, "100000000000000000"),
            (0.1 + 0.2, "0.30000000000000004"),
            (-2.5e-30, "-25e-31"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(Content::of_f64(value).to_string(), text);
        }
        assert_eq!(Content::of_text(" \u{a0}"), Content::Empty);
        assert_eq!(Content::of_text(" a b "), Content::Text("a b".into()));
        assert_eq!(Content::of_text("=\"25.060\""), Content::Text("25.060".into()));
    }
}
