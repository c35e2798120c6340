//! One row after another: fields to deviations, deviations to results, results to text and counts.
//!
//! A worker has an [`Evaluator`] and gives it chunks. Each row takes the fast way (integers of 1e-15 mm, each
//! result with a bound on its error) as far as that decides every digit and verdict; else the exact way,
//! which is that of `eval`.

use std::sync::Arc;

use super::buffer::Buffer;
use super::chunk::{Holds, LONGEST_RECORD};
use super::input::text;
use super::layout::{Layout, Role};
use super::number::read;
use super::outcome::{Kept, Part, Problem, Tally, WORST, keep_worst};
use super::plan::Plan;
use super::results::{Judgement, KINDS, Results, exact_result, fixed, spread_of};
use super::split::{Field, Record, next_record};
use super::statistics::Statistics;
use super::uncertain::Known;
use crate::decision::uncertainty::Spreads;
use crate::decision::{Evaluation, LimitTarget, Rule, Verdict, evaluate};
use crate::deviation::ErrorValue;
use crate::formula::{Fixed, PartError};
use crate::quantity::shown;

/// Some records of a table.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub(super) bytes: Vec<u8>,
    /// The number of the first record, from 1; only where parts have no name.
    pub(super) first_record: u64,
}

/// Where a row is within its chunk, and its name and copied fields.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) record: u64,
    pub(super) line: u64,
    pub(super) id: Option<Field>,
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
    deviations: [i64; KINDS],
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
            deviations: [0; KINDS],
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
            if plain && let Some((id, next)) = self.fast_row(bytes, at) {
                let row = Row { bytes, record, line: self.tally.lines + 1, id };
                self.tally.counts.rows += 1;
                self.tally.lines += 1;
                self.tally.work.fields += self.layout.columns.len() as u64;
                if !self.fast_part(row, chunk.first_record) {
                    let values = (0..self.layout.columns.len()).map(|column| self.exact_deviation(column)).collect();
                    self.exact_part(row, chunk.first_record, values, at..next);
                }
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
    fn fast_row(&mut self, bytes: &[u8], at: usize) -> Option<(Option<Field>, usize)> {
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
                let (decimal, end) = read(bytes, at, layout.mark)?;
                self.deviations[value] = column.scale.integer(decimal)?.checked_sub(column.nominal?)?;
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
        let raw = found.start..found.next;
        if found.open {
            let message = "a quote is not closed, so the rest of the table is in one field";
            return self.reject(bytes, raw, record, line, None, b"", message.to_owned());
        }
        if self.fields.len() != self.layout.roles.len() {
            let message =
                format!("the row has {} fields and the header has {}", self.fields.len(), self.layout.roles.len());
            let text = bytes[found.start..found.end].to_vec();
            return self.reject(bytes, raw, record, line, None, &text, message);
        }
        let mut values = Vec::new();
        let mut scratch = std::mem::take(&mut self.scratch);
        for (index, column) in self.layout.columns.iter().enumerate() {
            let content = self.fields[column.field].content(bytes, &mut scratch).trim_ascii();
            if values.is_empty()
                && let Some(integer) = column.integer(content, self.layout.mark)
            {
                self.deviations[index] = integer;
                continue;
            }
            // the first value that is no plain number: the row takes the exact way
            while values.len() < index {
                values.extend(self.exact_deviation(values.len()));
            }
            match column.exact(&text(content), &self.plan.sources[index].reading, self.layout.mark) {
                Ok(value) => values.push(value),
                Err(message) => {
                    let name = column.name.clone();
                    let content = content.to_vec();
                    self.scratch = scratch;
                    return self.reject(bytes, raw, record, line, Some(name), &content, message);
                }
            }
        }
        self.scratch = scratch;
        self.tally.work.fields += self.layout.columns.len() as u64;
        let id = self.layout.id.map(|id| self.fields[id]);
        let row = Row { bytes, record, line, id };
        if values.is_empty() {
            if self.fast_part(row, first_record) {
                return;
            }
            values = (0..self.layout.columns.len()).filter_map(|column| self.exact_deviation(column)).collect();
        }
        self.exact_part(row, first_record, values.into_iter().map(Some).collect(), raw);
    }

    fn exact_deviation(&self, column: usize) -> Option<ErrorValue> {
        self.layout.columns[column].deviation(self.deviations[column])
    }

    /// Evaluates the part with these deviations, if the fast way decides everything about it.
    #[inline]
    fn fast_part(&mut self, row: Row<'_>, first_record: u64) -> bool {
        let Some(results) = Results::new(self.plan, self.layout, &self.deviations) else { return false };
        if self.plan.uncertain.is_some() {
            return self.uncertain_part(row, first_record, &results);
        }
        let Judgement::Known(verdict) = results.judge(self.plan) else { return false };
        self.settle(row, first_record, &results, None, verdict)
    }

    /// The same for a part with its uncertainties.
    #[inline(never)]
    fn uncertain_part(&mut self, row: Row<'_>, first_record: u64, results: &Results) -> bool {
        let plan = self.plan;
        if plan.uncertain.as_ref().is_some_and(|uncertain| uncertain.monte_carlo.is_some()) {
            return false;
        }
        let Some(spreads) = results.spreads(plan, self.layout, &self.deviations) else { return false };
        let judgement = match plan.request.rule {
            Rule::Iso14253 => results.judge_iso_14253(plan, &spreads),
            _ => results.judge(plan),
        };
        let Judgement::Known(verdict) = judgement else { return false };
        self.settle(row, first_record, results, Some(&spreads), verdict)
    }

    /// Writes and counts a part; `false`, and nothing done, if a digit takes exact arithmetic.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a call for each row costs a twentieth of all it takes")]
    fn settle(
        &mut self,
        row: Row<'_>,
        first_record: u64,
        results: &Results,
        spreads: Option<&Spreads>,
        verdict: Option<Verdict>,
    ) -> bool {
        let plan = self.plan;
        if plan.request.rows.has(verdict) {
            let mark = self.out.mark();
            if !self.write_row(row, first_record, results, spreads, verdict) {
                self.out.truncate(mark);
                return false;
            }
        }
        self.tally.counts.judge(verdict);
        self.tally.work.results += plan.results_per_part;
        if plan.request.statistics {
            for (statistics, output) in self.statistics.iter_mut().zip(plan.quantities()) {
                statistics.add(results.of(output).units);
            }
            for (moving, (_, output)) in self.tally.moving.iter_mut().zip(&plan.followed) {
                moving.add(results.of(output).units);
            }
            if let Some(spreads) = spreads {
                self.add_gauge(spreads);
            }
            let (margin, on, result) = results.margin(self.plan);
            let full = self.tally.worst.len() == WORST;
            if !full || self.tally.worst.last().is_some_and(|last| margin < last.margin) {
                let part = self.part(row, first_record, verdict, margin, on, result);
                keep_worst(&mut self.tally.worst, Kept { part, margin });
            }
        }
        if self.keeps_failure(verdict) {
            let (margin, on, result) = results.margin(self.plan);
            let part = self.part(row, first_record, verdict, margin, on, result);
            self.tally.failures.push(part);
        }
        true
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

    fn part(
        &self,
        row: Row<'_>,
        first_record: u64,
        verdict: Option<Verdict>,
        margin: i128,
        on: Option<LimitTarget>,
        (lower, upper): (Fixed, Fixed),
    ) -> Part {
        #[expect(clippy::cast_precision_loss, reason = "mm with 16 digits")]
        let mm = |units: i128| units as f64 / Fixed::PER_MM as f64;
        Part {
            id: Self::id(row, first_record),
            file: Arc::clone(&self.file),
            line: row.line,
            record: row.record,
            place: None,
            verdict,
            margin_mm: mm(margin),
            on,
            result_mm: (mm(i128::from(lower.units)), mm(i128::from(upper.units))),
        }
    }

    /// The part's name, or the number of its record.
    fn id(row: Row<'_>, first_record: u64) -> String {
        match row.id {
            Some(field) => text(field.content(row.bytes, &mut Vec::new())).into_owned(),
            None => (first_record + row.record - 1).to_string(),
        }
    }

    /// Evaluates the part exactly, as `eval` does.
    fn exact_part(
        &mut self,
        row: Row<'_>,
        first_record: u64,
        values: Vec<Option<ErrorValue>>,
        raw: std::ops::Range<usize>,
    ) {
        let plan = self.plan;
        self.tally.work.exact += 1;
        let errors: Option<Vec<PartError>> =
            plan.sources.iter().zip(values).map(|(source, value)| source.formula.formula().of(&value?)).collect();
        let evaluated = match errors {
            Some(errors) => self.evaluated(&errors),
            None => Err((None, "a value is beyond the range of double-precision numbers".to_owned())),
        };
        let (evaluation, known) = match evaluated {
            Ok(evaluated) => evaluated,
            Err((column, message)) => {
                return self.reject(row.bytes, raw, row.record, row.line, column, b"", message);
            }
        };
        let verdict = match evaluation.verdict {
            Some(Verdict::Pass | Verdict::Indeterminate) if !plan.unjudged.is_empty() => None,
            verdict => verdict,
        };
        if plan.request.rows.has(verdict) {
            self.write_exact_row(row, first_record, &evaluation, known.as_ref(), verdict);
        }
        self.tally.counts.judge(verdict);
        self.tally.work.results += plan.results_per_part;
        let wants_part = plan.request.statistics || self.keeps_failure(verdict);
        if !wants_part {
            return;
        }
        let results = Results::rounded(&evaluation, plan);
        if plan.request.statistics {
            for (index, output) in plan.quantities().enumerate() {
                match exact_result(&evaluation, plan, output).and_then(fixed) {
                    Some(units) => self.statistics[index].add(units),
                    None => self.statistics[index].add_beyond(),
                }
            }
            for (moving, (_, output)) in self.tally.moving.iter_mut().zip(&plan.followed) {
                moving.add(results.of(output).units);
            }
            if let Some(known) = &known {
                self.add_gauge(&known.spreads);
            }
        }
        let (margin, on, result) = results.margin(self.plan);
        let part = self.part(row, first_record, verdict, margin, on, result);
        if self.keeps_failure(verdict) {
            self.tally.failures.push(part.clone());
        }
        if plan.request.statistics {
            keep_worst(&mut self.tally.worst, Kept { part, margin });
        }
    }

    /// Evaluates errors exactly, with their uncertainties where these are needed; else the column that is to blame, if
    /// one is, and what is wrong.
    fn evaluated(&self, errors: &[PartError]) -> Result<(Evaluation, Option<Known>), (Option<String>, String)> {
        let plan = self.plan;
        let mut evaluation = evaluate(errors, &plan.limits, plan.model, plan.stack).map_err(|error| {
            let column = error.error.and_then(|kind| plan.sources.iter().position(|source| source.kind == kind));
            (column.map(|column| self.layout.columns[column].name.clone()), error.to_string())
        })?;
        let known = plan.uncertain.as_ref();
        let known = known.map(|uncertain| uncertain.exact(errors, plan.model, plan.stack, &plan.limits));
        let known = known.transpose().map_err(|error| (None, error.to_string()))?;
        if known.is_some() || plan.request.rule != Rule::Simple {
            let simulated = known.as_ref().and_then(|known| known.simulation.as_ref());
            let inside = simulated.map(|simulation| simulation.outcome.inside.as_slice());
            let decided =
                evaluation.decide_by(&plan.request.rule, known.as_ref().map(|known| &known.propagation), inside);
            decided.map_err(|error| (None, error.to_string()))?;
        }
        Ok((evaluation, known))
    }

    /// Counts a row that makes no part, and keeps it as it is.
    #[expect(clippy::too_many_arguments, reason = "all that there is to say about a row")]
    fn reject(
        &mut self,
        bytes: &[u8],
        raw: std::ops::Range<usize>,
        record: u64,
        line: u64,
        column: Option<String>,
        content: &[u8],
        message: String,
    ) {
        self.tally.counts.rejected += 1;
        if self.keeps_rejects {
            self.rejects.extend_from_slice(&bytes[raw]);
            if !self.rejects.ends_with(b"\n") && !self.rejects.ends_with(b"\r") {
                self.rejects.push(b'\n');
            }
        }
        self.problem(record, line, column, content, message);
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
