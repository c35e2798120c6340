//! `rackmesh batch`: tables of measured parts, through the formulas; with `--teeth` through the exact mesh.

mod bar;
mod notes;
mod targets;
mod teeth;

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(super) use bar::Bar;
use clap::builder::PossibleValue;
pub(super) use notes::{notes, unjudged, without_names};
use targets::Targets;
pub(super) use targets::report_of_usage;

use super::decision::JudgeArgs;
use super::output::{Failure, Output, Status};
use super::rows_format::{RowsArgs, RowsFormat};
use super::set::SetArgs;
use super::signals::{self, Interruption};
use super::tables::{self, Files, Opener, ReadArgs};
use super::teeth::with_known_teeth;
use super::{spec_files, stream, target};
use crate::batch::{Batch, Counts, Decimals, Layout, Outcome, Plan, Request, RowFormat, Rows, RunError};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::report::{self, Basis, BatchReport, Format, WithReading};
use crate::spec::Spec;
use crate::table::{Contradiction, Table};

pub(super) const ABOUT: &str = "Judge tables of measured parts: ΔCD and a verdict for every part";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh batch rack.toml parts.csv > results.csv
  rackmesh batch rack.toml spaces.csv --teeth --to 30
  rackmesh batch rack.toml lot*.csv --rejects bad.csv --junit parts.xml --annotations github

Exit status: 0 all parts inside the limits or none given, 1 a part outside, 2 a row rejected or
not judged, 3 indeterminate and none worse, 129, 130 or 143 interrupted.")]
// the stroke is that of the exact mesh
#[command(mut_args(with_teeth))]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: PathBuf,
    /// Tables: text, gzip, zstd, .xlsx, .dfq, Parquet; `-` or none reads standard input.
    files: Vec<PathBuf>,
    #[command(flatten)]
    rows: RowsArgs,
    /// Decimals of the lengths in the result.
    #[arg(long, value_name = "N|full")]
    decimals: Option<Decimals>,
    /// The columns to write, by name.
    ///
    /// They are results, or columns of the table.
    #[arg(long, value_delimiter = ',', value_name = "NAME,…")]
    columns: Option<Vec<String>>,
    /// Print counts, statistics, Ppk and the worst parts instead of rows.
    #[arg(long, conflicts_with = "only_failures")]
    summary: bool,
    /// Write the parts that do not pass only.
    #[arg(long)]
    only_failures: bool,
    #[command(flatten)]
    judge: JudgeArgs,
    /// Put each part's errors on the worst teeth found: columns reached_….
    #[arg(long, alias = "mesh", conflicts_with = "teeth")]
    worst_teeth: bool,
    /// Judge without errors that the spec asks for and the table lacks.
    #[arg(long)]
    partial: bool,
    #[command(flatten)]
    set: SetArgs,
    /// One row per tooth or space: each part through the exact mesh.
    #[arg(long, conflicts_with_all = ["stack", "model", "monte_carlo"])]
    teeth: bool,
    #[command(flatten)]
    range: super::mesh::Range,
    /// Write rejected rows here, unchanged and below their header.
    #[arg(long, value_name = "FILE")]
    rejects: Option<PathBuf>,
    /// End at the first rejected row.
    #[arg(long)]
    strict: bool,
    /// Write a JUnit report here.
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Annotate parts that do not pass, on standard error, for github.
    #[arg(long, value_parser = [
        PossibleValue::new("github").help("Workflow commands of GitHub Actions"),
    ], value_name = "FOR", hide_possible_values = true)]
    annotations: Option<String>,
    /// Threads; one per core unless given.
    #[arg(long, short = 'j', alias = "jobs", value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    #[command(flatten)]
    reading: ReadArgs,
}

fn with_teeth(arg: clap::Arg) -> clap::Arg {
    if matches!(arg.get_id().as_str(), "from" | "to" | "tolerance") { arg.requires("teeth") } else { arg }
}

/// Rejected rows shown on standard error; the others are counted.
const PROBLEMS_SHOWN: usize = 10;

const NO_LIMITS: &str = "there are no limits, so that no part can pass: --only-failures leaves nothing out";

fn unread(file: &Path, error: &io::Error) -> Diagnostic {
    let name = stream::name(file);
    Diagnostic::error(Code::FileAccess, format!("cannot read {name} to its end: {error}")).about(&name)
}

/// The results when the last file has been read, whether its rows were parts or teeth.
struct Ending<'a> {
    spec: &'a Spec,
    targets: Targets,
    /// Why files could not be read.
    failed: &'a [Diagnostic],
    /// How many of these were reported already.
    told: usize,
    basis: Basis,
    interruption: &'a Interruption,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        output.annotate(self.annotations.is_some());
        let junit = self.begin_report()?;
        let spec = Arc::new(self.reading.laid_out(self.set.read_spec(&self.spec, output)?)?);
        let mut files = self.files.clone();
        if files.is_empty() {
            files.push("-".into());
        }
        spec_files::refuse_shared_input(&self.spec, &files)?;
        let screen = output.screen();
        let (format, rows_format, summary_format) = self.rows.formats(self.summary, screen)?;
        let read: Vec<PathBuf> = self.reading.layout_file().into_iter().chain(&files).cloned().collect();
        let inputs = spec_files::inputs(&spec, &self.spec, &read);
        let mut begun = self.begin(junit, &inputs, &spec, (format, screen))?;
        let interruption = signals::interrupted(output);
        let opener = Opener::new(&self.reading, &spec, self.judge.model, interruption.stop());
        let opener = Opener { teeth: Some(self.teeth), ..opener };
        let nothing = || {
            let ending = Ending {
                spec: &spec,
                targets: std::mem::take(&mut begun),
                failed: &[],
                told: 0,
                basis: self.basis(&spec),
                interruption: &interruption,
            };
            let outcome = Outcome { interrupted: true, ..Outcome::default() };
            let ended = self.end(ending, (outcome, Ok(())), summary_format, output);
            output.finish(ended);
        };
        let mut found = interruption.while_waiting(|| opener.look(&files), nothing)?;
        // report what is missing before computing the others
        let told = found.failed.len();
        found.failed.iter().for_each(|diagnostic| output.diagnostic(diagnostic));
        if self.teeth {
            let formats = (format, rows_format, summary_format);
            return self.run_teeth(&spec, (&mut found, begun), formats, &interruption, output);
        }
        let Some(first) = &found.first else { return Ok(Status::Undecided) };
        let mut request = self.request((format, rows_format), &first.spec)?;
        if format == RowsFormat::Office && self.columns.is_none() && self.is_workbook() {
            request.copied = originals(&first.table);
            begun.with_copied(request.copied.len());
        }
        Plan::refuse(&first.spec, &first.table, &request)?;
        let spec = Arc::new(with_known_teeth((*first.spec).clone(), &self.spec, output)?);
        let plan = Plan::new(&spec, &first.table, request)?;
        self.remarks(&plan, output);
        let mut notes = [first.notes.clone(), notes(&spec, &plan)].concat();
        notes.extend(without_names(&plan));
        let sinks = begun.sinks(rows_format, || plan.columns_written())?;
        let mut batch = Batch::new(&plan, sinks, self.threads.map(usize::from));
        let mut bar = Bar::new(&files, "rows", output);
        let failed = Self::run_each(&mut found, &mut bar, |table, bar| {
            let layout = Layout::new(&plan, &table)?;
            let run = batch.run(table, &layout, interruption.stop(), &mut |progress| bar.show(progress));
            Ok((run, batch.is_over()))
        })?;
        bar.finish();
        let (mut outcome, written) = batch.finish();
        outcome.notes.extend(notes);
        let ending = Ending {
            spec: &spec,
            targets: begun,
            failed: &failed,
            told,
            basis: Basis::of(&plan),
            interruption: &interruption,
        };
        self.end(ending, (outcome, written), summary_format, output)
    }

    /// Runs table after table until the run is over; returns what is wrong with tables that are not read to their end.
    fn run_each(
        found: &mut Files<'_>,
        bar: &mut Bar,
        mut run: impl FnMut(Table, &mut Bar) -> Result<(Result<(), RunError>, bool), Diagnostics>,
    ) -> Result<Vec<Diagnostic>, Failure> {
        let mut failed = std::mem::take(&mut found.failed);
        for path in found.paths.clone() {
            let ran = found.next(&path).and_then(|opened| Ok(run(opened.table, bar)?));
            bar.next();
            match ran {
                Ok((ran, is_over)) => {
                    failed.extend(unfinished(&path, ran)?);
                    if is_over {
                        break;
                    }
                }
                Err(failure) => failed.extend(tables::diagnostics_of(&path, failure)),
            }
        }
        Ok(failed)
    }

    /// Completes the files, and prints the outcome.
    fn end(
        &self,
        ending: Ending<'_>,
        (mut outcome, written): (Outcome, io::Result<()>),
        format: Format,
        output: &mut Output,
    ) -> Result<Status, Failure> {
        let Ending { spec, mut targets, failed, told, basis, interruption } = ending;
        written?;
        outcome.notes.extend(spec.suspicions_in_words());
        outcome.tell_duplicates();
        outcome.is_cut |= !failed.is_empty();
        let is_complete = !outcome.interrupted && !outcome.is_cut;
        let counted = in_words(&outcome.counts, if self.teeth { "part" } else { "row" });
        let plug = basis.yoke.as_ref().and_then(|judge| report::plug_in_words(&judge.yoke, &outcome.settings));
        let counted = plug.into_iter().fold(counted, |counted, plug| format!("{counted}; {plug}"));
        let notes =
            [vec![counted.clone(), basis.judged_by()], report::said(&outcome.readings, &outcome.notes)].concat();
        outcome.interrupted |= !targets.finish_rows(is_complete, &notes, interruption, output)?;
        for diagnostic in failed.iter().skip(told) {
            output.diagnostic(diagnostic);
        }
        let shows_notes = match format {
            Format::Json => true,
            Format::Csv => false,
            Format::Table | Format::Markdown => !output.is_quiet(),
        };
        let holds_notes = self.summary && self.rows.output.is_none() && shows_notes;
        if holds_notes {
            let _ = tables::say_readings(&outcome.readings, output);
        } else {
            tables::say(&outcome.readings, &outcome.notes, output);
        }
        self.problems(&basis, &outcome, output);
        targets.finish_report(spec.title.as_deref(), &basis, &outcome, failed)?;
        if self.summary {
            let report = BatchReport::new(spec.title.as_deref(), &basis, &outcome);
            let report = WithReading { report: &report, readings: &outcome.readings, notes: &outcome.notes };
            match targets.summary.take() {
                Some(mut summary) => {
                    summary.write_all(report::write(&report, format, output.screen().of_file())?.as_bytes())?;
                    summary.end(is_complete, output)?;
                }
                None => output.report(&report, format)?,
            }
        } else {
            let not_accepted = outcome.contradiction.iter().map(|why| format!("{counted}, but {why}"));
            output.remark(&not_accepted.fold(counted.clone(), |_, line| line));
        }
        if let Some(status) = interruption.status().filter(|_| outcome.interrupted) {
            return Ok(status);
        }
        if outcome.counts.rows == 0 {
            let message = "there is no part in the tables, so none was checked";
            output.diagnostic(&Diagnostic::warning(Code::BadTable, message));
        }
        Ok(status(&outcome, &basis, !failed.is_empty()))
    }

    /// Refuses columns that are asked for twice: rows have one of each name.
    fn refuse_repeated_columns(&self) -> Result<(), Diagnostic> {
        let columns = self.columns.as_deref().unwrap_or_default();
        let repeated = columns.iter().enumerate().find(|(place, name)| columns[..*place].contains(name));
        repeated.map_or(Ok(()), |(_, name)| {
            let message = format!("--columns names `{name}` twice");
            Err(Diagnostic::usage(message).help("name each column once"))
        })
    }

    /// How parts are judged, as far as the spec says it, before there is a table.
    fn basis(&self, spec: &Spec) -> Basis {
        let rule = self.judge.rule(spec);
        if self.teeth {
            return Basis::of_teeth(spec, &rule);
        }
        Basis {
            model: self.judge.model.name(),
            stack: Some(self.judge.stack),
            rule,
            limits: spec.limits(),
            ..Basis::default()
        }
    }

    /// The columns to write: those asked for, those of a table for people, or all (`None`).
    fn columns(&self, format: RowsFormat, spec: &Spec) -> Option<Vec<String>> {
        let of_table = ["part_id", "lower_mm", "upper_mm", "margin_mm", "nearest_limit", "verdict", "reason"];
        let count = if spec.limits.is_empty() && spec.function_limits.is_empty() { 3 } else { of_table.len() };
        let is_table = format.is_for_people() && !self.summary;
        self.columns
            .clone()
            .or_else(|| is_table.then(|| of_table[..count].iter().copied().map(str::to_owned).collect()))
    }

    fn request(&self, (written, format): (RowsFormat, RowFormat), spec: &Spec) -> Result<Request, Failure> {
        self.refuse_repeated_columns()?;
        Ok(Request {
            model: self.judge.model,
            stack: self.judge.stack,
            rule: self.judge.rule(spec),
            monte_carlo: self.judge.settings()?,
            decimals: self.decimals.unwrap_or_default(),
            format,
            columns: self.columns(written, spec),
            copied: Vec::new(),
            mesh: self.worst_teeth,
            partial: self.partial,
            rows: match (self.summary, self.only_failures) {
                (true, _) => Rows::None,
                (_, true) => Rows::NotPassed,
                _ => Rows::All,
            },
            statistics: self.summary,
            strict: self.strict,
            failures_kept: if self.annotations.is_some() { report::ANNOTATIONS_SHOWN } else { 0 },
            lists_parts: self.junit.is_some(),
            problems_kept: PROBLEMS_SHOWN,
        })
    }

    /// Whether rows go to a workbook, which has the columns of the first table, too.
    fn is_workbook(&self) -> bool {
        self.rows.output.as_deref().is_some_and(|path| target::ending(path) == "xlsx")
    }

    /// Remarks before the first row.
    fn remarks(&self, plan: &Plan, output: &mut Output) {
        unjudged(plan, output);
        let has_limits = !plan.limits.is_empty() || plan.is_yoke_limited();
        if self.only_failures && !has_limits && plan.unjudged.is_empty() {
            output.diagnostic(&Diagnostic::warning(Code::UnjudgedLimit, NO_LIMITS));
        }
    }

    /// The rejected rows with their faults, and annotations.
    fn problems(&self, basis: &Basis, outcome: &Outcome, output: &mut Output) {
        for problem in outcome.problems.iter().take(PROBLEMS_SHOWN) {
            output.message(&problem.to_string());
        }
        let more = outcome.counts.rejected.saturating_sub(PROBLEMS_SHOWN as u64);
        if more > 0 {
            output.message(&format!("… and {} more rejected", report::grouped(more)));
        }
        if self.annotations.is_some() {
            report::github_annotations(basis, outcome).lines().for_each(|line| output.message(line));
        }
        if outcome.interrupted {
            output.message(match outcome.counts.rows {
                0 => signals::NOTHING_YET,
                _ => "interrupted: this is of the rows up to here, and not of all parts",
            });
        }
    }
}

/// The headings of a table's columns, once each, without that of the parts' names.
fn originals(table: &Table) -> Vec<String> {
    let is_name = |title: &String| table.reading.columns.iter().any(|of| of.role == "part_id" && of.title == *title);
    let mut titles: Vec<String> = Vec::new();
    for title in table.titles.iter().filter(|title| !title.is_empty() && !is_name(title)) {
        if !titles.contains(title) {
            titles.push(title.clone());
        }
    }
    titles
}

/// The counts in one line.
fn in_words(counts: &Counts, row: &str) -> String {
    let all = [
        (counts.pass, "pass"),
        (counts.fail, "fail"),
        (counts.indeterminate, "indeterminate"),
        (counts.unjudged, "without a verdict"),
        (counts.rejected, "rejected"),
    ];
    let shown = all.into_iter().filter(|(count, what)| *count > 0 || (*what == "fail" && counts.pass > 0));
    let parts: Vec<_> = shown.map(|(count, what)| format!("{} {what}", report::grouped(count))).collect();
    let plural = if counts.rows == 1 { "" } else { "s" };
    let mut line = format!("{} {row}{plural}", report::grouped(counts.rows));
    if !parts.is_empty() {
        line.push_str(&format!(": {}", parts.join(", ")));
    }
    if counts.blank_lines > 0 {
        let lines = if counts.blank_lines == 1 { "line" } else { "lines" };
        line.push_str(&format!("; {} blank {lines}", report::grouped(counts.blank_lines)));
    }
    line
}

/// The fault where a table was not read to its end.
pub(super) fn unfinished(path: &Path, run: Result<(), RunError>) -> Result<Option<Diagnostic>, Failure> {
    match run {
        Ok(()) => Ok(None),
        Err(RunError::Read(error)) => Ok(Some(unread(path, &error))),
        Err(RunError::Write(error)) => Err(Failure::Write(error)),
        Err(RunError::Contradiction(contradiction)) => {
            let Contradiction { line, column, message, help } = contradiction;
            let column = if column.is_empty() { column } else { format!(", column `{column}`") };
            // what the whole table says has no line, and the table was read to its end
            let (line, end) =
                if line == 0 { (String::new(), "") } else { (format!(", line {line}"), "; the run ends here") };
            let message = format!("{}{line}{column}: {message}{end}", stream::name(path));
            Ok(Some(Diagnostic::error(Code::BadTable, message).help(help).about(&stream::name(path))))
        }
    }
}

/// The exit status: a rejected row counts more than a failed part, and a failed part more than an open verdict.
pub(super) fn status(outcome: &Outcome, basis: &Basis, unread: bool) -> Status {
    let counts = &outcome.counts;
    if counts.rejected > 0 || unread || outcome.is_cut || counts.rows == 0 {
        Status::Undecided
    } else if counts.fail > 0 {
        Status::Fail
    } else if basis.unjudged_sentence(outcome).is_some() {
        Status::Undecided
    } else if counts.indeterminate > 0 {
        Status::Indeterminate
    } else {
        Status::Pass
    }
}
