//! Sums over the elements on the face of one plane flank, which are most elements. Both contact models fill them, one flank
//! pair at a time; it does not know how a gap was found.
//!
//! The gaps of such elements have one normal, so their derivatives by a and s are the same for all, and every entry of
//! the generalised forces and tangents is made of the sums of f, f', ∂f/∂δ' times products of at most two of the
//! derivatives by ψ and φ. They are formed once per flank pair: see [`Load::add`] for what they stand for.

use super::load::{Load, NormalForce, Sliding, Touching};
use crate::linear::increase;

/// An element's gap on a plane face, with its derivatives by ψ and φ.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct OnFace {
    pub(super) gap: f64,
    /// Share of a whole element.
    pub(super) weight: f64,
    pub(super) by_angle: f64,
    pub(super) by_roll: f64,
    pub(super) by_angle_twice: f64,
    pub(super) by_angle_roll: f64,
    pub(super) by_roll_twice: f64,
}

/// Σ x, Σ x g_ψ, Σ x g_φ, Σ x g_ψ², Σ x g_ψ g_φ, Σ x g_φ² for a weight x.
type Moments = [f64; 6];

/// Adds an element's to the sums.
fn add(moments: &mut Moments, x: f64, on: &OnFace) {
    let (angle, roll) = (x * on.by_angle, x * on.by_roll);
    sum(moments, [x, angle, roll, angle * on.by_angle, angle * on.by_roll, roll * on.by_roll]);
}

fn sum<const N: usize>(sums: &mut [f64; N], add: [f64; N]) {
    sums.iter_mut().zip(add).for_each(|(sum, add)| *sum += add);
}

/// Σ x g_i g_j, the derivative h by a being the same for all.
fn matrix([one, angle, roll, angle_angle, angle_roll, roll_roll]: Moments, h: f64) -> [[f64; 3]; 3] {
    [[angle_angle, h * angle, angle_roll], [h * angle, h * h * one, h * roll], [angle_roll, h * roll, roll_roll]]
}

/// The elements on a face so far.
#[derive(Debug, Clone, Default)]
pub(super) struct Face {
    right: bool,
    tooth: i64,
    /// The derivatives that all elements share: by a, s, and aφ.
    by_height: f64,
    by_stroke: f64,
    by_height_roll: f64,
    /// How fast every gap opens by the rates of a and s.
    opening: f64,
    /// Σ f times 1, g_ψ, g_φ, g_ψψ, g_ψφ, g_φφ.
    force: Moments,
    stiffness: Moments,
    damping: Moments,
    /// Σ x (g_ψ, 1, g_φ) of what the rates make of the derivatives by ψ and φ, in place of x.
    turning: [[f64; 3]; 2],
    energy: f64,
    damped: f64,
    deepest: f64,
    contacts: u32,
}

impl Face {
    pub(super) fn new(load: &Load<'_>, (right, tooth): (bool, i64), by: [f64; 3]) -> Self {
        let [by_height, by_stroke, by_height_roll] = by;
        Self {
            right,
            tooth,
            by_height,
            by_stroke,
            by_height_roll,
            opening: by_height * load.rates[1] + by_stroke * load.rates[3],
            ..Self::default()
        }
    }

    /// Adds an element with a negative gap. `sliding` is asked for only with friction.
    pub(super) fn add(&mut self, on: &OnFace, load: &mut Load<'_>, sliding: impl FnOnce() -> Sliding) {
        let v = &load.rates;
        let depth = -on.gap;
        let rate = -(on.by_angle * v[0] + on.by_roll * v[2] + self.opening);
        let force = load.law.force(depth, rate);
        let f = on.weight * force.value;
        let (by_depth, by_rate) = (on.weight * force.by_depth, on.weight * force.by_rate);
        let by = [1.0, on.by_angle, on.by_roll, on.by_angle_twice, on.by_angle_roll, on.by_roll_twice];
        sum(&mut self.force, by.map(|by| f * by));
        add(&mut self.stiffness, by_depth, on);
        let turning = |by: [f64; 2]| by[0] * v[0] + by[1] * v[2];
        let by_angle = || turning([on.by_angle_twice, on.by_angle_roll]);
        let by_roll = || turning([on.by_angle_roll, on.by_roll_twice]) + self.by_height_roll * v[1];
        if by_rate != 0.0 {
            add(&mut self.damping, by_rate, on);
            for (sums, x) in self.turning.iter_mut().zip([by_rate * by_angle(), by_rate * by_roll()]) {
                sum(sums, [x * on.by_angle, x, x * on.by_roll]);
            }
        }
        self.damped += (f - on.weight * force.elastic) * rate;
        self.energy += on.weight * force.energy;
        self.deepest = self.deepest.max(depth);
        self.contacts += 1;
        load.work.touching.0[usize::from(!self.right)].push(self.met(on, f, by_depth));
        if let Some((mu, fade)) = load.law.friction {
            load.work.counters.friction_evaluations += 1;
            let by_q = [
                by_depth * on.by_angle + by_rate * by_angle(),
                by_depth * self.by_height + by_rate * self.by_height_roll * v[2],
                by_depth * on.by_roll + by_rate * by_roll(),
            ];
            load.rub(&sliding(), mu, fade, &NormalForce { value: f, by_rate, by_q });
        }
    }

    /// Keeps an element that is near but does not touch.
    pub(super) fn pass(&self, on: &OnFace, load: &mut Load<'_>) {
        load.work.near.push(self.met(on, 0.0, 0.0));
    }

    fn met(&self, on: &OnFace, force: f64, by_depth: f64) -> Touching {
        let &OnFace { gap, weight, by_angle, by_roll, .. } = on;
        Touching { gap, by: [by_angle, self.by_height, by_roll], weight, force, by_depth }
    }

    /// Adds the sums to the load.
    pub(super) fn close(&self, load: &mut Load<'_>) {
        if self.contacts == 0 {
            return;
        }
        let h = self.by_height;
        let [force, by_angle, by_roll, by_angle_twice, by_angle_roll, by_roll_twice] = self.force;
        let total = &mut load.sum;
        sum(&mut total.generalized, [by_angle, h * force, by_roll, self.by_stroke * force]);
        let bent = self.by_height_roll * force;
        let hessian = [[by_angle_twice, 0.0, by_angle_roll], [0.0, 0.0, bent], [by_angle_roll, bent, by_roll_twice]];
        // x (g_ψ, g_a, g_φ) of what the rates make of the derivative by each coordinate
        let turned = |[angle, one, roll]: [f64; 3]| [angle, h * one, roll];
        let lifting = self.by_height_roll * load.rates[2];
        let [one, angle, roll, ..] = self.damping;
        let turning = [
            turned(self.turning[0]),
            turned([angle * lifting, one * lifting, roll * lifting]),
            turned(self.turning[1]),
        ];
        let stiffness = matrix(self.stiffness, h);
        increase(&mut total.stiffness, |i, j| stiffness[i][j] + turning[j][i] - hessian[i][j]);
        let damping = matrix(self.damping, h);
        increase(&mut total.damping, |i, j| damping[i][j]);
        total.along += self.by_stroke.abs() * force;
        total.energy += self.energy;
        total.damped += self.damped;
        total.note((self.right, self.tooth), self.contacts, force, self.deepest);
    }
}
