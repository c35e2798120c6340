//! The measured spaces of a rack, or teeth of a pinion, and what each does by the formulas. Called for pasted
//! blocks and reports.

use super::{MeasuredTables, Spec};
use crate::deviation::{DeviationValue, Part};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::{Model, PartDeviation};
use crate::judge::{Effect, Feature, MeasuredPart, MeasuredRow};
use crate::quantity::{Angle, Length};
use crate::table::{Measured, PinionTooth, RackSpace};
use crate::trig;

impl Spec {
    /// The same spec with the rack (or the pinion) as measured and nothing else wrong with it.
    #[must_use]
    pub fn measured_only(&self, rack: bool) -> Self {
        let mut spec = Self { errors: Vec::new(), ..self.clone() };
        if rack {
            spec.rack.deviations.clear();
            spec.rack.measured = None;
        } else {
            spec.pinion.deviations.clear();
            spec.pinion.measured = None;
        }
        spec
    }

    /// Whether the spec says that something is wrong with the rack (or the pinion), which a measured table replaces.
    #[must_use]
    pub fn has_other_deviations(&self, rack: bool) -> bool {
        let part = if rack { Part::Rack } else { Part::Pinion };
        self.knows_teeth(part) || self.errors.iter().any(|(kind, _)| kind.part() == part)
    }

    /// What a measured rack or pinion does by the formulas: the rack of `tables`, or else its pinion.
    ///
    /// # Errors
    /// Diagnostics for missing keys, or a value that its formula does not take.
    pub fn measured(&self, tables: &MeasuredTables, model: Model) -> Result<MeasuredPart, Diagnostics> {
        let (is_rack, features, values) = match (&tables.rack, &tables.pinion) {
            (Some(rack), _) => {
                let (features, values) = self.rack_values(&rack.rows)?;
                (true, features, values)
            }
            (None, Some(pinion)) => {
                let (features, values) = pinion_values(&pinion.rows);
                (false, features, values)
            }
            (None, None) => (true, Vec::new(), Vec::new()),
        };
        let zero = |feature: &Feature| (feature.error(), DeviationValue::zero(feature.error()));
        let kinds: Vec<_> = features.iter().map(zero).collect();
        let formulas = if kinds.is_empty() {
            Vec::new()
        } else {
            self.measured_only(is_rack).with_errors(&kinds).part_deviations()?
        };
        let mut rows = Vec::with_capacity(values.len());
        for (number, deviations) in values {
            let mut effects = Vec::with_capacity(deviations.len());
            for (deviation, formula) in deviations.into_iter().zip(&formulas) {
                effects.push(match deviation {
                    None => None,
                    Some(deviation) => {
                        let place = if is_rack { "space" } else { "tooth" };
                        let error = PartDeviation::new(formula.law(), deviation);
                        let delta_cd = error.delta_cd(model).map_err(|problem| {
                            let message = format!("{place} {number}: {}: {problem}", formula.kind());
                            Diagnostic::error(Code::OutOfDomain, message)
                        })?;
                        Some(Effect { deviation, delta_cd })
                    }
                });
            }
            rows.push(MeasuredRow { number, effects });
        }
        rows.sort_by_key(|row| row.number);
        Ok(MeasuredPart { is_rack, model, features, rows })
    }

    /// The transverse pitch along the rack, p_x = π m_n / cos β_r.
    fn rack_pitch(&self) -> Result<Length, Diagnostics> {
        let Some(module) = &self.pair.normal_module else {
            let message = "`pair.normal_module` is missing; positions of spaces need it for their pitch";
            return Err(Diagnostic::error(Code::MissingKey, message)
                .help("add `normal_module = …` below [pair]")
                .into());
        };
        let beta = self.rack.helix_angle.as_ref().map_or(Angle::ZERO, |angle| angle.value);
        let pitch_mm = std::f64::consts::PI * module.value.mm() / trig::sin_cos_of(beta).1;
        Length::nearest(pitch_mm * 1e12, "the pitch")
            .map_err(|error| Diagnostic::error(Code::OutOfDomain, error.to_string()).into())
    }

    fn rack_values(&self, rows: &[RackSpace]) -> Result<Values, Diagnostics> {
        let mut rows: Vec<&RackSpace> = rows.iter().collect();
        rows.sort_by_key(|row| row.space);
        let absolute = rows.iter().any(|row| matches!(row.over_pin, Some(Measured::Absolute(_))));
        let nominal = if absolute { Some(self.nominal_over_pin()?) } else { None };
        let has_position = rows.iter().any(|row| row.position.is_some());
        let absolute = rows.iter().any(|row| matches!(row.position, Some(Measured::Absolute(_))));
        let pitch = if absolute { Some(self.rack_pitch()?) } else { None };
        let mut features = Vec::new();
        let mut include = |feature, present| {
            if present {
                features.push(feature);
            }
            present
        };
        let over_pin = include(Feature::OverPin, rows.iter().any(|row| row.over_pin.is_some()));
        let step = include(Feature::Pitch, has_position);
        let lead = include(Feature::Lead, rows.iter().any(|row| row.lead.is_some()));
        let mut values = Vec::with_capacity(rows.len());
        for (index, row) in rows.iter().enumerate() {
            let mut deviations = Vec::new();
            if over_pin {
                deviations.push(row.over_pin.map(|measured| match (measured, nominal) {
                    (Measured::Absolute(length), Some(nominal)) => DeviationValue::Length(length - nominal),
                    (Measured::Absolute(length) | Measured::Deviation(length), _) => DeviationValue::Length(length),
                }));
            }
            if step {
                let before =
                    index.checked_sub(1).map(|before| rows[before]).filter(|before| before.space + 1 == row.space);
                let positions = before.and_then(|before| Some((before.position?, row.position?)));
                deviations.push(positions.and_then(|positions| match positions {
                    (Measured::Deviation(a), Measured::Deviation(b)) => Some(DeviationValue::Length(b - a)),
                    (Measured::Absolute(a), Measured::Absolute(b)) => {
                        pitch.map(|pitch| DeviationValue::Length(b - a - pitch))
                    }
                    _ => None,
                }));
            }
            if lead {
                deviations.push(row.lead.map(DeviationValue::Angle));
            }
            values.push((row.space, deviations));
        }
        Ok((features, values))
    }
}

/// Features, and the deviations of each space or tooth.
type Values = (Vec<Feature>, Vec<(i64, Vec<Option<DeviationValue>>)>);

fn pinion_values(rows: &[PinionTooth]) -> Values {
    let of = |row: &PinionTooth, feature| match feature {
        Feature::LeftPitch => row.left_pitch,
        Feature::RightPitch => row.right_pitch,
        _ => row.radial,
    };
    let features = [Feature::Radial, Feature::LeftPitch, Feature::RightPitch];
    let features: Vec<_> =
        features.into_iter().filter(|feature| rows.iter().any(|row| of(row, *feature).is_some())).collect();
    let values = rows.iter().map(|row| {
        let deviations = features.iter().map(|feature| of(row, *feature).map(DeviationValue::Length));
        (row.tooth, deviations.collect())
    });
    let values = values.collect();
    (features, values)
}
