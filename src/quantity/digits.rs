//! Plain numbers among the bytes of a table: digits and a decimal mark. The reader of decimal text and the readers of tables call it,
//! for every cell that holds a measured value.

#[cfg(feature = "table")]
use super::LARGEST;
#[cfg(feature = "table")]
use super::number::Scale;
use super::number::{Decimal, MOST_DIGITS};

impl Decimal {
    /// The plain number that starts at `at`, the fast case of [`parse`](Self::parse): sign, digits, decimal mark,
    /// digits, at most 18 in all. Returns it with the place behind it.
    pub(crate) fn plain(bytes: &[u8], at: usize, mark: u8) -> Option<(Self, usize)> {
        Self::short(bytes, at, mark).or_else(|| long(bytes, at, mark))
    }

    /// A [plain](Self::plain) number of at most seven characters, as most measured values have, all of which are read at once; `None`
    /// for any other text.
    // kept in registers: a tenth of the time of a table
    #[inline(always)]
    pub(crate) fn short(bytes: &[u8], at: usize, mark: u8) -> Option<(Self, usize)> {
        const EACH: u64 = 0x0101_0101_0101_0101;
        let text = u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?);
        let negative = text as u8 == b'-';
        let sign = u32::from(negative) * u8::BITS;
        // each digit becomes its value, and a sign a digit 0; the highest bit of a byte says that neither stands there
        let digits = text ^ (EACH * 0x30);
        let others = (((digits & (EACH * 0x7f)) + EACH * 0x76) | digits) & (EACH * 0x80) & !(u64::from(sign) << 4);
        let digits = digits >> sign << sign;
        // bits before the first such byte
        let before = |others: u64| (others != 0).then(|| others.trailing_zeros() - 7);
        let whole = before(others)?;
        let (digits, decimals) = if (text >> whole) as u8 == mark {
            let (end, is_whole) = (before(others & (others - 1))?, (1 << whole) - 1);
            ((digits & is_whole) | (digits >> 8 & !is_whole), Some(end - whole - 8))
        } else {
            (digits, None)
        };
        let count = whole + decimals.unwrap_or(0);
        if count == sign || decimals == Some(0) {
            return None;
        }
        // zeros before the first digit; then pairs, fours and eights of digits
        let ones = digits << (u64::BITS - count);
        let pairs = (ones * 10 + (ones >> 8)) & 0x00ff_00ff_00ff_00ff;
        let fours = (pairs * 100 + (pairs >> 16)) & 0x0000_ffff_0000_ffff;
        let digits = (fours * 10_000 + (fours >> 32)) & 0xffff_ffff;
        let exponent = -(decimals.unwrap_or(0) as i32 / 8);
        let end = at + count as usize / 8 + usize::from(decimals.is_some());
        Some((Self { negative, digits, exponent }, end))
    }
}

/// A plain number of at most 18 digits, read digit by digit. One that ends in its mark is left to [`Decimal::parse`].
#[inline(never)]
fn long(bytes: &[u8], at: usize, mark: u8) -> Option<(Decimal, usize)> {
    let negative = *bytes.get(at)? == b'-';
    let start = at + usize::from(negative);
    let (mut digits, point) = leading(bytes, start, 0);
    let (whole, mut end, mut decimals) = (point - start, point, 0);
    if bytes.get(point) == Some(&mark) {
        (digits, end) = leading(bytes, point + 1, digits);
        decimals = end - point - 1;
    }
    let is_number = (1..MOST_DIGITS).contains(&(whole + decimals)) && end != point + 1;
    is_number.then_some((Decimal { negative, digits, exponent: -(decimals as i32) }, end))
}

/// Appends the digits that start at `at` to `digits`, and returns them with the place behind; wraps beyond 19 digits.
#[inline]
fn leading(bytes: &[u8], mut at: usize, mut digits: u64) -> (u64, usize) {
    while let Some(byte) = bytes.get(at) {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        digits = digits.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    (digits, at)
}

/// The plain numbers of a column as steps of a grid, less a nominal value: what does not depend on the number, worked out once.
#[cfg(feature = "table")]
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlainSteps {
    /// By the number of decimals, the steps of one in the last of them, and the most digits that the grid holds.
    each: [(i64, u64); Self::DECIMALS],
    nominal: i64,
    farthest: u64,
}

#[cfg(feature = "table")]
impl PlainSteps {
    /// More than the decimals that are read at once.
    const DECIMALS: usize = 8;

    /// Numbers of this scale, less `nominal` and up to `farthest` in steps.
    pub(crate) fn new(scale: Scale, nominal: i64, farthest: i64) -> Self {
        // without whole steps only 0 is on the grid
        let each = std::array::from_fn(|decimals| match scale.of_decimal(decimals as i32) {
            Some(steps) => (steps, (LARGEST / steps).unsigned_abs()),
            None => (0, 0),
        });
        Self { each, nominal, farthest: farthest.unsigned_abs() }
    }

    /// The steps of a number less the nominal value; `None` if it needs a closer look.
    #[inline]
    pub(crate) fn of(&self, number: Decimal) -> Option<i64> {
        let (steps, most) = *self.each.get(number.exponent.wrapping_neg() as usize)?;
        if number.digits > most {
            return None;
        }
        let magnitude = number.digits as i64 * steps;
        let less = if number.negative { -magnitude } else { magnitude } - self.nominal;
        (less.unsigned_abs() <= self.farthest).then_some(less)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn plain_numbers_are_found_and_others_left_alone() {
        let decimal = |negative, digits, exponent| Decimal { negative, digits, exponent };
        let plain = |text: &[u8], at| Decimal::plain(text, at, b'.');
        assert_eq!(plain(b"x-25.0131,", 1), Some((decimal(true, 250_131, -4), 9)));
        assert_eq!(plain(b"7", 0), Some((decimal(false, 7, 0), 1)));
        assert_eq!(plain(b".5,", 0), Some((decimal(false, 5, -1), 2)));
        for text in [&b""[..], b"-", b".", b"-.", b",", b" 1", b"+1", b"7.\n", b"abc", b"1234567890123456789"] {
            assert_eq!(plain(text, 0), None, "{text:?}");
        }
        // these are more than a plain number: the place behind it is not the end
        assert_eq!(plain(b"1e3", 0).map(|(_, end)| end), Some(1));
        assert_eq!(plain(b"12 um", 0).map(|(_, end)| end), Some(2));
    }

    #[test]
    fn numbers_that_are_read_at_once() {
        for (text, number, end) in [
            (&b"25.0131,"[..], (false, 250_131, -4), 7),
            (b"-0.0107,", (true, 107, -4), 7),
            (b"7\n-12345", (false, 7, 0), 1),
            (b"-.5,,,,,", (true, 5, -1), 3),
            (b"1234567\r", (false, 1_234_567, 0), 7),
        ] {
            let (negative, digits, exponent) = number;
            assert_eq!(Decimal::short(text, 0, b'.'), Some((Decimal { negative, digits, exponent }, end)), "{text:?}");
        }
        for text in [
            &b"12345678"[..],
            b"25.01312,",
            b"25.0131",
            b"7.,     ",
            b",1234567",
            b"\xb00,,,,,,",
            b"-,,,,,,,",
            b"-.,,,,,,",
        ] {
            assert_eq!(Decimal::short(text, 0, b'.'), None, "{text:?}");
        }
    }

    proptest! {
        #[cfg(feature = "table")]
        #[test]
        fn steps_that_are_worked_out_once(digits in 0u64..100_000_000, negative: bool, decimals in 0i32..10, exponent in 0i32..16, nominal: i32) {
            let (scale, number) = (Scale { factor: 254, exponent }, Decimal { negative, digits, exponent: -decimals });
            let farthest = LARGEST / 1000;
            let one_by_one = number.steps(scale).filter(|steps| steps.abs() <= LARGEST).map(|steps| steps - i64::from(nominal));
            let one_by_one = one_by_one.filter(|steps| steps.abs() <= farthest);
            if let Some(steps) = PlainSteps::new(scale, nominal.into(), farthest).of(number) {
                prop_assert_eq!(Some(steps), one_by_one);
            } else {
                prop_assert!(one_by_one.is_none() || decimals > 7.min(exponent));
            }
        }

        #[test]
        fn a_number_is_read_at_once_as_digit_by_digit(text in "-?-?[0-9]{0,6}[.,0-9]{0,3}[0-9]{0,3}\\PC{0,8}", mark in "[.,\0]") {
            let (bytes, mark) = (text.as_bytes(), mark.as_bytes()[0]);
            for start in 0..=bytes.len() {
                if let Some(short) = Decimal::short(bytes, start, mark) {
                    prop_assert_eq!(Some(short), long(bytes, start, mark));
                }
            }
        }
    }
}
