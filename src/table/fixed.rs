//! Text of aligned columns: finds which cells of a line are empty from where the others stand. Called by [`grid`](super::grid).

use std::ops::Range;

use unicode_width::UnicodeWidthStr;

use super::cell::{Cell, Record};

/// Where the cells of a line stand, in columns of a terminal. The first byte of the line is at `start`.
pub(crate) fn extents(start: usize, cells: &[Cell]) -> Vec<Range<usize>> {
    // bytes before a cell in excess of its columns: characters of several bytes
    let mut hidden = 0;
    let extent = |cell: &Cell| {
        let text = cell.text();
        let from = cell.span.start.saturating_sub(start + hidden);
        hidden += text.len().saturating_sub(text.width());
        from..from + text.width()
    };
    cells.iter().map(extent).collect()
}

/// The records with an empty cell where a line has a gap. The cells that stand below each other tell the columns of a block of
/// lines; where they do not, its records stay as they are.
pub(super) fn placed(mut records: Vec<Record>) -> Vec<Record> {
    // headings and the rows below them may be a blank line apart
    let follows = |one: &Record, next: &Record| next.line <= one.line + 1 + u64::from(one.numbers() == 0);
    for block in records.chunk_by_mut(follows) {
        let is_header = |record: &&Record| record.numbers() == 0 && record.cells.len() > 1;
        let widest = block.iter().filter(is_header).map(|record| record.cells.len()).max();
        let Some(header) = block.iter().position(|record| is_header(&record) && Some(record.cells.len()) == widest)
        else {
            continue;
        };
        let (above, rows) = block.split_at_mut(header + 1);
        let mut rows: Vec<&mut Record> = rows.iter_mut().filter(|record| record.numbers() > 0).collect();
        place(&above[header], &mut rows);
    }
    records
}

/// Puts the cells of rows into columns. The columns are those of the rows, or else of the rows and the header together. Where there
/// are not as many as the header has cells, the rows stay as they are.
fn place(header: &Record, rows: &mut [&mut Record]) {
    let width = header.cells.len();
    if rows.iter().all(|row| row.cells.len() >= width) {
        return;
    }
    let extents_of = |record: &Record| extents(record.start, &record.cells);
    let of_rows: Vec<Vec<Range<usize>>> = rows.iter().map(|row| extents_of(row)).collect();
    let is_one_each = |columns: &Vec<Range<usize>>| {
        let places = |row: &Vec<Range<usize>>| row.iter().map(|cell| place_of(cell, columns)).collect::<Vec<_>>();
        columns.len() == width
            && of_rows.iter().map(places).all(|places| places.windows(2).all(|pair| pair[0] != pair[1]))
    };
    let with_header = || columns(of_rows.iter().flatten().cloned().chain(extents_of(header)).collect());
    // a row without a gap tells the columns, wherever the headings stand above them
    let has_whole = rows.iter().any(|row| row.cells.len() == width);
    let alone = Some(columns(of_rows.iter().flatten().cloned().collect())).filter(|_| has_whole).filter(is_one_each);
    let Some(columns) = alone.or_else(|| Some(with_header()).filter(is_one_each)) else { return };
    for (row, extents) in rows.iter_mut().zip(&of_rows) {
        let mut cells = vec![Cell::default(); width];
        for (cell, extent) in std::mem::take(&mut row.cells).into_iter().zip(extents) {
            cells[place_of(extent, &columns)] = cell;
        }
        row.cells = cells;
    }
}

/// Joins extents that overlap.
fn columns(mut cells: Vec<Range<usize>>) -> Vec<Range<usize>> {
    cells.sort_by_key(|cell| cell.start);
    let mut columns: Vec<Range<usize>> = Vec::new();
    for cell in cells {
        match columns.last_mut().filter(|column| cell.start < column.end) {
            Some(column) => column.end = column.end.max(cell.end),
            None => columns.push(cell),
        }
    }
    columns
}

fn place_of(cell: &Range<usize>, columns: &[Range<usize>]) -> usize {
    columns.partition_point(|column| column.end <= cell.start)
}
