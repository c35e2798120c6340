//! Rows that are points of a measured curve: a stroke and ΔCD each.

use super::{Column, Field, Reading, Table};
use crate::deviation::DeviationValue;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::evaluation::REJECTED;
use crate::trace::TracePoint;

/// A measured curve.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    /// What messages call its table.
    pub name: String,
    /// Its points, the strokes rising.
    pub points: Vec<TracePoint>,
    /// How many rows have no value.
    pub without_value: u64,
    /// How it was read.
    pub reading: Reading,
}

impl Trace {
    /// Reads the rows of a table whose contract says that it is a measured curve.
    ///
    /// # Errors
    /// A column that is missing, a row that is no point, or fewer than two points.
    pub fn of_table(table: Table) -> Result<Self, Diagnostics> {
        let name = table.name.to_string();
        let bad = |message: String| Diagnostic::error(Code::BadTable, message);
        let place = |field: Field| {
            let found = table.columns.iter().position(|column: &Column| column.field == field);
            found.ok_or_else(|| {
                let key = field.key();
                bad(format!("{name} has no column of {key}"))
                    .help(format!("call it {key}, or say which it is: [table.columns] {key} = {{ name = \"…\" }}"))
            })
        };
        let places = [place(Field::Stroke)?, place(Field::DeltaCd)?];
        let reading = table.reading.clone();
        let titles: Vec<String> = table.columns.iter().map(|column| column.title.clone()).collect();
        let blocks = table.blocks().map_err(|error| Diagnostic::unreadable(&name, &error))?;
        let mut trace = Self { name: name.clone(), reading, ..Self::default() };
        for block in &blocks {
            if let Some(found) = &block.contradiction {
                return Err(found.of(&name).into());
            }
            let wrong = block.faults().iter().find(|fault| !fault.is_missing);
            if let Some(fault) = wrong {
                let column = fault.column.map(|column| format!(", column `{}`", titles[column])).unwrap_or_default();
                let message = format!("{name}, line {}{column}: {}", block.lines[fault.row], fault.message);
                return Err(bad(message).into());
            }
            if let Some(row) = block.failed.first() {
                return Err(bad(format!("{name}, line {}: {REJECTED}", block.lines[*row])).into());
            }
            block.tell(&mut trace.reading);
            let missing = block.rejected_rows();
            trace.without_value += missing.len() as u64;
            for row in (0..block.rows()).filter(|row| !missing.contains(row)) {
                let mm = |place: usize| match block.values(place).get(row) {
                    Some(DeviationValue::Length(length)) => Some(length.mm()),
                    _ => None,
                };
                if let [Some(stroke_mm), Some(delta_cd_mm)] = places.map(mm) {
                    trace.points.push(TracePoint { stroke_mm, delta_cd_mm });
                }
            }
        }
        trace.points.sort_by(|a, b| a.stroke_mm.total_cmp(&b.stroke_mm));
        match (trace.points.first(), trace.points.last()) {
            (Some(first), Some(last)) if first.stroke_mm < last.stroke_mm => Ok(trace),
            _ => Err(bad(format!("{name} has no two points at different strokes")).into()),
        }
    }
}
