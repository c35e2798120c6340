//! What a column can hold: names and errors of parts, sizes of spaces and teeth, and what stands beside them. Knows no headings.

use crate::deviation::DeviationKind;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Field {
    /// The part's name or number.
    PartId,
    /// One value per part.
    Error(DeviationKind),
    /// Number of a rack's space.
    Space,
    /// Measure over the pin in one space.
    OverPin,
    /// Position of the pin in one space.
    Position,
    /// Number of a pinion's tooth.
    Tooth,
    /// Radial deviation of the space after a tooth.
    Radial,
    /// Single pitch deviation of a left flank.
    LeftPitch,
    /// Single pitch deviation of a right flank.
    RightPitch,
    /// Helix angle deviation of a space or tooth.
    Lead,
    /// Stroke at a point of a measured curve.
    Stroke,
    /// ΔCD at that point.
    DeltaCd,
}

impl Field {
    /// Its name in a contract, in `--as` and in messages.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::PartId => "part_id",
            Self::Error(kind) => kind.key(),
            Self::Space => "space",
            Self::OverPin => "over_pin",
            Self::Position => "position",
            Self::Tooth => "tooth",
            Self::Radial => "radial",
            Self::LeftPitch => "left_pitch",
            Self::RightPitch => "right_pitch",
            Self::Lead => "lead",
            Self::Stroke => "stroke",
            Self::DeltaCd => "delta_cd",
        }
    }

    /// Every field that can be asked for.
    pub const ALL: [Self; 17] = [
        Self::PartId,
        Self::Error(DeviationKind::RackOverRoller),
        Self::Error(DeviationKind::RackPitch),
        Self::Error(DeviationKind::RackLead),
        Self::Error(DeviationKind::PinionRadial),
        Self::Error(DeviationKind::PinionPitch),
        Self::Error(DeviationKind::PinionLead),
        Self::Space,
        Self::OverPin,
        Self::Position,
        Self::Tooth,
        Self::Radial,
        Self::LeftPitch,
        Self::RightPitch,
        Self::Lead,
        Self::Stroke,
        Self::DeltaCd,
    ];

    /// Whether the column holds whole numbers or names rather than measured values.
    #[must_use]
    pub const fn is_index(self) -> bool {
        matches!(self, Self::PartId | Self::Space | Self::Tooth)
    }

    /// Whether a pinion's teeth have it and a rack's spaces do not.
    pub(crate) const fn is_of_tooth(self) -> bool {
        matches!(
            self,
            Self::Tooth | Self::LeftPitch | Self::RightPitch | Self::Radial | Self::Error(DeviationKind::PinionRadial)
        )
    }

    /// Whether it is a size or an angle of a space or tooth.
    pub(crate) const fn is_of_space_or_tooth(self) -> bool {
        matches!(self, Self::OverPin | Self::Position | Self::Radial | Self::LeftPitch | Self::RightPitch | Self::Lead)
    }

    /// Whether the points of a measured curve have it.
    pub(crate) const fn is_of_trace(self) -> bool {
        matches!(self, Self::Stroke | Self::DeltaCd)
    }

    /// Whether its values are deviations, whatever the heading says.
    pub(crate) const fn is_deviation(self) -> bool {
        matches!(self, Self::Radial | Self::LeftPitch | Self::RightPitch | Self::Lead)
    }

    /// Whether its values are angles.
    #[must_use]
    pub const fn is_angle(self) -> bool {
        matches!(self, Self::Lead | Self::Error(DeviationKind::RackLead))
    }

    /// The error of a part that it is, or that a size of a space or tooth belongs to.
    pub(crate) const fn kind(self) -> Option<DeviationKind> {
        match self {
            Self::Error(kind) => Some(kind),
            Self::OverPin => Some(DeviationKind::RackOverRoller),
            Self::Lead => Some(DeviationKind::RackLead),
            Self::Radial => Some(DeviationKind::PinionRadial),
            _ => None,
        }
    }
}

impl From<DeviationKind> for Field {
    fn from(kind: DeviationKind) -> Self {
        Self::Error(kind)
    }
}

/// A name that no field has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("it is none of {}", Field::ALL.map(Field::key).join(", "))]
pub struct UnknownField;

impl std::str::FromStr for Field {
    type Err = UnknownField;

    fn from_str(text: &str) -> Result<Self, UnknownField> {
        Self::ALL.into_iter().find(|field| field.key() == text).ok_or(UnknownField)
    }
}

/// Whether a column holds the measured value itself or its deviation from nominal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ValueKind {
    /// The value.
    Measured,
    /// Measured minus nominal.
    Deviation,
}

/// What a column holds beside a value, or in a table with a row per characteristic. The companions of a value come first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Beside {
    /// Measured minus nominal.
    Deviation,
    /// The nominal value.
    Nominal,
    /// The upper tolerance or limit, or the tolerance to both sides.
    Upper,
    /// The lower tolerance or limit.
    Lower,
    /// How uncertain the measured value is.
    Uncertainty,
    /// The unit of the row.
    Unit,
    /// The evaluation length of f_Hβ.
    Length,
    /// The measured value.
    Measured,
    /// What was measured.
    Name,
}

impl Beside {
    /// Each with the key by which a contract names it, in their order.
    const KEYS: [(Self, &'static str); 9] = [
        (Self::Deviation, "deviation"),
        (Self::Nominal, "nominal"),
        (Self::Upper, "upper"),
        (Self::Lower, "lower"),
        (Self::Uncertainty, "uncertainty"),
        (Self::Unit, "unit"),
        (Self::Length, "length"),
        (Self::Measured, "actual"),
        (Self::Name, "name"),
    ];

    /// The key by which a contract names it.
    pub(crate) const fn key(self) -> &'static str {
        Self::KEYS[self as usize].1
    }

    /// What the key names.
    pub(crate) fn of_key(key: &str) -> Option<Self> {
        Self::KEYS.into_iter().find(|(_, own)| *own == key).map(|(beside, _)| beside)
    }
}
