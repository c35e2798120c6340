//! How a valid geometry meshes: contact ratio, and warnings of undercut, tip interference, thin tips and steep flanks. Called
//! by whoever builds a [`Pair`]; forbids nothing.

use super::Pair;
use crate::quantity::Rounded;
use crate::trig;

/// The stroke over which a flank pair of the nominal pair keeps contact, in pitches p_x: the right flank of rack tooth i
/// carries at strokes i + c ± ε/2, the left flank at i − c ± ε/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactRatio {
    /// Transverse contact ratio: path of contact in a transverse section of the pinion over the transverse base pitch.
    pub transverse: f64,
    /// Overlap ratio: total − transverse; 0 for a pinion without helix.
    pub overlap: f64,
    /// Total contact ratio ε: stroke over which one flank pair keeps contact, over the pitch.
    pub total: f64,
    /// Offset c: middle of that stroke for the right flank of rack tooth 0, over the pitch.
    pub offset: f64,
}

impl ContactRatio {
    /// The contact ratio of flanks that do not reach each other.
    const NONE: Self = Self { transverse: 0.0, overlap: 0.0, total: 0.0, offset: 0.0 };
}

/// A property of a valid geometry that a designer should know.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryWarning {
    /// A rack cutter as high as this rack would undercut the pinion.
    #[error("undercut: profile shift {} is below the limit {limit:.4} for this addendum", Rounded(*.profile_shift))]
    Undercut {
        /// The pinion's profile shift coefficient.
        profile_shift: f64,
        /// The smallest profile shift coefficient without undercut, (h_a − r sin² α_t)/m_n.
        limit: f64,
    },
    /// The rack's tip reaches deeper than the start of the involute.
    #[error(
        "tip interference: the rack's tip reaches {depth_mm:.4} mm deeper than the involute, which starts at diameter {root_form_diameter_mm:.3} mm"
    )]
    TipInterference {
        /// Depth of the rack's tip below the lowest point of contact of the involute, mm.
        depth_mm: f64,
        /// Diameter at which the involute starts, mm.
        root_form_diameter_mm: f64,
    },
    /// The pinion's tooth is thinner than 0.2 m_n at its tip.
    #[error(
        "pinion tooth is nearly pointed: normal thickness {tip_thickness_mm:.4} mm at the tip, less than {} mm", Rounded(*.limit_mm)
    )]
    NearlyPointed {
        /// Normal tooth thickness at the tip, mm.
        tip_thickness_mm: f64,
        /// 0.2 m_n, mm.
        limit_mm: f64,
    },
    /// The flanks are so steep that the centre distance amplifies each of their displacements.
    #[error(
        "sensitive: at a normal pressure angle of {}° the centre distance moves {gain:.3} times as far as a flank does \
         (1 / (2 tan α_n))",
        Rounded(*.normal_pressure_angle_deg)
    )]
    Sensitive {
        /// Normal pressure angle α_n, degrees.
        normal_pressure_angle_deg: f64,
        /// 1 / (2 tan α_n).
        gain: f64,
    },
    /// A flank pair leaves contact before the next one enters it.
    #[error("contact ratio {total:.4} is below 1 (transverse {transverse:.4}, overlap {overlap:.4})")]
    LowContactRatio {
        /// Transverse contact ratio.
        transverse: f64,
        /// Overlap ratio.
        overlap: f64,
        /// Their sum.
        total: f64,
    },
}

/// Smallest normal thickness of a tip as a share of m_n: the case of a thinner one is hardened through (workshop rule).
const THIN_TIP: f64 = 0.2;

/// Largest gain without a warning: 1.4 is usual, and 2.8 is that of the steepest flanks in use (10°).
const SENSITIVE: f64 = 3.0;

/// ΔCD = t / (2 tan α_n) of a tooth that is thicker by t, mm.
///
/// `thicker_mm` is t in the rack's normal section; for a pinion tooth it is cos β_p times the arc at the reference circle.
/// `tan_alpha` is tan α_n, above 0.
#[must_use]
pub fn thickness_offset_mm(thicker_mm: f64, tan_alpha: f64) -> f64 {
    0.5 * thicker_mm / tan_alpha
}

/// Smallest profile shift coefficient without undercut, x = (h_a − r sin² α_t) / m_n, for a rack cutter of addendum h_a and a
/// pinion of reference radius r. Lengths are in mm; the module m_n is above 0.
#[must_use]
pub fn undercut_limit(addendum: f64, reference_radius: f64, transverse_pressure_angle_rad: f64, module: f64) -> f64 {
    let sin_t = trig::sin(transverse_pressure_angle_rad);
    (addendum - reference_radius * sin_t * sin_t) / module
}

impl Pair {
    /// ΔCD per displacement of one flank of every tooth, normal to the tooth line in the reference plane: 1 / (2 tan α_n), mm
    /// per mm.
    #[must_use]
    pub fn gain(&self) -> f64 {
        0.5 / trig::tan(self.normal_pressure_angle_rad())
    }

    /// [`undercut_limit`] for this rack's addendum.
    #[must_use]
    pub fn undercut_limit(&self) -> f64 {
        let p = self.pinion();
        let (addendum, module) = (self.rack().addendum_mm, self.normal_module_mm());
        undercut_limit(addendum, p.reference_radius_mm, p.transverse_pressure_angle_rad, module)
    }

    /// Roll angle τ at which the rack's tip plane meets the line of action at a = a_0. The point of contact has the height
    /// Z = x m_n + r sin² α_t − r_b τ sin α_t. The angle is negative with undercut.
    fn rack_tip_roll_rad(&self) -> f64 {
        let p = self.pinion();
        let sin_t = trig::sin(p.transverse_pressure_angle_rad);
        let height = p.profile_shift * self.normal_module_mm() + p.reference_radius_mm * sin_t * sin_t;
        (height - self.rack().addendum_mm) / (p.base_radius_mm * sin_t)
    }

    /// Contact ratio of the nominal pair at a_0.
    ///
    /// A point of contact has a roll angle τ and a place w along the pinion's axis. The flanks bound both: τ lies between the
    /// involute's start (or the rack's tip) and the pinion's tip, |w| ≤ b/2, and |y| ≤ k/2 with
    /// y = r_b (τ cos α_t − sin α_t) sin Σ + w cos Σ. The phase of the mesh is φ = τ − w tan β_b / r_b. Its extent over that
    /// polygon, over the angular pitch 2π/z, is the total contact ratio. The right flank of rack tooth 0 touches at the stroke
    /// ½ + (φ − ψ_b − α_t) / (2π/z), in pitches.
    #[must_use]
    pub fn contact_ratio(&self) -> ContactRatio {
        let p = self.pinion();
        let low = self.rack_tip_roll_rad().max(p.start_roll_rad);
        let high = p.tip_roll_rad;
        let pitch = p.angular_pitch_rad();
        if low >= high {
            return ContactRatio::NONE;
        }
        let (sin_t, cos_t) = trig::sin_cos(p.transverse_pressure_angle_rad);
        let (sin_s, cos_s) = trig::sin_cos(self.shaft_angle_rad());
        let (half_b, half_k) = (p.face_width_mm / 2.0, self.rack().face_width_mm / 2.0);
        let y = |&(tau, w): &(f64, f64)| p.base_radius_mm * (tau * cos_t - sin_t) * sin_s + w * cos_s;
        let corners = [(low, -half_b), (high, -half_b), (high, half_b), (low, half_b)];
        let below = clip(&corners, |q| half_k - y(q), between);
        let polygon = clip(&below, |q| half_k + y(q), between);
        if polygon.is_empty() {
            return ContactRatio::NONE;
        }
        let kappa = trig::tan(p.helix_angle_rad) / p.reference_radius_mm;
        let phases = polygon.iter().map(|&(tau, w)| tau - kappa * w);
        let (min, max) = phases.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        let total = (max - min) / pitch;
        let transverse = ((high - low) / pitch).min(total);
        let offset = 0.5 + (0.5 * (min + max) - p.base_half_angle_rad - p.transverse_pressure_angle_rad) / pitch;
        ContactRatio { transverse, overlap: total - transverse, total, offset }
    }

    /// The properties of this geometry that a designer should know, the worst first.
    #[must_use]
    pub fn warnings(&self) -> Vec<GeometryWarning> {
        let p = self.pinion();
        let mut found = Vec::new();
        let ratio = self.contact_ratio();
        if ratio.total < 1.0 {
            let ContactRatio { transverse, overlap, total, .. } = ratio;
            found.push(GeometryWarning::LowContactRatio { transverse, overlap, total });
        }
        let limit = self.undercut_limit();
        if p.profile_shift < limit {
            found.push(GeometryWarning::Undercut { profile_shift: p.profile_shift, limit });
        }
        let roll = self.rack_tip_roll_rad();
        if roll < p.start_roll_rad {
            // a roll angle τ is r_b τ along the line of action, and r_b τ sin α_t in height
            let sin_t = trig::sin(p.transverse_pressure_angle_rad);
            found.push(GeometryWarning::TipInterference {
                depth_mm: p.base_radius_mm * (p.start_roll_rad - roll) * sin_t,
                root_form_diameter_mm: 2.0 * p.root_form_radius_mm,
            });
        }
        let gain = self.gain();
        if gain > SENSITIVE {
            let normal_pressure_angle_deg = self.normal_pressure_angle_rad().to_degrees();
            found.push(GeometryWarning::Sensitive { normal_pressure_angle_deg, gain });
        }
        // the helix angle at the tip circle: tan β_a = (r_a / r) tan β_p
        let tan_tip = p.tip_radius_mm / p.reference_radius_mm * trig::tan(p.helix_angle_rad);
        let normal = p.tip_thickness_mm() / (1.0 + tan_tip * tan_tip).sqrt();
        let limit_mm = THIN_TIP * self.normal_module_mm();
        if normal < limit_mm {
            found.push(GeometryWarning::NearlyPointed { tip_thickness_mm: normal, limit_mm });
        }
        found
    }
}

/// The part of a convex polygon on which the linear function `inside` is not negative; `towards` is the point at a share of
/// the way from one corner to another.
pub(crate) fn clip<P: Copy>(polygon: &[P], inside: impl Fn(&P) -> f64, towards: impl Fn(&P, &P, f64) -> P) -> Vec<P> {
    let mut kept = Vec::with_capacity(polygon.len() + 2);
    for (index, here) in polygon.iter().enumerate() {
        let next = &polygon[(index + 1) % polygon.len()];
        let (f, g) = (inside(here), inside(next));
        if f >= 0.0 {
            kept.push(*here);
        }
        if (f > 0.0 && g < 0.0) || (f < 0.0 && g > 0.0) {
            kept.push(towards(here, next, f / (f - g)));
        }
    }
    kept
}

/// The point at a share of the way from `a` to `b`.
fn between(a: &(f64, f64), b: &(f64, f64), share: f64) -> (f64, f64) {
    (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1))
}

#[cfg(test)]
pub(crate) mod tests;
