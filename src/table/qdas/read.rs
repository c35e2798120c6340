//! Reads Q-DAS ASCII text, line by line. Called by [`read`](fn@super::read); keeps what is said, and judges nothing.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::{Characteristic, LeftOut, PartDefinition, Qdas, Value};
use crate::diagnostic::{Code, Diagnostic, Source};
use crate::quantity::{Length, parse_f64};
use crate::table::number::{DecimalMark, normalise};

/// Characteristics and parts at most: more is a broken index, not a measuring plan.
const MOST_CHARACTERISTICS: usize = 10_000;
/// The longest text of one value.
const LONGEST_VALUE: usize = 200;
/// Values of a file at most: a lot of a million parts has some millions.
const MOST_VALUES: usize = 8_000_000;
/// What keys with `/0` may say in all, one for each characteristic.
const MOST_WORK: usize = 100_000_000;

/// What a file says of a characteristic before its lines are put together.
#[derive(Debug, Clone, Default)]
struct Draft {
    characteristic: Characteristic,
    allowances: [Option<String>; 2],
    /// K2120 and K2121: whether there is a limit.
    limit_types: [Option<i64>; 2],
    defined: bool,
}

#[derive(Default)]
struct Reader {
    sources: Vec<Arc<Source>>,
    parts: Vec<PartDefinition>,
    drafts: Vec<Draft>,
    count: Option<usize>,
    part: usize,
    /// Lines of values so far.
    samples: u32,
    values: usize,
    work: usize,
    part_names: Vec<String>,
    /// By attribute.
    left_out: BTreeMap<String, LeftOut>,
}

/// One line with a key.
struct Line<'t> {
    key: u16,
    index: usize,
    text: &'t str,
    start: usize,
}

impl Line<'_> {
    fn span(&self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }
}

/// Reads a file, or a file of definitions and the file of its values: name and text of each, in that order.
///
/// # Errors
/// What is wrong, with the file, the line and the key: a line that is neither, an index beyond K0100, a number that is
/// none.
pub fn read(files: &[(&str, &str)]) -> Result<Qdas, Diagnostic> {
    let mut reader = Reader::default();
    for (name, text) in files.iter().take(usize::from(u8::MAX)) {
        let text = text.trim_start_matches('\u{feff}');
        if u32::try_from(text.len()).is_err() {
            return Err(Diagnostic::error(Code::FileAccess, format!("{name} is larger than 4 GiB")));
        }
        reader.sources.push(Arc::new(Source::new(*name, text)));
        reader.file()?;
    }
    reader.finish()
}

impl Reader {
    fn bad(&self, line: Range<usize>, message: String) -> Diagnostic {
        let diagnostic = Diagnostic::error(Code::BadTable, message);
        match self.sources.last() {
            Some(source) => diagnostic.at(source, line, ""),
            None => diagnostic,
        }
    }

    fn file(&mut self) -> Result<(), Diagnostic> {
        let Some(source) = self.sources.last().cloned() else { return Ok(()) };
        let mut start = 0;
        for (number, whole) in source.text.split_inclusive('\n').enumerate() {
            let line = whole.trim_end_matches(['\n', '\r', '\u{1a}']);
            let at = start;
            start += whole.len();
            if line.trim().is_empty() {
                continue;
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
        let most = self.count.unwrap_or(MOST_CHARACTERISTICS);
        if index == 0 || index > most {
            let message = match self.count {
                Some(count) => format!("K{:04}/{index}: the file has {count} characteristics (K0100)", line.key),
                None => format!("K{:04}/{index}: there is no characteristic of that number", line.key),
            };
            return Err(self.bad(line.span(), message));
        }
        if self.drafts.len() < index {
            self.drafts.resize(index, Draft::default());
        }
        let part = self.part;
        let draft = &mut self.drafts[index - 1];
        if !draft.defined {
            draft.defined = true;
            draft.characteristic.part = part;
        }
        Ok(&mut self.drafts[index - 1])
    }

    fn field(&mut self, line: &Line<'_>, number: u32) -> Result<(), Diagnostic> {
        match line.key {
            100 => {
                let count = line.text.trim().parse::<usize>().ok().filter(|count| *count <= MOST_CHARACTERISTICS);
                let Some(count) = count else {
                    let message = format!(
                        "K0100: `{}` is not a number of characteristics (0 to {MOST_CHARACTERISTICS})",
                        line.text
                    );
                    return Err(self.bad(line.span(), message));
                };
                self.count = Some(count);
            }
            1..=99 => self.value_field(line, number)?,
            1000..=1999 => {
                let index = line.index.max(1);
                if index > MOST_CHARACTERISTICS {
                    let message = format!("K{:04}/{index}: there is no part of that number", line.key);
                    return Err(self.bad(line.span(), message));
                }
                if self.parts.len() < index {
                    self.parts.resize(index, PartDefinition::default());
                }
                self.part = index - 1;
                match line.key {
                    1001 => line.text.trim().clone_into(&mut self.parts[index - 1].number),
                    1002 => line.text.trim().clone_into(&mut self.parts[index - 1].name),
                    _ => {}
                }
            }
            2000..=2999 => self.characteristic_field(line)?,
            _ => {}
        }
        Ok(())
    }

    fn characteristic_field(&mut self, line: &Line<'_>) -> Result<(), Diagnostic> {
        const NUMBERS: [u16; 6] = [2101, 2106, 2110, 2111, 2112, 2113];
        let indices = match (line.index, self.count) {
            (0, count) => 1..=count.unwrap_or(self.drafts.len()).max(1),
            (index, _) => index..=index,
        };
        let text = line.text.trim();
        self.work(indices.clone().count(), line)?;
        let mut number = None;
        if NUMBERS.contains(&line.key) && !text.is_empty() {
            // no thousands marks, so that a comma is a decimal comma
            let plain = text.replace(',', ".");
            if !is_number(&plain) || normalise(&plain, DecimalMark::Point).is_none() {
                let message = format!("K{:04}/{}: `{text}` is not a number", line.key, line.index);
                return Err(self.bad(line.span(), message));
            }
            number = Some(plain);
        }
        for index in indices {
            let draft = self.draft(index, line)?;
            let characteristic = &mut draft.characteristic;
            match line.key {
                2001 => text.clone_into(&mut characteristic.number),
                2002 => text.clone_into(&mut characteristic.name),
                2101 => characteristic.nominal.clone_from(&number),
                2106 => characteristic.uncertainty.clone_from(&number),
                2110 => characteristic.lower.clone_from(&number),
                2111 => characteristic.upper.clone_from(&number),
                2112 => draft.allowances[0].clone_from(&number),
                2113 => draft.allowances[1].clone_from(&number),
                2120 => draft.limit_types[0] = text.parse().ok(),
                2121 => draft.limit_types[1] = text.parse().ok(),
                2142 if !text.is_empty() => characteristic.unit = Some(text.to_owned()),
                _ => {}
            }
        }
        Ok(())
    }

    /// K0001 starts a value of a characteristic, the other keys add to its last one.
    fn value_field(&mut self, line: &Line<'_>, number: u32) -> Result<(), Diagnostic> {
        let text = line.text.trim();
        if line.key == 1 {
            let index = if line.index == 0 { 1 } else { line.index };
            let mut value = self.value(line.text, line.start, number)?;
            let values = &mut self.draft(index, line)?.characteristic.values;
            value.sample = values.last().map_or(0, |last| last.sample + 1);
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
        let all = 1..=self.drafts.len();
        let indices = if line.index == 0 { all } else { line.index..=line.index };
        self.work(indices.clone().count(), line)?;
        let counts = line.key != 2 || counts(text);
        for index in indices {
            let Some(last) = self.draft(index, line)?.characteristic.values.last_mut() else { continue };
            last.is_none |= !counts;
            if line.key == 14 {
                last.part_name = name;
            }
            if !counts {
                self.leave_out(text, number);
            }
        }
        Ok(())
    }

    /// A value with that attribute does not count.
    fn leave_out(&mut self, attribute: &str, line: u32) {
        let first = || LeftOut { code: attribute.to_owned(), count: 0, first_line: line };
        self.left_out.entry(attribute.to_owned()).or_insert_with(first).count += 1;
    }

    fn work(&mut self, more: usize, line: &Line<'_>) -> Result<(), Diagnostic> {
        self.work += more;
        if self.work <= MOST_WORK {
            return Ok(());
        }
        Err(self.bad(line.span(), format!("K{:04}/0: the file repeats such lines without end", line.key)))
    }

    fn value(&mut self, text: &str, start: usize, line: u32) -> Result<Value, Diagnostic> {
        let span = start..start + text.len();
        let trimmed = text.trim();
        let plain = trimmed.replace(',', ".");
        if !trimmed.is_empty() && !is_number(&plain) {
            let shown: String = trimmed.chars().take(40).collect();
            return Err(self.bad(span, format!("K0001: `{shown}` is not a number")));
        }
        if text.len() > LONGEST_VALUE {
            return Err(self.bad(span, "K0001: the value is longer than any number".to_owned()));
        }
        self.values += 1;
        if self.values > MOST_VALUES {
            return Err(self.bad(span, format!("the file has more than {MOST_VALUES} values; split it")));
        }
        Ok(Value {
            source: u8::try_from(self.sources.len() - 1).unwrap_or(u8::MAX),
            start: u32::try_from(start).unwrap_or(u32::MAX),
            length: u8::try_from(text.len()).unwrap_or(u8::MAX),
            // an empty place is no value either
            is_none: trimmed.is_empty(),
            line,
            ..Value::default()
        })
    }

    /// A line of values: one per characteristic between 0x0F, its fields between 0x14.
    fn values(&mut self, line: &str, start: usize, number: u32) -> Result<(), Diagnostic> {
        let span = start..start + line.len();
        let line_text = line.strip_suffix('\u{f}').unwrap_or(line);
        if self.count.is_none() && self.drafts.is_empty() {
            return Err(self.bad(span, "the file does not start with K0100 or another key of the format".to_owned()));
        }
        let count = self.count.unwrap_or(self.drafts.len());
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
            if !counts(attribute) {
                value.is_none = true;
                self.leave_out(attribute, number);
            }
            value.sample = self.samples;
            let line = Line { key: 1, index: index + 1, text, start: at };
            self.draft(index + 1, &line)?.characteristic.values.push(value);
            at += field.len() + 1;
        }
        self.samples = self.samples.saturating_add(1);
        Ok(())
    }

    fn finish(mut self) -> Result<Qdas, Diagnostic> {
        if self.drafts.iter().all(|draft| draft.characteristic.values.is_empty()) {
            let name = self.sources.last().map_or_else(|| "the file".to_owned(), |source| source.name.clone());
            return Err(Diagnostic::error(Code::BadTable, format!("{name} has no measured values"))
                .help("values are K0001 lines, or lines without a key; those of a .dfd stand in its .dfx"));
        }
        if self.parts.is_empty() {
            self.parts.push(PartDefinition::default());
        }
        let parts = self.parts.len();
        let characteristics = self.drafts.into_iter().map(|draft| {
            let Draft { mut characteristic, allowances, limit_types, .. } = draft;
            let [lower, upper] =
                allowances.map(|allowance| sum(characteristic.nominal.as_deref(), allowance.as_deref()));
            characteristic.lower = characteristic.lower.or(lower).filter(|_| limit_types[0] != Some(0));
            characteristic.upper = characteristic.upper.or(upper).filter(|_| limit_types[1] != Some(0));
            characteristic.part = characteristic.part.min(parts - 1);
            characteristic
        });
        let mut left_out: Vec<LeftOut> = self.left_out.into_values().collect();
        left_out.sort_by_key(|left_out| left_out.first_line);
        Ok(Qdas {
            characteristics: characteristics.collect(),
            left_out,
            parts: self.parts,
            sources: self.sources,
            part_names: self.part_names,
        })
    }
}

/// Whether a value with that attribute (K0002) counts.
fn counts(attribute: &str) -> bool {
    attribute.is_empty() || attribute.parse() == Ok(0)
}

/// Whether a text with a decimal point is a number.
fn is_number(text: &str) -> bool {
    parse_f64(text).is_ok()
}

/// The nominal value and an allowance as one decimal number.
fn sum(nominal: Option<&str>, allowance: Option<&str>) -> Option<String> {
    let length = |text: &str| text.parse::<Length>().ok();
    Some((length(nominal?)? + length(allowance?)?).mm().to_string())
}

/// A line that starts with a key; an error if the key is followed by an index that is none.
fn keyed(line: &str, start: usize) -> Option<Result<Line<'_>, String>> {
    let digits = line.strip_prefix(['K', 'k'])?.get(..4).filter(|digits| digits.bytes().all(|b| b.is_ascii_digit()))?;
    let key: u16 = digits.parse().ok()?;
    let rest = &line[5..];
    let (index, text) = match rest.strip_prefix('/') {
        None => ("", rest.strip_prefix([' ', '\t']).unwrap_or(rest)),
        Some(indexed) => indexed.split_once([' ', '\t']).unwrap_or((indexed, "")),
    };
    // a second index counts values, whose order says the same
    let first = index.split('/').next().unwrap_or("");
    let parsed = if first.is_empty() { Some(usize::from(key >= 1000)) } else { first.parse().ok() };
    let Some(index) = parsed else {
        return Some(Err(format!("K{key:04}: `/{index}` is not a number of a characteristic or part")));
    };
    let start = start + line.len() - text.len();
    Some(Ok(Line { key, index, text, start }))
}
