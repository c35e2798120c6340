//! The circle on which the pinion's pitch, and arcs of its teeth, were measured. f_p is an arc, so it is proportional to the
//! diameter of its circle. Used once the spec is read, and for the values of a table.

use std::borrow::Cow;

use super::resolve::Problems;
use super::{Located, Spec, WrittenError, keys};
use crate::deviation::{DeviationKind, DeviationValue, DeviationValues, PinionDeviationKind};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::femtometres;
use crate::quantity::{Length, plain};
use crate::table::PinionTooth;
use crate::trig;
use crate::uncertainty::Influence;

/// The circle on which the pinion's pitches were measured, beside the reference circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PitchCircle {
    /// The circle's diameter d_M.
    pub measured_at: Length,
    /// Diameter of the reference circle d = m_n z / cos β_p, mm.
    pub reference_mm: f64,
}

impl PitchCircle {
    /// d / d_M.
    fn scale(&self) -> f64 {
        self.reference_mm / self.measured_at.mm()
    }

    /// A length on the measurement circle, on the reference circle: f_p d / d_M, rounded to the grid once.
    #[must_use]
    pub fn scaled(&self, measured: Length) -> Length {
        // measured lengths are far below the largest, and circles differ by a few modules
        Length::nearest(femtometres(measured) * self.scale(), "the pitch deviation").unwrap_or(Length::LARGEST)
    }

    fn scale_value(&self, value: &mut DeviationValue) {
        if let DeviationValue::Length(length) = value {
            *length = self.scaled(*length);
        }
    }

    /// The values of a column, scaled in the same way.
    #[must_use]
    pub fn scaled_all(&self, measured: &DeviationValues) -> DeviationValues {
        match measured {
            DeviationValues::Lengths(lengths) => {
                DeviationValues::Lengths(lengths.iter().map(|length| self.scaled(*length)).collect())
            }
            other => other.clone(),
        }
    }

    /// The conversion in words.
    fn remark(&self, what: &str) -> String {
        format!(
            "{what}: measured at d_M = {}, scaled by d/d_M = {} to the reference circle of d = {} mm",
            self.measured_at,
            plain((1e6 * self.scale()).round() / 1e6),
            plain((1e6 * self.reference_mm).round() / 1e6)
        )
    }
}

impl Spec {
    /// Scales values that were measured on another circle to the reference circle, and finds the circle of the values of tables.
    pub(super) fn scale_to_reference_circle(&mut self) -> Result<(), Diagnostics> {
        self.scale_arcs()?;
        self.scale_pitch()
    }

    /// Arcs of single teeth; those of a table are scaled where they are read.
    fn scale_arcs(&mut self) -> Result<(), Diagnostics> {
        use PinionDeviationKind::{Left, Right, Shift, Thickness};
        let Some(value) = self.get(keys::PINION_MEASURED_AT) else { return Ok(()) };
        let span = self.place(keys::PINION_MEASURED_AT).unwrap_or_default();
        let circle = self.circle(&Located { value, span })?;
        for written in &mut self.pinion_deviations {
            if let Shift(mm) | Thickness(mm) | Left(mm) | Right(mm) = &mut written.value.kind {
                *mm *= circle.scale();
            }
        }
        self.arc_circle = Some(circle);
        Ok(())
    }

    /// The rows of `pinion.measured`, their arcs on the reference circle.
    pub(super) fn on_reference_circle<'r>(&self, rows: &'r [PinionTooth]) -> Cow<'r, [PinionTooth]> {
        let Some(circle) = self.arc_circle else { return Cow::Borrowed(rows) };
        let scaled = |arc: Option<Length>| arc.map(|arc| circle.scaled(arc));
        let on_circle = |row: &PinionTooth| PinionTooth {
            position: scaled(row.position),
            left_pitch: scaled(row.left_pitch),
            right_pitch: scaled(row.right_pitch),
            ..row.clone()
        };
        rows.iter().map(on_circle).collect()
    }

    /// The pitch of the pinion in `[errors]`, and its uncertainty.
    fn scale_pitch(&mut self) -> Result<(), Diagnostics> {
        let kind = DeviationKind::PinionPitch;
        let of_column = self.batch_column(kind).and_then(|column| column.value.measured_at.clone());
        // a place in another file is not a place in the spec
        let of_column = of_column.map(|given| match self.table.source {
            Some(_) => Located { span: 0..0, ..given },
            None => given,
        });
        let Some(given) = self.measured_at.clone().or(of_column.clone()) else { return Ok(()) };
        if let Some(other) = of_column.filter(|other| other.value != given.value) {
            let message = format!(
                "`errors` and `table.columns` say that the pitch was measured at {} and {}",
                given.value, other.value
            );
            return Err(Diagnostic::error(Code::BadErrorEntry, message)
                .at(self.source_of_columns(), other.span, "")
                .into());
        }
        let circle = self.circle(&given)?;
        let has_value = self.errors.iter().any(|(other, _)| *other == kind);
        if self.measured_at.is_some() || !has_value {
            let (errors, uncertainties) = (self.errors.iter_mut(), self.uncertainties.iter_mut());
            for (_, written) in errors.filter(|(other, _)| *other == kind) {
                match &mut written.value {
                    WrittenError::Value(value) => circle.scale_value(value),
                    WrittenError::Tolerance(ends) => {
                        ends.nearer.iter_mut().chain([&mut ends.farther]).for_each(|end| circle.scale_value(end));
                    }
                    // classes and over-roller measures belong to no circle
                    WrittenError::OverRoller { .. } | WrittenError::Class(_) => {}
                }
            }
            for (_, written) in uncertainties.filter(|(source, _)| *source == Influence::Error(kind)) {
                written.value.standard *= circle.scale();
            }
        }
        self.pitch_circle = Some(circle);
        Ok(())
    }

    /// The circle on which the pinion's pitch (if it is among these errors) and arcs of its teeth were measured, in words.
    #[must_use]
    pub fn circles_in_words(&self, errors: &[DeviationKind]) -> Vec<String> {
        let of_pitch = self.pitch_circle.filter(|_| errors.contains(&DeviationKind::PinionPitch));
        let of_pitch = of_pitch.map(|circle| circle.remark("pinion pitch"));
        let of_arcs = self.arc_circle.map(|circle| circle.remark("arcs of the pinion's teeth"));
        of_pitch.into_iter().chain(of_arcs).collect()
    }

    /// Checks that the circle lies between base circle and tips, where the pinion has its involute.
    fn circle(&self, given: &Located<Length>) -> Result<PitchCircle, Diagnostics> {
        let mut problems = Problems::default();
        let need = || ("`measured_at`".to_owned(), Some((given.span.clone(), "d = m_n z / cos β_p".to_owned())));
        let module = problems.take(self, keys::PAIR_NORMAL_MODULE, need);
        let teeth = problems.take(self, keys::PINION_TEETH, need);
        let (module, teeth) = problems.answer(module.zip(teeth), &self.source)?;
        let cos = trig::sin_cos_of(self.or_zero(keys::PINION_HELIX_ANGLE)).1;
        let reference_mm = module.mm() * f64::from(teeth) / cos;
        // d_b = d cos α_t, tan α_t = tan α_n / cos β_p
        let tangent = self.get(keys::PAIR_NORMAL_PRESSURE_ANGLE).map(|angle| trig::tan_of(angle) / cos);
        let base_mm = tangent.map_or(0.0, |tangent| reference_mm / (1.0 + tangent * tangent).sqrt());
        let tip_mm = self.get(keys::PINION_TIP_DIAMETER).map_or(f64::INFINITY, Length::mm);
        if (base_mm..=tip_mm).contains(&given.value.mm()) {
            return Ok(PitchCircle { measured_at: given.value, reference_mm });
        }
        let tip = if tip_mm.is_finite() {
            format!(" and at most the tip diameter, {} mm", plain(tip_mm))
        } else {
            String::new()
        };
        let message = format!(
            "the diameter of the measurement circle d_M is {}; it must be at least the base diameter, {base_mm:.4} mm{tip}",
            given.value
        );
        let diagnostic =
            Diagnostic::error(Code::OutOfDomain, message).help("`measured_at` is a diameter, not a radius");
        Err(diagnostic.at(&self.source, given.span.clone(), "").into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAIR: &str = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[pinion]\nteeth = 8\n";

    fn pitch(entry: &str) -> Result<(f64, Option<f64>), String> {
        let text = format!("{PAIR}[errors]\npinion_pitch = {entry}");
        let spec = Spec::parse("spec.toml", &text).map_err(|problem| problem.to_string())?;
        let uncertainty = spec.uncertainties.first().map(|(_, written)| written.value.standard);
        let errors = spec.part_deviations().map_err(|problem| problem.to_string())?;
        Ok((errors[0].value().base(), uncertainty))
    }

    /// d = 16 mm.
    #[test]
    fn a_pitch_is_to_its_circle_as_on_the_reference_circle() {
        let at = |circle: &str| pitch(&format!("{{ value = \"9 um\", measured_at = {circle}, u = \"0.5 um\" }}"));
        assert_eq!(at("\"16 mm\""), Ok((0.009, Some(0.0005))));
        let (value, uncertainty) = at("\"17.2 mm\"").unwrap();
        assert_eq!(value, 0.008_372_093_023);
        assert!((uncertainty.unwrap() - 0.0005 * 16.0 / 17.2).abs() < 1e-18);
        let measured = pitch("{ measured = 6.292, nominal = 6.283, measured_at = 20 }").unwrap();
        assert_eq!(measured.0, 0.0072);
    }

    /// Both ends of a tolerance, too.
    #[test]
    fn a_tolerance_is_on_its_circle() {
        let ends = "{ value = { lower = \"-4 um\", upper = \"10 um\" }, measured_at = 20 }";
        let spec = Spec::parse("spec.toml", &format!("{PAIR}[errors]\npinion_pitch = {ends}")).unwrap();
        assert_eq!(spec.part_deviations().unwrap()[0].tolerance().base(), [-0.0032, 0.008]);
    }

    #[test]
    fn arcs_of_single_teeth_are_on_the_reference_circle() {
        let text = format!(
            "{PAIR}measured_at = 20\n[[pinion.deviation]]\nshift = 0.01\nthickness = -0.02\nleft = 0.03\nradial = 0.04\n"
        );
        let spec = Spec::parse("spec.toml", &text).unwrap();
        let kinds: Vec<_> = spec.pinion_deviations.iter().map(|written| written.value.kind).collect();
        let (shift, thickness) = (PinionDeviationKind::Shift(0.008), PinionDeviationKind::Thickness(-0.016));
        assert_eq!(kinds[..2], [shift, thickness]);
        assert_eq!(kinds[2..], [PinionDeviationKind::Left(0.024), PinionDeviationKind::Radial(0.04)]);
        let length = |text: &str| text.parse::<Length>().unwrap();
        let row = PinionTooth {
            tooth: 0,
            radial: Some(length("0.005")),
            position: Some(length("0.01")),
            left_pitch: Some(length("0.02")),
            right_pitch: None,
            lead: None,
            extent: crate::table::RowExtent::Whole,
            line: 1,
        };
        let rows = spec.on_reference_circle(std::slice::from_ref(&row));
        let PinionTooth { radial, position, left_pitch, right_pitch, .. } = &rows[0];
        assert_eq!(
            [radial, position, left_pitch],
            [Some(length("0.005")), Some(length("0.008")), Some(length("0.016"))].each_ref()
        );
        assert_eq!(*right_pitch, None);
        assert_eq!(spec.circles_in_words(&[]).len(), 1);
        assert!(Spec::parse("spec.toml", &text.replace("measured_at = 20", "measured_at = 9")).is_err());
    }

    #[test]
    fn what_is_no_circle_of_the_involute_is_refused() {
        for (entry, said) in [
            ("{ value = 0.009, measured_at = 8.6 }", "is a diameter, not a radius"),
            ("{ value = 0.009, measured_at = 0 }", "must be above 0 mm"),
            ("{ class = 7, measured_at = 17 }", "of the reference circle"),
            ("{ value = 0.009, measured_at = \"17 deg\" }", "a length is needed"),
        ] {
            let text = format!("{PAIR}[errors]\npinion_pitch = {entry}");
            let problems = Spec::parse("spec.toml", &text).unwrap_err();
            let texts: Vec<_> = problems.0.iter().map(|one| format!("{} {:?}", one.message, one.help)).collect();
            assert!(texts.join("\n").contains(said), "{texts:?}");
        }
        let alone =
            Spec::parse("spec.toml", "[errors]\npinion_pitch = { value = 0.009, measured_at = 17 }").unwrap_err();
        assert!(alone.to_string().contains("`pair.normal_module` is missing"), "{alone}");
        let of_rack =
            Spec::parse("spec.toml", &format!("{PAIR}[errors]\nrack_pitch = {{ value = 0.009, measured_at = 17 }}"));
        assert!(of_rack.unwrap_err().to_string().contains("no key `measured_at`"));
    }
}
