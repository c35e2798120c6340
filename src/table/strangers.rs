//! Columns, lines and characteristics that name nothing known: which of them are no measurement, and which could be one, so
//! that nothing is judged before somebody says what they are. Called once per table.

use std::borrow::Cow;
use std::collections::HashSet;

use serde::Serialize;

use super::cell::{Cell, Record};
use super::column::{Column, Nominal, Stated, has_tolerance_behind};
use super::grid::{Separator, records};
use super::measured::MeasuredValues;
use super::names::{
    Field, Role, heading, is_called, is_context, is_evaluation_length, is_other_of_flank, is_scale, is_statistic,
    is_total, is_value_heading, lies_within, near, plain_widths, role, says_deviation, split_unit,
};
use super::reading::{AsideReading, NotUsed};
use super::shape::{PartNames, Shape, aside, has_digit, is_part_name, is_spread, shape, uncounted};
use super::understand::Understood;
use super::unknown::{UNCERTAINTY, Unknown, is_foreign_unit};
use super::want::{Orientation, Want, quoted};
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::shown;

/// A column, line or characteristic that may be a measurement and is not understood.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Stranger {
    /// The file.
    pub file: String,
    /// `column 4`, `line 7`.
    pub place: String,
    /// As the table calls it.
    pub title: String,
    /// Its first values.
    pub values: Vec<String>,
    /// The unit, if there is one.
    pub unit: Option<String>,
    /// The nearest names that are known.
    pub near: Vec<&'static str>,
    /// What leaves it out, as `--ignore` takes it.
    #[serde(skip)]
    pub(crate) pattern: String,
}

/// What became of what is not understood.
#[derive(Debug, Default)]
pub(crate) struct Sorted {
    pub(crate) strangers: Vec<Stranger>,
    pub(crate) not_used: Vec<NotUsed>,
    pub(crate) asides: Vec<AsideReading>,
    /// The errors whose columns the spec has to name before `others = "ignore"` leaves the strangers out.
    pub(crate) to_be_named: Vec<DeviationKind>,
}

/// What `others = "ignore"` leaves out: once every error of the spec is found, what cannot be one of those whose column only its
/// name tells.
#[derive(Debug, Clone)]
pub(crate) struct Others {
    is_asked: bool,
    /// The errors of the spec of which there is no column.
    missing: Vec<DeviationKind>,
    /// The errors whose column neither the spec names nor their key.
    unnamed: Vec<DeviationKind>,
}

impl Others {
    /// Of a table with these columns.
    pub(crate) fn of(columns: &[Column], want: &Want) -> Self {
        let column = |kind: &DeviationKind| columns.iter().find(|column| column.kind == Some(*kind));
        let is_named =
            |column: &Column, kind: DeviationKind| want.is_own(&column.title) || is_called(&column.title, kind.key());
        let is_unnamed = |kind: &DeviationKind| column(kind).is_some_and(|column| !is_named(column, *kind));
        let expected = || want.expected.iter().copied();
        Self {
            is_asked: want.others_ignored && !want.expected.is_empty(),
            missing: expected().filter(|kind| column(kind).is_none()).collect(),
            unnamed: expected().filter(is_unnamed).collect(),
        }
    }

    /// Whether something is left out.
    pub(crate) fn leaves_out(&self, unknown: &Unknown) -> bool {
        self.in_the_way(unknown).is_some_and(|errors| errors.is_empty())
    }

    /// The errors that something may be, and that the spec has to name before it is left out; `None` where it never is.
    fn in_the_way(&self, unknown: &Unknown) -> Option<Vec<DeviationKind>> {
        let near: Vec<_> = near(&unknown.title).into_iter().filter_map(Field::kind).collect();
        let may_be = |kind: &DeviationKind| unknown.is_repeated || near.contains(kind);
        let unnamed = self.unnamed.iter().copied().filter(may_be);
        self.is_asked.then(|| self.missing.iter().copied().chain(unnamed).collect())
    }
}

/// Sorts what a table, or another sheet of its workbook, has besides the measurements that are understood.
pub(crate) fn sort(file: &str, shape: &Shape, understood: &Understood, want: &Want, others: &Others) -> Sorted {
    let mut sorted = Sorted::default();
    let columns = &understood.columns;
    // a number above the names that no column can hold, or a whole one behind a word that is no part's name, is none of a row
    let names = understood.shape.part_names();
    let measured = MeasuredValues::of(understood);
    let is_title = |unknown: &Unknown| {
        let is_name = names.may_have(&unknown.title) || Cell::of_text(&unknown.title, 0..0).is_number();
        let is_value =
            |cell: &Cell| (is_name || cell.has_decimals()) && columns.iter().any(|column| column.may_hold(cell));
        unknown.column.is_none()
            && !has_scale(&unknown.title)
            && shape.orientation == Orientation::Rows
            && !columns.is_empty()
            && !shape.header.is_empty()
            && !unknown.clone().measured(false).could_be_measured()
            && !unknown.cells.iter().any(is_value)
    };
    for unknown in &shape.unknown {
        let behind = || unknown.cells.iter().map(Cell::text).collect::<Vec<_>>().join(" ");
        if is_title(unknown) || measured.are_described_by(unknown, &behind()) {
            sorted.not_used.push(NotUsed { title: unknown.title.clone(), why: "no measurement" });
        } else {
            let title = &unknown.title;
            let is_said = is_statistic(title) || role(title).is_some_and(Role::is_beside_value);
            let is_one_more = |cell: &Cell| {
                !is_said && measured.may_have(cell)
                    || lies_within(title) && measured.is_beyond_all(cell)
                    || is_spread(title) && measured.are_narrower_than(cell)
            };
            let is_repeated = measured.are_repeated_by(unknown) || unknown.cells.iter().any(is_one_more);
            let heading = AsideReading { line: 0, text: title.clone() };
            if let Some(value) = value_beyond(&heading, &measured, false).filter(|_| unknown.column.is_some()) {
                sorted.take(file, &Unknown { place: unknown.place.clone(), is_repeated: true, ..value }, want, others);
            }
            let is_measurement = unknown.is_measurement || is_repeated;
            let is_unread = unknown.is_unread || unknown.column.is_none() && has_scale(title);
            if unknown.column.is_some() && is_spread(title) && !is_measurement && shape.has_column_of_means() {
                sorted.not_used.push(NotUsed { title: title.clone(), why: "no measurement" });
                continue;
            }
            sorted.take(file, &Unknown { is_measurement, is_repeated, is_unread, ..unknown.clone() }, want, others);
        }
    }
    for aside in &shape.asides {
        // above the names stand titles; only what has the name of a part there is a row
        let is_above = Some(aside.line) < shape.header_line;
        let line_names = LineNames { of_parts: &names, is_above };
        let found = value_in(aside, shape.header.len(), columns, Some(&line_names));
        let found = found
            .or_else(|| value_beyond(aside, &measured, is_above))
            .map(|unknown| Unknown { is_repeated: true, ..unknown });
        let is_described = |unknown: &Unknown| {
            let behind = aside.text.strip_prefix(&unknown.title);
            behind.is_some_and(|behind| measured.are_described_by(unknown, behind))
        };
        let found = found.or_else(|| without_value(aside, shape, columns)).or_else(|| without_name(aside, shape));
        let found = found.or_else(|| of_part(aside, shape)).or_else(|| of_all_values(aside, columns));
        match found {
            Some(unknown) if !repeats_nominal(&unknown, aside, columns) && !is_described(&unknown) => {
                sorted.take(file, &unknown, want, others);
            }
            _ => sorted.asides.push(aside.clone()),
        }
    }
    let is_remark =
        |unknown: &&Unknown| unknown.column.is_some() && !want.ignores(&unknown.title) && !unknown.could_be_measured();
    let remarks = Remarks { columns, width: shape.header.len(), of_parts: &names, measured: Some(&measured) };
    for unknown in shape.unknown.iter().filter(is_remark) {
        let line = |row: usize| shape.lines.get(row).or(shape.header_line.as_ref()).copied().unwrap_or_default();
        let cells = unknown.cells.iter().enumerate().filter(|(_, cell)| !cell.is_measure());
        let mut values = cells.filter_map(|(row, cell)| remarks.value_in(cell, &unknown.place, line(row)));
        if let Some(value) = values.next() {
            sorted.take(file, &value, want, others);
        }
    }
    sorted
}

/// Remarks beside values, which may correct one.
pub(crate) struct Remarks<'a> {
    pub(crate) columns: &'a [Column],
    /// How many cells a row has.
    pub(crate) width: usize,
    pub(crate) of_parts: &'a PartNames,
    /// The values, as far as the table was looked at.
    pub(crate) measured: Option<&'a MeasuredValues>,
}

impl Remarks<'_> {
    /// What of a cell of the column at a place may be a value.
    pub(crate) fn value_in(&self, cell: &Cell, column: &str, line: u64) -> Option<Unknown> {
        let remark = AsideReading { line, text: cell.text().into_owned() };
        let names = LineNames { of_parts: self.of_parts, is_above: false };
        let is_held = |cell: &Cell| self.columns.iter().any(|column| column.may_hold(cell));
        let may_be_value = |value: &Unknown| !near(&value.title).is_empty() || value.cells.iter().any(is_held);
        // of a number with a word behind it, what is near a nominal value counts
        let is_prose = !cell.is_number() || cell.is_measure() || has_words(cell);
        let value =
            value_in(&remark, self.width, self.columns, Some(&names)).filter(|value| is_prose && may_be_value(value));
        let value = value.or_else(|| value_beyond(&remark, self.measured?, false))?;
        let place = format!("{column}, {}", value.place);
        Some(Unknown { place, ..value })
    }
}

/// What of another sheet may be a measurement: columns, or else the first line that would be one beside the table that is read.
/// A number below a name for context is none.
pub(crate) fn of_sheet(file: &str, records: &[Record], understood: &Understood, want: &Want) -> Sorted {
    let others = &Others::of(&understood.columns, want);
    let columns = shape(records, Separator::TAB, want).map(|shape| sort(file, &shape, understood, want, others));
    let mut sorted = columns.unwrap_or_default();
    let names = LineNames { of_parts: &understood.shape.part_names(), is_above: false };
    let measured = MeasuredValues::of(understood);
    let heading =
        |place: usize| records.iter().find_map(|record| record.cells.get(place).filter(|cell| !cell.is_empty()));
    let is_context = |text: &str| (is_context(text) || is_statistic(text)) && !is_part_name(text);
    let is_other = |place: usize| heading(place).is_some_and(|cell| is_context(&cell.text()));
    let is_kept = |place: usize, cell: &Cell| !cell.is_number() || !is_other(place) || measured.may_have(cell);
    for record in records {
        if !sorted.strangers.is_empty() {
            break;
        }
        let cells = record.cells.iter().enumerate().filter(|(place, cell)| is_kept(*place, cell));
        let line = aside(&Record { cells: cells.map(|(_, cell)| cell.clone()).collect(), ..record.clone() });
        let found = value_in(&line, 0, &understood.columns, Some(&names));
        if let Some(unknown) = found.or_else(|| value_beyond(&line, &measured, false)) {
            sorted.take(file, &unknown, want, others);
        }
    }
    sorted
}

impl Sorted {
    pub(crate) fn take(&mut self, file: &str, unknown: &Unknown, want: &Want, others: &Others) {
        let in_the_way = others.in_the_way(unknown);
        let title = &unknown.title;
        let not_used =
            |why| NotUsed { title: if title.is_empty() { unknown.place.clone() } else { title.clone() }, why };
        if unknown.is_ignored(want) {
            self.not_used.push(not_used("ignored by the user"));
        } else if role(title) == Some(Role::Uncertainty)
            && want.by_uncertainty
            && unknown.cells.iter().any(Cell::is_number)
        {
            self.strangers.push(stranger(file, &unknown.clone().uncertainty()));
        } else if role(title) == Some(Role::Uncertainty) {
            self.not_used.push(not_used("an uncertainty: those that count stand in the spec"));
        } else if !unknown.could_be_measured() {
            if !title.is_empty() || unknown.cells.iter().any(|cell| !cell.is_missing()) {
                self.not_used.push(not_used("no measurement"));
            }
        } else if in_the_way.as_ref().is_some_and(Vec::is_empty) {
            self.not_used.push(not_used("others are ignored"));
        } else {
            self.to_be_named.extend(in_the_way.into_iter().flatten());
            self.strangers.push(stranger(file, unknown));
        }
    }
}

/// Whether a line says nothing but a column's nominal value, and perhaps its tolerance: `Soll: 25,000 ± 0,03`.
fn repeats_nominal(unknown: &Unknown, aside: &AsideReading, columns: &[Column]) -> bool {
    let has_tolerance = has_tolerance_behind(&aside.text);
    let is_nominal = |cell: &Cell| {
        columns.iter().any(|column| {
            matches!(column.nominal, Nominal::Fixed(nominal) if column.quantity(cell).is_ok_and(|value| value == nominal))
        })
    };
    role(&unknown.title) == Some(Role::Nominal)
        && unknown.cells.first().is_some_and(is_nominal)
        && unknown.cells.len() <= 1 + usize::from(has_tolerance)
}

/// By which names a line that is no part of the table is told from a row.
pub(crate) struct LineNames<'a> {
    pub(crate) of_parts: &'a PartNames,
    /// Whether the line stands above the names of the columns, where titles are.
    pub(crate) is_above: bool,
}

/// What of a line that is no part of the table may be a measured value: what has the name or the unit of one, a number
/// with decimals that may be one of the columns', or as many numbers as a row has. Statistics and tolerances are none. A number
/// behind a word that is no part's name is one near a column's nominal value only, and above the names with three decimals.
pub(crate) fn value_in(
    aside: &AsideReading,
    width: usize,
    columns: &[Column],
    names: Option<&LineNames<'_>>,
) -> Option<Unknown> {
    if !has_digit(&aside.text) {
        return None;
    }
    let text = without_punctuation(&aside.text);
    let record = uncounted(records(&text, Separator::Blanks).ok()?.first()?);
    let cells: Vec<Cell> = without_foreign(&record.cells).cloned().collect();
    let is_cell = |cell: &Cell| cell.is_number() && !cell.text().starts_with("00");
    let is_row = width > 1 && record.cells.len() == width && record.cells.iter().all(is_cell);
    let found = named_values(&cells, aside.line)?;
    let found = if is_row { found.measured(true) } else { found };
    let is_name = found.title.is_empty() || names.is_none_or(|names| names.of_parts.may_have(&found.title));
    let is_above = names.is_some_and(|names| names.is_above);
    // B liegt 0,061 drüber
    let begins_with_part = names.is_some_and(|names| names.of_parts.begin(&found.title));
    let deviate = || !columns.is_empty() && columns.iter().all(|column| column.nominal == Nominal::None);
    let is_signed = |cell: &Cell| cell.text().trim_start().starts_with(['+', '-', '\u{2212}']);
    let is_alone = found.cells.iter().filter(|cell| cell.is_number()).count() == 1;
    // behind the name of a part or with a sign, a number may say by how much a value deviates
    let is_deviation = |cell: &Cell| {
        cell.is_measure()
            && (begins_with_part && (cell.is_fine() || deviate()) || is_signed(cell) && is_alone && names.is_some())
            && columns.iter().any(|column| column.may_hold(cell) || column.may_deviate_by(cell))
    };
    let is_value = |cell: &Cell| {
        let may_be_of =
            |column: &Column| is_name || (!is_above || cell.is_fine()) && matches!(column.nominal, Nominal::Fixed(_));
        cell.has_decimals() && columns.iter().any(|column| may_be_of(column) && column.may_hold(cell))
    };
    let may_be_value = |cell: &Cell| is_value(cell) || is_deviation(cell);
    let may_be = || !is_statistic(&found.title) && role(&found.title).is_none() && found.cells.iter().any(may_be_value);
    if found.could_be_measured() { Some(found) } else { may_be().then(|| found.measured(true)) }
}

/// Whether words stand behind the number of a cell: `419 neu 25,060`.
fn has_words(cell: &Cell) -> bool {
    cell.text().split_whitespace().count() > 2
}

/// What of a line is near a nominal value and beyond all values of the table, whatever the words before it say: `NOK: 25,060`.
/// Above the names, where titles are, it has three decimals.
fn value_beyond(aside: &AsideReading, measured: &MeasuredValues, is_above: bool) -> Option<Unknown> {
    let text = without_punctuation(&aside.text);
    let record = records(&text, Separator::Blanks).ok()?.into_iter().next()?;
    let at = record.cells.iter().position(|cell| measured.is_beyond_all(cell) && (!is_above || cell.is_fine()))?;
    let title = record.cells[..at].iter().map(Cell::text).collect::<Vec<_>>().join(" ");
    let found = Unknown::line(&title, aside.line, vec![record.cells[at].clone()]).measured(true);
    Some(Unknown { is_repeated: true, ..found })
}

/// A line among values behind their names that begins with the name of an error which has none: `Teilung Zahnstange: n.i.O.`
fn without_value(aside: &AsideReading, shape: &Shape, columns: &[Column]) -> Option<Unknown> {
    const MOST_WORDS: usize = 6;
    if shape.orientation == Orientation::Rows || shape.header_line.is_some() || columns.is_empty() {
        return None;
    }
    let words: Vec<&str> = aside.text.split_whitespace().collect();
    let name = (1..words.len().min(MOST_WORDS)).rev().map(|count| words[..count].join(" "));
    let is_missing = |name: &String| {
        let heading = heading(name, &[]).filter(|_| is_value_heading(name, &[]));
        heading.is_some_and(|heading| columns.iter().all(|column| !heading.fields.contains(&column.field)))
    };
    let name = name.into_iter().find(is_missing).filter(|_| words.len() <= MOST_WORDS)?;
    let behind = words[name.split(' ').count()..].join(" ");
    Some(Unknown::line(&name, aside.line, vec![Cell::of_text(&behind, 0..0)]).unread())
}

/// What a line says of all values, and nothing else does: by which factor they are written, and over which length they are
/// evaluated.
fn of_all_values(aside: &AsideReading, columns: &[Column]) -> Option<Unknown> {
    let unread = |title: &str| Unknown::line(title, aside.line, vec![Cell::of_text(&aside.text, 0..0)]).unread();
    if has_scale(&aside.text) {
        return Some(unread(&aside.text));
    }
    let words: Vec<&str> = aside.text.split([' ', ':', '=', '\u{a0}']).filter(|word| !word.is_empty()).collect();
    let names = (1..words.len()).map(|count| (words[..count].join(" "), words[count..].join(" ")));
    let (name, length) = names.into_iter().find(|(name, _)| is_evaluation_length(name))?;
    let is_other = |column: &Column| matches!(column.evaluated, Stated::Fixed(over) if length.parse() != Ok(over));
    columns.iter().any(is_other).then(|| unread(&name))
}

/// Whether a text has a word for a factor.
fn has_scale(text: &str) -> bool {
    text.split(|c: char| !c.is_alphanumeric()).any(is_scale)
}

/// A number in a line that names a part of the table: `P2: 95`, `Bemerkung: Teil 2 zeigte 95`. A part with a bare number for a
/// name has a word for parts before it.
fn of_part(aside: &AsideReading, shape: &Shape) -> Option<Unknown> {
    let words: Vec<&str> = aside.text.split(|c: char| c.is_whitespace() || ":;,=()".contains(c)).collect();
    let ids: HashSet<Cow<'_, str>> = shape.ids.iter().flat_map(|ids| &ids.cells).map(Cell::text).collect();
    let names_one = |at: &usize| {
        let before = at.checked_sub(1).map(|before| words[before]);
        let is_plain = words[*at].bytes().all(|byte| byte.is_ascii_digit());
        has_digit(words[*at]) && ids.contains(words[*at]) && (!is_plain || before.is_some_and(is_part_name))
    };
    let at = (0..words.len()).find(names_one)?;
    let is_value = |word: &&&str| Cell::of_text(word, 0..0).is_measure() && !ids.contains(**word);
    let value = words[at + 1..].iter().find(is_value)?;
    Some(Unknown::line(words[at], aside.line, vec![Cell::of_text(value, 0..0)]).measured(true))
}

/// A number alone in its line among values behind their names.
fn without_name(aside: &AsideReading, shape: &Shape) -> Option<Unknown> {
    let cell = Cell::of_text(aside.text.trim(), 0..0);
    let is_among_values = shape.orientation == Orientation::Columns && shape.header.is_empty();
    (is_among_values && cell.is_number()).then(|| Unknown::line("", aside.line, vec![cell]).measured(true))
}

/// A line of prose without what stands around its words and numbers: `A: 25,061.`, `(25,061 mm)`, `25,061/25,011`,
/// `部品Bは25.061でした。` A day keeps its dots.
fn without_punctuation(line: &str) -> String {
    let is_kept = |c: char| c.is_alphanumeric() || "+-\u{2212}°'′″%€$".contains(c);
    let is_day = |word: &str| word.ends_with('.') && word.split('.').all(|part| part.len() <= 2);
    let is_decimal = |word: &str| Cell::of_text(word, 0..0).has_decimals();
    // kana and ideographs have no blanks between them and numbers
    let is_unspaced = |c: char| c >= '\u{3000}';
    let mut spaced = String::new();
    for c in plain_widths(line).chars() {
        if spaced.chars().next_back().is_some_and(|last| is_unspaced(last) != is_unspaced(c)) {
            spaced.push(' ');
        }
        spaced.push(c);
    }
    let words = spaced.split(|c: char| c.is_whitespace() || matches!(c, '|' | ';')).filter(|word| !word.is_empty());
    // an arrow is no sign
    let words = words.filter(|word| *word == "+" || word.contains(char::is_alphanumeric));
    let words = words.map(|word| match word.split_once(['/', '-', '–', '…']) {
        Some((first, second)) if is_decimal(first) && is_decimal(second) => format!("{first} {second}"),
        _ if is_day(word) => word.to_owned(),
        _ => apart(word).trim_matches(|c| !is_kept(c)).to_owned(),
    });
    words.collect::<Vec<_>>().join(" ")
}

/// A word with a number of two decimals inside, which stands apart then: `P2=25,064`, `Ø25,064`, `25,064/25,012`.
fn apart(word: &str) -> String {
    let is_of_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',');
    let runs = word.split_inclusive(|c| !is_of_number(c)).map(|run| {
        let number = run.trim_end_matches(|c| !is_of_number(c));
        (number, &run[number.len()..])
    });
    let is_measure = |run: &str| Cell::of_text(run, 0..0).has_two_decimals();
    let runs =
        runs.map(|(run, behind)| if is_measure(run) { format!(" {run} {behind}") } else { format!("{run}{behind}") });
    let spaced: String = runs.collect();
    // a sign and a unit belong to it
    if Cell::of_text(word, 0..0).is_measure() {
        word.to_owned()
    } else {
        spaced.split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

/// Whether a text names a part, a space or a tooth, whose number stands behind it.
fn names_one(text: &str) -> bool {
    heading(text, &[]).is_some_and(|heading| heading.fields.iter().all(|field| field.is_index()))
}

/// Cells without numbers in units that are none of lengths or angles: `20,3 °C`.
fn without_foreign(cells: &[Cell]) -> impl Iterator<Item = &Cell> {
    let is_unit = |cell: &Cell| {
        let text = cell.text();
        let unit = text.trim_end_matches([',', ';', '.', ')']);
        is_foreign_unit(unit) && !matches!(unit, "-" | "1")
    };
    let is_other = move |at: usize| cells[at].is_number() && cells.get(at + 1).is_some_and(is_unit);
    (0..cells.len()).filter(move |at| !is_other(*at)).map(|at| &cells[at])
}

/// The first name in a line that is more than context, and the values behind it.
fn named_values(cells: &[Cell], line: u64) -> Option<Unknown> {
    let words = cells.iter().take_while(|cell| !cell.is_measure() && !has_digit(&cell.text())).count();
    // a time, a number in a list, or the value stands before the name
    if words == 0 {
        let (first, rest) = cells.split_first()?;
        let numbers = || Unknown::numbers(&first.text(), line, rest).filter(|_| !near(&first.text()).is_empty());
        if let Some(found) = numbers() {
            return Some(found.measured(true));
        }
        let alone = || Unknown::numbers("", line, std::slice::from_ref(first));
        return named_values(rest, line).map_or_else(alone, |mut found| {
            found.cells.push(first.clone());
            Some(found)
        });
    }
    let (label, values) = cells.split_at(words);
    let text = label.iter().map(Cell::text).collect::<Vec<_>>().join(" ");
    // a known name counts, whatever stands in place of its number: `rack pitch 12...15 µm`
    let is_known = !near(&text).is_empty() || role(&text) == Some(Role::Nominal);
    // an order, a page, a date, a space: the word before the number says what it is
    let is_named = is_known && values.first().is_some_and(Cell::has_decimals);
    if !is_named && (is_context(text.split_whitespace().next_back()?) || names_one(&text)) {
        let rest = values.get(1..)?;
        // Part 2: 25.2 mm
        let is_value = rest.first().is_some_and(Cell::is_measure);
        let of_part = || Unknown::numbers("", line, rest).filter(|_| names_one(&text));
        return named_values(rest, line).or_else(of_part).map(|found| found.measured(is_value && names_one(&text)));
    }
    // Pos. 5 Rack pich 0.21
    let behind = (!is_known).then(|| named_values(values.get(1..)?, line)).flatten();
    if let Some(behind) = behind.filter(|behind| !near(&behind.title).is_empty()) {
        return Some(behind);
    }
    let unread = || {
        let whole = values.iter().map(Cell::text).collect::<Vec<_>>().join(" ");
        Unknown::line(&text, line, vec![Cell::of_text(&whole, 0..0)])
    };
    let numbers = Unknown::numbers(&text, line, values);
    numbers.or_else(|| is_known.then(unread)).map(|unknown| unknown.measured(is_known))
}

fn stranger(file: &str, unknown: &Unknown) -> Stranger {
    const VALUES: usize = 3;
    let (_, unit) = split_unit(&unknown.title);
    let unit = unit.or_else(|| unknown.unit.clone());
    let values = unknown.cells.iter().filter(|cell| !cell.is_missing()).take(VALUES).map(|cell| shown(&cell.text()));
    let mut names: Vec<_> = near(&unknown.title).into_iter().map(Field::key).collect();
    names.dedup();
    Stranger {
        file: file.to_owned(),
        place: unknown.place.clone(),
        title: unknown.title.clone(),
        values: values.collect(),
        unit,
        near: names,
        pattern: unknown.pattern(),
    }
}

/// The refusal of tables with columns that are not understood, all of them at once; `None` if there are none.
/// `to_be_named` are the errors whose columns the spec has to name before `others = "ignore"` leaves these out.
#[must_use]
pub fn refusal(strangers: &[Stranger], to_be_named: &[DeviationKind]) -> Option<Diagnostic> {
    const SHOWN: usize = 20;
    strangers.first()?;
    let listed = strangers.iter().take(SHOWN).map(|stranger| {
        let near =
            if stranger.near.is_empty() { String::new() } else { format!("; near {}", stranger.near.join(", ")) };
        let title = Some(&stranger.title).filter(|title| !title.is_empty());
        let title = title.map_or_else(String::new, |title| format!("`{}`: ", shown(title)));
        format!("\n  {}, {}: {title}{}{near}", stranger.file, stranger.place, stranger.values.join(", "))
    });
    let more = strangers.len().saturating_sub(SHOWN);
    let more = if more == 0 { String::new() } else { format!("\n  and {more} more") };
    let message = format!(
        "not understood, so nothing is judged: {}{}{more}",
        if strangers.len() == 1 {
            "a column or line that may be a measurement".to_owned()
        } else {
            format!("{} columns or lines that may be measurements", strangers.len())
        },
        listed.collect::<String>()
    );
    let mut patterns: Vec<&str> = strangers.iter().map(|stranger| stranger.pattern.as_str()).collect();
    patterns.dedup();
    patterns.truncate(SHOWN);
    let mut mappings: Vec<String> = strangers.iter().filter_map(Stranger::mapping).collect();
    // a key stands in a spec once
    let mut keys = HashSet::new();
    mappings.retain(|mapping| mapping.starts_with(KEY) || keys.insert(mapping.split(' ').next().map(str::to_owned)));
    mappings.dedup();
    mappings.truncate(SHOWN);
    let ignored =
        patterns.iter().map(|pattern| format!("--ignore {}", shell_quoted(pattern))).collect::<Vec<_>>().join(" ");
    let quoted = patterns.iter().map(|pattern| quoted(pattern)).collect::<Vec<_>>().join(", ");
    let said = format!("[batch] ignore = [{quoted}], or on the command line {ignored}");
    let mut help = if strangers.iter().all(|stranger| stranger.place.ends_with(UNCERTAINTY)) {
        format!("uncertainties stand in the spec, as u beside each of [errors]; leave them out of the table: {ignored}")
    } else if strangers.iter().all(|stranger| stranger.pattern.starts_with(SHEET)) {
        format!("name the sheet that is meant with --sheet; or leave the other out: {said}")
    } else if mappings.is_empty() && strangers.iter().any(|stranger| stranger.title.is_empty()) {
        format!("give it a name, or leave it out: {said}")
    } else if mappings.is_empty() {
        format!("leave it out, if it is none of the spec's errors: {said}")
    } else {
        format!("say in the spec what it is, under [batch.columns]: {}; or leave it out: {said}", mappings.join("; "))
    };
    if mappings.iter().any(|mapping| mapping.starts_with(KEY)) {
        help += &format!("; {KEY} is one of {}", DeviationKind::ALL.map(DeviationKind::key).join(", "));
    }
    if !to_be_named.is_empty() {
        let keys = DeviationKind::ALL.into_iter().filter(|kind| to_be_named.contains(kind)).map(DeviationKind::key);
        let keys = keys.collect::<Vec<_>>().join(", ");
        help += &format!("; others = \"ignore\" leaves it out once [batch.columns] names the column of {keys}");
    }
    Some(Diagnostic::error(Code::NotUnderstood, message).help(help))
}

/// Stands before the name of a sheet in the pattern that leaves it out.
pub(crate) const SHEET: &str = "sheet ";

/// Stands in a remedy for the error that a column may be.
const KEY: &str = "KEY";

impl Stranger {
    /// The line of the spec that says what it is, if that is the nearest name; `None` for what the spec cannot name.
    fn mapping(&self) -> Option<String> {
        let name = Some(split_unit(&self.title).0.trim().to_owned()).filter(|name| *name == self.pattern)?;
        // nothing tells which error it is, if it is one
        let kind = self.near.iter().find_map(|key| key.parse::<Field>().ok()?.kind());
        // form, crowning and runout are no error that a spec has, and only a pitch has a total
        let is_pitch = matches!(kind, Some(DeviationKind::RackPitch | DeviationKind::PinionPitch));
        let is_lead = matches!(kind, Some(DeviationKind::RackLead | DeviationKind::PinionLead));
        if (kind.is_none() || is_lead) && is_other_of_flank(&name) || kind.is_some() && !is_pitch && is_total(&name) {
            return None;
        }
        let unit = self.unit.as_ref().map_or_else(String::new, |unit| format!(", unit = {}", quoted(unit)));
        let has_nominal = matches!(kind, Some(DeviationKind::RackOverRoller | DeviationKind::PinionRadial));
        let holds = if has_nominal && says_deviation(&name) { ", kind = \"deviation\"" } else { "" };
        let extent = if kind.is_some() && is_total(&name) { ", extent = \"total\"" } else { "" };
        let key = kind.map_or(KEY, DeviationKind::key);
        Some(format!("{key} = {{ name = {}{unit}{holds}{extent} }}", quoted(&name)))
    }
}

pub(super) fn shell_quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "'\\''"))
}
