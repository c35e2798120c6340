//! What is outside a domain is an error that names the quantity and its domain, and nothing panics.

use proptest::prelude::*;
use rackmesh::deviation::DeviationValue;
use rackmesh::evaluation::evaluate;
use rackmesh::formula::law::lead_slope;
use rackmesh::formula::over_pin::OverPin;
use rackmesh::formula::{Law, Model, PartDeviation, ideal_pin, roller_change};
use rackmesh::judge::bound::Basis;
use rackmesh::judge::{Combined, Interval, Stack};
use rackmesh::quantity::{Angle, DomainError, Length};

const MODELS: [Model; 2] = [Model::Exact, Model::Paper];

fn mm(value: f64) -> Length {
    Length::from_mm(value).unwrap()
}

fn deg(value: f64) -> Angle {
    Angle::from_degrees(value).unwrap()
}

type Call = fn(f64) -> Result<(), DomainError>;

/// An input of a formula: the formula with everything else in its domain, and what its error says.
struct Case {
    formula: &'static str,
    quantity: &'static str,
    unit: &'static str,
    domain: &'static str,
    outside: &'static [f64],
    inside: &'static [f64],
    call: Call,
}

const NOT_POSITIVE: &[f64] = &[0.0, -0.0, -1e-300, -1e-12, -0.5, -19.7, -1e6];
const POSITIVE: &[f64] = &[1e-12, 1e-6, 0.5, 3.5, 1e5];
const NEGATIVE: &[f64] = &[-1e-12, -0.01, -1e6];
const NOT_PRESSURE: &[f64] = &[0.0, -0.0, -1e-12, -20.0, 45.000_000_000_001, 45.1, 60.0, 90.0, 180.0, 277_777.0];
const PRESSURE: &[f64] = &[1e-12, 20.0, 30.0, 44.999_999_999_999, 45.0];
const NOT_INCLINED: &[f64] = &[90.0, -90.0, 90.000_000_000_001, -90.000_000_000_001, 180.0, -270.0, 277_777.0];
const INCLINED: &[f64] = &[0.0, 1e-12, -1e-12, 12.0, -60.0, 89.999_999_999_999, -89.999_999_999_999];

impl Case {
    const fn pressure_angle(formula: &'static str, call: Call) -> Self {
        Self {
            formula,
            quantity: "normal pressure angle α_n",
            unit: "°",
            domain: "above 0° and at most 45°",
            outside: NOT_PRESSURE,
            inside: PRESSURE,
            call,
        }
    }

    const fn inclination(formula: &'static str, quantity: &'static str, call: Call) -> Self {
        Self {
            formula,
            quantity,
            unit: "°",
            domain: "above -90° and below 90°",
            outside: NOT_INCLINED,
            inside: INCLINED,
            call,
        }
    }

    const fn positive(formula: &'static str, quantity: &'static str, call: Call) -> Self {
        Self { formula, quantity, unit: " mm", domain: "above 0 mm", outside: NOT_POSITIVE, inside: POSITIVE, call }
    }

    const fn not_negative(formula: &'static str, quantity: &'static str, call: Call) -> Self {
        Self { formula, quantity, unit: " mm", domain: "at least 0 mm", outside: NEGATIVE, inside: POSITIVE, call }
    }
}

fn over_pin() -> OverPin {
    OverPin {
        normal_module: mm(2.0),
        normal_pressure_angle: deg(20.0),
        tooth_thickness: None,
        pin_diameter: mm(3.5),
        datum: mm(20.0),
    }
}

fn measure(over_pin: &OverPin) -> Result<(), DomainError> {
    over_pin.sensitivities()?;
    over_pin.measure().map(drop)
}

fn pin(module: f64, alpha: f64, thickness: Option<f64>) -> Result<(), DomainError> {
    let thickness = thickness.map(mm);
    ideal_pin::diameter(mm(module), deg(alpha), thickness).map(drop)
}

fn rollers(from: f64, to: f64, alpha: f64) -> Result<(), DomainError> {
    roller_change::difference(mm(from), mm(to), deg(alpha)).map(drop)
}

fn lead() -> Law {
    Law::rack_lead(deg(20.0), deg(12.0), mm(19.7)).unwrap()
}

const CASES: &[Case] = &[
    Case::positive("ideal pin", "normal module m_n", |v| pin(v, 20.0, None)),
    Case::pressure_angle("ideal pin", |v| pin(2.0, v, None)),
    Case::positive("ideal pin", "tooth thickness s_n", |v| pin(2e5, 20.0, Some(v))),
    Case::positive("over-pin", "normal module m_n", |v| measure(&OverPin { normal_module: mm(v), ..over_pin() })),
    Case::pressure_angle("over-pin", |v| measure(&OverPin { normal_pressure_angle: deg(v), ..over_pin() })),
    Case::positive("over-pin", "tooth thickness s_n", |v| {
        measure(&OverPin { normal_module: mm(2e5), tooth_thickness: Some(mm(v)), ..over_pin() })
    }),
    Case::positive("over-pin", "pin diameter d_p", |v| measure(&OverPin { pin_diameter: mm(v), ..over_pin() })),
    Case::not_negative("over-pin", "distance from the datum to the reference plane K", |v| {
        measure(&OverPin { datum: mm(v), ..over_pin() })
    }),
    Case::positive("roller change", "pin diameter d_p", |v| rollers(v, 3.0, 20.0)),
    Case::positive("roller change", "pin diameter d_p", |v| rollers(3.0, v, 20.0)),
    Case::pressure_angle("roller change", |v| rollers(3.0, 4.0, v)),
    Case::pressure_angle("rack pitch", |v| Law::rack_pitch(deg(v), deg(12.0)).map(drop)),
    Case::inclination("rack pitch", "helix angle of the rack β_r", |v| Law::rack_pitch(deg(20.0), deg(v)).map(drop)),
    Case::not_negative("rack pitch", "centre distance deviation of a pitch or lead error ΔCD", |v| {
        let formula = Law::rack_pitch(deg(20.0), deg(12.0))?;
        MODELS.iter().try_for_each(|model| formula.largest_error(mm(v), *model).map(drop))
    }),
    Case::pressure_angle("pinion pitch", |v| Law::pinion_pitch(deg(v), deg(12.0)).map(drop)),
    Case::inclination("pinion pitch", "helix angle of the pinion β_p", |v| {
        Law::pinion_pitch(deg(20.0), deg(v)).map(drop)
    }),
    Case::not_negative("pinion pitch", "centre distance deviation of a pitch or lead error ΔCD", |v| {
        let formula = Law::pinion_pitch(deg(20.0), deg(12.0))?;
        MODELS.iter().try_for_each(|model| formula.largest_error(mm(v), *model).map(drop))
    }),
    Case::pressure_angle("pinion lead", |v| Law::pinion_lead(deg(v), deg(12.0)).map(drop)),
    Case::inclination("pinion lead", "helix angle of the pinion β_p", |v| {
        Law::pinion_lead(deg(20.0), deg(v)).map(drop)
    }),
    Case::not_negative("pinion lead", "centre distance deviation of a pitch or lead error ΔCD", |v| {
        let formula = Law::pinion_lead(deg(20.0), deg(12.0))?;
        MODELS.iter().try_for_each(|model| formula.largest_error(mm(v), *model).map(drop))
    }),
    Case::pressure_angle("rack lead", |v| Law::rack_lead(deg(v), deg(12.0), mm(19.7)).map(drop)),
    Case::inclination("rack lead", "helix angle of the rack β_r", |v| {
        Law::rack_lead(deg(20.0), deg(v), mm(19.7)).map(drop)
    }),
    Case::positive("rack lead", "face width of the rack k", |v| Law::rack_lead(deg(20.0), deg(12.0), mm(v)).map(drop)),
    Case::inclination("rack lead", "lead angle error Δβ", |v| lead().delta_cd(deg(v), Model::Exact).map(drop)),
    Case::inclination("rack lead", "lead angle error Δβ", |v| lead().delta_cd(deg(v), Model::Paper).map(drop)),
    Case::inclination("rack lead", "lead angle error Δβ", |v| lead().sensitivities(deg(v), Model::Exact).map(drop)),
    Case::inclination("rack lead", "lead angle error Δβ", |v| lead().sensitivities(deg(v), Model::Paper).map(drop)),
    Case::not_negative("rack lead", "centre distance deviation of a pitch or lead error ΔCD", |v| {
        lead().largest_error(mm(v), Model::Paper).map(drop)
    }),
    Case::positive("slope", "evaluation length L", |v| lead_slope(mm(0.01), mm(v)).map(drop)),
    Case::positive("slope", "evaluation length L", |v| lead_slope(mm(-1e6), mm(v)).map(drop)),
];

#[test]
fn outside_a_domain_the_error_names_quantity_and_domain() {
    for case in CASES {
        for value in case.outside {
            let error = (case.call)(*value).expect_err(&format!("{} of {}: {value:e}", case.formula, case.quantity));
            // what is finer than the grid is nothing, and a zero has no sign
            let shown = if value.abs() < 1e-13 { 0.0 } else { *value };
            let shown = if case.unit == "°" { deg(shown).to_string() } else { mm(shown).to_string() };
            let expected = format!("the {} is {shown}; it must be {}", case.quantity, case.domain);
            assert_eq!(error.to_string(), expected, "{}", case.formula);
        }
    }
}

#[test]
fn inside_a_domain_there_is_a_result_up_to_its_ends() {
    for case in CASES {
        for value in case.inside {
            let result = (case.call)(*value);
            // the ends of a domain may lead beyond the numbers, which is then said so
            let beyond = matches!(result, Err(DomainError::Overflow(_)))
                && (*value > 9e4 || *value < 1e-9 || (value.abs() - 90.0).abs() < 1e-9);
            assert!(result.is_ok() || beyond, "{} of {}: {value:e}: {result:?}", case.formula, case.quantity);
        }
    }
}

#[test]
fn a_value_that_is_no_number_is_refused() {
    for (value, shown) in [
        (f64::NAN, "NaN"),
        (-f64::NAN, "NaN"),
        (f64::from_bits(0x7ff0_0000_0000_0001), "NaN"),
        (f64::INFINITY, "inf"),
        (f64::NEG_INFINITY, "-inf"),
    ] {
        let length = Length::from_mm(value).unwrap_err().to_string();
        assert_eq!(length, format!("the length is {shown}; it must be a finite number"));
        let angle = Angle::from_degrees(value).unwrap_err().to_string();
        assert_eq!(angle, format!("the angle is {shown}; it must be a finite number"));
    }
    for text in ["nan", "NaN", "inf", "-inf", "infinity", "+Infinity"] {
        let length = text.parse::<Length>().unwrap_err().to_string();
        assert_eq!(length, format!("`{text}` is not a length: a finite number is needed"));
        let angle = text.parse::<Angle>().unwrap_err().to_string();
        assert_eq!(angle, format!("`{text}` is not an angle: a finite number is needed"));
    }
    for text in ["1e309", "-1.000000000000001e6", "1e99999"] {
        let error = text.parse::<Length>().unwrap_err().to_string();
        assert_eq!(error, "the length is too large: its magnitude must stay within 1e6 mm", "{text}");
        let error = text.parse::<Angle>().unwrap_err().to_string();
        assert_eq!(error, "the angle is too large: its magnitude must stay within 277777°", "{text}");
    }
}

#[test]
fn a_tooth_as_thick_as_the_pitch_leaves_no_space() {
    for thickness in [7.853_981_633_975, 8.0, 1e6] {
        let expected = format!(
            "the tooth thickness s_n is {}; it must be below the normal pitch π m_n = 7.853981633974 mm",
            mm(thickness)
        );
        assert_eq!(pin(2.5, 20.0, Some(thickness)).unwrap_err().to_string(), expected);
        let over_pin = OverPin { normal_module: mm(2.5), tooth_thickness: Some(mm(thickness)), ..over_pin() };
        assert_eq!(over_pin.measure().unwrap_err().to_string(), expected);
        assert_eq!(over_pin.sensitivities().unwrap_err().to_string(), expected);
    }
    assert!(pin(2.5, 20.0, Some(7.853_981_633_974)).is_ok());
}

#[test]
fn a_delta_cd_that_no_lead_error_reaches() {
    // k / (2 cos β_r tan α_n) = 5 mm
    let formula = Law::rack_lead(deg(45.0), deg(60.0), mm(5.0)).unwrap();
    for delta_cd in [5.0, 5.1, 1e6] {
        assert_eq!(
            formula.largest_error(mm(delta_cd), Model::Exact).unwrap_err().to_string(),
            format!("no lead angle error below 90° reaches a ΔCD of {}: the largest possible is 5 mm", mm(delta_cd))
        );
    }
    assert!(formula.largest_error(mm(4.999_999_999_999), Model::Exact).is_ok());
}

#[test]
fn a_result_beyond_the_grid_names_what_it_is() {
    let (huge, tiny, steep) = (mm(1e6), deg(1e-12), deg(89.999_999_999_999));
    let pitch = Law::rack_pitch(tiny, steep).unwrap();
    let pinion = Law::pinion_pitch(tiny, Angle::ZERO).unwrap();
    let lead = Law::rack_lead(tiny, steep, huge).unwrap();
    let over_pin = OverPin { normal_pressure_angle: tiny, ..over_pin() };
    for (error, what) in [
        (ideal_pin::diameter(huge, deg(20.0), None).unwrap_err(), "the pin diameter d_p'"),
        (over_pin.measure().unwrap_err(), "the measure M over the pin"),
        (roller_change::difference(mm(3.0), mm(4.0), tiny).unwrap_err(), "the difference ΔM"),
        (pitch.delta_cd(mm(0.01), Model::Paper).unwrap_err(), "ΔCD"),
        (pinion.delta_cd(mm(-0.01), Model::Exact).unwrap_err(), "ΔCD"),
        (lead.delta_cd(deg(0.25), Model::Exact).unwrap_err(), "ΔCD"),
        (lead.delta_cd(deg(0.25), Model::Paper).unwrap_err(), "ΔCD"),
    ] {
        assert_eq!(error.to_string(), format!("{what} is too large: its magnitude must stay within 1e6 mm"));
    }
    let flat = Law::rack_pitch(deg(45.0), steep).unwrap();
    assert_eq!(
        flat.largest_error(huge, Model::Exact).unwrap_err().to_string(),
        "no pitch error up to 1 km reaches a ΔCD of 1000000 mm: the largest possible is 9.696e-9 mm"
    );
}

#[test]
fn an_evaluation_says_which_error_it_stumbled_over() {
    let evaluated = |errors: &[PartDeviation]| {
        evaluate(errors, &vec![], Model::Exact, Stack::Range, &Basis::default()).unwrap_err().to_string()
    };
    let flat = Law::rack_pitch(deg(1e-12), Angle::ZERO).unwrap();
    let beyond = "is too large: its magnitude must stay within 1e6 mm";
    let shift = PartDeviation::new(Law::rack_over_roller(), mm(0.01));
    assert_eq!(
        evaluated(&[shift, PartDeviation::new(lead(), deg(-90.0))]),
        "rack lead: the lead angle error Δβ is -90°; it must be above -90° and below 90°"
    );
    assert_eq!(evaluated(&[shift, PartDeviation::new(flat, mm(0.01))]), format!("rack pitch: ΔCD {beyond}"));
    let huge = [Law::rack_over_roller(), Law::pinion_radial()].map(|law| PartDeviation::new(law, mm(6e5)));
    assert_eq!(evaluated(&huge), format!("combination: the sum of ΔCD {beyond}"));
}

/// A finite result, or an error that says what must be otherwise.
fn said<T>(result: Result<T, DomainError>, finite: impl Fn(&T) -> bool) -> Result<(), TestCaseError> {
    match result {
        Ok(value) => prop_assert!(finite(&value)),
        Err(error) => {
            let text = error.to_string();
            let explained = ["it must be", "is too large", "the largest possible is"];
            prop_assert!(explained.iter().any(|words| text.contains(words)), "{}", text);
        }
    }
    Ok(())
}

macro_rules! lengths_in_range {
    () => {
        |length: &Length| length.mm().abs() <= 1e6
    };
}

macro_rules! finite_sensitivities {
    () => {
        |all| all.iter().all(|sensitivity| sensitivity.value.is_none_or(f64::is_finite))
    };
}

/// Every formula of these numbers, whatever they are.
fn everything(lengths: &[f64; 4], angles: &[f64; 3]) -> Result<(), TestCaseError> {
    let mut l = vec![];
    for value in lengths {
        match Length::from_mm(*value) {
            Ok(length) => {
                prop_assert!((length.mm() - value).abs() <= 0.5e-12 + 2.0 * f64::EPSILON * value.abs());
                l.push(length);
            }
            Err(_) => prop_assert!(!value.is_finite() || value.abs() > 9.99e5),
        }
    }
    let mut a = vec![];
    for value in angles {
        match Angle::from_degrees(*value) {
            Ok(angle) => {
                prop_assert!((angle.degrees() - value).abs() <= 1.4e-13 + 2.0 * f64::EPSILON * value.abs());
                a.push(angle);
            }
            Err(_) => prop_assert!(!value.is_finite() || value.abs() > 2.7e5),
        }
    }
    let (&[l_0, l_1, l_2, l_3], &[a_0, a_1, a_2]) = (&l[..], &a[..]) else { return Ok(()) };
    said(lead_slope(l_0, l_1), |slope| slope.base().is_finite())?;
    for thickness in [None, Some(l_1)] {
        said(ideal_pin::diameter(l_0, a_0, thickness), lengths_in_range!())?;
        let over_pin = OverPin {
            normal_module: l_0,
            normal_pressure_angle: a_0,
            tooth_thickness: thickness,
            pin_diameter: l_2,
            datum: l_3,
        };
        said(over_pin.measure(), lengths_in_range!())?;
        said(over_pin.sensitivities(), finite_sensitivities!())?;
    }
    said(roller_change::difference(l_0, l_1, a_0), lengths_in_range!())?;
    let laws = [
        (Ok(Law::rack_over_roller()), DeviationValue::Length(l_0)),
        (Law::rack_pitch(a_0, a_1), l_0.into()),
        (Law::rack_lead(a_0, a_1, l_2), a_2.into()),
        (Ok(Law::pinion_radial()), l_1.into()),
        (Law::pinion_pitch(a_0, a_1), l_1.into()),
        (Law::pinion_lead(a_0, a_1), l_2.into()),
    ];
    let mut errors = vec![];
    for (law, error) in laws {
        if let Ok(law) = law {
            for model in MODELS {
                said(law.delta_cd(error, model), lengths_in_range!())?;
                said(law.largest_error(l_0, model), |error| error.base().is_finite())?;
                said(law.sensitivities(error, model), finite_sensitivities!())?;
            }
            errors.push(PartDeviation::new(law, error));
        }
        said(law, |_| true)?;
    }
    let evaluation = evaluate(&errors, &vec![], Model::Exact, Stack::Range, &Basis::default());
    said(evaluation.map_err(|error| *error.problem), |evaluation| {
        let Combined { range, rss } = evaluation.combined;
        // a lead of 45° and more has no range
        let in_order = |of: Interval| -1e6 <= of.lower.mm() && of.lower <= of.upper && of.upper.mm() <= 1e6;
        [range, rss].into_iter().flatten().all(in_order)
    })
}

/// Any bit pattern at all: every exponent, subnormal numbers, infinities and NaNs with payloads.
fn any_bits() -> impl Strategy<Value = f64> {
    any::<u64>().prop_map(f64::from_bits)
}

/// Mostly angles that a formula takes.
fn mostly_angles() -> impl Strategy<Value = f64> {
    prop_oneof![any_bits(), -90.0..=90.0, 0.0..=45.0, prop::sample::select(&[0.0, 30.0, 45.0, 60.0, 90.0, 5e-324][..])]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn no_bit_pattern_panics(lengths in prop::array::uniform4(any_bits()), angles in prop::array::uniform3(any_bits())) {
        everything(&lengths, &angles)?;
    }

    #[test]
    fn no_bit_pattern_panics_with_angles_in_reach(
        lengths in prop::array::uniform4(any_bits().prop_map(|value| if value.is_finite() { value.abs() } else { 1.0 })),
        angles in prop::array::uniform3(mostly_angles()),
    ) {
        everything(&lengths, &angles)?;
    }

    #[test]
    fn no_text_panics(text in ".{0,40}", number in "[-+−]?[0-9_.,]{0,25}([eE][-+]?[0-9]{0,20})? ?[a-zµμ°'\"″]{0,6}") {
        for text in [text, number] {
            if let Err(error) = text.parse::<Length>() {
                prop_assert!(error.to_string().contains("length"), "{}", error);
            }
            if let Err(error) = text.parse::<Angle>() {
                prop_assert!(error.to_string().contains("angle"), "{}", error);
            }
        }
    }
}
