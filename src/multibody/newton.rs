//! Newton's method for two or three unknowns with a line search. Called by both implicit runs; knows no mechanics
//! beyond forces and their tangent.
//!
//! The equations are the balance of forces r(x) = 0 with the tangent K = −∂r/∂x; near a solution r is monotone, so along a
//! Newton direction d the power r·d falls to zero. A step is shortened while it overshoots, so the method does not
//! cycle where contacts open and close.

/// Forces that are out of balance, with their tangent.
#[derive(Debug, Clone, Copy)]
pub(super) struct Balance<T> {
    pub(super) residual: [f64; 3],
    pub(super) tangent: [[f64; 3]; 3],
    /// Whatever else the caller wants of the solution.
    pub(super) with: T,
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

/// Steps below this are rounding, mm.
const SMALLEST: f64 = 2e-14;

/// Gaussian elimination of n ≤ 3 equations with pivots on the diagonal; `None` if one is not positive.
#[allow(clippy::needless_range_loop)] // matrices read as in the books
pub(super) fn solve(mut k: [[f64; 3]; 3], mut r: [f64; 3], n: usize) -> Option<[f64; 3]> {
    for i in 0..n {
        if k[i][i] <= 0.0 || !k[i][i].is_finite() {
            return None;
        }
        for j in i + 1..n {
            let factor = k[j][i] / k[i][i];
            for l in i..n {
                k[j][l] -= factor * k[i][l];
            }
            r[j] -= factor * r[i];
        }
    }
    for i in (0..n).rev() {
        for l in i + 1..n {
            r[i] -= k[i][l] * r[l];
        }
        r[i] /= k[i][i];
    }
    Some(r)
}

/// Solves `balance(x).residual = 0` from `x`.
pub(super) fn newton<T: Copy>(
    mut x: [f64; 3],
    limits: &Limits,
    mut balance: impl FnMut(&[f64; 3]) -> Balance<T>,
) -> Solution<T> {
    let n = limits.unknowns;
    let scaled = |b: &Balance<T>| {
        let r: [f64; 3] = std::array::from_fn(|i| if i < n { b.residual[i] / limits.scale[i] } else { 0.0 });
        let k: [[f64; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| b.tangent[i][j] / (limits.scale[i] * limits.scale[j])));
        (r, k)
    };
    let norm = |v: &[f64; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut here = balance(&x);
    let mut iterations = 0;
    loop {
        let (r, k) = scaled(&here);
        let size = norm(&r);
        let done = |x, here: &Balance<T>, iterations, converged| Solution {
            x,
            with: here.with,
            iterations,
            residual: size,
            converged,
        };
        if size <= limits.force {
            return done(x, &here, iterations, true);
        }
        if iterations >= limits.iterations || !size.is_finite() {
            return done(x, &here, iterations, false);
        }
        iterations += 1;
        let mut d = solve(k, r, n).filter(|d| dot(d, &r) > 0.0).unwrap_or_else(|| {
            // no contact holds some unknown: raise the diagonal until one step is as long as allowed
            let floor = size / limits.step;
            let mut k = k;
            for (i, row) in k.iter_mut().enumerate() {
                row[i] = row[i].max(0.0) + floor;
            }
            solve(k, r, n).filter(|d| dot(d, &r) > 0.0).unwrap_or(r.map(|v| v / floor))
        });
        let length = norm(&d);
        if length <= SMALLEST {
            return done(x, &here, iterations, true);
        }
        if length > limits.step {
            d = d.map(|v| v * (limits.step / length));
        }
        let power = dot(&r, &d);
        let mut share = 1.0;
        loop {
            let trial: [f64; 3] =
                std::array::from_fn(|i| if i < n { x[i] + share * d[i] / limits.scale[i] } else { x[i] });
            let next = balance(&trial);
            let (r_next, _) = scaled(&next);
            let power_next = dot(&r_next, &d);
            let overshot = power_next < -0.7 * power && norm(&r_next) > 0.7 * size;
            if !overshot || share < 1e-3 {
                x = trial;
                here = next;
                break;
            }
            share *= (power / (power - power_next)).clamp(0.1, 0.5);
        }
    }
}
