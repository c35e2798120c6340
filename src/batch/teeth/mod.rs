//! Tables with many rows per part: each part's teeth or spaces, through the exact mesh.
//!
//! The command line makes one [`Teeth`] per run and hands it table after table. The rows of a part follow each other;
//! its columns are those of [`crate::cmm`]'s tables, by their names or by what their headings mean, with one more that
//! names the part. A part of which a row is bad is rejected with all of its rows. Parts are solved side by side and
//! written in the tables' order.

mod read;

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::input::{Header, Input};
use super::layout::find_id;
use super::number::Decimals;
use super::outcome::{Kept, Outcome, Part, Problem, keep_worst};
use super::request::{RowFormat, Rows};
use super::run::{Progress, RunError, Sinks};
use super::statistics::{Moving, Statistics};
use super::{buffer::Buffer, write};
use crate::cmm::paste::heading_of_teeth;
use crate::cmm::{name_and_unit, pinion_teeth, rack_spaces};
use crate::decision::rule::decide;
use crate::decision::{Limit, LimitTarget, Rule, Verdict};
use crate::diagnostic::{Code, Diagnostic};
use crate::mesh::Summary;
use crate::quantity::Length;
use crate::spec::{MeasuredTables, Spec};
use read::{Reader, Rowset};

/// What is asked of a batch of parts with their teeth.
#[derive(Debug, Clone)]
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
    /// The column that names the part; `part_id` if `None`.
    pub id: Option<String>,
    /// Whether the run ends at the first rejected part.
    pub strict: bool,
    /// How many parts that do not pass are kept with their results.
    pub failures_kept: usize,
    /// How many rejected parts are kept with what is wrong with them.
    pub problems_kept: usize,
}

/// Which part's teeth a table has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Of {
    Rack,
    Pinion,
}

/// A column that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Column {
    Id,
    Number(Number),
    Verdict,
}

/// A result of the curve, mm.
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
}

impl Number {
    fn of(self, summary: &Summary) -> f64 {
        /// Digits beyond this, mm, are rounding of the solution.
        const FINEST: f64 = 1e12;
        let mm = match self {
            Self::Mean => summary.mean_mm,
            Self::Min => summary.min_mm,
            Self::Max => summary.max_mm,
            Self::PeakToPeak => summary.peak_to_peak_mm,
            Self::ToothToTooth => summary.tooth_to_tooth_mm,
            Self::MinStroke => summary.min_stroke_mm,
            Self::MaxStroke => summary.max_stroke_mm,
            Self::TransmissionError => summary.transmission_error_mm,
        };
        // -0 is no result
        (mm * FINEST).round() / FINEST + 0.0
    }
}

/// The columns that can be written; the first so many are written unless others are asked for.
const COLUMNS: [(&str, Column); 10] = [
    ("part_id", Column::Id),
    ("mean_delta_cd_mm", Column::Number(Number::Mean)),
    ("min_delta_cd_mm", Column::Number(Number::Min)),
    ("max_delta_cd_mm", Column::Number(Number::Max)),
    ("peak_to_peak_mm", Column::Number(Number::PeakToPeak)),
    ("tooth_to_tooth_mm", Column::Number(Number::ToothToTooth)),
    ("verdict", Column::Verdict),
    ("min_stroke_mm", Column::Number(Number::MinStroke)),
    ("max_stroke_mm", Column::Number(Number::MaxStroke)),
    ("transmission_error_mm", Column::Number(Number::TransmissionError)),
];
const WRITTEN: usize = 7;

/// The results of which there are statistics.
const QUANTITIES: [(&str, Number); 5] = [
    ("mean_delta_cd_mm", Number::Mean),
    ("min_delta_cd_mm", Number::Min),
    ("max_delta_cd_mm", Number::Max),
    ("peak_to_peak_mm", Number::PeakToPeak),
    ("tooth_to_tooth_mm", Number::ToothToTooth),
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
            wrote_header: false,
            rejects_header: None,
        })
    }

    /// What each column written holds, of those that `columns` asks for.
    #[must_use]
    pub fn column_kinds(columns: Option<&[String]>) -> Vec<super::ColumnKind> {
        use super::ColumnKind;
        let kind = |column: &Column| match column {
            Column::Id | Column::Verdict => ColumnKind::Text,
            Column::Number(_) => ColumnKind::Number,
        };
        match columns {
            None => COLUMNS[..WRITTEN].iter().map(|(_, column)| kind(column)).collect(),
            Some(names) => {
                let found = names.iter().filter_map(|name| COLUMNS.iter().find(|(known, _)| known == name));
                found.map(|(_, column)| kind(column)).collect()
            }
        }
    }

    /// The limits (mm, lower and upper) that each quantity is held against, if it is.
    #[must_use]
    pub fn quantity_limits(spec: &Spec) -> Vec<(Option<f64>, Option<f64>)> {
        let limit = spec.limits.iter().find(|(on, _)| *on == LimitTarget::CenterDistance);
        let ends = limit
            .map_or((None, None), |(_, limit)| (limit.value.lower.map(Length::mm), limit.value.upper.map(Length::mm)));
        let held = |number: Number| matches!(number, Number::Min | Number::Max);
        QUANTITIES.map(|(_, number)| if held(number) { ends } else { (None, None) }).to_vec()
    }

    /// How the columns of a table are understood that do not have the names of its own, and which are not used at all.
    #[must_use]
    pub fn understood(&self, header: &Header) -> Vec<String> {
        let id = find_id(self.spec, header, self.request.id.as_deref()).ok().flatten();
        let columns = header.columns.iter().enumerate().filter(|(index, _)| Some(*index) != id);
        let said = columns.filter_map(|(_, column)| {
            let name = table_name(column);
            if !NAMES.contains(&name_and_unit(&name).0.as_str()) {
                Some(format!("`{column}` is not used"))
            } else if name == *column {
                None
            } else {
                Some(format!("`{column}` is {name}"))
            }
        });
        said.collect()
    }

    /// Runs one table. `stop` ends the run after the parts that were begun.
    ///
    /// # Errors
    /// A diagnostic if the table's columns are not those of a rack or a pinion; [`RunError`] if it cannot be read to
    /// its end, or the results cannot be written. What was computed before is kept.
    pub fn run(
        &mut self,
        input: Input,
        stop: &AtomicBool,
        progress: &mut dyn FnMut(&Progress),
    ) -> Result<Result<(), RunError>, Diagnostic> {
        let header = &input.header;
        let id = find_id(self.spec, header, self.request.id.as_deref())?.ok_or_else(|| {
            let message = format!("{} has no column `part_id`, so its rows belong to no part", header.name);
            Diagnostic::error(Code::BadTable, message).help("name the column that has the part's name with --id")
        })?;
        let columns: Vec<_> = header.columns.iter().map(|column| table_name(column)).collect();
        let of = kind(&columns).ok_or_else(|| no_teeth(header))?;
        let name = Arc::clone(&header.name);
        let place = input.place.clone();
        let mut reader = Reader::new(input, &columns, id);
        let before = self.outcome.bytes;
        let run = (|| {
            self.start(&reader.input.header).map_err(RunError::Write)?;
            let mut parts = Vec::new();
            loop {
                // some parts for each worker, so that a slow one holds nobody up for long
                while parts.len() < 8 * self.workers {
                    match reader.next().map_err(RunError::Read)? {
                        Some(part) if !stop.load(Ordering::Relaxed) => parts.push(part),
                        _ => break,
                    }
                }
                if parts.is_empty() || stop.load(Ordering::Relaxed) {
                    return Ok(());
                }
                let solver = Solver { spec: self.spec, tables: self.tables, request: &self.request, of, name: &name };
                let solved = solver.all(&parts, self.workers);
                for (part, solved) in parts.drain(..).zip(solved) {
                    let place = Place { file: &name, of_record: place.as_deref() };
                    self.settle(&part, solved, &place).map_err(RunError::Write)?;
                    if self.is_over() {
                        return Ok(());
                    }
                }
                let counts = self.outcome.counts;
                progress(&Progress {
                    rows: counts.rows,
                    failures: counts.fail,
                    rejected: counts.rejected,
                    bytes: reader.input.chunks.bytes_read(),
                });
            }
        })();
        self.outcome.interrupted |= stop.load(Ordering::Relaxed);
        self.outcome.bytes = before + reader.input.chunks.bytes_read();
        Ok(run)
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
        let mut flushed = Ok(());
        for sink in [self.sinks.rows, self.sinks.rejects].into_iter().flatten() {
            flushed = flushed.and(sink.writer.flush());
        }
        (self.outcome, flushed)
    }

    /// Writes what stands before the first part, or before the first rejected row of another header.
    fn start(&mut self, header: &Header) -> io::Result<()> {
        if let Some(rows) = self.sinks.rows.as_mut().filter(|_| !self.wrote_header) {
            let names: Vec<_> = self.columns.iter().map(|(name, _)| (*name).to_owned()).collect();
            rows.writer.write_all(&rows.packing.pack(write::header(&names, self.request.format))?)?;
            self.wrote_header = true;
        }
        if let Some(rejects) = &mut self.sinks.rejects
            && self.rejects_header.as_ref() != Some(&header.raw)
        {
            rejects.writer.write_all(&rejects.packing.pack(header.raw.clone())?)?;
            self.rejects_header = Some(header.raw.clone());
        }
        Ok(())
    }

    /// Judges, counts and writes a part.
    fn settle(&mut self, part: &Rowset, solved: Solved, place: &Place<'_>) -> io::Result<()> {
        self.outcome.counts.rows += 1;
        let first = part.lines.first().copied().unwrap_or(0);
        let judged = solved.and_then(|summary| {
            self.verdict(&summary).map(|verdict| (summary, verdict)).map_err(|message| (first, message))
        });
        let (summary, verdict) = match judged {
            Ok(judged) => judged,
            Err((line, message)) => return self.reject(part, line, &message, place),
        };
        self.outcome.counts.judge(verdict);
        let failed = matches!(verdict, Some(Verdict::Fail | Verdict::Indeterminate));
        if failed && self.outcome.failures.len() < self.request.failures_kept {
            self.outcome.failures.push(self.part(part, &summary, verdict, place));
        }
        if self.request.statistics {
            self.count(&summary);
            let kept = self.part(part, &summary, verdict, place);
            let margin = Length::from_mm(kept.margin_mm).unwrap_or(Length::ZERO);
            keep_worst(&mut self.worst, Kept { part: kept, margin });
        }
        let line = if self.request.rows.has(verdict) { self.row(part, &summary, verdict) } else { Vec::new() };
        match &mut self.sinks.rows {
            Some(rows) if !line.is_empty() => rows.writer.write_all(&rows.packing.pack(line)?),
            _ => Ok(()),
        }
    }

    fn count(&mut self, summary: &Summary) {
        let quantities = self.outcome.statistics.iter_mut().zip(&mut self.moving).zip(QUANTITIES);
        for ((statistics, moving), (_, number)) in quantities {
            // a verdict was reached on these: they are lengths
            let value = Length::from_mm(number.of(summary)).unwrap_or(Length::ZERO);
            statistics.add(value);
            moving.add(value);
        }
    }

    fn reject(&mut self, part: &Rowset, line: u64, message: &str, place: &Place<'_>) -> io::Result<()> {
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
                line,
                record: part.record,
                place: place.of(part.record),
                column: None,
                text: String::new(),
                message: format!("part {}: {message}", part.id),
            });
        }
        Ok(())
    }

    fn verdict(&self, summary: &Summary) -> Result<Option<Verdict>, String> {
        let Some(limit) = self.limit else { return Ok(None) };
        let lower = Length::from_mm(summary.min_mm).map_err(|error| error.to_string())?;
        let upper = Length::from_mm(summary.max_mm).map_err(|error| error.to_string())?;
        let decision = decide(&self.request.rule, limit, (lower, upper), None, None);
        decision.map(|decision| Some(decision.verdict)).map_err(|error| error.to_string())
    }

    /// The part with its place and margin; without a limit, the margin is how far its largest ΔCD is below 0.
    fn part(&self, part: &Rowset, summary: &Summary, verdict: Option<Verdict>, place: &Place<'_>) -> Part {
        let above = self.limit.and_then(|limit| limit.upper).map(|end| end.mm() - summary.max_mm);
        let below = self.limit.and_then(|limit| limit.lower).map(|end| summary.min_mm - end.mm());
        let nearest = above.into_iter().chain(below).reduce(f64::min);
        Part {
            id: part.id.clone(),
            file: Arc::clone(place.file),
            line: part.lines.first().copied().unwrap_or(0),
            record: part.record,
            place: place.of(part.record),
            verdict,
            margin_mm: nearest.unwrap_or(-summary.max_mm.abs().max(summary.min_mm.abs())),
            on: nearest.map(|_| LimitTarget::CenterDistance),
            result_mm: (Number::Min.of(summary), Number::Max.of(summary)),
        }
    }

    fn row(&self, part: &Rowset, summary: &Summary, verdict: Option<Verdict>) -> Vec<u8> {
        let format = self.request.format;
        let mut out = Buffer::default();
        for (index, (name, column)) in self.columns.iter().enumerate() {
            match format {
                RowFormat::JsonLines => {
                    let start = if index == 0 { "{" } else { "," };
                    out.extend(format!("{start}\"{name}\":").as_bytes());
                }
                RowFormat::Csv if index > 0 => out.extend(b","),
                RowFormat::Tsv if index > 0 => out.extend(b"\t"),
                RowFormat::Csv | RowFormat::Tsv => {}
            }
            match (column, verdict) {
                (Column::Id, _) => write::text(&mut out, part.id.as_bytes(), format),
                (Column::Number(of), _) => out.extend(self.request.decimals.text(of.of(summary)).as_bytes()),
                (Column::Verdict, Some(verdict)) => write::text(&mut out, verdict.name().as_bytes(), format),
                (Column::Verdict, None) if format == RowFormat::JsonLines => out.extend(b"null"),
                (Column::Verdict, None) => {}
            }
        }
        out.extend(if format == RowFormat::JsonLines { b"}\n" } else { b"\n" });
        out.written().to_vec()
    }
}

/// Where the records of a table are.
struct Place<'a> {
    file: &'a Arc<str>,
    of_record: Option<&'a (dyn Fn(u64) -> String + Send + Sync)>,
}

impl Place<'_> {
    fn of(&self, record: u64) -> Option<String> {
        self.of_record.map(|place| place(record))
    }
}

/// What a table of one part calls a column: its own name if that is known, or what its heading means.
fn table_name(column: &str) -> String {
    let (name, _) = name_and_unit(column);
    if NAMES.contains(&name.as_str()) {
        column.to_owned()
    } else {
        heading_of_teeth(column).unwrap_or_else(|| column.to_owned())
    }
}

const RACK: [&str; 5] = ["over_pin", "over_pin_deviation", "position", "position_deviation", "space"];
const PINION: [&str; 4] = ["radial_deviation", "left_pitch_deviation", "right_pitch_deviation", "tooth"];
const NAMES: [&str; 10] =
    [RACK[0], RACK[1], RACK[2], RACK[3], RACK[4], PINION[0], PINION[1], PINION[2], PINION[3], "lead_deviation"];

/// Whose teeth the columns are of.
fn kind(columns: &[String]) -> Option<Of> {
    let has = |names: &[&str]| columns.iter().any(|column| names.contains(&name_and_unit(column).0.as_str()));
    if has(&RACK) {
        Some(Of::Rack)
    } else if has(&PINION) {
        Some(Of::Pinion)
    } else {
        None
    }
}

fn no_teeth(header: &Header) -> Diagnostic {
    Diagnostic::error(Code::BadTable, format!("{} has no column of a rack's spaces or a pinion's teeth", header.name)).help(
        format!(
            "it has {}; a rack has space, over_pin or over_pin_deviation, position or position_deviation, lead_deviation; \
             a pinion tooth, radial_deviation, left_pitch_deviation, right_pitch_deviation, lead_deviation",
            header.names()
        ),
    )
}

/// Solves parts.
struct Solver<'a> {
    spec: &'a Spec,
    tables: &'a MeasuredTables,
    request: &'a TeethRequest,
    of: Of,
    name: &'a str,
}

type Solved = Result<Summary, (u64, String)>;

impl Solver<'_> {
    /// Solves every part, side by side.
    fn all(&self, parts: &[Rowset], workers: usize) -> Vec<Solved> {
        let next = AtomicUsize::new(0);
        let solved: Vec<Mutex<Option<Solved>>> = parts.iter().map(|_| Mutex::new(None)).collect();
        std::thread::scope(|scope| {
            for _ in 0..workers.min(parts.len()) {
                scope.spawn(|| {
                    loop {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        let (Some(part), Some(slot)) = (parts.get(index), solved.get(index)) else { return };
                        *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(self.one(part));
                    }
                });
            }
        });
        let missing = || Err((0, "the part was not solved".to_owned()));
        solved
            .into_iter()
            .map(|slot| slot.into_inner().unwrap_or_else(PoisonError::into_inner).unwrap_or_else(missing))
            .collect()
    }

    fn one(&self, part: &Rowset) -> Solved {
        if let Some(bad) = &part.bad {
            return Err(bad.clone());
        }
        let first = part.lines.first().copied().unwrap_or(0);
        let table = String::from_utf8_lossy(&part.table);
        // a line of the part's own table is a row's place in the whole one
        let of_row = |diagnostic: &Diagnostic| {
            let line = diagnostic.place.as_ref().map(|place| place.line_and_column().0);
            let line = line.and_then(|line| part.lines.get(line.checked_sub(2)?)).copied();
            (line.unwrap_or(first), diagnostic.message.clone())
        };
        let mut tables = self.tables.clone();
        match self.of {
            Of::Rack => tables.rack = Some(rack_spaces(self.name, &table).map_err(|problem| of_row(&problem))?),
            Of::Pinion => tables.pinion = Some(pinion_teeth(self.name, &table).map_err(|problem| of_row(&problem))?),
        }
        let input = self
            .spec
            .mesh(&tables)
            .map_err(|problems| problems.0.first().map_or_else(|| (first, problems.to_string()), of_row))?;
        let (from, to) = self.request.stroke_mm;
        let curve =
            input.mesh.curve(from, to, self.request.tolerance_mm).map_err(|error| (first, error.to_string()))?;
        curve.summary(&input.mesh).ok_or_else(|| (first, "the exact mesh has no points along the stroke".to_owned()))
    }
}
