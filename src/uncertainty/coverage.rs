//! Effective degrees of freedom and coverage factors. Called wherever a standard uncertainty is expanded; it knows no
//! inputs but their contributions.

use crate::statistics::student_quantile;

/// The coverage probability of `k = 2` for a normal distribution, erf(√2).
pub const COVERAGE: f64 = 0.954_499_736_103_641_6;

/// The Welch-Satterthwaite formula: ν_eff = u⁴ / Σ (c_i u_i)⁴ / ν_i for independent contributions c_i u_i; infinite
/// where every ν_i is. Influence: JCGM 100:2008, clause G.4.1.
#[must_use]
pub fn effective_dof(combined: f64, contributions: &[f64], dofs: &[f64]) -> f64 {
    if combined == 0.0 {
        return f64::INFINITY;
    }
    let sum: f64 = contributions
        .iter()
        .zip(dofs)
        .map(|(contribution, dof)| {
            let share = contribution / combined;
            share * share * share * share / dof
        })
        .sum();
    1.0 / sum
}

/// The coverage factor k of 95.45 %: 2, or Student's t at `dof` degrees of freedom, rounded down to a whole number.
#[must_use]
pub fn coverage_factor(dof: f64) -> f64 {
    if dof.is_finite() { student_quantile(0.5 + 0.5 * COVERAGE, whole_dof(dof)) } else { 2.0 }
}

/// Degrees of freedom rounded down to a whole number of at least 1 (clause G.6.4); rounding of the binary number before
/// does not make 9 of them 8.
pub(super) fn whole_dof(dof: f64) -> f64 {
    (dof * (1.0 + 1e-12)).floor().max(1.0)
}
