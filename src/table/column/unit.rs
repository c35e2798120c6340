//! The unit of a column's numbers, and what gives it.

use std::fmt;
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

/// The unit of a column's numbers, as an account says it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum UnitSaid {
    /// All have this one.
    Same(Unit),
    /// Each row has its own, in the column of this heading.
    PerRow(String),
}

/// Whether each row has its own unit: only a column of units gives it, and a value has no other companion.
const fn is_per_row(from: UnitFrom, companions: usize) -> bool {
    matches!(from, UnitFrom::Beside) && companions == 1
}

impl UnitSaid {
    /// The unit that something gives to a column with so many companions, of which one may have units, in a table with these headings.
    pub(crate) fn of(
        (unit, from): (Unit, UnitFrom),
        (units, companions): (Option<usize>, usize),
        titles: &[String],
    ) -> Self {
        let units = units.filter(|_| is_per_row(from, companions));
        units.map_or(Self::Same(unit), |place| Self::PerRow(titles[place].clone()))
    }

    /// The symbol of the unit that all numbers have.
    pub(crate) fn symbol(&self) -> Option<&'static str> {
        if let Self::Same(unit) = self { Some(unit.symbol()) } else { None }
    }
}

impl fmt::Display for UnitSaid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Same(unit) => f.write_str(unit.symbol()),
            Self::PerRow(heading) => write!(f, "unit by column `{}`", shown(heading)),
        }
    }
}

impl Column {
    /// The unit of its numbers in a table with these headings.
    pub(crate) fn unit_said(&self, titles: &[String]) -> UnitSaid {
        let units = self.beside.get(Role::Unit).map(|units| units.place);
        UnitSaid::of((self.unit, self.unit_from), (units, self.beside.iter().count()), titles)
    }

    /// Whether a text names the unit of its numbers.
    pub(crate) fn has_unit(&self, text: &str) -> bool {
        unit_of(text, self.field.is_angle()) == Some(self.unit)
    }

    /// The unit of a row's value. It is the column's, or that of the row's cell where each row has its own.
    pub(crate) fn unit_of_row(&self, cell: Option<&Cell>) -> Result<Unit, Problem> {
        let Some(cell) = cell else { return Ok(self.unit) };
        let text = cell.text();
        if self.has_unit(&text) || cell.is_missing() && self.unit_from != UnitFrom::Beside {
            return Ok(self.unit);
        }
        let own = unit_of(&text, self.field.is_angle()).filter(|unit| discriminant(unit) == discriminant(&self.unit));
        own.filter(|_| is_per_row(self.unit_from, self.beside.iter().count())).ok_or_else(|| {
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
