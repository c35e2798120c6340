//! `[table]`: the contract of tables with values of parts. Fills what `[batch]` does, and the layout that the reader obeys.

use std::sync::Arc;

use toml::Spanned;
use toml::de::DeValue;

use super::batch::{BatchColumn, BatchSection, nominal};
use super::errors::{has_circle, of_each, read_extent_value};
use super::keys::{self, BESIDE, Section};
use super::reader::SectionReader;
use super::{Located, Spec};
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic};
use crate::table::{DecimalMark, DeclaredColumn, Layout, LineRule, Parts, Pattern};

/// Reads `[table]`, if it is there.
pub(super) fn read(sections: &mut SectionReader<'_>, spec: &mut Spec) {
    let (table, batch) = (sections.table.get(keys::TABLE.name), sections.table.get(keys::BATCH.name));
    let (Some(table), Some(inner)) = (table, sections.entry(keys::TABLE.name)) else { return };
    if batch.is_some() {
        let problem = Diagnostic::error(Code::BadErrorEntry, "[table] takes the place of [batch], and both are there");
        sections.report(problem.help("move what [batch] says into [table]"), table.span());
    }
    sections.inner(&keys::TABLE, inner, |reader| spec.batch = section(reader));
}

fn section(reader: &mut SectionReader<'_>) -> BatchSection {
    let mut declared = Vec::new();
    let columns = reader.table("columns", &keys::TABLE_COLUMNS, |reader| {
        let part_id = reader.get(keys::PART_ID).map(|id| id.value);
        let columns = of_each(|kind| column(reader, kind, &mut declared));
        BatchSection { part_id, columns, ..BatchSection::default() }
    });
    let columns = columns.map(|columns| columns.value).unwrap_or_default();
    let decimal = reader.get(keys::TABLE_DECIMAL).map(|mark| match mark.value {
        "comma" => DecimalMark::Comma,
        _ => DecimalMark::Point,
    });
    let parts = reader.get(keys::TABLE_PARTS).map(|parts| match parts.value {
        "columns" => Parts::Columns,
        _ => Parts::Rows,
    });
    let patterns = |texts: Vec<Located<String>>| texts.iter().map(|text| Pattern::of_heading(&text.value)).collect();
    let layout = Layout {
        parts,
        separator: separator(reader),
        decimal,
        part_id: columns.part_id.clone(),
        columns: declared,
        ignore: patterns(reader.texts("ignore")),
        ignore_lines: line_rules(reader),
        comments: patterns(reader.texts("comments")),
        ignores_others: reader.get(keys::TABLE_OTHERS).is_some(),
        may_repeat: reader.get(keys::TABLE_REPEATS).is_some(),
    };
    BatchSection { decimal, layout: Some(Arc::new(layout)), ..columns }
}

fn separator(reader: &mut SectionReader<'_>) -> Option<u8> {
    let written = reader.get(keys::TABLE_SEPARATOR)?;
    match written.value.as_bytes() {
        b"tab" => Some(b'\t'),
        [byte] if byte.is_ascii() && !byte.is_ascii_alphanumeric() && !matches!(byte, b'"' | b'.' | b'-') => {
            Some(*byte)
        }
        _ => {
            let problem =
                Diagnostic::error(Code::WrongType, "`separator` must be one character such as \";\", or \"tab\"");
            reader.refuse(problem, written.span)
        }
    }
}

/// The patterns for lines.
fn line_rules(reader: &mut SectionReader<'_>) -> Vec<LineRule> {
    const NAME: &str = "ignore_lines";
    let Some(value) = reader.table.get(NAME) else { return Vec::new() };
    let DeValue::Array(list) = value.get_ref() else {
        reader.wrong_type::<()>(NAME, value, "a list such as [\"Datum: #\", { like = \"Max;*\", at_most = 1 }]");
        return Vec::new();
    };
    list.iter().filter_map(|entry| line_rule(reader, entry)).collect()
}

fn line_rule(reader: &mut SectionReader<'_>, entry: &Spanned<DeValue<'_>>) -> Option<LineRule> {
    let needed = "text in quotes, or { like = \"…\", at_most = 1 },";
    let DeValue::Table(table) = entry.get_ref() else {
        let text = reader.text_value("ignore_lines", entry, needed)?;
        return Some(LineRule { pattern: Pattern::of_line(text), at_most: 0 });
    };
    reader.knows_keys("ignore_lines", table, &["like", "at_most"].into_iter(), "its keys are like and at_most")?;
    let Some(like) = table.get("like") else { return reader.wrong_type("ignore_lines", entry, needed) };
    let pattern = Pattern::of_line(reader.text_value("like", like, needed)?);
    let Some(most) = table.get("at_most") else { return Some(LineRule { pattern, at_most: 0 }) };
    let count = if let DeValue::Integer(count) = most.get_ref() { count.as_str().parse().ok() } else { None };
    let Some(at_most) = count else { return reader.wrong_type("at_most", most, "a whole number") };
    Some(LineRule { pattern, at_most })
}

fn column(
    reader: &mut SectionReader<'_>,
    kind: DeviationKind,
    declared: &mut Vec<DeclaredColumn>,
) -> Option<Located<BatchColumn>> {
    let section = section_of(kind)?;
    reader.table(kind.key(), section, |reader| {
        let name = reader.get(keys::COLUMN_NAME).map(|name| name.value);
        let nominal_heading = heading_of_nominal(reader);
        let mut beside: Vec<(&'static str, String)> =
            nominal_heading.iter().map(|name| ("nominal", name.clone())).collect();
        for key in BESIDE {
            let Some(value) = reader.table.get(key) else { continue };
            beside.extend(reader.text_value(key, value, "a heading in quotes").map(|name| (key, name.to_owned())));
        }
        declared.push(DeclaredColumn::new(kind, name.clone(), beside));
        let is_lead = kind == DeviationKind::RackLead;
        BatchColumn {
            name,
            unit: reader.column_unit("unit", is_lead),
            length: if is_lead { reader.get(keys::EVALUATION_LENGTH) } else { None },
            nominal: if nominal_heading.is_some() { None } else { nominal(reader, kind) },
            kind: reader.get(keys::COLUMN_KIND),
            extent: reader.table.get(keys::EXTENT).and_then(|value| read_extent_value(reader, kind, value)),
            measured_at: if has_circle(kind) { reader.get(keys::COLUMN_MEASURED_AT) } else { None },
        }
    })
}

/// The section of a column, as `[table.columns]` has it.
fn section_of(kind: DeviationKind) -> Option<&'static Section> {
    let key = keys::TABLE_COLUMNS.keys.iter().find(|key| key.name() == kind.key())?;
    if let keys::Kind::Table(section) = key.kind { Some(section) } else { None }
}

/// The heading of a column of nominal values: a text that is no quantity.
fn heading_of_nominal(reader: &SectionReader<'_>) -> Option<String> {
    let DeValue::String(text) = reader.table.get("nominal")?.get_ref() else { return None };
    (!text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.'))).then(|| text.to_string())
}
