//! A column as a file or a program stores it: numbers as numbers, texts as texts, and which rows have a value. Its meaning is
//! found as that of any other column. Made by the reader of Parquet files and by programs that have columns.

use std::borrow::Cow;
use std::ops::Range;

use super::block::{Span, span_end};
use super::cell::{Cell, Content};
use crate::quantity::Decimal;

/// The values of a column in some rows.
#[derive(Debug, Clone)]
pub struct Stored<'a> {
    values: Values<'a>,
    /// Whether each row has a value; `None` if all do.
    has_value: Option<Cow<'a, [bool]>>,
}

#[derive(Debug, Clone)]
enum Values<'a> {
    Doubles(Cow<'a, [f64]>),
    Integers {
        unscaled: Cow<'a, [i64]>,
        scale: i32,
    },
    /// One text behind the other.
    Texts {
        bytes: Cow<'a, [u8]>,
        /// Where the first begins and where each ends.
        ends: Vec<usize>,
    },
    /// Everything else, cell by cell.
    Contents(Cow<'a, [Content]>),
}

impl<'a> Stored<'a> {
    fn of(values: Values<'a>) -> Self {
        Self { values, has_value: None }
    }

    /// Doubles, each of which means its shortest decimal: `25.0131` is 25.0131.
    #[must_use]
    pub fn doubles(values: impl Into<Cow<'a, [f64]>>) -> Self {
        Self::of(Values::Doubles(values.into()))
    }

    /// Single-precision numbers, each of which means its shortest decimal.
    #[must_use]
    pub fn singles(values: &[f32]) -> Self {
        Self::contents(values.iter().map(|value| number(Decimal::of_f32(*value))).collect())
    }

    /// Integers of which the last `scale` digits are decimals.
    #[must_use]
    pub fn integers(unscaled: impl Into<Cow<'a, [i64]>>, scale: i32) -> Self {
        Self::of(Values::Integers { unscaled: unscaled.into(), scale })
    }

    /// Long integers of which the last `scale` digits are decimals.
    #[must_use]
    pub fn long_integers(unscaled: impl IntoIterator<Item = i128>, scale: i32) -> Self {
        let content = |unscaled| Content::Number(Decimal::of_i128(unscaled, scale));
        Self::contents(unscaled.into_iter().map(content).collect())
    }

    /// Texts in UTF-8, one behind the other in `bytes`: `ends` says where the first begins and where each ends.
    #[must_use]
    pub fn texts(bytes: impl Into<Cow<'a, [u8]>>, ends: Vec<usize>) -> Self {
        Self::of(Values::Texts { bytes: bytes.into(), ends })
    }

    /// Dates, times and truth values, as a message shows them. They are no measured values.
    #[must_use]
    pub fn others(shown: impl IntoIterator<Item = String>) -> Self {
        Self::contents(shown.into_iter().map(|shown| Content::Other(shown.into())).collect())
    }

    pub(crate) fn contents(contents: Vec<Content>) -> Self {
        Self::of(Values::Contents(contents.into()))
    }

    /// The same column, with a value in those rows only.
    #[must_use]
    pub fn with_values_where(self, has_value: impl Into<Cow<'a, [bool]>>) -> Self {
        Self { has_value: Some(has_value.into()), ..self }
    }

    /// Puts the values into the rows that have one, in order.
    pub(crate) fn spread(self, has_value: Vec<bool>) -> Self {
        let values = match self.values {
            Values::Doubles(values) => Values::Doubles(spread(&values, &has_value).into()),
            Values::Integers { unscaled, scale } => {
                Values::Integers { unscaled: spread(&unscaled, &has_value).into(), scale }
            }
            Values::Texts { bytes, ends } => {
                let mut present = ends.into_iter();
                let mut end = present.next().unwrap_or(0);
                let start = std::iter::once(end);
                let of_row = has_value.iter().map(|has_value| {
                    end = if *has_value { present.next().unwrap_or(end) } else { end };
                    end
                });
                Values::Texts { bytes, ends: start.chain(of_row).collect() }
            }
            Values::Contents(contents) => Values::Contents(spread(&contents, &has_value).into()),
        };
        Self { values, has_value: Some(has_value.into()) }
    }

    /// How many rows there are.
    #[must_use]
    pub fn rows(&self) -> usize {
        match &self.values {
            Values::Doubles(values) => values.len(),
            Values::Integers { unscaled, .. } => unscaled.len(),
            Values::Texts { ends, .. } => ends.len().saturating_sub(1),
            Values::Contents(contents) => contents.len(),
        }
    }

    /// Some of the rows, which are not copied.
    pub(crate) fn slice(&self, rows: Range<usize>) -> Stored<'_> {
        let values = match &self.values {
            Values::Doubles(values) => Values::Doubles(values[rows.clone()].into()),
            Values::Integers { unscaled, scale } => {
                Values::Integers { unscaled: unscaled[rows.clone()].into(), scale: *scale }
            }
            Values::Texts { bytes, ends } => {
                let ends = &ends[rows.start..=rows.end];
                let bytes = &bytes[ends[0]..ends[rows.len()]];
                Values::Texts { bytes: bytes.into(), ends: ends.iter().map(|end| end - ends[0]).collect() }
            }
            Values::Contents(contents) => Values::Contents(contents[rows.clone()].into()),
        };
        Stored { values, has_value: self.has_value.as_ref().map(|has_value| has_value[rows].into()) }
    }

    /// Whether it is a column of texts.
    pub(crate) fn is_text(&self) -> bool {
        matches!(self.values, Values::Texts { .. })
    }

    /// Whether a row holds a number, or a text that may be one.
    pub(crate) fn has_numbers(&self) -> bool {
        (0..self.rows()).any(|row| self.cell(row).is_number())
    }

    /// A made-up row of the same type.
    pub(crate) fn stand_in(&self) -> Stored<'static> {
        match &self.values {
            Values::Texts { .. } => Stored::texts(b"x".to_vec(), vec![0, 1]),
            _ => Stored::doubles(vec![0.0]),
        }
    }

    fn has_value(&self, row: usize) -> bool {
        self.has_value.as_ref().is_none_or(|has_value| has_value.get(row) == Some(&true))
    }

    /// What a row holds.
    fn content(&self, row: usize) -> Content {
        if !self.has_value(row) {
            return Content::Empty;
        }
        match &self.values {
            Values::Doubles(values) => number(Decimal::of_f64(values[row])),
            Values::Integers { unscaled, scale } => {
                Content::Number(Decimal::of_i128(i128::from(unscaled[row]), *scale))
            }
            Values::Texts { bytes, ends } => {
                Content::of_text(&String::from_utf8_lossy(&bytes[ends[row]..ends[row + 1]]))
            }
            Values::Contents(contents) => contents[row].clone(),
        }
    }

    pub(crate) fn cell(&self, row: usize) -> Cell {
        Cell::from(self.content(row))
    }

    /// Calls `take` for each row with its number, if it has one.
    #[inline]
    pub(crate) fn numbers(&self, mut take: impl FnMut(usize, Option<Decimal>)) {
        let mut each = |row: usize, number: Option<Decimal>| take(row, number.filter(|_| self.has_value(row)));
        match &self.values {
            Values::Doubles(values) => {
                values.iter().enumerate().for_each(|(row, value)| each(row, Decimal::of_double(*value)));
            }
            Values::Integers { unscaled, scale } => {
                unscaled.iter().enumerate().for_each(|(row, value)| each(row, Some(Decimal::of_i64(*value, *scale))));
            }
            Values::Texts { .. } => (0..self.rows()).for_each(|row| each(row, None)),
            Values::Contents(contents) => {
                for (row, content) in contents.iter().enumerate() {
                    each(row, if let Content::Number(number) = content { Some(*number) } else { None });
                }
            }
        }
    }

    /// The doubles, if every row has one.
    pub(crate) fn all_doubles(&self) -> Option<&[f64]> {
        match (&self.values, &self.has_value) {
            (Values::Doubles(values), None) => Some(values),
            _ => None,
        }
    }

    /// All texts, one behind the other.
    pub(crate) fn all_text(&self) -> &[u8] {
        if let Values::Texts { bytes, .. } = &self.values { bytes } else { &[] }
    }

    /// Where the texts of some rows stand in [`Self::all_text`].
    pub(crate) fn spans(&self, rows: Range<usize>) -> impl Iterator<Item = Span> {
        let ends = if let Values::Texts { ends, .. } = &self.values { &ends[rows.start..=rows.end] } else { &[] };
        ends.windows(2).map(|ends| Span { start: span_end(ends[0]), end: span_end(ends[1]) })
    }

    /// What a row holds, as text.
    pub(crate) fn words(&self, row: usize) -> Cow<'_, [u8]> {
        match self.text(row) {
            Some(text) => text.into(),
            None if self.has_value(row) => self.content(row).to_string().into_bytes().into(),
            None => Cow::default(),
        }
    }

    /// The bytes of a text, if that is what the column holds.
    pub(crate) fn text(&self, row: usize) -> Option<&[u8]> {
        match &self.values {
            Values::Texts { bytes, ends } if self.has_value(row) => Some(&bytes[ends[row]..ends[row + 1]]),
            _ => None,
        }
    }
}

/// Puts values into the rows that have one; the other rows get a default.
fn spread<T: Clone + Default>(values: &[T], has_value: &[bool]) -> Vec<T> {
    let mut present = values.iter().cloned();
    let value = |has_value: &bool| if *has_value { present.next() } else { None };
    has_value.iter().map(value).map(Option::unwrap_or_default).collect()
}

/// A number. NaN, an infinity and a `DECIMAL` beyond its type are no measured values.
pub(crate) fn number(number: Option<Decimal>) -> Content {
    number.map_or_else(|| Content::Other("no finite number".into()), Content::Number)
}
