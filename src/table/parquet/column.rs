//! What the columns of a Parquet file hold. Found from its schema; reads no value.

use std::ops::Range;

use ::parquet::basic::{ConvertedType, LogicalType, Repetition, Type as Physical};
use ::parquet::schema::types::{ColumnDescriptor, SchemaDescriptor, TypePtr};
use chrono::DateTime;

use crate::table::chunk::LONGEST_RECORD;
use crate::table::stored::Stored;

/// A column of a file.
#[derive(Debug, Clone)]
pub(crate) struct StoredColumn {
    /// Its name; the path, if it is a field of a record.
    pub(crate) name: String,
    /// The columns of values that it consists of.
    pub(super) leaves: Range<usize>,
    /// Where its values are, or why they are not read.
    pub(crate) leaf: Result<Leaf, Unread>,
}

/// Why the values of a column are not read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Unread {
    /// Its type: a list, a map, or values that are neither numbers nor texts nor moments.
    Type(String),
    /// Its packing.
    Packing(String),
}

impl StoredColumn {
    /// Whether its values can be read.
    pub(crate) fn is_read(&self) -> bool {
        self.leaf.is_ok()
    }
}

/// Where the values of a column are, and how they are meant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Leaf {
    pub(super) index: usize,
    pub(super) values: Values,
    /// The definition level of a row that has a value.
    pub(super) level: i16,
}

/// How stored values are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Values {
    /// As they are stored.
    PlainNumbers,
    /// Integers without a sign.
    Unsigned,
    /// Integers, of which this many digits are decimals.
    Decimal {
        scale: i32,
    },
    Moment(Moment),
}

impl Values {
    /// What stored integers mean.
    pub(super) fn of_integers(self, stored: Vec<i64>) -> Stored<'static> {
        match self {
            Self::Moment(moment) => Stored::others(stored.into_iter().map(|count| moment.shown(count.into()))),
            Self::Unsigned => Stored::long_integers(stored.into_iter().map(|value| value.cast_unsigned().into()), 0),
            Self::Decimal { scale } => Stored::integers(stored, scale),
            Self::PlainNumbers => Stored::integers(stored, 0),
        }
    }
}

/// A date or a time that is stored as a count since the beginning of 1970 or since midnight: the nanoseconds of one count, and how it is
/// shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Moment {
    nanoseconds: i64,
    format: &'static str,
}

const SECOND: i64 = 1_000_000_000;
const DAY: i64 = 86_400 * SECOND;

impl Moment {
    const DATE: Self = Self { nanoseconds: DAY, format: "%F" };

    const fn time(nanoseconds: i64) -> Self {
        Self { nanoseconds, format: "%T%.f" }
    }

    const fn timestamp(nanoseconds: i64) -> Self {
        Self { nanoseconds, format: "%F %T%.f" }
    }

    /// As a message shows it; the count itself where the calendar ends.
    fn shown(self, count: i128) -> String {
        let second = i128::from(SECOND);
        let nanoseconds = count * i128::from(self.nanoseconds);
        let seconds = i64::try_from(nanoseconds.div_euclid(second)).ok();
        let moment = seconds.and_then(|seconds| {
            DateTime::from_timestamp(seconds, u32::try_from(nanoseconds.rem_euclid(second)).unwrap_or_default())
        });
        moment.map_or_else(|| count.to_string(), |moment| moment.format(self.format).to_string())
    }
}

/// A timestamp of older files: nanoseconds of a day, and the Julian day.
pub(super) fn shown_int96([low, high, day]: [u32; 3]) -> String {
    const EPOCH: i128 = 2_440_588;
    let nanoseconds = (i128::from(high & 0x7fff_ffff) << 32) | i128::from(low);
    Moment::timestamp(1).shown((i128::from(day) - EPOCH) * i128::from(DAY) + nanoseconds)
}

/// Bytes of a fixed length as text, or else in hexadecimal digits.
pub(super) fn shown_bytes(bytes: &[u8]) -> String {
    let text = std::str::from_utf8(bytes).map(|text| text.trim_end_matches('\0'));
    match text.ok().filter(|text| !text.contains(char::is_control)) {
        Some(text) => text.to_owned(),
        None => bytes.iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}")),
    }
}

/// The columns of a file in their order; the fields of a record are called by their path, `rack.pitch`.
pub(super) fn columns(schema: &SchemaDescriptor) -> Vec<StoredColumn> {
    let mut columns = Vec::new();
    for field in schema.root_schema().get_fields() {
        add(field, "", schema, &mut columns);
    }
    columns
}

fn add(field: &TypePtr, path: &str, schema: &SchemaDescriptor, columns: &mut Vec<StoredColumn>) {
    let name = format!("{path}{}", field.name());
    let info = field.get_basic_info();
    if !field.is_primitive() && !is_repeated(field) && info.converted_type() == ConvertedType::NONE {
        let path = format!("{name}.");
        return field.get_fields().iter().for_each(|field| add(field, &path, schema, columns));
    }
    let first = columns.last().map_or(0, |column| column.leaves.end);
    let leaf = || {
        let column = field.is_primitive().then(|| schema.column(first)).filter(|column| column.max_rep_level() == 0)?;
        Some(Leaf { index: first, values: values(&column)?, level: column.max_def_level() })
    };
    let leaf = leaf().ok_or_else(|| Unread::Type(type_in_words(field)));
    columns.push(StoredColumn { name, leaves: first..first + leaves(field), leaf });
}

/// How many columns of values a field has.
fn leaves(field: &TypePtr) -> usize {
    if field.is_primitive() { 1 } else { field.get_fields().iter().map(leaves).sum() }
}

fn is_repeated(field: &TypePtr) -> bool {
    let info = field.get_basic_info();
    info.has_repetition() && info.repetition() == Repetition::REPEATED
}

/// The type of a column that is not read, in words.
fn type_in_words(field: &TypePtr) -> String {
    match field.get_basic_info().converted_type() {
        ConvertedType::LIST => "a list".to_owned(),
        ConvertedType::MAP | ConvertedType::MAP_KEY_VALUE => "a map".to_owned(),
        _ if is_repeated(field) => "a list".to_owned(),
        _ if !field.is_primitive() => "a group".to_owned(),
        ConvertedType::NONE => format!("of type {}", field.get_physical_type()),
        converted => format!("of type {converted}"),
    }
}

/// How the values of a column are meant; `None` if they are not read.
fn values(column: &ColumnDescriptor) -> Option<Values> {
    match column.physical_type() {
        Physical::DOUBLE | Physical::FLOAT | Physical::BOOLEAN | Physical::INT96 => Some(Values::PlainNumbers),
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
        | (ConvertedType::NONE, None | Some(LogicalType::Unknown)) => Some(Values::PlainNumbers),
        (ConvertedType::DATE, _) => moment(Moment::DATE),
        (ConvertedType::TIME_MILLIS, _) => moment(Moment::time(SECOND / 1000)),
        (ConvertedType::TIME_MICROS, _) => moment(Moment::time(1000)),
        (ConvertedType::TIMESTAMP_MILLIS, _) => moment(Moment::timestamp(SECOND / 1000)),
        (ConvertedType::TIMESTAMP_MICROS, _) => moment(Moment::timestamp(1000)),
        // converted types have no nanoseconds, logical types have
        (ConvertedType::NONE, Some(LogicalType::Time(_))) => moment(Moment::time(1)),
        (ConvertedType::NONE, Some(LogicalType::Timestamp(_))) => moment(Moment::timestamp(1)),
        _ => None,
    }
}

fn of_bytes(column: &ColumnDescriptor) -> Option<Values> {
    if usize::try_from(column.type_length()).is_ok_and(|length| length > LONGEST_RECORD) {
        return None;
    }
    match (column.converted_type(), column.logical_type_ref()) {
        (ConvertedType::DECIMAL, _) => Some(Values::Decimal { scale: column.type_scale() }),
        (ConvertedType::UTF8 | ConvertedType::ENUM | ConvertedType::JSON, _)
        | (ConvertedType::NONE, None | Some(LogicalType::Unknown)) => Some(Values::PlainNumbers),
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
            (-719_528, "0000-01-01"),
        ] {
            assert_eq!(Moment::DATE.shown(days), date);
        }
        assert_eq!(Moment::timestamp(1_000_000).shown(-1), "1969-12-31 23:59:59.999");
        assert_eq!(Moment::time(1000).shown(45_296_000_001), "12:34:56.000001");
        assert_eq!(Moment::timestamp(1).shown(1_250_000_000), "1970-01-01 00:00:01.250");
        assert_eq!(Moment::timestamp(1_000_000).shown(2000), "1970-01-01 00:00:02");
        assert_eq!(shown_int96([500_000_000, 0, 2_440_588]), "1970-01-01 00:00:00.500");
        assert_eq!(Moment::timestamp(SECOND).shown(i64::MIN.into()), i64::MIN.to_string());
        assert_eq!(Moment::DATE.shown(i64::MAX.into()), i64::MAX.to_string());
    }

    #[test]
    fn bytes_that_name_something() {
        assert_eq!(shown_bytes(b"P001"), "P001");
        assert_eq!(shown_bytes(b"P1\0\0"), "P1");
        assert_eq!(shown_bytes(&[0xff, 0x01]), "ff01");
    }
}
