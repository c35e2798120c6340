//! What is known about a pair: its path of contact, its own error-free curve, how much of the faces carries. Made once
//! for a pair and as much error as it is asked about; knows no single error.

use std::f64::consts::PI;

use super::Range;
use super::profile::{Profile, Rolls};
use crate::deviation::{DeviationError, PinionFlanks, PinionForm, RackFlanks, RackForm};
use crate::gear::{GeometryError, Pair, PairData, PinionData, RackData};
use crate::mesh::{Mesh, MeshError, Support};
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

/// Everything that is given of a pair but its errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenPair {
    /// Its nominal geometry.
    pub pair: Pair,
    /// Form of the rack's flanks.
    pub rack_form: RackForm,
    /// Form of the pinion's flanks.
    pub pinion_form: PinionForm,
    /// How the rack is held.
    pub support: Support,
}

/// A pair whose geometry is known, and what follows from it for errors up to a reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownPair {
    pub(super) given: GivenPair,
    /// The largest ΔCD of errors, all together, that this holds for, mm.
    pub(super) reach: f64,
    /// Centre distance at which lines of contact fit, mm.
    pub(super) line_distance: f64,
    /// Where lines of contact carry whatever the errors.
    pub(super) line: ContactPath,
    /// What error-free parts do.
    pub(super) own: Range,
    /// Half the rack's width, and half the pinion's, over which profiles alone always carry; `None` if they do not.
    pub(super) rack_sections: Option<f64>,
    pub(super) pinion_sections: Option<f64>,
}

/// Why nothing is known about a pair.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KnownPairError {
    /// Errors leave nothing of the flanks.
    #[error("errors of {reach_mm} mm leave no pair: {source}")]
    Geometry {
        /// How large the errors are, mm.
        reach_mm: f64,
        /// What is wrong with it.
        source: GeometryError,
    },
    /// A form that does not fit.
    #[error(transparent)]
    Form(#[from] DeviationError),
    /// The pair has no curve.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Tolerance of an own curve, mm: of a fixed rack, and of one that may roll, which is slow.
const CURVE_MM: f64 = 1e-7;
const ROLLING_CURVE_MM: f64 = 1e-5;
/// Flanks are shortened this many times as far as they shift, which also covers that a shorter tip falls off less steeply.
const SHORTENING: f64 = 2.0;

impl GivenPair {
    /// A pair with plain flanks and a rack that does not roll.
    #[must_use]
    pub fn plain(pair: Pair) -> Self {
        let (rack_form, pinion_form) = (RackForm::default(), PinionForm::default());
        Self { pair, rack_form, pinion_form, support: Support::Fixed }
    }

    fn has_form(&self) -> bool {
        !(self.rack_form.is_plain() && self.pinion_form.is_plain())
    }

    pub(super) fn rolls(&self) -> bool {
        self.support != Support::Fixed
    }
}

impl ContactPath {
    /// Of a pair without errors.
    #[must_use]
    pub fn nominal(pair: &Pair) -> Self {
        let line_distance = pair.nominal_center_distance_mm() + thickness_offset(pair);
        let rolls = Rolls {
            low: Profile::new(pair, line_distance, 0.0).lowest_line(),
            high: pair.pinion().tip_roll_rad,
        };
        Self::of(pair, line_distance, rolls, 0.0)
    }

    /// Of points of contact with roll angles within `rolls`, between the pinion's end faces, and between the rack's if
    /// those are `wider` mm farther out on either side.
    fn of(pair: &Pair, line_distance: f64, rolls: Rolls, wider: f64) -> Self {
        let (rack, pinion) = (pair.rack(), pair.pinion());
        let (half_b, half_k) = (0.5 * pinion.face_width_mm, 0.5 * rack.face_width_mm + wider);
        let (sin_t, cos_t) = trig::sin_cos(pinion.transverse_pressure_angle_rad);
        let (sin_s, cos_s) = trig::sin_cos(pair.shaft_angle_rad());
        let (sin_b, cos_b) = trig::sin_cos(pinion.base_helix_angle_rad);
        let (sin_n, cos_n) = trig::sin_cos(pair.normal_pressure_angle_rad());
        let pitch = PI * pair.normal_module_mm();
        // where the rack's end faces cut a line of contact
        let cut = |roll: f64, y: f64| (y - pinion.base_radius_mm * (roll * cos_t - sin_t) * sin_s) / cos_s;
        let roll_at = |w: f64, y: f64| ((y - w * cos_s) / (pinion.base_radius_mm * sin_s) + sin_t) / cos_t;
        let mut corners = Vec::with_capacity(12);
        for roll in [rolls.low, rolls.high] {
            corners.extend([-half_b, half_b, cut(roll, -half_k), cut(roll, half_k)].map(|w| Corner { roll, w }));
        }
        for w in [-half_b, half_b] {
            corners.extend([-half_k, half_k].map(|y| Corner { roll: roll_at(w, y), w }));
        }
        let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
        for Corner { roll, w } in corners {
            let y = pinion.base_radius_mm * (roll * cos_t - sin_t) * sin_s + w * cos_s;
            let inside = |value: f64, low: f64, high: f64| {
                let slack = 1e-9 * (1.0 + high.abs());
                value >= low - slack && value <= high + slack
            };
            if inside(roll, rolls.low, rolls.high) && inside(w, -half_b, half_b) && inside(y, -half_k, half_k) {
                let place = pinion.base_radius_mm * roll * cos_b - w * sin_b - line_distance * sin_n;
                let stroke = (0.5 * rack.tooth_thickness_mm + place / cos_n) / pitch;
                (first, last) = (first.min(stroke), last.max(stroke));
            }
        }
        if first <= last {
            Self { ratio: last - first, offset: 0.5 * (last + first) }
        } else {
            Self { ratio: 0.0, offset: 0.0 }
        }
    }

    /// Whether a tooth of the rack always carries on both flanks: then no shifts of whole teeth sink the pinion.
    #[must_use]
    pub fn has_both_flanks_of_a_rack_tooth(&self) -> bool {
        self.ratio >= 1.0 + 2.0 * self.offset.abs()
    }

    /// Whether a tooth of the pinion always does.
    #[must_use]
    pub fn has_both_flanks_of_a_pinion_tooth(&self) -> bool {
        self.ratio >= 1.0 + (1.0 - 2.0 * self.offset).abs()
    }
}

/// A corner of the field of contact.
#[derive(Clone, Copy)]
struct Corner {
    roll: f64,
    w: f64,
}

impl KnownPair {
    /// What is known of a pair for errors that together move ΔCD by up to `reach_mm`; see
    /// [`reach_mm`](super::reach_mm). Solves the error-free mesh over a pitch where lines of contact alone do not say what
    /// its curve is: a contact ratio near 1 and below, flank form, a rack that may roll.
    ///
    /// # Errors
    /// [`KnownPairError`] if errors as large leave no flanks or the pair does not mesh.
    pub fn new(given: GivenPair, reach_mm: f64) -> Result<Self, KnownPairError> {
        let pair = &given.pair;
        let line_distance = pair.nominal_center_distance_mm() + thickness_offset(pair);
        let excess = Profile::new(pair, line_distance, reach_mm).largest_excess().value;
        let reach = reach_mm + excess;
        let shift = SHORTENING * shift_rad(pair, reach);
        let shorter = Profile::new(pair, line_distance, -reach);
        let rolls = Rolls { low: shorter.lowest_line() + shift, high: pair.pinion().tip_roll_rad - shift };
        let narrower = pair.pinion().base_radius_mm * shift * trig::sin(pair.shaft_angle_rad()).abs();
        let line = ContactPath::of(pair, line_distance, rolls, -narrower);
        let mut known = Self {
            given,
            reach: reach_mm,
            line_distance,
            line,
            own: Range { lower: 0.0, upper: 0.0 },
            rack_sections: None,
            pinion_sections: None,
        };
        known.set_sections(rolls, narrower);
        known.own = known.own_range(reach, excess)?;
        Ok(known)
    }

    /// The range of ΔCD without errors, as far as errors change the flanks that carry: the nominal teeth's
    /// thickness, form, undercut, gaps in the path of contact.
    fn own_range(&self, reach: f64, excess: f64) -> Result<Range, KnownPairError> {
        let GivenPair { pair, pinion_form, .. } = &self.given;
        let offset = thickness_offset(pair);
        // a form that adds material: a negative profile slope
        let added = (-pinion_form.profile_slope_mm).max(0.0) / trig::sin(pair.normal_pressure_angle_rad());
        let upper = offset + excess + added;
        let lower = if self.carries_lines() { offset } else { self.lowest(reach)?.min(offset) };
        Ok(Range { lower, upper })
    }

    /// Whether lines of contact carry on both sides at every stroke, whatever the errors.
    pub(super) fn carries_lines(&self) -> bool {
        self.line.ratio >= 1.0 && !self.given.has_form() && !self.given.rolls()
    }

    /// The lowest ΔCD of the pair with flanks shortened by what errors may shift them.
    fn lowest(&self, reach: f64) -> Result<f64, KnownPairError> {
        let GivenPair { mut rack_form, pinion_form, support, .. } = self.given;
        let shortened = shortened(&self.given.pair, reach);
        let pair = Pair::new(&shortened).map_err(|source| KnownPairError::Geometry { reach_mm: reach, source })?;
        rack_form.tip_relief_start_mm -= reach;
        let rack = RackFlanks::nominal(&pair).with_form(&pair, rack_form)?;
        let pinion = PinionFlanks::nominal(&pair).with_form(pinion_form)?;
        let mesh = Mesh::new(pair, rack, pinion, support)?;
        let tolerance = if self.given.rolls() { ROLLING_CURVE_MM } else { CURVE_MM };
        let curve = mesh.curve(0.0, pair.rack().pitch_mm, tolerance)?;
        let lowest = curve.points.iter().map(|point| point.delta_cd_mm).fold(f64::INFINITY, f64::min);
        Ok(lowest - tolerance)
    }

    /// The path on which flanks carry that stand out by up to `error` mm of centre distance more than their neighbours:
    /// edges lengthen it.
    pub(super) fn lengthened(&self, error: f64) -> ContactPath {
        let pair = &self.given.pair;
        let profile = Profile::new(pair, self.line_distance, self.reach);
        let carrying = profile.carrying(error);
        let shift = shift_rad(pair, self.reach);
        let rolls = Rolls { low: carrying.low - shift, high: carrying.high + shift };
        let wider = (profile.off_line(error) + pair.pinion().base_radius_mm * shift)
            * trig::sin(pair.shaft_angle_rad()).abs();
        ContactPath::of(pair, self.line_distance, rolls, 1.2 * wider)
    }

    /// The nominal path of contact.
    #[must_use]
    pub fn nominal_path(&self) -> ContactPath {
        ContactPath::nominal(&self.given.pair)
    }

    /// The pair's own range without errors, as wide as errors up to the reach may make it, mm.
    #[must_use]
    pub const fn own_mm(&self) -> Range {
        self.own
    }

    /// The largest sum of errors that this holds for, mm of ΔCD.
    #[must_use]
    pub const fn reach_mm(&self) -> f64 {
        self.reach
    }

    fn set_sections(&mut self, rolls: Rolls, narrower: f64) {
        if self.given.has_form() || self.given.rolls() || rolls.low >= rolls.high {
            return;
        }
        let pair = &self.given.pair;
        let (rack, pinion) = (pair.rack(), pair.pinion());
        let (sin_s, cos_s) = trig::sin_cos(pair.shaft_angle_rad());
        let (sin_t, cos_t) = trig::sin_cos(pinion.transverse_pressure_angle_rad);
        let off_axis = |roll: f64| (pinion.base_radius_mm * (roll * cos_t - sin_t)).abs();
        let skew = sin_s.abs() * off_axis(rolls.low).max(off_axis(rolls.high));
        let transverse = (rolls.high - rolls.low) / pinion.angular_pitch_rad();
        // along the rack a section's place on the pinion moves with the roll angle
        let along = 1.0 + trig::tan(pinion.helix_angle_rad) * cos_t * cos_t * sin_s / cos_s;
        let half = |own: f64, other: f64| Some(own.min(other)).filter(|&half| half >= 0.0);
        if transverse * along.abs() >= 1.0 {
            self.rack_sections =
                half(0.5 * rack.face_width_mm - narrower, 0.5 * pinion.face_width_mm * cos_s.abs() - skew);
        }
        if transverse >= 1.0 {
            let covered = (0.5 * rack.face_width_mm - narrower - skew) / cos_s.abs();
            self.pinion_sections = half(0.5 * pinion.face_width_mm, covered);
        }
    }

    /// Half the width of the rack, and half that of the pinion, that points of contact can have.
    pub(super) fn half_widths(&self) -> HalfWidths {
        let (rack, pinion) = (self.given.pair.rack(), self.given.pair.pinion());
        let (sin_s, cos_s) = trig::sin_cos(self.given.pair.shaft_angle_rad());
        let depth = (self.line_distance - self.reach - rack.addendum_mm).max(0.0).min(pinion.tip_radius_mm);
        let chord = ((pinion.tip_radius_mm - depth) * (pinion.tip_radius_mm + depth)).sqrt() * sin_s.abs();
        let (half_k, half_b) = (0.5 * rack.face_width_mm, 0.5 * pinion.face_width_mm);
        HalfWidths {
            rack: half_k.min(half_b * cos_s.abs() + chord),
            pinion: half_b.min((half_k + chord) / cos_s.abs()),
        }
    }

    /// The heights over the reference plane at which flanks touch.
    pub(super) fn heights(&self) -> Range {
        let lower = self.line_distance - self.reach + self.own.lower.min(0.0) - self.given.pair.pinion().tip_radius_mm;
        Range { lower, upper: self.given.pair.rack().addendum_mm }
    }
}

/// Half of the faces of both parts, mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfWidths {
    pub(super) rack: f64,
    pub(super) pinion: f64,
}

/// ΔCD of nominal teeth that are thicker than the standard ones, mm.
fn thickness_offset(pair: &Pair) -> f64 {
    let (rack, pinion) = (pair.rack(), pair.pinion());
    let tan_n = trig::tan(pair.normal_pressure_angle_rad());
    let cos_p = trig::cos(pinion.helix_angle_rad);
    let standard = (0.5 * PI + 2.0 * pinion.profile_shift * tan_n) * pair.normal_module_mm() / cos_p;
    let thicker = rack.tooth_thickness_mm - 0.5 * PI * pair.normal_module_mm();
    (thicker + (pinion.tooth_thickness_mm - standard) * cos_p) / (2.0 * tan_n)
}

/// How far errors of so much ΔCD move a contact line on a flank, rad of roll angle: a flank by e / (m_n z / 2), and the
/// rotation by as much.
fn shift_rad(pair: &Pair, reach: f64) -> f64 {
    let per_rad = 0.5 * pair.normal_module_mm() * f64::from(pair.pinion().teeth);
    2.0 * reach * trig::tan(pair.normal_pressure_angle_rad()) / per_rad
}

/// The same pair with less of its flanks: what is left of them whatever errors up to the reach shift.
fn shortened(pair: &Pair, reach: f64) -> PairData {
    let (rack, pinion) = (pair.rack(), pair.pinion());
    let cos_p = trig::cos(pinion.helix_angle_rad);
    let tan_n = trig::tan(pair.normal_pressure_angle_rad());
    let standard = (0.5 * PI + 2.0 * pinion.profile_shift * tan_n) * pair.normal_module_mm() / cos_p;
    let shift = SHORTENING * shift_rad(pair, reach);
    let radius = |roll: f64| pinion.base_radius_mm * (1.0 + roll * roll).sqrt();
    let narrower = pinion.base_radius_mm * shift * trig::sin(pair.shaft_angle_rad()).abs();
    PairData {
        normal_module_mm: pair.normal_module_mm(),
        normal_pressure_angle_rad: pair.normal_pressure_angle_rad(),
        rack: RackData {
            helix_angle_rad: rack.helix_angle_rad,
            face_width_mm: rack.face_width_mm - 2.0 * narrower,
            addendum_mm: rack.addendum_mm - reach,
            tooth_thickness_mm: Some(rack.tooth_thickness_mm),
        },
        pinion: PinionData {
            teeth: pinion.teeth,
            helix_angle_rad: pinion.helix_angle_rad,
            profile_shift: pinion.profile_shift,
            tip_diameter_mm: 2.0 * radius(pinion.tip_roll_rad - shift),
            root_form_diameter_mm: Some(2.0 * radius(pinion.start_roll_rad + shift)),
            face_width_mm: pinion.face_width_mm,
            tooth_thickness_deviation_mm: pinion.tooth_thickness_mm - standard,
        },
    }
}
