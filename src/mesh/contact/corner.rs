//! The ends of the contact line in closed form: where the flanks fit but their line of contact lies beyond the pinion's
//! tip or root edge. Called by [`FlankContact::touch`] before any search; says nothing where it is not sure.
//!
//! # The demand in roll angle and generator
//! If the base helix angle fits the plane, w drops out: at the roll angle τ on the generator δ the flank's plane asks for
//!
//! ```text
//! F = F_0 + (r_b/sin ν) g(δ, τ),   g = τ (cos δ − 1) + δ − sin δ,   w = (τ − δ − (ν − c))/κ,
//! ```
//!
//! where F_0 is what the contact line δ = 0 asks for. At a fixed w, g changes with τ by −τ sin δ; along an edge
//! of constant τ it changes with δ by 1 − cos δ − τ sin δ. So while δ < 0 everywhere, g grows with τ and with δ, and is
//! largest at the corner of tip edge and end face with the largest δ. While δ > 0 it grows as both fall as long
//! as tan(δ/2) < τ, and the best is the corner of the root edge with the smallest δ. The rest of the flank, tan(δ/2) ≥ τ,
//! is kept out by the rack's tip plane, which asks there for no more than d + r_b (cos ν − τ_0 sin ν).
//!
//! On the way to that corner one may meet the rack's end face and then goes along it. δ still grows with τ there if
//! the shaft angle is not too large for the face widths, which [`FlankContact::slides`] tells once for each flank pair.

use super::{ContactKind, FlankContact, Pose, Spot, Touch};
use crate::trig;

/// Steps of Newton's method along the edge at most; two or three are enough.
const MAX_STEPS: u32 = 12;

/// A step shorter than this, in rad or as a share of half the face, leaves an error below rounding.
const SETTLED: f64 = 1e-8;

impl FlankContact {
    /// Whether every point of the flank reaches the corner nearest to the contact line by a way along which the demand
    /// grows, whatever the rotation.
    pub(in crate::mesh) fn slides(&self, tip_radius: f64, off_axis: f64) -> bool {
        let across = self.across.t.abs();
        let turn = self.kappa.abs() * across * tip_radius;
        // dy/dw along an edge of constant τ, and how y changes with τ at a fixed w, for any position of the point
        let along = self.across.w - turn;
        let with_roll = self.kappa.abs() * across * self.base_radius * self.tip_roll;
        self.across.z == 0.0
            && across * (tip_radius + off_axis) < self.across.half_width
            && along > 0.0
            && with_roll < 0.9 * along
    }

    /// What the rack's tip plane asks for at most on the part of the flank where tan(δ/2) ≥ τ, beyond which the demand of
    /// the flank's plane may grow again.
    pub(super) fn reach_of_root(&self, pose: &Pose) -> f64 {
        let low = self.cos_nu - self.start_roll * self.sin_nu;
        if low < 0.0 { f64::INFINITY } else { self.tip.d + self.base_radius * low - pose.offset.1 }
    }

    /// The corner that touches, if the flank's tip or root edge is what is nearest to the contact line and nothing else
    /// of the rack tooth is in the way.
    pub(super) fn corner(&self, pose: &Pose, floor: f64) -> Option<Touch> {
        if !self.slides {
            return None;
        }
        let zero = pose.c - self.nu;
        let reach = self.kappa.abs() * self.half_face;
        let towards_tip = if zero + self.tip_roll - reach >= 0.0 {
            false
        } else if zero + self.start_roll + reach <= 0.0 {
            true
        } else {
            // both edges cross δ = 0 somewhere: decided by where the rack's face ends
            let tip = self.on_edge(pose, self.tip_roll, -1.0)?;
            if tip.delta < 0.0 {
                return self.settled(pose, floor, self.tip_roll, tip);
            }
            false
        };
        let (roll, direction) = if towards_tip { (self.tip_roll, -1.0) } else { (self.start_roll, 1.0) };
        let place = self.on_edge(pose, roll, direction)?;
        if towards_tip == (place.delta < 0.0) { self.settled(pose, floor, roll, place) } else { None }
    }

    /// The end of an edge of constant roll angle with the largest δ (`direction` −1) or the smallest.
    fn on_edge(&self, pose: &Pose, roll: f64, direction: f64) -> Option<Place> {
        let zero = pose.c - self.nu;
        let k = self.across.half_width;
        let at = |w: f64| {
            let delta = zero + roll - self.kappa * w;
            let (sin, cos) = trig::sin_cos(pose.c + roll - self.kappa * w);
            let y = self.across.t * (self.base_radius * (sin - roll * cos) + pose.offset.0) + self.across.w * w;
            Place { delta, w, sin, cos, y, on_face_end: false }
        };
        if self.kappa == 0.0 {
            // the edge lies on one generator
            let middle = at(0.0);
            let (low, high) = self.widths_at(middle.y);
            return (low <= high).then_some(Place { w: 0.5 * (low + high), ..middle });
        }
        let mut w = direction * self.half_face.copysign(self.kappa);
        let mut place = at(w);
        if place.y.abs() <= k {
            return Some(place);
        }
        let target = k.copysign(w);
        if (place.y - target) * w < 0.0 {
            return None;
        }
        for _ in 0..MAX_STEPS {
            let slope = self.across.w - self.kappa * self.across.t * self.base_radius * (place.cos + roll * place.sin);
            let step = (target - place.y) / slope;
            w += step;
            place = at(w);
            if step.abs() <= SETTLED * self.half_face {
                place.on_face_end = true;
                return (w.abs() <= self.half_face).then_some(place);
            }
        }
        None
    }

    /// The point where the rack's tip edge meets an end face (or, without a helix, one generator), if that is what touches.
    ///
    /// Along the end with the smallest δ for each τ let F fall and T, what the rack's tip plane asks for, grow with τ; they
    /// cross at τ*. Points with τ > τ* have a smaller F than there; those with τ < τ* a smaller T, because T falls with
    /// δ at a fixed τ as long as τ < tan γ.
    pub(super) fn rack_corner(&self, pose: &Pose, floor: f64, hint: Option<f64>) -> Option<Touch> {
        if !self.slides {
            return None;
        }
        let zero = pose.c - self.nu;
        let end = if self.kappa == 0.0 { 0.0 } else { self.half_face.copysign(self.kappa) };
        // on parallel axes the rack's face ends at one place along the pinion
        let parallel = self.across.t == 0.0;
        let face_end = if parallel { self.across.half_width / self.across.w } else { f64::INFINITY };
        let (mut w, mut on_face_end) = (end.clamp(-face_end, face_end), end.abs() > face_end);
        let start = hint.map_or(0.1, |delta| delta) - zero + self.kappa * w;
        let mut roll = start.clamp(self.start_roll.max(1e-3), self.tip_roll);
        for step in 0..MAX_STEPS {
            let at = self.rack_point(pose, zero, roll, w);
            if step == 0 && at.y.abs() > self.across.half_width && self.kappa != 0.0 {
                on_face_end = true;
            }
            let y = if on_face_end {
                [at.y - self.across.half_width.copysign(end), at.y_roll, at.y_w]
            } else {
                [0.0, 0.0, 1.0]
            };
            let (by_roll, by_w) = solved([at.excess, y[0]], at.excess_by, [y[1], y[2]]);
            // the crossing lies between both values here, and neither reaches what carries already
            let bound = at.demand.max(at.demand - at.excess);
            if (parallel || !on_face_end) && bound <= floor && self.keeps_out_the_rest(pose, floor, &at, on_face_end) {
                let spot = Spot { delta: at.delta, w, kind: ContactKind::Corner, on_tip: false };
                let (rate, kind, spread) = (at.demand_rate, spot.kind, by_roll.abs());
                return Some(Touch { demand: bound, rate, kind, spot, other: None, spread, vertex: None });
            }
            (roll, w) = ((roll - by_roll).min(self.tip_roll), w - by_w);
            if roll.is_nan() || roll <= self.start_roll {
                return None;
            }
            if by_roll.abs() <= SETTLED && by_w.abs() <= SETTLED * self.half_face {
                return self.rack_touch(pose, floor, &self.rack_point(pose, zero, roll, w), on_face_end);
            }
        }
        None
    }

    fn rack_point(&self, pose: &Pose, zero: f64, roll: f64, w: f64) -> RackPoint {
        let (scale, r) = (self.base_radius / self.sin_nu, self.base_radius);
        let delta = zero + roll - self.kappa * w;
        let (sin, cos) = trig::sin_cos(self.nu + delta);
        let (sin_d, cos_d) = (sin * self.cos_nu - cos * self.sin_nu, cos * self.cos_nu + sin * self.sin_nu);
        let (along, turned) = (r * (cos + roll * sin), r * (roll * cos - sin));
        let (by_delta, t) = (scale * (1.0 - cos_d - roll * sin_d), self.across.t);
        let demand = self.unbounded(pose) + scale * (roll * (cos_d - 1.0) + delta - sin_d);
        let tip = self.tip.d - pose.offset.1 + along;
        let demand_by = [-scale * roll * sin_d, -self.kappa * by_delta];
        RackPoint {
            roll,
            w,
            delta,
            sin,
            cos,
            demand,
            demand_by,
            excess: demand - tip,
            excess_by: [demand_by[0] - r * roll * cos, demand_by[1] + self.kappa * turned],
            y: t * (r * (sin - roll * cos) + pose.offset.0) + self.across.w * w,
            y_roll: t * r * roll * sin,
            y_w: self.across.w - self.kappa * t * along,
            demand_rate: by_delta - scale - self.flank.t * pose.offset_rate.0 - pose.offset_rate.1,
            tip_rate: turned - pose.offset_rate.1,
            y_rate: t * (along + pose.offset_rate.0),
            // tan(δ/2) ≥ τ
            again: sin_d >= roll * (1.0 + cos_d),
        }
    }

    /// Whether no other point of the flank asks for more than the larger of both planes' demands at a point of its end with
    /// the smallest δ, or than the floor.
    fn keeps_out_the_rest(&self, pose: &Pose, floor: f64, at: &RackPoint, on_face_end: bool) -> bool {
        let RackPoint { roll, w, delta, sin, cos, demand, .. } = *at;
        if delta < 0.0 || cos <= 0.0 {
            return false;
        }
        if self.kappa != 0.0 {
            let outside = if on_face_end { w.abs() > self.half_face } else { at.y.abs() > self.across.half_width };
            if outside || at.again || self.reach_of_root(pose) > demand.max(floor) {
                return false;
            }
        }
        // along the rack's face end δ grows by 1 ± q τ as τ does; tan γ − τ is the smallest where the involute starts
        let turn = (self.kappa * self.across.t).abs();
        let q = turn * self.base_radius / (self.across.w - turn * self.base_radius * (1.0 + self.tip_roll));
        let lowest = delta - (roll - self.start_roll) * (1.0 + q * roll);
        let (lowest_sin, lowest_cos) = trig::sin_cos(self.nu + lowest);
        q >= 0.0 && (1.0 - q * roll) * cos > q * sin * sin && lowest_sin >= self.start_roll * lowest_cos
    }

    /// The touch at the rack's tip edge, unless something else could touch or a condition of the proof fails.
    fn rack_touch(&self, pose: &Pose, floor: f64, at: &RackPoint, on_face_end: bool) -> Option<Touch> {
        let RackPoint { mut w, delta, demand, .. } = *at;
        if !self.keeps_out_the_rest(pose, floor, at, on_face_end) {
            return None;
        }
        if self.kappa == 0.0 {
            let (low, high) = self.widths_at(at.y - self.across.w * w);
            if low > high {
                return None;
            }
            w = 0.5 * (low + high);
        }
        let y = if on_face_end { [at.y_rate, at.y_roll, at.y_w] } else { [0.0, 0.0, 1.0] };
        let (by_roll, by_w) = solved([at.demand_rate - at.tip_rate, y[0]], at.excess_by, [y[1], y[2]]);
        let rate = at.demand_rate - at.demand_by[0] * by_roll - at.demand_by[1] * by_w;
        let kind = ContactKind::Corner;
        let spot = Spot { delta, w, kind, on_tip: false };
        Some(Touch { demand, rate, kind, spot, other: None, spread: 0.0, vertex: None })
    }

    /// What both faces leave of w on a generator without helix whose y at w = 0 is given.
    fn widths_at(&self, y: f64) -> (f64, f64) {
        let k = self.across.half_width;
        let (low, high) = ((-k - y) / self.across.w, (k - y) / self.across.w);
        (low.max(-self.half_face), high.min(self.half_face))
    }

    /// The touch at an edge's end, unless more than it could touch.
    fn settled(&self, pose: &Pose, floor: f64, roll: f64, place: Place) -> Option<Touch> {
        let Place { delta, w, sin, cos, on_face_end, .. } = place;
        let scale = self.base_radius / self.sin_nu;
        let (sin_d, cos_d) = (sin * self.cos_nu - cos * self.sin_nu, cos * self.cos_nu + sin * self.sin_nu);
        let demand = self.unbounded(pose) + scale * (roll * (cos_d - 1.0) + delta - sin_d);
        let unsure = sin_d >= roll * (1.0 + cos_d) || self.reach_of_root(pose) > demand.max(floor);
        if delta > 0.0 && self.kappa != 0.0 && unsure {
            return None;
        }
        let along = self.base_radius * (cos + roll * sin);
        if self.tip.d + along - pose.offset.1 < demand {
            return None;
        }
        // how δ moves with c: with the flank, and along its edge where the rack's face ends
        let moves = if on_face_end {
            let swept = self.across.t * (along + pose.offset_rate.0);
            let slope = self.across.w - self.kappa * self.across.t * along;
            1.0 + self.kappa * swept / slope
        } else {
            1.0
        };
        let line_rate = -scale - self.flank.t * pose.offset_rate.0 - pose.offset_rate.1;
        let rate = line_rate + scale * (1.0 - cos_d - roll * sin_d) * moves;
        let kind = match (self.kappa == 0.0, delta < 0.0) {
            (true, true) => ContactKind::TipEdge,
            (true, false) => ContactKind::RootEdge,
            (false, _) => ContactKind::Corner,
        };
        let spot = Spot { delta, w, kind, on_tip: false };
        Some(Touch { demand, rate, kind, spot, other: None, spread: 0.0, vertex: None })
    }
}

/// A point of an edge of constant roll angle.
#[derive(Clone, Copy)]
struct Place {
    delta: f64,
    w: f64,
    /// Sine and cosine of γ.
    sin: f64,
    cos: f64,
    /// Coordinate across the rack.
    y: f64,
    /// Whether the rack's end face ends it, not the pinion's.
    on_face_end: bool,
}

/// A point of the flank with what both of the rack's planes ask for there, and the derivatives by τ (at a fixed w) and w.
struct RackPoint {
    roll: f64,
    w: f64,
    delta: f64,
    /// Sine and cosine of γ.
    sin: f64,
    cos: f64,
    demand: f64,
    demand_by: [f64; 2],
    /// F − T.
    excess: f64,
    excess_by: [f64; 2],
    y: f64,
    y_roll: f64,
    y_w: f64,
    /// Derivatives by c.
    demand_rate: f64,
    tip_rate: f64,
    y_rate: f64,
    again: bool,
}

/// The solution of two linear equations.
fn solved(right: [f64; 2], first: [f64; 2], second: [f64; 2]) -> (f64, f64) {
    let inverse = 1.0 / (first[0] * second[1] - first[1] * second[0]);
    ((right[0] * second[1] - first[1] * right[1]) * inverse, (first[0] * right[1] - right[0] * second[0]) * inverse)
}

#[cfg(test)]
mod tests {
    use crate::gear::{Pair, PairData, PinionData, RackData};
    use crate::mesh::contact::{ContactKind, FlankContact, Pose};
    use crate::mesh::prepare::Roll;
    use crate::mesh::{FlankSide, Mesh};
    use crate::trig;

    /// Numbers in 0..1 that fill it evenly.
    struct Even(f64);

    impl Even {
        fn next(&mut self, low: f64, high: f64) -> f64 {
            self.0 = (self.0 + 0.618_033_988_749_895).fract();
            low + (high - low) * self.0
        }
    }

    fn contacts(mut each: impl FnMut(&FlankContact, &Pose)) {
        let mut even = Even(0.1);
        let mut made = 0;
        while made < 300 {
            let module = even.next(1.0, 3.0);
            let teeth = even.next(6.0, 40.0).round();
            let helix = |even: &mut Even| if even.next(0.0, 1.0) < 0.25 { 0.0 } else { even.next(-0.7, 0.7) };
            let (rack, pinion) = (helix(&mut even), helix(&mut even));
            let parallel = even.next(0.0, 1.0) < 0.3;
            let radius = 0.5 * module * teeth / trig::cos(pinion);
            let shift = even.next(0.0, 0.6);
            let data = PairData {
                normal_module_mm: module,
                normal_pressure_angle_rad: even.next(0.26, 0.43),
                rack: RackData {
                    helix_angle_rad: if parallel { -pinion } else { rack },
                    face_width_mm: even.next(5.0, 15.0) * module,
                    addendum_mm: even.next(0.7, 1.1) * module,
                    tooth_thickness_mm: None,
                },
                pinion: PinionData {
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "6 to 40")]
                    teeth: teeth as u32,
                    helix_angle_rad: pinion,
                    profile_shift: shift,
                    tip_diameter_mm: 2.0 * (radius + module * (shift + even.next(0.6, 1.0))),
                    root_form_diameter_mm: Some(2.0 * (radius + module * (shift - even.next(0.8, 1.2)))),
                    face_width_mm: even.next(5.0, 15.0) * module,
                    tooth_thickness_deviation_mm: 0.0,
                },
            };
            let Ok(mesh) = Pair::new(&data).map(|pair| Mesh::nominal(pair).expect("teeth in order")) else { continue };
            made += 1;
            let side = if made % 2 == 0 { FlankSide::Right } else { FlankSide::Left };
            let contact = mesh.prepare(side, 0, &Roll::NONE).contact;
            for _ in 0..12 {
                let reach = contact.kappa.abs() * contact.half_face + 0.2;
                let roll = even.next(contact.start_roll - reach, contact.tip_roll + reach);
                let (x, z) = (even.next(-0.1, 0.1), even.next(-0.1, 0.1));
                let c = contact.nu - roll;
                let pose = Pose { c, shift: 0.0, offset: (x, z), offset_rate: (-z, x), across: 0.0 };
                // placed as where the pinion is near its place: the line asks for the nominal centre distance or so
                let line = contact.unbounded(&pose);
                let wanted = mesh.pair().nominal_center_distance_mm() + even.next(-0.1, 0.1);
                each(&contact, &Pose { shift: wanted - line, ..pose });
            }
        }
    }

    /// The search knows nothing of these formulas.
    #[test]
    fn corners_are_what_the_search_finds() {
        let (mut corners, mut of_rack, mut named, mut worst) = (0, 0, 0, 0.0_f64);
        contacts(|contact, pose| {
            if contact.line(pose).is_some() {
                return;
            }
            let searched = FlankContact { slides: false, ..*contact }.touch(pose, f64::NEG_INFINITY, None);
            let direct = contact.corner(pose, f64::NEG_INFINITY);
            corners += u32::from(direct.is_some());
            let at_rack = if direct.is_none() { contact.rack_corner(pose, f64::NEG_INFINITY, None) } else { None };
            of_rack += u32::from(at_rack.is_some());
            let Some(touch) = direct.or(at_rack) else { return };
            let searched = searched.expect("the search finds it too");
            assert!(
                touch.demand >= searched.demand - 1e-12 && touch.demand <= searched.demand + 1e-12,
                "{touch:?}\n{searched:?}\n{contact:?}\n{pose:?}"
            );
            worst = worst.max((touch.demand - searched.demand).abs());
            // at the base circle, where the demand is level, the search ends beside the edge
            if (touch.spot.delta - searched.spot.delta).abs() < 1e-9 {
                named += 1;
                assert_eq!(touch.kind, searched.kind, "{touch:?}\n{searched:?}\n{contact:?}");
            }
        });
        println!("{corners} corners, {of_rack} at the rack's tip edge, largest difference {worst:e}");
        assert!(corners > 500 && of_rack > 50 && named > 500, "{corners} {of_rack} {named}");
    }

    /// The eccentric offset turns with c: offset(c + h) = offset + h offset_rate to first order.
    #[test]
    fn rates_are_differences_of_demands() {
        let (mut compared, mut worst) = (0, 0.0_f64);
        contacts(|contact, pose| {
            let h = 1e-6;
            let moved = |h: f64| {
                let (x, z) = pose.offset;
                let (dx, dz) = pose.offset_rate;
                Pose { c: pose.c + h, offset: (x + h * dx, z + h * dz), ..*pose }
            };
            let at = |h: f64| contact.touch(&moved(h), f64::NEG_INFINITY, None);
            let (Some(before), Some(here), Some(after)) = (at(-h), at(0.0), at(h)) else { return };
            if before.kind == here.kind && after.kind == here.kind && here.kind != ContactKind::Line {
                let slope = (after.demand - before.demand) / (2.0 * h);
                let bend = (after.demand - 2.0 * here.demand + before.demand).abs() / h;
                // not across a corner of the demand
                if bend < 1e-3 {
                    compared += 1;
                    worst = worst.max((slope - here.rate).abs());
                }
            }
        });
        println!("{compared} rates, largest difference {worst:e}");
        assert!(compared > 1000 && worst < 1e-5, "{compared} {worst:e}");
    }
}
