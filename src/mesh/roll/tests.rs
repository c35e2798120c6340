//! Tests of the rolling rack, and of its bounds.

use super::*;
use crate::deviation::{
    Eccentricity, PinionFlanks, PinionForm, RackDeviation, RackDeviationKind, RackFlanks, RackForm, ToothRange,
};
use crate::gear::{Pair, PairData, PinionData, RackData};
use crate::mesh::{ContactKind, Mesh, Support};
use crate::trig;

fn rolling(rack_helix: f64, pinion_helix: f64, lead: f64, eccentricity: f64) -> Mesh {
    formed(rack_helix, pinion_helix, lead, eccentricity, 0.0)
}

/// The same with flanks that stand back.
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
    let off_axis = Eccentricity { amount_mm: eccentricity, tooth: 3 };
    let pinion =
        PinionFlanks::nominal(&pair).with_eccentricity(&[off_axis]).and_then(|pinion| pinion.with_form(pinion_form));
    let pinion = pinion.expect("small");
    Mesh::new(pair, rack, pinion, Support::FreeRoll { axis_depth_mm: 8.0 }).expect("teeth in order")
}

/// Where the unrolled rack is taken at once, a search over all rolls finds nothing else.
#[test]
fn a_level_rack_is_what_a_search_finds() {
    let mut level = 0;
    for (rack, pinion) in [(0.0, 0.0), (-0.35, 0.35), (0.0, 0.37), (0.2, 0.3)] {
        for (lead, eccentricity) in [(0.0, 0.0), (0.0, 0.05), (1e-5, 0.0), (0.004, 0.0)] {
            let mesh = rolling(rack, pinion, lead, eccentricity);
            let mut sampler = Sampler::new(&mesh);
            for step in 0..40 {
                let stroke = 0.63 * f64::from(step);
                if let Some(flat) = sampler.level(stroke, 8.0) {
                    level += 1;
                    let searched = sampler.lowest(stroke, 8.0).expect("contact");
                    assert!(searched.value > flat.value - LEVEL && searched.angle.abs() < FLAT, "{stroke}");
                }
            }
        }
    }
    println!("{level} of 640 strokes are level");
    assert!(level > 250, "{level}");
}

/// Spur, helical on parallel axes, and crossed; with and without eccentricity and flank form.
#[test]
fn the_derivative_by_the_roll_is_that_of_differences() {
    let (mut compared, mut worst) = (0, 0.0_f64);
    for (rack, pinion) in [(0.0, 0.0), (-0.35, 0.35), (0.0, 0.37), (0.2, 0.3)] {
        for (lead, eccentricity, form) in
            [(0.004, 0.0, 0.0), (0.004, 0.05, 0.0), (-0.007, 0.02, 0.0), (0.002, 0.0, 0.02), (-0.004, 0.03, 0.01)]
        {
            let mesh = formed(rack, pinion, lead, eccentricity, form);
            let mut sampler = Sampler::new(&mesh);
            for step in 0..12 {
                let stroke = 0.77 * f64::from(step);
                for angle in [-0.05, -0.02, -0.004, 0.003, 0.013, 0.031, 0.06] {
                    let h = 1e-5;
                    let mut at = |angle| sampler.at_roll(stroke, angle, 8.0).expect("contact");
                    let (before, here, after) = (at(angle - h), at(angle), at(angle + h));
                    // across a kink there is no derivative
                    if before.rolling.at == after.rolling.at {
                        compared += 1;
                        worst = worst.max(((after.value - before.value) / (2.0 * h) - here.slope).abs());
                    }
                }
            }
        }
    }
    println!("{compared} derivatives, largest difference {worst:e} mm/rad");
    assert!(compared > 1600 && worst < 1e-5, "{compared} {worst:e}");
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
            assert_eq!(point.ending == Ending::IterationLimit, beyond, "{alpha} {lead} {point:?}");
            assert_eq!(point.converged(), !beyond);
            let off = point.roll_rad.abs() - expected.min(LARGEST);
            assert!(off.abs() < 0.05 * expected, "{alpha} {lead} {expected} {point:?}");
        }
    }
}

/// The bound on how the height of a rack point bends follows from the point farthest from the axis.
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
            assert!(sampler.level(stroke, depth).is_none());
            let point = sampler.at(stroke).expect("contact");
            let lines = [point.right.contact, point.left.contact] == [ContactKind::Line; 2];
            assert!(point.roll_rad == 0.0 && lines && point.converged(), "{face} {depth} {point:?}");
        }
    }
}
