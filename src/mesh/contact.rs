//! One rack flank against one pinion flank: the centre distance at which they touch. Called by the solver for every
//! flank pair in reach; knows nothing of other teeth, strokes or tolerances of a curve.
//!
//! # Setting
//! Everything is written for a right flank of the rack and a left flank of the pinion; the other side is the mirror
//! image in X. Transverse coordinates of the pinion are ξ, horizontal, and ζ, vertical, both from its axis, and w
//! along the axis. With the base radius r_b, κ = tan β_b / r_b and the angle c of the flank's start at
//! mid-width, the involute helicoid is the set of straight generators, one for each angle γ,
//!
//! ```text
//! τ = γ − c + κ w,   ξ = r_b (sin γ − τ cos γ),   ζ = −r_b (cos γ + τ sin γ),
//! ```
//!
//! bounded by τ_0 ≤ τ ≤ τ_a, |w| ≤ b/2, and by the rack's end faces |y| ≤ k/2. Along a generator all coordinates are
//! linear in w. The rack tooth is the solid under planes; where a pinion point lies over it, the flank's plane and
//! the tip's plane each ask for a centre distance that is linear in the coordinates, and the smaller of both keeps the
//! point out. So on one generator the largest demand is that of a concave function, piecewise linear in w,
//! on an interval: [`generator`] finds it in closed form, and what remains is one maximum over γ.
//!
//! With ν the angle at which the flank plane's normal appears in the transverse plane and δ = γ − ν, the demand at a
//! fixed w has the derivative −(r_b/sin ν) τ sin δ: without bounds the best generator is δ = 0. If the base helix angle
//! fits the plane, the demand is constant along that generator, which is then the contact line.

mod climb;
mod corner;
mod form;
mod generator;
mod rack_corner;
mod reach;
mod roll_rate;
mod slip;
#[cfg(test)]
pub(super) mod tests;

pub(super) use form::{Form, FormRates, Peaks};
pub(super) use roll_rate::{PoseRates, RollRates};
pub(super) use slip::{Motion, Normal};

use std::f64::consts::PI;

use self::climb::Search;
use self::generator::{Bound, Coordinates, Generator, Line};
use self::reach::Reach;
use crate::trig;

/// A plane of the rack tooth, scaled so that it asks for the centre distance `d − t ξ − k_w w − ζ`, with k_w
/// in the field `w`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Plane {
    pub(super) d: f64,
    pub(super) t: f64,
    pub(super) w: f64,
}

/// The coordinate across the rack: `t ξ + k_w w + z ζ + pose.across`, with k_w in the field `w`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Across {
    pub(super) t: f64,
    pub(super) w: f64,
    pub(super) z: f64,
    pub(super) half_width: f64,
}

named! {
    /// Where on the flanks a contact is.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    #[non_exhaustive]
    pub enum ContactKind {
        /// Along a whole generator: flank against flank.
        Line = "line",
        /// Inside both flanks at one point; only with flank form.
        Point = "point",
        /// At the pinion's tip edge.
        TipEdge = "tip edge",
        /// At the edge where the pinion's involute starts.
        RootEdge = "root edge",
        /// At the edge between the rack's flank and its tip plane.
        RackEdge = "rack edge",
        /// At an end face of the rack.
        RackEndEdge = "end edge",
        /// At an end face of the pinion.
        PinionEndEdge = "end edge",
        /// Where two of these edges meet.
        Corner = "corner",
    }
}

display_by_name!(ContactKind);

/// A flank pair, ready to be asked. `c` and the eccentric offsets are set for each position of the pinion.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FlankContact {
    pub(super) base_radius: f64,
    pub(super) kappa: f64,
    pub(super) start_roll: f64,
    pub(super) tip_roll: f64,
    pub(super) half_face: f64,
    pub(super) flank: Plane,
    pub(super) tip: Plane,
    pub(super) across: Across,
    /// ν and its sine and cosine.
    pub(super) nu: f64,
    pub(super) sin_nu: f64,
    pub(super) cos_nu: f64,
    /// Whether the base helix angle fits the plane, so that the contact line is a generator.
    pub(super) fits: bool,
    /// Whether the helix angle fits and [`FlankContact::slides`] holds.
    pub(super) slides: bool,
    /// r_b/sin ν.
    pub(super) scale: f64,
    /// See [`FlankContact::far_loss`].
    pub(super) far_loss: f64,
    /// Constants of the quick bound.
    pub(super) reach: Reach,
    /// 1/κ, or 0 without a helix.
    pub(super) inverse_kappa: f64,
    /// 1 over dy/dw on the contact line; infinite if it runs along the rack.
    pub(super) inverse_across: f64,
    /// Bound of |w| from all end faces.
    pub(super) w_extent: f64,
    /// Slope of the demand along the generator δ = 0.
    pub(super) tilt: f64,
    pub(super) form: Option<Form>,
}

/// The part that changes with the pinion's rotation and the stroke.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pose {
    /// Angle of the flank's start at mid-width.
    pub(super) c: f64,
    /// Added to the flank plane's `d`.
    pub(super) shift: f64,
    /// Eccentric offset along ξ and ζ, and its derivative by c.
    pub(super) offset: (f64, f64),
    pub(super) offset_rate: (f64, f64),
    /// Constant part of the coordinate across the rack; not 0 only when the rack is rolled.
    pub(super) across: f64,
}

/// The largest demand of a flank pair and where it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    /// Centre distance asked for; an upper bound if the search ended early because the floor is out of reach.
    pub(super) demand: f64,
    /// Its derivative by c.
    pub(super) rate: f64,
    pub(super) kind: ContactKind,
    pub(super) spot: Spot,
    /// Where two edges meet: the other spot, and the share of the first in what their meeting point does.
    pub(super) other: Option<(Spot, f64)>,
    /// At a vertex of the patch: a generator beyond it and the demand's rate per rate of the gap there.
    pub(super) vertex: Option<(f64, f64)>,
    /// Whether the contact is where the rack's tip edge ends the contact line.
    pub(super) at_rack_edge: bool,
}

/// A point of contact: generator, place on it, and what bounds it there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spot {
    pub(super) delta: f64,
    pub(super) w: f64,
    pub(super) kind: ContactKind,
    pub(super) surface: Surface,
}

impl Spot {
    fn is_on_tip(&self) -> bool {
        self.surface == Surface::Tip
    }
}

/// The rack's surfaces: the flank, the flank where it has tip relief, and the tip plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Surface {
    Flank,
    Relieved,
    Tip,
}

/// Where a contact is expected: there the search begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hint {
    pub(super) delta: f64,
    pub(super) w: f64,
    pub(super) at_rack_edge: bool,
}

/// Generators from one δ to another.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Range {
    lo: f64,
    hi: f64,
}

impl Touch {
    /// A contact that one spot decides.
    fn at(demand: f64, rate: f64, spot: Spot) -> Self {
        Self { demand, rate, kind: spot.kind, spot, other: None, vertex: None, at_rack_edge: false }
    }

    /// Whether what touches lies over the rack tooth's tip plane, away from its flank.
    pub(super) fn is_on_tip(&self) -> bool {
        self.spot.is_on_tip() && self.other.is_none_or(|(spot, _)| spot.is_on_tip())
    }
}

/// Relative accuracy of a demand, against the base radius. Rounding leaves about 1e-15.
const DEMAND: f64 = 2e-15;

/// Iterations after which a maximum over generators is given up refining; the bracket halves at least every third.
const MAX_EVALUATIONS: u32 = 200;

/// Where the coordinate across the rack has an extreme, its derivative says nothing: look this far (rad) beside it.
const BESIDE: f64 = 1e-3;

impl FlankContact {
    /// The flank pair with the constants that follow from its geometry.
    pub(super) fn completed(self, tip_radius: f64, eccentricity: f64) -> Self {
        let mut contact = Self {
            scale: self.base_radius / self.sin_nu,
            inverse_kappa: if self.kappa == 0.0 { 0.0 } else { 1.0 / self.kappa },
            // there is a contact line only if the rack is not rolled
            inverse_across: 1.0 / (self.across.w - self.base_radius * self.kappa * (self.across.t * self.cos_nu)),
            ..self
        };
        contact.slides = contact.slides(tip_radius);
        if contact.slides {
            contact.far_loss = contact.far_loss();
            contact.reach = contact.reach(tip_radius, eccentricity);
        }
        contact
    }

    /// The demand of the generator δ = 0 at w = 0, bounds ignored.
    fn unbounded(&self, pose: &Pose) -> f64 {
        self.flank.d + pose.shift + self.scale * (self.nu - pose.c) - self.flank.t * pose.offset.0 - pose.offset.1
    }

    /// From where to where along w the contact line runs, if the helix fits and part of that generator is on both flanks.
    fn line_span(&self, pose: &Pose) -> Option<(f64, f64)> {
        if !self.fits {
            return None;
        }
        let roll = self.nu - pose.c;
        if self.kappa == 0.0 && !(self.start_roll..=self.tip_roll).contains(&roll) {
            return None;
        }
        let xi = self.base_radius * (self.sin_nu - roll * self.cos_nu) + pose.offset.0;
        let (mut lo, mut hi) = (-self.half_face, self.half_face);
        if self.kappa != 0.0 {
            let (a, b) = ((self.start_roll - roll) * self.inverse_kappa, (self.tip_roll - roll) * self.inverse_kappa);
            lo = lo.max(a.min(b));
            hi = hi.min(a.max(b));
        }
        // where it runs along the rack the bounds are infinite: both on one side if it lies beside the rack's face
        let (y, k) = (self.across.t * xi, self.across.half_width);
        let (a, b) = ((-k - y) * self.inverse_across, (k - y) * self.inverse_across);
        lo = lo.max(a.min(b));
        hi = hi.min(a.max(b));
        (lo <= hi).then_some((lo, hi))
    }

    /// The contact along that line, unless the tip plane asks for more.
    fn line(&self, pose: &Pose) -> Option<Touch> {
        let (lo, hi) = self.line_span(pose)?;
        let (r, roll) = (self.base_radius, self.nu - pose.c);
        let (sin, cos) = (self.sin_nu, self.cos_nu);
        let zeta = -r * (cos + roll * sin) + pose.offset.1;
        let demand = self.unbounded(pose);
        // the tip plane asks for tip.d − ζ (it is level whenever the helix fits); highest where ζ is lowest
        let down = r * self.kappa * sin;
        let lowest = (zeta - down * lo).min(zeta - down * hi);
        if self.tip.d - lowest < demand {
            return None;
        }
        let rate = -self.scale - self.flank.t * pose.offset_rate.0 - pose.offset_rate.1;
        let spot = Spot { delta: 0.0, w: 0.5 * (lo + hi), kind: ContactKind::Line, surface: Surface::Flank };
        Some(Touch::at(demand, rate, spot))
    }

    /// The largest demand over the whole flank; `None` if no point of it is over the rack's face.
    ///
    /// Demands that cannot reach `floor` need not be exact. `hint` is where the contact is expected.
    pub(super) fn touch(&self, pose: &Pose, floor: f64, hint: Option<Hint>) -> Option<Touch> {
        if self.form.is_some() {
            return self.touch_with_form(pose, &mut Peaks::default());
        }
        let flank = self.generators(pose)?;
        let line = self.line(pose);
        if self.kappa == 0.0 && line.is_some() {
            return line;
        }
        if line.is_none()
            && self.slides
            && let Some(touch) = self.end_of_line(pose, floor, hint)
        {
            return Some(touch);
        }
        self.search(pose, line, &Search { range: flank, flank, floor, start: hint.map(|hint| hint.delta), known: None })
    }

    /// The generators of the flank.
    fn generators(&self, pose: &Pose) -> Option<Range> {
        let zero = pose.c - self.nu;
        let reach = self.kappa.abs() * self.half_face;
        let flank = Range { lo: (zero + self.start_roll - reach).max(-PI), hi: (zero + self.tip_roll + reach).min(PI) };
        (flank.lo <= flank.hi).then_some(flank)
    }

    /// The touch at a corner, where no generator touches along its whole length, in closed form; `None` where that is not sure.
    fn end_of_line(&self, pose: &Pose, floor: f64, hint: Option<Hint>) -> Option<Touch> {
        let zero = pose.c - self.nu;
        let at_rack_edge = hint.map_or(zero + 0.5 * (self.start_roll + self.tip_roll) > 0.0, |hint| hint.at_rack_edge);
        let corner = || self.corner(pose, floor, hint);
        let rack_corner = || self.rack_corner(pose, hint);
        if at_rack_edge { rack_corner().or_else(corner) } else { corner().or_else(rack_corner) }
    }

    /// The largest demand of all generators, or of the contact line.
    fn search(&self, pose: &Pose, line: Option<Touch>, search: &Search) -> Option<Touch> {
        let (Range { lo, hi }, floor) = (search.flank, search.floor);
        let mut best = line;
        // peaks equal within rounding: the first found names the contact
        let tie = 8.0 * DEMAND * self.scale;
        let root = if self.fits { self.reach_of_root(pose) } else { f64::INFINITY };
        let harmless = root <= best.map_or(floor, |best| best.demand.max(floor));
        // the part that is not searched still counts in the bound
        let bounded =
            |best: Touch| Touch { demand: if harmless { best.demand.max(root) } else { best.demand }, ..best };
        let climb = |best: Option<Touch>, lo: f64, hi: f64| {
            let found = if lo <= hi { self.climb(pose, &Search { range: Range { lo, hi }, ..*search }) } else { None };
            found.filter(|found| best.is_none_or(|best| found.demand > best.demand + tie)).or(best)
        };
        // Along the edge where the involute starts, at δ beyond the contact line, the demand differs from the line's by
        // (r_b/sin ν)(δ³/6 − τ_0 δ²/2 + …): an involute that starts near its base circle reaches out again there.
        let rise = 2.0 * self.start_roll;
        if !harmless && pose.c - self.nu + self.start_roll + self.kappa.abs() * self.half_face > rise {
            best = climb(best, lo.max(rise), hi);
        }
        if self.fits && best.is_some_and(|best| best.kind == ContactKind::Line) {
            return best.map(bounded);
        }
        if let Some(turn) = self.jump() {
            let past = turn * (1.0 + 1e-9);
            best = climb(best, lo.max(-turn), hi.min(turn));
            best = climb(best, lo.max(past), hi);
            best = climb(best, lo, hi.min(-past));
        } else {
            best = climb(best, lo, hi);
        }
        if best.is_none() {
            // the faces may meet on either side of where the flank's way across the rack turns
            let level = trig::atan2(self.across.z, self.across.t) - self.nu;
            for turn in [level - PI, level, level + PI].into_iter().filter(|&turn| lo < turn && turn < hi) {
                best = climb(best, lo, turn - BESIDE);
                best = climb(best, turn + BESIDE, hi);
            }
        }
        best.map(bounded)
    }

    /// Off δ = 0 the demand rises along a generator by tilt − (r_b κ/sin ν)(1 − cos δ) per w. Where that changes its
    /// sign, at this δ to either side, the best point jumps from one end of the generator to the other, and there may be a
    /// peak on either side. `None` if the sign does not change.
    fn jump(&self) -> Option<f64> {
        let share = self.tilt * self.sin_nu / (self.base_radius * self.kappa);
        (share > 0.0 && share < 2.0).then(|| 2.0 * trig::asin((0.5 * share).sqrt()))
    }
}
