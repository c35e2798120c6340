//! From records to a closed table, whatever file they are of.

use std::borrow::Cow;
use std::sync::Arc;

use super::Contract;
use super::characteristics::{self, Turned};
use super::columns::columns;
use super::heading::{Matched, Named, find, key, matched, roles};
use super::open::{Open, list};
use super::owner::{Owner, line_of};
use super::tallies::Tallies;
use super::units::{line_of_units, own_units};
use super::unowned::{is_bare, likely_heading, no_headings, no_parts, no_values, not_cut, open_to_others, unowned};
use super::whole::{last_of_each, named, own_headings};
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::Unit;
use crate::table::Table;
use crate::table::account::{Proposal, Unclosed};
use crate::table::cell::{MOST_CELLS, Record, cells_in, refuse_many};
use crate::table::column::{Column, UnitFrom, is_rack};
use crate::table::dictionary::{Form, Role};
use crate::table::encoding::Encoding;
use crate::table::field::Beside;
use crate::table::layout::{IsCurve, Layout, OwnRule, Parts, Repeats};
use crate::table::ledger::Tally;
use crate::table::number::DecimalMark;
use crate::table::pattern::Pattern;
use crate::table::pieces::{Pieces, Place};
use crate::table::reading::{ColumnReading, Reading};
use crate::table::rows::Setup;
use crate::table::want::Want;
use crate::table::{column_reading_of, named_only};

/// What is known of a file besides its records.
#[derive(Clone)]
pub(crate) struct File<'f> {
    pub(crate) name: &'f str,
    pub(crate) format: &'static str,
    /// What has no owner outside the records, such as a comment.
    pub(crate) open: Vec<Open>,
    /// How many more things have no owner there.
    pub(crate) more: usize,
    /// What rules left out there, by their numbers.
    pub(crate) left_out: Vec<(usize, Tally)>,
    /// What the format writes besides values.
    pub(crate) said: Tally,
    /// The tolerance that the file gives for the column at a place and in a unit, mm or degrees.
    pub(crate) widest: Option<&'f dyn Fn(usize, Unit) -> Option<f64>>,
    /// What separates the cells of a text whose rows are streamed.
    pub(crate) separator: Option<u8>,
}

/// A closed table without its rows, and where they begin.
pub(crate) struct Found {
    pub(crate) table: Table,
    /// The records before the first row.
    pub(crate) above: usize,
    /// The place of the heading among them.
    pub(crate) heading: usize,
    /// Rows in place of the records: made from columns or characteristics, or with names of parts from lines of their own.
    pub(crate) turned: Option<Vec<Record>>,
}

impl<'f> File<'f> {
    /// Gives a column the tolerance that the file has for it.
    fn tell_tolerance(&self, column: &mut Column) {
        column.tolerance = self.widest.and_then(|widest| widest(column.place, column.unit));
    }

    /// Adds a comment or the like to what a rule leaves out, or to what has no owner.
    pub(crate) fn comment(&mut self, layout: &Layout, place: &str, text: &str) {
        match layout.comments.iter().position(|rule| rule.fits(text)) {
            Some(rule) => self.leave_out(layout.rule_of_comment(rule), 0, &format!("{place}: {text}")),
            None => self.open.push(Open::Comment { place: place.to_owned(), text: text.to_owned() }),
        }
    }

    /// Adds comments that a rule left out before. They have no owner where the contract lacks that rule.
    pub(crate) fn comments(&mut self, layout: &Layout, rule: &Pattern, tally: &Tally) {
        match layout.comments.iter().position(|known| known == rule) {
            Some(rule) => self.left_out.push((layout.rule_of_comment(rule), tally.clone())),
            None => self
                .open
                .extend(tally.first.iter().map(|text| Open::Comment { place: String::new(), text: text.clone() })),
        }
    }

    /// Counts a text, at a line or with a digest of what it stands for, for the rule of that number.
    pub(crate) fn leave_out(&mut self, rule: usize, line: u64, text: &str) {
        if self.left_out.last().is_none_or(|(last, _)| *last != rule) {
            self.left_out.push((rule, Tally::default()));
        }
        if let Some((_, tally)) = self.left_out.last_mut() {
            tally.add(line, 0, text);
        }
    }

    /// A file of which nothing but its records is known.
    pub(crate) fn new(name: &'f str, format: &'static str) -> Self {
        Self {
            name,
            format,
            open: Vec::new(),
            more: 0,
            left_out: Vec::new(),
            said: Tally::default(),
            widest: None,
            separator: None,
        }
    }
}

/// How many roles the heading of some records has; 0 if there is none.
pub(crate) fn score(records: &[Record], layout: &Layout) -> usize {
    orientation(records, layout).map_or(0, |(.., score)| score)
}

/// Where parts stand, the form of the table, and how many roles its headings have. `None` if no heading is known.
fn orientation(records: &[Record], layout: &Layout) -> Option<(Parts, Form, usize)> {
    let forms = [
        (Parts::Rows, Form::Teeth),
        (Parts::Rows, Form::Parts),
        (Parts::Characteristics, Form::Characteristics),
        (Parts::Columns, Form::Teeth),
        (Parts::Columns, Form::Parts),
        (Parts::Rows, Form::Trace),
    ];
    let is_possible = |(parts, form): &(Parts, Form)| {
        let is_curve = *form == Form::Trace;
        let is_allowed = match layout.curve {
            IsCurve::No => !is_curve,
            IsCurve::ByHeadings => true,
            IsCurve::Yes => is_curve,
        };
        if is_curve || !is_allowed {
            return is_allowed;
        }
        layout.parts.is_none_or(|declared| declared == *parts) && (!layout.teeth || *form == Form::Teeth)
    };
    let mut found = forms.into_iter().filter(is_possible).filter_map(|(parts, form)| {
        if parts != Parts::Columns {
            return find(records, layout, form).map(|(_, score)| (parts, form, score));
        }
        let turned = turned(records, layout);
        let (at, score) = find(&turned, layout, form)?;
        // a heading that repeats is the name of a characteristic, in a row of each part
        let mut known: Vec<Role> = roles(&turned[at], layout, form).collect();
        known.sort_by_key(|role| key(*role));
        known.dedup();
        (layout.parts.is_some() || known.len() == score).then_some((parts, form, score))
    });
    // one heading alone may be the name of a row
    let first = found.next()?;
    Some(if first.2 > 1 { first } else { found.find(|(.., score)| *score > 1).unwrap_or(first) })
}

/// The columns of records as rows, without lines that a rule leaves out; a row has the number of its column.
fn turned(records: &[Record], layout: &Layout) -> Vec<Record> {
    let kept: Vec<&Record> = records.iter().filter(|record| layout.covering(record).is_none()).collect();
    let width = kept.iter().map(|record| record.filled().len()).max().unwrap_or(0);
    // a long row above many short ones is no table of parts in columns
    let width = if width.saturating_mul(kept.len()) > MOST_CELLS { 0 } else { width };
    let row =
        |place: usize| Record::new(kept.iter().map(|record| record.cell(place).clone()).collect(), place as u64 + 1);
    (0..width).map(row).collect()
}

/// Whether a table is read as a whole, because a row may depend on another one.
pub(crate) fn needs_all(layout: &Layout) -> bool {
    layout.part_line().is_some() || layout.repeats == Repeats::Last
}

/// Whether the parts of a table stand in rows, by its first records.
pub(crate) fn is_in_rows(records: &[Record], layout: &Layout) -> bool {
    orientation(records, layout).is_none_or(|(parts, ..)| parts == Parts::Rows)
}

/// Finds the columns of a table by its first records, or by all of them where parts are not in rows.
///
/// In this order: where parts stand and the form of the table; the names of parts that stand in lines of their own; the line of
/// headings and the line of units; lines above and between them without an owner; the owner of each column; units and decimal mark;
/// the rows that `repeats = "last"` leaves out. Everything without an owner is collected on the way, and [`Contract::close`] refuses
/// the table if there is any.
///
/// # Errors
/// Everything that has no owner, at once.
pub(crate) fn found(file: &File<'_>, records: &[Record], layout: &Arc<Layout>, want: &Want) -> Result<Found, Unclosed> {
    let (parts, form) =
        orientation(records, layout).map_or((Parts::Rows, layout.form()), |(parts, form, _)| (parts, form));
    let mut left_out = Tallies::new(layout);
    for (rule, tally) in &file.left_out {
        left_out.rules[*rule].tally.join(tally);
    }
    left_out.rules[layout.own_rule(OwnRule::OfFormat)].tally.join(&file.said);
    let mut open = file.open.clone();
    open.extend(own_headings(records, layout));
    if parts == Parts::Characteristics {
        let named = named(records, layout, form, &mut open);
        let records = named.as_deref().unwrap_or(records);
        return by_characteristic(&File { open, ..file.clone() }, records, left_out, layout, want);
    }
    let is_turned = parts == Parts::Columns;
    let turned = if is_turned { Some(turned(records, layout)) } else { named(records, layout, form, &mut open) };
    if is_turned {
        left_out.lines(records, layout);
    }
    let rows = turned.as_deref().unwrap_or(records);
    let at = find(rows, layout, form).map(|(at, _)| at);
    let (heading, is_known) = (at.unwrap_or_else(|| likely_heading(rows, layout)), at.is_some());
    let units = line_of_units(rows, heading, (layout, form), &mut open);
    let first = units.map_or(heading + 1, |at| (at + 1).max(heading + 1));
    let before = || rows.iter().enumerate().take(first).filter(|(at, _)| *at != heading && Some(*at) != units);
    if !is_turned {
        before().for_each(|(_, record)| left_out.lines(std::slice::from_ref(record), layout));
    }
    let more = list(&mut open, before().filter_map(|(_, record)| unowned(record, layout)));
    let units = units.and_then(|at| rows.get(at));
    let below = rows.get(first..).unwrap_or_default();
    let below: Cow<'_, [Record]> = match layout.ignore_lines[..] {
        [] => below.into(),
        _ => below.iter().filter(|row| layout.covering(row).is_none()).cloned().collect(),
    };
    let headings = rows.get(heading).cloned().unwrap_or_default();
    refuse_wide(file.name, headings.filled().len())?;
    let mut matched = matched(&headings, &below, layout, form);
    let want = &*of_pinion(&matched, want);
    let is_bare = !is_known && is_bare(rows, layout);
    if !is_known {
        matched.open.retain(|open| !(is_bare && matches!(open, Open::Column { .. })));
        matched.open.insert(
            0,
            if is_bare {
                no_headings("values stand there without headings", rows, (layout, want))
            } else {
                no_values(&matched)
            },
        );
    }
    matched.open.splice(0..0, open);
    matched.more = more;
    let not_cut = not_cut(&below, layout);
    let has_rows = !is_bare && not_cut.is_none();
    matched.open.extend(not_cut);
    let (mut columns, mark) = columns(&mut matched, units, &below, layout, want);
    for column in &mut columns {
        file.tell_tolerance(column);
    }
    if let Some(units) = units {
        own_units(units, &mut matched, &mut left_out);
        matched.units_line = line_of(units);
    }
    open_to_others(&mut matched, &columns, &below, (layout, want));
    if !matched.open.is_empty() && has_rows {
        let no_parts = no_parts(&matched, &below, layout);
        matched.more += list(&mut matched.open, no_parts);
    }
    left_out.headings(&matched);
    let id = matched.owners.iter().position(|owner| *owner == Some(Owner::Role(Role::PartId)));
    let last = last_of_each((rows, first), id, form, layout, &mut left_out);
    let table = closed(file, (layout, want), (matched, columns, mark), &below, left_out, parts)?;
    Ok(Found { table, above: first, heading, turned: last.or(turned) })
}

/// Closes the table of the columns that are found. `rows` are its first rows.
///
/// # Errors
/// Everything that has no owner, at once.
fn closed(
    file: &File<'_>,
    (layout, want): (&Arc<Layout>, &Want),
    (matched, columns, mark): (Matched, Vec<Column>, Option<DecimalMark>),
    rows: &[Record],
    left_out: Tallies,
    parts: Parts,
) -> Result<Table, Unclosed> {
    let titles = matched.titles.clone();
    let (line, form, more) = (matched.line, matched.form, matched.more + file.more);
    let contract = Contract::close(layout, matched).map_err(|matched| {
        let mut proposal = Proposal::of_matched(file.name, layout, *matched, rows, want);
        proposal.more += more;
        Unclosed::Open(Box::new(proposal))
    })?;
    let reading = Reading {
        file: file.name.to_owned(),
        format: file.format,
        decimal_mark: mark.map(DecimalMark::word),
        parts_in: parts.word(),
        header_line: Some(line).filter(|line| *line > 0 && parts != Parts::Columns),
        unit_counted: match form {
            Form::Teeth if is_rack(&columns, contract.index()) => "space",
            Form::Teeth => "tooth",
            Form::Trace => "point",
            Form::Parts | Form::Characteristics => "part",
        },
        columns: column_readings(&contract, &titles, &columns),
        left_out: left_out.rules,
        ..Reading::default()
    };
    let table = table(file, reading, Arc::new(contract), titles, columns, want);
    // the columns of a file are copied to results only where its rows are parts
    Ok(if parts == Parts::Rows { table } else { Table { titles: Vec::new(), ..table } })
}

/// A table with a row per characteristic, as one with a row per part.
fn by_characteristic(
    file: &File<'_>,
    records: &[Record],
    mut left_out: Tallies,
    layout: &Arc<Layout>,
    want: &Want,
) -> Result<Found, Unclosed> {
    let heading = find(records, layout, Form::Characteristics).map_or(0, |(at, _)| at);
    left_out.lines(records, layout);
    let mut open = file.open.clone();
    let more = list(&mut open, records[..heading].iter().filter_map(|record| unowned(record, layout)));
    records.get(heading).map_or(Ok(()), |headings| refuse_wide(file.name, headings.filled().len()))?;
    let Turned { mut matched, units, rows } = characteristics::turned(records, heading, (layout, want), &mut left_out);
    matched.open.splice(0..0, open);
    matched.more += more;
    let (columns, mark) = columns(&mut matched, Some(&units), &rows, layout, want);
    let table = closed(file, (layout, want), (matched, columns, mark), &rows, left_out, Parts::Characteristics)?;
    Ok(Found { table, above: 0, heading, turned: Some(rows) })
}

/// Refuses a table of more headings than a sheet has columns.
pub(crate) fn refuse_wide(name: &str, count: usize) -> Result<(), Diagnostic> {
    const MOST: usize = 1 << 14;
    if count <= MOST {
        return Ok(());
    }
    let message = format!("{name} has {count} headings, and at most {MOST} are read");
    Err(Diagnostic::error(Code::BadTable, message).help("leave out what is not needed"))
}

/// What is known of a table, with the pinion's face width where rows are teeth of a pinion.
fn of_pinion<'w>(matched: &Matched, want: &'w Want) -> Cow<'w, Want> {
    let is_of_tooth = |owner: &Option<Owner>| matches!(owner, Some(Owner::Role(Role::Value(field) | Role::Index(field))) if field.is_of_tooth());
    if matched.form == Form::Teeth && matched.owners.iter().any(is_of_tooth) {
        return Cow::Owned(Want { face_width: want.pinion_face_width, ..want.clone() });
    }
    Cow::Borrowed(want)
}

fn column_readings(contract: &Contract, titles: &[String], columns: &[Column]) -> Vec<ColumnReading> {
    let each = contract.owners.iter().zip(titles).enumerate();
    let read = each.filter_map(|(place, (owner, title))| match owner {
        Owner::Role(Role::Value(_)) => {
            let column = columns.iter().find(|column| column.place == place)?;
            let by_key = column.unit_from == UnitFrom::Key;
            let unit = format!("{}{}", column.unit_said(titles), if by_key { ", by its key" } else { "" });
            Some(ColumnReading { unit: Some(unit), ..column_reading_of(column) })
        }
        Owner::Role(Role::Beside(kind, beside @ (Beside::Upper | Beside::Lower | Beside::Uncertainty))) => {
            Some(named_only(title, &format!("{} of {}, not judged", beside.key(), kind.key())))
        }
        Owner::Role(role) => Some(named_only(title, &key(*role))),
        Owner::Rule(rule) => Some(named_only(title, contract.layout.role_of_rule(*rule)?)),
        Owner::Nameless => None,
    });
    let of = contract.of.iter().filter_map(Named::role).map(|(title, role)| named_only(title, &key(role)));
    of.chain(read).collect()
}

fn table(
    file: &File<'_>,
    reading: Reading,
    contract: Arc<Contract>,
    titles: Vec<String>,
    columns: Vec<Column>,
    want: &Want,
) -> Table {
    let is_teeth = matches!(reading.unit_counted, "space" | "tooth");
    let index_field = contract.index();
    let (id, index) =
        (contract.place(|role| role == Role::PartId), contract.place(|role| matches!(role, Role::Index(_))));
    let may_repeat = contract.layout.repeats == Repeats::All || reading.unit_counted != "part";
    let setup = Setup {
        columns: columns.clone(),
        titles: titles.clone(),
        id,
        index,
        separator: file.separator.unwrap_or(b','),
        is_even: file.separator.is_some(),
        contract,
    };
    Table {
        name: file.name.into(),
        reading,
        is_teeth,
        has_id: id.is_some(),
        refuses_repeats: !may_repeat,
        header_raw: crate::table::block::line_of(titles.iter()),
        titles,
        columns,
        index_field,
        pinion_teeth: want.pinion_teeth,
        encoding: Encoding::PLAIN,
        place: Place::Line,
        pieces: Pieces::of_setup(setup),
    }
}

/// The table of some records, `head` and then `rest`. The rest is streamed where each row is read by itself.
///
/// # Errors
/// Everything that has no owner, at once.
pub(crate) fn of_records(
    file: &File<'_>,
    head: Vec<Record>,
    rest: impl Iterator<Item = Result<Record, Diagnostic>> + Send + 'static,
    layout: &Arc<Layout>,
    want: &Want,
) -> Result<Table, Unclosed> {
    let (mut head, mut rest) = (head, rest);
    if !is_in_rows(&head, layout) || needs_all(layout) {
        let mut cells = refuse_many(file.name, cells_in(&head))?;
        for record in rest.by_ref() {
            head.push(record?);
            cells = refuse_many(file.name, cells + cells_in(&head[head.len() - 1..]))?;
        }
    }
    let Found { mut table, above, turned, .. } = found(file, &head, layout, want)?;
    match turned {
        Some(rows) => {
            if table.reading.parts_in == "columns" {
                table.place = Place::Record;
            }
            table.pieces.give_records(rows.into_iter().skip(above).map(Ok));
        }
        None => table.pieces.give_records(head.into_iter().skip(above).map(Ok).chain(rest)),
    }
    Ok(table)
}

impl Table {
    /// The columns that a rule leaves out: the rule, the place in the file, which `places` gives for each column, and the heading.
    pub(crate) fn left_out_columns(&self, places: &[usize]) -> Vec<(usize, usize, String)> {
        let left_out = self.pieces.contract().left_out();
        left_out.map(|(place, rule)| (rule, places[place], self.titles[place].clone())).collect()
    }
}
