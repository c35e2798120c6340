//! An independent solution by brute force: the rack as a height field, each pinion flank maximised over the whole
//! patch.
//!
//! It shares with the library only the input data (`Pair`, and where each flank is). Nothing is known here of
//! generators, contact lines or derivatives: a point of the flank is computed from its radius and its place along
//! the axis, its demand is the height of the rack under it less its own height, and the largest demand is found by a
//! grid and golden sections in both directions.

use rackmesh::deviation::{PinionFlanks, RackFlanks, RackTooth};
use rackmesh::gear::Pair;
use rackmesh::trig;

pub struct Brute<'a> {
    pub pair: &'a Pair,
    pub rack: &'a RackFlanks,
    pub pinion: &'a PinionFlanks,
    pub roll: Roll,
}

/// The rack turned about an axis along X, at Y = 0 and `depth` below its reference plane. Which points of the pinion
/// lie over its face then depends on the centre distance, for which one is assumed.
#[derive(Clone, Copy, Default)]
pub struct Roll {
    pub angle: f64,
    pub depth: f64,
    pub assumed: f64,
}

fn golden(mut a: f64, mut b: f64, f: &mut dyn FnMut(f64) -> f64, rounds: usize) -> f64 {
    let g = 0.618_033_988_749_894_9;
    let mut best = f(a).max(f(b));
    let (mut x, mut y) = (b - g * (b - a), a + g * (b - a));
    let (mut fx, mut fy) = (f(x), f(y));
    for _ in 0..rounds {
        best = best.max(fx).max(fy);
        if fx > fy {
            b = y;
            y = x;
            fy = fx;
            x = b - g * (b - a);
            fx = f(x);
        } else {
            a = x;
            x = y;
            fx = fy;
            y = a + g * (b - a);
            fy = f(y);
        }
    }
    best.max(fx).max(fy)
}

/// Grid, then golden section around its best point.
fn maximum(lo: f64, hi: f64, cells: usize, rounds: usize, f: &mut dyn FnMut(f64) -> f64) -> f64 {
    let at = |i: usize| lo + (hi - lo) * i as f64 / cells as f64;
    let values: Vec<f64> = (0..=cells).map(|i| f(at(i))).collect();
    let top = (0..=cells).max_by(|&i, &j| values[i].total_cmp(&values[j])).unwrap();
    if values[top] < -1e8 {
        return values[top];
    }
    golden(at(top.saturating_sub(1)), at((top + 1).min(cells)), f, rounds).max(values[top])
}

impl Brute<'_> {
    /// What the rack's solid tooth asks of a point of the pinion at (x, y, z), y within the face; `y_rack` is measured
    /// in the rolled rack. The pinion's surface stands back by `removed`, along the flank's normal.
    fn demand_of(&self, tooth: &RackTooth, centre: f64, [x, y, z]: [f64; 3], y_rack: f64, removed: f64) -> f64 {
        let rack = self.pair.rack();
        let half = rack.tooth_thickness_mm / 2.0 / trig::cos(rack.helix_angle_rad);
        let tan_n = trig::tan(self.pair.normal_pressure_angle_rad());
        let sin_n = trig::sin(self.pair.normal_pressure_angle_rad());
        let (s, c, depth) = (trig::sin(self.roll.angle), trig::cos(self.roll.angle), self.roll.depth);
        let form = self.rack.form();
        // a plane z' = level − along·x − across·y' of the rack, where (y', z') is (y, z) turned back about the axis
        let turned = |level: f64, along: f64, across: f64| {
            (level + depth - along * x + y * (s - across * c)) / (c + across * s) - depth
        };
        let plane = |side: f64, flank: rackmesh::deviation::RackFlank| {
            let beta = rack.helix_angle_rad + flank.lead_rad;
            // distance outward from the flank's own line at Z = 0, in the normal plane: (x − foot) cos β − y' sin β
            let foot = centre + side * half + flank.along_x_mm;
            let per_out = side / tan_n;
            let along = per_out * trig::cos(beta);
            let across = -per_out * trig::sin(beta);
            let level = flank.along_z_mm + along * foot;
            let mut removed = removed + form.crowning_mm * (2.0 * y_rack / rack.face_width_mm).powi(2);
            if form.tip_relief_mm > 0.0 {
                // the height z' of the plane over the point's place (x, y') in the rack
                let height = level - along * x - across * y_rack;
                let share = (height - form.tip_relief_start_mm) / (rack.addendum_mm - form.tip_relief_start_mm);
                removed += form.tip_relief_mm * share.max(0.0);
            }
            turned(level - removed / sin_n, along, across)
        };
        let tip = turned(rack.addendum_mm - removed * sin_n, 0.0, 0.0);
        plane(1.0, tooth.right).min(plane(-1.0, tooth.left)).min(tip) - z
    }

    /// Material removed from a pinion flank.
    fn removed(&self, roll: f64, w: f64) -> f64 {
        let (p, form) = (self.pair.pinion(), self.pinion.form());
        let share = (roll - p.start_roll_rad) / (p.tip_roll_rad - p.start_roll_rad);
        let crown = form.crowning_mm * (2.0 * w / p.face_width_mm).powi(2);
        crown + form.profile_slope_mm * share
    }

    /// A point of a pinion flank, relative to the axis, in rack coordinates. `side` +1 right, −1 left.
    fn point(&self, tooth: i64, side: f64, angle: f64, radius: f64, w: f64) -> [f64; 3] {
        let p = self.pair.pinion();
        let j = tooth.rem_euclid(i64::from(p.teeth)) as usize;
        let flank = if side > 0.0 { self.pinion.teeth()[j].right } else { self.pinion.teeth()[j].left };
        let alpha = trig::acos((p.base_radius_mm / radius).min(1.0));
        let inv = trig::tan(alpha) - alpha;
        let phi = angle + side * (p.base_half_angle_rad - inv) + flank.arc_mm / p.reference_radius_mm
            - w * trig::tan(p.helix_angle_rad + flank.lead_rad) / p.reference_radius_mm;
        let pitch = std::f64::consts::TAU / f64::from(p.teeth);
        let zero = angle - j as f64 * pitch;
        let (e, f) = self.pinion.eccentricity_mm();
        let across = radius * trig::sin(phi) + e * trig::sin(zero) + f * trig::cos(zero);
        let up = -radius * trig::cos(phi) - e * trig::cos(zero) + f * trig::sin(zero);
        let sigma = self.pair.shaft_angle_rad();
        let (s, c) = (trig::sin(sigma), trig::cos(sigma));
        [across * c + w * s, -across * s + w * c, up]
    }

    /// Largest demand of one pinion flank on one rack tooth; `rough` only from the grid.
    fn flank(&self, rack_tooth: i64, centre: f64, tooth: i64, side: f64, angle: f64, rough: bool) -> f64 {
        let p = self.pair.pinion();
        let (b, k) = (p.face_width_mm / 2.0, self.pair.rack().face_width_mm / 2.0);
        let deviation = self.rack.tooth(rack_tooth);
        let along = |radius: f64| {
            let (s, c) = (trig::sin(self.roll.angle), trig::cos(self.roll.angle));
            let roll = ((radius / p.base_radius_mm).powi(2) - 1.0).max(0.0).sqrt();
            let across = |y: f64, z: f64| y * c + s * (self.roll.assumed + z + self.roll.depth);
            let y = |w: f64| {
                let [_, y, z] = self.point(tooth, side, angle, radius, w);
                across(y, z)
            };
            // y is monotone in w for every geometry tried here; find where it leaves the face
            let (y0, y1) = (y(-b), y(b));
            let edge = |target: f64| {
                let (mut lo, mut hi) = (-b, b);
                for _ in 0..60 {
                    let mid = 0.5 * (lo + hi);
                    if (y(mid) < target) == (y0 < y1) { lo = mid } else { hi = mid }
                }
                0.5 * (lo + hi)
            };
            if y0.max(y1) < -k || y0.min(y1) > k {
                return -1e9 - (y0.abs().min(y1.abs()) - k);
            }
            let (low, high) = (y0.min(y1), y0.max(y1));
            let mut ends = (
                if low < -k {
                    edge(-k)
                } else if y0 < y1 {
                    -b
                } else {
                    b
                },
                if high > k {
                    edge(k)
                } else if y0 < y1 {
                    b
                } else {
                    -b
                },
            );
            if ends.0 > ends.1 {
                ends = (ends.1, ends.0);
            }
            let mut demand = |w: f64| {
                let [x, y, z] = self.point(tooth, side, angle, radius, w);
                self.demand_of(&deviation, centre, [x, y, z], across(y, z), self.removed(roll, w))
            };
            if rough {
                maximum(ends.0, ends.1, 6, 0, &mut demand)
            } else {
                maximum(ends.0, ends.1, 10, 42, &mut demand)
            }
        };
        let cells = if rough { 10 } else { 24 };
        // equal steps in roll angle, so that the start of the involute is not starved
        let (t0, t1) = (p.start_roll_rad, p.tip_roll_rad);
        let mut by_roll = |t: f64| along(p.base_radius_mm * (1.0 + t * t).sqrt());
        maximum(t0, t1, cells, if rough { 0 } else { 42 }, &mut by_roll)
    }

    /// The largest demand of all left (−1) or right (+1) pinion flanks with the pinion at `offset` from its nominal
    /// angle.
    pub fn demand(&self, stroke: f64, side: f64, offset: f64, rack_teeth: &[i64]) -> f64 {
        let (rack, p) = (self.pair.rack(), self.pair.pinion());
        let pitch = std::f64::consts::TAU / f64::from(p.teeth);
        let mut rough = Vec::new();
        for &i in rack_teeth {
            let centre = i as f64 * rack.pitch_mm - stroke;
            for j in [i - 1, i] {
                let angle = (j as f64 + 0.5) * pitch - stroke * pitch / rack.pitch_mm + offset;
                rough.push((self.flank(i, centre, j, side, angle, true), i, centre, j, angle));
            }
        }
        rough.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut best = f64::NEG_INFINITY;
        for &(value, i, centre, j, angle) in &rough {
            // the grid is far finer than a module of height
            if value > best - 0.6 * self.pair.normal_module_mm() {
                best = best.max(self.flank(i, centre, j, side, angle, false));
            }
        }
        best
    }

    /// a(s), by regula falsi on the two sides' difference; `None` if a side has no contact.
    pub fn center_distance(&self, stroke: f64, rack_teeth: &[i64], start: f64) -> Option<f64> {
        let p = self.pair.pinion();
        let sides = |offset: f64| {
            let l = self.demand(stroke, -1.0, offset, rack_teeth);
            let r = self.demand(stroke, 1.0, offset, rack_teeth);
            (l, r)
        };
        let span = 0.02 * std::f64::consts::TAU / f64::from(p.teeth);
        let (mut a, mut b) = (start - span, start + span);
        let difference = |(l, r): (f64, f64)| l - r;
        let (mut fa, mut fb) = (difference(sides(a)), difference(sides(b)));
        for _ in 0..6 {
            if fa > 0.0 && fb < 0.0 {
                break;
            }
            (a, b) = (a - 2.0 * (b - a), b + 2.0 * (b - a));
            (fa, fb) = (difference(sides(a)), difference(sides(b)));
        }
        if !(fa > 0.0 && fb < 0.0) {
            return None;
        }
        let mut last = 0;
        for _ in 0..400 {
            let x = (a * fb - b * fa) / (fb - fa);
            let at = sides(x);
            let f = difference(at);
            if f.abs() < 2e-10 || b - a < 1e-15 {
                let best = at.0.max(at.1);
                return (best > -1e8).then_some(best - 0.5 * f.abs());
            }
            if f > 0.0 {
                (a, fa) = (x, f);
                if last == 1 {
                    fb *= 0.5;
                }
                last = 1;
            } else {
                (b, fb) = (x, f);
                if last == -1 {
                    fa *= 0.5;
                }
                last = -1;
            }
        }
        panic!("the brute force did not converge at stroke {stroke}");
    }
}
