//! From rows of measured values to displacements of flanks. The spec layer calls it with the rows; it reads no file.

use std::collections::BTreeMap;
use std::ops::Sub;

use super::error::{DeviationError, DeviationQuantity, MAX_LEAD_RAD, length, within};
use super::{DeviationValue, PinionTooth, RackTooth};
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

/// A value of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowValue {
    /// What was measured.
    pub what: &'static str,
    /// Its deviation.
    pub value: DeviationValue,
}

impl RowValue {
    fn length(what: &'static str, mm: Option<f64>) -> Option<Self> {
        Some(Self { what, value: DeviationValue::from_mm(mm?)? })
    }

    fn lead(rad: Option<f64>) -> Option<Self> {
        Some(Self { what: "lead deviation", value: DeviationValue::from_rad(rad?)? })
    }
}

impl RackSpaceRow {
    /// The name of the position among the values.
    pub const POSITION: &str = "position deviation";

    /// What was measured of the space.
    pub fn values(&self) -> impl Iterator<Item = RowValue> {
        let over_pin = RowValue::length("over-pin", Some(self.height_mm));
        let position = RowValue::length(Self::POSITION, Some(self.position_mm));
        [over_pin, position, RowValue::lead(self.lead_rad)].into_iter().flatten()
    }
}

impl PinionToothRow {
    /// What was measured of the tooth.
    pub fn values(&self) -> impl Iterator<Item = RowValue> {
        let radial = RowValue::length("radial deviation", self.radial_mm);
        let position = RowValue::length("position deviation", self.position_mm);
        let left = RowValue::length("left pitch deviation", self.left_pitch_mm);
        let right = RowValue::length("right pitch deviation", self.right_pitch_mm);
        [radial, position, left, right, RowValue::lead(self.lead_rad)].into_iter().flatten()
    }
}

/// The deviation of each pitch by the number of the later of its two places, from the deviations of both; without one of them
/// there is no pitch. Behind the last of a pinion's `teeth` comes tooth 0.
#[must_use]
pub fn pitch_steps<T: Copy + Sub<Output = T>>(positions: &BTreeMap<i64, T>, teeth: Option<u32>) -> BTreeMap<i64, T> {
    let before = |place: i64| match teeth {
        Some(teeth) if place == 0 => Some(i64::from(teeth) - 1),
        _ => place.checked_sub(1),
    };
    let step = |(&place, &position): (&i64, &T)| Some((place, position - *positions.get(&before(place)?)?));
    positions.iter().filter_map(step).collect()
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

/// The displacements of pinion flanks from the rows of one turn, tooth 0 first.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::{
        PinionDeviation, PinionFlank, PinionFlanks, RackDeviation, RackDeviationKind, RackFlank, RackFlanks, ToothRange,
    };
    use crate::gear::example;

    #[test]
    fn pitches_follow_from_neighbours_and_a_turn_closes() {
        let positions = BTreeMap::from([(-1, 5), (0, 7), (1, 4), (3, 9)]);
        assert_eq!(pitch_steps(&positions, None), BTreeMap::from([(0, 2), (1, -3)]));
        assert_eq!(pitch_steps(&positions, Some(4)), BTreeMap::from([(0, -2), (1, -3)]));
        assert_eq!(pitch_steps(&positions, Some(5)), BTreeMap::from([(1, -3)]));
        assert_eq!(pitch_steps(&BTreeMap::from([(i64::MIN, 1)]), None), BTreeMap::new());
    }

    fn near(value: f64, expected: f64) {
        assert!((value - expected).abs() < 1e-15, "{value} {expected}");
    }

    fn rack_is(flank: RackFlank, along_x_mm: f64, lead_rad: f64) {
        near(flank.along_x_mm, along_x_mm);
        near(flank.lead_rad, lead_rad);
    }

    /// A pin that lies higher and further on: its flanks are closer by 2 h tan α_x, and both further on. Rows add up.
    #[test]
    fn a_space_moves_the_flanks_that_bound_it() {
        let pair = Pair::new(&example(20, 0.3, 0.0)).unwrap();
        let tan_x = 0.5 / trig::cos(0.3);
        let row = |height_mm, position_mm, lead_rad| RackSpaceRow { space: 4, height_mm, position_mm, lead_rad };
        let rows = [row(0.02, 0.005, Some(1e-3)), row(0.01, 0.002, Some(2e-3))];
        let teeth = rack_flanks_from_spaces(&pair, &rows).unwrap();
        assert_eq!(teeth.keys().copied().collect::<Vec<_>>(), [4, 5]);
        rack_is(teeth[&4].right, 0.007 + 0.03 * tan_x, 3e-3);
        rack_is(teeth[&5].left, 0.007 - 0.03 * tan_x, 3e-3);
        rack_is(teeth[&4].left, 0.0, 0.0);
        // they are added to the known deviations
        let added =
            RackFlanks::new(&pair, &[RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Shift(0.1) }])
                .and_then(|flanks| flanks.with_measured(&teeth))
                .and_then(|flanks| flanks.with_measured(&teeth))
                .unwrap();
        rack_is(added.tooth(4).right, 0.1 + 2.0 * (0.007 + 0.03 * tan_x), 6e-3);
        rack_is(added.tooth(5).left, 0.1 + 2.0 * (0.007 - 0.03 * tan_x), 6e-3);
        let lifted = std::collections::BTreeMap::from([(
            4,
            RackTooth { right: RackFlank { along_z_mm: 0.01, ..RackFlank::default() }, ..RackTooth::default() },
        )]);
        let twice =
            RackFlanks::nominal(&pair).with_measured(&lifted).and_then(|flanks| flanks.with_measured(&lifted)).unwrap();
        near(twice.tooth(4).right.along_z_mm, 0.02);
    }

    /// Left and right flanks outward by as much; half of a change of the normal thickness is 1/(2 cos β) along the
    /// rack.
    #[test]
    fn deviations_of_single_flanks_of_the_rack() {
        let pair = Pair::new(&example(20, 0.3, 0.0)).unwrap();
        let flanks = |kind| RackFlanks::new(&pair, &[RackDeviation { teeth: "3..=5".parse().unwrap(), kind }]).unwrap();
        for (kind, left, right) in [
            (RackDeviationKind::Left(0.02), -0.02, 0.0),
            (RackDeviationKind::Right(0.02), 0.0, 0.02),
            (RackDeviationKind::Thickness(0.02), -0.01 / trig::cos(0.3), 0.01 / trig::cos(0.3)),
        ] {
            for (tooth, on) in [(2, 0.0), (3, 1.0), (5, 1.0), (6, 0.0)] {
                rack_is(flanks(kind).tooth(tooth).left, on * left, 0.0);
                rack_is(flanks(kind).tooth(tooth).right, on * right, 0.0);
            }
        }
    }

    /// A tooth line is at most 85° steep, with the helix angle that it has anyway.
    #[test]
    fn the_steepest_tooth_line() {
        let degrees = |value: f64| value * (std::f64::consts::PI / 180.0);
        let pair = Pair::new(&example(20, degrees(-30.0), degrees(40.0))).unwrap();
        let rack = |lead| {
            RackFlanks::nominal(&pair).with_measured(&std::collections::BTreeMap::from([(
                1,
                RackTooth {
                    right: RackFlank { lead_rad: degrees(lead), ..RackFlank::default() },
                    ..RackTooth::default()
                },
            )]))
        };
        assert!(rack(44.9).is_ok());
        assert!(MAX_LEAD_RAD < degrees(54.9) || rack(54.9).is_ok());
        assert!(rack(55.1).is_err());
        let pinion = |lead| {
            let lead_rad = degrees(lead);
            let flank = PinionFlank { lead_rad, ..PinionFlank::default() };
            PinionFlanks::nominal(&pair)
                .with_measured(&[PinionTooth { left: flank, right: flank }])
                .and_then(|flanks| flanks.with_measured(&[PinionTooth { left: flank, right: flank }]))
        };
        assert!(pinion(22.4).is_ok() && pinion(22.6).is_err());
    }

    fn tooth(tooth: i64) -> PinionToothRow {
        PinionToothRow {
            tooth,
            radial_mm: None,
            position_mm: None,
            left_pitch_mm: None,
            right_pitch_mm: None,
            lead_rad: None,
        }
    }

    /// The space after the last tooth is bounded by the first; rows of the same tooth add up.
    #[test]
    fn a_pin_moves_the_flanks_of_its_space_and_a_lead_those_of_its_tooth() {
        let pair = Pair::new(&example(12, 0.0, 0.0)).unwrap();
        let row = PinionToothRow { radial_mm: Some(0.02), position_mm: Some(0.005), lead_rad: Some(1e-3), ..tooth(11) };
        let teeth = pinion_flanks_from_rows(&pair, &[row, row]).unwrap();
        assert_eq!(teeth.len(), 12);
        near(teeth[11].right.arc_mm, 2.0 * (0.005 + 0.01));
        near(teeth[0].left.arc_mm, 2.0 * (0.005 - 0.01));
        near(teeth[11].left.lead_rad, 2e-3);
        near(teeth[11].right.lead_rad, 2e-3);
        assert_eq!(
            (teeth[11].left.arc_mm, teeth[0].right, teeth[1]),
            (0.0, PinionFlank::default(), PinionTooth::default())
        );
        // they are added to the known deviations
        let twice = PinionFlanks::nominal(&pair).with_measured(&teeth).and_then(|flanks| flanks.with_measured(&teeth));
        near(twice.unwrap().teeth()[11].right.arc_mm, 4.0 * (0.005 + 0.01));
        let error = pinion_flanks_from_rows(&pair, &[tooth(12)]);
        assert_eq!(error, Err(DeviationError::NoSuchTooth { tooth: 12, teeth: 12 }));
    }

    /// Pitches −1, 3, 1, 1, … of which the mean of 1 is removed: −2, 2, 0, … add up to −2, 0, 0, …, with the mean −1/6.
    #[test]
    fn pitches_are_summed_closed_and_centred() {
        let pair = Pair::new(&example(12, 0.0, 0.0)).unwrap();
        let rows: Vec<_> = (0..12)
            .map(|j| {
                let pitch = [-0.001, 0.003].get(usize::try_from(j).unwrap()).copied().unwrap_or(0.001);
                PinionToothRow { left_pitch_mm: Some(pitch), ..tooth(j) }
            })
            .collect();
        let teeth = pinion_flanks_from_rows(&pair, &rows).unwrap();
        for (j, tooth) in teeth.iter().enumerate() {
            near(tooth.left.arc_mm, (if j == 0 { -0.002 } else { 0.0 }) + 0.002 / 12.0);
            assert_eq!(tooth.right.arc_mm, 0.0);
        }
        let right: Vec<_> = rows
            .iter()
            .map(|row| PinionToothRow { right_pitch_mm: row.left_pitch_mm, left_pitch_mm: None, ..*row })
            .collect();
        near(pinion_flanks_from_rows(&pair, &right).unwrap()[0].right.arc_mm, -0.002 + 0.002 / 12.0);
        assert_eq!(
            pinion_flanks_from_rows(&pair, &rows[1..]),
            Err(DeviationError::IncompleteTurn { tooth: 0, rows: 0 })
        );
        let twice = [&rows[..], &rows[3..4]].concat();
        assert_eq!(pinion_flanks_from_rows(&pair, &twice), Err(DeviationError::IncompleteTurn { tooth: 3, rows: 2 }));
    }

    /// Components towards tooth 0 and a quarter turn further; those of several add up.
    #[test]
    fn eccentricities_are_vectors() {
        let pair = Pair::new(&example(12, 0.0, 0.0)).unwrap();
        let of = |all: &[(f64, u32)]| {
            let all: Vec<_> =
                all.iter().map(|(amount_mm, tooth)| PinionDeviation::eccentricity(*amount_mm, *tooth)).collect();
            PinionFlanks::new(&pair, &all).unwrap().eccentricity_mm()
        };
        for (all, along, across) in [
            (&[(0.02, 0)][..], 0.02, 0.0),
            (&[(0.02, 3)], 0.0, 0.02),
            (&[(0.02, 1), (0.02, 5)], 0.0, 0.02),
            (&[(0.01, 0), (0.02, 3), (0.01, 0)], 0.02, 0.02),
        ] {
            near(of(all).0, along);
            near(of(all).1, across);
        }
        assert!(PinionFlanks::new(&pair, &[PinionDeviation::eccentricity(0.1, 12)]).is_err());
    }

    /// An error names the quantity and its unit.
    #[test]
    fn errors_are_in_words() {
        let pair = Pair::new(&example(12, 0.0, 0.0)).unwrap();
        let wrong =
            |kind| RackFlanks::new(&pair, &[RackDeviation { teeth: ToothRange::ALL, kind }]).unwrap_err().to_string();
        let long = wrong(RackDeviationKind::Shift(2e6));
        assert!(long.starts_with("displacement") && long.contains(" mm"), "{long}");
        let steep = wrong(RackDeviationKind::Lead(2.0));
        assert!(steep.starts_with("lead deviation") && steep.contains("114.5916°"), "{steep}");
        let mut data = example(12, 2.0, 0.0);
        let steep = Pair::new(&data).unwrap_err().to_string();
        assert!(steep.starts_with("rack helix angle = 114.59"), "{steep}");
        data = example(12, 0.0, 0.0);
        data.normal_module_mm = -1.0;
        assert!(Pair::new(&data).unwrap_err().to_string().starts_with("normal module = -1 mm is"));
    }
}
