//! The remarks on the result of a batch: what the tables lack, what every part has, why there is no range.

use crate::batch::Plan;
use crate::chance::MOST_ADAPTIVE_OF_MANY;
use crate::cli::output::Output;
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic};
use crate::judge::LimitTarget;
use crate::report;
use crate::spec::{Spec, WrittenError};

/// A remark on errors that the spec asks for and the tables lack.
fn lacking(spec: &Spec, kinds: &[DeviationKind], is_partial: bool) -> Option<String> {
    let keys = DeviationKind::keys(kinds.iter().copied());
    let consequence = if is_partial {
        "parts are judged without, as told by --partial"
    } else if kinds.iter().all(|kind| class(spec, *kind).is_some()) {
        "the sum is shown without and not judged; a class is what is permitted, not what a part has"
    } else {
        "the sum is shown without and not judged; every_part = true beside a value of [errors] says that every part has it, --partial judges without"
    };
    (!kinds.is_empty()).then(|| format!("the tables lack {keys}, which the spec asks for: {consequence}"))
}

/// Which values of the spec every part has.
fn of_every_part(kinds: &[DeviationKind]) -> Option<String> {
    let keys = DeviationKind::keys(kinds.iter().copied());
    (!kinds.is_empty()).then(|| format!("every part has the value in [errors]: {keys}"))
}

/// The plan's remarks on the result.
pub(in crate::cli) fn notes(spec: &Spec, plan: &Plan) -> Vec<String> {
    let classes = plan.errors().filter_map(|kind| Some((kind, class(spec, kind)?)));
    let mut notes: Vec<_> = classes
        .map(|(kind, grade)| {
            let key = kind.key();
            format!("{key}: the table's values count; class {grade} in [errors] is not held against them, because limits stand in [limits]")
        })
        .collect();
    notes.extend(lacking(spec, &plan.lacking, plan.is_partial()));
    notes.extend(of_every_part(&plan.of_every_part().collect::<Vec<_>>()));
    notes.extend(plan.extents_in_words());
    notes.extend(spec.circles_in_words(&plan.errors().collect::<Vec<_>>()));
    let refused_by = Some(&plan.request.rule).filter(|rule| rule.needs_uncertainty() && !plan.unjudged.is_empty());
    notes.extend(spec.note_of_exact(&plan.taken_as_exact(), refused_by));
    if let Some(settings) = plan.request.monte_carlo.filter(|settings| settings.draws.is_none()) {
        notes.push(format!(
            "random draws of a part end at {MOST_ADAPTIVE_OF_MANY}, where u may not be stable to {} digits; linear_validated is empty \
             where these leave it open: --digits 1 needs fewer, --monte-carlo N makes more",
            settings.digits
        ));
    }
    if let Some(open) = plan.open() {
        let missing = spec.missing_geometry().into_iter().map(|key| format!("`{key}`")).collect::<Vec<_>>();
        let is_judged = plan.limits.iter().all(|(on, _)| *on != LimitTarget::CenterDistance);
        let what = if is_judged { "a worst case" } else { "a worst case or a verdict" };
        notes.push(format!("no part has {what}: {open}: {}", missing.join(", ")));
    }
    if plan.open().is_none() {
        let missing = spec.missing_geometry();
        notes.extend(plan.bound_notes().iter().map(|note| report::bound_note(note, &missing)));
    }
    let unstated = plan.unstated().into_iter().filter(|what| !what.is_default());
    let unstated: Vec<_> = unstated.map(report::unstated).collect();
    notes.extend((!unstated.is_empty()).then(|| format!("a pass assumes: {}", unstated.join(", "))));
    notes
}

/// A remark that parts have no names of their own.
pub(in crate::cli) fn without_names(plan: &Plan) -> Option<String> {
    let note =
        "the tables have no column `part_id`: parts are called by the number of their row; name the column with --id";
    (!plan.has_id).then(|| note.to_owned())
}

/// The class that `[errors]` gives for an error.
fn class(spec: &Spec, kind: DeviationKind) -> Option<u8> {
    spec.errors.iter().find_map(|(error, written)| match written.value {
        WrittenError::Class(grade) if *error == kind => Some(grade),
        _ => None,
    })
}

/// Says which limits are not judged, before the first row.
pub(in crate::cli) fn unjudged(plan: &Plan, output: &mut Output) {
    for target in &plan.unjudged {
        let message = match target {
            LimitTarget::Error(kind) if plan.errors().all(|error| error != *kind) => {
                format!("there is a limit on ΔCD of the {target}, but the table has no such column")
            }
            _ if plan.lacking.is_empty() => {
                format!("the limit on ΔCD of the {target} is not judged: something that the spec asks for is missing")
            }
            _ => {
                let keys = DeviationKind::keys(plan.lacking.iter().copied());
                format!(
                    "the limit on ΔCD of the {target} is not judged: the table lacks {keys}, which the spec asks for"
                )
            }
        };
        output.diagnostic(&Diagnostic::warning(Code::UnjudgedLimit, message));
    }
}
