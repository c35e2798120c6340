//! Parquet files as stored columns.
//!
//! A file is opened with [`ParquetTable::open`]; [`ranges`](ParquetTable::ranges) are its rows, some at a time, which
//! workers [`read`](ParquetTable::read) side by side, each with the columns that are looked at. Nothing becomes text on the
//! way: a double is its shortest decimal, a `DECIMAL` and an integer are what they are. Nothing here knows what a column
//! means.

mod column;
mod pages;
mod shared;

pub(crate) use column::Unread;
pub(crate) use shared::SharedFile;

use std::ops::Range;
use std::sync::Arc;

use ::parquet::basic::{Compression, Encoding};
use ::parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use ::parquet::data_type::{ByteArray, DataType, Int96};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::ColumnChunkMetaData;
use ::parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};

use super::cell::Content;
use super::stored::{Stored, number};
use super::want::ignore_option;
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::Decimal;
use column::{StoredColumn, Values};
use pages::CheckedPages;

/// Rows that are read together: their columns stay near at hand.
const RANGE_ROWS: usize = 1 << 11;

/// A Parquet file that was opened.
pub struct ParquetTable {
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
        let mut columns = column::columns(reader.metadata().file_metadata().schema_descr());
        for column in &mut columns {
            let Ok(leaf) = &column.leaf else { continue };
            let mut chunks = reader.metadata().row_groups().iter().map(|group| group.column(leaf.index));
            if let Some(packing) = chunks.find_map(packing_not_read) {
                column.leaf = Err(Unread::Packing(packing));
            }
        }
        Ok(Self { name: name.to_owned(), length, reader: Arc::new(reader), columns })
    }

    /// Its columns, in their order.
    pub(crate) fn columns(&self) -> &[StoredColumn] {
        &self.columns
    }

    /// Whether the schema that Arrow keeps beside the columns, in base64, has a unit of a field: a key behind its length.
    pub(crate) fn has_units_of_fields(&self) -> bool {
        // at each place that it may have among three bytes
        const KEYS: [&str; 6] =
            ["BAAAAHVuaXQA", "QAAAB1bml0A", "EAAAAdW5pdA", "BQAAAHVuaXRzA", "UAAAB1bml0cw", "FAAAAdW5pdHMA"];
        let pairs = self.reader.metadata().file_metadata().key_value_metadata().into_iter().flatten();
        let mut schemas = pairs.filter(|pair| pair.key == "ARROW:schema").filter_map(|pair| pair.value.as_ref());
        schemas.any(|schema| KEYS.iter().any(|key| schema.contains(key)))
    }

    /// Whether the values of the columns that can be read lie in the file.
    ///
    /// # Errors
    /// The first column that lies beyond the file's end.
    pub(crate) fn check(&self) -> Result<(), Diagnostic> {
        for column in &self.columns {
            let Ok(leaf) = &column.leaf else { continue };
            for group in self.reader.metadata().row_groups() {
                let chunk = group.column(leaf.index);
                let start = chunk.dictionary_page_offset().unwrap_or(chunk.data_page_offset());
                let end = start.checked_add(chunk.compressed_size()).and_then(|end| u64::try_from(end).ok());
                let in_file = start >= 0 && chunk.compressed_size() >= 0 && end.is_some_and(|end| end <= self.length);
                if !in_file {
                    let problem = format!("column `{}` lies beyond its end", column.name);
                    return Err(Diagnostic::unreadable(&self.name, &problem));
                }
            }
        }
        Ok(())
    }

    /// All of its rows, some at a time.
    pub(crate) fn ranges(&self) -> Vec<RowRange> {
        let mut ranges = Vec::new();
        let mut before = 0;
        for (group, metadata) in self.reader.metadata().row_groups().iter().enumerate() {
            let rows = usize::try_from(metadata.num_rows()).unwrap_or(0);
            for start in (0..rows).step_by(RANGE_ROWS) {
                ranges.push(RowRange { group, start, rows: RANGE_ROWS.min(rows - start), before });
                before += RANGE_ROWS.min(rows - start) as u64;
            }
        }
        ranges
    }

    /// Some rows of the columns at these places, of those that can be read at all.
    ///
    /// # Errors
    /// If they cannot be read.
    pub(crate) fn read(
        &self,
        open: &mut Option<OpenGroup>,
        range: RowRange,
        places: &[bool],
    ) -> Result<Vec<Option<Stored<'static>>>, Diagnostic> {
        let unreadable = |error: ParquetError| Diagnostic::unreadable(&self.name, &error);
        let group = match open {
            Some(group) if group.number == range.group && group.next <= range.start => group,
            _ => open.insert(self.open_group(range.group, places).map_err(unreadable)?),
        };
        let rows = range.start - group.next..range.start - group.next + range.rows;
        group.next = range.start + range.rows;
        let column = |column: &mut Option<(ColumnReader, Values)>| {
            let Some((reader, values)) = column else { return Ok(None) };
            stored(reader, *values, rows.clone()).map(Some)
        };
        group.columns.iter_mut().map(column).collect::<Result<_, _>>().map_err(unreadable)
    }

    fn open_group(&self, number: usize, places: &[bool]) -> Result<OpenGroup, ParquetError> {
        let group = self.reader.get_row_group(number)?;
        let mut columns = Vec::new();
        for (leaf, is_wanted) in self.columns.iter().filter_map(|column| column.leaf.as_ref().ok()).zip(places) {
            if !is_wanted {
                columns.push(None);
                continue;
            }
            let column = group.metadata().column(leaf.index).column_descr_ptr();
            let pages = CheckedPages::new(group.get_column_page_reader(leaf.index)?, &column);
            columns.push(Some((get_column_reader(column, Box::new(pages)), leaf.values)));
        }
        Ok(OpenGroup { number, columns, next: 0 })
    }

    /// The refusal of a column that is not read.
    pub(crate) fn refused(&self, column: &str, why: &Unread) -> Diagnostic {
        let name = &self.name;
        match why {
            Unread::Type(what) => {
                let message = format!("{name}: column `{column}` is {what}, which is not read");
                let help = format!("write it as DOUBLE, DECIMAL or text; or leave it out: {}", ignore_option(column));
                Diagnostic::error(Code::BadTable, message).help(help)
            }
            Unread::Packing(how) => {
                let message = format!("cannot read {name}: column `{column}` is {how}");
                let help = "write the file with SNAPPY, GZIP, BROTLI or LZ4, or without compression; texts plain or with a dictionary";
                Diagnostic::error(Code::FileAccess, message).help(help)
            }
        }
    }
}

/// How the values of a column in a group are packed, if that is not read.
fn packing_not_read(chunk: &ColumnChunkMetaData) -> Option<String> {
    let is_delta =
        |encoding: &Encoding| [Encoding::DELTA_BYTE_ARRAY, Encoding::DELTA_LENGTH_BYTE_ARRAY].contains(encoding);
    let packed = chunk.encodings().find(is_delta).map(pages::packed_by_differences);
    codec_not_read(chunk.compression()).map(|codec| format!("compressed with {codec}")).or(packed)
}

/// A compression that is not read.
fn codec_not_read(compression: Compression) -> Option<&'static str> {
    match compression {
        Compression::ZSTD(_) => Some("ZSTD"),
        Compression::LZO => Some("LZO"),
        _ => None,
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

/// Some rows of a group.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowRange {
    group: usize,
    /// The first row, from the start of the group.
    start: usize,
    rows: usize,
    /// Rows of the file before them.
    pub(crate) before: u64,
}

impl RowRange {
    /// Its first rows.
    pub(crate) fn first(self, rows: usize) -> Self {
        Self { rows: self.rows.min(rows), ..self }
    }
}

/// A group of rows that is being read.
pub(crate) struct OpenGroup {
    number: usize,
    /// By place; `None` of a column that is not wanted.
    columns: Vec<Option<(ColumnReader, Values)>>,
    /// The next row.
    next: usize,
}

fn ended_early(rows: usize) -> ParquetError {
    ParquetError::EOF(format!("a column ends {rows} rows before the others"))
}

/// Values of a column in some of the next rows.
fn stored(reader: &mut ColumnReader, values: Values, rows: Range<usize>) -> Result<Stored<'static>, ParquetError> {
    match (reader, values) {
        (ColumnReader::DoubleColumnReader(reader), _) => read(reader, rows, Stored::doubles),
        (ColumnReader::FloatColumnReader(reader), _) => read(reader, rows, |values| Stored::singles(&values)),
        (ColumnReader::Int64ColumnReader(reader), _) => read(reader, rows, |integers| values.of_integers(integers)),
        (ColumnReader::Int32ColumnReader(reader), _) => {
            let is_unsigned = values == Values::Unsigned;
            let long = |value: i32| if is_unsigned { value.cast_unsigned().into() } else { value.into() };
            read(reader, rows, |integers| values.of_integers(integers.into_iter().map(long).collect()))
        }
        (ColumnReader::ByteArrayColumnReader(reader), Values::Decimal { scale }) => {
            read_each(reader, rows, |value| of_bytes(value.data(), scale))
        }
        (ColumnReader::ByteArrayColumnReader(reader), _) => read(reader, rows, |texts| {
            let mut bytes = Vec::with_capacity(texts.iter().map(ByteArray::len).sum());
            let mut ends = Vec::with_capacity(texts.len() + 1);
            ends.push(0);
            for text in texts {
                bytes.extend_from_slice(text.data());
                ends.push(bytes.len());
            }
            Stored::texts(bytes, ends)
        }),
        (ColumnReader::FixedLenByteArrayColumnReader(reader), _) => {
            read_each(reader, rows, |value| of_fixed(value.data(), values))
        }
        (ColumnReader::Int96ColumnReader(reader), _) => {
            let parts = |value: &Int96| value.data().try_into().unwrap_or_default();
            read_each(reader, rows, |value| Content::Other(column::shown_int96(parts(value))))
        }
        (ColumnReader::BoolColumnReader(reader), _) => {
            read_each(reader, rows, |value| Content::Other(value.to_string()))
        }
    }
}

/// The same, each by itself.
fn read_each<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: Range<usize>,
    content: impl Fn(&T::T) -> Content,
) -> Result<Stored<'static>, ParquetError> {
    read(reader, rows, |values| Stored::contents(values.iter().map(content).collect()))
}

/// The same of one type; pages of the rows before them are not unpacked.
fn read<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: Range<usize>,
    stored: impl FnOnce(Vec<T::T>) -> Stored<'static>,
) -> Result<Stored<'static>, ParquetError> {
    let (mut levels, mut values) = (Vec::new(), Vec::with_capacity(rows.len()));
    let skipped = reader.skip_records(rows.start)?;
    let (found, ..) = reader.read_records(rows.len(), Some(&mut levels), None, &mut values)?;
    if skipped + found != rows.end {
        return Err(ended_early(rows.end - skipped - found));
    }
    // a column that has a value in each row has no levels
    if levels.iter().all(|level| *level > 0) {
        return Ok(stored(values));
    }
    Ok(stored(values).spread(levels.into_iter().map(|level| level > 0).collect()))
}

/// Bytes of a fixed length.
fn of_fixed(bytes: &[u8], values: Values) -> Content {
    match values {
        Values::Decimal { scale } => of_bytes(bytes, scale),
        Values::Halves => number(bytes.try_into().ok().and_then(column::half)),
        Values::Uuids => Content::of_text(&column::shown_uuid(bytes)),
        _ => Content::of_text(&column::shown_bytes(bytes)),
    }
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
