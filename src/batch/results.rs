//! The results of the rows of a block, column by column, and what they say about the limits. Called by the evaluator of
//! blocks; `eval` combines and judges by the same functions.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::layout::Layout;
use super::meshed::{MeshAnswer, Meshed, Meshes};
use super::output::{End, Output, UncertainOutput};
use super::plan::Plan;
use super::request::Request;
use super::source::{KINDS, index_of};
use super::uncertain::RowUncertainty;
use crate::deviation::{DeviationKind, DeviationValues};
use crate::evaluation::{JudgedBy, subject, too_near, worse};
use crate::function::{Check, Judged, JudgedYoke, YokeJudge};
use crate::judge::bound::{ChangingErrors, ErrorRange, ExtendedError, GivenGeometry, NoBound, Range};
use crate::judge::reached::{self, Reached};
use crate::judge::rule::{self, Conformance, Ends};
use crate::judge::{Interval, Limit, LimitTarget, NearestEnd, Stack, Verdict};
use crate::quantity::{DomainError, Length, QuantityError};
use crate::table::{Block, Fault};
use crate::trig;
use crate::uncertainty::{Spread, Spreads};

/// The results of the rows of a block.
pub(super) struct Results<'a> {
    plan: &'a Plan,
    layout: &'a Layout,
    /// Ends the run: rows that take long are then left out, with all behind them.
    stop: &'a AtomicBool,
    /// How many rows there are.
    rows: usize,
    /// Why rows make no part, by row; nothing else of such a row counts.
    pub(super) refusals: BTreeMap<usize, Box<Fault>>,
    /// ΔCD of each kind of error, by its number.
    each: [Vec<Length>; KINDS],
    /// What each can do alone, where that is held against a limit.
    alone: [Vec<Option<Interval>>; KINDS],
    /// What all do together, by the number of the combination.
    combined: [Vec<Option<Interval>>; Stack::ALL.len()],
    reached: Vec<Option<Interval>>,
    /// What is uncertain about each part, if that is computed.
    uncertainties: Vec<Option<RowUncertainty>>,
    /// The parts that the exact mesh judges, by row.
    meshed: BTreeMap<usize, MeshAnswer>,
    /// What the yoke does on each part, if that is asked.
    yokes: Vec<Option<Arc<JudgedYoke>>>,
    /// The verdict on the errors of each part, where there are limits on a yoke, too.
    of_errors: Vec<Option<Verdict>>,
    /// The verdict on each part; `None` if a limit could not be judged.
    pub(super) verdicts: Vec<Option<Verdict>>,
}

/// How far a part is inside the nearest limit, which that is, and what is held against it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Margin {
    pub(super) inside_by: Length,
    pub(super) on: Option<(LimitTarget, NearestEnd)>,
    pub(super) result: Interval,
}

/// What is wrong with a row; `column` is to blame, if one is.
fn fault(column: Option<usize>, message: String) -> Fault {
    Fault { row: 0, column, is_missing: false, text: String::new(), message }
}

/// What is wrong with what follows from the values of a row: `what`, of the column that is to blame, if one is.
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

/// The nearest decimals of a range; nothing of one that is open.
#[inline]
fn nearest(range: Result<Range, NoBound>) -> Result<Option<Interval>, QuantityError> {
    let Ok(range) = range else { return Ok(None) };
    Interval::nearest(range).map(Some)
}

impl<'a> Results<'a> {
    /// The results of the deviations, a column per source of the plan, but for rows that are refused already. What has no
    /// bound is left out. In strict mode nothing behind the first refused row counts.
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
            reached: Vec::new(),
            uncertainties: Vec::new(),
            meshed: BTreeMap::new(),
            yokes: Vec::new(),
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
            if let Some(verdict) = results.verdicts.get_mut(*row) {
                *verdict = Some(Verdict::Fail);
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

    /// What rows come to. One that is refused comes to nothing; one for which there is a reason is refused.
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

    /// The same of rows that take long: those that a signal leaves no time for, and all behind them, do not count.
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

    /// ΔCD of an error, and what the error can do alone if that has a limit.
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

    /// What all errors do together; `values` has a column per error, mm or rad.
    fn take_sums(&mut self, values: &[Vec<f64>], errors: &ChangingErrors<'_>) {
        let plan = self.plan;
        if plan.needs_range || plan.needs_rss {
            let mut refused = Vec::new();
            let mut end = |column: &mut Vec<_>, row: usize, range: Result<Range, NoBound>| {
                column.push(nearest(range).unwrap_or_else(|problem| {
                    refused.push((row, problem));
                    None
                }));
            };
            let [mut range, mut rss] = [(); 2].map(|()| Vec::with_capacity(self.rows));
            errors.each_together(self.rows, values, |row, together| {
                if plan.needs_range {
                    end(&mut range, row, together.range);
                }
                if plan.needs_rss {
                    end(&mut rss, row, together.rss);
                }
            });
            self.combined = [range, rss];
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

    /// The uncertainties of what is held against a limit, if they are known.
    #[inline]
    fn uncertainty_on(&self, on: LimitTarget, row: usize) -> Option<&RowUncertainty> {
        match self.meshed(row) {
            Some(Ok(meshed)) if on == LimitTarget::CenterDistance => meshed.uncertainty.as_ref(),
            _ => self.uncertainty(row),
        }
    }

    /// The uncertainties of all parts of which they are known.
    pub(super) fn uncertainties(&self) -> impl Iterator<Item = &RowUncertainty> {
        self.runs().flatten().filter_map(|row| self.uncertainty(row))
    }

    /// Judges the parts, those that the bound does not pass by `mesh`. Without limits, or with one that could not be judged, a
    /// verdict that is not fail is open.
    fn judge(&mut self, mut mesh: impl FnMut(&mut Self, &mut [Option<Verdict>], usize)) {
        let is_open = self.plan.limits.is_empty() || !self.plan.unjudged.is_empty();
        let mut verdicts = is_open.then(|| vec![None; self.rows]);
        for limit in 0..self.plan.limits.len() {
            let mut judged = self.by_row(|results, row| results.judge_by(limit, row));
            if self.plan.is_all_placed && self.plan.limits[limit].0 == LimitTarget::CenterDistance {
                mesh(self, &mut judged, limit);
            }
            verdicts = Some(match verdicts {
                None => judged,
                Some(before) => before.into_iter().zip(judged).map(|(one, other)| worse(one, other)).collect(),
            });
        }
        self.verdicts = verdicts.unwrap_or_default();
    }

    /// What the yoke does on each part, with the verdicts on it: by the mesh where nothing is left to place, by the bound elsewhere.
    #[cold]
    fn take_yokes(&mut self, yoke: &YokeJudge, deviations: &[Cow<'_, DeviationValues>], meshes: &mut Meshes<'_>) {
        let plan = self.plan;
        self.yokes = self.by_slow_row(|results, row| {
            Ok(Some(if !plan.lacking.is_empty() && !plan.is_partial() {
                let keys = plan.lacking.iter().map(|kind| kind.key()).collect();
                Arc::new(yoke.unknown(yoke.open(&Judged::Lacks(keys))))
            } else if plan.knows_teeth {
                let values: Vec<_> = deviations.iter().map(|column| column.at(row)).collect();
                meshes.yoke(plan, yoke, &values)
            } else {
                Arc::new(results.yoke_by_bound(yoke, row))
            }))
        });
        if yoke.limits.is_empty() {
            return;
        }
        self.of_errors.clone_from(&self.verdicts);
        for (row, yoke) in self.yokes.iter().enumerate() {
            let Some(yoke) = yoke else { continue };
            let checks = yoke.checks.iter().map(|check| check.verdict);
            let of_errors = self.asks_of_errors(row).then_some(self.of_errors[row]);
            self.verdicts[row] = of_errors.into_iter().chain(checks).reduce(worse).flatten();
        }
    }

    /// Whether something is asked of the errors of a part beside its yoke, or the table says that the part is rejected.
    fn asks_of_errors(&self, row: usize) -> bool {
        let has_limits = !(self.plan.limits.is_empty() && self.plan.unjudged.is_empty());
        has_limits || self.of_errors.get(row) == Some(&Some(Verdict::Fail))
    }

    /// The limits on a yoke by the worst case of a part; open where its pair is not known.
    fn yoke_by_bound(&self, yoke: &YokeJudge, row: usize) -> JudgedYoke {
        let range = at(&self.combined[Stack::Range as usize], row);
        match &self.plan.basis.geometry {
            GivenGeometry::Known(pairs) => {
                let width_mm = range.map(|range| (range.upper - range.lower).mm());
                yoke.within(&pairs.given().pair, width_mm)
            }
            GivenGeometry::Unknown | GivenGeometry::BothFlanks => yoke.unknown(yoke.open(&Judged::NotProven)),
        }
    }

    /// Whether a limit on the yoke is broken, and none on ΔCD.
    pub(super) fn fails_by_yoke(&self, row: usize) -> bool {
        self.verdicts[row] == Some(Verdict::Fail)
            && self.of_errors.get(row).is_some_and(|verdict| *verdict != Some(Verdict::Fail))
    }

    /// What the yoke does on a part, if that is asked.
    pub(super) fn yoke(&self, row: usize) -> Option<&Arc<JudgedYoke>> {
        self.yokes.get(row)?.as_ref()
    }

    /// Judges the parts that the bound does not pass by their exact mesh. Once the run is to stop, no part counts that is not
    /// meshed, nor any behind it.
    #[cold]
    fn judge_by_mesh(
        &mut self,
        verdicts: &mut [Option<Verdict>],
        limit: usize,
        deviations: &[Cow<'_, DeviationValues>],
        meshes: &mut Meshes<'_>,
    ) {
        let open: Vec<_> = self.runs().flatten().filter(|row| verdicts[*row] != Some(Verdict::Pass)).collect();
        for row in open {
            let values: Vec<_> = deviations.iter().map(|column| column.at(row)).collect();
            let Some(answer) = meshes.answer(self.plan, &values) else {
                return self.cut(row);
            };
            self.meshed.insert(row, answer);
            match self.judge_by(limit, row) {
                Ok(verdict) => verdicts[row] = verdict,
                Err(reason) => drop(self.refusals.insert(row, reason)),
            }
        }
    }

    /// What the exact mesh says of a part, or why it has no answer; `None` of a part that it does not judge.
    pub(super) fn meshed(&self, row: usize) -> Option<Result<&Meshed, &str>> {
        self.meshed.get(&row).map(|answer| answer.as_ref().as_ref().map_err(String::as_str))
    }

    /// Who judges the errors of a part together.
    pub(super) fn judged_by(&self, row: usize) -> JudgedBy {
        match (self.meshed(row), self.plan.request.stack) {
            (Some(Ok(_)), _) => JudgedBy::Mesh,
            (_, Stack::Rss) => JudgedBy::Statistical,
            (_, Stack::Range) => JudgedBy::Bound,
        }
    }

    /// Why a part fails, is indeterminate or has no verdict, and what the exact mesh says of one that it judges.
    pub(super) fn reason(&self, row: usize) -> Option<Cow<'_, str>> {
        let meshed = self.meshed(row).map(by_mesh);
        let checks = self.yoke(row).map_or(&[][..], |yoke| &yoke.checks);
        let own = if checks.is_empty() { &self.verdicts } else { &self.of_errors };
        let of_errors = (checks.is_empty() || self.asks_of_errors(row)).then(|| own[row]);
        let unless_pass = match of_errors {
            None | Some(Some(Verdict::Pass)) => None,
            Some(None) if checks.is_empty() => return Some(self.plan.without_verdict.as_str().into()),
            Some(None) => Some(self.plan.without_verdict.clone()),
            Some(Some(verdict)) => Some(self.not_passed(verdict, row)),
        };
        let of_yoke = checks.iter().filter_map(Check::reason);
        let said: Vec<_> = unless_pass.into_iter().chain(meshed).chain(of_yoke).collect();
        (!said.is_empty()).then(|| said.join("; ").into())
    }

    /// Why a part does not pass.
    #[cold]
    fn not_passed(&self, verdict: Verdict, row: usize) -> String {
        let Request { stack, rule, .. } = &self.plan.request;
        let limits = self.plan.limits.iter().enumerate();
        let judged = limits.filter(|(limit, _)| matches!(self.judge_by(*limit, row), Ok(Some(of)) if of == verdict));
        let why = judged.filter_map(|(_, (on, limit))| match verdict {
            Verdict::Fail => Some(format!("{} {}", subject(*on, *stack), limit.nearest(self.judged(*on, row)?)?)),
            _ => Some(too_near(*on, *stack, rule)),
        });
        let why = why.collect::<Vec<_>>().join("; ");
        if why.is_empty() { "the table says that the part is rejected".to_owned() } else { why }
    }

    /// The verdict on the limit with that index; `None` without a result.
    #[inline]
    fn judge_by(&self, index: usize, row: usize) -> Result<Option<Verdict>, Box<Fault>> {
        let plan = self.plan;
        let (on, limit) = &plan.limits[index];
        let Some(result) = self.judged(*on, row) else { return Ok(None) };
        let uncertainty = self.uncertainty_on(*on, row);
        let ends = uncertainty.and_then(|known| ends(plan, &known.spreads, *on, result));
        if ends.is_none() && plan.request.rule.needs_uncertainty() {
            return Ok(None);
        }
        let simulated = uncertainty.and_then(|known| known.inside(index));
        match rule::verdict(&plan.request.rule, limit, result, ends.as_ref(), simulated) {
            Ok((verdict, _)) => Ok(Some(verdict)),
            Err(error) => Err(Box::new(fault(None, error.to_string()))),
        }
    }

    /// The probability that a limit is met, simulated or by the linear uncertainties; `None` without a result.
    pub(super) fn conformance(&self, known: &RowUncertainty, on: LimitTarget, row: usize) -> Option<f64> {
        let plan = self.plan;
        let index = plan.limits.iter().position(|(other, _)| *other == on)?;
        let known = self.uncertainty_on(on, row).unwrap_or(known);
        let ends = self.judged(on, row).and_then(|result| ends(plan, &known.spreads, on, result));
        Some(Conformance::of(&plan.limits[index].1, ends.as_ref(), known.inside(index))?.probability)
    }

    /// How far a part is inside the nearest limit; `None` where nothing is held against one.
    #[inline]
    pub(super) fn inside_by(&self, row: usize) -> Option<Length> {
        let inside_by = |(on, limit): &(LimitTarget, Limit)| {
            let Interval { lower, upper } = self.judged(*on, row)?;
            limit.upper.map(|end| end - upper).into_iter().chain(limit.lower.map(|end| lower - end)).min()
        };
        self.plan.limits.iter().filter_map(inside_by).min()
    }

    /// How far a part is inside the nearest limit; without limits, how far its largest result is from 0. `None` without a result.
    pub(super) fn margin(&self, row: usize) -> Option<Margin> {
        let of_limits = self.plan.limits.iter().filter_map(|(on, limit)| {
            let result = self.judged(*on, row)?;
            let nearest = limit.nearest(result)?;
            Some(Margin { inside_by: nearest.inside_by, on: Some((*on, nearest)), result })
        });
        // of equals the first
        of_limits.reduce(|nearest, other| if other.inside_by < nearest.inside_by { other } else { nearest }).or_else(
            || {
                let results = self.plan.quantities().filter_map(|output| self.of(output, row));
                let largest = results.max_by_key(|value| value.abs())?;
                Some(Margin { inside_by: -largest.abs(), on: None, result: Interval::value(largest) })
            },
        )
    }

    /// The end of a limit that a judged part is nearest to; `None` while a limit may be nearer that is not judged.
    pub(super) fn nearest(&self, row: usize) -> Option<(LimitTarget, NearestEnd)> {
        self.verdicts[row].and_then(|_| self.margin(row)?.on)
    }

    /// How far an error is inside its own limit.
    pub(super) fn margin_of(&self, kind: DeviationKind, row: usize) -> Option<Length> {
        let on = LimitTarget::Error(kind);
        let (_, limit) = self.plan.limits.iter().find(|(other, _)| *other == on)?;
        Some(limit.nearest(self.judged(on, row)?)?.inside_by)
    }

    /// The results of an output that is a length, of all parts that have one.
    pub(super) fn all_of(&self, output: &Output) -> Cow<'_, [Length]> {
        if let (Output::Error(kind), true) = (output, self.refusals.is_empty()) {
            return Cow::Borrowed(&self.each[*kind as usize][..self.rows]);
        }
        let mut all = Vec::with_capacity(self.rows);
        for rows in self.runs() {
            self.each_of(output, &rows, |length| all.extend(length));
        }
        all.into()
    }

    /// Calls `take` with the result of an output in each of some rows, if the output is a length. Whether it is.
    #[inline]
    pub(super) fn each_of(
        &self,
        output: &Output,
        rows: &ops::Range<usize>,
        mut take: impl FnMut(Option<Length>),
    ) -> bool {
        let (ranges, end) = match output {
            Output::Error(kind) => {
                match self.each[*kind as usize].get(rows.clone()) {
                    Some(lengths) => lengths.iter().for_each(|length| take(Some(*length))),
                    None => rows.clone().for_each(|_| take(None)),
                }
                return true;
            }
            Output::Combined(stack, end) => (&self.combined[*stack as usize], end),
            Output::Reached(end) => (&self.reached, end),
            Output::Judged(_) | Output::Margin => {
                rows.clone().for_each(|row| take(self.of(output, row)));
                return true;
            }
            _ => return false,
        };
        match ranges.get(rows.clone()) {
            Some(ranges) => ranges.iter().for_each(|range| take(range.map(|range| end.of(range)))),
            None => rows.clone().for_each(|_| take(None)),
        }
        true
    }

    /// The result of an output that is a length; `None` if there is none.
    #[inline]
    pub(super) fn of(&self, output: &Output, row: usize) -> Option<Length> {
        match output {
            Output::Error(kind) => self.each[*kind as usize].get(row).copied(),
            Output::Combined(stack, end) => Some(end.of(at(&self.combined[*stack as usize], row)?)),
            Output::Reached(end) => Some(end.of(at(&self.reached, row)?)),
            Output::Judged(end) => Some(end.of(self.judged(LimitTarget::CenterDistance, row)?)),
            Output::Margin => self.verdicts[row].and_then(|_| self.inside_by(row)),
            _ => None,
        }
    }

    /// What is held against a limit.
    #[inline]
    fn judged(&self, on: LimitTarget, row: usize) -> Option<Interval> {
        match on {
            LimitTarget::CenterDistance => match self.meshed(row) {
                Some(Ok(meshed)) => Some(meshed.range),
                _ => at(&self.combined[self.plan.request.stack as usize], row),
            },
            LimitTarget::Error(kind) => at(&self.alone[kind as usize], row),
        }
    }
}

/// By what the exact mesh passes or fails a part.
#[cold]
fn by_mesh(meshed: Result<&Meshed, &str>) -> String {
    match meshed {
        Ok(Meshed { range: Interval { lower, upper }, .. }) => {
            format!("judged by the exact mesh: ΔCD = {:.6} to {:.6} mm", lower.mm(), upper.mm())
        }
        Err(why) => format!("judged by the worst case, for the exact mesh has no answer: {why}"),
    }
}

/// A row of a column, which may not be computed.
#[inline]
fn at(column: &[Option<Interval>], row: usize) -> Option<Interval> {
    *column.get(row)?
}

/// What the exact mesh reaches with the errors on the worst teeth found; `None` where it has no solution.
fn reached(plan: &Plan, errors: &[ExtendedError]) -> Option<Interval> {
    let GivenGeometry::Known(pairs) = &plan.basis.geometry else { return None };
    let Reached { lower_mm, upper_mm, .. } = reached::reached(errors, pairs.given()).ok()??;
    Interval::nearest(Range { lower: lower_mm, upper: upper_mm }).ok()
}

/// A result with its uncertainty; `None` where no bound is known within it.
fn ends(plan: &Plan, spreads: &Spreads, on: LimitTarget, result: Interval) -> Option<Ends> {
    let source = match on {
        LimitTarget::CenterDistance => None,
        LimitTarget::Error(kind) => index_of(&plan.sources, kind),
    };
    let ends = spreads.ends(source, result);
    (ends.lower_standard_mm.is_finite() && ends.upper_standard_mm.is_finite()).then_some(ends)
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
