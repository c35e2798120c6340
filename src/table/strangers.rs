//! Columns, lines and characteristics that name nothing known: which of them are no measurement, and which could be one, so
//! that nothing is judged before somebody says what they are. Called once per table.

use serde::Serialize;

use super::cell::Cell;
use super::grid::{Separator, records};
use super::names::{Field, Role, is_context, is_evaluation_length, near, role, split_unit};
use super::reading::{AsideReading, NotUsed};
use super::shape::{Shape, Unknown, is_part_name, uncounted};
use super::want::Want;
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::{Unit, shown};

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
}

/// What became of what is not understood.
#[derive(Debug, Default)]
pub(crate) struct Sorted {
    pub(crate) strangers: Vec<Stranger>,
    pub(crate) not_used: Vec<NotUsed>,
    pub(crate) asides: Vec<AsideReading>,
}

/// Sorts what a table has besides its measurements. `complete` tells that every error of the spec is found.
pub(crate) fn sort(file: &str, shape: &Shape, want: &Want, complete: bool) -> Sorted {
    let mut sorted = Sorted::default();
    for unknown in &shape.unknown {
        sorted.take(file, unknown, want, complete);
    }
    for aside in &shape.asides {
        match labelled(aside) {
            Some(unknown) if could_be_measured(&unknown) || want.ignores(&unknown.title) => {
                sorted.take(file, &unknown, want, complete);
            }
            _ => sorted.asides.push(aside.clone()),
        }
    }
    sorted
}

impl Sorted {
    fn take(&mut self, file: &str, unknown: &Unknown, want: &Want, complete: bool) {
        let title = &unknown.title;
        let not_used =
            |why| NotUsed { title: if title.is_empty() { unknown.place.clone() } else { title.clone() }, why };
        if want.ignores(title) {
            self.not_used.push(not_used("ignored by the user"));
        } else if role(title) == Some(Role::Uncertainty) {
            self.not_used.push(not_used("an uncertainty: those that count stand in the spec"));
        } else if !could_be_measured(unknown) {
            if !title.is_empty() || unknown.cells.iter().any(Cell::is_number) {
                self.not_used.push(not_used("no measurement"));
            }
        } else if want.others_ignored && complete {
            self.not_used.push(not_used("others are ignored"));
        } else {
            self.strangers.push(stranger(file, unknown));
        }
    }
}

/// A line of words and numbers as a name and its values.
fn labelled(aside: &AsideReading) -> Option<Unknown> {
    let record = uncounted(records(&aside.text, Separator::Blanks).first()?);
    let words = record.cells.iter().take_while(|cell| !cell.is_measure()).count();
    let (label, numbers) = record.cells.split_at(words);
    let text = label.iter().map(Cell::text).collect::<Vec<_>>().join(" ");
    let unknown = |title: &str, numbers: &[Cell]| {
        let cells: Vec<_> = numbers.iter().filter(|cell| cell.is_number()).cloned().collect();
        (!cells.is_empty()).then(|| Unknown::line(title, aside.line, cells))
    };
    // an order, a page, a date: the word before the number says what it is
    let last = text.split_whitespace().next_back()?;
    if is_context(last) {
        // Part 2: 25.2 mm
        return unknown("", numbers.get(1..)?).filter(|_| is_part_name(&text));
    }
    unknown(&text, numbers)
}

/// Whether it holds numbers, and its name or unit is that of a measurement.
pub(crate) fn could_be_measured(unknown: &Unknown) -> bool {
    let title = &unknown.title;
    let (_, in_title) = split_unit(title);
    let unit = in_title.as_deref().or(unknown.unit.as_deref());
    let mut values = unknown.cells.iter().filter(|cell| cell.is_number() || is_bounded(&cell.text())).peekable();
    // the evaluation length of a lead that was not measured says nothing
    let is_other = is_context(title) || is_evaluation_length(title) || unit.is_some_and(is_foreign_unit);
    if values.peek().is_none() || is_other {
        return false;
    }
    let measures = |symbol: &str| Unit::from_symbol(symbol).is_some();
    unknown.is_measurement
        || unit.is_some_and(measures)
        || title.contains('[') && unit.is_some()
        || has_unit(title)
        || values.any(|cell| unit_in(&cell.text()).is_some_and(|symbol| measures(&symbol)))
        || !near(title).is_empty()
        || unknown.column.is_some_and(|place| title.is_empty() && !counts_rows(unknown, place))
}

/// A number with a mark before it, which no reader of numbers takes: `>200`.
fn is_bounded(text: &str) -> bool {
    let text = text.trim();
    let rest = text.trim_start_matches(['<', '>', '≤', '≥', '~', '≈', '±', '=']).trim_start();
    rest.len() < text.len() && rest.starts_with(|c: char| c.is_ascii_digit())
}

/// Whether a first column without a name counts the rows.
fn counts_rows(unknown: &Unknown, place: usize) -> bool {
    place == 0 && unknown.cells.iter().all(|cell| cell.text().chars().all(|c| c.is_ascii_digit()))
}

/// Whether a unit stands anywhere among the words of a name.
fn has_unit(title: &str) -> bool {
    let is_clear = |word: &&str| word.chars().count() > 1 && !matches!(word.to_lowercase().as_str(), "in" | "min");
    title
        .split(|c: char| !c.is_alphanumeric() && c != 'µ')
        .filter(is_clear)
        .any(|word| Unit::from_symbol(word).is_some() || Unit::from_symbol(&word.to_lowercase()).is_some())
}

/// Units of what is neither a length nor an angle.
const FOREIGN_UNITS: [&str; 38] = [
    "-", "1", "pcs", "stk", "°c", "c", "°f", "k", "n", "kn", "mn", "nm", "nmm", "ncm", "kg", "g", "s", "ms", "sec",
    "h", "%", "‰", "bar", "mbar", "mpa", "hpa", "pa", "hrc", "hv", "hb", "rpm", "1/min", "min-1", "hz", "v", "a",
    "n/mm", "n/mm²",
];

/// Whether a unit measures neither lengths nor angles.
fn is_foreign_unit(unit: &str) -> bool {
    Unit::from_symbol(unit).is_none() && FOREIGN_UNITS.contains(&unit.trim().to_lowercase().as_str())
}

/// The unit behind a number.
pub(crate) fn unit_in(text: &str) -> Option<String> {
    let last = text.rfind(|c: char| c.is_numeric() || matches!(c, '.' | ','))?;
    let unit = text[last..].trim_start_matches(|c: char| c.is_numeric() || matches!(c, '.' | ',')).trim();
    (!unit.is_empty()).then(|| unit.to_owned())
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
    }
}

/// The refusal of tables with columns that are not understood, all of them at once; `None` if there are none.
/// `still_missing` are the errors without which `others = "ignore"` does not hold yet.
#[must_use]
pub fn refusal(strangers: &[Stranger], still_missing: &[DeviationKind]) -> Option<Diagnostic> {
    const SHOWN: usize = 20;
    strangers.first()?;
    let listed = strangers.iter().take(SHOWN).map(|stranger| {
        let near =
            if stranger.near.is_empty() { String::new() } else { format!("; near {}", stranger.near.join(", ")) };
        format!(
            "\n  {}, {}: `{}`: {}{near}",
            stranger.file,
            stranger.place,
            shown(&stranger.title),
            stranger.values.join(", ")
        )
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
    let mut named: Vec<&Stranger> = strangers.iter().filter(|stranger| !stranger.name().is_empty()).collect();
    named.dedup_by_key(|stranger| stranger.name());
    named.truncate(SHOWN);
    let each =
        |of: &dyn Fn(&&Stranger) -> String, between: &str| named.iter().map(of).collect::<Vec<_>>().join(between);
    let help = if named.is_empty() {
        "give it a name, or leave it out of the table".to_owned()
    } else {
        format!(
            "say in the spec what it is, under [batch.columns]: {}; or leave it out: [batch] ignore = [{}], or on the command line {}",
            each(&|stranger| stranger.mapping(), "; "),
            each(&|stranger| quoted(&stranger.name()), ", "),
            each(&|stranger| format!("--ignore {}", shell_quoted(&stranger.name())), " "),
        )
    };
    let names: Vec<_> = still_missing.iter().map(|kind| kind.key()).collect();
    let help = if names.is_empty() {
        help
    } else {
        format!(
            "{help}; others = \"ignore\" holds once every error of the spec is found, and {} is not",
            names.join(", ")
        )
    };
    Some(Diagnostic::error(Code::NotUnderstood, message).help(help))
}

impl Stranger {
    /// What it is called, without its unit.
    fn name(&self) -> String {
        split_unit(&self.title).0.trim().to_owned()
    }

    /// The line of the spec that says what it is, if that is the nearest name.
    fn mapping(&self) -> String {
        let key = self.near.first().copied().unwrap_or("rack_pitch");
        let unit = self.unit.as_ref().map_or_else(String::new, |unit| format!(", unit = {}", quoted(unit)));
        format!("{key} = {{ name = {}{unit} }}", quoted(&self.name()))
    }
}

/// A text as a spec writes it.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

fn shell_quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "'\\''"))
}
