//! What a spec says was measured, as deviations that standards limit. Called by `class --obtained`; knows no grades.

use std::collections::BTreeMap;

use super::{MeasuredTables, Spec, WrittenError, keys};
use crate::deviation::{DeviationKind, DeviationValue, Extent, Part};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::judge::class::NO_OVER_ROLLER_CLASS;
use crate::quantity::{Angle, Length};
use crate::standard::Deviation;
use crate::table::Measured;
use crate::trig;

/// A measured deviation of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredValue {
    /// The part.
    pub part: Part,
    /// The deviation that a standard grades, or why it grades none.
    pub graded: Result<Deviation, &'static str>,
    /// Its magnitude.
    pub amount: Length,
    /// What was measured, in words.
    pub origin: String,
}

impl Spec {
    /// The deviations that `[errors]` and the measured tables tell. From a table: F_r is the largest less the
    /// smallest radial value, f_pt the largest single pitch deviation, F_p the largest less the smallest sum of
    /// them, F_pz/8 the largest sum of k, f_Hβ the largest lead deviation over the face width.
    ///
    /// # Errors
    /// Diagnostics for gear data that an error needs.
    pub fn measured_deviations(&self, tables: &MeasuredTables) -> Result<Vec<MeasuredValue>, Diagnostics> {
        let mut values = Vec::new();
        if self.errors.iter().any(|(_, written)| !matches!(written.value, WrittenError::Class(_))) {
            for error in self.part_deviations()?.iter().filter(|error| !error.is_tolerance()) {
                let part = error.kind().part();
                let amount = match error.value() {
                    DeviationValue::Length(length) => length.abs(),
                    DeviationValue::Angle(angle) => self.slope(part, trig::tan_of(angle))?,
                    DeviationValue::Slope(tangent) => self.slope(part, tangent)?,
                };
                let origin = format!("[errors] {}", error.kind().key());
                let graded = graded_as(error.kind(), error.extent());
                values.push(MeasuredValue { part, graded, amount, origin });
            }
        }
        self.of_rack_table(tables, &mut values)?;
        self.of_pinion_table(tables, &mut values)?;
        Ok(values)
    }

    /// f_Hβ of a lead deviation, of which this is the tangent: over the face width.
    fn slope(&self, part: Part, tangent: f64) -> Result<Length, Diagnostics> {
        let key = match part {
            Part::Rack => keys::RACK_FACE_WIDTH,
            Part::Pinion => keys::PINION_FACE_WIDTH,
        };
        let width = self.get(key).ok_or_else(|| {
            Diagnostic::error(
                Code::MissingKey,
                format!("`{}` is missing; f_Hβ of a lead deviation needs it", key.any.path),
            )
        })?;
        Length::nearest(width.mm() * tangent.abs() * 1e12, "f_Hβ")
            .map_err(|error| Diagnostic::error(Code::NoResult, error.to_string()).into())
    }

    fn of_rack_table(&self, tables: &MeasuredTables, values: &mut Vec<MeasuredValue>) -> Result<(), Diagnostics> {
        let Some(table) = &tables.rack else { return Ok(()) };
        let mut push = |deviation, amount: Length, what: &str| {
            let origin = format!("{what} in {}", table.name);
            values.push(MeasuredValue { part: Part::Rack, graded: deviation, amount, origin });
        };
        let heights: Vec<Length> = table
            .rows
            .iter()
            .filter_map(|row| row.over_pin.as_ref())
            .map(|measured| match measured {
                Measured::Absolute(length) | Measured::Deviation(length) => *length,
            })
            .collect();
        if let Some(spread) = spread(&heights) {
            push(Err(NO_RUNOUT_OF_A_RACK), spread, "over-pin values, largest less smallest");
        }
        // position deviations of neighbouring spaces differ by the pitch deviation
        let positions: BTreeMap<i64, Length> = table
            .rows
            .iter()
            .filter_map(|row| match row.position.as_ref()? {
                Measured::Deviation(length) => Some((row.space, *length)),
                Measured::Absolute(_) => None,
            })
            .collect();
        let steps =
            positions.iter().filter_map(|(space, position)| Some((*positions.get(&(space + 1))? - *position).abs()));
        if let Some(step) = steps.max() {
            push(Ok(Deviation::SinglePitch), step, "differences of neighbouring position deviations");
        }
        let all: Vec<Length> = positions.into_values().collect();
        if let Some(spread) = spread(&all) {
            push(Ok(Deviation::TotalPitch), spread, "position deviations, largest less smallest");
        }
        if let Some(lead) = table.rows.iter().filter_map(|row| row.lead).map(Angle::abs).max() {
            push(Ok(Deviation::HelixSlope), self.slope(Part::Rack, trig::tan_of(lead))?, "largest lead deviation");
        }
        Ok(())
    }

    fn of_pinion_table(&self, tables: &MeasuredTables, values: &mut Vec<MeasuredValue>) -> Result<(), Diagnostics> {
        let Some(table) = &tables.pinion else { return Ok(()) };
        let mut push = |deviation, amount: Length, what: &str| {
            let origin = format!("{what} in {}", table.name);
            values.push(MeasuredValue { part: Part::Pinion, graded: Ok(deviation), amount, origin });
        };
        let radial: Vec<Length> = table.rows.iter().filter_map(|row| row.radial).collect();
        if let Some(spread) = spread(&radial) {
            push(Deviation::Runout, spread, "radial deviations, largest less smallest");
        }
        let of_flank = |left: bool| -> BTreeMap<i64, Length> {
            let pitch = |row: &crate::table::PinionTooth| if left { row.left_pitch } else { row.right_pitch };
            table.rows.iter().filter_map(|row| Some((row.tooth, pitch(row)?))).collect()
        };
        let flanks = [of_flank(true), of_flank(false)];
        if let Some(largest) = flanks.iter().flat_map(BTreeMap::values).map(|pitch| pitch.abs()).max() {
            push(Deviation::SinglePitch, largest, "largest single pitch deviation");
        }
        let teeth = self.or_zero(keys::PINION_TEETH) as usize;
        // sums mean something only over a whole turn
        let whole: Vec<Vec<Length>> = flanks
            .iter()
            .filter(|flank| teeth > 0 && flank.len() == teeth)
            .map(|flank| flank.values().copied().collect())
            .collect();
        let totals = whole.iter().filter_map(|flank| spread(&centred_sums(flank)));
        if let Some(total) = totals.max() {
            push(Deviation::TotalPitch, total, "cumulative pitch deviations, largest less smallest");
        }
        let pitches = (teeth / 8).max(2);
        let sectors = whole.iter().flat_map(|flank| {
            let sums = centred_sums(flank);
            (0..flank.len()).map(move |tooth| (sums[(tooth + pitches) % sums.len()] - sums[tooth]).abs())
        });
        if let Some(sector) = sectors.max() {
            push(Deviation::SectorPitch, sector, "largest cumulative pitch deviation over k pitches");
        }
        if let Some(lead) = table.rows.iter().filter_map(|row| row.lead).map(Angle::abs).max() {
            push(Deviation::HelixSlope, self.slope(Part::Pinion, trig::tan_of(lead))?, "largest lead deviation");
        }
        Ok(())
    }
}

const NO_RUNOUT_OF_A_RACK: &str = "the standards grade the runout of a wheel about its axis, and a rack has none";
const NO_RUNOUT: &str =
    "a standard grades the runout, the largest less the smallest radial value of all spaces, not one value";

/// The deviation that one value of `[errors]` is.
fn graded_as(kind: DeviationKind, extent: Extent) -> Result<Deviation, &'static str> {
    match (kind, extent) {
        (DeviationKind::RackOverRoller, _) => Err(NO_OVER_ROLLER_CLASS),
        (DeviationKind::PinionRadial, _) => Err(NO_RUNOUT),
        (DeviationKind::RackPitch | DeviationKind::PinionPitch, Extent::Total) => Ok(Deviation::TotalPitch),
        (DeviationKind::RackPitch | DeviationKind::PinionPitch, _) => Ok(Deviation::SinglePitch),
        (DeviationKind::RackLead | DeviationKind::PinionLead, _) => Ok(Deviation::HelixSlope),
    }
}

/// The largest less the smallest; `None` of fewer than two.
fn spread(values: &[Length]) -> Option<Length> {
    if values.len() < 2 {
        return None;
    }
    Some(*values.iter().max()? - *values.iter().min()?)
}

/// Sums of single pitch deviations around a turn, their mean removed, because a turn closes.
fn centred_sums(pitches: &[Length]) -> Vec<Length> {
    let mean = pitches.iter().map(|pitch| pitch.mm()).sum::<f64>() / pitches.len().max(1) as f64;
    let mean = Length::nearest(mean * 1e12, "the mean pitch deviation").unwrap_or(Length::ZERO);
    let mut total = Length::ZERO;
    pitches
        .iter()
        .map(|pitch| {
            total = total + (*pitch - mean);
            total
        })
        .collect()
}
