//! The end of the contact line at the rack's tip edge, in closed form. Called by [`FlankContact::touch`] where the
//! flanks fit and the pinion's flank goes deeper than the rack's teeth; says nothing where it is not sure. The setting
//! and the names are those of [`corner`](super::corner).
//!
//! # Where it is
//! Let E(τ) be the end of the flank with the smallest δ > 0 at each τ, at the pinion's end face or the rack's. Along it
//! F, what the flank's plane asks for, falls with τ, and T = d + r_b (cos γ + τ sin γ), what the rack's tip plane asks
//! for, grows, if cos γ > 0 and W cos γ > κ t r_b; they cross at τ*. What about other points of the flank?
//!
//! - τ > τ* and tan(δ/2) < τ: F is smaller than at E(τ), and there smaller than at the crossing.
//! - τ > τ* and tan(δ/2) ≥ τ: T is at most d + r_b (cos ν − τ sin ν), less than at the crossing if tan(δ/2) < τ there.
//! - τ < τ* and F ≥ T: at the same δ, T grows with τ, until it meets F or E(τ) below τ*, where it is smaller than at the
//!   crossing.
//! - τ < τ* and F ≤ T: at the same δ, F grows as τ falls, until it meets T or, at τ = 0, is less than T = d + r_b cos γ.
//!   The latter is less than at the crossing, where γ is smaller.
//!
//! The points where T meets F are one for each δ, since F − T falls with τ. As δ grows along them, away from the
//! crossing, what both ask for changes as cos γ (1 − cos δ) − sin γ sin δ does, which is negative: tan γ > tan(δ/2).
//!
//! So the crossing touches, if both faces are over each other there.
//!
//! It saves time: with the search instead the mesh takes up to 4.7 times as long (crossed axes, z = 30).

use super::corner::{MAX_STEPS, Place, SETTLED, Turned};
use super::{ContactKind, FlankContact, Hint, Pose, Spot, Surface, Touch};

/// A point of the flank with what both of the rack's planes ask for there, and the derivatives by τ (at a fixed w) and
/// w.
struct RackPoint {
    place: Place,
    demand_by_roll: f64,
    /// F − T.
    excess: f64,
    excess_by: [f64; 2],
    y_by_roll: f64,
    /// Derivatives by c.
    demand_rate: f64,
    tip_rate: f64,
}

impl FlankContact {
    /// The point where the rack's tip edge meets an end face (or, without a helix, one generator), if that is what
    /// touches.
    pub(super) fn rack_corner(&self, pose: &Pose, hint: Option<Hint>) -> Option<Touch> {
        let k = self.across.half_width;
        let zero = pose.c - self.nu;
        let side = 1.0_f64.copysign(self.kappa);
        let end = if self.kappa == 0.0 { 0.0 } else { side * self.half_face };
        let mut w = end;
        let mut at_rack_end = false;
        if let Some(hint) = hint
            && hint.at_rack_edge
            && hint.w * side < self.half_face * (1.0 - 1e-9)
            && self.kappa != 0.0
        {
            (w, at_rack_end) = (hint.w, true);
        }
        let start = hint.map_or(0.1, |hint| hint.delta) - zero + self.kappa * w;
        let mut roll = start.clamp(self.start_roll.max(1e-3), self.tip_roll);
        for step in 0..MAX_STEPS {
            let at = self.rack_point(pose, roll, w);
            if step == 0 && self.kappa != 0.0 && side * at.place.y > k {
                at_rack_end = true;
            }
            let y = if at_rack_end { [at.place.y - side * k, at.y_by_roll, at.place.y_by_w] } else { [0.0, 0.0, 1.0] };
            let (by_roll, by_w) = solved([at.excess, y[0]], at.excess_by, [y[1], y[2]]);
            (roll, w) = ((roll - by_roll).min(self.tip_roll), w - by_w);
            if roll.is_nan() || roll <= self.start_roll {
                return None;
            }
            if by_roll.abs() <= SETTLED && (self.kappa * by_w).abs() <= SETTLED {
                let at = self.rack_point(pose, roll, w);
                if at_rack_end && side * w > self.half_face {
                    (w, at_rack_end) = (end, false);
                } else if !at_rack_end && self.kappa != 0.0 && side * at.place.y > k {
                    at_rack_end = true;
                } else {
                    return self.rack_touch(pose, &at, at_rack_end);
                }
            }
        }
        None
    }

    /// As [`corner_rate`](Self::corner_rate), of a corner at the rack's tip edge.
    pub(super) fn rack_corner_rate(&self, pose: &Pose, spot: &Spot, [shift, across]: [f64; 2]) -> f64 {
        let at = self.rack_point(pose, self.roll_of(pose, spot), spot.w);
        let is_at_rack_end = self.is_at_rack_end(&at.place);
        let y = if is_at_rack_end { [-across, at.y_by_roll, at.place.y_by_w] } else { [0.0, 0.0, 1.0] };
        let (by_roll, by_w) = solved([-shift, y[0]], at.excess_by, [y[1], y[2]]);
        shift + at.demand_by_roll * by_roll - self.scale * at.place.by_delta * self.kappa * by_w
    }

    fn rack_point(&self, pose: &Pose, roll: f64, w: f64) -> RackPoint {
        let place = self.place(pose, roll, w);
        let Turned { sin_delta, sin, cos, .. } = place.generator;
        let (scale, r) = (self.scale, self.base_radius);
        let (turned, by_delta) = (r * (roll * cos - sin), scale * place.by_delta);
        let demand_by_roll = -scale * roll * sin_delta;
        RackPoint {
            place,
            demand_by_roll,
            excess: place.demand - (self.tip.d - pose.offset.1 + place.along),
            excess_by: [demand_by_roll - r * roll * cos, -self.kappa * by_delta + self.kappa * turned],
            y_by_roll: self.across.t * r * roll * sin,
            demand_rate: by_delta - scale - self.flank.t * pose.offset_rate.0 - pose.offset_rate.1,
            tip_rate: turned - pose.offset_rate.1,
        }
    }

    /// Whether no other point of the flank asks for more than the crossing of both planes' demands.
    fn keeps_out_the_rest(&self, pose: &Pose, at: &RackPoint) -> bool {
        let Place { generator: Turned { delta, cos, .. }, demand, by_delta, .. } = at.place;
        if delta < 0.0 || cos <= 0.0 {
            return false;
        }
        self.kappa == 0.0
            || self.across.w * cos > self.turn() * self.base_radius
                && by_delta <= 0.0
                && self.unbounded(pose) - self.far_loss <= demand
    }

    /// The touch at the rack's tip edge, unless something else could touch or a condition of the proof fails.
    fn rack_touch(&self, pose: &Pose, at: &RackPoint, at_rack_end: bool) -> Option<Touch> {
        let (place, k) = (&at.place, self.across.half_width);
        let mut w = place.w;
        if !self.keeps_out_the_rest(pose, at) {
            return None;
        }
        if self.kappa == 0.0 {
            let (low, high) = self.widths_at(place.y);
            if low > high {
                return None;
            }
            w = 0.5 * (low + high);
        } else if w.abs() > self.half_face || !at_rack_end && place.y.abs() > k {
            return None;
        }
        // w stays at the end of the pinion's face, and at the end of the rack's too: the corner of the rack tooth has one place
        // across the rack and one along it, and so one ξ and one w
        let by_roll = (at.demand_rate - at.tip_rate) * (1.0 / at.excess_by[0]);
        let rate = at.demand_rate - at.demand_by_roll * by_roll;
        let spot = Spot { delta: place.generator.delta, w, kind: ContactKind::Corner, surface: Surface::Flank };
        Some(Touch { at_rack_edge: true, ..Touch::at(place.demand, rate, spot) })
    }
}

/// The solution of two linear equations.
fn solved(right: [f64; 2], first: [f64; 2], second: [f64; 2]) -> (f64, f64) {
    let inverse = 1.0 / (first[0] * second[1] - first[1] * second[0]);
    ((right[0] * second[1] - first[1] * right[1]) * inverse, (first[0] * right[1] - right[0] * second[0]) * inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::contact::tests::{Random, scanned};
    use crate::mesh::contact::{Across, Plane};
    use crate::trig;

    /// Where the shafts cross so steeply that W hardly exceeds κ t r_a, the rack's tip plane may ask for less and less
    /// along the rack's end face: then the corner is not the highest point.
    #[test]
    fn a_corner_that_is_not_the_top_does_not_touch() {
        let mut random = Random(10);
        let (mut corners, mut others) = (0, 0);
        for _ in 0..3000 {
            let (nu, w) = (random.next(0.3, 0.5), random.next(0.1, 0.9));
            let (sin_nu, cos_nu) = trig::sin_cos(nu);
            let (base_radius, start_roll, tip_roll) = (10.0, random.next(0.05, 0.2), random.next(0.3, 0.6));
            let tip_radius = base_radius * f64::sqrt(1.0 + tip_roll * tip_roll);
            let t = (1.0 - w * w).sqrt();
            let kappa = random.next(0.9, 0.999) * w / (1.01 * t * tip_radius);
            let contact = FlankContact {
                base_radius,
                kappa,
                start_roll,
                tip_roll,
                half_face: random.next(1.0, 5.0),
                flank: Plane { d: 0.0, t: cos_nu / sin_nu, w: base_radius * kappa / sin_nu },
                across: Across { t, w, z: 0.0, half_width: random.next(0.2, 2.0) },
                nu,
                sin_nu,
                cos_nu,
                fits: true,
                ..FlankContact::default()
            };
            let roll = random.next(start_roll - 0.3, tip_roll);
            let none = (0.0, 0.0);
            let pose = Pose { c: nu - roll, shift: 0.0, offset: none, offset_rate: none, across: 0.0 };
            let mut contact = contact.completed(tip_radius, 0.0);
            let asked = contact.unbounded(&pose) - contact.scale * random.next(0.0, 0.003);
            contact.tip.d = asked - base_radius * (cos_nu + random.next(start_roll, tip_roll) * sin_nu);
            if !contact.slides || contact.line(&pose).is_some() {
                continue;
            }
            match (contact.rack_corner(&pose, None), scanned(&contact, &pose)) {
                (Some(corner), best) => {
                    corners += 1;
                    assert!(
                        best.is_some_and(|best| (best - corner.demand).abs() < 1e-9),
                        "{best:?} {corner:?}\n{contact:?}"
                    );
                }
                (None, _) => others += 1,
            }
        }
        assert!(corners > 50 && others > 1000, "{corners} {others}");
    }
}
