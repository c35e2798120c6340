//! Limits of ΔCD and the verdict. The spec layer builds them, everything that judges uses them; an equal value is inside.

use std::fmt;

use super::Interval;
use crate::deviation::DeviationKind;
use crate::quantity::{Length, Rounded};

/// Permitted values from `lower` to `upper`, both included; an end that is not given is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Limit {
    /// The lowest permitted value.
    pub lower: Option<Length>,
    /// The highest permitted value.
    pub upper: Option<Length>,
}

/// The quantity that a limit is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LimitTarget {
    /// The combined ΔCD.
    CenterDistance,
    /// The ΔCD of one error.
    Error(DeviationKind),
}

impl LimitTarget {
    /// The limit's key in specs and results.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::CenterDistance => "center_distance",
            Self::Error(kind) => kind.key(),
        }
    }
}

impl fmt::Display for LimitTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CenterDistance => f.write_str("centre distance"),
            Self::Error(kind) => kind.fmt(f),
        }
    }
}

/// The end of a limit that a result is nearest to, or furthest beyond.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NearestEnd {
    /// The result's own end on that side.
    pub result: Length,
    /// How far the result's end is inside; negative outside.
    pub inside_by: Length,
    /// The end of the limit.
    pub end: Length,
    /// Whether it is the upper end.
    pub is_upper: bool,
}

impl NearestEnd {
    /// The end's key in specs: `upper`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        if self.is_upper { "upper" } else { "lower" }
    }

    /// How far the result is outside: `is 0.0077 mm`, with as many decimals as are needed.
    fn by_in_words(&self) -> String {
        let by = self.inside_by.abs();
        let mut texts = (4..=12).map(|decimals| by.to_decimal_text(decimals));
        let by = texts.find(|text| text.bytes().any(|digit| matches!(digit, b'1'..=b'9')));
        ["is ", &by.unwrap_or_default(), " mm"].concat()
    }

    /// The words for a result that is outside, with those of its side that [`Limit::sides_in_words`] gives.
    #[cfg(feature = "batch")]
    pub(crate) fn in_words(&self, [below, above]: &[String; 2]) -> String {
        [&self.by_in_words(), " ", if self.is_upper { above } else { below }].concat()
    }
}

/// Where a result is that is outside: `above the limit 0.05 mm`.
fn side_in_words(is_upper: bool, end: Length) -> String {
    format!("{} the limit {end}", if is_upper { "above" } else { "below" })
}

/// The words for a result that is outside: `is 0.0077 mm above the limit 0.05 mm`.
impl fmt::Display for NearestEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.by_in_words(), side_in_words(self.is_upper, self.end))
    }
}

/// The limits of an evaluation.
pub type Limits = Vec<(LimitTarget, Limit)>;

named! {
    /// The outcome of a comparison with a limit.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Verdict {
        /// Inside the limit, or on it.
        Pass = "pass",
        /// Outside the limit.
        Fail = "fail",
        /// Too near the limit for the uncertainty or the guard band: neither conformity nor non-conformity is proven.
        Indeterminate = "indeterminate",
    }
}

impl Limit {
    /// The ends that are given, the lower one first.
    pub fn ends(self) -> impl Iterator<Item = Length> {
        self.lower.into_iter().chain(self.upper)
    }

    /// Where a result is that is below or above the limit, in words.
    #[cfg(feature = "batch")]
    pub(crate) fn sides_in_words(&self) -> [String; 2] {
        let words = |is_upper, end: Option<Length>| end.map_or(String::new(), |end| side_in_words(is_upper, end));
        [words(false, self.lower), words(true, self.upper)]
    }

    /// From `-magnitude` to `+magnitude`.
    #[must_use]
    pub fn symmetric(magnitude: Length) -> Self {
        Self { lower: Some(-magnitude.abs()), upper: Some(magnitude.abs()) }
    }

    /// The limit with both ends moved inwards.
    pub(super) fn narrowed(self, at_lower: Length, at_upper: Length) -> Self {
        Self { lower: self.lower.map(|end| end + at_lower), upper: self.upper.map(|end| end - at_upper) }
    }

    /// How far a result is from each end, the upper one first.
    #[inline]
    pub fn distances(&self, Interval { lower, upper }: Interval) -> impl Iterator<Item = NearestEnd> {
        let above = self.upper.map(|end| NearestEnd { result: upper, inside_by: end - upper, end, is_upper: true });
        let below = self.lower.map(|end| NearestEnd { result: lower, inside_by: lower - end, end, is_upper: false });
        above.into_iter().chain(below)
    }

    /// How far a result is inside the nearest end, negative beyond it; `None` for a limit without ends.
    #[must_use]
    #[inline]
    pub fn inside_by(&self, Interval { lower, upper }: Interval) -> Option<Length> {
        let of_upper = self.upper.map(|end| end - upper);
        of_upper.into_iter().chain(self.lower.map(|end| lower - end)).min()
    }

    /// The end that a result is nearest to, or furthest beyond; `None` for a limit without ends.
    #[must_use]
    #[inline]
    pub fn nearest(&self, result: Interval) -> Option<NearestEnd> {
        self.distances(result).min_by_key(|nearest| nearest.inside_by)
    }

    /// Whether every value of a result is permitted.
    #[must_use]
    pub fn judge(&self, result: Interval) -> Verdict {
        let above = self.lower.is_none_or(|limit| limit <= result.lower);
        let below = self.upper.is_none_or(|limit| result.upper <= limit);
        if above && below { Verdict::Pass } else { Verdict::Fail }
    }
}

/// `-0.03 … 0.05 mm`, `at most 0.05 mm`, `at least -0.03 mm` or `none`.
impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [lower, upper] = [self.lower, self.upper].map(|end| end.map(|end| Rounded(end.mm())));
        match (lower, upper) {
            (Some(lower), Some(upper)) => write!(f, "{lower} … {upper} mm"),
            (None, Some(upper)) => write!(f, "at most {upper} mm"),
            (Some(lower), None) => write!(f, "at least {lower} mm"),
            (None, None) => f.write_str("none"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_on_the_limit_is_inside() {
        // in binary numbers many of these differences exceed their limit
        for step in 0..=1500 {
            let nominal: Length = "25.0000".parse().unwrap();
            let measured: Length = format!("25.{step:04}").parse().unwrap();
            let limit: Length = format!("0.{step:04}").parse().unwrap();
            let deviation = measured - nominal;
            for (lower, upper) in [(deviation, deviation), (-deviation, deviation)] {
                assert_eq!(Limit::symmetric(limit).judge(Interval { lower, upper }), Verdict::Pass, "{measured:?}");
            }
            let beyond = deviation + Length::from_fm(1);
            assert_eq!(Limit::symmetric(limit).judge(Interval::value(beyond)), Verdict::Fail, "{measured:?}");
        }
    }

    #[test]
    fn a_limit_reads_as_one_would_say_it() {
        let (lower, upper): (Length, Length) = ("-0.03".parse().unwrap(), "50 um".parse().unwrap());
        let text = |lower: Option<Length>, upper: Option<Length>| Limit { lower, upper }.to_string();
        assert_eq!(text(Some(lower), Some(upper)), "-0.03 … 0.05 mm");
        assert_eq!(text(None, Some(upper)), "at most 0.05 mm");
        assert_eq!(text(Some(lower), None), "at least -0.03 mm");
    }

    #[test]
    fn an_open_end_permits_everything() {
        let limit = Limit { lower: None, upper: Some("0.05".parse().unwrap()) };
        let up_to = |upper: &str| Interval { lower: "-9".parse().unwrap(), upper: upper.parse().unwrap() };
        assert_eq!(limit.judge(up_to("0.05")), Verdict::Pass);
        assert_eq!(limit.judge(up_to("0.0500001")), Verdict::Fail);
    }

    #[test]
    fn keys_are_those_of_a_spec() {
        assert_eq!(LimitTarget::CenterDistance.key(), "center_distance");
        assert_eq!(LimitTarget::Error(DeviationKind::PinionRadial).key(), "pinion_radial");
    }
}
