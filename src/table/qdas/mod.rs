//! Q-DAS ASCII files (AQDEF): `.dfq`, or a `.dfd` with definitions and its `.dfx` with values.
//!
//! The command line reads the files and calls [`read`]; what comes out is a [`Qdas`], from which `Qdas::table` makes
//! a table with a row per measured part, made row by row. Results go back with [`definition_lines`] and [`row_lines`]. Nothing here knows formulas.
//!
//! # The format, as far as it is read
//! A line `Kxxxx/i text` says something of characteristic (K2xxx, K0xxx) or part (K1xxx) i; `/0` says it of all. K0100
//! counts the characteristics; K1001 and K1002 number and name the part; K2001 and K2002 number and name a
//! characteristic, K2101 is its nominal value, K2110 and K2111 its limits (K2112 and K2113 as allowances from nominal),
//! counted where K2120 and K2121 are not 0, K2106 its expanded uncertainty, K2142 its unit. One whose K2004 is not 0 is no size,
//! and its values are none. K0009, K1900 and K2900 are remarks, and so is K0005 in words. Values are either K0001 lines, with
//! attribute K0002, date K0004 and the part's name K0014, or lines without a key: characteristics in their
//! order between bytes 0x0F, and for each value, attribute and date between bytes 0x14. What is said of a value stands behind
//! it. Where K0100 stands behind values, another header begins: the values behind it are of its parts and characteristics. Numbers have a decimal point or
//! comma and no thousands marks; text is UTF-8 or Latin-1. Keys that are not listed are passed over.
//!
//! # Which values count
//! Those with attribute 0 or none. The maker lists the attributes 0 (valid), 129, 255, 256 and 290 (Hexagon, Q-DAS data
//! format, "Defined contents K00xx"), and none but 0 enters a calculation. Whatever has another attribute, one that is
//! not in that list included, is no value; [`Qdas::left_out`] lists them.

mod definition;
mod read;
mod table;
mod write;

pub use read::read;
pub use write::{CharacteristicColumn, ValueRow, definition_lines, row_lines};

use super::names::{Field, heading};
use super::number::DecimalMark;
use crate::deviation::{DeviationKind, Part};
use crate::quantity::Decimal;

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
    /// Whether that is a rack or a pinion, if its name says so.
    gear: Option<Part>,
    values: Vec<Value>,
}

impl Characteristic {
    /// How many values it has, invalid ones included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether it has no values.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The entry of the spec's names that means this characteristic, by its number or name, with its unit or without;
    /// neither letter case nor blanks around it matter.
    fn own_name<'n>(&self, own: &'n [(String, Field)]) -> Option<&'n (String, Field)> {
        let plain = |name: &str| name.trim().to_lowercase();
        let names = [&self.number, &self.name].map(|name| [plain(name), plain(&self.with_unit(name))]);
        own.iter().find(|(name, _)| !name.trim().is_empty() && names.as_flattened().contains(&plain(name)))
    }

    /// A name with the unit of the values behind it.
    fn with_unit(&self, name: &str) -> String {
        self.unit.as_ref().map_or_else(|| name.to_owned(), |unit| format!("{name} [{unit}]"))
    }

    fn sample(&self, sample: u32) -> Option<&Value> {
        let index = self.values.binary_search_by_key(&sample, |value| value.sample).ok()?;
        self.values.get(index)
    }
}

/// One value. Files have millions of them.
#[derive(Debug, Clone, Copy)]
struct Value {
    /// `None` if there is none, or its attribute (K0002) says that it does not count.
    number: Option<Decimal>,
    /// The decimal mark that it is written with.
    mark: Option<DecimalMark>,
    line: u32,
    /// K0014: index of a name, from 1.
    part_name: u32,
    /// Which measured part: values of the same one have the same number.
    sample: u32,
}

/// K1001, K1002 and K1008.
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
    /// What is remarked.
    pub remarks: Vec<Remark>,
    /// What messages call the file of its values.
    pub name: String,
    part_names: Vec<String>,
}

/// A remark on a value (K0009), an event in words (K0005), a remark on a part (K1900) or a characteristic (K2900).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remark {
    /// Its key.
    pub key: u16,
    /// Its line.
    pub line: u32,
    /// What it says.
    pub text: String,
}

/// The code of values of a characteristic that is none of a size.
const OF_NO_SIZE: &str = "K2004";

/// Values that an attribute (K0002) marks as none, or the kind of their characteristic (K2004).
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
    /// What the maker's list calls such values; `None` if it does not have the attribute.
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
    /// Which error a characteristic is: by the name that the spec gives to it; of an error that the spec gives no name
    /// to, by the error's own name, or what its number or name says in English or German, beside that of its part.
    #[must_use]
    pub fn error_of(characteristic: &Characteristic, own: &[(String, Field)]) -> Option<DeviationKind> {
        if let Some((_, field)) = characteristic.own_name(own) {
            return error(*field);
        }
        let names = [&characteristic.number, &characteristic.name];
        names.into_iter().find_map(|name| {
            let fields = heading(name, &[])?.fields;
            let mut kinds = fields.iter().filter_map(|field| error(*field));
            let kind = match fields[..] {
                [_] => kinds.next(),
                _ => kinds.find(|kind| characteristic.gear == Some(kind.part())),
            };
            kind.filter(|kind| own.iter().all(|(_, named)| error(*named) != Some(*kind)))
        })
    }
}

fn error(field: Field) -> Option<DeviationKind> {
    match field {
        Field::Error(kind) => Some(kind),
        Field::OverPin => Some(DeviationKind::RackOverRoller),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
