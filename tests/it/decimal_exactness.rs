//! Differences, sums and comparisons of decimal text against integer arithmetic.
//!
//! The tests count in whole units of 10⁻⁷ mm (a thousandth of a mil is 254 of them), where nothing
//! rounds, and write the numbers that the library reads as text.

use proptest::prelude::*;
use rackmesh::decision::{Limit, LimitTarget, Limits, Stack, Verdict, evaluate};
use rackmesh::deviation::ErrorKind;
use rackmesh::formula::{Law, Model, PartError};
use rackmesh::quantity::{Angle, Length, LengthUnit};

/// `units` · 10^−`decimals` as text.
fn decimal(units: i128, decimals: usize) -> String {
    let sign = if units < 0 { "-" } else { "" };
    let digits = format!("{:0>width$}", units.unsigned_abs(), width = decimals + 1);
    let (whole, fraction) = digits.split_at(digits.len() - decimals);
    format!("{sign}{whole}.{fraction}")
}

fn length(text: &str) -> Length {
    text.parse().expect(text)
}

fn angle(text: &str) -> Angle {
    text.parse().expect(text)
}

/// Whole units of 10⁻⁷ mm as a length.
fn exact(units: i128) -> Length {
    length(&decimal(units, 7))
}

/// The `f64` that the decimal itself reads as: decimal arithmetic, rounded once.
fn rounded_once(units: i128, decimals: usize) -> f64 {
    decimal(units, decimals).parse().unwrap()
}

/// A length as text in some unit, and in units of 10⁻⁷ mm.
#[derive(Debug, Clone)]
struct Written {
    text: String,
    units: i128,
}

impl Written {
    fn new(count: i64, unit: LengthUnit) -> Self {
        let count = i128::from(count);
        match unit {
            LengthUnit::Millimetre => Self { text: decimal(count, 7) + " mm", units: count },
            LengthUnit::Micrometre => Self { text: decimal(count, 4) + " um", units: count },
            LengthUnit::Inch => Self { text: decimal(count, 6) + " in", units: 254 * count },
            LengthUnit::Mil => Self { text: decimal(count, 3) + " mil", units: 254 * count },
            other => panic!("{other:?} is new: say what it is"),
        }
    }

    fn length(&self) -> Length {
        length(&self.text)
    }
}

fn unit() -> impl Strategy<Value = LengthUnit> {
    prop_oneof![
        Just(LengthUnit::Millimetre),
        Just(LengthUnit::Micrometre),
        Just(LengthUnit::Inch),
        Just(LengthUnit::Mil)
    ]
}

/// Up to a tenth of a mm, or up to a metre or so; either sign.
fn count() -> impl Strategy<Value = i64> {
    prop_oneof![-1_000_000..=1_000_000_i64, -40_000_000..=40_000_000_i64]
}

fn written() -> impl Strategy<Value = Written> {
    (count(), unit()).prop_map(|(count, unit)| Written::new(count, unit))
}

/// On a limit, or the smallest step to either side.
fn step() -> impl Strategy<Value = i128> {
    -1..=1_i128
}

fn verdict(pass: bool) -> Verdict {
    if pass { Verdict::Pass } else { Verdict::Fail }
}

/// Sums are kept in quarters of 10⁻⁷ mm, as the gains below are quarters.
fn quarters(quarters: i128) -> Length {
    length(&decimal(25 * quarters, 9))
}

/// An error whose ΔCD by the exact model is a rational part of the length written for it.
#[derive(Debug, Clone)]
struct Term {
    written: Written,
    gain: Gain,
}

#[derive(Debug, Clone, Copy)]
enum Gain {
    OverRoller,
    Radial,
    /// cos β / (2 tan α_n) = 1/2, 1/4, 3/4
    RackPitch(&'static str, &'static str, i128),
    PinionPitch(&'static str, &'static str, i128),
    /// sin Δβ / (2 cos β tan α_n): the length is the face width
    Lead(&'static str, &'static str, &'static str, i128),
}

const GAINS: [Gain; 11] = [
    Gain::OverRoller,
    Gain::Radial,
    Gain::RackPitch("45", "0", 2),
    Gain::RackPitch("45", "-60", 1),
    Gain::RackPitch("30", "30", 3),
    Gain::PinionPitch("45", "0", 2),
    Gain::PinionPitch("45", "60", 1),
    Gain::PinionPitch("30", "-30", 3),
    Gain::Lead("45", "0", "30", 1),
    Gain::Lead("45", "60", "-30", 2),
    Gain::Lead("30", "-30", "30", 2),
];

impl Term {
    fn error(&self) -> PartError {
        let value = self.written.length();
        match self.gain {
            Gain::OverRoller => PartError::new(Law::rack_over_roller(), value),
            Gain::Radial => PartError::new(Law::pinion_radial(), value),
            Gain::RackPitch(alpha, beta, _) => {
                PartError::new(Law::rack_pitch(angle(alpha), angle(beta)).unwrap(), value)
            }
            Gain::PinionPitch(alpha, beta, _) => {
                PartError::new(Law::pinion_pitch(angle(alpha), angle(beta)).unwrap(), value)
            }
            Gain::Lead(alpha, beta, error, _) => {
                let formula = Law::rack_lead(angle(alpha), angle(beta), value.abs()).unwrap();
                PartError::new(formula, angle(error))
            }
        }
    }

    /// ΔCD in quarters of 10⁻⁷ mm.
    fn delta_cd(&self) -> i128 {
        match self.gain {
            Gain::OverRoller | Gain::Radial => 4 * self.written.units,
            Gain::RackPitch(.., gain) | Gain::PinionPitch(.., gain) | Gain::Lead(.., gain) => {
                gain * self.written.units.abs()
            }
        }
    }

    fn always_acts(&self) -> bool {
        matches!(self.gain, Gain::OverRoller | Gain::Radial)
    }
}

fn term() -> impl Strategy<Value = Term> {
    let nonzero = written().prop_filter("a face width is not 0", |written| written.units != 0);
    (nonzero, prop::sample::select(&GAINS[..])).prop_map(|(written, gain)| Term { written, gain })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_difference_is_that_of_the_decimals(a in written(), b in written()) {
        let difference = a.length() - b.length();
        let units = a.units - b.units;
        prop_assert_eq!(difference, exact(units));
        prop_assert_eq!(difference.mm(), rounded_once(units, 7));
        prop_assert_eq!(difference.in_unit(LengthUnit::Micrometre), rounded_once(units, 4));
        prop_assert_eq!((b.length() - a.length()).mm(), rounded_once(-units, 7));
    }

    #[test]
    fn a_difference_in_inches_is_decimal_in_inches(a in count(), b in count()) {
        for (unit, decimals) in [(LengthUnit::Inch, 6), (LengthUnit::Mil, 3)] {
            let difference = Written::new(a, unit).length() - Written::new(b, unit).length();
            prop_assert_eq!(difference.in_unit(unit), rounded_once(i128::from(a) - i128::from(b), decimals));
        }
    }

    #[test]
    fn a_sum_is_that_of_the_decimals(terms in prop::collection::vec(written(), 0..9)) {
        let sum = terms.iter().map(Written::length).fold(Length::ZERO, |sum, term| sum + term);
        let units: i128 = terms.iter().map(|term| term.units).sum();
        prop_assert_eq!(sum, exact(units));
        prop_assert_eq!(sum.mm(), rounded_once(units, 7));
    }

    #[test]
    fn a_number_is_read_to_the_nearest_step(digits in "[1-9][0-9]{0,30}", exponent in -360..310_i32, negative: bool) {
        let text = format!("{}{digits}e{exponent}", if negative { "-" } else { "" });
        let mm: f64 = text.parse().unwrap();
        match text.parse::<Length>() {
            Ok(length) => prop_assert!((length.mm() - mm).abs() <= 0.5e-12 + 2.0 * f64::EPSILON * mm.abs(), "{}", text),
            Err(_) => prop_assert!(mm.abs() > 1e6 * (1.0 - 1e-15), "{} was refused", text),
        }
    }

    #[test]
    fn what_a_spreadsheet_leaves_on_a_difference_goes(measured in 24_000_000..26_000_000_i32, decimals in 13..17_usize) {
        // as it is shown with all its digits, and in powers of ten
        let (mm, units) = (f64::from(measured) / 1e6, measured - 25_000_000);
        let residue = mm - 25.0;
        for text in [format!("{residue:.decimals$}"), format!("{residue:e}"), format!("{residue:.14E}")] {
            prop_assert_eq!(length(&text), exact(10 * i128::from(units)), "{}", text);
        }
        prop_assert_eq!(length(&format!("{mm:.decimals$}")), exact(10 * i128::from(measured)));
    }

    #[test]
    fn minutes_and_seconds_are_exact(degrees in 0..90_i64, minutes in 0..60_i64, millis in 0..60_000_i64) {
        let read = angle(&format!("{degrees}° {minutes}' {}\"", decimal(millis.into(), 3)));
        prop_assert_eq!(read.nas(), (degrees * 3600 + minutes * 60) * 1_000_000_000 + millis * 1_000_000);
        prop_assert_eq!(angle(&read.to_string()), read);
    }

    #[test]
    fn a_limit_is_compared_in_decimal(measured in written(), nominal in written(), step in step(), width in 0..3_i128) {
        let deviation = measured.length() - nominal.length();
        let units = measured.units - nominal.units;
        for (lower, upper) in [(units + step, units + step + width), (units + step - width, units + step)] {
            let expected = verdict(lower <= units && units <= upper);
            let both = Limit { lower: Some(exact(lower)), upper: Some(exact(upper)) };
            prop_assert_eq!(both.judge(deviation, deviation), expected);
            let below = Limit { lower: None, upper: Some(exact(upper)) };
            prop_assert_eq!(below.judge(deviation, deviation), verdict(units <= upper));
            let above = Limit { lower: Some(exact(lower)), upper: None };
            prop_assert_eq!(above.judge(deviation, deviation), verdict(lower <= units));
        }
        let magnitude = units.abs() + step;
        if magnitude >= 0 {
            let symmetric = Limit::symmetric(exact(magnitude));
            prop_assert_eq!(symmetric.judge(deviation, deviation), verdict(units.abs() <= magnitude));
            prop_assert_eq!(symmetric.judge(-deviation, deviation.abs()), verdict(units.abs() <= magnitude));
        }
    }

    #[test]
    fn one_error_is_judged_in_decimal(term in term(), below in step(), above in step()) {
        let delta_cd = term.delta_cd();
        let limit = Limit { lower: Some(quarters(delta_cd + below)), upper: Some(quarters(delta_cd + above)) };
        let error = term.error();
        let limits: Limits = vec![(LimitTarget::Error(error.kind()), limit)];
        let evaluation = evaluate(&[error], &limits, Model::Exact, Stack::Range).unwrap();
        prop_assert_eq!(evaluation.contributions[0].exact, quarters(delta_cd));
        prop_assert_eq!(evaluation.verdict, Some(verdict(below <= 0 && above >= 0)));
    }

    #[test]
    fn sums_are_judged_in_decimal(
        terms in prop::collection::vec(term(), 1..7), below in step(), above in step(), by_magnitude in step(),
    ) {
        let errors: Vec<_> = terms.iter().map(Term::error).collect();
        let lower: i128 = terms.iter().filter(|term| term.always_acts()).map(Term::delta_cd).sum();
        let upper: i128 = terms.iter().map(Term::delta_cd).sum();
        let worst: i128 = terms.iter().map(|term| term.delta_cd().abs()).sum();
        let on_center_distance = |limit: Limit| -> Limits { vec![(LimitTarget::CenterDistance, limit)] };

        let limit = Limit { lower: Some(quarters(lower + below)), upper: Some(quarters(upper + above)) };
        let range = evaluate(&errors, &on_center_distance(limit), Model::Exact, Stack::Range).unwrap();
        prop_assert_eq!(range.combined.range_lower, quarters(lower));
        prop_assert_eq!(range.combined.range_upper, quarters(upper));
        prop_assert_eq!(range.combined.range_upper.mm(), rounded_once(25 * upper, 9));
        prop_assert_eq!(range.verdict, Some(verdict(below <= 0 && above >= 0)));

        let limit = Limit::symmetric(quarters(worst + by_magnitude));
        let worst_case = evaluate(&errors, &on_center_distance(limit), Model::Exact, Stack::WorstCase).unwrap();
        prop_assert_eq!(worst_case.combined.worst_case, quarters(worst));
        // the smallest limit is its magnitude: of a sum of 0 minus a step, one step
        prop_assert_eq!(worst_case.verdict, Some(verdict(worst <= (worst + by_magnitude).abs())));
    }

    #[test]
    fn a_rational_root_is_judged_in_decimal(
        tuple in prop::sample::select(vec![
            (vec![3, 4], 5), (vec![5, 12], 13), (vec![8, 15], 17), (vec![20, 21], 29),
            (vec![1, 2, 2], 3), (vec![2, 3, 6], 7), (vec![2, 4, 5, 6], 9), (vec![1], 1),
        ]),
        scale in 1..2_000_000_i64, unit in unit(), signs in prop::collection::vec(any::<bool>(), 4), step in step(),
    ) {
        let (legs, root) = tuple;
        let errors: Vec<_> = legs.iter().zip(signs).map(|(leg, negative)| {
            let value = Written::new(if negative { -leg * scale } else { leg * scale }, unit).length();
            if leg % 2 == 0 { PartError::new(Law::pinion_radial(), value) } else { PartError::new(Law::rack_over_roller(), value) }
        }).collect();
        let units = Written::new(root * scale, unit).units;
        let limits: Limits = vec![(LimitTarget::CenterDistance, Limit::symmetric(exact(units + step)))];
        let evaluation = evaluate(&errors, &limits, Model::Exact, Stack::Rss).unwrap();
        prop_assert_eq!(evaluation.combined.rss, exact(units));
        prop_assert_eq!(evaluation.verdict, Some(verdict(step >= 0)));
    }
}

#[test]
fn every_tenth_of_a_micrometre_is_inside_its_own_limit() {
    let nominal = length("25.0000");
    let (mut other_numbers, mut wrong_verdicts) = (0, 0);
    for step in 0..=1500 {
        let (measured, limit) = (decimal(250_000 + step, 4), decimal(step, 4));
        let error = length(&measured) - nominal;
        assert_eq!(error, length(&limit), "{measured}");
        assert_eq!(error.mm(), limit.parse::<f64>().unwrap(), "{measured}");
        for sign in [1, -1] {
            let signed = if sign == 1 { error } else { -error };
            for (allowed, expected) in [(step, Verdict::Pass), (step - 1, Verdict::Fail)] {
                if allowed < 0 {
                    continue;
                }
                let limits: Limits =
                    vec![(LimitTarget::CenterDistance, Limit::symmetric(length(&decimal(allowed, 4))))];
                let errors = [PartError::new(Law::rack_over_roller(), signed)];
                let verdict = evaluate(&errors, &limits, Model::Exact, Stack::Range).unwrap().verdict;
                assert_eq!(verdict, Some(expected), "{measured}, {sign}, ±{allowed}");
            }
        }
        // what binary subtraction makes of the same texts
        let binary = measured.parse::<f64>().unwrap() - 25.0;
        other_numbers += i32::from(binary != limit.parse::<f64>().unwrap());
        wrong_verdicts += i32::from(binary > limit.parse::<f64>().unwrap());
    }
    println!("of 1501 binary differences {other_numbers} are other numbers, and {wrong_verdicts} fail wrongly");
    assert!(other_numbers > 1000, "{other_numbers}");
    assert!(wrong_verdicts > 500, "{wrong_verdicts}");
}

#[test]
fn units_and_signs_in_one_sum() {
    for (texts, sum) in [
        (&["25.0131", "-25.0000"][..], "0.0131"),
        (&["0.1", "0.2", "-0.3"], "0"),
        (&["1 in", "-25.4 mm"], "0"),
        (&["1 mil", "-25.4 um"], "0"),
        (&["0.0005 in", "0.3 um", "-13 um"], "0"),
        (&["-0.5 in", "12.7001 mm", "0.1 µm"], "0.0002"),
        (&["1e-7", "1e6", "-1e6"], "1e-7"),
        (&["-0.7 mil", "17.78 μm", "-1e-12"], "-1e-12"),
    ] {
        let total = texts.iter().fold(Length::ZERO, |sum, text| sum + length(text));
        assert_eq!(total, length(sum), "{texts:?}");
        assert_eq!(total.mm(), sum.parse::<f64>().unwrap(), "{texts:?}");
    }
}

#[test]
fn limits_on_several_targets() {
    // 0.0131 − 0.02 always, and between 0 and 3/4 · 0.02 by the pitch
    let errors = [
        PartError::new(Law::rack_over_roller(), length("25.0131") - length("25.0000")),
        PartError::new(Law::pinion_radial(), length("-20 um")),
        PartError::new(Law::rack_pitch(angle("30"), angle("30")).unwrap(), length("-0.02")),
    ];
    let limit = |lower: &str, upper: &str| Limit { lower: Some(length(lower)), upper: Some(length(upper)) };
    let limits: Limits = vec![
        (LimitTarget::CenterDistance, limit("-6.9 um", "8.1 um")),
        (LimitTarget::Error(ErrorKind::RackOverRoller), limit("0.0131", "0.0131")),
        (LimitTarget::Error(ErrorKind::PinionRadial), limit("-0.02", "0")),
        (LimitTarget::Error(ErrorKind::RackPitch), limit("15 um", "0.015")),
    ];
    let evaluation = evaluate(&errors, &limits, Model::Exact, Stack::Range).unwrap();
    assert_eq!(evaluation.verdict, Some(Verdict::Pass));
    assert_eq!(evaluation.combined.range_upper.mm(), 0.0081);
    for check in &evaluation.limits {
        let (lower, upper) = check.result.unwrap();
        let below = Limit { lower: None, upper: Some(upper - length("1e-12")) };
        let above = Limit { lower: Some(lower + length("1e-12")), upper: None };
        assert_eq!(below.judge(lower, upper), Verdict::Fail, "{}", check.on);
        assert_eq!(above.judge(lower, upper), Verdict::Fail, "{}", check.on);
    }
}
