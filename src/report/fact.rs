//! Facts for programs: serialised values become a document of JSON, and rows of CSV are columns of its records.

use serde_json::{Map, Value};

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

/// The cells of CSV, header first: a row for each record below the key `records`, with what it has below each of the
/// `names`, which blanks part, or else the whole result has. Where a value stands at another place than its name says,
/// that place follows: `pp=pp/value`.
pub(super) fn rows(result: &Value, records: &str, names: &str) -> Vec<Vec<String>> {
    let columns = names.split_whitespace().map(|name| name.split_once('=').unwrap_or((name, name)));
    let (header, places): (Vec<_>, Vec<_>) =
        columns.map(|(name, place)| (name.to_owned(), format!("/{place}"))).unzip();
    let records = result.get(records).and_then(Value::as_array).into_iter().flatten();
    let row = |record: &Value| {
        let found = places.iter().map(|place| record.pointer(place).or_else(|| result.pointer(place)));
        found.map(|value| value.map(cell).unwrap_or_default()).collect()
    };
    std::iter::once(header).chain(records.map(row)).collect()
}

/// The value at a place of a result, such as `contributions/rack_pitch/delta_cd_mm`: an element of a list is called by its first
/// text.
#[cfg(feature = "cli")]
pub(crate) fn at<'v>(result: &'v Value, place: &str) -> Option<&'v Value> {
    place.split('/').try_fold(result, |value, name| match value {
        Value::Array(elements) => elements.iter().find(|element| element_name(element) == Some(name)),
        value => value.get(name),
    })
}

/// The name of an element of a list: its first text.
#[cfg(feature = "cli")]
pub(crate) fn element_name(element: &Value) -> Option<&str> {
    element.as_object()?.values().find_map(Value::as_str)
}

/// A value as the text of a cell; empty for null.
fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => number.as_f64().map(plain).unwrap_or_default(),
        other => other.to_string(),
    }
}
