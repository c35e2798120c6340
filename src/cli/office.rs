//! Results as Excel workbooks and Q-DAS files, for `paste` and `batch`.

use super::output::Failure;
use super::target;
use crate::diagnostic::{Code, Diagnostic};
use crate::judge::Limits;
use crate::report;

/// Whether results for a file of that name are collected first: the format needs them all.
pub(super) fn is_office(path: &str) -> bool {
    ["xlsx", "dfq"].contains(&target::ending(path).as_str())
}

/// Rows of CSV that are kept until they are all there.
#[derive(Debug, Default)]
pub(super) struct Collected(Vec<u8>);

/// Bytes of rows that are kept at most: a full Excel sheet and more.
const LARGEST_RESULT: usize = 512 << 20;

impl std::io::Write for Collected {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if self.0.len() + bytes.len() > LARGEST_RESULT {
            return Err(std::io::Error::other("there are too many rows for this format; write .csv"));
        }
        self.0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Collected {
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The rows, header included.
    pub(super) fn rows(&self) -> Result<Vec<Vec<String>>, Failure> {
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(self.0.as_slice());
        let rows = reader.records().map(|row| row.map(|row| row.iter().map(str::to_owned).collect()));
        Ok(rows.collect::<Result<_, csv::Error>>().map_err(std::io::Error::from)?)
    }
}

/// Rows with a header as a Q-DAS file of a part if the name ends in `.dfq`, as a workbook if not.
pub(super) fn rows_as(path: &str, rows: &[Vec<String>], part: &str, limits: &Limits) -> Result<Vec<u8>, Failure> {
    if target::ending(path) == "dfq" {
        return Ok(report::qdas(rows, part, limits));
    }
    report::xlsx::workbook("rackmesh", rows)
        .map_err(|error| Diagnostic::error(Code::FileAccess, format!("cannot write {path}: {error}")).into())
}
