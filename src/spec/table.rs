//! `[table]`: the contract of tables with values of parts, as the layout for the reader of tables.

use std::fmt;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::batch::{BatchColumn, TableSection, nominal};
use super::errors::{has_circle, of_each, read_extent_value};
use super::found::Found;
use super::keys::{self, BESIDE, Key, Section};
use super::reader::SectionReader;
use super::{Located, Spec, syntax_error};
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Source};
use crate::quantity::{Unit, shown};
use crate::table::DETAILS;
use crate::table::{
    DecimalMark, DeclaredColumn, Encoding, Field, IsCurve, Layout, LineRule, MOST_RULES, PartNames, Parts, Pattern,
    Repeats, Separator, StatusColumn, quoted,
};

/// Renames `[batch]`, the old name, to `[table]`; returns whether the spec has the old name.
pub(super) fn renamed(top: &mut DeTable<'_>, source: &Arc<Source>, found: &mut Found) -> bool {
    const OLD: &str = "batch";
    let Some(span) = top.keys().find(|key| key.get_ref().as_ref() == OLD).map(Spanned::span) else { return false };
    if top.contains_key(keys::TABLE.name) {
        let problem = Diagnostic::error(Code::BadErrorEntry, "[batch] is an old name of [table], and both are there");
        found.add(|| problem.help("move what [batch] says into [table]").at(source, span, ""));
        top.remove(OLD);
        return false;
    }
    if let Some(value) = top.remove(OLD) {
        top.insert(Spanned::new(span, keys::TABLE.name.into()), value);
    }
    true
}

/// Reads `[table]`, if it is there.
pub(super) fn read(sections: &mut SectionReader<'_>, spec: &mut Spec) {
    let (Some(table), Some(inner)) = (sections.table.get(keys::TABLE.name), sections.entry(keys::TABLE.name)) else {
        return;
    };
    let place = Some(table.span());
    sections.inner(&keys::TABLE, inner, |reader| spec.table = TableSection { place, ..section(reader) });
}

/// Reads a file that holds only `[table]`, for any number of specs.
///
/// # Errors
/// Every problem found in the text.
pub(super) fn file(name: &str, text: &str) -> Result<TableSection, Diagnostics> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let source = Arc::new(Source::new(name, text));
    let (top, errors) = DeTable::parse_recoverable(text);
    if let Some(error) = errors.first() {
        return Err(syntax_error(&source, error).into());
    }
    let (mut found, mut uncertainties) = (Found::default(), Vec::new());
    let top = top.into_inner();
    let mut reader = SectionReader {
        source: &source,
        section: &keys::TOP,
        table: &top,
        diagnostics: &mut found,
        uncertainties: &mut uncertainties,
    };
    for (key, _) in top.iter().filter(|(key, _)| key.get_ref().as_ref() != keys::TABLE.name) {
        let message = format!("a layout holds [table] and nothing else: here is `{}`", shown(key.get_ref()));
        reader.report(Diagnostic::error(Code::UnknownKey, message), key.span());
    }
    let mut table = None;
    match reader.entry(keys::TABLE.name) {
        Some(inner) => reader.inner(&keys::TABLE, inner, |reader| table = Some(section(reader))),
        None => reader.report(Diagnostic::error(Code::MissingKey, "a layout holds [table], and here is none"), 0..0),
    }
    match table {
        Some(table) if found.is_empty() => Ok(TableSection { source: Some(Arc::clone(&source)), ..table }),
        _ => Err(Diagnostics(found.sorted(|diagnostic| diagnostic.place.as_ref().map(|place| place.span.start)))),
    }
}

fn section(reader: &mut SectionReader<'_>) -> TableSection {
    let (mut declared, mut part_id, mut status) = (Vec::new(), None, None);
    let (mut headings, mut of_teeth, mut details) = (Vec::new(), Vec::new(), Vec::new());
    let columns = reader.table("columns", &keys::TABLE_COLUMNS, |reader| {
        part_id = part_names(reader);
        status = status_column(reader);
        for key in keys::HEADINGS {
            let text = reader.table.get(key).and_then(|value| reader.text_value(key, value, "a heading in quotes"));
            headings.extend(text.map(|text| (key, text.to_owned())));
        }
        for key in DETAILS {
            let text = reader.table.get(key).and_then(|value| reader.text_value(key, value, "a heading in quotes"));
            details.extend(text.map(|text| (key, text.to_owned())));
        }
        of_teeth.extend(
            Field::ALL.into_iter().filter(|field| field.is_of_space_or_tooth() || field.is_of_trace()).filter_map(
                |field| {
                    let section = if field.is_of_trace() { &keys::TABLE_TRACE } else { &keys::TABLE_TOOTH };
                    reader.table(field.key(), section, |reader| tooth_column(reader, field)).map(|column| column.value)
                },
            ),
        );
        of_each(|kind| column(reader, kind, &mut declared))
    });
    let columns = columns.map(|columns| columns.value).unwrap_or_default();
    let decimal = reader.get(keys::TABLE_DECIMAL).map(|mark| match mark.value {
        "comma" => DecimalMark::Comma,
        _ => DecimalMark::Point,
    });
    let parts = reader.get(keys::TABLE_PARTS).map(|parts| match parts.value {
        "columns" => Some(Parts::Columns),
        "characteristics" => Some(Parts::Characteristics),
        "spaces" | "teeth" => None,
        _ => Some(Parts::Rows),
    });
    // a space or tooth is a row or a column
    let teeth = parts == Some(None);
    let repeats = reader.get(keys::TABLE_REPEATS).map(|repeats| match repeats.value {
        "last" => Repeats::Last,
        _ => Repeats::All,
    });
    let patterns = |texts: Vec<Located<String>>| texts.iter().map(|text| Pattern::of_heading(&text.value)).collect();
    let few = ["ignore", "ignore_lines", "comments"].map(|list| has_few(reader, list));
    let [ignore, lines, comments] = few;
    let mut layout = Layout {
        is_written: true,
        parts: parts.flatten(),
        teeth,
        curve: IsCurve::No,
        encoding: parsed(reader, keys::TABLE_ENCODING, Encoding::named),
        sheet: reader.get(keys::TABLE_SHEET).map(|sheet| sheet.value),
        range: parsed(reader, keys::TABLE_RANGE, str::parse).unwrap_or_default(),
        index: None,
        separator: parsed(reader, keys::TABLE_SEPARATOR, Separator::byte_of),
        starts: starts(reader),
        decimal,
        headings: Vec::new(),
        units: parsed(reader, keys::TABLE_UNITS, line_of_units),
        part_id,
        columns: declared.into_iter().chain(of_teeth).collect(),
        status,
        of_characteristics: Vec::new(),
        of_format: Vec::new(),
        ignore: if ignore { patterns(reader.texts("ignore")) } else { Vec::new() },
        ignore_lines: if lines { line_rules(reader) } else { Vec::new() },
        comments: if comments { patterns(reader.texts("comments")) } else { Vec::new() },
        ignores_others: reader.get(keys::TABLE_OTHERS).is_some(),
        repeats: repeats.unwrap_or_default(),
        later: Arc::default(),
        details: Vec::new(),
    };
    for (key, heading) in headings {
        layout.call(key, heading);
    }
    layout.ignore.extend(details.iter().map(|(_, heading)| Pattern::of_heading(heading)));
    layout.details = details;
    TableSection { columns, layout: Arc::new(layout), ..TableSection::default() }
}

/// Whether a list of rules is no longer than a person writes and reads; a problem if it is.
fn has_few(reader: &mut SectionReader<'_>, list: &'static str) -> bool {
    let Some(value) = reader.table.get(list) else { return true };
    let count = value.get_ref().as_array().map_or(0, |rules| rules.len());
    if count > MOST_RULES {
        let message = format!("`{list}` has {count} rules, and {MOST_RULES} at most are read");
        let help = "write one for all that is alike: \"Temp*\" for headings, \"Datum: #\" or \"Mittelwert;*\" for lines, others = \"ignore\" \
                    for every further column";
        reader.report(Diagnostic::error(Code::WrongType, message).help(help), value.span());
    }
    count <= MOST_RULES
}

/// Where the names of parts stand.
fn part_names(reader: &mut SectionReader<'_>) -> Option<PartNames> {
    const NAME: &str = "part_id";
    let needed = "a heading in quotes, or { line = \"Part: *\" },";
    let value = reader.table.get(NAME)?;
    let DeValue::Table(table) = value.get_ref() else {
        return reader.text_value(NAME, value, needed).map(|name| PartNames::Column(name.to_owned()));
    };
    reader.knows_keys(NAME, table, &["line"].into_iter(), "its key is line")?;
    let Some(line) = table.get("line") else { return reader.wrong_type(NAME, value, needed) };
    let text = reader.text_value("line", line, needed)?;
    if text.matches('*').count() != 1 {
        let message = "`line` must have one `*`, which stands for the part's name";
        return reader.refuse(Diagnostic::error(Code::WrongType, message), line.span());
    }
    Some(PartNames::Line(Pattern::of_heading(text)))
}

/// A column of a space or tooth.
fn tooth_column(reader: &mut SectionReader<'_>, field: Field) -> DeclaredColumn {
    let name = reader.get(keys::COLUMN_NAME).map(|name| name.value);
    let is_deviation = reader.get(keys::COLUMN_KIND).is_some_and(|kind| kind.value == "deviation");
    let unit = reader.column_unit("unit", !field.is_of_trace()).map(|unit| unit.value);
    DeclaredColumn { is_deviation, others: others(reader, false), ..DeclaredColumn::new(field, name, unit, Vec::new()) }
}

/// The column of a measuring program's decision.
fn status_column(reader: &mut SectionReader<'_>) -> Option<StatusColumn> {
    let span = reader.table.get("status")?.span();
    let status = reader.table("status", &keys::TABLE_STATUS, |reader| {
        let texts = |texts: Vec<Located<String>>| texts.into_iter().map(|text| text.value).collect();
        let name = reader.get(keys::COLUMN_NAME).map(|name| name.value);
        name.map(|name| StatusColumn {
            name,
            accept: texts(reader.texts("accept")),
            reject: texts(reader.texts("reject")),
        })
    });
    let status = status?.value;
    if status.is_none() {
        let message = "`status` needs the heading of its column: name = \"…\"";
        reader.report(Diagnostic::error(Code::MissingKey, message), span);
    }
    status
}

/// A text; a problem if it is blank.
fn parsed<T, E: fmt::Display>(
    reader: &mut SectionReader<'_>,
    key: Key<String>,
    read: impl Fn(&str) -> Result<T, E>,
) -> Option<T> {
    let written = reader.get(key)?;
    let problem = match read(&written.value) {
        Ok(value) => return Some(value),
        Err(problem) => format!("`{}`: {problem}", key.any.name()),
    };
    reader.refuse(Diagnostic::error(Code::WrongType, problem), written.span)
}

/// The number of the line of units: `"line 8"`.
fn line_of_units(text: &str) -> Result<u64, &'static str> {
    let number = text.strip_prefix("line ").and_then(|number| number.trim().parse().ok());
    number.ok_or("write the number of a line, such as \"line 8\"")
}

/// Where the cells of a text of fixed width start, in rising order.
fn starts(reader: &mut SectionReader<'_>) -> Vec<usize> {
    const NAME: &str = "starts";
    let needed = "a list of whole numbers that grow, such as [0, 12, 24],";
    let Some(value) = reader.table.get(NAME) else { return Vec::new() };
    let whole = |entry: &Spanned<DeValue<'_>>| match entry.get_ref() {
        DeValue::Integer(number) => number.as_str().parse::<usize>().ok(),
        _ => None,
    };
    let starts: Option<Vec<usize>> = value.get_ref().as_array().and_then(|list| list.iter().map(whole).collect());
    if let Some(starts) = starts.filter(|starts| starts.is_sorted_by(|one, next| one < next)) {
        return starts;
    }
    reader.wrong_type::<()>(NAME, value, needed);
    Vec::new()
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
        let is_lead = kind == DeviationKind::RackLead;
        let unit = reader.column_unit("unit", is_lead);
        let unit_value = unit.as_ref().map(|unit| unit.value);
        let length = if is_lead { reader.get(keys::EVALUATION_LENGTH) } else { None };
        if let (Some(length), Some(Unit::Angle(unit))) = (&length, unit_value) {
            let message = format!("`length` is of f_Hβ, a length, and the unit of the column is {}", unit.symbol());
            reader.report(Diagnostic::error(Code::BadErrorEntry, message), length.span.clone());
        }
        let others = others(reader, nominal_heading.is_some());
        declared.push(DeclaredColumn { others, ..DeclaredColumn::new(kind, name.clone(), unit_value, beside) });
        BatchColumn {
            name,
            unit,
            length,
            nominal: if nominal_heading.is_some() { None } else { nominal(reader, kind) },
            kind: reader.get(keys::COLUMN_KIND),
            extent: reader.table.get(keys::EXTENT).and_then(|value| read_extent_value(reader, kind, value)),
            measured_at: if has_circle(kind) { reader.get(keys::COLUMN_MEASURED_AT) } else { None },
        }
    })
}

/// The keys of a column that do not name headings or its unit, with their values as TOML.
fn others(reader: &SectionReader<'_>, is_nominal_heading: bool) -> Vec<(String, String)> {
    let is_other = |key: &str| {
        !(matches!(key, "name" | "unit") || BESIDE.contains(&key) || is_nominal_heading && key == "nominal")
    };
    let each = reader.table.iter().filter(|(key, _)| is_other(key.get_ref()));
    each.map(|(key, value)| (key.get_ref().to_string(), in_toml(value.get_ref()))).collect()
}

/// A value as TOML, in one line.
fn in_toml(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => quoted(text),
        DeValue::Integer(number) => number.as_str().to_owned(),
        DeValue::Float(number) => number.as_str().to_owned(),
        DeValue::Boolean(is) => is.to_string(),
        DeValue::Datetime(date) => date.to_string(),
        DeValue::Array(list) => {
            format!("[{}]", list.iter().map(|entry| in_toml(entry.get_ref())).collect::<Vec<_>>().join(", "))
        }
        DeValue::Table(table) => {
            let keys =
                table.iter().map(|(key, value)| format!("{} = {}", quoted(key.get_ref()), in_toml(value.get_ref())));
            format!("{{ {} }}", keys.collect::<Vec<_>>().join(", "))
        }
    }
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::table::{Guesses, Proposal};

    /// What a key may hold, as TOML.
    fn samples(key: &keys::AnyKey) -> Vec<String> {
        let texts: &[&str] = match (key.path, key.kind) {
            ("table.encoding", _) => &["\"windows-1252\""],
            ("table.separator", _) => &["\"tab\"", "\"|\""],
            ("table.range", _) => &["\"B4:F200\""],
            ("table.units", _) => &["\"line 8\""],
            (_, keys::Kind::Text) => &["\"Maß [x]\"", "\"a \\\"b\\\"\""],
            (_, keys::Kind::Texts) => &["[\"Temp*\", \"F\"]"],
            (_, keys::Kind::LineRules) => &["[\"Datum: #\", { like = \"Max;*\", at_most = 2 }]"],
            (_, keys::Kind::PartId) => &["\"Teil\"", "{ line = \"Teil: *\" }"],
            (_, keys::Kind::Starts) => &["[0, 12, 24]"],
            (_, keys::Kind::NominalOrHeading { .. }) => &["25.0", "3", "\"Soll\""],
            (_, keys::Kind::ColumnUnit { .. }) => &["\"mm\"", "\"µm\""],
            (_, keys::Kind::Extent(_)) => &["\"one\"", "\"all\""],
            (_, keys::Kind::Length(_)) => &["18", "\"0.5 in\""],
            // "spaces" is written as "teeth"
            (_, keys::Kind::Word(words)) => {
                return words.iter().filter(|word| **word != "spaces").map(|word| quoted(word)).collect();
            }
            (path, kind) => panic!("{path}: {kind:?}"),
        };
        texts.iter().map(|text| (*text).to_owned()).collect()
    }

    /// A table with some keys of a section.
    fn table(section: &Section, random: &mut impl Iterator<Item = usize>) -> String {
        let mut entries = Vec::new();
        for key in section.keys {
            let value = if let keys::Kind::Table(inner) = key.kind {
                table(inner, random)
            } else {
                let samples = samples(key);
                samples[random.next().unwrap() % samples.len()].clone()
            };
            // a status has a name, and a table has spaces or teeth
            let is_there = random.next().unwrap().is_multiple_of(2) || section.name.ends_with("status");
            if is_there && !(key.name() == "tooth" && entries.iter().any(|entry: &String| entry.starts_with("space"))) {
                entries.push(format!("{} = {value}", key.name()));
            }
        }
        format!("{{ {} }}", entries.join(", "))
    }

    proptest! {
        #[test]
        fn the_block_of_a_contract_says_all_that_the_contract_says(
            random in proptest::collection::vec(any::<usize>(), 1000),
        ) {
            let text = format!("table = {}\n", table(&keys::TABLE, &mut random.into_iter()));
            let layout = |text: &str| match file("layout.toml", text) {
                Ok(section) => section.layout,
                Err(problems) => panic!("{problems} in {text}"),
            };
            let own = layout(&text);
            let block = Proposal::of("lot.csv", &own, Vec::new()).block(Guesses::Filled);
            prop_assert_eq!(&layout(&block), &own);
            let keys = |text: &str| -> toml::Table { toml::from_str(text).unwrap() };
            // a table without keys says nothing, but for a column, which a table must have
            let mut written = keys(&text);
            let table = written["table"].as_table_mut().unwrap();
            table.retain(|key, value| key != "columns" || !value.as_table().unwrap().is_empty());
            prop_assert_eq!(keys(&block), written);
        }
    }
}
