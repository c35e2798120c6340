//! The exact relations of a zero-backlash rack and pinion, on random pairs.
#![allow(clippy::pedantic, clippy::disallowed_methods)]

mod measured;

use crate::common::pairs;
use crate::common::random::{self, Random};
use approx::assert_abs_diff_eq;
use proptest::prelude::*;
use rackmesh::deviation::*;
use rackmesh::formula::Model;
use rackmesh::gear::Pair;
use rackmesh::mesh::{ContactKind, Mesh, MeshPoint, Support};
use rackmesh::spec::{MeasuredTables, Spec};

fn rack_with(pair: &Pair, teeth: ToothRange, kinds: &[RackDeviationKind]) -> RackFlanks {
    let list: Vec<_> = kinds.iter().map(|&kind| RackDeviation { teeth, kind }).collect();
    RackFlanks::new(pair, &list).unwrap()
}

fn pinion_with(pair: &Pair, teeth: ToothRange, kinds: &[PinionDeviationKind]) -> PinionFlanks {
    let list: Vec<_> = kinds.iter().map(|&kind| PinionDeviation { teeth, kind }).collect();
    PinionFlanks::new(pair, &list).unwrap()
}

fn mesh(pair: &Pair, rack: RackFlanks, pinion: PinionFlanks) -> Mesh {
    Mesh::new(*pair, rack, pinion, Support::Fixed).unwrap()
}

fn from(first: i64) -> ToothRange {
    ToothRange::new(Some(first), None).unwrap()
}

fn table_pair() -> Pair {
    Pair::new(&pairs::steering()).unwrap()
}

/// Whether flank meets flank on both sides, as the relations suppose: edges bind where a tip reaches too far.
fn line(point: &MeshPoint) -> bool {
    [point.right.contact, point.left.contact].iter().all(|kind| *kind == ContactKind::Line)
}

/// ΔCD of a pair without deviations: a thickness deviation of the pinion shows up as Δs_t / (2 tan α_t).
fn nominal_by_thickness(pair: &Pair) -> f64 {
    let p = pair.pinion();
    let nominal = (std::f64::consts::FRAC_PI_2 + 2.0 * p.profile_shift * pair.normal_pressure_angle_rad().tan())
        * pair.normal_module_mm()
        / p.helix_angle_rad.cos();
    (p.tooth_thickness_mm - nominal) / (2.0 * p.transverse_pressure_angle_rad.tan())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_pair_without_deviations_sits_at_its_nominal_centre_distance(seed: u64, at in -20.0..20.0_f64) {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let point = Mesh::nominal(pair).unwrap().at(at * pair.rack().pitch_mm).unwrap();
        prop_assert!(point.converged());
        prop_assume!(line(&point));
        let expected = nominal_by_thickness(&pair);
        prop_assert!((point.delta_cd_mm - expected).abs() < 1e-11, "{} {expected}", point.delta_cd_mm);
    }

    // relation 1, with whatever other deviations there are, lead errors among them; the tip plane and the end faces do not
    // move, so contacts at the rack's tip edge or at its ends are left out by giving both room
    #[test]
    fn an_over_roller_error_moves_the_pinion_by_itself(seed: u64, shift in -0.1..0.1_f64, lead in -0.01..0.01_f64) {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let lead = RackDeviationKind::Lead(lead);
        let s = random.range(-2.0, 5.0) * pair.rack().pitch_mm;
        let pinion = PinionFlanks::nominal(&pair);
        let without = mesh(&pair, rack_with(&pair, ToothRange::ALL, &[lead]), pinion.clone()).at(s).unwrap();
        let kinds = [lead, RackDeviationKind::OverRoller(shift)];
        let with = mesh(&pair, rack_with(&pair, ToothRange::ALL, &kinds), pinion).at(s).unwrap();
        let tip = |p: &rackmesh::mesh::MeshPoint| {
            use rackmesh::mesh::ContactKind::{Corner, RackEdge};
            [p.right.contact, p.left.contact].iter().any(|kind| matches!(kind, RackEdge | Corner))
        };
        prop_assume!(!tip(&with) && !tip(&without));
        // the rack teeth that carry must not change either: a tip plane left behind by the flanks shortens them
        prop_assume!(with.right == without.right && with.left == without.left);
        prop_assert!((with.delta_cd_mm - without.delta_cd_mm - shift).abs() < 1e-11);
    }

    #[test]
    fn a_thickness_error_moves_the_pinion_by_half_of_it_over_the_tangent(seed: u64, ds in -0.1..0.1_f64) {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let s = random.range(-2.0, 5.0) * pair.rack().pitch_mm;
        let rack = rack_with(&pair, ToothRange::ALL, &[RackDeviationKind::Thickness(ds)]);
        let point = mesh(&pair, rack, PinionFlanks::nominal(&pair)).at(s).unwrap();
        // a pinion that sinks between thinner teeth may meet a rack tip below its base circle first
        prop_assume!(line(&point));
        let expected = ds / (2.0 * pair.normal_pressure_angle_rad().tan());
        prop_assert!((point.delta_cd_mm - nominal_by_thickness(&pair) - expected).abs() < 1e-11);
    }

    // relations 3 and 4: while flank meets flank, ΔCD is exactly (e_right - e_left) / (2 tan α) of the teeth that carry:
    // the step's value while both sides of it carry and 0 before and after; with a low contact ratio a pinion alone in a
    // widened space sinks
    #[test]
    fn a_pitch_step_moves_the_pinion_while_both_sides_of_it_carry(seed: u64, step in -0.03..0.03_f64) {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let p = pair.rack().pitch_mm;
        let base = nominal_by_thickness(&pair);
        let rack = rack_with(&pair, from(3), &[RackDeviationKind::Shift(step)]);
        let mesh = mesh(&pair, rack, PinionFlanks::nominal(&pair));
        let strokes: Vec<f64> = (0..200).map(|i| p * (f64::from(i) / 25.0 - 1.5)).collect();
        for point in mesh.sample(&strokes).into_iter().flatten().filter(line) {
            let shift = |tooth: i64| if tooth >= 3 { step } else { 0.0 };
            let e = shift(point.right.rack_tooth) - shift(point.left.rack_tooth);
            let expected = base + e / (2.0 * pair.rack().tan_pressure_angle_x);
            prop_assert!((point.delta_cd_mm - expected).abs() < 1e-11, "{} {expected}", point.delta_cd_mm);
        }
    }

    #[test]
    fn a_pinion_pitch_step_moves_it_likewise(seed: u64, step in -0.03..0.03_f64) {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let z = i64::from(pair.pinion().teeth);
        let first = z / 2;
        let base = nominal_by_thickness(&pair);
        let pinion = pinion_with(&pair, from(first), &[PinionDeviationKind::Shift(step)]);
        let mesh = mesh(&pair, RackFlanks::nominal(&pair), pinion);
        let p = pair.rack().pitch_mm;
        let strokes: Vec<f64> = (0..200).map(|i| p * (first as f64 + f64::from(i) / 50.0 - 2.0)).collect();
        for point in mesh.sample(&strokes).into_iter().flatten().filter(line) {
            // a left flank of the pinion touches a right one of the rack: it gives way to a shift to higher index
            let shift = |tooth: u32| if i64::from(tooth) >= first { step } else { 0.0 };
            let e = shift(point.left.pinion_tooth) - shift(point.right.pinion_tooth);
            let expected = base + e / (2.0 * pair.pinion().transverse_pressure_angle_rad.tan());
            prop_assert!((point.delta_cd_mm - expected).abs() < 1e-11, "{} {expected}", point.delta_cd_mm);
        }
    }

    // relation 6
    #[test]
    fn radial_deviations_of_all_spaces_move_the_pinion_by_themselves(seed: u64, dr in -0.1..0.1_f64) {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let s = random.range(-2.0, 5.0) * pair.rack().pitch_mm;
        let pinion = pinion_with(&pair, ToothRange::ALL, &[PinionDeviationKind::Radial(dr)]);
        let point = mesh(&pair, RackFlanks::nominal(&pair), pinion).at(s).unwrap();
        prop_assume!(line(&point));
        prop_assert!((point.delta_cd_mm - nominal_by_thickness(&pair) - dr).abs() < 1e-11);
    }
}

/// Relation 5 with the published pair: thickness grows with the pitch, by half of it along X.
///
/// The published six values do not say how wide the pinion's face is, where its involute starts, and over which pitch
/// they are means. Tried were faces from 17 to 30 mm, an involute from the base circle and from five larger ones, and
/// the nominal pitch, the deviated one and 50 mm of stroke. One reading gives all six to the last digit: the mean over
/// the *deviated* pitch, after which the curve repeats, an involute from the base circle, and a face of 23.48 to 23.50
/// mm, whose ends just cut the path of contact where it is stretched most. A face that covers the rack wherever they
/// touch (more than 23.8 mm) gives 0.0194 0.0390 0.0589 | 0.0168 0.0350 0.0540.
#[test]
fn accumulated_pitch_errors_give_the_table() {
    let mut data = pairs::steering();
    let expected = [(0.01, 0.0194), (0.02, 0.0390), (0.03, 0.0588), (-0.01, 0.0168), (-0.02, 0.0349), (-0.03, 0.0538)];
    let covering = [0.01936, 0.03905, 0.05888, 0.01683, 0.03498, 0.05397];
    for ((dp, value), wide) in expected.into_iter().zip(covering) {
        let kinds = [RackDeviationKind::Pitch(dp), RackDeviationKind::Thickness(dp / 2.0)];
        for (face, value, rounding) in [(23.49, value, 5e-5), (30.0, wide, 5e-6)] {
            data.pinion.face_width_mm = face;
            let pair = Pair::new(&data).unwrap();
            let mesh = mesh(&pair, rack_with(&pair, ToothRange::ALL, &kinds), PinionFlanks::nominal(&pair));
            let period = pair.rack().pitch_mm + dp;
            for start in [0.0, 3.3] {
                let mean = mesh.curve(start, start + period, 1e-7).unwrap().summary(&mesh).unwrap().mean_mm;
                assert_abs_diff_eq!(mean, value, epsilon = rounding);
            }
        }
    }
}

/// Relation 7 for a straight rack: k |sin Δβ| / (2 tan α_n) in the limit of small errors, 5e-5 of it at 0.25°.
#[test]
fn a_lead_error_of_a_straight_rack_lifts_the_pinion() {
    let pair = table_pair();
    for (degrees, relative) in [(0.25, 1e-4), (-0.25, 1e-4), (0.02, 2e-5)] {
        let lead = f64::to_radians(degrees);
        let rack = rack_with(&pair, ToothRange::ALL, &[RackDeviationKind::Lead(lead)]);
        let mesh = mesh(&pair, rack.clone(), PinionFlanks::nominal(&pair));
        let expected = 19.7 * lead.sin().abs() / (2.0 * pair.normal_pressure_angle_rad().tan());
        let mut largest: f64 = 0.0;
        for i in 0..40 {
            largest = largest.max(mesh.at(f64::from(i) * 0.31).unwrap().delta_cd_mm);
        }
        println!("{degrees}: {largest} {expected} {:e}", largest / expected - 1.0);
        assert!((largest / expected - 1.0).abs() < relative, "{degrees}: {largest} {expected}");
        // a rack that may roll sits about half a percent lower, and never higher
        let free = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::FreeRoll { axis_depth_mm: 8.0 });
        let free = free.unwrap().at(3.0).unwrap();
        let fixed = mesh.at(3.0).unwrap();
        println!("  rolls {}: {} fixed {}", free.roll_rad, free.delta_cd_mm, fixed.delta_cd_mm);
        assert!(free.delta_cd_mm <= fixed.delta_cd_mm + 1e-12);
        assert!(free.delta_cd_mm > 0.98 * fixed.delta_cd_mm);
    }
}

/// Relation 7 for a helical rack: k |sin Δβ| / (2 cos β_rack tan α_n) within 2 %.
#[test]
fn a_lead_error_of_a_helical_rack_lifts_the_pinion() {
    let mut data = pairs::steering();
    data.rack.helix_angle_rad = 0.15;
    data.pinion.tip_diameter_mm = 2.0 * 8.0 / 21.0_f64.to_radians().cos() + 2.6;
    data.pinion.face_width_mm = 34.0;
    let pair = Pair::new(&data).unwrap();
    let lead = 0.25_f64.to_radians();
    let mesh =
        mesh(&pair, rack_with(&pair, ToothRange::ALL, &[RackDeviationKind::Lead(lead)]), PinionFlanks::nominal(&pair));
    let expected = 19.7 * lead.sin() / (2.0 * 0.15_f64.cos() * pair.normal_pressure_angle_rad().tan());
    let largest = mesh.curve(0.0, 13.0, 1e-6).unwrap().summary(&mesh).unwrap().max_mm;
    println!("{largest} {expected}");
    assert!((largest / expected - 1.0).abs() < 0.02, "{largest} {expected}");
}

// as `mesh::relations` derives it: both valleys of a rolling spur rack lie where one side's flanks fit again
#[test]
fn a_rack_that_may_roll_sinks_by_the_versine_of_its_roll() {
    let pair = table_pair();
    let (lead, depth) = (0.25_f64.to_radians(), 8.0);
    let rack = rack_with(&pair, ToothRange::ALL, &[RackDeviationKind::Lead(lead)]);
    let pinion = PinionFlanks::nominal(&pair);
    let fixed = mesh(&pair, rack.clone(), pinion.clone()).at(0.0).unwrap();
    let free = Mesh::new(pair, rack, pinion, Support::FreeRoll { axis_depth_mm: depth }).unwrap().at(0.0).unwrap();
    let roll = lead / pair.normal_pressure_angle_rad().tan();
    assert_abs_diff_eq!(free.roll_rad.abs(), roll, epsilon = 0.02 * roll);
    let sunk = fixed.delta_cd_mm - free.delta_cd_mm;
    assert_abs_diff_eq!(sunk, depth * roll * roll / 2.0, epsilon = 0.1 * sunk);
}

// the exception of `mesh::relations`: a pinion tooth alone in the space that is too wide
#[test]
fn a_single_pitch_error_can_sink_the_pinion() {
    // short teeth, so that at times one tooth carries alone
    let mut data = pairs::spur();
    data.rack.addendum_mm = 1.0;
    data.pinion.profile_shift = 0.0;
    data.pinion.tip_diameter_mm = 43.8;
    let pair = Pair::new(&data).unwrap();
    let step = RackDeviationKind::Pitch(0.02);
    let rack = rack_with(&pair, "4".parse().unwrap(), &[step]);
    let curve = mesh(&pair, rack, PinionFlanks::nominal(&pair)).curve(5.0, 40.0, 1e-6).unwrap();
    let by_formula = 0.02 / (2.0 * pair.normal_pressure_angle_rad().tan());
    let lowest = curve.points.iter().map(|point| point.delta_cd_mm).fold(0.0, f64::min);
    assert_abs_diff_eq!(lowest, -by_formula, epsilon = 1e-9);
}

/// An eccentric pinion moves by the amount when its tooth points at the rack.
#[test]
fn an_eccentric_pinion_swings_by_its_eccentricity() {
    let pair = table_pair();
    let pinion = PinionFlanks::new(&pair, &[PinionDeviation::eccentricity(0.015, 3)]).unwrap();
    let mesh = mesh(&pair, RackFlanks::nominal(&pair), pinion);
    let p = pair.rack().pitch_mm;
    assert_abs_diff_eq!(mesh.at(3.5 * p).unwrap().delta_cd_mm, 0.015, epsilon = 2e-6);
    assert_abs_diff_eq!(mesh.at(7.5 * p).unwrap().delta_cd_mm, -0.015, epsilon = 2e-6);
}

/// Carriers that ask for the same must not flicker: every kink of a nominal pair is one tooth taking over from another.
#[test]
fn a_nominal_curve_has_few_kinks_and_no_height() {
    for seed in 0..60 {
        let pair = random::pair(&mut Random(seed));
        let mesh = Mesh::nominal(pair).unwrap();
        let p = pair.rack().pitch_mm;
        let curve = mesh.curve(0.3 * p, 3.3 * p, 1e-6).unwrap();
        let summary = curve.summary(&mesh).unwrap();
        assert!(curve.resolved);
        assert!(summary.peak_to_peak_mm < 1e-11, "seed {seed}: {summary:?}");
        // three pitches of both sides
        assert!(curve.kinks.len() <= 6, "seed {seed}: {} kinks", curve.kinks.len());
    }
}

/// A helix slope deviation of the pinion, as `[errors]` puts it on the teeth, where the rack covers its whole face.
#[test]
fn a_lead_of_the_pinion_moves_it_by_its_law() {
    for (pinion_helix, rack_helix) in [("0", "0"), ("25", "0"), ("25", "-25"), ("-15", "15"), ("21", "4")] {
        for deviation in ["8 um", "-20 um"] {
            let text = format!(
                "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nface_width = 60\naddendum = 2\n\
                 helix_angle = {rack_helix}\n[pinion]\nteeth = 24\nhelix_angle = {pinion_helix}\nface_width = 20\n\
                 tip_diameter = {}\n[errors]\npinion_lead = \"{deviation}\"\n",
                48.0 / pinion_helix.parse::<f64>().unwrap().to_radians().cos() + 4.0
            );
            let spec = Spec::parse("lead", &text).unwrap_or_else(|error| panic!("{error}"));
            let law = spec.part_deviations().unwrap()[0].delta_cd(Model::Exact).unwrap().mm();
            let input = spec.mesh(&MeasuredTables::default()).unwrap_or_else(|error| panic!("{error}"));
            let pitch = input.mesh.pair().rack().pitch_mm;
            let strokes: Vec<f64> = (0..64).map(|i| f64::from(i) / 32.0 * pitch).collect();
            for point in input.mesh.sample(&strokes).into_iter().flatten() {
                let off = point.delta_cd_mm - law;
                assert!(off.abs() < 1e-11, "β_p = {pinion_helix}°, β_r = {rack_helix}°, {deviation}: {off}");
            }
        }
    }
}
