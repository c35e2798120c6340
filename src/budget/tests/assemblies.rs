//! Budgets by simulated assemblies.

use super::*;

/// The largest scale is found to a part in 10⁹ in some sixty simulations, whether it is 0, finite or unbounded.
#[test]
fn the_largest_scale_is_found_soon_and_closely() {
    let asked = std::cell::Cell::new(0);
    let found = |bound: f64, known: f64| {
        asked.set(0);
        let at = |scale: f64| Ok(vec![PartDeviation::new(Law::pinion_radial(), Length::from_mm(scale).unwrap())]);
        let conforms = |errors: &[PartDeviation]| {
            asked.set(asked.get() + 1);
            let value = errors[0].value().base();
            if value > known { Err(NoBound::BeyondReach) } else { Ok(value <= bound) }
        };
        simulation::largest_scale(at, conforms).map(|largest| largest.errors[0].value().base())
    };
    for bound in [3e-5, 0.0123, 1.0, 500.0] {
        for known in [f64::INFINITY, 1.1 * bound] {
            let scale = found(bound, known).unwrap();
            assert!(scale <= bound && scale > bound * (1.0 - 2e-9), "{bound}: {scale}");
            assert!(asked.get() < 70, "{bound}: {}", asked.get());
        }
        assert_eq!(found(bound, 0.9 * bound), Err(BudgetError::Unbounded));
    }
    assert_eq!(found(0.0, f64::INFINITY), Ok(0.0));
    assert!(asked.get() < 70, "{}", asked.get());
    assert_eq!(found(f64::INFINITY, f64::INFINITY), Err(BudgetError::Unbounded));
    assert!(asked.get() < 70, "{}", asked.get());
}

#[test]
fn spreads_have_names() {
    let names = [ToleranceDistribution::Uniform, ToleranceDistribution::Normal, ToleranceDistribution::Triangular];
    assert_eq!(names.map(ToleranceDistribution::name), ["uniform", "normal", "triangular"]);
}

#[test]
fn a_single_uniform_error_conforms_up_to_its_quantile() {
    // |e| ≤ L for a fraction L/T of a uniform error: T = L / 0.95
    let settings = simulation(0.95, ToleranceDistribution::Uniform);
    let entries = vec![free(Law::rack_over_roller(), weight(1))];
    let budget = allocate(&of_sizes(entries, "0.0475", Summation::Simulation(settings))).unwrap();
    let conforming = budget.conforming.unwrap();
    assert!((0.95..0.9501).contains(&conforming));
    assert!((budget.lines[0].delta_cd.mm() - 0.05).abs() < 0.0003);
}

/// Within a fraction p of its tolerance lies 0.95 of a triangular error for 1 − (1 − p)² = 0.95, and of a normal one
/// that is cut at three standard deviations for 2Φ(3p) − 1 = 0.95 (2Φ(3) − 1).
#[test]
fn other_distributions_conform_up_to_their_quantiles() {
    use crate::statistics::{normal_cdf, normal_quantile};
    let normal = normal_quantile(0.5 + 0.475 * (2.0 * normal_cdf(3.0) - 1.0)) / 3.0;
    for (spread, quantile) in
        [(ToleranceDistribution::Triangular, 1.0 - 0.05_f64.sqrt()), (ToleranceDistribution::Normal, normal)]
    {
        let entries = vec![free(Law::rack_over_roller(), weight(1))];
        let budget = allocate(&of_sizes(entries, "0.05", Summation::Simulation(simulation(0.95, spread)))).unwrap();
        assert!((budget.lines[0].delta_cd.mm() * quantile / 0.05 - 1.0).abs() < 0.01, "{spread:?}");
    }
}

#[test]
fn simulated_tolerances_conform_and_no_more() {
    let [over_roller, pitch, lead, radial, pinion_pitch] = formulas();
    for spread in [ToleranceDistribution::Uniform, ToleranceDistribution::Normal, ToleranceDistribution::Triangular] {
        let settings = RandomAssemblies { draws: 20_000, ..simulation(0.99, spread) };
        let entries = vec![
            free(over_roller, weight(1)),
            free(pitch, weight(1)),
            free(lead, weight(1)),
            fixed(radial, "0.004"),
            free(pinion_pitch, weight(1)),
        ];
        let request = request(entries, "0.05", Summation::Simulation(settings));
        let budget = allocate(&request).unwrap();
        let assembly = Assembly::new(&request, &settings);
        let fraction = |enlarged: Option<usize>| {
            let lines = budget.lines.iter().enumerate();
            let errors: Vec<_> = lines
                .map(|(index, line)| read_again(&line.error, if enlarged == Some(index) { 1.02 } else { 1.0 }))
                .collect();
            assembly.conforming(&errors).unwrap()
        };
        assert_eq!(fraction(None), budget.conforming.unwrap());
        assert!(fraction(None) >= 0.99);
        for index in [0, 1, 2, 4] {
            assert!(fraction(Some(index)) < 0.99, "{spread:?} {index}");
        }
    }
}

/// The worst case gives no larger tolerances than a simulation in which every assembly conforms, and not much smaller ones.
#[test]
fn the_worst_case_approaches_a_simulation_in_which_all_conform() {
    let [over_roller, pitch, lead, radial, pinion_pitch] = formulas();
    let all = Summation::Simulation(simulation(1.0, ToleranceDistribution::Uniform));
    for laws in [[over_roller, pitch, lead], [radial, pinion_pitch, pitch], [lead, radial, pinion_pitch]] {
        for (lower, upper) in [("-0.05", "0.05"), ("-0.03", "0.08")] {
            let of = |rule: Summation| {
                let entries = laws.iter().map(|law| free(*law, weight(1))).collect();
                let request = Request { limit: limit(Some(lower), Some(upper)), ..request(entries, "1", rule) };
                allocate(&request).unwrap().lines[0].delta_cd.mm()
            };
            let (worst, simulated) = (of(Summation::WorstCase), of(all));
            assert!(worst <= simulated && simulated < 1.05 * worst, "{laws:?} {lower}: {worst} {simulated}");
        }
    }
}

/// Of three errors, one is stopped by its own limit, one by the budget, and a fixed one by nothing.
#[test]
fn an_own_limit_in_a_simulated_budget() {
    let settings = simulation(0.99, ToleranceDistribution::Uniform);
    let [over_roller, pitch, _, radial, _] = formulas();
    let entries = vec![free(over_roller, weight(1)), free(pitch, weight(1)), fixed(radial, "0.004")];
    let mut request = request(entries, "0.05", Summation::Simulation(settings));
    request.own_limits = vec![
        (DeviationKind::RackPitch, limit(None, Some("0.005"))),
        (DeviationKind::PinionRadial, Limit::symmetric(length("0.004"))),
    ];
    let budget = allocate(&request).unwrap();
    assert_eq!(budget.lines.iter().map(|line| line.at_own_limit).collect::<Vec<_>>(), [false, true, false]);
    let own = budget.lines[1].range.upper.mm();
    assert!(own <= 0.005 && own > 0.005 * (1.0 - 1e-6), "{own}");
    assert!(budget.lines[0].delta_cd.mm() > 0.03);
}

#[test]
fn an_infeasible_simulation_names_what_breaks_it() {
    let settings = simulation(0.99, ToleranceDistribution::Uniform);
    let [over_roller, pitch, _, radial, _] = formulas();
    let entries = vec![fixed(radial, "0.004"), fixed(over_roller, "0.09"), free(pitch, weight(1))];
    let budget = allocate(&request(entries, "0.05", Summation::Simulation(settings))).unwrap();
    assert_eq!(budget.broken_by, [DeviationKind::RackOverRoller]);
    let entries = vec![fixed(radial, "0.2"), fixed(over_roller, "0.9")];
    let budget = allocate(&of_sizes(entries, "0.05", Summation::Simulation(settings))).unwrap();
    assert_eq!(budget.broken_by, [DeviationKind::RackOverRoller, DeviationKind::PinionRadial]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any mixture of fixed and free errors, weights and costs, either rule, awkward decimals.
    #[test]
    fn allocations_meet_the_limit_and_nothing_is_left(
        upper in 5e-3..0.1_f64,
        lower in 0.3..2.0_f64,
        weights in prop::array::uniform5(1_u32..40),
        shares in prop::array::uniform5(0.0..1.0_f64),
        is_fixed in prop::array::uniform5(any::<bool>()),
        by_cost in any::<bool>(),
        rss in any::<bool>(),
        own in prop::option::of(0.01..0.9_f64),
    ) {
        let entries: Vec<Entry> = formulas()
            .into_iter()
            .enumerate()
            .map(|(index, law)| {
                // few and small enough to be feasible whatever adds up
                let share = Length::from_mm(upper * lower.min(1.0) * 0.03 * shares[index]).unwrap();
                let freedom = f64::from(weights[index]);
                match largest_tolerance(&Free { law, freedom: weight(1), extent: Extent::Each }, share, Model::Exact).unwrap() {
                    error if is_fixed[index] => Entry::Fixed(error),
                    _ if by_cost => free(law, Freedom::Cost(freedom)),
                    _ => free(law, Freedom::Weight(freedom)),
                }
            })
            .collect();
        let mut request = request(entries, "1", if rss { Summation::Rss } else { Summation::WorstCase });
        let mm = |mm: f64| Some(Length::from_mm(mm).unwrap());
        request.limit = Limit { lower: mm(-lower * upper), upper: mm(upper) };
        if let Some(part) = own && !is_fixed[1] {
            request.own_limits = vec![(DeviationKind::RackPitch, Limit { lower: None, upper: mm(upper * part) })];
        }
        check(&request);
    }
}

/// A pair of incomplete geometry whose ΔCD is not 0 without errors: that ΔCD counts.
#[test]
fn the_own_delta_cd_of_a_pair_counts_in_a_simulation() {
    let all_conform =
        Summation::Simulation(RandomAssemblies { draws: 20_000, ..simulation(1.0, ToleranceDistribution::Uniform) });
    let of = |own_curve| {
        let basis = Basis { own_curve, ..Basis::default() };
        allocate(&Request { basis, ..of_sizes(vec![free(Law::rack_over_roller(), weight(1))], "0.1", all_conform) })
    };
    let largest = |own_mm| of(OwnCurve::At(own_mm)).unwrap().lines[0].delta_cd.mm();
    for own_mm in [0.0, 0.08, -0.08] {
        let found = largest(own_mm);
        assert!(found >= 0.1 - own_mm.abs() && found < 1.01 * (0.1 - own_mm.abs()), "{own_mm}: {found}");
    }
    assert!(of(OwnCurve::Unknown).is_err());
}
