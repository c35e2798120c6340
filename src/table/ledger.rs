//! Who owns each cell. What reads a cell owns it: a role, a rule that a person wrote, or the file's format. A cell that nothing
//! reads has no owner: its row is rejected, and a table with a whole column of them is refused.

use std::cell::Cell as Shared;
use std::fmt;

use serde::{Serialize, Serializer};
use twox_hash::XxHash64;

use super::cell::{Cell, Record};
use crate::quantity::shown;

/// The name of the rule that owns what a format writes besides values.
pub(crate) const OF_FORMAT: &str = "by its format";
/// How many texts of each rule are shown.
const SHOWN: usize = 3;
/// How many texts are kept of each rule: more than a page shows of a column, and its heading.
const KEPT: usize = 5;

/// What a rule left out.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// How many cells or lines; blank ones do not count.
    pub count: u64,
    /// The first texts that differ.
    pub first: Vec<String>,
    /// A digest of all texts with their places. The order in which they are added does not matter.
    #[serde(serialize_with = "in_hexadecimal")]
    pub digest: u64,
}

/// A rule that a person wrote, or that a format has, and what it left out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// The rule, as it is written.
    pub rule: String,
    /// The role of what it covers, if it has one: `status`, or a key of `[report]`. No value follows from it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub role: Option<&'static str>,
    #[serde(flatten)]
    pub(crate) tally: Tally,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands references on")]
fn in_hexadecimal<S: Serializer>(digest: &u64, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&format_args!("{digest:016x}"))
}

impl Tally {
    /// Counts a text at a place of a line, unless it is blank.
    pub(crate) fn add(&mut self, line: u64, place: usize, text: &str) {
        if !text.is_empty() {
            self.count += 1;
            self.digest = self.digest.wrapping_add(digest(line, place, text.as_bytes()));
            self.keep(text);
        }
    }

    /// Keeps a text if it differs from those that are kept, and there is room.
    fn keep(&mut self, text: &str) {
        if self.first.len() < KEPT && self.first.iter().all(|known| known != text) {
            self.first.push(text.to_owned());
        }
    }

    /// Adds what the same rule left out further on.
    pub(crate) fn join(&mut self, next: &Self) {
        self.count += next.count;
        self.digest = self.digest.wrapping_add(next.digest);
        next.first.iter().for_each(|text| self.keep(text));
    }
}

/// `` `Temp*` 12 texts (20,1, 20,2, 20,3, …) 1a2b3c4d ``
impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Tally { count, first, digest } = &self.tally;
        let texts: Vec<_> = first.iter().take(SHOWN).map(|text| shown(text)).collect();
        let more = if *count > texts.len() as u64 { ", …" } else { "" };
        match count {
            0 => write!(f, "{} nothing", self.rule),
            1 => write!(f, "{} 1 text ({}) {:08x}", self.rule, texts.concat(), digest >> 32),
            count => write!(f, "{} {count} texts ({}{more}) {:08x}", self.rule, texts.join(", "), digest >> 32),
        }
    }
}

impl LeftOut {
    /// The first texts that differ.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.tally.first.iter().map(String::as_str)
    }
}

/// Adds what each rule left out in further rows.
pub(crate) fn join(left_out: &mut [LeftOut], next: &[Tally]) {
    left_out.iter_mut().zip(next).for_each(|(rule, next)| rule.tally.join(next));
}

/// The digest of a text at its place.
pub(crate) fn digest(line: u64, place: usize, text: &[u8]) -> u64 {
    /// A line has fewer cells than this, so that each cell has a seed of its own.
    const PLACES: u64 = 1 << 32;
    XxHash64::oneshot(line.wrapping_mul(PLACES).wrapping_add(place as u64), text)
}

/// The cells of one record, and which of them are read. What reads a cell owns it.
pub(crate) struct RowLedger<'r> {
    record: &'r Record,
    is_read: Vec<Shared<bool>>,
}

/// A cell that nothing has read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Unowned<'r> {
    pub(crate) place: usize,
    pub(crate) cell: &'r Cell,
}

impl<'r> RowLedger<'r> {
    /// A ledger of a record of which nothing is read.
    pub(crate) fn new(record: &'r Record) -> Self {
        Self { record, is_read: vec![Shared::new(false); record.cells.len()] }
    }

    /// Reads the cell at a place. The caller becomes its owner.
    pub(crate) fn read(&self, place: usize) -> &'r Cell {
        if let Some(is_read) = self.is_read.get(place) {
            is_read.set(true);
        }
        self.record.cell(place)
    }

    /// Checks that every cell that is not blank is read.
    ///
    /// # Errors
    /// The first cell that is not.
    pub(crate) fn close(self) -> Result<(), Unowned<'r>> {
        let cells = self.record.cells.iter().zip(self.is_read).enumerate();
        let mut unread = cells.filter(|(_, (cell, is_read))| !is_read.get() && !cell.is_empty());
        unread.next().map_or(Ok(()), |(place, (cell, _))| Err(Unowned { place, cell }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nobody_reads_is_not_owned() {
        let cell = |text: &str| Cell::of_text(text);
        let record = Record::new(vec![cell("P1"), cell(""), cell("25,011"), cell("412")], 2);
        let ledger = RowLedger::new(&record);
        assert_eq!(ledger.read(0).text(), "P1");
        assert!(ledger.read(7).is_empty());
        ledger.read(2);
        assert_eq!(ledger.close().unwrap_err().place, 3);
    }

    #[test]
    fn digests_tell_texts_and_places() {
        let tally = |texts: &[(u64, &str)]| {
            let mut tally = Tally::default();
            for (line, text) in texts {
                tally.add(*line, 1, text);
            }
            tally
        };
        let both = tally(&[(1, "20,1"), (2, "20,2"), (3, "")]);
        assert_eq!(both.count, 2);
        let mut joined = tally(&[(1, "20,1")]);
        joined.join(&tally(&[(2, "20,2")]));
        assert_eq!(joined, both);
        for other in [tally(&[(1, "20,2"), (2, "20,1")]), tally(&[(1, "20,1"), (2, "20,3")]), tally(&[(1, "20,1")])] {
            assert_ne!(other.digest, both.digest);
        }
        let told = LeftOut { rule: "`Temp*`".to_owned(), role: None, tally: tally(&[(1, "20,1")]) };
        assert_eq!(told.to_string(), "`Temp*` 1 text (20,1) 5d69b1d7");
    }
}
