//! Guesses for a person of what columns without an owner are. They rest on the numbers of a column, on how similar its heading is to
//! known ones, and on which errors are missing. A guess counts only once a person confirms it.

use std::collections::BTreeMap;

use super::rules::{Certainty, Rule, Suggestion, ignore, may_be_detail};
use crate::deviation::DeviationKind;
use crate::table::cell::{Cell, Record};
use crate::table::contract::{Matched, Open, Owner, plausible_units};
use crate::table::dictionary::{Form, Heading, Role, headings_of, lookup, normal};
use crate::table::field::Field;
use crate::table::grid::unit_of;
use crate::table::pattern::escaped_heading;
use crate::table::want::{Want, quoted};

/// Columns that are looked at, at most.
const MOST: usize = 100;
/// The least nearness of a heading to one of an error that the spec asks for.
const NEAR: f64 = 0.6;
/// The least nearness of a heading to one of any other error.
const VERY_NEAR: f64 = 0.75;

const IS_NEAR: &str = "its heading is near one that is known";

/// What a column may be.
#[derive(Debug)]
pub(crate) struct Guess {
    pub(crate) place: usize,
    pub(crate) title: String,
    pub(crate) key: String,
    pub(crate) why: &'static str,
    entry: String,
}

impl Guess {
    pub(crate) fn suggestion(self) -> Suggestion {
        Rule::Column { key: self.key, entry: self.entry }.guess(self.why)
    }
}

/// A column without an owner.
struct Candidate<'c> {
    place: usize,
    title: &'c str,
    name: String,
    /// The unit in its heading, or in the line of units.
    unit: Option<String>,
    cells: Vec<&'c Cell>,
}

impl Candidate<'_> {
    /// The units in which its numbers may be values of an error; none if its own unit is of another quantity.
    fn units(&self, kind: DeviationKind, rows: &[Record], want: &Want) -> Vec<&'static str> {
        let is_other = |unit: &String| unit_of(unit, Field::Error(kind).is_angle()).is_none();
        let found = plausible_units(kind, self.title, self.place, rows, want);
        if self.unit.as_ref().is_some_and(is_other) { Vec::new() } else { found }
    }

    /// The entry of a contract that makes it the column of an error.
    fn entry(&self, kind: DeviationKind, rows: &[Record], want: &Want) -> String {
        let unit = self.unit.clone().or_else(|| match self.units(kind, rows, want)[..] {
            [unit] => Some(unit.to_owned()),
            _ => None,
        });
        let unit = unit.map_or_else(String::new, |unit| format!(", unit = {}", quoted(&unit)));
        format!("{{ name = {}{unit} }}", quoted(&self.name))
    }

    /// Whether at least nine of ten of its cells are numbers.
    fn is_numeric(&self) -> bool {
        let numbers = self.cells.iter().filter(|cell| cell.is_number()).count();
        numbers > 0 && numbers * 10 >= self.cells.len() * 9
    }

    /// How similar its name is to the most similar heading of a role, from 0 to 1.
    fn nearness(&self, role: Role) -> f64 {
        let name = normal(&self.name);
        headings_of(role).map(|heading| strsim::sorensen_dice(&name, heading)).fold(0.0, f64::max)
    }

    fn guess(&self, key: &str, entry: String, why: &'static str) -> Guess {
        Guess { place: self.place, title: self.title.to_owned(), key: key.to_owned(), why, entry }
    }
}

/// The guesses for the columns of a table, at most one for each.
pub(crate) fn guesses(matched: &Matched, rows: &[Record], want: &Want) -> Vec<Guess> {
    let mut left: Vec<Candidate<'_>> = candidates(matched, &matched.open, rows).take(MOST).collect();
    let has = |role: Role| matched.owners.contains(&Some(Owner::Role(role)));
    let mut guesses = characteristics(&left);
    if !guesses.is_empty() {
        return guesses;
    }
    guesses.extend(values(&mut left, rows, want, &|kind| has(Role::Value(Field::Error(kind)))));
    let has_values = matched.owners.iter().any(|owner| matches!(owner, Some(Owner::Role(Role::Value(_)))));
    let status = left.iter().filter(|_| !has(Role::Status)).find_map(status);
    left.retain(|column| status.as_ref().is_none_or(|status| status.place != column.place));
    if !has(Role::PartId) && (has_values || !guesses.is_empty()) {
        guesses.extend(name_of_part(&left));
    }
    guesses.extend(status);
    guesses
}

/// A column of dates that a page can show as the date of the parts; nothing tells of what it is the date.
pub(crate) fn date(matched: &Matched, open: &[Open], rows: &[Record], rules: &[Suggestion]) -> Option<Suggestion> {
    let is_date_known = |known: &Suggestion| matches!(&known.rule, Rule::Column { key, .. } if key == "date");
    let is_dated = |column: &Candidate<'_>| {
        let is_free = rules.iter().any(|known| known.rule == ignore(column.title));
        is_free
            && may_be_detail(column.title)
            && !column.cells.is_empty()
            && column.cells.iter().all(|cell| is_date(&cell.text()))
    };
    let column = candidates(matched, open, rows).take(MOST).find(is_dated)?;
    let rule = Rule::Column { key: "date".to_owned(), entry: quoted(column.title) };
    (!rules.iter().any(is_date_known))
        .then(|| rule.one_of("in place of the column in `ignore`: its texts are dates, which a page can show"))
}

/// Whether a text begins with year, month and day, or with day or month first and the year last.
fn is_date(text: &str) -> bool {
    let day = text.trim().split([' ', 'T']).next().unwrap_or_default();
    let Some(mark) = day.chars().find(|c| !c.is_ascii_digit()).filter(|c| matches!(c, '-' | '.' | '/')) else {
        return false;
    };
    let lengths: Vec<_> = day.split(mark).map(|part| part.parse::<u32>().map_or(0, |_| part.len())).collect();
    matches!(lengths[..], [4, 1 | 2, 1 | 2] | [1 | 2, 1 | 2, 4])
}

/// The columns without an owner.
fn candidates<'c>(
    matched: &'c Matched,
    open: &'c [Open],
    rows: &'c [Record],
) -> impl Iterator<Item = Candidate<'c>> + 'c {
    open.iter().filter_map(move |open| match open {
        Open::Column { place, title, .. } if !title.is_empty() && matched.titles.get(*place) == Some(title) => {
            let cells = rows.iter().map(|row| row.cell(*place)).filter(|cell| !cell.is_missing()).collect();
            let Heading { name, unit } = matched.headings[*place].clone();
            Some(Candidate { place: *place, title, name, unit, cells })
        }
        _ => None,
    })
}

/// Where no column is known or guessed to hold an error that the spec asks for, adds a choice for each column that may hold it. The
/// rule that leaves out such a column becomes a guess; so does the rule for a column whose heading is near one of an error that the
/// table lacks.
pub(crate) fn undecided(
    matched: &Matched,
    (open, rows): (&[Open], &[Record]),
    want: &Want,
    guesses: &[Guess],
    rules: &mut Vec<Suggestion>,
) {
    let is_found = |kind: &DeviationKind| {
        matched.owners.contains(&Some(Owner::Role(Role::Value(Field::Error(*kind)))))
            || guesses.iter().any(|guess| guess.key == kind.key())
    };
    if !matches!(matched.form, Form::Parts) {
        return;
    }
    let missing: Vec<DeviationKind> = want.expected.iter().copied().filter(|kind| !is_found(kind)).collect();
    let (mut doubtful, mut choices): (Vec<(String, &str)>, Vec<Suggestion>) = (Vec::new(), Vec::new());
    let choice = |kind: &DeviationKind, entry: String| {
        Rule::Column { key: kind.key().to_owned(), entry }.one_of("or another column, or none: say which")
    };
    for (at, column) in candidates(matched, open, rows).enumerate() {
        if guesses.iter().any(|guess| guess.place == column.place) {
            continue;
        }
        let able = missing.iter().filter(|kind| at < MOST && !column.units(**kind, rows, want).is_empty());
        let able: Vec<&DeviationKind> = able.filter(|_| column.is_numeric()).collect();
        let is_near = |kind: &DeviationKind| {
            !is_found(kind) && column.nearness(Role::Value(Field::Error(*kind))) >= NEAR && column.is_numeric()
        };
        if !able.is_empty() || at >= MOST && !missing.is_empty() {
            doubtful.push((escaped_heading(column.title), "it may be an error that the spec asks for"));
        } else if at < MOST && DeviationKind::ALL.iter().any(is_near) {
            doubtful.push((escaped_heading(column.title), IS_NEAR));
        }
        choices.extend(able.into_iter().map(|kind| choice(kind, column.entry(*kind, rows, want))));
    }
    for open in open.iter().filter(|_| !missing.is_empty()) {
        let Open::Characteristic { title, .. } = open else { continue };
        doubtful.push((escaped_heading(title), "it may be an error that the spec asks for"));
        choices.extend(missing.iter().map(|kind| choice(kind, format!("{{ name = {} }}", quoted(title)))));
    }
    choices.truncate(MOST);
    for Suggestion { rule, certainty } in rules.iter_mut().filter(|known| known.certainty == Certainty::Exact) {
        let Rule::Entry("ignore", text) = rule else { continue };
        if let Some((_, why)) = doubtful.iter().find(|(title, _)| title == text) {
            *certainty = Certainty::Guess((*why).to_owned());
        }
    }
    rules.extend(choices);
}

/// Guesses for a table with a row per characteristic: the column of their names, half of which or more are headings of errors, that of
/// their values, and that of the part.
fn characteristics(columns: &[Candidate<'_>]) -> Vec<Guess> {
    let is_error = |cell: &&&Cell| {
        let meaning = lookup(Form::Parts, &Heading::of(&cell.text()).name);
        meaning.is_some_and(|meaning| matches!(meaning.role, Role::Value(_)))
    };
    let names = columns.iter().find(|column| {
        let known = column.cells.iter().filter(is_error).count();
        known > 0 && known * 2 >= column.cells.len()
    });
    let values = columns.iter().find(|column| column.is_numeric());
    let Some((names, values)) = names.zip(values) else { return Vec::new() };
    let part = columns.iter().find(|column| column.place != names.place && !column.is_numeric());
    let guess = |column: &Candidate<'_>, key: &str, why| column.guess(key, quoted(column.title), why);
    let mut guesses = vec![
        guess(names, "name", "its texts are headings of errors"),
        guess(values, "actual", "the first column of numbers"),
    ];
    guesses.extend(part.map(|part| guess(part, "part_id", "the first column of texts")));
    guesses
}

/// The column that may name the parts: its texts all differ.
fn name_of_part(columns: &[Candidate<'_>]) -> Option<Guess> {
    let is_distinct = |column: &Candidate<'_>| {
        let mut texts: Vec<_> = column.cells.iter().map(|cell| cell.text()).collect();
        let count = texts.len();
        texts.sort_unstable();
        texts.dedup();
        count > 0 && texts.len() == count
    };
    let mut able = columns.iter().filter(|column| is_distinct(column));
    let near = able.clone().find(|column| column.nearness(Role::PartId) >= NEAR).map(|column| (column, IS_NEAR));
    let first = able.find(|column| column.place == 0 && !column.is_numeric());
    let (column, why) = near.or(first.map(|column| (column, "the first column, whose texts differ")))?;
    Some(column.guess("part_id", quoted(column.title), why))
}

/// The columns that may have the values of errors that the spec asks for; of any error if it asks for none.
fn values(
    left: &mut Vec<Candidate<'_>>,
    rows: &[Record],
    want: &Want,
    is_found: &dyn Fn(DeviationKind) -> bool,
) -> Vec<Guess> {
    let asked = if want.expected.is_empty() { DeviationKind::ALL.to_vec() } else { want.expected.clone() };
    let mut missing: Vec<DeviationKind> = asked.into_iter().filter(|kind| !is_found(*kind)).collect();
    let (mut guesses, mut taken) = (Vec::new(), Vec::new());
    let units = |column: &Candidate<'_>, kind: DeviationKind| column.units(kind, rows, want);
    loop {
        let is_left = |kind: &DeviationKind| !is_found(*kind) && !taken.contains(kind);
        let kinds: Vec<DeviationKind> = DeviationKind::ALL.into_iter().filter(is_left).collect();
        let pairs = left.iter().enumerate().filter(|(_, column)| column.is_numeric()).flat_map(|(at, column)| {
            kinds.iter().map(move |kind| (at, *kind, column.nearness(Role::Value(Field::Error(*kind)))))
        });
        let least = |kind: &DeviationKind| if missing.contains(kind) { NEAR } else { VERY_NEAR };
        let near = pairs.filter(|(at, kind, near)| *near >= least(kind) && !units(&left[*at], *kind).is_empty());
        let near = near.max_by(|one, other| one.2.total_cmp(&other.2));
        let found = near.map(|(at, kind, _)| (at, kind, IS_NEAR)).or_else(|| {
            let [kind] = missing[..] else { return None };
            let mut able =
                left.iter().enumerate().filter(|(_, column)| column.is_numeric() && !units(column, kind).is_empty());
            let (at, _) = able.next().filter(|_| !want.expected.is_empty())?;
            able.next().is_none().then_some((at, kind, "the only column of numbers that can be it"))
        });
        let Some((at, kind, why)) = found else { return guesses };
        let column = left.remove(at);
        missing.retain(|other| *other != kind);
        taken.push(kind);
        guesses.push(column.guess(kind.key(), column.entry(kind, rows, want), why));
    }
}

/// A column of decisions: a few texts, of which one ends in another, as `n.i.O.` in `i.O.`
fn status(column: &Candidate<'_>) -> Option<Guess> {
    const MOST: usize = 4;
    let mut texts: BTreeMap<String, usize> = BTreeMap::new();
    for cell in column.cells.iter().filter(|cell| !cell.is_number()) {
        *texts.entry(cell.text().into_owned()).or_default() += 1;
        if texts.len() > MOST {
            return None;
        }
    }
    let lower = |text: &String| text.to_lowercase();
    let is_within = |short: &String, long: &String| short != long && lower(long).ends_with(&lower(short));
    let accept = texts.keys().find(|short| texts.keys().any(|long| is_within(short, long)))?;
    let others: Vec<String> = texts.keys().filter(|text| *text != accept).map(|text| quoted(text)).collect();
    let entry = format!(
        "{{ name = {}, accept = [{}], reject = [{}] }}",
        quoted(&column.name),
        quoted(accept),
        others.join(", ")
    );
    Some(column.guess("status", entry, "its few texts may be decisions"))
}
