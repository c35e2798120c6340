use super::*;

fn angle(text: &str) -> Angle {
    text.parse().unwrap()
}

fn length(text: &str) -> Length {
    text.parse().unwrap()
}

fn laws(alpha: &str, beta: &str) -> [Law; 6] {
    let (alpha, beta) = (angle(alpha), angle(beta));
    [
        Law::rack_over_roller(),
        Law::rack_pitch(alpha, beta).unwrap(),
        Law::rack_lead(alpha, beta, length("20")).unwrap(),
        Law::pinion_radial(),
        Law::pinion_pitch(alpha, beta).unwrap(),
        Law::pinion_lead(alpha, beta).unwrap(),
    ]
}

/// cos 30°/(2 tan 30°) = 3/4: short decimals stay short, and a value on its limit is inside.
#[test]
fn a_rational_gain_gives_decimals() {
    let law = laws("30", "30")[1];
    assert_eq!(law.delta_cd(length("-0.04"), Model::Exact).unwrap(), length("0.03"));
    assert_eq!(law.largest_error(length("0.75"), Model::Exact).unwrap(), length("1").into());
    assert_eq!(law.largest_error(length("0"), Model::Exact).unwrap(), Length::ZERO.into());
}

/// With k/(2 tan 45°) = 10 mm an error of 30° reaches 5 mm exactly, and is allowed.
#[test]
fn the_largest_lead_error_may_reach_the_limit() {
    let law = laws("45", "0")[2];
    assert_eq!(law.largest_error(length("5"), Model::Exact).unwrap(), angle("30").into());
    let message = law.largest_error(length("10"), Model::Exact).unwrap_err().to_string();
    assert_eq!(message, "no lead angle error below 90° reaches a ΔCD of 10 mm: the largest possible is 10 mm");
    assert!(law.largest_error(length("-0.1"), Model::Exact).is_err());
    assert_eq!(law.largest_error(length("10"), Model::Paper).unwrap(), angle("45").into());
}

#[test]
fn the_largest_error_is_the_last_that_holds() {
    for law in laws("19.9", "-21.5") {
        for model in [Model::Exact, Model::Paper] {
            for text in ["0.000000000001", "0.013", "0.1", "1.7"] {
                let largest = law.largest_error(length(text), model).unwrap();
                let (held, next): (DeviationValue, DeviationValue) = match largest {
                    DeviationValue::Length(error) => (error.into(), (error + Length::from_fm(1)).into()),
                    DeviationValue::Angle(error) => {
                        let printed: Angle = error.to_string().trim_end_matches('°').parse().unwrap();
                        assert_eq!(printed, error, "read back as printed");
                        (DeviationValue::Angle(printed), (error + angle("0.00000000001")).into())
                    }
                    DeviationValue::Slope(_) => unreachable!(),
                };
                assert!(law.delta_cd(held, model).unwrap() <= length(text), "{law:?} {text}");
                assert!(law.delta_cd(next, model).unwrap() > length(text), "{law:?} {text}");
            }
        }
    }
}

#[test]
fn the_largest_slope_deviation_is_the_last_that_holds() {
    let law = laws("19.9", "-21.5")[2];
    for (evaluation_length, model) in [("18", Model::Exact), ("18", Model::Paper), ("0.7", Model::Exact)] {
        let over = length(evaluation_length);
        for text in ["0.000000000001", "0.02", "1.7"] {
            let largest = law.largest_slope_deviation(length(text), over, model).unwrap();
            let next = largest + Length::from_fm(1);
            for (deviation, holds) in [(largest, true), (next, false)] {
                let reached = law.delta_cd(lead_slope(deviation, over).unwrap(), model).unwrap();
                assert_eq!(reached <= length(text), holds, "{text} over {evaluation_length}: {deviation}");
            }
        }
    }
}

#[test]
fn no_slope_deviation_where_none_is_meant_or_reaches() {
    let [_, step, lead, ..] = laws("20", "0");
    let largest = |law: Law, delta_cd: &str, over: &str| {
        law.largest_slope_deviation(length(delta_cd), length(over), Model::Exact).map_err(|error| error.to_string())
    };
    assert_eq!(largest(lead, "0", "18"), Ok(Length::ZERO));
    assert!(largest(lead, "-0.01", "18").is_err());
    assert!(largest(lead, "0.01", "0").is_err());
    assert!(largest(step, "0.01", "18").is_err());
    let message = largest(lead, "5000", "18").unwrap_err();
    assert!(message.starts_with("no helix slope deviation up to 1 m reaches a ΔCD of 5000 mm"), "{message}");
}

#[test]
fn slopes_are_those_of_the_values() {
    for law in laws("20", "15") {
        for model in [Model::Exact, Model::Paper] {
            for error in [1e-6, 0.013, -0.4, 12.0] {
                let step = 1e-6 * f64::abs(error);
                let rise = law.delta_cd_mm(error + step, model) - law.delta_cd_mm(error - step, model);
                let secant = rise / (2.0 * step);
                assert!((law.slope(error, model) - secant).abs() <= 1e-8 * secant.abs(), "{law:?} {error}");
            }
        }
    }
}

/// At α_n = 20°, β = 25° it is 11.5 % below the rack's lead formula with the same f_Hβ over its face.
#[test]
fn the_pinions_lead_is_below_the_racks() {
    let (alpha, beta) = (angle("20"), angle("25"));
    let deviation = length("10 um");
    let pinion = Law::pinion_lead(alpha, beta).unwrap();
    let of_pinion = pinion.delta_cd(deviation, Model::Exact).unwrap();
    let (sin, cos) = trig::sin_cos_of(alpha);
    let sin_base = trig::sin_cos_of(beta).0 * cos;
    let expected_mm = 0.01 * (1.0 - sin_base * sin_base).sqrt() / (2.0 * sin);
    // rounded to the grid of lengths
    assert!((of_pinion.mm() - expected_mm).abs() < 1e-12);
    assert_eq!(pinion.delta_cd(deviation, Model::Paper).unwrap(), of_pinion);
    let rack = Law::rack_lead(alpha, beta, length("20")).unwrap();
    let of_rack = rack.delta_cd(lead_slope(deviation, length("20")).unwrap(), Model::Exact).unwrap();
    assert!((of_pinion.mm() / of_rack.mm() - 0.885).abs() < 5e-4, "{of_pinion} {of_rack}");
}

/// Of each law: what a degree or a mm more of its gear data does to ΔCD.
#[test]
fn relative_sensitivities_are_those_of_the_gain() {
    let (alpha, beta, width) = (20.0, 25.0, 20.0);
    for law in laws("20", "25") {
        for model in [Model::Exact, Model::Paper] {
            let at = |alpha, beta, width| law.drawn(alpha, beta, width).delta_cd_mm(0.01, model);
            for (input, relative) in law.relative_sensitivities(model) {
                let step = 1e-4;
                let (above, below) = match input {
                    Influence::NormalPressureAngle => (at(alpha + step, beta, width), at(alpha - step, beta, width)),
                    Influence::FaceWidth => (at(alpha, beta, width + step), at(alpha, beta, width - step)),
                    _ => (at(alpha, beta + step, width), at(alpha, beta - step, width)),
                };
                let secant = (above - below) / (2.0 * step) / at(alpha, beta, width);
                assert!((relative / secant - 1.0).abs() < 1e-7, "{law:?} {model} {input:?}: {relative} {secant}");
            }
        }
    }
}

/// The paper's formulas know no helix, so they have no derivative by it; at no error there is none by a magnitude.
#[test]
fn what_a_law_is_sensitive_to() {
    let inputs = |law: Law, error: DeviationValue, model| {
        let all = law.sensitivities(error, model).unwrap();
        all.iter().filter(|one| one.value.is_some()).map(|one| one.input).collect::<Vec<_>>()
    };
    let [shift, step, lead, .., pinion_lead] = laws("20", "15");
    let error = DeviationValue::Length(length("0.02"));
    assert_eq!(inputs(shift, Length::ZERO.into(), Model::Exact), [Influence::Error(shift.kind)]);
    let by_rack = [Influence::Error(step.kind), Influence::NormalPressureAngle, Influence::RackHelixAngle];
    assert_eq!(inputs(step, error, Model::Exact), by_rack);
    assert_eq!(inputs(step, error, Model::Paper), by_rack[..2]);
    let by_pinion = [Influence::Error(pinion_lead.kind), Influence::NormalPressureAngle, Influence::PinionHelixAngle];
    assert_eq!(inputs(pinion_lead, error, Model::Paper), by_pinion);
    assert_eq!(
        inputs(lead, Angle::ZERO.into(), Model::Exact),
        [Influence::NormalPressureAngle, Influence::FaceWidth, Influence::RackHelixAngle]
    );
}

#[test]
fn a_slope_is_its_angle() {
    let slope = lead_slope(length("8 um"), length("18")).unwrap();
    let lead = laws("20", "15")[2];
    let (sine, tangent) = (0.008 / 18.000_001_777_777_69, 0.008 / 18.0);
    for (model, function) in [(Model::Exact, sine), (Model::Paper, tangent)] {
        let ratio = lead.delta_cd(slope, model).unwrap().mm() / (lead.gain(model) / FM_PER_MM);
        assert!((ratio / function - 1.0).abs() < 1e-9, "{model} {ratio} {function}");
    }
    assert!(lead_slope(length("8 um"), Length::ZERO).is_err());
}

#[test]
fn what_does_not_fit_is_an_error() {
    let [shift, step, lead, ..] = laws("5", "0");
    for (law, error) in [(shift, angle("1").into()), (step, DeviationValue::Slope(0.1)), (lead, length("1").into())] {
        assert!(matches!(law.delta_cd(error, Model::Exact), Err(DomainError::WrongDimension { .. })));
    }
    let overflow = step.delta_cd(length("1e6"), Model::Exact).unwrap_err().to_string();
    assert_eq!(overflow, "ΔCD is too large: its magnitude must stay within 1e6 mm");
    assert!(lead.delta_cd(angle("90"), Model::Exact).is_err());
}

#[test]
fn drawn_gear_data_outside_the_domain_give_no_number() {
    let lead = laws("20", "12")[2];
    let drawn = |alpha, helix, width| lead.drawn(alpha, helix, width).delta_cd_mm(0.1, Model::Exact);
    assert!((drawn(20.0, 12.0, 20.0) / lead.delta_cd_mm(0.1, Model::Exact) - 1.0).abs() < 1e-15);
    for (alpha, helix, width) in [(0.0, 12.0, 20.0), (45.1, 12.0, 20.0), (20.0, -90.0, 20.0), (20.0, 12.0, -0.1)] {
        assert!(drawn(alpha, helix, width).is_nan(), "{alpha} {helix} {width}");
    }
}

/// Each law has a page, and the page is about it.
#[test]
fn every_law_is_documented_under_its_name() {
    for law in laws("20", "0") {
        assert_eq!(law.page().name.replace('-', "_"), law.kind().key());
        for model in [Model::Exact, Model::Paper] {
            assert!(!equation(law.kind(), model).is_empty(), "{law:?}");
        }
    }
    assert_eq!(equation(DeviationKind::RackPitch, Model::Exact), "|Δp| cos β_r / (2 tan α_n)");
    assert_eq!(equation(DeviationKind::RackLead, Model::Paper), "k |tan Δβ| / (2 tan α_n)");
    assert_eq!(equation(DeviationKind::PinionRadial, Model::Paper), "r - r_nom");
    for model in [Model::Exact, Model::Paper] {
        assert_eq!(equation(DeviationKind::PinionLead, model), "|f_Hβ| cos β_b / (2 sin α_n)");
    }
}
