//! A part's errors and gear data as plain numbers, in degrees and mm, which may be varied or drawn.

use std::f64::consts::FRAC_PI_2;

use super::{Influence, UncertainPart, Uncertainties, Uncertainty};
use crate::deviation::{self, DeviationKind};
use crate::formula::law::RADIANS_PER_DEGREE;
use crate::formula::over_pin::OverPin;
use crate::formula::{Law, PartDeviation};
use crate::gear::{PairData, thickness_offset_mm};
use crate::judge::Stack;
use crate::judge::bound::{Basis, ErrorRange, ExtendedError, GivenGeometry, KnownPairs, Range};
use crate::quantity::Length;
use crate::trig;

/// The gear data of a part, mm and degrees. Data that no error needs are 0.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Gear {
    pub(crate) alpha: f64,
    pub(crate) rack_helix: f64,
    pub(crate) pinion_helix: f64,
    pub(crate) face_width: f64,
    /// The inputs of a computed nominal over-roller measure: m_n, s_n if it is given, d_p and K.
    pub(crate) module: f64,
    pub(crate) thickness: Option<f64>,
    pub(crate) pin: f64,
    pub(crate) datum: f64,
}

/// The gear data on which laws depend.
pub(crate) const OF_LAWS: [Influence; 4] =
    [Influence::NormalPressureAngle, Influence::RackHelixAngle, Influence::PinionHelixAngle, Influence::FaceWidth];

impl Gear {
    /// The gear data of the errors' laws, and of the pair if it is known.
    pub(crate) fn new(errors: &[PartDeviation], over_pin: Option<&OverPin>, basis: &Basis) -> Self {
        // any valid pressure angle, for errors whose formula needs none
        let mut gear = Self { alpha: 20.0, ..Self::default() };
        if let GivenGeometry::Known(pairs) = &basis.geometry {
            let pair = &pairs.given().pair;
            gear = Self {
                alpha: pair.normal_pressure_angle_rad() / RADIANS_PER_DEGREE,
                rack_helix: pair.rack().helix_angle_rad / RADIANS_PER_DEGREE,
                pinion_helix: pair.pinion().helix_angle_rad / RADIANS_PER_DEGREE,
                face_width: pair.rack().face_width_mm,
                ..gear
            };
        }
        for error in errors {
            if let Some(geometry) = error.law().geometry() {
                gear.alpha = geometry.pressure_angle.degrees();
                *gear.helix_mut(error.kind()) = geometry.helix_angle.degrees();
                gear.face_width = geometry.face_width.map_or(gear.face_width, Length::mm);
            }
        }
        if let Some(over_pin) = over_pin {
            gear.alpha = over_pin.normal_pressure_angle.degrees();
            gear.module = over_pin.normal_module.mm();
            gear.thickness = over_pin.tooth_thickness.map(Length::mm);
            (gear.pin, gear.datum) = (over_pin.pin_diameter.mm(), over_pin.datum.mm());
        }
        gear
    }

    fn helix_mut(&mut self, kind: DeviationKind) -> &mut f64 {
        if kind.part() == deviation::Part::Pinion { &mut self.pinion_helix } else { &mut self.rack_helix }
    }

    fn helix(mut self, kind: DeviationKind) -> f64 {
        *self.helix_mut(kind)
    }

    /// The number of a source, if it is one of these data.
    pub(crate) fn of_source(&mut self, source: Influence) -> Option<&mut f64> {
        match source {
            Influence::NormalPressureAngle => Some(&mut self.alpha),
            Influence::RackHelixAngle => Some(&mut self.rack_helix),
            Influence::PinionHelixAngle => Some(&mut self.pinion_helix),
            Influence::FaceWidth => Some(&mut self.face_width),
            Influence::NormalModule => Some(&mut self.module),
            Influence::ToothThickness => self.thickness.as_mut(),
            Influence::Roller => Some(&mut self.pin),
            Influence::Datum => Some(&mut self.datum),
            Influence::Error(_) => None,
        }
    }

    /// The nominal measure over the roller, M = K − (π m_n − s_n)/(2 tan α_n) + (d_p/2)(1 + 1/sin α_n), mm.
    pub(crate) fn measure(&self) -> f64 {
        let (sin, cos) = trig::sin_cos(self.alpha * RADIANS_PER_DEGREE);
        let pitch = std::f64::consts::PI * self.module;
        let space = pitch - self.thickness.unwrap_or(0.5 * pitch);
        self.datum - 0.5 * space * cos / sin + 0.5 * self.pin * (1.0 + 1.0 / sin)
    }

    /// The constant ΔCD, mm, of a pair of unknown geometry for its rack tooth thickness; 0 if that is not given.
    pub(crate) fn own_delta_cd_mm(&self) -> f64 {
        self.thickness.map_or(0.0, |thickness| own_delta_cd_mm(thickness, self.module, self.alpha))
    }

    /// The law for this gear.
    pub(crate) fn law(&self, law: Law) -> Law {
        law.drawn(self.alpha, self.helix(law.kind()), self.face_width)
    }
}

/// One error of a part, whose value and gear data may vary.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VariedError {
    pub(crate) law: Law,
    error: ExtendedError,
}

impl VariedError {
    /// The error; `None` if it has no bound.
    pub(crate) fn new(error: &PartDeviation) -> Option<Self> {
        Some(Self { law: error.law(), error: ExtendedError::of(error).ok()? })
    }

    /// The error with another value, mm or degrees.
    pub(crate) fn with_value(&self, value: f64) -> ExtendedError {
        self.error.with_value(if self.law.kind() == DeviationKind::RackLead {
            value * RADIANS_PER_DEGREE
        } else {
            value
        })
    }

    /// The error with another value, mm or degrees, and other gear data.
    pub(crate) fn at(&self, value: f64, gear: &Gear) -> ExtendedError {
        self.with_value(value).of_gear(self.law, gear.alpha, gear.helix(self.law.kind()), gear.face_width)
    }
}

/// A pair of known geometry with one size off by ± its standard uncertainty. That changes the path of contact, the number of
/// teeth on it, and the ΔCD of the pair itself.
#[derive(Debug, Clone)]
pub(crate) struct VariedPair {
    pub(crate) source: Influence,
    /// The uncertainty of the size.
    pub(crate) uncertainty: Uncertainty,
    /// The pair with the smaller size; `None` if no such pair exists.
    below: Option<Basis>,
    above: Option<Basis>,
}

impl VariedPair {
    /// A varied pair for each uncertain size, if the geometry is known.
    pub(crate) fn all(basis: &Basis, uncertainties: &Uncertainties) -> Vec<Self> {
        let GivenGeometry::Known(pairs) = &basis.geometry else { return Vec::new() };
        let of = |(source, uncertainty): &(Influence, Uncertainty)| {
            let (resize, by) = (resized(*source)?, uncertainty.standard);
            let off = |by: f64| {
                let by = if source.is_angle() { by * RADIANS_PER_DEGREE } else { by };
                let given = pairs.given().varied(|data| resize(data, by)).ok()?;
                Some(Basis { geometry: GivenGeometry::Known(KnownPairs::new(given)), ..basis.clone() })
            };
            (by > 0.0).then(|| Self { source: *source, uncertainty: *uncertainty, below: off(-by), above: off(by) })
        };
        uncertainties.inputs().iter().filter_map(of).collect()
    }

    /// The difference of the ends to those of the nominal pair, over the deviation of the size, upwards or downwards.
    pub(crate) fn slope(&self, up: bool, nominal: Range, ends: impl Fn(&Basis) -> Range) -> Range {
        let by = self.uncertainty.standard;
        let (basis, by) = if up { (&self.above, by) } else { (&self.below, -by) };
        basis.as_ref().map_or(NO_RANGE, ends).with(nominal, |varied, nominal| (varied - nominal) / by)
    }

    /// The steeper of the two slopes, for each end.
    pub(crate) fn steepest(&self, nominal: Range, ends: impl Fn(&Basis) -> Range) -> Range {
        let [up, down] = [true, false].map(|up| self.slope(up, nominal, &ends));
        up.with(down, |up, down| if down.is_nan() || up.abs() >= down.abs() { up } else { down })
    }
}

/// The function that adds a deviation of a source, mm or rad, to the sizes of a pair; `None` if they do not depend on it.
fn resized(source: Influence) -> Option<fn(&mut PairData, f64)> {
    /// A rack tooth thickness that differs from half a pitch by less than this, mm, follows the module.
    const STANDARD_MM: f64 = 1e-9;
    match source {
        Influence::NormalPressureAngle => Some(|data, by| data.normal_pressure_angle_rad += by),
        Influence::RackHelixAngle => Some(|data, by| data.rack.helix_angle_rad += by),
        Influence::PinionHelixAngle => Some(|data, by| data.pinion.helix_angle_rad += by),
        Influence::FaceWidth => Some(|data, by| data.rack.face_width_mm += by),
        Influence::ToothThickness => {
            Some(|data, by| data.rack.tooth_thickness_mm = data.rack.tooth_thickness_mm.map(|s| s + by))
        }
        Influence::NormalModule => Some(|data, by| {
            let half_pitch = FRAC_PI_2 * data.normal_module_mm;
            let thickness = data.rack.tooth_thickness_mm;
            data.rack.tooth_thickness_mm = thickness.filter(|s| (s - half_pitch).abs() > STANDARD_MM);
            data.normal_module_mm += by;
        }),
        _ => None,
    }
}

/// The constant ΔCD, mm, of a pair of unknown geometry whose rack teeth have a given thickness,
/// (s_n − π m_n / 2) / (2 tan α_n); the angle in degrees.
fn own_delta_cd_mm(thickness_mm: f64, module_mm: f64, alpha: f64) -> f64 {
    thickness_offset_mm(thickness_mm - FRAC_PI_2 * module_mm, trig::tan(alpha * RADIANS_PER_DEGREE))
}

/// The derivative of [`own_delta_cd_mm`] by a source, mm per mm or degree; 0 if the geometry is known.
pub(crate) fn own_slope(source: Influence, part: &UncertainPart<'_>) -> f64 {
    let (GivenGeometry::Unknown | GivenGeometry::BothFlanks, Some(over_pin)) = (&part.basis.geometry, part.over_pin)
    else {
        return 0.0;
    };
    let Some(thickness) = over_pin.tooth_thickness else { return 0.0 };
    let alpha = over_pin.normal_pressure_angle.degrees();
    let (sin, cos) = trig::sin_cos(alpha * RADIANS_PER_DEGREE);
    match source {
        Influence::ToothThickness => 0.5 * cos / sin,
        Influence::NormalModule => -0.5 * FRAC_PI_2 * cos / sin,
        Influence::NormalPressureAngle => {
            -RADIANS_PER_DEGREE * own_delta_cd_mm(thickness.mm(), over_pin.normal_module.mm(), alpha) / (sin * cos)
        }
        _ => 0.0,
    }
}

/// Both ends of the judged range, NaN if there are none.
pub(crate) fn ends(stack: Stack, errors: &[ExtendedError], basis: &Basis) -> Range {
    basis.all_placed.unwrap_or_else(|| {
        let together = basis.together(errors);
        together.interval(together.judged(stack)).unwrap_or(NO_RANGE)
    })
}

/// The range of one error alone, NaN if there is no bound.
pub(crate) fn range_alone(error: &ExtendedError, basis: &Basis) -> Range {
    basis.alone(error).map_or(NO_RANGE, ErrorRange::alone)
}

/// The range of what has none.
pub(crate) const NO_RANGE: Range = Range { lower: f64::NAN, upper: f64::NAN };

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::Extent;
    use crate::judge::bound::GivenPair;
    use crate::quantity::Angle;
    use crate::reproduction;
    use crate::uncertainty::Uncertainty;

    /// On the paper's pair with a wide pinion a third step begins to carry at a rack face width of about 23.8 mm.
    #[test]
    fn a_size_near_a_jump_of_the_bound_is_uncertain_by_the_jump() {
        let given = GivenPair::plain(reproduction::pair().unwrap());
        let law = Law::rack_pitch("19.9".parse().unwrap(), Angle::ZERO).unwrap();
        let pitch: Length = "0.010".parse().unwrap();
        let error = ExtendedError::new(law, pitch, Extent::Each).unwrap();
        let of = |basis: &Basis| ends(Stack::Range, &[error], basis);
        let slope_at = |width: f64| {
            let given = given.varied(|data| {
                data.rack.face_width_mm = width;
                data.pinion.face_width_mm = 30.0;
            });
            let geometry = GivenGeometry::Known(KnownPairs::new(given.unwrap()));
            let basis = Basis { geometry, ..Basis::default() };
            let width = (Influence::FaceWidth, Uncertainty::standard(0.1));
            let uncertainties = Uncertainties::new(vec![width], &[]).unwrap();
            let [pair] = &VariedPair::all(&basis, &uncertainties)[..] else { panic!("the pair is known") };
            pair.steepest(of(&basis), of).upper
        };
        assert_eq!(slope_at(19.7), 0.0);
        // 0.1 mm of face width raises the upper end by more than a micrometre
        assert!(slope_at(23.75) > 0.01, "{}", slope_at(23.75));
    }
}
