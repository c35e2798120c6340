//! Parquet files as columns of numbers and texts.
//!
//! The command line opens a file with [`ParquetTable::of_file`], chooses among its [`columns`](ParquetTable::columns),
//! and [`read`](ParquetTable::read)s those, a batch of rows at a time; no other column is unpacked. Nothing becomes text
//! on the way: a double is its shortest decimal, a `DECIMAL` and an integer are what they are. Nothing here knows what a
//! column means.

mod column;
mod pages;

pub(crate) use column::{Column, ColumnKind};

use std::fs::File;
use std::sync::Arc;

use ::bytes::Bytes;
use ::parquet::basic::Compression;
use ::parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use ::parquet::data_type::{ByteArray, DataType, FixedLenByteArray};
use ::parquet::errors::ParquetError;
use ::parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};

use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::Decimal;
use column::{Leaf, Moment, Values};
use pages::CheckedPages;

/// Rows of a batch at most.
pub(crate) const BATCH_ROWS: usize = 8192;

/// A Parquet file that was opened.
pub(crate) struct ParquetTable {
    name: String,
    /// Bytes of the file.
    length: u64,
    reader: Arc<dyn FileReader>,
    columns: Vec<Column>,
}

/// A number of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Number {
    /// There is none.
    Missing,
    /// A number.
    Finite(Decimal),
    /// NaN, an infinity, or a `DECIMAL` beyond its type: something that is no measured value.
    NotFinite,
}

/// The values of a column in a batch, one per row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ColumnValues {
    /// Numbers.
    Numbers(Vec<Number>),
    /// Texts.
    Texts(Vec<Option<String>>),
    /// Dates, times, true and false, as a message shows them.
    Others(Vec<Option<String>>),
}

/// Some rows, in the file's order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Batch {
    /// The number of the first row, from 1.
    pub(crate) first_row: u64,
    /// How many rows.
    pub(crate) rows: usize,
    /// The columns that were asked for, in that order.
    pub(crate) columns: Vec<ColumnValues>,
}

impl ParquetTable {
    /// Opens a file; `name` is what messages call it.
    ///
    /// # Errors
    /// If it is no Parquet file, or an encrypted one.
    pub(crate) fn of_file(name: &str, file: File) -> Result<Self, Diagnostic> {
        Self::open(name, file)
    }

    /// Opens a file that is in memory.
    ///
    /// # Errors
    /// If it is no Parquet file, or an encrypted one.
    pub(crate) fn of_bytes(name: &str, bytes: Vec<u8>) -> Result<Self, Diagnostic> {
        Self::open(name, Bytes::from(bytes))
    }

    fn open<R: ChunkReader + 'static>(name: &str, source: R) -> Result<Self, Diagnostic> {
        check_marks(name, &source)?;
        let length = source.len();
        let reader = SerializedFileReader::new(source).map_err(|error| unreadable(name, &error))?;
        let columns = column::columns(reader.metadata().file_metadata().schema_descr());
        Ok(Self { name: name.to_owned(), length, reader: Arc::new(reader), columns })
    }

    /// Its columns, in their order.
    pub(crate) fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Reads the columns with these indices, from the first row on.
    ///
    /// # Errors
    /// If one of them cannot be read: for what it holds, or for how it is compressed.
    pub(crate) fn read(&self, wanted: &[usize]) -> Result<Batches, Diagnostic> {
        let mut columns = Vec::new();
        for column in wanted.iter().filter_map(|index| self.columns.get(*index)) {
            let Some(leaf) = &column.leaf else {
                let message =
                    format!("{}, column `{}` cannot be read: it holds {}", self.name, column.name, column.kind);
                return Err(Diagnostic::error(Code::BadTable, message));
            };
            self.check_chunks(&column.name, leaf.index)?;
            columns.push(leaf.clone());
        }
        Ok(Batches {
            name: self.name.clone(),
            reader: Arc::clone(&self.reader),
            columns,
            open: Vec::new(),
            next_group: 0,
            left: 0,
            next_row: 1,
        })
    }

    /// Whether a column's values lie in the file, and are compressed as they may be.
    fn check_chunks(&self, column: &str, leaf: usize) -> Result<(), Diagnostic> {
        for group in self.reader.metadata().row_groups() {
            let chunk = group.column(leaf);
            let start = chunk.dictionary_page_offset().unwrap_or(chunk.data_page_offset());
            let end = start.checked_add(chunk.compressed_size()).and_then(|end| u64::try_from(end).ok());
            let in_file = start >= 0 && chunk.compressed_size() >= 0 && end.is_some_and(|end| end <= self.length);
            if !in_file {
                return Err(unreadable(&self.name, &format!("column `{column}` lies beyond its end")));
            }
            if let Some(problem) = self.refused(column, chunk.compression()) {
                return Err(problem);
            }
        }
        Ok(())
    }

    /// Why a compression is not read; `None` if it is.
    fn refused(&self, column: &str, compression: Compression) -> Option<Diagnostic> {
        let name = match compression {
            Compression::UNCOMPRESSED
            | Compression::SNAPPY
            | Compression::GZIP(_)
            | Compression::LZ4
            | Compression::LZ4_RAW => return None,
            Compression::ZSTD(_) => "ZSTD",
            Compression::BROTLI(_) => "BROTLI",
            Compression::LZO => "LZO",
        };
        let message = format!("cannot read {}: column `{column}` is compressed with {name}", self.name);
        let help = "write the file with SNAPPY, GZIP or LZ4, or without compression";
        Some(Diagnostic::error(Code::FileAccess, message).help(help))
    }
}

/// A file says at both ends what it is.
fn check_marks<R: ChunkReader>(name: &str, source: &R) -> Result<(), Diagnostic> {
    const MARK: usize = 4;
    let end = source.len().saturating_sub(MARK as u64);
    let mark = |at: u64| source.get_bytes(at, MARK).unwrap_or_default();
    match (mark(0).as_ref(), mark(end).as_ref()) {
        (b"PAR1", b"PAR1") => Ok(()),
        (_, b"PARE") => Err(unreadable(name, &"it is encrypted")),
        (b"PAR1", _) => Err(unreadable(name, &"it is a Parquet file whose end is missing")),
        _ => Err(unreadable(name, &"it is no Parquet file")),
    }
}

fn unreadable(name: &str, problem: &dyn std::fmt::Display) -> Diagnostic {
    Diagnostic::error(Code::FileAccess, format!("cannot read {name}: {problem}"))
}

/// The rows of a file, a batch at a time.
pub(crate) struct Batches {
    name: String,
    reader: Arc<dyn FileReader>,
    columns: Vec<Leaf>,
    /// The columns of the group of rows that is read.
    open: Vec<ColumnReader>,
    next_group: usize,
    /// Rows of the group that are not read yet.
    left: usize,
    next_row: u64,
}

impl Iterator for Batches {
    type Item = Result<Batch, Diagnostic>;

    fn next(&mut self) -> Option<Self::Item> {
        let batch = self.batch().transpose()?;
        Some(batch.map_err(|error| {
            // nothing is read behind what cannot be read
            (self.left, self.next_group) = (0, self.reader.num_row_groups());
            unreadable(&self.name, &error)
        }))
    }
}

impl Batches {
    fn batch(&mut self) -> Result<Option<Batch>, ParquetError> {
        while self.left == 0 {
            if self.next_group == self.reader.num_row_groups() {
                return Ok(None);
            }
            let group = self.reader.get_row_group(self.next_group)?;
            let open = |leaf: &Leaf| {
                let column = group.metadata().column(leaf.index).column_descr_ptr();
                let pages = CheckedPages::new(group.get_column_page_reader(leaf.index)?, &column);
                Ok::<_, ParquetError>(get_column_reader(column, Box::new(pages)))
            };
            self.open = self.columns.iter().map(open).collect::<Result<_, _>>()?;
            self.left = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
            self.next_group += 1;
        }
        let rows = self.left.min(BATCH_ROWS);
        let columns = self.open.iter_mut().zip(&self.columns);
        let columns = columns.map(|(reader, leaf)| values(reader, leaf.values, rows)).collect::<Result<_, _>>()?;
        let batch = Batch { first_row: self.next_row, rows, columns };
        self.left -= rows;
        self.next_row += rows as u64;
        Ok(Some(batch))
    }
}

/// The next values of a column.
fn values(reader: &mut ColumnReader, values: Values, rows: usize) -> Result<ColumnValues, ParquetError> {
    match reader {
        ColumnReader::DoubleColumnReader(reader) => numbers(reader, rows, |value| finite(Decimal::of_f64(*value))),
        ColumnReader::FloatColumnReader(reader) => numbers(reader, rows, |value| finite(Decimal::of_f32(*value))),
        ColumnReader::Int32ColumnReader(reader) => match values {
            Values::Moment(moment) => others(reader, rows, |value| moment.shown(i64::from(*value))),
            Values::Unsigned => numbers(reader, rows, |value| whole(i128::from(value.cast_unsigned()), 0)),
            _ => numbers(reader, rows, |value| whole(i128::from(*value), values.scale())),
        },
        ColumnReader::Int64ColumnReader(reader) => match values {
            Values::Moment(moment) => others(reader, rows, |value| moment.shown(*value)),
            Values::Unsigned => numbers(reader, rows, |value| whole(i128::from(value.cast_unsigned()), 0)),
            _ => numbers(reader, rows, |value| whole(i128::from(*value), values.scale())),
        },
        ColumnReader::ByteArrayColumnReader(reader) => match values {
            Values::Decimal { scale } => numbers(reader, rows, |value: &ByteArray| of_bytes(value.data(), scale)),
            _ => read(reader, rows, |value| value.map(text)).map(ColumnValues::Texts),
        },
        ColumnReader::FixedLenByteArrayColumnReader(reader) => {
            numbers(reader, rows, |value: &FixedLenByteArray| of_bytes(value.data(), values.scale()))
        }
        ColumnReader::Int96ColumnReader(reader) => {
            others(reader, rows, |value| Moment::Timestamp { per_second: 1000 }.shown(value.to_millis()))
        }
        ColumnReader::BoolColumnReader(reader) => others(reader, rows, bool::to_string),
    }
}

fn numbers<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: usize,
    number: impl Fn(&T::T) -> Number,
) -> Result<ColumnValues, ParquetError> {
    read(reader, rows, |value| value.map_or(Number::Missing, &number)).map(ColumnValues::Numbers)
}

fn others<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: usize,
    shown: impl Fn(&T::T) -> String,
) -> Result<ColumnValues, ParquetError> {
    read(reader, rows, |value| value.map(&shown)).map(ColumnValues::Others)
}

/// The next `rows` values, each made of what the file has or of `None`.
fn read<T: DataType, C>(
    reader: &mut ColumnReaderImpl<T>,
    rows: usize,
    make: impl Fn(Option<&T::T>) -> C,
) -> Result<Vec<C>, ParquetError> {
    let (mut levels, mut values) = (Vec::new(), Vec::with_capacity(rows));
    let (found, ..) = reader.read_records(rows, Some(&mut levels), None, &mut values)?;
    if found != rows {
        return Err(ParquetError::EOF(format!("a column ends {} rows before the others", rows - found)));
    }
    // a column that has a value in each row has no levels
    if levels.is_empty() {
        return Ok(values.iter().map(|value| make(Some(value))).collect());
    }
    let mut values = values.iter();
    Ok(levels.iter().map(|level| make(if *level == 0 { None } else { values.next() })).collect())
}

fn finite(number: Option<Decimal>) -> Number {
    number.map_or(Number::NotFinite, Number::Finite)
}

fn whole(unscaled: i128, scale: i32) -> Number {
    Number::Finite(Decimal::of_i128(unscaled, scale))
}

/// A `DECIMAL` from its two's complement, the highest byte first.
fn of_bytes(bytes: &[u8], scale: i32) -> Number {
    let negative = bytes.first().is_some_and(|byte| byte & 0x80 != 0);
    let start = if negative { -1i128 } else { 0 };
    let unscaled = bytes.iter().try_fold(start, |sum, byte| sum.checked_mul(256)?.checked_add(i128::from(*byte)));
    unscaled.map_or(Number::NotFinite, |unscaled| whole(unscaled, scale))
}

fn text(bytes: &ByteArray) -> String {
    String::from_utf8_lossy(bytes.data()).into_owned()
}

#[cfg(test)]
mod tests;
