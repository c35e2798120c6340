//! Q-DAS ASCII files (AQDEF): `.dfq`, or a `.dfd` with definitions and its `.dfx` with values.
//!
//! The command line reads the files and calls [`read`]; what comes out is a [`Qdas`], from which [`Qdas::table`] makes
//! a table with a row per measured part. Results go back with [`write`](fn@write). Nothing here knows formulas.
//!
//! # The format, as far as it is read
//! A line `Kxxxx/i text` says something of characteristic (K2xxx, K0xxx) or part (K1xxx) i; `/0` says it of all. K0100
//! counts the characteristics; K1001 and K1002 number and name the part; K2001 and K2002 number and name a
//! characteristic, K2101 is its nominal value, K2110 and K2111 its limits (K2112 and K2113 as allowances from nominal),
//! counted where K2120 and K2121 are not 0, K2106 its expanded uncertainty, K2142 its unit. Values are either K0001
//! lines, with attribute K0002, date K0004 and the part's name K0014, or lines without a key: characteristics in their
//! order between bytes 0x0F, and for each value, attribute and date between bytes 0x14. Attribute 255 marks what is no
//! value. Numbers have a decimal point or comma and no thousands marks; text is UTF-8 or Latin-1. Keys that are not
//! listed are passed over.

mod read;
mod write;

pub use read::read;
pub use write::{Column, write};

use std::sync::Arc;

use super::paste::{Field, heading_fields};
use super::sheet::Sheet;
use crate::deviation::ErrorKind;
use crate::diagnostic::Source;

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

    fn sample(&self, sample: u32) -> Option<&Value> {
        let index = self.values.binary_search_by_key(&sample, |value| value.sample).ok()?;
        self.values.get(index)
    }
}

/// One value: bytes of a source. Files have millions of them.
#[derive(Debug, Clone, Copy, Default)]
struct Value {
    source: u8,
    start: u32,
    length: u8,
    /// K0002
    invalid: bool,
    line: u32,
    /// K0014: index of a name, from 1.
    part_name: u32,
    /// Which measured part: values of the same one have the same number.
    sample: u32,
}

/// K1001 and K1002.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PartDefinition {
    /// K1001
    pub number: String,
    /// K1002
    pub name: String,
}

/// The content of a file.
#[derive(Debug, Clone)]
pub struct Qdas {
    /// The parts that the file defines; at least one.
    pub parts: Vec<PartDefinition>,
    /// Its characteristics, in their order.
    pub characteristics: Vec<Characteristic>,
    sources: Vec<Arc<Source>>,
    part_names: Vec<String>,
}

impl Qdas {
    /// The value of a sample, with a decimal point; `None` if it is not valid or there is none.
    fn value(&self, characteristic: &Characteristic, sample: u32) -> Option<String> {
        let value = characteristic.sample(sample).filter(|value| !value.invalid)?;
        let text = &self.sources[usize::from(value.source)].text;
        let text = &text[value.start as usize..value.start as usize + usize::from(value.length)];
        Some(text.trim().replace(',', "."))
    }

    /// Which error a characteristic is: by a name that the spec gives, an error's own name, or what its number or
    /// name says in English or German.
    #[must_use]
    pub fn error_of(characteristic: &Characteristic, own: &[(String, Field)]) -> Option<ErrorKind> {
        [&characteristic.number, &characteristic.name].into_iter().find_map(
            |name| match heading_fields(name, own)[..] {
                [Field::Error(kind)] => Some(kind),
                [Field::OverPin] => Some(ErrorKind::RackOverRoller),
                _ => None,
            },
        )
    }

    /// The values as a table: a row per measured part, a column per characteristic with its unit. Columns of errors
    /// have the error's name.
    #[must_use]
    pub fn table(self, own: &[(String, Field)]) -> QdasTable {
        let mut columns = vec!["part_id".to_owned()];
        // the same characteristic of several parts is one column
        let mut indices: Vec<Vec<usize>> = Vec::new();
        for (index, characteristic) in self.characteristics.iter().enumerate() {
            let title = title(characteristic, own);
            let known = columns.iter().skip(1).zip(&mut indices).find(|(column, indices)| {
                **column == title
                    && indices.iter().all(|other| self.characteristics[*other].part != characteristic.part)
            });
            if let Some((_, indices)) = known {
                indices.push(index);
            } else {
                columns.push(title);
                indices.push(vec![index]);
            }
        }
        let mut rows: Vec<(usize, u32)> = Vec::new();
        for characteristic in &self.characteristics {
            rows.extend(characteristic.values.iter().map(|value| (characteristic.part, value.sample)));
        }
        rows.sort_unstable();
        rows.dedup();
        QdasTable { columns, indices, rows, qdas: self }
    }
}

/// The values of a file as a table.
#[derive(Debug, Clone)]
pub struct QdasTable {
    /// The names of the columns; the first is `part_id`.
    pub columns: Vec<String>,
    /// The characteristics of each other column, one per part of the file.
    indices: Vec<Vec<usize>>,
    /// Part and sample.
    rows: Vec<(usize, u32)>,
    qdas: Qdas,
}

impl QdasTable {
    /// How many rows it has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether it has no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// What the file says.
    #[must_use]
    pub fn qdas(&self) -> &Qdas {
        &self.qdas
    }

    fn characteristics(&self, part: usize) -> impl Iterator<Item = Option<&Characteristic>> {
        self.indices.iter().map(move |indices| {
            indices.iter().map(|index| &self.qdas.characteristics[*index]).find(|found| found.part == part)
        })
    }

    /// The cells of a row; empty if it is beyond the last.
    #[must_use]
    pub fn row(&self, row: usize) -> Vec<String> {
        let Some((part, sample)) = self.rows.get(row).copied() else { return Vec::new() };
        let values = || self.characteristics(part).map(|found| (found, found.and_then(|found| found.sample(sample))));
        let named = values().filter_map(|(_, value)| value).map(|value| value.part_name).max().unwrap_or(0);
        let number = &self.qdas.parts[part].number;
        let name = match named {
            0 if self.qdas.parts.len() == 1 => (row + 1).to_string(),
            0 => format!("{number} {}", sample + 1),
            named => self.qdas.part_names[named as usize - 1].clone(),
        };
        let cells =
            values().map(|(found, _)| found.and_then(|found| self.qdas.value(found, sample)).unwrap_or_default());
        std::iter::once(name).chain(cells).collect()
    }

    /// Where a row stands: file and line.
    #[must_use]
    pub fn place(&self, row: usize) -> String {
        let Some((part, sample)) = self.rows.get(row).copied() else { return String::new() };
        let first = self.characteristics(part).flatten().find_map(|found| found.sample(sample));
        first.map_or_else(String::new, |value| {
            format!("{} line {}", self.qdas.sources[usize::from(value.source)].name, value.line)
        })
    }

    /// The line of the file where a row stands.
    #[must_use]
    pub fn line(&self, row: usize) -> u32 {
        let Some((part, sample)) = self.rows.get(row).copied() else { return 0 };
        self.characteristics(part).flatten().find_map(|found| found.sample(sample)).map_or(0, |value| value.line)
    }

    /// The table in memory, as many rows as `most_cells` allow.
    #[must_use]
    pub fn sheet(&self, name: &str, most_cells: usize) -> Sheet {
        let rows = (most_cells / self.columns.len().max(1)).min(self.rows.len());
        Sheet {
            name: name.to_owned(),
            header_line: 1,
            columns: self.columns.clone(),
            rows: (0..rows).map(|row| (self.line(row), self.row(row))).collect(),
        }
    }
}

fn title(characteristic: &Characteristic, own: &[(String, Field)]) -> String {
    let name = match Qdas::error_of(characteristic, own) {
        Some(kind) => kind.key(),
        None if characteristic.name.is_empty() => &characteristic.number,
        None => &characteristic.name,
    };
    match &characteristic.unit {
        Some(unit) => format!("{name} [{unit}]"),
        None => name.to_owned(),
    }
}

#[cfg(test)]
mod tests;
