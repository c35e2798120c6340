//! The values of a Q-DAS file as a table with a row per measured part. Made by [`Qdas::table`]; makes each row when it is asked for.

use std::collections::HashMap;

use super::values::Value;
use super::{Characteristic, Qdas};
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
        let rows = RowRuns::of(&self.characteristics);
        let numbers_differ = self.parts.iter().any(|part| part.number != self.parts[0].number);
        QdasTable { indices, rows, numbers_differ, qdas: self }
    }
}

/// Which rows there are: every pair of a part and a sample that some value has, once. Samples that follow each other are one run.
#[derive(Debug, Clone, Default)]
struct RowRuns {
    /// The first row of each run, its part and its first sample.
    runs: Vec<(usize, usize, u32)>,
    /// How many rows there are.
    count: usize,
}

impl RowRuns {
    fn of(characteristics: &[Characteristic]) -> Self {
        let runs = |one: &Characteristic| one.values.runs().map(|run| (one.part, run)).collect::<Vec<_>>();
        let mut all: Vec<(usize, (u32, u32))> = characteristics.iter().flat_map(runs).collect();
        all.sort_unstable();
        all.dedup();
        let mut found = Self::default();
        let mut reached: Option<(usize, u32)> = None;
        for (part, (first, last)) in all {
            let known = reached.filter(|(of, _)| *of == part).map(|(_, sample)| sample);
            let first = known.map_or(first, |known| first.max(known.saturating_add(1)));
            if first <= last {
                found.runs.push((found.count, part, first));
                found.count += (last - first + 1) as usize;
                reached = Some((part, last));
            }
        }
        found
    }

    /// Part and sample of a row.
    fn get(&self, row: usize) -> Option<(usize, u32)> {
        let run = self.runs.partition_point(|(first, ..)| *first <= row).checked_sub(1)?;
        let (first, part, sample) = self.runs[run];
        (row < self.count).then(|| (part, sample + (row - first) as u32))
    }
}

/// The values of a file as a table.
#[derive(Debug, Clone)]
pub(crate) struct QdasTable {
    /// The characteristics of each column but the first, one per part of the file, in the order of parts.
    pub(super) indices: Vec<Vec<usize>>,
    rows: RowRuns,
    /// Whether parts have numbers of their own (K1001).
    numbers_differ: bool,
    pub(super) qdas: Qdas,
}

impl QdasTable {
    /// How many rows it has.
    pub(crate) fn len(&self) -> usize {
        self.rows.count
    }

    /// The decimal mark of the values; `None` if none has decimals.
    ///
    /// # Errors
    /// If they have points and commas: the line of a value with the other mark.
    pub(crate) fn mark(&self) -> Result<Option<DecimalMark>, u32> {
        let values = self.qdas.characteristics.iter().flat_map(|characteristic| characteristic.values.iter());
        let mut marked = values.filter(|value| value.mark().is_some());
        let known = marked.next().and_then(Value::mark);
        marked.find(|value| value.mark() != known).map_or(Ok(known), |other| Err(other.line))
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
        let values = self.characteristics(part).filter_map(|found| found?.values.get(sample));
        let number = &self.qdas.parts[part].number;
        match values.map(|(_, name)| name).max().unwrap_or(0) {
            0 if !self.numbers_differ => (row + 1).to_string(),
            0 => format!("{number} {}", sample + 1),
            named => self.qdas.part_names.get(named).to_owned(),
        }
    }

    /// The refusal of the first row whose values have the names of different parts (K0014). The order of values joins them to rows, and
    /// these are not of one part.
    pub(crate) fn mixed(&self, file: &str) -> Option<Diagnostic> {
        if self.qdas.part_names.len() < 2 {
            return None;
        }
        (0..self.len()).filter_map(|row| self.rows.get(row)).find_map(|(part, sample)| {
            let values = self.characteristics(part).filter_map(|found| found?.values.get(sample));
            let mut named = values.filter(|(_, name)| *name > 0).peekable();
            let (_, first) = *named.peek()?;
            let (Value { line, .. }, other) = named.find(|(_, name)| *name != first)?;
            let [one, name] = [first, other].map(|number| self.qdas.part_names.get(number));
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
        let (part, sample) = self.rows.get(row)?;
        let name = Content::of_text(&self.part_name(row, part, sample));
        let values = self.characteristics(part).map(|found| {
            let number = found.and_then(|found| found.values.get(sample)?.0.number());
            number.map_or(Content::Empty, Content::Number)
        });
        let cells: Vec<Cell> = std::iter::once(name).chain(values).map(Cell::from).collect();
        Some(Record::new(cells, u64::from(self.line(row))))
    }

    /// The line of the file where a row stands.
    pub(super) fn line(&self, row: usize) -> u32 {
        let Some((part, sample)) = self.rows.get(row) else { return 0 };
        let value = self.characteristics(part).flatten().find_map(|found| found.values.get(sample));
        value.map_or(0, |(value, _)| value.line)
    }
}

/// The heading of a column: the name that the contract or the dictionary knows, with its unit.
pub(super) fn title(characteristic: &Characteristic, layout: &Layout) -> String {
    characteristic.with_unit(characteristic.called(layout))
}
