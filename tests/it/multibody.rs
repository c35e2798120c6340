//! The multibody model against the exact mesh, and its own promises.
#![allow(clippy::pedantic, clippy::disallowed_methods)]

mod energies;

use std::ops::ControlFlow;

use crate::common::random::{self, Random};
use crate::common::{convergence, paper};
use rackmesh::deviation::*;
use rackmesh::multibody::*;

fn go_on(_: &Sample) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn analytic() -> Parameters {
    Parameters { contact: ContactModel::Analytic(StripGrid::default()), ..Parameters::default() }
}

/// Every error of the paper's Tables 1 to 3, with how far it may be from the exact mesh as a length and as a share.
fn rows() -> Vec<(RackDeviationKind, f64, f64)> {
    let mut rows = Vec::new();
    for e in [0.01, 0.02, 0.03, -0.01, -0.02, -0.03] {
        rows.push((RackDeviationKind::OverRoller(e), 2e-4, 0.0));
        rows.push((RackDeviationKind::Pitch(e), 1e-3, 0.02));
    }
    for degrees in [0.25, 0.5, -0.25, -0.5_f64] {
        rows.push((RackDeviationKind::Lead(degrees.to_radians()), 1e-3, 0.02));
    }
    rows
}

/// As `reproduce` runs them: in time, the rack free to roll.
#[test]
fn all_rows_of_the_paper_are_near_the_exact_mesh() {
    use rackmesh::reproduction::{PRINTED, PaperTable, simulate_all};
    for (printed, row) in PRINTED.iter().zip(simulate_all(&|_| {})) {
        let row = row.unwrap();
        assert_eq!(row.outcome.end, RunEnd::Completed);
        let exact = row.exact_mm.unwrap();
        let found = row.outcome.rigid_difference_mm().unwrap();
        let energy = row.outcome.energy.unwrap();
        assert!(energy.drift_share().unwrap() < 0.01, "{printed:?}: {energy:?}");
        let allowed = if printed.table == PaperTable::OverRoller { 2e-4 } else { f64::max(1e-3, 0.02 * exact) };
        println!("{printed:?}: {:.4} µm of {:.3} µm", 1e3 * (found - exact), 1e3 * exact);
        assert!((found - exact).abs() <= allowed, "{printed:?}: {found} {exact}");
        let ripple = row.outcome.nominal.unwrap().ripple_mm;
        assert!(ripple < 5e-5, "{printed:?}: ripple {ripple}");
    }
}

#[test]
fn quasi_static_differences_are_those_of_the_exact_mesh() {
    for parameters in [Parameters::default(), analytic()] {
        for (kind, length, share) in rows() {
            let scene = paper::scene(Some(kind), parameters);
            let outcome = scene.quasi_static(&mut go_on);
            assert_eq!(outcome.end, RunEnd::Completed);
            let (rigid, _) = paper::rigid_difference(&scene, &outcome);
            let found = outcome.rigid_difference_mm().unwrap();
            let allowed = f64::max(length, share * rigid.abs());
            assert!((found - rigid).abs() <= allowed, "{kind:?}: {found} {rigid}");
        }
    }
}

#[test]
fn a_run_that_is_told_to_stop_keeps_what_it_has() {
    let scene = paper::scene(None, Parameters { stroke_mm: 1.0, ..Parameters::default() });
    let mut seen = 0;
    let outcome = scene.quasi_static(&mut |_| {
        seen += 1;
        if seen == 4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(outcome.end, RunEnd::Interrupted);
    assert_eq!(outcome.samples.len(), 4);
    let whole = scene.quasi_static(&mut go_on);
    assert_eq!(whole.samples.len(), 11);
    assert_eq!(outcome.samples[..], whole.samples[..4]);
}

fn same(a: &Outcome, b: &Outcome) {
    assert_eq!(a.end, b.end);
    assert_eq!(a.samples.len(), b.samples.len());
    for (a, b) in a.samples.iter().zip(&b.samples) {
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }
}

#[test]
fn culling_changes_no_bit_and_saves_most_of_the_work() {
    let short = Parameters { start_mm: 18.0, stroke_mm: 14.0, spacing_mm: 1.0, ..Parameters::default() };
    let roll = Support::FreeRoll { axis_depth_mm: 8.0 };
    let grid = SphereGrid { profile_nodes: 24, width_nodes: 32, ..SphereGrid::default() };
    for contact in [ContactModel::Spheres(grid), ContactModel::Analytic(StripGrid { strips: 64 })] {
        for support in [Support::Fixed, roll] {
            for kind in [
                RackDeviationKind::OverRoller(-0.05),
                RackDeviationKind::Pitch(0.03),
                RackDeviationKind::Lead(0.005),
                RackDeviationKind::Thickness(-0.1),
            ] {
                let parameters = Parameters { contact, support, ..short };
                let culled = paper::scene(Some(kind), parameters).quasi_static(&mut go_on);
                let whole = paper::scene(Some(kind), Parameters { cull: false, ..parameters }).quasi_static(&mut go_on);
                same(&culled, &whole);
                assert!(5 * culled.counters.spheres_tested < whole.counters.spheres_tested, "{:?}", culled.counters);
            }
        }
    }
    // any pair: every hand, helix, shaft angle and start of the involute, with deviations of every kind
    let mut random = Random(7);
    for case in 0..24 {
        let pair = random::pair(&mut random);
        let (rack, pinion) = (random::rack(&mut random, &pair, true), random::pinion(&mut random, &pair, true));
        let contact = if case % 3 == 0 {
            ContactModel::Analytic(StripGrid { strips: 48 })
        } else {
            ContactModel::Spheres(SphereGrid { profile_nodes: 24, width_nodes: 24, ..SphereGrid::default() })
        };
        let stroke_mm = 2.0 * pair.rack().pitch_mm;
        let parameters = Parameters { contact, stroke_mm, spacing_mm: 0.07 * stroke_mm, ..Parameters::default() };
        let run = |cull| {
            Scene::new(pair, rack.clone(), pinion.clone(), Parameters { cull, ..parameters })
                .unwrap()
                .quasi_static(&mut go_on)
        };
        same(&run(true), &run(false));
    }
}

#[test]
fn tangents_agree_with_finite_differences() {
    let mut random = Random(11);
    let mut touched = 0;
    for case in 0..60 {
        let pair = random::pair(&mut random);
        let mut rack = random::rack(&mut random, &pair, true);
        let pinion = random::pinion(&mut random, &pair, true);
        let analytic = case % 2 == 0;
        if !analytic && case % 3 == 0 {
            let crowned = RackForm { crowning_mm: 0.01, ..RackForm::default() };
            rack = rack.with_form(&pair, crowned).unwrap();
        }
        let contact = if analytic {
            ContactModel::Analytic(StripGrid { strips: 40 })
        } else {
            ContactModel::Spheres(SphereGrid { profile_nodes: 40, width_nodes: 40, ..SphereGrid::default() })
        };
        let support = if case % 4 < 2 { Support::FreeRoll { axis_depth_mm: 8.0 } } else { Support::Fixed };
        let parameters = Parameters {
            contact,
            support,
            stiffness_exponent: 2.5,
            indentation_exponent: 2.5,
            damping: 1e5,
            friction: if case % 5 == 0 { 0.1 } else { 0.0 },
            friction_speed_mm_per_s: 5.0,
            ..Parameters::default()
        };
        let stroke = random.range(-2.0, 2.0) * pair.rack().pitch_mm;
        let Ok(rigid) = rackmesh::mesh::Mesh::new(pair, rack.clone(), pinion.clone(), rackmesh::mesh::Support::Fixed)
            .unwrap()
            .at(stroke)
        else {
            continue;
        };
        let scene =
            Scene::new(pair, rack, pinion, Parameters { start_mm: stroke, stroke_mm: 1.0, ..parameters }).unwrap();
        let rolls = scene.rolls();
        let at = Coordinates {
            pinion_angle: rigid.pinion_angle_rad + random.range(-1e-3, 1e-3),
            center_distance: rigid.center_distance_mm - 0.02,
            roll: if rolls { random.range(-1e-3, 1e-3) } else { 0.0 },
            stroke,
        };
        let rates =
            Coordinates { pinion_angle: 0.3, center_distance: -2.0, roll: if rolls { 0.1 } else { 0.0 }, stroke: 20.0 };
        let here = scene.forces(&at, &rates);
        assert!(here.contacts > 0);
        touched += here.contacts;
        let unknowns = if rolls { 3 } else { 2 };
        let scale = [pair.pinion().reference_radius_mm, 1.0, 10.0];
        let size = (0..unknowns).map(|i| here.stiffness[i][i].abs() / scale[i] / scale[i]).fold(0.0, f64::max);
        let rate_size = (0..unknowns).map(|i| here.damping[i][i].abs() / scale[i] / scale[i]).fold(0.0, f64::max);
        for j in 0..unknowns {
            let moved = |at: &Coordinates, by: f64| {
                let mut moved = *at;
                match j {
                    0 => moved.pinion_angle += by,
                    1 => moved.center_distance += by,
                    _ => moved.roll += by,
                }
                moved
            };
            let h = 1e-7 / scale[j];
            let (up, down) = (scene.forces(&moved(&at, h), &rates), scene.forces(&moved(&at, -h), &rates));
            let v = 1e-4 / scale[j];
            let (fast, slow) = (scene.forces(&at, &moved(&rates, v)), scene.forces(&at, &moved(&rates, -v)));
            for i in 0..unknowns {
                let by_place = -(up.generalized[i] - down.generalized[i]) / (2.0 * h);
                let by_rate = -(fast.generalized[i] - slow.generalized[i]) / (2.0 * v);
                let error = (here.stiffness[i][j] - by_place).abs() / scale[i] / scale[j] / size;
                // documented: form and the turning of the direction of sliding are left out of the tangent
                let allowed = if parameters.friction > 0.0 { 0.05 } else { 2e-4 };
                assert!(error < allowed, "case {case} stiffness {i}{j}: {} {by_place}", here.stiffness[i][j]);
                let error = (here.damping[i][j] - by_rate).abs() / scale[i] / scale[j] / rate_size;
                let allowed = if parameters.friction > 0.0 { 1e-3 } else { 1e-5 };
                assert!(error < allowed, "case {case} damping {i}{j}: {} {by_rate}", here.damping[i][j]);
            }
        }
    }
    assert!(touched > 1000);
}

/// The elastic contact forces at a sample.
fn forces_at(scene: &Scene, sample: &Sample) -> Forces {
    let at = Coordinates {
        pinion_angle: sample.pinion_angle_rad,
        center_distance: sample.center_distance_mm,
        roll: sample.roll_rad,
        stroke: sample.stroke_mm,
    };
    scene.forces(&at, &Coordinates::default())
}

/// Largest difference of ΔCD between two runs over the same strokes, after the start.
fn apart(a: &Outcome, b: &Outcome, from_mm: f64) -> f64 {
    assert_eq!(a.samples.len(), b.samples.len());
    let pairs = a.samples.iter().zip(&b.samples).filter(|(a, _)| a.stroke_mm >= from_mm);
    pairs.map(|(a, b)| (a.delta_cd_mm - b.delta_cd_mm).abs()).fold(0.0, f64::max)
}

#[test]
fn a_slow_motion_follows_the_equilibria_without_ripple() {
    for parameters in [Parameters::default(), analytic()] {
        let scene = paper::scene(Some(RackDeviationKind::OverRoller(0.02)), parameters);
        let (moving, still) = (scene.dynamic(&mut go_on), scene.quasi_static(&mut go_on));
        assert_eq!(moving.end, RunEnd::Completed);
        // while a tooth comes in the damping holds the parts back
        assert!(apart(&moving, &still, 0.0) < 1e-4);
        for part in [moving.nominal.unwrap(), moving.deviating.unwrap()] {
            let steady = |outcome: &Outcome| Outcome {
                samples: outcome
                    .samples
                    .iter()
                    .copied()
                    .filter(|s| (part.from_mm..part.to_mm).contains(&s.stroke_mm))
                    .collect(),
                ..outcome.clone()
            };
            assert!(apart(&steady(&moving), &steady(&still), 0.0) < 1e-6);
        }
        for part in [moving.nominal.unwrap(), moving.deviating.unwrap()] {
            assert!(part.ripple_mm < 5e-5, "{part:?}");
        }
        assert!((moving.rigid_difference_mm().unwrap() - 0.02).abs() < 2e-4);
        // at rest the contact carries the preload, half on each side, along both normals
        let rest = &moving.samples[0];
        let forces = forces_at(&scene, rest);
        assert!((forces.generalized[1] - 500.0).abs() < 1e-3 && forces.generalized[0].abs() < 1e-2, "{forces:?}");
        let side = 250.0 / 19.9_f64.to_radians().sin();
        for force in [rest.normal_force_right_n, rest.normal_force_left_n] {
            // a few parts in a thousand stand on edges, whose normals differ
            assert!((force - side).abs() < 5e-3 * side, "{force} {side}");
        }
        let energy = moving.energy.unwrap();
        assert!((energy.impulse - energy.momentum).abs() < 1e-6 * 500.0 * 2.5, "{energy:?}");
        assert!(energy.dissipated > 0.0);
        // the ramp takes its travel at half the speed
        assert!((moving.samples.last().unwrap().time_s - (49.0 / 20.0 + 0.1)).abs() < 1e-9);
    }
}

const ROLL: Support = Support::FreeRoll { axis_depth_mm: 8.0 };

#[test]
fn errors_fall_as_theory_says() {
    for convergence in convergence::all() {
        let order = convergence.order();
        println!("{}: {order:.2} {:?}", convergence.what, convergence.errors);
        // where contacts switch, single errors jump about the line; strips do better than they must
        assert!(order > 0.8 * convergence.expected, "{}: {order} {:?}", convergence.what, convergence.errors);
        assert!(order < 1.6 * convergence.expected, "{}: {order} {:?}", convergence.what, convergence.errors);
    }
}

#[test]
fn a_yoke_carries_what_the_mesh_pushes() {
    let yoke = Yoke { preload_n: 500.0, rate_n_per_mm: 200.0, clearance_mm: 0.01, ..Yoke::default() };
    let parameters = Parameters { support: Support::Yoke(yoke), stroke_mm: 40.0, ..Parameters::default() };
    let scene = paper::scene(Some(RackDeviationKind::OverRoller(0.02)), parameters);
    for outcome in [scene.quasi_static(&mut go_on), scene.dynamic(&mut go_on)] {
        assert_eq!(outcome.end, RunEnd::Completed);
        for sample in &outcome.samples {
            let held = sample.yoke.unwrap();
            assert_eq!(held.travel_mm, sample.delta_cd_mm);
            let up = forces_at(&scene, sample).generalized[1];
            // in motion inertia and damping carry a share while a tooth comes in
            let allowed = if outcome.counters.steps > 0 { 2e-2 } else { 1e-5 };
            assert!((up - held.force_n - held.bush_force_n).abs() < allowed * up, "{up} {sample:?}");
            let stop = (held.travel_mm - 0.01).max(0.0) * yoke.stop_n_per_mm;
            assert!((held.force_n - (500.0 + 200.0 * held.travel_mm + stop)).abs() < 1e-9);
        }
        // behind the odd teeth the yoke is on its stop
        assert!(outcome.samples.last().unwrap().yoke.unwrap().force_n > 1000.0);
        assert!((outcome.rigid_difference_mm().unwrap() - 0.02).abs() < 2e-4);
    }
}

#[test]
fn a_yoke_has_its_limits_in_springs_that_are_soft_or_stiff() {
    let run = |support: Support| {
        let parameters =
            Parameters { support, start_mm: 14.0, stroke_mm: 18.0, spacing_mm: 0.5, ..Parameters::default() };
        let outcome = paper::scene(Some(RackDeviationKind::OverRoller(0.02)), parameters).quasi_static(&mut go_on);
        assert_eq!(outcome.end, RunEnd::Completed);
        outcome
    };
    // springs without rate and a stop out of reach are the preload on the slider
    let soft = Yoke { rate_n_per_mm: 0.0, bush_n_per_mm: 0.0, clearance_mm: 100.0, ..Yoke::default() };
    assert!(apart(&run(Support::Yoke(soft)), &run(Support::Fixed), 0.0) < 1e-9);
    // a stiff spring of whatever name holds the rack: the teeth give way instead
    let mut last = f64::INFINITY;
    for stiffness in [1e2, 1e4, 1e6, 1e8] {
        let bush = run(Support::Yoke(Yoke { bush_n_per_mm: stiffness, ..soft }));
        let rate = run(Support::Yoke(Yoke { rate_n_per_mm: stiffness, ..soft }));
        // until the spring of the yoke is relaxed both are the same
        assert!(apart(&bush, &rate, 0.0) < 1e-9, "{stiffness}");
        let most = bush.samples.iter().map(|sample| sample.delta_cd_mm).fold(0.0, f64::max);
        assert!(most < last, "{stiffness}: {most} {last}");
        last = most;
    }
    assert!(last < 0.4 * 0.02, "{last}");
    // without clearance the stop is such a spring for outward travel
    let stopped = run(Support::Yoke(Yoke { clearance_mm: 0.0, stop_n_per_mm: 1e8, ..soft }));
    assert!(stopped.samples.iter().all(|sample| sample.delta_cd_mm < 0.4 * 0.02));
}

#[test]
fn a_rack_that_may_roll_rolls_as_in_the_exact_mesh() {
    use rackmesh::mesh;
    let parameters = Parameters {
        support: Support::FreeRoll { axis_depth_mm: 8.0 },
        start_mm: 30.0,
        stroke_mm: 6.0,
        spacing_mm: 1.0,
        ..analytic()
    };
    let scene = paper::scene(Some(RackDeviationKind::Lead(0.25_f64.to_radians())), parameters);
    assert!(scene.rolls());
    assert_eq!(scene.mesh().support(), mesh::Support::FreeRoll { axis_depth_mm: 8.0 });
    let exact = scene.mesh();
    let outcome = scene.quasi_static(&mut go_on);
    assert_eq!(outcome.end, RunEnd::Completed);
    let mean =
        outcome.samples.iter().map(|s| s.delta_cd_mm + s.indentation_mm).sum::<f64>() / outcome.samples.len() as f64;
    let strokes: Vec<f64> = outcome.samples.iter().map(|s| s.stroke_mm).collect();
    let rigid: Vec<f64> = exact.sample(&strokes).into_iter().map(|p| p.unwrap().delta_cd_mm).collect();
    let rigid = rigid.iter().sum::<f64>() / rigid.len() as f64;
    assert!((mean - rigid).abs() < 0.02 * rigid, "{mean} {rigid}");
}

/// No part of the rack has teeth that deviate only; the largest ΔCD shows all the same, at the stroke of the exact mesh's and
/// with its tooth.
#[test]
fn one_odd_tooth_shows_in_the_extremes() {
    let pair = paper::pair();
    for tooth in [3, 5] {
        let odd = RackDeviation { teeth: tooth.to_string().parse().unwrap(), kind: RackDeviationKind::Thickness(0.02) };
        let rack = RackFlanks::new(&pair, &[odd]).unwrap();
        let scene = Scene::new(pair, rack, PinionFlanks::nominal(&pair), Parameters::default()).unwrap();
        let outcome = scene.quasi_static(&mut go_on);
        assert_eq!((outcome.end, outcome.deviating), (RunEnd::Completed, None));
        let [low, high] = outcome.extremes().unwrap();
        assert!(high.delta_cd_mm > 0.012 && low.delta_cd_mm < 0.0, "{low:?} {high:?}");
        let exact = scene.mesh().curve(0.0, 50.0, 1e-4).unwrap().summary(scene.mesh()).unwrap();
        assert!((high.delta_cd_mm + high.indentation_mm - exact.max_mm).abs() < 3e-3, "{high:?} {exact:?}");
        assert!(high.carrying.contains(&Some(tooth)), "{tooth}: {high:?}");
    }
}

/// Without friction the drive carries the difference of both sides, and the means of its force and of the torque are its work.
#[test]
fn the_drive_carries_the_difference_of_both_sides() {
    let cos = 19.9_f64.to_radians().cos();
    let scene = paper::scene(Some(RackDeviationKind::OverRoller(0.02)), Parameters::default());
    for outcome in [scene.quasi_static(&mut go_on), scene.dynamic(&mut go_on)] {
        let part = outcome.nominal.unwrap();
        let lines = outcome.samples.iter().filter(|sample| (part.from_mm..part.to_mm).contains(&sample.stroke_mm));
        for sample in lines {
            let apart = (sample.normal_force_left_n - sample.normal_force_right_n) * cos;
            // a few parts in a thousand stand on edges, whose normals differ
            assert!((sample.rack_force_n - apart).abs() < 5e-3 * sample.normal_force_left_n, "{sample:?}");
        }
        let forces = outcome.forces().unwrap();
        let last = outcome.samples.last().unwrap();
        let from = outcome.samples.iter().find(|sample| sample.stroke_mm == forces.from_mm).unwrap();
        let work = last.driven_n_mm - from.driven_n_mm;
        assert!((forces.rack_n.mean * (last.stroke_mm - forces.from_mm) - work).abs() < 1e-9, "{forces:?}");
        let radius = 1.0 / scene.mesh().pair().rotation_per_stroke_rad();
        let torque = 1e-3 * forces.rack_n.mean * radius;
        assert!((forces.pinion_torque_n_m.mean - torque).abs() < 0.01 * torque.abs(), "{forces:?} {torque}");
        assert!(forces.rack_n.smallest < forces.rack_n.mean && forces.rack_n.mean < forces.rack_n.largest);
    }
}

/// Errors without teeth are put where `mesh` puts them, and are judged as it judges them.
#[test]
fn errors_are_placed_and_judged_as_mesh_does() {
    let run = |command: &str, spec: &str, limit: &str| {
        let mut rackmesh = std::process::Command::new(env!("CARGO_BIN_EXE_rackmesh"));
        let rackmesh =
            rackmesh.current_dir(env!("CARGO_MANIFEST_DIR")).args([command, spec, "-f", "json", "--set", limit]);
        let output = rackmesh.args((command == "simulate").then_some("--quasi-static")).output().unwrap();
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (output.status.code(), json)
    };
    let mut placed = 0;
    for spec in ["examples/steering.toml", "examples/mesh-errors.toml", "examples/mesh.toml"] {
        for (upper, status) in [("0.001", 1), ("1", 0)] {
            let limit = format!("limits.center_distance={{ lower = -1, upper = {upper} }}");
            let [(mesh, by_mesh), (simulate, simulated)] =
                ["mesh", "simulate"].map(|command| run(command, spec, &limit));
            assert_eq!((mesh, simulate), (Some(status), Some(status)), "{spec}");
            for key in ["verdict", "judged_mm", "judged_by", "reason"] {
                assert_eq!(by_mesh[key], simulated[key], "{spec}: {key}");
            }
            let place = |json: &serde_json::Value| {
                let notes = json["notes"].as_array().unwrap();
                notes
                    .iter()
                    .find(|note| note.as_str().unwrap().contains("the teeth on which a search finds the"))
                    .cloned()
            };
            assert_eq!(place(&by_mesh), place(&simulated), "{spec}");
            placed += u32::from(place(&simulated).is_some());
        }
    }
    assert!(placed > 0);
}
