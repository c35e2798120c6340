//! Domains: which values of a quantity make sense, and the error that says so. Declared by the formulas and the spec;
//! corrects nothing.

use std::fmt;

use thiserror::Error;

use super::{Angle, Length, QuantityError};

/// One end of a domain, in the quantity's base unit (mm or degrees).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DomainEnd {
    /// No bound.
    None,
    /// The bound itself is not in the domain.
    Exclusive(i64),
    /// The bound itself is in the domain.
    Inclusive(i64),
}

/// A named quantity and the values that it may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Domain {
    /// The quantity's name in the field: `normal pressure angle`.
    pub name: &'static str,
    /// Its symbol: `α_n`.
    pub symbol: &'static str,
    /// The lower end.
    pub lower: DomainEnd,
    /// The upper end.
    pub upper: DomainEnd,
}

/// A value outside its domain, or a result outside the numbers.
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
    /// No error in the domain reaches the ΔCD that was asked about.
    #[error("no {error} reaches a ΔCD of {delta_cd}: the largest possible is {largest}")]
    NeverReached {
        /// The error's name.
        error: &'static str,
        /// The ΔCD asked about.
        delta_cd: Length,
        /// The supremum of ΔCD over the domain.
        largest: Length,
    },
    /// A value is an angle where the formula takes a length, or the other way round.
    #[error("{value} is no value of a {error} error")]
    WrongDimension {
        /// The error's name.
        error: &'static str,
        /// The value, with its unit.
        value: String,
    },
    /// A value or a result is beyond what lengths and angles hold.
    #[error(transparent)]
    Overflow(#[from] QuantityError),
}

impl Domain {
    /// The domain of a length or angle that has none but being a number.
    #[must_use]
    pub const fn any(name: &'static str, symbol: &'static str) -> Self {
        Self { name, symbol, lower: DomainEnd::None, upper: DomainEnd::None }
    }

    /// The domain of everything above 0.
    #[must_use]
    pub const fn positive(name: &'static str, symbol: &'static str) -> Self {
        Self { name, symbol, lower: DomainEnd::Exclusive(0), upper: DomainEnd::None }
    }

    /// Whether `value`, in the base unit, lies in the domain.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        let above = match self.lower {
            DomainEnd::None => true,
            DomainEnd::Exclusive(bound) => value > bound as f64,
            DomainEnd::Inclusive(bound) => value >= bound as f64,
        };
        let below = match self.upper {
            DomainEnd::None => true,
            DomainEnd::Exclusive(bound) => value < bound as f64,
            DomainEnd::Inclusive(bound) => value <= bound as f64,
        };
        above && below
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
        let lower = match self.lower {
            DomainEnd::None => None,
            DomainEnd::Exclusive(bound) => Some(format!("above {bound}{unit}")),
            DomainEnd::Inclusive(bound) => Some(format!("at least {bound}{unit}")),
        };
        let upper = match self.upper {
            DomainEnd::None => None,
            DomainEnd::Exclusive(bound) => Some(format!("below {bound}{unit}")),
            DomainEnd::Inclusive(bound) => Some(format!("at most {bound}{unit}")),
        };
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
            lower: DomainEnd::Exclusive(0),
            upper: DomainEnd::Inclusive(45),
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
