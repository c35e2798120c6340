//! `rackmesh simulate`: the multibody simulation along the stroke.

use super::{mesh, signals};
use std::ops::ControlFlow;
use std::path::PathBuf;

use super::decision::JudgeArgs;
use super::output::{Failure, Output, Status};
use super::picture::{PlotArgs, draw};
use super::set::SetArgs;
use super::signals::Interruption;
use super::spec_files::files_read;
use super::teeth::{judged, placed};
use crate::diagnostic::{Code, Diagnostic};
use crate::mesh::Mesh;
use crate::multibody::{Outcome, RunEnd, Sample, Scene, Steady, Support, exact_mean_mm};
use crate::quantity::Length;
use crate::report::chart::{Axis, Chart, Layer, Scale, Shape};
use crate::report::{CurveEnd, Format, SimulationReport, extreme_in_words};

pub(super) const ABOUT: &str = "Simulate forces: elastic bodies in contact along the stroke";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh simulate examples/mesh.toml                  steady ΔCD of both rack parts, beside the exact mesh
  rackmesh simulate examples/mesh.toml --quasi-static --format csv
  rackmesh simulate examples/mesh.toml --plot run.svg

--step overrides simulation.spacing. Ctrl-C ends the run and prints what was computed.

Exit status: 0 inside the limits or none given, 1 outside, 2 not judged or not computed to the end,
3 indeterminate, 129, 130 or 143 if a signal ended it.")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: PathBuf,
    /// Solve the equilibrium at each stroke, without inertia and damping.
    #[arg(long)]
    quasi_static: bool,
    /// List strokes this far apart.
    #[arg(long, alias = "spacing", value_name = "LENGTH", allow_hyphen_values = true)]
    step: Option<Length>,
    #[command(flatten)]
    plot: PlotArgs,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
}

impl Args {
    /// Runs the scene with a bar where somebody watches, until the end or Ctrl-C.
    fn watched(&self, scene: &Scene, interruption: &Interruption, output: &Output) -> Outcome {
        let mut bar = super::bar::Bar::new(output);
        let parameters = scene.parameters();
        let way = if parameters.returns { 2.0 } else { 1.0 } * parameters.stroke_mm;
        let mut seen = 0.0;
        let mut watch = |sample: &Sample| {
            seen += parameters.spacing_mm;
            bar.show(Some(f64::min(seen / way, 1.0)), || format!("stroke {:.1} mm", sample.stroke_mm));
            if interruption.came() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let outcome = if self.quasi_static { scene.quasi_static(&mut watch) } else { scene.dynamic(&mut watch) };
        bar.finish();
        outcome
    }

    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let mut spec = self.set.read_spec(&self.spec, output)?;
        let open = super::function::leave_open(&spec, output);
        if let Some(step) = &self.step {
            spec.simulation.spacing_mm = step.mm();
        }
        let picture = self.plot.picture(&files_read(&spec, &self.spec))?;
        let (spec, input) = placed(spec, &self.spec, output)?;
        let evaluation = judged(&spec, &JudgeArgs::of_spec(), output)?;
        let scene = spec.scene(&input)?;
        let parameters = scene.parameters();
        let interruption = signals::interrupted(output);
        let outcome = self.watched(&scene, &interruption, output);
        let exact = |steady: Option<Steady>| exact_mean_mm(&input.mesh, &steady?);
        let report = SimulationReport {
            title: spec.title.as_deref(),
            parameters,
            inertias: scene.inertias(),
            quasi_static: self.quasi_static,
            outcome: &outcome,
            exact_mm: [exact(outcome.nominal), exact(outcome.deviating)],
            notes: (spec.has_yoke() && !matches!(parameters.support, Support::Yoke(_)))
                .then(|| NO_YOKE.to_owned())
                .into_iter()
                .chain(mesh::placement(&input))
                .chain(input.warnings.iter().map(ToString::to_string))
                .chain(mesh::unmeasured(&input))
                .chain(evaluation.note_of_unsolved())
                .chain((!evaluation.limits.is_empty()).then(|| RIGID.to_owned()))
                .collect(),
            evaluation,
            open,
            screen: output.screen(),
        };
        let picture = picture.filter(|_| !outcome.samples.is_empty());
        let is_complete = matches!(outcome.end, RunEnd::Completed);
        draw(picture, || chart(&report, &input.mesh), is_complete, output)?;
        output.report(&report, self.format)?;
        Ok(match outcome.end {
            RunEnd::Completed => Status::of(report.evaluation.verdict, &report.evaluation.limits),
            RunEnd::Interrupted => {
                // tables report it themselves
                if matches!(self.format, Format::Csv | Format::Json) {
                    let reached = outcome.samples.last().map_or(parameters.start_mm, |sample| sample.stroke_mm);
                    let message =
                        format!("interrupted at a stroke of {reached:.1} mm; the positions up to there are printed");
                    output.diagnostic(&Diagnostic::warning(Code::NoSimulation, message));
                }
                interruption.status().unwrap_or(Status::Undecided)
            }
            RunEnd::Failed(error) => {
                output.diagnostic(&Diagnostic::error(Code::NoSimulation, error.to_string()));
                Status::Undecided
            }
        })
    }
}

const RIGID: &str = "limits are held against rigid teeth, as `mesh` does; the elastic part goes with the stiffness";
const NO_YOKE: &str = "[yoke] does not count here: it does with `simulation.support = \"yoke\"`";

/// ΔCD over the stroke with the exact mesh; for a rack that comes back the loop of the torque.
fn chart(report: &SimulationReport<'_>, mesh: &Mesh) -> Chart {
    let (there, back) = report.outcome.samples.split_at(report.outcome.there);
    if !back.is_empty() {
        let torque = |sample: &Sample| (sample.stroke_mm, sample.pinion_torque_n_m);
        let layers = vec![
            Layer::new("stroke rising", Shape::Line(there.iter().map(torque).collect())),
            Layer::new("stroke falling", Shape::Line(back.iter().rev().map(torque).collect())),
        ];
        let chart = Chart::along_the_stroke(report.title.unwrap_or("torque at the pinion"), layers);
        let y = Axis { label: "torque at the pinion [N m]".to_owned(), scale: Scale::Airy };
        return Chart { y, ..chart };
    }
    let samples = there.iter();
    let strokes: Vec<f64> = samples.clone().map(|sample| sample.stroke_mm).collect();
    let exact = strokes.iter().zip(mesh.sample(&strokes));
    let exact = exact.filter_map(|(stroke, point)| Some((*stroke, point.ok()?.delta_cd_mm)));
    let simulated = samples.map(|sample| (sample.stroke_mm, sample.delta_cd_mm));
    let mut layers = vec![
        Layer::new("simulated", Shape::Line(simulated.collect())),
        Layer::new("exact mesh", Shape::Line(exact.collect())),
    ];
    layers.extend(report.outcome.extremes().and_then(|ends| {
        let ends =
            ends.map(|at| CurveEnd { stroke_mm: at.stroke_mm, delta_cd_mm: at.delta_cd_mm, rack_teeth: at.carrying });
        extreme_in_words(ends, mesh.pair().pinion().teeth)
    }));
    Chart::along_the_stroke(report.title.unwrap_or("ΔCD along the stroke"), layers)
}
