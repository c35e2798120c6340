//! From records to columns: where the names stand, which cells belong to them, what is no part of the table.
//! Called once per separator; it does not read numbers beyond telling that they are some.

use super::grid::{Cell, Record, Separator};
use super::names::{Field, Holds, Role, heading, is_unit, role, split_unit};
use super::{Orientation, Want};
use crate::deviation::ErrorKind;

/// A column (or, turned, a row) of values with its meaning.
#[derive(Debug, Clone)]
pub(super) struct Column {
    pub(super) field: Field,
    /// As the block calls it; empty without a header.
    pub(super) title: String,
    pub(super) unit: Option<String>,
    pub(super) holds: Option<Holds>,
    /// One per part, space or tooth.
    pub(super) cells: Vec<Option<Cell>>,
    /// In a table with a row per characteristic: the nominal value that stands beside it.
    pub(super) nominal: Option<Cell>,
}

/// A block as a table.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    pub(super) orientation: Orientation,
    /// Line of the header, if there is one.
    pub(super) header_line: Option<usize>,
    pub(super) german: bool,
    pub(super) columns: Vec<Column>,
    /// Numbers beside the values, which tell the decimal mark as well.
    pub(super) others: Vec<Cell>,
    /// Headings that name nothing known.
    pub(super) other_columns: Vec<String>,
    /// Lines that are no part of the table: number and text.
    pub(super) ignored: Vec<(usize, String)>,
    /// Line and bytes of each part, space or tooth; one for all if they stand in columns.
    pub(super) places: Vec<(usize, std::ops::Range<usize>)>,
}

/// Why records are no table.
#[derive(Debug, Clone)]
pub(super) enum NoLayout {
    /// No line with a number.
    NoNumbers,
    /// A heading that could be two things.
    TwoMeanings { heading: Cell, fields: Vec<Field> },
    /// A row that has more cells than the header.
    Ragged { record: Record, expected: usize },
    /// The same name twice.
    Twice { heading: Cell, field: Field },
    /// Numbers without names, and a count that does not fit what is expected.
    Count { columns: usize, rows: usize, span: std::ops::Range<usize> },
    /// As many rows as columns, and no names: two ways to read it.
    Square,
}

/// Reads records as a table.
pub(super) fn layout(records: &[Record], separator: Separator, want: &Want) -> Result<Layout, NoLayout> {
    if records.iter().all(|record| record.numbers() == 0) {
        return Err(NoLayout::NoNumbers);
    }
    if want.fields.is_empty() {
        let header = find_header(records, separator, want);
        let characteristics = find_characteristics(records, want);
        let labels = find_labels(records, want);
        let header_score = header.as_ref().map_or(0, |header| header.known);
        if let Some(found) = characteristics.filter(|found| found.1.len() >= header_score.max(1)) {
            return by_characteristic(records, &found, want);
        }
        if labels.len() > header_score || (labels.len() == 1 && header_score == 1 && header.is_none()) {
            return by_label(records, &labels, want);
        }
        if let Some(header) = header {
            return by_header(records, &header, separator, want);
        }
    }
    without_names(records, want)
}

struct Header {
    record: usize,
    cells: Vec<Cell>,
    known: usize,
}

/// The record that names the most columns and has numbers below it.
fn find_header(records: &[Record], separator: Separator, want: &Want) -> Option<Header> {
    let mut best: Option<Header> = None;
    for (index, record) in records.iter().enumerate() {
        if record.numbers() > 0 {
            continue;
        }
        // a unit row may stand between
        let Some(data) = records[index + 1..].iter().take(3).find(|record| record.numbers() > 0) else { continue };
        let cells = match separator {
            Separator::Blanks => grouped(record, data.cells.len(), want),
            _ => Some(record.cells.clone()),
        };
        let Some(cells) = cells else { continue };
        let known = cells.iter().filter(|cell| heading(&cell.text, &want.own).is_some()).count();
        let values = cells.iter().any(|cell| {
            heading(&cell.text, &want.own).is_some_and(|heading| heading.fields.iter().any(|field| !field.is_index()))
        });
        if values && best.as_ref().is_none_or(|best| known > best.known) {
            best = Some(Header { record: index, cells, known });
        }
    }
    best
}

/// Words of a heading line put together to as many cells as the rows below have.
fn grouped(record: &Record, wanted: usize, want: &Want) -> Option<Vec<Cell>> {
    const LONGEST_NAME: usize = 6;
    let words = &record.cells;
    if words.len() > 200 {
        return None;
    }
    let merge = |from: usize, to: usize| {
        let text = words[from..to].iter().map(|cell| cell.text.as_str()).collect::<Vec<_>>().join(" ");
        Cell { text, span: words[from].span.start..words[to - 1].span.end }
    };
    let mut cells = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let most = (words.len() - at).min(LONGEST_NAME);
        let length = (1..=most).rev().find(|length| {
            let text = merge(at, at + length).text;
            heading(&text, &want.own).is_some_and(|found| {
                // two names in one: the second begins with a word that names a part or a value by itself
                *length == 1 || found.fields.len() == 1 || found.unit.is_some()
            }) && !(2..*length).any(|split| {
                heading(&merge(at, at + split).text, &want.own).is_some_and(|head| head.fields.len() == 1)
                    && heading(&merge(at + split, at + length).text, &want.own)
                        .is_some_and(|tail| !tail.fields.is_empty())
            })
        });
        let length = length.unwrap_or(1);
        cells.push(merge(at, at + length));
        at += length;
    }
    (cells.len() == wanted).then_some(cells)
}

/// The records whose first cell is a name with numbers after it.
fn find_labels(records: &[Record], want: &Want) -> Vec<usize> {
    let known = |record: &Record| {
        record.cells.len() > 1
            && record.cells[1..].iter().any(Cell::is_number)
            && heading(&record.cells[0].text, &want.own)
                .is_some_and(|heading| heading.fields.iter().any(|field| !field.is_index()))
    };
    (0..records.len()).filter(|index| known(&records[*index])).collect()
}

/// A header that speaks of nominal and actual values, and the records below it that start with a name.
fn find_characteristics(records: &[Record], want: &Want) -> Option<(usize, Vec<usize>)> {
    let header = records.iter().position(|record| {
        let roles: Vec<_> = record.cells.iter().filter_map(|cell| role(&cell.text)).collect();
        record.numbers() == 0
            && roles.len() > 1
            && roles.iter().any(|role| matches!(role, Role::Measured | Role::Deviation))
    })?;
    let name = name_column(&records[header]);
    let rows = (header + 1..records.len()).filter(|index| {
        let record = &records[*index];
        record.numbers() > 0 && record.cells.get(name).is_some_and(|cell| heading(&cell.text, &want.own).is_some())
    });
    let rows: Vec<_> = rows.collect();
    (!rows.is_empty()).then_some((header, rows))
}

fn name_column(header: &Record) -> usize {
    header.cells.iter().position(|cell| role(&cell.text) == Some(Role::Name)).unwrap_or(0)
}

fn one_meaning(found: &[Field], want: &Want, title: &Cell) -> Result<Field, NoLayout> {
    if let [field] = found {
        return Ok(*field);
    }
    let mut expected = found.iter().filter(|field| want.expected.iter().any(|kind| Field::Error(*kind) == **field));
    match (expected.next(), expected.next()) {
        (Some(field), None) => Ok(*field),
        _ => Err(NoLayout::TwoMeanings { heading: title.clone(), fields: found.to_vec() }),
    }
}

/// Headings as columns; `None` for those that are not known.
fn columns(cells: &[Cell], want: &Want) -> Result<(Vec<Option<Column>>, bool), NoLayout> {
    let headings: Vec<_> = cells.iter().map(|cell| heading(&cell.text, &want.own)).collect();
    // in a table of a pinion's teeth, or in one that has values of one part only, `pitch` is that part's
    let of = |kinds: &[ErrorKind]| {
        headings
            .iter()
            .flatten()
            .any(|heading| matches!(heading.fields.as_slice(), [Field::Error(kind)] if kinds.contains(kind)))
    };
    let rack = of(&[ErrorKind::RackOverRoller, ErrorKind::RackLead]);
    let pinion = of(&[ErrorKind::PinionRadial]);
    let mut german = false;
    let mut columns: Vec<Option<Column>> = Vec::with_capacity(cells.len());
    for (cell, heading) in cells.iter().zip(headings) {
        let Some(mut heading) = heading else {
            columns.push(None);
            continue;
        };
        german |= heading.german;
        if heading.fields.len() > 1 && rack != pinion {
            let wanted = if rack { ErrorKind::RackPitch } else { ErrorKind::PinionPitch };
            heading.fields.retain(|field| *field == Field::Error(wanted));
        }
        let field = one_meaning(&heading.fields, want, cell)?;
        if columns.iter().flatten().any(|column| column.field == field) {
            return Err(NoLayout::Twice { heading: cell.clone(), field });
        }
        columns.push(Some(Column {
            field,
            title: cell.text.clone(),
            unit: heading.unit,
            holds: heading.holds,
            cells: Vec::new(),
            nominal: None,
        }));
    }
    Ok((columns, german))
}

fn by_header(records: &[Record], header: &Header, separator: Separator, want: &Want) -> Result<Layout, NoLayout> {
    let (mut columns, german) = columns(&header.cells, want)?;
    let width = header.cells.len();
    let mut ignored: Vec<_> = records[..header.record].iter().map(ignore).collect();
    let mut places = Vec::new();
    let mut below = &records[header.record + 1..];
    let is_unit_row = |record: &&Record| record.cells.iter().all(|cell| cell.text.is_empty() || is_unit(&cell.text));
    if let Some(units) = below.first().filter(is_unit_row) {
        for (column, cell) in columns.iter_mut().zip(&units.cells) {
            if let Some(column) = column.as_mut().filter(|column| column.unit.is_none() && !cell.text.is_empty()) {
                column.unit = Some(bare_unit(&cell.text));
            }
        }
        below = &below[1..];
    }
    // the table ends with the last line that has as many cells as it has columns and a number in one of them
    let words = matches!(separator, Separator::Blanks | Separator::Lines);
    let fits = |record: &Record| {
        let count = record.cells.len();
        (count > 1 || width == 1) && (count == width || !words)
    };
    let end = below.iter().rposition(|record| fits(record) && record.numbers() > 0).map_or(0, |index| index + 1);
    for record in &below[..end] {
        let is_value = |(index, column): (usize, &Option<Column>)| {
            column.as_ref().is_some_and(|column| !column.field.is_index())
                && record.cells.get(index).is_some_and(|cell| !cell.text.is_empty())
        };
        let has_value = columns.iter().enumerate().any(is_value);
        if record.cells.len() > width || (record.numbers() > 0 && !fits(record)) {
            return Err(NoLayout::Ragged { record: record.clone(), expected: width });
        }
        if record.numbers() == 0 && (!has_value || record.cells.len() < width) {
            ignored.push(ignore(record));
            continue;
        }
        for (index, column) in columns.iter_mut().enumerate() {
            if let Some(column) = column {
                column.cells.push(record.cells.get(index).cloned());
            }
        }
        places.push((record.line, record.span.clone()));
    }
    if places.is_empty() {
        let ragged = below.iter().find(|record| record.numbers() > 0);
        return Err(
            ragged.map_or(NoLayout::NoNumbers, |record| NoLayout::Ragged { record: record.clone(), expected: width })
        );
    }
    ignored.extend(below[end..].iter().map(ignore));
    let other_columns = header
        .cells
        .iter()
        .zip(&columns)
        .filter(|(cell, column)| column.is_none() && !cell.text.is_empty())
        .map(|(cell, _)| cell.text.clone())
        .collect();
    Ok(Layout {
        orientation: Orientation::Rows,
        header_line: Some(records[header.record].line),
        german,
        columns: columns.into_iter().flatten().collect(),
        others: Vec::new(),
        other_columns,
        ignored,
        places,
    })
}

fn bare_unit(text: &str) -> String {
    text.trim_matches(['[', ']', '(', ')']).trim().to_owned()
}

fn ignore(record: &Record) -> (usize, String) {
    let text: Vec<_> = record.cells.iter().map(|cell| cell.text.as_str()).filter(|text| !text.is_empty()).collect();
    (record.line, text.join(" "))
}

/// One line per name, with a value per part behind it.
fn by_label(records: &[Record], labels: &[usize], want: &Want) -> Result<Layout, NoLayout> {
    let names: Vec<_> = labels.iter().map(|index| records[*index].cells[0].clone()).collect();
    let (columns, german) = columns(&names, want)?;
    let mut columns: Vec<_> = columns.into_iter().flatten().collect();
    let mut count = 0;
    for (column, index) in columns.iter_mut().zip(labels) {
        for cell in &records[*index].cells[1..] {
            match column.cells.last_mut() {
                // 12,5 | µm
                Some(Some(last)) if is_unit(&cell.text) => {
                    last.text = format!("{} {}", last.text, bare_unit(&cell.text));
                }
                None if is_unit(&cell.text) && column.unit.is_none() => {
                    column.unit = Some(bare_unit(&cell.text));
                }
                _ => column.cells.push(Some(cell.clone())),
            }
        }
        count = count.max(column.cells.len());
    }
    let mut ignored = Vec::new();
    for (index, record) in records.iter().enumerate().filter(|(index, _)| !labels.contains(index)) {
        let index_row = heading(&record.cells[0].text, &want.own).filter(|heading| {
            record.cells.len() == count + 1 && heading.fields.first().is_some_and(|field| field.is_index())
        });
        match index_row {
            Some(heading) if index < labels[0] => columns.push(Column {
                field: heading.fields[0],
                title: record.cells[0].text.clone(),
                unit: None,
                holds: None,
                cells: record.cells[1..].iter().cloned().map(Some).collect(),
                nominal: None,
            }),
            _ => ignored.push(ignore(record)),
        }
    }
    for (column, index) in columns.iter().zip(labels) {
        if column.cells.len() != count {
            return Err(NoLayout::Ragged { record: records[*index].clone(), expected: count + 1 });
        }
    }
    let first = &records[labels[0]];
    let place = (first.line, first.span.clone());
    Ok(Layout {
        orientation: Orientation::Columns,
        header_line: None,
        german,
        columns,
        others: Vec::new(),
        other_columns: Vec::new(),
        ignored,
        places: vec![place; count],
    })
}

/// A row per characteristic, with columns such as nominal, actual, deviation, unit.
fn by_characteristic(records: &[Record], found: &(usize, Vec<usize>), want: &Want) -> Result<Layout, NoLayout> {
    let (header, rows) = (found.0, &found.1);
    let roles: Vec<_> = records[header].cells.iter().map(|cell| role(&cell.text)).collect();
    let units: Vec<_> = records[header].cells.iter().map(|cell| split_unit(&cell.text).1).collect();
    let name = name_column(&records[header]);
    let names: Vec<_> = rows.iter().map(|index| records[*index].cells[name].clone()).collect();
    let (columns, german) = columns(&names, want)?;
    let mut columns: Vec<_> = columns.into_iter().flatten().collect();
    let at = |role: Role| roles.iter().position(|other| *other == Some(role));
    for (column, index) in columns.iter_mut().zip(rows) {
        let record = &records[*index];
        if record.cells.len() > roles.len() {
            return Err(NoLayout::Ragged { record: record.clone(), expected: roles.len() });
        }
        let cell = |role: Role| {
            let index = at(role)?;
            let cell = record.cells.get(index).filter(|cell| !crate::cmm::written::is_empty(&cell.text))?;
            Some((cell.clone(), units[index].clone()))
        };
        let unit = cell(Role::Unit).map(|(cell, _)| bare_unit(&cell.text));
        // the value and its nominal, or else the deviation
        let (value, nominal, holds) = match (cell(Role::Measured), cell(Role::Nominal), cell(Role::Deviation)) {
            (Some(measured), nominal @ Some(_), _) => (Some(measured), nominal, Holds::Measured),
            (_, _, Some(deviation)) => (Some(deviation), None, Holds::Deviation),
            (measured, _, None) => (measured, None, Holds::Measured),
        };
        column.unit = column.unit.take().or(unit).or_else(|| value.as_ref().and_then(|(_, unit)| unit.clone()));
        // without a column of deviations, what the heading or the spec says of the value holds
        if holds == Holds::Deviation || nominal.is_some() {
            column.holds = Some(holds);
        }
        column.nominal = nominal.map(|(cell, _)| cell);
        column.cells.push(value.map(|(cell, _)| cell));
    }
    let ignored = (0..records.len()).filter(|index| *index != header && !rows.contains(index));
    let first = &records[rows[0]];
    Ok(Layout {
        orientation: Orientation::Columns,
        header_line: Some(records[header].line),
        german: german || records[header].cells.iter().any(|cell| cell.text.to_lowercase().contains("ist")),
        columns,
        others: rows.iter().flat_map(|index| records[*index].cells.iter().cloned()).collect(),
        other_columns: Vec::new(),
        ignored: ignored.map(|index| ignore(&records[index])).collect(),
        places: vec![(first.line, first.span.clone())],
    })
}

/// Numbers without names: what they are is asked for, or is the spec's order.
fn without_names(records: &[Record], want: &Want) -> Result<Layout, NoLayout> {
    let fields: Vec<Field> = if want.fields.is_empty() {
        want.expected.iter().map(|kind| Field::Error(*kind)).collect()
    } else {
        want.fields.clone()
    };
    // lines of numbers, perhaps with a name in front
    let numeric = |record: &Record| {
        let text = record.cells.iter().filter(|cell| !cell.is_number() && !crate::cmm::written::is_empty(&cell.text));
        let text = text.count();
        let first_is_text = record.cells.first().is_some_and(|cell| !cell.is_number());
        record.numbers() > 0 && (text == 0 || (text == 1 && first_is_text))
    };
    let rows: Vec<&Record> = records.iter().filter(|record| numeric(record)).collect();
    let Some(first) = rows.first() else { return Err(NoLayout::NoNumbers) };
    let labelled = rows.iter().any(|record| !record.cells[0].is_number());
    let width = rows.iter().map(|record| record.cells.len()).max().unwrap_or(0);
    let span = first.span.start..rows.last().map_or(first.span.end, |record| record.span.end);
    let wanted = fields.len();
    let with_id = fields.contains(&Field::PartId);
    // a name in front of every row
    let offset = usize::from(!with_id && (labelled || width == wanted + 1));
    let as_rows = width == wanted + offset && rows.iter().all(|record| record.cells.len() == width);
    let as_columns = !labelled && rows.len() == wanted && rows.iter().all(|record| record.cells.len() == width);
    if as_rows && as_columns && wanted > 1 && want.orientation.is_none() {
        return Err(NoLayout::Square);
    }
    let ignored = records.iter().filter(|record| !numeric(record)).map(ignore).collect();
    let column = |field: Field, cells: Vec<Option<Cell>>| Column {
        field,
        title: String::new(),
        unit: None,
        holds: None,
        cells,
        nominal: None,
    };
    let rowwise = as_rows && want.orientation != Some(Orientation::Columns);
    if rowwise {
        let mut columns: Vec<_> = fields
            .iter()
            .enumerate()
            .map(|(index, field)| {
                column(*field, rows.iter().map(|row| row.cells.get(index + offset).cloned()).collect())
            })
            .collect();
        if offset == 1 {
            columns.insert(0, column(Field::PartId, rows.iter().map(|row| row.cells.first().cloned()).collect()));
        }
        return Ok(Layout {
            orientation: Orientation::Rows,
            header_line: None,
            german: false,
            columns,
            others: Vec::new(),
            other_columns: Vec::new(),
            ignored,
            places: rows.iter().map(|row| (row.line, row.span.clone())).collect(),
        });
    }
    if as_columns && want.orientation != Some(Orientation::Rows) {
        let columns =
            fields.iter().zip(&rows).map(|(field, row)| column(*field, row.cells.iter().cloned().map(Some).collect()));
        return Ok(Layout {
            orientation: Orientation::Columns,
            header_line: None,
            german: false,
            columns: columns.collect(),
            others: Vec::new(),
            other_columns: Vec::new(),
            ignored,
            places: vec![(first.line, first.span.clone()); width],
        });
    }
    Err(NoLayout::Count { columns: width, rows: rows.len(), span })
}
