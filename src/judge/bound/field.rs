//! The field of contact: which points of a pinion flank can touch a rack flank, by roll angle τ and place w along the
//! pinion's axis, and when. Knows no errors.
//!
//! A point of contact passes at the stroke, in pitches from the stroke of its rack tooth,
//!
//! ```text
//! p = s_n/(2 π m_n) + (−a sin α_n + r_b τ cos β_b − w sin β_b) / (π m_n cos α_n)
//! y = r_b (τ cos α_t − sin α_t) sin Σ + w cos Σ,    Z = a − r_b (cos α_t + τ sin α_t)
//! ```
//!
//! for a right flank. A left flank is a right one turned by half a turn about Z: p and y change sign.

use std::f64::consts::PI;

use super::Range;
use super::profile::{Profile, Rolls};
use crate::gear::{Pair, clip, thickness_offset_mm};
use crate::trig;

/// Where flank pairs carry, in pitches of stroke: the right flank of tooth i at strokes i + c ± ε/2, the left one at
/// i − c ± ε/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPath {
    /// Length ε.
    pub ratio: f64,
    /// Offset c.
    pub offset: f64,
}

impl ContactPath {
    /// The path of contact of a pair without errors.
    #[must_use]
    pub fn nominal(pair: &Pair) -> Self {
        Field::nominal(pair).path()
    }

    /// Whether a tooth of the rack always carries on both flanks: then shifts of whole teeth cannot sink the pinion.
    #[must_use]
    pub fn has_both_flanks_of_a_rack_tooth(&self) -> bool {
        self.ratio >= 1.0 + 2.0 * self.offset.abs()
    }

    /// Whether a tooth of the pinion always carries on both flanks.
    #[must_use]
    pub fn has_both_flanks_of_a_pinion_tooth(&self) -> bool {
        self.ratio >= 1.0 + (1.0 - 2.0 * self.offset).abs()
    }
}

/// A point of contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::judge) struct Spot {
    pub(in crate::judge) roll: f64,
    pub(in crate::judge) w: f64,
    /// Stroke, pitches from that of the rack tooth.
    pub(in crate::judge) stroke: f64,
    /// Place across the rack and height over the reference plane, mm.
    pub(in crate::judge) y: f64,
    pub(in crate::judge) z: f64,
}

/// The corners of a convex field of contact.
#[derive(Debug)]
pub(in crate::judge) struct Field {
    corners: Vec<Spot>,
}

impl Spot {
    fn new(pair: &Pair, roll: f64, w: f64) -> Self {
        let (rack, pinion) = (pair.rack(), pair.pinion());
        let (sin_t, cos_t) = trig::sin_cos(pinion.transverse_pressure_angle_rad);
        let (sin_s, cos_s) = trig::sin_cos(pair.shaft_angle_rad());
        let (sin_b, cos_b) = trig::sin_cos(pinion.base_helix_angle_rad);
        let (sin_n, cos_n) = trig::sin_cos(pair.normal_pressure_angle_rad());
        let (r_b, line_distance) = (pinion.base_radius_mm, line_distance(pair));
        let place = (r_b * roll * cos_b - w * sin_b - line_distance * sin_n) / cos_n;
        Self {
            roll,
            w,
            stroke: (0.5 * rack.tooth_thickness_mm + place) / (PI * pair.normal_module_mm()),
            y: r_b * (roll * cos_t - sin_t) * sin_s + w * cos_s,
            z: line_distance - r_b * (cos_t + roll * sin_t),
        }
    }

    /// The point at this share of the way to another point; everything is linear in roll angle and place.
    fn towards(&self, other: &Self, share: f64) -> Self {
        let between = |a: f64, b: f64| a + share * (b - a);
        Self {
            roll: between(self.roll, other.roll),
            w: between(self.w, other.w),
            stroke: between(self.stroke, other.stroke),
            y: between(self.y, other.y),
            z: between(self.z, other.z),
        }
    }
}

impl Field {
    /// The field of a pair without errors.
    pub(in crate::judge) fn nominal(pair: &Pair) -> Self {
        let low = Profile::new(pair, line_distance(pair), 0.0).lowest_line();
        Self::new(pair, Rolls { low, high: pair.pinion().tip_roll_rad }, 0.0)
    }

    /// The field of points with roll angles within `rolls`, between the pinion's end faces, and between the rack's end faces
    /// moved out by `wider` mm.
    pub(in crate::judge) fn new(pair: &Pair, rolls: Rolls, wider: f64) -> Self {
        if rolls.low > rolls.high {
            return Self { corners: Vec::new() };
        }
        let half_face = 0.5 * pair.pinion().face_width_mm;
        let half_width = 0.5 * pair.rack().face_width_mm + wider;
        let corners =
            [(rolls.low, -half_face), (rolls.high, -half_face), (rolls.high, half_face), (rolls.low, half_face)];
        let all = Self { corners: corners.map(|(roll, w)| Spot::new(pair, roll, w)).to_vec() };
        all.clipped(|spot| half_width - spot.y).clipped(|spot| half_width + spot.y)
    }

    /// The part on which a linear function is not negative.
    fn clipped(&self, inside: impl Fn(&Spot) -> f64) -> Self {
        Self { corners: clip(&self.corners, inside, Spot::towards) }
    }

    /// The points that pass between two strokes, in pitches.
    pub(in crate::judge) fn between(&self, strokes: Range) -> Self {
        self.clipped(|spot| spot.stroke - strokes.lower).clipped(|spot| strokes.upper - spot.stroke)
    }

    /// The points of contact lines between two roll angles.
    pub(in crate::judge) fn within(&self, rolls: Rolls) -> Self {
        self.clipped(|spot| spot.roll - rolls.low).clipped(|spot| rolls.high - spot.roll)
    }

    /// The least and the greatest value of a linear function; `None` for an empty field.
    pub(in crate::judge) fn extremes(&self, function: impl Fn(&Spot) -> f64) -> Option<Range> {
        let ranges = self.corners.iter().map(function).map(|value| Range { lower: value, upper: value });
        ranges.reduce(|a, b| Range { lower: a.lower.min(b.lower), upper: a.upper.max(b.upper) })
    }

    pub(in crate::judge) fn path(&self) -> ContactPath {
        let none = Range { lower: 0.0, upper: 0.0 };
        let strokes = self.extremes(|spot| spot.stroke).unwrap_or(none);
        ContactPath { ratio: strokes.upper - strokes.lower, offset: 0.5 * (strokes.lower + strokes.upper) }
    }
}

/// The centre distance at which lines of contact fit, mm: teeth thicker than standard ones move it.
pub(in crate::judge) fn line_distance(pair: &Pair) -> f64 {
    pair.nominal_center_distance_mm() + thickness_offset(pair)
}

/// ΔCD of nominal teeth that are thicker than standard ones, mm.
pub(in crate::judge) fn thickness_offset(pair: &Pair) -> f64 {
    let thicker = pair.rack().tooth_thickness_mm - 0.5 * PI * pair.normal_module_mm();
    let cos_p = trig::cos(pair.pinion().helix_angle_rad);
    thickness_offset_mm(thicker + thickness_deviation(pair) * cos_p, trig::tan(pair.normal_pressure_angle_rad()))
}

/// How much thicker than standard the pinion's teeth are, as an arc at the reference circle, mm.
pub(in crate::judge) fn thickness_deviation(pair: &Pair) -> f64 {
    let pinion = pair.pinion();
    let tan_n = trig::tan(pair.normal_pressure_angle_rad());
    let standard = (0.5 * PI + 2.0 * pinion.profile_shift * tan_n) * pair.normal_module_mm();
    pinion.tooth_thickness_mm - standard / trig::cos(pinion.helix_angle_rad)
}

/// What one side asks for when the pinion turns away from it, mm of centre distance per rad: m_n z / (2 tan α_n).
pub(in crate::judge) fn mm_per_rad(pair: &Pair) -> f64 {
    0.5 * pair.normal_module_mm() * f64::from(pair.pinion().teeth) / trig::tan(pair.normal_pressure_angle_rad())
}

/// How far errors move a contact line on a flank, rad of roll angle: e / (m_n z / 2) by the flank, and as much by the
/// rotation.
pub(super) fn shift_rad(pair: &Pair, delta_cd_mm: f64) -> f64 {
    2.0 * delta_cd_mm / mm_per_rad(pair)
}

/// How far such a shift moves a contact line across the rack, mm.
pub(super) fn skew(pair: &Pair, shift: f64) -> f64 {
    pair.pinion().base_radius_mm * shift * trig::sin(pair.shaft_angle_rad()).abs()
}
