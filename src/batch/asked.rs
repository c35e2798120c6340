//! The request for each part, before anything is computed: which errors the table has, which outputs and limits need them,
//! and what cannot be answered.

use std::sync::Arc;

use super::output::{Output, SaidOfYoke};
use super::request::{Request, Rows};
use super::source::{Source, error_columns, index_of, sources};
use crate::chance::MonteCarloError;
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::function::KNOWN_FIGURES;
use crate::judge::bound::{Basis, GivenGeometry};
use crate::judge::{LimitTarget, Limits, Rule};
use crate::mesh::Support;
use crate::spec::Spec;
use crate::table::Table;

/// The request for each part, as far as it is known before the spec's single teeth are solved.
pub(super) struct Asked {
    /// The spec, with what it says of the table's columns.
    pub(super) spec: Arc<Spec>,
    pub(super) sources: Vec<Source>,
    pub(super) present: Vec<DeviationKind>,
    pub(super) outputs: Vec<Output>,
    /// The limits that can be judged.
    pub(super) limits: Limits,
    pub(super) unjudged: Vec<LimitTarget>,
    pub(super) lacking: Vec<DeviationKind>,
    /// The errors without which the parts are judged.
    pub(super) without: Vec<String>,
    pub(super) is_uncertain: bool,
}

impl Asked {
    pub(super) fn new(spec: &Arc<Spec>, table: &Table, request: &Request) -> Result<Self, Diagnostics> {
        let columns = error_columns(table)?;
        let in_table: Vec<_> = columns.iter().filter_map(|column| column.kind).collect();
        spec.refuse_both_ways(&in_table)?;
        let spec = &Arc::new(spec.for_columns(&in_table));
        let of_every_part = spec.errors_of_every_part(&in_table)?;
        let lacking = spec.lacking(&in_table);
        let is_present =
            |kind: &DeviationKind| in_table.contains(kind) || of_every_part.iter().any(|error| error.kind() == *kind);
        let present: Vec<_> = DeviationKind::ALL.into_iter().filter(is_present).collect();
        let limits = spec.limits();
        let is_uncertain = !spec.uncertainties_of(&present)?.is_empty();
        if !is_uncertain {
            refuse_without_uncertainty(&request.rule, request.monte_carlo.is_some())?;
        }
        let limited: Vec<_> = limits.iter().map(|(on, _)| *on).collect();
        let yoke = SaidOfYoke { is_given: spec.has_yoke(), is_limited: !spec.function_limits.is_empty() };
        let mut outputs = Output::asked(table, request, &present, &limited, is_uncertain, yoke)?;
        let needed = |kind: &DeviationKind| {
            let is_limited = yoke.is_limited
                || limited.contains(&LimitTarget::CenterDistance)
                || limited.contains(&LimitTarget::Error(*kind));
            is_limited || outputs.iter().any(|output| output.needs(*kind))
        };
        let needed: Vec<_> = present.iter().copied().filter(needed).collect();
        let sources = sources(spec, &needed, &columns, &of_every_part, &limits)?;
        // a rule that needs uncertainties judges no error without one
        let uncertainties = spec.uncertainties_of(&present)?;
        let is_certain = |kind: &DeviationKind| uncertainties.of(crate::uncertainty::Influence::Error(*kind)).is_none();
        let lacks_uncertainty = request.rule.needs_uncertainty() && !request.partial && in_table.iter().any(is_certain);
        let is_read = |on: LimitTarget| match on {
            _ if lacks_uncertainty => false,
            LimitTarget::CenterDistance => lacking.is_empty() || request.partial,
            LimitTarget::Error(kind) => index_of(&sources, kind).is_some(),
        };
        let (judged, unjudged): (Limits, Limits) = limits.into_iter().partition(|(on, _)| is_read(*on));
        let unjudged: Vec<_> = unjudged.into_iter().map(|(on, _)| on).collect();
        outputs.retain(|output| !matches!(output, Output::Conformance(on) if unjudged.contains(on)));
        if request.columns.is_none() {
            let knows_teeth = sources.iter().all(|source| source.extended.is_on_all_teeth());
            let is_other = |figure: usize| (figure < KNOWN_FIGURES) != knows_teeth;
            outputs.retain(|output| !matches!(output, Output::Yoke(figure) if is_other(*figure)));
        }
        let mut without = Vec::new();
        if request.partial {
            without.extend(lacking.iter().map(|kind| kind.key().to_owned()));
            let exact = in_table.iter().filter(|kind| request.rule.needs_uncertainty() && is_certain(kind));
            without.extend(exact.map(|kind| format!("uncertainty of {}", kind.key())));
        }
        if !without.is_empty() {
            outputs.push(Output::Without);
        }
        if request.rows == Rows::Every && !outputs.contains(&Output::Reason) {
            outputs.push(Output::Reason);
        }
        if asks_for_reached(&outputs) && spec.has_deviations() {
            return Err(unreached_by_known_teeth().into());
        }
        let spec = Arc::clone(spec);
        Ok(Self { spec, sources, present, outputs, limits: judged, unjudged, lacking, without, is_uncertain })
    }
}

pub(super) fn asks_for_reached(outputs: &[Output]) -> bool {
    outputs.iter().any(|output| matches!(output, Output::Reached(_)))
}

fn unreached_by_known_teeth() -> Diagnostic {
    Diagnostic::error(Code::NoMesh, "--worst-teeth puts errors on teeth, and the spec knows teeth one by one")
}

/// Refuses a search for the worst teeth of a pair that is not known, or whose rack may roll.
pub(super) fn refuse_unreached(spec: &Spec, basis: &Basis) -> Result<(), Diagnostic> {
    let message = match &basis.geometry {
        _ if basis.known_teeth.is_some() => return Err(unreached_by_known_teeth()),
        GivenGeometry::Known(pairs) if pairs.given().support == Support::Fixed => return Ok(()),
        GivenGeometry::Known(_) => "--worst-teeth puts errors on teeth of a rack that does not roll".to_owned(),
        GivenGeometry::Unknown | GivenGeometry::BothFlanks => {
            let missing = spec.missing_geometry().into_iter().map(|key| format!("`{key}`")).collect::<Vec<_>>();
            format!("--worst-teeth needs the pair's geometry: {} missing", missing.join(", "))
        }
    };
    Err(Diagnostic::error(Code::NoMesh, message))
}

/// Refuses requests that need uncertainties where the spec gives none for the parts of a table.
///
/// # Errors
/// A diagnostic if parts are simulated, or the rule needs uncertainties.
pub fn refuse_without_uncertainty(rule: &Rule, is_simulated: bool) -> Result<(), Diagnostic> {
    if is_simulated {
        return Err(Diagnostic::error(Code::NoMonteCarlo, MonteCarloError::NothingUncertain.to_string())
            .help("give the errors an uncertainty, such as `rack_pitch = { u = \"0.8 um\" }`"));
    }
    if rule.needs_uncertainty() {
        let message = format!("the rule {rule} needs an uncertainty above 0, and the spec gives none");
        return Err(Diagnostic::error(Code::BadRule, message).help(
            "give the errors one, such as `rack_pitch = { u = \"0.8 um\" }`; or the guard band: --rule guard=VALUE",
        ));
    }
    Ok(())
}
