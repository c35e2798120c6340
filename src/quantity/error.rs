//! Why a text or a number is not the quantity that it should be. Raised where quantities are read and computed.

use thiserror::Error;

use super::{AngleUnit, LengthUnit, NumberError};

/// Why a text or a number is not the quantity that it should be.
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
    /// The unit is none of those known.
    #[error("`{}` is not a unit of {expected}: write {units}", shown(unit))]
    UnknownUnit {
        /// The unit as written.
        unit: String,
        /// What was expected: `a length` or `an angle`.
        expected: &'static str,
        /// The units to choose from.
        units: &'static str,
    },
    /// The unit measures something else.
    #[error("`{}` is a unit of {measures}, and {expected} is needed: write {units}", shown(unit))]
    OtherDimension {
        /// The unit as written.
        unit: String,
        /// What the unit measures.
        measures: &'static str,
        /// What was expected.
        expected: &'static str,
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
    /// The value is beyond what the quantity holds.
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
        Self::no_unit(symbol, AngleUnit::from_symbol(symbol).map(|_| "angle"), "a length", LengthUnit::NAMES)
    }

    /// A symbol that is no unit of angle.
    pub(crate) fn no_unit_of_angle(symbol: &str) -> Self {
        Self::no_unit(symbol, LengthUnit::from_symbol(symbol).map(|_| "length"), "an angle", AngleUnit::NAMES)
    }

    fn no_unit(symbol: &str, of: Option<&'static str>, expected: &'static str, units: &'static str) -> Self {
        let unit = symbol.to_owned();
        match of {
            Some(measures) => Self::OtherDimension { unit, measures, expected, units },
            None => Self::UnknownUnit { unit, expected, units },
        }
    }
}

/// A text as a message shows it: its first 60 characters, on one line, and nothing that a terminal would obey.
pub(crate) fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut shown = String::new();
    for (count, c) in text.chars().enumerate() {
        if count == LONGEST {
            shown.push('…');
            break;
        }
        if c.is_control() {
            shown.extend(c.escape_debug());
        } else {
            shown.push(c);
        }
    }
    shown
}
