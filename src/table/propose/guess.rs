//! Guesses for a person of what columns without an owner are. They rest on the numbers of a column, on how similar its heading is to
//! known ones, and on which errors are missing. A guess counts only once a person confirms it.

use std::collections::{BTreeMap, HashMap};

use super::entry::Entry;
use super::rules::{Certainty, Rule, Suggestion, ignore, may_be_detail};
use crate::deviation::DeviationKind;
use crate::table::cell::{Cell, Record};
use crate::table::column::UnitSaid;
use crate::table::contract::{Matched, Open, Owner, fits_beside, plausible_units};
use crate::table::dictionary::{Form, Heading, Role, headings_of, lookup, normal};
use crate::table::field::Field;
use crate::table::grid::unit_of;
use crate::table::pattern::escaped_heading;
use crate::table::want::{Want, quoted};

/// Columns that are looked at, at most.
const MOST: usize = 100;
/// Rows whose numbers are measured, at most.
const MOST_MEASURED: usize = 100;
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
    pub(crate) entry: Entry,
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
    /// What its numbers may be, each with the units in which they may be it.
    able: Vec<(Field, Vec<&'static str>)>,
}

impl Candidate<'_> {
    /// Finds what its numbers may be. The points of a measured curve may have any size.
    fn measure(mut self, form: Form, rows: &[Record], want: &Want) -> Self {
        if !self.is_numeric() {
            return self;
        }
        let rows = &rows[..rows.len().min(MOST_MEASURED)];
        let own = self.unit.as_deref();
        let of_error = |kind| (Field::Error(kind), plausible_units(kind, (self.title, own), self.place, rows, want));
        self.able = match form {
            Form::Trace if own.is_none_or(|unit| unit_of(unit, false).is_some()) => {
                [Field::Stroke, Field::DeltaCd].map(|field| (field, vec!["mm", "um"])).into()
            }
            Form::Trace => Vec::new(),
            _ => DeviationKind::ALL.into_iter().map(of_error).filter(|(_, units)| !units.is_empty()).collect(),
        };
        self
    }

    /// Whether a heading near that of a value can tell that the column has it: where it has a unit of its own, its size need not fit.
    fn may_be_called(&self, field: Field) -> bool {
        let own = self.unit.as_deref().filter(|_| self.is_numeric());
        own.map_or_else(|| self.may_be(field), |unit| unit_of(unit, field.is_angle()).is_some())
    }

    fn may_be(&self, field: Field) -> bool {
        self.able.iter().any(|(able, _)| *able == field)
    }

    /// The entry of a contract that gives it a role.
    fn entry(&self, field: Field) -> Entry {
        let units = self.able.iter().find(|(able, _)| *able == field).map_or(&[][..], |(_, units)| units);
        let unit = self.unit.as_deref().or(if let [unit] = units { Some(*unit) } else { None });
        Entry::named(&self.name, unit)
    }

    /// Whether most of its cells are numbers.
    fn is_numeric(&self) -> bool {
        let numbers = self.cells.iter().filter(|cell| cell.is_number()).count();
        numbers * 2 > self.cells.len()
    }

    /// How similar its name is to the most similar heading of a role, from 0 to 1.
    fn nearness(&self, role: Role) -> f64 {
        let name = normal(&self.name);
        headings_of(role).map(|heading| strsim::sorensen_dice(&name, heading)).fold(0.0, f64::max)
    }

    fn guess(&self, key: &str, entry: Entry, why: &'static str) -> Guess {
        Guess { place: self.place, title: self.title.to_owned(), key: key.to_owned(), why, entry }
    }
}

/// The guesses for the columns of a table, at most one for each.
pub(crate) fn guesses(matched: &Matched, rows: &[Record], want: &Want) -> Vec<Guess> {
    let left = candidates(matched, &matched.open, rows).take(MOST);
    let mut left: Vec<Candidate<'_>> = left.map(|column| column.measure(matched.form, rows, want)).collect();
    let has = |role: Role| matched.owners.contains(&Some(Owner::Role(role)));
    let mut guesses = characteristics(&left);
    if !guesses.is_empty() {
        return guesses;
    }
    guesses.extend(beside(&left, matched, rows, want));
    left.retain(|column| !guesses.iter().any(|guess| guess.place == column.place));
    guesses.extend(values(&mut left, matched, want));
    // a name or a decision has no unit
    left.retain(|column| column.unit.is_none() && matched.form != Form::Trace);
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
    let rule = Rule::Column { key: "date".to_owned(), entry: Entry::heading(column.title) };
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
            Some(Candidate { place: *place, title, name, unit, cells, able: Vec::new() })
        }
        _ => None,
    })
}

/// The values that a table must have and lacks: the errors of the spec, or what the points of a measured curve have. Of a table of
/// teeth no more is known.
fn lacking(matched: &Matched, want: &Want) -> Vec<Field> {
    let all: Vec<Field> = match matched.form {
        Form::Parts => want.expected.iter().copied().map(Field::Error).collect(),
        Form::Trace => vec![Field::Stroke, Field::DeltaCd],
        Form::Teeth | Form::Characteristics => Vec::new(),
    };
    all.into_iter().filter(|field| !matched.owners.contains(&Some(Owner::Role(Role::Value(*field))))).collect()
}

/// Where no column is known or guessed to hold values that the table lacks, adds a choice for each column that may hold them, and leaves
/// it to a person to leave out such a column. The rule that leaves out a column whose heading is near one of an error becomes a guess.
pub(crate) fn undecided(
    matched: &Matched,
    (open, rows): (&[Open], &[Record]),
    want: &Want,
    guesses: &[Guess],
    rules: &mut Vec<Suggestion>,
) {
    let is_guessed = |field: &Field| guesses.iter().any(|guess| guess.key == field.key());
    let missing: Vec<Field> = lacking(matched, want).into_iter().filter(|field| !is_guessed(field)).collect();
    let (mut doubtful, mut choices): (HashMap<String, Certainty>, Vec<Suggestion>) = (HashMap::new(), Vec::new());
    let choice = |field: &Field, entry: Entry| {
        Rule::Column { key: field.key().to_owned(), entry }
            .one_of("values that the table lacks: say which column has them")
    };
    let doubt = || Certainty::Doubt("perhaps values that the table lacks: say whether it is not used".to_owned());
    for (at, column) in candidates(matched, open, rows).enumerate() {
        if guesses.iter().any(|guess| guess.place == column.place) {
            continue;
        }
        let column = if at < MOST { column.measure(matched.form, rows, want) } else { column };
        let able: Vec<&Field> = missing.iter().filter(|field| column.may_be(**field)).collect();
        let is_near = |kind: DeviationKind| {
            let role = Role::Value(Field::Error(kind));
            let is_found = matched.owners.contains(&Some(Owner::Role(role))) || is_guessed(&Field::Error(kind));
            !is_found && column.nearness(role) >= NEAR && column.is_numeric()
        };
        if !able.is_empty() || at >= MOST && !missing.is_empty() {
            doubtful.entry(escaped_heading(column.title)).or_insert_with(doubt);
        } else if at < MOST && matched.form == Form::Parts && DeviationKind::ALL.into_iter().any(is_near) {
            let near = || Certainty::Guess(IS_NEAR.to_owned());
            doubtful.entry(escaped_heading(column.title)).or_insert_with(near);
        }
        choices.extend(able.into_iter().map(|field| choice(field, column.entry(*field))));
    }
    for open in open.iter().filter(|_| !missing.is_empty()) {
        let Open::Characteristic { title, .. } = open else { continue };
        doubtful.entry(escaped_heading(title)).or_insert_with(doubt);
        choices.extend(missing.iter().map(|field| choice(field, Entry::named(title, None))));
    }
    choices.truncate(MOST);
    for Suggestion { rule, certainty } in rules.iter_mut().filter(|known| known.certainty == Certainty::Exact) {
        let Rule::Entry("ignore", text) = rule else { continue };
        if let Some(doubt) = doubtful.get(text) {
            *certainty = doubt.clone();
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
    let part =
        columns.iter().find(|column| column.place != names.place && column.unit.is_none() && !column.is_numeric());
    let guess = |column: &Candidate<'_>, key: &str, why| column.guess(key, Entry::heading(column.title), why);
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
    Some(column.guess("part_id", Entry::heading(column.title), why))
}

/// The columns that have values which the table lacks, by their headings or because nothing else can be it; those of any error if the
/// spec asks for none.
fn values(left: &mut Vec<Candidate<'_>>, matched: &Matched, want: &Want) -> Vec<Guess> {
    // what the contract names is not guessed
    let is_free = |field: &Field| !want.layout.names(Role::Value(*field));
    let asked: Vec<Field> = lacking(matched, want).into_iter().filter(is_free).collect();
    let mut all = asked.clone();
    if matched.form != Form::Trace {
        let is_new =
            |field: &Field| !asked.contains(field) && !matched.owners.contains(&Some(Owner::Role(Role::Value(*field))));
        all.extend(DeviationKind::ALL.into_iter().map(Field::Error).filter(is_free).filter(is_new));
    }
    let least = |field: Field| if want.expected.is_empty() || asked.contains(&field) { NEAR } else { VERY_NEAR };
    let mut guesses: Vec<Guess> = Vec::new();
    loop {
        let is_left = |field: &&Field| !guesses.iter().any(|guess| guess.key == field.key());
        let pairs = |is_able: &dyn Fn(&Candidate<'_>, Field) -> bool| -> Vec<(usize, Field)> {
            let each = left.iter().enumerate().flat_map(|(at, column)| {
                let able = all.iter().filter(is_left).filter(|field| is_able(column, **field));
                able.map(move |field| (at, *field)).collect::<Vec<_>>()
            });
            each.collect()
        };
        let near = pairs(&|column, field| column.may_be_called(field)).into_iter();
        let near = near.map(|(at, field)| (at, field, left[at].nearness(Role::Value(field))));
        let near = near.filter(|(_, field, near)| *near >= least(*field));
        let near = near.max_by(|one, other| one.2.total_cmp(&other.2)).map(|(at, field, _)| (at, field, IS_NEAR));
        let asked = pairs(&|column, field| asked.contains(&field) && column.may_be(field));
        let is_only =
            |(at, field): &(usize, Field)| asked.iter().filter(|(other, of)| other == at || of == field).count() == 1;
        let only = || {
            asked
                .iter()
                .find(|pair| is_only(pair))
                .map(|(at, field)| (*at, *field, "the only column of numbers that can be it"))
        };
        let Some((at, field, why)) = near.or_else(only) else { return guesses };
        let column = left.remove(at);
        guesses.push(column.guess(field.key(), column.entry(field), why));
    }
}

/// The columns beside known values: the units of each row, where nothing else gives a unit, and nominal values with the deviations from
/// them, by the numbers.
fn beside(left: &[Candidate<'_>], matched: &Matched, rows: &[Record], want: &Want) -> Vec<Guess> {
    /// How many columns apart they are, at most.
    const FAR: usize = 4;
    let is_value = |(place, owner): (usize, &Option<Owner>)| match owner {
        Some(Owner::Role(Role::Value(field @ Field::Error(_)))) => Some((place, *field)),
        _ => None,
    };
    let values: Vec<_> = matched.owners.iter().enumerate().filter_map(is_value).collect();
    let mut guesses: Vec<Guess> = Vec::new();
    for (at, (place, field)) in values.iter().enumerate() {
        let next = values.get(at + 1).map_or(usize::MAX, |(next, _)| *next);
        let behind = || left.iter().filter(|column| (*place..next).contains(&column.place));
        let unit = matched.units.iter().find(|(known, _)| known == place);
        let Heading { name, unit: in_heading } = &matched.headings[*place];
        let by_key = in_heading.is_none() && lookup(matched.form, name).is_some_and(|meaning| meaning.is_key);
        let is_unit = |cell: &&Cell| unit_of(&cell.text(), field.is_angle()).is_some();
        let are_units = |column: &&Candidate<'_>| !column.cells.is_empty() && column.cells.iter().all(is_unit);
        if let Some(units) = behind().find(are_units).filter(|_| unit.is_none() || by_key) {
            let entry = Entry::of([("name", quoted(name)), ("units", quoted(units.title))]);
            guesses.push(units.guess(field.key(), entry, "its cells are units"));
            continue;
        }
        let Some((_, UnitSaid::Same(unit))) = unit else { continue };
        let numbers = || left.iter().filter(|column| column.place.abs_diff(*place) <= FAR && column.is_numeric());
        let of = (*field, &*matched.titles[*place], *place, *unit);
        let own = |column: &Candidate<'_>| (column.place, column.unit.clone());
        let pair = numbers().find_map(|nominal| {
            let ((one, one_unit), is_free) = (own(nominal), |place| guesses.iter().all(|guess| guess.place != place));
            let fits = |other: &&Candidate<'_>| {
                let (two, two_unit) = own(other);
                one != two
                    && is_free(one)
                    && is_free(two)
                    && fits_beside(of, [(one, one_unit.as_deref()), (two, two_unit.as_deref())], rows, want)
            };
            numbers().find(fits).map(|deviation| [("nominal", nominal), ("deviation", deviation)])
        });
        for (key, column) in pair.into_iter().flatten() {
            let entry = Entry::of([(key, quoted(column.title))]);
            guesses.push(column.guess(
                field.key(),
                entry,
                "by the numbers, deviations are the values less the nominal ones",
            ));
        }
    }
    guesses
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
    let texts = [("accept", format!("[{}]", quoted(accept))), ("reject", format!("[{}]", others.join(", ")))];
    let entry = Entry::of([("name", quoted(&column.name))].into_iter().chain(texts));
    Some(column.guess("status", entry, "its few texts may be decisions"))
}
