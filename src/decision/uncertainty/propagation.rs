//! The linear propagation itself: the formulas' derivatives, weighted as the errors are combined, times the standard
//! uncertainties. Called for single parts; [`Propagator`](super::Propagator) does the same for many parts of one gear.

use super::coverage::{coverage_factor, effective_dof};
use super::{FOLD, InputContribution, Linear, Propagation, Source, Uncertainties, UncertaintyError};
use crate::decision::{Combined, Stack, Term};
use crate::deviation::ErrorKind;
use crate::formula::over_pin::OverPin;
use crate::formula::{Input, Model, PartError, Prepared, Sensitivity};
use crate::quantity::DomainError;

/// What the uncertainties of a part's inputs are about: its errors and, if the nominal of the over-roller measure is
/// computed, from what.
#[derive(Debug, Clone, Copy)]
pub struct Part<'a> {
    /// The errors.
    pub errors: &'a [PartError],
    /// The inputs of the over-roller error's nominal, if that is computed.
    pub over_pin: Option<&'a OverPin>,
    /// The model of the formulas.
    pub model: Model,
    /// How the errors are combined.
    pub stack: Stack,
}

/// Derivatives of one ΔCD by all inputs, in the order of the inputs.
struct Gradient {
    kind: ErrorKind,
    value_mm: f64,
    derivatives: Vec<f64>,
    /// Whether the formula folds this error and it is near zero.
    folded: bool,
    /// Whether the value is a permissible deviation, which acts either way.
    is_tolerance: bool,
}

/// Propagates `uncertainties` through the formulas of a part, linearly.
///
/// # Errors
/// [`UncertaintyError::Domain`] if a formula or one of its derivatives has no value there.
pub fn propagate(part: &Part<'_>, uncertainties: &Uncertainties) -> Result<Propagation, UncertaintyError> {
    let gradients: Vec<Gradient> =
        part.errors.iter().map(|error| gradient(error, part, uncertainties)).collect::<Result<_, _>>()?;
    let errors = gradients
        .iter()
        .map(|gradient| {
            let folded = if gradient.folded { vec![gradient.kind] } else { Vec::new() };
            (gradient.kind, linear(uncertainties, gradient.value_mm, &gradient.derivatives, folded))
        })
        .collect();
    let terms: Vec<_> = part
        .errors
        .iter()
        .map(|error| {
            let delta_cd = error.delta_cd(part.model)?;
            Ok(Term { kind: error.kind(), delta_cd, is_tolerance: error.is_tolerance() })
        })
        .collect::<Result<_, DomainError>>()?;
    let combined = Combined::of(&terms).map_err(DomainError::from)?;
    let (lower, upper) = combined.interval(part.stack);
    let ends = [(false, &lower), (true, &upper)].map(|(is_upper, value)| {
        let (derivatives, folded) = end(part.stack, is_upper, &gradients, uncertainties);
        linear(uncertainties, value.mm(), &derivatives, folded)
    });
    let [lower, upper] = ends;
    let by_input = |result: &Linear| {
        let of = |source: Source| result.contributions.iter().find(|c| c.source == source);
        let inputs = uncertainties.inputs().iter();
        inputs.map(|(source, _)| of(*source).map_or(0.0, |c| c.contribution_mm)).collect::<Vec<_>>()
    };
    let covariance = uncertainties.covariance(&by_input(&lower), &by_input(&upper));
    let scale = lower.standard_mm * upper.standard_mm;
    let end_correlation = if scale > 0.0 { (covariance / scale).clamp(-1.0, 1.0) } else { 0.0 };
    Ok(Propagation { errors, lower, upper, stack: part.stack, end_correlation })
}

/// The derivatives of one end of the combination, and what makes it not linear.
fn end(
    stack: Stack,
    is_upper: bool,
    gradients: &[Gradient],
    uncertainties: &Uncertainties,
) -> (Vec<f64>, Vec<ErrorKind>) {
    let mut sum = vec![0.0; uncertainties.inputs().len()];
    let mut folded = Vec::new();
    let squares: f64 = gradients.iter().map(|gradient| gradient.value_mm * gradient.value_mm).sum();
    for gradient in gradients {
        let u = contribution_of(uncertainties, &gradient.derivatives);
        // these combinations fold what the formula does not
        let near_zero = gradient.value_mm.abs() < FOLD * u;
        let Some(weight) =
            stack_weight(stack, is_upper, gradient.kind, gradient.is_tolerance, gradient.value_mm, squares)
        else {
            continue;
        };
        for (sum, derivative) in sum.iter_mut().zip(&gradient.derivatives) {
            *sum += weight * derivative;
        }
        if gradient.folded || (stack != Stack::Range && near_zero) {
            folded.push(gradient.kind);
        }
    }
    (sum, folded)
}

/// ∂(end of the combination)/∂ΔCD of one error; `None` if that end does not follow from it. `squares` is the sum of the
/// squares of all ΔCD, mm².
pub(super) fn stack_weight(
    stack: Stack,
    is_upper: bool,
    kind: ErrorKind,
    is_tolerance: bool,
    value_mm: f64,
    squares: f64,
) -> Option<f64> {
    let sign = if value_mm < 0.0 { -1.0 } else { 1.0 };
    let weight = match stack {
        Stack::Range if is_tolerance && kind.always_acts() => return Some(if is_upper { sign } else { -sign }),
        Stack::Range => return (is_upper || kind.always_acts()).then_some(1.0),
        Stack::WorstCase => sign,
        Stack::Rss if squares > 0.0 => value_mm / squares.sqrt(),
        Stack::Rss => 1.0,
    };
    Some(if is_upper { weight } else { -weight })
}

fn contribution_of(uncertainties: &Uncertainties, derivatives: &[f64]) -> f64 {
    let terms = contributions(uncertainties, derivatives);
    uncertainties.covariance(&terms, &terms).max(0.0).sqrt()
}

fn contributions(uncertainties: &Uncertainties, derivatives: &[f64]) -> Vec<f64> {
    uncertainties.inputs().iter().zip(derivatives).map(|((_, u), c)| c * u.standard).collect()
}

fn linear(uncertainties: &Uncertainties, value_mm: f64, derivatives: &[f64], folded: Vec<ErrorKind>) -> Linear {
    let terms = contributions(uncertainties, derivatives);
    let variance = uncertainties.covariance(&terms, &terms).max(0.0);
    let standard_mm = variance.sqrt();
    let dofs: Vec<_> = uncertainties.inputs().iter().map(|(_, uncertainty)| uncertainty.dof).collect();
    let correlated = (0..terms.len()).any(|i| terms[i] != 0.0 && dofs[i].is_finite() && uncertainties.correlated(i));
    let dof = (!correlated).then(|| effective_dof(standard_mm, &terms, &dofs));
    let coverage_factor = coverage_factor(dof.unwrap_or(f64::INFINITY));
    let contributions = uncertainties
        .inputs()
        .iter()
        .zip(derivatives)
        .zip(&terms)
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
    Linear { value_mm, standard_mm, dof, coverage_factor, contributions, folded }
}

fn gradient(error: &PartError, part: &Part<'_>, uncertainties: &Uncertainties) -> Result<Gradient, UncertaintyError> {
    let kind = error.kind();
    let mut by_source: Vec<(Source, f64)> = Vec::new();
    let mut at_kink = false;
    for Sensitivity { input, value } in error.sensitivities(part.model)? {
        let Some(source) = source_of(kind, input) else { continue };
        let value = if let Some(value) = value {
            value
        } else {
            at_kink = true;
            // the slope beside the kink
            Prepared::new(&error.formula(), part.model).slope(0.0)
        };
        by_source.push((source, value));
    }
    if let (ErrorKind::RackOverRoller, Some(over_pin)) = (kind, part.over_pin) {
        // M − M_nom falls as the nominal rises
        for Sensitivity { input, value } in over_pin.sensitivities()? {
            if let (Some(source), Some(value)) = (over_pin_source(input), value) {
                by_source.push((source, -value));
            }
        }
    }
    let derivatives = uncertainties
        .inputs()
        .iter()
        .map(|(source, _)| by_source.iter().filter(|(of, _)| of == source).map(|(_, value)| value).sum())
        .collect();
    let magnitude = match error.largest() {
        PartError::RackPitch(value, _) | PartError::PinionPitch(value, _) => Some(value.mm().abs()),
        PartError::RackLead(value, _) => Some(value.degrees().abs()),
        PartError::RackOverRoller(_) | PartError::PinionRadial(_) | PartError::Within(_) => None,
    };
    let u = uncertainties.of(Source::Error(kind)).map_or(0.0, |uncertainty| uncertainty.standard);
    let folded = u > 0.0 && (at_kink || magnitude.is_some_and(|magnitude| magnitude < FOLD * u));
    Ok(Gradient {
        kind,
        value_mm: error.delta_cd(part.model)?.mm(),
        derivatives,
        folded,
        is_tolerance: error.is_tolerance(),
    })
}

pub(super) fn source_of(kind: ErrorKind, input: Input) -> Option<Source> {
    match input {
        Input::Error => Some(Source::Error(kind)),
        Input::NormalPressureAngle => Some(Source::NormalPressureAngle),
        Input::HelixAngle if kind == ErrorKind::PinionPitch => Some(Source::PinionHelixAngle),
        Input::HelixAngle => Some(Source::RackHelixAngle),
        Input::FaceWidth => Some(Source::FaceWidth),
        _ => None,
    }
}

pub(super) fn over_pin_source(input: Input) -> Option<Source> {
    match input {
        Input::NormalModule => Some(Source::NormalModule),
        Input::NormalPressureAngle => Some(Source::NormalPressureAngle),
        Input::ToothThickness => Some(Source::ToothThickness),
        Input::Datum => Some(Source::Datum),
        Input::PinDiameter => Some(Source::Roller),
        _ => None,
    }
}
