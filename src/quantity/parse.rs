//! Reading quantities from text: a number and an optional unit. Called by `FromStr` of lengths and angles and by the
//! readers of tables; decimal points only, and never `nan` or `inf`.

use thiserror::Error;

use super::Rational;

/// Why a text is not a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum NumberError {
    /// There is no number in the text.
    #[error("there is no number")]
    Empty,
    /// The text is not a decimal number.
    #[error("that is not a decimal number")]
    NotANumber,
    /// The number has a comma: a decimal comma or a thousands mark, which is left to nobody's guess.
    #[error("a comma could be a decimal or a thousands mark; write a decimal point and no thousands mark")]
    Comma,
    /// The text is an infinity or not-a-number.
    #[error("a finite number is needed")]
    NotFinite,
    /// The number is larger than any double-precision number.
    #[error("the number is too large (its magnitude must stay below 1.8e308)")]
    TooLarge,
    /// The number is smaller than any double-precision number but not zero.
    #[error("the number is too small (its magnitude must be 0 or at least 5e-324)")]
    TooSmall,
    /// The text is longer than any number needs.
    #[error("the number has more digits than any measurement")]
    TooLong,
}

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
    /// The value is beyond the range of double-precision numbers.
    #[error("{what} is beyond the range of double-precision numbers (1.8e308)")]
    Overflow {
        /// The quantity that overflows.
        what: &'static str,
    },
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

/// Splits `text` into its leading number and what follows, both trimmed.
pub(crate) fn split_number(text: &str) -> (&str, &str) {
    let text = text.trim();
    let mut end = 0;
    let mut characters = text.char_indices().peekable();
    let mut previous = ' ';
    while let Some((index, c)) = characters.next() {
        let sign_allowed = index == 0 || matches!(previous, 'e' | 'E');
        let exponent = matches!(c, 'e' | 'E')
            && previous.is_ascii_digit()
            && characters.peek().is_some_and(|(_, next)| next.is_ascii_digit() || matches!(next, '+' | '-'));
        let part = c.is_ascii_digit()
            || matches!(c, '.' | '_' | ',')
            || (sign_allowed && matches!(c, '+' | '-' | '\u{2212}'))
            || exponent;
        if !part {
            break;
        }
        end = index + c.len_utf8();
        previous = c;
    }
    (text[..end].trim(), text[end..].trim())
}

/// Reads the number of a quantity; `expected` is what the error calls it, `text` the whole text.
pub(super) fn number(written: &str, text: &str, expected: &'static str) -> Result<Rational, QuantityError> {
    Rational::parse_decimal(written).map_err(|reason| QuantityError::Number {
        text: text.to_owned(),
        expected,
        // "abc" has no leading number at all, but it is not empty
        reason: if reason == NumberError::Empty && !text.trim().is_empty() {
            match Rational::parse_decimal(text.trim()) {
                Err(NumberError::NotFinite) => NumberError::NotFinite,
                _ => NumberError::NotANumber,
            }
        } else {
            reason
        },
    })
}
