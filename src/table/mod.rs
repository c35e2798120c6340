//! Tables of measured values, whatever file they are in, as typed columns: the one reader.
//!
//! The command line opens files and hands them in as bytes ([`Container::open`]); the spec and the user say what is known
//! ([`Want`]). The result is a [`Table`]: columns with roles, units and nominal values, how these were found ([`Reading`]), and
//! the rows, as [`Block`]s of columns. `batch`, `paste`, `report`, `read` and the tables that a spec names all use this reader.
//! Nothing here knows gear geometry.
//!
//! # How a table is read
//! ```text
//! bytes ─ encoding ─ text ─ split, grid ─┐
//! workbook ──────────────────────────────┼─ records ─ contract (dictionary, layout) ─ columns ─ rows (ledger) ─ blocks
//! qdas, report ──────────────────────────┤
//! parquet ───────────────────────────────┘
//! ```
//! | module | what it is |
//! |---|---|
//! | `encoding`, `chunk`, `split`, `grid`, `fixed` | bytes to text, text to records, records to cells |
//! | `workbook`, `qdas`, `parquet`, `report`, `typed` | files whose cells are typed, and reports whose format says what each cell is |
//! | `field`, `dictionary`, `layout`, `pattern` | the roles of columns, the known headings, and a person's contract |
//! | `contract` | gives each column and line its owner, or refuses the table |
//! | `account`, `propose` | the cells of a table with their owners; the lines that would close it: no path to a result |
//! | `ledger` | which cells were read, and what rules left out |
//! | `number`, `column`, `companions` | the meaning of a cell |
//! | `rows`, `pieces`, `block` | rows to columns |
//! | `reading` | how it was read, for the result |
//! | `teeth`, `trace` | rows that are spaces of a rack, teeth of a pinion, or points of a measured curve |
//!
//! # The rule
//! Every cell that is not blank has one owner: a role, or a rule that a person wrote. If one has none, there is no table, and
//! the refusal lists all of them. Words decide nothing. A cell is a number, says that there is no value (`n.a.`, `-`,
//! `#DIV/0!`), or rejects its row with its place.
//!
//! ```
//! use rackmesh::table::{Container, Source, Want};
//!
//! let bytes = "Teil;Rollenmaß Abweichung [µm]\nP1;13,1\nP2;-2,5\n";
//! let container = Container::open("parts.csv", Source::bytes(bytes.as_bytes().to_vec()), &Want::default())?;
//! let table = container.table("parts.csv", &Want::default())?;
//! assert_eq!(table.reading.columns[1].role, "rack_over_roller");
//! assert_eq!(table.reading.decimal_mark, Some("comma"));
//! # Ok::<(), rackmesh::diagnostic::Diagnostics>(())
//! ```

mod account;
mod block;
mod cell;
mod chunk;
mod column;
mod companions;
mod container;
mod contract;
mod dictionary;
mod encoding;
mod field;
mod fixed;
mod grid;
mod layout;
mod ledger;
mod number;
mod parquet;
mod pattern;
mod pieces;
mod propose;
pub mod qdas;
mod reading;
mod report;
mod rows;
mod split;
mod stored;
mod teeth;
mod text;
mod trace;
mod typed;
mod want;
pub mod workbook;

pub use account::{ColumnAccount, LineAccount, Proposal};
pub use block::{Block, Contradiction, Fault};
pub use container::{Container, Source};
pub use encoding::{Encoding, decode};
pub use field::{Field, UnknownField, ValueKind};
pub use grid::Separator;
pub(crate) use layout::DETAILS;
pub use layout::{ColumnOption, DeclaredColumn, IsCurve, Layout, LineRule, PartNames, Parts, Repeats, StatusColumn};
pub use ledger::{LeftOut, Tally};
pub use number::DecimalMark;
pub use pattern::Pattern;
pub(crate) use propose::OddRows;
pub use propose::{Guesses, table_in_sentences};
pub use reading::{AsideReading, ColumnReading, NotUsed, Reading};
pub use stored::Stored;
pub use teeth::gather::{TeethTable, of_one_part};
pub use teeth::{Measured, PinionTeeth, PinionTooth, RackSpace, RackSpaces, RowExtent, Teeth};
pub use trace::Trace;
pub use want::{GivenColumn, Want};
pub use workbook::{CellRange, KnownWorkbook};

pub(crate) use column::{Column, Nominal, in_words};
pub(crate) use encoding::text as cell_text;
pub(crate) use grid::unit_of;
pub(crate) use layout::MOST_RULES;
pub(crate) use ledger::join as join_left_out;
pub(crate) use parquet::ROWS_TOGETHER;
pub(crate) use pieces::{Piece, Pieces, Place, Queue};
pub(crate) use reading::ASIDES_KEPT;
pub(crate) use rows::{Doubtful, Rows, Wanted};
pub(crate) use teeth::gather::{Gatherer, gather};
pub(crate) use teeth::{LineFault, ToothedPart};
pub(crate) use typed::stored_table;
pub(crate) use want::quoted;

use std::sync::Arc;

use crate::deviation::DeviationKind;
use crate::quantity::{Unit, shown};

/// A table with known columns, whose rows are still to be read.
pub struct Table {
    /// Its name in messages.
    pub name: Arc<str>,
    /// How it was read.
    pub reading: Reading,
    /// Whether each row is a tooth or a space; else it is a part.
    pub is_teeth: bool,
    /// Whether parts have names.
    pub has_id: bool,
    /// Whether a part may appear only once.
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
    /// The errors with a column.
    pub fn kinds(&self) -> impl Iterator<Item = DeviationKind> + '_ {
        self.columns.iter().filter_map(|column| column.kind)
    }

    /// All rows, in order.
    pub(crate) fn rows(self, wanted: Wanted) -> impl Iterator<Item = std::io::Result<Block>> {
        let (rows, mut queue) = self.pieces.open(wanted);
        let mut piece = Piece::default();
        let mut doubtful = Doubtful::default();
        std::iter::from_fn(move || match queue.next(&rows, &mut piece) {
            Ok(false) => {
                let found = std::mem::take(&mut doubtful).contradiction(&rows);
                found.is_some().then(|| Ok(Block { contradiction: found, ..Block::default() }))
            }
            Err(error) => Some(Err(error)),
            Ok(true) => {
                piece.read(&rows);
                doubtful.add(&rows, &piece.block);
                Some(Ok(std::mem::take(&mut piece.block)))
            }
        })
    }

    /// All of its rows, with every column read.
    ///
    /// # Errors
    /// If it cannot be read to its end.
    pub fn blocks(self) -> Result<Vec<Block>, std::io::Error> {
        self.rows(Wanted::default()).collect()
    }

    /// The columns for a message, up to a limit; columns without a name (the margin of a sheet) are left out.
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

fn named_only(title: &str, role: &str) -> ColumnReading {
    ColumnReading { title: title.to_owned(), role: role.to_owned(), ..ColumnReading::default() }
}

/// How a column is read, whatever units single rows have.
fn column_reading_of(column: &Column) -> ColumnReading {
    let is_angle = column.field.is_angle();
    let holds = match (column.nominal, column.holds) {
        (Nominal::None, Some(ValueKind::Deviation)) => "deviation",
        (Nominal::None, None) if column.field.is_of_trace() => "measured",
        (Nominal::None, None) if column.kind.is_some() || !column.is_of_space() => "deviation",
        _ => "measured",
    };
    let is_slope = is_angle && matches!(column.unit, Unit::Length(_));
    ColumnReading {
        title: column.title.clone(),
        role: column.kind.map_or(column.field.key(), DeviationKind::key).to_owned(),
        unit: Some(column.unit.symbol().to_owned()),
        holds: Some(if is_slope { "f_Hβ" } else { holds }),
        nominal: match column.nominal {
            Nominal::None => None,
            Nominal::Fixed(nominal) => Some(in_words(nominal)),
            Nominal::Beside => Some("beside it".to_owned()),
        },
    }
}

#[cfg(test)]
mod tests;
