#![doc = include_str!("method.md")]
//!
//! `budget` calls [`allocate`] with errors whose tolerances are fixed and errors whose tolerances are free; each free
//! one gets a share of what the fixed ones leave. It evaluates with the formulas and combinations that
//! [`evaluate`](super::evaluate) uses, and must not round a tolerance up. By simulation: [`simulation`].

pub mod simulation;
#[cfg(test)]
mod tests;

use thiserror::Error;

use super::{Combined, EvaluationError, Limit, Term};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::formula::{Model, PartError, PartFormula, Sensitivity, over_roller};
use crate::quantity::{Angle, DomainError, Length, Rational};
use simulation::{Assembly, Simulated, Simulation};

/// How tolerances add up.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Rule {
    /// The sum of magnitudes.
    WorstCase,
    /// The root of the sum of squares.
    Rss,
    /// A fraction of random assemblies.
    Simulation(Simulation),
}

impl Rule {
    /// `worst`, `rss` or `simulation`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::WorstCase => "worst",
            Self::Rss => "rss",
            Self::Simulation(_) => "simulation",
        }
    }
}

/// What decides the size of a free tolerance.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Freedom {
    /// A weight: ΔCD in this ratio.
    Weight(Rational),
    /// A relative cost: ΔCD where the sum of costs is smallest.
    Cost(Rational),
}

/// One error of a budget.
#[derive(Debug, Clone)]
pub enum Entry {
    /// Its tolerance is fixed: the error lies within plus and minus its value.
    Fixed(PartError),
    /// Its tolerance is sought.
    Free(PartFormula, Freedom),
}

impl Entry {
    /// The kind of error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Fixed(error) => error.kind(),
            Self::Free(formula, _) => formula.kind(),
        }
    }
}

/// A budget's demand.
#[derive(Debug, Clone)]
pub struct Request {
    /// The errors.
    pub entries: Vec<Entry>,
    /// The limit of the combined ΔCD.
    pub limit: Limit,
    /// Limits of single errors' ΔCD.
    pub own_limits: Vec<(ErrorKind, Limit)>,
    /// How tolerances add up.
    pub rule: Rule,
    /// The formulas' reading.
    pub model: Model,
}

/// One error of a finished budget.
#[derive(Debug, Clone)]
pub struct Line {
    /// The error with its tolerance.
    pub error: PartError,
    /// Its ΔCD.
    pub delta_cd: Length,
    /// Whether the tolerance was given.
    pub is_fixed: bool,
    /// Whether the error's own limit, not the budget, stops it.
    pub at_own_limit: bool,
    /// Its part of the sum that the rule forms: of magnitudes, or of squares.
    pub share: f64,
    /// ∂ΔCD/∂input at the tolerance.
    pub sensitivities: Vec<Sensitivity>,
}

/// A finished budget.
#[derive(Debug, Clone)]
pub struct Budget {
    /// One per error.
    pub lines: Vec<Line>,
    /// The tolerances combined as `eval` does.
    pub combined: Combined,
    /// The ΔCD that was distributed: the nearer end of the limit.
    pub bound: Option<Length>,
    /// What the simulation of these tolerances gave.
    pub simulated: Option<Simulated>,
    /// Errors without which the fixed tolerances would leave something: empty if the budget is feasible.
    pub broken_by: Vec<ErrorKind>,
}

impl Budget {
    /// Whether the limit is met.
    #[must_use]
    pub fn is_feasible(&self) -> bool {
        self.broken_by.is_empty()
    }
}

/// Why there is no budget at all.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BudgetError {
    /// The limit does not allow ΔCD to be zero, or allows nothing else.
    #[error("the limit of ΔCD leaves nothing to distribute: 0 must lie inside it, with room to either side")]
    NoRoom,
    /// Nothing stops the free tolerances.
    #[error("the limit does not stop the free tolerances: give it an upper end")]
    Unbounded,
    /// The limit of ΔCD has no end.
    #[error("a budget needs a limit of the combined ΔCD")]
    NoLimit,
    /// A formula has no result.
    #[error("{}: {problem}", .kind.name())]
    Formula {
        /// The error.
        kind: ErrorKind,
        /// What is wrong.
        problem: Box<DomainError>,
    },
    /// A combination has no result.
    #[error(transparent)]
    Combination(#[from] EvaluationError),
}

fn of_kind(kind: ErrorKind) -> impl Fn(DomainError) -> BudgetError {
    move |problem| BudgetError::Formula { kind, problem: Box::new(problem) }
}

/// Finds the tolerances.
///
/// # Errors
/// [`BudgetError`] if the limit gives nothing to distribute or a formula has no result. Fixed tolerances that take
/// more than the limit are no error: the budget then names what breaks it.
pub fn allocate(request: &Request) -> Result<Budget, BudgetError> {
    match request.rule {
        Rule::WorstCase | Rule::Rss => by_sum(request),
        Rule::Simulation(settings) => by_simulation(request, &settings),
    }
}

/// The largest W for which −W … +W lies inside the limit.
fn symmetric_bound(limit: &Limit) -> Result<Length, BudgetError> {
    let lower = limit.lower.as_ref().map(|lower| -lower);
    let bound = match (lower, limit.upper.clone()) {
        (None, None) => return Err(BudgetError::NoLimit),
        (Some(bound), None) | (None, Some(bound)) => bound,
        (Some(lower), Some(upper)) => lower.min(upper),
    };
    if bound > Length::ZERO { Ok(bound) } else { Err(BudgetError::NoRoom) }
}

/// The largest ΔCD that the error's own limit allows.
fn own_bound(request: &Request, kind: ErrorKind) -> Option<Length> {
    let (_, limit) = request.own_limits.iter().find(|(of, _)| *of == kind)?;
    let lower = limit.lower.as_ref().filter(|_| kind.always_acts()).map(|lower| -lower);
    let bound = [lower, limit.upper.clone()].into_iter().flatten().min()?;
    Some(bound.max(Length::ZERO))
}

/// The ratio in which a free error's ΔCD stands to the others'.
fn ratio(freedom: &Freedom, rule: Rule) -> Rational {
    match (freedom, rule) {
        (Freedom::Weight(weight), _) => weight.clone(),
        (Freedom::Cost(cost), Rule::WorstCase) => cost.sqrt().unwrap_or(Rational::ZERO),
        (Freedom::Cost(cost), Rule::Rss | Rule::Simulation(_)) => cost.cbrt(),
    }
}

/// The largest tolerance of which ΔCD does not exceed `delta_cd`, a double rounded towards zero.
fn largest_tolerance(formula: &PartFormula, delta_cd: &Length, model: Model) -> Result<PartError, DomainError> {
    let toward_zero = |length: &Length| -> Result<Length, DomainError> {
        Ok(Length::from_mm(length.exact_mm().to_f64_toward_zero())?)
    };
    Ok(match formula {
        PartFormula::RackOverRoller => PartError::RackOverRoller(toward_zero(&over_roller::largest_error(delta_cd))?),
        PartFormula::PinionRadial => PartError::PinionRadial(toward_zero(delta_cd)?),
        PartFormula::RackPitch(formula) => {
            PartError::RackPitch(formula.largest_error(delta_cd, model)?, formula.clone())
        }
        PartFormula::PinionPitch(formula) => {
            PartError::PinionPitch(formula.largest_error(delta_cd, model)?, formula.clone())
        }
        PartFormula::RackLead(formula) => PartError::RackLead(formula.largest_error(delta_cd, model)?, formula.clone()),
    })
}

/// An error of nothing.
fn nothing(formula: &PartFormula) -> PartError {
    match formula {
        PartFormula::RackOverRoller => PartError::RackOverRoller(Length::ZERO),
        PartFormula::PinionRadial => PartError::PinionRadial(Length::ZERO),
        PartFormula::RackPitch(formula) => PartError::RackPitch(Length::ZERO, formula.clone()),
        PartFormula::PinionPitch(formula) => PartError::PinionPitch(Length::ZERO, formula.clone()),
        PartFormula::RackLead(formula) => PartError::RackLead(Angle::ZERO, formula.clone()),
    }
}

/// The magnitude of ΔCD of an error's tolerance.
fn magnitude(error: &PartError, model: Model) -> Result<Length, BudgetError> {
    Ok(error.delta_cd(model).map_err(of_kind(error.kind()))?.abs())
}

/// What a ΔCD takes of the sum that the rule forms.
fn taken(delta_cd: &Length, squares: bool) -> Rational {
    if squares { delta_cd.exact_mm().square() } else { delta_cd.exact_mm().clone() }
}

/// Worst case and RSS: sums of magnitudes, or of squares.
fn by_sum(request: &Request) -> Result<Budget, BudgetError> {
    let squares = request.rule == Rule::Rss;
    let bound = symmetric_bound(&request.limit)?;
    let mut left = taken(&bound, squares);
    let mut fixed: Vec<(ErrorKind, Rational)> = Vec::new();
    let mut free: Vec<Free<'_>> = Vec::new();
    for entry in &request.entries {
        match entry {
            Entry::Fixed(error) => fixed.push((error.kind(), taken(&magnitude(error, request.model)?, squares))),
            Entry::Free(formula, freedom) => free.push(Free {
                formula,
                ratio: ratio(freedom, request.rule),
                own: own_bound(request, formula.kind()),
                delta_cd: None,
                at_own_limit: false,
            }),
        }
    }
    let mut broken_by = beyond_own_limits(request)?;
    let total = fixed.iter().fold(Rational::ZERO, |sum, (_, taken)| &sum + taken);
    let nothing_left = |rest: &Rational| *rest < 0 || (rest.is_zero() && !free.is_empty());
    if nothing_left(&(&left - &total)) {
        // the largest first, until what remains fits
        fixed.sort_by(|a, b| b.1.cmp(&a.1));
        let mut rest = &left - &total;
        for (kind, taken) in fixed {
            if !nothing_left(&rest) {
                break;
            }
            rest = &rest + &taken;
            broken_by.push(kind);
        }
    } else {
        left = &left - &total;
        share_out(&mut free, left, squares)?;
    }
    let feasible = broken_by.is_empty();
    let mut lines = Vec::new();
    for entry in &request.entries {
        lines.push(match entry {
            Entry::Fixed(error) => line(error.clone(), true, false, request.model)?,
            Entry::Free(formula, _) => {
                let found = free.iter().find(|free| free.formula.kind() == formula.kind());
                let share = found.and_then(|free| free.delta_cd.as_ref()).filter(|_| feasible);
                let error = match share {
                    Some(delta_cd) => largest_tolerance(formula, delta_cd, request.model),
                    None => Ok(nothing(formula)),
                };
                let error = error.map_err(of_kind(formula.kind()))?;
                line(error, false, found.is_some_and(|free| free.at_own_limit), request.model)?
            }
        });
    }
    finish(lines, Some(bound), squares, None, broken_by)
}

/// A free error while shares are found.
struct Free<'a> {
    formula: &'a PartFormula,
    ratio: Rational,
    own: Option<Length>,
    delta_cd: Option<Length>,
    at_own_limit: bool,
}

/// Divides `left` among the free errors in their ratios, none beyond its own limit.
fn share_out(free: &mut [Free<'_>], mut left: Rational, squares: bool) -> Result<(), BudgetError> {
    loop {
        let open: Vec<usize> = (0..free.len()).filter(|i| !free[*i].at_own_limit).collect();
        let weight = |ratio: &Rational| if squares { ratio.square() } else { ratio.clone() };
        let sum = open.iter().fold(Rational::ZERO, |sum, i| &sum + &weight(&free[*i].ratio));
        if sum.is_zero() {
            return Ok(());
        }
        let mut stopped = false;
        for &i in &open {
            let part = &(&left * &weight(&free[i].ratio)) / &sum;
            // a root that is not rational is cut off, never rounded up
            let part = if squares { part.sqrt().unwrap_or(Rational::ZERO) } else { part };
            let kind = free[i].formula.kind();
            let share = Length::from_exact_mm(part, "a share of ΔCD").map_err(|error| of_kind(kind)(error.into()))?;
            match &free[i].own {
                Some(own) if *own < share => {
                    free[i].delta_cd = Some(own.clone());
                    free[i].at_own_limit = true;
                    stopped = true;
                }
                _ => free[i].delta_cd = Some(share),
            }
        }
        if !stopped {
            return Ok(());
        }
        // start again with what those at their own limits leave
        for i in open.into_iter().filter(|i| free[*i].at_own_limit) {
            let own = free[i].delta_cd.clone().unwrap_or(Length::ZERO);
            left = &left - &taken(&own, squares);
        }
    }
}

/// Fixed errors whose own limit their tolerance exceeds.
fn beyond_own_limits(request: &Request) -> Result<Vec<ErrorKind>, BudgetError> {
    let mut beyond = Vec::new();
    for entry in &request.entries {
        if let Entry::Fixed(error) = entry
            && let Some(own) = own_bound(request, error.kind())
            && magnitude(error, request.model)? > own
        {
            beyond.push(error.kind());
        }
    }
    Ok(beyond)
}

fn line(error: PartError, is_fixed: bool, at_own_limit: bool, model: Model) -> Result<Line, BudgetError> {
    let delta_cd = magnitude(&error, model)?;
    let sensitivities = error.sensitivities(model).map_err(of_kind(error.kind()))?;
    Ok(Line { error, delta_cd, is_fixed, at_own_limit, share: 0.0, sensitivities })
}

fn finish(
    mut lines: Vec<Line>,
    bound: Option<Length>,
    squares: bool,
    simulated: Option<Simulated>,
    mut broken_by: Vec<ErrorKind>,
) -> Result<Budget, BudgetError> {
    let sum = lines.iter().fold(Rational::ZERO, |sum, line| &sum + &taken(&line.delta_cd, squares));
    for line in &mut lines {
        if !sum.is_zero() {
            line.share = (&taken(&line.delta_cd, squares) / &sum).to_f64();
        }
    }
    let terms: Vec<Term> = lines
        .iter()
        .map(|line| Term { kind: line.error.kind(), delta_cd: line.delta_cd.clone(), is_tolerance: true })
        .collect();
    let combined =
        Combined::of(&terms).map_err(|problem| EvaluationError { error: None, problem: Box::new(problem.into()) })?;
    broken_by.sort();
    broken_by.dedup();
    Ok(Budget { lines, combined, bound, simulated, broken_by })
}

/// A target fraction of random assemblies.
fn by_simulation(request: &Request, settings: &Simulation) -> Result<Budget, BudgetError> {
    if request.limit.lower.is_none() && request.limit.upper.is_none() {
        return Err(BudgetError::NoLimit);
    }
    let assembly = Assembly::new(request, settings);
    let mut broken_by = beyond_own_limits(request)?;
    // the free tolerances for a scale of their ratios, mm
    let at = |scale: f64| -> Result<Vec<PartError>, BudgetError> {
        let mut errors = Vec::new();
        for entry in &request.entries {
            errors.push(match entry {
                Entry::Fixed(error) => error.clone(),
                Entry::Free(formula, freedom) => {
                    let share = scale * ratio(freedom, request.rule).to_f64();
                    let share = Length::from_mm(share).map_err(|error| of_kind(formula.kind())(error.into()))?;
                    let own = own_bound(request, formula.kind());
                    let share = own.filter(|own| *own < share).unwrap_or(share);
                    match largest_tolerance(formula, &share, request.model) {
                        Ok(error) => error,
                        // beyond what any angle does: as good as unbounded
                        Err(DomainError::NeverReached { .. }) => return Err(BudgetError::Unbounded),
                        Err(error) => return Err(of_kind(formula.kind())(error)),
                    }
                }
            });
        }
        Ok(errors)
    };
    let conforms = |errors: &[PartError]| assembly.count(errors) >= assembly.needed();
    let none = at(0.0)?;
    let has_free = request.entries.iter().any(|entry| matches!(entry, Entry::Free(..)));
    let errors = if !conforms(&none) {
        broken_by.extend(breaking_terms(&assembly, request)?);
        none
    } else if has_free && broken_by.is_empty() {
        simulation::largest_scale(at, conforms)?
    } else {
        none
    };
    let simulated = assembly.outcome(&errors);
    let mut lines = Vec::new();
    for (entry, error) in request.entries.iter().zip(errors) {
        let own = own_bound(request, error.kind());
        let mut line = line(error, matches!(entry, Entry::Fixed(_)), false, request.model)?;
        // a tolerance rounded towards zero stops within an ulp below its limit
        line.at_own_limit = !line.is_fixed && own.is_some_and(|own| line.delta_cd.mm() >= own.mm() * (1.0 - 1e-12));
        lines.push(line);
    }
    finish(lines, symmetric_bound(&request.limit).ok(), true, Some(simulated), broken_by)
}

/// The fixed errors, largest first, without which enough assemblies would conform.
fn breaking_terms(assembly: &Assembly, request: &Request) -> Result<Vec<ErrorKind>, BudgetError> {
    let mut fixed = Vec::new();
    for entry in &request.entries {
        if let Entry::Fixed(error) = entry {
            fixed.push((magnitude(error, request.model)?, error.kind()));
        }
    }
    fixed.sort_by(|a, b| b.cmp(a));
    let mut without = Vec::new();
    for (_, kind) in fixed {
        without.push(kind);
        let rest: Vec<PartError> = request
            .entries
            .iter()
            .map(|entry| match entry {
                Entry::Fixed(error) if !without.contains(&error.kind()) => error.clone(),
                Entry::Fixed(error) => nothing(&error.formula()),
                Entry::Free(formula, _) => nothing(formula),
            })
            .collect();
        if assembly.count(&rest) >= assembly.needed() {
            break;
        }
    }
    Ok(without)
}

/// A tolerance in mm or degrees.
#[must_use]
pub fn base_value(error: &PartError) -> f64 {
    match error.value() {
        ErrorValue::Length(length) => length.abs().mm(),
        ErrorValue::Angle(angle) => angle.abs().degrees(),
    }
}
