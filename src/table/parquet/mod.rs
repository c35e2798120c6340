//! Parquet files as stored columns.
//!
//! [`ParquetTable::open`] opens a file, and [`next`](ParquetTable::next) reads some rows at a time of the columns that are needed.
//! Numbers stay numbers: a double means its shortest decimal, a `DECIMAL` and an integer their exact value. Nothing here knows what a
//! column means.

mod arrow;
mod column;
mod header;
mod pages;

pub(crate) use column::{StoredColumn, Unread};

use ::parquet::basic::{Compression, Encoding};
use ::parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use ::parquet::data_type::{ByteArray, DataType, Int96};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::ColumnChunkMetaData;
use ::parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};
use bytes::Bytes;

use std::sync::Arc;

use super::cell::Content;
use super::ledger::digest;
use super::stored::{Stored, number};
use crate::diagnostic::Diagnostic;
use crate::quantity::Decimal;
use column::{Leaf, Values};
use pages::{CheckedPages, Texts};

/// Rows that are read together: few enough for the processor's cache.
pub(crate) const ROWS_TOGETHER: usize = 1 << 11;

/// Reads so many bytes of a file from a place on.
type StoredBytes = Box<dyn Fn(u64, usize) -> Option<Bytes> + Send>;

/// Bytes of texts that are read together, about.
const TEXT_TOGETHER: usize = 8 << 20;
/// Columns that are open at once while the first rows are read.
const COLUMNS_TOGETHER: usize = 64;
/// Columns at most.
const MOST_COLUMNS: usize = 10_000;
/// Bytes of the footer at most, which lists the columns of each group of rows and takes ten times as much memory: enough for 20
/// columns in 2,000 groups.
const LARGEST_FOOTER: u32 = 4 << 20;
/// Stored bytes that are hashed together.
const HASHED_TOGETHER: usize = 1 << 20;

/// A Parquet file that is open.
pub struct ParquetTable {
    name: String,
    /// Bytes of the file.
    length: u64,
    reader: Box<dyn FileReader>,
    /// Its stored bytes.
    bytes: StoredBytes,
    /// Its columns, in their order.
    pub(crate) columns: Vec<StoredColumn>,
    /// The group of rows that is read next.
    group: usize,
    /// The columns of the group that is being read, by place; `None` for one that is not read.
    open: Vec<Option<(ColumnReader, Leaf)>>,
    /// The lengths of the texts of each column, as far as its pages are read.
    longest: Vec<Arc<Texts>>,
    /// How many rows of that group are still to be read.
    left: usize,
    /// How many rows of the file are read.
    before: u64,
}

/// A source of bytes that can be read from two places.
pub(crate) trait Again: Sized {
    /// A second handle of the same source.
    fn again(&self) -> std::io::Result<Self>;
}

impl Again for std::fs::File {
    fn again(&self) -> std::io::Result<Self> {
        self.try_clone()
    }
}

impl Again for Bytes {
    fn again(&self) -> std::io::Result<Self> {
        Ok(self.clone())
    }
}

/// Some rows of a file.
pub(crate) struct StoredRows {
    /// By place; `None` for a column that is not read.
    pub(crate) columns: Vec<Option<Stored<'static>>>,
    /// Rows of the file before them.
    pub(crate) before: u64,
}

impl ParquetTable {
    /// Opens a file, on a disk or in memory; messages call it `name`.
    ///
    /// # Errors
    /// If it is not a Parquet file, or an encrypted one.
    pub(crate) fn open<R: ChunkReader + Again + 'static>(name: &str, source: R) -> Result<Self, Diagnostic> {
        check_marks(name, &source)?;
        let length = source.len();
        let again = source.again().map_err(|error| Diagnostic::unreadable(name, &error))?;
        let bytes = Box::new(move |start: u64, count: usize| again.get_bytes(start, count).ok());
        let reader = SerializedFileReader::new(source).map_err(|error| Diagnostic::unreadable(name, &error))?;
        let schema = reader.metadata().file_metadata().schema_descr();
        if schema.num_columns() > MOST_COLUMNS {
            let problem = format!("it has {} columns, and at most {MOST_COLUMNS} are read", schema.num_columns());
            return Err(Diagnostic::unreadable(name, &problem).help("write it with the columns that are needed"));
        }
        let mut columns = column::columns(schema);
        for column in &mut columns {
            let Ok(leaf) = &column.leaf else { continue };
            let mut chunks = reader.metadata().row_groups().iter().map(|group| group.column(leaf.index));
            if let Some(packing) = chunks.find_map(packing_not_read) {
                column.leaf = Err(Unread::Packing(packing));
            }
        }
        let (reader, name) = (Box::new(reader), name.to_owned());
        let (open, longest) = (Vec::new(), Vec::new());
        Ok(Self { name, length, reader, bytes, columns, group: 0, open, longest, left: 0, before: 0 })
    }

    /// The metadata of fields in the schema that Arrow stores: keys and values.
    pub(crate) fn remarks_of_fields(&self) -> Vec<(String, String)> {
        let pairs = self.reader.metadata().file_metadata().key_value_metadata().into_iter().flatten();
        let schemas = pairs.filter(|pair| pair.key == "ARROW:schema").filter_map(|pair| pair.value.as_ref());
        let unknown = || vec![("ARROW:schema".to_owned(), "it is not understood".to_owned())];
        schemas.flat_map(|schema| arrow::remarks_of_fields(schema).unwrap_or_else(unknown)).collect()
    }

    /// The metadata of the file, without what pandas and Arrow write for themselves: keys and values.
    pub(crate) fn remarks(&self) -> impl Iterator<Item = (&str, &str)> {
        let pairs = self.reader.metadata().file_metadata().key_value_metadata().into_iter().flatten();
        let is_own = |key: &str| matches!(key, "pandas" | "ARROW:schema");
        let pairs = pairs.filter(move |pair| !is_own(&pair.key));
        pairs.map(|pair| (pair.key.as_str(), pair.value.as_deref().unwrap_or_default()))
    }

    /// A digest of the stored bytes of a column, by its place; nothing is unpacked.
    pub(crate) fn stored_digest(&self, place: usize) -> u64 {
        let leaves = &self.columns[place].leaves;
        let groups = self.reader.metadata().row_groups().iter();
        let chunks = groups.flat_map(|group| leaves.clone().map(|leaf| group.column(leaf)));
        let pieces = chunks.flat_map(|chunk| {
            let start = chunk.dictionary_page_offset().unwrap_or(chunk.data_page_offset());
            let [start, size] = [start, chunk.compressed_size()].map(|number| usize::try_from(number).unwrap_or(0));
            let end = start.saturating_add(size);
            (start..end).step_by(HASHED_TOGETHER).map(move |at| (at, HASHED_TOGETHER.min(end - at)))
        });
        let digests = pieces.zip(0..).map(|((at, count), number)| {
            let bytes = (self.bytes)(at as u64, count).unwrap_or_default();
            digest(number, place, &bytes)
        });
        digests.fold(0, u64::wrapping_add)
    }

    /// Checks that the values of the columns that can be read lie in the file.
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

    /// The next rows, `most` of them at most; `None` at the end. `places` says which of the columns that can be read are needed.
    ///
    /// # Errors
    /// If they cannot be read.
    pub(crate) fn next(&mut self, places: &[bool], most: usize) -> Result<Option<StoredRows>, Diagnostic> {
        let rows = self.next_rows(places, most);
        rows.map_err(|error| Diagnostic::unreadable(&self.name, &error))
    }

    /// The first rows of all columns that can be read, `most` of them at most, and how many they are. Only some columns are open at
    /// once. Goes back to the first row.
    ///
    /// # Errors
    /// If they cannot be read, or the texts of one row are too long.
    pub(crate) fn head(&mut self, most: usize) -> Result<(Vec<Option<Stored<'static>>>, usize), Diagnostic> {
        let count = self.columns.iter().filter(|column| column.is_read()).count();
        let (mut columns, mut rows, mut widest) = (Vec::with_capacity(count), most, 0);
        for first in (0..count).step_by(COLUMNS_TOGETHER) {
            let places: Vec<bool> =
                (0..count).map(|place| (first..first + COLUMNS_TOGETHER).contains(&place)).collect();
            let read = self.next(&places, rows)?.map_or_else(Vec::new, |read| read.columns);
            self.rewind();
            widest += self.longest.iter().map(|texts| texts.begin()).sum::<usize>();
            if widest > TEXT_TOGETHER {
                let problem = format!("the texts of a row have more than {} MiB", TEXT_TOGETHER >> 20);
                return Err(
                    Diagnostic::unreadable(&self.name, &problem).help("write it without the columns of long texts")
                );
            }
            let shortest = read.iter().flatten().map(Stored::rows).min().unwrap_or(0);
            rows = rows.min(shortest).min(TEXT_TOGETHER / widest.max(1));
            columns.extend(read.into_iter().flatten().map(Some));
        }
        Ok((columns, rows))
    }

    fn next_rows(&mut self, places: &[bool], most: usize) -> Result<Option<StoredRows>, ParquetError> {
        while self.left == 0 {
            if self.group == self.reader.num_row_groups() {
                return Ok(None);
            }
            self.open_group(places)?;
        }
        let widest: usize = self.longest.iter().map(|texts| texts.begin()).sum();
        let most = most.min((TEXT_TOGETHER / widest.max(1)).max(1));
        let (rows, before) = (self.left.min(most), self.before);
        (self.left, self.before) = (self.left - rows, before + rows as u64);
        let column = |column: &mut Option<(ColumnReader, Leaf)>| {
            column.as_mut().map(|(reader, leaf)| stored(reader, leaf, rows)).transpose()
        };
        let columns = self.open.iter_mut().map(column).collect::<Result<_, _>>()?;
        Ok(Some(StoredRows { columns, before }))
    }

    fn open_group(&mut self, places: &[bool]) -> Result<(), ParquetError> {
        let group = self.reader.get_row_group(self.group)?;
        let leaves = self.columns.iter().filter_map(|column| column.leaf.as_ref().ok());
        let bytes = &self.bytes;
        let mut longest = Vec::new();
        let column = |(leaf, is_wanted): (&Leaf, &bool)| {
            let open = || {
                let chunk = group.metadata().column(leaf.index);
                header::check(chunk, bytes).map_err(ParquetError::General)?;
                let column = chunk.column_descr_ptr();
                let texts = Arc::new(Texts::default());
                let pages = CheckedPages::new(group.get_column_page_reader(leaf.index)?, &column, &texts)?;
                longest.push(texts);
                Ok((get_column_reader(column, Box::new(pages)), *leaf))
            };
            is_wanted.then(open).transpose()
        };
        self.open = leaves.zip(places).map(column).collect::<Result<_, ParquetError>>()?;
        self.longest = longest;
        self.left = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        self.group += 1;
        Ok(())
    }

    /// Goes back to the first row.
    pub(crate) fn rewind(&mut self) {
        (self.group, self.left, self.before) = (0, 0, 0);
    }
}

/// The packing of a column in a group, if it is one that is not read.
fn packing_not_read(chunk: &ColumnChunkMetaData) -> Option<String> {
    let is_delta =
        |encoding: &Encoding| [Encoding::DELTA_BYTE_ARRAY, Encoding::DELTA_LENGTH_BYTE_ARRAY].contains(encoding);
    let packed = chunk.encodings().find(is_delta).map(pages::packed_by_differences);
    codec_not_read(chunk.compression()).map(|codec| format!("compressed with {codec}")).or(packed)
}

/// The name of a compression that is not read; `None` if it is read.
fn codec_not_read(compression: Compression) -> Option<&'static str> {
    match compression {
        Compression::ZSTD(_) => Some("ZSTD"),
        Compression::LZO => Some("LZO"),
        _ => None,
    }
}

/// Checks the marks at both ends of a file, and the size of its footer, which stands before the last one.
fn check_marks<R: ChunkReader>(name: &str, source: &R) -> Result<(), Diagnostic> {
    const MARK: usize = 4;
    let end = source.len().saturating_sub(MARK as u64);
    let mark = |at: u64| source.get_bytes(at, MARK).unwrap_or_default();
    let footer = mark(end.saturating_sub(MARK as u64)).as_ref().try_into().map_or(0, u32::from_le_bytes);
    match (mark(0).as_ref(), mark(end).as_ref()) {
        (b"PAR1", b"PAR1") if footer > LARGEST_FOOTER && u64::from(footer) < end => {
            let most = LARGEST_FOOTER >> 20;
            let problem = format!("the list of its columns and row groups is larger than {most} MiB");
            let help = "write it with larger row groups, or with fewer columns";
            Err(Diagnostic::unreadable(name, &problem).help(help))
        }
        (b"PAR1", b"PAR1") => Ok(()),
        (_, b"PARE") => Err(Diagnostic::unreadable(name, &"it is encrypted")),
        (b"PAR1", _) => Err(Diagnostic::unreadable(name, &"it is a Parquet file whose end is missing")),
        _ => Err(Diagnostic::unreadable(name, &"it is no Parquet file")),
    }
}

/// The values of a column in the next rows.
fn stored(reader: &mut ColumnReader, leaf: &Leaf, rows: usize) -> Result<Stored<'static>, ParquetError> {
    let (values, rows) = (leaf.values, (rows, leaf.level));
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
        (ColumnReader::FixedLenByteArrayColumnReader(reader), _) => read_each(reader, rows, |value| match values {
            Values::Decimal { scale } => of_bytes(value.data(), scale),
            _ => Content::of_text(&column::shown_bytes(value.data())),
        }),
        (ColumnReader::Int96ColumnReader(reader), _) => {
            let parts = |value: &Int96| value.data().try_into().unwrap_or_default();
            read_each(reader, rows, |value| Content::Other(column::shown_int96(parts(value)).into()))
        }
        (ColumnReader::BoolColumnReader(reader), _) => {
            read_each(reader, rows, |value| Content::Other(value.to_string().into()))
        }
    }
}

/// The values of a column in the next rows, each converted by itself.
fn read_each<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: (usize, i16),
    content: impl Fn(&T::T) -> Content,
) -> Result<Stored<'static>, ParquetError> {
    read(reader, rows, |values| Stored::contents(values.iter().map(content).collect()))
}

/// The values of a column of one type in the next rows. A row of level `present` has a value.
fn read<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    (rows, present): (usize, i16),
    stored: impl FnOnce(Vec<T::T>) -> Stored<'static>,
) -> Result<Stored<'static>, ParquetError> {
    let (mut levels, mut values) = (Vec::new(), Vec::with_capacity(rows));
    let (found, ..) = reader.read_records(rows, Some(&mut levels), None, &mut values)?;
    if found != rows {
        return Err(ParquetError::EOF(format!("a column ends {} rows before the others", rows - found)));
    }
    // a column that has a value in each row has no levels
    if levels.iter().all(|level| *level == present) {
        return Ok(stored(values));
    }
    Ok(stored(values).spread(levels.into_iter().map(|level| level == present).collect()))
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
