//! What has no owner around the columns of a table: headings that are not known, lines above it and rows that are no parts, and columns
//! that the rule for all others must not leave out.

use super::Contract;
use super::heading::{Matched, is_one};
use super::open::Open;
use super::owner::{Owner, line_of};
use crate::deviation::DeviationKind;
use crate::quantity::listed;
use crate::table::block::Odd;
use crate::table::cell::{Cell, Record};
use crate::table::column::{Column, Nominal};
use crate::table::companions::Companions;
use crate::table::dictionary::{Form, Role};
use crate::table::field::Field;
use crate::table::grid::unit_of;
use crate::table::layout::{IsCurve, Layout, OwnRule};
use crate::table::want::Want;

/// The line that is shown as the headings where no heading is known: as wide as most lines with numbers, which a title above is not.
pub(super) fn likely_heading(records: &[Record], layout: &Layout) -> usize {
    let uncovered = || records.iter().enumerate().filter(|(_, record)| layout.covering(record).is_none());
    let with_numbers = uncovered().filter(|(_, record)| record.numbers() > 0);
    let mut widths: Vec<usize> = with_numbers.map(|(_, record)| record.filled().len()).collect();
    let middle = widths.len() / 2;
    let usual = if widths.is_empty() { 0 } else { *widths.select_nth_unstable(middle).1 };
    let likely =
        |width: usize| uncovered().find(move |(_, record)| record.filled().len() >= width && record.numbers() == 0);
    let likely = likely(usual.max(2)).or_else(|| likely(2)).or_else(|| uncovered().next());
    likely.map_or(0, |(at, _)| at)
}

/// Whether every line that could be a line of headings has numbers.
pub(super) fn is_bare(records: &[Record], layout: &Layout) -> bool {
    let uncovered = || records.iter().filter(|row| !row.filled().is_empty() && layout.covering(row).is_none());
    let has_rows = uncovered().any(|row| row.filled().len() > 1);
    let mut rows = uncovered().filter(|row| !has_rows || row.filled().len() > 1).peekable();
    let has_numbers = |row: &Record| row.numbers() > 0 || numbers_between_blanks(row).is_some();
    layout.headings.is_empty() && rows.peek().is_some() && rows.all(has_numbers)
}

/// How many numbers stand in the only cell of a row; `None` if anything else stands there, or one number.
fn numbers_between_blanks(row: &Record) -> Option<usize> {
    let [cell] = row.filled() else { return None };
    let text = cell.text();
    let count = text.split_whitespace().filter(|word| Cell::of_text(word).is_number()).count();
    (count > 1 && count == text.split_whitespace().count()).then_some(count)
}

/// The problem that several numbers stand in the only cell of a row, where headings are given for more.
pub(super) fn not_cut(rows: &[Record], layout: &Layout) -> Option<Open> {
    let count = rows.iter().find_map(numbers_between_blanks).filter(|_| layout.headings.len() > 1)?;
    let what = format!("{count} numbers stand in one cell, with blanks between them");
    Some(Open::Wrong { what, help: "--separator ' ' cuts them".to_owned() })
}

/// The problem that values stand there without headings, with the options that give them.
pub(crate) fn no_headings(what: &str, rows: &[Record], (layout, want): (&Layout, &Want)) -> Open {
    let values: Vec<String> = if layout.curve == IsCurve::Yes {
        vec!["stroke[mm]".to_owned(), "delta_cd[um]".to_owned()]
    } else {
        let kinds = if want.expected.is_empty() { &DeviationKind::ALL[..] } else { &want.expected };
        let mut kinds = kinds.to_vec();
        kinds.sort_unstable();
        kinds.iter().map(|kind| format!("{}[{}]", kind.key(), want.usual_unit(*kind))).collect()
    };
    let numbered = || rows.iter().filter(|row| layout.covering(row).is_none() && row.numbers() > 0);
    let widest = numbered().max_by_key(|row| row.filled().len());
    let between_blanks = rows.iter().filter_map(numbers_between_blanks).max().filter(|_| widest.is_none());
    let width = between_blanks.or(widest.map(|row| row.filled().len()));
    let is_named = |width: usize| width > values.len() || widest.is_some_and(|row| !row.cell(0).is_number());
    let name = width.is_none_or(is_named).then(|| "part_id".to_owned()).filter(|_| layout.curve != IsCurve::Yes);
    let mut headings: Vec<String> = name.into_iter().chain(values).collect();
    headings.resize(width.unwrap_or(headings.len()), String::new());
    let separator = if between_blanks.is_some() { "--separator ' ' " } else { "" };
    let help = format!("give a heading to each column, such as {separator}--as '{}'", headings.join(","));
    Open::Wrong { what: what.to_owned(), help }
}

/// The problem that no heading is of values.
pub(super) fn no_values(matched: &Matched) -> Open {
    if matches!(matched.form, Form::Parts | Form::Characteristics) {
        return Open::NoValues { titles: matched.titles.clone() };
    }
    let titles = listed(&matched.titles);
    if matched.form == Form::Trace {
        let what = format!("no column is known as the stroke or ΔCD of a measured curve: {titles}");
        let help = "call them stroke and delta_cd, or say which they are: [table.columns] stroke = { name = \"…\", unit = \"mm\" }";
        return Open::Wrong { what, help: help.to_owned() };
    }
    let what = format!("no column is known to hold a rack's spaces or a pinion's teeth: {titles}");
    let help = "a rack has space, over_pin or over_pin_deviation, position or position_deviation, lead_deviation; a pinion \
                tooth, radial_deviation, left_pitch_deviation, right_pitch_deviation, lead_deviation";
    Open::Wrong { what, help: help.to_owned() }
}

/// A line above a table, if no rule leaves it out.
pub(super) fn unowned(record: &Record, layout: &Layout) -> Option<Open> {
    let is_open = !record.says_nothing() && layout.covering(record).is_none();
    let is_heading = is_one(record, layout);
    is_open.then(|| Open::Line { line: record.line, text: line_of(record), is_heading })
}

/// Lists columns that the rule for all others must not leave out. A column with the nominal value and the unit of a column of values
/// may be another measurement of the same. While an error of the spec has no column, the rule leaves out none.
pub(super) fn open_to_others(
    matched: &mut Matched,
    columns: &[Column],
    below: &[Record],
    (layout, want): (&Layout, &Want),
) {
    let has = |kind: &DeviationKind| matched.owners.contains(&Some(Owner::Role(Role::Value(Field::Error(*kind)))));
    let lacks_error = matched.form == Form::Parts && !want.expected.iter().all(has);
    for place in 0..matched.owners.len() {
        if matched.owners[place] != Some(Owner::Rule(layout.own_rule(OwnRule::Others))) {
            continue;
        }
        let unit = matched.headings[place].unit.as_deref();
        let cells = || below.iter().map(|record| record.cell(place)).filter(|cell| !cell.is_missing());
        let is_again = |column: &Column| {
            matches!(column.nominal, Nominal::Fixed(nominal) if !nominal.is_zero())
                && unit.is_none_or(|unit| unit_of(unit, column.field.is_angle()) == Some(column.unit))
                && cells().next().is_some()
                && cells().all(|cell| matches!(column.value(cell, Companions::default()), Ok(Some(_))))
        };
        if lacks_error || columns.iter().any(is_again) {
            matched.open.push(Open::column(place, &matched.titles[place], below));
        }
    }
}

/// Rows that are no parts, which are listed with what has no owner: those with the name of a statistic, and lines of words.
pub(super) fn no_parts<'r>(
    matched: &Matched,
    below: &'r [Record],
    layout: &'r Layout,
) -> impl Iterator<Item = Open> + use<'r> {
    let place_of = |role: Role| matched.owners.iter().position(|owner| *owner == Some(Owner::Role(role)));
    let (id, is_value) =
        (place_of(Role::PartId), |owner: &Option<Owner>| matches!(owner, Some(Owner::Role(Role::Value(_)))));
    let values: Vec<usize> = (0..matched.owners.len()).filter(|place| is_value(&matched.owners[*place])).collect();
    let row = move |record: &Record| {
        let numbers = values.iter().filter(|place| record.cell(**place).is_number()).count();
        let name = id.map(|place| record.cell(place)).filter(|name| !name.is_missing());
        let statistic = name.filter(|name| Contract::is_statistic(name));
        let is_line = || record.numbers() == 0 && record.filled().len() == 1 || record.cell(0).text().contains(':');
        if is_one(record, layout) || statistic.is_none() && (numbers > 0 || !is_line()) {
            return None;
        }
        let name = statistic.unwrap_or_else(|| record.cell(0)).text().into_owned();
        let (is_no_name, could_be_part) = (statistic.is_some(), statistic.is_some() && numbers == values.len());
        let (line, text) = (record.line, line_of(record));
        Some(Open::Row(Odd { line, text, name, is_no_name, has_text: false, could_be_part }))
    };
    below.iter().filter(|record| !record.filled().is_empty()).filter_map(row)
}
