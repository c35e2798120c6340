//! Linear propagation for many parts of one gear: what [`propagate`](super::propagate) gives, as far as a table of
//! parts needs it, in a few hundred nanoseconds. Called by the batch engine; the values of a part come from its caller.
//!
//! Every formula is a gain, which follows from the gear, times a function of the error alone:
//!
//! ```text
//! ∂ΔCD/∂x = ΔCD · ∂(ln gain)/∂x        for the gear's x
//! ```
//!
//! so that the derivatives of one error of any size give those of all. Each result comes with a bound on what rounding
//! does to it, so that the caller knows which digits and verdicts are certain.

use super::coverage::{coverage_factor, effective_dof, whole_dof};
use super::propagation::{over_pin_source, source_of, stack_weight};
use super::{FOLD, Linear, Part, Propagation, Source, Uncertainties, UncertaintyError};
use crate::decision::Stack;
use crate::deviation::{ErrorKind, ErrorValue};
use crate::formula::over_pin::OverPin;
use crate::formula::{Model, PartFormula, Prepared, Sensitivity};
use crate::quantity::{Angle, Length};

const KINDS: usize = ErrorKind::ALL.len();

/// As many inputs as there are.
const INPUTS: usize = 13;

/// Rounding of sums of contributions in units of their magnitudes: some twenty operations here and as many in
/// [`propagate`](super::propagate).
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// How near to a whole number degrees of freedom may come before rounding decides which way they are rounded down.
const UNSURE_DOF: f64 = 1e-13;

/// Coverage factors are kept up to so many degrees of freedom.
const KEPT_FACTORS: usize = 256;

/// The uncertainty of one result.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    /// Standard uncertainty u, mm.
    pub standard_mm: f64,
    /// How far [`propagate`](super::propagate) may differ from it, mm.
    pub rounding_mm: f64,
    /// Coverage factor k.
    pub coverage_factor: f64,
    /// Variance from measuring the errors alone, mm²: what is uncertain about the gear is the same for all parts.
    pub gauge_mm2: f64,
    /// Whether an error is so near to zero that the result is not linear.
    pub folded: bool,
}

/// The uncertainties of a part's results.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spreads {
    /// Of each error's ΔCD, in the order of the formulas.
    pub errors: [Spread; KINDS],
    /// Of the lower end of the combination that is judged.
    pub lower: Spread,
    /// Of its upper end.
    pub upper: Spread,
    /// The correlation of both ends.
    pub end_correlation: f64,
    /// Whether every coverage factor and every `folded` is certain; where not, [`propagate`](super::propagate)
    /// decides.
    pub certain: bool,
}

/// One error of a part.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point {
    /// The error, mm or degrees.
    pub error: f64,
    /// Its ΔCD, mm.
    pub delta_cd_mm: f64,
}

/// What the uncertainty of one kind of error's ΔCD follows from.
#[derive(Debug, Clone)]
struct Terms {
    kind: ErrorKind,
    formula: Prepared,
    /// The input that is the error itself.
    own: Option<usize>,
    /// u of the error itself, mm or degrees.
    own_standard: f64,
    /// u(x) ∂(ln ΔCD)/∂x of each input.
    relative: [f64; INPUTS],
    /// u(x) ∂ΔCD/∂x of inputs of a computed nominal value, mm.
    constant: [f64; INPUTS],
}

/// The uncertainties of a gear's parts, ready for many of them; see the module.
#[derive(Debug, Clone)]
pub struct Propagator {
    uncertainties: Uncertainties,
    terms: Vec<Terms>,
    stack: Stack,
    /// Degrees of freedom of the inputs; empty where all are infinite.
    dofs: Vec<f64>,
    factors: Vec<f64>,
    /// Whether each input is an error, which is measured anew for each part.
    measured: [bool; INPUTS],
}

/// u(x) ∂y/∂x of every input of a result, and their magnitudes before anything cancels.
#[derive(Clone, Copy)]
struct Contributions {
    each: [f64; INPUTS],
    magnitudes: [f64; INPUTS],
}

impl Contributions {
    const NONE: Self = Self { each: [0.0; INPUTS], magnitudes: [0.0; INPUTS] };

    fn add(&mut self, weight: f64, other: &Self, inputs: usize) {
        for index in 0..inputs {
            self.each[index] += weight * other.each[index];
            self.magnitudes[index] += weight.abs() * other.magnitudes[index];
        }
    }
}

impl Propagator {
    /// Prepares the uncertainties of parts whose errors have these formulas. `over_pin` is what the nominal measure of
    /// the over-roller error is computed from, if it is.
    ///
    /// # Errors
    /// [`UncertaintyError::Domain`] if a derivative has no value.
    pub fn new(
        formulas: &[Prepared],
        over_pin: Option<&OverPin>,
        uncertainties: Uncertainties,
        stack: Stack,
    ) -> Result<Self, UncertaintyError> {
        let inputs = uncertainties.inputs();
        let index = |source: Source| inputs.iter().position(|(other, _)| *other == source);
        let mut terms = Vec::with_capacity(formulas.len());
        for formula in formulas {
            let kind = formula.kind();
            let own = index(Source::Error(kind));
            let mut of_kind = Terms {
                kind,
                formula: formula.clone(),
                own,
                own_standard: own.map_or(0.0, |own| inputs[own].1.standard),
                relative: [0.0; INPUTS],
                constant: [0.0; INPUTS],
            };
            for (source, relative) in relative_sensitivities(formula.formula(), formula.model())? {
                if let Some(at) = index(source) {
                    of_kind.relative[at] += relative * inputs[at].1.standard;
                }
            }
            if let (ErrorKind::RackOverRoller, Some(over_pin)) = (kind, over_pin) {
                for Sensitivity { input, value } in over_pin.sensitivities()? {
                    if let (Some(at), Some(value)) = (over_pin_source(input).and_then(index), value) {
                        // M − M_nom falls as the nominal rises
                        of_kind.constant[at] -= value * inputs[at].1.standard;
                    }
                }
            }
            terms.push(of_kind);
        }
        let finite = inputs.iter().any(|(_, uncertainty)| uncertainty.dof.is_finite());
        let dofs = if finite { inputs.iter().map(|(_, uncertainty)| uncertainty.dof).collect() } else { Vec::new() };
        #[expect(clippy::cast_precision_loss, reason = "small whole numbers")]
        let factors =
            if finite { (0..KEPT_FACTORS).map(|dof| coverage_factor(dof as f64)).collect() } else { Vec::new() };
        let mut measured = [false; INPUTS];
        for (measured, (source, _)) in measured.iter_mut().zip(inputs) {
            *measured = matches!(source, Source::Error(_));
        }
        Ok(Self { uncertainties, terms, stack, dofs, factors, measured })
    }

    /// What is uncertain.
    #[must_use]
    pub fn uncertainties(&self) -> &Uncertainties {
        &self.uncertainties
    }

    /// The uncertainties of one part, of which `points` has an error for each formula.
    #[must_use]
    pub fn spreads(&self, points: &[Point]) -> Spreads {
        let count = self.uncertainties.inputs().len();
        let mut spreads = Spreads { certain: true, ..Spreads::default() };
        let mut each = [Contributions::NONE; KINDS];
        let mut squares = 0.0;
        for (index, (terms, point)) in self.terms.iter().zip(points).enumerate() {
            let contributions = &mut each[index];
            for input in 0..count {
                let value = terms.constant[input] + point.delta_cd_mm * terms.relative[input];
                contributions.each[input] = value;
                contributions.magnitudes[input] =
                    terms.constant[input].abs() + (point.delta_cd_mm * terms.relative[input]).abs();
            }
            if let Some(own) = terms.own {
                let value = terms.formula.slope(point.error) * terms.own_standard;
                contributions.each[own] += value;
                contributions.magnitudes[own] += value.abs();
            }
            let nearest = FOLD * terms.own_standard;
            let pushing = !terms.kind.always_acts();
            let (folded, certain) = below(point.error.abs(), nearest);
            squares += point.delta_cd_mm * point.delta_cd_mm;
            let mut spread = self.spread(contributions, &mut spreads.certain);
            spread.folded = pushing && folded;
            spreads.certain &= certain || !pushing;
            spreads.errors[index] = spread;
        }
        let mut ends = [Contributions::NONE; 2];
        let mut folded = [false; 2];
        for (index, (terms, point)) in self.terms.iter().zip(points).enumerate() {
            let spread = spreads.errors[index];
            let (near_zero, certain) = below(point.delta_cd_mm.abs(), FOLD * spread.standard_mm);
            let folds = self.stack != Stack::Range;
            for (is_upper, end) in [false, true].into_iter().zip(&mut ends) {
                let weight = stack_weight(self.stack, is_upper, terms.kind, false, point.delta_cd_mm, squares);
                let Some(weight) = weight else { continue };
                end.add(weight, &each[index], count);
                folded[usize::from(is_upper)] |= spread.folded || (folds && near_zero);
                spreads.certain &= certain || !folds;
            }
        }
        spreads.lower = self.spread(&ends[0], &mut spreads.certain);
        spreads.upper = self.spread(&ends[1], &mut spreads.certain);
        (spreads.lower.folded, spreads.upper.folded) = (folded[0], folded[1]);
        let scale = spreads.lower.standard_mm * spreads.upper.standard_mm;
        let covariance = self.uncertainties.covariance(&ends[0].each[..count], &ends[1].each[..count]);
        spreads.end_correlation = if scale > 0.0 { (covariance / scale).clamp(-1.0, 1.0) } else { 0.0 };
        spreads
    }

    /// The uncertainties of a part as `propagation` has them, with what measuring contributes to each.
    ///
    /// # Errors
    /// [`UncertaintyError::Domain`] if a ΔCD has no value.
    pub fn exact(&self, part: &Part<'_>, propagation: &Propagation) -> Result<Spreads, UncertaintyError> {
        let mut points = [Point::default(); KINDS];
        for (point, error) in points.iter_mut().zip(part.errors) {
            let value = match error.value() {
                ErrorValue::Length(length) => length.mm(),
                ErrorValue::Angle(angle) => angle.degrees(),
            };
            *point = Point { error: value, delta_cd_mm: error.delta_cd(part.model)?.mm() };
        }
        let mut spreads = self.spreads(&points[..part.errors.len().min(KINDS)]);
        let exact = |spread: &mut Spread, linear: &Linear| {
            *spread = Spread {
                standard_mm: linear.standard_mm,
                rounding_mm: 0.0,
                coverage_factor: linear.coverage_factor,
                gauge_mm2: spread.gauge_mm2,
                folded: !linear.folded.is_empty(),
            };
        };
        for (spread, (_, linear)) in spreads.errors.iter_mut().zip(&propagation.errors) {
            exact(spread, linear);
        }
        exact(&mut spreads.lower, &propagation.lower);
        exact(&mut spreads.upper, &propagation.upper);
        spreads.end_correlation = propagation.end_correlation;
        spreads.certain = true;
        Ok(spreads)
    }

    fn spread(&self, contributions: &Contributions, certain: &mut bool) -> Spread {
        let count = self.uncertainties.inputs().len();
        let each = &contributions.each[..count];
        let variance = self.uncertainties.covariance(each, each).max(0.0);
        let standard_mm = variance.sqrt();
        let magnitudes = &contributions.magnitudes[..count];
        let largest = self.uncertainties.absolute_covariance(magnitudes);
        let rounding = ROUNDING * largest;
        // |√(v + δ) − √v| is δ/(2√v), and never above √δ
        let rounding_mm = if largest == 0.0 { 0.0 } else { rounding / standard_mm.max(rounding.sqrt()) };
        let mut gauge = [0.0; INPUTS];
        for (gauge, (value, measured)) in gauge.iter_mut().zip(each.iter().zip(&self.measured)) {
            *gauge = if *measured { *value } else { 0.0 };
        }
        let gauge_mm2 = self.uncertainties.covariance(&gauge[..count], &gauge[..count]).max(0.0);
        let coverage_factor = self.coverage_factor(standard_mm, each, certain);
        Spread { standard_mm, rounding_mm, coverage_factor, gauge_mm2, folded: false }
    }

    fn coverage_factor(&self, standard_mm: f64, each: &[f64], certain: &mut bool) -> f64 {
        let finite = |index: usize| self.dofs.get(index).is_some_and(|dof| dof.is_finite());
        if self.dofs.is_empty() {
            return 2.0;
        }
        if (0..each.len()).any(|i| each[i] != 0.0 && finite(i) && self.uncertainties.correlated(i)) {
            return 2.0;
        }
        let dof = effective_dof(standard_mm, each, &self.dofs);
        if !dof.is_finite() {
            return 2.0;
        }
        let whole = whole_dof(dof);
        // rounding may lead to the other side of a whole number
        *certain &= whole == whole_dof(dof * (1.0 - UNSURE_DOF)) && whole == whole_dof(dof * (1.0 + UNSURE_DOF));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number of at least 1; saturates"
        )]
        let kept = self.factors.get(whole as usize);
        kept.copied().unwrap_or_else(|| coverage_factor(dof))
    }
}

/// Whether a magnitude is below a bound, and whether that is certain in spite of rounding.
fn below(magnitude: f64, bound: f64) -> (bool, bool) {
    (magnitude < bound, (magnitude - bound).abs() > ROUNDING * bound || magnitude == bound)
}

/// ∂(ln ΔCD)/∂x for the gear's x in a formula: the same for every error, so it is taken at one.
fn relative_sensitivities(formula: &PartFormula, model: Model) -> Result<Vec<(Source, f64)>, UncertaintyError> {
    let sample = match formula.kind() {
        ErrorKind::RackLead => Angle::from_degrees(0.1).map(ErrorValue::Angle),
        _ => Length::from_mm(0.1).map(ErrorValue::Length),
    };
    let Some(error) = formula.of(&sample.map_err(crate::quantity::DomainError::from)?) else { return Ok(Vec::new()) };
    let delta_cd = error.delta_cd(model)?.mm();
    let sensitivities = error.sensitivities(model)?;
    let of_gear = sensitivities.into_iter().filter_map(|Sensitivity { input, value }| {
        let source = source_of(formula.kind(), input)?;
        (!matches!(source, Source::Error(_))).then_some((source, value? / delta_cd))
    });
    Ok(of_gear.collect())
}

#[cfg(test)]
mod tests;
