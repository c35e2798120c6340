//! Lines that are no parts: what they have in common, and how they differ from the names of parts.

use std::collections::{BTreeMap, HashSet};

use crate::table::block::Block;
use crate::table::ledger::digest;
use crate::table::pattern::{Pattern, escaped};

/// Names of parts that are looked at, at most.
const MOST_SEEN: usize = 1000;

/// Names of parts among which one that is there twice is found: as many as in a batch.
const MOST_NAMES: usize = 100_000;

/// What the names of parts look like.
#[derive(Debug, Default)]
pub(crate) struct Shapes {
    of_names: HashSet<String>,
    /// How many names these are of.
    seen: usize,
    /// The first names, as digests.
    names: HashSet<u64>,
    /// The first name that is there twice.
    pub(crate) twice: Option<String>,
    /// Names without a digit that are there more than once, and how often.
    pub(crate) words: BTreeMap<String, u64>,
}

impl Shapes {
    /// Adds the names of the parts in a block.
    pub(crate) fn add(&mut self, block: &Block, rejected: &HashSet<usize>) {
        let names = (0..block.rows()).filter(|row| !rejected.contains(row)).filter_map(|row| block.name(row));
        names.for_each(|name| self.add_name(&name));
    }

    /// Adds the name of a part.
    pub(crate) fn add_name(&mut self, name: &str) {
        const MOST_WORDS: usize = 20;
        self.see(name);
        let digest = digest(0, 0, name.as_bytes());
        let is_new =
            if self.names.len() < MOST_NAMES { self.names.insert(digest) } else { !self.names.contains(&digest) };
        if !name.is_empty() && !is_new {
            if !name.contains(|c: char| c.is_numeric())
                && (self.words.len() < MOST_WORDS || self.words.contains_key(name))
            {
                *self.words.entry(name.to_owned()).or_insert(1) += 1;
            }
            self.twice.get_or_insert_with(|| name.to_owned());
        }
    }

    /// Adds what the name of a part looks like, if there is room.
    pub(crate) fn see(&mut self, name: &str) {
        if self.seen < MOST_SEEN {
            self.seen += 1;
            self.of_names.insert(shape(name));
        }
    }

    /// Whether no name was looked at.
    pub(crate) fn is_empty(&self) -> bool {
        self.of_names.is_empty()
    }

    /// Whether no more names are looked at.
    pub(crate) fn is_full(&self) -> bool {
        self.seen >= MOST_SEEN
    }

    /// Whether a text looks like the name of a part.
    pub(crate) fn has(&self, text: &str) -> bool {
        self.of_names.contains(&shape(text))
    }
}

/// The start of a text with one sign for each run of letters and of digits.
fn shape(text: &str) -> String {
    const LOOKED_AT: usize = 200;
    let kind = |c: char| match c {
        c if c.is_alphabetic() => 'a',
        c if c.is_numeric() => '9',
        c => c,
    };
    let mut shape: Vec<char> = text.trim().chars().take(LOOKED_AT).map(kind).collect();
    shape.dedup();
    shape.into_iter().collect()
}

/// A line with `#` for each number.
pub(crate) fn generalised(text: &str) -> String {
    let mut pattern = String::new();
    let mut rest = text.trim();
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        pattern += &escaped(&rest[..start]);
        // digits within a word stay as they are
        let is_word = pattern.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let run = &rest[start..];
        let length = run.find(|c: char| !c.is_ascii_digit() && !".,:/-".contains(c)).unwrap_or(run.len());
        let digits = run[..length].trim_end_matches(|c: char| !c.is_ascii_digit());
        pattern += if is_word { digits } else { "#" };
        rest = &run[digits.len()..];
    }
    fitting(pattern + &escaped(rest), text)
}

/// The pattern, if it fits its own text; otherwise the one that fits that text only.
fn fitting(pattern: String, text: &str) -> String {
    if Pattern::of_line(&pattern).fits(text) { pattern } else { escaped(text.trim()) }
}

/// The pattern of two lines: `#` where their numbers differ, or else their common first words and `*`; `None` if they have none.
pub(crate) fn common(one: &str, other: &str) -> Option<String> {
    if one == other || Pattern::of_line(one).fits(other) {
        return Some(one.to_owned());
    }
    let pattern = generalised(one);
    if Pattern::of_line(&pattern).fits(other) {
        return Some(pattern);
    }
    let alike = one.char_indices().zip(other.chars()).take_while(|((_, a), b)| a == b).last();
    let start = &one[..alike.map_or(0, |((at, c), _)| at + c.len_utf8())];
    let label = &start[..start.rfind([' ', ';', ':', '\t']).map_or(0, |at| at + 1)];
    label.chars().any(char::is_alphabetic).then(|| format!("{}*", escaped(label)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_lines_are_left_open() {
        for (text, pattern) in [
            ("Prüfprotokoll 7", "Prüfprotokoll #"),
            ("Datum: 12.03.2026;9:12", "Datum: #;#"),
            ("CHR_017 ok", "CHR_017 ok"),
            ("Max;25,012", "Max;#"),
            ("Los # 7", r"Los \# #"),
            ("", ""),
        ] {
            assert_eq!(generalised(text), pattern);
            assert!(Pattern::of_line(pattern).fits(text), "{text}");
        }
    }

    #[test]
    fn lines_are_generalised_where_they_differ() {
        for (one, other, pattern) in [
            ("Prüfer: Huber", "Prüfer: Meier", Some("Prüfer: *")),
            ("Prüfer;Huber", "Prüfer;Hofer", Some("Prüfer;*")),
            ("Datum: 12.03.2026", "Datum: 13.03.2026", Some("Datum: #")),
            ("Datum: #", "Datum: 13.03.2026", Some("Datum: #")),
            ("Werk Ulm", "Werk Ulm", Some("Werk Ulm")),
            ("Ulm", "Bern", None),
            ("12 Teile", "1x Teile", None),
        ] {
            assert_eq!(common(one, other).as_deref(), pattern, "{one} {other}");
        }
    }

    #[test]
    fn the_first_names_are_kept() {
        let mut shapes = Shapes::default();
        (0..MOST_NAMES + 5000).for_each(|part| shapes.add_name(&format!("P{part}")));
        assert_eq!((shapes.names.len(), &shapes.twice), (MOST_NAMES, &None));
        shapes.add_name("P7");
        assert_eq!(shapes.twice.as_deref(), Some("P7"));
    }

    #[test]
    fn names_of_parts_have_few_shapes() {
        assert_eq!([shape("P1"), shape("Teil 12-a"), shape("Mittelwert")], ["a9", "a 9-a", "a"]);
        assert_eq!(shape(&"a1".repeat(5000)).len(), 200);
    }
}
