//! The files that a batch writes: rows in their format and packing, and rejected rows.

use std::fs::File;
use std::io::Write;

use super::{Args, BatchFormat, unwritable};
use crate::batch::{Packing, Sink, Sinks};
use crate::cli::output::Failure;
use crate::cli::{office, stream};
#[cfg(not(feature = "parquet"))]
use crate::diagnostic::{Code, Diagnostic};

/// What the columns of a Parquet file hold.
#[cfg(feature = "parquet")]
pub(super) type Kinds = Vec<crate::batch::ColumnKind>;
#[cfg(feature = "parquet")]
type Parquet = crate::batch::ParquetRows;

/// There are no Parquet files without the feature.
#[cfg(not(feature = "parquet"))]
pub(super) type Kinds = ();
#[cfg(not(feature = "parquet"))]
type Parquet = office::Collected;

#[cfg(feature = "parquet")]
#[expect(clippy::unnecessary_wraps, reason = "without the feature it fails")]
fn parquet(rows: Box<dyn Write + Send>, kinds: Kinds) -> Result<Parquet, Failure> {
    Ok(Parquet::new(rows, kinds))
}

#[cfg(not(feature = "parquet"))]
fn parquet(_: Box<dyn Write + Send>, (): Kinds) -> Result<Parquet, Failure> {
    Err(Diagnostic::error(Code::Usage, "this rackmesh was built without the feature `parquet`")
        .help("build it with `cargo install --path . --features parquet`, or write csv")
        .into())
}

/// Files that are written.
pub(super) struct Targets {
    rows: Option<Box<dyn Write + Send>>,
    /// The rows, too, if they become a Parquet file, which has an end of its own.
    parquet: Option<Parquet>,
    rejects: Option<File>,
    packing: Packing,
    rejects_packing: Packing,
}

impl Targets {
    /// Ends the files that have an end of their own.
    pub(super) fn finish(self) -> Result<(), Failure> {
        self.parquet.map_or(Ok(()), |parquet| Ok(parquet.finish()?))
    }

    pub(super) fn sinks(&mut self) -> Sinks<'_> {
        let (packing, rejects_packing) = (self.packing, self.rejects_packing);
        Sinks {
            rows: self.rows.as_mut().map(|writer| Sink { writer, packing }),
            rejects: self.rejects.as_mut().map(|writer| Sink { writer, packing: rejects_packing }),
        }
    }
}

impl Args {
    /// Where rows and rejected rows go.
    pub(super) fn targets(&self, collected: &office::Collected, kinds: &dyn Fn() -> Kinds) -> Result<Targets, Failure> {
        let rows: Option<Box<dyn Write + Send>> = match (&self.output, self.summary) {
            (_, true) => None,
            (Some(path), false) if office::is_office(path) => Some(Box::new(collected.clone())),
            (Some(path), false) => Some(Box::new(File::create(path).map_err(|error| unwritable(path, &error))?)),
            (None, false) => Some(Box::new(stream::Stdout)),
        };
        let (rows, parquet) = match rows {
            Some(rows) if self.is_parquet() => {
                let parquet = parquet(rows, kinds())?;
                let writer: Box<dyn Write + Send> = Box::new(parquet.clone());
                (Some(writer), Some(parquet))
            }
            rows => (rows, None),
        };
        let packing = |path: &Option<String>| path.as_deref().map_or(Packing::None, |path| Packing::of_name(path).0);
        let rejects = self.rejects.as_ref().map(|path| File::create(path).map_err(|error| unwritable(path, &error)));
        Ok(Targets {
            rows,
            parquet,
            rejects: rejects.transpose()?,
            packing: packing(&self.output),
            rejects_packing: packing(&self.rejects),
        })
    }

    /// Whether the rows become a Parquet file.
    fn is_parquet(&self) -> bool {
        let named = || self.output.as_deref().is_some_and(|path| path.to_ascii_lowercase().ends_with(".parquet"));
        !self.summary && (self.format == Some(BatchFormat::Parquet) || (self.format.is_none() && named()))
    }
}
