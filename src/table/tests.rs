//! The reader of tables as a whole: bytes in, parts and how they were read out.

mod characteristics;
mod closure;
mod columns;
mod containers;
mod rows;
mod strangers;
mod teeth;

use super::*;
use crate::deviation::DeviationValue;
use crate::diagnostic::{Diagnostic, Diagnostics};

/// A table that was read.
struct Read {
    reading: Reading,
    strangers: Vec<Stranger>,
    /// Each part: `name: error deviation, …`, with what is wrong in place of a value.
    parts: Vec<String>,
}

/// A spec of a rack: the measure over the roller with its nominal value, and the pitch.
fn want() -> Want {
    let nominal = DeviationValue::Length("25".parse().unwrap());
    Want {
        expected: vec![DeviationKind::RackOverRoller, DeviationKind::RackPitch],
        given: vec![given(DeviationKind::RackOverRoller, Some(nominal))],
        ..Want::default()
    }
}

fn given(kind: DeviationKind, nominal: Option<DeviationValue>) -> GivenColumn {
    GivenColumn { kind, unit: None, holds: None, nominal: nominal.map(Ok), length: None, has_extent: false }
}

/// A spec that asks for these errors and knows nothing of them.
fn asks(expected: &[DeviationKind]) -> Want {
    Want { expected: expected.to_vec(), ..Want::default() }
}

/// Reads a file; what is wrong with it comes as messages, each with what to do.
fn read_file(name: &str, bytes: &[u8], want: &Want) -> Result<Read, String> {
    let in_words = |Diagnostics(problems): Diagnostics| {
        let each = |problem: &Diagnostic| format!("{problem} | {}", problem.help.clone().unwrap_or_default());
        problems.iter().map(each).collect::<Vec<_>>().join("\n")
    };
    let container = Container::open(name, Source::bytes(bytes.to_vec()), want).map_err(in_words)?;
    let mut table = container.table(name, want).map_err(in_words)?;
    let strangers = std::mem::take(&mut table.strangers);
    let reading = table.reading.clone();
    let keys: Vec<_> =
        table.columns.iter().map(|column| column.kind.map_or(column.field.key(), DeviationKind::key)).collect();
    let mut parts = Vec::new();
    for block in table.blocks().map_err(|error| error.to_string())? {
        parts.extend((0..block.rows()).map(|row| part(&block, row, &keys)));
        parts.extend(block.contradiction.map(|contradiction| format!("contradiction: {}", contradiction.message)));
    }
    Ok(Read { reading, strangers, parts })
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
        "rack_over_roller rack_pitch\n25.013 12um\n",
        "| rack over roller | dp |\n|---|---|\n| 25.013 mm | 12 µm |\n",
        "\"Rollenmaß\n[mm]\"\t\"dp\n[µm]\"\n25,013\t12,0\n",
        "Rollenmaß\tdp\nmm\tµm\n25,013\t12\n",
        "25.013 0.012",
        "25,013\n0,012\n",
        "25,013\u{a0}mm\t12\u{a0}µm",
        "rack over roller: 25.013 mm\nrack pitch: 12 um\n",
        "001 Rack over roller [mm] 25.013\n002 Pitch error of rack 12 um\n",
        "1;Rollenmaß;25,013;mm\n2;Teilung Zahnstange;12;µm\n",
        "rack_over_roller=25,013\nrack_pitch=0,012\n",
        "Rollenmaß\t25,013\tmm\nTeilung Zahnstange\t12\tµm\n",
        "Merkmal;Soll;Ist;Abweichung;Einheit\nRollenmaß;25,000;25,013;0,013;mm\nTeilung Zahnstange;;;12;µm\n",
        "Merkmal\tNennmaß [mm]\tIstmaß [mm]\nRollenmaß\t25,000\t25,013\nTeilung Zahnstange\t0\t0,012\n",
        "Hello,\n\nhere are the values of today:\n\nrack_over_roller;rack_pitch\n25.013;0.012\n\nBest regards\nJo; Quality\n",
        "rack over roller deviation [µm],dp [µm]\n13,12\n",
        "\u{feff}rack_over_roller,note,rack_pitch\n25.013,good,0.012",
        "rack_over_roller [cm],rack_pitch [1/1000 mm]\n2.5013,12\n",
        "rack_over_roller [millimètre];rack_pitch [0,001mm]\n25,013;12\n",
        "rack_over_roller [mm];rack_pitch [µ m]\n25,013;12\n",
    ] {
        assert_eq!(parts(text, &want()), ["rack_over_roller 0.013 mm rack_pitch 0.012 mm"], "{text}");
    }
}

#[test]
fn several_parts_in_rows_or_columns() {
    let expected =
        ["a1: rack_over_roller 0.013 mm rack_pitch 0.012 mm", "a2: rack_over_roller -0.02 mm rack_pitch 0 mm"];
    for text in [
        "Teil;Rollenmaß [mm];dp [µm]\na1;25,013;12\na2;24,98;0\n",
        "part  rack over roller (mm)  dp [um]\na1  25.013  12\na2  24.98   0",
        "| Teil | Rollenmaß [mm] | dp [µm] |\n|---|---|---|\n| a1 | 25,013 | 12 |\n| a2 | 24,98 | 0 |\n",
        "part\ta1\ta2\nrack over roller [mm]\t25.013\t24.98\ndp [µm]\t12\t0\n",
        "a1\t25.013\t0.012\na2\t24.98\t0\n",
        "Merkmal;Soll;OG;UG;Einheit;a1;a2\nRollenmaß;25;0,03;-0,03;mm;25,013;24,98\nTeilung Zahnstange;0;20;-20;µm;12;0\n",
        "partnb,id,actual,nominal,uppertol,lowertol,unit\na1,rack_over_roller,25.013,25,0.05,-0.05,mm\na1,rack_pitch,12,0,20,-20,um\n\
         a2,rack_over_roller,24.98,25,0.05,-0.05,mm\na2,rack_pitch,0,0,20,-20,um\n",
        "id,partnb,actual,nominal\nrack_pitch,a1,0.012,0\nrack_over_roller,a1,25.013,25\nrack_over_roller,a2,24.98,25\n\
         rack_pitch,a2,0,0\n",
    ] {
        let mut found = parts(text, &want());
        let turned = ["rack_pitch 0.012 mm rack_over_roller 0.013 mm", "rack_pitch 0 mm rack_over_roller -0.02 mm"];
        for (part, (turned, expected)) in found.iter_mut().zip(turned.iter().zip(expected)) {
            if part.ends_with(turned) {
                expected.clone_into(part);
            }
        }
        assert_eq!(found, expected, "{text}");
    }
}

#[test]
fn thousands_marks_minus_signs_and_angles() {
    let want = asks(&[DeviationKind::RackOverRoller, DeviationKind::RackLead]);
    for (text, expected) in [
        ("1.000,92;-0,5", "rack_over_roller 1000.92 mm rack_lead -0.5°"),
        ("1,000.92;\u{2212}0.5", "rack_over_roller 1000.92 mm rack_lead -0.5°"),
        ("1'000.92 um\t12° 30'", "rack_over_roller 1.00092 mm rack_lead 12.5°"),
        ("1\u{202f}000,92 µm\t\u{2013}0,5°", "rack_over_roller 1.00092 mm rack_lead -0.5°"),
        ("1 000,92 µm;0,5", "rack_over_roller 1.00092 mm rack_lead 0.5°"),
        ("1e-2;-5e-1", "rack_over_roller 0.01 mm rack_lead -0.5°"),
        ("0.01;- 0.5", "rack_over_roller 0.01 mm rack_lead -0.5°"),
        ("\u{ff10}\u{ff0e}\u{ff10}\u{ff11};\u{ff0d}\u{ff10}.5", "rack_over_roller 0.01 mm rack_lead -0.5°"),
        ("1.5\t-0° 1' 30\"", "rack_over_roller 1.5 mm rack_lead -0.025°"),
        ("1.5;0°1'30''", "rack_over_roller 1.5 mm rack_lead 0.025°"),
        ("1.5;0°1\u{2032}30\u{2033}", "rack_over_roller 1.5 mm rack_lead 0.025°"),
        ("0.5 in;90\u{2033}", "rack_over_roller 12.7 mm rack_lead 0.025°"),
    ] {
        assert_eq!(parts(text, &want), [expected], "{text}");
    }
}

#[test]
fn what_is_ambiguous_is_refused_with_its_readings() {
    let plain = asks(&[DeviationKind::RackPitch]);
    let two = asks(&[DeviationKind::RackPitch, DeviationKind::PinionPitch]);
    let three =
        "with decimal point: rack_pitch 1.234 mm, rack_pitch 5.678 mm; or with decimal comma: rack_pitch 1.234 µm";
    for (text, want, message, readings) in [
        (
            "1,234",
            &plain,
            "two ways",
            "with decimal point: rack_pitch 1234 mm; or with decimal comma: rack_pitch 1.234 mm",
        ),
        (
            "1.234",
            &plain,
            "two ways",
            "with decimal point: rack_pitch 1.234 mm; or with decimal comma: rack_pitch 1234 mm",
        ),
        ("1.234;1.234", &two, "two ways, because of `1.234`", "--decimal comma or --decimal point"),
        ("25,013;1.234", &two, "two ways, because of `25,013`", "with decimal comma: rack_pitch 25.013 mm"),
        ("rack_pitch [µm]\n1,234\n5,678\n", &plain, "two ways", three),
        ("Teilung Zahnstange [µm]\n1.234\n", &plain, "two ways", "with decimal comma: rack_pitch 1.234 mm"),
        ("pitch\n0.01\n", &two, "`pitch` could be rack_pitch or pinion_pitch", "or name it `rack_pitch`"),
        ("1\t2\n3\t4\n", &two, "as many rows as columns", "--parts rows or --parts columns"),
        ("Zahn\tTeilung\n0\t0.01\n", &two, "`Teilung` could be rack_pitch or pinion_pitch", ""),
    ] {
        let found = refused(text, want);
        assert!(found.contains("error[ambiguous-block]") && found.contains(message), "{text}: {found}");
        assert!(found.contains(readings), "{text}: {found}");
    }
    let columns = Want { orientation: Some(Orientation::Columns), ..two };
    let expected = ["rack_pitch 1 mm pinion_pitch 3 mm", "rack_pitch 2 mm pinion_pitch 4 mm"];
    assert_eq!(parts("1\t2\n3\t4\n", &columns), expected);
}

#[test]
fn what_settles_the_decimal_mark() {
    let two = asks(&[DeviationKind::RackPitch, DeviationKind::PinionPitch]);
    let told = |mark| Want { decimal: Some(mark), ..asks(&[DeviationKind::RackPitch]) };
    let nominal = Some(DeviationValue::Length("25".parse().unwrap()));
    let known = Want { given: vec![given(DeviationKind::RackPitch, nominal)], ..two.clone() };
    let far = "otherwise 25013 mm is far from the nominal value 25 mm";
    for (text, want, by, values) in [
        ("1,234;0,5", &two, "settled by `0,5`", "rack_pitch 1.234 mm pinion_pitch 0.5 mm"),
        ("0,5 um;1.234 um", &two, "settled by `0,5 um`", "rack_pitch 0.0005 mm pinion_pitch 1.234 mm"),
        ("1.25 um;25,013 um", &two, "settled by `1.25 um`", "rack_pitch 0.00125 mm pinion_pitch 25.013 mm"),
        ("1.234 um;1.000,5 um", &two, "settled by `1.000,5 um`", "rack_pitch 1.234 mm pinion_pitch 1.0005 mm"),
        ("25.013;0,5 um", &known, "settled by `0,5 um`", "rack_pitch: 25013 mm is far"),
        ("25.013;1 um", &known, far, "rack_pitch 0.013 mm pinion_pitch 0.001 mm"),
        ("1,234", &told(DecimalMark::Comma), "as told", "rack_pitch 1.234 mm"),
        ("1,234", &told(DecimalMark::Point), "as told", "rack_pitch 1234 mm"),
        ("rack_over_roller\n25,013\n", &super::tests::want(), far, "rack_over_roller 0.013 mm"),
        // what is wrong whatever the mark settles nothing, and keeps nothing from being settled
        (
            "rack_over_roller;dp [um]\n25.0l3;1\n13;1\n25.013;1\n",
            &super::tests::want(),
            far,
            "rack_over_roller: `l3 mm`",
        ),
    ] {
        let found = read(text, want).unwrap_or_else(|problem| panic!("{text}: {problem}"));
        let settled = found.reading.settled_by.unwrap_or_default();
        assert!(settled.starts_with(by), "{text}: {settled}");
        assert!(found.parts[0].starts_with(values), "{text}: {:?}", found.parts);
    }
    let both = refused("1.5;1,5", &two);
    assert!(both.starts_with("block:1:5: error[bad-table]: the table has decimal points and commas: `1.5` and `1,5`"));
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    for (text, expected) in [
        ("hello", "error[bad-table]: block holds no table of numbers"),
        ("", "error[bad-table]: block holds no table of numbers"),
        ("rack_pitch;rack_over_roller\n", "error[bad-table]: block has names (rack_pitch rack_over_roller) and no row"),
        ("rack_pitch;rack_pitch\n1;2", "error[bad-table]: block: `rack_pitch` names rack_pitch a second time"),
        ("dp [um];Δp [um]\n1;2", "error[bad-table]: block: `Δp [um]` names rack_pitch a second time"),
        (
            "rack_over_roller\t1\t2\nrack_pitch\t1\n",
            "block:2:1: error[bad-table]: line 2: the row has 2 cells, and the table has 3",
        ),
        ("1;2;3;4", "block:1:1: error[bad-table]: the numbers have no names: 1 row by 4 columns"),
        (
            "rack pitch (Ist) [mm]\n1,5",
            "error[missing-key]: block: `rack pitch (Ist) [mm]` holds measured values, and nothing tells",
        ),
        ("rack_pitch;\"note\n1;2\n", "error[bad-table]: block, line 1: a quote is not closed"),
    ] {
        let found = refused(text, &want());
        assert!(found.starts_with(expected), "{text}: {found}");
    }
    let text = "nr;rack_over_roller;dp [um]\n1;25.013;12\n2;25.0l3;5\n3;;5\n4;13;5\n5;25;0\n6;2_5.01;0\n7;25;1;2\n";
    let found = parts(text, &want());
    let expected = [
        "1: rack_over_roller 0.013 mm rack_pitch 0.012 mm",
        "2: rack_over_roller: `l3 mm` is not a unit of a length",
        "3: rack_over_roller missing rack_pitch 0.005 mm",
        "4: rack_over_roller: 13 mm is far from the nominal value 25 mm",
        "5: rack_over_roller 0 mm rack_pitch 0 mm",
        "6: rack_over_roller: `2_5.01 mm` is not a length",
        ": the row has 4 fields and the header has 3: `7 25 1 2`",
    ];
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!(found.starts_with(expected), "{found}");
    }
}

#[test]
fn missing_values_are_missing_and_none_of_them_ends_the_table() {
    let want = asks(&[DeviationKind::RackPitch]);
    for cell in ["", " ", "n.a.", "-", "---", "#DIV/0!", "#NV", "N/A", "NaN", "k.A.", "\u{2014}"] {
        let text = format!("part;rack_pitch;rack_over_roller\nP1;{cell};1\nP2;1;2\nP3;{cell};{cell}\n");
        let expected = [
            "P1: rack_pitch missing rack_over_roller 1 mm",
            "P2: rack_pitch 1 mm rack_over_roller 2 mm",
            "P3: rack_pitch missing rack_over_roller missing",
        ];
        assert_eq!(parts(&text, &want), expected, "{cell}");
    }
    let footer = "part;rack_pitch\nP1;1\nP2;\n;\nGruß;\n";
    assert_eq!(parts(footer, &want), ["P1: rack_pitch 1 mm", "P2: rack_pitch missing"]);
    let asides: Vec<_> = reading(footer, &want).asides.iter().map(|aside| aside.text.clone()).collect();
    assert!(asides.contains(&"Gruß".to_owned()), "{asides:?}");
}

#[test]
fn how_it_was_read_as_text() {
    let text = "Hallo,\nTeil;Rollenmaß [mm];Härte;dp [µm]\n1;25,013;58;12\nGruß\n";
    assert_eq!(
        reading(text, &want()).to_string(),
        "block: read as semicolons, decimal comma (otherwise 25013 mm is far from the nominal value 25 mm), names in line 2, a part a row: \"Teil\" = part_id, \"Rollenmaß [mm]\" = \
         rack_over_roller [mm] measured, nominal 25 mm, \"dp [µm]\" = rack_pitch [µm] deviation"
    );
    let assumed = reading("rack_over_roller;rack_pitch;Temp [°C]\n25.5;1.5;20\n", &want());
    let remarks = [
        "block: units assumed, because nothing tells them: `rack_over_roller` mm, `rack_pitch` mm",
        "block: not used: `Temp [°C]`",
    ];
    assert_eq!(assumed.remarks(), remarks);
    let across = reading("part\ta1\ta2\nrack_pitch\t1\t2\n", &want());
    assert_eq!((across.parts_in, across.unit_counted, across.decimal_mark), ("columns", "part", None));
    let table = Container::open("block", Source::bytes(text.into()), &want()).unwrap().table("block", &want()).unwrap();
    let mapping = [
        "rack_over_roller = { name = \"Rollenmaß\", unit = \"mm\" }",
        "rack_pitch = { name = \"dp\", unit = \"µm\", kind = \"deviation\" }",
    ];
    assert_eq!(table.mapping(), mapping);
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
    for round in 0..4000 {
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
