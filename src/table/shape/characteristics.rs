//! Tables with a row per characteristic, as CMM programs export them: a column of names, and columns of actual and nominal
//! values, tolerances, deviations and units; one part, a part in each of several columns, or a column that names the part.
//! Called by [`shape`](super::shape).

use std::borrow::Cow;
use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap, HashSet};

use super::headings::{Named, PartNames, headings, is_extreme, is_part_name, is_statistic_among, says_no_part};
use super::rows::is_shifted;
use super::{Measurement, NoShape, Series, Shape, aside, has_digit};
use crate::table::cell::{Cell, Record};
use crate::table::column::is_limit;
use crate::table::companions::Companions;
use crate::table::grid::{Separator, bare_unit, differ, is_unit, unit_in};
use crate::table::names::{
    Field, Role, ValueKind, WordList, heading, is_again, is_called, is_context, names_value, role, split_unit,
};
use crate::table::unknown::Unknown;
use crate::table::want::{Orientation, Want};

/// A table of characteristics, found but not read.
pub(crate) struct Characteristics {
    header: usize,
    /// What each column is.
    roles: Vec<Option<Role>>,
    /// The column of names.
    name: usize,
    /// The columns of values, where each is a part.
    parts: Vec<usize>,
    /// The records that are characteristics, known or not.
    rows: Vec<usize>,
    /// How many of them have a known name.
    pub(crate) known: usize,
}

/// What the cells of a row are, by the part and the field that they belong to.
struct Reading<'a> {
    found: &'a Characteristics,
    want: &'a Want,
    /// The heading of each column.
    titles: Vec<String>,
    parts: Vec<Cell>,
    /// The index of each part by its name, where a column names it.
    indices: HashMap<String, usize>,
    lines: Vec<u64>,
    /// Whether a row has a unit beside its value.
    has_units: bool,
}

/// A header that speaks of nominal and actual values, or of values of parts, and the records below it that start with a
/// name.
pub(crate) fn find_characteristics(records: &[Record], want: &Want) -> Option<Characteristics> {
    if want.teeth == Some(true) {
        return None;
    }
    let may_be_header = |record: &Record| record.numbers() == 0 || numbers_parts(record);
    records.iter().enumerate().filter(|(_, record)| may_be_header(record)).find_map(|(header, record)| {
        let is_ignored = |cell: &Cell| want.ignores(&cell.text());
        // a part in a series is none that is called by its letters: K1, K2, K3
        let is_of_series = |place: usize| is_called_like_another(&record.cells, place);
        let names_part =
            |cell: &Cell| want.own.iter().any(|(own, field)| *field == Field::PartId && is_called(&cell.text(), own));
        let is_part_named = record.cells.iter().any(names_part);
        let role_of = |(place, cell): (usize, &Cell)| {
            if is_part_named && (names_part(cell) || role(&cell.text()) == Some(Role::Part)) {
                return names_part(cell).then_some(Role::Part);
            }
            role(&cell.text()).filter(|role| !(is_ignored(cell) || role.is_beside_value() && is_of_series(place)))
        };
        let mut roles: Vec<_> = record.cells.iter().enumerate().map(role_of).collect();
        take_names(&mut roles, record, &records[header + 1..], want);
        take_verdicts(&mut roles, record, &records[header + 1..]);
        let has = |wanted: &[Role]| roles.iter().flatten().any(|role| wanted.contains(role));
        // names of parts beside a word for names, as in `Merkmal | Einheit | Teil 1 | Teil 2`
        let names_parts = roles.contains(&Some(Role::Name)) && roles.contains(&None);
        let is_table = names_parts
            || roles.iter().flatten().count() > 1
                && has(&[Role::Measured, Role::Deviation, Role::Nominal, Role::Upper, Role::Lower]);
        if !is_table {
            return None;
        }
        let has_name =
            |row: &Record, place: usize| row.cells.get(place).is_some_and(|cell| names_value(&cell.text(), &want.own));
        let named = |place: &usize| records[header + 1..].iter().filter(|row| has_name(row, *place)).count();
        let called = (0..roles.len()).rev().filter(|place| roles[*place] == Some(Role::Name));
        // a number or a short text may stand before what was measured, and be called a name too
        let name = called.max_by_key(named);
        let name = name.or_else(|| roles.iter().position(Option::is_none)).unwrap_or(0);
        // a value with a unit is no name: `P2 again: 25,30 mm`, cut at its comma
        let may_be_name = |cell: &Cell| !(cell.is_number() && unit_in(&cell.text()).is_some_and(|unit| is_unit(&unit)));
        let is_row = |record: &Record| {
            record.cells.len() > name.max(1) && record.numbers() > 0 && may_be_name(&record.cells[name])
                || has_name(record, name)
        };
        let rows: Vec<usize> = (header + 1..records.len()).filter(|index| is_row(&records[*index])).collect();
        let parts = if has(&[Role::Measured, Role::Deviation]) {
            Vec::new()
        } else {
            let is_part = |place: &usize| {
                let title = record.cells[*place].text();
                let is_counter = || is_part_name(&title) && !has_digit(&title);
                let has_numbers = |row: &usize| records[*row].cells.get(*place).is_some_and(Cell::is_number);
                *place != name
                    && roles[*place].is_none()
                    && !is_counter()
                    && !(*place < name && !has_digit(&title) && counts_rows(records, &rows, *place))
                    && (!is_statistic_among(&title, &record.cells) || is_called_like_another(&record.cells, *place))
                    && (has_digit(&title) || !is_context(&title))
                    && !record.cells[*place].is_empty()
                    && !is_ignored(&record.cells[*place])
                    && (names_one_part(&title)
                        || is_called_like_another(&record.cells, *place)
                        || rows.iter().any(has_numbers))
            };
            let mut found: Vec<usize> = (0..roles.len()).filter(is_part).collect();
            let is_numbered = |place: &usize| has_digit(&record.cells[*place].text());
            if found.iter().any(|place| names_one_part(&record.cells[*place].text())) {
                found.retain(is_numbered);
            }
            // one of which nothing was measured is called like the others
            let names = PartNames::of(found.iter().map(|place| &record.cells[*place]));
            let is_like = |place: &usize| {
                let title = record.cells[*place].text();
                *place != name
                    && roles[*place].is_none()
                    && names.may_have(&title)
                    && !is_statistic_among(&title, &record.cells)
                    && !is_ignored(&record.cells[*place])
            };
            (0..roles.len()).filter(|place| found.contains(place) || !found.is_empty() && is_like(place)).collect()
        };
        let is_known = |row: &&usize| heading(&records[**row].cells[name].text(), &want.own).is_some();
        let known = rows.iter().filter(is_known).count();
        let is_read = has(&[Role::Measured, Role::Deviation]) || !parts.is_empty();
        drop_common_names(&mut roles, &rows, records, record);
        let parts = settle_parts(&mut roles, parts, &rows, records);
        drop_extremes(&mut roles, &parts, record);
        // so many roles leave no doubt, though none of the names is known
        let is_sure = roles.contains(&Some(Role::Name)) && roles.iter().flatten().count() > 2 && !rows.is_empty();
        ((known > 0 || is_sure) && is_read).then_some(Characteristics { header, roles, name, parts, rows, known })
    })
}

/// `Nom` is the nominal value, and in French the name: beside a column of nominal values it has names, if all its cells are words.
/// So has any requirement in whose cells known names stand, where no column that is called by names has them.
fn take_names(roles: &mut [Option<Role>], header: &Record, below: &[Record], want: &Want) {
    let is_called = |place: usize| header.cells[place].text().trim().eq_ignore_ascii_case("nom");
    let cells = |place: usize| below.iter().filter_map(move |row| row.cells.get(place));
    let has_words = |place: usize| {
        let mut cells = cells(place).filter(|cell| !cell.is_missing()).peekable();
        cells.peek().is_some() && !cells.any(Cell::is_number)
    };
    let has_names = |place: usize| cells(place).any(|cell| names_value(&cell.text(), &want.own));
    let [wanted, called, measured] = [Role::Nominal, Role::Name, Role::Measured].map(|role| places(roles, role));
    let may_be_french = wanted.len() > 1 && called.is_empty();
    let is_named = || !measured.is_empty() && !called.iter().any(|place| has_names(*place));
    let is_name =
        |place: &usize| has_words(*place) && (may_be_french && is_called(*place) || has_names(*place) && is_named());
    if let Some(place) = wanted.into_iter().find(is_name) {
        roles[place] = Some(Role::Name);
    }
}

/// The columns of a role.
fn places(roles: &[Option<Role>], of: Role) -> Vec<usize> {
    (0..roles.len()).filter(|place| roles[*place] == Some(of)).collect()
}

/// Of several columns that may name the part, those that are the same in every row name it not, beside one that is not; nor do
/// those that go one to one with it.
fn drop_common_names(roles: &mut [Option<Role>], rows: &[usize], records: &[Record], header: &Record) {
    let names = places(roles, Role::Part);
    if names.len() < 2 {
        return;
    }
    let is_common = |place: usize| {
        let cells = rows.iter().filter_map(|row| records[*row].cells.get(place)).filter(|cell| !cell.is_missing());
        cells.map(Cell::text).collect::<HashSet<_>>().len() < 2
    };
    let is_serial = |place: usize| WordList::Serial.has(&header.cells[place].text());
    let tells = |place: &usize| !is_common(*place) && (is_serial(*place) || !counts_rows(records, rows, *place));
    let of_one_part = || {
        let serial = names.iter().find(|place| is_serial(**place)).or(names.first());
        serial.filter(|_| names.iter().all(|place| is_common(*place)))
    };
    let Some(kept) = names.iter().find(|place| tells(place)).or_else(of_one_part) else { return };
    // as many pairs as there are of either
    let is_same = |place: usize| {
        let names = |place: usize| rows.iter().map(move |row| records[*row].cells.get(place).map(Cell::text));
        let pairs: HashSet<_> = names(*kept).zip(names(place)).collect();
        [*kept, place].into_iter().all(|place| names(place).collect::<HashSet<_>>().len() == pairs.len())
    };
    for place in names.iter().filter(|place| *place != kept && (is_common(**place) || is_same(**place))) {
        roles[*place] = None;
    }
}

/// Words beside the values of several parts are no part's: `Part 1 | Part 2 | Result`.
fn take_verdicts(roles: &mut [Option<Role>], header: &Record, below: &[Record]) {
    let cells = |place: usize| below.iter().filter_map(move |row| row.cells.get(place));
    let is_part = |place: &usize| {
        let title = &header.cells[*place];
        roles[*place].is_none() && (names_one_part(&title.text()) || title.is_whole() && !title.is_empty())
    };
    let is_verdict = |place: &usize| !cells(*place).any(Cell::is_number) && !cells(*place).all(Cell::is_missing);
    if (0..roles.len()).filter(is_part).count() > 1
        && let Some(place) = places(roles, Role::Measured).into_iter().find(is_verdict)
    {
        roles[place] = Some(Role::Status);
    }
}

/// The columns that are parts, where a column seems to name the part as well: beside one column of values it does, and beside
/// several it may number the rows.
fn settle_parts(roles: &mut [Option<Role>], parts: Vec<usize>, rows: &[usize], records: &[Record]) -> Vec<usize> {
    let Some(names) = roles.iter().position(|role| *role == Some(Role::Part)) else { return parts };
    match parts[..] {
        [] => return parts,
        [values] => {
            roles[values] = Some(Role::Measured);
            return Vec::new();
        }
        _ => {}
    }
    let numbers: Vec<_> = rows.iter().filter_map(|row| records[*row].cells.get(names)).map(Cell::text).collect();
    let is_number = |text: &Cow<'_, str>| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let distinct: HashSet<_> = numbers.iter().collect();
    if numbers.iter().all(is_number) && distinct.len() == rows.len() {
        roles[names] = None;
    }
    parts
}

/// An extreme is no limit where it may be made of the values: right behind the measured ones, or alone behind the parts.
fn drop_extremes(roles: &mut [Option<Role>], parts: &[usize], header: &Record) {
    let is_limit = |role: Option<Role>| matches!(role, Some(Role::Upper | Role::Lower));
    let limits: Vec<usize> = (0..roles.len()).filter(|place| is_limit(roles[*place])).collect();
    if let ([limit], Some(last)) = (&limits[..], parts.last())
        && limit > last
        && is_extreme(&header.cells[*limit].text())
    {
        roles[*limit] = None;
    }
    if let Some(measured) = roles.iter().position(|role| *role == Some(Role::Measured)) {
        let behind = measured + 1..roles.len();
        for place in behind.take_while(|place| is_extreme(&header.cells[*place].text())) {
            roles[place] = None;
        }
    }
}

/// Whether two cells hold the same number, whichever their decimal mark is.
fn is_same_number(one: &Cell, other: &Cell) -> bool {
    number(one).is_some() && number(one) == number(other)
}

/// The number in a cell, whichever its decimal mark is.
fn number(cell: &Cell) -> Option<f64> {
    cell.text().replace(',', ".").parse().ok()
}

/// One of the last digit of a number.
fn last_digit(cell: &Cell) -> f64 {
    let text = cell.text();
    let decimals = text.split_once([',', '.']).map_or(0, |(_, decimals)| decimals.len());
    format!("1e-{decimals}").parse().unwrap_or(1.0)
}

/// Whether a column has the axes along which something was measured.
pub(super) fn is_axis(title: &str) -> bool {
    ["ax", "axis", "achse", "axe", "軸"].contains(&title.trim().to_lowercase().as_str())
}

/// Whether a cell of that column is a direction: M, R, X.
pub(super) fn is_direction(name: &Cell) -> bool {
    name.text().trim().chars().count() <= 2
}

/// Whether a line numbers parts behind a word for names: `Merkmal | Einheit | 417 | 418`.
fn numbers_parts(record: &Record) -> bool {
    let numbers = record.cells.iter().filter(|cell| cell.is_number()).map(Cell::text);
    let numbers: Vec<_> = numbers.map(|text| text.trim().to_owned()).collect();
    let distinct: HashSet<_> = numbers.iter().collect();
    numbers.iter().all(|number| number.bytes().all(|byte| byte.is_ascii_digit()))
        && distinct.len() == numbers.len()
        && record.cells.iter().any(|cell| role(&cell.text()) == Some(Role::Name))
}

/// Whether a heading is that of another column but for its digits: `R17` beside `R16`.
fn is_called_like_another(header: &[Cell], place: usize) -> bool {
    let stem = |cell: &Cell| cell.text().trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
    let own = stem(&header[place]);
    let is_letter = |cell: &Cell| cell.text().chars().count() == 1 && cell.text().chars().all(char::is_alphabetic);
    // R, S, T, U
    let is_of_letters = is_letter(&header[place]) && header.iter().filter(|cell| is_letter(cell)).count() > 2;
    is_of_letters
        || has_digit(&header[place].text())
            && !own.is_empty()
            && header
                .iter()
                .enumerate()
                .any(|(other, cell)| other != place && has_digit(&cell.text()) && stem(cell) == own)
}

/// Whether a column holds the numbers of the rows, such as those of the balloons on a drawing.
fn counts_rows(records: &[Record], rows: &[usize], place: usize) -> bool {
    let cells = || rows.iter().filter_map(|row| records[*row].cells.get(place));
    let number = |cell: &Cell| cell.text().parse::<u64>().ok();
    cells().all(Cell::is_whole) && cells().filter_map(number).is_sorted_by(|one, next| one < next)
}

/// Whether a heading is the name of a part, `Teil 2`, even if nothing of it was measured.
fn names_one_part(title: &str) -> bool {
    has_digit(title) && is_part_name(title.trim_end_matches(|c: char| c.is_ascii_digit() || c == '-'))
}

/// Reads the characteristics.
pub(crate) fn by_characteristic(
    records: &[Record],
    found: &Characteristics,
    separator: Separator,
    want: &Want,
) -> Result<Shape, NoShape> {
    let (records, filled) = found.with_names(records);
    let records = &*records;
    let header = &records[found.header];
    let is_ragged = |row: &&usize| {
        let record = &records[**row];
        is_cut(record, header, separator, want)
            || record.filled().len() > header.cells.len()
            || is_shifted(header.start, &header.cells, record, separator)
    };
    if let Some(row) = found.rows.iter().find(is_ragged) {
        return Err(NoShape::Ragged { record: records[*row].clone(), expected: header.cells.len() });
    }
    found.has_each_role_once(records, want)?;
    let is_no_part = |place: &&usize| {
        let title = header.cells[**place].text();
        says_no_part(&title) || is_again(&title)
    };
    if let Some(place) = found.parts.iter().find(is_no_part) {
        return Err(NoShape::NoPart { heading: header.cells[*place].clone() });
    }
    let mut names: Vec<Cell> = Vec::new();
    let mut rows_of: HashMap<String, Vec<&Record>> = HashMap::new();
    for row in &found.rows {
        let name = &records[*row].cells[found.name];
        let rows = rows_of.entry(name.text().into_owned()).or_default();
        if rows.is_empty() {
            names.push(name.clone());
        }
        rows.push(&records[*row]);
    }
    let is_axis = is_axis(&header.cells[found.name].text());
    let named = headings(&names, want)?.into_iter().zip(&names);
    let named: Vec<_> = named.map(|(named, name)| named.filter(|_| !(is_axis && is_direction(name)))).collect();
    let mut shape = Shape::new(Orientation::Columns);
    shape.header_line = Some(header.line);
    let note = |place: usize| {
        let title = header.cells[place].text();
        format!("`{title}`: a name counts for the empty cells below it")
    };
    shape.notes.extend(filled.into_iter().map(note));
    let reading = Reading::new(records, found, want);
    for (name, named) in names.iter().zip(named) {
        let rows = &rows_of[name.text().as_ref()];
        let Some(named) = named else {
            let mut cells: Vec<Cell> = rows.iter().flat_map(|row| found.values_of(row)).collect();
            if !cells.iter().any(Cell::is_number) {
                // where a separator is lost, the value stands behind the name
                cells.extend(name.text().split_whitespace().next_back().map(|last| Cell::of_text(last, 0..0)));
            }
            let unit = reading.unit_of_rows(rows).ok().flatten();
            // behind the name of a part stands a value of it
            let is_unread = names_one_part(&name.text()) && cells.iter().any(Cell::is_number);
            let unknown = Unknown::line(&name.text(), rows[0].line, cells).measured(true);
            shape.unknown.push(Unknown { unit, is_unread, ..unknown });
            continue;
        };
        let measurement = reading.measurement(&named, rows, name)?;
        if shape.measurements.iter().any(|known| known.field == measurement.field) {
            return Err(twice(&named, name));
        }
        shape.measurements.push(measurement);
    }
    if found.roles.contains(&Some(Role::Part)) || !found.parts.is_empty() {
        let column = found.roles.iter().position(|role| *role == Some(Role::Part));
        let title = column.map_or_else(|| "part".to_owned(), |place| header.cells[place].text().into_owned());
        shape.ids = Some(Series { title, cells: reading.parts.clone(), ..Series::default() });
    }
    shape.unknown.extend(found.columns_without_role(records));
    shape.lines = reading.lines;
    shape.beside = found.rows.iter().flat_map(|row| records[*row].cells.iter().cloned()).collect();
    let strangers = (0..records.len()).filter(|index| *index != found.header && !found.rows.contains(index));
    shape.asides = strangers.map(|index| &records[index]).filter(|record| !record.says_nothing()).map(aside).collect();
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

impl Characteristics {
    /// Those of all rows below the first one, which is the header.
    pub(super) fn below_header(roles: Vec<Option<Role>>, end: usize) -> Self {
        let name = roles.iter().position(|role| *role == Some(Role::Name)).unwrap_or(0);
        Self { header: 0, roles, name, parts: Vec::new(), rows: (1..end).collect(), known: end.saturating_sub(1) }
    }

    /// The first column of a role.
    fn place(&self, role: Role) -> Option<usize> {
        self.roles.iter().position(|other| *other == Some(role))
    }

    /// The records with the names of part and characteristic in every row, where one stands in the first row of a block only,
    /// and the columns of which cells were filled.
    fn with_names<'r>(&self, records: &'r [Record]) -> (Cow<'r, [Record]>, BTreeSet<usize>) {
        let mut filled = (Cow::Borrowed(records), BTreeSet::new());
        let Some(part) = self.place(Role::Part) else { return filled };
        for rows in self.rows.windows(2) {
            for (place, other) in [(part, self.name), (self.name, part)] {
                let (above, row) = (&filled.0[rows[0]].cells, &records[rows[1]].cells);
                let has_other = row.get(other).is_some_and(|cell| !cell.is_missing());
                if row.get(place).is_some_and(Cell::is_empty)
                    && has_other
                    && (place == part || self.goes_on(above, row))
                {
                    let name = above.get(place).cloned().unwrap_or_default();
                    filled.0.to_mut()[rows[1]].cells[place] = name;
                    filled.1.insert(place);
                }
            }
        }
        filled
    }

    /// Whether a row without a name has the nominal value and the unit of the one above it.
    fn goes_on(&self, above: &[Cell], row: &[Cell]) -> bool {
        let is_same = |place: usize| {
            let text = |cells: &[Cell]| cells.get(place).map(|cell| cell.text().into_owned()).unwrap_or_default();
            text(row).is_empty() || text(row) == text(above)
        };
        [Role::Nominal, Role::Unit].into_iter().filter_map(|role| self.place(role)).all(is_same)
    }

    /// A second column of the same role, with numbers, leaves open which of them counts; so do several columns of values
    /// beside one that names the part, and a column called like a part beside the values.
    fn has_each_role_once(&self, records: &[Record], want: &Want) -> Result<(), NoShape> {
        let header = &records[self.header].cells;
        let two = |first: usize, second: usize| {
            Err(NoShape::TwoColumns { first: header[first].clone(), second: header[second].clone() })
        };
        if let ([first, second, ..], Some(_)) = (&self.parts[..], self.place(Role::Part)) {
            return two(*first, *second);
        }
        for (place, role) in self.roles.iter().enumerate() {
            let role = match role {
                Some(Role::Name | Role::Uncertainty) => continue,
                Some(role) => *role,
                None if want.ignores(&header[place].text()) => continue,
                None if self.parts.is_empty() && names_one_part(&header[place].text()) => Role::Measured,
                None if self.may_be_second_value(records, place, want) => Role::Measured,
                None => continue,
            };
            let first = self.place(role).unwrap_or(place);
            if first != place && (role == Role::Unit || self.has_numbers(records, place)) {
                return two(first, place);
            }
        }
        Ok(())
    }

    /// Whether a column is called by who may have measured again, or by a word for values, and a known row has a number there; one
    /// whole number in all rows is none of a value.
    fn may_be_second_value(&self, records: &[Record], place: usize, want: &Want) -> bool {
        let header = &records[self.header].cells;
        let title = header[place].text();
        let words = || title.split(|c: char| !c.is_alphanumeric());
        // a number of measurements is none of them
        let is_of_values = |word: &str| role(word) == Some(Role::Measured);
        let is_called_so = WordList::Verifier.has(&title)
            || words().any(is_of_values) && !words().any(is_part_name) && !is_statistic_among(&title, header);
        let cells = || self.rows.iter().map(|row| &records[*row].cells);
        let is_value = |cells: &Vec<Cell>| {
            cells.get(place).is_some_and(Cell::is_measure) && names_value(&cells[self.name].text(), &want.own)
        };
        let whole = cells().map(|cells| cells.get(place).filter(|cell| cell.is_whole()).map(Cell::text));
        let whole: HashSet<_> = whole.collect();
        let is_fixed = self.rows.len() > 1 && whole.len() == 1 && !whole.contains(&None);
        is_called_so && !is_fixed && cells().any(is_value)
    }

    /// The cells of a row that may be measured: all but its name, and the part's.
    fn values_of(&self, row: &Record) -> Vec<Cell> {
        let is_value = |place: usize| place != self.name && self.roles.get(place) != Some(&Some(Role::Part));
        row.cells.iter().enumerate().filter(|(place, _)| is_value(*place)).map(|(_, cell)| cell.clone()).collect()
    }

    fn has_numbers(&self, records: &[Record], place: usize) -> bool {
        self.rows.iter().any(|row| records[*row].cells.get(place).is_some_and(Cell::is_number))
    }

    /// The columns that are neither names nor values, nor what belongs to them.
    fn columns_without_role(&self, records: &[Record]) -> Vec<Unknown> {
        let header = &records[self.header].cells;
        let says_nothing = |place: usize| match self.roles[place] {
            None => true,
            Some(Role::Status) => split_unit(&header[place].text()).1.is_none(),
            // a second one has no numbers
            Some(role @ (Role::Measured | Role::Part)) => self.place(role) != Some(place),
            Some(_) => false,
        };
        let is_without = |place: &usize| says_nothing(*place) && *place != self.name && !self.parts.contains(place);
        let unknown = |place: usize| {
            let cells: Vec<Cell> = self.rows.iter().filter_map(|row| records[*row].cells.get(place).cloned()).collect();
            // a list's numbers count its rows
            let is_counted = (place < self.name || self.parts.is_empty()) && cells.iter().all(Cell::is_whole);
            let title = header[place].text();
            // the largest of the values is one of them
            let is_of_parts = |row: &usize| {
                let record = &records[*row];
                let is_part = |part: &Cell| record.cells.get(place).is_some_and(|cell| is_same_number(part, cell));
                let values = self.parts.iter().copied().chain(self.place(Role::Measured));
                let mut values = values.filter_map(|value| record.cells.get(value));
                record.cells.get(place).is_none_or(Cell::is_missing) || values.any(is_part)
            };
            let is_beyond = |row: &usize| {
                let record = &records[*row];
                let size = |place: usize| Some(number(record.cells.get(place)?)?.abs());
                let values = self.parts.iter().copied().chain(self.place(Role::Measured)).filter_map(size);
                let digit = record.cells.get(place).map_or(0.0, last_digit);
                size(place).zip(values.reduce(f64::max)).is_some_and(|(size, largest)| size > largest + digit)
            };
            let is_value = if is_extreme(&title) {
                !self.rows.iter().all(is_of_parts)
            } else if WordList::Mean.has(&title) {
                self.rows.iter().any(is_beyond)
            } else {
                !is_counted && (!is_part_name(&title) || has_digit(&title)) && !is_statistic_among(&title, header)
            };
            Unknown::column(&title, place, cells).measured(is_value && self.roles[place].is_none())
        };
        (0..self.roles.len()).filter(is_without).map(unknown).collect()
    }
}

impl<'a> Reading<'a> {
    fn new(records: &[Record], found: &'a Characteristics, want: &'a Want) -> Self {
        let header = &records[found.header];
        let titles: Vec<_> = header.cells.iter().map(|cell| cell.text().into_owned()).collect();
        let first = found.rows.first().map_or(header.line, |row| records[*row].line);
        let has_unit = |place| {
            found.rows.iter().any(|row| records[*row].cells.get(place).is_some_and(|cell: &Cell| is_unit(&cell.text())))
        };
        let has_units = found.place(Role::Unit).is_some_and(has_unit);
        let (parts, indices, lines) = (Vec::new(), HashMap::new(), Vec::new());
        let mut reading = Self { found, want, titles, parts, indices, lines, has_units };
        match found.place(Role::Part) {
            Some(place) => {
                for row in &found.rows {
                    let record = &records[*row];
                    let name = record.cells.get(place).cloned().unwrap_or_default();
                    if let Entry::Vacant(entry) = reading.indices.entry(name.text().into_owned()) {
                        entry.insert(reading.parts.len());
                        reading.parts.push(name);
                        reading.lines.push(record.line);
                    }
                }
            }
            None if found.parts.is_empty() => {
                reading.parts.push(Cell::default());
                reading.lines.push(first);
            }
            None => {
                reading.parts = found.parts.iter().map(|place| header.cells[*place].clone()).collect();
                reading.lines = vec![first; found.parts.len()];
            }
        }
        reading
    }

    /// The part that a row belongs to; 0 where the row belongs to all.
    fn part_of(&self, record: &Record) -> usize {
        let name = self.found.place(Role::Part).and_then(|place| record.cells.get(place));
        name.and_then(|name| self.indices.get(name.text().as_ref())).copied().unwrap_or(0)
    }

    /// The cells of one column, one per part.
    fn series(&self, place: usize, rows: &[&Record], title: &Cell, field: Field) -> Result<Series, NoShape> {
        let mut cells = vec![Cell::default(); self.parts.len()];
        let mut filled = vec![false; self.parts.len()];
        for record in rows {
            let cell = record.cells.get(place).filter(|cell| !cell.is_missing()).cloned().unwrap_or_default();
            if !self.found.parts.is_empty() {
                // a nominal value or a tolerance is that of every part
                cells.fill(cell);
                continue;
            }
            let part = self.part_of(record);
            if std::mem::replace(&mut filled[part], true) {
                return Err(NoShape::Twice { heading: title.clone(), field, may_tell: self.may_tell(rows) });
            }
            cells[part] = cell;
        }
        let (_, unit) = split_unit(&self.titles[place]);
        Ok(Series { title: title.text().into_owned(), place, unit, cells })
    }

    /// The columns without a role that may tell of which parts rows are, where none is known to: no two rows have the same there.
    fn may_tell(&self, rows: &[&Record]) -> Vec<String> {
        let differs = |place: &usize| {
            let cells = rows.iter().filter_map(|row| row.cells.get(*place)).filter(|cell| !cell.is_missing());
            self.found.roles[*place].is_none() && cells.map(Cell::text).collect::<HashSet<_>>().len() == rows.len()
        };
        let is_told = self.found.place(Role::Part).is_some();
        (0..self.titles.len())
            .filter(|place| !is_told && differs(place))
            .map(|place| self.titles[place].clone())
            .collect()
    }

    /// The values of one characteristic.
    fn measurement(&self, named: &Named, rows: &[&Record], title: &Cell) -> Result<Measurement, NoShape> {
        if !self.found.parts.is_empty() && rows.len() > 1 {
            return Err(twice(named, title));
        }
        let unit_of_row = self.unit_of_rows(rows)?;
        if differ(named.series.unit.as_deref(), unit_of_row.as_deref()) {
            return Err(NoShape::Units { record: rows[0].clone() });
        }
        // where others have a unit beside them, none is assumed
        let missing = || self.has_units.then(String::new);
        let unit = named.series.unit.clone().or(unit_of_row).or_else(missing);
        // the unit in the heading of a column is that of its numbers
        let united = |series: Series| Series { unit: series.unit.clone().or_else(|| unit.clone()), ..series };
        let of_role = |role: Role| -> Result<Option<Series>, NoShape> {
            let Some(place) = self.found.place(role) else { return Ok(None) };
            let series = united(self.series(place, rows, title, named.field)?);
            Ok(series.cells.iter().any(|cell| !cell.is_missing()).then_some(series))
        };
        let (measured, deviation) = (of_role(Role::Measured)?, of_role(Role::Deviation)?);
        let measured = if self.found.parts.is_empty() { measured } else { Some(united(self.by_part(rows, title))) };
        let mut beside = Companions::default();
        let headed = |series: Series| Series { title: self.titles[series.place].clone(), ..series };
        for role in [Role::Nominal, Role::Upper, Role::Lower, Role::Uncertainty] {
            beside.set(role, of_role(role)?.map(headed));
        }
        // what is wanted of a deviation is a limit: `max. 10 µm`
        let are_limits = |wanted: &Series| wanted.cells.iter().all(|cell| cell.is_missing() || is_limit(&cell.text()));
        if let Some(limit) = beside.get(Role::Nominal).filter(|wanted| are_limits(wanted)).cloned() {
            beside.set(Role::Nominal, None);
            beside.set(Role::Upper, Some(limit));
        }
        // the value and its nominal, or else the deviation
        let in_spec =
            named.field.kind().and_then(|kind| self.want.given(kind)).is_some_and(|given| given.nominal.is_some());
        let (value, deviation, holds) = match (measured, deviation) {
            (Some(measured), deviation) if beside.get(Role::Nominal).is_some() || (in_spec && deviation.is_some()) => {
                (measured, deviation, Some(ValueKind::Measured))
            }
            (None, Some(deviation)) if self.found.place(Role::Measured).is_some() && says_zero(&deviation) => {
                // a report that nobody filled in
                (
                    Series { cells: vec![Cell::default(); self.parts.len()], ..deviation },
                    None,
                    Some(ValueKind::Deviation),
                )
            }
            (measured, Some(deviation)) => {
                beside.set(Role::Measured, measured.map(headed));
                (deviation, None, Some(ValueKind::Deviation))
            }
            (measured, None) => {
                // without values, any unit will do
                let unit = unit.clone().filter(|unit| !unit.is_empty());
                let unit = unit.or_else(|| Some(if named.field.is_angle() { "°" } else { "mm" }.to_owned()));
                let cells = vec![Cell::default(); self.parts.len()];
                let empty = || Series { unit, cells, ..named.series.clone() };
                (measured.unwrap_or_else(empty), None, named.holds)
            }
        };
        let has_value = value.cells.iter().any(|cell| !cell.is_missing());
        if has_value && differ(value.unit.as_deref(), unit.as_deref()) {
            return Err(NoShape::Units { record: rows[0].clone() });
        }
        let field = if named.aspect == Role::Measured { named.field } else { return Err(twice(named, title)) };
        beside.set(Role::Deviation, deviation.map(headed));
        Ok(Measurement { field, holds, value, beside, stated_unit: None, nominal_in_row: None })
    }

    /// The unit in the column of units, which is the same for every row of a characteristic.
    fn unit_of_rows(&self, rows: &[&Record]) -> Result<Option<String>, NoShape> {
        let Some(place) = self.found.place(Role::Unit) else { return Ok(None) };
        let unit_of = |record: &Record| {
            let cell = record.cells.get(place).filter(|cell| !cell.is_missing())?;
            Some(bare_unit(&cell.text()).to_owned())
        };
        let unit = unit_of(rows[0]);
        match rows.iter().find(|record| unit_of(record) != unit) {
            Some(record) => Err(NoShape::Units { record: (*record).clone() }),
            None => Ok(unit),
        }
    }

    /// The values of a characteristic whose parts are columns.
    fn by_part(&self, rows: &[&Record], title: &Cell) -> Series {
        let cell = |place: &usize| rows[0].cells.get(*place).filter(|cell| !cell.is_missing()).cloned();
        let cells = self.found.parts.iter().map(|place| cell(place).unwrap_or_default()).collect();
        Series { title: title.text().into_owned(), cells, ..Series::default() }
    }
}

/// Whether no digit of its numbers is other than 0.
fn says_zero(series: &Series) -> bool {
    !series.cells.iter().any(|cell| cell.text().contains(|c: char| ('1'..='9').contains(&c)))
}

fn twice(named: &Named, title: &Cell) -> NoShape {
    NoShape::Twice { heading: title.clone(), field: named.field, may_tell: Vec::new() }
}
