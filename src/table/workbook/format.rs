//! What formats show beside a number: `0.000" mm"` shows millimetres, whatever the heading says, and a font may strike
//! it through. Read from the styles of a workbook.

use std::collections::HashMap;

use calamine::{Font, Style as CellStyle};

/// How a column of numbers is shown, if not by their digits alone.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Shown {
    /// The column, from 0.
    pub(crate) column: usize,
    /// The first row in which it is so, from 1.
    pub(crate) row: u32,
    pub(crate) style: Style,
}

/// How a style shows a number.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Style {
    /// What is shown beside it.
    pub(crate) text: String,
    pub(crate) is_struck_through: bool,
    /// Whether nothing of some numbers is shown.
    pub(crate) hides: bool,
}

/// Stands for the style of a text of which a run is struck through.
pub(super) const STRUCK_RUN: u32 = u32::MAX;

/// How each style of cells shows a number, by its index; styles that show nothing but the number are left out.
pub(super) fn shown_by_style(styles: &[CellStyle]) -> HashMap<u32, Style> {
    let shown = styles.iter().map(|style| Style {
        text: style.number_format.as_ref().map_or_else(String::new, |format| beside_number(&format.format_code)),
        is_struck_through: style.font.as_ref().is_some_and(Font::has_strikethrough),
        hides: style.number_format.as_ref().is_some_and(|format| hides_numbers(&format.format_code)),
    });
    let run = Style { is_struck_through: true, ..Style::default() };
    (0..).zip(shown).filter(|(_, style)| *style != Style::default()).chain([(STRUCK_RUN, run)]).collect()
}

/// Whether a format shows nothing of the numbers above or below zero, as `;;;` does.
fn hides_numbers(code: &str) -> bool {
    let (mut sections, mut within) = (vec![false], None);
    for c in code.chars() {
        match (within, c) {
            (Some(end), c) => within = Some(end).filter(|end| c != *end),
            (None, '"') => within = Some('"'),
            (None, '[') => within = Some(']'),
            (None, ';') => sections.push(false),
            (None, c) => *sections.last_mut().expect("there is one") |= "0#?@".contains(c) || c.is_ascii_alphabetic(),
        }
    }
    !code.is_empty() && sections.iter().take(2).any(|is_shown| !is_shown)
}

/// The words and marks of a number format's part for positive numbers: `mm` of `0.000" mm";-0.000" mm"`, and what makes others of
/// them: a minus before them, a divisor, a comma behind them for thousands.
fn beside_number(code: &str) -> String {
    let mut text = String::new();
    let (mut is_quoted, mut characters) = (false, code.chars());
    let is_digit = |c: char| matches!(c, '0' | '#' | '?');
    // the first letter of a date, or digit of a number
    let mut first = None;
    while let Some(c) = characters.next() {
        let behind = || characters.as_str().split(';').next().unwrap_or_default();
        match c {
            '"' => is_quoted = !is_quoted,
            _ if is_quoted => text.push(c),
            '\\' => text.extend(characters.next()),
            // a colour, a condition, a currency
            '[' => while characters.next().is_some_and(|c| c != ']') {},
            ';' => break,
            // a blank of that width, a character that fills the cell
            '_' | '*' => _ = characters.next(),
            '%' | '<' | '>' | '°' => text.push(c),
            '-' if first.is_none() => text.push(c),
            '/' if first.is_some_and(is_digit) => text.push(c),
            ',' if first.is_some_and(is_digit) && !behind().contains(is_digit) => text.push(c),
            _ if is_digit(c) || c.is_ascii_alphabetic() => _ = first.get_or_insert(c),
            _ => {}
        }
    }
    text.trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_beside_numbers() {
        for (code, text) in [
            ("0.000\" mm\"", "mm"),
            ("0.000\\ \\µ\\m;-0.000", "µm"),
            ("[Red]0.00%", "%"),
            ("\"<\"0.0", "<"),
            ("#,##0.00_ ", ""),
            ("_-* #,##0.00_-;-* #,##0.00_-", ""),
            ("+0.000;-0.000", ""),
            ("yyyy-mm-dd", ""),
            ("d/m/yyyy, hh:mm", ""),
            ("0.0E-00", ""),
            ("-0.000", "-"),
            ("\"-\"0.000\" mm\"", "- mm"),
            ("#,##0.0,", ","),
            ("0.000/1000", "/"),
            ("General", ""),
        ] {
            assert_eq!(beside_number(code), text, "{code}");
        }
        for (code, hides) in [
            (";;;", true),
            ("0.000;;", true),
            ("\"\"", true),
            ("[Red]0.0;\"x;y\"-0.0", false),
            ("0.000;-0.000;;@", false),
            ("General", false),
            ("@", false),
            ("", false),
        ] {
            assert_eq!(hides_numbers(code), hides, "{code}");
        }
        let style = |code: Option<&str>, is_struck_through| {
            let mut style = CellStyle::default();
            style.font.get_or_insert_default().strikethrough = is_struck_through;
            if let Some(code) = code {
                code.clone_into(&mut style.number_format.get_or_insert_default().format_code);
            }
            style
        };
        let styles = [
            style(Some("General"), false),
            style(Some("0.0\" in\""), false),
            style(Some("0.00%"), false),
            style(None, true),
        ];
        let shown = [(1, "in", false), (2, "%", false), (3, "", true), (STRUCK_RUN, "", true)];
        let style = |text: &str, is_struck_through| Style { text: text.to_owned(), is_struck_through, hides: false };
        let expected = shown.map(|(index, text, is_struck)| (index, style(text, is_struck))).into();
        assert_eq!(shown_by_style(&styles), expected);
    }
}
