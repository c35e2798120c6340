//! What is outside a domain is an error that names the quantity and its domain, and nothing panics.

use proptest::prelude::*;
use rackmesh::decision::{Stack, evaluate};
use rackmesh::formula::over_pin::OverPin;
use rackmesh::formula::{
    Model, PartError, PinionPitch, RackLead, RackPitch, ideal_pin, over_roller, pinion_radial, roller_change,
};
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

const NOT_POSITIVE: &[f64] = &[0.0, -0.0, -5e-324, -1e-300, -0.5, -19.7, -1e300, f64::MIN];
const POSITIVE: &[f64] = &[5e-324, 1e-300, 0.5, 3.5, 1e300];
const NEGATIVE: &[f64] = &[-5e-324, -0.01, -1e300, f64::MIN];
const NOT_PRESSURE: &[f64] =
    &[0.0, -0.0, -5e-324, -20.0, 45.000_000_000_000_01, 45.1, 60.0, 90.0, 180.0, 1e300, f64::MAX, f64::MIN];
const PRESSURE: &[f64] = &[1e-100, 20.0, 30.0, 44.999_999_999_999_99, 45.0];
const NOT_INCLINED: &[f64] =
    &[90.0, -90.0, 90.000_000_000_000_01, -90.000_000_000_000_01, 180.0, -270.0, 1e300, f64::MAX, f64::MIN];
const INCLINED: &[f64] = &[0.0, 5e-324, -5e-324, 12.0, -60.0, 89.999_999_999_999_99, -89.999_999_999_999_99];

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
    ideal_pin::sensitivities(&mm(module), &deg(alpha), thickness.as_ref())?;
    ideal_pin::diameter(&mm(module), &deg(alpha), thickness.as_ref()).map(drop)
}

fn rollers(from: f64, to: f64, alpha: f64) -> Result<(), DomainError> {
    roller_change::sensitivities(&mm(from), &mm(to), &deg(alpha))?;
    roller_change::difference(&mm(from), &mm(to), &deg(alpha)).map(drop)
}

fn lead() -> RackLead {
    RackLead::new(&deg(20.0), &deg(12.0), &mm(19.7)).unwrap()
}

const CASES: &[Case] = &[
    Case::positive("ideal pin", "normal module m_n", |v| pin(v, 20.0, None)),
    Case::pressure_angle("ideal pin", |v| pin(2.0, v, None)),
    Case::positive("ideal pin", "tooth thickness s_n", |v| pin(1e307, 20.0, Some(v))),
    Case::positive("over-pin", "normal module m_n", |v| measure(&OverPin { normal_module: mm(v), ..over_pin() })),
    Case::pressure_angle("over-pin", |v| measure(&OverPin { normal_pressure_angle: deg(v), ..over_pin() })),
    Case::positive("over-pin", "tooth thickness s_n", |v| {
        measure(&OverPin { normal_module: mm(1e305), tooth_thickness: Some(mm(v)), ..over_pin() })
    }),
    Case::positive("over-pin", "pin diameter d_p", |v| measure(&OverPin { pin_diameter: mm(v), ..over_pin() })),
    Case::not_negative("over-pin", "distance from the datum to the reference plane K", |v| {
        measure(&OverPin { datum: mm(v), ..over_pin() })
    }),
    Case::positive("roller change", "pin diameter d_p", |v| rollers(v, 3.0, 20.0)),
    Case::positive("roller change", "pin diameter d_p", |v| rollers(3.0, v, 20.0)),
    Case::pressure_angle("roller change", |v| rollers(3.0, 4.0, v)),
    Case::pressure_angle("rack pitch", |v| RackPitch::new(&deg(v), &deg(12.0)).map(drop)),
    Case::inclination("rack pitch", "helix angle of the rack β_r", |v| RackPitch::new(&deg(20.0), &deg(v)).map(drop)),
    Case::not_negative("rack pitch", "centre distance deviation of a pitch or lead error ΔCD", |v| {
        let formula = RackPitch::new(&deg(20.0), &deg(12.0))?;
        MODELS.iter().try_for_each(|model| formula.largest_error(&mm(v), *model).map(drop))
    }),
    Case::pressure_angle("pinion pitch", |v| PinionPitch::new(&deg(v), &deg(12.0)).map(drop)),
    Case::inclination("pinion pitch", "helix angle of the pinion β_p", |v| {
        PinionPitch::new(&deg(20.0), &deg(v)).map(drop)
    }),
    Case::not_negative("pinion pitch", "centre distance deviation of a pitch or lead error ΔCD", |v| {
        let formula = PinionPitch::new(&deg(20.0), &deg(12.0))?;
        MODELS.iter().try_for_each(|model| formula.largest_error(&mm(v), *model).map(drop))
    }),
    Case::pressure_angle("rack lead", |v| RackLead::new(&deg(v), &deg(12.0), &mm(19.7)).map(drop)),
    Case::inclination("rack lead", "helix angle of the rack β_r", |v| {
        RackLead::new(&deg(20.0), &deg(v), &mm(19.7)).map(drop)
    }),
    Case::positive("rack lead", "face width of the rack k", |v| {
        RackLead::new(&deg(20.0), &deg(12.0), &mm(v)).map(drop)
    }),
    Case::inclination("rack lead", "lead angle error Δβ", |v| lead().delta_cd(&deg(v), Model::Exact).map(drop)),
    Case::inclination("rack lead", "lead angle error Δβ", |v| lead().delta_cd(&deg(v), Model::Paper).map(drop)),
    Case::inclination("rack lead", "lead angle error Δβ", |v| lead().sensitivities(&deg(v), Model::Exact).map(drop)),
    Case::inclination("rack lead", "lead angle error Δβ", |v| lead().sensitivities(&deg(v), Model::Paper).map(drop)),
    Case::not_negative("rack lead", "centre distance deviation of a pitch or lead error ΔCD", |v| {
        lead().largest_error(&mm(v), Model::Paper).map(drop)
    }),
    Case::positive("slope", "evaluation length L", |v| RackLead::error_from_slope(&mm(0.01), &mm(v)).map(drop)),
    Case::positive("slope", "evaluation length L", |v| RackLead::error_from_slope(&mm(-1e300), &mm(v)).map(drop)),
];

#[test]
fn outside_a_domain_the_error_names_quantity_and_domain() {
    for case in CASES {
        for value in case.outside {
            let error = (case.call)(*value).expect_err(&format!("{} of {}: {value:e}", case.formula, case.quantity));
            // a zero has no sign once it is exact
            let shown = if *value == 0.0 { 0.0 } else { *value };
            let expected = format!("the {} is {shown}{}; it must be {}", case.quantity, case.unit, case.domain);
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
            let beyond = matches!(result, Err(DomainError::Overflow(_))) && *value > 1e299;
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
    for text in ["1e309", "-1.8e308", "1e99999"] {
        assert!(text.parse::<Length>().unwrap_err().to_string().contains("length"), "{text}");
        assert!(text.parse::<Angle>().unwrap_err().to_string().contains("angle"), "{text}");
    }
}

#[test]
fn a_tooth_as_thick_as_the_pitch_leaves_no_space() {
    for thickness in [7.853_981_633_974_484, 8.0, 1e300, f64::MAX] {
        let expected = format!(
            "the tooth thickness s_n is {thickness} mm; it must be below the normal pitch π m_n = 7.853981633974483 mm"
        );
        assert_eq!(pin(2.5, 20.0, Some(thickness)).unwrap_err().to_string(), expected);
        let over_pin = OverPin { normal_module: mm(2.5), tooth_thickness: Some(mm(thickness)), ..over_pin() };
        assert_eq!(over_pin.measure().unwrap_err().to_string(), expected);
        assert_eq!(over_pin.sensitivities().unwrap_err().to_string(), expected);
    }
    assert!(pin(2.5, 20.0, Some(7.853_981_633_974_483)).is_ok());
}

#[test]
fn a_delta_cd_that_no_lead_error_reaches() {
    // k / (2 cos β_r tan α_n) = 5 mm
    let formula = RackLead::new(&deg(45.0), &deg(60.0), &mm(5.0)).unwrap();
    for delta_cd in [5.0, 5.1, 1e300] {
        assert_eq!(
            formula.largest_error(&mm(delta_cd), Model::Exact).unwrap_err().to_string(),
            format!("no lead angle error below 90° reaches a ΔCD of {delta_cd} mm: the largest possible is 5 mm")
        );
    }
    assert!(formula.largest_error(&mm(5.0_f64.next_down()), Model::Exact).is_ok());
}

#[test]
fn a_result_beyond_the_numbers_names_what_it_is() {
    let huge = mm(f64::MAX);
    let tiny = deg(5e-324);
    let steep = deg(89.999_999_999_999_99);
    let pitch = RackPitch::new(&tiny, &steep).unwrap();
    let sheer = RackPitch::new(&deg(1e-200), &steep).unwrap();
    let flat = RackPitch::new(&deg(45.0), &steep).unwrap();
    let pinion = PinionPitch::new(&tiny, &Angle::ZERO).unwrap();
    let lead = RackLead::new(&tiny, &steep, &huge).unwrap();
    let over_pin = OverPin { normal_pressure_angle: tiny.clone(), ..over_pin() };
    let slanted = OverPin { normal_pressure_angle: deg(1e-200), ..over_pin.clone() };
    let quarter = deg(0.25);
    for (error, what) in [
        (ideal_pin::diameter(&huge, &deg(20.0), None).unwrap_err(), "the pin diameter d_p'"),
        (over_pin.measure().unwrap_err(), "the measure M over the pin"),
        (over_pin.sensitivities().unwrap_err(), "the sensitivity to the pin diameter d_p"),
        (slanted.sensitivities().unwrap_err(), "the sensitivity to the normal pressure angle α_n"),
        (roller_change::difference(&mm(3.0), &mm(4.0), &tiny).unwrap_err(), "the difference ΔM"),
        (
            roller_change::sensitivities(&mm(3.0), &mm(4.0), &tiny).unwrap_err(),
            "the sensitivity to the pin diameter d_p",
        ),
        (pitch.delta_cd(&mm(0.01), Model::Paper).unwrap_err(), "ΔCD"),
        (pitch.sensitivities(&mm(0.01), Model::Paper).unwrap_err(), "the sensitivity to the error itself"),
        (sheer.sensitivities(&mm(0.01), Model::Exact).unwrap_err(), "the sensitivity to the normal pressure angle α_n"),
        (flat.largest_error(&huge, Model::Exact).unwrap_err(), "the pitch error"),
        (pinion.delta_cd(&mm(-0.01), Model::Exact).unwrap_err(), "ΔCD"),
        (lead.delta_cd(&quarter, Model::Exact).unwrap_err(), "ΔCD"),
        (lead.delta_cd(&quarter, Model::Paper).unwrap_err(), "ΔCD"),
        (lead.sensitivities(&quarter, Model::Exact).unwrap_err(), "the sensitivity to the error itself"),
    ] {
        let expected = format!("{what} is beyond the range of double-precision numbers (1.8e308)");
        assert_eq!(error.to_string(), expected);
    }
}

#[test]
fn an_evaluation_says_which_error_it_stumbled_over() {
    let evaluated =
        |errors: &[PartError]| evaluate(errors, &vec![], Model::Exact, Stack::Range).unwrap_err().to_string();
    let flat = RackPitch::new(&deg(5e-324), &Angle::ZERO).unwrap();
    let beyond = "is beyond the range of double-precision numbers (1.8e308)";
    let shift = PartError::RackOverRoller(mm(0.01));
    assert_eq!(
        evaluated(&[shift.clone(), PartError::RackLead(deg(-90.0), lead())]),
        "rack lead: the lead angle error Δβ is -90°; it must be above -90° and below 90°"
    );
    assert_eq!(evaluated(&[shift, PartError::RackPitch(mm(0.01), flat)]), format!("rack pitch: ΔCD {beyond}"));
    let huge = [PartError::RackOverRoller(mm(f64::MAX)), PartError::PinionRadial(mm(f64::MAX))];
    assert_eq!(evaluated(&huge), format!("combination: the sum of ΔCD {beyond}"));
}

/// A finite result, or an error that says what must be otherwise.
fn said<T>(result: Result<T, DomainError>, finite: impl Fn(&T) -> bool) -> Result<(), TestCaseError> {
    match result {
        Ok(value) => prop_assert!(finite(&value)),
        Err(error) => {
            let text = error.to_string();
            let explained = ["it must be", "is beyond the range of", "the largest possible is"];
            prop_assert!(explained.iter().any(|words| text.contains(words)), "{}", text);
        }
    }
    Ok(())
}

fn finite_length(length: &Length) -> bool {
    length.mm().is_finite()
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
                prop_assert_eq!(length.mm(), *value);
                l.push(length);
            }
            Err(_) => prop_assert!(!value.is_finite()),
        }
    }
    let mut a = vec![];
    for value in angles {
        match Angle::from_degrees(*value) {
            Ok(angle) => {
                prop_assert_eq!(angle.degrees(), *value);
                a.push(angle);
            }
            Err(_) => prop_assert!(!value.is_finite()),
        }
    }
    let ([l_0, l_1, l_2, l_3], [a_0, a_1, a_2]) = (&l[..], &a[..]) else { return Ok(()) };
    let lead_error = RackLead::error_from_slope(l_0, l_1);
    said(lead_error, |angle| angle.degrees().is_finite())?;
    for thickness in [None, Some(l_1)] {
        said(ideal_pin::diameter(l_0, a_0, thickness), finite_length)?;
        said(ideal_pin::sensitivities(l_0, a_0, thickness), finite_sensitivities!())?;
        let over_pin = OverPin {
            normal_module: l_0.clone(),
            normal_pressure_angle: a_0.clone(),
            tooth_thickness: thickness.cloned(),
            pin_diameter: l_2.clone(),
            datum: l_3.clone(),
        };
        said(over_pin.measure(), finite_length)?;
        said(over_pin.sensitivities(), finite_sensitivities!())?;
    }
    said(roller_change::difference(l_0, l_1, a_0), finite_length)?;
    said(roller_change::sensitivities(l_0, l_1, a_0), finite_sensitivities!())?;
    prop_assert_eq!(&over_roller::delta_cd(l_0), l_0);
    prop_assert_eq!(&pinion_radial::delta_cd(l_0), l_0);
    let (rack, pinion) = (RackPitch::new(a_0, a_1), PinionPitch::new(a_0, a_1));
    let lead = RackLead::new(a_0, a_1, l_2);
    let mut errors = vec![PartError::RackOverRoller(l_0.clone()), PartError::PinionRadial(l_1.clone())];
    for model in MODELS {
        if let Ok(rack) = &rack {
            said(rack.delta_cd(l_0, model), finite_length)?;
            said(rack.largest_error(l_0, model), finite_length)?;
            said(rack.sensitivities(l_0, model), finite_sensitivities!())?;
            errors.push(PartError::RackPitch(l_0.clone(), rack.clone()));
        }
        if let Ok(pinion) = &pinion {
            said(pinion.delta_cd(l_0, model), finite_length)?;
            said(pinion.largest_error(l_0, model), finite_length)?;
            said(pinion.sensitivities(l_0, model), finite_sensitivities!())?;
            errors.push(PartError::PinionPitch(l_1.clone(), pinion.clone()));
        }
        if let Ok(lead) = &lead {
            said(lead.delta_cd(a_2, model), finite_length)?;
            said(lead.largest_error(l_0, model), |angle| angle.degrees().abs() < 90.0)?;
            said(lead.sensitivities(a_2, model), finite_sensitivities!())?;
            errors.push(PartError::RackLead(a_2.clone(), lead.clone()));
        }
    }
    said(rack, |_| true)?;
    said(pinion, |_| true)?;
    said(lead, |_| true)?;
    let evaluation = evaluate(&errors, &vec![], Model::Exact, Stack::Range);
    said(evaluation.map_err(|error| *error.problem), |evaluation| finite_length(&evaluation.combined.worst_case))
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
