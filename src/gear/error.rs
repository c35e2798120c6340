//! Why a geometry cannot be built. Raised by [`Pair::new`](super::Pair::new).

use crate::quantity::{Degrees, Rounded};

/// A quantity of the pair's drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PairSize {
    /// Normal module m_n.
    NormalModule,
    /// Normal pressure angle α_n.
    NormalPressureAngle,
    /// Rack helix angle β_r.
    RackHelixAngle,
    /// Rack face width k.
    RackFaceWidth,
    /// Rack addendum.
    RackAddendum,
    /// Rack normal tooth thickness.
    RackToothThickness,
    /// Pinion number of teeth z.
    PinionTeeth,
    /// Pinion helix angle β_p.
    PinionHelixAngle,
    /// Pinion profile shift coefficient x.
    PinionProfileShift,
    /// Pinion tip diameter.
    PinionTipDiameter,
    /// Pinion root form diameter.
    PinionRootFormDiameter,
    /// Pinion face width b.
    PinionFaceWidth,
    /// Pinion tooth thickness deviation.
    PinionToothThicknessDeviation,
}

impl PairSize {
    /// Its name, its unit and its key in a spec.
    const fn facts(self) -> [&'static str; 3] {
        match self {
            Self::NormalModule => ["normal module", "mm", "pair.normal_module"],
            Self::NormalPressureAngle => ["normal pressure angle", "rad", "pair.normal_pressure_angle"],
            Self::RackHelixAngle => ["rack helix angle", "rad", "rack.helix_angle"],
            Self::RackFaceWidth => ["rack face width", "mm", "rack.face_width"],
            Self::RackAddendum => ["rack addendum", "mm", "rack.addendum"],
            Self::RackToothThickness => ["rack tooth thickness", "mm", "rack.tooth_thickness"],
            Self::PinionTeeth => ["pinion number of teeth", "", "pinion.teeth"],
            Self::PinionHelixAngle => ["pinion helix angle", "rad", "pinion.helix_angle"],
            Self::PinionProfileShift => ["pinion profile shift", "", "pinion.profile_shift"],
            Self::PinionTipDiameter => ["pinion tip diameter", "mm", "pinion.tip_diameter"],
            Self::PinionRootFormDiameter => ["pinion root form diameter", "mm", "pinion.root_form_diameter"],
            Self::PinionFaceWidth => ["pinion face width", "mm", "pinion.face_width"],
            Self::PinionToothThicknessDeviation => {
                ["pinion tooth thickness deviation", "mm", "pinion.tooth_thickness_deviation"]
            }
        }
    }

    /// Its name: `normal module`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.facts()[0]
    }

    /// The unit of its values: `mm`, `rad`, or empty for a number.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        self.facts()[1]
    }

    /// Its key in a spec: `pair.normal_module`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.facts()[2]
    }

    /// A value of it, with its unit; angles in degrees.
    fn shown(self, value: f64) -> String {
        match self.unit() {
            "rad" => Degrees(value).to_string(),
            unit => format!("{} {unit}", Rounded(value)).trim_end().to_owned(),
        }
    }
}

display_by_name!(PairSize);

/// Why a rack and pinion with these numbers cannot exist or cannot mesh.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// A value outside its domain; NaN and infinities always are.
    #[error("{quantity} = {} is outside {} .. {}", .quantity.shown(*.value), .quantity.shown(*.min), .quantity.shown(*.max))]
    OutOfDomain {
        /// Which number.
        quantity: PairSize,
        /// Its value, in the quantity's unit.
        value: f64,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
    },
    /// The rack's flanks meet below its tip plane.
    #[error(
        "rack tooth is pointed: normal thickness {} mm at the tip plane, addendum {} mm", Rounded(*.tip_thickness_mm), Rounded(*.addendum_mm)
    )]
    PointedRack {
        /// Normal tooth thickness at the tip plane, mm, not positive.
        tip_thickness_mm: f64,
        /// The addendum, mm.
        addendum_mm: f64,
    },
    /// The rack's teeth are as thick as the pitch, or thicker: no space is left for the pinion.
    #[error("rack tooth space has no width: normal thickness {} mm, normal pitch {} mm", Rounded(*.tooth_thickness_mm), Rounded(*.pitch_mm))]
    NoRackSpace {
        /// Normal tooth thickness at the reference plane, mm.
        tooth_thickness_mm: f64,
        /// Normal pitch, mm.
        pitch_mm: f64,
    },
    /// The pinion's flanks meet below its tip circle.
    #[error("pinion tooth is pointed: transverse thickness {} mm at tip diameter {} mm", Rounded(*.tip_thickness_mm), Rounded(*.tip_diameter_mm))]
    PointedPinion {
        /// Transverse tooth thickness at the tip, mm, not positive.
        tip_thickness_mm: f64,
        /// The tip diameter, mm.
        tip_diameter_mm: f64,
    },
    /// The involute has no length: its start lies at or outside the tip.
    #[error(
        "pinion has no involute: it starts at diameter {} mm and the tip is at {} mm", Rounded(*.start_diameter_mm), Rounded(*.tip_diameter_mm)
    )]
    NoInvolute {
        /// Diameter at which the involute starts (root form, at least the base circle), mm.
        start_diameter_mm: f64,
        /// The tip diameter, mm.
        tip_diameter_mm: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Angles in degrees, lengths in mm, numbers of teeth and shifts as they are.
    #[test]
    fn what_is_outside_its_domain_is_said_in_its_unit() {
        let said = |quantity, value, min, max| GeometryError::OutOfDomain { quantity, value, min, max }.to_string();
        assert_eq!(said(PairSize::PinionTeeth, 0.0, 1.0, 10_000.0), "pinion number of teeth = 0 is outside 1 .. 10000");
        assert_eq!(
            said(PairSize::PinionProfileShift, 11.0, -10.0, 10.0),
            "pinion profile shift = 11 is outside -10 .. 10"
        );
        assert_eq!(said(PairSize::RackFaceWidth, 0.0, 0.5, 20.0), "rack face width = 0 mm is outside 0.5 mm .. 20 mm");
        let quarter = std::f64::consts::FRAC_PI_2;
        assert_eq!(
            said(PairSize::PinionHelixAngle, quarter, -0.5 * quarter, 0.5 * quarter),
            "pinion helix angle = 90° is outside -45° .. 45°"
        );
        let units = [PairSize::PinionTeeth, PairSize::RackHelixAngle, PairSize::RackAddendum].map(PairSize::unit);
        assert_eq!(units, ["", "rad", "mm"]);
    }
}
