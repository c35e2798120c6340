//! Results as columns, for Parquet files and for programs that work with columns. The evaluator fills them; they know no
//! format.

use std::borrow::Cow;

use super::number::Decimals;
use crate::quantity::Length;

/// The kind of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ColumnKind {
    /// Text.
    Text,
    /// Numbers.
    Number,
    /// `true` or `false`.
    Flag,
}

/// One cell of the results.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ResultCell<'a> {
    /// There is no result.
    Nothing,
    /// A length.
    Length(Length),
    /// A number that lies on no grid: an uncertainty in mm, a probability.
    Number(f64),
    /// Whether something holds.
    Flag(bool),
    /// Text in UTF-8, whatever a file has there.
    Text(Cow<'a, [u8]>),
}

/// The results of some rows, a column for each output of the plan.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ResultColumns {
    /// The columns.
    pub columns: Vec<ResultColumn>,
    /// How many rows there are.
    pub rows: usize,
}

/// A column of results.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultColumn {
    /// Whether each row has a value; `None` if all do.
    pub has_value: Option<Vec<bool>>,
    /// The values by row, with anything where there is none.
    pub values: ResultValues,
}

/// The values of a column of results.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ResultValues {
    /// Texts in UTF-8, one behind the other.
    Texts {
        /// The texts.
        bytes: Vec<u8>,
        /// Where the first text begins and where each ends, as Arrow has them.
        ends: Vec<i32>,
    },
    /// Numbers.
    Numbers(Vec<f64>),
    /// Flags.
    Flags(Vec<bool>),
}

impl ResultColumns {
    /// Empty columns of these kinds, with room for so many rows.
    pub(super) fn new(kinds: impl IntoIterator<Item = ColumnKind>, room: usize) -> Self {
        Self::default().emptied(kinds, room)
    }

    /// Empty columns of these kinds with room for so many rows, in the memory of these where they fit.
    pub(super) fn emptied(self, kinds: impl IntoIterator<Item = ColumnKind>, room: usize) -> Self {
        let mut spare = self.columns.into_iter().map(|column| column.values);
        let texts = |bytes: Vec<u8>, ends: Vec<i32>| {
            let mut ends = emptied(ends, room + 1);
            ends.push(0);
            ResultValues::Texts { bytes: emptied(bytes, room * SHORT), ends }
        };
        let values = |kind| match (kind, spare.next()) {
            (ColumnKind::Text, Some(ResultValues::Texts { bytes, ends })) => texts(bytes, ends),
            (ColumnKind::Text, _) => texts(Vec::new(), Vec::new()),
            (ColumnKind::Number, Some(ResultValues::Numbers(values))) => ResultValues::Numbers(emptied(values, room)),
            (ColumnKind::Number, _) => ResultValues::Numbers(Vec::with_capacity(room)),
            (ColumnKind::Flag, _) => ResultValues::Flags(Vec::with_capacity(room)),
        };
        let columns = kinds.into_iter().map(values).map(|values| ResultColumn { has_value: None, values });
        Self { columns: columns.collect(), rows: 0 }
    }

    /// How many bytes of memory the values take.
    pub(super) fn room_bytes(&self) -> usize {
        let of_column = |column: &ResultColumn| match &column.values {
            ResultValues::Texts { bytes, ends } => bytes.capacity() + ends.capacity() * size_of::<i32>(),
            ResultValues::Numbers(values) => values.capacity() * size_of::<f64>(),
            ResultValues::Flags(values) => values.capacity(),
        };
        self.columns.iter().map(of_column).sum()
    }

    /// Adds a row.
    #[inline]
    pub(super) fn push<'a>(&mut self, cells: impl Iterator<Item = ResultCell<'a>>, decimals: Decimals) {
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            column.push(&cell, decimals);
        }
        self.rows += 1;
    }

    /// Appends rows of the same columns, or of any if there are none yet.
    pub fn append(&mut self, more: Self) {
        if self.rows == 0 {
            *self = more;
            return;
        }
        self.rows += more.rows;
        for (column, more) in self.columns.iter_mut().zip(more.columns) {
            if column.has_value.is_some() || more.has_value.is_some() {
                let which =
                    |column: &ResultColumn| column.has_value.clone().unwrap_or_else(|| vec![true; column.rows()]);
                column.has_value = Some([which(column), which(&more)].concat());
            }
            match (&mut column.values, more.values) {
                (ResultValues::Numbers(all), ResultValues::Numbers(mut more)) => all.append(&mut more),
                (ResultValues::Flags(all), ResultValues::Flags(mut more)) => all.append(&mut more),
                (ResultValues::Texts { bytes, ends }, ResultValues::Texts { bytes: mut more, ends: more_ends }) => {
                    let start = end_of(bytes.len());
                    bytes.append(&mut more);
                    ends.extend(more_ends.into_iter().skip(1).map(|end| start + end));
                }
                _ => {}
            }
        }
    }
}

impl ResultColumn {
    /// How many rows there are.
    #[must_use]
    pub fn rows(&self) -> usize {
        match &self.values {
            ResultValues::Texts { ends, .. } => ends.len().saturating_sub(1),
            ResultValues::Numbers(values) => values.len(),
            ResultValues::Flags(values) => values.len(),
        }
    }

    /// Whether a row has a value.
    #[must_use]
    pub fn has_value(&self, row: usize) -> bool {
        self.has_value.as_ref().is_none_or(|has_value| has_value.get(row) == Some(&true))
    }

    /// The text of a row, if that is what the column holds.
    #[must_use]
    pub fn text(&self, row: usize) -> Option<&[u8]> {
        let ResultValues::Texts { bytes, ends } = &self.values else { return None };
        let [start, end] = [row, row + 1].map(|at| usize::try_from(*ends.get(at)?).ok());
        bytes.get(start?..end?).filter(|_| self.has_value(row))
    }

    /// The bytes of all texts.
    pub(super) fn text_bytes(&self) -> usize {
        if let ResultValues::Texts { bytes, .. } = &self.values { bytes.len() } else { 0 }
    }

    /// Says of some rows, before their values are added, whether each has one.
    #[inline]
    fn begin(&mut self, rows: usize, has_value: bool) {
        if !has_value && self.has_value.is_none() {
            self.has_value = Some(vec![true; self.rows()]);
        }
        if let Some(all) = &mut self.has_value {
            all.resize(all.len() + rows, has_value);
        }
    }

    /// Adds rows of a column of numbers.
    pub(super) fn extend(&mut self, lengths: &[Length], decimals: Decimals) {
        self.begin(lengths.len(), true);
        if let ResultValues::Numbers(values) = &mut self.values {
            decimals.extend(values, lengths);
        }
    }

    /// Adds rows of a column of numbers, none of which has a value.
    pub(super) fn extend_without(&mut self, rows: usize) {
        self.begin(rows, false);
        if let ResultValues::Numbers(values) = &mut self.values {
            values.resize(values.len() + rows, 0.0);
        }
    }

    /// Adds rows with the texts that are appended.
    #[inline]
    pub(super) fn extend_texts<R>(&mut self, rows: impl ExactSizeIterator<Item = R>, append: impl Fn(R, &mut Vec<u8>)) {
        self.begin(rows.len(), true);
        if let ResultValues::Texts { bytes, ends } = &mut self.values {
            ends.extend(rows.map(|row| {
                append(row, bytes);
                end_of(bytes.len())
            }));
        }
    }

    /// Adds so many rows with the same words, if there are any.
    pub(super) fn extend_words(&mut self, words: Option<&str>, rows: usize) {
        self.begin(rows, words.is_some());
        if let ResultValues::Texts { bytes, ends } = &mut self.values {
            let (start, words) = (bytes.len(), words.unwrap_or_default().as_bytes());
            bytes.extend_from_slice(&words.repeat(rows));
            ends.extend((1..=rows).map(|row| end_of(start + row * words.len())));
        }
    }

    /// Adds a row; numbers have the values that are written with these decimals.
    #[inline]
    pub(super) fn push(&mut self, cell: &ResultCell<'_>, decimals: Decimals) {
        self.begin(1, *cell != ResultCell::Nothing);
        match &mut self.values {
            ResultValues::Numbers(values) => values.push(match cell {
                ResultCell::Length(length) => decimals.value(*length),
                ResultCell::Number(number) => decimals.text(*number).parse().unwrap_or(*number),
                _ => 0.0,
            }),
            ResultValues::Flags(values) => values.push(*cell == ResultCell::Flag(true)),
            ResultValues::Texts { bytes, ends } => {
                if let ResultCell::Text(text) = cell {
                    append_text(bytes, text);
                }
                ends.push(end_of(bytes.len()));
            }
        }
    }
}

/// Bytes of a short text, such as a name or a verdict.
const SHORT: usize = 8;

/// The same memory without values, with room for so many.
fn emptied<T>(mut values: Vec<T>, room: usize) -> Vec<T> {
    values.clear();
    values.reserve(room);
    values
}

/// Where texts of so many bytes end. Whoever gathers more than [`i32::MAX`] bytes of them refuses them.
#[inline]
fn end_of(bytes: usize) -> i32 {
    bytes as i32
}

/// Appends a text as UTF-8.
#[inline]
pub(super) fn append_text(bytes: &mut Vec<u8>, text: &[u8]) {
    if text.is_ascii() {
        bytes.extend_from_slice(text);
    } else {
        bytes.extend_from_slice(String::from_utf8_lossy(text).as_bytes());
    }
}
