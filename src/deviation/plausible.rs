//! Which values make sense as a deviation of teeth or as gear data, and what a value that does not was probably meant to be. All
//! commands and tables use this one rule; they only add where the value stands.
//!
//! A value is impossible if no part with teeth can have it, and suspicious if no real part has it. The usual mistakes are a
//! measured size in place of a deviation, µm written as mm, radians and arc minutes written as degrees.
//!
//! | quantity | suspicious | impossible | why |
//! |---|---|---|---|
//! | deviation of length | from 1 mm, or a quarter of the module if that is less | above the module | The coarsest class of the standards permits less than a tenth of a module, and less than 1 mm up to module 40. A flank that is a module off belongs to another tooth. |
//! | lead error | from 2° | above 45° | The coarsest class permits less than 0.4° on a face of 10 mm. |
//! | pressure angle | below 5° | below 1° | At 5° a pinion below 263 teeth is undercut, at 1° one below 6566. Above 45° the formulas have no value. |
//! | helix angle | 0.087° to 0.873° either way | | As radians these are 5° to 50°, the angles that gears have. An angle so small gives no overlap, but may be meant. |
//! | normal module | above 100 mm | | The largest of the standards is 50 mm to 70 mm. |
//! | face width | above 1 m, or 100 modules if that is less | | A usual face is 5 to 20 modules wide. |
//! | pin of a rack | touches a module or more from the reference plane | 1.5 modules from it, or above the tips | There it rests on tips or on the root. |

use std::fmt;

#[cfg(feature = "table")]
use super::DeviationValues;
use super::{DeviationValue, MAX_LEAD_RAD};
use crate::quantity::{Angle, Length};

/// A whole number of millimetres.
const fn mm(value: i64) -> Length {
    Length::from_fm(value * 1_000_000_000_000)
}

/// From here on a deviation is suspicious, whatever the module.
const MUCH: Length = mm(1);
/// The share of the module from which a deviation is suspicious: a quarter.
const MUCH_OF_MODULE: i64 = 4;
/// From here on a lead error is suspicious, degrees.
const MUCH_LEAD: f64 = 2.0;
/// A pressure angle below this is suspicious, degrees.
const SMALL_PRESSURE_ANGLE: f64 = 5.0;
/// A pressure angle below this is impossible, degrees.
const SMALLEST_PRESSURE_ANGLE: f64 = 1.0;
/// Pressure angles of 10° to 45° in radians.
const PRESSURE_ANGLES_RAD: std::ops::RangeInclusive<f64> = 0.17..=0.79;
/// Helix angles of 5° to 50° in radians.
const HELIX_ANGLES_RAD: std::ops::RangeInclusive<f64> = 0.087..=0.873;
/// A normal module above this is suspicious.
const LARGE_MODULE: Length = mm(100);
/// A face width above this is suspicious.
const LARGE_FACE_WIDTH: Length = mm(1000);
/// A face wider than so many modules is suspicious.
const WIDE_IN_MODULES: i64 = 100;
/// A face width or an addendum below this part of a module is suspicious.
const SMALL_IN_MODULES: i64 = 50;
/// A pin that touches flanks farther from the reference plane than so many modules is suspicious, and impossible.
const PIN_FAR: f64 = 1.0;
const PIN_FARTHEST: f64 = 1.5;
/// Measured micrometres have no digits below 0.1 µm: a number with finer digits is a size in mm.
const FINEST_IN_MICROMETRES: i64 = mm(1).fm() / 10;

/// How large the values of an error may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// For a length.
    pub length: Length,
    /// For an angle.
    pub angle: Angle,
    /// For the tangent of an angle.
    pub slope: f64,
}

impl Reach {
    /// The possible deviations; any length where the module is not known.
    #[must_use]
    pub fn possible(module: Option<Length>) -> Self {
        Self { length: module.unwrap_or(Length::LARGEST), angle: degrees(MAX_LEAD_RAD.to_degrees()), slope: 1.0 }
    }

    /// The deviations that are not suspicious.
    #[must_use]
    pub fn usual(module: Option<Length>) -> Self {
        let length = module.map_or(MUCH, |module| MUCH.min(Length::from_fm(module.fm() / MUCH_OF_MODULE)));
        let angle = degrees(MUCH_LEAD);
        Self { length, angle, slope: crate::trig::tan(angle.radians()) }
    }

    /// These values, with lengths up to `length` only.
    #[must_use]
    pub fn within(self, length: Length) -> Self {
        Self { length: self.length.min(length), ..self }
    }

    /// Whether a value is beyond the limit.
    #[must_use]
    #[inline]
    pub fn is_exceeded_by(&self, value: DeviationValue) -> bool {
        match value {
            DeviationValue::Length(length) => length.abs() > self.length,
            DeviationValue::Angle(angle) => angle.abs() > self.angle,
            DeviationValue::Slope(slope) => slope.abs() > self.slope,
        }
    }

    /// How many of a column's values are suspicious by this limit.
    #[must_use]
    #[cfg(feature = "table")]
    pub fn doubted(&self, values: &DeviationValues) -> u64 {
        let mut count = 0;
        values.for_each(|value| count += u64::from(self.is_reached_by(value)));
        count
    }

    /// Whether a value is beyond the limit or equal to it.
    #[must_use]
    #[inline]
    pub fn is_reached_by(&self, value: DeviationValue) -> bool {
        match value {
            DeviationValue::Length(length) => length.abs() >= self.length,
            DeviationValue::Angle(angle) => angle.abs() >= self.angle,
            DeviationValue::Slope(slope) => slope.abs() >= self.slope,
        }
    }
}

/// A few whole degrees, which an angle can always hold.
fn degrees(value: f64) -> Angle {
    Angle::from_degrees(value).unwrap_or(Angle::LARGEST)
}

/// What a value was probably meant to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Meant {
    /// The same number in another unit, by its symbol in a spec.
    Unit(&'static str),
    /// A measured size.
    Size,
    /// f_Hβ or its length in another unit.
    Slope,
    /// The number does not tell.
    Unknown,
}

/// Where a value stands, which decides how the right one is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrittenIn {
    /// In a spec.
    Spec,
    /// Among the arguments.
    Argument,
}

/// An impossible or suspicious value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Doubt {
    /// What it is for what: `large for a deviation`.
    what: &'static str,
    /// The value.
    pub value: DeviationValue,
    /// Whether the value is impossible; else it is suspicious.
    pub is_impossible: bool,
    /// What was probably meant.
    pub meant: Meant,
    /// The module with which a deviation is compared.
    module: Option<Length>,
    /// The pin that touches at the reference plane.
    ideal_pin: Option<Length>,
}

/// The doubt about the value of an error.
#[must_use]
pub fn deviation(value: DeviationValue, module: Option<Length>) -> Option<Doubt> {
    const LEAD: &str = "large for a lead error";
    let usual = Reach::usual(module);
    if !usual.is_reached_by(value) {
        return None;
    }
    let is_impossible = Reach::possible(module).is_exceeded_by(value);
    let doubt = |what, meant| Doubt { is_impossible, ..Doubt::of(what, value, meant) };
    Some(match value {
        DeviationValue::Length(length) => {
            Doubt { module, ..doubt("large for a deviation", size_or_micrometres(length, usual.length)) }
        }
        DeviationValue::Angle(angle) if angle.abs().degrees() < 60.0 * MUCH_LEAD => doubt(LEAD, Meant::Unit("arcmin")),
        DeviationValue::Angle(_) => doubt(LEAD, Meant::Unknown),
        DeviationValue::Slope(_) => doubt(LEAD, Meant::Slope),
    })
}

/// What a length that is too large for a deviation was meant to be.
fn size_or_micrometres(length: Length, usual: Length) -> Meant {
    if !length.is_negative() && length.fm() % FINEST_IN_MICROMETRES != 0 {
        Meant::Size
    } else if Length::from_fm(length.fm() / 1000).abs() < usual {
        Meant::Unit("um")
    } else {
        Meant::Unknown
    }
}

/// The doubt about a normal pressure angle.
#[must_use]
pub fn pressure_angle(angle: Angle) -> Option<Doubt> {
    let value = angle.degrees();
    let meant = if PRESSURE_ANGLES_RAD.contains(&value) { Meant::Unit("rad") } else { Meant::Unknown };
    let doubt = Doubt::of("small for a pressure angle", angle.into(), meant);
    let is_small = value > 0.0 && value < SMALL_PRESSURE_ANGLE;
    is_small.then_some(Doubt { is_impossible: value < SMALLEST_PRESSURE_ANGLE, ..doubt })
}

/// The doubt about a helix angle that is written without its unit.
#[must_use]
pub fn helix_angle(angle: Angle) -> Option<Doubt> {
    let doubt = Doubt::of("small for a helix angle", angle.into(), Meant::Unit("rad"));
    HELIX_ANGLES_RAD.contains(&angle.abs().degrees()).then_some(doubt)
}

/// The doubt about a normal module.
#[must_use]
pub fn normal_module(module: Length) -> Option<Doubt> {
    (module > LARGE_MODULE).then_some(Doubt::of("large for a module", module.into(), Meant::Unit("um")))
}

/// The doubt about a face width.
#[must_use]
pub fn face_width(width: Length, module: Option<Length>) -> Option<Doubt> {
    let wide = |module: Length| Length::from_fm(module.fm().saturating_mul(WIDE_IN_MODULES));
    let largest = module.map_or(LARGE_FACE_WIDTH, |module| LARGE_FACE_WIDTH.min(wide(module)));
    (width > largest).then_some(large_face(width)).or_else(|| small("small for a face width", width, module?))
}

/// The doubt about the evaluation length of f_Hβ, a part of a face width: a length that was meant in µm would make the lead
/// nearly 0.
#[must_use]
pub fn evaluation_length(length: Length) -> Option<Doubt> {
    (length > LARGE_FACE_WIDTH).then_some(Doubt { is_impossible: true, ..large_face(length) })
}

/// The doubt about the addendum of the rack.
#[must_use]
pub fn addendum(height: Length, module: Option<Length>) -> Option<Doubt> {
    small("small for an addendum", height, module?)
}

/// The doubt about a pin that touches flanks so many modules over the reference plane; the tips are at `tips`, if that is known.
#[must_use]
pub fn pin(diameter: Length, ideal: Length, touches_at: f64, tips: Option<f64>) -> Option<Doubt> {
    let is_impossible = touches_at > tips.unwrap_or(PIN_FARTHEST) || touches_at < -PIN_FARTHEST;
    let what = if diameter.mm() > ideal.mm() { "large for a pin" } else { "small for a pin" };
    let doubt = Doubt::of(what, diameter.into(), Meant::Unknown);
    (is_impossible || touches_at.abs() > PIN_FAR).then_some(Doubt { is_impossible, ideal_pin: Some(ideal), ..doubt })
}

/// The doubt about a size that is a small part of the module: metres in place of millimetres.
fn small(what: &'static str, size: Length, module: Length) -> Option<Doubt> {
    let is_small = size > Length::ZERO && size.fm() < module.fm() / SMALL_IN_MODULES;
    is_small.then_some(Doubt::of(what, size.into(), Meant::Unit("m")))
}

fn large_face(width: Length) -> Doubt {
    Doubt::of("large for a face width", width.into(), Meant::Unit("um"))
}

impl Doubt {
    /// A suspicion.
    const fn of(what: &'static str, value: DeviationValue, meant: Meant) -> Self {
        Self { what, value, is_impossible: false, meant, module: None, ideal_pin: None }
    }

    /// The doubt about a measured value less its nominal one; the difference says nothing about either.
    #[must_use]
    pub fn of_difference(self) -> Self {
        Self { meant: Meant::Unknown, ..self }
    }

    /// The doubt about a value that belongs to no part, such as a limit.
    #[must_use]
    pub fn of_no_part(self) -> Self {
        Self { is_impossible: false, ..self }
    }

    /// The doubt about a value that is never a measured size: the form of flanks, an uncertainty.
    #[must_use]
    pub fn of_no_size(self) -> Self {
        Self { meant: if self.meant == Meant::Size { Meant::Unit("um") } else { self.meant }, ..self }
    }

    /// What to write.
    #[must_use]
    pub fn remedy(&self, written: WrittenIn) -> String {
        let number = self.value.base();
        match (self.meant, written) {
            (Meant::Unit(unit), WrittenIn::Spec) => format!("if that is {}, write \"{number} {unit}\"", name(unit)),
            (Meant::Unit(unit), WrittenIn::Argument) => format!("if that is {}, write {number}{unit}", name(unit)),
            (Meant::Size, WrittenIn::Spec) => {
                format!("if that is a measured size, write {{ measured = {number}, nominal = … }}")
            }
            (Meant::Size, WrittenIn::Argument) => {
                format!("if that is a measured size, write --measured {number} --nominal …")
            }
            (Meant::Slope, _) => {
                "check the units of f_Hβ and of its evaluation length: a number alone is mm".to_owned()
            }
            (Meant::Unknown, _) => "check the unit and the decimal mark".to_owned(),
        }
    }
}

/// A unit in words.
fn name(unit: &'static str) -> &'static str {
    match unit {
        "um" => "µm",
        "arcmin" => "arc minutes",
        "rad" => "radians",
        "m" => "metres",
        other => other,
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let too = if self.is_impossible { "too " } else { "" };
        match self.value {
            // the angle of a slope with few digits
            DeviationValue::Slope(_) => write!(f, "{:.2}° is {too}{}", self.value.base(), self.what)?,
            value => write!(f, "{value} is {too}{}", self.what)?,
        }
        if let Some(module) = self.module {
            write!(f, " (the module is {module})")?;
        }
        if let Some(ideal) = self.ideal_pin {
            write!(f, "; one that touches at the reference plane has {:.3} mm", ideal.mm())?;
        }
        Ok(())
    }
}

/// The one remark on a column with suspicious values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubtedColumn {
    /// The limit of usual values.
    pub usual: Reach,
    /// Whether the column holds lead errors.
    pub is_lead: bool,
    /// The number of suspicious values.
    pub count: u64,
}

impl fmt::Display for DoubtedColumn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { usual, is_lead, count } = self;
        let values = if *count == 1 { "1 value is" } else { &*format!("{count} values are") };
        if *is_lead {
            write!(f, "{values} large for a lead error, {} or more: check the unit", usual.angle)
        } else {
            let length = usual.length;
            write!(f, "{values} large for a deviation, {length} or more: check the unit, and whether these are sizes")
        }
    }
}

#[cfg(test)]
mod tests;
