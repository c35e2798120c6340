//! A table is judged the same whether it is text, a Parquet file or columns in memory.

use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

use rackmesh::batch::{
    Batch, ColumnEvaluator, ColumnKind, ColumnPiece, ColumnSink as _, Layout, Packing, ParquetRows, Plan, Request,
    ResultColumn, ResultColumns, ResultValues, RowSink, Sink, Sinks,
};
use rackmesh::spec::Spec;
use rackmesh::table::{Container, Source, Stored};

/// A file in memory that is still there when the writer is gone.
#[derive(Clone, Default)]
struct Memory(Arc<Mutex<Vec<u8>>>);

impl std::io::Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().expect("nobody panics").extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

const SPEC: &str = "[pair]\nnormal_pressure_angle = 20\n[rack]\nface_width = 19.8\n\
                    [errors]\nrack_over_roller = { nominal = 25.0 }\npinion_radial = { nominal = 8.5 }\n\
                    [limits]\ncenter_distance = \"±0.05\"\nrack_over_roller = \"±0.01\"\n\
                    [table.columns]\nrack_pitch = { unit = \"um\" }\n";
const NAMES: [&str; 5] = ["part_id", "rack_over_roller", "rack_pitch", "rack_lead", "pinion_radial"];

/// Numbers of ten-thousandths, by a generator of its own; a tenth of the sizes lies on the limit.
fn numbers(rows: usize) -> [Vec<i64>; 4] {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut below = |count: i64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        i64::try_from(state % count.unsigned_abs()).expect("it is smaller")
    };
    let mut columns = [const { Vec::new() }; 4];
    for _ in 0..rows {
        let size = if below(10) == 0 { 100 - 200 * below(2) } else { below(240) - 120 };
        for (column, number) in columns.iter_mut().zip([
            250_000 + size,
            10_000 * below(40) / 100,
            below(1000) - 500,
            85_000 + below(100) - 50,
        ]) {
            column.push(number);
        }
    }
    columns
}

/// The decimal of ten-thousandths.
fn text(number: i64) -> String {
    let sign = if number < 0 { "-" } else { "" };
    format!("{sign}{}.{:04}", number.abs() / 10_000, number.abs() % 10_000)
}

fn csv(columns: &[Vec<i64>; 4]) -> Vec<u8> {
    let mut table = NAMES.join(",") + "\n";
    for row in 0..columns[0].len() {
        let _ = write!(table, "P{row}");
        for column in columns {
            let _ = write!(table, ",{}", text(column[row]));
        }
        table.push('\n');
    }
    table.into_bytes()
}

fn doubles(column: &[i64]) -> Vec<f64> {
    column.iter().map(|number| text(*number).parse().expect("it is a number")).collect()
}

fn names(rows: usize) -> (Vec<u8>, Vec<usize>) {
    let (mut bytes, mut ends) = (Vec::new(), vec![0]);
    for row in 0..rows {
        bytes.extend_from_slice(format!("P{row}").as_bytes());
        ends.push(bytes.len());
    }
    (bytes, ends)
}

fn parquet(columns: &[Vec<i64>; 4]) -> Vec<u8> {
    let rows = columns[0].len();
    let kinds = NAMES
        .iter()
        .enumerate()
        .map(|(index, name)| ((*name).to_owned(), if index == 0 { ColumnKind::Text } else { ColumnKind::Number }));
    let (bytes, ends) = names(rows);
    let ends = ends.into_iter().map(|end| i32::try_from(end).expect("a short text")).collect();
    let values = std::iter::once(ResultValues::Texts { bytes, ends })
        .chain(columns.iter().map(|column| ResultValues::Numbers(doubles(column))));
    let columns = values.map(|values| ResultColumn { has_value: None, values }).collect();
    let memory = Memory::default();
    let mut file = ParquetRows::new(Box::new(memory.clone()), &kinds.collect::<Vec<_>>()).expect("memory");
    file.take(ResultColumns { columns, rows }).expect("memory");
    file.finish().expect("memory");
    memory.0.lock().map(|bytes| bytes.clone()).expect("nobody panics")
}

/// The rows that a batch writes.
fn judged(name: &str, bytes: Vec<u8>) -> String {
    let spec = Arc::new(Spec::parse("spec.toml", SPEC).expect("the spec is valid"));
    let want = spec.want();
    let container = Container::open(name, Source::bytes(bytes), &want).expect("it is known");
    let table = container.table(name, &want).expect("there is a header");
    let plan = Plan::new(&spec, &table, Request::default()).expect("the plan fits");
    let layout = Layout::new(&plan, &table).expect("the columns are there");
    let mut rows = Vec::new();
    let sink = RowSink::Text(Sink { writer: &mut rows, packing: Packing::None });
    let sinks = Sinks { rows: Some(sink), ..Sinks::default() };
    let mut batch = Batch::new(&plan, sinks, Some(3));
    batch.run(table, &layout, &AtomicBool::new(false), &mut |_| {}).expect("memory is readable");
    let (outcome, _) = batch.finish();
    assert_eq!(outcome.counts.rejected, 0);
    assert!(outcome.counts.pass > 1000 && outcome.counts.fail > 1000, "{:?}", outcome.counts);
    String::from_utf8(rows).expect("CSV is text")
}

/// 200,000 rows, a tenth of them with a size on its limit: the same rows come out, to the last digit.
#[test]
fn a_parquet_file_is_judged_like_its_text() {
    let columns = numbers(200_000);
    let (of_text, of_file) = (judged("parts.csv", csv(&columns)), judged("parts.parquet", parquet(&columns)));
    let differs = of_text.lines().zip(of_file.lines()).find(|(text, file)| text != file);
    assert_eq!(differs, None);
    assert_eq!(of_text.len(), of_file.len());
}

/// The same in memory, whether values are doubles or decimals.
#[test]
fn columns_in_memory_are_judged_like_text() {
    let columns = numbers(20_000);
    let of_text = judged("parts.csv", csv(&columns));
    let spec = Arc::new(Spec::parse("spec.toml", SPEC).expect("the spec is valid"));
    let titles = NAMES.map(str::to_owned);
    let evaluator = ColumnEvaluator::new(&spec, &[], Request::default());
    let of_doubles = |column: &Vec<i64>| Some(Stored::doubles(doubles(column)));
    let of_decimals = |column: &Vec<i64>| Some(Stored::integers(column.clone(), 4));
    let stored: [Vec<_>; 2] = [columns.iter().map(of_doubles).collect(), columns.iter().map(of_decimals).collect()];
    for stored in stored {
        let (bytes, ends) = names(20_000);
        let all: Vec<_> = std::iter::once(Some(Stored::texts(bytes, ends))).chain(stored).collect();
        let piece = ColumnPiece { name: "parts", before: 0, titles: &titles, columns: &all };
        let evaluated = evaluator.evaluate(&piece).expect("the columns are known");
        let at = evaluated.columns.iter().position(|(name, _)| name == "verdict").expect("it is written");
        let column = &evaluated.results.columns[at];
        let verdicts = (0..column.rows()).filter_map(|row| std::str::from_utf8(column.text(row)?).ok());
        let expected = of_text.lines().skip(1).map(|line| line.rsplit(',').nth(1).expect("there is one"));
        assert!(verdicts.eq(expected));
    }
}
