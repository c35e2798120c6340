//! Q-DAS ASCII files (AQDEF): `.dfq`, or a `.dfd` with definitions and its `.dfx` with values.
//!
//! [`read`] reads the texts of the files into a [`Qdas`]; `Qdas::table` makes a table from it, with a row per measured part.
//! [`definition_lines`] and [`row_lines`] write results. Nothing here knows formulas.
//!
//! # The format, as far as it is read
//! A line `Kxxxx/i text` is about part i (K1xxx) or characteristic i (K2xxx, K0xxx); `/0` is about all of them.
//!
//! | key | what it says |
//! |---|---|
//! | K0100 | number of characteristics |
//! | K1001, K1002 | number and name of the part |
//! | K2001, K2002 | number and name of the characteristic |
//! | K2004 | its kind: one that is not 0 is no size, and its values do not count |
//! | K2101 | its nominal value |
//! | K2110, K2111 | its lower and upper limit; K2112 and K2113 give them as allowances from nominal; they count where K2120 and K2121 are not 0 |
//! | K2106 | its expanded uncertainty |
//! | K2142 | its unit |
//! | K0001 | a value; its attribute K0002, its date K0004 and the part's name K0014 stand behind it |
//! | K0009, K1900, K2900 | remarks; so are words under keys that have numbers (K0005, K2005, …), reasons of a test (K1203) and texts of characteristics (K2092) |
//!
//! Values may stand in lines without a key, too: the characteristics in their order between bytes 0x0F, and for each its value,
//! attribute and date between bytes 0x14. A K0100 behind values begins another header: the values behind it are of the parts and
//! characteristics of that header. Numbers have a decimal point or comma and no thousands marks; text is UTF-8 or Latin-1. Other keys
//! of the format say nothing of values. Remarks, and texts under all other keys, need a rule.
//!
//! # Which values count
//! Values with attribute 0 or none count. The maker lists the attributes 0 (valid), 129, 255, 256 and 290 (Hexagon, Q-DAS data
//! format, "Defined contents K00xx"), and only 0 enters a calculation. A value with any other attribute, also one outside that
//! list, does not count; [`Qdas::left_out`] lists them.

mod closed;
mod definition;
mod keys;
mod read;
mod remarks;
mod table;
mod values;
mod write;

pub(crate) use closed::qdas_table;
pub use read::read;
pub(crate) use read::read_all;
pub use write::{CharacteristicColumn, ValueRow, definition_lines, row_lines};

use super::contract::{Owner, owner};
use super::dictionary::{Form, Role, lookup};
use super::field::Field;
use super::layout::Layout;
use super::ledger::Tally;
use crate::deviation::DeviationKind;
use remarks::Remarks;
use values::{Names, Values};

/// A characteristic and its values.
#[derive(Debug, Clone, Default)]
pub struct Characteristic {
    /// K2001
    pub number: String,
    /// K2002
    pub name: String,
    /// K2101, with a decimal point.
    pub nominal: Option<String>,
    /// K2110, or K2112 added to the nominal value; with a decimal point.
    pub lower: Option<String>,
    /// K2111, or K2113 added to the nominal value.
    pub upper: Option<String>,
    /// K2142
    pub unit: Option<String>,
    /// K2106
    pub uncertainty: Option<String>,
    /// Which part definition of the file it belongs to, from 0.
    pub part: usize,
    /// Limits that are not used, with the reason.
    pub unused: Vec<String>,
    values: Values,
}

impl Characteristic {
    /// The number of values, invalid ones included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether it has no values.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Its number and its name, as far as it has them.
    fn names(&self) -> impl Iterator<Item = &str> + Clone {
        [self.number.trim(), self.name.trim()].into_iter().filter(|name| !name.is_empty())
    }

    /// What a contract calls it: its number or its name, whichever has an owner; its name if neither has.
    fn called(&self, layout: &Layout) -> &str {
        let of =
            |is_owned: &dyn Fn(&str, &str) -> bool| self.names().find(|name| is_owned(&self.with_unit(name), name));
        of(&|title, name| layout.declared(title, name, Form::Parts).is_some())
            .or_else(|| of(&|title, name| layout.ignores(title, name, usize::MAX - 1, true).is_some()))
            .or_else(|| of(&|_, name| lookup(Form::Parts, name).is_some()))
            .or_else(|| self.names().last())
            .unwrap_or_default()
    }

    /// A name with the unit of the values behind it.
    fn with_unit(&self, name: &str) -> String {
        self.unit.as_ref().map_or_else(|| name.to_owned(), |unit| format!("{name} [{unit}]"))
    }
}

/// A part as the file defines it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PartDefinition {
    /// K1001
    pub number: String,
    /// K1002
    pub name: String,
    /// K1008
    pub kind: String,
}

/// The content of a file.
#[derive(Debug, Clone)]
pub struct Qdas {
    /// The parts that the file defines; at least one.
    pub parts: Vec<PartDefinition>,
    /// Its characteristics, in their order.
    pub characteristics: Vec<Characteristic>,
    /// The values that do not count, by their attribute, in the order of their first lines.
    pub left_out: Vec<LeftOut>,
    /// Remarks, and texts under unknown keys.
    pub(crate) remarks: Remarks,
    /// What the other keys of the format say.
    pub(crate) said: Tally,
    /// The name of the file of values in messages.
    pub name: String,
    part_names: Names,
}

/// The code of values whose characteristic is no size.
const OF_NO_SIZE: &str = "K2004";

/// Values that do not count because of their attribute (K0002) or the kind of their characteristic (K2004).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// The attribute, as it is written.
    pub code: String,
    /// How many values have it.
    pub count: usize,
    /// The line of the first.
    pub first_line: u32,
}

impl LeftOut {
    /// The name of such values in the maker's list; `None` if the list does not have the attribute.
    #[must_use]
    pub fn meaning(&self) -> Option<&'static str> {
        match self.code.as_str() {
            "129" => Some("invalid"),
            "255" => Some("placeholder"),
            "256" => Some("deleted"),
            "290" => Some("not plausible"),
            OF_NO_SIZE => Some("of a characteristic that is no size"),
            _ => None,
        }
    }
}

impl Qdas {
    /// Which error a characteristic is: by the name that the contract gives to it, or because its number or name is a heading of
    /// the dictionary.
    #[must_use]
    pub fn error_of(characteristic: &Characteristic, layout: &Layout) -> Option<DeviationKind> {
        let called = characteristic.called(layout);
        match owner(&characteristic.with_unit(called), called, usize::MAX - 1, layout, Form::Parts) {
            Ok(Some(Owner::Role(Role::Value(Field::Error(kind))))) => Some(kind),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests;
