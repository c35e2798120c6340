//! Tables with a row per characteristic, as CMM programs export them: a column of names, and columns of actual and nominal
//! values, tolerances, deviations and units; one part, a part in each of several columns, or a column that names the part.
//! Called by [`shape`](super::shape).

mod reading;
mod roles;

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap, HashSet};

use super::headings::{PartNames, headings, is_extreme, is_part_name, is_statistic_among, says_no_part};
use super::rows::is_shifted;
use super::{NoShape, Series, Shape, aside, distinct, has_digit};
use crate::table::cell::{Cell, Record};
use crate::table::grid::{Separator, is_unit, unit_in};
use crate::table::names::{Role, WordList, heading, is_again, is_context, names_value, role, split_unit};
use crate::table::unknown::Unknown;
use crate::table::want::{Orientation, Want};
use reading::Reading;
pub(super) use roles::{is_axis, is_direction};
use roles::{is_called_like_another, names_one_part, numbers_parts, places, roles_of, take_names, take_verdicts};

/// A table of characteristics, found but not read.
pub(super) struct Characteristics<'r> {
    header: &'r Record,
    /// What each column is.
    roles: Vec<Option<Role>>,
    /// The column of names.
    name: usize,
    /// The columns of values, where each is a part.
    parts: Vec<usize>,
    /// The records that are characteristics, known or not.
    rows: Vec<Cow<'r, Record>>,
    /// The records beside them.
    others: Vec<&'r Record>,
    /// How many of the rows have a known name.
    pub(super) known: usize,
}

/// A header that speaks of nominal and actual values, or of values of parts, and the records below it that start with a
/// name.
pub(super) fn find_characteristics<'r>(records: &'r [Record], want: &Want) -> Option<Characteristics<'r>> {
    let may_be_header = |record: &Record| record.numbers() == 0 || numbers_parts(record);
    let is_header = |at: &usize| want.teeth != Some(true) && may_be_header(&records[*at]);
    (0..records.len()).filter(is_header).find_map(|header| characteristics_below(records, header, want))
}

/// The characteristics below a record, if it is a header.
fn characteristics_below<'r>(records: &'r [Record], header: usize, want: &Want) -> Option<Characteristics<'r>> {
    let (above, below) = (&records[..header], &records[header + 1..]);
    let header = &records[header];
    let mut roles = roles_of(header, want);
    take_names(&mut roles, header, below, want);
    take_verdicts(&mut roles, header, below);
    let has = |wanted: &[Role]| roles.iter().flatten().any(|role| wanted.contains(role));
    let has_values = has(&[Role::Measured, Role::Deviation]);
    // names of parts beside a word for names, as in `Merkmal | Einheit | Teil 1 | Teil 2`
    let names_parts = roles.contains(&Some(Role::Name)) && roles.contains(&None);
    let has_roles = roles.iter().flatten().count() > 1;
    if !names_parts && !(has_roles && (has_values || has(&[Role::Nominal, Role::Upper, Role::Lower]))) {
        return None;
    }
    let has_name = |row: &Record, place: usize| names_value(&row.cell(place).text(), &want.own);
    let named = |place: &usize| below.iter().filter(|row| has_name(row, *place)).count();
    // a number or a short text may stand before what was measured, and be called a name too
    let name = places(&roles, Role::Name).into_iter().rev().max_by_key(named);
    let name = name.or_else(|| roles.iter().position(Option::is_none)).unwrap_or(0);
    // a value with a unit is no name: `P2 again: 25,30 mm`, cut at its comma
    let may_be_name = |cell: &Cell| !(cell.is_number() && unit_in(&cell.text()).is_some_and(|unit| is_unit(&unit)));
    let is_row = |record: &&Record| {
        record.cells.len() > name.max(1) && record.numbers() > 0 && may_be_name(&record.cells[name])
            || has_name(record, name)
    };
    let (rows, beside): (Vec<&Record>, Vec<&Record>) = below.iter().partition(is_row);
    let known = rows.iter().filter(|row| heading(&row.cells[name].text(), &want.own).is_some()).count();
    let rows = rows.into_iter().map(Cow::Borrowed).collect();
    let others = above.iter().chain(beside).collect();
    let mut found = Characteristics { header, roles, name, parts: Vec::new(), rows, others, known };
    if !has_values {
        found.parts = found.part_columns(want);
    }
    let is_read = has_values || !found.parts.is_empty();
    found.drop_common_names();
    found.settle_parts();
    found.drop_extremes();
    // so many roles leave no doubt, though none of the names is known
    let is_sure = found.place(Role::Name).is_some() && found.roles.iter().flatten().count() > 2;
    ((known > 0 || is_sure && !found.rows.is_empty()) && is_read).then_some(found)
}

/// The number in a cell, whichever its decimal mark is.
fn number(cell: &Cell) -> Option<f64> {
    cell.text().replace(',', ".").parse().ok()
}

/// Reads the characteristics.
pub(super) fn by_characteristic(
    mut found: Characteristics<'_>,
    separator: Separator,
    want: &Want,
) -> Result<Shape, NoShape> {
    let mut shape = Shape::new(Orientation::Columns);
    shape.notes = found.fill_names();
    let header = found.header;
    let is_ragged = |row: &&Cow<'_, Record>| {
        is_cut(row, header, separator, want)
            || row.filled().len() > header.cells.len()
            || is_shifted(header.start, &header.cells, row, separator)
    };
    if let Some(row) = found.rows.iter().find(is_ragged) {
        return Err(NoShape::Ragged { record: Record::clone(row), expected: header.cells.len() });
    }
    found.has_each_role_once(want)?;
    let mut parts = found.parts.iter().map(|place| &header.cells[*place]);
    if let Some(heading) = parts.find(|cell| says_no_part(&cell.text()) || is_again(&cell.text())) {
        return Err(NoShape::NoPart { heading: heading.clone() });
    }
    let mut names: Vec<Cell> = Vec::new();
    let mut rows_of: HashMap<String, Vec<&Record>> = HashMap::new();
    for row in &found.rows {
        let name = &row.cells[found.name];
        let rows = rows_of.entry(name.text().into_owned()).or_default();
        if rows.is_empty() {
            names.push(name.clone());
        }
        rows.push(row);
    }
    let is_axis = is_axis(&header.cells[found.name].text());
    let named = headings(&names, want)?.into_iter().zip(&names);
    let named: Vec<_> = named.map(|(named, name)| named.filter(|_| !(is_axis && is_direction(name)))).collect();
    shape.header_line = Some(header.line);
    let reading = Reading::new(&found, want);
    for (name, named) in names.iter().zip(named) {
        let rows = &rows_of[name.text().as_ref()];
        let Some(named) = named else {
            shape.unknown.push(reading.unknown(name, rows));
            continue;
        };
        let measurement = reading.measurement(&named, rows, name)?;
        if shape.measurements.iter().any(|known| known.field == measurement.field) {
            return Err(NoShape::twice(name, named.field));
        }
        shape.measurements.push(measurement);
    }
    if let Some(of_two) = found.of_two_batches(want) {
        return Err(of_two);
    }
    let part = found.place(Role::Part);
    if part.is_some() || !found.parts.is_empty() {
        let title = part.map_or_else(|| "part".to_owned(), |place| found.title(place));
        shape.ids = Some(Series { title, cells: reading.parts.clone(), ..Series::default() });
    }
    shape.unknown.extend(found.columns_without_role());
    // numbers of rows have points, whatever the decimal mark is: `1.1`
    let counts = |place: &usize| WordList::RowNumber.has(&found.title(*place));
    let counts: HashSet<usize> = (0..header.cells.len()).filter(counts).collect();
    let cells = found.rows.iter().flat_map(|row| row.cells.iter().enumerate());
    shape.beside = cells.filter(|(place, _)| !counts.contains(place)).map(|(_, cell)| cell.clone()).collect();
    shape.asides = found.others.iter().filter(|record| !record.says_nothing()).map(|record| aside(record)).collect();
    shape.lines = reading.lines;
    Ok(shape)
}

/// Whether the row of a known name has fewer cells than the header, so that values may be those of other columns; behind tabs,
/// cells at the end may be empty.
fn is_cut(record: &Record, header: &Record, separator: Separator, want: &Want) -> bool {
    let is_even = matches!(separator, Separator::Character(byte) if byte != b'\t');
    let is_known = || record.cells.iter().any(|cell| names_value(&cell.text(), &want.own));
    // a line of Markdown ends with a bar
    let expected = if separator == Separator::Character(b'|') { header.cells.len() } else { header.filled().len() };
    is_even && record.cells.len() < expected && is_known()
}

impl<'r> Characteristics<'r> {
    /// Those of all rows below the first one, which is the header.
    pub(super) fn below_header(table: &'r [Record], roles: Vec<Option<Role>>, others: &'r [Record]) -> Self {
        let name = roles.iter().position(|role| *role == Some(Role::Name)).unwrap_or(0);
        let rows = table[1..].iter().map(Cow::Borrowed).collect();
        let (parts, others) = (Vec::new(), others.iter().collect());
        Self { header: &table[0], roles, name, parts, rows, others, known: table.len() - 1 }
    }

    /// The first column of a role.
    fn place(&self, role: Role) -> Option<usize> {
        self.roles.iter().position(|other| *other == Some(role))
    }

    fn title(&self, place: usize) -> String {
        self.header.cells[place].text().into_owned()
    }

    /// The cells of a column.
    fn column(&self, place: usize) -> impl Iterator<Item = &Cell> {
        self.rows.iter().map(move |row| row.cell(place))
    }

    fn has_numbers(&self, place: usize) -> bool {
        self.column(place).any(Cell::is_number)
    }

    /// Whether a column holds the numbers of the rows, such as those of the balloons on a drawing.
    fn counts_rows(&self, place: usize) -> bool {
        let numbers = self.column(place).filter_map(|cell| cell.text().parse::<u64>().ok());
        self.column(place).all(Cell::is_whole) && numbers.is_sorted_by(|one, next| one < next)
    }

    /// The columns that are parts, where none is called by what it holds.
    fn part_columns(&self, want: &Want) -> Vec<usize> {
        let titles = &self.header.cells;
        let is_like_another = |place: usize| is_called_like_another(titles, place);
        let is_open = |place: &usize| {
            *place != self.name && self.roles[*place].is_none() && !want.ignores(&titles[*place].text())
        };
        let is_part = |place: &usize| {
            let (title, place) = (titles[*place].text(), *place);
            let is_numbered = has_digit(&title);
            let is_counter = !is_numbered && (is_part_name(&title) || place < self.name && self.counts_rows(place));
            is_open(&place)
                && !title.is_empty()
                && !is_counter
                && (is_numbered || !is_context(&title))
                && (!is_statistic_among(&title, titles) || is_like_another(place))
                && (names_one_part(&title) || is_like_another(place) || self.has_numbers(place))
        };
        let mut found: Vec<usize> = (0..titles.len()).filter(is_part).collect();
        if found.iter().any(|place| names_one_part(&titles[*place].text())) {
            found.retain(|place| has_digit(&titles[*place].text()));
        }
        // one of which nothing was measured is called like the others
        let names = PartNames::of(found.iter().map(|place| &titles[*place]));
        let is_like = |place: &usize| {
            let title = titles[*place].text();
            is_open(place) && names.may_have(&title) && !is_statistic_among(&title, titles)
        };
        (0..titles.len()).filter(|place| found.contains(place) || is_like(place)).collect()
    }

    /// A row of a part that has another batch, nest or the like than a row before: it may be of another part with that name.
    fn of_two_batches(&self, want: &Want) -> Option<NoShape> {
        let part = self.place(Role::Part);
        let is_batch = |place: &usize| {
            let title = self.title(*place);
            Some(*place) != part && WordList::Batch.has(&title) && !want.ignores(&title)
        };
        let place = (0..self.roles.len()).filter(|_| self.parts.is_empty()).find(is_batch)?;
        let mut first: HashMap<Cow<'_, str>, &Record> = HashMap::new();
        self.rows.iter().find_map(|row| {
            let name = part.map(|part| row.cell(part).text()).unwrap_or_default();
            let before = *first.entry(name).or_insert(row);
            let [one, other] = [before, row].map(|row| row.cell(place));
            let is_other = !one.is_missing() && !other.is_missing() && one.text() != other.text();
            is_other.then(|| NoShape::two_batches(&self.title(place), [one, other], row))
        })
    }

    /// Of several columns that may name the part, those that are the same in every row name it not, beside one that is not; nor do
    /// those that go one to one with it.
    fn drop_common_names(&mut self) {
        let is_common = |place: usize| distinct(self.column(place).filter(|cell| !cell.is_missing())) < 2;
        let mut names = places(&self.roles, Role::Part);
        // Teil X, Nr. 1
        let is_number = |place: &usize| {
            let is_called = self.roles[*place].is_none() && WordList::RowNumber.has(&self.title(*place));
            is_called && !is_common(*place) && !self.counts_rows(*place)
        };
        if names.iter().all(|place| is_common(*place)) && !names.is_empty() {
            names.extend((0..self.roles.len()).filter(is_number));
        }
        if names.len() < 2 {
            return;
        }
        let is_serial = |place: usize| WordList::Serial.has(&self.title(place));
        let tells = |place: &&usize| !is_common(**place) && (is_serial(**place) || !self.counts_rows(**place));
        let of_one_part = || {
            let serial = names.iter().find(|place| is_serial(**place)).or(names.first());
            serial.filter(|_| names.iter().all(|place| is_common(*place)))
        };
        let Some(kept) = names.iter().find(tells).or_else(of_one_part).copied() else { return };
        // as many pairs as there are of either
        let is_same = |place: usize| {
            let texts = |place: usize| self.column(place).map(Cell::text);
            let pairs: HashSet<_> = texts(kept).zip(texts(place)).collect();
            [kept, place].into_iter().all(|place| distinct(self.column(place)) == pairs.len())
        };
        let dropped = |place: &&usize| **place != kept && (is_common(**place) || is_same(**place));
        for place in names.iter().filter(dropped).copied().collect::<Vec<_>>() {
            self.roles[place] = None;
        }
        self.roles[kept] = Some(Role::Part);
    }

    /// Settles which columns are parts where a column seems to name the part as well: beside one column of values it does, and
    /// beside several it may number the rows.
    fn settle_parts(&mut self) {
        let Some(names) = self.place(Role::Part) else { return };
        if let [values] = self.parts[..] {
            self.roles[values] = Some(Role::Measured);
            self.parts.clear();
        } else if !self.parts.is_empty()
            && self.column(names).all(|cell| !cell.is_empty() && cell.is_whole())
            && distinct(self.column(names)) == self.rows.len()
        {
            self.roles[names] = None;
        }
    }

    /// An extreme is no limit where it may be made of the values: right behind the measured ones, or alone behind the parts.
    fn drop_extremes(&mut self) {
        let is_extreme = |place: &usize| is_extreme(&self.title(*place));
        let is_limit = |place: &usize| matches!(self.roles[*place], Some(Role::Upper | Role::Lower));
        let limits: Vec<usize> = (0..self.roles.len()).filter(is_limit).collect();
        let alone = match (&limits[..], self.parts.last()) {
            ([limit], Some(last)) if limit > last => Some(*limit).filter(is_extreme),
            _ => None,
        };
        let behind = self.place(Role::Measured).map_or(0..0, |measured| measured + 1..self.roles.len());
        for place in behind.take_while(is_extreme).chain(alone).collect::<Vec<_>>() {
            self.roles[place] = None;
        }
    }

    /// Puts the names of part and characteristic into every row, where one stands in the first row of a block only; what is to be
    /// said of the columns of which cells were filled.
    fn fill_names(&mut self) -> Vec<String> {
        let mut filled = BTreeSet::new();
        let Some(part) = self.place(Role::Part) else { return Vec::new() };
        for below in 1..self.rows.len() {
            let unfilled = self.rows[below].clone();
            for (place, other) in [(part, self.name), (self.name, part)] {
                let above = &self.rows[below - 1];
                if unfilled.cells.get(place).is_some_and(Cell::is_empty)
                    && !unfilled.cell(other).is_missing()
                    && (place == part || self.goes_on(above, &unfilled))
                {
                    let name = above.cell(place).clone();
                    self.rows[below].to_mut().cells[place] = name;
                    filled.insert(place);
                }
            }
        }
        let note = |place| format!("`{}`: a name counts for the empty cells below it", self.title(place));
        filled.into_iter().map(note).collect()
    }

    /// Whether a row without a name has the nominal value and the unit of the one above it.
    fn goes_on(&self, above: &Record, row: &Record) -> bool {
        let is_same = |place: usize| row.cell(place).is_empty() || row.cell(place).text() == above.cell(place).text();
        [Role::Nominal, Role::Unit].into_iter().filter_map(|role| self.place(role)).all(is_same)
    }

    /// A second column of the same role, with numbers, leaves open which of them counts; so do several columns of values
    /// beside one that names the part, and a column called like a part beside the values.
    fn has_each_role_once(&self, want: &Want) -> Result<(), NoShape> {
        let header = &self.header.cells;
        let two = |first: usize, second: usize| {
            Err(NoShape::TwoColumns { first: header[first].clone(), second: header[second].clone() })
        };
        if let ([first, second, ..], Some(_)) = (&self.parts[..], self.place(Role::Part)) {
            return two(*first, *second);
        }
        for (place, role) in self.roles.iter().enumerate() {
            let is_second_value = || {
                !want.ignores(&header[place].text())
                    && (self.parts.is_empty() && names_one_part(&header[place].text())
                        || self.may_be_second_value(place, want))
            };
            let role = match role {
                Some(Role::Name | Role::Uncertainty) => continue,
                Some(role) => *role,
                None if is_second_value() => Role::Measured,
                None => continue,
            };
            let first = self.place(role).unwrap_or(place);
            if first != place && (role == Role::Unit || self.has_numbers(place) && !self.is_limit_of(place, first)) {
                return two(first, place);
            }
        }
        Ok(())
    }

    /// Whether a column has the limits of size of a column of allowances, `OGW` beside `OT`, or the reverse.
    fn is_limit_of(&self, place: usize, other: usize) -> bool {
        const ROUNDING: f64 = 1e-9;
        let Some(nominal) = self.place(Role::Nominal) else { return false };
        matches!(self.roles[place], Some(Role::Upper | Role::Lower))
            && self.rows.iter().filter(|row| row.cell(place).is_number()).all(|row| {
                let [limit, other, nominal] =
                    [place, other, nominal].map(|place| number(row.cell(place)).unwrap_or(f64::NAN));
                let apart = (limit - other).abs();
                (apart - nominal.abs()).abs() <= ROUNDING
            })
    }

    /// Whether a column is called by who may have measured again, or by a word for values, and a known row has a number there; one
    /// whole number in all rows is none of a value.
    fn may_be_second_value(&self, place: usize, want: &Want) -> bool {
        let title = self.title(place);
        let words = || title.split(|c: char| !c.is_alphanumeric());
        // a number of measurements is none of them
        let is_of_values = |word: &str| role(word) == Some(Role::Measured);
        let is_called_so = WordList::Verifier.has(&title)
            || words().any(is_of_values)
                && !words().any(is_part_name)
                && !is_statistic_among(&title, &self.header.cells);
        let is_value = |row: &Cow<'_, Record>| {
            row.cell(place).is_measure() && names_value(&row.cells[self.name].text(), &want.own)
        };
        let is_fixed =
            self.rows.len() > 1 && self.column(place).all(Cell::is_whole) && distinct(self.column(place)) == 1;
        is_called_so && !is_fixed && self.rows.iter().any(is_value)
    }

    /// The columns that are neither names nor values, nor what belongs to them.
    fn columns_without_role(&self) -> impl Iterator<Item = Unknown> {
        let says_nothing = |place: usize| match self.roles[place] {
            None => true,
            Some(Role::Status) => split_unit(&self.title(place)).1.is_none(),
            // a second value has no numbers, and limits stand beside allowances: `OT` and `OGW`
            Some(role @ (Role::Measured | Role::Part | Role::Upper | Role::Lower)) => self.place(role) != Some(place),
            Some(_) => false,
        };
        let is_without =
            move |place: &usize| says_nothing(*place) && *place != self.name && !self.parts.contains(place);
        let unknown = |place: usize| {
            let cells: Vec<Cell> = self.rows.iter().filter_map(|row| row.cells.get(place).cloned()).collect();
            let is_value = self.roles[place].is_none() && self.may_be_value(place);
            Unknown::column(&self.title(place), place, cells).measured(is_value)
        };
        (0..self.roles.len()).filter(is_without).map(unknown)
    }

    /// The values in a row.
    fn values_of<'c>(&'c self, row: &'c Record) -> impl Iterator<Item = f64> {
        let places = self.parts.iter().copied().chain(self.place(Role::Measured));
        places.filter_map(|place| number(row.cell(place)))
    }

    /// Whether the numbers of a column without a role may be values: an extreme or a mean of them is, if it contradicts them.
    fn may_be_value(&self, place: usize) -> bool {
        let title = self.title(place);
        if is_extreme(&title) {
            // the largest of the values is one of them
            !self.rows.iter().all(|row| {
                let cell = row.cell(place);
                cell.is_missing() || self.values_of(row).any(|value| number(cell) == Some(value))
            })
        } else if WordList::Mean.has(&title) {
            self.rows.iter().any(|row| {
                let cell = row.cell(place);
                let text = cell.text();
                let decimals = text.split_once([',', '.']).map_or(0, |(_, decimals)| decimals.len());
                let last_digit: f64 = format!("1e-{decimals}").parse().unwrap_or(1.0);
                let largest = self.values_of(row).map(f64::abs).reduce(f64::max);
                number(cell).zip(largest).is_some_and(|(mean, largest)| mean.abs() > largest + last_digit)
            })
        } else {
            // a list's numbers count its rows: 1, 2, or 1.1, 1.2
            let is_number = |cell: &Cell| cell.text().bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
            let is_called = WordList::RowNumber.has(&title);
            let is_count = |cell: &Cell| cell.is_whole() || is_called && is_number(cell);
            let is_counted = (place < self.name || self.parts.is_empty()) && self.column(place).all(is_count);
            !is_counted
                && (!is_part_name(&title) || has_digit(&title))
                && !is_statistic_among(&title, &self.header.cells)
        }
    }
}
