//! The files that a batch writes: rows in their format and packing, and rejected rows. They appear under their names when
//! the run is complete; of one that is not, what there is stands beside as NAME.partial.

use std::io::Write as _;

use super::Args;
use crate::batch::{ColumnKind, Packing, ParquetRows, RowFormat, RowSink, Sink, Sinks};
use crate::cli::office;
use crate::cli::output::{Failure, Output};
use crate::cli::target::{self, Target};
use crate::diagnostic::Diagnostic;
use crate::spec::Spec;

/// Rows that are not written to their file as they come.
enum Kept {
    /// Of a Parquet file, which has an end of its own.
    Parquet(Box<ParquetRows>),
    /// Of a file whose format needs all rows, and its name.
    Office(office::Collected, String),
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
                Some(Kept::Office(writer, _)) => Some(RowSink::Text(Sink { writer, packing })),
                None => file,
            },
            rejects: self.rejects.as_mut().map(|writer| Sink { writer, packing: rejects_packing }),
        }
    }

    /// Ends the files. Of a run that is not complete, what there is is kept beside, and that is said.
    pub(super) fn finish(mut self, is_complete: bool, spec: &Spec, output: &mut Output) -> Result<(), Failure> {
        match (self.kept, &mut self.file) {
            (Some(Kept::Parquet(rows)), _) => rows.finish()?,
            (Some(Kept::Office(rows, path)), Some(file)) if !rows.is_empty() => {
                let title = spec.title.as_deref().unwrap_or("rackmesh");
                file.write_all(&office::rows_as(&path, &rows.rows()?, title, &spec.limits())?)?;
            }
            _ => {}
        }
        for target in [self.file, self.rejects].into_iter().flatten() {
            target.end(is_complete, output)?;
        }
        Ok(())
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
        self.rejects.as_deref().map_or(Ok(()), refuse_other_format)
    }

    /// Where rows and rejected rows go.
    pub(super) fn targets(
        &self,
        format: RowFormat,
        inputs: &[String],
        columns: &dyn Fn() -> Vec<(String, ColumnKind)>,
    ) -> Result<Targets, Failure> {
        let rejects = self.rejects.as_ref().map(|path| Target::create(path, inputs)).transpose()?;
        let packing = |path: &Option<String>| path.as_deref().map_or(Packing::None, |path| Packing::of_name(path).0);
        let (packing, rejects_packing) = (packing(&self.output), packing(&self.rejects));
        let path = self.output.as_deref().unwrap_or("-");
        let mut file = if self.summary { None } else { Some(Target::create(path, inputs)?) };
        let kept = match &mut file {
            Some(_) if office::is_office(path) => Some(Kept::Office(office::Collected::default(), path.to_owned())),
            Some(file) if format == RowFormat::Columns => {
                Some(Kept::Parquet(Box::new(ParquetRows::new(file.take_writer(), &columns())?)))
            }
            _ => None,
        };
        Ok(Targets { file, kept, rejects, packing, rejects_packing })
    }
}

/// Rejected rows are text: a name that says otherwise is refused.
fn refuse_other_format(path: &str) -> Result<(), Failure> {
    const OTHERS: [&str; 7] = ["parquet", "xlsx", "xlsm", "dfq", "json", "jsonl", "ndjson"];
    let ending = target::ending(path);
    if !OTHERS.contains(&ending.as_str()) {
        return Ok(());
    }
    let message = format!("--rejects {path}: rejected rows are written as lines of text, and not as .{ending}");
    Err(Diagnostic::usage(message).help("give a name that ends in .csv or .txt").into())
}
