//! The result of the propagation: a value with its standard uncertainty, its coverage factor and the contribution of each
//! input. Decision rules and reports read it.

use super::Influence;
use super::coverage::whole_dof;
use crate::deviation::DeviationKind;
use crate::judge::bound::Range;
use crate::judge::rule::{Ends, Tail};
use crate::judge::{Interval, LimitTarget, Stack};
use crate::statistics::student_quantile;

pub(super) const KINDS: usize = DeviationKind::ALL.len();

/// The contribution of one input to a result's uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputContribution {
    /// The input.
    pub source: Influence,
    /// Its standard uncertainty u(x_i), mm or degrees.
    pub standard: f64,
    /// Its degrees of freedom ν_i.
    pub dof: f64,
    /// Sensitivity c_i = ∂y/∂x_i, mm per mm or mm per degree.
    pub sensitivity: f64,
    /// Contribution c_i u(x_i), mm.
    pub contribution_mm: f64,
    /// Share (c_i u(x_i))² / u²(y); `None` if u(y) is 0. With correlations the shares do not add up to 1.
    pub share: Option<f64>,
}

/// The linear result for one ΔCD.
#[derive(Debug, Clone, PartialEq)]
pub struct Linear {
    /// The value y, mm.
    pub value_mm: f64,
    /// Standard uncertainty u(y), mm.
    pub standard_mm: f64,
    /// Effective degrees of freedom ν_eff; `None` where correlated contributions cancel, so that u(y) is not known.
    pub dof: Option<f64>,
    /// Coverage factor k; `None` where ν_eff is.
    pub coverage_factor: Option<f64>,
    /// The contribution of each input on which this result depends.
    pub contributions: Vec<InputContribution>,
    /// Errors so near to 0 that their ΔCD, a magnitude, is not linear: u(y) is an upper bound there.
    pub folded: Vec<DeviationKind>,
}

impl Linear {
    /// The expanded uncertainty U = k u(y), mm; `None` where u(y) is not known.
    #[must_use]
    pub fn expanded_mm(&self) -> Option<f64> {
        Some(self.coverage_factor? * self.standard_mm)
    }

    /// The half-width of the interval that contains the value with `probability`; `None` where u(y) is not known.
    #[must_use]
    pub fn half_width_mm(&self, probability: f64) -> Option<f64> {
        Some(self.standard_mm * student_quantile(0.5 + 0.5 * probability, whole_dof(self.dof?)))
    }
}

/// How the ends of one error's range alone depend on its ΔCD.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EndWeights {
    /// ∂(end)/∂ΔCD.
    pub slope: Range,
    /// The most that uncertain sizes of the pair add to the standard uncertainty, mm.
    pub of_pair_mm: Range,
    /// The fewest degrees of freedom of these sizes; contributions that add up as magnitudes have at least as many.
    pub pair_dof: f64,
}

/// The uncertainty of one result.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    /// Standard uncertainty u, mm.
    pub standard_mm: f64,
    /// Coverage factor k; `None` where the degrees of freedom are.
    pub coverage_factor: Option<f64>,
    /// Variance from the measurement of the errors alone, without that of the gear, which is the same for all parts; mm².
    pub gauge_mm2: f64,
    /// The number of errors so near to zero that the result is not linear; `None` if there are any and inputs are correlated.
    pub folds: Option<u8>,
    /// The number of other strokes of a mesh that may have this end.
    pub rivals: u32,
    /// Effective degrees of freedom; `None` where correlated contributions cancel, so that u is not known.
    pub dof: Option<f64>,
}

impl Spread {
    const fn tail(&self) -> Tail {
        Tail { dof: self.dof, folds: self.folds, rivals: self.rivals }
    }
}

/// The uncertainties of a part's results.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spreads {
    /// The uncertainty of each error's ΔCD, in the order of the errors.
    pub errors: [Spread; KINDS],
    /// How the ends of each error's range alone depend on its ΔCD.
    pub weights: [EndWeights; KINDS],
    /// The uncertainty of the lower end of the combination that is judged.
    pub lower: Spread,
    /// The uncertainty of its upper end.
    pub upper: Spread,
    /// The correlation of both ends.
    pub end_correlation: f64,
}

impl Spreads {
    /// A result with its uncertainty: that of the error with this index alone, or that of the combination.
    #[must_use]
    pub fn ends(&self, error: Option<usize>, result: Interval) -> Ends {
        let (lower_standard_mm, upper_standard_mm, correlation) = match error {
            Some(index) => {
                let (EndWeights { slope, of_pair_mm, .. }, of_error) =
                    (self.weights[index], self.errors[index].standard_mm);
                let standard = slope.with(of_pair_mm, |slope, of_pair| slope.abs() * of_error + of_pair);
                let both = slope.lower * slope.upper;
                (standard.lower, standard.upper, if both == 0.0 { 0.0 } else { both.signum() })
            }
            None => (self.lower.standard_mm, self.upper.standard_mm, self.end_correlation),
        };
        let (lower_mm, upper_mm) = (result.lower.mm(), result.upper.mm());
        let [lower_tail, upper_tail] = match error {
            Some(index) => {
                let tail = self.errors[index].tail();
                [Tail { dof: tail.dof.map(|dof| dof.min(self.weights[index].pair_dof)), ..tail }; 2]
            }
            None => [self.lower.tail(), self.upper.tail()],
        };
        Ends { lower_mm, upper_mm, lower_standard_mm, upper_standard_mm, correlation, lower_tail, upper_tail }
    }
}

/// The linear results for a part.
#[derive(Debug, Clone, PartialEq)]
pub struct Propagation {
    /// The result for each error's ΔCD, in the order of the errors.
    pub errors: Vec<(DeviationKind, Linear)>,
    /// The result for the lower end of the combination that is judged.
    pub lower: Linear,
    /// The result for its upper end.
    pub upper: Linear,
    /// The combination.
    pub stack: Stack,
    /// The uncertainties alone.
    pub spreads: Spreads,
}

impl Propagation {
    /// The result that a limit on `target` judges, with its uncertainty.
    #[must_use]
    pub fn ends(&self, target: LimitTarget, result: Interval) -> Option<Ends> {
        let error = match target {
            LimitTarget::CenterDistance => None,
            LimitTarget::Error(kind) => Some(self.errors.iter().position(|(other, _)| *other == kind)?),
        };
        Some(self.spreads.ends(error, result))
    }
}
