//! What each column of a table with a row per characteristic holds, by its heading and by what stands below it.

use crate::table::cell::{Cell, Record};
use crate::table::names::{Field, Role, WordList, is_called, names_value, role};
use crate::table::shape::headings::is_part_name;
use crate::table::shape::rows::are_verdicts;
use crate::table::shape::{distinct, has_digit};
use crate::table::want::Want;

/// What each column of a header is.
pub(super) fn roles_of(header: &Record, want: &Want) -> Vec<Option<Role>> {
    let names_part =
        |cell: &Cell| want.own.iter().any(|(own, field)| *field == Field::PartId && is_called(&cell.text(), own));
    let is_part_named = header.cells.iter().any(names_part);
    let role_of = |(place, cell): (usize, &Cell)| {
        let title = cell.text();
        if is_part_named && (names_part(cell) || role(&title) == Some(Role::Part)) {
            return names_part(cell).then_some(Role::Part);
        }
        // a part in a series is none that is called by its letters: K1, K2, K3
        let is_of_series = |role: &Role| role.is_beside_value() && is_called_like_another(&header.cells, place);
        role(&title).filter(|role| !want.ignores(&title) && !is_of_series(role))
    };
    header.cells.iter().enumerate().map(role_of).collect()
}

/// `Nom` is the nominal value, and in French the name: beside a column of nominal values it has names, if all its cells are words.
/// So has any requirement in whose cells known names stand, where no column that is called by names has them.
pub(super) fn take_names(roles: &mut [Option<Role>], header: &Record, below: &[Record], want: &Want) {
    let is_called = |place: usize| header.cells[place].text().trim().eq_ignore_ascii_case("nom");
    let has_names = |place: usize| below.iter().any(|row| names_value(&row.cell(place).text(), &want.own));
    let [wanted, called, measured] = [Role::Nominal, Role::Name, Role::Measured].map(|role| places(roles, role));
    let may_be_french = wanted.len() > 1 && called.is_empty();
    let is_named = || !measured.is_empty() && !called.iter().any(|place| has_names(*place));
    let is_name = |place: &usize| {
        has_words(below, *place) && (may_be_french && is_called(*place) || has_names(*place) && is_named())
    };
    if let Some(place) = wanted.into_iter().find(is_name) {
        roles[place] = Some(Role::Name);
    }
}

/// Whether a column has words, and no number.
fn has_words(rows: &[Record], place: usize) -> bool {
    let mut cells = rows.iter().map(|row| row.cell(place)).filter(|cell| !cell.is_missing()).peekable();
    cells.peek().is_some() && !cells.any(Cell::is_number)
}

/// The columns of a role.
pub(super) fn places(roles: &[Option<Role>], of: Role) -> Vec<usize> {
    (0..roles.len()).filter(|place| roles[*place] == Some(of)).collect()
}

/// Words beside the values of several parts are no part's: `Part 1 | Part 2 | Result`; beside columns that are only called alike,
/// approvals.
pub(super) fn take_verdicts(roles: &mut [Option<Role>], header: &Record, below: &[Record]) {
    let is_numbered = |place: usize| {
        let title = &header.cells[place];
        names_one_part(&title.text()) || title.is_whole() && !title.is_empty()
    };
    let is_alike = |place: usize| is_called_like_another(&header.cells, place);
    let open = (0..roles.len()).filter(|place| roles[*place].is_none());
    let (numbered, alike) = (open.clone().filter(|place| is_numbered(*place)), open.filter(|place| is_alike(*place)));
    let (has_parts, has_alike) = (numbered.count() > 1, alike.count() > 1);
    let cells = |place: usize| below.iter().map(move |row| row.cell(place));
    let is_verdict = |place: &usize| {
        has_parts && has_words(below, *place) || has_alike && are_verdicts(cells(*place), &[WordList::Approval])
    };
    if let Some(place) = places(roles, Role::Measured).into_iter().find(is_verdict) {
        roles[place] = Some(Role::Status);
    }
}

/// Whether a column has the axes along which something was measured.
pub(in crate::table::shape) fn is_axis(title: &str) -> bool {
    ["ax", "axis", "achse", "axe", "軸"].contains(&title.trim().to_lowercase().as_str())
}

/// Whether a cell of that column is a direction: M, R, X.
pub(in crate::table::shape) fn is_direction(name: &Cell) -> bool {
    name.text().trim().chars().count() <= 2
}

/// Whether a line numbers parts behind a word for names: `Merkmal | Einheit | 417 | 418`.
pub(super) fn numbers_parts(record: &Record) -> bool {
    let numbers = || record.cells.iter().filter(|cell| cell.is_number());
    numbers().all(Cell::is_whole)
        && distinct(numbers()) == numbers().count()
        && record.cells.iter().any(|cell| role(&cell.text()) == Some(Role::Name))
}

/// Whether a heading is that of another column but for its digits: `R17` beside `R16`.
pub(super) fn is_called_like_another(header: &[Cell], place: usize) -> bool {
    let stem = |cell: &Cell| cell.text().trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
    let own = stem(&header[place]);
    let is_letter = |cell: &Cell| cell.text().chars().count() == 1 && cell.text().chars().all(char::is_alphabetic);
    // R, S, T, U
    let is_of_letters = is_letter(&header[place]) && header.iter().filter(|cell| is_letter(cell)).count() > 2;
    is_of_letters
        || has_digit(&header[place].text())
            && !own.is_empty()
            && header
                .iter()
                .enumerate()
                .any(|(other, cell)| other != place && has_digit(&cell.text()) && stem(cell) == own)
}

/// Whether a heading is the name of a part, `Teil 2`, even if nothing of it was measured.
pub(super) fn names_one_part(title: &str) -> bool {
    has_digit(title) && is_part_name(title.trim_end_matches(|c: char| c.is_ascii_digit() || c == '-'))
}
