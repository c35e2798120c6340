//! The assumptions of verdicts and bounds, in words.

use super::number::{SEEN_MM, ends, interval_text, millimetres, plain, tidy};
use crate::deviation::DeviationKind;
use crate::evaluation::{Contribution, Evaluation, LimitCheck};
use crate::formula::Model;
use crate::judge::bound::{AssumedHeight, HeightFrom, Note, Range};
use crate::judge::{Interval, LimitTarget, Verdict};
use crate::quantity::Length;
use crate::uncertainty::Unstated;

/// An assumption of a pass; facts have its text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Assumption {
    text: String,
    /// Whether it is the default of keys that the spec leaves out, which the sentence of a pass does not have.
    is_default: bool,
}

impl serde::Serialize for Assumption {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.text)
    }
}

/// The assumptions of verdicts, a clause each; that of the error-free pair where the sum is judged.
#[must_use]
pub fn assumptions(notes: &[Note], sum_is_judged: bool, unstated: &[Unstated]) -> Vec<Assumption> {
    let clause = |note: &Note| match note {
        Note::OwnCurveAt(0.0) => sum_is_judged.then(|| "the error-free pair has ΔCD = 0".to_owned()),
        Note::OwnCurveAt(mm) => sum_is_judged.then(|| format!("the error-free pair has ΔCD = {} mm", plain(tidy(*mm)))),
        Note::AssumedHeight(AssumedHeight { mm, .. }) => {
            Some(format!("flanks touch within {} mm of the reference plane", plain(tidy(*mm))))
        }
        _ => None,
    };
    let unstated = unstated.iter().map(|what| (self::unstated(*what).to_owned(), what.is_default()));
    let known = notes.iter().filter_map(clause).map(|text| (text, false));
    known.chain(unstated).map(|(text, is_default)| Assumption { text, is_default }).collect()
}

/// An assumption of a verdict where nothing is stated.
#[must_use]
pub const fn unstated(what: Unstated) -> &'static str {
    match what {
        Unstated::Freedom => "ν = ∞ where no dof is given",
        Unstated::Correlation => "r = 0 where no correlation is given",
        Unstated::Size => "sizes without an uncertainty are exact",
        Unstated::RootForm => "the pinion's flanks are involutes down to the base circle",
        Unstated::Zero => "β_r, β_p and x are 0 where they are not given",
        Unstated::FixedRack => "the rack cannot roll",
        Unstated::Thickness => "teeth have their nominal thickness where none is given",
        Unstated::Form => "flanks have no form where none is given",
        Unstated::Extent => "an error without an extent has the usual one of its kind",
    }
}

/// The same of an evaluation.
pub(super) fn assumptions_of(evaluation: &Evaluation) -> Vec<Assumption> {
    let sum_is_judged = evaluation.limits.iter().any(|check| check.on == LimitTarget::CenterDistance);
    assumptions(&evaluation.notes, sum_is_judged, &evaluation.unstated)
}

/// The assumptions of a pass, as part of its sentence.
pub(super) fn assumed(assumptions: &[Assumption]) -> String {
    let shown = assumptions.iter().filter(|assumption| !assumption.is_default);
    match shown.map(|assumption| assumption.text.as_str()).collect::<Vec<_>>().as_slice() {
        [] => String::new(),
        [one] => format!(" if {one}"),
        [first @ .., last] => format!(" if {} and {last}", first.join(", ")),
    }
}

/// The assumptions of a bound, a remark each, the most important first; the keys that would narrow it are one remark.
#[must_use]
pub fn bound_remarks(notes: &[Note], missing: &[&str]) -> Vec<String> {
    let rank = |note: &&Note| match note {
        Note::GeometryNeeded => 0,
        Note::GeometryNarrows | Note::BothFlanksNarrows => 1,
        Note::OwnCurveAt(_) => 3,
        Note::WholeTeeth => 4,
        _ => 2,
    };
    let mut ranked: Vec<_> = notes.iter().collect();
    ranked.sort_by_key(rank);
    let are_one = |a: &&Note, b: &&Note| rank(a) == 1 && rank(b) == 1;
    let in_words = |notes: &[&Note]| notes.iter().map(|note| bound_note(note, missing)).collect::<Vec<_>>().join("; ");
    ranked.chunk_by(are_one).map(in_words).collect()
}

/// The assumptions of a bound, in words; with the `missing` keys of the pair's geometry.
#[must_use]
pub fn bound_note(note: &Note, missing: &[&str]) -> String {
    match note {
        Note::GeometryNarrows => {
            format!("Geometry incomplete, the bound is wider than it need be: {}", to_add(missing))
        }
        Note::BothFlanksNarrows => {
            "`contact = \"both flanks\"` below [pair] narrows it, too, if a tooth of either part always carries with both flanks"
                .to_owned()
        }
        Note::OwnCurveAt(0.0) => {
            "the pair without errors is taken to have ΔCD = 0: no undercut, a contact ratio of 1 or more".to_owned()
        }
        Note::OwnCurveAt(delta_cd_mm) => format!(
            "the pair without errors is taken to stay at ΔCD = {} mm, by its tooth thickness: no undercut, a contact ratio of 1 or more",
            plain(tidy(*delta_cd_mm))
        ),
        Note::OwnRange(Range { lower, upper }) => format!(
            "share of form and geometry in the bound (tooth thickness, form, undercut, gaps in contact): ΔCD = {} mm; it holds wherever \
             errors of this size shift the contact, so it may be wider than the curve of the pair without errors",
            ends(tidy(*lower), tidy(*upper))
        ),
        Note::KnownTeeth(Range { lower, upper }) => {
            format!("the sum counts the teeth that are known one by one: ΔCD = {} mm", ends(tidy(*lower), tidy(*upper)))
        }
        Note::OpenWithin(source) => format!(
            "no bound of ΔCD is known where {} is off by its uncertainty: the results are shown without uncertainties",
            source.key()
        ),
        Note::GeometryNeeded => format!("there is no worst case without the pair's geometry: {}", to_add(missing)),
        Note::AssumedHeight(AssumedHeight { mm, from }) => {
            let from = match from {
                HeightFrom::FaceWidth => "a quarter of the face width, as `pair.normal_module` is not given: a module above two thirds of that",
                HeightFrom::Module => "1.5 normal modules, as the pair's geometry is not given: higher teeth",
                HeightFrom::Addendum => "`rack.addendum`, as the pair's geometry is not given: a higher pinion",
            };
            let height = plain(tidy(*mm));
            format!("for the lead error flanks are taken to touch within {height} mm over and under the reference plane, {from} can leave the range")
        }
        Note::NothingScatters => {
            "nothing scatters, so there is no statistical sum: measured errors enter with their bound, and the worst case is judged".to_owned()
        }
        Note::WholeTeeth => {
            "pitch deviations of several teeth are shifts of whole teeth; where flank sides deviate apart, give F_p with \
             extent = \"total\""
                .to_owned()
        }
    }
}

/// The keys that complete the geometry.
fn to_add(keys: &[&str]) -> String {
    let keys: Vec<_> = keys.iter().map(|key| format!("`{key}`")).collect();
    if keys.is_empty() { "add what is missing of it".to_owned() } else { format!("add {}", keys.join(", ")) }
}

/// Why the ends of a worst case are not the sums of the ends that errors have alone, in a sentence; `None` if they are.
pub(super) fn why_ends_differ(
    errors: &[Option<Interval>],
    combined: Option<Interval>,
    notes: &[Note],
) -> Option<String> {
    let combined = combined.filter(|_| !errors.is_empty())?;
    let own = notes.iter().find_map(|note| match note {
        Note::OwnRange(range) | Note::KnownTeeth(range) => Some(*range),
        Note::OwnCurveAt(mm) => Some(Range { lower: *mm, upper: *mm }),
        _ => None,
    });
    let (mut lower, mut upper) = own.map_or((0.0, 0.0), |own| (own.lower, own.upper));
    for error in errors {
        let error = (*error)?;
        (lower, upper) = (lower + error.lower.mm(), upper + error.upper.mm());
    }
    let differs = |sum: f64, end: Length| (sum - end.mm()).abs() >= SEEN_MM;
    (differs(lower, combined.lower) || differs(upper, combined.upper)).then(|| {
        "the worst case is not the sum of the errors' own ranges: an error that lifts a tooth out of contact lets another \
         one lower ΔCD in full, and not all errors raise ΔCD at the same stroke"
            .to_owned()
    })
}

/// Where a formula of a lead error gives more than the error's bound.
pub(super) fn beyond_bound(error: &Contribution, model: Model) -> Option<String> {
    let (formula, most) = (error.delta_cd(model).mm(), error.range.ok()?.upper.mm());
    let is_lead = matches!(error.kind, DeviationKind::RackLead | DeviationKind::PinionLead);
    (is_lead && formula > most + SEEN_MM).then(|| {
        format!(
            "the formula of the {} counts the ends of its own face, where the other part does not reach: {} mm, and in the worst \
             case {} mm",
            error.kind,
            millimetres(formula),
            millimetres(most)
        )
    })
}

/// For a failed limit on the combination that no placement reaches: how far the placements come.
pub(super) fn beyond_reach(check: &LimitCheck, evaluation: &Evaluation) -> Option<String> {
    let failed = check.verdict == Some(Verdict::Fail) && check.on == LimitTarget::CenterDistance;
    let reached = evaluation.reached.filter(|reached| failed && check.limit.judge(*reached) == Verdict::Pass)?;
    Some(format!("no placement found goes that far, the worst ones reach {} mm", interval_text(&reached)))
}
