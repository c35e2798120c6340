//! What has no owner in a table.

use std::borrow::Cow;
use std::collections::BTreeSet;

use crate::quantity::{listed, shown};
use crate::table::block::Odd;
use crate::table::cell::{Cell, Record};
use crate::table::grid::Separator;
use crate::table::number::is_missing;

/// Something that needs an owner, or a choice, before the table is read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Open {
    /// A column without a role or a rule, with its first texts; whether they may be decisions.
    Column { place: usize, title: String, first: Vec<String>, may_decide: bool },
    /// A characteristic without a role or a rule, with its first value.
    Characteristic { title: String, first: Vec<String> },
    /// A line that is no part; whether it is a heading.
    Line { line: u64, text: String, is_heading: bool },
    /// A row that is no part by its name, or because it has no value.
    Row(Odd),
    /// A comment, a text box or metadata of a file.
    Comment { place: String, text: String },
    /// Sheets of which none is chosen.
    Sheets { names: Vec<String> },
    /// A column of values whose unit nothing gives, and the units in which its numbers are of a usual size.
    Unit { key: &'static str, title: String, units: Vec<&'static str> },
    /// Two columns with one role.
    Twice { key: String, titles: [String; 2] },
    /// A pattern that would leave out a heading of the dictionary.
    Pattern { pattern: String, title: String },
    /// A rule that leaves out the only column with the names of parts.
    IgnoredNames { rule: String, title: String },
    /// A heading that the contract names and the table lacks.
    Missing { key: String, name: String },
    /// No heading has the role of an error.
    NoValues { titles: Vec<String> },
    /// Nothing tells the decimal mark.
    Mark { example: String },
    /// The encodings under which more headings are known.
    Encoding { names: Vec<&'static str> },
    /// Nothing tells which of these separates the cells.
    Separator { able: Vec<Separator> },
    /// Something else that is wrong, with what to do.
    Wrong { what: String, help: String },
}

/// How much of what has no owner is listed, at most. All of it is counted.
pub(crate) const MOST_LISTED: usize = 10_000;

/// Lists what is found while there is room, and returns how much more there is.
pub(crate) fn list(open: &mut Vec<Open>, mut found: impl Iterator<Item = Open>) -> usize {
    let room = MOST_LISTED.saturating_sub(open.len());
    open.extend(found.by_ref().take(room));
    found.count()
}

impl Open {
    /// A column without an owner, from its heading and the rows below it.
    pub(crate) fn column(place: usize, title: &str, below: &[Record]) -> Self {
        let cells = || below.iter().map(|record| record.cell(place)).filter(|cell| !cell.is_empty());
        let first = cells().take(3).map(|cell| cell.text().into_owned()).collect();
        Self::Column { place, title: title.to_owned(), first, may_decide: may_decide(cells().map(Cell::text)) }
    }

    /// What has no owner, in one line.
    pub(crate) fn in_words(&self) -> String {
        let first_of = |first: &[String]| first.iter().map(|text| shown(text)).collect::<Vec<_>>().join(", ");
        match self {
            Self::Column { place, title, first, .. } if title.is_empty() => {
                format!("column {} has no heading: {}", place + 1, first_of(first))
            }
            Self::Column { title, first, .. } => format!("column `{}`: {}", shown(title), first_of(first)),
            Self::Characteristic { title, first } => format!("characteristic `{}`: {}", shown(title), first_of(first)),
            Self::Line { line, text, .. } => format!("line {line}: {}", shown(text)),
            Self::Row(Odd { line, text, .. }) => format!("line {line} is no part: {}", shown(text)),
            Self::Comment { place, text } => format!("{place}: {}", shown(text)),
            Self::Sheets { names } => format!("several sheets have cells: {}: choose one with --sheet", listed(names)),
            Self::Unit { key, title, .. } => format!("`{}` is {key}, and nothing tells its unit", shown(title)),
            Self::Twice { key, titles } => format!("{} are both {key}", listed(titles)),
            Self::Pattern { pattern, title } => {
                format!(
                    "`{pattern}` would leave out `{}`, whose meaning is known: leave it out by its whole name",
                    shown(title)
                )
            }
            Self::IgnoredNames { title, .. } => {
                let how = "take it out of `ignore`, or say what names the parts: part_id = \"…\"";
                format!("`{}` names the parts, and a rule leaves it out: {how}", shown(title))
            }
            Self::Missing { key, name } => format!("there is no `{}`, which the contract names as {key}", shown(name)),
            Self::NoValues { titles } => format!("no column is known to hold an error: {}", listed(titles)),
            Self::Mark { example } => {
                format!("`{}` has a decimal mark or a thousands mark, and nothing tells which", shown(example))
            }
            Self::Encoding { names } => {
                let or = names.join(" or ");
                format!("it is no text in UTF-8, and in {or} more of its headings are known: --encoding {or}")
            }
            Self::Separator { able } => {
                let names: Vec<String> = able.iter().map(|separator| separator.name()).collect();
                format!("cells may be separated by {}", names.join(" or by "))
            }
            Self::Wrong { what, .. } => what.clone(),
        }
    }
}

/// Whether some texts may be decisions: few of them differ, and none is long, a number or a date. Their words do not matter.
pub(crate) fn may_decide<'t>(texts: impl Iterator<Item = Cow<'t, str>>) -> bool {
    const MOST: usize = 4;
    const LONGEST: usize = 60;
    let mut found = BTreeSet::new();
    for text in texts.filter(|text| !is_missing(text)) {
        let is_number = text.chars().all(|c| c.is_ascii_digit() || c.is_whitespace() || ".,:/+-".contains(c));
        let is_long = text.len() > LONGEST;
        found.insert(text);
        if is_number || is_long || found.len() > MOST {
            return false;
        }
    }
    !found.is_empty()
}
