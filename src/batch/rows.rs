//! The row that is written for a part, as text or in columns. Called by the row evaluator; computes nothing.

use super::columns::ResultCell;
use super::evaluate::{Evaluator, Row};
use super::output::Output;
use super::request::RowFormat;
use super::results::{Results, spread_of};
use super::uncertain::RowUncertainty;
use super::write;
use crate::judge::Verdict;

/// What came of a row.
pub(super) enum Written<'a> {
    /// A part with its results.
    Part { results: &'a Results, uncertainty: Option<&'a RowUncertainty>, verdict: Option<Verdict> },
    /// No results, and why.
    None { reason: &'a str },
}

impl Evaluator<'_> {
    /// Writes the row.
    #[inline]
    pub(super) fn write_row(&mut self, row: Option<Row<'_>>, written: &Written<'_>) {
        let plan = self.plan;
        if plan.format == RowFormat::Columns {
            let cells = (0..plan.outputs.len()).map(|index| cell(plan, index, row, written));
            return self.columns.push(cells, plan.decimals);
        }
        self.out.room(plan.row_room);
        for (index, (output, start)) in plan.outputs.iter().zip(&plan.json_names).enumerate() {
            write::start(&mut self.out, index, start, plan.format);
            match (written, plan.places) {
                // a quarter of the time of a table is writing its lengths
                (Written::Part { results, .. }, Some(places)) if let Some(length) = results.of(output) => {
                    places.write(&mut self.out, length);
                }
                _ => {
                    write::cell(&mut self.out, &cell(plan, index, row, written), plan.format, plan.decimals);
                    self.out.room(plan.row_room);
                }
            }
        }
        write::end(&mut self.out, plan.format);
    }
}

/// What stands in the output with that index; without a row, only the reason.
#[inline]
fn cell<'a>(plan: &'a super::Plan, index: usize, row: Option<Row<'a>>, written: &Written<'a>) -> ResultCell<'a> {
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
        (Output::Reason, Written::None { reason }) => text(reason),
        (Output::Reason, Written::Part { verdict: None, .. }) => text(&plan.without_verdict),
        (_, Written::None { .. }) | (Output::Reason, _) => ResultCell::Nothing,
        (Output::Without, _) => text(&plan.without),
        (Output::Verdict, Written::Part { verdict, .. }) => {
            verdict.map_or(ResultCell::Nothing, |verdict| text(verdict.name()))
        }
        (output, Written::Part { results, uncertainty, .. }) if output.is_uncertain() => {
            uncertainty.and_then(|known| uncertain(plan, output, results, known)).unwrap_or(ResultCell::Nothing)
        }
        (output, Written::Part { results, .. }) => results.of(output).map_or(ResultCell::Nothing, ResultCell::Length),
    }
}

/// What stands in an output that takes the uncertainties; `None` where there is none.
#[inline(never)]
fn uncertain(
    plan: &super::Plan,
    output: &Output,
    results: &Results,
    known: &RowUncertainty,
) -> Option<ResultCell<'static>> {
    Some(match output {
        Output::Standard(of) => ResultCell::Number(spread_of(&known.spreads, *of).standard_mm),
        Output::Expanded(of) => {
            let spread = spread_of(&known.spreads, *of);
            ResultCell::Number(spread.coverage_factor * spread.standard_mm)
        }
        Output::Conformance(limit) => {
            ResultCell::Number(known.inside(*limit).or_else(|| results.conformance(plan, &known.spreads, *limit))?)
        }
        Output::Simulated(of, statistic) => ResultCell::Number(statistic.of(known.simulation_of(*of)?)),
        Output::Validated => ResultCell::Flag(known.validated?),
        _ => ResultCell::Flag(!known.spreads.upper.folded),
    })
}
