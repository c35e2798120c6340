//! Tables by contract are closed: whatever is changed in a file, what comes out changes, a row is rejected, or the run ends.

use std::sync::Arc;

use ::parquet::basic::{LogicalType, Repetition, Type as Physical};
use ::parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::Type;

use super::*;

type Grid = Vec<Vec<String>>;

/// A file of some kind, as it is written from a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Text(char, char),
    FixedWidth,
    Workbook,
    Parquet,
    /// Cells of a line behind each other, as Q-DAS files and reports of measuring programs have them.
    Lines(&'static str),
}

const KINDS: [Kind; 6] = [
    Kind::Text(';', ','),
    Kind::Text(',', '.'),
    Kind::Text('\t', ','),
    Kind::FixedWidth,
    Kind::Workbook,
    Kind::Parquet,
];

/// Tables with a row per part, of which the last one has its parts in columns.
const TABLES: [&str; 4] = [
    "Prüfprotokoll 7\nTeil|Rollenmaß [mm]|Temp [°C]|CHR_017\nP1|25.011|20.1|3.1\nP2|25.004|20.2|-2.2\nP3|25.008|20.2|1.7\n\
     Mittelwert|25.008|20.2|0.9",
    "Teil|Rollenmaß|Soll|Abw|Temp|CHR_017|Bemerkung\n|mm|mm|mm||um|\nP1|25.011|25.000|0.011|20.1|3.1|\nP2|25.004|25.000|0.004|20.2|-2.2|ok",
    "Temp|CHR_017|Teil|\n20|3.1|P1|\n21|-2.2|P2|\n22|0.4|P3|",
    "Teil|P1|P2|P3\nRollenmaß [mm]|25.011|25.004|25.008\nTemp [°C]|20|21|22\nCHR_017|3.1|-2.2|1.7",
];

/// Tables with a row per characteristic.
const CHARACTERISTICS: [&str; 2] = [
    "Prüfprotokoll 7\nTeil|Merkmal|Soll|Ist|Abw|Einheit|Bemerkung\nP1|Rollenmaß|25.000|25.011|0.011|mm|\nP1|CHR_017|0|3.1|3.1|um|ok\n\
     P1|Temp|20|20.1|0.1|C|\nP2|Rollenmaß|25.000|25.004|0.004|mm|\nP2|CHR_017|0|-2.2|-2.2|um|",
    "Merkmal|Ist [mm]|Temp\nRollenmaß|25.011|20\nPinion radial error|0.0031|20",
];

/// Tables with a row per space or tooth.
const TEETH: [&str; 2] = [
    "Teil|Lücke|Rollenmaß Abweichung [um]|position_deviation [um]|Temp\nP1|0|1.5|0|20\nP1|1|2.5|-1|20\nP2|0|0.5|0|21\nP2|1|0.25|2|21",
    "tooth|left_pitch|right_pitch|Temp\n0|0.003|0.001|20\n1|-0.004|0.002|20\n2|0.001|-0.003|20",
];

/// Files of formats that say what each of their cells is, with what stands between the cells of a line.
const FORMATS: [(Kind, &str); 3] = [
    (
        Kind::Lines(" "),
        "K0100|3\nK1001/1|R-118\nK1002/1|Zahnstange\nK1900/1|Prüfer Huber\nK2001/1|1\nK2002/1|Rollenmaß\nK2101/1|25.0\n\
         K2110/1|24.98\nK2111/1|25.03\nK2142/1|mm\nK2001/2|CHR_017\nK2142/2|um\nK2002/3|Temp\n25.011\u{f}3.1\u{14}0\u{14}1.1.2026\u{f}20\n\
         K0014/0|P1\n25.004\u{f}-2.2\u{f}21\nK0014/0|P2",
    ),
    (
        Kind::Lines("\t"),
        "planid|partnb|id|type|idsymbol|actual|nominal|uppertol|lowertol|deviation|comment|unit|group1|\n\
         7|P1|Rollenmaß|xValue|X1|25.011|25.000|0.03|-0.02|0.011||mm|A\n7|P1|CHR_017|yValue|Y1|3.1|0|15|-15|3.1||um\n\
         7|P1|Temp 1|t|T|20|20|1|1|0||C\n7|P2|Rollenmaß|xValue|X1|25.004|25.000|0.03|-0.02|0.004||mm\n\
         7|P2|CHR_017|yValue|Y1|-2.2|0|15|-15|-2.2||um\nEND",
    ),
    (
        Kind::Lines("  "),
        "Prüfprotokoll 7\nPART NAME|:|RACK 7412\nSER NUMBER|:|P1\nDIM|OVER_ROLLER=|2D DISTANCE UNITS=MM,$\nGRAPH=OFF|TEXT=OFF\n\
         AX|NOMINAL|+TOL|-TOL|MEAS|MAX|DEV|OUTTOL\nM|25.000|0.03|0.02|25.011|25.011|0.011|0.000\n\
         DIM|CHR_017=|LOCATION UNITS=UM\nAX|NOMINAL|MEAS|DEV\nX|0|3.1|3.1|---->---\nEND OF DIMENSION CHR_017\n\
         PART NAME|:|RACK 7412\nSER NUMBER|:|P2\nDIM|OVER_ROLLER=|2D UNITS=MM\nAX|NOMINAL|MEAS|DEV\nM|25.000|25.004|0.004\n\
         DIM|CHR_017=|LOCATION UNITS=UM\nAX|NOMINAL|MEAS|DEV\nX|0|-2.2|-2.2",
    ),
];

const WORDS: [&str; 26] = [
    "0",
    "K2002/1",
    "SER NUMBER",
    "UNITS=IN",
    "412",
    "0.412",
    "25.061",
    "-3",
    "NOK",
    "korrekt: 0.412",
    "Teil",
    "Rollenmaß [mm]",
    "in inch",
    "x",
    "P2",
    "P9",
    "Soll",
    "mm",
    "in",
    "-",
    "CHR_017",
    "Alle Werte in Zoll",
    "valori in pollici",
    "値は無効",
    "Mean",
    "Prüfprotokoll 8",
];

fn all_tables() -> impl Iterator<Item = &'static str> {
    TABLES.into_iter().chain(CHARACTERISTICS).chain(TEETH)
}

pub(super) fn contract(grid: &str) -> Want {
    let column = |kind, name: &str, beside: &[(&'static str, &str)]| {
        let beside = beside.iter().map(|(key, name)| (*key, (*name).to_owned())).collect();
        DeclaredColumn::new(kind, (!name.is_empty()).then(|| name.to_owned()), None, beside)
    };
    let mut columns = vec![column(DeviationKind::RackPitch, "CHR_017", &[])];
    columns.retain(|_| grid.contains("CHR_017"));
    if grid.contains("|Soll|Abw|") {
        columns.push(column(DeviationKind::RackOverRoller, "", &[("nominal", "Soll"), ("deviation", "Abw")]));
    }
    let line = |text, at_most| LineRule { pattern: Pattern::of_line(text), at_most };
    let layout = Layout {
        columns,
        ignore: ["Temp*", "Bemerkung"].map(Pattern::of_heading).to_vec(),
        comments: vec![Pattern::of_heading("K1900: *")],
        ignore_lines: vec![line("Prüfprotokoll #", 0), line("Mittelwert;*", 1)],
        ..Layout::default()
    };
    let pitch = GivenColumn { unit: Unit::from_symbol("um"), ..given(DeviationKind::RackPitch, None) };
    let mut want = want();
    want.given.push(pitch);
    want.teeth = Some(TEETH.contains(&grid));
    Want { layout: layout.into(), ..want }
}

fn grid(text: &str) -> Grid {
    text.lines().map(|line| line.split('|').map(str::to_owned).collect()).collect()
}

/// The file of a grid, with a comment or a second sheet where a workbook has one.
fn file(kind: Kind, grid: &Grid, beside: Option<&str>) -> Vec<u8> {
    let is_number = |cell: &str| cell.parse::<f64>().is_ok();
    match kind {
        Kind::Text(separator, mark) => {
            let cell = |cell: &String| {
                let cell = if is_number(cell) { cell.replace('.', &mark.to_string()) } else { cell.clone() };
                if cell.contains(separator) { format!("\"{cell}\"") } else { cell }
            };
            let line = |row: &Vec<String>| row.iter().map(cell).collect::<Vec<_>>().join(&separator.to_string()) + "\n";
            grid.iter().map(line).collect::<String>().into_bytes()
        }
        Kind::FixedWidth => {
            let line = |row: &Vec<String>| row.iter().map(|cell| format!("{cell:<32}")).collect::<Vec<_>>().concat();
            grid.iter().map(line).collect::<Vec<_>>().join("\n").into_bytes()
        }
        Kind::Workbook => {
            let mut book = rust_xlsxwriter::Workbook::new();
            let sheet = book.add_worksheet();
            for (row, cells) in grid.iter().enumerate() {
                for (column, cell) in cells.iter().enumerate().filter(|(_, cell)| !cell.is_empty()) {
                    let (row, column) = (row as u32, column as u16);
                    match cell.parse::<f64>() {
                        Ok(number) => sheet.write_number(row, column, number).unwrap(),
                        Err(_) => sheet.write_string(row, column, cell).unwrap(),
                    };
                }
            }
            match beside {
                Some(text) if text.len() % 2 == 0 => {
                    _ = sheet.insert_note(1, 1, &rust_xlsxwriter::Note::new(text)).unwrap();
                }
                Some(text) => _ = book.add_worksheet().write_string(0, 0, text).unwrap(),
                None => {}
            }
            book.save_to_buffer().unwrap()
        }
        Kind::Parquet => parquet(grid, beside),
        Kind::Lines(between) => grid.iter().map(|row| row.join(between) + "\n").collect::<String>().into_bytes(),
    }
}

fn parquet(grid: &Grid, remark: Option<&str>) -> Vec<u8> {
    let width = grid.iter().map(Vec::len).max().unwrap_or(0);
    let cell = |row: usize, column: usize| grid[row].get(column).map_or("", String::as_str);
    let is_double = |column: usize| (1..grid.len()).all(|row| cell(row, column).parse::<f64>().is_ok());
    let field = |column: usize| {
        let (name, is_text) = (cell(0, column), !is_double(column));
        let physical = if is_text { Physical::BYTE_ARRAY } else { Physical::DOUBLE };
        let field = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
        Arc::new(field.with_logical_type(is_text.then_some(LogicalType::String)).build().unwrap())
    };
    let schema = Type::group_type_builder("lot").with_fields((0..width).map(field).collect()).build().unwrap();
    let remarks = remark.map(|text| vec![KeyValue::new("remark".to_owned(), text.to_owned())]);
    let properties = WriterProperties::builder().set_key_value_metadata(remarks).build();
    let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties)).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for column in 0..width {
        let mut open = group.next_column().unwrap().unwrap();
        let levels: Vec<i16> = (1..grid.len()).map(|row| i16::from(!cell(row, column).is_empty())).collect();
        let texts = (1..grid.len()).map(|row| cell(row, column)).filter(|text| !text.is_empty());
        if is_double(column) {
            let values: Vec<f64> = texts.map(|text| text.parse().unwrap()).collect();
            open.typed::<DoubleType>().write_batch(&values, Some(&levels), None).unwrap();
        } else {
            let values: Vec<ByteArray> = texts.map(ByteArray::from).collect();
            open.typed::<ByteArrayType>().write_batch(&values, Some(&levels), None).unwrap();
        }
        open.close().unwrap();
    }
    group.close().unwrap();
    writer.into_inner().unwrap()
}

/// What is observed of a file: its parts with their values, what its columns are, what each rule left out and what is hidden; an error if it is
/// refused, or a row is rejected.
pub(super) fn observed(kind: Kind, bytes: Vec<u8>, want: &Want) -> Result<(Vec<String>, String), String> {
    let in_words = |Diagnostics(problems): Diagnostics| format!("{problems:?}");
    let name = if kind == Kind::Workbook { "lot.xlsx" } else { "lot" };
    let table = Container::open(name, Source::bytes(bytes), want).and_then(|container| container.table(name, want));
    let table = table.map_err(in_words)?;
    let (mut reading, is_teeth) = (table.reading.clone(), table.is_teeth);
    let keys: Vec<_> = table.columns.iter().map(|column| column.field.key()).collect();
    let mut parts = Vec::new();
    for block in table.blocks().map_err(|error| error.to_string())? {
        if let Some(contradiction) = block.contradiction {
            return Err(contradiction.message);
        }
        if let Some(fault) = block.faults.first() {
            return Err(fault.message.clone());
        }
        parts.extend((0..block.rows()).map(|row| part(&block, row, &keys)));
        block.tell(&mut reading);
    }
    let words = if is_teeth { 2 } else { 1 };
    let name = |part: &String| part.split(':').take(words).map(str::to_owned).collect::<Vec<_>>();
    let names: std::collections::HashSet<Vec<String>> = parts.iter().map(name).collect();
    if names.len() < parts.len() {
        return Err("a part is there twice".to_owned());
    }
    let hidden: Vec<_> = reading.notes.iter().filter(|note| note.contains("hidden")).collect();
    Ok((parts, format!("{:?} {:?} {hidden:?}", reading.columns, reading.left_out)))
}

pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn below(&mut self, count: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 % count as u64).unwrap()
    }
}

/// Changes a grid, or gives what is to stand beside it.
fn mutated(grid: &mut Grid, random: &mut Random) -> Option<&'static str> {
    let word = WORDS[random.below(WORDS.len())];
    let row = random.below(grid.len());
    let column = random.below(grid[row].len());
    match random.below(13) {
        0 | 1 => grid[row][column] = word.to_owned(),
        2 => grid[row].insert(column, word.to_owned()),
        3 => grid[row].push(word.to_owned()),
        4 => grid.insert(row, vec![word.to_owned()]),
        5 => {
            let width = grid[row].len();
            let cells = (0..width).map(|_| WORDS[random.below(WORDS.len())].to_owned()).collect();
            grid.insert(row, cells);
        }
        6 => grid.iter_mut().for_each(|row| row.insert(column.min(row.len()), word.to_owned())),
        7 => grid[row][column] = format!("{} {word}", grid[row][column]),
        8 => _ = grid.remove(row),
        9 => grid.insert(row, grid[row].clone()),
        11 => {
            // the last digit of a number
            let text = &mut grid[row][column];
            if let Some(digit) = text.chars().last().and_then(|last| last.to_digit(10)) {
                text.pop();
                text.push(char::from_digit((digit + 1) % 10, 10).unwrap());
            }
        }
        10 => grid.iter_mut().filter(|row| row.len() > column).for_each(|row| _ = row.remove(column)),
        _ => return Some(word),
    }
    None
}

/// A grid without blanks around its cells, blank cells at the ends of its rows, and blank rows at its end. A unit behind a number in a
/// column of that unit is another spelling of the number.
fn normal(grid: &Grid) -> Grid {
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    let cell = |cell: &String| match cell.trim().split_once(' ') {
        Some((number, "mm")) if is_number(number) => number.to_owned(),
        _ => cell.trim().to_owned(),
    };
    let trimmed = |row: &Vec<String>| {
        let mut row: Vec<String> = row.iter().map(cell).collect();
        row.truncate(row.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1));
        row
    };
    let mut rows: Grid = grid.iter().map(trimmed).collect();
    rows.truncate(rows.iter().rposition(|row| !row.is_empty()).map_or(0, |last| last + 1));
    rows
}

/// Whether a grid can be written so: a Parquet file has one heading, and nothing above it; one of fixed width has no empty cells
/// that others have to show.
fn can_be(kind: Kind, text: &str) -> bool {
    match kind {
        Kind::Parquet => !text.starts_with("Prüf") && !text.contains("mm|mm") && !text.starts_with("Teil|P1"),
        Kind::FixedWidth => !text.contains("||") && !text.contains("|\n") && !text.ends_with('|'),
        _ => true,
    }
}

/// `RACKMESH_LONG_TESTS=1` tries a hundred thousand changes.
#[test]
fn no_change_goes_unnoticed() {
    let long = std::env::var("RACKMESH_LONG_TESTS").is_ok_and(|value| value == "1");
    let tables = KINDS.into_iter().flat_map(|kind| all_tables().map(move |table| (kind, table)));
    let tables: Vec<(Kind, &str)> = tables.filter(|(kind, table)| can_be(*kind, table)).chain(FORMATS).collect();
    let each = if long { 100_000 } else { 2_000 } / tables.len() + 1;
    let (mut random, mut tried, mut unnoticed) = (Random(0x9e37_79b9_7f4a_7c15), 0, Vec::new());
    for (kind, text) in tables {
        let (base, want) = (grid(text), contract(text));
        let before = observed(kind, file(kind, &base, None), &want)
            .unwrap_or_else(|problem| panic!("{kind:?} {text}: {problem}"));
        for _ in 0..each {
            let mut changed = base.clone();
            let beside = mutated(&mut changed, &mut random).filter(|_| matches!(kind, Kind::Workbook | Kind::Parquet));
            let is_nothing = changed.iter().all(Vec::is_empty) || beside.is_none() && normal(&changed) == normal(&base);
            if is_nothing || kind == Kind::Parquet && changed.len() < 2 {
                continue;
            }
            tried += 1;
            if observed(kind, file(kind, &changed, beside), &want).is_ok_and(|after| after == before) {
                unnoticed.push(format!(
                    "{kind:?} {beside:?}\n{}",
                    changed.iter().map(|row| row.join("|") + "\n").collect::<String>()
                ));
            }
        }
    }
    println!("{tried} changes, {} unnoticed", unnoticed.len());
    assert!(
        unnoticed.is_empty(),
        "{} of {tried} changes go unnoticed:\n{}",
        unnoticed.len(),
        unnoticed[..unnoticed.len().min(12)].join("\n")
    );
}

/// The same values, parts and rules, whatever the file.
#[test]
fn files_of_one_table_agree() {
    for text in all_tables() {
        let parts = |kind: Kind| observed(kind, file(kind, &grid(text), None), &contract(text)).map(|(parts, _)| parts);
        let expected = parts(KINDS[0]).unwrap();
        assert!(!expected.is_empty());
        for kind in KINDS.into_iter().filter(|kind| can_be(*kind, text)) {
            assert_eq!(parts(kind).as_ref(), Ok(&expected), "{kind:?} {text}");
        }
    }
}
