//! What names nothing known: which of it ends the run, and which is listed.

use super::*;

fn strangers(text: &str, want: &Want) -> Vec<String> {
    let found = read(text, want).unwrap_or_else(|problem| panic!("{text}: {problem}"));
    let shown = |stranger: &Stranger| {
        format!(
            "{}: {} ({}) near {}",
            stranger.place,
            stranger.title,
            stranger.values.join(" "),
            stranger.near.join(" ")
        )
    };
    found.strangers.iter().map(shown).collect()
}

fn unused(text: &str, want: &Want) -> Vec<String> {
    reading(text, want).not_used.iter().map(|unused| format!("{}: {}", unused.title, unused.why)).collect()
}

/// A table with a column more.
fn with(title: &str, cell: &str) -> String {
    format!("part;rack_over_roller;{title}\nP1;25,5;{cell}\n")
}

#[test]
fn a_column_that_may_be_a_measurement_is_none_that_is_left_out() {
    for (title, cell, near) in [
        ("rack_pich [um]", "200", "rack_pitch"),
        ("rack_pich", "200", "rack_pitch"),
        ("Teilungsabweichnug [µm]", "200", "rack_pitch pinion_pitch"),
        ("Taster 3 [mm]", "3,5", ""),
        ("Winkel 7 (deg)", "3,5", ""),
        ("Taster 3", "3,5 mm", ""),
        ("profile form [um]", "2", ""),
    ] {
        let expected = format!("column 3: {title} ({cell}) near {near}");
        assert_eq!(strangers(&with(title, cell), &want()), [expected], "{title}");
    }
    for title in ["pitch [um]", "erreur de pas [um]", "rack_pitch"] {
        assert_eq!(strangers(&with(title, "200"), &want()), [""; 0], "{title}");
    }
}

#[test]
fn a_column_that_cannot_be_a_measurement_is_listed() {
    for (title, cell) in [
        ("Temperatur [°C]", "20,5"),
        ("Kraft [N]", "12"),
        ("Steifigkeit [N/mm]", "12"),
        ("Zyklus [s]", "12"),
        ("Drehzahl [rpm]", "12"),
        ("Datum", "2026-01-02"),
        ("Uhrzeit", "12:30"),
        ("Bediener", "Jo"),
        ("Maschine", "7"),
        ("Serie", "4711"),
        ("Modul [mm]", "2,5"),
        ("Bemerkung", "25 Stück gemessen"),
        ("foo", "17"),
        ("shift", "2"),
        ("rack_pich [um]", "good"),
    ] {
        let text = with(title, cell);
        assert_eq!(strangers(&text, &want()), [""; 0], "{title}");
        assert_eq!(unused(&text, &want()), [format!("{title}: no measurement")], "{title}");
    }
}

#[test]
fn the_user_leaves_out_what_no_rule_may() {
    let text = "part;rack_over_roller;rack_pitch;Taster 3 [mm];Taster 4 [mm]\nP1;25,5;1;3;4\n";
    assert_eq!(strangers(text, &want()).len(), 2);
    let ignoring = |pattern: &str| Want { ignored: vec![pattern.to_owned()], ..want() };
    assert_eq!(strangers(text, &ignoring("Taster*")), [""; 0]);
    let why = "ignored by the user";
    assert_eq!(unused(text, &ignoring("Taster *")), [format!("Taster 3 [mm]: {why}"), format!("Taster 4 [mm]: {why}")]);
    assert_eq!(strangers(text, &ignoring("Taster 3")), ["column 5: Taster 4 [mm] (4) near "]);
    assert_eq!(strangers(text, &ignoring("Taster 3 [mm]")), ["column 5: Taster 4 [mm] (4) near "]);
    // also a column that is known
    let known = read(text, &Want { ignored: vec!["rack_pitch".to_owned(), "Taster*".to_owned()], ..want() }).unwrap();
    assert_eq!(known.parts, ["P1: rack_over_roller 0.5 mm"]);
    // others hold once every error of the spec is there
    let others = Want { others_ignored: true, ..want() };
    assert_eq!(strangers(text, &others), [""; 0]);
    assert_eq!(unused(text, &others)[0], "Taster 3 [mm]: others are ignored");
    let lacking = "part;rack_over_roller;Taster 3 [mm]\nP1;25,5;3\n";
    assert_eq!(strangers(lacking, &others), ["column 3: Taster 3 [mm] (3) near "]);
    let table =
        Container::open("block", Source::bytes(lacking.into()), &others).unwrap().table("block", &others).unwrap();
    assert_eq!(table.to_be_named, [DeviationKind::RackPitch]);
    let refused = refusal(&table.strangers, &table.to_be_named).unwrap();
    assert!(
        refused
            .help
            .unwrap()
            .ends_with("others = \"ignore\" leaves it out once [batch.columns] names the column of rack_pitch")
    );
}

#[test]
fn lines_of_a_block_and_rows_of_characteristics() {
    let known = "rack_over_roller: 25.5 mm\n";
    for (line, expected) in [
        ("Stirnteilung Zahnstange 0,1200", "line 2: Stirnteilung Zahnstange (0,1200) near rack_pitch"),
        ("003 Ptich error of rack 0.2100", "line 2: 003 Ptich error of rack (0.2100) near rack_pitch"),
        ("003 Taster 3 mm", "line 2: 003 Taster (3 mm) near "),
    ] {
        assert_eq!(strangers(&format!("{known}{line}\n"), &want()), [expected], "{line}");
    }
    for line in
        ["Page 3 of 7", "Taster 3 mm", "Order 4711", "measured on 3.4. at 20 °C", "Best regards", "Tel. 0711 123"]
    {
        assert_eq!(strangers(&format!("{known}{line}\n"), &want()), [""; 0], "{line}");
    }
    assert_eq!(
        parts(&format!("{known}003 Pitch error of rack 0.21 mm\n"), &want()),
        ["rack_over_roller 0.5 mm rack_pitch 0.21 mm"]
    );
    // among values a line is a measurement, whatever it is called
    let among = "rack_over_roller: 25.5 mm\nfoo 80\nrack_pitch: 12 um\n";
    assert_eq!(strangers(among, &want()), ["line 2: foo (80) near "]);
    let rows = "id;actual;unit\nrack_over_roller;25.5;mm\nfoo;80;\nbar;good;\nDatum;3;\n";
    assert_eq!(strangers(rows, &want()), ["line 3: foo (80) near "]);
}

#[test]
fn the_refusal_lists_all_of_them_with_both_remedies() {
    let strangers = read("part;rack_pich [um];Taster \"3\" [mm]\nP1;200;3\n", &want()).unwrap().strangers;
    let refused = refusal(&strangers, &[]).unwrap();
    assert_eq!(
        refused.to_string(),
        "error[not-understood]: not understood, so nothing is judged: 2 columns or lines that may be measurements\n  block, column 2: \
         `rack_pich [um]`: 200; near rack_pitch\n  block, column 3: `Taster \"3\" [mm]`: 3"
    );
    assert_eq!(
        refused.help.unwrap(),
        "say in the spec what it is, under [batch.columns]: rack_pitch = { name = \"rack_pich\", unit = \"um\" }; KEY = \
         { name = \"Taster \\\"3\\\"\", unit = \"mm\" }; or leave it out: [batch] ignore = [\"rack_pich\", \
         \"Taster \\\"3\\\"\"], or on the command line --ignore 'rack_pich' --ignore 'Taster \"3\"'; KEY is one of \
         rack_over_roller, rack_pitch, rack_lead, pinion_radial, pinion_pitch, pinion_lead"
    );
    assert_eq!(refusal(&[], &[DeviationKind::RackPitch]), None);
}

#[test]
fn a_line_of_unknown_names_is_a_header_and_not_dropped() {
    for text in ["Wert A [mm];Wert B [mm]\n1;2\n", "foo;rack_pich\n1;2\n"] {
        assert!(!strangers(text, &want()).is_empty(), "{text}");
    }
    // nothing of it can be a measurement, and nothing is taken for one
    let found = read("foo;bar\n1;2\n", &want()).unwrap();
    assert_eq!(found.parts, [""]);
    assert_eq!(found.reading.not_used.len(), 2);
}
