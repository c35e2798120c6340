//! Tables with a name in front of each line, and a value per part behind it.

use super::headings::{Named, headings, is_of_no_part, is_part_name, one_meaning, says_no_part};
use super::{NoShape, Series, Shape, aside, has_digit, unknown_line};
use crate::quantity::Unit;
use crate::table::cell::{Cell, Record};
use crate::table::grid::{Separator, bare_unit, is_unit, unit_in};
use crate::table::names::{Field, Role, WordList, heading, is_tolerance, names_value, repeats_value, role};
use crate::table::reading::AsideReading;
use crate::table::unknown::Unknown;
use crate::table::want::{Orientation, Want};

/// The records whose first cell is a name with numbers after it.
pub(super) fn find_labels(records: &[Record], want: &Want) -> Vec<usize> {
    let known = |record: &Record| {
        record.filled().len() > 1
            && record.cells[1..].iter().any(Cell::is_number)
            && !record.cells[0].is_measure()
            && names_value(&record.cells[0].text(), &want.own)
    };
    (0..records.len()).filter(|index| known(&records[*index])).collect()
}

/// A line above labels that calls a column nominal or a tolerance: the values of such a column are no part's.
pub(super) fn columns_of_no_part(records: &[Record], labels: &[usize]) -> Option<NoShape> {
    let above = &records[..*labels.first()?];
    let says_all = |cell: &&Cell| says_no_part(&cell.text()) && !cell.text().trim().contains(' ');
    let names_columns = |record: &&Record| !states_tolerance(record);
    // a line of names has as many cells as the lines below it
    let names = above.last().filter(|record| record.cells.len() == records[labels[0]].cells.len());
    let titles = || names.into_iter().flat_map(|names| names.cells.iter().skip(1));
    let is_of_names = names.is_some_and(|names| role(&names.cell(0).text()) == Some(Role::Name));
    let heading = titles()
        .find(|cell| says_no_part(&cell.text()))
        .or_else(|| titles().find(|cell| is_of_names && is_of_no_part(&cell.text())))
        .or_else(|| above.iter().filter(names_columns).flat_map(|record| &record.cells).find(says_all))
        .or_else(|| {
            let has_several = records[labels[0]].numbers() > 1;
            let names_both = |record: &&Record| names_columns(record) && names_part_and_other(record);
            above.iter().find(names_both).filter(|_| has_several)?.cells.first()
        })?;
    Some(NoShape::NoPart { heading: heading.clone() })
}

/// Whether a line names a part and a column of none, and nothing else: `Toleranz Teil 1`.
fn names_part_and_other(record: &Record) -> bool {
    let is_part = |text: &str| has_digit(text) || is_part_name(text);
    let is_beside = |text: &str| role(text).is_some_and(Role::is_beside_value);
    let is_column = |text: &str| {
        is_part(text) || is_beside(text) || text.split_whitespace().all(|word| is_part(word) || is_beside(word))
    };
    let texts = || record.filled().iter().map(Cell::text);
    texts().any(|text| is_part(&text))
        && texts().any(|text| says_no_part(&text))
        && texts().all(|text| is_column(&text))
}

/// Whether a line says a tolerance and nothing else: `Toleranz: ±0,03 mm`.
fn states_tolerance(record: &Record) -> bool {
    let values = record.filled().get(1..).unwrap_or_default();
    let is_value = |cell: &Cell| {
        let number = Cell::of_text(cell.text().trim_start_matches('±'), 0..0);
        is_unit(&cell.text()) || number.has_decimals() || number.is_measure() && unit_in(&number.text()).is_some()
    };
    is_tolerance(&record.cell(0).text()) && !values.is_empty() && values.iter().all(is_value)
}

/// Whether its first cell counts lines: `003`, `10.`, `1/2`.
pub(super) fn is_counted(record: &Record) -> bool {
    let text = record.cell(0).text();
    let digits = text.trim_end_matches(['.', ')', ':']);
    text.starts_with(|c: char| c.is_ascii_digit()) && digits.chars().all(|c| c.is_ascii_digit() || c == '/')
}

/// A line `003 Pitch error 0.21` with its number in the name; any other record as it is.
pub(crate) fn uncounted(record: &Record) -> Record {
    let is_word = |cell: &&Cell| !cell.is_number() && !cell.is_missing();
    let words = record.cells.iter().skip(1).take_while(is_word).count();
    let has_value = || record.cells[words + 1..].iter().any(Cell::is_number);
    if !is_counted(record) || words == 0 || !has_value() {
        return record.clone();
    }
    let texts: Vec<_> = record.cells[..=words].iter().map(Cell::text).collect();
    let name = Cell::of_text(&texts.join(" "), record.cells[0].span.start..record.cells[words].span.end);
    record.with_cells(std::iter::once(name).chain(record.cells[words + 1..].iter().cloned()))
}

/// One line per name, with a value per part behind it.
pub(super) fn by_label(
    records: &[Record],
    labels: &[usize],
    separator: Separator,
    want: &Want,
) -> Result<Shape, NoShape> {
    let names: Vec<_> = labels.iter().map(|index| records[*index].cells[0].clone()).collect();
    let named = headings(&names, want)?;
    let mut shape = Shape::new(Orientation::Columns);
    let has_units = labels.iter().zip(&named).any(|(index, named)| {
        let is_angle = named.as_ref().is_some_and(|named| named.field.is_angle());
        records[*index].cells.get(1).is_some_and(|cell| is_unit_of(&cell.text(), is_angle))
    });
    let has_places = matches!(separator, Separator::Character(_));
    let above = if has_places { parts_above(&records[..labels[0]], has_units, want) } else { 0 };
    let mut count = above;
    let mut found = Vec::new();
    for (named, index) in named.into_iter().zip(labels) {
        let Some(mut named) = named else {
            shape.unknown.push(unknown_line(&records[*index], false));
            continue;
        };
        let cells = behind_label(&records[*index], has_units);
        let cells = without_approval(cells, has_places);
        let (cells, temperature) = split_temperature(cells);
        let line = records[*index].line;
        shape.asides.extend(temperature.map(|text| AsideReading { line, text }));
        if !named.series.fill(cells, named.field.is_angle()) {
            return Err(NoShape::Units { record: records[*index].clone() });
        }
        count = count.max(named.series.cells.len());
        found.push((named, &records[*index]));
    }
    for (mut named, record) in found {
        let cells = &mut named.series.cells;
        if has_places && (above == count || record.cells.len() > count) {
            // a cell that is not filled is that of a part
            cells.resize(count, Cell::default());
        } else if named.aspect == Role::Measured && cells.len() != count {
            return Err(NoShape::Ragged { record: record.clone(), expected: count + 1 });
        }
        shape.take(named)?;
    }
    let follows = |index: &usize| records[*index].line == records[index - 1].line + 1;
    let last = labels[labels.len() - 1];
    let right_below = (last + 1..records.len()).take_while(follows).last().unwrap_or(last);
    let lines = Lines { first: labels[0], last, right_below, count, has_units, want };
    for (index, record) in records.iter().enumerate().filter(|(index, _)| !labels.contains(index)) {
        lines.take_other(index, record, &mut shape)?;
    }
    shape.lines = vec![records[labels[0]].line; count];
    shape.drop_valueless();
    Ok(shape)
}

/// How many parts a line above the labels names.
fn parts_above(above: &[Record], has_units: bool, want: &Want) -> usize {
    let names_parts =
        |record: &&Record| heading(&record.cell(0).text(), &want.own).is_some_and(|heading| heading.is_index());
    above.iter().filter(names_parts).map(|record| behind_label(record, has_units).len()).max().unwrap_or(0)
}

/// The lines that begin with known names.
struct Lines<'a> {
    /// The first of their records, and the last.
    first: usize,
    last: usize,
    /// The last record that stands right below them.
    right_below: usize,
    /// Values of each.
    count: usize,
    /// Whether a column of units stands behind the names.
    has_units: bool,
    want: &'a Want,
}

impl Lines<'_> {
    /// Whether a record stands among the values, or right below them with a number that has decimals.
    fn is_among(&self, index: usize, record: &Record) -> bool {
        let has_decimals = |cell: &Cell| cell.is_number() && cell.text().trim_end_matches('.').contains(['.', ',']);
        (self.first < index && index < self.last)
            || (self.last < index && index <= self.right_below && record.cells.iter().skip(1).any(has_decimals))
    }

    /// Takes a record among them, above or below.
    fn take_other(&self, index: usize, record: &Record, shape: &mut Shape) -> Result<(), NoShape> {
        if record.says_nothing() {
            return Ok(());
        }
        let title = record.cells[0].text();
        if let Some(named) = without_number(record, self.count, self.want)
            && shape.measurements.iter().all(|measurement| measurement.field != named.field)
        {
            return shape.take(named);
        }
        // no part is called `412 µm`
        let has_unit = |cell: &Cell| {
            let text = cell.text();
            is_unit(&text) || unit_in(&text).is_some_and(|unit| is_unit(&unit))
        };
        let cells = behind_label(record, self.has_units);
        let names_parts =
            heading(&title, &self.want.own).filter(|heading| cells.len() == self.count && heading.is_index());
        let of_parts = names_parts.map(|heading| heading.fields[0]).or_else(|| {
            let stands_above = title.is_empty() && index + 1 == self.first && cells.len() == self.count;
            (stands_above && shape.ids.is_none()).then_some(Field::PartId)
        });
        match of_parts {
            Some(field) if index < self.first => {
                let series = Series { title: title.into_owned(), cells: cells.to_vec(), ..Series::default() };
                shape.take(Named { field, aspect: Role::Measured, holds: None, series })?;
            }
            _ if record.numbers() > 0
                && record.filled().len() > 1
                && !record.cells[0].is_measure()
                && (!is_part_name(&title) || record.cells.iter().any(has_unit)) =>
            {
                let is_value = index > self.first && says_value(&title, &record.cells[1..]);
                shape.unknown.push(unknown_line(record, is_value || self.is_among(index, record)));
            }
            // a value whose name is not there
            _ if record.cells.iter().all(|cell| unit_in(&cell.text()).is_some_and(|unit| is_unit(&unit))) => {
                shape.unknown.push(Unknown::line("", record.line, record.cells.clone()).measured(true));
            }
            _ => shape.asides.push(aside(record)),
        }
        Ok(())
    }
}

/// Whether a number behind a title is a value, and not that of a tooth or space: `rechts 95`, `Zahn 7: 95`.
pub(super) fn says_value(title: &str, behind: &[Cell]) -> bool {
    let last = title.split_whitespace().next_back().unwrap_or_default();
    let counts = heading(last, &[]).is_some_and(|heading| heading.is_index());
    let numbers = behind.iter().filter(|cell| cell.is_number()).count();
    numbers > usize::from(counts) && (counts || repeats_value(title))
}

/// A field that a line names without a number, and what stands in its place: `Rack pitch: n/a`.
fn without_number(record: &Record, count: usize, want: &Want) -> Option<Named> {
    let line = record.in_words();
    let is_none = |cell: &Cell| !cell.is_number() && (cell.is_missing() || has_digit(&cell.text()));
    // between blanks, the value is the last word of a line
    let by_words = || {
        let (title, word) = line.trim().rsplit_once([' ', ':', '='])?;
        let (name, word) = (Cell::of_text(title, 0..0), Cell::of_text(word, 0..0));
        (record.numbers() == 0 && is_none(&word) && names_value(&name.text(), &want.own)).then(|| (name, vec![word]))
    };
    let by_cells = || {
        let (name, values) = (&record.cells[0], record.filled().get(1..).unwrap_or_default());
        let says_nothing = values.iter().all(|cell| !cell.is_number());
        (says_nothing && names_value(&name.text(), &want.own)).then(|| (name.clone(), values.to_vec()))
    };
    let (name, mut cells) = by_words().or_else(by_cells)?;
    let title = name.text().into_owned();
    let heading = if want.ignores(&title) { None } else { heading(&title, &want.own) }?;
    let field = one_meaning(&heading.fields, want, &name).ok()?;
    cells.resize(count, Cell::default());
    let series = Series { title, unit: heading.unit, cells, ..Series::default() };
    Some(Named { field, aspect: Role::Measured, holds: heading.holds, series })
}

/// Whether a text is a unit: `min` behind the name of an angle is no time.
fn is_unit_of(text: &str, is_angle: bool) -> bool {
    is_unit(text) || (is_angle && Unit::of_angle(bare_unit(text)).is_some())
}

/// The cells behind a label, without that of a column of units which has none here.
fn behind_label(record: &Record, has_units: bool) -> &[Cell] {
    let behind = record.filled().get(1..).unwrap_or_default();
    let has_none = |cell: &Cell| cell.is_missing() || role(&cell.text()) == Some(Role::Unit);
    match behind.split_first() {
        Some((first, values)) if has_units && has_none(first) => values,
        _ => behind,
    }
}

/// The cells of one value without the temperature that stands behind it, and this: `bei 20 °C`.
fn split_temperature(cells: &[Cell]) -> (&[Cell], Option<String>) {
    let at = cells.iter().rposition(|cell| WordList::At.has(&cell.text())).filter(|at| *at > 0);
    let (value, behind) = cells.split_at(at.unwrap_or(cells.len()));
    let text = behind.iter().map(Cell::text).collect::<Vec<_>>().join(" ");
    let number = text.trim_end_matches(['.', ',']).strip_suffix("°C").and_then(|text| text.split(' ').nth(1));
    let is_one = number.is_some_and(|number| Cell::of_text(number, 0..0).is_number()) && behind.len() <= 3;
    if is_one && value.iter().any(Cell::is_number) { (value, Some(text)) } else { (cells, None) }
}

/// The cells of one value without an approval, which stands behind it or its unit; where cells have places, one right behind a
/// value may be another part's.
fn without_approval(cells: &[Cell], has_places: bool) -> &[Cell] {
    const MOST_WORDS: usize = 3;
    let says = |count: &usize| {
        let behind = &cells[cells.len() - count..];
        is_approval(&behind.iter().map(Cell::text).collect::<Vec<_>>().join(" "))
    };
    let Some(words) = (1..=MOST_WORDS.min(cells.len())).rfind(says) else { return cells };
    let rest = &cells[..cells.len() - words];
    let is_behind_unit = || rest.last().is_some_and(|cell| is_unit(cell.text().trim_end_matches([',', ';', '.'])));
    let numbers = rest.iter().filter(|cell| cell.is_number()).count();
    let is_kept = numbers == 0 || has_places && (numbers > 1 || !is_behind_unit());
    if is_kept { cells } else { rest }
}

/// Whether a text says that somebody was content with the value before it, and nothing else: `i.O.`, `(OK)`.
fn is_approval(text: &str) -> bool {
    WordList::Approval.has(text.trim_matches(['(', ')', '!', ',', ';']))
}

impl Series {
    /// The values behind a name: a unit behind a value belongs to it, one before the first to all. Whether each value has
    /// one unit at most.
    fn fill(&mut self, cells: &[Cell], is_angle: bool) -> bool {
        let mut of_all: Option<String> = None;
        for cell in cells {
            let text = cell.text();
            // the end of a sentence
            let stem = text.trim_end_matches(['.', ',', ';']);
            let text = if is_unit_of(stem, is_angle) { stem } else { &text };
            let is_unit = is_unit_of(text, is_angle);
            let behind = if is_unit { bare_unit(text) } else { text };
            match self.cells.last_mut() {
                // 12,5 | µm
                Some(_) if is_unit && of_all.as_ref().is_some_and(|unit| unit != behind) => return false,
                None if is_unit && self.unit.is_none() => {
                    of_all = Some(behind.to_owned());
                    self.unit.clone_from(&of_all);
                }
                // what stands behind a number and is none belongs to it: nobody else says what it is; 0° 1' 15" is one angle
                Some(last)
                    if is_unit
                        || !cell.is_number() && !cell.is_missing() && last.is_number()
                        || goes_on_with_angle(&last.text(), text) =>
                {
                    let whole = format!("{} {behind}", last.text());
                    *last = Cell::of_text(&whole, last.span.start..cell.span.end);
                }
                _ => self.cells.push(cell.clone()),
            }
        }
        // a unit behind the last value alone may be that of all
        let in_cell = |cell: &Cell| unit_in(&cell.text()).is_some_and(|unit| is_unit_of(&unit, is_angle));
        match self.cells.split_last() {
            Some((last, others)) if self.unit.is_none() && !others.is_empty() && in_cell(last) => {
                others.iter().any(in_cell) || !others.iter().any(Cell::is_number)
            }
            _ => true,
        }
    }
}

/// Which part of an angle in degrees, minutes and seconds a text is, if it is one.
fn angle_part(text: &str) -> Option<usize> {
    let marks: [&[char]; 3] = [&['°'], &['\'', '\u{2032}'], &['"', '\u{2033}']];
    marks.iter().position(|marks| text.trim_end().ends_with(*marks))
}

/// Whether a text goes on with an angle: minutes behind degrees, seconds behind minutes.
fn goes_on_with_angle(before: &str, text: &str) -> bool {
    let is_smaller = angle_part(before).zip(angle_part(text)).is_some_and(|(before, part)| before < part);
    is_smaller && text.trim_start().starts_with(|c: char| c.is_ascii_digit())
}
