//! Lines that say in words what was measured, as people write them:
//! ```text
//! Part 1: over roller 25.012 mm (nominal 25 mm, dev. +0.012 mm), rack pitch 3 µm
//! Part 2: over roller is 25.020 mm
//! ```
//! Each value is one of a table of characteristics. A line counts if all of it is understood: with anything left over (`NOK`,
//! `or 25.113`), it is a line beside the table. Called by [`shape`](super::shape).

use std::collections::{BTreeSet, HashMap, HashSet};

use super::characteristics::{Characteristics, by_characteristic};
use super::headings::{is_extreme, is_part_name};
use super::labels::says_value;
use super::words::{Token, is_colon_behind, speaker, tokens, word, words};
use super::{NoShape, Shape, has_digit, unknown_line};
use crate::deviation::{DeviationKind, Part as Gear};
use crate::table::cell::{Cell, Record};
use crate::table::column::has_tolerance_behind;
use crate::table::grid::{Separator, records, unit_in};
use crate::table::names::{Field, Role, ValueKind, WordList, heading, part_said, role};
use crate::table::reading::AsideReading;
use crate::table::unknown::Unknown;
use crate::table::want::Want;

/// The columns of the table that sentences make, and what they are called.
const COLUMNS: [(Role, &str); 7] = [
    (Role::Part, "part"),
    (Role::Name, "characteristic"),
    (Role::Measured, "actual"),
    (Role::Nominal, "nominal"),
    (Role::Deviation, "deviation"),
    (Role::Upper, "upper limit"),
    (Role::Lower, "lower limit"),
];
const PART: usize = 0;
const NAME: usize = 1;

/// What a characteristic is called.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Name {
    fields: Vec<Field>,
    holds: Option<ValueKind>,
}

/// What stands before a number.
#[derive(Clone)]
struct Label {
    /// The characteristic; `None` where it is the one before.
    name: Option<Name>,
    /// As the line calls it.
    title: String,
    role: Role,
    /// The word that says so, if there is one.
    said: String,
}

/// A part, by a word for parts and its name: `Part 1`.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct Part {
    word: String,
    name: String,
}

/// A line that names a part.
struct PartHeading {
    part: Part,
    record: Record,
}

/// A line that names a characteristic of which values of parts stand in the lines below: `Rollenmaß:`.
struct Subject {
    label: Label,
    record: Record,
    is_used: bool,
}

/// What a line says.
enum Said {
    Part(Part),
    Value { label: Label, cell: Cell },
}

/// The values of one characteristic of a part.
struct Row {
    part: Option<Part>,
    name: Name,
    record: Record,
}

/// What lines say, so far.
#[derive(Default)]
struct Sentences {
    rows: Vec<Row>,
    /// Where the row of a part and a characteristic is, and the first one of the characteristic.
    places: HashMap<String, usize>,
    /// The parts that are named, in their order.
    parts: Vec<Part>,
    named: HashSet<Part>,
    /// That of which the lines speak.
    part: Option<Part>,
    /// Whether that is a rack or a pinion, if a line says so.
    gear: Option<Gear>,
    notes: Vec<String>,
    /// Whether a line says what an asterisk behind a number means, and that it means nothing.
    has_footnote: bool,
    /// What the columns are called first.
    titles: [Option<String>; COLUMNS.len()],
    /// Lines that name a part and nothing else.
    headings: Vec<PartHeading>,
    /// The characteristic that a line above names alone.
    subject: Option<Subject>,
    /// Lines that are not understood.
    others: Vec<Record>,
    /// The first line that begins with a value and has more.
    half_understood: Option<Record>,
}

/// The lines that are sentences, as a table.
pub(super) fn by_sentence(records: &[Record], want: &Want) -> Result<Shape, NoShape> {
    if !want.fields.is_empty() || want.teeth == Some(true) {
        return Err(NoShape::NoNumbers);
    }
    let has_footnote = records.iter().any(is_footnote);
    let mut sentences = Sentences { has_footnote, ..Sentences::default() };
    for record in records {
        if !sentences.take(record, want)? {
            sentences.leave_subject();
            sentences.others.push(record.clone());
        }
    }
    sentences.leave_subject();
    let Sentences { rows, parts, notes, half_understood, titles, headings, mut others, .. } = sentences;
    let has_parts = rows.iter().any(|row| row.part.is_some());
    let Some(first) = rows.first().filter(|_| rows.iter().all(|row| row.part.is_some() == has_parts)) else {
        return Err(half_understood.map_or(NoShape::NoNumbers, |record| NoShape::Sentence { record }));
    };
    let first = first.record.clone();
    let mut lines: BTreeSet<u64> = rows.iter().map(|row| row.record.line).collect();
    // a part of which nothing is said is one without values
    let with_values: HashSet<&Part> = rows.iter().flat_map(|row| &row.part).collect();
    let words: HashSet<String> = with_values.iter().map(|part| part.word.clone()).collect();
    // of which part a pitch is, the names of the parts tell: Rack 1
    let want = &*want.of_part(words.iter().cloned());
    let is_like_others = |part: &Part| words.contains(&part.word);
    let has_none = |part: &Part| !with_values.contains(part);
    let without = parts.iter().filter(|part| is_like_others(part) && has_none(part)).map(|part| {
        let mut cells = vec![Cell::default(); COLUMNS.len()];
        (cells[PART], cells[NAME]) = (Cell::of_text(&part.name, 0..0), first.cells[NAME].clone());
        Record { cells, ..first.clone() }
    });
    let without: Vec<Record> = without.collect();
    others.extend(headings.into_iter().filter(|heading| !is_like_others(&heading.part)).map(|heading| heading.record));
    let titles = titles.iter().zip(COLUMNS).map(|(said, (_, title))| said.as_deref().unwrap_or(title));
    let header = titles.map(|title| Cell::of_text(title, 0..0)).collect();
    let mut table = vec![Record { cells: header, ..first }];
    table.extend(rows.into_iter().map(|row| with_one_unit(row, want)).chain(without));
    let first_used = if has_parts { PART } else { NAME };
    for record in &mut table {
        record.cells.drain(..first_used);
    }
    let roles = COLUMNS[first_used..].iter().map(|(role, _)| Some(*role)).collect();
    let found = Characteristics::below_header(&table, roles, &others);
    let mut shape = by_characteristic(found, Separator::Sentences, want)?;
    shape.header_line = None;
    let asides = std::mem::take(&mut shape.asides);
    for aside in asides {
        let is_right_below = lines.contains(&aside.line.saturating_sub(1));
        lines.extend(is_right_below.then_some(aside.line));
        match unread(&aside, &lines, is_right_below) {
            Some(unknown) => shape.unknown.push(unknown),
            None => shape.asides.push(aside),
        }
    }
    shape.notes.extend(notes);
    Ok(shape)
}

/// Whether a line says behind an asterisk that something was measured, and at which temperature: `* measured at 20 °C`.
fn is_footnote(line: &Record) -> bool {
    let text = line.in_words();
    let Some(said) = text.strip_prefix('*') else { return false };
    let (words, number) = said.split_at(said.find(|c: char| c.is_ascii_digit()).unwrap_or(said.len()));
    let is_temperature = Cell::of_text(number, 0..0).is_number() && number.ends_with("°C");
    role(words) == Some(Role::Measured) && (number.is_empty() || is_temperature)
}

/// A line beside sentences that may say a value, or that one does not count: `Second part 103 µm`, `Part 1: NOK`. Among the
/// sentences, and right below them with decimals, every number may be one.
fn unread(line: &AsideReading, sentences: &BTreeSet<u64>, is_right_below: bool) -> Option<Unknown> {
    if is_rejected(&tokens(&line.text, 0, 0)) {
        return Some(Unknown::line(&line.text, line.line, vec![Cell::of_text(&line.text, 0..0)]).unread());
    }
    let record = records(&line.text, Separator::Blanks).ok()?.into_iter().next()?;
    let title = record.cells[0].text();
    if record.numbers() == 0 || record.filled().len() < 2 || record.cells[0].is_measure() || is_part_name(&title) {
        return None;
    }
    let behind = &record.cells[1..];
    let is_between = sentences.first() < Some(&line.line) && Some(&line.line) < sentences.last();
    let is_among = is_between || is_right_below && behind.iter().any(Cell::has_decimals);
    let unknown = unknown_line(&Record { line: line.line, ..record.clone() }, is_among || says_value(&title, behind));
    Some(unknown).filter(Unknown::could_be_measured)
}

/// Whether a line says that somebody is not content, perhaps with a part: `NOK`, `Part 1 is n.i.O.`
fn is_rejected(tokens: &[Token]) -> bool {
    let mut words = tokens.iter().filter_map(word).filter(|word| !WordList::Verb.has(word) && !is_part_name(word));
    let (Some(said), None) = (words.next(), words.next()) else { return false };
    let is_said = role(said) == Some(Role::Status) || WordList::Again.has(said) || WordList::Rejected.has(said);
    is_said && !WordList::Approval.has(said)
}

/// The place of a role among the columns.
fn column(role: Role) -> Option<usize> {
    COLUMNS.iter().position(|(other, _)| *other == role)
}

/// A row of which the numbers without a unit have that of the value, and the value that of its nominal one; a deviation has it
/// where it is held against the value.
fn with_one_unit(row: Row, want: &Want) -> Record {
    let Row { name, mut record, .. } = row;
    let text = |role: Role| column(role).map(|place| record.cells[place].text()).unwrap_or_default();
    let given = name.fields[0].kind().and_then(|kind| want.given(kind));
    let has_nominal = !text(Role::Nominal).is_empty() || given.is_some_and(|given| given.nominal.is_some());
    let unit = unit_in(&text(Role::Measured)).or_else(|| unit_in(&text(Role::Nominal)));
    let Some(unit) = unit else { return record };
    for (cell, (role, _)) in record.cells.iter_mut().zip(COLUMNS).skip(NAME + 1) {
        let is_checked = role != Role::Deviation || has_nominal;
        if is_checked && !cell.is_empty() && unit_in(&cell.text()).is_none() {
            *cell = Cell::of_text(&format!("{} {unit}", cell.text()), cell.span.clone());
        }
    }
    record
}

impl Sentences {
    /// Takes a line, if all of it is understood; whether it is. A part that a line names is one, whatever is said of it.
    fn take(&mut self, record: &Record, want: &Want) -> Result<bool, NoShape> {
        let Some(line) = record.cells.first() else { return Ok(false) };
        let text = if self.has_footnote { line.text().replace('*', " ") } else { line.text().into_owned() };
        let speaker = speaker(&text);
        let tokens = tokens(&text, speaker.len(), line.span.start);
        let subject = words(&tokens).and_then(|words| label_of(&words, want));
        if let Some(label) = subject.filter(|label| label.name.is_some() && label.role == Role::Measured) {
            self.leave_subject();
            self.subject = Some(Subject { label, record: record.clone(), is_used: false });
            return Ok(true);
        }
        let mut reader = LineReader { rest: &tokens, said: Vec::new(), want, subject: self.subject.as_mut() };
        let is_understood = reader.all();
        let said = reader.said;
        let is_understood = is_understood && self.take_gear(&said);
        if !is_understood {
            if let Some(Said::Part(part)) = said.first() {
                self.name(part);
            }
            if said.iter().any(|said| matches!(said, Said::Value { .. })) {
                self.half_understood.get_or_insert(record.clone());
            }
            return Ok(false);
        }
        if let [Said::Part(part)] = &said[..] {
            self.headings.push(PartHeading { part: part.clone(), record: record.clone() });
        }
        let mut current: Option<Name> = None;
        for said in said {
            match said {
                Said::Part(part) => {
                    self.name(&part);
                    self.part = Some(part);
                }
                Said::Value { label, cell } => {
                    current = label.name.clone().or(current);
                    let Some(name) = &current else { return Ok(false) };
                    if let Some(place) = column(label.role).filter(|_| !label.said.is_empty()) {
                        self.titles[place].get_or_insert(label.said);
                    }
                    self.row(name, &label.title, record).fill(label.role, cell)?;
                }
            }
        }
        if !speaker.is_empty() {
            self.notes.push(format!("line {}: `{}` is taken for who wrote it, and when", record.line, speaker.trim()));
        }
        Ok(true)
    }

    /// Takes of which gear a line speaks; whether all of its values are of the one that is named last. The name of a
    /// characteristic leaves that open where both have it.
    fn take_gear(&mut self, said: &[Said]) -> bool {
        let mut of_part = None;
        said.iter().all(|said| {
            let label = match said {
                Said::Part(part) => {
                    of_part = part_said(&part.word);
                    self.gear = of_part.or(self.gear);
                    return true;
                }
                Said::Value { label, .. } => label,
            };
            self.gear = part_said(&label.title).or(self.gear);
            let field = label.name.as_ref().and_then(|name| name.fields.first());
            let Some(kind) = field.and_then(|field| field.kind()) else { return true };
            let is_of_one = matches!(kind, DeviationKind::RackOverRoller | DeviationKind::PinionRadial);
            let of = if is_of_one { of_part } else { self.gear };
            of.is_none_or(|of| kind.part() == of)
        })
    }

    /// Ends the lines below a characteristic; without a value among them, nothing tells what it is.
    fn leave_subject(&mut self) {
        let unused = self.subject.take().filter(|subject| !subject.is_used);
        self.others.extend(unused.map(|subject| subject.record));
    }

    fn name(&mut self, part: &Part) {
        if self.named.insert(part.clone()) {
            self.parts.push(part.clone());
        }
    }

    /// The row of a characteristic of the part of which the lines speak; its title is the first one.
    fn row(&mut self, name: &Name, title: &str, line: &Record) -> &mut Row {
        let next = self.rows.len();
        let first = *self.places.entry(format!("{name:?}")).or_insert(next);
        let at = *self.places.entry(format!("{name:?} {:?}", self.part)).or_insert(next);
        if at == next {
            let mut cells = vec![Cell::default(); COLUMNS.len()];
            let named = self.rows.get(first).map(|row| row.record.cells[NAME].clone());
            cells[NAME] = named.unwrap_or_else(|| Cell::of_text(title, line.span()));
            if let Some(part) = &self.part {
                cells[PART] = Cell::of_text(&part.name, line.span());
            }
            let record = Record { cells, ..line.clone() };
            self.rows.push(Row { part: self.part.clone(), name: name.clone(), record });
        }
        &mut self.rows[at]
    }
}

impl Row {
    /// Fills the cell of a role; a second value of one leaves open which of them counts.
    fn fill(&mut self, role: Role, value: Cell) -> Result<(), NoShape> {
        let heading = self.record.cells[NAME].clone();
        match column(role).map(|place| &mut self.record.cells[place]) {
            Some(cell) if cell.is_empty() => {
                *cell = value;
                Ok(())
            }
            _ => Err(NoShape::Twice { heading, field: self.name.fields[0], may_tell: Vec::new() }),
        }
    }
}

/// A line of which a part is read.
struct LineReader<'t> {
    rest: &'t [Token],
    said: Vec<Said>,
    want: &'t Want,
    subject: Option<&'t mut Subject>,
}

impl LineReader<'_> {
    /// Reads the line; whether all of it is understood, and says something.
    fn all(&mut self) -> bool {
        while !self.rest.is_empty() {
            if !(self.mark() || self.part() || self.approval() || self.brackets() || self.value()) {
                return false;
            }
        }
        !self.said.is_empty()
    }

    /// What stands between two values, and a mark before the first: a bullet.
    fn mark(&mut self) -> bool {
        let is_mark = match self.rest.first() {
            Some(Token::Mark(mark)) => matches!(mark, ',' | ';' | '.' | '、' | '，'),
            Some(Token::Word(word)) => {
                matches!(word.as_str(), "-" | "–" | "—" | "•" | "*" | "·") && self.said.is_empty()
            }
            _ => false,
        };
        self.rest = &self.rest[usize::from(is_mark)..];
        is_mark
    }

    /// A part's name behind a word for parts, and a mark: `Part 1:`.
    fn part(&mut self) -> bool {
        const MOST_WORDS: usize = 3;
        let words = self.rest.iter().take(MOST_WORDS).map_while(word).collect::<Vec<_>>();
        let named = (1..=words.len()).find_map(|count| {
            let word = words[..count].join(" ");
            let is_colon = matches!(self.rest.get(count), Some(Token::Mark(':' | '：')));
            let at = count + usize::from(is_colon);
            let is_gear = || is_colon_behind(&self.rest[at..]) && part_said(&word).is_some() && count == 1;
            let name = part_name(self.rest.get(at)?).filter(|_| is_part_name(&word) || is_gear())?;
            let is_end = match self.rest.get(at + 1) {
                Some(Token::Mark(mark)) => matches!(mark, ':' | '：' | ',' | ';'),
                Some(_) => false,
                None => self.said.is_empty(),
            };
            is_end.then(|| (Part { word: word.to_lowercase(), name }, at + 2))
        });
        let of_code = || match self.rest {
            [Token::Word(code), ..] if has_digit(code) && self.said.is_empty() && is_colon_behind(self.rest) => {
                let is_code = code.chars().all(|c| c.is_alphanumeric() || matches!(c, '-' | '_' | '/'));
                is_code.then(|| (Part { word: String::new(), name: code.clone() }, 2))
            }
            _ => None,
        };
        let Some((part, count)) = named.or_else(of_code) else { return false };
        self.said.push(Said::Part(part));
        self.rest = self.rest.get(count..).unwrap_or_default();
        true
    }

    /// Whether a value stands before the rest.
    fn is_behind_value(&self) -> bool {
        matches!(self.said.last(), Some(Said::Value { .. }))
    }

    /// That somebody is content with the value before it.
    fn approval(&mut self) -> bool {
        let length = match self.rest {
            [Token::Word(word), ..] if WordList::Approval.has(word) => 1,
            [Token::Mark('('), Token::Word(word), Token::Mark(')'), ..] if WordList::Approval.has(word) => 3,
            _ => 0,
        };
        let length = if self.is_behind_value() { length } else { 0 };
        self.rest = &self.rest[length..];
        length > 0
    }

    /// What is wanted of the value before it, or by how much it deviates: `(nominal 25 mm, dev. +0.012 mm)`.
    fn brackets(&mut self) -> bool {
        let Some((Token::Mark('(' | '（'), rest)) = self.rest.split_first() else { return false };
        let is_end = |token: &Token| matches!(token, Token::Mark(')' | '）'));
        let Some(end) = rest.iter().position(is_end).filter(|_| self.is_behind_value()) else { return false };
        let is_between = |token: &Token| matches!(token, Token::Mark(',' | ';'));
        // the smallest and the largest one may be measured
        let is_extreme = |item: &&[Token]| {
            words(&item[..item.len().saturating_sub(1)]).is_some_and(|title| is_extreme(&title.join(" ")))
        };
        if rest[..end].split(is_between).filter(is_extreme).count() > 1 {
            return false;
        }
        for item in rest[..end].split(is_between) {
            let Some((Token::Number(cell), title)) = item.split_last() else { return false };
            let Some(title) = words(title) else { return false };
            let role = if title.is_empty() { Some(Role::Nominal) } else { role(&title.join(" ")) };
            let is_sized = !title.is_empty() || has_tolerance_behind(&cell.text());
            let Some(role) = role.filter(|role| role.is_beside_value() && column(*role).is_some() && is_sized) else {
                return false;
            };
            let label = Label { name: None, title: String::new(), role, said: title.join(" ") };
            self.said.push(Said::Value { label, cell: cell.clone() });
        }
        self.rest = &rest[end + 1..];
        true
    }

    /// A value behind its name, behind what it is of the characteristic before it (`Soll 25,000`), or behind a part below the
    /// name.
    fn value(&mut self) -> bool {
        let Some(at) = self.rest.iter().position(|token| matches!(token, Token::Number(_))) else { return false };
        let (label, rest) = self.rest.split_at(at);
        let label = if label.is_empty() && matches!(self.said[..], [Said::Part(_)]) {
            self.subject.as_mut().map(|subject| {
                subject.is_used = true;
                subject.label.clone()
            })
        } else {
            words(label).and_then(|words| label_of(&words, self.want))
        };
        let (Some(label), Some((Token::Number(cell), rest))) = (label, rest.split_first()) else { return false };
        let is_said = label.name.is_some() || self.is_behind_value();
        if !is_said || label.role != Role::Nominal && has_tolerance_behind(&cell.text()) {
            return false;
        }
        self.said.push(Said::Value { label, cell: cell.clone() });
        self.rest = rest;
        true
    }
}

/// The name of a part: a number, a letter, or a word with a digit.
fn part_name(token: &Token) -> Option<String> {
    let is_name = |word: &str| has_digit(word) || word.chars().count() == 1 && word.chars().all(char::is_alphabetic);
    match token {
        Token::Word(word) => Some(word.clone()).filter(|word| is_name(word)),
        Token::Number(cell) => Some(cell.text().into_owned()).filter(|_| cell.is_whole()),
        Token::Mark(_) => None,
    }
}

/// What words before a number say, of which all are known: a characteristic (`over roller is`), and what the number is of it
/// (`Rollenmaß Soll`, `actual`).
fn label_of(words: &[&str], want: &Want) -> Option<Label> {
    let is_verb = |word: &&&str| WordList::Verb.has(word);
    let verbs = words.iter().rev().take_while(is_verb).count();
    let words = &words[..words.len() - verbs];
    let whole = words.join(" ");
    if let Some(role) = role(&whole).filter(|role| may_stand_alone(*role)) {
        return Some(Label { name: None, title: String::new(), role, said: whole });
    }
    let named = |text: &str| {
        let heading = heading(text, &want.own)?;
        let is_value = heading.aspect == Role::Measured && !heading.is_index();
        is_value.then_some(Name { fields: heading.fields, holds: heading.holds })
    };
    let is_said = |word: &&str| role(word).is_some_and(may_stand_alone);
    let first = words.iter().position(|word| !is_said(word))?;
    let last = words.iter().rposition(|word| !is_said(word))?;
    let title = words[first..=last].join(" ");
    let said = [&words[..first], &words[last + 1..]].concat().join(" ");
    let is_same = |name: &Name| heading(&whole, &want.own).is_none_or(|heading| heading.fields == name.fields);
    let said_role =
        if said.is_empty() { Some(Role::Measured) } else { role(&said).filter(|role| may_stand_alone(*role)) };
    if let (name @ Some(_), Some(role)) = (named(&title).filter(is_same), said_role) {
        return Some(Label { name, title, role, said });
    }
    let name = Some(named(&whole)?);
    Some(Label { name, title: whole, role: Role::Measured, said: String::new() })
}

/// Whether a number of that role may stand outside brackets.
fn may_stand_alone(role: Role) -> bool {
    matches!(role, Role::Measured | Role::Nominal | Role::Deviation)
}
