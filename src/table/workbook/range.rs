//! The part of a sheet that a user names: `A1:F200`. Given to the reader of workbooks.

use std::fmt;

/// Columns of a sheet, as Excel has them.
const MOST_COLUMNS: u32 = 16_384;

/// A part of a sheet: `A1:F200`, `B:F`, `3:90`; counted from 0, ends included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellRange {
    pub(super) columns: (u32, u32),
    pub(super) rows: (u32, u32),
}

impl Default for CellRange {
    fn default() -> Self {
        Self { columns: (0, MOST_COLUMNS - 1), rows: (0, u32::MAX) }
    }
}

impl CellRange {
    pub(super) fn has_row(&self, row: u32) -> bool {
        (self.rows.0..=self.rows.1).contains(&row)
    }

    pub(super) fn has_column(&self, column: u32) -> bool {
        (self.columns.0..=self.columns.1).contains(&column)
    }
}

impl fmt::Display for CellRange {
    /// The range as a contract has it; empty for a whole sheet.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let whole = Self::default();
        let corner = |column: u32, row: u32| {
            let column = if self.columns == whole.columns { String::new() } else { letters(column) };
            if self.rows == whole.rows { column } else { format!("{column}{}", u64::from(row) + 1) }
        };
        if *self == whole {
            return Ok(());
        }
        write!(f, "{}:{}", corner(self.columns.0, self.rows.0), corner(self.columns.1, self.rows.1))
    }
}

/// The letters of a column, from 0.
fn letters(column: u32) -> String {
    let last = char::from_digit(column % 26 + 10, 36).unwrap_or('a').to_ascii_uppercase();
    let first = (column / 26).checked_sub(1).map(letters).unwrap_or_default();
    format!("{first}{last}")
}

/// A text that is no range of cells.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a range of cells: write A1:F200, B:F or 3:90")]
pub struct NoCellRange(String);

impl std::str::FromStr for CellRange {
    type Err = NoCellRange;

    fn from_str(text: &str) -> Result<Self, NoCellRange> {
        let bad = || NoCellRange(text.to_owned());
        let (from, to) = text.split_once(':').unwrap_or((text, text));
        let whole = Self::default();
        let (from, to) = (corner(from).ok_or_else(bad)?, corner(to).ok_or_else(bad)?);
        if from.0.is_some() != to.0.is_some() || from.1.is_some() != to.1.is_some() {
            return Err(bad());
        }
        let ordered = |a: Option<u32>, b: Option<u32>, whole: (u32, u32)| match (a, b) {
            (Some(a), Some(b)) => (a.min(b), a.max(b)),
            _ => whole,
        };
        Ok(Self { columns: ordered(from.0, to.0, whole.columns), rows: ordered(from.1, to.1, whole.rows) })
    }
}

/// Column and row of `B12`, `$B$12`, `B` or `12`, from 0.
pub(super) fn corner(text: &str) -> Option<(Option<u32>, Option<u32>)> {
    let (mut column, mut letters, mut row, mut digits) = (0, 0, 0, 0);
    for byte in text.trim().bytes().filter(|byte| *byte != b'$') {
        match byte.to_ascii_uppercase() {
            letter @ b'A'..=b'Z' if digits == 0 && letters < 3 => {
                (column, letters) = (column * 26 + u32::from(letter - b'A') + 1, letters + 1);
            }
            digit @ b'0'..=b'9' if digits < 7 => (row, digits) = (row * 10 + u32::from(digit - b'0'), digits + 1),
            _ => return None,
        }
    }
    let column = (letters > 0).then(|| (column - 1).min(MOST_COLUMNS - 1));
    let row = if digits == 0 { None } else { Some(row.checked_sub(1)?) };
    (letters + digits > 0).then_some((column, row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges() {
        assert_eq!("b2:c9".parse(), Ok(CellRange { columns: (1, 2), rows: (1, 8) }));
        assert_eq!("AA:Z".parse(), Ok(CellRange { columns: (25, 26), rows: (0, u32::MAX) }));
        assert_eq!("9:3".parse(), Ok(CellRange { columns: (0, MOST_COLUMNS - 1), rows: (2, 8) }));
        for text in ["B2:C9", "AA:AZB", "XFD1:XFD1", "3:9"] {
            assert_eq!(text.parse::<CellRange>().unwrap().to_string(), text);
        }
        for text in ["", "A0:B2", "A1:B", "1A", "ABCD1", "A1:B2:C3", "A99999999"] {
            assert!(text.parse::<CellRange>().is_err(), "{text}");
        }
    }
}
