//! Numbers without names: what they are is asked for, or is the spec's order.

use super::headings::{Named, PartNames, is_part_name};
use super::{NoShape, Series, Shape, aside, has_digit, unknown_line};
use crate::deviation::Part;
use crate::table::cell::{Cell, Record};
use crate::table::column::has_tolerance_behind;
use crate::table::grid::{is_unit, unit_in};
use crate::table::names::{Field, Role, is_known_word, names_value, part_said, role, says_more, split_unit};
use crate::table::want::{Orientation, Want};

/// Numbers without names: what they are is asked for, or is the spec's order.
pub(super) fn without_names(records: &[Record], want: &Want) -> Result<Shape, NoShape> {
    let fields: Vec<Field> = if want.fields.is_empty() {
        want.expected.iter().map(|kind| Field::Error(*kind)).collect()
    } else {
        want.fields.clone()
    };
    let rows: Vec<&Record> = records.iter().filter(|record| has_numbers_only(record)).collect();
    let Some(&first) = rows.first() else { return Err(NoShape::NoNumbers) };
    let labelled = rows.iter().any(|record| !record.cells[0].is_number());
    let width = rows.iter().map(|record| record.filled().len()).max().unwrap_or(0);
    let wanted = fields.len();
    // a name in front of every row
    let offset = usize::from(!fields.contains(&Field::PartId) && (labelled || width == wanted + 1));
    let even = rows.iter().all(|record| record.filled().len() == width);
    // 25,01 is no part's name
    let is_name = |record: &&Record| !record.cells[0].is_number() || !record.cells[0].text().contains(['.', ',']);
    let as_rows = even && width == wanted + offset && (offset == 0 || rows.iter().all(is_name));
    let as_columns = even && !labelled && rows.len() == wanted;
    if as_rows && as_columns && wanted > 1 && want.orientation.is_none() {
        return Err(NoShape::Square);
    }
    let in_rows = as_rows && want.orientation != Some(Orientation::Columns);
    let in_columns = as_columns && want.orientation != Some(Orientation::Rows);
    if !in_rows && !in_columns {
        let span = first.span().start..rows.last().map_or(0, |record| record.span().end);
        return Err(NoShape::Count { columns: width, rows: rows.len(), span });
    }
    if let Some(record) = says_what_they_are(records, want) {
        return Err(NoShape::OtherNames { record: record.clone() });
    }
    let id = fields.iter().position(|field| *field == Field::PartId).or((offset == 1).then_some(0));
    let names = PartNames::of(rows.iter().filter(|_| in_rows).filter_map(|row| row.cells.get(id?)));
    let is_row = |record: &Record| {
        has_numbers_only(record) || record.filled().len() == 1 && names.may_have(&record.cells[0].text())
    };
    let rows: Vec<&Record> = records.iter().filter(|record| is_row(record)).collect();
    let mut shape = Shape::new(if in_rows { Orientation::Rows } else { Orientation::Columns });
    for (index, field) in fields.iter().enumerate() {
        let cells = if in_rows {
            rows.iter().map(|row| row.cells.get(index + offset).cloned().unwrap_or_default()).collect()
        } else {
            rows[index].filled().to_vec()
        };
        shape.take(bare(*field, cells))?;
    }
    if in_rows && offset == 1 {
        shape.take(bare(Field::PartId, rows.iter().map(|row| row.cells[0].clone()).collect()))?;
    }
    shape.lines = if in_rows { rows.iter().map(|row| row.line).collect() } else { vec![first.line; width] };
    for record in records.iter().filter(|record| !is_row(record) && !record.says_nothing()) {
        if record.numbers() > 0 {
            shape.unknown.push(unknown_line(record, true));
        } else {
            shape.asides.push(aside(record));
        }
    }
    Ok(shape)
}

/// A column that is called by its field's key.
fn bare(field: Field, cells: Vec<Cell>) -> Named {
    let series = Series { title: field.key().to_owned(), cells, ..Series::default() };
    Named { field, aspect: Role::Measured, holds: None, series }
}

/// A cell beside a number that has a known name and its size: `Over roller 25.000 ±0.030`.
pub(super) fn name_with_size<'r>(records: &'r [Record], want: &Want) -> Option<&'r Cell> {
    let is_both = |cell: &&Cell| {
        let text = cell.text();
        let (name, size) = text.split_at(text.find(|c: char| c.is_ascii_digit()).unwrap_or(0));
        let is_size = || Cell::of_text(size, 0..0).has_decimals() || has_tolerance_behind(size);
        names_value(name, &want.own) && is_size()
    };
    records.iter().filter(|record| record.numbers() > 0).flat_map(|record| &record.cells).find(is_both)
}

/// Letters of a name without digits that may be a part's: `A`, `VII`.
const SHORT: usize = 3;

/// A line that may say what the numbers are: words above the last of them, a name in front of one that is none of a part, and
/// where the user says what they are, a unit.
fn says_what_they_are<'r>(records: &'r [Record], want: &Want) -> Option<&'r Record> {
    let last = records.iter().rposition(has_numbers_only)?;
    let has_unit = |cell: &Cell| split_unit(&cell.text()).1.is_some();
    let is_name = |cell: &Cell| {
        let text = cell.text();
        is_plain_name(&text) && (has_digit(&text) || text.chars().count() <= SHORT)
    };
    let says = |record: &&Record| {
        // `2: over roller is` begins like a number
        let is_number = |cell: &Cell| cell.is_number() && unit_in(&cell.text()).is_none_or(|unit| is_unit(&unit));
        let words = || record.cells.iter().filter(|cell| !is_number(cell) && !cell.is_missing());
        let is_row = has_numbers_only(record);
        words().any(has_unit) || want.fields.is_empty() && words().any(|cell| !is_row || !is_name(cell))
    };
    records[..=last].iter().filter(|record| !record.says_nothing()).find(says)
}

/// Whether a part's name says nothing else: a code such as `R2`, and before it perhaps what it counts (`Charge 4711`). It has
/// no number with decimals, no mark of doubt and no word that is known.
fn is_plain_name(name: &str) -> bool {
    let words: Vec<&str> =
        name.split_whitespace().map(|word| word.trim_matches([',', ';', ':', '(', ')', '.', '='])).collect();
    let code = words.iter().position(|word| has_digit(word)).unwrap_or(words.len());
    let (before, codes) = words.split_at(code);
    let is_counted = |word: &&str| is_part_name(word) || word.chars().count() < 2 || !is_known_word(word);
    let is_code = |word: &&str| {
        let letters = word.trim_matches(|c: char| c.is_ascii_digit());
        let is_role = role(letters).is_some_and(Role::is_beside_value) && letters.chars().count() >= SHORT;
        let is_count = has_digit(word) && !Cell::of_text(word, 0..0).has_decimals();
        is_count && !is_role && part_said(letters) != Some(Part::Pinion) || word.chars().count() < 2
    };
    before.iter().all(is_counted)
        && codes.iter().all(is_code)
        && !names_value(&before.join(" "), &[])
        && !name.contains(says_more)
}

/// Whether a line holds numbers, perhaps with a name in front.
fn has_numbers_only(record: &Record) -> bool {
    let is_text = |cell: &&Cell| !cell.is_number() && !cell.is_missing();
    let texts = record.cells.iter().filter(is_text).count();
    record.numbers() > 0 && (texts == 0 || (texts == 1 && !record.cells[0].is_number()))
}
