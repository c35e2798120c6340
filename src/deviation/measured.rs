//! From rows of measured values to displacements of flanks. Called by the spec layer once it has read the
//! rows, and by the virtual measuring machine's tests; reads no file.

use std::collections::BTreeMap;

use super::error::{DeviationError, DeviationQuantity, MAX_LEAD_RAD, length, within};
use super::{PinionTooth, RackTooth};
use crate::gear::Pair;
use crate::trig;

/// A pin or ball in one space of the rack. Space j lies between the teeth j and j + 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RackSpaceRow {
    /// The space.
    pub space: i64,
    /// Height over the pin less its nominal value, h = M − M_nom, mm.
    pub height_mm: f64,
    /// Position along the rack less its nominal value, t = X − X_nom, mm.
    pub position_mm: f64,
    /// Helix angle deviation of the space, rad, if measured.
    pub lead_rad: Option<f64>,
}

/// One pinion tooth and the space after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinionToothRow {
    /// The tooth, 0 to z − 1.
    pub tooth: i64,
    /// Radial deviation of the space after it, mm, if measured.
    pub radial_mm: Option<f64>,
    /// Position of a pin in that space less its nominal one, as arc at the reference circle towards higher index, mm,
    /// if measured.
    pub position_mm: Option<f64>,
    /// Single pitch deviation f_p of the left flanks, from the tooth before to this one, mm, if measured.
    pub left_pitch_mm: Option<f64>,
    /// Single pitch deviation f_p of the right flanks, from the tooth before to this one, mm, if measured.
    pub right_pitch_mm: Option<f64>,
    /// Helix angle deviation of both flanks of this tooth, rad, if measured.
    pub lead_rad: Option<f64>,
}

/// The displacements of rack flanks that a pin sees: both flanks that bound space j lie t ± h tan α_x from nominal,
/// tan α_x = tan α_n / cos β_r; a space that is too narrow lifts the pin.
///
/// Rows of the same space add up.
///
/// # Errors
/// [`DeviationError::OutOfDomain`] for values that are not finite or longer than 1 km.
pub fn rack_flanks_from_spaces(pair: &Pair, rows: &[RackSpaceRow]) -> Result<BTreeMap<i64, RackTooth>, DeviationError> {
    let tan_x = pair.rack().tan_pressure_angle_x;
    let mut teeth: BTreeMap<i64, RackTooth> = BTreeMap::new();
    for row in rows {
        let lift = length(DeviationQuantity::Displacement, row.height_mm)? * tan_x;
        let along = length(DeviationQuantity::Displacement, row.position_mm)?;
        let lead = within(DeviationQuantity::Lead, row.lead_rad.unwrap_or(0.0), MAX_LEAD_RAD)?;
        let right = &mut teeth.entry(row.space).or_default().right;
        right.along_x_mm += along + lift;
        right.lead_rad += lead;
        let left = &mut teeth.entry(row.space.saturating_add(1)).or_default().left;
        left.along_x_mm += along - lift;
        left.lead_rad += lead;
    }
    Ok(teeth)
}

/// The displacements of pinion flanks that rows of one turn tell, tooth 0 first.
///
/// Radial values move both flanks of their space into it by r tan α_t, positions of a pin both along with it. Single
/// pitch deviations of a flank are summed; since the pitches of a turn must close, their mean is removed first, and
/// since a sum starts at an arbitrary tooth and says nothing about thickness, the mean of the sums is removed too.
/// Positive ones displace a flank towards higher index.
///
/// # Errors
/// [`DeviationError::NoSuchTooth`] for an index outside 0..z−1, [`DeviationError::IncompleteTurn`] if pitches are
/// given for some teeth only or twice, [`DeviationError::OutOfDomain`] for values that are not finite or too large.
pub fn pinion_flanks_from_rows(pair: &Pair, rows: &[PinionToothRow]) -> Result<Vec<PinionTooth>, DeviationError> {
    let z = pair.pinion().teeth;
    let count = z as usize;
    let tan_t = trig::tan(pair.pinion().transverse_pressure_angle_rad);
    let mut teeth = vec![PinionTooth::default(); count];
    let mut pitches: [Vec<Vec<f64>>; 2] = [vec![Vec::new(); count], vec![Vec::new(); count]];
    for row in rows {
        let j = usize::try_from(row.tooth)
            .ok()
            .filter(|&j| j < count)
            .ok_or(DeviationError::NoSuchTooth { tooth: row.tooth, teeth: z })?;
        let arc = length(DeviationQuantity::Displacement, row.radial_mm.unwrap_or(0.0))? * tan_t;
        let position = length(DeviationQuantity::Displacement, row.position_mm.unwrap_or(0.0))?;
        teeth[j].right.arc_mm += position + arc;
        teeth[(j + 1) % count].left.arc_mm += position - arc;
        let lead = within(DeviationQuantity::Lead, row.lead_rad.unwrap_or(0.0), MAX_LEAD_RAD)?;
        teeth[j].left.lead_rad += lead;
        teeth[j].right.lead_rad += lead;
        for (side, pitch) in [row.left_pitch_mm, row.right_pitch_mm].into_iter().enumerate() {
            if let Some(value) = pitch {
                pitches[side][j].push(length(DeviationQuantity::Displacement, value)?);
            }
        }
    }
    for (side, column) in pitches.iter().enumerate() {
        for (tooth, sum) in teeth.iter_mut().zip(cumulative(column)?) {
            if side == 0 {
                tooth.left.arc_mm += sum;
            } else {
                tooth.right.arc_mm += sum;
            }
        }
    }
    Ok(teeth)
}

/// Sums of single pitches over a turn, closed and centred; empty if none were measured.
fn cumulative(column: &[Vec<f64>]) -> Result<Vec<f64>, DeviationError> {
    if column.iter().all(Vec::is_empty) {
        return Ok(Vec::new());
    }
    if let Some((j, rows)) = column.iter().enumerate().find(|(_, rows)| rows.len() != 1) {
        let tooth = i64::try_from(j).unwrap_or(i64::MAX);
        return Err(DeviationError::IncompleteTurn { tooth, rows: rows.len() });
    }
    #[allow(clippy::cast_precision_loss)] // at most 10 000 teeth
    let count = column.len() as f64;
    let mean = column.iter().map(|rows| rows[0]).sum::<f64>() / count;
    let mut sums: Vec<f64> = column
        .iter()
        .scan(0.0, |sum, rows| {
            *sum += rows[0] - mean;
            Some(*sum)
        })
        .collect();
    let centre = sums.iter().sum::<f64>() / count;
    for sum in &mut sums {
        *sum -= centre;
    }
    Ok(sums)
}
