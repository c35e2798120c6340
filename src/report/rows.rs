//! The rows of a batch for people: its columns with headings in words. Called by whoever shows them as a table or a sheet.

use serde_json::Value;

use super::number::millimetres;
use super::{Block, Column, Report, Table};
use crate::deviation::key_in_words;

/// The heading of a column of results, with its unit on a line of its own.
#[must_use]
pub fn row_heading(name: &str) -> String {
    match name {
        "part_id" => return "part".to_owned(),
        "lower_mm" => return "ΔCD from\n[mm]".to_owned(),
        "upper_mm" => return "ΔCD to\n[mm]".to_owned(),
        "nearest_limit" => return "limit".to_owned(),
        _ => {}
    }
    let of = if name.starts_with("delta_cd_") { "ΔCD of " } else { "" };
    let unit = if name.ends_with("_mm") { "\n[mm]" } else { "" };
    format!("{of}{}{unit}", result_in_words(name))
}

/// What a column of results holds, in words: of `delta_cd_rack_pitch_mm` the error, of `range_upper_mm` the worst case's
/// upper end.
pub(super) fn result_in_words(name: &str) -> String {
    let name = name.trim_start_matches("delta_cd_").trim_end_matches("_mm");
    key_in_words(name).replacen("range", "worst case", 1)
}

/// Rows of results.
pub struct RowsReport<'a> {
    /// The rows; the first has the names of the columns.
    pub rows: &'a [Vec<String>],
    /// Whether lengths are shown with the decimals that they have.
    pub as_written: bool,
}

impl Report for RowsReport<'_> {
    fn json(&self) -> Value {
        self.rows.into()
    }

    fn rows(&self) -> Vec<Vec<String>> {
        self.rows.to_vec()
    }

    /// A table without the columns in which nothing stands.
    fn blocks(&self) -> Vec<Block> {
        let Some((names, rows)) = self.rows.split_first() else { return Vec::new() };
        let cell = |row: &[String], index: usize| {
            let cell = row.get(index).cloned().unwrap_or_default();
            let number = cell.parse().ok().filter(|_| names[index].ends_with("_mm") && !self.as_written);
            match number {
                Some(number) => millimetres(number),
                None if names[index] == "nearest_limit" => cell.trim_start_matches("center_distance.").to_owned(),
                None => cell,
            }
        };
        let is_filled = |index: &usize| rows.iter().any(|row| row.get(*index).is_some_and(|cell| !cell.is_empty()));
        let table = (0..names.len()).filter(is_filled).fold(Table::of(rows), |table, index| {
            let (name, heading) = (&names[index], row_heading(&names[index]));
            let column = if name.ends_with("_mm") { Column::number(heading) } else { Column::text(heading) };
            table.column_if(true, column, |row| cell(row, index))
        });
        vec![table.block()]
    }
}
