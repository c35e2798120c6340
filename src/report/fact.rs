//! Facts as programs read them: what serialises becomes a document of JSON, and rows of CSV are columns of its records.

use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::quantity::plain;

/// The version of the JSON that the program writes, its first key, `format_version`. It grows when a key goes or changes
/// its meaning, and stays when one comes.
pub const FORMAT_VERSION: u32 = 1;

/// A result as a document of JSON.
pub(crate) fn document(result: Value) -> Value {
    let mut document = Map::from_iter([("format_version".to_owned(), FORMAT_VERSION.into())]);
    if let Value::Object(result) = result {
        document.extend(result);
    }
    Value::Object(document)
}

/// The cells of CSV, header first: a row for each record below the key `records`, with what it has below each name, or
/// else the whole result has.
pub(super) fn rows(result: &Value, records: &str, names: &[impl AsRef<str>]) -> Vec<Vec<String>> {
    let header = names.iter().map(|name| name.as_ref().to_owned()).collect();
    let records = result.get(records).and_then(Value::as_array).into_iter().flatten();
    let row = |record: &Value| {
        let found = names.iter().map(|name| record.get(name.as_ref()).or_else(|| result.get(name.as_ref())));
        found.map(|value| value.map(cell).unwrap_or_default()).collect()
    };
    std::iter::once(header).chain(records.map(row)).collect()
}

/// The cells of CSV, header first, of records that have the same names; at least one is needed.
pub(super) fn rows_of(records: &[impl Serialize]) -> Vec<Vec<String>> {
    let records = json!(records);
    let first = records.get(0).and_then(Value::as_object).into_iter().flat_map(Map::keys);
    let names: Vec<_> = first.cloned().collect();
    rows(&json!({ "records": records }), "records", &names)
}

/// A value as the text of a cell: nothing where it is null.
fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => number.as_f64().map(plain).unwrap_or_default(),
        other => other.to_string(),
    }
}
