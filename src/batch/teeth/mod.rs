//! Tables with many rows per part: each part's teeth or spaces, through the exact mesh.
//!
//! The command line makes one [`Teeth`] per run and hands it table after table. The rows of a part may stand anywhere in one
//! table: a part is judged when all tables are read, and rejected if two of them name it. The rows replace the spec's errors
//! of that part, and the part is judged at the strokes at which every flank that can carry was measured. A bad row rejects its
//! part with all rows. Parts are solved side by side and written in the order of their first rows.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

mod columns;
mod judge;
mod lot;

use columns::{COLUMNS, Column, QUANTITIES, columns_asked};
pub use judge::{JudgedTeeth, TeethJudge};
use lot::{Lot, Solved, judged_part, refuse_in_two};

use super::columns::{ColumnKind, ResultCell, ResultColumns};
use super::ledger::{Ledger, RowSink, Sinks};
use super::outcome::{Outcome, Problem, Quantity, keep_worst};
use super::request::Request;
use super::run::{Progress, RunError};
use super::write;
use crate::deviation;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::function::YokeJudge;
use crate::judge::LimitTarget;
use crate::parallel;
use crate::quantity::Length;
use crate::spec::{MeasuredTables, Spec};
use crate::table::{Gatherer, LineFault, Reading, Table, ToothedPart, Wanted};

/// What is asked of a batch of parts with their teeth.
#[derive(Debug, Clone, Default)]
pub struct TeethRequest {
    /// The stroke, mm.
    pub stroke_mm: (f64, f64),
    /// The tolerance of the curve between its points, mm.
    pub tolerance_mm: f64,
    /// First and last stroke of the rack's travel, mm, if they are known.
    pub travel_mm: Option<(f64, f64)>,
    /// What is written and kept, the rule, and whether parts are judged without what the spec asks for. The formulas'
    /// model, their stack and the simulation of results are not asked for.
    pub rows: Request,
}

/// A batch of parts with their teeth. In the counts of its outcome, a row is a part.
pub struct Teeth<'a> {
    spec: &'a Spec,
    tables: &'a MeasuredTables,
    /// The parts of the tables that were read.
    lots: Vec<Lot>,
    /// Bytes that they take, about.
    held: usize,
    request: TeethRequest,
    columns: Vec<(&'static str, Column)>,
    /// What the yoke is held against, if the spec has one.
    yoke: Option<YokeJudge>,
    ledger: Ledger<'a>,
    workers: usize,
    /// Parts of which not every stroke that was asked for is covered.
    cut: u64,
}

impl<'a> Teeth<'a> {
    /// Starts a batch; `tables` are those of the part that is the same for all.
    ///
    /// # Errors
    /// Diagnostics if a column is asked for that there is not, or of a yoke of which too little is said.
    pub fn new(
        spec: &'a Spec,
        tables: &'a MeasuredTables,
        request: TeethRequest,
        sinks: Sinks<'a>,
        workers: usize,
    ) -> Result<Self, Diagnostics> {
        let columns = columns_asked(request.rows.columns.as_deref(), spec.has_yoke())?;
        let yoke = spec.yoke_judge(request.travel_mm, &request.rows.rule)?;
        let limit = spec.limits.iter().find(|(on, _)| *on == LimitTarget::CenterDistance);
        let limit = limit.map(|(_, limit)| &limit.value);
        let kept = if request.rows.statistics { &COLUMNS[QUANTITIES] } else { &[] };
        let quantity = |(name, column): &(&str, Column)| {
            let end = if let Column::End(end, _) = column { Some(*end) } else { None };
            let on = end.map(|_| LimitTarget::CenterDistance);
            Quantity::new((*name).to_owned(), on, limit.filter(|_| end.is_some()), end)
        };
        Ok(Self {
            spec,
            tables,
            lots: Vec::new(),
            held: 0,
            request,
            columns,
            yoke,
            ledger: Ledger::new(sinks, kept.iter().map(quantity).collect()),
            workers: workers.max(1),
            cut: 0,
        })
    }

    /// The columns that are written of those that `columns` asks for: their names, and what they hold.
    ///
    /// # Errors
    /// A diagnostic if a column is asked for that there is not.
    pub fn columns_written(spec: &Spec, columns: Option<&[String]>) -> Result<Vec<(String, ColumnKind)>, Diagnostic> {
        let written = |(name, column): (&str, Column)| (name.to_owned(), column.kind());
        Ok(columns_asked(columns, spec.has_yoke())?.into_iter().map(written).collect())
    }

    /// Reads the parts of one table.
    ///
    /// # Errors
    /// Diagnostics if the table's columns are not those of a rack or a pinion; [`RunError`] if it cannot be read to its end.
    pub fn take(&mut self, table: Table) -> Result<Result<(), RunError>, Diagnostics> {
        let name = Arc::clone(&table.name);
        let gatherer = Gatherer::new(&table)?;
        let part = if gatherer.is_rack() { deviation::Part::Rack } else { deviation::Part::Pinion };
        let judge = TeethJudge::new(self.spec, part, self.request.rows.rule.clone(), self.request.rows.partial)?;
        self.note(judge.notes());
        let mut reading = table.reading.clone();
        if self.spec.has_other_deviations(part) {
            reading.notes.push(format!("{name}: the table takes the place of the deviations in the spec"));
        }
        let (unit, encoding) = (table.place, table.encoding);
        let (header, has_names) = (table.header_raw.clone(), table.has_id);
        let gathered = self.gathered(table, gatherer, &mut reading);
        self.ledger.outcome.readings.push(reading);
        Ok(gathered
            .map(|parts| self.lots.push(Lot { parts, part, has_names, file: name, unit, encoding, header, judge })))
    }

    /// Keeps notes that are new.
    fn note(&mut self, notes: Vec<String>) {
        let known = &mut self.ledger.outcome.notes;
        for note in notes {
            if !known.contains(&note) {
                known.push(note);
            }
        }
    }

    /// The rows of a table, put together to parts; what they say besides goes to `reading`.
    fn gathered(
        &mut self,
        table: Table,
        mut gatherer: Gatherer,
        reading: &mut Reading,
    ) -> Result<Vec<ToothedPart>, RunError> {
        let keeps_raw = self.ledger.sinks.rejects.is_some();
        gatherer.held = self.held;
        for block in table.rows(Wanted { copied: Vec::new(), keeps_raw }) {
            let block = block.map_err(RunError::Read)?;
            block.tell(reading);
            gatherer.take(&block, keeps_raw).map_err(RunError::Contradiction)?;
        }
        self.held = gatherer.held;
        Ok(gatherer.finish())
    }

    /// Judges the parts of all tables. `stop` ends the run after the parts that were begun.
    fn judge(&mut self, stop: &AtomicBool, progress: &mut dyn FnMut(&Progress)) -> io::Result<()> {
        let mut lots = std::mem::take(&mut self.lots);
        refuse_in_two(&mut lots);
        for lot in &lots {
            let names = || {
                let names: Vec<_> = self.columns.iter().map(|(name, _)| (*name).to_owned()).collect();
                write::header(&names, self.request.rows.format)
            };
            self.ledger.start(names, lot.encoding, &lot.header)?;
            self.lot(lot, stop, progress)?;
        }
        self.ledger.outcome.interrupted |= stop.load(Ordering::Relaxed);
        Ok(())
    }

    /// Solves and settles every part of a table.
    fn lot(&mut self, lot: &Lot, stop: &AtomicBool, progress: &mut dyn FnMut(&Progress)) -> io::Result<()> {
        // some parts for each worker, so that a slow one holds nobody up for long
        for parts in lot.parts.chunks(8 * self.workers) {
            if self.ledger.is_over(self.request.rows.strict) || stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let (tables, request, yoke) = (self.tables, &self.request, self.yoke.as_ref());
            let solve = |(): &mut (), index: usize| {
                let is_stopped = stop.load(Ordering::Relaxed);
                (!is_stopped).then(|| lot.solved(&parts[index], tables, request, yoke))
            };
            let solved = parallel::map(self.workers, parts.len(), || (), solve).0;
            for (part, solved) in parts.iter().zip(solved.into_iter().map_while(|solved| solved)) {
                self.settle(part, solved, lot)?;
                if self.ledger.is_over(self.request.rows.strict) {
                    return Ok(());
                }
            }
            let counts = self.ledger.outcome.counts;
            let (rows, failures, rejected) = (counts.rows, counts.fail, counts.rejected);
            progress(&Progress { rows, failures, rejected, bytes: 0 });
        }
        Ok(())
    }

    /// Judges the parts of all tables: what they came to. `stop` ends the run after the parts that were begun.
    ///
    /// # Errors
    /// If the results cannot be written. What was computed before is kept.
    pub fn finish(mut self, stop: &AtomicBool, progress: &mut dyn FnMut(&Progress)) -> (Outcome, io::Result<()>) {
        let judged = self.judge(stop, progress);
        if self.cut > 0 {
            let (from, to) = self.request.stroke_mm;
            self.ledger.outcome.notes.push(format!(
                "the curve of {} parts is that of the strokes whose contacts were measured, and not from {from} to {to} mm: see \
                 from_stroke_mm and to_stroke_mm; lower_mm and upper_mm, which are judged, are those of all such strokes",
                self.cut
            ));
        }
        let (outcome, written) = self.ledger.finish(self.request.rows.strict);
        (outcome, judged.and(written))
    }

    /// Judges, counts and writes a part.
    fn settle(&mut self, part: &ToothedPart, solved: Result<Solved, LineFault>, lot: &Lot) -> io::Result<()> {
        self.ledger.outcome.counts.rows += 1;
        let mut solved = match solved {
            Ok(solved) => solved,
            Err(fault) => return self.reject(part, &fault, lot),
        };
        let verdict = solved.verdict();
        self.note(std::mem::take(&mut solved.judged.notes));
        self.ledger.outcome.counts.judge(verdict);
        self.ledger.outcome.counts.fail_by_status += u64::from(solved.judged.evaluation.rejection().is_some());
        if solved.is_cut {
            self.cut += 1;
        }
        if let Some(settings) = solved.yoke.as_ref().and_then(|yoke| yoke.settings_known()) {
            self.ledger.outcome.settings.add(settings);
        }
        let kept = judged_part(part, &solved, lot);
        if let Some(list) = self.ledger.sinks.parts.as_mut() {
            list.take(std::slice::from_ref(&kept), &[])?;
        }
        if kept.is_not_passed() && self.ledger.outcome.failures.len() < self.request.rows.failures_kept {
            self.ledger.outcome.failures.push(kept.clone());
        }
        if self.request.rows.statistics {
            self.count(&solved);
            keep_worst(&mut self.ledger.outcome.worst, kept.badness(), || kept);
        }
        if self.request.rows.rows.has(verdict) { self.write(part, &solved) } else { Ok(()) }
    }

    fn count(&mut self, solved: &Solved) {
        for (quantity, (_, column)) in self.ledger.outcome.quantities.iter_mut().zip(&COLUMNS[QUANTITIES]) {
            let Some(Ok(value)) = column.number(solved).map(Length::from_mm) else { continue };
            quantity.statistics.add(&[value]);
            if quantity.is_limited() {
                quantity.statistics.moving.add(value);
            }
        }
    }

    fn reject(&mut self, part: &ToothedPart, fault: &LineFault, lot: &Lot) -> io::Result<()> {
        self.ledger.outcome.counts.rejected += 1;
        if let Some(rejects) = &mut self.ledger.sinks.rejects {
            let mut raw = part.raw.clone();
            if !raw.ends_with(b"\n") && !raw.ends_with(b"\r") {
                raw.push(b'\n');
            }
            rejects.write(&lot.encoding.original(&raw))?;
        }
        let problem = Problem {
            place: lot.place(fault.line, part.record),
            part: Some(part.name.clone()).filter(|name| !name.is_empty()),
            column: None,
            text: String::new(),
            message: fault.message.clone(),
        };
        if let Some(list) = self.ledger.sinks.parts.as_mut() {
            list.take(&[], std::slice::from_ref(&problem))?;
        }
        if self.ledger.outcome.problems.len() < self.request.rows.problems_kept {
            self.ledger.outcome.problems.push(problem);
        }
        Ok(())
    }

    /// Writes the row of a part.
    fn write(&mut self, part: &ToothedPart, solved: &Solved) -> io::Result<()> {
        let Request { format, decimals, .. } = self.request.rows;
        let text = |text: String| ResultCell::Text(text.into_bytes().into());
        let cells = self.columns.iter().map(|(_, column)| match column {
            Column::Text(of) => of(part, solved).map_or(ResultCell::Nothing, text),
            column => column.number(solved).map_or(ResultCell::Nothing, ResultCell::Number),
        });
        match &mut self.ledger.sinks.rows {
            None => Ok(()),
            Some(RowSink::Columns(sink)) => {
                let mut row = ResultColumns::new(self.columns.iter().map(|(_, column)| column.kind()), 1);
                row.push(cells, decimals);
                sink.take(row)
            }
            Some(RowSink::Text(sink)) => {
                let (mut out, starts) = (Vec::new(), write::json_starts(self.columns.iter().map(|(name, _)| *name)));
                for (index, (cell, start)) in cells.zip(&starts).enumerate() {
                    write::start(&mut out, index, start, format);
                    write::cell(&mut out, &cell, format, decimals);
                }
                write::end(&mut out, format);
                sink.write(&out)
            }
        }
    }
}
