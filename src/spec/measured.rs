//! The measured spaces of a rack, or teeth of a pinion, with ΔCD of each by the formulas. Used for pasted blocks and reports.

use std::collections::BTreeMap;

use super::{Spec, keys};
use crate::deviation::{DeviationValue, Part, pitch_steps};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::{Model, PartDeviation};
use crate::judge::{Effect, Feature, MeasuredPart, MeasuredRow};
use crate::quantity::{FM_PER_MM, Length};
use crate::table::{Measured, PinionTooth, RackSpace, Teeth};
use crate::trig;

impl Spec {
    /// The spec with a part as measured, and without its other errors.
    #[must_use]
    pub fn measured_only(&self, part: Part) -> Self {
        let mut spec = Self { errors: Vec::new(), ..self.clone() };
        match part {
            Part::Rack => {
                spec.rack_deviations.clear();
                spec.values.remove(keys::RACK_MEASURED);
            }
            Part::Pinion => {
                spec.pinion_deviations.clear();
                spec.values.remove(keys::PINION_MEASURED);
            }
        }
        spec
    }

    /// Whether the spec gives errors of a part, which a measured table replaces.
    #[must_use]
    pub fn has_other_deviations(&self, part: Part) -> bool {
        self.knows_teeth(part) || self.errors.iter().any(|(kind, _)| kind.part() == part)
    }

    /// A measured rack or pinion by the formulas.
    ///
    /// # Errors
    /// Diagnostics for missing keys, or a value that its formula does not take.
    pub fn measured(&self, teeth: &Teeth, model: Model) -> Result<MeasuredPart, Diagnostics> {
        let part = teeth.part();
        let (features, values) = match teeth {
            Teeth::Rack(rack) => self.rack_values(&rack.rows)?,
            Teeth::Pinion(pinion) => self.pinion_values(&self.on_reference_circle(&pinion.rows))?,
        };
        let zero = |feature: &Feature| (feature.error(), DeviationValue::zero(feature.error()));
        let kinds: Vec<_> = features.iter().map(zero).collect();
        let formulas = if kinds.is_empty() {
            Vec::new()
        } else {
            self.measured_only(part).with_errors(&kinds).part_deviations()?
        };
        let place = if part == Part::Rack { "space" } else { "tooth" };
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
        Ok(MeasuredPart { part, model, features, rows })
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
        Length::nearest(pitch_mm * FM_PER_MM, "the pitch")
            .map_err(|error| Diagnostic::error(Code::OutOfDomain, error.to_string()).into())
    }

    /// The positions of pins along the rack less their nominal ones, by their spaces: space j is nominally at (j + 1/2) p_x.
    pub(super) fn position_deviations(&self, rows: &[RackSpace]) -> Result<BTreeMap<i64, Length>, Diagnostics> {
        let is_absolute = |row: &RackSpace| matches!(row.position, Some(Measured::Absolute(_)));
        let pitch = if rows.iter().any(is_absolute) { self.rack_pitch()? } else { Length::ZERO };
        let mut positions = BTreeMap::new();
        for row in rows {
            match row.position {
                Some(Measured::Deviation(length)) => positions.insert(row.space, length),
                Some(Measured::Absolute(length)) => {
                    let halves = (2 * i128::from(row.space) + 1) * i128::from(pitch.fm());
                    let nominal = i64::try_from(halves.div_euclid(2)).map_err(|_| {
                        let message = format!("line {}: space {} is beyond every rack", row.line, row.space);
                        Diagnostic::error(Code::OutOfDomain, message)
                    })?;
                    positions.insert(row.space, length - Length::from_fm(nominal))
                }
                None => None,
            };
        }
        Ok(positions)
    }

    fn rack_values(&self, rows: &[RackSpace]) -> Result<Values, Diagnostics> {
        let absolute = rows.iter().any(|row| matches!(row.over_pin, Some(Measured::Absolute(_))));
        let nominal = if absolute { Some(self.nominal_over_pin()?) } else { None };
        let pitches = pitch_steps(&self.position_deviations(rows)?, None);
        let of = |row: &RackSpace, feature: &Feature| match feature {
            Feature::OverPin => row.over_pin.map(|measured| match (measured, nominal) {
                (Measured::Absolute(length), Some(nominal)) => DeviationValue::Length(length - nominal),
                (Measured::Absolute(length) | Measured::Deviation(length), _) => DeviationValue::Length(length),
            }),
            Feature::Pitch => pitches.get(&row.space).copied().map(DeviationValue::Length),
            _ => row.lead.map(DeviationValue::Angle),
        };
        let is_measured = |feature: &Feature| match feature {
            Feature::Pitch => rows.iter().any(|row| row.position.is_some()),
            feature => rows.iter().any(|row| of(row, feature).is_some()),
        };
        let features = [Feature::OverPin, Feature::Pitch, Feature::Lead].into_iter().filter(is_measured);
        let features: Vec<_> = features.collect();
        let deviations =
            |row: &RackSpace| (row.space, features.iter().map(|feature| of(row, feature)).collect::<Vec<_>>());
        let values = rows.iter().map(deviations).collect();
        Ok((features, values))
    }

    fn pinion_values(&self, rows: &[PinionTooth]) -> Result<Values, Diagnostics> {
        let positions: BTreeMap<_, _> = rows.iter().filter_map(|row| Some((row.tooth, row.position?))).collect();
        let pitches = if positions.is_empty() {
            BTreeMap::new()
        } else {
            let teeth = self.get(keys::PINION_TEETH).ok_or_else(|| {
                let message =
                    "`pinion.teeth` is missing; positions need it for the step from the last tooth to the first";
                Diagnostic::error(Code::MissingKey, message).help("add `teeth = …` below [pinion]")
            })?;
            pitch_steps(&positions, Some(teeth))
        };
        let slope = |row: &PinionTooth| row.lead.map(|lead| Ok((row.tooth, self.slope_of_pinion(lead)?)));
        let slopes = rows.iter().filter_map(slope).collect::<Result<BTreeMap<_, _>, Diagnostics>>()?;
        let of = |row: &PinionTooth, feature: &Feature| match feature {
            Feature::LeftPitch => row.left_pitch,
            Feature::RightPitch => row.right_pitch,
            Feature::PinPitch => pitches.get(&row.tooth).copied(),
            Feature::HelixSlope => slopes.get(&row.tooth).copied(),
            _ => row.radial,
        };
        let is_measured = |feature: &Feature| match feature {
            Feature::PinPitch => !positions.is_empty(),
            feature => rows.iter().any(|row| of(row, feature).is_some()),
        };
        let features =
            [Feature::Radial, Feature::PinPitch, Feature::LeftPitch, Feature::RightPitch, Feature::HelixSlope];
        let features: Vec<_> = features.into_iter().filter(is_measured).collect();
        let values = rows.iter().map(|row| {
            let deviations = features.iter().map(|feature| of(row, feature).map(DeviationValue::Length));
            (row.tooth, deviations.collect())
        });
        let values = values.collect();
        Ok((features, values))
    }
}

/// Features, and the deviations of each space or tooth.
type Values = (Vec<Feature>, Vec<(i64, Vec<Option<DeviationValue>>)>);
