//! The contract of a table: each column has a role or is left out by a rule, and each line is a part, left out by a rule, or
//! rejected. Cells without an owner end the run, and all of them are listed.
//!
//! `heading` finds the line of headings and gives each column its owner, `columns` finds units and decimal mark. Only
//! [`Contract::close`] makes a table that can be read.

mod characteristics;
mod columns;
mod heading;
mod open;
mod owner;
mod table;
mod tallies;
mod units;
mod unowned;
mod whole;

pub(crate) use columns::{fits_beside, plausible_units};
pub(crate) use heading::{Matched, Named, key, owner};
pub(crate) use open::{MOST_LISTED, Open, list, may_decide};
pub(crate) use owner::{Owner, line_of};
pub(crate) use table::{File, Found, found, is_in_rows, needs_all, of_records, refuse_wide, score};
pub(crate) use unowned::no_headings;
pub(crate) use whole::with_headings;

use std::collections::HashSet;
use std::sync::{Arc, LazyLock};

use super::cell::{Cell, Record};
use super::dictionary::{LONGEST_KNOWN, Role};
use super::encoding::text;
use super::field::Field;
use super::layout::{Layout, LineRule, OwnRule, StatusColumn};
use super::ledger::{LeftOut, OF_FORMAT, Tally};
use super::pattern::Pattern;
use crate::quantity::shown;

/// A table in which every column has an owner. Only such a table can be read.
#[derive(Debug, Clone)]
pub(crate) struct Contract {
    pub(crate) layout: Arc<Layout>,
    pub(crate) owners: Vec<Owner>,
    /// The headings.
    pub(crate) titles: Vec<String>,
    /// What has an owner besides the columns, in a table with a row per characteristic.
    pub(crate) of: Vec<Named>,
    /// The heading, as a line.
    heading: String,
    /// The line of units below it; empty if there is none.
    units: String,
    /// The first bytes of lines that a rule may leave out; `None` if any may be.
    first_bytes: Option<Vec<u8>>,
}

/// The names of statistics and limits, which no part has.
const NO_PART_NAMES: &str = "mean, average, avg, max, min, maximum, minimum, median, range, sigma, std, stdev, sum, total, cp, cpk, nominal, \
     target, usl, lsl, ucl, lcl, upper limit, lower limit, mittelwert, mittel, spannweite, streuung, standardabweichung, summe, soll, \
     sollwert, nennwert, toleranz, moyenne, 平均, 最大, 最小";

/// The names of the reader's own rules, which nobody writes, in the order of [`OwnRule`].
const OWN_RULES: [&str; 7] = [
    "others",
    "repeated headings",
    "beside values",
    "other sheets",
    "rows before the last of their part",
    OF_FORMAT,
    STATUS,
];

/// The rule for the texts of a status, which decide and are no values.
const STATUS: &str = "status";

impl Contract {
    /// Closes a table: every column has an owner.
    ///
    /// # Errors
    /// The columns as they are matched, with everything that has no owner.
    pub(crate) fn close(layout: &Arc<Layout>, matched: Matched) -> Result<Self, Box<Matched>> {
        if !matched.open.is_empty() {
            return Err(Box::new(matched));
        }
        let Matched { owners, titles, heading, units_line, of, .. } = matched;
        let owners: Vec<Owner> = owners.into_iter().flatten().collect();
        let first_bytes = layout.ignore_lines.iter().map(|rule| rule.pattern.first_byte()).collect();
        Ok(Self { layout: Arc::clone(layout), owners, titles, of, heading, units: units_line, first_bytes })
    }

    /// What numbers the rows, where they are spaces or teeth.
    fn index(&self) -> Option<Field> {
        let place = self.place(|role| matches!(role, Role::Index(_)))?;
        if let Owner::Role(Role::Index(field)) = self.owners[place] { Some(field) } else { None }
    }

    /// The column of a role.
    fn place(&self, is_it: impl Fn(Role) -> bool) -> Option<usize> {
        self.owners.iter().position(|owner| matches!(owner, Owner::Role(role) if is_it(*role)))
    }

    /// The columns that a rule leaves out, with the rule.
    pub(crate) fn left_out(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let rule =
            |(place, owner): (usize, &Owner)| if let Owner::Rule(rule) = owner { Some((place, *rule)) } else { None };
        self.owners.iter().enumerate().filter_map(rule)
    }

    /// Whether a column has no heading, so that nothing may stand in it. A column beyond the heading has none.
    pub(crate) fn is_nameless(&self, place: usize) -> bool {
        matches!(self.owners.get(place), None | Some(Owner::Nameless))
    }

    /// Whether a line may be one that a rule leaves out, by its first byte.
    pub(crate) fn may_cover(&self, first: u8) -> bool {
        // a quote stands before the text
        self.first_bytes.as_ref().is_none_or(|bytes| bytes.contains(&first) || first == b'"' && !bytes.is_empty())
    }

    /// Whether a record repeats the heading or its line of units.
    pub(crate) fn is_heading(&self, record: &Record) -> bool {
        let is_line = |line: &str| {
            let mut rest = Some(line);
            for (place, cell) in record.filled().iter().enumerate() {
                rest = rest
                    .and_then(|rest| rest.strip_prefix(if place > 0 { ";" } else { "" })?.strip_prefix(&*cell.text()));
            }
            rest == Some("")
        };
        is_line(&self.heading) || !self.units.is_empty() && is_line(&self.units)
    }

    /// Whether a record is another heading: two or more of its cells are known headings.
    pub(crate) fn is_other_heading(&self, record: &Record) -> bool {
        record.numbers() == 0 && heading::is_one(record, &self.layout)
    }

    /// Whether a cell has the name of a statistic or a limit.
    pub(crate) fn is_statistic(name: &Cell) -> bool {
        static NAMES: LazyLock<HashSet<&str>> = LazyLock::new(|| NO_PART_NAMES.split(", ").collect());
        let text = name.text();
        if text.is_empty() || text.len() > LONGEST_KNOWN || text.bytes().any(|byte| byte.is_ascii_digit()) {
            return false;
        }
        NAMES.contains(&*text.to_lowercase())
    }

    /// What is wrong with the name of a part; `None` if nothing is.
    pub(crate) fn no_name(name: &Cell) -> Option<String> {
        let text = name.text();
        if name.is_missing() {
            return Some("the part has no name".to_owned());
        }
        if name.is_unlike() {
            return Some(format!("the part's name is `{}`: show it plainly, or leave the line out", shown(&text)));
        }
        Self::is_statistic(name)
            .then(|| format!("`{text}` is no part's name: leave the line out, or give the part another name"))
    }

    /// Whether a name needs no closer look: no name of a statistic or a limit has a digit, and it may be other words.
    pub(crate) fn is_plain_name(name: &[u8]) -> bool {
        let is_word =
            |text: &str| text.chars().any(char::is_alphabetic) && Self::no_name(&Cell::of_text(text)).is_none();
        name.iter().any(u8::is_ascii_digit) || is_word(&text(name))
    }

    /// The column of a measuring program's decision.
    pub(crate) fn status(&self) -> Option<usize> {
        self.place(|role| role == Role::Status)
    }
}

impl Layout {
    /// Whether a measuring program accepts a part, by the text of its status.
    ///
    /// # Errors
    /// If the text is neither accepted nor rejected.
    pub(crate) fn accepts(&self, text: &str) -> Result<bool, String> {
        let status = self.status.as_ref();
        let is_among = |texts: fn(&StatusColumn) -> &Vec<String>| {
            status.is_some_and(|status| texts(status).iter().any(|one| one.trim() == text))
        };
        match (is_among(|status| &status.accept), is_among(|status| &status.reject)) {
            (true, false) => Ok(true),
            (false, true) => Ok(false),
            _ if text.is_empty() => Err("the status of the part is blank, so it has no verdict".to_owned()),
            _ => Err(format!(
                "the status `{}` is neither accepted nor rejected, so the part has no verdict",
                shown(text)
            )),
        }
    }

    /// The rule that leaves out a line, by its number among the rules for lines. A heading is left out only by a rule that fits one
    /// line.
    pub(crate) fn covering(&self, record: &Record) -> Option<usize> {
        if self.ignore_lines.is_empty() {
            return None;
        }
        let line = line_of(record);
        let fits = |rule: &LineRule| rule.pattern.fits(&line);
        let rule = self.ignore_lines.iter().position(fits)?;
        if self.ignore_lines[rule].pattern.is_exact() || !heading::is_one(record, self) {
            return Some(rule);
        }
        self.ignore_lines.iter().position(|rule| rule.pattern.is_exact() && fits(rule))
    }

    /// The number of a rule for lines among all rules.
    pub(crate) fn rule_of_line(&self, line_rule: usize) -> usize {
        self.ignore.len() + line_rule
    }

    /// The number of a rule for comments among all rules.
    pub(crate) fn rule_of_comment(&self, comment: usize) -> usize {
        self.ignore.len() + self.ignore_lines.len() + comment
    }

    /// The number of one of the reader's own rules among all rules.
    pub(crate) fn own_rule(&self, rule: OwnRule) -> usize {
        self.rule_of_comment(self.comments.len()) + rule as usize
    }

    /// All rules in order of their numbers, with nothing left out yet.
    pub(crate) fn rules(&self) -> Vec<LeftOut> {
        let quoted = |what: &str, text: &str| format!("{what}`{text}`");
        let ignored = self.ignore.iter().map(|rule| (quoted("", rule.text()), self.detail_of(rule)));
        let lines = self.ignore_lines.iter().map(|rule| (quoted("lines ", rule.pattern.text()), None));
        let comments = self.comments.iter().map(|rule| (quoted("comments ", rule.text()), None));
        let own = OWN_RULES.map(|rule| (rule.to_owned(), (rule == STATUS).then_some(STATUS)));
        let all = ignored.chain(lines).chain(comments).chain(own);
        all.map(|(rule, role)| LeftOut { rule, role, tally: Tally::default() }).collect()
    }

    /// The key of `[report]` that the columns of a rule stand for, if they stand for one.
    fn detail_of(&self, rule: &Pattern) -> Option<&'static str> {
        self.details.iter().find(|(_, heading)| Pattern::of_heading(heading) == *rule).map(|(key, _)| *key)
    }

    /// The role of the columns that one of all rules covers.
    pub(crate) fn role_of_rule(&self, rule: usize) -> Option<&'static str> {
        self.detail_of(self.ignore.get(rule)?)
    }
}
