//! How fast the multibody model tends to the exact mesh and to the exact motion, setting by setting.

use std::ops::ControlFlow;

use super::paper;
use rackmesh::deviation::*;
use rackmesh::multibody::*;

/// Errors over a setting that is halved (or divided by ten) again and again.
pub struct Convergence {
    pub what: &'static str,
    pub unit: &'static str,
    /// Order that theory gives.
    pub expected: f64,
    /// Setting and error, mm.
    pub errors: Vec<(f64, f64)>,
}

impl Convergence {
    /// Slope of the logarithms from the first to the last pair.
    pub fn order(&self) -> f64 {
        let (first, last) = (self.errors[0], self.errors[self.errors.len() - 1]);
        (first.1 / last.1).ln() / (first.0 / last.0).ln()
    }
}

fn go_on(_: &Sample) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn lines(strips: u32) -> ContactModel {
    ContactModel::Analytic(StripGrid { strips })
}

/// Strokes at which only teeth with deviations touch, hardly elastic.
fn stiff(preload_n: f64, contact: ContactModel) -> Parameters {
    Parameters { preload_n, contact, stiffness: 1e9, start_mm: 30.0, stroke_mm: 6.3, ..Parameters::default() }
}

/// Root mean square of ΔCD less the exact mesh, with the indentation added back or not.
fn error(kind: Option<RackDeviationKind>, parameters: Parameters, rigid: bool) -> f64 {
    let scene = paper::scene(kind, parameters);
    let outcome = scene.quasi_static(&mut go_on);
    assert_eq!(outcome.end, RunEnd::Completed, "{kind:?} {parameters:?}");
    let square = |sample: &Sample| {
        let exact = scene.mesh().at(sample.stroke_mm).unwrap().delta_cd_mm;
        (sample.delta_cd_mm + if rigid { sample.indentation_mm } else { 0.0 } - exact).powi(2)
    };
    (outcome.samples.iter().map(square).sum::<f64>() / outcome.samples.len() as f64).sqrt()
}

/// Spheres over the profile, on nominal flanks: between two of them a line of contact sinks by the square of the
/// distance.
pub fn profile() -> Convergence {
    let at = |nodes: u32| {
        let grid = SphereGrid { profile_nodes: nodes, width_nodes: 24, ..SphereGrid::default() };
        let pinion = *paper::pair().pinion();
        let step = (pinion.tip_roll_rad - pinion.start_roll_rad) * pinion.base_radius_mm / f64::from(nodes - 1);
        (step, error(None, stiff(0.5, ContactModel::Spheres(grid)), true))
    };
    let errors = [9, 17, 33, 65].map(at).to_vec();
    Convergence { what: "distance of spheres over the profile, line of contact", unit: "mm", expected: 2.0, errors }
}

/// Rows (or strips) over the face width, where a lead deviation puts the load on the end of the face.
pub fn width(spheres: bool) -> Convergence {
    let lead = Some(RackDeviationKind::Lead(0.004));
    let at = |rows: u32| {
        let grid = SphereGrid { width_nodes: rows, ..SphereGrid::default() };
        let contact = if spheres { ContactModel::Spheres(grid) } else { lines(rows) };
        (paper::pair().pinion().face_width_mm / f64::from(rows), error(lead, stiff(5.0, contact), true))
    };
    let what = if spheres {
        "distance of rows of spheres, end of face"
    } else {
        "width of strips of exact surfaces, end of face"
    };
    Convergence { what, unit: "mm", expected: 1.0, errors: [96, 192, 384, 768].map(at).to_vec() }
}

/// Preload: a line of contact gives way by its power 1/a, an end of the face by 1/(a + 1).
pub fn preload(lead: bool) -> Convergence {
    let kind = lead.then_some(RackDeviationKind::Lead(0.004));
    let at = |preload_n: f64| (preload_n, error(kind, stiff(preload_n, lines(2000)), false));
    let (what, expected) =
        if lead { ("preload, end of face", 1.0 / 2.5) } else { ("preload, line of contact", 1.0 / 1.5) };
    Convergence { what, unit: "N", expected, errors: [500.0, 50.0, 5.0].map(at).to_vec() }
}

/// Steps in time of the implicit scheme: a heavy spur pinion that a suddenly moving rack sets swinging on its teeth,
/// which stay in touch. The error is the largest difference from the run with half the step.
pub fn step() -> Convergence {
    let pair = paper::spur();
    let runs = [1.0, 0.5, 0.25, 0.125, 0.0625].map(|part| (0.1 * part, swinging(1e-4 * part)));
    let apart = |coarse: &Outcome, fine: &Outcome| {
        let pairs = coarse.samples.iter().zip(fine.samples.iter().step_by(2));
        let angle = pairs.map(|(a, b)| (a.pinion_angle_rad - b.pinion_angle_rad).abs()).fold(0.0, f64::max);
        angle * pair.pinion().base_radius_mm
    };
    let errors = runs.windows(2).map(|two| (two[0].0, apart(&two[0].1, &two[1].1))).collect();
    Convergence { what: "step in time, pinion swinging on its teeth", unit: "µm of stroke", expected: 2.0, errors }
}

fn swinging(spacing_mm: f64) -> Outcome {
    let pair = paper::spur();
    let parameters = Parameters {
        contact: lines(16),
        stiffness: 8e5,
        preload_n: 200.0,
        damping: 0.0,
        tolerance_mm: 1.0,
        start_mm: -0.008,
        stroke_mm: 0.016,
        // at once: the steps are then alike
        ramp_mm: 1e-9,
        speed_mm_per_s: 5.0,
        spacing_mm,
        masses: Masses { pinion_kg: Some(50.0), pinion_kg_mm2: Some(1000.0), ..Masses::default() },
        ..Parameters::default()
    };
    let scene = Scene::new(pair, RackFlanks::nominal(&pair), PinionFlanks::nominal(&pair), parameters).unwrap();
    let outcome = scene.dynamic(&mut go_on);
    assert_eq!(outcome.end, RunEnd::Completed);
    assert_eq!(outcome.counters.steps as usize, outcome.samples.len() - 1, "{spacing_mm} {:?}", outcome.counters);
    outcome
}

/// The size of the energy's drift, N mm, with these parts of the longest step.
pub fn drifts(parts: [f64; 3]) -> Vec<f64> {
    parts.map(|part| swinging(1e-4 * part).energy.unwrap().drift.abs()).to_vec()
}

/// Everything above.
pub fn all() -> Vec<Convergence> {
    vec![profile(), width(true), width(false), preload(false), preload(true), step()]
}
