//! The unit of a column's numbers, and what gives it.

use std::mem::discriminant;

use super::{Column, Problem};
use crate::quantity::{Unit, shown};
use crate::table::cell::Cell;
use crate::table::field::Beside as Role;
use crate::table::grid::unit_of;

/// What gives the unit of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum UnitFrom {
    /// A heading or a line of units.
    Table,
    /// A column of units beside the values.
    Beside,
    /// The cells of values alone: each of them has it.
    Cells,
    /// The spec.
    Spec,
    /// Its key: a column that is called by it is in mm or degrees.
    Key,
}

impl Column {
    /// Whether a text names the unit of its numbers.
    pub(crate) fn has_unit(&self, text: &str) -> bool {
        unit_of(text, self.field.is_angle()) == Some(self.unit)
    }

    /// The unit of a row's value. It is the column's, or that of the row's cell where only a column of units gives it and the value
    /// has no other companion.
    pub(crate) fn unit_of_row(&self, cell: Option<&Cell>) -> Result<Unit, Problem> {
        let Some(cell) = cell else { return Ok(self.unit) };
        let text = cell.text();
        if self.has_unit(&text) || cell.is_missing() && self.unit_from != UnitFrom::Beside {
            return Ok(self.unit);
        }
        let is_own = self.unit_from == UnitFrom::Beside && self.beside.iter().count() == 1;
        let own = unit_of(&text, self.field.is_angle()).filter(|unit| discriminant(unit) == discriminant(&self.unit));
        own.filter(|_| is_own).ok_or_else(|| {
            Problem::new(format!(
                "the unit beside it is `{}`, and the column's is {}",
                shown(&text),
                self.unit.symbol()
            ))
        })
    }

    /// The unit of a companion's numbers.
    pub(super) fn unit_beside(&self, role: Role) -> Unit {
        self.beside.get(role).map_or(self.unit, |companion| companion.unit)
    }
}
