//! The tags of the XML in a workbook, which comes in pieces. A tag is never kept beyond the longest record.

use std::borrow::Cow;

use crate::table::chunk::LONGEST_RECORD;

/// Where programs read XML differently: comments, entities of its own, an encoding, tags or texts of great length.
pub(super) const ODD: &str = "comments, an encoding or the like, which programs read differently";

/// The tags of XML that comes in pieces.
#[derive(Clone, Default)]
pub(super) struct Tags {
    /// What follows a `<`, without its `>`.
    tag: Vec<u8>,
    is_open: bool,
    /// The quotation mark of the value that is read.
    quote: Option<u8>,
    /// The text behind the last tag.
    text: Vec<u8>,
}

impl Tags {
    /// Calls `take` with each tag that ends in `piece`, without its angle brackets, and the text before it. A tag that is too long, or
    /// whose text is, comes as `!`.
    pub(super) fn each(&mut self, mut piece: &[u8], take: &mut dyn FnMut(&str, &str)) {
        while !piece.is_empty() {
            if !self.is_open {
                let start = memchr::memchr(b'<', piece);
                keep(&mut self.text, &piece[..start.unwrap_or(piece.len())]);
                let Some(start) = start else { return };
                self.is_open = true;
                piece = &piece[start + 1..];
                continue;
            }
            // a quoted value may hold what ends a tag, and a comment any quotation mark
            let end = match self.quote {
                Some(quote) => memchr::memchr(quote, piece),
                None if self.tag.first().or(piece.first()) == Some(&b'!') => memchr::memchr(b'>', piece),
                None => memchr::memchr3(b'>', b'"', b'\'', piece),
            };
            let Some(end) = end else { return keep(&mut self.tag, piece) };
            let is_quote = piece[end] != b'>' || self.quote.is_some();
            keep(&mut self.tag, &piece[..end + usize::from(is_quote)]);
            if is_quote {
                self.quote = if self.quote.is_some() { None } else { Some(piece[end]) };
            } else {
                let is_too_long = self.tag.len().max(self.text.len()) > LONGEST_RECORD;
                let tag = if is_too_long { Cow::Borrowed("!") } else { lossy(&self.tag) };
                take(&tag, &lossy(&self.text));
                self.tag.clear();
                self.text.clear();
                self.is_open = false;
            }
            piece = &piece[end + 1..];
        }
    }
}

/// The text of some bytes. Nearly all are UTF-8, which is seen faster by itself.
fn lossy(bytes: &[u8]) -> Cow<'_, str> {
    std::str::from_utf8(bytes).map_or_else(|_| String::from_utf8_lossy(bytes), Cow::Borrowed)
}

/// Keeps what may be one byte too long.
fn keep(kept: &mut Vec<u8>, more: &[u8]) {
    let room = (LONGEST_RECORD + 1).saturating_sub(kept.len());
    kept.extend_from_slice(&more[..more.len().min(room)]);
}

/// Calls `take` with each tag of some XML and the text before it.
pub(super) fn each_tag(xml: &[u8], mut take: impl FnMut(&str, &str)) {
    Tags::default().each(xml, &mut take);
}

/// Whether a tag is one that programs read differently.
pub(super) fn is_odd(tag: &str) -> bool {
    let encoding = if tag.starts_with("?xml") { attribute(tag, "encoding") } else { None };
    tag.starts_with('!')
        || tag.as_bytes().contains(&0)
        || encoding.is_some_and(|name| !name.eq_ignore_ascii_case("utf-8"))
}

/// The name of a tag, without its prefix.
pub(super) fn name(tag: &str) -> &str {
    let end = tag.bytes().position(|byte| byte.is_ascii_whitespace() || byte == b'/').unwrap_or(tag.len());
    without_prefix(&tag[..end])
}

/// The name of the element that a tag ends.
pub(super) fn ended(tag: &str) -> Option<&str> {
    tag.strip_prefix('/').map(name)
}

fn without_prefix(name: &str) -> &str {
    name.bytes().rposition(|byte| byte == b':').map_or(name, |at| &name[at + 1..])
}

/// The value of an attribute of a tag, as it is written; a prefix of its name does not matter.
pub(super) fn attribute<'t>(tag: &'t str, wanted: &str) -> Option<&'t str> {
    attributes(tag).find(|(name, _)| *name == wanted).map(|(_, value)| value)
}

/// The attributes of a tag, each a name without its prefix and a value as it is written.
pub(super) fn attributes(tag: &str) -> impl Iterator<Item = (&str, &str)> {
    let mut rest = tag.split_once(|c: char| c.is_ascii_whitespace()).map_or("", |(_, rest)| rest);
    std::iter::from_fn(move || {
        let (name, value) = split_at(rest, b'=')?;
        let value = value.trim_start();
        let quote = value.bytes().next().filter(|byte| matches!(byte, b'"' | b'\''))?;
        let (value, next) = split_at(&value[1..], quote)?;
        rest = next;
        Some((without_prefix(name.trim()), value))
    })
}

/// A short text before and behind a byte of ASCII.
fn split_at(text: &str, byte: u8) -> Option<(&str, &str)> {
    let at = text.bytes().position(|other| other == byte)?;
    Some((&text[..at], &text[at + 1..]))
}

/// A text of XML as it is meant.
pub(super) fn unescaped(text: &str) -> String {
    let mut pieces = text.split('&');
    let mut meant = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (entity, rest) = piece.split_once(';').unwrap_or_default();
        let number = entity.strip_prefix('#').and_then(|number| match number.strip_prefix('x') {
            Some(number) => u32::from_str_radix(number, 16).ok(),
            None => number.parse().ok(),
        });
        let character = match entity {
            "lt" => Some('<'),
            "gt" => Some('>'),
            "quot" => Some('"'),
            "apos" => Some('\''),
            "amp" => Some('&'),
            _ => number.and_then(char::from_u32),
        };
        match character {
            Some(character) => meant.push(character),
            None => meant.push('&'),
        }
        meant += if character.is_some() { rest } else { piece };
    }
    meant
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_and_texts_whatever_the_pieces() {
        let xml = "<?xml version='1.0'?><a b=\"1 > 2\" c='\"'>x &gt; y</a><!-- don't --><d/>";
        let expected = ["?xml version='1.0'?|", "a b=\"1 > 2\" c='\"'|", "/a|x &gt; y", "!-- don't --|", "d/|"];
        for length in [1, 3, 7, xml.len()] {
            let (mut tags, mut found) = (Tags::default(), Vec::new());
            for piece in xml.as_bytes().chunks(length) {
                tags.each(piece, &mut |tag, text| found.push(format!("{tag}|{text}")));
            }
            assert_eq!(found, expected, "in pieces of {length}");
        }
        assert_eq!(attribute("a b=\"1 > 2\" c='\"'", "c"), Some("\""));
        let mut long = Vec::new();
        each_tag(format!("<a b='{}'>", "x".repeat(LONGEST_RECORD)).as_bytes(), |tag, _| long.push(tag.to_owned()));
        assert_eq!(long, ["!"]);
    }

    #[test]
    fn entities_are_what_they_mean() {
        assert_eq!(unescaped("a &lt; b &amp;amp; &#10;&#xE4; & &foo; 1;"), "a < b &amp; \nä & &foo; 1;");
    }

    #[test]
    fn what_programs_read_differently() {
        for (tag, odd) in [
            ("?xml version='1.0' encoding=\"UTF-8\"", false),
            ("?xml version='1.0' encoding='windows-1252'", true),
            ("!--", true),
            ("\0r\0o\0w", true),
            ("row", false),
        ] {
            assert_eq!(is_odd(tag), odd, "{tag}");
        }
    }
}
