//! The quantities that ΔCD follows from, and how uncertain one of them is. Built by the spec layer and by callers;
//! holds numbers only, and knows nothing of formulas.

use crate::deviation::DeviationKind;

/// A quantity that ΔCD follows from and that may be uncertain.
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
    /// All of them.
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

    /// The quantity of the gear whose size stands under a key of a spec.
    #[must_use]
    pub fn of_gear(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|source| !matches!(source, Self::Error(_)) && source.key() == key)
    }

    /// Its key, its words, and whether it is an angle.
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

    /// Its key in specs and results: `errors.rack_pitch`, `pair.normal_pressure_angle`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.facts().0
    }

    /// Whether it is an angle (degrees); otherwise it is a length (mm).
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

/// How the values that a quantity may have are distributed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Distribution {
    /// Normal; Student's t where the degrees of freedom are finite (JCGM 101, 6.4.9).
    Normal,
    /// Any value within the half-width alike: u = a/√3.
    Rectangular,
    /// Falling linearly from the middle: u = a/√6.
    Triangular,
    /// As of a sine wave, mostly near the ends: u = a/√2.
    Arcsine,
}

impl Distribution {
    /// Its name in specs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::Rectangular => "rectangular",
            Self::Triangular => "triangular",
            Self::Arcsine => "arcsine",
        }
    }

    /// Half-width in standard uncertainties; of a normal distribution, that of 95.45 %.
    #[must_use]
    pub fn half_width(self) -> f64 {
        match self {
            Self::Normal => 2.0,
            Self::Rectangular => 3.0_f64.sqrt(),
            Self::Triangular => 6.0_f64.sqrt(),
            Self::Arcsine => std::f64::consts::SQRT_2,
        }
    }
}

/// The uncertainty of one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// Standard uncertainty u, mm or degrees.
    pub standard: f64,
    /// How its values are distributed.
    pub distribution: Distribution,
    /// Degrees of freedom ν of u; infinite if u is known well.
    pub dof: f64,
}

impl Uncertainty {
    /// A standard uncertainty that is known well, normal.
    #[must_use]
    pub const fn standard(u: f64) -> Self {
        Self { standard: u, distribution: Distribution::Normal, dof: f64::INFINITY }
    }

    /// From an expanded uncertainty U = k u.
    #[must_use]
    pub fn expanded(expanded: f64, k: f64) -> Self {
        Self::standard(expanded / k)
    }

    /// From a half-width and its distribution.
    #[must_use]
    pub fn half_width(half_width: f64, distribution: Distribution) -> Self {
        Self { standard: half_width / distribution.half_width(), distribution, dof: f64::INFINITY }
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
