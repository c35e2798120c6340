//! One part's errors, evaluated: ΔCD of each, combined, and judged. Called by the command line and for parts with their
//! teeth; takes formulas as they are.

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

/// What one error contributes.
#[derive(Debug, Clone, PartialEq)]
pub struct Contribution {
    /// The kind of error.
    pub kind: DeviationKind,
    /// The error's value.
    pub value: DeviationValue,
    /// On which teeth it is.
    pub extent: Extent,
    /// Its ΔCD by the exact formula.
    pub exact: Length,
    /// Its ΔCD by the paper's formula.
    pub paper: Length,
    /// What it can do alone, wherever it is.
    pub range: Result<Interval, NoBound>,
    /// How many of its steps add up at most, of a pitch on many teeth.
    pub in_contact: Option<u32>,
    /// Its share of the sum of magnitudes, 0 to 1, by the chosen model; `None` if every ΔCD is zero.
    pub share: Option<f64>,
    /// The ends of what is permitted, in place of a measured value.
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

    /// Its extent in words, with how many steps add up.
    #[must_use]
    pub fn extent_in_words(&self) -> String {
        let words = self.extent.words(self.kind.counts(), self.in_contact);
        // two ends say which signs there are
        if self.two_ends().is_some() { words.replace(", any sign", ", its own value") } else { words }
    }
}

/// Why there is nothing to hold against a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unjudged {
    /// The limited error is not given.
    NotGiven,
    /// Errors that the spec asks for are not there.
    Lacking,
    /// The rule needs an uncertainty of every value, and one has none.
    NoUncertainty,
    /// There is no finite range.
    NoBound(NoBound),
}

/// One limit, the interval of ΔCD held against it, and how that ended.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitCheck {
    /// What the limit is on.
    pub on: LimitTarget,
    /// The limit.
    pub limit: Limit,
    /// The result from its lowest to its highest value.
    pub result: Result<Interval, Unjudged>,
    /// The verdict, `None` if there is no result to judge.
    pub verdict: Option<Verdict>,
    /// How a decision rule came to it; `None` while the value alone decides and nothing is known of its uncertainty.
    pub decision: Option<Decision>,
}

impl LimitCheck {
    /// Why it is open by a rule; `None` of a limit that is met or broken.
    #[must_use]
    pub fn open_because(&self, stack: Stack, rule: &Rule) -> Option<String> {
        match (self.result, self.verdict) {
            (Err(Unjudged::NotGiven), _) => Some(format!("there is no value for {}", self.on)),
            (Err(Unjudged::Lacking), _) => Some("the sum lacks errors that the spec asks for".to_owned()),
            (Err(Unjudged::NoUncertainty), _) => Some(format!("the rule {rule} needs an uncertainty of every value")),
            (Err(Unjudged::NoBound(open)), _) => Some(open.to_string()),
            (Ok(_), Some(Verdict::Indeterminate)) => Some(too_near(self.on, stack, rule)),
            (Ok(_), _) => None,
        }
    }
}

/// What a limit is on.
#[must_use]
pub fn subject(on: LimitTarget, stack: Stack) -> String {
    match on {
        LimitTarget::CenterDistance => format!("ΔCD ({stack})"),
        LimitTarget::Error(kind) => format!("ΔCD of {kind}"),
    }
}

/// Why a verdict is indeterminate.
#[must_use]
pub fn too_near(on: LimitTarget, stack: Stack, rule: &Rule) -> String {
    let (what, rule) = (subject(on, stack), rule.in_words());
    format!("{what} is too near a limit to prove conformity or non-conformity (rule {rule})")
}

named! {
    /// Who judges a combination.
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
    /// Of errors, on a pair of which this is known.
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
    /// The combinations: what these errors can do wherever they are.
    pub combined: Combined<Interval>,
    /// What is held against a limit on ΔCD: a combination, or what the exact mesh makes of errors that are on all teeth.
    pub judged: Result<Interval, NoBound>,
    /// What they rest on.
    pub notes: Vec<Note>,
    /// What the verdicts take for granted of uncertainties.
    pub unstated: Vec<Unstated>,
    /// Who judges.
    pub judged_by: JudgedBy,
    /// Why the exact mesh does not judge though nothing is left to place.
    pub unsolved: Option<String>,
    /// What the exact mesh reaches with the errors on the worst teeth that a search finds, if it was asked.
    pub reached: Option<Interval>,
    /// The decision rule by which the verdicts are reached.
    pub rule: Rule,
    /// One per limit.
    pub limits: Vec<LimitCheck>,
    /// Fail if any limit fails; `None` if there are none, or one could not be judged; indeterminate if one is; else
    /// pass.
    pub verdict: Option<Verdict>,
}

impl Evaluation {
    /// The limits that could not be judged, because the error they are on is not given.
    pub fn not_given(&self) -> impl Iterator<Item = LimitTarget> + '_ {
        self.limits.iter().filter(|check| check.result == Err(Unjudged::NotGiven)).map(|check| check.on)
    }

    /// Judges every limit again by a decision rule, with the uncertainty of the results and, if they were simulated,
    /// the simulated probabilities of conformance (one per limit, NaN where there is none).
    ///
    /// # Errors
    /// [`QuantityError`] if a guard band is beyond the range of numbers.
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

    /// Why the verdict is open: of every limit that is; `None` where it is a pass or a fail, or there is no limit.
    #[must_use]
    pub fn open_because(&self) -> Option<String> {
        if matches!(self.verdict, Some(Verdict::Pass | Verdict::Fail)) {
            return None;
        }
        let mut reasons: Vec<_> =
            self.limits.iter().filter_map(|check| check.open_because(self.stack, &self.rule)).collect();
        reasons.dedup();
        (!reasons.is_empty()).then(|| reasons.join("; "))
    }

    /// The verdict with those on what a yoke does; `None` without any limit, or if one is open.
    #[must_use]
    pub fn verdict_with(&self, checks: &[Check]) -> Option<Verdict> {
        let of_errors = (!self.limits.is_empty()).then_some(self.verdict);
        of_errors.into_iter().chain(checks.iter().map(|check| check.verdict)).reduce(worse).flatten()
    }

    /// How wide the worst case is, mm: U − L, beyond which no ΔCD varies; `None` without a bound.
    #[must_use]
    pub fn range_width_mm(&self) -> Option<f64> {
        self.combined.range.ok().map(|range| (range.upper - range.lower).mm())
    }

    /// Why that is open; `None` where it is a pass or a fail.
    #[must_use]
    pub fn open_with(&self, checks: &[Check]) -> Option<String> {
        if matches!(self.verdict_with(checks), Some(Verdict::Pass | Verdict::Fail)) {
            return None;
        }
        let reasons: Vec<_> =
            self.open_because().into_iter().chain(checks.iter().filter_map(Check::open_because)).collect();
        (!reasons.is_empty()).then(|| reasons.join("; "))
    }

    /// Why the bound judges in place of the exact mesh, in a sentence.
    #[must_use]
    pub fn note_of_unsolved(&self) -> Option<String> {
        let why = self.unsolved.as_ref()?;
        Some(format!(
            "nothing is left to place, and the exact mesh has no answer, so that the worst case judges: {why}"
        ))
    }

    /// Whether it is proven that ΔCD stays within its limit.
    #[must_use]
    pub fn passes(&self) -> bool {
        let on_sum = self.limits.iter().find(|check| check.on == LimitTarget::CenterDistance);
        on_sum.is_some_and(|check| check.verdict == Some(Verdict::Pass))
    }

    /// Takes the verdict on a limit back; one that is open keeps its reason.
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
    /// The error whose ΔCD has no value; `None` if it is a sum.
    pub error: Option<DeviationKind>,
    /// What is wrong with it.
    #[source]
    pub problem: Box<DomainError>,
}

/// Evaluates `errors` by `model`, combines them by what is known of the pair, and judges the combination picked by
/// `asked`, and what single errors can do, against `limits`.
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
        // where nothing is left to place nothing scatters, either
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
    let (unstated, unsolved, reached, rule) = (Vec::new(), None, None, Rule::Simple);
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
        verdict,
    })
}

/// What each error contributes by `model`.
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

/// Of the verdicts on two limits, or on some of them and another, `None` where one could not be judged: fail if any is; open
/// if one could not be judged; indeterminate if any is; else pass.
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
