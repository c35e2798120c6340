//! Exact rational numbers: the arithmetic under [`Length`](super::Length) and
//! [`Angle`](super::Angle).

use std::cmp::Ordering;
use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::LazyLock;

use dashu_base::{Abs, BitTest, CubicRoot, Signed, SquareRoot, UnsignedAbs};
use dashu_int::{IBig, UBig};
use dashu_ratio::Relaxed;

use super::NumberError;

/// An exact rational number.
///
/// Decimal text and every finite `f64` are rational numbers, and so are their sums, differences,
/// products and quotients; nothing is lost until [`to_f64`](Self::to_f64) rounds once.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Rational(Relaxed);

/// Decimal exponents beyond these are refused when text is read: such a number is no `f64`.
const LARGEST_DECIMAL_EXPONENT: i64 = 308;
const SMALLEST_DECIMAL_EXPONENT: i64 = -324;
/// The longest exact decimal expansion of an `f64` has 767 significant digits.
const LONGEST_NUMBER: usize = 1100;

impl Rational {
    /// 0.
    pub const ZERO: Self = Self(Relaxed::ZERO);
    /// 1.
    pub const ONE: Self = Self(Relaxed::ONE);

    /// The whole number `n`.
    #[must_use]
    pub fn integer(n: i64) -> Self {
        Self(Relaxed::from(n))
    }

    /// The fraction `numerator / denominator`.
    ///
    /// # Panics
    /// If `denominator` is 0: fractions are written in the source code, never read.
    #[must_use]
    pub fn fraction(numerator: i64, denominator: u64) -> Self {
        assert!(denominator != 0, "a fraction's denominator is not 0");
        Self(Relaxed::from_parts(IBig::from(numerator), UBig::from(denominator)))
    }

    /// π with 100 decimals.
    #[must_use]
    pub fn pi() -> &'static Self {
        static PI: LazyLock<Rational> = LazyLock::new(|| {
            const DIGITS: &str = "3141592653589793238462643383279502884197169399375105820974944592307\
                                  8164062862089986280348253421170679";
            let digits = DIGITS.bytes().fold(UBig::ZERO, |digits, byte| digits * 10u8 + (byte - b'0'));
            Rational::from_parts(digits.into(), UBig::from(10u8).pow(DIGITS.len() - 1))
        });
        &PI
    }

    pub(crate) fn from_parts(numerator: IBig, denominator: UBig) -> Self {
        Self(Relaxed::from_parts(numerator, denominator))
    }

    /// Ten to the power `exponent`.
    #[must_use]
    pub(crate) fn power_of_ten(exponent: i64) -> Self {
        let power = UBig::from(10u8).pow(usize::try_from(exponent.unsigned_abs()).unwrap_or(usize::MAX));
        if exponent < 0 { Self::from_parts(IBig::ONE, power) } else { Self(Relaxed::from(power)) }
    }

    /// Reads a decimal number, exactly: `25.0131`, `-3`, `+1.5e-3`, `1_000` (an underscore stands between two digits).
    ///
    /// # Errors
    /// [`NumberError`] if the text is not a decimal number, or is too large or too small for an `f64`.
    pub fn parse_decimal(text: &str) -> Result<Self, NumberError> {
        if text.len() > LONGEST_NUMBER {
            return Err(NumberError::TooLong);
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
        let digits: String = whole.chars().chain(fraction.chars()).filter(|c| *c != '_').collect();
        if digits.is_empty()
            || !groups_digits(whole)
            || !groups_digits(fraction)
            || !digits.bytes().all(|b| b.is_ascii_digit())
        {
            return Err(match text.to_ascii_lowercase().trim_start_matches(['+', '-']) {
                "" => NumberError::Empty,
                "inf" | "infinity" | "nan" => NumberError::NotFinite,
                _ if rest.contains(',') => NumberError::Comma,
                _ => NumberError::NotANumber,
            });
        }
        let exponent: i64 = match exponent {
            None => 0,
            Some(written) => {
                let unsigned = written.strip_prefix(['+', '-']).unwrap_or(written);
                if unsigned.is_empty() || !unsigned.bytes().all(|b| b.is_ascii_digit()) {
                    return Err(NumberError::NotANumber);
                }
                // An exponent too long for an integer is out of range just the same.
                written.parse().unwrap_or(if written.starts_with('-') { i64::MIN / 2 } else { i64::MAX / 2 })
            }
        };
        let significant = digits.trim_start_matches('0');
        if significant.is_empty() {
            return Ok(Self::ZERO);
        }
        let fraction_digits = fraction.bytes().filter(u8::is_ascii_digit).count();
        let last_place = exponent - i64::try_from(fraction_digits).unwrap_or(i64::MAX / 4);
        let first_place = last_place + i64::try_from(significant.len()).unwrap_or(i64::MAX / 4) - 1;
        if first_place > LARGEST_DECIMAL_EXPONENT {
            return Err(NumberError::TooLarge);
        }
        if first_place < SMALLEST_DECIMAL_EXPONENT {
            return Err(NumberError::TooSmall);
        }
        let magnitude: UBig = significant.parse().map_err(|_| NumberError::NotANumber)?;
        let value = &Self(Relaxed::from(magnitude)) * &Self::power_of_ten(last_place);
        Ok(if negative { -&value } else { value })
    }

    /// The decimal number that a person wrote to get this `f64`: the shortest that reads back as it.
    /// `None` if it is not finite.
    #[must_use]
    pub fn from_shortest_decimal(value: f64) -> Option<Self> {
        value.is_finite().then(|| Self::parse_decimal(&format!("{value:e}")).ok())?
    }

    /// The nearest `f64`, ties to even; infinite beyond its range.
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        self.0.to_f64().value()
    }

    /// The `f64` furthest from zero whose shortest decimal does not exceed this number in magnitude:
    /// what to print of a bound that must still hold when the printed text is read again.
    #[must_use]
    pub fn to_f64_toward_zero(&self) -> f64 {
        let mut value = self.to_f64();
        if value.is_infinite() {
            value = f64::MAX.copysign(value);
        }
        // The nearest f64 lies half a unit away at most and its shortest decimal within another half.
        for _ in 0..2 {
            match Self::from_shortest_decimal(value) {
                Some(read) if read.abs() > self.abs() => {
                    value = if value > 0.0 { value.next_down() } else { value.next_up() };
                }
                _ => break,
            }
        }
        value
    }

    /// The magnitude.
    #[must_use]
    pub fn abs(&self) -> Self {
        Self(self.0.clone().abs())
    }

    /// Whether the number is 0.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.0.is_zero()
    }

    /// Whether the number is below 0.
    #[must_use]
    pub fn is_negative(&self) -> bool {
        self.0.is_negative()
    }

    /// The number's square.
    #[must_use]
    pub fn square(&self) -> Self {
        self * self
    }

    /// 2^`power` times the number, rounded towards zero to a whole number.
    pub(crate) fn to_fixed_point(&self, power: usize) -> IBig {
        (self.0.numerator() << power) / IBig::from(self.0.denominator().clone())
    }

    /// The square root, to a relative error below 2⁻²⁵⁵; `None` for a negative number.
    ///
    /// A root that is rational comes out exactly.
    #[must_use]
    pub fn sqrt(&self) -> Option<Self> {
        if self.is_negative() {
            return None;
        }
        let (numerator, denominator) = self.0.clone().into_parts();
        // √(n/d) = √(n d 4^shift) / (d 2^shift), with a radicand of at least 512 bits
        let radicand = numerator.unsigned_abs() * &denominator;
        let shift = 256usize.saturating_sub(radicand.bit_len() / 2);
        let root = (radicand << (2 * shift)).sqrt();
        Some(Self::from_parts(root.into(), denominator << shift))
    }

    /// The cube root, to a relative error below 2⁻²⁵⁵. A root that is rational comes out exactly.
    #[must_use]
    pub fn cbrt(&self) -> Self {
        let (numerator, denominator) = self.0.clone().into_parts();
        let negative = numerator.is_negative();
        // ∛(n/d) = ∛(n d² 8^shift) / (d 2^shift), with a radicand of at least 768 bits
        let radicand = numerator.unsigned_abs() * &denominator * &denominator;
        let shift = 256usize.saturating_sub(radicand.bit_len() / 3);
        let root = (radicand << (3 * shift)).cbrt();
        let root = Self::from_parts(root.into(), denominator << shift);
        if negative { -&root } else { root }
    }

    /// The nearest multiple of `step`, half away from zero.
    #[must_use]
    pub(crate) fn round_to_multiple_of(&self, step: &Self) -> Self {
        &Self(Relaxed::from((self / step).0.round())) * step
    }

    /// The number with so many decimals, rounded half away from zero; zero has no sign.
    #[must_use]
    pub fn to_decimal_text(&self, decimals: u16) -> String {
        let scaled: IBig = (self * &Self::power_of_ten(i64::from(decimals))).0.round();
        let sign = if scaled.is_negative() { "-" } else { "" };
        let digits = scaled.unsigned_abs().to_string();
        let decimals = usize::from(decimals);
        let digits = format!("{digits:0>width$}", width = decimals + 1);
        let (whole, fraction) = digits.split_at(digits.len() - decimals);
        if decimals == 0 { format!("{sign}{whole}") } else { format!("{sign}{whole}.{fraction}") }
    }

    /// The number rounded to `digits` significant decimal digits, half away from zero.
    #[must_use]
    pub fn round_significant(&self, digits: u16) -> Self {
        if self.is_zero() {
            return Self::ZERO;
        }
        let bits = |n: usize| i64::try_from(n).unwrap_or(i64::MAX / 4);
        let binary_exponent = bits(self.0.numerator().bit_len()) - bits(self.0.denominator().bit_len());
        // |x| lies in (2^(b-1), 2^(b+1)); log10 2 is close to 30103/100000
        let mut place = (binary_exponent - 1) * 30_103 / 100_000 - 1;
        let ten = Self::integer(10);
        let mut leading = &self.abs() / &Self::power_of_ten(place);
        while leading >= ten {
            leading = &leading / &ten;
            place += 1;
        }
        let last_place = place + 1 - i64::from(digits);
        let scaled = self / &Self::power_of_ten(last_place);
        &Self(Relaxed::from(scaled.0.round())) * &Self::power_of_ten(last_place)
    }
}

impl Add for &Rational {
    type Output = Rational;
    fn add(self, other: Self) -> Rational {
        Rational(&self.0 + &other.0)
    }
}

impl Sub for &Rational {
    type Output = Rational;
    fn sub(self, other: Self) -> Rational {
        Rational(&self.0 - &other.0)
    }
}

impl Mul for &Rational {
    type Output = Rational;
    fn mul(self, other: Self) -> Rational {
        Rational(&self.0 * &other.0)
    }
}

/// # Panics
/// If the divisor is 0, as integer division does.
impl Div for &Rational {
    type Output = Rational;
    fn div(self, other: Self) -> Rational {
        Rational(&self.0 / &other.0)
    }
}

impl Neg for &Rational {
    type Output = Rational;
    fn neg(self) -> Rational {
        Rational(-self.0.clone())
    }
}

impl PartialEq<i64> for Rational {
    fn eq(&self, other: &i64) -> bool {
        *self == Self::integer(*other)
    }
}

impl PartialOrd<i64> for Rational {
    fn partial_cmp(&self, other: &i64) -> Option<Ordering> {
        self.partial_cmp(&Self::integer(*other))
    }
}

impl fmt::Debug for Rational {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// Whether each underscore stands between two digits.
fn groups_digits(digits: &str) -> bool {
    !digits.contains('_') || digits.split('_').all(|group| !group.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Rational {
        Rational::parse_decimal(text).expect(text)
    }

    #[test]
    fn decimal_text_is_read_exactly() {
        assert_eq!(read("25.0131"), Rational::fraction(250_131, 10_000));
        assert_eq!(read("-0.5e1"), Rational::integer(-5));
        assert_eq!(read("+1_000.0"), Rational::integer(1000));
        assert_eq!(read("\u{2212}.25"), Rational::fraction(-1, 4));
        assert_eq!(read("7."), Rational::integer(7));
        assert_eq!(read("0e999999999999999999999"), Rational::ZERO);
    }

    #[test]
    fn what_is_no_number_says_why() {
        for (text, error) in [
            ("1_", NumberError::NotANumber),
            ("_1", NumberError::NotANumber),
            ("1__0", NumberError::NotANumber),
            ("25_.013", NumberError::NotANumber),
            ("25._013", NumberError::NotANumber),
            ("", NumberError::Empty),
            ("-", NumberError::Empty),
            ("0,4", NumberError::Comma),
            ("1.2.3", NumberError::NotANumber),
            ("1e", NumberError::NotANumber),
            ("1e+-3", NumberError::NotANumber),
            ("0x10", NumberError::NotANumber),
            ("nan", NumberError::NotFinite),
            ("-inf", NumberError::NotFinite),
            ("1e309", NumberError::TooLarge),
            ("1e99999999999999999999", NumberError::TooLarge),
            ("1e-325", NumberError::TooSmall),
            ("1e-99999999999999999999", NumberError::TooSmall),
            (&"1".repeat(2000), NumberError::TooLong),
        ] {
            assert_eq!(Rational::parse_decimal(text), Err(error), "{text}");
        }
    }

    #[test]
    fn rounding_to_significant_digits() {
        for (text, digits, rounded) in [
            ("123456", 3, "123000"),
            ("0.00099995", 4, "0.001"),
            ("-9.99", 2, "-10"),
            ("1e-300", 40, "1e-300"),
            ("9.99e307", 2, "1e308"),
            ("0", 5, "0"),
        ] {
            assert_eq!(read(text).round_significant(digits), read(rounded), "{text}");
        }
        let third = Rational::fraction(1, 3).round_significant(40);
        assert_eq!(third, read(&format!("0.{}", "3".repeat(40))));
    }

    #[test]
    fn decimal_text_is_rounded_half_away_from_zero() {
        for (text, decimals, written) in [
            ("0.0131", 6, "0.013100"),
            ("-0.0000005", 6, "-0.000001"),
            ("-0.0000004", 6, "0.000000"),
            ("12.5", 0, "13"),
            ("-1e3", 2, "-1000.00"),
        ] {
            assert_eq!(read(text).to_decimal_text(decimals), written, "{text}");
        }
    }

    #[test]
    fn square_roots() {
        assert_eq!(read("0.0025").sqrt(), Some(read("0.05")));
        assert_eq!(read("2").sqrt().unwrap().to_f64(), std::f64::consts::SQRT_2);
        assert_eq!(read("4e-300").sqrt(), Some(read("2e-150")));
        assert_eq!(Rational::ZERO.sqrt(), Some(Rational::ZERO));
        assert_eq!(read("-1").sqrt(), None);
    }

    #[test]
    fn cube_roots() {
        assert_eq!(read("0.027").cbrt(), read("0.3"));
        assert_eq!(read("-8").cbrt(), read("-2"));
        assert_eq!(Rational::ZERO.cbrt(), Rational::ZERO);
        let root = read("2").cbrt();
        let error = &(&(&root * &root) * &root) - &read("2");
        assert!(error.abs() < read("1e-75"));
        assert_eq!(read("1e-300").cbrt(), read("1e-100"));
    }

    #[test]
    fn a_bound_printed_and_read_again_still_holds() {
        for text in ["0.1", "0.30000000000000001", "-0.69999999999999999", "1e-320", "0"] {
            let bound = read(text);
            let printed = bound.to_f64_toward_zero();
            let again = Rational::from_shortest_decimal(printed).unwrap();
            assert!(again.abs() <= bound.abs(), "{text} -> {printed}");
            assert!((printed - bound.to_f64()).abs() <= 2.0 * f64::EPSILON * bound.to_f64().abs(), "{text}");
        }
    }
}
