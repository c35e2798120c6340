//! The comments on cells of a workbook and its text boxes, which may correct a value, and its texts that are struck through. Found in their XML; nothing here opens a file.

use std::collections::HashSet;

use super::xml::{attribute, name};

/// A comment on a cell, or a text box.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Comment {
    /// `comment B3`, `text box`.
    pub(crate) place: String,
    pub(crate) text: String,
}

/// The comments of a part of a workbook, `xl/comments1.xml`, or the text boxes of `xl/drawings/drawing1.xml`.
pub(super) fn comments(xml: &[u8]) -> Vec<Comment> {
    let mut found: Vec<Comment> = Vec::new();
    for piece in String::from_utf8_lossy(xml).split('<').skip(1) {
        let Some((tag, text)) = piece.split_once('>') else { continue };
        match (name(tag), attribute(tag, "ref"), found.last_mut()) {
            ("comment", Some(cell), _) => found.push(Comment { place: format!("comment {cell}"), text: String::new() }),
            ("sp", ..) => found.push(Comment { place: "text box".to_owned(), text: String::new() }),
            ("p", _, Some(shape)) => shape.text += "\n",
            ("t", _, Some(comment)) => comment.text += &unescaped(text),
            _ => {}
        }
    }
    found
}

/// The texts of cells of which a run is struck through, from `xl/sharedStrings.xml`.
pub(super) fn struck_through(xml: &[u8]) -> HashSet<String> {
    let xml = String::from_utf8_lossy(xml);
    let is_struck = |string: &&str| string.contains("<strike/>") || string.contains("<strike val=\"1\"");
    let text = |string: &str| {
        let pieces = string.split("<t").filter_map(|piece| piece.split_once('>')?.1.split_once("</t"));
        pieces.map(|(text, _)| unescaped(text)).collect::<String>()
    };
    xml.split("<si>").filter(is_struck).map(text).collect()
}

/// A text of XML as it is meant.
fn unescaped(text: &str) -> String {
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
        assert_eq!(comments(xml), [comment("B3", "Huber:\nneu < 25,061"), comment("C4", "")]);
    }
}
