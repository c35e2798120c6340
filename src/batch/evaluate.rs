//! Blocks: columns of deviations to columns of results, results to text and counts. A worker has an [`Evaluator`] and gives it
//! blocks; the evaluator does not know where their columns come from.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::layout::Layout;
use super::meshed::Meshes;
use super::outcome::{Part, PartError, Problem, Tally, badness, keep_worst, may_be_worst};
use super::output::Output;
use super::plan::Plan;
use super::request::{Request, Rows};
use super::results::{Margin, Results, spread_of};
use super::rows::{Row, RowWriter, WrittenRow};
use super::source::Source;
use super::statistics::Statistics;
use crate::deviation::plausible::Reach;
use crate::deviation::{DeviationValue, DeviationValues};
use crate::judge::Verdict;
use crate::judge::bound::ChangingErrors;
use crate::quantity::{Length, shown};
use crate::table::{Block, Fault};

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
    /// The results of the last block, which go into the statistics once the block counts.
    results: Option<Results<'a>>,
    /// The errors on the teeth that their extents allow.
    errors: ChangingErrors<'a>,
    /// The parts that the exact mesh judged.
    meshes: Meshes<'a>,
    /// The range of deviations that are not suspicious.
    usual: Reach,
    /// Whether rejected rows are kept at all.
    keeps_rejects: bool,
}

impl<'a> Evaluator<'a> {
    /// An evaluator for the rows of a file; once `stop` is set, it begins no more slow rows.
    pub(super) fn new(
        plan: &'a Plan,
        layout: &'a Layout,
        file: &Arc<str>,
        keeps_rejects: bool,
        stop: &'a AtomicBool,
    ) -> Self {
        let quantities = if plan.request.statistics { plan.quantities_kept() } else { Vec::new() };
        Self {
            plan,
            layout,
            file: Arc::clone(file),
            written: RowWriter::new(plan),
            rejects: Vec::new(),
            tally: Tally::default(),
            statistics: quantities.into_iter().map(|quantity| quantity.statistics).collect(),
            results: None,
            errors: ChangingErrors::new(&plan.basis, plan.sources.iter().map(|source| source.extended).collect()),
            meshes: Meshes::new(stop),
            usual: Reach::usual(plan.spec.module()),
            keeps_rejects,
        }
    }

    /// Whether a signal left no time for some rows of the last block.
    pub(super) fn is_cut(&self, rows: usize) -> bool {
        self.tally.counts.rows < rows as u64
    }

    /// Evaluates a block and forgets the results of the last one. `keeps_names` asks for the names of its parts.
    pub(super) fn block(&mut self, block: &Block, records_before: u64, keeps_names: bool) {
        self.written.begin(block.rows());
        self.rejects.clear();
        self.results = None;
        self.tally.clear(self.plan.followed.len());
        self.tally.counts.blank_lines = block.blank_lines;
        if block.is_rest {
            self.keep_raw(block, 0);
        }
        let columns = self.columns(block);
        let results = Results::new(self.plan, self.layout, block, &columns, &self.errors, &mut self.meshes);
        self.take(&results, &columns, Row { block, index: 0, records_before });
        self.results = Some(results);
        if self.is_cut(block.rows()) {
            // in strict mode a refused row is the last one; after a signal there is no time for further rows
            return;
        }
        self.write_no_parts(block, block.record_count);
        self.tally.has_names = keeps_names;
    }

    /// Counts the suspicious values of the block.
    pub(super) fn doubt(&mut self, block: &Block) {
        for (doubted, column) in self.tally.doubted.iter_mut().zip(&self.layout.columns) {
            let is_reached = |end: &DeviationValue| self.usual.is_reached_by(*end);
            let may_be =
                |column: &usize| block.ends.get(*column).is_none_or(|ends| ends.iter().flatten().any(is_reached));
            *doubted = column.filter(may_be).map_or(0, |column| self.usual.doubted(block.values(column)));
        }
    }

    /// Where every row is written: writes the rows that are not parts, up to this record of the block.
    fn write_no_parts(&mut self, block: &Block, record: u64) {
        if self.plan.request.rows != Rows::Every {
            return;
        }
        let (first, rows) = (block.lines.first().zip(block.records.first()), self.written.rows() as u64);
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
    fn columns<'b>(&self, block: &'b Block) -> Vec<Cow<'b, DeviationValues>> {
        let columns = self.plan.sources.iter().zip(&self.layout.columns);
        let values = columns.map(|(source, column)| match (column, source.of_every_part) {
            (Some(column), _) => match self.plan.circle_of(source) {
                Some(circle) => Cow::Owned(circle.scaled_all(block.values(*column))),
                None => Cow::Borrowed(block.values(*column)),
            },
            (None, Some(value)) => Cow::Owned(DeviationValues::repeated(value, block.rows())),
            (None, None) => Cow::Owned(DeviationValues::default()),
        });
        values.collect()
    }

    /// Takes the results of a block, of whose rows this is the first.
    fn take(&mut self, results: &Results<'_>, columns: &[Cow<'_, DeviationValues>], first: Row<'_>) {
        let Request { lists_parts, failures_kept, statistics, .. } = self.plan.request;
        let may_keep = lists_parts || failures_kept > 0 || statistics;
        for rows in results.runs() {
            let refused = rows.end;
            if self.is_written_at_once(first.block, results, &rows) {
                self.write_no_parts(first.block, first.block.records[rows.start] - 1);
                self.written.parts(first, results, rows.clone());
            } else {
                rows.clone().for_each(|index| self.write_part(Row { index, ..first }, results));
            }
            self.count(results, &rows);
            for index in rows.filter(|_| may_keep) {
                self.keep_part(Row { index, ..first }, results, columns);
            }
            if let Some(refusal) = results.refusals.get(&refused) {
                self.refuse(Row { index: refused, ..first }, refusal);
            }
        }
        for (moving, (_, output)) in self.tally.moving.iter_mut().zip(&self.plan.followed) {
            results.all_of(output).iter().for_each(|result| moving.add(*result));
        }
    }

    /// Whether rows that are all parts are all written, and nothing between them.
    fn is_written_at_once(&self, block: &Block, results: &Results<'_>, rows: &Range<usize>) -> bool {
        let wanted = self.plan.request.rows;
        let records = &block.records[rows.clone()];
        let (Some(first), Some(last)) = (records.first(), records.last()) else { return false };
        results.verdicts[rows.clone()].iter().all(|verdict| wanted.has(*verdict))
            && (wanted != Rows::Every || last - first + 1 == records.len() as u64)
    }

    /// Counts parts.
    fn count(&mut self, results: &Results<'_>, rows: &Range<usize>) {
        let Tally { counts, settings, .. } = &mut self.tally;
        counts.rows += rows.len() as u64;
        results.verdicts[rows.clone()].iter().for_each(|verdict| counts.judge(*verdict));
        counts.fail_by_status += results.failed_by_status(rows);
        counts.meshed += results.judged_by_mesh(rows);
        let known = rows.clone().filter_map(|row| results.yoke(row)?.settings_known());
        known.for_each(|known| settings.add(known));
    }

    /// Writes a part, if its verdict is wanted.
    #[inline]
    fn write_part(&mut self, row: Row<'_>, results: &Results<'_>) {
        if self.plan.request.rows.has(results.verdicts[row.index]) {
            self.write_no_parts(row.block, row.record() - 1);
            self.written.row(Some(row), &WrittenRow::Part { results, row: row.index });
        }
    }

    /// Keeps a part that is worth a look.
    #[inline]
    fn keep_part(&mut self, row: Row<'_>, results: &Results<'_>, columns: &[Cow<'_, DeviationValues>]) {
        let verdict = results.verdicts[row.index];
        let is_kept = self.keeps(verdict);
        // most parts are not among the worst
        let fails_otherwise = results.fails_otherwise(row.index);
        let bad = |by: Length| badness(verdict, fails_otherwise, by.mm());
        let is_worst = |by: Length| may_be_worst(&self.tally.worst, bad(by));
        let may_be_worst = || results.inside_by(row.index).is_none_or(is_worst);
        if !(is_kept || self.plan.request.statistics && may_be_worst()) {
            return;
        }
        let margin = results.margin(row.index);
        let file = &self.file;
        let (plan, layout) = (self.plan, self.layout);
        let part =
            || Part { errors: errors(row.index, plan, layout, results, columns), ..kept(row, file, results, margin) };
        if let Some(margin) = margin.filter(|_| self.plan.request.statistics) {
            keep_worst(&mut self.tally.worst, bad(margin.inside_by), part);
        }
        if is_kept {
            self.tally.parts.push(part());
        }
    }

    /// Takes the block into the statistics: a block behind the end of the run does not count.
    pub(super) fn count_block(&mut self) {
        let Some(results) = self.results.take() else { return };
        for (statistics, output) in self.statistics.iter_mut().zip(self.plan.quantities()) {
            statistics.add(&results.all_of(output));
            if let Some(of) = self.plan.spread_of(output) {
                let spreads = results.uncertainties().filter_map(|known| spread_of(self.plan, &known.spreads, of));
                spreads.for_each(|spread| statistics.add_gauge(spread.gauge_mm2));
            }
        }
    }

    fn keeps(&self, verdict: Option<Verdict>) -> bool {
        let Request { failures_kept, lists_parts, .. } = self.plan.request;
        let is_failure = matches!(verdict, Some(Verdict::Fail | Verdict::Indeterminate));
        lists_parts || (is_failure && self.tally.parts.len() < failures_kept)
    }

    /// Rejects a row: a cell is no value, the row is not a row, or its values have no results.
    fn refuse(&mut self, row: Row<'_>, Fault { column, text, message, .. }: &Fault) {
        self.tally.counts.rows += 1;
        self.tally.counts.rejected += 1;
        if self.plan.request.rows == Rows::Every {
            self.write_no_parts(row.block, row.record() - 1);
            self.written.row(Some(row), &WrittenRow::None { reason: message });
        }
        self.keep_raw(row.block, row.index);
        let Request { lists_parts, problems_kept, .. } = self.plan.request;
        if lists_parts || self.tally.problems.len() < problems_kept {
            self.tally.problems.push(Problem {
                place: row.place(&self.file),
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

/// The errors of a part.
fn errors(
    row: usize,
    plan: &Plan,
    layout: &Layout,
    results: &Results<'_>,
    columns: &[Cow<'_, DeviationValues>],
) -> Vec<PartError> {
    let error = |((source, values), nominal): ((&Source, &Cow<'_, DeviationValues>), &Option<DeviationValue>)| {
        let kind = source.law.kind();
        PartError {
            kind,
            deviation: values.at(row),
            tolerance: source.tolerance,
            of_every_part: source.of_every_part.is_some(),
            nominal: *nominal,
            delta_cd: results.of(&Output::Error(kind), row).unwrap_or_default(),
            margin: results.margin_of(kind, row),
        }
    };
    plan.sources.iter().zip(columns).zip(&layout.nominals).map(error).collect()
}

/// A part as the summary keeps it; a part without a result counts as infinitely far outside.
fn kept(row: Row<'_>, file: &Arc<str>, results: &Results<'_>, margin: Option<Margin>) -> Part {
    const OPEN: f64 = f64::INFINITY;
    Part {
        id: row.id().into_owned(),
        place: row.place(file),
        verdict: results.verdicts[row.index],
        margin_mm: margin.map_or(-OPEN, |margin| margin.inside_by.mm()),
        on: margin.and_then(|margin| margin.on).map(|(on, _)| on),
        result_mm: margin.map_or((-OPEN, OPEN), |margin| (margin.result.lower.mm(), margin.result.upper.mm())),
        reason: results.reason(row.index).map(Cow::into_owned),
        errors: Vec::new(),
        yoke: results.yoke(row.index).cloned(),
        judged_by: results.judged_by(row.index),
        is_rejected: row.block.failed.binary_search(&row.index).is_ok(),
        fails_otherwise: results.fails_otherwise(row.index),
    }
}
