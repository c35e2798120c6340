//! Rows of a report as a Q-DAS file: lengths become characteristics, for the statistics software that the values came
//! from.

use super::WITHOUT;
use crate::deviation::key_in_words;
use crate::judge::{LimitTarget, Limits};
use crate::quantity::Length;
use crate::table::qdas::{CharacteristicColumn, PartDefinition, ValueRow, definition_lines, row_lines};

/// A `.dfq` of rows with a header: the columns in mm and degrees, with the limits that hold for them, a row per part
/// named by its `part_id` (or its first column). That errors were left out, and why a part has no verdict, are remarks.
#[derive(Debug)]
pub struct QdasRows {
    title: String,
    limits: Limits,
    header: Vec<String>,
    is_defined: bool,
}

impl QdasRows {
    /// No rows yet, not even the header.
    #[must_use]
    pub fn new(title: &str, limits: &Limits) -> Self {
        Self { title: title.to_owned(), limits: limits.clone(), header: Vec::new(), is_defined: false }
    }

    /// The file's lines of the next row: none of the header, and the definitions before those of the first row.
    pub fn lines(&mut self, row: &[&str]) -> Vec<u8> {
        if self.header.is_empty() {
            self.header = row.iter().map(|&name| name.to_owned()).collect();
            return Vec::new();
        }
        let mut lines = Vec::new();
        if !std::mem::replace(&mut self.is_defined, true) {
            lines = self.definitions(row);
        }
        let position = |wanted: &str| self.header.iter().position(|name| name == wanted);
        let values = self.lengths().map(|(index, ..)| text(row, Some(index)).parse().ok());
        let name = text(row, position("part_id").or(Some(0)));
        lines.extend(row_lines(&ValueRow { name, values: values.collect(), remark: text(row, position("reason")) }));
        lines
    }

    /// The columns in mm and degrees: their index, name and unit.
    fn lengths(&self) -> impl Iterator<Item = (usize, &str, &str)> {
        self.header.iter().enumerate().filter_map(|(index, name)| {
            let (stem, unit) = name.rsplit_once('_').filter(|(_, unit)| matches!(*unit, "mm" | "deg"))?;
            Some((index, stem, unit))
        })
    }

    /// The head of the file. All parts of a table are judged without the same errors.
    fn definitions(&self, first_row: &[&str]) -> Vec<u8> {
        let column = |(index, stem, unit): (usize, &str, &str)| {
            let limited = |target: &LimitTarget| match target {
                LimitTarget::CenterDistance => stem == "range_lower" || stem == "range_upper",
                LimitTarget::Error(kind) => stem.strip_prefix("delta_cd_") == Some(kind.key()),
            };
            let limit = self.limits.iter().find(|(target, _)| limited(target)).map(|(_, limit)| limit);
            let end = |end: fn(&crate::judge::Limit) -> Option<Length>| limit.and_then(end).map(Length::mm);
            CharacteristicColumn {
                number: self.header[index].clone(),
                name: key_in_words(stem).replace("delta cd", "Delta CD"),
                unit: unit.to_owned(),
                nominal: None,
                lower: end(|limit| limit.lower),
                upper: end(|limit| limit.upper),
            }
        };
        let columns: Vec<_> = self.lengths().map(column).collect();
        let part =
            PartDefinition { number: self.title.clone(), name: "rackmesh".to_owned(), ..PartDefinition::default() };
        let remark = match text(first_row, self.header.iter().position(|name| name == WITHOUT)) {
            "" => String::new(),
            keys => format!("judged without {keys} (--partial)"),
        };
        definition_lines(&part, &remark, &columns)
    }
}

/// The cell of a column, if there is one.
fn text<'r>(row: &[&'r str], column: Option<usize>) -> &'r str {
    column.and_then(|column| row.get(column)).map_or("", |text| *text)
}
