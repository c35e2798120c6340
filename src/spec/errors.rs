//! `[errors]` as written: each entry is a deviation, or the values from which it follows. [`Spec::parse`](super::Spec::parse)
//! and the reader of `[budget]` call it; it computes no ΔCD and needs no gear data.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::keys::{self, READINGS};
use super::reader::{SectionReader, TEXT};
use super::{Located, Spec};
use crate::deviation::plausible::{self, WrittenIn};
use crate::deviation::{DeviationKind, DeviationValue, Extent};
use crate::diagnostic::{Code, Diagnostic};
use crate::formula::law::lead_slope;
use crate::formula::{PartDeviation, ToleranceEnds};
use crate::quantity::{DomainError, Length};
use crate::uncertainty::Influence;

/// An entry of `[errors]`, as far as it can be understood without the gear data.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum WrittenError {
    /// A deviation, given or measured minus nominal, or f_Hβ over its length.
    Value(DeviationValue),
    /// An over-roller measure whose nominal is to be computed.
    OverRoller {
        /// The measure M.
        measured: Length,
        /// The roller's diameter.
        roller: Length,
    },
    /// A tolerance with two ends.
    Tolerance(ToleranceEnds),
    /// A grade of the standard in `[tolerance]`.
    Class(u8),
}

impl WrittenError {
    /// Whether the entry is a permissible deviation, not the value of a part.
    pub(super) const fn is_permitted(&self) -> bool {
        matches!(self, Self::Tolerance(_) | Self::Class(_))
    }
}

impl From<DeviationValue> for WrittenError {
    fn from(value: DeviationValue) -> Self {
        Self::Value(value)
    }
}

impl From<&PartDeviation> for WrittenError {
    fn from(error: &PartDeviation) -> Self {
        if error.is_tolerance() { Self::Tolerance(error.tolerance()) } else { Self::Value(error.value()) }
    }
}

/// The entries that are found, by kind of error.
pub(super) fn of_each<T>(mut read: impl FnMut(DeviationKind) -> Option<T>) -> Vec<(DeviationKind, T)> {
    DeviationKind::ALL.into_iter().filter_map(|kind| Some((kind, read(kind)?))).collect()
}

/// Reads `[errors]`. Nominal values and uncertainties without a value come first: draws follow the order in which
/// uncertainties are found.
pub(super) fn read(reader: &mut SectionReader<'_>, spec: &mut Spec) {
    let alone = |kind: &DeviationKind| match reader.entry(kind.key()) {
        Some(entry) if stands_alone(*kind, entry, Some("nominal")) => 0,
        Some(entry) if stands_alone(*kind, entry, None) => 1,
        _ => 2,
    };
    let mut kinds = DeviationKind::ALL;
    kinds.sort_by_key(alone);
    for kind in kinds {
        read_entry(reader, kind, spec);
    }
    spec.extents = of_each(|kind| read_extent(reader, kind));
    let has_readings =
        |kind: &DeviationKind| reader.entry(kind.key()).is_some_and(|entry| entry.contains_key(READINGS));
    spec.of_readings = DeviationKind::ALL.into_iter().filter(has_readings).collect();
}

/// Whether an entry has only this key, or none, besides keys that make no value.
fn stands_alone(kind: DeviationKind, entry: &DeTable<'_>, key: Option<&str>) -> bool {
    let own = |name: &str| Some(name) == key;
    key.is_none_or(|key| entry.contains_key(key))
        && !entry.is_empty()
        && entry.keys().all(|name| own(name.get_ref()) || is_beside(kind, name.get_ref()))
}

/// Reads the entry of an error, if there is one.
fn read_entry(reader: &mut SectionReader<'_>, kind: DeviationKind, spec: &mut Spec) -> Option<()> {
    let value = reader.table.get(kind.key())?;
    let span = value.span();
    if let Some(entry) = reader.entry(kind.key()) {
        if let Some(circle) = entry.get(keys::MEASURED_AT).filter(|_| has_circle(kind)) {
            let diameter = reader.length_value(keys::MEASURED_AT, circle)?;
            reader.in_domain(crate::formula::domain::MEASUREMENT_CIRCLE.check_length(diameter), circle.span())?;
            spec.measured_at = Some(Located { value: diameter, span: circle.span() });
        }
        if stands_alone(kind, entry, None) {
            reader.note_uncertainty(kind.key(), entry, span.clone(), Influence::Error(kind), None);
            spec.unmeasured.push((kind, span));
            return None;
        }
        match entry.get(keys::EVERY_PART).map(|value| (value, value.get_ref())) {
            Some((_, DeValue::Boolean(every_part))) => spec.every_part.extend(every_part.then_some(kind)),
            Some((value, _)) => reader.wrong_type(keys::EVERY_PART, value, "true or false").unwrap_or_default(),
            None => {}
        }
    }
    let Entry { value, nominal, evaluation_length } = read_error_value(reader, kind, value)?;
    spec.errors.extend(value.map(|value| (kind, Located { value, span })));
    spec.nominals.extend(nominal.map(|nominal| (kind, nominal)));
    spec.evaluation_length = spec.evaluation_length.or(evaluation_length);
    Some(())
}

/// On which teeth an error is, if the entry says so.
pub(super) fn read_extent(reader: &mut SectionReader<'_>, kind: DeviationKind) -> Option<Located<Extent>> {
    let value = reader.entry(kind.key())?.get(keys::EXTENT)?;
    read_extent_value(reader, kind, value)
}

/// Reads an extent that an error of this kind can have.
pub(super) fn read_extent_value(
    reader: &mut SectionReader<'_>,
    kind: DeviationKind,
    value: &Spanned<DeValue<'_>>,
) -> Option<Located<Extent>> {
    let text = reader.text_value(keys::EXTENT, value, TEXT)?;
    let refusal = match text.parse::<Extent>() {
        Ok(extent) if extent.fits(kind.counts()) => return Some(Located { value: extent, span: value.span() }),
        Ok(_) => Extent::NO_TOTAL.to_owned(),
        Err(unknown) => unknown.to_string(),
    };
    let message = format!("`{}.{}`: {refusal}", kind.key(), keys::EXTENT);
    reader.refuse(Diagnostic::error(Code::BadErrorEntry, message), value.span())
}

/// Whether a key of an entry goes with a value and makes none: keys of an uncertainty, the extent, the circle of a pitch.
fn is_beside(kind: DeviationKind, key: &str) -> bool {
    key == keys::EXTENT || keys::UNCERTAINTY_KEYS.contains(&key) || has_circle(kind) && key == keys::MEASURED_AT
}

/// Whether the circle on which an error was measured can be given.
pub(super) fn has_circle(kind: DeviationKind) -> bool {
    kind == DeviationKind::PinionPitch
}

/// The content of an error's entry.
#[derive(Default)]
pub(super) struct Entry {
    /// The error; `None` beside a nominal value alone.
    pub(super) value: Option<WrittenError>,
    nominal: Option<Located<DeviationValue>>,
    /// The evaluation length of f_Hβ.
    evaluation_length: Option<Length>,
}

impl Entry {
    fn of(value: WrittenError) -> Self {
        Self { value: Some(value), ..Self::default() }
    }
}

/// Reads the value of an error: a deviation, or a table from which it follows.
pub(super) fn read_error_value(
    reader: &mut SectionReader<'_>,
    kind: DeviationKind,
    value: &Spanned<DeValue<'_>>,
) -> Option<Entry> {
    let entry = match value.get_ref() {
        DeValue::Table(entry) => read_error_table(reader, kind, entry, value.span())?,
        _ => Entry::of(WrittenError::Value(value_of(reader, kind, kind.key(), value)?)),
    };
    let farthest = match entry.value {
        Some(WrittenError::Value(value)) => Some(value),
        Some(WrittenError::Tolerance(ends)) => Some(ends.farther),
        _ => None,
    };
    if let Some(DeviationValue::Angle(angle)) = farthest {
        reader.in_domain(crate::formula::domain::LEAD_ERROR.check_angle(angle), value.span())?;
    }
    Some(entry)
}

/// A value of an error of this kind, measured, nominal, or their difference.
fn value_of(
    reader: &mut SectionReader<'_>,
    kind: DeviationKind,
    name: &str,
    value: &Spanned<DeValue<'_>>,
) -> Option<DeviationValue> {
    match kind {
        DeviationKind::RackLead => reader.angle_value(name, value).map(DeviationValue::Angle),
        _ => reader.length_value(name, value).map(DeviationValue::Length),
    }
}

/// A value of an error under a key of its entry, or the two ends of its tolerance; `read` reads each of them.
fn value_or_ends<'t>(
    reader: &mut SectionReader<'_>,
    (kind, entry): (DeviationKind, &DeTable<'_>),
    name: &str,
    value: &Spanned<DeValue<'t>>,
    read: impl Fn(&mut SectionReader<'_>, &str, &Spanned<DeValue<'t>>) -> Option<DeviationValue>,
) -> Option<WrittenError> {
    let DeValue::Table(ends) = value.get_ref() else {
        return read(reader, name, value).map(WrittenError::Value);
    };
    let help = format!(
        "write {{ {name} = {{ lower = \"-1 um\", upper = \"5 um\" }} }}, with an extent beside the value if need be"
    );
    reader.knows_keys(name, ends, &["lower", "upper"].into_iter(), &help)?;
    let mut end = |name: &str| read(reader, name, ends.get(name)?);
    let (lower, upper) = (end("lower"), end("upper"));
    let total = entry.get(keys::EXTENT).and_then(|extent| extent.get_ref().as_str()) == Some(Extent::Total.name());
    let problem = match (lower, upper) {
        _ if ends.len() < 2 => "a tolerance has a `lower` and an `upper` end",
        (Some(lower), Some(upper)) if lower.base() > upper.base() => "the lower end is above the upper one",
        _ if keys::UNCERTAINTY_KEYS.iter().any(|key| entry.contains_key(*key)) => {
            "what is permitted has no measuring uncertainty"
        }
        _ if total => "a total cumulative deviation has no sign, so that it has one value",
        (lower, upper) => return Some(WrittenError::Tolerance(ToleranceEnds::from_to(lower?, upper?))),
    };
    let message = format!("`{}`: {problem}", kind.key());
    reader.refuse(Diagnostic::error(Code::BadErrorEntry, message).help(help), value.span())
}

/// The keys that the table form of an error may have, in the combinations that make an error.
pub(super) fn error_table_forms(kind: DeviationKind) -> &'static [&'static [&'static str]] {
    match kind {
        DeviationKind::RackOverRoller => &[
            &["value"],
            &["measured", "nominal"],
            &["measured", "roller"],
            &["nominal"],
            &["class"],
            &[READINGS],
            &[READINGS, "nominal"],
            &[READINGS, "roller"],
        ],
        DeviationKind::RackLead => &[
            &["value"],
            &["measured", "nominal"],
            &["f_h_beta", "length"],
            &["nominal"],
            &["class"],
            &[READINGS],
            &[READINGS, "nominal"],
            &[READINGS, "length"],
        ],
        _ => &[&["value"], &["measured", "nominal"], &["nominal"], &["class"], &[READINGS], &[READINGS, "nominal"]],
    }
}

/// Whether a table form of an error is a value of a part: no class, which is a tolerance, and no nominal value alone.
pub(super) fn is_of_a_part(form: &[&str]) -> bool {
    form != ["class"] && form != ["nominal"]
}

/// The form of an entry with these keys, if they make one.
fn error_form(
    reader: &mut SectionReader<'_>,
    kind: DeviationKind,
    entry: &DeTable<'_>,
    span: Range<usize>,
) -> Option<&'static [&'static str]> {
    let forms = error_table_forms(kind);
    let circle = has_circle(kind).then_some(keys::MEASURED_AT);
    let beside = keys::UNCERTAINTY_KEYS.into_iter().chain([keys::EVERY_PART, keys::EXTENT]).chain(circle);
    let known = forms.iter().flat_map(|form| form.iter().copied()).chain(beside);
    reader.knows_keys(kind.key(), entry, &known, &format!("write {}", forms_in_words(forms)))?;
    let uncertain = keys::UNCERTAINTY_KEYS.iter().filter(|key| entry.contains_key(**key)).count();
    let every_part = entry.contains_key(keys::EVERY_PART);
    let is_circle_given = has_circle(kind) && entry.contains_key(keys::MEASURED_AT);
    let beside = uncertain
        + usize::from(every_part)
        + usize::from(entry.contains_key(keys::EXTENT))
        + usize::from(is_circle_given);
    let bad = |message: String, help: &str| Diagnostic::error(Code::BadErrorEntry, message).help(help);
    let makes = |form: &&&[&str]| form.len() + beside == entry.len() && form.iter().all(|k| entry.contains_key(*k));
    let Some(form) = forms.iter().find(makes) else {
        let message = format!("`{}` is a table that makes no error", kind.key());
        return reader.refuse(bad(message, &format!("write {}", forms_in_words(forms))), span);
    };
    if every_part && !is_of_a_part(form) {
        let message = format!("`{}` has no value that `every_part` could be of", kind.key());
        return reader.refuse(bad(message, "it goes with a value: { value = …, every_part = true }"), span);
    }
    if *form == ["class"] && is_circle_given {
        let message = format!("`{}` is a class: what is permitted is that of the reference circle", kind.key());
        return reader.refuse(bad(message, "leave `measured_at` out, or give the largest deviation as `value`"), span);
    }
    if *form == ["class"] && entry.contains_key(keys::EXTENT) {
        let message = format!("`{}` is a class: what is permitted is that of each tooth", kind.key());
        return reader.refuse(bad(message, "leave `extent` out, or give the largest deviation as `value`"), span);
    }
    Some(form)
}

fn read_error_table(
    reader: &mut SectionReader<'_>,
    kind: DeviationKind,
    entry: &DeTable<'_>,
    span: Range<usize>,
) -> Option<Entry> {
    let form = error_form(reader, kind, entry, span.clone())?;
    let noted = Influence::Error(kind);
    if form == ["class"] {
        if keys::UNCERTAINTY_KEYS.iter().any(|key| entry.contains_key(*key)) {
            let message = format!("`{}` is a class: what is permitted has no measuring uncertainty", kind.key());
            return reader.refuse(Diagnostic::error(Code::BadUncertainty, message), span);
        }
        return entry.get("class").and_then(|value| reader.class_value(value)).map(WrittenError::Class).map(Entry::of);
    }
    let readings = match entry.get(READINGS) {
        Some(values) => {
            let is_angle = kind == DeviationKind::RackLead && !form.contains(&"length");
            Some(reader.readings(kind.key(), entry, values, is_angle)?)
        }
        None => None,
    };
    // the mean of readings stands for what is measured
    let get = |name: &str| {
        let mean = readings.as_ref().map(|readings| &readings.mean);
        entry.get(name).or_else(|| mean.filter(|_| ["value", "measured", "f_h_beta"].contains(&name)))
    };
    let note = |reader: &mut SectionReader<'_>, span: Range<usize>, degrees_per_mm: Option<f64>| match &readings {
        Some(readings) => reader.note_readings(readings, noted, degrees_per_mm),
        None => reader.note_uncertainty(kind.key(), entry, span, noted, degrees_per_mm).unwrap_or_default(),
    };
    let is_tolerance = form == ["value"] && entry.get("value").is_some_and(|value| value.get_ref().is_table());
    if !form.contains(&"length") && !is_tolerance {
        // with a nominal value alone, the uncertainty is that of the measured values to come
        let place = entry.get("nominal").filter(|_| form == ["nominal"]).map_or(span.clone(), Spanned::span);
        note(reader, place, None);
    }
    let mut length = |name: &str| reader.length_value(name, get(name)?);
    match form {
        [_, "length"] => {
            let (slope, over) = (get("f_h_beta")?, length("length")?);
            if let Some(doubt) = plausible::evaluation_length(over) {
                let diagnostic = Diagnostic::error(Code::Implausible, format!("`length` of {}: {doubt}", kind.key()));
                return reader.refuse(diagnostic.help(doubt.remedy(WrittenIn::Spec)), span);
            }
            let read = |reader: &mut SectionReader<'_>, name: &str, value: &Spanned<DeValue<'_>>| {
                let tangent = lead_slope(reader.length_value(name, value)?, over);
                let refused = |error: DomainError| Diagnostic::error(Code::OutOfDomain, error.to_string());
                tangent.map_err(|error| reader.report(refused(error), span.clone())).ok()
            };
            let written = value_or_ends(reader, (kind, entry), "f_h_beta", slope, read)?;
            if let WrittenError::Value(DeviationValue::Slope(tangent)) = written {
                // d(atan(f/L))/df = L/(L² + f²) = 1/(L (1 + (f/L)²))
                let degrees_per_mm = (1.0 / (over.mm() * (1.0 + tangent * tangent))).to_degrees();
                note(reader, span, Some(degrees_per_mm));
            }
            Some(Entry { evaluation_length: Some(over), ..Entry::of(written) })
        }
        [_, "roller"] => {
            let measured = length("measured");
            let roller = entry.get("roller")?;
            let roller = reader.uncertain("roller", roller, Some(Influence::Roller))?;
            let roller = reader.length_value("roller", &roller)?;
            let roller_span = entry.get("roller").map_or(span, Spanned::span);
            reader.in_domain(crate::formula::domain::PIN_DIAMETER.check_length(roller), roller_span)?;
            Some(Entry::of(WrittenError::OverRoller { measured: measured?, roller }))
        }
        ["value" | READINGS] => {
            let read = |reader: &mut SectionReader<'_>, name: &str, value: &Spanned<DeValue<'_>>| {
                value_of(reader, kind, name, value)
            };
            value_or_ends(reader, (kind, entry), "value", get("value")?, read).map(Entry::of)
        }
        _ => {
            let mut value = |name: &str| value_of(reader, kind, name, get(name)?);
            let (measured, nominal) = (value("measured"), value("nominal")?);
            let value = measured.map(|measured| WrittenError::Value(measured.less(nominal)));
            let nominal = entry.get("nominal").map(|written| Located { value: nominal, span: written.span() });
            Some(Entry { value, nominal, ..Entry::default() })
        }
    }
}

fn forms_in_words(forms: &[&[&str]]) -> String {
    let table = |form: &&[&str]| {
        let keys: Vec<_> = form.iter().map(|name| format!("{name} = …")).collect();
        format!("{{ {} }}", keys.join(", "))
    };
    // a nominal value alone serves tables of measured values, and is no error by itself
    let tables: Vec<_> = forms.iter().filter(|form| ***form != ["nominal"]).map(table).collect();
    format!("a deviation, or {}", tables.join(" or "))
}

#[cfg(test)]
mod tests;
