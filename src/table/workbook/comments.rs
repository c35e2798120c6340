//! The comments and text boxes of a workbook, which may correct a value, and its texts and conditional formats that strike through. Found
//! in their XML; nothing here opens a file.

use std::collections::{HashMap, HashSet};

use super::format::Style;
use super::xml::{attribute, each_tag, ended, name, unescaped};

/// A comment on a cell, or a text box.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Comment {
    /// `comment B3`, `text box`.
    pub(crate) place: String,
    pub(crate) text: String,
}

/// What a part of a workbook says besides cells: comments, text boxes, titles of charts, remarks on tables.
pub(super) fn comments(xml: &[u8]) -> Vec<Comment> {
    let comment = |place: &str, text: String| Comment { place: place.to_owned(), text };
    let mut found = vec![comment("drawing", String::new())];
    // in text boxes of old drawings every text counts
    let mut is_box = false;
    each_tag(xml, |tag, text| {
        if let Some(comment) = found.last_mut().filter(|_| is_box || matches!(ended(tag), Some("t" | "text"))) {
            comment.text += &unescaped(text);
        }
        is_box &= ended(tag) != Some("textbox");
        match (name(tag), attribute(tag, "ref"), found.last_mut()) {
            ("comment" | "threadedComment", Some(cell), _) => {
                found.push(comment(&format!("comment {cell}"), String::new()));
            }
            ("table", ..) => {
                found.extend(attribute(tag, "comment").map(|text| comment("table", unescaped(text))));
            }
            ("sp" | "textbox", ..) => {
                is_box = name(tag) == "textbox" && !tag.ends_with('/');
                found.push(comment("text box", String::new()));
            }
            ("p", _, Some(shape)) => shape.text += "\n",
            _ => {}
        }
    });
    let trimmed = found.into_iter().map(|comment| Comment { text: comment.text.trim().to_owned(), ..comment });
    trimmed.filter(|comment| !comment.text.is_empty()).collect()
}

/// The words of a page header, without codes for places, fonts and fields such as the page number.
pub(super) fn said_in_header(text: &str) -> String {
    let (mut said, mut rest) = (String::new(), text);
    while let Some((before, code)) = rest.split_once('&') {
        said += before;
        let mut characters = code.chars();
        rest = match characters.next() {
            Some('"') => characters.as_str().split_once('"').map_or("", |(_, rest)| rest),
            Some('K') => characters.as_str().get(6..).unwrap_or_default(),
            Some('0'..='9') => code.trim_start_matches(|c: char| c.is_ascii_digit()),
            _ => characters.as_str(),
        };
        said.push(' ');
    }
    said += rest;
    let has_words = said.contains(char::is_alphanumeric);
    if has_words { said.split_whitespace().collect::<Vec<_>>().join(" ") } else { String::new() }
}

/// How a run of a text is shown, if not plainly.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Run {
    /// Raised or lowered, as the `2` of `mm²` is: no digit of a number.
    Raised,
    Struck,
}

impl Run {
    /// How a tag says that its run is shown.
    pub(super) fn of(tag: &str) -> Option<Self> {
        match (name(tag), attribute(tag, "val")) {
            ("strike", _) if is_on(tag) => Some(Self::Struck),
            ("vertAlign", Some("superscript" | "subscript")) => Some(Self::Raised),
            _ => None,
        }
    }
}

/// The texts of which a run is not shown plainly, by their numbers, from `xl/sharedStrings.xml`.
pub(super) fn odd_runs(xml: &[u8]) -> HashMap<usize, Run> {
    let (mut odd, mut count) = (HashMap::new(), 0);
    each_tag(xml, |tag, _| {
        if let Some(run) = Run::of(tag) {
            let known = odd.entry(count).or_insert(run);
            *known = run.max(*known);
        }
        count += usize::from(ended(tag) == Some("si") || name(tag) == "si" && tag.ends_with('/'));
    });
    odd
}

/// What each conditional format does not show plainly, in words, from `xl/styles.xml`; `None` if it shows all plainly.
pub(super) fn conditional(xml: &[u8]) -> Vec<Option<String>> {
    let (mut formats, mut is_within) = (Vec::new(), false);
    each_tag(xml, |tag, _| match (name(tag), ended(tag)) {
        ("dxfs", _) => is_within = !tag.ends_with('/'),
        (_, Some("dxfs")) => is_within = false,
        ("dxf", _) if is_within => formats.push(None),
        _ => {
            let shows = shows_otherwise(tag).filter(|_| is_within);
            if let (Some(shows), Some(format)) = (shows, formats.last_mut()) {
                *format = Some(shows);
            }
        }
    });
    formats
}

/// What programs read differently in `xl/styles.xml`: two number formats of one number, a font that is not there.
pub(super) fn odd_styles(xml: &[u8]) -> Option<&'static str> {
    let (mut formats, mut fonts, mut list, mut odd) = (HashSet::new(), 0, String::new(), None);
    each_tag(xml, |tag, _| match (name(tag), list.as_str()) {
        (part @ ("numFmts" | "fonts" | "cellXfs" | "cellStyleXfs" | "dxfs"), _) => part.clone_into(&mut list),
        ("numFmt", "numFmts") => {
            let is_new = attribute(tag, "numFmtId").is_some_and(|number| formats.insert(number.to_owned()));
            odd = odd.or((!is_new).then_some("two number formats of one number"));
        }
        ("font", "fonts") => fonts += 1,
        ("xf", "cellXfs") => {
            let is_there = |font: &str| font.parse::<usize>().is_ok_and(|font| font < fonts);
            odd = odd.or(attribute(tag, "fontId")
                .filter(|font| !is_there(font))
                .map(|_| "a style of a font that is not there"));
        }
        _ => {}
    });
    odd
}

/// What a tag of a format does not show plainly, in words.
pub(super) fn shows_otherwise(tag: &str) -> Option<String> {
    match name(tag) {
        "strike" if is_on(tag) => Some("strikes through".to_owned()),
        "numFmt" => {
            let code = unescaped(attribute(tag, "formatCode")?);
            Style::of_code(&code, false).map(|_| format!("shows as {code}"))
        }
        _ => None,
    }
}

/// Whether a tag is on: it is, unless its `val` says otherwise.
pub(super) fn is_on(tag: &str) -> bool {
    !matches!(attribute(tag, "val"), Some("0" | "false"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_runs_of_a_comment_are_one_text() {
        let xml = b"<comments><authors><author>Huber</author></authors><commentList><comment ref=\"B3\" authorId=\"0\"><text>\
                    <r><rPr><b/></rPr><t>Huber:</t></r><r><t xml:space=\"preserve\">\nneu &lt; 25,061</t></r></text></comment>\
                    <comment ref='C4'><text><t/></text></comment></commentList></comments>";
        let comment = |cell: &str, text: &str| Comment { place: format!("comment {cell}"), text: text.to_owned() };
        assert_eq!(comments(xml), [comment("B3", "Huber:\nneu < 25,061")]);
    }

    #[test]
    fn texts_and_conditions_that_strike_through() {
        let xml = "<x:sst><x:si><x:t>25,012</x:t></x:si><x:si/><x:si><x:r><x:rPr><x:strike val='true'/></x:rPr><x:t>25,4</x:t></x:r>\
                   <x:r><x:t>25,0</x:t></x:r><x:rPh><x:t>yomi</x:t></x:rPh></x:si>\
                   <x:si><x:r><x:rPr><x:strike val=\"0\"/><x:vertAlign val='subscript'/></x:rPr><x:t>A</x:t></x:r></x:si></x:sst>";
        for xml in [xml.to_owned(), xml.replace("x:", "")] {
            assert!(odd_runs(xml.as_bytes()) == HashMap::from([(2, Run::Struck), (3, Run::Raised)]));
        }
        let styles = "<styleSheet><fonts><font><strike/></font></fonts><dxfs><dxf><font><color/></font></dxf><dxf/>\
                      <dxf><font><strike/></font></dxf><dxf><numFmt numFmtId='9' formatCode='&quot;n.i.O.&quot;'/></dxf>\
                      <dxf><numFmt numFmtId='8' formatCode='0.00'/></dxf></dxfs></styleSheet>";
        let found: Vec<_> = conditional(styles.as_bytes()).into_iter().map(Option::unwrap_or_default).collect();
        assert_eq!(found, ["", "", "strikes through", "shows as \"n.i.O.\"", ""]);
    }
}
