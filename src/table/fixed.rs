//! Text of aligned columns: finds which cells of a line are empty from where the others stand. Called by [`grid`](super::grid).

use std::ops::Range;

use unicode_width::UnicodeWidthStr;

use super::cell::{Cell, Record};

/// Cells between runs of two or more blanks, each with the place of its first byte in the line.
pub(super) fn aligned(line: &str) -> Vec<(usize, Cell)> {
    let line = line.trim_end();
    let mut cells = Vec::new();
    let mut start = line.len() - line.trim_start().len();
    while start < line.len() {
        let end = line[start..].find("  ").map_or(line.len(), |length| start + length);
        cells.push((start, Cell::of_text(&line[start..end])));
        start = line.len() - line[end..].trim_start().len();
    }
    cells
}

/// Where the cells of a line stand, in columns of a terminal.
fn extents_of(line: &str) -> Vec<Range<usize>> {
    // bytes before a cell in excess of its columns: characters of several bytes
    let mut hidden = 0;
    let extent = |(start, cell): &(usize, Cell)| {
        let text = cell.text();
        let from = start.saturating_sub(hidden);
        hidden += text.len().saturating_sub(text.width());
        from..from + text.width()
    };
    aligned(line).iter().map(extent).collect()
}

/// The records with an empty cell where a line has a gap. The cells that stand below each other tell the columns of a block of
/// lines; where they do not, its records stay as they are. `lines` are those of the records.
pub(super) fn placed(mut records: Vec<Record>, mut lines: &[&str]) -> Vec<Record> {
    // headings and the rows below them may be a blank line apart
    let follows = |one: &Record, next: &Record| next.line <= one.line + 1 + u64::from(one.numbers() == 0);
    for block in records.chunk_by_mut(follows) {
        let (own, behind) = lines.split_at(block.len());
        lines = behind;
        let is_header = |record: &&Record| record.numbers() == 0 && record.cells.len() > 1;
        let widest = block.iter().filter(is_header).map(|record| record.cells.len()).max();
        let Some(header) = block.iter().position(|record| is_header(&record) && Some(record.cells.len()) == widest)
        else {
            continue;
        };
        let (above, rows) = block.split_at_mut(header + 1);
        let rows = rows.iter_mut().zip(&own[header + 1..]).filter(|(record, _)| record.numbers() > 0);
        place((&above[header], own[header]), &mut rows.map(|(row, line)| (row, *line)).collect::<Vec<_>>());
    }
    records
}

/// Puts the cells of rows into columns. The columns are those of the rows, or else of the rows and the header together. Where there
/// are not as many as the header has cells, the rows stay as they are.
fn place((header, of_header): (&Record, &str), rows: &mut [(&mut Record, &str)]) {
    let width = header.cells.len();
    if rows.iter().all(|(row, _)| row.cells.len() >= width) {
        return;
    }
    let of_rows = || rows.iter().map(|(_, line)| extents_of(line));
    let is_one_each = |columns: &Vec<Range<usize>>| {
        let places = |row: Vec<Range<usize>>| row.iter().map(|cell| place_of(cell, columns)).collect::<Vec<_>>();
        columns.len() == width && of_rows().map(places).all(|places| places.windows(2).all(|pair| pair[0] != pair[1]))
    };
    let with_header = || columns(of_rows().flatten().chain(extents_of(of_header)));
    // a row without a gap tells the columns, wherever the headings stand above them
    let has_whole = rows.iter().any(|(row, _)| row.cells.len() == width);
    let alone = Some(columns(of_rows().flatten())).filter(|_| has_whole).filter(is_one_each);
    let Some(columns) = alone.or_else(|| Some(with_header()).filter(is_one_each)) else { return };
    for (row, line) in rows {
        let mut cells = vec![Cell::default(); width];
        for (cell, extent) in row.cells.iter().zip(extents_of(line)) {
            cells[place_of(&extent, &columns)] = cell.clone();
        }
        row.cells = cells.into();
    }
}

/// Joins extents that overlap.
fn columns(cells: impl Iterator<Item = Range<usize>>) -> Vec<Range<usize>> {
    let mut columns: Vec<Range<usize>> = Vec::new();
    for cell in cells {
        let first = place_of(&cell, &columns);
        let overlapping = columns[first..].iter().take_while(|column| column.start < cell.end).count();
        let joined = columns.drain(first..first + overlapping);
        let joined = joined.fold(cell, |cell, column| cell.start.min(column.start)..cell.end.max(column.end));
        columns.insert(first, joined);
    }
    columns
}

fn place_of(cell: &Range<usize>, columns: &[Range<usize>]) -> usize {
    columns.partition_point(|column| column.end <= cell.start)
}
