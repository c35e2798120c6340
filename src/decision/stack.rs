#![doc = include_str!("stack.md")]
//!
//! Called by the evaluation; judges nothing.

use std::fmt;

use crate::deviation::ErrorKind;
use crate::quantity::{Length, QuantityError, Rational};

/// How errors are combined to the result that is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Stack {
    /// What these measured errors can do at some point of the stroke: over-roller and radial errors
    /// always act, with their sign; pitch and lead errors add between 0 and their value.
    #[default]
    Range,
    /// The sum of magnitudes, to either side.
    WorstCase,
    /// The root of the sum of squares, to either side.
    Rss,
}

impl Stack {
    /// `range`, `worst` or `rss`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Range => "range",
            Self::WorstCase => "worst",
            Self::Rss => "rss",
        }
    }
}

impl fmt::Display for Stack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Range => "range",
            Self::WorstCase => "worst case",
            Self::Rss => "RSS",
        })
    }
}

/// One ΔCD of a sum.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Term {
    /// The kind of error that it comes from.
    pub kind: ErrorKind,
    /// ΔCD.
    pub delta_cd: Length,
    /// Whether the error is a permissible deviation, whose sign is not known.
    pub is_tolerance: bool,
}

impl Term {
    /// From lowest to highest, ΔCD while the error acts: a permissible over-roller or radial deviation may
    /// act either way.
    #[must_use]
    pub fn interval(&self) -> (Length, Length) {
        if self.is_tolerance && self.kind.always_acts() {
            (-&self.delta_cd.abs(), self.delta_cd.abs())
        } else {
            (self.delta_cd.clone(), self.delta_cd.clone())
        }
    }
}

/// The combinations of several ΔCD.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Combined {
    /// The lower end of the range: the sum of the signed errors.
    pub range_lower: Length,
    /// The upper end of the range: the lower end plus every pitch and lead error.
    pub range_upper: Length,
    /// The sum of magnitudes.
    pub worst_case: Length,
    /// The root of the sum of squares.
    pub rss: Length,
}

impl Combined {
    /// Combines the ΔCD of each measured error.
    ///
    /// # Errors
    /// [`QuantityError::Overflow`] if a sum is beyond the range of `f64`.
    pub fn new(terms: &[(ErrorKind, Length)]) -> Result<Self, QuantityError> {
        let measured = |(kind, delta_cd): &(ErrorKind, Length)| Term {
            kind: *kind,
            delta_cd: delta_cd.clone(),
            is_tolerance: false,
        };
        Self::of(&terms.iter().map(measured).collect::<Vec<_>>())
    }

    /// Combines the ΔCD of each error, measured or permissible.
    ///
    /// # Errors
    /// [`QuantityError::Overflow`] if a sum is beyond the range of `f64`.
    pub fn of(terms: &[Term]) -> Result<Self, QuantityError> {
        let sum = |terms: &mut dyn Iterator<Item = Length>| -> Result<Length, QuantityError> {
            let sum: Length = terms.sum();
            Length::from_exact_mm(sum.exact_mm().clone(), "the sum of ΔCD")
        };
        let squares = terms.iter().fold(Rational::ZERO, |sum, term| &sum + &term.delta_cd.exact_mm().square());
        // a root that is rational, as that of 0.03² + 0.04², is exact, and stays so
        let root = squares.sqrt().unwrap_or(Rational::ZERO);
        let rss = if root.square() == squares { root } else { root.round_significant(40) };
        Ok(Self {
            range_lower: sum(&mut terms.iter().filter(|term| term.kind.always_acts()).map(|term| term.interval().0))?,
            range_upper: sum(&mut terms.iter().map(|term| term.interval().1))?,
            worst_case: sum(&mut terms.iter().map(|term| term.delta_cd.abs()))?,
            rss: Length::from_exact_mm(rss, "the RSS of ΔCD")?,
        })
    }

    /// The interval of ΔCD that a stack-up claims, from lower to upper.
    #[must_use]
    pub fn interval(&self, stack: Stack) -> (Length, Length) {
        match stack {
            Stack::Range => (self.range_lower.clone(), self.range_upper.clone()),
            Stack::WorstCase => (-&self.worst_case, self.worst_case.clone()),
            Stack::Rss => (-&self.rss, self.rss.clone()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn combined(terms: &[(ErrorKind, &str)]) -> Combined {
        let terms: Vec<_> = terms.iter().map(|(kind, text)| (*kind, text.parse().unwrap())).collect();
        Combined::new(&terms).unwrap()
    }

    #[test]
    fn signed_errors_act_always_and_pushing_errors_sometimes() {
        let c = combined(&[
            (ErrorKind::RackOverRoller, "-0.03"),
            (ErrorKind::PinionRadial, "+0.01"),
            (ErrorKind::RackPitch, "0.04"),
            (ErrorKind::RackLead, "0.005"),
        ]);
        assert_eq!((c.range_lower.mm(), c.range_upper.mm()), (-0.02, 0.025));
        assert_eq!(c.worst_case.mm(), 0.085);
        assert_eq!(c.interval(Stack::WorstCase).0.mm(), -0.085);
    }

    #[test]
    fn a_permissible_deviation_acts_either_way() {
        let term = |kind, text: &str, is_tolerance| Term { kind, delta_cd: text.parse().unwrap(), is_tolerance };
        let c = Combined::of(&[
            term(ErrorKind::RackOverRoller, "0.03", true),
            term(ErrorKind::PinionRadial, "0.01", false),
            term(ErrorKind::RackPitch, "0.04", true),
        ])
        .unwrap();
        assert_eq!((c.range_lower.mm(), c.range_upper.mm()), (-0.02, 0.08));
        assert_eq!(c.worst_case.mm(), 0.08);
    }

    #[test]
    fn a_decimal_root_is_exact() {
        let c = combined(&[(ErrorKind::RackOverRoller, "0.03"), (ErrorKind::RackPitch, "0.04")]);
        assert_eq!(c.rss, "0.05".parse().unwrap());
    }

    /// However many decimals an exact root has; another one is rounded to forty.
    #[test]
    fn a_long_decimal_root_is_exact_and_an_irrational_one_rounded() {
        let (three, four) = (format!("3.{}3", "0".repeat(43)), format!("4.{}4", "0".repeat(43)));
        let five: Length = format!("5.{}5", "0".repeat(43)).parse().unwrap();
        assert_eq!(combined(&[(ErrorKind::RackOverRoller, &three), (ErrorKind::RackPitch, &four)]).rss, five);
        let one = combined(&[(ErrorKind::RackOverRoller, "1"), (ErrorKind::RackPitch, "1")]).rss;
        assert_eq!(one, "1.414213562373095048801688724209698078570".parse().unwrap());
    }

    #[test]
    fn nothing_combines_to_nothing_and_overflow_is_an_error() {
        assert!(combined(&[]).rss.is_zero());
        let huge: Length = "1.7e308".parse().unwrap();
        let terms = [(ErrorKind::RackPitch, huge.clone()), (ErrorKind::RackLead, huge)];
        assert!(Combined::new(&terms).is_err());
    }
}
