//! `rackmesh eval`: ΔCD of the errors in a spec, combined and judged.

use std::path::{Path, PathBuf};

use super::bar::SharedBar;
use super::decision::JudgeArgs;
use super::output::{Failure, Output, Status};
use super::picture::{PlotArgs, draw};
use super::set::SetArgs;
use super::teeth::{WorstTeeth, mesh_of, with_known_teeth};
use super::{function, mesh, spec_files};
use crate::diagnostic::{Code, Diagnostic};
use crate::judge::LimitTarget;
use crate::mesh::{STROKE_MM, TOLERANCE_MM};
use crate::report::{EvaluationReport, Format, MeshPart};
use crate::spec::Spec;

pub(super) const ABOUT: &str = "Evaluate a spec: ΔCD of each error, combined and judged";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh eval rack.toml
  rackmesh eval rack.toml --stack rss --format json
  rackmesh eval examples/mesh-errors.toml --mesh
  rackmesh eval rack.toml --plot stack.svg
  rackmesh eval examples/uncertain.toml --rule iso14253 --monte-carlo
  rackmesh init | rackmesh eval -

Exit status: 0 inside the limits or none given, 1 outside, 2 could not judge, 3 indeterminate by the rule.")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    #[arg(required_unless_present = "monte_carlo")]
    spec: Option<PathBuf>,
    #[command(flatten)]
    judge: JudgeArgs,
    /// Add the exact mesh of the same parts, along a stroke of 50 mm.
    #[arg(long)]
    mesh: bool,
    /// Do not look for the worst teeth to put the errors on.
    #[arg(long, alias = "no-mesh", conflicts_with = "mesh")]
    no_worst_teeth: bool,
    #[command(flatten)]
    plot: PlotArgs,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
}

impl Args {
    pub(super) fn run(mut self, output: &mut Output) -> Result<Status, Failure> {
        let path = match self.spec.take() {
            Some(path) => path,
            None => self.judge.spec_behind_monte_carlo().map(PathBuf::from).ok_or_else(|| {
                Diagnostic::usage("no spec is given").help("write `rackmesh eval rack.toml --monte-carlo`")
            })?,
        };
        let spec = self.set.read_spec(&path, output)?;
        let picture = self.plot.picture(&spec_files::files_read(&spec, &path))?;
        let spec = with_known_teeth(spec, &path, output)?;
        let is_searched = !self.no_worst_teeth
            && (self.mesh || spec.has_yoke() || spec.limit_on(LimitTarget::CenterDistance).is_some());
        let worst = if is_searched { WorstTeeth::of(spec.part_deviations()?, &spec.basis()?)? } else { None };
        let mut report = evaluated(&spec, &self.judge, worst.as_ref(), output)?;
        let tables = spec_files::measured_tables(&spec, &path, output)?;
        report.yoke = function::evaluated(&spec, &tables, &report.evaluation, worst.as_ref())?;
        if report.yoke.is_none() {
            function::leave_open(&spec, output);
        }
        let of_yoke = report.yoke.as_ref().map_or(Status::Pass, |yoke| function::status(yoke.checks()));
        let status = Status::of(report.evaluation.verdict, &report.evaluation.limits).max(of_yoke);
        if self.mesh {
            report.mesh = Some(mesh_part(&spec, &path, worst.as_ref(), output)?);
        }
        draw(picture, || report.chart(), true, output)?;
        output.report(&report, self.format)?;
        Ok(status)
    }
}

/// The part of `[errors]` of a spec whose known teeth are solved, evaluated and judged; with a limit, also the range that its
/// errors reach on the worst teeth.
pub(super) fn evaluated<'a>(
    spec: &'a Spec,
    judge: &JudgeArgs,
    worst: Option<&WorstTeeth>,
    output: &mut Output,
) -> Result<EvaluationReport<'a>, Failure> {
    let (mut evaluation, uncertainty) =
        judge.judged(spec, &spec.part_deviations()?, &spec.basis()?, &SharedBar::new(output))?;
    let worst = worst.filter(|_| spec.limit_on(LimitTarget::CenterDistance).is_some());
    evaluation.reached = worst.map(WorstTeeth::interval).transpose()?;
    let note_of_exact = judge.leave_open_without_uncertainty(spec, &mut evaluation);
    for target in evaluation.not_given() {
        output.diagnostic(&unjudged(spec, target));
    }
    let mut report = EvaluationReport::new(spec.title.as_deref(), evaluation, &spec.missing_geometry());
    // of many remarks the first ones are shown
    report.rests_on.splice(0..0, (!spec.scatter.is_empty()).then(|| NO_SCATTER.to_owned()));
    report.classes = spec.classes()?;
    report.notes.extend(spec.circles_in_words(&spec.kinds()));
    report.notes.extend(spec.suspicions_in_words().into_iter().chain(note_of_exact));
    report.uncertainty = uncertainty;
    Ok(report)
}

const NO_SCATTER: &str =
    "[scatter] is not judged here: `rackmesh monte-carlo` draws racks by it, and counts those inside the limits";

/// The exact mesh of the spec, in short.
fn mesh_part(spec: &Spec, path: &Path, worst: Option<&WorstTeeth>, output: &mut Output) -> Result<MeshPart, Failure> {
    let stroke_mm = spec.travel_mm().unwrap_or(STROKE_MM);
    let mut input = mesh_of(spec, &spec_files::measured_tables(spec, path, output)?)?;
    if let Some(worst) = worst {
        worst.place(&mut input, spec.limit_on(LimitTarget::CenterDistance))?;
    }
    let curve = input.mesh.curve(stroke_mm.0, stroke_mm.1, TOLERANCE_MM)?;
    let summary = curve
        .summary(&input.mesh)
        .ok_or_else(|| Diagnostic::error(Code::NoMesh, "the exact mesh has no points along the stroke"))?;
    Ok(MeshPart { stroke_mm, summary, notes: mesh::notes(&input) })
}

pub(super) fn unjudged(spec: &Spec, target: LimitTarget) -> Diagnostic {
    let message = format!("there is a limit on ΔCD of the {target}, but [errors] does not give that error");
    let place = spec.limits.iter().find(|(on, _)| *on == target).map(|(_, limit)| limit.span.clone());
    Diagnostic::warning(Code::UnjudgedLimit, message)
        .help(match target {
            LimitTarget::Error(kind) if spec.knows_teeth(kind.part()) => {
                "remove its limit: of teeth that are known one by one, no single error is judged".to_owned()
            }
            _ => format!("add `{}` to [errors], or remove its limit", target.key()),
        })
        .at(&spec.source, place, "cannot be judged")
}
