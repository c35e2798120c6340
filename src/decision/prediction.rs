//! What the formulas say about deviations per tooth: the range of ΔCD to hold the exact mesh against.
//!
//! Each deviation is taken as the formula of its kind of error takes it, without regard to which teeth are
//! in contact when: what is on every tooth acts always, what is on some of them acts between nothing and
//! its value. Values are good to a nanometre, for comparison beside a curve.

use crate::deviation::{
    Eccentricity, PinionDeviation, PinionDeviationKind, PinionToothRow, RackDeviation, RackDeviationKind, RackSpaceRow,
    ToothRange,
};
use crate::gear::Pair;
use crate::trig;

/// What one deviation contributes by its formula.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// What it is: `rack pitch, teeth 8..`.
    pub what: String,
    /// The lowest ΔCD, mm.
    pub lower_mm: f64,
    /// The highest ΔCD, mm.
    pub upper_mm: f64,
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
}

impl Prediction {
    /// Starts with no deviation.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The range of the sum, mm.
    #[must_use]
    pub fn range_mm(&self) -> (f64, f64) {
        self.terms.iter().fold((0.0, 0.0), |(low, high), term| (low + term.lower_mm, high + term.upper_mm))
    }

    /// A value that always acts if it is on all teeth, and sometimes if it is on some.
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
                // a shift of every tooth is none
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
                // the paper has no formula for the pinion's lead
                PinionDeviationKind::Lead(_) => {}
            }
        }
        self
    }

    /// Adds an eccentricity of the pinion: a radial error that goes through both signs in a turn.
    #[must_use]
    pub fn eccentricity(mut self, eccentricity: &Eccentricity) -> Self {
        let amount = eccentricity.amount_mm.abs();
        self.terms.push(Predicted { what: "pinion eccentricity".to_owned(), lower_mm: -amount, upper_mm: amount });
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
        let heights = rows.iter().map(|row| row.height_mm);
        let (lower_mm, upper_mm) = extremes(heights);
        self.terms.push(Predicted { what: "rack over-pin, measured".to_owned(), lower_mm, upper_mm });
        let steps = rows.iter().filter_map(|row| {
            let next = rows.iter().find(|other| other.space == row.space + 1);
            next.map(|next| (next.position_mm - row.position_mm).abs())
        });
        self.signed("rack pitch, measured".to_owned(), false, extremes(steps).1.max(0.0) * gains.rack);
        let leads = rows.iter().filter_map(|row| row.lead_rad).map(|lead| trig::sin(lead).abs());
        self.signed("rack lead, measured".to_owned(), false, extremes(leads).1.max(0.0) * gains.lead);
        self
    }

    /// Adds the measured teeth of a pinion: radial values as they are, the largest single pitch deviation.
    #[must_use]
    pub fn pinion_rows(mut self, pair: &Pair, rows: &[PinionToothRow]) -> Self {
        if rows.is_empty() {
            return self;
        }
        let gains = Gains::new(pair);
        if rows.iter().any(|row| row.radial_mm.is_some()) {
            let (lower_mm, upper_mm) = extremes(rows.iter().map(|row| row.radial_mm.unwrap_or(0.0)));
            self.terms.push(Predicted { what: "pinion radial, measured".to_owned(), lower_mm, upper_mm });
        }
        let mut positions: Vec<_> =
            rows.iter().filter_map(|row| row.position_mm.map(|position| (row.tooth, position))).collect();
        positions.sort_unstable_by_key(|(tooth, _)| *tooth);
        let steps = positions.windows(2).filter(|ends| ends[1].0 == ends[0].0 + 1).map(|ends| ends[1].1 - ends[0].1);
        let pitches = rows.iter().flat_map(|row| [row.left_pitch_mm, row.right_pitch_mm]).flatten();
        let pitches = pitches.chain(steps).map(f64::abs);
        self.signed("pinion pitch, measured".to_owned(), false, extremes(pitches).1.max(0.0) * gains.pinion);
        self
    }
}

/// The lowest and highest of some values; 0 where there are none.
fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.map(|value| (value, value)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or((0.0, 0.0))
}

impl Gains {
    fn new(pair: &Pair) -> Self {
        let normal = 0.5 / trig::tan(pair.normal_pressure_angle_rad());
        let cos_rack = trig::cos(pair.rack().helix_angle_rad);
        Self {
            rack: cos_rack * normal,
            normal,
            pinion: trig::cos(pair.pinion().helix_angle_rad) * normal,
            lead: pair.rack().face_width_mm * normal / cos_rack,
        }
    }
}
