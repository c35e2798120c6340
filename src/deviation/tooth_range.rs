//! Which teeth a deviation is on: `all`, `5`, `8..`, `8..=12`. Written by users, read by the flanks.

use std::fmt;
use std::str::FromStr;

/// A range of tooth indices, both ends included; an end left out is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct ToothRange {
    first: Option<i64>,
    last: Option<i64>,
}

/// The first rack tooth with an error of `[errors]`: the teeth before it are nominal, as in the paper's model.
pub const FIRST_ODD_TOOTH: i64 = 4;

/// Largest tooth index either way: 2⁵⁰, far beyond any rack, and exact in every floating-point product.
const MAX_INDEX: i64 = 1 << 50;

/// Why a text is not a range of teeth.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ToothRangeError {
    /// It has none of the forms.
    #[error("`{text}` is not a range of teeth; write `all`, `5`, `8..`, `..=12` or `8..=12`")]
    Syntax {
        /// What was written.
        text: String,
    },
    /// The end lies before the start, so the range is empty.
    #[error("teeth {first}..={last}: the range ends before it starts")]
    Empty {
        /// Its start.
        first: i64,
        /// Its end.
        last: i64,
    },
    /// An index too large for exact arithmetic.
    #[error("tooth {index} is outside ±{MAX_INDEX}")]
    TooFar {
        /// The index.
        index: i64,
    },
}

impl ToothRange {
    /// Every tooth.
    pub const ALL: Self = Self { first: None, last: None };

    /// From one tooth to another, both included; an end left out is open.
    ///
    /// # Errors
    /// If the range is empty or an index is beyond ±2⁵⁰.
    pub fn new(first: Option<i64>, last: Option<i64>) -> Result<Self, ToothRangeError> {
        for index in [first, last].into_iter().flatten() {
            if !(-MAX_INDEX..=MAX_INDEX).contains(&index) {
                return Err(ToothRangeError::TooFar { index });
            }
        }
        match (first, last) {
            (Some(first), Some(last)) if last < first => Err(ToothRangeError::Empty { first, last }),
            _ => Ok(Self { first, last }),
        }
    }

    /// This tooth and all after it; an index beyond ±2⁵⁰ is clipped.
    #[must_use]
    pub fn starting_at(first: i64) -> Self {
        Self { first: Some(first.clamp(-MAX_INDEX, MAX_INDEX)), last: None }
    }

    /// One tooth of a pinion.
    #[must_use]
    pub const fn of(tooth: u32) -> Self {
        Self { first: Some(tooth as i64), last: Some(tooth as i64) }
    }

    /// One tooth.
    ///
    /// # Errors
    /// If the index is beyond ±2⁵⁰.
    pub fn single(tooth: i64) -> Result<Self, ToothRangeError> {
        Self::new(Some(tooth), Some(tooth))
    }

    /// The first tooth, if the range has a lower end.
    #[must_use]
    pub const fn first(self) -> Option<i64> {
        self.first
    }

    /// The last tooth, if the range has an upper end.
    #[must_use]
    pub const fn last(self) -> Option<i64> {
        self.last
    }

    /// Whether a tooth is in the range.
    #[must_use]
    pub fn contains(self, tooth: i64) -> bool {
        self.first.is_none_or(|first| first <= tooth) && self.last.is_none_or(|last| tooth <= last)
    }

    /// How many pitches of this range lie between tooth 0's (or the range's) start and a tooth: the n of "the
    /// n-th tooth of the range". Teeth after the range keep its length; a range without lower end is anchored
    /// at tooth 0.
    #[must_use]
    pub fn pitches_before(self, tooth: i64) -> i64 {
        let capped = |index: i64| self.last.map_or(index, |last| index.min(last));
        match self.first {
            Some(first) => (capped(tooth) - first + 1).max(0),
            None => capped(tooth) - capped(0),
        }
    }
}

impl FromStr for ToothRange {
    type Err = ToothRangeError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let trimmed = text.trim();
        if trimmed == "all" || trimmed == ".." {
            return Ok(Self::ALL);
        }
        let index = |part: &str| -> Result<i64, ToothRangeError> {
            part.trim().parse().map_err(|_| ToothRangeError::Syntax { text: text.to_owned() })
        };
        match trimmed.split_once("..") {
            None => Self::single(index(trimmed)?),
            Some((first, "")) => Self::new(Some(index(first)?), None),
            Some((first, last)) => {
                let last = last.strip_prefix('=').ok_or_else(|| ToothRangeError::Syntax { text: text.to_owned() })?;
                let first = if first.is_empty() { None } else { Some(index(first)?) };
                Self::new(first, Some(index(last)?))
            }
        }
    }
}

impl fmt::Display for ToothRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.first, self.last) {
            (None, None) => f.write_str("all"),
            (Some(first), None) => write!(f, "{first}.."),
            (None, Some(last)) => write!(f, "..={last}"),
            (Some(first), Some(last)) if first == last => write!(f, "{first}"),
            (Some(first), Some(last)) => write!(f, "{first}..={last}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_reads_and_prints_back() {
        for text in ["all", "5", "-3", "8..", "8..=12", "..=4", "-2..=-1"] {
            let range: ToothRange = text.parse().unwrap();
            assert_eq!(range.to_string(), text);
        }
        for text in ["", "8..12", "x", "1..=", "1.5", "=3", "..3", "8...=9"] {
            assert!(matches!(text.parse::<ToothRange>(), Err(ToothRangeError::Syntax { .. })), "{text}");
        }
        assert_eq!("5..=4".parse::<ToothRange>(), Err(ToothRangeError::Empty { first: 5, last: 4 }));
        assert_eq!(
            "9000000000000000000".parse::<ToothRange>(),
            Err(ToothRangeError::TooFar { index: 9_000_000_000_000_000_000 })
        );
    }

    #[test]
    fn pitches_accumulate_and_stay() {
        let n = |range: &str, tooth: i64| range.parse::<ToothRange>().unwrap().pitches_before(tooth);
        assert_eq!([7, 8, 9, 100].map(|i| n("8..", i)), [0, 1, 2, 93]);
        assert_eq!([7, 8, 12, 13].map(|i| n("8..=12", i)), [0, 1, 5, 5]);
        assert_eq!([-2, 0, 3].map(|i| n("all", i)), [-2, 0, 3]);
        assert_eq!([-6, -4, 0, 5].map(|i| n("..=-4", i)), [-2, 0, 0, 0]);
        assert_eq!([-1, 0, 2, 5].map(|i| n("..=2", i)), [-1, 0, 2, 2]);
    }
}
