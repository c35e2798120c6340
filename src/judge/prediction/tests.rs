use super::*;
use crate::deviation::{PinionFlanks, RackFlanks, pinion_flanks_from_rows};
use crate::formula::Law;
use crate::gear::example;
use crate::judge::bound::tests::random::Random;
use crate::mesh::{Mesh, Support};

pub(crate) fn pair(teeth: u32, rack_helix: f64, pinion_helix: f64) -> Pair {
    Pair::new(&example(teeth, rack_helix, pinion_helix)).expect("a valid pair")
}

/// Names, and ranges in mm to twelve decimals.
fn terms(prediction: &Prediction) -> Vec<(&str, String)> {
    let text = |term: &Predicted| format!("{:.12} {:.12}", term.lower_mm + 0.0, term.upper_mm + 0.0);
    prediction.terms.iter().map(|term| (term.what.as_str(), text(term))).collect()
}

#[test]
fn a_placed_error_has_its_teeth_and_the_value_of_its_formula() {
    let pair = pair(20, 0.0, 0.4);
    let angle = Angle::from_degrees(20.0).unwrap();
    let law = Law::rack_pitch(angle, Angle::from_degrees(0.0).unwrap()).unwrap();
    let error = PartDeviation::new(law, Length::from_mm(0.012).unwrap());
    let run = |first, last| Run { first, last, side: None, value: -0.012 };
    for (runs, what) in [
        (vec![run(5, 5)], "rack pitch, before tooth 5"),
        (vec![run(5, 7), run(9, 9)], "rack pitch, before teeth 5 to 7 and before tooth 9"),
    ] {
        let Predicted { what: said, lower_mm, upper_mm } = PlacedError { error, runs }.predicted(&pair).unwrap();
        assert_eq!((said.as_str(), lower_mm), (what, 0.0));
        assert!((upper_mm - 0.012 / (2.0 * trig::tan(angle.radians()))).abs() < 1e-9, "{upper_mm}");
    }
    let nowhere = PlacedError { error, runs: Vec::new() }.predicted(&pair).unwrap();
    assert_eq!((nowhere.what.as_str(), nowhere.upper_mm), ("rack pitch, nowhere", 0.0));
}

/// Every kind of deviation of 0.03 mm or rad, on all teeth and on some.
#[test]
fn each_deviation_has_the_gain_of_its_formula() {
    let (rack_helix, pinion_helix) = (0.3, 0.4);
    let pair = pair(20, rack_helix, pinion_helix);
    let some = ToothRange::new(Some(4), None).unwrap();
    let both = |lower: f64, upper: f64| format!("{lower:.12} {upper:.12}");
    let (cos_rack, cos_pinion) = (trig::cos(rack_helix), trig::cos(pinion_helix));
    for (kind, gain) in [
        (RackDeviationKind::OverRoller(-0.03), -0.03),
        (RackDeviationKind::Thickness(0.03), 0.03),
        (RackDeviationKind::Left(-0.03), -0.03 * cos_rack),
        (RackDeviationKind::Right(0.03), 0.03 * cos_rack),
        (RackDeviationKind::Lead(0.03), trig::sin(0.03) * 20.0 / cos_rack),
    ] {
        for (teeth, expected) in [(ToothRange::ALL, (gain, gain)), (some, (gain.min(0.0), gain.max(0.0)))] {
            let prediction = Prediction::new().rack(&pair, &[RackDeviation { teeth, kind }]);
            assert_eq!(terms(&prediction)[0].1, both(expected.0, expected.1), "{kind:?}");
        }
    }
    for (kind, gain) in [
        (PinionDeviationKind::Radial(-0.03), -0.03),
        (PinionDeviationKind::Thickness(0.03), 0.03 * cos_pinion),
        (PinionDeviationKind::Left(-0.03), -0.03 * cos_pinion),
        (PinionDeviationKind::Right(0.03), 0.03 * cos_pinion),
    ] {
        for (teeth, expected) in [(ToothRange::ALL, (gain, gain)), (some, (gain.min(0.0), gain.max(0.0)))] {
            let prediction = Prediction::new().pinion(&pair, &[PinionDeviation { teeth, kind }]);
            assert_eq!(terms(&prediction)[0].1, both(expected.0, expected.1), "{kind:?}");
        }
    }
}

/// Pitches push, whatever their sign; a shift of all teeth is none; a pinion's lead has no formula.
#[test]
fn pitches_push_and_a_shift_of_all_teeth_is_none() {
    let pair = pair(20, 0.3, 0.4);
    let some = ToothRange::new(Some(4), None).unwrap();
    let rack = |teeth, kind| RackDeviation { teeth, kind };
    let pushed = Prediction::new().rack(
        &pair,
        &[
            rack(ToothRange::ALL, RackDeviationKind::Pitch(-0.03)),
            rack(ToothRange::ALL, RackDeviationKind::Shift(-0.03)),
            rack(some, RackDeviationKind::Shift(-0.03)),
        ],
    );
    let gain = format!("{:.12} {:.12}", 0.0, 0.03 * trig::cos(0.3));
    let none = format!("{:.12} {:.12}", 0.0, 0.0);
    assert_eq!(terms(&pushed).into_iter().map(|term| term.1).collect::<Vec<_>>(), [&*gain, &none, &gain]);
    let pinion = |teeth, kind| PinionDeviation { teeth, kind };
    let pushed = Prediction::new().pinion(
        &pair,
        &[
            pinion(ToothRange::ALL, PinionDeviationKind::Shift(0.03)),
            pinion(some, PinionDeviationKind::Shift(-0.03)),
            pinion(ToothRange::ALL, PinionDeviationKind::Lead(0.01)),
            PinionDeviation::eccentricity(-0.04, 0),
        ],
    );
    let gain = format!("{:.12} {:.12}", 0.0, 0.03 * trig::cos(0.4));
    let eccentricity = format!("{:.12} {:.12}", -0.04, 0.04);
    let ranges: Vec<_> = terms(&pushed).into_iter().map(|term| term.1).collect();
    assert_eq!(ranges, [none, gain, eccentricity]);
    let (lower, upper) = pushed.range_mm();
    assert_eq!(format!("{lower:.12} {upper:.12}"), format!("{:.12} {:.12}", -0.04, 0.04 + 0.03 * trig::cos(0.4)));
}

/// Steps are those between neighbours only, from the lower to the higher number, in whatever order the rows come.
#[test]
fn measured_rows_give_their_largest_steps() {
    let pair = pair(20, 0.3, 0.4);
    let space = |space, height_mm, position_mm, lead_rad| RackSpaceRow { space, height_mm, position_mm, lead_rad };
    let rows = [
        space(8, 0.01, 1.0, None),
        space(2, -0.02, 0.0, Some(-0.004)),
        space(1, 0.0, 0.011, Some(0.003)),
        space(3, 0.005, 0.009, None),
    ];
    let range = |lower: f64, upper: f64| format!("{lower:.12} {upper:.12}");
    let measured = Prediction::new().rack_rows(&pair, &rows);
    let expected = [
        ("rack over-pin, measured", range(-0.02, 0.01)),
        ("rack pitch, measured", range(0.0, 0.011 * trig::cos(0.3))),
        ("rack lead, measured", range(0.0, trig::sin(0.004) * 20.0 / trig::cos(0.3))),
    ];
    assert_eq!(terms(&measured), expected);
    assert_eq!(Prediction::new().rack_rows(&pair, &[]).pinion_rows(&pair, &[]), Prediction::new());

    let tooth = |tooth, radial_mm, position_mm, left_pitch_mm| PinionToothRow {
        tooth,
        radial_mm,
        position_mm,
        left_pitch_mm,
        right_pitch_mm: None,
        lead_rad: None,
    };
    let rows = [
        tooth(3, Some(0.01), Some(0.03), Some(0.004)),
        tooth(1, Some(-0.02), Some(0.01), None),
        tooth(2, None, Some(0.015), Some(-0.002)),
        tooth(9, None, Some(0.5), None),
    ];
    let measured = Prediction::new().pinion_rows(&pair, &rows);
    let expected = [
        ("pinion radial, measured", range(-0.02, 0.01)),
        // the step of the positions and the pitch of the left flanks add up
        ("pinion pitch, measured", range(0.0, 0.019 * trig::cos(0.4))),
    ];
    assert_eq!(terms(&measured), expected);
    let pitches = Prediction::new().pinion_rows(&pair, &[tooth(1, None, None, Some(-0.02))]);
    assert_eq!(terms(&pitches), [("pinion pitch, measured", range(0.0, 0.02 * trig::cos(0.4)))]);
    // behind the last tooth comes the first
    let around = [tooth(0, None, Some(0.0), None), tooth(19, None, Some(-0.03), None)];
    let around = Prediction::new().pinion_rows(&pair, &around);
    assert_eq!(terms(&around), [("pinion pitch, measured", range(0.0, 0.03 * trig::cos(0.4)))]);
    let lead = PinionToothRow { lead_rad: Some(0.001), ..tooth(1, None, None, None) };
    let lead = Prediction::new().pinion_rows(&pair, &[lead]);
    let slope = pinion_helix_slope_mm(HelixOfPinion::of(&pair), 0.001);
    let same = Prediction::new().pinion_lead(&pair, slope);
    assert_eq!(terms(&lead)[1], ("pinion lead, measured", terms(&same)[0].1.clone()));
}

/// One tooth whose flanks deviate each by itself, and a pin that stands elsewhere in one space: the mesh asks for no more
/// than the formulas.
#[test]
fn measured_teeth_of_a_pinion_lift_no_more_than_the_formulas() {
    let pair = pair(20, 0.0, 0.0);
    let mut random = Random(7);
    let mut closest = f64::INFINITY;
    for _ in 0..40 {
        let mut draw = || random.range(-0.04, 0.04);
        let (left, right, pin) = (draw(), draw(), draw());
        let rows: Vec<_> = (0..20)
            .map(|tooth| {
                let single = |value: f64| match tooth {
                    5 => Some(value),
                    6 => Some(-value),
                    _ => Some(0.0),
                };
                let position_mm = Some(if tooth == 19 { pin } else { 0.0 });
                let (left_pitch_mm, right_pitch_mm) = (single(left), single(right));
                PinionToothRow { tooth, radial_mm: None, position_mm, left_pitch_mm, right_pitch_mm, lead_rad: None }
            })
            .collect();
        let pinion = PinionFlanks::nominal(&pair);
        let pinion = pinion.with_measured(&pinion_flanks_from_rows(&pair, &rows).unwrap()).unwrap();
        let mesh = Mesh::new(pair, RackFlanks::nominal(&pair), pinion, Support::Fixed).unwrap();
        let reached = mesh.curve(0.0, 20.0 * pair.rack().pitch_mm, 1e-6).unwrap().summary(&mesh).unwrap().max_mm;
        let upper = Prediction::new().pinion_rows(&pair, &rows).range_mm().1;
        assert!(reached <= upper + 1e-6, "{left} {right} {pin}: {reached} {upper}");
        let one_side = Gains::new(&pair).pinion * left.abs().max(right.abs()).max(pin.abs());
        closest = closest.min(one_side - reached);
    }
    assert!(closest < -0.02, "one side alone is no bound: {closest}");
}
