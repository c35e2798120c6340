//! Why a text or a number is not a length or an angle. Raised where quantities are read and computed.

use thiserror::Error;

use crate::diagnostic::harmless;

use super::{AngleUnit, LengthUnit, NumberError};

/// Why a text or a number is not a length or an angle.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum QuantityError {
    /// The number itself cannot be read.
    #[error("`{}` is not {expected}: {reason}", shown(text))]
    Number {
        /// The text as written.
        text: String,
        /// What was expected: `a length` or `an angle`.
        expected: &'static str,
        /// What is wrong with the number.
        reason: NumberError,
    },
    /// The unit is unknown, or is one of another quantity.
    #[error("`{}` is {problem}: write {units}", shown(unit))]
    Unit {
        /// The unit as written.
        unit: String,
        /// What is wrong with it.
        problem: &'static str,
        /// The units to choose from.
        units: &'static str,
    },
    /// The value is an infinity or not-a-number.
    #[error("{what} is {value}; it must be a finite number")]
    NotFinite {
        /// The quantity.
        what: &'static str,
        /// `NaN`, `inf` or `-inf`.
        value: String,
    },
    /// The value is larger than the quantity may be.
    #[error("{what} is too large: its magnitude must stay within {largest}")]
    Overflow {
        /// The quantity that overflows.
        what: &'static str,
        /// The largest magnitude, with its unit.
        largest: &'static str,
    },
}

impl QuantityError {
    /// A symbol that is no unit of length.
    pub(crate) fn no_unit_of_length(symbol: &str) -> Self {
        let is_known = AngleUnit::from_symbol(symbol).is_some();
        let problem = if is_known { "a unit of angle, and a length is needed" } else { "not a unit of a length" };
        Self::Unit { unit: symbol.to_owned(), problem, units: LengthUnit::NAMES }
    }

    /// A symbol that is no unit of angle.
    pub(crate) fn no_unit_of_angle(symbol: &str) -> Self {
        let is_known = LengthUnit::from_symbol(symbol).is_some();
        let problem = if is_known { "a unit of length, and an angle is needed" } else { "not a unit of an angle" };
        Self::Unit { unit: symbol.to_owned(), problem, units: AngleUnit::NAMES }
    }
}

/// A text as a message shows it: its first 60 characters, on one line, without control characters.
pub(crate) fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    let more = text.chars().nth(LONGEST).map(|_| '…');
    harmless(&text.chars().take(LONGEST).chain(more).collect::<String>()).into_owned()
}

/// Texts as a message lists them: the first twenty, and how many more there are.
#[cfg(feature = "table")]
pub(crate) fn listed(texts: &[impl AsRef<str>]) -> String {
    const MOST: usize = 20;
    let more = texts.len().checked_sub(MOST + 1).map(|more| format!("and {} more", more + 1));
    let first = texts.iter().take(MOST).map(|text| format!("`{}`", shown(text.as_ref())));
    first.chain(more).collect::<Vec<_>>().join(", ")
}
