//! Why a deviation cannot be applied to a part. Raised where flanks are built; holds data, words only in `Display`.

use std::fmt;

/// What a deviation's number is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DeviationQuantity {
    /// A displacement in mm.
    Displacement,
    /// A lead (helix angle) deviation in rad.
    Lead,
    /// An eccentricity in mm.
    Eccentricity,
    /// A flank form amount in mm.
    Form,
}

impl fmt::Display for DeviationQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Displacement => "displacement",
            Self::Lead => "lead deviation",
            Self::Eccentricity => "eccentricity",
            Self::Form => "flank form",
        })
    }
}

/// Why a deviation cannot be applied.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviationError {
    /// A value that is not finite or far beyond anything that could be a deviation.
    #[error("{quantity} = {value} is outside ±{limit}")]
    OutOfDomain {
        /// What the number is.
        quantity: DeviationQuantity,
        /// The number, mm or rad.
        value: f64,
        /// The largest magnitude allowed.
        limit: f64,
    },
    /// A pinion tooth that does not exist.
    #[error("pinion tooth {tooth} does not exist: the teeth are 0..={}", .teeth - 1)]
    NoSuchTooth {
        /// The tooth asked for.
        tooth: i64,
        /// Number of teeth.
        teeth: u32,
    },
    /// A measured turn of the pinion with a tooth missing or twice.
    #[error("pinion tooth {tooth} has {rows} rows of measured pitch; each tooth needs exactly one")]
    IncompleteTurn {
        /// The tooth.
        tooth: i64,
        /// How many rows it has.
        rows: usize,
    },
}

/// Longest displacement taken for a deviation, mm; anything near it is a mistake in units, and products with
/// tooth indices stay finite.
const MAX_LENGTH_MM: f64 = 1e6;

pub(super) fn length(quantity: DeviationQuantity, value: f64) -> Result<f64, DeviationError> {
    within(quantity, value, MAX_LENGTH_MM)
}

pub(super) fn within(quantity: DeviationQuantity, value: f64, limit: f64) -> Result<f64, DeviationError> {
    if value.abs() <= limit { Ok(value) } else { Err(DeviationError::OutOfDomain { quantity, value, limit }) }
}
