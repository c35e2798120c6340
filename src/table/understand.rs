//! From a text to a table: every separator that it may have, and both decimal marks, are tried. If all readings that are
//! possible give the same values, that is the table; if they do not, and neither another cell nor a nominal value settles
//! it, the text is refused with the readings shown. The computer's locale is never asked. Called for the whole of a short
//! text, and for the start of a long one.

use std::cmp::Ordering;
use std::mem::discriminant;
use std::sync::Arc;

use super::cell::{Cell, Content, Record};
use super::column::{Column, Extent, Nominal, Problem, UnitFrom, behind_name, fitting};
use super::companions::Companions;
use super::grid::{Separator, records, separators};
use super::names::{Field, Role, WordList, is_called, may_be_of_parts, names_value, part_in_title, part_said, role};
use super::number::{DecimalMark, Marks, normalise};
use super::reading::AsideReading;
use super::shape::{Measurement, NoShape, Shape, has_digit, located, shape, stated_units, unknown_unit};
use super::want::{Orientation, Want, ignore_option, mapping, quoted};
use crate::deviation::DeviationValue;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Source};
use crate::quantity::{AngleUnit, LengthUnit, Unit, shown};

/// A table whose columns are found.
#[derive(Debug, Clone)]
pub(crate) struct Understood {
    /// What stands between cells; `None` where the file has cells of its own.
    pub(crate) separator: Option<Separator>,
    pub(crate) shape: Arc<Shape>,
    /// The decimal mark; `None` if no number has decimals.
    pub(crate) mark: Option<DecimalMark>,
    pub(crate) settled_by: Option<String>,
    /// One per measurement of the shape.
    pub(crate) columns: Vec<Column>,
    /// Whether each row is a tooth or a space.
    pub(crate) is_teeth: bool,
    /// Values in words: what two readings are compared by, and shown as.
    values: Vec<String>,
    /// Why it cannot be meant, if it cannot.
    doubt: Option<String>,
    /// Why its decimal mark cannot be meant: no number of a column whose value depends on the mark makes sense.
    ruled_out: Option<String>,
}

/// A decimal mark, and what speaks for it.
struct Choice {
    mark: DecimalMark,
    settled_by: Option<String>,
}

/// The rank of what is wrong with a column that was found.
const COLUMN_FOUND: u8 = 3;

/// Reads a text, or its start.
pub(crate) fn understand(source: &Arc<Source>, want: &Want) -> Result<Understood, Diagnostics> {
    let text = source.text.as_str();
    let mut candidates: Vec<Understood> = Vec::new();
    // the reading that came furthest says best what is wrong
    let mut failure: Option<(u8, Diagnostics)> = None;
    let mut fail = |rank: u8, problem: Diagnostics| {
        if failure.as_ref().is_none_or(|(known, _)| *known < rank) {
            failure = Some((rank, problem));
        }
    };
    let told = want.separator.map(|byte| vec![Separator::Character(byte)]);
    let mut possible = told.unwrap_or_else(|| separators(text));
    if possible.contains(&Separator::COMMA)
        && possible.contains(&Separator::AlignedBlanks)
        && stands_aligned(text, want)
    {
        possible.retain(|separator| *separator != Separator::COMMA);
    }
    for separator in possible {
        let is_strong = matches!(separator, Separator::Character(byte) if byte != b',' || want.separator.is_some());
        let cut = records(text, separator).map_err(|line| NoShape::OpenQuote { line });
        let cut = cut.and_then(|records| Ok((shape(&records, separator, want)?, records)));
        match cut {
            Ok((shape, records))
                if separator == Separator::COMMA && !is_strong && !commas_separate(&shape, &records, want) => {}
            Ok((shape, records)) => {
                let named = shape.header_line.is_some() && shape.width() > 1;
                let sure = is_strong && (shape.width() > 1 || shape.lines.len() > 1 && shape.header.is_empty())
                    || named && separator == Separator::COMMA
                    || separator == Separator::AlignedBlanks && is_even(&records, &shape);
                match readings(source, Some(separator), &Arc::new(shape), want) {
                    Ok(read) => candidates.extend(read),
                    Err(problem) if sure => return Err(problem),
                    Err(problem) => fail(COLUMN_FOUND, problem),
                }
                // no other separator can do better
                if sure {
                    break;
                }
            }
            Err(problem) => {
                let rank = match problem {
                    NoShape::NoNumbers | NoShape::Count { .. } | NoShape::InOneCell { .. } => 0,
                    NoShape::OtherNames { .. } => 1,
                    _ => 2,
                };
                // between single blanks, the names of columns are no longer told apart
                let is_sure =
                    is_strong || matches!((&problem, separator), (NoShape::NoPart { .. }, Separator::AlignedBlanks));
                let diagnostic = problem.explain(source, want);
                if rank > 0 && is_sure {
                    return Err(diagnostic.into());
                }
                fail(rank, diagnostic.into());
            }
        }
    }
    // a reading that finds no column says less than one that finds a column and what is wrong with it
    if failure.as_ref().is_some_and(|(rank, _)| *rank == COLUMN_FOUND) {
        candidates.retain(|candidate| !candidate.columns.is_empty());
    }
    let failed = || failure.map_or_else(|| NoShape::NoNumbers.explain(source, want).into(), |(_, problem)| problem);
    choose_sentences(&mut candidates);
    settle(source, candidates).unwrap_or_else(|| Err(failed()))
}

/// Reads records whose file has cells of its own.
pub(crate) fn understand_records(name: &str, records: &[Record], want: &Want) -> Result<Understood, Diagnostics> {
    let source = &Arc::new(Source::new(name, ""));
    let shape = shape(records, Separator::TAB, want).map_err(|problem| problem.explain(source, want))?;
    let candidates = readings(source, None, &Arc::new(shape), want)?;
    settle(source, candidates).unwrap_or_else(|| Err(NoShape::NoNumbers.explain(source, want).into()))
}

/// Leaves the readings as sentences alone, if they have all values of the others and more, or out.
fn choose_sentences(candidates: &mut Vec<Understood>) {
    let is_sentences = |candidate: &Understood| candidate.separator == Some(Separator::Sentences);
    if candidates.iter().all(is_sentences) || !candidates.iter().any(is_sentences) {
        return;
    }
    candidates.iter_mut().for_each(Understood::examine);
    let has_all = |candidate: &Understood, other: &Understood| {
        other.values.iter().all(|value| candidate.values.contains(value)) && candidate.values.len() > other.values.len()
    };
    let others: Vec<&Understood> = candidates.iter().filter(|candidate| !is_sentences(candidate)).collect();
    let says_more = |candidate: &Understood| {
        is_sentences(candidate) && candidate.doubt.is_none() && others.iter().all(|other| has_all(candidate, other))
    };
    let is_kept = candidates.iter().any(says_more);
    candidates.retain(|candidate| is_sentences(candidate) == is_kept);
}

/// The one reading of several; `None` if there is none.
fn settle(source: &Arc<Source>, mut candidates: Vec<Understood>) -> Option<Result<Understood, Diagnostics>> {
    if candidates.len() < 2 {
        return candidates.pop().map(Ok);
    }
    candidates.iter_mut().for_each(Understood::examine);
    if candidates.iter().any(|candidate| !candidate.values.is_empty()) {
        candidates.retain(|candidate| !candidate.values.is_empty());
    }
    if candidates.iter().any(|candidate| candidate.doubt.is_none()) {
        candidates.retain(|candidate| candidate.doubt.is_none());
    }
    let mut distinct: Vec<Understood> = Vec::new();
    for candidate in candidates {
        if distinct.iter().all(|other| other.values != candidate.values) {
            distinct.push(candidate);
        }
    }
    match distinct.len() {
        0 => None,
        1 => distinct.pop().map(Ok),
        _ => Some(Err(two_readings(source, &distinct).into())),
    }
}

/// Whether the columns of a text stand below each other, so that its commas are decimal marks; where cells end in commas,
/// the blanks are only there for the eye.
fn stands_aligned(text: &str, want: &Want) -> bool {
    let records = records(text, Separator::AlignedBlanks).unwrap_or_default();
    let ends_in_comma = |record: &Record| record.cells.iter().any(|cell| cell.text().ends_with(','));
    !records.iter().any(ends_in_comma)
        && shape(&records, Separator::AlignedBlanks, want).is_ok_and(|shape| is_even(&records, &shape))
}

/// Whether every row of numbers has as many cells as the others and the header: blanks that stand between cells by chance
/// leave no such table.
fn is_even(records: &[Record], shape: &Shape) -> bool {
    let is_row = |record: &&Record| match shape.header_line {
        Some(line) => record.line == line || record.numbers() > 0,
        None => record.cells.len() > 1,
    };
    let mut widths = records.iter().filter(is_row).map(|record| record.cells.len());
    let first = widths.next().unwrap_or(0);
    let mut others = widths.peekable();
    first > 1 && others.peek().is_some() && others.all(|width| width == first)
}

/// Whether commas may stand between these cells: not if the text after one would begin with a zero that no number begins
/// with, if a counter would be a part's name, if there is none between the names, or if nothing is known and each cuts a
/// number: `Rollenmaß 25,012 mm`.
fn commas_separate(shape: &Shape, records: &[Record], want: &Want) -> bool {
    let whole = |record: &Record| {
        let is_cut = |pair: &&[Cell]| pair[1].is_number() && pair[0].span.end + 1 == pair[1].span.start;
        let name = |pair: &[Cell]| Some(pair[0].text().trim_end_matches(|c: char| c.is_ascii_digit()).to_owned());
        record.cells.windows(2).find(is_cut).and_then(name).filter(|name| name.ends_with([' ', '\u{a0}']))
    };
    let mut with_numbers = records.iter().filter(|record| record.numbers() > 0).map(whole).peekable();
    if shape.measurements.is_empty() && with_numbers.peek().is_some() {
        let names: Option<Vec<String>> = with_numbers.collect();
        if names.is_some_and(|names| names.iter().any(|name| names_value(name, &want.own))) {
            return false;
        }
    }
    let values = || shape.measurements.iter().flat_map(|measurement| &measurement.value.cells);
    let is_fraction = |cell: &Cell| {
        let text = cell.text();
        let digits = text.trim_start_matches(['+', '-']);
        digits.starts_with('0') && digits[1..].starts_with(|c: char| c.is_ascii_digit())
    };
    // 1,234 is no part 1 with the value 234
    let counted = shape.orientation == Orientation::Rows
        && shape.header_line.is_none()
        && shape.ids.as_ref().is_some_and(|ids| ids.cells.iter().any(Cell::is_number));
    let is_label = shape.orientation == Orientation::Columns;
    let is_wide = is_label || shape.width() + shape.lines.len() > 2;
    is_wide && shape.header.len() != 1 && !counted && !values().any(is_fraction)
}

impl Shape {
    /// How many columns are known.
    fn width(&self) -> usize {
        let beside = self.ids.iter().chain(&self.index).count();
        self.header.len().max(self.measurements.len() + beside)
    }

    /// The cells in which a number tells the decimal mark.
    fn number_cells(&self) -> impl Iterator<Item = &Cell> {
        let measured = self.measurements.iter();
        let measured =
            measured.flat_map(|measurement| std::iter::once(&measurement.value).chain(measurement.beside.iter()));
        measured.flat_map(|series| &series.cells).chain(&self.beside)
    }
}

/// The readings of a shape: one, or one for each decimal mark.
fn readings(
    source: &Arc<Source>,
    separator: Option<Separator>,
    shape: &Arc<Shape>,
    want: &Want,
) -> Result<Vec<Understood>, Diagnostics> {
    let choices = choices(source, separator, shape, want)?;
    let several = choices.len() > 1;
    let has_mark = |cell: &Cell| matches!(&cell.content, Content::Text(text) if text.contains(['.', ',', '．', '，']));
    let has_decimals = shape.number_cells().any(has_mark);
    let mut candidates = Vec::new();
    let mut failure = None;
    for Choice { mark, settled_by } in choices {
        match read(source, shape, mark, want) {
            Ok(read) => {
                let mark = (has_decimals || want.decimal.is_some()).then_some(mark);
                candidates.push(Understood { separator, mark, settled_by, ..read });
            }
            Err(problem) => failure = Some(problem),
        }
    }
    if several {
        candidates.iter_mut().for_each(Understood::examine);
        settle_mark(&mut candidates);
        // a line beside the table tells the mark where no value does
        if candidates.len() > 1 && candidates.iter().any(|candidate| candidate.settled_by.is_some()) {
            candidates.retain(|candidate| candidate.settled_by.is_some());
        }
    }
    match failure {
        Some(failure) if candidates.is_empty() => Err(failure),
        _ => Ok(candidates),
    }
}

/// What the numbers of a table say about their decimal mark.
#[derive(Default)]
struct Evidence<'s> {
    /// The first cell that is a number with a decimal point only.
    point: Option<&'s Cell>,
    comma: Option<&'s Cell>,
    /// Whether a cell is a different number with each.
    is_open: bool,
    /// Whether such a cell has a comma: between commas, it is in quotes.
    has_open_comma: bool,
}

impl<'s> Evidence<'s> {
    fn of(cells: impl Iterator<Item = &'s Cell>) -> Self {
        let mut evidence = Self::default();
        for cell in cells {
            match cell.marks() {
                Marks::None | Marks::Same => {}
                _ if !cell.is_measure() => {}
                Marks::Differ => {
                    evidence.is_open = true;
                    evidence.has_open_comma |= cell.text().contains(',');
                }
                Marks::Only(DecimalMark::Point) => evidence.point = evidence.point.or(Some(cell)),
                Marks::Only(DecimalMark::Comma) => evidence.comma = evidence.comma.or(Some(cell)),
            }
        }
        evidence
    }
}

/// Of the readings with either mark, leaves those that can be meant: what rules out one mark settles the other.
fn settle_mark(candidates: &mut Vec<Understood>) {
    let reasons: [fn(&Understood) -> Option<&String>; 2] =
        [|candidate| candidate.ruled_out.as_ref(), |candidate| candidate.doubt.as_ref()];
    for why in reasons {
        let Some(reason) = candidates.iter().find_map(why).cloned() else { continue };
        if candidates.iter().any(|candidate| why(candidate).is_none()) {
            candidates.retain(|candidate| why(candidate).is_none());
            for candidate in candidates {
                candidate.settled_by = Some(format!("otherwise {reason}"));
            }
            return;
        }
    }
}

/// The decimal marks that a table may have.
fn choices(
    source: &Arc<Source>,
    separator: Option<Separator>,
    shape: &Shape,
    want: &Want,
) -> Result<Vec<Choice>, Diagnostic> {
    let mut evidence = Evidence::of(shape.number_cells());
    if evidence.is_open && evidence.point.is_none() && evidence.comma.is_none() {
        // what is no measurement tells the mark as well
        let columns = shape.unknown.iter().filter(|unknown| unknown.column.is_some());
        let others = Evidence::of(columns.flat_map(|unknown| &unknown.cells));
        if others.point.is_none() || others.comma.is_none() {
            (evidence.point, evidence.comma) = (others.point, others.comma);
        }
    }
    let open = evidence.is_open;
    let by = |cell: &Cell| format!("settled by `{}`", cell.text());
    let one = |mark, settled_by| Ok(vec![Choice { mark, settled_by }]);
    match (want.decimal, evidence.point, evidence.comma) {
        (Some(mark), ..) => one(mark, Some("as told".to_owned())),
        (None, Some(point), Some(comma)) => {
            let message = format!("the table has decimal points and commas: `{}` and `{}`", point.text(), comma.text());
            // of two values, either mark leaves one that is no number
            let values = Evidence::of(shape.measurements.iter().flat_map(|measurement| &measurement.value.cells));
            let help = match (values.point, values.comma) {
                (Some(_), Some(_)) => "write every number in the same way",
                _ => {
                    "write every number in the same way, or say which mark counts: --decimal comma, or in the spec [batch] decimal = \"comma\""
                }
            };
            let diagnostic = Diagnostic::error(Code::BadTable, message).help(help);
            Err(located(diagnostic, source, comma.span.clone(), ""))
        }
        (None, Some(cell), None) => one(DecimalMark::Point, open.then(|| by(cell))),
        (None, None, Some(cell)) => one(DecimalMark::Comma, open.then(|| by(cell))),
        (None, None, None) if !open => one(DecimalMark::Point, None),
        (None, None, None) if separator == Some(Separator::COMMA) && !evidence.has_open_comma => {
            one(DecimalMark::Point, Some("commas separate".to_owned()))
        }
        (None, None, None) => {
            let lines = shape.unknown.iter().filter(|unknown| unknown.column.is_none());
            let lines = Evidence::of(lines.flat_map(|unknown| &unknown.cells).filter(|cell| cell.has_decimals()));
            let choice = |mark, cell: Option<&Cell>, other: Option<&Cell>| Choice {
                mark,
                settled_by: cell.filter(|_| other.is_none()).map(by),
            };
            let (point, comma) = (lines.point, lines.comma);
            Ok(vec![choice(DecimalMark::Point, point, comma), choice(DecimalMark::Comma, comma, point)])
        }
    }
}

/// Reads the values of a shape with a decimal mark.
fn read(source: &Source, shape: &Arc<Shape>, mark: DecimalMark, want: &Want) -> Result<Understood, Diagnostics> {
    let is_teeth = want.teeth.unwrap_or_else(|| is_teeth(shape));
    let fields = shape.measurements.iter().map(|measurement| measurement.field);
    let is_pinion = is_teeth && fields.chain(shape.index_field).any(Field::is_of_tooth);
    let of_pinion = is_pinion.then(|| Want { face_width: want.pinion_face_width, ..want.clone() });
    let want = of_pinion.as_ref().unwrap_or(want);
    let mut columns = Vec::with_capacity(shape.measurements.len());
    let mut problems: Vec<_> =
        shape.index.iter().filter(|_| !is_teeth).map(|index| numbers_teeth(&index.title)).collect();
    for measurement in &shape.measurements {
        let kind = if is_teeth { None } else { measurement.field.kind() };
        if !is_teeth && kind.is_none() {
            problems.push(
                Diagnostic::error(
                    Code::BadTable,
                    format!(
                        "`{}` is {} of a tooth or space, and each row of this table is a part",
                        measurement.value.title,
                        measurement.field.key()
                    ),
                )
                .help("tables with a row per tooth or space are read by `rackmesh batch --teeth` and `rackmesh paste`"),
            );
            continue;
        }
        match Column::new(measurement, kind, want, mark) {
            Ok(column) => columns.push(column),
            Err(diagnostics) => problems.extend(diagnostics.0),
        }
    }
    problems.extend(twice(&columns));
    let statements: Vec<_> = shape.statements(want).collect();
    let said = |statement: &AsideReading| {
        other_unit(shape, &columns, want, &format!("line {}", statement.line), &statement.text)
    };
    problems.extend(statements.iter().find_map(said));
    problems.extend(other_part(shape, &columns, want));
    if !problems.is_empty() {
        let in_file =
            |problem: Diagnostic| Diagnostic { message: format!("{}: {}", source.name, problem.message), ..problem };
        return Err(Diagnostics(problems.into_iter().map(in_file).collect()));
    }
    Ok(Understood {
        separator: None,
        shape: Arc::clone(shape),
        mark: Some(mark),
        settled_by: None,
        columns,
        is_teeth,
        values: Vec::new(),
        doubt: None,
        ruled_out: None,
    })
}

/// Two columns of one error: nothing tells which of them counts.
fn twice(columns: &[Column]) -> Option<Diagnostic> {
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

/// The refusal of a table of parts with a column that numbers their spaces or teeth.
fn numbers_teeth(title: &str) -> Diagnostic {
    let message = format!("`{title}` numbers spaces or teeth: each row is a tooth or a space, and not a part");
    Diagnostic::error(Code::BadTable, message).help(format!(
        "put the exact mesh to work: --teeth; or leave the column out, if each row is a part: {}",
        ignore_option(title)
    ))
}

/// A text at a place beside the table that states another unit than the one that is assumed for a column, or than those that
/// stand beside all of them; millimetres and degrees may be meant for others.
fn other_unit(shape: &Shape, columns: &[Column], want: &Want, place: &str, text: &str) -> Option<Diagnostic> {
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

/// A line above values that speaks of the other part than a column is of, whose name does not say it: `Ritzel` above
/// `Teilung`; or, as a title, than all of them are, whatever their names say.
fn other_part(shape: &Shape, columns: &[Column], want: &Want) -> Option<Diagnostic> {
    let last = shape.lines.iter().max().copied().unwrap_or_default();
    // a word without a number is a title, wherever it stands
    let is_title = |aside: &AsideReading| !has_digit(&aside.text);
    let may_say = |aside: &&AsideReading| (aside.line < last || is_title(aside)) && !want.ignores(&aside.text);
    let above = shape.asides.iter().filter(may_say);
    above.filter_map(|aside| Some((aside, part_in_title(&aside.text)?))).find_map(|(aside, said)| {
        let is_of_both = columns.iter().any(|column| column.kind.is_some_and(|kind| kind.part() == said));
        let is_other = |column: &&Column| {
            let is_named =
                want.is_own(&column.title) || (is_of_both || !is_title(aside)) && part_said(&column.title).is_some();
            !is_named && column.kind.is_some_and(|kind| kind.part() != said && !is_called(&column.title, kind.key()))
        };
        let column = columns.iter().find(is_other)?;
        let (line, text, title, key) = (aside.line, shown(&aside.text), &column.title, column.kind?.key());
        let message = format!("line {line} says `{text}`, and `{title}` would be read as `{key}`");
        let help = format!(
            "name the column, if it is: [batch.columns] {}; or leave the line out: {}",
            mapping(key, column.kind, title, None),
            ignore_option(&aside.text)
        );
        Some(Diagnostic::error(Code::BadTable, message).help(help))
    })
}

impl Understood {
    /// The refusal of a text at a place beside the table that states another unit.
    pub(crate) fn contradicted_by(&self, place: &str, text: &str, want: &Want) -> Option<Diagnostic> {
        other_unit(&self.shape, &self.columns, want, place, text)
    }

    /// A row, or a limit in a column beside those of parts, that is called by a statistic or a limit of the others, and is none by
    /// its value: beyond them all, or an upper limit below them; it is a part, or of other parts. Asked where every row is there.
    pub(crate) fn false_statistic(&self, file: &str) -> Option<Diagnostic> {
        let name = |row: usize| {
            let cells = self.shape.index.iter().chain(&self.shape.ids).filter_map(|series| series.cells.get(row));
            cells.map(Cell::text).find(|text| !text.is_empty()).unwrap_or_default()
        };
        let of_parts: Vec<bool> = (0..self.shape.lines.len()).map(|row| may_be_of_parts(&name(row))).collect();
        let is_across = self.shape.orientation == Orientation::Columns && of_parts.len() > 1;
        if !of_parts.contains(&true) && !is_across {
            return None;
        }
        let refused = |line: u64, name: &str, value: &Cell| {
            let text = value.text();
            let message = format!("{file}, line {line}: `{name}` is {text}, which values of the others contradict");
            let help = "give the row the name of its part, or take it out of the table";
            Some(Diagnostic::error(Code::BadTable, message).help(help))
        };
        for (measurement, column) in self.shape.measurements.iter().zip(&self.columns) {
            let rows = || measurement.value.cells.iter().enumerate();
            let others = rows().filter(|(row, _)| !(of_parts[*row] && name(*row).len() > 1));
            let others = others.fold(Extent::NONE, |extent, (row, cell)| {
                let value = column.read(cell, measurement.beside_row(row)).ok().flatten();
                value.map_or(extent, |value| extent.with(value, cell, column))
            });
            let is_false = |(row, cell): &(usize, &Cell)| {
                of_parts[*row] && is_false_statistic(&name(*row), column, cell, measurement.beside_row(*row), &others)
            };
            if others.least > others.most {
                continue;
            }
            if let Some((row, cell)) = rows().find(is_false) {
                return refused(self.shape.lines[row], &name(row), cell);
            }
            // a limit to one side may be a part
            let [upper, lower] = [Role::Upper, Role::Lower].map(|role| measurement.beside.get(role));
            let limit = upper.xor(lower).filter(|_| is_across && column.nominal != Nominal::None);
            if let Some((limit, cell)) = limit.and_then(|limit| Some((limit, limit.cells.first()?)))
                && is_false_statistic(&limit.title, column, cell, measurement.beside_row(0), &others)
            {
                return refused(self.shape.lines[0], &limit.title, cell);
            }
        }
        None
    }

    /// That a line beside the table counts other parts than it has: `Anzahl Teile: 3`. Asked where every row is there.
    pub(crate) fn other_count(&self, file: &str) -> Option<String> {
        let ids = self.shape.ids.as_ref().filter(|_| !self.is_teeth)?;
        let parts = ids.cells.iter().filter(|name| !may_be_of_parts(&name.text())).count();
        let count = |line: &AsideReading| {
            let words: Vec<&str> = line.text.split([' ', ':', '=']).filter(|word| !word.is_empty()).collect();
            let (number, words) = words.split_last()?;
            number.parse::<usize>().ok().filter(|_| WordList::PartCount.has(&words.join(" ")))
        };
        let mut counts = self.shape.asides.iter().filter_map(|line| Some((line, count(line)?)));
        let (line, _) = counts.find(|(_, count)| *count != parts)?;
        Some(format!("{file}: line {} says `{}`, and the table has {parts}", line.line, shown(&line.text)))
    }

    /// Whether each row below a header is a part, a space or a tooth.
    pub(crate) fn has_row_per_part(&self) -> bool {
        self.shape.orientation == Orientation::Rows && !self.shape.header.is_empty()
    }

    /// Reads every value: only asked where there is more than one reading to choose from.
    fn examine(&mut self) {
        let Self { shape, columns, values, doubt, ruled_out, .. } = self;
        (*values, *doubt, *ruled_out) = (Vec::new(), None, None);
        for (measurement, column) in shape.measurements.iter().zip(columns) {
            let key = measurement.field.key();
            let (mut is_possible, mut impossible) = (false, None);
            for (row, cell) in measurement.value.cells.iter().enumerate() {
                let is_open = || cell.marks() == Marks::Differ;
                let value = match column.read(cell, measurement.beside_row(row)) {
                    Ok(None) => continue,
                    Ok(Some(value)) => in_words(value),
                    // how large a deviation may be settles nothing
                    Err(Problem::TooLarge(_)) => "too large".to_owned(),
                    Err(
                        Problem::Bad(what) | Problem::Far(what) | Problem::OtherMark(what) | Problem::OpenMark(what),
                    ) => {
                        if impossible.is_none() && is_open() {
                            impossible = Some(what.clone());
                        }
                        doubt.get_or_insert(what);
                        continue;
                    }
                };
                is_possible = is_possible || is_open();
                values.push(format!("{key} {value}"));
            }
            if !is_possible {
                *ruled_out = ruled_out.take().or(impossible);
            }
        }
    }
}

impl Measurement {
    /// What stands beside the value of a row.
    pub(crate) fn beside_row(&self, row: usize) -> Companions<&Cell> {
        self.beside.map(|series| series.cells.get(row))
    }
}

/// Whether what a row of this name has in a column cannot be made of the others.
pub(super) fn is_false_statistic(
    name: &str,
    column: &Column,
    cell: &Cell,
    beside: Companions<&Cell>,
    others: &Extent,
) -> bool {
    let side = column.beyond(cell, beside, others);
    side.is_some_and(|side| contradicts(name, side, column.nominal))
        || name.len() > 1 && WordList::Spread.has(name) && column.is_wider(cell, others)
}

/// Whether a row of this name cannot lie beyond this end of the others: a mean or an extreme of them, a limit on the other side,
/// and a spread, a sum or an index near their nominal value.
fn contradicts(name: &str, side: Ordering, nominal: Nominal) -> bool {
    let is_limit = match side {
        Ordering::Less => role(name) == Some(Role::Upper),
        _ => role(name) == Some(Role::Lower),
    };
    let is_apart = WordList::Apart.has(name) || WordList::Spread.has(name);
    is_limit || WordList::Mean.has(name) || is_apart && nominal != Nominal::None
}

/// Whether each row is a tooth or space: it has their numbers or values, or over-pin values of no named part; one value
/// behind its name is that of a part.
fn is_teeth(shape: &Shape) -> bool {
    let has = |fields: &[Field]| shape.measurements.iter().any(|measurement| fields.contains(&measurement.field));
    let is_error = |measurement: &Measurement| matches!(measurement.field, Field::Error(_));
    shape.index.is_some()
        || has(&[Field::Position, Field::LeftPitch, Field::RightPitch, Field::Radial])
        || (has(&[Field::OverPin, Field::Lead])
            && (shape.orientation == Orientation::Rows || shape.lines.len() > 1)
            && shape.ids.is_none()
            && !shape.measurements.iter().any(is_error))
}

/// The refusal of a text that can be read in more than one way.
fn two_readings(source: &Arc<Source>, candidates: &[Understood]) -> Diagnostic {
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

/// A value for people: small lengths in µm.
pub(crate) fn in_words(value: DeviationValue) -> String {
    match value {
        DeviationValue::Length(length) if !length.is_zero() && length.abs().mm() < 0.1 => {
            format!("{} µm", length.in_unit(LengthUnit::Micrometre))
        }
        value => value.to_string(),
    }
}
