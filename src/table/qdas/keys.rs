//! The keys of Q-DAS: lines that start with one, which keys the format owns, and which change values.

use std::ops::Range;

use crate::quantity::parse_f64;

/// One line with a key.
pub(super) struct Line<'t> {
    pub(super) key: u16,
    pub(super) index: usize,
    pub(super) text: &'t str,
    /// The whole line.
    pub(super) whole: &'t str,
    /// Where in it the text starts.
    pub(super) start: usize,
}

impl<'t> Line<'t> {
    /// A line without a key.
    pub(super) fn plain(whole: &'t str) -> Self {
        Self { key: 1, index: 1, text: whole, whole, start: 0 }
    }

    /// The bytes of the text.
    pub(super) fn span(&self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }
}

/// Whether the format owns what stands under a key: keys that are read, and keys that say what is measured, where, when, with what and
/// by whom. All other keys, and those of remarks, need a rule.
#[rustfmt::skip]
pub(super) const fn is_of_format(key: u16) -> bool {
    matches!(
        key,
        1..=2 | 4..=8 | 10..=12 | 14..=17 | 53 | 97 | 100..=101 | 1001..=1017 | 1021..=1022 | 1031..=1032 | 1041..=1046
        | 1051..=1055 | 1061..=1063 | 1071..=1072 | 1081..=1087 | 1091..=1092 | 1100..=1115 | 1201..=1231 | 1301..=1303
        | 1311..=1315 | 1341..=1363 | 2001..=2011 | 2015..=2016 | 2022..=2024 | 2027..=2031 | 2041..=2049 | 2060..=2061
        | 2071..=2072 | 2090..=2093 | 2101..=2106 | 2110..=2117 | 2120..=2121 | 2130..=2131 | 2141..=2143 | 2151..=2152
        | 2201..=2228 | 2301..=2322 | 2401..=2411
    )
}

/// Whether words under a key of the format are a person's own, which need a rule: where the format has a number of a catalogue, an amount
/// or a switch, in reasons of a test (K1203), and in texts of characteristics (K2092).
#[rustfmt::skip]
pub(super) const fn has_free_words(key: u16) -> bool {
    matches!(
        key,
        2 | 5 | 7 | 11 | 15 | 100..=101 | 1010 | 1083 | 1203 | 1210 | 2004..=2011 | 2015..=2016 | 2022..=2024 | 2027..=2028
        | 2030..=2031 | 2041..=2042 | 2044..=2049 | 2092 | 2102..=2105 | 2114..=2117 | 2120..=2121 | 2130..=2131
    )
}

/// Whether a value with that attribute (K0002) counts.
pub(super) fn counts(attribute: &str) -> bool {
    attribute.is_empty() || attribute.parse() == Ok(0)
}

/// Whether a text with a decimal point is a number.
pub(super) fn is_number(text: &str) -> bool {
    parse_f64(text).is_ok()
}

/// A line that starts with a key; an error if the index behind the key is no number.
pub(super) fn keyed(line: &str) -> Option<Result<Line<'_>, String>> {
    let digits = line.strip_prefix(['K', 'k'])?.get(..4).filter(|digits| digits.bytes().all(|b| b.is_ascii_digit()))?;
    let key: u16 = digits.parse().ok()?;
    let rest = &line[5..];
    let (index, text) = match rest.strip_prefix('/') {
        None => ("", rest.strip_prefix([' ', '\t']).unwrap_or(rest)),
        Some(indexed) => indexed.split_once([' ', '\t']).unwrap_or((indexed, "")),
    };
    // a second index counts values, whose order says the same
    let first = index.split('/').next().unwrap_or("");
    let parsed = if first.is_empty() { Some(usize::from(key >= 1000)) } else { first.parse().ok() };
    let Some(index) = parsed else {
        return Some(Err(format!("K{key:04}: `/{index}` is not a number of a characteristic or part")));
    };
    Some(Ok(Line { key, index, text, whole: line, start: line.len() - text.len() }))
}

/// What changes the values, if a key says that something does: an additive constant (K2071) or a factor (K2072).
pub(super) fn changes_values(key: u16, text: &str) -> Option<&'static str> {
    let (what, neutral) = match key {
        2071 => ("an additive constant of", 0.0),
        2072 => ("a factor of", 1.0),
        _ => return None,
    };
    let is_neutral = text.is_empty() || text.replace(',', ".").parse() == Ok(neutral);
    (!is_neutral).then_some(what)
}
