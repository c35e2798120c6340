//! Numbers as text for programs. Called wherever results are written.

/// The shortest text that reads back as the same double; in powers of ten where the decimal form is long.
pub(crate) fn plain(value: f64) -> String {
    plain_padded(value, 0)
}

/// As [`plain`], with at least `decimals` decimals.
pub(crate) fn plain_padded(value: f64, decimals: usize) -> String {
    // `Display` never writes an exponent; outside this range it writes mostly zeros
    if value != 0.0 && !(1e-7..1e15).contains(&value.abs()) {
        return format!("{value:e}");
    }
    padded(value, decimals).unwrap_or_else(|| value.to_string())
}

/// A value filled up with zeros to `decimals` decimals; `None` if it has as many or more.
pub(crate) fn padded(value: f64, decimals: usize) -> Option<String> {
    let text = format!("{value}");
    let has = text.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    let point = if has == 0 { "." } else { "" };
    (decimals > has).then(|| format!("{text}{point}{}", "0".repeat(decimals - has)))
}

/// Femtometres, the steps of the grid of lengths, in a mm.
pub(crate) const FM_PER_MM: f64 = 1e12;

/// A value rounded to 1 fm: the digits behind are rounding errors of a solution (1e-15 of the centre distance).
pub(crate) fn tidy(value: f64) -> f64 {
    let rounded = (value * FM_PER_MM).round() / FM_PER_MM;
    // 0 has no sign
    if rounded == 0.0 || !rounded.is_finite() { rounded.abs() } else { rounded }
}

/// A length in mm rounded as by [`tidy`], in femtometres; `None` if it is larger than any [`Length`](super::Length), or NaN.
pub(crate) fn femtometres(mm: f64) -> Option<i64> {
    let rounded = (mm * FM_PER_MM).round();
    // the conversion saturates, which the comparison excludes
    (rounded.abs() <= super::LARGEST as f64).then_some(rounded as i64)
}

/// A number of femtometres, whole or not, in mm.
pub(crate) fn of_femtometres(fm: f64) -> f64 {
    tidy(fm / FM_PER_MM)
}

/// A number with its sign and `decimals` decimals, or up to two more if these are all zero; if those are too, zero without
/// a sign. A number of 1e7 or more stands in powers of ten.
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
