//! What the rules of a contract left out of a table while its columns are found.

use super::heading::Matched;
use super::owner::{Owner, line_of};
use crate::table::cell::Record;
use crate::table::layout::{Layout, OwnRule};
use crate::table::ledger::LeftOut;

/// What each rule left out so far.
pub(super) struct Tallies {
    pub(super) rules: Vec<LeftOut>,
    /// The number of the rule for what stands beside values.
    pub(super) beside: usize,
}

impl Tallies {
    pub(super) fn new(layout: &Layout) -> Self {
        Self { rules: layout.rules(), beside: layout.own_rule(OwnRule::BesideValues) }
    }

    pub(super) fn add(&mut self, rule: usize, line: u64, place: usize, text: &str) {
        self.rules[rule].tally.add(line, place, text);
    }

    /// Counts the lines that rules leave out.
    pub(super) fn lines(&mut self, records: &[Record], layout: &Layout) {
        for record in records {
            if let Some(rule) = layout.covering(record) {
                self.add(layout.rule_of_line(rule), record.line, 0, &line_of(record));
            }
        }
    }

    /// Counts the headings of columns that rules leave out.
    pub(super) fn headings(&mut self, matched: &Matched) {
        for (place, (owner, title)) in matched.owners.iter().zip(&matched.titles).enumerate() {
            if let Some(Owner::Rule(rule)) = owner {
                self.add(*rule, matched.line, place, title);
            }
        }
    }
}
