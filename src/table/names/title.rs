//! Of which part a title says that values are, however it says it. Called by everything that hears titles.

use std::sync::LazyLock;

use super::WordList;
use super::near::is_gear_size;
use super::vocabulary::{Sense, VOCABULARY};
use super::words::Words;
use crate::deviation::Part;

/// Titles with more words are sentences.
const LONGEST: usize = 16;

/// What is driven as a whole: no word for the part that it has in its name.
const WHOLE_GEARS: [&str; 3] = ["lenkung", "getriebe", "antrieb"];

/// The part that a title says that all is of: `Messprotokoll Ritzelwelle 4711`, or the first of `Ritzel zu Zahnstange 4711`. With
/// what it was measured or paired says nothing, nor does what is known of one: `Ritzel-Charge: 4711`.
pub(crate) fn part_in_title(text: &str) -> Option<Part> {
    let words = Words::of(text).tokens;
    let has = |list: WordList, word: &String| VOCABULARY.has(list, word);
    let is_elsewhere = || words.iter().any(|word| has(WordList::Elsewhere, word)) || is_gear_size(text);
    let is_of_one = || text.split_once([':', '=']).is_some_and(|(label, said)| is_of_one(label, said));
    if words.len() > LONGEST || !words.iter().any(|word| part_of(word).is_some()) || is_elsewhere() || is_of_one() {
        return None;
    }
    let mut to_mate = words.split(|word| has(WordList::Mate, word) || is_mate(word)).take(1);
    let spoken = to_mate.next()?.split(|word| has(WordList::ToMate, word));
    let said = |words: &[String]| words.iter().filter_map(|word| part_of(word)).collect::<Vec<Part>>();
    let said = spoken.map(said).find(|said| !said.is_empty())?;
    said.iter().all(|part| *part == said[0]).then_some(said[0])
}

/// Whether a line says something of one of the parts, and not that all is of it: its batch, who made it, and where.
fn is_of_one(label: &str, said: &str) -> bool {
    let words = Words::of(label).tokens;
    let names_part = |word: &String| part_words().any(|known| known.letters == *word);
    let says_more = words.iter().any(|word| part_of(word).is_some()) && !words.iter().all(names_part);
    let is_of_others = [WordList::Person, WordList::Place].iter().any(|list| list.has(label.trim()))
        || WordList::Words.has(label.trim()) && said.split_whitespace().count() > 1;
    says_more && part_in_title(said).is_none() || is_of_others && !WordList::Report.has(label.trim())
}

/// The part that a word names, by itself or at either end of a longer one: `Ritzelwelle`, `Lenkritzel`.
fn part_of(word: &str) -> Option<Part> {
    let is_whole_gear = WHOLE_GEARS.iter().any(|gear| word.ends_with(gear));
    let is_named = |known: &&PartWord| {
        let is_in = known.is_long() && (word.starts_with(known.letters) || word.ends_with(known.letters));
        known.letters == word || is_in && !is_whole_gear
    };
    part_words().find(is_named).map(|known| known.part)
}

/// Whether a word names what something is measured with: `Lehrritzel`.
fn is_mate(word: &str) -> bool {
    let before = |known: &PartWord| word.strip_suffix(known.letters).filter(|_| known.is_long());
    part_words().filter_map(before).any(|before| VOCABULARY.has(WordList::Mate, before))
}

/// A word for one of the parts.
#[derive(Debug)]
struct PartWord {
    letters: &'static str,
    part: Part,
}

impl PartWord {
    /// Whether it may be part of a longer word.
    fn is_long(&self) -> bool {
        self.letters.len() > "rack".len()
    }
}

fn part_words() -> impl Iterator<Item = &'static PartWord> {
    static WORDS: LazyLock<Vec<PartWord>> = LazyLock::new(|| {
        let part_word = |part: Part, sense: Sense| {
            let words = VOCABULARY.all().filter(move |word| word.senses.contains(&sense));
            words.map(move |word| PartWord { letters: &word.letters, part })
        };
        part_word(Part::Rack, Sense::Rack).chain(part_word(Part::Pinion, Sense::Pinion)).collect()
    });
    WORDS.iter()
}
