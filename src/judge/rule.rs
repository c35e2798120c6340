#![doc = include_str!("rule.md")]
//!
//! Called after an evaluation, with the uncertainty of its results; propagates nothing itself.

use super::{Interval, Limit, Verdict};
use crate::deviation::DeviationKind;
use crate::quantity::{Length, LengthUnit, QuantityError, plain};
use crate::statistics::{bivariate_normal_cdf, normal_cdf, student_cdf};

/// Guard band of ISO 14253-1 in standard uncertainties: 95 % one-sided, as the standard rounds it.
pub const ISO_14253_FACTOR: f64 = 1.65;

/// Conformance probability of ISO 14253-1.
pub const ISO_14253_PROBABILITY: f64 = 0.95;

/// The rule by which a verdict is reached.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Rule {
    /// By the measured value alone.
    #[default]
    Simple,
    /// ISO 14253-1: with a guard band of 1.65 standard uncertainties.
    Iso14253,
    /// With a given guard band.
    Guard(Length),
}

impl Rule {
    /// Whether the rule needs an uncertainty.
    #[must_use]
    pub const fn needs_uncertainty(&self) -> bool {
        matches!(self, Self::Iso14253)
    }

    /// Why the rule judges nothing without the uncertainties of these errors.
    pub(crate) fn lacks_uncertainty(&self, of: impl Iterator<Item = DeviationKind>) -> String {
        let needs = format!("the rule {self} needs an uncertainty of every value");
        match DeviationKind::keys(of) {
            keys if keys.is_empty() => needs,
            keys => format!("{needs}, and none is given of {keys}"),
        }
    }

    /// The rule's name for people.
    #[must_use]
    pub fn in_words(&self) -> String {
        match self {
            Self::Simple => "simple".to_owned(),
            Self::Iso14253 => "ISO 14253-1".to_owned(),
            Self::Guard(guard) => format!("guard {} µm", plain(guard.in_unit(LengthUnit::Micrometre))),
        }
    }

    /// The limit within which a value passes by this rule, as far as that does not depend on an uncertainty.
    #[must_use]
    pub fn accepted(&self, limit: &Limit) -> Limit {
        let Self::Guard(band) = *self else { return *limit };
        limit.narrowed(band, band)
    }
}

impl std::fmt::Display for Rule {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Simple => f.write_str("simple"),
            Self::Iso14253 => f.write_str("iso14253"),
            Self::Guard(value) => write!(f, "guard={value}"),
        }
    }
}

/// Why a text is no decision rule.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RuleError {
    /// No known rule has this name.
    #[error("`{0}` is not a decision rule: write simple, iso14253 or guard=VALUE")]
    Unknown(String),
    /// The guard band is not a length.
    #[error(transparent)]
    NoLength(#[from] QuantityError),
    /// The guard band is below 0.
    #[error("the guard band {0} is negative: it must be 0 or more")]
    Negative(Length),
}

impl std::str::FromStr for Rule {
    type Err = RuleError;

    fn from_str(text: &str) -> Result<Self, RuleError> {
        match text.trim() {
            "simple" => Ok(Self::Simple),
            "iso14253" => Ok(Self::Iso14253),
            other => {
                let Some(value) = other.strip_prefix("guard=") else {
                    return Err(RuleError::Unknown(text.to_owned()));
                };
                let guard: Length = value.parse()?;
                if guard.is_negative() {
                    return Err(RuleError::Negative(guard));
                }
                Ok(Self::Guard(guard))
            }
        }
    }
}

/// A result from its lower to its upper end, with the uncertainty of both; mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ends {
    /// The lower end.
    pub lower_mm: f64,
    /// The upper end.
    pub upper_mm: f64,
    /// Standard uncertainty of the lower end.
    pub lower_standard_mm: f64,
    /// Standard uncertainty of the upper end.
    pub upper_standard_mm: f64,
    /// Correlation of both ends.
    pub correlation: f64,
    /// How the lower end is distributed.
    pub lower_tail: Tail,
    /// How the upper end is distributed.
    pub upper_tail: Tail,
}

/// How an end is distributed beyond its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tail {
    /// Effective degrees of freedom of its standard uncertainty; `None` where that is not known.
    pub dof: Option<f64>,
    /// The number of magnitudes in this end so near to 0 that either sign may count; `None` where inputs are correlated, because
    /// other signs may then spread wider.
    pub folds: Option<u8>,
    /// How many other strokes of a mesh may hold this end.
    pub rivals: u32,
}

impl Tail {
    /// A normal distribution.
    pub const NORMAL: Self = Self { dof: Some(f64::INFINITY), folds: Some(0), rivals: 0 };

    /// Upper bound of the probability Q that the end lies so many standard uncertainties beyond its value. Either sign of n
    /// magnitudes, and each rival stroke, makes another normal end that is at most as far. Student's t for finite degrees of
    /// freedom. Without a limit nothing lies beyond it.
    fn beyond(self, distance: Option<f64>) -> Option<f64> {
        let Some(distance) = distance else { return Some(0.0) };
        let (folds, dof) = (self.folds?, self.dof?);
        if distance.is_infinite() {
            return Some(if distance > 0.0 { 0.0 } else { 1.0 });
        }
        let of_one = if dof.is_finite() { student_cdf(-distance, dof) } else { normal_cdf(-distance) };
        Some((f64::from(1_u32 << folds) * (1.0 + f64::from(self.rivals)) * of_one).min(1.0))
    }
}

impl Ends {
    /// A single value, normally distributed.
    #[must_use]
    pub const fn value(value_mm: f64, standard_mm: f64) -> Self {
        Self {
            lower_mm: value_mm,
            upper_mm: value_mm,
            lower_standard_mm: standard_mm,
            upper_standard_mm: standard_mm,
            correlation: 1.0,
            lower_tail: Tail::NORMAL,
            upper_tail: Tail::NORMAL,
        }
    }

    /// Whether nothing is known of how an end is distributed.
    fn is_unknown(&self) -> bool {
        self.lower_tail.dof.is_none() || self.upper_tail.dof.is_none()
    }

    /// Whether the probability of conformance is exact: otherwise it is a lower bound.
    #[must_use]
    pub fn is_normal(&self) -> bool {
        [self.lower_tail, self.upper_tail] == [Tail::NORMAL; 2]
    }

    /// How far both ends are inside their limits, in standard uncertainties; `None` where there is no limit.
    fn distances(&self, limit: &Limit) -> (Option<f64>, Option<f64>) {
        let reduced = |distance: f64, standard: f64| match standard {
            // a value on the limit is inside
            0.0 if distance >= 0.0 => f64::INFINITY,
            0.0 => f64::NEG_INFINITY,
            _ => distance / standard,
        };
        let below = limit.lower.map(|lower| reduced(self.lower_mm - lower.mm(), self.lower_standard_mm));
        let above = limit.upper.map(|upper| reduced(upper.mm() - self.upper_mm, self.upper_standard_mm));
        (below, above)
    }

    /// The probability that both ends lie inside `limit`, if both are jointly normal, else a lower bound of it. `None` where
    /// the distribution of an end with correlated inputs is not known, and where the lower bound says nothing.
    #[must_use]
    pub fn conformance(&self, limit: &Limit) -> Option<f64> {
        let (h, k) = self.distances(limit);
        if !self.is_normal() {
            let least = 1.0 - self.lower_tail.beyond(h)? - self.upper_tail.beyond(k)?;
            return (least > 0.0).then_some(least);
        }
        let [h, k] = [h, k].map(|distance| distance.unwrap_or(f64::INFINITY));
        // the lower end must not be too low, the upper one not too high: opposite directions
        let rho = -self.correlation;
        let is_one = rho < -1.0 + 1e-9;
        Some(if is_one { (normal_cdf(h) - normal_cdf(-k)).max(0.0) } else { bivariate_normal_cdf(h, k, rho) })
    }

    /// Whether a verdict by the guard band of one limit has a probability of 95 %: both limits may be near, and the ends need not
    /// be normal.
    fn proves(&self, verdict: Verdict, limit: &Limit) -> bool {
        match verdict {
            Verdict::Pass => self.conformance(limit).is_some_and(|probability| probability >= ISO_14253_PROBABILITY),
            Verdict::Fail => {
                let (low, high) = self.distances(limit);
                let is_beyond = |distance: Option<f64>, tail: Tail| {
                    let risk =
                        distance.and_then(|inside| Tail { folds: Some(0), rivals: 0, ..tail }.beyond(Some(-inside)));
                    risk.is_some_and(|risk| risk <= 1.0 - ISO_14253_PROBABILITY)
                };
                is_beyond(low, self.lower_tail) || is_beyond(high, self.upper_tail)
            }
            Verdict::Indeterminate => true,
        }
    }
}

/// How probable conformity is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conformance {
    /// The probability of conformance p_c.
    pub probability: f64,
    /// Whether p_c was counted in a simulation; otherwise it follows from the linear result.
    pub simulated: bool,
    /// Whether p_c is a lower bound, because an end is not normally distributed.
    pub is_least: bool,
}

impl Conformance {
    /// p_c as simulated, else by the linear result; `None` where neither gives one.
    #[must_use]
    pub fn of(limit: &Limit, ends: Option<&Ends>, simulated: Option<f64>) -> Option<Self> {
        match (counting(ends, simulated), ends) {
            (Some(probability), _) => Some(Self { probability, simulated: true, is_least: false }),
            (None, Some(ends)) => {
                let is_least = !ends.is_normal();
                ends.conformance(limit).map(|probability| Self { probability, simulated: false, is_least })
            }
            (None, None) => None,
        }
    }

    /// The specific consumer's risk: that the part, accepted, does not conform.
    #[must_use]
    pub fn consumer_risk(&self) -> f64 {
        1.0 - self.probability
    }

    /// The specific producer's risk: that the part, rejected, does conform.
    #[must_use]
    pub const fn producer_risk(&self) -> f64 {
        self.probability
    }
}

/// How a rule decided about one limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// The guard bands at the lower and the upper limit; `None` where the rule has none, or a simulated probability
    /// decided.
    pub guard: Option<(Length, Length)>,
    /// The probability of conformance, where uncertainties are given.
    pub conformance: Option<Conformance>,
    /// The verdict.
    pub verdict: Verdict,
}

/// Decides about one limit. `result` is exact from its lower to its upper end, `ends` has the uncertainty of both,
/// `simulated` is the probability of conformance by simulation. Without `ends` and `simulated` `iso14253` decides nothing.
///
/// # Errors
/// [`QuantityError`] if a guard band is beyond the range of numbers.
pub fn decide(
    rule: &Rule,
    limit: &Limit,
    result: Interval,
    ends: Option<&Ends>,
    simulated: Option<f64>,
) -> Result<Decision, QuantityError> {
    let (verdict, guard) = verdict(rule, limit, result, ends, simulated)?;
    Ok(Decision { guard, conformance: Conformance::of(limit, ends, simulated), verdict })
}

/// The simulated probability, if it counts. It does not where the draws cancel, or where another stroke of a mesh may hold an
/// end, because draws move the ends only.
fn counting(ends: Option<&Ends>, simulated: Option<f64>) -> Option<f64> {
    let has_rivals = |ends: &Ends| ends.lower_tail.rivals + ends.upper_tail.rivals > 0;
    simulated.filter(|_| !ends.is_some_and(|ends| ends.is_unknown() || has_rivals(ends)))
}

/// The verdict on a result, from its lower to its upper end, with the uncertainties of both, or its simulated
/// probability of conformance; and the guard bands at the lower and the upper limit that led to it, if the rule has any.
///
/// # Errors
/// [`QuantityError`] if a guard band is beyond the largest length.
#[inline]
pub(crate) fn verdict(
    rule: &Rule,
    limit: &Limit,
    result: Interval,
    ends: Option<&Ends>,
    simulated: Option<f64>,
) -> Result<(Verdict, Option<(Length, Length)>), QuantityError> {
    let band = |standard_mm: f64| Length::nearest(ISO_14253_FACTOR * standard_mm * 1e12, "the guard band");
    let guard = match (rule, counting(ends, simulated)) {
        (Rule::Iso14253, Some(probability)) if probability >= ISO_14253_PROBABILITY => {
            return Ok((Verdict::Pass, None));
        }
        (Rule::Iso14253, Some(probability)) if probability <= 1.0 - ISO_14253_PROBABILITY => {
            return Ok((Verdict::Fail, None));
        }
        (Rule::Iso14253, Some(_)) => return Ok((Verdict::Indeterminate, None)),
        (Rule::Iso14253, None) => match ends {
            Some(ends) => Some((band(ends.lower_standard_mm)?, band(ends.upper_standard_mm)?)),
            None => return Ok((Verdict::Indeterminate, None)),
        },
        (Rule::Simple, _) => None,
        (Rule::Guard(guard), _) => Some((*guard, *guard)),
    };
    let verdict = judge(limit, result, guard);
    let is_proven = match (rule, ends) {
        (Rule::Iso14253, Some(ends)) => ends.proves(verdict, limit),
        _ => true,
    };
    Ok((if is_proven { verdict } else { Verdict::Indeterminate }, guard))
}

/// Compares a result, from its lower to its upper end, with a limit and its guard bands: inside the limit moved inwards it
/// passes, outside the limit moved outwards it fails.
fn judge(limit: &Limit, result: Interval, guard: Option<(Length, Length)>) -> Verdict {
    let Some((at_lower, at_upper)) = guard else { return limit.judge(result) };
    let [inwards, outwards] = [limit.narrowed(at_lower, at_upper), limit.narrowed(-at_lower, -at_upper)];
    match (inwards.judge(result), outwards.judge(result)) {
        (Verdict::Pass, _) => Verdict::Pass,
        (_, Verdict::Fail) => Verdict::Fail,
        _ => Verdict::Indeterminate,
    }
}

#[cfg(test)]
mod tests;
