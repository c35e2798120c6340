//! Patterns of a contract: which headings and lines a rule leaves out. Knows no tables.

use std::str::Chars;

use crate::diagnostic::is_steering;

/// A text in which `*` stands for any characters and, in a rule for lines, `#` for a number, a date or a time of day. `\*`, `\#`
/// and `\\` are these characters, and `\u001b` is a character that steers a terminal, as messages show it. Case counts; blanks
/// around the text do not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    text: String,
    /// The texts before, between and behind the `*`.
    pieces: Vec<Vec<Token>>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Token {
    Text(String),
    Number,
}

impl Pattern {
    /// A pattern for headings.
    #[must_use]
    pub fn of_heading(text: &str) -> Self {
        Self::new(text, false)
    }

    /// A pattern for lines.
    #[must_use]
    pub fn of_line(text: &str) -> Self {
        Self::new(text, true)
    }

    /// Reads a pattern; with `counts`, `#` stands for a number.
    fn new(text: &str, counts: bool) -> Self {
        let text = text.trim();
        let mut pieces = vec![Vec::new()];
        let mut characters = text.chars();
        while let Some(c) = characters.next() {
            let piece = pieces.last_mut().expect("there is a first one");
            match c {
                '*' => pieces.push(Vec::new()),
                '#' if counts => piece.push(Token::Number),
                c => {
                    let c = if c == '\\' { plain(&mut characters) } else { c };
                    match piece.last_mut() {
                        Some(Token::Text(text)) => text.push(c),
                        _ => piece.push(Token::Text(c.to_string())),
                    }
                }
            }
        }
        Self { text: text.to_owned(), pieces }
    }

    /// The pattern as it is written.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether it fits one text only.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        matches!(&self.pieces[..], [only] if !only.contains(&Token::Number))
    }

    /// The first byte that every fitting text has; `None` if it may be any byte.
    #[must_use]
    pub fn first_byte(&self) -> Option<u8> {
        let Token::Text(first) = self.pieces[0].first()? else { return None };
        first.bytes().next()
    }

    /// Whether it fits a text.
    #[must_use]
    pub fn fits(&self, text: &str) -> bool {
        let text = text.trim();
        let Some(mut at) = length_of(&self.pieces[0], text) else { return false };
        let mut pieces = self.pieces[1..].iter().peekable();
        if pieces.peek().is_none() {
            return at == text.len();
        }
        // each piece follows the one before it, and the last one ends the text
        while let Some(piece) = pieces.next() {
            let is_last = pieces.peek().is_none();
            let places = text[at..].char_indices().map(|(by, _)| at + by).chain([text.len()]);
            let found = places.filter_map(|place| Some(place + length_of(piece, &text[place..])?));
            let Some(end) = found.into_iter().find(|end| !is_last || *end == text.len()) else { return false };
            at = end;
        }
        true
    }

    /// What the only `*` of a pattern without `#` stands for in a text that fits.
    pub(crate) fn left_open<'t>(&self, text: &'t str) -> Option<&'t str> {
        let [before, behind] = &self.pieces[..] else { return None };
        let (text, behind) = (text.trim(), behind.iter().map(Token::text).collect::<String>());
        let inner = text[length_of(before, text)?..].strip_suffix(&*behind)?.trim();
        (!inner.is_empty()).then_some(inner)
    }
}

impl Token {
    fn text(&self) -> &str {
        match self {
            Self::Text(text) => text,
            Self::Number => "#",
        }
    }
}

/// The characters that a backslash makes plain.
const SPECIAL: [char; 3] = ['*', '#', '\\'];

/// The character that a backslash and what is behind it stand for.
fn plain(behind: &mut Chars<'_>) -> char {
    let rest = behind.as_str();
    let code = rest.strip_prefix('u').and_then(|code| u32::from_str_radix(code.get(..4)?, 16).ok());
    let (c, taken) = match (rest.chars().next(), code.and_then(char::from_u32)) {
        (Some(next), _) if SPECIAL.contains(&next) => (next, 1),
        (_, Some(steering)) if is_steering(steering) => (steering, 5),
        _ => ('\\', 0),
    };
    behind.by_ref().take(taken).for_each(drop);
    c
}

/// The pattern for lines that fits this text only.
#[must_use]
pub(crate) fn escaped(text: &str) -> String {
    escaped_but(text, false)
}

/// The pattern for headings that fits this text only. In headings `#` is a plain character.
#[must_use]
pub(crate) fn escaped_heading(text: &str) -> String {
    escaped_but(text, true)
}

fn escaped_but(text: &str, is_heading: bool) -> String {
    let mut escaped = String::with_capacity(text.len());
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        let is_special = match c {
            '*' => true,
            '#' => !is_heading,
            '\\' => characters.peek().is_some_and(|next| SPECIAL.contains(next) || *next == 'u'),
            _ => false,
        };
        escaped.extend(is_special.then_some('\\').into_iter().chain([c]));
    }
    escaped
}

/// How many bytes at the start of a text a piece takes; `None` if it does not fit there.
fn length_of(piece: &[Token], text: &str) -> Option<usize> {
    let mut rest = text;
    for token in piece {
        rest = match token {
            Token::Number => &rest[number(rest)?..],
            Token::Text(literal) => rest.strip_prefix(literal.as_str())?,
        };
    }
    Some(text.len() - rest.len())
}

/// How many bytes the number, date or time of day at the start of a text takes.
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
            (r"U\u0007*", "U\u{7} 2", true),
            (r"C:\users\u00e4", r"C:\users\u00e4", true),
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
        for text in ["Bem*", "#17", r"C:\T\*", "***", r"\#", r"a\\*#", r"U\u0007", "25.012"] {
            let (heading, line) = (Pattern::of_heading(&escaped_heading(text)), Pattern::of_line(&escaped(text)));
            assert!(heading.is_exact() && line.is_exact() && heading.fits(text) && line.fits(text), "{text}");
        }
        assert!(!Pattern::of_line(&escaped("Bem*")).fits("Bemerkung"));
        assert!(Pattern::of_heading("Temp #").is_exact() && !Pattern::of_line("Temp #").is_exact());
        assert_eq!(
            [Pattern::of_line("# x"), Pattern::of_line("xy*")].map(|pattern| pattern.first_byte()),
            [None, Some(b'x')]
        );
    }
}
