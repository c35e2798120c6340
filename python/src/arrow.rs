//! Arrow arrays as stored columns, numbers without a copy, and results as a record batch.

use std::sync::Arc;

use arrow_array::cast::AsArray as _;
use arrow_array::types::{
    ArrowPrimitiveType, Decimal32Type, Decimal64Type, Decimal128Type, Float32Type, Float64Type, Int8Type, Int16Type,
    Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, BooleanArray, Float64Array, RecordBatch, StringArray};
use arrow_buffer::{Buffer, NullBuffer, OffsetBuffer, ToByteSlice as _};
use arrow_cast::cast;
use arrow_cast::display::{ArrayFormatter, FormatOptions};
use arrow_schema::{ArrowError, DataType, Field, Schema};
use bytes::Bytes;
use rackmesh::batch::{ColumnEvaluator, ColumnKind, ResultColumns, ResultValues};
use rackmesh::table::Stored;

/// An array of a type that stored columns have: dictionaries and views are cast to their values.
pub(crate) fn plain(array: &ArrayRef) -> Result<ArrayRef, ArrowError> {
    match array.data_type() {
        DataType::Dictionary(_, values) => plain(&cast(array, values)?),
        DataType::RunEndEncoded(_, values) => plain(&cast(array, values.data_type())?),
        DataType::Utf8View => cast(array, &DataType::LargeUtf8),
        DataType::Float16 => cast(array, &DataType::Float32),
        _ => Ok(Arc::clone(array)),
    }
}

/// A plain array as a stored column; `None` for a type that holds no measurement.
pub(crate) fn stored(array: &ArrayRef) -> Option<Stored<'_>> {
    let column = match array.data_type() {
        DataType::Float64 => Stored::doubles(&array.as_primitive::<Float64Type>().values()[..]),
        DataType::Float32 => Stored::singles(&array.as_primitive::<Float32Type>().values()[..]),
        DataType::Int64 => Stored::integers(&array.as_primitive::<Int64Type>().values()[..], 0),
        DataType::Int32 => integers::<Int32Type>(array, 0),
        DataType::Int16 => integers::<Int16Type>(array, 0),
        DataType::Int8 => integers::<Int8Type>(array, 0),
        DataType::UInt32 => integers::<UInt32Type>(array, 0),
        DataType::UInt16 => integers::<UInt16Type>(array, 0),
        DataType::UInt8 => integers::<UInt8Type>(array, 0),
        DataType::UInt64 => {
            Stored::long_integers(array.as_primitive::<UInt64Type>().values().iter().map(|value| i128::from(*value)), 0)
        }
        DataType::Decimal32(_, scale) => integers::<Decimal32Type>(array, i32::from(*scale)),
        DataType::Decimal64(_, scale) => {
            Stored::integers(&array.as_primitive::<Decimal64Type>().values()[..], i32::from(*scale))
        }
        DataType::Decimal128(_, scale) => {
            let values = array.as_primitive::<Decimal128Type>().values();
            Stored::long_integers(values.iter().copied(), i32::from(*scale))
        }
        DataType::Utf8 => {
            let texts = array.as_string::<i32>();
            texts_of(texts.value_data(), texts.value_offsets())
        }
        DataType::LargeUtf8 => {
            let texts = array.as_string::<i64>();
            texts_of(texts.value_data(), texts.value_offsets())
        }
        DataType::Null => Stored::doubles(vec![0.0; array.len()]).with_values_where(vec![false; array.len()]),
        DataType::Boolean
        | DataType::Date32
        | DataType::Date64
        | DataType::Time32(_)
        | DataType::Time64(_)
        | DataType::Timestamp(..) => {
            let formatter = ArrayFormatter::try_new(array.as_ref(), &FormatOptions::default()).ok()?;
            Stored::others((0..array.len()).map(|row| formatter.value(row).to_string()).collect::<Vec<_>>())
        }
        _ => return None,
    };
    Some(match array.nulls().filter(|nulls| nulls.null_count() > 0) {
        Some(nulls) => column.with_values_where(nulls.iter().collect::<Vec<_>>()),
        None => column,
    })
}

fn integers<T: ArrowPrimitiveType>(array: &ArrayRef, scale: i32) -> Stored<'_>
where
    i64: From<T::Native>,
{
    let values = array.as_primitive::<T>().values();
    Stored::integers(values.iter().map(|value| i64::from(*value)).collect::<Vec<_>>(), scale)
}

/// Texts that begin and end at these places of `all`, which may also hold the texts of other rows.
fn texts_of<'a, O: Copy + TryInto<usize>>(all: &'a [u8], offsets: &[O]) -> Stored<'a> {
    // offsets of an array are never negative
    let place = |offset: &O| (*offset).try_into().unwrap_or(0);
    let (first, last) = (offsets.first().map_or(0, place), offsets.last().map_or(0, place));
    Stored::texts(&all[first..last], offsets.iter().map(|offset| place(offset) - first).collect())
}

/// The schema of results.
pub(crate) fn schema(columns: &[(String, ColumnKind)]) -> Schema {
    let field = |(name, kind): &(String, ColumnKind)| {
        let kind = match kind {
            ColumnKind::Number => DataType::Float64,
            ColumnKind::Flag => DataType::Boolean,
            _ => DataType::Utf8,
        };
        Field::new(name, kind, true)
    };
    Schema::new(columns.iter().map(field).collect::<Vec<_>>())
}

/// Results that arrays of Python hold; once the last is gone, the evaluator that made them takes them back, if there is one.
struct Lent {
    results: ResultColumns,
    evaluator: Option<Arc<ColumnEvaluator>>,
}

impl Drop for Lent {
    fn drop(&mut self) {
        if let Some(evaluator) = &self.evaluator {
            evaluator.take_back(std::mem::take(&mut self.results));
        }
    }
}

/// The bytes of a column of lent results: its values, or where its texts end.
struct Part {
    lent: Arc<Lent>,
    column: usize,
    is_ends: bool,
}

impl AsRef<[u8]> for Part {
    fn as_ref(&self) -> &[u8] {
        match &self.lent.results.columns[self.column].values {
            ResultValues::Numbers(values) => values.to_byte_slice(),
            ResultValues::Texts { ends, .. } if self.is_ends => ends.to_byte_slice(),
            ResultValues::Texts { bytes, .. } => bytes,
            _ => &[],
        }
    }
}

/// Results as a record batch. Their memory goes back to the evaluator that made them, if there is one.
pub(crate) fn batch(
    columns: &[(String, ColumnKind)],
    results: ResultColumns,
    evaluator: Option<Arc<ColumnEvaluator>>,
) -> Result<RecordBatch, ArrowError> {
    let lent = Arc::new(Lent { results, evaluator });
    let buffer = |column: usize, is_ends: bool| {
        Buffer::from(Bytes::from_owner(Part { lent: Arc::clone(&lent), column, is_ends }))
    };
    let mut arrays: Vec<ArrayRef> = Vec::with_capacity(columns.len());
    for (index, column) in lent.results.columns.iter().enumerate() {
        let nulls = column.has_value.as_deref().map(NullBuffer::from).filter(|nulls| nulls.null_count() > 0);
        arrays.push(match &column.values {
            ResultValues::Numbers(_) => Arc::new(Float64Array::try_new(buffer(index, false).into(), nulls)?),
            ResultValues::Flags(values) => Arc::new(BooleanArray::new(values.as_slice().into(), nulls)),
            ResultValues::Texts { .. } => {
                let offsets = OffsetBuffer::new(buffer(index, true).into());
                Arc::new(StringArray::try_new(offsets, buffer(index, false), nulls)?)
            }
            _ => return Err(ArrowError::NotYetImplemented("a kind of results".to_owned())),
        });
    }
    RecordBatch::try_new(Arc::new(schema(columns)), arrays)
}
