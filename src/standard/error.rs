//! Why a standard gives no permissible value. Raised by the files of the standards.

use thiserror::Error;

use super::{Deviation, Size, Standard};

/// Why there is no permissible value.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum StandardError {
    /// A grade that the standard does not have.
    #[error("{standard} has grades {} to {}, not {grade}", .standard.grades().start(), .standard.grades().end())]
    Grade {
        /// The standard.
        standard: Standard,
        /// The grade asked for.
        grade: u8,
    },
    /// A deviation that the standard does not limit, or whose limits are not known here.
    #[error("{standard} gives no permissible value of {}", .standard.symbol(*.deviation))]
    NoSuchDeviation {
        /// The standard.
        standard: Standard,
        /// The deviation asked for.
        deviation: Deviation,
    },
    /// A size that the value depends on is missing.
    #[error("{} by {standard} needs the {}", .standard.symbol(*.deviation), .size.name())]
    Missing {
        /// The standard.
        standard: Standard,
        /// The deviation asked for.
        deviation: Deviation,
        /// The size.
        size: Size,
    },
    /// A size outside the standard's scope.
    #[error("the {} is {value}{}; {standard} covers {bound}{}", .size.name(), .size.unit(), .size.unit())]
    OutOfScope {
        /// The standard.
        standard: Standard,
        /// The size.
        size: Size,
        /// Its value, in the size's unit.
        value: String,
        /// The bounds in words, in the size's unit: `4 to 1000`.
        bound: String,
    },
    /// A cell of a table that no public source confirms.
    #[error("the value of {} of grade {grade} by {standard} is not confirmed here: {confirmed}", .standard.symbol(*.deviation))]
    Unconfirmed {
        /// The standard.
        standard: Standard,
        /// The deviation asked for.
        deviation: Deviation,
        /// The grade asked for.
        grade: u8,
        /// The cells that are confirmed, in words.
        confirmed: &'static str,
    },
}

/// A name that is not the name of a standard.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("`{text}` is not one of the standards {}; name the edition, because editions differ", ids())]
pub struct UnknownStandard {
    /// What was written.
    pub text: String,
}

fn ids() -> String {
    Standard::ALL.map(Standard::id).join(", ")
}
