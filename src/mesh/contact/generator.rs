//! The largest demand on one generator, in closed form: what bounds the generator, and what the planes ask for along it.

use super::form::OnGenerator;
use super::{ContactKind, FlankContact, Plane, Pose, Surface};
use crate::trig;

/// The demand of one generator.
#[derive(Debug, Clone, Copy)]
pub(super) enum Generator {
    /// The generator has points over the rack tooth. With form, `rival` is what the end of it that is farther away asks for.
    Some { demand: f64, slope: f64, rate: f64, w: f64, kind: ContactKind, surface: Surface, rival: f64 },
    /// The generator has no such points: the bounds on w miss each other by `gap` < 0, which changes with δ by `slope` and with
    /// c by `rate`.
    None { gap: f64, slope: f64, rate: f64 },
}

/// Bounds on w may miss each other by this share of the face width and still count as meeting: the vertex of a
/// patch is a point, and rounding must not lose it.
pub(super) const VERTEX: f64 = 1e-13;

/// What bounds w on a generator, with its derivatives by δ and c.
#[derive(Clone, Copy)]
pub(super) struct Bound {
    pub(super) w: f64,
    pub(super) slope: f64,
    pub(super) rate: f64,
    pub(super) kind: ContactKind,
}

/// A linear function of w on the generator at δ, with its derivatives by δ and c.
#[derive(Clone, Copy)]
pub(super) struct Line {
    pub(super) p: f64,
    pub(super) q: f64,
    pub(super) p_slope: f64,
    pub(super) q_slope: f64,
    pub(super) p_rate: f64,
}

impl Line {
    pub(super) fn at(&self, w: f64) -> f64 {
        self.p + self.q * w
    }
    pub(super) fn slope_at(&self, w: f64) -> f64 {
        self.p_slope + self.q_slope * w
    }
}

/// Coordinates on a generator.
pub(super) struct Coordinates {
    pub(super) t0: f64,
    pub(super) xi: Line,
    pub(super) zeta: Line,
}

impl FlankContact {
    pub(super) fn coordinates(&self, pose: &Pose, delta: f64) -> Coordinates {
        let (sin_d, cos_d) = trig::sin_cos(delta);
        let sin = sin_d * self.cos_nu + cos_d * self.sin_nu;
        let cos = cos_d * self.cos_nu - sin_d * self.sin_nu;
        let r = self.base_radius;
        let t0 = (self.nu - pose.c) + delta;
        let rk = r * self.kappa;
        Coordinates {
            t0,
            xi: Line {
                p: r * (sin - t0 * cos) + pose.offset.0,
                q: -rk * cos,
                p_slope: r * t0 * sin,
                q_slope: rk * sin,
                p_rate: r * cos + pose.offset_rate.0,
            },
            zeta: Line {
                p: -r * (cos + t0 * sin) + pose.offset.1,
                q: -rk * sin,
                p_slope: -r * t0 * cos,
                q_slope: -rk * cos,
                p_rate: r * sin + pose.offset_rate.1,
            },
        }
    }

    pub(super) fn plane(plane: &Plane, shift: f64, at: &Coordinates) -> Line {
        let Coordinates { xi, zeta, .. } = at;
        Line {
            p: plane.d + shift - plane.t * xi.p - zeta.p,
            q: -plane.t * xi.q - plane.w - zeta.q,
            p_slope: -plane.t * xi.p_slope - zeta.p_slope,
            q_slope: -plane.t * xi.q_slope - zeta.q_slope,
            p_rate: -plane.t * xi.p_rate - zeta.p_rate,
        }
    }

    pub(super) fn across_line(&self, pose: &Pose, at: &Coordinates) -> Line {
        let (a, Coordinates { xi, zeta, .. }) = (&self.across, at);
        Line {
            p: a.t * xi.p + a.z * zeta.p + pose.across,
            q: a.t * xi.q + a.z * zeta.q + a.w,
            p_slope: a.t * xi.p_slope + a.z * zeta.p_slope,
            q_slope: a.t * xi.q_slope + a.z * zeta.q_slope,
            p_rate: a.t * xi.p_rate + a.z * zeta.p_rate,
        }
    }

    /// Bounds of w on a generator, from below and above: the ends of its involute, and the rack's end faces. (The pinion's end
    /// faces bound w, too.) Where a generator runs along the rack, no w keeps it within the end faces: then the last value is
    /// the gap that is left.
    pub(super) fn edges(&self, pose: &Pose, at: &Coordinates) -> [Option<(Bound, Bound)>; 2] {
        // without a helix the generator lies at one roll angle; the caller keeps that within bounds
        let involute = (self.kappa != 0.0).then(|| {
            let inverse = 1.0 / self.kappa;
            let edge = |roll: f64, kind| Bound { w: (roll - at.t0) * inverse, slope: -inverse, rate: inverse, kind };
            let (root, tip) = (edge(self.start_roll, ContactKind::RootEdge), edge(self.tip_roll, ContactKind::TipEdge));
            if inverse > 0.0 { (root, tip) } else { (tip, root) }
        });
        let y = self.across_line(pose, at);
        let k = self.across.half_width;
        let kind = ContactKind::RackEndEdge;
        let rack = if y.q.abs() * self.half_face > 1e-12 * k {
            let inverse = 1.0 / y.q;
            let edge = |y_end: f64| {
                let w = (y_end - y.p) * inverse;
                Bound { w, slope: -y.slope_at(w) * inverse, rate: -y.p_rate * inverse, kind }
            };
            Some(if inverse > 0.0 { (edge(-k), edge(k)) } else { (edge(k), edge(-k)) })
        } else {
            // outside the rack no w helps, δ must change
            (y.p.abs() > k).then(|| {
                let gap = (k - y.p.abs()).min(0.0);
                let slope = if y.p > 0.0 { -y.p_slope } else { y.p_slope };
                (
                    Bound { w: -gap / 2.0, slope: -slope / 2.0, rate: 0.0, kind },
                    Bound { w: gap / 2.0, slope: slope / 2.0, rate: 0.0, kind },
                )
            })
        };
        [involute, rack]
    }

    pub(super) fn pinion_ends(&self) -> (Bound, Bound) {
        let end = |w| Bound { w, slope: 0.0, rate: 0.0, kind: ContactKind::PinionEndEdge };
        (end(-self.half_face), end(self.half_face))
    }

    /// The interval of w on a generator.
    pub(super) fn interval(&self, pose: &Pose, at: &Coordinates) -> (Bound, Bound) {
        let (mut lo, mut hi) = self.pinion_ends();
        let edges = self.edges(pose, at);
        if let Some(gap) = edges[1].filter(|(low, high)| low.w > high.w) {
            return gap;
        }
        for (low, high) in edges.into_iter().flatten() {
            if low.w > lo.w {
                lo = low;
            }
            if high.w < hi.w {
                hi = high;
            }
        }
        (lo, hi)
    }

    /// The largest demand on the generator δ.
    pub(super) fn demand(&self, pose: &Pose, delta: f64) -> Generator {
        #[cfg(test)]
        super::tests::count();
        let at = self.coordinates(pose, delta);
        let (lo, hi) = self.interval(pose, &at);
        let gap = hi.w - lo.w;
        if gap < -VERTEX * self.half_face {
            return Generator::None { gap, slope: hi.slope - lo.slope, rate: hi.rate - lo.rate };
        }
        let flank = Self::plane(&self.flank, pose.shift, &at);
        let tip = Self::plane(&self.tip, 0.0, &at);
        if let Some(form) = self.form {
            let lines = [flank, tip, self.across_line(pose, &at)];
            return self.demand_with_form(&OnGenerator { form: &form, pose, at: &at, lines, lo, hi });
        }
        let at_bound = |bound: &Bound| {
            let (f, t) = (flank.at(bound.w), tip.at(bound.w));
            if f <= t { (f, flank, Surface::Flank) } else { (t, tip, Surface::Tip) }
        };
        let ended = |bound: &Bound, demand: f64, line: &Line, surface: Surface| Generator::Some {
            demand,
            slope: line.slope_at(bound.w) + line.q * bound.slope,
            rate: line.p_rate + line.q * bound.rate,
            w: bound.w,
            kind: bound.kind,
            surface,
            rival: f64::NEG_INFINITY,
        };
        let (demand, line, surface) = at_bound(&hi);
        if line.q >= 0.0 {
            return ended(&hi, demand, &line, surface);
        }
        let (demand, line, surface) = at_bound(&lo);
        if line.q <= 0.0 {
            return ended(&lo, demand, &line, surface);
        }
        // rising at the lower end and falling at the upper one: the two planes cross between
        let inverse = 1.0 / (tip.q - flank.q);
        let w = ((flank.p - tip.p) * inverse).clamp(lo.w.min(hi.w), hi.w.max(lo.w));
        let w_slope = (flank.slope_at(w) - tip.slope_at(w)) * inverse;
        let w_rate = (flank.p_rate - tip.p_rate) * inverse;
        Generator::Some {
            demand: flank.at(w).min(tip.at(w)),
            slope: flank.slope_at(w) + flank.q * w_slope,
            rate: flank.p_rate + flank.q * w_rate,
            w,
            kind: ContactKind::RackEdge,
            surface: Surface::Flank,
            rival: f64::NEG_INFINITY,
        }
    }
}
