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

/// Writes several lengths: up to eight are put together on the stack and copied at once.
fn write_each<const DECIMALS: u32>(out: &mut Vec<u8>, separator: u8, lengths: &[Length]) {
    const TOGETHER: usize = 8;
    // a separator, a sign, a digit, the mark, and six decimals
    const LONGEST: usize = 10;
    for lengths in lengths.chunks(TOGETHER) {
        let (mut bytes, mut end) = ([0; TOGETHER * LONGEST], 0);
        for length in lengths {
            bytes[end] = separator;
            end += 1;
            if let Some((is_negative, text)) = short::<DECIMALS>(*length) {
                bytes[end] = b'-';
                end += usize::from(is_negative);
                bytes[end..end + text.len()].copy_from_slice(&text);
                end += DECIMALS as usize + 2;
            } else {
                out.extend_from_slice(&bytes[..end]);
                end = 0;
                write_long(out, *length, DECIMALS);
            }
        }
        out.extend_from_slice(&bytes[..end]);
    }
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
    let millionths = rounded as u32 * 10u32.pow(6u32.saturating_sub(DECIMALS));
    let [a, b, c] = [millionths / 10_000, millionths / 100, millionths].map(|pairs| PAIRS[(pairs % 100) as usize]);
    Some((is_negative, [b'0' + (millionths / 1_000_000) as u8, b'.', a[0], a[1], b[0], b[1], c[0], c[1]]))
}

/// The texts of 00 to 99: a division for each digit takes longer.
const PAIRS: [[u8; 2]; 100] = {
    let mut pairs = [[b'0'; 2]; 100];
    let mut pair = 0;
    while pair < 100 {
        pairs[pair] = [b'0' + pair as u8 / 10, b'0' + pair as u8 % 10];
        pair += 1;
    }
    pairs
};

#[cold]
fn write_long(out: &mut Vec<u8>, length: Length, decimals: u32) {
    let (rounded, is_negative) = rounded(length, decimals);
    let (one, count) = (10u64.pow(decimals), decimals as usize);
    let sign = if is_negative { "-" } else { "" };
    let text = match decimals {
        0 => format!("{sign}{rounded}"),
        _ => format!("{sign}{}.{:0count$}", rounded / one, rounded % one),
    };
    out.extend_from_slice(text.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

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
