//! Rows of a report as a Q-DAS file: lengths become characteristics, for the statistics software that the values came
//! from.

use super::WITHOUT;
use crate::judge::{LimitTarget, Limits};
use crate::quantity::Length;
use crate::table::qdas::{CharacteristicColumn, PartDefinition, ValueRow, write};

/// A `.dfq` of rows with a header: the columns in mm and degrees, with the limits that hold for them, a row per part
/// named by its `part_id` (or its first column). That errors were left out, and why a part has no verdict, are remarks.
#[must_use]
pub fn qdas(rows: &[Vec<String>], title: &str, limits: &Limits) -> Vec<u8> {
    let Some((header, rows)) = rows.split_first() else { return Vec::new() };
    let position = |wanted: &str| header.iter().position(|name| name == wanted);
    let (id, reason, without) = (position("part_id").unwrap_or(0), position("reason"), position(WITHOUT));
    let indices: Vec<(usize, &str, &str)> = header
        .iter()
        .enumerate()
        .filter_map(|(index, name)| {
            let (stem, unit) = name.rsplit_once('_').filter(|(_, unit)| matches!(*unit, "mm" | "deg"))?;
            Some((index, stem, unit))
        })
        .collect();
    let columns: Vec<CharacteristicColumn> = indices
        .iter()
        .map(|(index, stem, unit)| {
            let limited = |target: &LimitTarget| match target {
                LimitTarget::CenterDistance => *stem == "range_lower" || *stem == "range_upper",
                LimitTarget::Error(kind) => stem.strip_prefix("delta_cd_") == Some(kind.key()),
            };
            let limit = limits.iter().find(|(target, _)| limited(target)).map(|(_, limit)| limit);
            let end = |end: fn(&crate::judge::Limit) -> Option<Length>| limit.and_then(end).map(Length::mm);
            CharacteristicColumn {
                number: header[*index].clone(),
                name: stem.replace('_', " ").replace("delta cd", "Delta CD"),
                unit: (*unit).to_owned(),
                nominal: None,
                lower: end(|limit| limit.lower),
                upper: end(|limit| limit.upper),
            }
        })
        .collect();
    let part = PartDefinition { number: title.to_owned(), name: "rackmesh".to_owned(), ..PartDefinition::default() };
    // all parts of a table are judged without the same errors
    let without = rows.iter().map(|row| text(row, without)).find(|keys| !keys.is_empty());
    let remark = without.map_or_else(String::new, |keys| format!("judged without {keys} (--partial)"));
    let rows = rows.iter().map(|row| {
        let values = indices.iter().map(|(index, ..)| text(row, Some(*index)).parse().ok());
        ValueRow { name: text(row, Some(id)), values: values.collect(), remark: text(row, reason) }
    });
    write(&part, &remark, &columns, rows)
}

/// What stands in a column, if there is one.
fn text(row: &[String], column: Option<usize>) -> &str {
    column.and_then(|column| row.get(column)).map_or("", String::as_str)
}
