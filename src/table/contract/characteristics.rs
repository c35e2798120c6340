//! Tables with a row per characteristic become tables with a row per part: the column of names says what each row is, the others
//! what its cells are. Called by [`table`](super::table).

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

use super::heading::{Matched, Named, key, matched, owner};
use super::open::{MOST_LISTED, Open};
use super::owner::{Owner, line_of};
use super::tallies::Tallies;
use crate::deviation::DeviationKind;
use crate::table::cell::{Cell, Record};
use crate::table::dictionary::{Form, Heading, Role};
use crate::table::field::{Beside, Field};
use crate::table::layout::{Layout, OwnRule, Repeats};
use crate::table::ledger::{RowLedger, digest};
use crate::table::want::Want;

/// What stands beside a value in a row of its characteristic.
const BESIDE: [Beside; 6] =
    [Beside::Nominal, Beside::Deviation, Beside::Upper, Beside::Lower, Beside::Uncertainty, Beside::Unit];

/// The table of parts.
pub(super) struct Turned {
    /// Its columns.
    pub(super) matched: Matched,
    /// The units of its columns, as the headings of the characteristics' table say them.
    pub(super) units: Record,
    pub(super) rows: Vec<Record>,
}

/// An error or a size, by the name that it has in the table.
struct Characteristic {
    field: Field,
    title: String,
    /// What stands beside its values in some row.
    beside: Vec<Beside>,
}

/// The rows of a part.
struct PartRows<'r> {
    name: Option<&'r Cell>,
    line: u64,
    /// Each of a characteristic.
    rows: Vec<(usize, &'r Record)>,
    /// A cell below no heading.
    surplus: Option<&'r Cell>,
}

impl<'r> PartRows<'r> {
    /// The row of a characteristic.
    fn row(&self, characteristic: usize) -> Option<&'r Record> {
        self.rows.iter().find(|(number, _)| *number == characteristic).map(|(_, row)| *row)
    }
}

/// Characteristics and parts as they are found row by row.
struct Reader<'r, 'l> {
    layout: &'l Layout,
    columns: &'l Matched,
    left_out: &'l mut Tallies,
    open: Vec<Open>,
    /// How much more has no owner.
    more: usize,
    found: Vec<Characteristic>,
    parts: Vec<PartRows<'r>>,
    /// The last rows of each part, by its name.
    known: HashMap<Cow<'r, str>, usize>,
    /// The owner of each name of a characteristic; of names without one some are here.
    owners: HashMap<String, Result<Option<Owner>, Box<Open>>>,
    /// The nominal values and units of those that are read.
    owned: HashSet<[String; 2]>,
    /// Digests of the names that are listed as without an owner, or as left out by a rule.
    listed: HashSet<u64>,
    /// The characteristics that a rule leaves out.
    ignored: Vec<Named>,
    /// Whether no row has an error that the spec asks for.
    lacks_error: bool,
}

/// The table of parts of the records below the line of headings.
pub(super) fn turned(
    records: &[Record],
    heading: usize,
    (layout, want): (&Layout, &Want),
    left_out: &mut Tallies,
) -> Turned {
    let below = &records[heading + 1..];
    let mut columns = matched(&records[heading], below, layout, Form::Characteristics);
    left_out.headings(&columns);
    let open = std::mem::take(&mut columns.open);
    let mut reader = Reader {
        layout,
        columns: &columns,
        left_out,
        open,
        more: 0,
        found: Vec::new(),
        parts: Vec::new(),
        known: HashMap::new(),
        owners: HashMap::new(),
        owned: HashSet::new(),
        listed: HashSet::new(),
        ignored: Vec::new(),
        lacks_error: false,
    };
    reader.look(below);
    let is_read = |kind: &DeviationKind| {
        let role = Owner::Role(Role::Value(Field::Error(*kind)));
        reader.owners.values().any(|owner| *owner == Ok(Some(role)))
    };
    reader.lacks_error = !want.expected.iter().all(is_read);
    for record in below {
        reader.row(record);
    }
    reader.missing();
    reader.turned()
}

impl<'r> Reader<'r, '_> {
    /// The column of a role.
    fn place(&self, role: Role) -> Option<usize> {
        self.columns.owners.iter().position(|owner| *owner == Some(Owner::Role(role)))
    }

    /// The column of values, and whether they are deviations.
    fn values(&self) -> Option<(usize, bool)> {
        let of = |beside| self.place(Role::Of(beside));
        of(Beside::Measured).map(|place| (place, false)).or_else(|| Some((of(Beside::Deviation)?, true)))
    }

    /// The name of a row's characteristic, if it has one.
    fn name(&self, record: &'r Record) -> Option<String> {
        let name = record.cell(self.place(Role::Of(Beside::Name))?);
        (!name.is_missing()).then(|| name.text().into_owned())
    }

    /// The nominal value and the unit of a row.
    fn nominal(&self, record: &Record) -> Option<[String; 2]> {
        let nominal = record.cell(self.place(Role::Of(Beside::Nominal))?).text().into_owned();
        let unit = self.place(Role::Of(Beside::Unit)).map(|place| record.cell(place).text().into_owned());
        nominal.contains(|c: char| ('1'..='9').contains(&c)).then(|| [nominal, unit.unwrap_or_default()])
    }

    /// Finds the owners of all names.
    fn look(&mut self, records: &'r [Record]) {
        for record in records.iter().filter(|record| self.layout.covering(record).is_none()) {
            let Some(title) = self.name(record) else { continue };
            if !self.owners.contains_key(&title) {
                let name = Heading::of(&title).name;
                let found = owner(&title, &name, usize::MAX - 1, self.layout, Form::Parts).map_err(Box::new);
                if found != Ok(None) || self.owners.len() < MOST_LISTED {
                    self.owners.insert(title.clone(), found);
                }
            }
            let is_read = matches!(self.owners.get(&title), Some(Ok(Some(Owner::Role(Role::Value(_))))));
            let nominal = self.nominal(record).filter(|_| is_read);
            self.owned.extend(nominal);
        }
    }

    fn row(&mut self, record: &'r Record) {
        if record.filled().is_empty() || self.layout.covering(record).is_some() {
            return;
        }
        let line = line_of(record);
        if line == self.columns.heading {
            return self.left_out.add(self.layout.own_rule(OwnRule::RepeatedHeadings), record.line, 0, &line);
        }
        let part = self.place(Role::PartId).map(|place| record.cell(place).text());
        if part.is_some_and(|name| self.layout.later.contains(&*name)) {
            return self.left_out.add(self.layout.own_rule(OwnRule::RepeatedParts), record.line, 0, &line);
        }
        let Some(title) = self.name(record) else {
            return self.unowned(Open::Line { line: record.line, text: line, is_heading: false });
        };
        match self.owners.get(&title).cloned().unwrap_or(Ok(None)) {
            Ok(Some(Owner::Role(Role::Value(field)))) => self.value(record, field, title),
            Ok(Some(Owner::Rule(rule))) if !self.repeats_owned(record, rule) => self.ignored(record, rule, title),
            Err(open) => self.unowned(*open),
            _ if record.filled().len() == 1 => {
                self.unowned(Open::Line { line: record.line, text: line, is_heading: false });
            }
            _ => {
                let first = self.first(record);
                self.unowned(Open::Characteristic { title, first });
            }
        }
    }

    /// Whether a name is not listed yet.
    fn is_new(&mut self, name: &str) -> bool {
        self.listed.insert(digest(0, 0, name.as_bytes()))
    }

    /// Adds what is not owned, once.
    fn unowned(&mut self, open: Open) {
        let is_new = match &open {
            Open::Characteristic { title, .. } | Open::Pattern { title, .. } => self.is_new(title),
            Open::Twice { titles, .. } => self.is_new(&titles.concat()),
            Open::Wrong { what, .. } => self.is_new(what),
            _ => true,
        };
        if self.open.len() < MOST_LISTED {
            self.open.extend(is_new.then_some(open));
        } else {
            self.more += usize::from(is_new);
        }
    }

    /// Whether the rule for all others would leave out what has the nominal value and the unit of a characteristic that is read, or what
    /// may be an error that the table lacks: it may be the same, measured again, or that error.
    fn repeats_owned(&self, record: &Record, rule: usize) -> bool {
        rule == self.layout.own_rule(OwnRule::Others)
            && (self.lacks_error || self.nominal(record).is_some_and(|nominal| self.owned.contains(&nominal)))
    }

    /// The rows of a record's part; the last ones of it.
    fn part(&mut self, record: &'r Record) -> usize {
        let name = self.place(Role::PartId).map(|place| record.cell(place));
        let text = name.map(Cell::text).unwrap_or_default();
        *self.known.entry(text).or_insert_with(|| {
            self.parts.push(PartRows { name, line: record.line, rows: Vec::with_capacity(1), surplus: None });
            self.parts.len() - 1
        })
    }

    /// The value in a row of a characteristic, as a text, if there is one.
    fn first(&self, record: &Record) -> Vec<String> {
        let places = [Beside::Measured, Beside::Deviation].map(|of| self.place(Role::Of(of)));
        let value = places.into_iter().flatten().map(|place| record.cell(place)).find(|cell| !cell.is_empty());
        value.map(|value| value.text().into_owned()).into_iter().collect()
    }

    /// A row that a rule leaves out; its part is one all the same.
    fn ignored(&mut self, record: &'r Record, rule: usize, title: String) {
        self.part(record);
        if self.ignored.len() < MOST_LISTED && self.is_new(&title) {
            let first = self.first(record);
            self.ignored.push(Named { place: None, title, owner: Owner::Rule(rule), first });
        }
        for (place, cell) in record.cells.iter().enumerate() {
            self.left_out.add(rule, record.line, place, &cell.text());
        }
    }

    /// A row with a value.
    fn value(&mut self, record: &'r Record, field: Field, title: String) {
        let known = self.found.iter().position(|characteristic| characteristic.field == field);
        let number = known.unwrap_or_else(|| {
            self.found.push(Characteristic { field, title: title.clone(), beside: Vec::new() });
            self.found.len() - 1
        });
        let mut part = self.part(record);
        let is_again = self.parts[part].row(number).is_some();
        let is_named = self.parts[part].name.is_some();
        if self.found[number].title != title || is_again && !is_named {
            let titles = [self.found[number].title.clone(), title];
            return self.unowned(Open::Twice { key: key(Role::Value(field)), titles });
        }
        if is_again {
            // the part is there twice
            let name = self.parts[part].name;
            let next = PartRows { name, line: record.line, rows: Vec::new(), surplus: None };
            if self.layout.repeats == Repeats::Last {
                let before = std::mem::replace(&mut self.parts[part], next);
                for (_, row) in before.rows {
                    self.left_out.add(self.layout.own_rule(OwnRule::RepeatedParts), row.line, 0, &line_of(row));
                }
            } else {
                self.parts.push(next);
                part = self.parts.len() - 1;
                self.known.insert(name.map(Cell::text).unwrap_or_default(), part);
            }
        }
        let ledger = RowLedger::new(record);
        for (place, owner) in self.columns.owners.iter().enumerate().take(record.cells.len()) {
            match owner {
                Some(Owner::Role(Role::Status)) => {
                    let text = ledger.read(place).text();
                    self.left_out.add(self.layout.own_rule(OwnRule::Status), record.line, place, &text);
                }
                Some(Owner::Role(role)) => {
                    let cell = ledger.read(place);
                    let beside = BESIDE.into_iter().find(|beside| *role == Role::Of(*beside) && !cell.is_missing());
                    let known = &mut self.found[number].beside;
                    if let Some(beside) = beside.filter(|beside| !known.contains(beside)) {
                        known.push(beside);
                    }
                }
                Some(Owner::Rule(rule)) => self.left_out.add(*rule, record.line, place, &ledger.read(place).text()),
                Some(Owner::Nameless) | None => {}
            }
        }
        let surplus = ledger.close().err().map(|unowned| unowned.cell);
        self.parts[part].surplus = self.parts[part].surplus.or(surplus);
        self.parts[part].rows.push((number, record));
    }

    /// The characteristics that the contract names and the table lacks.
    fn missing(&mut self) {
        let is_there = |role: Role| self.found.iter().any(|known| Role::Value(known.field) == role);
        let promised = self.layout.promised().filter(|(role, _)| matches!(role, Role::Value(_)) && !is_there(*role));
        let missing: Vec<_> =
            promised.map(|(role, name)| Open::Missing { key: key(role), name: name.to_owned() }).collect();
        self.open.extend(missing);
        if self.found.is_empty() {
            let names = self.open.iter().filter_map(|open| match open {
                Open::Characteristic { title, .. } => Some(title.clone()),
                _ => None,
            });
            self.open.insert(0, Open::NoValues { titles: names.collect() });
        }
    }

    /// What a measuring program decided of a part: of the texts in its rows the worst, of equals the first.
    fn decision(&self, part: &PartRows<'_>, place: usize) -> Cell {
        let worst = |row: &&Record| {
            let accepts = self.layout.accepts(row.cell(place).text().trim());
            (accepts.map_or(1, |accepts| if accepts { 2 } else { 0 }), row.line)
        };
        part.rows.iter().map(|(_, row)| *row).min_by_key(worst).map(|row| row.cell(place).clone()).unwrap_or_default()
    }

    /// The table of parts.
    fn turned(mut self) -> Turned {
        self.known = HashMap::new();
        let mut matched = Matched { line: self.columns.line, open: Vec::new(), ..Matched::default() };
        let mut units: Vec<Cell> = Vec::new();
        // which column of the characteristics' table each column is of which characteristic
        let mut sources: Vec<(usize, usize)> = Vec::new();
        let id = self.place(Role::PartId);
        if let Some(id) = id {
            matched.push(Role::PartId, &self.columns.titles[id]);
            units.push(Cell::default());
        }
        let status = self.place(Role::Status);
        if let Some(status) = status {
            matched.push(Role::Status, &self.columns.titles[status]);
            units.push(Cell::default());
        }
        let values = self.values();
        matched.are_deviations = values.is_some_and(|(_, are_deviations)| are_deviations);
        for (number, characteristic) in self.found.iter().enumerate() {
            let Some((value, are_deviations)) = values else { continue };
            matched.push(Role::Value(characteristic.field), &characteristic.title);
            units.push(Cell::of_text(self.columns.headings[value].unit.as_deref().unwrap_or_default()));
            sources.push((number, value));
            for beside in &characteristic.beside {
                let place = self.place(Role::Of(*beside)).filter(|_| !(are_deviations && *beside == Beside::Deviation));
                let Some(place) = place else { continue };
                matched.push(Role::Beside(characteristic.field, *beside), &self.columns.titles[place]);
                units.push(Cell::default());
                sources.push((number, place));
            }
        }
        let row = |part: &PartRows<'_>| {
            let cell = |(number, place): &(usize, usize)| {
                part.row(*number).map(|row| row.cell(*place).clone()).unwrap_or_default()
            };
            let id = id.map(|_| part.name.cloned().unwrap_or_default());
            let status = status.map(|place| self.decision(part, place));
            let cells = id.into_iter().chain(status).chain(sources.iter().map(cell)).chain(part.surplus.cloned());
            Record::new(cells.collect(), part.line)
        };
        let rows = self.parts.iter().map(row).collect();
        (matched.open, matched.more) = (self.open, self.more);
        let owned = self.columns.owners.iter().zip(&self.columns.titles);
        let of = owned.enumerate().filter_map(|(place, (owner, title))| match owner {
            Some(owner @ (Owner::Role(Role::Of(_)) | Owner::Rule(_))) => {
                Some(Named { place: Some(place), title: title.clone(), owner: *owner, first: Vec::new() })
            }
            _ => None,
        });
        matched.of = of.chain(self.ignored).collect();
        Turned { matched, units: Record::new(units, self.columns.line), rows }
    }
}
