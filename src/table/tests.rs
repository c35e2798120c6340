//! The reader of tables as a whole: bytes in, parts and how they were read out.

mod characteristics;
mod closure;
mod containers;
mod rows;
mod teeth;
mod workbook_xml;

use super::*;
use crate::deviation::DeviationValue;
use crate::diagnostic::{Diagnostic, Diagnostics};

/// A table that was read.
#[derive(Debug)]
struct Read {
    reading: Reading,
    /// Each part: `name: error deviation, …`, with what is wrong in place of a value.
    parts: Vec<String>,
}

/// A spec of a rack: the measure over the roller, with its nominal value.
fn want() -> Want {
    let nominal = DeviationValue::Length("25".parse().unwrap());
    Want { given: vec![given(DeviationKind::RackOverRoller, Some(nominal))], ..Want::default() }
}

/// The same, with what a contract says besides.
fn by(contract: impl Fn(&mut Layout)) -> Want {
    let mut layout = Layout::default();
    contract(&mut layout);
    Want { layout: layout.into(), ..want() }
}

fn given(kind: DeviationKind, nominal: Option<DeviationValue>) -> GivenColumn {
    GivenColumn { kind, unit: None, holds: None, nominal: nominal.map(Ok), length: None }
}

/// Reads a file; what is wrong with it comes as messages, each with what to do.
fn read_file(name: &str, bytes: &[u8], want: &Want) -> Result<Read, String> {
    let in_words = |Diagnostics(problems): Diagnostics| {
        let each = |problem: &Diagnostic| {
            format!("{problem} | {} | {}", problem.message_with_list(), problem.help.clone().unwrap_or_default())
        };
        problems.iter().map(each).collect::<Vec<_>>().join("\n")
    };
    let container = Container::open(name, Source::bytes(bytes.to_vec()), want).map_err(in_words)?;
    let table = container.table(name, want).map_err(in_words)?;
    let reading = table.reading.clone();
    let keys: Vec<_> =
        table.columns.iter().map(|column| column.kind.map_or(column.field.key(), DeviationKind::key)).collect();
    let mut parts = Vec::new();
    for block in table.blocks().map_err(|error| error.to_string())? {
        parts.extend((0..block.rows()).map(|row| part(&block, row, &keys)));
        parts.extend(block.contradiction.map(|contradiction| format!("contradiction: {}", contradiction.message)));
    }
    Ok(Read { reading, parts })
}

fn part(block: &Block, row: usize, keys: &[&str]) -> String {
    let mut words: Vec<String> = block.name(row).map(|name| format!("{name}:")).into_iter().collect();
    let fault = |column| block.faults().iter().find(|fault| (fault.row, fault.column) == (row, column));
    words.extend(block.index.get(row).copied().flatten().map(|index| format!("{index}:")));
    if let Some(fault) = fault(None) {
        words.push(format!("{}: `{}`", fault.message, fault.text));
        return words.join(" ");
    }
    for (column, key) in keys.iter().enumerate() {
        words.push(match fault(Some(column)) {
            Some(fault) if fault.is_missing => format!("{key} missing"),
            Some(fault) => format!("{key}: {}", fault.message),
            None => format!("{key} {}", block.values(column).at(row)),
        });
    }
    words.join(" ")
}

fn read(text: &str, want: &Want) -> Result<Read, String> {
    read_file("block", text.as_bytes(), want)
}

/// The parts of a text, or why there are none.
fn parts(text: &str, want: &Want) -> Vec<String> {
    read(text, want).map_or_else(|problem| vec![problem], |read| read.parts)
}

/// How a text is read.
fn reading(text: &str, want: &Want) -> Reading {
    read(text, want).unwrap_or_else(|problem| panic!("{text}: {problem}")).reading
}

/// Why a text is refused.
fn refused(text: &str, want: &Want) -> String {
    read(text, want).err().unwrap_or_else(|| panic!("{text} is read as {:?}", parts(text, want)))
}

#[test]
fn the_same_part_however_it_is_written() {
    for text in [
        "rack_over_roller,rack_pitch\n25.013,0.012\n",
        "rack_over_roller;rack_pitch\r\n25,013;0,012\r\n",
        "Rollenmaß [mm]\tTeilungsabweichung Zahnstange [µm]\n25,013\t12\n",
        "Rack over roller (mm)  rack pitch (um)\n25,013            12,0\n",
        "| rack over roller [mm] | rack pitch [um] |\n|---|---|\n| 25.013 mm | 12 µm |\n",
        "\"Rollenmaß\n[mm]\"\t\"Zahnstangenteilung\n[µm]\"\n25,013\t12,0\n",
        "Rollenmaß\tZahnstangenteilung\nmm\tµm\n25,013\t12\n",
        "rack_over_roller\t25,013\nrack_pitch\t0,012\n",
        "rack over roller deviation [µm],rack pitch [µm]\n13,12\n",
        "rack_over_roller [cm],rack_pitch [1/1000 mm]\n2.5013,12\n",
        "rack_over_roller [millimètre];rack_pitch [0,001mm]\n25,013;12\n",
    ] {
        assert_eq!(parts(text, &want()), ["rack_over_roller 0.013 mm rack_pitch 0.012 mm"], "{text}");
    }
}

#[test]
fn several_parts_in_rows_or_columns() {
    let expected =
        ["a1: rack_over_roller 0.013 mm rack_pitch 0.012 mm", "a2: rack_over_roller -0.02 mm rack_pitch 0 mm"];
    for text in [
        "Teil;Rollenmaß [mm];rack pitch [µm]\na1;25,013;12\na2;24,98;0\n",
        "part  rack over roller (mm)  rack pitch [um]\na1    25.013                 12\na2    24.98                  0",
        "part\ta1\ta2\nrack over roller [mm]\t25.013\t24.98\nrack pitch [µm]\t12\t0\n",
    ] {
        assert_eq!(parts(text, &want()), expected, "{text}");
    }
}

#[test]
fn what_has_no_owner_is_listed_at_once() {
    let text = "Protokoll 7\nTeil;Rollenmaß;CHR_017;Temp [°C]\nP1;25,013;12;20\nMittelwert;25,013;12;20\n";
    let found = refused(text, &want());
    for said in [
        "line 1: Protokoll 7",
        "column `CHR_017`: 12",
        "column `Temp [°C]`: 20",
        "`Rollenmaß` is rack_over_roller, and nothing tells its unit",
    ] {
        assert!(found.contains(said), "{said}: {found}");
    }
}

#[test]
fn a_row_is_rejected_with_its_place() {
    let want = by(|layout| layout.ignore = vec![Pattern::of_heading("Temp")]);
    let text = "nr;rack_over_roller;rack_pitch [um];Temp\n1;25.013;12;20\n2;25.0l3;5;20\n3;;5;20\n4;13;5;20\n5;25,1;0;20\n\
                6;25 ±0.02;0;20\n7;25;1;2;9\nMittelwert;25;1;20\n;25;1;20\n8;25 mm;1 um;20\n9;1 in;1;20\n10;25.02;1;20\n";
    let text = text.replace("nr;", "part_id;");
    let expected = [
        "1: rack_over_roller 0.013 mm rack_pitch 0.012 mm",
        "2: rack_over_roller: `25.0l3` is not a number alone",
        "3: rack_over_roller missing rack_pitch 0.005 mm",
        "4: rack_over_roller: 13 mm is far from the nominal value 25 mm",
        "5: rack_over_roller: `25,1` has a comma, and the table's numbers have a decimal point",
        "6: rack_over_roller: `25 ±0.02` is not a number alone",
        ": `9` stands in column 5, which has no heading",
        ": `Mittelwert` is no part's name",
        ": the part has no name",
        "8: rack_over_roller 0 mm rack_pitch 0.001 mm",
        "9: rack_over_roller: `1 in` is in in, and the column in mm",
        "10: rack_over_roller 0.02 mm rack_pitch 0.001 mm",
    ];
    let found = parts(&text, &want);
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!(found.starts_with(expected), "{found}, not {expected}");
    }
    for cell in ["", " ", "n.a.", "-", "---", "#DIV/0!", "#NV", "N/A", "NaN", "k.A.", "\u{2014}"] {
        let text = format!("part;rack_pitch\nP1;{cell}\nP2;1\n");
        assert_eq!(parts(&text, &want), ["P1: rack_pitch missing", "P2: rack_pitch 1 mm"], "{cell}");
    }
}

#[test]
fn the_decimal_mark_is_the_one_by_which_all_can_be_read() {
    for (rows, mark) in
        [("25,013;1,5\n25.013;2,5", "comma"), ("25,013;1", "comma"), ("25.013;1", "point"), ("25,0;1", "comma")]
    {
        let text = format!("rack_over_roller;rack_pitch [um]\n{rows}\n");
        assert_eq!(reading(&text, &want()).decimal_mark, Some(mark), "{rows}");
    }
    assert_eq!(reading("rack_over_roller\n25\n", &want()).decimal_mark, None);
    let open = refused("rack_pitch;part\n1,234;a\n", &want());
    assert!(open.contains("`1,234` has a decimal mark or a thousands mark"), "{open}");
    let told = by(|layout| layout.decimal = Some(DecimalMark::Comma));
    assert_eq!(parts("rack_pitch;part\n1,234;a\n", &told), ["a: rack_pitch 1.234 mm"]);
}

#[test]
fn what_numbers_say_of_each_other() {
    let beside = by(|layout| {
        let names = vec![("nominal", "Soll".to_owned()), ("deviation", "Abw".to_owned())];
        layout.columns = vec![DeclaredColumn::new(DeviationKind::RackOverRoller, None, None, names)];
    });
    let text = "part;Rollenmaß [mm];Soll;Abw\nP1;25,011;25;0,011\nP2;25,011;25;0,110\nP3;25,011;24,9;0,111\n";
    let found = parts(text, &beside);
    assert_eq!(found[0], "P1: rack_over_roller 0.011 mm");
    assert!(found[1].contains("the deviation beside it is 0.11 mm, and this one is 0.011 mm"), "{found:?}");
    assert!(found[2].contains("the nominal value is 24.9 mm in the table and 25 mm in the spec"), "{found:?}");
    let others = by(|layout| layout.ignores_others = true);
    let again = refused("part;rack_over_roller;2nd\nP1;25.011;25.412\nP2;25.012;25.413\n", &others);
    assert!(again.contains("column `2nd`"), "{again}");
    let other = reading("part;rack_over_roller;hardness\nP1;25.011;58\n", &others);
    assert_eq!(other.left_out.iter().map(|rule| rule.tally.count).sum::<u64>(), 1);
}

#[test]
fn how_it_was_read_as_text() {
    let text = "Hallo,\nTeil;Rollenmaß [mm];Härte;rack pitch [µm]\n1;25,013;58;12\n";
    let want = by(|layout| {
        layout.ignore = vec![Pattern::of_heading("Härte")];
        layout.ignore_lines = vec![LineRule { pattern: Pattern::of_line("Hallo,"), at_most: 0 }];
    });
    let found = reading(text, &want);
    assert_eq!(
        found.to_string(),
        "block: read as semicolons, decimal comma, names in line 2, a part a row: \"Teil\" = part_id, \"Rollenmaß [mm]\" = \
         rack_over_roller [mm] measured, nominal 25 mm, \"rack pitch [µm]\" = rack_pitch [µm] deviation"
    );
    assert!(found.warnings()[0].starts_with("block: left out: `Härte` 1 text (Härte) "), "{:?}", found.warnings());
}

#[test]
fn nothing_that_is_read_panics() {
    let alphabet = [
        "1,5",
        "25.013",
        ";",
        "\t",
        ",",
        "|",
        "  ",
        " ",
        "\n",
        "\"",
        "pitch",
        "Lücke",
        "[µm]",
        "-",
        "°",
        "=",
        "Ist",
        "Merkmal",
        "rack_pitch",
        "over_pin",
        "part",
        "Soll",
        "Teil 1",
        "n.a.",
        "sep=;",
        "K0100 1",
        "f_Hβ [µm]",
        "mm",
        "\r",
    ];
    let mut state = 1_u64;
    let long = std::env::var("RACKMESH_LONG_TESTS").is_ok_and(|value| value == "1");
    for round in 0..if long { 40_000 } else { 1000 } {
        let mut text = String::new();
        for _ in 0..24 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            text.push_str(alphabet[usize::try_from(state >> 33).unwrap() % alphabet.len()]);
        }
        let want = if round % 2 == 0 { want() } else { Want { teeth: Some(round % 3 == 0), ..Want::default() } };
        let _ = read(&text, &want);
        let _ = of_one_part("block", Source::bytes(text.into_bytes()), &want);
    }
}
