//! From a text to a table: every separator that it may have, and both decimal marks, are tried. If all readings that are
//! possible give the same values, that is the table; if they do not, and neither another cell nor a nominal value settles
//! it, the text is refused with the readings shown. The computer's locale is never asked. Called for the whole of a short
//! text, and for the start of a long one.

mod mark;
mod refusal;

use std::cmp::{Ordering, Reverse};
use std::sync::Arc;

use super::cell::{Cell, Record};
use super::column::{Column, Extent, Nominal, Problem};
use super::companions::Companions;
use super::grid::{Separator, records, separators};
use super::names::{
    Field, Role, WordList, is_apart, is_called_spread, is_statistic, may_be_of_parts, names_value, role, split_unit,
    statistic_word,
};
use super::number::{DecimalMark, Marks};
use super::reading::AsideReading;
use super::shape::{Measurement, NoShape, Series, Shape, is_spread, shape};
use super::unknown::Unknown;
use super::want::{Orientation, Want};
use crate::deviation::DeviationValue;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Source};
use crate::quantity::{AngleUnit, LengthUnit, Unit, shown};
use mark::readings;
pub(crate) use refusal::said_of_other;
use refusal::{
    cut_by_commas, no_error, numbers_teeth, other_numbers, other_order, other_part, other_unit, several_parts, twice,
    two_readings,
};

/// A table whose columns are found.
#[derive(Debug, Clone, Default)]
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

/// What is wrong with a reading, and how far it came.
struct Failure {
    rank: u8,
    problem: Diagnostics,
}

/// The rank of what is wrong with a column that was found.
const COLUMN_FOUND: u8 = 3;

/// Reads a text, or its start.
pub(crate) fn understand(source: &Arc<Source>, want: &Want) -> Result<Understood, Diagnostics> {
    let text = source.text.as_str();
    let mut candidates: Vec<Understood> = Vec::new();
    let mut failures: Vec<Failure> = Vec::new();
    let told = want.separator.map(|byte| vec![Separator::Character(byte)]);
    let mut possible = told.unwrap_or_else(|| separators(text));
    let has_both = [Separator::COMMA, Separator::AlignedBlanks].iter().all(|either| possible.contains(either));
    if has_both && stands_aligned(text, want) {
        possible.retain(|separator| *separator != Separator::COMMA);
    }
    for separator in possible {
        let is_strong = matches!(separator, Separator::Character(byte) if byte != b',' || want.separator.is_some());
        let cut = records(text, separator).map_err(|line| NoShape::OpenQuote { line });
        let cut = cut.and_then(|records| Ok((shape(&records, separator, want)?, records)));
        match cut {
            Ok((shape, records))
                if separator == Separator::COMMA && !is_strong && !commas_separate(&shape, &records, want) => {}
            Ok((shape, _)) if separator == Separator::COMMA && shape.may_be_shifted() => {
                return Err(cut_by_commas(source).into());
            }
            Ok((shape, records)) => {
                let named = shape.header_line.is_some() && shape.width() > 1;
                let sure = is_strong && (shape.width() > 1 || shape.lines.len() > 1 && shape.header.is_empty())
                    || named && separator == Separator::COMMA
                    || separator == Separator::AlignedBlanks && is_even(&records, &shape);
                match readings(source, Some(separator), &Arc::new(shape), want) {
                    Ok(read) => candidates.extend(read),
                    Err(problem) if sure => return Err(problem),
                    Err(problem) => failures.push(Failure { rank: COLUMN_FOUND, problem }),
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
                failures.push(Failure { rank, problem: diagnostic.into() });
            }
        }
    }
    // a reading that finds no column says less than one that finds a column and what is wrong with it
    if failures.iter().any(|failure| failure.rank == COLUMN_FOUND) {
        candidates.retain(|candidate| !candidate.columns.is_empty());
    }
    // the reading that came furthest says best what is wrong
    let failure = failures.into_iter().min_by_key(|failure| Reverse(failure.rank));
    let failed = || failure.map_or_else(|| NoShape::NoNumbers.explain(source, want).into(), |failure| failure.problem);
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
    /// Whether commas that cut every value in two would leave this table: whole millimetres or degrees, and nothing but digits in all
    /// columns behind them, of which the last is none of values.
    fn may_be_shifted(&self) -> bool {
        let is_whole = |cell: &Cell| cell.text().bytes().all(|byte| byte.is_ascii_digit());
        let are_whole = |cells: &Vec<Cell>| cells.iter().all(is_whole) && !cells.iter().all(Cell::is_missing);
        let Some(last) = self.header.len().checked_sub(1) else { return false };
        let unknown = |place: usize| {
            self.unknown.iter().find(|unknown| unknown.column == Some(place)).map(|unknown| &unknown.cells)
        };
        let values = self.measurements.iter().map(|measurement| &measurement.value);
        let cells = |place: usize| {
            unknown(place).or_else(|| values.clone().find(|series| series.place == place).map(|series| &series.cells))
        };
        let is_coarse = |series: &Series| {
            let unit = series.unit.as_deref().and_then(Unit::from_symbol);
            unit.is_none_or(|unit| {
                matches!(unit, Unit::Length(LengthUnit::Millimetre) | Unit::Angle(AngleUnit::Degree))
            })
        };
        let is_cut = |series: &Series| {
            is_coarse(series) && (series.place..=last).all(|place| cells(place).is_some_and(are_whole))
        };
        // with a unit it would have decimals, too, and is none that may be left out
        let has_unit = split_unit(&self.header[last].text()).1.is_some();
        unknown(last).is_some() && !has_unit && values.clone().any(is_cut)
    }

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
            problems.push(no_error(&measurement.value.title, measurement.field));
            continue;
        }
        match Column::new(measurement, kind, want, mark) {
            Ok(column) => columns.push(column),
            Err(diagnostics) => problems.extend(diagnostics.0),
        }
    }
    problems.extend(twice(&columns));
    let other = |said: AsideReading| other_unit(shape, &columns, want, &format!("line {}", said.line), &said.text);
    problems.extend(shape.statements(want).find_map(other));
    problems.extend(other_part(shape, &columns, want));
    problems.extend(other_order(shape, want));
    problems.extend(several_parts(shape, want));
    problems.extend(other_numbers(shape, want).filter(|_| is_teeth && shape.index.is_none()));
    if !problems.is_empty() {
        let in_file =
            |problem: Diagnostic| Diagnostic { message: format!("{}: {}", source.name, problem.message), ..problem };
        return Err(Diagnostics(problems.into_iter().map(in_file).collect()));
    }
    let shape = Arc::clone(shape);
    Ok(Understood { shape, mark: Some(mark), columns, is_teeth, ..Understood::default() })
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
        let is_made = |unknown: &&Unknown| is_statistic(&unknown.title) || is_spread(&unknown.title);
        let is_beside_statistic = |limit: &Series| {
            let mut places = self.shape.unknown.iter().filter(is_made).filter_map(|unknown| unknown.column);
            places.any(|place| place.abs_diff(limit.place) == 1)
        };
        let refused = |line: u64, name: &str, value: &Cell| {
            let text = value.text();
            let message = format!("{file}, line {line}: `{name}` is {text}, which values of the others contradict");
            let help = "give the row the name of its part, or take it out of the table";
            Some(Diagnostic::error(Code::BadTable, message).help(help))
        };
        for (measurement, column) in self.shape.measurements.iter().zip(&self.columns) {
            let rows = || measurement.value.cells.iter().enumerate();
            let others = rows().filter(|(row, _)| !(of_parts[*row] && name(*row).len() > 1));
            // beside a cell that is no value, nobody knows how far the values reach
            let mut is_read = true;
            let others = others.fold(Extent::NONE, |extent, (row, cell)| {
                let value = column.read(cell, measurement.beside_row(row));
                is_read &= value.is_ok();
                value.ok().flatten().map_or(extent, |value| extent.with(value, cell, column))
            });
            let is_false = |(row, cell): &(usize, &Cell)| {
                // a part may be called by one letter
                let may_be_part = is_spread(&name(*row));
                of_parts[*row]
                    && !may_be_part
                    && is_false_statistic(&name(*row), column, cell, measurement.beside_row(*row), &others)
            };
            if !is_read || others.least > others.most {
                continue;
            }
            if let Some((row, cell)) = rows().find(is_false) {
                return refused(self.shape.lines[row], &name(row), cell);
            }
            // a limit to one side may be a part, and next to a mean or a count both are the ends of the values
            let limits = [Role::Upper, Role::Lower].map(|role| measurement.beside.get(role));
            let limits: Vec<&Series> = limits.into_iter().flatten().collect();
            let are_ends = limits.len() == 1
                || limits.iter().any(|limit| is_beside_statistic(limit) && WordList::Mean.has(&limit.title));
            let is_asked = is_across && column.nominal != Nominal::None && are_ends;
            for limit in limits.into_iter().filter(|_| is_asked) {
                let Some(cell) = limit.cells.first() else { continue };
                if is_false_statistic(&limit.title, column, cell, measurement.beside_row(0), &others) {
                    return refused(self.shape.lines[0], &limit.title, cell);
                }
            }
        }
        None
    }

    /// That a line beside the table counts other parts than it has: `Anzahl Teile: 3`. Asked where every row is there.
    pub(crate) fn other_count(&self, file: &str) -> Option<String> {
        let ids = self.shape.ids.as_ref().filter(|_| !self.is_teeth)?;
        let parts = ids.cells.iter().filter(|name| !may_be_of_parts(&name.text())).count();
        let count = |line: &AsideReading| {
            let words = line.text.split([' ', ':', '=', '(', ')']).filter(|word| !word.is_empty());
            let (numbers, words): (Vec<&str>, Vec<&str>) = words.partition(|word| word.parse::<usize>().is_ok());
            let [number] = numbers[..] else { return None };
            let words = words.join(" ");
            // as a database ends its answer: `(2 rows)`
            let counts = [WordList::PartCount, WordList::Rows].iter().any(|list| list.has(&words));
            number.parse::<usize>().ok().filter(|_| counts)
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
                    Err(Problem::Bad(what) | Problem::Far(what) | Problem::Mark { what, .. }) => {
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
    let (name, side) = (statistic_word(name), column.beyond(cell, beside, others));
    let limit = role(name).or_else(|| control_limit(name));
    // no upper limit lies below the others, and no lower one above
    let is_false_limit = matches!(
        (limit, side),
        (Some(Role::Upper), Some(Ordering::Less)) | (Some(Role::Lower), Some(Ordering::Greater))
    );
    let is_spread = is_called_spread(name);
    // a spread, a sum or an index is far from a nominal value
    let has_nominal = column.nominal != Nominal::None;
    let is_size = || matches!(column.read(cell, beside), Ok(Some(_)));
    is_false_limit
        || side.is_some() && (WordList::Mean.has(name) || is_spread && has_nominal)
        || has_nominal && is_apart(name) && is_size()
        || !has_nominal && WordList::Sum.has(name) && column.is_no_sum(cell, beside, others)
        || is_spread && column.is_wider(cell, others)
}

/// The end of a control chart that a row is called by, which limits no part.
fn control_limit(name: &str) -> Option<Role> {
    let is = |word: &str| name.eq_ignore_ascii_case(word);
    is("ucl").then_some(Role::Upper).or(is("lcl").then_some(Role::Lower))
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

/// A value for people: small lengths in µm.
pub(crate) fn in_words(value: DeviationValue) -> String {
    match value {
        DeviationValue::Length(length) if !length.is_zero() && length.abs().mm() < 0.1 => {
            format!("{} µm", length.in_unit(LengthUnit::Micrometre))
        }
        value => value.to_string(),
    }
}
