//! The row that is written for a part, as text or in columns. Called by the evaluator; computes nothing.

use std::borrow::Cow;
use std::sync::Arc;

use super::columns::{ResultCell, ResultColumns};
use super::outcome::RowPlace;
use super::output::{Output, simulated};
use super::plan::Plan;
use super::request::{Request, RowFormat};
use super::results::{Results, spread_of};
use super::write;
use crate::table::Block;

/// What came of a row.
pub(super) enum WrittenRow<'a> {
    /// A part with its row of the results.
    Part { results: &'a Results<'a>, row: usize },
    /// No results, and why.
    None { reason: &'a str },
}

/// A row of a block.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    pub(super) block: &'a Block,
    pub(super) index: usize,
    /// Records before the block.
    pub(super) records_before: u64,
}

impl<'a> Row<'a> {
    /// The part's name, or the number of its record.
    pub(super) fn id(self) -> Cow<'a, str> {
        let number = || (self.records_before + self.record()).to_string().into();
        self.block.name(self.index).unwrap_or_else(number)
    }

    /// Its record, from the start of the block.
    pub(super) fn record(self) -> u64 {
        self.block.records[self.index]
    }

    /// Where it is; its record counts from the start of the block.
    pub(super) fn place(self, file: &Arc<str>) -> RowPlace {
        RowPlace { file: Arc::clone(file), line: self.block.lines[self.index], record: self.record(), in_words: None }
    }
}

/// The rows of a block as they are written: as text, or in columns.
pub(super) struct RowWriter<'a> {
    plan: &'a Plan,
    pub(super) out: Vec<u8>,
    pub(super) columns: ResultColumns,
}

impl<'a> RowWriter<'a> {
    pub(super) fn new(plan: &'a Plan) -> Self {
        Self { plan, out: Vec::new(), columns: ResultColumns::default() }
    }

    /// Forgets what was written.
    pub(super) fn clear(&mut self) {
        self.out.clear();
        if self.plan.request.format == RowFormat::Columns {
            self.columns = ResultColumns::new(self.plan.column_kinds());
        }
    }

    /// Writes a row.
    #[inline]
    pub(super) fn row(&mut self, row: Option<Row<'_>>, written: &WrittenRow<'_>) {
        let plan = self.plan;
        let Request { format, decimals, .. } = plan.request;
        if format == RowFormat::Columns {
            let cells = (0..plan.outputs.len()).map(|index| cell(plan, index, row, written));
            return self.columns.push(cells, decimals);
        }
        for (index, (output, start)) in plan.outputs.iter().zip(&plan.json_names).enumerate() {
            write::start(&mut self.out, index, start, format);
            match (written, plan.places) {
                // a quarter of the time of a table is writing its lengths
                (WrittenRow::Part { results, row }, Some(places)) if let Some(length) = results.of(output, *row) => {
                    places.write(&mut self.out, length);
                }
                _ => write::cell(&mut self.out, &cell(plan, index, row, written), format, decimals),
            }
        }
        write::end(&mut self.out, format);
    }
}

/// What stands in the output with that index; without a row, only the reason.
#[expect(
    clippy::inline_always,
    reason = "the value is taken apart where it is made: with `write::cell`, a tenth of the time of a table"
)]
#[inline(always)]
fn cell<'a>(plan: &'a Plan, index: usize, row: Option<Row<'a>>, written: &WrittenRow<'a>) -> ResultCell<'a> {
    let text = |text: &'a str| ResultCell::Text(text.as_bytes().into());
    match (&plan.outputs[index], written) {
        (Output::Id, _) => row.map_or(ResultCell::Nothing, |row| {
            ResultCell::Text(match row.block.name_bytes(row.index) {
                Some(name) => name.into(),
                None => row.id().into_owned().into_bytes().into(),
            })
        }),
        (Output::Copied(_), _) => {
            let Some(row) = row else { return ResultCell::Nothing };
            let is_copied = |output: &&Output| matches!(output, Output::Copied(_));
            let number = plan.outputs[..index].iter().filter(is_copied).count();
            ResultCell::Text(row.block.copied(row.index, number).unwrap_or_default().into())
        }
        (Output::Reason, WrittenRow::None { reason }) => text(reason),
        (Output::Reason, WrittenRow::Part { results, row }) => match results.reason(*row) {
            Some(Cow::Borrowed(reason)) => text(reason),
            Some(Cow::Owned(reason)) => ResultCell::Text(reason.into_bytes().into()),
            None => ResultCell::Nothing,
        },
        (Output::NearestLimit, WrittenRow::Part { results, row }) => {
            results.nearest(*row).map_or(ResultCell::Nothing, |(on, end)| {
                ResultCell::Text(format!("{}.{}", on.key(), end.name()).into_bytes().into())
            })
        }
        (_, WrittenRow::None { .. }) => ResultCell::Nothing,
        (Output::Without, _) => text(&plan.without),
        (Output::Verdict, WrittenRow::Part { results, row }) => {
            results.verdicts[*row].map_or(ResultCell::Nothing, |verdict| text(verdict.name()))
        }
        (output, WrittenRow::Part { results, row }) if output.is_uncertain() => {
            uncertain(plan, output, results, *row).unwrap_or(ResultCell::Nothing)
        }
        (output, WrittenRow::Part { results, row }) => {
            results.of(output, *row).map_or(ResultCell::Nothing, ResultCell::Length)
        }
    }
}

/// What stands in an output that takes the uncertainties; `None` where there is none.
#[inline(never)]
fn uncertain(plan: &Plan, output: &Output, results: &Results<'_>, row: usize) -> Option<ResultCell<'static>> {
    let known = results.uncertainty(row)?;
    Some(match output {
        Output::Standard(of) => {
            let spread = spread_of(plan, &known.spreads, *of)?;
            ResultCell::Number(spread.dof.map(|_| spread.standard_mm)?)
        }
        Output::Expanded(of) => {
            let spread = spread_of(plan, &known.spreads, *of)?;
            ResultCell::Number(spread.coverage_factor? * spread.standard_mm)
        }
        Output::Conformance(on) => ResultCell::Number(results.conformance(known, *on, row)?),
        Output::Simulated(of, statistic) => {
            ResultCell::Number(simulated(known.simulation_of(&plan.sources, *of)?, *statistic))
        }
        Output::Validated => ResultCell::Flag(known.validated?),
        _ => ResultCell::Flag(known.spreads.upper.folds == Some(0)),
    })
}
