//! One row after another: fields to deviations, deviations to results, results to text and counts.
//!
//! A worker has an [`Evaluator`] and gives it chunks. A line of plain numbers is read in one pass; every other record is
//! split into its fields first. What follows from the deviations is the same for both, and for `eval`.

use std::sync::Arc;

use super::buffer::Buffer;
use super::chunk::{Holds, LONGEST_RECORD};
use super::input::text;
use super::layout::{Layout, Role};
use super::outcome::{Kept, Part, Problem, Tally, WORST, keep_worst};
use super::plan::Plan;
use super::results::{KINDS, Margin, Results, spread_of};
use super::split::{Field, Record, next_record};
use super::statistics::Statistics;
use super::uncertain::RowUncertainty;
use crate::decision::Verdict;
use crate::decision::uncertainty::Spreads;
use crate::deviation::{ErrorKind, ErrorValue};
use crate::quantity::{Decimal, shown};

/// Some records of a table.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub(super) bytes: Vec<u8>,
    /// The number of the first record, from 1; only where parts have no name.
    pub(super) first_record: u64,
}

/// Where a row is within its chunk, and its name.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    /// The chunk.
    pub(super) bytes: &'a [u8],
    /// Where the row starts in it, and where the next one does.
    start: usize,
    next: usize,
    pub(super) record: u64,
    pub(super) line: u64,
    pub(super) id: Option<Field>,
}

/// Why a row makes no part.
#[derive(Default)]
struct Refusal {
    message: String,
    /// The text that is wrong, if it is one.
    text: Vec<u8>,
    /// The column that is to blame, by its index, if one is.
    column: Option<usize>,
}

/// Evaluates the rows of chunks.
pub(super) struct Evaluator<'a> {
    pub(super) plan: &'a Plan,
    pub(super) layout: &'a Layout,
    file: Arc<str>,
    /// The rows to write.
    pub(super) out: Buffer,
    /// The rejected rows as they are.
    pub(super) rejects: Vec<u8>,
    pub(super) tally: Tally,
    pub(super) statistics: Vec<Statistics>,
    pub(super) fields: Vec<Field>,
    pub(super) scratch: Vec<u8>,
    deviations: [ErrorValue; KINDS],
    /// Whether rejected rows are kept at all.
    keeps_rejects: bool,
}

impl<'a> Evaluator<'a> {
    pub(super) fn new(plan: &'a Plan, layout: &'a Layout, file: &Arc<str>, keeps_rejects: bool) -> Self {
        let quantities = if plan.request.statistics { plan.quantities().count() } else { 0 };
        Self {
            plan,
            layout,
            file: Arc::clone(file),
            out: Buffer::default(),
            rejects: Vec::new(),
            tally: Tally::default(),
            statistics: vec![Statistics::default(); quantities],
            fields: Vec::new(),
            scratch: Vec::new(),
            deviations: [ErrorValue::zero(ErrorKind::RackOverRoller); KINDS],
            keeps_rejects,
        }
    }

    /// Evaluates a chunk; what came out of the last one is forgotten.
    pub(super) fn chunk(&mut self, chunk: &Chunk, holds: Holds) {
        self.out.truncate(0);
        self.rejects.clear();
        self.tally.clear(self.plan.followed.len());
        match holds {
            Holds::Records { plain } => self.records(chunk, plain),
            Holds::Piece { first, last } => self.piece(chunk, first, last),
        }
    }

    fn records(&mut self, chunk: &Chunk, plain: bool) {
        let bytes = chunk.bytes.as_slice();
        let mut at = 0;
        while at < bytes.len() {
            if self.plan.request.strict && self.tally.counts.rejected > 0 {
                return;
            }
            let record = self.tally.counts.rows + 1;
            if plain && let Some((id, next)) = self.plain_row(bytes, at) {
                self.tally.counts.rows += 1;
                self.tally.lines += 1;
                self.part(Row { bytes, start: at, next, record, line: self.tally.lines, id }, chunk.first_record);
                at = next;
                continue;
            }
            let mut fields = std::mem::take(&mut self.fields);
            let mut blank = 0;
            let found = next_record(bytes, at, self.layout.separator, &mut fields, &mut blank);
            self.fields = fields;
            self.tally.counts.blank_lines += blank;
            let Some(found) = found else {
                self.tally.lines += blank;
                return;
            };
            self.tally.counts.rows += 1;
            self.general_row(bytes, found, record, chunk.first_record);
            self.tally.lines += found.lines;
            at = found.next;
        }
    }

    /// Reads the line at `at` if it is made of as many fields as the header, with plain numbers where values
    /// are read: the deviations, the part's name, and the next line's place.
    #[inline]
    fn plain_row(&mut self, bytes: &[u8], at: usize) -> Option<(Option<Field>, usize)> {
        let layout = self.layout;
        let copies = !layout.copied.is_empty();
        let last = layout.roles.len() - 1;
        let mut at = at;
        let mut id = None;
        // a line without a character is no record
        if matches!(bytes[at], b'\n' | b'\r') {
            return None;
        }
        if copies {
            self.fields.clear();
        }
        for (index, role) in layout.roles.iter().enumerate() {
            let start = at;
            if let Role::Value(value) = *role {
                let column = &layout.columns[value];
                let (number, end) = Decimal::plain(bytes, at, layout.mark)?;
                self.deviations[value] = column.plain(number)?;
                at = end;
            } else {
                while let Some(&byte) = bytes.get(at) {
                    if byte == layout.separator || byte == b'\n' || byte == b'\r' {
                        break;
                    }
                    at += 1;
                }
                if *role == Role::Id {
                    id = Some(Field { start, end: at, quoted: false });
                }
            }
            if copies {
                self.fields.push(Field { start, end: at, quoted: false });
            }
            if index < last {
                if bytes.get(at) != Some(&layout.separator) {
                    return None;
                }
                at += 1;
            }
        }
        match bytes.get(at) {
            Some(b'\n') => Some((id, at + 1)),
            Some(b'\r') if bytes.get(at + 1) == Some(&b'\n') => Some((id, at + 2)),
            None => Some((id, at)),
            Some(_) => None,
        }
    }

    /// A row of any kind, with its fields found.
    fn general_row(&mut self, bytes: &[u8], found: Record, record: u64, first_record: u64) {
        let line = self.tally.lines + found.lines_before + 1;
        let mut row = Row { bytes, start: found.start, next: found.next, record, line, id: None };
        if found.open {
            let message = "a quote is not closed, so the rest of the table is in one field".to_owned();
            return self.reject(row, Refusal { message, ..Refusal::default() });
        }
        if self.fields.len() != self.layout.roles.len() {
            let message =
                format!("the row has {} fields and the header has {}", self.fields.len(), self.layout.roles.len());
            let text = bytes[found.start..found.end].to_vec();
            return self.reject(row, Refusal { message, text, column: None });
        }
        let mut scratch = std::mem::take(&mut self.scratch);
        for (index, column) in self.layout.columns.iter().enumerate() {
            let content = self.fields[column.field].content(bytes, &mut scratch).trim_ascii();
            match column.read(&text(content), self.layout.mark) {
                Ok(value) => self.deviations[index] = value,
                Err(message) => {
                    let refusal = Refusal { message, text: content.to_vec(), column: Some(index) };
                    self.scratch = scratch;
                    return self.reject(row, refusal);
                }
            }
        }
        self.scratch = scratch;
        row.id = self.layout.id.map(|id| self.fields[id]);
        self.part(row, first_record);
    }

    /// Evaluates, writes and counts the part with these deviations, or rejects its row.
    #[inline]
    fn part(&mut self, row: Row<'_>, first_record: u64) {
        if let Err(refusal) = self.evaluate(row, first_record) {
            self.reject(row, refusal);
        }
    }

    #[inline]
    fn evaluate(&mut self, row: Row<'_>, first_record: u64) -> Result<(), Refusal> {
        let plan = self.plan;
        let refused = |message: String| Refusal { message, ..Refusal::default() };
        let results = Results::new(plan, &self.deviations).map_err(|none| {
            let kind = none.source.map(|source| plan.sources[source].law.kind());
            let name = kind.map_or("combination", ErrorKind::name);
            Refusal { message: format!("{name}: {}", none.problem), text: Vec::new(), column: none.source }
        })?;
        let uncertainty = match &plan.uncertain {
            Some(uncertain) => {
                let known = uncertain.of_row(&plan.sources, &self.deviations, &results, &plan.limits);
                Some(known.map_err(|error| refused(error.to_string()))?)
            }
            None => None,
        };
        let verdict = results.judge(plan, uncertainty.as_ref()).map_err(|error| refused(error.to_string()))?;
        if plan.request.rows.has(verdict) {
            self.write_row(row, first_record, &results, uncertainty.as_ref(), verdict);
        }
        self.tally.counts.judge(verdict);
        if plan.request.statistics {
            self.count(&results, uncertainty.as_ref());
            let margin = results.margin(plan);
            let full = self.tally.worst.len() == WORST;
            if !full || self.tally.worst.last().is_some_and(|last| margin.inside_by < last.margin) {
                let part = self.kept(row, first_record, verdict, margin);
                keep_worst(&mut self.tally.worst, Kept { part, margin: margin.inside_by });
            }
        }
        if self.keeps_failure(verdict) {
            let part = self.kept(row, first_record, verdict, results.margin(plan));
            self.tally.failures.push(part);
        }
        Ok(())
    }

    /// Takes the results into the statistics.
    fn count(&mut self, results: &Results, uncertainty: Option<&RowUncertainty>) {
        for (statistics, output) in self.statistics.iter_mut().zip(self.plan.quantities()) {
            statistics.add(results.of(output));
        }
        for (moving, (_, output)) in self.tally.moving.iter_mut().zip(&self.plan.followed) {
            moving.add(results.of(output));
        }
        if let Some(known) = uncertainty {
            self.add_gauge(&known.spreads);
        }
    }

    /// Adds what measuring contributes to the variance of each result.
    fn add_gauge(&mut self, spreads: &Spreads) {
        for (statistics, output) in self.statistics.iter_mut().zip(self.plan.quantities()) {
            if let Some(of) = self.plan.spread_of(output) {
                statistics.add_gauge(spread_of(spreads, of).gauge_mm2);
            }
        }
    }

    fn keeps_failure(&self, verdict: Option<Verdict>) -> bool {
        let kept = self.plan.request.failures_kept;
        kept > 0 && matches!(verdict, Some(Verdict::Fail | Verdict::Indeterminate)) && self.tally.failures.len() < kept
    }

    /// A part as it is kept for the summary.
    fn kept(&self, row: Row<'_>, first_record: u64, verdict: Option<Verdict>, margin: Margin) -> Part {
        Part {
            id: Self::id(row, first_record),
            file: Arc::clone(&self.file),
            line: row.line,
            record: row.record,
            place: None,
            verdict,
            margin_mm: margin.inside_by.mm(),
            on: margin.on,
            result_mm: (margin.result.0.mm(), margin.result.1.mm()),
        }
    }

    /// The part's name, or the number of its record.
    fn id(row: Row<'_>, first_record: u64) -> String {
        match row.id {
            Some(field) => text(field.content(row.bytes, &mut Vec::new())).into_owned(),
            None => (first_record + row.record - 1).to_string(),
        }
    }

    /// Counts a row that makes no part, and keeps it as it is.
    fn reject(&mut self, row: Row<'_>, refusal: Refusal) {
        self.tally.counts.rejected += 1;
        if self.keeps_rejects {
            self.rejects.extend_from_slice(&row.bytes[row.start..row.next]);
            if !self.rejects.ends_with(b"\n") && !self.rejects.ends_with(b"\r") {
                self.rejects.push(b'\n');
            }
        }
        let column = refusal.column.map(|column| self.layout.columns[column].name.clone());
        self.problem(row.record, row.line, column, &refusal.text, refusal.message);
    }

    fn problem(&mut self, record: u64, line: u64, column: Option<String>, content: &[u8], message: String) {
        if self.tally.problems.len() < self.plan.request.problems_kept {
            let (file, text) = (Arc::clone(&self.file), shown(&text(content)));
            self.tally.problems.push(Problem { file, line, record, place: None, column, text, message });
        }
    }

    /// A piece of a record that is too long: one rejected row, however many pieces.
    fn piece(&mut self, chunk: &Chunk, first: bool, last: bool) {
        if first {
            self.tally.counts.rows += 1;
            self.tally.counts.rejected += 1;
            let limit = LONGEST_RECORD >> 10;
            let message =
                format!("the row is longer than {limit} KiB: a quote may not be closed, or a line end missing");
            let start = chunk.bytes[..chunk.bytes.len().min(200)].to_vec();
            self.problem(1, 1, None, &start, message);
        }
        if self.keeps_rejects {
            self.rejects.extend_from_slice(&chunk.bytes);
            if last && !self.rejects.ends_with(b"\n") && !self.rejects.ends_with(b"\r") {
                self.rejects.push(b'\n');
            }
        }
        self.tally.lines = memchr::memchr_iter(b'\n', &chunk.bytes).count() as u64;
    }
}
