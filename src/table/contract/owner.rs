//! Who owns a column, and how a line is held against a rule.

use crate::table::cell::{Cell, Record};
use crate::table::dictionary::Role;

/// Who owns the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Owner {
    /// What is read.
    Role(Role),
    /// The rule of that number that leaves it out.
    Rule(usize),
    /// Nobody: it has no heading, and may have no cells.
    Nameless,
}

/// A record as one line: its cells between semicolons, without empty ones at its end.
pub(crate) fn line_of(record: &Record) -> String {
    record.filled().iter().map(Cell::text).collect::<Vec<_>>().join(";")
}
