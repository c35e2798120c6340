//! The kinds of manufacturing error that the formulas know, one value per part. Named by every layer above; holds no
//! formula.

use std::fmt;

use crate::quantity::{Angle, Length};

/// A part of the pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Part {
    /// The rack.
    Rack,
    /// The pinion.
    Pinion,
}

impl Part {
    /// `rack` or `pinion`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rack => "rack",
            Self::Pinion => "pinion",
        }
    }
}

/// A kind of manufacturing error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum ErrorKind {
    /// Over-roller error of the rack: a shift of its pitch line.
    RackOverRoller,
    /// Pitch error of the rack.
    RackPitch,
    /// Lead angle error of the rack.
    RackLead,
    /// Radial measurement error of the pinion.
    PinionRadial,
    /// Single pitch deviation of the pinion.
    PinionPitch,
}

impl ErrorKind {
    /// Every kind, in the paper's order.
    pub const ALL: [Self; 5] =
        [Self::RackOverRoller, Self::RackPitch, Self::RackLead, Self::PinionRadial, Self::PinionPitch];

    /// The key that specs, tables and results call it by: `rack_over_roller`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::RackOverRoller => "rack_over_roller",
            Self::RackPitch => "rack_pitch",
            Self::RackLead => "rack_lead",
            Self::PinionRadial => "pinion_radial",
            Self::PinionPitch => "pinion_pitch",
        }
    }

    /// The name that people read: `rack over-roller`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::RackOverRoller => "rack over-roller",
            Self::RackPitch => "rack pitch",
            Self::RackLead => "rack lead",
            Self::PinionRadial => "pinion radial",
            Self::PinionPitch => "pinion pitch",
        }
    }

    /// Whether the error acts with its sign along the whole stroke (over-roller and radial errors), or
    /// varies between nothing and its value (pitch and lead errors).
    #[must_use]
    pub const fn always_acts(self) -> bool {
        matches!(self, Self::RackOverRoller | Self::PinionRadial)
    }
}

impl fmt::Display for ErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The value of an error: a length, or an angle for a lead error.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ErrorValue {
    /// A deviation in length.
    Length(Length),
    /// A deviation in angle.
    Angle(Angle),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_those_of_a_spec() {
        let keys = ["rack_over_roller", "rack_pitch", "rack_lead", "pinion_radial", "pinion_pitch"];
        assert_eq!(ErrorKind::ALL.map(ErrorKind::key), keys);
    }
}
