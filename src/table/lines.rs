//! Lines that are no part of a table: what of one may be a measured value. Prose has its numbers between words, marks and
//! names. Asked when what is beside the values is sorted.

use std::borrow::Cow;
use std::collections::HashSet;

use super::cell::Cell;
use super::column::{Column, Nominal, has_tolerance_behind};
use super::grid::{Separator, is_clock, is_date, is_unit, records, unit_in};
use super::measured::MeasuredValues;
use super::names::{
    Role, WordList, heading, is_context, is_of_parts, is_statistic, is_value_heading, names_page, near, plain_widths,
    repeats_value, role, says_deviation, says_which,
};
use super::reading::AsideReading;
use super::rejection::says_rejected;
use super::shape::{PartLine, PartNames, Shape, has_digit, is_part_name, part_line, uncounted};
use super::unknown::{Unknown, has_unit_behind, is_foreign_unit};
use super::want::{Orientation, Want};
use crate::quantity::Length;

/// Whether a line says nothing but a column's nominal value, and perhaps its tolerance: `Soll: 25,000 ± 0,03`.
pub(super) fn repeats_nominal(unknown: &Unknown, aside: &AsideReading, columns: &[Column]) -> bool {
    let has_tolerance = has_tolerance_behind(&aside.text);
    let named = heading(&unknown.title, &[]).filter(|heading| heading.aspect == Role::Nominal);
    let is_nominal = |cell: &Cell| {
        columns.iter().filter(|column| named.as_ref().is_none_or(|named| named.fields.contains(&column.field))).any(|column| {
            matches!(column.nominal, Nominal::Fixed(nominal) if column.quantity(cell).is_ok_and(|value| value == nominal))
        })
    };
    (named.is_some() || role(&unknown.title) == Some(Role::Nominal))
        && unknown.cells.first().is_some_and(is_nominal)
        && unknown.cells.len() <= 1 + usize::from(has_tolerance)
}

/// What lines and remarks that are no part of a table are held against.
#[derive(Clone, Copy)]
pub(crate) struct Beside<'a> {
    pub(crate) columns: &'a [Column],
    /// How many cells a row has.
    pub(crate) width: usize,
    /// By what lines are told from rows; none where a row may have any name.
    pub(crate) of_parts: Option<&'a PartNames>,
    /// The values, as far as the table was looked at.
    pub(crate) measured: Option<&'a MeasuredValues>,
}

impl Beside<'_> {
    /// What of a line may be a measured value. Above the names of the columns, titles stand.
    pub(super) fn value_in(&self, aside: &AsideReading, is_above: bool) -> Option<Unknown> {
        let correction = || Unknown::line("", aside.line, vec![Cell::of_text(&aside.text, 0..0)]).unread();
        let corrects = || !is_above && self.of_parts.is_some() && says_value_alone(&aside.text, self.columns);
        value_in(aside, self, is_above)
            .or_else(|| value_beyond(aside, self.measured?))
            .or_else(|| corrects().then(correction))
    }

    /// What of a cell of the column at a place may be a value, and corrects one.
    pub(crate) fn value_in_remark(&self, cell: &Cell, column: &str, line: u64) -> Option<Unknown> {
        let remark = AsideReading { line, text: cell.text().into_owned() };
        // of a number with a word behind it, what is near a nominal value counts, or has a unit or a sign
        let is_prose = !cell.is_number() || cell.is_measure() || cell.text().split_whitespace().count() > 2;
        let is_of = |column: &Column, cell: &Cell| {
            (is_prose || has_unit_behind(&cell.text())) && column.may_hold(cell)
                || is_signed(cell) && column.may_deviate_by(cell)
        };
        let is_value = |cell: &Cell| self.columns.iter().any(|column| is_of(column, cell));
        // Taster 3 mm
        let is_of_probe = |cell: &Cell| {
            unit_in(&cell.text()).is_some_and(|unit| unit == "mm")
                && !self
                    .columns
                    .iter()
                    .any(|column| matches!(column.nominal, Nominal::Fixed(_)) && column.may_hold(cell))
        };
        let is_probe = |value: &Unknown| WordList::Probe.has(&value.title) && value.cells.iter().all(is_of_probe);
        let is_meant = |value: &Unknown| {
            !is_probe(value) && (is_prose && !near(&value.title).is_empty() || value.cells.iter().any(is_value))
        };
        let correction = || Unknown::line("", line, vec![cell.clone()]).unread();
        let value = value_in(&remark, self, false).filter(is_meant);
        let value = value.or_else(|| value_beyond(&remark, self.measured?));
        let is_correction = has_scale(&remark.text)
            || is_prose && speaks_of_deviation(&remark.text)
            || says_value_alone(&remark.text, self.columns);
        let value = value.or_else(|| is_correction.then(correction))?;
        Some(Unknown { place: format!("{column}, {}", value.place), ..value })
    }
}

/// What of a line that is no part of the table may be a measured value: what has the name or the unit of one, a number
/// with decimals that may be one of the columns', as many numbers as a row has, or a mean or an extreme that the values do
/// not have. Other statistics and tolerances are none. A number behind a word that is no part's name is one near a column's
/// nominal value only, and above the names with three decimals.
fn value_in(aside: &AsideReading, beside: &Beside<'_>, is_above: bool) -> Option<Unknown> {
    let Beside { columns, width, of_parts: names, .. } = *beside;
    if !has_digit(&aside.text) {
        return None;
    }
    let text = without_punctuation(&aside.text);
    let record = uncounted(records(&text, Separator::Blanks).ok()?.first()?);
    let cells: Vec<Cell> = without_foreign(&record.cells).cloned().collect();
    let is_cell = |cell: &Cell| cell.is_number() && !cell.text().starts_with("00");
    let is_row = width > 1 && record.cells.len() == width && record.cells.iter().all(is_cell);
    let found = named_values(&cells, aside.line)?;
    let found = if is_row { found.measured(true) } else { found };
    let is_name = found.title.is_empty() || names.is_none_or(|names| names.may_have(&found.title));
    // B liegt 0,061 drüber
    let begins_with_part = names.is_some_and(|names| names.begin(&found.title));
    let deviate = || !columns.is_empty() && columns.iter().all(|column| column.nominal == Nominal::None);
    let is_alone = found.cells.iter().filter(|cell| cell.is_number()).count() == 1;
    // behind the name of a part or with a sign, a number may say by how much a value deviates
    let is_deviation = |cell: &Cell| {
        cell.is_measure()
            && (begins_with_part && (cell.is_fine() || deviate()) || is_signed(cell) && is_alone && names.is_some())
            && columns.iter().any(|column| column.may_hold(cell) || column.may_deviate_by(cell))
    };
    let is_value = |cell: &Cell| {
        let may_be_of =
            |column: &Column| is_name || (!is_above || cell.is_fine()) && matches!(column.nominal, Nominal::Fixed(_));
        cell.has_decimals() && columns.iter().any(|column| may_be_of(column) && column.may_hold(cell))
    };
    let may_be_value = |cell: &Cell| is_value(cell) || is_deviation(cell);
    let may_be = || !is_statistic(&found.title) && role(&found.title).is_none() && found.cells.iter().any(may_be_value);
    // Maximum: 25,30
    let is_of_others = |measured: &MeasuredValues| measured.contradict(&found.title, &found.cells);
    let may_be = may_be() || beside.measured.is_some_and(is_of_others);
    if found.could_be_measured() { Some(found) } else { may_be.then(|| found.measured(true)) }
}

/// What of a line is near a nominal value and beyond all values of the table, whatever the words before it say: `NOK: 25,060`.
pub(super) fn value_beyond(aside: &AsideReading, measured: &MeasuredValues) -> Option<Unknown> {
    let text = without_punctuation(&aside.text);
    let record = records(&text, Separator::Blanks).ok()?.into_iter().next()?;
    let at = record.cells.iter().position(|cell| measured.is_beyond_all(cell))?;
    let title = record.cells[..at].iter().map(Cell::text).collect::<Vec<_>>().join(" ");
    let found = Unknown::line(&title, aside.line, vec![record.cells[at].clone()]).measured(true);
    Some(Unknown { is_repeated: true, ..found })
}

/// A line among values behind their names that begins with the name of an error which has none: `Teilung Zahnstange: n.i.O.`
pub(super) fn without_value(aside: &AsideReading, shape: &Shape, columns: &[Column]) -> Option<Unknown> {
    const MOST_WORDS: usize = 6;
    if shape.orientation == Orientation::Rows || shape.header_line.is_some() || columns.is_empty() {
        return None;
    }
    let words: Vec<&str> = aside.text.split_whitespace().collect();
    let name = (1..words.len().min(MOST_WORDS)).rev().map(|count| words[..count].join(" "));
    let is_missing = |name: &String| {
        let heading = heading(name, &[]).filter(|_| is_value_heading(name, &[]));
        heading.is_some_and(|heading| columns.iter().all(|column| !heading.fields.contains(&column.field)))
    };
    let name = name.into_iter().find(is_missing).filter(|_| words.len() <= MOST_WORDS)?;
    let behind = words[name.split(' ').count()..].join(" ");
    Some(Unknown::line(&name, aside.line, vec![Cell::of_text(&behind, 0..0)]).unread())
}

/// What a line says of all values, and nothing else does: by which factor they are written, that they are nominal, a statistic or
/// do not count, and another size than that with which they are read.
pub(super) fn of_all_values(aside: &AsideReading, columns: &[Column], want: &Want) -> Option<Unknown> {
    let unread = |title: &str| Unknown::line(title, aside.line, vec![Cell::of_text(&aside.text, 0..0)]).unread();
    let said = without_label(&aside.text);
    if has_scale(&aside.text)
        || corrects_unit(said)
        || is_of_parts(said)
        || is_rejected(&aside.text)
        || is_rejected(said)
    {
        return Some(unread(&aside.text));
    }
    let is_other =
        |said: &NamedSize| size_read_with(&said.name, columns, want).is_some_and(|read_with| said.size != read_with);
    named_sizes(&aside.text).find(is_other).map(|said| unread(&said.name))
}

/// Whether a text says that one unit is meant and not another, and nothing else: `mm not µm`.
fn corrects_unit(text: &str) -> bool {
    let words = || text.split([' ', ',']).filter(|word| !word.is_empty());
    let denies = |word: &str| WordList::Negation.has(word) || WordList::Again.has(word);
    words().any(is_unit) && words().any(denies) && words().all(|word| is_unit(word) || denies(word) || word == "but")
}

/// What a line says behind what it is labelled with, and between marks: `[14:05] Tom: Sollwerte`, `# Sollwerte`; the name of who
/// measured may be a word.
fn without_label(text: &str) -> &str {
    let is_mark = |c: char| c.is_whitespace() || "#*-[]<>|!".contains(c);
    let said = text.rsplit_once(": ").filter(|(label, _)| !WordList::Person.has(label) && !WordList::Place.has(label));
    said.map_or(text, |(_, said)| said).trim_matches(is_mark)
}

/// The names in a line of statistics, each with what stands behind it: `Max 25,012 Min 24,998`.
pub(super) fn statistics(text: &str, line: u64) -> Vec<Unknown> {
    let mut found: Vec<Unknown> = Vec::new();
    for cell in records(text, Separator::Blanks).unwrap_or_default().into_iter().flat_map(|record| record.cells) {
        let word = cell.text().into_owned();
        let is_behind = !is_statistic(&word) && (cell.is_number() || is_unit(&word));
        match found.last_mut() {
            Some(last) if is_behind => last.cells.push(cell),
            Some(last) if last.cells.is_empty() => last.title += &format!(" {word}"),
            _ => found.push(Unknown::line(&word, line, Vec::new())),
        }
    }
    found
}

/// A size behind its name.
pub(super) struct NamedSize {
    pub(super) name: String,
    pub(super) size: Length,
}

/// The size that a line ends with, behind each name that may be its: `Modul: 2,5 mm`.
pub(super) fn named_sizes(text: &str) -> impl Iterator<Item = NamedSize> {
    let words: Vec<&str> = text.split([' ', ':', '=', '\u{a0}']).filter(|word| !word.is_empty()).collect();
    (1..words.len()).filter_map(move |count| {
        let size = words[count..].join(" ").replace(',', ".").parse().ok()?;
        Some(NamedSize { name: words[..count].join(" "), size })
    })
}

/// The size of that name with which values are read: the length over which f_Hβ is evaluated, the diameter of the roller from
/// which the nominal measure follows.
pub(super) fn size_read_with(name: &str, columns: &[Column], want: &Want) -> Option<Length> {
    let over_face_width = |column: &&Column| column.evaluated_over_face_width(want);
    if WordList::EvaluationLength.has(name) {
        columns.iter().find_map(Column::evaluated_over)
    } else if WordList::FaceWidth.has(name) {
        columns.iter().find(over_face_width).and_then(Column::evaluated_over)
    } else {
        want.roller.filter(|_| WordList::Roller.has(name))
    }
}

/// Whether a text has words for a factor or a sign, or a fraction of a millimetre, or says of a number by how much values are
/// off: `0,06 zu groß`.
pub(super) fn has_scale(text: &str) -> bool {
    let has_fraction = || {
        let mut behind = text.split("1/10").skip(1).map(|behind| behind.trim_start_matches(['0', ' ']));
        behind.any(|behind| behind.starts_with("mm"))
    };
    WordList::Scale.is_in(text) || has_digit(text) && WordList::Shift.is_in(text) || has_fraction()
}

/// Whether a line says that values do not count, or a part, and has no other number than that of the part: `Messung ungültig`,
/// `Teil 422 Ausschuss`.
fn is_rejected(text: &str) -> bool {
    let words: Vec<&str> = text.split([' ', ':', ';', ',', '(', ')']).filter(|word| !word.is_empty()).collect();
    let is_behind_part = |at: usize| at.checked_sub(1).is_some_and(|before| is_part_name(words[before]));
    says_rejected(text)
        && (0..words.len())
            .all(|at| !words[at].starts_with(|c: char| c.is_ascii_digit()) || is_behind_part(at) || is_date(words[at]))
}

/// Whether the words before a number are those of a deviation, of the worst value or of a flank: `deviation 109`,
/// `worst part 109`, `right flank 109`.
fn speaks_of_deviation(text: &str) -> bool {
    let before = text.find(|c: char| c.is_ascii_digit()).map(|number| &text[..number]);
    // L1 is a line or a robot
    let is_flank =
        |words: &str| says_which(words.trim()) && (words.chars().count() > 1 || !words.ends_with(char::is_alphabetic));
    before.is_some_and(|words| WordList::Mean.has(words) || says_deviation(words) || is_flank(words))
}

/// Whether a text is a number that some column may hold and words that call it a value, and nothing else: `nochmal gemessen: 95`,
/// `95!`, `2→95`, `0.4 over`. The number of a tooth is none, nor is a digit behind a machine: `KMG 2`.
pub(super) fn says_value_alone(text: &str, columns: &[Column]) -> bool {
    // 2. Messung: 412
    let counted = without_list_number(text);
    let is_again = counted.len() < text.len() && counted.split_whitespace().next().is_some_and(repeats_value);
    let (mut has_number, mut is_said, mut is_named) = (false, is_again, false);
    // the digits that a number has at most which is that of the word before it
    let mut digits_of_name = 0;
    let is_mark = |c: char| "→⇒≈~>!=".contains(c);
    let text = counted.trim_end_matches('.').replace("->", "→").replace(": ", " = ").replace(is_mark, " = ");
    for word in text.split(|c: char| c.is_whitespace() || "(),;".contains(c)).filter(|word| !word.is_empty()) {
        let bare = word.strip_suffix("my").unwrap_or(word);
        let number = Cell::of_text(bare, 0..0);
        if number.is_measure() && !word.ends_with('.') && !word.contains([':', '/']) {
            let is_name = bare.len() <= digits_of_name;
            // beside `3 µm` nobody writes the unit once more
            let in_micrometres = Cell::of_text(&format!("{bare} µm"), 0..0);
            let may_hold = |column: &Column| column.may_hold(&number) || column.may_hold(&in_micrometres);
            has_number |= !is_name && columns.iter().any(may_hold);
            is_said |= bare.len() < word.len();
            is_named = is_name;
        } else if names_one(word) {
            // Zahn 3, 7
            (is_said, is_named, digits_of_name) = (true, false, usize::MAX);
        } else if WordList::Words.has(word) {
            digits_of_name = 1;
        } else if word == "=" || WordList::CallsValue.has(word) || WordList::Again.has(word) || says_which(word) {
            is_said = true;
            // Zahn: 3
            digits_of_name = if is_named || digits_of_name == 1 { 0 } else { digits_of_name };
        } else if WordList::Verb.has(word) {
            digits_of_name = 0;
        } else if !WordList::BesideValue.has(word) && !WordList::Report.has(word) {
            return false;
        }
    }
    has_number && is_said
}

/// Whether a number has a sign.
pub(super) fn is_signed(cell: &Cell) -> bool {
    cell.is_number() && cell.text().trim_start().starts_with(['+', '-', '\u{2212}'])
}

/// A number in a line that names a part of the table: `P2: 95`, `Bemerkung: Teil 2 zeigte 95`. A part with a bare number for a
/// name has a word for parts before it.
pub(super) fn of_part(aside: &AsideReading, shape: &Shape) -> Option<Unknown> {
    let is_number = |word: &str| Cell::of_text(word, 0..0).is_number();
    let text = plain_widths(&aside.text);
    let pieces = text.split_whitespace().filter(|word| !is_clock(word));
    let words: Vec<&str> = pieces.flat_map(|word| word.split([':', ';', ',', '=', '(', ')'])).collect();
    let ids: HashSet<Cow<'_, str>> = shape.ids.iter().flat_map(|ids| &ids.cells).map(Cell::text).collect();
    let names_one = |at: &usize| {
        let before = at.checked_sub(1).map(|before| words[before]);
        let is_plain = words[*at].bytes().all(|byte| byte.is_ascii_digit());
        has_digit(words[*at]) && ids.contains(words[*at]) && (!is_plain || before.is_some_and(is_part_name))
    };
    // one more, with as many numbers as a row has: A3 25 412
    let said: Vec<&str> = words.iter().copied().filter(|word| !word.is_empty()).collect();
    let is_row = || {
        let (name, values) = said.split_first()?;
        let are_values = values.len() == shape.measurements.len() && values.iter().all(|word| is_number(word));
        (shape.ids.is_some() && values.len() > 1 && are_values && shape.part_names().may_have(name)).then_some(0)
    };
    // Teil 421   Seite 1
    let at =
        (0..words.len()).find(names_one).or_else(is_row).filter(|at| !names_page(words[at + 1..].join(" ").trim()))?;
    let is_value = |word: &&&str| Cell::of_text(word, 0..0).is_measure() && !ids.contains(**word);
    let value = words[at + 1..].iter().find(is_value)?;
    Some(Unknown::line(words[at], aside.line, vec![Cell::of_text(value, 0..0)]).measured(true))
}

/// A line above rows of one part that names another one, by the word of their column: `Teil 421`.
pub(super) fn of_other_part(aside: &AsideReading, shape: &Shape) -> Option<Unknown> {
    let ids = shape.ids.as_ref().filter(|_| Some(aside.line) < shape.header_line)?;
    let PartLine { word, name } = part_line(&aside.text)?;
    let is_of_column = ids.title.to_lowercase().starts_with(&word.to_lowercase());
    let is_other = |id: &Cell| id.text() == ids.cells[0].text() && !id.text().contains(&name);
    let is_meant = is_of_column && ids.cells.iter().all(is_other) && shape.part_names().may_have(&name);
    is_meant.then(|| Unknown::line(&word, aside.line, vec![Cell::of_text(&name, 0..0)]).unread())
}

/// A number alone in its line among values behind their names.
pub(super) fn without_name(aside: &AsideReading, shape: &Shape) -> Option<Unknown> {
    let cell = Cell::of_text(without_list_number(aside.text.trim()), 0..0);
    let is_among_values = shape.orientation == Orientation::Columns && shape.header.is_empty();
    (is_among_values && cell.is_number()).then(|| Unknown::line("", aside.line, vec![cell]).measured(true))
}

/// A line without the number of a section or a list in front of it: `1. Geometry`.
fn without_list_number(line: &str) -> &str {
    const MOST_DIGITS: usize = 2;
    let is_count = |number: &str| number.len() <= MOST_DIGITS && number.bytes().all(|byte| byte.is_ascii_digit());
    let counted = line.split_once(['.', ')']).filter(|(number, said)| is_count(number) && said.starts_with(' '));
    counted.map_or(line, |(_, said)| said.trim())
}

/// A line of prose without what stands around its words and numbers: `A: 25,061.`, `(25,061 mm)`, `25,061/25,011`,
/// `部品Bは25.061でした。` A day keeps its dots.
pub(super) fn without_punctuation(line: &str) -> String {
    let is_kept = |c: char| c.is_alphanumeric() || "+-\u{2212}°'′″%€$".contains(c);
    let is_day = |word: &str| word.ends_with('.') && word.split('.').all(|part| part.len() <= 2);
    let is_decimal = |word: &str| Cell::of_text(word, 0..0).has_decimals();
    // kana and ideographs have no blanks between them and numbers
    let is_unspaced = |c: char| c >= '\u{3000}';
    let mut spaced = String::new();
    for c in plain_widths(&line.replace('：', " ")).chars() {
        if spaced.chars().next_back().is_some_and(|last| is_unspaced(last) != is_unspaced(c)) {
            spaced.push(' ');
        }
        spaced.push(c);
    }
    let words = spaced.split(|c: char| c.is_whitespace() || matches!(c, '|' | ';')).filter(|word| !word.is_empty());
    // an arrow is no sign
    let words = words.filter(|word| *word == "+" || word.contains(char::is_alphanumeric));
    let words = words.map(|word| match word.split_once(['/', '-', '–', '…']) {
        Some((first, second)) if is_decimal(first) && is_decimal(second) => format!("{first} {second}"),
        _ if is_day(word) => word.to_owned(),
        _ => apart(word).trim_matches(|c| !is_kept(c)).to_owned(),
    });
    words.collect::<Vec<_>>().join(" ")
}

/// A word with a number of two decimals inside, which stands apart then: `P2=25,064`, `Ø25,064`, `25,064/25,012`.
fn apart(word: &str) -> String {
    let is_of_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',');
    let runs = word.split_inclusive(|c| !is_of_number(c)).map(|run| {
        let number = run.trim_end_matches(|c| !is_of_number(c));
        (number, &run[number.len()..])
    });
    let is_measure = |run: &str| Cell::of_text(run, 0..0).has_two_decimals();
    let runs =
        runs.map(|(run, behind)| if is_measure(run) { format!(" {run} {behind}") } else { format!("{run}{behind}") });
    let spaced: String = runs.collect();
    // a sign and a unit belong to it
    if Cell::of_text(word, 0..0).is_measure() {
        word.to_owned()
    } else {
        spaced.split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

/// Whether a text names a part, a space or a tooth, whose number stands behind it.
fn names_one(text: &str) -> bool {
    heading(text, &[]).is_some_and(|heading| heading.fields.iter().all(|field| field.is_index()))
}

/// Cells without numbers in units that are none of lengths or angles: `20,3 °C`.
fn without_foreign(cells: &[Cell]) -> impl Iterator<Item = &Cell> {
    let is_unit = |cell: &Cell| {
        let text = cell.text();
        let unit = text.trim_end_matches([',', ';', '.', ')']);
        is_foreign_unit(unit) && !matches!(unit, "-" | "1")
    };
    // `95 µm am Zahn 7` is no time of day
    let has_none = |cell: &Cell| cell.is_number() && unit_in(&cell.text()).is_none();
    let is_other = move |at: usize| has_none(&cells[at]) && cells.get(at + 1).is_some_and(is_unit);
    (0..cells.len()).filter(move |at| !is_other(*at)).map(|at| &cells[at])
}

/// The first name in a line that is more than context, and the values behind it.
fn named_values(cells: &[Cell], line: u64) -> Option<Unknown> {
    let words = cells.iter().take_while(|cell| !cell.is_measure() && !has_digit(&cell.text())).count();
    // a time, a number in a list, or the value stands before the name
    if words == 0 {
        let (first, rest) = cells.split_first()?;
        let numbers = || Unknown::numbers(&first.text(), line, rest).filter(|_| !near(&first.text()).is_empty());
        if let Some(found) = numbers() {
            return Some(found.measured(true));
        }
        let alone = || Unknown::numbers("", line, std::slice::from_ref(first));
        return named_values(rest, line).map_or_else(alone, |mut found| {
            found.cells.push(first.clone());
            Some(found)
        });
    }
    let (label, values) = cells.split_at(words);
    let text = label.iter().map(Cell::text).collect::<Vec<_>>().join(" ");
    // a known name counts, whatever stands in place of its number: `rack pitch 12...15 µm`
    let is_known = !near(&text).is_empty() || role(&text) == Some(Role::Nominal);
    // an order, a page, a date, a space: the word before the number says what it is
    let is_named = is_known && values.first().is_some_and(Cell::has_decimals);
    if !is_named && (is_context(text.split_whitespace().next_back()?) || names_one(&text)) {
        let rest = values.get(1..)?;
        // Part 2: 25.2 mm
        let is_value = rest.first().is_some_and(Cell::is_measure);
        let of_part = || Unknown::numbers("", line, rest).filter(|_| names_one(&text));
        return named_values(rest, line).or_else(of_part).map(|found| found.measured(is_value && names_one(&text)));
    }
    // Pos. 5 Rack pich 0.21
    let behind = (!is_known).then(|| named_values(values.get(1..)?, line)).flatten();
    if let Some(behind) = behind.filter(|behind| !near(&behind.title).is_empty()) {
        return Some(behind);
    }
    let unread = || {
        let whole = values.iter().map(Cell::text).collect::<Vec<_>>().join(" ");
        Unknown::line(&text, line, vec![Cell::of_text(&whole, 0..0)])
    };
    let numbers = Unknown::numbers(&text, line, values);
    numbers.or_else(|| is_known.then(unread)).map(|unknown| unknown.measured(is_known))
}
