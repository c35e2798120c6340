//! The files that a batch writes: rows in their format and packing, and rejected rows. They appear under their names when
//! the run is complete; of one that is not, what there is stands beside as NAME.partial.

use std::io::Write;

use super::Args;
use crate::batch::{ColumnKind, Packing, ParquetRows, RowFormat, RowSink, Sink, Sinks};
use crate::cli::long::Interruption;
use crate::cli::office::{OfficeRows, is_office};
use crate::cli::output::{Failure, Output};
use crate::cli::target::{self, Target};
use crate::diagnostic::Diagnostic;
use crate::spec::Spec;

/// Rows that are not written to their file as they come.
enum Kept {
    /// Of a Parquet file, which has an end of its own.
    Parquet(Box<ParquetRows>),
    /// Of a workbook or a Q-DAS file.
    Office(OfficeRows<Box<dyn Write + Send>>),
}

/// Files that are written.
#[derive(Default)]
pub(super) struct Targets {
    file: Option<Target>,
    kept: Option<Kept>,
    rejects: Option<Target>,
    packing: Packing,
    rejects_packing: Packing,
}

impl Targets {
    pub(super) fn sinks(&mut self) -> Sinks<'_> {
        let (packing, rejects_packing) = (self.packing, self.rejects_packing);
        let file = self.file.as_mut().map(|writer| RowSink::Text(Sink { writer, packing }));
        Sinks {
            rows: match &mut self.kept {
                Some(Kept::Parquet(rows)) => Some(RowSink::Columns(rows.as_mut())),
                Some(Kept::Office(writer)) => Some(RowSink::Text(Sink { writer, packing })),
                None => file,
            },
            rejects: self.rejects.as_mut().map(|writer| Sink { writer, packing: rejects_packing }),
        }
    }

    /// Ends the files; whether that was not interrupted. Of a run that is not complete, what there is is kept beside, and
    /// that is said.
    pub(super) fn finish(
        mut self,
        is_complete: bool,
        interruption: &Interruption,
        output: &mut Output,
    ) -> Result<bool, Failure> {
        let mut is_written = true;
        match self.kept {
            Some(Kept::Parquet(rows)) => rows.finish()?,
            Some(Kept::Office(rows)) => is_written = rows.finish(interruption.stop())?,
            None => {}
        }
        if let Some(file) = self.file.take_if(|_| !is_written) {
            file.discard(output);
        }
        for target in [self.file, self.rejects].into_iter().flatten() {
            target.end(is_complete, output)?;
        }
        Ok(is_written)
    }
}

impl Args {
    /// Refuses files to be written that are read, that are one, or whose name says what they are not.
    pub(super) fn refuse_targets(&self, inputs: &[String]) -> Result<(), Failure> {
        let written: Vec<&str> =
            [&self.output, &self.rejects, &self.junit].into_iter().flatten().map(String::as_str).collect();
        target::refuse_same(&written)?;
        for path in &written {
            target::refuse_inputs(path, inputs)?;
        }
        self.rejects.as_deref().map_or(Ok(()), refuse_other_place)
    }

    /// Where rows and rejected rows go.
    pub(super) fn targets(
        &self,
        format: RowFormat,
        inputs: &[String],
        spec: &Spec,
        columns: &dyn Fn() -> Vec<(String, ColumnKind)>,
    ) -> Result<Targets, Failure> {
        let rejects = self.rejects.as_ref().map(|path| Target::create(path, inputs)).transpose()?;
        let packing = |path: &Option<String>| path.as_deref().map_or(Packing::None, |path| Packing::of_name(path).0);
        let (packing, rejects_packing) = (packing(&self.output), packing(&self.rejects));
        let path = self.output.as_deref().unwrap_or("-");
        let mut file = if self.summary { None } else { Some(Target::create(path, inputs)?) };
        let kept = match &mut file {
            Some(file) if is_office(path) => {
                let title = spec.title.as_deref().unwrap_or("rackmesh");
                Some(Kept::Office(OfficeRows::new(path, file.take_writer(), (title, &spec.limits()))?))
            }
            Some(file) if format == RowFormat::Columns => {
                Some(Kept::Parquet(Box::new(ParquetRows::new(file.take_writer(), &columns())?)))
            }
            _ => None,
        };
        Ok(Targets { file, kept, rejects, packing, rejects_packing })
    }
}

/// Rejected rows are the bytes of the table: a name that says otherwise is refused, and so are the process's own streams, for
/// what shows them would obey what stands in them.
fn refuse_other_place(path: &str) -> Result<(), Failure> {
    if target::is_own_stream(path) {
        let message =
            format!("--rejects {path}: rejected rows are copied byte by byte, which only a file takes safely");
        return Err(Diagnostic::usage(message).help("give the name of a file").into());
    }
    const OTHERS: [&str; 7] = ["parquet", "xlsx", "xlsm", "dfq", "json", "jsonl", "ndjson"];
    let ending = target::ending(path);
    if !OTHERS.contains(&ending.as_str()) {
        return Ok(());
    }
    let message = format!("--rejects {path}: rejected rows are written as lines of text, and not as .{ending}");
    Err(Diagnostic::usage(message).help("give a name that ends in .csv or .txt").into())
}
