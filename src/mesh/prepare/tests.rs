use super::*;
use crate::deviation::{PinionDeviation, PinionDeviationKind, RackDeviation, RackDeviationKind, RackForm, ToothRange};
use crate::gear::{Pair, example};
use crate::reproduction;

/// By central differences, at rolls where nothing vanishes, of flanks with lead errors and form.
#[test]
fn rates_are_what_the_roll_changes() {
    const H: f64 = 1e-5;
    let pair = reproduction::pair().unwrap();
    let form = RackForm { crowning_mm: 0.01, ..RackForm::default() };
    let lead = [RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Lead(0.01) }];
    let rack = RackFlanks::new(&pair, &lead).unwrap().with_form(&pair, form).unwrap();
    let support = Support::FreeRoll { axis_depth_mm: 8.0 };
    let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), support).unwrap();
    let plane = |plane: &Plane| [plane.d, plane.t, plane.w];
    let all = |prepared: &Prepared| {
        let contact = &prepared.contact;
        let form = contact.form.unwrap();
        let across = [contact.across.t, contact.across.w, contact.across.z];
        let others = [prepared.per_shift, form.per_normal, form.per_normal_on_tip];
        [plane(&contact.flank), plane(&contact.tip), across, others].concat()
    };
    for side in [FlankSide::Right, FlankSide::Left] {
        for angle in [-0.3, 0.07, 0.2] {
            let at = |angle| mesh.prepare(side, 4, &Roll::new(angle, 8.0));
            let RollRates { flank, tip, across, per_shift, form } = at(angle).rates;
            let rates = [
                plane(&flank),
                plane(&tip),
                [across.t, across.w, across.z],
                [per_shift, form.per_normal, form.per_normal_on_tip],
            ]
            .concat();
            let (before, after) = (all(&at(angle - H)), all(&at(angle + H)));
            for (index, rate) in rates.iter().enumerate() {
                let difference = (after[index] - before[index]) / (2.0 * H);
                assert!((rate - difference).abs() < 1e-7, "{side:?} {angle} {index}: {rate} {difference}");
            }
        }
    }
}

/// A helix is none if the flank stays where it is to rounding, however wide the face.
#[test]
fn a_helix_is_counted_from_what_it_turns() {
    let pair = Pair::new(&example(20, 0.0, 0.0)).unwrap();
    let width_over_radius = pair.pinion().face_width_mm / pair.pinion().reference_radius_mm;
    for (turn, counts) in [(0.0, false), (0.9, false), (1.1, true), (100.0, true)] {
        let kind = PinionDeviationKind::Lead(turn * NO_HELIX / width_over_radius);
        let leads = [PinionDeviation { teeth: ToothRange::ALL, kind }];
        let pinion = PinionFlanks::new(&pair, &leads).unwrap();
        let mesh = Mesh::new(pair, RackFlanks::nominal(&pair), pinion, Support::Fixed).unwrap();
        let kappa = mesh.prepare(FlankSide::Right, 0, &Roll::NONE).contact.kappa;
        assert_eq!(kappa != 0.0, counts, "{turn}: {kappa}");
    }
}

/// Two a quarter of a turn apart add up as sides of a triangle; bounds lean on it.
#[test]
fn the_eccentricity_is_that_of_all_together() {
    let pair = Pair::new(&example(20, 0.0, 0.0)).unwrap();
    let each = [PinionDeviation::eccentricity(0.03, 0), PinionDeviation::eccentricity(0.04, 5)];
    let pinion = PinionFlanks::new(&pair, &each).unwrap();
    let mesh = Mesh::new(pair, RackFlanks::nominal(&pair), pinion, Support::Fixed).unwrap();
    assert!((mesh.eccentricity() - 0.05).abs() < 1e-15, "{}", mesh.eccentricity());
}

/// The points within the rack's end faces and the tip circle, however the pinion is turned: along w they reach as
/// far as is said, and without either angle between the faces no less far.
#[test]
fn the_width_in_use_is_that_between_the_end_faces() {
    for (shaft, angle, depth, amount_mm) in [
        (0.0, 0.0, 8.0, 0.0),
        (0.3, 0.0, 8.0, 1.0),
        (-0.3, 0.0, 8.0, 3.0),
        (0.0, 0.05, 8.0, 0.0),
        (0.0, -0.07, 30.0, 2.0),
        (0.3, 0.06, 8.0, 1.0),
        (-0.2, -0.06, 1.0, 0.0),
    ] {
        let mut data = example(20, -0.2, 0.2 + shaft);
        data.rack.face_width_mm = 5.0;
        data.pinion.face_width_mm = 200.0;
        let pair = Pair::new(&data).unwrap();
        let pinion = PinionFlanks::new(&pair, &[PinionDeviation::eccentricity(amount_mm, 0)]).unwrap();
        let support = Support::FreeRoll { axis_depth_mm: depth };
        let mesh = Mesh::new(pair, RackFlanks::nominal(&pair), pinion, support).unwrap();
        let roll = Roll::new(angle, depth);
        let FlankContact { across, w_extent, .. } = mesh.prepare(FlankSide::Right, 0, &roll).contact;
        let radius = pair.pinion().tip_radius_mm + amount_mm;
        let mut farthest = 0.0_f64;
        for step in 0..3600 {
            let (sin, cos) = trig::sin_cos(f64::from(step) * 0.001_745_329_251_994_33);
            for center_distance in [0.0, radius] {
                let y = radius * (across.t * cos + across.z * sin) + roll.sin * (depth + center_distance);
                farthest = farthest.max((across.half_width + y.abs()) / across.w.abs());
            }
        }
        assert!(farthest <= w_extent * (1.0 + 1e-12), "{shaft} {angle}: {farthest} {w_extent}");
        let exact = shaft == 0.0 || angle == 0.0;
        assert!(!exact || farthest >= w_extent * (1.0 - 1e-5), "{shaft} {angle}: {farthest} {w_extent}");
    }
}

/// A rack tooth is out of order from where its flanks meet at the reference plane, or its middle passes the next's.
#[test]
fn a_rack_tooth_has_thickness_and_comes_before_the_next() {
    let pair = Pair::new(&example(20, 0.2, 0.2)).unwrap();
    let cos = trig::cos(pair.rack().helix_angle_rad);
    let (thickness, pitch) = (pair.rack().tooth_thickness_mm, pair.rack().pitch_mm);
    let in_order = |kind| {
        let list = [RackDeviation { teeth: ToothRange::single(3).unwrap(), kind }];
        let rack = RackFlanks::new(&pair, &list).unwrap();
        let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::Fixed).unwrap();
        [2, 3, 4].map(|tooth| mesh.prepare(FlankSide::Left, tooth, &Roll::NONE).in_order)
    };
    for share in [0.5, 0.99, 1.01, 3.0] {
        let there = [true, share < 1.0, true];
        assert_eq!(in_order(RackDeviationKind::Thickness(-share * thickness)), there, "thickness {share}");
        let one_flank = share * thickness / cos;
        if one_flank < 0.5 * pitch {
            assert_eq!(in_order(RackDeviationKind::Right(-one_flank)), there, "right {share}");
            assert_eq!(in_order(RackDeviationKind::Left(one_flank)), there, "left {share}");
        }
        assert_eq!(in_order(RackDeviationKind::Shift(share * pitch)), there, "shift {share}");
        assert_eq!(in_order(RackDeviationKind::Shift(-share * pitch)), [share < 1.0, true, true], "shift back {share}");
    }
}
