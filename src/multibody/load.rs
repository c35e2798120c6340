//! Sums the contact elements into generalised forces and their tangents. Called by both contact models for each
//! element that touches; knows nothing of how its gap was found.

use super::law::{Force, Law};
use super::outcome::Counters;
use super::state::Forces;

/// A contact element's gap as a function of ψ, a, φ, s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element {
    pub(super) gap: f64,
    pub(super) gradient: [f64; 4],
    pub(super) hessian: [[f64; 4]; 4],
    /// Share of a whole element.
    pub(super) weight: f64,
    /// Its derivatives, where it changes: the energy of an element that is cut off pushes back too.
    pub(super) fading: Option<[f64; 4]>,
}

/// An element over the face of a plane flank of a rack that is not rolled: most of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Flat {
    pub(super) gap: f64,
    pub(super) by_angle: f64,
    pub(super) by_height: f64,
    pub(super) by_stroke: f64,
    /// The second derivative by ψ; all others are 0.
    pub(super) by_angle_twice: f64,
    pub(super) weight: f64,
}

/// The same on a rack that may roll.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tilted {
    pub(super) flat: Flat,
    pub(super) by_roll: f64,
    /// Second derivatives by ψφ, aφ and φφ.
    pub(super) by_angle_roll: f64,
    pub(super) by_height_roll: f64,
    pub(super) by_roll_twice: f64,
}

/// What friction needs: the normal and the motion of the pinion's material point against the rack by each coordinate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sliding {
    pub(super) normal: [f64; 3],
    pub(super) motion: [[f64; 3]; 4],
}

/// A touching element, for the estimate of the indentation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touching {
    pub(super) gap: f64,
    /// Its derivatives by ψ and a.
    pub(super) by_angle: f64,
    pub(super) by_height: f64,
}

/// What evaluations share: counters and memory.
#[derive(Debug, Default)]
pub(super) struct Work {
    pub(super) counters: Counters,
    pub(super) touching: Touchings,
}

/// The touching elements of the last evaluation, by side: right, left. Kept to be used again.
#[derive(Debug, Default)]
pub(super) struct Touchings(pub(super) [Vec<Touching>; 2]);

/// Exchanges of the simplex method at most; three are the rule.
const EXCHANGES: usize = 32;

impl Touchings {
    /// The smallest rise of a at which, to first order, some rotation opens every gap; 0 if one side does not touch.
    ///
    /// Each element asks for a rise that is linear in the rotation, right ones falling and left ones rising, so
    /// the answer is where both sides' upper envelopes cross; the pair of elements that cross there is found by
    /// exchanging one of them for the one that is violated most.
    pub(super) fn indentation(&self) -> f64 {
        let deepest = |side: &[Touching]| side.iter().copied().min_by(|a, b| a.gap.total_cmp(&b.gap));
        let (Some(mut right), Some(mut left)) = (deepest(&self.0[0]), deepest(&self.0[1])) else { return 0.0 };
        let mut rise = 0.0;
        for _ in 0..EXCHANGES {
            let det = right.by_angle * left.by_height - left.by_angle * right.by_height;
            if det == 0.0 {
                return rise;
            }
            let turn = (left.gap * right.by_height - right.gap * left.by_height) / det;
            rise = (right.gap * left.by_angle - left.gap * right.by_angle) / det;
            let after = |t: &Touching| t.gap + t.by_angle * turn + t.by_height * rise;
            let worst = |side: &[Touching]| side.iter().copied().min_by(|a, b| after(a).total_cmp(&after(b)));
            let mut exchanged = false;
            for (side, kept) in self.0.iter().zip([&mut right, &mut left]) {
                if let Some(found) = worst(side)
                    && after(&found) < after(kept) - 1e-12
                {
                    *kept = found;
                    exchanged = true;
                }
            }
            if !exchanged {
                break;
            }
        }
        rise
    }
}

/// A running sum.
#[derive(Debug)]
pub(super) struct Load<'a> {
    pub(super) law: &'a Law,
    pub(super) rates: [f64; 4],
    pub(super) sum: Forces,
    pub(super) work: &'a mut Work,
}

fn dot3(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Load<'_> {
    /// Adds an element with a negative gap. `sliding` is asked for only with friction.
    pub(super) fn add(&mut self, right: bool, tooth: i64, element: &Element, sliding: impl FnOnce() -> Sliding) {
        let Element { gap, gradient: g, hessian, weight, fading } = element;
        let v = &self.rates;
        let depth = -gap;
        let rate = -(g[0] * v[0] + g[1] * v[1] + g[2] * v[2] + g[3] * v[3]);
        let force = self.law.force(depth, rate);
        let (f, by_depth, by_rate) = (weight * force.value, weight * force.by_depth, weight * force.by_rate);
        let mut by_q = [0.0; 3];
        for j in 0..3 {
            let h = &hessian[j];
            by_q[j] = by_depth * g[j] + by_rate * (h[0] * v[0] + h[1] * v[1] + h[2] * v[2] + h[3] * v[3]);
        }
        let sum = &mut self.sum;
        for (i, gi) in g.iter().enumerate() {
            sum.generalized[i] += f * gi;
        }
        for i in 0..3 {
            for j in 0..3 {
                sum.stiffness[i][j] += g[i] * by_q[j] - f * hessian[i][j];
                sum.damping[i][j] += by_rate * g[i] * g[j];
            }
        }
        if let Some(w) = fading {
            for (sum, w) in sum.generalized.iter_mut().zip(w) {
                *sum -= force.energy * w;
            }
            for i in 0..3 {
                for j in 0..3 {
                    sum.stiffness[i][j] -= force.value * g[i] * w[j] + force.elastic * w[i] * g[j];
                }
            }
        }
        self.note(right, tooth, *gap, (g[0], g[1]), f * g[3].abs(), f, *weight, &force, rate);
        if let Some((mu, fade)) = self.law.friction {
            self.work.counters.friction_evaluations += 1;
            self.rub(&sliding(), mu, fade, f, by_rate, &by_q);
        }
    }

    /// [`Load::add`] for a flat element. The roll must not be a coordinate.
    pub(super) fn add_flat(&mut self, right: bool, tooth: i64, flat: &Flat, sliding: impl FnOnce() -> Sliding) {
        let Flat { gap, by_angle, by_height, by_stroke, by_angle_twice, weight } = *flat;
        let v = &self.rates;
        let depth = -gap;
        let rate = -(by_angle * v[0] + by_height * v[1] + by_stroke * v[3]);
        let force = self.law.force(depth, rate);
        let (f, by_depth, by_rate) = (weight * force.value, weight * force.by_depth, weight * force.by_rate);
        let by_q = [by_depth * by_angle + by_rate * by_angle_twice * v[0], by_depth * by_height];
        let sum = &mut self.sum;
        sum.generalized[0] += f * by_angle;
        sum.generalized[1] += f * by_height;
        sum.generalized[3] += f * by_stroke;
        sum.stiffness[0][0] += by_angle * by_q[0] - f * by_angle_twice;
        sum.stiffness[0][1] += by_angle * by_q[1];
        sum.stiffness[1][0] += by_height * by_q[0];
        sum.stiffness[1][1] += by_height * by_q[1];
        if by_rate != 0.0 {
            sum.damping[0][0] += by_rate * by_angle * by_angle;
            sum.damping[0][1] += by_rate * by_angle * by_height;
            sum.damping[1][0] += by_rate * by_height * by_angle;
            sum.damping[1][1] += by_rate * by_height * by_height;
        }
        self.note(right, tooth, gap, (by_angle, by_height), f * by_stroke.abs(), f, weight, &force, rate);
        if let Some((mu, fade)) = self.law.friction {
            self.work.counters.friction_evaluations += 1;
            self.rub(&sliding(), mu, fade, f, by_rate, &[by_q[0], by_q[1], 0.0]);
        }
    }

    /// [`Load::add`] for a flat element of a rack that may roll.
    #[allow(clippy::needless_range_loop)] // matrices read as in the books
    pub(super) fn add_tilted(&mut self, right: bool, tooth: i64, tilted: &Tilted, sliding: impl FnOnce() -> Sliding) {
        let Tilted { flat, by_roll, by_angle_roll, by_height_roll, by_roll_twice } = *tilted;
        let Flat { gap, by_angle, by_height, by_stroke, by_angle_twice, weight } = flat;
        let v = &self.rates;
        let depth = -gap;
        let rate = -(by_angle * v[0] + by_height * v[1] + by_roll * v[2] + by_stroke * v[3]);
        let force = self.law.force(depth, rate);
        let (f, by_depth, by_rate) = (weight * force.value, weight * force.by_depth, weight * force.by_rate);
        let g = [by_angle, by_height, by_roll];
        let mut by_q = g.map(|g| by_depth * g);
        if by_rate != 0.0 {
            by_q[0] += by_rate * (by_angle_twice * v[0] + by_angle_roll * v[2]);
            by_q[1] += by_rate * by_height_roll * v[2];
            by_q[2] += by_rate * (by_angle_roll * v[0] + by_height_roll * v[1] + by_roll_twice * v[2]);
        }
        let sum = &mut self.sum;
        for i in 0..3 {
            sum.generalized[i] += f * g[i];
            for j in 0..3 {
                sum.stiffness[i][j] += g[i] * by_q[j];
            }
        }
        sum.generalized[3] += f * by_stroke;
        sum.stiffness[0][0] -= f * by_angle_twice;
        sum.stiffness[0][2] -= f * by_angle_roll;
        sum.stiffness[2][0] -= f * by_angle_roll;
        sum.stiffness[1][2] -= f * by_height_roll;
        sum.stiffness[2][1] -= f * by_height_roll;
        sum.stiffness[2][2] -= f * by_roll_twice;
        if by_rate != 0.0 {
            for i in 0..3 {
                for j in 0..3 {
                    sum.damping[i][j] += by_rate * g[i] * g[j];
                }
            }
        }
        self.note(right, tooth, gap, (by_angle, by_height), f * by_stroke.abs(), f, weight, &force, rate);
        if let Some((mu, fade)) = self.law.friction {
            self.work.counters.friction_evaluations += 1;
            self.rub(&sliding(), mu, fade, f, by_rate, &by_q);
        }
    }

    /// Counts an element.
    #[allow(clippy::too_many_arguments)] // one inner step of both ways to add
    fn note(
        &mut self,
        right: bool,
        tooth: i64,
        gap: f64,
        (by_angle, by_height): (f64, f64),
        along: f64,
        f: f64,
        weight: f64,
        force: &Force,
        rate: f64,
    ) {
        let sum = &mut self.sum;
        sum.along += along;
        sum.energy += weight * force.energy;
        sum.dissipation += (f - weight * force.elastic) * rate;
        if right {
            sum.normal_right += f;
        } else {
            sum.normal_left += f;
        }
        sum.contacts += 1;
        sum.penetration = sum.penetration.max(-gap);
        sum.teeth = Some(sum.teeth.map_or((tooth, tooth), |(low, high)| (low.min(tooth), high.max(tooth))));
        self.work.touching.0[usize::from(!right)].push(Touching { gap, by_angle, by_height });
    }

    /// Friction −μ f v_t / √(v_t² + v_0²) on the pinion's point. The tangent leaves out how the direction of sliding
    /// turns with the coordinates: its share is the displacement of a step over the radius of curvature, below 1e-4.
    fn rub(&mut self, sliding: &Sliding, mu: f64, fade: f64, f: f64, by_rate: f64, by_q: &[f64; 3]) {
        let Sliding { normal, motion } = sliding;
        let v = &self.rates;
        let mut velocity = [0.0; 3];
        for (axis, out) in velocity.iter_mut().enumerate() {
            *out = (0..4).map(|k| motion[k][axis] * v[k]).sum();
        }
        let across = dot3(&velocity, normal);
        let tangent: [f64; 3] = std::array::from_fn(|axis| velocity[axis] - across * normal[axis]);
        let speed = (dot3(&tangent, &tangent) + fade * fade).sqrt();
        let per_force: [f64; 4] = std::array::from_fn(|k| -mu * dot3(&tangent, &motion[k]) / speed);
        let sum = &mut self.sum;
        for (i, value) in per_force.iter().enumerate() {
            sum.generalized[i] += f * value;
        }
        for i in 0..3 {
            for j in 0..3 {
                sum.stiffness[i][j] += per_force[i] * by_q[j];
                let along = dot3(&motion[i], &motion[j]) - dot3(&motion[i], normal) * dot3(&motion[j], normal);
                let turning = per_force[i] * per_force[j] / (mu * mu);
                sum.damping[i][j] += mu * f / speed * (along - turning);
                sum.damping[i][j] += per_force[i] * by_rate * dot3(&motion[j], normal);
            }
        }
        sum.dissipation += mu * f * dot3(&tangent, &tangent) / speed;
    }
}
