//! The fast propagation against the one for single parts, and on the edges of what is certain.

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
