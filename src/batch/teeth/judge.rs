//! The verdict on a part with measured teeth or spaces: its curve over all strokes at which a measured tooth can carry, together
//! with the errors of the other part. Tables of many parts and a block of one part share it.

use std::ops::Range;

use super::super::asked::refuse_without_uncertainty;
use crate::deviation::{DeviationKind, Part};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::evaluation::{Evaluation, Unjudged, evaluate};
use crate::formula::{Model, PartDeviation};
use crate::function::{Judged, JudgedYoke, YokeJudge};
use crate::judge::bound::Basis;
use crate::judge::{LimitTarget, Limits, Rule, Stack};
use crate::mesh::{Curve, TOLERANCE_MM};
use crate::spec::{MeasuredTables, MeshInput, SolvedTeeth, Spec, WrittenError};
use crate::uncertainty::{self, propagate};

/// The judge of parts whose teeth were measured.
#[derive(Debug, Clone)]
pub struct TeethJudge {
    /// The spec with the measured deviations only.
    measured_only: Spec,
    /// Errors of the other part that hold for every part.
    errors: Vec<PartDeviation>,
    /// Errors of the other part that the spec asks for and that are not known.
    lacking: Vec<DeviationKind>,
    /// The spec as it was written.
    spec: Spec,
    /// The part whose teeth were measured.
    part: Part,
    basis: Basis,
    limits: Limits,
    rule: Rule,
    is_partial: bool,
}

/// The result of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgedTeeth {
    /// From the first to the last stroke that was judged, mm.
    pub strokes: Range<f64>,
    /// Its teeth with the errors of the other part, judged by the limits of the spec.
    pub evaluation: Evaluation,
    /// Errors that the spec asks for and that are not known, without which the part is not judged.
    lacks: Vec<DeviationKind>,
    /// Notes on errors that were not measured although the spec asks for them, and on values taken as exact beside uncertain ones.
    pub notes: Vec<String>,
}

impl TeethJudge {
    /// A judge for measured racks, or for measured pinions.
    ///
    /// # Errors
    /// Diagnostics for geometry that cannot mesh, errors of a part whose teeth the spec knows, and a rule that needs
    /// uncertainties where none is given.
    pub fn new(spec: &Spec, part: Part, rule: Rule, is_partial: bool) -> Result<Self, Diagnostics> {
        let (of_part, of_other): (Vec<_>, Vec<_>) =
            DeviationKind::ALL.into_iter().partition(|kind| kind.part() == part);
        let given: Vec<_> = spec.errors.iter().map(|(kind, _)| *kind).filter(|kind| of_other.contains(kind)).collect();
        spec.refuse_both_ways(&given)?;
        if spec.uncertainties.is_empty() {
            refuse_without_uncertainty(&rule, false)?;
        }
        let measured_only = spec.measured_only(part);
        Ok(Self {
            errors: spec.errors_of_every_part(&of_part)?,
            lacking: spec.lacking(&of_part),
            spec: spec.clone(),
            part,
            basis: measured_only.pair_basis()?,
            limits: spec.limits(),
            measured_only,
            rule,
            is_partial,
        })
    }

    /// The spec with the measured deviations only.
    #[must_use]
    pub fn measured_only(&self) -> &Spec {
        &self.measured_only
    }

    /// Notes on errors that are not counted, and on those that every part has.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let lacking = DeviationKind::keys(self.lacking.iter().copied());
        let every = DeviationKind::keys(self.errors.iter().map(PartDeviation::kind));
        let mut notes = self.spec.circles_in_words(&[]);
        if !every.is_empty() {
            notes.push(format!("every part meets the value in [errors]: {every}"));
        }
        if !lacking.is_empty() && self.is_partial {
            notes.push(format!("judged without {lacking} of the other part, as told by --partial"));
        } else if !lacking.is_empty() {
            notes.push(format!(
                "the spec asks for {lacking} of the other part, and no part is judged without: every_part = true beside \
                 a value of [errors] says that every part meets it, --partial judges without"
            ));
        }
        notes
    }

    /// Judges a part with the mesh of its tables.
    ///
    /// # Errors
    /// Diagnostics if there are no strokes to judge, or one of them has no solution.
    pub fn judge(&self, input: &MeshInput, tables: &MeasuredTables) -> Result<JudgedTeeth, Diagnostics> {
        let strokes = input.judged_strokes()?;
        let spec = self.measured_only.clone().with_known_teeth(tables, &input.mesh, &strokes)?;
        let lacks_uncertainty = self.rule.needs_uncertainty() && !spec.teeth_taken_as_exact.is_empty();
        let unmeasured = self.spec.not_in_tables(self.part, tables);
        let mut evaluation = self.evaluated(&spec)?;
        let mut lacks = [&self.lacking[..], &unmeasured].concat();
        lacks.retain(|_| !self.is_partial);
        let why = if lacks.is_empty() {
            (lacks_uncertainty && !self.is_partial).then(|| Unjudged::without_uncertainty(&spec.teeth_taken_as_exact))
        } else {
            Some(Unjudged::lacking(&lacks))
        };
        if let Some(why) = why {
            evaluation.leave_open(LimitTarget::CenterDistance, why);
        }
        let ends = strokes.first().zip(strokes.last());
        Ok(JudgedTeeth {
            strokes: ends.map_or(0.0..0.0, |(first, last)| first.start..last.end),
            evaluation,
            lacks,
            notes: [self.note_of_unmeasured(&unmeasured), self.note_of_certain(&spec), note_of_spaces(tables)]
                .into_iter()
                .flatten()
                .collect(),
        })
    }

    /// The yoke's figures of a judged part, with its limits; `curve` is that of the part's own teeth over the same strokes, if it
    /// is solved already. With errors of the other part that are not on all teeth the bound judges.
    #[must_use]
    pub fn yoke(
        &self,
        yoke: &YokeJudge,
        part: &JudgedTeeth,
        (input, tables): (&MeshInput, &MeasuredTables),
        curve: Option<&Curve>,
    ) -> JudgedYoke {
        if !part.lacks.is_empty() {
            let keys = part.lacks.iter().map(|kind| kind.key()).collect();
            return yoke.unknown(yoke.open(&Judged::Lacks(keys)));
        }
        let errors: Vec<_> = self.errors.iter().map(|error| (error.kind(), WrittenError::from(error))).collect();
        let placed = (!errors.is_empty()).then(|| self.measured_only.with_errors(&errors).mesh_of_all_teeth(tables));
        let unsolved = || yoke.unknown(yoke.open(&Judged::Unsolved));
        let (input, curve) = match &placed {
            None => (input, curve),
            Some(Ok(Some(placed))) => (placed, None),
            Some(Ok(None)) => return yoke_by_bound(yoke, part, input),
            Some(Err(_)) => return unsolved(),
        };
        let (from, to) = yoke.strokes_mm;
        let solved = match curve {
            Some(curve) => yoke.on(&input.mesh, curve),
            None => input.mesh.curve(from, to, TOLERANCE_MM).and_then(|curve| yoke.on(&input.mesh, &curve)),
        };
        let Ok(Some(function)) = solved else { return unsolved() };
        let is_measured = input.measures(&function);
        let known = yoke.known(function, is_measured);
        // the points are those of the part's own teeth
        if placed.is_some() { known.in_short() } else { known }
    }

    /// A note on errors that the spec gives for the measured part and its table lacks.
    fn note_of_unmeasured(&self, unmeasured: &[DeviationKind]) -> Option<String> {
        let kinds = DeviationKind::keys(unmeasured.iter().copied());
        let part = self.part.name();
        if kinds.is_empty() {
            None
        } else if self.is_partial {
            Some(format!("judged without {kinds} of the {part}, as told by --partial"))
        } else {
            Some(format!(
                "the spec speaks of {kinds} of the {part}, and the table has no column of it: measure it, take it out of \
                 the spec, or judge without by --partial"
            ))
        }
    }

    /// A note on values without an uncertainty where others have one.
    fn note_of_certain(&self, spec: &Spec) -> Option<String> {
        let beside = self.errors.iter().map(PartDeviation::kind).filter(|kind| !spec.is_uncertain(*kind));
        let exact: Vec<_> = spec.taken_as_exact().into_iter().chain(beside).collect();
        let is_refused = self.rule.needs_uncertainty() && !self.is_partial && !spec.teeth_taken_as_exact.is_empty();
        spec.note_of_exact(&exact, is_refused.then_some(&self.rule))
    }

    /// Known teeth and errors of the other part together, by the rule; where none of these errors is left to place and the bound
    /// does not pass, by the mesh of both.
    fn evaluated(&self, spec: &Spec) -> Result<Evaluation, Diagnostics> {
        let by_bound = self.evaluated_on(spec, &self.basis)?;
        let is_limited = self.limits.iter().any(|(on, _)| *on == LimitTarget::CenterDistance);
        if self.errors.is_empty() || !is_limited || by_bound.passes() {
            return Ok(by_bound);
        }
        let errors: Vec<_> = self.errors.iter().map(|error| (error.kind(), WrittenError::from(error))).collect();
        match spec.with_errors(&errors).solved() {
            Some(Ok(SolvedTeeth { teeth, sensitivities })) => {
                let basis = Basis { all_placed: Some(teeth.range), ..self.basis.clone() };
                self.evaluated_on(&Spec { teeth_sensitivities: sensitivities, ..spec.clone() }, &basis)
            }
            Some(Err(why)) => Ok(Evaluation { unsolved: Some(why), ..by_bound }),
            None => Ok(by_bound),
        }
    }

    /// The same on a pair of which this is known beside the teeth.
    fn evaluated_on(&self, spec: &Spec, basis: &Basis) -> Result<Evaluation, Diagnostics> {
        let no_result = |message: String| Diagnostic::error(Code::NoResult, message);
        let (errors, model, stack) = (&self.errors, Model::Exact, Stack::Range);
        let basis = &Basis { known_teeth: spec.known_teeth, ..basis.clone() };
        let mut evaluation =
            evaluate(errors, &self.limits, model, stack, basis).map_err(|failure| spec.explain_failure(&failure))?;
        if self.rule == Rule::Simple {
            return Ok(evaluation);
        }
        let kinds: Vec<_> = errors.iter().map(PartDeviation::kind).collect();
        evaluation.unstated = spec.unstated(&kinds, true, &self.rule);
        let (uncertainties, over_pin) = (spec.uncertainties_of(&kinds)?, spec.over_pin());
        let teeth = &spec.teeth_sensitivities;
        let part = uncertainty::UncertainPart { errors, over_pin: over_pin.as_ref(), model, stack, basis, teeth };
        let propagation = (!uncertainties.is_empty()).then(|| propagate(&part, &uncertainties)).transpose();
        let propagation = propagation.map_err(|error| no_result(error.to_string()))?;
        let decided = evaluation.decide_by(&self.rule, propagation.as_ref(), None);
        decided.map_err(|error| no_result(error.to_string()))?;
        Ok(evaluation)
    }
}

/// The yoke's figures of a judged part where errors of the other part are left to place.
fn yoke_by_bound(yoke: &YokeJudge, part: &JudgedTeeth, input: &MeshInput) -> JudgedYoke {
    let (from, to) = yoke.strokes_mm;
    if input.measures_strokes(from, to) {
        yoke.within(input.mesh.pair(), part.evaluation.range_width_mm())
    } else {
        yoke.unknown(yoke.open(&Judged::NotMeasured))
    }
}

/// A note on spaces at the ends that have rows without values: strokes at which they carry are not judged.
fn note_of_spaces(tables: &MeasuredTables) -> Option<String> {
    let spaces = tables.rack.as_ref()?.without_values();
    let listed = spaces.iter().map(i64::to_string).collect::<Vec<_>>().join(", ");
    (!spaces.is_empty()).then(|| {
        format!("spaces with a row and without values, so that strokes with contacts there are not judged: {listed}")
    })
}
