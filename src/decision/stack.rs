#![doc = include_str!("stack.md")]
//!
//! Called by the evaluation; judges nothing.

use std::fmt;

use crate::deviation::ErrorKind;
use crate::quantity::{Length, QuantityError};

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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
            (-self.delta_cd.abs(), self.delta_cd.abs())
        } else {
            (self.delta_cd, self.delta_cd)
        }
    }
}

/// The combinations of several ΔCD.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
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
    /// Combines the ΔCD of each error, measured or permissible.
    ///
    /// # Errors
    /// [`QuantityError::Overflow`] if a sum is beyond the largest length.
    pub fn of(terms: &[Term]) -> Result<Self, QuantityError> {
        // one way through the terms: a batch combines those of every row
        let (mut lower, mut upper, mut magnitudes, mut squares) = (0_i128, 0_i128, 0_i128, 0_u128);
        for term in terms {
            let interval = term.interval();
            if term.kind.always_acts() {
                lower += i128::from(interval.0.fm());
            }
            upper += i128::from(interval.1.fm());
            let magnitude = term.delta_cd.fm().unsigned_abs();
            magnitudes += i128::from(magnitude);
            squares += u128::from(magnitude).pow(2);
        }
        let sum = |fm: i128| Length::of_sum(fm, "the sum of ΔCD");
        Ok(Self {
            range_lower: sum(lower)?,
            range_upper: sum(upper)?,
            worst_case: sum(magnitudes)?,
            rss: root(squares),
        })
    }

    /// The interval of ΔCD that a stack-up claims, from lower to upper.
    #[must_use]
    pub fn interval(&self, stack: Stack) -> (Length, Length) {
        match stack {
            Stack::Range => (self.range_lower, self.range_upper),
            Stack::WorstCase => (-self.worst_case, self.worst_case),
            Stack::Rss => (-self.rss, self.rss),
        }
    }
}

/// The root of a sum of squares, to the nearest step of the grid: that of 0.03² + 0.04² is 0.05.
fn root(squares: u128) -> Length {
    // a double is within 1 of the root of what ΔCD are; whole numbers tell which is nearest
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a start for whole numbers"
    )]
    let mut root = (squares as f64).sqrt() as u64;
    let square = |root: u64| u128::from(root) * u128::from(root);
    // (n ± 1/2)² = n² ± n + 1/4
    while squares > square(root) + u128::from(root) {
        root += 1;
    }
    while square(root) > squares + u128::from(root) - u128::from(root > 0) {
        root -= 1;
    }
    Length::from_fm(i64::try_from(root).unwrap_or(i64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn combined(terms: &[(ErrorKind, &str)]) -> Combined {
        let term = |(kind, text): &(ErrorKind, &str)| Term {
            kind: *kind,
            delta_cd: text.parse().unwrap(),
            is_tolerance: false,
        };
        Combined::of(&terms.iter().map(term).collect::<Vec<_>>()).unwrap()
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

    #[test]
    fn an_irrational_root_is_the_nearest_step() {
        let one = combined(&[(ErrorKind::RackOverRoller, "1"), (ErrorKind::RackPitch, "1")]).rss;
        assert_eq!(one, "1.414213562373".parse().unwrap());
        let three = combined(&[(ErrorKind::RackOverRoller, "1"), (ErrorKind::RackPitch, "1.4142135623731")]).rss;
        assert_eq!(three, "1.732050807569".parse().unwrap());
    }

    #[test]
    fn nothing_combines_to_nothing_and_overflow_is_an_error() {
        assert!(combined(&[]).rss.is_zero());
        let large = |kind| Term { kind, delta_cd: "9e5".parse().unwrap(), is_tolerance: false };
        let error = Combined::of(&[large(ErrorKind::RackPitch), large(ErrorKind::RackLead)]).unwrap_err();
        assert_eq!(error.to_string(), "the sum of ΔCD is too large: its magnitude must stay within 1e6 mm");
    }
}
