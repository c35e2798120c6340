#![doc = include_str!("method.md")]
//!
//! Called by the command line and the batch engine with the errors of a part and what is known of their uncertainty; it
//! draws nothing at random ([`monte_carlo`](super::monte_carlo) does) and judges nothing ([`rule`](super::rule) does).
//! Where a result is folded at zero, [`Linear::folded`] says so.

mod inputs;
mod prepared;
mod source;

pub use inputs::{Uncertainties, UncertaintyError};
pub use prepared::{Point, Propagator, Spread, Spreads};
pub use source::{Distribution, Source, Uncertainty};

use super::rule::Ends;
use super::statistics::student_quantile;
use super::{Combined, LimitTarget, Stack, Term};
use crate::deviation::ErrorKind;
use crate::formula::over_pin::OverPin;
use crate::formula::{Input, Model, PartError, Prepared, Sensitivity};
use crate::quantity::DomainError;

/// The coverage probability of `k = 2` for a normal distribution, erf(√2).
pub const COVERAGE: f64 = 0.954_499_736_103_641_6;

/// A magnitude whose error is nearer to zero than this many standard uncertainties is not linear: at three the ends of
/// a 95 % interval are off by 0.0005 u, which two digits do not show.
pub const FOLD: f64 = 3.0;

/// What one input contributes to a result's uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputContribution {
    /// The input.
    pub source: Source,
    /// Its standard uncertainty u(x_i), mm or degrees.
    pub standard: f64,
    /// Its degrees of freedom.
    pub dof: f64,
    /// c_i = ∂y/∂x_i, mm per mm or mm per degree.
    pub sensitivity: f64,
    /// c_i u(x_i), mm.
    pub contribution_mm: f64,
    /// (c_i u(x_i))² / u²(y); `None` if u(y) is 0. With correlations the shares do not add up to 1.
    pub share: Option<f64>,
}

/// The linear result for one ΔCD.
#[derive(Debug, Clone, PartialEq)]
pub struct Linear {
    /// The value y, mm.
    pub value_mm: f64,
    /// Standard uncertainty u(y), mm.
    pub standard_mm: f64,
    /// Effective degrees of freedom ν_eff; `None` where correlated inputs have finite ones, for which there is no
    /// formula.
    pub dof: Option<f64>,
    /// Coverage factor k.
    pub coverage_factor: f64,
    /// One per input that this result depends on.
    pub contributions: Vec<InputContribution>,
    /// Errors so near to zero that the magnitude of what they do is not linear: u(y) is an upper bound there.
    pub folded: Vec<ErrorKind>,
}

impl Linear {
    /// The expanded uncertainty U = k u(y), mm.
    #[must_use]
    pub fn expanded_mm(&self) -> f64 {
        self.coverage_factor * self.standard_mm
    }

    /// The half-width of the interval that contains the value with `probability`.
    #[must_use]
    pub fn half_width_mm(&self, probability: f64) -> f64 {
        let dof = self.dof.unwrap_or(f64::INFINITY);
        self.standard_mm * student_quantile(0.5 + 0.5 * probability, dof.floor().max(1.0))
    }
}

/// The linear results for a part.
#[derive(Debug, Clone, PartialEq)]
pub struct Propagation {
    /// Of each error's ΔCD, in the order of the errors.
    pub errors: Vec<(ErrorKind, Linear)>,
    /// Of the lower end of the combination that is judged.
    pub lower: Linear,
    /// Of its upper end: with the range, the sum of all.
    pub upper: Linear,
    /// The combination.
    pub stack: Stack,
    /// The correlation of both ends.
    pub end_correlation: f64,
}

impl Propagation {
    /// What a limit on `target` is held against, with its uncertainty.
    #[must_use]
    pub fn ends(&self, target: LimitTarget) -> Option<Ends> {
        match target {
            LimitTarget::CenterDistance => Some(Ends {
                lower_mm: self.lower.value_mm,
                upper_mm: self.upper.value_mm,
                lower_standard_mm: self.lower.standard_mm,
                upper_standard_mm: self.upper.standard_mm,
                correlation: self.end_correlation,
            }),
            LimitTarget::Error(kind) => {
                let (_, linear) = self.errors.iter().find(|(other, _)| *other == kind)?;
                Some(Ends::value(linear.value_mm, linear.standard_mm))
            }
        }
    }

    /// Errors whose ΔCD is so near to zero that nothing linear describes it.
    #[must_use]
    pub fn folded(&self) -> &[ErrorKind] {
        &self.upper.folded
    }
}

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
fn stack_weight(
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

/// The Welch-Satterthwaite formula: ν_eff = u⁴ / Σ (c_i u_i)⁴ / ν_i for independent contributions c_i u_i; infinite
/// where every ν_i is. Source: JCGM 100:2008, clause G.4.1.
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
fn whole_dof(dof: f64) -> f64 {
    (dof * (1.0 + 1e-12)).floor().max(1.0)
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

fn source_of(kind: ErrorKind, input: Input) -> Option<Source> {
    match input {
        Input::Error => Some(Source::Error(kind)),
        Input::NormalPressureAngle => Some(Source::NormalPressureAngle),
        Input::HelixAngle if kind == ErrorKind::PinionPitch => Some(Source::PinionHelixAngle),
        Input::HelixAngle => Some(Source::RackHelixAngle),
        Input::FaceWidth => Some(Source::FaceWidth),
        _ => None,
    }
}

fn over_pin_source(input: Input) -> Option<Source> {
    match input {
        Input::NormalModule => Some(Source::NormalModule),
        Input::NormalPressureAngle => Some(Source::NormalPressureAngle),
        Input::ToothThickness => Some(Source::ToothThickness),
        Input::Datum => Some(Source::Datum),
        Input::PinDiameter => Some(Source::Roller),
        _ => None,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::formula::{PinionPitch, RackLead, RackPitch};
    use crate::quantity::{Angle, Length};

    fn length(text: &str) -> Length {
        text.parse().unwrap()
    }

    fn angle(text: &str) -> Angle {
        text.parse().unwrap()
    }

    fn five(pitch: &str, lead: &str) -> Vec<PartError> {
        let (alpha, rack, pinion) = (angle("20"), angle("12"), angle("21"));
        vec![
            PartError::RackOverRoller(length("0.013")),
            PartError::RackPitch(length(pitch), RackPitch::new(&alpha, &rack).unwrap()),
            PartError::RackLead(angle(lead), RackLead::new(&alpha, &rack, &length("19.7")).unwrap()),
            PartError::PinionRadial(length("-0.004")),
            PartError::PinionPitch(length("0.009"), PinionPitch::new(&alpha, &pinion).unwrap()),
        ]
    }

    fn part(errors: &[PartError]) -> Part<'_> {
        Part { errors, over_pin: None, model: Model::Exact, stack: Stack::Range }
    }

    /// Every quantity that can be uncertain, in the order of a [`Scene`]'s values.
    pub(in crate::decision) const SOURCES: [Source; 13] = [
        Source::Error(ErrorKind::RackOverRoller),
        Source::Error(ErrorKind::RackPitch),
        Source::Error(ErrorKind::RackLead),
        Source::Error(ErrorKind::PinionRadial),
        Source::Error(ErrorKind::PinionPitch),
        Source::NormalPressureAngle,
        Source::RackHelixAngle,
        Source::PinionHelixAngle,
        Source::FaceWidth,
        Source::NormalModule,
        Source::Datum,
        Source::Roller,
        Source::ToothThickness,
    ];

    /// A part of which every quantity may change; mm and degrees.
    #[derive(Clone, Copy)]
    pub(in crate::decision) struct Scene {
        pub(in crate::decision) values: [f64; 13],
        pub(in crate::decision) thickness: bool,
        pub(in crate::decision) tolerances: bool,
        pub(in crate::decision) model: Model,
        pub(in crate::decision) stack: Stack,
    }

    impl Scene {
        pub(in crate::decision) const VALUES: [f64; 13] =
            [-0.013, 0.012, 0.0255, 0.004, -0.009, 20.0, 12.0, 21.0, 19.7, 2.5, 21.5, 5.0, 3.9];

        pub(in crate::decision) fn over_pin(&self) -> OverPin {
            let mm = |index: usize| Length::from_mm(self.values[index]).unwrap();
            OverPin {
                normal_module: mm(9),
                normal_pressure_angle: Angle::from_degrees(self.values[5]).unwrap(),
                tooth_thickness: self.thickness.then(|| mm(12)),
                pin_diameter: mm(11),
                datum: mm(10),
            }
        }

        /// Its errors; the measure over the roller stays what it is when its nominal value changes.
        pub(in crate::decision) fn errors(&self) -> Vec<PartError> {
            let mm = |index: usize| Length::from_mm(self.values[index]).unwrap();
            let degrees = |index: usize| Angle::from_degrees(self.values[index]).unwrap();
            let (alpha, rack, pinion) = (degrees(5), degrees(6), degrees(7));
            let nominal = Self { values: Self::VALUES, ..*self }.over_pin().measure().unwrap();
            let shift = &self.over_pin().measure().unwrap() - &nominal;
            let errors = vec![
                PartError::RackOverRoller(&mm(0) - &shift),
                PartError::RackPitch(mm(1), RackPitch::new(&alpha, &rack).unwrap()),
                PartError::RackLead(degrees(2), RackLead::new(&alpha, &rack, &mm(8)).unwrap()),
                PartError::PinionRadial(mm(3)),
                PartError::PinionPitch(mm(4), PinionPitch::new(&alpha, &pinion).unwrap()),
            ];
            let within = |error| if self.tolerances { PartError::Within(Box::new(error)) } else { error };
            errors.into_iter().map(within).collect()
        }

        /// ΔCD of each error, and the lower and upper end of all, mm.
        pub(in crate::decision) fn delta_cd(&self) -> Vec<f64> {
            let terms: Vec<_> = self
                .errors()
                .iter()
                .map(|error| {
                    let delta_cd = error.delta_cd(self.model).unwrap();
                    Term { kind: error.kind(), delta_cd, is_tolerance: error.is_tolerance() }
                })
                .collect();
            let (lower, upper) = Combined::of(&terms).unwrap().interval(self.stack);
            let each = terms.iter().map(|term| term.delta_cd.mm());
            each.chain([lower.mm(), upper.mm()]).collect()
        }

        pub(in crate::decision) fn all() -> impl Iterator<Item = Self> {
            let models = [Model::Exact, Model::Paper].into_iter();
            let stacks = move |model| [Stack::Range, Stack::WorstCase, Stack::Rss].map(|stack| (model, stack));
            models.flat_map(stacks).flat_map(|(model, stack)| {
                let scene = |thickness| Self { values: Self::VALUES, thickness, tolerances: !thickness, model, stack };
                [scene(true), scene(false)]
            })
        }
    }

    /// Each sensitivity of each result against the difference of two parts.
    #[test]
    fn sensitivities_are_those_of_differences() {
        for scene in Scene::all() {
            let inputs = SOURCES.map(|source| (source, Uncertainty::standard(1e-7))).to_vec();
            let (errors, over_pin) = (scene.errors(), scene.over_pin());
            let part = Part { errors: &errors, over_pin: Some(&over_pin), model: scene.model, stack: scene.stack };
            let linear = propagate(&part, &Uncertainties::new(inputs, &[]).unwrap()).unwrap();
            let results: Vec<_> =
                linear.errors.iter().map(|(_, linear)| linear).chain([&linear.lower, &linear.upper]).collect();
            for (index, source) in SOURCES.into_iter().enumerate() {
                let step = 1e-7 * scene.values[index].abs();
                let beside = |sign: f64| {
                    let mut beside = scene;
                    beside.values[index] += sign * step;
                    (beside.values[index], beside.delta_cd())
                };
                let ((from, low), (to, high)) = (beside(-1.0), beside(1.0));
                for (which, result) in results.iter().enumerate() {
                    let difference = (high[which] - low[which]) / (to - from);
                    let found = result.contributions.iter().find(|of| of.source == source);
                    let found = found.map_or(0.0, |of| of.sensitivity);
                    assert!(
                        (found - difference).abs() < 1e-8 + 1e-6 * difference.abs(),
                        "{:?} {:?} {source:?} {which}: {found} {difference}",
                        scene.model,
                        scene.stack
                    );
                }
            }
        }
    }

    /// The root of squares of nothing has the slope of a single error, so that the uncertainty is not lost.
    #[test]
    fn the_root_of_squares_at_zero() {
        let errors = [PartError::RackOverRoller(Length::ZERO)];
        let inputs = vec![(Source::Error(ErrorKind::RackOverRoller), Uncertainty::standard(0.001))];
        let rss = Part { stack: Stack::Rss, ..part(&errors) };
        let result = propagate(&rss, &Uncertainties::new(inputs, &[]).unwrap()).unwrap();
        assert_eq!((result.upper.standard_mm, result.lower.standard_mm), (0.001, 0.001));
        assert_eq!(result.end_correlation, -1.0);
    }

    /// Welch and Satterthwaite is for independent contributions: with a correlated one of finite degrees of freedom
    /// there is no ν_eff, for those results that depend on it.
    #[test]
    fn correlated_inputs_of_few_degrees_of_freedom_have_no_effective_one() {
        let errors = five("0.012", "0.0255");
        let (a, b) = (Source::Error(ErrorKind::RackOverRoller), Source::Error(ErrorKind::PinionRadial));
        let pitch = Source::Error(ErrorKind::RackPitch);
        let few = |dof| Uncertainty { dof, ..Uncertainty::standard(0.001) };
        let inputs = vec![(a, few(5.0)), (b, Uncertainty::standard(0.002)), (pitch, few(7.0))];
        let result = propagate(&part(&errors), &Uncertainties::new(inputs, &[(a, b, 0.5)]).unwrap()).unwrap();
        let dof = |index: usize| result.errors[index].1.dof;
        assert_eq!((dof(0), dof(3)), (None, Some(f64::INFINITY)));
        assert!((dof(1).unwrap() - 7.0).abs() < 1e-12);
        assert_eq!((result.upper.dof, result.upper.coverage_factor), (None, 2.0));
    }

    /// Exactly three standard uncertainties from zero is far enough, and what has no uncertainty does not fold.
    #[test]
    fn three_standard_uncertainties_are_far_enough() {
        let errors = [PartError::RackOverRoller(length("0.375"))];
        let worst = Part { stack: Stack::WorstCase, ..part(&errors) };
        let with = |u| Uncertainties::new(vec![(SOURCES[0], Uncertainty::standard(u))], &[]).unwrap();
        assert!(propagate(&worst, &with(0.125)).unwrap().folded().is_empty());
        assert!(!propagate(&worst, &with(0.126)).unwrap().folded().is_empty());
        let zero = five("0", "0");
        let result = propagate(&Part { stack: Stack::WorstCase, ..part(&zero) }, &with(0.001)).unwrap();
        assert_eq!(result.folded(), []);
    }

    #[test]
    fn the_end_gauge_of_jcgm_100_h1() {
        // JCGM 100:2008, H.1: contributions 25, 9.7, 2.9 and 16.6 nm with 18, 25.6, 50 and 2 degrees of freedom
        let (terms, dofs) = ([25.0, 9.7, 2.9, 16.6], [18.0, 25.6, 50.0, 2.0]);
        let u = terms.iter().map(|t| t * t).sum::<f64>().sqrt();
        assert_eq!(format!("{u:.0}"), "32");
        let dof = effective_dof(u, &terms, &dofs);
        assert_eq!(format!("{:.0}", dof.floor()), "16");
        let k = student_quantile(0.995, dof.floor());
        assert_eq!(format!("{k:.2}"), "2.92");
        assert_eq!(format!("{:.0}", k * u), "93");
    }

    #[test]
    fn contributions_add_up_in_squares() {
        let errors = five("0.012", "0.0255");
        let u = |standard| Uncertainty::standard(standard);
        let inputs = vec![
            (Source::Error(ErrorKind::RackOverRoller), u(0.0008)),
            (Source::Error(ErrorKind::RackPitch), u(0.0006)),
            (Source::Error(ErrorKind::RackLead), u(0.001)),
            (Source::NormalPressureAngle, u(0.05)),
            (Source::FaceWidth, u(0.1)),
        ];
        let result = propagate(&part(&errors), &Uncertainties::new(inputs, &[]).unwrap()).unwrap();
        let shares: f64 = result.upper.contributions.iter().filter_map(|c| c.share).sum();
        assert!((shares - 1.0).abs() < 1e-12);
        assert_eq!(result.upper.coverage_factor, 2.0);
        assert!(result.folded().is_empty());
        // the lower end is the over-roller and radial error alone
        assert!((result.lower.standard_mm - 0.0008).abs() < 1e-15);
        assert!((result.end_correlation - 0.0008 / result.upper.standard_mm).abs() < 1e-12);
        // the pitch error alone: cos 12° / (2 tan 20°) of its own, and its share of the pressure angle's
        let (_, pitch) = &result.errors[1];
        let gain = 0.978_147_600_733_805_6 / (2.0 * 0.363_970_234_266_202_4);
        let by_alpha = 0.012 * gain / (0.342_020_143_325_668_7 * 0.939_692_620_785_908_4) * 0.017_453_292_519_943_3;
        let (own, of_angle): (f64, f64) = (gain * 0.0006, by_alpha * 0.05);
        let expected = (own * own + of_angle * of_angle).sqrt();
        assert!((pitch.standard_mm / expected - 1.0).abs() < 1e-12);
    }

    #[test]
    fn correlations_add_or_cancel() {
        let errors = five("0.012", "0.0255");
        let (a, b) = (Source::Error(ErrorKind::RackOverRoller), Source::Error(ErrorKind::PinionRadial));
        let inputs = vec![(a, Uncertainty::standard(0.003)), (b, Uncertainty::standard(0.003))];
        for (r, expected) in [(1.0, 0.006), (0.0, 0.003 * 2.0_f64.sqrt()), (-1.0, 0.0)] {
            let uncertainties = Uncertainties::new(inputs.clone(), &[(a, b, r)]).unwrap();
            let result = propagate(&part(&errors), &uncertainties).unwrap();
            assert!((result.upper.standard_mm - expected).abs() < 1e-12, "{r}");
        }
        assert!(matches!(
            Uncertainties::new(inputs, &[(a, b, 1.5)]),
            Err(UncertaintyError::Coefficient { coefficient: 1.5, .. })
        ));
    }

    #[test]
    fn correlations_that_cannot_be_are_refused() {
        let sources = [ErrorKind::RackOverRoller, ErrorKind::PinionRadial, ErrorKind::RackPitch].map(Source::Error);
        let inputs = sources.map(|source| (source, Uncertainty::standard(0.001))).to_vec();
        let [a, b, c] = sources;
        let contradiction = Uncertainties::new(inputs.clone(), &[(a, b, 0.9), (b, c, 0.9), (a, c, -0.9)]);
        assert_eq!(contradiction, Err(UncertaintyError::Contradiction(c)));
        assert!(Uncertainties::new(inputs, &[(a, b, 1.0), (b, c, 1.0), (a, c, 1.0)]).is_ok());
    }

    #[test]
    fn near_zero_the_linear_result_says_that_it_is_none() {
        let u = 0.001;
        for (pitch, folded) in [("0", true), ("0.0029", true), ("-0.0029", true), ("0.0031", false), ("-0.0031", false)]
        {
            let errors = five(pitch, "0.0255");
            let inputs = vec![(Source::Error(ErrorKind::RackPitch), Uncertainty::standard(u))];
            let result = propagate(&part(&errors), &Uncertainties::new(inputs, &[]).unwrap()).unwrap();
            assert_eq!(result.folded().contains(&ErrorKind::RackPitch), folded, "{pitch}");
            // and is still an upper bound: the gain times u
            assert!((result.errors[1].1.standard_mm - u * 1.343_719_222_954_923).abs() < 1e-12, "{pitch}");
        }
        // the worst case folds signed errors too
        let errors = [PartError::RackOverRoller(length("0.0001"))];
        let inputs = vec![(Source::Error(ErrorKind::RackOverRoller), Uncertainty::standard(u))];
        let uncertainties = Uncertainties::new(inputs, &[]).unwrap();
        let worst = Part { stack: Stack::WorstCase, ..part(&errors) };
        assert!(!propagate(&worst, &uncertainties).unwrap().folded().is_empty());
        assert!(propagate(&part(&errors), &uncertainties).unwrap().folded().is_empty());
    }

    #[test]
    fn degrees_of_freedom_widen_the_interval() {
        let errors = [PartError::RackOverRoller(length("0.01"))];
        let four = Uncertainty { dof: 4.0, ..Uncertainty::standard(0.001) };
        let uncertainties = Uncertainties::new(vec![(Source::Error(ErrorKind::RackOverRoller), four)], &[]).unwrap();
        let result = propagate(&part(&errors), &uncertainties).unwrap().upper;
        assert_eq!(result.dof, Some(4.0));
        // JCGM 100:2008, Table G.2: 2.87
        assert_eq!(format!("{:.2}", result.coverage_factor), "2.87");
    }

    #[test]
    fn half_widths_and_expanded_uncertainties() {
        let near = |u: Uncertainty, expected: f64| assert!((u.standard - expected).abs() < 1e-15, "{u:?}");
        near(Uncertainty::half_width(0.003, Distribution::Rectangular), 0.003 / 3.0_f64.sqrt());
        near(Uncertainty::half_width(0.003, Distribution::Triangular), 0.003 / 6.0_f64.sqrt());
        near(Uncertainty::half_width(0.003, Distribution::Arcsine), 0.003 / 2.0_f64.sqrt());
        near(Uncertainty::expanded(0.003, 2.0), 0.0015);
    }

    #[test]
    fn what_does_not_reach_a_result_leaves_it_certain() {
        let errors = [PartError::PinionRadial(length("0.004"))];
        let inputs = vec![
            (Source::PinionHelixAngle, Uncertainty::standard(0.04)),
            (Source::Error(ErrorKind::PinionRadial), Uncertainty::standard(0.0)),
        ];
        let found = propagate(&part(&errors), &Uncertainties::new(inputs, &[]).unwrap()).unwrap();
        assert_eq!((found.lower.standard_mm, found.upper.standard_mm, found.end_correlation), (0.0, 0.0, 0.0));
        assert_eq!(found.lower.folded, []);
        // the error itself has a derivative, but no share of nothing
        let [only] = &found.upper.contributions[..] else { panic!("{:?}", found.upper.contributions) };
        assert_eq!((only.sensitivity, only.contribution_mm, only.share), (1.0, 0.0, None));
    }

    /// At no ΔCD, the derivative of a magnitude is that on the positive side.
    #[test]
    fn weights_at_zero() {
        let weight = |stack, is_upper, is_tolerance, value_mm, squares| {
            stack_weight(stack, is_upper, ErrorKind::PinionRadial, is_tolerance, value_mm, squares)
        };
        for value_mm in [0.0, 0.5] {
            assert_eq!(weight(Stack::WorstCase, true, false, value_mm, 1.0), Some(1.0));
            assert_eq!(weight(Stack::WorstCase, false, false, value_mm, 1.0), Some(-1.0));
            assert_eq!(weight(Stack::Range, true, true, value_mm, 1.0), Some(1.0));
            assert_eq!(weight(Stack::Range, false, true, value_mm, 1.0), Some(-1.0));
        }
        assert_eq!(weight(Stack::WorstCase, true, false, -0.5, 1.0), Some(-1.0));
        assert_eq!(weight(Stack::Rss, false, false, 0.5, 4.0), Some(-0.25));
        assert_eq!(weight(Stack::Rss, true, false, 0.0, 0.0), Some(1.0));
    }
}
