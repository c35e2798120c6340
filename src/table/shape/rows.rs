//! Tables with a header: each row below it is a part, a space or a tooth.

use std::ops::Range;

use super::headings::{Named, PartNames, headings, is_extreme, is_numbered, known};
use super::{NoShape, Series, Shape, aside, has_digit, unknown_line};
use crate::table::cell::{Cell, Record};
use crate::table::fixed::extents;
use crate::table::grid::{Separator, bare_unit, differ, is_unit};
use crate::table::names::{
    Field, Role, WordList, heading, is_context, is_statistic, names_value, part_said, role, says_which, split_unit,
};
use crate::table::unknown::{Unknown, speaks_of_value};
use crate::table::want::{Orientation, Want};

pub(super) struct Header {
    pub(super) record: usize,
    /// How many records it takes.
    rows: usize,
    cells: Vec<Cell>,
    pub(super) known: usize,
}

impl Header {
    /// How much of it is understood; a name that could be two things is half understood.
    fn score(&self, want: &Want) -> usize {
        let of = |cell: &Cell| match heading(&cell.text(), &want.own) {
            Some(heading) if heading.fields.len() == 1 => 2,
            Some(_) => 1,
            None => usize::from(WordList::EvaluationLength.has(&cell.text())),
        };
        self.cells.iter().map(of).sum()
    }
}

/// The record that names the most columns and has numbers below it.
pub(super) fn find_header(records: &[Record], separator: Separator, want: &Want) -> Option<Header> {
    /// Names stand at the top.
    const LOOKED_AT: usize = 200;
    let mut best: Option<Header> = None;
    let has_numbers: Vec<bool> = records.iter().map(|record| record.numbers() > 0).collect();
    for (index, record) in records.iter().enumerate().take(LOOKED_AT) {
        // `2. Messung` is no value
        if has_numbers[index] && known(&record.cells, want) < 2.max(record.numbers() + 1) {
            continue;
        }
        // a unit row, a line drawn below, or rows without a value may stand between
        let is_near = |below: &usize| *below <= index + 3 || records[*below].cells.len() == record.cells.len();
        let mut near = (index + 1..records.len()).take_while(is_near);
        let Some(data) = near.find(|below| has_numbers[*below]).map(|below| &records[below]) else { continue };
        let cells = match separator {
            Separator::Blanks => grouped(record, data.cells.len(), want)
                .or_else(|| above_names(grouped(record, 1, want)?, &records[index + 1..])),
            Separator::AlignedBlanks if stands_behind_count(records, index) => {
                // what counts the rows has no name
                let start = record.start..record.start;
                Some(std::iter::once(Cell::of_text("", start)).chain(record.cells.iter().cloned()).collect())
            }
            _ => Some(record.filled().to_vec())
                .filter(|cells| cells.len() == 1)
                .and_then(|heading| above_names(heading, &records[index + 1..]))
                .or_else(|| Some(record.cells.clone())),
        };
        let Some(cells) = cells else { continue };
        for header in [header(index, 1, cells.clone(), want), two_rows(records, index, &cells, want)] {
            let Some(header) = header else { continue };
            // what goes on in a second line says more
            let goes_on = |best: &Header| header.rows > best.rows && header.score(want) == best.score(want);
            if best.as_ref().is_none_or(|best| header.score(want) > best.score(want) || goes_on(best)) {
                best = Some(header);
            }
        }
    }
    best
}

/// Cells as a header, if they name a value.
fn header(record: usize, rows: usize, cells: Vec<Cell>, want: &Want) -> Option<Header> {
    let known = known(&cells, want);
    cells.iter().any(|cell| names_value(&cell.text(), &want.own)).then_some(Header { record, rows, cells, known })
}

/// A heading that goes on in the record below it.
fn two_rows(records: &[Record], index: usize, cells: &[Cell], want: &Want) -> Option<Header> {
    let below = records.get(index + 1)?;
    let is_beside = |cell: &Cell| role(&cell.text()).is_some_and(Role::is_beside_value);
    let has_roles = below.cells.iter().any(is_beside);
    // `Zahnstange` above `Rollenmaß` and `Teilung`, `links` above `fp` and `Fp`
    let is_gear = |cell: &Cell| {
        let text = cell.text();
        (part_said(&text).is_some() || says_which(&text) && !is_extreme(&text)) && !names_value(&text, &want.own)
    };
    let has_gears = cells.iter().any(is_gear);
    let fits = below.cells.len() == cells.len() || (has_roles || has_gears) && below.cells.len() > cells.len();
    let goes_on = below.numbers() == 0 && fits && !below.says_nothing() && !is_unit_row(below);
    if !goes_on || known(&below.cells, want) > 1 && !has_gears {
        return None;
    }
    let mut above = Cell::default();
    let joined = below.cells.iter().enumerate().map(|(place, lower)| {
        let upper = cells.get(place).filter(|upper| !upper.is_empty());
        // a heading that is merged stands in the first of its cells
        let is_merged = (has_roles || is_gear(&above)) && !lower.is_empty();
        let upper = upper.or(is_merged.then_some(&above)).cloned().unwrap_or_default();
        let text = format!("{} {}", upper.text(), lower.text());
        above.clone_from(&upper);
        Cell::of_text(text.trim(), upper.span)
    });
    header(index, 2, joined.collect(), want)
}

/// A line of names right above the first numbers, with as many cells, though none of the names is known.
pub(super) fn header_of_strangers(records: &[Record]) -> Option<Header> {
    let record = records.iter().zip(records.get(1..)?).position(|(_, below)| below.numbers() > 0)?;
    let (names, below) = (&records[record], &records[record + 1]);
    let is_header = names.numbers() == 0
        && !names.says_nothing()
        && names.filled().len() == below.filled().len()
        && names.line + 1 == below.line;
    is_header.then(|| Header { record, rows: 1, cells: names.cells.clone(), known: 0 })
}

/// Whether each row below a line of names begins with its number in front of all names, and has a cell below each.
fn stands_behind_count(records: &[Record], names: usize) -> bool {
    let (names, above, below) = (&records[names], &records[..names], &records[names + 1..]);
    let is_below = |(cell, name): (&Range<usize>, &Range<usize>)| cell.start < name.end && name.start < cell.end;
    let of_names = extents(names.start, &names.cells);
    let first = of_names.first().map_or(0, |name| name.start);
    let is_row = |(number, row): (usize, &Record)| {
        let cells = extents(row.start, &row.cells);
        row.cells.len() == names.cells.len() + 1
            && row.cells[0].text() == number.to_string()
            && cells[0].end <= first
            && cells[1..].iter().zip(&of_names).all(is_below)
    };
    let is_whole = |row: &&Record| row.cells.len() > 1;
    below.first().is_some_and(|first| is_whole(&first))
        && !above.last().is_some_and(is_unit_row)
        && below.iter().filter(is_whole).enumerate().all(is_row)
}

/// A heading alone above lines of a name and a value: `Rollenmaß in mm:` above `A: 25,011`.
fn above_names(heading: Vec<Cell>, below: &[Record]) -> Option<Vec<Cell>> {
    let is_pair = |record: &Record| record.cells.len() == 2 && !record.cells[0].is_number();
    let are_pairs = below.iter().filter(|record| record.numbers() > 0).all(is_pair);
    are_pairs.then(|| std::iter::once(Cell::default()).chain(heading).collect())
}

/// Words of a heading line put together to as many cells as the rows below have.
fn grouped(record: &Record, wanted: usize, want: &Want) -> Option<Vec<Cell>> {
    const LONGEST_NAME: usize = 6;
    let words = &record.cells;
    if words.len() > 200 {
        return None;
    }
    let merge = |from: usize, to: usize| {
        let text = words[from..to].iter().map(Cell::text).collect::<Vec<_>>().join(" ");
        Cell::of_text(&text, words[from].span.start..words[to - 1].span.end)
    };
    let named = |from: usize, to: usize| heading(&merge(from, to).text(), &want.own);
    let mut cells = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let most = (words.len() - at).min(LONGEST_NAME);
        let length = (1..=most).rev().find(|length| {
            let end = at + length;
            // two names in one: the second begins with a word that names a part or a value by itself
            named(at, end).is_some_and(|found| *length == 1 || found.fields.len() == 1 || found.unit.is_some())
                && !(2..*length).any(|split| {
                    named(at, at + split).is_some_and(|head| head.fields.len() == 1)
                        && named(at + split, end).is_some_and(|tail| !tail.fields.is_empty())
                })
        });
        let length = length.unwrap_or(1);
        cells.push(merge(at, at + length));
        at += length;
    }
    (cells.len() == wanted).then_some(cells)
}

/// The row of units, below a header or right above it.
fn units_of(records: &[Record], header: &Header) -> Option<usize> {
    let below = header.record + header.rows;
    let next = records[below..].iter().position(|record| !record.says_nothing()).map(|offset| below + offset);
    let is_units = |index: &usize| is_unit_row(&records[*index]);
    next.filter(is_units).or_else(|| header.record.checked_sub(1).filter(is_units))
}

/// Whether units are those of columns; one alone that stands below no value is that of the table.
fn is_of_columns(header: &Record, units: &Record, named: &[Option<Named>]) -> bool {
    let is_of_value = |place: usize| match &named[place] {
        Some(named) => !named.field.is_index(),
        None => place > 0 && header.cells.get(place).is_some_and(|cell| !cell.is_empty()),
    };
    let mut places = (0..named.len()).filter(|place| unit_below(header, units, *place).is_some());
    units.cells.iter().filter(|cell| !cell.is_missing()).count() > 1 || places.any(is_of_value)
}

/// Whether a line above the names has a number where a row has a value, and does not say that it is none.
fn has_value_above(record: &Record, named: &[Option<Named>]) -> bool {
    let title = record.cells[0].text();
    let is_value = |(cell, named): (&Cell, &Option<Named>)| {
        named.as_ref().is_some_and(|named| !named.field.is_index())
            && cell.is_measure()
            && !cell.text().contains([':', '/'])
    };
    record.cells.iter().zip(named).any(is_value)
        && !is_context(&title)
        && !is_statistic(&title)
        && role(&title).is_none()
}

/// Whether each of some cells has a word of one of these lists.
pub(super) fn are_verdicts<'c>(cells: impl Iterator<Item = &'c Cell>, lists: &[WordList]) -> bool {
    let mut said = cells.filter(|cell| !cell.is_missing()).map(Cell::text).peekable();
    said.peek().is_some() && said.all(|text| lists.iter().any(|list| list.has(&text)))
}

/// The rows in a range of records: at least one, and none with a cell less than it seems.
fn rows_of<'r>(
    records: &'r [Record],
    header: &Header,
    range: Range<usize>,
    separator: Separator,
    id: Option<usize>,
) -> Result<Vec<&'r Record>, NoShape> {
    let (names, first) = (&records[header.record], range.start);
    let ragged = |record: &Record| NoShape::Ragged { record: record.clone(), expected: header.cells.len() };
    let mut rows: Vec<&Record> = records[range].iter().filter(|record| !record.says_nothing()).collect();
    if rows.is_empty() {
        let numbers = records[first..].iter().find(|record| record.numbers() > 0);
        return Err(numbers.map_or_else(|| NoShape::NoRows { names: names.in_words() }, ragged));
    }
    if rows.iter().all(|row| is_statistic(&row.cell(id.unwrap_or(0)).text())) {
        return Err(NoShape::NoRows { names: names.in_words() });
    }
    if let Some(id) = id {
        let measured = rows.iter().filter(|row| row.numbers() > 0);
        let parts = PartNames::of(measured.filter_map(|row| row.cells.get(id)));
        rows.retain(|row| !parts.exclude(&row.cell(id).text()));
    }
    match rows.iter().find(|row| is_shifted(names.start, &header.cells, row, separator)) {
        Some(shifted) => Err(ragged(shifted)),
        None => Ok(rows),
    }
}

pub(super) fn by_header(
    records: &[Record],
    header: &Header,
    separator: Separator,
    want: &Want,
) -> Result<Shape, NoShape> {
    let named = headings(&header.cells, want)?;
    let width = header.cells.len();
    let mut shape = Shape::new(Orientation::Rows);
    shape.header_line = Some(records[header.record].line);
    shape.header.clone_from(&header.cells);
    let row_of_units = units_of(records, header);
    let units = row_of_units.filter(|units| is_of_columns(&records[header.record], &records[*units], &named));
    let below = header.record + header.rows;
    let first = row_of_units.filter(|units| *units >= below).map_or(below, |units| units + 1);
    for line in (0..header.record).chain(row_of_units.filter(|units| *units >= below)) {
        let record = &records[line];
        if let Some(group) = group_of_no_value(record, &named).filter(|group| !want.ignores(&group.text())) {
            let cell = Cell::of_text(&record.in_words(), 0..0);
            shape.unknown.push(Unknown::line(&group.text(), record.line, vec![cell]).unread());
        } else if has_value_above(record, &named) {
            // A is no unit above names
            let value = unknown_line(record, true);
            let unit = value.unit.clone().filter(|unit| is_unit(unit));
            shape.unknown.push(Unknown { unit, ..value });
        } else if !record.says_nothing() && units != Some(line) {
            shape.asides.push(aside(record));
        }
    }
    let id = named.iter().position(|named| named.as_ref().is_some_and(|named| named.field == Field::PartId));
    let end = first + end_of_rows(&records[first..], width, separator, id.unwrap_or(0));
    let rows = rows_of(records, header, first..end, separator, id)?;
    shape.data = first..end;
    let (mut lengths, mut columns_of_units) = (None, Vec::new());
    let has_lead = named.iter().flatten().any(|named| named.field.is_angle());
    let column = |place: usize| rows.iter().map(|row| row.cell(place).clone()).collect();
    let series = |place: usize| {
        let title = header.cells[place].text().into_owned();
        Series { unit: split_unit(&title).1, title, place, cells: column(place) }
    };
    let unit_of = |place: usize| {
        let unit = unit_below(&records[header.record], &records[units?], place)?;
        Some(bare_unit(&unit.text()).to_owned())
    };
    for (place, (cell, named)) in header.cells.iter().zip(named).enumerate() {
        // Over roller Result
        let is_verdict = |named: &Named| {
            shape.measurements.iter().any(|measurement| measurement.field == named.field)
                && are_verdicts(rows.iter().map(|row| row.cell(place)), &[WordList::Approval, WordList::Disapproval])
        };
        if let Some(mut named) = named.filter(|named| !has_minus(&cell.text()) && !is_verdict(named)) {
            let below = unit_of(place);
            if let Some(record) = units.filter(|_| differ(named.series.unit.as_deref(), below.as_deref())) {
                return Err(NoShape::Units { record: records[record].clone() });
            }
            named.series.unit = named.series.unit.take().or(below);
            named.series.cells = column(place);
            shape.take(named)?;
        } else if has_lead && WordList::EvaluationLength.has(&cell.text()) && !want.ignores(&cell.text()) {
            lengths = Some(series(place));
        } else if role(&cell.text()) == Some(Role::Unit) {
            columns_of_units.push(series(place));
        } else if want.ignores(&cell.text()) || !shape.take_beside(&series(place)) {
            // a nominal value or tolerance in front of every value is that of one of them
            let is_of_value = shape.measurements.is_empty() && role(&cell.text()).is_some_and(Role::is_beside_value);
            let unknown = Unknown::column(&cell.text(), place, column(place));
            let unknown = unknown.measured(is_of_value || has_minus(&cell.text()));
            shape.unknown.push(Unknown { unit: unit_of(place), ..unknown });
        }
    }
    if let Some(heading) = shape.list_beside() {
        return Err(NoShape::ListBeside { heading });
    }
    shape.take_nominal_row(&rows, id.unwrap_or(0));
    let beside = width..rows.iter().map(|row| row.cells.len()).max().unwrap_or(0);
    // without a heading beside the table, only remarks are left out: a row with a value there is rejected
    let is_value = |cell: &Cell| cell.is_number() || speaks_of_value(&cell.text());
    let remarks = beside.map(|place| Unknown::column("", place, column(place)));
    shape.unknown.extend(remarks.filter(|unknown| !unknown.cells.iter().any(is_value)));
    for measurement in shape.measurements.iter_mut().filter(|measurement| measurement.field.is_angle()) {
        measurement.beside.set(Role::Length, lengths.clone());
    }
    shape.take_units(columns_of_units);
    shape.take_units_beside();
    shape.share_units();
    shape.take_nameless(want);
    shape.lines = rows.iter().map(|row| row.line).collect();
    let has_other_unit = |record: &&Record| {
        shape.measurements.iter().map(|measurement| &measurement.value).any(|value| {
            let unit = Some(record.cell(value.place).text()).filter(|text| is_unit(text));
            differ(value.unit.as_deref(), unit.as_deref())
        })
    };
    if let Some(record) = records[end..].iter().find(has_other_unit) {
        return Err(NoShape::Units { record: record.clone() });
    }
    shape.asides.extend(records[end..].iter().filter(|record| !record.says_nothing()).map(aside));
    shape.drop_valueless();
    shape.drop_changing_limits();
    Ok(shape)
}

/// What a line above the names calls columns of values that it says are none: `Nominal`, `Toleranzen`.
fn group_of_no_value<'r>(record: &'r Record, named: &[Option<Named>]) -> Option<&'r Cell> {
    let is_of_none = |cell: &Cell| {
        let role = role(&cell.text());
        role != Some(Role::Deviation) && role.is_some_and(Role::is_beside_value)
    };
    let is_value = |named: &Option<Named>| {
        named.as_ref().is_some_and(|named| named.aspect == Role::Measured && !named.field.is_index())
    };
    record.cells.iter().enumerate().filter(|(_, cell)| is_of_none(cell)).find_map(|(place, cell)| {
        let behind = record.cells.iter().skip(place + 1).position(|cell| !cell.is_empty());
        let end = behind.map_or(named.len(), |behind| place + 1 + behind);
        named.get(place..end)?.iter().any(is_value).then_some(cell)
    })
}

/// Whether a row between blanks lacks a cell in front of one that it has: that one stands below another heading than its
/// number says.
pub(super) fn is_shifted(start: usize, header: &[Cell], row: &Record, separator: Separator) -> bool {
    let has_places = !matches!(separator, Separator::AlignedBlanks | Separator::Blanks);
    if has_places || row.cells.len() >= header.len() || row.numbers() == 0 {
        return false;
    }
    let headings = extents(start, header);
    let away = |heading: &Range<usize>, cell: &Range<usize>| {
        cell.start.saturating_sub(heading.end).max(heading.start.saturating_sub(cell.end))
    };
    let cells = extents(row.start, &row.cells);
    let mut cells = cells.iter().zip(&headings);
    cells.any(|(cell, own)| headings.iter().any(|other| away(other, cell) < away(own, cell)))
}

/// The cell of a row of units that stands below a heading: the one in its place, or, of fewer cells between blanks, the
/// one that begins nearest to it.
fn unit_below<'r>(header: &Record, units: &'r Record, place: usize) -> Option<&'r Cell> {
    let has_places = units.cells.iter().all(|cell| cell.span.is_empty());
    let found = if has_places || units.cells.len() == header.cells.len() {
        units.cells.get(place)
    } else {
        let headings = extents(header.start, &header.cells);
        let nearest = |cell: &Range<usize>| {
            headings.iter().enumerate().min_by_key(|(_, heading)| heading.start.abs_diff(cell.start))
        };
        let below = extents(units.start, &units.cells);
        let mut below = units.cells.iter().zip(&below);
        below.find(|(_, cell)| nearest(cell).is_some_and(|(nearest, _)| nearest == place)).map(|(cell, _)| cell)
    };
    found.filter(|cell| !cell.is_missing())
}

/// Whether a record has a unit of length or angle, and nothing longer than one elsewhere.
fn is_unit_row(record: &Record) -> bool {
    const LONGEST: usize = 12;
    let mut cells = record.cells.iter().filter(|cell| !cell.is_missing()).peekable();
    record.numbers() == 0
        && record.cells.iter().any(|cell| is_unit(&cell.text()))
        && cells.all(|cell| {
            let text = cell.text();
            is_unit(&text) || text.chars().count() <= LONGEST && !text.trim().contains(' ')
        })
}

/// Whether a minus stands before a name, so that its values are the other way round: `- M`.
fn has_minus(title: &str) -> bool {
    let name = title.trim_start();
    name.strip_prefix(['-', '–', '−'])
        .is_some_and(|name| name.trim_start().starts_with(|c: char| c.is_alphabetic() || c == '('))
}

/// How many records are rows: the table ends with the last line that has as many cells as it has columns and a number in
/// one of them, or that looks like a part whose values cannot be read.
fn end_of_rows(below: &[Record], width: usize, separator: Separator, id: usize) -> usize {
    let words = matches!(separator, Separator::Blanks | Separator::Lines);
    let fits = |record: &Record| {
        let count = record.cells.len();
        let is_missing = |cell: &Cell| !cell.is_empty() && cell.is_missing();
        let says_missing = || count == width && !record.says_nothing() && record.cells.iter().any(is_missing);
        (count > 1 || width == 1) && (count == width || !words) && (record.numbers() > 0 || says_missing())
    };
    let Some(last) = below.iter().rposition(fits) else { return 0 };
    let mut end = last + 1;
    let names =
        PartNames::of(below[..end].iter().filter(|record| record.numbers() > 0).filter_map(|row| row.cells.get(id)));
    for (index, record) in below.iter().enumerate().skip(end) {
        let follows = end == index && record.line == below[index - 1].line + 1;
        let first = record.cells.get(id).or(record.cells.first()).map(Cell::text).unwrap_or_default();
        // a row of a sheet ends with its last cell
        let is_sheet = record.cells.iter().all(|cell| cell.span.is_empty());
        let is_whole = record.cells.len() == width || is_sheet && record.numbers() == 0;
        // Rack 2   412
        let may_lack_cells = words && follows && record.numbers() > 1;
        if is_part(record, &first, width, words, follows) && !names.have_no(&first)
            || names.may_have(&first) && (follows || is_whole)
            || may_lack_cells
        {
            end = index + 1;
        }
    }
    end
}

/// Whether a record without numbers looks like a part: its name, and a cell for each column. What stands apart from the
/// rows is a part only if there are digits in it.
fn is_part(record: &Record, first: &str, width: usize, words: bool, follows: bool) -> bool {
    let word = first.split_whitespace().next().unwrap_or_default();
    let is_whole = record.cells.len() == width && width > 1;
    if record.says_nothing() || is_unit_row(record) || is_statistic(first) {
        return false;
    }
    let is_name = !first.is_empty() && first.trim() == word && !first.contains(':') && !is_context(word);
    if follows {
        return is_numbered(first) || is_whole && (record.filled().len() > 1 || is_name && !words);
    }
    is_whole && is_name && !words && record.cells.iter().any(|cell| has_digit(&cell.text()))
}
