//! What a yoke does, judged for the subcommands that solve the mesh.

use std::ops::Range;

use super::output::{Failure, Output, Status};
use super::teeth::WorstTeeth;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::evaluation::{Evaluation, worse};
use crate::function::{Bounded, Bounds, Check, Function, SafeSettings, Target, Terms, judge, lift_off_per_newton};
use crate::judge::Rule;
use crate::mesh::{Curve, Mesh};
use crate::report::{BoundPart, FunctionPart, YokeSection};
use crate::spec::{MeasuredTables, MeshInput, Origin, Spec, keys};

/// What the yoke of a spec does on a curve of its mesh, if it has one; `knows_travel` says whether the curve's strokes are the
/// rack's travel. Where the errors' teeth are not known the bound of ΔCD proves a pass, and the curve a fail.
pub(super) fn part(
    spec: &Spec,
    input: &MeshInput,
    curve: &Curve,
    knows_travel: bool,
    evaluation: &Evaluation,
) -> Result<Option<FunctionPart>, Failure> {
    let Some(function) = function(spec, &input.mesh, curve)? else { return Ok(None) };
    let (yoke, limits) = (spec.yoke()?, spec.function_limits());
    let is_known = matches!(input.origin, Origin::Teeth | Origin::AllTeeth) && input.left_out.is_empty();
    let checks = if is_known {
        let is_measured = is_measured(input, &function);
        judge(&function, &yoke, &limits, Terms { knows_travel, is_measured, is_by_value: is_by_value(spec) })
    } else {
        by_bound(spec, &input.mesh, evaluation, std::slice::from_ref(&function))?
    };
    Ok(Some(FunctionPart { yoke, function, window: window(spec), checks, is_known }))
}

/// What the yoke does on a curve, if there is one.
fn function(spec: &Spec, mesh: &Mesh, curve: &Curve) -> Result<Option<Function>, Failure> {
    if !spec.has_yoke() {
        return Ok(None);
    }
    Ok(Function::of(mesh, curve, &spec.yoke()?, window(spec).as_ref().map(Bounds::window).as_ref())?)
}

/// Whether every flank that carries over the strokes, and where the play is set, was measured, if its part was.
fn is_measured(input: &MeshInput, function: &Function) -> bool {
    if input.rack_rows.is_empty() && input.pinion_rows.is_empty() {
        return true;
    }
    let (from, to) = function.strokes_mm;
    let (from, to) = (from.min(function.set_at_mm), to.max(function.set_at_mm));
    let covers = |strokes: &Range<f64>| strokes.start <= from && to <= strokes.end;
    let strokes = input.judged_strokes();
    strokes.is_ok_and(|strokes| input.rack_rows.is_empty() || strokes.iter().any(covers))
}

/// The permitted play.
fn window(spec: &Spec) -> Option<Bounds> {
    spec.function_limits().into_iter().find(|(on, _)| *on == Target::YokePlay).map(|(_, bounds)| bounds)
}

fn is_by_value(spec: &Spec) -> bool {
    spec.get(keys::DECISION_RULE).is_none_or(|rule| rule == Rule::Simple)
}

/// What a bound of ΔCD says of a yoke, with what it does where a search put the errors.
fn bounded<'a>(spec: &Spec, mesh: &Mesh, evaluation: &Evaluation, reached: &'a [Function]) -> Option<Bounded<'a>> {
    let range = evaluation.combined.range.ok()?;
    let width_mm = (range.upper - range.lower).mm();
    let open = Bounds::default();
    let safe = SafeSettings::of(&window(spec).unwrap_or(open).window(), width_mm);
    let lift_off = lift_off_per_newton(mesh.pair(), spec.get(keys::YOKE_FRICTION_TEETH).unwrap_or(0.0));
    Some(Bounded { safe, lift_off, reached })
}

/// The limits judged by the bound and by placements; open if there is no bound.
fn by_bound(
    spec: &Spec,
    mesh: &Mesh,
    evaluation: &Evaluation,
    reached: &[Function],
) -> Result<Vec<Check>, Diagnostics> {
    let (yoke, limits) = (spec.yoke()?, spec.function_limits());
    let Some(bounded) = bounded(spec, mesh, evaluation, reached) else { return Ok(Check::all_unproven(&limits)) };
    Ok(bounded.judge(&yoke, &limits, is_by_value(spec)))
}

/// What the yoke of a spec does as far as its errors tell, for a spec whose geometry is known: on the curve over the travel where
/// both parts' teeth are, or else by the bound.
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
    if let Some(input) = known {
        let (from, to) = spec.travel_mm().unwrap_or(super::mesh::STROKE_MM);
        let curve = input.mesh.curve(from, to, super::mesh::TOLERANCE_MM)?;
        let part = part(spec, &input, &curve, spec.travel_mm().is_some(), evaluation)?;
        return Ok(part.map(|part| YokeSection::Known(Box::new(part))));
    }
    let pair = spec.pair("the yoke")?;
    let nominal = Mesh::nominal(pair)?;
    let turn = pair.rack().pitch_mm * f64::from(pair.pinion().teeth);
    let error_free = function(spec, &nominal, &nominal.curve(0.0, turn, super::mesh::TOLERANCE_MM)?)?;
    let travel = spec.travel_mm().map_or(f64::INFINITY, |(from, to)| to - from);
    let mut reached = Vec::new();
    for (mesh, stroke_mm) in worst.map(|worst| worst.meshes(pair)).transpose()?.into_iter().flatten() {
        // a placement holds for strokes within a few pitches, wherever on the rack they are
        let half = (PITCHES * pair.rack().pitch_mm).min(0.5 * travel);
        let curve = mesh.curve(stroke_mm - half, stroke_mm + half, super::mesh::TOLERANCE_MM)?;
        reached.extend(function(spec, &mesh, &curve)?);
    }
    let checks = by_bound(spec, &nominal, evaluation, &reached)?;
    let bounded = bounded(spec, &nominal, evaluation, &reached);
    let part = BoundPart::new(spec.yoke()?, window(spec), bounded.as_ref(), error_free, checks);
    Ok(Some(YokeSection::Bounded(Box::new(part))))
}

/// Pitches on either side of the stroke at which errors were placed.
const PITCHES: f64 = 3.0;

/// Leaves the limits open that a spec has for what its yoke does, in a command that does not judge them.
pub(super) fn leave_open(spec: &Spec, output: &mut Output) {
    if let Some((on, bounds)) = spec.function_limits.first() {
        let message =
            format!("limits.{} is not judged here, where no curve of the mesh is solved for a yoke", on.name());
        let why = Diagnostic::warning(Code::UnjudgedLimit, message);
        let help = "`rackmesh mesh` judges it, with what the yoke does along the travel";
        output.leave_open(&why.help(help).at(&spec.source, bounds.span.clone(), "stays open"));
    }
}

/// How a command ends that judged a yoke by these limits.
pub(super) fn status(checks: &[Check]) -> Status {
    let verdicts = checks.iter().map(|check| check.verdict).reduce(worse);
    verdicts.map_or(Status::Pass, |verdict| verdict.map_or(Status::Undecided, Status::from))
}
