//! What a column means: units, nominal values, companions, characteristics.

use super::*;
use crate::quantity::Unit;

/// The first part of a table with one error; `cell` is its value.
fn value(title: &str, cell: &str, want: &Want) -> String {
    let text = format!("part;{title}\nP1;{cell}\n");
    parts(&text, want).swap_remove(0)
}

#[test]
fn units_of_lengths_and_angles() {
    let want = asks(&[DeviationKind::RackPitch, DeviationKind::RackLead]);
    for (title, expected) in [
        ("rack_pitch [nm]", "rack_pitch 0.000002 mm"),
        ("rack_pitch [\u{b5}m]", "rack_pitch 0.002 mm"),
        ("rack_pitch [\u{3bc}m]", "rack_pitch 0.002 mm"),
        ("rack_pitch [㎛]", "rack_pitch 0.002 mm"),
        ("rack_pitch (micron)", "rack_pitch 0.002 mm"),
        ("rack_pitch_um", "rack_pitch 0.002 mm"),
        ("rack_pitch in µm", "rack_pitch 0.002 mm"),
        ("rack_pitch /µm", "rack_pitch 0.002 mm"),
        ("rack_pitch [1/1000 mm]", "rack_pitch 0.002 mm"),
        ("rack_pitch [mm]", "rack_pitch 2 mm"),
        ("rack_pitch [cm]", "rack_pitch 20 mm"),
        ("rack_pitch [m]", "rack_pitch 2000 mm"),
        ("rack_pitch [in]", "rack_pitch 50.8 mm"),
        ("rack_pitch [\u{2033}]", "rack_pitch 50.8 mm"),
        ("rack_pitch [mil]", "rack_pitch 0.0508 mm"),
        ("rack_pitch [thou]", "rack_pitch 0.0508 mm"),
        ("rack_lead [°]", "rack_lead 2°"),
        ("rack_lead [deg]", "rack_lead 2°"),
        ("rack_lead [min]", "rack_lead 0.0333333333333°"),
        ("rack_lead [arcmin]", "rack_lead 0.0333333333333°"),
        ("rack_lead [\u{2032}]", "rack_lead 0.0333333333333°"),
        ("rack_lead [\u{2033}]", "rack_lead 0.0005555555556°"),
        ("rack_lead [mrad]", "rack_lead 0.114591559026°"),
        ("rack_lead [gon]", "rack_lead 1.8°"),
    ] {
        assert_eq!(value(title, "2", &want), format!("P1: {expected}"), "{title}");
    }
    // a unit in the cell counts before that of the heading
    assert_eq!(value("rack_pitch [mm]", "2 µm", &want), "P1: rack_pitch 0.002 mm");
    assert_eq!(value("rack_pitch", "2 µm", &want), "P1: rack_pitch 0.002 mm");
}

#[test]
fn a_unit_that_nothing_tells_or_that_is_none_is_refused() {
    let want = asks(&[DeviationKind::RackPitch, DeviationKind::RackLead]);
    for (title, expected) in [
        ("rack_pitch [kg]", "`rack_pitch [kg]`: `kg` is not a unit of a length"),
        ("rack_pitch [min]", "`rack_pitch [min]`: `min` is not a unit of a length"),
        ("rack_pitch [parsec]", "`rack_pitch [parsec]`: `parsec` is not a unit of a length"),
        ("rack_lead [N]", "`rack_lead [N]`: `N` is not a unit of an angle"),
        ("Teilung Zahnstange", "`Teilung Zahnstange` is rack_pitch, and nothing tells the unit of its numbers"),
        ("rack pitch error", "`rack pitch error` is rack_pitch, and nothing tells the unit of its numbers"),
    ] {
        let found = value(title, "2", &want);
        assert!(found.starts_with(&format!("error[bad-table]: block: {expected}")), "{title}: {found}");
        // what the spec says takes no unit out of a heading
        let has_none = !title.contains('[');
        assert_eq!(found.contains("in the spec: [batch.columns] rack_"), has_none, "{title}: {found}");
    }
    // a column that is called by its key has the unit of a spec, and that is said
    let assumed = |title: &str, want: &Want| reading(&format!("{title};note\n2;a\n"), want).columns[0].unit_is_assumed;
    assert!(assumed("rack_pitch", &want) && assumed("RACK_PITCH_deviation", &want) && !assumed("rack_pitch_mm", &want));
    let named = Want { own: vec![("Wert 7".to_owned(), Field::Error(DeviationKind::RackPitch))], ..Want::default() };
    assert!(assumed("Wert 7", &named));
    let micrometres = GivenColumn { unit: Unit::from_symbol("um"), ..given(DeviationKind::RackPitch, None) };
    let stated = Want { given: vec![micrometres], ..want };
    assert_eq!(value("Teilung Zahnstange", "2", &stated), "P1: rack_pitch 0.002 mm");
    let contradicted = value("Teilung Zahnstange [mm]", "2", &stated);
    assert!(contradicted.contains("the table says mm and the spec µm"), "{contradicted}");
}

#[test]
fn a_value_is_held_against_what_stands_beside_it() {
    let header = "Teil;Rollenmaß [mm];Soll [cm];Abw. [µm];OT [µm];UT [µm]";
    for (row, expected) in [
        ("25.013;2.5;13;50;-50", "rack_over_roller 0.013 mm"),
        ("25.0131;2.5;13;50;-50", "rack_over_roller 0.0131 mm"),
        ("25.02;2.5;61;50;-50", "rack_over_roller: the deviation beside it is 0.061 mm, and this one is 0.02 mm"),
        ("25;2.5;13;50;-50", "rack_over_roller: the deviation beside it is 0.013 mm, and this one is 0 mm"),
        ("25.013;2.5;;50;-50", "rack_over_roller 0.013 mm"),
        ("25.013;2.5;n.a.;;", "rack_over_roller 0.013 mm"),
        ("25.013;;;;", "rack_over_roller: there is no nominal value beside it"),
        ("25.5;2.5;;1;-1", "rack_over_roller: a deviation of 0.5 mm is more than 100 times the tolerance beside it"),
        ("13;2.5;;;", "rack_over_roller: 13 mm is far from the nominal value 25 mm"),
        ("0.013;2.5;;;", "rack_over_roller: 0.013 mm is far from the nominal value 25 mm"),
        (";2.5;;50;-50", "rack_over_roller missing"),
    ] {
        let want = Want { decimal: Some(DecimalMark::Point), ..asks(&[DeviationKind::RackOverRoller]) };
        let found = parts(&format!("{header}\nP1;{row}\n"), &want);
        assert!(found[0].starts_with(&format!("P1: {expected}")), "{row}: {found:?}");
    }
    let roles = reading(&format!("{header}\nP1;25.5;2.5;500;50;-50\n"), &want()).columns;
    let roles: Vec<_> = roles.iter().map(|column| column.role.as_str()).collect();
    let of = |(what, note): (&str, &str)| format!("{what} of rack_over_roller{note}");
    let tolerances = [("upper tolerance", ", not judged"), ("lower tolerance", ", not judged")];
    let companions = [("deviation", ", checked"), ("nominal", ""), tolerances[0], tolerances[1]].map(of);
    assert_eq!(roles[2..], companions);
}

#[test]
fn a_deviation_where_a_measure_stands_and_the_reverse() {
    let with_module = Want { module: Some("2".parse().unwrap()), ..want() };
    let text = "rack_over_roller;rack_pitch [mm]\n25.01;12\n0.01;1\n25.01;1\n";
    let found = parts(text, &with_module);
    assert!(found[0].contains("rack_pitch: 12 mm is too much for a deviation (the module is 2 mm)"), "{found:?}");
    assert!(found[1].contains("rack_over_roller: 0.01 mm is far from the nominal value 25 mm"), "{found:?}");
    assert_eq!(found[2], "rack_over_roller 0.01 mm rack_pitch 1 mm");
    // limits of size and allowances are both tolerances
    let text = "Merkmal;Soll;Ist;OG;UG;Einheit\nRollenmaß;25,000;25,016;25,030;24,970;mm\nTeilung Zahnstange;0;0,01;20;-20;µm\n";
    let found = read(text, &want()).unwrap();
    assert_eq!(found.parts, ["rack_over_roller 0.016 mm rack_pitch 0.00001 mm"]);
    let note = "block: `Teilung Zahnstange`: every value is less than a 500th of its tolerance: check the unit";
    assert_eq!(found.reading.notes, [note]);
}

#[test]
fn a_nominal_value_in_the_table_and_another_in_the_spec() {
    let text = "part;rack_over_roller;rack_over_roller Soll\nP1;25.51;25.5\nP2;25.01;25\n";
    let found = parts(text, &want());
    let expected = "P1: rack_over_roller: the nominal value is 25.5 mm in the table and 25 mm in the spec";
    assert_eq!(found, [expected, "P2: rack_over_roller 0.01 mm"]);
}

#[test]
fn the_deviation_of_the_helix_in_micrometres() {
    let want = asks(&[DeviationKind::RackLead]);
    let face = Want { face_width: Some("18".parse().unwrap()), ..want.clone() };
    let length = GivenColumn { length: Some("18".parse().unwrap()), ..given(DeviationKind::RackLead, None) };
    let stated = Want { given: vec![length], ..want.clone() };
    // atan(20 µm / 18 mm)
    let slope = "P1: rack_lead 0.063661951038433°";
    for (text, want) in [
        ("part;f_Hβ [µm];Auswertelänge [mm]\nP1;20;18\n", &want),
        ("part;f_Hβ [µm];Auswertelänge [cm]\nP1;20;1.8\n", &want),
        ("part;f_Hβ [µm]\nP1;20\n", &face),
        ("part;f_Hβ [mm]\nP1;0.02\n", &stated),
    ] {
        assert_eq!(parts(text, want), [slope], "{text}");
    }
    assert!(reading("part;f_Hβ [µm]\nP1;20\n", &face).notes[0].contains("is evaluated over the rack's face width"));
    let missing = parts("part;f_Hβ [µm];Auswertelänge [mm]\nP1;20;18\nP2;20;\n", &want);
    assert_eq!(missing[1], "P2: rack_lead: there is no evaluation length for this f_Hβ");
    assert!(refused("part;f_Hβ [µm]\nP1;20\n", &want).contains("nothing tells its evaluation length"));
}

#[test]
fn what_is_uncertain_is_not_used() {
    let text = "rack_pitch [µm];U(rack_pitch) [µm]\n20 ± 0.8;1\n";
    let found = read(text, &want()).unwrap();
    assert_eq!(found.parts, ["rack_pitch 0.02 mm"]);
    assert_eq!(found.reading.notes.len(), 2, "{:?}", found.reading.notes);
}

#[test]
fn characteristics_that_contradict_themselves() {
    for (text, expected) in [
        (
            "id;actual\nrack_pitch;0.016\nrack_pitch;0.017\n",
            "block:2:1: error[bad-table]: `rack_pitch` names rack_pitch a second time",
        ),
        (
            "part;id;actual;unit\n1;rack_pitch;0.016;mm\n2;rack_pitch;17;um\n",
            "block:3:1: error[bad-table]: line 3: nothing tells one unit",
        ),
        (
            "Merkmal;Ist;Einheit\nTeilung Zahnstange;3;\n",
            "error[bad-table]: block: `Teilung Zahnstange` is rack_pitch, and nothing tells the unit",
        ),
        ("Merkmal;Soll;OG\nrack_pitch;3;4\n", "block:1:9: error[bad-table]: `Soll` is no part's value"),
        ("Merkmal;Ist;Soll\nrack_pitch;3;4;5\n", "block:2:1: error[bad-table]: line 2: the row has 4 cells"),
    ] {
        let found = refused(text, &asks(&[DeviationKind::RackPitch]));
        assert!(found.starts_with(expected), "{text}: {found}");
    }
    // nominal values and tolerances are no parts
    let text = "Merkmal;Soll;OG;UG;Teil 1;Teil 2\nrack_pitch;0;0,02;-0,02;0,011;0,012\n";
    assert_eq!(parts(text, &want()), ["Teil 1: rack_pitch 0.011 mm", "Teil 2: rack_pitch 0.012 mm"]);
    // a part without one of the values
    let text = "part;id;actual\nP1;rack_pitch;0.01\nP2;rack_pitch;0.02\nP2;rack_over_roller;0.03\n";
    let deviations = asks(&[DeviationKind::RackPitch, DeviationKind::RackOverRoller]);
    let expected =
        ["P1: rack_pitch 0.01 mm rack_over_roller missing", "P2: rack_pitch 0.02 mm rack_over_roller 0.03 mm"];
    assert_eq!(parts(text, &deviations), expected);
}
