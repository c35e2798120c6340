//! Rows of text: the fast case is a case of the general one, and a long table is read like a short one.

use proptest::prelude::*;

use super::*;
use crate::table::chunk::ChunkContent;

/// The reader of the rows of a table that begins so.
fn rows(start: &str, want: &Want, wanted: Wanted) -> Rows {
    let source = Source::bytes(start.as_bytes().to_vec());
    let want = Want { layout: Layout { separator: Some(b','), ..Layout::clone(&want.layout) }.into(), ..want.clone() };
    let table = Container::open("block", source, &want).unwrap().table("block", &want).unwrap();
    table.pieces.open(wanted).0
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
        1 => "P[0-9]{1,3}|Mean|Stück|nan|ー|mean |min|n\\.a\\.|-|part|rack_pitch| ?[0-9]+ (um|mm)|[0-9]+um|1_000",
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

#[test]
fn copied_cells_stay_with_their_rows() {
    let start = "part,rack_pitch,note\nP1,0.5,a\n";
    let wanted = Wanted { copied: vec![0, 2], keeps_raw: false };
    let notes = by(|layout| layout.ignore = vec![Pattern::of_heading("note")]);
    let rows = rows(start, &notes, wanted);
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
        let notes = by(|layout| layout.ignore = vec![Pattern::of_heading("note")]);
        let module = Want { module: Some("2".parse().unwrap()), ..want() };
        for (start, want) in [
            ("part,rack_pitch,pinion_pitch\nP1,0.5,1.5\n", &notes),
            ("part,rack_pitch [um],pinion_pitch [in]\nP1,5,1\n", &notes),
            ("part,rack_over_roller,rack_pitch_um\nP1,25.01,2.5\n", &module),
            ("rack_pitch,note,pinion_pitch\n5.1,a,1\n", &notes),
        ] {
            let rows = rows(start, want, Wanted { keeps_raw: true, ..Wanted::default() });
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
    let want = by(|layout| layout.ignore = vec![Pattern::of_heading("Bemerkung")]);
    for (header, separator, comma) in [
        ("part,rack_pitch [um]", ",", false),
        ("Teil;Bemerkung;Zahnstangenteilung [µm]", ";x;", true),
        ("sep=\t\nTeil\tZahnstangenteilung [µm]", "\t", true),
        ("Teil;Zahnstangenteilung\n;[µm]", ";", true),
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
    let want = want();
    for (mark, name) in [(".", "point"), (",", "comma")] {
        let text = long("Zahnstangenteilung [µm]", |number| format!("{}{mark}{}", number % 50, number % 10));
        let found = read(&text, &want).unwrap();
        assert_eq!((found.parts.len(), found.reading.decimal_mark), (9000, Some(name)));
        assert_eq!(found.parts[8123], "rack_pitch 0.0233 mm");
    }
}

#[test]
fn another_mark_far_down_rejects_its_row() {
    let value = |number: usize, other: &str| if number == 8000 { other.to_owned() } else { (number % 50).to_string() };
    // nothing before it has decimals
    let text = long("part;rack_pitch [um]", |number| format!("P{number};{}", value(number, "1,5")));
    let found = read(&text, &want()).unwrap().parts;
    assert!(
        found[8000].contains("`1,5` has decimals, and no number before it tells the decimal mark"),
        "{}",
        found[8000]
    );
    let text =
        long("part;rack_pitch [um]", |number| format!("P{number};{}", value(number, "1,5")).replace("49", "4.9"));
    let found = read(&text, &want()).unwrap().parts;
    assert!(found[8000].contains("has a comma, and the table's numbers have a decimal point"), "{}", found[8000]);
    assert_eq!(found.iter().filter(|part| part.contains("`1,5`")).count(), 1);
}

#[test]
fn headings_again_are_no_parts_and_other_headings_end_the_table() {
    let text = "part;rack_pitch\n;[mm]\nP1;0.01\npart;rack_pitch\n;[mm]\nP2;0.02\nMittelwert;0.015\n";
    let means =
        by(|layout| layout.ignore_lines = vec![LineRule { pattern: Pattern::of_line("Mittelwert;*"), at_most: 1 }]);
    assert_eq!(parts(text, &means), ["P1: rack_pitch 0.01 mm", "P2: rack_pitch 0.02 mm"]);
    let twice = parts(&format!("{text}Mittelwert;0.016\n"), &means);
    assert!(
        twice.last().unwrap().contains("contradiction: a rule leaves out a line that could be a part"),
        "{twice:?}"
    );
    let other = parts(&format!("{text}part;pinion_pitch\nP3;0.1\n"), &means);
    assert!(other.last().unwrap().contains("contradiction: another heading stands here"), "{other:?}");
}
