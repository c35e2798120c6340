use super::*;
use crate::deviation::{DeviationKind, Extent};
use crate::formula::{Law, Model, PartDeviation};
use crate::judge::{Limit, LimitTarget, Stack};
use crate::quantity::{Angle, Length};
use crate::statistics::{folded_normal, normal_cdf, normal_quantile};
use crate::uncertainty::Distribution;
use crate::uncertainty::tests::UNKNOWN;
use crate::uncertainty::{UncertainPart, Uncertainties, propagate};

/// Any function of a few variables.
pub(super) struct Function<F>(pub(super) F);

impl<F: Fn(&[f64]) -> f64 + Sync> Simulated for Function<F> {
    fn outputs(&self) -> usize {
        1
    }

    fn evaluate(&self, inputs: &[Vec<f64>], outputs: &mut [Vec<f64>]) {
        for (draw, out) in outputs[0].iter_mut().enumerate() {
            let x: Vec<f64> = inputs.iter().map(|column| column[draw]).collect();
            *out = (self.0)(&x);
        }
    }
}

fn run(f: impl Fn(&[f64]) -> f64 + Sync, variables: Vec<(f64, Uncertainty)>, draws: u64) -> Simulation {
    let settings = Settings { draws: Some(draws), ..Settings::default() };
    let variables = Variables { variables, factor: None };
    simulate(&Function(f), &variables, &[], &settings).unwrap().results.remove(0)
}

fn rectangular(from: f64, to: f64) -> (f64, Uncertainty) {
    (0.5 * (from + to), Uncertainty::half_width(0.5 * (to - from), Distribution::Rectangular))
}

fn shows(value: f64, decimals: usize, printed: &str) {
    assert_eq!(format!("{value:.decimals$}"), printed, "{value}");
}

/// A part with these errors, of a pair of which nothing is known.
fn part(errors: &[PartDeviation]) -> UncertainPart<'_> {
    let (model, stack) = (Model::Exact, Stack::Range);
    UncertainPart { errors, over_pin: None, model, stack, basis: &UNKNOWN, teeth: &[] }
}

#[test]
fn the_additive_models_of_jcgm_101_clause_9_2() {
    let sum = |x: &[f64]| x.iter().sum::<f64>();
    let normal = |standard| (0.0, Uncertainty::standard(standard));
    let flat = |standard: f64| {
        (0.0, Uncertainty { distribution: Distribution::Rectangular, ..Uncertainty::standard(standard) })
    };
    // Table 2: four standard normal quantities
    let result = run(sum, vec![normal(1.0); 4], 500_000);
    shows(result.standard, 2, "2.00");
    shows(result.symmetric.1, 1, "3.9");
    // Table 3: four rectangular ones of the same deviation, for which the interval is ±3.88
    let result = run(sum, vec![flat(1.0); 4], 2_000_000);
    shows(result.standard, 2, "2.00");
    shows(result.symmetric.0, 2, "-3.88");
    shows(result.symmetric.1, 2, "3.88");
    // Table 4: one of them ten times as wide: 10.1, and ±17.0 where the linear result is ±19.9
    let result = run(sum, vec![flat(1.0), flat(1.0), flat(1.0), flat(10.0)], 1_000_000);
    assert!((result.standard - 103.0_f64.sqrt()).abs() < 0.02, "{}", result.standard);
    shows(result.symmetric.1, 1, "17.0");
}

#[test]
fn the_mass_calibration_of_jcgm_101_clause_9_3() {
    // m_R,c = N(100 000.000, 0.050) mg, δm_R,c = N(1.234, 0.020) mg, ρ_a = R(1.10, 1.30), ρ_W = R(7000, 9000),
    // ρ_R = R(7950, 8050) kg/m³; deviation from 100 g
    let variables = vec![
        (100_000.0, Uncertainty::standard(0.050)),
        (1.234, Uncertainty::standard(0.020)),
        rectangular(1.10, 1.30),
        rectangular(7000.0, 9000.0),
        rectangular(7950.0, 8050.0),
    ];
    let deviation = |x: &[f64]| (x[0] + x[1]) * (1.0 + (x[2] - 1.2) * (1.0 / x[3] - 1.0 / x[4])) - 100_000.0;
    let result = run(deviation, variables, 1_000_000);
    // Table 6: 1.234 1, 0.075 4, shortest 95 % interval [1.083 4, 1.382 5]
    assert!((result.mean - 1.234_1).abs() < 0.000_3, "{}", result.mean);
    assert!((result.standard - 0.075_4).abs() < 0.000_2, "{}", result.standard);
    assert!((result.shortest.0 - 1.083_4).abs() < 0.002, "{:?}", result.shortest);
    assert!((result.shortest.1 - 1.382_5).abs() < 0.002, "{:?}", result.shortest);
}

#[test]
fn a_folded_normal_variable_has_its_closed_form() {
    for mean in [0.0, 0.5, 1.5, 4.0] {
        let result = run(|x| x[0].abs(), vec![(mean, Uncertainty::standard(1.0))], 1_000_000);
        let (expected, deviation) = folded_normal(mean, 1.0);
        assert!((result.mean - expected).abs() < 4e-3, "{mean}");
        assert!((result.standard - deviation).abs() < 3e-3, "{mean}");
        for end in [result.symmetric.0, result.symmetric.1] {
            let p = normal_cdf(end - mean) - normal_cdf(-end - mean);
            assert!((p - 0.025).abs().min((p - 0.975).abs()) < 6e-4, "{mean} {end} {p}");
        }
    }
    // at zero the shortest interval starts there, and ends where 95 % of |z| do
    let result = run(|x| x[0].abs(), vec![(0.0, Uncertainty::standard(1.0))], 1_000_000);
    assert!(result.shortest.0 < 0.02, "{:?}", result.shortest);
    assert!((result.shortest.1 - normal_quantile(0.975)).abs() < 0.02, "{:?}", result.shortest);
}

#[test]
fn tolerances_of_digits() {
    // JCGM 101, 7.9.2: u = 0.000 35 g to 2 digits: δ = 0.000 005; u = 2 K to 1 digit: 0.5
    assert!((tolerance(0.000_35, 2) - 0.000_005).abs() < 1e-18);
    assert!((tolerance(2.0, 1) - 0.5).abs() < 1e-15);
}

fn length(text: &str) -> Length {
    text.parse().unwrap()
}

fn five(pitch: &str, lead: &str) -> Vec<PartDeviation> {
    let angle = |text: &str| text.parse::<Angle>().unwrap();
    let (alpha, rack, pinion) = (angle("20"), angle("12"), angle("21"));
    vec![
        PartDeviation::new(Law::rack_over_roller(), length("0.013")),
        PartDeviation::new(Law::rack_pitch(alpha, rack).unwrap(), length(pitch)),
        PartDeviation::new(Law::rack_lead(alpha, rack, length("19.7")).unwrap(), angle(lead)),
        PartDeviation::new(Law::pinion_radial(), length("-0.004")),
        PartDeviation::new(Law::pinion_pitch(alpha, pinion).unwrap(), length("0.009")),
    ]
}

fn all_uncertain() -> Vec<(Influence, Uncertainty)> {
    let mut inputs: Vec<_> =
        DeviationKind::ALL.into_iter().map(|kind| (Influence::Error(kind), Uncertainty::standard(0.0008))).collect();
    inputs.push((Influence::NormalPressureAngle, Uncertainty::standard(0.02)));
    inputs.push((Influence::RackHelixAngle, Uncertainty::half_width(0.05, Distribution::Rectangular)));
    inputs.push((Influence::PinionHelixAngle, Uncertainty::half_width(0.05, Distribution::Triangular)));
    inputs.push((Influence::FaceWidth, Uncertainty::half_width(0.1, Distribution::Arcsine)));
    inputs
}

#[test]
fn far_from_zero_linear_and_simulated_results_agree() {
    for (model, stack) in [(Model::Exact, Stack::Range), (Model::Paper, Stack::Range), (Model::Exact, Stack::Rss)] {
        let errors = five("0.012", "-0.0255");
        let part = UncertainPart { errors: &errors, over_pin: None, model, stack, basis: &UNKNOWN, teeth: &[] };
        let uncertainties = Uncertainties::new(all_uncertain(), &[]).unwrap();
        let linear = propagate(&part, &uncertainties).unwrap();
        let settings = Settings { draws: Some(500_000), ..Settings::default() };
        let simulated = simulate_part(&part, &uncertainties, &Vec::new(), &settings).unwrap();
        assert!(simulated.errors().map(|(kind, _)| kind).eq(linear.errors.iter().map(|(kind, _)| *kind)));
        let pairs = linear.errors.iter().map(|(_, linear)| linear).zip(simulated.errors().map(|(_, s)| s));
        for (linear, simulated) in pairs.chain([(&linear.upper, simulated.upper()), (&linear.lower, simulated.lower())])
        {
            // four standard errors of the mean, and of the deviation
            assert!((linear.value_mm - simulated.mean).abs() < 6e-3 * linear.standard_mm, "{linear:?}");
            assert!((simulated.standard / linear.standard_mm - 1.0).abs() < 5e-3, "{stack} {linear:?}");
            assert!(validate(linear, simulated, 1).validated, "{linear:?}");
        }
    }
}

#[test]
fn near_zero_the_simulation_does_not_validate_the_linear_result() {
    let errors = five("0", "0.0255");
    let part = part(&errors[1..2]);
    let inputs = vec![(Influence::Error(DeviationKind::RackPitch), Uncertainty::standard(0.001))];
    let uncertainties = Uncertainties::new(inputs, &[]).unwrap();
    let linear = propagate(&part, &uncertainties).unwrap();
    let settings = Settings { draws: Some(400_000), ..Settings::default() };
    let simulated = simulate_part(&part, &uncertainties, &Vec::new(), &settings).unwrap();
    assert!(!validate(&linear.upper, simulated.upper(), 2).validated);
    let gain = 1.343_719_222_954_923;
    // draws until their digits are reached, too
    let adaptive =
        simulate_part(&part, &uncertainties, &Vec::new(), &Settings { digits: 1, ..Settings::default() }).unwrap();
    assert_eq!(adaptive.outcome.reached(), Some(true));
    assert!(!validate(&linear.upper, adaptive.upper(), 1).validated);
    let (mean, deviation) = folded_normal(0.0, 0.001 * gain);
    assert!((simulated.upper().mean / mean - 1.0).abs() < 0.01);
    assert!((simulated.upper().standard / deviation - 1.0).abs() < 0.01);
    assert!(linear.upper.standard_mm > simulated.upper().standard);
}

#[test]
fn the_same_bits_at_any_number_of_threads() {
    let errors = five("0.012", "0.0255");
    let part = part(&errors);
    let uncertainties = Uncertainties::new(all_uncertain(), &[]).unwrap();
    let limits = vec![(LimitTarget::CenterDistance, Limit::symmetric(length("0.047")))];
    for draws in [None, Some(230_000)] {
        let with = |threads, seed| {
            let settings = Settings { threads: Some(threads), seed, draws, digits: 1, ..Settings::default() };
            simulate_part(&part, &uncertainties, &limits, &settings).unwrap()
        };
        let one = with(1, 7);
        for threads in [2, 5] {
            assert_eq!(one, with(threads, 7));
        }
        assert_ne!(one.upper().mean, with(1, 8).upper().mean);
    }
}

#[test]
fn correlated_draws_and_probabilities_of_conformance() {
    let errors = [
        PartDeviation::new(Law::rack_over_roller(), length("0.010")),
        PartDeviation::new(Law::pinion_radial(), length("0.005")).with_extent(Extent::All),
    ];
    let part = part(&errors);
    let (a, b) = (Influence::Error(DeviationKind::RackOverRoller), Influence::Error(DeviationKind::PinionRadial));
    let inputs = vec![(a, Uncertainty::standard(0.003)), (b, Uncertainty::standard(0.004))];
    let limits = vec![
        (LimitTarget::CenterDistance, Limit { lower: None, upper: Some(length("0.020")) }),
        (LimitTarget::Error(DeviationKind::RackPitch), Limit::symmetric(length("0.020"))),
    ];
    for r in [-1.0, -0.5, 0.0, 0.8, 1.0] {
        let uncertainties = Uncertainties::new(inputs.clone(), &[(a, b, r)]).unwrap();
        let settings = Settings { draws: Some(400_000), ..Settings::default() };
        let simulated = simulate_part(&part, &uncertainties, &limits, &settings).unwrap();
        let u: f64 = (0.003 * 0.003 + 0.004 * 0.004 + 2.0 * r * 0.003 * 0.004_f64).sqrt();
        assert!((simulated.upper().standard / u - 1.0).abs() < 5e-3, "{r}");
        assert!((simulated.outcome.inside[0] - normal_cdf(0.005 / u)).abs() < 3e-3, "{r}");
        assert!(simulated.outcome.inside[1].is_nan());
    }
    let flat = vec![(a, Uncertainty::half_width(0.003, Distribution::Rectangular)), inputs[1]];
    let refused = Uncertainties::new(flat, &[(a, b, 0.5)]).unwrap();
    assert_eq!(
        simulate_part(&part, &refused, &limits, &Settings::default()).unwrap_err(),
        MonteCarloError::CorrelatedNotNormal(a)
    );
}

#[test]
fn what_cannot_be_simulated_says_why() {
    let errors = five("0.012", "0.0255");
    let part = part(&errors);
    let try_with = |inputs, settings: &Settings| {
        simulate_part(&part, &Uncertainties::new(inputs, &[]).unwrap(), &Vec::new(), settings).unwrap_err()
    };
    assert_eq!(try_with(Vec::new(), &Settings::default()), MonteCarloError::NothingUncertain);
    let wide = vec![(Influence::NormalPressureAngle, Uncertainty::standard(15.0))];
    assert!(matches!(try_with(wide, &Settings::default()), MonteCarloError::OutsideDomain { .. }));
    let few = Uncertainty { dof: 2.0, ..Uncertainty::standard(0.001) };
    let few = vec![(Influence::Error(DeviationKind::RackPitch), few)];
    assert!(matches!(try_with(few, &Settings::default()), MonteCarloError::TooFewFreedom { dof: 2.0, .. }));
    // three are enough for a standard deviation
    let three = Uncertainty { dof: 3.0, ..Uncertainty::standard(0.001) };
    let three = Uncertainties::new(vec![(Influence::Error(DeviationKind::RackPitch), three)], &[]).unwrap();
    let once = Settings { draws: Some(10_000), ..Settings::default() };
    assert!(simulate_part(&part, &three, &Vec::new(), &once).is_ok());
    let nine = Settings { digits: 9, ..Settings::default() };
    assert!(matches!(try_with(all_uncertain(), &nine), MonteCarloError::Setting { value: 9, .. }));
}

/// What is done is a share of all draws, or of those that the draws so far ask for.
#[test]
fn draws_show_how_much_is_done() {
    let variables = Variables { variables: vec![(3.0, Uncertainty::standard(9.5))], factor: None };
    let seen = |settings: Settings| {
        let shares = std::sync::Mutex::new(Vec::new());
        let watch = |share| shares.lock().unwrap().push(share);
        let outcome = simulate_watched(&Function(|x: &[f64]| x[0]), &variables, &[], &settings, &watch).unwrap();
        let shares: Vec<Option<f64>> = shares.into_inner().unwrap();
        assert_eq!(shares.len() as u64 * BLOCK, outcome.draws);
        shares
    };
    let one_thread = Settings { threads: Some(1), ..Settings::default() };
    assert_eq!(seen(Settings { draws: Some(4 * BLOCK), ..one_thread }), [0.25, 0.5, 0.75, 1.0].map(Some));
    // to one digit in several rounds: unknown in the first one, then never beyond all, and all in the end
    let shares = seen(Settings { digits: 1, ..one_thread });
    let (unknown, known) = shares.split_at(10);
    assert!(unknown.iter().all(Option::is_none) && known.iter().all(|share| share.is_some_and(|share| share <= 1.0)));
    assert_eq!((known.is_empty(), shares.last()), (false, Some(&Some(1.0))));
}

/// The ends of the interval have a standard error of 2.67 u/√n: to one digit, u = 9.5 takes 258 000 draws.
#[test]
fn rounds_double_until_the_digits_hold() {
    let variables = Variables { variables: vec![(3.0, Uncertainty::standard(9.5))], factor: None };
    let with = |draws| {
        let settings = Settings { digits: 1, draws, ..Settings::default() };
        simulate(&Function(|x: &[f64]| x[0]), &variables, &[], &settings).unwrap()
    };
    let adaptive = with(None);
    assert_eq!((adaptive.draws, adaptive.reached()), (400_000, Some(true)));
    let given = with(Some(399_999));
    assert_eq!((given.draws, given.reached()), (400_000, None));
    assert_eq!(given.results, adaptive.results);
    let result = &given.results[0];
    assert!(
        (result.histogram.quantile(0.5) - 3.0).abs() < 0.1
            && (result.histogram.quantile(0.841_344_746) - 12.5).abs() < 0.1
    );
}

/// At the most draws a simulation says what holds: 2.67 u/√n of 400 000 draws is 0.42 of a fifth of the tolerance of one digit of
/// u = 9.5, ten times that of two digits, and takes 25 million draws to reach it.
#[test]
fn the_most_draws_say_which_digits_hold() {
    let variables = Variables { variables: vec![(3.0, Uncertainty::standard(9.5))], factor: None };
    let at_most = |most_draws, digits| {
        let settings = Settings { most_draws, digits, ..Settings::default() };
        simulate(&Function(|x: &[f64]| x[0]), &variables, &[], &settings)
    };
    let outcome = at_most(400_000, 2).unwrap();
    assert_eq!((outcome.draws, outcome.reached()), (400_000, Some(false)));
    assert_eq!((outcome.stable_digits(), outcome.reachable_digits()), (Some(1), Some(1)));
    let needed = outcome.needed_draws().unwrap();
    assert!((15_000_000..40_000_000).contains(&needed) && needed % 1_000_000 == 0, "{needed}");
    let four = at_most(20_000, 4).unwrap();
    assert_eq!((four.draws, four.stable_digits(), four.needed_draws()), (20_000, Some(1), None));
    let one = at_most(1_000_000, 1).unwrap();
    assert_eq!((one.reached(), one.stable_digits(), one.needed_draws()), (Some(true), Some(1), None));
    assert!(matches!(at_most(10_000, 1), Err(MonteCarloError::Setting { least: 20_000, .. })));
}

/// Values where the quantity may be, with the deviations of their distributions.
#[test]
fn each_distribution_about_its_value() {
    let uncertain = |distribution| (3.0, Uncertainty::half_width(0.5, distribution));
    for (distribution, divisor) in
        [(Distribution::Rectangular, 3.0_f64), (Distribution::Triangular, 6.0), (Distribution::Arcsine, 2.0)]
    {
        let result = run(|x| x[0], vec![uncertain(distribution)], 100_000);
        assert!((result.mean - 3.0).abs() < 0.01, "{distribution:?} {}", result.mean);
        assert!((result.standard * divisor.sqrt() / 0.5 - 1.0).abs() < 0.01, "{distribution:?} {}", result.standard);
        let (least, most) = result.extremes;
        assert!((2.5..2.51).contains(&least) && (3.49..=3.5).contains(&most), "{distribution:?}");
    }
    // Student's t of 10 degrees of freedom: √(10/8) as wide
    let student = (3.0, Uncertainty { dof: 10.0, ..Uncertainty::standard(0.5) });
    let result = run(|x| x[0], vec![student], 200_000);
    assert!((result.mean - 3.0).abs() < 0.01 && (result.standard / 0.5 / 1.25_f64.sqrt() - 1.0).abs() < 0.02);
    // among correlated ones, a variable that is not keeps its distribution
    let normal = (0.0, Uncertainty::standard(1.0));
    let variables = Variables {
        variables: vec![normal, normal, uncertain(Distribution::Rectangular)],
        factor: Some(vec![1.0, 0.0, 0.0, 0.6, 0.8, 0.0, 0.0, 0.0, 1.0]),
    };
    let settings = Settings { draws: Some(100_000), ..Settings::default() };
    let third = simulate(&Function(|x: &[f64]| x[2]), &variables, &[], &settings).unwrap().results.remove(0);
    assert!(third.extremes.0 >= 2.5 && third.extremes.1 <= 3.5, "{:?}", third.extremes);
}

/// Few enough draws without a result to miss the first block are found in the others; many end it after the first.
#[test]
fn draws_without_a_result_are_counted() {
    let share = |furthest: f64, draws: u64| {
        let variables = Variables { variables: vec![(0.0, Uncertainty::standard(1.0))], factor: None };
        let settings = Settings { draws: Some(draws), ..Settings::default() };
        let f = move |x: &[f64]| if x[0] > furthest { f64::NAN } else { x[0] };
        match simulate(&Function(f), &variables, &[], &settings) {
            Err(MonteCarloError::OutsideDomain { share }) => share,
            other => panic!("{other:?}"),
        }
    };
    let few = share(4.0, 200_000);
    let count = few * 200_000.0;
    assert!(few > 0.0 && few < 1e-4 && (count - count.round()).abs() < 1e-9, "{few}");
    let many = share(1.0, 10_000);
    assert!((many - normal_cdf(-1.0)).abs() < 0.02, "{many}");
    assert_eq!(share(1.0, 1_000_000), many);
}

/// Both ends must agree.
#[test]
fn one_end_that_differs_is_not_validated() {
    let mut simulation = run(|x| x[0], vec![(0.5, Uncertainty::standard(2.0))], 100_000);
    let linear = Linear {
        value_mm: 0.5,
        standard_mm: 2.0,
        dof: Some(f64::INFINITY),
        coverage_factor: Some(2.0),
        contributions: Vec::new(),
        folded: Vec::new(),
    };
    assert!(validate(&linear, &simulation, 1).validated);
    let (low, high) = simulation.symmetric;
    for ends in [(low - 1.0, high), (low, high + 1.0)] {
        simulation.symmetric = ends;
        assert!(!validate(&linear, &simulation, 1).validated, "{ends:?}");
    }
}
