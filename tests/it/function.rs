//! What a yoke does, held against relations that follow from its definition: work, mirror images, shifts and windows.

use crate::process::run;
use rackmesh::deviation::{PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks, ToothRange};
use rackmesh::function::{Bounds, Function, Judged, SetAt, Target, Terms, Window, Yoke, judge};
use rackmesh::gear::Pair;
use rackmesh::judge::Verdict;
use rackmesh::mesh::{Curve, Mesh, MeshPoint, Sampler, Support};
use rackmesh::trig;

use crate::common::random::{self, Random};

const YOKE: Yoke = Yoke {
    preload_n: Some(500.0),
    rate_n_per_mm: Some(100.0),
    set_at: SetAt::Stroke(3.0),
    play_mm: Some(0.06),
    thread_pitch_mm: None,
    yoke_friction: Some(0.1),
    tooth_friction: Some(0.08),
    bearing_torque_n_m: Some(0.1),
};

const BY_VALUE: Terms = Terms { knows_travel: true, is_measured: true, is_by_value: true };

/// Random meshes over a stroke of some pitches, with their curves.
fn meshes(seed: u64, count: usize) -> Vec<(Mesh, Curve)> {
    let mut random = Random(seed);
    let mut found = Vec::new();
    while found.len() < count {
        let pair = random::pair(&mut random);
        let (rack, pinion) = (random::rack(&mut random, &pair, true), random::pinion(&mut random, &pair, true));
        let Ok(mesh) = Mesh::new(pair, rack, pinion, Support::Fixed) else { continue };
        let Ok(curve) = mesh.curve(-2.0, 5.0 * pair.rack().pitch_mm, 1e-6) else { continue };
        if curve.resolved {
            found.push((mesh, curve));
        }
    }
    found
}

fn function(mesh: &Mesh, curve: &Curve, yoke: &Yoke, window: Option<&Window>) -> Function {
    Function::of(mesh, curve, yoke, window).expect("a mesh").expect("points")
}

/// What lifting the yoke takes is the work on its spring; both directions together take the friction twice; without friction
/// they are mirror images; and a torque is F dΔCD/dθ of the curve itself.
#[test]
fn torque_is_the_work_of_the_yoke_and_of_friction() {
    let mut compared = 0;
    for (mesh, curve) in meshes(50, 8) {
        let at = |yoke: &Yoke| function(&mesh, &curve, yoke, None);
        let with = at(&YOKE);
        let forces = with.forces.expect("forces");
        let (first, last) = (&curve.points[0], &curve.points[curve.points.len() - 1]);
        let turned = last.pinion_angle_rad - first.pinion_angle_rad;
        let energy = |mm: f64| 500.0 * (mm - with.at_mm()) + 50.0 * (mm - with.at_mm()) * (mm - with.at_mm());
        let work = (energy(last.delta_cd_mm) - energy(first.delta_cd_mm)) / 1000.0 / turned;
        assert!((forces.lifting_n_m.mean - work).abs() < 1e-12, "{} {work}", forces.lifting_n_m.mean);
        let resting = forces.yoke_friction_n_m.mean + forces.tooth_friction_n_m.mean + 0.1;
        let both = forces.rising.extent.mean + forces.falling.extent.mean;
        assert!((both - 2.0 * resting).abs() < 1e-12, "{both} {resting}");
        assert!((forces.rising.extent.mean - forces.falling.extent.mean - 2.0 * work).abs() < 1e-12);
        let smooth = Yoke { yoke_friction: None, tooth_friction: None, bearing_torque_n_m: None, ..YOKE };
        let forces = at(&smooth).forces.expect("forces");
        let (rising, falling) = (forces.rising.extent, forces.falling.extent);
        assert!((rising.largest + falling.smallest).abs() < 1e-12 && (rising.smallest + falling.largest).abs() < 1e-12);
        assert_eq!(rising.largest_stroke_mm, falling.smallest_stroke_mm);
        // between neighbours with the same carriers the mean of both ends is the work per angle, but for their bend
        let plain = at(&smooth);
        for (points, here) in curve.points.windows(2).zip(plain.along.windows(2)) {
            let [a, b] = points else { unreachable!() };
            let angle = b.pinion_angle_rad - a.pinion_angle_rad;
            if (a.right, a.left) == (b.right, b.left) && angle > 1e-5 {
                let [at_a, at_b] = [here[0].forces.expect("forces"), here[1].forces.expect("forces")];
                let [low, high] = [at_a.rising_n_m.min(at_b.rising_n_m), at_a.rising_n_m.max(at_b.rising_n_m)];
                let work = 0.5 * (at_a.yoke_n + at_b.yoke_n) * (b.delta_cd_mm - a.delta_cd_mm) / angle / 1000.0;
                let slack = 1e-6 + 0.02 * (high - low) + 1e-12 / angle;
                assert!(low - slack <= work && work <= high + slack, "{work} {low} {high} {a:?} {b:?}");
                compared += 1;
            }
        }
    }
    assert!(compared > 3000, "{compared}");
}

/// A window is kept where the variation fits it, by 0.2 µm either way; another stroke to set at moves the settings by what
/// ΔCD differs there; the tightest one leaves the lower end as it is.
#[test]
fn a_setting_is_there_where_the_variation_fits_the_window() {
    for (mesh, curve) in meshes(51, 12) {
        let variation = function(&mesh, &curve, &YOKE, None).variation_mm();
        let extremes = curve.summary(&mesh).expect("points");
        assert!((variation - extremes.peak_to_peak_mm).abs() < 2e-11);
        for (spare, fits) in [(2e-4, true), (-2e-4, false)] {
            let window = Window { lower_mm: 0.01, upper_mm: Some(0.01 + variation + spare) };
            let limits = [(Target::YokePlay, Bounds { lower: Some(0.01), upper: window.upper_mm })];
            let free = Yoke { play_mm: None, ..YOKE };
            let found = function(&mesh, &curve, &free, Some(&window));
            assert_eq!(found.setting.is_some(), fits, "{variation} {spare}");
            let checks = judge(&found, &free, &limits, BY_VALUE);
            assert_eq!(checks[0].verdict, Some(if fits { Verdict::Pass } else { Verdict::Fail }));
            let Some(setting) = found.setting else {
                assert_eq!(checks[0].judged, Judged::NoSetting);
                continue;
            };
            let plays = found.plays_mm().expect("the middle");
            assert!((plays.0 - 0.0101).abs() < 1e-9 && (plays.1 - (0.0101 + variation)).abs() < 1e-9, "{plays:?}");
            let tightest = function(&mesh, &curve, &Yoke { set_at: SetAt::Tightest, ..free }, Some(&window));
            let at_tightest = tightest.setting.expect("a setting");
            assert!((at_tightest.from_mm - 0.01).abs() < 1e-12);
            let moved = tightest.at_mm() - found.at_mm();
            assert!((setting.from_mm - at_tightest.from_mm - moved).abs() < 2e-12);
            // a play beyond the settings leaves the window
            for (play, verdict) in [(setting.from_mm, Verdict::Pass), (setting.from_mm - 1e-6, Verdict::Fail)] {
                let set = Yoke { play_mm: Some(play), ..YOKE };
                let checks = judge(&function(&mesh, &curve, &set, Some(&window)), &set, &limits, BY_VALUE);
                assert_eq!(checks[0].verdict, Some(verdict), "{play} {setting:?}");
            }
        }
    }
}

/// Of a pair whose error-free curve is flat a size on all teeth moves the rack and nothing else.
#[test]
fn a_size_on_all_teeth_drops_out_of_the_variation() {
    let mut random = Random(52);
    for size in [0.01, -0.02, 0.03] {
        let pair = random::pair(&mut random);
        let flat = |list: &[RackDeviation]| -> Mesh {
            let rack = RackFlanks::new(&pair, list).expect("small");
            Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::Fixed).expect("teeth in order")
        };
        let of = |mesh: &Mesh| {
            let curve = mesh.curve(0.0, 30.0, 1e-6).expect("a curve");
            function(mesh, &curve, &YOKE, None)
        };
        let nominal = of(&flat(&[]));
        let sized = of(&flat(&[RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::OverRoller(size) }]));
        if nominal.variation_mm() < 1e-12 {
            assert!(sized.variation_mm() < 1e-12 && (sized.at_mm() - nominal.at_mm() - size).abs() < 1e-12);
            let lifting = sized.forces.expect("forces").lifting_n_m;
            assert!(lifting.largest.abs() < 1e-12 && lifting.smallest.abs() < 1e-12, "{lifting:?}");
        }
    }
    let pair: Pair = rackmesh::reproduction::pair().expect("the paper's pair");
    let mesh = Mesh::nominal(pair).expect("teeth in order");
    let curve = mesh.curve(0.0, 30.0, 1e-6).expect("a curve");
    assert!(function(&mesh, &curve, &YOKE, None).variation_mm() < 1e-12);
}

/// What is not known is asked for, and a rule that needs an uncertainty has none.
#[test]
fn a_limit_is_open_without_what_it_needs() {
    let mesh = Mesh::nominal(rackmesh::reproduction::pair().expect("the paper's pair")).expect("teeth in order");
    let curve = mesh.curve(0.0, 10.0, 1e-6).expect("a curve");
    let limits = Target::ALL.map(|on| (on, Bounds { lower: Some(0.0), upper: Some(1e4) }));
    let judged = |yoke: &Yoke, terms| judge(&function(&mesh, &curve, yoke, None), yoke, &limits, terms);
    let open = |yoke: &Yoke, on: usize| match judged(yoke, BY_VALUE)[on].judged.clone() {
        Judged::Lacks(keys) => keys,
        _ => Vec::new(),
    };
    let bare = Yoke { preload_n: Some(1.0), ..Yoke::default() };
    assert_eq!(open(&bare, 1), ["yoke.rate", "yoke.friction.yoke", "yoke.friction.teeth", "yoke.bearing_torque"]);
    assert_eq!(open(&bare, 2), ["yoke.rate", "yoke.friction.yoke", "yoke.friction.teeth"]);
    assert_eq!(open(&bare, 3), ["yoke.rate", "yoke.friction.teeth"]);
    assert!(judged(&YOKE, BY_VALUE)[1..].iter().all(|check| check.verdict == Some(Verdict::Pass)));
    let unmeasured = Terms { is_measured: false, ..BY_VALUE };
    for terms in [Terms { knows_travel: false, ..BY_VALUE }, Terms { is_by_value: false, ..BY_VALUE }, unmeasured] {
        assert!(judged(&YOKE, terms).iter().all(|check| check.verdict.is_none()), "{terms:?}");
    }
}

/// Play, force, torque and lift-off anew: from ΔCD and the pinion's angle at neighbouring strokes of the mesh, and the wedge.
#[test]
fn each_stroke_is_what_its_neighbours_say() {
    const STEP: f64 = 1e-3;
    let (mut compared, mut turned) = (0, 0.0_f64);
    for (mesh, curve) in meshes(53, 6) {
        let pair = mesh.pair();
        let smooth = Yoke { yoke_friction: None, tooth_friction: None, bearing_torque_n_m: None, ..YOKE };
        let (with, without) = (function(&mesh, &curve, &YOKE, None), function(&mesh, &curve, &smooth, None));
        let set_at = mesh.at(3.0).expect("solved").delta_cd_mm;
        // a flank that climbs alone: its slope along the rack, and the friction angle in that plane
        let (alpha, beta) = (pair.normal_pressure_angle_rad(), pair.rack().helix_angle_rad);
        let slope = trig::atan(trig::tan(alpha) / trig::cos(beta));
        let across = trig::cos(alpha) * trig::sin(beta);
        let held = trig::atan(0.08 / (1.0 - across * across).sqrt());
        for ((point, at), frictionless) in curve.points.iter().zip(&with.along).zip(&without.along).step_by(7) {
            let moved = point.delta_cd_mm - set_at;
            assert!((at.play_mm.expect("a play") - (0.06 - moved)).abs() < 1e-12);
            let (forces, frictionless) = (at.forces.expect("forces"), frictionless.forces.expect("forces"));
            let force = 500.0 + 100.0 * moved;
            assert!((forces.yoke_n - force).abs() < 1e-9);
            assert!((forces.lift_off_n - force / trig::tan(slope + held)).abs() < 1e-8, "{forces:?}");
            assert!((frictionless.lift_off_n - force / trig::tan(slope)).abs() < 1e-8, "{frictionless:?}");
            let near = [-1.0, -0.5, 0.5, 1.0].map(|step| mesh.at(point.stroke_mm + step * STEP).expect("solved"));
            let [before, little_before, little_after, after] = &near;
            let alike = |other: &MeshPoint| (other.right, other.left) == (point.right, point.left);
            if alike(before) && alike(after) {
                // two places of one edge have the same names: where one takes over from the other each side has its own rates
                let central = |of: fn(&MeshPoint) -> f64| (of(after) - of(before)) / (2.0 * STEP);
                let one_sided = |half: &MeshPoint, whole: &MeshPoint, of: fn(&MeshPoint) -> f64| {
                    (4.0 * of(half) - of(whole) - 3.0 * of(point)) / (whole.stroke_mm - point.stroke_mm)
                };
                let rates = |rate: &dyn Fn(fn(&MeshPoint) -> f64) -> f64| {
                    let per_angle = force / rate(|at| at.pinion_angle_rad) / 1000.0;
                    (per_angle * rate(|at| at.delta_cd_mm), 0.1 * per_angle)
                };
                let sides = [
                    rates(&central),
                    rates(&|of| one_sided(little_before, before, of)),
                    rates(&|of| one_sided(little_after, after, of)),
                ];
                let torque = frictionless.rising_n_m;
                let is_near = |&(expected, yoke): &(f64, f64)| {
                    (torque - expected).abs() < 1e-6 && (forces.yoke_friction_n_m - yoke).abs() < 1e-6
                };
                let Some((expected, _)) = sides.into_iter().find(is_near) else {
                    panic!("{torque} {forces:?} {sides:?}")
                };
                assert!((frictionless.falling_n_m + expected).abs() < 1e-6);
                let resting = forces.yoke_friction_n_m + forces.tooth_friction_n_m + 0.1;
                assert!((forces.rising_n_m - resting - forces.lifting_n_m).abs() < 1e-12);
                assert!((forces.falling_n_m - resting + forces.lifting_n_m).abs() < 1e-12);
                (compared, turned) = (compared + 1, turned.max(expected.abs()));
            }
        }
        // between the points of the curve no torque is larger than the largest
        let (rising, falling) = (without.forces.expect("forces").rising, without.forces.expect("forces").falling);
        let mut sampler = Sampler::new(&mesh);
        for step in 0..400 {
            let stroke = -2.0 + (5.0 * pair.rack().pitch_mm + 2.0) * f64::from(step) / 400.0;
            let point = sampler.at(stroke).expect("solved");
            let rates = sampler.rates(&point);
            let forces = without.at(&point, rates).forces.expect("forces");
            for (torque, all) in [(forces.rising_n_m, rising), (forces.falling_n_m, falling)] {
                assert!(
                    all.extent.smallest - 1e-6 <= torque && torque <= all.extent.largest + 1e-6,
                    "{stroke} {torque}"
                );
            }
        }
        assert!(
            without.forces.expect("forces").lift_off_n.smallest
                <= (500.0 + 100.0 * (with.lowest.delta_cd_mm - set_at)) / trig::tan(slope) + 1e-8
        );
    }
    assert!(compared > 300 && turned > 0.05, "{compared} {turned}");
}

/// `simulate` names every limit on a yoke, says that the yoke does not count, and ends with the verdict of its exit status.
#[test]
fn a_simulation_leaves_limits_on_a_yoke_open() {
    let stroke = ["--set", "simulation.stroke=2", "--set", "limits.center_distance=±0.1"];
    let line = ["simulate", "examples/function.toml", "--quasi-static", "--step", "1mm"];
    let ended = run(&[&line[..], &stroke].concat(), "");
    let open =
        "limits.yoke_play, limits.pinion_torque, limits.torque_fluctuation, limits.lift_off_force are not judged here";
    let last = ended.stdout.trim_end().lines().last().unwrap_or_default();
    assert_eq!((ended.code, last), (Some(2), &*format!("No verdict: {open}")), "{}{}", ended.stdout, ended.stderr);
    assert!(ended.stderr.contains(open) && ended.stdout.contains("PASS: "), "{}{}", ended.stdout, ended.stderr);
    assert!(ended.stdout.contains("note: [yoke] does not count here"), "{}", ended.stdout);
}
