//! Results for people and programs.
//!
//! A result describes itself once ([`Report`]): its JSON, its rows for CSV, and its blocks of text and tables. One writer per
//! format turns that into text ([`write`](fn@write)), which the command line prints; nothing here computes a result.
//!
//! JSON and CSV are for programs: keys carry their unit, numbers are the shortest text that reads back
//! as the same double, and what could not be computed is `null` or an empty field. Tables and Markdown
//! are for people: four decimals of a millimetre, which is 0.1 µm.

#[cfg(feature = "batch")]
mod basis;
#[cfg(feature = "batch")]
mod batch;
#[cfg(feature = "batch")]
mod batch_chart;
mod budget;
mod calculation;
pub mod chart;
#[cfg(feature = "batch")]
mod ci;
mod class;
#[cfg(feature = "cli")]
pub mod compare;
pub mod contributions;
mod diagnosis;
mod evaluation;
mod fact;
pub mod function;
mod geometry;
mod grounds;
#[cfg(feature = "html")]
pub mod html;
mod mesh;
pub mod mesh_points;
mod number;
#[cfg(feature = "batch")]
mod parts;
#[cfg(feature = "batch")]
mod paste;
#[cfg(feature = "table")]
mod qdas;
mod racks;
#[cfg(feature = "table")]
mod reading;
mod reproduction;
mod rows;
mod simulation;
mod sketch;
#[cfg(feature = "cli")]
pub mod sweep;
mod table;
mod trace;
mod uncertainty;
pub mod xlsx;

#[cfg(feature = "batch")]
pub use basis::Basis;
#[cfg(feature = "batch")]
pub use batch::BatchReport;
#[cfg(feature = "batch")]
pub use batch_chart::{Histograms, RunChart};
pub use budget::BudgetReport;
pub use calculation::{Calculation, ResultUnit, WorstCase, WorstCaseResult, formula_note};
#[cfg(feature = "batch")]
pub use ci::{ANNOTATIONS_SHOWN, Junit, github_annotation, github_annotations, junit_of_failure};
pub use class::{ClassReport, ClassRow, GradeSearchReport, ObtainedReport};
pub use evaluation::{EvaluationReport, MeshPart};

pub use fact::FORMAT_VERSION;
pub(crate) use fact::document;
#[cfg(feature = "cli")]
pub(crate) use fact::{at, element_name};
pub use function::{BoundPart, FunctionPart, YokeSection};
#[cfg(feature = "batch")]
pub use function::{plug_in_words, yokes_block};
pub use grounds::{Assumption, assumptions, bound_note, bound_remarks, unstated};
pub use mesh::{CurveEnd, MeasureReport, MeshReport, extreme_in_words};
#[cfg(feature = "cli")]
pub(crate) use number::{counted, grouped};
#[cfg(feature = "batch")]
pub use parts::{part_block, parts_blocks};
#[cfg(feature = "batch")]
pub use paste::{PartsReport, SpacesReport};
#[cfg(feature = "table")]
pub use qdas::QdasRows;
pub use racks::{RacksReport, StudyFileError, rack_columns, rack_lines, read_study, study_json};
#[cfg(feature = "table")]
pub use reading::{WithReading, reading_blocks, reading_form, remarks, said};
pub use reproduction::Reproduction;
pub use rows::{RowsReport, row_heading};
pub use simulation::SimulationReport;
#[cfg(feature = "cli")]
pub(crate) use table::table_text;
use table::worst_last;
pub use table::{Align, Block, Column, Table, noted};
pub use trace::TracePart;
pub use uncertainty::UncertaintyPart;

use serde_json::Value;

use crate::deviation::DeviationKind;
use crate::diagnostic::{harmless, harmless_lines, is_formula};

/// Adds the texts that a list does not have.
#[cfg(feature = "batch")]
pub(crate) fn add_new(all: &mut Vec<String>, more: impl IntoIterator<Item = String>) {
    for one in more {
        if !all.contains(&one) {
            all.push(one);
        }
    }
}

/// An output format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[non_exhaustive]
pub enum Format {
    /// Aligned tables for people.
    #[default]
    Table,
    /// One JSON object.
    Json,
    /// Comma-separated values with a header row.
    Csv,
    /// Markdown tables.
    Markdown,
}

/// How a table is drawn on a screen.
#[expect(clippy::struct_excessive_bools, reason = "each is a property of the screen by itself")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Screen {
    /// Columns available; `None` if the output is not a screen and lines may be as long as they are.
    pub width: Option<u16>,
    /// Whether to use colours.
    pub color: bool,
    /// Whether it only prints lines of plain text, so that nothing can be drawn.
    pub is_dumb: bool,
    /// Whether remarks are left out.
    pub is_quiet: bool,
    /// Whether a table comes with all remarks, not only the first ones.
    pub shows_all_remarks: bool,
    /// Whether a text in CSV that a spreadsheet would compute gets an apostrophe.
    pub safe_csv: bool,
}

impl Screen {
    /// A file in place of the screen.
    #[cfg(feature = "cli")]
    pub(crate) fn of_file(self) -> Self {
        Self { safe_csv: self.safe_csv, shows_all_remarks: true, ..Self::default() }
    }

    /// The columns that a drawing may take; `None` if nothing can be drawn.
    fn drawing_width(self) -> Option<usize> {
        const WIDEST: u16 = 100;
        self.width.filter(|_| !self.is_dumb).map(|width| usize::from(width.min(WIDEST)))
    }
}

/// A result that can be written.
pub trait Report {
    /// The whole result as JSON.
    fn json(&self) -> Value;

    /// The values that are compared from design to design, at the same places.
    fn brief(&self) -> Value {
        self.json()
    }

    /// The result as rows; the first is the header.
    fn rows(&self) -> Vec<Vec<String>>;

    /// The result for people.
    fn blocks(&self) -> Vec<Block>;
}

/// Text that cannot be taken for markup, in an element or in an attribute; line breaks stay.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in harmless_lines(text).chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// The first blocks of a report: the spec's title, if there is one.
fn titled(title: Option<&str>) -> Vec<Block> {
    title.map(|title| Block::Title(title.to_owned())).into_iter().collect()
}

/// The end of a verdict's sentence: the errors without which the user had the parts judged.
fn judged_without(kinds: &[DeviationKind]) -> String {
    let names: Vec<_> = kinds.iter().map(|kind| kind.name()).collect();
    if names.is_empty() { String::new() } else { format!("; judged without {}", names.join(", ")) }
}

/// The column of errors without which parts were judged, in `batch`.
const WITHOUT: &str = "judged_without";

/// The errors in that column.
fn keys_of(kinds: &[DeviationKind]) -> String {
    kinds.iter().map(|kind| kind.key()).collect::<Vec<_>>().join("; ")
}

/// Keeps the first remarks, which are the most important ones, and says how many there are besides.
fn keep_first_remarks(blocks: &mut Vec<Block>) {
    const MOST: usize = 2;
    let mut remarks = 0;
    let mut last = None;
    let all = std::mem::take(blocks);
    for block in all {
        let is_remark = matches!(block, Block::Remark(_));
        remarks += usize::from(is_remark);
        if !is_remark || remarks <= MOST {
            blocks.push(block);
            last = if is_remark { Some(blocks.len()) } else { last };
        }
    }
    if let (Some(last), Some(more @ 1..)) = (last, remarks.checked_sub(MOST)) {
        let what = if more == 1 { "remark" } else { "remarks" };
        blocks.insert(last, Block::Note(format!("{more} more {what}: --verbose")));
    }
}

/// The report as text in `format`, ending in a newline.
///
/// # Errors
/// If the rows are not a table (a fault of the report, not of its data).
pub fn write(report: &dyn Report, format: Format, screen: Screen) -> Result<String, std::io::Error> {
    let blocks = || {
        let mut blocks = report.blocks();
        blocks.retain(|block| !(screen.is_quiet && matches!(block, Block::Remark(_))));
        blocks.iter_mut().for_each(Block::show);
        blocks
    };
    match format {
        Format::Table => {
            let mut blocks = blocks();
            if !screen.shows_all_remarks {
                keep_first_remarks(&mut blocks);
            }
            Ok(table::text(&blocks, screen))
        }
        Format::Markdown => Ok(table::markdown(&blocks())),
        Format::Json => Ok(harmless_lines(&format!("{:#}\n", document(report.json()))).into_owned()),
        Format::Csv => {
            let mut writer = csv::Writer::from_writer(Vec::new());
            for row in report.rows() {
                for cell in &row {
                    let apostrophe = if screen.safe_csv && is_formula(cell) { "'" } else { "" };
                    writer.write_field(format!("{apostrophe}{}", harmless(cell)))?;
                }
                writer.write_record(None::<&[u8]>)?;
            }
            let bytes = writer.into_inner().map_err(csv::IntoInnerError::into_error)?;
            String::from_utf8(bytes).map_err(std::io::Error::other)
        }
    }
}
