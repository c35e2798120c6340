//! The present contract as lines of a spec.

use super::entry::Entry;
use crate::table::field::Beside;
use crate::table::grid::Separator;
use crate::table::layout::{DeclaredColumn, Layout, PartNames, Parts, Repeats, StatusColumn};
use crate::table::want::quoted;

/// What the contract says of the table as a whole.
pub(super) fn keys(layout: &Layout) -> Vec<String> {
    let parts = layout.parts.map(Parts::word).or(layout.teeth.then_some("teeth"));
    let parts = parts.map(|word| format!("parts = \"{word}\""));
    let separator = layout.separator.and_then(|byte| Separator::Character(byte).word());
    let separator = separator.map(|word| format!("separator = {}", quoted(&word)));
    let encoding = layout.encoding.map(|encoding| format!("encoding = {}", quoted(encoding.name())));
    let sheet = layout.sheet.as_deref().map(|sheet| format!("sheet = {}", quoted(sheet)));
    let range = Some(layout.range.to_string()).filter(|range| !range.is_empty());
    let range = range.map(|range| format!("range = {}", quoted(&range)));
    let starts = (!layout.starts.is_empty()).then(|| format!("starts = {:?}", layout.starts));
    let decimal = layout.decimal.map(|mark| format!("decimal = \"{}\"", mark.word()));
    let units = layout.units.map(|line| format!("units = \"line {line}\""));
    let repeats = match layout.repeats {
        Repeats::Refused => None,
        Repeats::All => Some("repeats = \"all\"".to_owned()),
        Repeats::Last => Some("repeats = \"last\"".to_owned()),
    };
    let others = layout.ignores_others.then(|| "others = \"ignore\"".to_owned());
    [encoding, sheet, range, parts, separator, starts, decimal, units, repeats, others].into_iter().flatten().collect()
}

/// What the contract says of columns, each with its key.
pub(super) fn columns(layout: &Layout) -> Vec<(&'static str, Entry)> {
    let part = layout.part_id.as_ref().map(|names| match names {
        PartNames::Column(name) => Entry::heading(name),
        PartNames::Line(pattern) => Entry::of([("line", quoted(pattern.text()))]),
    });
    let list = |texts: &[String]| format!("[{}]", texts.iter().map(|text| quoted(text)).collect::<Vec<_>>().join(", "));
    let status = layout.status.as_ref().map(|StatusColumn { name, accept, reject }| {
        let texts = [("accept", accept), ("reject", reject)].into_iter().filter(|(_, texts)| !texts.is_empty());
        Entry::of([("name", quoted(name))].into_iter().chain(texts.map(|(key, texts)| (key, list(texts)))))
    });
    let column = |column: &DeclaredColumn| {
        let name = column.name.iter().map(|name| ("name", quoted(name)));
        let unit = column.unit.iter().map(|unit| ("unit", quoted(unit.symbol())));
        let beside = column.beside.iter().map(|(beside, name)| {
            let key = if *beside == Beside::Unit { "units" } else { beside.key() };
            (key, quoted(name))
        });
        let others = column.others.iter().map(|(key, value)| (key.as_str(), value.clone()));
        (column.field.key(), Entry::of(name.chain(unit).chain(beside).chain(others)))
    };
    let of = layout.of_characteristics.iter().map(|(beside, name)| (beside.key(), name));
    let index = layout.index.iter().map(|(index, name)| (index.key(), name));
    let headings = of.chain(index).chain(layout.details.iter().map(|(key, name)| (*key, name)));
    let headings = headings.map(|(key, name)| (key, Entry::heading(name)));
    let named = part.map(|part| ("part_id", part)).into_iter().chain(status.map(|status| ("status", status)));
    named.chain(headings).chain(layout.columns.iter().map(column)).collect()
}
