//! Spheres of the pinion against patches of the rack. Called by the scene for every flank pair of a position.
//!
//! What provably cannot touch is skipped: see [`super::bound`].

use super::closest;
use super::face::{Face, OnFace};
use super::flank::Patch;
use super::load::{Element, Load, Sliding};
use super::meeting::{Meeting, PlacedRow};
use super::template::{EARLY, Node, Phase, Template};
use crate::linear::{dot, increase};

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
pub(super) fn touch(meeting: &Meeting<'_>, load: &mut Load<'_>) {
    let Meeting { pair, template, reach, placed, bound, .. } = meeting;
    let n_y = placed.n_w * placed.cos_shaft - placed.n_xi * placed.sin_shaft;
    let mut face = Face::new(load, (pair.right, pair.rack_tooth), [placed.n_zeta, placed.sign * pair.normal[0], n_y]);
    let plain = meeting.is_plain();
    let margin = if plain { reach.margin.max(0.0) } else { 0.0 };
    for placed_row in meeting.rows() {
        let PlacedRow { row, crossing, sin, cos } = placed_row;
        let plane = Plane {
            nx: placed.n_xi * cos + placed.n_zeta * sin,
            ny: placed.n_zeta * cos - placed.n_xi * sin,
            base: placed.base + row.w * placed.n_w + row.removed,
            axial: template.sin_base * placed.n_w - 1.0,
        };
        let Phase { shift, nodes } = &template.phases[row.phase];
        let stations = Stations { nodes, shift: *shift, plane: &plane, stop: bound.stop };
        let station = |roll: f64| (roll - template.start_roll) * template.per_step;
        let (from, to) = if plain && meeting.is_early(&placed_row) {
            let Some(floor) = meeting.floor(&placed_row) else { continue };
            stations.climb(station(floor), load)
        } else if reach.cull && crossing >= template.start_roll - EARLY {
            stations.walk(station(crossing), load)
        } else {
            load.work.counters.spheres_tested += nodes.len() as u64;
            (0, nodes.len())
        };
        for node in &nodes[from..to] {
            let gap = plane.depth(node);
            if gap < margin {
                Sphere::new(template, &placed_row, node, gap).touch(meeting, &mut face, load);
            }
        }
    }
    face.close(load);
}

impl Meeting<'_> {
    /// Whether the rack's flank may be taken for plane, which most are.
    fn is_plain(&self) -> bool {
        matches!(self.pair.patch, Patch::Plane)
    }
}

/// The stations of a row against the rack flank's plane.
struct Stations<'a> {
    nodes: &'a [Node],
    shift: f64,
    plane: &'a Plane,
    /// Height from which on all stations further out are clear.
    stop: f64,
}

impl Stations<'_> {
    /// Those around the contact line that may touch.
    fn walk(&self, crossing: f64, load: &mut Load<'_>) -> (usize, usize) {
        let Self { nodes, shift, .. } = *self;
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
        let to = self.first_clear(start);
        let mut from = start;
        while from > 0 && self.plane.depth(&nodes[from - 1]) < self.stop {
            from -= 1;
        }
        load.work.counters.spheres_tested += (to - from + 2) as u64;
        (from, to)
    }

    /// Those from a height on that may touch; the contact line lies before them all.
    fn climb(&self, floor: f64, load: &mut Load<'_>) -> (usize, usize) {
        // the last station not above the floor, or one before it
        let from = if floor < self.shift { 0 } else { ((floor - self.shift) as usize).min(self.nodes.len() - 1) };
        let to = self.first_clear(from);
        load.work.counters.spheres_tested += (to - from + 1) as u64;
        (from, to)
    }

    fn first_clear(&self, from: usize) -> usize {
        let mut to = from;
        while to < self.nodes.len() && self.plane.depth(&self.nodes[to]) < self.stop {
            to += 1;
        }
        to
    }
}

/// A sphere in a position.
struct Sphere {
    /// Height of its lowest point over the rack flank's plane.
    gap: f64,
    radius: f64,
    /// Removed by the pinion's form, mm.
    removed: f64,
    weight: f64,
    /// Its centre's ξ, ζ (from the axis of the tooth system) and w.
    center: [f64; 3],
}

impl Sphere {
    fn new(template: &Template, placed: &PlacedRow<'_>, node: &Node, gap: f64) -> Self {
        let &PlacedRow { row, sin, cos, .. } = placed;
        Self {
            gap,
            radius: node.radius,
            removed: row.removed + node.removed,
            weight: row.weight * node.weight,
            center: [
                node.xi * cos - node.zeta * sin,
                node.xi * sin + node.zeta * cos,
                row.w + node.radius * template.sin_base,
            ],
        }
    }

    /// Adds the contact.
    fn touch(&self, meeting: &Meeting<'_>, face: &mut Face, load: &mut Load<'_>) {
        if !self.touch_plane(meeting, face, load) {
            self.touch_patch(meeting, load);
        }
    }

    /// Adds the contact with a plane face; `false` if the sphere may touch elsewhere.
    fn touch_plane(&self, meeting: &Meeting<'_>, face: &mut Face, load: &mut Load<'_>) -> bool {
        let Meeting { pair, pose, placed, .. } = meeting;
        if !meeting.is_plain() {
            return false;
        }
        let [xi, zeta, w] = self.center;
        let (xi, zeta) = (xi + placed.eccentric.0, zeta + placed.eccentric.1);
        let across = w * placed.cos_shaft - xi * placed.sin_shaft;
        // from the axis of the roll
        let up = zeta + (pose.at.center_distance + pose.shared.depth);
        let (y, z) = (across * pose.cos_roll + up * pose.sin_roll, up * pose.cos_roll - across * pose.sin_roll);
        // what is left of the radius once the form is removed, and the height of the centre
        let left = self.radius - self.removed;
        let height = self.gap + left;
        let beyond = pair.beyond(y, z - pose.shared.depth, height);
        if beyond > 0.0 {
            return self.gap >= 0.0 || closest::clear(height, beyond, self.radius, left);
        }
        let [_, ny, nz] = pair.normal;
        // the rack's normal in the pinion's frame, and its part along Y
        let (n_xi, n_zeta) = (placed.n_xi, placed.n_zeta);
        let n_y = placed.n_w * placed.cos_shaft - n_xi * placed.sin_shaft;
        let on = OnFace {
            gap: self.gap,
            weight: self.weight,
            by_angle: placed.sign * (zeta * n_xi - xi * n_zeta),
            by_roll: ny * z - nz * y,
            by_angle_twice: -(xi * n_xi + zeta * n_zeta),
            by_angle_roll: placed.sign * (zeta * placed.sin_shaft * n_zeta - xi * n_y),
            by_roll_twice: -(ny * y + nz * z),
        };
        if self.gap >= 0.0 {
            face.pass(&on, load);
        } else {
            face.add(&on, load, || self.sliding(meeting, pair.normal));
        }
        true
    }

    /// Adds the contact with the rack's flank as it is, edges and form included.
    fn touch_patch(&self, meeting: &Meeting<'_>, load: &mut Load<'_>) {
        let Meeting { pair, pose, placed, .. } = meeting;
        let [xi, zeta, w] = self.center;
        let point = placed.point(pose, xi, zeta, w);
        let Some(distance) = pair.distance(&point.at, self.radius) else { return };
        let n = &distance.gradient;
        let flat = *n == pair.normal;
        // over a plane's face the height is known already, with one rounding less
        let gap = if flat { self.gap } else { distance.value - self.radius + self.removed };
        if gap >= 0.0 {
            return;
        }
        let gradient: [f64; 4] = std::array::from_fn(|k| dot(n, &point.motion[k]));
        let mut hessian = point.hessian(n);
        if !flat {
            let curved = point.motion.map(|motion| distance.hessian.map(|row| dot(&row, &motion)));
            increase(&mut hessian, |i, j| dot(&curved[i], &point.motion[j]));
        }
        let element = Element { gap, gradient, hessian, weight: self.weight, fading: None };
        load.add(pair.right, pair.rack_tooth, &element, || {
            let length = dot(n, n).sqrt();
            self.sliding(meeting, n.map(|v| v / length))
        });
    }

    fn sliding(&self, meeting: &Meeting<'_>, normal: [f64; 3]) -> Sliding {
        let motion = meeting.placed.motion_at_contact(meeting.pose, self.center, self.radius, &normal);
        Sliding { normal, motion }
    }
}
