//! The rules that a proposal would add to a contract, each exact, a guess, or a choice that is left to a person.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

use super::entry::Entry;
use super::lines::{Shapes, common, generalised};
use crate::deviation::DeviationKind;
use crate::table::block::Odd;
use crate::table::column::UnitSaid;
use crate::table::contract::{Named, Open, Owner, key, may_decide};
use crate::table::dictionary::{Form, Heading, LONGEST_HEADING, Role, lookup, normal};
use crate::table::field::{Beside, Field};
use crate::table::layout::{DETAILS, Layout};
use crate::table::pattern::{escaped, escaped_heading};
use crate::table::want::{Want, quoted};

/// How many lines of one pattern are written one by one, at most.
pub(crate) const MOST_EXACT: usize = 20;

/// How sure a rule is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Certainty {
    /// It names what stands in the file, and nothing more.
    Exact,
    /// A guess, for this reason.
    Guess(String),
    /// To leave out what may be values that the table lacks, for this reason: left to a person.
    Doubt(String),
    /// A choice for a person, who may have to change the value.
    Choice(String),
    /// One of several values, each complete, of which a person chooses.
    OneOf(String),
}

/// Something that a contract may say.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Rule {
    /// A key of `[table]`, with its value as TOML.
    Key(&'static str, String),
    /// An entry of a list of `[table]`: of `ignore` a column that is not used, of `comments` a comment of a workbook.
    Entry(&'static str, String),
    /// Lines that belong to no part: as they stand in the file, each with how many like it could be parts, and a pattern that fits
    /// more.
    Lines { exact: Vec<(String, u64)>, like: Option<String>, at_most: u64 },
    /// An entry of `[table.columns]`.
    Column { key: String, entry: Entry },
}

/// A rule, and how sure it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Suggestion {
    pub(crate) rule: Rule,
    pub(crate) certainty: Certainty,
}

/// The rules that a proposal would add to a contract.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rules {
    pub(crate) layout: Arc<Layout>,
    pub(crate) list: Vec<Suggestion>,
}

impl Rule {
    pub(crate) fn exact(self) -> Suggestion {
        Suggestion { rule: self, certainty: Certainty::Exact }
    }

    pub(crate) fn guess(self, why: impl Into<String>) -> Suggestion {
        Suggestion { rule: self, certainty: Certainty::Guess(why.into()) }
    }

    fn choice(self, why: impl Into<String>) -> Suggestion {
        Suggestion { rule: self, certainty: Certainty::Choice(why.into()) }
    }

    pub(crate) fn one_of(self, why: impl Into<String>) -> Suggestion {
        Suggestion { rule: self, certainty: Certainty::OneOf(why.into()) }
    }
}

/// The rules that would own what has no owner.
pub(crate) fn of_open(open: &Open, layout: &Layout) -> Vec<Suggestion> {
    let unless_it_decides = |rule: Rule, may_decide: bool| {
        vec![if may_decide { rule.guess("its few texts may be decisions: then it is `status`") } else { rule.exact() }]
    };
    match open {
        Open::Column { place, title, may_decide, .. } if title.is_empty() => {
            unless_it_decides(ignore(&format!("column {}", place + 1)), *may_decide)
        }
        Open::Column { title, .. } if lookup(Form::Characteristics, &Heading::of(title).name).is_some() => {
            vec![
                ignore(title)
                    .guess("what its heading says would stand beside values: then name it there, nominal = \"…\""),
            ]
        }
        Open::Column { title, may_decide, .. } => {
            unless_it_decides(detail(title, layout).unwrap_or_else(|| ignore(title)), *may_decide)
        }
        Open::Characteristic { title, first } => {
            unless_it_decides(ignore(title), may_decide(first.iter().map(Cow::from)))
        }
        Open::Line { text, is_heading: true, .. } => {
            vec![line_as_it_is(text).guess("it has headings of another table")]
        }
        Open::Line { text, .. } => vec![line(text, 0)],
        Open::Row(odd) => of_odd(odd, &Shapes::default()).into_iter().collect(),
        Open::Comment { text, .. } => {
            vec![Rule::Entry("comments", escaped_heading(&text.lines().collect::<Vec<_>>().join(" "))).exact()]
        }
        Open::Unit { key, title, units } => {
            let entry = |unit: &str| Rule::Column {
                key: (*key).to_owned(),
                entry: Entry::named(&Heading::of(title).name, Some(unit)),
            };
            if let [unit] = units[..] {
                return vec![entry(unit).guess(format!("only in {unit} its numbers are of a usual size"))];
            }
            let or = if units.is_empty() { "its unit".to_owned() } else { units.join(" or ") };
            vec![entry(units.first().unwrap_or(&"?")).choice(format!("say which unit: {or}"))]
        }
        Open::Mark { .. } => each("decimal", ["comma", "point"].into_iter()),
        Open::Encoding { names } => match names[..] {
            [name] => vec![Rule::Key("encoding", quoted(name)).guess("more of its headings are known")],
            _ => each("encoding", names.iter().copied()),
        },
        Open::Sheets { names } => each("sheet", names.iter().take(20).map(String::as_str)),
        Open::Separator { able } => {
            let words: Vec<String> = able.iter().filter_map(|separator| separator.word()).collect();
            each("separator", words.iter().map(String::as_str))
        }
        Open::Twice { titles: [one, other], .. } if one != other => {
            [one, other].map(|title| ignore(title).one_of("say which of them is not used")).to_vec()
        }
        _ => Vec::new(),
    }
}

/// A column that is not used.
pub(crate) fn ignore(title: &str) -> Rule {
    Rule::Entry("ignore", escaped_heading(title))
}

/// Whether a heading can name a column that a page shows: it is a pattern there.
pub(crate) fn may_be_detail(title: &str) -> bool {
    escaped_heading(title) == title
}

/// A column that a page shows, if its heading is the key of one that has no column yet.
fn detail(title: &str, layout: &Layout) -> Option<Rule> {
    let name = normal(&Heading::of(title).name);
    let key = DETAILS.into_iter().find(|key| *key == name && layout.details.iter().all(|(known, _)| known != key))?;
    may_be_detail(title).then(|| Rule::Column { key: key.to_owned(), entry: Entry::heading(title) })
}

/// The rule for a line, `at_most` of which could be parts.
fn line(text: &str, at_most: u64) -> Suggestion {
    row(text, generalised(text), at_most)
}

/// The choice of the column of values, where nothing tells it.
pub(crate) fn no_values(want: &Want) -> Suggestion {
    let kind = want.expected.first().copied().unwrap_or(DeviationKind::RackPitch);
    let entry = Entry::named("…", Some(want.usual_unit(kind)));
    Rule::Column { key: kind.key().to_owned(), entry }.choice("say which column it is")
}

/// The choices for parts that are there more than once.
pub(crate) fn repeats() -> Vec<Suggestion> {
    each("repeats", ["last", "all"].into_iter())
}

/// The choices for the value of a key.
fn each<'v>(key: &'static str, values: impl Iterator<Item = &'v str>) -> Vec<Suggestion> {
    values.map(|value| Rule::Key(key, quoted(value)).one_of("say which")).collect()
}

/// The rule for a line as it stands in the file.
fn line_as_it_is(text: &str) -> Rule {
    Rule::Lines { exact: vec![(escaped(text.trim()), 0)], like: None, at_most: 0 }
}

/// The choice to leave out `count` lines that have the same name without a digit: they may be no parts.
pub(crate) fn named(name: &str, count: u64) -> Suggestion {
    let like = Some(format!("{};*", escaped(name)));
    Rule::Lines { exact: Vec::new(), like, at_most: count }.one_of("or the lines of that name are no part: say which")
}

/// The rule for one more line that could be a part, by a pattern of the contract.
pub(crate) fn one_more(pattern: &str, text: &str) -> Suggestion {
    row(text, pattern.to_owned(), 1)
}

/// The rule for a line: exact if the pattern is the line itself, otherwise a guess.
fn row(text: &str, like: String, at_most: u64) -> Suggestion {
    let exact = escaped(text.trim());
    let (is_same, like_any) = (like == exact, like.contains('*'));
    let rule = Rule::Lines { exact: vec![(exact, at_most)], like: (!is_same).then_some(like), at_most };
    if is_same { rule.exact() } else { rule.guess(if like_any { "whatever stands there" } else { "any number there" }) }
}

/// The rule for a row that is perhaps no part; `None` if its name looks like that of a part.
pub(crate) fn of_odd(odd: &Odd, shapes: &Shapes) -> Option<Suggestion> {
    if !odd.is_no_name && shapes.has(&odd.name) {
        return None;
    }
    if odd.text.len() + 4 > LONGEST_HEADING {
        // of a longer row the start is kept
        let (like, at_most) = (Some(escaped(&odd.text) + "*"), u64::from(odd.could_be_part));
        return Some(Rule::Lines { exact: Vec::new(), like, at_most }.guess("whatever stands there"));
    }
    if !odd.is_no_name && odd.has_text {
        let like = Some(generalised(&odd.text));
        return Some(Rule::Lines { exact: Vec::new(), like, at_most: 0 }.guess("its name is unlike those of parts"));
    }
    let at_most = u64::from(odd.could_be_part);
    Some(if odd.is_no_name && odd.name.chars().any(char::is_alphanumeric) {
        let pattern = if odd.text.starts_with(&format!("{};", odd.name)) { "{};*" } else { "*{}*" };
        row(&odd.text, pattern.replace("{}", &escaped(&odd.name)), at_most)
    } else {
        line(&odd.text, at_most)
    })
}

/// What is known of the columns of a table: their owners, their headings, the units of values by place, and what else has an owner in a
/// table with a row per characteristic.
pub(crate) struct Found<'t> {
    pub(crate) owners: &'t [Option<Owner>],
    pub(crate) titles: &'t [String],
    pub(crate) units: &'t [(usize, UnitSaid)],
    pub(crate) of: &'t [Named],
}

/// Entries of a contract for the roles that the dictionary finds, but for those of which the contract says something already. Where
/// two columns differ by their unit only, the entry has the whole heading. Units that come per row are in no entry.
pub(crate) fn pinned(Found { owners, titles, units, of }: &Found<'_>, layout: &Layout) -> Vec<Suggestion> {
    let name = |place: usize| {
        let name = Heading::of(&titles[place]).name;
        let is_alone = titles.iter().filter(|title| Heading::of(title).name == name).count() == 1;
        if is_alone { name } else { titles[place].clone() }
    };
    // the dictionary alone finds a size of a space together with the deviation beside it
    let has_deviation = |field: Field| owners.contains(&Some(Owner::Role(Role::Beside(field, Beside::Deviation))));
    let column = |(place, owner): (usize, &Option<Owner>)| {
        let Some(Owner::Role(role)) = owner else { return None };
        let (key, entry) = match role {
            _ if layout.names(*role) => return None,
            Role::Value(field) if layout.columns.iter().any(|column| column.field == *field) => return None,
            Role::PartId => ("part_id", Entry::heading(&name(place))),
            Role::Index(field) => (field.key(), Entry::heading(&name(place))),
            Role::Value(field) if !(field.is_of_space_or_tooth() && has_deviation(*field)) => {
                let (_, unit) = units.iter().find(|(at, _)| *at == place)?;
                (field.key(), Entry::named(&name(place), unit.symbol()))
            }
            _ => return None,
        };
        Some(Rule::Column { key: key.to_owned(), entry }.exact())
    };
    let of =
        of.iter().filter_map(Named::role).filter(|(_, role)| !layout.names(*role)).map(|(title, role)| {
            Rule::Column { key: key(role), entry: Entry::heading(&Heading::of(title).name) }.exact()
        });
    owners.iter().enumerate().filter_map(column).chain(of).collect()
}

/// Replaces the rules that would leave out lines such as `Teil: P1` by one that names the parts by these lines.
pub(crate) fn name_by_line(rules: &mut Vec<Suggestion>) {
    let pattern = |suggestion: &Suggestion| {
        let Rule::Lines { exact, .. } = &suggestion.rule else { return None };
        let (text, _) = exact.first()?;
        let (label, rest) = text.split_once([':', ';'])?;
        let name = rest.trim_start_matches([':', ';', ' ']);
        let is_known = lookup(Form::Parts, label.trim())?.role == Role::PartId;
        let is_alone = is_known && !name.is_empty() && !name.contains([':', ';', '*', '#']);
        is_alone.then(|| format!("{}*", &text[..text.len() - name.len()]))
    };
    let Some(line) = rules.iter().find_map(pattern) else { return };
    let names = |other: &Suggestion| matches!(&other.rule, Rule::Column { key, .. } if key == "part_id");
    rules.retain(|other| pattern(other).as_ref() != Some(&line) && !names(other));
    let entry = Entry::of([("line", quoted(&line))]);
    rules.push(Rule::Column { key: "part_id".to_owned(), entry }.guess("it names the parts below it"));
}

/// Marks a guess as confirmed by a person. Returns whether there is such a guess.
pub(crate) fn accept(rules: &mut Vec<Suggestion>, key: &str, column: &str) -> bool {
    let (name, whole) = (Heading::of(column).name, escaped_heading(column));
    let mut found = false;
    for Suggestion { rule, certainty } in rules.iter_mut() {
        let is_it = match rule {
            Rule::Column { key: own, entry } => own == key && (entry.is_of(&name) || entry.is_of(column)),
            Rule::Entry(own, text) => *own == key && *text == whole,
            Rule::Key(own, value) => *own == key && *value == quoted(&name),
            Rule::Lines { .. } => false,
        };
        if is_it && !matches!(certainty, Certainty::Choice(_)) {
            (found, *certainty) = (true, Certainty::Exact);
        }
    }
    // a column that a page shows is named in place of being left out
    if found && DETAILS.contains(&key) {
        rules.retain(|known| known.rule != Rule::Entry("ignore", whole.clone()));
    }
    // the other choices are dropped
    let is_other = |rule: &Rule| match rule {
        Rule::Column { key: own, .. } => own == key,
        Rule::Key(own, _) => *own == key,
        Rule::Entry(..) | Rule::Lines { .. } => false,
    };
    rules.retain(|known| !(found && is_other(&known.rule) && matches!(known.certainty, Certainty::OneOf(_))));
    found
}

impl Rule {
    /// What this rule shares with every rule that says the same.
    fn identity(&self, certainty: &Certainty) -> (u8, String) {
        match self {
            Self::Key(key, value) => (0, format!("{key} = {value}")),
            Self::Entry(list, text) => (if *list == "ignore" { 1 } else { 3 }, text.clone()),
            Self::Lines { exact, like, .. } => {
                (2, like.as_ref().or(exact.first().map(|(text, _)| text)).cloned().unwrap_or_default())
            }
            // each choice of a column stands for itself
            Self::Column { key, entry } if matches!(certainty, Certainty::OneOf(_)) => (5, format!("{key} = {entry}")),
            Self::Column { key, .. } => (4, key.clone()),
        }
    }

    /// Adds another rule that says the same.
    fn take(&mut self, next: Suggestion, certainty: &mut Certainty) {
        match (self, next.rule) {
            (Self::Lines { exact, at_most, .. }, Self::Lines { exact: more, at_most: most, .. })
                if !matches!(next.certainty, Certainty::OneOf(_)) =>
            {
                *at_most += most;
                let has_room = exact.len() <= MOST_EXACT;
                for (text, count) in more {
                    match exact.iter_mut().find(|(known, _)| *known == text) {
                        Some((_, known)) => *known += count,
                        None if has_room => exact.push((text, count)),
                        None => {}
                    }
                }
            }
            // what stands beside a column is found once its role is known
            (Self::Column { entry, .. }, Self::Column { entry: more, .. }) => {
                let all = entry.and(&more);
                if all != *entry {
                    (*entry, *certainty) = (all, next.certainty);
                }
            }
            _ => {}
        }
    }
}

/// Joins rules that say the same; lines of one pattern are one rule.
pub(crate) fn settle(rules: &mut Vec<Suggestion>) {
    let mut places: HashMap<(u8, String), usize> = HashMap::new();
    let mut settled: Vec<Suggestion> = Vec::new();
    for suggestion in rules.drain(..) {
        let identity = suggestion.rule.identity(&suggestion.certainty);
        let place = *places.entry(identity).or_insert(settled.len());
        match settled.get_mut(place) {
            Some(known) => known.rule.take(suggestion, &mut known.certainty),
            None => settled.push(suggestion),
        }
    }
    *rules = settled;
}

/// Adds the rules of another file. A role with a known heading in each file needs no rule, and lines that differ become one pattern.
pub(crate) fn generalise(rules: &mut Vec<Suggestion>, others: Vec<Suggestion>, file: &str) {
    for other in others {
        let is_known = |known: &&mut Suggestion| matches!((&known.rule, &other.rule), (Rule::Entry(..), _) if known.rule == other.rule);
        match &other.rule {
            _ if matches!(other.certainty, Certainty::OneOf(_)) => {
                if !rules.contains(&other) {
                    rules.push(other);
                }
            }
            // a guess in one file is one in all
            Rule::Entry(..) => match rules.iter_mut().find(is_known) {
                Some(known) if known.certainty == Certainty::Exact => known.certainty = other.certainty,
                Some(_) => {}
                None => rules.push(other),
            },
            Rule::Lines { exact, at_most, .. } => {
                let found = rules.iter_mut().find_map(|known| match &mut known.rule {
                    Rule::Lines { exact: own, like, at_most } => {
                        let ((first, _), (next, _)) = (own.first()?, exact.first()?);
                        let pattern = common(like.as_ref().unwrap_or(first), next).or_else(|| common(first, next))?;
                        Some((own, like, at_most, &mut known.certainty, pattern))
                    }
                    _ => None,
                });
                let Some((own, like, most, certainty, pattern)) = found else {
                    rules.push(other);
                    continue;
                };
                *most = (*most).max(*at_most);
                if own != exact {
                    *like = Some(pattern);
                    *certainty = Certainty::Exact;
                    own.clear();
                    own.push(exact[0].clone());
                }
            }
            Rule::Column { key, entry } => {
                let same =
                    rules.iter().position(|known| matches!(&known.rule, Rule::Column { key: own, .. } if own == key));
                match same {
                    None => rules.push(other),
                    Some(at) if matches!(&rules[at].rule, Rule::Column { entry: own, .. } if own == entry) => {}
                    // the dictionary finds both
                    Some(at) if rules[at].certainty == Certainty::Exact && other.certainty == Certainty::Exact => {
                        rules.remove(at);
                    }
                    Some(_) => rules.push(other.rule.choice(format!("in {file}"))),
                }
            }
            _ if rules.contains(&other) => {}
            Rule::Key(..) => rules.push(other),
        }
    }
}
