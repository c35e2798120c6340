//! From records to measurements: where the names stand, which cells belong to them, what is no part of the table. Called
//! once for each separator that a text may have, and once for a sheet; reads no number beyond telling that it is one.
//!
//! | shape | where the names are |
//! |---|---|
//! | rows | a header; each row below it is a part, a space or a tooth |
//! | labels | the first cell of each line, with a value per part behind it |
//! | characteristics | one column; others hold the actual and nominal values, tolerances and units |
//! | bare | nowhere: the order of the spec, or of `--as` |

use std::borrow::Cow;

use super::cell::{Cell, Record};
use super::characteristics::{by_characteristic, find_characteristics};
use super::grid::{Separator, bare_unit, is_unit};
use super::names::{Aspect, Field, Heading, Holds, Role, heading, is_evaluation_length, role, split_unit};
use super::strangers::{could_be_measured, unit_in};
use super::want::{Orientation, Want};
use crate::deviation::ErrorKind;
use crate::quantity::Unit;

/// The cells of one name.
#[derive(Debug, Clone, Default)]
pub(crate) struct Series {
    /// As the table calls it; empty without names.
    pub(crate) title: String,
    /// Its place in a record, where rows are parts.
    pub(crate) place: usize,
    /// The unit, as it is written.
    pub(crate) unit: Option<String>,
    /// One per part, space or tooth.
    pub(crate) cells: Vec<Cell>,
}

/// Everything that a table says of one field.
#[derive(Debug, Clone)]
pub(crate) struct Measurement {
    pub(crate) field: Field,
    /// Whether the value is the measure or its deviation, if the table says so.
    pub(crate) holds: Option<Holds>,
    pub(crate) value: Series,
    /// The deviation that stands beside a measured value.
    pub(crate) deviation: Option<Series>,
    pub(crate) nominal: Option<Series>,
    pub(crate) upper: Option<Series>,
    pub(crate) lower: Option<Series>,
    pub(crate) uncertainty: Option<Series>,
}

/// A column or line that names nothing known.
#[derive(Debug, Clone)]
pub(crate) struct Unknown {
    pub(crate) title: String,
    /// `column 4`, `line 7`.
    pub(crate) place: String,
    /// Its place in a record, if it is a column.
    pub(crate) column: Option<usize>,
    /// The unit that stands below its heading or beside it.
    pub(crate) unit: Option<String>,
    pub(crate) cells: Vec<Cell>,
    /// Whether it is a measurement because of where it stands: a row of a table of characteristics.
    pub(crate) is_measurement: bool,
}

impl Unknown {
    pub(crate) fn column(title: &str, column: usize, cells: Vec<Cell>) -> Self {
        let place = format!("column {}", column + 1);
        Self { title: title.to_owned(), place, column: Some(column), unit: None, cells, is_measurement: false }
    }

    /// A line with a name in front of its cells.
    pub(crate) fn line(title: &str, line: u64, cells: Vec<Cell>) -> Self {
        let place = format!("line {line}");
        Self { title: title.to_owned(), place, column: None, unit: None, cells, is_measurement: false }
    }

    pub(crate) fn measured(self, is_measurement: bool) -> Self {
        Self { is_measurement, ..self }
    }
}

/// A line that is no part of the table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Aside {
    pub(crate) line: u64,
    pub(crate) text: String,
}

/// A text as a table.
#[derive(Debug, Clone)]
pub(crate) struct Shape {
    pub(crate) orientation: Orientation,
    /// Line of the names, if they stand in one.
    pub(crate) header_line: Option<u64>,
    /// The names of the columns, where rows are parts.
    pub(crate) header: Vec<Cell>,
    /// The records that are parts, where rows are.
    pub(crate) data: std::ops::Range<usize>,
    pub(crate) ids: Option<Series>,
    /// The numbers of spaces or teeth.
    pub(crate) index: Option<Series>,
    pub(crate) index_field: Option<Field>,
    /// Evaluation lengths of f_Hβ.
    pub(crate) lengths: Option<Series>,
    pub(crate) measurements: Vec<Measurement>,
    pub(crate) unknown: Vec<Unknown>,
    pub(crate) asides: Vec<Aside>,
    /// The line of each part, space or tooth.
    pub(crate) lines: Vec<u64>,
    /// Whether its language writes decimal commas.
    pub(crate) commas: bool,
    /// Numbers beside the values, which tell the decimal mark as well.
    pub(crate) beside: Vec<Cell>,
}

/// Why records are no table.
#[derive(Debug, Clone)]
pub(crate) enum NoShape {
    /// No line with a number.
    NoNumbers,
    /// Names, and no numbers below them.
    NoRows { names: String },
    /// A quote that is not closed.
    OpenQuote { line: u64 },
    /// A heading that could be two things.
    TwoMeanings { heading: Cell, fields: Vec<Field> },
    /// A row that has more or fewer cells than the header.
    Ragged { record: Record, expected: usize },
    /// The same name twice.
    Twice { heading: Cell, field: Field },
    /// Numbers without names, and a count that does not fit what is expected.
    Count { columns: usize, rows: usize, span: std::ops::Range<usize> },
    /// A characteristic whose rows have different units.
    Units { record: Record },
    /// A column of nominal values or tolerances, and none of which it is clear that it holds a part's values.
    NoPart { heading: Cell },
    /// Two columns of actual values, or of another role that a table of characteristics has once.
    TwoColumns { first: Cell, second: Cell },
    /// As many rows as columns, and no names: two ways to read it.
    Square,
}

/// A column with a known name.
#[derive(Debug, Clone)]
pub(crate) struct Named {
    pub(crate) field: Field,
    pub(crate) aspect: Aspect,
    pub(crate) holds: Option<Holds>,
    pub(crate) series: Series,
}

/// What the headings of a table are.
pub(crate) struct Headings {
    /// One per heading; `None` if it is not known.
    pub(crate) named: Vec<Option<Named>>,
    pub(crate) commas: bool,
}

impl Shape {
    pub(crate) fn new(orientation: Orientation) -> Self {
        Self {
            orientation,
            header_line: None,
            header: Vec::new(),
            data: 0..0,
            ids: None,
            index: None,
            index_field: None,
            lengths: None,
            measurements: Vec::new(),
            unknown: Vec::new(),
            asides: Vec::new(),
            lines: Vec::new(),
            commas: false,
            beside: Vec::new(),
        }
    }

    /// Takes a column with a known name.
    pub(crate) fn take(&mut self, named: Named) -> Result<(), NoShape> {
        let Named { field, aspect, holds, series } = named;
        if matches!(field, Field::PartId | Field::Space | Field::Tooth) {
            let slot = if field == Field::PartId { &mut self.ids } else { &mut self.index };
            if slot.is_some() {
                return Err(twice(&series, field));
            }
            *slot = Some(series);
            if field != Field::PartId {
                self.index_field = Some(field);
            }
            return Ok(());
        }
        let known = self.measurements.iter().position(|measurement| measurement.field == field);
        let at = known.unwrap_or_else(|| {
            self.measurements.push(Measurement {
                field,
                holds: None,
                value: Series::default(),
                deviation: None,
                nominal: None,
                upper: None,
                lower: None,
                uncertainty: None,
            });
            self.measurements.len() - 1
        });
        let fresh = known.is_none();
        self.measurements[at].take(aspect, holds, series, fresh)
    }

    /// Takes a column that says of no field that it is nominal, a tolerance or a deviation: it belongs to the value before
    /// it. Whether it was taken.
    fn take_beside(&mut self, title: &str, place: usize, cells: &dyn Fn(usize) -> Vec<Cell>) -> bool {
        let Some(measurement) = self.measurements.last_mut().filter(|found| !found.value.title.is_empty()) else {
            return false;
        };
        let slot = match role(title) {
            Some(Role::Nominal) => &mut measurement.nominal,
            Some(Role::Deviation) => &mut measurement.deviation,
            Some(Role::Upper) => &mut measurement.upper,
            Some(Role::Lower) => &mut measurement.lower,
            Some(Role::Uncertainty) => &mut measurement.uncertainty,
            _ => return false,
        };
        if slot.is_some() {
            return false;
        }
        let (_, unit) = split_unit(title);
        *slot = Some(Series { title: title.to_owned(), place, unit, cells: cells(place) });
        true
    }

    /// Leaves out what has companions but no value: its nominal value says nothing of a part.
    pub(crate) fn drop_valueless(&mut self) {
        let (kept, dropped) = std::mem::take(&mut self.measurements)
            .into_iter()
            .partition(|measurement| !measurement.value.title.is_empty() || !measurement.value.cells.is_empty());
        self.measurements = kept;
        for measurement in dropped {
            let Measurement { deviation, nominal, upper, lower, uncertainty, .. } = measurement;
            for series in [deviation, nominal, upper, lower, uncertainty].into_iter().flatten() {
                self.unknown.push(Unknown::column(&series.title, series.place, series.cells));
            }
        }
    }
}

impl Shape {
    /// Takes a column that holds nothing but units as those of the unknown column before it.
    fn take_units_beside(&mut self) {
        let units = |unknown: &Unknown| -> Option<(usize, String)> {
            let mut cells = unknown.cells.iter().filter(|cell| !cell.is_missing()).peekable();
            let first = bare_unit(&cells.peek()?.text()).to_owned();
            cells.all(|cell| is_unit(&cell.text())).then_some((unknown.column?, first))
        };
        for (place, unit) in self.unknown.iter().filter_map(units).collect::<Vec<_>>() {
            let before = self.unknown.iter_mut().find(|unknown| unknown.column.is_some_and(|at| at + 1 == place));
            if let Some(before) = before {
                before.unit.get_or_insert(unit);
            }
        }
    }

    /// The columns that hold no numbers as far as the table was looked at, and would be measurements if they did.
    pub(crate) fn watched(&self, want: &Want) -> Vec<usize> {
        let would_be = |unknown: &&Unknown| {
            let with_number = Unknown { cells: vec![Cell::of_text("0", 0..0)], ..(*unknown).clone() };
            let has_numbers = unknown.cells.iter().any(Cell::is_number);
            !has_numbers && !want.ignores(&unknown.title) && could_be_measured(&with_number)
        };
        self.unknown.iter().filter(would_be).filter_map(|unknown| unknown.column).collect()
    }
}

fn twice(series: &Series, field: Field) -> NoShape {
    NoShape::Twice { heading: Cell::of_text(&series.title, 0..0), field }
}

impl Measurement {
    /// Takes one of the columns that belong to the field; `fresh` if it is the first.
    fn take(&mut self, aspect: Aspect, holds: Option<Holds>, series: Series, fresh: bool) -> Result<(), NoShape> {
        let has_value = !fresh && !self.value.title.is_empty();
        let slot = match aspect {
            Aspect::Value if !has_value => {
                self.holds = holds;
                self.value = series;
                return Ok(());
            }
            // a measured value counts, and the deviation beside it is held against it
            Aspect::Value if holds == Some(Holds::Deviation) && self.holds != holds => &mut self.deviation,
            Aspect::Value if self.holds == Some(Holds::Deviation) && holds != self.holds => {
                self.deviation = Some(std::mem::replace(&mut self.value, series));
                self.holds = holds.or(Some(Holds::Measured));
                return Ok(());
            }
            Aspect::Value => return Err(twice(&series, self.field)),
            Aspect::Nominal => &mut self.nominal,
            Aspect::Upper => &mut self.upper,
            Aspect::Lower => &mut self.lower,
            Aspect::Uncertainty => &mut self.uncertainty,
        };
        if slot.is_some() {
            return Err(twice(&series, self.field));
        }
        if aspect == Aspect::Value {
            self.holds = Some(Holds::Measured);
        }
        *slot = Some(series);
        Ok(())
    }
}

/// Reads records as a table.
pub(crate) fn shape(records: &[Record], separator: Separator, want: &Want) -> Result<Shape, NoShape> {
    let header = find_header(records, separator, want);
    if records.iter().all(|record| record.numbers() == 0) {
        return Err(match records.iter().find(|record| known(&record.cells, want) > 0) {
            Some(names) => NoShape::NoRows { names: names.in_words() },
            None => NoShape::NoNumbers,
        });
    }
    if !want.fields.is_empty() {
        return without_names(&without_margin(records, separator), want);
    }
    let characteristics = find_characteristics(records, want);
    let mut inner = without_margin(records, separator);
    if inner.iter().any(is_counted) {
        inner = inner.iter().map(uncounted).collect();
    }
    let labels = find_labels(&inner, want);
    let named = header.as_ref().map_or(0, |header| header.known);
    if let Some(found) = characteristics.filter(|found| found.known >= named) {
        return by_characteristic(records, &found, want);
    }
    if let Some(columns) = columns_of_no_part(&inner, &labels) {
        return Err(columns);
    }
    if labels.len() > named || (labels.len() == 1 && named <= 1 && header.is_none()) {
        return by_label(&inner, &labels, want);
    }
    if let Some(header) = header {
        return by_header(records, &header, separator, want);
    }
    match header_of_strangers(records) {
        Some(header) => by_header(records, &header, separator, want),
        None => without_names(&inner, want),
    }
}

/// The records of a table between bars, as Markdown draws it, or of a sheet, without the empty cells at its left side.
fn without_margin(records: &[Record], separator: Separator) -> Cow<'_, [Record]> {
    let of_table = |record: &&Record| record.cells.len() > 1;
    let has_margin = matches!(separator, Separator::Character(b'|') | Separator::TAB)
        && records.iter().filter(of_table).all(|record| record.cells[0].is_empty());
    if !has_margin {
        return records.into();
    }
    let inner = |record: &Record| {
        let cells = record.cells.get(1..).filter(|cells| !cells.is_empty()).unwrap_or(&record.cells);
        Record { cells: cells.to_vec(), ..record.clone() }
    };
    records.iter().map(inner).collect()
}

pub(crate) struct Header {
    record: usize,
    /// How many records it takes.
    rows: usize,
    cells: Vec<Cell>,
    known: usize,
}

fn known(cells: &[Cell], want: &Want) -> usize {
    cells.iter().filter(|cell| is_known(cell, want)).count()
}

fn is_known(cell: &Cell, want: &Want) -> bool {
    let text = cell.text();
    heading(&text, &want.own).is_some() || is_evaluation_length(&text)
}

/// Whether a cell names a value, and not only a part.
pub(crate) fn names_value(cell: &Cell, want: &Want) -> bool {
    heading(&cell.text(), &want.own).is_some_and(|heading| heading.fields.iter().any(|field| !field.is_index()))
}

/// The record that names the most columns and has numbers below it.
fn find_header(records: &[Record], separator: Separator, want: &Want) -> Option<Header> {
    /// Names stand at the top.
    const LOOKED_AT: usize = 200;
    let mut best: Option<Header> = None;
    for (index, record) in records.iter().enumerate().take(LOOKED_AT) {
        if record.numbers() > 0 {
            continue;
        }
        // a unit row, or a line drawn below, may stand between
        let Some(data) = records[index + 1..].iter().take(3).find(|record| record.numbers() > 0) else { continue };
        let cells = match separator {
            Separator::Blanks => grouped(record, data.cells.len(), want),
            _ => Some(record.cells.clone()),
        };
        let Some(cells) = cells else { continue };
        for header in [header(index, 1, cells.clone(), want), two_rows(records, index, &cells, want)] {
            let Some(header) = header else { continue };
            if best.as_ref().is_none_or(|best| header.score(want) > best.score(want)) {
                best = Some(header);
            }
        }
    }
    best
}

/// Cells as a header, if they name a value.
fn header(record: usize, rows: usize, cells: Vec<Cell>, want: &Want) -> Option<Header> {
    let known = known(&cells, want);
    cells.iter().any(|cell| names_value(cell, want)).then_some(Header { record, rows, cells, known })
}

/// A heading that goes on in the record below it.
fn two_rows(records: &[Record], index: usize, cells: &[Cell], want: &Want) -> Option<Header> {
    let below = records.get(index + 1)?;
    let goes_on =
        below.numbers() == 0 && below.cells.len() == cells.len() && !below.says_nothing() && !is_unit_row(below);
    if !goes_on || known(&below.cells, want) > 1 {
        return None;
    }
    let joined = cells.iter().zip(&below.cells).map(|(upper, lower)| {
        let text = format!("{} {}", upper.text(), lower.text());
        Cell::of_text(text.trim(), upper.span.clone())
    });
    header(index, 2, joined.collect(), want)
}

impl Header {
    /// How much of it is understood; a name that could be two things is half understood.
    fn score(&self, want: &Want) -> usize {
        let of = |cell: &Cell| match heading(&cell.text(), &want.own) {
            Some(heading) if heading.fields.len() == 1 => 2,
            Some(_) => 1,
            None => usize::from(is_evaluation_length(&cell.text())),
        };
        self.cells.iter().map(of).sum()
    }
}

/// A line of names right above the first numbers, with as many cells, though none of the names is known.
fn header_of_strangers(records: &[Record]) -> Option<Header> {
    let record = records.iter().zip(records.get(1..)?).position(|(_, below)| below.numbers() > 0)?;
    let (names, below) = (&records[record], &records[record + 1]);
    let is_header = names.numbers() == 0
        && !names.says_nothing()
        && names.filled().len() == below.filled().len()
        && names.line + 1 == below.line;
    is_header.then(|| Header { record, rows: 1, cells: names.cells.clone(), known: 0 })
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

/// Whether its first cell counts lines: `003`, `10.`, `1/2`.
fn is_counted(record: &Record) -> bool {
    let counts = |text: &str| {
        let digits = text.trim_end_matches(['.', ')', ':']);
        text.starts_with(|c: char| c.is_ascii_digit()) && digits.chars().all(|c| c.is_ascii_digit() || c == '/')
    };
    record.cells.first().is_some_and(|cell| counts(&cell.text()))
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
    let cells = std::iter::once(name).chain(record.cells[words + 1..].iter().cloned());
    Record { cells: cells.collect(), ..record.clone() }
}

/// The records whose first cell is a name with numbers after it.
fn find_labels(records: &[Record], want: &Want) -> Vec<usize> {
    let known = |record: &Record| {
        record.filled().len() > 1
            && record.cells[1..].iter().any(Cell::is_number)
            && !record.cells[0].is_measure()
            && names_value(&record.cells[0], want)
    };
    (0..records.len()).filter(|index| known(&records[*index])).collect()
}

/// A line above labels that calls a column nominal or a tolerance: the values of such a column are no part's.
fn columns_of_no_part(records: &[Record], labels: &[usize]) -> Option<NoShape> {
    let above = &records[..*labels.first()?];
    let is_none = |cell: &&Cell| {
        matches!(
            role(&cell.text()),
            Some(Role::Nominal | Role::Upper | Role::Lower | Role::Deviation | Role::Uncertainty)
        )
    };
    let heading = above.iter().flat_map(|record| &record.cells).find(is_none)?;
    Some(NoShape::NoPart { heading: heading.clone() })
}

fn one_meaning(found: &[Field], want: &Want, title: &Cell) -> Result<Field, NoShape> {
    if let [field] = found {
        return Ok(*field);
    }
    let mut expected = found.iter().filter(|field| want.expected.iter().any(|kind| Field::Error(*kind) == **field));
    match (expected.next(), expected.next()) {
        (Some(field), None) => Ok(*field),
        _ => Err(NoShape::TwoMeanings { heading: title.clone(), fields: found.to_vec() }),
    }
}

/// What headings mean; `None` for those that are not known or that the user leaves out.
pub(crate) fn headings(cells: &[Cell], want: &Want) -> Result<Headings, NoShape> {
    let understood = |cell: &Cell| {
        let text = cell.text();
        if want.ignores(&text) { None } else { heading(&text, &want.own) }
    };
    let found: Vec<_> = cells.iter().map(understood).collect();
    // in a table of a pinion's teeth, or in one that has values of one part only, `pitch` is that part's
    let of = |kinds: &[ErrorKind]| {
        let is_so =
            |heading: &Heading| matches!(heading.fields.as_slice(), [Field::Error(kind)] if kinds.contains(kind));
        found.iter().flatten().any(is_so)
    };
    let rack = of(&[ErrorKind::RackOverRoller, ErrorKind::RackLead]);
    let pinion = of(&[ErrorKind::PinionRadial]);
    let commas = found.iter().flatten().any(|heading| heading.commas);
    let mut named: Vec<Option<Named>> = Vec::with_capacity(cells.len());
    for (place, (cell, heading)) in cells.iter().zip(found).enumerate() {
        let Some(mut heading) = heading else {
            named.push(None);
            continue;
        };
        if heading.fields.len() > 1 && rack != pinion && want.expected.is_empty() {
            let wanted = if rack { ErrorKind::RackPitch } else { ErrorKind::PinionPitch };
            heading.fields.retain(|field| *field == Field::Error(wanted));
        }
        let field = one_meaning(&heading.fields, want, cell)?;
        let series = Series { title: cell.text().into_owned(), place, unit: heading.unit, cells: Vec::new() };
        named.push(Some(Named { field, aspect: heading.aspect, holds: heading.holds, series }));
    }
    drop_second_part_names(&mut named, want);
    Ok(Headings { named, commas })
}

/// Of several columns that may name the part, the one that the spec names, or else the first; a second one is no error.
fn drop_second_part_names(named: &mut [Option<Named>], want: &Want) {
    let is_id = |found: &Option<Named>| found.as_ref().is_some_and(|found| found.field == Field::PartId);
    let own = named
        .iter()
        .position(|found| is_id(found) && found.as_ref().is_some_and(|found| want.is_own(&found.series.title)));
    let plain = || {
        let is_key = |found: &Option<Named>| {
            found.as_ref().is_some_and(|found| found.series.title.eq_ignore_ascii_case(Field::PartId.key()))
        };
        named.iter().position(is_key).or_else(|| named.iter().position(is_id))
    };
    let Some(kept) = own.or_else(plain) else { return };
    for (index, found) in named.iter_mut().enumerate() {
        if index != kept && is_id(found) {
            *found = None;
        }
    }
}

fn by_header(records: &[Record], header: &Header, separator: Separator, want: &Want) -> Result<Shape, NoShape> {
    let Headings { named, commas } = headings(&header.cells, want)?;
    let width = header.cells.len();
    let mut shape = Shape::new(Orientation::Rows);
    (shape.header_line, shape.commas) = (Some(records[header.record].line), commas);
    shape.header.clone_from(&header.cells);
    shape.asides = records[..header.record].iter().filter(|record| !record.says_nothing()).map(aside).collect();
    let below = header.record + header.rows;
    let units = records[below..].iter().position(|record| !record.says_nothing()).map(|offset| below + offset);
    let units = units.filter(|index| is_unit_row(&records[*index]));
    let first = units.map_or(below, |units| units + 1);
    let end = first + end_of_rows(&records[first..], width, separator);
    let rows: Vec<&Record> = records[first..end].iter().filter(|record| !record.says_nothing()).collect();
    if rows.is_empty() {
        let ragged = records[first..].iter().find(|record| record.numbers() > 0);
        return Err(ragged.map_or_else(
            || NoShape::NoRows { names: records[header.record].in_words() },
            |record| NoShape::Ragged { record: record.clone(), expected: width },
        ));
    }
    shape.data = first..end;
    let column = |place: usize| rows.iter().map(|row| row.cells.get(place).cloned().unwrap_or_default()).collect();
    for (place, (cell, named)) in header.cells.iter().zip(named).enumerate() {
        if let Some(mut named) = named {
            let unit = units.and_then(|units| unit_below(&records[header.record], &records[units], place));
            let below = || unit.map(|unit| bare_unit(&unit.text()).to_owned());
            named.series.unit = named.series.unit.take().or_else(below);
            named.series.cells = column(place);
            shape.take(named)?;
        } else if is_evaluation_length(&cell.text()) && !want.ignores(&cell.text()) {
            let (_, unit) = super::names::split_unit(&cell.text());
            shape.lengths = Some(Series { title: cell.text().into_owned(), place, unit, cells: column(place) });
        } else if !shape.take_beside(&cell.text(), place, &column) || want.ignores(&cell.text()) {
            let unit = units.and_then(|units| unit_below(&records[header.record], &records[units], place));
            let unit = unit.map(|unit| bare_unit(&unit.text()).to_owned());
            shape.unknown.push(Unknown { unit, ..Unknown::column(&cell.text(), place, column(place)) });
        }
    }
    shape.take_units_beside();
    shape.lines = rows.iter().map(|row| row.line).collect();
    shape.asides.extend(records[end..].iter().filter(|record| !record.says_nothing()).map(aside));
    shape.drop_valueless();
    Ok(shape)
}

/// The cell of a row of units that stands below a heading: the one in its place, or, of fewer cells between blanks, the
/// one that begins nearest to it.
fn unit_below<'r>(header: &Record, units: &'r Record, place: usize) -> Option<&'r Cell> {
    let found = if units.cells.len() == header.cells.len() {
        units.cells.get(place)
    } else {
        let at = |record: &Record, cell: &Cell| cell.span.start.saturating_sub(record.start);
        let nearest = |cell: &Cell| {
            header.cells.iter().enumerate().min_by_key(|(_, heading)| at(header, heading).abs_diff(at(units, cell)))
        };
        units.cells.iter().find(|cell| nearest(cell).is_some_and(|(nearest, _)| nearest == place))
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

/// How many records are rows: the table ends with the last line that has as many cells as it has columns and a number in
/// one of them, and with those right below it that look like a part whose values cannot be read.
fn end_of_rows(below: &[Record], width: usize, separator: Separator) -> usize {
    let words = matches!(separator, Separator::Blanks | Separator::Lines);
    let fits = |record: &Record| {
        let count = record.cells.len();
        let is_missing = |cell: &Cell| !cell.is_empty() && cell.is_missing();
        let says_missing = || count == width && !record.says_nothing() && record.cells.iter().any(is_missing);
        (count > 1 || width == 1) && (count == width || !words) && (record.numbers() > 0 || says_missing())
    };
    let end = below.iter().rposition(fits).map_or(0, |index| index + 1);
    let Some(last) = end.checked_sub(1) else { return end };
    let is_part = |record: &&Record| {
        let first = record.cells.first().map(Cell::text).unwrap_or_default();
        let is_name = has_digit(&first) && !first.contains(':');
        record.cells.len() == width
            && !record.says_nothing()
            && !is_unit_row(record)
            && (record.filled().len() > 1 || is_name)
    };
    let follows = |(above, record): (&Record, &Record)| record.line == above.line + 1;
    let right_below = below[end..]
        .iter()
        .enumerate()
        .take_while(|(index, record)| follows((&below[last + index], record)) && is_part(record));
    end + right_below.count()
}

/// Whether a text holds a digit: `Teil 1`, or a value that cannot be read.
pub(crate) fn has_digit(text: &str) -> bool {
    text.contains(|c: char| c.is_ascii_digit())
}

pub(crate) fn aside(record: &Record) -> Aside {
    Aside { line: record.line, text: record.in_words() }
}

/// A line with a name and numbers that is not known.
pub(crate) fn unknown_line(record: &Record, is_measurement: bool) -> Unknown {
    let title = record.cells.first().map(|cell| cell.text().into_owned()).unwrap_or_default();
    Unknown::line(&title, record.line, record.cells.iter().skip(1).cloned().collect()).measured(is_measurement)
}

/// One line per name, with a value per part behind it.
fn by_label(records: &[Record], labels: &[usize], want: &Want) -> Result<Shape, NoShape> {
    let names: Vec<_> = labels.iter().map(|index| records[*index].cells[0].clone()).collect();
    let Headings { named, commas } = headings(&names, want)?;
    let mut shape = Shape::new(Orientation::Columns);
    shape.commas = commas;
    let (mut count, mut lines) = (0, Vec::new());
    let has_units = labels.iter().zip(&named).any(|(index, named)| {
        let is_angle = named.as_ref().is_some_and(|named| named.field.is_angle());
        records[*index].cells.get(1).is_some_and(|cell| is_unit_of(&cell.text(), is_angle))
    });
    for (named, index) in named.into_iter().zip(labels) {
        let Some(mut named) = named else { continue };
        named.series.fill(behind_label(&records[*index], has_units), named.field.is_angle());
        count = count.max(named.series.cells.len());
        if named.aspect == Aspect::Value {
            lines.push((named.series.cells.len(), *index));
        }
        shape.take(named)?;
    }
    if let Some((_, index)) = lines.iter().find(|(cells, _)| *cells != count) {
        return Err(NoShape::Ragged { record: records[*index].clone(), expected: count + 1 });
    }
    for (index, record) in records.iter().enumerate().filter(|(index, _)| !labels.contains(index)) {
        if record.says_nothing() {
            continue;
        }
        let title = record.cells[0].text();
        if let Some((field, title)) = value_is_missing(record, want)
            && shape.measurements.iter().all(|measurement| measurement.field != field)
        {
            let series = Series { title, cells: vec![Cell::default(); count], ..Series::default() };
            shape.take(Named { field, aspect: Aspect::Value, holds: None, series })?;
            continue;
        }
        let cells = behind_label(record, has_units);
        let names_parts = heading(&title, &want.own)
            .filter(|heading| cells.len() == count && heading.fields.first().is_some_and(|field| field.is_index()));
        match names_parts {
            Some(heading) if index < labels[0] => {
                let cells = cells.to_vec();
                let series = Series { title: title.into_owned(), cells, ..Series::default() };
                shape.take(Named { field: heading.fields[0], aspect: Aspect::Value, holds: None, series })?;
            }
            _ if record.numbers() > 0 && !record.cells[0].is_measure() && !is_part_name(&title) => {
                let stands_among = labels.first().is_some_and(|first| *first < index)
                    && labels.last().is_some_and(|last| index < *last);
                shape.unknown.push(unknown_line(record, stands_among));
            }
            // a value whose name is not there
            _ if record.cells.iter().all(|cell| unit_in(&cell.text()).is_some_and(|unit| is_unit(&unit))) => {
                shape.unknown.push(Unknown::line("", record.line, record.cells.clone()).measured(true));
            }
            _ => shape.asides.push(aside(record)),
        }
    }
    shape.lines = vec![records[labels[0]].line; count];
    shape.drop_valueless();
    Ok(shape)
}

fn is_part_name(title: &str) -> bool {
    heading(title, &[]).is_some_and(|heading| heading.fields == [Field::PartId])
}

/// The field that a line names without a value of it, and the name: `Rack pitch: n/a`.
fn value_is_missing(record: &Record, want: &Want) -> Option<(Field, String)> {
    let is_none = |cell: &Cell| !cell.is_number() && (cell.is_missing() || has_digit(&cell.text()));
    let line = record.in_words();
    // between blanks, the value is the last word of a line that has no number
    let by_words = || {
        let (title, word) = line.trim().rsplit_once([' ', ':', '='])?;
        let is_label = names_value(&Cell::of_text(title, 0..0), want);
        is_label.then(|| (title.to_owned(), vec![Cell::of_text(word, 0..0)]))
    };
    let by_cells =
        || (record.cells[0].text().trim().to_owned(), record.filled().into_iter().skip(1).cloned().collect());
    let (title, values) = if record.numbers() == 0 { by_words().unwrap_or_else(by_cells) } else { by_cells() };
    let title = title.as_str();
    let name = Cell::of_text(title, record.cells[0].span.clone());
    let is_so = !values.is_empty() && values.iter().all(is_none) && !want.ignores(title) && names_value(&name, want);
    let fields = if is_so { heading(title, &want.own)?.fields } else { return None };
    Some((one_meaning(&fields, want, &name).ok()?, title.to_owned()))
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

impl Series {
    /// The values behind a name: a unit behind a value belongs to it, one before the first to all.
    fn fill(&mut self, cells: &[Cell], is_angle: bool) {
        for cell in cells {
            let text = cell.text();
            let is_unit = |text: &str| is_unit_of(text, is_angle);
            match self.cells.last_mut() {
                // 12,5 | µm
                Some(last) if is_unit(&text) => {
                    let united = format!("{} {}", last.text(), bare_unit(&text));
                    *last = Cell::of_text(&united, last.span.start..cell.span.end);
                }
                None if is_unit(&text) && self.unit.is_none() => self.unit = Some(bare_unit(&text).to_owned()),
                // what stands behind a number and is none belongs to it: nobody else says what it is
                Some(last) if !cell.is_number() && !cell.is_missing() && last.is_number() => {
                    let whole = format!("{} {text}", last.text());
                    *last = Cell::of_text(&whole, last.span.start..cell.span.end);
                }
                // 0° 1' 15"
                Some(last) if goes_on_with_angle(&last.text(), &text) => {
                    let whole = format!("{} {text}", last.text());
                    *last = Cell::of_text(&whole, last.span.start..cell.span.end);
                }
                _ => self.cells.push(cell.clone()),
            }
        }
    }
}

/// Numbers without names: what they are is asked for, or is the spec's order.
fn without_names(records: &[Record], want: &Want) -> Result<Shape, NoShape> {
    let fields: Vec<Field> = if want.fields.is_empty() {
        want.expected.iter().map(|kind| Field::Error(*kind)).collect()
    } else {
        want.fields.clone()
    };
    // lines of numbers, perhaps with a name in front
    let numeric = |record: &Record| {
        let is_text = |cell: &&Cell| !cell.is_number() && !cell.is_missing();
        let texts = record.cells.iter().filter(is_text).count();
        record.numbers() > 0 && (texts == 0 || (texts == 1 && !record.cells[0].is_number()))
    };
    let rows: Vec<&Record> = records.iter().filter(|record| numeric(record)).collect();
    let Some(first) = rows.first() else { return Err(NoShape::NoNumbers) };
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
    let bare = |field: Field, cells: Vec<Cell>| Named {
        field,
        aspect: Aspect::Value,
        holds: None,
        series: Series { title: field.key().to_owned(), cells, ..Series::default() },
    };
    let in_rows = as_rows && want.orientation != Some(Orientation::Columns);
    let in_columns = as_columns && want.orientation != Some(Orientation::Rows);
    if !in_rows && !in_columns {
        let span = first.span().start..rows.last().map_or(0, |record| record.span().end);
        return Err(NoShape::Count { columns: width, rows: rows.len(), span });
    }
    let mut shape = Shape::new(if in_rows { Orientation::Rows } else { Orientation::Columns });
    for (index, field) in fields.iter().enumerate() {
        let cells = if in_rows {
            rows.iter().map(|row| row.cells[index + offset].clone()).collect()
        } else {
            rows[index].filled().to_vec()
        };
        shape.take(bare(*field, cells))?;
    }
    if in_rows && offset == 1 {
        shape.take(bare(Field::PartId, rows.iter().map(|row| row.cells[0].clone()).collect()))?;
    }
    shape.lines = if in_rows { rows.iter().map(|row| row.line).collect() } else { vec![first.line; width] };
    for record in records.iter().filter(|record| !numeric(record) && !record.says_nothing()) {
        if record.numbers() > 0 {
            shape.unknown.push(unknown_line(record, true));
        } else {
            shape.asides.push(aside(record));
        }
    }
    Ok(shape)
}
