//! The measured tables that a spec names: each row as the deviations of a space or tooth.

use crate::deviation::plausible;
use crate::deviation::{DeviationKind, DeviationValue, PinionToothRow, RackSpaceRow, RowValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::gear::Pair;
use crate::quantity::{Angle, Length};
use crate::spec::resolve::Problems;
use crate::spec::{Located, Spec, keys, said_of};
use crate::table::{Measured, PinionTeeth, PinionTooth, RackSpaces, Teeth};

/// The tables that a spec names, read by the caller.
#[derive(Debug, Clone, Default)]
pub struct MeasuredTables {
    /// `rack.measured`
    pub rack: Option<RackSpaces>,
    /// `pinion.measured`
    pub pinion: Option<PinionTeeth>,
}

impl MeasuredTables {
    /// The tables with these teeth in place of the measured ones of their part.
    #[must_use]
    pub fn with(self, teeth: Teeth) -> Self {
        match teeth {
            Teeth::Rack(rack) => Self { rack: Some(rack), ..self },
            Teeth::Pinion(pinion) => Self { pinion: Some(pinion), ..self },
        }
    }
}

impl Spec {
    /// Refuses a table of a pinion with a tooth that does not exist, or a deviation that no tooth can have.
    pub(super) fn check_pinion_rows(&self, teeth: &PinionTeeth, rows: &[PinionToothRow]) -> Result<(), Diagnostic> {
        let count = self.get(keys::PINION_TEETH).map_or(i64::MAX, i64::from);
        for row in &teeth.rows {
            if !(0..count).contains(&row.tooth) {
                let (name, line, tooth, last) = (&teeth.name, row.line, row.tooth, count - 1);
                let message = format!("{name}, line {line}: tooth {tooth} does not exist: the teeth are 0 to {last}");
                return Err(Diagnostic::error(Code::BadTeeth, message).help(if tooth == count {
                    format!("count the teeth from 0: tooth {tooth} is tooth 0 of the next turn")
                } else {
                    "count the teeth from 0".to_owned()
                }));
            }
        }
        for (line, row) in teeth.rows.iter().map(|row| row.line).zip(rows) {
            if let Some(diagnostic) = self.impossible_row(&teeth.name, line, row.values()) {
                return Err(diagnostic.help("check the unit of the column"));
            }
        }
        Ok(())
    }

    /// Why a row of a table has no deviation, if one of its values is impossible.
    fn impossible_row(&self, table: &str, line: u64, values: impl IntoIterator<Item = RowValue>) -> Option<Diagnostic> {
        values.into_iter().find_map(|RowValue { what, value }| {
            let doubt = plausible::deviation(value, self.module()).filter(|doubt| doubt.is_impossible)?;
            Some(Diagnostic::error(Code::Implausible, format!("{table}, line {line}: {what}: {doubt}")))
        })
    }

    /// Measured values less their nominal ones.
    pub(super) fn rack_rows(&self, spaces: &RackSpaces, pair: &Pair) -> Result<Vec<RackSpaceRow>, Diagnostics> {
        let absolute = spaces.rows.iter().find(|row| matches!(row.over_pin, Some(Measured::Absolute(_))));
        let nominal = match absolute {
            Some(_) => Some(self.nominal_over_pin()?),
            None => None,
        };
        let mut rows = Vec::with_capacity(spaces.rows.len());
        for row in &spaces.rows {
            let height = match (row.over_pin, nominal) {
                (Some(Measured::Deviation(length)), _) => length.mm(),
                (Some(Measured::Absolute(length)), Some(nominal)) => (length - nominal).mm(),
                _ => 0.0,
            };
            // tooth indices are far below 2⁵³
            let nominal_position = (row.space as f64 + 0.5) * pair.rack().pitch_mm;
            let position = match &row.position {
                Some(Measured::Deviation(length)) => length.mm(),
                Some(Measured::Absolute(length)) => length.mm() - nominal_position,
                None => 0.0,
            };
            let lead_rad = row.lead.map(Angle::radians);
            let read = RackSpaceRow { space: row.space, height_mm: height, position_mm: position, lead_rad };
            // messages about a position name its place
            let is_doubted = |value: &RowValue| value.what != RackSpaceRow::POSITION;
            if let Some(diagnostic) = self.impossible_row(&spaces.name, row.line, read.values().filter(is_doubted)) {
                return Err(diagnostic.help("check the units, `rack.pin` and `rack.datum`").into());
            }
            if position.abs() > pair.rack().pitch_mm / 2.0 {
                let message = format!(
                    "{}, line {}: the pin of space {} stands {position:.4} mm from its nominal position {nominal_position:.4} mm, more than half a pitch",
                    spaces.name, row.line, row.space
                );
                let diagnostic = Diagnostic::error(Code::OutOfDomain, message)
                    .help("space j is nominally at (j + 1/2) p_x; shift the positions, or give `position_deviation`");
                return Err(diagnostic.into());
            }
            rows.push(read);
        }
        Ok(rows)
    }

    /// The nominal measure over the pin: that of `errors.rack_over_roller`, or computed for `rack.pin`.
    ///
    /// # Errors
    /// Diagnostics for missing keys, or a thickness that leaves no space.
    pub fn nominal_over_pin(&self) -> Result<Length, Diagnostics> {
        let given = said_of(&self.nominals, DeviationKind::RackOverRoller);
        if let Some(Located { value: DeviationValue::Length(nominal), .. }) = given {
            return Ok(*nominal);
        }
        let mut problems = Problems::default();
        let place = self.place(keys::RACK_MEASURED);
        let who = || {
            let place = place.clone().map(|span| (span, "has absolute over-pin values".to_owned()));
            ("the nominal measure over the pin".to_owned(), place)
        };
        let pin = problems.take(self, keys::RACK_PIN, who);
        let over_pin = self.over_pin_of(pin.unwrap_or(Length::ZERO), &mut problems, &who);
        problems
            .answer(over_pin, &self.source)?
            .measure()
            .map_err(|error| Diagnostic::error(Code::OutOfDomain, error.to_string()).into())
    }

    /// The nominal measure M over the roller of `errors.rack_over_roller` or over `rack.pin`, computed; `None` if a key is missing,
    /// or the pin has no place.
    #[must_use]
    pub fn computed_over_pin(&self) -> Option<Length> {
        let of_pin =
            || self.over_pin_of(self.get(keys::RACK_PIN)?, &mut Problems::default(), &|| (String::new(), None));
        self.over_pin().or_else(of_pin)?.measure().ok()
    }
}

/// The rows of a pinion's table as deviations.
pub(super) fn pinion_rows(rows: &[PinionTooth]) -> Vec<PinionToothRow> {
    let mm = |length: &Option<Length>| length.map(Length::mm);
    rows.iter()
        .map(|row| PinionToothRow {
            tooth: row.tooth,
            radial_mm: mm(&row.radial),
            position_mm: mm(&row.position),
            left_pitch_mm: mm(&row.left_pitch),
            right_pitch_mm: mm(&row.right_pitch),
            lead_rad: row.lead.map(Angle::radians),
        })
        .collect()
}
