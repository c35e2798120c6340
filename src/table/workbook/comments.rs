//! The comments on cells of a workbook and its text boxes, which may correct a value, and its texts that are struck
//! through. Found in their XML; nothing here opens a file.

use std::collections::HashSet;

use super::xml::{attribute, name};

/// A comment on a cell, or a text box.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Comment {
    /// `comment B3`, `text box`.
    pub(crate) place: String,
    pub(crate) text: String,
}

/// What a part of a workbook says beside its cells: comments, text boxes, titles of charts, remarks on tables.
pub(super) fn comments(xml: &[u8]) -> Vec<Comment> {
    let comment = |place: String, text: &str| Comment { place, text: unescaped(text) };
    let mut found = vec![comment("drawing".to_owned(), "")];
    // in boxes of old drawings any text counts
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

/// Without comments whose text stands in another one of their cell, as old programs see it.
pub(super) fn once_each(comments: &mut Vec<Comment>) {
    let all = comments.clone();
    let is_other = |one: &Comment, other: &Comment| one.place == other.place && other.text.len() > one.text.len();
    comments.retain(|one| !all.iter().any(|other| is_other(one, other) && other.text.contains(one.text.trim())));
}

/// The texts of cells of which a run is struck through, from `xl/sharedStrings.xml`.
pub(super) fn struck_through(xml: &[u8]) -> HashSet<String> {
    let (mut struck, mut found, mut is_struck, mut is_spoken) = (HashSet::new(), String::new(), false, false);
    each_tag(xml, |tag, text| match name(tag) {
        "strike" => is_struck |= !matches!(attribute(tag, "val"), Some("0" | "false")),
        // how a text is spoken is no part of it
        "rPh" => is_spoken = true,
        "r" => is_spoken = false,
        "t" if !is_spoken => found += &unescaped(text),
        _ if tag.strip_prefix('/').is_some_and(|tag| name(tag) == "si") => {
            let text = std::mem::take(&mut found);
            if std::mem::take(&mut is_struck) {
                struck.insert(text);
            }
            is_spoken = false;
        }
        _ => {}
    });
    struck
}

/// Calls `take` with each tag and the text behind it.
fn each_tag(xml: &[u8], mut take: impl FnMut(&str, &str)) {
    let xml = String::from_utf8_lossy(xml);
    xml.split('<').skip(1).filter_map(|piece| piece.split_once('>')).for_each(|(tag, text)| take(tag, text));
}

/// A text of XML as it is meant.
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
    fn a_text_of_which_a_run_is_struck_through() {
        let xml = "<x:sst><x:si><x:t>25,012</x:t></x:si><x:si><x:r><x:rPr><x:strike val='true'/></x:rPr><x:t>25,4</x:t></x:r>\
                   <x:r><x:t>25,0</x:t></x:r><x:rPh><x:t>yomi</x:t></x:rPh></x:si>\
                   <x:si><x:r><x:rPr><x:strike val=\"0\"/></x:rPr><x:t>A</x:t></x:r></x:si></x:sst>";
        for xml in [xml.to_owned(), xml.replace("x:", "")] {
            assert_eq!(struck_through(xml.as_bytes()), HashSet::from(["25,425,0".to_owned()]));
        }
    }
}
