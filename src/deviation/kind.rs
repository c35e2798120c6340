//! The kinds of manufacturing error that the formulas know, one value per part. Every layer above uses them; they hold no formula.

use std::fmt;

use super::{Countable, Extent};
use crate::quantity::{Angle, Length};
use crate::trig;

named! {
    /// A part of the pair.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    #[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
    pub enum Part {
        /// The rack.
        Rack = "rack",
        /// The pinion.
        Pinion = "pinion",
    }
}

/// A kind of manufacturing error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum DeviationKind {
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
    /// Helix slope deviation f_Hβ of the pinion.
    PinionLead,
}

impl DeviationKind {
    /// The kinds that the paper has a formula for, in its order.
    pub const OF_PAPER: [Self; 5] =
        [Self::RackOverRoller, Self::RackPitch, Self::RackLead, Self::PinionRadial, Self::PinionPitch];

    /// Every kind: the paper's in its order, then the others.
    pub const ALL: [Self; 6] = [
        Self::RackOverRoller,
        Self::RackPitch,
        Self::RackLead,
        Self::PinionRadial,
        Self::PinionPitch,
        Self::PinionLead,
    ];

    /// Its key, its name, the part that has it, what its extent counts, and its default extent.
    const fn row(self) -> (&'static str, &'static str, Part, Countable, Extent) {
        match self {
            Self::RackOverRoller => ("rack_over_roller", "rack over-roller", Part::Rack, Countable::Space, Extent::All),
            Self::RackPitch => ("rack_pitch", "rack pitch", Part::Rack, Countable::Pitch, Extent::One),
            Self::RackLead => ("rack_lead", "rack lead", Part::Rack, Countable::Tooth, Extent::All),
            Self::PinionRadial => ("pinion_radial", "pinion radial", Part::Pinion, Countable::Space, Extent::One),
            Self::PinionPitch => ("pinion_pitch", "pinion pitch", Part::Pinion, Countable::Pitch, Extent::One),
            Self::PinionLead => ("pinion_lead", "pinion lead", Part::Pinion, Countable::Tooth, Extent::All),
        }
    }

    /// The error's key in specs, tables and results: `rack_over_roller`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.row().0
    }

    /// The keys of several errors, as a list in a sentence.
    #[must_use]
    pub fn keys(kinds: impl IntoIterator<Item = Self>) -> String {
        kinds.into_iter().map(Self::key).collect::<Vec<_>>().join(", ")
    }

    /// The error's name for people: `rack over-roller`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().1
    }

    /// The part that has the error.
    #[must_use]
    pub const fn part(self) -> Part {
        self.row().2
    }

    /// What its extent counts.
    #[must_use]
    pub const fn counts(self) -> Countable {
        self.row().3
    }

    /// The default extent of a measured value.
    #[must_use]
    pub const fn usual_extent(self) -> Extent {
        self.row().4
    }

    /// Whether the error acts with its sign along the whole stroke (over-roller and radial errors), or
    /// varies between nothing and its value (pitch and lead errors).
    #[must_use]
    pub const fn always_acts(self) -> bool {
        matches!(self, Self::RackOverRoller | Self::PinionRadial)
    }
}

display_by_name!(DeviationKind);

/// A key of the spec, or a column of results, in words: `rack over-roller`.
#[cfg(any(feature = "report", feature = "spec"))]
pub(crate) fn key_in_words(key: &str) -> String {
    key.replace('_', " ").replace("over roller", "over-roller")
}

/// The value of an error: a length, or an angle for a lead error of the rack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DeviationValue {
    /// A deviation in length.
    Length(Length),
    /// A deviation in angle.
    Angle(Angle),
    /// The tangent of a deviation in angle: f_Hβ over its evaluation length.
    Slope(f64),
}

impl DeviationValue {
    /// A length in mm; `None` if the number is no length, or beyond the largest one.
    pub(crate) fn from_mm(mm: f64) -> Option<Self> {
        Length::from_mm(mm).ok().map(Self::Length)
    }

    /// An angle in rad; `None` if the number is no angle, or beyond the largest one.
    pub(crate) fn from_rad(rad: f64) -> Option<Self> {
        Angle::from_degrees(rad.to_degrees()).ok().map(Self::Angle)
    }

    /// An error of 0 of a kind.
    #[must_use]
    pub const fn zero(kind: DeviationKind) -> Self {
        match kind {
            DeviationKind::RackLead => Self::Angle(Angle::ZERO),
            _ => Self::Length(Length::ZERO),
        }
    }

    /// The value in its base unit, mm or degrees.
    #[must_use]
    pub fn base(self) -> f64 {
        match self {
            Self::Length(length) => length.mm(),
            Self::Angle(angle) => angle.degrees(),
            Self::Slope(slope) => trig::atan(slope).to_degrees(),
        }
    }

    /// The value less a nominal one of the same dimension.
    #[must_use]
    pub fn less(self, nominal: Self) -> Self {
        match (self, nominal) {
            (Self::Length(value), Self::Length(nominal)) => Self::Length(value - nominal),
            (Self::Angle(value), Self::Angle(nominal)) => Self::Angle(value - nominal),
            _ => self,
        }
    }

    /// The magnitude.
    #[must_use]
    pub fn abs(self) -> Self {
        match self {
            Self::Length(length) => Self::Length(length.abs()),
            Self::Angle(angle) => Self::Angle(angle.abs()),
            Self::Slope(slope) => Self::Slope(slope.abs()),
        }
    }

    /// Whether the value may be a size in place of an error or a limit: half a module or more (a millimetre where the module is not
    /// known), or a degree.
    #[cfg(feature = "table")]
    pub(crate) fn is_size(self, module: Option<Length>) -> bool {
        match (self, module) {
            (Self::Length(length), Some(module)) => length.abs().mm() >= module.mm() / 2.0,
            _ => self.abs().base() >= 1.0,
        }
    }

    /// Whether the error is 0.
    #[must_use]
    pub fn is_zero(self) -> bool {
        match self {
            Self::Length(length) => length.is_zero(),
            Self::Angle(angle) => angle.is_zero(),
            Self::Slope(slope) => slope == 0.0,
        }
    }
}

impl fmt::Display for DeviationValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(length) => length.fmt(f),
            Self::Angle(angle) => angle.fmt(f),
            Self::Slope(_) => write!(f, "{}°", self.base()),
        }
    }
}

impl From<Length> for DeviationValue {
    fn from(length: Length) -> Self {
        Self::Length(length)
    }
}

impl From<Angle> for DeviationValue {
    fn from(angle: Angle) -> Self {
        Self::Angle(angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_those_of_a_spec() {
        let keys = ["rack_over_roller", "rack_pitch", "rack_lead", "pinion_radial", "pinion_pitch", "pinion_lead"];
        assert_eq!(DeviationKind::ALL.map(DeviationKind::key), keys);
        assert!(DeviationKind::ALL.starts_with(&DeviationKind::OF_PAPER));
    }

    #[test]
    fn keys_begin_with_the_part() {
        for kind in DeviationKind::ALL {
            assert!(kind.key().starts_with(kind.part().name()), "{kind}");
        }
    }
}
