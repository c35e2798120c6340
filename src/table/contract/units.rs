//! The line of units below the headings: whether there is one, and who owns its cells.

use super::heading::{Matched, owner};
use super::open::Open;
use super::owner::Owner;
use super::tallies::Tallies;
use crate::table::cell::{Cell, Record};
use crate::table::dictionary::{Form, Heading, Role};
use crate::table::grid::{is_unit, only_units};
use crate::table::layout::Layout;

/// The place of the line of units: the one that the contract names, or that below the headings, if it has units and no rule covers it.
pub(super) fn line_of_units(
    rows: &[Record],
    heading: usize,
    (layout, form): (&Layout, Form),
    open: &mut Vec<Open>,
) -> Option<usize> {
    let has_units = |line: &Record| layout.covering(line).is_none() && are_units(line, &rows[heading], layout, form);
    let units = layout.units.map_or_else(
        || Some(heading + 1).filter(|at| rows.get(*at).is_some_and(has_units)),
        |line| rows.iter().position(|record| record.line == line),
    );
    if let Some(line) = layout.units.filter(|_| units.is_none()) {
        let what = format!("there is no line {line}, in which the contract says that the units stand");
        open.push(Open::Wrong { what, help: "correct `units`".to_owned() });
    }
    units
}

/// Whether a line has units, or what should be one below a column of values. Below columns that are not read the units may be of
/// any quantity, such as `°C`; then a unit of length or angle must stand below another column.
fn are_units(units: &Record, headings: &Record, layout: &Layout, form: Form) -> bool {
    let mut is_told = false;
    let mut is_one = |(place, cell): (usize, &Cell)| {
        let title = headings.cell(place).text();
        // a heading may be merged over both lines
        let is_unit = is_unit(&cell.text()) || cell.text() == title;
        match owner(&title, &Heading::of(&title).name, place, layout, form) {
            Ok(Some(Owner::Rule(_))) => return true,
            // what is no unit of a value is told with its column
            Ok(None | Some(Owner::Role(Role::Value(_)))) => is_told |= is_unit,
            _ => return is_unit,
        }
        true
    };
    let mut filled = units.cells.iter().enumerate().filter(|(_, cell)| !cell.is_missing());
    only_units(&units.cells).is_some() || units.numbers() == 0 && filled.all(&mut is_one) && is_told
}

/// Gives the cells of the line of units their owners: below a column that a rule leaves out the rule, below a column of values the
/// column. A column without an owner keeps its unit.
pub(super) fn own_units(units: &Record, matched: &mut Matched, left_out: &mut Tallies) {
    for (place, cell) in units.cells.iter().enumerate().filter(|(_, cell)| !cell.is_empty()) {
        let is_heading = matched.titles.get(place).is_some_and(|title| cell.text() == **title);
        match matched.owners.get(place) {
            Some(Some(Owner::Rule(rule))) => left_out.add(*rule, units.line, place, &cell.text()),
            Some(Some(Owner::Role(_))) if is_heading => left_out.add(left_out.beside, units.line, place, &cell.text()),
            Some(Some(Owner::Role(Role::Value(_)))) => {}
            Some(None) if is_heading => {}
            Some(None) => _ = matched.headings[place].unit.get_or_insert_with(|| cell.text().into_owned()),
            Some(Some(Owner::Role(Role::Beside(..) | Role::PartId | Role::Status | Role::Index(_)))) => {
                left_out.add(left_out.beside, units.line, place, &cell.text());
            }
            _ => {
                let what = format!("line {}: `{}` is a unit of no value", units.line, cell.text());
                matched.open.push(Open::Wrong { what, help: String::new() });
            }
        }
    }
}
