//! Measurements whose cells are all there become a block: tables in which parts are columns, and blocks without names.

use super::block::{Block, line_of};
use super::cell::Cell;
use super::column::Column;
use super::rows::{put, start, take_index};
use super::understand::Understood;

/// The parts of an understood table.
pub(crate) fn gathered(understood: &Understood) -> Block {
    let Understood { shape, columns, .. } = understood;
    let mut block = Block::default();
    block.start_columns(columns.iter().map(Column::nothing));
    for (row, line) in shape.lines.iter().enumerate() {
        let series = shape.ids.iter().chain(shape.measurements.iter().map(|measurement| &measurement.value));
        let texts: Vec<_> = series.map(|series| series.cells.get(row).map(Cell::text).unwrap_or_default()).collect();
        let raw = block.append(&line_of(texts.iter()));
        block.record_count += 1;
        start(*line, raw, &mut block);
        if shape.ids.is_some() {
            let name = block.append(texts[0].as_bytes());
            block.names.push(name);
        }
        for (number, (measurement, column)) in shape.measurements.iter().zip(columns).enumerate() {
            let cell = measurement.value.cells.get(row).cloned().unwrap_or_default();
            let value = column.read(&cell, measurement.beside_row(row));
            put(&mut block, number, column, &cell, value);
        }
        if let Some(index) = &shape.index {
            take_index(&mut block, &index.cells.get(row).cloned().unwrap_or_default());
        }
    }
    block
}
