//! What the columns of a Parquet file hold. Found from its schema; reads no value.

use ::parquet::basic::{ConvertedType, LogicalType, Type as Physical};
use ::parquet::schema::types::{ColumnDescriptor, SchemaDescriptor, TypePtr};

use crate::quantity::Decimal;
use crate::table::cell::Content;

/// A column of a file.
#[derive(Debug, Clone)]
pub(crate) struct StoredColumn {
    /// Its name.
    pub(crate) name: String,
    /// Where its values are; `None` of lists, maps and records, and of values of a type that is not read:
    /// half-precision and very long numbers, bytes.
    pub(super) leaf: Option<Leaf>,
}

impl StoredColumn {
    /// Whether its values can be read.
    pub(crate) fn is_read(&self) -> bool {
        self.leaf.is_some()
    }
}

/// Where the values of a column are, and how they are meant.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    pub(super) index: usize,
    pub(super) values: Values,
}

/// How stored values are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Values {
    /// As they are stored.
    Plain,
    /// Integers without a sign.
    Unsigned,
    /// Integers, of which this many digits are decimals.
    Decimal {
        scale: i32,
    },
    Moment(Moment),
}

impl Values {
    /// How many digits of a stored integer are decimals.
    pub(super) fn scale(self) -> i32 {
        if let Self::Decimal { scale } = self { scale } else { 0 }
    }

    /// What a stored integer means, which is given with a sign and without.
    pub(super) fn content(self, signed: i64, unsigned: u64) -> Content {
        match self {
            Self::Moment(moment) => Content::Other(moment.shown(signed)),
            Self::Unsigned => Content::Number(Decimal::of_i128(i128::from(unsigned), 0)),
            _ => Content::Number(Decimal::of_i128(i128::from(signed), self.scale())),
        }
    }
}

/// A date or a time as a count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Moment {
    /// Days since the beginning of 1970.
    Date,
    /// Since midnight.
    Time { per_second: i64 },
    /// Since the beginning of 1970.
    Timestamp { per_second: i64 },
}

impl Moment {
    /// As a message shows it.
    pub(super) fn shown(self, count: i64) -> String {
        const DAY: i64 = 86_400;
        let clock = |seconds: i64| {
            let seconds = seconds.rem_euclid(DAY);
            format!("{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
        };
        match self {
            Self::Date => shown_day(count),
            Self::Time { per_second } => clock(count.div_euclid(per_second)),
            Self::Timestamp { per_second } => {
                let seconds = count.div_euclid(per_second);
                format!("{} {}", shown_day(seconds.div_euclid(DAY)), clock(seconds))
            }
        }
    }
}

/// Year, month and day, of days since the beginning of 1970.
fn shown_day(days: i64) -> String {
    /// The calendar repeats itself.
    const CYCLE_YEARS: i64 = 400;
    const CYCLE_DAYS: i64 = 146_097;
    let leap = |year: i64| year % 4 == 0 && (year % 100 != 0 || year % CYCLE_YEARS == 0);
    let mut day = days.rem_euclid(CYCLE_DAYS);
    let mut year = 1970;
    while day >= 365 + i64::from(leap(year)) {
        day -= 365 + i64::from(leap(year));
        year += 1;
    }
    let february = 28 + i64::from(leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if day < length {
            break;
        }
        day -= length;
        month += 1;
    }
    format!("{}-{month:02}-{:02}", year + days.div_euclid(CYCLE_DAYS) * CYCLE_YEARS, day + 1)
}

/// The columns of a file in their order; one that is nested is one column.
pub(super) fn columns(schema: &SchemaDescriptor) -> Vec<StoredColumn> {
    let column = |(root, field): (usize, &TypePtr)| {
        let first = (0..schema.num_columns()).find(|leaf| schema.get_column_root_idx(*leaf) == root);
        let index = first.filter(|index| field.is_primitive() && schema.column(*index).max_rep_level() == 0);
        let leaf = index.and_then(|index| Some(Leaf { index, values: values(&schema.column(index))? }));
        StoredColumn { name: field.name().to_owned(), leaf }
    };
    schema.root_schema().get_fields().iter().enumerate().map(column).collect()
}

/// How the values of a column are meant; `None` if they are not read.
fn values(column: &ColumnDescriptor) -> Option<Values> {
    match column.physical_type() {
        Physical::DOUBLE | Physical::FLOAT | Physical::BOOLEAN | Physical::INT96 => Some(Values::Plain),
        Physical::INT32 | Physical::INT64 => of_integers(column),
        Physical::BYTE_ARRAY | Physical::FIXED_LEN_BYTE_ARRAY => of_bytes(column),
    }
}

fn of_integers(column: &ColumnDescriptor) -> Option<Values> {
    let moment = |moment| Some(Values::Moment(moment));
    match (column.converted_type(), column.logical_type_ref()) {
        (ConvertedType::DECIMAL, _) => Some(Values::Decimal { scale: column.type_scale() }),
        (ConvertedType::UINT_8 | ConvertedType::UINT_16 | ConvertedType::UINT_32 | ConvertedType::UINT_64, _) => {
            Some(Values::Unsigned)
        }
        (ConvertedType::INT_8 | ConvertedType::INT_16 | ConvertedType::INT_32 | ConvertedType::INT_64, _)
        | (ConvertedType::NONE, None | Some(LogicalType::Unknown)) => Some(Values::Plain),
        (ConvertedType::DATE, _) => moment(Moment::Date),
        (ConvertedType::TIME_MILLIS, _) => moment(Moment::Time { per_second: 1000 }),
        (ConvertedType::TIME_MICROS, _) => moment(Moment::Time { per_second: 1_000_000 }),
        (ConvertedType::TIMESTAMP_MILLIS, _) => moment(Moment::Timestamp { per_second: 1000 }),
        (ConvertedType::TIMESTAMP_MICROS, _) => moment(Moment::Timestamp { per_second: 1_000_000 }),
        // nanoseconds are younger than converted types
        (ConvertedType::NONE, Some(LogicalType::Time(_))) => moment(Moment::Time { per_second: 1_000_000_000 }),
        (ConvertedType::NONE, Some(LogicalType::Timestamp(_))) => {
            moment(Moment::Timestamp { per_second: 1_000_000_000 })
        }
        _ => None,
    }
}

fn of_bytes(column: &ColumnDescriptor) -> Option<Values> {
    /// Digits of a number that fits an `i128`.
    const MOST_DIGITS: i32 = 38;
    let has_any_length = column.physical_type() == Physical::BYTE_ARRAY;
    match (column.converted_type(), column.logical_type_ref()) {
        (ConvertedType::DECIMAL, _) => {
            let fits = column.type_precision() <= MOST_DIGITS;
            fits.then_some(Values::Decimal { scale: column.type_scale() })
        }
        (ConvertedType::UTF8 | ConvertedType::ENUM | ConvertedType::JSON, _)
        | (ConvertedType::NONE, None | Some(LogicalType::Unknown)) => has_any_length.then_some(Values::Plain),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_shown_as_dates() {
        for (days, date) in [
            (0, "1970-01-01"),
            (-1, "1969-12-31"),
            (59, "1970-03-01"),
            (11_016, "2000-02-29"),
            (20_453, "2025-12-31"),
            (47_541, "2100-03-01"),
            (-719_528, "0-01-01"),
        ] {
            assert_eq!(Moment::Date.shown(days), date);
        }
        assert_eq!(Moment::Timestamp { per_second: 1000 }.shown(-1), "1969-12-31 23:59:59");
        assert_eq!(Moment::Time { per_second: 1_000_000 }.shown(45_296_000_001), "12:34:56");
        assert!(!Moment::Timestamp { per_second: 1 }.shown(i64::MIN).is_empty());
        assert!(!Moment::Date.shown(i64::MAX).is_empty());
    }
}
