//! The columns of values of a table: their units and the decimal mark. A unit may be given in several places, which must agree. The
//! decimal mark is declared, or the only one by which every number can be read.

use std::cmp::Ordering;

use super::heading::{Matched, key};
use super::open::Open;
use super::owner::Owner;
use crate::deviation::plausible::Reach;
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::Diagnostics;
use crate::quantity::{Angle, AngleUnit, Length, LengthUnit, Unit};
use crate::table::cell::{Cell, Content, Record};
use crate::table::column::{Column, Declared, Problem, UnitFrom, UnitSaid};
use crate::table::dictionary::{Form, Heading, Role, lookup};
use crate::table::field::{Beside, Field};
use crate::table::grid::{unit_in, unit_of};
use crate::table::layout::Layout;
use crate::table::number::{DecimalMark, normalise};
use crate::table::want::Want;

/// Finds the columns of values, and adds what they lack to `matched.open`. `units` is the line of units below the heading.
pub(crate) fn columns(
    matched: &mut Matched,
    units: Option<&Record>,
    rows: &[Record],
    layout: &Layout,
    want: &Want,
) -> (Vec<Column>, Option<DecimalMark>) {
    let mut declared = Vec::new();
    for place in 0..matched.owners.len() {
        let Some(Owner::Role(Role::Value(field))) = matched.owners[place] else { continue };
        declared.extend(one(matched, (place, field), units, rows, (layout, want)));
    }
    let with = |mark: Option<DecimalMark>| -> Result<Vec<Column>, Diagnostics> {
        let each = declared.iter().map(|declared| Column::declared(&Declared { mark, ..declared.clone() }, want));
        let (mut columns, mut problems) = (Vec::new(), Vec::new());
        each.for_each(|column| match column {
            Ok(column) => columns.push(column),
            Err(found) => problems.extend(found.0),
        });
        if problems.is_empty() { Ok(columns) } else { Err(Diagnostics(problems)) }
    };
    let mark = layout.decimal.map_or_else(|| mark(with, rows), |mark| Ok(Some(mark)));
    match mark.and_then(|mark| with(mark).map(|columns| (columns, mark)).map_err(wrong)) {
        Ok(found) => found,
        Err(open) => {
            matched.open.extend(open);
            (Vec::new(), None)
        }
    }
}

/// Problems of the spec as problems of a table.
fn wrong(Diagnostics(problems): Diagnostics) -> Vec<Open> {
    let open = |problem: crate::diagnostic::Diagnostic| Open::Wrong {
        what: problem.message,
        help: problem.help.unwrap_or_default().into(),
    };
    problems.into_iter().map(open).collect()
}

/// One column; `None` if nothing gives its unit, or two places disagree on it.
fn one(
    matched: &mut Matched,
    (place, field): (usize, Field),
    units: Option<&Record>,
    rows: &[Record],
    (layout, want): (&Layout, &Want),
) -> Option<Declared> {
    let (title, name) = (matched.titles[place].clone(), matched.headings[place].name.clone());
    let meaning = lookup(matched.form, &name).filter(|meaning| meaning.role == Role::Value(field));
    let is_angle = field.is_angle();
    let beside = beside(matched, field, is_angle, units);
    let of_row = units.map(|units| units.cell(place).text().into_owned());
    let of_row = of_row.filter(|unit| !unit.is_empty() && *unit != title);
    let mut said = Vec::new();
    for symbol in matched.headings[place].unit.clone().into_iter().chain(of_row) {
        let Some(unit) = unit_of(&symbol, is_angle) else {
            let (of, such) = if is_angle { ("an angle", "deg, arcmin or mrad") } else { ("a length", "mm, µm or in") };
            let what = format!("`{title}`: `{symbol}` is no unit of {of}");
            matched.open.push(Open::Wrong { what, help: format!("write a unit such as {such} there") });
            return None;
        };
        said.push((unit, UnitFrom::Table));
    }
    let own = layout.columns.iter().find(|column| column.field == field);
    let kind = if let (Field::Error(kind), Form::Parts) = (field, matched.form) { Some(kind) } else { None };
    let given = own.and_then(|column| column.unit).or_else(|| want.given(kind?)?.unit);
    said.extend(given.map(|unit| (unit, UnitFrom::Spec)));
    let unit_column = beside.iter().find(|(role, ..)| *role == Beside::Unit).map(|(_, at, _)| *at);
    if let Some(at) = unit_column.filter(|_| said.is_empty()) {
        let first = rows.iter().map(|row| row.cell(at)).find(|cell| !cell.is_missing());
        said.extend(first.and_then(|cell| unit_of(&cell.text(), is_angle)).map(|unit| (unit, UnitFrom::Beside)));
    }
    if said.is_empty() && meaning.is_some_and(|meaning| meaning.is_key) {
        let default = if is_angle { Unit::Angle(AngleUnit::Degree) } else { Unit::Length(LengthUnit::Millimetre) };
        said.push((default, UnitFrom::Key));
    }
    if said.is_empty() {
        said.extend(
            unit_of_cells(rows.iter().map(|row| row.cell(place)), is_angle).map(|unit| (unit, UnitFrom::Cells)),
        );
    }
    let is_own = own.is_some_and(|own| own.is_deviation) || field.is_deviation();
    let is_deviation = matched.are_deviations || is_own || meaning.is_some_and(|meaning| meaning.is_deviation);
    let is_of_part = matched.form == Form::Parts;
    let with = |unit: Unit, unit_from| {
        let (title, beside) = (title.clone(), beside.clone());
        Declared { field, is_of_part, title, place, unit, unit_from, is_deviation, mark: None, beside }
    };
    let Some((unit, from)) = said.first().copied() else {
        let units = plausible(&|unit| with(unit, UnitFrom::Spec), is_angle, rows, want);
        matched.open.push(Open::Unit { key: field.key(), title, units });
        return None;
    };
    if said.iter().any(|(other, _)| *other != unit) {
        matched.open.push(two_units(&title, field, &said));
        return None;
    }
    matched.units.push((place, UnitSaid::of((unit, from), (unit_column, beside.len()), &matched.titles)));
    Some(with(unit, from))
}

/// A column for which two places give different units.
fn two_units(title: &str, field: Field, said: &[(Unit, UnitFrom)]) -> Open {
    let words: Vec<_> = said.iter().map(|(unit, _)| unit.symbol()).collect();
    let what = format!("the unit of `{title}` ({}) is {}", key(Role::Value(field)), words.join(" and "));
    Open::Wrong { what, help: "correct the one that is wrong".to_owned() }
}

/// The unit behind the first number in some cells, if each number has one.
fn unit_of_cells<'c>(cells: impl Iterator<Item = &'c Cell>, is_angle: bool) -> Option<Unit> {
    let unit = |cell: &Cell| {
        let text = cell.text();
        let is_in_degrees = is_angle && text.contains(['°', '′', '\'']) && text.parse::<Angle>().is_ok();
        if is_in_degrees { Some(Unit::Angle(AngleUnit::Degree)) } else { unit_of(&unit_in(&text)?, is_angle) }
    };
    let units = cells.filter(|cell| cell.is_number()).map(unit).collect::<Option<Vec<_>>>()?;
    units.first().copied()
}

/// The columns beside that of an error, with their places and the units of their headings, or of the line of units.
fn beside(
    matched: &Matched,
    field: Field,
    is_angle: bool,
    units: Option<&Record>,
) -> Vec<(Beside, usize, Option<Unit>)> {
    let owners = matched.owners.iter().zip(&matched.headings).enumerate();
    let beside = owners.filter_map(|(place, (owner, heading))| match owner {
        Some(Owner::Role(Role::Beside(of, beside))) if *of == field => {
            let of_row = || unit_of(&units?.cell(place).text(), is_angle);
            Some((*beside, place, heading.unit.as_deref().and_then(|unit| unit_of(unit, is_angle)).or_else(of_row)))
        }
        _ => None,
    });
    beside.collect()
}

/// The units in which the numbers of a column without an owner would be values of an error; of the unit `own`, if the column has one.
pub(crate) fn plausible_units(
    kind: DeviationKind,
    (title, own): (&str, Option<&str>),
    place: usize,
    rows: &[Record],
    want: &Want,
) -> Vec<&'static str> {
    let field = Field::Error(kind);
    let meaning = lookup(Form::Parts, &Heading::of(title).name).filter(|meaning| meaning.role == Role::Value(field));
    let is_deviation = meaning.is_some_and(|meaning| meaning.is_deviation);
    let with = |unit: Unit| {
        let (title, beside, unit_from) = (title.to_owned(), Vec::new(), UnitFrom::Spec);
        Declared { field, is_of_part: true, title, place, unit, unit_from, is_deviation, mark: None, beside }
    };
    let Some(own) = own else { return plausible(&with, field.is_angle(), rows, want) };
    let own = unit_of(own, field.is_angle()).filter(|unit| is_usual(&|| with(*unit), rows, want));
    own.map(Unit::symbol).into_iter().collect()
}

/// Whether two columns have the nominal values and the deviations of a column of values, by the numbers of most rows.
pub(crate) fn fits_beside(
    (field, title, place, unit): (Field, &str, usize, Unit),
    [nominal, deviation]: [(usize, Option<&str>); 2],
    rows: &[Record],
    want: &Want,
) -> bool {
    const MOST_ROWS: usize = 100;
    let own = |unit: Option<&str>| unit.and_then(|unit| unit_of(unit, field.is_angle()));
    let beside = vec![(Beside::Nominal, nominal.0, own(nominal.1)), (Beside::Deviation, deviation.0, own(deviation.1))];
    let is_zero = |row: &&Record| !row.cell(nominal.0).text().contains(|c: char| ('1'..='9').contains(&c));
    DecimalMark::ALL.into_iter().any(|mark| {
        let (title, unit_from, beside) = (title.to_owned(), UnitFrom::Table, beside.clone());
        let (is_of_part, is_deviation, mark) = (true, false, Some(mark));
        let declared = Declared { field, is_of_part, title, place, unit, unit_from, is_deviation, mark, beside };
        let Ok(column) = Column::declared(&declared, want) else { return false };
        let fits = |row: &&Record| {
            let is_whole = [place, nominal.0, deviation.0].into_iter().all(|at| row.cell(at).is_number());
            is_whole && column.value(row.cell(place), column.beside_in(row)).is_ok()
        };
        let first = || rows.iter().take(MOST_ROWS);
        first().filter(|row| !is_zero(row)).filter(fits).count() * 2 > first().count()
    })
}

/// The units in which every number of a column is of a usual size.
fn plausible(with: &dyn Fn(Unit) -> Declared, is_angle: bool, rows: &[Record], want: &Want) -> Vec<&'static str> {
    let symbols = if is_angle { ["deg", "arcmin", "um"] } else { ["mm", "um", "in"] };
    let is_read =
        |symbol: &&'static str| unit_of(symbol, is_angle).is_some_and(|unit| is_usual(&|| with(unit), rows, want));
    symbols.into_iter().filter(is_read).collect()
}

/// Whether every number of a column that can be read is of a usual size, and at least one is large enough to be measured. Most can be
/// read.
fn is_usual(declared: &dyn Fn() -> Declared, rows: &[Record], want: &Want) -> bool {
    /// The smallest length that is measured: 0.1 µm.
    const LEAST_MEASURED: Length = Length::from_fm(100_000_000);
    let usual = Reach::usual(want.module);
    let is_seen = |value: DeviationValue| match value {
        DeviationValue::Length(length) => length.abs() >= LEAST_MEASURED,
        _ => !value.is_zero(),
    };
    let by_mark = |mark| {
        let Ok(column) = Column::declared(&Declared { mark: Some(mark), ..declared() }, want) else {
            return (0, false);
        };
        let numbers = rows.iter().filter(|row| row.cell(column.place).is_number());
        let values: Vec<_> = numbers.map(|row| column.value(row.cell(column.place), column.beside_in(row))).collect();
        let is_usual = |value: &Result<Option<DeviationValue>, Problem>| match value {
            Ok(value) => value.is_none_or(|value| !usual.is_reached_by(value)),
            Err(problem) => !problem.is_too_large,
        };
        let (count, are_usual) = (values.len(), values.iter().all(is_usual));
        let read: Vec<_> = values.into_iter().flatten().flatten().collect();
        (read.len(), are_usual && read.len() * 2 > count && read.into_iter().any(is_seen))
    };
    let by_marks = DecimalMark::ALL.map(by_mark);
    let most = by_marks.iter().map(|(read, _)| *read).max();
    by_marks.iter().any(|(read, is_usual)| Some(*read) == most && *is_usual)
}

/// The decimal mark by which every number can be read, or else by which more of them can; `None` if no number has a point or a comma.
///
/// # Errors
/// If both marks read every number, or equally many.
fn mark(
    with: impl Fn(Option<DecimalMark>) -> Result<Vec<Column>, Diagnostics>,
    rows: &[Record],
) -> Result<Option<DecimalMark>, Vec<Open>> {
    let [point, comma] = [DecimalMark::Point, DecimalMark::Comma].map(|mark| with(Some(mark)));
    let columns = [point.map_err(wrong)?, comma.map_err(wrong)?];
    let is_marked = |cell: &Cell| matches!(&cell.content, Content::Text(text) if text.contains(['.', ',']));
    let is_number = |cell: &Cell| is_marked(cell) && !cell.is_missing() && cell.is_number();
    let of_row = |row| columns[0].iter().enumerate().map(move |(number, column)| (number, row, column.place));
    let numbers =
        || rows.iter().flat_map(of_row).filter(|(_, row, place): &(_, &Record, _)| is_number(row.cell(*place)));
    let Some(example) = numbers().next().map(|(_, row, place)| row.cell(place).text().into_owned()) else {
        return Ok(None);
    };
    let is_read = |column: &Column, row: &Record| {
        let read = column.read(row.cell(column.place), column.beside_in(row));
        // a value that is too large does not settle the mark
        read.map_or_else(|problem| problem.is_too_large, |_| true)
    };
    let is_strict = |column: &Column, row: &Record| column.value(row.cell(column.place), column.beside_in(row)).is_ok();
    let strict = |of: &[Column]| {
        let is_written =
            |column: &Column, row: &Record| normalise(&row.cell(column.place).text(), column.mark).is_some();
        let count = |is_it: &dyn Fn(&Column, &Record) -> bool| {
            numbers().filter(|(number, row, _)| is_it(&of[*number], row)).count()
        };
        // a value that contradicts its nominal value is still a number
        (count(&is_strict), count(&is_written))
    };
    let [point, comma] = columns.each_ref().map(|of| numbers().all(|(number, row, _)| is_read(&of[number], row)));
    match (point, comma) {
        (true, false) => Ok(Some(DecimalMark::Point)),
        (false, true) => Ok(Some(DecimalMark::Comma)),
        (true, true) => Err(vec![Open::Mark { example }]),
        (false, false) => match strict(&columns[0]).cmp(&strict(&columns[1])) {
            Ordering::Greater => Ok(Some(DecimalMark::Point)),
            Ordering::Less => Ok(Some(DecimalMark::Comma)),
            Ordering::Equal => Err(vec![Open::Mark { example }]),
        },
    }
}
