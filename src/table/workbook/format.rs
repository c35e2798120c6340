//! What number formats show beside a number: `0.000" mm"` shows millimetres, whatever the heading says. Read from the
//! styles of a workbook.

use std::collections::HashMap;

use super::xml::{Tags, attribute, name};

/// A unit, or another word or mark, that a column of numbers is shown with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Shown {
    /// The column, from 0.
    pub(crate) column: usize,
    /// The first row in which it is so, from 1.
    pub(crate) row: u32,
    /// What is shown.
    pub(crate) text: String,
}

/// What each style of cells shows beside a number, by its index; styles that show nothing are left out.
pub(super) fn shown_by_style(styles: &[u8]) -> HashMap<u32, String> {
    let mut formats: HashMap<u32, String> = HashMap::from([(9, "%".to_owned()), (10, "%".to_owned())]);
    let (mut shown, mut is_of_cells, mut index) = (HashMap::new(), false, 0);
    Tags::default().each(styles, &mut |tag| {
        let number = |key| attribute(tag, key).and_then(|text| text.parse::<u32>().ok());
        match name(tag) {
            _ if tag.starts_with('/') => is_of_cells &= !tag.ends_with("cellXfs"),
            "numFmt" => {
                if let (Some(id), Some(code)) = (number("numFmtId"), attribute(tag, "formatCode")) {
                    formats.insert(id, beside_number(code));
                }
            }
            "cellXfs" => is_of_cells = true,
            "xf" if is_of_cells => {
                let text = number("numFmtId").and_then(|id| formats.get(&id)).filter(|text| !text.is_empty());
                shown.extend(text.map(|text| (index, text.clone())));
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
        let styles = "<numFmts><numFmt numFmtId=\"164\" formatCode=\"0.0&quot; in&quot;\"/></numFmts><cellStyleXfs><xf numFmtId=\"9\"/>\
                      </cellStyleXfs><cellXfs><xf numFmtId=\"0\"/><xf numFmtId=\"164\"/><xf numFmtId=\"10\"/></cellXfs>";
        let expected = HashMap::from([(1, "in".to_owned()), (2, "%".to_owned())]);
        assert_eq!(shown_by_style(styles.as_bytes()), expected);
    }
}
