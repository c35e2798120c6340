//! The results of one part, and what they say about the limits. Called by the row evaluator; `eval` combines and judges
//! by the same functions.

use super::output::{Output, UncertainOutput};
use super::plan::Plan;
use super::source::{KINDS, index_of};
use super::uncertain::RowUncertainty;
use crate::deviation::DeviationValue;
use crate::evaluation::overall;
use crate::judge::bound::{ChangingErrors, ExtendedError, GivenGeometry, Range};
use crate::judge::reached::{self, Reached};
use crate::judge::rule::{Ends, verdict};
use crate::judge::{Interval, LimitTarget, Stack, Verdict};
use crate::quantity::{DomainError, Length, QuantityError};
use crate::trig;
use crate::uncertainty::{Spread, Spreads};

/// The results of one part.
#[derive(Debug, Clone, Copy)]
pub(super) struct Results {
    /// ΔCD of each kind of error, by its number.
    pub(super) each: [Length; KINDS],
    /// What each can do alone, where that is held against a limit.
    alone: [Option<Interval>; KINDS],
    range: Option<Interval>,
    rss: Option<Interval>,
    reached: Option<Interval>,
}

/// Why a row makes no part.
pub(super) struct Refusal {
    pub(super) message: String,
    /// The source that is to blame, by its index, if one is.
    pub(super) source: Option<usize>,
}

impl Refusal {
    /// A source whose ΔCD has no value, or the combination.
    #[cold]
    fn of(plan: &Plan, source: Option<usize>, problem: &DomainError) -> Self {
        let name = source.map_or("combination", |source| plan.sources[source].law.kind().name());
        Self { message: format!("{name}: {problem}"), source }
    }
}

/// How far a part is inside the nearest limit, which that is, and what is held against it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Margin {
    pub(super) inside_by: Length,
    pub(super) on: Option<LimitTarget>,
    pub(super) result: Interval,
}

/// The value of an error as the bound takes it, mm or rad.
#[inline]
fn plain_value(value: DeviationValue) -> f64 {
    match value {
        DeviationValue::Length(length) => length.mm(),
        DeviationValue::Angle(angle) => angle.radians(),
        DeviationValue::Slope(slope) => trig::atan(slope),
    }
}

impl Results {
    /// The results of the deviations, one per source of the plan, whose errors get these values. What has no bound is
    /// left out.
    #[inline]
    pub(super) fn new(
        plan: &Plan,
        deviations: &[DeviationValue; KINDS],
        errors: &mut ChangingErrors<'_>,
    ) -> Result<Self, Refusal> {
        let of_source = |index, problem| Refusal::of(plan, Some(index), &problem);
        let mut results =
            Self { each: [Length::ZERO; KINDS], alone: [None; KINDS], range: None, rss: None, reached: None };
        for (index, source) in plan.sources.iter().enumerate() {
            let kind = source.law.kind() as usize;
            let delta_cd = source.law.delta_cd(deviations[index], plan.request.model);
            results.each[kind] = delta_cd.map_err(|problem| of_source(index, problem))?;
            errors.set(index, plain_value(deviations[index]));
            if source.is_limited {
                let alone = errors.alone(index).ok();
                let alone = alone.map(|alone| Interval::nearest(alone.alone())).transpose();
                results.alone[kind] = alone.map_err(|problem| of_source(index, problem.into()))?;
            }
        }
        if plan.needs_range || plan.needs_rss {
            let together = errors.together();
            let of = |stack: Stack| {
                let ends = together.interval(stack).ok().map(Interval::nearest).transpose();
                ends.map_err(|problem| Refusal::of(plan, None, &problem.into()))
            };
            if plan.needs_range {
                results.range = of(Stack::Range)?;
            }
            if plan.needs_rss {
                results.rss = of(Stack::Rss)?;
            }
        }
        if plan.needs_reached {
            results.reached = reached(plan, errors.errors());
        }
        Ok(results)
    }

    /// The verdict on the part; `None` if a limit could not be judged.
    #[inline]
    pub(super) fn judge(
        &self,
        plan: &Plan,
        uncertainty: Option<&RowUncertainty>,
    ) -> Result<Option<Verdict>, QuantityError> {
        let mut verdicts = [None; 1 + KINDS];
        for (index, (on, limit)) in plan.limits.iter().enumerate() {
            let Some(result) = self.judged(plan, *on) else { continue };
            let standard = uncertainty.map_or((0.0, 0.0), |known| {
                let ends = ends(plan, &known.spreads, *on, result);
                (ends.lower_standard_mm, ends.upper_standard_mm)
            });
            let simulated = uncertainty.and_then(|known| known.inside(index));
            verdicts[index] = Some(verdict(&plan.request.rule, limit, result, standard, simulated)?.0);
        }
        let judged = verdicts[..plan.limits.len()].iter().copied();
        Ok(overall(judged.chain(plan.unjudged.iter().map(|_| None))))
    }

    /// The probability that a limit is met, simulated or by the linear uncertainties; `None` without a result.
    pub(super) fn conformance(&self, plan: &Plan, known: &RowUncertainty, on: LimitTarget) -> Option<f64> {
        let index = plan.limits.iter().position(|(other, _)| *other == on)?;
        let linear = || Some(ends(plan, &known.spreads, on, self.judged(plan, on)?).conformance(&plan.limits[index].1));
        known.inside(index).or_else(linear)
    }

    /// How far the part is inside the nearest limit; without limits, how far its largest result is from 0.
    pub(super) fn margin(&self, plan: &Plan) -> Margin {
        let of_limits = plan.limits.iter().filter_map(|(on, limit)| {
            let result = self.judged(plan, *on)?;
            let above = limit.upper.map(|end| end - result.upper);
            let below = limit.lower.map(|end| result.lower - end);
            let inside_by = above.into_iter().chain(below).min()?;
            Some(Margin { inside_by, on: Some(*on), result })
        });
        // of equals the first
        of_limits
            .reduce(|nearest, other| if other.inside_by < nearest.inside_by { other } else { nearest })
            .unwrap_or_else(|| {
                let results = plan.quantities().filter_map(|output| self.of(output));
                let largest = results.max_by_key(|value| value.abs()).unwrap_or(Length::ZERO);
                Margin { inside_by: -largest.abs(), on: None, result: Interval::value(largest) }
            })
    }

    /// The result of an output that is a length; `None` if there is none.
    #[inline]
    pub(super) fn of(&self, output: &Output) -> Option<Length> {
        match output {
            Output::Error(kind) => Some(self.each[*kind as usize]),
            Output::RangeLower => Some(self.range?.lower),
            Output::RangeUpper => Some(self.range?.upper),
            Output::RssLower => Some(self.rss?.lower),
            Output::RssUpper => Some(self.rss?.upper),
            Output::ReachedLower => Some(self.reached?.lower),
            Output::ReachedUpper => Some(self.reached?.upper),
            _ => None,
        }
    }

    /// What is held against a limit.
    #[inline]
    fn judged(&self, plan: &Plan, on: LimitTarget) -> Option<Interval> {
        match on {
            LimitTarget::CenterDistance if plan.request.stack == Stack::Rss => self.rss,
            LimitTarget::CenterDistance => self.range,
            LimitTarget::Error(kind) => self.alone[kind as usize],
        }
    }
}

/// What the exact mesh reaches with the errors on the worst teeth found; `None` where it has no solution.
fn reached(plan: &Plan, errors: &[ExtendedError]) -> Option<Interval> {
    let GivenGeometry::Known(pairs) = &plan.basis.geometry else { return None };
    let Reached { lower_mm, upper_mm, .. } = reached::reached(errors, pairs.given()).ok()??;
    Interval::nearest(Range { lower: lower_mm, upper: upper_mm }).ok()
}

/// A result with its uncertainty.
fn ends(plan: &Plan, spreads: &Spreads, on: LimitTarget, result: Interval) -> Ends {
    let source = match on {
        LimitTarget::CenterDistance => None,
        LimitTarget::Error(kind) => index_of(&plan.sources, kind),
    };
    spreads.ends(source, result)
}

/// The uncertainty of a result.
pub(super) fn spread_of<'s>(plan: &Plan, spreads: &'s Spreads, of: UncertainOutput) -> Option<&'s Spread> {
    Some(match of {
        UncertainOutput::Error(kind) => &spreads.errors[index_of(&plan.sources, kind)?],
        UncertainOutput::Lower => &spreads.lower,
        UncertainOutput::Upper => &spreads.upper,
    })
}
