//! The line of headings, and the owner of each column: what the contract declares, then an exact rule, then the dictionary, then
//! patterns, then the rule for all others.

use std::borrow::Cow;

use super::open::Open;
use super::owner::{Owner, line_of};
use crate::quantity::shown;
use crate::table::cell::{Cell, Record};
use crate::table::column::UnitSaid;
use crate::table::dictionary::{Form, Heading, Known, LONGEST_HEADING, Role, is_known, lookup};
use crate::table::field::Beside;
use crate::table::layout::{Layout, OwnRule};

/// The columns of a table with their owners, before the table is closed.
#[derive(Debug, Default)]
pub(crate) struct Matched {
    /// The owner of each column; `None` if it has none.
    pub(crate) owners: Vec<Option<Owner>>,
    pub(crate) headings: Vec<Heading>,
    pub(crate) titles: Vec<String>,
    /// Place and unit of each column of values whose unit is known.
    pub(crate) units: Vec<(usize, UnitSaid)>,
    /// The heading, as a line.
    pub(crate) heading: String,
    /// The line of units below it.
    pub(crate) units_line: String,
    pub(crate) line: u64,
    /// Everything that has no owner so far.
    pub(crate) open: Vec<Open>,
    /// How much more has none.
    pub(crate) more: usize,
    /// The form of table as which it is read.
    pub(crate) form: Form,
    /// Whether all values are deviations, whatever their headings say.
    pub(crate) are_deviations: bool,
    /// What has an owner besides the columns, in a table with a row per characteristic.
    pub(crate) of: Vec<Named>,
}

/// A heading of a table with a row per characteristic, or a characteristic that a rule leaves out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Named {
    /// The place of the heading's column; `None` of a characteristic.
    pub(crate) place: Option<usize>,
    pub(crate) title: String,
    pub(crate) owner: Owner,
    /// Its first text.
    pub(crate) first: Vec<String>,
}

impl Named {
    /// The heading and its role, if it has one.
    pub(crate) fn role(&self) -> Option<(&str, Role)> {
        if let Owner::Role(role) = self.owner { Some((&self.title, role)) } else { None }
    }
}

impl Matched {
    /// Adds a column of a role.
    pub(super) fn push(&mut self, role: Role, title: &str) {
        self.owners.push(Some(Owner::Role(role)));
        self.headings.push(Heading::of(title));
        self.titles.push(title.to_owned());
    }
}

/// The role that the contract gives to a heading of that name, or the dictionary, which knows it so.
fn role(title: &str, (name, known): (&str, &Known), layout: &Layout, form: Form) -> Option<Role> {
    layout.declared(title, name, form).or_else(|| {
        let meaning = known.meaning(form)?;
        layout.ignores(title, name, usize::MAX - 1, true).is_none().then_some(meaning.role)
    })
}

/// The roles of the cells of a record that are headings.
pub(crate) fn roles<'r>(record: &'r Record, layout: &'r Layout, form: Form) -> impl Iterator<Item = Role> + 'r {
    named(record).filter_map(move |(title, name)| role(&title, (&name, &Known::of(&name)), layout, form))
}

/// The cells of a record that may be headings, each with its name.
fn named(record: &Record) -> impl Iterator<Item = (Cow<'_, str>, String)> {
    let filled = record.cells.iter().filter(|cell| !cell.is_empty() && !cell.is_number()).map(Cell::text);
    filled.map(|title| {
        let name = Heading::of(&title).name;
        (title, name)
    })
}

/// Whether a record is a line of headings: two or more of its cells have a role in one form of tables.
pub(crate) fn is_one(record: &Record, layout: &Layout) -> bool {
    let mut counts = [Form::Parts, Form::Teeth, Form::Characteristics, Form::Trace].map(|form| (form, 0));
    named(record).any(|(title, name)| {
        let known = Known::of(&name);
        let of_form = |(form, count): &mut (Form, usize)| {
            *count += usize::from(role(&title, (&name, &known), layout, *form).is_some());
            *count == 2
        };
        counts.iter_mut().any(of_form)
    })
}

/// How many headings of a record have a role; `None` if it is no line of headings. Such a line has no numbers, and a heading of
/// values. In a table of spaces or teeth it also has a heading of their numbers, unless the rows are known to be spaces or teeth; in
/// a table of characteristics one of their names.
pub(crate) fn score(record: &Record, layout: &Layout, form: Form) -> Option<usize> {
    if record.cells.iter().any(Cell::is_number) {
        return None;
    }
    let found: Vec<Role> = roles(record, layout, form).collect();
    let has = |is_it: &dyn Fn(&Role) -> bool| found.iter().any(is_it);
    let has_of = |beside: Beside| found.contains(&Role::Of(beside));
    let is_one = match form {
        Form::Characteristics => has_of(Beside::Name) && (has_of(Beside::Measured) || has_of(Beside::Deviation)),
        Form::Teeth if !layout.teeth && !has(&|role| matches!(role, Role::Index(_))) => false,
        Form::Parts | Form::Teeth | Form::Trace => has(&|role| matches!(role, Role::Value(_))),
    };
    is_one.then_some(found.len())
}

/// The place of the line of headings, and how many roles it has: the first with two of them, or else the first with one.
pub(crate) fn find(records: &[Record], layout: &Layout, form: Form) -> Option<(usize, usize)> {
    if !layout.headings.is_empty() {
        return Some((0, score(records.first()?, layout, form)?));
    }
    let headings = || {
        let each = records.iter().enumerate().filter(|(_, record)| layout.covering(record).is_none());
        each.filter_map(|(at, record)| Some((at, score(record, layout, form)?)))
    };
    headings().find(|(_, score)| *score > 1).or_else(|| headings().next())
}

/// Gives each column of a heading its owner. `below` are rows, which show what has no owner.
pub(crate) fn matched(heading: &Record, below: &[Record], layout: &Layout, form: Form) -> Matched {
    let mut titles: Vec<String> = heading.cells.iter().map(|cell| cell.text().into_owned()).collect();
    titles.resize(titles.len().max(layout.last_place()), String::new());
    let mut found = Matched { heading: line_of(heading), line: heading.line, form, ..Matched::default() };
    let mut roles: Vec<(Role, String)> = Vec::new();
    // beyond the heading, a cell rejects its row
    for (place, written) in titles.iter_mut().enumerate() {
        let title = written.clone();
        if let Some(open) = too_long(&title) {
            found.open.push(open);
            found.owners.push(None);
            found.headings.push(Heading::default());
            *written = shown(&title);
            continue;
        }
        let named = Heading::of(&title);
        let owner = owner(&title, &named.name, place, layout, form);
        let owner = beside_absolute(owner, &named.name, &roles, form);
        if let Ok(Some(Owner::Role(role))) = owner {
            if let Some((_, other)) = roles.iter().find(|(other, _)| *other == role) {
                found.open.push(Open::Twice { key: key(role), titles: [other.clone(), title.clone()] });
            }
            if let Some(unit) = named.unit.as_ref().filter(|_| !has_unit(role)) {
                let what = format!("`{}` is {}, and `{}` is a unit of no value", shown(&title), key(role), shown(unit));
                found.open.push(Open::Wrong { what, help: "correct the heading".to_owned() });
            }
            roles.push((role, title.clone()));
        }
        let is_blank = || below.iter().all(|record| record.cell(place).is_empty());
        match &owner {
            Ok(Some(Owner::Nameless)) if !is_blank() => found.open.push(Open::column(place, &title, below)),
            Ok(Some(_)) => {}
            Ok(None) => found.open.push(Open::column(place, &title, below)),
            Err(open) => found.open.push(open.clone()),
        }
        found.owners.push(owner.unwrap_or_default());
        found.headings.push(named);
    }
    found.open.extend(ignored_names(&found.owners, &titles, layout, form));
    let promised = layout.promised().filter(|(role, _)| role.is_of(form));
    for (role, name) in promised.filter(|(role, _)| !roles.iter().any(|(other, _)| other == role)) {
        found.open.push(Open::Missing { key: key(role), name: name.to_owned() });
    }
    found.titles = titles;
    found
}

/// The problem, if there is one, that a rule leaves out the only column with the names of the parts.
fn ignored_names(owners: &[Option<Owner>], titles: &[String], layout: &Layout, form: Form) -> Option<Open> {
    let is_name =
        |title: &str| lookup(form, &Heading::of(title).name).is_some_and(|meaning| meaning.role == Role::PartId);
    let is_named = owners.contains(&Some(Owner::Role(Role::PartId))) || layout.part_id.is_some();
    let mut columns = owners.iter().zip(titles).filter(|_| !is_named);
    let (_, title) = columns.find(|(owner, title)| matches!(owner, Some(Owner::Rule(_))) && is_name(title))?;
    let rule =
        layout.ignore.iter().find(|rule| rule.fits(title)).map_or_else(String::new, |rule| rule.text().to_owned());
    Some(Open::IgnoredNames { rule, title: title.clone() })
}

/// The problem that a heading or the name of a characteristic is longer than any that is read: no role and no rule owns it.
fn too_long(title: &str) -> Option<Open> {
    (title.len() > LONGEST_HEADING).then(|| Open::Wrong {
        what: format!("the heading `{}` has {} bytes", shown(title), title.len()),
        help: format!("write one of {LONGEST_HEADING} bytes at most"),
    })
}

/// The owner of a column or a characteristic; `None` if it has neither a role nor a rule.
///
/// # Errors
/// A pattern that would leave out a heading that is known, and a heading that is too long.
pub(crate) fn owner(title: &str, name: &str, place: usize, layout: &Layout, form: Form) -> Result<Option<Owner>, Open> {
    if let Some(open) = too_long(title) {
        return Err(open);
    }
    if let Some(role) = layout.declared(title, name, form) {
        return Ok(Some(Owner::Role(role)));
    }
    if let Some(rule) = layout.ignores(title, name, place, true) {
        return Ok(Some(Owner::Rule(rule)));
    }
    if form == Form::Characteristics && layout.of_format.iter().any(|own| own == title) {
        return Ok(Some(Owner::Rule(layout.own_rule(OwnRule::OfFormat))));
    }
    if title.is_empty() {
        return Ok(Some(layout.ignores(title, name, place, false).map_or(Owner::Nameless, Owner::Rule)));
    }
    let known = lookup(form, name).map(|meaning| meaning.role);
    match layout.ignores(title, name, place, false) {
        Some(rule) if known.is_some() => {
            Err(Open::Pattern { pattern: layout.ignore[rule].text().to_owned(), title: title.to_owned() })
        }
        Some(rule) => Ok(Some(Owner::Rule(rule))),
        None if known.is_some_and(|role| !layout.names(role)) => Ok(known.map(Owner::Role)),
        None => {
            let takes = layout.ignores_others && !is_known(name);
            Ok(takes.then(|| Owner::Rule(layout.own_rule(OwnRule::Others))))
        }
    }
}

/// The owner of a column. The deviation of a size of a space or tooth stands beside that size, if a column before it has the size.
fn beside_absolute(
    owner: Result<Option<Owner>, Open>,
    name: &str,
    before: &[(Role, String)],
    form: Form,
) -> Result<Option<Owner>, Open> {
    let Ok(Some(Owner::Role(Role::Value(field)))) = owner else { return owner };
    let is_deviation = |name: &str| lookup(form, name).is_some_and(|meaning| meaning.is_deviation);
    let is_absolute =
        |(role, title): &(Role, String)| *role == Role::Value(field) && !is_deviation(&Heading::of(title).name);
    let is_beside = form == Form::Teeth && is_deviation(name) && before.iter().any(is_absolute);
    Ok(Some(Owner::Role(if is_beside { Role::Beside(field, Beside::Deviation) } else { Role::Value(field) })))
}

/// Whether a heading of a role may have a unit.
fn has_unit(role: Role) -> bool {
    match role {
        Role::Value(_) => true,
        Role::Beside(_, of) | Role::Of(of) => !matches!(of, Beside::Unit | Beside::Name),
        Role::PartId | Role::Status | Role::Index(_) => false,
    }
}

/// The name of a role in messages.
pub(crate) fn key(role: Role) -> String {
    match role {
        Role::PartId => "part_id".to_owned(),
        Role::Status => "status".to_owned(),
        Role::Value(field) | Role::Index(field) => field.key().to_owned(),
        Role::Beside(field, beside) => format!("{} of {}", beside.key(), field.key()),
        Role::Of(beside) => beside.key().to_owned(),
    }
}
