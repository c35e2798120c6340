mod rows;

use ::bytes::Bytes;
use ::parquet::basic::{BrotliLevel, GzipLevel, LogicalType, Repetition, TimeUnit, Type as Physical, ZstdLevel};
use ::parquet::column::writer::ColumnWriter;
use ::parquet::data_type::{ByteArray, FixedLenByteArray, Int96};
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::parser::parse_message_type;
use ::parquet::schema::types::Type;

use std::sync::Arc;

use crate::deviation::DeviationKind;
use crate::quantity::Unit;

use super::*;

/// The values of a column in a group, and where they stand: 1 for a value, 0 for none; nothing if each row has one.
#[derive(Clone)]
enum Stored<'v> {
    Doubles(&'v [f64], &'v [i16]),
    Floats(&'v [f32]),
    Ints(&'v [i32], &'v [i16]),
    Longs(&'v [i64]),
    Texts(&'v [&'v str], &'v [i16]),
    Bytes(&'v [&'v [u8]]),
    Fixed(&'v [&'v [u8]]),
    Bools(&'v [bool]),
    Old(&'v [u32]),
}

fn file(schema: Type, compression: Compression, groups: &[Vec<Stored<'_>>]) -> Vec<u8> {
    let properties = WriterProperties::builder().set_compression(compression).build();
    let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties)).unwrap();
    for columns in groups {
        let mut group = writer.next_row_group().unwrap();
        for column in columns {
            let mut open = group.next_column().unwrap().unwrap();
            write(open.untyped(), column);
            open.close().unwrap();
        }
        group.close().unwrap();
    }
    writer.into_inner().unwrap()
}

fn write(writer: &mut ColumnWriter<'_>, column: &Stored<'_>) {
    let some = |levels: &'_ [i16]| (!levels.is_empty()).then(|| levels.to_vec());
    let written = match (writer, column) {
        (ColumnWriter::DoubleColumnWriter(writer), Stored::Doubles(values, levels)) => {
            writer.write_batch(values, some(levels).as_deref(), None)
        }
        (ColumnWriter::FloatColumnWriter(writer), Stored::Floats(values)) => writer.write_batch(values, None, None),
        (ColumnWriter::Int32ColumnWriter(writer), Stored::Ints(values, levels)) => {
            writer.write_batch(values, some(levels).as_deref(), None)
        }
        (ColumnWriter::Int64ColumnWriter(writer), Stored::Longs(values)) => writer.write_batch(values, None, None),
        (ColumnWriter::BoolColumnWriter(writer), Stored::Bools(values)) => writer.write_batch(values, None, None),
        (ColumnWriter::ByteArrayColumnWriter(writer), Stored::Texts(values, levels)) => {
            let values: Vec<ByteArray> = values.iter().map(|text| ByteArray::from(*text)).collect();
            writer.write_batch(&values, some(levels).as_deref(), None)
        }
        (ColumnWriter::ByteArrayColumnWriter(writer), Stored::Bytes(values)) => {
            let values: Vec<ByteArray> = values.iter().map(|bytes| ByteArray::from(*bytes)).collect();
            writer.write_batch(&values, None, None)
        }
        (ColumnWriter::FixedLenByteArrayColumnWriter(writer), Stored::Fixed(values)) => {
            let values: Vec<FixedLenByteArray> = values.iter().map(|bytes| bytes.to_vec().into()).collect();
            writer.write_batch(&values, None, None)
        }
        (ColumnWriter::Int96ColumnWriter(writer), Stored::Old(values)) => {
            let mut moment = Int96::new();
            moment.set_data(values[0], values[1], values[2]);
            writer.write_batch(&[moment], None, None)
        }
        _ => panic!("the schema says otherwise"),
    };
    written.unwrap();
}

fn message(text: &str) -> Type {
    parse_message_type(text).unwrap()
}

fn decimal(text: &str) -> Content {
    Content::Number(Decimal::parse(text).unwrap())
}

fn opened(bytes: &[u8]) -> Result<ParquetTable, Diagnostic> {
    ParquetTable::open("lot.parquet", Bytes::from(bytes.to_vec()))
}

/// The cells of each column that can be read.
fn read_all(bytes: &[u8]) -> Result<Vec<Vec<Content>>, String> {
    let mut table = opened(bytes).map_err(|error| error.to_string())?;
    let mut all = vec![Vec::new(); table.columns.iter().filter(|column| column.is_read()).count()];
    let places = vec![true; all.len()];
    table.check().map_err(|error| error.to_string())?;
    while let Some(StoredRows { columns, .. }) =
        table.next(&places, ROWS_TOGETHER).map_err(|error| error.to_string())?
    {
        for (all, stored) in all.iter_mut().zip(columns.into_iter().flatten()) {
            all.extend((0..stored.rows()).map(|row| stored.cell(row).content));
        }
    }
    Ok(all)
}

#[test]
fn numbers_are_what_the_file_holds() {
    let schema = message(
        "message parts { optional double a; required float b; required int32 c (INTEGER(8, true)); \
         required int32 d (INTEGER(32, false)); required int64 e (INTEGER(64, false)); required int64 f; \
         required int32 g (DECIMAL(9, 4)); required int64 h (DECIMAL(18, 6)); \
         required fixed_len_byte_array(5) i (DECIMAL(10, 3)); required binary j (DECIMAL(38, 2)); }",
    );
    let fixed: [&[u8]; 3] = [&[0xff, 0xff, 0xff, 0xff, 0xfe], &[0, 0, 0, 0x61, 0xa8], &[0, 0, 0, 0, 0]];
    let beyond = [1; 17];
    let long: [&[u8]; 3] = [&[0x80], &[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7], &beyond];
    let group = vec![
        Stored::Doubles(&[25.0131, f64::NAN], &[1, 0, 1]),
        Stored::Floats(&[25.0131, -0.1, f32::INFINITY]),
        Stored::Ints(&[-128, 0, 127], &[]),
        Stored::Ints(&[-1, 0, i32::MIN], &[]),
        Stored::Longs(&[-1, 0, 1]),
        Stored::Longs(&[i64::MIN, i64::MAX, 12]),
        Stored::Ints(&[250_131, -5, 0], &[]),
        Stored::Longs(&[25_013_100, -1, 999_999_999_999_999_999]),
        Stored::Fixed(&fixed),
        Stored::Bytes(&long),
    ];
    let bytes = file(schema, Compression::UNCOMPRESSED, &[group]);
    let not_finite = || Content::Other("no finite number".into());
    let expected: [[Content; 3]; 10] = [
        [decimal("25.0131"), Content::Empty, not_finite()],
        [decimal("25.0131"), decimal("-0.1"), not_finite()],
        ["-128", "0", "127"].map(decimal),
        ["4294967295", "0", "2147483648"].map(decimal),
        [Content::Number(Decimal { negative: false, digits: u64::MAX, exponent: 0 }), decimal("0"), decimal("1")],
        ["-9223372036854775808", "9223372036854775807", "12"].map(decimal),
        ["25.0131", "-0.0005", "0.0000"].map(decimal),
        ["25.013100", "-0.000001", "999999999999.999999"].map(decimal),
        ["-0.002", "25.000", "0.000"].map(decimal),
        [decimal("-1.28"), decimal("0.07"), not_finite()],
    ];
    assert_eq!(read_all(&bytes).unwrap(), expected);
}

#[test]
fn texts_dates_and_what_is_no_measurement() {
    let nanoseconds = Type::primitive_type_builder("at", Physical::INT64)
        .with_repetition(Repetition::REQUIRED)
        .with_logical_type(Some(LogicalType::timestamp(true, TimeUnit::NANOS)))
        .build()
        .unwrap();
    let fields = message(
        "message parts { optional binary id (STRING); required binary plain; required boolean ok; \
         required int32 day (DATE); required int96 old; required fixed_len_byte_array(2) half (FLOAT16); \
         required group list (LIST) { repeated group list { required double element; } } \
         repeated double several; optional int32 none (UNKNOWN); }",
    );
    let mut fields = fields.get_fields().to_vec();
    fields.insert(5, Arc::new(nanoseconds));
    let schema = Type::group_type_builder("parts").with_fields(fields).build().unwrap();
    let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::default()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    let half: [&[u8]; 1] = [&[0, 0x3c]];
    for column in [
        Stored::Texts(&["Prüfling\n1"], &[1]),
        Stored::Texts(&["x"], &[]),
        Stored::Bools(&[true]),
        Stored::Ints(&[20_453], &[]),
        Stored::Old(&[0, 0, 2_440_589]),
        Stored::Longs(&[1_500_000_000]),
        Stored::Fixed(&half),
    ] {
        let mut open = group.next_column().unwrap().unwrap();
        write(open.untyped(), &column);
        open.close().unwrap();
    }
    for _ in 0..2 {
        let mut open = group.next_column().unwrap().unwrap();
        let ColumnWriter::DoubleColumnWriter(several) = open.untyped() else { panic!("doubles") };
        several.write_batch(&[1.0, 2.0], Some(&[1, 1]), Some(&[0, 1])).unwrap();
        open.close().unwrap();
    }
    let mut open = group.next_column().unwrap().unwrap();
    write(open.untyped(), &Stored::Ints(&[], &[0]));
    open.close().unwrap();
    group.close().unwrap();
    let bytes = writer.into_inner().unwrap();

    let table = opened(&bytes).unwrap();
    let not_read: Vec<_> =
        table.columns.iter().filter(|column| !column.is_read()).map(|column| column.name.as_str()).collect();
    assert_eq!(not_read, ["half", "list", "several"]);
    let other = |text: &str| vec![Content::Other(text.into())];
    let text = |text: &str| vec![Content::Text(text.into())];
    let expected = [
        text("Prüfling\n1"),
        text("x"),
        other("true"),
        other("2025-12-31"),
        other("1970-01-02 00:00:00"),
        other("1970-01-01 00:00:01.500"),
        vec![Content::Empty],
    ];
    assert_eq!(read_all(&bytes).unwrap(), expected);
}

#[test]
fn rows_come_in_pieces_whatever_their_groups() {
    let schema =
        message("message parts { required binary id (STRING); required int32 skipped; optional double value; }");
    let counts = [1, ROWS_TOGETHER, 0, 2 * ROWS_TOGETHER + 5];
    let values: Vec<f64> = (0..3 * ROWS_TOGETHER + 6).map(|row| f64::from(u32::try_from(row).unwrap()) / 8.0).collect();
    let ids = ["a", "b", "c"];
    for compression in [
        Compression::UNCOMPRESSED,
        Compression::SNAPPY,
        Compression::LZ4_RAW,
        Compression::GZIP(GzipLevel::default()),
        Compression::BROTLI(BrotliLevel::default()),
    ] {
        let mut groups = Vec::new();
        let texts: Vec<&str> = (0..values.len()).map(|row| ids[row % 3]).collect();
        let (ints, levels) = (vec![7; values.len()], vec![1; values.len()]);
        let mut start = 0;
        for count in counts {
            let rows = start..start + count;
            groups.push(vec![
                Stored::Texts(&texts[rows.clone()], &[]),
                Stored::Ints(&ints[rows.clone()], &[]),
                Stored::Doubles(&values[rows.clone()], &levels[rows]),
            ]);
            start += count;
        }
        let bytes = file(schema.clone(), compression, &groups);
        let numbers: Vec<_> = values.iter().map(|value| Content::of_f64(*value)).collect();
        let texts: Vec<_> = texts.iter().map(|text| Content::of_text(text)).collect();
        let ints = vec![decimal("7"); numbers.len()];
        let mut table = opened(&bytes).unwrap();
        let mut sizes = Vec::new();
        while let Some(StoredRows { columns, before }) = table.next(&[true, false, true], ROWS_TOGETHER).unwrap() {
            let rows = columns[0].as_ref().unwrap().rows();
            sizes.push((before, rows));
            let last = usize::try_from(before).unwrap() + rows - 1;
            for (column, all) in columns.iter().zip([Some(&texts), None, Some(&numbers)]) {
                let found = column.as_ref().map(|column| column.cell(rows - 1).content);
                assert_eq!(found.as_ref(), all.map(|all| &all[last]));
            }
        }
        let full = ROWS_TOGETHER as u64;
        let starts = [0, 1, full + 1, 2 * full + 1, 3 * full + 1];
        let counts = [1, ROWS_TOGETHER, ROWS_TOGETHER, ROWS_TOGETHER, 5];
        assert!(starts.into_iter().zip(counts).eq(sizes));
        assert_eq!(read_all(&bytes).unwrap(), [texts, ints, numbers], "{compression}");
    }
}

#[test]
fn a_page_that_is_broken_is_refused() {
    let schema = message("message parts { required double a; required double b; }");
    let first: Vec<f64> = (0..100).map(f64::from).collect();
    let group = vec![Stored::Doubles(&first, &[]), Stored::Doubles(&first, &[])];
    let mut bytes = file(schema, Compression::UNCOMPRESSED, &[group]);
    // the first column's page
    bytes[4..40].fill(0xff);
    assert!(read_all(&bytes).unwrap_err().contains("cannot read lot.parquet: "));
}

#[test]
fn a_file_on_disk_is_read_like_one_in_memory() {
    let schema = message("message parts { required double a; required double b; }");
    let group = vec![Stored::Doubles(&[1.0, 2.0], &[]), Stored::Doubles(&[3.0, 4.0], &[])];
    let bytes = file(schema, Compression::SNAPPY, &[group]);
    let path = std::env::temp_dir().join(format!("rackmesh-table-{}.parquet", std::process::id()));
    std::fs::write(&path, &bytes).unwrap();
    let mut table = ParquetTable::open("lot.parquet", std::fs::File::open(&path).unwrap()).unwrap();
    let StoredRows { columns, .. } = table.next(&[true, true], ROWS_TOGETHER).unwrap().unwrap();
    std::fs::remove_file(&path).unwrap();
    let cells = columns.iter().flatten().map(|column| [0, 1].map(|row| column.cell(row).content));
    assert_eq!(cells.collect::<Vec<_>>(), [["1", "2"].map(decimal), ["3", "4"].map(decimal)]);
}

#[test]
fn what_cannot_be_read_says_why() {
    let schema = || message("message parts { required double a; }");
    let group = || vec![Stored::Doubles(&[1.0, 2.0, 3.0], &[])];
    let bytes = file(schema(), Compression::SNAPPY, &[group()]);
    let problem = |bytes: &[u8]| read_all(bytes).unwrap_err();
    let mut encrypted = bytes.clone();
    let end = encrypted.len() - 4;
    encrypted[end..].copy_from_slice(b"PARE");
    assert_eq!(problem(&encrypted), "error[file-access]: cannot read lot.parquet: it is encrypted");
    assert_eq!(problem(b"a;b\n1;2\n"), "error[file-access]: cannot read lot.parquet: it is no Parquet file");
    assert_eq!(problem(b""), "error[file-access]: cannot read lot.parquet: it is no Parquet file");
    assert!(problem(&bytes[..end]).contains("it is a Parquet file whose end is missing"));
    assert!(problem(b"PAR1").contains("cannot read lot.parquet: "));
}

#[test]
fn a_codec_that_is_not_read_is_named() {
    for (compression, name) in [(Compression::ZSTD(ZstdLevel::default()), "ZSTD"), (Compression::LZO, "LZO")] {
        assert_eq!(codec_not_read(compression).map(ToString::to_string).as_deref(), Some(name));
    }
    assert_eq!(codec_not_read(Compression::LZ4), None);
}

/// Why a file is refused whose column is packed so.
#[test]
fn how_a_column_is_packed_matters_unless_a_rule_leaves_it_out() {
    use crate::table::{Container, Source, Want};
    let of = ::parquet::schema::types::ColumnPath::from("operator");
    for encoding in [Encoding::DELTA_BYTE_ARRAY, Encoding::DELTA_LENGTH_BYTE_ARRAY] {
        let builder = WriterProperties::builder().set_column_dictionary_enabled(of.clone(), false);
        let properties = builder.set_column_encoding(of.clone(), encoding).build();
        let schema = message("message parts { required double rack_pitch_um; required binary operator (STRING); }");
        let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties)).unwrap();
        let mut group = writer.next_row_group().unwrap();
        for column in [Stored::Doubles(&[1.0], &[]), Stored::Texts(&["12"], &[])] {
            let mut open = group.next_column().unwrap().unwrap();
            write(open.untyped(), &column);
            open.close().unwrap();
        }
        group.close().unwrap();
        let (bytes, want) = (writer.into_inner().unwrap(), Want::default());
        let container = Container::open("lot.parquet", Source::bytes(bytes), &want).unwrap();
        let problems = container.table("lot.parquet", &want).err().unwrap();
        let expected = format!("column `operator`: it is packed by {encoding}, which is not read");
        assert!(problems.0[0].list.iter().any(|line| line.text == expected), "{problems}");
    }
}

#[test]
fn a_type_that_is_not_read_needs_a_rule() {
    use crate::table::{Container, Layout, Pattern, Source, Want};
    let found = |ignore: &[&str]| {
        let schema = message(
            "message parts { required double rack_pitch; required group operator { required fixed_len_byte_array(12) of \
             (INTERVAL); } }",
        );
        let columns = vec![Stored::Doubles(&[1.0], &[]), Stored::Fixed(&[&[0; 12]])];
        let bytes = file(schema, Compression::SNAPPY, &[columns]);
        let ignore = ignore.iter().map(|pattern| Pattern::of_heading(pattern)).collect();
        let want = Want { layout: Layout { ignore, ..Layout::default() }.into(), ..Want::default() };
        let container = Container::open("lot.parquet", Source::bytes(bytes), &want).unwrap();
        container.table("lot.parquet", &want).map(drop).map_err(|problems| problems.0[0].message_with_list())
    };
    let refused = found(&[]).unwrap_err();
    assert!(refused.contains("column `operator.of`: it is of type INTERVAL"), "{refused}");
    assert_eq!(found(&["operator.*"]), Ok(()));
}

/// The fields of a record are called by their path; one whose record is not there has no value.
#[test]
fn fields_of_records() {
    let schema = "message parts { required binary part_id (STRING); optional group rack { optional double pitch; } }";
    let columns = vec![Stored::Texts(&["P1", "P2", "P3"], &[]), Stored::Doubles(&[0.003], &[2, 1, 0])];
    let bytes = file(message(schema), Compression::SNAPPY, &[columns]);
    let declared = crate::table::DeclaredColumn::new(
        DeviationKind::RackPitch,
        Some("rack.pitch".to_owned()),
        Unit::from_symbol("mm"),
        Vec::new(),
    );
    let layout = crate::table::Layout { columns: vec![declared], ..crate::table::Layout::default() };
    assert_eq!(parts_by(&bytes, layout), ["P1: 0.003 mm", "P2: missing", "P3: missing"]);
}

/// As CMM programs export it.
#[test]
fn a_file_with_a_row_per_characteristic() {
    let schema = message(
        "message parts { required binary part (STRING); required binary characteristic (STRING); \
         required double actual; required double nominal; required binary unit (STRING); }",
    );
    let group = vec![
        Stored::Texts(&["P1", "P1", "P2", "P2"], &[]),
        Stored::Texts(&["rack_over_roller", "rack_pitch", "rack_over_roller", "rack_pitch"], &[]),
        Stored::Doubles(&[25.013, 0.012, 24.99, 0.001], &[]),
        Stored::Doubles(&[25.0, 0.0, 25.0, 0.0], &[]),
        Stored::Texts(&["mm"; 4], &[]),
    ];
    let bytes = file(schema, Compression::SNAPPY, &[group]);
    assert_eq!(parts(&bytes), ["P1: 0.013 mm", "P2: -0.01 mm"]);
}

#[test]
fn bytes_that_are_changed_are_refused_or_read() {
    let schema = message(
        "message parts { optional binary id (STRING); required double a; required int32 b (DECIMAL(9, 4)); \
         required fixed_len_byte_array(3) c (DECIMAL(6, 2)); required boolean d; required int64 e; }",
    );
    let fixed: [&[u8]; 4] = [&[1, 2, 3]; 4];
    let group = vec![
        Stored::Texts(&["P1", "P2", "P1"], &[1, 1, 0, 1]),
        Stored::Doubles(&[1.0, 2.0, 3.0, 4.5], &[]),
        Stored::Ints(&[1, 2, 3, 4], &[]),
        Stored::Fixed(&fixed),
        Stored::Bools(&[true, false, true, true]),
        Stored::Longs(&[5, 6, 7, 8]),
    ];
    for compression in [Compression::SNAPPY, Compression::BROTLI(BrotliLevel::default())] {
        let bytes = file(schema.clone(), compression, std::slice::from_ref(&group));
        assert!(read_all(&bytes).is_ok());
        for at in 0..bytes.len() {
            for change in [0x01, 0x80, 0xff] {
                let mut changed = bytes.clone();
                changed[at] ^= change;
                let _ = read_all(&changed);
            }
        }
    }
}

/// Each row of a file as a table: the part, and its value or why there is none.
fn parts(bytes: &[u8]) -> Vec<String> {
    parts_by(bytes, crate::table::Layout::default())
}

/// The same by a contract.
fn parts_by(bytes: &[u8], layout: crate::table::Layout) -> Vec<String> {
    use crate::table::{Container, Source, Want};
    let want = Want { layout: layout.into(), ..Want::default() };
    let table = Container::open("lot.csv", Source::bytes(bytes.to_vec()), &want).unwrap();
    let table = table.table("lot.csv", &want).unwrap();
    assert_eq!(table.reading.format, "Parquet");
    let mut parts = Vec::new();
    for block in table.blocks().unwrap() {
        for row in 0..block.rows() {
            let name = block.name(row).unwrap_or_default();
            let fault = block.faults().iter().find(|fault| fault.row == row);
            parts.push(match fault {
                Some(fault) if fault.is_missing => format!("{name}: missing"),
                Some(fault) => format!("{name}: {}", fault.message),
                None => format!("{name}: {}", block.values(0).at(row)),
            });
        }
    }
    parts
}
