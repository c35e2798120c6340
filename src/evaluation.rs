//! The errors of one part: the ΔCD of each, their combination, and the verdicts. Called by the command line, and for parts
//! whose teeth are known.

use std::fmt;

use thiserror::Error;

use crate::deviation::{DeviationKind, DeviationValue, Extent};
use crate::formula::{Model, PartDeviation, ToleranceEnds};
use crate::function::Check;
use crate::judge::bound::{Basis, Bound, ErrorRange, NoBound, Note};
use crate::judge::rule::{Decision, Rule, decide};
use crate::judge::{Combined, Interval, Limit, LimitTarget, Limits, Stack, Verdict};
use crate::quantity::{DomainError, Length, QuantityError};
use crate::uncertainty::{Propagation, Unstated};

/// The contribution of one error.
#[derive(Debug, Clone, PartialEq)]
pub struct Contribution {
    /// The kind of error.
    pub kind: DeviationKind,
    /// The error's value.
    pub value: DeviationValue,
    /// The teeth on which it is.
    pub extent: Extent,
    /// Its ΔCD by the exact formula.
    pub exact: Length,
    /// Its ΔCD by the paper's formula.
    pub paper: Length,
    /// The range of its ΔCD alone, on any teeth that its extent allows.
    pub range: Result<Interval, NoBound>,
    /// For a pitch error on many teeth: the largest number of its steps that add up.
    pub in_contact: Option<u32>,
    /// Its share of the sum of magnitudes, 0 to 1, by the chosen model; `None` if every ΔCD is zero.
    pub share: Option<f64>,
    /// The ends of its tolerance, if it is a tolerance in place of a measured value.
    pub tolerance: Option<ToleranceEnds>,
}

impl Contribution {
    /// ΔCD by `model`.
    #[must_use]
    pub fn delta_cd(&self, model: Model) -> Length {
        match model {
            Model::Exact => self.exact,
            Model::Paper => self.paper,
        }
    }

    /// Both ends of a tolerance that has two, mm or degrees.
    #[must_use]
    pub fn two_ends(&self) -> Option<[f64; 2]> {
        self.tolerance.filter(|ends| ends.nearer.is_some()).map(ToleranceEnds::base)
    }

    /// Its extent in words, with the number of steps that add up.
    #[must_use]
    pub fn extent_in_words(&self) -> String {
        let words = self.extent.words(self.kind.counts(), self.in_contact);
        // the two ends determine the signs
        if self.two_ends().is_some() { words.replace(", any sign", ", its own value") } else { words }
    }
}

/// Why a limit has no result to judge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unjudged {
    /// The limited error is not given.
    NotGiven,
    /// Errors that the spec asks for are missing: of each of [`DeviationKind::ALL`], whether it is.
    Lacking([bool; DeviationKind::ALL.len()]),
    /// The rule needs an uncertainty of every value: of each of [`DeviationKind::ALL`], whether it has none.
    NoUncertainty([bool; DeviationKind::ALL.len()]),
    /// The range is not finite.
    NoBound(NoBound),
}

impl Unjudged {
    /// Without these errors.
    #[must_use]
    pub fn lacking(kinds: &[DeviationKind]) -> Self {
        Self::Lacking(DeviationKind::ALL.map(|kind| kinds.contains(&kind)))
    }

    /// Without an uncertainty of these errors' values.
    #[must_use]
    pub fn without_uncertainty(kinds: &[DeviationKind]) -> Self {
        Self::NoUncertainty(DeviationKind::ALL.map(|kind| kinds.contains(&kind)))
    }
}

/// One limit, the interval of ΔCD that it judges, and the verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitCheck {
    /// The quantity that the limit is on.
    pub on: LimitTarget,
    /// The limit.
    pub limit: Limit,
    /// The result from its lowest to its highest value.
    pub result: Result<Interval, Unjudged>,
    /// The verdict, `None` if there is no result to judge.
    pub verdict: Option<Verdict>,
    /// The decision behind it; `None` while the value alone decides and its uncertainty is not known.
    pub decision: Option<Decision>,
}

impl LimitCheck {
    /// Why it is open under a rule; `None` for a limit that is met or broken.
    #[must_use]
    pub fn open_because(&self, judged_by: JudgedBy, rule: &Rule) -> Option<String> {
        match (self.result, self.verdict) {
            (Err(Unjudged::NotGiven), _) => Some(format!("there is no value for {}", self.on)),
            (Err(Unjudged::Lacking(lacks)), _) => {
                Some(format!("the sum lacks {}, which the spec asks for", DeviationKind::keys(marked(lacks))))
            }
            (Err(Unjudged::NoUncertainty(lacks)), _) => Some(rule.lacks_uncertainty(marked(lacks))),
            (Err(Unjudged::NoBound(open)), _) => Some(open.to_string()),
            (Ok(_), Some(Verdict::Indeterminate)) => Some(too_near(self.on, judged_by, rule)),
            (Ok(_), _) => None,
        }
    }
}

/// The errors that are marked, of each of [`DeviationKind::ALL`].
fn marked(marks: [bool; DeviationKind::ALL.len()]) -> impl Iterator<Item = DeviationKind> {
    DeviationKind::ALL.into_iter().zip(marks).filter_map(|(kind, is_marked)| is_marked.then_some(kind))
}

/// The quantity that a limit is on, in words.
#[must_use]
pub fn subject(on: LimitTarget, judged_by: JudgedBy) -> String {
    match (on, judged_by) {
        (LimitTarget::CenterDistance, JudgedBy::Bound) => format!("ΔCD ({})", Stack::Range),
        (LimitTarget::CenterDistance, JudgedBy::Statistical) => format!("ΔCD ({})", Stack::Rss),
        (LimitTarget::CenterDistance, JudgedBy::Mesh) => "ΔCD (exact mesh)".to_owned(),
        (LimitTarget::Error(kind), _) => format!("ΔCD of {kind}"),
    }
}

/// Why a verdict is indeterminate.
#[must_use]
pub fn too_near(on: LimitTarget, judged_by: JudgedBy, rule: &Rule) -> String {
    let (what, rule) = (subject(on, judged_by), rule.in_words());
    format!("{what} is too near a limit to prove conformity or non-conformity (rule {rule})")
}

named! {
    /// What judges a combination.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum JudgedBy {
        /// The bound: no placement of the errors leaves it.
        Bound = "bound",
        /// The exact mesh: both parts' teeth are known, or every error is on all teeth.
        Mesh = "mesh",
        /// The statistical sum.
        Statistical = "statistical",
    }
}

impl JudgedBy {
    /// What judges this number of errors, on a pair of which `basis` is known.
    #[must_use]
    pub fn of(stack: Stack, errors: usize, basis: &Basis) -> Self {
        match stack {
            Stack::Rss => Self::Statistical,
            Stack::Range if basis.all_placed.is_some() || (errors == 0 && basis.known_teeth.is_some()) => Self::Mesh,
            Stack::Range => Self::Bound,
        }
    }
}

impl fmt::Display for JudgedBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Bound => "the worst case",
            Self::Mesh => "the exact mesh of the known teeth",
            Self::Statistical => "the statistical sum, which is no bound",
        })
    }
}

/// Every contribution, the combinations and the verdicts.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// The model of the values that were combined and judged.
    pub model: Model,
    /// The combination that was judged.
    pub stack: Stack,
    /// One per error, in the order given.
    pub contributions: Vec<Contribution>,
    /// The combinations: the ΔCD of these errors on any teeth that their extents allow.
    pub combined: Combined<Interval>,
    /// The ΔCD that a limit on it judges: a combination, or the ΔCD of the exact mesh where the teeth of all errors are known.
    pub judged: Result<Interval, NoBound>,
    /// The assumptions of the combinations.
    pub notes: Vec<Note>,
    /// The assumptions of the verdicts where nothing is stated.
    pub unstated: Vec<Unstated>,
    /// What judges.
    pub judged_by: JudgedBy,
    /// Why the exact mesh does not judge, although the teeth of all errors are known.
    pub unsolved: Option<String>,
    /// The ΔCD of the exact mesh with the errors on the worst teeth that a search finds, if a search was asked for.
    pub reached: Option<Interval>,
    /// The decision rule by which the verdicts are reached.
    pub rule: Rule,
    /// One per limit.
    pub limits: Vec<LimitCheck>,
    /// Whether the status of the part rejects it, so that it fails whatever its values are.
    pub is_rejected: bool,
    /// Fail if a limit fails; else `None` if there is no limit or one is open; else indeterminate if one is; else pass.
    pub verdict: Option<Verdict>,
}

/// Why a part fails that its status rejects, where no limit is broken.
pub const REJECTED: &str = "the table says that the part fails by its status";

impl Evaluation {
    /// The limits that are open because their error is not given.
    pub fn not_given(&self) -> impl Iterator<Item = LimitTarget> + '_ {
        self.limits.iter().filter(|check| check.result == Err(Unjudged::NotGiven)).map(|check| check.on)
    }

    /// Judges every limit again by a decision rule, with the uncertainty of the results and, if they were simulated,
    /// the probabilities of conformance (one per limit, NaN where there is none).
    ///
    /// # Errors
    /// [`QuantityError`] if a guard band is larger than a length may be.
    pub fn decide_by(
        &mut self,
        rule: &Rule,
        propagation: Option<&Propagation>,
        simulated: Option<&[f64]>,
    ) -> Result<(), QuantityError> {
        self.rule = rule.clone();
        for (index, check) in self.limits.iter_mut().enumerate() {
            let Ok(result) = check.result else { continue };
            let ends = propagation.and_then(|propagation| propagation.ends(check.on, result));
            let probability = simulated.and_then(|inside| inside.get(index)).copied().filter(|p| !p.is_nan());
            let decision = decide(rule, &check.limit, result, ends.as_ref(), probability)?;
            check.verdict = Some(decision.verdict);
            check.decision = Some(decision);
        }
        self.verdict = overall(&self.limits);
        Ok(())
    }

    /// Why the verdict is open, for every limit that is; `None` for a pass or a fail, or without a limit.
    #[must_use]
    pub fn open_because(&self) -> Option<String> {
        if matches!(self.verdict, Some(Verdict::Pass | Verdict::Fail)) {
            return None;
        }
        let mut reasons: Vec<_> =
            self.limits.iter().filter_map(|check| check.open_because(self.judged_by, &self.rule)).collect();
        reasons.dedup();
        (!reasons.is_empty()).then(|| reasons.join("; "))
    }

    /// The verdict together with those on a yoke; `None` without any limit, or if one is open.
    #[must_use]
    pub fn verdict_with(&self, checks: &[Check]) -> Option<Verdict> {
        let of_errors = (self.is_rejected || !self.limits.is_empty()).then_some(self.verdict);
        of_errors.into_iter().chain(checks.iter().map(|check| check.verdict)).reduce(worse).flatten()
    }

    /// Fails the part if its status rejects it.
    pub fn reject_if(&mut self, is_rejected: bool) {
        self.is_rejected |= is_rejected;
        self.verdict = if self.is_rejected { Some(Verdict::Fail) } else { self.verdict };
    }

    /// Why the part fails, if its status rejects it and no limit is broken.
    #[must_use]
    pub fn rejection(&self) -> Option<String> {
        let is_broken = self.limits.iter().any(|check| check.verdict == Some(Verdict::Fail));
        (self.is_rejected && !is_broken).then(|| REJECTED.to_owned())
    }

    /// Why the verdict together with those on a yoke is open, or that the status rejects the part.
    #[must_use]
    pub fn reason_with(&self, checks: &[Check]) -> Option<String> {
        self.open_with(checks).or_else(|| self.rejection())
    }

    /// Width U − L of the worst case, mm: ΔCD varies by no more; `None` without a bound.
    #[must_use]
    pub fn range_width_mm(&self) -> Option<f64> {
        self.combined.range.ok().map(|range| (range.upper - range.lower).mm())
    }

    /// Why the verdict together with those on a yoke is open; `None` for a pass or a fail.
    #[must_use]
    pub fn open_with(&self, checks: &[Check]) -> Option<String> {
        if matches!(self.verdict_with(checks), Some(Verdict::Pass | Verdict::Fail)) {
            return None;
        }
        let reasons: Vec<_> =
            self.open_because().into_iter().chain(checks.iter().filter_map(Check::open_because)).collect();
        (!reasons.is_empty()).then(|| reasons.join("; "))
    }

    /// A sentence on why the bound judges in place of the exact mesh.
    #[must_use]
    pub fn note_of_unsolved(&self) -> Option<String> {
        let why = self.unsolved.as_ref()?;
        Some(format!(
            "the teeth of all errors are known, but the exact mesh has no answer, so the worst case judges: {why}"
        ))
    }

    /// Whether it is proven that ΔCD stays within its limit.
    #[must_use]
    pub fn passes(&self) -> bool {
        let on_sum = self.limits.iter().find(|check| check.on == LimitTarget::CenterDistance);
        on_sum.is_some_and(|check| check.verdict == Some(Verdict::Pass))
    }

    /// Withdraws the verdict on a limit; an open limit keeps its reason.
    pub fn leave_open(&mut self, on: LimitTarget, why: Unjudged) {
        for check in self.limits.iter_mut().filter(|check| check.on == on && check.result.is_ok()) {
            check.result = Err(why);
            (check.verdict, check.decision) = (None, None);
        }
        self.verdict = overall(&self.limits);
    }

    /// Whether any error's ΔCD depends on the model.
    #[must_use]
    pub fn models_differ(&self) -> bool {
        self.contributions.iter().any(|contribution| contribution.exact != contribution.paper)
    }
}

/// Why an evaluation has no result.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{}: {problem}", .error.map_or("combination", DeviationKind::name))]
pub struct EvaluationError {
    /// The error whose ΔCD has no value; `None` for the combination.
    pub error: Option<DeviationKind>,
    /// Why it has none.
    #[source]
    pub problem: Box<DomainError>,
}

/// Evaluates `errors` by `model`, combines them for the pair of `basis`, and judges the combination that `asked` names, and the
/// ranges of single errors, by `limits`.
///
/// # Errors
/// [`EvaluationError`] if a ΔCD is outside its formula's domain, or a result overflows.
pub fn evaluate(
    errors: &[PartDeviation],
    limits: &Limits,
    model: Model,
    asked: Stack,
    basis: &Basis,
) -> Result<Evaluation, EvaluationError> {
    let of_sum = |problem: QuantityError| EvaluationError { error: None, problem: Box::new(problem.into()) };
    let bound = basis.bound_of(errors);
    let contributions = contributions(errors, model, &bound)?;
    let combined = bound.combined.nearest().map_err(of_sum)?;
    let stack = combined.judged(asked);
    let judged = match basis.all_placed {
        // known teeth have no statistical scatter
        Some(range) => Ok(Interval::nearest(range).map_err(of_sum)?),
        None => combined.interval(stack),
    };
    let limits: Vec<_> = limits
        .iter()
        .map(|(on, limit)| {
            let result = match on {
                LimitTarget::CenterDistance => judged.map_err(Unjudged::NoBound),
                LimitTarget::Error(kind) => match contributions.iter().find(|one| one.kind == *kind) {
                    Some(one) => one.range.map_err(Unjudged::NoBound),
                    None => Err(Unjudged::NotGiven),
                },
            };
            let verdict = result.ok().map(|result| limit.judge(result));
            LimitCheck { on: *on, limit: *limit, result, verdict, decision: None }
        })
        .collect();
    let verdict = overall(&limits);
    let judged_by = JudgedBy::of(stack, errors.len(), basis);
    let nothing_scatters = (stack != asked).then_some(Note::NothingScatters);
    let notes = bound.notes.into_iter().chain(nothing_scatters).collect();
    let (unstated, unsolved, reached, rule, is_rejected) = (Vec::new(), None, None, Rule::Simple, false);
    Ok(Evaluation {
        model,
        stack,
        contributions,
        combined,
        judged,
        notes,
        unstated,
        judged_by,
        unsolved,
        reached,
        rule,
        limits,
        is_rejected,
        verdict,
    })
}

/// The contribution of each error, by `model`.
fn contributions(errors: &[PartDeviation], model: Model, bound: &Bound) -> Result<Vec<Contribution>, EvaluationError> {
    let mut contributions = Vec::with_capacity(errors.len());
    for (error, range) in errors.iter().zip(&bound.errors) {
        let of_error = |problem: DomainError| EvaluationError { error: Some(error.kind()), problem: Box::new(problem) };
        contributions.push(Contribution {
            kind: error.kind(),
            value: error.value(),
            extent: error.extent(),
            exact: error.delta_cd(Model::Exact).map_err(of_error)?,
            paper: error.delta_cd(Model::Paper).map_err(of_error)?,
            range: Interval::of(range.map(ErrorRange::alone)).map_err(|problem| of_error(problem.into()))?,
            in_contact: range.ok().map(|range| range.in_contact),
            share: None,
            tolerance: error.is_tolerance().then(|| error.tolerance()),
        });
    }
    let sum: f64 = contributions.iter().map(|contribution| contribution.delta_cd(model).abs().mm()).sum();
    if sum > 0.0 {
        for contribution in &mut contributions {
            contribution.share = Some(contribution.delta_cd(model).abs().mm() / sum);
        }
    }
    Ok(contributions)
}

/// The verdict on all limits; `None` without any.
fn overall(limits: &[LimitCheck]) -> Option<Verdict> {
    limits.iter().map(|check| check.verdict).reduce(worse).flatten()
}

/// The verdict on two limits together, `None` for an open one: fail if one fails; else open if one is; else indeterminate if
/// one is; else pass.
#[inline]
pub(crate) fn worse(one: Option<Verdict>, other: Option<Verdict>) -> Option<Verdict> {
    match (one, other) {
        (Some(Verdict::Fail), _) | (_, Some(Verdict::Fail)) => Some(Verdict::Fail),
        (None, _) | (_, None) => None,
        (Some(Verdict::Indeterminate), _) | (_, Some(Verdict::Indeterminate)) => Some(Verdict::Indeterminate),
        _ => Some(Verdict::Pass),
    }
}

#[cfg(test)]
mod tests;
