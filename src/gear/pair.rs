//! The nominal pair with every derived value. Built by the spec, read by all that computes with gears.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::{GeometryError, PairData, PairSize};
use crate::trig;

/// The rack of a [`Pair`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rack {
    /// Helix angle β_r, right hand positive, rad.
    pub helix_angle_rad: f64,
    /// Face width k along Y, mm.
    pub face_width_mm: f64,
    /// Addendum: height of the tip plane above the reference plane, mm.
    pub addendum_mm: f64,
    /// Normal tooth thickness s_n at the reference plane, mm.
    pub tooth_thickness_mm: f64,
    /// Pitch along X, p_x = π m_n / cos β_r, mm.
    pub pitch_mm: f64,
    /// Tangent of the pressure angle in the X-Z plane, tan α_x = tan α_n / cos β_r.
    pub tan_pressure_angle_x: f64,
}

/// The pinion of a [`Pair`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinion {
    /// Number of teeth z.
    pub teeth: u32,
    /// Helix angle β_p at the reference cylinder, right hand positive, rad.
    pub helix_angle_rad: f64,
    /// Helix angle β_b at the base cylinder, sin β_b = sin β_p cos α_n, rad.
    pub base_helix_angle_rad: f64,
    /// Profile shift coefficient x.
    pub profile_shift: f64,
    /// Face width b along the axis, mm.
    pub face_width_mm: f64,
    /// Reference radius r = m_n z / (2 cos β_p), mm.
    pub reference_radius_mm: f64,
    /// Base radius r_b = r cos α_t, mm.
    pub base_radius_mm: f64,
    /// Tip radius r_a, mm.
    pub tip_radius_mm: f64,
    /// Root form radius r_f, at which the involute starts, at least r_b, mm.
    pub root_form_radius_mm: f64,
    /// Transverse pressure angle at the reference circle, tan α_t = tan α_n / cos β_p, rad.
    pub transverse_pressure_angle_rad: f64,
    /// Transverse pitch at the reference circle, p_t = π m_n / cos β_p, mm.
    pub transverse_pitch_mm: f64,
    /// Transverse tooth thickness at the reference circle, mm.
    pub tooth_thickness_mm: f64,
    /// Roll angle of the involute at its start, √((r_f/r_b)² − 1), rad.
    pub start_roll_rad: f64,
    /// Roll angle of the involute at the tip, √((r_a/r_b)² − 1), rad.
    pub tip_roll_rad: f64,
    /// Half the angle of a tooth at the base circle, ψ_b = s_t/(2r) + inv α_t, rad.
    pub base_half_angle_rad: f64,
}

/// A crossed helical rack and pinion with checked numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    normal_module_mm: f64,
    normal_pressure_angle_rad: f64,
    rack: Rack,
    pinion: Pinion,
}

/// Widths and diameters: wider than any gear made, and narrow enough that nothing derived overflows.
const LENGTH_MM: (f64, f64) = (1e-6, 1e9);
/// Modules: a smaller or larger one is a mistake in the unit.
const MODULE_MM: (f64, f64) = (1e-3, 1e3);
/// Normal pressure angles, 1° to 60°: below, 1 / tan α_n amplifies every error; above, no tooth is left.
const PRESSURE_ANGLE_RAD: (f64, f64) = (PI / 180.0, PI / 3.0);
/// Helix angles, ±80°: beyond lie single-start worms.
const HELIX_RAD: (f64, f64) = (-80.0 * PI / 180.0, 80.0 * PI / 180.0);
/// The most teeth of a pinion.
pub const MOST_TEETH: u32 = 10_000;
/// Numbers of teeth.
const TEETH: (f64, f64) = (1.0, MOST_TEETH as f64);
/// Profile shift coefficients.
const SHIFT: (f64, f64) = (-10.0, 10.0);

fn within(quantity: PairSize, value: f64, (min, max): (f64, f64)) -> Result<f64, GeometryError> {
    if value >= min && value <= max { Ok(value) } else { Err(GeometryError::OutOfDomain { quantity, value, min, max }) }
}

impl Pair {
    /// Checks the numbers of a drawing and derives all that follows from them.
    ///
    /// # Errors
    /// [`GeometryError::OutOfDomain`] names the first number outside its domain; the other variants say
    /// that a tooth has no tip, no space or no involute. Geometry that meshes badly is no error: [`Pair::warnings`] lists it.
    pub fn new(data: &PairData) -> Result<Self, GeometryError> {
        let m_n = within(PairSize::NormalModule, data.normal_module_mm, MODULE_MM)?;
        let alpha_n = within(PairSize::NormalPressureAngle, data.normal_pressure_angle_rad, PRESSURE_ANGLE_RAD)?;
        let tan_n = trig::tan(alpha_n);
        let rack = Self::rack_of(data, m_n, tan_n)?;
        let pinion = Self::pinion_of(data, m_n, alpha_n)?;
        Ok(Self { normal_module_mm: m_n, normal_pressure_angle_rad: alpha_n, rack, pinion })
    }

    fn rack_of(data: &PairData, m_n: f64, tan_n: f64) -> Result<Rack, GeometryError> {
        let raw = &data.rack;
        let beta = within(PairSize::RackHelixAngle, raw.helix_angle_rad, HELIX_RAD)?;
        let face = within(PairSize::RackFaceWidth, raw.face_width_mm, LENGTH_MM)?;
        let addendum = within(PairSize::RackAddendum, raw.addendum_mm, (-10.0 * m_n, 10.0 * m_n))?;
        let thickness = match raw.tooth_thickness_mm {
            None => FRAC_PI_2 * m_n,
            Some(value) => within(PairSize::RackToothThickness, value, (1e-6 * m_n, 10.0 * m_n))?,
        };
        if thickness >= PI * m_n {
            return Err(GeometryError::NoRackSpace { tooth_thickness_mm: thickness, pitch_mm: PI * m_n });
        }
        let tip_thickness = thickness - 2.0 * addendum * tan_n;
        if tip_thickness <= 0.0 {
            return Err(GeometryError::PointedRack { tip_thickness_mm: tip_thickness, addendum_mm: addendum });
        }
        let cos_beta = trig::cos(beta);
        Ok(Rack {
            helix_angle_rad: beta,
            face_width_mm: face,
            addendum_mm: addendum,
            tooth_thickness_mm: thickness,
            pitch_mm: PI * m_n / cos_beta,
            tan_pressure_angle_x: tan_n / cos_beta,
        })
    }

    fn pinion_of(data: &PairData, m_n: f64, alpha_n: f64) -> Result<Pinion, GeometryError> {
        let raw = &data.pinion;
        let (sin_n, cos_n) = trig::sin_cos(alpha_n);
        let tan_n = sin_n / cos_n;
        let z = within(PairSize::PinionTeeth, f64::from(raw.teeth), TEETH)?;
        let beta = within(PairSize::PinionHelixAngle, raw.helix_angle_rad, HELIX_RAD)?;
        let x = within(PairSize::PinionProfileShift, raw.profile_shift, SHIFT)?;
        let face = within(PairSize::PinionFaceWidth, raw.face_width_mm, LENGTH_MM)?;
        let (sin_beta, cos_beta) = trig::sin_cos(beta);
        let r = m_n * z / (2.0 * cos_beta);
        let tip = within(PairSize::PinionTipDiameter, raw.tip_diameter_mm, (1e-6, 4.0 * r + 40.0 * m_n))?;
        let deviation = within(
            PairSize::PinionToothThicknessDeviation,
            raw.tooth_thickness_deviation_mm,
            (-10.0 * m_n, 10.0 * m_n),
        )?;
        let alpha_t = trig::atan(tan_n / cos_beta);
        let r_b = r * trig::cos(alpha_t);
        let start = match raw.root_form_diameter_mm {
            None => r_b,
            Some(value) => (within(PairSize::PinionRootFormDiameter, value, (0.0, 1e9))? / 2.0).max(r_b),
        };
        let r_a = tip / 2.0;
        if start >= r_a {
            return Err(GeometryError::NoInvolute { start_diameter_mm: 2.0 * start, tip_diameter_mm: tip });
        }
        let roll = |radius: f64| ((radius - r_b) * (radius + r_b)).max(0.0).sqrt() / r_b;
        let thickness = (FRAC_PI_2 + 2.0 * x * tan_n) * m_n / cos_beta + deviation;
        // inv α_t = tan α_t − α_t
        let base_half_angle = thickness / (2.0 * r) + (tan_n / cos_beta - alpha_t);
        let pinion = Pinion {
            teeth: raw.teeth,
            helix_angle_rad: beta,
            base_helix_angle_rad: trig::asin(sin_beta * cos_n),
            profile_shift: x,
            face_width_mm: face,
            reference_radius_mm: r,
            base_radius_mm: r_b,
            tip_radius_mm: r_a,
            root_form_radius_mm: start,
            transverse_pressure_angle_rad: alpha_t,
            transverse_pitch_mm: PI * m_n / cos_beta,
            tooth_thickness_mm: thickness,
            start_roll_rad: roll(start),
            tip_roll_rad: roll(r_a),
            base_half_angle_rad: base_half_angle,
        };
        let tip_thickness = pinion.tip_thickness_mm();
        if tip_thickness <= 0.0 {
            return Err(GeometryError::PointedPinion { tip_thickness_mm: tip_thickness, tip_diameter_mm: tip });
        }
        Ok(pinion)
    }

    /// Normal module m_n, mm.
    #[must_use]
    pub const fn normal_module_mm(&self) -> f64 {
        self.normal_module_mm
    }

    /// Normal pressure angle α_n, rad.
    #[must_use]
    pub const fn normal_pressure_angle_rad(&self) -> f64 {
        self.normal_pressure_angle_rad
    }

    /// The rack.
    #[must_use]
    pub const fn rack(&self) -> &Rack {
        &self.rack
    }

    /// The pinion.
    #[must_use]
    pub const fn pinion(&self) -> &Pinion {
        &self.pinion
    }

    /// Shaft angle Σ = β_r + β_p, rad.
    #[must_use]
    pub fn shaft_angle_rad(&self) -> f64 {
        self.rack.helix_angle_rad + self.pinion.helix_angle_rad
    }

    /// Nominal centre distance a_0 = r + x m_n, from the rack's reference plane to the pinion's axis, mm.
    /// A nominal tooth thickness that differs from π m_n / 2 does not change a_0; it is part of ΔCD = a − a_0.
    #[must_use]
    pub fn nominal_center_distance_mm(&self) -> f64 {
        self.pinion.reference_radius_mm + self.pinion.profile_shift * self.normal_module_mm
    }

    /// Pinion rotation per stroke, 2π / (z p_x), rad/mm.
    #[must_use]
    pub fn rotation_per_stroke_rad(&self) -> f64 {
        TAU / (f64::from(self.pinion.teeth) * self.rack.pitch_mm)
    }
}

impl Pinion {
    /// Transverse tooth thickness at the tip circle, 2 r_a (ψ_b − inv α_a) with cos α_a = r_b / r_a, mm.
    #[must_use]
    pub fn tip_thickness_mm(&self) -> f64 {
        let inv = self.tip_roll_rad - trig::atan(self.tip_roll_rad);
        2.0 * self.tip_radius_mm * (self.base_half_angle_rad - inv)
    }

    /// Angle from one tooth to the next, 2π/z, rad.
    #[must_use]
    pub fn angular_pitch_rad(&self) -> f64 {
        TAU / f64::from(self.teeth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::example;

    fn near(value: f64, expected: f64) {
        assert!((value - expected).abs() < 1e-13 * expected.abs().max(1.0), "{value} {expected}");
    }

    /// Each number at its bounds, just beyond them, and none at all; module 2, 20 teeth.
    #[test]
    fn each_number_has_its_bounds() {
        type Set = fn(&mut PairData, f64);
        let cases: [(PairSize, Set, f64, f64); 12] = [
            (PairSize::NormalModule, |data, value| data.normal_module_mm = value, 1e-3, 1e3),
            (
                PairSize::NormalPressureAngle,
                |data, value| data.normal_pressure_angle_rad = value,
                0.017_453_292_519_943_295,
                1.047_197_551_196_597_6,
            ),
            (
                PairSize::RackHelixAngle,
                |data, value| data.rack.helix_angle_rad = value,
                -1.396_263_401_595_463_6,
                1.396_263_401_595_463_6,
            ),
            (PairSize::RackFaceWidth, |data, value| data.rack.face_width_mm = value, 1e-6, 1e9),
            (PairSize::RackAddendum, |data, value| data.rack.addendum_mm = value, -20.0, 20.0),
            (PairSize::RackToothThickness, |data, value| data.rack.tooth_thickness_mm = Some(value), 2e-6, 20.0),
            (
                PairSize::PinionHelixAngle,
                |data, value| data.pinion.helix_angle_rad = value,
                -1.396_263_401_595_463_6,
                1.396_263_401_595_463_6,
            ),
            (PairSize::PinionProfileShift, |data, value| data.pinion.profile_shift = value, -10.0, 10.0),
            (PairSize::PinionFaceWidth, |data, value| data.pinion.face_width_mm = value, 1e-6, 1e9),
            // four reference radii and forty modules
            (PairSize::PinionTipDiameter, |data, value| data.pinion.tip_diameter_mm = value, 1e-6, 160.0),
            (
                PairSize::PinionToothThicknessDeviation,
                |data, value| data.pinion.tooth_thickness_deviation_mm = value,
                -20.0,
                20.0,
            ),
            (PairSize::PinionRootFormDiameter, |data, value| data.pinion.root_form_diameter_mm = Some(value), 0.0, 1e9),
        ];
        let error = |set: Set, value| {
            let mut data = example(20, 0.0, 0.0);
            set(&mut data, value);
            Pair::new(&data).err()
        };
        for (quantity, set, min, max) in cases {
            for value in [min.next_down(), max.next_up()] {
                let expected = GeometryError::OutOfDomain { quantity, value, min, max };
                assert_eq!(error(set, value), Some(expected), "{quantity}");
            }
            assert!(matches!(error(set, f64::NAN), Some(GeometryError::OutOfDomain { .. })), "{quantity}");
            for value in [min, max] {
                let found = error(set, value);
                let refused = matches!(found, Some(GeometryError::OutOfDomain { quantity: of, .. }) if of == quantity);
                assert!(!refused, "{found:?}");
            }
        }
        for teeth in [0, 10_001] {
            let expected = GeometryError::OutOfDomain {
                quantity: PairSize::PinionTeeth,
                value: f64::from(teeth),
                min: 1.0,
                max: 10_000.0,
            };
            assert_eq!(Pair::new(&example(teeth, 0.0, 0.0)).err(), Some(expected));
        }
    }

    /// The sides of the helix angle's triangle are 3, 4 and 5, tan α_n = 1/2.
    #[test]
    fn what_follows_from_a_drawing() {
        let helix = trig::atan(0.75);
        let mut data = example(20, -helix, helix);
        data.pinion.tooth_thickness_deviation_mm = 0.1;
        data.pinion.root_form_diameter_mm = Some(48.0);
        let pair = Pair::new(&data).unwrap();
        let (rack, p) = (pair.rack(), pair.pinion());
        near(rack.pitch_mm, 2.5 * PI);
        near(rack.tan_pressure_angle_x, 0.625);
        near(rack.tooth_thickness_mm, PI);
        near(p.reference_radius_mm, 25.0);
        near(p.transverse_pitch_mm, 2.5 * PI);
        near(trig::tan(p.transverse_pressure_angle_rad), 0.625);
        let r_b = 25.0 / f64::sqrt(1.0 + 0.625 * 0.625);
        near(p.base_radius_mm, r_b);
        near(trig::sin(p.base_helix_angle_rad), 0.6 / f64::sqrt(1.25));
        let thickness = (FRAC_PI_2 + 0.2) * 2.5 + 0.1;
        near(p.tooth_thickness_mm, thickness);
        near(p.base_half_angle_rad, thickness / 50.0 + 0.625 - trig::atan(0.625));
        let roll = |radius: f64| f64::sqrt((radius / r_b) * (radius / r_b) - 1.0);
        near(p.tip_roll_rad, roll(27.3));
        near(p.start_roll_rad, roll(24.0));
        near(p.root_form_radius_mm, 24.0);
        let at_tip = p.base_half_angle_rad - (roll(27.3) - trig::atan(roll(27.3)));
        near(p.tip_thickness_mm(), 54.6 * at_tip);
        near(pair.nominal_center_distance_mm(), 25.4);
        near(pair.rotation_per_stroke_rad(), 1.0 / 25.0);
        assert_eq!(pair.shaft_angle_rad(), 0.0);
        // an involute starts at the base circle at the earliest
        for root_form_diameter_mm in [None, Some(0.0), Some(42.3)] {
            data.pinion.root_form_diameter_mm = root_form_diameter_mm;
            let p = *Pair::new(&data).unwrap().pinion();
            assert_eq!((p.root_form_radius_mm, p.start_roll_rad), (p.base_radius_mm, 0.0));
        }
    }

    #[test]
    fn teeth_that_cannot_be() {
        let data = example(20, 0.0, 0.0);
        let rack = |tooth_thickness_mm: f64| {
            let mut data = data;
            data.rack.tooth_thickness_mm = Some(tooth_thickness_mm);
            Pair::new(&data)
        };
        // as thick as the pitch
        let full = 2.0 * PI;
        assert_eq!(rack(full), Err(GeometryError::NoRackSpace { tooth_thickness_mm: full, pitch_mm: full }));
        assert!(rack(full.next_down()).is_ok());
        // flanks that meet in the tip plane
        let pointed = 2.0 * 1.9 * trig::tan(data.normal_pressure_angle_rad);
        near(pointed, 1.9);
        assert_eq!(rack(pointed), Err(GeometryError::PointedRack { tip_thickness_mm: 0.0, addendum_mm: 1.9 }));
        assert!(rack(pointed.next_up()).is_ok());
        let Err(GeometryError::PointedRack { tip_thickness_mm, .. }) = rack(1.7) else { panic!("pointed") };
        near(tip_thickness_mm, -0.2);

        // no involute is left between its start and the tip
        let mut ends = data;
        ends.pinion.root_form_diameter_mm = Some(44.6);
        let none = GeometryError::NoInvolute { start_diameter_mm: 44.6, tip_diameter_mm: 44.6 };
        assert_eq!(Pair::new(&ends), Err(none));
        // a tip far beyond where the flanks meet
        let mut high = data;
        high.pinion.tip_diameter_mm = 60.0;
        let Err(GeometryError::PointedPinion { tip_thickness_mm, tip_diameter_mm }) = Pair::new(&high) else {
            panic!("pointed")
        };
        let r_b = 20.0 / f64::sqrt(1.25);
        let roll = f64::sqrt(900.0 / (r_b * r_b) - 1.0);
        let half = (FRAC_PI_2 + 0.2) * 2.0 / 40.0 + 0.5 - trig::atan(0.5);
        near(tip_thickness_mm, 60.0 * (half - roll + trig::atan(roll)));
        assert_eq!(tip_diameter_mm, 60.0);
    }
}
