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
use crate::formula::{Law, Model, PartError, Sensitivity};
use crate::quantity::{DomainError, Length};
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Freedom {
    /// A weight: ΔCD in this ratio.
    Weight(f64),
    /// A relative cost: ΔCD where the sum of costs is smallest.
    Cost(f64),
}

/// One error of a budget.
#[derive(Debug, Clone, Copy)]
pub enum Entry {
    /// Its tolerance is fixed: the error lies within plus and minus its value.
    Fixed(PartError),
    /// Its tolerance is sought.
    Free(Law, Freedom),
}

impl Entry {
    /// The kind of error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Fixed(error) => error.kind(),
            Self::Free(law, _) => law.kind(),
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
    let lower = limit.lower.map(|lower| -lower);
    let bound = match (lower, limit.upper) {
        (None, None) => return Err(BudgetError::NoLimit),
        (Some(bound), None) | (None, Some(bound)) => bound,
        (Some(lower), Some(upper)) => lower.min(upper),
    };
    if bound > Length::ZERO { Ok(bound) } else { Err(BudgetError::NoRoom) }
}

/// The largest ΔCD that the error's own limit allows.
fn own_bound(request: &Request, kind: ErrorKind) -> Option<Length> {
    let (_, limit) = request.own_limits.iter().find(|(of, _)| *of == kind)?;
    let lower = limit.lower.filter(|_| kind.always_acts()).map(|lower| -lower);
    let bound = [lower, limit.upper].into_iter().flatten().min()?;
    Some(bound.max(Length::ZERO))
}

/// The ratio in which a free error's ΔCD stands to the others'.
fn ratio(freedom: Freedom, rule: Rule) -> f64 {
    match (freedom, rule) {
        (Freedom::Weight(weight), _) => weight,
        (Freedom::Cost(cost), Rule::WorstCase) => cost.sqrt(),
        (Freedom::Cost(cost), Rule::Rss | Rule::Simulation(_)) => libm::cbrt(cost),
    }
}

/// The largest tolerance of which ΔCD does not exceed `delta_cd`.
fn largest_tolerance(law: Law, delta_cd: Length, model: Model) -> Result<PartError, DomainError> {
    Ok(PartError::new(law, law.largest_error(delta_cd, model)?))
}

/// An error of nothing.
fn nothing(law: Law) -> PartError {
    PartError::new(law, ErrorValue::zero(law.kind()))
}

/// The magnitude of ΔCD of an error's tolerance.
fn magnitude(error: &PartError, model: Model) -> Result<Length, BudgetError> {
    Ok(error.delta_cd(model).map_err(of_kind(error.kind()))?.abs())
}

/// What a ΔCD takes of the sum that the rule forms, in fm or fm².
fn taken(delta_cd: Length, squares: bool) -> i128 {
    let magnitude = i128::from(delta_cd.fm());
    if squares { magnitude * magnitude } else { magnitude }
}

/// The largest ΔCD that takes no more than that.
fn affordable(left: i128, squares: bool) -> Length {
    let fm = if squares { left.isqrt() } else { left };
    Length::from_fm(i64::try_from(fm).unwrap_or(i64::MAX))
}

/// Worst case and RSS: sums of magnitudes, or of squares.
fn by_sum(request: &Request) -> Result<Budget, BudgetError> {
    let squares = request.rule == Rule::Rss;
    let bound = symmetric_bound(&request.limit)?;
    let mut fixed: Vec<(ErrorKind, i128)> = Vec::new();
    let mut free: Vec<Free> = Vec::new();
    for entry in &request.entries {
        match entry {
            Entry::Fixed(error) => fixed.push((error.kind(), taken(magnitude(error, request.model)?, squares))),
            Entry::Free(law, freedom) => free.push(Free {
                law: *law,
                ratio: ratio(*freedom, request.rule),
                own: own_bound(request, law.kind()),
                delta_cd: Length::ZERO,
                at_own_limit: false,
            }),
        }
    }
    let mut broken_by = beyond_own_limits(request)?;
    let nothing_left = |left: i128| left < 0 || (left == 0 && !free.is_empty());
    let mut left = taken(bound, squares) - fixed.iter().map(|(_, taken)| taken).sum::<i128>();
    if nothing_left(left) {
        // the largest first, until what remains fits
        fixed.sort_by_key(|(_, taken)| std::cmp::Reverse(*taken));
        for (kind, taken) in fixed {
            if !nothing_left(left) {
                break;
            }
            left += taken;
            broken_by.push(kind);
        }
    } else {
        share_out(&mut free, left, squares);
    }
    let feasible = broken_by.is_empty();
    let mut lines = Vec::new();
    for entry in &request.entries {
        lines.push(match entry {
            Entry::Fixed(error) => line(*error, true, false, request.model)?,
            Entry::Free(law, _) => {
                let found = free.iter().find(|free| free.law.kind() == law.kind());
                let error = match found.filter(|_| feasible) {
                    Some(free) => largest_tolerance(*law, free.delta_cd, request.model).map_err(of_kind(law.kind()))?,
                    None => nothing(*law),
                };
                line(error, false, found.is_some_and(|free| free.at_own_limit), request.model)?
            }
        });
    }
    finish(lines, Some(bound), squares, None, broken_by)
}

/// A free error while shares are found.
struct Free {
    law: Law,
    ratio: f64,
    own: Option<Length>,
    delta_cd: Length,
    at_own_limit: bool,
}

/// Divides `left`, in fm or fm², among the free errors in their ratios, none beyond its own limit.
#[expect(clippy::cast_precision_loss, reason = "cut off to what is left afterwards")]
fn share_out(free: &mut [Free], mut left: i128, squares: bool) {
    let weight = |ratio: f64| if squares { ratio * ratio } else { ratio };
    loop {
        let mut open: Vec<&mut Free> = free.iter_mut().filter(|free| !free.at_own_limit).collect();
        let sum: f64 = open.iter().map(|free| weight(free.ratio)).sum();
        if sum == 0.0 {
            return;
        }
        let mut rest = left;
        let mut stopped = false;
        for free in &mut open {
            let part = left as f64 * (weight(free.ratio) / sum);
            // never more in all than there is to share
            free.delta_cd = cut_off(if squares { part.sqrt() } else { part }).min(affordable(rest, squares));
            rest -= taken(free.delta_cd, squares);
            if let Some(own) = free.own.filter(|own| *own < free.delta_cd) {
                free.delta_cd = own;
                free.at_own_limit = true;
                stopped = true;
            }
        }
        if !stopped {
            return;
        }
        // start again with what those at their own limits leave
        left -= open.iter().filter(|free| free.at_own_limit).map(|free| taken(free.delta_cd, squares)).sum::<i128>();
    }
}

/// A share in fm, cut off to the grid; a whole number that rounding left just below itself is that number.
#[expect(clippy::cast_possible_truncation, reason = "saturates, and no more than what is left is taken")]
fn cut_off(fm: f64) -> Length {
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    Length::from_fm((fm * (1.0 + ROUNDING)).floor() as i64)
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
    let sum: i128 = lines.iter().map(|line| taken(line.delta_cd, squares)).sum();
    for line in &mut lines {
        #[expect(clippy::cast_precision_loss, reason = "16 digits of a share")]
        if sum != 0 {
            line.share = taken(line.delta_cd, squares) as f64 / sum as f64;
        }
    }
    let terms: Vec<Term> = lines
        .iter()
        .map(|line| Term { kind: line.error.kind(), delta_cd: line.delta_cd, is_tolerance: true })
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
                Entry::Fixed(error) => *error,
                Entry::Free(law, freedom) => {
                    let share = Length::from_mm(scale * ratio(*freedom, request.rule));
                    let share = share.map_err(|error| of_kind(law.kind())(error.into()))?;
                    let own = own_bound(request, law.kind());
                    let share = own.filter(|own| *own < share).unwrap_or(share);
                    match largest_tolerance(*law, share, request.model) {
                        Ok(error) => error,
                        // beyond what any angle does: as good as unbounded
                        Err(DomainError::NeverReached { .. }) => return Err(BudgetError::Unbounded),
                        Err(error) => return Err(of_kind(law.kind())(error)),
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
                Entry::Fixed(error) if !without.contains(&error.kind()) => *error,
                Entry::Fixed(error) => nothing(error.law()),
                Entry::Free(law, _) => nothing(*law),
            })
            .collect();
        if assembly.count(&rest) >= assembly.needed() {
            break;
        }
    }
    Ok(without)
}
