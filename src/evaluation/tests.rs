use super::*;
use crate::formula::Law;
use crate::quantity::Angle;

fn angle(text: &str) -> Angle {
    text.parse().unwrap()
}

fn length(text: &str) -> Length {
    text.parse().unwrap()
}

fn center_distance(limit: &str) -> Limits {
    vec![(LimitTarget::CenterDistance, Limit::symmetric(length(limit)))]
}

#[test]
fn a_rational_gain_meets_a_decimal_limit_exactly() {
    // cos 30° / (2 tan 30°) = 3/4, and 1/(2 tan 45°) = 1/2
    let errors = [
        PartDeviation::new(Law::rack_pitch(angle("30"), angle("30")).unwrap(), length("0.02")),
        PartDeviation::new(Law::pinion_pitch(angle("45"), angle("0")).unwrap(), length("0.03")),
        PartDeviation::new(Law::rack_over_roller(), length("0.02")),
    ];
    let verdict = |limit: &str| {
        evaluate(&errors, &center_distance(limit), Model::Exact, Stack::Range, &Basis::default()).unwrap().verdict
    };
    assert_eq!(verdict("0.05"), Some(Verdict::Pass));
    assert_eq!(verdict("0.049999999999"), Some(Verdict::Fail));
}

#[test]
fn the_stack_picks_what_is_judged() {
    let errors = [
        PartDeviation::within(Law::rack_over_roller(), length("0.03")),
        PartDeviation::within(Law::pinion_radial(), length("0.04")),
    ];
    let verdict = |stack| {
        let limits = center_distance("0.05");
        evaluate(&errors, &limits, Model::Exact, stack, &Basis::default()).unwrap().verdict.unwrap()
    };
    assert_eq!(verdict(Stack::Rss), Verdict::Pass);
    assert_eq!(verdict(Stack::Range), Verdict::Fail);
}

#[test]
fn what_has_no_bound_is_open() {
    let error = PartDeviation::new(Law::rack_pitch(angle("20"), angle("0")).unwrap(), length("0.001"));
    let limits = center_distance("0.05");
    let with = |extent| {
        let errors = [error.with_extent(extent)];
        evaluate(&errors, &limits, Model::Exact, Stack::Range, &Basis::default()).unwrap()
    };
    assert_eq!(with(Extent::One).verdict, Some(Verdict::Pass));
    let open = with(Extent::Each);
    assert_eq!((open.verdict, open.limits[0].result), (None, Err(Unjudged::NoBound(NoBound::TeethInContactUnknown))));
}

#[test]
fn a_limit_without_its_error_is_not_passed() {
    let errors = [PartDeviation::new(Law::rack_over_roller(), length("0.01"))];
    let mut limits = center_distance("0.05");
    limits.push((LimitTarget::Error(DeviationKind::RackLead), Limit::symmetric(length("0.01"))));
    let evaluation = evaluate(&errors, &limits, Model::Exact, Stack::Range, &Basis::default()).unwrap();
    assert_eq!(evaluation.verdict, None);
    assert_eq!(evaluation.not_given().collect::<Vec<_>>(), [LimitTarget::Error(DeviationKind::RackLead)]);
}
