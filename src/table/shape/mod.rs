//! From records to measurements: where the names stand, which cells belong to them, what is no part of the table. Called
//! once for each separator that a text may have, and once for a sheet; reads no number beyond telling that it is one.
//!
//! | shape | where the names are |
//! |---|---|
//! | rows | a header; each row below it is a part, a space or a tooth |
//! | labels | the first cell of each line, with a value per part behind it |
//! | characteristics | one column; others hold the actual and nominal values, tolerances and units |
//! | sentences | before each number: `Part 1: over roller is 25.012 mm, rack pitch 3 µm` |
//! | bare | nowhere: the order of the spec, or of `--as` |

mod bare;
mod blocks;
mod characteristics;
mod dimensions;
mod headings;
mod items;
mod labels;
mod merged;
mod pages;
mod refusal;
mod rows;
mod sentences;
mod stated;
mod words;

pub(crate) use headings::{PartNames, is_numbered, is_part_name, is_spread};
pub(crate) use labels::uncounted;
pub(crate) use pages::{PartLine, part_line};
pub(crate) use refusal::{NoShape, located, many};
pub(crate) use stated::{stated_units, unknown_unit};

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap, HashSet};

use super::cell::{Cell, Record};
use super::companions::Companions;
use super::grid::{Separator, bare_unit, is_unit};
use super::names::{Field, Role, ValueKind, WordList, is_statistic, part_in_title, role, split_unit};
use super::reading::AsideReading;
use super::unknown::{Unknown, is_foreign_unit};
use super::want::{Orientation, Want};
use crate::deviation::Part;
use crate::quantity::Unit;
use bare::{name_with_size, without_names};
use blocks::with_parts_side_by_side;
use characteristics::{by_characteristic, find_characteristics};
use dimensions::with_dimension_names;
use headings::{Named, known};
use items::without_item_numbers;
use labels::{by_label, columns_of_no_part, find_labels, is_counted};
use merged::{with_heading_in_one_row, with_names_above, with_part_in_each_row};
use pages::{with_part_of_page, with_part_of_section};
use rows::{by_header, find_header, header_of_strangers};
use sentences::by_sentence;

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
    pub(crate) holds: Option<ValueKind>,
    pub(crate) value: Series,
    pub(crate) beside: Companions<Series>,
    /// The unit that a line beside the table states.
    pub(crate) stated_unit: Option<Unit>,
    /// What a row that is called nominal has in the column.
    pub(crate) nominal_in_row: Option<Cell>,
}

/// A text as a table.
#[derive(Debug, Clone, Default)]
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
    pub(crate) measurements: Vec<Measurement>,
    pub(crate) unknown: Vec<Unknown>,
    pub(crate) asides: Vec<AsideReading>,
    /// The line of each part, space or tooth.
    pub(crate) lines: Vec<u64>,
    /// Numbers beside the values, which tell the decimal mark as well.
    pub(crate) beside: Vec<Cell>,
    /// What was taken from elsewhere than its own cell.
    pub(crate) notes: Vec<String>,
}

impl Shape {
    pub(crate) fn new(orientation: Orientation) -> Self {
        Self { orientation, ..Self::default() }
    }

    /// Takes a column with a known name.
    pub(crate) fn take(&mut self, named: Named) -> Result<(), NoShape> {
        let slot = match named.field {
            Field::PartId => &mut self.ids,
            Field::Space | Field::Tooth => {
                self.index_field.get_or_insert(named.field);
                &mut self.index
            }
            field => {
                let known = self.measurements.iter().position(|measurement| measurement.field == field);
                let at = known.unwrap_or_else(|| {
                    self.measurements.push(Measurement::of(field));
                    self.measurements.len() - 1
                });
                return self.measurements[at].take(named);
            }
        };
        if slot.is_some() {
            return Err(twice(&named.series, named.field));
        }
        *slot = Some(named.series);
        Ok(())
    }

    /// Takes a column that says of no field that it is nominal, a tolerance or a deviation: it belongs to the value before
    /// it. Whether it was taken.
    fn take_beside(&mut self, series: &Series) -> bool {
        // a largest value that changes from part to part is measured, and no tolerance
        let changes = || series.cells.windows(2).any(|pair| pair[0].text() != pair[1].text());
        let name = split_unit(&series.title).0;
        // of one part, nothing tells either
        let may_change = || changes() || series.cells.len() == 1 && WordList::Mean.has(&name);
        let is_measured = || is_statistic(&name) && may_change();
        let value = self.measurements.last_mut().filter(|found| !found.value.title.is_empty());
        match value.zip(role(&series.title)).and_then(|(value, role)| value.beside.slot(role)) {
            Some(slot @ None) if !is_measured() => *slot = Some(series.clone()),
            _ => return false,
        }
        true
    }

    /// The heading of nominal values below which names of limits stand: a list beside the table, `Soll` above `OGW` and `UGW`.
    fn list_beside(&self) -> Option<Cell> {
        let names_other = |cell: &Cell| {
            cell.text().starts_with(char::is_alphabetic) && role(&cell.text()).is_some_and(Role::is_beside_value)
        };
        let mut nominals = self.measurements.iter().filter_map(|measurement| measurement.beside.get(Role::Nominal));
        let list = nominals.find(|series| series.cells.iter().any(names_other))?;
        self.header.get(list.place).cloned()
    }

    /// Takes a row of nominal values among those of the parts, which is called so.
    fn take_nominal_row(&mut self, rows: &[&Record], name: usize) {
        let is_nominal = |row: &&&Record| {
            let title = row.cell(name).text();
            role(&title) == Some(Role::Nominal) && !WordList::Requirement.has(&title)
        };
        let Some(row) = rows.iter().find(is_nominal) else { return };
        for measurement in &mut self.measurements {
            let cell = row.cell(measurement.value.place);
            measurement.nominal_in_row = Some(cell).filter(|cell| cell.is_number()).cloned();
        }
    }

    /// Leaves out what has companions but no value: its nominal value says nothing of a part.
    pub(crate) fn drop_valueless(&mut self) {
        let has_none = |found: &mut Measurement| found.value.title.is_empty() && found.value.cells.is_empty();
        for measurement in self.measurements.extract_if(.., has_none) {
            let unknown = |series: &Series| Unknown::column(&series.title, series.place, series.cells.clone());
            self.unknown.extend(measurement.beside.iter().map(unknown));
        }
    }

    /// Leaves out limits that change from part to part without a nominal value that does: they are measured.
    pub(crate) fn drop_changing_limits(&mut self) {
        for Measurement { beside, .. } in &mut self.measurements {
            let changes = |series: &&Series| distinct(series.cells.iter().filter(|cell| !cell.is_missing())) > 1;
            let is_of_one_size = beside.get(Role::Nominal).is_none();
            for role in [Role::Upper, Role::Lower] {
                if let Some(series) = beside.get(role).filter(|series| is_of_one_size && changes(series)).cloned() {
                    self.unknown.push(Unknown::column(&series.title, series.place, series.cells).measured(true));
                    beside.set(role, None);
                }
            }
        }
    }

    /// Gives columns of units to the values before them, or to those behind them if one stands before the first value.
    fn take_units(&mut self, units: Vec<Series>) {
        let first = self.measurements.iter().map(|measurement| measurement.value.place).min();
        let stand_before = units.iter().any(|series| Some(series.place + 1) == first);
        for series in units {
            // units behind another column of numbers are those of that one
            let is_of_other = self.unknown.iter().any(|before| {
                before.column.is_some_and(|at| at + 1 == series.place) && before.cells.iter().any(Cell::is_number)
            });
            let is_of_value = |measurement: &&mut Measurement| {
                let place = measurement.value.place;
                if stand_before { place == series.place + 1 } else { place < series.place && !is_of_other }
            };
            let value = self.measurements.iter_mut().filter(is_of_value).max_by_key(|found| found.value.place);
            match value.and_then(|measurement| measurement.beside.slot(Role::Unit)) {
                Some(slot @ None) => *slot = Some(series),
                _ => self.unknown.push(Unknown::column(&series.title, series.place, series.cells)),
            }
        }
    }

    /// Gives the only column of units to every value that says no unit of its own.
    fn share_units(&mut self) {
        let units = || self.measurements.iter().filter_map(|measurement| measurement.beside.get(Role::Unit));
        let (Some(shared), None) = (units().next().cloned(), units().nth(1)) else { return };
        let is_open = |found: &&mut Measurement| found.value.unit.is_none() && found.beside.get(Role::Unit).is_none();
        for measurement in self.measurements.iter_mut().filter(is_open) {
            measurement.beside.set(Role::Unit, Some(shared.clone()));
        }
    }

    /// Takes a first column without a name, or one of words, as the names of the parts, if each is another.
    fn take_nameless(&mut self, want: &Want) {
        let is_name = |unknown: &Unknown| {
            let says_nothing = unknown.cells.iter().any(Cell::is_missing);
            let is_words = || !want.ignores(&unknown.title) && !unknown.cells.iter().any(Cell::is_number);
            let may_name = unknown.title.is_empty() || is_words() && !unknown.could_be_measured();
            unknown.column == Some(0)
                && may_name
                && !says_nothing
                && distinct(unknown.cells.iter()) == unknown.cells.len()
        };
        if self.ids.is_none()
            && self.index.is_none()
            && let Some(at) = self.unknown.iter().position(is_name)
        {
            let Unknown { title, cells, .. } = self.unknown.remove(at);
            self.ids = Some(Series { title, cells, ..Series::default() });
        }
    }

    /// Takes a column that holds nothing but units as those of the unknown column of numbers before it.
    fn take_units_beside(&mut self) {
        let units = |unknown: &Unknown| Some((unknown.column?, bare_unit(&unknown.units()?.text()).to_owned()));
        for (place, unit) in self.unknown.iter().filter_map(units).collect::<Vec<_>>() {
            let is_before = |unknown: &&mut Unknown| {
                unknown.column.is_some_and(|at| at + 1 == place) && unknown.cells.iter().any(Cell::is_number)
            };
            if let Some(before) = self.unknown.iter_mut().find(is_before) {
                before.unit.get_or_insert(unit);
                self.unknown.retain(|unknown| unknown.column != Some(place));
            }
        }
    }

    /// Whether beside columns of parts there is one of means or extremes of them.
    pub(crate) fn has_column_of_means(&self) -> bool {
        let beside = self.measurements.iter().flat_map(|measurement| measurement.beside.iter());
        let mut titles = beside.map(|series| &series.title).chain(self.unknown.iter().map(|unknown| &unknown.title));
        self.orientation == Orientation::Columns && titles.any(|title| WordList::Mean.has(title))
    }

    /// Whether a line repeats the names of the parts, as a heading does above more values of theirs.
    pub(crate) fn names_parts_again(&self, aside: &AsideReading) -> bool {
        let mut names = self.ids.iter().flat_map(|ids| &ids.cells).map(Cell::text).peekable();
        let is_below = Some(aside.line) > self.header_line && names.peek().is_some();
        let text = format!(" {} ", aside.text);
        is_below && names.all(|name| text.contains(&format!(" {name} ")))
    }

    /// What the names of its parts look like.
    pub(crate) fn part_names(&self) -> PartNames {
        let is_row = |row: usize| {
            self.measurements.iter().any(|measurement| measurement.value.cells.get(row).is_some_and(Cell::is_number))
        };
        let names = self.ids.iter().flat_map(|ids| ids.cells.iter().enumerate());
        PartNames::of(names.filter(|(row, _)| is_row(*row)).map(|(_, name)| name))
    }

    /// The columns that hold no numbers as far as the table was looked at, and would be measurements if they did.
    pub(crate) fn watched(&self, want: &Want) -> Vec<usize> {
        let would_be = |unknown: &&Unknown| {
            let with_number = Unknown { cells: vec![Cell::of_text("0", 0..0)], ..(*unknown).clone() };
            let has_numbers = unknown.cells.iter().any(Cell::is_number);
            !has_numbers && !unknown.is_ignored(want) && with_number.could_be_measured()
        };
        self.unknown.iter().filter(would_be).filter_map(|unknown| unknown.column).collect()
    }

    /// What the names of parts and columns that are not used say of which part rows are, each as a line. Where rows speak of both
    /// parts, they are pairs, and the columns say nothing.
    pub(crate) fn said_beside_values(&self, want: &Want) -> Vec<AsideReading> {
        let columns = self.unknown.iter().filter(|unknown| unknown.says_part() && !want.ignores(&unknown.title));
        let columns = columns.map(|unknown| &unknown.cells).chain(self.ids.iter().map(|ids| &ids.cells));
        let mut rows: HashMap<usize, Vec<Part>> = HashMap::new();
        let mut said: Vec<AsideReading> = Vec::new();
        for (row, cell) in columns.flat_map(|cells| cells.iter().enumerate()) {
            let text = cell.text();
            // a quick look: most names of parts are numbers with a letter
            let has_word = text.chars().filter(|c| c.is_alphabetic()).nth(1).is_some();
            let part = Some(&text).filter(|text| has_word && !want.ignores(text)).and_then(|text| part_in_title(text));
            let Some(part) = part else { continue };
            rows.entry(row).or_default().push(part);
            if said.iter().all(|other| other.text != text) {
                let line = self.lines.get(row).or(self.header_line.as_ref()).copied().unwrap_or(1);
                said.push(AsideReading { line, text: text.into_owned() });
            }
        }
        let is_of_pair = |parts: &Vec<Part>| parts.iter().any(|part| *part != parts[0]);
        if rows.values().any(is_of_pair) { Vec::new() } else { said }
    }

    /// The columns that are no measurements, and may have remarks.
    pub(crate) fn remarks(&self, want: &Want) -> Vec<Remarks> {
        let watched = self.watched(want);
        let remarks = |unknown: &Unknown| {
            let place = unknown.column.filter(|place| !watched.contains(place) && !want.ignores(&unknown.title))?;
            let said = || unknown.cells.iter().filter(|cell| !cell.is_missing()).map(Cell::text);
            let has_digits = said().any(|text| has_digit(&text));
            // dates and numbers are no remarks
            let has_words = !has_digits || said().any(|text| !has_digit(&text));
            let known = unknown.cells.iter().map(|cell| cell.text().as_bytes().to_vec()).collect();
            let (are_verdicts, says_part) = (unknown.are_verdicts(), unknown.says_part());
            has_words.then_some(Remarks { place, known, has_digits, are_verdicts, says_part })
        };
        self.unknown.iter().filter_map(remarks).collect()
    }
}

/// A column of remarks.
#[derive(Debug, Clone)]
pub(crate) struct Remarks {
    pub(crate) place: usize,
    /// What was looked at.
    known: HashSet<Vec<u8>>,
    /// Whether digits are among that, so that others say nothing new.
    pub(crate) has_digits: bool,
    pub(crate) are_verdicts: bool,
    /// Whether they say which part a row is.
    pub(crate) says_part: bool,
}

impl Remarks {
    /// Whether nothing like it was looked at.
    pub(crate) fn is_new(&self, remark: &[u8]) -> bool {
        let is_like_others = || self.has_digits && remark.iter().any(u8::is_ascii_digit);
        !remark.is_empty() && !is_like_others() && !self.known.contains(remark)
    }
}

fn twice(series: &Series, field: Field) -> NoShape {
    NoShape::twice(&Cell::of_text(&series.title, 0..0), field)
}

impl Measurement {
    fn of(field: Field) -> Self {
        Self {
            field,
            holds: None,
            value: Series::default(),
            beside: Companions::default(),
            stated_unit: None,
            nominal_in_row: None,
        }
    }

    /// Takes one of the columns that belong to the field.
    fn take(&mut self, Named { aspect, holds, series, .. }: Named) -> Result<(), NoShape> {
        let has_value = !self.value.title.is_empty();
        let slot = match aspect {
            Role::Measured if !has_value => {
                (self.holds, self.value) = (holds, series);
                return Ok(());
            }
            // a measured value counts, and the deviation beside it is held against it
            Role::Measured if holds == Some(ValueKind::Deviation) && self.holds != holds => {
                self.holds = Some(ValueKind::Measured);
                self.beside.slot(Role::Deviation)
            }
            Role::Measured if self.holds == Some(ValueKind::Deviation) && holds != self.holds => {
                self.beside.set(Role::Deviation, Some(std::mem::replace(&mut self.value, series)));
                self.holds = holds.or(Some(ValueKind::Measured));
                return Ok(());
            }
            role => self.beside.slot(role),
        };
        let Some(slot) = slot.filter(|slot| slot.is_none()) else { return Err(twice(&series, self.field)) };
        *slot = Some(series);
        Ok(())
    }
}

/// How many different texts cells have.
pub(crate) fn distinct<'c>(cells: impl Iterator<Item = &'c Cell>) -> usize {
    cells.map(Cell::text).collect::<HashSet<_>>().len()
}

/// Records that may be the head of a report.
const HEAD: usize = 100;

/// Reads records as a table.
pub(crate) fn shape(records: &[Record], separator: Separator, want: &Want) -> Result<Shape, NoShape> {
    // headings are no title
    let is_title = |record: &&Record| record.numbers() == 0 && known(&record.cells, want) < 2;
    let head = records.iter().take(HEAD).filter(is_title);
    let names = names_of_one(records, want);
    let want = &want.of_part(head.map(Record::in_words).chain(names));
    let records = without_item_numbers(records);
    let records = with_heading_in_one_row(&records);
    let records = with_parts_side_by_side(&records, want);
    let records = with_names_above(&records);
    let records = with_part_in_each_row(&records, want);
    let records = with_part_of_page(&records);
    let records = with_part_of_section(&records);
    let mut shape = shape_of(&with_dimension_names(&records, want), separator, want)?;
    shape.take_stated_units(want);
    Ok(shape)
}

/// What a column of parts' names or kinds says, if every cell of it says of which part its row is: `Rack 1`, or `Zahnstange`.
fn names_of_one(records: &[Record], want: &Want) -> Vec<String> {
    let mut rows =
        records.iter().take(HEAD).skip_while(|record| record.numbers() > 0 || known(&record.cells, want) < 2);
    let Some(header) = rows.next() else { return Vec::new() };
    let rows: Vec<&Record> =
        rows.filter(|record| record.numbers() > 0 && record.cells.len() == header.cells.len()).collect();
    let says_part = |place: &usize| Unknown::column(&header.cells[*place].text(), *place, Vec::new()).says_part();
    let names = |place: usize| rows.iter().map(|row| row.cell(place).text().into_owned()).collect::<Vec<_>>();
    let is_said = |names: &Vec<String>| names.iter().all(|name| part_in_title(name).is_some());
    (0..header.cells.len()).filter(says_part).map(names).find(is_said).unwrap_or_default()
}

fn shape_of(records: &[Record], separator: Separator, want: &Want) -> Result<Shape, NoShape> {
    if separator == Separator::Sentences {
        return by_sentence(records, want);
    }
    let header = find_header(records, separator, want);
    if records.iter().all(|record| record.numbers() == 0) {
        return Err(match records.iter().find(|record| known(&record.cells, want) > 0) {
            Some(names) => NoShape::NoRows { names: names.in_words() },
            None => NoShape::NoNumbers,
        });
    }
    if let Some(header) = header.as_ref().filter(|_| !want.fields.is_empty()) {
        return Err(NoShape::HasNames { record: records[header.record].clone() });
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
        return by_characteristic(found, separator, want);
    }
    // the name of a part stands in front of each of its teeth, a label in front of one line
    let texts: BTreeSet<_> = labels.iter().map(|index| inner[*index].cells[0].text()).collect();
    if texts.len() > named || (labels.len() == 1 && named <= 1 && header.is_none()) {
        if let Some(columns) = columns_of_no_part(&inner, &labels) {
            return Err(columns);
        }
        return by_label(&inner, &labels, separator, want);
    }
    if let Some(header) = header {
        return by_header(records, &header, separator, want);
    }
    match (header_of_strangers(records), name_with_size(records, want)) {
        (Some(header), _) => by_header(records, &header, separator, want),
        (None, Some(cell)) => Err(NoShape::InOneCell { cell: cell.clone() }),
        (None, None) => without_names(&inner, want),
    }
}

/// The records of a table between bars, as Markdown draws it, or of a sheet, without the empty cells at its left side.
fn without_margin(records: &[Record], separator: Separator) -> Cow<'_, [Record]> {
    let blanks = |record: &Record| record.cells.iter().take_while(|cell| cell.is_empty()).count();
    let of_table = |record: &&Record| record.filled().len() > 1;
    let margin = records.iter().filter(of_table).map(blanks).min().unwrap_or(0);
    if margin == 0 || !matches!(separator, Separator::Character(b'|') | Separator::TAB) {
        return records.into();
    }
    let inner = |record: &Record| {
        let cells = record.cells.get(margin..).filter(|cells| !cells.is_empty()).unwrap_or(&record.cells);
        record.with_cells(cells.iter().cloned())
    };
    records.iter().map(inner).collect()
}

/// Whether a text holds a digit: `Teil 1`, or a value that cannot be read.
pub(crate) fn has_digit(text: &str) -> bool {
    text.contains(|c: char| c.is_ascii_digit())
}

pub(crate) fn aside(record: &Record) -> AsideReading {
    AsideReading { line: record.line, text: record.in_words() }
}

/// A line with a name and numbers that is not known.
pub(crate) fn unknown_line(record: &Record, is_measurement: bool) -> Unknown {
    // a unit stands before the values, or behind the first one
    let before = Some(bare_unit(&record.cell(1).text()).to_owned()).filter(|unit| is_unit(unit));
    let behind = || {
        let pair = record.cells.windows(2).find(|pair| pair[0].is_number())?;
        Some(pair[1].text().trim().to_owned()).filter(|unit| is_unit(unit) || is_foreign_unit(unit))
    };
    let unit = before.or_else(behind);
    // a value may stand where others have their names
    let is_value = record.cell(0).is_measure();
    let cells = record.cells.iter().skip(usize::from(!is_value)).cloned().collect();
    Unknown { unit, ..Unknown::line(&record.cell(0).text(), record.line, cells).measured(is_measurement) }
}
