//! Numbers as text. All reports call it; it decides how many digits a column has.

use crate::deviation::DeviationValue;
use crate::judge::Interval;
use crate::quantity::LengthUnit;
pub(super) use crate::quantity::{padded, plain, plain_padded, signed, tidy};

/// The last decimal that columns of mm have.
pub(super) const SEEN_MM: f64 = 1e-4;

/// The smallest length that the mesh tells from none, mm.
const NOTHING_MM: f64 = 1e-6;

/// A length in mm for people: signed, to 0.1 µm; a smaller one to 1 nm.
pub(super) fn millimetres(mm: f64) -> String {
    signed(if mm.abs() < NOTHING_MM { 0.0 } else { mm }, 4)
}

/// The magnitude of a length that has no sign, in mm for people.
pub(super) fn unsigned(mm: f64) -> String {
    millimetres(mm).trim_start_matches('+').to_owned()
}

/// The stroke of an extreme, mm, for people; empty where there is none.
pub(super) fn stroke_text(mm: f64) -> String {
    if mm.is_nan() { String::new() } else { format!("{mm:.4}") }
}

/// A count with its thousands apart.
pub(crate) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let groups: Vec<_> = digits.as_bytes().rchunks(3).rev().map(String::from_utf8_lossy).collect();
    groups.join(",")
}

/// So many things: `1 rack`, `1,000 racks`.
pub(crate) fn counted(count: u64, thing: &str) -> String {
    format!("{} {thing}{}", grouped(count), if count == 1 { "" } else { "s" })
}

/// A share in whole percent.
pub(super) fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// From one length to another, in mm for people; one number if they are equal.
pub(super) fn ends(lower_mm: f64, upper_mm: f64) -> String {
    let (lower, upper) = (millimetres(lower_mm), millimetres(upper_mm));
    if lower == upper { upper } else { format!("{lower} … {upper}") }
}

/// The same of an interval.
pub(super) fn interval_text(Interval { lower, upper }: &Interval) -> String {
    ends(lower.mm(), upper.mm())
}

/// A deviation without its unit, which is µm or degrees.
pub(super) fn deviation_number(value: DeviationValue) -> String {
    match value {
        DeviationValue::Length(length) => signed(length.in_unit(LengthUnit::Micrometre), 1),
        angle => signed(angle.base(), 4),
    }
}

/// A deviation, or both ends of a tolerance of two, in µm or degrees.
pub(super) fn deviation_text(value: DeviationValue, ends: Option<[f64; 2]>) -> String {
    let (per_base, decimals, unit) =
        if matches!(value, DeviationValue::Length(_)) { (1e3, 1, " µm") } else { (1.0, 4, "°") };
    match ends.map(|ends| ends.map(|end| signed(per_base * end, decimals))) {
        Some([lower, upper]) => format!("{lower} … {upper}{unit}"),
        None => format!("{}{unit}", deviation_number(value)),
    }
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
    fn thousands_stand_apart() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn no_column_of_millimetres_has_powers_of_ten_or_a_signed_zero() {
        for (value, text) in [
            (0.0, "0.0000"),
            (-0.0, "0.0000"),
            (0.013, "+0.0130"),
            (-0.00006, "-0.0001"),
            (0.00004, "+0.00004"),
            (-0.000_001_2, "-0.000001"),
            (-0.000_000_6, "0.0000"),
            (-8.02e-8, "0.0000"),
            (-1e-300, "0.0000"),
            (1e8, "+1.00e8"),
        ] {
            assert_eq!(millimetres(value), text);
        }
    }

    #[test]
    fn decimals_that_a_value_does_not_have_are_zeros() {
        assert_eq!(padded(0.004, 30).as_deref(), Some("0.004000000000000000000000000000"));
        assert_eq!(padded(-12.0, 2).as_deref(), Some("-12.00"));
        assert_eq!((padded(0.004, 3), padded(12.0, 0)), (None, None));
    }

    #[test]
    fn what_is_allowed_is_not_rounded_up() {
        for (value, decimals, text) in
            [(6.317, 2, "6.31"), (-6.317, 2, "-6.31"), (6.25, 2, "6.25"), (0.9999, 0, "0"), (12.0, 3, "12.000")]
        {
            assert_eq!(truncated(value, decimals), text);
        }
    }
}
