//! Spheres of the pinion against patches of the rack. Called by the scene for every flank pair of a position.
//!
//! # What is skipped, and why that changes nothing
//! Let D be the height of a sphere's lowest point over the rack flank's plane. The distance of its centre from the
//! patch is at least its height over the plane ([`super::closest`]; form only removes material), so D ≥ 0 is clear.
//! With the roll angle τ_* at which a row crosses the contact line, δ = τ − τ_*, and N_t the normal's part in
//! the pinion's transverse plane, a row has
//!
//! ```text
//! D = const + |N_t| r_b [τ (1 − cos δ) + sin δ − δ] − R(τ) |N_t| cos β_b (1 − cos δ) − R(τ) ε + removed(τ),
//! ```
//!
//! ε = 1 − sin β_b N_w − cos β_b |N_t| ≥ 0 a constant (0 if the lead fits). Let H be D without its last two terms.
//! - δ < 0: H falls with τ, because |sin δ| (r_b τ − R cos β_b) ≥ 0 (R ≤ C τ², C cos β_b τ ≤ r_b) and R' ≥ 0.
//! - δ > 0: dH/dτ = |N_t| [sin δ (r_b τ − R cos β_b) − R' cos β_b (1 − cos δ)]. Where R = R_0 the last term is 0 and
//!   the first not negative; where R = C τ² it is |N_t| τ sin δ [r_b − C cos β_b (τ + 2 tan(δ/2))] ≥ 0 by
//!   the choice of C, as long as δ ≤ τ_a + ½, that is τ_* ≥ −½.
//!
//! So H grows to both sides of τ_*. A walk outwards may stop at the first D ≥ R_0 ε + (max − min of removed), since then
//! every later D ≥ 0. Rows with τ_* < τ_0 − ½ are not walked but gone through.
//!
//! Whole rows and flanks: on the contact line H is L = const, linear in w. Where τ_* ≥ 0 nothing of a row lies lower, so
//! L ≥ R_0 ε + … (the bound above) clears it. For −½ ≤ τ_* < 0 the lowest H is at τ = 0 or later, where the bracket
//! is at least r_b ∫ τ sin(τ − τ_*) dτ from τ_* to 0, which is r_b (sin x − x) ≥ −r_b x³/6 with x = −τ_*; L less
//! |N_t| r_b x³/6 must then reach the bound. That function is concave in w, so a flank is clear if it is at both its
//! ends. A row whose line lies beyond the tip, τ_a < τ_*, has at its lowest node H ≥ L + |N_t| (r_b τ_a − R cos β_b)
//! (1 − cos δ), and 1 − cos δ ≥ (1 − cos 1) min(δ², 1).
//!
//! Rows whose line lies before the profile's start meet the rack above its tip, if at all. A sphere with the lowest point D
//! < 0 touches only if the foot of its centre lies less than m = √(|D| (|D| + 2R)) beyond the patch. That foot
//! is not lower than the flank's point itself, less R (|N_t| − cos β_b) if that is positive, as long as ν ≤ γ ≤ π − ν; and
//! from its height at the start, z_s, the flank falls by at most r_b cos γ_s (τ² − τ_0²)/2. So spheres below the τ at
//! which that reaches the tip's height plus m are clear, with |D| bounded as above; from there H grows.
//!
//! A pinion point at the polar angle χ from straight down lies at Z ≥ a − e − r_a cos χ, e the eccentricity, and
//! no point of the rack is higher than its tip edge; a sphere whose flank point lies 2 R_0 higher than that is clear,
//! because its centre is within R_0 of that point.

use super::closest;
use super::flank::{FlankPair, Patch, Placed, Pose};
use super::load::{Element, Flat, Load, Sliding};
use super::template::{EARLY, Node, Row, Template};
use crate::trig;

/// What the scene knows of all flanks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    pub(super) cull: bool,
    /// Whether the rack's roll is a coordinate.
    pub(super) rolls: bool,
    pub(super) radius: f64,
    /// Polar angle beyond which no pinion point meets the rack.
    pub(super) polar: f64,
}

/// Added to the bound at which a walk stops, mm: rounding of D is a hundredth of it.
const SLACK: f64 = 1e-11;

struct Plane {
    nx: f64,
    ny: f64,
    base: f64,
    axial: f64,
}

impl Plane {
    fn depth(&self, node: &Node) -> f64 {
        node.xi * self.nx + node.zeta * self.ny + node.radius * self.axial + self.base + node.removed
    }
}

/// 1 − cos 1, rounded down.
const BEND: f64 = 0.459_697;

/// What clears whole rows of a flank.
struct Bound {
    stop: f64,
    /// L = level + slope w and τ_* = line + κ w.
    level: f64,
    slope: f64,
    line: f64,
    kappa: f64,
    /// |N_t| r_b / 6 and |N_t| (r_b τ_a − R cos β_b) (1 − cos 1).
    early: f64,
    late: f64,
    tip: f64,
}

impl Bound {
    /// Whether no sphere of the section at w touches, if its contact line is not too early to say.
    fn clears(&self, w: f64) -> bool {
        let crossing = self.line + self.kappa * w;
        let mut height = self.level + self.slope * w;
        if crossing > self.tip {
            let beyond = crossing - self.tip;
            height += self.late * (beyond * beyond).min(1.0);
        } else if crossing < 0.0 {
            if crossing < -EARLY {
                return false;
            }
            height += self.early * crossing * crossing * crossing;
        }
        height >= self.stop
    }
}

/// Adds the contacts of one flank pair.
pub(super) fn touch(
    pair: &FlankPair,
    template: &Template,
    placed: &Placed,
    pose: &Pose,
    reach: &Reach,
    load: &mut Load<'_>,
) {
    let Placed { n_xi, n_zeta, n_w, length, .. } = *placed;
    let axial = template.sin_base * n_w - 1.0;
    let misfit = (-axial - template.cos_base * length).max(0.0);
    let line = placed.nu - placed.c;
    let per_roll = length * template.base_radius;
    let bound = Bound {
        stop: reach.radius * misfit + template.form.profile_slope_mm.abs() + SLACK,
        level: placed.base - per_roll * line,
        slope: n_w - per_roll * template.kappa,
        line,
        kappa: template.kappa,
        early: per_roll / 6.0,
        late: length * template.last_reach.max(0.0) * BEND,
        tip: template.tip_roll,
    };
    // the part beyond the tip is convex, so the flank as a whole is judged without it
    let whole = Bound { late: 0.0, ..bound };
    if reach.cull && whole.clears(-template.half_face) && whole.clears(template.half_face) {
        return;
    }
    let (sin_c, cos_c) = trig::sin_cos(placed.c);
    let rows = &template.rows;
    let range = if reach.cull { row_range(template, placed, reach.polar) } else { 0..rows.len() };
    // what may be taken for plane and level, which most contacts are
    let plain = !reach.rolls && matches!(pair.patch, Patch::Plane);
    let tip = Tip { template, pair, top: pose.at.center_distance + placed.eccentric.1, nu: placed.nu, length };
    for row in &rows[range] {
        if reach.cull && bound.clears(row.w) {
            continue;
        }
        let (sin, cos) = (sin_c * row.cos - cos_c * row.sin, cos_c * row.cos + sin_c * row.sin);
        let plane = Plane {
            nx: n_xi * cos + n_zeta * sin,
            ny: n_zeta * cos - n_xi * sin,
            base: placed.base + row.w * n_w + row.removed,
            axial,
        };
        let (shift, nodes) = &template.phases[row.phase];
        let crossing = line + template.kappa * row.w;
        let (from, to) = if plain && reach.cull && crossing < template.start_roll && crossing >= -EARLY {
            let Some(floor) = tip.floor(&bound, row.w, crossing, (sin, cos)) else { continue };
            climb(nodes, &plane, (floor - template.start_roll) * template.per_step, *shift, bound.stop, load)
        } else if reach.cull && crossing >= template.start_roll - EARLY {
            walk(nodes, &plane, (crossing - template.start_roll) * template.per_step, *shift, bound.stop, load)
        } else {
            load.work.counters.spheres_tested += nodes.len() as u64;
            (0, nodes.len())
        };
        for node in &nodes[from..to] {
            let gap = plane.depth(node);
            if gap >= 0.0 {
                continue;
            }
            let turned = (node.xi * cos - node.zeta * sin, node.xi * sin + node.zeta * cos);
            if plain {
                let (xi, zeta) = (turned.0 + placed.eccentric.0, turned.1 + placed.eccentric.1);
                let w = row.w + node.radius * template.sin_base;
                let (y, z) = (w * placed.cos_shaft - xi * placed.sin_shaft, zeta + pose.at.center_distance);
                // what is left of the radius once the form is removed, and the height of the centre
                let left = node.radius - (row.removed + node.removed);
                let height = gap + left;
                let beyond = pair.beyond(y, z, height);
                if beyond > 0.0 && closest::clear(height, beyond, node.radius, left) {
                    continue;
                }
                if beyond <= 0.0 {
                    let flat = Flat {
                        gap,
                        by_angle: placed.sign * (zeta * n_xi - xi * n_zeta),
                        by_height: n_zeta,
                        by_stroke: placed.sign * pair.normal[0],
                        by_angle_twice: -(xi * n_xi + zeta * n_zeta),
                        weight: row.weight * node.weight,
                    };
                    load.add_flat(pair.right, pair.rack_tooth, &flat, || Sliding {
                        normal: pair.normal,
                        motion: placed.point(pose, turned.0, turned.1, w).motion,
                    });
                    continue;
                }
            }
            sphere(pair, template, placed, pose, row, node, turned, gap, load);
        }
    }
}

/// Stations around the contact line that may touch.
fn walk(nodes: &[Node], plane: &Plane, crossing: f64, shift: f64, stop: f64, load: &mut Load<'_>) -> (usize, usize) {
    let last = nodes.len() - 1;
    // the first station beyond the crossing
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)] // clamped
    let start = if crossing < 0.0 {
        0
    } else if crossing < shift {
        1
    } else {
        ((crossing - shift).min(last as f64) as usize + 2).min(nodes.len())
    };
    #[allow(clippy::cast_precision_loss)]
    let start = if crossing >= (last - 1) as f64 { nodes.len() } else { start.min(last) };
    let mut to = start;
    while to < nodes.len() && plane.depth(&nodes[to]) < stop {
        to += 1;
    }
    let mut from = start;
    while from > 0 && plane.depth(&nodes[from - 1]) < stop {
        from -= 1;
    }
    load.work.counters.spheres_tested += (to - from + 2) as u64;
    (from, to)
}

/// Stations from a height on that may touch; the contact line lies before them all.
fn climb(nodes: &[Node], plane: &Plane, floor: f64, shift: f64, stop: f64, load: &mut Load<'_>) -> (usize, usize) {
    // the last station not above the floor, or one before it
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // not negative, and clamped
    let from = if floor < shift { 0 } else { ((floor - shift) as usize).min(nodes.len() - 1) };
    let mut to = from;
    while to < nodes.len() && plane.depth(&nodes[to]) < stop {
        to += 1;
    }
    load.work.counters.spheres_tested += (to - from + 1) as u64;
    (from, to)
}

/// What the rack's tip leaves of a row whose contact line lies before the profile's start.
struct Tip<'a> {
    template: &'a Template,
    pair: &'a FlankPair,
    /// Height of the tooth system's axis over the rack's reference plane.
    top: f64,
    nu: f64,
    length: f64,
}

impl Tip<'_> {
    /// A roll angle below which no sphere of a row touches; `None` if none at all does.
    fn floor(&self, bound: &Bound, w: f64, crossing: f64, (sin, cos): (f64, f64)) -> Option<f64> {
        let t = self.template;
        let start = t.start_roll;
        if self.nu + (t.tip_roll - crossing) > std::f64::consts::PI - self.nu {
            return Some(start);
        }
        let (sin, cos) = (sin * t.cos_start + cos * t.sin_start, cos * t.cos_start - sin * t.sin_start);
        let early = crossing.min(0.0);
        let deepest = (bound.stop - bound.level - bound.slope * w - bound.early * early * early * early).max(0.0);
        let margin = (deepest * (deepest + 2.0 * t.widest)).sqrt() + SLACK;
        let misfit = t.widest * (self.length - t.cos_base).max(0.0);
        let height = self.top - t.base_radius * (cos + start * sin) - misfit - self.pair.bounds.tip - margin;
        if height <= 0.0 {
            return Some(start);
        }
        let floor = (start * start + 2.0 * height / (t.base_radius * cos)).sqrt();
        // no number if even the end of the profile rises
        (cos > 0.0 && floor <= t.tip_roll).then_some(floor)
    }
}

/// Rows that reach down to the rack's tip.
fn row_range(template: &Template, placed: &Placed, polar: f64) -> std::ops::Range<usize> {
    // a row's centre line lies at the polar angle tooth_angle − sign κ w
    let (rows, angle) = (&template.rows, placed.tooth_angle * placed.sign);
    let widest = polar + template.tooth_reach;
    if template.kappa == 0.0 {
        return if angle.abs() <= widest { 0..rows.len() } else { 0..0 };
    }
    let (one, other) = ((angle - widest) / template.kappa, (angle + widest) / template.kappa);
    let (low, high) = (one.min(other), one.max(other));
    let from = rows.partition_point(|row| row.w < low);
    let to = rows.partition_point(|row| row.w <= high);
    from..to.max(from)
}

#[allow(clippy::too_many_arguments)] // one inner step of `touch`
fn sphere(
    pair: &FlankPair,
    template: &Template,
    placed: &Placed,
    pose: &Pose,
    row: &Row,
    node: &Node,
    (xi, zeta): (f64, f64),
    height: f64,
    load: &mut Load<'_>,
) {
    let point = placed.point(pose, xi, zeta, row.w + node.radius * template.sin_base);
    let removed = row.removed + node.removed;
    let Some(distance) = pair.distance(&point.at, node.radius) else { return };
    let n = &distance.gradient;
    let flat = *n == pair.normal;
    // over a plane's face the height is known already, with one rounding less
    let gap = if flat { height } else { distance.value - node.radius + removed };
    if gap >= 0.0 {
        return;
    }
    let dot = |v: &[f64; 3]| n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
    let gradient: [f64; 4] = std::array::from_fn(|k| dot(&point.motion[k]));
    let mut hessian = [[0.0; 4]; 4];
    let [angle_angle, angle_roll, height_roll, roll_roll] = point.second.map(|v| dot(&v));
    hessian[0][0] = angle_angle;
    (hessian[0][2], hessian[2][0]) = (angle_roll, angle_roll);
    (hessian[1][2], hessian[2][1]) = (height_roll, height_roll);
    hessian[2][2] = roll_roll;
    if !flat {
        for (i, motion) in point.motion.iter().enumerate() {
            let curved: [f64; 3] =
                std::array::from_fn(|axis| (0..3).map(|other| distance.hessian[axis][other] * motion[other]).sum());
            for (j, other) in point.motion.iter().enumerate() {
                hessian[i][j] += curved[0] * other[0] + curved[1] * other[1] + curved[2] * other[2];
            }
        }
    }
    let element = Element { gap, gradient, hessian, weight: row.weight * node.weight };
    load.add(pair.right, pair.rack_tooth, &element, || {
        let length = dot(n).sqrt();
        Sliding { normal: n.map(|v| v / length), motion: point.motion }
    });
}
