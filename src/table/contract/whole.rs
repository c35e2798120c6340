//! Changes to all records of a table: headings that the user gives, names of parts that stand in lines of their own, and rows before
//! the last one of a part.

use std::collections::HashMap;

use super::heading::{matched, score};
use super::open::Open;
use super::owner::{Owner, line_of};
use super::tallies::Tallies;
use crate::quantity::shown;
use crate::table::cell::{Cell, Record};
use crate::table::dictionary::{Form, Role};
use crate::table::layout::{Layout, OwnRule, Repeats};

/// The heading that the user gives to a file without one.
pub(crate) fn with_headings(layout: &Layout) -> Option<Record> {
    let cells = layout.headings.iter().map(|heading| Cell::of_text(heading.trim())).collect();
    (!layout.headings.is_empty()).then(|| Record::new(cells, 0))
}

/// The problem, if there is one, that a file has headings of its own although the user gives them.
pub(super) fn own_headings(records: &[Record], layout: &Layout) -> Option<Open> {
    let first = records.iter().skip(1).find(|record| layout.covering(record).is_none() && !record.filled().is_empty());
    let first = first.filter(|_| !layout.headings.is_empty())?;
    let known = super::heading::roles(first, layout, layout.form()).next()?;
    let what = format!(
        "line {} has a heading that is known, {}: --as is for tables without headings",
        first.line,
        super::heading::key(known)
    );
    Some(Open::Wrong { what, help: "leave --as out".to_owned() })
}

/// The records with the name of their part in a column: in that of the names, or else in a new last one. Lines above the rows of each
/// part give the name. `None` if the contract has no such lines.
pub(super) fn named(records: &[Record], layout: &Layout, form: Form, open: &mut Vec<Open>) -> Option<Vec<Record>> {
    let pattern = layout.part_line()?;
    let width = records.iter().map(|record| record.filled().len()).max().unwrap_or(0);
    let own = records.iter().find(|record| score(record, layout, form).is_some()).and_then(|heading| {
        let owners = matched(heading, &[], layout, form).owners;
        owners.iter().position(|owner| *owner == Some(Owner::Role(Role::PartId)))
    });
    let place = own.unwrap_or(width);
    let (mut name, mut rows) = (String::new(), Vec::new());
    for record in records {
        if record.filled().is_empty() || layout.covering(record).is_some() {
            rows.push(record.clone());
            continue;
        }
        let line = line_of(record);
        let is_plain = !record.cells.iter().any(Cell::is_unlike);
        if let Some(found) = pattern.left_open(&line).filter(|_| is_plain) {
            found.clone_into(&mut name);
            continue;
        }
        let mut cells = record.cells.to_vec();
        cells.resize(cells.len().max(place + 1), Cell::default());
        let text = if score(record, layout, form).is_some() { "part_id" } else { &name };
        match own {
            Some(_) if text == "part_id" && text != name => {}
            Some(_) if !cells[place].is_empty() && cells[place].text() != name => {
                let (said, name) = (shown(&cells[place].text()), shown(&name));
                let what =
                    format!("line {}: the part is `{said}`, and the line above its rows names `{name}`", record.line);
                open.push(Open::Wrong { what, help: "correct the one that is wrong".to_owned() });
            }
            _ => cells[place] = Cell::of_text(text),
        }
        rows.push(Record::new(cells, record.line));
    }
    Some(rows)
}

/// The records with the last row of each part only. The rows before it are left out. `None` if the contract does not ask for that.
pub(super) fn last_of_each(
    (records, first): (&[Record], usize),
    place: Option<usize>,
    form: Form,
    layout: &Layout,
    left_out: &mut Tallies,
) -> Option<Vec<Record>> {
    let place = place.filter(|_| layout.repeats == Repeats::Last)?;
    let name = |record: &Record| record.cell(place).text().trim().to_owned();
    let is_row = |record: &Record| layout.covering(record).is_none() && !record.cell(place).is_missing();
    let last: HashMap<String, u64> =
        records[first..].iter().filter(|record| is_row(record)).map(|record| (name(record), record.line)).collect();
    let mut kept = records[..first].to_vec();
    for record in &records[first..] {
        let is_last = |name: &String| !layout.later.contains(name) && last.get(name) == Some(&record.line);
        let is_before = is_row(record) && !is_last(&name(record));
        if is_before && score(record, layout, form).is_none() {
            left_out.add(layout.own_rule(OwnRule::RepeatedParts), record.line, 0, &line_of(record));
        } else {
            kept.push(record.clone());
        }
    }
    Some(kept)
}
