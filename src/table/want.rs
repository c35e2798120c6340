//! What is known about a table before it is read: what the spec says of its columns, and what the user says of the file.
//! Filled by the spec and the command line; asked by every step of the reading.

use std::borrow::Cow;
use std::sync::Arc;

use super::encoding::Encoding;
use super::layout::{DeclaredColumn, Layout, PartNames, Parts};
use super::names::{
    Field, ValueKind, is_called, is_total, part_in_title, repeats_value, says_deviation, says_which, split_unit,
};
use super::number::DecimalMark;
use super::pattern::Pattern;
use super::workbook::CellRange;
use crate::deviation::{DeviationKind, DeviationValue, Part};
use crate::diagnostic::{Diagnostics, harmless};
use crate::quantity::{Length, Unit};

/// How parts stand in a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Orientation {
    /// A part, space or tooth in each row.
    #[default]
    Rows,
    /// A part, space or tooth in each column.
    Columns,
}

impl Orientation {
    /// `rows` or `columns`.
    pub(crate) const fn word(self) -> &'static str {
        match self {
            Self::Rows => "rows",
            Self::Columns => "columns",
        }
    }
}

/// What the spec says of the column of an error.
#[derive(Debug, Clone)]
pub struct GivenColumn {
    /// The error.
    pub kind: DeviationKind,
    /// The unit of its numbers.
    pub unit: Option<Unit>,
    /// Whether it holds measured values or deviations.
    pub holds: Option<ValueKind>,
    /// The nominal value, or what is missing to compute it.
    pub nominal: Option<Result<DeviationValue, Diagnostics>>,
    /// The evaluation length of f_Hβ.
    pub length: Option<Length>,
    /// Whether it says on which teeth its values are.
    pub has_extent: bool,
}

/// What is known about a table before it is read.
#[derive(Debug, Clone, Default)]
pub struct Want {
    /// What its columns hold, in order; empty to find out from its header or the spec's order.
    pub fields: Vec<Field>,
    /// The errors that the spec speaks of, in its order.
    pub expected: Vec<DeviationKind>,
    /// Names that the spec gives to columns.
    pub own: Vec<(String, Field)>,
    /// What the spec says of columns.
    pub given: Vec<GivenColumn>,
    /// The normal module: a measured value that is further from its nominal one is not meant.
    pub module: Option<Length>,
    /// The rack's face width, over which f_Hβ is evaluated where nothing else is said.
    pub face_width: Option<Length>,
    /// The pinion's face width, over which f_Hβ of its teeth is evaluated.
    pub pinion_face_width: Option<Length>,
    /// The roller over which a rack is measured, if the nominal measure follows from it.
    pub roller: Option<Length>,
    /// How many teeth the pinion has.
    pub pinion_teeth: Option<i64>,
    /// The nominal measure over the pin, if the spec tells it.
    pub over_pin: Option<Length>,
    /// Patterns of columns and lines that the user leaves out.
    pub ignored: Vec<String>,
    /// Whether parts are judged by the uncertainties of their values, which are those of the spec.
    pub by_uncertainty: bool,
    /// Whether what is not understood is left out once every error of the spec is found.
    pub others_ignored: bool,
    /// The separator, if it is given.
    pub separator: Option<u8>,
    /// The decimal mark, if it is given.
    pub decimal: Option<DecimalMark>,
    /// The orientation, if it is given.
    pub orientation: Option<Orientation>,
    /// The encoding, if it is given.
    pub encoding: Option<Encoding>,
    /// The sheet of a workbook, if it is given.
    pub sheet: Option<String>,
    /// The cells of a sheet.
    pub range: CellRange,
    /// Whether nothing is judged, so that a nominal value need not be known.
    pub only_shown: bool,
    /// Of which part the values are, as a title or the name of a sheet says.
    pub part: Option<Part>,
    /// Whether each row is a tooth or a space; found from the names unless given.
    pub teeth: Option<bool>,
    /// The contract by which a table with values of parts is read, if there is one.
    pub layout: Option<Arc<Layout>>,
}

impl Want {
    /// The same of a table with these titles, if they say that all is of one part.
    pub(crate) fn of_part(&self, titles: impl Iterator<Item = String>) -> Cow<'_, Self> {
        let said = titles.filter(|title| !self.ignores(title)).filter_map(|title| part_in_title(&title));
        let said: Vec<Part> = said.chain(self.part).collect();
        let is_one = said.iter().all(|part| *part == said[0]);
        match said.first().filter(|_| is_one).copied() {
            part if part == self.part => Cow::Borrowed(self),
            part => Cow::Owned(Self { part, ..self.clone() }),
        }
    }

    /// The contract by which a table is read, where nothing else decides.
    pub(crate) fn only_contract(&self) -> Option<Arc<Layout>> {
        (self.layout.is_some() || self.teeth == Some(true)).then(|| self.contract())
    }

    /// The contract by which a table is read: that of the spec, or what it says of columns without one.
    pub(crate) fn contract(&self) -> Arc<Layout> {
        let teeth = self.teeth == Some(true);
        if let Some(layout) = &self.layout {
            return if teeth { Arc::new(Layout { teeth, ..Layout::clone(layout) }) } else { Arc::clone(layout) };
        }
        let parts = self.orientation.map(|orientation| match orientation {
            Orientation::Rows => Parts::Rows,
            Orientation::Columns => Parts::Columns,
        });
        let part_id = self.own.iter().find(|(_, field)| *field == Field::PartId).map(|(name, _)| name.clone());
        let errors = self.own.iter().filter(|(_, field)| *field != Field::PartId);
        let columns = errors.map(|(name, field)| DeclaredColumn::new(*field, Some(name.clone()), None, Vec::new()));
        Arc::new(Layout {
            parts,
            teeth,
            decimal: self.decimal,
            separator: self.separator,
            part_id: part_id.map(PartNames::Column),
            columns: columns.collect(),
            ignore: self.ignored.iter().map(|pattern| Pattern::of_heading(pattern)).collect(),
            ignores_others: self.others_ignored,
            ..Layout::default()
        })
    }

    /// What the spec says of the column of an error.
    pub(crate) fn given(&self, kind: DeviationKind) -> Option<&GivenColumn> {
        self.given.iter().find(|given| given.kind == kind)
    }

    /// Whether the user leaves out what is called so, with or without its unit, as it is or as messages show it.
    pub(crate) fn ignores(&self, title: &str) -> bool {
        let (name, _) = super::names::split_unit(title);
        let fits = |pattern: &str, text: &str| matches(pattern, text) || matches(pattern, &harmless(text));
        self.ignored.iter().any(|pattern| fits(pattern, title) || fits(pattern, &name))
    }

    /// Whether a title is a name that the spec gives to a column, with a number, a letter or a word behind it that tells it from that:
    /// `CHR_017.1`, `CHR_017a`, `CHR_017_right`.
    pub(crate) fn names_once_more(&self, title: &str) -> bool {
        const MOST_BEHIND: usize = 3;
        let name = split_unit(title).0;
        let is_once_more = |own: &str| {
            let Some(behind) = name.strip_prefix(own).filter(|behind| !behind.is_empty()) else { return false };
            let word = behind.trim_matches(|c: char| !c.is_alphanumeric());
            let is_short = word.chars().count() < MOST_BEHIND;
            let is_letter = own.ends_with(|c: char| c.is_ascii_digit()) && word.chars().all(char::is_alphabetic);
            !word.is_empty()
                && if behind == word {
                    is_short && is_letter
                } else {
                    is_short || says_which(word) || repeats_value(word)
                }
        };
        let mut own = self.own.iter().filter(|(_, field)| *field != Field::PartId);
        own.any(|(own, _)| is_once_more(&split_unit(own).0))
    }

    /// The unit that the spec gives to a column, if this is the column that it means.
    pub(crate) fn stated_unit(&self, kind: DeviationKind, title: &str) -> Option<Unit> {
        let mut names = self.own.iter().filter(|(_, field)| field.kind() == Some(kind)).peekable();
        let is_meant = names.peek().is_none() || names.any(|(own, _)| is_called(title, own));
        self.given(kind).and_then(|given| given.unit).filter(|_| is_meant)
    }

    /// Whether a title is a name that the spec gives, which needs no unit: it has that of the spec or the key.
    pub(crate) fn is_own(&self, title: &str) -> bool {
        self.own.iter().any(|(own, _)| is_called(title, own))
    }
}

/// A text as a spec writes it.
pub(crate) fn quoted(text: &str) -> String {
    let escapes = [('\\', "\\\\"), ('"', "\\\""), ('\n', "\\n"), ('\r', "\\r"), ('\t', "\\t")];
    let escaped = escapes.into_iter().fold(text.to_owned(), |text, (c, escape)| text.replace(c, escape));
    format!("\"{}\"", harmless(&escaped))
}

/// The line of a spec that says what a column is; `kind` is the error that its name may be.
pub(crate) fn mapping(key: &str, kind: Option<DeviationKind>, name: &str, unit: Option<&str>) -> String {
    let unit = unit.map_or_else(String::new, |unit| format!(", unit = {}", quoted(unit)));
    let has_nominal = matches!(kind, Some(DeviationKind::RackOverRoller | DeviationKind::PinionRadial));
    let holds = if has_nominal && says_deviation(name) { ", kind = \"deviation\"" } else { "" };
    let extent = if kind.is_some() && is_total(name) { ", extent = \"total\"" } else { "" };
    format!("{key} = {{ name = {}{unit}{holds}{extent} }}", quoted(name))
}

/// The option that leaves out what fits a pattern, as a shell takes it.
pub(crate) fn ignore_option(pattern: &str) -> String {
    // what begins with a dash is no option of its own
    let separator = if pattern.starts_with('-') { '=' } else { ' ' };
    format!("--ignore{separator}'{}'", pattern.replace('\'', "'\\''"))
}

/// Whether a text fits a pattern in which `*` stands for any characters; outer blanks do not count. `Fp` is another deviation
/// than `fp`.
fn matches(pattern: &str, text: &str) -> bool {
    let (pattern, text) = (pattern.trim(), text.trim());
    let Some((first, others)) = pattern.split_once('*') else { return text == pattern };
    let (middle, last) = others.rsplit_once('*').unwrap_or(("", others));
    let inner = text.strip_prefix(first).and_then(|text| text.strip_suffix(last));
    // each piece stands behind the one before it
    inner
        .is_some_and(|inner| middle.split('*').try_fold(inner, |rest, piece| Some(rest.split_once(piece)?.1)).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns() {
        for (pattern, text, fits) in [
            ("Temp*", "Temperatur [°C]", true),
            ("temp", "Temperatur", false),
            ("*wert", "Mittelwert", true),
            ("M*w*t", "Mittelwert", true),
            ("*", "", true),
            ("a*b", "ab", true),
            ("a*b", "a", false),
            ("Bemerkung", " Bemerkung ", true),
            ("Fp *", "fp Zahnstange", false),
        ] {
            assert_eq!(matches(pattern, text), fits, "{pattern} {text}");
        }
    }
}
