//! What a name that is not understood may have meant, and which names are known to mean something else.

use super::letters::joined;
use super::role::{is_statistic, role};
use super::unit::{split_unit, split_wanted};
use super::vocabulary::{Entry, Role, Sense, VOCABULARY, WordList, is_japanese};
use super::words::Words;
use super::{Field, has_total_pitch, heading, name_of, needs_part, of_pinion, of_rack};
use crate::deviation::{DeviationKind, Part};

/// The longest known phrase, in words.
const LONGEST_PHRASE: usize = 5;

/// The fields whose names are nearest to a heading that is not understood, or leaves open which field it means; empty if
/// it is near none. Part, flank, unit, numbers and words such as `measured` make no name near.
pub(crate) fn near(text: &str) -> Vec<Field> {
    if is_context(text) || is_statistic(text) {
        return Vec::new();
    }
    if let Some(heading) = heading(text, &[]) {
        return heading.fields.into_iter().filter(|field| !only_whole(*field)).collect();
    }
    let words = Words::of(&name_of(text));
    let mut fields = named(&words);
    if fields.is_empty() {
        fields = misspelt(&words);
    }
    of_part(fields, &words)
}

/// Whether a name is known to be no measured error: dates, operators, machines, serial numbers, and what a gear is, such
/// as its module or the diameter of the roller.
pub(crate) fn is_context(text: &str) -> bool {
    is_of_context_only(&name_of(text)) || is_gear_size(text)
}

fn is_of_context_only(name: &str) -> bool {
    let Some(known) = Words::of(name).known() else { return false };
    // `Maß` is written like a mass, and says nothing
    let is_open = |word: &Entry| word.senses.contains(&Sense::Context) && word.senses.contains(&Sense::Filling);
    let says_it = |word: &&Entry| !is_open(word) && word.senses.iter().any(|sense| is_of_context(*sense));
    let silent = |word: &&Entry| word.senses.iter().any(|sense| is_silent(*sense) && *sense != Sense::Other);
    known.iter().any(says_it) && known.iter().all(|word| says_it(word) || silent(word))
}

/// Whether a name is that of a total over all teeth, such as F_p or F_r.
pub(crate) fn is_total(text: &str) -> bool {
    has_total_pitch(text) || says(text, Sense::Total)
}

/// Whether a name is that of another deviation of flanks than f_Hβ and the pitch: their form, crowning or total.
pub(crate) fn is_other_of_flank(text: &str) -> bool {
    let name = joined(&name_of(text));
    let words: Vec<&str> = name.split(' ').collect();
    let is_named = |other: &String| {
        let count = other.split(' ').count();
        words.windows(count).any(|phrase| phrase.join(" ") == *other)
            || other.chars().count() > 6 && words.iter().any(|word| word.contains(other.as_str()))
    };
    VOCABULARY.list(WordList::OtherFlank).any(is_named)
}

/// Whether a name says that it is a deviation.
pub(crate) fn says_deviation(text: &str) -> bool {
    says(text, Sense::Deviation)
}

/// Whether a name is that of the largest of several values, and none with a limit behind it: `fp max`.
pub(crate) fn says_largest(text: &str) -> bool {
    let (text, _) = split_unit(text);
    let text = split_wanted(&text).map_or(text.as_str(), |wanted| wanted.name);
    says(text, Sense::Greatest) || says(text, Sense::Largest)
}

/// Whether a name is that of a tolerance or a limit, and of no value: `Toleranz`, `Zulässige Abweichung`.
pub(crate) fn is_tolerance(text: &str) -> bool {
    matches!(role(text), Some(Role::Upper | Role::Lower)) && (says(text, Sense::Tolerance) || says(text, Sense::Limit))
}

/// The part that a text speaks of; `None` if it speaks of none, or of both.
pub(crate) fn part_said(text: &str) -> Option<Part> {
    match (says(text, Sense::Rack), says(text, Sense::Pinion)) {
        (true, false) => Some(Part::Rack),
        (false, true) => Some(Part::Pinion),
        _ => None,
    }
}

/// Whether one of the words of a name has a sense.
fn says(text: &str, sense: Sense) -> bool {
    let words = Words::of(&name_of(text));
    let has = |known: Vec<&'static Entry>| known.iter().any(|word| word.senses.contains(&sense));
    let of_token = |token: &String| Words::of_tokens(vec![token.clone()]).known().is_some_and(has);
    words.known().is_some_and(has) || words.tokens.iter().any(of_token)
}

/// Whether a name is known to be a size of the gear, such as its module or the diameter of the roller.
pub(crate) fn is_gear_size(text: &str) -> bool {
    let name = name_of(text);
    let name = without_symbol(&name);
    is_of_context_only(name)
        && Words::of(name).known().is_some_and(|known| known.iter().any(|word| word.senses.contains(&Sense::Gear)))
}

/// The name of a size of a gear without its symbol: `Zahnbreite b =`, `Eingriffswinkel αn`, `Taster: Ø`.
fn without_symbol(name: &str) -> &str {
    const SYMBOLS: [&str; 12] = ["b", "d", "l", "m", "mn", "z", "ø", "α", "αn", "αt", "β", "da"];
    let Some((before, symbol)) = name.trim_end_matches(['=', ' ']).rsplit_once([' ', ':']) else { return name };
    let is_symbol = SYMBOLS.contains(&symbol.to_lowercase().replace('_', "").as_str());
    if is_symbol { before.trim_end_matches([':', ' ']) } else { name }
}

const fn is_of_context(sense: Sense) -> bool {
    matches!(sense, Sense::Context | Sense::Gear | Sense::Alone([Field::PartId]))
}

/// Whether it says nothing of what was measured.
const fn is_silent(sense: Sense) -> bool {
    !matches!(sense, Sense::Name(_) | Sense::Error(_) | Sense::Alone(_) | Sense::Near(_) | Sense::Context | Sense::Gear)
}

/// What the words of a name can mean that are known; some mean it only if nothing else stands beside them, so that they are
/// the `whole` name.
fn names(known: &[&'static Entry], whole: bool) -> Vec<Field> {
    let mut fields = Vec::new();
    for sense in known.iter().flat_map(|word| &word.senses) {
        match sense {
            Sense::Name(named) | Sense::Error(named) | Sense::Near(named) => add(&mut fields, named),
            Sense::Alone(named) if whole => add(&mut fields, named),
            _ => {}
        }
    }
    fields.retain(|field| *field != Field::PartId && (whole || !only_whole(*field)));
    fields
}

/// Whether its names are ordinary words: a `tool position` is no position of a pin.
fn only_whole(field: Field) -> bool {
    field.is_index() || field == Field::Position
}

fn add(fields: &mut Vec<Field>, more: &[Field]) {
    // a pitch is meant by the rack's name or the pinion's
    let pitch = [Field::Error(DeviationKind::RackPitch), Field::Error(DeviationKind::PinionPitch)];
    let more = if more.iter().any(|field| pitch.contains(field)) { &pitch } else { more };
    for field in more {
        if !fields.contains(field) {
            fields.push(*field);
        }
    }
}

/// The fields whose names stand in a heading.
fn named(words: &Words) -> Vec<Field> {
    let fields = words.known().map_or_else(|| named_among_others(words), |known| names(&known, false));
    if fields.is_empty() { named_alone(words) } else { fields }
}

/// The fields of a word that counts only by itself, where it does: `M 2`, `p limit`.
fn named_alone(words: &Words) -> Vec<Field> {
    let known = words.known().unwrap_or_default();
    let mut speaking = known.iter().filter(|word| word.senses.iter().any(|sense| !is_silent(*sense)));
    match (speaking.next(), speaking.next()) {
        (Some(word), None) => names(&[*word], true),
        _ => Vec::new(),
    }
}

/// The fields whose names stand among words that are not known, or within one: `pitch circle`, `Stirnteilung`.
fn named_among_others(words: &Words) -> Vec<Field> {
    const LONG: usize = 7;
    let mut fields = Vec::new();
    for length in (1..=LONGEST_PHRASE.min(words.tokens.len())).rev() {
        for phrase in words.tokens.windows(length) {
            let known = Words::of_tokens(phrase.to_vec()).known().filter(|known| known.len() == 1 || length == 1);
            add(&mut fields, &known.map_or_else(Vec::new, |known| names(&known, false)));
        }
    }
    let unknown = |token: &&String| Words::of_tokens(vec![(*token).clone()]).known().is_none();
    let unknown: Vec<&String> = words.tokens.iter().filter(unknown).collect();
    let within = |entry: &&'static Entry| {
        (entry.is_japanese() || entry.letters.len() >= LONG)
            && unknown.iter().any(|token| token.contains(&entry.letters))
    };
    let within: Vec<&'static Entry> = VOCABULARY.all().filter(within).collect();
    add(&mut fields, &names(&within, false));
    fields
}

/// The fields whose names differ least from the words of a heading that are not known, if by a letter or two.
fn misspelt(words: &Words) -> Vec<Field> {
    let unknown: Vec<String> = words.tokens.iter().filter_map(|token| unknown_part(token)).collect();
    let of_context = |token: &String| {
        let known = Words::of_tokens(vec![token.clone()]).known().unwrap_or_default();
        known.iter().any(|word| word.senses.iter().any(|sense| matches!(sense, Sense::Context | Sense::Gear)))
    };
    let beside_context = words.tokens.iter().any(of_context);
    let mut found = Vec::new();
    for length in 1..=LONGEST_PHRASE.min(unknown.len()) {
        let whole = length == unknown.len() && !beside_context;
        for phrase in unknown.windows(length) {
            let phrase = phrase.concat();
            let misspelt = |entry| Some((distance(&phrase, entry)?, names(&[entry], whole)));
            found.extend(VOCABULARY.all().filter_map(misspelt).filter(|(_, fields)| !fields.is_empty()));
        }
    }
    let nearest = found.iter().map(|(distance, _)| *distance).min();
    let mut fields = Vec::new();
    for (_, named) in found.iter().filter(|(distance, _)| Some(*distance) == nearest) {
        add(&mut fields, named);
    }
    fields
}

/// A word without the known words at its ends; `None` if nothing is left, or only what says nothing.
fn unknown_part(token: &str) -> Option<String> {
    let whole = Words::of_tokens(vec![token.to_owned()]);
    let says_nothing = |entry: &&Entry| entry.senses.iter().any(|sense| is_silent(*sense) || is_of_context(*sense));
    if whole.known().is_some_and(|known| known.iter().all(says_nothing)) || token.chars().any(is_japanese) {
        return None;
    }
    let silent = |entry: &&Entry| entry.letters.len() > 2 && entry.senses.iter().all(|sense| is_silent(*sense));
    let mut rest = token;
    for entry in VOCABULARY.all().filter(silent) {
        let stem = rest.strip_prefix(&entry.letters).or_else(|| rest.strip_suffix(&entry.letters));
        rest = stem.filter(|stem| stem.chars().count() > 3).unwrap_or(rest);
    }
    Some(rest.to_owned())
}

/// How many letters are missing, added, wrong or swapped, if few enough for the word's length.
fn distance(phrase: &str, entry: &Entry) -> Option<usize> {
    let length = entry.letters.chars().count();
    let most = match length {
        0..=3 => return None,
        4..=6 => 1,
        _ => 2,
    };
    if phrase.chars().count().abs_diff(length) > most || !entry.letters.is_ascii() {
        return None;
    }
    Some(strsim::osa_distance(phrase, &entry.letters)).filter(|distance| *distance <= most)
}

/// The fields of the part that the name says; all of them if it has none of that part.
fn of_part(fields: Vec<Field>, words: &Words) -> Vec<Field> {
    let says = |part: Sense| {
        let is_part = |entry: &&Entry| entry.senses.contains(&part);
        let said = |entry: &Entry| {
            let within = entry.is_japanese() && words.letters.contains(&entry.letters);
            let token = |token: &String| {
                token.starts_with(&entry.letters) || (token.len() > 4 && distance(token, entry).is_some())
            };
            within || words.tokens.iter().any(token)
        };
        VOCABULARY.all().filter(is_part).any(said)
    };
    let of: fn(Field) -> bool = match (says(Sense::Rack), says(Sense::Pinion)) {
        (true, false) => |field| !of_pinion(field),
        (false, true) => |field| !of_rack(field),
        _ => return fields.into_iter().filter(|field| !needs_part(*field)).collect(),
    };
    let fitting: Vec<Field> = fields.iter().copied().filter(|field| of(*field)).collect();
    if fitting.is_empty() { fields } else { fitting }
}
