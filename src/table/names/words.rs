//! The letters of a name and the known words that it is made of. Called by everything that understands names.
//!
//! Blanks, `_`, `-`, case and accents tell nothing: `Rack-Pitch`, `rackPitch` and `RACK PITCH` are the same letters.
//! A name is understood when known words cover all of it, as `Zahnstangenteilungsabweichung` is `Zahnstange`,
//! `Teilung` and `Abweichung`, and `ラックピッチ誤差` is three words without a blank.

use super::vocabulary::{Entry, NUMBER, VOCABULARY};

/// Longer texts are sentences, not names.
const LONGEST: usize = 160;

/// Letters that join the parts of a German compound, or make a plural.
const LINKS: [&str; 4] = ["s", "n", "es", "en"];

/// A name as folded words, and the same without the blanks between them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Words {
    pub(super) tokens: Vec<String>,
    letters: String,
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

    pub(super) fn letters(&self) -> &str {
        &self.letters
    }

    /// The fewest known words that make up all of the letters; `None` if some letters belong to no known word.
    pub(super) fn known(&self) -> Option<Vec<&'static Entry>> {
        let end = self.letters.len();
        // from the end: the word that starts at each place on the shortest way to the end
        let mut ways: Vec<Option<Way>> = vec![None; end + 1];
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

    fn best_way(&self, start: usize, ways: &[Option<Way>]) -> Option<Way> {
        let mut best: Option<Way> = None;
        let mut consider = |word: &'static Entry, next: usize| {
            let rest = if next == self.letters.len() { Some(0) } else { ways[next].map(|way| way.count) };
            let Some(rest) = rest else { return };
            if best.is_none_or(|best| (rest + 1, best.next) < (best.count, next)) {
                best = Some(Way { word, next, count: rest + 1 });
            }
        };
        let rest = &self.letters[start..];
        for word in VOCABULARY.starting_like(rest) {
            let next = start + word.letters.len();
            if !rest.starts_with(&word.letters) {
                continue;
            }
            if self.may_stand(word, start, next) {
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

    /// Short words stand by themselves only; longer ones also within a compound.
    fn may_stand(&self, word: &Entry, start: usize, next: usize) -> bool {
        let within = word.letters.len() > 2;
        within || (self.is_edge(start) && self.is_edge(next))
    }

    fn is_edge(&self, at: usize) -> bool {
        self.edges.binary_search(&at).is_ok()
    }
}

#[derive(Debug, Clone, Copy)]
struct Way {
    word: &'static Entry,
    next: usize,
    /// Words from here to the end.
    count: usize,
}

/// A text in lower case, without accents, with blanks between words and nothing but letters and digits in them.
pub(super) fn fold(text: &str) -> String {
    let chars: Vec<char> = plain_widths(text).replace("(s)", "s").chars().collect();
    let mut out = String::with_capacity(text.len() + 8);
    for (index, &c) in chars.iter().enumerate() {
        let before = index.checked_sub(1).map(|index| chars[index]);
        let after = chars.get(index + 1).copied();
        if before.is_some_and(|before| starts_word(before, c)) {
            out.push(' ');
        }
        match c {
            '+' if after == Some('/') || after == Some('-') => out.push_str(" ± "),
            '±' => out.push_str(" ± "),
            '+' => out.push_str(" + "),
            '-' | '\u{2212}' | '\u{2013}' if is_sign(before, after) => out.push_str(" - "),
            '#' => out.push_str(" # "),
            c => fold_letter(c, &mut out),
        }
    }
    // an umlaut may be written as two letters
    out.replace("ae", "a").replace("oe", "o").replace("ue", "u")
}

/// A text as names are compared that are no words of the vocabulary: folded, with a blank between words.
pub(super) fn joined(text: &str) -> String {
    fold(text).replace(['_', '-'], " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Whether a capital follows a small letter (`rackPitch`), or a digit a letter or the reverse.
fn starts_word(before: char, c: char) -> bool {
    (before.is_lowercase() && c.is_uppercase())
        || (before.is_alphabetic() && c.is_ascii_digit())
        || (before.is_ascii_digit() && c.is_alphabetic())
}

/// Whether a dash is a minus rather than a hyphen: `-Tol`, `- Tol`, `Tol -`, `Tol-`.
fn is_sign(before: Option<char>, after: Option<char>) -> bool {
    let blank = |c: Option<char>| c.is_none_or(|c| c.is_whitespace() || matches!(c, '[' | '('));
    let last = after.is_none_or(|c| matches!(c, '[' | '('));
    match before {
        None => true,
        Some('/' | '+') => false,
        before if blank(before) => !blank(after) || last,
        _ => blank(after),
    }
}

fn fold_letter(c: char, out: &mut String) {
    for c in c.to_lowercase() {
        match c {
            'à' | 'á' | 'â' | 'ä' => out.push('a'),
            'è' | 'é' | 'ê' | 'ë' => out.push('e'),
            'î' | 'ï' | 'í' => out.push('i'),
            'ô' | 'ö' | 'ó' | 'œ' => out.push('o'),
            'ù' | 'û' | 'ü' | 'ú' => out.push('u'),
            'ç' => out.push('c'),
            'ß' => out.push_str("ss"),
            'α' => out.push_str("alpha"),
            'β' => out.push_str("beta"),
            'δ' | '∆' => out.push_str("delta "),
            '№' => out.push_str("no"),
            // ローラ and ローラー are the same word; accents that follow their letter say nothing either
            'ー' | '\u{300}'..='\u{36f}' => {}
            c if c.is_alphanumeric() => out.push(c),
            _ => out.push(' '),
        }
    }
}

/// Full-width letters as plain ones, half-width katakana as full ones, their marks joined to them.
pub(super) fn plain_widths(text: &str) -> String {
    const KATAKANA: &str = "ヲァィゥェォャュョッーアイウエオカキクケコサシスセソタチツテトナニヌネノハヒフヘホマミムメモヤユヨラリルレロワン";
    let katakana = |c: char| KATAKANA.chars().nth(c as usize - 0xff66);
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\u{ff9e}' | '\u{3099}' | '\u{ff9f}' | '\u{309a}' => {
                let step = if matches!(c, '\u{ff9e}' | '\u{3099}') { 1 } else { 2 };
                let last = out.chars().next_back().filter(|last| ('\u{3041}'..='\u{30ff}').contains(last));
                if let Some(joined) = last.and_then(|last| char::from_u32(last as u32 + step)) {
                    out.pop();
                    out.push(joined);
                }
            }
            '\u{ff01}'..='\u{ff5e}' => out.extend(char::from_u32(c as u32 - 0xfee0)),
            '\u{ff66}'..='\u{ff9d}' => out.extend(katakana(c)),
            '\u{3000}' => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_the_same_however_they_are_written() {
        for (text, folded) in [
            ("Rollenmaß", "rollenmass"),
            ("ROLLENMASS", "rollenmass"),
            ("Zahnlu\u{308}cke", "zahnlucke"),
            ("Zahnluecke", "zahnlucke"),
            ("RackPitch", "rack pitch"),
            ("Ｍ　（ｍｍ）", "m mm"),
            ("ﾋﾟｯﾁ誤差", "ピッチ誤差"),
            ("ローラー", "ロラ"),
            ("Écart d'hélice", "ecart d helice"),
            ("Δβ", "delta beta"),
            ("roller(s)", "rollers"),
            ("Tol +", "tol +"),
            ("-Tol", "- tol"),
            ("- Tol", "- tol"),
            ("Tol-", "tol -"),
            ("+/-", "±"),
            ("Soll-Ist", "soll ist"),
            ("Pitch - rack", "pitch rack"),
        ] {
            let words: Vec<_> = fold(text).split_whitespace().map(str::to_owned).collect();
            assert_eq!(words.join(" "), folded, "{text}");
        }
    }

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
