//! Reads one section of a spec: typed values by key, with every problem on the way. The files of the sections call it. It
//! never ends at the first problem and requires no key.

use std::borrow::Cow;
use std::fmt::Display;
use std::ops::Range;
use std::str::FromStr;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::Located;
use super::found::Found;
use super::keys::{AnyKey, ERRORS, Key, Kind, LARGEST_CLASS, MeasureUnit, SECTIONS, Section};
use super::value::{KeyType, Value, Values};
use crate::deviation::ToothRange;
use crate::diagnostic::{Code, Diagnostic, Source, nearest, nearest_or};
use crate::function::SetAt;
use crate::judge::Rule;
use crate::judge::class::RackDiameter;
use crate::quantity::{Angle, Domain, DomainError, Length, QuantityError, parse_f64, shown, split_number};
use crate::uncertainty::{Influence, Uncertainty};

/// The name of a required text in messages.
pub(super) const TEXT: &str = "text in quotes";

/// A table of the spec while it is being read.
pub(super) struct SectionReader<'a> {
    pub(super) source: &'a Arc<Source>,
    pub(super) section: &'static Section,
    pub(super) table: &'a DeTable<'a>,
    pub(super) diagnostics: &'a mut Found,
    /// The uncertainties found so far.
    pub(super) uncertainties: &'a mut Vec<(Influence, Located<Uncertainty>)>,
}

impl<'a> SectionReader<'a> {
    /// The value of a name, if it is a table.
    pub(super) fn entry(&self, name: &str) -> Option<&'a DeTable<'a>> {
        self.table.get(name)?.get_ref().as_table()
    }

    /// Reports keys that the section does not have.
    pub(super) fn refuse_unknown_keys(&mut self) {
        let own = self.section.keys.iter().map(AnyKey::name);
        let section = format!("[{}]", self.section.name);
        for key in others(self.table, &own) {
            let name = key.get_ref().as_ref();
            self.diagnostics.add(|| {
                let message = format!("{section} has no key `{}`", shown(name));
                let all = || format!("the keys of {section} are {}", own.clone().collect::<Vec<_>>().join(", "));
                let help = || elsewhere(name).unwrap_or_else(all);
                unknown(message, name, own.clone(), help).at(self.source, key.span(), "unknown key")
            });
        }
    }

    /// Reads every key of the section that holds one value, and those of its tables.
    pub(super) fn values(&mut self, values: &mut Values) {
        for key in self.section.keys {
            let value = match key.kind {
                Kind::Table(section) | Kind::Whole(section) => {
                    let table = self.table(key.name(), section, |inner| {
                        if matches!(key.kind, Kind::Whole(_)) {
                            inner.refuse_missing_keys();
                        }
                        inner.values(values);
                    });
                    table.map(|Located { span, .. }| Located { value: Value::Table(()), span })
                }
                _ => self.value(key),
            };
            if let Some(value) = value {
                values.insert(key.path, value);
            }
        }
    }

    /// The value of a key, if it is there and can be read.
    pub(super) fn get<T: KeyType>(&mut self, key: Key<T>) -> Option<Located<T>> {
        let Located { value, span } = self.value(&key.any)?;
        Some(Located { value: T::of(&value)?, span })
    }

    /// The value of a key that holds one; `None` for the others too.
    fn value(&mut self, key: &AnyKey) -> Option<Located<Value>> {
        let name = key.name();
        let written = self.table.get(name)?;
        let written = match key.kind {
            Kind::Length(_) | Kind::Angle(_) => self.uncertain(name, written, Influence::of_gear(key.path))?,
            _ => Cow::Borrowed(written),
        };
        let written = written.as_ref();
        let span = written.span();
        let value = match key.kind {
            Kind::Label => Value::Text(match written.get_ref() {
                DeValue::Integer(number) => number.as_str().to_owned(),
                DeValue::Float(number) => number.as_str().to_owned(),
                DeValue::Datetime(date) => date.to_string(),
                _ => self.text_value(name, written, TEXT)?.to_owned(),
            }),
            Kind::Text | Kind::File => Value::Text(self.text_value(name, written, TEXT)?.to_owned()),
            Kind::Length(domain) => {
                let length = self.length_value(name, written)?;
                self.in_domain(domain.check_length(length), span.clone())?;
                Value::Length(length)
            }
            Kind::Angle(domain) => {
                let angle = self.angle_value(name, written)?;
                self.in_domain(domain.check_angle(angle), span.clone())?;
                Value::Angle(angle)
            }
            Kind::Number(domain) => {
                let number = self.plain_number(name, written)?;
                Value::Number(self.number_in(&domain, "", number, span.clone())?)
            }
            Kind::Measure(domain, unit) => {
                let number = self.measure_value(name, written, unit)?;
                Value::Number(self.number_in(&domain, unit.after, number, span.clone())?)
            }
            Kind::Count(domain) => {
                let DeValue::Integer(_) = written.get_ref() else {
                    return self.wrong_type(name, written, "a whole number");
                };
                let number = self.plain_number(name, written)?;
                // the domain is far inside u32, and the number is whole
                Value::Count(self.number_in(&domain, "", number, span.clone())? as u32)
            }
            Kind::Word(words) => Value::Word(self.word_value(name, written, words)?),
            Kind::Flag => match written.get_ref() {
                DeValue::Boolean(flag) => Value::Flag(*flag),
                _ => return self.wrong_type(name, written, "true or false"),
            },
            Kind::Standard => Value::Standard(self.parsed(name, written, Code::UnknownStandard)?),
            Kind::Rule => Value::Rule(self.rule_value(name, written)?),
            Kind::RackDiameter => Value::RackDiameter(self.rack_diameter(name, written)?),
            Kind::Teeth => Value::Teeth(self.teeth_value(name, written)?),
            Kind::SetAt => Value::SetAt(self.set_at(name, written)?),
            _ => return None,
        };
        Some(Located { value, span })
    }

    /// Reports keys that the table of a value cannot have; `None` if there are any.
    pub(super) fn knows_keys(
        &mut self,
        name: &str,
        table: &DeTable<'_>,
        known: &(impl Iterator<Item = &'static str> + Clone),
        help: &str,
    ) -> Option<()> {
        let before = self.diagnostics.len();
        for key in others(table, known) {
            self.diagnostics.add(|| {
                let message = format!("`{name}` has no key `{}`", shown(key.get_ref()));
                let diagnostic =
                    Diagnostic::error(Code::UnknownKey, message)
                        .help(nearest_or(key.get_ref(), known.clone(), || help.to_owned()));
                diagnostic.at(self.source, key.span(), "unknown key")
            });
        }
        (self.diagnostics.len() == before).then_some(())
    }

    pub(super) fn report(&mut self, diagnostic: Diagnostic, span: Range<usize>) {
        self.diagnostics.add(|| diagnostic.at(self.source, span, ""));
    }

    /// Reports why there is no value.
    pub(super) fn refuse<T>(&mut self, diagnostic: Diagnostic, span: Range<usize>) -> Option<T> {
        self.report(diagnostic, span);
        None
    }

    /// The result of reading a value, or a report of why there is none.
    fn accept<T>(&mut self, name: &str, read: Result<T, impl Display>, code: Code, span: Range<usize>) -> Option<T> {
        read.map_err(|error| self.report(Diagnostic::error(code, format!("`{name}`: {error}")), span)).ok()
    }

    pub(super) fn wrong_type<T>(&mut self, name: &str, value: &Spanned<DeValue<'_>>, needed: &str) -> Option<T> {
        let message = format!("`{name}` is {}; {needed} is needed", type_in_words(value.get_ref()));
        self.refuse(Diagnostic::error(Code::WrongType, message), value.span())
    }

    /// A text, which messages call `needed` if it is missing.
    pub(super) fn text_value<'v>(
        &mut self,
        name: &str,
        value: &'v Spanned<DeValue<'_>>,
        needed: &str,
    ) -> Option<&'v str> {
        if let DeValue::String(text) = value.get_ref() { Some(text) } else { self.wrong_type(name, value, needed) }
    }

    /// The meaning of a name; an unknown name is a problem of the kind `code`.
    fn parsed<T: FromStr<Err: Display>>(&mut self, name: &str, value: &Spanned<DeValue<'_>>, code: Code) -> Option<T> {
        let parsed = self.text_value(name, value, TEXT)?.parse();
        self.accept(name, parsed, code, value.span())
    }

    /// A decision rule, whose refusal names the key.
    fn rule_value(&mut self, name: &str, value: &Spanned<DeValue<'_>>) -> Option<Rule> {
        let rule = self.text_value(name, value, TEXT)?.parse::<Rule>();
        rule.map_err(|error| self.report(Diagnostic::error(Code::BadRule, error.to_string()), value.span())).ok()
    }

    /// Which diameter stands for a rack.
    fn rack_diameter(&mut self, name: &str, value: &Spanned<DeValue<'_>>) -> Option<RackDiameter> {
        const DIAMETER: Domain = Domain::positive("reference diameter", "d");
        match value.get_ref() {
            DeValue::String(text) if text.as_ref() == "pinion" => Some(RackDiameter::Pinion),
            DeValue::String(text) if text.as_ref() == "developed" => Some(RackDiameter::Developed),
            DeValue::String(text) if !text.contains(|c: char| c.is_ascii_digit()) => {
                let message = format!("`{name}` must be \"pinion\", \"developed\" or a length");
                self.refuse(Diagnostic::error(Code::WrongType, message), value.span())
            }
            _ => {
                let length = self.length_value(name, value)?;
                self.in_domain(DIAMETER.check_length(length), value.span())?;
                Some(RackDiameter::Given(length))
            }
        }
    }

    /// Where the play of the yoke is set.
    fn set_at(&mut self, name: &str, value: &Spanned<DeValue<'_>>) -> Option<SetAt> {
        match value.get_ref() {
            DeValue::String(text) if text.as_ref() == "tightest" => Some(SetAt::Tightest),
            DeValue::String(text) if !text.contains(|c: char| c.is_ascii_digit()) => {
                let message = format!("`{name}` must be a stroke or \"tightest\"");
                self.refuse(Diagnostic::error(Code::WrongType, message), value.span())
            }
            _ => Some(SetAt::Stroke(self.length_value(name, value)?.mm())),
        }
    }

    /// A range of teeth.
    fn teeth_value(&mut self, name: &str, value: &Spanned<DeValue<'_>>) -> Option<ToothRange> {
        let text = match value.get_ref() {
            DeValue::String(text) => text.as_ref(),
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str(),
            _ => return self.wrong_type(name, value, "a tooth number or text such as \"8..=12\""),
        };
        self.accept(name, text.parse(), Code::BadTeeth, value.span())
    }

    /// One of the words that a key allows.
    fn word_value(&mut self, name: &str, value: &Spanned<DeValue<'_>>, words: &[&'static str]) -> Option<&'static str> {
        let found = match value.get_ref() {
            DeValue::String(text) => words.iter().find(|word| **word == text.as_ref()),
            _ => None,
        };
        if found.is_none() {
            let quoted: Vec<_> = words.iter().map(|word| format!("\"{word}\"")).collect();
            let message = format!("`{name}` must be {}", quoted.join(" or "));
            self.report(Diagnostic::error(Code::WrongType, message), value.span());
        }
        found.copied()
    }

    /// The grade of a class.
    pub(super) fn class_value(&mut self, value: &Spanned<DeValue<'_>>) -> Option<u8> {
        let DeValue::Integer(integer) = value.get_ref() else {
            return self.wrong_type("class", value, "a whole number");
        };
        let grade = integer.as_str().parse().ok().filter(|grade| integer.radix() == 10 && *grade <= LARGEST_CLASS);
        if grade.is_none() {
            let message = format!("`class` is {}; grades are 0 to {LARGEST_CLASS}", integer.as_str());
            self.report(Diagnostic::error(Code::OutOfDomain, message), value.span());
        }
        grade
    }

    /// A number in the key's unit, or text that names another.
    pub(super) fn measure_value(&mut self, name: &str, value: &Spanned<DeValue<'_>>, unit: MeasureUnit) -> Option<f64> {
        let DeValue::String(text) = value.get_ref() else { return self.plain_number(name, value) };
        self.accept(name, in_unit(text, unit), Code::BadQuantity, value.span())
    }

    /// A number, unless it lies outside its domain; `unit` stands behind numbers.
    fn number_in(&mut self, domain: &Domain, unit: &'static str, number: f64, span: Range<usize>) -> Option<f64> {
        if domain.contains(number) {
            return Some(number);
        }
        let bounds = domain.in_words(unit);
        let message = format!("the {} {} is {number}{unit}; it must be {bounds}", domain.name, domain.symbol);
        self.refuse(Diagnostic::error(Code::OutOfDomain, message), span)
    }

    pub(super) fn plain_number(&mut self, name: &str, value: &Spanned<DeValue<'_>>) -> Option<f64> {
        let Some(written) = decimal_text(value.get_ref()) else {
            return self.wrong_type(name, value, "a number");
        };
        let bad = |error| Diagnostic::error(Code::BadQuantity, format!("`{name}` is not a number: {error}"));
        parse_f64(&written).map_err(|error| self.report(bad(error), value.span())).ok()
    }

    /// A length under `name`, unchecked against a domain.
    pub(super) fn length_value(&mut self, name: &str, value: &Spanned<DeValue<'_>>) -> Option<Length> {
        self.quantity(name, value, "a length (a number in mm, or text such as \"20 um\")")
    }

    /// An angle under `name`, unchecked against a domain.
    pub(super) fn angle_value(&mut self, name: &str, value: &Spanned<DeValue<'_>>) -> Option<Angle> {
        self.quantity(name, value, "an angle (a number in degrees, or text such as \"15 arcmin\")")
    }

    /// An angle in degrees, or a length in mm.
    pub(super) fn base_value(&mut self, name: &str, value: &Spanned<DeValue<'_>>, is_angle: bool) -> Option<f64> {
        Some(if is_angle { self.angle_value(name, value)?.degrees() } else { self.length_value(name, value)?.mm() })
    }

    fn quantity<Q: std::str::FromStr<Err = QuantityError>>(
        &mut self,
        name: &str,
        value: &Spanned<DeValue<'_>>,
        needed: &str,
    ) -> Option<Q> {
        let text = match value.get_ref() {
            DeValue::String(text) => Some(text.to_string()),
            other => decimal_text(other),
        };
        let Some(text) = text else { return self.wrong_type(name, value, needed) };
        self.accept(name, text.parse(), Code::BadQuantity, value.span())
    }

    pub(super) fn in_domain(&mut self, check: Result<(), DomainError>, span: Range<usize>) -> Option<()> {
        check.map_err(|error| self.report(Diagnostic::error(Code::OutOfDomain, error.to_string()), span)).ok()
    }
}

/// A number with one of a unit's symbols.
pub(super) fn in_unit(text: &str, unit: MeasureUnit) -> Result<f64, String> {
    let (written, symbol) = split_number(text);
    let number = parse_f64(written).map_err(|error| format!("`{text}` is not a number: {error}"))?;
    if symbol.is_empty() || symbol == unit.symbol {
        return Ok(number);
    }
    match unit.others.iter().find(|other| other.0 == symbol) {
        Some((_, numerator, denominator)) => Ok(number * numerator / denominator),
        None if unit.symbol.is_empty() => Err(format!("`{symbol}` is no part of a number without a unit")),
        None => Err(format!("`{symbol}` is not a unit that fits; write {}", unit.symbol)),
    }
}

/// The text of a decimal number as it stands in the file, so that no digit is lost on the way; TOML groups digits by
/// underscores.
pub(super) fn decimal_text(value: &DeValue<'_>) -> Option<String> {
    match value {
        DeValue::Float(float) => Some(float.as_str().replace('_', "")),
        DeValue::Integer(integer) if integer.radix() == 10 => Some(integer.as_str().replace('_', "")),
        _ => None,
    }
}

pub(super) fn type_in_words(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Integer(integer) if integer.radix() != 10 => "a number that is not decimal",
        DeValue::Integer(_) => "a whole number",
        DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

/// The unknown keys of a table, in the order of the file.
fn others<'t>(
    table: &'t DeTable<'_>,
    known: &(impl Iterator<Item = &'static str> + Clone),
) -> Vec<&'t Spanned<DeString<'t>>> {
    let is_known = |key: &str| known.clone().any(|known| known == key);
    let mut others: Vec<_> = table.keys().filter(|key| !is_known(key.get_ref())).collect();
    others.sort_by_key(|key| key.span().start);
    others
}

/// Suggestions with their whole path, which `--set` needs: the section with this name, else the keys of the first section whose
/// names end with it, else the most similar ones.
pub(super) fn elsewhere(name: &str) -> Option<String> {
    if SECTIONS.iter().any(|section| section.name == name) {
        return Some(format!("its keys stand in a section of its own: [{name}]"));
    }
    let ending = format!("_{name}");
    let ends_so = |section: &&Section| keys_of(section, |key| key.name().ends_with(&ending));
    let ends_so = sections().iter().map(ends_so).find(|found| !found.is_empty());
    let all = || sections().into_iter().flat_map(|section| section.keys).map(AnyKey::name);
    ways_to(&ends_so.or_else(|| nearest(name, all()).map(keys_called))?)
}

/// The sections, that of the errors first: measured values are meant most often.
fn sections() -> Vec<&'static Section> {
    let (errors, others): (Vec<_>, Vec<_>) = SECTIONS.iter().partition(|section| section.name == ERRORS.name);
    errors.into_iter().chain(others).collect()
}

fn keys_of(section: &Section, is: impl Fn(&AnyKey) -> bool) -> Vec<&'static AnyKey> {
    section.keys.iter().filter(|key| is(key)).collect()
}

/// The keys of any section with this name.
fn keys_called(name: &str) -> Vec<&'static AnyKey> {
    sections().into_iter().flat_map(|section| keys_of(section, |key| key.name() == name)).collect()
}

/// Keys as a question; `None` without one.
fn ways_to(keys: &[&AnyKey]) -> Option<String> {
    let ways: Vec<_> = keys.iter().map(|key| format!("`{}`", key.path)).collect();
    (!ways.is_empty()).then(|| format!("did you mean {}?", ways.join(" or ")))
}

/// The message for an unknown name: the keys of other sections with this name, else the known name most like it, else `help`.
pub(super) fn unknown(
    message: String,
    name: &str,
    known: impl Iterator<Item = &'static str>,
    help: impl FnOnce() -> String,
) -> Diagnostic {
    let called_so = ways_to(&keys_called(name));
    Diagnostic::error(Code::UnknownKey, message).help(called_so.unwrap_or_else(|| nearest_or(name, known, help)))
}
