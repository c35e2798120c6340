//! Lengths as the text of a row: what a batch writes most. Called by the evaluator.

use crate::quantity::Length;

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

impl Decimals {
    /// The double that a length reads as when it is written.
    pub(super) fn value(self, length: Length) -> f64 {
        match self {
            Self::Places(places) if places < 12 => {
                let cut = 10i64.pow(12 - u32::from(places));
                let rounded = (length.fm().abs() + cut / 2) / cut * cut;
                Length::from_fm(if length.is_negative() { -rounded } else { rounded }).mm()
            }
            _ => length.mm(),
        }
    }

    /// A number that is no length of the grid: an uncertainty in mm, a probability.
    pub(super) fn text(self, value: f64) -> String {
        match (self, Length::from_mm(value)) {
            (Self::Places(places), Ok(length)) => length.to_decimal_text(places.into()),
            _ => crate::quantity::plain(value),
        }
    }
}

impl Default for Decimals {
    /// A nanometre.
    fn default() -> Self {
        Self::Places(6)
    }
}

/// A text that says no number of decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("write a whole number up to {}, or `full`", Decimals::MOST)]
pub struct NoDecimals;

impl std::str::FromStr for Decimals {
    type Err = NoDecimals;

    fn from_str(text: &str) -> Result<Self, NoDecimals> {
        match text.parse() {
            _ if text == "full" => Ok(Self::Full),
            Ok(places) if places <= Self::MOST => Ok(Self::Places(places)),
            _ => Err(NoDecimals),
        }
    }
}

/// Writes lengths in mm with a number of decimals.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    write: fn(&mut Vec<u8>, Length),
    /// Decimals that the grid does not have.
    zeros: u8,
}

impl Places {
    pub(super) fn new(count: u8) -> Self {
        /// By the number of decimals, so that each divides by constants.
        const WRITERS: [fn(&mut Vec<u8>, Length); 13] = [
            write::<0>,
            write::<1>,
            write::<2>,
            write::<3>,
            write::<4>,
            write::<5>,
            write::<6>,
            write::<7>,
            write::<8>,
            write::<9>,
            write::<10>,
            write::<11>,
            write::<12>,
        ];
        let kept = count.min(12);
        Self { write: WRITERS[usize::from(kept)], zeros: count - kept }
    }

    /// Writes the length rounded half away from zero.
    #[inline]
    pub(super) fn write(self, out: &mut Vec<u8>, length: Length) {
        (self.write)(out, length);
        out.resize(out.len() + usize::from(self.zeros), b'0');
    }
}

fn write<const DECIMALS: u32>(out: &mut Vec<u8>, length: Length) {
    let (cut, one) = (10u64.pow(12 - DECIMALS), 10u64.pow(DECIMALS));
    let rounded = (length.fm().unsigned_abs() + cut / 2) / cut;
    if length.is_negative() && rounded > 0 {
        out.push(b'-');
    }
    whole(out, rounded / one);
    if DECIMALS == 0 {
        return;
    }
    out.push(b'.');
    // twelve digits, of which the first are kept
    let decimals = rounded % one * cut;
    let (first, last) = ((decimals / 10_000) as u32, (decimals % 10_000 * 10_000) as u32);
    leading_digits(out, eight_digits(first), DECIMALS.min(8) as usize);
    if DECIMALS > 8 {
        leading_digits(out, eight_digits(last), DECIMALS as usize - 8);
    }
}

/// The first `count` of eight digits: room for all of them, so that the copy has a constant length.
#[inline]
fn leading_digits(out: &mut Vec<u8>, digits: [u8; 8], count: usize) {
    let end = out.len() + count;
    out.extend_from_slice(&digits);
    out.truncate(end);
}

/// A whole number.
#[inline]
fn whole(out: &mut Vec<u8>, number: u64) {
    if number < 10 {
        out.push(b'0' + number as u8);
    } else {
        out.extend_from_slice(number.to_string().as_bytes());
    }
}

/// The eight decimal digits of a number below 10⁸, the first one first: halves, quarters and single digits
/// are divided side by side in one word.
#[inline]
fn eight_digits(number: u32) -> [u8; 8] {
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
    fn decimals_are_rounded_half_away_from_zero() {
        for (places, fm, text) in [
            (6, 13_100_000_000, "0.013100"),
            (6, -13_100_500_000, "-0.013101"),
            (6, 13_100_499_999, "0.013100"),
            (6, -499_999, "0.000000"),
            (6, -500_000, "-0.000001"),
            (0, 500_000_000_000, "1"),
            (0, -1_499_999_999_999, "-1"),
            (1, 999_950_000_000_000, "1000.0"),
            (3, 12_345_678_000_000, "12.346"),
            (9, 12_345_678_123_456, "12.345678123"),
            (12, -1_000_000_000_001, "-1.000000000001"),
            (14, 1, "0.00000000000100"),
        ] {
            let mut out = Vec::new();
            Places::new(places).write(&mut out, Length::from_fm(fm));
            assert_eq!(std::str::from_utf8(&out).unwrap(), text, "{fm} {places}");
        }
    }
}
