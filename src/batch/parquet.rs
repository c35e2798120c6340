//! Rows as a Parquet file. A batch writes its rows here; the command line closes the file.
//!
//! Takes results in columns and writes groups of some [`GROUP`] rows, so that memory does not depend on the number of rows. A
//! program reads the same values as from rows of text.

use std::borrow::Cow;
use std::io::{self, Write};
use std::sync::Arc;

use ::bytes::Bytes;
use ::parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use ::parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType};
use ::parquet::errors::ParquetError;
use ::parquet::file::properties::{EnabledStatistics, WriterProperties};
use ::parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use ::parquet::schema::types::{ColumnPath, Type};

use super::columns::{ColumnKind, ResultColumn, ResultColumns, ResultValues};
use super::ledger::ColumnSink;
use crate::table::Field;

/// Rows in a group, at least: a few MiB of results.
const GROUP: usize = 1 << 14;
/// Rows in a piece of a group from which on it stays as it is.
const PIECE: usize = 1 << 10;

/// A writer of a batch's rows as a Parquet file.
pub struct ParquetRows {
    writer: SerializedFileWriter<Box<dyn Write + Send>>,
    /// The rows of the group to be written, in pieces that are not moved once they are large.
    group: Vec<ResultColumns>,
    /// How many rows these are.
    rows: usize,
}

impl ParquetRows {
    /// Rows of columns of these names and kinds, to `out`.
    ///
    /// # Errors
    /// If nothing can be written.
    pub fn new(out: Box<dyn Write + Send>, columns: &[(String, ColumnKind)]) -> io::Result<Self> {
        let mut properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(format!("rackmesh {}", env!("CARGO_PKG_VERSION")));
        let mut fields = Vec::new();
        for (name, kind) in columns {
            let (physical, logical) = match kind {
                ColumnKind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
                ColumnKind::Number => (Physical::DOUBLE, None),
                ColumnKind::Flag => (Physical::BOOLEAN, None),
            };
            let field = Type::primitive_type_builder(name, physical)
                .with_repetition(Repetition::OPTIONAL)
                .with_logical_type(logical)
                .build();
            fields.push(Arc::new(field.map_err(failed)?));
            let path = || ColumnPath::from(vec![name.clone()]);
            if *kind == ColumnKind::Number || name == Field::PartId.key() {
                // nearly all values differ
                properties = properties.set_column_dictionary_enabled(path(), false);
            }
            if *kind == ColumnKind::Text {
                // the least and the greatest text are of no use
                properties = properties.set_column_statistics_enabled(path(), EnabledStatistics::None);
            }
        }
        let schema = Type::group_type_builder("parts").with_fields(fields).build().map_err(failed)?;
        let writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties.build())).map_err(failed)?;
        Ok(Self { group: Vec::new(), rows: 0, writer })
    }

    /// Writes the last group and the end of the file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(mut self) -> io::Result<()> {
        self.write_group()?;
        self.writer.close().map(|_| ()).map_err(failed)
    }

    fn write_group(&mut self) -> io::Result<()> {
        if std::mem::take(&mut self.rows) == 0 {
            return Ok(());
        }
        let mut group = self.writer.next_row_group().map_err(failed)?;
        let mut pieces: Vec<_> = self.group.drain(..).map(|rows| rows.columns.into_iter()).collect();
        while let Some(mut open) = group.next_column().map_err(failed)? {
            for column in pieces.iter_mut().filter_map(Iterator::next) {
                write_column(&mut open, column).map_err(failed)?;
            }
            open.close().map_err(failed)?;
        }
        group.close().map_err(failed)?;
        Ok(())
    }
}

impl ColumnSink for ParquetRows {
    fn take(&mut self, rows: ResultColumns) -> io::Result<()> {
        self.rows += rows.rows;
        match self.group.last_mut().filter(|last| last.rows < PIECE) {
            Some(last) => last.append(rows),
            None => self.group.push(rows),
        }
        if self.rows >= GROUP { self.write_group() } else { Ok(()) }
    }
}

/// Writes some rows of a column.
fn write_column(open: &mut SerializedColumnWriter<'_>, column: ResultColumn) -> Result<usize, ParquetError> {
    let rows = column.rows();
    let ResultColumn { has_value, values } = column;
    let levels: Vec<i16> = match &has_value {
        Some(has_value) => has_value.iter().map(|has_value| i16::from(*has_value)).collect(),
        None => vec![1; rows],
    };
    let levels = Some(levels.as_slice());
    match values {
        ResultValues::Texts { bytes, ends } => {
            let bytes = Bytes::from(bytes);
            let spans: Vec<[i32; 2]> = ends.windows(2).map(|span| [span[0], span[1]]).collect();
            let text = |span: &[i32; 2]| ByteArray::from(bytes.slice(span[0] as usize..span[1] as usize));
            let texts: Vec<_> = present(&spans, has_value.as_deref()).iter().map(text).collect();
            open.typed::<ByteArrayType>().write_batch(&texts, levels, None)
        }
        ResultValues::Numbers(numbers) => {
            open.typed::<DoubleType>().write_batch(&present(&numbers, has_value.as_deref()), levels, None)
        }
        ResultValues::Flags(flags) => {
            open.typed::<BoolType>().write_batch(&present(&flags, has_value.as_deref()), levels, None)
        }
    }
}

/// The values of the rows that have one.
fn present<'v, T: Copy>(values: &'v [T], has_value: Option<&[bool]>) -> Cow<'v, [T]> {
    let Some(has_value) = has_value else { return values.into() };
    values.iter().zip(has_value).filter(|(_, has_value)| **has_value).map(|(value, _)| *value).collect()
}

fn failed(error: ParquetError) -> io::Error {
    match error {
        // a closed pipe stays one
        ParquetError::External(source) => match source.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(source) => io::Error::other(source),
        },
        error => io::Error::other(error),
    }
}

#[cfg(test)]
mod tests {
    use ::parquet::file::reader::{FileReader as _, SerializedFileReader};
    use ::parquet::record::Field;

    use std::sync::Mutex;

    use super::super::columns::ResultCell;
    use super::super::number::Decimals;
    use super::*;
    use crate::quantity::Length;

    /// A file in memory that is still there when the writer is gone.
    #[derive(Clone, Default)]
    struct Memory(Arc<Mutex<Vec<u8>>>);

    impl Write for Memory {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn what_is_read_back_is_what_was_written() {
        let kinds = vec![ColumnKind::Text, ColumnKind::Number, ColumnKind::Flag, ColumnKind::Text];
        let names = ["part_id", "rss_mm", "linear", "verdict"].map(str::to_owned);
        let columns: Vec<_> = names.into_iter().zip(kinds.clone()).collect();
        let memory = Memory::default();
        let mut file = ParquetRows::new(Box::new(memory.clone()), &columns).unwrap();
        let mut expected = Vec::new();
        let parts = GROUP + 100;
        for part in 0..parts {
            let fm = part as i64 * 1_000_000 * if part % 2 == 0 { -1 } else { 1 };
            let (id, verdict) = (format!("P{part}"), ["pass", "fail", ""][part % 3]);
            let mut rows = ResultColumns::new(kinds.iter().copied(), 0);
            let text = |text: &'static str| ResultCell::Text(text.as_bytes().into());
            let cells = [
                ResultCell::Text(id.clone().into_bytes().into()),
                ResultCell::Length(Length::from_fm(fm)),
                ResultCell::Flag(part % 5 == 0),
                if verdict.is_empty() { ResultCell::Nothing } else { text(verdict) },
            ];
            rows.push(cells.into_iter(), Decimals::Places(6));
            file.take(rows).unwrap();
            expected.push((id, Decimals::Places(6).value(Length::from_fm(fm)), part % 5 == 0, verdict));
        }
        file.finish().unwrap();
        let file = bytes::Bytes::from(memory.0.lock().unwrap().clone());
        let reader = SerializedFileReader::new(file).unwrap();
        assert_eq!(reader.metadata().num_row_groups(), 2);
        let mut count = 0;
        for (row, (id, number, flag, verdict)) in reader.get_row_iter(None).unwrap().zip(&expected) {
            let row = row.unwrap();
            let fields: Vec<_> = row.get_column_iter().map(|(_, field)| field.clone()).collect();
            let verdict = if verdict.is_empty() { Field::Null } else { Field::Str((*verdict).to_owned()) };
            assert_eq!(fields, [Field::Str(id.clone()), Field::Double(*number), Field::Bool(*flag), verdict]);
            count += 1;
        }
        assert_eq!(count, parts);
    }
}
