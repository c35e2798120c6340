//! The results of some rows of a block, column by column, and what they say about the limits. Called by the evaluator of
//! blocks; `eval` combines and judges by the same functions.

use super::layout::Layout;
use super::output::{Output, UncertainOutput};
use super::plan::Plan;
use super::request::Request;
use super::source::{KINDS, index_of};
use super::uncertain::RowUncertainty;
use crate::deviation::{DeviationKind, DeviationValue};
use crate::evaluation::{overall, too_near};
use crate::judge::bound::{ChangingErrors, ErrorRange, ExtendedError, GivenGeometry, NoBound, Range};
use crate::judge::reached::{self, Reached};
use crate::judge::rule::{self, Ends};
use crate::judge::{Interval, LimitTarget, Stack, Verdict};
use crate::quantity::{DomainError, Length, QuantityError};
use crate::table::Fault;
use crate::trig;
use crate::uncertainty::{Spread, Spreads};

/// The results of some rows.
pub(super) struct Results<'a> {
    plan: &'a Plan,
    layout: &'a Layout,
    /// Why a row makes no part.
    pub(super) refusals: Refusals,
    /// ΔCD of each kind of error, by its number.
    each: [Vec<Option<Length>>; KINDS],
    /// What each can do alone, where that is held against a limit.
    alone: [Vec<Option<Interval>>; KINDS],
    range: Vec<Option<Interval>>,
    rss: Vec<Option<Interval>>,
    reached: Vec<Option<Interval>>,
    /// What is uncertain about each part, if that is computed.
    uncertainties: Vec<Option<RowUncertainty>>,
    /// The verdict on each part; `None` if a limit could not be judged.
    pub(super) verdicts: Vec<Option<Verdict>>,
}

/// By row, why it makes no part.
pub(super) type Refusals = Vec<Option<Box<Fault>>>;

/// How far a part is inside the nearest limit, which that is, and what is held against it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Margin {
    pub(super) inside_by: Length,
    pub(super) on: Option<LimitTarget>,
    pub(super) result: Interval,
}

/// What is wrong with a row; `column` is to blame, if one is.
#[cold]
fn fault(column: Option<usize>, message: String) -> Fault {
    Fault { row: 0, column, is_missing: false, text: String::new(), message }
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

/// The nearest decimals of a range; nothing of one that is open.
#[inline]
fn nearest(range: Result<Range, NoBound>) -> Result<Option<Interval>, QuantityError> {
    range.ok().map(Interval::nearest).transpose()
}

impl<'a> Results<'a> {
    /// The results of the deviations, a column per source of the plan, but for rows that are refused already. What has no
    /// bound is left out.
    pub(super) fn new(
        plan: &'a Plan,
        layout: &'a Layout,
        refusals: Refusals,
        deviations: &[&[DeviationValue]],
        errors: &ChangingErrors<'_>,
    ) -> Self {
        let mut results = Self {
            plan,
            layout,
            refusals,
            each: Default::default(),
            alone: Default::default(),
            range: Vec::new(),
            rss: Vec::new(),
            reached: Vec::new(),
            uncertainties: Vec::new(),
            verdicts: Vec::new(),
        };
        for (index, deviations) in deviations.iter().enumerate() {
            results.take_error(index, deviations);
        }
        results.take_sums(deviations, errors);
        if let Some(uncertain) = &plan.uncertain {
            results.uncertainties = results.by_row(|results, row| {
                let deviations: Vec<_> = deviations.iter().map(|column| column[row]).collect();
                let delta_cd = |kind: DeviationKind| results.each[kind as usize][row].unwrap_or_default();
                let known = uncertain.of_row(&plan.sources, &deviations, delta_cd, &plan.limits);
                known.map(Some).map_err(|error| fault(None, error.to_string()))
            });
        }
        results.verdicts = results.by_row(Self::judge);
        if plan.request.strict {
            let first = results.refusals.iter().position(Option::is_some);
            results.refusals.truncate(first.map_or(usize::MAX, |first| first + 1));
        }
        results
    }

    /// What rows come to. One that is refused comes to nothing; one for which there is a reason is refused.
    #[inline]
    fn by_row<T: Default, C: FromIterator<T>>(&mut self, of: impl Fn(&Self, usize) -> Result<T, Fault>) -> C {
        let mut refusals = std::mem::take(&mut self.refusals);
        let come_to = |(row, refusal): (usize, &mut Option<Box<Fault>>)| match refusal {
            Some(_) => T::default(),
            None => of(self, row).unwrap_or_else(|reason| {
                *refusal = Some(Box::new(reason));
                T::default()
            }),
        };
        let column = refusals.iter_mut().enumerate().map(come_to).collect();
        self.refusals = refusals;
        column
    }

    /// ΔCD of an error, and what the error can do alone if that has a limit.
    fn take_error(&mut self, index: usize, deviations: &[DeviationValue]) {
        let plan = self.plan;
        let (source, column) = (&plan.sources[index], self.layout.columns[index]);
        let kind = source.law.kind();
        let refused = |problem: DomainError| fault(column, format!("{}: {problem}", kind.name()));
        self.each[kind as usize] =
            self.by_row(|_, row| source.law.delta_cd(deviations[row], plan.request.model).map(Some).map_err(refused));
        if source.is_limited {
            self.alone[kind as usize] = self.by_row(|_, row| {
                let error = source.extended.with_value(plain_value(deviations[row]));
                nearest(plan.basis.alone(&error).map(ErrorRange::alone)).map_err(|problem| refused(problem.into()))
            });
        }
    }

    /// What all errors do together.
    fn take_sums(&mut self, deviations: &[&[DeviationValue]], errors: &ChangingErrors<'_>) {
        let plan = self.plan;
        let values = |row: usize| deviations.iter().map(move |column| plain_value(column[row]));
        if plan.needs_range || plan.needs_rss {
            (self.range, self.rss) = self.by_row(|_, row| {
                let together = errors.together(values(row));
                let range = if plan.needs_range { nearest(together.range) } else { Ok(None) };
                let rss = if plan.needs_rss { nearest(together.rss) } else { Ok(None) };
                range
                    .and_then(|range| Ok((range, rss?)))
                    .map_err(|problem| fault(None, format!("combination: {}", DomainError::from(problem))))
            });
        }
        if plan.needs_reached {
            self.reached = self.by_row(|_, row| Ok(reached(plan, &errors.with(values(row)))));
        }
    }

    /// The uncertainties of a part, if they are known.
    pub(super) fn uncertainty(&self, row: usize) -> Option<&RowUncertainty> {
        self.uncertainties.get(row)?.as_ref()
    }

    #[inline]
    fn judge(&self, row: usize) -> Result<Option<Verdict>, Fault> {
        let verdicts = self.judge_each(row)?;
        let judged = verdicts[..self.plan.limits.len()].iter().copied();
        Ok(overall(judged.chain(self.plan.unjudged.iter().map(|_| None))))
    }

    /// Why a part is indeterminate.
    #[cold]
    pub(super) fn too_near(&self, row: usize) -> String {
        let Request { stack, rule, .. } = &self.plan.request;
        let verdicts = self.judge_each(row).unwrap_or_default();
        let limits = self.plan.limits.iter().zip(verdicts);
        let near = limits.filter(|(_, verdict)| *verdict == Some(Verdict::Indeterminate));
        near.map(|((on, _), _)| too_near(*on, *stack, rule)).collect::<Vec<_>>().join("; ")
    }

    /// The verdict on each limit, as far as there are limits.
    #[inline]
    fn judge_each(&self, row: usize) -> Result<[Option<Verdict>; 1 + KINDS], Fault> {
        let plan = self.plan;
        let uncertainty = self.uncertainty(row);
        let mut verdicts = [None; 1 + KINDS];
        for (index, (on, limit)) in plan.limits.iter().enumerate() {
            let Some(result) = self.judged(*on, row) else { continue };
            let standard = uncertainty.map_or((0.0, 0.0), |known| {
                let ends = ends(plan, &known.spreads, *on, result);
                (ends.lower_standard_mm, ends.upper_standard_mm)
            });
            let simulated = uncertainty.and_then(|known| known.inside(index));
            let verdict = rule::verdict(&plan.request.rule, limit, result, standard, simulated);
            verdicts[index] = Some(verdict.map_err(|error| fault(None, error.to_string()))?.0);
        }
        Ok(verdicts)
    }

    /// The probability that a limit is met, simulated or by the linear uncertainties; `None` without a result.
    pub(super) fn conformance(&self, known: &RowUncertainty, on: LimitTarget, row: usize) -> Option<f64> {
        let plan = self.plan;
        let index = plan.limits.iter().position(|(other, _)| *other == on)?;
        let linear = || Some(ends(plan, &known.spreads, on, self.judged(on, row)?).conformance(&plan.limits[index].1));
        known.inside(index).or_else(linear)
    }

    /// How far a part is inside the nearest limit; without limits, how far its largest result is from 0.
    pub(super) fn margin(&self, row: usize) -> Margin {
        let of_limits = self.plan.limits.iter().filter_map(|(on, limit)| {
            let result = self.judged(*on, row)?;
            let above = limit.upper.map(|end| end - result.upper);
            let below = limit.lower.map(|end| result.lower - end);
            let inside_by = above.into_iter().chain(below).min()?;
            Some(Margin { inside_by, on: Some(*on), result })
        });
        // of equals the first
        of_limits
            .reduce(|nearest, other| if other.inside_by < nearest.inside_by { other } else { nearest })
            .unwrap_or_else(|| {
                let results = self.plan.quantities().filter_map(|output| self.of(output, row));
                let largest = results.max_by_key(|value| value.abs()).unwrap_or(Length::ZERO);
                Margin { inside_by: -largest.abs(), on: None, result: Interval::value(largest) }
            })
    }

    /// The rows that are parts.
    pub(super) fn parts(&self) -> impl Iterator<Item = usize> {
        (0..self.refusals.len()).filter(|row| self.refusals[*row].is_none())
    }

    /// The results of an output that is a length, of all parts that have one.
    pub(super) fn all_of(&self, output: &Output) -> impl Iterator<Item = Length> {
        self.parts().filter_map(|row| self.of(output, row))
    }

    /// The result of an output that is a length; `None` if there is none.
    #[inline]
    pub(super) fn of(&self, output: &Output, row: usize) -> Option<Length> {
        match output {
            Output::Error(kind) => self.each[*kind as usize][row],
            Output::RangeLower => Some(at(&self.range, row)?.lower),
            Output::RangeUpper => Some(at(&self.range, row)?.upper),
            Output::RssLower => Some(at(&self.rss, row)?.lower),
            Output::RssUpper => Some(at(&self.rss, row)?.upper),
            Output::ReachedLower => Some(at(&self.reached, row)?.lower),
            Output::ReachedUpper => Some(at(&self.reached, row)?.upper),
            _ => None,
        }
    }

    /// What is held against a limit.
    #[inline]
    fn judged(&self, on: LimitTarget, row: usize) -> Option<Interval> {
        match on {
            LimitTarget::CenterDistance if self.plan.request.stack == Stack::Rss => at(&self.rss, row),
            LimitTarget::CenterDistance => at(&self.range, row),
            LimitTarget::Error(kind) => at(&self.alone[kind as usize], row),
        }
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
