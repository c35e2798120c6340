//! Units of lengths and of angles: their spellings and their scales.

use super::number::Scale;

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LengthUnit {
    /// `nm`: 0.000001 mm.
    Nanometre,
    /// `um`, `µm`: 0.001 mm.
    Micrometre,
    /// `1/100 mm`, in a heading.
    Hundredth,
    /// `mm`.
    Millimetre,
    /// `cm`: 10 mm.
    Centimetre,
    /// `m`: 1000 mm.
    Metre,
    /// `in`, `″`: 25.4 mm.
    Inch,
    /// `mil`: 0.001 in.
    Mil,
}

impl LengthUnit {
    /// Every unit that stands behind a number, the usual ones first.
    pub const ALL: [Self; 7] =
        [Self::Millimetre, Self::Micrometre, Self::Inch, Self::Mil, Self::Nanometre, Self::Centimetre, Self::Metre];

    /// The units in words, for messages.
    pub const NAMES: &'static str = "nm, um, µm, mm, cm, m, in or mil";

    /// The unit with this symbol or name in a heading.
    #[must_use]
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        let thousandth = is_spelt(symbol, &["1/1000 mm", "1/1000mm", "mm/1000", "10⁻³ mm"]).then_some(Self::Micrometre);
        let hundredth = || is_spelt(symbol, Self::Hundredth.spellings()).then_some(Self::Hundredth);
        thousandth.or_else(hundredth).or_else(|| Self::behind_number(symbol))
    }

    /// The unit with this symbol behind a number; without `1/1000 mm`, for `12 1/1000 mm` could be a mixed fraction.
    pub(super) fn behind_number(symbol: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| is_spelt(symbol, unit.spellings()))
    }

    /// How the unit is written behind a number.
    pub(crate) const fn spellings(self) -> &'static [&'static str] {
        match self {
            Self::Nanometre => &["nm", "\u{339a}"],
            // the micro sign and the Greek letter look alike; people type both
            Self::Micrometre => &[
                "um",
                "\u{b5}m",
                "\u{3bc}m",
                "\u{339b}",
                "micron",
                "microns",
                "micrometer",
                "micrometre",
                "micrometers",
                "micrometres",
                "mikrometer",
                "micromètre",
                "micromètres",
                "ミクロン",
            ],
            Self::Hundredth => &["1/100 mm", "1/100mm", "mm/100"],
            Self::Millimetre => &[
                "mm",
                "\u{339c}",
                "millimeter",
                "millimeters",
                "millimetre",
                "millimetres",
                "millimètre",
                "millimètres",
                "ミリ",
            ],
            Self::Centimetre => &["cm", "\u{339d}"],
            Self::Metre => &["m"],
            Self::Inch => &["in", "in.", "inch", "inches", "zoll", "pouce", "pouces", "インチ", "\u{2033}"],
            Self::Mil => &["mil", "mils", "thou"],
        }
    }

    /// The unit's symbol.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Micrometre => "µm",
            unit => unit.spellings()[0],
        }
    }

    /// One of this unit in femtometres.
    pub(crate) const fn scale(self) -> Scale {
        match self {
            Self::Nanometre => Scale { factor: 1, exponent: 6 },
            Self::Micrometre => Scale { factor: 1, exponent: 9 },
            Self::Hundredth => Scale { factor: 1, exponent: 10 },
            Self::Millimetre => Scale { factor: 1, exponent: 12 },
            Self::Centimetre => Scale { factor: 1, exponent: 13 },
            Self::Metre => Scale { factor: 1, exponent: 15 },
            // 25.4 mm
            Self::Inch => Scale { factor: 254, exponent: 11 },
            Self::Mil => Scale { factor: 254, exponent: 8 },
        }
    }
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
    /// `µrad`, `urad`: 0.000001 rad.
    Microradian,
    /// `gon`: 0.9°.
    Gon,
}

impl AngleUnit {
    /// Every unit, the usual ones first.
    pub const ALL: [Self; 7] =
        [Self::Degree, Self::Arcminute, Self::Arcsecond, Self::Radian, Self::Milliradian, Self::Microradian, Self::Gon];

    /// The units in words, for messages.
    pub const NAMES: &'static str = "deg, °, ', arcmin, \", arcsec, rad, mrad, µrad or gon";

    /// The unit with this symbol or name of a known angle: `min` and `sec` are parts of a degree.
    #[must_use]
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| is_spelt(symbol, unit.spellings()))
    }

    /// How the unit is written.
    pub(crate) const fn spellings(self) -> &'static [&'static str] {
        match self {
            Self::Degree => &["deg", "°", "degree", "degrees", "Grad"],
            Self::Arcminute => &["arcmin", "'", "\u{2032}", "\u{2019}", "min"],
            Self::Arcsecond => &["arcsec", "\"", "\u{2033}", "\u{201d}", "''", "sec"],
            Self::Radian => &["rad"],
            Self::Milliradian => &["mrad"],
            // the micro sign and the Greek letter look alike; people type both
            Self::Microradian => &["urad", "\u{b5}rad", "\u{3bc}rad"],
            Self::Gon => &["gon"],
        }
    }

    /// The unit's symbol, as it stands after a number and a blank.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Microradian => "µrad",
            unit => unit.spellings()[0],
        }
    }

    /// One of this unit in nano-arcseconds.
    pub(crate) const fn scale(self) -> Scale {
        match self {
            Self::Degree => Scale { factor: 36, exponent: 11 },
            Self::Arcminute => Scale { factor: 6, exponent: 10 },
            Self::Arcsecond => Scale { factor: 1, exponent: 9 },
            // 648000/π arcseconds, to 18 digits
            Self::Radian => Scale { factor: 206_264_806_247_096_355, exponent: -3 },
            Self::Milliradian => Scale { factor: 206_264_806_247_096_355, exponent: -6 },
            Self::Microradian => Scale { factor: 206_264_806_247_096_355, exponent: -9 },
            Self::Gon => Scale { factor: 324, exponent: 10 },
        }
    }
}

/// A unit of length or of angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Of a length.
    Length(LengthUnit),
    /// Of an angle.
    Angle(AngleUnit),
}

impl Unit {
    /// The unit with this symbol where nothing else says what is measured: `″` is an inch; `min` and `sec` are times.
    #[must_use]
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        let length = LengthUnit::from_symbol(symbol).map(Self::Length);
        let is_time = ["min", "sec"].iter().any(|time| time.eq_ignore_ascii_case(symbol));
        length.or_else(|| Self::of_angle(symbol).filter(|_| !is_time))
    }

    /// The unit with this symbol of a known length: `″` and `"` are inches.
    #[must_use]
    pub fn of_length(symbol: &str) -> Option<Self> {
        let inch = (symbol == "\"").then_some(LengthUnit::Inch);
        inch.or_else(|| LengthUnit::from_symbol(symbol)).map(Self::Length)
    }

    /// The unit with this symbol of a known angle: `″` is an arcsecond, `min` an arcminute.
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

/// Spellings whose case matters: `Nm` is a moment, `M` a thread, `Mrad` a million radians, and `grad` is a gon in English.
const CASE_COUNTS: [&str; 4] = ["m", "nm", "mrad", "Grad"];

/// A regular expression for a spelling; in any case, unless its case matters.
#[cfg(feature = "spec")]
pub(crate) fn spelling_pattern(spelling: &str) -> String {
    let letter = |letter: char| format!("[{}{}]", letter.to_ascii_lowercase(), letter.to_ascii_uppercase());
    let has_case = |letter: char| letter.is_ascii_alphabetic() && !CASE_COUNTS.contains(&spelling);
    let sign = |part: char| if part == '.' { r"\.".to_owned() } else { part.into() };
    spelling.chars().map(|part| if has_case(part) { letter(part) } else { sign(part) }).collect()
}

/// Whether a symbol is one of a unit's spellings; in any case, unless its case matters.
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
            ("\"", arcsecond, inch, arcsecond),
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
