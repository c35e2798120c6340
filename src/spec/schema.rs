//! The spec's JSON Schema, from the same table as the reader. `rackmesh schema` prints it; it names no key itself.

use std::collections::BTreeMap;
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
    let mut schema = Schema::default();
    let mut properties = schema.properties(&TOP);
    properties.extend(SECTIONS.iter().map(|section| (section.name.to_owned(), schema.section(section))));
    let mut made = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "rackmesh gear spec",
        "description": TOP.doc,
        "type": "object",
        "additionalProperties": false,
        "properties": properties,
        "$defs": schema.definitions.clone(),
    });
    let mut counts = BTreeMap::new();
    count_references(&made, &mut counts);
    let once: Map<String, Value> =
        schema.definitions.into_iter().filter(|(name, _)| counts.get(name) == Some(&1)).collect();
    if let Some(definitions) = made["$defs"].as_object_mut() {
        definitions.retain(|name, _| !once.contains_key(name));
    }
    put_in_place(&mut made, &once);
    made
}

/// The name of the definition that a schema refers to.
fn referred(schema: &Map<String, Value>) -> Option<&str> {
    schema.get("$ref")?.as_str()?.strip_prefix("#/$defs/")
}

/// Counts how often each definition is referred to.
fn count_references(schema: &Value, counts: &mut BTreeMap<String, usize>) {
    match schema {
        Value::Object(object) => {
            if let Some(name) = referred(object) {
                *counts.entry(name.to_owned()).or_default() += 1;
            }
            object.values().for_each(|value| count_references(value, counts));
        }
        Value::Array(list) => list.iter().for_each(|value| count_references(value, counts)),
        _ => {}
    }
}

/// Moves definitions with a single reference to that place; the keywords beside the reference stay.
fn put_in_place(schema: &mut Value, once: &Map<String, Value>) {
    match schema {
        Value::Object(object) => {
            if let Some(Value::Object(definition)) = referred(object).and_then(|name| once.get(name)).cloned() {
                object.remove("$ref");
                for (key, value) in definition {
                    object.entry(key).or_insert(value);
                }
            }
            object.values_mut().for_each(|value| put_in_place(value, once));
        }
        Value::Array(list) => list.iter_mut().for_each(|value| put_in_place(value, once)),
        _ => {}
    }
}

/// The definitions, by name.
#[derive(Default)]
struct Schema {
    definitions: Map<String, Value>,
}

impl Schema {
    /// Refers to a schema under this name, or under the name with a number where another one has it.
    fn shared(&mut self, name: &str, schema: Value) -> Value {
        let names = (1..).map(|number| if number == 1 { name.to_owned() } else { format!("{name}_{number}") });
        let is_free = |name: &String| self.definitions.get(name).is_none_or(|there| *there == schema);
        let Some(name) = names.into_iter().find(is_free) else { return schema };
        let reference = json!({ "$ref": format!("#/$defs/{name}") });
        self.definitions.insert(name, schema);
        reference
    }

    fn properties(&mut self, section: &Section) -> Map<String, Value> {
        section.keys.iter().map(|key| (key.name().to_owned(), self.described(key))).collect()
    }

    fn section(&mut self, section: &Section) -> Value {
        let mut schema = closed(self.properties(section), &[]);
        schema["description"] = section.doc.into();
        schema
    }

    /// A key with its meaning; keys that several tables share stand among the definitions.
    fn described(&mut self, key: &AnyKey) -> Value {
        let mut schema = self.key(key);
        schema["description"] = key.doc.into();
        let has_one_place = key.path.contains('.') || matches!(key.kind, Kind::Table(_) | Kind::Tables(_));
        if has_one_place { schema } else { self.shared(key.name(), schema) }
    }

    fn key(&mut self, key: &AnyKey) -> Value {
        let source = Influence::of_gear(key.path);
        match key.kind {
            Kind::Text | Kind::File => text(),
            Kind::Label => json!({ "type": ["string", "number"] }),
            Kind::Number(domain) => typed("number", &domain),
            Kind::Count(domain) => typed("integer", &domain),
            Kind::Length(domain) => {
                let forms = vec![typed("number", &domain), self.length()];
                self.size(forms, source)
            }
            Kind::Measure(domain, unit) if unit.symbol.is_empty() => typed("number", &domain),
            Kind::Angle(domain) | Kind::Measure(domain, _) => self.size(vec![typed("number", &domain), text()], source),
            Kind::Rule => json!({ "type": "string", "pattern": r"^\s*(simple|iso14253|guard=.+)\s*$" }),
            Kind::Spread { is_angle, class } => self.spread(is_angle, class.is_some()),
            Kind::Texts => json!({ "type": "array", "items": text() }),
            Kind::LineRules => {
                let most = json!({ "type": "integer", "minimum": 0 });
                let rule = closed(json!({ "like": text(), "at_most": most }), &["like"]);
                json!({ "type": "array", "items": any_of([text(), rule]) })
            }
            Kind::PartId => any_of([text(), closed(json!({ "line": text() }), &["line"])]),
            Kind::Starts => json!({ "type": "array", "items": { "type": "integer", "minimum": 0 } }),
            Kind::NominalOrHeading { .. } | Kind::SetAt => self.quantity(),
            Kind::ColumnUnit { of_lead } => {
                let lengths = LengthUnit::ALL.into_iter().flat_map(LengthUnit::spellings).collect::<Vec<_>>();
                let angles = AngleUnit::ALL.into_iter().flat_map(AngleUnit::spellings).collect::<Vec<_>>();
                let lengths = self.shared("unit_of_length", json!({ "enum": lengths }));
                let either = |angles| any_of([lengths.clone(), angles]);
                if of_lead { either(self.shared("unit_of_angle", json!({ "enum": angles }))) } else { lengths }
            }
            Kind::Pair => json!({ "type": "array", "items": text(), "minItems": 2, "maxItems": 2 }),
            Kind::Error(kind) => self.error(kind),
            Kind::Extent(counted) => self.extent(counted),
            Kind::Word(words) => json!({ "enum": words }),
            Kind::Flag => json!({ "type": "boolean" }),
            Kind::Tolerance(kind) => self.tolerance(kind),
            Kind::Standard => any_of([json!({ "enum": Standard::ALL.map(Standard::id) }), text()]),
            Kind::RackDiameter => any_of([json!({ "enum": ["pinion", "developed"] }), above_zero(), self.length()]),
            Kind::Teeth => any_of([json!({ "type": "integer" }), text()]),
            // the columns of several errors have the same keys
            Kind::Table(section) if section.name.contains("columns.") => {
                let column = closed(self.properties(section), &[]);
                self.shared("column", column)
            }
            Kind::Table(section) | Kind::Whole(section) => self.section(section),
            Kind::Tables(section) => json!({ "type": "array", "items": self.section(section) }),
            Kind::Limit => self.limit(),
            Kind::MeasureLimit(_) => {
                let end = self.quantity();
                let ends = closed(json!({ "lower": end, "upper": end }), &[]);
                self.shared("bounds", ends)
            }
        }
    }

    /// Text that is a length: a number with a sign and one of the units, or none.
    fn length(&mut self) -> Value {
        self.signed_length("length", r"^\s*[+\-−]?[0-9.]")
    }

    /// A length with a sign that `sign` matches.
    fn signed_length(&mut self, name: &str, sign: &str) -> Value {
        let spellings = LengthUnit::ALL.into_iter().flat_map(LengthUnit::spellings).copied();
        let all: Vec<&str> = spellings.collect();
        let one = |spelling: &&str| {
            let plural = format!("{spelling}s");
            let is_plural = spelling.strip_suffix('s').is_some_and(|one| all.contains(&one));
            let ending = if all.contains(&plural.as_str()) { "[sS]?" } else { "" };
            (!is_plural).then(|| spelling_pattern(spelling) + ending)
        };
        let units: Vec<_> = all.iter().filter_map(one).collect();
        let pattern = format!(r"^\s*(±|\+/?-|[+\-−])?\s*[0-9.]+([eE][+\-]?[0-9]+)?\s*({})?\s*$", units.join("|"));
        let any_sign = self.shared("in_units_of_length", json!({ "type": "string", "pattern": pattern }));
        self.shared(name, json!({ "allOf": [{ "pattern": sign }, any_sign] }))
    }

    /// A number, or text with a unit.
    fn quantity(&mut self) -> Value {
        self.shared("quantity", any_of([json!({ "type": "number" }), text()]))
    }

    fn readings(&mut self) -> Value {
        let items = self.quantity();
        self.shared("readings", json!({ "type": "array", "items": items, "minItems": 2 }))
    }

    /// Both ends of a tolerance.
    fn ends(&mut self) -> Value {
        let end = self.quantity();
        self.shared("ends", closed(json!({ "lower": end, "upper": end }), &["lower", "upper"]))
    }

    fn limit(&mut self) -> Value {
        let either_way = self.signed_length("either_way", r"^\s*(±|\+/?-)");
        let end = any_of([json!({ "type": "number" }), self.length()]);
        let mut ends = closed(json!({ "lower": end, "upper": end }), &[]);
        ends["minProperties"] = 1.into();
        self.shared("limit", any_of([either_way, ends]))
    }

    /// The forms of a size, with an uncertainty where it may have one.
    fn size(&mut self, mut forms: Vec<Value>, source: Option<Influence>) -> Value {
        if source.is_some() {
            let mut properties = self.uncertainty();
            properties.insert("value".to_owned(), json!({}));
            let uncertain = self.shared("uncertain", closed(properties, &["value"]));
            let value = self.size(forms.clone(), None);
            forms.push(json!({ "allOf": [uncertain, { "properties": { "value": value } }] }));
            let readings = closed(json!({ READINGS: self.readings() }), &[READINGS]);
            forms.push(self.shared("mean_of_readings", readings));
        }
        self.shared("size", any_of(forms))
    }

    fn extent(&mut self, counted: Countable) -> Value {
        self.shared("extent", json!({ "enum": Extent::names(counted) }))
    }

    fn uncertainty(&mut self) -> Map<String, Value> {
        let amount = self.shared("u", any_of([json!({ "type": "number", "minimum": 0 }), text()]));
        let distribution = json!({ "enum": ["normal", "rectangular", "triangular", "arcsine"] });
        let distribution = self.shared("distribution", distribution);
        let schema = |name| match name {
            "k" => above_zero(),
            "dof" => json!({ "type": "number", "minimum": 1 }),
            "distribution" => distribution.clone(),
            _ => amount.clone(),
        };
        UNCERTAINTY_KEYS.into_iter().map(|name| (name.to_owned(), schema(name))).collect()
    }

    /// A spread of an angle or a length, also as a class where there is one.
    fn spread(&mut self, is_angle: bool, has_class: bool) -> Value {
        let amount = if is_angle { text() } else { self.length() };
        let amount = self.size(vec![above_zero(), amount], None);
        let distribution = self.uncertainty()["distribution"].clone();
        let half_width = json!({ "half_width": amount, "distribution": distribution });
        let between = json!({ "value": self.ends(), "distribution": distribution });
        let mut forms = vec![
            amount,
            self.shared("half_width", closed(half_width, &["half_width", "distribution"])),
            self.shared("within", closed(between, &["value"])),
        ];
        if has_class {
            forms.push(self.shared("class", closed(json!({ "class": grade() }), &["class"])));
        }
        self.shared("spread", any_of(forms))
    }

    /// An entry of `[budget]`.
    fn tolerance(&mut self, kind: DeviationKind) -> Value {
        let extent = self.extent(kind.counts());
        let free = |name: &str| closed(json!({ name: above_zero(), EXTENT: extent }), &[name]);
        let free = any_of([json!({ "const": "free" }), free("weight"), free("cost")]);
        any_of([self.shared("free", free), self.error(kind)])
    }

    /// An error: a value, or a table whose keys make one. The table lists its keys once, and then which go together.
    fn error(&mut self, kind: DeviationKind) -> Value {
        let mut beside = self.uncertainty();
        beside.insert(EXTENT.to_owned(), self.extent(kind.counts()));
        if has_circle(kind) {
            beside.insert(MEASURED_AT.to_owned(), any_of([json!({ "type": "number" }), self.length()]));
        }
        let forms = error_table_forms(kind);
        // the last: the uncertainty and extent of values that come from a table
        let every_kind = error_table_forms(DeviationKind::RackPitch);
        let (common, own): (Vec<_>, Vec<_>) =
            forms.iter().copied().chain([&[][..]]).partition(|form| form.is_empty() || every_kind.contains(form));
        let mut combinations = |forms: Vec<&[&'static str]>| -> Vec<Value> {
            forms.into_iter().map(|form| self.combination(form, &beside)).collect()
        };
        let (common, mut combinations) = (combinations(common), combinations(own));
        combinations.push(self.shared("forms", any_of(common)));
        let mut properties = beside;
        for name in forms.iter().copied().flatten().copied().chain([EVERY_PART]) {
            let schema = match name {
                "class" => self.shared("grade", grade()),
                "value" | "f_h_beta" => {
                    let forms = any_of([self.quantity(), self.ends()]);
                    self.shared("amount", forms)
                }
                READINGS => self.readings(),
                EVERY_PART => json!({ "type": "boolean" }),
                _ => self.quantity(),
            };
            properties.insert(name.to_owned(), schema);
        }
        let mut table = closed(properties, &[]);
        table["minProperties"] = 1.into();
        table["allOf"] = json!([any_of(combinations)]);
        let value = if kind == DeviationKind::RackLead { text() } else { self.length() };
        self.shared("error", any_of([json!({ "type": "number" }), value, table]))
    }

    /// Keys that make an error, and what may stand beside them.
    fn combination(&mut self, form: &[&str], beside: &Map<String, Value>) -> Value {
        let own = json!({ "enum": form });
        let of_readings = form.first() == Some(&READINGS);
        let may_stand = |name: &&str| !(of_readings && UNCERTAINTY_KEYS.contains(name));
        let mut others: Vec<&str> = beside.keys().map(String::as_str).filter(may_stand).collect();
        others.extend((!form.is_empty() && is_of_a_part(form)).then_some(EVERY_PART));
        let known = match form {
            ["class"] => own,
            [] => self.shared("beside", json!({ "enum": others })),
            _ => any_of([own, self.shared("beside", json!({ "enum": others }))]),
        };
        json!({ "required": form, "propertyNames": known })
    }
}

/// A table with these keys and no others, some of which it must have.
fn closed(properties: impl Into<Value>, required: &[&str]) -> Value {
    let properties: Value = properties.into();
    let mut schema = json!({ "type": "object", "additionalProperties": false, "properties": properties });
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    schema
}

fn any_of(forms: impl Into<Vec<Value>>) -> Value {
    json!({ "anyOf": forms.into() })
}

fn text() -> Value {
    json!({ "type": "string" })
}

fn above_zero() -> Value {
    json!({ "type": "number", "exclusiveMinimum": 0 })
}

fn grade() -> Value {
    json!({ "type": "integer", "minimum": 0, "maximum": LARGEST_CLASS })
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
