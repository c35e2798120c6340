//! The pair with every derived value. Built by the spec layer and by tests, read by everything below;
//! holds no deviation and computes no contact.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::{GeometryError, PairData, Quantity};
use crate::trig;

/// The rack of a [`Pair`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rack {
    /// Helix angle β_r, right hand positive, rad.
    pub helix_angle_rad: f64,
    /// Face width k along Y, mm.
    pub face_width_mm: f64,
    /// Height of the tip plane above the reference plane, mm.
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
    /// Radius at which the involute starts, at least r_b, mm.
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
    /// Half the angle between a tooth's flanks at the base circle, s_t/(2r) + inv α_t, rad.
    pub base_half_angle_rad: f64,
}

/// A crossed helical rack and pinion whose numbers have been checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    normal_module_mm: f64,
    normal_pressure_angle_rad: f64,
    rack: Rack,
    pinion: Pinion,
}

/// The bounds are wider than any gear made and narrow enough that nothing derived overflows.
const LENGTH_MM: (f64, f64) = (1e-6, 1e9);
/// Smaller modules and larger ones would only be mistakes in units.
const MODULE_MM: (f64, f64) = (1e-3, 1e3);
/// 1° to 60°: below, tan α in denominators amplifies every error; above, no tooth is left.
const PRESSURE_ANGLE_RAD: (f64, f64) = (PI / 180.0, PI / 3.0);
/// ±80°: single-start worms end here.
const HELIX_RAD: (f64, f64) = (-80.0 * PI / 180.0, 80.0 * PI / 180.0);
/// Numbers of teeth.
const TEETH: (f64, f64) = (1.0, 10_000.0);
/// Profile shift coefficients.
const SHIFT: (f64, f64) = (-10.0, 10.0);

fn within(quantity: Quantity, value: f64, (min, max): (f64, f64)) -> Result<f64, GeometryError> {
    if value >= min && value <= max { Ok(value) } else { Err(GeometryError::OutOfDomain { quantity, value, min, max }) }
}

impl Pair {
    /// Checks the numbers of a drawing and derives everything that follows from them.
    ///
    /// # Errors
    /// [`GeometryError::OutOfDomain`] names the first number outside its domain; the other variants say
    /// that a tooth has no tip, no space or no involute. Geometry that meshes badly but does mesh passes; see
    /// [`Pair::warnings`].
    pub fn new(data: &PairData) -> Result<Self, GeometryError> {
        let m_n = within(Quantity::NormalModule, data.normal_module_mm, MODULE_MM)?;
        let alpha_n = within(Quantity::NormalPressureAngle, data.normal_pressure_angle_rad, PRESSURE_ANGLE_RAD)?;
        let tan_n = trig::tan(alpha_n);
        let rack = Self::rack_of(data, m_n, tan_n)?;
        let pinion = Self::pinion_of(data, m_n, alpha_n)?;
        Ok(Self { normal_module_mm: m_n, normal_pressure_angle_rad: alpha_n, rack, pinion })
    }

    fn rack_of(data: &PairData, m_n: f64, tan_n: f64) -> Result<Rack, GeometryError> {
        let raw = &data.rack;
        let beta = within(Quantity::RackHelixAngle, raw.helix_angle_rad, HELIX_RAD)?;
        let face = within(Quantity::RackFaceWidth, raw.face_width_mm, LENGTH_MM)?;
        let addendum = within(Quantity::RackAddendum, raw.addendum_mm, (-10.0 * m_n, 10.0 * m_n))?;
        let thickness = match raw.tooth_thickness_mm {
            None => FRAC_PI_2 * m_n,
            Some(value) => within(Quantity::RackToothThickness, value, (1e-6 * m_n, 10.0 * m_n))?,
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
        let z = within(Quantity::PinionTeeth, f64::from(raw.teeth), TEETH)?;
        let beta = within(Quantity::PinionHelixAngle, raw.helix_angle_rad, HELIX_RAD)?;
        let x = within(Quantity::PinionProfileShift, raw.profile_shift, SHIFT)?;
        let face = within(Quantity::PinionFaceWidth, raw.face_width_mm, LENGTH_MM)?;
        let (sin_beta, cos_beta) = trig::sin_cos(beta);
        let r = m_n * z / (2.0 * cos_beta);
        let tip = within(Quantity::PinionTipDiameter, raw.tip_diameter_mm, (1e-6, 4.0 * r + 40.0 * m_n))?;
        let deviation = within(
            Quantity::PinionToothThicknessDeviation,
            raw.tooth_thickness_deviation_mm,
            (-10.0 * m_n, 10.0 * m_n),
        )?;
        let alpha_t = trig::atan(tan_n / cos_beta);
        let r_b = r * trig::cos(alpha_t);
        let start = match raw.root_form_diameter_mm {
            None => r_b,
            Some(value) => (within(Quantity::PinionRootFormDiameter, value, (0.0, 1e9))? / 2.0).max(r_b),
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
    /// It stays the same if either part's nominal tooth thickness differs from the standard one; such a
    /// difference is part of ΔCD = a − a_0.
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
    /// Transverse tooth thickness at the tip circle, 2 r_a (ψ_b − inv α_a), mm.
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
