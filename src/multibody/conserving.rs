//! One step in time that keeps the energy of contacts without damping and friction, and when it is taken. Called by
//! [`super::dynamics`]; knows the contact only by its forces.
//!
//! # Why
//! What an impact leaves without losses is vibration of the contacts, at 30 to 150 kHz, that never dies: a rack that
//! rolls meets the pinion some hundred times in a stroke, and a few N mm go on ringing. A scheme that damps them by
//! 1e-6 a period loses them all, and any scheme of a fixed order errs where a force jumps because a corner slides off
//! an edge. So the energy is not left to the order:
//!
//! ```text
//! q_1 − q_0 = h (v_0 + v_1)/2,    M (v_1 − v_0) = h (F_0 + F_1)/2 + h λ M (q_1 − q_0),
//! λ = −[U_1 − U_0 + (F_0 + F_1)·(x_1 − x_0)/2] / [(q_1 − q_0)·M (q_1 − q_0) + m (s_1 − s_0)²],    x = (q, s),
//! ```
//!
//! the trapezoidal rule, with λ such that the forces do just the work by which the potential U falls: a discrete
//! gradient (Gonzalez 1996; about the trapezoid instead of the midpoint, so that one evaluation of the forces serves,
//! and in the measure of the masses). The drive at s pushes with the force of the same gradient, m standing for the
//! largest mass it moves, so the denominator does not vanish where a vibration turns. Then stored energy and work of
//! the drive agree in each step to what is left of its balance. The rule is symmetric and of second order: λ is the
//! trapezoidal rule's own error over a square.
//!
//! Every coordinate must have a mass; where one has none, nothing is followed.
//!
//! # When
//! Energy that agrees says nothing of a vibration that the steps do not follow: steps of [`FOLLOWED`] radians at most
//! of the fastest one, shorter where the error of the positions asks for it, neither damp nor feed it (a run of nothing
//! else ends with the energy of one by Verlet's scheme with steps a quarter as long). Where nothing vibrates the
//! damping scheme's steps are a thousand times as long and lose next to nothing, so those are made as long as the
//! allowed drift lasts, and tried again.

use super::Scene;
use super::drive::Drive;
use super::energy::Flow;
use super::load::Work;
use super::newton::{Balance, Limits, newton};
use super::state::State;
use crate::linear::solve;

/// One step's outcome.
pub(super) struct Step {
    pub(super) state: State,
    /// Largest error of a position, mm.
    pub(super) error: f64,
    pub(super) gained: Flow,
}

/// Unbalanced force over the closing force at which a step is solved: times the way of all steps, forth and back, it is
/// the energy that is made up.
const BALANCE: f64 = 1e-7;
/// Iterations; two are the rule.
const ITERATIONS: u32 = 25;
/// Displacements below this, mm, are not told from rounding.
const ROUNDING: f64 = 1e-8;
/// Radians of the fastest vibration that a step takes at most.
const FOLLOWED: f64 = 2.0;
/// Steps after which those are tried again, fewest and most.
const SOON: u32 = 64;
const LATE: u32 = 4096;

/// Whether vibrations are followed, and until when.
#[derive(Debug, Default)]
pub(super) struct Following {
    left: u32,
    patience: u32,
    /// Whether long steps that damp have been made since.
    damped: bool,
}

impl Following {
    pub(super) fn is_on(&self) -> bool {
        self.left > 0
    }

    /// Follows vibrations, each time twice as long if nothing else has helped.
    pub(super) fn begin(&mut self) {
        self.patience = if self.damped { SOON } else { (2 * self.patience).clamp(SOON, LATE) };
        self.left = self.patience;
        self.damped = false;
    }

    /// Counts a step that was made, `long` if it was worth being made.
    pub(super) fn count(&mut self, long: bool) {
        self.damped |= long && self.left == 0;
        self.left = self.left.saturating_sub(1);
    }
}

impl Scene {
    /// The longest step that follows the fastest vibration of the bodies; 0 if one has no mass. The frequency is
    /// bounded as Gershgorin has it, in lengths.
    pub(super) fn following(&self, at: &State) -> f64 {
        let n = self.coordinates() as usize;
        let scale = self.limits(0.0).scale;
        let tangent = self.tangent(&at.q, &at.contact);
        let mut square: f64 = if self.inertia[..n].contains(&0.0) { f64::INFINITY } else { 0.0 };
        for i in 0..n {
            let sum: f64 = (0..n).map(|j| tangent[i][j].abs() / scale[j]).sum();
            square = square.max(sum * scale[i] / self.inertia[i]);
        }
        FOLLOWED / square.sqrt()
    }

    /// One step; `None` if it is not solved.
    pub(super) fn conserving(&self, drive: &Drive, from: &State, end: f64, work: &mut Work) -> Option<Step> {
        let h = end - from.time;
        let n = self.coordinates() as usize;
        let m = &self.inertia;
        let limits = Limits { iterations: ITERATIONS, ..self.limits(BALANCE * self.load_n()) };
        let scale = limits.scale;
        let travel = drive.at(end).stroke - from.stroke;
        let before = self.potential(from);
        let most = (0..n).map(|i| m[i] / (scale[i] * scale[i])).fold(0.0, f64::max);
        let least = most * (travel * travel + ROUNDING * ROUNDING);
        // M (v_1 − v_0)/h
        let inertia = |i: usize, way: &[f64; 3]| 2.0 * m[i] * (way[i] / h - from.v[i]) / h;
        // from where the rack alone would have taken the parts, on by the tangent
        let mut guess = [travel * self.mesh.pair().rotation_per_stroke_rad(), 0.0, 0.0];
        let (mut matrix, mut right) = (self.tangent(&from.q, &from.contact), [0.0; 3]);
        for i in 0..n {
            matrix[i] = std::array::from_fn(|j| 0.5 * matrix[i][j] / (scale[i] * scale[j]));
            matrix[i][i] += 2.0 * m[i] / (h * h * scale[i] * scale[i]);
            right[i] = (from.f[i] - inertia(i, &guess)) / scale[i];
        }
        for (i, moved) in solve(matrix, right, n).into_iter().flatten().enumerate() {
            guess[i] += moved / scale[i];
        }
        let solution = newton(guess, &limits, &mut |way: &[f64; 3]| {
            let q = std::array::from_fn(|i| from.q[i] + way[i]);
            let v = std::array::from_fn(|i| if i < n { 2.0 * way[i] / h - from.v[i] } else { 0.0 });
            let state = self.state(drive.at(end), q, v, work);
            let mean: [f64; 3] = std::array::from_fn(|i| 0.5 * (from.f[i] + state.f[i]));
            let along = 0.5 * (from.contact.generalized[3] + state.contact.generalized[3]) * travel;
            let gained = self.potential(&state) - before + along + (0..n).map(|i| mean[i] * way[i]).sum::<f64>();
            let size = least + (0..n).map(|i| m[i] * way[i] * way[i]).sum::<f64>();
            let lambda = -gained / size;
            // how λ changes is left out: its share is the change of the stiffness over the step's way
            let (mut residual, mut tangent) = ([0.0; 3], self.tangent(&q, &state.contact));
            for i in 0..n {
                residual[i] = mean[i] + lambda * m[i] * way[i] - inertia(i, way);
                tangent[i] = tangent[i].map(|k| 0.5 * k);
                tangent[i][i] += (2.0 / (h * h) - lambda) * m[i];
            }
            Balance { residual, tangent, potential: None, with: (state, lambda) }
        });
        work.counters.iterations += u64::from(solution.iterations);
        if !solution.converged {
            return None;
        }
        let (state, lambda) = solution.with;
        // what the trapezoidal rule leaves out where the acceleration changes evenly
        let error = |i: usize| h * h / 12.0 * (state.f[i] - from.f[i]).abs() / m[i] * scale[i];
        let error = (0..n).map(error).fold(0.0, f64::max);
        let mean = |of: fn(&State) -> f64| 0.5 * (of(from) + of(&state));
        let gained = Flow {
            driven: -mean(|state| state.contact.generalized[3]) * travel - lambda * least,
            exchanged: mean(|state| state.contact.along) * travel,
            impulse: h * mean(|state| state.f[1]) + lambda * h * m[1] * (state.q[1] - from.q[1]),
            ..Flow::default()
        };
        Some(Step { state, error, gained })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_that_damp_are_tried_again_later_and_later() {
        let mut following = Following::default();
        let mut waits = Vec::new();
        for _ in 0..9 {
            following.begin();
            let mut steps = 0;
            while following.is_on() {
                following.count(true);
                steps += 1;
            }
            waits.push(steps);
        }
        assert_eq!(waits, [64, 128, 256, 512, 1024, 2048, 4096, 4096, 4096]);
        following.count(true);
        following.begin();
        assert_eq!(following.left, SOON);
    }
}
