//! A file of rows: row by row, or as a Parquet file, a workbook, a Q-DAS file, a table for people or an array of JSON. It is begun
//! before anything is computed, and put in its place when the run is complete.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::office::{FormedRows, is_office};
use super::output::{Failure, Output};
use super::rows_format::RowsFormat;
use super::signals::Interruption;
use super::target::{Target, shown};
use crate::batch::{ColumnKind, Packing, ParquetRows, RowFormat, RowSink, Sink};
use crate::judge::Limits;
use crate::report::{Format, Screen};

/// Rows that are not written row by row.
enum Kept {
    /// Of a Parquet file, which has an end of its own.
    Parquet(Box<ParquetRows>),
    /// Of a workbook, a Q-DAS file, a table for people or an array of JSON.
    Formed(Box<FormedRows<Box<dyn Write + Send>>>),
}

/// A file of rows.
pub(super) struct RowsFile {
    file: Target,
    kept: Option<Kept>,
    packing: Packing,
}

impl RowsFile {
    /// Begins the file of that name, or standard output, in a run that reads `inputs`. `named` has the name of the rows in a Q-DAS
    /// file and their limits.
    pub(super) fn begin(
        path: Option<&Path>,
        inputs: &[PathBuf],
        named: (&str, &Limits),
        (format, screen, as_written): (RowsFormat, Screen, bool),
    ) -> Result<Self, Failure> {
        let screen = if path.is_some() { screen.of_file() } else { screen };
        let path = path.unwrap_or(Path::new("-"));
        let name = &shown(path);
        let mut file = Target::create(path, inputs)?;
        let formed = match format {
            _ if is_office(name) => Some(FormedRows::new(name, file.take_writer(), named)?),
            RowsFormat::Table => Some(FormedRows::table(file.take_writer(), Format::Table, screen, as_written)),
            RowsFormat::Markdown => Some(FormedRows::table(file.take_writer(), Format::Markdown, screen, as_written)),
            RowsFormat::Json => Some(FormedRows::array(file.take_writer())),
            _ => None,
        };
        let packing = Packing::of_name(name).0;
        Ok(Self { file, kept: formed.map(|rows| Kept::Formed(Box::new(rows))), packing })
    }

    /// The sink of the rows, once their columns are known.
    pub(super) fn sink(
        &mut self,
        format: RowFormat,
        columns: impl FnOnce() -> Vec<(String, ColumnKind)>,
    ) -> Result<RowSink<'_>, Failure> {
        if format == RowFormat::Columns && self.kept.is_none() {
            self.kept = Some(Kept::Parquet(Box::new(ParquetRows::new(self.file.take_writer(), &columns())?)));
        }
        let packing = self.packing;
        Ok(match &mut self.kept {
            Some(Kept::Parquet(rows)) => RowSink::Columns(rows.as_mut()),
            Some(Kept::Formed(writer)) => RowSink::Text(Sink { writer, packing }),
            None => RowSink::Text(Sink { writer: &mut self.file, packing }),
        })
    }

    /// Says that so many columns behind the first one are those of the table.
    pub(super) fn with_copied(&mut self, count: usize) {
        if let Some(Kept::Formed(rows)) = &mut self.kept {
            rows.with_copied(count);
        }
    }

    /// Completes the file; returns whether it is complete. An incomplete run keeps the rows so far in NAME.partial and says so.
    pub(super) fn finish(
        self,
        is_complete: bool,
        notes: &[String],
        interruption: &Interruption,
        output: &mut Output,
    ) -> Result<bool, Failure> {
        let is_written = match self.kept {
            Some(Kept::Parquet(rows)) => rows.finish().map(|()| true)?,
            Some(Kept::Formed(rows)) => rows.finish(notes, interruption.stop())?,
            None => true,
        };
        if is_written {
            self.file.end(is_complete, output)?;
        } else {
            self.file.discard(output);
        }
        Ok(is_written)
    }
}
