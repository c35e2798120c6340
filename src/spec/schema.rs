//! The spec's JSON Schema, from the same table as the reader. Printed by `rackmesh schema`; names no key by itself.

use std::collections::BTreeSet;
use std::ops::Bound;

use serde_json::{Map, Value, json};

use super::errors::{error_table_forms, has_circle, is_of_a_part};
use super::keys::{
    AnyKey, EVERY_PART, EXTENT, Kind, LARGEST_CLASS, MEASURED_AT, READINGS, SECTIONS, Section, TOP, UNCERTAINTY_KEYS,
};
use crate::deviation::{Countable, DeviationKind, Extent};
use crate::quantity::{AngleUnit, Domain, LengthUnit, spelling_pattern};
use crate::standard::Standard;
use crate::uncertainty::Influence;

/// The JSON Schema (draft 2020-12) of the spec, so that editors complete keys and mark mistakes.
#[must_use]
pub fn json_schema() -> Value {
    let sections = SECTIONS.iter().map(|section| (section.name, object(section)));
    let properties: Map<_, _> = TOP
        .keys
        .iter()
        .map(|key| (key.name(), property(key)))
        .chain(sections)
        .map(|(name, schema)| (name.to_owned(), schema))
        .collect();
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "rackmesh gear spec",
        "description": TOP.doc,
        "type": "object",
        "additionalProperties": false,
        "properties": properties,
    })
}

fn object(section: &Section) -> Value {
    let properties: Map<_, _> = section.keys.iter().map(|key| (key.name().to_owned(), property(key))).collect();
    json!({
        "description": section.doc,
        "type": "object",
        "additionalProperties": false,
        "properties": properties,
    })
}

/// A table with these keys and no others, some of which it must have.
fn closed(properties: impl Into<Value>, required: &[&str]) -> Value {
    let properties: Value = properties.into();
    json!({ "type": "object", "additionalProperties": false, "required": required, "properties": properties })
}

fn property(key: &AnyKey) -> Value {
    let source = Influence::of_gear(key.path);
    let mut schema = match key.kind {
        Kind::Text | Kind::File => json!({ "type": "string" }),
        Kind::Number(domain) => typed("number", &domain),
        Kind::Count(domain) => typed("integer", &domain),
        Kind::Length(domain) => json!({ "anyOf": forms(vec![typed("number", &domain), length_text()], source) }),
        Kind::Measure(domain, unit) if unit.symbol.is_empty() => typed("number", &domain),
        Kind::Angle(domain) | Kind::Measure(domain, _) => {
            json!({ "anyOf": forms(vec![typed("number", &domain), json!({ "type": "string" })], source) })
        }
        Kind::Rule => json!({ "type": "string", "pattern": r"^\s*(simple|iso14253|guard=.+)\s*$" }),
        Kind::Spread { is_angle, class } => spread(is_angle, class.is_some()),
        Kind::Texts => json!({ "type": "array", "items": { "type": "string" } }),
        Kind::LineRules => {
            let most = json!({ "type": "integer", "minimum": 0 });
            let rule = closed(json!({ "like": { "type": "string" }, "at_most": most }), &["like"]);
            json!({ "type": "array", "items": { "anyOf": [{ "type": "string" }, rule] } })
        }
        Kind::PartId => {
            json!({ "anyOf": [{ "type": "string" }, closed(json!({ "line": { "type": "string" } }), &["line"])] })
        }
        Kind::Starts => json!({ "type": "array", "items": { "type": "integer", "minimum": 0 } }),
        Kind::NominalOrHeading { .. } => json!({ "anyOf": [{ "type": "number" }, { "type": "string" }] }),
        Kind::ColumnUnit { of_lead } => {
            let lengths = LengthUnit::ALL.into_iter().flat_map(LengthUnit::spellings);
            let angles = AngleUnit::ALL.into_iter().filter(|_| of_lead).flat_map(AngleUnit::spellings);
            json!({ "enum": lengths.chain(angles).collect::<BTreeSet<_>>() })
        }
        Kind::Pair => json!({ "type": "array", "items": { "type": "string" }, "minItems": 2, "maxItems": 2 }),
        Kind::Error(kind) => error(kind),
        Kind::Extent(counted) => extent(counted),
        Kind::Word(words) => json!({ "enum": words }),
        Kind::Tolerance(kind) => tolerance(kind),
        Kind::Standard => json!({ "anyOf": [
            { "enum": Standard::ALL.map(Standard::id) },
            { "type": "string" },
        ] }),
        Kind::RackDiameter => json!({ "anyOf": [
            { "enum": ["pinion", "developed"] },
            { "type": "number", "exclusiveMinimum": 0 },
            length_text(),
        ] }),
        Kind::Teeth => json!({ "anyOf": [{ "type": "integer" }, { "type": "string" }] }),
        Kind::Table(section) | Kind::Whole(section) => object(section),
        Kind::Tables(section) => json!({ "type": "array", "items": object(section) }),
        Kind::Limit => {
            let end = json!({ "anyOf": [{ "type": "number" }, length_text()] });
            json!({ "anyOf": [
                { "type": "string", "pattern": length_pattern(r"(±|\+-|\+/-)\s*") },
                {
                    "type": "object",
                    "additionalProperties": false,
                    "minProperties": 1,
                    "properties": { "lower": end, "upper": end },
                },
            ] })
        }
    };
    if let Value::Object(schema) = &mut schema {
        schema.insert("description".to_owned(), key.doc.into());
    }
    schema
}

/// A spread: of an angle or a length, as a class too where there is one.
fn spread(is_angle: bool, has_class: bool) -> Value {
    let text = if is_angle { json!({ "type": "string" }) } else { length_text() };
    let amount = json!({ "anyOf": [{ "type": "number", "exclusiveMinimum": 0 }, text] });
    let distribution = &uncertainty_properties()["distribution"];
    let properties = json!({ "half_width": amount, "distribution": distribution });
    let half_width = closed(properties, &["half_width", "distribution"]);
    let between = closed(json!({ "value": ends(), "distribution": distribution }), &["value"]);
    let mut forms = vec![amount, half_width, between];
    if has_class {
        forms.push(closed(json!({ "class": grade() }), &["class"]));
    }
    json!({ "anyOf": forms })
}

/// An entry of `[budget]`.
fn tolerance(kind: DeviationKind) -> Value {
    let number = json!({ "type": "number", "exclusiveMinimum": 0 });
    let free = |name: &str| closed(json!({ name: number, EXTENT: extent(kind.counts()) }), &[name]);
    json!({ "anyOf": [{ "const": "free" }, free("weight"), free("cost"), error(kind)] })
}

/// The forms of a value, with one that carries an uncertainty where that means anything.
fn forms(mut forms: Vec<Value>, source: Option<Influence>) -> Vec<Value> {
    if source.is_some() {
        let mut properties = uncertainty_properties();
        properties.insert("value".to_owned(), json!({ "anyOf": forms }));
        forms.push(closed(properties, &["value"]));
        forms.push(closed(json!({ READINGS: readings() }), &[READINGS]));
    }
    forms
}

fn uncertainty_properties() -> Map<String, Value> {
    let quantity = json!({ "anyOf": [{ "type": "number", "minimum": 0 }, { "type": "string" }] });
    UNCERTAINTY_KEYS
        .into_iter()
        .map(|name| {
            let schema = match name {
                "k" => json!({ "type": "number", "exclusiveMinimum": 0 }),
                "dof" => json!({ "type": "number", "minimum": 1 }),
                "distribution" => json!({ "enum": ["normal", "rectangular", "triangular", "arcsine"] }),
                _ => quantity.clone(),
            };
            (name.to_owned(), schema)
        })
        .collect()
}

/// Repeated readings.
fn readings() -> Value {
    json!({ "type": "array", "items": { "anyOf": [{ "type": "number" }, { "type": "string" }] }, "minItems": 2 })
}

/// The extents that an error that counts these may have.
fn extent(counted: Countable) -> Value {
    json!({ "enum": Extent::names(counted) })
}

fn grade() -> Value {
    json!({ "type": "integer", "minimum": 0, "maximum": LARGEST_CLASS })
}

fn length_text() -> Value {
    json!({ "type": "string", "pattern": length_pattern(r"[+\-−]?") })
}

/// A length as text, behind what `sign` matches.
fn length_pattern(sign: &str) -> String {
    let spellings = LengthUnit::ALL.into_iter().flat_map(LengthUnit::spellings);
    let units: Vec<_> = spellings.map(|spelling| spelling_pattern(spelling)).collect();
    format!(r"^\s*{sign}[0-9.]+([eE][+\-]?[0-9]+)?\s*({})?\s*$", units.join("|"))
}

fn error(kind: DeviationKind) -> Value {
    let text = if kind == DeviationKind::RackLead { json!({ "type": "string" }) } else { length_text() };
    let mut forms = vec![json!({ "type": "number" }), text];
    for form in error_table_forms(kind) {
        let value = |name: &str| match name {
            "class" => grade(),
            "value" | "f_h_beta" => json!({ "anyOf": [{ "type": "number" }, { "type": "string" }, ends()] }),
            READINGS => readings(),
            _ => json!({ "anyOf": [{ "type": "number" }, { "type": "string" }] }),
        };
        let mut properties: Map<_, _> = form.iter().map(|name| ((*name).to_owned(), value(name))).collect();
        if *form != ["class"] {
            properties.extend(beside(kind));
            if form[0] == READINGS {
                for key in UNCERTAINTY_KEYS {
                    properties.remove(key);
                }
            }
        }
        if is_of_a_part(form) {
            properties.insert(EVERY_PART.to_owned(), json!({ "type": "boolean" }));
        }
        forms.push(closed(properties, form));
    }
    // the uncertainty and extent of values that come from a table
    forms.push(json!({
        "type": "object",
        "additionalProperties": false,
        "minProperties": 1,
        "properties": beside(kind),
    }));
    json!({ "anyOf": forms })
}

/// What may stand beside the value of an error: its uncertainty, its extent, and the circle of a pitch.
fn beside(kind: DeviationKind) -> Map<String, Value> {
    let mut properties = uncertainty_properties();
    properties.insert(EXTENT.to_owned(), extent(kind.counts()));
    if has_circle(kind) {
        properties.insert(MEASURED_AT.to_owned(), json!({ "anyOf": [{ "type": "number" }, length_text()] }));
    }
    properties
}

/// Both ends of a tolerance.
fn ends() -> Value {
    let end = json!({ "anyOf": [{ "type": "number" }, { "type": "string" }] });
    closed(json!({ "lower": end, "upper": end }), &["lower", "upper"])
}

fn typed(name: &str, domain: &Domain) -> Value {
    let mut schema = json!({ "type": name });
    let ends = [(domain.lower, "minimum", "exclusiveMinimum"), (domain.upper, "maximum", "exclusiveMaximum")];
    for (end, inclusive, exclusive) in ends {
        match end {
            Bound::Unbounded => {}
            Bound::Excluded(bound) => schema[exclusive] = bound.into(),
            Bound::Included(bound) => schema[inclusive] = bound.into(),
        }
    }
    schema
}
