//! `[limits]` as written. Called by [`Spec::parse`](super::Spec::parse); judges nothing.

use toml::de::DeValue;

use super::Located;
use super::reader::{self, SectionReader};
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic};
use crate::judge::{Limit, LimitTarget};
use crate::quantity::Length;

/// Reads `[limits]`: of the combined ΔCD, and of the errors.
pub(super) fn read(reader: &mut SectionReader<'_>) -> Vec<(LimitTarget, Located<Limit>)> {
    let targets = DeviationKind::ALL.into_iter().map(LimitTarget::Error);
    std::iter::once(LimitTarget::CenterDistance)
        .chain(targets)
        .filter_map(|target| Some((target, read_limit(reader, target.key())?)))
        .collect()
}

/// The value behind the sign `±` of a symmetric limit.
pub(super) fn magnitude(text: &str) -> Option<&str> {
    ["±", "+-", "+/-"].iter().find_map(|sign| text.trim().strip_prefix(sign)).map(str::trim)
}

/// Reads one entry of `[limits]`: `"±0.05"`, or a table with `lower`, `upper` or both.
pub(super) fn read_limit(reader: &mut SectionReader<'_>, name: &'static str) -> Option<Located<Limit>> {
    let value = reader.table.get(name)?;
    let help = "write \"±0.05\", or { lower = -0.05, upper = 0.05 }";
    let limit = match value.get_ref() {
        DeValue::String(text) => match magnitude(text).map(str::parse::<Length>) {
            None => Err(format!("`{name}` is \"{text}\", which is not a limit")),
            Some(Ok(magnitude)) if !magnitude.is_negative() => Ok(Limit::symmetric(magnitude)),
            Some(Ok(_)) => Err(format!("`{name}` has two signs")),
            Some(Err(error)) => Err(format!("`{name}`: {error}")),
        },
        DeValue::Table(ends) => {
            reader.knows_keys(name, ends, &["lower", "upper"].into_iter(), help)?;
            let mut end = |name: &str| match ends.get(name) {
                Some(value) => reader.length_value(name, value).map(Some),
                None => Some(None),
            };
            let (lower, upper) = (end("lower"), end("upper"));
            match (lower?, upper?) {
                (None, None) => Err(format!("`{name}` limits nothing")),
                (Some(lower), Some(upper)) if lower > upper => {
                    Err(format!("the lower limit {lower} is above the upper limit {upper}"))
                }
                (lower, upper) => Ok(Limit { lower, upper }),
            }
        }
        other => Err(format!("`{name}` is {}; a limit has two ends", reader::type_in_words(other))),
    };
    match limit {
        Ok(limit) => Some(Located { value: limit, span: value.span() }),
        Err(message) => reader.refuse(Diagnostic::error(Code::BadLimit, message).help(help), value.span()),
    }
}
