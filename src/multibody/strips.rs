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

use super::bound::{BEND, Bound, Reach, Tip, row_range};
use super::face::{Face, OnFace};
use super::flank::{FlankPair, Placed, Pose, removal};
use super::load::{Element, Load, Sliding};
use super::template::{EARLY, Row, Template};
use crate::deviation::RackForm;
use crate::trig;

/// A point of the profile in section w, with its derivatives by τ.
struct Profile {
    gamma: f64,
    tau: f64,
    by_roll: (f64, f64),
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Adds the contacts of one flank pair.
pub(super) fn touch(
    pair: &FlankPair,
    template: &Template,
    placed: &Placed,
    pose: &Pose,
    reach: &Reach,
    form: &RackForm,
    load: &mut Load<'_>,
) {
    let bound = Bound::new(template, placed, 0.0);
    if reach.cull && bound.clears_flank(template.half_face) {
        return;
    }
    let rows = &template.rows;
    let range = if reach.cull { row_range(template, placed, reach.polar) } else { 0..rows.len() };
    let plain = !reach.rolls && form.is_plain() && template.form.is_plain();
    let line = placed.nu - placed.c;
    let (sin_c, cos_c) = trig::sin_cos(placed.c);
    let tip = Tip::new(template, pair, placed, pose);
    let direct = Direct::new(pair, template, placed, pose, reach.cull);
    let by = [placed.n_zeta, placed.sign * pair.normal[0], 0.0];
    let mut face = Face::new(load, (pair.right, pair.rack_tooth), by);
    for row in &rows[range] {
        if reach.cull && bound.clears(row.w) {
            continue;
        }
        let crossing = line + template.kappa * row.w;
        load.work.counters.spheres_tested += 1;
        if reach.cull && crossing < template.start_roll && crossing >= -EARLY {
            let turned = (sin_c * row.cos - cos_c * row.sin, cos_c * row.cos + sin_c * row.sin);
            if tip.floor(&bound, row.w, crossing, turned).is_none() {
                continue;
            }
        }
        let tau = crossing.clamp(template.start_roll, template.tip_roll);
        if plain && tau == crossing {
            if direct.touch(pair, placed, pose, &bound, row, tau, &mut face, load) {
                continue;
            }
        } else if (tau - crossing).abs() > 1.5 {
            continue;
        }
        section(pair, template, placed, pose, form, (row.w, row.weight), (tau, tau == crossing), load);
    }
    face.close(load);
}

/// Sections that touch on the contact line of plane flanks: their gaps are linear in everything but an eccentricity.
struct Direct {
    /// ξ = r_b (sin ν − τ cos ν), ζ = −r_b (cos ν + τ sin ν).
    sin: f64,
    cos: f64,
    base_radius: f64,
    /// |N_t| r_b (1 − cos 1).
    rise: f64,
    by_angle: f64,
    by_angle_twice: f64,
    top: f64,
    half_width: f64,
    tip: f64,
    cull: bool,
}

impl Direct {
    fn new(pair: &FlankPair, template: &Template, placed: &Placed, pose: &Pose, cull: bool) -> Self {
        let Placed { sign, n_xi, n_zeta, length, eccentric, .. } = *placed;
        Self {
            sin: n_zeta / length,
            cos: n_xi / length,
            base_radius: template.base_radius,
            rise: length * template.base_radius * BEND,
            by_angle: sign * (eccentric.1 * n_xi - eccentric.0 * n_zeta - length * template.base_radius),
            by_angle_twice: -(eccentric.0 * n_xi + eccentric.1 * n_zeta),
            top: pose.at.center_distance + eccentric.1,
            half_width: pair.bounds.half_width,
            tip: pair.bounds.tip,
            cull,
        }
    }

    #[allow(clippy::too_many_arguments)] // one inner step of `touch`
    /// Adds a section's contact if it is one on the contact line; `false` if it may touch elsewhere.
    fn touch(
        &self,
        pair: &FlankPair,
        placed: &Placed,
        pose: &Pose,
        bound: &Bound,
        row: &Row,
        tau: f64,
        face: &mut Face,
        load: &mut Load<'_>,
    ) -> bool {
        let gap = bound.height(row.w);
        let above = self.top - self.base_radius * (self.cos + tau * self.sin) - self.tip;
        if above > 0.0 {
            // only the part below the rack's tip may touch: z falls by at most r_b cos ν (τ² − τ_*²)/2, and the section
            // rises as `Bound` has it
            if self.cos <= 0.0 {
                return false;
            }
            let end = (tau * tau + 2.0 * above / (self.base_radius * self.cos)).sqrt();
            let beyond = (end - tau).min(1.0);
            return self.cull && gap + self.rise * tau * beyond * beyond >= bound.stop;
        }
        let xi = self.base_radius * (self.sin - tau * self.cos) + placed.eccentric.0;
        let y = row.w * placed.cos_shaft - xi * placed.sin_shaft;
        let share = share(self.half_width, y, row.weight, placed);
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
        face.add::<false>(&on, load, || {
            let (x, w) = (self.base_radius * (self.sin - tau * self.cos), row.w);
            let zeta = -self.base_radius * (self.cos + tau * self.sin);
            Sliding { normal: pair.normal, motion: placed.point(pose, x, zeta, w).motion }
        });
        true
    }
}

/// Cosine of the shaft angle that is taken for the least.
const LEAST: f64 = 1e-3;

/// The share of a strip that lies between the rack's end faces.
fn share(half_width: f64, y: f64, width: f64, placed: &Placed) -> f64 {
    let cell = width * placed.cos_shaft.abs().max(LEAST);
    ((half_width - y.abs()) / cell + 0.5).clamp(0.0, 1.0)
}

fn profile(template: &Template, placed: &Placed, w: f64, tau: f64) -> ((f64, f64), Profile) {
    let gamma = placed.c + tau - template.kappa * w;
    let (sin, cos) = trig::sin_cos(gamma);
    let r = template.base_radius;
    let at = (r * (sin - tau * cos), -r * (cos + tau * sin));
    (at, Profile { gamma, tau, by_roll: (r * tau * sin, -r * tau * cos) })
}

#[allow(clippy::too_many_arguments)] // one inner step of `touch`
fn section(
    pair: &FlankPair,
    template: &Template,
    placed: &Placed,
    pose: &Pose,
    form: &RackForm,
    (w, width): (f64, f64),
    (tau, on_line): (f64, bool),
    load: &mut Load<'_>,
) {
    let bounds = pair.bounds;
    let (mut at, mut here) = profile(template, placed, w, tau);
    let mut point = placed.point(pose, at.0, at.1, w);
    let on_rack_tip = point.at[2] > bounds.tip;
    if on_rack_tip {
        // z falls towards the pinion's tip
        let (mut low, mut high, mut tau) = (tau, template.tip_roll, tau);
        let end = profile(template, placed, w, high).0;
        if placed.point(pose, end.0, end.1, w).at[2] >= bounds.tip {
            return;
        }
        for _ in 0..60 {
            let above = point.at[2] - bounds.tip;
            if above > 0.0 {
                low = tau;
            } else {
                high = tau;
            }
            let slope = along(placed, pose, here.by_roll)[2];
            let step = -above / slope;
            let next =
                if slope < 0.0 && tau + step > low && tau + step < high { tau + step } else { 0.5 * (low + high) };
            if (next - tau).abs() <= 1e-15 {
                break;
            }
            tau = next;
            (at, here) = profile(template, placed, w, tau);
            point = placed.point(pose, at.0, at.1, w);
        }
    }
    let n = &pair.normal;
    let by_tau = along(placed, pose, here.by_roll);
    let tau_angle = along(placed, pose, (placed.sign * here.by_roll.1, -placed.sign * here.by_roll.0));
    let tau_roll = [0.0, by_tau[2], -by_tau[1]];
    // m, and ∂τ/∂q
    let mut m = *n;
    let mut moved = [0.0; 4];
    let z = |v: &[f64; 3]| v[2];
    if on_rack_tip {
        let slope = by_tau[2];
        m[2] -= dot(n, &by_tau) / slope;
        moved = std::array::from_fn(|k| -z(&point.motion[k]) / slope);
    } else if on_line && here.tau > 0.0 {
        let (sin, cos) = trig::sin_cos(here.gamma);
        let r = template.base_radius;
        let bend = along(placed, pose, (r * (sin + here.tau * cos), r * (here.tau * sin - cos)));
        let curvature = dot(n, &bend);
        moved[0] = -dot(n, &tau_angle) / curvature;
        moved[2] = -dot(n, &tau_roll) / curvature;
    }
    let (removed, by_y, by_z) = removal(form, bounds.half_width, bounds.tip, point.at[1], point.at[2]);
    let face = w / template.half_face;
    let range = template.tip_roll - template.start_roll;
    let profile_slope = template.form.profile_slope_mm / range;
    let removed = removed + template.form.crowning_mm * face * face + profile_slope * (here.tau - template.start_roll);
    let gap = dot(n, &point.at) - pair.offset + removed;
    if gap >= 0.0 {
        return;
    }
    let share = share(bounds.half_width, point.at[1], width, placed);
    if share == 0.0 {
        return;
    }
    let mut gradient: [f64; 4] = std::array::from_fn(|k| dot(&m, &point.motion[k]));
    for (k, slope) in gradient.iter_mut().enumerate() {
        let carried = |axis: usize| point.motion[k][axis] + by_tau[axis] * moved[k];
        *slope += by_y * carried(1) + by_z * carried(2) + profile_slope * moved[k];
    }
    let mut hessian = [[0.0; 4]; 4];
    let [angle_angle, angle_roll, height_roll, roll_roll] = point.second.map(|v| dot(&m, &v));
    hessian[0][0] = angle_angle;
    (hessian[0][2], hessian[2][0]) = (angle_roll, angle_roll);
    (hessian[1][2], hessian[2][1]) = (height_roll, height_roll);
    hessian[2][2] = roll_roll;
    if on_rack_tip || on_line {
        let (sin, cos) = trig::sin_cos(here.gamma);
        let r = template.base_radius;
        let bend = along(placed, pose, (r * (sin + here.tau * cos), r * (here.tau * sin - cos)));
        let curvature = dot(&m, &bend);
        let turned = [dot(&m, &tau_angle), 0.0, dot(&m, &tau_roll), 0.0];
        for i in 0..4 {
            for j in 0..4 {
                hessian[i][j] += turned[i] * moved[j] + turned[j] * moved[i] + curvature * moved[i] * moved[j];
            }
        }
    }
    let fading = (share < 1.0).then(|| {
        let per_y = -point.at[1].signum() / placed.cos_shaft.abs().max(LEAST);
        std::array::from_fn(|k| per_y * (point.motion[k][1] + by_tau[1] * moved[k]))
    });
    let element = Element { gap, gradient, hessian, weight: width * share, fading };
    load.add(pair.right, pair.rack_tooth, &element, || Sliding { normal: *n, motion: point.motion });
}

/// A transverse direction in rack coordinates.
fn along(placed: &Placed, pose: &Pose, (xi, zeta): (f64, f64)) -> [f64; 3] {
    let (x, y) = (xi * placed.cos_shaft, -xi * placed.sin_shaft);
    [x, y * pose.cos_roll + zeta * pose.sin_roll, -y * pose.sin_roll + zeta * pose.cos_roll]
}
