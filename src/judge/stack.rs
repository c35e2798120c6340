#![doc = include_str!("stack.md")]
//!
//! The evaluation and batches call it; it judges nothing.

use std::fmt;

use crate::judge::bound::{Combined, NoBound, Range};
use crate::quantity::{FM_PER_MM, Length, QuantityError};

named! {
    /// How errors combine to the result that is judged.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    #[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
    #[non_exhaustive]
    pub enum Stack {
        /// The worst case: the bound for errors anywhere on the teeth.
        ///
        /// No placement of these errors on the teeth leaves it.
        #[default]
        #[cfg_attr(feature = "cli", value(name = "worst-case", aliases = ["worst", "range"]))]
        Range = "range",
        /// Tolerances as three standard deviations around the bound of what was measured; no bound.
        ///
        /// Statistical: it holds all but a few of many such parts, at any one stroke.
        Rss = "rss",
    }
}

impl fmt::Display for Stack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Range => "worst case",
            Self::Rss => "statistical (RSS)",
        })
    }
}

/// ΔCD from a lowest to a highest value.
#[cfg_attr(feature = "report", derive(serde::Serialize))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Interval {
    /// The lowest.
    pub lower: Length,
    /// The highest.
    pub upper: Length,
}

impl Interval {
    /// The nearest decimals of a range: errors in decimals then meet a decimal limit exactly.
    ///
    /// # Errors
    /// [`QuantityError::Overflow`] if an end is beyond the largest length.
    #[inline]
    pub fn nearest(range: Range) -> Result<Self, QuantityError> {
        let nearest = |mm: f64| Length::nearest(mm * FM_PER_MM, "the sum of ΔCD");
        Ok(Self { lower: nearest(range.lower)?, upper: nearest(range.upper)? })
    }

    /// The nearest decimals of a range that may be open.
    ///
    /// # Errors
    /// [`QuantityError::Overflow`] if an end is beyond the largest length.
    pub fn of(range: Result<Range, NoBound>) -> Result<Result<Self, NoBound>, QuantityError> {
        match range {
            Ok(range) => Self::nearest(range).map(Ok),
            Err(open) => Ok(Err(open)),
        }
    }

    /// A single value.
    #[must_use]
    pub const fn value(value: Length) -> Self {
        Self { lower: value, upper: value }
    }

    /// The end that is farther from 0.
    #[must_use]
    pub fn largest(&self) -> Length {
        if self.lower.abs() > self.upper.abs() { self.lower } else { self.upper }
    }
}

impl Combined<Range> {
    /// The nearest decimals.
    ///
    /// # Errors
    /// [`QuantityError::Overflow`] if a sum is beyond the largest length.
    pub fn nearest(self) -> Result<Combined<Interval>, QuantityError> {
        Ok(Combined { range: Interval::of(self.range)?, rss: Interval::of(self.rss)? })
    }
}

impl<T> Combined<T> {
    /// The combination that is judged: the worst case also where the statistical one is asked for and nothing scatters.
    #[must_use]
    pub fn judged(&self, asked: Stack) -> Stack {
        match self.rss {
            Err(NoBound::NothingScatters) => Stack::Range,
            _ => asked,
        }
    }

    /// The combination of a kind.
    ///
    /// # Errors
    /// [`NoBound`] if there is none.
    pub fn interval(self, stack: Stack) -> Result<T, NoBound> {
        match stack {
            Stack::Range => self.range,
            Stack::Rss => self.rss,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::DeviationValue;
    use crate::deviation::Extent;
    use crate::formula::Law;
    use crate::formula::{PartDeviation, ToleranceEnds};
    use crate::judge::bound::Basis;
    use crate::quantity::Angle;

    fn combined(errors: &[PartDeviation]) -> Combined<Interval> {
        Basis::default().bound_of(errors).combined.nearest().unwrap()
    }

    fn length(text: &str) -> Length {
        text.parse().unwrap()
    }

    fn interval(lower: &str, upper: &str) -> Interval {
        Interval { lower: length(lower), upper: length(upper) }
    }

    fn pitch(value: &str) -> PartDeviation {
        // cos 30° / (2 tan 30°) = 3/4
        let angle: Angle = "30".parse().unwrap();
        PartDeviation::new(Law::rack_pitch(angle, angle).unwrap(), length(value))
    }

    #[test]
    fn sizes_act_with_their_sign_and_steps_either_way() {
        let c = combined(&[
            PartDeviation::new(Law::rack_over_roller(), length("-0.03")),
            PartDeviation::new(Law::pinion_radial(), length("0.01")),
            pitch("0.04"),
        ]);
        assert_eq!(c.range, Ok(interval("-0.06", "0.01")));
    }

    #[test]
    fn decimals_meet_decimals() {
        for step in 0..=2000 {
            let size = |fm: i64| PartDeviation::new(Law::rack_over_roller(), Length::from_fm(fm));
            let c = combined(&[size(step * 100_000_000), size(30_000_000_000), pitch("0.02")]);
            let expected = Length::from_fm(step * 100_000_000 + 45_000_000_000);
            assert_eq!(c.range.unwrap().upper, expected);
        }
    }

    #[test]
    fn tolerances_combine_by_their_spread() {
        let tolerance = |law, value| PartDeviation::within(law, length(value));
        let c = combined(&[tolerance(Law::rack_over_roller(), "0.03"), tolerance(Law::pinion_radial(), "0.04")]);
        assert_eq!(c.range, Ok(interval("-0.07", "0.07")));
        assert_eq!(c.rss, Ok(interval("-0.05", "0.05")));
    }

    #[test]
    fn a_tolerance_that_leaves_one_value_does_not_scatter() {
        let of = |ends: [&str; 2]| {
            let [lower, upper] = ends.map(|end| DeviationValue::Length(length(end)));
            PartDeviation::between(Law::rack_over_roller(), ToleranceEnds::from_to(lower, upper))
        };
        for (ends, at) in [(["0", "0"], "0"), (["0.01", "0.01"], "0.01"), (["-0.02", "-0.02"], "-0.02")] {
            for extent in [Extent::Each, Extent::All] {
                let c = combined(&[of(ends).with_extent(extent)]);
                assert_eq!(
                    (c.range, c.rss),
                    (Ok(interval(at, at)), Err(NoBound::NothingScatters)),
                    "{ends:?} {extent}"
                );
            }
        }
        let c = combined(&[of(["0.01", "0.01"]), of(["-0.03", "0.03"])]);
        assert_eq!((c.range, c.rss), (Ok(interval("-0.02", "0.04")), Ok(interval("-0.02", "0.04"))));
    }

    #[test]
    fn every_pitch_has_no_range_without_the_pair() {
        let c = combined(&[pitch("0.01").with_extent(Extent::All)]);
        assert_eq!((c.range, c.rss), (Err(NoBound::TeethInContactUnknown), Err(NoBound::NothingScatters)));
        let c = combined(&[pitch("0.01").with_extent(Extent::Each)]);
        assert_eq!((c.range, c.rss), (Err(NoBound::TeethInContactUnknown), Err(NoBound::TeethInContactUnknown)));
    }

    #[test]
    fn nothing_combines_to_nothing_and_overflow_is_an_error() {
        assert_eq!(combined(&[]).range, Ok(Interval::default()));
        let large = PartDeviation::new(Law::rack_over_roller(), length("9e5"));
        let error = Basis::default().bound_of(&[large, large]).combined.nearest().unwrap_err();
        assert_eq!(error.to_string(), "the sum of ΔCD is too large: its magnitude must stay within 1e6 mm");
    }
}
