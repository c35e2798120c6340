//! The outcome of a batch: counts that add up, the rejected rows with their faults, the parts worth a look. The run fills it,
//! reports read it; it decides nothing.

use std::fmt;
use std::io;
use std::sync::Arc;

use super::duplicates::Duplicates;
use super::output::{End, Output};
use super::request::Request;
use super::source::KINDS;
use super::statistics::{MovingRange, Statistics};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::Code;
use crate::evaluation::JudgedBy;
use crate::formula::ToleranceEnds;
use crate::function::{JudgedYoke, Settings};
use crate::judge::{Limit, LimitTarget, Verdict};
use crate::quantity::Length;
use crate::table::{ASIDES_KEPT, AsideReading, Block, Doubtful, LeftOut, OddRows, Place, Reading, Rows, join_left_out};

/// The number of rows, and of each outcome.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Records below the headers.
    pub rows: u64,
    /// Parts within every limit.
    pub pass: u64,
    /// Parts outside a limit, or that fail by their status.
    pub fail: u64,
    /// Of those, parts that break no limit on ΔCD and that their status rejects.
    pub fail_by_status: u64,
    /// Parts too near a limit for the decision rule.
    pub indeterminate: u64,
    /// Parts without a verdict: there is no limit, or one could not be judged.
    pub unjudged: u64,
    /// Rows that make no part.
    pub rejected: u64,
    /// Lines without a character, which are no records.
    pub blank_lines: u64,
    /// Parts that the exact mesh judged, because the bound does not pass them and nothing is left to place.
    pub meshed: u64,
}

impl Counts {
    /// The parts: rows that are not rejected.
    #[must_use]
    pub const fn parts(&self) -> u64 {
        self.rows - self.rejected
    }

    /// The counts of rows with their names.
    #[must_use]
    pub const fn named(&self) -> [(&'static str, u64); 6] {
        [
            ("rows", self.rows),
            ("pass", self.pass),
            ("fail", self.fail),
            ("indeterminate", self.indeterminate),
            ("unjudged", self.unjudged),
            ("rejected", self.rejected),
        ]
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.rows += other.rows;
        self.pass += other.pass;
        self.fail += other.fail;
        self.fail_by_status += other.fail_by_status;
        self.indeterminate += other.indeterminate;
        self.unjudged += other.unjudged;
        self.rejected += other.rejected;
        self.blank_lines += other.blank_lines;
        self.meshed += other.meshed;
    }

    /// Counts a verdict.
    #[inline]
    pub(super) fn judge(&mut self, verdict: Option<Verdict>) {
        match verdict {
            Some(Verdict::Pass) => self.pass += 1,
            Some(Verdict::Fail) => self.fail += 1,
            Some(Verdict::Indeterminate) => self.indeterminate += 1,
            None => self.unjudged += 1,
        }
    }
}

/// Where a row is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowPlace {
    /// The table.
    pub file: Arc<str>,
    /// The line on which its record starts, from 1.
    pub line: u64,
    /// Its record, from 1 below the header.
    pub record: u64,
    /// In words, for tables without lines.
    pub in_words: Option<String>,
}

/// `parts.csv:17`, or as the table calls it.
impl fmt::Display for RowPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.in_words {
            Some(place) => write!(f, "{}, {place}", self.file),
            None => write!(f, "{}:{}", self.file, self.line),
        }
    }
}

/// A row that makes no part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Where it is.
    pub place: RowPlace,
    /// The name of the part, if it has one.
    pub part: Option<String>,
    /// The column, by its name in the header.
    pub column: Option<String>,
    /// What stands there, shortened.
    pub text: String,
    /// What is wrong with it.
    pub message: String,
}

impl Problem {
    /// What is wrong, with the text where the message does not have it.
    #[must_use]
    pub fn what(&self) -> String {
        let column = self.column.as_ref().map(|column| format!(", column `{column}`")).unwrap_or_default();
        let part = self.part.as_ref().map(|part| format!(" (part {part})")).unwrap_or_default();
        let message = format!("record {}{part}{column}: {}", self.place.record, self.message);
        if self.text.is_empty() || self.message.contains(&self.text) {
            message
        } else {
            format!("{message}: `{}`", self.text)
        }
    }
}

/// `file:line: error[bad-row]: record, column: what is wrong`, on one line.
impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: error[{}]: {}", self.place, Code::BadRow, self.what())
    }
}

/// A part that is worth a look.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Its name.
    pub id: String,
    /// Where its row is.
    pub place: RowPlace,
    /// The verdict.
    pub verdict: Option<Verdict>,
    /// How far it is inside the nearest limit, mm; negative outside. Without limits, how far its largest ΔCD
    /// is below 0.
    pub margin_mm: f64,
    /// The limit that is nearest, or broken most.
    pub on: Option<LimitTarget>,
    /// The result that is held against that limit, mm.
    pub result_mm: (f64, f64),
    /// Why it does not pass, or has no verdict.
    pub reason: Option<String>,
    /// Who judges its errors together.
    pub judged_by: JudgedBy,
    /// Its errors; none of a part whose teeth are known.
    pub errors: Vec<PartError>,
    /// What a yoke does on it, if the spec has one.
    pub yoke: Option<Arc<JudgedYoke>>,
    /// Whether its status rejects it.
    pub is_rejected: bool,
    /// Whether it fails by its status or a limit on its yoke, and breaks none on ΔCD.
    pub fails_otherwise: bool,
}

/// An error of a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartError {
    /// The kind of error.
    pub kind: DeviationKind,
    /// The deviation that is evaluated; of a tolerance, the end farther from 0.
    pub deviation: DeviationValue,
    /// The tolerance that every part keeps, where none was measured.
    pub tolerance: Option<ToleranceEnds>,
    /// Whether the spec gives it for every part, in place of a measurement.
    pub of_every_part: bool,
    /// The nominal value that it is the distance to; `None` where deviations were measured.
    pub nominal: Option<DeviationValue>,
    /// Its ΔCD.
    pub delta_cd: Length,
    /// How far that is inside its own limit.
    pub margin: Option<Length>,
}

impl Part {
    /// Whether it fails, or is too near a limit.
    #[must_use]
    pub fn is_not_passed(&self) -> bool {
        matches!(self.verdict, Some(Verdict::Fail | Verdict::Indeterminate))
    }

    /// How bad it is.
    pub(super) fn badness(&self) -> Badness {
        badness(self.verdict, self.fails_otherwise, self.margin_mm)
    }
}

/// How bad a part is, the lesser the worse: its rank, and its margin in mm.
pub(super) type Badness = (u8, f64);

/// Parts outside a limit on ΔCD, and those without a result, come before those that fail otherwise, and these before all others.
#[inline]
pub(super) fn badness(verdict: Option<Verdict>, fails_otherwise: bool, margin_mm: f64) -> Badness {
    let rank = match verdict {
        _ if fails_otherwise => 1,
        Some(Verdict::Fail) => 0,
        _ => u8::from(margin_mm > f64::NEG_INFINITY) * 2,
    };
    (rank, margin_mm)
}

/// Takes every part that is wanted, and every row that makes no part.
pub trait PartSink: Send {
    /// Takes the next parts and rows.
    ///
    /// # Errors
    /// If they cannot be written.
    fn take(&mut self, parts: &[Part], problems: &[Problem]) -> io::Result<()>;
}

/// A result over all parts.
#[derive(Debug, Clone)]
pub struct Quantity {
    /// Its name.
    pub name: String,
    /// The limit with which it is compared. Of the two ends of a combination, the upper one stands last.
    pub on: Option<LimitTarget>,
    /// The lower and the upper limit on the quantity, mm.
    pub limits: (Option<f64>, Option<f64>),
    /// Which end of a range it is: that end is compared with the limit on its side.
    pub(super) end: Option<End>,
    /// Its statistics.
    pub statistics: Statistics,
}

impl Quantity {
    /// A result without a value so far, and its limit.
    pub(super) fn new(name: String, on: Option<LimitTarget>, limit: Option<&Limit>, end: Option<End>) -> Self {
        let ends = |limit: &Limit| (limit.lower.map(Length::mm), limit.upper.map(Length::mm));
        let new = Self { name, on, limits: limit.map_or((None, None), ends), end, statistics: Statistics::default() };
        // only a result with a limit has a capability
        if new.is_limited() { Self { statistics: Statistics::of_kept_values(), ..new } } else { new }
    }

    /// The limits with which it is compared, mm: for the end of a range the one on its side.
    #[must_use]
    pub fn own_limits(&self) -> (Option<f64>, Option<f64>) {
        match self.end {
            Some(End::Lower) => (self.limits.0, None),
            Some(End::Upper) => (None, self.limits.1),
            None => self.limits,
        }
    }

    /// Whether it has a limit.
    #[must_use]
    pub fn is_limited(&self) -> bool {
        self.own_limits() != (None, None)
    }
}

/// The outcome of a batch.
#[derive(Debug, Clone, Default)]
pub struct Outcome {
    /// The counts.
    pub counts: Counts,
    /// The first rejected rows.
    pub problems: Vec<Problem>,
    /// The first parts that did not pass.
    pub failures: Vec<Part>,
    /// The parts nearest to their limits, or furthest outside, the worst first.
    pub worst: Vec<Part>,
    /// The results that have statistics.
    pub quantities: Vec<Quantity>,
    /// The plug settings of the parts, where it is known which of them keep the window.
    pub settings: Settings,
    /// How each table was read.
    pub readings: Vec<Reading>,
    /// Remarks on the spec and the tables: what was left out, what was assumed.
    pub notes: Vec<String>,
    /// Part names that appear more than once.
    pub duplicates: Duplicates,
    /// Whether the run was ended before the end of the input, by the user.
    pub interrupted: bool,
    /// Whether the run ended before the end of a table, because it could not be read further, or at the first rejected row.
    pub is_cut: bool,
    /// The first contradiction for which a table is not accepted, in words.
    pub contradiction: Option<String>,
    /// Bytes read, after unpacking.
    pub bytes: u64,
}

impl Outcome {
    /// Why the run does not speak for all parts, if it does not.
    #[must_use]
    pub fn why_incomplete(&self) -> Option<&str> {
        if self.interrupted {
            Some("the run was interrupted: later parts were not checked")
        } else if let Some(contradiction) = &self.contradiction {
            Some(contradiction)
        } else {
            self.is_cut.then_some("a table was not read to its end: not all parts were checked")
        }
    }

    /// Adds the warning on repeated part names to the last table's reading, where warnings stand, and a note if not all names were
    /// checked.
    pub fn tell_duplicates(&mut self) {
        let warned = self.readings.last_mut().filter(|_| self.duplicates.count > 0);
        let notes = warned.map_or(&mut self.notes, |reading| &mut reading.notes);
        notes.extend(self.duplicates.note());
    }
}

/// The outcome of one chunk.
#[derive(Debug, Default)]
pub(super) struct Tally {
    pub(super) counts: Counts,
    pub(super) problems: Vec<Problem>,
    /// Parts that do not pass, or every part where they are listed.
    pub(super) parts: Vec<Part>,
    pub(super) worst: Vec<Part>,
    /// How many values of each source are suspicious.
    pub(super) doubted: [u64; KINDS],
    /// Whether the names of the parts are still checked.
    pub(super) has_names: bool,
    /// The settings of the parts' plug.
    pub(super) settings: Settings,
    /// One per result with a limit, where statistics are kept.
    pub(super) moving: Vec<MovingRange>,
}

impl Tally {
    /// Empties it for the next chunk, in which so many results are followed from part to part.
    pub(super) fn clear(&mut self, followed: usize) {
        *self = Self { moving: vec![MovingRange::default(); followed], ..Self::default() };
    }
}

/// The counts of one table while it is read, and of all of them.
pub(super) struct Total<'a> {
    pub(super) outcome: &'a mut Outcome,
    pub(super) followed: &'a [(usize, Output)],
    /// Records before the next piece.
    pub(super) records: u64,
    pub(super) place: Place,
    /// Records that are no parts.
    pub(super) asides: Vec<AsideReading>,
    /// Lines that rules leave out and that could be parts.
    pub(super) doubtful: Doubtful,
    /// Rejected rows that are perhaps no parts.
    pub(super) odd: OddRows,
    /// The rules of the table's contract, with what each left out so far.
    pub(super) left_out: Vec<LeftOut>,
    /// How many values of each source are suspicious.
    pub(super) doubted: [u64; KINDS],
    pub(super) request: &'a Request,
}

impl Total<'_> {
    /// Takes the next block with its outcome; record numbers of the block become those of the table.
    pub(super) fn add(
        &mut self,
        rows: &Rows,
        block: &mut Block,
        tally: &mut Tally,
        list: Option<&mut (dyn PartSink + '_)>,
    ) -> io::Result<()> {
        let (records, request) = (self.records, self.request);
        self.doubtful.add(rows, block);
        self.odd.add(block);
        let settle = |place: &mut RowPlace| {
            place.record += records;
            place.in_words = self.place.in_words(place.line);
        };
        tally.problems.iter_mut().for_each(|problem| settle(&mut problem.place));
        tally.parts.iter_mut().for_each(|part| settle(&mut part.place));
        let listed = list.map_or(Ok(()), |list| list.take(&tally.parts, &tally.problems));
        let room = request.problems_kept.saturating_sub(self.outcome.problems.len());
        self.outcome.problems.extend(tally.problems.drain(..).take(room));
        let room = request.failures_kept.saturating_sub(self.outcome.failures.len());
        self.outcome.failures.extend(tally.parts.drain(..).filter(Part::is_not_passed).take(room));
        for mut part in tally.worst.drain(..) {
            settle(&mut part.place);
            keep_worst(&mut self.outcome.worst, part.badness(), || part);
        }
        for ((index, _), next) in self.followed.iter().zip(&tally.moving) {
            self.outcome.quantities[*index].statistics.moving.join(next);
        }
        let room = ASIDES_KEPT - self.asides.len();
        self.asides.extend(block.asides.drain(..).take(room));
        for (doubted, more) in self.doubted.iter_mut().zip(tally.doubted) {
            *doubted += more;
        }
        join_left_out(&mut self.left_out, &block.left_out);
        if tally.has_names {
            self.outcome.duplicates.add((0..block.rows()).filter_map(|row| block.name_bytes(row)));
        }
        self.records += block.record_count;
        self.outcome.counts.add(&tally.counts);
        self.outcome.settings.merge(&tally.settings);
        listed
    }
}

/// Parts that are kept as the worst.
const WORST_KEPT: usize = 10;

/// Whether a part that is this bad is one of the worst; of equals the first stays.
#[inline]
pub(super) fn may_be_worst(worst: &[Part], badness: Badness) -> bool {
    worst.get(WORST_KEPT - 1).is_none_or(|last| last.badness() > badness)
}

/// Adds a part that is this bad to the worst if it is one; of equals the first stays.
#[inline]
pub(super) fn keep_worst(worst: &mut Vec<Part>, badness: Badness, part: impl FnOnce() -> Part) {
    if !may_be_worst(worst, badness) {
        return;
    }
    worst.truncate(WORST_KEPT - 1);
    worst.insert(worst.partition_point(|other| other.badness() <= badness), part());
}
