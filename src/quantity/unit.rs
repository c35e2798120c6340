//! The unit of a column or of a result: of a length, or of an angle.

use super::{AngleUnit, LengthUnit};

/// A unit of length or of angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Of a length.
    Length(LengthUnit),
    /// Of an angle.
    Angle(AngleUnit),
}

impl Unit {
    /// The unit of that symbol where nothing else says what is measured: `″` is an inch, and `min` and `sec` are times.
    #[must_use]
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        let is_time = ["min", "sec"].iter().any(|time| time.eq_ignore_ascii_case(symbol));
        Self::of_length(symbol).or_else(|| Self::of_angle(symbol).filter(|_| !is_time))
    }

    /// The unit of that symbol on what is known to be a length: `″` is an inch.
    #[must_use]
    pub fn of_length(symbol: &str) -> Option<Self> {
        LengthUnit::from_symbol(symbol).map(Self::Length)
    }

    /// The unit of that symbol on what is known to be an angle: `″` is an arcsecond, `min` an arcminute.
    #[must_use]
    pub fn of_angle(symbol: &str) -> Option<Self> {
        AngleUnit::from_symbol(symbol).map(Self::Angle)
    }

    /// The unit's symbol.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Length(unit) => unit.symbol(),
            Self::Angle(unit) => unit.symbol(),
        }
    }
}

/// Spellings that mean something else in other case: `Nm` is a moment, `M` a thread, `Mrad` a million radians, and
/// `grad` a gon to some.
const CASE_COUNTS: [&str; 4] = ["m", "nm", "mrad", "Grad"];

/// Whether a symbol is one of a unit's spellings, in any case where that changes nothing.
pub(super) fn is_spelt(symbol: &str, spellings: &[&str]) -> bool {
    spellings.iter().any(|spelling| {
        *spelling == symbol || (spelling.eq_ignore_ascii_case(symbol) && !CASE_COUNTS.contains(spelling))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_measured_decides_what_a_mark_means() {
        let inch = Some(Unit::Length(LengthUnit::Inch));
        let arcsecond = Some(Unit::Angle(AngleUnit::Arcsecond));
        for (symbol, anywhere, of_length, of_angle) in [
            ("\u{2033}", inch, inch, arcsecond),
            ("\"", arcsecond, None, arcsecond),
            ("sec", None, None, arcsecond),
            ("Min", None, None, Some(Unit::Angle(AngleUnit::Arcminute))),
            ("Micron", Some(Unit::Length(LengthUnit::Micrometre)), Some(Unit::Length(LengthUnit::Micrometre)), None),
            ("N", None, None, None),
        ] {
            assert_eq!(Unit::from_symbol(symbol), anywhere, "{symbol}");
            assert_eq!(Unit::of_length(symbol), of_length, "{symbol}");
            assert_eq!(Unit::of_angle(symbol), of_angle, "{symbol}");
        }
    }
}
