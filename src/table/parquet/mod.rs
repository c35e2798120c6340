//! Parquet files as records of typed cells.
//!
//! A file is opened with [`ParquetTable::open`], and [`batches`](ParquetTable::batches) reads the columns that can be
//! read, some rows at a time. Nothing becomes text on the way: a double is its shortest decimal, a `DECIMAL` and an
//! integer are what they are. Nothing here knows what a column means.

mod column;
mod pages;

use std::sync::Arc;

use ::parquet::basic::Compression;
use ::parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use ::parquet::data_type::DataType;
use ::parquet::errors::ParquetError;
use ::parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};

use super::cell::{Cell, Content, Record};
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::Decimal;
use column::{Leaf, Moment, StoredColumn, Values};
use pages::CheckedPages;

/// Rows of a batch at most.
const BATCH_ROWS: usize = 8192;

/// A Parquet file that was opened.
pub(crate) struct ParquetTable {
    name: String,
    /// Bytes of the file.
    length: u64,
    reader: Arc<dyn FileReader>,
    columns: Vec<StoredColumn>,
}

impl ParquetTable {
    /// Opens a file, on a disk or in memory; `name` is what messages call it.
    ///
    /// # Errors
    /// If it is no Parquet file, or an encrypted one.
    pub(crate) fn open<R: ChunkReader + 'static>(name: &str, source: R) -> Result<Self, Diagnostic> {
        check_marks(name, &source)?;
        let length = source.len();
        let reader = SerializedFileReader::new(source).map_err(|error| Diagnostic::unreadable(name, &error))?;
        let columns = column::columns(reader.metadata().file_metadata().schema_descr());
        Ok(Self { name: name.to_owned(), length, reader: Arc::new(reader), columns })
    }

    /// Its columns, in their order.
    pub(crate) fn columns(&self) -> &[StoredColumn] {
        &self.columns
    }

    /// Reads the columns that can be read, from the first row on.
    ///
    /// # Errors
    /// If one of them lies beyond the file's end, or is compressed in a way that is not read.
    pub(crate) fn batches(&self) -> Result<Batches, Diagnostic> {
        let mut columns = Vec::new();
        for column in &self.columns {
            if let Some(leaf) = column.leaf {
                self.check_chunks(&column.name, leaf.index)?;
                columns.push(leaf);
            }
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
                return Err(Diagnostic::unreadable(&self.name, &format!("column `{column}` lies beyond its end")));
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
        (_, b"PARE") => Err(Diagnostic::unreadable(name, &"it is encrypted")),
        (b"PAR1", _) => Err(Diagnostic::unreadable(name, &"it is a Parquet file whose end is missing")),
        _ => Err(Diagnostic::unreadable(name, &"it is no Parquet file")),
    }
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
    type Item = Result<Vec<Record>, Diagnostic>;

    fn next(&mut self) -> Option<Self::Item> {
        let batch = self.batch().transpose()?;
        Some(batch.map_err(|error| {
            // nothing is read behind what cannot be read
            (self.left, self.next_group) = (0, self.reader.num_row_groups());
            Diagnostic::unreadable(&self.name, &error)
        }))
    }
}

impl Batches {
    fn batch(&mut self) -> Result<Option<Vec<Record>>, ParquetError> {
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
        let count = self.columns.len();
        let record = |row| Record::new(Vec::with_capacity(count), row);
        let mut records: Vec<Record> = (self.next_row..).take(rows).map(record).collect();
        for (reader, leaf) in self.open.iter_mut().zip(&self.columns) {
            for (record, content) in records.iter_mut().zip(contents(reader, leaf.values, rows)?) {
                record.cells.push(Cell::from(content));
            }
        }
        self.left -= rows;
        self.next_row += rows as u64;
        Ok(Some(records))
    }
}

/// The next values of a column.
fn contents(reader: &mut ColumnReader, values: Values, rows: usize) -> Result<Vec<Content>, ParquetError> {
    match reader {
        ColumnReader::DoubleColumnReader(reader) => read(reader, rows, |value| number(Decimal::of_f64(*value))),
        ColumnReader::FloatColumnReader(reader) => read(reader, rows, |value| number(Decimal::of_f32(*value))),
        ColumnReader::Int32ColumnReader(reader) => {
            read(reader, rows, |value| values.content(i64::from(*value), u64::from(value.cast_unsigned())))
        }
        ColumnReader::Int64ColumnReader(reader) => {
            read(reader, rows, |value| values.content(*value, value.cast_unsigned()))
        }
        ColumnReader::ByteArrayColumnReader(reader) => read(reader, rows, |value| match values {
            Values::Decimal { scale } => of_bytes(value.data(), scale),
            _ => Content::of_text(&String::from_utf8_lossy(value.data())),
        }),
        ColumnReader::FixedLenByteArrayColumnReader(reader) => {
            read(reader, rows, |value| of_bytes(value.data(), values.scale()))
        }
        ColumnReader::Int96ColumnReader(reader) => {
            let moment = Moment::Timestamp { per_second: 1000 };
            read(reader, rows, |value| Content::Other(moment.shown(value.to_millis())))
        }
        ColumnReader::BoolColumnReader(reader) => read(reader, rows, |value| Content::Other(value.to_string())),
    }
}

/// The next `rows` values; an empty cell where there is none.
fn read<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: usize,
    content: impl Fn(&T::T) -> Content,
) -> Result<Vec<Content>, ParquetError> {
    let (mut levels, mut values) = (Vec::new(), Vec::with_capacity(rows));
    let (found, ..) = reader.read_records(rows, Some(&mut levels), None, &mut values)?;
    if found != rows {
        return Err(ParquetError::EOF(format!("a column ends {} rows before the others", rows - found)));
    }
    let mut values = values.iter().map(content);
    // a column that has a value in each row has no levels
    if levels.is_empty() {
        return Ok(values.collect());
    }
    let value = |level| if level == 0 { None } else { values.next() };
    Ok(levels.into_iter().map(value).map(Option::unwrap_or_default).collect())
}

/// A number; NaN, an infinity and a `DECIMAL` beyond its type are no measured values.
fn number(number: Option<Decimal>) -> Content {
    number.map_or_else(|| Content::Other("no finite number".to_owned()), Content::Number)
}

/// A `DECIMAL` from its two's complement, the highest byte first.
fn of_bytes(bytes: &[u8], scale: i32) -> Content {
    let negative = bytes.first().is_some_and(|byte| byte & 0x80 != 0);
    let start = if negative { -1i128 } else { 0 };
    let unscaled = bytes.iter().try_fold(start, |sum, byte| sum.checked_mul(256)?.checked_add(i128::from(*byte)));
    number(unscaled.map(|unscaled| Decimal::of_i128(unscaled, scale)))
}

#[cfg(test)]
mod tests;
