//! The values of a spec, key by key and each in one unit, for `compare`. Checks nothing, because the spec was read before.

use std::path::Path;

use toml::de::{DeTable, DeValue};

use super::found::Found;
use super::keys::{Kind, MeasureUnit, SECTIONS, Section, TOP};
use super::reader::{decimal_text, in_unit};
use super::{Spec, limits, set, top};
use crate::deviation::{DeviationKind, ToothRange};
use crate::diagnostic::Diagnostics;
use crate::judge::Rule;
use crate::quantity::{Angle, Length, parse_f64, plain};

impl Spec {
    /// The keys with their values, in documented order: lengths in mm, angles in degrees, so that `"10 um"` and `0.01` are one
    /// text. Limits and tolerances are two keys, `….lower` and `….upper`. The name of a table is relative to the folder in which
    /// the program runs, where `path` is the spec.
    ///
    /// # Errors
    /// None for a spec that was parsed.
    pub fn written(&self, path: &Path) -> Result<Vec<(String, String)>, Diagnostics> {
        let text = &self.source.text;
        let (mut found, settings) = (Found::default(), set::settings(&self.settings, text.len()));
        let (table, _) = top(text, &settings, &self.source, &mut found)?;
        let mut written = Written { folder: path.parent().unwrap_or(Path::new("")), values: Vec::new() };
        written.section(&TOP, "", &table);
        for section in SECTIONS {
            if let Some(DeValue::Table(table)) = table.get(section.name).map(toml::Spanned::get_ref) {
                written.section(section, section.name, table);
            }
        }
        Ok(written.values)
    }
}

/// The unit of a key's number.
#[derive(Clone, Copy)]
enum Counted {
    Length,
    Angle,
    In(MeasureUnit),
    Number,
    Limit,
    Teeth,
    Rule,
    File,
    Nothing,
}

impl Counted {
    const fn length_or_angle(is_angle: bool) -> Self {
        if is_angle { Self::Angle } else { Self::Length }
    }

    fn of(kind: Kind) -> Self {
        match kind {
            Kind::Length(_) | Kind::SetAt | Kind::RackDiameter => Self::Length,
            Kind::Angle(_) => Self::Angle,
            Kind::Error(kind) | Kind::Tolerance(kind) => Self::length_or_angle(kind == DeviationKind::RackLead),
            Kind::Spread { is_angle, .. } | Kind::NominalOrHeading { is_angle } => Self::length_or_angle(is_angle),
            Kind::Measure(_, unit) | Kind::MeasureLimit(unit) => Self::In(unit),
            Kind::Number(_) | Kind::Count(_) => Self::Number,
            Kind::Limit => Self::Limit,
            Kind::Teeth => Self::Teeth,
            Kind::Rule => Self::Rule,
            Kind::File => Self::File,
            _ => Self::Nothing,
        }
    }

    /// The unit of a key in the table of a value.
    fn of_part(self, name: &str) -> Self {
        match name {
            "f_h_beta" | "length" | "roller" | "measured_at" => Self::Length,
            "k" | "dof" | "class" | "weight" | "cost" => Self::Number,
            _ => self,
        }
    }

    /// A value in the unit of its kind; other values stay.
    fn text(self, written: String) -> String {
        let read = match self {
            Self::Length | Self::Limit => written.parse().ok().map(|length: Length| length.to_string()),
            Self::Angle => written.parse().ok().map(|angle: Angle| angle.to_string()),
            Self::In(unit) => in_unit(&written, unit).ok().map(|number| plain(number) + unit.after),
            Self::Number => parse_f64(&written).ok().map(plain),
            Self::Teeth => written.parse().ok().map(|teeth: ToothRange| teeth.to_string()),
            Self::Rule => written.parse().ok().map(|rule: Rule| rule.to_string()),
            Self::File | Self::Nothing => None,
        };
        read.unwrap_or(written)
    }
}

/// The values found so far.
struct Written<'a> {
    /// The path of the spec.
    folder: &'a Path,
    values: Vec<(String, String)>,
}

impl Written<'_> {
    fn section(&mut self, section: &Section, path: &str, table: &DeTable<'_>) {
        for key in section.keys {
            let Some(value) = table.get(key.name()).map(toml::Spanned::get_ref) else { continue };
            let path = if path.is_empty() { key.name().to_owned() } else { format!("{path}.{}", key.name()) };
            match (key.kind, value) {
                (Kind::Table(inner) | Kind::Whole(inner), DeValue::Table(table)) => self.section(inner, &path, table),
                (Kind::Tables(inner), DeValue::Array(tables)) => {
                    for (index, table) in tables.iter().enumerate() {
                        let Some(table) = table.get_ref().as_table() else { continue };
                        self.section(inner, &format!("{path}[{}]", index + 1), table);
                    }
                }
                (kind, value) => self.value(Counted::of(kind), path, value),
            }
        }
    }

    fn value(&mut self, counted: Counted, path: String, value: &DeValue<'_>) {
        match (counted, value) {
            (_, DeValue::Table(table)) => {
                for (name, value) in table {
                    let name = name.get_ref().as_ref();
                    let path = if name == "value" { path.clone() } else { format!("{path}.{name}") };
                    self.value(counted.of_part(name), path, value.get_ref());
                }
            }
            (Counted::Limit, DeValue::String(text)) if let Some(magnitude) = limits::magnitude(text) => {
                self.values.push((format!("{path}.lower"), counted.text(format!("-{magnitude}"))));
                self.values.push((format!("{path}.upper"), counted.text(magnitude.to_owned())));
            }
            (Counted::File, DeValue::String(text)) => {
                self.values.push((path, self.folder.join(text.as_ref()).display().to_string()));
            }
            _ => self.values.push((path, text(counted, value))),
        }
    }
}

/// A value as text.
fn text(counted: Counted, value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => counted.text(text.to_string()),
        DeValue::Array(values) => {
            let texts: Vec<_> = values.iter().map(|value| text(counted, value.get_ref())).collect();
            format!("[{}]", texts.join(", "))
        }
        DeValue::Boolean(is) => is.to_string(),
        DeValue::Datetime(date) => date.to_string(),
        DeValue::Table(table) => {
            let texts =
                table.iter().map(|(name, value)| format!("{} = {}", name.get_ref(), text(counted, value.get_ref())));
            format!("{{ {} }}", texts.collect::<Vec<_>>().join(", "))
        }
        number => decimal_text(number).map_or_else(String::new, |number| counted.text(number)),
    }
}
