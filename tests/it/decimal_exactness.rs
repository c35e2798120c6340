//! Differences, sums and comparisons of decimal text against integer arithmetic.
//!
//! The tests count in whole units of 10⁻⁷ mm (a thousandth of a mil is 254 of them), where nothing
//! rounds, and write the numbers that the library reads as text.

use proptest::prelude::*;
use rackmesh::deviation::{DeviationKind, Extent};
use rackmesh::evaluation::{Evaluation, evaluate};
use rackmesh::formula::law::lead_slope;
use rackmesh::formula::{Law, Model, PartDeviation};
use rackmesh::judge::bound::Basis;
use rackmesh::judge::{Interval, Limit, LimitTarget, Limits, Stack, Verdict};
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

/// Sums are kept in eightieths of 10⁻⁷ mm, which all gains below are multiples of.
fn eightieths(eightieths: i128) -> Length {
    length(&decimal(125 * eightieths, 11))
}

/// By what is known without the pair's geometry.
fn evaluated(errors: &[PartDeviation], limits: &Limits, stack: Stack) -> Evaluation {
    evaluate(errors, limits, Model::Exact, stack, &Basis::default()).expect("the errors are in their domain")
}

/// An error whose ΔCD, and what it can do without the pair's geometry, are rational parts of the length written for it.
#[derive(Debug, Clone)]
struct Term {
    written: Written,
    gain: Gain,
    extent: Extent,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Gain {
    OverRoller,
    Radial,
    /// cos β / (2 tan α_n) = 1/2, 1/4, 3/4: in quarters
    RackPitch(&'static str, &'static str, i128),
    PinionPitch(&'static str, &'static str, i128),
    /// A slope of 3/4 either way, of a spur rack at 45°: the length is the face width.
    Lead(&'static str),
}

const GAINS: [Gain; 10] = [
    Gain::OverRoller,
    Gain::Radial,
    Gain::RackPitch("45", "0", 2),
    Gain::RackPitch("45", "-60", 1),
    Gain::RackPitch("30", "30", 3),
    Gain::PinionPitch("45", "0", 2),
    Gain::PinionPitch("45", "60", 1),
    Gain::PinionPitch("30", "-30", 3),
    Gain::Lead("3 um"),
    Gain::Lead("-3 um"),
];

impl Term {
    fn error(&self) -> PartDeviation {
        let value = self.written.length();
        let error = match self.gain {
            Gain::OverRoller => PartDeviation::new(Law::rack_over_roller(), value),
            Gain::Radial => PartDeviation::new(Law::pinion_radial(), value),
            Gain::RackPitch(alpha, beta, _) => {
                PartDeviation::new(Law::rack_pitch(angle(alpha), angle(beta)).unwrap(), value)
            }
            Gain::PinionPitch(alpha, beta, _) => {
                PartDeviation::new(Law::pinion_pitch(angle(alpha), angle(beta)).unwrap(), value)
            }
            Gain::Lead(slope) => {
                let formula = Law::rack_lead(angle("45"), angle("0"), value.abs()).unwrap();
                PartDeviation::new(formula, lead_slope(length(slope), length("4 um")).unwrap())
            }
        };
        error.with_extent(self.extent)
    }

    /// ΔCD in eightieths of 10⁻⁷ mm.
    fn delta_cd(&self) -> i128 {
        match self.gain {
            Gain::OverRoller | Gain::Radial => 80 * self.written.units,
            Gain::RackPitch(.., gain) | Gain::PinionPitch(.., gain) => 20 * gain * self.written.units.abs(),
            // k sin Δβ / 2, of which sin Δβ is 3/5
            Gain::Lead(_) => 24 * self.written.units.abs(),
        }
    }

    /// What it can do alone, from the lower to the upper end: a size acts with its sign, or as far as it is there, and
    /// what turns or steps acts either way.
    fn ends(&self) -> (i128, i128) {
        let size = self.delta_cd();
        match (self.gain, self.extent) {
            (Gain::OverRoller | Gain::Radial, Extent::All) => (size, size),
            (Gain::OverRoller | Gain::Radial, Extent::Each) => (-size.abs(), size.abs()),
            (Gain::OverRoller | Gain::Radial, _) => (size.min(0), size.max(0)),
            (Gain::RackPitch(..) | Gain::PinionPitch(..), _) => (-size, size),
            // at the ends of the face k sin Δβ / (2 cos Δβ) = 3/8 k, and k/4 from the reference plane
            // (1/cos Δβ − 1) k/4 = 1/16 k more
            (Gain::Lead(_), _) => (-35 * self.written.units.abs(), 35 * self.written.units.abs()),
        }
    }
}

/// A term of sums to 100 mm, as far as binary numbers tell 10⁻¹² mm apart.
fn term() -> impl Strategy<Value = Term> {
    let nonzero = written().prop_filter("a face width is not 0", |written| written.units != 0);
    let usual = nonzero.prop_filter("longer than any part's errors", |written| written.units.abs() <= 100_000_000);
    let extents = prop::sample::select(vec![Extent::One, Extent::Part, Extent::All, Extent::Each]);
    (usual, prop::sample::select(&GAINS[..]), extents).prop_map(|(written, gain, extent)| {
        let is_size = matches!(gain, Gain::OverRoller | Gain::Radial);
        let is_lead = matches!(gain, Gain::Lead(_));
        // pitches of many teeth have no range without the pair
        let extent = if is_size || is_lead { extent } else { Extent::One };
        Term { written, gain, extent }
    })
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
            prop_assert_eq!(both.judge(Interval::value(deviation)), expected);
            let below = Limit { lower: None, upper: Some(exact(upper)) };
            prop_assert_eq!(below.judge(Interval::value(deviation)), verdict(units <= upper));
            let above = Limit { lower: Some(exact(lower)), upper: None };
            prop_assert_eq!(above.judge(Interval::value(deviation)), verdict(lower <= units));
        }
        let magnitude = units.abs() + step;
        if magnitude >= 0 {
            let symmetric = Limit::symmetric(exact(magnitude));
            let either_way = Interval { lower: -deviation.abs(), upper: deviation.abs() };
            prop_assert_eq!(symmetric.judge(Interval::value(deviation)), verdict(units.abs() <= magnitude));
            prop_assert_eq!(symmetric.judge(either_way), verdict(units.abs() <= magnitude));
        }
    }

    #[test]
    fn one_error_is_judged_in_decimal(term in term(), below in step(), above in step()) {
        let (lower, upper) = term.ends();
        let limit = Limit { lower: Some(eightieths(lower + below)), upper: Some(eightieths(upper + above)) };
        let error = term.error();
        let limits: Limits = vec![(LimitTarget::Error(error.kind()), limit)];
        let evaluation = evaluated(&[error], &limits, Stack::Range);
        prop_assert_eq!(evaluation.contributions[0].exact, eightieths(term.delta_cd()));
        prop_assert_eq!(evaluation.verdict, Some(verdict(below <= 0 && above >= 0)));
    }

    #[test]
    fn sums_are_judged_in_decimal(
        terms in prop::collection::vec(term(), 1..7), below in step(), above in step(), by_magnitude in step(),
    ) {
        // leads of one part add up as angles, which are no decimals
        let mut leads = 0;
        let is_first_lead = |term: &Term| {
            leads += i32::from(matches!(term.gain, Gain::Lead(_)));
            !matches!(term.gain, Gain::Lead(_)) || leads == 1
        };
        let terms: Vec<_> = terms.into_iter().filter(is_first_lead).collect();
        let errors: Vec<_> = terms.iter().map(Term::error).collect();
        let lower: i128 = terms.iter().map(|term| term.ends().0).sum();
        let upper: i128 = terms.iter().map(|term| term.ends().1).sum();
        let on_center_distance = |limit: Limit| -> Limits { vec![(LimitTarget::CenterDistance, limit)] };

        let limit = Limit { lower: Some(eightieths(lower + below)), upper: Some(eightieths(upper + above)) };
        let evaluation = evaluated(&errors, &on_center_distance(limit), Stack::Range);
        let range = evaluation.combined.range.unwrap();
        prop_assert_eq!(range, Interval { lower: eightieths(lower), upper: eightieths(upper) });
        prop_assert_eq!(range.upper.mm(), rounded_once(125 * upper, 11));
        prop_assert_eq!(evaluation.verdict, Some(verdict(below <= 0 && above >= 0)));

        let largest = lower.abs().max(upper.abs());
        let limit = Limit::symmetric(eightieths(largest + by_magnitude));
        let evaluation = evaluated(&errors, &on_center_distance(limit), Stack::Range);
        prop_assert_eq!(range.largest().abs(), eightieths(largest));
        // the smallest limit is its magnitude: of a sum of 0 minus a step, one step
        prop_assert_eq!(evaluation.verdict, Some(verdict(largest <= (largest + by_magnitude).abs())));
    }

    #[test]
    fn a_rational_root_is_judged_in_decimal(
        tuple in prop::sample::select(vec![
            (vec![3, 4], 5), (vec![5, 12], 13), (vec![8, 15], 17), (vec![20, 21], 29),
            (vec![1, 2, 2], 3), (vec![2, 3, 6], 7), (vec![2, 4, 5, 6], 9), (vec![1], 1),
        ]),
        scale in 1..100_000_i64, mean in -1_000_000..1_000_000_i64, unit in unit(),
        signs in prop::collection::vec(any::<bool>(), 4), below in step(), above in step(),
    ) {
        let (legs, root) = tuple;
        let mut errors: Vec<_> = legs.iter().zip(signs).map(|(leg, negative)| {
            let value = Written::new(if negative { -leg * scale } else { leg * scale }, unit).length();
            let law = if leg % 2 == 0 { Law::pinion_radial() } else { Law::rack_over_roller() };
            PartDeviation::within(law, value)
        }).collect();
        // what is measured moves all of it
        let measured = Written::new(mean, unit);
        errors.push(PartDeviation::new(Law::rack_over_roller(), measured.length()));
        let units = Written::new(root * scale, unit).units;
        let (lower, upper) = (measured.units - units, measured.units + units);
        let limit = Limit { lower: Some(exact(lower + below)), upper: Some(exact(upper + above)) };
        let evaluation = evaluated(&errors, &vec![(LimitTarget::CenterDistance, limit)], Stack::Rss);
        prop_assert_eq!(evaluation.combined.rss, Ok(Interval { lower: exact(lower), upper: exact(upper) }));
        prop_assert_eq!(evaluation.verdict, Some(verdict(below <= 0 && above >= 0)));
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
                let errors = [PartDeviation::new(Law::rack_over_roller(), signed)];
                let verdict = evaluated(&errors, &limits, Stack::Range).verdict;
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
    // 0.0131 always, down to −0.02 by one space of the pinion, and 3/4 · 0.02 either way by the pitch
    let errors = [
        PartDeviation::new(Law::rack_over_roller(), length("25.0131") - length("25.0000")),
        PartDeviation::new(Law::pinion_radial(), length("-20 um")),
        PartDeviation::new(Law::rack_pitch(angle("30"), angle("30")).unwrap(), length("-0.02")),
    ];
    let limit = |lower: &str, upper: &str| Limit { lower: Some(length(lower)), upper: Some(length(upper)) };
    let limits: Limits = vec![
        (LimitTarget::CenterDistance, limit("-21.9 um", "28.1 um")),
        (LimitTarget::Error(DeviationKind::RackOverRoller), limit("0.0131", "0.0131")),
        (LimitTarget::Error(DeviationKind::PinionRadial), limit("-0.02", "0")),
        (LimitTarget::Error(DeviationKind::RackPitch), limit("-15 um", "0.015")),
    ];
    let evaluation = evaluated(&errors, &limits, Stack::Range);
    assert_eq!(evaluation.verdict, Some(Verdict::Pass));
    assert_eq!(evaluation.combined.range.unwrap().upper.mm(), 0.0281);
    for check in &evaluation.limits {
        let result = check.result.unwrap();
        let below = Limit { lower: None, upper: Some(result.upper - length("1e-12")) };
        let above = Limit { lower: Some(result.lower + length("1e-12")), upper: None };
        assert_eq!(below.judge(result), Verdict::Fail, "{}", check.on);
        assert_eq!(above.judge(result), Verdict::Fail, "{}", check.on);
    }
}
