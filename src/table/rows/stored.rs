//! Reads stored columns into a block: whole columns of plain numbers at once, other rows as records.

use super::super::block::{Block, Span};
use super::super::cell::Record;
use super::super::contract::{Contract, Owner};
use super::super::stored::Stored;
use super::{Column, PlainColumn, Rows};
use crate::deviation::{DeviationValue, DeviationValues};

impl Rows {
    /// The columns of plain numbers; `None` if these are not all that is read of a row.
    fn plain_columns(&self) -> Option<&Vec<PlainColumn>> {
        self.plain_columns.as_ref().filter(|_| !self.wanted.keeps_raw)
    }

    /// Which of so many fields are read.
    pub(crate) fn places(&self, fields: usize) -> Vec<bool> {
        // what a rule leaves out is not unpacked, unless it is copied
        let is_read = |place: usize| !matches!(self.setup.contract.owners.get(place), Some(Owner::Rule(_)));
        (0..fields).map(|place| is_read(place) || self.wanted.copied.contains(&place)).collect()
    }

    /// Reads rows of stored columns; a field that is not read has none. The table has `before` rows before these.
    pub(crate) fn stored(&self, fields: &[Option<Stored<'_>>], before: u64, block: &mut Block) {
        let rows = fields.iter().flatten().map(Stored::rows).max().unwrap_or(0);
        block.clear(self.setup.columns.iter().map(Column::nothing));
        let plain = self.plain_columns();
        let of_column = |column: &PlainColumn| Some((*column, fields[column.place].as_ref()?));
        let plain: Option<Vec<_>> = plain.and_then(|columns| columns.iter().map(of_column).collect());
        let Some(columns) = plain else {
            for row in 0..rows {
                self.record(&stored_record(fields, row, before), block);
            }
            return;
        };
        // rows whose numbers do not say all are read as records
        let mut odd = Vec::new();
        let of_column = |(column, stored): &(PlainColumn, &Stored<'_>)| {
            deviations(column, stored, self.setup.columns[column.number].nothing(), &mut odd)
        };
        let mut values: Vec<_> = columns.iter().map(of_column).collect();
        let names = self.setup.id.and_then(|place| fields[place].as_ref());
        if let Some(names) = names {
            odd.extend((0..rows).filter(|row| !names.text(*row).is_some_and(Contract::is_plain_name)));
            block.text.extend_from_slice(names.all_text());
        }
        let is_nameless = |place: usize| self.setup.contract.is_nameless(place);
        for stored in (0..fields.len()).filter(|place| is_nameless(*place)).filter_map(|place| fields[place].as_ref()) {
            odd.extend((0..rows).filter(|row| !stored.words(*row).is_empty()));
        }
        odd.sort_unstable();
        odd.dedup();
        let mut first = 0;
        for end in odd.into_iter().chain([rows]) {
            for ((column, _), values) in columns.iter().zip(&mut values) {
                let of_block = &mut block.values[column.number];
                if end - first == rows {
                    std::mem::swap(of_block, values);
                } else {
                    of_block.extend_from(values, first..end);
                }
            }
            if let Some(names) = names {
                block.names.extend(names.spans(first..end));
            }
            block.plain_rows(first..end, before);
            if end < rows {
                self.odd(&stored_record(fields, end, before), block);
            }
            if block.contradiction.is_some() {
                return;
            }
            first = end + 1;
        }
    }

    /// Reads a row as a record. One without any cell is a part without values, because cells that are not read may stand there.
    fn odd(&self, record: &Record, block: &mut Block) {
        block.record_count += 1;
        self.part(record, Span::default(), block);
    }
}

/// The deviations of a column's numbers. Rows without one are added to `odd`.
fn deviations(
    column: &PlainColumn,
    stored: &Stored<'_>,
    nothing: DeviationValue,
    odd: &mut Vec<usize>,
) -> DeviationValues {
    if let Some(deviations) = stored.all_doubles().and_then(|doubles| column.numbers.deviations(doubles)) {
        return deviations;
    }
    let mut values = DeviationValues::repeated(nothing, 0);
    stored.numbers(|row, number| {
        let deviation = number.and_then(|number| column.numbers.deviation(number));
        if !deviation.is_some_and(|deviation| values.push(deviation)) {
            values.push_nothing();
            odd.push(row);
        }
    });
    values
}

/// A row of stored columns as a record. The table has `before` rows before these columns.
pub(crate) fn stored_record(fields: &[Option<Stored<'_>>], row: usize, before: u64) -> Record {
    let cell = |field: &Option<Stored<'_>>| field.as_ref().map(|stored| stored.cell(row)).unwrap_or_default();
    Record::new(fields.iter().map(cell).collect(), before + row as u64 + 1)
}
