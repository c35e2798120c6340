use super::table::{QdasTable, title};
use super::*;
use crate::quantity::{Decimal, LengthUnit, Unit};
use crate::table::cell::{Cell, Content, Record};
use crate::table::layout::DeclaredColumn;

/// The names of the columns and the cells of each row.
fn rows(text: &str) -> Vec<String> {
    let table = read(&[("lot.dfq", text)]).unwrap_or_else(|error| panic!("{error}")).table(&Layout::default());
    std::iter::once(titles(&table, &Layout::default()).join("|")).chain(records(&table)).collect()
}

fn titles(table: &QdasTable, layout: &Layout) -> Vec<String> {
    let others = table.indices.iter().map(|indices| title(&table.qdas.characteristics[indices[0]], layout));
    std::iter::once("part_id".to_owned()).chain(others).collect()
}

fn records(table: &QdasTable) -> Vec<String> {
    let cells = |record: Record| record.cells.iter().map(Cell::text).collect::<Vec<_>>().join("|");
    (0..table.len()).filter_map(|row| table.record(row)).map(cells).collect()
}

const HEAD: &str = "K0100 2\r\nK1001/1 4711\r\nK1002/1 Zahnstange\r\nK2001/1 rack_over_roller\r\nK2002/1 Rollenmaß\r\n\
                    K2101/1 25,000\r\nK2112/1 -0,02\r\nK2113/1 0,03\r\nK2142/1 mm\r\nK2106/1 0,002\r\nK2001/2 2\r\n\
                    K2002/2 Teilungsabweichung Zahnstange\r\nK2142/2 µm\r\n";

#[test]
fn values_under_keys() {
    let text = format!(
        "{HEAD}K0001/1 25,013\r\nK0002/1 0\r\nK0004/1 01.01.2026/15:18:31\r\nK0014/1 P1\r\nK0001/2 12\r\n\
         K0001/1 25.02\r\nK0001/2 99\r\nK0002/2 255\r\nK0014/0 P2\r\n"
    );
    assert_eq!(
        rows(&text),
        ["part_id|rack_over_roller [mm]|Teilungsabweichung Zahnstange [µm]", "P1|25.013|12", "P2|25.02|"]
    );
    let qdas = read(&[("lot.dfq", &text)]).unwrap();
    let first = &qdas.characteristics[0];
    assert_eq!(
        qdas.parts,
        [PartDefinition { number: "4711".to_owned(), name: "Zahnstange".to_owned(), kind: String::new() }]
    );
    let limits =
        (first.nominal.as_deref(), first.lower.as_deref(), first.upper.as_deref(), first.uncertainty.as_deref());
    assert_eq!(limits, (Some("25.000"), Some("24.98"), Some("25.03"), Some("0.002")));
}

#[test]
fn values_on_binary_lines_in_a_file_of_their_own() {
    let definitions = HEAD.to_owned();
    let values = "25,013\u{14}0\u{14}1.1.2026/15:18:31\u{f}12\u{14}0\r\nK0014/0 P1\r\n25,02\u{f}99\u{14}255\r\n25,03\r\n\u{f}7\u{f}\r\n";
    let qdas = read(&[("lot.dfd", &definitions), ("lot.dfx", values)]).unwrap();
    let table = qdas.table(&Layout::default());
    assert_eq!(records(&table), ["P1|25.013|12", "2|25.02|", "3|25.03|", "4||7"]);
    assert_eq!(table.line(2), 4);
}

#[test]
fn several_parts_with_the_same_characteristics() {
    let text = "K0100 3\nK1001/1 A\nK2002/1 rack_pitch\nK0001/1 0.01\nK0001/1 0.02\nK1001/2 B\nK2002/2 rack_pitch\nK2002/3 Härte\n\
                K0001/2 0.03\nK0001/3 58\n";
    assert_eq!(rows(text), ["part_id|rack_pitch|Härte", "A 1|0.01|", "A 2|0.02|", "B 1|0.03|58"]);
}

#[test]
fn limits_that_are_switched_off_are_none() {
    let text = "K0100 1\nK2002/1 rack_pitch\nK2110/1 0\nK2111/1 0.02\nK2120/1 0\nK2121/1 1\n0.01\n";
    let qdas = read(&[("lot.dfq", text)]).unwrap();
    assert_eq!(qdas.characteristics[0].lower, None);
    assert_eq!(qdas.characteristics[0].upper.as_deref(), Some("0.02"));
}

#[test]
fn what_is_wrong_is_said_with_line_and_key() {
    for (text, expected) in [
        ("K0100 x\n", "lot.dfq:1:7: error[bad-table]: K0100: `x` is not a number of characteristics"),
        ("K0100 1\nK2101/1 abc\n", "lot.dfq:2:9: error[bad-table]: K2101/1: `abc` is not a number"),
        ("K0100 1\nK2002/2 a\n", "lot.dfq:2:9: error[bad-table]: K2002/2: the file has 1 characteristics (K0100)"),
        ("K0100 1\nK2002/a b\n", "lot.dfq:2:1: error[bad-table]: K2002: `/a` is not a number of a"),
        ("K0100 1\n1.0\u{f}2.0\n", "lot.dfq:2:1: error[bad-table]: the line has more values than"),
        ("K0100 1\nK2002/1 a\n1.0\u{14}0\nabc\n", "lot.dfq:4:1: error[bad-table]: K0001: `abc` is not a number"),
        ("part;1\n", "lot.dfq:1:1: error[bad-table]: the file does not start with K0100"),
        ("K0100 1\nK2002/1 a\n", "error[bad-table]: lot.dfq has no measured values"),
        ("", "error[bad-table]: lot.dfq has no measured values"),
        ("K2002/99999999999999999999999 a\n", "lot.dfq:1:1: error[bad-table]: K2002: `/99999999999999999999999` is"),
        ("K2002/4000000000 a\n", "lot.dfq:1:18: error[bad-table]: K2002/4000000000: there is no"),
    ] {
        let error = read(&[("lot.dfq", text)]).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn what_is_written_is_read_again() {
    let columns = [
        CharacteristicColumn {
            number: "delta_cd_mm".to_owned(),
            name: "ΔCD".to_owned(),
            unit: "mm".to_owned(),
            upper: Some(0.05),
            ..CharacteristicColumn::default()
        },
        CharacteristicColumn {
            number: "rack_pitch".to_owned(),
            name: "Teilung".to_owned(),
            unit: "µm".to_owned(),
            ..CharacteristicColumn::default()
        },
    ];
    let part = PartDefinition { number: "4711".to_owned(), name: "Maß\nband".to_owned(), kind: String::new() };
    let rows = [
        ValueRow { name: "P1", values: vec![Some(0.1 + 0.2), Some(-1e-9)], remark: "" },
        ValueRow { name: "P2", values: vec![None, Some(f64::NAN)], remark: "no\nlead" },
    ];
    let mut written = definition_lines(&part, "judged without rack_lead", &columns);
    for row in rows {
        written.extend(row_lines(&row));
    }
    let text = crate::table::decode(&written);
    assert!(text.contains("\r\nK1900/1 judged without rack_lead\r\n"), "{text}");
    let qdas = read(&[("back.dfq", &text)]).unwrap();
    assert_eq!(qdas.parts[0].name, "Maß band");
    assert_eq!(qdas.characteristics[0].name, "?CD");
    assert_eq!(qdas.characteristics[0].upper.as_deref(), Some("0.05"));
    assert_eq!(qdas.characteristics[0].lower, None);
    let value = |characteristic: usize, row| {
        let number = qdas.characteristics[characteristic].values.get(row).unwrap().0.number()?;
        Content::Number(number).to_string().parse::<f64>().ok()
    };
    assert_eq!((value(0, 0), value(1, 0)), (Some(0.1 + 0.2), Some(-1e-9)));
    assert_eq!((value(0, 1), value(1, 1)), (None, None));
    assert_eq!(
        qdas.remarks.kept.iter().map(|remark| remark.text.as_str()).collect::<Vec<_>>(),
        ["judged without rack_lead", "no lead"]
    );
    assert_eq!(qdas.table(&Layout::default()).record(1).unwrap().cells[0].text(), "P2");
}

#[test]
fn what_changes_values_is_refused() {
    let lot = |keys: &str| read(&[("lot.dfq", format!("K0100 1\nK2002/1 rack_pitch\n{keys}\n1\n").as_str())]);
    for keys in ["K2071/1 0,06", "K2071/0 -1", "K2072/1 10", "K2072/1 0", "K2072/1 x"] {
        let refused = lot(keys).map(|_| ()).unwrap_err().to_string();
        assert!(refused.contains("an additive constant of") || refused.contains("a factor of"), "{keys}: {refused}");
    }
    for keys in ["K2071/1 0", "K2071/1 0,000", "K2072/1 1.0", "K2072/0 1", "K2072/1"] {
        assert!(lot(keys).is_ok(), "{keys}");
    }
}

#[test]
fn a_characteristic_that_is_no_size_has_no_values() {
    let lot = "K0100 2\nK2002/1 rack_pitch\nK2002/2 rack_lead\nK2004/1 1\nK2004/2 0\n0\u{f}5\n1\u{f}6\n";
    assert_eq!(rows(lot), ["part_id|rack_pitch|rack_lead", "1||5", "2||6"]);
    let left_out = read(&[("lot.dfq", lot)]).unwrap().left_out;
    assert_eq!(left_out, [LeftOut { code: "K2004".to_owned(), count: 2, first_line: 6 }]);
}

#[test]
fn only_attribute_0_makes_a_value() {
    let code = |code: &str, count, first_line| LeftOut { code: code.to_owned(), count, first_line };
    let keyed = "K0100 2\nK2002/1 rack_pitch\nK2002/2 rack_lead\nK0001/1 1\nK0002/1 0\nK0001/2 2\nK0002/2 290\nK0001/1 3\n\
                 K0001/2 4\nK0002/0 256\nK0001/1 5\nK0002/1 00\nK0001/2 6\nK0002/2 128\n";
    assert_eq!(rows(keyed), ["part_id|rack_pitch|rack_lead", "1|1|", "2||", "3|5|"]);
    let left_out = read(&[("lot.dfq", keyed)]).unwrap().left_out;
    assert_eq!(left_out, [code("290", 1, 7), code("256", 2, 10), code("128", 1, 14)]);
    assert_eq!(
        left_out.iter().map(LeftOut::meaning).collect::<Vec<_>>(),
        [Some("not plausible"), Some("deleted"), None]
    );
    let binary = "K0100 2\nK2002/1 rack_pitch\nK2002/2 rack_lead\n1\u{14}129\u{14}1.1.2026\u{f}2\u{14}0\n\
                  3\u{14}\u{f}4\u{14} x \n5\u{f}\u{14}255\n7\u{14}129\u{f}8\u{14}129\n";
    assert_eq!(rows(binary), ["part_id|rack_pitch|rack_lead", "1||2", "2|3|", "3|5|", "4||"]);
    let left_out = read(&[("lot.dfq", binary)]).unwrap().left_out;
    assert_eq!(left_out, [code("129", 3, 4), code("x", 1, 5), code("255", 1, 6)]);
}

#[test]
fn a_name_in_the_spec_finds_its_characteristic() {
    let text = "K0100 3\nK2001/1 17\nK2002/1  MYROLL \nK2142/1 mm\nK2002/2 rack_over_roller\nK2142/2 mm\nK2001/3 ß1\n\
                K2002/3 Teilung Zahnstange\n25.1\u{f}24\u{f}0.1\n";
    let own = |name: &str, kind| {
        let columns = vec![DeclaredColumn::new(kind, Some(name.to_owned()), None, Vec::new())];
        Layout { columns, ..Layout::default() }
    };
    let columns = |layout: &Layout| titles(&read(&[("lot.dfq", text)]).unwrap().table(layout), layout)[1..].to_vec();
    for (name, titled) in [("MYROLL", "MYROLL [mm]"), ("MYROLL [mm]", "MYROLL [mm]"), ("17", "17 [mm]")] {
        let own = own(name, DeviationKind::RackOverRoller);
        assert_eq!(columns(&own), [titled, "rack_over_roller [mm]", "Teilung Zahnstange"]);
        let qdas = read(&[("lot.dfq", text)]).unwrap();
        let errors = qdas.characteristics.iter().map(|characteristic| Qdas::error_of(characteristic, &own));
        let expected = [Some(DeviationKind::RackOverRoller), None, Some(DeviationKind::RackPitch)];
        assert_eq!(errors.collect::<Vec<_>>(), expected, "{name}");
    }
    assert_eq!(columns(&own("ß1", DeviationKind::RackPitch)), ["MYROLL [mm]", "rack_over_roller [mm]", "ß1"]);
}

#[test]
fn values_as_records() {
    let text = format!("{HEAD}25,013\u{f}+1.25e1\u{14}129\r\nK0014/0 P1\r\n\u{f}-,5\r\n");
    let table = read(&[("lot.dfq", &text)]).unwrap().table(&Layout::default());
    let number = |digits, exponent| Content::Number(Decimal { negative: false, digits, exponent });
    let record = |cells: Vec<Content>, line| Record::new(cells.into_iter().map(Cell::from).collect(), line);
    let text = |text: &str| Content::Text(text.into());
    let header = ["part_id", "rack_over_roller [mm]", "Teilungsabweichung Zahnstange [µm]"];
    assert_eq!(table.header(&Layout::default()), record(header.map(text).to_vec(), 1));
    assert_eq!(table.record(0), Some(record(vec![text("P1"), number(25_013, -3), Content::Empty], 14)));
    let half = Content::Number(Decimal { negative: true, digits: 5, exponent: -1 });
    assert_eq!(table.record(1), Some(record(vec![text("2"), Content::Empty, half], 16)));
    assert_eq!(table.record(2), None);
    assert_eq!([0, 1, 2, 9].map(|column| widest_um(&table, column)), [None, Some(30), None, None]);
}

/// How far the limits of a column are from their nominal values, in µm.
fn widest_um(table: &QdasTable, column: usize) -> Option<i64> {
    let widest = table.widest(column, Unit::Length(LengthUnit::Millimetre))?;
    Some((widest * 1000.0).round() as i64)
}

#[test]
fn each_part_of_a_file_has_its_limits() {
    let text = "K0100 2\nK1001/1 A\nK2002/1 rack_over_roller\nK2101/1 25\nK2111/1 25.1\nK1001/2 B\n\
                K2002/2 rack_over_roller\nK2101/2 26\nK2110/2 25.8\nK0001/1 25.1\nK0001/2 26.1\n";
    let table = read(&[("lot.dfq", text)]).unwrap().table(&Layout::default());
    assert_eq!(widest_um(&table, 1), Some(200));
}

#[test]
fn values_belong_to_the_header_before_them() {
    let part = |number: &str, unit: &str, values: &str| {
        format!("K0100 1\nK1001/1 {number}\nK2002/1 rack_pitch\nK2142/1 {unit}\n{values}")
    };
    let text = part("A", "um", "1\n2\n") + &part("B", "um", "3\n") + &part("A", "um", "K0001/1 4\n");
    assert_eq!(rows(&text), ["part_id|rack_pitch [um]", "A 1|1", "A 2|2", "B 3|3", "A 4|4"]);
    let text = part("A", "um", "1\nK0014/1 P1\n") + &part("A", "um", "2\n");
    assert_eq!(rows(&text), ["part_id|rack_pitch [um]", "P1|1", "2|2"]);
    // a column of each unit, which are two columns of one error
    let text = part("A", "mm", "0.1\n") + &part("B", "um", "12\n");
    assert_eq!(rows(&text), ["part_id|rack_pitch [mm]|rack_pitch [um]", "A 1|0.1|", "B 2||12"]);
    let text = "K0100 1\nK2002/1 rack_pitch\nK2142/1 um\n1\nK0100 1\nK2002/1 rack_pitch\n2\n";
    assert_eq!(rows(text), ["part_id|rack_pitch [um]|rack_pitch", "1|1|", "2||2"]);
}

#[test]
fn what_contradicts_itself_is_refused() {
    for (text, expected) in [
        (
            "K0100 1\nK2142/1 mm\n1\nK2142/1 um\n2\n",
            "lot.dfq:4:9: error[bad-table]: K2142 says `um` behind values for which it said `mm`",
        ),
        (
            "K0100 1\nK2002/1 a\n1\nK2142/1 um\n",
            "lot.dfq:4:9: error[bad-table]: K2142 says `um` behind values for which it said nothing",
        ),
        ("K0100 1\nK2142/1 mm\nK2142/1 um\n2\n", "lot.dfq:3:9: error[bad-table]: K2142 says `um`, and `mm` before it"),
        ("K0100 1\nK1001/1 A\n1\nK1001/1 B\n2\n", "lot.dfq:4:9: error[bad-table]: K1001/1 says `B`, and `A` before it"),
        (
            "K0100 2\nK2002/1 a\nK0100 1\n",
            "lot.dfq:3:7: error[bad-table]: K0100 counts 1 characteristics, and 2 before it",
        ),
        (
            "K0100 3\nK2002/1 a\n1\n",
            "lot.dfq:1:7: error[bad-table]: K0100 counts 3 characteristics, and the file has 1",
        ),
        (
            "K0100 1\nK2002/1 a\nK0002/1 255\nK0001/1 12\n",
            "lot.dfq:3:9: error[bad-table]: K0002/1: there is no value before it",
        ),
        ("K0100 1\nK2002/1 a\nK0014/0 P1\n12\n", "lot.dfq:3:9: error[bad-table]: K0014/0: there is no value before it"),
        (
            "K0100 1\nK2111/1 20\nK2113/1 5\n1\n",
            "lot.dfq:3:9: error[bad-table]: K2111 is 20, and the nominal value 0 with K2113 5 is another limit",
        ),
        (
            "K0100 1\nK2113/1 5\n1\n",
            "lot.dfq:2:9: error[bad-table]: K2113 is an allowance of 5, and there is no nominal value",
        ),
        (
            "K0100 1\nK2110/1 5\nK2111/1 3\n1\n",
            "lot.dfq:2:9: error[bad-table]: the lower limit 5 is above the upper limit 3",
        ),
    ] {
        let error = read(&[("lot.dfq", text)]).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{error}");
    }
    for text in [
        "K0100 1\nK2142/0 mm\nK2142/1 um\nK2142/1 um\n2\n",
        "K0100 1\nK2101/1 25,000\nK2111/1 25.03\nK2113/1 0.030\nK2110/1 24.98\nK2112/1 -0.02\n25\n",
        "K0100 1\nK2111/1 20\nK2113/1 5\nK2121/1 0\n1\n",
    ] {
        assert!(read(&[("lot.dfq", text)]).is_ok(), "{text}");
    }
}

/// Whatever key a text stands under, another text there is seen: it is read, needs a rule, or is in the digest of the format.
#[test]
fn no_key_goes_unnoticed() {
    let seen = |key: u16, text: &str| {
        let line = format!("K{key:04}/1 {text}\n");
        let (above, below) = if key < 100 { ("", &*line) } else { (&*line, "") };
        let file = format!("{HEAD}{above}25,013\u{f}12\n{below}");
        read(&[("lot.dfq", &file)]).map(|qdas| (qdas.said, qdas.remarks, qdas.parts, qdas.characteristics.len()))
    };
    let words = ["alle Werte in Zoll", "ungueltig 412"];
    for key in (2..10_000).filter(|key| *key != 100) {
        for [one, other] in [words, ["1", "2"]] {
            let (one, other) = (seen(key, one), seen(key, other));
            assert!(one.is_err() || other.is_err() || one.ok() != other.ok(), "K{key:04}");
        }
        let has_words = |key: u16| seen(key, words[0]).is_ok_and(|(_, remarks, ..)| remarks.kept.is_empty());
        assert!(!matches!(key, 5 | 9 | 15 | 1203 | 1900 | 2005 | 2092 | 2900) || !has_words(key), "K{key:04}");
    }
}

/// Remarks are counted by the rule that leaves them out as they come, and of those without one the first are kept.
#[test]
fn of_many_remarks_the_first_are_kept() {
    use crate::table::{Pattern, Want};
    let remarks = (0..5000).map(|at| format!("K0009/1 shift {at}\n")).collect::<Vec<_>>().concat();
    let lot = format!("K0100 1\nK2002/1 rack_pitch\nK2142/1 um\n1\n{remarks}");
    let read = |rules: &[&str]| {
        let rules: Vec<Pattern> = rules.iter().map(|rule| Pattern::of_heading(rule)).collect();
        let bytes = Box::new(std::io::Cursor::new(lot.clone()));
        (read_all(vec![("lot.dfq".to_owned(), bytes)], &rules).unwrap(), rules)
    };
    let table = |(qdas, comments): (Qdas, Vec<Pattern>)| {
        let want = Want { layout: Layout { comments, ..Layout::default() }.into(), ..Want::default() };
        qdas_table("lot.dfq", qdas, &want).map_err(crate::diagnostic::Diagnostics::from)
    };
    let (open, rules) = read(&[]);
    assert_eq!((open.remarks.kept.len(), open.remarks.more), (1000, 4000));
    let refused = table((open, rules)).err().unwrap().0.remove(0).message_with_list();
    assert!(refused.contains("line 5: K0009: shift 0") && refused.contains("and 4960 more"), "{refused}");
    let (covered, rules) = read(&["K0009: shift *"]);
    assert!(covered.remarks.kept.is_empty() && covered.remarks.more == 0);
    let digest = covered.remarks.left_out[0].1.digest;
    let left_out = table((covered.clone(), rules)).unwrap().reading.left_out;
    let rule = left_out.iter().find(|rule| rule.rule == "comments `K0009: shift *`").unwrap();
    assert_eq!((rule.tally.count, rule.tally.digest), (5000, digest));
    assert_eq!(rule.tally.first[0], "line 5: K0009: shift 0");
    // another contract does not have that rule
    assert!(table((covered, Vec::new())).is_err());
}

/// What is kept of a file is bounded, whatever stands in it.
#[test]
fn texts_and_attributes_that_are_kept_are_bounded() {
    let lot = |keys: &str| read(&[("lot.dfq", format!("K0100 1\nK2002/1 rack_pitch\n1\n{keys}").as_str())]);
    let long = "x".repeat(1001);
    for key in ["K1001/1", "K2002/1", "K0014/1"] {
        let refused = read(&[("lot.dfq", &format!("K0100 1\n{key} {long}\n"))]).map(|_| ()).unwrap_err().to_string();
        assert!(refused.starts_with("lot.dfq:2:") && refused.contains("has a text of 1001 bytes"), "{refused}");
    }
    assert_eq!(lot(&format!("K0009/1 {long}\n")).unwrap().remarks.kept.len(), 1);
    let attributes = (0..1002).map(|at| format!("K0001/1 1\nK0002/1 a{at}\n")).collect::<Vec<_>>().concat();
    let refused = lot(&attributes).map(|_| ()).unwrap_err().to_string();
    assert!(
        refused.contains("lot.dfq:2005:9: error[bad-table]: values have more than 1000 different attributes"),
        "{refused}"
    );
    let long = format!("K0009/1 {}\n", "x".repeat(100_000)).repeat(50);
    let kept: usize = lot(&long).unwrap().remarks.kept.iter().map(|remark| remark.text.len()).sum();
    assert!(kept > 0 && kept <= 1 << 20, "{kept}");
}
