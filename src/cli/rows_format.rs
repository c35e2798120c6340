//! The format of rows, or of the summary of a batch: by the option, or by the name of the output. Shared by the subcommands that
//! write a table.

use std::path::PathBuf;

use clap::ValueEnum;

use super::output::Failure;
use super::target::{self, shown};
use crate::batch::{Packing, RowFormat};
use crate::diagnostic::Diagnostic;
use crate::report::{Format, Screen};

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum RowsFormat {
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
    /// Markdown tables.
    Markdown,
    /// An array of JSON objects, of a summary one object.
    Json,
    /// Workbook or Q-DAS file (rows), as the output's name says.
    #[value(skip)]
    Office,
}

impl RowsFormat {
    /// The format of a name's ending.
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

    /// Whether the format is for people: such a table has the most important columns.
    pub(super) const fn is_for_people(self) -> bool {
        matches!(self, Self::Table | Self::Markdown)
    }

    /// Its name on the command line.
    fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
    }
}

/// Where rows go.
#[derive(Debug, clap::Args)]
pub(super) struct RowsArgs {
    /// The file to write; the ending of its name tells the format.
    #[arg(long, short, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Output format.
    #[arg(long, short, value_enum)]
    format: Option<RowsFormat>,
}

impl RowsArgs {
    /// The format of the output and with it that of the run's rows, and of a summary; `summary` says whether a summary is written in
    /// place of rows.
    pub(super) fn formats(&self, summary: bool, screen: Screen) -> Result<(RowsFormat, RowFormat, Format), Failure> {
        let (format, safe_csv) = (self.format(summary, screen)?, screen.safe_csv);
        let rows = match format {
            RowsFormat::Csv if safe_csv => RowFormat::SafeCsv,
            RowsFormat::Tsv if safe_csv => RowFormat::SafeTsv,
            RowsFormat::Csv | RowsFormat::Office | RowsFormat::Table | RowsFormat::Markdown => RowFormat::Csv,
            RowsFormat::Tsv => RowFormat::Tsv,
            RowsFormat::Jsonl | RowsFormat::Json => RowFormat::JsonLines,
            RowsFormat::Parquet => RowFormat::Columns,
        };
        let summary = match format {
            RowsFormat::Table => Format::Table,
            RowsFormat::Csv => Format::Csv,
            RowsFormat::Json => Format::Json,
            RowsFormat::Markdown => Format::Markdown,
            _ if summary => {
                let message = format!("a summary cannot be written as {}", format.name());
                return Err(Diagnostic::usage(message).help("write table, markdown, json or csv").into());
            }
            _ => Format::Table,
        };
        Ok((format, rows, summary))
    }

    /// The format: that of the option, of the output's name, or the usual one.
    fn format(&self, summary: bool, screen: Screen) -> Result<RowsFormat, Failure> {
        let Some(format) = self.format else {
            let is_shown = self.output.is_none() && screen.width.is_some();
            let usual = if summary || is_shown { RowsFormat::Table } else { RowsFormat::Csv };
            return Ok(self.known_ending(summary)?.and_then(RowsFormat::of_ending).unwrap_or(usual));
        };
        let Some(path) = &self.output else { return Ok(format) };
        let name = &shown(path);
        match RowsFormat::of_ending(&target::ending(Packing::of_name(name).1)) {
            // .txt is any text
            Some(named) if named != format && named != RowsFormat::Table => {
                let message = format!("--format {} does not fit the name {name}", format.name());
                Err(Diagnostic::usage(message).help("leave out --format, or end the name otherwise").into())
            }
            _ => Ok(format),
        }
    }

    /// The ending of the output's name, which tells the format.
    fn known_ending(&self, summary: bool) -> Result<Option<&'static str>, Diagnostic> {
        const ROWS: [&str; 10] = ["csv", "tsv", "jsonl", "ndjson", "json", "txt", "md", "parquet", "xlsx", "dfq"];
        let Some(path) = &self.output else { return Ok(None) };
        let name = &shown(path);
        let ending = match Packing::of_name(name) {
            _ if summary => target::known_ending(path, path, &["txt", "json", "csv", "md"]),
            (Packing::None, _) => target::known_ending(path, path, &ROWS),
            // only text is packed
            (_, unpacked) => target::known_ending(path, unpacked, &ROWS[..4]),
        };
        ending.map_err(|diagnostic| {
            let endings = diagnostic.help.clone().unwrap_or_default();
            diagnostic.help(format!("{endings}; or --format says the format"))
        })
    }
}
