//! Tables with many rows per part: each part's teeth or spaces, through the exact mesh.
//!
//! The command line makes one [`Teeth`] per run and hands it table after table. The rows of a part may stand anywhere in
//! its table. They take the place of what the spec says is wrong with that part, and are judged at the strokes at which
//! every flank that can carry was measured. A part of which a row is bad is rejected with all of its rows. Parts are
//! solved side by side and written in the order of their first rows.

use std::collections::BTreeSet;
use std::io;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

mod judge;

pub use judge::{JudgedTeeth, TeethJudge};

use super::columns::{ColumnKind, ResultCell, ResultColumns};
use super::number::Decimals;
use super::outcome::{Kept, Outcome, Part, Problem, keep_worst};
use super::request::{RowFormat, Rows};
use super::run::{Progress, RowSink, RunError, Sinks};
use super::statistics::{Moving, Statistics};
use super::{buffer::Buffer, write};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::judge::{Limit, LimitTarget, Rule, Verdict};
use crate::mesh::{CarryingStrokes, Summary};
use crate::parallel;
use crate::quantity::Length;
use crate::spec::{MeasuredTables, Spec, keys};
use crate::table::{self, Encoding, Gatherer, LineFault, Place, Table, ToothedPart, Wanted};

/// What is asked of a batch of parts with their teeth.
#[derive(Debug, Clone, Default)]
pub struct TeethRequest {
    /// The stroke, mm.
    pub stroke_mm: (f64, f64),
    /// How near the curve between its points is, mm.
    pub tolerance_mm: f64,
    /// Decimals of the lengths written.
    pub decimals: Decimals,
    /// The format of the rows written.
    pub format: RowFormat,
    /// The columns to write, by name; those of every part if `None`.
    pub columns: Option<Vec<String>>,
    /// Which parts are written.
    pub rows: Rows,
    /// Whether statistics and the worst parts are kept.
    pub statistics: bool,
    /// How a verdict is reached.
    pub rule: Rule,
    /// Whether parts are judged without what the spec asks for and nobody knows of them.
    pub partial: bool,
    /// Whether the run ends at the first rejected part.
    pub strict: bool,
    /// How many parts that do not pass are kept with their results.
    pub failures_kept: usize,
    /// How many rejected parts are kept with what is wrong with them.
    pub problems_kept: usize,
}

/// A column that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Column {
    Id,
    Number(Number),
    Verdict,
}

/// A result, mm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Number {
    Mean,
    Min,
    Max,
    PeakToPeak,
    ToothToTooth,
    MinStroke,
    MaxStroke,
    TransmissionError,
    Lower,
    Upper,
    FromStroke,
    ToStroke,
}

impl Number {
    /// `None` if there is none.
    fn of(self, solved: &Solved) -> Option<f64> {
        /// Digits beyond this, mm, are rounding of the solution.
        const FINEST: f64 = 1e12;
        let summary = &solved.summary;
        let mm = match self {
            Self::Mean => summary.mean_mm,
            Self::Min => summary.min_mm,
            Self::Max => summary.max_mm,
            Self::PeakToPeak => summary.peak_to_peak_mm,
            Self::ToothToTooth => summary.tooth_to_tooth_mm,
            Self::MinStroke => summary.min_stroke_mm,
            Self::MaxStroke => summary.max_stroke_mm,
            Self::TransmissionError => summary.transmission_error_mm,
            Self::Lower => solved.judged.range.ok()?.lower.mm(),
            Self::Upper => solved.judged.range.ok()?.upper.mm(),
            Self::FromStroke => solved.strokes.start,
            Self::ToStroke => solved.strokes.end,
        };
        // -0 is no result
        Some((mm * FINEST).round() / FINEST + 0.0)
    }
}

/// The columns that can be written; the first so many are written unless others are asked for.
const COLUMNS: [(&str, Column); 14] = [
    ("part_id", Column::Id),
    ("mean_delta_cd_mm", Column::Number(Number::Mean)),
    ("min_delta_cd_mm", Column::Number(Number::Min)),
    ("max_delta_cd_mm", Column::Number(Number::Max)),
    ("peak_to_peak_mm", Column::Number(Number::PeakToPeak)),
    ("tooth_to_tooth_mm", Column::Number(Number::ToothToTooth)),
    ("lower_mm", Column::Number(Number::Lower)),
    ("upper_mm", Column::Number(Number::Upper)),
    ("verdict", Column::Verdict),
    ("from_stroke_mm", Column::Number(Number::FromStroke)),
    ("to_stroke_mm", Column::Number(Number::ToStroke)),
    ("min_stroke_mm", Column::Number(Number::MinStroke)),
    ("max_stroke_mm", Column::Number(Number::MaxStroke)),
    ("transmission_error_mm", Column::Number(Number::TransmissionError)),
];
const WRITTEN: usize = 11;

/// The results of which there are statistics.
const QUANTITIES: [(&str, Number); 7] = [
    ("mean_delta_cd_mm", Number::Mean),
    ("min_delta_cd_mm", Number::Min),
    ("max_delta_cd_mm", Number::Max),
    ("peak_to_peak_mm", Number::PeakToPeak),
    ("tooth_to_tooth_mm", Number::ToothToTooth),
    ("lower_mm", Number::Lower),
    ("upper_mm", Number::Upper),
];

/// A batch of parts with their teeth. In the counts of its outcome, a row is a part.
pub struct Teeth<'a> {
    spec: &'a Spec,
    tables: &'a MeasuredTables,
    request: TeethRequest,
    columns: Vec<(&'static str, Column)>,
    limit: Option<&'a Limit>,
    sinks: Sinks<'a>,
    workers: usize,
    outcome: Outcome,
    worst: Vec<Kept>,
    moving: [Moving; QUANTITIES.len()],
    /// Parts of which not every stroke that was asked for is covered.
    cut: u64,
    wrote_header: bool,
    rejects_header: Option<Vec<u8>>,
}

impl<'a> Teeth<'a> {
    /// Starts a batch; `tables` are those of the part that is the same for all.
    ///
    /// # Errors
    /// A diagnostic if a column is asked for that there is not.
    pub fn new(
        spec: &'a Spec,
        tables: &'a MeasuredTables,
        request: TeethRequest,
        sinks: Sinks<'a>,
        workers: usize,
    ) -> Result<Self, Diagnostic> {
        let columns = match &request.columns {
            None => COLUMNS[..WRITTEN].to_vec(),
            Some(names) => {
                let column = |name: &String| {
                    COLUMNS.iter().find(|(known, _)| known == name).copied().ok_or_else(|| {
                        let known: Vec<_> = COLUMNS.iter().map(|(name, _)| *name).collect();
                        Diagnostic::error(Code::Usage, format!("there is no column `{name}` to write"))
                            .help(format!("the results are {}", known.join(", ")))
                    })
                };
                names.iter().map(column).collect::<Result<_, _>>()?
            }
        };
        let limit = spec.limits.iter().find(|(on, _)| *on == LimitTarget::CenterDistance);
        let mut outcome = Outcome::default();
        if request.statistics {
            outcome.quantities = QUANTITIES.map(|(name, _)| name.to_owned()).to_vec();
            outcome.statistics = vec![Statistics::default(); QUANTITIES.len()];
        }
        Ok(Self {
            spec,
            tables,
            request,
            columns,
            limit: limit.map(|(_, limit)| &limit.value),
            sinks,
            workers: workers.max(1),
            outcome,
            worst: Vec::new(),
            moving: [Moving::default(); QUANTITIES.len()],
            cut: 0,
            wrote_header: false,
            rejects_header: None,
        })
    }

    /// The columns that are written of those that `columns` asks for: their names, and what they hold.
    #[must_use]
    pub fn columns_written(columns: Option<&[String]>) -> Vec<(String, ColumnKind)> {
        let written = |(name, column): &(&str, Column)| {
            let kind = match column {
                Column::Id | Column::Verdict => ColumnKind::Text,
                Column::Number(_) => ColumnKind::Number,
            };
            ((*name).to_owned(), kind)
        };
        match columns {
            None => COLUMNS[..WRITTEN].iter().map(written).collect(),
            Some(names) => {
                names.iter().filter_map(|name| COLUMNS.iter().find(|(known, _)| known == name)).map(written).collect()
            }
        }
    }

    /// The limits (mm, lower and upper) that each quantity is held against, if it is.
    #[must_use]
    pub fn quantity_limits(spec: &Spec) -> Vec<(Option<f64>, Option<f64>)> {
        let limit = spec.limits.iter().find(|(on, _)| *on == LimitTarget::CenterDistance);
        let ends = limit
            .map_or((None, None), |(_, limit)| (limit.value.lower.map(Length::mm), limit.value.upper.map(Length::mm)));
        let held = |number: Number| matches!(number, Number::Lower | Number::Upper);
        QUANTITIES.map(|(_, number)| if held(number) { ends } else { (None, None) }).to_vec()
    }

    /// Runs one table. `stop` ends the run after the parts that were begun.
    ///
    /// # Errors
    /// Diagnostics if the table's columns are not those of a rack or a pinion; [`RunError`] if it cannot be read to
    /// its end, or the results cannot be written. What was computed before is kept.
    pub fn run(
        &mut self,
        table: Table,
        stop: &AtomicBool,
        progress: &mut dyn FnMut(&Progress),
    ) -> Result<Result<(), RunError>, Diagnostics> {
        let name = Arc::clone(&table.name);
        let gatherer = Gatherer::new(&table)?;
        let is_rack = gatherer.is_rack();
        let judge = TeethJudge::new(self.spec, is_rack, self.request.rule.clone(), self.request.partial)?;
        let spec = judge.measured_only();
        let strokes = if is_rack { Some(carrying(spec)?) } else { None };
        for note in judge.notes() {
            if !self.outcome.notes.contains(&note) {
                self.outcome.notes.push(note);
            }
        }
        let mut reading = table.reading.clone();
        if self.spec.has_other_deviations(is_rack) {
            reading.notes.push(format!("{name}: the table takes the place of the deviations in the spec"));
        }
        let place = Where { file: &name, unit: table.place };
        let (encoding, header) = (table.encoding, table.header_raw.clone());
        let read = self.gathered(table, gatherer);
        let run = read.map_err(RunError::Read).and_then(|parts| match parts {
            Ok(parts) => {
                self.start(encoding, &header).map_err(RunError::Write)?;
                let request = &self.request;
                let (stroke_mm, tolerance_mm, tables) = (request.stroke_mm, request.tolerance_mm, self.tables);
                let solver = Solver { judge: &judge, tables, stroke_mm, tolerance_mm, strokes: strokes.as_ref() };
                self.all(&parts, &solver, &place, stop, progress)
            }
            Err(contradiction) => Err(RunError::Contradiction(contradiction)),
        });
        self.outcome.interrupted |= stop.load(Ordering::Relaxed);
        self.outcome.readings.push(reading);
        Ok(run)
    }

    /// The rows of a table, put together to parts.
    fn gathered(
        &self,
        table: Table,
        mut gatherer: Gatherer,
    ) -> io::Result<Result<Vec<ToothedPart>, table::Contradiction>> {
        let keeps_raw = self.sinks.rejects.is_some();
        let needed = vec![true; table.columns.len()];
        for block in table.rows(Wanted { needed, copied: Vec::new(), keeps_raw }) {
            let block = block?;
            gatherer.take(&block, keeps_raw);
            if let Some(contradiction) = block.contradiction {
                return Ok(Err(contradiction));
            }
        }
        Ok(Ok(gatherer.finish()))
    }

    /// Solves and settles every part.
    fn all(
        &mut self,
        parts: &[ToothedPart],
        solver: &Solver<'_>,
        place: &Where<'_>,
        stop: &AtomicBool,
        progress: &mut dyn FnMut(&Progress),
    ) -> Result<(), RunError> {
        // some parts for each worker, so that a slow one holds nobody up for long
        for parts in parts.chunks(8 * self.workers) {
            if stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let solved =
                parallel::map(self.workers, parts.len(), || (), |(): &mut (), index| solver.one(&parts[index])).0;
            for (part, solved) in parts.iter().zip(solved) {
                self.settle(part, solved, place).map_err(RunError::Write)?;
                if self.is_over() {
                    return Ok(());
                }
            }
            let counts = self.outcome.counts;
            let (rows, failures, rejected) = (counts.rows, counts.fail, counts.rejected);
            progress(&Progress { rows, failures, rejected, bytes: 0 });
        }
        Ok(())
    }

    /// Whether the run has come to its end before that of the input.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.outcome.interrupted || (self.request.strict && self.outcome.counts.rejected > 0)
    }

    /// Ends the batch: what it came to.
    ///
    /// # Errors
    /// If the results cannot be written.
    pub fn finish(mut self) -> (Outcome, io::Result<()>) {
        let limits = Self::quantity_limits(self.spec);
        for ((statistics, moving), limit) in self.outcome.statistics.iter_mut().zip(&self.moving).zip(limits) {
            if limit != (None, None) {
                statistics.add_moving(moving);
            }
        }
        self.outcome.worst = self.worst.into_iter().map(|kept| kept.part).collect();
        if self.cut > 0 {
            let (from, to) = self.request.stroke_mm;
            self.outcome.notes.push(format!(
                "the curve of {} parts is that of the strokes whose contacts were measured, and not from {from} to {to} mm: see \
                 from_stroke_mm and to_stroke_mm; lower_mm and upper_mm, which are judged, are those of all such strokes",
                self.cut
            ));
        }
        (self.outcome, self.sinks.flush())
    }

    /// Writes what stands before the first part, or before the first rejected row of another header.
    fn start(&mut self, encoding: Encoding, header: &[u8]) -> io::Result<()> {
        if let Some(RowSink::Text(rows)) = self.sinks.rows.as_mut().filter(|_| !self.wrote_header) {
            let names: Vec<_> = self.columns.iter().map(|(name, _)| (*name).to_owned()).collect();
            rows.writer.write_all(&rows.packing.pack(write::header(&names, self.request.format))?)?;
            self.wrote_header = true;
        }
        if let Some(rejects) = &mut self.sinks.rejects
            && self.rejects_header.as_deref() != Some(header)
        {
            rejects.writer.write_all(&rejects.packing.pack(encoding.original(header).into_owned())?)?;
            self.rejects_header = Some(header.to_vec());
        }
        Ok(())
    }

    /// Judges, counts and writes a part.
    fn settle(&mut self, part: &ToothedPart, solved: Result<Solved, LineFault>, place: &Where<'_>) -> io::Result<()> {
        self.outcome.counts.rows += 1;
        let solved = match solved {
            Ok(solved) => solved,
            Err(fault) => return self.reject(part, &fault, place),
        };
        let verdict = solved.judged.verdict;
        for note in &solved.judged.notes {
            if !self.outcome.notes.contains(note) {
                self.outcome.notes.push(note.clone());
            }
        }
        self.outcome.counts.judge(verdict);
        if solved.is_cut {
            self.cut += 1;
        }
        let failed = matches!(verdict, Some(Verdict::Fail | Verdict::Indeterminate));
        if failed && self.outcome.failures.len() < self.request.failures_kept {
            self.outcome.failures.push(self.part(part, &solved, place));
        }
        if self.request.statistics {
            self.count(&solved);
            let kept = self.part(part, &solved, place);
            let margin = Length::from_mm(kept.margin_mm).unwrap_or(Length::ZERO);
            keep_worst(&mut self.worst, Kept { part: kept, margin });
        }
        if self.request.rows.has(verdict) { self.write(part, &solved) } else { Ok(()) }
    }

    fn count(&mut self, solved: &Solved) {
        let quantities = self.outcome.statistics.iter_mut().zip(&mut self.moving).zip(QUANTITIES);
        for ((statistics, moving), (_, number)) in quantities {
            let Some(Ok(value)) = number.of(solved).map(Length::from_mm) else { continue };
            statistics.add(value);
            moving.add(value);
        }
    }

    fn reject(&mut self, part: &ToothedPart, fault: &LineFault, place: &Where<'_>) -> io::Result<()> {
        self.outcome.counts.rejected += 1;
        if let Some(rejects) = &mut self.sinks.rejects {
            let mut raw = part.raw.clone();
            if !raw.ends_with(b"\n") && !raw.ends_with(b"\r") {
                raw.push(b'\n');
            }
            rejects.writer.write_all(&rejects.packing.pack(raw)?)?;
        }
        if self.outcome.problems.len() < self.request.problems_kept {
            self.outcome.problems.push(Problem {
                file: Arc::clone(place.file),
                line: fault.line,
                record: part.record,
                place: place.unit.in_words(fault.line),
                part: Some(part.name.clone()).filter(|name| !name.is_empty()),
                column: None,
                text: String::new(),
                message: fault.message.clone(),
            });
        }
        Ok(())
    }

    /// The part with its place and margin; without a limit, the margin is how far its largest ΔCD is below 0.
    fn part(&self, part: &ToothedPart, solved: &Solved, place: &Where<'_>) -> Part {
        let JudgedTeeth { range, verdict, .. } = &solved.judged;
        // what is open stands nearest to any limit
        let open = f64::INFINITY;
        let (lowest, highest) = range.map_or((-open, open), |range| (range.lower.mm(), range.upper.mm()));
        let above = self.limit.and_then(|limit| limit.upper).map(|end| end.mm() - highest);
        let below = self.limit.and_then(|limit| limit.lower).map(|end| lowest - end.mm());
        let nearest = above.into_iter().chain(below).reduce(f64::min);
        Part {
            id: part.name.clone(),
            file: Arc::clone(place.file),
            line: part.line,
            record: part.record,
            place: place.unit.in_words(part.line),
            verdict: *verdict,
            margin_mm: nearest.unwrap_or(-highest.abs().max(lowest.abs())),
            on: nearest.map(|_| LimitTarget::CenterDistance),
            result_mm: (lowest, highest),
        }
    }

    /// Writes the row of a part.
    fn write(&mut self, part: &ToothedPart, solved: &Solved) -> io::Result<()> {
        let TeethRequest { format, decimals, .. } = self.request;
        let cells = self.columns.iter().map(|(_, column)| match column {
            Column::Id => ResultCell::Text(part.name.as_bytes().into()),
            Column::Number(of) => of.of(solved).map_or(ResultCell::Nothing, ResultCell::Number),
            Column::Verdict => match solved.judged.verdict {
                Some(verdict) => ResultCell::Text(verdict.name().as_bytes().into()),
                None => ResultCell::Nothing,
            },
        });
        match &mut self.sinks.rows {
            None => Ok(()),
            Some(RowSink::Columns(sink)) => {
                let mut row = ResultColumns::new(
                    Self::columns_written(self.request.columns.as_deref()).iter().map(|(_, kind)| *kind),
                );
                row.push(cells, decimals);
                sink.take(row)
            }
            Some(RowSink::Text(sink)) => {
                let mut out = Buffer::default();
                for (index, (cell, (name, _))) in cells.zip(&self.columns).enumerate() {
                    let start = format!("{}\"{name}\":", if index == 0 { '{' } else { ',' });
                    write::start(&mut out, index, start.as_bytes(), format);
                    write::cell(&mut out, &cell, format, decimals);
                }
                write::end(&mut out, format);
                sink.writer.write_all(&sink.packing.pack(out.written().to_vec())?)
            }
        }
    }
}

/// Where the rows of a table are.
struct Where<'a> {
    file: &'a Arc<str>,
    unit: Place,
}

/// Where the flanks of a rack carry.
fn carrying(spec: &Spec) -> Result<CarryingStrokes, Diagnostics> {
    let pair = spec.pair("the exact mesh")?;
    CarryingStrokes::of(&pair).map_err(|error| Diagnostic::error(Code::NoMesh, error.to_string()).into())
}

/// Solves parts.
struct Solver<'a> {
    judge: &'a TeethJudge,
    tables: &'a MeasuredTables,
    stroke_mm: (f64, f64),
    tolerance_mm: f64,
    /// Where a rack's flanks carry; `None` for a pinion, of which every tooth must be measured.
    strokes: Option<&'a CarryingStrokes>,
}

/// A part's curve in short.
struct Solved {
    summary: Summary,
    judged: JudgedTeeth,
    /// From the first to the last stroke that is covered.
    strokes: Range<f64>,
    /// Whether strokes that were asked for are not.
    is_cut: bool,
}

impl Solver<'_> {
    fn one(&self, part: &ToothedPart) -> Result<Solved, LineFault> {
        if let Some(fault) = &part.fault {
            return Err(fault.clone());
        }
        let bad = |message: String| LineFault { line: part.line, message };
        let (from, to) = self.stroke_mm;
        let mut tables = self.tables.clone();
        let covered = match &part.teeth {
            table::Teeth::Rack(rack) => {
                let spaces: BTreeSet<i64> = rack.measured_spaces();
                tables.rack = Some(rack.clone());
                self.strokes.map_or_else(|| vec![from..to], |strokes| strokes.measured(&spaces, from, to))
            }
            table::Teeth::Pinion(pinion) => {
                let teeth = i64::from(self.judge.measured_only().or_zero(keys::PINION_TEETH));
                if let Some(tooth) = pinion.unmeasured(teeth) {
                    return Err(bad(format!("tooth {tooth} was not measured: a turn needs all {teeth}")));
                }
                tables.pinion = Some(pinion.clone());
                vec![from..to]
            }
        };
        let first = |problems: Diagnostics| {
            bad(problems.0.first().map_or_else(|| problems.to_string(), |problem| problem.message.clone()))
        };
        let input = self.judge.measured_only().mesh(&tables).map_err(first)?;
        let strokes = match covered.as_slice() {
            [strokes] => strokes.clone(),
            [] => {
                let message = "there is no stroke at which every flank that can carry was measured";
                return Err(bad(format!("{message}: more spaces in a row are needed")));
            }
            [first, .., last] => {
                return Err(bad(format!(
                    "a space was not measured between the strokes {:.3} and {:.3} mm: give each run of spaces by itself",
                    first.end, last.start
                )));
            }
        };
        let curve = input.mesh.curve(strokes.start, strokes.end, self.tolerance_mm);
        let curve = curve.map_err(|error| bad(error.to_string()))?;
        let summary = curve.summary(&input.mesh);
        let summary = summary.ok_or_else(|| bad("the exact mesh has no points along the stroke".to_owned()))?;
        let judged = self.judge.judge(&input, &tables).map_err(first)?;
        Ok(Solved { summary, judged, is_cut: strokes != (from..to), strokes })
    }
}
