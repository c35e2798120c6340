//! Rows as a Parquet file. Given to a batch as the writer of its rows; the command line ends it.
//!
//! Takes the rows as CSV, with their header, and writes groups of [`GROUP`] rows, so that memory does not depend on how
//! many there are. Numbers become doubles: what a program reads is what the CSV says. An empty field is null.

use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};

use ::parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use ::parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType};
use ::parquet::errors::ParquetError;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::{ColumnPath, Type};

/// What a column holds.
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

/// Rows in a group: a few MiB of results.
pub const GROUP: usize = 1 << 14;

/// The values of a column in the group to be written; nulls are in the levels only.
enum Values {
    Text(Vec<ByteArray>),
    Number(Vec<f64>),
    Flag(Vec<bool>),
}

struct Column {
    values: Values,
    /// 1 for a value, 0 for null.
    levels: Vec<i16>,
}

/// Where the rows of a batch become a Parquet file; clones write the same file.
#[derive(Clone)]
pub struct ParquetRows(Arc<Mutex<State>>);

struct State {
    kinds: Vec<ColumnKind>,
    /// Until the header is there.
    out: Option<Box<dyn Write + Send>>,
    writer: Option<SerializedFileWriter<Box<dyn Write + Send>>>,
    columns: Vec<Column>,
    rows: usize,
}

impl ParquetRows {
    /// Rows of columns of these kinds, to `out`.
    #[must_use]
    pub fn new(out: Box<dyn Write + Send>, kinds: Vec<ColumnKind>) -> Self {
        let state = State { kinds, out: Some(out), writer: None, columns: Vec::new(), rows: 0 };
        Self(Arc::new(Mutex::new(state)))
    }

    /// Writes what is left, and the file's end.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(&self) -> io::Result<()> {
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        state.write_group()?;
        match state.writer.take() {
            Some(writer) => writer.close().map(|_| ()).map_err(failed),
            None => Ok(()),
        }
    }
}

impl Write for ParquetRows {
    /// Takes whole rows.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut rows = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes);
        let mut row = csv::ByteRecord::new();
        while rows.read_byte_record(&mut row)? {
            if state.writer.is_none() {
                state.start(&row)?;
            } else {
                state.row(&row)?;
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
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

impl State {
    /// Starts the file with the names in its header.
    fn start(&mut self, names: &csv::ByteRecord) -> io::Result<()> {
        let Some(out) = self.out.take() else { return Err(io::Error::other("the file has ended")) };
        let mut properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(format!("rackmesh {}", env!("CARGO_PKG_VERSION")));
        let mut fields = Vec::new();
        for (name, kind) in names.iter().zip(&self.kinds) {
            let name = String::from_utf8_lossy(name).into_owned();
            let (physical, logical) = match kind {
                ColumnKind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
                ColumnKind::Number => (Physical::DOUBLE, None),
                ColumnKind::Flag => (Physical::BOOLEAN, None),
            };
            let field = Type::primitive_type_builder(&name, physical)
                .with_repetition(Repetition::OPTIONAL)
                .with_logical_type(logical)
                .build();
            fields.push(Arc::new(field.map_err(failed)?));
            if *kind == ColumnKind::Number {
                // hardly any two numbers are the same
                properties = properties.set_column_dictionary_enabled(ColumnPath::from(vec![name]), false);
            }
            let values = match kind {
                ColumnKind::Text => Values::Text(Vec::new()),
                ColumnKind::Number => Values::Number(Vec::new()),
                ColumnKind::Flag => Values::Flag(Vec::new()),
            };
            self.columns.push(Column { values, levels: Vec::new() });
        }
        let schema = Type::group_type_builder("parts").with_fields(fields).build().map_err(failed)?;
        let writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties.build())).map_err(failed)?;
        self.writer = Some(writer);
        Ok(())
    }

    fn row(&mut self, row: &csv::ByteRecord) -> io::Result<()> {
        for (cell, column) in row.iter().zip(&mut self.columns) {
            if cell.is_empty() {
                column.levels.push(0);
                continue;
            }
            column.levels.push(1);
            let text = String::from_utf8_lossy(cell);
            let unread = || io::Error::other(format!("`{text}` is no result"));
            match &mut column.values {
                Values::Text(values) => values.push(ByteArray::from(text.as_ref())),
                Values::Number(values) => values.push(text.parse().map_err(|_| unread())?),
                Values::Flag(values) => values.push(text.parse().map_err(|_| unread())?),
            }
        }
        self.rows += 1;
        if self.rows == GROUP { self.write_group() } else { Ok(()) }
    }

    fn write_group(&mut self) -> io::Result<()> {
        let Some(writer) = self.writer.as_mut().filter(|_| self.rows > 0) else { return Ok(()) };
        let mut group = writer.next_row_group().map_err(failed)?;
        for column in &mut self.columns {
            let Some(mut open) = group.next_column().map_err(failed)? else { break };
            let levels = Some(column.levels.as_slice());
            let written = match &mut column.values {
                Values::Text(values) => {
                    let written = open.typed::<ByteArrayType>().write_batch(values, levels, None);
                    values.clear();
                    written
                }
                Values::Number(values) => {
                    let written = open.typed::<DoubleType>().write_batch(values, levels, None);
                    values.clear();
                    written
                }
                Values::Flag(values) => {
                    let written = open.typed::<BoolType>().write_batch(values, levels, None);
                    values.clear();
                    written
                }
            };
            written.map_err(failed)?;
            column.levels.clear();
            open.close().map_err(failed)?;
        }
        group.close().map_err(failed)?;
        self.rows = 0;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use ::parquet::file::reader::{FileReader as _, SerializedFileReader};
    use ::parquet::record::Field;

    use super::*;

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
    fn what_is_read_back_is_what_the_csv_says() {
        let kinds = vec![ColumnKind::Text, ColumnKind::Number, ColumnKind::Flag, ColumnKind::Text];
        let memory = Memory::default();
        let mut rows = ParquetRows::new(Box::new(memory.clone()), kinds);
        let mut expected = Vec::new();
        rows.write_all(b"part_id,rss_mm,linear,verdict\n").unwrap();
        let parts = GROUP + 100;
        for part in 0..parts {
            let number = format!("{}0.{part:06}", if part % 2 == 0 { "-" } else { "" });
            let verdict = ["pass", "fail", ""][part % 3];
            let id = if part == 7 { "\"P,\n7\"".to_owned() } else { format!("P{part}") };
            rows.write_all(format!("{id},{number},{},{verdict}\n", part % 5 == 0).as_bytes()).unwrap();
            expected.push((id.trim_matches('"').to_owned(), number.parse::<f64>().unwrap(), part % 5 == 0, verdict));
        }
        rows.finish().unwrap();
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
