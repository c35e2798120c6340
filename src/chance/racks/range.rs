//! Successive racks, and why their results cannot be put together.

use std::fmt;

use thiserror::Error;

/// Successive racks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "report", serde(deny_unknown_fields))]
pub struct RackRange {
    /// The number of the first one, from 0.
    pub first_rack: u64,
    /// How many.
    pub racks: u64,
}

impl RackRange {
    /// The number behind the last one.
    #[must_use]
    pub fn end(self) -> u64 {
        self.first_rack.saturating_add(self.racks)
    }

    pub(super) fn between(first_rack: u64, end: u64) -> Self {
        Self { first_rack, racks: end.saturating_sub(first_rack) }
    }
}

/// `racks 3 … 7`, or `rack 3`.
impl fmt::Display for RackRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.racks {
            0 => f.write_str("no racks"),
            1 => write!(f, "rack {}", self.first_rack),
            _ => write!(f, "racks {} … {}", self.first_rack, self.end() - 1),
        }
    }
}

/// Why results cannot be put together.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// Studies of different things.
    #[error("the studies are not of the same racks: the {what} is {here} in one and {there} in the other")]
    Other {
        /// What differs.
        what: &'static str,
        /// As one has it.
        here: String,
        /// As the other has it.
        there: String,
    },
    /// Racks that both studies have.
    #[error("both studies have {both}, which would count twice")]
    Overlap {
        /// The first range of them.
        both: RackRange,
    },
    /// Racks that were not asked for.
    #[error("the studies have {has}, and {asked} are asked for")]
    NotAsked {
        /// What they have.
        has: RackRange,
        /// What is asked for.
        asked: RackRange,
    },
    /// A ΔCD that is none.
    #[error("a ΔCD of {length_mm} mm cannot be counted")]
    NoLength {
        /// The ΔCD, mm.
        length_mm: f64,
    },
    /// Sums that do not fit 128 bits.
    #[error("these are more racks than one study can hold: the sum of ΔCD² has more than 128 bits")]
    TooMany,
    /// A study that no run has made.
    #[error("the study is damaged: {what}")]
    Damaged {
        /// What does not agree.
        what: &'static str,
    },
}
