//! The measured spaces of a rack, or teeth of a pinion, and what each does by the formulas. Called for pasted
//! blocks and reports.

use super::{MeasuredTables, Spec, keys};
use crate::deviation::{DeviationValue, Part};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::{Model, PartDeviation};
use crate::judge::{Effect, Feature, MeasuredPart, MeasuredRow};
use crate::quantity::Length;
use crate::table::{Measured, PinionTooth, RackSpace};
use crate::trig;

impl Spec {
    /// The same spec with the rack (or the pinion) as measured and nothing else wrong with it.
    #[must_use]
    pub fn measured_only(&self, rack: bool) -> Self {
        let mut spec = Self { errors: Vec::new(), ..self.clone() };
        if rack {
            spec.rack_deviations.clear();
            spec.values.remove(keys::RACK_MEASURED);
        } else {
            spec.pinion_deviations.clear();
            spec.values.remove(keys::PINION_MEASURED);
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
        let place = if is_rack { "space" } else { "tooth" };
        let effect = |number: i64, deviation: DeviationValue, formula: &PartDeviation| {
            let delta_cd = PartDeviation::new(formula.law(), deviation).delta_cd(model);
            let delta_cd = delta_cd.map_err(|problem| {
                let message = format!("{place} {number}: {}: {problem}", formula.kind());
                Diagnostic::error(Code::OutOfDomain, message)
            })?;
            Ok::<_, Diagnostic>(Effect { deviation, delta_cd })
        };
        let mut rows = Vec::with_capacity(values.len());
        for (number, deviations) in values {
            let effects = deviations
                .into_iter()
                .zip(&formulas)
                .map(|(deviation, formula)| deviation.map(|deviation| effect(number, deviation, formula)).transpose());
            rows.push(MeasuredRow { number, effects: effects.collect::<Result<_, _>>()? });
        }
        rows.sort_by_key(|row| row.number);
        Ok(MeasuredPart { is_rack, model, features, rows })
    }

    /// The transverse pitch along the rack, p_x = π m_n / cos β_r.
    fn rack_pitch(&self) -> Result<Length, Diagnostics> {
        let Some(module) = self.get(keys::PAIR_NORMAL_MODULE) else {
            let message = "`pair.normal_module` is missing; positions of spaces need it for their pitch";
            return Err(Diagnostic::error(Code::MissingKey, message)
                .help("add `normal_module = …` below [pair]")
                .into());
        };
        let beta = self.or_zero(keys::RACK_HELIX_ANGLE);
        let pitch_mm = std::f64::consts::PI * module.mm() / trig::sin_cos_of(beta).1;
        Length::nearest(pitch_mm * 1e12, "the pitch")
            .map_err(|error| Diagnostic::error(Code::OutOfDomain, error.to_string()).into())
    }

    fn rack_values(&self, rows: &[RackSpace]) -> Result<Values, Diagnostics> {
        let mut rows: Vec<&RackSpace> = rows.iter().collect();
        rows.sort_by_key(|row| row.space);
        let absolute = rows.iter().any(|row| matches!(row.over_pin, Some(Measured::Absolute(_))));
        let nominal = if absolute { Some(self.nominal_over_pin()?) } else { None };
        let absolute = rows.iter().any(|row| matches!(row.position, Some(Measured::Absolute(_))));
        let pitch = if absolute { Some(self.rack_pitch()?) } else { None };
        let of = |index: usize, feature: &Feature| {
            let row = rows[index];
            match feature {
                Feature::OverPin => row.over_pin.map(|measured| match (measured, nominal) {
                    (Measured::Absolute(length), Some(nominal)) => DeviationValue::Length(length - nominal),
                    (Measured::Absolute(length) | Measured::Deviation(length), _) => DeviationValue::Length(length),
                }),
                Feature::Pitch => {
                    let before = rows[index.checked_sub(1)?];
                    match (before.position?, row.position?) {
                        _ if before.space + 1 != row.space => None,
                        (Measured::Deviation(a), Measured::Deviation(b)) => Some(DeviationValue::Length(b - a)),
                        (Measured::Absolute(a), Measured::Absolute(b)) => Some(DeviationValue::Length(b - a - pitch?)),
                        _ => None,
                    }
                }
                _ => row.lead.map(DeviationValue::Angle),
            }
        };
        let is_measured = |feature: &Feature| match feature {
            Feature::OverPin => rows.iter().any(|row| row.over_pin.is_some()),
            Feature::Pitch => rows.iter().any(|row| row.position.is_some()),
            _ => rows.iter().any(|row| row.lead.is_some()),
        };
        let features = [Feature::OverPin, Feature::Pitch, Feature::Lead].into_iter().filter(is_measured);
        let features: Vec<_> = features.collect();
        let deviations = |(index, row): (usize, &&RackSpace)| {
            (row.space, features.iter().map(|feature| of(index, feature)).collect::<Vec<_>>())
        };
        let values = rows.iter().enumerate().map(deviations).collect();
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
