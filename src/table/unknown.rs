//! Columns and lines that name nothing known, and whether one could be a measurement. Found by the shape of a table;
//! decides nothing.

use std::borrow::Cow;

use super::cell::Cell;
use super::grid::{is_clock, is_date, is_unit, only_units, unit_in};
use super::names::{
    WordList, is_again, is_context, is_gear_size, is_statistic, near, part_said, repeats_value, split_unit,
};
use super::rejection::is_of_validity;
use super::shape::{distinct, is_part_name};
use super::want::Want;
use crate::quantity::Unit;

/// Stands behind the place of what says how uncertain values are.
pub(crate) const UNCERTAINTY: &str = ", an uncertainty";

/// A column or line that names nothing known.
#[derive(Debug, Clone, Default)]
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
    /// Whether its numbers are like those of a known column.
    pub(crate) is_repeated: bool,
    /// Whether it has a known name, and what stands behind it is no number.
    pub(crate) is_unread: bool,
}

impl Unknown {
    pub(crate) fn column(title: &str, column: usize, cells: Vec<Cell>) -> Self {
        Self { column: Some(column), ..Self::at(format!("column {}", column + 1), title, cells) }
    }

    /// A line with a name in front of its cells.
    pub(crate) fn line(title: &str, line: u64, cells: Vec<Cell>) -> Self {
        Self::at(format!("line {line}"), title, cells)
    }

    fn at(place: String, title: &str, cells: Vec<Cell>) -> Self {
        Self { place, title: title.to_owned(), cells, ..Self::default() }
    }

    /// The numbers among the cells of a line; `None` without any.
    pub(crate) fn numbers(title: &str, line: u64, cells: &[Cell]) -> Option<Self> {
        let numbers: Vec<_> = cells.iter().filter(|cell| cell.is_number()).cloned().collect();
        (!numbers.is_empty()).then(|| Self::line(title, line, numbers))
    }

    /// As something that says how uncertain values are, and is taken for a measurement.
    pub(crate) fn uncertainty(self) -> Self {
        let place = self.place.trim_end_matches(UNCERTAINTY).to_owned() + UNCERTAINTY;
        Self { place, is_measurement: true, ..self }
    }

    /// As a measurement of which nobody can read the value.
    pub(crate) fn unread(self) -> Self {
        Self { is_unread: true, ..self }
    }

    pub(crate) fn measured(self, is_measurement: bool) -> Self {
        Self { is_measurement, ..self }
    }

    /// What the user may call it: its name without a unit, or its place if it has none.
    pub(crate) fn pattern(&self) -> String {
        let (name, _) = split_unit(&self.title);
        // `*` stands for every name
        Some(name.trim()).filter(|name| !name.trim_matches('*').is_empty()).unwrap_or(&self.place).to_owned()
    }

    /// Whether the user leaves it out.
    pub(crate) fn is_ignored(&self, want: &Want) -> bool {
        want.ignores(&self.title) || want.ignores(&self.pattern())
    }

    /// The first of its cells, if it is a column of nothing but units of length or angle.
    pub(crate) fn units(&self) -> Option<&Cell> {
        let are_initials = || {
            WordList::Person.has(&self.title)
                && !self.cells.iter().any(|cell| cell.text().contains(|c: char| !c.is_ascii_uppercase()))
        };
        self.column.and_then(|_| only_units(&self.cells)).filter(|_| !are_initials())
    }

    /// Whether it holds numbers, and its name or unit is that of a measurement; or units of which nothing tells what they are of.
    pub(crate) fn could_be_measured(&self) -> bool {
        if self.units().is_some() || self.is_unread || self.has_signs() {
            return true;
        }
        let values: Vec<_> = self.cells.iter().filter(|cell| self.is_value(cell)).map(Cell::text).collect();
        // gemessen um 14:22 Uhr
        let is_time = self.column.is_none() && values.iter().all(|text| is_clock(text));
        let title = self.title.strip_suffix(" um").filter(|_| is_time).unwrap_or(&self.title);
        let unit = split_unit(title).1.or_else(|| self.unit.clone());
        let unit = unit.as_deref();
        // the evaluation length of a lead that was not measured says nothing
        let is_of_gear = is_gear_size(title)
            && !(self.is_repeated && distinct(self.cells.iter()) > 1)
            && !(WordList::ToothCount.is_in(title) && unit.is_some_and(is_unit));
        let is_other = is_of_gear
            || WordList::EvaluationLength.has(title)
            || unit.is_some_and(is_foreign_unit)
            || is_rate(&title.replacen("_min", "/min", 1)) && near(title).is_empty()
            // of a torque, newton metres
            || unit == Some("nm") && is_context(title);
        // without values, nothing was measured
        if is_other || values.iter().all(|text| unit_in(text).is_some_and(|unit| is_foreign_unit(&unit))) {
            return false;
        }
        let is_in_unit =
            unit.is_some_and(is_unit) || has_unit(title) || values.iter().any(|text| has_unit_behind(text));
        let are_values = WordList::Words.has(title) && self.cells.iter().any(Cell::has_decimals);
        if is_context(title) {
            return are_values
                || is_in_unit && unit != Some("min")
                || self.names_more()
                || self.is_repeated && (self.is_fine() || self.has_words() || WordList::Requirement.has(title))
                || is_again(title) && self.may_be_measured_again();
        }
        self.is_measurement
            || are_values
            || is_in_unit
            || title.contains('[') && unit.is_some()
            || !near(title).is_empty()
            || self.column.is_some_and(|place| is_no_name(title) && !self.counts_rows(place))
            || self.column.is_some() && repeats_value(title) && !is_statistic(title) && !self.counts_or_flags()
            || self.column.is_none()
                && (is_again(title) && !values.iter().all(|text| text.contains(':'))
                    || repeats_value(title) && values.len() > 1)
    }

    /// Whether it is a column that says which part a row is, and not with which it is paired.
    pub(crate) fn says_part(&self) -> bool {
        let names_one = is_part_name(&self.title) && part_said(&self.title).is_none();
        self.column.is_some() && (names_one || WordList::Report.has(&self.title))
    }

    /// Whether it is a column of verdicts: of its cells at least as many approve as say anything else. `ja` and `1` do where its name
    /// says so, and `P` beside `F`.
    pub(crate) fn are_verdicts(&self) -> bool {
        const PAIRS: [[&str; 2]; 2] = [["P", "F"], ["A", "R"]];
        let said: Vec<_> = self.cells.iter().filter(|cell| !cell.is_missing()).map(Cell::text).collect();
        let is_pair = |pair: &[&str; 2]| {
            said.iter().all(|text| pair.contains(&&**text))
                && pair.iter().all(|letter| said.iter().any(|text| text == letter))
        };
        let may_be_yes = is_of_validity(&self.title) || PAIRS.iter().any(is_pair);
        let approves = |text: &&Cow<'_, str>| WordList::Approval.has(text) || may_be_yes && WordList::Yes.has(text);
        let approvals = said.iter().filter(approves).count();
        self.column.is_some() && approvals > 0 && 2 * approvals >= said.len()
    }

    /// Whether it holds the signs of numbers that stand elsewhere: its name says so, or it is a column of both.
    pub(crate) fn has_signs(&self) -> bool {
        let is_plus = |cell: &Cell| matches!(cell.text().trim(), "+" | "plus");
        let is_minus = |cell: &Cell| matches!(cell.text().trim(), "-" | "\u{2212}" | "minus" | "moins");
        let (mut signs, is_of_signs) = (self.cells.iter(), |cell: &Cell| is_plus(cell) || is_minus(cell));
        if WordList::Sign.has(&self.title) {
            return signs.any(is_of_signs);
        }
        self.column.is_some()
            && self.cells.iter().any(is_plus)
            && self.cells.iter().any(is_minus)
            && signs.all(|cell| is_of_signs(cell) || cell.is_missing())
    }

    /// Whether a cell holds a number, though maybe one that nobody can read: `>200`, `12...15 µm`.
    fn is_value(&self, cell: &Cell) -> bool {
        let text = cell.text();
        cell.is_number()
            || is_bounded(&text)
            || self.is_measurement && has_unit_behind(&text)
            || self.title.is_empty() && speaks_of_value(&text)
    }

    /// Whether words stand among its numbers.
    fn has_words(&self) -> bool {
        self.cells.iter().any(|cell| !cell.is_number() && !cell.is_missing())
    }

    /// Whether a number of it has the decimals of measured values; a workbook drops zeros of others.
    fn is_fine(&self) -> bool {
        self.cells.iter().any(Cell::is_fine)
    }

    /// Whether a line goes on with the name of a measurement: `lot 2: rack pitch 212 µm`.
    fn names_more(&self) -> bool {
        let words: Vec<_> = self.cells.iter().filter(|cell| !cell.is_number()).map(Cell::text).collect();
        self.column.is_none() && !near(&words.join(" ")).is_empty()
    }

    /// Whether its numbers may be of another measurement: a column that does not count them, a line with decimals.
    fn may_be_measured_again(&self) -> bool {
        match self.column {
            Some(_) => !self.counts_or_flags(),
            None => self.cells.iter().any(Cell::has_decimals),
        }
    }

    /// Whether each number is 0, 1, the one above it or one more, as where measurements are counted: `Messung` 1, 2, 1, 2.
    fn counts_or_flags(&self) -> bool {
        let cells = self.cells.iter().filter(|cell| !cell.is_missing());
        let numbers: Option<Vec<u32>> = cells.map(|cell| cell.text().parse().ok()).collect();
        let goes_on = |pair: &[u32]| pair[1] <= 1 || pair[1] == pair[0] || pair[1] == pair[0] + 1;
        numbers
            .is_some_and(|numbers| numbers.first().is_some_and(|first| *first <= 1) && numbers.windows(2).all(goes_on))
    }

    /// Whether a first column without a name counts the rows.
    fn counts_rows(&self, place: usize) -> bool {
        place == 0 && self.cells.iter().all(Cell::is_whole)
    }
}

/// Whether a column has no name, or one that a program has given to it: `Unnamed: 3`, `Spalte4`, `...4`.
fn is_no_name(title: &str) -> bool {
    let word = title.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches([' ', ':', '_']).to_lowercase();
    title.is_empty()
        || word.len() < title.len() && matches!(word.as_str(), "unnamed" | "column" | "spalte" | "colonne" | "...")
}

/// Whether a remark speaks of a value: `corrected: 25,060 mm`, `dp = 80`.
pub(crate) fn speaks_of_value(text: &str) -> bool {
    text.contains(|c: char| c.is_ascii_digit()) && (has_unit_behind(text) || !near(text).is_empty())
}

/// Whether a unit of length or angle stands behind the number in a text.
pub(crate) fn has_unit_behind(text: &str) -> bool {
    let is_mark = |c: char| c.is_ascii_punctuation() && !matches!(c, '\'' | '"') || c == ' ';
    unit_in(text).is_some_and(|unit| is_unit(unit.trim_matches(is_mark))) && !is_turn(text) && !is_before_time(text)
}

/// Whether `um` stands behind a date, and is a word: `Am 11.03.2026 um`.
fn is_before_time(text: &str) -> bool {
    text.strip_suffix(" um").and_then(|text| text.split_whitespace().next_back()).is_some_and(is_date)
}

/// Whether a text ends with a right angle or a multiple of one, by which parts are turned: `gedreht um 180°`.
fn is_turn(text: &str) -> bool {
    let number = text.trim().strip_suffix('°').and_then(|text| text.split_whitespace().next_back()?.parse().ok());
    number.is_some_and(|degrees: u32| degrees > 0 && degrees.is_multiple_of(90))
}

/// A number with a mark before it, which no reader of numbers takes: `>200`.
fn is_bounded(text: &str) -> bool {
    let text = text.trim();
    let rest = text.trim_start_matches(['<', '>', '≤', '≥', '~', '≈', '±', '=']).trim_start();
    rest.len() < text.len() && rest.starts_with(|c: char| c.is_ascii_digit())
}

/// Whether a unit stands anywhere among the words of a name.
fn has_unit(title: &str) -> bool {
    let is_clear = |word: &&str| word.chars().count() > 1 && !matches!(word.to_lowercase().as_str(), "in" | "min");
    title
        .split(|c: char| !c.is_alphanumeric() && c != 'µ')
        .filter(is_clear)
        .any(|word| Unit::from_symbol(word).is_some() || Unit::from_symbol(&word.to_lowercase()).is_some())
}

/// Whether a unit measures neither lengths nor angles.
pub(crate) fn is_foreign_unit(unit: &str) -> bool {
    let is_other = WordList::ForeignUnit.has(unit) || unit.trim().starts_with('%') || is_rate(unit);
    is_other && Unit::from_symbol(unit).is_none()
}

/// Whether a unit is one per time or per turn: `mm/min`, `m/s`, `mm/U`.
fn is_rate(unit: &str) -> bool {
    let per = unit.rsplit_once('/').map_or("", |(_, per)| per.trim());
    ["min", "s", "sec", "h", "u", "umdr", "rev", "tr", "tour"].iter().any(|turn| per.eq_ignore_ascii_case(turn))
}
