//! The lines of a contract that a proposal would add, as they stand in a spec.

use super::own;
use super::rules::{Certainty, MOST_EXACT, Rule, Rules, Suggestion};
use crate::table::pattern::Pattern;
use crate::table::want::quoted;

/// How guesses are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guesses {
    /// As entries that are marked as guesses.
    Filled,
    /// As comments, which a person uncomments.
    AsComments,
}

/// The number of new columns to leave out from which a rule for all others is offered.
const MANY: usize = 12;

impl Rules {
    /// The `[table]` that closes the table. Its lists are complete: the entries of the present contract come first.
    pub(crate) fn block(&self, guesses: Guesses) -> String {
        let mut text = "[table]\n".to_owned();
        let own = own::keys(&self.layout).into_iter().flat_map(|line| [line, "\n".to_owned()]);
        text.extend(own);
        for (rule, certainty) in self.each() {
            if let Rule::Key(key, value) = rule {
                text += &entry(&format!("{key} = {value}"), certainty, guesses);
            }
        }
        let quote_all = |patterns: &[Pattern]| patterns.iter().map(|rule| quoted(rule.text())).collect();
        let texts = |list: &'static str| {
            move |rule: &Rule, guesses| match rule {
                Rule::Entry(own, text) if *own == list && guesses == Guesses::Filled => vec![quoted(text)],
                _ => Vec::new(),
            }
        };
        // the columns of details are named
        let is_detail =
            |rule: &&Pattern| self.layout.details.iter().any(|(_, name)| Pattern::of_heading(name) == **rule);
        let ignored: Vec<_> = self.layout.ignore.iter().filter(|rule| !is_detail(rule)).cloned().collect();
        text += &self.list("ignore", quote_all(&ignored), guesses, &texts("ignore"));
        let count = self.each().filter(|(rule, _)| matches!(rule, Rule::Entry("ignore", _))).count();
        if count >= MANY {
            text += &format!(
                "# others = \"ignore\"   # in place of the {count} new columns in that list: leaves out these and any further one\n"
            );
        }
        let known = self.layout.ignore_lines.iter().map(|rule| line_rule(rule.pattern.text(), rule.at_most)).collect();
        text += &self.list("ignore_lines", known, guesses, &lines);
        text += &self.list("comments", quote_all(&self.layout.comments), guesses, &texts("comments"));
        let columns = self.each().filter_map(|(rule, certainty)| match rule {
            Rule::Column { key, entry: value } => {
                Some((key != "part_id", entry(&format!("{key} = {value}"), certainty, guesses)))
            }
            _ => None,
        });
        let mut columns: Vec<_> = columns.collect();
        let is_new =
            |key: &str| self.each().any(|(rule, _)| matches!(rule, Rule::Column { key: new, .. } if new == key));
        let own = own::columns(&self.layout).into_iter().filter(|(key, _)| !is_new(key));
        columns.splice(0..0, own.map(|(key, line)| (key != "part_id", format!("{line}\n"))));
        columns.sort_by_key(|(is_value, _)| *is_value);
        let columns: String = columns.into_iter().map(|(_, line)| line).collect();
        if columns.is_empty() { text } else { format!("{text}[table.columns]\n{columns}") }
    }

    fn each(&self) -> impl Iterator<Item = (&Rule, &Certainty)> {
        self.list.iter().map(|Suggestion { rule, certainty }| (rule, certainty))
    }

    /// A list in one line, or in a line for each entry where one of them is a guess.
    fn list(
        &self,
        name: &str,
        known: Vec<String>,
        guesses: Guesses,
        of: &dyn Fn(&Rule, Guesses) -> Vec<String>,
    ) -> String {
        let mut entries: Vec<(String, Option<String>)> = known.into_iter().map(|text| (text, None)).collect();
        for (rule, certainty) in self.each() {
            let filled = || of(rule, Guesses::Filled).into_iter();
            let commented =
                |why: &String| filled().map(|text| (format!("# {text}"), Some(why.clone()))).collect::<Vec<_>>();
            match (certainty, guesses) {
                (Certainty::Exact, _) => entries.extend(filled().map(|text| (text, None))),
                (Certainty::Guess(why), Guesses::Filled) => {
                    entries.extend(filled().map(|text| (text, Some(format!("a guess: {why}")))));
                }
                (Certainty::Guess(why), Guesses::AsComments) => {
                    entries.extend(of(rule, guesses).into_iter().map(|text| (text, None)));
                    entries.extend(commented(&format!("a guess: {why}")));
                }
                (Certainty::Choice(why) | Certainty::OneOf(why), _) => entries.extend(commented(why)),
            }
        }
        if entries.is_empty() {
            return String::new();
        }
        if entries.iter().all(|(text, why)| why.is_none() && !text.starts_with('#')) {
            let texts: Vec<_> = entries.into_iter().map(|(text, _)| text).collect();
            return format!("{name} = [{}]\n", texts.join(", "));
        }
        let line = |(text, why): (String, Option<String>)| {
            let why = why.map_or_else(String::new, |why| format!("   # {why}"));
            format!("  {text},{why}\n")
        };
        format!("{name} = [\n{}]\n", entries.into_iter().map(line).collect::<String>())
    }
}

/// The entries of `ignore_lines` for a rule: its pattern, or each line as it stands in the table.
fn lines(rule: &Rule, guesses: Guesses) -> Vec<String> {
    let Rule::Lines { exact, like, at_most } = rule else { return Vec::new() };
    match like {
        Some(like) if guesses == Guesses::Filled || exact.len() > MOST_EXACT => vec![line_rule(like, *at_most)],
        _ => exact.iter().map(|(text, count)| line_rule(text, *count)).collect(),
    }
}

/// A rule for lines, of which `at_most` could be parts.
fn line_rule(text: &str, at_most: u64) -> String {
    match at_most {
        0 => quoted(text),
        most => format!("{{ like = {}, at_most = {most} }}", quoted(text)),
    }
}

/// A line of the spec: as it is, marked as a guess, or as a comment.
fn entry(text: &str, certainty: &Certainty, guesses: Guesses) -> String {
    match (certainty, guesses) {
        (Certainty::Exact, _) => format!("{text}\n"),
        (Certainty::Guess(why), Guesses::Filled) => format!("{text}   # a guess: {why}\n"),
        (Certainty::Guess(why), Guesses::AsComments) => format!("# {text}   # a guess: {why}\n"),
        (Certainty::Choice(why) | Certainty::OneOf(why), _) => format!("# {text}   # {why}\n"),
    }
}
