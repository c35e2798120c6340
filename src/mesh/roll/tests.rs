//! Tests of the rolling rack: that no roll is lower than the one found.

mod brute;
pub(in crate::mesh) mod odd;
mod search;

use super::*;
use crate::deviation::{
    PinionDeviation, PinionDeviationKind, PinionFlanks, PinionForm, RackDeviation, RackDeviationKind, RackFlanks,
    RackForm, ToothRange,
};
use crate::gear::{Pair, PairData, PinionData, RackData};
use crate::mesh::contact::tests::{self as contact_tests, Random};
use crate::mesh::{ContactKind, Mesh, Support};
use crate::reproduction;
use crate::trig;

/// A pair with a rack that rolls, and flanks that stand back.
fn formed(rack_helix: f64, pinion_helix: f64, lead: f64, eccentricity: f64, form: f64) -> Mesh {
    let radius = 20.0 / trig::cos(pinion_helix);
    let pair = Pair::new(&PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: 0.35,
        rack: RackData { helix_angle_rad: rack_helix, face_width_mm: 20.0, addendum_mm: 1.9, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 20,
            helix_angle_rad: pinion_helix,
            profile_shift: 0.2,
            tip_diameter_mm: 2.0 * radius + 4.6,
            root_form_diameter_mm: Some(2.0 * radius - 1.8),
            face_width_mm: 26.0,
            tooth_thickness_deviation_mm: 0.0,
        },
    })
    .expect("a valid pair");
    let lead = RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Lead(lead) };
    let rack_form = RackForm { crowning_mm: form, tip_relief_mm: 0.7 * form, tip_relief_start_mm: 0.4 };
    let pinion_form = PinionForm { crowning_mm: 0.4 * form, profile_slope_mm: -0.5 * form };
    let rack = RackFlanks::new(&pair, &[lead]).and_then(|rack| rack.with_form(&pair, rack_form)).expect("small");
    let off_axis = PinionDeviation::eccentricity(eccentricity, 3);
    let pinion = PinionFlanks::new(&pair, &[off_axis]).and_then(|pinion| pinion.with_form(pinion_form));
    let pinion = pinion.expect("small");
    Mesh::new(pair, rack, pinion, Support::FreeRoll { axis_depth_mm: 8.0 }).expect("teeth in order")
}

/// How many derivatives by the roll were compared with differences, and by how much they differ at most.
fn derivatives(mesh: &Mesh, depth_mm: f64, strokes: impl Iterator<Item = f64>) -> (usize, f64) {
    let mut sampler = Sampler::new(mesh);
    let (mut compared, mut worst) = (0, 0.0_f64);
    for stroke in strokes {
        for angle in [-0.05, -0.02, -0.004, 0.003, 0.013, 0.031, 0.06] {
            let h = 1e-5;
            let mut at = |angle| sampler.at_roll(stroke, angle, depth_mm).expect("contact");
            let (before, here, after) = (at(angle - h), at(angle), at(angle + h));
            // across a kink there is no derivative
            if before.rolling.at == after.rolling.at {
                compared += 1;
                worst = worst.max(((after.value - before.value) / (2.0 * h) - here.slope).abs());
            }
        }
    }
    (compared, worst)
}

/// Spur, helical on parallel axes, and crossed; with and without eccentricity and flank form.
#[test]
fn the_derivative_by_the_roll_is_that_of_differences() {
    let (mut all, mut worst) = (0, 0.0_f64);
    for (rack, pinion) in [(0.0, 0.0), (-0.35, 0.35), (0.0, 0.37), (0.2, 0.3)] {
        for (lead, eccentricity, form) in
            [(0.004, 0.0, 0.0), (0.004, 0.05, 0.0), (-0.007, 0.02, 0.0), (0.002, 0.0, 0.02), (-0.004, 0.03, 0.01)]
        {
            let mesh = formed(rack, pinion, lead, eccentricity, form);
            let (compared, difference) = derivatives(&mesh, 8.0, (0..12).map(|step| 0.77 * f64::from(step)));
            (all, worst) = (all + compared, worst.max(difference));
        }
    }
    println!("{all} derivatives, largest difference {worst:e} mm/rad");
    assert!(all > 1600 && worst < 1e-5, "{all} {worst:e}");
}

/// Axes crossed by so much that the rack's end faces cut the line of contact off: at one end of the flank that is left,
/// its edges meet, and as the rack rolls that point wanders along the flank.
#[test]
fn the_derivative_by_the_roll_counts_how_an_end_of_the_flank_moves() {
    let pair = Pair::new(&PairData {
        normal_module_mm: 3.34,
        normal_pressure_angle_rad: 0.3836,
        rack: RackData { helix_angle_rad: 0.0, face_width_mm: 14.4, addendum_mm: 3.66, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 35,
            helix_angle_rad: -0.474,
            profile_shift: 0.41,
            tip_diameter_mm: 139.4,
            root_form_diameter_mm: Some(127.2),
            face_width_mm: 41.8,
            tooth_thickness_deviation_mm: 0.0,
        },
    })
    .expect("a valid pair");
    let lead = |teeth, lead| RackDeviation { teeth, kind: RackDeviationKind::Lead(lead) };
    let leads = [lead(ToothRange::ALL, 0.0052), lead(ToothRange::new(Some(4), Some(6)).expect("in order"), -0.003)];
    let rack = RackFlanks::new(&pair, &leads).expect("small");
    let support = Support::FreeRoll { axis_depth_mm: 14.0 };
    let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), support).expect("teeth in order");
    let (compared, worst) = derivatives(&mesh, 14.0, (0..12).map(|step| 54.0 + 0.9 * f64::from(step)));
    println!("{compared} derivatives, largest difference {worst:e} mm/rad");
    assert!(compared > 60 && worst < 1e-5, "{compared} {worst:e}");
}

/// Where the demands of both sides rise as the pinion turns, what both ask for together changes by more than either.
#[test]
fn the_derivative_by_the_roll_holds_where_both_sides_rise_together() {
    let pair = Pair::new(&PairData {
        normal_module_mm: 1.2177,
        normal_pressure_angle_rad: 0.2831,
        rack: RackData { helix_angle_rad: 0.0, face_width_mm: 46.7, addendum_mm: 1.2264, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 56,
            helix_angle_rad: 0.6142,
            profile_shift: 0.7399,
            tip_diameter_mm: 87.21,
            root_form_diameter_mm: Some(84.66),
            face_width_mm: 31.1,
            tooth_thickness_deviation_mm: -0.0859,
        },
    })
    .expect("a valid pair");
    let deviation = |first, kind| RackDeviation { teeth: ToothRange::new(Some(first), None).expect("in order"), kind };
    let deviations = [deviation(3, RackDeviationKind::Thickness(0.29)), deviation(10, RackDeviationKind::Pitch(-0.18))];
    let rack = RackFlanks::new(&pair, &deviations).expect("small");
    let support = Support::FreeRoll { axis_depth_mm: 9.8 };
    let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), support).expect("teeth in order");
    let (compared, worst) = derivatives(&mesh, 9.8, (0..60).map(|step| 100.0 + 0.43 * f64::from(step)));
    println!("{compared} derivatives, largest difference {worst:e} mm/rad");
    // the derivatives are some 20 mm/rad, and change so fast that differences are off by 0.03
    assert!(compared > 400 && worst < 0.05, "{compared} {worst:e}");
}

/// Between a falling and a rising end there may be a valley that is higher than one of them. Once that end was taken for
/// the bottom again and again, until the search was given up.
#[test]
fn a_valley_above_an_end_is_not_that_end() {
    let pair = reproduction::pair().expect("the paper's pair");
    let lead = RackDeviation {
        teeth: ToothRange::new(Some(4), None).expect("in order"),
        kind: RackDeviationKind::Lead(0.004_363),
    };
    let rack = RackFlanks::new(&pair, &[lead]).expect("small");
    let support = Support::FreeRoll { axis_depth_mm: 8.0 };
    let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), support).expect("teeth in order");
    for stroke in [24.402_106, 24.411_765, 24.43] {
        let mut sampler = Sampler::new(&mesh);
        let point = sampler.at(stroke).expect("contact");
        let work = sampler.work();
        println!("{stroke}: {} {work:?}", point.roll_rad);
        assert!(point.converged() && work.searched < 1000, "{point:?} {work:?}");
        for step in -75..=75 {
            let roll = 1e-3 * f64::from(step);
            for roll in [roll, point.roll_rad + 1e-3 * roll] {
                let here = sampler.at_roll(stroke, roll, 8.0).expect("contact");
                assert!(here.value > point.center_distance_mm - 1e-11, "{stroke} {roll}: {} {point:?}", here.value);
            }
        }
    }
}

/// A random pair as somebody would build it, on a rack that may roll, with errors and perhaps form.
fn random_mesh(random: &mut Random) -> Option<Mesh> {
    let pair = contact_tests::pair(random, false)?;
    let deviation = |random: &mut Random, kind: fn(f64) -> RackDeviationKind, most: f64| RackDeviation {
        teeth: ToothRange::new(Some(if random.next(0.0, 1.0) < 0.5 { 0 } else { 4 }), None).expect("in order"),
        kind: kind(random.next(-most, most)),
    };
    let mut deviations = vec![deviation(random, RackDeviationKind::Lead, 0.006)];
    if random.next(0.0, 1.0) < 0.6 {
        deviations.push(deviation(random, RackDeviationKind::Pitch, 0.03));
        deviations.push(deviation(random, RackDeviationKind::Left, 0.03));
    }
    let mut rack = RackFlanks::new(&pair, &deviations).ok()?;
    let off_axis = PinionDeviation::eccentricity(random.next(0.0, 0.05), 0);
    let lead = PinionDeviation {
        teeth: ToothRange::single(2).ok()?,
        kind: PinionDeviationKind::Lead(random.next(-0.004, 0.004)),
    };
    let mut pinion = PinionFlanks::new(&pair, &[lead, off_axis]).ok()?;
    if random.next(0.0, 1.0) < 0.2 {
        let relief = RackForm { crowning_mm: random.next(0.0, 0.02), tip_relief_mm: 0.01, tip_relief_start_mm: 0.0 };
        rack = rack.with_form(&pair, relief).ok()?;
        pinion = pinion.with_form(PinionForm { crowning_mm: 0.01, profile_slope_mm: -0.01 }).ok()?;
    }
    Mesh::new(pair, rack, pinion, Support::FreeRoll { axis_depth_mm: random.next(0.0, 15.0) }).ok()
}

/// The lowest roll of random pairs is that of the brute force, whether the stroke before is known or not.
/// `RACKMESH_LONG_TESTS=1` looks at very many.
#[test]
fn no_roll_of_random_pairs_is_lower() {
    let long = std::env::var("RACKMESH_LONG_TESTS").is_ok_and(|value| value == "1");
    let (mut made, mut converged, mut most, mut worst) = (0, 0, 0, 0.0_f64);
    for seed in 0..if long { 3000 } else { 40 } {
        let mut random = Random(seed);
        let Some(mesh) = random_mesh(&mut random) else { continue };
        for _ in 0..if long { 3 } else { 2 } {
            let stroke = random.next(-20.0, 60.0);
            let mut walker = Sampler::new(&mesh);
            let _ = walker.at(stroke - random.next(0.0, 0.05));
            let lowest = brute::lowest(&mesh, stroke);
            for mut sampler in [Sampler::new(&mesh), walker] {
                let before = sampler.work().searched;
                let Ok(point) = sampler.at(stroke) else { continue };
                made += 1;
                most = most.max(sampler.work().searched - before);
                if point.converged() {
                    converged += 1;
                    let off = lowest.map_or(f64::INFINITY, |(lowest, _)| point.center_distance_mm - lowest);
                    worst = worst.max(off.abs());
                    if off.abs() > 1e-9 {
                        println!("seed {seed}, stroke {stroke}: by {off:e} {lowest:?} {point:?}");
                    }
                }
            }
        }
    }
    println!("{converged} of {made} converged, at most {most} searched; {worst:e} mm");
    assert!(
        made > 120 && converged > made - made / 500 - 1 && most < MAX_SEARCHES / 5,
        "{converged} of {made}, {most}"
    );
    assert!(worst < 1e-9, "{worst:e}");
}

/// A search ends within a roll of what it may take, in a valley or between, and says that it did not see everything.
#[test]
fn a_search_takes_no_more_than_it_may() {
    let mesh = formed(0.2, 0.3, 0.004, 0.03, 0.02);
    let search = |stroke, searches| {
        let mut sampler = Sampler::new(&mesh);
        let found = sampler.lowest(stroke, 8.0, searches).expect("contact");
        (found.point.ending, sampler.work().searched)
    };
    for step in 0..6 {
        let stroke = 0.9 * f64::from(step);
        let (ending, whole) = search(stroke, MAX_SEARCHES);
        assert!(ending == Ending::Converged && whole > 150, "{ending:?} {whole}");
        let first = search(stroke, 0).1;
        let mut sampler = Sampler::new(&mesh);
        let [low, high] = [-0.05, 0.05].map(|roll| sampler.at_roll(stroke, roll, 8.0).expect("contact"));
        let before = sampler.work();
        let out = AtStroke { stroke_mm: stroke, depth_mm: 8.0, most_searched: before.searched - 1 };
        let narrowed = sampler.narrow([low, high], &out);
        assert!(!narrowed.is_closed && sampler.work() == before);
        for (end, given) in [(narrowed.low, low), (narrowed.high, high)] {
            assert!(end.point.ending == Ending::RollNotFound && end.value == given.value, "{end:?}");
        }
        for part in 1..8 {
            let may = first + (whole - first) * part / 8;
            let (ending, searched) = search(stroke, may);
            assert!(ending == Ending::RollNotFound && searched > may && searched < may + 50, "{may}: {searched}");
        }
    }
}

/// What one rotation and known peaks say of a roll is no more than its solution, wherever the search comes from.
#[test]
fn what_a_roll_asks_for_at_least_is_no_more_than_its_solution() {
    let (mut bounds, mut near) = (0, 0);
    for (lead, form) in [(0.004, 0.0), (0.004, 0.02), (-0.002, 0.01)] {
        let mesh = formed(0.2, 0.3, lead, 0.03, form);
        let mut sampler = Sampler::new(&mesh);
        for step in 0..12 {
            let stroke_mm = 0.31 * f64::from(step);
            sampler.at(stroke_mm).expect("contact");
            let stroke = AtStroke { stroke_mm, depth_mm: 8.0, most_searched: u64::MAX };
            for roll in [-0.06, -0.02, -0.003, 0.0007, 0.011, 0.05] {
                let exact = Sampler::new(&mesh).at_roll(stroke_mm, roll, 8.0).expect("contact");
                for best in [None, Some(exact.value - 0.1)] {
                    let bound = sampler.at_least(&stroke, roll, best).expect("contact");
                    assert!(bound.value <= exact.value + 1e-11, "{roll} {best:?}: {bound:?} {exact:?}");
                    bounds += usize::from(!bound.is_exact);
                    near += usize::from(!bound.is_exact && bound.value > exact.value - 1e-3);
                }
            }
        }
    }
    println!("{bounds} bounds, {near} of them near");
    assert!(bounds > 400 && near > 300, "{bounds} {near}");
}

/// A spur pair with a pressure angle and a rack face.
fn spur(pressure_angle: f64, face: f64, lead: f64) -> Mesh {
    spur_on(pressure_angle, face, lead, 8.0)
}

fn spur_on(pressure_angle: f64, face: f64, lead: f64, axis_depth_mm: f64) -> Mesh {
    let pair = Pair::new(&PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: pressure_angle,
        rack: RackData { helix_angle_rad: 0.0, face_width_mm: face, addendum_mm: 1.9, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 20,
            helix_angle_rad: 0.0,
            profile_shift: 0.2,
            tip_diameter_mm: 44.6,
            root_form_diameter_mm: Some(38.2),
            face_width_mm: face + 6.0,
            tooth_thickness_deviation_mm: 0.0,
        },
    })
    .expect("a valid pair");
    let lead = RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Lead(lead) };
    let rack = RackFlanks::new(&pair, &[lead]).expect("small");
    Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::FreeRoll { axis_depth_mm }).expect("in order")
}

/// A flat flank with a large lead error is level again at a roll of lead/tan α, beyond what is searched: that is said.
#[test]
fn a_valley_beyond_the_largest_roll_is_not_called_found() {
    for (alpha, lead, beyond) in [(0.35, 0.02, false), (0.35, 0.029, true), (0.35, -0.029, true), (0.2, 0.01, false)] {
        let mesh = spur(alpha, 20.0, lead);
        for step in 0..6 {
            let point = mesh.at(0.9 * f64::from(step)).expect("contact");
            let expected = lead.abs() / trig::tan(alpha);
            assert_eq!(point.ending == Ending::RollNotFound, beyond, "{alpha} {lead} {point:?}");
            assert_eq!(point.converged(), !beyond);
            let off = point.roll_rad.abs() - expected.min(LARGEST_ROLL_RAD);
            assert!(off.abs() < 0.05 * expected, "{alpha} {lead} {expected} {point:?}");
        }
    }
}

/// Few teeth, an involute from its base circle and narrow faces: where that circle meets the pinion's end face is
/// higher than where the climb over generators ended, whose name and derivative it once was given; a roll was then
/// taken for a bottom that is none, and a valley passed over.
#[test]
fn no_roll_is_lower_where_narrow_faces_meet_on_the_base_circle() {
    let pair = Pair::new(&PairData {
        normal_module_mm: 3.178,
        normal_pressure_angle_rad: 0.4323,
        rack: RackData { helix_angle_rad: 0.0, face_width_mm: 1.977, addendum_mm: 4.306, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 9,
            helix_angle_rad: -0.1478,
            profile_shift: -0.0547,
            tip_diameter_mm: 34.32,
            root_form_diameter_mm: None,
            face_width_mm: 3.254,
            tooth_thickness_deviation_mm: 0.0,
        },
    })
    .expect("a valid pair");
    let support = Support::FreeRoll { axis_depth_mm: 16.08 };
    let mesh = Mesh::new(pair, RackFlanks::nominal(&pair), PinionFlanks::nominal(&pair), support).expect("in order");
    for (stroke, rolls) in [(4.942, -60..=-50), (5.166, 60..=80), (5.243, 75..=90), (5.46, 110..=130)] {
        let point = mesh.at(stroke).expect("contact");
        let mut sampler = Sampler::new(&mesh);
        for roll in rolls {
            let here = sampler.at_roll(stroke, 1e-5 * f64::from(roll), 16.08).expect("contact");
            assert!(here.value > point.center_distance_mm - 1e-10, "{stroke} {}: {} {point:?}", here.angle, here.value);
        }
    }
}

/// The corner of a rack's tip passes the circle where the involute starts: what it asks for falls there all at once, into a
/// valley beside the one of the last stroke.
#[test]
fn a_valley_behind_a_corner_that_falls_sharply_is_found() {
    const DEGREE: f64 = std::f64::consts::PI / 180.0;
    let pair = Pair::new(&PairData {
        normal_module_mm: 2.5,
        normal_pressure_angle_rad: 20.85 * DEGREE,
        rack: RackData { helix_angle_rad: DEGREE, face_width_mm: 18.14, addendum_mm: 2.4, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 7,
            helix_angle_rad: -DEGREE,
            profile_shift: 0.3,
            tip_diameter_mm: 22.053,
            root_form_diameter_mm: None,
            face_width_mm: 28.99,
            tooth_thickness_deviation_mm: 0.0,
        },
    })
    .expect("a valid pair");
    let (third, later) = (ToothRange::single(3).expect("in order"), ToothRange::new(Some(2), None).expect("in order"));
    let lead = -1.66 / 60.0 * DEGREE;
    let deviations = [
        RackDeviation { teeth: third, kind: RackDeviationKind::OverRoller(0.009_26) },
        RackDeviation { teeth: third, kind: RackDeviationKind::Shift(-0.003_19) },
        RackDeviation { teeth: later, kind: RackDeviationKind::Left(-0.013_04) },
        RackDeviation { teeth: later, kind: RackDeviationKind::Lead(lead) },
    ];
    let rack = RackFlanks::new(&pair, &deviations).expect("small");
    let pinion = PinionFlanks::new(&pair, &[PinionDeviation::eccentricity(0.003, 2)]).expect("small");
    let mesh = Mesh::new(pair, rack, pinion, Support::FreeRoll { axis_depth_mm: 7.0 }).expect("in order");
    let (lowest, roll) = brute::lowest(&mesh, 20.4525).expect("contact");
    assert!((roll - 0.001_992).abs() < 1e-6, "{roll}");
    for before in [20.43, 20.4547, 20.456] {
        let mut sampler = Sampler::new(&mesh);
        sampler.at(before).expect("contact");
        let point = sampler.at(20.4525).expect("contact");
        assert!((point.center_distance_mm - lowest).abs() < 1e-9, "{before}: {lowest} {point:?}");
    }
}

/// The height of a rack point bends by its distance from the axis at most.
#[test]
fn the_farthest_point_is_at_a_corner_of_the_tip() {
    let mesh = spur(0.35, 20.0, 0.0);
    // the tip is 1.9 mm high, the roots at least as deep as one module
    let expected = (10.0_f64 * 10.0 + 10.0 * 10.0).sqrt();
    assert!((Sampler::new(&mesh).largest_distance(8.0) - expected).abs() < 1e-12);
    assert!((Sampler::new(&mesh).largest_distance(-8.0) - expected).abs() < 1e-12);
    let mesh = spur(0.35, 6.0, 0.0);
    assert!((Sampler::new(&mesh).largest_distance(2.0) - 5.0).abs() < 1e-12);
}

/// Where a few bounds do not show that the level rack is the lowest, the search ends at it, and then it is that.
#[test]
fn a_search_that_ends_at_the_level_rack_gives_it() {
    for (face, depth) in [(2.0, -30.0), (5.0, -30.0), (5.0, 60.0)] {
        let mesh = spur_on(0.35, face, 0.0, depth);
        for step in 0..10 {
            let mut sampler = Sampler::new(&mesh);
            let stroke = 0.61 * f64::from(step);
            let point = sampler.at(stroke).expect("contact");
            let lines = [point.right.contact, point.left.contact] == [ContactKind::Line; 2];
            assert!(point.roll_rad == 0.0 && lines && point.converged(), "{face} {depth} {point:?}");
        }
    }
}
