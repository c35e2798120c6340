//! Sums the contact elements into generalised forces and their tangents. Both contact models call it for each element that
//! touches outside a plane face (elements on faces go to [`super::face`]); it does not know how a gap was found.

use super::law::{Force, Law};
use super::newton::Bend;
use super::outcome::Counters;
use super::state::Forces;
use crate::linear::{dot, increase};

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

/// The force between two surfaces along their normal, and what it changes with.
#[derive(Debug, Clone, Copy)]
pub(super) struct NormalForce {
    /// Its value, N.
    pub(super) value: f64,
    /// Its derivative by the rate of penetration.
    pub(super) by_rate: f64,
    /// Its derivatives by the coordinates.
    pub(super) by_q: [f64; 3],
}

/// What friction needs: the normal and the motion of the pinion's material point against the rack by each coordinate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sliding {
    pub(super) normal: [f64; 3],
    pub(super) motion: [[f64; 3]; 4],
}

/// An element of the last evaluation, to estimate the indentation and the effect of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touching {
    pub(super) gap: f64,
    /// Its derivatives by ψ, a and φ.
    pub(super) by: [f64; 3],
    /// Share of a whole element.
    pub(super) weight: f64,
    /// Its force, N, and the force's derivative by the penetration, N/mm; 0 if it does not touch.
    pub(super) force: f64,
    pub(super) by_depth: f64,
}

/// Counters and memory that evaluations share.
#[derive(Debug, Default)]
pub(super) struct Work {
    pub(super) counters: Counters,
    pub(super) touching: Touchings,
    /// Elements of the last evaluation that a step may make touch: those whose gaps are below `margin`, mm.
    pub(super) near: Vec<Touching>,
    pub(super) margin: f64,
}

impl Work {
    /// What the tangent leaves out of a step of ψ, a and φ: the rest of each generalised force and of each entry of the
    /// tangent, from the elements of the last evaluation with gaps that are linear in the step. The law is one without
    /// damping; friction is taken to stay as it is.
    pub(super) fn bend(&self, law: &Law, step: &[f64; 3]) -> Bend {
        let (mut rest, mut harder) = ([0.0; 3], [0.0; 6]);
        for element in self.touching.0.iter().flatten().chain(&self.near) {
            let g = element.by;
            let opening = dot(&g, step);
            let depth = -(element.gap + opening);
            let after = if depth > 0.0 { law.force(depth, 0.0) } else { Force::default() };
            let force = element.weight * after.value - element.force + element.by_depth * opening;
            let by_depth = element.weight * after.by_depth - element.by_depth;
            let by = g.map(|g| by_depth * g);
            for (sum, g) in rest.iter_mut().zip(g) {
                *sum += force * g;
            }
            let products = [by[0] * g[0], by[0] * g[1], by[0] * g[2], by[1] * g[1], by[1] * g[2], by[2] * g[2]];
            for (sum, product) in harder.iter_mut().zip(products) {
                *sum += product;
            }
        }
        let [aa, ah, ar, hh, hr, rr] = harder;
        Bend { force: rest, tangent: [[aa, ah, ar], [ah, hh, hr], [ar, hr, rr]] }
    }
}

/// The touching elements of the last evaluation, by side: right, left. Kept to be used again.
#[derive(Debug, Default)]
pub(super) struct Touchings(pub(super) [Vec<Touching>; 2]);

/// Exchanges of the simplex method at most; three are usual.
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
            let det = right.by[0] * left.by[1] - left.by[0] * right.by[1];
            if det == 0.0 {
                return rise;
            }
            let turn = (left.gap * right.by[1] - right.gap * left.by[1]) / det;
            rise = (right.gap * left.by[0] - left.gap * right.by[0]) / det;
            let after = |t: &Touching| t.gap + t.by[0] * turn + t.by[1] * rise;
            let mut exchanged = false;
            for (side, kept) in self.0.iter().zip([&mut right, &mut left]) {
                let (mut lowest, mut worst) = (after(kept) - 1e-12, None);
                for element in side {
                    let gap = after(element);
                    if gap < lowest {
                        (lowest, worst) = (gap, Some(element));
                    }
                }
                if let Some(found) = worst {
                    *kept = *found;
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

impl Load<'_> {
    /// Adds an element with a negative gap. `sliding` is asked for only with friction.
    pub(super) fn add(&mut self, right: bool, tooth: i64, element: &Element, sliding: impl FnOnce() -> Sliding) {
        let Element { gap, gradient: g, hessian, weight, fading } = element;
        let v = &self.rates;
        let depth = -gap;
        let rate = -(g[0] * v[0] + g[1] * v[1] + g[2] * v[2] + g[3] * v[3]);
        let force = self.law.force(depth, rate);
        let (f, by_depth, by_rate) = (weight * force.value, weight * force.by_depth, weight * force.by_rate);
        let by_q: [f64; 3] = std::array::from_fn(|j| {
            let h = &hessian[j];
            by_depth * g[j] + by_rate * (h[0] * v[0] + h[1] * v[1] + h[2] * v[2] + h[3] * v[3])
        });
        let sum = &mut self.sum;
        for (i, gi) in g.iter().enumerate() {
            sum.generalized[i] += f * gi;
        }
        increase(&mut sum.stiffness, |i, j| g[i] * by_q[j] - f * hessian[i][j]);
        increase(&mut sum.damping, |i, j| by_rate * g[i] * g[j]);
        if let Some(w) = fading {
            for (sum, w) in sum.generalized.iter_mut().zip(w) {
                *sum -= force.energy * w;
            }
            increase(&mut sum.stiffness, |i, j| -(force.value * g[i] * w[j] + force.elastic * w[i] * g[j]));
        }
        sum.along += f * g[3].abs();
        sum.energy += weight * force.energy;
        sum.damped += (f - weight * force.elastic) * rate;
        sum.note((right, tooth), 1, f, depth);
        let touching = Touching { gap: *gap, by: [g[0], g[1], g[2]], weight: *weight, force: f, by_depth };
        self.work.touching.0[usize::from(!right)].push(touching);
        if let Some((mu, fade)) = self.law.friction {
            self.work.counters.friction_evaluations += 1;
            self.rub(&sliding(), mu, fade, &NormalForce { value: f, by_rate, by_q });
        }
    }

    /// Friction −μ f v_t / √(v_t² + v_0²) on the pinion's point. The tangent leaves out how the direction of sliding
    /// turns with the coordinates: its share is the displacement of a step over the radius of curvature, below 1e-4.
    pub(super) fn rub(&mut self, sliding: &Sliding, mu: f64, fade: f64, force: &NormalForce) {
        let Sliding { normal, motion } = sliding;
        let NormalForce { value: f, by_rate, by_q } = *force;
        let v = &self.rates;
        let velocity: [f64; 3] = std::array::from_fn(|axis| (0..4).map(|k| motion[k][axis] * v[k]).sum());
        let across = dot(&velocity, normal);
        let tangent: [f64; 3] = std::array::from_fn(|axis| velocity[axis] - across * normal[axis]);
        let speed = (dot(&tangent, &tangent) + fade * fade).sqrt();
        let per_force: [f64; 4] = std::array::from_fn(|k| -mu * dot(&tangent, &motion[k]) / speed);
        let sum = &mut self.sum;
        for (i, value) in per_force.iter().enumerate() {
            sum.generalized[i] += f * value;
        }
        increase(&mut sum.stiffness, |i, j| per_force[i] * by_q[j]);
        increase(&mut sum.damping, |i, j| {
            let along = dot(&motion[i], &motion[j]) - dot(&motion[i], normal) * dot(&motion[j], normal);
            mu * f / speed * (along - per_force[i] * per_force[j] / (mu * mu))
        });
        increase(&mut sum.damping, |i, j| per_force[i] * by_rate * dot(&motion[j], normal));
        sum.rubbed += mu * f * dot(&tangent, &tangent) / speed;
    }
}
