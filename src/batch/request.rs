//! The request to a batch. The command line fills it, the plan reads it; it knows no table.

use super::number::Decimals;
use crate::chance::Settings;
use crate::formula::Model;
use crate::judge::{Rule, Stack, Verdict};

/// What is asked of a batch.
#[expect(clippy::struct_excessive_bools, reason = "independent options")]
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// The formulas' model.
    pub model: Model,
    /// The combination that the verdict judges.
    pub stack: Stack,
    /// The decision rule: by the limits, or with a guard band.
    pub rule: Rule,
    /// How to simulate the distribution of each part's results; `None` for no simulation.
    pub monte_carlo: Option<Settings>,
    /// Decimals of the numbers written.
    pub decimals: Decimals,
    /// The format of the rows written.
    pub format: RowFormat,
    /// The columns to write, by the names of the output or of the input; all results if `None`.
    pub columns: Option<Vec<String>>,
    /// Columns of the first table that are written as they are, beside all results; a later table may lack one.
    pub copied: Vec<String>,
    /// Whether the errors of each part are put on the worst teeth that a search finds, where the whole pair is known.
    pub mesh: bool,
    /// Whether parts are judged although the table lacks an error that the spec asks for.
    pub partial: bool,
    /// Whether statistics and the worst parts are kept.
    pub statistics: bool,
    /// Which rows are written.
    pub rows: Rows,
    /// Whether the run ends at the first rejected row.
    pub strict: bool,
    /// How many parts that do not pass are kept with their results.
    pub failures_kept: usize,
    /// Whether every part goes to [`Sinks::parts`](super::Sinks::parts).
    pub lists_parts: bool,
    /// How many rejected rows are kept with what is wrong with them, unless every part is listed.
    pub problems_kept: usize,
}

/// Which rows are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rows {
    /// None: only the outcome is wanted.
    None,
    /// One per part.
    #[default]
    All,
    /// One per part that does not pass.
    NotPassed,
    /// One per row of the table, with a column `reason` that says why a row has no results.
    Every,
}

impl Rows {
    /// Whether a part with that verdict is written.
    #[inline]
    pub(super) fn has(self, verdict: Option<Verdict>) -> bool {
        match self {
            Self::None => false,
            Self::All | Self::Every => true,
            Self::NotPassed => verdict != Some(Verdict::Pass),
        }
    }
}

/// How rows are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum RowFormat {
    /// Comma-separated values with a header.
    #[default]
    Csv,
    /// Tab-separated values with a header.
    Tsv,
    /// Comma-separated values, with an apostrophe before texts that a spreadsheet would compute.
    SafeCsv,
    /// See [`RowFormat::SafeCsv`].
    SafeTsv,
    /// One JSON object per line.
    JsonLines,
    /// No text, but columns.
    Columns,
}

impl RowFormat {
    /// The separator of values; `None` for JSON.
    #[inline]
    pub(super) const fn separator(self) -> Option<u8> {
        match self {
            Self::Csv | Self::SafeCsv | Self::Columns => Some(b','),
            Self::Tsv | Self::SafeTsv => Some(b'\t'),
            Self::JsonLines => None,
        }
    }
}
