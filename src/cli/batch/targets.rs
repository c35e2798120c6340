//! The files that a batch writes: rows in their format and packing, and rejected rows. They appear under their names when
//! the run is complete; of one that is not, what there is stands beside as NAME.partial.

use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};

use super::Args;
use crate::batch::{ColumnKind, Packing, ParquetRows, RowFormat, RowSink, Sink, Sinks};
use crate::cli::output::{Failure, Output};
use crate::cli::target::{self, Target};
use crate::cli::{office, stream};
use crate::diagnostic::{Code, Diagnostic};
use crate::spec::Spec;

/// A file that a writer of its own format writes, and that is ended here.
#[derive(Clone)]
struct Shared(Arc<Mutex<Option<Target>>>);

impl Shared {
    fn new(target: Target) -> Self {
        Self(Arc::new(Mutex::new(Some(target))))
    }

    fn take(&self) -> Option<Target> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.lock().unwrap_or_else(PoisonError::into_inner).as_mut() {
            Some(target) => target.write(bytes),
            None => Err(io::Error::other("the file has ended")),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).as_mut().map_or(Ok(()), Write::flush)
    }
}

/// Files that are written.
pub(super) struct Targets {
    rows: Option<Box<dyn Write + Send>>,
    /// The file of the rows, if they go to one.
    file: Option<Shared>,
    /// The rows, if they become a Parquet file, which has an end of its own.
    parquet: Option<ParquetRows>,
    /// The rows, if their format needs all of them.
    collected: Option<office::Collected>,
    rejects: Option<Target>,
    packing: Packing,
    rejects_packing: Packing,
}

impl Targets {
    pub(super) fn sinks(&mut self) -> Sinks<'_> {
        let (packing, rejects_packing) = (self.packing, self.rejects_packing);
        Sinks {
            rows: match (&mut self.parquet, &mut self.rows) {
                (Some(parquet), _) => Some(RowSink::Columns(parquet)),
                (None, rows) => rows.as_mut().map(|writer| RowSink::Text(Sink { writer, packing })),
            },
            rejects: self.rejects.as_mut().map(|writer| Sink { writer, packing: rejects_packing }),
        }
    }

    /// Ends the files. Of a run that is not complete, what there is is kept beside, and that is said.
    pub(super) fn finish(
        self,
        is_complete: bool,
        path: Option<&str>,
        spec: &Spec,
        output: &mut Output,
    ) -> Result<(), Failure> {
        if let Some(parquet) = self.parquet {
            parquet.finish()?;
        }
        let file = self.file.and_then(|file| file.take());
        let file = match (self.collected, path, file) {
            (Some(collected), Some(path), Some(mut file)) => {
                let title = spec.title.as_deref().unwrap_or("rackmesh");
                file.write_all(&office::rows_as(path, &collected.rows()?, title, &spec.limits())?)?;
                Some(file)
            }
            (_, _, file) => file,
        };
        for target in [file, self.rejects].into_iter().flatten() {
            target.end(is_complete, output)?;
        }
        Ok(())
    }
}

impl Args {
    /// Where rows and rejected rows go.
    pub(super) fn targets(
        &self,
        format: RowFormat,
        inputs: &[String],
        columns: &dyn Fn() -> Vec<(String, ColumnKind)>,
    ) -> Result<Targets, Failure> {
        let inputs: Vec<&str> = inputs.iter().map(String::as_str).collect();
        let written: Vec<&str> =
            [&self.output, &self.rejects, &self.junit].into_iter().flatten().map(String::as_str).collect();
        target::refuse_same(&written)?;
        for path in &written {
            target::refuse_inputs(path, &inputs)?;
        }
        self.rejects.as_deref().map_or(Ok(()), refuse_other_format)?;
        let rejects = self.rejects.as_ref().map(|path| Target::create(path, &inputs)).transpose()?;
        let packing = |path: &Option<String>| path.as_deref().map_or(Packing::None, |path| Packing::of_name(path).0);
        let mut targets = Targets {
            rows: None,
            file: None,
            parquet: None,
            collected: None,
            rejects,
            packing: packing(&self.output),
            rejects_packing: packing(&self.rejects),
        };
        if self.summary {
            return Ok(targets);
        }
        let rows: Box<dyn Write + Send> = match &self.output {
            Some(path) => {
                let file = Shared::new(Target::create(path, &inputs)?);
                targets.file = Some(file.clone());
                if office::is_office(path) {
                    let collected = office::Collected::default();
                    targets.collected = Some(collected.clone());
                    Box::new(collected)
                } else {
                    Box::new(file)
                }
            }
            None => Box::new(stream::Stdout),
        };
        if format == RowFormat::Columns {
            targets.parquet = Some(ParquetRows::new(rows, &columns())?);
        } else {
            targets.rows = Some(rows);
        }
        Ok(targets)
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
    Err(Diagnostic::error(Code::Usage, message).help("give a name that ends in .csv or .txt").into())
}
