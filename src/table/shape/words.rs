//! A line of words cut into pieces: who wrote it, words, numbers with their units, and marks.

use crate::table::cell::Cell;
use crate::table::grid::{is_date, is_unit};
use crate::table::names::is_known_word;

/// A piece of a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Token {
    Word(String),
    /// A number with its unit, if it has one.
    Number(Cell),
    Mark(char),
}

/// The words, numbers and marks of a line from a place on.
pub(super) fn tokens(line: &str, from: usize, start: usize) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut at = from;
    while let Some(c) = line[at..].chars().next() {
        let rest = &line[at..];
        let length = number_length(rest);
        if c.is_whitespace() {
            at += c.len_utf8();
        } else if length > 0 {
            let end = at + length;
            tokens.push(Token::Number(Cell::of_text(&line[at..end], start + at..start + end)));
            at = end;
        } else if is_mark(c, &rest[c.len_utf8()..]) {
            tokens.push(Token::Mark(c));
            at += c.len_utf8();
        } else {
            let length = word_length(rest);
            tokens.push(Token::Word(rest[..length].to_owned()));
            at += length;
        }
    }
    tokens
}

/// Whether a character stands between words; a point does at the end of a sentence.
fn is_mark(c: char, behind: &str) -> bool {
    let is_end = || behind.is_empty() || behind.starts_with(char::is_whitespace);
    matches!(c, ',' | ';' | ':' | '=' | '(' | ')' | '：' | '、' | '，' | '（' | '）') || c == '.' && is_end()
}

/// The bytes of a word at the start of a text; a number behind it begins another, unless it goes on with a letter: `D4`.
fn word_length(text: &str) -> usize {
    let mut before: Option<char> = None;
    for (at, c) in text.char_indices() {
        let is_apart = before.is_some_and(|before| !before.is_alphanumeric() || before >= '\u{3000}');
        if c.is_whitespace() || c != '.' && is_mark(c, "") || is_apart && c.is_ascii_digit() {
            return at;
        }
        before = Some(c);
    }
    text.len()
}

/// The bytes of the number at the start of a text, with its tolerance and its unit; 0 if there is none.
fn number_length(text: &str) -> usize {
    let number = plain_number_length(text);
    let behind = text[number..].trim_start();
    let tolerance = behind.strip_prefix('±').map(|tolerance| {
        let tolerance = tolerance.trim_start();
        text.len() - tolerance.len() + plain_number_length(tolerance)
    });
    let end = tolerance.filter(|_| number > 0).unwrap_or(number);
    let behind = text[end..].trim_start();
    let unit = &behind[..behind.find(|c: char| c.is_whitespace() || is_mark(c, "x")).unwrap_or(behind.len())];
    let unit = unit.trim_end_matches('.');
    let with_unit = text.len() - behind.len() + unit.len();
    let is_measure = |end: usize| Cell::of_text(&text[..end], 0..0).is_measure();
    match number {
        0 => 0,
        _ if is_unit(unit) && is_measure(with_unit) => with_unit,
        _ if is_measure(end) => end,
        _ => 0,
    }
}

/// The bytes of the digits at the start of a text, with a sign and a mark between them.
fn plain_number_length(text: &str) -> usize {
    let digits = text.trim_start_matches(['+', '-', '\u{2212}']);
    let sign = text.len() - digits.len();
    if sign > '\u{2212}'.len_utf8() || !digits.starts_with(|c: char| c.is_ascii_digit()) {
        return 0;
    }
    let is_inside = |at: usize, c: char| {
        c.is_ascii_digit() || matches!(c, '.' | ',') && digits[at + 1..].starts_with(|c: char| c.is_ascii_digit())
    };
    let end = digits.char_indices().find(|(at, c)| !is_inside(*at, *c)).map_or(digits.len(), |(at, _)| at);
    sign + end
}

/// Who wrote a line of a chat, and when: `[14:02] Tom: `. Nothing if a known word is among the names.
pub(super) fn speaker(line: &str) -> &str {
    const MOST_WORDS: usize = 3;
    let is_kept = |c: char| c.is_ascii_digit() || matches!(c, '[' | ']' | ':' | '.' | '/' | '-' | ',' | ' ');
    let stamp = &line[..line.find(|c| !is_kept(c)).unwrap_or(0)];
    let words = || stamp.split(['[', ']', ' ', ',']).map(|word| word.trim_matches('-')).filter(|word| !word.is_empty());
    let is_time = |word: &str| word.contains(':') && !word.contains(['.', '/', '-']);
    let is_day = |word: &str| is_date(&word.replace(['/', '-'], "."));
    if !words().any(is_time) || !words().all(|word| is_time(word) || is_day(word)) {
        return "";
    }
    let behind = &line[stamp.len()..];
    let name = behind.split_once(':').map_or("", |(name, _)| name);
    let is_name = |word: &str| word.chars().all(char::is_alphabetic) && !is_known_word(word);
    if !name.is_empty() && name.split(' ').count() <= MOST_WORDS && name.split(' ').all(is_name) {
        return &line[..=stamp.len() + name.len()];
    }
    stamp
}

pub(super) fn word(token: &Token) -> Option<&str> {
    if let Token::Word(word) = token { Some(word) } else { None }
}

/// The words among some tokens, which may have a colon or an equals sign behind them; `None` if there is anything else.
pub(super) fn words(tokens: &[Token]) -> Option<Vec<&str>> {
    let is_colon = |token: &&Token| matches!(token, Token::Mark(':' | '=' | '：'));
    let has_letters = |word: &&str| word.contains(|c: char| c.is_alphanumeric() || matches!(c, 'Ø' | '⌀' | '∅' | '±'));
    tokens.iter().filter(|token| !is_colon(token)).map(|token| word(token).filter(has_letters)).collect()
}

/// Whether a colon stands behind the first of some tokens.
pub(super) fn is_colon_behind(tokens: &[Token]) -> bool {
    matches!(tokens.get(1), Some(Token::Mark(':' | '：')))
}
