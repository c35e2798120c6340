//! An error with its extent and the gear data that its effect follows from. The bound reads it; it computes no range.

use super::NoBound;
use crate::deviation::{DeviationKind, DeviationValue, Extent, MAX_LEAD_RAD, MAX_LENGTH_MM, Part};
use crate::formula::law::{RADIANS_PER_DEGREE, unit_gain};
use crate::formula::{Law, Model, PartDeviation};
use crate::gear::Pair;
use crate::trig;

/// An error that may be on any teeth that its extent allows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtendedError {
    pub(in crate::judge) part: Part,
    /// mm, or rad.
    pub(crate) value: f64,
    pub(in crate::judge) effect: ErrorEffect,
    /// How far it extends.
    pub(crate) extent: Extent,
    /// Whether the sign is not known: the error then is anything from minus to plus the value.
    pub(in crate::judge) either_sign: bool,
    /// For a tolerance that is not symmetric, the end nearer to 0; the value is the other end.
    pub(in crate::judge) nearer_end: Option<f64>,
}

/// The effect of an error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::judge) enum ErrorEffect {
    /// Both flanks of a space stand out so that the space sits higher by the value.
    Size,
    /// Steps from tooth to tooth: each moves ΔCD by `gain` times its value. `cap` is the total cumulative deviation of either
    /// flank side, if it is limited.
    Pitch { gain: f64, cap: Option<f64> },
    /// The rack's tooth lines turn by the value.
    RackLead(RackLines),
    /// The pinion's helices turn; over the whole face that is `gain` times the value of ΔCD.
    PinionLead { gain: f64 },
}

impl ErrorEffect {
    pub(in crate::judge) const fn is_lead(self) -> bool {
        matches!(self, Self::RackLead(_) | Self::PinionLead { .. })
    }
}

/// The gear data behind a lead error of the rack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::judge) struct RackLines {
    pub(in crate::judge) tan_alpha: f64,
    pub(in crate::judge) helix: f64,
    pub(in crate::judge) face_width: f64,
}

impl RackLines {
    /// The gear data of a pair.
    pub(super) fn of_pair(pair: &Pair) -> Self {
        let rack = pair.rack();
        let tan_alpha = trig::tan(pair.normal_pressure_angle_rad());
        Self { tan_alpha, helix: rack.helix_angle_rad, face_width: rack.face_width_mm }
    }

    /// mm of ΔCD per rad of a small lead, by the formula.
    pub(super) fn gain(&self) -> f64 {
        self.face_width * unit_gain(DeviationKind::RackLead, Model::Exact, self.tan_alpha, trig::cos(self.helix))
    }
}

impl ExtendedError {
    /// An error without effect, for lists of a fixed length.
    pub(crate) const NONE: Self = Self {
        part: Part::Rack,
        value: 0.0,
        effect: ErrorEffect::Size,
        extent: Extent::All,
        either_sign: false,
        nearer_end: None,
    };

    /// An error of a kind with a [`Law`]. A measured error has a sign; for a tolerance ([`Extent::Each`], [`Extent::Total`])
    /// the magnitude counts.
    ///
    /// # Errors
    /// [`NoBound::NotOfItsKind`] if value and law or extent do not fit, [`NoBound::TooLarge`] for a value that is not finite,
    /// a lead of 45° and more, or a length of 1 km and more.
    pub fn new(law: Law, value: impl Into<DeviationValue>, extent: Extent) -> Result<Self, NoBound> {
        let (effect, largest) = match (law.kind(), law.geometry()) {
            (DeviationKind::RackOverRoller | DeviationKind::PinionRadial, _) => (ErrorEffect::Size, MAX_LENGTH_MM),
            (DeviationKind::RackPitch | DeviationKind::PinionPitch, _) => {
                (ErrorEffect::Pitch { gain: law.slope(1.0, Model::Exact), cap: None }, MAX_LENGTH_MM)
            }
            (DeviationKind::PinionLead, _) => {
                (ErrorEffect::PinionLead { gain: law.slope(1.0, Model::Exact) }, MAX_LENGTH_MM)
            }
            (DeviationKind::RackLead, Some(gear)) => {
                let face_width = gear.face_width.ok_or(NoBound::NotOfItsKind)?.mm();
                let rack = RackLines {
                    tan_alpha: trig::tan_of(gear.pressure_angle),
                    helix: gear.helix_angle.radians(),
                    face_width,
                };
                (ErrorEffect::RackLead(rack), MAX_LEAD_RAD.min(std::f64::consts::FRAC_PI_2 - rack.helix.abs()))
            }
            (DeviationKind::RackLead, None) => return Err(NoBound::NotOfItsKind),
        };
        let value = match (effect, value.into()) {
            (ErrorEffect::RackLead(_), DeviationValue::Angle(angle)) => angle.radians(),
            (ErrorEffect::RackLead(_), DeviationValue::Slope(slope)) => trig::atan(slope),
            (ErrorEffect::RackLead(_), DeviationValue::Length(_)) => return Err(NoBound::NotOfItsKind),
            (_, DeviationValue::Length(length)) => length.mm(),
            _ => return Err(NoBound::NotOfItsKind),
        };
        if !extent.fits(law.kind().counts()) {
            return Err(NoBound::NotOfItsKind);
        }
        if value.abs() < largest {
            Ok(Self { part: law.kind().part(), value, effect, extent, either_sign: false, nearer_end: None })
        } else {
            Err(NoBound::TooLarge)
        }
    }

    /// The error of a part's deviation; a tolerance has no known sign.
    ///
    /// # Errors
    /// [`NoBound`] as [`ExtendedError::new`].
    pub fn of(error: &PartDeviation) -> Result<Self, NoBound> {
        let extended = Self::new(error.law(), error.value(), error.extent())?;
        let extended = if error.is_tolerance() { extended.of_either_sign() } else { extended };
        let nearer = error.tolerance().nearer.map(|nearer| Self::new(error.law(), nearer, error.extent()));
        let extended = Self { nearer_end: nearer.transpose()?.map(|nearer| nearer.value), ..extended };
        Ok(error.total().map_or(extended, |total| extended.within_total(total.mm())))
    }

    /// Whether the error is on every tooth alike, so that nothing is left to place. The pitches of a pinion sum to zero over a
    /// turn: they cannot all be off the same way.
    #[must_use]
    pub const fn is_on_all_teeth(&self) -> bool {
        let closes = matches!((self.part, self.effect), (Part::Pinion, ErrorEffect::Pitch { .. }));
        matches!(self.extent, Extent::All) && !self.either_sign && !closes
    }

    /// The error with randomly drawn or varied gear data, which lie on no grid, in degrees and mm.
    pub(crate) fn of_gear(mut self, law: Law, pressure_angle: f64, helix_angle: f64, face_width_mm: f64) -> Self {
        match &mut self.effect {
            ErrorEffect::Pitch { gain, .. } | ErrorEffect::PinionLead { gain } => {
                *gain = law.drawn(pressure_angle, helix_angle, face_width_mm).slope(1.0, Model::Exact);
            }
            ErrorEffect::RackLead(rack) => {
                let tan_alpha = trig::tan(pressure_angle * RADIANS_PER_DEGREE);
                *rack = RackLines { tan_alpha, helix: helix_angle * RADIANS_PER_DEGREE, face_width: face_width_mm };
            }
            ErrorEffect::Size => {}
        }
        self
    }

    /// The error without a known sign. With the extents `each` and `total` the sign is never known.
    pub(in crate::judge) fn of_either_sign(self) -> Self {
        Self { either_sign: matches!(self.extent, Extent::One | Extent::Part | Extent::All), ..self }
    }

    /// An error whose sign is not known, at either end of its tolerance.
    #[inline]
    pub(in crate::judge) fn signs(&self) -> Option<[Self; 2]> {
        let [lower, upper] = self.ends();
        self.either_sign.then(|| [upper, lower].map(|end| Self { either_sign: false, ..self.measured(end) }))
    }

    /// Whether a tolerance leaves some teeth, or some parts, without the error.
    pub(super) fn may_be_nothing(&self) -> bool {
        let [lower, upper] = self.ends();
        self.extent != Extent::All || lower <= 0.0 && upper >= 0.0
    }

    /// The least and the greatest value of a tolerance, mm or rad.
    pub(in crate::judge) fn ends(&self) -> [f64; 2] {
        let nearer = self.nearer_end.unwrap_or(-self.value);
        [self.value.min(nearer), self.value.max(nearer)]
    }

    /// A tolerance that is not symmetric, as its middle, which is on all its teeth, and plus and minus half its width.
    pub(in crate::judge) fn split(&self) -> Option<[Self; 2]> {
        self.nearer_end?;
        let [lower, upper] = self.ends();
        let extent = if self.extent == Extent::Each { Extent::All } else { self.extent };
        let middle = Self { extent, either_sign: false, ..self.measured(0.5 * (lower + upper)) };
        Some([middle, self.measured(0.5 * (upper - lower))])
    }

    /// The error with one value in place of a tolerance of two ends.
    fn measured(self, value: f64) -> Self {
        Self { nearer_end: None, ..self.with_value(value) }
    }

    /// Whether the value is a tolerance: either each tooth has its own value in it, or all teeth have one.
    #[inline]
    pub(crate) fn is_tolerance(&self) -> bool {
        self.either_sign || matches!(self.extent, Extent::Each | Extent::Total)
    }

    /// Whether the error is a tolerance with more than one possible value.
    #[inline]
    pub(crate) fn scatters(&self) -> bool {
        let [lower, upper] = self.ends();
        self.is_tolerance() && lower < upper
    }

    /// The pitch tolerance without a limit of its total.
    pub(super) fn uncapped(mut self) -> Self {
        if let ErrorEffect::Pitch { cap, .. } = &mut self.effect {
            *cap = None;
        }
        self
    }

    /// The error at a share of its value; for two ends, −1 is the lower and +1 the upper end.
    pub(super) fn scaled(self, share: f64) -> Self {
        let value = match self.split() {
            None => share * self.value,
            Some([middle, half]) => middle.value + share * half.value,
        };
        self.measured(value)
    }

    /// The error with another value, in mm or rad.
    pub(crate) fn with_value(self, value: f64) -> Self {
        Self { value, ..self }
    }

    /// The pitch tolerance with a limit F_p on the total cumulative deviation of either flank side: the error then does no more
    /// than [`Extent::Total`] of F_p.
    #[must_use]
    pub fn within_total(mut self, total_mm: f64) -> Self {
        if let ErrorEffect::Pitch { cap, .. } = &mut self.effect {
            *cap = Some(total_mm.abs());
        }
        self
    }
}

/// The helix angle deviation at the reference cylinder, rad, of a helix slope deviation f_Hβ over the face width.
#[must_use]
pub fn pinion_lead_angle_rad(pair: &Pair, deviation_mm: f64) -> f64 {
    let pinion = pair.pinion();
    let slope = deviation_mm / (pinion.face_width_mm * trig::cos(pinion.transverse_pressure_angle_rad));
    trig::atan(trig::tan(pinion.helix_angle_rad) + slope) - pinion.helix_angle_rad
}

/// The helix slope deviation f_Hβ, mm, over a pinion's face width of a helix angle deviation Δβ at the reference cylinder:
/// b cos α_t (tan(β + Δβ) − tan β). The inverse of [`pinion_lead_angle_rad`].
#[must_use]
pub fn pinion_helix_slope_mm(pinion: HelixOfPinion, deviation_rad: f64) -> f64 {
    let HelixOfPinion { normal_pressure_angle_rad, helix_angle_rad, face_width_mm } = pinion;
    let cos = trig::cos(helix_angle_rad);
    let transverse = trig::atan2(trig::tan(normal_pressure_angle_rad), cos);
    // tan(β + Δβ) − tan β without the difference of two large numbers
    let tangents = trig::sin(deviation_rad) / (cos * trig::cos(helix_angle_rad + deviation_rad));
    face_width_mm * trig::cos(transverse) * tangents
}

/// The gear data behind a helix slope deviation of a pinion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HelixOfPinion {
    /// α_n, rad.
    pub normal_pressure_angle_rad: f64,
    /// β, rad, right hand positive.
    pub helix_angle_rad: f64,
    /// b, mm.
    pub face_width_mm: f64,
}

impl HelixOfPinion {
    /// The gear data of a pair.
    #[must_use]
    pub fn of(pair: &Pair) -> Self {
        Self {
            normal_pressure_angle_rad: pair.normal_pressure_angle_rad(),
            helix_angle_rad: pair.pinion().helix_angle_rad,
            face_width_mm: pair.pinion().face_width_mm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::example;

    #[test]
    fn a_helix_slope_and_its_angle_are_inverse() {
        for helix in [-0.5, 0.0, 0.4] {
            let pair = Pair::new(&example(20, 0.0, helix)).unwrap();
            for slope in [-0.3, -0.012, 0.0, 0.0105, 0.2] {
                let back = pinion_helix_slope_mm(HelixOfPinion::of(&pair), pinion_lead_angle_rad(&pair, slope));
                assert!((back - slope).abs() < 1e-13, "{helix} {slope} {back}");
            }
        }
    }
}
