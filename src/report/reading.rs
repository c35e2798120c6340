//! How tables were read, as part of another report. Wraps the report of a result; computes nothing.

use serde_json::{Value, json};

use super::{Block, Column, Report, Table};
use crate::table::Reading;

/// A report, and how its tables were read.
pub struct WithReading<'a> {
    /// The result.
    pub report: &'a dyn Report,
    /// How each table was read.
    pub readings: &'a [Reading],
    /// Remarks on what was left out or assumed.
    pub notes: &'a [String],
}

/// The remarks on the reading that the user must know.
#[must_use]
pub fn remarks(readings: &[Reading], notes: &[String]) -> Vec<String> {
    let mut all: Vec<String> = notes.to_vec();
    super::add_new(&mut all, readings.iter().flat_map(Reading::remarks));
    all
}

/// How tables were read, with these remarks, a line each.
#[must_use]
pub fn said(readings: &[Reading], notes: &[String]) -> Vec<String> {
    readings.iter().map(ToString::to_string).chain(remarks(readings, notes)).collect()
}

/// How tables were read, for a page: the text's form, every column with its role, unit and nominal value, and what was
/// not used.
#[must_use]
pub fn reading_blocks(readings: &[Reading], notes: &[String]) -> Vec<Block> {
    let mut blocks = Vec::new();
    for reading in readings {
        blocks.extend([reading_form(reading), columns(reading)]);
    }
    blocks.extend(remarks(readings, notes).into_iter().map(Block::Remark));
    blocks
}

/// The separator, the decimal mark, and the line of names.
#[must_use]
pub fn reading_form(reading: &Reading) -> Block {
    let format = [Some(reading.format), reading.separator.as_deref(), reading.encoding.as_deref()];
    let mark = reading.decimal_mark.map(|mark| ("decimal mark".to_owned(), mark.to_owned()));
    let each = if reading.parts_in == "columns" { "a column" } else { "a row" };
    let asides = reading.asides.iter().map(|aside| format!("line {}: {}", aside.line, aside.text));
    let read_as = format.into_iter().flatten().collect::<Vec<_>>().join(", ");
    let rows = std::iter::once(("read as".to_owned(), read_as))
        .chain(mark)
        .chain(reading.header_line.map(|line| ("names".to_owned(), format!("line {line}"))))
        .chain([(format!("each {}", reading.unit_counted), each.to_owned())])
        .chain(asides.map(|aside| ("no part of it".to_owned(), aside)));
    Table::of(rows).text("table", |(what, _)| what.clone()).text(&reading.file, |(_, how)| how.clone()).block()
}

/// Every column, and the cells that were not used.
fn columns(reading: &Reading) -> Block {
    let used = reading.columns.iter().map(|column| {
        let unit = column.unit.clone().unwrap_or_default();
        let nominal = column.nominal.clone().unwrap_or_default();
        [&column.title, &column.role, &unit, column.holds.unwrap_or_default(), &nominal].map(str::to_owned)
    });
    let unused = reading
        .not_used
        .iter()
        .map(|unused| [&unused.title, &format!("not used: {}", unused.why), "", "", ""].map(str::to_owned));
    Block::Table(Table {
        rows: used.chain(unused).map(Vec::from).collect(),
        columns: ["column", "is", "unit", "holds", "nominal"].map(Column::text).into(),
    })
}

impl Report for WithReading<'_> {
    fn json(&self) -> Value {
        let mut json = self.report.json();
        let remarks = remarks(self.readings, self.notes);
        if let Value::Object(object) = &mut json {
            let mut notes = match object.get("notes") {
                Some(Value::Array(notes)) => notes.clone(),
                _ => Vec::new(),
            };
            notes.extend(remarks.into_iter().map(Value::from));
            object.insert("notes".to_owned(), notes.into());
            // the tables of parts and the tables that the spec names
            let mut readings = match object.get("reading") {
                Some(Value::Array(readings)) => readings.clone(),
                _ => Vec::new(),
            };
            readings.extend(self.readings.iter().map(|reading| json!(reading)));
            object.insert("reading".to_owned(), readings.into());
        }
        json
    }

    fn rows(&self) -> Vec<Vec<String>> {
        self.report.rows()
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = self.report.blocks();
        // the verdict stays last
        let end = blocks.iter().position(|block| matches!(block, Block::Verdict(..))).unwrap_or(blocks.len());
        let notes = remarks(self.readings, self.notes).into_iter().map(Block::Remark);
        blocks.splice(end..end, notes);
        blocks
    }
}
