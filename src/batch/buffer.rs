//! Bytes that grow at the end: room is made once per row, and then every write is a copy.

/// Written bytes with room behind them.
#[derive(Debug, Default)]
pub(super) struct Buffer {
    bytes: Vec<u8>,
    at: usize,
}

impl Buffer {
    /// Makes room for so many bytes.
    #[inline]
    pub(super) fn room(&mut self, more: usize) {
        // the digits are written eight at a time
        let needed = self.at + more + 8;
        if needed > self.bytes.len() {
            self.bytes.resize(needed.max(2 * self.bytes.len()), 0);
        }
    }

    /// What was written.
    pub(super) fn written(&self) -> &[u8] {
        &self.bytes[..self.at]
    }

    /// Forgets what was written behind a mark.
    #[inline]
    pub(super) fn truncate(&mut self, mark: usize) {
        self.at = mark;
    }

    /// One byte, within the room.
    #[inline]
    pub(super) fn byte(&mut self, byte: u8) {
        self.bytes[self.at] = byte;
        self.at += 1;
    }

    /// The first `count` of eight digits, within the room.
    #[inline]
    pub(super) fn leading_digits(&mut self, digits: [u8; 8], count: usize) {
        self.bytes[self.at..self.at + 8].copy_from_slice(&digits);
        self.at += count;
    }

    /// A whole number, within the room (20 digits at most).
    #[inline]
    pub(super) fn integer(&mut self, number: u64) {
        if number < 10 {
            self.byte(b'0' + number as u8);
            return;
        }
        let leading = number / 100_000_000;
        let low = eight_digits((number % 100_000_000) as u32);
        if leading > 0 {
            self.integer(leading);
            self.leading_digits(low, 8);
        } else {
            for digit in low.into_iter().skip_while(|digit| *digit == b'0') {
                self.byte(digit);
            }
        }
    }

    /// Any bytes; makes its own room.
    #[inline]
    pub(super) fn extend(&mut self, bytes: &[u8]) {
        self.room(bytes.len());
        self.bytes[self.at..self.at + bytes.len()].copy_from_slice(bytes);
        self.at += bytes.len();
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
    fn integers() {
        for number in [0, 9, 10, 4611, 99_999_999, 100_000_000, 1_000_000_001, u64::MAX] {
            let mut out = Buffer::default();
            out.room(32);
            out.integer(number);
            assert_eq!(std::str::from_utf8(out.written()).unwrap(), number.to_string());
        }
    }
}
