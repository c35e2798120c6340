//! The same parts in every kind of file give the same answers.

use std::cell::Cell as Counter;

use proptest::prelude::*;
use proptest::sample::select;
use rackmesh::table::Want;

use super::file::{Code, Dialect, Figures, Stored, dialect, figures, is_ambiguous, parquet, qdas, workbook};
use super::grid::{Design, Grid, Shape, Units, design};
use super::parts::{NominalIn, Parts, parts};
use super::{check, failed, read};

/// Whether the values of a table are those of the parts, in their order.
fn compare(parts: &Parts, order: &[usize], bytes: &[u8], want: &Want) -> Result<(), String> {
    let values = read::values(bytes, want)?;
    if !values.faults.is_empty() || values.rows != order.len() {
        return Err(format!("{} rows, faults {:?}: {}", values.rows, values.faults, values.reading));
    }
    for error in &parts.errors {
        let expected: Vec<_> = order.iter().map(|part| error.expected(*part)).collect();
        if values.of(error.kind) != Some(&expected) {
            return Err(format!("{}: {:?}, not {expected:?}: {}", error.kind, values.of(error.kind), values.reading));
        }
    }
    Ok(())
}

/// The same, with the names of the parts, and through the batch with as many workers.
pub fn compare_judged(parts: &Parts, order: &[usize], bytes: &[u8], workers: usize) -> Result<read::Judged, String> {
    let spec = read::spec(&parts.spec("50", false));
    compare(parts, order, bytes, &spec.want())?;
    let judged = read::judge(bytes, &spec, workers)?;
    if !judged.passes() {
        return Err(format!("it does not pass: {:?} {:?}", judged.outcome.counts, judged.outcome.problems));
    }
    let names: Vec<_> = judged.verdicts.iter().map(|verdict| verdict.name.as_str()).collect();
    let expected: Vec<_> = order.iter().filter_map(|part| parts.names.get(*part)).map(String::as_str).collect();
    if !expected.is_empty() && names != expected {
        return Err(format!("{names:?}, not {expected:?}"));
    }
    Ok(judged)
}

/// Counts the tables that are read and those that may be refused.
#[derive(Default)]
struct Tally {
    read: Counter<u32>,
    refused: Counter<u32>,
}

impl Tally {
    /// Takes the comparison of a table, which may be refused if nothing tells its decimal mark.
    fn take<T>(&self, found: Result<T, String>, is_ambiguous: bool, text: &str) -> Result<(), TestCaseError> {
        match found {
            Ok(_) => self.read.set(self.read.get() + 1),
            Err(_) if is_ambiguous => self.refused.set(self.refused.get() + 1),
            Err(problem) => return Err(failed(&problem, text)),
        }
        Ok(())
    }

    /// Of 20 tables at least 19 are read.
    fn check(&self) {
        let (read, refused) = (self.read.get(), self.refused.get());
        assert!(refused * 19 <= read, "{read} tables are read and {refused} refused");
    }
}

#[test]
fn texts_in_every_dialect() {
    let tally = Tally::default();
    check(160, (parts(), design(), dialect()), |(parts, design, dialect)| {
        let grid = Grid::new(&parts, &design);
        let found = compare_judged(&parts, &grid.order, &dialect.file(&grid), 2);
        tally.take(found, is_ambiguous(&grid, dialect.figures), &dialect.text(&grid))
    });
    tally.check();
}

#[test]
fn workbooks() {
    let tally = Tally::default();
    let texts = proptest::option::of(figures());
    check(60, (parts(), design(), texts, 0..4_u16), |(parts, design, texts, margin)| {
        let grid = Grid::new(&parts, &design);
        let figures = texts.unwrap_or(Figures::PLAIN);
        let found = compare_judged(&parts, &grid.order, &workbook(&grid, texts, margin), 2);
        tally.take(found, is_ambiguous(&grid, figures), &Dialect { figures, ..Dialect::PLAIN }.text(&grid))
    });
    tally.check();
}

#[test]
fn parquet_files() {
    let tally = Tally::default();
    let stored = select(vec![Stored::Double, Stored::Decimal, Stored::Text]);
    check(60, (parts(), design(), stored), |(parts, design, stored)| {
        // a column has one name, and its values one type
        let units = if design.units == Units::Apart { Units::Cells } else { design.units };
        let grid = Grid::new(&parts, &Design { shape: Shape::Rows, units, ..design });
        let found = compare_judged(&parts, &grid.order, &parquet(&grid, stored), 2);
        tally.take(found, is_ambiguous(&grid, Figures::PLAIN), &Dialect::PLAIN.text(&grid))
    });
    tally.check();
}

#[test]
fn qdas_files() {
    let code = select(vec![Code::Utf8, Code::Utf8Mark, Code::Windows1252, Code::Utf16Little]);
    check(60, (parts(), select(vec!['.', ',']), any::<bool>(), code), |(mut parts, mark, is_binary, code)| {
        // such a file has no columns beside the values
        for nominal in parts.errors.iter_mut().filter_map(|error| error.nominal.as_mut()) {
            nominal.stands_in = NominalIn::Spec;
        }
        let text = qdas(&parts, mark, is_binary);
        let order: Vec<_> = (0..parts.count).collect();
        compare_judged(&parts, &order, &code.bytes(&text), 2).map_err(|problem| failed(&problem, &text))?;
        Ok(())
    });
}

/// The rows of a table again and again, until it is read as a stream.
pub fn repeated(grid: &Grid) -> Grid {
    const LONG: usize = 150_000;
    let rows = &grid.cells[grid.first..grid.first + grid.order.len()];
    let length: usize = rows.iter().flatten().map(|cell| Figures::PLAIN.cell(cell).len() + 1).sum();
    let times = LONG / length + 1;
    let mut long = grid.clone();
    long.cells.truncate(grid.first);
    long.cells.extend(rows.iter().cloned().cycle().take(rows.len() * times));
    long.order = grid.order.iter().copied().cycle().take(rows.len() * times).collect();
    long
}

#[test]
fn long_tables_and_any_number_of_workers() {
    check(6, (parts(), design(), dialect()), |(parts, design, dialect)| {
        let grid = Grid::new(&parts, &Design { shape: Shape::Rows, mean: false, ..design });
        if is_ambiguous(&grid, dialect.figures) {
            return Ok(());
        }
        let text = dialect.text(&grid);
        let short = compare_judged(&parts, &grid.order, &dialect.file(&grid), 1);
        short.map_err(|problem| failed(&problem, &text))?;
        let long = repeated(&grid);
        let mut rows = Vec::new();
        for workers in [1, 3] {
            let judged = compare_judged(&parts, &long.order, &dialect.file(&long), workers);
            rows.push(judged.map_err(|problem| failed(&problem, &text))?.rows);
        }
        prop_assert_eq!(&rows[0], &rows[1]);
        Ok(())
    });
}
