//! Run time against error: every model and setting on the same three errors.
//!
//! `cargo run --release --example run_time_and_error [FOLDER]` prints a table, and writes it as CSV with one log-log
//! picture for each kind of error into FOLDER (default `benches/results`).
//!
//! The error of a model is the root mean square, over the strokes at which only teeth with deviations are in contact,
//! of its ΔCD less that of the exact mesh at the same stroke. A simulation's ΔCD is taken with its elastic indentation
//! added back. The run time is the median of several runs, for one core and 50 mm of stroke.

use std::error::Error;
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;

use rackmesh::deviation::{FIRST_ODD_TOOTH, PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks, ToothRange};
use rackmesh::formula::{Law, Model};
use rackmesh::gear::Pair;
use rackmesh::mesh::{Mesh, Support};
use rackmesh::multibody::{ContactModel, Outcome, Parameters, Scene, SphereGrid, StripGrid};
use rackmesh::quantity::{Angle, Length};
use rackmesh::report::chart::{Axis, Chart, Layer, Scale, Shape};
use rackmesh::reproduction::{self, FACE_WIDTH, PRESSURE_ANGLE};

/// Strokes at which only deviating teeth touch, mm.
const WINDOW: (f64, f64) = (32.0, 49.0);
const STROKE_MM: f64 = 50.0;
/// Runs are repeated until this much time is spent, at least three times.
const SPENT_S: f64 = 0.15;

/// A measured setting.
struct Row {
    model: &'static str,
    setting: String,
    time_s: f64,
    error_mm: f64,
}

impl Row {
    fn point(&self) -> (f64, f64) {
        (self.time_s, self.error_mm)
    }
}

/// One kind of error: what it is, and the rack that has it from tooth 4 on.
struct Case {
    name: &'static str,
    title: &'static str,
    kinds: Vec<RackDeviationKind>,
    formula: fn() -> Result<f64, Box<dyn Error>>,
}

fn cases() -> [Case; 3] {
    [
        Case {
            name: "over-roller",
            title: "over-roller error ΔM = 0.02 mm",
            kinds: vec![RackDeviationKind::OverRoller(0.02)],
            formula: || Ok(Law::rack_over_roller().delta_cd("0.02".parse::<Length>()?, Model::Exact)?.mm()),
        },
        Case {
            name: "pitch",
            title: "every pitch off by Δp = 0.02 mm",
            kinds: vec![RackDeviationKind::Pitch(0.02), RackDeviationKind::Thickness(0.01)],
            formula: || {
                let alpha: Angle = PRESSURE_ANGLE.parse()?;
                Ok(Law::rack_pitch(alpha, Angle::ZERO)?.delta_cd("0.02".parse::<Length>()?, Model::Exact)?.mm())
            },
        },
        Case {
            name: "lead",
            title: "lead angle error Δβ = 0.25°",
            kinds: vec![RackDeviationKind::Lead(0.25 * std::f64::consts::PI / 180.0)],
            formula: || {
                let (alpha, width): (Angle, Length) = (PRESSURE_ANGLE.parse()?, FACE_WIDTH.parse()?);
                Ok(Law::rack_lead(alpha, Angle::ZERO, width)?.delta_cd("0.25".parse::<Angle>()?, Model::Exact)?.mm())
            },
        },
    ]
}

/// The median time of `run`, s, and what it gave.
fn timed<T>(mut run: impl FnMut() -> T) -> (f64, T) {
    let mut times = Vec::new();
    let begin = Instant::now();
    loop {
        let start = Instant::now();
        let result = std::hint::black_box(run());
        times.push(start.elapsed().as_secs_f64());
        if times.len() >= 3 && begin.elapsed().as_secs_f64() > SPENT_S {
            times.sort_by(f64::total_cmp);
            return (times[times.len() / 2], result);
        }
    }
}

/// Root mean square of `curve` less the exact mesh, within the window.
fn error_mm(mesh: &Mesh, curve: impl Iterator<Item = (f64, f64)>) -> Result<f64, Box<dyn Error>> {
    let (mut sum, mut count) = (0.0, 0.0);
    for (stroke, delta_cd) in curve.filter(|(stroke, _)| (WINDOW.0..=WINDOW.1).contains(stroke)) {
        let difference = delta_cd - mesh.at(stroke)?.delta_cd_mm;
        sum += difference * difference;
        count += 1.0;
    }
    Ok(f64::sqrt(sum / count))
}

/// Strokes across the window, not in step with anything.
fn strokes() -> impl Iterator<Item = f64> {
    let step = (WINDOW.1 - WINDOW.0) / 997.0;
    (0..997).map(move |index| WINDOW.0 + step * (f64::from(index) + 0.5))
}

/// The curve between its points.
fn interpolated(points: &[(f64, f64)], stroke: f64) -> f64 {
    let after = points.partition_point(|point| point.0 < stroke).clamp(1, points.len() - 1);
    let (a, b) = (points[after - 1], points[after]);
    if b.0 > a.0 { a.1 + (b.1 - a.1) * (stroke - a.0) / (b.0 - a.0) } else { b.1 }
}

fn simulated(
    mesh: &Mesh,
    pair: Pair,
    parameters: &Parameters,
    run: fn(&Scene) -> Outcome,
) -> Result<Option<(f64, f64)>, Box<dyn Error>> {
    let (time, outcome) =
        timed(|| Scene::new(pair, mesh.rack().clone(), mesh.pinion().clone(), *parameters).map(|scene| run(&scene)));
    let outcome = outcome?;
    if !outcome.completed() {
        eprintln!("not completed: {:?}", outcome.end);
        return Ok(None);
    }
    let rigid = outcome.samples.iter().map(|sample| (sample.stroke_mm, sample.delta_cd_mm + sample.indentation_mm));
    Ok(Some((time, error_mm(mesh, rigid)?)))
}

fn measure(case: &Case) -> Result<Vec<Row>, Box<dyn Error>> {
    let pair = reproduction::pair()?;
    let teeth = ToothRange::starting_at(FIRST_ODD_TOOTH);
    let deviations: Vec<_> = case.kinds.iter().map(|kind| RackDeviation { teeth, kind: *kind }).collect();
    let mesh = Mesh::new(pair, RackFlanks::new(&pair, &deviations)?, PinionFlanks::nominal(&pair), Support::Fixed)?;
    let mut rows = Vec::new();
    let (time_s, delta_cd) = timed(|| (case.formula)());
    let delta_cd = delta_cd?;
    let error = error_mm(&mesh, strokes().map(|stroke| (stroke, delta_cd)))?;
    rows.push(Row { model: "formula", setting: "exact model".to_owned(), time_s, error_mm: error });
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8] {
        let (time_s, curve) = timed(|| mesh.curve(0.0, STROKE_MM, tolerance));
        let points: Vec<_> = curve?.points.iter().map(|point| (point.stroke_mm, point.delta_cd_mm)).collect();
        let error = error_mm(&mesh, strokes().map(|stroke| (stroke, interpolated(&points, stroke))))?;
        rows.push(Row { model: "exact mesh", setting: format!("tolerance {tolerance:e}"), time_s, error_mm: error });
    }
    let spheres = [12, 24, 48, 96].map(|profile| {
        let grid = SphereGrid { profile_nodes: profile, width_nodes: 2 * profile, ..SphereGrid::default() };
        (format!("{profile} × {} spheres", 2 * profile), ContactModel::Spheres(grid))
    });
    let strips = [16, 64, 256].map(|strips| (format!("{strips} strips"), ContactModel::Analytic(StripGrid { strips })));
    let quasi_static = |scene: &Scene| scene.quasi_static(&mut |_| ControlFlow::Continue(()));
    let dynamic = |scene: &Scene| scene.dynamic(&mut |_| ControlFlow::Continue(()));
    let models = [
        (&spheres[..], ["equilibrium (spheres)", "in time (spheres)"]),
        (&strips[..], ["equilibrium (exact surfaces)", "in time (exact surfaces)"]),
    ];
    for (settings, names) in models {
        for (model, run) in names.into_iter().zip([quasi_static as fn(&Scene) -> Outcome, dynamic]) {
            for (setting, contact) in settings {
                let parameters = Parameters { contact: *contact, stroke_mm: STROKE_MM, ..Parameters::default() };
                if let Some((time_s, error_mm)) = simulated(&mesh, pair, &parameters, run)? {
                    rows.push(Row { model, setting: setting.clone(), time_s, error_mm });
                }
            }
        }
    }
    // the tolerance of the steps in time, where the spheres are fine enough to show it
    for tolerance_mm in [1e-3, 1e-4, 1e-6] {
        let parameters = Parameters { tolerance_mm, stroke_mm: STROKE_MM, ..Parameters::default() };
        if let Some((time_s, error_mm)) = simulated(&mesh, pair, &parameters, dynamic)? {
            let setting = format!("default spheres; tolerance {tolerance_mm:e}");
            rows.push(Row { model: "in time (tolerance)", setting, time_s, error_mm });
        }
    }
    Ok(rows)
}

/// The points that no other point beats in both run time and error (the Pareto front), from left to right.
fn front(rows: &[Row]) -> Vec<(f64, f64)> {
    let mut points: Vec<_> = rows.iter().map(Row::point).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut lowest = f64::INFINITY;
    points.retain(|point| {
        let better = point.1 < lowest;
        lowest = lowest.min(point.1);
        better
    });
    points
}

/// Error against run time: a line for each model, and the front as a staircase.
fn chart(case: &Case, rows: &[Row], front: &[(f64, f64)]) -> Chart {
    let next = front.iter().skip(1).map(|point| point.0).chain([f64::NAN]);
    let stairs = front.iter().zip(next).flat_map(|(point, next)| [*point, (next, point.1)]);
    let mut layers = vec![Layer::new("no setting is both faster and closer", Shape::Trail(stairs.collect()))];
    for rows in rows.chunk_by(|a, b| a.model == b.model) {
        layers.push(Layer::new(rows[0].model, Shape::Track(rows.iter().map(Row::point).collect())));
    }
    let axis = |label: &str| Axis { label: label.to_owned(), scale: Scale::Logarithmic };
    Chart {
        title: format!("Run time against error: {}", case.title),
        x: axis("run time for 50 mm of stroke, one core [s]"),
        y: axis("error of ΔCD, rms [mm]"),
        layers,
        height: 560.0,
        ..Chart::default()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "benches/results".to_owned());
    if folder.starts_with('-') {
        let usage = "usage: cargo run --release --example run_time_and_error [FOLDER]";
        if folder == "--help" || folder == "-h" {
            println!(
                "{usage}\n\nMeasures every model and writes a table and plots into FOLDER (default benches/results)."
            );
            return Ok(());
        }
        return Err(format!("'{folder}' is no folder; {usage}").into());
    }
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;
    let mut csv = "case,model,setting,time_s,rms_error_mm,on_front\n".to_owned();
    for case in cases() {
        let rows = measure(&case)?;
        let front = front(&rows);
        println!("\n{}\n{:28} {:34} {:>12} {:>14}", case.title, "model", "setting", "run time [s]", "rms error [mm]");
        for row in &rows {
            let on_front = front.contains(&row.point());
            let mark = if on_front { " *" } else { "" };
            println!("{:28} {:34} {:12.3e} {:14.3e}{mark}", row.model, row.setting, row.time_s, row.error_mm);
            writeln!(
                csv,
                "{},{},{},{:.3e},{:.3e},{on_front}",
                case.name, row.model, row.setting, row.time_s, row.error_mm
            )?;
        }
        let svg = chart(&case, &rows, &front).svg().ok_or("nothing was measured")?;
        std::fs::write(folder.join(format!("run-time-and-error-{}.svg", case.name)), svg)?;
    }
    println!("\n* no setting is both faster and closer");
    std::fs::write(folder.join("run-time-and-error.csv"), csv)?;
    Ok(())
}
