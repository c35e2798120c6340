//! The values of a Q-DAS file as a table with a row per measured part. Made by [`Qdas::table`]; makes each row when it is asked for.

use std::collections::HashMap;

use super::{Characteristic, Qdas, Value};
use crate::deviation::DeviationValue;
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::{Decimal, Unit};
use crate::table::cell::{Cell, Content, Record};
use crate::table::layout::Layout;
use crate::table::number::{DecimalMark, quantity};

impl Characteristic {
    /// How far its limits are from its nominal value at most, mm or degrees; `None` if it has no limits.
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
    /// The values as a table: a row per measured part, a column per characteristic with its unit.
    pub(crate) fn table(self, layout: &Layout) -> QdasTable {
        let mut indices: Vec<Vec<usize>> = Vec::new();
        // the same characteristic of several parts is one column
        let mut columns: HashMap<String, Vec<usize>> = HashMap::new();
        let mut of_part: HashMap<(usize, usize), usize> = HashMap::new();
        for (index, characteristic) in self.characteristics.iter().enumerate() {
            let titled = columns.entry(title(characteristic, layout)).or_default();
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
        let part = |characteristic: &Characteristic| u32::try_from(characteristic.part).unwrap_or(u32::MAX);
        let samples: Vec<_> = self.characteristics.iter().map(|one| (part(one), one.values.as_slice())).collect();
        let rows = rows_of(samples);
        let numbers_differ = self.parts.iter().any(|part| part.number != self.parts[0].number);
        QdasTable { indices, rows, numbers_differ, qdas: self }
    }
}

/// Part and sample of each row: every pair that some value has, once. Most characteristics have the same samples, so that only new ones
/// are added.
fn rows_of(mut of: Vec<(u32, &[Value])>) -> Vec<(u32, u32)> {
    of.sort_by_key(|(part, _)| *part);
    let mut rows: Vec<(u32, u32)> = Vec::new();
    for same in of.chunk_by(|(one, _), (other, _)| one == other) {
        let first = rows.len();
        for (part, values) in same {
            let is_known = |value: &Value| rows[first..].binary_search(&(*part, value.sample)).is_ok();
            let new: Vec<_> =
                values.iter().filter(|value| !is_known(value)).map(|value| (*part, value.sample)).collect();
            rows.extend(new);
            rows[first..].sort_unstable();
        }
    }
    rows.dedup();
    rows
}

/// The values of a file as a table.
#[derive(Debug, Clone)]
pub(crate) struct QdasTable {
    /// The characteristics of each column but the first, one per part of the file, in the order of parts.
    pub(super) indices: Vec<Vec<usize>>,
    /// Part and sample of each row.
    rows: Vec<(u32, u32)>,
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

    /// Part and sample of a row.
    fn row(&self, row: usize) -> Option<(usize, u32)> {
        self.rows.get(row).map(|(part, sample)| (*part as usize, *sample))
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

    /// The refusal of the first row whose values have the names of different parts (K0014). The order of values joins them to rows, and
    /// these are not of one part.
    pub(crate) fn mixed(&self, file: &str) -> Option<Diagnostic> {
        if self.qdas.part_names.len() < 2 {
            return None;
        }
        (0..self.len()).filter_map(|row| self.row(row)).find_map(|(part, sample)| {
            let values = self.characteristics(part).filter_map(|found| found?.sample(sample));
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

    /// The names of the columns with their units: `part_id` first.
    pub(crate) fn header(&self, layout: &Layout) -> Record {
        let names = self.indices.iter().map(|indices| title(&self.qdas.characteristics[indices[0]], layout));
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

    /// A row: the part's name and the values, with an empty cell where there is no value or it does not count; `None` beyond the last
    /// row.
    pub(crate) fn record(&self, row: usize) -> Option<Record> {
        let (part, sample) = self.row(row)?;
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
        let Some((part, sample)) = self.row(row) else { return 0 };
        self.characteristics(part).flatten().find_map(|found| found.sample(sample)).map_or(0, |value| value.line)
    }
}

/// The heading of a column: the name that the contract or the dictionary knows, with its unit.
pub(super) fn title(characteristic: &Characteristic, layout: &Layout) -> String {
    characteristic.with_unit(characteristic.called(layout))
}
