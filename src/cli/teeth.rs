//! Teeth that a spec knows one by one: their mesh is solved before anything is judged. Shared by the subcommands that
//! judge errors.

use super::decision::DecisionArgs;
use super::eval;
use super::mesh::{measured_tables, unsolved};
use super::output::Failure;
use crate::diagnostic::{Code, Diagnostic};
use crate::evaluation::{Evaluation, JudgedBy, LimitCheck};
use crate::formula::{Model, PartDeviation};
use crate::gear::Pair;
use crate::judge::bound::{Basis, ExtendedError, GivenGeometry, KnownTeeth, Open, Range};
use crate::judge::reached::{self, Placement, Reached};
use crate::judge::strokes::{Followed, StrokesError};
use crate::judge::{Interval, Limit, LimitTarget, Stack, Verdict};
use crate::mesh::{Mesh, Support};
use crate::spec::Spec;

/// The spec, with what its teeth do if it knows them one by one; `path` is where it was read.
pub(super) fn with_known_teeth(spec: Spec, path: &str) -> Result<Spec, Failure> {
    if !spec.has_deviations() {
        return Ok(spec);
    }
    let tables = measured_tables(&spec, path)?;
    // that a part is not given both ways is known from here on
    let input = spec.mesh(&tables)?;
    let strokes = input.judged_strokes().map_err(|error| no_strokes(&error))?;
    let followed = Followed::of(&input.mesh);
    let extremes = followed.extremes(&input.mesh, &strokes).map_err(|error| unsolved(&error))?;
    let sensitivities = spec.teeth_sensitivities(&tables, &input.mesh, &extremes, followed.tolerance_mm)?;
    let certain = spec.certain_teeth(&tables);
    Ok(spec.with_known_teeth(KnownTeeth { range: followed.judged(&extremes) }, sensitivities, certain))
}

fn no_strokes(error: &StrokesError) -> Failure {
    match error {
        StrokesError::Mesh(error) => unsolved(error),
        other => Diagnostic::error(Code::NoMesh, other.to_string()).into(),
    }
}

/// What is held against the limit of the combination, and who says so.
pub(super) struct Judged {
    pub(super) range: Result<Interval, Open>,
    pub(super) by: JudgedBy,
    /// One for each limit, by the spec's rule.
    pub(super) checks: Vec<LimitCheck>,
    /// Of all of them; `None` if there is none, or one has nothing to hold against it.
    pub(super) verdict: Option<Verdict>,
    basis: Basis,
}

impl Judged {
    /// Of a spec whose known teeth are solved.
    pub(super) fn new(spec: &Spec) -> Result<Self, Failure> {
        let (errors, basis) = (spec.part_errors_or_none()?, spec.basis()?);
        let decision = DecisionArgs::of_spec();
        let (evaluation, _) = eval::judged(spec, &errors, &basis, &decision, Model::Exact, Stack::Range)?;
        let Evaluation { combined, judged_by, limits, verdict, .. } = evaluation;
        Ok(Self { range: combined.range, by: judged_by, checks: limits, verdict, basis })
    }

    /// The mesh of the worst placement found: at the end that is nearer to the limit, or the upper one.
    pub(super) fn worst_mesh(&self, spec: &Spec, pair: &Pair, limit: Option<&Limit>) -> Result<Option<Mesh>, Failure> {
        let Some(reached) = worst_placements(&spec.part_deviations()?, &self.basis)? else { return Ok(None) };
        let below = limit.and_then(|limit| limit.lower).map_or(f64::INFINITY, |lower| reached.lower_mm - lower.mm());
        let above = limit.and_then(|limit| limit.upper).map_or(f64::INFINITY, |upper| upper.mm() - reached.upper_mm);
        let Placement { rack, pinion, .. } = if below < above { reached.lower } else { reached.upper };
        // only racks that do not roll have worst placements
        let mesh = Mesh::new(*pair, rack, pinion, Support::Fixed).map_err(|error| unsolved(&error))?;
        Ok(Some(mesh))
    }
}

/// What the errors of a spec reach, if there is a limit to hold it against.
pub(super) fn reached(spec: &Spec, basis: &Basis) -> Result<Option<Interval>, Failure> {
    if !spec.limits.iter().any(|(on, _)| *on == LimitTarget::CenterDistance) {
        return Ok(None);
    }
    reached_by(&spec.part_deviations()?, basis)
}

/// What errors reach on the worst teeth that a search finds, if the whole pair is known; nothing beside known teeth, or with a
/// rack that may roll.
pub(super) fn reached_by(errors: &[PartDeviation], basis: &Basis) -> Result<Option<Interval>, Failure> {
    let Some(Reached { lower_mm, upper_mm, .. }) = worst_placements(errors, basis)? else { return Ok(None) };
    let interval = Interval::nearest(Range { lower: lower_mm, upper: upper_mm });
    Ok(Some(interval.map_err(|error| Diagnostic::error(Code::NoResult, error.to_string()))?))
}

/// The worst placements that a search finds, where there are any to be found.
fn worst_placements(errors: &[PartDeviation], basis: &Basis) -> Result<Option<Reached>, Failure> {
    let GivenGeometry::Known(pairs) = &basis.geometry else { return Ok(None) };
    if basis.known_teeth.is_some() || errors.is_empty() {
        return Ok(None);
    }
    let errors: Result<Vec<_>, _> = errors.iter().map(ExtendedError::of).collect();
    // errors that are too large for a bound are too large for a mesh
    let Ok(errors) = errors else { return Ok(None) };
    match reached::reached(&errors, pairs.given()) {
        Ok(reached) => Ok(reached),
        Err(error) => Err(Diagnostic::error(Code::NoMesh, error.to_string())
            .help("`--no-worst-teeth` judges without looking for the worst teeth")
            .into()),
    }
}
