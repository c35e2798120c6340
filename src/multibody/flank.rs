//! One rack flank with the pinion flank that meets it, and where both are in a position. The scene makes it once per rack
//! tooth, both contact models read it.
//!
//! Everything is written for a right flank of the rack and a left one of the pinion; the other side is the mirror image
//! in X (`sign` = −1), under which the roll about X stays. Rack coordinates are local: X from the tooth's
//! nominal centre.

use super::Coordinates;
use super::closest::{self, Distance};
use crate::deviation::RackForm;
use crate::linear::dot;
use crate::trig;

/// A rack flank's surface: a plane polygon, or a grid of triangles.
#[derive(Debug, Clone)]
pub(super) enum Patch {
    Plane,
    Grid { cells: usize, corners: Vec<[f64; 3]> },
}

/// A flank pair.
#[derive(Debug, Clone)]
pub(super) struct FlankPair {
    pub(super) right: bool,
    pub(super) sign: f64,
    pub(super) rack_tooth: i64,
    /// Number of the pinion's tooth, counted on over turns.
    pub(super) pinion_tooth: i64,
    /// The rack plane's outward normal and its distance from the local origin.
    pub(super) normal: [f64; 3],
    pub(super) offset: f64,
    /// The flank's start angle less its tooth's.
    pub(super) start: f64,
    /// Angle ν and length of the normal's part in the pinion's transverse plane while the rack is not rolled.
    pub(super) level: (f64, f64),
    /// Which template the pinion's flank has.
    pub(super) template: usize,
    pub(super) bounds: Bounds,
    /// Corners of the plane flank, counterclockwise.
    pub(super) corners: [[f64; 3]; 4],
    pub(super) patch: Patch,
}

/// Where rack flanks end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub(super) half_width: f64,
    pub(super) tip: f64,
    pub(super) bottom: f64,
    /// Beyond this distance from a patch's edge nothing touches, mm, added to the sphere's radius.
    pub(super) reach: f64,
}

/// A position, with everything that flanks share.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pose {
    pub(super) at: Coordinates,
    pub(super) sin_roll: f64,
    pub(super) cos_roll: f64,
    /// The pinion's tooth system against its axis, across and up.
    pub(super) eccentric: (f64, f64),
    pub(super) shared: SceneGeometry,
}

/// A flank pair in a position.
#[derive(Debug, Clone, Copy)]
pub(super) struct FlankPosition {
    pub(super) sign: f64,
    /// Angle of the pinion tooth.
    pub(super) tooth_angle: f64,
    /// Angle of the flank's start at mid-width.
    pub(super) c: f64,
    pub(super) sin_shaft: f64,
    pub(super) cos_shaft: f64,
    /// The rack's normal along ξ, ζ and w.
    pub(super) n_xi: f64,
    pub(super) n_zeta: f64,
    pub(super) n_w: f64,
    /// Angle ν and length of (ξ, ζ) of the normal.
    pub(super) nu: f64,
    pub(super) length: f64,
    /// The part of a point's gap that does not depend on the point.
    pub(super) base: f64,
    pub(super) eccentric: (f64, f64),
    /// X of the tooth's nominal centre, mirrored.
    pub(super) place: f64,
}

impl FlankPair {
    pub(super) fn place(&self, pose: &Pose) -> FlankPosition {
        let Pose { at, sin_roll, cos_roll, shared, .. } = pose;
        let (sign, depth) = (self.sign, shared.depth);
        let (tooth, partner) = (self.rack_tooth as f64, self.pinion_tooth as f64);
        let tooth_angle = (partner + 0.5) * shared.angular_pitch - at.pinion_angle;
        let place = sign * (tooth * shared.pitch - at.stroke);
        let [nx, ny, nz] = self.normal;
        let (gy, gz) = (ny * cos_roll - nz * sin_roll, ny * sin_roll + nz * cos_roll);
        let (sin_shaft, cos_shaft) = (sign * shared.sin_shaft, shared.cos_shaft);
        let n_xi = nx * cos_shaft - gy * sin_shaft;
        let eccentric = (sign * pose.eccentric.0, pose.eccentric.1);
        let (nu, length) = if *sin_roll == 0.0 { self.level } else { transverse(n_xi, gz) };
        FlankPosition {
            sign,
            tooth_angle,
            c: sign * tooth_angle + self.start,
            sin_shaft,
            cos_shaft,
            n_xi,
            n_zeta: gz,
            n_w: nx * sin_shaft + gy * cos_shaft,
            nu,
            length,
            base: at.center_distance * gz + eccentric.0 * n_xi + eccentric.1 * gz + depth * (gz - nz)
                - nx * place
                - self.offset,
            eccentric,
            place,
        }
    }

    /// The flank's triangles where it has form; the amounts are removed along the normal.
    pub(super) fn shape(&mut self, form: &RackForm, cells: u32) {
        if form.is_plain() {
            return;
        }
        let n = cells as usize;
        let Bounds { half_width, tip, bottom, .. } = self.bounds;
        let mut corners = Vec::with_capacity((n + 1) * (n + 1));
        for j in 0..=n {
            let z = bottom + (tip - bottom) * j as f64 / n as f64;
            for i in 0..=n {
                let y = half_width * (2.0 * i as f64 / n as f64 - 1.0);
                let removed = removal(form, half_width, tip, y, z).0;
                let [nx, ny, nz] = self.normal;
                let x = (self.offset - ny * y - nz * z) / nx;
                corners.push([x - nx * removed, y - ny * removed, z - nz * removed]);
            }
        }
        self.patch = Patch::Grid { cells: n, corners };
    }

    /// How far the foot of a point lies beyond a plane flank, at least; not positive inside, where the point's height
    /// is its distance.
    pub(super) fn beyond(&self, y: f64, z: f64, height: f64) -> f64 {
        let Bounds { half_width, tip, bottom, .. } = self.bounds;
        let (y, z) = (y - height * self.normal[1], z - height * self.normal[2]);
        (y.abs() - half_width).max(z - tip).max(bottom - z)
    }

    /// Distance of a sphere's centre, in local rack coordinates, from this flank.
    pub(super) fn distance(&self, center: &[f64; 3], radius: f64) -> Option<Distance> {
        let Bounds { half_width, tip, bottom, reach } = self.bounds;
        let reach = reach + radius;
        let n = &self.normal;
        let height = n[0] * center[0] + n[1] * center[1] + n[2] * center[2] - self.offset;
        let (y, z) = (center[1] - height * n[1], center[2] - height * n[2]);
        if y.abs() - half_width > reach || z - tip > reach || bottom - z > reach {
            return None;
        }
        match &self.patch {
            Patch::Plane => {
                if y.abs() <= half_width && z <= tip && z >= bottom {
                    return Some(Distance { value: height, gradient: *n, hessian: [[0.0; 3]; 3] });
                }
                closest::polygon(&self.corners, n, center, radius, reach)
            }
            Patch::Grid { cells, corners } => {
                // the surface is convex, so the nearest triangle lies beside the foot point; the amounts removed tilt
                // it by far less than a cell
                let count = *cells as f64;
                let column = |share: f64| {
                    let cell = (share * count).clamp(0.0, count - 1.0) as usize;
                    cell.saturating_sub(1)..=(cell + 1).min(cells - 1)
                };
                let mut best: Option<Distance> = None;
                for j in column((z - bottom) / (tip - bottom)) {
                    for i in column(0.5 + 0.5 * y / half_width) {
                        let first = j * (cells + 1) + i;
                        let quad = [first, first + 1, first + cells + 2, first + cells + 1].map(|k| corners[k]);
                        for triangle in [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]] {
                            let normal = closest::normal(&triangle);
                            if let Some(found) = closest::polygon(&triangle, &normal, center, radius, reach)
                                && best.is_none_or(|best| found.value < best.value)
                            {
                                best = Some(found);
                            }
                        }
                    }
                }
                best
            }
        }
    }
}

/// Angle and length of a normal's part in the transverse plane.
pub(super) fn transverse(n_xi: f64, n_zeta: f64) -> (f64, f64) {
    (trig::atan2(n_zeta, n_xi), (n_xi * n_xi + n_zeta * n_zeta).sqrt())
}

/// What a rack's form removes at a place of its flank, and the derivatives by y and z.
pub(super) fn removal(form: &RackForm, half_width: f64, tip: f64, y: f64, z: f64) -> (f64, f64, f64) {
    let share = y / half_width;
    let crowned = form.crowning_mm * share * share;
    let per_height = form.tip_relief_mm / (tip - form.tip_relief_start_mm);
    let relief = if z > form.tip_relief_start_mm && form.tip_relief_mm != 0.0 { per_height } else { 0.0 };
    (crowned + relief * (z - form.tip_relief_start_mm), 2.0 * form.crowning_mm * share / half_width, relief)
}

/// A point of the pinion in local rack coordinates, with its derivatives by ψ, a, φ and s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) at: [f64; 3],
    pub(super) motion: [[f64; 3]; 4],
    /// Second derivatives by ψψ, ψφ, aφ, φφ; all others are 0.
    second: [[f64; 3]; 4],
}

impl Point {
    /// Second derivatives of the point's way along a direction.
    pub(super) fn hessian(&self, along: &[f64; 3]) -> [[f64; 4]; 4] {
        let [angle_angle, angle_roll, height_roll, roll_roll] = self.second.map(|v| dot(along, &v));
        [
            [angle_angle, 0.0, angle_roll, 0.0],
            [0.0, 0.0, height_roll, 0.0],
            [angle_roll, height_roll, roll_roll, 0.0],
            [0.0; 4],
        ]
    }
}

impl FlankPosition {
    /// Maps a point given by ξ, ζ (from the axis of the tooth system) and w.
    pub(super) fn point(&self, pose: &Pose, xi: f64, zeta: f64, w: f64) -> Point {
        let (xi, zeta) = (xi + self.eccentric.0, zeta + self.eccentric.1);
        let (sin, cos) = (self.sin_shaft, self.cos_shaft);
        let turn = |v: [f64; 3]| [0.0, v[2], -v[1]];
        let lifted = pose.unrolled([
            xi * cos + w * sin - self.place,
            -xi * sin + w * cos,
            pose.at.center_distance + zeta + pose.shared.depth,
        ]);
        let by_angle = self.direction(pose, self.sign * zeta, -self.sign * xi);
        let by_height = pose.unrolled([0.0, 0.0, 1.0]);
        let by_roll = turn(lifted);
        Point {
            at: [lifted[0], lifted[1], lifted[2] - pose.shared.depth],
            motion: [by_angle, by_height, by_roll, [self.sign, 0.0, 0.0]],
            second: [self.direction(pose, -xi, -zeta), turn(by_angle), turn(by_height), turn(by_roll)],
        }
    }

    /// A direction in the pinion's transverse plane, in rack coordinates.
    pub(super) fn direction(&self, pose: &Pose, xi: f64, zeta: f64) -> [f64; 3] {
        pose.unrolled([xi * self.cos_shaft, -xi * self.sin_shaft, zeta])
    }

    /// How the pinion's point moves at which a sphere around ξ, ζ, w touches along the rack's unit normal: friction
    /// acts there, not in the centre.
    pub(super) fn motion_at_contact(
        &self,
        pose: &Pose,
        [xi, zeta, w]: [f64; 3],
        radius: f64,
        normal: &[f64; 3],
    ) -> [[f64; 3]; 4] {
        let [nx, ny, nz] = *normal;
        let (gy, gz) = (ny * pose.cos_roll - nz * pose.sin_roll, ny * pose.sin_roll + nz * pose.cos_roll);
        let along = nx * self.cos_shaft - gy * self.sin_shaft;
        let across = nx * self.sin_shaft + gy * self.cos_shaft;
        self.point(pose, xi - radius * along, zeta - radius * gz, w - radius * across).motion
    }
}

impl Pose {
    /// A direction on the ground as the rack has it that is rolled.
    fn unrolled(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = (self.sin_roll, self.cos_roll);
        [x, y * cos + z * sin, -y * sin + z * cos]
    }

    pub(super) fn new(at: Coordinates, shared: SceneGeometry) -> Self {
        let (sin_roll, cos_roll) = if at.roll == 0.0 { (0.0, 1.0) } else { trig::sin_cos(at.roll) };
        let (along, across) = shared.eccentricity;
        let eccentric = if (along, across) == (0.0, 0.0) {
            (0.0, 0.0)
        } else {
            let (sin, cos) = trig::sin_cos(0.5 * shared.angular_pitch - at.pinion_angle);
            (along * sin + across * cos, across * sin - along * cos)
        };
        Self { at, sin_roll, cos_roll, eccentric, shared }
    }
}

/// What all flank pairs of a scene share.
#[derive(Debug, Clone, Copy)]
pub(super) struct SceneGeometry {
    pub(super) pitch: f64,
    pub(super) angular_pitch: f64,
    pub(super) sin_shaft: f64,
    pub(super) cos_shaft: f64,
    /// How far the roll axis lies below the reference plane.
    pub(super) depth: f64,
    /// Of the pinion, towards tooth 0 and across.
    pub(super) eccentricity: (f64, f64),
}
