//! Angles: whole nano-arcseconds, with their units. Used by every module; trigonometry is in [`trig`](crate::trig).

use std::fmt;
use std::str::FromStr;

#[cfg(feature = "spec")]
use super::number::half_digit;
use super::number::{Decimal, split_number};
use super::unit::AngleUnit;
use super::{QuantityError, grid_quantity};

/// An angle on a grid of nano-arcseconds (2.8e-13°). Base unit: degree.
///
/// Read from text: a bare number is in degrees; the units are `deg` (`°`), `arcmin` (`'`), `arcsec` (`"`), `rad`,
/// `mrad`, `µrad`, `gon`. Minutes and seconds, at most 60 each, may follow degrees: `12° 30' 15"`. Every unit but the radian
/// is exact; radians take π to 18 digits.
///
/// ```
/// use rackmesh::quantity::Angle;
///
/// assert_eq!("15 arcmin".parse::<Angle>()?, Angle::from_degrees(0.25)?);
/// assert_eq!("12° 30'".parse::<Angle>()?.degrees(), 12.5);
/// # Ok::<(), rackmesh::quantity::QuantityError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Angle {
    nas: i64,
}

impl Angle {
    /// An angle from a number of degrees, read as its shortest decimal.
    ///
    /// # Errors
    /// [`QuantityError`] if `degrees` is an infinity or NaN, or beyond 277,777°.
    pub fn from_degrees(degrees: f64) -> Result<Self, QuantityError> {
        Self::of_f64(degrees, AngleUnit::Degree)
    }

    /// An angle from a number of nano-arcseconds.
    #[must_use]
    pub const fn from_nas(nas: i64) -> Self {
        Self { nas }
    }

    /// The angle in nano-arcseconds.
    #[must_use]
    pub const fn nas(self) -> i64 {
        self.nas
    }

    /// The angle in degrees.
    #[must_use]
    pub fn degrees(self) -> f64 {
        self.nas as f64 / 3.6e12
    }

    /// The angle in radians, rounded once to the nearest `f64`.
    #[must_use]
    pub fn radians(self) -> f64 {
        self.radians_and_rest().0
    }

    /// The angle in radians as the sum of two numbers: the nearest `f64`, and its rounding error.
    #[inline]
    pub(crate) fn radians_and_rest(self) -> (f64, f64) {
        const HALF: u32 = 26;
        /// The radians in a nano-arcsecond, π/648000 · 1e-9: its first 26 bits, and the others.
        const FIRST: f64 = 4.848_136_751_573_666e-15;
        const OTHERS: f64 = 5.952_169_393_454_658e-23;
        // both products with `FIRST` are exact
        let high = ((self.nas >> HALF) << HALF) as f64 * FIRST;
        let low = (self.nas & ((1 << HALF) - 1)) as f64 * FIRST + self.nas as f64 * OTHERS;
        let nearest = high + low;
        (nearest, low - (nearest - high))
    }

    /// The largest rounding error of an angle written as `text`: half of one in the last digit, that of the seconds in
    /// `19° 31' 42"`. A whole number counts as exact and has none.
    #[cfg(feature = "spec")]
    pub(crate) fn rounding_of(text: &str) -> Self {
        let half = half_digit(text).and_then(|(half, unit)| {
            let unit = if unit.is_empty() { AngleUnit::Degree } else { AngleUnit::from_symbol(unit)? };
            Self::of_number(half, unit).ok()
        });
        half.unwrap_or_default()
    }

    /// The angle in `unit`. Radians are not on the grid; of them it is the shortest decimal that reads back as the same
    /// angle.
    #[must_use]
    pub fn in_unit(self, unit: AngleUnit) -> f64 {
        match unit {
            AngleUnit::Radian => self.shortest_number(self.radians(), unit),
            AngleUnit::Milliradian => self.shortest_number(1e3 * self.radians(), unit),
            AngleUnit::Microradian => self.shortest_number(1e6 * self.radians(), unit),
            unit => self.nas as f64 / unit.scale().steps(),
        }
    }

    /// The shortest number near `value` that reads in `unit` as this angle.
    fn shortest_number(self, value: f64, unit: AngleUnit) -> f64 {
        self.shortest(value, unit).parse().unwrap_or(value)
    }

    /// The shortest decimal text of `value` that reads in `unit` as this angle.
    fn shortest(self, value: f64, unit: AngleUnit) -> String {
        let reads_back = |text: &String| {
            let read = Decimal::parse(text).ok().map(|number| Self::of_number(number, unit));
            read == Some(Ok(self))
        };
        (0..=16).map(|decimals| format!("{value:.decimals$}")).find(reads_back).unwrap_or_else(|| value.to_string())
    }
}

grid_quantity!(Angle, nas, AngleUnit, "the angle", "277777°");

impl FromStr for Angle {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, QuantityError> {
        const EXPECTED: &str = "an angle";
        let mut rest = text;
        let mut sum: Option<Self> = None;
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
                    Decimal::of_quantity(written, text, EXPECTED)?;
                    return Err(QuantityError::no_unit_of_angle(if symbol.is_empty() { remainder } else { symbol }));
                }
            };
            let number = Decimal::of_quantity(written, text, EXPECTED)?;
            let part = Self::of_number(number, unit)?;
            // the parts after the first have smaller units and no sign: 12° 30' 15"
            let follows = match previous {
                None => true,
                Some(AngleUnit::Degree) => matches!(unit, AngleUnit::Arcminute | AngleUnit::Arcsecond),
                Some(AngleUnit::Arcminute) => unit == AngleUnit::Arcsecond,
                Some(_) => false,
            };
            let signed = written.starts_with(['+', '-', '\u{2212}']);
            if !follows || (sum.is_some() && signed) {
                return Err(QuantityError::no_unit_of_angle(rest.trim()));
            }
            if previous.is_some_and(|previous| part.in_unit(previous) > 1.0) {
                let what = "the number of minutes or seconds";
                return Err(QuantityError::Overflow { what, largest: "60" });
            }
            sum = Some(match sum {
                None => {
                    negative = signed && !written.starts_with('+');
                    part
                }
                Some(sum) if negative => sum - part,
                Some(sum) => sum + part,
            });
            previous = Some(unit);
            if remainder.is_empty() {
                return Ok(sum.unwrap_or(Self::ZERO));
            }
            rest = remainder;
        }
    }
}

/// The shortest decimal number of degrees that reads back as the same angle.
impl fmt::Display for Angle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}°", self.shortest(self.degrees(), AngleUnit::Degree))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle(text: &str) -> Angle {
        text.parse().expect(text)
    }

    #[cfg(feature = "spec")]
    #[test]
    fn what_is_written_is_rounded_in_its_last_digit() {
        for (text, half) in [
            ("-19.528333", "0.0000005"),
            ("19° 31' 42\"", "0.5 arcsec"),
            ("\u{2212}19°31.7'", "0.05 arcmin"),
            ("\u{2212}20", "0"),
            ("1172 arcmin", "0"),
        ] {
            assert_eq!(Angle::rounding_of(text), angle(half), "{text}");
        }
    }

    #[test]
    fn units_are_exact() {
        for text in ["0.25", "0.25deg", "0.25°", "15'", "15 arcmin", "900\"", "900 arcsec", "0° 15'", "0°14'60\""] {
            assert_eq!(angle(text), angle("0.25"), "{text}");
        }
        assert_eq!(angle("1° 900\""), angle("1.25"));
        assert_eq!(
            "0°01′75″".parse::<Angle>().unwrap_err().to_string(),
            "the number of minutes or seconds is too large: its magnitude must stay within 60"
        );
        for text in ["0.25 Degrees", "0.25 Grad", "15 min", "15′", "900″", "900 sec", "0 deg 14 min 60 sec"] {
            assert_eq!(angle(text), angle("0.25"), "{text}");
        }
        assert_eq!(angle("3 gon"), angle("2.7"));
        assert_eq!(angle("2.7").in_unit(AngleUnit::Gon), 3.0);
        assert_eq!(angle("5 µrad"), angle("0.005 mrad"));
        assert_eq!(angle("5 urad").in_unit(AngleUnit::Microradian), 5.0);
        assert_eq!(angle("-1° 30'").degrees(), -1.5);
        assert_eq!(angle("-0° 30'").degrees(), -0.5);
        assert!((angle("1 rad").degrees() - 57.295_779_513_082_32).abs() < 1.4e-13);
        assert_eq!(angle("1e-300"), Angle::ZERO);
        assert_eq!(angle("0.00000000001").nas(), 36);
        assert_eq!(angle("180").radians(), std::f64::consts::PI);
        assert_eq!(angle("5 mrad").in_unit(AngleUnit::Milliradian), 5.0);
        assert_eq!((angle("12.35") - angle("12.10")).degrees(), 0.25);
    }

    #[test]
    fn every_spelling_is_its_unit_and_no_other() {
        for unit in AngleUnit::ALL {
            for spelling in unit.spellings().iter().chain([&unit.symbol()]) {
                assert_eq!(AngleUnit::from_symbol(spelling), Some(unit), "{spelling}");
            }
        }
        assert_eq!(AngleUnit::from_symbol("DEG"), Some(AngleUnit::Degree));
        // `grad` is a gon in English and a degree in German
        for symbol in ["grad", "GRAD", "Mrad", "gr", "s", "m", "°C", ""] {
            assert_eq!(AngleUnit::from_symbol(symbol), None, "{symbol}");
        }
    }

    #[test]
    fn errors_name_what_is_wrong() {
        const UNITS: &str = AngleUnit::NAMES;
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
