//! What the rows or the summary of a batch are written as: by the option, or by the name of the output.

use clap::ValueEnum;

use super::Args;
use crate::batch::{Packing, RowFormat};
use crate::cli::output::Failure;
use crate::cli::target::{self, shown};
use crate::diagnostic::Diagnostic;
use crate::report::{Format, Screen};

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum BatchFormat {
    /// Comma-separated values with a header.
    Csv,
    /// Tab-separated values with a header.
    Tsv,
    /// One JSON object per line (rows).
    Jsonl,
    /// Parquet (rows).
    Parquet,
    /// Aligned tables for people; rows on a terminal unless told otherwise.
    Table,
    /// Markdown tables (summary).
    Markdown,
    /// An array of JSON objects, of a summary one object.
    Json,
    /// Workbook or Q-DAS file (rows), as the output's name says.
    #[value(skip)]
    Office,
}

impl BatchFormat {
    /// The format that the ending of a name tells.
    fn of_ending(ending: &str) -> Option<Self> {
        Some(match ending {
            "csv" => Self::Csv,
            "tsv" => Self::Tsv,
            "jsonl" | "ndjson" => Self::Jsonl,
            "parquet" => Self::Parquet,
            "xlsx" | "dfq" => Self::Office,
            "json" => Self::Json,
            "md" => Self::Markdown,
            "txt" => Self::Table,
            _ => return None,
        })
    }

    /// What it is called on the command line.
    fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
    }
}

impl Args {
    /// What is written, and by that the format of the rows that the run makes, and of a summary.
    pub(super) fn formats(&self, screen: Screen) -> Result<(BatchFormat, RowFormat, Format), Failure> {
        let (format, safe_csv) = (self.format(screen)?, screen.safe_csv);
        let refused = |what: &str, help: &str| {
            let message = format!("{what} cannot be written as {}", format.name());
            Err(Diagnostic::usage(message).help(help).into())
        };
        let rows = match format {
            BatchFormat::Csv if safe_csv => RowFormat::SafeCsv,
            BatchFormat::Tsv if safe_csv => RowFormat::SafeTsv,
            BatchFormat::Csv | BatchFormat::Office | BatchFormat::Table => RowFormat::Csv,
            BatchFormat::Tsv => RowFormat::Tsv,
            BatchFormat::Jsonl | BatchFormat::Json => RowFormat::JsonLines,
            BatchFormat::Parquet => RowFormat::Columns,
            _ if self.summary => RowFormat::Csv,
            BatchFormat::Markdown => {
                return refused("rows", "write table, csv, tsv, json, jsonl or parquet; or ask for the --summary");
            }
        };
        let summary = match format {
            BatchFormat::Table => Format::Table,
            BatchFormat::Csv => Format::Csv,
            BatchFormat::Json => Format::Json,
            BatchFormat::Markdown => Format::Markdown,
            _ if self.summary => return refused("a summary", "write table, markdown, json or csv"),
            _ => Format::Table,
        };
        Ok((format, rows, summary))
    }

    /// The format: that of the option, of the output's name, or the usual one.
    fn format(&self, screen: Screen) -> Result<BatchFormat, Failure> {
        let Some(format) = self.format else {
            let is_shown = self.output.is_none() && screen.width.is_some();
            let usual = if self.summary || is_shown { BatchFormat::Table } else { BatchFormat::Csv };
            return Ok(self.known_ending()?.and_then(BatchFormat::of_ending).unwrap_or(usual));
        };
        let Some(path) = &self.output else { return Ok(format) };
        let name = &shown(path);
        match BatchFormat::of_ending(&target::ending(Packing::of_name(name).1)) {
            // .txt is any text
            Some(named) if named != format && named != BatchFormat::Table => {
                let message = format!("--format {} does not fit the name {name}", format.name());
                Err(Diagnostic::usage(message).help("leave out --format, or end the name otherwise").into())
            }
            _ => Ok(format),
        }
    }

    /// The ending of the output's name, which tells the format.
    fn known_ending(&self) -> Result<Option<&'static str>, Diagnostic> {
        const ROWS: [&str; 9] = ["csv", "tsv", "jsonl", "ndjson", "json", "txt", "parquet", "xlsx", "dfq"];
        let Some(path) = &self.output else { return Ok(None) };
        let name = &shown(path);
        let ending = match Packing::of_name(name) {
            _ if self.summary => target::known_ending(path, path, &["txt", "json", "csv", "md"]),
            (Packing::None, _) => target::known_ending(path, path, &ROWS),
            // text alone is packed
            (_, unpacked) => target::known_ending(path, unpacked, &ROWS[..4]),
        };
        ending.map_err(|diagnostic| {
            let endings = diagnostic.help.clone().unwrap_or_default();
            diagnostic.help(format!("{endings}; or --format says the format"))
        })
    }
}
