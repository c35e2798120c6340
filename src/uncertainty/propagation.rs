//! The linear propagation: the laws' derivatives, weighted as the errors are combined, times the standard uncertainties.
//! Called for single parts, and by the batch engine for many parts of one gear; what depends on the gear alone is computed
//! once.
//!
//! Every law is a gain, which follows from the gear, times a function of the error alone:
//!
//! ```text
//! ∂ΔCD/∂x = ΔCD · ∂(ln gain)/∂x        for the gear's x
//! ```
//!
//! The ends of the combination are those of the bound, which has kinks and jumps: a size on some teeth moves the upper end only
//! if it is positive, and an end jumps where one more tooth begins to carry. The slope of an end by an error is therefore the
//! steepest within its uncertainty ([`WITHIN`]); by a size of the pair it is the difference over its standard uncertainty.

use std::sync::OnceLock;

use super::coverage::{coverage_factor, effective_dof, whole_dof};
use super::gear::{Gear, NO_RANGE, OF_LAWS, VariedError, VariedPair, ends, own_slope, range_alone};
use super::result::KINDS;
use super::{
    EndWeights, FOLD, InputContribution, Linear, Propagation, Spread, Spreads, TeethSensitivity, Uncertainties,
    Uncertainty, UncertaintyError,
};
use crate::deviation::{DeviationKind, Extent};
use crate::formula::over_pin::OverPin;
use crate::formula::{Influence, Law, Model, PartDeviation, Sensitivity};
use crate::judge::Stack;
use crate::judge::bound::{Basis, ExtendedError, Range};

/// Degrees of freedom up to which coverage factors are kept.
const KEPT_FACTORS: u32 = 256;

/// A part with uncertain quantities: its errors and, if the nominal over-roller measure is computed, the inputs of that.
#[derive(Debug, Clone, Copy)]
pub struct UncertainPart<'a> {
    /// The errors.
    pub errors: &'a [PartDeviation],
    /// The inputs of the nominal over-roller measure, if that is computed.
    pub over_pin: Option<&'a OverPin>,
    /// The model of the formulas.
    pub model: Model,
    /// How the errors are combined.
    pub stack: Stack,
    /// What is known of the pair.
    pub basis: &'a Basis,
    /// The derivatives by uncertain values, for teeth that are known one by one.
    pub teeth: &'a [TeethSensitivity],
}

/// Propagates `uncertainties` linearly through the laws of a part: u²(y) = Σ_i Σ_j c_i c_j u(x_i) u(x_j) r_ij with
/// c_i = ∂y/∂x_i (JCGM 100:2008, clause 5.2.2); lengths in mm, angles in degrees.
///
/// # Errors
/// [`UncertaintyError::Domain`] if a law or one of its derivatives has no value there.
pub fn propagate(part: &UncertainPart<'_>, uncertainties: &Uncertainties) -> Result<Propagation, UncertaintyError> {
    Propagator::new(part, uncertainties.clone())?.propagation(part.errors)
}

/// One error of a part.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point {
    /// The error, mm or degrees.
    pub error: f64,
    /// Its ΔCD, mm.
    pub delta_cd_mm: f64,
}

/// The derivatives of one error's ΔCD.
#[derive(Debug, Clone)]
struct Derivatives {
    law: Law,
    /// Its extent.
    extent: Extent,
    /// The error for the bound; `None` if it is too large for a bound.
    varied: Option<VariedError>,
    /// The input that is the error itself, and its standard uncertainty, mm or degrees.
    own: Option<(usize, f64)>,
    /// ∂(ln ΔCD)/∂x of each input.
    relative: Vec<f64>,
    /// ∂ΔCD/∂x of the inputs of a computed nominal value.
    constant: Vec<f64>,
}

/// The derivatives of a result by all inputs.
#[derive(Debug, Clone, Default)]
struct Gradient {
    by_input: Vec<f64>,
    /// The errors so near zero that the result is not linear.
    folded: Vec<DeviationKind>,
}

/// The gradients of a part's results.
#[derive(Default)]
struct Gradients {
    errors: Vec<Gradient>,
    lower: Gradient,
    upper: Gradient,
}

/// The propagation for many parts of one gear: what depends on the gear alone is computed once.
#[derive(Debug, Clone)]
pub struct Propagator {
    uncertainties: Uncertainties,
    derivatives: Vec<Derivatives>,
    model: Model,
    stack: Stack,
    /// Degrees of freedom of the inputs; empty where all are infinite.
    dofs: Vec<f64>,
    /// Coverage factors by whole degrees of freedom, if any are finite; each is computed when it is first needed.
    factors: Vec<OnceLock<f64>>,
    basis: Basis,
    /// The gear data of the errors' laws.
    gear: Gear,
    /// The pair, if its geometry is known, with one uncertain size off at a time.
    pairs: Vec<VariedPair>,
    /// The derivative of the constant ΔCD of a pair of unknown geometry by each input.
    own_slopes: Vec<f64>,
    /// The derivatives by uncertain values, for teeth that are known one by one.
    teeth: Vec<TeethSensitivity>,
}

/// Step of an input for a derivative, mm or degrees. Ends are linear nearly everywhere, so the step may be large.
const VARIED_BY: f64 = 1e-6;

/// Distances from a value, in standard uncertainties, over which slopes of the ends are taken. A jump or a kink within the
/// distance increases the slope, so that the interval (k = 1 to 2.5) contains the end beyond it.
pub(crate) const WITHIN: [f64; 6] = [1.0, -1.0, 1.7, -1.7, 2.5, -2.5];

/// The steepest slope of each end within the uncertainty of a value: `at`, the slope at the value, unless `over`, the slope
/// over a distance, is clearly steeper.
fn steepest_within(standard: f64, at: Range, over: impl Fn(f64) -> Range) -> Range {
    /// The factor from which a slope is clearly steeper: ends that are combined in squares are slightly curved.
    const CLEARLY: f64 = 1.0 + 1e-3;
    let steeper = |slope: f64, other: f64| {
        if other.is_nan() || other.abs() > slope.abs() * CLEARLY + 1e-9 { other } else { slope }
    };
    let distances = WITHIN.iter().map(|so_many| so_many * standard).filter(|distance| *distance != 0.0);
    distances.fold(at, |slope, distance| slope.with(over(distance), steeper))
}

impl Propagator {
    /// Prepares the propagation for parts with the kinds of errors of this one, of any values.
    ///
    /// # Errors
    /// [`UncertaintyError::Domain`] if a derivative has no value.
    pub fn new(part: &UncertainPart<'_>, uncertainties: Uncertainties) -> Result<Self, UncertaintyError> {
        let derivatives =
            part.errors.iter().map(|error| Derivatives::new(error, part, &uncertainties)).collect::<Result<_, _>>()?;
        let inputs = uncertainties.inputs();
        let finite = inputs.iter().any(|(_, uncertainty)| uncertainty.dof.is_finite());
        let dofs = if finite { inputs.iter().map(|(_, uncertainty)| uncertainty.dof).collect() } else { Vec::new() };
        let kept = if finite { KEPT_FACTORS } else { 0 };
        let factors = (0..kept).map(|_| OnceLock::new()).collect();
        Ok(Self {
            own_slopes: inputs.iter().map(|(source, _)| own_slope(*source, part)).collect(),
            pairs: VariedPair::all(part.basis, &uncertainties),
            uncertainties,
            derivatives,
            model: part.model,
            stack: part.stack,
            dofs,
            factors,
            basis: part.basis.clone(),
            gear: Gear::new(part.errors, part.over_pin, part.basis),
            teeth: part.teeth.to_vec(),
        })
    }

    /// The uncertainties.
    #[must_use]
    pub fn uncertainties(&self) -> &Uncertainties {
        &self.uncertainties
    }

    /// The uncertainties of one part; `points` are its errors.
    #[must_use]
    pub fn spreads(&self, points: &[Point]) -> Spreads {
        self.spreads_of(points, &self.gradients(points))
    }

    fn spreads_of(&self, points: &[Point], gradients: &Gradients) -> Spreads {
        let (mut lower, mut upper) = (self.spread(&gradients.lower), self.spread(&gradients.upper));
        for TeethSensitivity { rivals: [at_lower, at_upper], .. } in &self.teeth {
            (lower.rivals, upper.rivals) = (lower.rivals.max(*at_lower), upper.rivals.max(*at_upper));
        }
        let end_correlation = self.end_correlation(gradients, &lower, &upper);
        let mut spreads = Spreads { lower, upper, end_correlation, ..Spreads::default() };
        for (index, (of, point)) in self.derivatives.iter().zip(points).enumerate() {
            spreads.errors[index] = self.spread(&gradients.errors[index]);
            spreads.weights[index] = self.weights(of, point.error);
        }
        spreads
    }

    /// The uncertainties of one part with the contribution of each input.
    ///
    /// # Errors
    /// [`UncertaintyError::Domain`] if a ΔCD or their combination has no value.
    pub fn propagation(&self, errors: &[PartDeviation]) -> Result<Propagation, UncertaintyError> {
        let point = |error: &PartDeviation| {
            Ok(Point { error: error.value().base(), delta_cd_mm: error.delta_cd(self.model)?.mm() })
        };
        let points = errors.iter().map(point).collect::<Result<Vec<_>, UncertaintyError>>()?;
        let gradients = self.gradients(&points);
        let slopes = gradients.lower.by_input.iter().zip(&gradients.upper.by_input);
        let unknown = |((lower, upper), _): &((&f64, &f64), _)| !(lower.is_finite() && upper.is_finite());
        if let Some((_, (source, _))) = slopes.zip(self.uncertainties.inputs()).find(unknown) {
            return Err(UncertaintyError::NoBound(*source));
        }
        let ends = self.ends(&values(&points), None, &self.basis);
        let each = errors.iter().zip(&points).zip(&gradients.errors);
        Ok(Propagation {
            errors: each
                .map(|((error, point), gradient)| (error.kind(), self.linear(point.delta_cd_mm, gradient)))
                .collect(),
            lower: self.linear(ends.lower, &gradients.lower),
            upper: self.linear(ends.upper, &gradients.upper),
            stack: self.stack,
            spreads: self.spreads_of(&points, &gradients),
        })
    }

    fn gradients(&self, points: &[Point]) -> Gradients {
        let mut gradients = Gradients::default();
        for (of, point) in self.derivatives.iter().zip(points) {
            let relative = of.constant.iter().zip(&of.relative);
            let by_input = relative.map(|(constant, relative)| constant + point.delta_cd_mm * relative).collect();
            let mut gradient = Gradient { by_input, folded: Vec::new() };
            let kind = of.law.kind();
            if let Some((own, standard)) = of.own {
                gradient.by_input[own] += of.law.slope(point.error, self.model);
                if point.error.abs() < FOLD * standard {
                    gradient.folded.extend((!kind.always_acts()).then_some(kind));
                    // a size on some of the teeth acts with one sign only
                    let at_ends = !(kind.always_acts() && of.extent == Extent::All);
                    gradients.lower.folded.extend(at_ends.then_some(kind));
                }
            }
            gradients.errors.push(gradient);
        }
        gradients.upper.folded.clone_from(&gradients.lower.folded);
        let values = values(points);
        let centre = self.ends(&values, None, &self.basis);
        for (input, (source, _)) in self.uncertainties.inputs().iter().enumerate() {
            let slopes = self.by_input(input, &values, centre);
            let teeth = self.teeth.iter().find(|teeth| teeth.source == *source);
            let teeth = teeth.map_or(Range::default(), |teeth| teeth.slope);
            let slope = slopes.with(teeth, |slope, teeth| slope + self.own_slopes[input] + teeth);
            gradients.lower.by_input.push(slope.lower);
            gradients.upper.by_input.push(slope.upper);
        }
        gradients
    }

    fn weights(&self, of: &Derivatives, value: f64) -> EndWeights {
        let alone = |value: f64, basis: &Basis| {
            of.varied.map_or(NO_RANGE, |varied| range_alone(&varied.with_value(value), basis))
        };
        let here = alone(value, &self.basis);
        let over = |step: f64| alone(value + step, &self.basis).with(here, |off, here| (off - here) / step);
        let away = if value < 0.0 { -VARIED_BY } else { VARIED_BY };
        let slope = steepest_within(self.standard(of), over(away), over);
        let of_law = of.law.slope(value, self.model);
        let slope = Range { lower: slope.lower / of_law, upper: slope.upper / of_law };
        let mut weights = EndWeights { slope, of_pair_mm: Range::default(), pair_dof: f64::INFINITY };
        for pair in &self.pairs {
            let steepest = pair.steepest(here, |basis| alone(value, basis));
            let Uncertainty { standard, dof, .. } = pair.uncertainty;
            weights.of_pair_mm = weights.of_pair_mm.with(steepest, |sum, slope| sum + slope.abs() * standard);
            if weights.of_pair_mm != Range::default() {
                weights.pair_dof = weights.pair_dof.min(dof);
            }
        }
        weights
    }

    /// The derivatives of both ends by one input.
    fn by_input(&self, input: usize, values: &[f64], centre: Range) -> Range {
        let over = |step: f64| {
            self.ends(values, Some((input, step)), &self.basis).with(centre, |off, centre| (off - centre) / step)
        };
        let at = over(VARIED_BY).with(over(-VARIED_BY), |above, below| 0.5 * (above + below));
        let (source, uncertainty) = self.uncertainties.inputs()[input];
        let follows = |of: &Derivatives| of.own.is_some_and(|(own, _)| own == input) || of.constant[input] != 0.0;
        let of_error = self.derivatives.iter().any(follows);
        let slope = if of_error { steepest_within(uncertainty.standard, at, over) } else { at };
        let Some(pair) = self.pairs.iter().find(|pair| pair.source == source) else { return slope };
        slope.with(pair.steepest(centre, |basis| self.ends(values, None, basis)), |slope, of_pair| slope + of_pair)
    }

    /// Upper bound of the standard uncertainty of an error: that of its value plus that of its nominal value.
    fn standard(&self, of: &Derivatives) -> f64 {
        let inputs = self.uncertainties.inputs().iter().zip(&of.constant);
        let of_nominal = inputs.map(|((_, uncertainty), slope)| (slope * uncertainty.standard).abs());
        of.own.map_or(0.0, |(_, standard)| standard) + of_nominal.sum::<f64>()
    }

    /// Both ends of the combination for errors of these values, with `off`: an input and its deviation.
    fn ends(&self, values: &[f64], off: Option<(usize, f64)>, basis: &Basis) -> Range {
        let mut gear = self.gear;
        let shifted = off.and_then(|(input, step)| {
            let (source, _) = self.uncertainties.inputs()[input];
            gear.of_source(source).filter(|_| OF_LAWS.contains(&source)).map(|value| *value += step)
        });
        let mut errors = [ExtendedError::NONE; KINDS];
        for ((error, of), value) in errors.iter_mut().zip(&self.derivatives).zip(values) {
            let Some(varied) = &of.varied else { return NO_RANGE };
            let own = off.map_or(0.0, |(input, step)| {
                let is_own = of.own.is_some_and(|(own, _)| own == input);
                (of.constant[input] + if is_own { 1.0 } else { 0.0 }) * step
            });
            *error = match shifted {
                Some(()) => varied.at(value + own, &gear),
                None => varied.with_value(value + own),
            };
        }
        ends(self.stack, &errors[..self.derivatives.len()], basis)
    }

    /// c_i u(x_i) of every input.
    fn contributions(&self, by_input: &[f64]) -> Vec<f64> {
        let inputs = by_input.iter().zip(self.uncertainties.inputs());
        inputs.map(|(derivative, (_, uncertainty))| derivative * uncertainty.standard).collect()
    }

    /// The variance of a result, mm²; infinite where a derivative is not known.
    fn variance(&self, by_input: &[f64]) -> f64 {
        let contributions = self.contributions(by_input);
        let variance = self.uncertainties.covariance(&contributions, &contributions);
        if variance.is_nan() { f64::INFINITY } else { variance.max(0.0) }
    }

    fn spread(&self, gradient: &Gradient) -> Spread {
        let standard_mm = self.variance(&gradient.by_input).sqrt();
        let mut gauge = gradient.by_input.clone();
        for (derivative, (source, _)) in gauge.iter_mut().zip(self.uncertainties.inputs()) {
            if !matches!(source, Influence::Error(_)) {
                *derivative = 0.0;
            }
        }
        let dof = self.dof(&self.contributions(&gradient.by_input), standard_mm);
        let is_correlated = || (0..gradient.by_input.len()).any(|input| self.uncertainties.correlated(input));
        Spread {
            standard_mm,
            coverage_factor: self.coverage_factor(dof),
            gauge_mm2: self.variance(&gauge),
            folds: (gradient.folded.is_empty() || !is_correlated()).then_some(gradient.folded.len() as u8),
            rivals: 0,
            dof: dof.map(whole_dof),
        }
    }

    fn linear(&self, value_mm: f64, gradient: &Gradient) -> Linear {
        let variance = self.variance(&gradient.by_input);
        let standard_mm = variance.sqrt();
        let contributions = self.contributions(&gradient.by_input);
        let dof = self.dof(&contributions, standard_mm);
        let inputs = self.uncertainties.inputs().iter().zip(&gradient.by_input).zip(&contributions);
        let contributions = inputs
            .filter(|((_, derivative), _)| **derivative != 0.0)
            .map(|(((source, uncertainty), sensitivity), contribution)| InputContribution {
                source: *source,
                standard: uncertainty.standard,
                dof: uncertainty.dof,
                sensitivity: *sensitivity,
                contribution_mm: *contribution,
                share: (variance > 0.0).then(|| contribution * contribution / variance),
            })
            .collect();
        Linear {
            value_mm,
            standard_mm,
            dof,
            coverage_factor: self.coverage_factor(dof),
            contributions,
            folded: gradient.folded.clone(),
        }
    }

    /// Effective degrees of freedom; `None` where correlated contributions cancel, so that u is not known.
    fn dof(&self, contributions: &[f64], standard_mm: f64) -> Option<f64> {
        /// The smallest u, as a share of the sum of all contributions: correlation coefficients have no more digits.
        const CANCELLED: f64 = 1e-6;
        let is_correlated = self.uncertainties.correlates(contributions);
        let all: f64 = contributions.iter().map(|contribution| contribution.abs()).sum();
        if is_correlated && standard_mm <= CANCELLED * all {
            return None;
        }
        if self.dofs.is_empty() || all == 0.0 {
            return Some(f64::INFINITY);
        }
        let terms = self.uncertainties.terms(contributions);
        let shares: Vec<_> = terms.iter().map(|term| term / (standard_mm * standard_mm)).collect();
        Some(effective_dof(&shares, &self.dofs, !is_correlated))
    }

    fn coverage_factor(&self, dof: Option<f64>) -> Option<f64> {
        dof.map(|dof| match self.factors.get(whole_dof(dof) as usize) {
            Some(kept) => *kept.get_or_init(|| coverage_factor(dof)),
            None => coverage_factor(dof),
        })
    }

    fn end_correlation(&self, gradients: &Gradients, lower: &Spread, upper: &Spread) -> f64 {
        let scale = lower.standard_mm * upper.standard_mm;
        if scale == 0.0 || !scale.is_finite() {
            return 0.0;
        }
        let (a, b) = (self.contributions(&gradients.lower.by_input), self.contributions(&gradients.upper.by_input));
        (self.uncertainties.covariance(&a, &b) / scale).clamp(-1.0, 1.0)
    }
}

impl Derivatives {
    fn new(
        error: &PartDeviation,
        part: &UncertainPart<'_>,
        uncertainties: &Uncertainties,
    ) -> Result<Self, UncertaintyError> {
        let (law, kind) = (error.law(), error.kind());
        let inputs = uncertainties.inputs();
        let index = |source: Influence| inputs.iter().position(|(other, _)| *other == source);
        let (mut relative, mut constant) = (vec![0.0; inputs.len()], vec![0.0; inputs.len()]);
        for (input, derivative) in law.relative_sensitivities(part.model) {
            if let Some(at) = index(input) {
                relative[at] += derivative;
            }
        }
        if let (DeviationKind::RackOverRoller, Some(over_pin)) = (kind, part.over_pin) {
            for Sensitivity { input, value } in over_pin.sensitivities()? {
                if let (Some(at), Some(value)) = (index(input), value) {
                    // M − M_nom falls as M_nom rises
                    constant[at] -= value;
                }
            }
        }
        let own = index(Influence::Error(kind)).map(|own| (own, inputs[own].1.standard));
        Ok(Self { law, extent: error.extent(), varied: VariedError::new(error), own, relative, constant })
    }
}

fn values(points: &[Point]) -> Vec<f64> {
    points.iter().map(|point| point.error).collect()
}
