//! What the exact mesh says of parts whose errors are all on every tooth, where the bound does not pass them. Asked by the
//! results of a block; holds nothing against a limit.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::plan::Plan;
use super::uncertain::{RowUncertainty, Uncertain};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::Diagnostics;
use crate::judge::Interval;
use crate::judge::bound::Basis;
use crate::spec::{SolvedTeeth, Spec};

/// What the mesh says of a part.
pub(super) struct Meshed {
    /// From its lowest to its highest ΔCD.
    pub(super) range: Interval,
    /// What is uncertain about these, if that is computed.
    pub(super) uncertainty: Option<RowUncertainty>,
}

/// A part in the mesh, or why that has no answer.
pub(super) type MeshAnswer = Arc<Result<Meshed, String>>;

/// The parts that were meshed: those that are equal once.
pub(super) struct Meshes<'a> {
    known: HashMap<Vec<u64>, MeshAnswer>,
    /// Ends the run.
    pub(super) stop: &'a AtomicBool,
}

/// Parts that are kept at most.
const MOST_KEPT: usize = 4096;

impl<'a> Meshes<'a> {
    /// None so far.
    pub(super) fn new(stop: &'a AtomicBool) -> Self {
        Self { known: HashMap::new(), stop }
    }

    /// The answer for a part with these errors, a value per source of the plan; `None` once the run is to stop.
    pub(super) fn answer(&mut self, plan: &Plan, values: &[DeviationValue]) -> Option<MeshAnswer> {
        if self.stop.load(Ordering::Relaxed) {
            return None;
        }
        let key: Vec<_> = values.iter().map(|value| value.base().to_bits()).collect();
        if let Some(known) = self.known.get(&key) {
            return Some(Arc::clone(known));
        }
        let answer = Arc::new(meshed(plan, values));
        if self.known.len() == MOST_KEPT {
            self.known.clear();
        }
        self.known.insert(key, Arc::clone(&answer));
        Some(answer)
    }
}

fn meshed(plan: &Plan, values: &[DeviationValue]) -> Result<Meshed, String> {
    let kinds = plan.sources.iter().map(|source| source.law.kind());
    let spec = plan.spec.with_errors(&kinds.zip(values.iter().copied()).collect::<Vec<_>>());
    let solved = spec.solved().unwrap_or_else(|| Err("something is left to place".to_owned()))?;
    let range = Interval::nearest(solved.teeth.range).map_err(|problem| problem.to_string())?;
    let uncertainty = plan.uncertain.as_ref().map(|_| uncertain(plan, spec, solved, values)).transpose()?;
    Ok(Meshed { range, uncertainty })
}

/// What is uncertain about the extremes of a part's mesh.
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
