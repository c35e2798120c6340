//! The guarantees of a budget, evaluated forward as `eval` does it.

use proptest::prelude::*;

use super::*;
use crate::decision::{LimitTarget, Stack, Verdict, evaluate};
use crate::judge::bound::{GivenGeometry, GivenPair, KnownPairs};
use crate::quantity::Angle;

fn length(text: &str) -> Length {
    text.parse().unwrap()
}

fn formulas(alpha: &str, beta: &str, width: &str) -> [Law; 5] {
    let (alpha, beta): (Angle, Angle) = (alpha.parse().unwrap(), beta.parse().unwrap());
    [
        Law::rack_over_roller(),
        Law::rack_pitch(alpha, beta).unwrap(),
        Law::rack_lead(alpha, beta, length(width)).unwrap(),
        Law::pinion_radial(),
        Law::pinion_pitch(alpha, beta).unwrap(),
    ]
}

/// The paper's pair.
fn pair() -> Basis {
    let given = GivenPair::plain(crate::reproduction::pair().unwrap());
    Basis { geometry: GivenGeometry::Known(KnownPairs::new(given)), ..Basis::default() }
}

fn weight(number: u32) -> Freedom {
    Freedom::Weight(f64::from(number))
}

fn request(entries: Vec<Entry>, limit: &str, rule: Rule) -> Request {
    Request {
        entries,
        limit: Limit::symmetric(length(limit)),
        own_limits: Vec::new(),
        rule,
        model: Model::Exact,
        basis: pair(),
    }
}

/// An error read again from the double that is printed.
fn read_again(error: &PartError, factor: f64) -> PartError {
    let value = error.value().abs().base() * factor;
    let value = match error.value() {
        ErrorValue::Length(_) => ErrorValue::Length(Length::from_mm(value).unwrap()),
        _ => ErrorValue::Angle(Angle::from_degrees(value).unwrap()),
    };
    PartError::within(error.law(), value)
}

/// The verdict of `eval` on the tolerances of a budget, one of them enlarged.
fn verdict(budget: &Budget, request: &Request, enlarged: Option<usize>) -> Verdict {
    let errors: Vec<PartError> = budget
        .lines
        .iter()
        .enumerate()
        .map(|(index, line)| read_again(&line.error, if enlarged == Some(index) { 1.01 } else { 1.0 }))
        .collect();
    let mut limits = vec![(LimitTarget::CenterDistance, request.limit)];
    limits.extend(request.own_limits.iter().map(|(kind, limit)| (LimitTarget::Error(*kind), *limit)));
    let stack = if request.rule == Rule::Rss { Stack::Rss } else { Stack::Range };
    evaluate(&errors, &limits, request.model, stack, &request.basis).unwrap().verdict.unwrap()
}

/// Meets the limit, and not if any free tolerance grows by 1 %.
fn check(request: &Request) -> Budget {
    let budget = allocate(request).unwrap();
    assert!(budget.is_feasible());
    assert_eq!(verdict(&budget, request, None), Verdict::Pass, "{budget:?}");
    for (index, line) in budget.lines.iter().enumerate() {
        if !line.is_fixed {
            assert_eq!(verdict(&budget, request, Some(index)), Verdict::Fail, "{:?}", line.error);
        }
    }
    budget
}

#[test]
fn shares_stand_in_the_ratio_of_weights() {
    let [over_roller, pitch, lead, radial, _] = formulas("20", "0", "19.7");
    let entries = vec![
        Entry::Fixed(PartError::new(Law::pinion_radial(), length("0.01"))),
        Entry::Free(over_roller, weight(1)),
        Entry::Free(pitch, weight(2)),
        Entry::Free(lead, weight(1)),
    ];
    let budget = check(&request(entries, "0.05", Rule::WorstCase));
    let shares: Vec<f64> = budget.lines.iter().map(|line| line.delta_cd.mm()).collect();
    for (share, expected) in shares.iter().zip([0.01, 0.01, 0.02, 0.01]) {
        // a lead error in decimals of a degree stays a little below
        assert!(*share <= expected && share - expected > -1e-11, "{shares:?}");
    }
    for (line, expected) in budget.lines.iter().zip([0.2, 0.2, 0.4, 0.2]) {
        assert!((line.share - expected).abs() < 1e-9, "{line:?}");
    }
    // 3, 4 and 12 make 13
    let entries =
        vec![Entry::Fixed(PartError::new(Law::rack_over_roller(), length("0.05"))), Entry::Free(radial, weight(7))];
    let budget = check(&request(entries, "0.13", Rule::Rss));
    assert_eq!(budget.lines[1].error.value(), ErrorValue::Length(length("0.12")));
    assert_eq!([budget.lines[0].share, budget.lines[1].share], [25.0 / 169.0, 144.0 / 169.0]);
}

#[test]
fn costs_are_smallest_where_they_are_said_to_be() {
    let [over_roller, _, _, radial, _] = formulas("20", "0", "19.7");
    let cost = Freedom::Cost;
    for (rule, ratio) in [(Rule::WorstCase, 8_f64.sqrt()), (Rule::Rss, 2.0)] {
        let entries = vec![Entry::Free(over_roller, cost(1.0)), Entry::Free(radial, cost(8.0))];
        let budget = check(&request(entries, "0.06", rule));
        let (a, b) = (budget.lines[0].delta_cd.mm(), budget.lines[1].delta_cd.mm());
        assert!((b / a - ratio).abs() < 1e-9);
        // the sum of costs at neighbouring allocations is larger
        let total = |a: f64| {
            let b = if rule == Rule::Rss { (0.06_f64 * 0.06 - a * a).sqrt() } else { 0.06 - a };
            1.0 / a + 8.0 / b
        };
        assert!(total(a) < total(a * 1.001) && total(a) < total(a * 0.999));
    }
}

#[test]
fn an_own_limit_leaves_more_to_the_others() {
    let [over_roller, pitch, ..] = formulas("20", "0", "19.7");
    let entries = vec![Entry::Free(over_roller, weight(1)), Entry::Free(pitch, weight(1))];
    let mut request = request(entries, "0.05", Rule::WorstCase);
    request.own_limits = vec![(ErrorKind::RackPitch, Limit { lower: None, upper: Some(length("0.005")) })];
    let budget = check(&request);
    assert!(budget.lines[1].at_own_limit && !budget.lines[0].at_own_limit);
    assert_eq!(budget.lines[0].delta_cd, length("0.045"));
}

/// Who gets no more than the budget would give anyway is not stopped by its own limit, and who has no weight gets
/// nothing.
#[test]
fn a_share_that_equals_the_own_limit_and_one_of_nothing() {
    let [over_roller, pitch, ..] = formulas("20", "0", "19.7");
    let entries = vec![
        Entry::Free(over_roller, weight(1)),
        Entry::Free(pitch, weight(1)),
        Entry::Free(Law::pinion_radial(), weight(0)),
    ];
    let mut request = request(entries, "0.05", Rule::WorstCase);
    request.own_limits = vec![(ErrorKind::RackPitch, Limit { lower: None, upper: Some(length("0.025")) })];
    let budget = allocate(&request).unwrap();
    assert!(budget.lines.iter().all(|line| !line.at_own_limit));
    assert_eq!(budget.lines[0].delta_cd, length("0.025"));
    assert_eq!(budget.lines[2].delta_cd, Length::ZERO);
    request.entries.drain(..2);
    assert_eq!(allocate(&request).unwrap().lines[0].delta_cd, Length::ZERO);
}

#[test]
fn a_fixed_tolerance_beyond_its_own_limit_breaks_the_budget() {
    let simulated = Rule::Simulation(simulation(0.9, simulation::Spread::Uniform));
    for rule in [Rule::WorstCase, Rule::Rss, simulated] {
        for (fixed, broken) in [("0.009", false), ("0.01", false), ("0.0101", true), ("-0.0101", true)] {
            let entries = vec![
                Entry::Fixed(PartError::new(Law::pinion_radial(), length(fixed))),
                Entry::Free(Law::rack_over_roller(), weight(1)),
            ];
            let mut request = request(entries, "0.05", rule);
            request.own_limits = vec![(ErrorKind::PinionRadial, Limit::symmetric(length("0.01")))];
            let budget = allocate(&request).unwrap();
            let expected: &[ErrorKind] = if broken { &[ErrorKind::PinionRadial] } else { &[] };
            assert_eq!(budget.broken_by, expected, "{rule:?} {fixed}");
            assert_eq!(budget.lines[1].delta_cd == Length::ZERO, broken, "{rule:?} {fixed}");
        }
    }
}

#[test]
fn an_infeasible_budget_names_what_breaks_it() {
    let [over_roller, ..] = formulas("20", "0", "19.7");
    let entries = vec![
        Entry::Fixed(PartError::new(Law::pinion_radial(), length("0.04"))),
        Entry::Fixed(PartError::new(Law::rack_over_roller(), length("-0.02"))),
        Entry::Free(formulas("20", "0", "19.7")[1], weight(1)),
    ];
    let budget = allocate(&request(entries, "0.05", Rule::WorstCase)).unwrap();
    assert_eq!(budget.broken_by, [ErrorKind::PinionRadial]);
    assert!(!budget.is_feasible());
    // exactly the limit leaves nothing for a free one, and is enough without one
    let exactly = vec![Entry::Fixed(PartError::new(Law::pinion_radial(), length("0.05")))];
    assert!(allocate(&request(exactly.clone(), "0.05", Rule::WorstCase)).unwrap().is_feasible());
    let and_free = [exactly, vec![Entry::Free(over_roller, weight(1))]].concat();
    let budget = allocate(&request(and_free, "0.05", Rule::WorstCase)).unwrap();
    assert_eq!(budget.broken_by, [ErrorKind::PinionRadial]);
    let two = vec![
        Entry::Fixed(PartError::new(Law::pinion_radial(), length("0.06"))),
        Entry::Fixed(PartError::new(Law::rack_over_roller(), length("0.07"))),
    ];
    let budget = allocate(&request(two, "0.05", Rule::Rss)).unwrap();
    assert_eq!(budget.broken_by, [ErrorKind::RackOverRoller, ErrorKind::PinionRadial]);
}

#[test]
fn a_limit_without_room_is_an_error() {
    let entries = || vec![Entry::Free(Law::rack_over_roller(), weight(1))];
    let of = |lower: Option<&str>, upper: Option<&str>| {
        let mut request = request(entries(), "1", Rule::WorstCase);
        request.limit = Limit { lower: lower.map(length), upper: upper.map(length) };
        allocate(&request).map(|budget| budget.lines[0].delta_cd.mm())
    };
    assert_eq!(of(Some("-0.02"), Some("0.05")), Ok(0.02));
    assert_eq!(of(None, Some("0.05")), Ok(0.05));
    assert_eq!(of(Some("0.01"), Some("0.05")), Err(BudgetError::NoRoom));
    assert_eq!(of(Some("0"), Some("0.05")), Err(BudgetError::NoRoom));
    assert_eq!(of(None, None), Err(BudgetError::NoLimit));
}

fn simulation(conforming: f64, spread: simulation::Spread) -> Simulation {
    Simulation { conforming, spread, draws: 100_000, seed: 1 }
}

/// To a part in 10⁹, in some fifty simulations, wherever it lies; and nowhere.
#[test]
fn the_largest_scale_is_found_soon_and_closely() {
    let asked = std::cell::Cell::new(0);
    let found = |bound: f64| {
        asked.set(0);
        let at = |scale: f64| Ok(vec![PartError::new(Law::pinion_radial(), Length::from_mm(scale).unwrap())]);
        let conforms = |errors: &[PartError]| {
            asked.set(asked.get() + 1);
            errors[0].value().base() <= bound
        };
        simulation::largest_scale(at, conforms).map(|errors| errors[0].value().base())
    };
    for bound in [3e-5, 0.0123, 1.0, 500.0] {
        let scale = found(bound).unwrap();
        assert!(scale <= bound && scale > bound * (1.0 - 2e-9), "{bound}: {scale}");
        assert!(asked.get() < 60, "{bound}: {}", asked.get());
    }
    assert_eq!(found(0.0).unwrap(), 0.0);
    assert!(asked.get() < 60, "{}", asked.get());
    assert!(matches!(found(f64::INFINITY), Err(BudgetError::Unbounded)));
    assert!(asked.get() < 60, "{}", asked.get());
}

#[test]
fn spreads_have_names() {
    let names = [simulation::Spread::Uniform, simulation::Spread::Normal, simulation::Spread::Triangular];
    assert_eq!(names.map(simulation::Spread::name), ["uniform", "normal", "triangular"]);
}

#[test]
fn a_single_uniform_error_conforms_up_to_its_quantile() {
    // |e| ≤ L for a fraction L/T of a uniform error: T = L / 0.95
    let settings = simulation(0.95, simulation::Spread::Uniform);
    let entries = vec![Entry::Free(Law::rack_over_roller(), weight(1))];
    let budget = allocate(&request(entries, "0.0475", Rule::Simulation(settings))).unwrap();
    let simulated = budget.simulated.unwrap();
    assert!(simulated.conforming >= 0.95 && simulated.conforming < 0.9501);
    assert!((budget.lines[0].delta_cd.mm() - 0.05).abs() < 0.0003);
}

/// Within a fraction p of its tolerance lies 0.95 of a triangular error for 1 − (1 − p)² = 0.95, and of a normal one
/// that is cut at three standard deviations for 2Φ(3p) − 1 = 0.95 (2Φ(3) − 1).
#[test]
fn other_distributions_conform_up_to_their_quantiles() {
    use crate::decision::statistics::{normal_cdf, normal_quantile};
    let normal = normal_quantile(0.5 + 0.475 * (2.0 * normal_cdf(3.0) - 1.0)) / 3.0;
    for (spread, quantile) in
        [(simulation::Spread::Triangular, 1.0 - 0.05_f64.sqrt()), (simulation::Spread::Normal, normal)]
    {
        let entries = vec![Entry::Free(Law::rack_over_roller(), weight(1))];
        let budget = allocate(&request(entries, "0.05", Rule::Simulation(simulation(0.95, spread)))).unwrap();
        assert!((budget.lines[0].delta_cd.mm() * quantile / 0.05 - 1.0).abs() < 0.01, "{spread:?}");
    }
}

#[test]
fn simulated_tolerances_conform_and_no_more() {
    let [over_roller, pitch, lead, radial, pinion_pitch] = formulas("20", "10", "19.7");
    for spread in [simulation::Spread::Uniform, simulation::Spread::Normal, simulation::Spread::Triangular] {
        let settings = simulation(0.99, spread);
        let entries = vec![
            Entry::Free(over_roller, weight(1)),
            Entry::Free(pitch, weight(1)),
            Entry::Free(lead, weight(1)),
            Entry::Fixed(PartError::new(radial, length("0.004"))),
            Entry::Free(pinion_pitch, weight(1)),
        ];
        let mut request = request(entries, "0.05", Rule::Simulation(settings));
        let budget = allocate(&request).unwrap();
        let fraction = |enlarged: Option<usize>| {
            let lines = budget.lines.iter().enumerate();
            let fixed = lines.map(|(index, line)| {
                Entry::Fixed(read_again(&line.error, if enlarged == Some(index) { 1.01 } else { 1.0 }))
            });
            let request = Request { entries: fixed.collect(), ..request.clone() };
            allocate(&request).unwrap().simulated.unwrap().conforming
        };
        assert!(fraction(None) >= 0.99);
        for index in [0, 1, 2, 4] {
            assert!(fraction(Some(index)) < 0.99, "{spread:?} {index}");
        }
        // worst case is stricter
        request.rule = Rule::WorstCase;
        assert!(allocate(&request).unwrap().lines[0].delta_cd < budget.lines[0].delta_cd);
    }
}

/// Of three errors, one is stopped by its own limit, one by the budget, and a fixed one by nothing.
#[test]
fn an_own_limit_in_a_simulated_budget() {
    let settings = simulation(0.99, simulation::Spread::Uniform);
    let [over_roller, pitch, ..] = formulas("20", "0", "19.7");
    let entries = vec![
        Entry::Free(over_roller, weight(1)),
        Entry::Free(pitch, weight(1)),
        Entry::Fixed(PartError::new(Law::pinion_radial(), length("0.004"))),
    ];
    let mut request = request(entries, "0.05", Rule::Simulation(settings));
    request.own_limits = vec![
        (ErrorKind::RackPitch, Limit { lower: None, upper: Some(length("0.005")) }),
        (ErrorKind::PinionRadial, Limit::symmetric(length("0.004"))),
    ];
    let budget = allocate(&request).unwrap();
    assert_eq!(budget.lines.iter().map(|line| line.at_own_limit).collect::<Vec<_>>(), [false, true, false]);
    let own = budget.lines[1].delta_cd.mm();
    assert!(own <= 0.005 && own > 0.005 * (1.0 - 1e-12), "{own}");
    assert!(budget.lines[0].delta_cd.mm() > 0.03);
}

#[test]
fn an_infeasible_simulation_names_what_breaks_it() {
    let settings = simulation(0.99, simulation::Spread::Uniform);
    let entries = vec![
        Entry::Fixed(PartError::new(Law::pinion_radial(), length("0.004"))),
        Entry::Fixed(PartError::new(Law::rack_over_roller(), length("0.09"))),
        Entry::Free(formulas("20", "0", "19.7")[1], weight(1)),
    ];
    let budget = allocate(&request(entries, "0.05", Rule::Simulation(settings))).unwrap();
    assert_eq!(budget.broken_by, [ErrorKind::RackOverRoller]);
    let entries = vec![
        Entry::Fixed(PartError::new(Law::pinion_radial(), length("0.2"))),
        Entry::Fixed(PartError::new(Law::rack_over_roller(), length("0.9"))),
    ];
    let budget = allocate(&request(entries, "0.05", Rule::Simulation(settings))).unwrap();
    assert_eq!(budget.broken_by, [ErrorKind::RackOverRoller, ErrorKind::PinionRadial]);
    // pushing errors never go below a lower limit
    let entries = vec![Entry::Free(formulas("20", "0", "19.7")[1], weight(1))];
    let mut request = request(entries, "0.05", Rule::Simulation(settings));
    request.limit = Limit { lower: Some(length("-0.05")), upper: None };
    assert_eq!(allocate(&request).unwrap_err(), BudgetError::Unbounded);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Any mixture of fixed and free errors, weights and costs, either rule, awkward decimals.
    #[test]
    fn allocations_meet_the_limit_and_nothing_is_left(
        alpha in 5.0..45.0_f64,
        beta in -44.0..44.0_f64,
        width in 1.0..100.0_f64,
        limit in 1e-4..1.0_f64,
        weights in prop::array::uniform5(1_u32..40),
        fixed in prop::array::uniform5(0.0..1.0_f64),
        is_fixed in prop::array::uniform5(any::<bool>()),
        by_cost in any::<bool>(),
        rss in any::<bool>(),
        capped in prop::option::of(0.01..0.9_f64),
    ) {
        let rule = if rss { Rule::Rss } else { Rule::WorstCase };
        let formulas = formulas(&alpha.to_string(), &beta.to_string(), &width.to_string());
        let entries: Vec<Entry> = formulas
            .iter()
            .enumerate()
            .map(|(index, formula)| {
                // five of a fifth at most: always feasible, and something is left
                let share = Length::from_mm(limit * 0.19 * fixed[index]).unwrap();
                let freedom = f64::from(weights[index]);
                match largest_tolerance(*formula, share, Model::Exact) {
                    Ok(error) if is_fixed[index] => Entry::Fixed(error),
                    _ if by_cost => Entry::Free(*formula, Freedom::Cost(freedom)),
                    _ => Entry::Free(*formula, Freedom::Weight(freedom)),
                }
            })
            .collect();
        let mut request = request(entries, &limit.to_string(), rule);
        if let Some(part) = capped
            && !is_fixed[1]
        {
            let upper = Some(Length::from_mm(limit * part).unwrap());
            request.own_limits = vec![(ErrorKind::RackPitch, Limit { lower: None, upper })];
        }
        // a lead error may be unable to reach its share: that is an error of its own
        if let Ok(budget) = allocate(&request) {
            prop_assert!(budget.is_feasible());
            check(&request);
        }
    }
}
