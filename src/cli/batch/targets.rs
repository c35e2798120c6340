//! The files that a batch writes: rows in their format and packing, or the summary; rejected rows; a JUnit report. They are
//! begun before anything is computed, and appear under their names when the run is complete; of one that is not, what there
//! is stands beside as NAME.partial, and the JUnit report says so.

use std::ffi::OsString;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::Args;
use super::format::BatchFormat;
use crate::batch::{ColumnKind, Outcome, Packing, ParquetRows, PartSink, RowFormat, RowSink, Sink, Sinks};
use crate::cli::office::{FormedRows, is_office};
use crate::cli::output::{Failure, Output};
use crate::cli::signals::Interruption;
use crate::cli::target::{self, Target, UnlessComplete, named, shown};
use crate::diagnostic::Diagnostic;
use crate::report::{self, Basis, Junit, Screen};
use crate::spec::Spec;

/// Rows that are not written to their file as they come.
enum Kept {
    /// Of a Parquet file, which has an end of its own.
    Parquet(Box<ParquetRows>),
    /// Of a workbook, a Q-DAS file, a table for people or an array of JSON.
    Formed(Box<FormedRows<Box<dyn Write + Send>>>),
}

/// Files that are written.
#[derive(Default)]
pub(super) struct Targets {
    file: Option<Target>,
    kept: Option<Kept>,
    rejects: Option<Target>,
    pub(super) summary: Option<Target>,
    junit: Option<Target>,
    /// The test cases of the JUnit report.
    cases: Option<Junit<File>>,
    packing: Packing,
    rejects_packing: Packing,
}

impl Targets {
    /// What the rows are written to, now that it is known which columns they have.
    pub(super) fn sinks(
        &mut self,
        format: RowFormat,
        columns: impl FnOnce() -> Vec<(String, ColumnKind)>,
    ) -> Result<Sinks<'_>, Failure> {
        if let (Some(file), RowFormat::Columns) = (&mut self.file, format) {
            self.kept = Some(Kept::Parquet(Box::new(ParquetRows::new(file.take_writer(), &columns())?)));
        }
        let (packing, rejects_packing) = (self.packing, self.rejects_packing);
        let file = self.file.as_mut().map(|writer| RowSink::Text(Sink { writer, packing }));
        Ok(Sinks {
            rows: match &mut self.kept {
                Some(Kept::Parquet(rows)) => Some(RowSink::Columns(rows.as_mut())),
                Some(Kept::Formed(writer)) => Some(RowSink::Text(Sink { writer, packing })),
                None => file,
            },
            rejects: self.rejects.as_mut().map(|writer| Sink { writer, packing: rejects_packing }),
            parts: self.cases.as_mut().map(|cases| cases as &mut dyn PartSink),
        })
    }

    /// Says that so many columns behind the first one are those of the table.
    pub(super) fn with_copied(&mut self, count: usize) {
        if let Some(Kept::Formed(rows)) = &mut self.kept {
            rows.with_copied(count);
        }
    }

    /// Writes the JUnit report, if there is to be one.
    pub(super) fn finish_report(
        &mut self,
        title: Option<&str>,
        basis: &Basis,
        outcome: &Outcome,
    ) -> Result<(), Failure> {
        let Some((mut target, cases)) = self.junit.take().zip(self.cases.take()) else { return Ok(()) };
        cases.write(&mut target, title, basis, outcome)?;
        target.finish()
    }

    /// Ends the files of rows; whether that was not interrupted. Of a run that is not complete, what there is is kept beside,
    /// and that is said.
    pub(super) fn finish_rows(
        &mut self,
        is_complete: bool,
        notes: &[String],
        interruption: &Interruption,
        output: &mut Output,
    ) -> Result<bool, Failure> {
        let mut is_written = true;
        match self.kept.take() {
            Some(Kept::Parquet(rows)) => rows.finish()?,
            Some(Kept::Formed(rows)) => is_written = rows.finish(notes, interruption.stop())?,
            None => {}
        }
        if let Some(file) = self.file.take_if(|_| !is_written) {
            file.discard(output);
        }
        for target in [self.file.take(), self.rejects.take()].into_iter().flatten() {
            target.end(is_complete, output)?;
        }
        Ok(is_written)
    }
}

/// Begins a JUnit report. Of a run that fails it says so, for pipelines show what stands there.
fn begin_report(path: &Path, inputs: &[PathBuf]) -> Result<Target, Failure> {
    Target::with(path, inputs, UnlessComplete::Report(report::junit_of_failure))
}

/// Writes the JUnit report of a run whose arguments are wrong.
pub(in crate::cli) fn report_of_usage(arguments: &[OsString], error: &clap::Error) {
    if !error.use_stderr() {
        return;
    }
    // an option that is wrong ends clap's reading, whatever follows
    let mut rest = arguments.iter().skip_while(|argument| *argument != "batch");
    let path = rest.find_map(|argument| match argument.to_str()?.strip_prefix("--junit")? {
        "" => Some(None),
        value => value.strip_prefix('=').map(|path| Some(PathBuf::from(path))),
    });
    let path = path.and_then(|path| path.or_else(|| rest.next().map(PathBuf::from)));
    // what is wrong with the file is told when the arguments are right
    drop(path.map(|path| begin_report(&path, &[])));
}

impl Args {
    /// Begins the JUnit report, before anything can fail.
    pub(super) fn begin_report(&self) -> Result<Option<Target>, Failure> {
        let read: Vec<PathBuf> = std::iter::once(&self.spec).chain(&self.files).cloned().collect();
        self.junit.as_deref().map(|path| begin_report(path, &read)).transpose()
    }

    /// Begins the other files. Refuses those that are read, that are one, or whose name says what they are not.
    pub(super) fn begin(
        &self,
        junit: Option<Target>,
        inputs: &[PathBuf],
        spec: &Spec,
        (format, screen): (BatchFormat, Screen),
    ) -> Result<Targets, Failure> {
        let written: Vec<&Path> =
            [&self.output, &self.rejects, &self.junit].into_iter().flatten().map(PathBuf::as_path).collect();
        target::refuse_same(&written)?;
        for path in &written {
            target::refuse_inputs(path, inputs)?;
        }
        self.rejects.as_deref().map_or(Ok(()), refuse_other_place)?;
        let packing =
            |path: &Option<PathBuf>| path.as_deref().map_or(Packing::None, |path| Packing::of_name(&shown(path)).0);
        let path = self.output.as_deref().unwrap_or(Path::new("-"));
        let rejects = self.rejects.as_ref().map(|path| Target::create(path, inputs)).transpose()?;
        let is_written = !self.summary || self.output.is_some();
        let file = is_written.then(|| Target::create(path, inputs)).transpose()?;
        let (mut file, summary) = if self.summary { (None, file) } else { (file, None) };
        let kept = match &mut file {
            Some(file) => {
                let title = spec.title.as_deref().unwrap_or("rackmesh");
                let formed = match format {
                    _ if is_office(&shown(path)) => {
                        Some(FormedRows::new(&shown(path), file.take_writer(), (title, &spec.limits()))?)
                    }
                    BatchFormat::Table => {
                        let screen = if self.output.is_some() { screen.of_file() } else { screen };
                        Some(FormedRows::table(file.take_writer(), screen, self.decimals.is_some()))
                    }
                    BatchFormat::Json => Some(FormedRows::array(file.take_writer())),
                    _ => None,
                };
                formed.map(|rows| Kept::Formed(Box::new(rows)))
            }
            None => None,
        };
        let name = self.junit.as_deref().map(shown).unwrap_or_default();
        let cases = junit.as_ref().map(|_| tempfile::tempfile()).transpose();
        Ok(Targets {
            kept,
            packing: packing(&self.output),
            rejects_packing: packing(&self.rejects),
            file,
            rejects,
            summary,
            junit,
            cases: cases.map_err(|error| named(&name, &error))?.map(|cases| Junit::new(name, cases)),
        })
    }
}

/// Rejected rows are the bytes of the table: a name that says otherwise is refused, and so are the process's own streams, for
/// what shows them would obey what stands in them.
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
