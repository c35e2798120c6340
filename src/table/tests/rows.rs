//! Rows of text: the fast case is a case of the general one, and a long table is read like a short one.

use proptest::prelude::*;

use super::*;
use crate::diagnostic::Source as Text;
use crate::table::chunk::ChunkContent;
use crate::table::rows::Setup;
use crate::table::understand::understand;

/// The reader of the rows of a table that begins so.
fn rows(start: &str, want: &Want) -> Rows {
    let source = Arc::new(Text::new("block", start));
    let understood = understand(&source, want).unwrap();
    let needed = vec![true; understood.columns.len()];
    Rows::new(
        Setup { separator: b',', is_even: true, ..Setup::of(&understood, want) },
        Wanted { needed, keeps_raw: true, ..Wanted::default() },
    )
}

/// Everything that a block says, as text.
fn said(rows: &Rows, bytes: &[u8]) -> Vec<String> {
    let mut block = Block::default();
    rows.chunk(&mut bytes.to_vec(), ChunkContent::Records, 0, &mut block);
    let mut said: Vec<String> = (0..block.rows())
        .map(|row| {
            let raw = String::from_utf8_lossy(block.raw(row).unwrap()).into_owned();
            format!("{} {} {raw:?} {}", block.lines[row], block.records[row], part(&block, row, &["a", "b"]))
        })
        .collect();
    said.extend(block.asides.iter().map(|aside| format!("{} {}", aside.line, aside.text)));
    said.push(format!("{} {} {}", block.record_count, block.line_count, block.blank_lines));
    said.push(format!("{:?}", block.contradiction));
    said
}

fn field() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => "-?[0-9]{1,3}(\\.[0-9]{1,6})?",
        1 => "[-+]?[0-9]{0,20}[.]?[0-9]{0,20}",
        1 => "[0-9.,'eE+ -]{0,8}",
        1 => "P[0-9]{1,3}|Mean|mean |min|n\\.a\\.|-|part|rack_pitch| ?[0-9]+ (um|mm)|[0-9]+um|1_000",
        1 => "[ -!#-~]{0,6}",
        1 => "\"-?[0-9]{1,2}[.][0-9]{1,4}\"",
        1 => "\"[ -~\n]{0,6}\"",
        1 => "[ -~]{0,4}",
    ]
}

fn line() -> impl Strategy<Value = String> {
    let cells = prop_oneof![8 => proptest::collection::vec(field(), 3), 1 => proptest::collection::vec(field(), 0..6)];
    (cells, prop_oneof![6 => Just("\n"), 1 => Just("\r\n")]).prop_map(|(cells, end)| cells.join(",") + end)
}

/// A remark that is behind the start of a table is looked at where it has a digit.
#[test]
fn a_value_in_a_remark_ends_the_rows() {
    let rows = rows("part,rack_pitch [um],note\nP1,5,ok\nP2,6,\n", &want());
    let contradiction = |line: &str| {
        let mut block = Block::default();
        rows.chunk(&mut line.as_bytes().to_vec(), ChunkContent::Records, 0, &mut block);
        block.contradiction.map(|contradiction| contradiction.column)
    };
    assert_eq!(contradiction("P3,5,corrected to 12.5 um\n"), Some("note".to_owned()));
    assert_eq!(contradiction("P3,5,scratch\nP4,5,shift 2\n"), None);
}

#[test]
fn copied_cells_stay_with_their_rows() {
    let start = "part,rack_pitch,note\nP1,0.5,a\n";
    let source = Arc::new(Text::new("block", start));
    let understood = understand(&source, &want()).unwrap();
    let wanted = Wanted { needed: vec![true], copied: vec![0, 2], keeps_raw: false };
    let rows = Rows::new(Setup { separator: b',', is_even: true, ..Setup::of(&understood, &want()) }, wanted);
    let mut block = Block::default();
    let bytes = b"P1,0.5,a\nP2,0.5,b,too,many\n\"P3\",0.5,c\nP4,x,d\nP5,0.5,\"open";
    rows.chunk(&mut bytes.to_vec(), ChunkContent::Records, 0, &mut block);
    let copied = |row: usize| [0, 1].map(|number| String::from_utf8_lossy(block.copied(row, number).unwrap()));
    let expected = [["P1", "a"], ["", ""], ["P3", "c"], ["P4", "d"], ["", ""]];
    assert_eq!((0..block.rows()).map(copied).collect::<Vec<_>>(), expected);
}

proptest! {
    #[test]
    fn a_plain_line_is_read_like_any_other(lines in proptest::collection::vec(line(), 1..12)) {
        let bytes = lines.concat().into_bytes();
        let deviations = asks(&[DeviationKind::RackPitch, DeviationKind::PinionPitch]);
        let module = Want { module: Some("2".parse().unwrap()), ..want() };
        for (start, want) in [
            ("part,rack_pitch,pinion_pitch\nP1,0.5,1.5\n", &deviations),
            ("part,rack_pitch [um],pinion_pitch [in]\nP1,5,1\n", &deviations),
            ("part,rack_over_roller,rack_pitch_um\nP1,25.01,2.5\n", &module),
            ("rack_pitch,note,pinion_pitch\n5,a,1\n", &deviations),
        ] {
            let rows = rows(start, want);
            prop_assert_eq!(said(&rows, &bytes), said(&rows.clone().without_plain_lines(), &bytes), "{}", start);
        }
    }
}

/// A table that is longer than what it is understood from.
fn long(header: &str, row: impl Fn(usize) -> String) -> String {
    let rows: String = (0..9000).map(|number| row(number) + "\n").collect();
    format!("{header}\n{rows}")
}

#[test]
fn a_long_table_is_read_like_a_short_one() {
    let want = asks(&[DeviationKind::RackPitch]);
    for (header, separator, comma) in [
        ("part,rack_pitch [um]", ",", false),
        ("Teil;Bemerkung;Teilung Zahnstange [µm]", ";x;", true),
        ("sep=\t\nTeil\tTeilung Zahnstange [µm]", "\t", true),
        ("Hallo,\n\nTeil;Teilung Zahnstange\n;[µm]", ";", true),
    ] {
        let text = long(header, |number| {
            let value = format!("{}.{}", number % 50, number % 10);
            format!("P{number}{separator}{}", if comma { value.replace('.', ",") } else { value })
        });
        let found = read(&text, &want).unwrap();
        assert_eq!(found.parts.len(), 9000, "{header}");
        assert_eq!(found.parts[8123], "P8123: rack_pitch 0.0233 mm", "{header}");
        assert_eq!(found.reading.decimal_mark, Some(if comma { "comma" } else { "point" }));
    }
}

#[test]
fn a_single_column_of_any_length() {
    let want = asks(&[DeviationKind::RackPitch]);
    for (mark, name) in [(".", "point"), (",", "comma")] {
        let text = long("Teilung Zahnstange [µm]", |number| format!("{}{mark}{}", number % 50, number % 10));
        let found = read(&text, &want).unwrap();
        assert_eq!((found.parts.len(), found.reading.decimal_mark), (9000, Some(name)));
        assert_eq!(found.parts[8123], "rack_pitch 0.0233 mm");
    }
}

#[test]
fn what_contradicts_the_start_of_a_long_table_ends_it() {
    let want = asks(&[DeviationKind::RackPitch]);
    let value = |number: usize, other: &str| if number == 8000 { other.to_owned() } else { (number % 50).to_string() };
    // nothing before it has decimals
    for (other, message) in
        [("1.234", "`1.234` could be 1.234 or 1234, and nothing before it tells which"), ("1,5", "has a decimal comma")]
    {
        let text = long("part;rack_pitch [um]", |number| format!("P{number};{}", value(number, other)));
        let found = read(&text, &want).unwrap().parts;
        let contradiction = found.last().unwrap();
        assert!(contradiction.contains("contradiction: ") && contradiction.contains(message), "{contradiction}");
    }
    let text =
        long("part;rack_pitch [um]", |number| format!("P{number};{}", value(number, "1,5")).replace("49", "4.9"));
    assert!(read(&text, &want).unwrap().parts.last().unwrap().contains("has a decimal comma"));
}

#[test]
fn headers_again_and_statistics_are_no_parts() {
    let text = "part;rack_pitch\n;[mm]\nP1;0.01\npart;rack_pitch\n;[mm]\nP2;0.02\nMittelwert;0.015\nP3;0.04\nStd. dev;0.015\nmax:;0.04\n";
    let found = parts(text, &asks(&[DeviationKind::RackPitch]));
    assert_eq!(found, ["P1: rack_pitch 0.01 mm", "P2: rack_pitch 0.02 mm", "P3: rack_pitch 0.04 mm"]);
}
