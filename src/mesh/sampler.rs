//! What is kept from one stroke to the next: the flank pairs as they were prepared and where each was touched last. Read
//! and written by the solver and by what one side asks for; solves nothing.

use super::contact::{ContactKind, Hint, Peaks, Pose, Surface, Touch};
use super::prepare::{Prepared, Roll};
use super::roll::course::Course;
use super::{FlankSide, Mesh, Support, Work};
use crate::trig;

/// Solves one stroke after the other, each starting from the last one's solution.
#[derive(Debug, Clone)]
pub struct Sampler<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) constants: Constants,
    cache: [Vec<Option<Slot>>; 2],
    /// The rack's present roll; flank pairs are prepared anew for it when they are next asked.
    pub(super) roll: Roll,
    /// Centre distance assumed where a rolled rack's end faces need one.
    pub(super) assumed: f64,
    /// Rotation offset and rack displacement of the last solution.
    pub(super) last: Option<(f64, f64)>,
    /// Rack teeth that carried, right and left, the last one first. That is asked first, since most others then are seen
    /// from afar to ask for less: without it the mesh takes 6 times as long.
    pub(super) carried: [[i64; KNOWN]; 2],
    /// For a rack that rolls: how the last solution changes with the roll.
    pub(super) rolling: Rolling,
    /// For a rack that rolls: the rolls that were looked at.
    pub(super) course: Course,
    pub(super) looks: Looks,
    pub(super) work: Work,
}

/// Teeth that carried, as many as are kept of a side.
pub(super) const KNOWN: usize = 8;

/// Where a side is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Looks {
    /// At all flanks in reach, and all of each.
    Everywhere,
    /// At flanks that carried, and where the peaks of those with form were: what is found is what the side asks for at least.
    AtPeaks,
}

/// A flank pair, with what it asked for when it was last searched and where that was.
#[derive(Debug, Clone)]
pub(super) struct Slot {
    pub(super) tooth: i64,
    /// The rack's roll that it is prepared for.
    pub(super) roll: f64,
    pub(super) prepared: Prepared,
    pub(super) seen: Option<Seen>,
    /// Of a flank with form its peaks, and what the highest of the known ones asked for.
    pub(super) peaks: Peaks,
    pub(super) at_peaks: Option<Seen>,
}

/// What a flank pair asked for, at most, and where it did.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub(super) demand: f64,
    pub(super) c: f64,
    pub(super) shift: f64,
    pub(super) roll: f64,
    pub(super) across: f64,
    pub(super) hint: Hint,
}

impl Seen {
    /// Whether this pair asks for less than the floor now, because demands change only so fast.
    pub(super) fn stays_below(&self, pose: &Pose, roll: f64, floor: f64, constants: &Constants) -> bool {
        self.demand
            + LIPSCHITZ * constants.default_rate * (pose.c - self.c).abs()
            + (pose.shift - self.shift).abs()
            + constants.roll_reach * (roll - self.roll).abs()
            + (pose.across - self.across).abs()
            < floor
    }

    pub(super) fn new(touch: &Touch, pose: &Pose, roll: f64) -> Self {
        Self {
            demand: touch.demand,
            c: pose.c,
            shift: pose.shift,
            roll,
            across: pose.across,
            hint: Hint { delta: touch.spot.delta, w: touch.spot.w, at_rack_edge: touch.at_rack_edge },
        }
    }
}

/// A demand changes with the pinion's rotation by (r_b/sin ν)|cos δ + τ sin δ| at a point of the flank, and a little
/// more where end faces sweep over it: this many times r_b / sin α_t is certainly enough.
const LIPSCHITZ: f64 = 4.0;

/// How a solution changes with the rack's roll.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rolling {
    /// Derivatives of the centre distance by the roll, and by the one assumed.
    pub(super) rate: [f64; 2],
    /// The same of the rotation at which both sides ask for the same.
    pub(super) turn: [f64; 2],
    /// What touches on both sides.
    pub(super) at: Option<[Contact; 2]>,
}

/// Names a contact: its tooth, its kind, the end of the face it is at and the surface it is on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contact {
    pub(super) tooth: i64,
    pub(super) kind: ContactKind,
    /// The edges that it is on.
    pub(super) edges: [Option<ContactKind>; 2],
    pub(super) at_high_end: bool,
    pub(super) surface: Surface,
}

impl Rolling {
    /// 1 less the share of a change of the assumed centre distance that the end faces feed back: that is small, and a
    /// share of [`MOST_FED_BACK`] and more is not believed.
    pub(super) fn remaining(&self) -> f64 {
        let fed_back = self.rate[1];
        if fed_back < MOST_FED_BACK { 1.0 - fed_back } else { 1.0 }
    }
}

/// See [`Rolling::remaining`].
const MOST_FED_BACK: f64 = 0.5;

/// Both sides agree if their demands differ by less than this share of r_a; rounding leaves 1e-15 of it.
const AGREEMENT: f64 = 1e-14;

#[derive(Debug, Clone, Copy)]
pub(super) struct Constants {
    pub(super) pitch: f64,
    pub(super) angular_pitch: f64,
    pub(super) angle_per_mm: f64,
    pub(super) nominal: f64,
    /// Range of the pinion tooth's angle within which its flank can touch, for a right rack flank.
    pub(super) window: (f64, f64),
    pub(super) eccentricity: (f64, f64),
    pub(super) stroke_limit: f64,
    pub(super) default_rate: f64,
    pub(super) tolerance: f64,
    /// No demand changes faster than this with the rack's roll, mm/rad.
    pub(super) roll_reach: f64,
}

impl<'a> Sampler<'a> {
    /// A sampler that has seen no stroke yet.
    #[must_use]
    pub fn new(mesh: &'a Mesh) -> Self {
        let constants = Constants::new(mesh);
        let teeth = (constants.window.1 - constants.window.0) / constants.angular_pitch + 4.0;
        let slots = (teeth.clamp(4.0, 4096.0) as usize).next_power_of_two();
        Self {
            mesh,
            constants,
            cache: [vec![None; slots], vec![None; slots]],
            roll: Roll::NONE,
            assumed: mesh.pair().nominal_center_distance_mm(),
            last: None,
            carried: [std::array::from_fn(|i| if i == 0 { 0 } else { i64::MIN }); 2],
            rolling: Rolling::default(),
            course: Course::default(),
            looks: Looks::Everywhere,
            work: Work::default(),
        }
    }

    /// What was done so far.
    #[must_use]
    pub const fn work(&self) -> Work {
        self.work
    }

    /// Keeps the tooth that carries.
    pub(super) fn carries(&mut self, side: FlankSide, tooth: i64) {
        let carried = &mut self.carried[usize::from(side == FlankSide::Left)];
        let place = carried.iter().position(|&known| known == tooth).unwrap_or(KNOWN - 1);
        carried.copy_within(..place, 1);
        carried[0] = tooth;
    }

    #[inline]
    pub(super) fn slot(&mut self, side: FlankSide, tooth: i64) -> &mut Slot {
        let of_side = usize::from(side == FlankSide::Left);
        let index = (tooth as usize) & (self.cache[of_side].len() - 1);
        let ready = |slot: &Slot| slot.tooth == tooth && slot.roll == self.roll.angle;
        if !self.cache[of_side][index].as_ref().is_some_and(ready) {
            self.fill(side, tooth, index);
        }
        let Some(slot) = &mut self.cache[of_side][index] else { unreachable!("it was filled") };
        slot
    }

    /// Prepares a flank pair; what was seen of it at another roll is kept.
    #[cold]
    fn fill(&mut self, side: FlankSide, tooth: i64, index: usize) {
        self.work.prepared += 1;
        let prepared = self.mesh.prepare(side, tooth, &self.roll);
        let slot = &mut self.cache[usize::from(side == FlankSide::Left)][index];
        let (seen, peaks, at_peaks) = match slot {
            Some(slot) if slot.tooth == tooth => (slot.seen, slot.peaks, slot.at_peaks),
            _ => (None, Peaks::default(), None),
        };
        *slot = Some(Slot { tooth, roll: self.roll.angle, prepared, seen, peaks, at_peaks });
    }
}

impl Constants {
    fn new(mesh: &Mesh) -> Self {
        let (rack, pinion) = (mesh.pair().rack(), mesh.pair().pinion());
        let angular_pitch = pinion.angular_pitch_rad();
        let alpha = pinion.transverse_pressure_angle_rad;
        let sin = trig::sin(alpha);
        let scale = pinion.base_radius_mm / sin;
        // beyond the involute's end by η a flank stays clear by (r_b/sin ν) τ η²/2; leave half a module of that
        let margin = (mesh.pair().normal_module_mm() / (scale * pinion.tip_roll_rad)).sqrt().min(1.0);
        let kappa = trig::tan(pinion.helix_angle_rad).abs() / pinion.reference_radius_mm;
        let contact = mesh.prepare(FlankSide::Right, 0, &Roll::NONE).contact;
        let reach = 1.1 * kappa * contact.w_extent + margin;
        let low = alpha - (pinion.tip_roll_rad + reach) + pinion.base_half_angle_rad;
        let high = alpha - (pinion.start_roll_rad - reach - margin) + pinion.base_half_angle_rad;
        Self {
            pitch: rack.pitch_mm,
            angular_pitch,
            angle_per_mm: angular_pitch / rack.pitch_mm,
            nominal: mesh.pair().nominal_center_distance_mm(),
            window: (low, high),
            eccentricity: mesh.pinion().eccentricity_mm(),
            // tooth numbers below 2⁵⁰
            stroke_limit: rack.pitch_mm * 1_125_899_906_842_624.0,
            default_rate: scale,
            roll_reach: 4.0
                * (rack.face_width_mm
                    + rack.addendum_mm
                    + pinion.tip_radius_mm
                    + match mesh.support() {
                        Support::Fixed => 0.0,
                        Support::FreeRoll { axis_depth_mm } => axis_depth_mm.abs(),
                    }),
            tolerance: AGREEMENT * (pinion.tip_radius_mm + mesh.eccentricity()),
        }
    }
}
