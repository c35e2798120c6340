//! Limits in integers of 1e-15 mm, for results with a bound on their error. Made by the plan, asked by the row
//! evaluator.

use crate::decision::{Limit, LimitTarget, Limits, Rule};
use crate::deviation::ErrorKind;
use crate::formula::Fixed;
use crate::quantity::{Length, Rational};

/// A limit on the fixed-point results.
#[derive(Debug, Clone)]
pub(super) struct FixedLimit {
    pub(super) on: Judged,
    /// The limit itself.
    pub(super) nominal: Zone,
    /// What is in here passes.
    pub(super) accepted: Zone,
    /// What is not in here fails; `None` if that is all that does not pass.
    pub(super) rejected: Option<Zone>,
}

/// An interval between integers of 1e-15 mm: the greatest that is not above an end, and the least that is not
/// below it; both are the end itself if it is such an integer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Zone {
    pub(super) lower: Option<(i64, i64)>,
    pub(super) upper: Option<(i64, i64)>,
}

/// Whether a zone holds a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Holds {
    Yes,
    No,
    /// The bound on the result's error does not decide it.
    Unsure,
}

impl Zone {
    fn new(limit: &Limit, guard: &Length) -> Self {
        Self {
            lower: limit.lower.as_ref().map(|end| around(&(end + guard))),
            upper: limit.upper.as_ref().map(|end| around(&(end - guard))),
        }
    }

    /// Whether everything from `lower` to `upper` is inside.
    #[inline]
    pub(super) fn holds(&self, lower: Fixed, upper: Fixed) -> Holds {
        let mut holds = Holds::Yes;
        if let Some((below, _)) = self.upper
            && upper.units + upper.bound > below
        {
            if upper.units - upper.bound > below {
                return Holds::No;
            }
            holds = Holds::Unsure;
        }
        if let Some((_, above)) = self.lower
            && lower.units - lower.bound < above
        {
            if lower.units + lower.bound < above {
                return Holds::No;
            }
            holds = Holds::Unsure;
        }
        holds
    }
}

/// What a limit is held against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Judged {
    /// The combination.
    Combined,
    /// The source with that index.
    Source(usize),
}

/// The limits, as far as they can be judged.
#[derive(Default)]
pub(super) struct JudgedLimits {
    pub(super) limits: Limits,
    pub(super) fixed: Vec<FixedLimit>,
    pub(super) unjudged: Vec<LimitTarget>,
}

impl JudgedLimits {
    pub(super) fn new(limits: Limits, rule: &Rule, index: &dyn Fn(ErrorKind) -> Option<usize>) -> Self {
        let mut sorted = Self::default();
        for (on, limit) in limits {
            let held = match on {
                LimitTarget::CenterDistance => Some(Judged::Combined),
                LimitTarget::Error(kind) => index(kind).map(Judged::Source),
            };
            if let Some(held) = held {
                sorted.fixed.push(FixedLimit::new(held, &limit, rule));
                sorted.limits.push((on, limit));
            } else {
                sorted.unjudged.push(on);
            }
        }
        sorted
    }
}

impl FixedLimit {
    fn new(on: Judged, limit: &Limit, rule: &Rule) -> Self {
        let nominal = Zone::new(limit, &Length::ZERO);
        match rule {
            Rule::Guard(guard) if !guard.is_zero() => {
                Self { on, nominal, accepted: Zone::new(limit, guard), rejected: Some(Zone::new(limit, &-guard)) }
            }
            // the guard band of ISO 14253-1 is each part's own
            Rule::Guard(_) | Rule::Simple | Rule::Iso14253 => Self { on, nominal, accepted: nominal, rejected: None },
        }
    }
}

/// The integers of 1e-15 mm next to a length, below and above; both are the length itself if it is one.
fn around(length: &Length) -> (i64, i64) {
    let scaled = length.exact_mm() * &Rational::integer(Fixed::PER_MM);
    // limits beyond the fixed-point results are met by all of them
    let whole = i64::try_from(scaled.to_fixed_point(0));
    let whole = whole.unwrap_or(if length.is_negative() { i64::MIN / 2 } else { i64::MAX / 2 });
    match scaled.partial_cmp(&whole) {
        Some(std::cmp::Ordering::Less) => (whole - 1, whole),
        Some(std::cmp::Ordering::Greater) => (whole, whole + 1),
        _ => (whole, whole),
    }
}
