//! The one reader of decimal text. Called for lengths, angles and plain numbers. The decimal mark is a point; `nan` and `inf`
//! are no numbers.

use thiserror::Error;

/// Why a text is not a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum NumberError {
    /// There is no number in the text.
    #[error("there is no number")]
    Empty,
    /// The text is not a decimal number.
    #[error("that is not a decimal number")]
    NotANumber,
    /// The number has a comma, which could be a decimal comma or a thousands mark.
    #[error("a comma could be a decimal or a thousands mark; write a decimal point and no thousands mark")]
    Comma,
    /// The text is an infinity or not-a-number.
    #[error("a finite number is needed")]
    NotFinite,
    /// The number is larger than any double-precision number.
    #[error("the number is too large (its magnitude must stay below 1.8e308)")]
    TooLarge,
}

/// The powers of ten that fit a `u64`.
const POWERS_OF_TEN: [u64; 20] = {
    let mut powers = [1; 20];
    let mut exponent = 1;
    while exponent < 20 {
        powers[exponent] = 10 * powers[exponent - 1];
        exponent += 1;
    }
    powers
};

/// The most digits that always fit a `u64`.
pub(super) const MOST_DIGITS: usize = 19;

/// A decimal number `±digits · 10^exponent`. Digits of a text after the 19th are cut off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Decimal {
    pub(crate) negative: bool,
    pub(crate) digits: u64,
    pub(crate) exponent: i32,
}

/// The steps of a quantity's grid in one of a unit: `factor · 10^exponent`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Scale {
    pub(crate) factor: u64,
    pub(crate) exponent: i32,
}

impl Scale {
    /// The steps of one of the unit, where they are a whole number.
    pub(crate) const fn steps(self) -> f64 {
        (self.factor * POWERS_OF_TEN[self.exponent as usize]) as f64
    }

    /// The steps of one in that decimal of the unit, if they are a whole number.
    #[cfg(feature = "table")]
    pub(super) fn of_decimal(self, decimal: i32) -> Option<i64> {
        let power = POWERS_OF_TEN.get(usize::try_from(self.exponent - decimal).ok()?)?;
        i64::try_from(self.factor.checked_mul(*power)?).ok()
    }
}

impl Decimal {
    /// Reads a decimal number: `25.0131`, `-3`, `+1.5e-3`.
    pub(crate) fn parse(text: &str) -> Result<Self, NumberError> {
        if let Some((plain, end)) = Self::plain(text.as_bytes(), 0, b'.')
            && end == text.len()
        {
            return Ok(plain);
        }
        let (negative, rest) = match text.strip_prefix(['-', '\u{2212}']) {
            Some(rest) => (true, rest),
            None => (false, text.strip_prefix('+').unwrap_or(text)),
        };
        let (mantissa, exponent) = match rest.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, Some(exponent)),
            None => (rest, None),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let is_number = |digits: &str| digits.bytes().all(|byte| byte.is_ascii_digit());
        if mantissa.len() == usize::from(mantissa.contains('.')) || !is_number(whole) || !is_number(fraction) {
            return Err(match text.to_ascii_lowercase().trim_start_matches(['+', '-']) {
                "" => NumberError::Empty,
                "inf" | "infinity" | "nan" => NumberError::NotFinite,
                _ if rest.contains(',') => NumberError::Comma,
                _ => NumberError::NotANumber,
            });
        }
        let exponent = exponent.map_or(Ok(0), power_of_ten)?;
        let significant = || whole.bytes().chain(fraction.bytes()).skip_while(|digit| *digit == b'0');
        let digits = significant().take(MOST_DIGITS).fold(0, |sum, digit| 10 * sum + u64::from(digit - b'0'));
        let count = |n: usize| i32::try_from(n).unwrap_or(i32::MAX / 4);
        let cut_off = count(significant().count().saturating_sub(MOST_DIGITS));
        Ok(Self { negative, digits, exponent: exponent - count(fraction.len()) + cut_off })
    }

    /// The nearest step of a grid, halves away from zero; `None` beyond an `i64`.
    #[inline]
    pub(crate) fn steps(self, scale: Scale) -> Option<i64> {
        if self.digits == 0 {
            return Some(0);
        }
        let exponent = self.exponent + scale.exponent;
        let magnitude = match usize::try_from(exponent) {
            // measured values: all of their digits are on the grid
            Ok(power) => self.digits.checked_mul(scale.factor.checked_mul(*POWERS_OF_TEN.get(power)?)?),
            Err(_) => u64::try_from(self.rounded(scale.factor, exponent.unsigned_abs())).ok(),
        };
        let magnitude = i64::try_from(magnitude?).ok()?;
        Some(if self.negative { -magnitude } else { magnitude })
    }

    /// `digits · factor / 10^places`, halves rounded up.
    #[cold]
    #[inline(never)]
    fn rounded(self, factor: u64, places: u32) -> u128 {
        let product = u128::from(self.digits) * u128::from(factor);
        // beyond 10^38 it is less than half a step
        let Some(power) = 10u128.checked_pow(places) else { return 0 };
        product / power + u128::from(product % power >= power.div_ceil(2))
    }
}

/// Numbers as files store them.
#[cfg(feature = "table")]
impl Decimal {
    /// The shortest decimal of a double, which reads back as it; `None` if it is not finite.
    pub(crate) fn of_f64(value: f64) -> Option<Self> {
        Self::of_double(value).map(Self::without_zeros)
    }

    /// As [`of_f64`](Self::of_f64), but the digits may end in zeros.
    #[inline]
    pub(crate) fn of_double(value: f64) -> Option<Self> {
        const MILLIONTH: i32 = -6;
        let (millionths, is_shortest) = millionths(value);
        if is_shortest {
            return Some(Self { negative: millionths < 0, digits: millionths.unsigned_abs(), exponent: MILLIONTH });
        }
        Self::of_display(format_args!("{value:e}"))
    }

    /// The shortest decimal of a single-precision number, which reads back as it; `None` if it is not finite.
    pub(crate) fn of_f32(value: f32) -> Option<Self> {
        Self::of_display(format_args!("{value:e}"))
    }

    /// `unscaled · 10^-scale`.
    pub(crate) fn of_i64(unscaled: i64, scale: i32) -> Self {
        Self { negative: unscaled < 0, digits: unscaled.unsigned_abs(), exponent: -scale }
    }

    /// `unscaled · 10^-scale`; digits after the 19th are cut off.
    pub(crate) fn of_i128(unscaled: i128, scale: i32) -> Self {
        let mut magnitude = unscaled.unsigned_abs();
        let mut exponent = -scale;
        let digits = loop {
            match u64::try_from(magnitude) {
                Ok(digits) => break digits,
                Err(_) => magnitude /= 10,
            }
            exponent += 1;
        };
        Self { negative: unscaled < 0, digits, exponent }
    }

    /// A number in scientific notation; `None` if the text is no number.
    fn of_display(number: std::fmt::Arguments<'_>) -> Option<Self> {
        let mut text = ShortText { bytes: [0; 32], length: 0 };
        std::fmt::Write::write_fmt(&mut text, number).ok()?;
        Self::parse(std::str::from_utf8(&text.bytes[..text.length]).ok()?).ok()
    }

    /// The same number without zeros at the end of its digits.
    fn without_zeros(mut self) -> Self {
        while self.exponent < 0 && self.digits.is_multiple_of(10) {
            self.digits /= 10;
            self.exponent += 1;
        }
        self
    }
}

/// The whole number of millionths nearest to a double, and whether it is the double's shortest decimal. It has no branch, so
/// that the machine computes several doubles at once.
#[cfg(feature = "table")]
#[inline]
pub(super) fn millionths(value: f64) -> (i64, bool) {
    const MILLION: f64 = 1e6;
    // different decimals of 15 digits are different doubles, so one that reads as this double is its shortest decimal
    const OF_15_DIGITS: f64 = 999_999_999_999_999.0;
    // 1.5 · 2^52: the last bit of a double as large counts ones, so that adding it rounds to a whole number
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    let rounded = value * MILLION + WHOLE;
    let millionths = rounded - WHOLE;
    // if the nearest number of millionths does not read as this double, none does
    let is_shortest = (millionths / MILLION == value) & (millionths.abs() <= OF_15_DIGITS);
    (rounded.to_bits().wrapping_sub(WHOLE.to_bits()).cast_signed(), is_shortest)
}

/// A short text on the stack, for millions of numbers.
#[cfg(feature = "table")]
struct ShortText {
    bytes: [u8; 32],
    length: usize,
}

#[cfg(feature = "table")]
impl std::fmt::Write for ShortText {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        let end = self.length + text.len();
        self.bytes.get_mut(self.length..end).ok_or(std::fmt::Error)?.copy_from_slice(text.as_bytes());
        self.length = end;
        Ok(())
    }
}

/// The exponent behind an `e`; one beyond `BEYOND` is cut to it, because no number is as large.
fn power_of_ten(written: &str) -> Result<i32, NumberError> {
    const BEYOND: i32 = 1_000_000_000;
    let unsigned = written.strip_prefix(['+', '-']).unwrap_or(written);
    if unsigned.is_empty() || !unsigned.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(NumberError::NotANumber);
    }
    let beyond = if written.starts_with('-') { -BEYOND } else { BEYOND };
    Ok(written.parse().map_or(beyond, |exponent: i32| exponent.clamp(-BEYOND, BEYOND)))
}

/// Reads a number that is neither length nor angle: a weight, a stiffness, a count.
#[cfg(any(feature = "table", test))]
pub(crate) fn parse_f64(text: &str) -> Result<f64, NumberError> {
    Decimal::parse(text)?;
    let value: f64 = text.replace('\u{2212}', "-").parse().map_err(|_| NumberError::NotANumber)?;
    if value.is_finite() { Ok(value) } else { Err(NumberError::TooLarge) }
}

/// Splits `text` into its leading number and what follows, both trimmed.
pub(crate) fn split_number(text: &str) -> (&str, &str) {
    let text = text.trim();
    let mut end = 0;
    let mut characters = text.char_indices().peekable();
    let mut previous = ' ';
    while let Some((index, c)) = characters.next() {
        let sign_allowed = index == 0 || matches!(previous, 'e' | 'E');
        let exponent = matches!(c, 'e' | 'E')
            && previous.is_ascii_digit()
            && characters.peek().is_some_and(|(_, next)| next.is_ascii_digit() || matches!(next, '+' | '-'));
        let part = c.is_ascii_digit()
            || matches!(c, '.' | '_' | ',')
            || (sign_allowed && matches!(c, '+' | '-' | '\u{2212}'))
            || exponent;
        if !part {
            break;
        }
        end = index + c.len_utf8();
        previous = c;
    }
    (text[..end].trim(), text[end..].trim())
}

/// Half of one in the last digit of a quantity as written, with its unit: the largest rounding error of these digits.
/// `None` for a whole number, which counts as exact.
#[cfg(feature = "spec")]
pub(super) fn half_digit(text: &str) -> Option<(Decimal, &str)> {
    let is_part = |c: char| c.is_ascii_digit() || ".,_eE+-\u{2212}".contains(c);
    let text = text.trim();
    let end = text.rfind(|c: char| c.is_ascii_digit())? + 1;
    // the last part: the seconds of 19° 31' 42"
    let start = text[..end].char_indices().rev().take_while(|(_, c)| is_part(*c)).last()?.0;
    let (written, unit) = split_number(&text[start..]);
    let exponent = Decimal::parse(written).ok()?.exponent;
    let half = Decimal { negative: false, digits: 5, exponent: exponent.saturating_sub(1) };
    (start > 0 || exponent < 0).then_some((half, unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MM: Scale = Scale { factor: 1, exponent: 12 };

    fn femtometres(text: &str) -> Option<i64> {
        Decimal::parse(text).expect(text).steps(MM)
    }

    #[test]
    fn decimal_text_is_read_to_the_nearest_step() {
        for (text, steps) in [
            ("25.0131", 25_013_100_000_000),
            ("-0.5e1", -5_000_000_000_000),
            ("+1000.0", 1_000_000_000_000_000),
            ("\u{2212}.25", -250_000_000_000),
            ("7.", 7_000_000_000_000),
            ("0e999999999999999999999", 0),
            // 25.0131 and 25.0131 - 25 as a spreadsheet writes them
            ("25.013100000000001", 25_013_100_000_000),
            ("1.31000000000014E-02", 13_100_000_000),
            ("0.0000000000005", 1),
            ("-0.0000000000005", -1),
            ("0.000000000000499999999999999999999999", 0),
            ("1e-99999999999999999999", 0),
            ("0.00000000000000000000000000000000000000000000000000025e51", 250_000_000_000),
            ("9223372.036854775807", i64::MAX),
        ] {
            assert_eq!(femtometres(text), Some(steps), "{text}");
        }
        for beyond in ["9223372.036854775808", "1e309", "-1e99999999999999999999", &"1".repeat(2000)] {
            assert_eq!(femtometres(beyond), None, "{beyond}");
        }
    }

    #[test]
    fn what_is_no_number_says_why() {
        for (text, error) in [
            ("1_000", NumberError::NotANumber),
            ("", NumberError::Empty),
            ("-", NumberError::Empty),
            (".", NumberError::NotANumber),
            ("0,4", NumberError::Comma),
            ("1.2.3", NumberError::NotANumber),
            ("1e", NumberError::NotANumber),
            ("1e+-3", NumberError::NotANumber),
            ("0x10", NumberError::NotANumber),
            ("nan", NumberError::NotFinite),
            ("-inf", NumberError::NotFinite),
        ] {
            assert_eq!(Decimal::parse(text), Err(error), "{text}");
        }
        assert_eq!(parse_f64("1e309"), Err(NumberError::TooLarge));
        assert_eq!(parse_f64("\u{2212}0.1"), Ok(-0.1));
    }

    #[cfg(feature = "table")]
    #[test]
    fn binary_numbers_become_their_shortest_decimal() {
        let decimal = |negative, digits, exponent| Some(Decimal { negative, digits, exponent });
        for (value, expected) in [
            (0.0, decimal(false, 0, 0)),
            (-0.0, decimal(false, 0, 0)),
            (25.0131, decimal(false, 250_131, -4)),
            (-100.0, decimal(true, 100, 0)),
            (0.1 + 0.2, decimal(false, 30_000_000_000_000_004, -17)),
            (1.31e-9, decimal(false, 131, -11)),
            (999_999_999.999_999, decimal(false, 999_999_999_999_999, -6)),
            (1e17, decimal(false, 1, 17)),
            (f64::MAX, decimal(false, 17_976_931_348_623_157, 292)),
            (-5e-324, decimal(true, 5, -324)),
            (f64::NAN, None),
            (f64::NEG_INFINITY, None),
        ] {
            assert_eq!(Decimal::of_f64(value), expected, "{value}");
        }
        assert_eq!(Decimal::of_f32(25.0131), decimal(false, 250_131, -4));
        assert_eq!(Decimal::of_f32(-0.1), decimal(true, 1, -1));
        assert_eq!(Decimal::of_f32(f32::INFINITY), None);
        assert_eq!(Some(Decimal::of_i128(-250_131, 4)), decimal(true, 250_131, -4));
        assert_eq!(Some(Decimal::of_i128(i128::MIN, 38)), decimal(true, 17_014_118_346_046_923_173, -19));
    }

    #[cfg(feature = "table")]
    proptest::proptest! {
        #[test]
        fn every_double_is_read_as_it_is_displayed(steps in -1_000_000_000_000_000_000i64..1_000_000_000_000_000_000, places in 0i32..18, any in proptest::num::f64::NORMAL) {
            let rounded: f64 = format!("{steps}e-{places}").parse().expect("a number");
            for value in [rounded, any] {
                let number = Decimal::of_f64(value).expect("finite");
                let sign = if number.negative { "-" } else { "" };
                let text = format!("{sign}{}e{}", number.digits, number.exponent);
                assert_eq!(text.parse(), Ok(value), "{text}");
                let shortest = Decimal::parse(&format!("{value:e}")).expect("a number");
                let significant = |mut digits: u64| {
                    while digits > 0 && digits.is_multiple_of(10) {
                        digits /= 10;
                    }
                    digits
                };
                assert_eq!(significant(number.digits), significant(shortest.digits), "{value:e}");
            }
        }
    }
}
