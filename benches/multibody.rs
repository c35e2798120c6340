//! Run time and error of the multibody model over its discretisation and tolerances.
//!
//! Each row is the paper's 50 mm of stroke at 500 N and 20 mm/s: the fastest of three runs on one core, the work done,
//! the rms ripple over the nominal teeth, and the rms difference of ΔCD + indentation (and of ΔCD alone) from the exact
//! mesh.
#![allow(missing_docs, clippy::large_types_passed_by_value)] // parameters are written in place

use std::ops::ControlFlow;
use std::time::Instant;

use rackmesh::deviation::{PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks};
use rackmesh::gear::{Pair, PairData, PinionData, RackData};
use rackmesh::multibody::{ContactModel, Outcome, Parameters, Scene, SphereGrid, StripGrid};

fn pair() -> Pair {
    let radians = |degrees: f64| degrees * std::f64::consts::PI / 180.0;
    Pair::new(&PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: radians(19.9),
        rack: RackData { helix_angle_rad: 0.0, face_width_mm: 19.7, addendum_mm: 1.7, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 8,
            helix_angle_rad: radians(21.0),
            profile_shift: 0.3,
            tip_diameter_mm: 19.738,
            root_form_diameter_mm: None,
            face_width_mm: 25.0,
            tooth_thickness_deviation_mm: 0.0,
        },
    })
    .expect("a valid pair")
}

fn scene(kind: RackDeviationKind, parameters: Parameters) -> Scene {
    let pair = pair();
    let teeth = "4..".parse().expect("a range");
    let rack = RackFlanks::new(&pair, &[RackDeviation { teeth, kind }]).expect("small deviations");
    Scene::new(pair, rack, PinionFlanks::nominal(&pair), parameters).expect("parameters in their domains")
}

fn row(name: &str, kind: RackDeviationKind, parameters: Parameters, dynamic: bool) {
    let scene = scene(kind, parameters);
    let mut best = f64::INFINITY;
    let mut outcome: Option<Outcome> = None;
    for _ in 0..3 {
        let started = Instant::now();
        let watch = &mut |_: &_| ControlFlow::Continue(());
        outcome = Some(if dynamic { scene.dynamic(watch) } else { scene.quasi_static(watch) });
        best = best.min(started.elapsed().as_secs_f64());
    }
    let Some(outcome) = outcome else { return };
    let strokes: Vec<f64> = outcome.samples.iter().map(|sample| sample.stroke_mm).collect();
    let exact = scene.mesh().sample(&strokes);
    let (mut rigid, mut raw, mut count) = (0.0, 0.0, 0.0);
    for (sample, exact) in outcome.samples.iter().zip(exact) {
        let exact = exact.expect("a mesh at every stroke").delta_cd_mm;
        let off = sample.delta_cd_mm - exact;
        raw += off * off;
        rigid += (off + sample.indentation_mm) * (off + sample.indentation_mm);
        count += 1.0;
    }
    let micrometres = |sum: f64| 1e3 * (sum / count).sqrt();
    println!(
        "{name:<46} {:>9.2} ms {:>8} evaluations {:>6} steps   ripple {:>7.4} µm   off {:>7.4} µm, with indentation {:>7.4} µm   {:?}",
        1e3 * best,
        outcome.counters.evaluations,
        outcome.counters.steps,
        outcome.nominal.map_or(f64::NAN, |part| 1e3 * part.ripple_mm),
        micrometres(rigid),
        micrometres(raw),
        outcome.end,
    );
}

fn main() {
    // `cargo test --benches` only asks whether it builds
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let spheres = |profile_nodes, width_nodes| {
        ContactModel::Spheres(SphereGrid { profile_nodes, width_nodes, ..SphereGrid::default() })
    };
    let lines = |strips| ContactModel::Analytic(StripGrid { strips });
    let radians = std::f64::consts::PI / 180.0;
    for (case, kind) in [
        ("over-roller +0.02", RackDeviationKind::OverRoller(0.02)),
        ("pitch +0.02", RackDeviationKind::Pitch(0.02)),
        ("lead +0.25°", RackDeviationKind::Lead(0.25 * radians)),
    ] {
        println!("{case}");
        for dynamic in [false, true] {
            let how = if dynamic { "dynamic" } else { "quasi-static" };
            for (profile, width) in [(24, 24), (48, 48), (48, 96), (96, 192), (192, 384)] {
                let parameters = Parameters { contact: spheres(profile, width), ..Parameters::default() };
                row(&format!("  {how}, {profile} x {width} spheres"), kind, parameters, dynamic);
            }
            for strips in [64, 256, 1024] {
                let parameters = Parameters { contact: lines(strips), ..Parameters::default() };
                row(&format!("  {how}, {strips} strips"), kind, parameters, dynamic);
            }
        }
        for tolerance_mm in [1e-3, 1e-4, 1e-5, 1e-6] {
            let parameters = Parameters { tolerance_mm, ..Parameters::default() };
            row(&format!("  dynamic, tolerance {tolerance_mm:e} mm"), kind, parameters, true);
        }
        row("  undamped", kind, Parameters { damping: 0.0, ..Parameters::default() }, true);
    }
}
