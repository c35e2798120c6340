//! Deviations of the pinion, per tooth and flank. The spec layer builds them, the mesh and the multibody model read them; they
//! do not depend on the pinion's rotation.

use super::error::{DeviationError, DeviationQuantity, MAX_HELIX_RAD, MAX_LEAD_RAD, length, within};
use super::{PinionForm, ToothRange};
use crate::gear::Pair;
use crate::trig;

/// One deviation of some of the pinion's teeth. Any number of them add up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinionDeviation {
    /// The teeth it is on, 0 to z − 1.
    pub teeth: ToothRange,
    /// The kind, with its value.
    pub kind: PinionDeviationKind,
}

/// A kind of deviation of a pinion tooth. Lengths in mm, angles in rad; lengths other than `Radial` and
/// `Eccentricity` are arcs at the reference circle.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum PinionDeviationKind {
    /// The tooth shifted towards higher index.
    Shift(f64),
    /// Transverse thickness changed; half to each flank.
    Thickness(f64),
    /// The flanks' helix angle at the reference cylinder changed; the section at mid-width stays.
    Lead(f64),
    /// The left flank (facing lower index) moved, outward positive.
    Left(f64),
    /// The right flank (facing higher index) moved, outward positive.
    Right(f64),
    /// The space after this tooth sits higher by this: both its flanks move into the space by Δr tan α_t.
    Radial(f64),
    /// The whole tooth system sits off the axis of rotation, displaced towards the centre line of this tooth at mid-width,
    /// so that the centre distance grows by the amount when the tooth points at the rack. Several add up as vectors.
    Eccentricity(f64),
}

impl PinionDeviation {
    /// An eccentricity of this amount, mm, towards a tooth.
    #[must_use]
    pub fn eccentricity(amount_mm: f64, tooth: u32) -> Self {
        Self { teeth: ToothRange::of(tooth), kind: PinionDeviationKind::Eccentricity(amount_mm) }
    }
}

/// Where one flank of a pinion tooth is, relative to nominal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PinionFlank {
    /// Arc at the reference circle towards higher index, mm (outward for a right flank, inward for a left one).
    pub arc_mm: f64,
    /// Change of the helix angle at the reference cylinder, rad.
    pub lead_rad: f64,
}

/// Both flanks of a pinion tooth.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PinionTooth {
    /// The flank that faces lower tooth indices.
    pub left: PinionFlank,
    /// The flank that faces higher tooth indices.
    pub right: PinionFlank,
}

/// All deviations of a pinion.
#[derive(Debug, Clone, PartialEq)]
pub struct PinionFlanks {
    teeth: Vec<PinionTooth>,
    form: PinionForm,
    eccentricity_mm: (f64, f64),
    helix_angle_rad: f64,
}

impl PinionFlanks {
    /// A pinion without deviations.
    #[must_use]
    pub fn nominal(pair: &Pair) -> Self {
        Self {
            teeth: vec![PinionTooth::default(); pair.pinion().teeth as usize],
            form: PinionForm::default(),
            eccentricity_mm: (0.0, 0.0),
            helix_angle_rad: pair.pinion().helix_angle_rad,
        }
    }

    /// A pinion with deviations, which add up.
    ///
    /// # Errors
    /// [`DeviationError::NoSuchTooth`] for an index outside 0..z−1, [`DeviationError::OutOfDomain`] for a value that
    /// is not finite, longer than 1 km, or turns a helix beyond 85°.
    pub fn new(pair: &Pair, deviations: &[PinionDeviation]) -> Result<Self, DeviationError> {
        let mut flanks = Self::nominal(pair);
        let tan_t = trig::tan(pair.pinion().transverse_pressure_angle_rad);
        let z = flanks.teeth.len();
        for deviation in deviations {
            let first = deviation.teeth.first().map_or(Ok(0), |tooth| flanks.index(tooth))?;
            let last = deviation.teeth.last().map_or(Ok(z - 1), |tooth| flanks.index(tooth))?;
            for j in first..=last {
                flanks.apply(j, deviation.kind, tan_t)?;
            }
        }
        flanks.check_leads()?;
        Ok(flanks)
    }

    fn apply(&mut self, j: usize, kind: PinionDeviationKind, tan_t: f64) -> Result<(), DeviationError> {
        let z = self.teeth.len();
        match kind {
            PinionDeviationKind::Shift(value) => {
                self.teeth[j].left.arc_mm += length(DeviationQuantity::Displacement, value)?;
                self.teeth[j].right.arc_mm += value;
            }
            PinionDeviationKind::Thickness(value) => {
                self.teeth[j].left.arc_mm -= length(DeviationQuantity::Displacement, value)? / 2.0;
                self.teeth[j].right.arc_mm += value / 2.0;
            }
            PinionDeviationKind::Left(value) => {
                self.teeth[j].left.arc_mm -= length(DeviationQuantity::Displacement, value)?;
            }
            PinionDeviationKind::Right(value) => {
                self.teeth[j].right.arc_mm += length(DeviationQuantity::Displacement, value)?;
            }
            PinionDeviationKind::Radial(value) => {
                let arc = length(DeviationQuantity::Displacement, value)? * tan_t;
                self.teeth[j].right.arc_mm += arc;
                self.teeth[(j + 1) % z].left.arc_mm -= arc;
            }
            PinionDeviationKind::Lead(value) => {
                self.teeth[j].left.lead_rad += within(DeviationQuantity::Lead, value, MAX_LEAD_RAD)?;
                self.teeth[j].right.lead_rad += value;
            }
            PinionDeviationKind::Eccentricity(value) => {
                let (sin, cos) = trig::sin_cos(std::f64::consts::TAU * (j as f64 / z as f64));
                let amount = length(DeviationQuantity::Eccentricity, value)?;
                self.eccentricity_mm.0 += amount * cos;
                self.eccentricity_mm.1 += amount * sin;
            }
        }
        Ok(())
    }

    /// The pinion moved further off its axis by the components of [`eccentricity_mm`](Self::eccentricity_mm).
    ///
    /// # Errors
    /// [`DeviationError::OutOfDomain`] as for [`PinionFlanks::new`].
    pub fn with_offset(mut self, (along, across): (f64, f64)) -> Result<Self, DeviationError> {
        self.eccentricity_mm.0 += length(DeviationQuantity::Eccentricity, along)?;
        self.eccentricity_mm.1 += length(DeviationQuantity::Eccentricity, across)?;
        Ok(self)
    }

    /// The pinion with measured displacements added, one per tooth, as
    /// [`pinion_flanks_from_rows`](super::pinion_flanks_from_rows) gives them.
    ///
    /// # Errors
    /// [`DeviationError::OutOfDomain`] as for [`PinionFlanks::new`]; [`DeviationError::NoSuchTooth`] if there are
    /// more rows than teeth.
    pub fn with_measured(mut self, measured: &[PinionTooth]) -> Result<Self, DeviationError> {
        for (j, row) in measured.iter().enumerate() {
            let j = self.index(i64::try_from(j).unwrap_or(i64::MAX))?;
            let PinionTooth { left, right } = &mut self.teeth[j];
            for (flank, add) in [(left, row.left), (right, row.right)] {
                flank.arc_mm += length(DeviationQuantity::Displacement, add.arc_mm)?;
                flank.lead_rad += within(DeviationQuantity::Lead, add.lead_rad, MAX_LEAD_RAD)?;
            }
        }
        self.check_leads()?;
        Ok(self)
    }

    /// The pinion with flank form.
    ///
    /// # Errors
    /// [`DeviationError::NegativeForm`] for a negative crowning, [`DeviationError::OutOfDomain`] for a length that is not finite or
    /// longer than 1 km.
    pub fn with_form(mut self, form: PinionForm) -> Result<Self, DeviationError> {
        self.form = form.checked()?;
        Ok(self)
    }

    fn index(&self, tooth: i64) -> Result<usize, DeviationError> {
        let teeth = self.teeth.len();
        usize::try_from(tooth)
            .ok()
            .filter(|&j| j < teeth)
            .ok_or(DeviationError::NoSuchTooth { tooth, teeth: u32::try_from(teeth).unwrap_or(u32::MAX) })
    }

    fn check_leads(&self) -> Result<(), DeviationError> {
        let limit = MAX_HELIX_RAD - self.helix_angle_rad.abs();
        for flank in self.teeth.iter().flat_map(|tooth| [tooth.left, tooth.right]) {
            within(DeviationQuantity::Lead, flank.lead_rad, limit)?;
        }
        Ok(())
    }

    /// The form of all flanks.
    #[must_use]
    pub const fn form(&self) -> &PinionForm {
        &self.form
    }

    /// The flanks of every tooth, 0 to z − 1.
    #[must_use]
    pub fn teeth(&self) -> &[PinionTooth] {
        &self.teeth
    }

    /// The eccentricity's components towards tooth 0 and a quarter turn further towards higher index, mm.
    #[must_use]
    pub const fn eccentricity_mm(&self) -> (f64, f64) {
        self.eccentricity_mm
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::example;

    fn flank(arc_mm: f64, lead_rad: f64) -> PinionFlank {
        PinionFlank { arc_mm, lead_rad }
    }

    #[test]
    fn measured_flanks_are_added_to_what_is_there() {
        let pair = Pair::new(&example(12, 0.0, 0.0)).unwrap();
        let all = |kind| PinionDeviation { teeth: ToothRange::ALL, kind };
        let known =
            PinionFlanks::new(&pair, &[all(PinionDeviationKind::Shift(0.25)), all(PinionDeviationKind::Lead(0.125))]);
        let row = PinionTooth { left: flank(0.5, 0.0625), right: flank(-0.5, 0.03125) };
        let flanks = known.unwrap().with_measured(&[PinionTooth::default(), row]).unwrap();
        let both = PinionTooth { left: flank(0.25, 0.125), right: flank(0.25, 0.125) };
        assert_eq!(flanks.teeth()[0], both);
        let sum = PinionTooth { left: flank(0.75, 0.1875), right: flank(-0.25, 0.15625) };
        assert_eq!(flanks.teeth()[1..3], [sum, both]);
        let many = vec![row; 13];
        let error = DeviationError::NoSuchTooth { tooth: 12, teeth: 12 };
        assert_eq!(flanks.with_measured(&many), Err(error));
    }

    #[test]
    fn helices_end_at_85_degrees() {
        let degree = std::f64::consts::PI / 180.0;
        for helix in [-60.0, 60.0] {
            let pair = Pair::new(&example(12, 0.0, helix * degree)).unwrap();
            let lead = |degrees: f64| {
                let kind = PinionDeviationKind::Lead(degrees * degree);
                PinionFlanks::new(&pair, &[PinionDeviation { teeth: ToothRange::ALL, kind }])
            };
            assert!(lead(24.9).is_ok() && lead(-24.9).is_ok());
            for degrees in [25.1, -25.1] {
                let Err(DeviationError::OutOfDomain { quantity, limit, .. }) = lead(degrees) else {
                    panic!("too steep")
                };
                assert_eq!(quantity, DeviationQuantity::Lead);
                assert!((limit - 25.0 * degree).abs() < 1e-12);
            }
        }
    }
}
