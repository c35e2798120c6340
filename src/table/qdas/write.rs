//! Writes results as Q-DAS ASCII, for the statistics software that the measured values came from. Called by the reports
//! of `paste` and `batch`; opens no file.

use super::PartDefinition;
use crate::diagnostic::is_steering;

/// A characteristic to write.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CharacteristicColumn {
    /// K2001
    pub number: String,
    /// K2002
    pub name: String,
    /// K2142
    pub unit: String,
    /// K2101
    pub nominal: Option<f64>,
    /// K2110
    pub lower: Option<f64>,
    /// K2111
    pub upper: Option<f64>,
}

/// A part's values to write.
#[derive(Debug, Clone, PartialEq)]
pub struct ValueRow<'r> {
    /// K0014
    pub name: &'r str,
    /// One for each characteristic.
    pub values: Vec<Option<f64>>,
    /// K0009; empty if there is none.
    pub remark: &'r str,
}

/// The definitions of a `.dfq` file, with a remark on all parts (K1900) if there is one; [`row_lines`] follow for each
/// row. Latin-1, as the format's readers expect; characters beyond it become `?`.
#[must_use]
pub fn definition_lines(part: &PartDefinition, remark: &str, columns: &[CharacteristicColumn]) -> Vec<u8> {
    const DECIMALS: usize = 9;
    let mut out = String::new();
    let mut field = |key: &str, text: &str| push_field(&mut out, key, text);
    field("K0100", &columns.len().to_string());
    field("K1001/1", &part.number);
    field("K1002/1", &part.name);
    if !remark.is_empty() {
        field("K1900/1", remark);
    }
    for (index, column) in columns.iter().enumerate() {
        let mut field = |key: &str, text: &str| push_field(&mut out, &format!("{key}/{}", index + 1), text);
        field("K2001", &column.number);
        field("K2002", &column.name);
        field("K2022", &DECIMALS.to_string());
        for (key, value) in [("K2101", column.nominal), ("K2110", column.lower), ("K2111", column.upper)] {
            if let Some(value) = value {
                field(key, &value.to_string());
            }
        }
        field("K2120", if column.lower.is_some() { "1" } else { "0" });
        field("K2121", if column.upper.is_some() { "1" } else { "0" });
        field("K2142", &column.unit);
    }
    latin_1(&out)
}

/// The lines of a row, one of them its values. A value that is `None` or not finite is written as empty, with
/// attribute 255.
#[must_use]
pub fn row_lines(ValueRow { name, values, remark }: &ValueRow<'_>) -> Vec<u8> {
    let value = |value: &Option<f64>| match value.filter(|value| value.is_finite()) {
        Some(value) => format!("{value}\u{14}0"),
        None => "\u{14}255".to_owned(),
    };
    let mut out = values.iter().map(value).collect::<Vec<_>>().join("\u{f}") + "\r\n";
    push_field(&mut out, "K0014/0", name);
    if !remark.is_empty() {
        push_field(&mut out, "K0009/0", remark);
    }
    latin_1(&out)
}

fn latin_1(text: &str) -> Vec<u8> {
    text.chars().map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?')).collect()
}

fn push_field(out: &mut String, key: &str, text: &str) {
    // a line break would start a line of its own
    out.push_str(&format!("{key} {}\r\n", text.replace(is_steering, " ")));
}
