//! The pictures of a batch: how its results are distributed, and how they run in the order of the rows. Called by the
//! page of `report`.

use std::io;

use super::chart::{Axis, Bar, Chart, Layer, Scale, Shape, Span};
use super::number::{SEEN_MM, millimetres};
use super::rows::result_in_words;
use crate::batch::{ColumnSink, Outcome, Plan, Quantity, ResultColumn, ResultColumns, ResultValues, Statistics};
use crate::judge::{LimitTarget, Limits};
use crate::quantity::Length;

/// The spread of results: in pictures where they vary, in a sentence where they do not.
#[derive(Debug, Default)]
pub struct Histograms {
    /// The picture of the judged end that is nearer to its limit.
    pub judged: Option<Chart>,
    /// Small pictures of ΔCD of each error.
    pub errors: Vec<Chart>,
    /// Results that are equal for all parts.
    pub level: Vec<String>,
}

impl Histograms {
    /// The spread of a batch's results.
    #[must_use]
    pub fn of(outcome: &Outcome) -> Self {
        let mut all = Self::default();
        let room = |quantity: &&Quantity| {
            let ((lower, upper), statistics) = (quantity.own_limits(), &quantity.statistics);
            let below = statistics.min_mm().zip(lower).map(|(min, lower)| min - lower);
            let above = statistics.max_mm().zip(upper).map(|(max, upper)| upper - max);
            below.into_iter().chain(above).fold(f64::INFINITY, f64::min)
        };
        let judged = outcome.quantities.iter().filter(|quantity| quantity.on == Some(LimitTarget::CenterDistance));
        if let Some(quantity) = judged.rev().min_by(|one, other| room(one).total_cmp(&room(other))) {
            all.judged = histogram(quantity, &mut all.level);
        }
        let is_error = |quantity: &&Quantity| matches!(quantity.on, Some(LimitTarget::Error(_)));
        for quantity in outcome.quantities.iter().filter(is_error) {
            let chart = histogram(quantity, &mut all.level);
            all.errors.extend(chart.map(|chart| Chart { width: 420.0, height: 300.0, ..chart }));
        }
        all
    }
}

/// The number of bars for values from the least to the largest, by the width of Freedman and Diaconis, 2 IQR / ∛n.
fn bins(statistics: &Statistics, reach: f64) -> usize {
    const MOST: f64 = 40.0;
    let (count, quarters) = (statistics.count() as f64, [0.25, 0.75].map(|share| statistics.quantile_mm(share)));
    let middle = quarters[1].zip(quarters[0]).map_or(0.0, |(upper, lower)| upper - lower);
    // by Sturges where half of the values are equal
    let bins = if middle > 0.0 { reach / (2.0 * middle) * libm::cbrt(count) } else { 1.0 + libm::log2(count) };
    bins.ceil().clamp(1.0, MOST) as usize
}

/// A picture of a result that varies, else a sentence.
fn histogram(Quantity { name, on, limits, statistics, .. }: &Quantity, level: &mut Vec<String>) -> Option<Chart> {
    let of = if matches!(on, Some(LimitTarget::Error(_))) { "ΔCD of " } else { "" };
    let title = format!("{of}{}", result_in_words(name));
    let (low, high) = (statistics.min_mm()?, statistics.max_mm()?);
    if high - low < SEEN_MM {
        level.push(format!("{title}: {} mm in every part.", millimetres(low)));
        return None;
    }
    let (high, bins) = (high.next_up(), bins(statistics, high - low));
    let counts = statistics.histogram(low, high, bins);
    let edge = |bin: usize| low + (high - low) * bin as f64 / bins as f64;
    let bars = counts.into_iter().enumerate().map(|(bin, count)| Bar {
        left: edge(bin),
        right: edge(bin + 1),
        low: 0.0,
        high: count as f64,
        text: String::new(),
    });
    Some(Chart {
        title: format!("Histogram of {title}"),
        x: Axis { label: format!("{title} [mm]"), scale: Scale::Airy },
        y: Axis { label: "parts".to_owned(), scale: Scale::Whole },
        layers: vec![
            Layer::new("", Shape::Bars(bars.collect())),
            Layer::new("limits", Shape::LimitsOnX([limits.0, limits.1].into_iter().flatten().collect())),
        ],
        ..Chart::default()
    })
}

/// Takes the rows of a batch and keeps the lowest and highest result of each group of neighbours; groups grow with the
/// batch, so that memory does not.
#[derive(Debug, Default)]
pub struct RunChart {
    /// The columns of the lower and the upper end.
    ends: Option<[usize; 2]>,
    /// Rows per group.
    size: u64,
    /// In the last group.
    held: u64,
    groups: Vec<(f64, f64)>,
}

/// Groups at most: more than a picture shows.
const MOST_GROUPS: usize = 1024;

impl ColumnSink for RunChart {
    fn take(&mut self, rows: ResultColumns) -> io::Result<()> {
        let Some([lower, upper]) = self.ends else { return Ok(()) };
        let values = |column: usize| match &rows.columns[column] {
            column @ ResultColumn { values: ResultValues::Numbers(values), .. } => {
                values.iter().enumerate().map(|(row, value)| column.has_value(row).then_some(*value)).collect()
            }
            _ => Vec::new(),
        };
        for (low, high) in values(lower).into_iter().zip(values(upper)) {
            self.add(low.zip(high));
        }
        Ok(())
    }
}

impl RunChart {
    /// A chart of the worst case.
    #[must_use]
    pub fn of(plan: &Plan) -> Self {
        Self { ends: plan.range_columns(), ..Self::default() }
    }

    /// Adds a row: its ends, or `None` if it is no part.
    fn add(&mut self, ends: Option<(f64, f64)>) {
        self.size = self.size.max(1);
        if self.groups.is_empty() || self.held == self.size {
            if self.groups.len() == MOST_GROUPS {
                self.groups = self.groups.chunks(2).map(|pair| pair.iter().copied().fold(pair[0], joined)).collect();
                self.size *= 2;
            }
            self.groups.push((f64::INFINITY, f64::NEG_INFINITY));
            self.held = 0;
        }
        self.held += 1;
        if let (Some(last), Some(ends)) = (self.groups.last_mut(), ends) {
            *last = joined(*last, ends);
        }
    }

    /// The picture, with the limits on ΔCD; `None` for a single part.
    #[must_use]
    pub fn chart(&self, limits: &Limits) -> Option<Chart> {
        let at = |index: usize| (index as u64 * self.size + 1) as f64;
        let groups = self.groups.iter().enumerate().filter(|(_, (low, high))| low <= high);
        let spans: Vec<_> = groups.map(|(index, (low, high))| Span { x: at(index), low: *low, high: *high }).collect();
        if spans.len() < 2 {
            return None;
        }
        let limit = limits.iter().find(|(target, _)| *target == LimitTarget::CenterDistance);
        let limits = limit.into_iter().flat_map(|(_, limit)| limit.ends()).map(Length::mm);
        let grouped = if self.size > 1 { format!("; each point holds {} rows", self.size) } else { String::new() };
        Some(Chart {
            title: format!("Run chart: ΔCD in the order of the rows{grouped}"),
            x: Axis { label: "row".to_owned(), scale: Scale::Whole },
            y: Axis { label: "ΔCD [mm]".to_owned(), scale: Scale::Airy },
            layers: vec![
                Layer::new("lowest to highest", Shape::Band(spans.clone())),
                Layer::new("highest", Shape::Line(spans.iter().map(|span| (span.x, span.high)).collect())),
                Layer::new("limits", Shape::Limits(limits.collect())),
            ],
            ..Chart::default()
        })
    }
}

fn joined(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.min(b.0), a.1.max(b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_chart_keeps_every_extreme_in_little_memory() {
        let mut run = RunChart::default();
        for part in 0..50_000 {
            run.add(Some((-0.1, if part == 31_415 { 0.9 } else { 0.1 })));
        }
        assert!(run.groups.len() <= MOST_GROUPS);
        assert_eq!(run.size, 64);
        let group = 31_415 / 64;
        assert_eq!(run.groups[group], (-0.1, 0.9));
        assert_eq!(run.groups.iter().filter(|group| group.1 > 0.5).count(), 1);
    }

    #[test]
    fn a_run_chart_counts_rows_that_are_no_part() {
        let mut run = RunChart::default();
        for row in [Some((0.0, 0.1)), None, Some((0.0, 0.2))] {
            run.add(row);
        }
        let Some(Layer { shape: Shape::Band(spans), .. }) = run.chart(&Vec::new()).map(|chart| chart.layers[0].clone())
        else {
            panic!("no picture")
        };
        assert_eq!(spans.iter().map(|span| span.x).collect::<Vec<_>>(), [1.0, 3.0]);
    }
}
