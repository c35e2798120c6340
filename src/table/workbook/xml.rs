//! The tags of the XML in a workbook, which comes in pieces. A tag is never kept beyond a few KiB.

/// The tags of XML that comes in pieces.
#[derive(Clone, Default)]
pub(super) struct Tags {
    /// What follows a `<`, without its `>`.
    open: Option<Vec<u8>>,
    /// The text behind the last tag, where that is a page's header or footer, or the content of a cell.
    text: Option<Vec<u8>>,
}

impl Tags {
    /// Calls `take` with each tag that ends in `piece`, without its angle brackets, and the text before it, if that is a page's header
    /// or footer, or the content of a cell.
    pub(super) fn each(&mut self, mut piece: &[u8], take: &mut dyn FnMut(&str, &str)) {
        /// No tag that is looked for is longer.
        const LONGEST: usize = 4096;
        while !piece.is_empty() {
            let Some(open) = &mut self.open else {
                let start = memchr::memchr(b'<', piece);
                if let Some(text) = &mut self.text {
                    let more = &piece[..start.unwrap_or(piece.len())];
                    text.extend_from_slice(&more[..more.len().min(LONGEST.saturating_sub(text.len()))]);
                }
                let Some(start) = start else { return };
                self.open = Some(Vec::new());
                piece = &piece[start + 1..];
                continue;
            };
            let end = memchr::memchr(b'>', piece);
            let more = &piece[..end.unwrap_or(piece.len())];
            open.extend_from_slice(&more[..more.len().min(LONGEST.saturating_sub(open.len()))]);
            let Some(end) = end else { return };
            if let Ok(tag) = std::str::from_utf8(open) {
                let text = self.text.take().unwrap_or_default();
                take(tag, &String::from_utf8_lossy(&text));
                let holds = tag == "v" || tag.ends_with(":v") || tag.ends_with("Header") || tag.ends_with("Footer");
                self.text = holds.then(Vec::new);
            }
            self.open = None;
            piece = &piece[end + 1..];
        }
    }
}

/// The name of a tag, without its prefix.
pub(super) fn name(tag: &str) -> &str {
    let end = tag.find(|c: char| c.is_ascii_whitespace() || c == '/').unwrap_or(tag.len());
    without_prefix(&tag[..end])
}

fn without_prefix(name: &str) -> &str {
    name.rsplit_once(':').map_or(name, |(_, name)| name)
}

/// The value of an attribute of a tag, as it is written; a prefix of its name does not matter.
pub(super) fn attribute<'t>(tag: &'t str, wanted: &str) -> Option<&'t str> {
    let (_, mut rest) = tag.split_once(|c: char| c.is_ascii_whitespace())?;
    loop {
        let (name, value) = rest.split_once('=')?;
        let value = value.trim_start();
        let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
        let (value, next) = value[1..].split_once(quote)?;
        if without_prefix(name.trim()) == wanted {
            return Some(value);
        }
        rest = next;
    }
}
