//! The rounding of permissible values.
//!
//! ISO 1328-1 (1995 and 2013) rounds the value of a grade once: above 10 µm to 1 µm, from 5 to 10 µm
//! to 0.5 µm, below 5 µm to 0.1 µm. The standards do not say how a value half way is rounded; here it is rounded
//! up. ISO 1328-2:1997 is assumed to have the same steps: every printed value known here is above 10 µm, where
//! steps of 1 µm are certain.

use crate::quantity::Length;

/// The length of a number of µm.
pub(super) fn micrometres(um: f64) -> Length {
    // permissible values are far smaller than the largest length
    Length::nearest(um * 1e9, "the permissible value").unwrap_or(Length::ZERO)
}

/// The rounded value of a permissible deviation.
pub(super) fn iso(unrounded: Length) -> Length {
    const UM: i64 = 1_000_000_000;
    let fm = unrounded.fm();
    let step = if fm > 10 * UM {
        UM
    } else if fm >= 5 * UM {
        UM / 2
    } else {
        UM / 10
    };
    Length::from_fm((fm + step / 2).div_euclid(step) * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_and_halves() {
        for (value, rounded) in [
            (10.5, 11.0),
            (10.499_999_999, 10.0),
            (10.000_000_001, 10.0),
            (10.0, 10.0),
            (9.75, 10.0),
            (9.749_999_999, 9.5),
            (6.25, 6.5),
            (5.25, 5.5),
            (5.2, 5.0),
            (5.0, 5.0),
            (4.99, 5.0),
            (4.95, 5.0),
            (4.949_999_999, 4.9),
            (1.35, 1.4),
            (0.04, 0.0),
            (17.5, 18.0),
            // rounding of a root
            (10.499_999_999_999_998, 11.0),
        ] {
            assert_eq!(iso(micrometres(value)), micrometres(rounded), "{value}");
        }
    }
}
