//! `{ class = 7 }` and `[tolerance]`: the permissible value of a class in a spec. Called where errors are resolved. It finds
//! the size of the wheel and asks [`standard`](crate::standard); it chooses neither a standard nor a rack's diameter.

use std::ops::Range;

use super::resolve::{Need, Problems};
use super::{Located, Spec, WrittenError, keys};
use crate::deviation::{DeviationKind, Part};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::judge::class::{
    self, DiameterSource, ErrorClass, RackDiameter, developed_diameter, deviation_of, reference_diameter,
};
use crate::quantity::{DomainError, Length};
use crate::standard::{Deviation, Size, Standard, StandardError, Wheel};

impl Spec {
    /// The errors that the spec gives as classes, with their permissible values.
    ///
    /// # Errors
    /// A diagnostic for each key that is missing, and for each class that has no value.
    pub fn classes(&self) -> Result<Vec<ErrorClass>, Diagnostics> {
        let mut problems = Problems::default();
        let class = |(kind, written): &(DeviationKind, Located<WrittenError>)| match written.value {
            WrittenError::Class(grade) => self.class(*kind, grade, &written.span, &mut problems),
            _ => None,
        };
        let classes = self.errors.iter().filter_map(class).collect();
        problems.answer(Some(classes), &self.source)
    }

    /// The size of a part as far as the spec gives it, without a diameter.
    #[must_use]
    pub fn wheel(&self, part: Part) -> Wheel {
        let (face_width, teeth, helix_angle) = match part {
            Part::Rack => (keys::RACK_FACE_WIDTH, None, keys::RACK_HELIX_ANGLE),
            Part::Pinion => (keys::PINION_FACE_WIDTH, self.get(keys::PINION_TEETH), keys::PINION_HELIX_ANGLE),
        };
        Wheel {
            normal_module: self.get(keys::PAIR_NORMAL_MODULE),
            diameter: None,
            face_width: self.get(face_width),
            teeth,
            helix_angle: self.get(helix_angle),
        }
    }

    /// The permissible value of a grade for a kind of error, if the spec says enough for it.
    #[must_use]
    pub fn class_of(&self, kind: DeviationKind, grade: u8) -> Option<ErrorClass> {
        self.class(kind, grade, &(0..0), &mut Problems::default())
    }

    /// The permissible value of `{ class = grade }` for a kind of error; `None` if a key is missing or the class is refused.
    pub(super) fn class(
        &self,
        kind: DeviationKind,
        grade: u8,
        span: &Range<usize>,
        problems: &mut Problems,
    ) -> Option<ErrorClass> {
        let Some(deviation) = deviation_of(kind) else {
            let message = format!("`{}` has no class: {}", kind.key(), class::NO_OVER_ROLLER_CLASS);
            let help = format!("{} = \"12 um\"", kind.key());
            let refused = Diagnostic::error(Code::NoClass, message).at(&self.source, span.clone(), "");
            return problems.accept(Err(refused.help(help)));
        };
        let part = kind.part();
        let need = || -> Need { (format!("`{}` of class {grade}", kind.key()), Some((span.clone(), String::new()))) };
        let mut wheel = self.wheel(part);
        let needs_width = kind == DeviationKind::RackLead;
        let face_width = needs_width.then(|| problems.take(self, keys::RACK_FACE_WIDTH, need));
        let Some(standard) = problems.take(self, keys::TOLERANCE_STANDARD, need) else {
            // as far as can be known without the standard
            let sizes = sizes_of_all(deviation, grade, &wheel);
            self.complete(&mut wheel, (&sizes, part), need, problems);
            return None;
        };
        let Some(limiting) = standard.that_limits(deviation) else {
            let error = StandardError::NoSuchDeviation { standard, deviation };
            return problems.accept(Err(self.no_class(kind, &error, span)));
        };
        let sizes = limiting.sizes_missing_for(&[deviation], grade, &wheel);
        let diameter = self.complete(&mut wheel, (&sizes, part), need, problems);
        let permissible = match limiting.permissible(deviation, grade, &wheel) {
            Err(StandardError::Missing { .. }) => return None,
            permissible => problems.accept(permissible.map_err(|error| self.no_class(kind, &error, span)))?,
        };
        let face_width = match face_width {
            Some(width) => Some(width?),
            None => None,
        };
        let value = class::error_value(kind, &permissible, face_width);
        let value =
            problems.accept(value.map_err(|error| {
                Diagnostic::error(Code::NoClass, error.to_string()).at(&self.source, span.clone(), "")
            }))?;
        let total = class::total_of(kind, limiting, grade, &wheel);
        Some(ErrorClass { kind, permissible, diameter, value, total })
    }

    /// Notes the sizes that a wheel lacks, and completes it by its diameter, which is computed; returns that.
    fn complete(
        &self,
        wheel: &mut Wheel,
        (sizes, part): (&[Size], Part),
        need: impl Fn() -> Need + Copy,
        problems: &mut Problems,
    ) -> Option<(Length, DiameterSource)> {
        for size in sizes {
            let key = match (size, part) {
                (Size::Diameter, _) => continue,
                (Size::NormalModule, _) => keys::PAIR_NORMAL_MODULE.any,
                (Size::FaceWidth, Part::Rack) => keys::RACK_FACE_WIDTH.any,
                (Size::FaceWidth, Part::Pinion) => keys::PINION_FACE_WIDTH.any,
                _ => keys::PINION_TEETH.any,
            };
            problems.note(key, need);
        }
        let diameter = sizes.contains(&Size::Diameter).then(|| self.diameter(part, need, problems)).flatten();
        wheel.diameter = wheel.diameter.or(diameter.map(|found| found.0));
        diameter
    }

    /// The diameter with which a standard is entered for a part; `None` if a key is missing or the diameter is refused.
    fn diameter(
        &self,
        part: Part,
        need: impl Fn() -> Need,
        problems: &mut Problems,
    ) -> Option<(Length, DiameterSource)> {
        let mut pinion = |source: DiameterSource| {
            let module = problems.take(self, keys::PAIR_NORMAL_MODULE, &need);
            let teeth = problems.take(self, keys::PINION_TEETH, &need);
            let helix_angle = self.or_zero(keys::PINION_HELIX_ANGLE);
            Some((reference_diameter(module?, teeth?, helix_angle), source))
        };
        let (diameter, source) = match part {
            Part::Pinion => pinion(DiameterSource::Own)?,
            Part::Rack => match self.get(keys::TOLERANCE_DIAMETER) {
                Some(RackDiameter::Pinion) => pinion(DiameterSource::MatingPinion)?,
                Some(RackDiameter::Developed) => {
                    let length = problems.take(self, keys::RACK_TOOTHED_LENGTH, &need)?;
                    (developed_diameter(length), DiameterSource::Developed)
                }
                Some(RackDiameter::Given(diameter)) => (Ok(diameter), DiameterSource::Given),
                None => {
                    problems.note(keys::TOLERANCE_DIAMETER.any, &need);
                    return None;
                }
            },
        };
        let refused = |error: DomainError| Diagnostic::error(Code::OutOfDomain, error.to_string());
        Some((problems.accept(diameter.map_err(refused))?, source))
    }

    fn no_class(&self, kind: DeviationKind, error: &StandardError, span: &Range<usize>) -> Diagnostic {
        let example = if kind == DeviationKind::RackLead {
            "{ f_h_beta = \"8 um\", length = 18, extent = \"each\" }"
        } else {
            "{ value = \"12 um\", extent = \"each\" }"
        };
        let help = match error {
            StandardError::Grade { .. } => "give a grade that the standard has".to_owned(),
            _ => format!("give the permitted value itself, of each tooth: {} = {example}", kind.key()),
        };
        Diagnostic::error(Code::NoClass, format!("`{}`: {error}", kind.key()))
            .at(&self.source, span.clone(), "")
            .help(help)
    }
}

/// The sizes that every standard needs for a grade of a deviation and the wheel lacks.
fn sizes_of_all(deviation: Deviation, grade: u8, wheel: &Wheel) -> Vec<Size> {
    let limiting = Standard::ALL.into_iter().filter_map(|standard| standard.that_limits(deviation));
    let each = limiting.filter(|standard| standard.grades().contains(&grade));
    let sizes = each.map(|standard| standard.sizes_missing_for(&[deviation], grade, wheel));
    let common = |all: Vec<Size>, sizes: Vec<Size>| all.into_iter().filter(|size| sizes.contains(size)).collect();
    sizes.reduce(common).unwrap_or_default()
}
