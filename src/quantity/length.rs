//! Lengths: rational numbers of millimetres, with their units. Used by every module; rounded only where they leave.

use std::fmt;
use std::str::FromStr;

use super::angle::AngleUnit;
use super::parse::{number, split_number};
use super::{QuantityError, Rational, exact_arithmetic};

/// A length, known exactly. Base unit: mm.
///
/// Read from text: a bare number is in mm; the units are `um` (`µm`), `mm`, `in`, `mil`.
///
/// ```
/// use rackmesh::quantity::Length;
///
/// assert_eq!("20 um".parse::<Length>()?, Length::from_mm(0.02)?);
/// assert_eq!("0.5 in".parse::<Length>()?.mm(), 12.7);
/// # Ok::<(), rackmesh::quantity::QuantityError>(())
/// ```
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Length {
    mm: Rational,
}

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LengthUnit {
    /// `um`, `µm`: 0.001 mm.
    Micrometre,
    /// `mm`.
    Millimetre,
    /// `in`: 25.4 mm.
    Inch,
    /// `mil`: 0.001 in.
    Mil,
}

impl LengthUnit {
    /// The units in words, for messages.
    pub const NAMES: &'static str = "um, µm, mm, in or mil";

    /// The unit of that symbol.
    #[must_use]
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        match symbol {
            "mm" => Some(Self::Millimetre),
            // the micro sign and the Greek letter look alike and are both typed
            "um" | "\u{b5}m" | "\u{3bc}m" => Some(Self::Micrometre),
            "in" => Some(Self::Inch),
            "mil" => Some(Self::Mil),
            _ => None,
        }
    }

    /// The unit's symbol.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Micrometre => "µm",
            Self::Millimetre => "mm",
            Self::Inch => "in",
            Self::Mil => "mil",
        }
    }

    /// Millimetres in one of this unit.
    #[must_use]
    pub fn in_mm(self) -> Rational {
        match self {
            Self::Micrometre => Rational::fraction(1, 1000),
            Self::Millimetre => Rational::ONE,
            Self::Inch => Rational::fraction(254, 10),
            Self::Mil => Rational::fraction(254, 10_000),
        }
    }
}

impl Length {
    /// No length at all.
    pub const ZERO: Self = Self { mm: Rational::ZERO };

    /// A length in mm; the number is taken as the decimal that was written for it, its shortest one.
    ///
    /// # Errors
    /// [`QuantityError::NotFinite`] if `mm` is an infinity or NaN.
    pub fn from_mm(mm: f64) -> Result<Self, QuantityError> {
        let mm = Rational::from_shortest_decimal(mm)
            .ok_or_else(|| QuantityError::NotFinite { what: "the length", value: mm.to_string() })?;
        Ok(Self { mm })
    }

    /// A length of exactly that many mm; `what` names it in the error.
    ///
    /// # Errors
    /// [`QuantityError::Overflow`] if the nearest `f64` is infinite.
    pub fn from_exact_mm(mm: Rational, what: &'static str) -> Result<Self, QuantityError> {
        if mm.to_f64().is_infinite() {
            return Err(QuantityError::Overflow { what });
        }
        Ok(Self { mm })
    }

    /// The length in mm, rounded once to the nearest `f64`.
    #[must_use]
    pub fn mm(&self) -> f64 {
        self.mm.to_f64()
    }

    /// The length in mm, exactly.
    #[must_use]
    pub fn exact_mm(&self) -> &Rational {
        &self.mm
    }

    /// The length in `unit`, rounded once to the nearest `f64`.
    #[must_use]
    pub fn in_unit(&self, unit: LengthUnit) -> f64 {
        (&self.mm / &unit.in_mm()).to_f64()
    }
}

exact_arithmetic!(Length, mm);

impl FromStr for Length {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, QuantityError> {
        const EXPECTED: &str = "a length";
        let (written, unit) = split_number(text);
        let number = number(written, text, EXPECTED)?;
        let unit = match LengthUnit::from_symbol(unit) {
            Some(unit) => unit,
            None if unit.is_empty() => LengthUnit::Millimetre,
            None => {
                let (unit, units) = (unit.to_owned(), LengthUnit::NAMES);
                return Err(match AngleUnit::from_symbol(&unit) {
                    Some(_) => QuantityError::OtherDimension { unit, measures: "angle", expected: EXPECTED, units },
                    None => QuantityError::UnknownUnit { unit, expected: EXPECTED, units },
                });
            }
        };
        Self::from_exact_mm(&number * &unit.in_mm(), "the length")
    }
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} mm", self.mm())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(text: &str) -> Length {
        text.parse().expect(text)
    }

    #[test]
    fn units_are_exact() {
        for text in ["12.7", "12.7mm", "12700 um", "12700 µm", "12700μm", "0.5 in", "500mil", " +12.7 mm "] {
            assert_eq!(length(text), length("12.7"), "{text}");
        }
        assert_eq!(length("1e3um"), length("1"));
        assert_eq!(length("-20 um").mm(), -0.02);
        assert_eq!(length("0.0131").in_unit(LengthUnit::Micrometre), 13.1);
    }

    #[test]
    fn differences_are_decimal_in_every_unit() {
        for (a, b, difference) in [
            ("25.0131", "25.0000", 0.0131),
            ("25013.1 um", "25 mm", 0.0131),
            ("1.0001 in", "1 in", 0.00254),
            ("1 mil", "25.3 um", 0.0001),
            ("-0.3", "-0.1", -0.2),
        ] {
            assert_eq!((&length(a) - &length(b)).mm(), difference, "{a} - {b}");
        }
    }

    #[test]
    fn errors_name_what_is_wrong() {
        for (text, message) in [
            ("20 deg", "`deg` is a unit of angle, and a length is needed: write um, µm, mm, in or mil"),
            ("20 mn", "`mn` is not a unit of a length: write um, µm, mm, in or mil"),
            (
                "0,4",
                "`0,4` is not a length: a comma could be a decimal or a thousands mark; write a decimal point and no \
                 thousands mark",
            ),
            ("abc", "`abc` is not a length: that is not a decimal number"),
            ("nan", "`nan` is not a length: a finite number is needed"),
            ("", "`` is not a length: there is no number"),
            ("1e308 in", "the length is beyond the range of double-precision numbers (1.8e308)"),
        ] {
            assert_eq!(text.parse::<Length>().unwrap_err().to_string(), message);
        }
        assert!(Length::from_mm(f64::NAN).is_err());
        assert!(Length::from_mm(f64::INFINITY).is_err());
    }
}
