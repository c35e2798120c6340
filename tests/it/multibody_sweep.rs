//! Whatever a simulation is asked ends in a right answer or in an error that says what to change.
//!
//! The default run is short; `RACKMESH_LONG_TESTS=1` runs 10 times as many scenes.
#![allow(clippy::pedantic, clippy::disallowed_methods)]

use std::ops::ControlFlow;

use crate::common::paper;
use crate::common::random::{self, Random};
use rackmesh::deviation::*;
use rackmesh::multibody::*;

fn cases(short: u64) -> std::ops::Range<u64> {
    0..if crate::common::is_long() { 10 * short } else { short }
}

fn power(random: &mut Random, low: f64, high: f64) -> f64 {
    10_f64.powf(random.range(low, high))
}

/// A deviation of any kind on teeth 4 and later.
fn kind(random: &mut Random) -> RackDeviationKind {
    match random.int(0, 3) {
        0 => RackDeviationKind::OverRoller(random.range(-0.05, 0.05)),
        1 => RackDeviationKind::Pitch(random.range(-0.03, 0.03)),
        2 => RackDeviationKind::Thickness(random.range(-0.05, 0.05)),
        _ => RackDeviationKind::Lead(random.range(-0.01, 0.01)),
    }
}

/// Every number over its whole range, on a logarithmic scale where it has one.
fn parameters(random: &mut Random) -> Parameters {
    let contact = if random.chance(0.3) {
        ContactModel::Analytic(StripGrid { strips: power(random, 0.5, 3.5) as u32 })
    } else {
        ContactModel::Spheres(SphereGrid {
            profile_nodes: power(random, 0.4, 2.5) as u32,
            width_nodes: power(random, 0.4, 2.5) as u32,
            radius_mm: if random.chance(0.2) { 0.0 } else { power(random, -2.0, 0.3) },
            ..SphereGrid::default()
        })
    };
    let some = |random: &mut Random| {
        let value = if random.chance(0.5) { 0.0 } else { power(random, -6.0, 2.0) };
        random.chance(0.4).then_some(value)
    };
    let preload_n = power(random, -1.0, 4.0);
    let support = match random.int(0, 5) {
        0 => Support::FreeRoll { axis_depth_mm: random.range(-5.0, 20.0) },
        1 => Support::Yoke(Yoke { preload_n, rate_n_per_mm: power(random, 0.0, 4.0), ..Yoke::default() }),
        _ => Support::Fixed,
    };
    Parameters {
        contact,
        support,
        preload_n,
        stroke_mm: 2.0,
        start_mm: random.range(-5.0, 30.0),
        stiffness: power(random, 3.0, 9.0),
        stiffness_exponent: random.range(1.0, 2.5),
        damping: if random.chance(0.3) { 0.0 } else { power(random, 0.0, 9.0) },
        damping_exponent: random.range(1.0, 2.5),
        indentation_exponent: random.range(1.0, 2.5),
        friction: if random.chance(0.5) { 0.0 } else { random.range(0.0, 0.3) },
        friction_speed_mm_per_s: power(random, -3.0, 1.0),
        speed_mm_per_s: power(random, -1.0, 3.0),
        energy_tolerance: 1.0,
        max_steps: 5_000,
        masses: Masses {
            pinion_kg: some(random),
            pinion_kg_mm2: some(random),
            rack_kg: some(random),
            rack_kg_mm2: some(random),
        },
        ..Parameters::default()
    }
}

#[test]
fn whatever_is_asked_ends_right_or_says_what_to_change() {
    let (mut refused, mut completed, mut failed, mut compared) = (0, 0, 0, 0);
    let advises = |error: &SimulationError| {
        let words = error.to_string();
        assert!(["lower", "raise", "loosen", "refine", "outside"].iter().any(|word| words.contains(word)), "{words}");
    };
    for seed in cases(60) {
        let mut random = Random(seed);
        let (pair, kind, parameters) = (paper::pair(), kind(&mut random), parameters(&mut random));
        let rack = RackFlanks::new(&pair, &[RackDeviation { teeth: "4..".parse().unwrap(), kind }]).unwrap();
        let scene = match Scene::new(pair, rack, PinionFlanks::nominal(&pair), parameters) {
            Ok(scene) => scene,
            Err(error) => {
                advises(&error);
                refused += 1;
                continue;
            }
        };
        for dynamic in [false, true] {
            let mut watch = |_: &Sample| ControlFlow::Continue(());
            let outcome = if dynamic { scene.dynamic(&mut watch) } else { scene.quasi_static(&mut watch) };
            // bounded work: steps are, and so is what a step may take
            assert!(outcome.counters.evaluations < 300_000, "seed {seed}: {:?}", outcome.counters);
            for sample in &outcome.samples {
                let numbers = [
                    sample.delta_cd_mm,
                    sample.pinion_angle_rad,
                    sample.roll_rad,
                    sample.indentation_mm,
                    sample.penetration_mm,
                ];
                assert!(numbers.iter().all(|value| value.is_finite()), "seed {seed}: {sample:?}");
                let both = sample.normal_force_left_n > 0.0 && sample.normal_force_right_n > 0.0;
                if dynamic || !both || scene.rolls() || sample.indentation_mm > 5e-3 {
                    continue;
                }
                // in equilibrium it is the exact mesh but for what lies between the spheres
                let exact = scene.mesh().at(sample.stroke_mm).unwrap().delta_cd_mm;
                let off = sample.delta_cd_mm + sample.indentation_mm - exact;
                let bound = scene.sinking_mm();
                compared += 1;
                // the indentation is added back to first order
                assert!(
                    off.abs() <= bound + 0.2 * sample.indentation_mm + 1e-8,
                    "seed {seed}: {off} of {bound} {sample:?} {kind:?} {parameters:?}"
                );
            }
            match outcome.end {
                RunEnd::Completed => completed += 1,
                RunEnd::Failed(error) => {
                    advises(&error);
                    println!("seed {seed}, dynamic {dynamic}: {error}");
                    failed += 1;
                }
                RunEnd::Interrupted => unreachable!(),
            }
        }
    }
    println!("{refused} refused, {completed} completed, {failed} failed, {compared} positions compared");
    assert!(completed > 3 * failed && compared > 100, "{completed} completed, {failed} failed, {compared} compared");
}

/// Pairs of every hand, helix and shaft angle with deviations of every kind, in equilibrium and in time.
#[test]
fn any_pair_with_any_deviations_is_the_exact_mesh_or_says_why_not() {
    let (mut completed, mut failed, mut compared) = (0, 0, 0);
    for seed in cases(12) {
        let mut random = Random(1_000_000 + seed);
        let pair = random::pair(&mut random);
        let (rack, pinion) = (random::rack(&mut random, &pair, true), random::pinion(&mut random, &pair, true));
        let contact = if random.chance(0.5) {
            ContactModel::Analytic(StripGrid { strips: 200 })
        } else {
            ContactModel::Spheres(SphereGrid { profile_nodes: 40, width_nodes: 120, ..SphereGrid::default() })
        };
        let pitch = pair.rack().pitch_mm;
        let parameters = Parameters {
            contact,
            start_mm: random.range(-2.0, 6.0) * pitch,
            stroke_mm: 1.2 * pitch,
            spacing_mm: 0.08 * pitch,
            max_steps: 5_000,
            stiffness: 1e8,
            preload_n: 50.0,
            ..Parameters::default()
        };
        let scene = match Scene::new(pair, rack, pinion, parameters) {
            Ok(scene) => scene,
            Err(error) => {
                println!("seed {seed}: {error}");
                failed += 1;
                continue;
            }
        };
        for dynamic in [false, true] {
            let mut watch = |_: &Sample| ControlFlow::Continue(());
            let outcome = if dynamic { scene.dynamic(&mut watch) } else { scene.quasi_static(&mut watch) };
            if outcome.end == RunEnd::Completed {
                completed += 1
            } else {
                failed += 1
            }
            if outcome.end != RunEnd::Completed {
                println!("seed {seed}, dynamic {dynamic}: {:?}", outcome.end);
            }
            for sample in outcome.samples.iter().filter(|_| !dynamic) {
                assert!(sample.delta_cd_mm.is_finite() && sample.indentation_mm.is_finite(), "seed {seed}: {sample:?}");
                let exact = scene.mesh().at(sample.stroke_mm).unwrap().delta_cd_mm;
                let off = sample.delta_cd_mm + sample.indentation_mm - exact;
                compared += 1;
                assert!(
                    off.abs() <= scene.sinking_mm() + 0.2 * sample.indentation_mm + 1e-8,
                    "seed {seed}: {off} of {} {sample:?} {parameters:?}",
                    scene.sinking_mm()
                );
            }
        }
    }
    println!("{completed} completed, {failed} failed, {compared} positions compared");
    assert!(completed > 4 * failed && compared > 100, "{completed} completed, {failed} failed, {compared} compared");
}

/// What a run costs is in proportion to the stroke, and grows far more slowly than the number of spheres.
#[test]
fn work_grows_with_the_stroke_and_hardly_with_the_spheres() {
    let run = |profile_nodes: u32, width_nodes: u32, stroke_mm: f64| {
        let contact = ContactModel::Spheres(SphereGrid { profile_nodes, width_nodes, ..SphereGrid::default() });
        let scene = paper::scene(None, Parameters { contact, stroke_mm, ..Parameters::default() });
        let outcome = scene.quasi_static(&mut |_: &Sample| ControlFlow::Continue(()));
        assert_eq!(outcome.end, RunEnd::Completed);
        outcome.counters.spheres_tested as f64
    };
    let (short, long) = (run(48, 96, 10.0), run(48, 96, 40.0));
    assert!((long / short / 4.0 - 1.0).abs() < 0.1, "{short} {long}");
    // 22 times as many spheres, and 1e5 on a flank
    assert!(run(312, 320, 10.0) < 8.0 * short, "{} {short}", run(312, 320, 10.0));
}
