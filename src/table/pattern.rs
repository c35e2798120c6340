//! Patterns of a contract: what a heading or a line looks like that a rule leaves out. Knows no tables.

/// A text in which `*` stands for any characters and, in a rule for lines, `#` for a number, a date or a time of day. Case
/// counts; outer blanks do not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    text: String,
    /// Whether `#` is a number.
    counts: bool,
}

impl Pattern {
    /// A pattern for headings.
    #[must_use]
    pub fn of_heading(text: &str) -> Self {
        Self { text: text.trim().to_owned(), counts: false }
    }

    /// A pattern for lines.
    #[must_use]
    pub fn of_line(text: &str) -> Self {
        Self { text: text.trim().to_owned(), counts: true }
    }

    /// The pattern as it is written.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether it fits one text only.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        !(self.text.contains('*') || self.counts && self.text.contains('#'))
    }

    /// The first byte of every text that it fits; `None` if that may be any.
    #[must_use]
    pub fn first_byte(&self) -> Option<u8> {
        let first = *self.text.as_bytes().first()?;
        (first != b'*' && !(self.counts && first == b'#')).then_some(first)
    }

    /// Whether it fits a text.
    #[must_use]
    pub fn fits(&self, text: &str) -> bool {
        let text = text.trim();
        let mut pieces = self.text.split('*');
        let first = pieces.next().unwrap_or_default();
        let Some(mut at) = self.piece(first, text) else { return false };
        let mut pieces = pieces.peekable();
        if pieces.peek().is_none() {
            return at == text.len();
        }
        // each piece stands behind the one before it, the last one at the end
        while let Some(piece) = pieces.next() {
            let is_last = pieces.peek().is_none();
            let places = text[at..].char_indices().map(|(by, _)| at + by).chain([text.len()]);
            let found = places.filter_map(|place| Some(place + self.piece(piece, &text[place..])?));
            let Some(end) = found.into_iter().find(|end| !is_last || *end == text.len()) else { return false };
            at = end;
        }
        true
    }

    /// What the one `*` of a pattern without `#` stands for in a text that it fits.
    pub(crate) fn left_open<'t>(&self, text: &'t str) -> Option<&'t str> {
        let (before, behind) = self.text.split_once('*')?;
        let inner = text.trim().strip_prefix(before)?.strip_suffix(behind)?.trim();
        (!inner.is_empty()).then_some(inner)
    }

    /// How many bytes at the start of a text a piece without `*` fits.
    fn piece(&self, piece: &str, text: &str) -> Option<usize> {
        let mut rest = text;
        for (index, literal) in piece.split('#').enumerate() {
            if self.counts && index > 0 {
                rest = &rest[number(rest)?..];
            } else if index > 0 {
                rest = rest.strip_prefix('#')?;
            }
            rest = rest.strip_prefix(literal)?;
        }
        Some(text.len() - rest.len())
    }
}

/// The bytes of the number, the date or the time of day at the start of a text.
fn number(text: &str) -> Option<usize> {
    let is_within = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | ':' | '/' | '-');
    let unsigned = text.strip_prefix(['+', '-', '\u{2212}']).unwrap_or(text);
    let run = unsigned.find(|c| !is_within(c)).map_or(unsigned, |end| &unsigned[..end]);
    let digits = run.trim_end_matches(|c: char| !c.is_ascii_digit());
    digits.starts_with(|c: char| c.is_ascii_digit()).then(|| text.len() - unsigned.len() + digits.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_patterns_fit() {
        for (pattern, text, fits) in [
            ("Temp*", "Temperatur [°C]", true),
            ("temp", "Temperatur", false),
            ("*wert", "Mittelwert", true),
            ("M*w*t", "Mittelwert", true),
            ("*", "", true),
            ("a*b", "ab", true),
            ("a*b", "a", false),
            ("a*b", "abb", true),
            ("Bemerkung", " Bemerkung ", true),
            ("Charge #", "Charge 7", false),
            ("Charge #", "Charge #", true),
        ] {
            assert_eq!(Pattern::of_heading(pattern).fits(text), fits, "{pattern} {text}");
        }
        for (pattern, text, fits) in [
            ("Datum: #", "Datum: 12.03.2026", true),
            ("Datum: #", "Datum: 12.03.2026 9:12", false),
            ("Datum: # #", "Datum: 12.03.2026 9:12", true),
            ("Datum: #", "Datum: gestern", false),
            ("Mittelwert;*", "Mittelwert;25,008;0,9", true),
            ("# Teile*", "12 Teile gemessen", true),
            ("Seite # von #", "Seite 1 von 2", true),
            ("Seite # von #", "Seite 1 von 2a", false),
            ("T #.", "T -3.", true),
        ] {
            assert_eq!(Pattern::of_line(pattern).fits(text), fits, "{pattern} {text}");
        }
        assert!(Pattern::of_heading("Temp #").is_exact() && !Pattern::of_line("Temp #").is_exact());
        assert_eq!(
            [Pattern::of_line("# x"), Pattern::of_line("xy*")].map(|pattern| pattern.first_byte()),
            [None, Some(b'x')]
        );
    }
}
