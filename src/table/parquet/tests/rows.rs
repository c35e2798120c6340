//! Files as tables of parts.

use super::*;

#[test]
fn a_file_as_a_table() {
    let ids = Stored::Texts(&["P1", "P2", "P3", "P4"], &[]);
    let schema = |column: &str| message(&format!("message parts {{ required binary part_id (STRING); {column} }}"));
    for (column, values, expected) in [
        // the shortest decimal of a double, and that of a float, not of the double that it becomes
        (
            "required double rack_pitch_um;",
            Stored::Doubles(&[12.3, 0.1 + 0.2, -1e-3, f64::NAN], &[]),
            ["P1: 0.0123 mm", "P2: 0.0003 mm", "P3: -0.000001 mm", "P4: `no finite number` is not a number"],
        ),
        (
            "required float rack_pitch;",
            Stored::Floats(&[0.0131, -0.1, 1e5, f32::INFINITY]),
            ["P1: 0.0131 mm", "P2: -0.1 mm", "P3: 100000 mm", "P4: `no finite number` is not a number"],
        ),
        (
            "required int32 rack_pitch (DECIMAL(9, 4));",
            Stored::Ints(&[131, -5, 0, 250_131], &[]),
            ["P1: 0.0131 mm", "P2: -0.0005 mm", "P3: 0 mm", "P4: 25.0131 mm"],
        ),
        (
            "optional int32 rack_pitch_um;",
            Stored::Ints(&[13, -5, 7], &[1, 1, 0, 1]),
            ["P1: 0.013 mm", "P2: -0.005 mm", "P3: missing", "P4: 0.007 mm"],
        ),
        (
            "optional double rack_pitch;",
            Stored::Doubles(&[0.5], &[0, 0, 1, 0]),
            ["P1: missing", "P2: missing", "P3: 0.5 mm", "P4: missing"],
        ),
        (
            "required binary rack_pitch_um (STRING);",
            Stored::Texts(&["12", "13 µm", "n.a.", "x"], &[]),
            ["P1: 0.012 mm", "P2: 0.013 mm", "P3: missing", "P4: `x` is not a number alone"],
        ),
    ] {
        let ids = match &ids {
            Stored::Texts(texts, levels) => Stored::Texts(texts, levels),
            _ => panic!("texts"),
        };
        let bytes = file(schema(column), Compression::SNAPPY, &[vec![ids, values]]);
        assert_eq!(parts(&bytes), expected, "{column}");
    }
}

/// Of a file with thousands of columns, some are open at once, and few rows are looked at.
#[test]
fn a_wide_file_is_looked_into_piece_by_piece() {
    use crate::table::cell::head_rows;
    let count = 4 * COLUMNS_TOGETHER + 1;
    let fields = |count: usize| (0..count).map(|at| format!("required double c{at}; ")).collect::<Vec<_>>().concat();
    let values = [1.0, 2.0, 3.0];
    let group = (0..count).map(|_| Stored::Doubles(&values, &[])).collect();
    let schema = |count: usize| message(&format!("message parts {{ {}}}", fields(count)));
    let bytes = file(schema(count), Compression::SNAPPY, &[group]);
    let mut table = ParquetTable::open("lot.parquet", Bytes::from(bytes)).unwrap();
    let (columns, rows) = table.head(2).unwrap();
    assert_eq!((columns.len(), columns.iter().flatten().count(), rows), (count, count, 2));
    assert!(table.open.iter().flatten().count() <= COLUMNS_TOGETHER);
    assert_eq!([1, 1000, 20_000, 1 << 20].map(head_rows), [400, 65, 3, 1]);
    let mut large = vec![0; LARGEST_FOOTER as usize + 100];
    large[..4].copy_from_slice(b"PAR1");
    large.extend((LARGEST_FOOTER + 1).to_le_bytes());
    large.extend(b"PAR1");
    let refused = ParquetTable::open("lot.parquet", Bytes::from(large)).err().unwrap().sentence();
    assert!(refused.contains("row groups is larger than 4 MiB; write it with larger row groups"), "{refused}");
    let bytes = file(schema(MOST_COLUMNS + 1), Compression::SNAPPY, &[]);
    let refused = ParquetTable::open("lot.parquet", Bytes::from(bytes)).err().unwrap().sentence();
    assert!(
        refused.contains("it has 10001 columns, and at most 10000 are read; write it with the columns"),
        "{refused}"
    );
}
