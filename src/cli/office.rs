//! Excel workbooks and Q-DAS files as tables, for `paste` and `batch`; results as such files.

use std::io::Read as _;
use std::path::Path;

use super::output::Failure;
use crate::batch::Input;
use crate::cmm::qdas::{self, QdasTable};
use crate::cmm::xlsx::{CellRange, SheetRows, Workbook};
use crate::cmm::{Sheet, paste};
use crate::diagnostic::{Code, Diagnostic};
use crate::formula::Model;
use crate::report::Report;
use crate::spec::Spec;

/// Where in a workbook the table is.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct Place {
    /// The sheet of an Excel workbook; the first one that has the columns unless given.
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
    /// The cells of the sheet, header included.
    #[arg(long, value_name = "A1:F200")]
    range: Option<String>,
}

/// A table that is no text.
pub(super) enum Office {
    /// A sheet of a workbook.
    Sheet(SheetRows),
    /// A file of statistics software.
    Qdas(Box<QdasTable>),
}

/// Files are read as a whole up to this size.
const LARGEST_FILE: u64 = 64 << 20;

/// Opens `path` if its name is that of a workbook or a Q-DAS file; `None` if it is not.
pub(super) fn open(path: &str, spec: &Spec, place: &Place) -> Result<Option<Office>, Failure> {
    let extension = Path::new(path).extension().and_then(|extension| extension.to_str()).unwrap_or("");
    match extension.to_ascii_lowercase().as_str() {
        "xlsx" | "xlsm" => sheet(path, spec, place).map(Some),
        "dfq" => qdas(&[path.to_owned()], spec).map(Some),
        "dfd" | "dfx" => {
            let other = |wanted: &str| {
                // LOT.DFD and LOT.DFX, too
                let upper = extension.chars().all(|c| c.is_ascii_uppercase());
                let wanted = if upper { wanted.to_ascii_uppercase() } else { wanted.to_owned() };
                Path::new(path).with_extension(wanted).display().to_string()
            };
            qdas(&[other("dfd"), other("dfx")], spec).map(Some)
        }
        _ if place.sheet.is_some() || place.range.is_some() => {
            let message = format!("--sheet and --range are for Excel workbooks, and {path} is none");
            Err(Diagnostic::error(Code::Usage, message).help("the name of a workbook ends in .xlsx").into())
        }
        _ => Ok(None),
    }
}

fn bytes(path: &str) -> Result<Vec<u8>, Failure> {
    let unreadable = |reason: String| Diagnostic::error(Code::FileAccess, format!("cannot read {path}: {reason}"));
    let mut bytes = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes));
    read.map_err(|error| unreadable(error.to_string()))?;
    if bytes.len() as u64 > LARGEST_FILE {
        let help = "export the table as CSV, which is read at any size";
        return Err(unreadable("it is larger than 64 MiB".to_owned()).help(help).into());
    }
    Ok(bytes)
}

fn qdas(paths: &[String], spec: &Spec) -> Result<Office, Failure> {
    let mut files = Vec::new();
    for path in paths {
        files.push((path.as_str(), crate::cmm::decode(&bytes(path)?).into_owned()));
    }
    let files: Vec<_> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    Ok(Office::Qdas(Box::new(qdas::read(&files)?.table(&spec.column_names()))))
}

fn sheet(path: &str, spec: &Spec, place: &Place) -> Result<Office, Failure> {
    let range = match &place.range {
        Some(range) => {
            range.parse().map_err(|problem| Diagnostic::error(Code::Usage, format!("--range: {problem}")))?
        }
        None => CellRange::default(),
    };
    let own = spec.column_names();
    let known = |heading: &str| paste::is_value_heading(heading, &own);
    let book = Workbook::open(path, bytes(path)?)?;
    Ok(Office::Sheet(book.rows(place.sheet.as_deref(), range, &known)?))
}

impl Office {
    /// The spec with what the file says where it is silent, and remarks on that.
    pub(super) fn completed(&self, spec: &Spec, model: Model) -> (Spec, Vec<String>) {
        match self {
            Self::Sheet(_) => (spec.clone(), Vec::new()),
            Self::Qdas(table) => spec.completed_by(table.qdas(), model),
        }
    }

    /// The table as rows of a batch; `path` is what messages call it.
    pub(super) fn input(self, path: &str) -> Input {
        match self {
            Self::Sheet(sheet) => {
                // the place of a row is asked for after it was read: the batch counts rows, the sheet may skip some
                let numbers = std::sync::Arc::new(std::sync::Mutex::new(Vec::new()));
                let seen = std::sync::Arc::clone(&numbers);
                let rows = sheet.rows.map(move |row| {
                    let (number, cells) = row.map_err(std::io::Error::other)?;
                    if let Ok(mut seen) = seen.lock() {
                        seen.push(number);
                    }
                    Ok(cells)
                });
                let place = move |record: u64| {
                    let index = usize::try_from(record).unwrap_or(usize::MAX).saturating_sub(1);
                    let number = numbers.lock().ok().and_then(|numbers| numbers.get(index).copied());
                    number.map_or_else(String::new, |number| format!("row {number}"))
                };
                Input::of_rows(&sheet.name, sheet.columns, rows, place)
            }
            Self::Qdas(table) => {
                let table: std::sync::Arc<QdasTable> = std::sync::Arc::from(table);
                let of_place = std::sync::Arc::clone(&table);
                let columns = table.columns.clone();
                let rows = (0..table.len()).map(move |row| Ok(table.row(row)));
                let place = move |record: u64| {
                    let index = usize::try_from(record).unwrap_or(usize::MAX).saturating_sub(1);
                    format!("line {}", of_place.line(index))
                };
                Input::of_rows(path, columns, rows, place)
            }
        }
    }

    /// The whole table in memory, for a block that a person looks at.
    pub(super) fn sheet(self, path: &str) -> Result<Sheet, Failure> {
        const MOST_CELLS: usize = 200_000;
        let too_long = || {
            Diagnostic::error(Code::BadTable, format!("{path} has too many rows to be shown"))
                .help("`rackmesh batch` evaluates tables of any length")
        };
        match self {
            Self::Sheet(sheet) => {
                let most = MOST_CELLS / sheet.columns.len().max(1);
                let mut rows = Vec::new();
                for row in sheet.rows {
                    let unreadable =
                        |problem| Diagnostic::error(Code::FileAccess, format!("cannot read {path}: {problem}"));
                    rows.push(row.map_err(unreadable)?);
                    if rows.len() > most {
                        return Err(too_long().into());
                    }
                }
                Ok(Sheet { name: sheet.name, header_line: sheet.header_row, columns: sheet.columns, rows })
            }
            Self::Qdas(table) => {
                let sheet = table.sheet(path, MOST_CELLS);
                if sheet.rows.len() < table.len() { Err(too_long().into()) } else { Ok(sheet) }
            }
        }
    }
}

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

/// Writes rows with a header to a workbook or a Q-DAS file.
pub(super) fn write_rows(path: &str, rows: &[Vec<String>], spec: &Spec) -> Result<(), Failure> {
    let failed = |problem: &dyn std::fmt::Display| {
        Diagnostic::error(Code::FileAccess, format!("cannot write {path}: {problem}"))
    };
    let title = spec.title.as_deref().unwrap_or("rackmesh");
    let bytes = match Path::new(path).extension().and_then(|extension| extension.to_str()) {
        Some(extension) if extension.eq_ignore_ascii_case("dfq") => crate::report::qdas(rows, title, &spec.limits()),
        _ => crate::report::xlsx::workbook("rackmesh", rows).map_err(|error| failed(&error))?,
    };
    std::fs::write(path, bytes).map_err(|error| failed(&error))?;
    Ok(())
}

/// Writes a report's rows to a file of the format that its name ends in: `.xlsx`, `.dfq`, `.csv`, `.json`, `.md`.
pub(super) fn write(path: &str, report: &dyn Report, spec: &Spec) -> Result<(), Failure> {
    use crate::report::Format;
    let failed = |problem: &dyn std::fmt::Display| {
        Diagnostic::error(Code::FileAccess, format!("cannot write {path}: {problem}"))
    };
    let text = |format| report_text(report, format);
    let extension = Path::new(path).extension().and_then(|extension| extension.to_str()).unwrap_or("");
    let bytes = match extension.to_ascii_lowercase().as_str() {
        "xlsx" | "dfq" => return write_rows(path, &report.rows(), spec),
        "csv" => text(Format::Csv)?,
        "json" => text(Format::Json)?,
        "md" => text(Format::Markdown)?,
        "txt" => text(Format::Table)?,
        _ => {
            let message = format!("--output {path}: the name tells no format");
            let help = "it ends in .xlsx, .dfq, .csv, .json, .md or .txt";
            return Err(Diagnostic::error(Code::Usage, message).help(help).into());
        }
    };
    std::fs::write(path, bytes).map_err(|error| failed(&error))?;
    Ok(())
}

fn report_text(report: &dyn Report, format: crate::report::Format) -> Result<Vec<u8>, Failure> {
    Ok(crate::report::write(report, format, crate::report::Screen::default())?.into_bytes())
}
