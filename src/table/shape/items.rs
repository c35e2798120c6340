//! Headings with the numbers of a form's items before them, as AS9102 has them: `5. Char. No.`, `9. Results`.

use std::borrow::Cow;

use super::HEAD;
use crate::table::cell::{Cell, Record};

/// The records, without the numbers in a row of such headings.
pub(super) fn without_item_numbers(records: &[Record]) -> Cow<'_, [Record]> {
    let Some(at) = records.iter().take(HEAD).position(has_item_numbers) else { return Cow::Borrowed(records) };
    let mut records = records.to_vec();
    for cell in &mut records[at].cells {
        let text = item(&cell.text()).map(|item| item.name.to_owned());
        *cell = text.map_or_else(|| cell.clone(), |text| Cell::of_text(&text, cell.span.clone()));
    }
    Cow::Owned(records)
}

/// A heading and its number.
struct Item<'t> {
    number: u32,
    name: &'t str,
}

fn item(text: &str) -> Option<Item<'_>> {
    let (number, name) = text.split_once('.')?;
    let name = name.strip_prefix(' ')?.trim();
    Some(Item { number: number.parse().ok()?, name }).filter(|item| item.name.starts_with(char::is_alphabetic))
}

/// Whether each cell of a record is such a heading, with growing numbers.
fn has_item_numbers(record: &Record) -> bool {
    const FEWEST: usize = 3;
    let cells: Vec<_> = record.cells.iter().filter(|cell| !cell.is_empty()).map(Cell::text).collect();
    let numbers: Option<Vec<u32>> = cells.iter().map(|text| item(text).map(|item| item.number)).collect();
    numbers.is_some_and(|numbers| numbers.len() >= FEWEST && numbers.is_sorted_by(|one, other| one < other))
}
