//! Text of an input made safe to show. Called by whoever writes text: messages, tables, rows, pages.

use std::borrow::Cow;

/// Whether a character steers the program that shows it. C0, DEL and C1 move the cursor, colour, or end a line; the others turn
/// the direction of a text (U+202A to U+202E, U+2066 to U+2069) or end a line for some programs (U+2028, U+2029).
#[must_use]
pub fn is_steering(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text on one line: each character that [steers](is_steering) is written as `\u` and four hexadecimal digits, as in
/// JSON and TOML.
#[must_use]
pub fn harmless(text: &str) -> Cow<'_, str> {
    escaped(text, "")
}

/// The same for a text of several lines, whose line breaks stay.
#[must_use]
pub fn harmless_lines(text: &str) -> Cow<'_, str> {
    escaped(text, "\n")
}

/// A text in which all characters that steer are escaped but those to be kept.
pub(super) fn escaped<'t>(text: &'t str, kept: &str) -> Cow<'t, str> {
    let is_escaped = |c: char| is_steering(c) && !kept.contains(c);
    // characters that steer are below a blank, DEL, or begin with one of two bytes
    let may = |byte: u8| matches!(byte, 0..=0x1f | 0x7f | 0xc2 | 0xe2) && !kept.as_bytes().contains(&byte);
    if !text.bytes().any(may) || !text.contains(is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_escaped(c) {
            out.push_str(&format!("\\u{:04x}", u32::from(c)));
        } else {
            out.push(c);
        }
    }
    Cow::Owned(out)
}

/// Whether a spreadsheet would compute a text that it reads from CSV: one that begins with `=`, `+`, `-` or `@` and is no
/// number.
#[must_use]
pub fn is_formula(text: &str) -> bool {
    text.trim_start().strip_prefix(['=', '+', '-', '@']).is_some_and(|rest| {
        let is_plain = !rest.is_empty() && rest.chars().all(|c| c.is_ascii_digit() || matches!(c, '.' | ','));
        text.starts_with(['=', '@']) || !is_plain && text.trim().parse::<f64>().is_err()
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn what_steers_is_escaped_and_nothing_else() {
        assert_eq!(
            harmless("ä | °…\u{1b}[31m\r\n\u{7f}\u{9b}1m\u{202e}\u{2069}"),
            "ä | °…\\u001b[31m\\u000d\\u000a\\u007f\\u009b1m\\u202e\\u2069"
        );
        assert_eq!(harmless_lines("a\nb\tc"), "a\nb\\u0009c");
        assert!(matches!(harmless("Zahnstange 7, Ø 3 µm, α_n …"), Cow::Borrowed(_)));
    }

    proptest! {
        #[test]
        fn nothing_that_steers_is_left(text in any::<String>()) {
            prop_assert!(!harmless(&text).contains(is_steering));
            prop_assert!(!harmless_lines(&text).contains(|c| is_steering(c) && c != '\n'));
            if !text.contains(is_steering) {
                prop_assert_eq!(harmless(&text), text.as_str());
            }
        }
    }
}
