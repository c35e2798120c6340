//! Reads a separated table: finds the separator, the columns and the decimal mark. Called by the readers of measured
//! spaces and teeth; does not know what a column means.

use std::ops::Range;
use std::sync::Arc;

use crate::diagnostic::{Code, Diagnostic, Source};
use crate::quantity::{AngleUnit, LengthUnit, QuantityError};

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Holds {
    Index,
    Length,
    Angle,
}

/// A column that a table may have.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column {
    pub(super) name: &'static str,
    pub(super) holds: Holds,
}

/// A table with its columns found.
pub(super) struct Table<'a> {
    source: &'a Arc<Source>,
    /// For each wanted column, where it is and the unit of its header.
    found: Vec<Option<(usize, Option<String>)>>,
    columns: &'static [Column],
    rows: Vec<Row>,
    decimal_comma: bool,
}

struct Row {
    cells: Vec<String>,
    span: Range<usize>,
}

impl<'a> Table<'a> {
    /// Reads the rows of `source` and finds `columns` by the header.
    pub(super) fn read(source: &'a Arc<Source>, columns: &'static [Column]) -> Result<Self, Diagnostic> {
        let text = source.text.as_str();
        let header_line = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
        let separator = [b'\t', b';'].into_iter().find(|byte| header_line.as_bytes().contains(byte)).unwrap_or(b',');
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(separator)
            .trim(csv::Trim::All)
            .flexible(true)
            .has_headers(false)
            .from_reader(text.as_bytes());
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record
                .map_err(|error| Diagnostic::error(Code::BadTable, format!("the table cannot be read: {error}")))?;
            let start = record.position().map_or(0, |position| usize::try_from(position.byte()).unwrap_or(0));
            let start = start + text[start..].len() - text[start..].trim_start_matches(['\r', '\n']).len();
            let end = text[start..].find(['\r', '\n']).map_or(text.len(), |length| start + length);
            rows.push(Row { cells: record.iter().map(str::to_owned).collect(), span: start..end });
        }
        if rows.is_empty() {
            return Err(Diagnostic::error(Code::BadTable, format!("{} has no rows", source.name))
                .help(format!("its header names its columns: {}", names(columns))));
        }
        let header = rows.remove(0);
        let mut found = vec![None; columns.len()];
        for (index, cell) in header.cells.iter().enumerate() {
            let (name, unit) = name_and_unit(cell);
            if let Some(column) = columns.iter().position(|column| column.name == name) {
                if found[column].is_some() {
                    let message = format!("the table has two columns `{name}`");
                    return Err(Diagnostic::error(Code::BadTable, message).at(source, header.span, ""));
                }
                found[column] = Some((index, unit));
            }
        }
        if columns.iter().zip(&found).all(|(column, found)| column.holds == Holds::Index || found.is_none()) {
            let message = "the table's header names no column that is known";
            return Err(Diagnostic::error(Code::BadTable, message)
                .at(source, header.span, "")
                .help(format!("the columns are {}, with the unit behind the name: over_pin [um]", names(columns))));
        }
        let mut table = Self { source, found, columns, rows, decimal_comma: false };
        table.decimal_comma = table.has_decimal_comma(separator)?;
        Ok(table)
    }

    /// Whether numbers have a decimal comma; refuses a table in which commas could be thousands marks.
    fn has_decimal_comma(&self, separator: u8) -> Result<bool, Diagnostic> {
        let mut ambiguous = None;
        let mut certain = None;
        let mut point = None;
        for row in &self.rows {
            for (index, _) in self.found.iter().flatten() {
                let Some(cell) = row.cells.get(*index) else { continue };
                if cell.contains('.') {
                    point = Some(row);
                }
                let Some((whole, rest)) = cell.split_once(',') else { continue };
                let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
                let whole = whole.trim_start_matches(['+', '-', '\u{2212}']);
                if separator == b',' || digits != 3 || whole == "0" || whole.len() > 3 {
                    certain = Some(row);
                } else {
                    ambiguous = Some((row, cell.clone()));
                }
            }
        }
        match (certain, point, ambiguous) {
            (Some(_), None, _) => Ok(true),
            (None, _, None) => Ok(false),
            (_, Some(row), _) => Err(Diagnostic::error(Code::BadTable, "the table has decimal points and commas")
                .at(self.source, row.span.clone(), "")
                .help("write every number with a decimal point and no thousands marks")),
            (None, None, Some((row, cell))) => {
                let message = format!(
                    "`{cell}` could be {} or {}, and nothing in the table tells which",
                    cell.replace(',', "."),
                    cell.replace(',', "")
                );
                Err(Diagnostic::error(Code::BadTable, message)
                    .at(self.source, row.span.clone(), "")
                    .help("write decimal points"))
            }
        }
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.columns.iter().zip(&self.found).any(|(column, found)| column.name == name && found.is_some())
    }

    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// The bytes of a row.
    pub(super) fn span(&self, row: usize) -> Range<usize> {
        self.rows[row].span.clone()
    }

    /// The quantity in a cell; `None` if the column is not there or the cell is empty.
    pub(super) fn quantity<Q>(&self, row: usize, name: &str) -> Result<Option<Q>, Diagnostic>
    where
        Q: std::str::FromStr<Err = QuantityError>,
    {
        let Some((cell, unit)) = self.cell(row, name) else { return Ok(None) };
        let bare = cell.ends_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | ','));
        let mut text = if self.decimal_comma { cell.replacen(',', ".", 1) } else { cell.to_owned() };
        if let (true, Some(unit)) = (bare, unit) {
            text.push_str(unit);
        }
        text.parse().map(Some).map_err(|error: QuantityError| self.bad_cell(row, name, &error.to_string()))
    }

    /// The whole number in a cell; `None` if the column is not there.
    pub(super) fn index(&self, row: usize, name: &str) -> Result<Option<i64>, Diagnostic> {
        let Some((cell, _)) = self.cell(row, name) else { return Ok(None) };
        cell.parse().map(Some).map_err(|_| self.bad_cell(row, name, &format!("`{cell}` is not a whole number")))
    }

    fn cell(&self, row: usize, name: &str) -> Option<(&str, Option<&str>)> {
        let column = self.columns.iter().position(|column| column.name == name)?;
        let (index, unit) = self.found[column].as_ref()?;
        let cell = self.rows[row].cells.get(*index)?.as_str();
        (!cell.is_empty()).then_some((cell, unit.as_deref()))
    }

    pub(super) fn bad_cell(&self, row: usize, name: &str, problem: &str) -> Diagnostic {
        Diagnostic::error(Code::BadTable, format!("column `{name}`: {problem}")).at(self.source, self.span(row), "")
    }
}

fn names(columns: &[Column]) -> String {
    columns.iter().map(|column| column.name).collect::<Vec<_>>().join(", ")
}

/// A header cell's column name, in lower case with underscores, and its unit: `Over pin [µm]`,
/// `position_mm`.
pub(crate) fn name_and_unit(cell: &str) -> (String, Option<String>) {
    let cell = cell.trim().trim_start_matches('\u{feff}');
    let (name, mut unit) = match cell.find(['[', '(']) {
        Some(start) => {
            let unit = cell[start + 1..].trim_end_matches([']', ')']).trim();
            (&cell[..start], Some(unit.to_owned()))
        }
        None => (cell, None),
    };
    let mut name: String = name.trim().to_lowercase().replace([' ', '-'], "_");
    if unit.is_none()
        && let Some((stem, last)) = name.rsplit_once('_')
        && (LengthUnit::from_symbol(last).is_some() || AngleUnit::from_symbol(last).is_some())
    {
        unit = Some(last.to_owned());
        name = stem.to_owned();
    }
    (name, unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_carry_units_in_three_ways() {
        for (cell, name, unit) in [
            ("Over Pin [µm]", "over_pin", Some("µm")),
            ("lead (deg)", "lead", Some("deg")),
            ("position_mm", "position", Some("mm")),
            ("left_pitch", "left_pitch", None),
            ("\u{feff}space", "space", None),
        ] {
            assert_eq!(name_and_unit(cell), (name.to_owned(), unit.map(str::to_owned)));
        }
    }
}
