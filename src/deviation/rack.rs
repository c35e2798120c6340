//! Deviations of the rack, per tooth and flank. The spec layer builds them, the mesh and the multibody model evaluate them
//! tooth by tooth, so that a long rack costs nothing; they do not depend on which teeth are in contact.

use std::collections::BTreeMap;

use super::error::{DeviationError, DeviationQuantity, MAX_HELIX_RAD, MAX_LEAD_RAD, length, within};
use super::{RackForm, ToothRange};
use crate::gear::Pair;
use crate::trig;

/// One deviation of some of the rack's teeth. Any number of them add up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RackDeviation {
    /// The teeth it is on.
    pub teeth: ToothRange,
    /// The kind, with its value.
    pub kind: RackDeviationKind,
}

/// A kind of deviation of a rack tooth. Lengths in mm, angles in rad.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum RackDeviationKind {
    /// Both flank planes shifted along Z; the tip plane stays.
    OverRoller(f64),
    /// The pitch before each of these teeth is longer by this; later teeth keep the sum.
    Pitch(f64),
    /// The teeth shifted along X.
    Shift(f64),
    /// Normal tooth thickness at the reference plane changed; half to each flank.
    Thickness(f64),
    /// Helix angle deviation, positive towards right hand: each flank turned about the vertical through its own
    /// point at Y = 0, Z = 0, its inclination to Z kept.
    Lead(f64),
    /// The left flank (facing −X) moved along X, outward positive.
    Left(f64),
    /// The right flank (facing +X) moved along X, outward positive.
    Right(f64),
}

/// Where one flank of a rack tooth is, relative to nominal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RackFlank {
    /// Displacement along +X at Y = 0, Z = 0, mm (outward for a right flank, inward for a left one).
    pub along_x_mm: f64,
    /// Displacement along +Z, mm; applied after the turn.
    pub along_z_mm: f64,
    /// Turn of the tooth line, positive towards right hand, rad.
    pub lead_rad: f64,
}

/// Both flanks of a rack tooth.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RackTooth {
    /// The flank that faces −X.
    pub left: RackFlank,
    /// The flank that faces +X.
    pub right: RackFlank,
}

/// All deviations of a rack.
#[derive(Debug, Clone, PartialEq)]
pub struct RackFlanks {
    deviations: Vec<RackDeviation>,
    /// The indices of deviations on one tooth alone, by tooth, and of those on several teeth or that move the teeth behind them: a
    /// tooth then checks only a few of many.
    of_tooth: BTreeMap<i64, Vec<usize>>,
    of_many: Vec<usize>,
    /// The sum of the pitch deviations of single steps up to a tooth, mm, where it changes.
    pitch_sums: BTreeMap<i64, f64>,
    measured: BTreeMap<i64, RackTooth>,
    form: RackForm,
    /// Normal thickness to displacement of each flank along X, 1/(2 cos β_r).
    thickness_to_x: f64,
    helix_angle_rad: f64,
}

impl RackFlanks {
    /// A rack without deviations.
    #[must_use]
    pub fn nominal(pair: &Pair) -> Self {
        let helix_angle_rad = pair.rack().helix_angle_rad;
        Self {
            deviations: Vec::new(),
            of_tooth: BTreeMap::new(),
            of_many: Vec::new(),
            pitch_sums: BTreeMap::new(),
            measured: BTreeMap::new(),
            form: RackForm::default(),
            thickness_to_x: 0.5 / trig::cos(helix_angle_rad),
            helix_angle_rad,
        }
    }

    /// A rack with deviations, which add up.
    ///
    /// # Errors
    /// [`DeviationError::OutOfDomain`] if a value is not finite, longer than 1 km, or turns a tooth line beyond 85°.
    pub fn new(pair: &Pair, deviations: &[RackDeviation]) -> Result<Self, DeviationError> {
        let mut flanks = Self::nominal(pair);
        for deviation in deviations {
            match deviation.kind {
                RackDeviationKind::Lead(value) => {
                    within(DeviationQuantity::Lead, value, MAX_LEAD_RAD)?;
                }
                RackDeviationKind::OverRoller(value)
                | RackDeviationKind::Pitch(value)
                | RackDeviationKind::Shift(value)
                | RackDeviationKind::Thickness(value)
                | RackDeviationKind::Left(value)
                | RackDeviationKind::Right(value) => {
                    length(DeviationQuantity::Displacement, value)?;
                }
            }
        }
        flanks.check_lead(largest_lead(deviations))?;
        flanks.deviations = deviations.to_vec();
        for (number, RackDeviation { teeth, kind }) in deviations.iter().enumerate() {
            match (teeth.first(), kind) {
                (Some(tooth), kind) if teeth.last() == Some(tooth) => match kind {
                    RackDeviationKind::Pitch(step) => *flanks.pitch_sums.entry(tooth).or_default() += step,
                    _ => flanks.of_tooth.entry(tooth).or_default().push(number),
                },
                _ => flanks.of_many.push(number),
            }
        }
        let mut sum = 0.0;
        for step in flanks.pitch_sums.values_mut() {
            sum += *step;
            *step = sum;
        }
        Ok(flanks)
    }

    /// The rack with deviations added to those that it has.
    ///
    /// # Errors
    /// [`DeviationError::OutOfDomain`] as for [`RackFlanks::new`].
    pub fn with_deviations(self, pair: &Pair, more: &[RackDeviation]) -> Result<Self, DeviationError> {
        let Self { deviations, of_tooth, of_many, pitch_sums, .. } =
            Self::new(pair, &[&self.deviations, more].concat())?;
        Ok(Self { deviations, of_tooth, of_many, pitch_sums, ..self })
    }

    /// The rack with measured displacements of single teeth added to those that it has, as
    /// [`rack_flanks_from_spaces`](super::rack_flanks_from_spaces) gives them.
    ///
    /// # Errors
    /// [`DeviationError::OutOfDomain`] as for [`RackFlanks::new`].
    pub fn with_measured(mut self, measured: &BTreeMap<i64, RackTooth>) -> Result<Self, DeviationError> {
        for (tooth, measured) in measured {
            let known = self.measured.entry(*tooth).or_default();
            for (flank, add) in [(&mut known.left, measured.left), (&mut known.right, measured.right)] {
                flank.along_x_mm += add.along_x_mm;
                flank.along_z_mm += add.along_z_mm;
                flank.lead_rad += add.lead_rad;
            }
        }
        for (tooth, known) in &self.measured {
            let all = self.tooth(*tooth);
            for (known, all) in [(known.left, all.left), (known.right, all.right)] {
                length(DeviationQuantity::Displacement, known.along_x_mm)?;
                length(DeviationQuantity::Displacement, known.along_z_mm)?;
                self.check_lead(known.lead_rad)?;
                self.check_lead(all.lead_rad)?;
            }
        }
        Ok(self)
    }

    /// The rack with flank form.
    ///
    /// # Errors
    /// [`DeviationError::NegativeForm`] for a negative amount, [`DeviationError::ReliefStart`] for a relief that starts above the
    /// tip, [`DeviationError::OutOfDomain`] for a length that is not finite or longer than 1 km.
    pub fn with_form(mut self, pair: &Pair, form: RackForm) -> Result<Self, DeviationError> {
        self.form = form.checked(pair.rack().addendum_mm)?;
        Ok(self)
    }

    fn check_lead(&self, lead: f64) -> Result<(), DeviationError> {
        within(DeviationQuantity::Lead, lead, MAX_HELIX_RAD - self.helix_angle_rad.abs()).map(drop)
    }

    /// The form of all flanks.
    #[must_use]
    pub const fn form(&self) -> &RackForm {
        &self.form
    }

    /// The deviations that may be on a tooth, in their order, without the pitches of single steps.
    fn near(&self, tooth: i64) -> impl Iterator<Item = &RackDeviation> {
        let mut own = self.of_tooth.get(&tooth).map_or(&[][..], Vec::as_slice).iter().peekable();
        let mut many = self.of_many.iter().peekable();
        let numbers = std::iter::from_fn(move || match (own.peek(), many.peek()) {
            (Some(one), Some(other)) if one > other => many.next(),
            (Some(_), _) => own.next(),
            (None, _) => many.next(),
        });
        numbers.map(|number| &self.deviations[*number])
    }

    /// Where the flanks of a tooth are.
    #[must_use]
    pub fn tooth(&self, index: i64) -> RackTooth {
        let mut tooth = self.measured.get(&index).copied().unwrap_or_default();
        if let Some((_, sum)) = self.pitch_sums.range(..=index).next_back() {
            tooth.left.along_x_mm += sum;
            tooth.right.along_x_mm += sum;
        }
        for deviation in self.near(index) {
            let RackTooth { left, right } = &mut tooth;
            if let RackDeviationKind::Pitch(value) = deviation.kind {
                // indices stay below 2⁵¹, so the conversion is exact
                let sum = deviation.teeth.pitches_before(index) as f64 * value;
                left.along_x_mm += sum;
                right.along_x_mm += sum;
                continue;
            }
            if !deviation.teeth.contains(index) {
                continue;
            }
            match deviation.kind {
                RackDeviationKind::OverRoller(value) => {
                    left.along_z_mm += value;
                    right.along_z_mm += value;
                }
                RackDeviationKind::Pitch(value) | RackDeviationKind::Shift(value) => {
                    left.along_x_mm += value;
                    right.along_x_mm += value;
                }
                RackDeviationKind::Thickness(value) => {
                    left.along_x_mm -= value * self.thickness_to_x;
                    right.along_x_mm += value * self.thickness_to_x;
                }
                RackDeviationKind::Lead(value) => {
                    left.lead_rad += value;
                    right.lead_rad += value;
                }
                RackDeviationKind::Left(value) => left.along_x_mm -= value,
                RackDeviationKind::Right(value) => right.along_x_mm += value,
            }
        }
        tooth
    }
}

/// The largest sum of lead deviations of any tooth, in magnitude.
fn largest_lead(deviations: &[RackDeviation]) -> f64 {
    // the sum changes where a range starts and after it ends
    let mut changes = Vec::new();
    for deviation in deviations {
        if let RackDeviationKind::Lead(value) = deviation.kind {
            changes.push((deviation.teeth.first().unwrap_or(i64::MIN), value));
            changes.extend(deviation.teeth.last().map(|last| (last + 1, -value)));
        }
    }
    changes.sort_unstable_by_key(|(tooth, _)| *tooth);
    let (mut sum, mut largest) = (0.0, 0.0_f64);
    for (index, (tooth, change)) in changes.iter().enumerate() {
        sum += change;
        if changes.get(index + 1).is_none_or(|(next, _)| next != tooth) && f64::abs(sum) > largest.abs() {
            largest = sum;
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lead(teeth: &str, value: f64) -> RackDeviation {
        RackDeviation { teeth: teeth.parse().expect("a range"), kind: RackDeviationKind::Lead(value) }
    }

    #[test]
    fn leads_add_up_tooth_by_tooth_only() {
        assert_eq!(largest_lead(&[lead("1", 0.5), lead("2", 0.5), lead("3..", -0.25)]), 0.5);
        assert_eq!(largest_lead(&[lead("all", 0.5), lead("2", 0.25), lead("2..=4", 0.125)]), 0.875);
        assert_eq!(largest_lead(&[lead("all", 0.5), lead("2..", -1.5)]), -1.0);
        assert_eq!(largest_lead(&[lead("all", 0.5), lead("all", -0.5)]), 0.0);
        // of two equal ones the first
        assert_eq!(largest_lead(&[lead("1", 0.5), lead("2", -0.5)]), 0.5);
    }

    /// Single steps of pitch are summed first, then deviations of one tooth and of several in the order in which they are given.
    #[test]
    fn deviations_of_a_tooth_add_up_in_their_order() {
        let pair = Pair::new(&crate::gear::example(12, 0.0, 0.0)).unwrap();
        let shift = |teeth: &str, value| RackDeviation {
            teeth: teeth.parse().expect("a range"),
            kind: RackDeviationKind::Shift(value),
        };
        let pitch = |teeth, value| RackDeviation { kind: RackDeviationKind::Pitch(value), ..shift(teeth, 0.0) };
        let all = [
            shift("2", 0.1),
            shift("all", 0.2),
            pitch("4", -0.03),
            pitch("2", 0.07),
            shift("2", 0.3),
            shift("1..", -0.6),
            shift("3", 1e-17),
        ];
        let flanks = RackFlanks::new(&pair, &all).unwrap();
        let sums = [
            (0, 0.2),
            (1, 0.2 - 0.6),
            (2, 0.07 + 0.1 + 0.2 + 0.3 - 0.6),
            (3, 0.07 + 0.2 - 0.6 + 1e-17),
            (90, (0.07 - 0.03) + 0.2 - 0.6),
        ];
        for (tooth, sum) in sums {
            assert_eq!(flanks.tooth(tooth).left.along_x_mm, sum, "{tooth}");
        }
    }

    /// Given and measured deviations of one tooth add up.
    #[test]
    fn a_measured_lead_beside_a_given_one_ends_at_85_degrees() {
        let pair = Pair::new(&crate::gear::example(12, 0.0, 0.0)).unwrap();
        let given = RackFlanks::new(&pair, &[lead("2", 0.7), lead("2", 0.7)]).unwrap();
        let measured = |tooth, lead_rad| {
            let left = RackFlank { lead_rad, ..RackFlank::default() };
            BTreeMap::from([(tooth, RackTooth { left, ..RackTooth::default() })])
        };
        assert!(given.clone().with_measured(&measured(2, 0.05)).is_ok());
        assert!(given.clone().with_measured(&measured(3, 0.2)).is_ok());
        assert!(given.with_measured(&measured(2, 0.2)).is_err());
    }

    #[test]
    fn tooth_lines_end_at_85_degrees() {
        let degree = std::f64::consts::PI / 180.0;
        for helix in [-60.0, 60.0] {
            let pair = Pair::new(&crate::gear::example(12, helix * degree, 0.0)).unwrap();
            let lead = |degrees: f64| RackFlanks::new(&pair, &[lead("all", degrees * degree)]);
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
