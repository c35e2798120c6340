//! Reads Q-DAS ASCII text, line by line. Called by [`read`](fn@super::read); keeps what the file says, and judges nothing.

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader, Cursor, Read};
use std::sync::Arc;

use super::definition::{Draft, KEYS, NUMBERS, Said};
use super::keys::{Line, changes_values, counts, has_free_words, is_number, is_of_format, keyed};
use super::remarks::{Remark, Remarks};
use super::values::{Names, Value};
use super::{Characteristic, LeftOut, OF_NO_SIZE, PartDefinition, Qdas};
use crate::diagnostic::{Code, Diagnostic, Source};
use crate::table::cell::Content;
use crate::table::chunk::LONGEST_RECORD;
use crate::table::encoding;
use crate::table::ledger::Tally;
use crate::table::number::{DecimalMark, normalise};
use crate::table::pattern::Pattern;

/// Characteristics or parts of a header at most. A higher number is an error of the file.
const MOST_CHARACTERISTICS: usize = 10_000;
/// Characteristics of all headers at most.
const MOST_IN_ALL: usize = 100_000;
/// Values of a file at most, which are all kept: a lot of a million parts has some millions.
const MOST_VALUES: usize = 2_500_000;
/// Bytes of a file at most.
const LARGEST_FILE: u64 = 64 << 20;
/// Bytes at most of a text that is kept.
const LONGEST_TEXT: usize = 1000;
/// Different attributes of values at most.
const MOST_ATTRIBUTES: usize = 1000;
/// How often keys may be applied to a characteristic in all: a key with `/0` is applied to each.
const MOST_WORK: usize = 100_000_000;

#[derive(Default)]
struct Reader {
    /// The file that is read.
    name: String,
    /// The number of the line that is read.
    line: u32,
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
    part_names: Names,
    /// The values that do not count, by their attribute.
    left_out: BTreeMap<String, LeftOut>,
    remarks: Remarks,
    /// What else the file says.
    said: Tally,
}

/// Reads a file, or a file of definitions and the file of its values: name and text of each, in that order.
///
/// # Errors
/// A line with neither a key nor values, an index beyond K0100, or a text in place of a number; with file, line and key.
pub fn read(files: &[(&str, &str)]) -> Result<Qdas, Diagnostic> {
    let file = |(name, text): &(&str, &str)| {
        let bytes: Box<dyn Read + Send> = Box::new(Cursor::new((*text).to_owned()));
        ((*name).to_owned(), bytes)
    };
    read_all(files.iter().map(file).collect(), &[])
}

/// The same for bytes that come once, with the rules for remarks. A line is kept no longer than it is read.
pub(crate) fn read_all(files: Vec<(String, Box<dyn Read + Send>)>, rules: &[Pattern]) -> Result<Qdas, Diagnostic> {
    let mut reader = Reader { remarks: Remarks::of(rules), ..Reader::default() };
    for (name, bytes) in files {
        reader.name = name;
        reader.file(bytes)?;
    }
    reader.finish()
}

impl Reader {
    fn bad(&self, line: &Line<'_>, message: String) -> Diagnostic {
        self.said(line).bad(message)
    }

    /// What a line says, with its place.
    fn said(&self, line: &Line<'_>) -> Said {
        let source = Source { lines_before: self.line as usize - 1, ..Source::new(&*self.name, line.whole) };
        Said { text: line.text.trim().to_owned(), of_all: line.index == 0, source: Arc::new(source), span: line.span() }
    }

    fn file(&mut self, bytes: Box<dyn Read + Send>) -> Result<(), Diagnostic> {
        let mut bytes = BufReader::new(bytes.take(LARGEST_FILE + 1));
        let (mut whole, mut size) = (Vec::new(), 0);
        self.line = 0;
        loop {
            whole.clear();
            let longest = LONGEST_RECORD as u64 + 3;
            let read = bytes.by_ref().take(longest).read_until(b'\n', &mut whole);
            let read = read.map_err(|error| Diagnostic::unreadable(&self.name, &error))?;
            if read == 0 {
                return Ok(());
            }
            size += read as u64;
            if size > LARGEST_FILE {
                let problem = format!("it is larger than {} MiB", LARGEST_FILE >> 20);
                return Err(Diagnostic::unreadable(&self.name, &problem).help("split it"));
            }
            self.line = self.line.saturating_add(1);
            let text = encoding::text(&whole);
            let line = text.trim_start_matches('\u{feff}').trim_end_matches(['\n', '\r', '\u{1a}']);
            if line.len() > LONGEST_RECORD {
                let line = Line { text: "", ..Line::plain("") };
                return Err(self.bad(&line, format!("the line is longer than {} KiB", LONGEST_RECORD >> 10)));
            }
            if line.trim().is_empty() {
                continue;
            }
            match keyed(line) {
                Some(Ok(line)) => self.field(&line)?,
                Some(Err(problem)) => return Err(self.bad(&Line::plain(line), problem)),
                None => self.values(line)?,
            }
        }
    }

    fn draft(&mut self, index: usize, line: &Line<'_>) -> Result<&mut Draft, Diagnostic> {
        let count = self.counted();
        if index == 0 || index > count.unwrap_or(MOST_CHARACTERISTICS) {
            let message = match count {
                Some(count) => format!("K{:04}/{index}: the file has {count} characteristics (K0100)", line.key),
                None => format!("K{:04}/{index}: there is no characteristic of that number", line.key),
            };
            return Err(self.bad(line, message));
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

    fn field(&mut self, line: &Line<'_>) -> Result<(), Diagnostic> {
        let text = line.text.trim();
        let index = line.whole[..line.start].trim();
        let is_own = is_of_format(line.key) && !(has_free_words(line.key) && text.contains(char::is_alphabetic));
        if is_own {
            // the text is a value, which is read; only the index is the format's
            let said = if line.key == 1 { index.to_owned() } else { format!("{index} {text}") };
            self.said.add(self.line.into(), 0, &said);
        } else if !text.is_empty() {
            self.said.add(self.line.into(), 0, index);
            self.remarks.add(Remark { key: line.key, line: self.line, text: text.to_owned() });
        }
        match line.key {
            100 => self.count_field(line),
            1..=99 => self.value_field(line),
            1000..=1999 => self.part_field(line),
            2000..=2999 => self.characteristic_field(line),
            _ => Ok(()),
        }
    }

    /// Refuses a text that would be kept and is too long.
    fn refuse_long(&self, line: &Line<'_>) -> Result<(), Diagnostic> {
        if line.text.len() <= LONGEST_TEXT {
            return Ok(());
        }
        let message =
            format!("K{:04} has a text of {} bytes, and at most {LONGEST_TEXT} are read", line.key, line.text.len());
        Err(self.bad(&Line { text: "", ..*line }, message).help("shorten it"))
    }

    /// K0100 starts a header; behind values it starts the next one.
    fn count_field(&mut self, line: &Line<'_>) -> Result<(), Diagnostic> {
        let count = line.text.trim().parse::<usize>().ok().filter(|count| *count <= MOST_CHARACTERISTICS);
        let Some(count) = count else {
            let message =
                format!("K0100: `{}` is not a number of characteristics (0 to {MOST_CHARACTERISTICS})", line.text);
            return Err(self.bad(line, message));
        };
        if self.has_values {
            self.end_header()?;
        }
        if let Some(other) = self.counted().filter(|other| *other != count) {
            let message = format!("K0100 counts {count} characteristics, and {other} before it in the same header");
            return Err(self.bad(line, message));
        }
        self.count = Some((count, self.said(line)));
        Ok(())
    }

    fn part_field(&mut self, line: &Line<'_>) -> Result<(), Diagnostic> {
        let index = line.index.max(1);
        if index > MOST_CHARACTERISTICS {
            let message = format!("K{:04}/{index}: there is no part of that number", line.key);
            return Err(self.bad(line, message));
        }
        if matches!(line.key, 1001 | 1002 | 1008) {
            self.refuse_long(line)?;
        }
        self.part = self.first_part + index - 1;
        if self.parts.len() <= self.part {
            self.parts.resize(self.part + 1, PartDefinition::default());
        }
        let text = line.text.trim();
        let part = &mut self.parts[self.part];
        let known = match line.key {
            1001 => &mut part.number,
            1002 => &mut part.name,
            1008 => &mut part.kind,
            _ => return Ok(()),
        };
        if known.is_empty() {
            text.clone_into(known);
        }
        if known == text || text.is_empty() {
            return Ok(());
        }
        let message = format!("K{:04}/{index} says `{text}`, and `{known}` before it", line.key);
        Err(self.bad(line, message).help("a header of another part starts with K0100, or the part has its own /i"))
    }

    fn characteristic_field(&mut self, line: &Line<'_>) -> Result<(), Diagnostic> {
        let indices = match (line.index, self.counted()) {
            (0, count) => 1..=count.unwrap_or(self.drafts.len()).max(1),
            (index, _) => index..=index,
        };
        self.work(indices.clone().count(), line)?;
        if KEYS.contains(&line.key) {
            self.refuse_long(line)?;
        }
        let mut said = self.said(line);
        if NUMBERS.contains(&line.key) && !said.text.is_empty() {
            // no thousands marks, so that a comma is a decimal comma
            let plain = said.text.replace(',', ".");
            if !is_number(&plain) || normalise(&plain, DecimalMark::Point).is_none() {
                let message = format!("K{:04}/{}: `{}` is not a number", line.key, line.index, said.text);
                return Err(self.bad(line, message));
            }
            said.text = plain;
        }
        if let Some(what) = changes_values(line.key, &said.text) {
            let message = format!("K{:04}/{} says {what} `{}`", line.key, line.index, said.text);
            let help =
                "the file does not say whether its values include it: write them as they count, without this key";
            return Err(self.bad(line, message).help(help));
        }
        for index in indices {
            self.draft(index, line)?.say(line.key, said.clone())?;
        }
        Ok(())
    }

    /// K0001 starts a value of a characteristic, the other keys add to its last one.
    fn value_field(&mut self, line: &Line<'_>) -> Result<(), Diagnostic> {
        let text = line.text.trim();
        if line.key == 1 {
            let index = if line.index == 0 { 1 } else { line.index };
            let value = self.value(line)?;
            let first = self.first_sample;
            let values = &mut self.draft(index, line)?.values;
            values.push(values.next_sample().unwrap_or(first), value);
            return Ok(());
        }
        let name = if line.key == 14 && !text.is_empty() {
            self.refuse_long(line)?;
            self.part_names.add(text)
        } else {
            0
        };
        let indices = if line.index == 0 { 1..=self.drafts.len() } else { line.index..=line.index };
        self.work(indices.clone().count(), line)?;
        let counts = line.key != 2 || counts(text);
        let mut has_value = false;
        for index in indices {
            let values = &mut self.draft(index, line)?.values;
            let Some(last) = values.last_mut() else { continue };
            has_value = true;
            let left_out = if counts { None } else { Some(last.take()) };
            if line.key == 14 {
                values.name_last(name);
            }
            if let Some(left_out) = left_out {
                let said = left_out.map_or_else(String::new, |value| Content::Number(value).to_string());
                self.said.add(self.line.into(), index, &said);
                self.leave_out(text, line)?;
            }
        }
        if !has_value && matches!(line.key, 2 | 14) {
            let message = format!("K{:04}/{}: there is no value before it that it belongs to", line.key, line.index);
            return Err(self.bad(line, message).help("attributes (K0002) and names (K0014) stand behind their values"));
        }
        Ok(())
    }

    /// Notes a value that does not count because of its attribute.
    fn leave_out(&mut self, attribute: &str, line: &Line<'_>) -> Result<(), Diagnostic> {
        self.not_counted(attribute, self.line);
        if self.left_out.len() <= MOST_ATTRIBUTES {
            return Ok(());
        }
        let message = format!("values have more than {MOST_ATTRIBUTES} different attributes (K0002)");
        Err(self.bad(line, message).help("an attribute is a number such as 0, 129, 255, 256 or 290"))
    }

    fn not_counted(&mut self, code: &str, line: u32) {
        let first = || LeftOut { code: code.to_owned(), count: 0, first_line: line };
        self.left_out.entry(code.to_owned()).or_insert_with(first).count += 1;
    }

    /// Refuses a file that applies keys to characteristics too often.
    fn work(&mut self, more: usize, line: &Line<'_>) -> Result<(), Diagnostic> {
        self.work += more;
        if self.work <= MOST_WORK {
            return Ok(());
        }
        Err(self.bad(line, format!("K{:04}/0: the file has too many such lines", line.key)))
    }

    fn value(&mut self, line: &Line<'_>) -> Result<Value, Diagnostic> {
        let text = line.text.trim();
        let Some(value) = Value::parse(text, self.line) else {
            let shown: String = text.chars().take(40).collect();
            return Err(self.bad(line, format!("K0001: `{shown}` is not a number")));
        };
        self.values += 1;
        self.has_values = true;
        if self.values > MOST_VALUES {
            let message = format!("the file has more than {MOST_VALUES} values");
            return Err(self.bad(line, message).help("split it, or export it as CSV, which is read at any size"));
        }
        Ok(value)
    }

    /// A line of values: one per characteristic between 0x0F, its fields between 0x14.
    fn values(&mut self, whole: &str) -> Result<(), Diagnostic> {
        let line = Line::plain(whole);
        let fields = whole.strip_suffix('\u{f}').unwrap_or(whole);
        if self.count.is_none() && self.drafts.is_empty() {
            let message = "the file does not start with K0100 or another key of the format";
            return Err(self.bad(&line, message.to_owned()));
        }
        let count = self.counted().unwrap_or(self.drafts.len());
        let mut start = 0;
        for (index, field) in fields.split('\u{f}').enumerate() {
            if index >= count {
                let message = format!("the line has more values than the file has characteristics ({count}, K0100)");
                return Err(self.bad(&line, message));
            }
            let (text, rest) = field.split_once('\u{14}').unwrap_or((field, ""));
            let line = Line { index: index + 1, text, start, ..line };
            let mut value = self.value(&line)?;
            let attribute = rest.split('\u{14}').next().unwrap_or("").trim();
            self.said.add(self.line.into(), index, rest);
            if !counts(attribute) {
                value.take();
                self.said.add(self.line.into(), index, text.trim());
                self.leave_out(attribute, &line)?;
            }
            let sample = self.samples;
            self.draft(index + 1, &line)?.values.push(sample, value);
            start += field.len() + 1;
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
                self.not_counted(OF_NO_SIZE, line);
            }
            self.samples = self.samples.max(draft.values.next_sample().unwrap_or(0));
            self.characteristics.push(draft.characteristic()?);
        }
        if self.characteristics.len() > MOST_IN_ALL {
            let message = format!("{} has more than {MOST_IN_ALL} characteristics in its headers", self.name);
            return Err(Diagnostic::error(Code::BadTable, message).help("split it"));
        }
        (self.first_part, self.part) = (self.parts.len(), self.parts.len());
        (self.first_sample, self.has_values) = (self.samples, false);
        Ok(())
    }

    fn finish(mut self) -> Result<Qdas, Diagnostic> {
        self.end_header()?;
        if self.characteristics.iter().all(Characteristic::is_empty) {
            let message = format!("{} has no measured values", self.name);
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
            name: self.name,
            part_names: self.part_names,
        })
    }
}
