//! The files of a batch: rows in their format and packing, or the summary; rejected rows; a JUnit report. They are begun before
//! anything is computed, and appear under their names when the run is complete. An incomplete run leaves NAME.partial beside
//! them, and its JUnit report says so.

use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};

use super::Args;
use crate::batch::{ColumnKind, Outcome, Packing, PartSink, RowFormat, Sink, Sinks};
use crate::cli::output::{Failure, Output};
use crate::cli::rows::RowsFile;
use crate::cli::rows_format::RowsFormat;
use crate::cli::signals::Interruption;
use crate::cli::target::{self, Target, UnlessComplete, shown};
use crate::diagnostic::Diagnostic;
use crate::report::{self, Basis, Junit, Screen};
use crate::spec::Spec;

/// Files that are written.
#[derive(Default)]
pub(super) struct Targets {
    rows: Option<RowsFile>,
    rejects: Option<Target>,
    pub(super) summary: Option<Target>,
    junit: Option<Target>,
    /// The test cases of the JUnit report.
    cases: Option<Junit<File>>,
    rejects_packing: Packing,
}

impl Targets {
    /// The sink of the rows, once their columns are known.
    pub(super) fn sinks(
        &mut self,
        format: RowFormat,
        columns: impl FnOnce() -> Vec<(String, ColumnKind)>,
    ) -> Result<Sinks<'_>, Failure> {
        let packing = self.rejects_packing;
        Ok(Sinks {
            rows: self.rows.as_mut().map(|rows| rows.sink(format, columns)).transpose()?,
            rejects: self.rejects.as_mut().map(|writer| Sink { writer, packing }),
            parts: self.cases.as_mut().map(|cases| cases as &mut dyn PartSink),
        })
    }

    /// Says that so many columns behind the first one are those of the table.
    pub(super) fn with_copied(&mut self, count: usize) {
        if let Some(rows) = &mut self.rows {
            rows.with_copied(count);
        }
    }

    /// Writes the JUnit report, if there is to be one.
    pub(super) fn finish_report(
        &mut self,
        title: Option<&str>,
        basis: &Basis,
        outcome: &Outcome,
        failed: &[Diagnostic],
    ) -> Result<(), Failure> {
        let Some((mut target, cases)) = self.junit.take().zip(self.cases.take()) else { return Ok(()) };
        cases.write(&mut target, title, basis, outcome, failed)?;
        target.finish()
    }

    /// Completes the files of rows; returns whether they are complete. An incomplete run keeps the rows so far in NAME.partial and
    /// says so.
    pub(super) fn finish_rows(
        &mut self,
        is_complete: bool,
        notes: &[String],
        interruption: &Interruption,
        output: &mut Output,
    ) -> Result<bool, Failure> {
        let rows = self.rows.take();
        let is_written = rows.map_or(Ok(true), |rows| rows.finish(is_complete, notes, interruption, output))?;
        self.rejects.take().map_or(Ok(()), |rejects| rejects.end(is_complete, output))?;
        Ok(is_written)
    }
}

/// Begins a JUnit report. If the run fails, the report says so, because pipelines show what stands there.
fn begin_report(path: &Path, inputs: &[PathBuf]) -> Result<Target, Failure> {
    Target::with(path, inputs, UnlessComplete::Report(report::junit_of_failure))
}

/// Writes the JUnit report and the annotation of a run whose arguments are wrong.
pub(in crate::cli) fn report_of_usage(arguments: &[OsString], error: &clap::Error, output: &mut Output) {
    if !error.use_stderr() {
        return;
    }
    // a wrong option ends clap's reading, whatever follows
    let mut rest = arguments.iter().skip_while(|argument| *argument != "batch");
    let annotates = |argument: &OsString| argument.to_string_lossy().starts_with("--annotations");
    output.annotate(rest.clone().any(annotates));
    output.keep_usage(error);
    let path = rest.find_map(|argument| match argument.to_str()?.strip_prefix("--junit")? {
        "" => Some(None),
        value => value.strip_prefix('=').map(|path| Some(PathBuf::from(path))),
    });
    let path = path.and_then(|path| path.or_else(|| rest.next().map(PathBuf::from)));
    // problems of the file are reported once the arguments are right
    drop(path.map(|path| begin_report(&path, &[])));
}

impl Args {
    /// Begins the JUnit report, before anything can fail.
    pub(super) fn begin_report(&self) -> Result<Option<Target>, Failure> {
        let read: Vec<PathBuf> = std::iter::once(&self.spec).chain(&self.files).cloned().collect();
        self.junit.as_deref().map(|path| begin_report(path, &read)).transpose()
    }

    /// Begins the other files. Refuses files that are read, two names of one file, and names with an ending of another format.
    pub(super) fn begin(
        &self,
        junit: Option<Target>,
        inputs: &[PathBuf],
        spec: &Spec,
        (format, screen): (RowsFormat, Screen),
    ) -> Result<Targets, Failure> {
        let written: Vec<&Path> =
            [&self.rows.output, &self.rejects, &self.junit].into_iter().flatten().map(PathBuf::as_path).collect();
        target::refuse_same(&written)?;
        for path in &written {
            target::refuse_inputs(path, inputs)?;
        }
        if self.rows.output.is_none() {
            target::refuse_inputs("/dev/stdout", inputs)?;
        }
        self.rejects.as_deref().map_or(Ok(()), refuse_other_place)?;
        let packing = self.rejects.as_deref().map_or(Packing::None, |path| Packing::of_name(&shown(path)).0);
        let rejects = self.rejects.as_ref().map(|path| Target::create(path, inputs)).transpose()?;
        let path = self.rows.output.as_deref();
        let summary = path.filter(|_| self.summary).map(|path| Target::create(path, inputs)).transpose()?;
        let called = (spec.title.as_deref().unwrap_or("rackmesh"), &spec.limits());
        let shown_as = (format, screen, self.decimals.is_some());
        let rows = (!self.summary).then(|| RowsFile::begin(path, inputs, called, shown_as)).transpose()?;
        let name = self.junit.as_deref().map(shown).unwrap_or_default();
        let cases = self.junit.as_deref().filter(|_| junit.is_some()).map(target::temporary).transpose()?;
        Ok(Targets {
            rows,
            rejects_packing: packing,
            rejects,
            summary,
            junit,
            cases: cases.map(|cases| Junit::new(name, cases)),
        })
    }
}

/// Rejected rows are the bytes of the table: a name with an ending of another format is refused, and so are the process's own
/// streams, because a terminal would obey control characters in them.
fn refuse_other_place(path: &Path) -> Result<(), Failure> {
    const OTHERS: [&str; 7] = ["parquet", "xlsx", "xlsm", "dfq", "json", "jsonl", "ndjson"];
    if target::is_own_stream(path) {
        let message =
            format!("--rejects {}: rejected rows are copied byte by byte, which only a file takes safely", shown(path));
        return Err(Diagnostic::usage(message).help("give the name of a file").into());
    }
    let ending = target::ending(path);
    if !OTHERS.contains(&ending.as_str()) {
        return Ok(());
    }
    let message =
        format!("--rejects {}: rejected rows are written as lines of text, and not as .{ending}", shown(path));
    Err(Diagnostic::usage(message).help("give a name that ends in .csv or .txt").into())
}
