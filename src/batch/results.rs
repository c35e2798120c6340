//! The results of one part, and what they say about the limits. Called by the row evaluator; `eval` combines and judges
//! by the same functions.

use super::output::{Of, Output};
use super::plan::Plan;
use super::uncertain::RowUncertainty;
use crate::decision::rule::{Ends, verdict};
use crate::decision::uncertainty::{Spread, Spreads};
use crate::decision::{Combined, LimitTarget, Term, Verdict, overall};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::quantity::{DomainError, Length, QuantityError};

pub(super) const KINDS: usize = ErrorKind::ALL.len();

/// The results of one part.
#[derive(Debug, Clone, Copy)]
pub(super) struct Results {
    pub(super) each: [Length; KINDS],
    combined: Combined,
}

/// Why a part has no results: the source whose ΔCD has none, or the combination, and what is wrong.
pub(super) struct NoResults {
    pub(super) source: Option<usize>,
    pub(super) problem: Box<DomainError>,
}

/// How far a part is inside the nearest limit, which that is, and what is held against it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Margin {
    pub(super) inside_by: Length,
    pub(super) on: Option<LimitTarget>,
    pub(super) result: (Length, Length),
}

impl Results {
    /// The results of the deviations, one per source of the plan.
    #[inline]
    pub(super) fn new(plan: &Plan, deviations: &[ErrorValue; KINDS]) -> Result<Self, NoResults> {
        let nothing = Term { kind: ErrorKind::RackOverRoller, delta_cd: Length::ZERO, is_tolerance: false };
        let mut terms = [nothing; KINDS];
        let mut each = [Length::ZERO; KINDS];
        for (index, source) in plan.sources.iter().enumerate() {
            let delta_cd = source.law.delta_cd(deviations[index], plan.model);
            each[index] = delta_cd.map_err(|problem| NoResults { source: Some(index), problem: Box::new(problem) })?;
            terms[index] = Term { kind: source.law.kind(), delta_cd: each[index], is_tolerance: false };
        }
        let combined = Combined::of(&terms[..plan.sources.len()]);
        let combined = combined.map_err(|problem| NoResults { source: None, problem: Box::new(problem.into()) })?;
        Ok(Self { each, combined })
    }

    /// The verdict on the part; `None` if a limit could not be judged.
    #[inline]
    pub(super) fn judge(
        &self,
        plan: &Plan,
        uncertainty: Option<&RowUncertainty>,
    ) -> Result<Option<Verdict>, QuantityError> {
        let mut verdicts = [Verdict::Pass; 1 + KINDS];
        for (index, (on, limit)) in plan.limits.iter().enumerate() {
            let standard = uncertainty.map_or((0.0, 0.0), |known| {
                let (lower, upper) = ends(&known.spreads, self.judged(plan, *on).1);
                (lower.standard_mm, upper.standard_mm)
            });
            let simulated = uncertainty.and_then(|known| known.inside(index));
            verdicts[index] =
                verdict(&plan.request.rule, limit, self.judged(plan, *on).0, standard, simulated)?.verdict;
        }
        let judged = verdicts[..plan.limits.len()].iter().copied().map(Some);
        Ok(overall(judged.chain(plan.unjudged.iter().map(|_| None))))
    }

    /// The probability that the limit with that index is met, by the linear uncertainties.
    pub(super) fn conformance(&self, plan: &Plan, spreads: &Spreads, limit: usize) -> f64 {
        let (on, limit) = &plan.limits[limit];
        let ((lower, upper), of) = self.judged(plan, *on);
        let (at_lower, at_upper) = ends(spreads, of);
        let ends = Ends {
            lower_mm: lower.mm(),
            upper_mm: upper.mm(),
            lower_standard_mm: at_lower.standard_mm,
            upper_standard_mm: at_upper.standard_mm,
            correlation: if of.is_some() { 1.0 } else { spreads.end_correlation },
        };
        ends.conformance(limit)
    }

    /// How far the part is inside the nearest limit; without limits, how far its largest result is from 0.
    pub(super) fn margin(&self, plan: &Plan) -> Margin {
        let of_limits = plan.limits.iter().filter_map(|(on, limit)| {
            let (result, _) = self.judged(plan, *on);
            let above = limit.upper.map(|end| end - result.1);
            let below = limit.lower.map(|end| result.0 - end);
            let inside_by = above.into_iter().chain(below).min()?;
            Some(Margin { inside_by, on: Some(*on), result })
        });
        // of equals the first
        of_limits
            .reduce(|nearest, other| if other.inside_by < nearest.inside_by { other } else { nearest })
            .unwrap_or_else(|| {
                let results = plan.quantities().map(|output| self.of(output));
                let largest = results.max_by_key(|value| value.abs()).unwrap_or(Length::ZERO);
                Margin { inside_by: -largest.abs(), on: None, result: (largest, largest) }
            })
    }

    /// The result of an output that is a length.
    #[inline]
    pub(super) fn of(&self, output: &Output) -> Length {
        match output {
            Output::Error(source) => self.each[*source],
            Output::RangeLower => self.combined.range_lower,
            Output::RangeUpper => self.combined.range_upper,
            Output::WorstCase => self.combined.worst_case,
            Output::Rss => self.combined.rss,
            _ => Length::ZERO,
        }
    }

    /// The lower and upper end that are held against a limit, and the source that they are of, if it is one.
    #[inline]
    fn judged(&self, plan: &Plan, on: LimitTarget) -> ((Length, Length), Option<usize>) {
        match on {
            LimitTarget::CenterDistance => (self.combined.interval(plan.stack), None),
            LimitTarget::Error(kind) => {
                let source = plan.sources.iter().position(|source| source.law.kind() == kind);
                let value = source.map_or(Length::ZERO, |source| self.each[source]);
                ((value, value), source)
            }
        }
    }
}

/// The uncertainties of the lower and the upper end of a source, or of the combination.
fn ends(spreads: &Spreads, source: Option<usize>) -> (&Spread, &Spread) {
    match source {
        Some(source) => (&spreads.errors[source], &spreads.errors[source]),
        None => (&spreads.lower, &spreads.upper),
    }
}

/// The uncertainty of a result.
pub(super) fn spread_of(spreads: &Spreads, of: Of) -> &Spread {
    match of {
        Of::Source(source) => &spreads.errors[source],
        Of::Lower => &spreads.lower,
        Of::Upper => &spreads.upper,
    }
}
