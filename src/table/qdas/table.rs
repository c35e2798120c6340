//! The values of a Q-DAS file as a table with a row per measured part. Made by [`Qdas::table`]; keeps no value, and
//! makes each row when it is asked for.

use std::collections::HashMap;

use super::{Characteristic, Qdas};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::{Decimal, Unit};
use crate::table::cell::{Cell, Content, Record};
use crate::table::names::{self, Field};
use crate::table::number::{DecimalMark, quantity};

impl Characteristic {
    /// How far its limits are from its nominal value, mm or degrees; `None` if it has none.
    fn widest(&self, unit: Unit) -> Option<f64> {
        let base = |text: &Option<String>| {
            let number = Decimal::parse(text.as_deref()?).ok()?;
            quantity(number, unit).ok().map(DeviationValue::base)
        };
        let nominal = base(&self.nominal).unwrap_or(0.0);
        let ends = [&self.lower, &self.upper].into_iter().filter_map(base);
        ends.map(|end| (end - nominal).abs()).reduce(f64::max)
    }
}

impl Qdas {
    /// The values as a table: a row per measured part, a column per characteristic with its unit. Columns of errors
    /// have the error's name.
    pub(crate) fn table(self, own: &[(String, Field)]) -> QdasTable {
        let mut indices: Vec<Vec<usize>> = Vec::new();
        // the same characteristic of several parts is one column
        let mut columns: HashMap<String, Vec<usize>> = HashMap::new();
        let mut of_part: HashMap<(usize, usize), usize> = HashMap::new();
        for (index, characteristic) in self.characteristics.iter().enumerate() {
            let titled = columns.entry(title(characteristic, own)).or_default();
            let first = titled.first().copied().unwrap_or(indices.len());
            let before = of_part.entry((first, characteristic.part)).or_default();
            if let Some(column) = titled.get(*before) {
                indices[*column].push(index);
            } else {
                titled.push(indices.len());
                indices.push(vec![index]);
            }
            *before += 1;
        }
        for indices in &mut indices {
            indices.sort_by_key(|index| self.characteristics[*index].part);
        }
        let mut rows: Vec<(usize, u32)> = Vec::new();
        for characteristic in &self.characteristics {
            rows.extend(characteristic.values.iter().map(|value| (characteristic.part, value.sample)));
        }
        rows.sort_unstable();
        rows.dedup();
        let numbers_differ = self.parts.iter().any(|part| part.number != self.parts[0].number);
        QdasTable { indices, rows, numbers_differ, qdas: self }
    }
}

/// The values of a file as a table.
#[derive(Debug, Clone)]
pub(crate) struct QdasTable {
    /// The characteristics of each column but the first, one per part of the file, in the order of parts.
    pub(super) indices: Vec<Vec<usize>>,
    /// Part and sample.
    rows: Vec<(usize, u32)>,
    /// Whether parts have numbers of their own (K1001).
    numbers_differ: bool,
    pub(super) qdas: Qdas,
}

impl QdasTable {
    /// How many rows it has.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// The decimal mark of the values; `None` if none has decimals.
    ///
    /// # Errors
    /// If they have points and commas: the line of a value with the other mark.
    pub(crate) fn mark(&self) -> Result<Option<DecimalMark>, u32> {
        let values = self.qdas.characteristics.iter().flat_map(|characteristic| &characteristic.values);
        let mut marked = values.filter(|value| value.number.is_some() && value.mark.is_some());
        let known = marked.next().and_then(|value| value.mark);
        marked.find(|value| value.mark != known).map_or(Ok(known), |other| Err(other.line))
    }

    fn characteristics(&self, part: usize) -> impl Iterator<Item = Option<&Characteristic>> {
        let all = &self.qdas.characteristics;
        self.indices.iter().map(move |indices| {
            let found = indices.binary_search_by_key(&part, |index| all[*index].part).ok()?;
            Some(&all[indices[found]])
        })
    }

    /// What the row's part is called: as the file names it (K0014), or else by a number.
    fn part_name(&self, row: usize, part: usize, sample: u32) -> String {
        let values = self.characteristics(part).filter_map(|found| found?.sample(sample));
        let number = &self.qdas.parts[part].number;
        match values.map(|value| value.part_name).max().unwrap_or(0) {
            0 if !self.numbers_differ => (row + 1).to_string(),
            0 => format!("{number} {}", sample + 1),
            named => self.qdas.part_names[named as usize - 1].clone(),
        }
    }

    /// The refusal of the first row whose values have the names of different parts (K0014): they are joined by their order, and
    /// are not of one part.
    pub(crate) fn mixed(&self, file: &str) -> Option<Diagnostic> {
        if self.qdas.part_names.len() < 2 {
            return None;
        }
        self.rows.iter().find_map(|(part, sample)| {
            let values = self.characteristics(*part).filter_map(|found| found?.sample(*sample));
            let mut named = values.filter(|value| value.part_name > 0).peekable();
            let first = named.peek()?.part_name;
            let other = named.find(|value| value.part_name != first)?;
            let [one, name] = [first, other.part_name].map(|index| &self.qdas.part_names[index as usize - 1]);
            let line = other.line;
            let message = format!("{file}, line {line}: this value is of `{name}` (K0014), and others measured with it of `{one}`");
            let help =
                "write the values of each part in one line, or those of every characteristic in the same order of parts";
            Some(Diagnostic::error(Code::BadTable, message).help(help))
        })
    }

    /// The names of the columns as the file writes them, with their units: `part_id` first. Of a characteristic's number
    /// and name it is what the spec or an error is called, if either is.
    pub(crate) fn header(&self, own: &[(String, Field)]) -> Record {
        let names = self.indices.iter().map(|indices| heading(&self.qdas.characteristics[indices[0]], own));
        let cells = std::iter::once("part_id".to_owned()).chain(names).map(|name| Content::of_text(&name).into());
        Record::new(cells.collect(), 1)
    }

    /// How far the limits of a column's characteristics are from their nominal values at most, mm or degrees; `None` if
    /// there are none.
    pub(crate) fn widest(&self, column: usize, unit: Unit) -> Option<f64> {
        let indices = column.checked_sub(1).and_then(|column| self.indices.get(column));
        let each = indices.into_iter().flatten().map(|index| &self.qdas.characteristics[*index]);
        each.filter_map(|characteristic| characteristic.widest(unit)).reduce(f64::max)
    }

    /// A row: the part's name and the values, nothing where there is none or it does not count; `None` beyond the last.
    pub(crate) fn record(&self, row: usize) -> Option<Record> {
        let (part, sample) = self.rows.get(row).copied()?;
        let name = Content::of_text(&self.part_name(row, part, sample));
        let values = self.characteristics(part).map(|found| {
            let number = found.and_then(|found| found.sample(sample)?.number);
            number.map_or(Content::Empty, Content::Number)
        });
        let cells: Vec<Cell> = std::iter::once(name).chain(values).map(Cell::from).collect();
        Some(Record::new(cells, u64::from(self.line(row))))
    }

    /// The line of the file where a row stands.
    pub(super) fn line(&self, row: usize) -> u32 {
        let Some((part, sample)) = self.rows.get(row).copied() else { return 0 };
        self.characteristics(part).flatten().find_map(|found| found.sample(sample)).map_or(0, |value| value.line)
    }
}

/// What a column is called in the reader of tables: as the spec calls it, or by the name of the error that it is.
pub(super) fn title(characteristic: &Characteristic, own: &[(String, Field)]) -> String {
    match Qdas::error_of(characteristic, own) {
        Some(kind) if characteristic.own_name(own).is_none() => characteristic.with_unit(kind.key()),
        _ => heading(characteristic, own),
    }
}

/// What a column is called: as the spec calls it, by the error whose name its number or name is, or by its name.
fn heading(characteristic: &Characteristic, own: &[(String, Field)]) -> String {
    if let Some((name, _)) = characteristic.own_name(own) {
        let has_unit = characteristic.unit.as_ref().is_some_and(|unit| name.trim().ends_with(&format!("[{unit}]")));
        return if has_unit { name.trim().to_owned() } else { characteristic.with_unit(name.trim()) };
    }
    let names = [&characteristic.number, &characteristic.name];
    let key =
        names.into_iter().find(|name| DeviationKind::ALL.iter().any(|kind| kind.key().eq_ignore_ascii_case(name)));
    let [number, name] = names;
    let named = key.unwrap_or(if name.is_empty() { number } else { name });
    let is_open = names::heading(named, &[]).is_some_and(|heading| heading.fields.len() > 1);
    match characteristic.gear.filter(|_| is_open) {
        Some(gear) => characteristic.with_unit(&format!("{} {named}", gear.name())),
        None => characteristic.with_unit(named),
    }
}
