//! What the columns of a table with a row per characteristic hold, as measuring programs call them.

use super::letters::joined;
use super::unit::split_unit;
use super::vocabulary::{Entry, Role, Sense, VOCABULARY, WordList};
use super::words::Words;
use super::{Field, bare, name_of};

/// What a heading of a table with a row per characteristic says; `None` for what is none of it, as a column of values
/// that is called after its part (`Teil 1`).
pub(crate) fn role(text: &str) -> Option<Role> {
    // a magnitude says no sign: |Dev|
    if text.trim().starts_with('|') {
        return None;
    }
    let (name, unit) = split_unit(bare(text));
    let known = Words::of(&name).known()?;
    if let [word] = known.as_slice()
        && let Some(role) =
            word.senses.iter().find_map(|sense| if let Sense::Role(role) = sense { Some(*role) } else { None })
    {
        return Some(role);
    }
    let senses: Vec<Sense> = known.iter().map(|word| role_sense(&word.senses)).collect::<Option<_>>()?;
    let has = |sense: Sense| senses.contains(&sense);
    if has(PART) {
        let of_part = |sense: &Sense| matches!(sense, &PART | Sense::Rack | Sense::Pinion | Sense::Filling);
        let ordinal = known.iter().any(|word| word.senses.contains(&Sense::Ordinal));
        let numbers_lines = ordinal && !has(Sense::Rack) && !has(Sense::Pinion);
        return (senses.iter().all(of_part) && !numbers_lines).then_some(Role::Part);
    }
    let tolerance = has(Sense::Tolerance) || has(Sense::Limit);
    // the deviation that was measured: Istabmaß
    if tolerance && has(Sense::Measured) {
        return Some(Role::Deviation);
    }
    // the upper one of two racks
    if !tolerance && (has(Sense::Rack) || has(Sense::Pinion)) && (has(Sense::Upper) || has(Sense::Lower)) {
        return None;
    }
    // the largest value, and no limit: Max. Ist, max. Abweichung
    let is_extreme = (has(Sense::Measured) || has(Sense::Deviation)) && (has(Sense::Greatest) || has(Sense::Least));
    if has(Sense::Largest) || is_extreme && !tolerance {
        return None;
    }
    let upper = has(Sense::Upper) || has(Sense::Greatest) || (has(Sense::Plus) && tolerance);
    let lower = has(Sense::Lower) || has(Sense::Least) || (has(Sense::Minus) && tolerance);
    match (upper, lower) {
        (true, true) => return None,
        (true, false) => return Some(Role::Upper),
        (false, true) => return Some(Role::Lower),
        // how much of a tolerance is used is none
        (false, false) if tolerance => return (unit.as_deref() != Some("%")).then_some(Role::Upper),
        (false, false) => {}
    }
    // Soll-Ist: the difference, and which sign it has is not said
    if has(Sense::Nominal) && has(Sense::Measured) {
        return None;
    }
    let by_word = [
        (Sense::Uncertainty, Role::Uncertainty),
        (Sense::Deviation, Role::Deviation),
        (Sense::Nominal, Role::Nominal),
        (Sense::Measured, Role::Measured),
    ];
    // Dev -: how far a value is below, as a magnitude
    let has_sign = text.trim_end().ends_with(['+', '-', '\u{2212}']);
    let found = by_word.into_iter().find(|(sense, _)| has(*sense)).map(|(_, role)| role);
    found.filter(|role| *role != Role::Deviation || !has_sign)
}

const PART: Sense = Sense::Alone(&[Field::PartId]);

/// What a word can say of a column; `None` if it is not used for one.
fn role_sense(senses: &[Sense]) -> Option<Sense> {
    let of_column = |sense: &Sense| match sense {
        Sense::Alone(_) => *sense == PART,
        Sense::Name(_) | Sense::Error(_) | Sense::Left | Sense::Right => false,
        Sense::Least => true,
        sense => !sense.is_foreign(),
    };
    senses.iter().copied().find(of_column)
}

impl WordList {
    /// Whether a name, with its unit or without, is in the list.
    pub(crate) fn has(self, name: &str) -> bool {
        let name = if self.is_folded() { joined(&name_of(name)) } else { plain(name) };
        VOCABULARY.has(self, &name)
    }

    /// Whether some words of a text are in the list; Japanese has no blanks between them.
    pub(crate) fn is_in(self, text: &str) -> bool {
        self.is_in_where(text, |_, _| true)
    }

    /// Whether a text says what is in the list, and not that there is none of it: `kein Ausschuss`, `Ausschuss: 0`.
    pub(crate) fn is_claimed_in(self, text: &str) -> bool {
        let is_none = |word: &str| Self::NoneOfIt.has(word);
        self.is_in_where(text, |before, behind| {
            // `25,012 0 NOK` is a row, and `reject No. 4` is one
            let is_count = before.len() > 1 && before.ends_with('0');
            (is_count || !before.split(' ').next_back().is_some_and(is_none)) && !is_none(behind)
        })
    }

    /// Whether some words of a text are in the list, and what stands before and behind them is as wanted.
    fn is_in_where(self, text: &str, is_wanted: impl Fn(&str, &str) -> bool) -> bool {
        let is_mark = |c: char| c.is_whitespace() || ",;:=()!".contains(c);
        let words: Vec<_> = text.split(is_mark).map(plain).filter(|word| !word.is_empty()).collect();
        let text = words.join(" ");
        let is_edge = |(before, behind): (&str, &str), words: &str| {
            let is_apart = words.starts_with(|c: char| c.is_ascii());
            !is_apart || (before.is_empty() || before.ends_with(' ')) && (behind.is_empty() || behind.starts_with(' '))
        };
        let is_said = |words: &String| {
            text.match_indices(words.as_str()).any(|(at, found)| {
                let (before, behind) = (&text[..at], &text[at + found.len()..]);
                is_edge((before, behind), words) && is_wanted(before.trim_end(), behind.trim_start())
            })
        };
        VOCABULARY.list(self).any(is_said)
    }
}

/// Whether a name is that of a statistic of parts, and not of a part.
pub(crate) fn is_statistic(name: &str) -> bool {
    [WordList::Statistic, WordList::Spread, WordList::Mean].into_iter().any(|list| list.has(name)) || is_apart(name)
}

/// Whether it is that of one that is no value of a part: a sum, a count, an index.
pub(crate) fn is_apart(name: &str) -> bool {
    WordList::Apart.has(name) || WordList::Sum.has(name)
}

/// Whether a row or column that is no part's is called by how far values are apart.
pub(crate) fn is_called_spread(name: &str) -> bool {
    WordList::Spread.has(name) || name == "R"
}

/// The name of a row, without what stands behind the word for a statistic: `Mittelwert (n=3)`, `Mittelwert aller Teile`.
pub(crate) fn statistic_word(name: &str) -> &str {
    const SHORTEST: usize = 5;
    let first = name.split([' ', '(']).next().filter(|first| first.chars().count() >= SHORTEST);
    first.filter(|first| WordList::Mean.has(first) || WordList::Spread.has(first)).unwrap_or(name)
}

/// Whether it is that of a statistic, a nominal value or a limit; one letter may be a part's.
pub(crate) fn is_of_parts(name: &str) -> bool {
    name.len() > 1 && may_be_of_parts(name)
}

/// The same where one letter is none of a part, either.
pub(crate) fn may_be_of_parts(name: &str) -> bool {
    // a quick look: none of them ends in a digit, as most names of parts do
    if name.ends_with(|c: char| c.is_ascii_digit()) {
        return false;
    }
    is_statistic(name) || matches!(role(name), Some(Role::Nominal | Role::Upper | Role::Lower))
}

/// Whether a column is called a value or a deviation, once more or in place of another: `Istwert`, `2. Messung`, `Wdh.`, `links`,
/// `größter Wert`.
pub(crate) fn repeats_value(title: &str) -> bool {
    let (whole, _) = split_unit(title);
    let name = whole.trim_matches(|c: char| c.is_ascii_digit() || matches!(c, ' ' | '#' | '.' | '_'));
    matches!(role(name), Some(Role::Measured | Role::Deviation))
        || is_again(name)
        || is_again(&whole)
        || says_which(name)
}

/// Whether a word has a meaning, as the name of a person has none.
pub(crate) fn is_known_word(word: &str) -> bool {
    Words::of(word).known().is_some() || VOCABULARY.lists(&plain(word))
}

/// Whether a name announces what was measured once more, or corrects it: `neu`, `Korrektur`.
pub(crate) fn is_again(name: &str) -> bool {
    WordList::Again.is_in(name)
}

/// Whether a line says where a page ends, and nothing else: `Seite 2 von 5`, `Page 2/5`, `Übertrag`.
pub(crate) fn names_page(line: &str) -> bool {
    let line = plain(line);
    // as a database ends its answer: `(2 rows)`
    let of_rows = line.trim_matches(['(', ')']).split_once(' ');
    if of_rows.is_some_and(|(count, rows)| count.parse::<u64>().is_ok() && WordList::Rows.has(rows)) {
        return true;
    }
    let is_page =
        |page: &&String| line.strip_prefix(page.as_str()).is_some_and(|rest| !rest.starts_with(char::is_alphabetic));
    let Some(page) = VOCABULARY.list(WordList::Page).find(is_page) else { return false };
    let behind = line[page.len()..].replace('/', " / ");
    let is_count =
        |word: &str| word.len() < 4 && word.bytes().all(|byte| byte.is_ascii_digit()) || WordList::PageCount.has(word);
    behind.trim_start_matches([':', '.']).split_whitespace().all(is_count)
}

/// Whether a title says of which flank a value is, or that it is an extreme, and nothing else.
pub(crate) fn says_which(name: &str) -> bool {
    let known = Words::of(name).known().unwrap_or_default();
    let says = |word: &Entry, said: fn(&Sense) -> bool| word.senses.iter().any(said);
    let is_which = |word: &Entry| {
        says(word, |sense| {
            matches!(sense, Sense::Left | Sense::Right | Sense::Greatest | Sense::Least | Sense::Largest)
        })
    };
    let is_filling = |word: &Entry| says(word, |sense| matches!(sense, Sense::Filling | Sense::Measured));
    known.iter().any(|word| is_which(word)) && known.iter().all(|word| is_which(word) || is_filling(word))
}

/// The name of a row without a mark behind it, in small letters: `X_max:` as `x max`.
fn plain(name: &str) -> String {
    name.trim().trim_end_matches([':', '.', '=']).trim().to_lowercase().replace('_', " ")
}
