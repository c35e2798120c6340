//! Mean and spread of an error at one stroke, for a statistical sum. Bounds nothing.

use super::error::ErrorEffect;
use super::single::range_of;
use super::{ErrorRange, ExtendedError, Extent, Knowledge, NoBound};
use crate::deviation::Part;

/// Mean and standard deviation of ΔCD, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moments {
    /// Mean.
    pub(super) mean_mm: f64,
    /// Standard deviation.
    pub(super) deviation_mm: f64,
}

/// Of a normal x whose tolerance is 3σ, |x| has this mean and this standard deviation, as shares of the tolerance:
/// √(2/π)/3 and √(1 − 2/π)/3.
const FOLDED_MEAN: f64 = 0.265_961_520_267_621_8;
const FOLDED_DEVIATION: f64 = 0.200_936_803_059_955_2;

impl Moments {
    /// Of a tolerance, of whose two ends these are the moments: what it does grows in proportion to it, either way.
    fn or(self, other: Self) -> Self {
        let mean_mm = FOLDED_MEAN * 0.5 * (self.mean_mm + other.mean_mm);
        let square = |of: Self| of.mean_mm * of.mean_mm + of.deviation_mm * of.deviation_mm;
        let variance = 0.5 * (square(self) + square(other)) / 9.0 - mean_mm * mean_mm;
        Self { mean_mm, deviation_mm: variance.max(0.0).sqrt() }
    }
}

/// Mean and spread of one error at any one stroke, which does this range alone. A tolerance is 3σ of a normal distribution.
/// A measured size or lead acts with its value; a measured step acts during its share of the stroke, or always if the
/// geometry is not known.
///
/// # Errors
/// [`NoBound`] if it follows from a range that there is not.
#[inline]
pub(super) fn moments(
    error: &ExtendedError,
    range: Result<ErrorRange, NoBound>,
    knowledge: &Knowledge,
) -> Result<Moments, NoBound> {
    let Some([one, other]) = error.signs() else { return of_signed(error, range, knowledge) };
    let of = |error: &ExtendedError| of_signed(error, range_of(error, knowledge), knowledge);
    Ok(of(&one)?.or(of(&other)?))
}

/// The same of an error with a sign.
#[inline]
fn of_signed(
    error: &ExtendedError,
    range: Result<ErrorRange, NoBound>,
    knowledge: &Knowledge,
) -> Result<Moments, NoBound> {
    let fixed = |mean_mm| Moments { mean_mm, deviation_mm: 0.0 };
    let folded = |largest: f64| Moments { mean_mm: FOLDED_MEAN * largest, deviation_mm: FOLDED_DEVIATION * largest };
    let value = error.value;
    Ok(match (error.effect, error.extent) {
        (ErrorEffect::Size, Extent::Each) => Moments { mean_mm: 0.0, deviation_mm: value.abs() / 3.0 },
        (ErrorEffect::Size, _) => fixed(value),
        (ErrorEffect::Pitch { .. }, Extent::Total) => Moments { mean_mm: 0.0, deviation_mm: range?.upper_mm / 3.0 },
        (ErrorEffect::Pitch { gain, .. }, Extent::Each) => folded(gain * value.abs()),
        (ErrorEffect::Pitch { gain, .. }, Extent::One) => {
            let share = share_of_stroke(error.part, value, knowledge);
            let step = gain * value.abs();
            Moments { mean_mm: step * share, deviation_mm: step * (share * (1.0 - share)).sqrt() }
        }
        // between the least and the most of what adds up
        (ErrorEffect::Pitch { .. }, _) => {
            let ErrorRange { lower_mm, upper_mm, .. } = range?;
            fixed(0.5 * (lower_mm + upper_mm))
        }
        (ErrorEffect::RackLead(_) | ErrorEffect::PinionLead { .. }, Extent::Each) => folded(range?.upper_mm),
        (ErrorEffect::RackLead(_) | ErrorEffect::PinionLead { .. }, _) => fixed(range?.upper_mm),
    })
}

/// The pitches of stroke during which a step acts, at most one.
fn share_of_stroke(part: Part, value: f64, knowledge: &Knowledge) -> f64 {
    let Some(known) = knowledge.pair else { return 1.0 };
    let path = known.nominal;
    let offset = match part {
        Part::Rack => 2.0 * path.offset * value.signum(),
        Part::Pinion => (1.0 - 2.0 * path.offset) * value.signum(),
    };
    (path.ratio - offset - 1.0).clamp(0.0, 1.0)
}
