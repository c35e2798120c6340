//! Why a deviation cannot be applied to a part. Raised where flanks are built; holds data, words only in `Display`.

use crate::quantity::{Degrees, Rounded};

named! {
    /// The quantity of a deviation's number.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    #[non_exhaustive]
    pub enum DeviationQuantity {
        /// A displacement in mm.
        Displacement = "displacement",
        /// A lead (helix angle) deviation in rad.
        Lead = "lead deviation",
        /// An eccentricity in mm.
        Eccentricity = "eccentricity",
        /// A flank form amount in mm.
        Form = "flank form",
    }
}

display_by_name!(DeviationQuantity);

impl DeviationQuantity {
    /// A value of the quantity, with its unit.
    fn shown(self, value: f64) -> String {
        match self {
            Self::Lead => Degrees(value).to_string(),
            Self::Displacement | Self::Eccentricity | Self::Form => format!("{} mm", Rounded(value)),
        }
    }
}

/// Why a deviation cannot be applied.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviationError {
    /// A value that is not finite or far beyond anything that could be a deviation.
    #[error("{quantity} = {} is outside ±{}", .quantity.shown(*.value), .quantity.shown(*.limit))]
    OutOfDomain {
        /// What the number is.
        quantity: DeviationQuantity,
        /// The number, mm or rad.
        value: f64,
        /// The largest magnitude allowed.
        limit: f64,
    },
    /// Crowning or relief that would add material.
    #[error("crowning and relief are material removed: {} mm is negative", Rounded(*.value_mm))]
    NegativeForm {
        /// The amount, mm.
        value_mm: f64,
    },
    /// A tip relief that starts at the tip or above it.
    #[error("the tip relief starts {} mm above the reference plane, the tip is at {} mm", Rounded(*.start_mm), Rounded(*.addendum_mm))]
    ReliefStart {
        /// Where it starts, mm.
        start_mm: f64,
        /// The addendum, mm.
        addendum_mm: f64,
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

/// Longest displacement of a deviation, mm: far above any real one, and such that products with tooth indices stay finite.
pub(crate) const MAX_LENGTH_MM: f64 = 1e6;

/// Largest single lead deviation, rad: 45°, a hundred times any measured one.
pub(crate) const MAX_LEAD_RAD: f64 = std::f64::consts::FRAC_PI_4;

/// Steepest tooth line that a lead deviation may lead to, rad: 85°.
pub(super) const MAX_HELIX_RAD: f64 = 85.0 * std::f64::consts::PI / 180.0;

pub(super) fn length(quantity: DeviationQuantity, value: f64) -> Result<f64, DeviationError> {
    within(quantity, value, MAX_LENGTH_MM)
}

pub(super) fn within(quantity: DeviationQuantity, value: f64, limit: f64) -> Result<f64, DeviationError> {
    if value.abs() <= limit { Ok(value) } else { Err(DeviationError::OutOfDomain { quantity, value, limit }) }
}
