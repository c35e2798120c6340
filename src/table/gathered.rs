//! Measurements whose cells are all there become a block: tables in which parts are columns, and blocks without names.

use super::block::{Block, Span};
use super::rows::{put, take_index};
use super::understand::Understood;

/// The parts of an understood table.
pub(crate) fn gathered(understood: &Understood) -> Block {
    let Understood { shape, columns, .. } = understood;
    let mut block = Block::default();
    block.values.resize_with(columns.len(), Vec::new);
    for (row, line) in shape.lines.iter().enumerate() {
        block.record_count += 1;
        block.lines.push(*line);
        block.records.push(block.record_count);
        let mut raw = Vec::new();
        if let Some(ids) = &shape.ids {
            let name = ids.cells.get(row).map(|cell| cell.text().into_owned()).unwrap_or_default();
            let span = block.append(name.as_bytes());
            block.names.push(span);
            raw.push(name);
        }
        for (number, (measurement, column)) in shape.measurements.iter().zip(columns).enumerate() {
            let cell = measurement.value.cells.get(row).cloned().unwrap_or_default();
            let value = column.read(&cell, measurement.beside_row(row));
            put(&mut block, number, column, &cell, value);
            raw.push(cell.text().into_owned());
        }
        if let Some(index) = &shape.index {
            take_index(&mut block, index.cells.get(row));
        }
        let line = super::block::line_of(raw.iter().map(String::as_str));
        let span: Span = block.append(&line);
        block.raw.push(span);
    }
    block
}
