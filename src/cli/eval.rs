//! `rackmesh eval`: ΔCD of the errors in a spec, combined and judged.

use clap::ValueEnum;

use super::decision::DecisionArgs;
use super::mesh;
use super::output::{Failure, Output, Status};
use super::set::SetArgs;
use super::teeth::{self, with_known_teeth};
use crate::diagnostic::{Code, Diagnostic};
use crate::evaluation::{Evaluation, evaluate};
use crate::formula::{Model, PartDeviation};
use crate::judge::bound::Basis;
use crate::judge::{LimitTarget, Stack, Verdict};
use crate::report::{EvaluationReport, Format, MeshPart, UncertaintyPart};
use crate::spec::Spec;

pub(super) const ABOUT: &str = "Evaluate a spec: ΔCD of each error, combined and judged";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh eval rack.toml
  rackmesh eval rack.toml --stack worst --format json
  rackmesh eval examples/mesh-errors.toml --mesh
  rackmesh eval examples/uncertain.toml --rule iso14253 --monte-carlo
  rackmesh init | rackmesh eval -

Exit status: 0 inside the limits or none given, 1 outside, 2 could not judge, 3 indeterminate by the rule.")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    #[arg(required_unless_present = "monte_carlo")]
    spec: Option<String>,
    /// How errors add up.
    #[arg(long, value_enum, default_value_t)]
    stack: StackArg,
    /// Formulas exact for rigid teeth, or as the paper prints them.
    #[arg(long, value_enum, default_value_t)]
    model: ModelArg,
    /// Add the exact mesh of the same parts, along a stroke of 50 mm.
    #[arg(long)]
    mesh: bool,
    /// Do not look for the worst teeth to put the errors on.
    #[arg(long, alias = "no-mesh", conflicts_with = "mesh")]
    no_worst_teeth: bool,
    #[command(flatten)]
    decision: DecisionArgs,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
}

#[derive(Debug, Clone, Copy, Default, ValueEnum)]
pub(super) enum StackArg {
    /// The worst case: what these errors can do wherever on the teeth they are.
    #[default]
    #[value(alias = "worst")]
    Range,
    /// Mean ± 3 standard deviations; no bound.
    Rss,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum ModelArg {
    /// Exact for rigid teeth.
    #[default]
    Exact,
    /// As the paper prints it.
    Paper,
}

impl From<StackArg> for Stack {
    fn from(stack: StackArg) -> Self {
        match stack {
            StackArg::Range => Self::Range,
            StackArg::Rss => Self::Rss,
        }
    }
}

impl From<ModelArg> for Model {
    fn from(model: ModelArg) -> Self {
        match model {
            ModelArg::Exact => Self::Exact,
            ModelArg::Paper => Self::Paper,
        }
    }
}

impl Args {
    pub(super) fn run(mut self, output: &mut Output) -> Result<Status, Failure> {
        let path = match self.spec.take() {
            Some(path) => path,
            None => self.decision.spec_behind_monte_carlo().ok_or_else(|| {
                Diagnostic::error(Code::Usage, "no spec is given").help("write `rackmesh eval rack.toml --monte-carlo`")
            })?,
        };
        let spec = with_known_teeth(self.set.read_spec(&path, output)?, &path)?;
        let basis = spec.basis()?;
        let (mut evaluation, uncertainty) =
            judged(&spec, &spec.part_deviations()?, &basis, &self.decision, self.model.into(), self.stack.into())?;
        if !self.no_worst_teeth {
            evaluation.reached = teeth::reached(&spec, &basis)?;
        }
        for target in evaluation.not_given() {
            output.diagnostic(&unjudged(&spec, target));
        }
        let missing = spec.missing_geometry();
        let mut report =
            EvaluationReport::new(spec.title.as_deref(), &evaluation, &missing).with_classes(spec.classes()?);
        report.notes.extend(spec.suspicions_in_words());
        report.rule = self.decision.rule(&spec);
        report.uncertainty = uncertainty;
        if self.mesh {
            report.mesh = Some(mesh_part(&spec, &path)?);
        }
        output.report(&report, self.format)?;
        Ok(status(&evaluation))
    }
}

/// Evaluates a part's errors by what is known of the pair and decides by its rule, with what is known of their
/// uncertainty.
pub(super) fn judged(
    spec: &Spec,
    errors: &[PartDeviation],
    basis: &Basis,
    decision: &DecisionArgs,
    model: Model,
    stack: Stack,
) -> Result<(Evaluation, Option<UncertaintyPart>), Failure> {
    let mut evaluation =
        evaluate(errors, &spec.limits(), model, stack, basis).map_err(|failure| spec.explain_failure(&failure))?;
    let uncertainty = decision.judge(spec, errors, basis, &mut evaluation)?;
    Ok((evaluation, uncertainty))
}

/// How a command ends that evaluated one part.
pub(super) fn status(evaluation: &Evaluation) -> Status {
    match evaluation.verdict {
        Some(Verdict::Fail) => Status::Fail,
        Some(Verdict::Pass) => Status::Pass,
        Some(Verdict::Indeterminate) => Status::Indeterminate,
        None if evaluation.limits.is_empty() => Status::Pass,
        None => Status::Undecided,
    }
}

/// The exact mesh of the spec, in short.
fn mesh_part(spec: &Spec, path: &str) -> Result<MeshPart, Failure> {
    const STROKE_MM: (f64, f64) = (0.0, 50.0);
    const TOLERANCE_MM: f64 = 1e-6;
    let input = spec.mesh(&mesh::measured_tables(spec, path)?)?;
    let curve = input.mesh.curve(STROKE_MM.0, STROKE_MM.1, TOLERANCE_MM).map_err(|error| mesh::unsolved(&error))?;
    let summary = curve
        .summary(&input.mesh)
        .ok_or_else(|| Diagnostic::error(Code::NoMesh, "the exact mesh has no points along the stroke"))?;
    Ok(MeshPart { stroke_mm: STROKE_MM, summary, notes: mesh::notes(&input) })
}

pub(super) fn unjudged(spec: &Spec, target: LimitTarget) -> Diagnostic {
    let message = format!("there is a limit on ΔCD of the {target}, but [errors] does not give that error");
    let diagnostic = Diagnostic::warning(Code::UnjudgedLimit, message)
        .help(format!("add `{}` to [errors], or remove its limit", target.key()));
    match spec.limits.iter().find(|(on, _)| *on == target) {
        Some((_, limit)) => diagnostic.at(&spec.source, limit.span.clone(), "cannot be judged"),
        None => diagnostic,
    }
}
