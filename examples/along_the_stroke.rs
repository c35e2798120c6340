//! The README's picture: ΔCD along the stroke of the paper's rack as a bound, by the exact mesh and as simulated.
//!
//! `cargo run --example along_the_stroke > docs/along-the-stroke.svg` writes it; the continuous integration holds the file
//! to it. The rack is that of the paper's Table 1, +0.02 mm: every pitch from tooth 4 on is too long, and the teeth are
//! thicker by half of that. The bound takes these errors to be on any run of teeth.

use std::error::Error;
use std::ops::ControlFlow;

use rackmesh::deviation::Extent;
use rackmesh::evaluation::evaluate;
use rackmesh::formula::{Law, Model, PartDeviation};
use rackmesh::judge::{Limits, Stack};
use rackmesh::quantity::{Angle, Length};
use rackmesh::report::chart::{Chart, Layer, Shape, Span};
use rackmesh::reproduction::PRESSURE_ANGLE;
use rackmesh::spec::{MeasuredTables, Spec};

const STROKE_MM: f64 = 50.0;
/// Of the mesh's curve, far below what the picture shows.
const TOLERANCE_MM: f64 = 1e-5;
/// Of the simulated positions every fifth is shown, 0.5 mm apart.
const EVERY: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let spec = Spec::parse("mesh.toml", include_str!("mesh.toml"))?;
    let input = spec.mesh(&MeasuredTables::default())?;
    let curve = input.mesh.curve(0.0, STROKE_MM, TOLERANCE_MM)?;
    let run = spec.scene(&input)?.dynamic(&mut |_| ControlFlow::Continue(()));
    if !run.completed() {
        return Err(format!("the simulation did not reach its end: {:?}", run.end).into());
    }

    let pitch = Law::rack_pitch(PRESSURE_ANGLE.parse::<Angle>()?, Angle::ZERO)?;
    // thicker teeth raise the pinion as a step of that size does
    let raised = pitch.delta_cd("10 um".parse::<Length>()?, Model::Exact)?;
    let errors = [
        PartDeviation::new(pitch, "20 um".parse::<Length>()?).with_extent(Extent::Part),
        PartDeviation::new(Law::rack_over_roller(), raised).with_extent(Extent::Part),
    ];
    let judged = evaluate(&errors, &Limits::default(), Model::Exact, Stack::Range, &spec.pair_basis()?)?;
    let bound = judged.combined.interval(Stack::Range)?;
    let band = [0.0, STROKE_MM].map(|x| Span { x, low: bound.lower.mm(), high: bound.upper.mm() });

    let mesh = curve.points.iter().map(|point| (point.stroke_mm, point.delta_cd_mm)).collect();
    let simulated = run.samples.iter().step_by(EVERY).map(|sample| (sample.stroke_mm, sample.delta_cd_mm)).collect();
    let layers = vec![
        Layer::new("bound: these errors on any teeth", Shape::Band(band.to_vec())),
        Layer::new("exact mesh", Shape::Line(mesh)),
        Layer::new("multibody simulation", Shape::Dots(simulated)),
    ];
    let title = "The paper's rack: pitch errors of +0.02 mm from tooth 4 on";
    print!("{}", Chart::along_the_stroke(title, layers).svg().ok_or("there is nothing to show")?);
    Ok(())
}
