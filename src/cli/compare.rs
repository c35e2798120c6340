//! `rackmesh compare`: specs side by side, what differs in them and what that does.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::held::{Answer, Facts};
use super::mesh::Stroke;
use super::output::{Failure, Output, Status};
use super::picture::{PlotArgs, draw};
use super::question::{Of, Question};
use super::results;
use super::set::SetArgs;
use super::signals;
use super::spec_files::files_read;
use super::target::is_dash;
use crate::deviation::key_in_words;
use crate::diagnostic::Diagnostic;
use crate::judge::{Limit, LimitTarget};
use crate::quantity::Length;
use crate::report::Format;
use crate::report::compare::{CompareReport, ComparedSpec};
use crate::spec::Spec;

pub(super) const ABOUT: &str = "Compare specs: what differs, and what that does to the results";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh compare old.toml new.toml
  rackmesh compare old.toml new.toml --plot curves.svg
  rackmesh compare a.toml b.toml c.toml --format json -- --stack rss

Values are compared in one unit: 0.01 mm is 10 um. Options of `eval` stand behind `--`.

Exit status: that of the worst spec: 0 inside limits or none given, 3 indeterminate, 2 could not judge, 1 outside;
129, 130 or 143 interrupted.")]
pub(super) struct Args {
    /// The gear specs (TOML), two or more; `-` reads standard input.
    #[arg(required = true, num_args = 2.., value_name = "SPEC")]
    specs: Vec<PathBuf>,
    #[command(flatten)]
    stroke: Stroke,
    #[command(flatten)]
    plot: PlotArgs,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
    /// Options of `eval`.
    #[arg(last = true, value_name = "OPTIONS")]
    options: Vec<String>,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        if self.specs.iter().filter(|path| is_dash(path)).count() > 1 {
            return Err(Diagnostic::usage("two specs cannot both come from standard input").into());
        }
        let specs = self.specs.iter().map(|path| self.set.read_spec(path, output)).collect::<Result<Vec<_>, _>>()?;
        let inputs: Vec<_> = specs.iter().zip(&self.specs).flat_map(|(spec, path)| files_read(spec, path)).collect();
        let picture = self.plot.picture(&inputs)?;
        let interruption = signals::interrupted(output);
        let ended = || interruption.status().unwrap_or(Status::Undecided);
        let (mut status, mut compared) = (Status::Pass, Vec::new());
        for (path, spec) in self.specs.iter().zip(&specs) {
            let ask = |of, options: &[String], facts| {
                let question = Question::new(of, options, (path, spec), interruption.stop())?;
                Ok::<_, Failure>(question.answer(&[], facts))
            };
            let Some(eval) = ask(Of::Eval, &self.options, Facts::All)? else { return Ok(ended()) };
            let missing: Vec<_> = spec.missing_geometry().into_iter().map(|key| format!("`{key}`")).collect();
            let mesh = if missing.is_empty() {
                ask(Of::Mesh, &self.stroke.options(), Facts::All)?
            } else {
                Some(Err(format!("it needs {}", missing.join(", "))))
            };
            let Some(mesh) = mesh else { return Ok(ended()) };
            eval.iter().flat_map(|answer| &answer.warnings).for_each(|warning| output.diagnostic(warning));
            let of_spec = Self::compared(path, spec, eval, mesh)?;
            status = status.max(Status::of_code(of_spec.exit_status));
            compared.push(of_spec);
        }
        let report = CompareReport(&compared);
        draw(picture, || report.chart(), true, output)?;
        output.report(&report, self.format)?;
        Ok(status)
    }

    /// A spec with the answers of its commands.
    fn compared(
        path: &Path,
        spec: &Spec,
        eval: Result<Answer, String>,
        mesh: Result<Answer, String>,
    ) -> Result<ComparedSpec, Failure> {
        let keys = spec.written(path)?;
        let limit = spec.limit_on(LimitTarget::CenterDistance).copied();
        let exit_status = eval.as_ref().map_or(Status::Undecided.code(), |answer| answer.status);
        let known = |what: &str, answer: Result<Answer, String>| match answer {
            Ok(answer) => (answer.json, None),
            Err(why) => (Value::Null, Some(format!("no {what}: {why}"))),
        };
        let ((eval, no_result), (mesh, no_mesh)) = (known("result", eval), known("mesh", mesh));
        let number = |point: &Value, name: &str| point.get(name).and_then(Value::as_f64);
        let points = mesh.get("points").and_then(Value::as_array).into_iter().flatten();
        let limits = ["/limits", "/yoke/limits"].map(|place| eval.pointer(place).and_then(Value::as_array));
        let failed = limits.into_iter().flatten().flatten().filter(|limit| limit["verdict"] == "fail");
        Ok(ComparedSpec {
            name: spec.source.name.clone(),
            title: spec.title.clone(),
            keys,
            curve: points.filter_map(|point| number(point, "stroke_mm").zip(number(point, "delta_cd_mm"))).collect(),
            limits: limit.into_iter().flat_map(Limit::ends).map(Length::mm).collect(),
            outside: failed.filter_map(|limit| Some(key_in_words(limit["on"].as_str()?))).collect(),
            results: results_of(&eval, &mesh),
            exit_status,
            notes: no_mesh.into_iter().collect(),
            no_result,
        })
    }
}

/// The results of both commands, those of the mesh with `mesh` before the name, and the verdict last.
fn results_of(eval: &Value, mesh: &Value) -> Vec<(String, Value)> {
    let of = |of: Of, answer: &Value| -> Vec<_> {
        let columns = results::all(of, answer).into_iter();
        columns.map(|column| (column.name.clone(), column.value(answer).cloned().unwrap_or_default())).collect()
    };
    let is_last = |(name, _): &(String, Value)| matches!(name.as_str(), "lower_mm" | "upper_mm" | "verdict" | "reason");
    let (last, mut all): (Vec<_>, Vec<_>) = of(Of::Eval, eval).into_iter().partition(is_last);
    // after these the mesh has the results that `eval` has, too
    let of_mesh = of(Of::Mesh, mesh).into_iter().take_while(|(name, _)| name != "nominal_center_distance_mm");
    all.extend(of_mesh.map(|(name, value)| (format!("mesh_{name}"), value)));
    all.extend(last);
    all
}
