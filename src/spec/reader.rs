//! Reads one section of a spec: typed values by key, collecting every problem on the way. Called by the files of the
//! sections; never ends at the first problem and requires no key.

use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Located;
use super::errors::LARGEST_CLASS;
use super::keys::{Kind, SECTIONS, Section, Unit};
use super::uncertainty::source_of;
use crate::diagnostic::{Code, Diagnostic, Source};
use crate::judge::class::RackDiameter;
use crate::quantity::{Angle, Domain, DomainError, Length, QuantityError, parse_f64, split_number};
use crate::standard::Standard;
use crate::uncertainty::{Source as UncertainSource, Uncertainty};

/// A table of the spec while it is being read.
pub(super) struct SectionReader<'a> {
    pub(super) source: &'a Arc<Source>,
    pub(super) section: &'static Section,
    pub(super) table: Option<&'a DeTable<'a>>,
    pub(super) diagnostics: &'a mut Vec<Diagnostic>,
    /// The uncertainties found so far.
    pub(super) uncertainties: &'a mut Vec<(UncertainSource, Located<Uncertainty>)>,
}

impl SectionReader<'_> {
    /// Reports keys that the section does not have.
    pub(super) fn refuse_unknown_keys(&mut self) {
        let known = |name: &str| self.section.keys.iter().any(|key| key.name == name);
        for (key, _) in self.table.into_iter().flatten() {
            let name = key.get_ref().as_ref();
            if !known(name) {
                let section = format!("[{}]", self.section.name);
                let mut diagnostic = Diagnostic::error(Code::UnknownKey, format!("{section} has no key `{name}`"));
                let own = self.section.keys.iter().map(|key| key.name);
                if let Some(similar) = similar(name, own) {
                    diagnostic = diagnostic.help(format!("did you mean `{similar}`?"));
                } else if let Some(other) = SECTIONS.iter().find(|other| other.keys.iter().any(|key| key.name == name))
                {
                    diagnostic = diagnostic.help(format!("`{name}` is a key of [{}]", other.name));
                } else {
                    let names: Vec<_> = self.section.keys.iter().map(|key| key.name).collect();
                    diagnostic = diagnostic.help(format!("the keys of {section} are {}", names.join(", ")));
                }
                self.diagnostics.push(diagnostic.at(self.source, key.span(), "unknown key"));
            }
        }
    }

    pub(super) fn kind(&self, name: &str) -> Option<Kind> {
        let key = self.section.keys.iter().find(|key| key.name == name);
        debug_assert!(key.is_some(), "{name} is not declared in keys.rs");
        key.map(|key| key.kind)
    }

    pub(super) fn report(&mut self, diagnostic: Diagnostic, span: Range<usize>, label: &str) {
        self.diagnostics.push(diagnostic.at(self.source, span, label));
    }

    pub(super) fn wrong_type(&mut self, name: &str, value: &Spanned<DeValue<'_>>, needed: &str) {
        let message = format!("`{name}` is {}; {needed} is needed", type_in_words(value.get_ref()));
        self.report(Diagnostic::error(Code::WrongType, message), value.span(), "");
    }

    pub(super) fn text(&mut self, name: &str) -> Option<String> {
        let value = self.table?.get(name)?;
        if let DeValue::String(text) = value.get_ref() {
            return Some(text.to_string());
        }
        self.wrong_type(name, value, "text in quotes");
        None
    }

    pub(super) fn length(&mut self, name: &str) -> Option<Located<Length>> {
        let value = self.table?.get(name)?;
        let Some(Kind::Length(domain)) = self.kind(name) else { return None };
        let value = self.uncertain(name, value, source_of(self.section.name, name))?;
        let length = self.length_value(name, value)?;
        self.in_domain(domain.check_length(length), value.span())?;
        Some(Located { value: length, span: value.span() })
    }

    pub(super) fn angle(&mut self, name: &str) -> Option<Located<Angle>> {
        let value = self.table?.get(name)?;
        let Some(Kind::Angle(domain)) = self.kind(name) else { return None };
        let value = self.uncertain(name, value, source_of(self.section.name, name))?;
        let angle = self.angle_value(name, value)?;
        self.in_domain(domain.check_angle(angle), value.span())?;
        Some(Located { value: angle, span: value.span() })
    }

    pub(super) fn number(&mut self, name: &str) -> Option<Located<f64>> {
        let value = self.table?.get(name)?;
        let number = self.plain_number(name, value)?;
        Some(Located { value: number, span: value.span() })
    }

    pub(super) fn count(&mut self, name: &str) -> Option<Located<u32>> {
        let value = self.table?.get(name)?;
        let Some(Kind::Count(domain)) = self.kind(name) else { return None };
        let DeValue::Integer(_) = value.get_ref() else {
            self.wrong_type(name, value, "a whole number");
            return None;
        };
        let number = self.plain_number(name, value)?;
        if !domain.contains(number) {
            let message =
                format!("the {} {} is {number}; it must be {}", domain.name, domain.symbol, domain.in_words(""));
            self.report(Diagnostic::error(Code::OutOfDomain, message), value.span(), "");
            return None;
        }
        // the domain is far inside u32, and the number is whole
        Some(Located { value: number as u32, span: value.span() })
    }

    /// The name of a standard.
    pub(super) fn standard(&mut self, name: &str) -> Option<Located<Standard>> {
        let value = self.table?.get(name)?;
        match self.text(name)?.parse() {
            Ok(standard) => Some(Located { value: standard, span: value.span() }),
            Err(error) => {
                let message = format!("`{name}`: {error}");
                self.report(Diagnostic::error(Code::UnknownStandard, message), value.span(), "");
                None
            }
        }
    }

    /// Which diameter stands for a rack.
    pub(super) fn rack_diameter(&mut self, name: &str) -> Option<Located<RackDiameter>> {
        const DIAMETER: Domain = Domain::positive("reference diameter", "d");
        let value = self.table?.get(name)?;
        let choice = match value.get_ref() {
            DeValue::String(text) if text.as_ref() == "pinion" => RackDiameter::Pinion,
            DeValue::String(text) if text.as_ref() == "developed" => RackDiameter::Developed,
            DeValue::String(text) if !text.contains(|c: char| c.is_ascii_digit()) => {
                let message = format!("`{name}` must be \"pinion\", \"developed\" or a length");
                self.report(Diagnostic::error(Code::WrongType, message), value.span(), "");
                return None;
            }
            _ => {
                let length = self.length_value(name, value)?;
                self.in_domain(DIAMETER.check_length(length), value.span())?;
                RackDiameter::Given(length)
            }
        };
        Some(Located { value: choice, span: value.span() })
    }

    /// The grade of a class.
    pub(super) fn class_value(&mut self, value: &Spanned<DeValue<'_>>) -> Option<u8> {
        let DeValue::Integer(integer) = value.get_ref() else {
            self.wrong_type("class", value, "a whole number");
            return None;
        };
        let grade = integer.as_str().parse().ok().filter(|grade| integer.radix() == 10 && *grade <= LARGEST_CLASS);
        if grade.is_none() {
            let message = format!("`class` is {}; grades are 0 to {LARGEST_CLASS}", integer.as_str());
            self.report(Diagnostic::error(Code::OutOfDomain, message), value.span(), "");
        }
        grade
    }

    /// A number in the key's unit, or text that names another.
    pub(super) fn measure(&mut self, name: &str) -> Option<Located<f64>> {
        let value = self.table?.get(name)?;
        let Some(Kind::Measure(domain, unit)) = self.kind(name) else { return None };
        let number = match value.get_ref() {
            DeValue::String(text) => match in_unit(text, unit) {
                Ok(number) => number,
                Err(problem) => {
                    let message = format!("`{name}`: {problem}");
                    self.report(Diagnostic::error(Code::BadQuantity, message), value.span(), "");
                    return None;
                }
            },
            _ => self.plain_number(name, value)?,
        };
        if !domain.contains(number) {
            let unit = unit.after;
            let bounds = domain.in_words(unit);
            let message = format!("the {} {} is {number}{unit}; it must be {bounds}", domain.name, domain.symbol);
            self.report(Diagnostic::error(Code::OutOfDomain, message), value.span(), "");
            return None;
        }
        Some(Located { value: number, span: value.span() })
    }

    pub(super) fn plain_number(&mut self, name: &str, value: &Spanned<DeValue<'_>>) -> Option<f64> {
        let Some(written) = decimal_text(value.get_ref()) else {
            self.wrong_type(name, value, "a number");
            return None;
        };
        match parse_f64(&written) {
            Ok(number) => Some(number),
            Err(error) => {
                let message = format!("`{name}` is not a number: {error}");
                self.report(Diagnostic::error(Code::BadQuantity, message), value.span(), "");
                None
            }
        }
    }

    /// A length under `name`, unchecked against a domain.
    pub(super) fn length_value(&mut self, name: &str, value: &Spanned<DeValue<'_>>) -> Option<Length> {
        self.quantity(name, value, "a length (a number in mm, or text such as \"20 um\")")
    }

    /// An angle under `name`, unchecked against a domain.
    pub(super) fn angle_value(&mut self, name: &str, value: &Spanned<DeValue<'_>>) -> Option<Angle> {
        self.quantity(name, value, "an angle (a number in degrees, or text such as \"15 arcmin\")")
    }

    fn quantity<Q: std::str::FromStr<Err = QuantityError>>(
        &mut self,
        name: &str,
        value: &Spanned<DeValue<'_>>,
        needed: &str,
    ) -> Option<Q> {
        let text = match value.get_ref() {
            DeValue::String(text) => text.to_string(),
            other => {
                let Some(text) = decimal_text(other) else {
                    self.wrong_type(name, value, needed);
                    return None;
                };
                text
            }
        };
        match text.parse() {
            Ok(quantity) => Some(quantity),
            Err(error) => {
                let message = format!("`{name}`: {error}");
                self.report(Diagnostic::error(Code::BadQuantity, message), value.span(), "");
                None
            }
        }
    }

    pub(super) fn in_domain(&mut self, check: Result<(), DomainError>, span: Range<usize>) -> Option<()> {
        match check {
            Ok(()) => Some(()),
            Err(error) => {
                self.report(Diagnostic::error(Code::OutOfDomain, error.to_string()), span, "");
                None
            }
        }
    }
}

/// A number with one of a unit's symbols.
fn in_unit(text: &str, unit: Unit) -> Result<f64, String> {
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
fn decimal_text(value: &DeValue<'_>) -> Option<String> {
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

/// The name most like a misspelt one, if any is like it at all.
pub(super) fn similar(name: &str, candidates: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    const LIKE: f64 = 0.85;
    candidates
        .map(|candidate| (strsim::jaro_winkler(&name.to_lowercase(), candidate), candidate))
        .filter(|(likeness, _)| *likeness >= LIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}
