//! Columns, lines and characteristics that name nothing known: which of them are no measurement, and which could be one, so
//! that nothing is judged before somebody says what they are. Called once per table.

mod sheet;

use std::collections::HashSet;

use serde::Serialize;

use super::cell::Cell;
use super::column::{Column, Nominal};
use super::grid::unit_in;
use super::lines::{
    Beside, NamedSize, has_scale, is_signed, named_sizes, of_all_values, of_other_part, of_part, repeats_nominal,
    says_value_alone, size_read_with, statistics, value_beyond, without_name, without_punctuation, without_value,
};
use super::measured::MeasuredValues;
use super::names::{
    Field, Role, WordList, heading, is_again, is_apart, is_called, is_called_spread, is_context, is_other_of_flank,
    is_statistic, is_total, near, part_in_title, part_said, role, split_unit,
};
use super::reading::{AsideReading, NotUsed};
use super::rejection::rejection;
use super::shape::{Measurement, PartNames, Shape, is_part_name, is_spread};
use super::understand::Understood;
use super::unknown::{UNCERTAINTY, Unknown};
use super::want::{Orientation, Want, ignore_option, mapping, quoted};
use crate::deviation::plausible::Reach;
use crate::deviation::{DeviationKind, DeviationValue, Part};
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::{Length, QuantityError, Unit, shown};
pub(crate) use sheet::{listed_statistics, of_sheet};

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
    /// Whether it stands in a line that is no part of the table, which no spec can name.
    #[serde(skip)]
    pub(crate) is_prose: bool,
    /// A column that is an error already that this may be, and the errors that have one.
    #[serde(skip)]
    pub(crate) beside: Option<String>,
    #[serde(skip)]
    pub(crate) taken: Vec<&'static str>,
}

/// What became of what is not understood.
#[derive(Debug, Default)]
pub(crate) struct Sorted {
    pub(crate) strangers: Vec<Stranger>,
    pub(crate) not_used: Vec<NotUsed>,
    pub(crate) asides: Vec<AsideReading>,
    /// The errors whose columns the spec has to name before `others = "ignore"` leaves the strangers out.
    pub(crate) to_be_named: Vec<DeviationKind>,
    /// What columns say against values that count.
    pub(crate) notes: Vec<String>,
}

/// What `others = "ignore"` leaves out: once every error of the spec is found, what cannot be one of those whose column only its
/// name tells.
#[derive(Debug, Clone, Default)]
pub(crate) struct Others {
    is_asked: bool,
    /// The errors of the spec of which there is no column.
    missing: Vec<DeviationKind>,
    /// The errors of columns that neither the spec names nor their key.
    unnamed: Vec<DeviationKind>,
}

impl Others {
    /// Of a table with these columns.
    pub(crate) fn of(columns: &[Column], want: &Want) -> Self {
        let column = |kind: &DeviationKind| columns.iter().find(|column| column.kind == Some(*kind));
        let is_named =
            |column: &Column, kind: DeviationKind| want.is_own(&column.title) || is_called(&column.title, kind.key());
        let unnamed = |column: &Column| column.kind.filter(|kind| !is_named(column, *kind));
        Self {
            is_asked: want.others_ignored && !want.expected.is_empty(),
            missing: want.expected.iter().copied().filter(|kind| column(kind).is_none()).collect(),
            unnamed: columns.iter().filter_map(unnamed).collect(),
        }
    }

    /// Whether something is left out.
    pub(crate) fn leaves_out(&self, unknown: &Unknown) -> bool {
        self.in_the_way(unknown).is_some_and(|errors| errors.is_empty())
    }

    /// The errors that something may be, and that the spec has to name before it is left out; `None` where it never is.
    fn in_the_way(&self, unknown: &Unknown) -> Option<Vec<DeviationKind>> {
        let near: Vec<_> = near(&unknown.title).into_iter().filter_map(Field::kind).collect();
        let is_again = unknown.is_repeated || is_again(&unknown.title);
        let may_be = |kind: &DeviationKind| is_again || near.contains(kind);
        let unnamed = self.unnamed.iter().copied().filter(may_be);
        self.is_asked.then(|| self.missing.iter().copied().chain(unnamed).collect())
    }
}

/// Sorts what a table, or another sheet of its workbook, has besides the measurements that are understood.
pub(crate) fn sort(file: &str, shape: &Shape, understood: &Understood, want: &Want, others: &Others) -> Sorted {
    if shape.unknown.is_empty() && shape.asides.is_empty() {
        return Sorted::default();
    }
    let (names, measured) = (understood.shape.part_names(), MeasuredValues::of(understood));
    let (columns, width) = (understood.columns.as_slice(), shape.header.len());
    let beside = Beside { columns, width, of_parts: Some(&names), measured: Some(&measured) };
    let sorted = Sorted::default();
    let mut sorter = Sorter { file, shape, names: &names, measured: &measured, beside, want, others, sorted };
    shape.unknown.iter().for_each(|unknown| sorter.take_unknown(unknown));
    shape.asides.iter().for_each(|aside| sorter.take_line(aside));
    shape.unknown.iter().for_each(|unknown| sorter.take_remark(unknown));
    let kept = shape.unknown.iter().filter(|unknown| !unknown.is_ignored(want));
    for unknown in kept {
        let rejection = rejection(&unknown.pattern(), &unknown.cells, unknown.are_verdicts());
        sorter.sorted.notes.extend(rejection.map(|rejection| rejection.in_words(file)));
        let named = |size| NamedSize { name: unknown.title.clone(), size };
        let said: Vec<_> = sizes(unknown).flatten().map(named).collect();
        sorter.sorted.notes.extend(other_module(file, &said, want));
        // Temp [°C]
        let lines = shape.lines.iter().zip(&unknown.cells).filter(|_| unknown.title.contains("°C"));
        let name = unknown.title.split(['[', '(']).next().unwrap_or_default().trim();
        let mut lines =
            lines.map(|(line, cell)| AsideReading { line: *line, text: format!("{name} {} °C", cell.text()) });
        sorter.sorted.notes.extend(lines.find_map(|line| other_temperature(file, &line, columns)));
    }
    sorter.sorted
}

/// A table of which the columns and lines beside the measurements are sorted.
struct Sorter<'a> {
    file: &'a str,
    shape: &'a Shape,
    names: &'a PartNames,
    measured: &'a MeasuredValues,
    beside: Beside<'a>,
    want: &'a Want,
    others: &'a Others,
    sorted: Sorted,
}

impl Sorter<'_> {
    fn take(&mut self, unknown: &Unknown) {
        let before = self.sorted.strangers.len();
        // beside a row for each part, a line is no other feature
        let is_feature = unknown.column.is_some() || self.shape.orientation == Orientation::Columns;
        let none = Others::default();
        self.sorted.take(self.file, unknown, self.want, if is_feature { self.others } else { &none });
        self.sorted.strangers[before..].iter_mut().for_each(|stranger| stranger.hold_against(self.beside.columns));
    }

    /// A column, or a line with a name and numbers.
    fn take_unknown(&mut self, unknown: &Unknown) {
        let title = &unknown.title;
        if self.is_other_size(unknown) {
            return self.take(&unknown.clone().unread());
        }
        if self.adds_up(unknown) {
            return self
                .sorted
                .not_used
                .push(NotUsed { title: title.clone(), why: "adds up what is measured of each tooth" });
        }
        if let Some(value) = self.value_in_heading(unknown) {
            self.take(&value);
        }
        let is_repeated = self.measured.are_repeated_by(unknown)
            || self.want.names_once_more(title)
            || unknown.cells.iter().any(|cell| self.is_one_more(title, cell));
        let is_measurement = unknown.is_measurement || is_repeated;
        if self.is_title(unknown) || self.is_described(unknown) || !is_measurement && self.is_range(unknown) {
            self.sorted.not_used.push(NotUsed { title: title.clone(), why: "no measurement" });
        } else {
            let cells = unknown.cells.iter().filter(|_| unknown.column.is_none()).map(Cell::text);
            let words = cells.fold(title.clone(), |words, cell| format!("{words} {cell}"));
            let is_value = || unknown.column.is_none() && says_value_alone(&words, self.beside.columns);
            let is_unread = unknown.is_unread || has_scale(&words) || is_value();
            self.take(&Unknown { is_measurement, is_repeated, is_unread, ..unknown.clone() });
        }
    }

    /// Whether a column adds up the deviations of a pitch from tooth to tooth, as F_p does, from 0 or from the first of them.
    fn adds_up(&self, unknown: &Unknown) -> bool {
        /// Of three numbers, each is rounded.
        const ROUNDING: f64 = 1.51;
        let unit = split_unit(&unknown.title).1.or_else(|| unknown.unit.clone());
        let unit = unit.and_then(|symbol| Unit::from_symbol(&symbol));
        let part = |row: usize| self.shape.ids.as_ref().map(|ids| ids.cells[row].text());
        let adds_up = |(measurement, column): (&Measurement, &Column)| {
            let value = |cell: &Cell| column.quantity(cell).map_or(f64::NAN, DeviationValue::base);
            let (single, total) =
                (|row: usize| value(&measurement.value.cells[row]), |row: usize| value(&unknown.cells[row]));
            let is_near = |row: usize, sum: f64| {
                let digit = column.digit(&unknown.cells[row], column.unit);
                (total(row) - sum).abs() <= ROUNDING * digit
            };
            let is_first = |row: usize| row == 0 || part(row - 1) != part(row);
            // the sum ends with a tooth, or begins with it
            [0, 1].iter().any(|before| {
                (0..unknown.cells.len()).all(|row| {
                    if is_first(row) {
                        return is_near(row, 0.0) || *before == 0 && is_near(row, single(row));
                    }
                    is_near(row, total(row - 1) + single(row - before))
                })
            })
        };
        let is_pitch = |field: Field| matches!(field, Field::LeftPitch | Field::RightPitch);
        let mut measurements = self.shape.measurements.iter().zip(self.beside.columns);
        unknown.column.is_some()
            && self.shape.orientation == Orientation::Rows
            && unknown.cells.len() > 2
            && is_total(&unknown.title)
            && !near(&unknown.title).is_empty()
            && measurements.any(|found| is_pitch(found.0.field) && unit == Some(found.1.unit) && adds_up(found))
    }

    /// Whether it is another size than that with which values are read.
    fn is_other_size(&self, unknown: &Unknown) -> bool {
        size_read_with(&split_unit(&unknown.title).0, self.beside.columns, self.want)
            .is_some_and(|read_with| sizes(unknown).any(|size| size != Ok(read_with)))
    }

    /// Whether it is a number above the names that no column can hold, or a whole one behind a word that is no part's name.
    fn is_title(&self, unknown: &Unknown) -> bool {
        let is_name = self.names.may_have(&unknown.title) || Cell::of_text(&unknown.title, 0..0).is_number();
        let is_value = |cell: &Cell| {
            (is_name || cell.has_decimals()) && self.beside.columns.iter().any(|column| column.may_hold(cell))
        };
        unknown.column.is_none()
            && !has_scale(&unknown.title)
            && self.shape.orientation == Orientation::Rows
            && !self.beside.columns.is_empty()
            && !self.shape.header.is_empty()
            && !unknown.clone().measured(false).could_be_measured()
            && !unknown.cells.iter().any(is_value)
    }

    /// Whether it says something of the values: a tolerance, a probe, a statistic.
    fn is_described(&self, unknown: &Unknown) -> bool {
        let behind = unknown.cells.iter().map(Cell::text).collect::<Vec<_>>().join(" ");
        self.measured.are_described_by(unknown, &behind)
    }

    /// Whether it is a column of ranges beside one of means.
    fn is_range(&self, unknown: &Unknown) -> bool {
        unknown.column.is_some() && is_spread(&unknown.title) && self.shape.has_column_of_means()
    }

    /// Whether a number below or behind a title may be one more of the values.
    fn is_one_more(&self, title: &str, cell: &Cell) -> bool {
        let is_said = is_statistic(title) || role(title).is_some_and(Role::is_beside_value);
        (!is_said || is_apart(title)) && self.measured.may_have(cell)
            || WordList::Mean.has(title) && self.measured.is_beyond_all(cell)
            || is_called_spread(title) && self.measured.are_narrower_than(cell)
    }

    /// A value in the heading of a column.
    fn value_in_heading(&self, unknown: &Unknown) -> Option<Unknown> {
        let heading = AsideReading { line: 0, text: unknown.title.clone() };
        let value = value_beyond(&heading, self.measured).filter(|_| unknown.column.is_some())?;
        Some(Unknown { place: unknown.place.clone(), is_repeated: true, ..value })
    }

    /// A line that is no part of the table.
    fn take_line(&mut self, aside: &AsideReading) {
        // above the names stand titles; only what has the name of a part there is a row
        let is_above = Some(aside.line) < self.shape.header_line;
        // `Mittelwert` below the rows is a row that nobody filled
        let is_below = self.shape.orientation == Orientation::Rows && Some(&aside.line) > self.shape.lines.last();
        let is_empty_statistic = is_below && is_statistic(&aside.text);
        let found = self
            .beside
            .value_in(aside, is_above)
            .map(|unknown| Unknown { is_repeated: true, ..unknown })
            .or_else(|| without_value(aside, self.shape, self.beside.columns))
            .or_else(|| without_name(aside, self.shape))
            .or_else(|| of_part(aside, self.shape))
            .or_else(|| of_other_part(aside, self.shape))
            .or_else(|| of_all_values(aside, self.beside.columns, self.want).filter(|_| !is_empty_statistic));
        let is_described = |unknown: &Unknown| {
            let text = without_punctuation(&aside.text);
            let several = statistics(&text, aside.line);
            text.strip_prefix(&unknown.title).is_some_and(|behind| self.measured.are_described_by(unknown, behind))
                || several.len() > 1 && several.iter().all(|one| !one.cells.is_empty() && self.is_described(one))
        };
        match found {
            Some(unknown)
                if !repeats_nominal(&unknown, aside, self.beside.columns)
                    && !is_described(&unknown)
                    && !is_helix_angle(&unknown, self.want) =>
            {
                let before = self.sorted.strangers.len();
                self.take(&unknown);
                for stranger in &mut self.sorted.strangers[before..] {
                    stranger.is_prose = self.shape.orientation == Orientation::Rows;
                }
            }
            _ => {
                let place = format!("line {}", aside.line);
                let said: Vec<_> = named_sizes(&aside.text).collect();
                let rejection = rejection(&place, [&Cell::of_text(&aside.text, 0..0)], false);
                self.sorted.notes.extend(rejection.map(|rejection| rejection.in_words(self.file)));
                self.sorted.notes.extend(other_module(self.file, &said, self.want));
                self.sorted.notes.extend(other_temperature(self.file, aside, self.beside.columns));
                self.sorted.asides.push(aside.clone());
            }
        }
    }

    /// A column of remarks, of which the first that holds a value counts.
    fn take_remark(&mut self, unknown: &Unknown) {
        let is_limit = matches!(role(&unknown.title), Some(Role::Upper | Role::Lower));
        let is_other = is_part_name(&unknown.title) || unknown.could_be_measured();
        if unknown.column.is_none() || self.want.ignores(&unknown.title) || is_other {
            return;
        }
        let shape = self.shape;
        let line = |row: usize| shape.lines.get(row).or(shape.header_line.as_ref()).copied().unwrap_or_default();
        let has_words = unknown.cells.iter().any(|cell| !cell.is_measure() && !cell.is_missing());
        let is_signed = |cell: &Cell| is_signed(cell) && !is_limit && (has_words || !is_context(&unknown.title));
        let mut cells = unknown.cells.iter().enumerate().filter(|(_, cell)| !cell.is_measure() || is_signed(cell));
        let value = cells.find_map(|(row, cell)| self.beside.value_in_remark(cell, &unknown.place, line(row)));
        if let Some(value) = value {
            self.take(&value);
        }
    }
}

impl Sorted {
    /// Titles that say that the teeth or spaces of a table are those of the other part.
    pub(crate) fn take_titles_of_other(&mut self, file: &str, part: Part, want: &Want, others: &Others) {
        let is_other = |aside: &AsideReading| part_in_title(&aside.text).is_some_and(|said| said != part);
        for title in self.asides.extract_if(.., |aside| is_other(aside)).collect::<Vec<_>>() {
            let cell = Cell::of_text(&title.text, 0..0);
            self.take(file, &Unknown::line(&title.text, title.line, vec![cell]).unread(), want, others);
        }
    }

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
        } else if role(title) == Some(Role::Uncertainty) && !unknown.has_signs() {
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

/// Whether a line says how a gear is made: the helix angle, which is far from any deviation of it, where none is measured.
fn is_helix_angle(line: &Unknown, want: &Want) -> bool {
    let is_lead = heading(&line.title, &[])
        .is_some_and(|heading| heading.fields == [Field::Error(DeviationKind::RackLead)] && heading.holds.is_none());
    let has_nominal = want.given(DeviationKind::RackLead).is_some_and(|given| given.nominal.is_some());
    let usual = Reach::usual(want.module);
    let is_angle = |cell: &Cell| {
        let text = cell.text().replace(',', ".");
        let angle = text.parse().or_else(|_| format!("{text} deg").parse());
        angle.is_ok_and(|angle| usual.is_exceeded_by(DeviationValue::Angle(angle)))
    };
    is_lead && !has_nominal && line.cells.iter().all(is_angle)
}

/// The sizes in a column or line.
fn sizes(unknown: &Unknown) -> impl Iterator<Item = Result<Length, QuantityError>> {
    let unit = split_unit(&unknown.title).1.or_else(|| unknown.unit.clone()).unwrap_or_default();
    unknown.cells.iter().filter(|cell| cell.is_number()).map(move |cell| {
        let size = cell.text().replace(',', ".");
        if unit_in(&size).is_some() { size } else { format!("{size} {unit}") }.trim().parse()
    })
}

/// What tells that parts may be of another pair: a normal module that is not the spec's.
fn other_module(file: &str, said: &[NamedSize], want: &Want) -> Option<String> {
    let ours = want.module?;
    let is_other = |said: &&NamedSize| WordList::NormalModule.has(&said.name) && said.size != ours;
    let NamedSize { name, size } = said.iter().find(is_other)?;
    Some(format!("{file}: `{name}` is {size}, and {ours} in the spec: these may be other parts"))
}

/// What tells that sizes have grown: a temperature of parts or the room that is not that at which sizes are meant.
fn other_temperature(file: &str, line: &AsideReading, columns: &[Column]) -> Option<String> {
    const KELVIN_APART: f64 = 2.0;
    let before = line.text.split_once("°C")?.0.trim();
    let (words, number) = before.split_at(before.rfind([' ', ':', '=']).map_or(0, |at| at + 1));
    let celsius: f64 = number.replace(',', ".").parse().ok()?;
    let is_of_parts = is_context(words) || role(words) == Some(Role::Measured) || WordList::At.has(words.trim());
    let has_sizes = columns.iter().any(|column| column.nominal != Nominal::None);
    (is_of_parts && has_sizes && (celsius - 20.0).abs() > KELVIN_APART)
        .then(|| format!("{file}: line {} says {celsius} °C, and sizes are taken as those at 20 °C", line.line))
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
        is_prose: false,
        beside: None,
        taken: Vec::new(),
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
        format!("{}, {}: {title}{}{near}", stranger.file, stranger.place, stranger.values.join(", "))
    });
    let more = strangers.len().saturating_sub(SHOWN);
    let more = (more > 0).then(|| format!("and {more} more"));
    let message = format!(
        "not understood, so nothing is judged: {}",
        if strangers.len() == 1 {
            "a column or line that may be a measurement".to_owned()
        } else {
            format!("{} columns or lines that may be measurements", strangers.len())
        }
    );
    let list = listed.chain(more).collect();
    let mut patterns: Vec<&str> = strangers.iter().map(|stranger| stranger.pattern.as_str()).collect();
    patterns.dedup();
    patterns.truncate(SHOWN);
    let mut mappings: Vec<String> = strangers.iter().filter_map(Stranger::mapping).collect();
    // a key stands in a spec once
    let mut keys = HashSet::new();
    mappings.retain(|mapping| mapping.starts_with(KEY) || keys.insert(mapping.split(' ').next().map(str::to_owned)));
    mappings.dedup();
    mappings.truncate(SHOWN);
    let ignored = patterns.iter().map(|pattern| ignore_option(pattern)).collect::<Vec<_>>().join(" ");
    let quoted = patterns.iter().map(|pattern| quoted(pattern)).collect::<Vec<_>>().join(", ");
    let said = format!("[batch] ignore = [{quoted}], or on the command line {ignored}");
    let mut help = if strangers.iter().all(|stranger| stranger.place.ends_with(UNCERTAINTY)) {
        format!("uncertainties stand in the spec, as u beside each of [errors]; leave them out of the table: {ignored}")
    } else if strangers.iter().all(|stranger| stranger.pattern.starts_with(SHEET)) {
        format!("name the sheet that is meant with --sheet; or leave the other out: {said}")
    } else if mappings.is_empty() && strangers.iter().any(|stranger| stranger.title.is_empty()) {
        format!("give it a name, or leave it out: {said}")
    } else if let (true, Some(column)) =
        (mappings.is_empty(), strangers.iter().find_map(|stranger| stranger.beside.as_ref()))
    {
        format!(
            "one value of each part counts, as now that of `{}`; leave out what does not count: {said}",
            shown(column)
        )
    } else if mappings.is_empty() {
        format!("leave it out, if it is none of the spec's errors: {said}")
    } else {
        let lines = mappings.join("; ");
        let keys = keys_of(&mappings);
        format!("say in the spec what it is, under [batch.columns]: {lines}; or leave it out: {said}{keys}")
    };
    if !to_be_named.is_empty() {
        let keys = DeviationKind::ALL.into_iter().filter(|kind| to_be_named.contains(kind)).map(DeviationKind::key);
        let keys = keys.collect::<Vec<_>>().join(", ");
        help += &format!("; others = \"ignore\" leaves it out once [batch.columns] names the column of {keys}");
    }
    Some(Diagnostic { list, ..Diagnostic::error(Code::NotUnderstood, message).help(help) })
}

/// What stands for the key in lines of a spec, if one has none.
fn keys_of(mappings: &[String]) -> String {
    let is_open = mappings.iter().any(|mapping| mapping.starts_with(KEY));
    let keys = || format!("; {KEY} is one of {}", DeviationKind::ALL.map(DeviationKind::key).join(", "));
    if is_open { keys() } else { String::new() }
}

/// Stands before the name of a sheet in the pattern that leaves it out.
pub(crate) const SHEET: &str = "sheet ";

/// Stands in a remedy for the error that a column may be.
const KEY: &str = "KEY";

impl Stranger {
    /// Tells of which errors near it the table has a column. Beside columns of a pinion alone, its name is of the pinion.
    fn hold_against(&mut self, columns: &[Column]) {
        let kinds: Vec<DeviationKind> = columns.iter().filter_map(|column| column.kind).collect();
        if part_said(&self.title).is_none() && kinds.iter().all(|kind| kind.part() == Part::Pinion) && !kinds.is_empty()
        {
            let of_pinion = [("rack_pitch", "pinion_pitch"), ("rack_lead", "pinion_lead")];
            let of_part = |key: &mut &'static str| {
                *key = of_pinion.iter().find(|(rack, _)| rack == key).map_or(*key, |(_, pinion)| *pinion);
            };
            self.near.iter_mut().for_each(of_part);
            self.near.dedup();
        }
        let column = |key: &&&str| columns.iter().find(|column| column.kind.is_some_and(|kind| kind.key() == **key));
        self.beside = self.near.iter().find_map(|key| column(&key)).map(|column| column.title.clone());
        self.taken = self.near.iter().filter(|key| column(key).is_some()).copied().collect();
    }

    /// The line of the spec that says what it is, if that is the nearest name; `None` for what the spec cannot name.
    fn mapping(&self) -> Option<String> {
        let is_free = |key: &&&str| !self.taken.contains(*key);
        let is_left = self.taken.is_empty() || self.near.iter().any(|key| is_free(&key)) && !is_total(&self.title);
        let is_number = |name: &str| Cell::of_text(name, 0..0).is_number();
        let is_name = |name: &String| *name == self.pattern && !self.is_prose && !is_number(name) && is_left;
        let name = Some(split_unit(&self.title).0.trim().to_owned()).filter(is_name)?;
        // nothing tells which error it is, if it is one
        let kind = self.near.iter().filter(is_free).find_map(|key| key.parse::<Field>().ok()?.kind());
        // form, crowning and runout are no error that a spec has, and only a pitch has a total
        let is_pitch = matches!(kind, Some(DeviationKind::RackPitch | DeviationKind::PinionPitch));
        let is_lead = matches!(kind, Some(DeviationKind::RackLead | DeviationKind::PinionLead));
        if (kind.is_none() || is_lead) && is_other_of_flank(&name) || kind.is_some() && !is_pitch && is_total(&name) {
            return None;
        }
        Some(mapping(kind.map_or(KEY, DeviationKind::key), kind, &name, self.unit.as_deref()))
    }
}
