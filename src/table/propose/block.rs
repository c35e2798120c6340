//! The lines of a contract that a proposal would add, as they stand in a spec.

use super::own;
use super::rules::{Certainty, MOST_EXACT, Rule, Rules, Suggestion};
use crate::table::pattern::Pattern;
use crate::table::want::quoted;

/// How guesses are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guesses {
    /// As entries, what may be values that the table lacks left out: nothing is left to choose from.
    Filled,
    /// As entries, but for what may be values that the table lacks: a comment, as every choice.
    Shown,
    /// As comments, which a person uncomments.
    AsComments,
}

/// A line of a contract, and why a person looks at it.
struct Line {
    text: String,
    why: Option<String>,
    /// Whether a person uncomments it, if it is right.
    is_comment: bool,
}

/// The number of new columns to leave out from which a rule for all others is offered.
const MANY: usize = 12;

impl Rules {
    /// The `[table]` that closes the table. Its lists are complete: the entries of the present contract come first. What is said of a
    /// line stands in a line before it.
    pub(crate) fn block(&self, guesses: Guesses) -> String {
        let mut text = "[table]\n".to_owned();
        let own = own::keys(&self.layout).into_iter().flat_map(|line| [line, "\n".to_owned()]);
        text.extend(own);
        let keys = self.each().filter_map(|(rule, certainty)| match rule {
            Rule::Key(key, value) => Some(Line::of(format!("{key} = {value}"), certainty, guesses)),
            _ => None,
        });
        text += &written(keys, "");
        let quote_all = |patterns: &[Pattern]| patterns.iter().map(|rule| quoted(rule.text())).collect();
        let texts = |list: &'static str| {
            move |rule: &Rule, _| match rule {
                Rule::Entry(own, text) if *own == list => vec![quoted(text)],
                _ => Vec::new(),
            }
        };
        // the columns of details are named
        let is_detail =
            |rule: &&Pattern| self.layout.details.iter().any(|(_, name)| Pattern::of_heading(name) == **rule);
        let ignored: Vec<_> = self.layout.ignore.iter().filter(|rule| !is_detail(rule)).cloned().collect();
        text += &list("ignore", quote_all(&ignored), self, guesses, &texts("ignore"));
        let count = self.each().filter(|(rule, _)| matches!(rule, Rule::Entry("ignore", _))).count();
        if count >= MANY {
            let why = format!("in place of the {count} new columns in that list, leaves out any further one too");
            let others = Line { text: "others = \"ignore\"".to_owned(), why: Some(why), is_comment: true };
            text += &written([others], "");
        }
        let known = self.layout.ignore_lines.iter().map(|rule| line_rule(rule.pattern.text(), rule.at_most)).collect();
        text += &list("ignore_lines", known, self, guesses, &lines);
        text += &list("comments", quote_all(&self.layout.comments), self, guesses, &texts("comments"));
        let columns = self.columns(guesses);
        if columns.is_empty() { text } else { format!("{text}[table.columns]\n{columns}") }
    }

    /// The entries of `[table.columns]`, that of the part's name first. What the contract says of a column stands as it is: a rule adds
    /// the keys that the entry lacks.
    fn columns(&self, guesses: Guesses) -> String {
        let new = || {
            self.each().filter_map(|(rule, certainty)| match rule {
                Rule::Column { key, entry } => Some((&**key, entry, certainty)),
                _ => None,
            })
        };
        let mut lines: Vec<(&str, Line)> = Vec::new();
        let own = own::columns(&self.layout);
        for (key, entry) in &own {
            let added = new().filter(|(other, ..)| other == key).map(|(_, new, certainty)| (entry.and(new), certainty));
            let added = added.filter(|(all, _)| all != entry);
            let added: Vec<_> = added.map(|(all, how)| Line::of(format!("{key} = {all}"), how, guesses)).collect();
            let is_replaced = added.iter().any(|line| !line.is_comment);
            lines.extend((!is_replaced).then(|| (*key, Line::plain(format!("{key} = {entry}")))));
            lines.extend(added.into_iter().map(|line| (*key, line)));
        }
        let is_new = |key: &str| own.iter().all(|(known, _)| *known != key);
        let new = new().filter(|(key, ..)| is_new(key));
        lines.extend(new.map(|(key, entry, how)| (key, Line::of(format!("{key} = {entry}"), how, guesses))));
        lines.sort_by_key(|(key, _)| *key != "part_id");
        written(lines.into_iter().map(|(_, line)| line), "")
    }

    fn each(&self) -> impl Iterator<Item = (&Rule, &Certainty)> {
        self.list.iter().map(|Suggestion { rule, certainty }| (rule, certainty))
    }
}

/// A list in one line, or in a line for each entry where something is said of one. `texts` are the entries of a rule as a guess is
/// written.
fn list(
    name: &str,
    known: Vec<String>,
    rules: &Rules,
    guesses: Guesses,
    texts: &dyn Fn(&Rule, Guesses) -> Vec<String>,
) -> String {
    let mut entries: Vec<Line> = known.into_iter().map(Line::plain).collect();
    for (rule, certainty) in rules.each() {
        let filled = texts(rule, Guesses::Filled);
        if let (Certainty::Guess(_), Guesses::AsComments, Rule::Lines { .. }) = (certainty, guesses, rule) {
            entries.extend(texts(rule, guesses).into_iter().map(Line::plain));
        }
        entries.extend(filled.into_iter().map(|text| Line::of(text, certainty, guesses)));
    }
    if entries.is_empty() {
        return String::new();
    }
    if entries.iter().all(|line| line.why.is_none()) {
        let texts: Vec<_> = entries.into_iter().map(|line| line.text).collect();
        return format!("{name} = [{}]\n", texts.join(", "));
    }
    let entries = entries.into_iter().map(|line| Line { text: line.text + ",", ..line });
    format!("{name} = [\n{}]\n", written(entries, "  "))
}

impl Line {
    fn plain(text: String) -> Self {
        Self { text, why: None, is_comment: false }
    }

    fn of(text: String, certainty: &Certainty, guesses: Guesses) -> Self {
        let guess = |why: &str| Some(format!("a guess: {why}"));
        let (why, is_comment) = match certainty {
            Certainty::Exact => (None, false),
            Certainty::Guess(why) => (guess(why), guesses == Guesses::AsComments),
            Certainty::Doubt(why) if guesses == Guesses::Filled => (guess(why), false),
            Certainty::Doubt(why) | Certainty::Choice(why) | Certainty::OneOf(why) => (Some(why.clone()), true),
        };
        Self { text, why, is_comment }
    }
}

/// Lines, each below what is said of it. What is said of comments that follow each other stands there once.
fn written(lines: impl IntoIterator<Item = Line>, indent: &str) -> String {
    let (mut text, mut said) = (String::new(), None);
    for Line { text: line, why, is_comment } in lines {
        if let Some(why) = why.as_ref().filter(|why| said.as_ref() != Some(*why)) {
            text += &format!("{indent}# {why}:\n");
        }
        let mark = if is_comment { "# " } else { "" };
        text += &format!("{indent}{mark}{line}\n");
        said = why.filter(|_| is_comment);
    }
    text
}

/// The entries of `ignore_lines` for a rule: its pattern, or each line as it stands in the table.
pub(super) fn lines(rule: &Rule, guesses: Guesses) -> Vec<String> {
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
