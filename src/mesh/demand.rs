//! What one side of the mesh asks for: the largest demand of all flank pairs in reach. Called by the solver at each
//! rotation tried; balances nothing, that is the solver's.
//!
//! Most pairs in reach are seen from afar not to carry, and of those some not at any rotation nearby; the others are
//! touched, each from where it was touched last.

use super::contact::{Hint, Pose, Touch};
use super::prepare::Prepared;
use super::solve::{Constants, Position};
use super::{FlankSide, MeshError, Sampler};
use crate::trig;

/// A flank pair, with what it asked for when it was last searched and where that was.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slot {
    tooth: i64,
    /// The rack's roll that it is prepared for.
    roll: f64,
    pub(super) prepared: Prepared,
    seen: Option<Seen>,
}

#[derive(Debug, Clone, Copy)]
struct Seen {
    demand: f64,
    c: f64,
    shift: f64,
    roll: f64,
    across: f64,
    /// The generator of the contact, and how it moved with the flank's angle between the last two searches.
    delta: f64,
    drift: f64,
    w: f64,
    at_rack_edge: bool,
}

impl Seen {
    fn new(touch: &Touch, pose: &Pose, roll: f64, before: Option<&Self>) -> Self {
        let delta = touch.spot.delta;
        let drift = match before {
            Some(before) if pose.c != before.c => ((delta - before.delta) / (pose.c - before.c)).clamp(-1.0, 2.0),
            Some(before) => before.drift,
            None => f64::from(u8::from(touch.is_carried())),
        };
        Self {
            demand: touch.demand,
            c: pose.c,
            shift: pose.shift,
            roll,
            across: pose.across,
            delta,
            drift,
            w: touch.spot.w,
            at_rack_edge: touch.at_rack_edge,
        }
    }

    fn hint(&self, c: f64) -> Hint {
        let by = c - self.c;
        Hint { delta: self.delta + self.drift * by, w: self.w, at_rack_edge: self.at_rack_edge, spread: 0.1 * by.abs() }
    }
}

/// A demand changes with the pinion's rotation by (r_b/sin ν)|cos δ + τ sin δ| at a point of the flank, and a little
/// more where end faces sweep over it: this many times r_b / sin α_t is certainly enough.
const LIPSCHITZ: f64 = 4.0;

/// Rotations (rad) this near to the first one tried at a stroke need not look at all pairs in reach again.
pub(super) const NEARBY: f64 = 1e-4;

/// Demands closer than this share of r_b / sin α_t are the same: rounding of the roll angle leaves some 1e-15.
const TIE: f64 = 1e-14;

/// What one side asks for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Demand {
    pub(super) value: f64,
    pub(super) rate: f64,
    pub(super) tooth: i64,
    pub(super) touch: Touch,
    pub(super) pose: Pose,
    /// The rack tooth's nominal place.
    pub(super) place: f64,
}

/// One side at one rotation.
struct Turn {
    side: FlankSide,
    /// Angle of the pinion tooth that meets the rack's nearest one on this side, and the number of that rack tooth.
    angle: f64,
    first: i64,
    /// What all flank pairs share.
    pose: Pose,
}

/// The largest demand of one side so far.
struct Best {
    demand: Option<Demand>,
    floor: f64,
    /// What others must exceed: of pairs that ask for the same within rounding the first carries, names of carriers
    /// must not flicker.
    mark: f64,
    /// A rack tooth that has no thickness or is out of order.
    disorder: Option<i64>,
}

impl Default for Best {
    fn default() -> Self {
        Self { demand: None, floor: f64::NEG_INFINITY, mark: f64::NEG_INFINITY, disorder: None }
    }
}

impl Sampler<'_> {
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
        let seen = slot.as_ref().filter(|slot| slot.tooth == tooth).and_then(|slot| slot.seen);
        *slot = Some(Slot { tooth, roll: self.roll.angle, prepared, seen });
    }

    /// The largest demand of one side with the pinion turned by `offset` against its nominal rotation. If that is near
    /// the first one tried at this stroke, pairs that were out of question there are not looked at again.
    pub(super) fn demand(
        &mut self,
        side: FlankSide,
        position: &Position,
        (offset, again): (f64, bool),
        stroke_mm: f64,
    ) -> Result<Demand, MeshError> {
        let Constants { angular_pitch, window, eccentricity, default_rate, .. } = self.constants;
        let (sign, angle, of_side) = (side.sign(), position.angle + offset, usize::from(side == FlankSide::Left));
        let (along, across) = eccentricity;
        let (offset, offset_rate) = if along == 0.0 && across == 0.0 {
            ((0.0, 0.0), (0.0, 0.0))
        } else {
            let (sin, cos) = trig::sin_cos(angle + position.to_first);
            let turned = (along * sin + across * cos, along * cos - across * sin);
            ((sign * turned.0, -turned.1), (turned.1, sign * turned.0))
        };
        let across = self.roll.sin * (self.roll.depth + self.assumed);
        // rack tooth i meets pinion tooth i with its right flank, i − 1 with its left one
        let (low, high, ahead) = match side {
            FlankSide::Right => (window.0, window.1, 0),
            FlankSide::Left => (-window.1, -window.0, 1),
        };
        let pose = Pose { c: 0.0, shift: 0.0, offset, offset_rate, across };
        let turn = Turn { side, angle, first: position.tooth + ahead, pose };
        // the pair that carried last first: it sets the mark that the others must reach
        let favourite = self.carried[of_side].wrapping_sub(turn.first);
        let mut best = Best::default();
        let mut near = std::mem::take(&mut self.near[of_side]);
        if again {
            let favourite = near.contains(&favourite).then_some(favourite);
            for n in favourite.into_iter().chain(near.iter().copied().filter(|&n| Some(n) != favourite)) {
                self.look(&turn, position, n, 0.0, &mut best);
            }
        } else {
            near.clear();
            let (from, to) =
                (((low - angle) / angular_pitch).ceil() as i64, ((high - angle) / angular_pitch).floor() as i64);
            let favourite = (from..=to).contains(&favourite).then_some(favourite);
            let slack = 2.0 * LIPSCHITZ * default_rate * NEARBY;
            for n in favourite.into_iter().chain((from..=to).filter(|&n| Some(n) != favourite)) {
                if self.look(&turn, position, n, slack, &mut best) {
                    near.push(n);
                }
            }
        }
        self.near[of_side] = near;
        if let Some(tooth) = best.disorder {
            return Err(MeshError::RackToothOrder { stroke_mm, tooth });
        }
        let best = best.demand.ok_or(MeshError::NoContact { stroke_mm, side })?;
        self.carried[of_side] = best.tooth;
        Ok(best)
    }

    /// Looks at one flank pair; whether it may carry if the mark falls by the slack.
    fn look(&mut self, turn: &Turn, position: &Position, n: i64, slack: f64, best: &mut Best) -> bool {
        let Constants { pitch, angular_pitch, .. } = self.constants;
        let sign = turn.side.sign();
        let tooth = turn.first + n;
        let (turned, place) =
            (turn.angle + n as f64 * angular_pitch, position.place + (tooth - position.tooth) as f64 * pitch);
        self.work.in_reach += 1;
        let Slot { prepared, .. } = self.slot(turn.side, tooth);
        if !prepared.in_order {
            best.disorder = best.disorder.or(Some(tooth));
        }
        let pose = Pose { c: sign * turned + prepared.start, shift: prepared.per_shift * place, ..turn.pose };
        if best.demand.is_some() && prepared.contact.stays_below(&pose, best.mark - slack) {
            return false;
        }
        if slack == 0.0 || !prepared.contact.stays_below(&pose, best.mark) {
            self.touch(turn.side, (tooth, place), &pose, best);
        }
        true
    }

    /// Where and when one flank pair touches, unless it is known from the last time that another one does before.
    fn touch(&mut self, side: FlankSide, (tooth, place): (i64, f64), pose: &Pose, best: &mut Best) {
        let Constants { default_rate, roll_reach, .. } = self.constants;
        let roll = self.roll.angle;
        let Slot { prepared, seen, .. } = self.slot(side, tooth);
        if let Some(seen) = seen
            && seen.demand
                + LIPSCHITZ * default_rate * (pose.c - seen.c).abs()
                + (pose.shift - seen.shift).abs()
                + roll_reach * (roll - seen.roll).abs()
                + (pose.across - seen.across).abs()
                < best.floor
        {
            return;
        }
        let touch = prepared.contact.touch(pose, best.floor, seen.as_ref().map(|seen| seen.hint(pose.c)));
        // a clipped demand is an upper bound, which is all that is asked of it
        *seen = touch.as_ref().map(|touch| Seen::new(touch, pose, roll, seen.as_ref()));
        self.work.searched += 1;
        if let Some(touch) = touch
            && touch.demand > best.mark
        {
            (best.floor, best.mark) = (touch.demand, touch.demand + TIE * default_rate);
            let rate = side.sign() * touch.rate;
            best.demand = Some(Demand { value: touch.demand, rate, tooth, touch, pose: *pose, place });
        }
    }
}
