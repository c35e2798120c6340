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
use super::number::{Decimals, read};
use super::outcome::{Kept, Part, Problem, Tally, WORST, keep_worst};
use super::plan::{Judged, Output, Plan};
use super::request::RowFormat;
use super::split::{Field, Record, next_record};
use super::statistics::Statistics;
use super::write;
use crate::decision::{Evaluation, LimitTarget, Stack, Verdict, evaluate};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::formula::{Fixed, PartError};
use crate::quantity::{Length, Rational};

const KINDS: usize = ErrorKind::ALL.len();

/// Some records of a table.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub(super) bytes: Vec<u8>,
    /// The number of the first record, from 1; only where parts have no name.
    pub(super) first_record: u64,
}

/// The results of one part, as far as some output or limit needs them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Results {
    pub(super) each: [Fixed; KINDS],
    pub(super) lower: Fixed,
    pub(super) upper: Fixed,
    pub(super) worst: Fixed,
    pub(super) rss: Fixed,
}

const ZERO: Fixed = Fixed { units: 0, bound: 0 };

/// A verdict, or that it takes exact arithmetic to tell.
enum Judgement {
    Known(Option<Verdict>),
    Unsure,
}

/// Where a row is within its chunk, and its name and copied fields.
#[derive(Clone, Copy)]
struct Row<'a> {
    bytes: &'a [u8],
    record: u64,
    line: u64,
    id: Option<Field>,
}

/// Evaluates the rows of chunks.
pub(super) struct Evaluator<'a> {
    plan: &'a Plan,
    layout: &'a Layout,
    file: Arc<str>,
    /// The rows to write.
    pub(super) out: Buffer,
    /// The rejected rows as they are.
    pub(super) rejects: Vec<u8>,
    pub(super) tally: Tally,
    pub(super) statistics: Vec<Statistics>,
    fields: Vec<Field>,
    scratch: Vec<u8>,
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
        self.tally.clear();
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
        let Some(results) = self.results() else { return false };
        let Judgement::Known(verdict) = self.judge(&results) else { return false };
        let plan = self.plan;
        if plan.request.rows.has(verdict) {
            let mark = self.out.mark();
            if !self.write_row(row, first_record, &results, verdict) {
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
            let (margin, on, result) = self.margin(&results);
            let full = self.tally.worst.len() == WORST;
            if !full || self.tally.worst.last().is_some_and(|last| margin < last.margin) {
                let part = self.part(row, first_record, verdict, margin, on, result);
                keep_worst(&mut self.tally.worst, Kept { part, margin });
            }
        }
        if self.keeps_failure(verdict) {
            let (margin, on, result) = self.margin(&results);
            let part = self.part(row, first_record, verdict, margin, on, result);
            self.tally.failures.push(part);
        }
        true
    }

    fn keeps_failure(&self, verdict: Option<Verdict>) -> bool {
        let kept = self.plan.request.failures_kept;
        kept > 0 && matches!(verdict, Some(Verdict::Fail | Verdict::Indeterminate)) && self.tally.failures.len() < kept
    }

    /// The results of the deviations; `None` where they are beyond the integers.
    #[inline]
    fn results(&self) -> Option<Results> {
        let plan = self.plan;
        let mut results = Results { each: [ZERO; KINDS], lower: ZERO, upper: ZERO, worst: ZERO, rss: ZERO };
        let mut squares = 0.0;
        let mut bounds = 0;
        for (index, source) in plan.sources.iter().enumerate() {
            let deviation = self.deviations[index];
            let value = if source.kind == ErrorKind::RackLead {
                #[expect(clippy::cast_precision_loss, reason = "one of the three roundings that the bound allows for")]
                source.formula.fixed_from_degrees(deviation as f64 * self.layout.columns[index].degrees)?
            } else {
                source.formula.fixed(deviation)?
            };
            results.each[index] = value;
            bounds += value.bound;
            // sums of five stay below 2⁶³
            if plan.needs_range {
                if source.kind.always_acts() {
                    results.lower.units += value.units;
                    results.lower.bound += value.bound;
                }
                results.upper.units += value.units;
            }
            if plan.needs_worst {
                results.worst.units += value.units.abs();
            }
            if plan.needs_rss {
                #[expect(clippy::cast_precision_loss, reason = "within the bound below")]
                let value = value.units as f64;
                squares += value * value;
            }
        }
        results.upper.bound = bounds;
        results.worst.bound = bounds;
        if plan.needs_rss {
            results.rss = if let [only] = &results.each[..plan.sources.len()] {
                Fixed { units: only.units.abs(), bound: only.bound }
            } else {
                root(squares, bounds)
            };
        }
        Some(results)
    }

    /// Holds the results against the limits.
    #[inline]
    fn judge(&self, results: &Results) -> Judgement {
        let plan = self.plan;
        let mut fails = false;
        for limit in &plan.fixed_limits {
            let (lower, upper) = results.judged(limit.on, plan.stack);
            // each end: surely inside, surely outside, or neither
            if let Some((below, _)) = limit.upper
                && upper.units + upper.bound > below
            {
                if upper.units - upper.bound <= below {
                    return Judgement::Unsure;
                }
                fails = true;
            }
            if let Some((_, above)) = limit.lower
                && lower.units - lower.bound < above
            {
                if lower.units + lower.bound >= above {
                    return Judgement::Unsure;
                }
                fails = true;
            }
        }
        Judgement::Known(if fails {
            Some(Verdict::Fail)
        } else if plan.fixed_limits.is_empty() || !plan.unjudged.is_empty() {
            None
        } else {
            Some(Verdict::Pass)
        })
    }

    /// How far the results are inside the nearest limit (1e-15 mm), which limit that is, and what is held
    /// against it.
    fn margin(&self, results: &Results) -> (i128, Option<LimitTarget>, (Fixed, Fixed)) {
        let plan = self.plan;
        let mut nearest: Option<(i128, Option<LimitTarget>, (Fixed, Fixed))> = None;
        for (limit, (on, _)) in plan.fixed_limits.iter().zip(&plan.limits) {
            let (lower, upper) = results.judged(limit.on, plan.stack);
            let above = limit.upper.map(|(end, _)| i128::from(end) - i128::from(upper.units));
            let below = limit.lower.map(|(_, end)| i128::from(lower.units) - i128::from(end));
            for margin in [above, below].into_iter().flatten() {
                if nearest.as_ref().is_none_or(|(least, ..)| margin < *least) {
                    nearest = Some((margin, Some(*on), (lower, upper)));
                }
            }
        }
        nearest.unwrap_or_else(|| {
            let largest = plan.quantities().map(|output| results.of(output)).max_by_key(|value| value.units.abs());
            let largest = largest.unwrap_or(ZERO);
            (-i128::from(largest.units.abs()), None, (largest, largest))
        })
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
            Some(errors) => evaluate(&errors, &plan.limits, plan.model, plan.stack).map_err(|error| {
                let column = error.error.and_then(|kind| plan.sources.iter().position(|source| source.kind == kind));
                (column.map(|column| self.layout.columns[column].name.clone()), error.to_string())
            }),
            None => Err((None, "a value is beyond the range of double-precision numbers".to_owned())),
        };
        let evaluation = match evaluated {
            Ok(evaluation) => evaluation,
            Err((column, message)) => {
                return self.reject(row.bytes, raw, row.record, row.line, column, b"", message);
            }
        };
        let verdict = match evaluation.verdict {
            Some(Verdict::Pass) if !plan.unjudged.is_empty() => None,
            verdict => verdict,
        };
        if plan.request.rows.has(verdict) {
            self.write_exact_row(row, first_record, &evaluation, verdict);
        }
        self.tally.counts.judge(verdict);
        self.tally.work.results += plan.results_per_part;
        let wants_part = plan.request.statistics || self.keeps_failure(verdict);
        if !wants_part {
            return;
        }
        let results = fixed_results(&evaluation, plan);
        if plan.request.statistics {
            for (index, output) in plan.quantities().enumerate() {
                match exact_result(&evaluation, plan, output).and_then(fixed) {
                    Some(units) => self.statistics[index].add(units),
                    None => self.statistics[index].add_beyond(),
                }
            }
        }
        let (margin, on, result) = self.margin(&results);
        let part = self.part(row, first_record, verdict, margin, on, result);
        if self.keeps_failure(verdict) {
            self.tally.failures.push(part.clone());
        }
        if plan.request.statistics {
            keep_worst(&mut self.tally.worst, Kept { part, margin });
        }
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
            let (file, text) = (Arc::clone(&self.file), shortened(content));
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

    /// Writes the row; `false` if a digit takes exact arithmetic.
    #[inline]
    fn write_row(&mut self, row: Row<'_>, first_record: u64, results: &Results, verdict: Option<Verdict>) -> bool {
        let plan = self.plan;
        let Some(places) = &plan.places else { return false };
        self.out.room(40 * plan.outputs.len() + plan.names_length);
        for (index, output) in plan.outputs.iter().enumerate() {
            self.write_start(index);
            match output {
                Output::Id | Output::Copied(_) | Output::Verdict => {
                    self.write_text(row, first_record, index, verdict);
                    self.out.room(40 * plan.outputs.len() + plan.names_length);
                }
                output => {
                    if !places.write(&mut self.out, results.of(output)) {
                        return false;
                    }
                }
            }
        }
        self.write_end();
        true
    }

    fn write_exact_row(&mut self, row: Row<'_>, first_record: u64, evaluation: &Evaluation, verdict: Option<Verdict>) {
        let plan = self.plan;
        for (index, output) in plan.outputs.iter().enumerate() {
            self.out.room(plan.names_length + 8);
            self.write_start(index);
            match exact_result(evaluation, plan, output) {
                None => self.write_text(row, first_record, index, verdict),
                Some(length) => {
                    let text = match plan.decimals {
                        Decimals::Places(places) => length.exact_mm().to_decimal_text(u16::from(places)),
                        Decimals::Full => crate::report::plain(length.mm()),
                    };
                    self.out.extend(text.as_bytes());
                }
            }
        }
        self.out.room(8);
        self.write_end();
    }

    /// What stands before the value of the column with that index.
    #[inline]
    fn write_start(&mut self, index: usize) {
        match self.plan.format {
            RowFormat::Csv if index > 0 => self.out.byte(b','),
            RowFormat::Tsv if index > 0 => self.out.byte(b'\t'),
            RowFormat::Csv | RowFormat::Tsv => {}
            RowFormat::JsonLines => self.out.extend(&self.plan.json_names[index]),
        }
    }

    #[inline]
    fn write_end(&mut self) {
        if self.plan.format == RowFormat::JsonLines {
            self.out.byte(b'}');
        }
        self.out.byte(b'\n');
    }

    /// The part's name, a copied field, or the verdict.
    fn write_text(&mut self, row: Row<'_>, first_record: u64, index: usize, verdict: Option<Verdict>) {
        let plan = self.plan;
        let field = match &plan.outputs[index] {
            Output::Id => row.id,
            Output::Copied(name) => {
                let earlier = plan.outputs[..index].iter().filter(|output| matches!(output, Output::Copied(_)));
                debug_assert!(!name.is_empty() || self.layout.copied.len() > earlier.clone().count());
                self.layout.copied.get(earlier.count()).and_then(|field| self.fields.get(*field)).copied()
            }
            _ => {
                let name = verdict.map(Verdict::name);
                return match (plan.format, name) {
                    (RowFormat::JsonLines, None) => self.out.extend(b"null"),
                    (RowFormat::JsonLines, Some(name)) => {
                        self.out.extend(b"\"");
                        self.out.extend(name.as_bytes());
                        self.out.extend(b"\"");
                    }
                    (_, name) => self.out.extend(name.unwrap_or("").as_bytes()),
                };
            }
        };
        if let Some(field) = field {
            let mut scratch = std::mem::take(&mut self.scratch);
            write::text(&mut self.out, field.content(row.bytes, &mut scratch), plan.format);
            self.scratch = scratch;
        } else {
            let number = (first_record + row.record - 1).to_string();
            write::text(&mut self.out, number.as_bytes(), plan.format);
        }
    }
}

impl Results {
    /// The result of an output that is a number.
    #[inline]
    fn of(&self, output: &Output) -> Fixed {
        match output {
            Output::Error(source) => self.each[*source],
            Output::RangeLower => self.lower,
            Output::RangeUpper => self.upper,
            Output::WorstCase => self.worst,
            Output::Rss => self.rss,
            Output::Id | Output::Verdict | Output::Copied(_) => ZERO,
        }
    }

    /// The lower and upper end that are held against a limit.
    #[inline]
    fn judged(&self, on: Judged, stack: Stack) -> (Fixed, Fixed) {
        let both = |value: Fixed| (Fixed { units: -value.units, ..value }, value);
        match (on, stack) {
            (Judged::Source(source), _) => (self.each[source], self.each[source]),
            (Judged::Combined, Stack::Range) => (self.lower, self.upper),
            (Judged::Combined, Stack::WorstCase) => both(self.worst),
            (Judged::Combined, Stack::Rss) => both(self.rss),
        }
    }
}

/// √ of a sum of at most five squares of which each root is known within its share of `bound`.
///
/// |∂√Σv²/∂v| ≤ 1, so the bounds add up. Rounding: each v to a double (1 half-ulp), its square (1), four sums
/// (4), which the root halves, and the root itself: below 5 half-ulps; 2⁻⁵⁰ is 8.
#[inline]
fn root(squares: f64, bound: i64) -> Fixed {
    let root = squares.sqrt();
    #[expect(clippy::cast_possible_truncation, reason = "five values below 2⁶⁰ have a root below 2⁶²")]
    let units = (root + 0.5) as i64;
    Fixed { units, bound: bound + (units >> 50) + 2 }
}

/// The exact result of an output that is a number.
fn exact_result<'e>(evaluation: &'e Evaluation, plan: &Plan, output: &Output) -> Option<&'e Length> {
    let combined = &evaluation.combined;
    Some(match output {
        Output::Error(source) => evaluation.contributions[*source].delta_cd(plan.model),
        Output::RangeLower => &combined.range_lower,
        Output::RangeUpper => &combined.range_upper,
        Output::WorstCase => &combined.worst_case,
        Output::Rss => &combined.rss,
        Output::Id | Output::Verdict | Output::Copied(_) => return None,
    })
}

/// A length in 1e-15 mm, rounded; `None` beyond what statistics hold.
fn fixed(length: &Length) -> Option<i64> {
    let scaled = length.exact_mm() * &Rational::integer(Fixed::PER_MM);
    i64::try_from(scaled.to_fixed_point(0)).ok().filter(|units| units.unsigned_abs() < 1 << 62)
}

/// Exact results as integers, the largest there are where they do not fit.
fn fixed_results(evaluation: &Evaluation, plan: &Plan) -> Results {
    let of = |length: &Length| {
        let end = if length.is_negative() { -(1 << 62) } else { 1 << 62 };
        Fixed { units: fixed(length).unwrap_or(end), bound: 1 }
    };
    let mut each = [ZERO; KINDS];
    for (value, contribution) in each.iter_mut().zip(&evaluation.contributions) {
        *value = of(contribution.delta_cd(plan.model));
    }
    let combined = &evaluation.combined;
    Results {
        each,
        lower: of(&combined.range_lower),
        upper: of(&combined.range_upper),
        worst: of(&combined.worst_case),
        rss: of(&combined.rss),
    }
}

/// The start of a text, for a message.
fn shortened(bytes: &[u8]) -> String {
    const LONGEST: usize = 60;
    let text = text(bytes);
    let mut short: String = text.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if text.chars().count() > LONGEST {
        short.push('…');
    }
    short
}
