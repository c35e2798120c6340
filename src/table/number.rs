//! Numbers as people and machines write them: decimal commas and points, thousands marks, units, odd minus signs,
//! full-width digits. Called for every cell that is no plain number. It writes the numbers plainly, and [`crate::quantity`] reads
//! them; it knows nothing of columns.
//!
//! Where one of comma and point is the decimal mark, the other groups thousands and does nothing else. A blank, a thin space or an
//! apostrophe groups thousands with either mark.

use super::dictionary::plain_widths;
use crate::deviation::DeviationValue;
use crate::quantity::{Angle, Decimal, Length, QuantityError, Unit};

/// Which character separates the decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum DecimalMark {
    /// `25.013`
    Point,
    /// `25,013`
    Comma,
}

impl DecimalMark {
    /// `point` or `comma`.
    pub(crate) const fn word(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Comma => "comma",
        }
    }

    /// Both marks.
    pub const ALL: [Self; 2] = [Self::Point, Self::Comma];

    /// The character as a byte.
    pub(crate) const fn byte(self) -> u8 {
        match self {
            Self::Point => b'.',
            Self::Comma => b',',
        }
    }
}

/// Blanks that spreadsheets and typesetters put between groups of digits.
const GROUP_BLANKS: [char; 5] = [' ', '\u{a0}', '\u{2009}', '\u{202f}', '\u{2007}'];

fn is_minus(c: char) -> bool {
    matches!(c, '-' | '\u{2212}' | '\u{2013}' | '\u{fe63}' | '\u{ff0d}')
}

/// Texts that say that there is no value, besides dashes and dots.
const MISSING: [&str; 24] = [
    "n/a", "na", "n.a.", "n.a", "nan", "k.a.", "k. a.", "#n/a", "#nv", "none", "null", "nil", "#div/0!", "#value!",
    "#wert!", "#ref!", "#bezug!", "#name?", "#num!", "#zahl!", "#null!", "n.d.", "n.m.", "missing",
];

/// Whether a cell says that there is no value.
pub(crate) fn is_missing(cell: &str) -> bool {
    let cell = cell.trim();
    cell.chars().all(|c| is_minus(c) || matches!(c, '\u{2014}' | '.' | '\u{2026}' | '/' | '\u{30fc}'))
        || MISSING.iter().any(|word| cell.eq_ignore_ascii_case(word))
}

/// The cell with every number in it as `Length` and `Angle` read it: a decimal point, no thousands marks, a plain
/// minus. `None` if the text does not start with a number, or has one that cannot be read with this decimal mark.
pub(crate) fn normalise(cell: &str, mark: DecimalMark) -> Option<String> {
    let mut out = String::new();
    let cell = plain_widths(cell);
    let mut rest = cell.trim();
    let mut first = true;
    while !rest.is_empty() {
        let signs = rest.len() - rest.trim_start_matches(|c| c == '+' || is_minus(c)).len();
        let sign = &rest[..signs];
        let after = rest[signs..].trim_start_matches(GROUP_BLANKS);
        let starts = after.starts_with(|c: char| c.is_ascii_digit())
            || after.starts_with(['.', ',']) && after[1..].starts_with(|c: char| c.is_ascii_digit());
        // two numbers with nothing between them are no number
        if starts && sign.chars().count() <= 1 && !out.ends_with(|c: char| c.is_ascii_digit() || c == '.') {
            let (number, length) = number(after, mark)?;
            if sign.chars().any(is_minus) {
                out.push('-');
            }
            out.push_str(&number);
            rest = &after[length..];
        } else if first {
            return None;
        } else {
            let length = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
            // a sign belongs to the number after it
            let text = &rest[..length];
            let text = text.trim_end_matches(|c| c == '+' || is_minus(c));
            if text.trim_matches(GROUP_BLANKS).is_empty() && !rest[text.len()..].is_empty() {
                return None;
            }
            out.extend(text.chars().map(|c| if GROUP_BLANKS.contains(&c) { ' ' } else { c }));
            rest = &rest[text.len()..];
        }
        first = false;
    }
    (!first).then_some(out)
}

/// The number at the start of `text` with a decimal point, and how many bytes it takes.
fn number(text: &str, mark: DecimalMark) -> Option<(String, usize)> {
    let decimal = char::from(mark.byte());
    let mut groups: Vec<&str> = Vec::new();
    let mut group_mark = None;
    let mut at = 0;
    let mut fraction = None;
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    loop {
        let count = digits(at);
        groups.push(&text[at..at + count]);
        at += count;
        let Some(next) = text[at..].chars().next() else { break };
        let after = at + next.len_utf8();
        let count = digits(after);
        if next == decimal {
            fraction = Some(&text[after..after + count]);
            at = after + count;
            break;
        }
        let groups_digits = GROUP_BLANKS.contains(&next) || matches!(next, '\'' | '\u{2019}' | '.' | ',');
        // 12' 30" is an angle, and `12 500 um` a number: only a group of three continues a number
        if !groups_digits || count == 0 || (count != 3 && !matches!(next, '.' | ',')) {
            break;
        }
        if count != 3 || group_mark.is_some_and(|mark| mark != next) {
            return None;
        }
        group_mark = Some(next);
        at = after;
    }
    if groups.len() > 1 && (!(1..=3).contains(&groups[0].len()) || groups[0].starts_with('0')) {
        return None;
    }
    let mut number = groups.concat();
    if number.is_empty() && fraction.is_none_or(str::is_empty) {
        return None;
    }
    if number.is_empty() {
        number.push('0');
    }
    if let Some(fraction) = fraction.filter(|fraction| !fraction.is_empty()) {
        number.push('.');
        number.push_str(fraction);
    }
    // a second decimal mark, or a group after the decimals, makes it no number
    if text[at..].starts_with(['.', ',']) {
        return None;
    }
    let exponent = exponent(&text[at..]);
    number.push_str(exponent);
    Some((number, at + exponent.len()))
}

/// The power of ten that a text starts with: `e-3`; empty if there is none.
fn exponent(text: &str) -> &str {
    let Some(power) = text.strip_prefix(['e', 'E']) else { return "" };
    let digits = power.strip_prefix(['+', '-']).unwrap_or(power);
    let rest = digits.trim_start_matches(|c: char| c.is_ascii_digit());
    if rest.len() < digits.len() { &text[..text.len() - rest.len()] } else { "" }
}

/// A number in a unit.
pub(crate) fn quantity(number: Decimal, unit: Unit) -> Result<DeviationValue, QuantityError> {
    match unit {
        Unit::Length(unit) => Length::of_number(number, unit).map(DeviationValue::Length),
        Unit::Angle(unit) => Angle::of_number(number, unit).map(DeviationValue::Angle),
    }
}

/// Whether a text is a number by either decimal mark.
pub(crate) fn is_number(cell: &str) -> bool {
    // most cells are digits with one mark or none
    let digits = cell.strip_prefix('-').unwrap_or(cell);
    let mut parts = digits.split(['.', ',']);
    let is_plain =
        |part: Option<&str>| part.is_none_or(|part| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit()));
    let is_plain = digits.len() <= 18 && is_plain(parts.next()) && is_plain(parts.next()) && parts.next().is_none();
    let is_word = cell.starts_with(|c: char| c.is_alphabetic() && c < '\u{3000}');
    is_plain || !is_word && DecimalMark::ALL.into_iter().any(|mark| normalise(cell, mark).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_both_marks() {
        for (cell, point, comma) in [
            ("25.013", Some("25.013"), Some("25013")),
            ("25,013", Some("25013"), Some("25.013")),
            ("0,4", None, Some("0.4")),
            ("0.125", Some("0.125"), None),
            ("1.000,92", None, Some("1000.92")),
            ("1,000.92", Some("1000.92"), None),
            ("1 000,92", None, Some("1000.92")),
            ("1\u{202f}000,92 µm", None, Some("1000.92 µm")),
            ("1'000.5", Some("1000.5"), None),
            ("1.234.567", None, Some("1234567")),
            ("1,234,567", Some("1234567"), None),
            ("\u{2212}3 µm", Some("-3 µm"), Some("-3 µm")),
            ("\u{2013}3,5", None, Some("-3.5")),
            ("- 3", Some("-3"), Some("-3")),
            ("12° 30'", Some("12° 30'"), Some("12° 30'")),
            ("12° 30,5'", None, Some("12° 30.5'")),
            (",5", None, Some("0.5")),
            ("1e-3", Some("1e-3"), Some("1e-3")),
            ("1,5e-3", None, Some("1.5e-3")),
            ("12.5.3", None, None),
            ("1,2.3,4", None, None),
            ("0,123,456", None, None),
            ("abc", None, None),
            ("--3", None, None),
            ("", None, None),
            ("1234,567", None, Some("1234.567")),
            ("5,", None, Some("5")),
            ("1 2.5", None, None),
            ("25.01 31", None, None),
            // what stands behind a number is left to the reader of quantities, for whom this is no unit
            ("1_000", Some("1_000"), Some("1_000")),
            ("2_5.01", Some("2_5.01"), None),
            ("\u{ff12}\u{ff15}\u{ff0e}\u{ff10}\u{ff11}\u{ff13}\u{ff11}", Some("25.0131"), None),
        ] {
            assert_eq!(normalise(cell, DecimalMark::Point).as_deref(), point, "{cell} with a point");
            assert_eq!(normalise(cell, DecimalMark::Comma).as_deref(), comma, "{cell} with a comma");
        }
        for (cell, is_it) in
            [("1,234", true), ("17", true), ("P1", false), ("-1.5", true), ("5,", true), ("1.2.3", false), ("-", false)]
        {
            assert_eq!(is_number(cell), is_it, "{cell}");
        }
        for missing in [" -- ", "n/a", "", "---", "#DIV/0!", "#NV", "\u{2014}"] {
            assert!(is_missing(missing), "{missing}");
        }
        assert!(!is_missing("-3"));
    }
}
