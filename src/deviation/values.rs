//! The values of a column: all of one dimension, which is checked once for a column.

use std::ops::Range;

use super::DeviationValue;
use crate::quantity::{Angle, Length};

/// Values of one dimension, in the order of their rows.
#[derive(Debug, Clone, PartialEq)]
pub enum DeviationValues {
    /// Deviations in length.
    Lengths(Vec<Length>),
    /// Deviations in angle.
    Angles(Vec<Angle>),
    /// Tangents of deviations in angle.
    Slopes(Vec<f64>),
}

/// Applies one expression to the values of each dimension.
macro_rules! of_each {
    ($all:expr, $values:ident => $result:expr) => {
        match $all {
            Self::Lengths($values) => $result,
            Self::Angles($values) => $result,
            Self::Slopes($values) => $result,
        }
    };
}

impl Default for DeviationValues {
    /// No lengths.
    fn default() -> Self {
        Self::Lengths(Vec::new())
    }
}

impl DeviationValues {
    /// One value, repeated.
    #[must_use]
    pub fn repeated(value: DeviationValue, count: usize) -> Self {
        match value {
            DeviationValue::Length(length) => Self::Lengths(vec![length; count]),
            DeviationValue::Angle(angle) => Self::Angles(vec![angle; count]),
            DeviationValue::Slope(slope) => Self::Slopes(vec![slope; count]),
        }
    }

    /// An empty column of that dimension, with room for so many values.
    #[cfg(feature = "table")]
    pub(crate) fn with_room(like: DeviationValue, count: usize) -> Self {
        match like {
            DeviationValue::Length(_) => Self::Lengths(Vec::with_capacity(count)),
            DeviationValue::Angle(_) => Self::Angles(Vec::with_capacity(count)),
            DeviationValue::Slope(_) => Self::Slopes(Vec::with_capacity(count)),
        }
    }

    /// The number of values.
    #[must_use]
    pub fn len(&self) -> usize {
        of_each!(self, values => values.len())
    }

    /// Whether there are no values.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of a row, of which there must be one.
    #[inline]
    pub(crate) fn at(&self, row: usize) -> DeviationValue {
        match self {
            Self::Lengths(values) => DeviationValue::Length(values[row]),
            Self::Angles(values) => DeviationValue::Angle(values[row]),
            Self::Slopes(values) => DeviationValue::Slope(values[row]),
        }
    }

    /// The value of a row; `None` behind the last.
    #[must_use]
    pub fn get(&self, row: usize) -> Option<DeviationValue> {
        (row < self.len()).then(|| self.at(row))
    }

    /// Calls `take` with each value.
    #[inline]
    pub fn for_each(&self, take: impl FnMut(DeviationValue)) {
        match self {
            Self::Lengths(values) => values.iter().copied().map(DeviationValue::Length).for_each(take),
            Self::Angles(values) => values.iter().copied().map(DeviationValue::Angle).for_each(take),
            Self::Slopes(values) => values.iter().copied().map(DeviationValue::Slope).for_each(take),
        }
    }

    /// The least and the greatest value; `None` without values.
    pub(crate) fn ends(&self) -> Option<[DeviationValue; 2]> {
        Some(match self {
            Self::Lengths(lengths) => ends(lengths)?.map(DeviationValue::Length),
            Self::Angles(angles) => ends(angles)?.map(DeviationValue::Angle),
            Self::Slopes(slopes) => ends(slopes)?.map(DeviationValue::Slope),
        })
    }

    /// Appends a value, unless it has another dimension; returns whether it was appended.
    #[inline]
    pub(crate) fn push(&mut self, value: DeviationValue) -> bool {
        match (self, value) {
            (Self::Lengths(values), DeviationValue::Length(length)) => values.push(length),
            (Self::Angles(values), DeviationValue::Angle(angle)) => values.push(angle),
            (Self::Slopes(values), DeviationValue::Slope(slope)) => values.push(slope),
            _ => return false,
        }
        true
    }

    /// Appends a 0, for a row without a value.
    pub(crate) fn push_nothing(&mut self) {
        of_each!(self, values => values.resize_with(values.len() + 1, Default::default));
    }

    /// Keeps only the first values.
    pub(crate) fn truncate(&mut self, count: usize) {
        of_each!(self, values => values.truncate(count));
    }

    /// Appends some of another column of the same dimension.
    pub(crate) fn extend_from(&mut self, other: &Self, rows: Range<usize>) {
        match (self, other) {
            (Self::Lengths(values), Self::Lengths(more)) => values.extend_from_slice(&more[rows]),
            (Self::Angles(values), Self::Angles(more)) => values.extend_from_slice(&more[rows]),
            (Self::Slopes(values), Self::Slopes(more)) => values.extend_from_slice(&more[rows]),
            (values, _) => {
                debug_assert!(false, "a column has one dimension");
                rows.for_each(|_| values.push_nothing());
            }
        }
    }
}

/// The least and the greatest value.
fn ends<T: PartialOrd + Copy>(values: &[T]) -> Option<[T; 2]> {
    let first = *values.first()?;
    let wider = |[least, most]: [T; 2], value: &T| {
        [if *value < least { *value } else { least }, if *value > most { *value } else { most }]
    };
    Some(values.iter().fold([first; 2], wider))
}
