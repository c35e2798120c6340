//! A size where a deviation belongs, a mistaken unit: said by every command, with the same words.

use crate::process::{Ended, Folder, run};

fn notes(ended: &Ended) -> Vec<String> {
    let json = ended.json();
    let notes = json["notes"].as_array().expect("notes");
    notes.iter().filter_map(|note| note.as_str().map(str::to_owned)).collect()
}

const PITCH: &str = "`rack_pitch`: 12 mm is large for a deviation; if that is µm, write \"12 um\"";
const PAIR: &str = "[pair]\nnormal_module = 1.83\nnormal_pressure_angle = 20\n";

#[test]
fn eval_warns_where_the_value_stands_and_in_its_notes() {
    let spec = "[pair]\nnormal_pressure_angle = 20\n[errors]\nrack_pitch = 12\n";
    let ended = run(&["eval", "-", "--format", "json"], spec);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("warning[implausible]") && ended.stderr.contains("<stdin>:4:14"), "{}", ended.stderr);
    assert!(ended.stderr.contains("write \"12 um\""), "{}", ended.stderr);
    assert!(notes(&ended).contains(&PITCH.to_owned()), "{}", ended.stdout);
    let meant = run(&["eval", "-", "--format", "json"], &spec.replace("12", "\"12 um\""));
    assert_eq!((meant.code, meant.stderr.as_str()), (Some(0), ""));
}

#[test]
fn eval_refuses_what_no_part_can_have() {
    for (spec, place, remedy) in [
        (format!("{PAIR}[errors]\nrack_pitch = 12\n"), "<stdin>:5:14", "write \"12 um\""),
        (format!("{PAIR}[errors]\nrack_over_roller = 25.013\n"), "<stdin>:5:20", "{ measured = 25.013, nominal = … }"),
        (
            "[pair]\nnormal_pressure_angle = 0.349\n[errors]\nrack_pitch = 0.01\n".to_owned(),
            "<stdin>:2:25",
            "0.349 rad",
        ),
    ] {
        let ended = run(&["eval", "-"], &spec);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{spec}");
        assert!(ended.stderr.contains("error[implausible]"), "{}", ended.stderr);
        assert!(ended.stderr.contains(place) && ended.stderr.contains(remedy), "{}", ended.stderr);
    }
}

#[test]
fn a_warning_changes_no_verdict() {
    let spec = "[errors]\nrack_over_roller = 25\n[limits]\ncenter_distance = \"±20 um\"\n";
    assert_eq!(run(&["eval", "-"], spec).code, Some(1));
    assert_eq!(run(&["eval", "-"], &spec.replace("±20 um", "±30")).code, Some(0));
}

#[test]
fn calc_warns_and_refuses() {
    let ended = run(&["calc", "over-roller", "25.013"], "");
    assert_eq!((ended.code, ended.stdout.trim()), (Some(0), "25.013000 mm"));
    assert!(ended.stderr.contains("--measured 25.013 --nominal …"), "{}", ended.stderr);
    let ended = run(&["calc", "pitch", "12um", "--pressure-angle", "20", "--helix-angle", "0.436"], "");
    assert_eq!(ended.code, Some(0));
    assert!(ended.stderr.contains("--helix-angle: 0.436° is small for a helix angle"), "{}", ended.stderr);
    let ended = run(&["calc", "pin", "--normal-module", "2", "--pressure-angle", "2", "--format", "json"], "");
    let doubt = "--pressure-angle: 2° is small for a pressure angle; check the unit and the decimal mark";
    assert!(ended.stdout.ends_with(&format!("\"notes\": [\n    \"{doubt}\"\n  ]\n}}\n")), "{}", ended.stdout);
    let ended = run(&["calc", "pitch", "12um", "--pressure-angle", "0.349"], "");
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""));
    assert!(ended.stderr.contains("if that is radians, write 0.349rad"), "{}", ended.stderr);
    let ended = run(&["calc", "pitch", "12um", "--pressure-angle", "0.349rad", "--helix-angle", "12"], "");
    assert_eq!(ended.code, Some(0));
    assert!(!ended.stderr.contains("implausible"), "{}", ended.stderr);
}

#[test]
fn mesh_warns_of_a_tooth_and_refuses_a_table_in_the_wrong_unit() {
    let spec = std::fs::read_to_string("examples/mesh.toml").expect("the example is there");
    let rack = spec.find("[[rack.deviation]]").expect("the example has deviations");
    let spec = format!("{}[[rack.deviation]]\nteeth = \"4\"\nshift = 0.6\n", &spec[..rack]);
    let ended = run(&["mesh", "-", "--format", "json"], &spec);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("`rack.deviation`: 0.6 mm is large for a deviation"), "{}", ended.stderr);
    assert!(notes(&ended).iter().any(|note| note.contains("0.6 mm is large for a deviation")), "{}", ended.stdout);

    let folder = Folder::new("plausible-mesh");
    std::fs::write(folder.path("pinion.csv"), "tooth,radial_deviation\n0,0.002\n1,8\n").expect("written");
    let start = spec.find("[[rack.deviation]]").expect("just written");
    let with_table = spec[..start].replace("[pinion]\n", "[pinion]\nmeasured = \"pinion.csv\"\n");
    std::fs::write(folder.path("spec.toml"), with_table).expect("written");
    let ended = run(&["mesh", &folder.path("spec.toml")], "");
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    assert!(ended.stderr.contains("line 3: radial deviation: 8 mm is too large for a deviation"), "{}", ended.stderr);
}

const TABLE: &str = "part_id,rack_over_roller\nA,0.01\nB,25.013\nC,0.02\n";

#[test]
fn tables_count_what_is_suspicious_and_reject_what_is_impossible() {
    let folder = Folder::new("plausible-tables");
    let spec = folder.path("spec.toml");
    let table = folder.path("parts.csv");
    let limits = "[errors]\nrack_over_roller = { nominal = 0 }\n[limits]\ncenter_distance = \"±50 um\"\n";
    let column =
        "[table.columns]\nrack_over_roller = { kind = \"deviation\" }\n[limits]\ncenter_distance = \"±50 um\"\n";
    std::fs::write(&table, TABLE).expect("written");
    for columns in [limits, column] {
        std::fs::write(&spec, columns).expect("written");
        let note = "`rack_over_roller`: 1 value is large for a deviation, 1 mm or more";
        for command in ["batch", "paste"] {
            let ended = run(&[command, &spec, &table], "");
            assert_eq!(ended.code, Some(1), "{command}: {}", ended.stderr);
            assert_eq!(ended.stderr.matches(note).count(), 1, "{command}: {}", ended.stderr);
        }
        let summary = run(&["batch", &spec, &table, "--summary", "--format", "json"], "");
        assert!(notes(&summary).iter().any(|said| said.contains(note)), "{}", summary.stdout);

        std::fs::write(&spec, format!("{PAIR}{columns}")).expect("written");
        for command in ["batch", "paste"] {
            let ended = run(&[command, &spec, &table], "");
            assert_eq!(ended.code, Some(2), "{command}: {}", ended.stderr);
            assert!(
                ended.stderr.contains("bad-row") && ended.stderr.contains("25.013 mm is"),
                "{command}: {}",
                ended.stderr
            );
            assert!(!ended.stderr.contains(note), "{command}: {}", ended.stderr);
        }
    }
    std::fs::write(&spec, column).expect("written");
    std::fs::write(&table, TABLE.replace("25.013", "0.015")).expect("written");
    for command in ["batch", "paste"] {
        let ended = run(&[command, &spec, &table], "");
        assert_eq!(ended.code, Some(0), "{command}: {}", ended.stderr);
        assert!(!ended.stderr.contains("large for"), "{command}: {}", ended.stderr);
    }
}

#[test]
fn a_column_of_arc_minutes_read_as_degrees() {
    let folder = Folder::new("plausible-lead");
    let (spec, table) = (folder.path("spec.toml"), folder.path("parts.csv"));
    std::fs::write(&spec, "[pair]\nnormal_pressure_angle = 20\n[rack]\nface_width = 20\n").expect("written");
    std::fs::write(&table, "part_id,rack_lead\nA,3\nB,-4.5\nC,0.1\nD,60\n").expect("written");
    for command in ["batch", "paste"] {
        let ended = run(&[command, &spec, &table], "");
        assert_eq!(ended.code, Some(2), "{command}: {}", ended.stderr);
        let note = "`rack_lead`: 2 values are large for a lead error, 2° or more: check the unit";
        assert!(ended.stderr.contains(note), "{command}: {}", ended.stderr);
        assert!(ended.stderr.contains("60° is too large for a lead error"), "{command}: {}", ended.stderr);
    }
}

/// A pin that rests on tips or on the root has a measure that no rack has.
#[test]
fn a_pin_that_flanks_do_not_carry_is_refused() {
    let calc = |pin: &str| {
        let options = ["--normal-module", "2", "--pressure-angle", "20", "--datum", "22", "--format", "json"];
        run(&[&["calc", "over-pin", "--pin", pin][..], &options[..]].concat(), "")
    };
    let spec = |measured: &str, roller: &str, addendum: &str| {
        format!(
            "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\ndatum = 22\naddendum = {addendum}\n\
             [errors]\nrack_over_roller = {{ measured = {measured}, roller = {roller} }}\n"
        )
    };
    for (pin, said) in [("40", "40 mm is too large for a pin"), ("1", "1 mm is too small for a pin")] {
        let ended = calc(pin);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{pin}");
        assert!(
            ended.stderr.contains("error[implausible]: --pin: ") && ended.stderr.contains(said),
            "{}",
            ended.stderr
        );
        assert!(ended.stderr.contains("one that touches at the reference plane has 3.343 mm"), "{}", ended.stderr);
        let measured = run(&["measure", "examples/mesh.toml", "--pin", if pin == "1" { "0.5" } else { "12" }], "");
        assert_eq!((measured.code, measured.stdout.as_str()), (Some(2), ""), "{}", measured.stderr);
        let ended = run(&["eval", "-"], &spec("24", pin, "2"));
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
        assert!(ended.stderr.contains(&format!("`roller`: {said}")), "{}", ended.stderr);
    }
    for (pin, is_doubted) in [("2", false), ("4", false), ("5.5", true)] {
        let ended = calc(pin);
        assert_eq!(ended.code, Some(0), "{pin}: {}", ended.stderr);
        assert_eq!(ended.stdout.contains("mm is large for a pin"), is_doubted, "{pin}: {}", ended.stdout);
    }
    // touches at 0.85 mm: below the tips of one rack, above those of another
    for (addendum, code) in [("0.9", 0), ("0.8", 2)] {
        let ended = run(&["eval", "-"], &spec("25.532", "4", addendum));
        assert_eq!(ended.code, Some(code), "{addendum}: {}", ended.stderr);
    }
}

#[test]
fn class_doubts_its_options() {
    let class = |options: &[&str]| {
        let size =
            ["class", "--standard", "iso1328-1:1995", "--grade", "7", "--normal-module", "2", "--face-width", "20"];
        run(&[&size, options].concat(), "")
    };
    let ended = class(&["--diameter", "14", "--helix-angle", "0.436", "--pressure-angle", "0.349"]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""));
    assert!(ended.stderr.contains("if that is radians, write 0.349rad"), "{}", ended.stderr);
    let ended = class(&["--diameter", "14", "--helix-angle", "0.436", "--format", "json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(notes(&ended).iter().any(|note| note.starts_with("--helix-angle: 0.436° is small")), "{}", ended.stdout);
    let teeth = ["--tooth-count", "7", "--helix-angle", "25", "--format", "json", "--diameter"];
    for (diameter, is_doubted) in [("100", true), ("14.9", false), ("18", false)] {
        let ended = class(&[&teeth[..], &[diameter]].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let said =
            notes(&ended).iter().any(|note| note.contains("m_n z / cos β of m_n = 2 mm, z = 7, β = 25° is 15.447 mm"));
        assert_eq!((said, ended.stderr.contains("warning[implausible]")), (is_doubted, is_doubted), "{}", ended.stdout);
    }
}
