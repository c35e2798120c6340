//! The results of the rows of a block, column by column; [`verdicts`] compares them with the limits. The evaluator of blocks
//! calls it; `eval` combines and judges by the same functions.

mod verdicts;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::layout::Layout;
use super::meshed::{MeshAnswer, Meshed, Meshes};
use super::output::{End, Output, UncertainOutput};
use super::plan::Plan;
use super::source::{KINDS, index_of};
use super::uncertain::RowUncertainty;
use crate::deviation::{DeviationKind, DeviationValues};
use crate::function::JudgedYoke;
use crate::judge::bound::{ChangingErrors, ErrorRange, ExtendedError, GivenGeometry, NoBound, Range};
use crate::judge::reached::{self, Reached};
use crate::judge::{Interval, LimitTarget, Stack, Verdict};
use crate::quantity::{DomainError, Length, QuantityError};
use crate::table::{Block, Fault};
use crate::trig;
use crate::uncertainty::{Spread, Spreads};
pub(super) use verdicts::Margin;

/// The results of the rows of a block.
pub(super) struct Results<'a> {
    plan: &'a Plan,
    layout: &'a Layout,
    /// Ends the run: slow rows, and all rows behind them, are then left out.
    stop: &'a AtomicBool,
    /// How many rows there are.
    rows: usize,
    /// Why rows make no part, by row; nothing else of such a row counts.
    pub(super) refusals: BTreeMap<usize, Box<Fault>>,
    /// ΔCD of each kind of error, by its number.
    each: [Vec<Length>; KINDS],
    /// The range of each error alone, where it has a limit.
    alone: [Vec<Option<Interval>>; KINDS],
    /// The joint range of all errors, by the number of the combination.
    combined: [Ranges; Stack::ALL.len()],
    /// The worst case of parts without anything that scatters, where the statistical sum is asked for.
    unscattered: BTreeMap<usize, Interval>,
    reached: Vec<Option<Interval>>,
    /// The uncertainty of each part, if it is computed.
    uncertainties: Vec<Option<RowUncertainty>>,
    /// The parts that the exact mesh judges, by row.
    meshed: BTreeMap<usize, MeshAnswer>,
    /// The yoke's figures of each part, if they are asked for.
    yokes: Vec<Option<Arc<JudgedYoke>>>,
    /// The rows of parts that their status rejects and that break no limit on ΔCD.
    by_status: Vec<usize>,
    /// The verdict on the errors of each part, where there are limits on a yoke, too.
    of_errors: Vec<Option<Verdict>>,
    /// The verdict on each part; `None` if a limit could not be judged.
    pub(super) verdicts: Vec<Option<Verdict>>,
}

/// The fault of a row, in `column` if one is to blame.
fn fault(column: Option<usize>, message: String) -> Fault {
    Fault { row: 0, column, is_missing: false, text: String::new(), message }
}

/// The fault of a result of a row: `what`, in the column to blame, if there is one.
#[cold]
fn no_result(what: &str, column: Option<usize>, problem: impl Into<DomainError>) -> Fault {
    fault(column, format!("{what}: {}", problem.into()))
}

/// The values of an error as the bound takes them, mm or rad.
fn plain_values(values: &DeviationValues) -> Vec<f64> {
    match values {
        DeviationValues::Lengths(lengths) => lengths.iter().map(|length| length.mm()).collect(),
        DeviationValues::Angles(angles) => angles.iter().map(|angle| angle.radians()).collect(),
        DeviationValues::Slopes(slopes) => slopes.iter().map(|slope| trig::atan(*slope)).collect(),
    }
}

/// The nearest decimals of a range; `None` for an open one.
#[inline]
fn nearest(range: Result<Range, NoBound>) -> Result<Option<Interval>, QuantityError> {
    let Ok(range) = range else { return Ok(None) };
    Interval::nearest(range).map(Some)
}

impl<'a> Results<'a> {
    /// The results of the deviations, a column per source of the plan, without rows that are refused already. Ranges without a
    /// bound are left out. In strict mode nothing behind the first refused row counts.
    pub(super) fn new(
        plan: &'a Plan,
        layout: &'a Layout,
        block: &Block,
        deviations: &[Cow<'_, DeviationValues>],
        errors: &ChangingErrors<'_>,
        meshes: &mut Meshes<'a>,
    ) -> Self {
        let mut results = Self {
            plan,
            layout,
            stop: meshes.stop,
            rows: block.rows(),
            // of several faults of a row the first counts
            refusals: block.faults().iter().rev().map(|fault| (fault.row, Box::new(fault.clone()))).collect(),
            each: Default::default(),
            alone: Default::default(),
            combined: Default::default(),
            unscattered: BTreeMap::new(),
            reached: Vec::new(),
            uncertainties: Vec::new(),
            meshed: BTreeMap::new(),
            yokes: Vec::new(),
            by_status: Vec::new(),
            of_errors: Vec::new(),
            verdicts: Vec::new(),
        };
        let values: Vec<_> = deviations.iter().map(|deviations| plain_values(deviations)).collect();
        for (index, (deviations, values)) in deviations.iter().zip(&values).enumerate() {
            results.take_error(index, deviations, values);
        }
        results.take_sums(&values, errors);
        if let Some(uncertain) = &plan.uncertain {
            results.uncertainties = results.by_slow_row(|results, row| {
                let deviations: Vec<_> = deviations.iter().map(|column| column.at(row)).collect();
                let delta_cd = |kind: DeviationKind| results.each[kind as usize].get(row).copied().unwrap_or_default();
                let known = uncertain.of_row(&plan.sources, &deviations, delta_cd, &plan.limits);
                known.map(Some).map_err(|error| Box::new(fault(None, error.to_string())))
            });
        }
        results.judge(|results, verdicts, limit| results.judge_by_mesh(verdicts, limit, deviations, meshes));
        for row in block.failed.iter().filter(|row| !results.refusals.contains_key(row)) {
            let Some(verdict) = results.verdicts.get_mut(*row) else { continue };
            if verdict.replace(Verdict::Fail) != Some(Verdict::Fail) {
                results.by_status.push(*row);
            }
        }
        if let Some(yoke) = &plan.yoke {
            results.take_yokes(yoke, deviations, meshes);
        }
        if let Some((first, _)) = results.refusals.first_key_value().filter(|_| plan.request.strict) {
            results.cut(first + 1);
        }
        results
    }

    /// The rows that are parts: those between two that are refused.
    pub(super) fn runs(&self) -> impl Iterator<Item = ops::Range<usize>> {
        let mut next = 0;
        self.refusals.keys().copied().chain([self.rows]).map(move |end| std::mem::replace(&mut next, end + 1)..end)
    }

    /// The results of rows. A refused row has none; a row with an error is refused.
    fn by_row<T: Default>(&mut self, mut of: impl FnMut(&Self, usize) -> Result<T, Box<Fault>>) -> Vec<T> {
        let (mut column, mut refused) = (Vec::with_capacity(self.rows), Vec::new());
        for rows in self.runs() {
            column.resize_with(rows.start, T::default);
            column.extend(rows.map(|row| {
                of(self, row).unwrap_or_else(|reason| {
                    refused.push((row, reason));
                    T::default()
                })
            }));
        }
        self.refusals.extend(refused);
        column
    }

    /// The results of slow rows: rows for which a signal leaves no time, and all behind them, do not count.
    fn by_slow_row<T: Default>(&mut self, mut of: impl FnMut(&Self, usize) -> Result<T, Box<Fault>>) -> Vec<T> {
        let mut end = self.rows;
        let column = self.by_row(|results, row| {
            if row >= end || results.stop.load(Ordering::Relaxed) {
                end = end.min(row);
                return Ok(T::default());
            }
            of(results, row)
        });
        self.cut(end);
        column
    }

    /// Leaves out the rows behind the first so many.
    fn cut(&mut self, rows: usize) {
        self.rows = rows;
        self.refusals.split_off(&rows);
    }

    /// ΔCD of an error, and its range alone if that has a limit.
    fn take_error(&mut self, index: usize, deviations: &DeviationValues, values: &[f64]) {
        let plan = self.plan;
        let (source, column) = (&plan.sources[index], self.layout.columns[index]);
        let kind = source.law.kind();
        self.each[kind as usize] = source.law.delta_cds(deviations, plan.request.model).unwrap_or_else(|| {
            self.by_row(|_, row| {
                let delta_cd = source.law.delta_cd(deviations.at(row), plan.request.model);
                delta_cd.map_err(|problem| Box::new(no_result(kind.name(), column, problem)))
            })
        });
        if source.is_limited {
            self.alone[kind as usize] = self.by_row(|_, row| {
                let error = source.extended.with_value(values[row]);
                let range = nearest(plan.basis.alone(&error).map(ErrorRange::alone));
                range.map_err(|problem| Box::new(no_result(kind.name(), column, problem)))
            });
        }
    }

    /// The joint range of all errors; `values` has a column per error, mm or rad.
    fn take_sums(&mut self, values: &[Vec<f64>], errors: &ChangingErrors<'_>) {
        let plan = self.plan;
        // what cannot scatter has no statistical sum
        let needs_rss = plan.needs_rss && plan.sources.iter().any(|source| source.scatters);
        if plan.needs_range || needs_rss {
            let mut refused = Vec::new();
            let mut nearest = |row: usize, range: Result<Range, NoBound>| {
                nearest(range).unwrap_or_else(|problem| {
                    refused.push((row, problem));
                    None
                })
            };
            let [mut range, mut rss] =
                [plan.needs_range, needs_rss].map(|is_needed| Ranges::with_room(if is_needed { self.rows } else { 0 }));
            let mut unscattered = BTreeMap::new();
            errors.each_together(self.rows, values, |row, together| {
                if plan.needs_range {
                    range.push(nearest(row, together.range));
                }
                if needs_rss {
                    rss.push(nearest(row, together.rss));
                }
                if plan.request.stack == Stack::Rss && together.rss == Err(NoBound::NothingScatters) {
                    unscattered.extend(nearest(row, together.range).map(|worst| (row, worst)));
                }
            });
            self.combined = [range, rss];
            self.unscattered = unscattered;
            for (row, problem) in refused {
                self.refusals.entry(row).or_insert_with(|| Box::new(no_result("combination", None, problem)));
            }
        }
        if plan.needs_reached {
            let errors = |row: usize| errors.with(values.iter().map(|column| column[row]));
            self.reached = self.by_slow_row(|_, row| Ok(reached(plan, &errors(row))));
        }
    }

    /// The uncertainties of a part, if they are known.
    pub(super) fn uncertainty(&self, row: usize) -> Option<&RowUncertainty> {
        self.uncertainties.get(row)?.as_ref()
    }

    /// The uncertainties of all parts, where they are known.
    pub(super) fn uncertainties(&self) -> impl Iterator<Item = &RowUncertainty> {
        self.runs().flatten().filter_map(|row| self.uncertainty(row))
    }

    /// The yoke's figures of a part, if they are asked for.
    pub(super) fn yoke(&self, row: usize) -> Option<&Arc<JudgedYoke>> {
        self.yokes.get(row)?.as_ref()
    }

    /// The exact mesh of a part, or why it has no answer; `None` for a part that it does not judge.
    pub(super) fn meshed(&self, row: usize) -> Option<Result<&Meshed, &str>> {
        self.meshed.get(&row).map(|answer| answer.as_ref().as_ref().map_err(String::as_str))
    }

    /// The results of an output that is a length, of all parts that have one.
    pub(super) fn all_of(&self, output: &Output) -> Cow<'_, [Length]> {
        if let (true, Lengths::Each(all)) = (self.refusals.is_empty(), self.lengths(output, &(0..self.rows))) {
            return all;
        }
        let mut all = Vec::with_capacity(self.rows);
        for rows in self.runs() {
            self.each_of(output, &rows, |length| all.extend(length));
        }
        all.into()
    }

    /// The results of an output in some rows, if it is a length.
    pub(super) fn lengths(&self, output: &Output, rows: &ops::Range<usize>) -> Lengths<'_> {
        match output {
            Output::Error(kind) => {
                self.each[*kind as usize].get(rows.clone()).map_or(Lengths::None, |each| Lengths::Each(each.into()))
            }
            Output::Combined(stack, end) => self.combined[*stack as usize].lengths(*end, rows),
            Output::Margin if let Some(margins) = self.margins(rows) => Lengths::Each(margins.into()),
            Output::Judged(_) | Output::Margin => {
                let each: Option<Vec<_>> = rows.clone().map(|row| self.of(output, row)).collect();
                each.map_or(Lengths::Other, |each| Lengths::Each(each.into()))
            }
            _ => Lengths::Other,
        }
    }

    /// Calls `take` with the result of an output in each of some rows, if the output is a length, and returns whether it is.
    #[inline]
    pub(super) fn each_of(
        &self,
        output: &Output,
        rows: &ops::Range<usize>,
        mut take: impl FnMut(Option<Length>),
    ) -> bool {
        match (self.lengths(output, rows), output) {
            (Lengths::Each(lengths), _) => lengths.iter().for_each(|length| take(Some(*length))),
            (Lengths::None, _) => rows.clone().for_each(|_| take(None)),
            (_, Output::Combined(..) | Output::Judged(_) | Output::Margin | Output::Reached(_)) => {
                rows.clone().for_each(|row| take(self.of(output, row)));
            }
            _ => return false,
        }
        true
    }

    /// The result of an output that is a length; `None` if there is none.
    #[inline]
    pub(super) fn of(&self, output: &Output, row: usize) -> Option<Length> {
        match output {
            Output::Error(kind) => self.each[*kind as usize].get(row).copied(),
            Output::Combined(stack, end) => Some(end.of(self.combined[*stack as usize].at(row)?)),
            Output::Reached(end) => Some(end.of(at(&self.reached, row)?)),
            Output::Judged(end) => Some(end.of(self.judged(LimitTarget::CenterDistance, row)?)),
            Output::Margin => self.verdicts[row].and_then(|_| self.inside_by(row)),
            _ => None,
        }
    }
}

/// Ranges by row, one of the ends behind the other: most rows have one.
#[derive(Default)]
struct Ranges {
    lower: Vec<Length>,
    upper: Vec<Length>,
    /// The rows without a range.
    open: Vec<usize>,
}

impl Ranges {
    fn with_room(rows: usize) -> Self {
        Self { lower: Vec::with_capacity(rows), upper: Vec::with_capacity(rows), open: Vec::new() }
    }

    #[inline]
    fn push(&mut self, range: Option<Interval>) {
        if range.is_none() {
            self.open.push(self.lower.len());
        }
        let Interval { lower, upper } = range.unwrap_or_default();
        self.lower.push(lower);
        self.upper.push(upper);
    }

    /// The range of a row, which may not be computed.
    #[inline]
    fn at(&self, row: usize) -> Option<Interval> {
        let (lower, upper) = (*self.lower.get(row)?, *self.upper.get(row)?);
        let is_open = !self.open.is_empty() && self.open.binary_search(&row).is_ok();
        (!is_open).then_some(Interval { lower, upper })
    }

    /// The ends of the ranges of some rows, if all have one.
    fn all(&self, rows: &ops::Range<usize>) -> Option<impl Iterator<Item = (&Length, &Length)>> {
        let (lower, upper) = (self.lower.get(rows.clone())?, self.upper.get(rows.clone())?);
        self.open.is_empty().then(|| lower.iter().zip(upper))
    }

    fn lengths(&self, end: End, rows: &ops::Range<usize>) -> Lengths<'_> {
        let ends = if end == End::Lower { &self.lower } else { &self.upper };
        match ends.get(rows.clone()) {
            None => Lengths::None,
            Some(_) if !self.open.is_empty() => Lengths::Other,
            Some(ends) => Lengths::Each(ends.into()),
        }
    }
}

/// The results of an output in some rows.
pub(super) enum Lengths<'r> {
    /// Each row has a length.
    Each(Cow<'r, [Length]>),
    /// No row has one.
    None,
    /// Some have one, or the output is no length.
    Other,
}

/// A row of a column, which may not be computed.
#[inline]
fn at(column: &[Option<Interval>], row: usize) -> Option<Interval> {
    *column.get(row)?
}

/// The range that the exact mesh reaches with the errors on the worst teeth found; `None` where it has no solution.
fn reached(plan: &Plan, errors: &[ExtendedError]) -> Option<Interval> {
    let GivenGeometry::Known(pairs) = &plan.basis.geometry else { return None };
    let Reached { lower_mm, upper_mm, .. } = reached::reached(errors, pairs.given()).ok()??;
    Interval::nearest(Range { lower: lower_mm, upper: upper_mm }).ok()
}

/// The uncertainty of a result; `None` where no bound is known within it.
pub(super) fn spread_of<'s>(plan: &Plan, spreads: &'s Spreads, of: UncertainOutput) -> Option<&'s Spread> {
    let spread = match of {
        UncertainOutput::Error(kind) => &spreads.errors[index_of(&plan.sources, kind)?],
        UncertainOutput::Combined(End::Lower) => &spreads.lower,
        UncertainOutput::Combined(End::Upper) => &spreads.upper,
    };
    spread.standard_mm.is_finite().then_some(spread)
}
