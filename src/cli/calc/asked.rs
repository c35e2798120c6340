//! What is asked of a law, and the answer: a ΔCD, or how large the error may be, with what it can do in the worst case.

use super::{Common, GivenValue, OptionDoubt, by_symbol, calculation, sensible, usage};
use crate::cli::output::{Failure, Output, Status};
use crate::deviation::plausible::{self, Doubt};
use crate::deviation::{DeviationValue, Extent};
use crate::formula::law::lead_slope;
use crate::formula::{Law, Model, PartDeviation};
use crate::judge::bound::{Basis, Bound};
use crate::judge::{Interval, Limit, Verdict};
use crate::quantity::{Angle, DomainError, Length, LengthUnit, Unit};
use crate::report::{Calculation, WorstCase, WorstCaseResult, formula_note, noted};

/// The question to a ΔCD formula.
pub(super) enum Question {
    /// ΔCD of this error.
    DeltaCd(DeviationValue),
    /// The largest error within this ΔCD.
    Error(Length),
    /// The largest helix slope deviation over this length within this ΔCD.
    SlopeDeviation { delta_cd: Length, length: Length },
}

/// A law with its question.
pub(super) struct Asked<'a> {
    pub(super) law: Law,
    pub(super) given: &'a GivenValue,
    pub(super) question: Question,
    /// The model of the law; `None` if both models agree.
    pub(super) model: Option<Model>,
}

impl Asked<'_> {
    /// The law's answer.
    fn answer(&self, model: Model) -> Result<DeviationValue, DomainError> {
        match self.question {
            Question::DeltaCd(error) => self.law.delta_cd(error, model).map(DeviationValue::Length),
            Question::Error(delta_cd) => self.law.largest_error(delta_cd, model),
            Question::SlopeDeviation { delta_cd, length } => {
                self.law.largest_slope_deviation(delta_cd, length, model).map(DeviationValue::Length)
            }
        }
    }

    /// A size as an error; it may be a slope deviation over a length.
    fn error(&self, size: DeviationValue) -> Result<DeviationValue, DomainError> {
        match (&self.question, size) {
            (Question::SlopeDeviation { length, .. }, DeviationValue::Length(slope)) => lead_slope(slope, *length),
            _ => Ok(size),
        }
    }

    /// The largest size up to that of the answer at which errors of either sign are within what is asked.
    fn largest(&self, answer: DeviationValue, is_within: impl Fn(DeviationValue) -> bool) -> DeviationValue {
        /// 1e-11°.
        const NAS: i64 = 36;
        let (steps, size): (i64, fn(i64) -> DeviationValue) = match answer.abs() {
            DeviationValue::Length(length) => (length.fm(), |fm| Length::from_fm(fm).into()),
            DeviationValue::Angle(angle) => (angle.nas() / NAS, |steps| Angle::from_nas(NAS * steps).into()),
            slope @ DeviationValue::Slope(_) => return slope,
        };
        let holds = |steps: i64| [steps, -steps].iter().all(|steps| self.error(size(*steps)).is_ok_and(&is_within));
        let (mut inside, mut outside) = (0, steps + 1);
        while outside - inside > 1 {
            let middle = inside + (outside - inside) / 2;
            *(if holds(middle) { &mut inside } else { &mut outside }) = middle;
        }
        size(inside)
    }

    /// Prints the answer with its remarks, and the worst case of the error if its teeth are asked for.
    pub(super) fn print(
        &self,
        output: &mut Output,
        common: &Common,
        doubts: &[OptionDoubt],
    ) -> Result<Status, Failure> {
        let mut notes = sensible(output, doubts)?;
        if let Question::DeltaCd(error) = self.question {
            // the law refuses values outside its domain
            self.answer(Model::Exact)?;
            let doubt = plausible::deviation(error, None);
            let doubt = if self.given.measured.is_some() { doubt.map(Doubt::of_difference) } else { doubt };
            notes.extend(sensible(output, &[("the error", doubt)])?);
        }
        let result = self.answer(self.model.unwrap_or_default())?;
        let mut calculation = calculation(self.law.page(), result);
        calculation.model = self.model;
        // the other model may have no value where the chosen one has
        calculation.other = self.model.map(|model| self.answer(model.other()).unwrap_or(result));
        calculation.is_bound = !matches!(self.question, Question::DeltaCd(_));
        if matches!(self.question, Question::SlopeDeviation { .. }) {
            calculation.unit = by_symbol(Unit::Length(LengthUnit::Micrometre));
        }
        let (worst_case, rests_on) = self.worst_case(result)?;
        calculation.worst_case = Some(worst_case);
        notes.splice(0..0, rests_on.iter().cloned());
        let printed = common.print(output, Calculation { notes, ..calculation })?;
        let is_asked = self.given.extent.is_some();
        if let (None, Some(worst_case)) = (common.format, printed.worst_case_remark()) {
            if is_asked {
                output.message(&worst_case);
            } else if printed.is_worse() {
                output.remark(&worst_case);
            }
            let said = if is_asked || printed.is_worse() { &rests_on[..] } else { &[] };
            for note in said {
                output.remark(&noted(note));
            }
        }
        let is_open = printed.worst_case.is_some_and(|worst_case| worst_case.result.is_err());
        Ok(if is_open && is_asked { Status::Undecided } else { Status::Pass })
    }

    /// The worst case of an error, or the largest error by the worst case, with its assumptions; nothing else is known of the pair.
    fn worst_case(&self, answer: DeviationValue) -> Result<(WorstCase, Vec<String>), Failure> {
        let kind = self.law.kind();
        let extent = self.given.extent.unwrap_or(kind.usual_extent());
        if !extent.fits(kind.counts()) {
            return Err(usage(format!("--extent {extent}: {}", Extent::NO_TOTAL)));
        }
        let range_of = |bound: &Bound| Interval::of(bound.combined.range).map_err(DomainError::from);
        let bound_of = |error| Basis::default().bound_of(&[PartDeviation::new(self.law, error).with_extent(extent)]);
        let error = if let Question::DeltaCd(error) = self.question { error } else { self.error(answer)? };
        let bound = bound_of(error);
        let range = range_of(&bound)?;
        let result = match self.question {
            Question::DeltaCd(_) => range.map(WorstCaseResult::DeltaCd),
            Question::Error(delta_cd) | Question::SlopeDeviation { delta_cd, .. } => {
                let limit = Limit::symmetric(delta_cd.abs());
                let is_within = |error| {
                    let range = range_of(&bound_of(error)).ok().and_then(Result::ok);
                    range.is_some_and(|range| limit.judge(range) == Verdict::Pass)
                };
                range.map(|_| WorstCaseResult::Error(self.largest(answer, is_within)))
            }
        };
        Ok((WorstCase { kind, extent, result }, bound.notes.iter().filter_map(formula_note).collect()))
    }
}
