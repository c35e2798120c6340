//! The files that a batch writes: rows in their format and packing, and rejected rows.

use std::fs::File;
use std::io::Write;

use super::{Args, BatchFormat, unwritable};
use crate::batch::{ColumnKind, Packing, ParquetRows, Sink, Sinks};
use crate::cli::output::Failure;
use crate::cli::{office, stream};

/// Files that are written.
pub(super) struct Targets {
    rows: Option<Box<dyn Write + Send>>,
    /// The rows, too, if they become a Parquet file, which has an end of its own.
    parquet: Option<ParquetRows>,
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
    pub(super) fn targets(
        &self,
        collected: &office::Collected,
        kinds: &dyn Fn() -> Vec<ColumnKind>,
    ) -> Result<Targets, Failure> {
        let rows: Option<Box<dyn Write + Send>> = match (&self.output, self.summary) {
            (_, true) => None,
            (Some(path), false) if office::is_office(path) => Some(Box::new(collected.clone())),
            (Some(path), false) => Some(Box::new(File::create(path).map_err(|error| unwritable(path, &error))?)),
            (None, false) => Some(Box::new(stream::Stdout)),
        };
        let (rows, parquet) = match rows {
            Some(rows) if self.is_parquet() => {
                let parquet = ParquetRows::new(rows, kinds());
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
