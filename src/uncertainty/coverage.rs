//! Effective degrees of freedom and coverage factors. Called wherever a standard uncertainty is expanded.

use crate::statistics::student_quantile;

/// The coverage probability of `k = 2` for a normal distribution, erf(√2).
pub const COVERAGE: f64 = 0.954_499_736_103_641_6;

/// Effective degrees of freedom ν of a combined uncertainty u: 1 / ν = Σ w_i² / ν_i for independent inputs, and
/// 1 / √ν = Σ |w_i| / √ν_i otherwise; at least 1, and infinite where every ν_i is.
///
/// `shares` are w_i = a_i Σ_j r_ij a_j / u² with a_i = c_i u_i; `dofs` are ν_i. To first order δu / u = Σ w_i δu_i / u_i, and the
/// standard deviation of δu_i / u_i is 1 / √(2 ν_i). Independent estimates u_i give the Welch-Satterthwaite formula (JCGM
/// 100:2008, clause G.4.1); for dependent ones 1 / √ν is at most the second sum, so that ν is a lower bound.
#[must_use]
pub fn effective_dof(shares: &[f64], dofs: &[f64], independent: bool) -> f64 {
    let terms = shares.iter().zip(dofs).map(|(share, dof)| share.abs() / dof.sqrt());
    let relative: f64 = if independent {
        terms.map(|term| term * term).sum()
    } else {
        let sum: f64 = terms.sum();
        sum * sum
    };
    (1.0 / relative).max(1.0)
}

/// The coverage factor k for 95.45 %: Student's t at `dof` degrees of freedom, rounded down to a whole number of at least 1
/// (JCGM 100:2008, clause G.6.4); 2 for infinite ones.
#[must_use]
pub fn coverage_factor(dof: f64) -> f64 {
    if dof.is_finite() { student_quantile(0.5 + 0.5 * COVERAGE, whole_dof(dof)) } else { 2.0 }
}

/// Degrees of freedom rounded down to a whole number of at least 1 (clause G.6.4); 9 less the rounding errors of the
/// shares stay 9.
pub(super) fn whole_dof(dof: f64) -> f64 {
    (dof * (1.0 + 1e-9)).floor().max(1.0)
}
