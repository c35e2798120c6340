//! Tables in which something is not what it should be: nothing passes that was not understood.

use proptest::prelude::*;
use proptest::sample::{Index, select};
use rackmesh::deviation::DeviationKind;

use super::file::{Between, Code, Dialect, Figures, dialect, is_ambiguous, packed, workbook};
use super::grid::{Cell, Design, Grid, Heading, Holds, Shape, design};
use super::parts::{NominalIn, Parts, parts};
use super::words::{ANGLES, LENGTHS};
use super::{check, failed, read};

/// A limit that every generated part keeps.
const WIDE: &str = "50";

impl Grid {
    fn text(&self, heading: Heading) -> String {
        Figures::PLAIN.cell(&self.cells[heading.row][heading.column])
    }

    fn set(&mut self, heading: Heading, text: String) {
        self.cells[heading.row][heading.column] = if text.is_empty() { Cell::Empty } else { Cell::Text(text) };
    }

    /// Puts a copy of a column in, or of a line where errors are lines.
    fn copy(&mut self, heading: Heading, to: Index) {
        if self.shape == Shape::Rows {
            let to = to.index(self.cells[0].len() + 1);
            for row in &mut self.cells {
                row.insert(to, row[heading.column].clone());
            }
        } else {
            let to = heading.row + to.index(self.cells.len() - heading.row) + 1;
            self.cells.insert(to, self.cells[heading.row].clone());
        }
    }

    /// Where the copy of a heading stands.
    fn of_copy(&self, heading: Heading, to: Index) -> Heading {
        if self.shape == Shape::Rows {
            Heading { column: to.index(self.cells[0].len()), ..heading }
        } else {
            Heading { row: heading.row + to.index(self.cells.len() - 1 - heading.row) + 1, ..heading }
        }
    }
}

/// How a name is changed.
#[derive(Debug, Clone)]
enum Rename {
    Far(String),
    /// One letter is left out, doubled, or changes places with the next.
    Near(Index, u8),
    Empty,
}

fn rename() -> impl Strategy<Value = Rename> {
    prop_oneof![
        "[a-z]{2,9}( [a-z]{1,7})?".prop_map(Rename::Far),
        "[A-ZÄÖÜ][a-zäöüß]{2,12}(abweichung|maß|fehler)?( [0-9])?".prop_map(Rename::Far),
        select(vec!["Temperatur", "Remark", "Ist", "2", "X1", "P7", "Soll", "測定", "value"])
            .prop_map(|name| Rename::Far(name.to_owned())),
        (any::<Index>(), 0..3_u8).prop_map(|(at, how)| Rename::Near(at, how)),
        (any::<Index>(), 0..3_u8).prop_map(|(at, how)| Rename::Near(at, how)),
        Just(Rename::Empty),
    ]
}

impl Rename {
    fn name(&self, known: &str) -> String {
        match self {
            Self::Far(name) => name.clone(),
            Self::Empty => String::new(),
            Self::Near(at, how) => {
                let mut letters: Vec<char> = known.chars().collect();
                let at = at.index(letters.len());
                match how {
                    0 => drop(letters.remove(at)),
                    1 => letters.insert(at, letters[at]),
                    _ => letters.swap(at, (at + 1) % known.chars().count()),
                }
                letters.into_iter().collect()
            }
        }
    }
}

/// A heading that is changed.
#[derive(Debug, Clone)]
struct Renamed {
    error: Index,
    /// Whether the nominal values lose their name, if they stand in the table.
    of_nominal: bool,
    rename: Rename,
    keeps_unit: bool,
}

prop_compose! {
    fn renamed()(
        error in any::<Index>(),
        of_nominal in any::<bool>(),
        rename in rename(),
        keeps_unit in any::<bool>(),
    ) -> Renamed {
        Renamed { error, of_nominal, rename, keeps_unit }
    }
}

impl Renamed {
    /// Changes the name; what the headings were.
    fn apply(&self, parts: &Parts, grid: &mut Grid) -> DeviationKind {
        let error = self.error.get(&parts.errors);
        let mut headings = grid.headings_of(error.kind, Holds::Nominal);
        if headings.is_empty() || !self.of_nominal {
            headings = grid.headings_of(error.kind, Holds::Values);
        }
        for heading in headings {
            let text = grid.text(heading);
            let name = text.split([' ', '/', '[', '(']).next().unwrap_or(&text).len();
            let name = if text.starts_with(error.title.text) { error.title.text.len() } else { name };
            let unit = if self.keeps_unit { &text[name..] } else { "" };
            let new = self.rename.name(&text[..name]);
            grid.set(heading, format!("{new}{unit}").trim().to_owned());
        }
        error.kind
    }
}

/// Whether a table still has all columns that a spec of the parts needs: the name means the same.
fn has_all(parts: &Parts, bytes: &[u8], spec: &rackmesh::spec::Spec) -> bool {
    let Ok(table) = read::table(bytes, &spec.want()) else { return false };
    let kinds: Vec<_> = table.kinds().collect();
    let nominal_of = |kind: DeviationKind| {
        let of_kind = |role: &str| role == kind.key();
        table.reading.columns.iter().any(|column| of_kind(&column.role) && column.nominal.is_some())
    };
    parts.errors.iter().all(|error| {
        let needs_nominal = error.nominal.is_some_and(|nominal| nominal.stands_in == NominalIn::Table);
        kinds.contains(&error.kind) && (!needs_nominal || nominal_of(error.kind))
    })
}

#[test]
fn without_a_needed_name_nothing_passes() {
    check(
        250,
        (parts(), design(), dialect(), renamed(), any::<bool>()),
        |(parts, design, dialect, renamed, on_each)| {
            let mut grid = Grid::new(&parts, &design);
            renamed.apply(&parts, &mut grid);
            let spec = read::spec(&parts.spec(WIDE, on_each));
            let bytes = dialect.file(&grid);
            if let Ok(judged) = read::judge(&bytes, &spec, 2)
                && judged.passes()
                && !has_all(&parts, &bytes, &spec)
            {
                return Err(failed("it passes", &dialect.text(&grid)));
            }
            Ok(())
        },
    );
}

#[test]
fn without_a_needed_name_no_workbook_passes() {
    check(50, (parts(), design(), renamed()), |(parts, design, renamed)| {
        let mut grid = Grid::new(&parts, &design);
        renamed.apply(&parts, &mut grid);
        let spec = read::spec(&parts.spec(WIDE, false));
        let bytes = workbook(&grid, None, 0);
        if let Ok(judged) = read::judge(&bytes, &spec, 2)
            && judged.passes()
            && !has_all(&parts, &bytes, &spec)
        {
            return Err(failed("it passes", &Dialect::PLAIN.text(&grid)));
        }
        Ok(())
    });
}

/// Parts whose errors are all deviations in one unit, so that each could stand under the name of any other.
fn alike(parts: &mut Parts) {
    parts.errors.retain(|error| error.kind != DeviationKind::RackLead);
    let Some(first) = parts.errors.first().cloned() else { return };
    for error in &mut parts.errors {
        (error.unit, error.decimals, error.nominal) = (first.unit, first.decimals, None);
        error.companions = super::parts::Companions::default();
        let largest = error.largest();
        error.deviations.iter_mut().for_each(|deviation| *deviation %= largest + 1);
        if error.title.is_measured {
            error.title = parts.language.titles(error.kind)[0];
        }
    }
}

#[test]
fn values_go_with_their_heading() {
    check(60, (parts(), design(), dialect()), |(mut parts, design, dialect)| {
        alike(&mut parts);
        let mut grid = Grid::new(&parts, &design);
        let [first, second, ..] = parts.errors.as_slice() else { return Ok(()) };
        if is_ambiguous(&grid, dialect.figures) {
            return Ok(());
        }
        let want = read::spec(&parts.spec(WIDE, false)).want();
        let before =
            read::values(&dialect.file(&grid), &want).map_err(|problem| failed(&problem, &dialect.text(&grid)))?;
        let both = [first.kind, second.kind].map(|kind| grid.headings_of(kind, Holds::Values));
        let [one, other] = [&both[0], &both[1]].map(|headings| grid.text(headings[0]));
        both[0].iter().for_each(|heading| grid.set(*heading, other.clone()));
        both[1].iter().for_each(|heading| grid.set(*heading, one.clone()));
        let after =
            read::values(&dialect.file(&grid), &want).map_err(|problem| failed(&problem, &dialect.text(&grid)))?;
        prop_assert_eq!(before.of(first.kind), after.of(second.kind), "{}", dialect.text(&grid));
        prop_assert_eq!(before.of(second.kind), after.of(first.kind), "{}", dialect.text(&grid));
        Ok(())
    });
}

#[test]
fn the_same_column_twice_is_refused() {
    let places = (any::<Index>(), any::<Index>());
    check(60, (parts(), design(), dialect(), places), |(parts, design, dialect, (error, to))| {
        let mut grid = Grid::new(&parts, &design);
        let heading = grid.headings_of(error.get(&parts.errors).kind, Holds::Values)[0];
        grid.copy(heading, to);
        match read::judge(&dialect.file(&grid), &read::spec(&parts.spec(WIDE, false)), 2) {
            Err(_) => Ok(()),
            Ok(judged) => Err(failed(&format!("{:?}", judged.outcome.counts), &dialect.text(&grid))),
        }
    });
}

#[test]
fn measurements_of_an_unknown_name_are_refused() {
    let units = LENGTHS.iter().chain(ANGLES).filter(|unit| unit.spelling != "min").map(|unit| unit.spelling);
    let name = ("[bcdfghjklqxz]{5,9}", select(units.collect::<Vec<_>>()));
    let places = (any::<Index>(), any::<Index>());
    check(80, (parts(), design(), dialect(), name, places), |(parts, design, dialect, (name, unit), (error, to))| {
        let mut grid = Grid::new(&parts, &design);
        let heading = grid.headings_of(error.get(&parts.errors).kind, Holds::Values)[0];
        grid.copy(heading, to);
        let copy = grid.of_copy(heading, to);
        grid.set(copy, format!("{name} [{unit}]"));
        match read::judge(&dialect.file(&grid), &read::spec(&parts.spec(WIDE, false)), 2) {
            Err(_) => Ok(()),
            Ok(judged) => Err(failed(&format!("{:?}", judged.outcome.counts), &dialect.text(&grid))),
        }
    });
}

/// What may stand in a cell by mistake, or because there is no value.
const GARBAGE: [&str; 14] =
    ["abc", "2_5.01", "1.2.3", "12,3,4", "??", "n.a.", "", "-", "#DIV/0!", "12 furlong", "--3", "0x10", "1..2", "i.O."];

#[test]
fn a_cell_that_is_no_number_rejects_its_part_only() {
    let places = (any::<Index>(), any::<Index>());
    check(
        120,
        (parts(), design(), dialect(), select(GARBAGE.to_vec()), places),
        |(parts, design, dialect, garbage, places)| {
            let mut grid = Grid::new(&parts, &Design { shape: Shape::Rows, ..design });
            let error = places.0.get(&parts.errors);
            let row = places.1.index(grid.order.len());
            let heading = grid.headings_of(error.kind, Holds::Values)[0];
            grid.set(Heading { row: grid.first + row, ..heading }, garbage.to_owned());
            if is_ambiguous(&grid, dialect.figures) || parts.count == 1 {
                return Ok(());
            }
            let text = dialect.text(&grid);
            let want = read::spec(&parts.spec(WIDE, false)).want();
            let values = read::values(&dialect.file(&grid), &want).map_err(|problem| failed(&problem, &text))?;
            prop_assert_eq!((&values.faults, values.rows), (&vec![row], parts.count), "{}\n{}", values.reading, text);
            for (place, part) in grid.order.iter().enumerate().filter(|(place, _)| *place != row) {
                for error in &parts.errors {
                    let value = values.of(error.kind).map(|values| values[place]);
                    prop_assert_eq!(value, Some(error.expected(*part)), "{}\n{}", values.reading, text);
                }
            }
            Ok(())
        },
    );
}

/// Parts that pass though they did not before; those that stand in the line where the table is cut are left out.
fn turned(whole: &read::Judged, cut: &read::Judged, line: &str) -> Vec<String> {
    let failed = |name: &str| whole.verdicts.iter().any(|part| part.name == name && part.verdict == "fail");
    let is_turned = |part: &&read::Verdict| part.verdict == "pass" && failed(&part.name) && !line.contains(&part.name);
    cut.verdicts.iter().filter(is_turned).map(|part| part.name.clone()).collect()
}

#[test]
fn a_table_that_is_cut_off_lets_no_bad_part_pass() {
    check(12, (parts(), design(), dialect()), |(mut parts, design, dialect)| {
        // names that are no part of each other
        parts.names = (0..parts.count).map(|part| format!("SN{part:02}")).collect();
        let grid = Grid::new(&parts, &design);
        let dialect = Dialect { code: Code::Utf8, is_packed: false, ..dialect };
        let text = dialect.text(&grid);
        let spec = read::spec(&parts.spec("0.3", false));
        let Ok(whole) = read::judge(text.as_bytes(), &spec, 1) else { return Ok(()) };
        for cut in (0..text.len()).step_by(text.len() / 60 + 1).filter(|cut| text.is_char_boundary(*cut)) {
            let line = text[..cut].rsplit(['\n', '\r']).next().unwrap_or("");
            let Ok(judged) = read::judge(&text.as_bytes()[..cut], &spec, 1) else { continue };
            // in a line of a label or of a characteristic, the cut is in the last of its parts
            let line = if matches!(grid.shape, Shape::Labels | Shape::PartColumns) { &text } else { line };
            let turned = turned(&whole, &judged, line);
            prop_assert!(turned.is_empty(), "{:?} pass\n{}", turned, &text[..cut]);
        }
        Ok(())
    });
}

#[test]
fn files_that_are_cut_off_never_pass() {
    check(8, (parts(), design(), dialect(), any::<Index>()), |(parts, design, dialect, cut)| {
        let grid = Grid::new(&parts, &design);
        let spec = read::spec(&parts.spec(WIDE, false));
        let text = dialect.text(&grid);
        for file in [workbook(&grid, None, 0), packed(text.as_bytes())] {
            let judged = read::judge(&file[..cut.index(file.len())], &spec, 1);
            prop_assert!(!judged.is_ok_and(|judged| judged.passes()), "{}", text);
        }
        Ok(())
    });
}

#[test]
fn another_decimal_mark_far_below_ends_the_run() {
    check(12, (parts(), design(), dialect(), any::<Index>()), |(parts, design, dialect, error)| {
        let between = if dialect.between == Between::Blanks { Between::Mark(';') } else { dialect.between };
        let dialect = Dialect { between, ..dialect };
        let mut grid = Grid::new(&parts, &Design { shape: Shape::Rows, mean: false, ..design });
        if is_ambiguous(&grid, dialect.figures) {
            return Ok(());
        }
        grid = super::same::repeated(&grid);
        let heading = grid.headings_of(error.get(&parts.errors).kind, Holds::Values)[0];
        let other = if dialect.figures.mark == '.' { "0,0" } else { "0.0" };
        let last = Heading { row: grid.cells.len() - 1, ..heading };
        grid.set(last, other.to_owned());
        let judged = read::judge(&dialect.file(&grid), &read::spec(&parts.spec(WIDE, false)), 2);
        prop_assert!(!judged.is_ok_and(|judged| judged.passes()));
        Ok(())
    });
}
