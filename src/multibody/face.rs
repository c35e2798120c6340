//! Sums over the elements on the face of one plane flank, which are most of all. Filled by both contact models, one
//! flank pair at a time; knows nothing of how a gap was found.
//!
//! The gaps of such elements have one normal, so their derivatives by a and s are the same for all, and every entry of
//! the generalised forces and tangents is made of the sums of f, f', ∂f/∂δ' times products of at most two of the
//! derivatives by ψ and φ. They are formed once per flank pair: see [`Load::add`] for what they stand for.

use super::load::{Load, NormalForce, Sliding, Touching};

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
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    one: f64,
    angle: f64,
    roll: f64,
    angle_angle: f64,
    angle_roll: f64,
    roll_roll: f64,
}

impl Moments {
    fn add(&mut self, x: f64, on: &OnFace) {
        let by_angle = x * on.by_angle;
        self.one += x;
        self.angle += by_angle;
        self.angle_angle += by_angle * on.by_angle;
        let by_roll = x * on.by_roll;
        self.roll += by_roll;
        self.angle_roll += by_angle * on.by_roll;
        self.roll_roll += by_roll * on.by_roll;
    }

    /// Σ x g_i g_j, the derivative by a being the same for all.
    fn matrix(&self, by_height: f64) -> [[f64; 3]; 3] {
        let (angle_height, height_roll) = (by_height * self.angle, by_height * self.roll);
        [
            [self.angle_angle, angle_height, self.angle_roll],
            [angle_height, by_height * by_height * self.one, height_roll],
            [self.angle_roll, height_roll, self.roll_roll],
        ]
    }
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
    force: f64,
    by_angle: f64,
    by_roll: f64,
    by_angle_twice: f64,
    by_angle_roll: f64,
    by_roll_twice: f64,
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
        self.force += f;
        self.by_angle += f * on.by_angle;
        self.by_angle_twice += f * on.by_angle_twice;
        self.by_roll += f * on.by_roll;
        self.by_angle_roll += f * on.by_angle_roll;
        self.by_roll_twice += f * on.by_roll_twice;
        self.stiffness.add(by_depth, on);
        let turning = |by: [f64; 2]| by[0] * v[0] + by[1] * v[2];
        let by_angle = || turning([on.by_angle_twice, on.by_angle_roll]);
        let by_roll = || turning([on.by_angle_roll, on.by_roll_twice]) + self.by_height_roll * v[1];
        if by_rate != 0.0 {
            self.damping.add(by_rate, on);
            for (sums, x) in self.turning.iter_mut().zip([by_rate * by_angle(), by_rate * by_roll()]) {
                sums[0] += x * on.by_angle;
                sums[1] += x;
                sums[2] += x * on.by_roll;
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

    /// Remembers an element that does not touch, but is near.
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
        let roll_rate = load.rates[2];
        let sum = &mut load.sum;
        let forces = [self.by_angle, h * self.force, self.by_roll, self.by_stroke * self.force];
        for (total, force) in sum.generalized.iter_mut().zip(forces) {
            *total += force;
        }
        let stiffness = self.stiffness.matrix(h);
        let damping = self.damping.matrix(h);
        let bent = self.by_height_roll * self.force;
        let hessian = [
            [self.by_angle_twice, 0.0, self.by_angle_roll],
            [0.0, 0.0, bent],
            [self.by_angle_roll, bent, self.by_roll_twice],
        ];
        // x (g_ψ, g_a, g_φ) of what the rates make of the derivative by each coordinate
        let turned = |[angle, one, roll]: [f64; 3]| [angle, h * one, roll];
        let lifting = self.by_height_roll * roll_rate;
        let Moments { one, angle, roll, .. } = self.damping;
        let turning = [
            turned(self.turning[0]),
            turned([angle * lifting, one * lifting, roll * lifting]),
            turned(self.turning[1]),
        ];
        for i in 0..3 {
            for j in 0..3 {
                sum.stiffness[i][j] += stiffness[i][j] + turning[j][i] - hessian[i][j];
                sum.damping[i][j] += damping[i][j];
            }
        }
        sum.along += self.by_stroke.abs() * self.force;
        sum.energy += self.energy;
        sum.damped += self.damped;
        sum.note((self.right, self.tooth), self.contacts, self.force, self.deepest);
    }
}
