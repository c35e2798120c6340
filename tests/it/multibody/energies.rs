//! Work, energy and what is lost: all of it adds up.

use super::*;

/// Over the strokes in which the first odd teeth come in. Nothing is lost but what the steps damp, and that is never
/// gained: the drift is not negative, and where nothing rings it is small.
#[test]
fn without_losses_the_drift_is_what_the_steps_damp() {
    let strips = ContactModel::Analytic(StripGrid { strips: 48 });
    for (support, contact, kind) in [
        (Support::Fixed, ContactModel::default(), RackDeviationKind::OverRoller(0.02)),
        (Support::Fixed, strips, RackDeviationKind::Lead(0.004)),
        (ROLL, ContactModel::default(), RackDeviationKind::Lead(0.004)),
    ] {
        let parameters =
            Parameters { damping: 0.0, support, contact, start_mm: 16.0, stroke_mm: 4.0, ..Parameters::default() };
        let outcome = paper::scene(Some(kind), parameters).dynamic(&mut go_on);
        assert_eq!(outcome.end, RunEnd::Completed);
        let energy = outcome.energy.unwrap();
        assert_eq!((energy.dissipated, energy.settling), (0.0, 0.0));
        println!("{kind:?} {contact:?} {support:?}: {energy:?} {:?} {:?}", energy.drift_share(), outcome.counters);
        let impulse = 500.0 * outcome.samples.last().unwrap().time_s;
        assert!((energy.impulse - energy.momentum).abs() < 1e-6 * impulse, "{energy:?}");
        assert!(energy.drift > -1e-6 * energy.exchanged && energy.drift < 1e-3 * energy.exchanged, "{energy:?}");
    }
}

/// Along the equilibria their work is what the energy falls by, whatever touches and leaves on the way: face, edge or
/// corner.
#[test]
fn forces_are_the_gradient_of_the_energy() {
    let roll = Support::FreeRoll { axis_depth_mm: 8.0 };
    let short = Parameters { start_mm: 36.0, stroke_mm: 1.6, ..Parameters::default() };
    let strips = ContactModel::Analytic(StripGrid { strips: 48 });
    for (support, contact) in [(Support::Fixed, short.contact), (roll, short.contact), (roll, strips)] {
        let kind = RackDeviationKind::Lead(0.25_f64.to_radians());
        let scene = paper::scene(Some(kind), Parameters { support, contact, ..short });
        let outcome = scene.quasi_static(&mut go_on);
        let (mut gained, mut exchanged) = (0.0, 0.0);
        for two in outcome.samples.windows(2) {
            let at = |s: &Sample| [s.pinion_angle_rad, s.center_distance_mm, s.roll_rad, s.stroke_mm];
            let (from, to) = (at(&two[0]), at(&two[1]));
            let way: [f64; 4] = std::array::from_fn(|i| to[i] - from[i]);
            let forces = |share: f64| {
                let [pinion_angle, center_distance, roll, stroke] = std::array::from_fn(|i| from[i] + share * way[i]);
                let at = Coordinates { pinion_angle, center_distance, roll, stroke };
                scene.forces(&at, &Coordinates::default())
            };
            let work = |f: &Forces| (0..4).map(|i| f.generalized[i] * way[i]).sum::<f64>();
            let (first, last) = (forces(0.0), forces(1.0));
            const PARTS: u32 = 1600;
            let inner: f64 = (1..PARTS).map(|k| work(&forces(f64::from(k) / f64::from(PARTS)))).sum();
            gained += last.energy - first.energy + (inner + 0.5 * (work(&first) + work(&last))) / f64::from(PARTS);
            exchanged += first.along * way[3];
        }
        println!("{gained:e} N mm of {exchanged} N mm");
        assert!(gained.abs() < 5e-6 * exchanged, "{gained:e} of {exchanged}");
    }
}

/// The terms add up, and the drift is below a hundredth of the largest of them.
fn balanced(outcome: &Outcome) -> rackmesh::multibody::Energy {
    let energy = outcome.energy.unwrap();
    let terms = energy.stored + energy.dissipated + energy.settling + energy.drift;
    assert!((energy.driven - terms).abs() < 1e-12 * energy.exchanged, "{energy:?}");
    assert!(energy.drift_share().unwrap() < 0.01, "{energy:?}");
    energy
}

/// Without losses the drive puts in what is stored; at rest nothing settles.
#[test]
fn equilibria_without_friction_store_what_is_driven() {
    for contact in [ContactModel::default(), ContactModel::Analytic(StripGrid::default())] {
        let scene =
            paper::scene(Some(RackDeviationKind::OverRoller(0.02)), Parameters { contact, ..Parameters::default() });
        let energy = balanced(&scene.quasi_static(&mut go_on));
        assert_eq!((energy.dissipated, energy.settling), (0.0, 0.0));
        assert!((energy.driven - energy.stored).abs() < 1e-12 * energy.exchanged, "{energy:?}");
    }
}

/// What the first steps lose is booked as settling, not as dissipated, and is no more than a rack that comes up to speed
/// can lose: nothing is driven in there.
#[test]
fn the_run_up_is_booked_as_settling() {
    let run_up = Parameters { support: ROLL, stroke_mm: 1.0, ..Parameters::default() };
    let kind = RackDeviationKind::OverRoller(0.02);
    let start = paper::scene(Some(kind), run_up).dynamic(&mut go_on).energy.unwrap();
    assert_eq!(start.dissipated, 0.0);
    assert!(start.settling > 0.0 && start.settling < 0.02, "{start:?}");
    let whole = balanced(&paper::scene(Some(kind), Parameters { stroke_mm: 50.0, ..run_up }).dynamic(&mut go_on));
    assert!(whole.settling > 0.0 && whole.settling < 0.02, "{start:?} {whole:?}");
    assert!(whole.dissipated > 0.3 && whole.dissipated < 1.0, "{whole:?}");
}

/// The work of the drive agrees with its force, integrated along a stroke in short steps.
#[test]
fn driven_is_the_work_of_the_force_on_the_rack() {
    let parameters =
        Parameters { start_mm: 16.0, stroke_mm: 2.0, ramp_mm: 0.01, spacing_mm: 5e-4, ..Parameters::default() };
    let scene = paper::scene(Some(RackDeviationKind::OverRoller(0.02)), parameters);
    let outcome = scene.quasi_static(&mut go_on);
    let forces: Vec<_> = outcome.samples.iter().map(|sample| forces_at(&scene, sample).generalized[3]).collect();
    let steps = outcome.samples.windows(2).zip(forces.windows(2));
    let work: f64 = steps.map(|(at, f)| -0.5 * (f[0] + f[1]) * (at[1].stroke_mm - at[0].stroke_mm)).sum();
    let driven = outcome.energy.unwrap().driven;
    assert!((driven - work).abs() < 0.01 * driven.abs(), "{driven} {work}");
}

/// Half the step, and the drift falls at least as the square: a heavy spur pinion that swings on teeth that stay in touch.
#[test]
fn drift_falls_with_the_square_of_the_step() {
    let drifts = convergence::drifts([1.0, 0.5, 0.25]);
    for two in drifts.windows(2) {
        assert!((two[0] / two[1]).log2() > 1.8, "{drifts:?}");
    }
}

/// Every example that can be simulated, in time and as equilibria: what is printed adds up to a hundredth.
#[test]
fn the_energy_of_every_example_adds_up() {
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let mut balanced = 0;
    for file in std::fs::read_dir(examples).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "toml") {
            continue;
        }
        for how in [&[][..], &["--quasi-static"][..]] {
            let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_rackmesh"));
            let output = command.arg("simulate").arg(&path).args(how).args(["--format", "json"]).output().unwrap();
            // a spec without a pair has nothing to simulate
            let Ok(found) = serde_json::from_slice::<serde_json::Value>(&output.stdout) else { continue };
            let energy = |name: &str| found["energy_n_mm"][name].as_f64().unwrap();
            let left =
                ["stored", "dissipated", "settling", "drift"].iter().fold(energy("driven"), |e, name| e - energy(name));
            assert!(left.abs() < 1e-12 * energy("exchanged"), "{}: {found}", path.display());
            assert!(energy("drift_share") < 0.01, "{}: {}", path.display(), found["energy_n_mm"]);
            balanced += 1;
        }
    }
    assert!(balanced >= 12, "{balanced}");
}
