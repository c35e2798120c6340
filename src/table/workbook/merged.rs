//! Merged cells of a sheet: their value counts for all of their rows, and they may hide no other value. Asked for each cell while rows
//! are read.

use std::collections::BTreeMap;

use super::range::CellRange;
use crate::table::cell::Cell;

/// Rows that all merged cells of a sheet together may have, at most.
const MOST_ROWS: u64 = 1 << 22;

/// The merged cells of a sheet.
#[derive(Debug, Clone, Default)]
pub(super) struct MergedCells {
    /// All of them; once reading begins, sorted by their first row, the last one first.
    ranges: Vec<CellRange>,
    /// How many rows all of them have.
    rows: u64,
    /// Those of the row that is being read, by their first column, with their value.
    open: BTreeMap<u32, (CellRange, Cell)>,
}

impl MergedCells {
    /// Adds a range of merged cells.
    pub(super) fn add(&mut self, range: CellRange) {
        self.rows += 1 + u64::from(range.rows.1 - range.rows.0);
        if self.rows <= MOST_ROWS {
            self.ranges.push(range);
        }
    }

    /// Prepares for the first row of a sheet.
    ///
    /// # Errors
    /// If the merged cells have too many rows.
    pub(super) fn begin(&mut self) -> Result<(), String> {
        self.ranges.sort_by_key(|range| std::cmp::Reverse(range.rows.0));
        let is_small = self.rows <= MOST_ROWS;
        is_small.then_some(()).ok_or_else(|| format!("its merged cells have more than {MOST_ROWS} rows"))
    }

    /// Notes a cell that is not empty.
    ///
    /// # Errors
    /// If merged cells hide it.
    pub(super) fn take(&mut self, row: u32, column: u32, cell: &Cell) -> Result<(), String> {
        while let Some(range) = self.ranges.pop_if(|range| range.rows.0 <= row) {
            self.open.insert(range.columns.0, (range, Cell::default()));
        }
        let open = self.open.range_mut(..=column).next_back();
        let Some((_, (range, value))) = open.filter(|(_, (range, _))| range.has_row(row) && range.has_column(column))
        else {
            return Ok(());
        };
        if (range.rows.0, range.columns.0) != (row, column) {
            return Err(format!("row {}: `{}` stands below the merged cells {range}", row + 1, cell.text()));
        }
        value.clone_from(cell);
        Ok(())
    }

    /// Puts the values of merged cells into the empty cells of a row. `first` is the column of the row's first cell.
    pub(super) fn fill(&mut self, row: u32, first: u32, cells: &mut Vec<Cell>) {
        for (range, value) in self.open.values().filter(|(range, _)| range.has_row(row)) {
            let Some(place) = range.columns.0.checked_sub(first).filter(|_| !value.is_empty()) else { continue };
            let place = place as usize;
            cells.resize(cells.len().max(place + 1), Cell::default());
            if cells[place].is_empty() {
                cells[place] = value.clone();
            }
        }
        self.open.retain(|_, (range, _)| range.rows.1 > row);
    }
}
