//! What a spec means: the errors with their formulas, and the limits. Called for a result once the spec is read; here a key
//! becomes required, and the message says what needs it.

use std::ops::Range;
use std::sync::Arc;

use super::keys::{self, AnyKey, Key};
use super::value::KeyType;
use super::{Located, Spec, WrittenError, said_of};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Source};
use crate::evaluation::EvaluationError;
use crate::formula::law::page_of;
use crate::formula::over_pin::OverPin;
use crate::formula::{Law, Model, OVER_PIN, PartDeviation};
use crate::judge::{Limit, LimitTarget, Limits};
use crate::quantity::{DomainError, Length};

impl Spec {
    /// The errors that the spec gives, each with the formula that it needs.
    ///
    /// # Errors
    /// A diagnostic for each key that an error's formula needs and the spec does not have, for gear data
    /// that contradict each other, or because there are no errors at all.
    pub fn part_deviations(&self) -> Result<Vec<PartDeviation>, Diagnostics> {
        self.refuse_without_value()?;
        self.refuse_both_ways(&self.kinds())?;
        if self.errors.is_empty() && self.has_deviations() {
            return Ok(Vec::new());
        }
        if self.errors.is_empty() {
            let place = self.source.text.find("[errors]").map_or(0..0, |start| start..start + "[errors]".len());
            let diagnostic = Diagnostic::error(
                Code::NoErrors,
                "the spec gives no error, so there is nothing to evaluate",
            )
            .at(&self.source, place, "");
            let scattered = if self.scatter.is_empty() { "" } else { "; `rackmesh monte-carlo` draws from [scatter]" };
            let help = format!("add an entry such as `rack_over_roller = \"+13 um\"` below [errors]{scattered}");
            return Err(diagnostic.help(help).into());
        }
        let mut problems = Problems::default();
        let error = |(kind, written): &(DeviationKind, Located<WrittenError>)| {
            Some(self.extended(self.part_deviation(*kind, written, &mut problems)?))
        };
        let errors = self.errors.iter().filter_map(error).collect();
        problems.answer(Some(errors), &self.source)
    }

    /// The kinds of the errors in `[errors]`.
    #[must_use]
    pub fn kinds(&self) -> Vec<DeviationKind> {
        self.errors.iter().map(|(kind, _)| *kind).collect()
    }

    /// Refuses errors with a nominal value or an uncertainty but without a value.
    fn refuse_without_value(&self) -> Result<(), Diagnostic> {
        let refused = |kind: &DeviationKind, has: &str, place: &Range<usize>, key: &str| {
            let help =
                format!("add `{key} = …` beside it, or evaluate measured values with `rackmesh paste` or `batch`");
            Err(Diagnostic::error(Code::BadErrorEntry, format!("`{}` has {has}", kind.key()))
                .at(&self.source, place.clone(), "")
                .help(help))
        };
        let is_given = |kind: &DeviationKind| said_of(&self.errors, *kind).is_some();
        if let Some((kind, nominal)) = self.nominals.iter().find(|(kind, _)| !is_given(kind)) {
            return refused(kind, "a nominal value, but no measured one", &nominal.span, "measured");
        }
        let has_value = |kind: &DeviationKind| self.knows_teeth(kind.part()) || is_given(kind);
        if let Some((kind, place)) = self.unmeasured.iter().find(|(kind, _)| !has_value(kind)) {
            return refused(kind, "no value", place, "value");
        }
        Ok(())
    }

    /// The errors with their formulas; empty for a pair without errors.
    ///
    /// # Errors
    /// Diagnostics as [`Spec::part_deviations`].
    pub fn part_errors_or_none(&self) -> Result<Vec<PartDeviation>, Diagnostics> {
        if self.errors.is_empty() { Ok(Vec::new()) } else { self.part_deviations() }
    }

    /// An error with the extent of the spec, if it gives one.
    #[must_use]
    pub fn extended(&self, error: PartDeviation) -> PartDeviation {
        said_of(&self.extents, error.kind()).map_or(error, |extent| error.with_extent(extent.value))
    }

    /// The spec with other errors, as measured on a part or permitted for every part. Their formulas need gear data as if they
    /// stood in `[errors]`.
    #[must_use]
    pub fn with_errors<E: Copy + Into<WrittenError>>(&self, errors: &[(DeviationKind, E)]) -> Self {
        // the nominal measure over a roller is still computed from the gear data, with their uncertainties
        let over_pin = self.over_pin().and_then(|over_pin| Some((over_pin.measure().ok()?, over_pin.pin_diameter)));
        let errors = errors.iter().map(|(kind, value)| {
            let written = match ((*value).into(), over_pin) {
                (WrittenError::Value(DeviationValue::Length(length)), Some((nominal, roller)))
                    if *kind == DeviationKind::RackOverRoller =>
                {
                    WrittenError::OverRoller { measured: length + nominal, roller }
                }
                (written, _) => written,
            };
            (*kind, Located { value: written, span: 0..0 })
        });
        Self { errors: errors.collect(), nominals: Vec::new(), unmeasured: Vec::new(), ..self.clone() }
    }

    /// The limits that the spec gives.
    #[must_use]
    pub fn limits(&self) -> Limits {
        self.limits.iter().map(|(target, limit)| (*target, limit.value)).collect()
    }

    /// The limit on a ΔCD, if the spec gives one.
    #[must_use]
    pub fn limit_on(&self, target: LimitTarget) -> Option<&Limit> {
        said_of(&self.limits, target).map(|limit| &limit.value)
    }

    /// A failed evaluation as a diagnostic that points at the error concerned.
    #[must_use]
    pub fn explain_failure(&self, failure: &EvaluationError) -> Diagnostic {
        let written = failure.error.and_then(|kind| said_of(&self.errors, kind));
        let place = written.map(|written| written.span.clone());
        Diagnostic::error(Code::NoResult, failure.to_string()).at(&self.source, place, "")
    }

    /// An error with its law; `None` if a key is missing or the value is refused.
    fn part_deviation(
        &self,
        kind: DeviationKind,
        written: &Located<WrittenError>,
        problems: &mut Problems,
    ) -> Option<PartDeviation> {
        let need = needed_by(kind, written);
        let error = match written.value {
            WrittenError::Value(value) => self.law_of(kind, problems, &need)?.map(|law| PartDeviation::new(law, value)),
            WrittenError::Tolerance(ends) => {
                self.law_of(kind, problems, &need)?.map(|law| PartDeviation::between(law, ends))
            }
            WrittenError::OverRoller { measured, roller } => {
                let nominal = self.over_pin_of(roller, problems, &need)?.measure();
                let law = self.law_of(kind, problems, &need)?;
                law.and_then(|law| Ok(PartDeviation::new(law, measured - nominal?)))
            }
            WrittenError::Class(grade) => {
                // all that is missing is noted
                let class = self.class(kind, grade, &written.span, problems);
                let law = self.law_of(kind, problems, &need)?;
                let class = class?;
                law.map(|law| class.tolerance(law))
            }
        };
        problems.accept(error.map_err(|error| self.contradiction(written, &error)))
    }

    /// The law of a kind of error for this gear; `None` if a key is missing.
    pub(super) fn law_of(
        &self,
        kind: DeviationKind,
        problems: &mut Problems,
        need: &dyn Fn() -> Need,
    ) -> Option<Result<Law, DomainError>> {
        let (rack, pinion) = (self.or_zero(keys::RACK_HELIX_ANGLE), self.or_zero(keys::PINION_HELIX_ANGLE));
        let mut pressure_angle = || problems.take(self, keys::PAIR_NORMAL_PRESSURE_ANGLE, need);
        Some(match kind {
            DeviationKind::RackOverRoller => Ok(Law::rack_over_roller()),
            DeviationKind::PinionRadial => Ok(Law::pinion_radial()),
            DeviationKind::RackPitch => Law::rack_pitch(pressure_angle()?, rack),
            DeviationKind::PinionPitch => Law::pinion_pitch(pressure_angle()?, pinion),
            DeviationKind::PinionLead => Law::pinion_lead(pressure_angle()?, pinion),
            DeviationKind::RackLead => {
                let pressure_angle = pressure_angle();
                let face_width = problems.take(self, keys::RACK_FACE_WIDTH, need);
                Law::rack_lead(pressure_angle?, rack, face_width?)
            }
        })
    }

    /// The inputs of the nominal measure over a roller; `None` if a key is missing.
    pub(super) fn over_pin_of(
        &self,
        pin_diameter: Length,
        problems: &mut Problems,
        need: &dyn Fn() -> Need,
    ) -> Option<OverPin> {
        let normal_module = problems.take(self, keys::PAIR_NORMAL_MODULE, need);
        let normal_pressure_angle = problems.take(self, keys::PAIR_NORMAL_PRESSURE_ANGLE, need);
        let datum = problems.take(self, keys::RACK_DATUM, need);
        Some(OverPin {
            normal_module: normal_module?,
            normal_pressure_angle: normal_pressure_angle?,
            tooth_thickness: self.get(keys::RACK_TOOTH_THICKNESS),
            pin_diameter,
            datum: datum?,
        })
    }

    /// A diagnostic for values that are each in their domain, but not together.
    fn contradiction(&self, written: &Located<WrittenError>, error: &DomainError) -> Diagnostic {
        let span = match error {
            DomainError::NoSpace { .. } => self.place(keys::RACK_TOOTH_THICKNESS),
            _ => None,
        };
        let code = if matches!(error, DomainError::Overflow(_)) { Code::NoResult } else { Code::OutOfDomain };
        Diagnostic::error(code, error.to_string()).at(&self.source, span.unwrap_or_else(|| written.span.clone()), "")
    }
}

/// What needs a key, where it stands, and why.
pub(super) type Need = (String, Option<(Range<usize>, String)>);

/// The need of an error of `[errors]`.
fn needed_by(kind: DeviationKind, written: &Located<WrittenError>) -> impl Fn() -> Need {
    move || {
        let formula = match written.value {
            // the nominal of M - M_nom is the measure over the pin
            WrittenError::OverRoller { .. } => OVER_PIN.equation(Model::Exact).replacen("M =", "M_nom =", 1),
            _ => page_of(kind).equation(Model::Exact).to_owned(),
        };
        let span = &written.span;
        (format!("`{}`", kind.key()), (!span.is_empty()).then(|| (span.clone(), formula)))
    }
}

/// Why a request has no answer: the missing keys, each named once, and the refused values.
#[derive(Default)]
pub(super) struct Problems {
    missing: Vec<MissingKey>,
    refused: Vec<Diagnostic>,
}

struct MissingKey {
    key: AnyKey,
    needed_by: Vec<String>,
    /// Where the first need stands, and why it needs the key.
    place: Option<(Range<usize>, String)>,
}

impl Problems {
    /// The value of a key, or a note that it is missing; `need` says what needs it, and where that stands.
    pub(super) fn take<T: KeyType>(&mut self, spec: &Spec, key: Key<T>, need: impl FnOnce() -> Need) -> Option<T> {
        let value = spec.get(key);
        if value.is_none() {
            self.note(key.any, need);
        }
        value
    }

    /// Notes that a key is missing.
    pub(super) fn note(&mut self, key: AnyKey, need: impl FnOnce() -> Need) {
        let (needed_by, place) = need();
        match self.missing.iter_mut().find(|missing| missing.key.path == key.path) {
            Some(missing) if missing.needed_by.contains(&needed_by) => {}
            Some(missing) => missing.needed_by.push(needed_by),
            None => self.missing.push(MissingKey { key, needed_by: vec![needed_by], place }),
        }
    }

    /// A value, or a note of why it is refused.
    pub(super) fn accept<T>(&mut self, value: Result<T, Diagnostic>) -> Option<T> {
        value.map_err(|refused| self.refused.push(refused)).ok()
    }

    /// The answer, if nothing is missing or refused.
    pub(super) fn answer<T>(self, answer: Option<T>, source: &Arc<Source>) -> Result<T, Diagnostics> {
        match answer {
            Some(answer) if self.missing.is_empty() && self.refused.is_empty() => Ok(answer),
            _ => Err(Diagnostics(self.diagnostics(source))),
        }
    }

    /// The refused values, then the missing keys.
    fn diagnostics(self, source: &Arc<Source>) -> Vec<Diagnostic> {
        let missing = self.missing.iter().map(|missing| {
            let MissingKey { key, needed_by, place } = missing;
            let (section, name) = key.path.rsplit_once('.').unwrap_or(("", key.path));
            let verb = if needed_by.len() == 1 { "needs" } else { "need" };
            let message = format!("`{section}.{name}` is missing; {} {verb} it", needed_by.join(", "));
            let diagnostic = Diagnostic::error(Code::MissingKey, message);
            let help = format!("add `{name} = …` below [{section}]");
            match place {
                Some((span, label)) => diagnostic.help(help).at(source, span.clone(), label.as_str()),
                // nothing in the spec needs it: name the file at least
                None => diagnostic.help(format!("{help} in {}", source.name)),
            }
        });
        self.refused.into_iter().chain(missing).collect()
    }
}
