//! The verdict on each part of a block, why it does not pass, how near a limit it is.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use super::{Results, at, fault};
use crate::batch::meshed::{Meshed, Meshes};
use crate::batch::plan::Plan;
use crate::batch::source::index_of;
use crate::batch::uncertain::RowUncertainty;
use crate::deviation::{DeviationKind, DeviationValues};
use crate::evaluation::{JudgedBy, REJECTED, too_near, worse};
use crate::function::{Check, Judged, JudgedYoke, YokeJudge};
use crate::judge::bound::GivenGeometry;
use crate::judge::rule::{self, Conformance, Ends};
use crate::judge::{Interval, Limit, LimitTarget, NearestEnd, Stack, Verdict};
use crate::quantity::Length;
use crate::table::Fault;
use crate::uncertainty::Spreads;

/// How far a part is inside the nearest limit, which limit that is, and the result compared with it.
#[derive(Debug, Clone, Copy)]
pub(in crate::batch) struct Margin {
    pub(in crate::batch) inside_by: Length,
    pub(in crate::batch) on: Option<(LimitTarget, NearestEnd)>,
    pub(in crate::batch) result: Interval,
}

impl Results<'_> {
    /// Judges the parts, those that the bound does not pass by `mesh`. Without limits, or with one that could not be judged, a
    /// verdict that is not fail is open.
    pub(super) fn judge(&mut self, mut mesh: impl FnMut(&mut Self, &mut [Option<Verdict>], usize)) {
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

    /// The yoke's figures of each part with their verdicts: by the mesh where no error is left to place, else by the bound.
    #[cold]
    pub(super) fn take_yokes(
        &mut self,
        yoke: &YokeJudge,
        deviations: &[Cow<'_, DeviationValues>],
        meshes: &mut Meshes<'_>,
    ) {
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

    /// Whether a part has limits besides those of its yoke, or the table says that the part is rejected.
    fn asks_of_errors(&self, row: usize) -> bool {
        let has_limits = !(self.plan.limits.is_empty() && self.plan.unjudged.is_empty());
        has_limits || self.of_errors.get(row) == Some(&Some(Verdict::Fail))
    }

    /// The limits on a yoke by the worst case of a part; open where its pair is not known.
    fn yoke_by_bound(&self, yoke: &YokeJudge, row: usize) -> JudgedYoke {
        let range = self.combined[Stack::Range as usize].at(row);
        match &self.plan.basis.geometry {
            GivenGeometry::Known(pairs) => {
                let width_mm = range.map(|range| (range.upper - range.lower).mm());
                yoke.within(&pairs.given().pair, width_mm)
            }
            GivenGeometry::Unknown | GivenGeometry::BothFlanks => yoke.unknown(yoke.open(&Judged::NotProven)),
        }
    }

    /// Whether the status of a part rejects it, and no limit on ΔCD is broken.
    pub(in crate::batch) fn fails_by_status(&self, row: usize) -> bool {
        self.by_status.binary_search(&row).is_ok()
    }

    /// How many parts of some rows their status rejects, without a broken limit on ΔCD.
    pub(in crate::batch) fn failed_by_status(&self, rows: &Range<usize>) -> u64 {
        self.by_status.iter().filter(|row| rows.contains(row)).count() as u64
    }

    /// How many parts of some rows the exact mesh judges.
    pub(in crate::batch) fn judged_by_mesh(&self, rows: &Range<usize>) -> u64 {
        self.meshed.range(rows.clone()).filter(|(_, answer)| answer.is_ok()).count() as u64
    }

    /// Whether a part fails by its status or a limit on its yoke, and breaks none on ΔCD.
    pub(in crate::batch) fn fails_otherwise(&self, row: usize) -> bool {
        let is_inside = || self.of_errors.get(row).is_some_and(|verdict| *verdict != Some(Verdict::Fail));
        self.fails_by_status(row) || self.verdicts[row] == Some(Verdict::Fail) && is_inside()
    }

    /// Judges the parts that the bound does not pass by their exact mesh. Once the run is to stop, the first part that is not
    /// meshed, and all behind it, do not count.
    #[cold]
    pub(super) fn judge_by_mesh(
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

    /// The method that judges the errors of a part together.
    pub(in crate::batch) fn judged_by(&self, row: usize) -> JudgedBy {
        match (self.meshed(row), self.plan.request.stack) {
            (Some(Ok(_)), _) => JudgedBy::Mesh,
            (_, Stack::Rss) if !self.unscattered.contains_key(&row) => JudgedBy::Statistical,
            _ => JudgedBy::Bound,
        }
    }

    /// Whether there is nothing to say of any part with this verdict.
    #[inline]
    pub(in crate::batch) fn passes_silently(&self, verdict: Option<Verdict>) -> bool {
        verdict == Some(Verdict::Pass) && self.meshed.is_empty() && self.yokes.is_empty()
    }

    /// How far each of some rows is inside the only limit, that on ΔCD; `None` where a row needs a closer look.
    pub(in crate::batch) fn margins(&self, rows: &Range<usize>) -> Option<Vec<Length>> {
        let [(LimitTarget::CenterDistance, limit)] = &self.plan.limits[..] else { return None };
        let ranges = self.combined[self.plan.request.stack as usize].all(rows).filter(|_| self.meshed.is_empty())?;
        if self.verdicts[rows.clone()].contains(&None) {
            return None;
        }
        ranges.map(|(lower, upper)| limit.inside_by(Interval { lower: *lower, upper: *upper })).collect()
    }

    /// Why a part fails, is indeterminate or has no verdict; for a part that the exact mesh judges, with its range.
    pub(in crate::batch) fn reason(&self, row: usize) -> Option<Cow<'_, str>> {
        if self.passes_silently(self.verdicts[row]) {
            return None;
        }
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
        joined(unless_pass.into_iter().chain(meshed).chain(of_yoke)).map(Cow::Owned)
    }

    /// Why a part does not pass.
    #[cold]
    fn not_passed(&self, verdict: Verdict, row: usize) -> String {
        let (rule, judged_by) = (&self.plan.request.rule, self.judged_by(row));
        let limits = self.plan.limits.iter().enumerate();
        let judged = limits.filter(|(limit, _)| matches!(self.judge_by(*limit, row), Ok(Some(of)) if of == verdict));
        let why = judged.filter_map(|(index, (on, limit))| match verdict {
            Verdict::Fail => {
                let (subjects, sides) = &self.plan.limits_in_words[index];
                let nearest = limit.nearest(self.judged(*on, row)?)?;
                Some([subjects[judged_by as usize].as_str(), " ", &nearest.in_words(sides)].concat())
            }
            _ => Some(too_near(*on, judged_by, rule)),
        });
        joined(why).unwrap_or_else(|| REJECTED.to_owned())
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
    pub(in crate::batch) fn conformance(&self, known: &RowUncertainty, on: LimitTarget, row: usize) -> Option<f64> {
        let plan = self.plan;
        let index = plan.limits.iter().position(|(other, _)| *other == on)?;
        let known = self.uncertainty_on(on, row).unwrap_or(known);
        let ends = self.judged(on, row).and_then(|result| ends(plan, &known.spreads, on, result));
        Some(Conformance::of(&plan.limits[index].1, ends.as_ref(), known.inside(index))?.probability)
    }

    /// How far a part is inside the nearest limit; `None` where nothing is held against one.
    #[inline]
    pub(in crate::batch) fn inside_by(&self, row: usize) -> Option<Length> {
        let inside_by = |(on, limit): &(LimitTarget, Limit)| limit.inside_by(self.judged(*on, row)?);
        self.plan.limits.iter().filter_map(inside_by).min()
    }

    /// How far a part is inside the nearest limit; without limits, how far its largest result is from 0. `None` without a result.
    pub(in crate::batch) fn margin(&self, row: usize) -> Option<Margin> {
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

    /// The end of a limit that a judged part is nearest to; `None` if a limit that is not judged may be nearer.
    pub(in crate::batch) fn nearest(&self, row: usize) -> Option<(LimitTarget, NearestEnd)> {
        self.verdicts[row].and_then(|_| self.margin(row)?.on)
    }

    /// How far an error is inside its own limit.
    pub(in crate::batch) fn margin_of(&self, kind: DeviationKind, row: usize) -> Option<Length> {
        let on = LimitTarget::Error(kind);
        let (_, limit) = self.plan.limits.iter().find(|(other, _)| *other == on)?;
        Some(limit.nearest(self.judged(on, row)?)?.inside_by)
    }

    /// The uncertainties of the result that a limit judges, if they are known.
    #[inline]
    fn uncertainty_on(&self, on: LimitTarget, row: usize) -> Option<&RowUncertainty> {
        match self.meshed(row) {
            Some(Ok(meshed)) if on == LimitTarget::CenterDistance => meshed.uncertainty.as_ref(),
            _ => self.uncertainty(row),
        }
    }

    /// The result that a limit judges.
    #[inline]
    pub(super) fn judged(&self, on: LimitTarget, row: usize) -> Option<Interval> {
        match on {
            LimitTarget::CenterDistance => match self.meshed(row) {
                Some(Ok(meshed)) => Some(meshed.range),
                _ => self.combined[self.plan.request.stack as usize]
                    .at(row)
                    .or_else(|| self.unscattered.get(&row).copied()),
            },
            LimitTarget::Error(kind) => at(&self.alone[kind as usize], row),
        }
    }
}

/// Texts with a semicolon between them; `None` without a text.
fn joined(mut texts: impl Iterator<Item = String>) -> Option<String> {
    let first = texts.next()?;
    Some(texts.fold(first, |all, more| format!("{all}; {more}")))
}

/// The result by which the exact mesh passes or fails a part.
#[cold]
fn by_mesh(meshed: Result<&Meshed, &str>) -> String {
    match meshed {
        Ok(Meshed { range: Interval { lower, upper }, .. }) => {
            format!("judged by the exact mesh: ΔCD = {:.6} to {:.6} mm", lower.mm(), upper.mm())
        }
        Err(why) => format!("judged by the worst case, for the exact mesh has no answer: {why}"),
    }
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
