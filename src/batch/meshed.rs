//! The exact mesh of parts whose errors are all on every tooth: its extremes where the bound does not pass them, and the
//! figures of a yoke. The results of a block ask for it.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::plan::Plan;
use super::uncertain::{RowUncertainty, Uncertain};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::Diagnostics;
use crate::function::{Judged, JudgedYoke, YokeJudge};
use crate::judge::Interval;
use crate::judge::bound::Basis;
use crate::mesh::TOLERANCE_MM;
use crate::spec::{SolvedTeeth, Spec};

/// The result of a part's mesh.
pub(super) struct Meshed {
    /// From its lowest to its highest ΔCD.
    pub(super) range: Interval,
    /// The uncertainty of both, if it is computed.
    pub(super) uncertainty: Option<RowUncertainty>,
}

/// A part in the mesh, or why that has no answer.
pub(super) type MeshAnswer = Arc<Result<Meshed, String>>;

/// The parts that were meshed; equal parts once.
pub(super) struct Meshes<'a> {
    known: HashMap<Vec<u64>, MeshAnswer>,
    /// The yoke's figures of these parts.
    yokes: HashMap<Vec<u64>, Arc<JudgedYoke>>,
    /// Ends the run.
    pub(super) stop: &'a AtomicBool,
}

/// The most parts that are kept.
const MOST_KEPT: usize = 4096;

impl<'a> Meshes<'a> {
    /// No parts so far.
    pub(super) fn new(stop: &'a AtomicBool) -> Self {
        Self { known: HashMap::new(), yokes: HashMap::new(), stop }
    }

    /// The answer for a part with these errors, a value per source of the plan; `None` once the run is to stop.
    pub(super) fn answer(&mut self, plan: &Plan, values: &[DeviationValue]) -> Option<MeshAnswer> {
        if self.stop.load(Ordering::Relaxed) {
            return None;
        }
        Some(kept(&mut self.known, values, || meshed(plan, values)))
    }

    /// The yoke's figures of a part with these errors, all of them on all teeth.
    pub(super) fn yoke(&mut self, plan: &Plan, yoke: &YokeJudge, values: &[DeviationValue]) -> Arc<JudgedYoke> {
        let unsolved = || yoke.unknown(yoke.open(&Judged::Unsolved));
        kept(&mut self.yokes, values, || yoke_on(plan, yoke, values).unwrap_or_else(unsolved))
    }
}

/// The result for a part with these values, kept or computed now.
fn kept<T>(known: &mut HashMap<Vec<u64>, Arc<T>>, values: &[DeviationValue], find: impl FnOnce() -> T) -> Arc<T> {
    let key: Vec<_> = values.iter().map(|value| value.base().to_bits()).collect();
    if let Some(known) = known.get(&key) {
        return Arc::clone(known);
    }
    let found = Arc::new(find());
    if known.len() == MOST_KEPT {
        known.clear();
    }
    known.insert(key, Arc::clone(&found));
    found
}

/// The part of the plan's spec with these errors.
fn part(plan: &Plan, values: &[DeviationValue]) -> Spec {
    let kinds = plan.sources.iter().map(|source| source.law.kind());
    plan.spec.with_errors(&kinds.zip(values.iter().copied()).collect::<Vec<_>>())
}

/// The yoke's figures of a part; `None` where its mesh has no solution.
fn yoke_on(plan: &Plan, yoke: &YokeJudge, values: &[DeviationValue]) -> Option<JudgedYoke> {
    let input = part(plan, values).mesh_of_all_teeth(&plan.spec.measured).ok()??;
    let (from, to) = yoke.strokes_mm;
    let curve = input.mesh.curve(from, to, TOLERANCE_MM).ok()?;
    let function = yoke.on(&input.mesh, &curve).ok()??;
    let is_measured = input.measures(&function);
    Some(yoke.known(function, is_measured).in_short())
}

fn meshed(plan: &Plan, values: &[DeviationValue]) -> Result<Meshed, String> {
    let spec = part(plan, values);
    let solved = spec.solved().unwrap_or_else(|| Err("something is left to place".to_owned()))?;
    let range = Interval::nearest(solved.teeth.range).map_err(|problem| problem.to_string())?;
    let uncertainty = plan.uncertain.as_ref().map(|_| uncertain(plan, spec, solved, values)).transpose()?;
    Ok(Meshed { range, uncertainty })
}

/// The uncertainty of the extremes of a part's mesh.
fn uncertain(
    plan: &Plan,
    spec: Spec,
    solved: SolvedTeeth,
    values: &[DeviationValue],
) -> Result<RowUncertainty, String> {
    let basis = Basis { all_placed: Some(solved.teeth.range), ..plan.basis.clone() };
    let spec = Spec { teeth_sensitivities: solved.sensitivities, ..spec };
    let uncertain = Uncertain::new(&spec, &plan.sources, &plan.request, &basis);
    let uncertain = uncertain.map_err(|problems: Diagnostics| problems.to_string())?;
    let delta_cd = |kind: DeviationKind| {
        let of_kind = plan.sources.iter().zip(values).find(|(source, _)| source.law.kind() == kind);
        let delta_cd = of_kind.map(|(source, value)| source.law.delta_cd(*value, plan.request.model));
        delta_cd.and_then(Result::ok).unwrap_or_default()
    };
    uncertain.of_row(&plan.sources, values, delta_cd, &plan.limits).map_err(|problem| problem.to_string())
}
