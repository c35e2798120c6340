//! Tables with many rows per part: each part's teeth or spaces, through the exact mesh.
//!
//! The rows of a part follow each other; its columns are those of [`crate::cmm`]'s tables, with one more that
//! names the part. A part of which a row is bad is rejected with all of its rows. Parts are solved side by
//! side and written in the table's order.

use std::io;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::chunk::Holds;
use super::input::{Input, text};
use super::layout::find_id;
use super::number::Decimals;
use super::outcome::{Outcome, Part, Problem};
use super::request::{RowFormat, Rows};
use super::run::{RunError, Sinks};
use super::split::next_record;
use super::{buffer::Buffer, write};
use crate::cmm::{name_and_unit, pinion_teeth, rack_spaces};
use crate::decision::rule::decide;
use crate::decision::{LimitTarget, Rule, Verdict};
use crate::diagnostic::{Code, Diagnostic};
use crate::mesh::Summary;
use crate::quantity::Length;
use crate::spec::{MeasuredTables, Spec};

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
    /// Which parts are written.
    pub rows: Rows,
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

/// One part's rows.
#[derive(Debug, Default)]
struct Rowset {
    id: String,
    /// Its table, without the column that names the part.
    table: Vec<u8>,
    raw: Vec<u8>,
    /// The line of each row.
    lines: Vec<u64>,
    /// The record of its first row.
    record: u64,
    /// What is wrong with a row of it, and on which line.
    bad: Option<(u64, String)>,
}

const COLUMNS: [&str; 7] = [
    "part_id",
    "mean_delta_cd_mm",
    "min_delta_cd_mm",
    "max_delta_cd_mm",
    "peak_to_peak_mm",
    "tooth_to_tooth_mm",
    "verdict",
];

/// Runs a table with a row per tooth or space. In the counts of the outcome, a row is a part.
///
/// # Errors
/// A diagnostic if the table's columns are not those of a rack or a pinion; [`RunError`] if it cannot be read
/// to its end, or the results cannot be written.
pub fn run_teeth(
    spec: &Spec,
    tables: &MeasuredTables,
    input: Input,
    request: &TeethRequest,
    mut sinks: Sinks<'_>,
    workers: usize,
    stop: &AtomicBool,
) -> Result<Result<Outcome, RunError>, Diagnostic> {
    let id = find_id(spec, &input.header, request.id.as_deref())?.ok_or_else(|| {
        Diagnostic::error(
            Code::BadTable,
            format!("{} has no column `part_id`, so its rows belong to no part", input.header.name),
        )
        .help("name the column that has the part's name with --id")
    })?;
    let of = kind(&input.header.columns).ok_or_else(|| {
        Diagnostic::error(Code::BadTable, format!("{} has no column of a rack's spaces or a pinion's teeth", input.header.name))
            .help(format!(
                "it has {}; a rack has space, over_pin or over_pin_deviation, position or position_deviation, lead_deviation; \
                 a pinion tooth, radial_deviation, left_pitch_deviation, right_pitch_deviation, lead_deviation",
                input.header.columns.join(", ")
            ))
    })?;
    let solver = Solver { spec, tables, request, of, name: Arc::clone(&input.header.name) };
    let mut reader = Reader::new(input, id);
    let mut outcome = Outcome::default();
    let run = (|| {
        let names = COLUMNS.map(str::to_owned);
        if let Some(rows) = &mut sinks.rows {
            let header = rows.packing.pack(write::header(&names, request.format)).map_err(RunError::Write)?;
            rows.writer.write_all(&header).map_err(RunError::Write)?;
        }
        if let Some(rejects) = &mut sinks.rejects {
            let header = rejects.packing.pack(reader.input.header.raw.clone()).map_err(RunError::Write)?;
            rejects.writer.write_all(&header).map_err(RunError::Write)?;
        }
        let mut parts = Vec::new();
        loop {
            // some parts for each worker, so that a slow one holds nobody up for long
            while parts.len() < 8 * workers {
                match reader.next().map_err(RunError::Read)? {
                    Some(part) if !stop.load(Ordering::Relaxed) => parts.push(part),
                    _ => break,
                }
            }
            if parts.is_empty() || stop.load(Ordering::Relaxed) {
                break;
            }
            let solved = solver.all(&parts, workers);
            for (part, solved) in parts.drain(..).zip(solved) {
                solver.settle(&part, solved, &mut outcome, &mut sinks).map_err(RunError::Write)?;
                if request.strict && outcome.counts.rejected > 0 {
                    return Ok(());
                }
            }
        }
        Ok(())
    })();
    outcome.interrupted = stop.load(Ordering::Relaxed);
    outcome.bytes = reader.input.chunks.bytes_read();
    let flushed = [sinks.rows, sinks.rejects].into_iter().flatten().try_for_each(|sink| sink.writer.flush());
    Ok(run.and(flushed.map_err(RunError::Write)).map(|()| outcome))
}

/// Whose teeth the columns are of.
fn kind(columns: &[String]) -> Option<Of> {
    let has = |names: &[&str]| columns.iter().any(|column| names.contains(&name_and_unit(column).0.as_str()));
    if has(&["over_pin", "over_pin_deviation", "position", "position_deviation", "space"]) {
        Some(Of::Rack)
    } else if has(&["radial_deviation", "left_pitch_deviation", "right_pitch_deviation", "tooth"]) {
        Some(Of::Pinion)
    } else {
        None
    }
}

/// Reads part by part.
struct Reader {
    input: Input,
    id: usize,
    /// The separator of the parts' own tables.
    separator: u8,
    chunk: Vec<u8>,
    at: usize,
    lines: u64,
    records: u64,
    /// The part whose rows are being read.
    open: Option<Rowset>,
}

impl Reader {
    fn new(mut input: Input, id: usize) -> Self {
        input.chunks.set_separator(input.header.separator);
        let separator = if input.header.separator == b'|' { b'\t' } else { input.header.separator };
        let lines = input.lines;
        Self { input, id, separator, chunk: Vec::new(), at: 0, lines, records: 0, open: None }
    }

    /// A line of the part's own table.
    fn line(&self, cells: &[String]) -> Vec<u8> {
        let mut line = Vec::new();
        let others = cells.iter().enumerate().filter(|(index, _)| *index != self.id);
        for (index, (_, cell)) in others.enumerate() {
            if index > 0 {
                line.push(self.separator);
            }
            let quoted = cell.contains([char::from(self.separator), '"', '\n', '\r']);
            line.extend(if quoted { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.clone() }.bytes());
        }
        line.push(b'\n');
        line
    }

    fn next(&mut self) -> io::Result<Option<Rowset>> {
        let (mut fields, mut scratch, mut blank) = (Vec::new(), Vec::new(), 0);
        loop {
            let record = next_record(&self.chunk, self.at, self.input.header.separator, &mut fields, &mut blank);
            let Some(record) = record else {
                self.lines += blank;
                self.at = 0;
                // what was read is done with, at the end of the table too
                self.chunk.clear();
                match self.input.chunks.next(&mut self.chunk)? {
                    None => return Ok(self.open.take()),
                    Some(Holds::Records { .. }) => {}
                    Some(Holds::Piece { first, .. }) => {
                        // the part with a row that is too long is bad, and the row's pieces are its rows
                        let line = self.lines + 1;
                        let part = self.open.get_or_insert_with(Rowset::default);
                        if first {
                            part.bad = Some((line, "a row is longer than 256 KiB".to_owned()));
                        }
                        part.raw.extend_from_slice(&self.chunk);
                        self.lines += memchr::memchr_iter(b'\n', &self.chunk).count() as u64;
                        self.chunk.clear();
                    }
                }
                continue;
            };
            let line = self.lines + record.lines_before + 1;
            let cells: Vec<String> =
                fields.iter().map(|field| text(field.content(&self.chunk, &mut scratch)).into_owned()).collect();
            let columns = self.input.header.columns.len();
            let id = cells.get(self.id).map(|id| id.trim().to_owned()).unwrap_or_default();
            let whole = cells.len() == columns && !record.open;
            // a row that is too short to name its part belongs to the one it stands in
            let continues = self.open.as_ref().is_some_and(|part| part.id == id || (!whole && id.is_empty()));
            if !continues && self.open.is_some() {
                return Ok(self.open.take());
            }
            self.records += 1;
            self.lines += record.lines;
            self.at = record.next;
            let row = self.line(&cells);
            let head = self.line(&self.input.header.columns);
            let raw: Range<usize> = record.start..record.next;
            let records = self.records;
            let part = self.open.get_or_insert_with(|| Rowset { id, record: records, ..Rowset::default() });
            if part.table.is_empty() {
                part.table = head;
            }
            if !whole && part.bad.is_none() {
                let found = format!("the row has {} fields and the header has {columns}", cells.len());
                let message = if record.open { "a quote is not closed".to_owned() } else { found };
                part.bad = Some((line, message));
            }
            part.table.extend(row);
            part.raw.extend_from_slice(&self.chunk[raw]);
            part.lines.push(line);
        }
    }
}

/// Solves parts.
struct Solver<'a> {
    spec: &'a Spec,
    tables: &'a MeasuredTables,
    request: &'a TeethRequest,
    of: Of,
    name: Arc<str>,
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
            Of::Rack => tables.rack = Some(rack_spaces(&self.name, &table).map_err(|problem| of_row(&problem))?),
            Of::Pinion => tables.pinion = Some(pinion_teeth(&self.name, &table).map_err(|problem| of_row(&problem))?),
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

    /// Judges, counts and writes a part.
    fn settle(&self, part: &Rowset, solved: Solved, outcome: &mut Outcome, sinks: &mut Sinks<'_>) -> io::Result<()> {
        outcome.counts.rows += 1;
        let verdict = solved.and_then(|summary| {
            let first = part.lines.first().copied().unwrap_or(0);
            self.verdict(&summary).map(|verdict| (summary, verdict)).map_err(|message| (first, message))
        });
        let (summary, verdict) = match verdict {
            Ok(judged) => judged,
            Err((line, message)) => {
                outcome.counts.rejected += 1;
                if let Some(rejects) = &mut sinks.rejects {
                    let mut raw = part.raw.clone();
                    if !raw.ends_with(b"\n") && !raw.ends_with(b"\r") {
                        raw.push(b'\n');
                    }
                    rejects.writer.write_all(&rejects.packing.pack(raw)?)?;
                }
                if outcome.problems.len() < self.request.problems_kept {
                    let message = format!("part {}: {message}", part.id);
                    outcome.problems.push(Problem {
                        file: Arc::clone(&self.name),
                        line,
                        record: part.record,
                        place: None,
                        column: None,
                        text: String::new(),
                        message,
                    });
                }
                return Ok(());
            }
        };
        outcome.counts.judge(verdict);
        let failed = matches!(verdict, Some(Verdict::Fail | Verdict::Indeterminate));
        if failed && outcome.failures.len() < self.request.failures_kept {
            outcome.failures.push(self.failure(part, &summary, verdict));
        }
        match &mut sinks.rows {
            Some(rows) if self.request.rows.has(verdict) => {
                let line = self.row(part, &summary, verdict);
                rows.writer.write_all(&rows.packing.pack(line)?)
            }
            _ => Ok(()),
        }
    }

    fn verdict(&self, summary: &Summary) -> Result<Option<Verdict>, String> {
        let limit = self.spec.limits.iter().find(|(on, _)| *on == LimitTarget::CenterDistance);
        let Some((_, limit)) = limit else { return Ok(None) };
        let lower = Length::from_mm(summary.min_mm).map_err(|error| error.to_string())?;
        let upper = Length::from_mm(summary.max_mm).map_err(|error| error.to_string())?;
        let decision = decide(&self.request.rule, &limit.value, (&lower, &upper), None, None);
        decision.map(|decision| Some(decision.verdict)).map_err(|error| error.to_string())
    }

    fn failure(&self, part: &Rowset, summary: &Summary, verdict: Option<Verdict>) -> Part {
        let limit = self.spec.limits.iter().find(|(on, _)| *on == LimitTarget::CenterDistance);
        let above = limit.and_then(|(_, limit)| limit.value.upper.as_ref()).map(|end| end.mm() - summary.max_mm);
        let below = limit.and_then(|(_, limit)| limit.value.lower.as_ref()).map(|end| summary.min_mm - end.mm());
        Part {
            id: part.id.clone(),
            file: Arc::clone(&self.name),
            line: part.lines.first().copied().unwrap_or(0),
            record: part.record,
            place: None,
            verdict,
            margin_mm: above.into_iter().chain(below).fold(f64::INFINITY, f64::min),
            on: Some(LimitTarget::CenterDistance),
            result_mm: (summary.min_mm, summary.max_mm),
        }
    }

    fn row(&self, part: &Rowset, summary: &Summary, verdict: Option<Verdict>) -> Vec<u8> {
        let format = self.request.format;
        let mut out = Buffer::default();
        let numbers =
            [summary.mean_mm, summary.min_mm, summary.max_mm, summary.peak_to_peak_mm, summary.tooth_to_tooth_mm];
        let number = |mm: f64| match (self.request.decimals, Length::from_mm(mm)) {
            (Decimals::Places(places), Ok(length)) => length.exact_mm().to_decimal_text(u16::from(places)),
            _ => crate::report::plain(mm),
        };
        for (index, column) in COLUMNS.iter().enumerate() {
            match format {
                RowFormat::JsonLines => {
                    let start = if index == 0 { "{" } else { "," };
                    out.extend(format!("{start}\"{column}\":").as_bytes());
                }
                RowFormat::Csv if index > 0 => out.extend(b","),
                RowFormat::Tsv if index > 0 => out.extend(b"\t"),
                RowFormat::Csv | RowFormat::Tsv => {}
            }
            match (index, index.checked_sub(1).and_then(|index| numbers.get(index)), verdict) {
                (0, ..) => write::text(&mut out, part.id.as_bytes(), format),
                (_, Some(mm), _) => out.extend(number(*mm).as_bytes()),
                (_, None, Some(verdict)) => write::text(&mut out, verdict.name().as_bytes(), format),
                (_, None, None) if format == RowFormat::JsonLines => out.extend(b"null"),
                (_, None, None) => {}
            }
        }
        out.extend(if format == RowFormat::JsonLines { b"}\n" } else { b"\n" });
        out.written().to_vec()
    }
}
