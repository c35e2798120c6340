//! Tables as people send them: `tests/tables/cases.toml` says what has to become of each. Every case is run as a user would
//! run it; what comes out is held against the expected status, values and words.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;

use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;
use rackmesh::deviation::{DeviationKind, DeviationValue};
use rackmesh::formula::Model;
use rackmesh::quantity::{Angle, Length};
use rackmesh::spec::Spec;
use serde::Deserialize;

#[derive(Deserialize)]
struct Cases {
    case: Vec<Case>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Case {
    file: Option<String>,
    #[serde(default)]
    more: Vec<String>,
    text: Option<String>,
    cells: Option<Vec<Vec<toml::Value>>>,
    format: Option<String>,
    #[serde(default)]
    sheets: BTreeMap<String, Vec<Vec<toml::Value>>>,
    #[serde(default)]
    types: Vec<String>,
    #[serde(default)]
    hidden_rows: Vec<u32>,
    /// Notes on cells, by their place: `B2`.
    #[serde(default)]
    notes: BTreeMap<String, String>,
    /// Ranges that are merged; one with `!` in front keeps the values below it.
    #[serde(default)]
    merged: Vec<String>,
    /// What numbers are shown with.
    number_format: Option<String>,
    /// What a sheet says beside its cells: `header`, `prompt`, `box`.
    #[serde(default)]
    beside: BTreeMap<String, String>,
    command: String,
    spec: Option<String>,
    #[serde(default)]
    options: Vec<String>,
    outcome: Outcome,
    #[serde(default)]
    says: Vec<String>,
    parts: Option<usize>,
    #[serde(default)]
    rejected: Vec<String>,
    #[serde(default)]
    values: BTreeMap<String, BTreeMap<String, f64>>,
    exit: Option<i32>,
    #[serde(default)]
    open: bool,
    why: String,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "lowercase")]
enum Outcome {
    /// All values count.
    Used,
    /// Something has no owner: the run names it, with the lines that close the table.
    Needs,
    /// It is no table, or contradicts itself.
    Refused,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tables")
}

fn cases() -> Vec<Case> {
    let text = std::fs::read_to_string(folder().join("cases.toml")).unwrap();
    toml::from_str::<Cases>(&text).unwrap().case
}

/// What a case is called in a message.
fn name(case: &Case, number: usize) -> String {
    let file = case.file.clone().unwrap_or_else(|| format!("{} of the manifest", case.format.as_deref().unwrap_or("")));
    format!("case {} ({file}, {})", number + 1, case.command)
}

/// The table of a case, made if it is none of the folder.
fn table(case: &Case, number: usize) -> String {
    match (&case.file, &case.cells) {
        (Some(file), _) => file.clone(),
        (None, Some(cells)) => {
            let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
            let path = path.join(format!("table-{number}.{}", case.format.as_deref().unwrap()));
            match case.format.as_deref() {
                Some("xlsx") => workbook(&path, cells, case),
                _ => parquet(&path, cells, &case.types),
            }
            path.display().to_string()
        }
        (None, None) => {
            let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("table-{number}.csv"));
            std::fs::write(&path, case.text.as_ref().expect("a case has a file, a text or cells")).unwrap();
            path.display().to_string()
        }
    }
}

fn workbook(path: &Path, cells: &[Vec<toml::Value>], case: &Case) {
    let mut book = rust_xlsxwriter::Workbook::new();
    let sheet = book.add_worksheet();
    write_sheet(sheet, cells);
    dress(sheet, cells, case);
    for row in &case.hidden_rows {
        sheet.set_row_hidden(row - 1).unwrap();
    }
    for (cell, note) in &case.notes {
        let (column, row) = place(cell);
        sheet.insert_note(row, column, &rust_xlsxwriter::Note::new(note)).unwrap();
    }
    for (name, cells) in &case.sheets {
        write_sheet(book.add_worksheet().set_name(name).unwrap(), cells);
    }
    book.save(path).unwrap();
}

/// Column and row of `B3`, from 0.
fn place(cell: &str) -> (u16, u32) {
    (u16::from(cell.as_bytes()[0] - b'A'), cell[1..].parse::<u32>().unwrap() - 1)
}

/// What a sheet has besides its cells.
fn dress(sheet: &mut rust_xlsxwriter::Worksheet, cells: &[Vec<toml::Value>], case: &Case) {
    for range in &case.merged {
        let (from, to) = range.trim_start_matches('!').split_once(':').unwrap();
        let ((first, top), (last, bottom)) = (place(from), place(to));
        sheet.merge_range(top, first, bottom, last, "", &rust_xlsxwriter::Format::new()).unwrap();
        for row in top..=bottom {
            let is_kept = row == top || range.starts_with('!');
            let own: Vec<toml::Value> = cells[row as usize].iter().skip(first as usize).take(1).cloned().collect();
            write_cells(sheet, row, first, if is_kept { &own } else { &[] });
        }
    }
    if let Some(format) = &case.number_format {
        sheet.set_cell_format(1, 1, &rust_xlsxwriter::Format::new().set_num_format(format)).unwrap();
    }
    if let Some(header) = case.beside.get("header") {
        sheet.set_header(header);
    }
    if let Some(prompt) = case.beside.get("prompt") {
        let validation = rust_xlsxwriter::DataValidation::new().set_input_message(prompt).unwrap();
        sheet.add_data_validation(1, 1, 1, 1, &validation).unwrap();
    }
    if let Some(text) = case.beside.get("box") {
        sheet.insert_shape(4, 4, &rust_xlsxwriter::Shape::textbox().set_text(text)).unwrap();
    }
}

fn write_sheet(sheet: &mut rust_xlsxwriter::Worksheet, cells: &[Vec<toml::Value>]) {
    for (row, cells) in (0..).zip(cells) {
        write_cells(sheet, row, 0, cells);
    }
}

fn write_cells(sheet: &mut rust_xlsxwriter::Worksheet, row: u32, first: u16, cells: &[toml::Value]) {
    for (column, cell) in (first..).zip(cells) {
        match cell {
            toml::Value::Integer(_) | toml::Value::Float(_) => sheet.write_number(row, column, number(cell)).unwrap(),
            toml::Value::String(text) if text.starts_with('#') && text.ends_with(['!', 'A']) => {
                let formula = rust_xlsxwriter::Formula::new("=1/0").set_result(text);
                sheet.write_formula(row, column, formula).unwrap()
            }
            toml::Value::String(text) if text.is_empty() => sheet,
            toml::Value::String(text) => sheet.write_string(row, column, text).unwrap(),
            other => sheet.write_string(row, column, other.to_string()).unwrap(),
        };
    }
}

/// Precision and scale of `decimal(9,4)`.
fn decimal(kind: &str) -> Option<(i32, i32)> {
    let inside = kind.strip_prefix("decimal(")?.strip_suffix(')')?;
    let (precision, scale) = inside.split_once(',')?;
    Some((precision.trim().parse().unwrap(), scale.trim().parse().unwrap()))
}

fn parquet(path: &Path, cells: &[Vec<toml::Value>], types: &[String]) {
    let fields = cells[0].iter().zip(types).map(|(title, kind)| {
        let (physical, converted) = match kind.as_str() {
            "text" => (Physical::BYTE_ARRAY, ConvertedType::UTF8),
            "double" => (Physical::DOUBLE, ConvertedType::NONE),
            "float" => (Physical::FLOAT, ConvertedType::NONE),
            "int32" => (Physical::INT32, ConvertedType::NONE),
            "int64" => (Physical::INT64, ConvertedType::NONE),
            "timestamp" => (Physical::INT64, ConvertedType::TIMESTAMP_MILLIS),
            _ => (Physical::INT64, ConvertedType::DECIMAL),
        };
        let builder = Type::primitive_type_builder(title.as_str().unwrap(), physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_converted_type(converted);
        let builder = match decimal(kind) {
            Some((precision, scale)) => builder.with_precision(precision).with_scale(scale),
            None => builder,
        };
        Arc::new(builder.build().unwrap())
    });
    let schema = Type::group_type_builder("parts").with_fields(fields.collect()).build().unwrap();
    let file = std::fs::File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::default()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for (index, kind) in types.iter().enumerate() {
        let column: Vec<&toml::Value> = cells[1..].iter().map(|row| &row[index]).collect();
        let mut open = group.next_column().unwrap().unwrap();
        parquet_column(&mut open, kind, &column);
        open.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
}

/// Writes the cells of a column; `"null"` is none.
fn parquet_column(open: &mut SerializedColumnWriter<'_>, kind: &str, column: &[&toml::Value]) {
    let is_null = |cell: &toml::Value| cell.as_str() == Some("null");
    let levels: Vec<i16> = column.iter().map(|cell| i16::from(!is_null(cell))).collect();
    let values: Vec<&toml::Value> = column.iter().copied().filter(|cell| !is_null(cell)).collect();
    let number = |cell: &&toml::Value| number(cell);
    match (kind, decimal(kind)) {
        ("text", _) => {
            let texts: Vec<_> = values.iter().map(|cell| ByteArray::from(cell.as_str().unwrap())).collect();
            open.typed::<ByteArrayType>().write_batch(&texts, Some(&levels), None).unwrap();
        }
        ("double", _) => {
            let numbers: Vec<_> = values.iter().map(number).collect();
            open.typed::<DoubleType>().write_batch(&numbers, Some(&levels), None).unwrap();
        }
        ("float", _) => {
            let numbers: Vec<_> = values.iter().map(|cell| number(cell) as f32).collect();
            open.typed::<FloatType>().write_batch(&numbers, Some(&levels), None).unwrap();
        }
        ("int32", _) => {
            let numbers: Vec<_> = values.iter().map(|cell| number(cell) as i32).collect();
            open.typed::<Int32Type>().write_batch(&numbers, Some(&levels), None).unwrap();
        }
        ("timestamp", _) => {
            let numbers: Vec<i64> = (1_760_000_000_000..).take(values.len()).collect();
            open.typed::<Int64Type>().write_batch(&numbers, Some(&levels), None).unwrap();
        }
        (_, decimal) => {
            let unscaled: f64 = format!("1e{}", decimal.map_or(0, |(_, scale)| scale)).parse().unwrap();
            let numbers: Vec<_> = values.iter().map(|cell| (number(cell) * unscaled).round() as i64).collect();
            open.typed::<Int64Type>().write_batch(&numbers, Some(&levels), None).unwrap();
        }
    }
}

/// A cell of the manifest as a number.
fn number(cell: &toml::Value) -> f64 {
    match cell {
        toml::Value::Integer(number) => number.to_string().parse().unwrap(),
        toml::Value::Float(number) => *number,
        toml::Value::String(text) => text.parse().unwrap(),
        other => panic!("{other}"),
    }
}

fn run(case: &Case, table: &str, more: &[&str]) -> Output {
    let mut words = case.command.split(' ');
    let mut command = Command::new(env!("CARGO_BIN_EXE_rackmesh"));
    command.current_dir(folder()).arg(words.next().unwrap());
    let files = std::iter::once(table).chain(case.more.iter().map(String::as_str));
    if case.command == "read" {
        command.args(files).args(&case.spec);
    } else {
        command.args(&case.spec).args(files);
    }
    command.args(words).args(&case.options).args(more);
    command.stdin(std::process::Stdio::null()).output().unwrap()
}

/// What a case expects of the exit status.
fn status(case: &Case) -> i32 {
    case.exit.unwrap_or(match case.outcome {
        Outcome::Needs | Outcome::Refused => 2,
        Outcome::Used => {
            if case.rejected.is_empty() {
                0
            } else {
                2
            }
        }
    })
}

/// ΔCD of a deviation by the formulas, mm.
fn delta_cd(spec: &Spec, error: &str, deviation: f64) -> f64 {
    let kind =
        DeviationKind::ALL.into_iter().find(|kind| kind.key() == error).unwrap_or_else(|| panic!("no error {error}"));
    let value: DeviationValue = match kind {
        DeviationKind::RackLead => Angle::from_degrees(deviation).unwrap().into(),
        _ => Length::from_mm(deviation).unwrap().into(),
    };
    spec.law(kind, "the test").unwrap().delta_cd(value, Model::Exact).unwrap().mm()
}

/// ΔCD of each error of each part, mm, as the command writes them.
fn results(case: &Case, table: &str) -> Vec<(String, BTreeMap<String, f64>)> {
    if case.command == "batch" {
        let out = run(case, table, &["--decimals", "full", "--format", "csv"]);
        let text = String::from_utf8(out.stdout).unwrap();
        let mut reader = csv_rows(&text).into_iter();
        let header = reader.next().unwrap_or_default();
        let errors = |row: Vec<String>| {
            let named = header.iter().zip(&row).filter_map(|(title, cell)| {
                let error = title.strip_prefix("delta_cd_")?.strip_suffix("_mm")?;
                Some((error.to_owned(), cell.parse().ok()?))
            });
            (row[0].clone(), named.collect())
        };
        return reader.map(errors).collect();
    }
    let out = run(case, table, &["--format", "json"]);
    let Ok(json) = serde_json::from_slice::<serde_json::Value>(&out.stdout) else { return Vec::new() };
    if let Some(contributions) = json["contributions"].as_array() {
        let errors = contributions
            .iter()
            .map(|one| (one["error"].as_str().unwrap().to_owned(), one["delta_cd_mm"].as_f64().unwrap()));
        let title = json["title"].as_str().unwrap_or("").trim_start_matches("part ").to_owned();
        return vec![(title, errors.collect())];
    }
    let parts = json["parts"].as_array().cloned().unwrap_or_default();
    let errors = |part: &serde_json::Value| {
        let named = part.as_object().unwrap().iter().filter_map(|(key, value)| {
            Some((key.strip_prefix("delta_cd_")?.strip_suffix("_mm")?.to_owned(), value.as_f64()?))
        });
        (part["part_id"].as_str().unwrap_or("").to_owned(), named.collect())
    };
    parts.iter().map(errors).collect()
}

fn csv_rows(text: &str) -> Vec<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
    reader.records().map(|row| row.unwrap().iter().map(str::to_owned).collect()).collect()
}

/// What is wrong with the values of a case.
fn wrong_values(case: &Case, table: &str) -> Vec<String> {
    if case.values.is_empty() || case.command.contains("--teeth") || case.command == "read" {
        return Vec::new();
    }
    let spec = folder().join(case.spec.as_ref().unwrap());
    let spec = Spec::parse("spec", &std::fs::read_to_string(spec).unwrap()).unwrap();
    let parts = results(case, table);
    let mut wrong = Vec::new();
    let judged = case.parts.map(|parts| parts - case.rejected.len());
    if judged.is_some_and(|judged| parts.iter().filter(|(_, errors)| !errors.is_empty()).count() != judged) {
        wrong.push(format!("{} parts, not {judged:?}", parts.len()));
    }
    for (part, errors) in &case.values {
        let found = match part.strip_prefix('#') {
            Some(number) => parts.get(number.parse::<usize>().unwrap() - 1),
            None => parts.iter().find(|(name, _)| name == part),
        };
        let Some((_, found)) = found else {
            wrong.push(format!("there is no part {part}"));
            continue;
        };
        for (error, deviation) in
            errors.iter().filter(|(error, _)| DeviationKind::ALL.iter().any(|kind| kind.key() == *error))
        {
            let expected = delta_cd(&spec, error, *deviation);
            match found.get(error) {
                Some(value) if (value - expected).abs() <= 2e-9 => {}
                other => wrong.push(format!("part {part}, {error}: ΔCD {other:?}, not {expected} of {deviation}")),
            }
        }
    }
    wrong
}

/// Writes what became of a case into the file that the environment names, to label new cases by.
fn record(number: usize, status: Option<i32>, problems: &[String], said: &str) {
    let Ok(path) = std::env::var("RACKMESH_TABLES") else { return };
    let line = serde_json::json!({ "case": number, "status": status, "problems": problems, "said": said });
    let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).unwrap();
    std::io::Write::write_all(&mut file, format!("{line}\n").as_bytes()).unwrap();
}

#[test]
fn every_table_becomes_what_it_has_to() {
    let only = std::env::var("RACKMESH_TABLE").unwrap_or_default();
    let mut wrong = Vec::new();
    for (number, case) in cases().iter().enumerate() {
        if !name(case, number).contains(&only) {
            continue;
        }
        let table = table(case, number);
        let out = run(case, &table, &[]);
        let said = format!("{}{}", String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr));
        let mut problems = Vec::new();
        if out.status.code() != Some(status(case)) {
            problems.push(format!("exit status {:?}, not {}", out.status.code(), status(case)));
        } else if case.outcome == Outcome::Used {
            problems.extend(wrong_values(case, &table));
        } else if !case.open && case.command != "read" && said.contains("\npass") {
            problems.push("there is a verdict".to_owned());
        }
        problems
            .extend(case.says.iter().filter(|word| !said.contains(*word)).map(|word| format!("does not say `{word}`")));
        // no lines close a table without a column that its contract names
        let closes = ["what closes the table, in the spec", "What closes it, in the spec", "\" is gone"]
            .map(|what| said.contains(what));
        if (case.outcome == Outcome::Needs) != closes.contains(&true) {
            problems.push("whether something has no owner is said wrongly".to_owned());
        }
        record(number, out.status.code(), &problems, &said);
        if !problems.is_empty() {
            wrong.push(format!(
                "{} {:?}: {}\n  {}\n  {}",
                name(case, number),
                case.outcome,
                problems.join("; "),
                case.why,
                said.lines().take(9).collect::<Vec<_>>().join("\n  ")
            ));
        }
    }
    assert!(wrong.is_empty(), "{} of the cases:\n{}", wrong.len(), wrong.join("\n"));
}
