//! The uncertainties of a part's inputs with their correlations, checked. Read by the linear propagation and by Monte Carlo.

use thiserror::Error;

use super::{Influence, Uncertainty};
use crate::quantity::DomainError;

/// The uncertainties of a part's inputs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Uncertainties {
    inputs: Vec<(Influence, Uncertainty)>,
    /// Correlation coefficients, a full matrix by rows.
    correlation: Vec<f64>,
    /// The Cholesky factor of the matrix, by rows; empty where nothing is correlated.
    factor: Vec<f64>,
}

/// An assumption of a verdict where nothing is stated: of uncertainties as in the GUM, of the gear its defaults.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unstated {
    /// Degrees of freedom ν are infinite.
    Freedom,
    /// Values are independent: r = 0.
    Correlation,
    /// Sizes of the gear are exact.
    Size,
    /// The flanks of a pinion that a rack cutter would undercut are involutes down to the base circle.
    RootForm,
    /// Helix angles and the profile shift are 0.
    Zero,
    /// The rack cannot roll.
    FixedRack,
    /// Teeth have their nominal thickness.
    Thickness,
    /// Flanks have no crowning, relief and slope.
    Form,
    /// An error is on the teeth that are usual for its kind.
    Extent,
}

impl Unstated {
    /// Whether it is a default of the gear: facts list these, the sentence of a pass does not.
    #[must_use]
    pub const fn is_default(self) -> bool {
        matches!(self, Self::Zero | Self::FixedRack | Self::Thickness | Self::Form | Self::Extent)
    }
}

/// Why uncertainties are impossible.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum UncertaintyError {
    /// A standard uncertainty that is negative or not finite.
    #[error("the standard uncertainty of {} is {value}; it must be 0 or more", .source_of.key())]
    Negative {
        /// The quantity.
        source_of: Influence,
        /// Its standard uncertainty.
        value: f64,
    },
    /// Too few degrees of freedom.
    #[error("{} has {dof} degrees of freedom; at least 1 is needed", .source_of.key())]
    Freedom {
        /// The quantity.
        source_of: Influence,
        /// Its degrees of freedom.
        dof: f64,
    },
    /// A quantity with two uncertainties.
    #[error("{} has two uncertainties", .0.key())]
    Twice(Influence),
    /// A correlation of a quantity that has no uncertainty.
    #[error("{} is correlated but has no uncertainty", .0.key())]
    Unknown(Influence),
    /// A correlation coefficient beyond ±1, or of a quantity with itself.
    #[error("the correlation of {} and {} is {coefficient}; it must be between -1 and 1, of two different quantities", .of.0.key(), .of.1.key())]
    Coefficient {
        /// The two quantities.
        of: (Influence, Influence),
        /// The coefficient.
        coefficient: f64,
    },
    /// Correlations that contradict each other.
    #[error("the correlations contradict each other at {}: their matrix is not positive semidefinite", .0.key())]
    Contradiction(Influence),
    /// A quantity beside whose value ΔCD has no bound.
    #[error("no bound of ΔCD is known where {} is off by its uncertainty", .0.key())]
    NoBound(Influence),
    /// A ΔCD or a derivative outside its domain.
    #[error(transparent)]
    Domain(#[from] DomainError),
}

impl Uncertainties {
    /// Checks and combines uncertainties and the correlations between pairs of them.
    ///
    /// # Errors
    /// [`UncertaintyError`] if a number is outside its domain, a quantity has two uncertainties, a correlated one has none, or
    /// the correlation matrix is not positive semidefinite.
    pub fn new(
        inputs: Vec<(Influence, Uncertainty)>,
        correlations: &[(Influence, Influence, f64)],
    ) -> Result<Self, UncertaintyError> {
        let n = inputs.len();
        for (index, (source, uncertainty)) in inputs.iter().enumerate() {
            if !(uncertainty.standard >= 0.0 && uncertainty.standard.is_finite()) {
                return Err(UncertaintyError::Negative { source_of: *source, value: uncertainty.standard });
            }
            if uncertainty.dof.is_nan() || uncertainty.dof < 1.0 {
                return Err(UncertaintyError::Freedom { source_of: *source, dof: uncertainty.dof });
            }
            if inputs[..index].iter().any(|(other, _)| other == source) {
                return Err(UncertaintyError::Twice(*source));
            }
        }
        let mut correlation = vec![0.0; n * n];
        for i in 0..n {
            correlation[i * n + i] = 1.0;
        }
        for &(a, b, coefficient) in correlations {
            let index =
                |source| inputs.iter().position(|(other, _)| *other == source).ok_or(UncertaintyError::Unknown(source));
            let (i, j) = (index(a)?, index(b)?);
            if i == j || !(-1.0..=1.0).contains(&coefficient) {
                return Err(UncertaintyError::Coefficient { of: (a, b), coefficient });
            }
            correlation[i * n + j] = coefficient;
            correlation[j * n + i] = coefficient;
        }
        let factor = if correlations.iter().any(|(_, _, r)| *r != 0.0) {
            cholesky(&correlation, n).map_err(|row| UncertaintyError::Contradiction(inputs[row].0))?
        } else {
            Vec::new()
        };
        Ok(Self { inputs, correlation, factor })
    }

    /// Whether no quantity has an uncertainty above 0.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.inputs.iter().all(|(_, uncertainty)| uncertainty.standard == 0.0)
    }

    /// The quantities and their uncertainties.
    #[must_use]
    pub fn inputs(&self) -> &[(Influence, Uncertainty)] {
        &self.inputs
    }

    /// The uncertainty of a quantity, if it has one.
    #[must_use]
    pub fn of(&self, source: Influence) -> Option<&Uncertainty> {
        self.inputs.iter().find(|(other, _)| *other == source).map(|(_, uncertainty)| uncertainty)
    }

    /// The Cholesky factor of the correlation matrix, by rows; `None` where nothing is correlated.
    #[must_use]
    pub fn correlation_factor(&self) -> Option<&[f64]> {
        (!self.factor.is_empty()).then_some(self.factor.as_slice())
    }

    /// Whether an input, by index, is correlated with another one.
    pub(super) fn correlated(&self, i: usize) -> bool {
        let n = self.inputs.len();
        (0..n).any(|j| j != i && self.correlation[i * n + j] != 0.0)
    }

    /// Whether two of the inputs that contribute to a result are correlated.
    pub(super) fn correlates(&self, contributions: &[f64]) -> bool {
        let n = self.inputs.len();
        let counts = |i: usize, j: usize| contributions[i] != 0.0 && contributions[j] != 0.0;
        !self.factor.is_empty() && (0..n).any(|i| (0..i).any(|j| counts(i, j) && self.correlation[i * n + j] != 0.0))
    }

    /// The terms a_i Σ_j r_ij a_j of contributions a_i = c_i u_i; their sum is u².
    pub(super) fn terms(&self, contributions: &[f64]) -> Vec<f64> {
        let n = self.inputs.len();
        let sum = |i: usize| (0..n).map(|j| contributions[j] * self.correlation[i * n + j]).sum::<f64>();
        contributions.iter().enumerate().map(|(i, contribution)| contribution * sum(i)).collect()
    }

    /// The quantities that are correlated with another one.
    pub fn correlated_sources(&self) -> impl Iterator<Item = Influence> + '_ {
        self.inputs.iter().enumerate().filter(|(i, _)| self.correlated(*i)).map(|(_, (source, _))| *source)
    }

    /// Σ_i Σ_j a_i b_j r_ij for contributions a_i = c_i u_i of two results.
    pub(super) fn covariance(&self, a: &[f64], b: &[f64]) -> f64 {
        let n = self.inputs.len();
        if self.factor.is_empty() {
            return a.iter().zip(b).map(|(a, b)| a * b).sum();
        }
        (0..n).map(|i| (0..n).map(|j| a[i] * b[j] * self.correlation[i * n + j]).sum::<f64>()).sum()
    }
}

/// The lower triangular L with L Lᵀ = `matrix`, or the row at which it is not positive semidefinite.
fn cholesky(matrix: &[f64], n: usize) -> Result<Vec<f64>, usize> {
    /// Rounding may leave a pivot of a singular matrix this far below 0.
    const ROUNDING: f64 = 1e-12;
    let mut factor = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let dot: f64 = (0..j).map(|k| factor[i * n + k] * factor[j * n + k]).sum();
            let rest = matrix[i * n + j] - dot;
            if i == j {
                if rest < -ROUNDING {
                    return Err(i);
                }
                factor[i * n + i] = rest.max(0.0).sqrt();
            } else if factor[j * n + j] > ROUNDING.sqrt() {
                factor[i * n + j] = rest / factor[j * n + j];
            } else if rest.abs() > ROUNDING.sqrt() {
                return Err(i);
            }
        }
    }
    Ok(factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCES: [Influence; 3] = [Influence::NormalPressureAngle, Influence::FaceWidth, Influence::RackHelixAngle];

    fn correlated([r_01, r_02, r_12]: [f64; 3]) -> Result<Uncertainties, UncertaintyError> {
        let [a, b, c] = SOURCES;
        let inputs = SOURCES.map(|source| (source, Uncertainty::standard(0.1))).to_vec();
        Uncertainties::new(inputs, &[(a, b, r_01), (a, c, r_02), (b, c, r_12)])
    }

    fn near(value: f64, expected: f64) {
        assert!((value - expected).abs() < 1e-15, "{value} {expected}");
    }

    /// Contributions of 2, 3 and −5: sums of nine products.
    #[test]
    fn covariances_take_each_pair_with_its_own_coefficient() {
        let of = correlated([0.5, -0.25, 0.125]).unwrap();
        let a = [2.0, 3.0, -5.0];
        near(of.covariance(&a, &a), 38.0 + 2.0 * (0.5 * 6.0 + 0.25 * 10.0 - 0.125 * 15.0));
        near(of.covariance(&a, &[1.0, 0.0, 0.0]), 2.0 + 0.5 * 3.0 + 0.25 * 5.0);
        let alone = correlated([0.0; 3]).unwrap();
        near(alone.covariance(&a, &a), 38.0);
    }

    #[test]
    fn the_factor_times_its_transpose_is_the_matrix() {
        let coefficients = [0.5, -0.25, 0.625];
        let of = correlated(coefficients).unwrap();
        let factor = of.correlation_factor().unwrap();
        let product = |i: usize, j: usize| (0..3).map(|k| factor[i * 3 + k] * factor[j * 3 + k]).sum::<f64>();
        for (i, j, expected) in [(0, 1, 0.5), (0, 2, -0.25), (1, 2, 0.625), (0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0)] {
            near(product(i, j), expected);
        }
        assert_eq!([factor[1], factor[2], factor[5]], [0.0; 3]);
        assert_eq!(correlated([0.0; 3]).unwrap().correlation_factor(), None);
    }

    /// Two quantities that are the same have the same correlation with a third one.
    #[test]
    fn correlations_that_contradict_each_other() {
        assert!(correlated([1.0, 0.5, 0.5]).is_ok());
        assert!(correlated([-1.0, 0.5, -0.5]).is_ok());
        for impossible in [[1.0, 0.5, -0.5], [1.0, 0.5, 0.0], [0.9, 0.9, 0.0]] {
            assert_eq!(correlated(impossible), Err(UncertaintyError::Contradiction(SOURCES[2])), "{impossible:?}");
        }
    }

    #[test]
    fn who_is_correlated_with_another() {
        let sources = |r| correlated(r).unwrap().correlated_sources().collect::<Vec<_>>();
        assert_eq!(sources([0.0, 0.0, 0.5]), SOURCES[1..]);
        assert_eq!(sources([0.0; 3]), []);
    }

    /// A pivot that rounding has left below 0 is 0, one further below is a contradiction.
    #[test]
    fn pivots_next_to_zero() {
        assert_eq!(cholesky(&[-1e-12], 1), Ok(vec![0.0]));
        assert_eq!(cholesky(&[-2e-12], 1), Err(0));
    }
}
