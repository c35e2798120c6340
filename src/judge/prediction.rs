//! The formulas' range of ΔCD for deviations per tooth, for comparison with the exact mesh.
//!
//! Each deviation goes through the formula of its kind of error, whichever teeth are in contact: a deviation on every tooth
//! always acts, one on some teeth acts between 0 and its value. Values are good to a nanometre.

use super::bound::{HelixOfPinion, pinion_helix_slope_mm};
use super::reached::Run;
use super::reached::placed::TEETH;
use crate::deviation::{
    Countable, DeviationKind, DeviationValue, Extent, Part, PinionDeviation, PinionDeviationKind, PinionToothRow,
    RackDeviation, RackDeviationKind, RackSpaceRow, ToothRange, pitch_steps,
};
use crate::formula::law::{RADIANS_PER_DEGREE, unit_gain};
use crate::formula::{Model, PartDeviation};
use crate::gear::Pair;
use crate::mesh::FlankSide;
use crate::quantity::{Angle, DomainError, Length};
use crate::trig;

/// The contribution of one deviation by its formula.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// The deviation in words: `rack pitch, teeth 8..`.
    pub what: String,
    /// The lowest ΔCD, mm.
    pub lower_mm: f64,
    /// The highest ΔCD, mm.
    pub upper_mm: f64,
}

/// An error and the teeth that it is on.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedError {
    /// The error.
    pub error: PartDeviation,
    /// Where the error is; nowhere if there is no run.
    pub runs: Vec<Run>,
}

impl PlacedError {
    /// The error's contribution by its formula: on every tooth always its value, on some teeth between 0 and its value.
    ///
    /// # Errors
    /// [`DomainError`] if a run has a value that the formula does not take.
    pub fn predicted(&self, pair: &Pair) -> Result<Predicted, DomainError> {
        let mut ends = Vec::new();
        for run in &self.runs {
            let value = match self.error.value() {
                DeviationValue::Length(_) => DeviationValue::Length(Length::from_mm(run.value)?),
                _ => DeviationValue::Angle(Angle::from_degrees(run.value / RADIANS_PER_DEGREE)?),
            };
            let mm = self.error.with_value(value).delta_cd(Model::Exact)?.mm();
            ends.extend(if self.is_everywhere(run, pair) { [mm, mm] } else { [mm, 0.0] });
        }
        // an error on no tooth has no effect
        let (lower_mm, upper_mm) = extremes(ends.into_iter()).unwrap_or_default();
        Ok(Predicted { what: self.in_words(pair), lower_mm, upper_mm })
    }

    /// The error and its teeth: `rack over-roller, spaces 3 to 5`.
    #[must_use]
    pub fn in_words(&self, pair: &Pair) -> String {
        let places: Vec<_> = self.runs.iter().map(|run| self.place(run, pair)).collect();
        let places = if places.is_empty() { "nowhere".to_owned() } else { places.join(" and ") };
        format!("{}, {places}", self.error.kind())
    }

    fn place(&self, run: &Run, pair: &Pair) -> String {
        let kind = self.error.kind();
        let counted = match kind.counts() {
            Countable::Pitch if self.error.extent() == Extent::Total => Countable::Tooth,
            counted => counted,
        };
        let (every, one, several) = match counted {
            Countable::Space => ("every space", "space", "spaces"),
            Countable::Pitch => ("every pitch", "before tooth", "before teeth"),
            Countable::Tooth => ("every tooth", "tooth", "teeth"),
        };
        let flank = match run.side {
            Some(FlankSide::Left) => "left flank of ",
            Some(FlankSide::Right) => "right flank of ",
            None => "",
        };
        let number = |place: i64| match kind.part() {
            Part::Rack => place,
            Part::Pinion => place.rem_euclid(i64::from(pair.pinion().teeth)),
        };
        let (first, last) = (number(run.first), number(run.last));
        if self.is_everywhere(run, pair) {
            format!("{flank}{every}")
        } else if first == last {
            format!("{flank}{one} {first}")
        } else {
            format!("{flank}{several} {first} to {last}")
        }
    }

    fn is_everywhere(&self, run: &Run, pair: &Pair) -> bool {
        match self.error.kind().part() {
            Part::Rack => run.first <= *TEETH.start() && run.last >= *TEETH.end(),
            Part::Pinion => run.last - run.first + 1 >= i64::from(pair.pinion().teeth),
        }
    }
}

/// The formulas' contributions and their sum.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Prediction {
    /// One per deviation that a formula knows.
    pub terms: Vec<Predicted>,
}

/// Factors from a displacement to ΔCD.
struct Gains {
    /// Along the rack's axis: cos β_r / (2 tan α_n)
    rack: f64,
    /// In the rack's normal plane: 1 / (2 tan α_n)
    normal: f64,
    /// Transverse on the pinion: cos β_p / (2 tan α_n)
    pinion: f64,
    /// k / (2 cos β_r tan α_n)
    lead: f64,
    /// Along the transverse base tangent of the pinion: cos β_b / (2 sin α_n)
    pinion_lead: f64,
}

impl Prediction {
    /// Starts with no deviation.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The contributions of errors on the teeth that they are put on.
    ///
    /// # Errors
    /// As [`PlacedError::predicted`].
    pub fn placed(pair: &Pair, errors: &[PlacedError]) -> Result<Self, DomainError> {
        Ok(Self { terms: errors.iter().map(|error| error.predicted(pair)).collect::<Result<_, _>>()? })
    }

    /// The range of the sum, mm.
    #[must_use]
    pub fn range_mm(&self) -> (f64, f64) {
        self.terms.iter().fold((0.0, 0.0), |(low, high), term| (low + term.lower_mm, high + term.upper_mm))
    }

    /// A value that acts always if it is on all teeth, else between 0 and the value.
    fn signed(&mut self, what: String, everywhere: bool, value: f64) {
        let (lower_mm, upper_mm) = if everywhere { (value, value) } else { (value.min(0.0), value.max(0.0)) };
        self.terms.push(Predicted { what, lower_mm, upper_mm });
    }

    /// Adds deviations of the rack.
    #[must_use]
    pub fn rack(mut self, pair: &Pair, deviations: &[RackDeviation]) -> Self {
        let gains = Gains::new(pair);
        for RackDeviation { teeth, kind } in deviations {
            let all = *teeth == ToothRange::ALL;
            let what = |name: &str| format!("rack {name}, teeth {teeth}");
            match kind {
                RackDeviationKind::OverRoller(value) => self.signed(what("over-roller"), all, *value),
                RackDeviationKind::Thickness(value) => self.signed(what("thickness"), all, value * gains.normal),
                RackDeviationKind::Left(value) => self.signed(what("left flank"), all, value * gains.rack),
                RackDeviationKind::Right(value) => self.signed(what("right flank"), all, value * gains.rack),
                RackDeviationKind::Pitch(value) => self.signed(what("pitch"), false, value.abs() * gains.rack),
                // shifting all teeth alike changes nothing
                RackDeviationKind::Shift(_) if all => self.signed(what("shift"), true, 0.0),
                RackDeviationKind::Shift(value) => self.signed(what("shift"), false, value.abs() * gains.rack),
                RackDeviationKind::Lead(value) => self.signed(what("lead"), all, trig::sin(*value).abs() * gains.lead),
            }
        }
        self
    }

    /// Adds deviations of the pinion.
    #[must_use]
    pub fn pinion(mut self, pair: &Pair, deviations: &[PinionDeviation]) -> Self {
        let gains = Gains::new(pair);
        for PinionDeviation { teeth, kind } in deviations {
            let all = *teeth == ToothRange::ALL;
            let what = |name: &str| format!("pinion {name}, teeth {teeth}");
            match kind {
                PinionDeviationKind::Radial(value) => self.signed(what("radial"), all, *value),
                PinionDeviationKind::Thickness(value) => self.signed(what("thickness"), all, value * gains.pinion),
                PinionDeviationKind::Left(value) => self.signed(what("left flank"), all, value * gains.pinion),
                PinionDeviationKind::Right(value) => self.signed(what("right flank"), all, value * gains.pinion),
                PinionDeviationKind::Shift(_) if all => self.signed(what("shift"), true, 0.0),
                PinionDeviationKind::Shift(value) => self.signed(what("pitch"), false, value.abs() * gains.pinion),
                // only the exact mesh takes helices of single teeth
                PinionDeviationKind::Lead(_) => {}
                // an eccentricity is a radial error that goes through both signs in a turn
                PinionDeviationKind::Eccentricity(value) => {
                    let what = "pinion eccentricity".to_owned();
                    self.terms.push(Predicted { what, lower_mm: -value.abs(), upper_mm: value.abs() });
                }
            }
        }
        self
    }

    /// Adds a helix slope deviation f_Hβ of the pinion that is given as one value.
    #[must_use]
    pub fn pinion_lead(mut self, pair: &Pair, deviation_mm: f64) -> Self {
        let upper = deviation_mm.abs() * Gains::new(pair).pinion_lead;
        self.signed("pinion lead".to_owned(), false, upper);
        self
    }

    /// Adds the measured spaces of a rack: over-pin values as they are, the largest step between
    /// neighbouring positions, the largest lead.
    #[must_use]
    pub fn rack_rows(mut self, pair: &Pair, rows: &[RackSpaceRow]) -> Self {
        if rows.is_empty() {
            return self;
        }
        let gains = Gains::new(pair);
        if let Some((lower_mm, upper_mm)) = extremes(rows.iter().map(|row| row.height_mm)) {
            self.terms.push(Predicted { what: "rack over-pin, measured".to_owned(), lower_mm, upper_mm });
        }
        let positions = rows.iter().map(|row| (row.space, row.position_mm)).collect();
        let steps = pitch_steps(&positions, None).into_values();
        self.signed("rack pitch, measured".to_owned(), false, largest(steps) * gains.rack);
        let leads = rows.iter().filter_map(|row| row.lead_rad).map(trig::sin);
        self.signed("rack lead, measured".to_owned(), false, largest(leads) * gains.lead);
        self
    }

    /// Adds the measured teeth of a pinion: radial values as they are; the largest step between neighbouring
    /// positions and the largest single pitch deviation of either flank side, which are independent and add up; the largest lead.
    #[must_use]
    pub fn pinion_rows(mut self, pair: &Pair, rows: &[PinionToothRow]) -> Self {
        if rows.is_empty() {
            return self;
        }
        let gains = Gains::new(pair);
        if let Some((lower_mm, upper_mm)) = extremes(rows.iter().filter_map(|row| row.radial_mm)) {
            self.terms.push(Predicted { what: "pinion radial, measured".to_owned(), lower_mm, upper_mm });
        }
        let positions = rows.iter().filter_map(|row| Some((row.tooth, row.position_mm?))).collect();
        let steps = pitch_steps(&positions, Some(pair.pinion().teeth));
        let left = rows.iter().filter_map(|row| row.left_pitch_mm);
        let right = rows.iter().filter_map(|row| row.right_pitch_mm);
        let pitch = largest(steps.into_values()) + largest(left) + largest(right);
        self.signed("pinion pitch, measured".to_owned(), false, pitch * gains.pinion);
        if rows.iter().any(|row| row.lead_rad.is_some()) {
            let slope = |lead| pinion_helix_slope_mm(HelixOfPinion::of(pair), lead);
            let slope = largest(rows.iter().filter_map(|row| row.lead_rad).map(slope));
            self.signed("pinion lead, measured".to_owned(), false, slope * gains.pinion_lead);
        }
        self
    }
}

/// The largest magnitude; 0 where there is none.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

/// The lowest and highest of some values; `None` where there are none.
fn extremes(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.map(|value| (value, value)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

impl Gains {
    fn new(pair: &Pair) -> Self {
        let tan_alpha = trig::tan(pair.normal_pressure_angle_rad());
        let gain = |kind, model, helix: f64| unit_gain(kind, model, tan_alpha, trig::cos(helix));
        let (rack, pinion) = (pair.rack().helix_angle_rad, pair.pinion().helix_angle_rad);
        Self {
            rack: gain(DeviationKind::RackPitch, Model::Exact, rack),
            normal: gain(DeviationKind::RackPitch, Model::Paper, rack),
            pinion: gain(DeviationKind::PinionPitch, Model::Exact, pinion),
            pinion_lead: gain(DeviationKind::PinionLead, Model::Exact, pinion),
            lead: pair.rack().face_width_mm * gain(DeviationKind::RackLead, Model::Exact, rack),
        }
    }
}

#[cfg(test)]
pub(super) mod tests;
