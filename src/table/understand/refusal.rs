//! Why a reading is refused: two columns of one error, another unit or part beside the table, two readings.

use std::collections::{BTreeSet, HashSet};
use std::mem::discriminant;
use std::sync::Arc;

use super::super::cell::Cell;
use super::super::column::{Column, UnitFrom, behind_name, fitting};
use super::super::grid::Separator;
use super::super::names::{
    Field, Role, WordList, is_called, is_context, names_page, part_in_title, part_said, role, says_which, split_unit,
};
use super::super::number::{DecimalMark, Marks, normalise};
use super::super::reading::AsideReading;
use super::super::shape::{Shape, has_digit, is_part_name, located, stated_units, unknown_unit};
use super::super::unknown::Unknown;
use super::super::want::{Orientation, Want, ignore_option, mapping, quoted};
use super::Understood;
use crate::deviation::{DeviationKind, Part};
use crate::diagnostic::{Code, Diagnostic, Source};
use crate::quantity::{AngleUnit, LengthUnit, Unit, shown};

/// Two columns of one error: nothing tells which of them counts.
pub(super) fn twice(columns: &[Column]) -> Option<Diagnostic> {
    let later = |(index, column): (usize, &Column)| {
        let kind = column.kind?;
        let first = columns[..index].iter().find(|first| first.kind == Some(kind))?;
        let message = format!("two columns for `{}`: `{}` and `{}`", kind.key(), first.title, column.title);
        let help = format!(
            "say which counts, and leave the other out: [batch.columns] {}, [batch] ignore = [{}]",
            mapping(kind.key(), Some(kind), &first.title, None),
            quoted(&column.title)
        );
        Some(Diagnostic::error(Code::BadTable, message).help(help))
    };
    columns.iter().enumerate().find_map(later)
}

/// The refusal of a table of parts with a column, or a row, that is none of an error.
pub(super) fn no_error(title: &str, field: Field) -> Diagnostic {
    if field == Field::PartId {
        let message = format!("`{title}` names the parts again, whose names stand in the header");
        return Diagnostic::error(Code::BadTable, message).help(format!("leave it out: {}", ignore_option(title)));
    }
    let message = format!("`{title}` is {} of a tooth or space, and each row of this table is a part", field.key());
    let of_one = |kind: DeviationKind| mapping(kind.key(), Some(kind), &split_unit(title).0, None);
    let whose = if matches!(field, Field::LeftPitch | Field::RightPitch) {
        let [rack, pinion] = [DeviationKind::RackPitch, DeviationKind::PinionPitch].map(of_one);
        format!("say of which part it is, [batch.columns] {rack} or {pinion}; ")
    } else {
        String::new()
    };
    Diagnostic::error(Code::BadTable, message).help(format!(
        "tables with a row per tooth or space are read by `rackmesh batch --teeth` and `rackmesh paste`; {whose}or leave it out: {}",
        ignore_option(title)
    ))
}

/// The refusal of a table of parts with a column that numbers their spaces or teeth.
pub(super) fn numbers_teeth(title: &str) -> Diagnostic {
    let message = format!("`{title}` numbers spaces or teeth: each row is a tooth or a space, and not a part");
    Diagnostic::error(Code::BadTable, message).help(format!(
        "put the exact mesh to work: --teeth; or leave the column out, if each row is a part: {}",
        ignore_option(title)
    ))
}

/// A text at a place beside the table that states another unit than the one that is assumed for a column, or than those that
/// stand beside all of them; millimetres and degrees may be meant for others.
pub(super) fn other_unit(
    shape: &Shape,
    columns: &[Column],
    want: &Want,
    place: &str,
    text: &str,
) -> Option<Diagnostic> {
    let stated = stated_units(text);
    let is_common = |unit| matches!(unit, Unit::Length(LengthUnit::Millimetre) | Unit::Angle(AngleUnit::Degree));
    columns.iter().find_map(|column| {
        let is_assumed = column.unit_from == UnitFrom::Key;
        // beside a unit that the table itself tells
        let is_of_others = |unit: Unit| {
            column.unit_from != UnitFrom::Spec && (is_common(unit) || columns.iter().any(|column| column.unit == unit))
        };
        let is_other = |unit: &Unit| discriminant(unit) == discriminant(&column.unit) && *unit != column.unit;
        // mm and µm
        let has_own = !is_assumed && stated.iter().any(|stated| stated.unit == column.unit);
        let stated = stated.iter().filter(|_| !has_own);
        let stated = stated.filter(|stated| is_assumed || stated.is_clear && !is_of_others(stated.unit));
        let title = &column.title;
        let help = match (stated.map(|stated| stated.unit).find(is_other), unknown_unit(text)) {
            (Some(unit), _) => {
                let measurement = shape.measurements.iter().find(|found| found.value.title == *title)?;
                let units = [unit, column.unit].map(Unit::symbol);
                behind_name(title, &fitting(measurement, column.kind, want, column.mark, units))
            }
            (None, Some(unknown)) if is_assumed => format!(
                "`{unknown}` is no unit that is known: write one behind the name, or leave the line out: {}",
                ignore_option(text)
            ),
            (None, _) => return None,
        };
        let (text, read_in) = (shown(text), column.unit.symbol());
        let message = if is_assumed {
            format!("{place} says `{text}`, and nothing else tells the unit of `{title}`, which would be {read_in}")
        } else {
            format!("{place} says `{text}`, and `{title}` is in {read_in}")
        };
        Some(Diagnostic::error(Code::BadTable, message).help(help))
    })
}

/// What may say of which part values are.
struct Saying {
    /// `line 3`.
    place: String,
    text: String,
    /// What leaves it out, as `--ignore` takes it.
    pattern: String,
    said: Part,
    /// Whether it is a line, and not what parts or a sheet are called.
    is_line: bool,
    /// Whether it speaks of all values, whatever the names of their columns say: a title without a number.
    is_of_all: bool,
}

/// A line above values, a column beside them or the names of the parts that speak of the other part than a column is of, whose
/// name does not say it: `Ritzel` above `Teilung`; or, as a title, than all of them are, whatever their names say.
pub(super) fn other_part(shape: &Shape, columns: &[Column], want: &Want) -> Option<Diagnostic> {
    let last = shape.lines.iter().max().copied().unwrap_or_default();
    // a word without a number is a title, wherever it stands
    let is_title = |aside: &AsideReading| !has_digit(&aside.text);
    let may_say = |aside: &&AsideReading| (aside.line < last || is_title(aside)) && !want.ignores(&aside.text);
    let saying = |aside: &AsideReading, is_line: bool| {
        let (text, said) = (aside.text.clone(), part_in_title(&aside.text)?);
        let (place, pattern) = (format!("line {}", aside.line), text.clone());
        Some(Saying { place, text, pattern, said, is_line, is_of_all: is_title(aside) })
    };
    let lines = shape.asides.iter().filter(may_say).filter_map(|aside| saying(aside, true));
    let beside = shape.said_beside_values(want);
    let beside = beside.iter().filter_map(|said| saying(said, false));
    let line = shape.header_line.unwrap_or(1);
    let heading = shape.ids.iter().map(|ids| AsideReading { line, text: ids.title.clone() });
    let heading = heading.filter_map(|heading| Some((part_said(&heading.text)?, heading)));
    let heading = heading.map(|(said, AsideReading { line, text })| Saying {
        place: format!("line {line}"),
        pattern: text.clone(),
        text,
        said,
        is_line: false,
        is_of_all: false,
    });
    lines.chain(beside).chain(heading).find_map(|saying| of_other(&saying, columns, want))
}

/// A second column of parts' names that has those of other rows: two tables may stand side by side, each in its own order.
pub(super) fn other_order(shape: &Shape, want: &Want) -> Option<Diagnostic> {
    let ids = shape.ids.as_ref()?;
    let is_second = |unknown: &&Unknown| unknown.column.is_some() && is_part_name(&unknown.title);
    shape.unknown.iter().filter(is_second).filter(|second| !second.is_ignored(want)).find_map(|second| {
        let is_name = |cell: &&Cell| !cell.is_missing() && !cell.is_number();
        let names: HashSet<_> = ids.cells.iter().filter(is_name).map(Cell::text).collect();
        let mut pairs = ids.cells.iter().zip(&second.cells).map(|(own, other)| [own.text(), other.text()]);
        let [own, other] = pairs.find(|[own, other]| own != other && names.contains(other))?;
        let (title, ids) = (&second.title, &ids.title);
        let message =
            format!("`{title}` is `{}` where `{ids}` is `{}`, and both name parts", shown(&other), shown(&own));
        let help = format!("give tables side by side one by one; or leave a column out: {}", ignore_option(title));
        Some(Diagnostic::error(Code::BadTable, message).help(help))
    })
}

/// Two lines of one form that differ in a number, a side or the like, and values below both that are read as one part's: each line
/// may name a part, or its batch.
pub(super) fn several_parts(shape: &Shape, want: &Want) -> Option<Diagnostic> {
    const MOST_WORDS: usize = 4;
    // the last line that names the same parts again, above more values of theirs
    let again = shape.asides.iter().filter(|aside| shape.names_parts_again(aside)).map(|aside| aside.line).max();
    let are_of_one = match shape.ids {
        Some(_) => again.is_some(),
        None => shape.measurements.iter().all(|measurement| measurement.value.cells.len() == 1),
    };
    if shape.orientation == Orientation::Rows || !are_of_one {
        return None;
    }
    // a label with a number, as `Lot: 7`
    let labels = shape.unknown.iter().filter(|unknown| unknown.column.is_none()).filter_map(|unknown| {
        let line = unknown.place.strip_prefix("line ")?.parse().ok()?;
        let [cell] = &unknown.cells[..] else { return None };
        Some(AsideReading { line, text: format!("{} {}", unknown.title, cell.text()) })
    });
    let is_name = |line: &AsideReading| {
        let is_short = line.text.split_whitespace().count() <= MOST_WORDS;
        is_short && !names_page(&line.text) && !want.ignores(&line.text)
    };
    let lines = shape.asides.iter().cloned().chain(labels).filter(is_name);
    let names: Vec<_> = lines.filter_map(|line| Some((form_of_name(&line.text)?, line))).collect();
    let may_be_lots = |form: &str, line: u64| {
        let lists = [WordList::Batch, WordList::PieceNumber];
        shape.ids.is_none() || again > Some(line) && lists.iter().any(|list| list.has(form))
    };
    let are_alike = |[(form, one), (other_form, other)]: &[&(String, AsideReading); 2]| {
        form == other_form && one.text != other.text && other.line > one.line + 1 && may_be_lots(form, other.line)
    };
    let mut pairs = names.iter().flat_map(|one| names.iter().map(move |other| [one, other]));
    let [(_, one), (_, other)] = pairs.find(are_alike)?;
    let message = format!(
        "lines {} and {} say `{}` and `{}`: each may name a part, and the values are those of one",
        one.line,
        other.line,
        shown(&one.text),
        shown(&other.text)
    );
    let help = format!("write `Part` in front of names of parts; or leave lines out: {}", ignore_option(&other.text));
    Some(Diagnostic::error(Code::BadTable, message).help(help))
}

/// A line without what tells one part from another: numbers, sides, single letters, `first`; `None` if it has none of that, or
/// counts something else.
fn form_of_name(line: &str) -> Option<String> {
    if says_which(line) {
        return Some(String::new());
    }
    let is_letter = |word: &str| word.chars().count() == 1;
    let tells_apart = |word: &str| is_letter(word) || says_which(word) || WordList::OneOfSeveral.has(word);
    let words = || line.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let fixed = words().filter(|word| !tells_apart(word)).map(|word| word.replace(|c: char| c.is_ascii_digit(), ""));
    let form = fixed.filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ");
    let is_of_part = [WordList::Batch, WordList::PieceNumber].iter().any(|list| list.has(&form))
        || role(&form) == Some(Role::Part)
        || part_said(&form).is_some();
    // a letter in front of a name tells no part: A. Smith
    let tells =
        |word: &str| has_digit(word) || tells_apart(word) && (!is_letter(word) || form.is_empty() || is_of_part);
    let is_number = !line.contains(|c: char| c.is_alphabetic() || matches!(c, '#' | '*'));
    let lists = [WordList::RowNumber, WordList::Probe];
    let is_number_of = role(&form) == Some(Role::Name) || lists.iter().any(|list| list.has(&form));
    let counts_others = is_number || is_number_of || is_context(&form) && !is_of_part;
    (words().any(tells) && !counts_others).then_some(form)
}

/// The refusal of a table whose commas may be decimal marks.
pub(super) fn cut_by_commas(source: &Source) -> Diagnostic {
    let message =
        format!("{}: the commas may be decimal marks: as separators they leave no value a decimal", source.name);
    let help = "put semicolons between the values, or quotes around them; if they are whole, write 25.0";
    Diagnostic::error(Code::AmbiguousBlock, message).help(help)
}

/// A column that numbers rows in another order than they stand, in a table of teeth that are not numbered otherwise: as gear testers
/// measure them.
pub(super) fn other_numbers(shape: &Shape, want: &Want) -> Option<Diagnostic> {
    let numbers = |unknown: &Unknown| {
        let numbers: Option<Vec<i64>> = unknown.cells.iter().map(|cell| cell.text().parse().ok()).collect();
        numbers.filter(|numbers| !numbers.is_empty() && unknown.column.is_some() && !unknown.is_ignored(want))
    };
    let unknown = shape.unknown.iter().find(|unknown| {
        let Some(numbers) = numbers(unknown) else { return false };
        let each: BTreeSet<i64> = numbers.iter().copied().collect();
        let (first, last) = (numbers[0], numbers[numbers.len() - 1]);
        let [least, most] = [each.first(), each.last()].map(|end| end.copied().unwrap_or(first));
        let is_next = |pair: &[i64]| Some(pair[1]) == pair[0].checked_add(1) || pair == [most, least];
        let is_in_order = [first, last] == [least, most] && numbers.windows(2).all(is_next);
        each.len() > 1 && usize::try_from(most.abs_diff(least)) == Ok(each.len() - 1) && !is_in_order
    })?;
    let title = &unknown.title;
    let message =
        format!("`{title}` numbers the rows in another order than they stand, and no column numbers the teeth");
    let help = format!("call the column `tooth` or `space`; or leave it out: {}", ignore_option(title));
    Some(Diagnostic::error(Code::BadTable, message).help(help))
}

/// The refusal of values of another part than a text beside them says, which the user leaves out by a pattern.
pub(crate) fn said_of_other(
    columns: &[Column],
    place: &str,
    text: &str,
    pattern: &str,
    want: &Want,
) -> Option<Diagnostic> {
    let said = part_in_title(text).filter(|_| !want.ignores(pattern))?;
    let [place, text, pattern] = [place, text, pattern].map(str::to_owned);
    of_other(&Saying { place, text, pattern, said, is_line: false, is_of_all: false }, columns, want)
}

/// The refusal of a column of the other part than is said.
fn of_other(saying: &Saying, columns: &[Column], want: &Want) -> Option<Diagnostic> {
    let is_of_both = columns.iter().any(|column| column.kind.is_some_and(|kind| kind.part() == saying.said));
    let is_other = |column: &&Column| {
        let is_named =
            want.is_own(&column.title) || (is_of_both || !saying.is_of_all) && part_said(&column.title).is_some();
        !is_named && column.kind.is_some_and(|kind| kind.part() != saying.said && !is_called(&column.title, kind.key()))
    };
    // beside columns of both parts, rows are pairs, whatever they are called
    let column = columns.iter().find(is_other).filter(|_| saying.is_line || !is_of_both)?;
    let (place, text, title, key) = (&saying.place, shown(&saying.text), &column.title, column.kind?.key());
    let message = format!("{place} says `{text}`, and `{title}` would be read as `{key}`");
    let help = format!(
        "name the column, if it is: [batch.columns] {}; or leave out what says so: {}",
        mapping(key, column.kind, title, None),
        ignore_option(&saying.pattern)
    );
    Some(Diagnostic::error(Code::BadTable, message).help(help))
}

/// The refusal of a text that can be read in more than one way.
pub(super) fn two_readings(source: &Arc<Source>, candidates: &[Understood]) -> Diagnostic {
    const SHOWN: usize = 4;
    let marks_only = candidates
        .windows(2)
        .all(|pair| pair[0].separator == pair[1].separator && pair[0].shape.orientation == pair[1].shape.orientation);
    let readings: Vec<_> = candidates
        .iter()
        .map(|candidate| {
            let how = match (marks_only, candidate.mark, candidate.separator) {
                (true, Some(mark), _) => format!("decimal {}", mark.word()),
                (_, mark, separator) => {
                    let mark = mark.map_or_else(String::new, |mark| format!(", decimal {}", mark.word()));
                    format!("{}{mark}", separator.map_or_else(String::new, Separator::name))
                }
            };
            let values: Vec<_> = candidate.values.iter().take(SHOWN).map(String::as_str).collect();
            let more = if candidate.values.len() > SHOWN { ", …" } else { "" };
            format!("with {how}: {}{more}", values.join(", "))
        })
        .collect();
    let is_open = |cell: &&Cell| cell.marks() == Marks::Differ;
    let open = candidates.iter().find_map(|candidate| candidate.shape.number_cells().find(is_open));
    let such = open.map_or_else(String::new, |cell| format!(", because of `{}`", cell.text()));
    let ways = if candidates.len() == 2 { "two" } else { "several" };
    let message = format!("the table can be read in {ways} ways{such}");
    let diagnostic = Diagnostic::error(Code::AmbiguousBlock, message).help(format!(
        "{}; say which it is: --decimal comma or --decimal point, or in the spec [batch] decimal = \"comma\"{}",
        readings.join("; or "),
        if marks_only { "" } else { ", or put semicolons between the values" }
    ));
    let Some(cell) = open else { return located(diagnostic, source, 0..0, "") };
    let [point, comma] = DecimalMark::ALL.map(|mark| normalise(&cell.text(), mark).unwrap_or_default());
    let label = if point.contains('.') { format!("{point} or {comma}?") } else { format!("{comma} or {point}?") };
    located(diagnostic, source, cell.span.clone(), &label)
}
