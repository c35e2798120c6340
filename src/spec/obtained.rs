//! The measured values of a spec as deviations that standards limit. `class --obtained` calls it; it knows no grades.

use std::collections::BTreeMap;

use super::keys::Key;
use super::{KeyType, MeasuredTables, Spec, keys};
use crate::deviation::{DeviationKind, DeviationValue, Extent, Part, pitch_steps};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::judge::bound::{HelixOfPinion, pinion_helix_slope_mm};
use crate::judge::class::NO_OVER_ROLLER_CLASS;
use crate::quantity::{Angle, FM_PER_MM, Length};
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
    /// The measured quantity in words.
    pub origin: String,
}

impl Spec {
    /// The deviations from `[errors]` and the measured tables. From a table: F_r is the largest less the
    /// smallest radial value, f_pt the largest single pitch deviation, F_p the largest less the smallest sum of
    /// them, F_pz/8 the largest sum of k, f_Hβ the largest lead deviation over the face width.
    ///
    /// # Errors
    /// Diagnostics for gear data that an error needs.
    pub fn measured_deviations(&self, tables: &MeasuredTables) -> Result<Vec<MeasuredValue>, Diagnostics> {
        let mut values = Vec::new();
        if self.errors.iter().any(|(_, written)| !written.value.is_permitted()) {
            for error in self.part_deviations()?.iter().filter(|error| !error.is_tolerance()) {
                let part = error.kind().part();
                let amount = match error.value() {
                    DeviationValue::Length(length) => length.abs(),
                    DeviationValue::Angle(angle) => self.slope_of_rack(trig::tan_of(angle))?,
                    DeviationValue::Slope(tangent) => self.slope_of_rack(tangent)?,
                };
                let origin = format!("[errors] {}", error.kind().key());
                let graded = graded_as(error.kind(), error.extent());
                values.push(MeasuredValue { part, graded, amount, origin });
            }
        }
        if let Some(rack) = &tables.rack {
            let slopes = rack.rows.iter().filter_map(|row| row.lead).map(|lead| self.slope_of_rack(trig::tan_of(lead)));
            let slope = slopes.collect::<Result<Vec<_>, _>>()?.into_iter().max();
            let positions = self.position_deviations(&rack.rows)?;
            values.extend(of_table(Part::Rack, &rack.name, of_spaces(&rack.rows, &positions), slope));
        }
        if let Some(pinion) = &tables.pinion {
            let slopes = pinion.rows.iter().filter_map(|row| row.lead).map(|lead| self.slope_of_pinion(lead));
            let slope = slopes.collect::<Result<Vec<_>, _>>()?.into_iter().map(Length::abs).max();
            let told = of_teeth(&self.on_reference_circle(&pinion.rows), self.or_zero(keys::PINION_TEETH));
            values.extend(of_table(Part::Pinion, &pinion.name, told, slope));
        }
        Ok(values)
    }

    /// f_Hβ over the face width for a lead deviation of the rack with this tangent.
    fn slope_of_rack(&self, tangent: f64) -> Result<Length, Diagnostics> {
        let width = self.for_slope(keys::RACK_FACE_WIDTH)?;
        slope(width.mm() * tangent.abs())
    }

    /// f_Hβ of a helix angle deviation of the pinion: over the face width, along the transverse base tangent; with its sign.
    pub(super) fn slope_of_pinion(&self, lead: Angle) -> Result<Length, Diagnostics> {
        let pinion = HelixOfPinion {
            normal_pressure_angle_rad: self.for_slope(keys::PAIR_NORMAL_PRESSURE_ANGLE)?.radians(),
            helix_angle_rad: self.or_zero(keys::PINION_HELIX_ANGLE).radians(),
            face_width_mm: self.for_slope(keys::PINION_FACE_WIDTH)?.mm(),
        };
        slope(pinion_helix_slope_mm(pinion, lead.radians()))
    }

    fn for_slope<T: KeyType>(&self, key: Key<T>) -> Result<T, Diagnostics> {
        self.get(key).ok_or_else(|| {
            let message = format!("`{}` is missing; f_Hβ of a lead deviation needs it", key.any.path);
            Diagnostic::error(Code::MissingKey, message).into()
        })
    }
}

fn slope(mm: f64) -> Result<Length, Diagnostics> {
    Length::nearest(mm * FM_PER_MM, "f_Hβ").map_err(|error| Diagnostic::error(Code::NoResult, error.to_string()).into())
}

/// The deviations from a table and its largest f_Hβ, with the name of the table.
fn of_table(
    part: Part,
    table: &str,
    mut told: Vec<Told>,
    slope: Option<Length>,
) -> impl Iterator<Item = MeasuredValue> {
    told.push(Told::of(Ok(Deviation::HelixSlope), slope, "largest lead deviation"));
    told.into_iter().filter_map(move |Told { graded, amount, what }| {
        Some(MeasuredValue { part, graded, amount: amount?, origin: format!("{what} in {table}") })
    })
}

/// A deviation from a table; no amount if too little was measured.
struct Told {
    graded: Result<Deviation, &'static str>,
    amount: Option<Length>,
    what: &'static str,
}

impl Told {
    const fn of(graded: Result<Deviation, &'static str>, amount: Option<Length>, what: &'static str) -> Self {
        Self { graded, amount, what }
    }
}

fn of_spaces(rows: &[RackSpace], positions: &BTreeMap<i64, Length>) -> Vec<Told> {
    let height =
        |row: &RackSpace| row.over_pin.map(|(Measured::Absolute(length) | Measured::Deviation(length))| length);
    let heights: Vec<Length> = rows.iter().filter_map(height).collect();
    let positions_in_order: Vec<_> = positions.values().copied().collect();
    let largest = pitch_steps(positions, None).into_values().map(Length::abs).max();
    vec![
        Told::of(Err(NO_RUNOUT_OF_A_RACK), spread(&heights), "over-pin values, largest less smallest"),
        Told::of(Ok(Deviation::SinglePitch), largest, "differences of neighbouring position deviations"),
        Told::of(Ok(Deviation::TotalPitch), spread(&positions_in_order), "position deviations, largest less smallest"),
    ]
}

fn of_teeth(rows: &[PinionTooth], teeth: u32) -> Vec<Told> {
    let radial: Vec<Length> = rows.iter().filter_map(|row| row.radial).collect();
    let flanks = [|row: &PinionTooth| row.left_pitch, |row: &PinionTooth| row.right_pitch]
        .map(|pitch| rows.iter().filter_map(|row| Some((row.tooth, pitch(row)?))).collect::<BTreeMap<_, _>>());
    let positions: BTreeMap<_, _> = rows.iter().filter_map(|row| Some((row.tooth, row.position?))).collect();
    let steps = pitch_steps(&positions, Some(teeth));
    let largest = flanks.iter().chain([&steps]).flat_map(BTreeMap::values).map(|pitch| pitch.abs()).max();
    // sums mean something only over a whole turn
    let is_whole = |flank: &&BTreeMap<i64, Length>| teeth > 0 && flank.len() == teeth as usize;
    let in_order = |flank: &BTreeMap<i64, Length>| flank.values().copied().collect::<Vec<_>>();
    let sums = flanks.iter().filter(is_whole).map(|flank| sums_over_a_turn(&in_order(flank)));
    let sums: Vec<_> = sums.chain([&positions].into_iter().filter(is_whole).map(in_order)).collect();
    let pitches = (teeth as usize / 8).max(2);
    let sectors = sums
        .iter()
        .flat_map(|sums| (0..sums.len()).map(move |tooth| (sums[(tooth + pitches) % sums.len()] - sums[tooth]).abs()));
    let told = |deviation, amount, what| Told::of(Ok(deviation), amount, what);
    vec![
        told(Deviation::Runout, spread(&radial), "radial deviations, largest less smallest"),
        told(Deviation::SinglePitch, largest, "largest single pitch deviation"),
        told(
            Deviation::TotalPitch,
            sums.iter().filter_map(|sums| spread(sums)).max(),
            "cumulative pitch deviations, largest less smallest",
        ),
        told(Deviation::SectorPitch, sectors.max(), "largest cumulative pitch deviation over k pitches"),
    ]
}

const NO_RUNOUT_OF_A_RACK: &str = "the standards grade the runout of a wheel about its axis, and a rack has none";
const NO_RUNOUT: &str =
    "a standard grades the runout, the largest less the smallest radial value of all spaces, not one value";

/// One value of `[errors]` as a deviation.
fn graded_as(kind: DeviationKind, extent: Extent) -> Result<Deviation, &'static str> {
    match (kind, extent) {
        (DeviationKind::RackOverRoller, _) => Err(NO_OVER_ROLLER_CLASS),
        (DeviationKind::PinionRadial, _) => Err(NO_RUNOUT),
        (DeviationKind::RackPitch | DeviationKind::PinionPitch, Extent::Total) => Ok(Deviation::TotalPitch),
        (DeviationKind::RackPitch | DeviationKind::PinionPitch, _) => Ok(Deviation::SinglePitch),
        (DeviationKind::RackLead | DeviationKind::PinionLead, _) => Ok(Deviation::HelixSlope),
    }
}

/// The largest less the smallest; `None` for fewer than two values.
fn spread(values: &[Length]) -> Option<Length> {
    if values.len() < 2 {
        return None;
    }
    Some(*values.iter().max()? - *values.iter().min()?)
}

/// Sums of single pitch deviations around a turn, without the mean pitch deviation, because a turn closes.
fn sums_over_a_turn(pitches: &[Length]) -> Vec<Length> {
    let mean = pitches.iter().map(|pitch| pitch.mm()).sum::<f64>() / pitches.len().max(1) as f64;
    let mean = Length::nearest(mean * FM_PER_MM, "the mean pitch deviation").unwrap_or(Length::ZERO);
    let mut total = Length::ZERO;
    pitches
        .iter()
        .map(|pitch| {
            total = total + (*pitch - mean);
            total
        })
        .collect()
}
