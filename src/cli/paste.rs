//! `rackmesh paste`: measured values from the clipboard, a mail, a terminal.

use std::cell::Cell;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::decision::JudgeArgs;
use super::output::{Failure, Output, Status};
use super::set::SetArgs;
use super::tables::{self, Opened, Opener, ReadArgs, Reopened};
use super::target::{self, Target, is_dash};
use super::{batch, confirm, function, mesh, office, page, signals, spec_files, stream, teeth, terminal};
use crate::batch::{
    self as batch_room, Batch, Decimals, Layout, Packing, PartSink, Plan, Problem, Request, RowSink, Sink, Sinks,
    TeethJudge,
};
use crate::deviation::Part;
use crate::diagnostic::{Code, Diagnostic};
use crate::mesh::TOLERANCE_MM;
use crate::report::{self, EvaluationReport, Format, PartsReport, Report, SpacesReport, WithReading, YokeSection};
use crate::spec::Spec;
use crate::table::{Reading, Table, ToothedPart, gather};

pub(super) const ABOUT: &str = "Evaluate pasted values: cells of a sheet, a CMM report, a mail";

#[derive(Debug, clap::Args)]
#[command(after_help = "Typed or pasted into a terminal, the block ends with Ctrl-D; blank lines belong to it.
How it was understood is said in one line; what could mean two things is refused.
--output writes .html, .xlsx, .dfq, .csv, .json, .md or .txt beside what is printed.

Examples:
  rackmesh paste examples/steering.toml examples/cmm-report.txt
  rackmesh paste rack.toml < values.txt
  rackmesh paste rack.toml --as rack_over_roller,rack_pitch
  rackmesh paste rack.toml --decimal comma --format csv < values.txt
  rackmesh paste examples/mesh.toml --mesh < spaces.txt

Exit status: 0 inside the limits or none given, 1 outside, 2 could not judge, 3 indeterminate by the
rule, 129, 130 or 143 interrupted.")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: PathBuf,
    /// A file with the block, or any table that `rackmesh batch` reads; standard input unless given.
    file: Option<PathBuf>,
    /// The file to write; the ending of its name tells the format.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Add the exact mesh of the same parts, along a stroke of 50 mm.
    #[arg(long)]
    mesh: bool,
    #[command(flatten)]
    judge: JudgeArgs,
    /// Judge without errors that the spec asks for and the table lacks.
    #[arg(long)]
    partial: bool,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
    #[command(flatten)]
    reading: ReadArgs,
}

/// The largest block that is read from standard input.
const LARGEST_BLOCK: u64 = 4 << 20;
/// Parts that are shown at most: `batch` is for more.
const MOST_PARTS: usize = 20_000;
/// Rejected rows that are named on standard error.
const PROBLEMS_SHOWN: usize = 20;

/// The endings of the output file.
const ENDINGS: [&str; 8] = ["html", "htm", "xlsx", "dfq", "csv", "json", "md", "txt"];

/// The result of a block.
struct Shown<'a> {
    /// The name of the part or the parts.
    title: &'a str,
    report: &'a dyn Report,
    /// The rows of a workbook or a Q-DAS file, header included: a part, a space or a tooth each.
    rows: Vec<Vec<String>>,
}

/// What was read, with remarks.
struct ReadBlock {
    spec: Arc<Spec>,
    readings: Vec<Reading>,
    notes: Vec<String>,
    /// The file that is written, begun.
    target: Cell<Option<Target>>,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let (spec, target) = match self.begin(output) {
            Ok(begun) => begun,
            Err(failure) => {
                let status = output.finish(Err(failure));
                if self.path().is_none() {
                    terminal::discard_block(output);
                }
                return Ok(status);
            }
        };
        let interruption = signals::signals(output);
        let found = self.open(&spec, interruption.stop(), output);
        if let Some(status) = signals::signals(output).status() {
            output.message(signals::NOTHING_YET);
            return Ok(status);
        }
        let found = found?;
        let Opened { table, spec, notes } = &found.opened;
        let readings = vec![table.reading.clone()];
        let mut read = ReadBlock { spec: Arc::clone(spec), readings, notes: notes.clone(), target: Cell::new(target) };
        read.notes.extend(read.spec.suspicions_in_words());
        if table.is_teeth { self.teeth(read, found.opened.table, output) } else { self.parts(read, found, output) }
    }

    /// The spec, and the file that is written, begun.
    fn begin(&self, output: &mut Output) -> Result<(Arc<Spec>, Option<Target>), Failure> {
        let spec = self.reading.laid_out(self.set.read_spec(&self.spec, output)?)?;
        let target = self.output.as_ref().map(|path| {
            target::known_ending(path, path, &ENDINGS)?;
            Target::create(path, &self.inputs(&spec))
        });
        Ok((Arc::new(spec), target.transpose()?))
    }

    /// The file with the block; `None` where standard input has it.
    fn path(&self) -> Option<&Path> {
        self.file.as_deref().filter(|path| !is_dash(path))
    }

    /// The name of a part without one: the spec's title names the pair, not this part.
    fn block_name(&self) -> String {
        let file = self.path().and_then(Path::file_name);
        file.map_or_else(|| "pasted part".to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// The files that are read.
    fn inputs(&self, spec: &Spec) -> Vec<PathBuf> {
        let block = self.file.clone().unwrap_or_else(|| "-".into());
        let files: Vec<PathBuf> = self.reading.layout_file().into_iter().cloned().chain([block]).collect();
        spec_files::inputs(spec, &self.spec, &files)
    }

    fn open<'a>(
        &'a self,
        spec: &Arc<Spec>,
        stop: &'a Arc<AtomicBool>,
        output: &mut Output,
    ) -> Result<Reopened<'a>, Failure> {
        let opener = Opener::new(&self.reading, spec, self.judge.model, stop);
        let mut rest = None;
        let (opener, opened, path) = if let Some(path) = self.path() {
            let opened = opener.open(path);
            (opener, opened, path.to_owned())
        } else {
            let bytes = terminal::read_block(output, LARGEST_BLOCK, &mut rest)?;
            let opened = opener.block(bytes.clone());
            (Opener { stdin: Some(bytes.into()), ..opener }, opened, PathBuf::from("-"))
        };
        match opened {
            Err(failure) if confirm::can_ask() && !signals::signals(output).came() => {
                confirm::confirmed(&opener, (&path, opener.contract_file(&self.spec)), self.partial, &mut rest, output)?
                    .ok_or(failure)
            }
            opened => Ok(Reopened { opened: opened?, opener, path }),
        }
    }

    /// Prints a report with how its table was read, and writes it to the file asked for.
    fn report(&self, shown: &Shown<'_>, read: &ReadBlock, output: &mut Output) -> Result<(), Failure> {
        let Shown { title, report, rows } = shown;
        let readings = &read.readings;
        let whole = WithReading { report: *report, readings, notes: &read.notes };
        if let Some((path, target)) = self.output.as_ref().zip(read.target.take()) {
            let text = |format| report::write(&whole, format, output.screen().of_file()).map(String::into_bytes);
            let bytes = match target::known_ending(path, path, &ENDINGS)? {
                Some("html" | "htm") => {
                    page::of_report(title, &read.spec, *report, readings, &read.notes, &self.inputs(&read.spec))?
                        .into_bytes()
                }
                Some("xlsx" | "dfq") => {
                    let notes = report::said(readings, &read.notes);
                    office::bytes(&target::shown(path), rows, (title, &read.spec.limits()), &notes)?
                }
                Some("csv") => text(Format::Csv)?,
                Some("json") => text(Format::Json)?,
                Some("md") => text(Format::Markdown)?,
                _ => text(Format::Table)?,
            };
            target.write_whole(&bytes)?;
        }
        if self.format == Format::Json {
            output.report(&whole, self.format)
        } else {
            output.report(*report, self.format)
        }
    }

    /// The parts of a block, as a batch judges them.
    fn parts(&self, mut read: ReadBlock, found: Reopened<'_>, output: &mut Output) -> Result<Status, Failure> {
        if self.mesh {
            let message = "--mesh needs values of spaces or teeth; these are values of whole parts";
            return Err(Diagnostic::usage(message)
                .help("for a part's errors put on its teeth: rackmesh eval --mesh")
                .into());
        }
        let Reopened { opened: Opened { table, .. }, opener, path } = found;
        let (request, is_named) = (self.request(&read.spec)?, table.has_id);
        let mut columns = Plan::usual_columns(&read.spec, &table, &request)?;
        columns.extend(PartsReport::ASKED_FOR.map(str::to_owned));
        read.spec = Arc::new(teeth::with_known_teeth((*read.spec).clone(), &self.spec, output)?);
        let plan = Plan::new(&read.spec, &table, Request { columns: Some(columns), ..request })?;
        batch::unjudged(&plan, output);
        let layout = Layout::new(&plan, &table)?;
        let (mut text, mut listed) = (Vec::new(), Listed::default());
        let rows = Some(RowSink::Text(Sink { writer: &mut text, packing: Packing::None }));
        let mut lot = Batch::new(&plan, Sinks { rows, rejects: None, parts: Some(&mut listed) }, None);
        let run = lot.run(table, &layout, opener.stop, &mut |_| {});
        let (mut outcome, written) = lot.finish();
        if listed.is_full() {
            let message = format!("{} has more than {MOST_PARTS} parts", stream::name(&path));
            return Err(Diagnostic::error(Code::BadTable, message)
                .help("`rackmesh batch` evaluates tables of any length")
                .into());
        }
        written?;
        if let Some(problem) = batch::unfinished(&path, run)? {
            return Err(problem.into());
        }
        outcome.tell_duplicates();
        read.readings = std::mem::take(&mut outcome.readings);
        read.notes.extend(std::mem::take(&mut outcome.notes).into_iter().chain(batch::notes(&read.spec, &plan)));
        tables::say(&read.readings, &read.notes, output);
        outcome.problems.iter().for_each(|problem| output.message(&problem.to_string()));
        let basis = report::Basis::of(&plan);
        let status = batch::status(&outcome, &basis, false);
        let Listed { parts, problems } = listed;
        if outcome.counts.rows == 0 {
            let message = "there is no part in the block, so none was checked";
            output.diagnostic(&Diagnostic::warning(Code::BadTable, message));
        } else if let ([part], []) = (&parts[..], &problems[..]) {
            let title = if is_named { format!("part {}", part.id) } else { self.block_name() };
            let cells = rows_of(&text)?;
            let report = self.only(&plan, (&title, part), output)?;
            self.report(&Shown { title: &title, report: &report, rows: cells }, &read, output)?;
        } else {
            let (title, rows) = (read.spec.title.as_deref(), &rows_of(&text)?[..]);
            let report =
                PartsReport { title, rows, parts: &parts, problems: &problems, basis: &basis, outcome: &outcome };
            let (cells, title) = (report.rows(), read.spec.title.clone().unwrap_or_else(|| self.block_name()));
            self.report(&Shown { title: &title, report: &report, rows: cells }, &read, output)?;
        }
        Ok(status)
    }

    /// The request for the parts of a block.
    fn request(&self, spec: &Spec) -> Result<Request, Failure> {
        Ok(Request {
            model: self.judge.model,
            stack: self.judge.stack,
            rule: self.judge.rule(spec),
            monte_carlo: self.judge.settings()?,
            decimals: Decimals::Full,
            partial: self.partial,
            lists_parts: true,
            problems_kept: PROBLEMS_SHOWN,
            ..Request::default()
        })
    }

    /// The only part of a block in the form of `eval`, with the verdict of the batch.
    fn only<'s>(
        &self,
        plan: &Plan,
        (title, part): (&'s str, &batch_room::Part),
        output: &Output,
    ) -> Result<EvaluationReport<'s>, Failure> {
        let (spec, mut evaluation, uncertainty) = self.judge.of_part(plan, part, output)?;
        if !plan.is_yoke_limited() {
            evaluation.verdict = part.verdict;
        }
        let mut report = EvaluationReport::new(Some(title), evaluation, &spec.missing_geometry());
        report.uncertainty = uncertainty;
        report.yoke =
            part.yoke.as_deref().zip(plan.yoke.as_ref()).map(|(yoke, judge)| YokeSection::of_part(yoke, judge));
        report.without = if plan.is_partial() { plan.lacking.clone() } else { Vec::new() };
        Ok(report)
    }

    fn teeth(&self, mut read: ReadBlock, table: Table, output: &mut Output) -> Result<Status, Failure> {
        let name = Arc::clone(&table.name);
        let mut parts = gather(table, &mut read.readings[0])?.into_iter();
        let (part, others) = (parts.next(), parts.next());
        let Some(part) = part else {
            return Err(Diagnostic::error(Code::BadTable, format!("{name} has no rows")).into());
        };
        if others.is_some() {
            let message = format!("{name} has teeth or spaces of several parts");
            return Err(Diagnostic::error(Code::BadTable, message)
                .help("`rackmesh batch --teeth` evaluates them")
                .into());
        }
        if let Some(fault) = part.fault {
            let message = format!("{name}, line {}: {}", fault.line, fault.message);
            return Err(Diagnostic::error(Code::BadRow, message).into());
        }
        if read.spec.has_other_deviations(part.teeth.part()) {
            read.notes.push("the table takes the place of the deviations in the spec".to_owned());
        }
        tables::say(&read.readings, &read.notes, output);
        self.spaces(read, part, output)
    }

    fn spaces(&self, mut read: ReadBlock, part: ToothedPart, output: &mut Output) -> Result<Status, Failure> {
        let (spec, teeth, is_rejected) = (&Arc::clone(&read.spec), part.teeth, part.rejected_on.is_some());
        let measured = spec.measured(&teeth, self.judge.model)?;
        let title = self.block_name();
        let mut report = SpacesReport { title: Some(&title), measured: &measured, mesh: None, is_rejected };
        let missing = spec.missing_geometry();
        let rows = report.rows();
        let asks = !(spec.limits.is_empty() && spec.function_limits.is_empty());
        if !asks && !self.mesh {
            self.report(&Shown { title: &title, report: &report, rows }, &read, output)?;
            return Ok(if is_rejected { Status::Fail } else { Status::Pass });
        }
        if !missing.is_empty() && !self.mesh {
            let unjudged = unjudged_teeth(&missing);
            read.notes.push(format!("no limit is judged: {}", unjudged.message));
            self.report(&Shown { title: &title, report: &report, rows }, &read, output)?;
            output.diagnostic(&unjudged);
            return Ok(if is_rejected { Status::Fail } else { Status::Undecided });
        }
        let judge = TeethJudge::new(spec, measured.part, self.judge.rule(spec), self.partial)?;
        let only = judge.measured_only();
        let all = spec_files::measured_tables(only, &self.spec, output)?.with(teeth);
        let input = only.mesh(&all)?;
        let mut judged = judge.judge(&input, &all)?;
        judged.evaluation.reject_if(is_rejected);
        let covered = judged.strokes.clone();
        let yoke = spec.yoke_judge(None, &self.judge.rule(spec))?;
        // the curve of a yoke is that of its strokes
        let of_yoke = yoke.as_ref().map(|yoke| yoke.strokes_mm).filter(|(from, to)| input.measures_strokes(*from, *to));
        let (from, to) = of_yoke.unwrap_or((covered.start, covered.end));
        let curve = input.mesh.curve(from, to, TOLERANCE_MM)?;
        let yoke = yoke.map(|yoke| {
            let part = judge.yoke(&yoke, &judged, (&input, &all), of_yoke.map(|_| &curve));
            YokeSection::of_part(&part, &yoke)
        });
        let mut solved = mesh::solved(spec, &input, curve, judged.evaluation)?;
        solved.yoke = yoke;
        solved.screen = output.screen();
        solved.notes.extend(judge.notes().into_iter().chain(judged.notes));
        if measured.part == Part::Rack {
            solved.notes.push(format!(
                "the strokes whose contacts were measured are {:.3} to {:.3} mm: the others are not judged",
                covered.start, covered.end
            ));
        }
        let checks = solved.yoke.as_ref().map_or(&[][..], YokeSection::checks);
        let status = Status::of(solved.evaluation.verdict, &solved.evaluation.limits).max(function::status(checks));
        report.mesh = Some(solved);
        self.report(&Shown { title: &title, report: &report, rows }, &read, output)?;
        Ok(status)
    }
}

/// Why measured teeth have no verdict.
fn unjudged_teeth(missing: &[&str]) -> Diagnostic {
    let missing = missing.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", ");
    Diagnostic::warning(
        Code::UnjudgedLimit,
        format!("teeth are judged by their exact mesh, for which {missing} is missing"),
    )
    .help("what the formulas say of single teeth is no range of all together")
}

/// The parts of a block, and the rows that make no part.
#[derive(Default)]
struct Listed {
    parts: Vec<batch_room::Part>,
    problems: Vec<Problem>,
}

impl Listed {
    fn is_full(&self) -> bool {
        self.parts.len() + self.problems.len() > MOST_PARTS
    }
}

impl PartSink for Listed {
    fn take(&mut self, parts: &[batch_room::Part], problems: &[Problem]) -> io::Result<()> {
        self.parts.extend_from_slice(parts);
        self.problems.extend_from_slice(problems);
        // the run ends here: nothing more of a refused block is kept
        if self.is_full() { Err(io::ErrorKind::FileTooLarge.into()) } else { Ok(()) }
    }
}

/// The rows of a text that a batch wrote, its header first.
fn rows_of(text: &[u8]) -> Result<Vec<Vec<String>>, Failure> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text);
    let row =
        |row: csv::Result<csv::StringRecord>| Ok(row.map_err(io::Error::from)?.iter().map(str::to_owned).collect());
    reader.records().map(row).collect()
}
