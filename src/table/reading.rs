//! How a table was read: what a user must know to trust the result. Filled by the reader; shown on a terminal, in JSON, on
//! the page and in JUnit by the reports.

use std::fmt;

use serde::Serialize;

use super::ledger::LeftOut;
use crate::quantity::shown;

/// How many lines that are no parts are kept.
pub(crate) const ASIDES_KEPT: usize = 100;

/// How one table was read.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Reading {
    /// The file, and the sheet of a workbook.
    pub file: String,
    /// What kind of file it is: `text`, `workbook`, `Q-DAS`, `Parquet`.
    pub format: &'static str,
    /// What stands between cells, in words.
    pub separator: Option<String>,
    /// The encoding, where it is not UTF-8.
    pub encoding: Option<String>,
    /// `point` or `comma`; `None` if no number has decimals, or none is text.
    pub decimal_mark: Option<&'static str>,
    /// Whether parts are `rows` or `columns`.
    pub parts_in: &'static str,
    /// What a row or column is: `part`, `space`, `tooth`.
    pub unit_counted: &'static str,
    /// Line of the header.
    pub header_line: Option<u64>,
    /// Each column that is used.
    pub columns: Vec<ColumnReading>,
    /// Columns and lines that are not used: what they are called, and why.
    pub not_used: Vec<NotUsed>,
    /// Lines that are no part of the table.
    pub asides: Vec<AsideReading>,
    /// What is assumed, and what the user should look at.
    pub notes: Vec<String>,
    /// The rules of the contract, with what each left out, or gave to a role that no value follows from.
    pub left_out: Vec<LeftOut>,
}

/// How one column was read.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct ColumnReading {
    /// As the table calls it.
    pub title: String,
    /// What it is: `rack_pitch`, `part_id`.
    pub role: String,
    /// The unit of its numbers.
    pub unit: Option<String>,
    /// `measured` or `deviation`.
    pub holds: Option<&'static str>,
    /// The nominal value, in words.
    pub nominal: Option<String>,
}

/// A column or line that is not used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NotUsed {
    /// As the table calls it.
    pub title: String,
    /// Why: `context`, `ignored by the user`, `others are ignored`.
    pub why: &'static str,
}

/// A line that is no part of the table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AsideReading {
    /// Its number.
    pub line: u64,
    /// What stands there.
    pub text: String,
}

impl Reading {
    /// What a user should know before trusting the result: the notes, and what is left out.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let used =
            self.left_out.iter().filter(|rule| rule.tally.count > 0 && rule.role.is_none()).map(ToString::to_string);
        let left_out = self.sentence("left out:", &used.collect::<Vec<_>>(), "");
        self.notes.iter().cloned().chain(left_out).collect()
    }

    fn sentence(&self, what: &str, each: &[String], more: &str) -> Option<String> {
        (!each.is_empty()).then(|| format!("{}: {what} {}{more}", self.file, each.join(", ")))
    }

    /// The warnings, then rules that leave out nothing, lines that are no parts and columns that are not used; a sentence each.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        const SHOWN: usize = 10;
        let asides = self.asides.iter().take(SHOWN).map(|aside| format!("{} \"{}\"", aside.line, shown(&aside.text)));
        let not_used = self.not_used.iter().map(|unused| format!("`{}`", unused.title));
        let lines = if self.asides.len() == 1 { "line" } else { "lines" };
        let more = if self.asides.len() > SHOWN { " and more" } else { "" };
        let unused = self.left_out.iter().filter(|rule| rule.tally.count == 0 && rule.rule.ends_with('`'));
        let unused: Vec<_> = unused.map(|rule| rule.rule.clone()).collect();
        let others = unused.len().saturating_sub(SHOWN);
        let others = if others > 0 { format!(" and {others} more") } else { String::new() };
        let said = [
            self.sentence("rules that leave out nothing:", &unused[..unused.len().min(SHOWN)], &others),
            self.sentence(&format!("no part of the table: {lines}"), &asides.collect::<Vec<_>>(), more),
            self.sentence("not used:", &not_used.collect::<Vec<_>>(), ""),
        ];
        self.warnings().into_iter().chain(said.into_iter().flatten()).collect()
    }
}

impl fmt::Display for ColumnReading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.title.is_empty() && !self.title.starts_with(&self.role) {
            write!(f, "\"{}\" = ", self.title)?;
        }
        f.write_str(&self.role)?;
        if let Some(unit) = &self.unit {
            write!(f, " [{unit}]")?;
        }
        if let Some(holds) = self.holds {
            write!(f, " {holds}")?;
        }
        match &self.nominal {
            Some(nominal) => write!(f, ", nominal {nominal}"),
            None => Ok(()),
        }
    }
}

/// How the table is read, in one line. What is left out is among the remarks.
impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.separator {
            Some(separator) => write!(f, "{}: read as {separator}", self.file)?,
            None => write!(f, "{}: read as {}", self.file, self.format)?,
        }
        if let Some(encoding) = &self.encoding {
            write!(f, ", {encoding}")?;
        }
        if let Some(mark) = self.decimal_mark {
            write!(f, ", decimal {mark}")?;
        }
        if let Some(line) = self.header_line {
            write!(f, ", names in line {line}")?;
        }
        let columns: Vec<_> = self.columns.iter().map(ToString::to_string).collect();
        let across = if self.parts_in == "columns" { "across" } else { "a row" };
        write!(f, ", a {} {across}: {}", self.unit_counted, columns.join(", "))
    }
}
