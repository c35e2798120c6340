//! The touch in closed form where the flanks fit, but the line of contact lies beyond the part of the flanks that the
//! faces, the pinion's tip and its root leave. [`FlankContact::touch`] calls it before any search; it gives no answer where
//! it is not sure. Where the rack's tip edge ends the line, see [`rack_corner`](super::rack_corner).
//!
//! It saves time: with the search alone the mesh takes 2.1 times as long on the steering pair with pitch errors.
//!
//! # The demand in roll angle and generator
//! If the base helix angle fits the plane, w drops out: at the roll angle τ on the generator δ the flank's plane asks
//! for
//!
//! ```text
//! F = F_0 + (r_b/sin ν) g(δ, τ),   g = τ (cos δ − 1) + δ − sin δ,   w = (τ − δ − (ν − c))/κ,
//! ```
//!
//! where F_0 is what the contact line δ = 0 asks for. At a fixed w, g changes with τ by −τ sin δ; along an edge
//! of constant τ it changes with δ by 1 − cos δ − τ sin δ. So while δ < 0 everywhere, g grows with τ and with δ, and is
//! largest where both are. While δ > 0 it grows as both fall as long as tan(δ/2) < τ. The rest of the flank,
//! tan(δ/2) ≥ τ, is kept out by the rack's tip plane, which asks there for no more than d + r_b (cos ν − τ_0 sin ν).
//!
//! # The end of the flank
//! Say that κ w is wanted as small as possible, to make δ large (for δ < 0), or as large as possible (for δ > 0). At
//! each τ the pinion's face ends the flank at |w| = b/2, or the rack's before, at |y| = k/2 with
//!
//! ```text
//! y = t (r_b (sin γ − τ cos γ) + e_ξ) + W w,   ∂y/∂w = W − κ t r_b (cos γ + τ sin γ),   ∂y/∂τ = t r_b τ sin γ.
//! ```
//!
//! For 0 ≤ γ ≤ π/2 the first is positive if W > κ t r_a, which [`FlankContact::slides`] asks for, and then δ grows with
//! τ along the rack's end too, by (W − κ t r_b cos γ)/(∂y/∂w) > 0, and so does what was said of g:
//!
//! - δ < 0: it grows with τ if κ t r_b (cos γ − sin γ tan(|δ|/2)) < W. With κ t > 0 that holds as r_b < r_a, with κ t <
//!   0 because γ + |δ|/2 < π/2.
//! - δ > 0: it falls with τ if κ t r_b (cos γ + sin γ tan(δ/2)) < W, where the bracket is cos(ν + δ/2)/cos(δ/2) < 1.
//!
//! So the best point is the end of the tip edge (δ < 0) or of the root edge (δ > 0), if there is one. Both faces may miss
//! each other at that τ, where the rack's face ends before the pinion's begins: then nothing is said. Without a helix δ
//! and τ go together, the edges are generators, and any w that both faces leave will do.
//!
//! Generators with γ < 0 or γ > π/2 are too far away to count: there g ≤ −(ν − sin ν) and, where tan(δ/2) < τ,
//! g ≤ δ − 2 tan(δ/2) ≤ −(π/2 − ν)³/12.

use std::f64::consts::FRAC_PI_2;

use super::{ContactKind, FlankContact, Hint, Pose, Spot, Surface, Touch};
use crate::trig;

/// Steps of Newton's method at most; two or three are enough.
pub(super) const MAX_STEPS: u32 = 12;

/// A step shorter than this, in rad, leaves an error below rounding.
pub(super) const SETTLED: f64 = 1e-8;

/// Which end face ends the edge of constant roll angle.
#[derive(Clone, Copy, PartialEq)]
enum EdgeEnd {
    PinionEnd,
    RackEnd,
}

/// A generator, by its angle.
#[derive(Clone, Copy)]
pub(super) struct Turned {
    pub(super) delta: f64,
    /// sin δ, 1 − cos δ and δ − sin δ.
    pub(super) sin_delta: f64,
    pub(super) versine: f64,
    pub(super) lag: f64,
    /// Sine and cosine of γ = ν + δ.
    pub(super) sin: f64,
    pub(super) cos: f64,
}

/// A point of the flank.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub(super) w: f64,
    pub(super) generator: Turned,
    /// r_b (cos γ + τ sin γ): how far it is towards the rack.
    pub(super) along: f64,
    /// What the flank's plane asks for, and that by δ at a fixed τ, per r_b/sin ν.
    pub(super) demand: f64,
    pub(super) by_delta: f64,
    /// Coordinate across the rack, and its derivative by w.
    pub(super) y: f64,
    pub(super) y_by_w: f64,
}

impl FlankContact {
    /// Whether the end of the flank is known, whatever the rotation. The last condition is that of
    /// [`rack_corner`](super::rack_corner) on the contact line; it holds if the tip circle is outside of the reference
    /// circle.
    pub(in crate::mesh) fn slides(&self, tip_radius: f64) -> bool {
        let turn = self.turn();
        self.fits
            && self.nu < FRAC_PI_2
            && self.across.w > 1.01 * turn * tip_radius
            && self.across.w * self.cos_nu > turn * self.base_radius
    }

    /// κ t, if positive.
    pub(super) fn turn(&self) -> f64 {
        (self.kappa * self.across.t).max(0.0)
    }

    /// By how much generators with γ < 0 or γ > π/2 ask for less than the contact line.
    pub(in crate::mesh) fn far_loss(&self) -> f64 {
        let above = FRAC_PI_2 - self.nu;
        self.scale * (self.nu - self.sin_nu).min(above * above * above / 12.0)
    }

    /// What the rack's tip plane asks for at most on the part of the flank where tan(δ/2) ≥ τ, beyond which the demand
    /// of the flank's plane may grow again.
    pub(super) fn reach_of_root(&self, pose: &Pose) -> f64 {
        self.tip.d + self.base_radius * (self.cos_nu - self.start_roll * self.sin_nu) - pose.offset.1
    }

    /// What the parts of the flank for which nothing is said here ask for at most, given the sign of δ on the others.
    pub(super) fn rest(&self, pose: &Pose, towards_tip: bool) -> f64 {
        let far = self.unbounded(pose) - self.far_loss;
        if towards_tip || self.kappa == 0.0 { far } else { far.max(self.reach_of_root(pose)) }
    }

    /// The corner that touches, if no edge of the rack tooth is in the way.
    pub(super) fn corner(&self, pose: &Pose, floor: f64, hint: Option<Hint>) -> Option<Touch> {
        let zero = pose.c - self.nu;
        let reach = self.kappa.abs() * self.half_face;
        let (least, most) = (zero + self.start_roll - reach, zero + self.tip_roll + reach);
        let towards_tip =
            if most <= 0.0 || least >= 0.0 { most <= 0.0 } else { hint.map_or(most < -least, |hint| hint.delta < 0.0) };
        // the sign of δ is the same on all of the flank, since the contact line is not on it
        for towards_tip in [towards_tip, !towards_tip] {
            let (place, held) = self.end(pose, hint, towards_tip)?;
            if (place.generator.delta < 0.0) == towards_tip {
                return self.settled(pose, floor, &place, held);
            }
        }
        None
    }

    /// Whether the rack's face ends at a point within the pinion's.
    pub(super) fn is_at_rack_end(&self, place: &Place) -> bool {
        const NEAR: f64 = 1e-9;
        let k = self.across.half_width;
        (place.y.abs() - k).abs() <= NEAR * k && place.w.abs() < self.half_face
    }

    /// How the demand of such a corner changes with a shift of the rack's flank and with a shift of the flank's points across
    /// the rack.
    pub(super) fn corner_rate(&self, pose: &Pose, spot: &Spot, [shift, across]: [f64; 2]) -> f64 {
        let place = self.place(pose, self.roll_of(pose, spot), spot.w);
        let w = if self.is_at_rack_end(&place) { -across / place.y_by_w } else { 0.0 };
        shift - self.scale * place.by_delta * self.kappa * w
    }

    /// The roll angle of a point of the flank.
    pub(super) fn roll_of(&self, pose: &Pose, spot: &Spot) -> f64 {
        spot.delta - (pose.c - self.nu) + self.kappa * spot.w
    }

    pub(super) fn turned(&self, delta: f64) -> Turned {
        let (sin_delta, cos_delta) = trig::sin_cos(delta);
        Turned {
            delta,
            sin_delta,
            versine: 1.0 - cos_delta,
            lag: delta - sin_delta,
            sin: self.sin_nu * cos_delta + self.cos_nu * sin_delta,
            cos: self.cos_nu * cos_delta - self.sin_nu * sin_delta,
        }
    }

    pub(super) fn place(&self, pose: &Pose, roll: f64, w: f64) -> Place {
        #[cfg(test)]
        super::tests::count();
        let generator = self.turned((pose.c - self.nu) + roll - self.kappa * w);
        let Turned { sin_delta, versine, lag, sin, cos, .. } = generator;
        let along = self.base_radius * (cos + roll * sin);
        let xi = self.base_radius * (sin - roll * cos) + pose.offset.0;
        Place {
            w,
            generator,
            along,
            demand: self.unbounded(pose) + self.scale * (lag - roll * versine),
            by_delta: versine - roll * sin_delta,
            y: self.across.t * xi + self.across.w * w,
            y_by_w: self.across.w - self.kappa * self.across.t * along,
        }
    }

    /// The end of the flank with the largest roll angle and generator, or with the smallest ones; `None` if the faces
    /// miss each other there.
    fn end(&self, pose: &Pose, hint: Option<Hint>, towards_tip: bool) -> Option<(Place, EdgeEnd)> {
        let (half_face, k) = (self.half_face, self.across.half_width);
        let roll = if towards_tip { self.tip_roll } else { self.start_roll };
        if self.kappa == 0.0 {
            // the edge lies on one generator
            let middle = self.place(pose, roll, 0.0);
            let (low, high) = self.widths_at(middle.y);
            return (low <= high).then_some((Place { w: 0.5 * (low + high), ..middle }, EdgeEnd::PinionEnd));
        }
        let end = if towards_tip { -1.0_f64 } else { 1.0 } * 1.0_f64.copysign(self.kappa);
        let mut place = self.place(pose, roll, end * half_face);
        if end * place.y <= k {
            return (end * place.y >= -k).then_some((place, EdgeEnd::PinionEnd));
        }
        // along the edge to where the rack's face ends
        if let Some(hint) = hint {
            let w = ((pose.c - self.nu) + roll - hint.delta) / self.kappa;
            if w.abs() <= half_face {
                place = self.place(pose, roll, w);
            }
        }
        for _ in 0..MAX_STEPS {
            let step = (end * k - place.y) / place.y_by_w;
            place = self.place(pose, roll, place.w + step);
            if (self.kappa * step).abs() <= SETTLED {
                return (place.w.abs() <= half_face).then_some((place, EdgeEnd::RackEnd));
            }
        }
        None
    }

    /// What both faces leave of w on a generator without helix whose y at w = 0 is given.
    pub(super) fn widths_at(&self, y: f64) -> (f64, f64) {
        let k = self.across.half_width;
        let (low, high) = ((-k - y) / self.across.w, (k - y) / self.across.w);
        (low.max(-self.half_face), high.min(self.half_face))
    }

    /// The touch at the flank's end, unless another point could touch.
    fn settled(&self, pose: &Pose, floor: f64, place: &Place, held: EdgeEnd) -> Option<Touch> {
        let Place { w, generator: Turned { delta, .. }, along, demand, by_delta, y_by_w, .. } = *place;
        let rest = self.rest(pose, delta < 0.0);
        let far = !(0.0..=FRAC_PI_2).contains(&(self.nu + delta));
        if far || rest > demand.max(floor) || self.tip.d + along - pose.offset.1 < demand {
            return None;
        }
        // how δ and τ move with c: with the flank, or along its edge where the rack's face ends
        let swept = along + pose.offset_rate.0;
        let rate = match held {
            EdgeEnd::PinionEnd => by_delta,
            EdgeEnd::RackEnd => by_delta * (1.0 + self.kappa * self.across.t * swept / y_by_w),
        };
        let kind = match (held, self.kappa == 0.0, delta < 0.0) {
            (EdgeEnd::PinionEnd, true, true) => ContactKind::TipEdge,
            (EdgeEnd::PinionEnd, true, false) => ContactKind::RootEdge,
            _ => ContactKind::Corner,
        };
        let rate = self.scale * (rate - 1.0) - self.flank.t * pose.offset_rate.0 - pose.offset_rate.1;
        Some(Touch::at(demand.max(rest), rate, Spot { delta, w, kind, surface: Surface::Flank }))
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh::contact::tests::{NO_FLOOR, Random, contacts, looks};
    use crate::mesh::contact::{Across, ContactKind, FlankContact, Hint, Pose};

    /// The closed forms agree with the search, which shares no code with them, and cases in which they are not sure are rare.
    #[test]
    fn corners_are_what_the_search_finds() {
        for (narrow, least, most) in [(false, [1309, 1535, 1335], 964), (true, [1496, 1377, 1513], 770)] {
            let (mut corners, mut of_rack, mut named, mut unsure) = (0, 0, 0, 0);
            let mut worst = 0.0_f64;
            contacts(narrow, |contact, pose| {
                if !contact.slides || contact.line(pose).is_some() {
                    return;
                }
                let searched = FlankContact { slides: false, ..*contact }.touch(pose, NO_FLOOR, None);
                let direct = contact.corner(pose, NO_FLOOR, None);
                let at_rack = contact.rack_corner(pose, None);
                corners += u32::from(direct.is_some());
                of_rack += u32::from(at_rack.is_some());
                let Some(touch) = direct.or(at_rack) else {
                    unsure += u32::from(searched.is_some());
                    return;
                };
                assert!(direct.is_none() || at_rack.is_none(), "{direct:?}\n{at_rack:?}");
                let searched = searched.expect("the search finds it too");
                assert!(
                    (touch.demand - searched.demand).abs() <= 1e-12,
                    "{touch:?}\n{searched:?}\n{contact:?}\n{pose:?}"
                );
                worst = worst.max((touch.demand - searched.demand).abs());
                // at the base circle, where the demand is level, the search ends beside the edge
                if (touch.spot.delta - searched.spot.delta).abs() < 1e-9 {
                    named += 1;
                    assert_eq!(touch.kind, searched.kind, "{touch:?}\n{searched:?}\n{contact:?}");
                }
            });
            let found = [corners, of_rack, named];
            println!(
                "{found:?} corners, at the rack's tip edge, and named; {unsure} unsure, largest difference {worst:e}"
            );
            assert!(
                found.iter().zip(least).all(|(&found, least)| found >= least) && unsure <= most,
                "{found:?} {unsure}"
            );
        }
    }

    /// The result does not depend on the hint; with it the search takes fewer steps.
    #[test]
    fn a_hint_changes_nothing() {
        for (narrow, most) in [(false, [38_630, 27_190, 39_340, 86_350]), (true, [37_100, 20_570, 29_350, 72_260])] {
            let mut random = Random(2);
            let mut counts = [0; 4];
            contacts(narrow, |contact, pose| {
                let (fresh, count) = looks(|| contact.touch(pose, NO_FLOOR, None));
                counts[0] += count;
                let Some(fresh) = fresh else { return };
                if !contact.slides || contact.line(pose).is_some() {
                    return;
                }
                let near = Hint {
                    delta: fresh.spot.delta + random.next(-1e-4, 1e-4),
                    w: fresh.spot.w * (1.0 + random.next(-1e-3, 1e-3)),
                    at_rack_edge: fresh.at_rack_edge,
                };
                let far = Hint {
                    delta: fresh.spot.delta + random.next(-0.1, 0.1),
                    w: random.next(-1.0, 1.0) * contact.half_face,
                    at_rack_edge: random.next(0.0, 1.0) < 0.5,
                };
                for (hint, counted) in [near, far].into_iter().zip(&mut counts[1..]) {
                    let (found, count) = looks(|| contact.touch(pose, NO_FLOOR, Some(hint)));
                    *counted += count;
                    let found = found.expect("it touched before");
                    assert!(
                        (found.demand - fresh.demand).abs() < 1e-12,
                        "{hint:?} {found:?}\n{fresh:?}\n{contact:?}\n{pose:?}"
                    );
                }
                // below a floor a bound will do
                for above in [1e-9, 1e-4, 0.01, 1.0] {
                    let (found, count) = looks(|| contact.touch(pose, fresh.demand + above, Some(near)));
                    counts[3] += count;
                    if let Some(found) = found {
                        assert!(
                            found.demand >= fresh.demand - 1e-12 && found.demand <= fresh.demand + above + 1e-12,
                            "{above} {found:?}\n{fresh:?}\n{contact:?}\n{pose:?}"
                        );
                    }
                    let found = contact.touch(pose, fresh.demand - above, Some(far)).expect("it asks for more");
                    assert!((found.demand - fresh.demand).abs() < 1e-12, "{found:?}\n{fresh:?}\n{contact:?}\n{pose:?}");
                }
            });
            println!("{counts:?} places looked at: afresh, from near, from afar, with a floor");
            assert!(counts.iter().zip(most).all(|(&count, most)| count <= most), "{counts:?}");
        }
    }

    /// A pair that the quick bound leaves out asks for no more than the mark; nearly all others ask for more, or almost.
    #[test]
    fn what_stays_below_asks_for_less() {
        for (narrow, least) in [(false, [4, 1642, 3475]), (true, [3, 2004, 3256])] {
            let mut below = [0; 3];
            let mut beyond = 0;
            contacts(narrow, |contact, pose| {
                let Some(touch) = contact.touch(pose, NO_FLOOR, None) else { return };
                assert!(!contact.stays_below(pose, touch.demand - 1e-12), "{touch:?}\n{contact:?}\n{pose:?}");
                let line = contact.unbounded(pose);
                if touch.demand < line {
                    beyond += 1;
                    for (share, below) in [0.0, 0.3, 0.9].into_iter().zip(&mut below) {
                        *below +=
                            u32::from(contact.stays_below(pose, touch.demand + share * (line - touch.demand) + 1e-12));
                    }
                }
            });
            println!("of {beyond} beyond the line's end {below:?} stay below none, 0.3 and 0.9 of what they miss");
            assert!(below.iter().zip(least).all(|(&below, least)| below >= least), "{below:?}");
        }
    }

    /// The eccentric offset turns with c: offset(c + h) = offset + h offset_rate to first order.
    #[test]
    fn rates_are_differences_of_demands() {
        let mut compared = 0;
        for narrow in [false, true] {
            contacts(narrow, |contact, pose| {
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
                        let off = (slope - here.rate).abs();
                        assert!(off < 1e-6 + bend, "{off:e} {here:?}\n{contact:?}\n{pose:?}");
                    }
                }
            });
        }
        assert!(compared > 5000, "{compared}");
    }

    /// The closed forms ask for ∂y/∂w > 0 on all of the flank, by a hundredth of it on its tip circle.
    #[test]
    fn a_flank_slides_if_w_leads_across_the_rack_all_over() {
        let nu: f64 = 0.35;
        let (sin_nu, cos_nu) = crate::trig::sin_cos(nu);
        let slides = |kappa: f64, (t, w): (f64, f64), tip_radius: f64| {
            let across = Across { t, w, ..Across::default() };
            FlankContact { base_radius: 20.0, kappa, nu, sin_nu, cos_nu, across, fits: true, ..FlankContact::default() }
                .slides(tip_radius)
        };
        for (kappa, t) in [(0.03, 0.4), (-0.03, -0.4), (0.001, 0.9)] {
            let turn = kappa * t;
            for (share, expected) in [(0.0, false), (0.999, false), (1.001, true), (3.0, true)] {
                // on the tip circle, and on the contact line if that reaches further
                assert_eq!(slides(kappa, (t, share * 1.01 * turn * 25.0), 25.0), expected, "{kappa} {share}");
                assert_eq!(slides(kappa, (t, share * turn * 20.0 / cos_nu), 20.5), expected, "{kappa} {share}");
            }
            // if the helix leads the other way, or on parallel axes, W need only be positive
            for t in [-t, 0.0] {
                assert!(slides(kappa, (t, 1e-3), 25.0) && !slides(kappa, (t, -1e-3), 25.0), "{kappa} {t}");
            }
        }
    }
}
