//! What a spec says was measured, as deviations that standards limit. Called by `class --obtained`; knows no grades.

use std::collections::BTreeMap;

use super::{MeasuredTables, Spec, WrittenError, keys};
use crate::deviation::{DeviationKind, DeviationValue, Extent, Part};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::judge::class::NO_OVER_ROLLER_CLASS;
use crate::quantity::{Angle, Length};
use crate::standard::Deviation;
use crate::table::{Measured, PinionTooth, RackSpace};
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
        let (rack, pinion) = (&tables.rack, &tables.pinion);
        let of_rack = rack.as_ref().map(|table| {
            let lead = table.rows.iter().filter_map(|row| row.lead).map(Angle::abs).max();
            (Part::Rack, &table.name, of_spaces(&table.rows), lead)
        });
        let of_pinion = pinion.as_ref().map(|table| {
            let lead = table.rows.iter().filter_map(|row| row.lead).map(Angle::abs).max();
            (Part::Pinion, &table.name, of_teeth(&table.rows, self.or_zero(keys::PINION_TEETH) as usize), lead)
        });
        for (part, table, mut all, lead) in of_rack.into_iter().chain(of_pinion) {
            let slope = lead.map(|lead| self.slope(part, trig::tan_of(lead))).transpose()?;
            all.push(told(Ok(Deviation::HelixSlope), slope, "largest lead deviation"));
            values.extend(all.into_iter().filter_map(|Told { graded, amount, what }| {
                Some(MeasuredValue { part, graded, amount: amount?, origin: format!("{what} in {table}") })
            }));
        }
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
}

/// What a table tells of a deviation; no amount if too little was measured.
struct Told {
    graded: Result<Deviation, &'static str>,
    amount: Option<Length>,
    what: &'static str,
}

fn told(graded: Result<Deviation, &'static str>, amount: Option<Length>, what: &'static str) -> Told {
    Told { graded, amount, what }
}

fn of_spaces(rows: &[RackSpace]) -> Vec<Told> {
    let height =
        |row: &RackSpace| row.over_pin.map(|(Measured::Absolute(length) | Measured::Deviation(length))| length);
    let heights: Vec<Length> = rows.iter().filter_map(height).collect();
    // position deviations of neighbouring spaces differ by the pitch deviation
    let position = |row: &RackSpace| match row.position? {
        Measured::Deviation(length) => Some((row.space, length)),
        Measured::Absolute(_) => None,
    };
    let positions: BTreeMap<i64, Length> = rows.iter().filter_map(position).collect();
    let step = |(space, position): (&i64, &Length)| positions.get(&(space + 1)).map(|next| (*next - *position).abs());
    let steps = positions.iter().filter_map(step).max();
    let positions: Vec<Length> = positions.values().copied().collect();
    vec![
        told(Err(NO_RUNOUT_OF_A_RACK), spread(&heights), "over-pin values, largest less smallest"),
        told(Ok(Deviation::SinglePitch), steps, "differences of neighbouring position deviations"),
        told(Ok(Deviation::TotalPitch), spread(&positions), "position deviations, largest less smallest"),
    ]
}

fn of_teeth(rows: &[PinionTooth], teeth: usize) -> Vec<Told> {
    let radial: Vec<Length> = rows.iter().filter_map(|row| row.radial).collect();
    let flanks = [|row: &PinionTooth| row.left_pitch, |row: &PinionTooth| row.right_pitch]
        .map(|pitch| rows.iter().filter_map(|row| Some((row.tooth, pitch(row)?))).collect::<BTreeMap<_, _>>());
    let largest = flanks.iter().flat_map(BTreeMap::values).map(|pitch| pitch.abs()).max();
    // sums mean something only over a whole turn
    let whole = flanks.iter().filter(|flank| teeth > 0 && flank.len() == teeth);
    let sums: Vec<_> = whole.map(|flank| centred_sums(&flank.values().copied().collect::<Vec<_>>())).collect();
    let pitches = (teeth / 8).max(2);
    let sectors = sums
        .iter()
        .flat_map(|sums| (0..sums.len()).map(move |tooth| (sums[(tooth + pitches) % sums.len()] - sums[tooth]).abs()));
    let cumulative = sums.iter().filter_map(|sums| spread(sums)).max();
    vec![
        told(Ok(Deviation::Runout), spread(&radial), "radial deviations, largest less smallest"),
        told(Ok(Deviation::SinglePitch), largest, "largest single pitch deviation"),
        told(Ok(Deviation::TotalPitch), cumulative, "cumulative pitch deviations, largest less smallest"),
        told(Ok(Deviation::SectorPitch), sectors.max(), "largest cumulative pitch deviation over k pitches"),
    ]
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
