//! Numbers in the messages of errors and warnings. Results are written by the report, which knows their accuracy.

use std::fmt;

/// A number to seven significant digits, without trailing zeros.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rounded(pub(crate) f64);

/// An angle in radians, shown in degrees to seven significant digits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Degrees(pub(crate) f64);

impl fmt::Display for Rounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scientific = format!("{:.6e}", self.0);
        let rounded: f64 = scientific.parse().unwrap_or(self.0);
        if rounded == 0.0 || (1e-5..1e10).contains(&rounded.abs()) || !rounded.is_finite() {
            write!(f, "{rounded}")
        } else {
            write!(f, "{rounded:e}")
        }
    }
}

impl fmt::Display for Degrees {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}°", Rounded(self.0.to_degrees()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seven_digits_and_no_more_zeros_than_needed() {
        for (value, text) in [
            (17.111_379_666_394_19, "17.11138"),
            (0.3, "0.3"),
            (-2.0, "-2"),
            (1e6, "1000000"),
            (1_125_899_906_842_624.0, "1.1259e15"),
            (1e-300, "1e-300"),
            (0.0, "0"),
            (f64::NAN, "NaN"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(Rounded(value).to_string(), text);
        }
        assert_eq!(Degrees(std::f64::consts::FRAC_PI_4).to_string(), "45°");
        assert_eq!(Degrees(3.0 * std::f64::consts::PI / 180.0).to_string(), "3°");
    }
}
