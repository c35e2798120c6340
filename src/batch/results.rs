//! The results of one part in integers of 1e-15 mm, and what they say about the limits.

use super::layout::Layout;
use super::plan::{Holds, Judged, Output, Plan};
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
        Judgement::Known(if fails {
            Some(Verdict::Fail)
        } else if plan.fixed_limits.is_empty() || !plan.unjudged.is_empty() {
            None
        } else if open {
            Some(Verdict::Indeterminate)
        } else {
            Some(Verdict::Pass)
        })
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
            Output::Id | Output::Verdict | Output::Copied(_) => ZERO,
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
        Output::Id | Output::Verdict | Output::Copied(_) => return None,
    })
}

/// A length in 1e-15 mm, rounded; `None` beyond what statistics hold.
pub(super) fn fixed(length: &Length) -> Option<i64> {
    let scaled = length.exact_mm() * &Rational::integer(Fixed::PER_MM);
    i64::try_from(scaled.to_fixed_point(0)).ok().filter(|units| units.unsigned_abs() < 1 << 62)
}
