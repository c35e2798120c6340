//! Every key of the spec with its kind, from the same table as the reader. `rackmesh explain keys` prints it, completions
//! offer it; it reads nothing.

use std::ops::Bound;

use super::keys::{Kind, SECTIONS, Section, TOP};
use crate::deviation::Extent;
use crate::quantity::Domain;

/// A key of the spec.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyEntry {
    /// The key with its sections: `rack.tip_relief.amount`.
    pub path: String,
    /// The kind of its value, in words.
    pub holds: String,
    /// Whether the value is a whole number.
    pub is_whole: bool,
    /// The meaning of the key.
    pub doc: &'static str,
}

/// Every key of the spec, in documented order.
#[must_use]
pub fn keys() -> Vec<KeyEntry> {
    let mut entries = Vec::new();
    for section in std::iter::once(&TOP).chain(SECTIONS) {
        add(section, section.name, &mut entries);
    }
    entries
}

/// Adds the keys of a section that is found under `path`, and of the tables in it.
fn add(section: &Section, path: &str, entries: &mut Vec<KeyEntry>) {
    for key in section.keys {
        let path = if path.is_empty() { key.name().to_owned() } else { format!("{path}.{}", key.name()) };
        let is_whole = matches!(key.kind, Kind::Count(_));
        entries.push(KeyEntry { path: path.clone(), holds: in_words(key.kind), is_whole, doc: key.doc });
        if let Kind::Table(section) | Kind::Whole(section) | Kind::Tables(section) = key.kind {
            add(section, &path, entries);
        }
    }
}

fn in_words(kind: Kind) -> String {
    let one_of = |words: &[&str]| words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(" or ");
    let text = match kind {
        Kind::Text => "text",
        Kind::Label => "text, a date or a number",
        Kind::File => "the name of a file",
        Kind::Length(domain) => return within("a length, mm", &domain, " mm"),
        Kind::Angle(domain) => return within("an angle, degrees", &domain, "°"),
        Kind::Number(domain) => return within("a number", &domain, ""),
        Kind::Count(domain) => return within("a whole number", &domain, ""),
        Kind::Measure(domain, unit) if unit.symbol.is_empty() => return within("a number", &domain, ""),
        Kind::Measure(domain, unit) => return within(&format!("a number, {}", unit.symbol), &domain, unit.after),
        Kind::Word(words) => return one_of(words),
        Kind::Flag => "true or false",
        Kind::Extent(counted) => return one_of(&Extent::names(counted)),
        Kind::Error(_) => "a deviation, or a table; a tolerance as { value = { lower, upper } }",
        Kind::Limit => "\"±0.05\", or { lower, upper }",
        Kind::MeasureLimit(_) => "{ lower, upper }",
        Kind::SetAt => "a length, mm, or \"tightest\"",
        Kind::Texts => "a list of texts",
        Kind::LineRules => "a list of texts, or of { like, at_most }",
        Kind::PartId => "a heading, or { line }",
        Kind::Starts => "a list of whole numbers",
        Kind::NominalOrHeading { is_angle: false } => "a length, mm, or a heading",
        Kind::NominalOrHeading { is_angle: true } => "an angle, degrees, or a heading",
        Kind::ColumnUnit { of_lead: false } => "a unit of length",
        Kind::ColumnUnit { of_lead: true } => "a unit of angle or length",
        Kind::Standard => "a standard",
        Kind::RackDiameter => "\"pinion\", \"developed\" or a length",
        Kind::Rule => "\"simple\", \"iso14253\" or \"guard=5um\"",
        Kind::Pair => "the names of two values",
        Kind::Tolerance(_) => "a tolerance, { value = { lower, upper } }, or \"free\"",
        Kind::Spread { class: Some(_), .. } => {
            "a standard deviation, a half-width, { value = { lower, upper } } or a class"
        }
        Kind::Spread { class: None, .. } => "a standard deviation, a half-width or { value = { lower, upper } }",
        Kind::Teeth => "\"all\", 5, \"8..\" or \"8..=12\"",
        Kind::Table(_) | Kind::Whole(_) => "a table",
        Kind::Tables(_) => "any number of tables",
    };
    text.to_owned()
}

fn within(what: &str, domain: &Domain, unit: &'static str) -> String {
    match (domain.lower, domain.upper) {
        (Bound::Unbounded, Bound::Unbounded) => what.to_owned(),
        _ => format!("{what}, {}", domain.in_words(unit)),
    }
}
