use super::*;

fn want() -> Want {
    Want {
        expected: vec![ErrorKind::RackOverRoller, ErrorKind::RackPitch],
        nominals: vec![(ErrorKind::RackOverRoller, ErrorValue::Length("25".parse().unwrap()))],
        ..Want::default()
    }
}

/// Each part: `id: error deviation, …`, or the diagnostic.
fn parts(text: &str, want: &Want) -> Vec<String> {
    match understand("block", text, want) {
        Ok(Understood { pasted: Pasted::Parts(parts), .. }) => parts
            .iter()
            .map(|part| {
                let mut words: Vec<String> = part.id.iter().map(|id| format!("{id}:")).collect();
                words.extend(part.errors.iter().map(|(kind, value)| match value {
                    ErrorValue::Length(length) => format!("{} {length}", kind.key()),
                    angle => format!("{} {}", kind.key(), angle.base()),
                }));
                words.extend(part.problems.iter().map(ToString::to_string));
                words.join(" ")
            })
            .collect(),
        Ok(other) => vec![format!("{:?}", other.pasted)],
        Err(diagnostic) => vec![format!("{diagnostic} | {}", diagnostic.help.clone().unwrap_or_default())],
    }
}

#[test]
fn the_same_part_however_it_is_pasted() {
    for text in [
        "rack_over_roller,rack_pitch\n25.013,0.012\n",
        "rack_over_roller;rack_pitch\r\n25,013;0,012\r\n",
        "Rollenmaß [mm]\tTeilungsabweichung Zahnstange [µm]\n25,013\t12\n",
        "Rack over roller  rack pitch (um)\n25,013            12,0\n",
        "rack_over_roller rack_pitch\n25.013 12um\n",
        "| rack over roller | dp |\n|---|---|\n| 25.013 mm | 12 µm |\n",
        "\"Rollenmaß\n[mm]\"\t\"dp\n[µm]\"\n25,013\t12,0\n",
        "Rollenmaß\tdp\nmm\tµm\n25,013\t12\n",
        "25.013 0.012",
        "25,013\n0,012\n",
        "25,013\u{a0}mm\t12\u{a0}µm",
        "rack over roller: 25.013 mm\nrack pitch: 12 um\n",
        "rack_over_roller=25,013\nrack_pitch=0,012\n",
        "Rollenmaß\t25,013\tmm\nTeilung Zahnstange\t12\tµm\n",
        "Merkmal;Soll;Ist;Abweichung;Einheit\nRollenmaß;25,000;25,013;0,013;mm\nTeilung Zahnstange;;;12;µm\n",
        "Merkmal\tNennmaß [mm]\tIstmaß [mm]\nRollenmaß\t25,000\t25,013\nTeilung Zahnstange\t0\t0,012\n",
        "Hello,\n\nhere are the values of today:\n\nrack_over_roller;rack_pitch\n25.013;0.012\n\nBest regards\nJo; Quality\n",
        "dp [µm],rack over roller deviation [µm]\n12,13\n",
        "\u{feff}rack_over_roller,note,rack_pitch\n25.013,good,0.012",
    ] {
        assert_eq!(parts(text, &want()), ["rack_over_roller 0.013 mm rack_pitch 0.012 mm"], "{text}");
    }
}

#[test]
fn several_parts_in_rows_or_columns() {
    let expected =
        ["a1: rack_over_roller 0.013 mm rack_pitch 0.012 mm", "a2: rack_over_roller -0.02 mm rack_pitch 0 mm"];
    for text in [
        "Teil;Rollenmaß;dp [µm]\na1;25,013;12\na2;24,98;0\n",
        "part  rack over roller  dp [um]\na1  25.013  12\na2  24.98   0",
        "part\ta1\ta2\nrack over roller\t25.013\t24.98\ndp [µm]\t12\t0\n",
        "a1\t25.013\t0.012\na2\t24.98\t0\n",
    ] {
        assert_eq!(parts(text, &want()), expected, "{text}");
    }
}

#[test]
fn thousands_marks_minus_signs_and_angles() {
    let want = Want { expected: vec![ErrorKind::RackOverRoller, ErrorKind::RackLead], ..Want::default() };
    for (text, expected) in [
        ("1.000,92;-0,5", "rack_over_roller 1000.92 mm rack_lead -0.5"),
        ("1,000.92;\u{2212}0.5", "rack_over_roller 1000.92 mm rack_lead -0.5"),
        ("1'000.92 um\t12° 30'", "rack_over_roller 1.00092 mm rack_lead 12.5"),
        ("1\u{202f}000,92 µm\t\u{2013}0,5°", "rack_over_roller 1.00092 mm rack_lead -0.5"),
        ("1 000,92 µm;0,5", "rack_over_roller 1.00092 mm rack_lead 0.5"),
        ("1e-2;-5e-1", "rack_over_roller 0.01 mm rack_lead -0.5"),
    ] {
        assert_eq!(parts(text, &want), [expected], "{text}");
    }
}

#[test]
fn what_is_ambiguous_is_refused_with_its_readings() {
    let plain = Want { expected: vec![ErrorKind::RackPitch], ..Want::default() };
    let two = Want { expected: vec![ErrorKind::RackPitch, ErrorKind::PinionPitch], ..Want::default() };
    for (text, want, message, readings) in [
        (
            "1,234",
            &plain,
            "two ways",
            "with decimal point: rack_pitch 1234 mm; or with decimal comma: rack_pitch 1.234 mm",
        ),
        ("rack_pitch [µm]\n1,234\n5,678\n", &plain, "two ways", "with decimal point: rack_pitch 1.234 mm"),
        ("Teilung Zahnstange [µm]\n1.234\n", &plain, "two ways", "with decimal comma: rack_pitch 1.234 mm"),
        ("pitch\n0.01\n", &two, "`pitch` could be rack_pitch or pinion_pitch", "--as rack_pitch"),
        ("1\t2\n3\t4\n", &two, "as many rows as columns", "--parts rows or --parts columns"),
        ("Zahn\tTeilung\n0\t0.01\n", &two, "could be", ""),
        // one of the two is a thousandfold of what it was meant to be, and nothing says which
        ("0,5 um;1.234 um", &two, "points and commas, so that `1.234 um` can be read in two ways", "--decimal comma"),
        (
            "1.25 um;25,013 um",
            &two,
            "points and commas, so that `25,013 um` can be read in two ways",
            "--decimal point",
        ),
        ("25,013;1.234", &two, "points and commas", "write every number in the same way"),
    ] {
        let found = parts(text, want);
        assert!(found[0].contains("error[ambiguous-block]") && found[0].contains(message), "{found:?}");
        assert!(found[0].contains(readings), "{found:?}");
    }
    // a nominal value, or another number with both marks, says that thousands are grouped; so does the user
    let nominal =
        Want { nominals: vec![(ErrorKind::RackPitch, ErrorValue::Length("25 mm".parse().unwrap()))], ..two.clone() };
    let told = Want { decimal: Some(DecimalMark::Comma), ..two.clone() };
    for (text, want, values) in [
        ("25.013 um;0,5 um", &nominal, "rack_pitch 0.013 mm pinion_pitch 0.0005 mm"),
        ("1.234 um;1.000,5 um", &two, "rack_pitch 1.234 mm pinion_pitch 1.0005 mm"),
        ("1.234 um;0,5 um", &told, "rack_pitch 1.234 mm pinion_pitch 0.0005 mm"),
    ] {
        assert_eq!(parts(text, want), [values], "{text}");
    }
    // what settles it, and is said
    let settled = |text: &str, want: &Want| understand("block", text, want).unwrap().account.settled_by;
    assert_eq!(settled("1,234;0,5", &two).as_deref(), Some("settled by `0,5`"));
    let told = Want { decimal: Some(DecimalMark::Comma), ..plain.clone() };
    assert_eq!(settled("1,234", &told).as_deref(), Some("as told by --decimal"));
    assert_eq!(parts("1,234", &told), ["rack_pitch 1.234 mm"]);
    let by_nominal = settled("rack_over_roller\n25,013\n", &super::tests::want());
    assert_eq!(by_nominal.as_deref(), Some("otherwise 25013 mm is far from the nominal value 25 mm"));
    let rows = Want { orientation: Some(Orientation::Columns), ..two.clone() };
    assert_eq!(
        parts("1\t2\n3\t4\n", &rows),
        ["rack_pitch 1 mm pinion_pitch 3 mm", "rack_pitch 2 mm pinion_pitch 4 mm"]
    );
    // a point with three decimals is no doubt where nothing speaks for commas
    assert_eq!(parts("1.234", &plain), ["rack_pitch 1.234 mm"]);
}

#[test]
fn what_is_wrong_is_said_with_its_place_and_nothing_is_lost() {
    for (text, expected) in [
        ("hello", "error[bad-table]: block holds no table of numbers"),
        ("", "error[bad-table]: block holds no table of numbers"),
        ("1.5;1,5", "block:1:5: error[bad-table]: the block has decimal points and commas: `1.5` and `1,5`"),
        ("rack_pitch;rack_pitch\n1;2", "block:1:12: error[bad-table]: `rack_pitch` names rack_pitch a second time"),
        ("rack_pitch;dp\n1;2", "block:1:12: error[bad-table]: `dp` names rack_pitch a second time"),
        ("rack_pitch;lead\n1;2;3\n", "block:2:1: error[bad-table]: this row has 3 cells, and the table has 2"),
        ("1;2;3;4", "block:1:1: error[bad-table]: the numbers have no names: 1 row by 4 columns"),
        (
            "rack pitch (Ist)\n1,5",
            "block:2:1: error[bad-table]: `rack pitch (Ist)` holds measured values, and nothing tells",
        ),
    ] {
        assert!(parts(text, &want())[0].starts_with(expected), "{:?}", parts(text, &want()));
    }
    let found = parts("nr;rack_over_roller;dp [um]\n1;25.013;12\n2;25.0l3;5\n3;;5\n4;13;5\n5;25;0\n", &want());
    assert_eq!(found[0], "1: rack_over_roller 0.013 mm rack_pitch 0.012 mm");
    assert!(
        found[1].contains("block:3:3: error[bad-table]: `rack_over_roller`: `25.0l3`: `l3` is not a unit"),
        "{}",
        found[1]
    );
    assert!(found[2].contains("block:4:1: error[bad-table]: there is no value for rack over-roller"), "{}", found[2]);
    assert!(found[4].starts_with("5: rack_over_roller 0 mm"), "{}", found[4]);
}

#[test]
fn spaces_and_teeth() {
    let text = "Lücke\tRollenmaß\tLage [mm]\n0\t25,0131\t2,9845\n1\t25,0\t8,95\n";
    let Pasted::Rack(rack) = understand("block", text, &want()).unwrap().pasted else { panic!("a rack") };
    assert_eq!(rack.rows.len(), 2);
    assert_eq!(rack.rows[1].position, Some(crate::cmm::Measured::Absolute("8.95".parse().unwrap())));
    // the same turned
    let text = "Lücke\t0\t1\nRollenmaß Abweichung [µm]\t13,1\t0\nLageabweichung [µm]\t1,5\t-2\n";
    let Pasted::Rack(rack) = understand("block", text, &want()).unwrap().pasted else { panic!("a rack") };
    assert_eq!(rack.rows[0].over_pin, Some(crate::cmm::Measured::Deviation("0.0131".parse().unwrap())));
    assert_eq!(rack.rows[1].space, 1);
    let text = "Zahn;radial [µm];fp links [µm];fp rechts [µm]\n0;1,5;2;3\n1;-1,5;-2;-3\n";
    let Pasted::Pinion(pinion) = understand("block", text, &want()).unwrap().pasted else { panic!("a pinion") };
    assert_eq!(pinion.rows[1].right_pitch, Some("-0.003".parse().unwrap()));
}

#[test]
fn the_account_names_everything() {
    let text = "Hallo,\nTeil;Rollenmaß;Härte;dp [µm]\n1;25,013;58;12\nGruß\n";
    assert_eq!(
        understand("block", text, &want()).unwrap().account.to_string(),
        "read as semicolons, decimal comma (otherwise 25013 mm is far from the nominal value 25 mm), names in line 2, 1 part: \
         \"Teil\" = part_id, \"Rollenmaß\" = rack_over_roller [mm, assumed] measured, nominal 25 mm, \"dp [µm]\" = rack_pitch [µm] \
         deviation; not used: Härte; no part of the table: lines 1 \"Hallo,\", 4 \"Gruß\""
    );
}

#[test]
fn nothing_that_is_pasted_panics() {
    let alphabet = [
        "1,5", "25.013", ";", "\t", ",", "|", "  ", " ", "\n", "\"", "pitch", "Lücke", "[µm]", "-", "°", "=", "Ist",
        "Merkmal",
    ];
    let mut state = 1_u64;
    for _ in 0..3000 {
        let mut text = String::new();
        for _ in 0..24 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            text.push_str(alphabet[usize::try_from(state >> 33).unwrap() % alphabet.len()]);
        }
        let _ = understand("block", &text, &want());
    }
}
