//! The common normal of a flank pair that touches, and how fast both flanks slide there. Asked once for a solved stroke;
//! searches nothing.

use super::{ContactKind, Coordinates, FlankContact, Pose, PoseRates, RollRates, Spot, Touch};

/// The direction in which a contact presses the rack, scaled to 1 along Z: how the centre distance that the contact asks for
/// changes as the rack moves along X and along Y.
#[derive(Debug, Clone, Copy)]
pub(in crate::mesh) struct Normal {
    pub(in crate::mesh) along: f64,
    pub(in crate::mesh) across: f64,
}

impl Normal {
    /// Force along the normal per force along Z.
    pub(in crate::mesh) fn length(self) -> f64 {
        (1.0 + self.along * self.along + self.across * self.across).sqrt()
    }
}

/// How both parts move for each mm of stroke: dΔCD/ds, and dθ/ds in rad/mm. On left flanks, which are the mirror image of
/// right ones, the sign is −1.
#[derive(Debug, Clone, Copy)]
pub(in crate::mesh) struct Motion {
    pub(in crate::mesh) sign: f64,
    pub(in crate::mesh) delta_cd: f64,
    pub(in crate::mesh) pinion_angle: f64,
}

/// Where the speed changes along a line by less than this share, its mean is its value in the middle.
const EVEN: f64 = 1e-6;

impl FlankContact {
    /// The normal, mirrored if it is that of a left flank: by the demand's derivatives, so that edges and corners have theirs.
    pub(in crate::mesh) fn normal(&self, pose: &Pose, touch: &Touch) -> Normal {
        let (plane, across) = (&self.flank, &self.across);
        let rate = |shift: f64, across: f64| self.rate_of_place(pose, touch, [shift, across]);
        Normal {
            along: rate(plane.t * across.w - plane.w * across.t, 0.0),
            across: rate(plane.t * across.t + plane.w * across.w, -1.0),
        }
    }

    /// How the demand changes as `shift` and `across` of its pose do.
    pub(in crate::mesh) fn rate_of_place(&self, pose: &Pose, touch: &Touch, [shift, across]: [f64; 2]) -> f64 {
        let moved = PoseRates { shift, across: [across, 0.0] };
        match (touch.spot.kind, touch.at_rack_edge) {
            (ContactKind::Corner, true) => self.rack_corner_rate(pose, &touch.spot, [shift, across]),
            (ContactKind::Corner, false) => self.corner_rate(pose, &touch.spot, [shift, across]),
            _ => self.roll_rate(pose, touch, &RollRates::default(), &moved)[0],
        }
    }

    /// Velocity of the rack against the pinion along ξ, ζ and w, for each mm of stroke: the rack moves by −1 along X and by
    /// −dΔCD/ds along Z, a point of the pinion by dθ/ds (ζ, −ξ).
    fn velocity(&self, at: &Coordinates, w: f64, motion: &Motion) -> [f64; 3] {
        let Motion { sign, delta_cd, pinion_angle } = *motion;
        let (sin, cos) = (-self.across.t, self.across.w);
        let along = cos + pinion_angle * at.zeta.at(w);
        [-sign * along, sign * pinion_angle * at.xi.at(w) - delta_cd, -sign * sin]
    }

    /// The sliding velocity at a contact; where two edges meet, at their meeting point.
    fn velocity_at(&self, pose: &Pose, touch: &Touch, motion: &Motion) -> [f64; 3] {
        let of = |spot: &Spot| self.velocity(&self.coordinates(pose, spot.delta), spot.w, motion);
        let (first, Some((spot, share))) = (of(&touch.spot), &touch.other) else { return of(&touch.spot) };
        let other = of(spot);
        [0, 1, 2].map(|i| share * first[i] + (1.0 - share) * other[i])
    }

    /// Sliding speed at a contact, for each mm of stroke.
    pub(in crate::mesh) fn slip(&self, pose: &Pose, touch: &Touch, motion: &Motion) -> f64 {
        let velocity = self.velocity_at(pose, touch, motion);
        dot(velocity, velocity).sqrt()
    }

    /// What a contact line asks for, its length along w, and the mean sliding speed along it, for each mm of stroke; `None`
    /// without one.
    pub(in crate::mesh) fn line_slip(&self, pose: &Pose, motion: &Motion) -> Option<(f64, f64, f64)> {
        let touch = self.line(pose)?;
        let (lo, hi) = self.line_span(pose)?;
        let at = self.coordinates(pose, 0.0);
        let [from, to] = [lo, hi].map(|w| self.velocity(&at, w, motion));
        Some((touch.demand, hi - lo, mean_length(from, to)))
    }

    /// The share of the sliding velocity along the normal: only rounding.
    #[cfg(test)]
    pub(in crate::mesh) fn approach(&self, pose: &Pose, touch: &Touch, motion: &Motion) -> f64 {
        let normal = self.normal(pose, touch);
        let [xi, zeta, w] = self.velocity_at(pose, touch, motion);
        let (sin, cos) = (-self.across.t, self.across.w);
        let (x, y) = (cos * xi + sin * w, cos * w - sin * xi);
        (normal.along * x + normal.across * y + zeta) / normal.length()
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Mean length of a vector that changes evenly from one to another: with x its part along the change and h what is across it,
/// the integral of √(x² + h²) is (x √(x² + h²) + h² arsinh(x/h)) / 2.
fn mean_length(from: [f64; 3], to: [f64; 3]) -> f64 {
    let change = [0, 1, 2].map(|i| to[i] - from[i]);
    let middle = [0, 1, 2].map(|i| 0.5 * (from[i] + to[i]));
    let (width, speed) = (dot(change, change).sqrt(), dot(middle, middle).sqrt());
    if width <= EVEN * speed || width == 0.0 {
        return speed;
    }
    let x = dot(middle, change) / width;
    let h2 = (speed * speed - x * x).max(0.0);
    let h = h2.sqrt();
    let integral = |x: f64| {
        let bent = if h > EVEN * width { h2 * libm::asinh(x / h) } else { 0.0 };
        0.5 * (x * (x * x + h2).sqrt() + bent)
    };
    (integral(x + 0.5 * width) - integral(x - 0.5 * width)) / width
}

#[cfg(test)]
mod tests {
    use super::mean_length;

    /// Checks vectors along one line and across it against the mean of many in between.
    #[test]
    fn the_mean_length_is_that_of_all_between() {
        for (from, to, expected) in [
            ([3.0, 0.0, 4.0], [3.0, 0.0, 4.0], 5.0),
            ([1.0, 0.0, 0.0], [3.0, 0.0, 0.0], 2.0),
            ([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.5),
            ([-1.0, 2.0, 0.0], [3.0, 2.0, 0.0], f64::NAN),
            ([-0.1, 0.2, 1.0], [0.3, -0.1, 1.1], f64::NAN),
        ] {
            let at = |share: f64| [0, 1, 2].map(|i: usize| from[i] + share * (to[i] - from[i]));
            let length = |v: [f64; 3]| super::dot(v, v).sqrt();
            let many: f64 = (0..10_000).map(|n| length(at((f64::from(n) + 0.5) / 1e4))).sum();
            let found = mean_length(from, to);
            assert!((found - many / 1e4).abs() < 1e-8, "{found} {many}");
            assert!(expected.is_nan() || (found - expected).abs() < 1e-15, "{found} {expected}");
        }
    }
}
