//! `rackmesh batch`: tables with a row per part, through the formulas; with `--teeth` through the exact mesh.

mod bar;
mod targets;
mod teeth;

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::ValueEnum;

use super::decision::DecisionArgs;
use super::eval::{ModelArg, StackArg};
use super::output::{Failure, Output, Status};
use super::{long, office, stream};
use crate::batch::{
    Batch, Counts, Decimals, Dialect, Input, Layout, Outcome, Packing, Plan, Request, RowFormat, Rows, RunError,
};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::report::{self, Basis, BatchReport, Format};
use crate::spec::{Spec, WrittenError};
use bar::Bar;

pub(super) const ABOUT: &str = "Check tables with a row per part: ΔCD, combinations and a verdict for every part";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh batch rack.toml parts.csv > results.csv
  rackmesh batch rack.toml parts.csv.gz --summary
  rackmesh batch rack.toml parts.csv --only-failures --columns part_id,verdict
  rackmesh batch rack.toml spaces.csv --teeth --to 30
  rackmesh batch rack.toml parts.csv --rule iso14253
  rackmesh batch rack.toml lot*.csv --rejects bad.csv --junit parts.xml --annotations github

Exit status: 0 all parts inside the limits or none given, 1 a part outside,
2 a row was rejected or something could not be judged, 3 a verdict is
indeterminate and none worse.")]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub(super) struct Args {
    /// The gear spec (TOML).
    spec: String,
    /// Tables with a header and a row per part, gzip and zstd included; Excel workbooks (.xlsx) and Q-DAS files (.dfq,
    /// .dfd with .dfx); `-` or none reads standard input.
    files: Vec<String>,
    #[command(flatten)]
    place: office::Place,
    /// Write the rows (or the summary) here; `.tsv`, `.jsonl`, `.parquet`, `.xlsx` and `.dfq` name a format, `.gz` and
    /// `.zst` pack.
    #[arg(long, short)]
    output: Option<String>,
    /// The format of rows (csv, tsv, jsonl, parquet) or of a summary (table, markdown, json, csv).
    #[arg(long, value_enum)]
    format: Option<BatchFormat>,
    /// Decimals of the lengths, mm; `full` writes what `eval` writes.
    #[arg(long, default_value = "6", value_name = "N|full")]
    decimals: Decimals,
    /// The columns to write: results, or columns of the table as they are.
    #[arg(long, value_delimiter = ',', value_name = "NAME,…")]
    columns: Option<Vec<String>>,
    /// The column that names the part.
    #[arg(long, value_name = "NAME")]
    id: Option<String>,
    /// Print counts, statistics, quantiles, Pp, Ppk and the ten worst parts instead of rows.
    #[arg(long, conflicts_with = "only_failures")]
    summary: bool,
    /// Write the parts that do not pass only.
    #[arg(long)]
    only_failures: bool,
    /// The combination that the verdict judges.
    #[arg(long, value_enum, default_value_t)]
    stack: StackArg,
    /// Formulas exact for rigid teeth, or as the paper prints them.
    #[arg(long, value_enum, default_value_t)]
    model: ModelArg,
    #[command(flatten)]
    decision: DecisionArgs,
    /// Many rows per part, one per tooth or space: each part through the exact mesh.
    #[arg(long, conflicts_with_all = ["stack", "model", "monte_carlo"])]
    teeth: bool,
    #[command(flatten)]
    range: super::mesh::Range,
    /// Write rejected rows here, unchanged and below their header.
    #[arg(long, value_name = "FILE")]
    rejects: Option<String>,
    /// End at the first rejected row.
    #[arg(long)]
    strict: bool,
    /// Write a JUnit report here.
    #[arg(long, value_name = "FILE")]
    junit: Option<String>,
    /// Annotate parts that do not pass and rejected rows, on standard error.
    #[arg(long, value_enum, value_name = "FOR")]
    annotations: Option<Annotations>,
    /// The separator, a character or `tab`; found from the header unless given.
    #[arg(long, value_parser = separator, value_name = "CHAR")]
    separator: Option<u8>,
    /// Numbers have a decimal comma.
    #[arg(long)]
    decimal_comma: bool,
    /// Threads; as many as there are cores unless given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BatchFormat {
    /// Comma-separated values with a header.
    Csv,
    /// Tab-separated values with a header.
    Tsv,
    /// One JSON object per line.
    Jsonl,
    /// Parquet (rows).
    Parquet,
    /// Aligned tables for people (summary).
    Table,
    /// Markdown tables (summary).
    Markdown,
    /// One JSON object (summary).
    Json,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Annotations {
    /// Workflow commands of GitHub Actions.
    Github,
}

/// Rejected rows shown on standard error; the others are counted.
const PROBLEMS_SHOWN: usize = 10;

/// Parts listed in a JUnit report; the others are counted in it.
const PARTS_LISTED: usize = 1000;

fn separator(text: &str) -> Result<u8, String> {
    match text.as_bytes() {
        _ if text == "tab" || text == "\\t" => Ok(b'\t'),
        [byte]
            if byte.is_ascii()
                && !byte.is_ascii_alphanumeric()
                && !matches!(byte, b'"' | b'\n' | b'\r' | b'.' | b'-') =>
        {
            Ok(*byte)
        }
        _ => Err("write one character such as ; or the word tab".to_owned()),
    }
}

const NO_LIMITS: &str = "there are no limits, so that no part can pass: --only-failures leaves nothing out";

fn unread(file: &str, error: &io::Error) -> Diagnostic {
    Diagnostic::error(Code::FileAccess, format!("cannot read {} to its end: {error}", stream::name(file)))
}

fn unwritable(name: &str, error: &io::Error) -> Failure {
    Diagnostic::error(Code::FileAccess, format!("cannot write {name}: {error}")).into()
}

/// What there is when the last file has been read, whether its rows were parts or teeth.
struct Ending<'a> {
    spec: &'a Spec,
    targets: targets::Targets,
    collected: &'a office::Collected,
    /// Why files could not be read.
    failed: &'a [Diagnostic],
    basis: Basis,
    /// Whether a limit was held against nothing.
    unjudged: bool,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = Arc::new(super::read_spec(&self.spec)?);
        let stop = long::interrupted();
        let mut files = self.files.iter().map(String::as_str).collect::<Vec<_>>();
        if files.is_empty() {
            files.push("-");
        }
        if files.contains(&"-") && self.spec == "-" {
            return Err(
                Diagnostic::error(Code::Usage, "the spec and the table cannot both come from standard input").into()
            );
        }
        let (rows_format, summary_format) = self.formats()?;
        if self.teeth {
            return self.run_teeth(&spec, &files, (rows_format, summary_format), &stop, output);
        }
        let dialect = Dialect { separator: self.separator, decimal_comma: self.decimal_comma };
        let (first, spec) = self.table(files[0], &spec, &stop, dialect, Some(output))?;
        let plan = Plan::new(&spec, &first.header, self.request(rows_format, &spec)?)?;
        self.remarks(&spec, &plan, &first, output);

        let collected = office::Collected::default();
        let mut targets = self.targets(&collected, &|| plan.column_kinds())?;
        let sinks = targets.sinks();
        let mut batch = Batch::new(&plan, sinks, self.threads.map(usize::from));
        let mut failed = Vec::new();
        let mut said: Option<Vec<String>> = None;
        let mut first = Some(first);
        let mut bar = Bar::new(&files, "rows");
        for file in &files {
            let input = match first.take() {
                Some(input) => Ok(input),
                None => self.table(file, &spec, &stop, dialect, None).map_err(failures).map(|(input, _)| input),
            };
            let layout = input.and_then(|input| {
                let layout = Layout::new(&plan, &input.header).map_err(|diagnostics| diagnostics.0)?;
                Ok((input, layout))
            });
            match layout {
                Ok((input, layout)) => {
                    if !layout.understood().is_empty() && said.as_deref() != Some(layout.understood()) {
                        output.remark(&format!("{}: {}", input.header.name, layout.understood().join(", ")));
                        said = Some(layout.understood().to_vec());
                    }
                    match batch.run(input, &layout, &stop, &mut |progress| bar.show(progress)) {
                        Ok(()) => {}
                        Err(RunError::Read(error)) => failed.push(unread(file, &error)),
                        Err(RunError::Write(error)) => return Err(Failure::Write(error)),
                    }
                }
                Err(diagnostics) => failed.extend(diagnostics),
            }
            bar.next();
            if batch.is_over() {
                break;
            }
        }
        bar.finish();
        let finished = batch.finish();
        let ending = Ending {
            spec: &spec,
            targets,
            collected: &collected,
            failed: &failed,
            basis: Basis::of(&plan),
            unjudged: !plan.unjudged().is_empty(),
        };
        self.end(ending, finished, summary_format, output)
    }

    /// Ends the files that are written, and says what came of it all.
    fn end(
        &self,
        ending: Ending<'_>,
        (outcome, written): (Outcome, io::Result<()>),
        format: Format,
        output: &mut Output,
    ) -> Result<Status, Failure> {
        let Ending { spec, targets, collected, failed, basis, unjudged } = ending;
        written?;
        targets.finish()?;
        self.write_office(collected, spec)?;
        for diagnostic in failed {
            output.diagnostic(diagnostic);
        }
        self.report(spec, &basis, &outcome, format, output)?;
        Ok(status(&outcome, !failed.is_empty(), unjudged))
    }

    /// Writes the rows that were collected for a workbook or a Q-DAS file.
    fn write_office(&self, collected: &office::Collected, spec: &Spec) -> Result<(), Failure> {
        match self.output.as_deref().filter(|path| !self.summary && office::is_office(path)) {
            Some(path) => office::write_rows(path, &collected.rows()?, spec),
            None => Ok(()),
        }
    }

    /// A table, whatever file it is in, and the spec with what the file says where it is silent; that is said where
    /// there is an `output`.
    fn table(
        &self,
        file: &str,
        spec: &Arc<Spec>,
        stop: &Arc<AtomicBool>,
        dialect: Dialect,
        output: Option<&mut Output>,
    ) -> Result<(Input, Arc<Spec>), Failure> {
        let Some(found) = office::open(file, spec, &self.place)? else {
            return Ok((Input::open(stream::name(file), stream::open(file, stop)?, dialect)?, Arc::clone(spec)));
        };
        let (completed, notes) = found.completed(spec, self.model.into());
        if let Some(output) = output {
            for note in notes {
                output.remark(&note);
            }
        }
        Ok((found.input(file), Arc::new(completed)))
    }

    /// The format of the rows, and of a summary.
    fn formats(&self) -> Result<(RowFormat, Format), Failure> {
        let named = self.output.as_deref().map(|path| Packing::of_name(path).1.to_ascii_lowercase());
        let ends = |suffix: &str| named.as_ref().is_some_and(|name| name.ends_with(suffix));
        let rows = match self.format {
            Some(BatchFormat::Csv) => RowFormat::Csv,
            Some(BatchFormat::Tsv) => RowFormat::Tsv,
            Some(BatchFormat::Jsonl) => RowFormat::JsonLines,
            Some(BatchFormat::Parquet) if !self.summary => RowFormat::Csv,
            Some(format) if !self.summary => {
                let name = format.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default();
                return Err(Diagnostic::error(Code::Usage, format!("rows cannot be written as {name}"))
                    .help("write csv, tsv, jsonl or parquet; or ask for the --summary")
                    .into());
            }
            None if ends(".tsv") => RowFormat::Tsv,
            None if ends(".jsonl") || ends(".ndjson") => RowFormat::JsonLines,
            _ => RowFormat::Csv,
        };
        let summary = match self.format {
            Some(BatchFormat::Csv) => Format::Csv,
            Some(BatchFormat::Json) => Format::Json,
            Some(BatchFormat::Markdown) => Format::Markdown,
            Some(BatchFormat::Tsv | BatchFormat::Jsonl | BatchFormat::Parquet) if self.summary => {
                return Err(Diagnostic::error(Code::Usage, "a summary has no such format")
                    .help("write table, markdown, json or csv")
                    .into());
            }
            None if ends(".json") => Format::Json,
            None if ends(".csv") => Format::Csv,
            None if ends(".md") => Format::Markdown,
            _ => Format::Table,
        };
        Ok((rows, summary))
    }

    fn request(&self, format: RowFormat, spec: &Spec) -> Result<Request, Failure> {
        Ok(Request {
            model: self.model.into(),
            stack: self.stack.into(),
            rule: self.decision.rule(spec),
            monte_carlo: self.decision.settings()?,
            decimals: self.decimals,
            format,
            columns: self.columns.clone(),
            id: self.id.clone(),
            rows: match (self.summary, self.only_failures) {
                (true, _) => Rows::None,
                (_, true) => Rows::NotPassed,
                _ => Rows::All,
            },
            statistics: self.summary,
            strict: self.strict,
            failures_kept: if self.junit.is_some() {
                PARTS_LISTED
            } else if self.annotations.is_some() {
                report::ANNOTATIONS_SHOWN
            } else {
                0
            },
            problems_kept: if self.junit.is_some() { PARTS_LISTED } else { PROBLEMS_SHOWN },
        })
    }

    /// What the user should know before the first row.
    fn remarks(&self, spec: &Spec, plan: &Plan, first: &Input, output: &mut Output) {
        let class = |kind| {
            spec.errors.iter().find_map(|(error, written)| match written.value {
                WrittenError::Class(grade) if *error == kind => Some(grade),
                _ => None,
            })
        };
        for kind in plan.left_out(&first.header) {
            let why = match class(kind) {
                Some(grade) => format!("class {grade} in [errors] is what is permitted, not what a part has"),
                None => "the value in [errors] is one part's".to_owned(),
            };
            let message =
                format!("{} has no column `{}`: that error is left out, because {why}", first.header.name, kind.key());
            output.diagnostic(&Diagnostic::warning(Code::BadTable, message));
        }
        for (kind, grade) in plan.errors().filter_map(|kind| Some((kind, class(kind)?))) {
            output.remark(&format!(
                "{}: the table's values count; class {grade} in [errors] is not held against them, because limits stand in [limits]",
                kind.key()
            ));
        }
        let exact = plan.taken_as_exact();
        if !exact.is_empty() {
            let names: Vec<_> = exact.iter().map(|kind| kind.key()).collect();
            output.remark(&format!("taken as exact, because no uncertainty is given: {}", names.join(", ")));
        }
        for target in plan.unjudged() {
            let message = format!("there is a limit on ΔCD of the {target}, but the table has no such column");
            output.diagnostic(&Diagnostic::warning(Code::UnjudgedLimit, message));
        }
        if !plan.has_id(&first.header) {
            let message =
                format!("{} has no column `part_id`: parts are called by the number of their row", first.header.name);
            let help = "name the column that has the part's name with --id";
            output.diagnostic(&Diagnostic::warning(Code::BadTable, message).help(help));
        }
        if self.only_failures && plan.limits().is_empty() {
            output.diagnostic(&Diagnostic::warning(Code::UnjudgedLimit, NO_LIMITS));
        }
    }

    /// What is said after the last row.
    fn report(
        &self,
        spec: &Spec,
        basis: &Basis,
        outcome: &Outcome,
        format: Format,
        output: &mut Output,
    ) -> Result<(), Failure> {
        self.problems(outcome, output);
        if let Some(path) = &self.junit {
            let report = report::junit(spec.title.as_deref(), &basis.judged_by(), &basis.limits, outcome);
            std::fs::write(path, report).map_err(|error| unwritable(path, &error))?;
        }
        if self.summary {
            let report = BatchReport::new(spec.title.as_deref(), basis, outcome);
            match &self.output {
                Some(path) => {
                    let text = report::write(&report, format, crate::report::Screen::default())?;
                    std::fs::write(path, text).map_err(|error| unwritable(path, &error))?;
                }
                None => output.report(&report, format)?,
            }
        } else {
            output.remark(&in_words(&outcome.counts, if self.teeth { "part" } else { "row" }));
        }
        Ok(())
    }

    /// What is wrong with which row, and annotations.
    fn problems(&self, outcome: &Outcome, output: &mut Output) {
        for problem in outcome.problems.iter().take(PROBLEMS_SHOWN) {
            output.remark(&problem.to_string());
        }
        let more = outcome.counts.rejected.saturating_sub(PROBLEMS_SHOWN as u64);
        if more > 0 {
            output.remark(&format!("… and {} more rejected", long::counted(more)));
        }
        if self.annotations == Some(Annotations::Github) {
            output.remark(report::github_annotations(outcome).trim_end());
        }
        if outcome.interrupted {
            output.remark("interrupted: what follows is of the rows up to here");
        }
    }
}

/// The counts in one line.
fn in_words(counts: &Counts, row: &str) -> String {
    let mut parts = Vec::new();
    for (count, what) in [
        (counts.pass, "pass"),
        (counts.fail, "fail"),
        (counts.indeterminate, "indeterminate"),
        (counts.unjudged, "without a verdict"),
        (counts.rejected, "rejected"),
    ] {
        if count > 0 || (what == "fail" && counts.pass > 0) {
            parts.push(format!("{} {what}", long::counted(count)));
        }
    }
    let plural = if counts.rows == 1 { "" } else { "s" };
    let mut line = format!("{} {row}{plural}", long::counted(counts.rows));
    if !parts.is_empty() {
        line.push_str(": ");
        line.push_str(&parts.join(", "));
    }
    if counts.blank_lines > 0 {
        let lines = if counts.blank_lines == 1 { "line" } else { "lines" };
        line.push_str(&format!("; {} blank {lines}", long::counted(counts.blank_lines)));
    }
    line
}

/// The exit status: a rejected row weighs more than a failed part, and that more than an open verdict.
pub(super) fn status(outcome: &Outcome, unread: bool, unjudged: bool) -> Status {
    let counts = &outcome.counts;
    if counts.rejected > 0 || unread {
        Status::Undecided
    } else if counts.fail > 0 {
        Status::Fail
    } else if unjudged {
        Status::Undecided
    } else if counts.indeterminate > 0 {
        Status::Indeterminate
    } else {
        Status::Pass
    }
}

fn failures(failure: Failure) -> Vec<Diagnostic> {
    match failure {
        Failure::Diagnostics(diagnostics) => diagnostics,
        Failure::Usage(error) => Diagnostics::from(Diagnostic::error(Code::Usage, error.to_string())).0,
        Failure::Write(error) => Diagnostics::from(Diagnostic::error(Code::FileAccess, error.to_string())).0,
    }
}
