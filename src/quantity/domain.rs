//! Domains: the values that a quantity may take, and the error of a value outside. Declared by the formulas and the spec.

use std::fmt;
use std::ops::{Bound, RangeBounds as _};

use thiserror::Error;

use super::{Angle, Length, QuantityError, Rounded};

/// A named quantity and the values that it may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Domain {
    /// The quantity's name in the field: `normal pressure angle`.
    pub name: &'static str,
    /// Its symbol: `α_n`.
    pub symbol: &'static str,
    /// The lower end, in the base unit (mm or degrees).
    pub lower: Bound<i64>,
    /// The upper end, in the base unit.
    pub upper: Bound<i64>,
}

/// A value outside its domain, or a result that is too large.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DomainError {
    /// The value lies outside the quantity's domain.
    #[error("the {} {} is {value}; it must be {bounds}", .domain.name, .domain.symbol)]
    Outside {
        /// The quantity and its domain.
        domain: Domain,
        /// The value, with its unit.
        value: String,
        /// The domain in words.
        bounds: String,
    },
    /// A tooth as thick as the pitch leaves no space.
    #[error("the tooth thickness s_n is {thickness}; it must be below the normal pitch π m_n = {pitch}")]
    NoSpace {
        /// The tooth thickness.
        thickness: Length,
        /// The normal pitch.
        pitch: Length,
    },
    /// No error in the domain reaches the ΔCD asked for.
    #[error("no {error} reaches a ΔCD of {delta_cd}: the largest possible is {} mm", Rounded(.largest.mm()))]
    NeverReached {
        /// The error's name.
        error: &'static str,
        /// The ΔCD asked for.
        delta_cd: Length,
        /// The supremum of ΔCD over the domain.
        largest: Length,
    },
    /// An angle where the formula takes a length, or a length where it takes an angle.
    #[error("{value} has the wrong dimension for a {error} error")]
    WrongDimension {
        /// The error's name.
        error: &'static str,
        /// The value, with its unit.
        value: String,
    },
    /// A value or a result is larger than a length or an angle may be.
    #[error(transparent)]
    Overflow(#[from] QuantityError),
}

impl Domain {
    /// The domain of a length or angle that may be any finite number.
    #[must_use]
    pub const fn any(name: &'static str, symbol: &'static str) -> Self {
        Self { name, symbol, lower: Bound::Unbounded, upper: Bound::Unbounded }
    }

    /// The domain of everything above 0.
    #[must_use]
    pub const fn positive(name: &'static str, symbol: &'static str) -> Self {
        Self { name, symbol, lower: Bound::Excluded(0), upper: Bound::Unbounded }
    }

    /// Whether `value`, in the base unit, lies in the domain.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        let end = |bound: i64| bound as f64;
        (self.lower.map(end), self.upper.map(end)).contains(&value)
    }

    /// Checks a length.
    ///
    /// # Errors
    /// [`DomainError::Outside`] naming the quantity, the value and the domain.
    pub fn check_length(&self, value: Length) -> Result<(), DomainError> {
        self.check(value.mm(), &value, " mm")
    }

    /// Checks an angle.
    ///
    /// # Errors
    /// [`DomainError::Outside`] naming the quantity, the value and the domain.
    pub fn check_angle(&self, value: Angle) -> Result<(), DomainError> {
        self.check(value.degrees(), &value, "°")
    }

    fn check(&self, value: f64, text: &dyn fmt::Display, unit: &'static str) -> Result<(), DomainError> {
        if self.contains(value) {
            return Ok(());
        }
        Err(DomainError::Outside { domain: *self, value: text.to_string(), bounds: self.in_words(unit) })
    }

    /// The domain in words, with its bounds in `unit`: `above 0° and at most 45°`.
    #[must_use]
    pub fn in_words(&self, unit: &'static str) -> String {
        let end = |end: Bound<i64>, excluded: &str, included: &str| match end {
            Bound::Unbounded => None,
            Bound::Excluded(bound) => Some(format!("{excluded} {bound}{unit}")),
            Bound::Included(bound) => Some(format!("{included} {bound}{unit}")),
        };
        let (lower, upper) = (end(self.lower, "above", "at least"), end(self.upper, "below", "at most"));
        let bounds: Vec<_> = lower.into_iter().chain(upper).collect();
        if bounds.is_empty() { "a finite number".to_owned() } else { bounds.join(" and ") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_names_quantity_value_and_domain() {
        let domain = Domain {
            name: "normal pressure angle",
            symbol: "α_n",
            lower: Bound::Excluded(0),
            upper: Bound::Included(45),
        };
        let angle = |text: &str| text.parse::<Angle>().unwrap();
        assert_eq!(domain.check_angle(angle("45")), Ok(()));
        assert_eq!(domain.check_angle(angle("1e-12")), Ok(()));
        assert_eq!(
            domain.check_angle(angle("45.000000000001")).unwrap_err().to_string(),
            "the normal pressure angle α_n is 45.000000000001°; it must be above 0° and at most 45°"
        );
        assert_eq!(
            domain.check_angle(angle("0")).unwrap_err().to_string(),
            "the normal pressure angle α_n is 0°; it must be above 0° and at most 45°"
        );
        let width = Domain::positive("face width", "k");
        assert_eq!(
            width.check_length("-3".parse().unwrap()).unwrap_err().to_string(),
            "the face width k is -3 mm; it must be above 0 mm"
        );
    }
}
