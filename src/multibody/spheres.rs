//! Spheres of the pinion against patches of the rack. Called by the scene for every flank pair of a position.
//!
//! What provably cannot touch is skipped: see [`super::bound`].

use super::bound::{Bound, Reach, Tip, row_range};
use super::closest;
use super::face::{Face, OnFace};
use super::flank::{FlankPair, Patch, Placed, Pose};
use super::load::{Element, Load, Sliding};
use super::template::{EARLY, Node, Row, Template};
use crate::trig;

/// A sphere that may touch: below the plane, or near it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    gap: f64,
    /// Of the angle by which its row is turned.
    sin: f64,
    cos: f64,
    row: usize,
    node: usize,
}

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

/// Adds the contacts of one flank pair.
pub(super) fn touch(
    pair: &FlankPair,
    template: &Template,
    placed: &Placed,
    pose: &Pose,
    reach: &Reach,
    load: &mut Load<'_>,
) {
    let Placed { n_xi, n_zeta, n_w, .. } = *placed;
    let axial = template.sin_base * n_w - 1.0;
    let line = placed.nu - placed.c;
    let bound = Bound::new(template, placed, reach.margin);
    if reach.cull && bound.clears_flank(template.half_face) {
        return;
    }
    let (sin_c, cos_c) = trig::sin_cos(placed.c);
    let rows = &template.rows;
    let range = if reach.cull { row_range(template, placed, reach.polar) } else { 0..rows.len() };
    // what may be taken for plane, which most contacts are
    let plain = matches!(pair.patch, Patch::Plane);
    // the rack's normal along Y, and the height of the pinion's axis over that of the roll
    let n_y = n_w * placed.cos_shaft - n_xi * placed.sin_shaft;
    let lift = pose.at.center_distance + pose.depth;
    let tip = Tip::new(template, pair, placed, pose);
    let mut found = std::mem::take(&mut load.work.found);
    found.clear();
    for row_index in range {
        let row = &rows[row_index];
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
        for (index, node) in nodes[from..to].iter().enumerate() {
            let gap = plane.depth(node);
            if gap < 0.0 || gap < reach.margin && plain {
                found.push(Found { gap, sin, cos, row: row_index, node: from + index });
            }
        }
    }
    let [_, ny, nz] = pair.normal;
    let mut face = Face::new(load, (pair.right, pair.rack_tooth), [n_zeta, placed.sign * pair.normal[0], n_y]);
    for &Found { gap, sin, cos, row, node } in &found {
        let row = &rows[row];
        let node = &template.phases[row.phase].1[node];
        let turned = (node.xi * cos - node.zeta * sin, node.xi * sin + node.zeta * cos);
        if plain {
            let (xi, zeta) = (turned.0 + placed.eccentric.0, turned.1 + placed.eccentric.1);
            let w = row.w + node.radius * template.sin_base;
            let across = w * placed.cos_shaft - xi * placed.sin_shaft;
            // from the axis of the roll
            let (y, z) = if reach.rolls {
                let up = zeta + lift;
                (across * pose.cos_roll + up * pose.sin_roll, up * pose.cos_roll - across * pose.sin_roll)
            } else {
                (across, zeta + lift)
            };
            // what is left of the radius once the form is removed, and the height of the centre
            let left = node.radius - (row.removed + node.removed);
            let height = gap + left;
            let beyond = pair.beyond(y, z - pose.depth, height);
            if beyond <= 0.0 {
                let on = OnFace {
                    gap,
                    weight: row.weight * node.weight,
                    by_angle: placed.sign * (zeta * n_xi - xi * n_zeta),
                    by_roll: ny * z - nz * y,
                    by_angle_twice: -(xi * n_xi + zeta * n_zeta),
                    by_angle_roll: placed.sign * (zeta * placed.sin_shaft * n_zeta - xi * n_y),
                    by_roll_twice: -(ny * y + nz * z),
                };
                let sliding = || Sliding {
                    normal: pair.normal,
                    motion: placed.motion_at_contact(pose, (turned.0, turned.1, w), node.radius, &pair.normal),
                };
                if gap >= 0.0 {
                    face.pass(&on, load);
                } else if reach.rolls {
                    face.add::<true>(&on, load, sliding);
                } else {
                    face.add::<false>(&on, load, sliding);
                }
                continue;
            }
            if gap >= 0.0 || closest::clear(height, beyond, node.radius, left) {
                continue;
            }
        }
        sphere(pair, template, placed, pose, row, node, turned, gap, load);
    }
    face.close(load);
    load.work.found = found;
}

/// Stations around the contact line that may touch.
fn walk(nodes: &[Node], plane: &Plane, crossing: f64, shift: f64, stop: f64, load: &mut Load<'_>) -> (usize, usize) {
    let last = nodes.len() - 1;
    // the first station beyond the crossing
    let start = if crossing < 0.0 {
        0
    } else if crossing < shift {
        1
    } else {
        ((crossing - shift).min(last as f64) as usize + 2).min(nodes.len())
    };
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
    let from = if floor < shift { 0 } else { ((floor - shift) as usize).min(nodes.len() - 1) };
    let mut to = from;
    while to < nodes.len() && plane.depth(&nodes[to]) < stop {
        to += 1;
    }
    load.work.counters.spheres_tested += (to - from + 1) as u64;
    (from, to)
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
    let element = Element { gap, gradient, hessian, weight: row.weight * node.weight, fading: None };
    load.add(pair.right, pair.rack_tooth, &element, || {
        let length = dot(n).sqrt();
        let normal = n.map(|v| v / length);
        let center = (xi, zeta, row.w + node.radius * template.sin_base);
        Sliding { normal, motion: placed.motion_at_contact(pose, center, node.radius, &normal) }
    });
}
