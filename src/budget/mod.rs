#![doc = include_str!("method.md")]
//!
//! The command `budget` calls [`allocate`] with errors of fixed tolerance and errors of free tolerance. Each free tolerance
//! gets a share of what the fixed ones leave of the limit. The formulas and combinations are those of
//! [`evaluate`](crate::evaluation::evaluate). A tolerance is never rounded up beyond the limit.

mod request;
mod simulation;
#[cfg(test)]
mod tests;

use crate::deviation::{DeviationKind, DeviationValue};
use crate::evaluation::EvaluationError;
use crate::formula::{Law, Model, PartDeviation};
use crate::judge::bound::{Basis, ExtendedError, NoBound};
use crate::judge::{Interval, Stack, Verdict};
use crate::quantity::{DomainError, Length};
use request::Allocated;
pub use request::{
    Budget, BudgetError, Entry, Free, Freedom, Line, RandomAssemblies, Request, Summation, ToleranceDistribution,
};
use simulation::Assembly;

fn of_kind(kind: DeviationKind) -> impl Fn(DomainError) -> BudgetError {
    move |problem| EvaluationError { error: Some(kind), problem: Box::new(problem) }.into()
}

/// Finds the free tolerances: the largest ones, in the ratios asked for, with which ΔCD meets its limit.
///
/// # Errors
/// [`BudgetError`] if the limit leaves nothing to distribute, if it does not stop the tolerances, or if a formula has no
/// result. Fixed tolerances that take more than the limit are no error: the budget names them.
pub fn allocate(request: &Request) -> Result<Budget, BudgetError> {
    if request.limit.lower.is_none() && request.limit.upper.is_none() {
        return Err(BudgetError::NoLimit);
    }
    match request.rule {
        Summation::WorstCase => by_scale(request, &|errors| conforms(request, Stack::Range, errors), None),
        Summation::Rss => by_scale(request, &|errors| conforms(request, Stack::Rss, errors), None),
        Summation::Simulation(settings) => {
            let assembly = Assembly::new(request, &settings);
            by_scale(request, &|errors| Ok(assembly.count(errors)? >= assembly.needed()), Some(&assembly))
        }
    }
}

/// Whether a combination of tolerances lies inside the limit.
fn conforms(request: &Request, stack: Stack, errors: &[PartDeviation]) -> Result<bool, NoBound> {
    let combined = request.basis.bound_of(errors).combined.nearest().map_err(|_| NoBound::TooLarge)?;
    Ok(request.limit.judge(combined.interval(combined.judged(stack))?) == Verdict::Pass)
}

/// The range of ΔCD of one error alone.
fn alone(error: PartDeviation, basis: &Basis) -> Result<Interval, NoBound> {
    let range = basis.alone(&ExtendedError::of(&error)?)?;
    Interval::nearest(range.alone()).map_err(|_| NoBound::TooLarge)
}

/// Whether every error stays inside its own limit, judged beside the others as `evaluate` does: with larger errors more teeth
/// carry.
fn within_own_limits(request: &Request, errors: &[PartDeviation]) -> Result<bool, NoBound> {
    if request.own_limits.is_empty() {
        return Ok(true);
    }
    let bound = request.basis.bound_of(errors);
    for (error, range) in errors.iter().zip(bound.errors) {
        if let Some((_, limit)) = request.own_limits.iter().find(|(of, _)| *of == error.kind()) {
            let range = Interval::nearest(range?.alone()).map_err(|_| NoBound::TooLarge)?;
            if limit.judge(range) != Verdict::Pass {
                return Ok(false);
            }
        }
    }
    Ok(true)
}

/// The ratio in which a free error's ΔCD stands to the others'.
fn ratio(freedom: Freedom, rule: Summation) -> f64 {
    match (freedom, rule) {
        (Freedom::Weight(weight), _) => weight,
        (Freedom::Cost(cost), Summation::WorstCase) => cost.sqrt(),
        (Freedom::Cost(cost), Summation::Rss | Summation::Simulation(_)) => libm::cbrt(cost),
    }
}

/// The largest tolerance whose ΔCD does not exceed `delta_cd`.
fn largest_tolerance(free: &Free, delta_cd: Length, model: Model) -> Result<PartDeviation, BudgetError> {
    match free.law.largest_error(delta_cd, model) {
        Ok(value) => Ok(free.within(value)),
        // no angle reaches this ΔCD
        Err(DomainError::NeverReached { .. }) => Err(BudgetError::Unbounded),
        Err(error) => Err(of_kind(free.law.kind())(error)),
    }
}

/// The magnitude of ΔCD of an error's tolerance.
fn magnitude(error: &PartDeviation, model: Model) -> Result<Length, BudgetError> {
    Ok(error.delta_cd(model).map_err(of_kind(error.kind()))?.abs())
}

/// Fixed errors whose tolerance exceeds their own limit.
fn beyond_own_limits(request: &Request) -> Vec<DeviationKind> {
    let fixed = request.entries.iter().filter_map(|entry| match entry {
        Entry::Fixed(error) => Some(error),
        Entry::Free(..) => None,
    });
    fixed
        .filter(|error| within_own_limits(request, std::slice::from_ref(*error)) != Ok(true))
        .map(PartDeviation::kind)
        .collect()
}

fn line(error: PartDeviation, is_fixed: bool, request: &Request) -> Result<Line, BudgetError> {
    let delta_cd = magnitude(&error, request.model)?;
    let sensitivities = error.sensitivities(request.model).map_err(of_kind(error.kind()))?;
    let range = alone(error, &request.basis)?;
    Ok(Line { error, delta_cd, range, is_fixed, at_own_limit: false, share: 0.0, sensitivities })
}

/// Whether tolerances conform; [`NoBound`] if there is no bound for tolerances as large.
type Conforms<'a> = &'a dyn Fn(&[PartDeviation]) -> Result<bool, NoBound>;

fn by_scale(request: &Request, conforms: Conforms<'_>, assembly: Option<&Assembly>) -> Result<Budget, BudgetError> {
    let scaled = Scaled::new(request)?;
    let conforms: Conforms<'_> = &|errors| Ok(conforms(errors)? && within_own_limits(request, errors)?);
    let mut broken_by = beyond_own_limits(request);
    let none = scaled.at(0.0)?;
    let is_free = |entry: &Entry| matches!(entry, Entry::Free(..));
    let mut allocated = Allocated { scale: 0.0, errors: none.clone() };
    if !conforms(&none).unwrap_or(false) {
        broken_by.extend(breaking(&scaled, conforms)?);
    } else if request.entries.iter().any(is_free) && broken_by.is_empty() {
        allocated = scaled.largest(conforms)?;
        if !scaled.gives_something(&allocated.errors) {
            broken_by.extend(breaking(&scaled, conforms)?);
            allocated = Allocated { scale: 0.0, errors: none };
        }
    }
    let mut lines = Vec::with_capacity(allocated.errors.len());
    for (index, error) in allocated.errors.iter().enumerate() {
        let mut line = line(*error, !is_free(&request.entries[index]), request)?;
        line.at_own_limit = scaled.is_at_own_limit(index, allocated.scale);
        lines.push(line);
    }
    set_shares(&mut lines, request.rule != Summation::WorstCase);
    let bound = request.basis.bound_of(&allocated.errors);
    let combined = bound
        .combined
        .nearest()
        .map_err(|problem| EvaluationError { error: None, problem: Box::new(problem.into()) })?;
    let conforming = assembly.map(|assembly| assembly.conforming(&allocated.errors)).transpose()?;
    broken_by.sort();
    broken_by.dedup();
    Ok(Budget { lines, combined, notes: bound.notes, conforming, broken_by })
}

/// The free tolerances of a request at a scale: the ΔCD of each is the scale, mm, times its ratio.
struct Scaled<'a> {
    request: &'a Request,
    /// The largest ΔCD that each entry's own limit allows, if that stops it.
    own: Vec<Option<Length>>,
}

/// The scale below which a free tolerance counts as 0, mm.
const SMALL_MM: f64 = 1e-6;

impl<'a> Scaled<'a> {
    fn new(request: &'a Request) -> Result<Self, BudgetError> {
        let mut scaled = Self { request, own: vec![None; request.entries.len()] };
        // tolerances of every tooth have a bound only if the pair is known
        if let Err(open @ (NoBound::TeethInContactUnknown | NoBound::OwnCurveUnknown)) =
            request.basis.bound_of(&scaled.at(SMALL_MM)?).combined.range
        {
            return Err(open.into());
        }
        for (index, entry) in request.entries.iter().enumerate() {
            if let Entry::Free(free) = entry {
                scaled.own[index] = own_share(free, request)?;
            }
        }
        Ok(scaled)
    }

    fn at(&self, scale: f64) -> Result<Vec<PartDeviation>, BudgetError> {
        let entries = self.request.entries.iter().zip(&self.own);
        let at = |(entry, own): (&Entry, &Option<Length>)| match entry {
            Entry::Fixed(error) => Ok(*error),
            Entry::Free(free) => {
                let share = length_of(free.law, scale * ratio(free.freedom, self.request.rule))?;
                largest_tolerance(free, own.map_or(share, |own| own.min(share)), self.request.model)
            }
        };
        entries.map(at).collect()
    }

    /// The tolerances at the largest scale.
    fn largest(&self, conforms: Conforms<'_>) -> Result<Allocated, BudgetError> {
        let Allocated { scale, errors } = match self.all_at_own_limits()? {
            Some(all) if conforms(&all.errors) == Ok(true) => all,
            _ => simulation::largest_scale(|scale| self.at(scale), conforms)?,
        };
        Ok(Allocated { scale, errors: self.with_short_decimals(errors, conforms)? })
    }

    /// The tolerances if only own limits stop them; `None` if a free one has no own limit.
    fn all_at_own_limits(&self) -> Result<Option<Allocated>, BudgetError> {
        let mut scale: f64 = 0.0;
        for (entry, own) in self.request.entries.iter().zip(&self.own) {
            let Entry::Free(free) = entry else { continue };
            let (Some(own), ratio) = (own, ratio(free.freedom, self.request.rule)) else { return Ok(None) };
            if ratio > 0.0 {
                // large enough that the own limit stops this one
                scale = scale.max(2.0 * own.mm() / ratio);
            }
        }
        Ok(Some(Allocated { scale, errors: self.at(scale)? }))
    }

    /// Whether every free error with a weight gets a tolerance.
    fn gives_something(&self, errors: &[PartDeviation]) -> bool {
        self.request.entries.iter().zip(errors).all(|(entry, error)| match entry {
            Entry::Free(free) => ratio(free.freedom, self.request.rule) == 0.0 || !error.value().is_zero(),
            Entry::Fixed(_) => true,
        })
    }

    /// The tolerances, each rounded up to fewer decimals if it still conforms.
    fn with_short_decimals(
        &self,
        mut errors: Vec<PartDeviation>,
        conforms: Conforms<'_>,
    ) -> Result<Vec<PartDeviation>, BudgetError> {
        for index in 0..errors.len() {
            let Entry::Free(free) = self.request.entries[index] else { continue };
            let share = magnitude(&errors[index], self.request.model)?;
            let rounded = Length::from_fm((share.fm() + ROUNDED_FM - 1) / ROUNDED_FM * ROUNDED_FM);
            let longer = std::mem::replace(&mut errors[index], largest_tolerance(&free, rounded, self.request.model)?);
            let is_inside =
                conforms(&errors) == Ok(true) && within_own_limits(self.request, &errors[index..=index]) == Ok(true);
            if !is_inside {
                errors[index] = longer;
            }
        }
        Ok(errors)
    }

    /// Whether its own limit stops an entry at this scale.
    fn is_at_own_limit(&self, index: usize, scale: f64) -> bool {
        let Entry::Free(free) = self.request.entries[index] else { return false };
        let share = scale * ratio(free.freedom, self.request.rule);
        self.own[index].is_some_and(|own| share > own.mm() * (1.0 + OWN_LIMIT_NEAR))
    }
}

/// An own limit stops a share that is larger by more than this, relative to the limit: the scale is no more precise.
const OWN_LIMIT_NEAR: f64 = 1e-9;

fn length_of(law: Law, mm: f64) -> Result<Length, BudgetError> {
    Length::from_mm(mm).map_err(|error| of_kind(law.kind())(error.into()))
}

/// The ΔCD up to which an error stays inside its own limit; `None` if it has none, or none that stops it.
fn own_share(free: &Free, request: &Request) -> Result<Option<Length>, BudgetError> {
    if !request.own_limits.iter().any(|(kind, _)| *kind == free.law.kind()) {
        return Ok(None);
    }
    let at = |scale: f64| Ok(vec![largest_tolerance(free, length_of(free.law, scale)?, request.model)?]);
    match simulation::largest_scale(at, |errors| within_own_limits(request, errors)) {
        Ok(largest) => Ok(Some(magnitude(&largest.errors[0], request.model)?)),
        Err(BudgetError::Unbounded) => Ok(None),
        Err(error) => Err(error),
    }
}

/// The step to which the ΔCD of a tolerance is rounded up if it still conforms: 1e-9 mm.
const ROUNDED_FM: i64 = 1_000;

/// Sets the share of each line in the sum of the errors' ΔCD alone, or in the sum of their squares.
fn set_shares(lines: &mut [Line], squares: bool) {
    let taken = |line: &Line| {
        let magnitude = line.range.largest().abs().mm();
        if squares { magnitude * magnitude } else { magnitude }
    };
    let sum: f64 = lines.iter().map(taken).sum();
    for line in lines {
        line.share = if sum > 0.0 { taken(line) / sum } else { 0.0 };
    }
}

/// The fixed errors, largest first, without which the others conform and leave something to the free ones.
fn breaking(scaled: &Scaled<'_>, conforms: Conforms<'_>) -> Result<Vec<DeviationKind>, BudgetError> {
    let request = scaled.request;
    let mut rest = scaled.at(SMALL_MM)?;
    let mut fixed = Vec::new();
    for (index, entry) in request.entries.iter().enumerate() {
        if let Entry::Fixed(error) = entry {
            fixed.push((magnitude(error, request.model)?, index));
        }
    }
    fixed.sort_by(|a, b| b.cmp(a));
    let mut without = Vec::new();
    for (_, index) in fixed {
        rest[index] = rest[index].with_value(DeviationValue::zero(rest[index].kind()));
        without.push(rest[index].kind());
        if conforms(&rest) == Ok(true) {
            return Ok(without);
        }
    }
    Err(conforms(&rest).err().map_or(BudgetError::NoRoom, BudgetError::NoBound))
}
