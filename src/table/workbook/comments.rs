//! The comments and text boxes of a workbook, which may correct a value, and its texts and conditional formats that strike through. Found
//! in their XML; nothing here opens a file.

use std::collections::HashSet;

use super::format::Style;
use super::xml::{attribute, name};

/// A comment on a cell, or a text box.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Comment {
    /// `comment B3`, `text box`.
    pub(crate) place: String,
    pub(crate) text: String,
}

/// What a part of a workbook says besides cells: comments, text boxes, titles of charts, remarks on tables.
pub(super) fn comments(xml: &[u8]) -> Vec<Comment> {
    let comment = |place: String, text: &str| Comment { place, text: unescaped(text) };
    let mut found = vec![comment("drawing".to_owned(), "")];
    // in text boxes of old drawings every text counts
    let mut is_box = false;
    each_tag(xml, |tag, text| {
        let cell = attribute(tag, "ref");
        match (name(tag), cell, found.last_mut()) {
            ("comment" | "threadedComment", Some(cell), _) => found.push(comment(format!("comment {cell}"), "")),
            ("table", ..) => found.extend(attribute(tag, "comment").map(|text| comment("table".to_owned(), text))),
            ("sp" | "textbox", ..) => {
                is_box = name(tag) == "textbox";
                found.push(comment("text box".to_owned(), if is_box { text } else { "" }));
            }
            (other, _, Some(comment)) if is_box => {
                is_box = !(other.is_empty() && tag.ends_with("textbox"));
                comment.text += &unescaped(if is_box { text } else { "" });
            }
            ("p", _, Some(shape)) => shape.text += "\n",
            ("t" | "text", _, Some(comment)) => comment.text += &unescaped(text),
            _ => {}
        }
    });
    let trimmed = found.into_iter().map(|comment| Comment { text: comment.text.trim().to_owned(), ..comment });
    trimmed.filter(|comment| !comment.text.is_empty()).collect()
}

/// Removes comments whose text is part of another comment on the same cell, as Excel repeats a threaded comment for old programs.
pub(super) fn once_each(comments: &mut Vec<Comment>) {
    let all = comments.clone();
    let is_other = |one: &Comment, other: &Comment| one.place == other.place && other.text.len() > one.text.len();
    comments.retain(|one| !all.iter().any(|other| is_other(one, other) && other.text.contains(one.text.trim())));
}

/// The numbers of the texts of which a run is struck through, from `xl/sharedStrings.xml`.
pub(super) fn struck_through(xml: &[u8]) -> HashSet<usize> {
    let (mut struck, mut count) = (HashSet::new(), 0);
    each_tag(xml, |tag, _| match name(tag) {
        "strike" if is_on(tag) => _ = struck.insert(count),
        "si" if tag.ends_with('/') => count += 1,
        _ if tag.strip_prefix('/').is_some_and(|tag| name(tag) == "si") => count += 1,
        _ => {}
    });
    struck
}

/// What each conditional format does not show plainly, in words, from `xl/styles.xml`; `None` if it shows all plainly.
pub(super) fn conditional(xml: &[u8]) -> Vec<Option<String>> {
    let (mut formats, mut is_within) = (Vec::new(), false);
    each_tag(xml, |tag, _| match (name(tag), tag.strip_prefix('/').map(name)) {
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

/// Calls `take` with each tag and the text behind it.
fn each_tag(xml: &[u8], mut take: impl FnMut(&str, &str)) {
    let xml = String::from_utf8_lossy(xml);
    xml.split('<').skip(1).filter_map(|piece| piece.split_once('>')).for_each(|(tag, text)| take(tag, text));
}

/// A text of XML without its escapes.
pub(super) fn unescaped(text: &str) -> String {
    [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&apos;", "'"), ("&#10;", "\n"), ("&amp;", "&")]
        .into_iter()
        .fold(text.to_owned(), |text, (escape, meant)| text.replace(escape, meant))
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
                   <x:si><x:r><x:rPr><x:strike val=\"0\"/></x:rPr><x:t>A</x:t></x:r></x:si></x:sst>";
        for xml in [xml.to_owned(), xml.replace("x:", "")] {
            assert_eq!(struck_through(xml.as_bytes()), HashSet::from([2]));
        }
        let styles = "<styleSheet><fonts><font><strike/></font></fonts><dxfs><dxf><font><color/></font></dxf><dxf/>\
                      <dxf><font><strike/></font></dxf><dxf><numFmt numFmtId='9' formatCode='&quot;n.i.O.&quot;'/></dxf>\
                      <dxf><numFmt numFmtId='8' formatCode='0.00'/></dxf></dxfs></styleSheet>";
        let found: Vec<_> = conditional(styles.as_bytes()).into_iter().map(Option::unwrap_or_default).collect();
        assert_eq!(found, ["", "", "strikes through", "shows as \"n.i.O.\"", ""]);
    }
}
