//! How far scattering errors move ΔCD at one stroke, for a statistical sum. This is no bound.

use super::error::ErrorEffect;
use super::single::range_of;
use super::{ErrorRange, ExtendedError, Extent, Knowledge, NoBound, Range};

/// For a normal x whose tolerance is 3σ: the mean of |x|, and three standard deviations of |x|, as shares of the tolerance:
/// √(2/π)/3 and √(1 − 2/π).
const FOLDED_MEAN: f64 = 0.265_961_520_267_621_8;
const FOLDED_SPREAD: f64 = 0.602_810_289_179_865_6;

/// The joint effect of independent tolerances, mm.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Scatter {
    /// Sums of squares of what three standard deviations of each tolerance lower and raise ΔCD, if each acts with its sign.
    signed: Range,
    /// Sum of squares of what they raise ΔCD, and sum of their means, if every error that can only push does so at every stroke.
    pushing: f64,
    pushing_mean: f64,
}

impl Scatter {
    /// Adds one more tolerance, which is three standard deviations of a normal distribution.
    ///
    /// # Errors
    /// [`NoBound`] if there is no range that it could scatter over.
    pub(super) fn with(self, error: &ExtendedError, knowledge: &Knowledge) -> Result<Self, NoBound> {
        let Range { lower, upper } = three_deviations(error, knowledge)?;
        let square = |mm: f64| mm * mm;
        let only_pushes = error.effect != ErrorEffect::Size;
        let (mean, spread) = if only_pushes { (FOLDED_MEAN, FOLDED_SPREAD) } else { (0.0, 1.0) };
        Ok(Self {
            signed: Range { lower: self.signed.lower + square(lower), upper: self.signed.upper + square(upper) },
            pushing: self.pushing + square(spread * upper),
            pushing_mean: self.pushing_mean + mean * upper,
        })
    }

    /// The range of all but a few values, about 0. An error that can only push acts with its sign where one pair of flanks
    /// carries, and pushes where several carry: the farther of both ends counts.
    pub(super) fn range(&self) -> Range {
        let pushed = self.pushing_mean + self.pushing.sqrt();
        Range { lower: -self.signed.lower.sqrt(), upper: pushed.max(self.signed.upper.sqrt()) }
    }
}

/// How far three standard deviations of a tolerance lower and raise ΔCD beside other errors: as far as its bound, except that
/// independent steps add up as squares.
fn three_deviations(error: &ExtendedError, knowledge: &Knowledge) -> Result<Range, NoBound> {
    let of = |range: ErrorRange| Range { lower: range.raw_lower_mm, upper: range.raw_upper_mm };
    let range = of(range_of(error, knowledge)?);
    let ErrorEffect::Pitch { gain, .. } = error.effect else { return Ok(range) };
    let step = gain * error.value.abs();
    // the pair's geometry says how many add up; the total caps them
    let uncapped = range_of(&error.uncapped(), knowledge).map(of);
    Ok(match (error.extent, uncapped) {
        (Extent::Each, Ok(uncapped)) => Range {
            lower: range.lower.max(-(step * -uncapped.lower).sqrt()),
            upper: range.upper.min((step * uncapped.upper).sqrt()),
        },
        _ => range,
    })
}
