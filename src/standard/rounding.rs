//! The rounding of permissible values.
//!
//! ISO 1328-1 (1995 and 2013) rounds the value of a grade, in µm, once: above 10 to whole µm, from 5 to 10
//! to 0.5 µm, below 5 to 0.1 µm. The standards do not say what becomes of a value half way; it is rounded up,
//! as schools teach. For ISO 1328-2:1997 the same steps are used: every printed value known to us is above
//! 10 µm, where they are sure.

use crate::quantity::Rational;

/// The rounded value of a permissible deviation, µm.
pub(super) fn iso(um: &Rational) -> Rational {
    let step = if *um > 10 {
        Rational::ONE
    } else if *um >= 5 {
        Rational::fraction(1, 2)
    } else {
        Rational::fraction(1, 10)
    };
    um.round_to_multiple_of(&step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_and_halves() {
        for (value, rounded) in [
            ("10.5", "11"),
            ("10.4999999999999999999999999", "10"),
            ("10.0000000000000000001", "10"),
            ("10", "10"),
            ("9.75", "10"),
            ("9.7499999999999999999999", "9.5"),
            ("6.25", "6.5"),
            ("5.25", "5.5"),
            ("5.2", "5"),
            ("5", "5"),
            ("4.99", "5"),
            ("4.95", "5"),
            ("4.9499999999999999999999", "4.9"),
            ("1.35", "1.4"),
            ("0.04", "0"),
            ("17.5", "18"),
        ] {
            let read = |text| Rational::parse_decimal(text).unwrap();
            assert_eq!(iso(&read(value)), read(rounded), "{value}");
        }
    }
}
