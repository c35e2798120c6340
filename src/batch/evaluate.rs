//! Blocks: columns of deviations to columns of results, results to text and counts. A worker has an [`Evaluator`] and gives
//! it blocks; where their columns are from, it does not know.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use super::layout::Layout;
use super::outcome::{KeptPart, Part, Problem, Tally, WORST, keep_worst};
use super::plan::Plan;
use super::request::Rows;
use super::results::{Margin, Refusals, Results, spread_of};
use super::rows::{Row, RowWriter, WrittenRow};
use super::statistics::Statistics;
use crate::deviation::DeviationValue;
use crate::deviation::plausible::Reach;
use crate::judge::Verdict;
use crate::judge::bound::ChangingErrors;
use crate::quantity::{Length, shown};
use crate::table::{Block, Fault};
use crate::uncertainty::Spreads;

/// Rows that are evaluated together: their columns stay near at hand.
const TOGETHER: usize = 512;

/// Results of a block that are not in the statistics yet, of one quantity.
#[derive(Default)]
struct Uncounted {
    results: Vec<Length>,
    /// What measuring contributes to the variance of each.
    gauges_mm2: Vec<f64>,
}

/// Evaluates the rows of blocks.
pub(super) struct Evaluator<'a> {
    pub(super) plan: &'a Plan,
    layout: &'a Layout,
    file: Arc<str>,
    pub(super) written: RowWriter<'a>,
    /// The rejected rows as they are.
    pub(super) rejects: Vec<u8>,
    pub(super) tally: Tally,
    pub(super) statistics: Vec<Statistics>,
    /// What of the block belongs there, once it is known to count.
    uncounted: Vec<Uncounted>,
    /// The errors on the teeth that their extents allow.
    errors: ChangingErrors<'a>,
    /// Which deviations are not suspicious.
    usual: Reach,
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
            written: RowWriter::new(plan),
            rejects: Vec::new(),
            tally: Tally::default(),
            statistics: vec![Statistics::default(); quantities],
            uncounted: (0..quantities).map(|_| Uncounted::default()).collect(),
            errors: ChangingErrors::new(&plan.basis, plan.sources.iter().map(|source| source.extended).collect()),
            usual: Reach::usual(plan.spec.module()),
            keeps_rejects,
        }
    }

    /// Evaluates a block; what came out of the last one is forgotten. `keeps_names` asks for the names of its parts.
    pub(super) fn block(&mut self, block: &Block, records_before: u64, keeps_names: bool) {
        self.written.clear();
        self.rejects.clear();
        for uncounted in &mut self.uncounted {
            uncounted.results.clear();
            uncounted.gauges_mm2.clear();
        }
        self.tally.clear(self.plan.followed.len());
        self.tally.lines = block.line_count;
        self.tally.records = block.record_count;
        self.tally.counts.blank_lines = block.blank_lines;
        self.tally.asides.clone_from(&block.asides);
        self.tally.contradiction.clone_from(&block.contradiction);
        if block.is_rest {
            self.keep_raw(block, 0);
        }
        for (doubted, column) in self.tally.doubted.iter_mut().zip(&self.layout.columns) {
            *doubted = column.map_or(0, |column| self.usual.doubted(block.values(column)));
        }
        let columns = self.columns(block);
        for first in (0..block.rows()).step_by(TOGETHER) {
            let rows = first..block.rows().min(first + TOGETHER);
            let refusals = refusals(block, &rows);
            let deviations: Vec<_> = columns.iter().map(|column| &column[rows.clone()]).collect();
            let results = Results::new(self.plan, self.layout, refusals, &deviations, &self.errors);
            self.take(&results, Row { block, index: first, records_before });
            let counts = &self.tally.counts;
            if self.plan.request.strict && counts.rejected > 0 && counts.rows < block.rows() as u64 {
                return;
            }
        }
        self.write_no_parts(block, block.record_count);
        if keeps_names {
            let names = (0..block.rows()).filter_map(|row| block.name_bytes(row));
            self.tally.names.extend(names.map(<[u8]>::to_vec));
        }
    }

    /// Where every row is written: those that are no parts, up to this record of the block.
    fn write_no_parts(&mut self, block: &Block, record: u64) {
        if self.plan.request.rows != Rows::Every {
            return;
        }
        let (first, rows) = (block.lines.first().zip(block.records.first()), self.written.columns.rows as u64);
        let line_before = first.map_or(0, |(line, record)| line - record);
        for record in rows + 1..=record {
            let aside = block.asides.iter().find(|aside| aside.line == line_before + record);
            let reason = match aside {
                Some(aside) => format!("no part: {}", shown(&aside.text)),
                None => "no part: there is nothing in the row".to_owned(),
            };
            self.written.row(None, &WrittenRow::None { reason: &reason });
        }
    }

    /// The deviations of each source in the rows of a block.
    fn columns<'b>(&self, block: &'b Block) -> Vec<Cow<'b, [DeviationValue]>> {
        let columns = self.plan.sources.iter().zip(&self.layout.columns);
        let values = columns.map(|(source, column)| match (column, source.of_every_part) {
            (Some(column), _) => block.values(*column).into(),
            (None, value) => value.map(|value| vec![value; block.rows()]).unwrap_or_default().into(),
        });
        values.collect()
    }

    /// Takes the results of some rows, of which this is the first.
    fn take(&mut self, results: &Results<'_>, first: Row<'_>) {
        if self.plan.request.statistics {
            self.count(results);
        }
        for (index, refusal) in results.refusals.iter().enumerate() {
            let row = Row { index: first.index + index, ..first };
            self.write_no_parts(row.block, row.record() - 1);
            self.tally.counts.rows += 1;
            match refusal {
                Some(refusal) => self.refuse(row, refusal),
                None => self.take_part(row, results, index),
            }
        }
    }

    /// Takes a part, whose results are in that row of them.
    #[inline]
    fn take_part(&mut self, row: Row<'_>, results: &Results<'_>, index: usize) {
        let verdict = results.verdicts[index];
        if self.plan.request.rows.has(verdict) {
            self.written.row(Some(row), &WrittenRow::Part { results, row: index });
        }
        self.tally.counts.judge(verdict);
        let is_failure = self.keeps_failure(verdict);
        if !is_failure && !self.plan.request.statistics {
            return;
        }
        let margin = results.margin(index);
        let worst = &self.tally.worst;
        let is_worst = worst.len() < WORST || worst.last().is_some_and(|last| margin.inside_by < last.margin);
        if self.plan.request.statistics && is_worst {
            let part = self.kept(row, verdict, margin);
            keep_worst(&mut self.tally.worst, KeptPart { part, margin: margin.inside_by });
        }
        if is_failure {
            let part = self.kept(row, verdict, margin);
            self.tally.failures.push(part);
        }
    }

    /// Takes the block into the statistics: a block behind the end of the run does not count.
    pub(super) fn count_block(&mut self) {
        for (statistics, uncounted) in self.statistics.iter_mut().zip(&self.uncounted) {
            statistics.add(&uncounted.results);
            uncounted.gauges_mm2.iter().for_each(|gauge| statistics.add_gauge(*gauge));
        }
    }

    /// Keeps results for the statistics.
    fn count(&mut self, results: &Results<'_>) {
        for (uncounted, output) in self.uncounted.iter_mut().zip(self.plan.quantities()) {
            uncounted.results.extend(results.all_of(output));
        }
        for (moving, (_, output)) in self.tally.moving.iter_mut().zip(&self.plan.followed) {
            results.all_of(output).for_each(|result| moving.add(result));
        }
        for known in results.parts().filter_map(|row| results.uncertainty(row)) {
            self.add_gauge(&known.spreads);
        }
    }

    /// Keeps what measuring contributes to the variance of each result.
    fn add_gauge(&mut self, spreads: &Spreads) {
        for (uncounted, output) in self.uncounted.iter_mut().zip(self.plan.quantities()) {
            let spread = self.plan.spread_of(output).and_then(|of| spread_of(self.plan, spreads, of));
            uncounted.gauges_mm2.extend(spread.map(|spread| spread.gauge_mm2));
        }
    }

    fn keeps_failure(&self, verdict: Option<Verdict>) -> bool {
        let kept = self.plan.request.failures_kept;
        kept > 0 && matches!(verdict, Some(Verdict::Fail | Verdict::Indeterminate)) && self.tally.failures.len() < kept
    }

    /// A part as it is kept for the summary.
    fn kept(&self, row: Row<'_>, verdict: Option<Verdict>, margin: Margin) -> Part {
        Part {
            id: row.id().into_owned(),
            file: Arc::clone(&self.file),
            line: row.line(),
            record: row.record(),
            place: None,
            verdict,
            margin_mm: margin.inside_by.mm(),
            on: margin.on,
            result_mm: (margin.result.lower.mm(), margin.result.upper.mm()),
        }
    }

    /// A row with a cell that is no value, that is no row at all, or whose values have no results.
    fn refuse(&mut self, row: Row<'_>, Fault { column, text, message, .. }: &Fault) {
        self.tally.counts.rejected += 1;
        if self.plan.request.rows == Rows::Every {
            self.written.row(Some(row), &WrittenRow::None { reason: message });
        }
        self.keep_raw(row.block, row.index);
        if self.tally.problems.len() < self.plan.request.problems_kept {
            self.tally.problems.push(Problem {
                file: Arc::clone(&self.file),
                line: row.line(),
                record: row.record(),
                place: None,
                part: row.block.name(row.index).filter(|name| !name.is_empty()).map(|name| shown(&name)),
                column: column.and_then(|column| self.layout.titles.get(column)).cloned(),
                text: text.clone(),
                message: message.clone(),
            });
        }
    }

    /// Keeps a row as it stands in the file.
    fn keep_raw(&mut self, block: &Block, index: usize) {
        let Some(raw) = block.raw(index).filter(|_| self.keeps_rejects) else { return };
        self.rejects.extend_from_slice(raw);
        if !block.goes_on && !self.rejects.ends_with(b"\n") && !self.rejects.ends_with(b"\r") {
            self.rejects.push(b'\n');
        }
    }
}

/// Why rows of a block are refused that have a cell that is no value, or are no rows at all: the first reason of each.
fn refusals(block: &Block, rows: &Range<usize>) -> Refusals {
    let mut refusals: Refusals = rows.clone().map(|_| None).collect();
    let first = block.faults().partition_point(|fault| fault.row < rows.start);
    for fault in block.faults()[first..].iter().take_while(|fault| fault.row < rows.end) {
        refusals[fault.row - rows.start].get_or_insert_with(|| Box::new(fault.clone()));
    }
    refusals
}
