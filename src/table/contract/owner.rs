//! The owner of a column, and the line that a rule is compared with.

use crate::table::cell::{Cell, Record};
use crate::table::dictionary::Role;

/// Who owns the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Owner {
    /// A role: the cells are read.
    Role(Role),
    /// The rule of that number, which leaves the column out.
    Rule(usize),
    /// Nobody: the column has no heading, and nothing may stand in it.
    Nameless,
}

/// A record as one line: its cells between semicolons, without empty ones at its end.
pub(crate) fn line_of(record: &Record) -> String {
    record.filled().iter().map(Cell::text).collect::<Vec<_>>().join(";")
}
