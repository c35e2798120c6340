//! The names of the quantities that ΔCD follows from, for derivatives and uncertainties; they hold no value.

use crate::deviation::{DeviationKind, Part};

/// A quantity that ΔCD follows from, and that may be uncertain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Influence {
    /// A measured error.
    Error(DeviationKind),
    /// Normal module m_n, where an over-roller nominal is computed or the pair's geometry is known.
    NormalModule,
    /// Normal pressure angle α_n.
    NormalPressureAngle,
    /// Helix angle of the rack β_r.
    RackHelixAngle,
    /// Face width of the rack k.
    FaceWidth,
    /// Tooth thickness of the rack s_n, where an over-roller nominal is computed or the pair's geometry is known.
    ToothThickness,
    /// Distance K from the datum to the reference plane, where an over-roller nominal is computed.
    Datum,
    /// Diameter of the measuring roller, where an over-roller nominal is computed.
    Roller,
    /// Helix angle of the pinion β_p.
    PinionHelixAngle,
}

impl Influence {
    /// Every influence.
    pub const ALL: [Self; 14] = [
        Self::Error(DeviationKind::RackOverRoller),
        Self::Error(DeviationKind::RackPitch),
        Self::Error(DeviationKind::RackLead),
        Self::Error(DeviationKind::PinionRadial),
        Self::Error(DeviationKind::PinionPitch),
        Self::Error(DeviationKind::PinionLead),
        Self::NormalModule,
        Self::NormalPressureAngle,
        Self::RackHelixAngle,
        Self::FaceWidth,
        Self::ToothThickness,
        Self::Datum,
        Self::Roller,
        Self::PinionHelixAngle,
    ];

    /// The helix angle of a part.
    pub(super) const fn helix_angle_of(part: Part) -> Self {
        match part {
            Part::Rack => Self::RackHelixAngle,
            Part::Pinion => Self::PinionHelixAngle,
        }
    }

    /// The influence whose size a spec gives by this key.
    #[must_use]
    pub fn of_gear(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|influence| !matches!(influence, Self::Error(_)) && influence.key() == key)
    }

    /// Key, name in words, and whether the influence is an angle.
    const fn facts(self) -> (&'static str, &'static str, bool) {
        match self {
            Self::Error(kind @ DeviationKind::RackOverRoller) => ("errors.rack_over_roller", kind.name(), false),
            Self::Error(kind @ DeviationKind::RackPitch) => ("errors.rack_pitch", kind.name(), false),
            Self::Error(kind @ DeviationKind::RackLead) => ("errors.rack_lead", kind.name(), true),
            Self::Error(kind @ DeviationKind::PinionRadial) => ("errors.pinion_radial", kind.name(), false),
            Self::Error(kind @ DeviationKind::PinionPitch) => ("errors.pinion_pitch", kind.name(), false),
            Self::Error(kind @ DeviationKind::PinionLead) => ("errors.pinion_lead", kind.name(), false),
            Self::NormalModule => ("pair.normal_module", "normal module", false),
            Self::NormalPressureAngle => ("pair.normal_pressure_angle", "pressure angle", true),
            Self::RackHelixAngle => ("rack.helix_angle", "rack helix angle", true),
            Self::FaceWidth => ("rack.face_width", "face width", false),
            Self::ToothThickness => ("rack.tooth_thickness", "tooth thickness", false),
            Self::Datum => ("rack.datum", "datum", false),
            Self::Roller => ("errors.rack_over_roller.roller", "roller", false),
            Self::PinionHelixAngle => ("pinion.helix_angle", "pinion helix angle", true),
        }
    }

    /// The influence's key in specs and results: `errors.rack_pitch`, `pair.normal_pressure_angle`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.facts().0
    }

    /// Whether the influence is an angle (degrees); else it is a length (mm).
    #[must_use]
    pub const fn is_angle(self) -> bool {
        self.facts().2
    }
}

impl std::fmt::Display for Influence {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.facts().1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Section and key of a spec.
    #[test]
    fn errors_have_the_keys_of_their_section() {
        for kind in DeviationKind::ALL {
            assert_eq!(Influence::Error(kind).key(), format!("errors.{}", kind.key()));
        }
        assert_eq!(Influence::FaceWidth.key(), "rack.face_width");
    }
}
