//! The yoke and its limits, for the subcommands that solve the mesh.

use super::output::{Failure, Output, Status};
use super::teeth::WorstTeeth;
use crate::diagnostic::{Code, Diagnostic};
use crate::evaluation::{Evaluation, worse};
use crate::function::Check;
use crate::mesh::{Curve, Mesh, STROKE_MM, TOLERANCE_MM};
use crate::report::{BoundPart, FunctionPart, YokeSection};
use crate::spec::{MeasuredTables, MeshInput, Origin, Spec};

/// The yoke of a spec on a curve of its mesh, if it has one, over the rack's travel if that is known. Where the teeth of the errors
/// are not known the bound of ΔCD proves a pass, and the curve a fail.
pub(super) fn part(
    spec: &Spec,
    input: &MeshInput,
    curve: &Curve,
    travel_mm: Option<(f64, f64)>,
    evaluation: &Evaluation,
) -> Result<Option<FunctionPart>, Failure> {
    let Some(judge) = spec.yoke_judge(travel_mm, &evaluation.rule)? else { return Ok(None) };
    let Some(function) = judge.on(&input.mesh, curve)? else { return Ok(None) };
    let is_known = matches!(input.origin, Origin::Teeth | Origin::AllTeeth) && input.left_out.is_empty();
    let checks = if is_known {
        judge.judge(&function, input.measures(&function))
    } else {
        judge.by_bound(input.mesh.pair(), evaluation.range_width_mm(), std::slice::from_ref(&function))
    };
    Ok(Some(FunctionPart { yoke: judge.yoke, function, window: judge.window(), checks, is_known }))
}

/// The yoke of a spec by its errors, for a spec whose geometry is known: on the curve over the travel where the teeth of both parts
/// are known, else by the bound.
pub(super) fn evaluated(
    spec: &Spec,
    tables: &MeasuredTables,
    evaluation: &Evaluation,
    worst: Option<&WorstTeeth>,
) -> Result<Option<YokeSection>, Failure> {
    if !spec.has_yoke() || !spec.missing_geometry().is_empty() {
        return Ok(None);
    }
    let known = match spec.mesh_of_all_teeth(tables)? {
        None if spec.has_deviations() => Some(spec.mesh(tables)?).filter(|input| input.left_out.is_empty()),
        known => known,
    };
    let travel = spec.travel_mm();
    if let Some(input) = known {
        let (from, to) = travel.unwrap_or(STROKE_MM);
        let curve = input.mesh.curve(from, to, TOLERANCE_MM)?;
        let part = part(spec, &input, &curve, travel, evaluation)?;
        return Ok(part.map(|part| YokeSection::Known(Box::new(part))));
    }
    let Some(judge) = spec.yoke_judge(travel, &evaluation.rule)? else { return Ok(None) };
    let pair = spec.pair("the yoke")?;
    let nominal = Mesh::nominal(pair)?;
    let turn = pair.rack().pitch_mm * f64::from(pair.pinion().teeth);
    let error_free = judge.on(&nominal, &nominal.curve(0.0, turn, TOLERANCE_MM)?)?;
    let length = travel.map_or(f64::INFINITY, |(from, to)| to - from);
    let mut reached = Vec::new();
    for (mesh, stroke_mm) in worst.map(|worst| worst.meshes(pair)).transpose()?.into_iter().flatten() {
        // a placement holds for strokes within a few pitches, wherever on the rack they are
        let half = (PITCHES * pair.rack().pitch_mm).min(0.5 * length);
        reached.extend(judge.on(&mesh, &mesh.curve(stroke_mm - half, stroke_mm + half, TOLERANCE_MM)?)?);
    }
    let width = evaluation.range_width_mm();
    let checks = judge.by_bound(&pair, width, &reached);
    let bounded = width.map(|width| judge.bounded(&pair, width, &reached));
    let part = BoundPart::new(judge.yoke, judge.window(), bounded.as_ref(), error_free, checks);
    Ok(Some(YokeSection::Bounded(Box::new(part))))
}

/// Pitches on either side of the stroke at which errors were placed.
const PITCHES: f64 = 3.0;

/// Leaves the limits on a spec's yoke open, in a command that does not judge them, and says so.
pub(super) fn leave_open(spec: &Spec, output: &mut Output) -> Option<String> {
    let (_, first) = spec.function_limits.first()?;
    let names: Vec<_> = spec.function_limits.iter().map(|(on, _)| format!("limits.{}", on.name())).collect();
    let (are, them) = if names.len() == 1 { ("is", "it") } else { ("are", "them") };
    let open = format!("{} {are} not judged here", names.join(", "));
    let why = format!("{open}, where no curve of the mesh is solved for a yoke");
    let help = format!("`rackmesh mesh` judges {them}, with what the yoke does along the travel");
    let why = Diagnostic::warning(Code::UnjudgedLimit, why).help(help);
    output.leave_open(&why.at(&spec.source, first.span.clone(), "stays open"));
    Some(open)
}

/// The outcome of a command that judged a yoke by these limits.
pub(super) fn status(checks: &[Check]) -> Status {
    let verdicts = checks.iter().map(|check| check.verdict).reduce(worse);
    verdicts.map_or(Status::Pass, |verdict| verdict.map_or(Status::Undecided, Status::from))
}
