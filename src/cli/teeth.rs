//! Teeth that a spec gives one by one: their mesh is solved before anything is judged. Shared by the subcommands that judge
//! errors.

use std::path::Path;

use super::bar::SharedBar;
use super::decision::JudgeArgs;
use super::output::{Failure, Output};
use super::spec_files::measured_tables;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::evaluation::{Evaluation, evaluate};
use crate::formula::{Model, PartDeviation};
use crate::gear::Pair;
use crate::judge::bound::{Basis, ExtendedError, GivenGeometry, Range};
use crate::judge::reached::{self, Placement, Reached};
use crate::judge::{Interval, Limit, LimitTarget, PlacedError, Stack};
use crate::mesh::{Mesh, MeshError, Support};
use crate::spec::{MeasuredTables, MeshInput, Origin, Spec};

/// The spec, with the effect of teeth that it gives one by one; `path` is where it was read.
pub(super) fn with_known_teeth(spec: Spec, path: &Path, output: &mut Output) -> Result<Spec, Failure> {
    if !spec.has_deviations() {
        return Ok(spec);
    }
    let tables = measured_tables(&spec, path, output)?;
    // from here on no part is given in both ways
    let input = spec.mesh(&tables)?;
    let strokes = input.judged_strokes().map_err(Diagnostics::from)?;
    Ok(spec.with_known_teeth(&tables, &input.mesh, &strokes)?)
}

/// The mesh of a spec: with its errors on all teeth if they are, else on some teeth.
pub(super) fn mesh_of(spec: &Spec, tables: &MeasuredTables) -> Result<MeshInput, Diagnostics> {
    spec.mesh_of_all_teeth(tables)?.map_or_else(|| spec.mesh(tables), Ok)
}

/// The spec with the effect of its teeth, and its mesh with the errors of `[errors]` on the teeth where they are judged: on all, or
/// on the worst teeth that a search finds.
pub(super) fn placed(spec: Spec, path: &Path, output: &mut Output) -> Result<(Spec, MeshInput), Failure> {
    if spec.has_deviations() && !is_judged(&spec, output) {
        // the same specs are refused
        spec.refuse_both_ways(&spec.kinds())?;
        spec.pair_basis()?;
        let input = mesh_of(&spec, &measured_tables(&spec, path, output)?)?;
        return Ok((spec, input));
    }
    let spec = with_known_teeth(spec, path, output)?;
    let mut input = mesh_of(&spec, &measured_tables(&spec, path, output)?)?;
    if let Some(worst) = WorstTeeth::of(spec.part_errors_or_none()?, &spec.basis()?)? {
        worst.place(&mut input, spec.limit_on(LimitTarget::CenterDistance))?;
    }
    Ok((spec, input))
}

/// Whether a verdict is wanted, or what a yoke does with it.
fn is_judged(spec: &Spec, output: &Output) -> bool {
    output.needs_verdict() || spec.has_yoke()
}

/// The errors of a spec whose known teeth are solved, judged by its limits; an evaluation of nothing where no verdict is wanted.
pub(super) fn judged(spec: &Spec, judge: &JudgeArgs, output: &Output) -> Result<Evaluation, Failure> {
    if !is_judged(spec, output) {
        let nothing = evaluate(&[], &Vec::new(), Model::Exact, Stack::Range, &Basis::default());
        return Ok(nothing.map_err(|failure| spec.explain_failure(&failure))?);
    }
    let (mut evaluation, _) =
        judge.judged(spec, &spec.part_errors_or_none()?, &spec.basis()?, &SharedBar::new(output))?;
    judge.leave_open_without_uncertainty(spec, &mut evaluation);
    Ok(evaluation)
}

/// Errors on the worst teeth that a search finds.
pub(super) struct WorstTeeth {
    errors: Vec<PartDeviation>,
    reached: Reached,
}

impl WorstTeeth {
    /// The worst placements of these errors, if the whole pair is known; none beside known teeth, with a rack that may roll, or for
    /// errors on all teeth.
    pub(super) fn of(errors: Vec<PartDeviation>, basis: &Basis) -> Result<Option<Self>, Failure> {
        let GivenGeometry::Known(pairs) = &basis.geometry else { return Ok(None) };
        if basis.known_teeth.is_some() || errors.is_empty() {
            return Ok(None);
        }
        let extended: Result<Vec<_>, _> = errors.iter().map(ExtendedError::of).collect();
        // errors that are too large for a bound are too large for a mesh
        let Ok(extended) = extended else { return Ok(None) };
        if extended.iter().all(ExtendedError::is_on_all_teeth) {
            return Ok(None);
        }
        match reached::reached(&extended, pairs.given()) {
            Ok(reached) => Ok(reached.map(|reached| Self { errors, reached })),
            Err(error) => Err(Diagnostic::error(Code::NoMesh, error.to_string())
                .help("`--no-worst-teeth` judges without looking for the worst teeth")
                .into()),
        }
    }

    /// The meshes of both placements, with the strokes around which they hold, mm.
    pub(super) fn meshes(&self, pair: Pair) -> Result<[(Mesh, f64); 2], MeshError> {
        let of = |Placement { rack, pinion, stroke_mm, .. }: &Placement| {
            Ok((Mesh::new(pair, rack.clone(), pinion.clone(), Support::Fixed)?, *stroke_mm))
        };
        Ok([of(&self.reached.lower)?, of(&self.reached.upper)?])
    }

    /// The range of ΔCD.
    pub(super) fn interval(&self) -> Result<Interval, Failure> {
        let Reached { lower_mm, upper_mm, .. } = self.reached;
        let interval = Interval::nearest(Range { lower: lower_mm, upper: upper_mm });
        Ok(interval.map_err(Diagnostic::with_code(Code::NoResult))?)
    }

    /// Puts the errors of a mesh on these teeth: those of the end nearer to the limit, or of the upper end.
    pub(super) fn place(&self, input: &mut MeshInput, limit: Option<&Limit>) -> Result<(), Failure> {
        let reached = &self.reached;
        let below = limit.and_then(|limit| limit.lower).map_or(f64::INFINITY, |lower| reached.lower_mm - lower.mm());
        let above = limit.and_then(|limit| limit.upper).map_or(f64::INFINITY, |upper| upper.mm() - reached.upper_mm);
        let is_upper = below >= above;
        let Placement { rack, pinion, errors, .. } = if is_upper { &reached.upper } else { &reached.lower };
        // only racks that do not roll have worst placements
        input.mesh = Mesh::new(*input.mesh.pair(), rack.clone(), pinion.clone(), Support::Fixed)?;
        let placed =
            self.errors.iter().zip(errors).map(|(error, runs)| PlacedError { error: *error, runs: runs.clone() });
        input.origin = Origin::WorstTeeth { errors: placed.collect(), is_upper };
        Ok(())
    }
}
