//! Odd inputs get a right answer or a clear error, never a panic, a NaN or a hang.
#![allow(clippy::pedantic, clippy::disallowed_methods)]

use crate::common::pairs::{spur, steering};
use crate::common::random::{self, Random};
use rackmesh::deviation::*;
use rackmesh::gear::{GeometryError, Pair, PairData};
use rackmesh::mesh::{Mesh, MeshError, Sampler, Support};

const ODD: [f64; 12] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    5e-324,
    1e-300,
    -1.0,
    1e9,
    1e300,
    f64::MAX,
    f64::MIN_POSITIVE,
];

#[test]
fn any_number_in_any_place_is_an_error_or_a_finite_answer() {
    let set: [fn(&mut PairData, f64); 11] = [
        |d, v| d.normal_module_mm = v,
        |d, v| d.normal_pressure_angle_rad = v,
        |d, v| d.rack.helix_angle_rad = v,
        |d, v| d.rack.face_width_mm = v,
        |d, v| d.rack.addendum_mm = v,
        |d, v| d.rack.tooth_thickness_mm = Some(v),
        |d, v| d.pinion.helix_angle_rad = v,
        |d, v| d.pinion.profile_shift = v,
        |d, v| d.pinion.tip_diameter_mm = v,
        |d, v| d.pinion.root_form_diameter_mm = Some(v),
        |d, v| d.pinion.face_width_mm = v,
    ];
    for (field, set) in set.iter().enumerate() {
        for value in ODD {
            let mut data = spur();
            set(&mut data, value);
            if let Ok(pair) = Pair::new(&data) {
                let ratio = pair.contact_ratio();
                assert!(ratio.total.is_finite() && pair.undercut_limit().is_finite(), "{field} {value}");
                if let Ok(point) = Mesh::nominal(pair).unwrap().at(1.0) {
                    assert!(point.center_distance_mm.is_finite(), "{field} {value}: {point:?}");
                }
            } else {
                assert!(!Pair::new(&data).unwrap_err().to_string().is_empty());
            }
        }
    }
    for (teeth, ok) in [(0, false), (1, false), (20, true), (u32::MAX, false)] {
        let mut data = spur();
        data.pinion.teeth = teeth;
        assert_eq!(Pair::new(&data).is_ok(), ok, "{teeth} teeth");
    }
}

#[test]
fn odd_strokes_and_deviations_are_errors() {
    let pair = Pair::new(&spur()).unwrap();
    let mesh = Mesh::nominal(pair).unwrap();
    for stroke in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300] {
        assert!(matches!(mesh.at(stroke), Err(MeshError::StrokeOutOfDomain { .. })));
    }
    assert!(mesh.at(5e-324).unwrap().delta_cd_mm.abs() < 1e-12);
    for value in [f64::NAN, f64::INFINITY, 1e300] {
        for kind in [RackDeviationKind::Shift(value), RackDeviationKind::Lead(value), RackDeviationKind::Pitch(value)] {
            assert!(RackFlanks::new(&pair, &[RackDeviation { teeth: ToothRange::ALL, kind }]).is_err());
        }
        assert!(mesh.curve(0.0, value, 1e-6).is_err() || value == 1e300);
        assert!(mesh.curve(0.0, 1.0, -value).is_err());
    }
    assert!(matches!(
        PinionFlanks::new(&pair, &[PinionDeviation::eccentricity(0.1, 20)]),
        Err(DeviationError::NoSuchTooth { tooth: 20, teeth: 20 })
    ));
}

#[test]
fn no_involute_and_pointed_teeth_are_named() {
    let mut data = spur();
    data.pinion.tip_diameter_mm = 37.0;
    assert!(matches!(Pair::new(&data), Err(GeometryError::NoInvolute { .. })));
    data.pinion.tip_diameter_mm = 60.0;
    assert!(matches!(Pair::new(&data), Err(GeometryError::PointedPinion { .. })));
    let mut data = spur();
    data.rack.addendum_mm = 5.0;
    assert!(matches!(Pair::new(&data), Err(GeometryError::PointedRack { .. })));
}

#[test]
fn a_crossed_axis_at_a_right_angle_and_a_parallel_one_both_work() {
    for (rack, pinion) in [(45.0_f64, 45.0_f64), (30.0, -30.0), (0.0, 0.0), (45.0, -45.0)] {
        let mut data = spur();
        data.rack.helix_angle_rad = rack.to_radians();
        data.pinion.helix_angle_rad = pinion.to_radians();
        let grow = 1.0 / pinion.to_radians().cos() - 1.0;
        data.pinion.tip_diameter_mm += 40.0 * grow;
        data.pinion.root_form_diameter_mm = Some(38.2 + 40.0 * grow);
        data.pinion.face_width_mm = 60.0;
        let pair = Pair::new(&data).unwrap();
        let mesh = Mesh::nominal(pair).unwrap();
        for i in 0..50 {
            let point = mesh.at(f64::from(i) * 0.37).unwrap();
            assert!(point.converged() && point.delta_cd_mm.abs() < 1e-11, "{rack} {pinion}: {point:?}");
        }
    }
}

#[test]
fn teeth_that_passed_each_other_are_an_error() {
    let pair = Pair::new(&spur()).unwrap();
    let swap = RackDeviation { teeth: ToothRange::single(3).unwrap(), kind: RackDeviationKind::Shift(7.0) };
    let rack = RackFlanks::new(&pair, &[swap]).unwrap();
    let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::Fixed).unwrap();
    assert!(matches!(mesh.at(3.0 * pair.rack().pitch_mm), Err(MeshError::RackToothOrder { tooth: 3, .. })));
    let swap = PinionDeviation { teeth: ToothRange::single(3).unwrap(), kind: PinionDeviationKind::Shift(7.0) };
    let pinion = PinionFlanks::new(&pair, &[swap]).unwrap();
    let mesh = Mesh::new(pair, RackFlanks::nominal(&pair), pinion, Support::Fixed);
    assert!(matches!(mesh, Err(MeshError::PinionToothOrder { .. })));
}

/// Where a rack has no tooth within a pitch of the pinion's axis there is no mesh, whatever its tips could do in there.
#[test]
fn no_tooth_under_the_pinion_is_an_error() {
    let pair = Pair::new(&spur()).unwrap();
    let p = pair.rack().pitch_mm;
    for wider in [0.1, 1.5, 6.0] {
        let kind = RackDeviationKind::Shift(wider * p);
        let gap = RackDeviation { teeth: ToothRange::new(Some(5), None).unwrap(), kind };
        let mesh = with(&pair, &[gap], Support::Fixed);
        for step in 0..120 {
            let place = 3.0 + 0.083 * f64::from(step);
            let away = (place - 4.0).min(5.0 + wider - place);
            let found = mesh.at(place * p);
            let missing = matches!(found, Err(MeshError::RackToothOrder { .. }));
            assert_eq!(missing, away > 1.0, "{wider} {place}: {found:?}");
            assert!(away > 0.0 || found.is_ok(), "{wider} {place}: {found:?}");
        }
    }
}

/// A sampler skips pairs that cannot have caught up since they were last searched; a fresh start searches all.
#[test]
fn many_strokes_on_many_cores_are_as_each_by_itself_and_the_same_bits_again() {
    for seed in 0..16 {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let rack = random::rack(&mut random, &pair, true);
        let pinion = random::pinion(&mut random, &pair, true);
        let mesh = Mesh::new(pair, rack, pinion, Support::Fixed).unwrap();
        let step = if seed % 2 == 0 { 0.01 } else { 0.37 };
        let strokes: Vec<f64> = (0..1200).map(|i| f64::from(i) * step).collect();
        let (a, b) = (mesh.sample(&strokes), mesh.sample(&strokes));
        for ((a, b), &s) in a.iter().zip(&b).zip(&strokes) {
            let (a, b) = (a.as_ref().unwrap(), b.as_ref().unwrap());
            assert_eq!(a.center_distance_mm.to_bits(), b.center_distance_mm.to_bits());
            let fresh = mesh.at(s).unwrap().center_distance_mm;
            assert!((fresh - a.center_distance_mm).abs() < 1e-11, "seed {seed}, stroke {s}");
        }
    }
}

/// Crowning removes material: it never lifts the pinion, and a tilted flank then touches inside the face.
#[test]
fn flank_form_lowers_the_pinion() {
    let pair = Pair::new(&spur()).unwrap();
    let lead = RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Lead(0.002) };
    let plain = RackFlanks::new(&pair, &[lead]).unwrap();
    let form = RackForm { crowning_mm: 0.02, tip_relief_mm: 0.01, tip_relief_start_mm: 1.0 };
    let formed = plain.clone().with_form(&pair, form).unwrap();
    let pinion = PinionFlanks::nominal(&pair);
    let at =
        |rack: RackFlanks| Mesh::new(pair, rack, pinion.clone(), Support::Fixed).unwrap().at(0.4).unwrap().delta_cd_mm;
    let (without, with) = (at(plain), at(formed));
    // with y = k/2 · t the demand is (tan lead · k/2 · t − c t²)/tan α: at t = 1 without, at its top with crowning
    let slope = 0.002_f64.tan() * 10.0;
    let t = (slope * 20.0_f64.to_radians().cos()) / (2.0 * 0.02);
    let expected = (slope * t * 20.0_f64.to_radians().cos() - 0.02 * t * t) / 20.0_f64.to_radians().sin();
    assert!(with < without - 1e-3, "{with} {without}");
    assert!((with - expected).abs() < 2e-4 * expected.max(0.1), "{with} {expected}");
}

fn with(pair: &Pair, list: &[RackDeviation], support: Support) -> Mesh {
    Mesh::new(*pair, RackFlanks::new(pair, list).unwrap(), PinionFlanks::nominal(pair), support).unwrap()
}

/// Whichever way the strokes of a rack that rolls are run through, the points are the same.
#[test]
fn strokes_in_reverse_give_the_same_points() {
    let pair = Pair::new(&spur()).unwrap();
    let lead = |first| RackDeviation {
        teeth: ToothRange::new(Some(first), None).unwrap(),
        kind: RackDeviationKind::Lead(0.004),
    };
    let mesh = with(&pair, &[lead(2)], Support::FreeRoll { axis_depth_mm: 8.0 });
    let strokes: Vec<f64> = (0..150).map(|i| f64::from(i) * 0.17).collect();
    let (mut up, mut down) = (Sampler::new(&mesh), Sampler::new(&mesh));
    let rising: Vec<_> = strokes.iter().map(|&s| up.at(s).unwrap().center_distance_mm).collect();
    let falling: Vec<_> = strokes.iter().rev().map(|&s| down.at(s).unwrap().center_distance_mm).collect();
    for ((a, b), s) in rising.iter().zip(falling.iter().rev()).zip(&strokes) {
        assert!((a - b).abs() < 1e-10, "stroke {s}: {a} {b}");
    }
}

/// Never above the fixed rack, two mirror rolls, about half a percent lower.
#[test]
fn a_rolling_rack_takes_one_of_two_mirror_rolls_half_a_percent_lower() {
    let pair = Pair::new(&steering()).unwrap();
    let lead = RackDeviation {
        teeth: ToothRange::new(Some(4), None).unwrap(),
        kind: RackDeviationKind::Lead(0.25_f64.to_radians()),
    };
    let fixed = with(&pair, &[lead], Support::Fixed);
    let free = with(&pair, &[lead], Support::FreeRoll { axis_depth_mm: 8.0 });
    let (mut least, mut most) = (0.0_f64, 0.0_f64);
    for i in 0..120 {
        let s = f64::from(i) * 0.41;
        let (rolled, held) = (free.at(s).unwrap(), fixed.at(s).unwrap());
        assert!(rolled.delta_cd_mm <= held.delta_cd_mm + 1e-11, "stroke {s}: {rolled:?} {held:?}");
        (least, most) = (least.min(rolled.roll_rad), most.max(rolled.roll_rad));
    }
    assert!((least + most).abs() < 0.01 * most && most > 0.011, "{least} {most}");
    let curve = free.curve(0.0, 50.0, 1e-6).unwrap();
    assert!(curve.resolved && curve.points.len() < 10_000 && curve.kinks.len() < 200);
    let top = |curve: rackmesh::mesh::Curve, mesh: &Mesh| curve.summary(mesh).unwrap().max_mm;
    let ratio = top(curve, &free) / top(fixed.curve(0.0, 50.0, 1e-6).unwrap(), &fixed);
    assert!((0.994..0.996).contains(&ratio), "{ratio}");
}

/// Each piece of a single pitch step's curve is known: 0, or |Δp| / (2 tan α).
#[test]
fn the_summary_of_a_pitch_step_is_known() {
    let pair = Pair::new(&steering()).unwrap();
    let step = RackDeviation { teeth: ToothRange::single(4).unwrap(), kind: RackDeviationKind::Pitch(0.01) };
    let mesh = with(&pair, &[step], Support::Fixed);
    let p = pair.rack().pitch_mm;
    let summary = mesh.curve(0.0, 8.0 * p, 1e-6).unwrap().summary(&mesh).unwrap();
    let height = 0.01 / (2.0 * 19.9_f64.to_radians().tan());
    assert!(summary.min_mm.abs() < 1e-11 && (summary.max_mm - height).abs() < 1e-11, "{summary:?}");
    assert!((summary.peak_to_peak_mm - height).abs() < 1e-11 && (summary.tooth_to_tooth_mm - height).abs() < 1e-11);
    assert!(summary.mean_mm > 0.0 && summary.mean_mm < height && summary.largest_rate > 0.0);
    assert!(summary.max_stroke_mm > 2.0 * p && summary.max_stroke_mm < 5.0 * p);
}
