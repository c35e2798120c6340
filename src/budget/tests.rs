//! The guarantees of a budget, evaluated forward as `eval` does it.

mod assemblies;

use std::sync::OnceLock;

use proptest::prelude::*;

use super::ToleranceDistribution;
use super::*;
use crate::deviation::Extent;
use crate::deviation::Extent::{All, Each, One, Part, Total};
use crate::evaluation::{Evaluation, evaluate};
use crate::judge::Limit;
use crate::judge::bound::{GivenGeometry, GivenPair, KnownPairs, OwnCurve};
use crate::judge::{LimitTarget, Stack, Verdict};
use crate::quantity::Angle;

fn length(text: &str) -> Length {
    text.parse().unwrap()
}

/// The laws of the paper's pair.
fn formulas() -> [Law; 5] {
    let angle = |text: &str| -> Angle { text.parse().unwrap() };
    [
        Law::rack_over_roller(),
        Law::rack_pitch(angle("19.9"), Angle::ZERO).unwrap(),
        Law::rack_lead(angle("19.9"), Angle::ZERO, length("19.7")).unwrap(),
        Law::pinion_radial(),
        Law::pinion_pitch(angle("19.9"), angle("21")).unwrap(),
    ]
}

/// The paper's pair, prepared once.
fn pair() -> Basis {
    static PAIR: OnceLock<Basis> = OnceLock::new();
    let prepared = || {
        let given = GivenPair::plain(crate::reproduction::pair().unwrap());
        Basis { geometry: GivenGeometry::Known(KnownPairs::new(given)), ..Basis::default() }
    };
    PAIR.get_or_init(prepared).clone()
}

fn weight(number: u32) -> Freedom {
    Freedom::Weight(f64::from(number))
}

fn free(law: Law, freedom: Freedom) -> Entry {
    Entry::Free(Free { law, freedom, extent: Extent::Each })
}

fn fixed(law: Law, value: &str) -> Entry {
    Entry::Fixed(PartDeviation::within(law, length(value)))
}

/// A budget of sizes, which need no pair: decimals add up exactly.
fn of_sizes(entries: Vec<Entry>, limit: &str, rule: Summation) -> Request {
    Request { basis: Basis::default(), ..request(entries, limit, rule) }
}

fn request(entries: Vec<Entry>, limit: &str, rule: Summation) -> Request {
    Request {
        entries,
        limit: Limit::symmetric(length(limit)),
        own_limits: Vec::new(),
        rule,
        model: Model::Exact,
        basis: pair(),
    }
}

fn limit(lower: Option<&str>, upper: Option<&str>) -> Limit {
    Limit { lower: lower.map(length), upper: upper.map(length) }
}

/// An error read again from the double that is printed.
fn read_again(error: &PartDeviation, factor: f64) -> PartDeviation {
    let value = error.value().abs().base() * factor;
    let value = match error.value() {
        DeviationValue::Length(_) => DeviationValue::Length(Length::from_mm(value).unwrap()),
        _ => DeviationValue::Angle(Angle::from_degrees(value).unwrap()),
    };
    error.with_value(value)
}

/// The evaluation of a budget's tolerances, some of them enlarged by 1 %.
fn evaluated(budget: &Budget, request: &Request, is_enlarged: impl Fn(&Line) -> bool) -> Evaluation {
    let lines = budget.lines.iter();
    let errors: Vec<PartDeviation> =
        lines.map(|line| read_again(&line.error, if is_enlarged(line) { 1.01 } else { 1.0 })).collect();
    let mut limits = vec![(LimitTarget::CenterDistance, request.limit)];
    limits.extend(request.own_limits.iter().map(|(kind, limit)| (LimitTarget::Error(*kind), *limit)));
    evaluate(&errors, &limits, request.model, stack(request), &request.basis).unwrap()
}

fn stack(request: &Request) -> Stack {
    if request.rule == Summation::Rss { Stack::Rss } else { Stack::Range }
}

fn simulation(conforming: f64, spread: ToleranceDistribution) -> RandomAssemblies {
    RandomAssemblies { conforming, spread, draws: 100_000, seed: 1 }
}

/// Checks that the budget meets the limit, and breaks it once all free tolerances grow by 1 %, or one that moves the end
/// that binds.
fn check(request: &Request) -> Budget {
    let budget = allocate(request).unwrap();
    assert!(budget.is_feasible(), "{budget:?}");
    let interval = |evaluation: &Evaluation| evaluation.combined.interval(stack(request)).unwrap();
    let found = evaluated(&budget, request, |_| false);
    assert_eq!(found.verdict, Some(Verdict::Pass), "{budget:?}");
    let ends = interval(&found);
    let binds = |end: Length, limit: Option<Length>| limit.is_some_and(|limit| (limit - end).abs().mm() < 1e-7);
    let (lower_binds, upper_binds) = (binds(ends.lower, request.limit.lower), binds(ends.upper, request.limit.upper));
    for line in budget.lines.iter().filter(|line| !line.is_fixed) {
        let larger = evaluated(&budget, request, |other| other.error.kind() == line.error.kind());
        let moved = interval(&larger);
        let matters = (lower_binds && moved.lower < ends.lower) || (upper_binds && moved.upper > ends.upper);
        let fails = larger.verdict == Some(Verdict::Fail);
        assert!(fails || !(matters || line.at_own_limit), "{:?} of {budget:?}", line.error);
    }
    if budget.lines.iter().any(|line| !line.is_fixed) {
        let larger = evaluated(&budget, request, |line| !line.is_fixed);
        assert_eq!(larger.verdict, Some(Verdict::Fail), "{budget:?}");
    }
    budget
}

#[test]
fn shares_stand_in_the_ratio_of_weights() {
    let [over_roller, pitch, lead, radial, _] = formulas();
    for rule in [Summation::WorstCase, Summation::Rss] {
        let entries =
            vec![fixed(radial, "0.01"), free(over_roller, weight(1)), free(pitch, weight(2)), free(lead, weight(1))];
        let budget = check(&request(entries, "0.05", rule));
        let shares: Vec<f64> = budget.lines.iter().map(|line| line.delta_cd.mm()).collect();
        assert_eq!(shares[0], 0.01);
        assert!((shares[2] / shares[1] - 2.0).abs() < 1e-6 && (shares[3] / shares[1] - 1.0).abs() < 1e-6, "{shares:?}");
        assert!((budget.lines.iter().map(|line| line.share).sum::<f64>() - 1.0).abs() < 1e-12);
    }
}

/// 0.01 of 0.05 leaves 0.04, and 3, 4 and 12 make 13: to the last decimal.
#[test]
fn sizes_share_a_limit_exactly() {
    let [over_roller, _, _, radial, _] = formulas();
    let budget =
        check(&of_sizes(vec![fixed(radial, "0.01"), free(over_roller, weight(3))], "0.05", Summation::WorstCase));
    assert_eq!(budget.lines[1].error.value(), DeviationValue::Length(length("0.04")));
    let budget = check(&of_sizes(vec![fixed(over_roller, "0.05"), free(radial, weight(7))], "0.13", Summation::Rss));
    assert_eq!(budget.lines[1].error.value(), DeviationValue::Length(length("0.12")));
    assert!((budget.lines[0].share - 25.0 / 169.0).abs() < 1e-12, "{:?}", budget.lines);
}

#[test]
fn costs_are_smallest_where_they_are_said_to_be() {
    let [over_roller, _, _, radial, _] = formulas();
    let cost = Freedom::Cost;
    for (rule, ratio) in [(Summation::WorstCase, 8_f64.sqrt()), (Summation::Rss, 2.0)] {
        let entries = vec![free(over_roller, cost(1.0)), free(radial, cost(8.0))];
        let budget = check(&of_sizes(entries, "0.06", rule));
        let (a, b) = (budget.lines[0].delta_cd.mm(), budget.lines[1].delta_cd.mm());
        assert!((b / a - ratio).abs() < 1e-7);
        // the sum of costs at neighbouring allocations is larger
        let total = |a: f64| {
            let b = if rule == Summation::Rss { (0.06_f64 * 0.06 - a * a).sqrt() } else { 0.06 - a };
            1.0 / a + 8.0 / b
        };
        assert!(total(a) < total(a * 1.001) && total(a) < total(a * 0.999));
    }
}

/// The lower limit does not stop an error that can only raise ΔCD; it stops errors that together can lower it.
#[test]
fn each_end_of_the_limit_stops_what_reaches_it() {
    let [_, pitch, _, _, pinion_pitch] = formulas();
    let of = |laws: &[Law], lower: &str, upper: &str| {
        let entries = laws.iter().map(|law| free(*law, weight(1))).collect();
        let request = Request { limit: limit(Some(lower), Some(upper)), ..request(entries, "1", Summation::WorstCase) };
        check(&request).lines[0].delta_cd.mm()
    };
    assert_eq!(alone(PartDeviation::within(pitch, length("0.01")), &pair()).unwrap().lower, Length::ZERO);
    assert_eq!(of(&[pitch], "-0.001", "0.08"), of(&[pitch], "-0.08", "0.08"));
    let both = [pitch, pinion_pitch];
    let (wide, narrow, one_sided) =
        (of(&both, "-0.08", "0.08"), of(&both, "-0.03", "0.03"), of(&both, "-0.03", "0.08"));
    assert!(narrow < one_sided && one_sided <= wide, "{narrow} {one_sided} {wide}");
    let alone = of(&both, "-0.001", "0.08");
    assert!(alone < narrow, "{alone} {narrow}");
}

/// Tolerances of one tooth, of a run, of all teeth: the bound of either sign meets the limit.
#[test]
fn tolerances_are_of_the_teeth_that_their_extents_say() {
    let [over_roller, pitch, lead, radial, pinion_pitch] = formulas();
    let of = |extents: [Extent; 5], rule| {
        let entries = [over_roller, pitch, lead, radial, pinion_pitch].into_iter().zip(extents);
        let entries = entries.map(|(law, extent)| Entry::Free(Free { law, freedom: weight(1), extent })).collect();
        request(entries, "0.05", rule)
    };
    for extents in [[One; 5], [Part; 5], [All; 5], [All, One, All, One, Total], [Each, One, One, Part, Each]] {
        let request = of(extents, Summation::WorstCase);
        let budget = check(&request);
        // a measured error has a sign
        for sign in [1.0, -1.0] {
            let errors: Vec<_> = budget.lines.iter().map(|line| read_again(&line.error.measured(), sign)).collect();
            let limits = [(LimitTarget::CenterDistance, request.limit)].to_vec();
            let found = evaluate(&errors, &limits, Model::Exact, Stack::Range, &request.basis).unwrap();
            assert_eq!(found.verdict, Some(Verdict::Pass), "{extents:?} {sign}");
        }
        check(&of(extents, Summation::Rss));
        let few = RandomAssemblies { draws: 5_000, ..simulation(1.0, ToleranceDistribution::Uniform) };
        let simulated = allocate(&of(extents, Summation::Simulation(few))).unwrap();
        assert!(simulated.lines[0].delta_cd >= budget.lines[0].delta_cd, "{extents:?}");
    }
    let granted = |extents| allocate(&of(extents, Summation::WorstCase)).unwrap().lines[0].delta_cd;
    assert!(granted([One; 5]) > granted([Each; 5]));
}

/// One pitch adds to none: no geometry is needed.
#[test]
fn the_pitch_of_one_tooth_needs_no_pair() {
    let one = Free { law: formulas()[1], freedom: weight(1), extent: Extent::One };
    let budget = check(&of_sizes(vec![Entry::Free(one)], "0.05", Summation::WorstCase));
    assert_eq!(budget.lines[0].delta_cd, length("0.05"));
    // without geometry a step may lower ΔCD
    assert_eq!(budget.lines[0].range.lower, length("-0.05"));
}

#[test]
fn an_own_limit_leaves_more_to_the_others() {
    let [over_roller, _, _, radial, _] = formulas();
    for (own, at_own_limit, left) in [("0.005", true, "0.045"), ("0.025", false, "0.025"), ("1", false, "0.025")] {
        let entries = vec![free(over_roller, weight(1)), free(radial, weight(1))];
        let mut request = of_sizes(entries, "0.05", Summation::WorstCase);
        request.own_limits = vec![(DeviationKind::PinionRadial, Limit::symmetric(length(own)))];
        let budget = check(&request);
        assert_eq!([budget.lines[0].at_own_limit, budget.lines[1].at_own_limit], [false, at_own_limit], "{own}");
        assert_eq!(budget.lines[0].delta_cd, length(left));
    }
    // the rest that own limits leave goes to no error
    let mut alone = of_sizes(vec![free(radial, weight(1))], "0.05", Summation::WorstCase);
    alone.own_limits = vec![(DeviationKind::PinionRadial, Limit::symmetric(length("0.005")))];
    let budget = check(&alone);
    assert!(budget.lines[0].at_own_limit && budget.lines[0].delta_cd == length("0.005"));
    // of a pitch, the ΔCD of all teeth in contact counts
    let entries = vec![free(over_roller, weight(1)), free(formulas()[1], weight(1))];
    let mut request = request(entries, "0.05", Summation::WorstCase);
    request.own_limits = vec![(DeviationKind::RackPitch, limit(None, Some("0.005")))];
    let budget = check(&request);
    assert!(budget.lines[1].at_own_limit && budget.lines[1].range.upper <= length("0.005"));
}

#[test]
fn who_has_no_weight_gets_nothing() {
    let [over_roller, _, _, radial, _] = formulas();
    let entries = vec![free(over_roller, weight(1)), free(radial, weight(0))];
    let budget = allocate(&of_sizes(entries, "0.05", Summation::WorstCase)).unwrap();
    assert_eq!([budget.lines[0].delta_cd, budget.lines[1].delta_cd], [length("0.05"), Length::ZERO]);
}

#[test]
fn a_fixed_tolerance_beyond_its_own_limit_breaks_the_budget() {
    let simulated = Summation::Simulation(simulation(0.9, ToleranceDistribution::Uniform));
    for rule in [Summation::WorstCase, Summation::Rss, simulated] {
        for (value, broken) in [("0.009", false), ("0.01", false), ("0.0101", true), ("-0.0101", true)] {
            let entries = vec![fixed(Law::pinion_radial(), value), free(Law::rack_over_roller(), weight(1))];
            let mut request = of_sizes(entries, "0.05", rule);
            request.own_limits = vec![(DeviationKind::PinionRadial, Limit::symmetric(length("0.01")))];
            let budget = allocate(&request).unwrap();
            let expected: &[DeviationKind] = if broken { &[DeviationKind::PinionRadial] } else { &[] };
            assert_eq!(budget.broken_by, expected, "{rule:?} {value}");
            assert_eq!(budget.lines[1].delta_cd == Length::ZERO, broken, "{rule:?} {value}");
        }
    }
}

#[test]
fn an_infeasible_budget_names_what_breaks_it() {
    let [over_roller, pitch, _, radial, _] = formulas();
    let broken_by = |request: Request| allocate(&request).unwrap().broken_by;
    let entries = vec![fixed(radial, "0.04"), fixed(over_roller, "-0.02"), free(pitch, weight(1))];
    assert_eq!(broken_by(request(entries, "0.05", Summation::WorstCase)), [DeviationKind::PinionRadial]);
    // exactly the limit is enough, and leaves nothing for a free one
    let exactly = vec![fixed(radial, "0.05")];
    assert_eq!(broken_by(of_sizes(exactly.clone(), "0.05", Summation::WorstCase)), []);
    let and_free = [exactly, vec![free(over_roller, weight(1))]].concat();
    assert_eq!(broken_by(of_sizes(and_free, "0.05", Summation::WorstCase)), [DeviationKind::PinionRadial]);
    let two = vec![fixed(radial, "0.06"), fixed(over_roller, "0.07")];
    assert_eq!(
        broken_by(of_sizes(two, "0.05", Summation::Rss)),
        [DeviationKind::RackOverRoller, DeviationKind::PinionRadial]
    );
}

#[test]
fn a_limit_without_room_is_an_error() {
    let of = |lower: Option<&str>, upper: Option<&str>| {
        let entries = vec![free(Law::rack_over_roller(), weight(1))];
        let request = Request { limit: limit(lower, upper), ..of_sizes(entries, "1", Summation::WorstCase) };
        allocate(&request).map(|budget| budget.lines[0].delta_cd.mm())
    };
    assert_eq!(of(Some("-0.02"), Some("0.05")), Ok(0.02));
    assert_eq!(of(None, Some("0.05")), Ok(0.05));
    assert_eq!(of(Some("0.01"), Some("0.05")), Err(BudgetError::NoRoom));
    assert_eq!(of(Some("0"), Some("0.05")), Err(BudgetError::NoRoom));
    assert_eq!(of(None, None), Err(BudgetError::NoLimit));
}

/// Every pitch adds up with those beside it: how many are in contact must be known.
#[test]
fn pitches_need_the_pair() {
    let entries = vec![free(formulas()[1], weight(1))];
    let problem = allocate(&of_sizes(entries, "0.05", Summation::WorstCase)).unwrap_err();
    assert_eq!(problem, BudgetError::NoBound(NoBound::TeethInContactUnknown));
}

/// A limit so far away that the teeth are gone before it is reached.
#[test]
fn a_limit_must_stop_the_tolerances_while_the_pair_meshes() {
    for rule in [
        Summation::WorstCase,
        Summation::Simulation(RandomAssemblies { draws: 1000, ..simulation(0.99, ToleranceDistribution::Uniform) }),
    ] {
        let entries = vec![free(Law::rack_over_roller(), weight(1))];
        assert_eq!(allocate(&request(entries, "20", rule)).unwrap_err(), BudgetError::Unbounded, "{rule:?}");
    }
}
