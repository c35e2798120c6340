//! Lengths: whole femtometres, with their units. Used by every module.

use std::fmt;
use std::str::FromStr;

use super::decimals::Places;
#[cfg(feature = "spec")]
use super::number::half_digit;
use super::number::{Decimal, split_number};
use super::unit::LengthUnit;
use super::{FM_PER_MM, QuantityError, grid_quantity};

/// A length on a grid of femtometres (1e-12 mm). Base unit: mm.
///
/// Read from text: a bare number is in mm; the units are `nm`, `um` (`µm`), `mm`, `cm`, `m`, `in` (`″`), `mil`. A finer
/// number is rounded to the grid. The largest length is 1 km.
///
/// ```
/// use rackmesh::quantity::Length;
///
/// assert_eq!("20 um".parse::<Length>()?, Length::from_mm(0.02)?);
/// assert_eq!("0.5 in".parse::<Length>()?.mm(), 12.7);
/// # Ok::<(), rackmesh::quantity::QuantityError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Length {
    fm: i64,
}

/// In mm.
#[cfg(feature = "report")]
impl serde::Serialize for Length {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_f64(self.mm())
    }
}

impl Length {
    /// A length from a number of mm, read as its shortest decimal.
    ///
    /// # Errors
    /// [`QuantityError`] if `mm` is an infinity or NaN, or beyond 1 km.
    pub fn from_mm(mm: f64) -> Result<Self, QuantityError> {
        Self::of_f64(mm, LengthUnit::Millimetre)
    }

    /// The length nearest to a number of femtometres; halves are rounded away from zero.
    ///
    /// # Errors
    /// [`QuantityError::Overflow`] beyond the largest length; it names the quantity, `what`.
    #[inline]
    pub(crate) fn nearest(fm: f64, what: &'static str) -> Result<Self, QuantityError> {
        match Self::near(fm) {
            Some(length) => Ok(length),
            None => Self::of_steps(None, what),
        }
    }

    /// The length nearest to a number of femtometres; `None` beyond the largest length.
    #[inline]
    pub(crate) fn near(fm: f64) -> Option<Self> {
        // false for NaN
        let is_within = fm.abs() <= Self::LARGEST.fm as f64;
        // adding 0.5 itself would round a number just below a half up
        let half = 0.5_f64.next_down();
        is_within.then(|| Self { fm: (fm + half.copysign(fm)) as i64 })
    }

    /// The exact sum of lengths.
    ///
    /// # Errors
    /// [`QuantityError::Overflow`] beyond the largest length; it names the sum, `what`.
    pub(crate) fn sum(lengths: impl IntoIterator<Item = Self>, what: &'static str) -> Result<Self, QuantityError> {
        Self::of_sum(lengths.into_iter().map(|length| i128::from(length.fm)).sum(), what)
    }

    /// A sum of femtometres as a length; `what` names it in the error.
    pub(crate) fn of_sum(fm: i128, what: &'static str) -> Result<Self, QuantityError> {
        Self::of_steps(i64::try_from(fm).ok(), what)
    }

    /// A length from a number of femtometres.
    #[must_use]
    pub const fn from_fm(fm: i64) -> Self {
        Self { fm }
    }

    /// The length in femtometres.
    #[must_use]
    pub const fn fm(self) -> i64 {
        self.fm
    }

    /// The length in mm.
    #[must_use]
    pub fn mm(self) -> f64 {
        self.fm as f64 / FM_PER_MM
    }

    /// The length in `unit`.
    #[must_use]
    pub fn in_unit(self, unit: LengthUnit) -> f64 {
        self.fm as f64 / unit.scale().steps()
    }

    /// The largest rounding error of a length written as `text`: half of one in the last digit. A whole number counts as
    /// exact and has none.
    #[cfg(feature = "spec")]
    pub(crate) fn rounding_of(text: &str) -> Self {
        let half = half_digit(text).and_then(|(half, unit)| {
            let unit = if unit.is_empty() { LengthUnit::Millimetre } else { LengthUnit::from_symbol(unit)? };
            Self::of_number(half, unit).ok()
        });
        half.unwrap_or_default()
    }

    /// The length in mm with `decimals` decimals; halves are rounded away from zero.
    #[must_use]
    pub fn to_decimal_text(self, decimals: usize) -> String {
        let mut text = Vec::new();
        Places::new(decimals).write(&mut text, self);
        text.into_iter().map(char::from).collect()
    }
}

grid_quantity!(Length, fm, LengthUnit, "the length", "1e6 mm");

impl FromStr for Length {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, QuantityError> {
        let (written, unit) = split_number(text);
        let number = Decimal::of_quantity(written, text, "a length")?;
        let unit = match LengthUnit::behind_number(unit) {
            Some(unit) => unit,
            None if unit.is_empty() => LengthUnit::Millimetre,
            None => return Err(QuantityError::no_unit_of_length(unit)),
        };
        Self::of_number(number, unit)
    }
}

/// The shortest decimal number of mm.
impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} mm", self.to_decimal_text(12).trim_end_matches('0').trim_end_matches('.'))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(text: &str) -> Length {
        text.parse().expect(text)
    }

    /// Doubles that are read at once give the same lengths as each by itself, or `None`.
    #[cfg(feature = "table")]
    #[test]
    fn doubles_at_once_are_lengths_one_by_one() {
        let less = Length::from_fm(25_000_000_000_000);
        for unit in LengthUnit::ALL {
            for value in [0.0, -0.0, 25.0131, -25.0131, 24.999_999, 1e-6, 5e-7, 0.1, 0.3, 999.5, 123_456.789_012, 1e9] {
                let by_itself = Length::of_plain(Decimal::of_double(value).unwrap(), unit).map(|length| length - less);
                let at_once = Length::of_doubles(&[value], unit, less, Length::LARGEST);
                let at_once = at_once.map(|lengths| lengths[0]);
                assert!(at_once.is_none() || at_once == by_itself, "{value} {unit:?}: {at_once:?} {by_itself:?}");
            }
            assert_eq!(Length::of_doubles(&[1.25, f64::NAN], unit, less, Length::LARGEST), None);
            assert_eq!(Length::of_doubles(&[1.25, 0.123_456_7], unit, less, Length::LARGEST), None);
            assert!(Length::of_doubles(&[1.25, -0.5], unit, less, Length::LARGEST).is_some());
            assert_eq!(Length::of_doubles(&[1.25], unit, less, Length::from_fm(1)), None);
        }
    }

    #[cfg(feature = "spec")]
    #[test]
    fn what_is_written_is_rounded_in_its_last_digit() {
        for (text, half) in [
            ("3.18310", "0.000005"),
            ("-3.2 mm", "0.05"),
            ("0.125 in", "0.0127"),
            ("25e-1", "0.05"),
            ("3", "0"),
            ("3000 um", "0"),
            ("x", "0"),
        ] {
            assert_eq!(Length::rounding_of(text), length(half), "{text}");
        }
    }

    #[test]
    fn units_are_exact() {
        for text in ["12.7", "12.7mm", "12700 um", "12700 µm", "12700μm", "0.5 in", "500mil", " +12.7 mm "] {
            assert_eq!(length(text), length("12.7"), "{text}");
        }
        for text in
            ["12700 MM", "12.7 ㎜", "12700000 nm", "12700㎛", "12700 Microns", "1.27 cm", "1.27㎝", "0.5″", "0.5 INCH"]
        {
            let expected = if text.ends_with("MM") { "12.7e3" } else { "12.7" };
            assert_eq!(length(text), length(expected), "{text}");
        }
        assert_eq!(length("0.0127 m"), length("500 thou"));
        assert_eq!(length("1e3um"), length("1"));
        assert_eq!(length("12.5 nm").fm(), 12_500_000);
        assert_eq!(length("1000 m"), Length::LARGEST);
        assert_eq!(length("-20 um").mm(), -0.02);
        assert_eq!(length("0.0131").in_unit(LengthUnit::Micrometre), 13.1);
    }

    #[test]
    fn every_spelling_is_its_unit_and_no_other() {
        for unit in LengthUnit::ALL {
            for spelling in unit.spellings().iter().chain([&unit.symbol()]) {
                assert_eq!(LengthUnit::from_symbol(spelling), Some(unit), "{spelling}");
            }
            assert_eq!(Length::of_number(Decimal::parse("3").unwrap(), unit).unwrap().in_unit(unit), 3.0, "{unit:?}");
        }
        for symbol in ["Mm", "MM", "CM", "IN", "Inch", "Micron", "Thou", "1/1000 MM"] {
            assert!(LengthUnit::from_symbol(symbol).is_some(), "{symbol}");
        }
        // a thread, a moment, a force, a concentration; nothing at all
        for symbol in ["M", "Nm", "NM", "N", "min", "sec", "µ", "\"", "'", "km", ""] {
            assert_eq!(LengthUnit::from_symbol(symbol), None, "{symbol}");
        }
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
            assert_eq!((length(a) - length(b)).mm(), difference, "{a} - {b}");
        }
    }

    #[test]
    fn errors_name_what_is_wrong() {
        for (text, message) in [
            ("20 deg", "`deg` is a unit of angle, and a length is needed: write nm, um, µm, mm, cm, m, in or mil"),
            ("5 M", "`M` is not a unit of a length: write nm, um, µm, mm, cm, m, in or mil"),
            ("5 Nm", "`Nm` is not a unit of a length: write nm, um, µm, mm, cm, m, in or mil"),
            ("12 1/1000 mm", "`1/1000 mm` is not a unit of a length: write nm, um, µm, mm, cm, m, in or mil"),
            ("1000.0001 m", "the length is too large: its magnitude must stay within 1e6 mm"),
            ("20 mn", "`mn` is not a unit of a length: write nm, um, µm, mm, cm, m, in or mil"),
            (
                "0,4",
                "`0,4` is not a length: a comma could be a decimal or a thousands mark; write a decimal point and no \
                 thousands mark",
            ),
            ("abc", "`abc` is not a length: that is not a decimal number"),
            ("nan", "`nan` is not a length: a finite number is needed"),
            ("", "`` is not a length: there is no number"),
            ("1e308 in", "the length is too large: its magnitude must stay within 1e6 mm"),
            ("1000000.000000000001", "the length is too large: its magnitude must stay within 1e6 mm"),
        ] {
            assert_eq!(text.parse::<Length>().unwrap_err().to_string(), message);
        }
        assert_eq!(length("1e6").mm(), 1e6);
        assert!(Length::from_mm(f64::NAN).is_err());
        assert!(Length::from_mm(f64::INFINITY).is_err());
    }
}
