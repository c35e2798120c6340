use super::*;

fn length(text: &str) -> Length {
    text.parse().unwrap()
}

fn verdict(rule: &str, value: &str, u: f64) -> Verdict {
    let value = length(value);
    let limit = Limit::symmetric(length("0.05"));
    decide(&rule.parse().unwrap(), &limit, Interval::value(value), Some(&Ends::value(value.mm(), u)), None)
        .unwrap()
        .verdict
}

#[test]
fn a_guard_band_is_exact_to_the_decimal() {
    use Verdict::{Fail, Indeterminate, Pass};
    for (value, expected) in [
        ("0.04", Pass),
        ("0.0400001", Indeterminate),
        ("0.05", Indeterminate),
        ("0.06", Indeterminate),
        ("0.0600001", Fail),
        ("-0.04", Pass),
        ("-0.0600001", Fail),
    ] {
        assert_eq!(verdict("guard=10um", value, 0.0), expected, "{value}");
    }
    // 1.65 · 0.001 = 0.00165
    for (value, expected) in
        [("0.04835", Pass), ("0.04836", Indeterminate), ("0.05165", Indeterminate), ("0.05166", Fail)]
    {
        assert_eq!(verdict("iso14253", value, 0.001), expected, "{value}");
    }
    assert_eq!(verdict("simple", "0.05", 0.01), Pass);
    assert_eq!(verdict("simple", "0.050001", 0.01), Fail);
}

#[test]
fn probabilities_of_conformance() {
    let limit = Limit::symmetric(length("0.05"));
    let near = |ends: Ends, expected: f64| {
        assert!((ends.conformance(&limit).unwrap() - expected).abs() < 1e-9, "{ends:?}");
    };
    // on one limit, the other far away
    near(Ends::value(0.05, 0.001), 0.5);
    // 1.65 u inside
    near(Ends::value(0.05 - 0.00165, 0.001), normal_cdf(1.65));
    near(Ends::value(0.0, 0.05), normal_cdf(1.0) - normal_cdf(-1.0));
    near(Ends::value(0.05, 0.0), 1.0);
    near(Ends::value(0.0501, 0.0), 0.0);
    // two independent ends
    let ends = Ends {
        lower_mm: -0.049,
        upper_mm: 0.048,
        lower_standard_mm: 0.001,
        upper_standard_mm: 0.001,
        correlation: 0.0,
        ..Ends::value(0.0, 0.0)
    };
    near(ends, normal_cdf(1.0) * normal_cdf(2.0));
    // both ends on their limits: Sheppard's quarter, whatever goes together
    for correlation in [0.8, -0.3, 1.0 - 1e-8, 1.0 - 1e-12, 1.0] {
        let ends = Ends { lower_mm: -0.05, upper_mm: 0.05, correlation, ..ends };
        let expected = 0.25 - crate::trig::asin(correlation) / std::f64::consts::TAU;
        assert!((ends.conformance(&limit).unwrap() - expected).abs() < 1e-5, "{correlation}");
    }
    let open = Limit { lower: None, upper: Some(length("0.05")) };
    assert!((ends.conformance(&open).unwrap() - normal_cdf(2.0)).abs() < 1e-12);
}

/// JCGM 106:2012, table 1 (clause 7.3): how many standard uncertainties inside a one-sided limit a value lies for a
/// probability of conformance.
#[test]
fn jcgm_106_one_sided_limits() {
    let open = Limit { lower: None, upper: Some(length("0.05")) };
    for (z, probability) in [(0.84, 0.80), (1.28, 0.90), (1.64, 0.95), (2.33, 0.99), (3.09, 0.999)] {
        let found = Ends::value(0.05 - 0.001 * z, 0.001).conformance(&open).unwrap();
        // the printed z has two decimals
        let half_a_digit = 0.005 / (std::f64::consts::TAU).sqrt() * libm::exp(-0.5 * (z - 0.005) * (z - 0.005));
        assert!((found - probability).abs() <= half_a_digit, "{z}: {found}");
    }
}

/// JCGM 106:2012, equation (21), and its resistors of 1500 Ω ± 0.2 Ω with a standard deviation of 0.12 Ω: 10 % lie outside.
/// In thousandths of a mm for Ω.
#[test]
fn jcgm_106_two_sided_limits() {
    let limit = Limit { lower: Some(length("1.4998")), upper: Some(length("1.5002")) };
    let inside = Ends::value(1.5, 0.000_12).conformance(&limit).unwrap();
    assert_eq!(format!("{:.0} %", 100.0 * (1.0 - inside)), "10 %");
}

/// ILAC-G8:09/2019, clauses 4.2.1 to 4.2.3 (page 9 and after): simple acceptance, w = 0, passes up to the limit with up to 50 %
/// of false acceptance; a guard band w = U = 2 u passes up to TL − w with 2.5 % at most, fails above TL + w and leaves
/// a conditional result between.
#[test]
fn ilac_g8_cases() {
    use Verdict::{Fail, Indeterminate, Pass};
    let (limit, u) = (Limit { lower: None, upper: Some(length("0.05")) }, 0.001);
    for (rule, value, expected) in [
        ("simple", "0.05", Pass),
        ("simple", "0.050001", Fail),
        ("guard=2um", "0.048", Pass),
        ("guard=2um", "0.048001", Indeterminate),
        ("guard=2um", "0.05", Indeterminate),
        ("guard=2um", "0.052", Indeterminate),
        ("guard=2um", "0.052001", Fail),
    ] {
        let ends = Ends::value(length(value).mm(), u);
        let result = Interval::value(length(value));
        let decision = decide(&rule.parse().unwrap(), &limit, result, Some(&ends), None).unwrap();
        assert_eq!(decision.verdict, expected, "{rule} {value}");
        let false_acceptance = decision.conformance.unwrap().consumer_risk();
        let most = if rule == "simple" { 0.5 } else { 0.025 };
        assert!(expected != Pass || false_acceptance <= most + 1e-12, "{rule} {value}: {false_acceptance}");
    }
}

/// What is inside by 1.65 u passes only with 95 % behind it: two limits, a magnitude near 0 and few degrees of freedom
/// take some away.
#[test]
fn a_pass_has_95_percent_behind_it() {
    use Verdict::{Fail, Indeterminate, Pass};
    let decided = |value: f64, u: f64, lower: &str, tail: Tail| {
        let ends = Ends { lower_tail: tail, upper_tail: tail, ..Ends::value(value, u) };
        let lower = (!lower.is_empty()).then(|| length(lower));
        let limit = Limit { lower, upper: Some(length("0.005")) };
        let result = Interval::value(Length::from_mm(value).unwrap());
        let decision = decide(&Rule::Iso14253, &limit, result, Some(&ends), None).unwrap();
        let probability = decision.conformance.map(|conformance| conformance.probability);
        assert_eq!(probability, ends.conformance(&limit));
        assert!(decision.verdict != Pass || probability >= Some(ISO_14253_PROBABILITY), "{probability:?}");
        decision.verdict
    };
    let few = |dof: f64| Tail { dof: Some(dof), ..Tail::NORMAL };
    let folded = |folds: u8| Tail { folds: Some(folds), ..Tail::NORMAL };
    let (correlated, cancelled) = (Tail { folds: None, ..Tail::NORMAL }, Tail { dof: None, ..Tail::NORMAL });
    for (value, u, lower, tail, expected) in [
        (0.0, 0.003, "", Tail::NORMAL, Pass),
        // 90.4 % between both
        (0.0, 0.003, "-0.005", Tail::NORMAL, Indeterminate),
        (0.0, 0.0025, "-0.005", Tail::NORMAL, Pass),
        // one magnitude: 1.96 u, two: 2.24 u
        (0.0, 0.0026, "", folded(1), Indeterminate),
        (0.0, 0.0025, "", folded(1), Pass),
        (0.0, 0.0023, "", folded(2), Indeterminate),
        (0.0, 0.0022, "", folded(2), Pass),
        (0.0, 0.0, "", correlated, Indeterminate),
        (0.0, 0.0, "", cancelled, Indeterminate),
        (0.010, 0.0, "", cancelled, Indeterminate),
        // Student's t with 4 degrees of freedom: 2.13 u
        (0.0, 0.0024, "", few(4.0), Indeterminate),
        (0.0, 0.0023, "", few(4.0), Pass),
        (0.010, 0.0024, "", few(4.0), Indeterminate),
        (0.010, 0.0023, "", few(4.0), Fail),
        (0.010, 0.0, "", few(4.0), Fail),
    ] {
        assert_eq!(decided(value, u, lower, tail), expected, "{value} {u} {lower} {tail:?}");
    }
}

#[test]
fn a_simulated_probability_decides_where_there_is_one() {
    let (value, limit) = (length("0.049"), Limit::symmetric(length("0.05")));
    for (probability, expected) in [(0.96, Verdict::Pass), (0.94, Verdict::Indeterminate), (0.04, Verdict::Fail)] {
        let decision = decide(&Rule::Iso14253, &limit, Interval::value(value), None, Some(probability)).unwrap();
        assert_eq!(decision.verdict, expected);
        let conformance = decision.conformance.unwrap();
        assert!(conformance.simulated);
        assert!((conformance.consumer_risk() + conformance.producer_risk() - 1.0).abs() < 1e-15);
    }
}

#[test]
fn rules_as_written() {
    assert_eq!("guard=5um".parse::<Rule>().unwrap(), Rule::Guard(length("0.005")));
    assert!("guard=-5um".parse::<Rule>().unwrap_err().to_string().contains("negative"));
    assert!("guard=5".parse::<Rule>().is_ok());
    assert!("iso".parse::<Rule>().unwrap_err().to_string().contains("iso14253"));
}
