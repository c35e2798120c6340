//! Results as Excel workbooks and Q-DAS files, for `paste` and `batch`.

use std::path::Path;

use super::output::Failure;
use super::target;
use crate::diagnostic::Code;
use crate::diagnostic::Diagnostic;
use crate::report::Report;
use crate::spec::Spec;

/// Whether results for a file of that name are collected first: the format needs them all.
pub(super) fn is_office(path: &str) -> bool {
    let extension = Path::new(path).extension().and_then(|extension| extension.to_str()).unwrap_or("");
    ["xlsx", "dfq"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// Rows of CSV that are kept until they are all there.
#[derive(Debug, Clone, Default)]
pub(super) struct Collected(std::sync::Arc<std::sync::Mutex<Vec<u8>>>);

/// Bytes of rows that are kept at most: a full Excel sheet and more.
const LARGEST_RESULT: usize = 512 << 20;

impl std::io::Write for Collected {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let mut kept = self.0.lock().map_err(|_| std::io::Error::other("the rows are lost"))?;
        if kept.len() + bytes.len() > LARGEST_RESULT {
            return Err(std::io::Error::other("there are too many rows for this format; write .csv"));
        }
        kept.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Collected {
    /// The rows, header included.
    pub(super) fn rows(&self) -> Result<Vec<Vec<String>>, Failure> {
        let kept = self.0.lock().map_err(|_| std::io::Error::other("the rows are lost"))?;
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(kept.as_slice());
        let rows = reader.records().map(|row| row.map(|row| row.iter().map(str::to_owned).collect()));
        Ok(rows.collect::<Result<_, csv::Error>>().map_err(std::io::Error::from)?)
    }
}

/// Rows with a header as a Q-DAS file if the name ends in `.dfq`, as a workbook if not.
pub(super) fn rows_as(path: &str, rows: &[Vec<String>], spec: &Spec) -> Result<Vec<u8>, Failure> {
    let title = spec.title.as_deref().unwrap_or("rackmesh");
    match Path::new(path).extension().and_then(|extension| extension.to_str()) {
        Some(extension) if extension.eq_ignore_ascii_case("dfq") => {
            Ok(crate::report::qdas(rows, title, &spec.limits()))
        }
        _ => crate::report::xlsx::workbook("rackmesh", rows)
            .map_err(|error| Diagnostic::error(Code::FileAccess, format!("cannot write {path}: {error}")).into()),
    }
}

/// A report in the format that the name ends in: `.xlsx`, `.dfq`, `.csv`, `.json`, `.md` or `.txt`. Pages are written by
/// the caller.
pub(super) fn report_as(path: &str, report: &dyn Report, spec: &Spec) -> Result<Vec<u8>, Failure> {
    use crate::report::Format;
    let format = match target::known_ending(path, &["html", "htm", "xlsx", "dfq", "csv", "json", "md", "txt"])? {
        Some("xlsx" | "dfq") => return rows_as(path, &report.rows(), spec),
        Some("csv") => Format::Csv,
        Some("json") => Format::Json,
        Some("md") => Format::Markdown,
        _ => Format::Table,
    };
    Ok(crate::report::write(report, format, crate::report::Screen::default())?.into_bytes())
}
