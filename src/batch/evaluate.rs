//! One row after another: deviations to results, results to text and counts. A worker has an [`Evaluator`] and gives it
//! blocks; where their columns are from, it does not know.

use std::sync::Arc;

use super::layout::Layout;
use super::outcome::{KeptPart, Part, Problem, Tally, WORST, keep_worst};
use super::plan::Plan;
use super::request::Rows;
use super::results::{Margin, Refusal, Results, spread_of};
use super::rows::{Row, RowWriter, WrittenRow};
use super::source::KINDS;
use super::statistics::Statistics;
use super::uncertain::RowUncertainty;
use crate::deviation::plausible::Reach;
use crate::deviation::{DeviationKind, DeviationValue};
use crate::judge::Verdict;
use crate::judge::bound::ChangingErrors;
use crate::quantity::shown;
use crate::table::Block;
use crate::uncertainty::Spreads;

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
    deviations: [DeviationValue; KINDS],
    /// The same on the teeth that their extents allow.
    errors: ChangingErrors<'a>,
    /// Which deviations are not suspicious.
    usual: Reach,
    /// Whether rejected rows are kept at all.
    keeps_rejects: bool,
}

impl<'a> Evaluator<'a> {
    pub(super) fn new(plan: &'a Plan, layout: &'a Layout, file: &Arc<str>, keeps_rejects: bool) -> Self {
        let quantities = if plan.request.statistics { plan.quantities().count() } else { 0 };
        let mut deviations = [DeviationValue::zero(DeviationKind::RackOverRoller); KINDS];
        for (deviation, source) in deviations.iter_mut().zip(&plan.sources) {
            *deviation = source.of_every_part.unwrap_or(*deviation);
        }
        Self {
            plan,
            layout,
            file: Arc::clone(file),
            written: RowWriter::new(plan),
            rejects: Vec::new(),
            tally: Tally::default(),
            statistics: vec![Statistics::default(); quantities],
            deviations,
            errors: ChangingErrors::new(&plan.basis, plan.sources.iter().map(|source| source.extended).collect()),
            usual: Reach::usual(plan.spec.module()),
            keeps_rejects,
        }
    }

    /// Evaluates a block; what came out of the last one is forgotten. `keeps_names` asks for the names of its parts.
    pub(super) fn block(&mut self, block: &Block, records_before: u64, keeps_names: bool) {
        self.written.clear();
        self.rejects.clear();
        self.tally.clear(self.plan.followed.len());
        self.tally.lines = block.line_count;
        self.tally.records = block.record_count;
        self.tally.counts.blank_lines = block.blank_lines;
        self.tally.asides.clone_from(&block.asides);
        self.tally.contradiction.clone_from(&block.contradiction);
        if block.is_rest {
            self.keep_raw(block, 0);
        }
        let mut faults = block.faults().iter().peekable();
        let columns: Vec<_> =
            self.layout.columns.iter().map(|column| column.map(|column| block.values(column))).collect();
        for (doubted, column) in self.tally.doubted.iter_mut().zip(&columns) {
            *doubted = column.map_or(0, |values| self.usual.doubted(values));
        }
        for index in 0..block.rows() {
            if self.plan.request.strict && self.tally.counts.rejected > 0 {
                return;
            }
            let row = Row { block, index, records_before };
            self.write_no_parts(block, row.record() - 1);
            self.tally.counts.rows += 1;
            if let Some(fault) = faults.next_if(|fault| fault.row == index) {
                while faults.next_if(|fault| fault.row == index).is_some() {}
                self.refuse(row, fault.column, &fault.text, &fault.message);
                continue;
            }
            for (deviation, column) in self.deviations.iter_mut().zip(&columns) {
                if let Some(column) = column {
                    *deviation = column[index];
                }
            }
            if let Err(Refusal { message, source }) = self.evaluate(row) {
                let column = source.and_then(|source| self.layout.columns[source]);
                self.refuse(row, column, "", &message);
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

    #[inline]
    fn evaluate(&mut self, row: Row<'_>) -> Result<(), Refusal> {
        let plan = self.plan;
        let refused = |message: String| Refusal { message, source: None };
        let results = Results::new(plan, &self.deviations, &mut self.errors)?;
        let uncertainty = match &plan.uncertain {
            Some(uncertain) => {
                let known = uncertain.of_row(&plan.sources, &self.deviations, &results.each, &plan.limits);
                Some(known.map_err(|error| refused(error.to_string()))?)
            }
            None => None,
        };
        let verdict = results.judge(plan, uncertainty.as_ref()).map_err(|error| refused(error.to_string()))?;
        if plan.request.rows.has(verdict) {
            let uncertainty = uncertainty.as_ref();
            self.written.row(Some(row), &WrittenRow::Part { results: &results, uncertainty, verdict });
        }
        self.tally.counts.judge(verdict);
        if plan.request.statistics {
            self.count(&results, uncertainty.as_ref());
            let margin = results.margin(plan);
            let full = self.tally.worst.len() == WORST;
            if !full || self.tally.worst.last().is_some_and(|last| margin.inside_by < last.margin) {
                let part = self.kept(row, verdict, margin);
                keep_worst(&mut self.tally.worst, KeptPart { part, margin: margin.inside_by });
            }
        }
        if self.keeps_failure(verdict) {
            let part = self.kept(row, verdict, results.margin(plan));
            self.tally.failures.push(part);
        }
        Ok(())
    }

    /// Takes the results into the statistics.
    fn count(&mut self, results: &Results, uncertainty: Option<&RowUncertainty>) {
        for (statistics, output) in self.statistics.iter_mut().zip(self.plan.quantities()) {
            results.of(output).into_iter().for_each(|result| statistics.add(result));
        }
        for (moving, (_, output)) in self.tally.moving.iter_mut().zip(&self.plan.followed) {
            results.of(output).into_iter().for_each(|result| moving.add(result));
        }
        if let Some(known) = uncertainty {
            self.add_gauge(&known.spreads);
        }
    }

    /// Adds what measuring contributes to the variance of each result.
    fn add_gauge(&mut self, spreads: &Spreads) {
        for (statistics, output) in self.statistics.iter_mut().zip(self.plan.quantities()) {
            if let Some(spread) = self.plan.spread_of(output).and_then(|of| spread_of(self.plan, spreads, of)) {
                statistics.add_gauge(spread.gauge_mm2);
            }
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
    fn refuse(&mut self, row: Row<'_>, column: Option<usize>, text: &str, message: &str) {
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
                text: text.to_owned(),
                message: message.to_owned(),
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
