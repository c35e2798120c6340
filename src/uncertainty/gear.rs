//! A part's errors and gear data as plain numbers that may be varied or drawn: degrees and mm. Computes no uncertainty.

use super::Source;
use crate::deviation::{DeviationKind, Part};
use crate::formula::law::RADIANS_PER_DEGREE;
use crate::formula::over_pin::OverPin;
use crate::formula::{Law, PartDeviation};
use crate::judge::Stack;
use crate::judge::bound::{Basis, ExtendedError, NoBound, Range};
use crate::quantity::Length;

/// The gear data of a part, mm and degrees; what no error needs is 0.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Gear {
    pub(crate) alpha: f64,
    pub(crate) rack_helix: f64,
    pub(crate) pinion_helix: f64,
    pub(crate) face_width: f64,
}

impl Gear {
    /// That the errors' laws were made for.
    pub(crate) fn new(errors: &[PartDeviation], over_pin: Option<&OverPin>) -> Self {
        // where no formula needs an angle its gain is not used: any valid one will do
        let mut gear = Self { alpha: 20.0, ..Self::default() };
        for error in errors {
            if let Some(geometry) = error.law().geometry() {
                gear.alpha = geometry.pressure_angle.degrees();
                *gear.helix_mut(error.kind()) = geometry.helix_angle.degrees();
                gear.face_width = geometry.face_width.map_or(gear.face_width, Length::mm);
            }
        }
        if let Some(over_pin) = over_pin {
            gear.alpha = over_pin.normal_pressure_angle.degrees();
        }
        gear
    }

    fn helix_mut(&mut self, kind: DeviationKind) -> &mut f64 {
        if kind.part() == Part::Pinion { &mut self.pinion_helix } else { &mut self.rack_helix }
    }

    fn helix(&self, kind: DeviationKind) -> f64 {
        if kind.part() == Part::Pinion { self.pinion_helix } else { self.rack_helix }
    }

    /// The number that a source is about, if it is one of these.
    pub(crate) fn of_source(&mut self, source: Source) -> Option<&mut f64> {
        match source {
            Source::NormalPressureAngle => Some(&mut self.alpha),
            Source::RackHelixAngle => Some(&mut self.rack_helix),
            Source::PinionHelixAngle => Some(&mut self.pinion_helix),
            Source::FaceWidth => Some(&mut self.face_width),
            _ => None,
        }
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
    /// Of an error; `None` if no bound can be given for it.
    pub(crate) fn new(error: &PartDeviation) -> Option<Self> {
        Some(Self { law: error.law(), error: ExtendedError::of(error).ok()? })
    }

    /// With a value in mm or degrees.
    pub(crate) fn with_value(&self, value: f64) -> ExtendedError {
        self.error.with_value(if self.law.kind() == DeviationKind::RackLead {
            value * RADIANS_PER_DEGREE
        } else {
            value
        })
    }

    /// With a value in mm or degrees and other gear data.
    pub(crate) fn at(&self, value: f64, gear: &Gear) -> ExtendedError {
        self.with_value(value).of_gear(self.law, gear.alpha, gear.helix(self.law.kind()), gear.face_width)
    }
}

/// Both ends of a combination, not numbers if there are none.
pub(crate) fn ends(stack: Stack, errors: &[ExtendedError], basis: &Basis) -> Range {
    let none = |_: NoBound| Range { lower: f64::NAN, upper: f64::NAN };
    stack.ends(&basis.together(errors)).unwrap_or_else(none)
}
