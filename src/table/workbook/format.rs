//! What formats show beside a number: `0.000" mm"` shows millimetres, whatever the heading says, and a font may strike
//! it through. Read from the styles of a workbook.

use std::collections::{HashMap, HashSet};

use super::xml::{Tags, attribute, name};

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
}

/// Stands for the style of a text of which a run is struck through.
pub(super) const STRUCK_RUN: u32 = u32::MAX;

/// How each style of cells shows a number, by its index; styles that show nothing but the number are left out.
pub(super) fn shown_by_style(styles: &[u8]) -> HashMap<u32, Style> {
    let mut formats: HashMap<u32, String> = HashMap::from([(9, "%".to_owned()), (10, "%".to_owned())]);
    let (mut fonts, mut struck) = (0, HashSet::new());
    let run = Style { text: String::new(), is_struck_through: true };
    let (mut shown, mut is_of_cells, mut index) = (HashMap::from([(STRUCK_RUN, run)]), false, 0);
    Tags::default().each(styles, &mut |tag| {
        let number = |key| attribute(tag, key).and_then(|text| text.parse::<u32>().ok());
        match name(tag) {
            _ if tag.starts_with('/') => is_of_cells &= !tag.ends_with("cellXfs"),
            "numFmt" => {
                if let (Some(id), Some(code)) = (number("numFmtId"), attribute(tag, "formatCode")) {
                    formats.insert(id, beside_number(code));
                }
            }
            "font" => fonts += 1,
            "strike" if !matches!(attribute(tag, "val"), Some("0" | "false")) => _ = struck.insert(fonts),
            "cellXfs" => is_of_cells = true,
            "xf" if is_of_cells => {
                let text = number("numFmtId").and_then(|id| formats.get(&id)).cloned().unwrap_or_default();
                // fonts are numbered from 0
                let is_struck_through = number("fontId").is_some_and(|font| struck.contains(&(font + 1)));
                let style = Style { text, is_struck_through };
                shown.extend(Some((index, style)).filter(|(_, style)| *style != Style::default()));
                index += 1;
            }
            _ => {}
        }
    });
    shown
}

/// The words and marks of a number format's part for positive numbers: `mm` of `0.000" mm";-0.000" mm"`, and what makes others of
/// them: a minus before them, a divisor, a comma behind them for thousands.
fn beside_number(code: &str) -> String {
    let code = code.replace("&quot;", "\"").replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
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
            ("0.000&quot; mm&quot;", "mm"),
            ("0.000\\ \\µ\\m;-0.000", "µm"),
            ("[Red]0.00%", "%"),
            ("&quot;&lt;&quot;0.0", "<"),
            ("#,##0.00_ ", ""),
            ("_-* #,##0.00_-;-* #,##0.00_-", ""),
            ("+0.000;-0.000", ""),
            ("yyyy-mm-dd", ""),
            ("d/m/yyyy, hh:mm", ""),
            ("0.0E-00", ""),
            ("-0.000", "-"),
            ("&quot;-&quot;0.000&quot; mm&quot;", "- mm"),
            ("#,##0.0,", ","),
            ("0.000/1000", "/"),
            ("General", ""),
        ] {
            assert_eq!(beside_number(code), text, "{code}");
        }
        let styles = "<fonts><font/><font><strike/></font><font><strike val=\"0\"/></font></fonts><numFmts><numFmt numFmtId=\"164\" formatCode=\"0.0&quot; in&quot;\"/></numFmts><cellStyleXfs><xf numFmtId=\"9\"/>\
                      </cellStyleXfs><cellXfs><xf numFmtId=\"0\"/><xf numFmtId=\"164\"/><xf numFmtId=\"10\" fontId=\"2\"/><xf fontId=\"1\"/></cellXfs>";
        let shown = [(1, "in", false), (2, "%", false), (3, "", true), (STRUCK_RUN, "", true)];
        let style = |text: &str, is_struck_through| Style { text: text.to_owned(), is_struck_through };
        let expected = shown.map(|(index, text, is_struck)| (index, style(text, is_struck))).into();
        assert_eq!(shown_by_style(styles.as_bytes()), expected);
    }
}
