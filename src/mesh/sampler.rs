//! What is kept from one stroke to the next: the prepared flank pairs, and where each touched last. `solve` and `demand`
//! read and write it; it solves nothing.

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
    /// The rack's present roll; a flank pair is prepared for it when it is next searched.
    pub(super) roll: Roll,
    /// Centre distance assumed where a rolled rack's end faces need one.
    pub(super) assumed: f64,
    /// Rotation offset and rack displacement of the last solution.
    pub(super) last: Option<(f64, f64)>,
    /// Rack teeth that carried, right and left, the last one first. That tooth is searched first, because `reach` then shows
    /// for most others that they ask for less: without this the mesh takes 6 times as long.
    pub(super) carried: [[i64; KNOWN]; 2],
    /// For a rack that rolls: how the last solution changes with the roll.
    pub(super) rolling: Rolling,
    /// For a rack that rolls: the rolls that were tried.
    pub(super) course: Course,
    pub(super) looks: Looks,
    pub(super) work: Work,
}

/// Stands for no tooth.
const NO_TOOTH: i64 = i64::MIN;
/// The teeth of one side that carried last; only so many are kept.
pub(super) const KNOWN: usize = 8;

/// Which part of a side is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Looks {
    /// All flanks in reach, and all of each flank.
    Everywhere,
    /// Only flanks that carried, and flanks with form only where their peaks were: the result is a lower bound of what the side
    /// asks for.
    AtPeaks,
}

/// A flank pair, with its demand at the last search and the place of that search.
#[derive(Debug, Clone)]
pub(super) struct Slot {
    pub(super) tooth: i64,
    /// The rack's roll for which the pair is prepared.
    pub(super) roll: f64,
    pub(super) prepared: Prepared,
    pub(super) seen: Option<Seen>,
    /// For a flank with form: its peaks, and the demand of the highest known peak.
    pub(super) peaks: Peaks,
    pub(super) at_peaks: Option<Seen>,
}

/// An upper bound of the demand of a flank pair, and the position for which it holds.
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
    /// Whether the pair must ask for less than the floor at this position, because a demand changes only so fast.
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
    /// Derivatives of the rotation at which both sides ask for the same.
    pub(super) turn: [f64; 2],
    /// What touches on both sides.
    pub(super) at: Option<[Contact; 2]>,
}

/// Names a contact: its tooth, its kind, the end of the face it is at and the surface it is on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contact {
    pub(super) tooth: i64,
    pub(super) kind: ContactKind,
    /// The edges on which the contact lies.
    pub(super) edges: [Option<ContactKind>; 2],
    pub(super) at_high_end: bool,
    pub(super) surface: Surface,
}

impl Rolling {
    /// 1 less the share of a change of the assumed centre distance that the end faces feed back. The share is small; one
    /// of [`MOST_FED_BACK`] and more is not believed.
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
    /// Upper bound of how fast a demand changes with the rack's roll, mm/rad.
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
            carried: [std::array::from_fn(|i| if i == 0 { 0 } else { NO_TOOTH }); 2],
            rolling: Rolling::default(),
            course: Course::default(),
            looks: Looks::Everywhere,
            work: Work::default(),
        }
    }

    /// A sampler that expects no tooth: of teeth that ask for the same it names the first one wherever it begins, so that names
    /// repeat with the pitch.
    pub(super) fn impartial(mesh: &'a Mesh) -> Self {
        Self { carried: [[NO_TOOTH; KNOWN]; 2], ..Self::new(mesh) }
    }

    /// The work done so far.
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

    /// Prepares a flank pair; keeps what is known of it from another roll.
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
        // beyond the end of the involute by η a flank stays clear by (r_b/sin ν) τ η²/2: search until that is half a module
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
