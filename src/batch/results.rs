//! The results of one part in integers of 1e-15 mm, and what they say about the limits. Called by the row evaluator;
//! says nothing where its bounds do not decide.

use super::layout::Layout;
use super::limits::{Holds, Judged};
use super::output::{Of, Output};
use super::plan::Plan;
use crate::decision::monte_carlo::{PartSimulation, Simulation};
use crate::decision::rule::{Ends, ISO_14253_FACTOR};
use crate::decision::uncertainty::{Point, Spread, Spreads};
use crate::decision::{Evaluation, LimitTarget, Stack, Verdict};
use crate::deviation::ErrorKind;
use crate::formula::Fixed;
use crate::quantity::{Length, Rational};

pub(super) const KINDS: usize = ErrorKind::ALL.len();

/// The results of one part, as far as some output or limit needs them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Results {
    pub(super) each: [Fixed; KINDS],
    pub(super) lower: Fixed,
    pub(super) upper: Fixed,
    pub(super) worst: Fixed,
    pub(super) rss: Fixed,
}

const ZERO: Fixed = Fixed { units: 0, bound: 0 };

/// A verdict, or that it takes exact arithmetic to tell.
pub(super) enum Judgement {
    Known(Option<Verdict>),
    Unsure,
}

impl Results {
    /// The results of the deviations; `None` where they are beyond the integers.
    #[inline]
    pub(super) fn new(plan: &Plan, layout: &Layout, deviations: &[i64; KINDS]) -> Option<Self> {
        let mut results = Results { each: [ZERO; KINDS], lower: ZERO, upper: ZERO, worst: ZERO, rss: ZERO };
        let mut squares = 0.0;
        let mut bounds = 0;
        for (index, source) in plan.sources.iter().enumerate() {
            let deviation = deviations[index];
            let value = if source.kind == ErrorKind::RackLead {
                #[expect(clippy::cast_precision_loss, reason = "one of the three roundings that the bound allows for")]
                source.formula.fixed_from_degrees(deviation as f64 * layout.columns[index].degrees)?
            } else {
                source.formula.fixed(deviation)?
            };
            results.each[index] = value;
            bounds += value.bound;
            // sums of five stay below 2⁶³
            if plan.needs_range {
                if source.kind.always_acts() {
                    results.lower.units += value.units;
                    results.lower.bound += value.bound;
                }
                results.upper.units += value.units;
            }
            if plan.needs_worst {
                results.worst.units += value.units.abs();
            }
            if plan.needs_rss {
                #[expect(clippy::cast_precision_loss, reason = "within the bound below")]
                let value = value.units as f64;
                squares += value * value;
            }
        }
        results.upper.bound = bounds;
        results.worst.bound = bounds;
        if plan.needs_rss {
            results.rss = if let [only] = &results.each[..plan.sources.len()] {
                Fixed { units: only.units.abs(), bound: only.bound }
            } else {
                root(squares, bounds)
            };
        }
        Some(results)
    }

    /// Holds the results against the limits, by the rule.
    #[inline]
    pub(super) fn judge(&self, plan: &Plan) -> Judgement {
        let (mut fails, mut open) = (false, false);
        for limit in &plan.fixed_limits {
            let (lower, upper) = self.judged(limit.on, plan.stack);
            match (limit.accepted.holds(lower, upper), &limit.rejected) {
                (Holds::Yes, _) => {}
                (Holds::No, None) => fails = true,
                (Holds::Unsure, None) => return Judgement::Unsure,
                (accepted, Some(rejected)) => match (accepted, rejected.holds(lower, upper)) {
                    (_, Holds::No) => fails = true,
                    (Holds::No, Holds::Yes) => open = true,
                    _ => return Judgement::Unsure,
                },
            }
        }
        Judgement::Known(overall(plan, fails, open))
    }

    /// The uncertainties of the results; `None` if it takes exact arithmetic to tell.
    pub(super) fn spreads(&self, plan: &Plan, layout: &Layout, deviations: &[i64; KINDS]) -> Option<Spreads> {
        let propagator = &plan.uncertain.as_ref()?.propagator;
        let mut points = [Point::default(); KINDS];
        for (index, source) in plan.sources.iter().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "a rounding that the bound allows for")]
            let deviation = deviations[index] as f64;
            let error = if source.kind == ErrorKind::RackLead {
                deviation * layout.columns[index].degrees
            } else {
                deviation / PER_MM
            };
            points[index] = Point { error, delta_cd_mm: millimetres(self.each[index]) };
        }
        let spreads = propagator.spreads(&points[..plan.sources.len()]);
        spreads.certain.then_some(spreads)
    }

    /// Holds the results against the limits with the guard bands of ISO 14253-1.
    pub(super) fn judge_iso_14253(&self, plan: &Plan, spreads: &Spreads) -> Judgement {
        let (mut fails, mut open) = (false, false);
        for limit in &plan.fixed_limits {
            let (lower, upper) = self.judged(limit.on, plan.stack);
            let (at_lower, at_upper) = match limit.on {
                Judged::Combined => (spreads.lower, spreads.upper),
                Judged::Source(source) => (spreads.errors[source], spreads.errors[source]),
            };
            let (Some(at_lower), Some(at_upper)) = (guard(&at_lower), guard(&at_upper)) else {
                return Judgement::Unsure;
            };
            // the limits moved inwards hold what the results moved outwards are held by
            match limit.nominal.holds(minus(lower, at_lower), plus(upper, at_upper)) {
                Holds::Yes => continue,
                Holds::Unsure => return Judgement::Unsure,
                Holds::No => {}
            }
            match limit.nominal.holds(plus(lower, at_lower), minus(upper, at_upper)) {
                Holds::No => fails = true,
                Holds::Yes => open = true,
                Holds::Unsure => return Judgement::Unsure,
            }
        }
        Judgement::Known(overall(plan, fails, open))
    }

    /// The probability that the limit with that index is met.
    pub(super) fn conformance(&self, plan: &Plan, spreads: &Spreads, limit: usize) -> f64 {
        let (lower, upper) = self.judged(plan.fixed_limits[limit].on, plan.stack);
        let (at_lower, at_upper, correlation) = match plan.fixed_limits[limit].on {
            Judged::Combined => (spreads.lower, spreads.upper, spreads.end_correlation),
            Judged::Source(source) => (spreads.errors[source], spreads.errors[source], 1.0),
        };
        let ends = Ends {
            lower_mm: millimetres(lower),
            upper_mm: millimetres(upper),
            lower_standard_mm: at_lower.standard_mm,
            upper_standard_mm: at_upper.standard_mm,
            correlation,
        };
        ends.conformance(&plan.limits[limit].1)
    }

    /// How far the results are inside the nearest limit (1e-15 mm), which limit that is, and what is held
    /// against it.
    pub(super) fn margin(&self, plan: &Plan) -> (i128, Option<LimitTarget>, (Fixed, Fixed)) {
        let mut nearest: Option<(i128, Option<LimitTarget>, (Fixed, Fixed))> = None;
        for (limit, (on, _)) in plan.fixed_limits.iter().zip(&plan.limits) {
            let (lower, upper) = self.judged(limit.on, plan.stack);
            let above = limit.nominal.upper.map(|(end, _)| i128::from(end) - i128::from(upper.units));
            let below = limit.nominal.lower.map(|(_, end)| i128::from(lower.units) - i128::from(end));
            for margin in [above, below].into_iter().flatten() {
                if nearest.as_ref().is_none_or(|(least, ..)| margin < *least) {
                    nearest = Some((margin, Some(*on), (lower, upper)));
                }
            }
        }
        nearest.unwrap_or_else(|| {
            let largest = plan.quantities().map(|output| self.of(output)).max_by_key(|value| value.units.abs());
            let largest = largest.unwrap_or(ZERO);
            (-i128::from(largest.units.abs()), None, (largest, largest))
        })
    }

    /// The result of an output that is a number.
    #[inline]
    pub(super) fn of(&self, output: &Output) -> Fixed {
        match output {
            Output::Error(source) => self.each[*source],
            Output::RangeLower => self.lower,
            Output::RangeUpper => self.upper,
            Output::WorstCase => self.worst,
            Output::Rss => self.rss,
            _ => ZERO,
        }
    }

    /// The lower and upper end that are held against a limit.
    #[inline]
    fn judged(&self, on: Judged, stack: Stack) -> (Fixed, Fixed) {
        let both = |value: Fixed| (Fixed { units: -value.units, ..value }, value);
        match (on, stack) {
            (Judged::Source(source), _) => (self.each[source], self.each[source]),
            (Judged::Combined, Stack::Range) => (self.lower, self.upper),
            (Judged::Combined, Stack::WorstCase) => both(self.worst),
            (Judged::Combined, Stack::Rss) => both(self.rss),
        }
    }

    /// Exact results as integers, the largest there are where they do not fit.
    pub(super) fn rounded(evaluation: &Evaluation, plan: &Plan) -> Self {
        let of = |length: &Length| {
            let end = if length.is_negative() { -(1 << 62) } else { 1 << 62 };
            Fixed { units: fixed(length).unwrap_or(end), bound: 1 }
        };
        let mut each = [ZERO; KINDS];
        for (value, contribution) in each.iter_mut().zip(&evaluation.contributions) {
            *value = of(contribution.delta_cd(plan.model));
        }
        let combined = &evaluation.combined;
        Self {
            each,
            lower: of(&combined.range_lower),
            upper: of(&combined.range_upper),
            worst: of(&combined.worst_case),
            rss: of(&combined.rss),
        }
    }
}

/// The verdict on a part: a limit that fails decides, then one that could not be judged, then one that is open.
#[inline]
fn overall(plan: &Plan, fails: bool, open: bool) -> Option<Verdict> {
    if fails {
        Some(Verdict::Fail)
    } else if plan.fixed_limits.is_empty() || !plan.unjudged.is_empty() {
        None
    } else if open {
        Some(Verdict::Indeterminate)
    } else {
        Some(Verdict::Pass)
    }
}

const PER_MM: f64 = 1e15;

#[expect(clippy::cast_precision_loss, reason = "a rounding that the bounds allow for")]
fn millimetres(value: Fixed) -> f64 {
    value.units as f64 / PER_MM
}

/// A length that is not negative, known within `rounding_mm`; `None` beyond the integers.
pub(super) fn fixed_spread(mm: f64, rounding_mm: f64) -> Option<Fixed> {
    const LARGEST: f64 = 1e18;
    if mm == 0.0 && rounding_mm == 0.0 {
        return Some(ZERO);
    }
    let (units, bound) = (mm * PER_MM, rounding_mm * PER_MM + mm * PER_MM * 4.0 * f64::EPSILON);
    if units.is_nan() || units >= LARGEST || bound >= LARGEST {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, reason = "below 10¹⁸")]
    Some(Fixed { units: (units + 0.5) as i64, bound: bound as i64 + 2 })
}

/// The guard band of ISO 14253-1.
fn guard(spread: &Spread) -> Option<Fixed> {
    fixed_spread(ISO_14253_FACTOR * spread.standard_mm, ISO_14253_FACTOR * spread.rounding_mm)
}

fn plus(a: Fixed, b: Fixed) -> Fixed {
    Fixed { units: a.units + b.units, bound: a.bound + b.bound }
}

fn minus(a: Fixed, b: Fixed) -> Fixed {
    Fixed { units: a.units - b.units, bound: a.bound + b.bound }
}

/// The uncertainty of a result.
pub(super) fn spread_of(spreads: &Spreads, of: Of) -> &Spread {
    match of {
        Of::Source(source) => &spreads.errors[source],
        Of::Lower => &spreads.lower,
        Of::Upper => &spreads.upper,
    }
}

/// The simulated distribution of a result.
pub(super) fn simulation_of(part: &PartSimulation, of: Of) -> &Simulation {
    match of {
        Of::Source(source) => &part.outcome.results[source],
        Of::Lower => part.lower(),
        Of::Upper => part.upper(),
    }
}

/// √ of a sum of at most five squares of which each root is known within its share of `bound`.
///
/// |∂√Σv²/∂v| ≤ 1, so the bounds add up. Rounding: each v to a double (1 half-ulp), its square (1), four sums
/// (4), which the root halves, and the root itself: below 5 half-ulps; 2⁻⁵⁰ is 8.
#[inline]
fn root(squares: f64, bound: i64) -> Fixed {
    let root = squares.sqrt();
    #[expect(clippy::cast_possible_truncation, reason = "five values below 2⁶⁰ have a root below 2⁶²")]
    let units = (root + 0.5) as i64;
    Fixed { units, bound: bound + (units >> 50) + 2 }
}

/// The exact result of an output that is a number.
pub(super) fn exact_result<'e>(evaluation: &'e Evaluation, plan: &Plan, output: &Output) -> Option<&'e Length> {
    let combined = &evaluation.combined;
    Some(match output {
        Output::Error(source) => evaluation.contributions[*source].delta_cd(plan.model),
        Output::RangeLower => &combined.range_lower,
        Output::RangeUpper => &combined.range_upper,
        Output::WorstCase => &combined.worst_case,
        Output::Rss => &combined.rss,
        _ => return None,
    })
}

/// A length in 1e-15 mm, rounded; `None` beyond what statistics hold.
pub(super) fn fixed(length: &Length) -> Option<i64> {
    let scaled = length.exact_mm() * &Rational::integer(Fixed::PER_MM);
    i64::try_from(scaled.to_fixed_point(0)).ok().filter(|units| units.unsigned_abs() < 1 << 62)
}
