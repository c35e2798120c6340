//! The row of a part, as text or in columns. The evaluator calls it; it computes nothing.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use super::columns::{ResultCell, ResultColumns, append_text};
use super::outcome::RowPlace;
use super::output::{Output, simulated};
use super::plan::Plan;
use super::request::{Request, RowFormat};
use super::results::{Lengths, Results, spread_of};
use super::write;
use crate::function::FIGURES;
use crate::judge::Verdict;
use crate::quantity::{Length, Places, tidy, write_whole};
use crate::table::Block;

/// The outcome of a row.
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

    /// Appends the name, or the number.
    fn write_id(self, out: &mut Vec<u8>) {
        match self.block.name_bytes(self.index) {
            Some(name) => append_text(out, name),
            None => write_whole(out, self.records_before + self.record()),
        }
    }

    /// The row's record, from the start of the block.
    pub(super) fn record(self) -> u64 {
        self.block.records[self.index]
    }

    /// The row's place; its record counts from the start of the block.
    pub(super) fn place(self, file: &Arc<str>) -> RowPlace {
        RowPlace { file: Arc::clone(file), line: self.block.lines[self.index], record: self.record(), in_words: None }
    }
}

/// The rows of a block as they are written: as text, or in columns.
pub(super) struct RowWriter<'a> {
    plan: &'a Plan,
    pub(super) out: Vec<u8>,
    /// The rows of this block, behind those of earlier ones that nobody took.
    pub(super) columns: ResultColumns,
    /// How many rows these are.
    earlier: usize,
}

impl<'a> RowWriter<'a> {
    pub(super) fn new(plan: &'a Plan) -> Self {
        Self { plan, out: Vec::new(), columns: ResultColumns::default(), earlier: 0 }
    }

    /// Begins a block of so many rows; text of the last one is gone.
    pub(super) fn begin(&mut self, rows: usize) {
        self.out.clear();
        if self.plan.request.format == RowFormat::Columns && self.columns.columns.is_empty() {
            self.columns = ResultColumns::new(self.plan.column_kinds(), rows);
        }
        self.earlier = self.columns.rows;
    }

    /// How many rows of the block are written in columns.
    pub(super) fn rows(&self) -> usize {
        self.columns.rows - self.earlier
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
                (WrittenRow::Part { results, row }, Some(places)) if let Some(length) = results.of(output, *row) => {
                    places.write(&mut self.out, length);
                }
                _ => write::cell(&mut self.out, &cell(plan, index, row, written), format, decimals),
            }
        }
        write::end(&mut self.out, format);
    }

    /// Writes rows that are all parts; `first` is the first row of their block.
    pub(super) fn parts(&mut self, first: Row<'_>, results: &Results<'_>, rows: Range<usize>) {
        match (self.plan.request.format, self.plan.places) {
            (RowFormat::Columns, _) => self.parts_in_columns(first, results, &rows),
            (format, Some(places)) if let Some(separator) = format.separator() => {
                for strip in strips(&rows) {
                    self.strip(first, results, strip, (places, separator));
                }
            }
            _ => {
                for row in rows {
                    self.row(Some(Row { index: row, ..first }), &WrittenRow::Part { results, row });
                }
            }
        }
    }

    /// Some rows as text, the lengths of which are looked up column by column.
    fn strip(&mut self, first: Row<'_>, results: &Results<'_>, rows: Range<usize>, (places, separator): (Places, u8)) {
        let (plan, Request { format, decimals, .. }) = (self.plan, &self.plan.request);
        let width = plan.outputs.len();
        let mut lengths = vec![Length::ZERO; width * rows.len()];
        // whether an output is a length in each of these rows; no separator stands before the first
        let is_length = |lengths: &mut [Length], index: usize| {
            let (mut each, mut is_full) = (lengths[index..].iter_mut().step_by(width), index > 0);
            let is_length = results.each_of(&plan.outputs[index], &rows, |length| match (each.next(), length) {
                (Some(place), Some(length)) => *place = length,
                _ => is_full = false,
            });
            is_length && is_full
        };
        let is_length: Vec<bool> = (0..width).map(|index| is_length(&mut lengths, index)).collect();
        let groups: Vec<Range<usize>> = groups(&is_length);
        for (at, row) in rows.enumerate() {
            let lengths = &lengths[at * width..][..width];
            for group in &groups {
                if is_length[group.start] {
                    places.write_each(&mut self.out, separator, &lengths[group.clone()]);
                    continue;
                }
                for index in group.clone() {
                    write::start(&mut self.out, index, b"", *format);
                    let written = WrittenRow::Part { results, row };
                    let cell = cell(plan, index, Some(Row { index: row, ..first }), &written);
                    write::cell(&mut self.out, &cell, *format, *decimals);
                }
            }
            write::end(&mut self.out, *format);
        }
    }

    fn parts_in_columns(&mut self, first: Row<'_>, results: &Results<'_>, rows: &Range<usize>) {
        let (plan, decimals) = (self.plan, self.plan.request.decimals);
        for (index, column) in self.columns.columns.iter_mut().enumerate() {
            let output = &plan.outputs[index];
            match results.lengths(output, rows) {
                Lengths::Each(lengths) => {
                    column.extend(&lengths, decimals);
                    continue;
                }
                Lengths::None => {
                    column.extend_without(rows.len());
                    continue;
                }
                Lengths::Other => {}
            }
            let each = rows.clone().map(|index| Row { index, ..first });
            match output {
                Output::Id => column.extend_texts(each, Row::write_id),
                Output::Verdict => {
                    let verdicts = &results.verdicts[rows.clone()];
                    for same in verdicts.chunk_by(PartialEq::eq) {
                        column.extend_words(same[0].map(Verdict::name), same.len());
                    }
                }
                Output::Reason => {
                    let mut start = rows.start;
                    for same in results.verdicts[rows.clone()].chunk_by(PartialEq::eq) {
                        let end = start + same.len();
                        if results.passes_silently(same[0]) {
                            column.extend_words(None, same.len());
                        } else {
                            (start..end).for_each(|row| column.extend_words(results.reason(row).as_deref(), 1));
                        }
                        start = end;
                    }
                }
                _ => each.for_each(|row| {
                    let written = WrittenRow::Part { results, row: row.index };
                    column.push(&cell(plan, index, Some(row), &written), decimals);
                }),
            }
        }
        self.columns.rows += rows.len();
    }
}

/// Rows whose lengths are looked up together.
const STRIP: usize = 128;

/// Rows in such strips.
fn strips(rows: &Range<usize>) -> impl Iterator<Item = Range<usize>> {
    rows.clone().step_by(STRIP).map(|start| start..rows.end.min(start + STRIP))
}

/// Runs of equal neighbours.
fn groups(all: &[bool]) -> Vec<Range<usize>> {
    let mut end = 0;
    all.chunk_by(bool::eq)
        .map(|same| {
            end += same.len();
            end - same.len()..end
        })
        .collect()
}

/// The cell of the output with that index; without results, only the reason.
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
        (Output::Yoke(_) | Output::OnYoke(_), WrittenRow::Part { results, row }) => {
            of_yoke(&plan.outputs[index], results, *row).unwrap_or(ResultCell::Nothing)
        }
        (output, WrittenRow::Part { results, row }) if output.is_uncertain() => {
            uncertain(plan, output, results, *row).unwrap_or(ResultCell::Nothing)
        }
        (output, WrittenRow::Part { results, row }) => {
            results.of(output, *row).map_or(ResultCell::Nothing, ResultCell::Length)
        }
    }
}

/// The cell of an output of a yoke; `None` where it is not known.
#[inline(never)]
fn of_yoke<'a>(output: &Output, results: &Results<'_>, row: usize) -> Option<ResultCell<'a>> {
    let yoke = results.yoke(row)?;
    match output {
        Output::Yoke(figure) => Some(ResultCell::Number(tidy(FIGURES[*figure].1(yoke)?))),
        Output::OnYoke(on) => Some(ResultCell::Text(yoke.verdict_on(*on)?.name().as_bytes().into())),
        _ => None,
    }
}

/// The cell of an output that needs the uncertainties; `None` where there are none.
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
        _ => ResultCell::Flag(known.spreads.upper.folds == Some(0) && known.spreads.upper.rivals == 0),
    })
}
