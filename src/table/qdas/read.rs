//! Reads Q-DAS ASCII text, line by line. Called by [`read`](fn@super::read); keeps what the file says, and judges nothing.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::definition::{Draft, NUMBERS, Said};
use super::keys::{Line, changes_values, counts, has_free_words, is_number, is_of_format, keyed};
use super::{Characteristic, LeftOut, OF_NO_SIZE, PartDefinition, Qdas, Remark, Value};
use crate::diagnostic::{Code, Diagnostic, Source};
use crate::quantity::Decimal;
use crate::table::cell::Content;
use crate::table::chunk::LONGEST_RECORD;
use crate::table::ledger::Tally;
use crate::table::number::{DecimalMark, normalise};

/// Characteristics or parts of a header at most. A higher number is an error of the file.
const MOST_CHARACTERISTICS: usize = 10_000;
/// Characteristics of all headers at most.
const MOST_IN_ALL: usize = 500_000;
/// Values of a file at most: a lot of a million parts has some millions.
const MOST_VALUES: usize = 8_000_000;
/// How often keys may be applied to a characteristic in all: a key with `/0` is applied to each.
const MOST_WORK: usize = 100_000_000;

#[derive(Default)]
struct Reader {
    /// The file that is read.
    source: Arc<Source>,
    parts: Vec<PartDefinition>,
    /// The characteristics of the headers before this one.
    characteristics: Vec<Characteristic>,
    /// The characteristics of this header.
    drafts: Vec<Draft>,
    /// How many characteristics K0100 says, and where.
    count: Option<(usize, Said)>,
    /// The first part of this header.
    first_part: usize,
    part: usize,
    /// Lines of values so far.
    samples: u32,
    /// Lines of values before this header.
    first_sample: u32,
    values: usize,
    /// Whether this header has values.
    has_values: bool,
    work: usize,
    part_names: Vec<String>,
    /// The values that do not count, by their attribute.
    left_out: BTreeMap<String, LeftOut>,
    remarks: Vec<Remark>,
    /// What else the file says.
    said: Tally,
}

/// Reads a file, or a file of definitions and the file of its values: name and text of each, in that order.
///
/// # Errors
/// A line with neither a key nor values, an index beyond K0100, or a text in place of a number; with file, line and key.
pub fn read(files: &[(&str, &str)]) -> Result<Qdas, Diagnostic> {
    read_all(files.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect())
}

/// The same for texts that the caller gives away.
pub(crate) fn read_all(files: Vec<(String, String)>) -> Result<Qdas, Diagnostic> {
    let mut reader = Reader::default();
    for (name, mut text) in files {
        let marks = text.len() - text.trim_start_matches('\u{feff}').len();
        text.drain(..marks);
        reader.source = Arc::new(Source::new(name, text));
        reader.file()?;
    }
    reader.finish()
}

impl Reader {
    fn bad(&self, line: Range<usize>, message: String) -> Diagnostic {
        Diagnostic::error(Code::BadTable, message).at(&self.source, line, "")
    }

    fn file(&mut self) -> Result<(), Diagnostic> {
        let source = Arc::clone(&self.source);
        let mut start = 0;
        for (number, whole) in source.text.split_inclusive('\n').enumerate() {
            let line = whole.trim_end_matches(['\n', '\r', '\u{1a}']);
            let at = start;
            start += whole.len();
            if line.trim().is_empty() {
                continue;
            }
            if line.len() > LONGEST_RECORD {
                let message = format!("the line is longer than {} KiB", LONGEST_RECORD >> 10);
                return Err(self.bad(at..at + 1, message));
            }
            let number = u32::try_from(number + 1).unwrap_or(u32::MAX);
            match keyed(line, at) {
                Some(Ok(line)) => self.field(&line, number)?,
                Some(Err(problem)) => return Err(self.bad(at..at + line.len(), problem)),
                None => self.values(line, at, number)?,
            }
        }
        Ok(())
    }

    fn draft(&mut self, index: usize, line: &Line<'_>) -> Result<&mut Draft, Diagnostic> {
        let count = self.counted();
        if index == 0 || index > count.unwrap_or(MOST_CHARACTERISTICS) {
            let message = match count {
                Some(count) => format!("K{:04}/{index}: the file has {count} characteristics (K0100)", line.key),
                None => format!("K{:04}/{index}: there is no characteristic of that number", line.key),
            };
            return Err(self.bad(line.span(), message));
        }
        if self.drafts.len() < index {
            self.drafts.resize(index, Draft::default());
        }
        let draft = &mut self.drafts[index - 1];
        draft.part.get_or_insert(self.part);
        Ok(draft)
    }

    /// How many characteristics this header has, if it says so.
    fn counted(&self) -> Option<usize> {
        self.count.as_ref().map(|(count, _)| *count)
    }

    fn field(&mut self, line: &Line<'_>, number: u32) -> Result<(), Diagnostic> {
        let text = line.text.trim();
        let index = self.source.text[line.at..line.start].trim();
        let is_own = is_of_format(line.key) && !(has_free_words(line.key) && text.contains(char::is_alphabetic));
        if is_own {
            // the text is a value, which is read; only the index is the format's
            let said = if line.key == 1 { index.to_owned() } else { format!("{index} {text}") };
            self.said.add(number.into(), 0, &said);
        } else if !text.is_empty() {
            self.said.add(number.into(), 0, index);
            self.remarks.push(Remark { key: line.key, line: number, text: text.to_owned() });
        }
        match line.key {
            100 => self.count_field(line),
            1..=99 => self.value_field(line, number),
            1000..=1999 => self.part_field(line),
            2000..=2999 => self.characteristic_field(line),
            _ => Ok(()),
        }
    }

    /// K0100 starts a header; behind values it starts the next one.
    fn count_field(&mut self, line: &Line<'_>) -> Result<(), Diagnostic> {
        let count = line.text.trim().parse::<usize>().ok().filter(|count| *count <= MOST_CHARACTERISTICS);
        let Some(count) = count else {
            let message =
                format!("K0100: `{}` is not a number of characteristics (0 to {MOST_CHARACTERISTICS})", line.text);
            return Err(self.bad(line.span(), message));
        };
        if self.has_values {
            self.end_header()?;
        }
        if let Some(other) = self.counted().filter(|other| *other != count) {
            let message = format!("K0100 counts {count} characteristics, and {other} before it in the same header");
            return Err(self.bad(line.span(), message));
        }
        self.count = Some((count, self.said(line)));
        Ok(())
    }

    /// What a line says, with its place.
    fn said(&self, line: &Line<'_>) -> Said {
        let source = Arc::clone(&self.source);
        Said { text: line.text.trim().to_owned(), of_all: line.index == 0, source, span: line.span() }
    }

    fn part_field(&mut self, line: &Line<'_>) -> Result<(), Diagnostic> {
        let index = line.index.max(1);
        if index > MOST_CHARACTERISTICS {
            let message = format!("K{:04}/{index}: there is no part of that number", line.key);
            return Err(self.bad(line.span(), message));
        }
        self.part = self.first_part + index - 1;
        if self.parts.len() <= self.part {
            self.parts.resize(self.part + 1, PartDefinition::default());
        }
        let part = &mut self.parts[self.part];
        let known = match line.key {
            1001 => &mut part.number,
            1002 => &mut part.name,
            1008 => &mut part.kind,
            _ => return Ok(()),
        };
        let text = line.text.trim();
        if known.is_empty() {
            text.clone_into(known);
        }
        if known == text || text.is_empty() {
            return Ok(());
        }
        let message = format!("K{:04}/{index} says `{text}`, and `{known}` before it", line.key);
        Err(self
            .bad(line.span(), message)
            .help("a header of another part starts with K0100, or the part has its own /i"))
    }

    fn characteristic_field(&mut self, line: &Line<'_>) -> Result<(), Diagnostic> {
        let indices = match (line.index, self.counted()) {
            (0, count) => 1..=count.unwrap_or(self.drafts.len()).max(1),
            (index, _) => index..=index,
        };
        self.work(indices.clone().count(), line)?;
        let mut said = self.said(line);
        if NUMBERS.contains(&line.key) && !said.text.is_empty() {
            // no thousands marks, so that a comma is a decimal comma
            let plain = said.text.replace(',', ".");
            if !is_number(&plain) || normalise(&plain, DecimalMark::Point).is_none() {
                let message = format!("K{:04}/{}: `{}` is not a number", line.key, line.index, said.text);
                return Err(self.bad(line.span(), message));
            }
            said.text = plain;
        }
        if let Some(what) = changes_values(line.key, &said.text) {
            let message = format!("K{:04}/{} says {what} `{}`", line.key, line.index, said.text);
            let help =
                "the file does not say whether its values include it: write them as they count, without this key";
            return Err(self.bad(line.span(), message).help(help));
        }
        for index in indices {
            self.draft(index, line)?.say(line.key, said.clone())?;
        }
        Ok(())
    }

    /// K0001 starts a value of a characteristic, the other keys add to its last one.
    fn value_field(&mut self, line: &Line<'_>, number: u32) -> Result<(), Diagnostic> {
        let text = line.text.trim();
        if line.key == 1 {
            let index = if line.index == 0 { 1 } else { line.index };
            let mut value = self.value(line.text, line.start, number)?;
            let first = self.first_sample;
            let values = &mut self.draft(index, line)?.values;
            value.sample = values.last().map_or(first, |last| last.sample + 1);
            values.push(value);
            return Ok(());
        }
        let name = if line.key == 14 && !text.is_empty() {
            if self.part_names.last().is_none_or(|last| last != text) {
                self.part_names.push(text.to_owned());
            }
            u32::try_from(self.part_names.len()).unwrap_or(0)
        } else {
            0
        };
        let indices = if line.index == 0 { 1..=self.drafts.len() } else { line.index..=line.index };
        self.work(indices.clone().count(), line)?;
        let counts = line.key != 2 || counts(text);
        let mut has_value = false;
        for index in indices {
            let Some(last) = self.draft(index, line)?.values.last_mut() else { continue };
            has_value = true;
            if line.key == 14 {
                last.part_name = name;
            }
            if !counts {
                let left_out = last.number.take();
                let said = left_out.map_or_else(String::new, |value| Content::Number(value).to_string());
                self.said.add(number.into(), index, &said);
                self.leave_out(text, number);
            }
        }
        if !has_value && matches!(line.key, 2 | 14) {
            let message = format!("K{:04}/{}: there is no value before it that it belongs to", line.key, line.index);
            return Err(self
                .bad(line.span(), message)
                .help("attributes (K0002) and names (K0014) stand behind their values"));
        }
        Ok(())
    }

    /// Notes a value that does not count because of its attribute.
    fn leave_out(&mut self, attribute: &str, line: u32) {
        let first = || LeftOut { code: attribute.to_owned(), count: 0, first_line: line };
        self.left_out.entry(attribute.to_owned()).or_insert_with(first).count += 1;
    }

    /// Refuses a file that applies keys to characteristics too often.
    fn work(&mut self, more: usize, line: &Line<'_>) -> Result<(), Diagnostic> {
        self.work += more;
        if self.work <= MOST_WORK {
            return Ok(());
        }
        Err(self.bad(line.span(), format!("K{:04}/0: the file has too many such lines", line.key)))
    }

    fn value(&mut self, text: &str, start: usize, line: u32) -> Result<Value, Diagnostic> {
        let span = start..start + text.len();
        let text = text.trim();
        let number = Decimal::parse(&text.replace(',', ".")).ok();
        if number.is_none() && !text.is_empty() {
            let shown: String = text.chars().take(40).collect();
            return Err(self.bad(span, format!("K0001: `{shown}` is not a number")));
        }
        self.values += 1;
        self.has_values = true;
        if self.values > MOST_VALUES {
            return Err(self.bad(span, format!("the file has more than {MOST_VALUES} values; split it")));
        }
        let mark = DecimalMark::ALL.into_iter().find(|mark| text.contains(char::from(mark.byte())));
        Ok(Value { number, mark, line, part_name: 0, sample: 0 })
    }

    /// A line of values: one per characteristic between 0x0F, its fields between 0x14.
    fn values(&mut self, line: &str, start: usize, number: u32) -> Result<(), Diagnostic> {
        let span = start..start + line.len();
        let line_text = line.strip_suffix('\u{f}').unwrap_or(line);
        if self.count.is_none() && self.drafts.is_empty() {
            return Err(self.bad(span, "the file does not start with K0100 or another key of the format".to_owned()));
        }
        let count = self.counted().unwrap_or(self.drafts.len());
        let mut at = start;
        for (index, field) in line_text.split('\u{f}').enumerate() {
            if index >= count {
                return Err(self.bad(
                    span,
                    format!("the line has more values than the file has characteristics ({count}, K0100)"),
                ));
            }
            let (text, rest) = field.split_once('\u{14}').unwrap_or((field, ""));
            let mut value = self.value(text, at, number)?;
            let attribute = rest.split('\u{14}').next().unwrap_or("").trim();
            self.said.add(number.into(), index, rest);
            if !counts(attribute) {
                value.number = None;
                self.said.add(number.into(), index, text.trim());
                self.leave_out(attribute, number);
            }
            value.sample = self.samples;
            let line = Line { key: 1, index: index + 1, text, at, start: at };
            self.draft(index + 1, &line)?.values.push(value);
            at += field.len() + 1;
        }
        self.samples = self.samples.saturating_add(1);
        Ok(())
    }

    /// Ends a header and its values. What follows is of the next one.
    fn end_header(&mut self) -> Result<(), Diagnostic> {
        let drafts = std::mem::take(&mut self.drafts);
        if let Some((count, said)) = self.count.take().filter(|(count, _)| *count > drafts.len()) {
            let message = format!("K0100 counts {count} characteristics, and the file has {}", drafts.len());
            return Err(said.bad(message).help("correct K0100, or give the characteristics that are missing"));
        }
        if self.parts.len() == self.first_part {
            self.parts.push(PartDefinition::default());
        }
        for mut draft in drafts {
            for (line, value) in draft.take_counts() {
                self.said.add(line.into(), 0, &Content::Number(value).to_string());
                self.leave_out(OF_NO_SIZE, line);
            }
            self.samples = self.samples.max(draft.values.last().map_or(0, |last| last.sample + 1));
            self.characteristics.push(draft.characteristic()?);
        }
        if self.characteristics.len() > MOST_IN_ALL {
            let message = format!("{} has more than {MOST_IN_ALL} characteristics in its headers", self.source.name);
            return Err(Diagnostic::error(Code::BadTable, message).help("split it"));
        }
        (self.first_part, self.part) = (self.parts.len(), self.parts.len());
        (self.first_sample, self.has_values) = (self.samples, false);
        Ok(())
    }

    fn finish(mut self) -> Result<Qdas, Diagnostic> {
        self.end_header()?;
        if self.characteristics.iter().all(Characteristic::is_empty) {
            let message = format!("{} has no measured values", self.source.name);
            return Err(Diagnostic::error(Code::BadTable, message)
                .help("values are K0001 lines, or lines without a key; those of a .dfd stand in its .dfx"));
        }
        let mut left_out: Vec<LeftOut> = self.left_out.into_values().collect();
        left_out.sort_by_key(|left_out| left_out.first_line);
        Ok(Qdas {
            characteristics: self.characteristics,
            left_out,
            remarks: self.remarks,
            said: self.said,
            parts: self.parts,
            name: self.source.name.clone(),
            part_names: self.part_names,
        })
    }
}
