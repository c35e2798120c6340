//! The known words that a name is made of. Called by everything that understands names.
//!
//! A name is understood when known words cover all of it, as `Zahnstangenteilungsabweichung` is `Zahnstange`,
//! `Teilung` and `Abweichung`, and `ラックピッチ誤差` is three words without a blank.

use super::letters::fold;
use super::vocabulary::{Entry, NUMBER, VOCABULARY};

/// Longer texts are sentences, not names.
const LONGEST: usize = 160;

/// Letters that join the parts of a German compound, or make a plural.
const LINKS: [&str; 4] = ["s", "n", "es", "en"];

/// A name as folded words, and the same without the blanks between them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Words {
    pub(super) tokens: Vec<String>,
    pub(super) letters: String,
    /// Where in the letters a token starts or ends.
    edges: Vec<usize>,
}

impl Words {
    pub(super) fn of(text: &str) -> Self {
        if text.len() > LONGEST {
            return Self::default();
        }
        Self::of_tokens(fold(text).split_whitespace().map(str::to_owned).collect())
    }

    pub(super) fn of_tokens(tokens: Vec<String>) -> Self {
        let mut letters = String::new();
        let mut edges = vec![0];
        for token in &tokens {
            letters.push_str(token);
            edges.push(letters.len());
        }
        Self { tokens, letters, edges }
    }

    /// The fewest known words that make up all of the letters; `None` if some letters belong to no known word.
    pub(super) fn known(&self) -> Option<Vec<&'static Entry>> {
        let end = self.letters.len();
        // from the end: the word that starts at each place on the shortest way to the end
        let mut ways: Vec<Option<Route>> = vec![None; end + 1];
        for start in (0..end).rev().filter(|start| self.letters.is_char_boundary(*start)) {
            ways[start] = self.best_way(start, &ways);
        }
        let mut found = Vec::new();
        let mut at = 0;
        while at < end {
            let way = ways[at]?;
            found.push(way.word);
            at = way.next;
        }
        (!found.is_empty()).then_some(found)
    }

    fn best_way(&self, start: usize, ways: &[Option<Route>]) -> Option<Route> {
        let mut best: Option<Route> = None;
        let mut consider = |word: &'static Entry, next: usize| {
            let rest = if next == self.letters.len() { Some(0) } else { ways[next].map(|way| way.count) };
            let Some(rest) = rest else { return };
            if best.is_none_or(|best| (rest + 1, best.next) < (best.count, next)) {
                best = Some(Route { word, next, count: rest + 1 });
            }
        };
        let rest = &self.letters[start..];
        for word in VOCABULARY.starting_like(rest) {
            let next = start + word.letters.len();
            if !rest.starts_with(&word.letters) {
                continue;
            }
            // short words stand by themselves only; longer ones also within a compound
            if word.letters.len() > 2 || (self.is_edge(start) && self.is_edge(next)) {
                consider(word, next);
            }
            let takes_link = word.takes_link() && !self.is_edge(next);
            for link in LINKS.iter().filter(|link| takes_link && self.letters[next..].starts_with(**link)) {
                consider(word, next + link.len());
            }
        }
        let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
        if digits > 0 {
            consider(&NUMBER, start + digits);
        }
        best
    }

    fn is_edge(&self, at: usize) -> bool {
        self.edges.binary_search(&at).is_ok()
    }
}

#[derive(Debug, Clone, Copy)]
struct Route {
    word: &'static Entry,
    next: usize,
    /// Words from here to the end.
    count: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_covered_by_known_words_or_not_known() {
        let count = |text: &str| Words::of(text).known().map(|words| words.len());
        assert_eq!(count("Zahnstangenteilungsabweichung"), Some(3));
        assert_eq!(count("ラックピッチ誤差"), Some(3));
        assert_eq!(count("f p"), Some(1));
        assert_eq!(count("Pass mich"), None);
        assert_eq!(count(""), None);
        assert_eq!(count(&"Teilung".repeat(60)), None);
    }
}
