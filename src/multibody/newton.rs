//! Newton's method for two or three unknowns with a line search. Called by both implicit runs; knows no mechanics
//! beyond forces and their tangent.
//!
//! The equations are the balance of forces r(x) = 0 with the tangent K = −∂r/∂x; near a solution r is monotone, so
//! along a Newton direction d the power r·d falls to zero. A step is shortened while it overshoots, so the method does
//! not cycle where contacts open and close. Where a potential is known, it must fall instead: a rack that rolls has
//! valleys a hundred thousand times softer along than across, and along a bent one the power tells nothing.
//!
//! A tangent that is not positive is made so by the size of its eigenvalues, and a balance on a hill is left.
//!
//! A system that knows how its forces bend along a step without being asked for them there may say so; the step is then
//! the second of two, and as near to the solution.

use crate::linear::{dot, solve};

/// Forces that are out of balance, with their tangent.
#[derive(Debug, Clone, Copy)]
pub(super) struct Balance<T> {
    pub(super) residual: [f64; 3],
    pub(super) tangent: [[f64; 3]; 3],
    /// The potential energy whose fall the forces are, N mm, if there is one.
    pub(super) potential: Option<f64>,
    /// Whatever else the caller wants of the solution.
    pub(super) with: T,
}

impl<T> Balance<T> {
    /// Residual and tangent of the unknowns in use, as forces and lengths.
    fn scaled(&self, limits: &Limits) -> ([f64; 3], [[f64; 3]; 3]) {
        let scale = &limits.scale;
        (
            std::array::from_fn(|i| if i < limits.unknowns { self.residual[i] / scale[i] } else { 0.0 }),
            std::array::from_fn(|i| std::array::from_fn(|j| self.tangent[i][j] / (scale[i] * scale[j]))),
        )
    }
}

/// What a tangent leaves out of a step: forces at its end, and how the tangent there differs.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bend {
    pub(super) force: [f64; 3],
    pub(super) tangent: [[f64; 3]; 3],
}

/// Equations to be solved.
pub(super) trait System {
    /// What a caller wants of the solution beside it.
    type With: Copy;

    /// The balance at x.
    fn balance(&mut self, x: &[f64; 3]) -> Balance<Self::With>;

    /// An estimate of what the tangent of the last balance leaves out of a step from there, if it costs little.
    fn bend(&self, _step: &[f64; 3]) -> Option<Bend> {
        None
    }
}

impl<T: Copy, F: FnMut(&[f64; 3]) -> Balance<T>> System for F {
    type With = T;

    fn balance(&mut self, x: &[f64; 3]) -> Balance<T> {
        self(x)
    }
}

/// How far to go.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Unknowns in use, 2 or 3.
    pub(super) unknowns: usize,
    /// Length per unit of each unknown: all norms are of lengths and forces.
    pub(super) scale: [f64; 3],
    /// Unbalanced force at which it is solved, N.
    pub(super) force: f64,
    /// Longest step, mm.
    pub(super) step: f64,
    /// What rounding makes of the potential, N mm: of two positions this near in it neither is the lower one.
    pub(super) noise: f64,
    /// Iterations at most.
    pub(super) iterations: u32,
}

/// What was found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solution<T> {
    pub(super) x: [f64; 3],
    pub(super) with: T,
    pub(super) iterations: u32,
    /// Force left, N.
    pub(super) residual: f64,
    pub(super) converged: bool,
}

/// How often an unstable balance is left, and how far, as a share of the longest step.
const NUDGES: u32 = 3;
const NUDGE: f64 = 0.05;

/// The potential must fall by this share of what the slope promises.
const FALL: f64 = 1e-4;

/// Steps below this are rounding, mm.
const SMALLEST: f64 = 2e-14;

/// Eigenvalues and orthonormal eigenvectors of the symmetric part of the leading n × n block: Jacobi's rotations.
fn eigen(k: &[[f64; 3]; 3], n: usize) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut a: [[f64; 3]; 3] =
        std::array::from_fn(|i| std::array::from_fn(|j| if i < n && j < n { 0.5 * (k[i][j] + k[j][i]) } else { 0.0 }));
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
            let t =
                if theta.abs() < 1e150 { theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt()) } else { 0.0 };
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let (above, below) = (a[p], a[q]);
            a[p] = std::array::from_fn(|j| c * above[j] - s * below[j]);
            a[q] = std::array::from_fn(|j| s * above[j] + c * below[j]);
            for row in &mut v {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
        }
    }
    ([a[0][0], a[1][1], a[2][2]], std::array::from_fn(|i| std::array::from_fn(|j| v[j][i])))
}

/// The step of a tangent that is not positive: each principal direction by the size of its stiffness, or by `floor`.
fn downhill(k: &[[f64; 3]; 3], r: &[f64; 3], n: usize, floor: f64) -> [f64; 3] {
    let (values, vectors) = eigen(k, n);
    let mut d = [0.0; 3];
    for (value, vector) in values.iter().zip(&vectors) {
        let part = (0..n).map(|i| vector[i] * r[i]).sum::<f64>() / value.abs().max(floor);
        for (d, along) in d.iter_mut().zip(vector).take(n) {
            *d += part * along;
        }
    }
    d
}

/// The direction in which a tangent is clearly negative, if there is one.
fn hill(k: &[[f64; 3]; 3], n: usize) -> Option<[f64; 3]> {
    if solve(*k, [0.0; 3], n).is_some() {
        return None;
    }
    let (values, vectors) = eigen(k, n);
    let stiffest = values.iter().fold(0.0, |most, value| value.abs().max(most));
    (0..n)
        .filter(|&i| values[i] < -1e-9 * stiffest)
        .min_by(|&a, &b| values[a].total_cmp(&values[b]))
        .map(|i| vectors[i])
}

/// The step that also takes along what the tangent leaves out of `d`, all in scaled units; `None` if that is no better.
fn bent(system: &impl System, k: &[[f64; 3]; 3], r: &[f64; 3], d: &[f64; 3], limits: &Limits) -> Option<[f64; 3]> {
    let (n, scale) = (limits.unknowns, &limits.scale);
    let bend = system.bend(&std::array::from_fn(|i| if i < n { d[i] / scale[i] } else { 0.0 }))?;
    let force = std::array::from_fn(|i| if i < n { bend.force[i] / scale[i] } else { 0.0 });
    let k = std::array::from_fn(|i| std::array::from_fn(|j| k[i][j] + bend.tangent[i][j] / (scale[i] * scale[j])));
    let more = solve(k, force, n)?;
    let both: [f64; 3] = std::array::from_fn(|i| d[i] + more[i]);
    (norm(&more) < 0.5 * norm(d) && dot(&both, r) > 0.0).then_some(both)
}

fn norm(v: &[f64; 3]) -> f64 {
    dot(v, v).sqrt()
}

/// Solves `balance(x).residual = 0` from `x`.
pub(super) fn newton<S: System>(mut x: [f64; 3], limits: &Limits, system: &mut S) -> Solution<S::With> {
    let n = limits.unknowns;
    let mut here = system.balance(&x);
    let (mut iterations, mut nudges) = (0, NUDGES);
    loop {
        let (r, k) = here.scaled(limits);
        let size = norm(&r);
        let done = |x, here: &Balance<S::With>, iterations, converged| Solution {
            x,
            with: here.with,
            iterations,
            residual: size,
            converged,
        };
        if size <= limits.force {
            // a balance that any disturbance would leave is left
            match hill(&k, n).filter(|_| nudges > 0 && iterations < limits.iterations) {
                None => return done(x, &here, iterations, true),
                Some(direction) => {
                    nudges -= 1;
                    iterations += 1;
                    for (i, x) in x.iter_mut().enumerate().take(n) {
                        *x += NUDGE * limits.step * direction[i] / limits.scale[i];
                    }
                    here = system.balance(&x);
                    continue;
                }
            }
        }
        if iterations >= limits.iterations || !size.is_finite() {
            return done(x, &here, iterations, false);
        }
        iterations += 1;
        // where no contact holds an unknown, or the balance is one of a ball on a hill
        let floor = size / limits.step;
        let straight = solve(k, r, n).filter(|d| dot(d, &r) > 0.0);
        let mut d = straight.unwrap_or_else(|| downhill(&k, &r, n, floor));
        let length = norm(&d);
        if length <= SMALLEST {
            return done(x, &here, iterations, true);
        }
        if length > limits.step {
            d = d.map(|v| v * (limits.step / length));
        } else if straight.is_some() {
            d = bent(system, &k, &r, &d, limits).unwrap_or(d);
        }
        (x, here) = along(system, &x, &here, &d, limits);
    }
}

/// A step along a direction, shortened while it overshoots: where it ends, and the balance there.
fn along<S: System>(
    system: &mut S,
    x: &[f64; 3],
    here: &Balance<S::With>,
    d: &[f64; 3],
    limits: &Limits,
) -> ([f64; 3], Balance<S::With>) {
    let (r, _) = here.scaled(limits);
    let (size, power) = (norm(&r), dot(&r, d));
    let mut share = 1.0;
    loop {
        let trial: [f64; 3] =
            std::array::from_fn(|i| if i < limits.unknowns { x[i] + share * d[i] / limits.scale[i] } else { x[i] });
        let next = system.balance(&trial);
        let (r_next, _) = next.scaled(limits);
        let power_next = dot(&r_next, d);
        let by_power = power_next < -0.7 * power && norm(&r_next) > 0.7 * size;
        let overshot = match (here.potential, next.potential) {
            // a fall that rounding hides is left to the power
            (Some(before), Some(after)) if after <= before + limits.noise => {
                by_power && after > before - FALL * share * power
            }
            (Some(before), Some(after)) => after > before - FALL * share * power,
            _ => by_power,
        };
        if !overshot || share < 1e-9 {
            return (trial, next);
        }
        share *= (power / (power - power_next)).clamp(0.1, 0.5);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_are_those_of_the_matrix() {
        let k = [[4.0, 1.0, -2.0], [1.0, -3.0, 0.5], [-2.0, 0.5, 1.0]];
        let (values, vectors) = eigen(&k, 3);
        for (value, v) in values.iter().zip(&vectors) {
            for (i, row) in k.iter().enumerate() {
                let product: f64 = (0..3).map(|j| row[j] * v[j]).sum();
                assert!((product - value * v[i]).abs() < 1e-14);
            }
        }
    }

    /// V = (x² − 1)² + y², whose hill is at x = 0.
    #[test]
    fn a_balance_on_a_hill_is_left() {
        let limits = Limits { unknowns: 2, scale: [1.0; 3], force: 1e-12, step: 0.1, noise: 1e-14, iterations: 100 };
        let solution = newton([0.0, 0.3, 0.0], &limits, &mut |x: &[f64; 3]| Balance {
            residual: [-4.0 * x[0] * (x[0] * x[0] - 1.0), -2.0 * x[1], 0.0],
            tangent: [[12.0 * x[0] * x[0] - 4.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0; 3]],
            potential: None,
            with: (),
        });
        assert!(solution.converged && (solution.x[0].abs() - 1.0).abs() < 1e-9 && solution.x[1].abs() < 1e-9);
    }
}
