//! Numbers as programs read them. Used by what writes results.

/// The shortest text that reads back as the same double, in powers of ten only where the plain form
/// would be long.
pub(crate) fn plain(value: f64) -> String {
    plain_padded(value, 0)
}

/// As [`plain`], with at least that many decimals.
pub(crate) fn plain_padded(value: f64, decimals: usize) -> String {
    // Rust's shortest form never uses an exponent; outside this range it is all zeros
    if value != 0.0 && !(1e-7..1e15).contains(&value.abs()) {
        return format!("{value:e}");
    }
    padded(value, decimals).unwrap_or_else(|| value.to_string())
}

/// A value with more decimals than it has: zeros.
pub(crate) fn padded(value: f64, decimals: usize) -> Option<String> {
    let text = format!("{value}");
    let has = text.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    let point = if has == 0 { "." } else { "" };
    (decimals > has).then(|| format!("{text}{point}{}", "0".repeat(decimals - has)))
}

/// The grid of lengths, 1 fm.
pub(crate) const FM_PER_MM: f64 = 1e12;

/// A value without the digits that are rounding of the solution (1e-15 of the centre distance) only.
pub(crate) fn tidy(value: f64) -> f64 {
    let rounded = (value * FM_PER_MM).round() / FM_PER_MM;
    // -0 says nothing
    if rounded == 0.0 || !rounded.is_finite() { rounded.abs() } else { rounded }
}

/// What [`tidy`] makes of a length in mm, as a whole number of femtometres; `None` if it is larger than any
/// [`Length`](super::Length) or no number.
pub(crate) fn femtometres(mm: f64) -> Option<i64> {
    let rounded = (mm * FM_PER_MM).round();
    // the conversion saturates
    (rounded.abs() <= super::LARGEST as f64).then_some(rounded as i64)
}

/// The other way, with parts of a femtometre.
pub(crate) fn of_femtometres(fm: f64) -> f64 {
    tidy(fm / FM_PER_MM)
}

/// A signed number with that many decimals, or up to two more where these would show nothing; what is zero even so has no
/// sign. Too large a number stands in powers of ten.
pub(crate) fn signed(value: f64, decimals: usize) -> String {
    const LARGE: f64 = 1e7;
    const MORE: usize = 2;
    if value.abs() >= LARGE {
        return format!("{value:+.2e}");
    }
    let texts = (decimals..=decimals + MORE).map(|decimals| format!("{value:+.decimals$}"));
    let shows = |text: &String| text.bytes().any(|byte| matches!(byte, b'1'..=b'9'));
    let mut shown = texts.filter(|text| !value.is_finite() || shows(text));
    shown.next().unwrap_or_else(|| format!("{:.decimals$}", 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

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
