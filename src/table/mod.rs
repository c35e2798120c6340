//! Tables of measured values, whatever file they are in, as typed columns: the one reader.
//!
//! The command line opens files and hands them in as bytes ([`Container::open`]); the spec and the user say what is known
//! ([`Want`]). What comes out is a [`Table`]: columns with roles, units and nominal values, how that was found
//! ([`Reading`]), what is not understood ([`Stranger`]), and the rows, as [`Block`]s of columns. `batch`, `paste`,
//! `report`, `read` and the tables that a spec names all read so. Nothing here knows gear geometry.
//!
//! # How a table is read
//! ```text
//! bytes ─ encoding ─ text ─ split, grid ─┐
//! workbook ──────────────────────────────┼─ records ─ shape (names) ─ understand ─ columns ─ rows ─ blocks
//! qdas ──────────────────────────────────┘                            strangers
//! parquet ──────────────────────────────────────────────────────────────────────────────────┘
//! ```
//! | module | what it is |
//! |---|---|
//! | `encoding`, `chunk`, `split`, `grid` | bytes to text, text to records, records to cells |
//! | `workbook`, `qdas`, `parquet`, `typed` | files whose cells are typed |
//! | `report` | texts of measuring programs, whose cells have a fixed meaning |
//! | `names` | what headings mean, in four languages |
//! | `shape` | where the names stand, which cells belong to them |
//! | `number`, `column`, `companions` | what a cell means |
//! | `understand` | separator and decimal mark: one reading, or a refusal |
//! | `contract`, `dictionary`, `ledger`, `propose` | tables by contract, and what would close one |
//! | `unknown`, `strangers`, `measured` | what names nothing known, and may be a measurement |
//! | `rejection` | what is said against a part |
//! | `rows`, `gathered`, `pieces`, `block` | rows to columns |
//! | `reading` | how it was read, for the result |
//! | `teeth` | rows that are spaces of a rack or teeth of a pinion |
//!
//! # The rules
//! A column is used, refused, or left out because the user said so or because it cannot be a measurement. A comma and a
//! point are never guessed: another cell, a nominal value or the user settles which is the decimal mark. A cell is a
//! number, says that there is no value (`n.a.`, `-`, `#DIV/0!`), or is refused with its place.
//!
//! ```
//! use rackmesh::table::{Container, Source, Want};
//!
//! let bytes = "Teil;Rollenmaß-Abweichung [µm]\nP1;13,1\nP2;-2,5\n";
//! let container = Container::open("parts.csv", Source::bytes(bytes.as_bytes().to_vec()), &Want::default())?;
//! let table = container.table("parts.csv", &Want::default())?;
//! assert_eq!(table.reading.columns[1].role, "rack_over_roller");
//! assert_eq!(table.reading.decimal_mark, Some("comma"));
//! # Ok::<(), rackmesh::diagnostic::Diagnostics>(())
//! ```

mod block;
mod cell;
mod chunk;
mod column;
mod companions;
mod container;
mod contract;
mod dictionary;
mod encoding;
mod fixed;
mod gathered;
mod grid;
mod layout;
mod ledger;
mod lines;
mod measured;
mod names;
mod number;
mod parquet;
mod pattern;
mod pieces;
mod propose;
pub mod qdas;
mod reading;
mod rejection;
mod report;
mod rows;
mod shape;
mod split;
mod stored;
mod strangers;
mod teeth;
mod text;
mod typed;
mod understand;
mod unknown;
mod want;
pub mod workbook;

pub use block::{Block, Contradiction, Fault};
pub use container::{Container, Source};
pub use encoding::{Encoding, decode};
pub use grid::Separator;
pub use layout::{ColumnOption, DeclaredColumn, Layout, LineRule, PartNames, Parts, Repeats, StatusColumn};
pub use ledger::{LeftOut, Tally};
pub use names::{Field, UnknownField, ValueKind};
pub use number::DecimalMark;
pub use pattern::Pattern;
pub use propose::{ColumnAccount, Guesses, LineAccount, Proposal, table_in_sentences};
pub use reading::{AsideReading, ColumnReading, NotUsed, Reading};
pub use stored::Stored;
pub use strangers::{Stranger, refusal};
pub use teeth::{Measured, PinionTeeth, PinionTooth, RackSpace, RackSpaces, RowExtent, Teeth, TeethTable, of_one_part};
pub use want::{GivenColumn, Orientation, Want};

pub(crate) use column::{Column, Nominal, unit_of};
pub(crate) use encoding::text as cell_text;
pub(crate) use ledger::join as join_left_out;
pub(crate) use names::is_called;
pub(crate) use pieces::{Piece, Pieces, Place, Queue};
pub(crate) use reading::ASIDES_KEPT;
pub(crate) use rejection::{Rejection, add as add_rejections};
pub(crate) use rows::{Extremes, Rows, Wanted};
pub(crate) use teeth::{Gatherer, LineFault, ToothedPart, gather};
pub(crate) use typed::stored_table;
pub(crate) use understand::in_words;

use std::sync::Arc;

use crate::deviation::{DeviationKind, Part};
use crate::quantity::{Unit, shown};
use block::line_of;
use cell::Cell;
use column::UnitFrom;
use names::{Role, part_in_title};
use rejection::rejection;
use shape::Measurement;
use strangers::Others;
use understand::Understood;
use unknown::Unknown;

/// A table whose columns are found, and whose rows are still to be read.
pub struct Table {
    /// What messages call it.
    pub name: Arc<str>,
    /// How it was read.
    pub reading: Reading,
    /// Columns, lines and characteristics that may be measurements and are not understood.
    pub strangers: Vec<Stranger>,
    /// The errors whose columns the spec has to name before `others = "ignore"` leaves these out.
    pub to_be_named: Vec<DeviationKind>,
    /// Whether each row is a tooth or a space, and not a part.
    pub is_teeth: bool,
    /// Whether parts have names.
    pub has_id: bool,
    /// Whether no part may be there twice.
    pub(crate) refuses_repeats: bool,
    /// The names of all columns, where rows are parts.
    pub titles: Vec<String>,
    pub(crate) columns: Vec<Column>,
    /// Whether the rows count spaces or teeth.
    pub(crate) index_field: Option<Field>,
    /// How many teeth the spec's pinion has.
    pub(crate) pinion_teeth: Option<i64>,
    /// The header as it stands in the file.
    pub(crate) header_raw: Vec<u8>,
    pub(crate) encoding: Encoding,
    pub(crate) place: Place,
    pub(crate) pieces: Pieces,
}

impl Table {
    fn new(name: &str, format: &'static str, understood: &Understood, want: &Want) -> Self {
        let shape = &understood.shape;
        let others = Others::of(&understood.columns, want);
        let part = if understood.is_teeth && !column::is_rack(&understood.columns, shape.index_field) {
            Part::Pinion
        } else {
            Part::Rack
        };
        let mut sorted = strangers::sort(name, shape, understood, want, &others);
        let mut reading = Reading {
            file: name.to_owned(),
            format,
            separator: understood.separator.map(Separator::name),
            settled_by: understood.settled_by.clone(),
            decimal_mark: understood.mark.map(DecimalMark::word),
            parts_in: shape.orientation.word(),
            header_line: shape.header_line,
            unit_counted: "part",
            notes: shape.notes.iter().map(|note| format!("{name}: {note}")).collect(),
            ..Reading::default()
        };
        reading.columns.extend(shape.ids.as_ref().map(|ids| named_only(&ids.title, Field::PartId.key())));
        if let (Some(index), Some(field)) = (&shape.index, shape.index_field) {
            reading.columns.push(named_only(&index.title, field.key()));
        }
        for (measurement, column) in shape.measurements.iter().zip(&understood.columns) {
            reading.notes.extend(doubts(name, measurement, column));
            reading.columns.push(column_reading(measurement, column));
            reading.columns.extend(companions(measurement, column.checks_deviation()));
            if want.by_uncertainty {
                for unknown in uncertainties(measurement) {
                    sorted.take(name, &unknown, want, &others);
                }
            } else if let Some(uncertainty) = measurement.beside.get(Role::Uncertainty) {
                reading.notes.push(format!(
                    "{name}: `{}` is an uncertainty, and is not used: uncertainties stand in the spec",
                    uncertainty.title
                ));
            }
        }
        if understood.is_teeth {
            let is_other = |said: &AsideReading| part_in_title(&said.text).is_some_and(|of| of != part);
            sorted.asides.extend(shape.said_beside_values(want).into_iter().filter(is_other));
            sorted.take_titles_of_other(name, part, want, &others);
        }
        (reading.not_used, reading.asides) = (sorted.not_used, sorted.asides);
        reading.notes.extend(sorted.notes);
        // T2_NOK
        let names = shape.ids.iter().flat_map(|ids| &ids.cells).map(Cell::text);
        let names =
            names.filter(|name| name.contains([' ', '_', '-']) && !name.ends_with(|c: char| c.is_ascii_digit()));
        let names: Vec<Cell> = names.map(|name| Cell::of_text(&name.replace(['_', '-'], " "), 0..0)).collect();
        let id = shape.ids.as_ref().map_or("", |ids| &ids.title);
        reading.notes.extend(rejection(id, &names, false).map(|rejection| rejection.in_words(name)));
        if understood.is_teeth {
            reading.unit_counted = if part == Part::Rack { "space" } else { "tooth" };
        }
        for column in understood.columns.iter().filter(|column| column.evaluated_over_face_width(want)) {
            reading.notes.push(format!(
                "{name}: `{}` is evaluated over the {}'s face width",
                column.title,
                part.name()
            ));
        }
        let titles: Vec<_> = shape.header.iter().map(|cell| cell.text().into_owned()).collect();
        let pieces = Pieces::of(understood, want);
        Self {
            name: name.into(),
            reading,
            strangers: sorted.strangers,
            to_be_named: sorted.to_be_named,
            is_teeth: understood.is_teeth,
            has_id: shape.ids.is_some(),
            refuses_repeats: false,
            columns: understood.columns.clone(),
            index_field: shape.index_field,
            pinion_teeth: want.pinion_teeth,
            header_raw: if pieces.are_rows { line_of(titles.iter()) } else { Vec::new() },
            encoding: Encoding::PLAIN,
            place: Place::Line,
            titles,
            pieces,
        }
    }

    /// The errors that it has columns of.
    pub fn kinds(&self) -> impl Iterator<Item = DeviationKind> + '_ {
        self.columns.iter().filter_map(|column| column.kind)
    }

    /// What its columns are, as lines of `[batch.columns]`.
    #[must_use]
    pub fn mapping(&self) -> Vec<String> {
        let line = |column: &Column| {
            let unit = column.unit.symbol();
            let kind = if column.holds == Some(ValueKind::Deviation) { ", kind = \"deviation\"" } else { "" };
            let (name, _) = names::split_unit(&column.title);
            Some(format!(
                "{} = {{ name = {}, unit = \"{unit}\"{kind} }}",
                column.kind?.key(),
                want::quoted(name.trim())
            ))
        };
        self.columns.iter().filter_map(line).collect()
    }

    /// All of its rows, in its order.
    pub(crate) fn rows(self, wanted: Wanted) -> impl Iterator<Item = std::io::Result<Block>> {
        let (rows, mut queue) = self.pieces.open(wanted);
        let mut piece = Piece::default();
        let mut extremes = Extremes::default();
        std::iter::from_fn(move || match queue.next(&rows, &mut piece) {
            Ok(false) => {
                let found = std::mem::take(&mut extremes).contradiction(&rows);
                found.is_some().then(|| Ok(Block { contradiction: found, ..Block::default() }))
            }
            Err(error) => Some(Err(error)),
            Ok(true) => {
                piece.read(&rows);
                extremes.add(&rows, &piece.block);
                Some(Ok(std::mem::take(&mut piece.block)))
            }
        })
    }

    /// All of its rows, with every column read.
    ///
    /// # Errors
    /// If it cannot be read to its end.
    pub fn blocks(self) -> Result<Vec<Block>, std::io::Error> {
        let needed = vec![true; self.columns.len()];
        self.rows(Wanted { needed, ..Wanted::default() }).collect()
    }

    /// Its columns as a message lists them, as many as it has room for; one without a name (the margin of a
    /// sheet) is none to choose.
    pub(crate) fn titles_in_words(&self) -> String {
        const MOST: usize = 30;
        let titles = || {
            let in_rows = self.titles.iter().filter(|title| !title.is_empty());
            in_rows.chain(self.columns.iter().map(|column| &column.title).filter(|_| self.titles.is_empty()))
        };
        let mut list = titles().take(MOST).map(|title| shown(title)).collect::<Vec<_>>().join(", ");
        if let more @ 1.. = titles().count().saturating_sub(MOST) {
            list += &format!(" and {more} more");
        }
        list
    }
}

impl Column {
    pub(crate) fn evaluated_over_face_width(&self, want: &Want) -> bool {
        let given = self.kind.and_then(|kind| want.given(kind)).and_then(|given| given.length);
        self.evaluated_over().is_some() && given.is_none()
    }
}

/// What is worth a look in a column that can be read: uncertainties that are not used, values far below their tolerance.
fn doubts(name: &str, measurement: &Measurement, column: &Column) -> Vec<String> {
    let mut notes = Vec::new();
    if measurement.value.cells.iter().any(|cell| cell.text().contains(['±'])) {
        notes.push(format!(
            "{name}: `{}`: what stands behind ± is not used: uncertainties stand in the spec",
            column.title
        ));
    }
    if names::split_wanted(&names::split_unit(&column.title).0).is_some() {
        notes.push(format!("{name}: `{}`: the tolerance in its name is not judged", column.title));
    }
    if let Some(doubt) = column.is_too_fine(measurement) {
        notes.push(format!("{name}: `{}`: {doubt}: check the unit", column.title));
    }
    if let Some([one, other]) = column.differing_nominals(measurement) {
        notes.push(format!(
            "{name}: the nominal value of `{}` is {} and {}: they may be of other parts",
            column.title,
            shown(&one.text()),
            shown(&other.text())
        ));
    }
    if column.is_far_below_tolerance(measurement) {
        notes.push(format!(
            "{name}: `{}`: every value is less than a 500th of its tolerance: check the unit",
            column.title
        ));
    }
    notes
}

/// Uncertainties that stand beside values, or behind them.
fn uncertainties(measurement: &Measurement) -> Vec<Unknown> {
    let behind: Vec<_> = measurement.value.cells.iter().filter(|cell| cell.text().contains(['±'])).cloned().collect();
    let behind = (!behind.is_empty()).then(|| Unknown::column("±", measurement.value.place, behind));
    let beside = measurement.beside.get(Role::Uncertainty).into_iter();
    let beside = beside.map(|series| Unknown::column(&series.title, series.place, series.cells.clone()));
    beside.chain(behind).map(Unknown::uncertainty).collect()
}

fn named_only(title: &str, role: &str) -> ColumnReading {
    ColumnReading { title: title.to_owned(), role: role.to_owned(), ..ColumnReading::default() }
}

fn column_reading(measurement: &Measurement, column: &Column) -> ColumnReading {
    ColumnReading { unit: Some(units(measurement, column).join(" or ")), ..column_reading_of(column) }
}

/// How a column is read, whatever units single rows have.
fn column_reading_of(column: &Column) -> ColumnReading {
    let is_angle = column.field.is_angle();
    let holds = match (column.nominal, column.holds) {
        (Nominal::None, Some(ValueKind::Deviation)) => "deviation",
        (Nominal::None, None) if column.kind.is_some() || !column.is_of_space() => "deviation",
        _ => "measured",
    };
    let is_slope = is_angle && matches!(column.unit, Unit::Length(_));
    ColumnReading {
        title: column.title.clone(),
        role: column.kind.map_or(column.field.key(), DeviationKind::key).to_owned(),
        unit: Some(column.unit.symbol().to_owned()),
        unit_is_assumed: column.unit_from == UnitFrom::Key,
        holds: Some(if is_slope { "f_Hβ" } else { holds }),
        nominal: match column.nominal {
            Nominal::None => None,
            Nominal::Fixed(nominal) => Some(in_words(nominal)),
            Nominal::Beside => Some("beside it".to_owned()),
        },
    }
}

/// The units of a column, those of single rows included.
fn units(measurement: &Measurement, column: &Column) -> Vec<&'static str> {
    let beside = measurement.beside.get(Role::Unit).into_iter().flat_map(|units| &units.cells);
    let mut units = vec![column.unit.symbol()];
    for symbol in beside.filter_map(|cell| column.unit_of_row(Some(cell)).ok()).map(Unit::symbol) {
        if !units.contains(&symbol) {
            units.push(symbol);
        }
    }
    units
}

/// The columns that stand beside a value. `is_checked` tells whether the value is held against a deviation beside it.
fn companions(measurement: &Measurement, is_checked: bool) -> impl Iterator<Item = ColumnReading> + '_ {
    let key = measurement.field.key();
    let beside = [
        (Role::Deviation, "deviation", if is_checked { ", checked" } else { ", not used" }),
        (Role::Nominal, "nominal", ""),
        (Role::Upper, "upper tolerance", ", not judged"),
        (Role::Lower, "lower tolerance", ", not judged"),
        (Role::Unit, "unit", ""),
        (Role::Length, "evaluation length", ""),
    ];
    beside.into_iter().filter_map(move |(role, what, note)| {
        let series = measurement.beside.get(role).filter(|series| series.title != measurement.value.title)?;
        Some(named_only(&series.title, &format!("{what} of {key}{note}")))
    })
}

#[cfg(test)]
mod tests;
