//! What one side of the mesh asks for: the largest demand of all flank pairs in reach. The solver calls it at each
//! rotation that it tries, and balances both sides.
//!
//! A quick bound shows that most pairs in reach do not carry. The others are searched, each from where it touched last:
//! without that place the mesh takes up to 2.3 times as long on crossed pairs. The demand at that place bounds the demand
//! nearby: without this bound a rack that rolls takes twice as long.

use std::ops::RangeInclusive;

use super::contact::{Pose, Touch};
use super::sampler::{Constants, Looks, Sampler, Seen, Slot};
use super::{FlankSide, Mesh, MeshError, MeshPoint, Support};
use crate::trig;

/// Demands closer than this share of r_b / sin α_t are the same: rounding of the roll angle leaves some 1e-15.
const TIE: f64 = 1e-14;

/// A position of the pinion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Position {
    pub(super) stroke_mm: f64,
    /// The rack tooth nearest to the pinion, and its nominal place.
    pub(super) tooth: i64,
    pub(super) place: f64,
    /// Angle of the pinion tooth of the same number at offset 0.
    pub(super) angle: f64,
    /// Angle of pinion tooth 0 less `tooth_angle`.
    pub(super) to_first: f64,
}

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

/// What a flank pair asks for near a rotation: a straight line over it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PairLine {
    side: FlankSide,
    pub(crate) rack_tooth: i64,
    pub(crate) pinion_tooth: i64,
    value_mm: f64,
    /// Its derivative by the rotation, mm/rad.
    rate: f64,
    /// Its derivative by the height of the rack's flank.
    per_height: f64,
}

impl PairLine {
    /// The line with the flanks where another mesh has them, if they are displaced there and not turned. The contact stays on
    /// its edge.
    pub(crate) fn displaced(self, from: &Mesh, to: &Mesh) -> Self {
        let [old, new] = [from, to].map(|mesh| mesh.mating_flanks(self.side, self.rack_tooth));
        let raised = (new.offset - old.offset) / old.normal[2] * self.per_height;
        let turned = (new.start - old.start) * self.side.sign() * self.rate;
        Self { value_mm: self.value_mm + raised + turned, ..self }
    }

    /// The centre distance at which the highest lines of both sides cross; `None` if a side has none.
    pub(crate) fn crossing(lines: &[Self]) -> Option<f64> {
        const MOST_STEPS: usize = 16;
        const ENOUGH_RAD: f64 = 1e-12;
        let mut turned = 0.0;
        let highest = |side: FlankSide, turned: f64| {
            let of_side = lines.iter().filter(|line| line.side == side);
            of_side.map(|line| (line.value_mm + line.rate * turned, line.rate)).max_by(|a, b| a.0.total_cmp(&b.0))
        };
        for _ in 0..MOST_STEPS {
            let (right, left) = (highest(FlankSide::Right, turned)?, highest(FlankSide::Left, turned)?);
            let step = (right.0 - left.0) / (left.1 - right.1);
            if !step.is_finite() {
                return None;
            }
            if step.abs() < ENOUGH_RAD {
                return Some(right.0.max(left.0));
            }
            turned += step;
        }
        Some(highest(FlankSide::Right, turned)?.0.max(highest(FlankSide::Left, turned)?.0))
    }
}

/// One side at one rotation: what all its flank pairs share.
struct Turn<'a> {
    side: FlankSide,
    position: &'a Position,
    /// Angle of the pinion tooth that meets the rack's nearest one on this side, and the number of that rack tooth.
    angle: f64,
    first: i64,
    pose: Pose,
}

/// The largest demand of one side so far.
#[derive(Default)]
struct Best {
    demand: Option<Demand>,
    /// Demands closer than this are equal; of equal ones the first tooth's counts, in whichever order they were searched.
    tie: f64,
    is_first_of_ties: bool,
    /// A rack tooth that has no thickness or is out of order.
    disorder: Option<i64>,
}

impl Best {
    /// The demand from which a tooth is searched exactly, and the demand that it must exceed to carry: the names of carriers
    /// must not flicker.
    fn bar(&self, tooth: i64) -> (f64, f64) {
        match &self.demand {
            None => (f64::NEG_INFINITY, f64::NEG_INFINITY),
            Some(best) if self.is_first_of_ties && tooth < best.tooth => (best.value - self.tie, best.value - self.tie),
            Some(best) => (best.value, best.value + self.tie),
        }
    }
}

impl Sampler<'_> {
    /// The rack tooth nearest to the pinion's axis, its displacement by deviations included.
    pub(super) fn locate(&mut self, stroke_mm: f64) -> Result<Position, MeshError> {
        let Constants { pitch, angular_pitch, angle_per_mm, stroke_limit, .. } = self.constants;
        if stroke_mm.abs() > stroke_limit || stroke_mm.is_nan() {
            return Err(MeshError::StrokeOutOfDomain { stroke_mm, limit_mm: stroke_limit });
        }
        let mut tooth = (stroke_mm / pitch).round() as i64;
        let mut place = reduced(tooth, pitch, stroke_mm);
        let mut away = place + self.slot(FlankSide::Right, tooth).prepared.center;
        for _ in 0..64 {
            let steps = (away / pitch).round().clamp(-1e15, 1e15) as i64;
            if steps == 0 {
                break;
            }
            // next to a gap so many steps lead too far: then take one
            let nearer = [steps, steps.signum()].into_iter().find_map(|steps| {
                let tooth = (tooth - steps).clamp(-(1 << 52), 1 << 52);
                let place = reduced(tooth, pitch, stroke_mm);
                let there = place + self.slot(FlankSide::Right, tooth).prepared.center;
                (there.abs() < away.abs()).then_some((tooth, place, there))
            });
            let Some(next) = nearer else { break };
            (tooth, place, away) = next;
        }
        if away.abs() > pitch {
            return Err(MeshError::RackToothOrder { stroke_mm, tooth });
        }
        let teeth = i64::from(self.mesh.pair().pinion().teeth);
        let to_first = -(tooth.rem_euclid(teeth) as f64) * angular_pitch;
        Ok(Position { stroke_mm, tooth, place, angle: 0.5 * angular_pitch + place * angle_per_mm, to_first })
    }

    /// What both sides ask for with the pinion turned by `offset` against its nominal rotation.
    pub(super) fn demands(&mut self, position: &Position, offset: f64) -> Result<[Demand; 2], MeshError> {
        self.work.rotations += 1;
        Ok([self.demand(FlankSide::Right, position, offset)?, self.demand(FlankSide::Left, position, offset)?])
    }

    /// One side with the pinion turned by `offset`, and its flank pairs in reach, counted from the rack's nearest tooth.
    fn turn<'p>(&self, side: FlankSide, position: &'p Position, offset: f64) -> (Turn<'p>, RangeInclusive<i64>) {
        let Constants { angular_pitch, window, eccentricity, .. } = self.constants;
        let (sign, angle) = (side.sign(), position.angle + offset);
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
        let pairs = ((low - angle) / angular_pitch).ceil() as i64..=((high - angle) / angular_pitch).floor() as i64;
        (Turn { side, position, angle, first: position.tooth + ahead, pose }, pairs)
    }

    /// The largest demand of one side.
    pub(super) fn demand(&mut self, side: FlankSide, position: &Position, offset: f64) -> Result<Demand, MeshError> {
        let (turn, pairs) = self.turn(side, position, offset);
        let mut best = self.best(&turn, pairs.clone());
        if best.demand.is_none() && self.looks == Looks::AtPeaks {
            self.looks = Looks::Everywhere;
            best = self.best(&turn, pairs);
            self.looks = Looks::AtPeaks;
        }
        let stroke_mm = position.stroke_mm;
        if let Some(tooth) = best.disorder {
            return Err(MeshError::RackToothOrder { stroke_mm, tooth });
        }
        let best = best.demand.ok_or(MeshError::NoContact { stroke_mm, side })?;
        self.carries(side, best.tooth);
        Ok(best)
    }

    /// What each flank pair in reach asks for at the rotation of a point, of those that `is_asked` by their teeth of rack and
    /// pinion; `None` if teeth are out of order. For a fixed rack.
    pub(crate) fn lines(&mut self, at: &MeshPoint, is_asked: impl Fn(i64, i64) -> bool) -> Option<Vec<PairLine>> {
        let position = self.locate(at.stroke_mm).ok()?;
        let teeth = i64::from(self.mesh.pair().pinion().teeth);
        let mut lines = Vec::new();
        for side in [FlankSide::Right, FlankSide::Left] {
            let (turn, pairs) = self.turn(side, &position, -at.transmission_error_rad);
            for n in pairs {
                let (rack_tooth, pinion_tooth) = (turn.first + n, (position.tooth + n).rem_euclid(teeth));
                if !is_asked(rack_tooth, pinion_tooth) {
                    continue;
                }
                let mut alone = Best::default();
                self.look(&turn, n, &mut alone);
                if alone.disorder.is_some() {
                    return None;
                }
                if let Some(Demand { value: value_mm, rate, pose, touch, .. }) = alone.demand {
                    let per_height =
                        self.slot(side, rack_tooth).prepared.contact.rate_of_place(&pose, &touch, [1.0, 0.0]);
                    lines.push(PairLine { side, rack_tooth, pinion_tooth, value_mm, rate, per_height });
                }
            }
        }
        Some(lines)
    }

    /// The highest demand of these flank pairs.
    fn best(&mut self, turn: &Turn<'_>, pairs: RangeInclusive<i64>) -> Best {
        let tie = TIE * self.constants.default_rate;
        let mut best = Best { tie, is_first_of_ties: self.mesh.support() != Support::Fixed, ..Best::default() };
        let carried = self.carried[usize::from(turn.side == FlankSide::Left)];
        let is_partial = self.looks == Looks::AtPeaks;
        let [favourite, known @ ..] =
            carried.map(|tooth| Some(tooth.wrapping_sub(turn.first)).filter(|n| pairs.contains(n)));
        // first the pair that carried last: it sets the mark that the others must reach
        let mut look = |n: i64| self.look(turn, n, &mut best);
        favourite.into_iter().for_each(&mut look);
        if is_partial {
            known.into_iter().flatten().for_each(look);
        } else {
            pairs.filter(|&n| Some(n) != favourite).for_each(look);
        }
        best
    }

    /// Searches the flank pair n teeth from the rack's nearest tooth, if it may ask for more than the mark.
    fn look(&mut self, turn: &Turn<'_>, n: i64, best: &mut Best) {
        let Constants { pitch, angular_pitch, .. } = self.constants;
        let Turn { side, position, angle, first, .. } = *turn;
        let tooth = first + n;
        let turned = angle + n as f64 * angular_pitch;
        let place = position.place + (tooth - position.tooth) as f64 * pitch;
        self.work.in_reach += 1;
        let Slot { prepared, .. } = self.slot(side, tooth);
        if !prepared.in_order {
            best.disorder = best.disorder.or(Some(tooth));
        }
        let pose = Pose { c: side.sign() * turned + prepared.start, shift: prepared.per_shift * place, ..turn.pose };
        if best.demand.is_none() || !prepared.stays_below(&pose, best.bar(tooth).1) {
            self.touch(side, tooth, place, &pose, best);
        }
    }

    /// Searches where one flank pair touches, unless the bound from its last search shows that it cannot carry.
    fn touch(&mut self, side: FlankSide, tooth: i64, place: f64, pose: &Pose, best: &mut Best) {
        let (constants, roll, looks) = (self.constants, self.roll.angle, self.looks);
        let (floor, mark) = best.bar(tooth);
        let Slot { prepared, seen, peaks, at_peaks, .. } = self.slot(side, tooth);
        let is_partial = looks == Looks::AtPeaks && prepared.plain.is_some() && peaks.are_known;
        let is_below = |seen: &Seen| seen.stays_below(pose, roll, floor, &constants);
        if seen.as_ref().is_some_and(is_below) || is_partial && at_peaks.as_ref().is_some_and(is_below) {
            return;
        }
        let contact = &prepared.contact;
        if !is_partial
            && let Some((plain, added)) = prepared.plain.as_deref()
            && best.demand.is_some()
        {
            // for a carrier all of the flank counts; for others it is enough to know that they ask for less
            let most = plain.touch(pose, floor - added, seen.map(|seen| seen.hint));
            let most = most.map(|touch| Touch { demand: touch.demand + added, ..touch });
            if most.as_ref().is_none_or(|most| most.demand < floor) {
                (*seen, *at_peaks) = (most.as_ref().map(|most| Seen::new(most, pose, roll)), None);
                self.work.searched += 1;
                return;
            }
        }
        let touch = if is_partial {
            contact.touch_at_peaks(pose, floor, peaks)
        } else if prepared.plain.is_some() {
            contact.touch_with_form(pose, peaks)
        } else {
            contact.touch(pose, floor, seen.map(|seen| seen.hint))
        };
        // a clipped demand is an upper bound, which is enough here
        let now = touch.as_ref().map(|touch| Seen::new(touch, pose, roll));
        *at_peaks = now;
        if !is_partial {
            *seen = now;
        }
        self.work.searched += 1;
        if let Some(touch) = touch
            && touch.demand > mark
        {
            let rate = side.sign() * touch.rate;
            best.demand = Some(Demand { value: touch.demand, rate, tooth, touch, pose: *pose, place });
        }
    }
}

/// `tooth · pitch − stroke` with one rounding of the result: the product is split exactly in two.
fn reduced(tooth: i64, pitch: f64, stroke: f64) -> f64 {
    let count = tooth as f64;
    let split = |x: f64| {
        let c = 134_217_729.0 * x; // 2²⁷ + 1
        let high = c - (c - x);
        (high, x - high)
    };
    let product = count * pitch;
    let ((a, b), (c, d)) = (split(count), split(pitch));
    let error = ((a * c - product) + a * d + b * c) + b * d;
    (product - stroke) + error
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Place and stroke are multiples of 2⁻⁴⁰, so that integers give the difference exactly.
    #[test]
    fn a_far_tooth_is_placed_with_one_rounding() {
        let unit = f64::from_bits(0x3d70_0000_0000_0000);
        let pitch = 6_908_617_345_679_i64;
        for tooth in [0, 1, -3, 1_000_003, -77_777_777_777, (1 << 50) - 1, -(1 << 50) + 12_345] {
            let product = i128::from(tooth) * i128::from(pitch);
            for apart in [0, 1, -7, 123_456_789_012, -987_654_321_098_765] {
                let stroke = ((product + apart) as f64) as i128;
                let expected = (product - stroke) as f64 * unit;
                let found = reduced(tooth, pitch as f64 * unit, stroke as f64 * unit);
                assert_eq!(found, expected, "{tooth} {apart}");
            }
        }
    }
}
