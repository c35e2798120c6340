//! Numbers as text. Called by all reports: how many digits a column has is decided here.

/// A length in mm for people: signed, to 0.1 µm; a value too small for that in powers of ten, so that
/// nothing but zero is printed as zero.
pub(super) fn millimetres(mm: f64) -> String {
    signed(mm, 4)
}

/// A signed number with that many decimals, or in powers of ten where they would show nothing or too
/// much.
pub(super) fn signed(value: f64, decimals: usize) -> String {
    const LARGE: f64 = 1e7;
    let fixed = format!("{value:+.decimals$}");
    let vanishes = value != 0.0 && fixed.bytes().all(|b| !b.is_ascii_digit() || b == b'0');
    if value == 0.0 {
        format!("{:.decimals$}", 0.0)
    } else if vanishes || value.abs() >= LARGE {
        format!("{value:+.2e}")
    } else {
        fixed
    }
}

/// The shortest text that reads back as the same double, in powers of ten only where the plain form
/// would be long.
pub(crate) fn plain(value: f64) -> String {
    plain_padded(value, 0)
}

/// As [`plain`], with at least that many decimals.
pub(super) fn plain_padded(value: f64, decimals: usize) -> String {
    // Rust's shortest form never uses an exponent; outside this range it is all zeros
    if value != 0.0 && !(1e-7..1e15).contains(&value.abs()) {
        return format!("{value:e}");
    }
    let text = format!("{value}");
    let has = text.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    if has >= decimals { text } else { format!("{value:.decimals$}") }
}

/// A value without the digits that are rounding of the solution (1e-15 of the centre distance) only.
pub(super) fn tidy(value: f64) -> f64 {
    const PICO: f64 = 1e12;
    let rounded = (value * PICO).round() / PICO;
    // -0 says nothing
    if rounded == 0.0 || !rounded.is_finite() { rounded.abs() } else { rounded }
}

/// The number with that many decimals, the rest cut off.
pub(super) fn truncated(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    // rounded up: cut the exact decimal expansion, which has fewer than 1100 decimals, instead
    if text.parse::<f64>().is_ok_and(|rounded| rounded.abs() > value.abs()) {
        let full = format!("{value:.1100}");
        let end = full.find('.').map_or(full.len(), |point| if decimals == 0 { point } else { point + 1 + decimals });
        return full[..end].to_owned();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_zero_is_printed_as_zero() {
        for (value, text) in [
            (0.0, "0.0000"),
            (-0.0, "0.0000"),
            (0.013, "+0.0130"),
            (-0.00006, "-0.0001"),
            (0.00004, "+4.00e-5"),
            (-1e-300, "-1.00e-300"),
            (1e8, "+1.00e8"),
        ] {
            assert_eq!(millimetres(value), text);
        }
    }

    #[test]
    fn what_is_allowed_is_not_rounded_up() {
        for (value, decimals, text) in
            [(6.317, 2, "6.31"), (-6.317, 2, "-6.31"), (6.25, 2, "6.25"), (0.9999, 0, "0"), (12.0, 3, "12.000")]
        {
            assert_eq!(truncated(value, decimals), text);
        }
    }

    #[test]
    fn plain_numbers_lose_nothing() {
        for (value, text) in [
            (0.0131, "0.013100"),
            (0.1 + 0.2, "0.30000000000000004"),
            (-25.0, "-25.000000"),
            (1e-9, "1e-9"),
            (1e300, "1e300"),
            (0.0, "0.000000"),
        ] {
            assert_eq!(plain_padded(value, 6), text);
            assert_eq!(plain(value).parse::<f64>().unwrap(), value);
        }
    }
}
