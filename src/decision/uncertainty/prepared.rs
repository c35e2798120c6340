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

use super::{FOLD, over_pin_source, source_of};
use super::{
    Linear, Part, Propagation, Source, Uncertainties, UncertaintyError, coverage_factor, effective_dof, stack_weight,
};
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
        let whole = super::whole_dof(dof);
        // rounding may lead to the other side of a whole number
        *certain &=
            whole == super::whole_dof(dof * (1.0 - UNSURE_DOF)) && whole == super::whole_dof(dof * (1.0 + UNSURE_DOF));
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
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::decision::uncertainty::{Distribution, Uncertainty, propagate};
    use crate::formula::{PinionPitch, RackLead, RackPitch};

    /// Fifty digits of their gains take time.
    fn formulas() -> &'static [PartFormula] {
        static FORMULAS: std::sync::OnceLock<Vec<PartFormula>> = std::sync::OnceLock::new();
        FORMULAS.get_or_init(made)
    }

    fn made() -> Vec<PartFormula> {
        let angle = |text: &str| text.parse::<Angle>().unwrap();
        let (alpha, rack, pinion) = (angle("20"), angle("12"), angle("21"));
        vec![
            PartFormula::RackOverRoller,
            PartFormula::RackPitch(RackPitch::new(&alpha, &rack).unwrap()),
            PartFormula::RackLead(RackLead::new(&alpha, &rack, &"19.7".parse().unwrap()).unwrap()),
            PartFormula::PinionRadial,
            PartFormula::PinionPitch(PinionPitch::new(&alpha, &pinion).unwrap()),
        ]
    }

    fn over_pin() -> OverPin {
        let mm = |text: &str| text.parse::<Length>().unwrap();
        OverPin {
            normal_module: mm("2.5"),
            normal_pressure_angle: "20".parse().unwrap(),
            tooth_thickness: None,
            pin_diameter: mm("5"),
            datum: mm("21.5"),
        }
    }

    fn inputs(dof: f64) -> Vec<(Source, Uncertainty)> {
        let u = Uncertainty::standard;
        let kinds = ErrorKind::ALL;
        vec![
            (Source::Error(kinds[0]), u(0.0008)),
            (Source::Error(kinds[1]), u(0.0006)),
            (Source::Error(kinds[2]), Uncertainty { dof, ..u(0.001) }),
            (Source::Error(kinds[3]), u(0.0009)),
            (Source::Error(kinds[4]), u(0.0007)),
            (Source::NormalPressureAngle, u(0.02)),
            (Source::FaceWidth, Uncertainty::half_width(0.1, Distribution::Rectangular)),
            (Source::RackHelixAngle, u(0.05)),
            (Source::PinionHelixAngle, u(0.04)),
            (Source::Datum, u(0.0005)),
            (Source::Roller, u(0.0003)),
        ]
    }

    /// The fast way against the propagation, for errors in nm and 1e-6°.
    fn check(errors: [i32; KINDS], stack: Stack, model: Model, correlation: f64, dof: f64) {
        let kinds = ErrorKind::ALL;
        let correlations = if correlation == 0.0 {
            Vec::new()
        } else {
            vec![(Source::Error(kinds[1]), Source::Error(kinds[4]), correlation)]
        };
        let uncertainties = Uncertainties::new(inputs(dof), &correlations).unwrap();
        let prepared: Vec<_> = formulas().iter().map(|formula| Prepared::new(formula, model)).collect();
        let over_pin = over_pin();
        let propagator = Propagator::new(&prepared, Some(&over_pin), uncertainties.clone(), stack).unwrap();
        let (mut part, mut points) = (Vec::new(), Vec::new());
        for (formula, error) in formulas().iter().zip(errors) {
            let text = format!("{error}e-6");
            let value = match formula.kind() {
                ErrorKind::RackLead => ErrorValue::Angle(text.parse().unwrap()),
                _ => ErrorValue::Length(text.parse().unwrap()),
            };
            let error_f64 = match &value {
                ErrorValue::Angle(angle) => angle.degrees(),
                ErrorValue::Length(length) => length.mm(),
            };
            let error = formula.of(&value).unwrap();
            points.push(Point { error: error_f64, delta_cd_mm: error.delta_cd(model).unwrap().mm() });
            part.push(error);
        }
        let fast = propagator.spreads(&points);
        let part = Part { errors: &part, over_pin: Some(&over_pin), model, stack };
        let exact = propagator.exact(&part, &propagate(&part, &uncertainties).unwrap()).unwrap();
        let all = |spreads: &Spreads| {
            let mut all = spreads.errors.to_vec();
            all.extend([spreads.lower, spreads.upper]);
            all
        };
        for (index, (fast_one, exact_one)) in all(&fast).iter().zip(all(&exact)).enumerate() {
            let off = (fast_one.standard_mm - exact_one.standard_mm).abs();
            assert!(off <= fast_one.rounding_mm, "{index}: {fast_one:?} {exact_one:?}");
            assert!(fast_one.rounding_mm <= 1e-9 * exact_one.standard_mm.max(1e-6), "{index}: {fast_one:?}");
            if fast.certain {
                assert_eq!(fast_one.coverage_factor, exact_one.coverage_factor, "{index}");
                assert_eq!(fast_one.folded, exact_one.folded, "{index}");
            }
            assert!(fast_one.gauge_mm2 <= fast_one.standard_mm * fast_one.standard_mm * (1.0 + 1e-12), "{index}");
        }
        assert!((fast.end_correlation - exact.end_correlation).abs() < 1e-9);
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]
        #[test]
        fn the_fast_way_is_the_propagation(
            errors in proptest::array::uniform5(-20_000_i32..20_000),
            shift in 0_u32..15,
            stack in 0_usize..3,
            paper: bool,
            correlation in prop_oneof![Just(0.0), -1.0..1.0_f64, Just(1.0), Just(-1.0)],
            dof in prop_oneof![Just(f64::INFINITY), Just(9.0), 1.0..100.0_f64],
        ) {
            let stack = [Stack::Range, Stack::WorstCase, Stack::Rss][stack];
            let model = if paper { Model::Paper } else { Model::Exact };
            check(errors.map(|error| error >> shift), stack, model, correlation, dof);
        }
    }

    /// Only a part within rounding of a bound needs the exact way: nobody would wait for it otherwise.
    #[test]
    fn a_usual_part_is_certain_and_one_on_the_edge_is_not() {
        assert_eq!(below(1.0, 2.0), (true, true));
        assert_eq!(below(2.0, 1.0), (false, true));
        assert_eq!(below(1.0, 1.0), (false, true));
        assert_eq!(below(1.0_f64.next_down(), 1.0), (true, false));
        assert_eq!(below(1.0_f64.next_up(), 1.0), (false, false));
        // rounding is in proportion to the bound, and what it may just reach is not certain
        assert_eq!(below(1.0 + ROUNDING, 1.0), (false, false));
        assert_eq!(below(2.0 + 1.5 * ROUNDING, 2.0), (false, false));
        assert_eq!(below(0.5 + 0.75 * ROUNDING, 0.5), (false, true));
        let kinds = ErrorKind::ALL;
        let prepared: Vec<_> = formulas().iter().map(|formula| Prepared::new(formula, Model::Exact)).collect();
        for stack in [Stack::Range, Stack::WorstCase, Stack::Rss] {
            let of = |dof: f64, correlations: &[(Source, Source, f64)]| {
                let uncertainties = Uncertainties::new(inputs(dof), correlations).unwrap();
                let propagator = Propagator::new(&prepared, None, uncertainties, stack).unwrap();
                let points = [0.013, 0.012, 0.0255, -0.014, 0.009].map(|error| Point { error, delta_cd_mm: error });
                propagator.spreads(&points)
            };
            let infinite = of(f64::INFINITY, &[]);
            assert!(infinite.certain && infinite.errors.iter().all(|spread| spread.coverage_factor == 2.0));
            // the lead error's 9 degrees of freedom are those of its own result, but for what the gear contributes
            let few = of(9.5, &[]);
            assert!(few.certain && few.errors[2].coverage_factor > 2.0 && few.errors[1].coverage_factor == 2.0);
            let correlated = of(9.5, &[(Source::Error(kinds[2]), Source::Error(kinds[3]), 0.5)]);
            assert!(correlated.errors.iter().all(|spread| spread.coverage_factor == 2.0));
            let others = of(9.5, &[(Source::Error(kinds[1]), Source::Error(kinds[3]), 0.5)]);
            assert!(others.errors[2].coverage_factor > 2.0);
            assert_eq!(others.errors[2].coverage_factor, few.errors[2].coverage_factor);
        }
    }

    /// Degrees of freedom that rounding could take for one fewer are looked at exactly.
    #[test]
    fn whole_degrees_of_freedom_are_not_certain() {
        let formula = [Prepared::new(&PartFormula::PinionRadial, Model::Exact)];
        let spreads = |dof| {
            let radial = (Source::Error(ErrorKind::PinionRadial), Uncertainty { dof, ..Uncertainty::standard(0.5) });
            let uncertainties = Uncertainties::new(vec![radial], &[]).unwrap();
            let propagator = Propagator::new(&formula, None, uncertainties, Stack::Range).unwrap();
            propagator.spreads(&[Point { error: 4.0, delta_cd_mm: 4.0 }])
        };
        // a whole number is one down to a part in 10¹² below it
        let edge = 9.0 / (1.0 + 1e-12);
        for beside in [1.0 - 5e-14, 1.0, 1.0 + 5e-14] {
            assert!(!spreads(edge * beside).certain, "{beside}");
        }
        assert!(spreads(9.0).certain && spreads(9.5).certain && spreads(400.0).certain);
        assert_eq!(spreads(9.0).upper.coverage_factor, coverage_factor(9.0));
        assert_eq!(spreads(400.5).upper.coverage_factor, coverage_factor(400.0));
    }

    #[test]
    fn on_the_edge_of_what_is_linear() {
        // 3 u of the pitch error is 1800 nm, of the lead error 3000e-6°
        let stacks = [Stack::Range, Stack::WorstCase, Stack::Rss].into_iter().cycle();
        for (error, stack) in [0, 1800, -1800, 1799, 3000, 2999].into_iter().zip(stacks) {
            check([error; KINDS], stack, Model::Exact, 0.0, 9.0);
        }
    }

    /// The propagator of one formula whose only uncertainty is that of `source`.
    fn of_one(formula: &PartFormula, source: Source, standard: f64, stack: Stack) -> Propagator {
        let uncertainties = Uncertainties::new(vec![(source, Uncertainty::standard(standard))], &[]).unwrap();
        Propagator::new(&[Prepared::new(formula, Model::Exact)], None, uncertainties, stack).unwrap()
    }

    #[test]
    fn an_ulp_from_where_it_folds_a_part_is_not_certain() {
        let u = 0.0006;
        let at = |formula: &PartFormula, stack, error: f64| {
            let propagator = of_one(formula, Source::Error(formula.kind()), u, stack);
            let spreads = propagator.spreads(&[Point { error, delta_cd_mm: error }]);
            (spreads.upper.folded, spreads.certain)
        };
        let fold = FOLD * u;
        // a pitch error's own formula folds
        let pitch = &formulas()[1];
        assert_eq!(at(pitch, Stack::Range, fold.next_down()), (true, false));
        assert_eq!(at(pitch, Stack::Range, -fold), (false, true));
        // an over-roller error is folded by magnitudes only
        let over_roller = &formulas()[0];
        for error in [fold.next_down(), -fold.next_down()] {
            assert_eq!(at(over_roller, Stack::Range, error), (false, true));
            assert_eq!(at(over_roller, Stack::WorstCase, error), (true, false));
            assert_eq!(at(over_roller, Stack::Rss, error), (true, false));
        }
        assert_eq!(at(over_roller, Stack::WorstCase, fold), (false, true));
        assert_eq!(at(over_roller, Stack::WorstCase, 0.5 * fold), (true, true));
    }

    /// A helix angle says nothing about a radial error.
    #[test]
    fn what_is_uncertain_elsewhere_leaves_nothing_uncertain() {
        for stack in [Stack::Range, Stack::WorstCase, Stack::Rss] {
            let propagator = of_one(&PartFormula::PinionRadial, Source::PinionHelixAngle, 0.04, stack);
            for delta_cd_mm in [0.0, 0.004] {
                let spreads = propagator.spreads(&[Point { error: delta_cd_mm, delta_cd_mm }]);
                let none = Spread { coverage_factor: 2.0, ..Spread::default() };
                assert_eq!((spreads.errors[0], spreads.lower, spreads.upper), (none, none, none));
                assert_eq!((spreads.end_correlation, spreads.certain), (0.0, true));
            }
        }
    }

    /// The bound is that of Σ |a_i| |a_j| |r_ij| for contributions a_i, however much of them cancels; those of an end
    /// add up error by error.
    #[test]
    fn rounding_follows_the_magnitudes_of_what_is_added() {
        let kinds = ErrorKind::ALL;
        let correlations = [
            (Source::Error(kinds[1]), Source::NormalPressureAngle, 0.75),
            (Source::Error(kinds[0]), Source::Datum, -0.5),
            (Source::Error(kinds[2]), Source::Error(kinds[4]), -0.25),
        ];
        let uncertainties = Uncertainties::new(inputs(f64::INFINITY), &correlations).unwrap();
        let sources: Vec<Source> = uncertainties.inputs().iter().map(|(source, _)| *source).collect();
        let prepared: Vec<_> = formulas().iter().map(|formula| Prepared::new(formula, Model::Exact)).collect();
        let over_pin = over_pin();
        let stack = Stack::WorstCase;
        let propagator = Propagator::new(&prepared, Some(&over_pin), uncertainties.clone(), stack).unwrap();
        let values = ["0.013", "-0.012", "0.0255", "-0.014", "0.009"];
        let (mut errors, mut points) = (Vec::new(), Vec::new());
        for (formula, text) in formulas().iter().zip(values) {
            let value = match formula.kind() {
                ErrorKind::RackLead => ErrorValue::Angle(text.parse().unwrap()),
                _ => ErrorValue::Length(text.parse().unwrap()),
            };
            errors.push(formula.of(&value).unwrap());
            let delta_cd_mm = errors.last().unwrap().delta_cd(Model::Exact).unwrap().mm();
            points.push(Point { error: text.parse().unwrap(), delta_cd_mm });
        }
        let spreads = propagator.spreads(&points);
        let part = Part { errors: &errors, over_pin: Some(&over_pin), model: Model::Exact, stack };
        let propagation = propagate(&part, &uncertainties).unwrap();
        let coefficient = |a: Source, b: Source| {
            let given = correlations.iter().find(|(one, other, _)| [(a, b), (b, a)].contains(&(*one, *other)));
            if a == b { 1.0 } else { given.map_or(0.0, |(_, _, r)| r.abs()) }
        };
        let check = |spread: &Spread, linear: &Linear, magnitudes: &[f64]| {
            assert!((spread.standard_mm - linear.standard_mm).abs() <= spread.rounding_mm, "{spread:?} {linear:?}");
            let products = sources
                .iter()
                .zip(magnitudes)
                .flat_map(|(a, x)| sources.iter().zip(magnitudes).map(move |(b, y)| x * y * coefficient(*a, *b)));
            let expected = ROUNDING * products.sum::<f64>() / linear.standard_mm;
            assert!((spread.rounding_mm / expected - 1.0).abs() < 1e-9, "{spread:?} {expected}");
        };
        let mut all = vec![0.0; sources.len()];
        for (spread, (_, linear)) in spreads.errors.iter().zip(&propagation.errors) {
            let mut each = vec![0.0; sources.len()];
            for found in &linear.contributions {
                let at = sources.iter().position(|source| *source == found.source).unwrap();
                each[at] += found.contribution_mm.abs();
                all[at] += found.contribution_mm.abs();
            }
            check(spread, linear, &each);
        }
        check(&spreads.upper, &propagation.upper, &all);
        check(&spreads.lower, &propagation.lower, &all);
    }
}
