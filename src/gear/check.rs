//! How a valid geometry meshes, and what it does badly: contact ratio, undercut, interference, thin tips. Called by whoever
//! builds a [`Pair`] and wants to warn; forbids nothing.

use super::Pair;
use crate::quantity::Rounded;
use crate::trig;

/// How long flank pairs of the nominal pair keep contact, and when, in teeth or, which is the same, pitches of stroke: the
/// right flank of rack tooth i carries at strokes i + c ± ε/2, the left one at i − c ± ε/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactRatio {
    /// Length of the path of contact in a transverse section of the pinion over the base pitch.
    pub transverse: f64,
    /// What the helix adds: total − transverse; 0 for a pinion without helix.
    pub overlap: f64,
    /// The stroke during which one flank pair keeps contact anywhere, over the pitch: ε.
    pub total: f64,
    /// The middle of that stroke for the right flank of rack tooth 0, over the pitch: c.
    pub offset: f64,
}

impl ContactRatio {
    /// Of flanks that do not reach each other.
    const NONE: Self = Self { transverse: 0.0, overlap: 0.0, total: 0.0, offset: 0.0 };
}

/// Something about a valid geometry that a designer would want to know.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryWarning {
    /// A rack cutter as high as this rack would undercut the pinion.
    #[error("undercut: profile shift {} is below the limit {limit:.4} for this addendum", Rounded(*.profile_shift))]
    Undercut {
        /// The pinion's profile shift coefficient.
        profile_shift: f64,
        /// The smallest one without undercut, (h_a − r sin² α_t)/m_n.
        limit: f64,
    },
    /// The rack's tip reaches further down than the involute.
    #[error(
        "tip interference: the rack's tip reaches {depth_mm:.4} mm deeper than the involute, which starts at diameter {root_form_diameter_mm:.3} mm"
    )]
    TipInterference {
        /// How much lower than the lowest point of contact of the involute the rack's tip is, mm.
        depth_mm: f64,
        /// Diameter at which the involute starts, mm.
        root_form_diameter_mm: f64,
    },
    /// Less than 0.2 m_n of the pinion's tooth is left at its tip.
    #[error(
        "pinion tooth is nearly pointed: normal thickness {tip_thickness_mm:.4} mm at the tip, less than {} mm", Rounded(*.limit_mm)
    )]
    NearlyPointed {
        /// Normal tooth thickness at the tip, mm.
        tip_thickness_mm: f64,
        /// 0.2 m_n, mm.
        limit_mm: f64,
    },
    /// Flanks so steep that the centre distance amplifies every displacement of theirs.
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

/// Below this share of m_n the tip's case would be hardened through (usual workshop rule).
const THIN_TIP: f64 = 0.2;

/// Gains above this deserve a warning: 1.4 is usual, 2.9 that of the steepest flanks in use (10°).
const SENSITIVE: f64 = 3.0;

/// ΔCD, mm, of a tooth that is thicker by so much in the normal section of the rack, t / (2 tan α_n); of a pinion tooth, cos β_p
/// times its arc at the reference circle counts.
#[must_use]
pub fn thickness_offset_mm(thicker_mm: f64, tan_alpha: f64) -> f64 {
    0.5 * thicker_mm / tan_alpha
}

/// Smallest profile shift at which a rack cutter with this addendum leaves no undercut on a pinion with this reference
/// radius: x = (h_a − r sin² α_t) / m_n. Lengths in mm.
#[must_use]
pub fn undercut_limit(addendum: f64, reference_radius: f64, transverse_pressure_angle_rad: f64, module: f64) -> f64 {
    let sin_t = trig::sin(transverse_pressure_angle_rad);
    (addendum - reference_radius * sin_t * sin_t) / module
}

impl Pair {
    /// How far the centre distance moves when one flank of every tooth moves along the reference plane by 1: the
    /// condition number of the exact mesh by its flanks, 1 / (2 tan α_n).
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

    /// Roll angle τ at which the rack's tip plane meets the line of action at a = a_0:
    /// the contact point's height is Z = x m_n + r sin² α_t − r_b τ sin α_t. Negative with undercut.
    fn rack_tip_roll_rad(&self) -> f64 {
        let p = self.pinion();
        let sin_t = trig::sin(p.transverse_pressure_angle_rad);
        let height = p.profile_shift * self.normal_module_mm() + p.reference_radius_mm * sin_t * sin_t;
        (height - self.rack().addendum_mm) / (p.base_radius_mm * sin_t)
    }

    /// Contact ratio of the nominal pair at a_0.
    ///
    /// A point of contact is known by its roll angle τ and its place w along the pinion's axis. The pair's flanks
    /// bound both: τ between the involute's start (or the rack's tip) and its tip, |w| ≤ b/2, and |y| ≤ k/2
    /// with y = r_b (τ cos α_t − sin α_t) sin Σ + w cos Σ. On that polygon the phase of the mesh is
    /// τ − w tan β_b / r_b; its extent over the angular pitch is the total contact ratio. A right flank touches at the
    /// stroke at which the pinion has turned by that phase less ψ_b + α_t, from half a pitch on.
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

    /// Everything about this geometry that a designer would want to know, worst first.
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
            // along the line of action a roll angle τ is r_b τ, of which sin α_t is height
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

/// The part of a convex polygon on which a linear function is not negative; `towards` is the point at a share of the way from
/// one corner to another.
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

/// The point at a share of the way.
fn between(a: &(f64, f64), b: &(f64, f64), share: f64) -> (f64, f64) {
    (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1))
}

#[cfg(test)]
pub(crate) mod tests;
