//! Decimal text to integers and back: what a batch does most.
//!
//! The row evaluator calls [`read`] with a field and [`Places::write`] with a result. Both know when they
//! are not sure, and then the exact path decides: they never guess.

use super::buffer::Buffer;
use crate::formula::Fixed;
use crate::quantity::{AngleUnit, LengthUnit};

/// A decimal number as it stands in a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Decimal {
    pub(super) negative: bool,
    pub(super) digits: u64,
    /// Digits behind the point.
    pub(super) decimals: usize,
}

/// Reads the plain decimal number that starts at `at`: sign, digits, decimal mark, digits. Returns it with
/// the place behind it; `None` if there is no such number, or if it has more than 18 digits.
#[inline]
pub(super) fn read(bytes: &[u8], at: usize, mark: u8) -> Option<(Decimal, usize)> {
    let mut at = at;
    let negative = *bytes.get(at)? == b'-';
    at += usize::from(negative);
    let start = at;
    let mut digits = 0u64;
    let mut byte = 0;
    while let Some(&next) = bytes.get(at) {
        byte = next;
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        digits = digits.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    let whole = at - start;
    let mut decimals = 0;
    if byte == mark && at < bytes.len() {
        at += 1;
        let point = at;
        while let Some(&byte) = bytes.get(at) {
            let digit = byte.wrapping_sub(b'0');
            if digit > 9 {
                break;
            }
            digits = digits.wrapping_mul(10).wrapping_add(u64::from(digit));
            at += 1;
        }
        decimals = at - point;
    }
    // 18 digits always fit
    if whole + decimals == 0 || whole + decimals > 18 {
        return None;
    }
    Some((Decimal { negative, digits, decimals }, at))
}

/// From a column's decimals to integers: of 1e-15 mm for lengths, of 1e-15 of the unit for angles.
#[derive(Debug, Clone)]
pub(super) struct Scale {
    /// By the number of decimals; 0 where the last place is smaller than the integers' unit.
    factors: [u64; 19],
}

impl Scale {
    pub(super) fn of_lengths(unit: LengthUnit) -> Self {
        match unit {
            LengthUnit::Millimetre => Self::new(15, 1),
            LengthUnit::Micrometre => Self::new(12, 1),
            // 25.4 mm = 254 · 10⁻¹ mm
            LengthUnit::Inch => Self::new(14, 254),
            LengthUnit::Mil => Self::new(11, 254),
        }
    }

    pub(super) fn of_angles() -> Self {
        Self::new(15, 1)
    }

    fn new(decimals: usize, factor: u64) -> Self {
        let mut factors = [0; 19];
        let mut power = factor;
        for place in (0..=decimals).rev() {
            factors[place] = power;
            power = power.saturating_mul(10);
        }
        Self { factors }
    }

    /// The integer; `None` if it is not one, or too large.
    #[inline]
    pub(super) fn integer(&self, decimal: Decimal) -> Option<i64> {
        let factor = *self.factors.get(decimal.decimals)?;
        let magnitude = decimal.digits.checked_mul(factor)?;
        if factor == 0 || magnitude > i64::MAX.unsigned_abs() / 2 {
            return None;
        }
        #[expect(clippy::cast_possible_wrap, reason = "below half of the largest")]
        let magnitude = magnitude as i64;
        Some(if decimal.negative { -magnitude } else { magnitude })
    }
}

/// Degrees in 1e-15 of a unit: two roundings, and a third when it is used.
pub(super) fn degrees_per_integer(unit: AngleUnit) -> f64 {
    unit.in_degrees().to_f64() * 1e-15
}

/// How many decimals of a millimetre are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decimals {
    /// So many, rounded half away from zero.
    Places(u8),
    /// The shortest text that reads back as the same double, as `eval` prints it.
    Full,
}

impl Decimals {
    /// The most that can be asked for.
    pub const MOST: u8 = 30;
}

impl Default for Decimals {
    /// A nanometre.
    fn default() -> Self {
        Self::Places(6)
    }
}

impl std::str::FromStr for Decimals {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse() {
            _ if text == "full" => Ok(Self::Full),
            Ok(places) if places <= Self::MOST => Ok(Self::Places(places)),
            _ => Err(format!("write a whole number up to {}, or `full`", Self::MOST)),
        }
    }
}

/// Writes [`Fixed`] lengths in mm with a number of decimals.
#[derive(Debug, Clone)]
pub(super) struct Places {
    count: usize,
    /// 1e-15 mm in the last place.
    unit: u64,
    per_unit: f64,
    /// 10^count.
    one: u64,
    /// 10^(8 - count), to fill eight digits.
    fill: u64,
}

impl Places {
    /// `None` where the last place is too small for the fast way to decide anything.
    pub(super) fn new(count: u8) -> Option<Self> {
        const MOST: u32 = 12;
        let count = u32::from(count);
        if count > MOST {
            return None;
        }
        let unit = 10u64.pow(Fixed::DECIMALS - count);
        #[expect(clippy::cast_precision_loss, reason = "powers of ten up to 10¹⁵ are exact")]
        let per_unit = 1.0 / unit as f64;
        Some(Self {
            count: count as usize,
            unit,
            per_unit,
            one: 10u64.pow(count),
            fill: 10u64.pow(8u32.saturating_sub(count)),
        })
    }

    /// Writes the value rounded half away from zero; `false`, and nothing written, if the value's bound does
    /// not decide the last digit.
    #[inline]
    pub(super) fn write(&self, out: &mut Buffer, value: Fixed) -> bool {
        let shifted = value.units.unsigned_abs() + self.unit / 2;
        // the quotient by a product that is off by one at most, and then the remainder says so
        #[expect(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "corrected below"
        )]
        let mut quotient = (shifted as f64 * self.per_unit) as u64;
        #[expect(clippy::cast_possible_wrap, reason = "the remainder is small")]
        let mut rest = shifted.wrapping_sub(quotient.wrapping_mul(self.unit)) as i64;
        #[expect(clippy::cast_possible_wrap, reason = "at most 10¹⁵")]
        let unit = self.unit as i64;
        if rest < 0 {
            quotient -= 1;
            rest += unit;
        } else if rest >= unit {
            quotient += 1;
            rest -= unit;
        }
        if rest < value.bound || rest + value.bound >= unit {
            return false;
        }
        if value.units < 0 && quotient != 0 {
            out.byte(b'-');
        }
        if quotient < self.one {
            out.byte(b'0');
        } else {
            out.integer(quotient / self.one);
            quotient %= self.one;
        }
        if self.count == 0 {
            return true;
        }
        out.byte(b'.');
        #[expect(clippy::cast_possible_truncation, reason = "below 10⁸")]
        if self.count <= 8 {
            out.leading_digits(eight_digits((quotient * self.fill) as u32), self.count);
        } else {
            let low = 10u64.pow(self.count as u32 - 8);
            out.leading_digits(eight_digits((quotient / low) as u32), 8);
            let rest = (quotient % low) * 10u64.pow(16 - self.count as u32);
            out.leading_digits(eight_digits(rest as u32), self.count - 8);
        }
        true
    }
}

/// The eight decimal digits of a number below 10⁸, the first one first: halves, quarters and single digits
/// are divided side by side in one word.
#[inline]
pub(super) fn eight_digits(number: u32) -> [u8; 8] {
    let fours = u64::from(number / 10_000) | u64::from(number % 10_000) << 32;
    // x / 100 = (x · 10486) >> 20 for x < 10⁴, x / 10 = (x · 103) >> 10 for x < 100
    let hundreds = ((fours * 10_486) >> 20) & 0x0000_007f_0000_007f;
    let twos = hundreds | (fours - hundreds * 100) << 16;
    let tens = ((twos * 103) >> 10) & 0x000f_000f_000f_000f;
    let ones = tens | (twos - tens * 10) << 8;
    (ones | 0x3030_3030_3030_3030).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits() {
        for number in (0..100_000_000).step_by(9973).chain([0, 9, 10, 99, 9999, 10_000, 99_999_999]) {
            assert_eq!(std::str::from_utf8(&eight_digits(number)).unwrap(), format!("{number:08}"));
        }
    }

    #[test]
    fn plain_numbers_are_read_and_others_left_alone() {
        let decimal = |negative, digits, decimals| Decimal { negative, digits, decimals };
        assert_eq!(read(b"x-25.0131,", 1, b'.'), Some((decimal(true, 250_131, 4), 9)));
        assert_eq!(read(b"7", 0, b'.'), Some((decimal(false, 7, 0), 1)));
        assert_eq!(read(b".5,", 0, b'.'), Some((decimal(false, 5, 1), 2)));
        assert_eq!(read(b"7.\n", 0, b'.'), Some((decimal(false, 7, 0), 2)));
        for text in [&b""[..], b"-", b".", b"-.", b",", b" 1", b"+1", b"abc", b"1234567890123456789"] {
            assert_eq!(read(text, 0, b'.'), None, "{text:?}");
        }
        // the place behind the number shows that these are more than a plain number
        assert_eq!(read(b"1e3", 0, b'.').map(|(_, end)| end), Some(1));
        assert_eq!(read(b"12 um", 0, b'.').map(|(_, end)| end), Some(2));
    }

    #[test]
    fn scales_are_exact() {
        let read = |text: &str| read(text.as_bytes(), 0, b'.').unwrap().0;
        let mm = Scale::of_lengths(LengthUnit::Millimetre);
        assert_eq!(mm.integer(read("25.0131")), Some(25_013_100_000_000_000));
        assert_eq!(mm.integer(read("-0.000000000000001")), Some(-1));
        assert_eq!(mm.integer(read("0.0000000000000001")), None);
        assert_eq!(mm.integer(read("9000")), None);
        assert_eq!(Scale::of_lengths(LengthUnit::Micrometre).integer(read("13.1")), Some(13_100_000_000_000));
        assert_eq!(Scale::of_lengths(LengthUnit::Inch).integer(read("1.0001")), Some(25_402_540_000_000_000));
        assert_eq!(Scale::of_lengths(LengthUnit::Mil).integer(read("-1")), Some(-25_400_000_000_000));
    }

    #[test]
    fn written_decimals_are_rounded_once_or_not_at_all() {
        let write = |places: u8, units: i64, bound: i64| {
            let mut out = Buffer::default();
            out.room(64);
            let sure = Places::new(places).unwrap().write(&mut out, Fixed { units, bound });
            sure.then(|| String::from_utf8(out.written().to_vec()).unwrap())
        };
        for (places, units, text) in [
            (6, 13_100_000_000_000, "0.013100"),
            (6, -13_100_500_000_000, "-0.013101"),
            (6, 13_100_499_999_999, "0.013100"),
            (6, -499_999_999, "0.000000"),
            (6, -500_000_000, "-0.000001"),
            (0, 500_000_000_000_000, "1"),
            (0, -1_499_999_999_999_999, "-1"),
            (1, 999_950_000_000_000_000, "1000.0"),
            (3, 12_345_678_000_000_000, "12.346"),
            (9, 12_345_678_123_456_789, "12.345678123"),
            (12, -1_000_000_000_001_499, "-1.000000000001"),
        ] {
            assert_eq!(write(places, units, 0).as_deref(), Some(text), "{units} {places}");
        }
        assert_eq!(write(6, 13_100_500_000_000, 1), None);
        assert_eq!(write(6, 13_100_499_999_999, 1), None);
        assert_eq!(write(6, 13_100_499_999_998, 1).as_deref(), Some("0.013100"));
    }
}
