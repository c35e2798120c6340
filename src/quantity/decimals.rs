//! Lengths as decimal text. Called by [`Length`] and by batches, whose output is mostly lengths.

use super::Length;

/// Writes lengths in mm with a number of decimals.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Places {
    write: fn(&mut Vec<u8>, Length),
    write_each: fn(&mut Vec<u8>, u8, &[Length]),
    /// Zeros behind the decimals of the grid.
    zeros: usize,
}

impl Places {
    pub(crate) fn new(count: usize) -> Self {
        /// The writers of one number of decimals, which divide by constants.
        type Writers = (fn(&mut Vec<u8>, Length), fn(&mut Vec<u8>, u8, &[Length]));
        const fn of<const DECIMALS: u32>() -> Writers {
            (write::<DECIMALS>, write_each::<DECIMALS>)
        }
        const WRITERS: [Writers; 13] = [
            of::<0>(),
            of::<1>(),
            of::<2>(),
            of::<3>(),
            of::<4>(),
            of::<5>(),
            of::<6>(),
            of::<7>(),
            of::<8>(),
            of::<9>(),
            of::<10>(),
            of::<11>(),
            of::<12>(),
        ];
        let kept = count.min(12);
        let (write, write_each) = WRITERS[kept];
        Self { write, write_each, zeros: count - kept }
    }

    /// Writes the length rounded half away from zero.
    #[inline]
    pub(crate) fn write(self, out: &mut Vec<u8>, length: Length) {
        (self.write)(out, length);
        if self.zeros > 0 {
            out.resize(out.len() + self.zeros, b'0');
        }
    }

    /// Writes several lengths, each behind a separator.
    #[cfg_attr(not(feature = "batch"), expect(dead_code, reason = "only batches write several"))]
    #[inline]
    pub(crate) fn write_each(self, out: &mut Vec<u8>, separator: u8, lengths: &[Length]) {
        if self.zeros == 0 {
            return (self.write_each)(out, separator, lengths);
        }
        for length in lengths {
            out.push(separator);
            self.write(out, *length);
        }
    }
}

fn write<const DECIMALS: u32>(out: &mut Vec<u8>, length: Length) {
    match short::<DECIMALS>(length) {
        Some((is_negative, text)) => {
            out.extend(is_negative.then_some(b'-'));
            out.extend_from_slice(&text[..DECIMALS as usize + 2]);
        }
        None => write_long(out, length, DECIMALS),
    }
}

/// Writes several lengths, up to the next long one into room that is made once.
fn write_each<const DECIMALS: u32>(out: &mut Vec<u8>, separator: u8, mut lengths: &[Length]) {
    while !lengths.is_empty() {
        let start = out.len();
        out.resize(start + lengths.len() * LONGEST, separator);
        let (written, bytes) = write_short::<DECIMALS>(&mut out[start..], separator, lengths);
        out.truncate(start + bytes);
        lengths = &lengths[written..];
        if let Some((long, rest)) = lengths.split_first() {
            out.push(separator);
            write_long(out, *long, DECIMALS);
            lengths = rest;
        }
    }
}

/// A separator, a sign, a digit, the mark, and six decimals.
const LONGEST: usize = 10;

/// Writes lengths up to the first long one: how many these are, and their bytes.
fn write_short<const DECIMALS: u32>(room: &mut [u8], separator: u8, lengths: &[Length]) -> (usize, usize) {
    let mut end = 0;
    for (index, length) in lengths.iter().enumerate() {
        let room = room.get_mut(end..).and_then(<[u8]>::first_chunk_mut::<LONGEST>);
        let (Some((is_negative, text)), Some(room)) = (short::<DECIMALS>(*length), room) else { return (index, end) };
        let digits = 1 + usize::from(is_negative);
        (room[0], room[1]) = (separator, b'-');
        room[digits..digits + text.len()].copy_from_slice(&text);
        end += digits + DECIMALS as usize + 2;
    }
    (lengths.len(), end)
}

/// The magnitude in units of the last decimal, and whether a minus sign stands before it.
#[inline]
fn rounded(length: Length, decimals: u32) -> (u64, bool) {
    let cut = 10u64.pow(12 - decimals);
    let rounded = (length.fm().unsigned_abs() + cut / 2) / cut;
    (rounded, length.is_negative() && rounded > 0)
}

/// The usual length of a table, below 10 mm with up to six decimals: whether a minus sign stands before it, and its text. The
/// text always has six decimals, so that each copy has the same number of bytes.
#[inline]
fn short<const DECIMALS: u32>(length: Length) -> Option<(bool, [u8; 8])> {
    let (rounded, is_negative) = rounded(length, DECIMALS);
    if !(1..=6).contains(&DECIMALS) || rounded >= 10 * 10u64.pow(DECIMALS) {
        return None;
    }
    let millionths = rounded * 10u64.pow(6u32.saturating_sub(DECIMALS));
    // the number in units of 2^-57: a digit stands above these bits, and a hundred times the rest has the next two there
    let mut rest = millionths * (1u64 << 57).div_ceil(1_000_000);
    let whole = u64::from(b'0') + (rest >> 57);
    let [a, b, c] = [(); 3].map(|()| {
        rest = (rest & ((1 << 57) - 1)) * 100;
        u64::from(PAIRS[(rest >> 57) as usize])
    });
    Some((is_negative, (whole | u64::from(b'.') << 8 | a << 16 | b << 32 | c << 48).to_le_bytes()))
}

/// The texts of 00 to 99, the first digit in the low byte, in a table of a size that needs no check: a division for each digit takes
/// longer.
const PAIRS: [u16; 128] = {
    let mut pairs = [0; 128];
    let mut pair = 0;
    while pair < 100 {
        pairs[pair] = u16::from_le_bytes([b'0' + pair as u8 / 10, b'0' + pair as u8 % 10]);
        pair += 1;
    }
    pairs
};

/// Writes a whole number.
#[cfg(feature = "batch")]
pub(crate) fn write_whole(out: &mut Vec<u8>, mut number: u64) {
    let mut text = [b'0'; 20];
    let mut start = text.len();
    while number >= 10 {
        start -= 2;
        text[start..start + 2].copy_from_slice(&PAIRS[(number % 100) as usize].to_le_bytes());
        number /= 100;
    }
    // no digit is left, or one; 0 is one
    if number > 0 || start == text.len() {
        start -= 1;
        text[start] += number as u8;
    }
    out.extend_from_slice(&text[start..]);
}

#[cold]
fn write_long(out: &mut Vec<u8>, length: Length, decimals: u32) {
    let (mut rest, is_negative) = rounded(length, decimals);
    // of the smallest length 20 characters are written, a mark included
    let mut text = [b'0'; 24];
    let mut start = text.len();
    let whole = if decimals == 0 { start } else { start - decimals as usize - 1 };
    while rest > 0 || start >= whole {
        start -= 1;
        if start == whole {
            text[start] = b'.';
        } else {
            text[start] += (rest % 10) as u8;
            rest /= 10;
        }
    }
    out.extend(is_negative.then_some(b'-'));
    out.extend_from_slice(&text[start..]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "batch")]
    #[test]
    fn whole_numbers_have_all_digits() {
        for number in [0, 9, 10, 2_048, 1_000_000, u64::MAX] {
            let mut text = Vec::new();
            write_whole(&mut text, number);
            assert_eq!(String::from_utf8(text).unwrap(), number.to_string());
        }
    }

    #[test]
    fn decimals_are_rounded_half_away_from_zero() {
        for (decimals, fm, text) in [
            (6, 13_100_000_000, "0.013100"),
            (6, -13_100_500_000, "-0.013101"),
            (6, 13_100_499_999, "0.013100"),
            (6, -499_999, "0.000000"),
            (6, -500_000, "-0.000001"),
            (0, 500_000_000_000, "1"),
            (0, -1_499_999_999_999, "-1"),
            (0, 12_500_000_000_000, "13"),
            (1, 999_950_000_000_000, "1000.0"),
            (2, -1_000_000_000_000_000, "-1000.00"),
            (3, 12_345_678_000_000, "12.346"),
            (7, -9_999_999_900_000, "-9.9999999"),
            (1, -9_949_999_999_999, "-9.9"),
            (1, 9_950_000_000_000, "10.0"),
            (9, 12_345_678_123_456, "12.345678123"),
            (12, -1_000_000_000_001, "-1.000000000001"),
            (12, i64::MIN, "-9223372.036854775808"),
            (14, 1, "0.00000000000100"),
        ] {
            assert_eq!(Length::from_fm(fm).to_decimal_text(decimals), text, "{fm} {decimals}");
            let (mut side_by_side, several) = (Vec::new(), [Length::from_fm(1), Length::from_fm(fm)].repeat(9));
            Places::new(decimals).write_each(&mut side_by_side, b';', &several);
            let one_by_one: String =
                several.iter().map(|length| [";", &length.to_decimal_text(decimals)].concat()).collect();
            assert_eq!(String::from_utf8(side_by_side).unwrap(), one_by_one);
        }
        for (fm, text) in
            [(13_100_000_000, "0.0131 mm"), (-25_000_000_000_000, "-25 mm"), (0, "0 mm"), (1, "0.000000000001 mm")]
        {
            assert_eq!(Length::from_fm(fm).to_string(), text);
        }
    }
}
