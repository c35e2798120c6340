//! Angles: rational numbers of degrees, with their units. Used by every module; trigonometry is in
//! [`trig`](crate::trig).

use std::fmt;
use std::str::FromStr;

use super::length::LengthUnit;
use super::parse::{number, split_number};
use super::{QuantityError, Rational, exact_arithmetic};

/// An angle, known exactly. Base unit: degree.
///
/// Read from text: a bare number is in degrees; the units are `deg` (`°`), `arcmin` (`'`), `arcsec`
/// (`"`), `rad`, `mrad`, and degrees, minutes and seconds may follow each other: `12° 30' 15"`. Only
/// radians are not exact: π enters them with 100 decimals.
///
/// ```
/// use rackmesh::quantity::Angle;
///
/// assert_eq!("15 arcmin".parse::<Angle>()?, Angle::from_degrees(0.25)?);
/// assert_eq!("12° 30'".parse::<Angle>()?.degrees(), 12.5);
/// # Ok::<(), rackmesh::quantity::QuantityError>(())
/// ```
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Angle {
    degrees: Rational,
}

/// A unit of angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum AngleUnit {
    /// `deg`, `°`.
    Degree,
    /// `arcmin`, `'`: 1/60°.
    Arcminute,
    /// `arcsec`, `"`: 1/3600°.
    Arcsecond,
    /// `rad`: 180°/π.
    Radian,
    /// `mrad`: 0.001 rad.
    Milliradian,
}

impl AngleUnit {
    /// The units in words, for messages.
    pub const NAMES: &'static str = "deg, °, ', arcmin, \", arcsec, rad or mrad";

    /// The unit of that symbol.
    #[must_use]
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        match symbol {
            "deg" | "°" => Some(Self::Degree),
            "arcmin" | "'" | "\u{2032}" | "\u{2019}" => Some(Self::Arcminute),
            "arcsec" | "\"" | "\u{2033}" | "\u{201d}" | "''" => Some(Self::Arcsecond),
            "rad" => Some(Self::Radian),
            "mrad" => Some(Self::Milliradian),
            _ => None,
        }
    }

    /// The unit's symbol, as it stands after a number and a blank.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Degree => "deg",
            Self::Arcminute => "arcmin",
            Self::Arcsecond => "arcsec",
            Self::Radian => "rad",
            Self::Milliradian => "mrad",
        }
    }

    /// Degrees in one of this unit.
    #[must_use]
    pub fn in_degrees(self) -> Rational {
        let radian = || &Rational::integer(180) / Rational::pi();
        match self {
            Self::Degree => Rational::ONE,
            Self::Arcminute => Rational::fraction(1, 60),
            Self::Arcsecond => Rational::fraction(1, 3600),
            Self::Radian => radian(),
            Self::Milliradian => &radian() / &Rational::integer(1000),
        }
    }
}

impl Angle {
    /// No angle at all.
    pub const ZERO: Self = Self { degrees: Rational::ZERO };

    /// An angle in degrees; the number is taken as the decimal that was written for it, its shortest
    /// one.
    ///
    /// # Errors
    /// [`QuantityError::NotFinite`] if `degrees` is an infinity or NaN.
    pub fn from_degrees(degrees: f64) -> Result<Self, QuantityError> {
        let degrees = Rational::from_shortest_decimal(degrees)
            .ok_or_else(|| QuantityError::NotFinite { what: "the angle", value: degrees.to_string() })?;
        Ok(Self { degrees })
    }

    /// An angle of exactly that many degrees; `what` names it in the error.
    ///
    /// # Errors
    /// [`QuantityError::Overflow`] if the nearest `f64` is infinite.
    pub fn from_exact_degrees(degrees: Rational, what: &'static str) -> Result<Self, QuantityError> {
        if degrees.to_f64().is_infinite() {
            return Err(QuantityError::Overflow { what });
        }
        Ok(Self { degrees })
    }

    /// The angle in degrees, rounded once to the nearest `f64`.
    #[must_use]
    pub fn degrees(&self) -> f64 {
        self.degrees.to_f64()
    }

    /// The angle in degrees, exactly.
    #[must_use]
    pub fn exact_degrees(&self) -> &Rational {
        &self.degrees
    }

    /// The angle in radians, rounded once to the nearest `f64`.
    #[must_use]
    pub fn radians(&self) -> f64 {
        self.in_unit(AngleUnit::Radian)
    }

    /// The angle in `unit`, rounded once to the nearest `f64`.
    #[must_use]
    pub fn in_unit(&self, unit: AngleUnit) -> f64 {
        (&self.degrees / &unit.in_degrees()).to_f64()
    }
}

exact_arithmetic!(Angle, degrees);

impl FromStr for Angle {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, QuantityError> {
        const EXPECTED: &str = "an angle";
        let mut rest = text;
        let mut sum: Option<Rational> = None;
        let mut negative = false;
        let mut previous: Option<AngleUnit> = None;
        loop {
            let (written, after) = split_number(rest);
            let next = after.find(|c: char| c.is_ascii_digit() || c.is_whitespace()).unwrap_or(after.len());
            let (symbol, remainder) = (after[..next].trim(), after[next..].trim());
            let unit = match AngleUnit::from_symbol(symbol) {
                Some(unit) => unit,
                None if symbol.is_empty() && sum.is_none() && remainder.is_empty() => AngleUnit::Degree,
                None => {
                    number(written, text, EXPECTED)?;
                    let (unit, units) =
                        (if symbol.is_empty() { remainder } else { symbol }.to_owned(), AngleUnit::NAMES);
                    return Err(match LengthUnit::from_symbol(&unit) {
                        Some(_) => {
                            QuantityError::OtherDimension { unit, measures: "length", expected: EXPECTED, units }
                        }
                        None => QuantityError::UnknownUnit { unit, expected: EXPECTED, units },
                    });
                }
            };
            let part = &number(written, text, EXPECTED)? * &unit.in_degrees();
            // after the first part come smaller units without a sign of their own: 12° 30' 15"
            let follows = match previous {
                None => true,
                Some(AngleUnit::Degree) => matches!(unit, AngleUnit::Arcminute | AngleUnit::Arcsecond),
                Some(AngleUnit::Arcminute) => unit == AngleUnit::Arcsecond,
                Some(_) => false,
            };
            let signed = written.starts_with(['+', '-', '\u{2212}']);
            if !follows || (sum.is_some() && signed) {
                return Err(QuantityError::UnknownUnit {
                    unit: rest.trim().to_owned(),
                    expected: EXPECTED,
                    units: AngleUnit::NAMES,
                });
            }
            sum = Some(match sum {
                None => {
                    negative = signed && !written.starts_with('+');
                    part
                }
                Some(sum) if negative => &sum - &part,
                Some(sum) => &sum + &part,
            });
            previous = Some(unit);
            if remainder.is_empty() {
                return Self::from_exact_degrees(sum.unwrap_or(Rational::ZERO), "the angle");
            }
            rest = remainder;
        }
    }
}

impl fmt::Display for Angle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}°", self.degrees())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle(text: &str) -> Angle {
        text.parse().expect(text)
    }

    #[test]
    fn units_are_exact() {
        for text in ["0.25", "0.25deg", "0.25°", "15'", "15 arcmin", "900\"", "900 arcsec", "0° 15'", "0°14'60\""] {
            assert_eq!(angle(text), angle("0.25"), "{text}");
        }
        assert_eq!(angle("-1° 30'").degrees(), -1.5);
        assert_eq!(angle("-0° 30'").degrees(), -0.5);
        assert_eq!(angle("1 rad").degrees(), 57.295_779_513_082_32);
        assert_eq!(angle("1e-300").degrees(), 1e-300);
        assert_eq!(angle("180").radians(), std::f64::consts::PI);
        assert_eq!(angle("5 mrad").in_unit(AngleUnit::Milliradian), 5.0);
        assert_eq!((&angle("12.35") - &angle("12.10")).degrees(), 0.25);
    }

    #[test]
    fn errors_name_what_is_wrong() {
        const UNITS: &str = "deg, °, ', arcmin, \", arcsec, rad or mrad";
        for (text, message) in [
            ("20 um", format!("`um` is a unit of length, and an angle is needed: write {UNITS}")),
            ("20 grad", format!("`grad` is not a unit of an angle: write {UNITS}")),
            ("1' 2°", format!("`2°` is not a unit of an angle: write {UNITS}")),
            ("1° -2'", format!("`-2'` is not a unit of an angle: write {UNITS}")),
            ("1 2", format!("`2` is not a unit of an angle: write {UNITS}")),
            ("x", "`x` is not an angle: that is not a decimal number".to_owned()),
            ("°", "`°` is not an angle: that is not a decimal number".to_owned()),
        ] {
            assert_eq!(text.parse::<Angle>().unwrap_err().to_string(), message);
        }
    }
}
