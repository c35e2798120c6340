//! The data that a page keeps of the parts of tables: while they are read the run chart, the texts of columns about all parts, and
//! each part where all are listed; in the end the outcome.

use std::borrow::Cow;
use std::io;
use std::sync::Arc;

use crate::batch::{ColumnSink, Outcome, Part, PartSink, Plan, Problem, ResultColumns};
use crate::report::chart::Chart;
use crate::report::{Basis, Block, RunChart, part_block, parts_blocks, yokes_block};
use crate::spec::Spec;
use crate::spec::keys::{self, Key};
use crate::table::{LeftOut, Reading};

/// Every part.
#[derive(Default)]
pub(super) struct Listed(pub(super) Vec<Part>);

impl PartSink for Listed {
    fn take(&mut self, parts: &[Part], _: &[Problem]) -> io::Result<()> {
        self.0.extend_from_slice(parts);
        Ok(())
    }
}

/// The page's data of the rows of a batch.
pub(super) struct Shown {
    pub(super) run: RunChart,
    pub(super) details: Vec<Detail>,
}

impl ColumnSink for Shown {
    fn take(&mut self, rows: ResultColumns) -> io::Result<()> {
        self.details.iter_mut().for_each(|detail| detail.take(&rows));
        self.run.take(rows)
    }
}

/// The texts of a column about all parts.
pub(super) struct Detail {
    /// The key of `[report]` that it stands for.
    key: &'static str,
    column: usize,
    /// The first texts that differ.
    texts: Vec<String>,
}

impl Detail {
    /// Texts that are kept.
    const MOST: usize = 4;

    /// Those that the spec names columns for.
    pub(super) fn of(plan: &Plan, spec: &Spec) -> Vec<Self> {
        let written = plan.column_names();
        let place = |heading: &String| written.iter().position(|name| name == heading);
        let details = spec.table.layout.details.iter();
        details.filter_map(|(key, heading)| Some(Self { key, column: place(heading)?, texts: Vec::new() })).collect()
    }

    /// Those that the spec names columns for, of tables whose rows are teeth.
    pub(super) fn of_teeth(spec: &Spec, readings: &[Reading]) -> Vec<Self> {
        let of_column = |(key, heading): &(&'static str, String)| {
            let mut detail = Self { key, column: 0, texts: Vec::new() };
            let rules = readings.iter().flat_map(|reading| &reading.left_out);
            let texts = rules.filter(|rule| rule.role == Some(*key)).flat_map(LeftOut::texts);
            texts.filter(|text| *text != heading.as_str()).for_each(|text| detail.keep(text.into()));
            detail
        };
        spec.table.layout.details.iter().map(of_column).collect()
    }

    fn take(&mut self, rows: &ResultColumns) {
        let column = &rows.columns[self.column];
        for text in (0..rows.rows).filter_map(|row| column.text(row)) {
            self.keep(String::from_utf8_lossy(text));
        }
    }

    fn keep(&mut self, text: Cow<'_, str>) {
        if self.texts.len() < Self::MOST && !text.is_empty() && self.texts.iter().all(|known| *known != text) {
            self.texts.push(text.into_owned());
        }
    }

    /// The texts in a line.
    fn shown(&self) -> String {
        let all = self.texts.iter().take(Self::MOST - 1).cloned().collect::<Vec<_>>().join(", ");
        if self.texts.len() < Self::MOST { all } else { format!("{all}, …") }
    }
}

/// What the head of a page says of the parts: by a setting, or else by the columns of the table, or else by the spec's own
/// `[report]`. Of parts that have names in their table, `[report]` does not name one.
pub(super) fn details(spec: &Spec, columns: &[Detail], has_names: bool) -> Vec<(String, String)> {
    let detail = |key: Key<String>| {
        let name = key.any.name();
        let column = columns.iter().find(|column| column.key == name && !column.texts.is_empty());
        let is_of_table = has_names && name == keys::REPORT_PART.any.name();
        let written = spec.get(key).filter(|_| spec.is_set(key) || (column.is_none() && !is_of_table));
        Some((name.to_owned(), written.or_else(|| column.map(Detail::shown))?))
    };
    keys::REPORT_KEYS.into_iter().filter_map(detail).collect()
}

/// The measured values of a part, and how far they are inside their limits.
pub(super) fn measured_blocks(part: &Part) -> Vec<Block> {
    let result = parts_blocks(&[Part { errors: Vec::new(), ..part.clone() }], "part");
    let result = result.into_iter().chain(yokes_block(std::slice::from_ref(part), "yoke of part"));
    part_block(part).into_iter().chain(result).chain(part.reason.clone().map(Block::Note)).collect()
}

/// The outcome of the parts of all tables.
pub(super) struct Lot {
    /// The spec, completed by the first table.
    pub(super) spec: Arc<Spec>,
    /// What is computed of each; `None` for parts with their teeth.
    pub(super) plan: Option<Plan>,
    pub(super) outcome: Outcome,
    pub(super) basis: Basis,
    /// Every part, if they are to be listed.
    pub(super) parts: Vec<Part>,
    pub(super) charts: Vec<Chart>,
    pub(super) small_charts: Vec<Chart>,
    /// The results that do not vary.
    pub(super) level: Vec<String>,
    pub(super) facts: Vec<(String, String)>,
}
