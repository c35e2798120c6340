//! The rows of a batch for people, with headings in words: for tables and sheets.

use serde_json::Value;

use super::number::{millimetres, signed, tidy};
use super::{Block, Column, Report, Table};
use crate::deviation::key_in_words;
use crate::quantity::{Rounded, Unit};

/// The endings of result names with a unit, and the unit.
const UNITS: [(&str, &str); 5] = [("_mm", "mm"), ("_um", "µm"), ("_deg", "°"), ("_n_m", "N m"), ("_n", "N")];

/// A column's name without its unit, and the unit, which is empty where it has none. A key of the spec may have any unit.
fn name_and_unit(name: &str) -> (&str, &str) {
    let of_result = || UNITS.iter().find_map(|(end, unit)| Some((name.strip_suffix(end)?, *unit)));
    let is_unit = |unit: &str| Unit::from_symbol(unit).is_some() || unit.starts_with('N');
    let of_key = name.rsplit_once('_').filter(|(key, unit)| key.contains('.') && is_unit(unit));
    of_key.or_else(of_result).unwrap_or((name, ""))
}

/// The heading of a column of results, with its unit on a line of its own.
#[must_use]
pub fn row_heading(name: &str) -> String {
    heading(name, '\n')
}

/// The heading of a column, with its unit behind a character. Keys of the spec, places in JSON and symbols stay as they are.
pub(super) fn heading(name: &str, between: char) -> String {
    let (own, unit) = match name {
        "part_id" => ("part", ""),
        "lower_mm" => ("ΔCD from", "mm"),
        "upper_mm" => ("ΔCD to", "mm"),
        "nearest_limit" => ("limit", ""),
        name if is_rate(name) => (name, "µm/mm"),
        _ => name_and_unit(name),
    };
    let of = if name.starts_with("delta_cd_") { "ΔCD of " } else { "" };
    let is_word = !(own.contains(['.', '/']) || own.starts_with("f_") || own.starts_with("F_"));
    let words = if is_word { format!("{of}{}", result_in_words(own)) } else { own.to_owned() };
    if unit.is_empty() { words } else { format!("{words}{between}[{unit}]") }
}

/// Whether a result is a rate, which programs get in mm/mm and people in µm/mm.
fn is_rate(name: &str) -> bool {
    name.ends_with("largest_rate")
}

/// A rate of mm/mm in µm/mm for people.
pub(super) fn rate_text(rate: f64) -> String {
    signed(1000.0 * rate, 2).trim_start_matches('+').to_owned()
}

/// A number of a result for people: a length to 0.1 µm, a rate in µm/mm, any other with four decimals at most, or with three digits
/// if it is small.
pub(super) fn number_text(name: &str, number: f64) -> String {
    const LEAST: f64 = 1e-3;
    let number = tidy(number);
    if name.ends_with("_mm") {
        return millimetres(number);
    }
    if is_rate(name) {
        return rate_text(number);
    }
    if number != 0.0 && number.abs() < LEAST {
        return Rounded(format!("{number:.2e}").parse().unwrap_or(number)).to_string();
    }
    let short = format!("{number:.4}");
    short.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The name of a column of results in words: for `delta_cd_rack_pitch_mm` the error, for `range_upper_mm` the worst case's upper
/// end.
pub(super) fn result_in_words(name: &str) -> String {
    let name = name.trim_start_matches("delta_cd_").trim_end_matches("_mm");
    key_in_words(name).replacen("range", "worst case", 1)
}

/// Rows of results.
pub struct RowsReport<'a> {
    /// The rows; the first has the names of the columns.
    pub rows: &'a [Vec<String>],
    /// Whether numbers are shown with the decimals that they have.
    pub as_written: bool,
    /// How many columns behind the first one are those of a table that was read; they stay as they are.
    pub copied: usize,
}

impl Report for RowsReport<'_> {
    fn json(&self) -> Value {
        self.rows.into()
    }

    fn rows(&self) -> Vec<Vec<String>> {
        self.rows.to_vec()
    }

    /// A table without empty columns.
    fn blocks(&self) -> Vec<Block> {
        let Some((names, rows)) = self.rows.split_first() else { return Vec::new() };
        let is_copied = |index: usize| (1..=self.copied).contains(&index);
        // a key's value stays as the user wrote it
        let is_rounded = |index: usize| {
            let name = names[index].as_str();
            !(self.as_written || is_copied(index) || name.contains('.') || name == "part_id")
        };
        let cell = |row: &[String], index: usize| {
            let cell = row.get(index).cloned().unwrap_or_default();
            match cell.parse().ok().filter(|_| is_rounded(index)) {
                Some(number) => number_text(&names[index], number),
                None if names[index] == "nearest_limit" => cell.trim_start_matches("center_distance.").to_owned(),
                None => cell,
            }
        };
        let is_number = |index: usize| {
            let cells = || rows.iter().filter_map(|row| row.get(index)).filter(|cell| !cell.is_empty());
            let is_of_numbers = || names[index] != "part_id" && cells().all(|cell| cell.parse::<f64>().is_ok());
            !is_copied(index) && (names[index].ends_with("_mm") || is_of_numbers())
        };
        let is_filled = |index: &usize| rows.iter().any(|row| row.get(*index).is_some_and(|cell| !cell.is_empty()));
        let table = (0..names.len()).filter(is_filled).fold(Table::of(rows), |table, index| {
            let name = &names[index];
            let heading = if is_copied(index) { name.clone() } else { row_heading(name) };
            let column = if is_number(index) { Column::number(heading) } else { Column::text(heading) };
            table.column_if(true, column, |row| cell(row, index))
        });
        vec![table.block()]
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Format, Screen, write};
    use super::*;

    #[test]
    fn units_stand_in_brackets_and_numbers_are_rounded() {
        for (name, heading, number, text) in [
            ("lift_off_force_n", "lift off force\n[N]", 812.345_678, "812.3457"),
            ("torque_rising_mean_n_m", "torque rising mean\n[N m]", 1.234_56e-5, "0.0000123"),
            ("delta_cd_rack_pitch_mm", "ΔCD of rack pitch\n[mm]", 0.0123_456, "+0.0123"),
            ("F_beta_um", "F_beta\n[µm]", 7.5, "7.5"),
            ("mesh_largest_rate", "mesh largest rate\n[µm/mm]", 0.103_388, "103.39"),
            ("mesh_largest_rate", "mesh largest rate\n[µm/mm]", -0.000_26, "-0.26"),
            ("contact_ratio", "contact ratio", 1.987_654_3, "1.9877"),
        ] {
            assert_eq!((row_heading(name).as_str(), number_text(name, number).as_str()), (heading, text));
        }
        for (key, heading) in [
            ("errors.rack_pitch_um", "errors.rack_pitch\n[um]"),
            ("yoke.preload_N", "yoke.preload\n[N]"),
            ("pair.normal_pressure_angle", "pair.normal_pressure_angle"),
            ("contributions/rack_pitch/share", "contributions/rack_pitch/share"),
        ] {
            assert_eq!(row_heading(key), heading);
        }
    }

    #[test]
    fn keys_parts_and_columns_of_a_table_stay_as_written() {
        let rows = |rows: &[&[&str]]| -> Vec<Vec<String>> {
            rows.iter().map(|row| row.iter().map(|cell| (*cell).to_owned()).collect()).collect()
        };
        let of = |all: &[&[&str]], copied| {
            let report = RowsReport { rows: &rows(all), as_written: false, copied };
            write(&report, Format::Markdown, Screen::default()).unwrap()
        };
        let swept = of(&[&["k.angle", "max_mm"], &["18.000001", "0.123456"]], 0);
        assert!(swept.contains("18.000001") && swept.contains("+0.1235"), "{swept}");
        let batch = of(&[&["part_id", "temp_n", "max_mm"], &["0012.50001", "1.234567", "1"]], 1);
        assert!(batch.contains("0012.50001") && batch.contains("1.234567") && batch.contains("temp_n"), "{batch}");
    }
}
