//! Exact helicoid against exact plane, cut into strips over the pinion's face. Called by the scene for every flank pair
//! of a position.
//!
//! A strip is a section at w. Its gap is the smallest over the profile's part below the rack's tip edge: on the contact
//! line at the roll angle τ_*, or at the pinion's tip, the start of its involute, or the rack's tip edge, whichever
//! bounds τ_*. The load per length k δ^a (and damping) acts there; strips of the width Δw sum it by the midpoint
//! rule, whose error falls as Δw². At the rack's end faces a strip counts with the share of it that lies within.
//!
//! Derivatives use the effective normal m: the rack's, or, on the rack's tip edge, m = N − (N·P_τ/z_τ) ẑ,
//! which is perpendicular to the profile. Then ∂g/∂q = m·∂P/∂q in every case. Of form (crowning, relief) the tangent
//! leaves the second derivatives out.

use super::bound::BEND;
use super::face::{Face, OnFace};
use super::flank::{FlankPosition, Point, removal};
use super::load::{Element, Load, Sliding};
use super::meeting::{Meeting, PlacedRow};
use super::template::Row;
use crate::deviation::RackForm;
use crate::linear::{dot, increase};
use crate::trig;

/// Sections further before or beyond the contact line than this (rad) are clear.
const FAR: f64 = 1.5;

/// Adds the contacts of one flank pair.
pub(super) fn touch(meeting: &Meeting<'_>, form: &RackForm, load: &mut Load<'_>) {
    let Meeting { pair, template, reach, placed, .. } = meeting;
    let plain = !reach.rolls && form.is_plain() && template.form.is_plain();
    let direct = Direct::new(meeting);
    let by = [placed.n_zeta, placed.sign * pair.normal[0], 0.0];
    let mut face = Face::new(load, (pair.right, pair.rack_tooth), by);
    for placed_row in meeting.rows() {
        load.work.counters.spheres_tested += 1;
        let PlacedRow { row, crossing, .. } = placed_row;
        let tau = crossing.clamp(template.start_roll, template.tip_roll);
        if plain && tau == crossing {
            if direct.touch(row, tau, &mut face, load) {
                continue;
            }
        } else if (tau - crossing).abs() > FAR {
            continue;
        }
        if let Some(section) = Section::lowest(meeting, row, crossing)
            && let Some(element) = section.element(form)
        {
            let sliding = || Sliding { normal: pair.normal, motion: section.at.point.motion };
            load.add(pair.right, pair.rack_tooth, &element, sliding);
        }
    }
    face.close(load);
}

/// Sections that touch on the contact line of plane flanks: their gaps are linear in everything but an eccentricity.
struct Direct<'a> {
    meeting: &'a Meeting<'a>,
    /// ξ = r_b (sin ν − τ cos ν), ζ = −r_b (cos ν + τ sin ν).
    sin: f64,
    cos: f64,
    /// |N_t| r_b (1 − cos 1).
    rise: f64,
    by_angle: f64,
    by_angle_twice: f64,
    top: f64,
}

impl<'a> Direct<'a> {
    fn new(meeting: &'a Meeting<'a>) -> Self {
        let FlankPosition { sign, n_xi, n_zeta, length, eccentric, .. } = meeting.placed;
        let base_radius = meeting.template.base_radius;
        Self {
            meeting,
            sin: n_zeta / length,
            cos: n_xi / length,
            rise: length * base_radius * BEND,
            by_angle: sign * (eccentric.1 * n_xi - eccentric.0 * n_zeta - length * base_radius),
            by_angle_twice: -(eccentric.0 * n_xi + eccentric.1 * n_zeta),
            top: meeting.pose.at.center_distance + eccentric.1,
        }
    }

    /// Adds a section's contact if it is one on the contact line; `false` if it may touch elsewhere.
    fn touch(&self, row: &Row, tau: f64, face: &mut Face, load: &mut Load<'_>) -> bool {
        let Meeting { pair, template, pose, reach, placed, bound, .. } = self.meeting;
        let gap = bound.height(row.w);
        let r = template.base_radius;
        let above = self.top - r * (self.cos + tau * self.sin) - pair.bounds.tip;
        if above > 0.0 {
            // only the part below the rack's tip may touch: z falls by at most r_b cos ν (τ² − τ_*²)/2, and the section
            // rises as `Bound` has it
            if self.cos <= 0.0 {
                return false;
            }
            let end = (tau * tau + 2.0 * above / (r * self.cos)).sqrt();
            let beyond = (end - tau).min(1.0);
            return reach.cull && gap + self.rise * tau * beyond * beyond >= bound.stop;
        }
        let x = r * (self.sin - tau * self.cos);
        let y = row.w * placed.cos_shaft - (x + placed.eccentric.0) * placed.sin_shaft;
        let share = share(self.meeting, y, row.weight);
        if gap >= 0.0 || share == 0.0 {
            return true;
        }
        if share < 1.0 {
            return false;
        }
        let on = OnFace {
            gap,
            weight: row.weight,
            by_angle: self.by_angle,
            by_angle_twice: self.by_angle_twice,
            ..OnFace::default()
        };
        face.add(&on, load, || {
            let zeta = -r * (self.cos + tau * self.sin);
            Sliding { normal: pair.normal, motion: placed.point(pose, x, zeta, row.w).motion }
        });
        true
    }
}

/// Least cosine of the shaft angle.
const LEAST: f64 = 1e-3;

/// The share of a strip that lies between the rack's end faces.
fn share(meeting: &Meeting<'_>, y: f64, width: f64) -> f64 {
    let cell = width * meeting.placed.cos_shaft.abs().max(LEAST);
    ((meeting.pair.bounds.half_width - y.abs()) / cell + 0.5).clamp(0.0, 1.0)
}

/// A point of the profile in a section.
struct OnProfile {
    tau: f64,
    /// Sine and cosine of γ.
    sin: f64,
    cos: f64,
    point: Point,
    by_tau: [f64; 3],
}

impl OnProfile {
    fn new(meeting: &Meeting<'_>, w: f64, tau: f64) -> Self {
        let Meeting { template, pose, placed, .. } = meeting;
        let (sin, cos) = trig::sin_cos(placed.c + tau - template.kappa * w);
        let r = template.base_radius;
        let point = placed.point(pose, r * (sin - tau * cos), -r * (cos + tau * sin), w);
        Self { tau, sin, cos, point, by_tau: placed.direction(pose, r * tau * sin, -r * tau * cos) }
    }

    /// From here on towards the pinion's tip, which z falls to, the place at the rack's tip edge; `None` if there is none.
    fn down_to_rack_tip(self, meeting: &Meeting<'_>, w: f64) -> Option<Self> {
        let (tip, mut low, mut high) = (meeting.pair.bounds.tip, self.tau, meeting.template.tip_roll);
        if Self::new(meeting, w, high).point.at[2] >= tip {
            return None;
        }
        let mut here = self;
        for _ in 0..60 {
            let above = here.point.at[2] - tip;
            if above > 0.0 {
                low = here.tau;
            } else {
                high = here.tau;
            }
            let slope = here.by_tau[2];
            let newton = here.tau - above / slope;
            let next = if slope < 0.0 && newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - here.tau).abs() <= 1e-15 {
                break;
            }
            here = Self::new(meeting, w, next);
        }
        Some(here)
    }
}

/// What determines the lowest point of a section.
#[derive(Clone, Copy, PartialEq)]
enum LowestPoint {
    ContactLine,
    RackTip,
    /// An end of the involute.
    Edge,
}

/// The lowest point of a section.
struct Section<'a> {
    meeting: &'a Meeting<'a>,
    row: &'a Row,
    at: OnProfile,
    held: LowestPoint,
}

impl<'a> Section<'a> {
    /// `None` if nothing of the section lies below the rack's tip.
    fn lowest(meeting: &'a Meeting<'a>, row: &'a Row, crossing: f64) -> Option<Self> {
        let tau = crossing.clamp(meeting.template.start_roll, meeting.template.tip_roll);
        let at = OnProfile::new(meeting, row.w, tau);
        if at.point.at[2] > meeting.pair.bounds.tip {
            let at = at.down_to_rack_tip(meeting, row.w)?;
            return Some(Self { meeting, row, at, held: LowestPoint::RackTip });
        }
        let held = if tau == crossing && tau > 0.0 { LowestPoint::ContactLine } else { LowestPoint::Edge };
        Some(Self { meeting, row, at, held })
    }

    /// The contact there; `None` if there is none.
    fn element(&self, form: &RackForm) -> Option<Element> {
        let Meeting { pair, template, placed, .. } = self.meeting;
        let OnProfile { tau, point, by_tau, .. } = &self.at;
        let (bounds, n) = (pair.bounds, &pair.normal);
        let (removed, by_y, by_z) = removal(form, bounds.half_width, bounds.tip, point.at[1], point.at[2]);
        let face = self.row.w / template.half_face;
        let slope = template.form.profile_slope_mm / (template.tip_roll - template.start_roll);
        let removed = removed + template.form.crowning_mm * face * face + slope * (tau - template.start_roll);
        let gap = dot(n, &point.at) - pair.offset + removed;
        let share = share(self.meeting, point.at[1], self.row.weight);
        if gap >= 0.0 || share == 0.0 {
            return None;
        }
        let Motion { normal, moved, hessian } = self.motion();
        let carried = |k: usize, axis: usize| point.motion[k][axis] + by_tau[axis] * moved[k];
        let gradient = std::array::from_fn(|k| {
            dot(&normal, &point.motion[k]) + (by_y * carried(k, 1) + by_z * carried(k, 2) + slope * moved[k])
        });
        let fading = (share < 1.0).then(|| {
            let per_y = -point.at[1].signum() / placed.cos_shaft.abs().max(LEAST);
            std::array::from_fn(|k| per_y * carried(k, 1))
        });
        Some(Element { gap, gradient, hessian, weight: self.row.weight * share, fading })
    }

    /// How the place changes with the coordinates.
    fn motion(&self) -> Motion {
        let Meeting { pair, template, pose, placed, .. } = self.meeting;
        let OnProfile { tau, sin, cos, point, by_tau } = &self.at;
        let (n, r) = (&pair.normal, template.base_radius);
        let (mut normal, mut moved) = (*n, [0.0; 4]);
        let by_angle = placed.direction(pose, -placed.sign * r * tau * cos, -placed.sign * r * tau * sin);
        let by_roll = [0.0, by_tau[2], -by_tau[1]];
        let bend = placed.direction(pose, r * (sin + tau * cos), r * (tau * sin - cos));
        match self.held {
            LowestPoint::RackTip => {
                normal[2] -= dot(n, by_tau) / by_tau[2];
                moved = std::array::from_fn(|k| -point.motion[k][2] / by_tau[2]);
            }
            LowestPoint::ContactLine => {
                let curvature = dot(n, &bend);
                moved[0] = -dot(n, &by_angle) / curvature;
                moved[2] = -dot(n, &by_roll) / curvature;
            }
            LowestPoint::Edge => {}
        }
        let mut hessian = point.hessian(&normal);
        let curvature = dot(&normal, &bend);
        let turned = [dot(&normal, &by_angle), 0.0, dot(&normal, &by_roll), 0.0];
        increase(&mut hessian, |i, j| turned[i] * moved[j] + turned[j] * moved[i] + curvature * moved[i] * moved[j]);
        Motion { normal, moved, hessian }
    }
}

/// How a place of a section changes with the coordinates.
struct Motion {
    /// m.
    normal: [f64; 3],
    /// ∂τ/∂q.
    moved: [f64; 4],
    hessian: [[f64; 4]; 4],
}
