//! What stands beside a verdict: why it is open, and what was taken for granted.

use super::*;

/// Of what is no placement nothing is measured.
#[test]
fn teeth_that_are_not_told_are_not_measured() {
    let rolls = format!("{PAPER}[support]\nroll = \"free\"\nroll_axis_depth = 8\n[errors]\nrack_pitch = \"12 um\"\n");
    let scatter = format!("{PAPER}[scatter]\nrack_pitch = \"4 um\"\n");
    let beside =
        format!("{PAPER}[errors]\nrack_pitch = \"12 um\"\n[[pinion.deviation]]\nteeth = 3\nshift = \"5 um\"\n");
    for spec in [rolls, scatter, beside] {
        let ended = run(&["measure", "-"], &spec);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
        assert!(ended.stderr.contains("[[rack.deviation]]"), "{}", ended.stderr);
    }
}

/// The height of teeth that a lead's range takes for granted is said with where it is from; a given addendum that is higher
/// counts.
#[test]
fn the_height_that_a_lead_is_taken_to_reach_is_said() {
    let spec = |pair: &str, rack: &str| {
        format!(
            "[pair]\nnormal_pressure_angle = 20\n{pair}[rack]\nhelix_angle = 40\nface_width = 8\n{rack}\
             [errors]\nrack_lead = \"0.6 deg\"\n[limits]\ncenter_distance = {{ upper = 0.18 }}\n"
        )
    };
    for (pair, rack, code, words) in [
        (
            "",
            "",
            0,
            "within 2 mm over and under the reference plane, a quarter of the face width, as `pair.normal_module` is not given",
        ),
        ("", "addendum = 6\n", 1, "within 6 mm over and under the reference plane, `rack.addendum`"),
        ("normal_module = 6\n", "", 1, "within 9 mm over and under the reference plane, 1.5 normal modules"),
    ] {
        let ended = eval(&spec(pair, rack));
        let notes = ended.json()["notes"].to_string();
        assert!(ended.code == Some(code) && notes.contains(words), "{}", ended.stdout);
    }
}

/// Known teeth count beside errors of the other part, and a note says so.
#[test]
fn known_teeth_beside_errors_are_named() {
    let spec = format!("{PAPER}[[rack.deviation]]\nteeth = 3\npitch = \"20 um\"\n[errors]\npinion_pitch = \"10 um\"\n");
    let notes = eval(&spec).json()["notes"].to_string();
    assert!(notes.contains("the sum counts the teeth that are known one by one: ΔCD = "), "{notes}");
}

/// `simulate` places errors as `mesh` does: each on as many teeth as its extent says.
#[test]
fn a_simulation_says_where_its_errors_are() {
    for (error, extent, where_it_is) in [
        ("rack_pitch", "one", "rack pitch, before tooth 1"),
        ("rack_pitch", "all", "on all teeth alike"),
        ("pinion_radial", "all", "on all teeth alike"),
        ("pinion_radial", "one", "pinion radial, space 7"),
    ] {
        let spec = format!(
            "{PAPER}[errors]\n{error} = {{ value = \"20 um\", extent = \"{extent}\" }}\n[simulation]\nstroke = 1\n"
        );
        let ended = run(&["simulate", "-", "--quasi-static", "--format", "json"], &spec);
        let notes = ended.json()["notes"].to_string();
        assert!(notes.contains(where_it_is), "{notes}");
    }
}

/// What a measured table cannot hold is named, and a pinion's table is read back.
#[test]
fn what_no_reading_tells_is_named() {
    let folder = Folder::new("measured-pinion");
    let table = folder.path("pinion.csv");
    let spec = format!("{PAPER}[[pinion.deviation]]\neccentricity = {{ amount = \"10 um\", tooth = 3 }}\n");
    let ended = run(&["measure", "-", "--part", "pinion", "--format", "csv"], &spec);
    assert!(ended.stderr.contains("no reading tells of the pinion: its eccentricity"), "{}", ended.stderr);
    std::fs::write(&table, &ended.stdout).expect("written");
    let back = folder.path("back.toml");
    std::fs::write(&back, PAPER.replace("[pinion]\n", "[pinion]\nmeasured = \"pinion.csv\"\n")).expect("written");
    assert_eq!(run(&["mesh", &back], "").code, Some(0));
}

/// A worst case that is open has its reason where it is read, with limits or without.
#[test]
fn an_open_worst_case_says_why() {
    let spec = "[pair]\nnormal_pressure_angle = 20\n[errors]\nrack_pitch = { value = \"30 um\", extent = \"each\" }\n";
    let why = "errors of many pitches add up over the teeth in contact: the pair's geometry is missing";
    for (limits, code) in [("", 0), ("[limits]\ncenter_distance = \"±0.1\"\n", 2)] {
        for format in ["table", "csv", "json", "markdown"] {
            let ended = run(&["eval", "-", "--format", format], &format!("{spec}{limits}"));
            let says =
                [why, "there is no worst case without the pair's geometry"].map(|text| ended.stdout.contains(text));
            assert!(ended.code == Some(code) && says != [false; 2], "{format}: {}", ended.stdout);
        }
    }
}

/// Whoever reads a verdict that is none reads why, in every format.
#[test]
fn an_open_verdict_has_its_reason_in_json_and_csv() {
    let why =
        |on: &str, rule: &str| format!("{on} is too near a limit to prove conformity or non-conformity (rule {rule})");
    let near = why("ΔCD (worst case)", "guard 5 µm");
    let spec =
        "[errors]\nrack_over_roller = 0.01\n[limits]\ncenter_distance = \"±0.012\"\n[decision]\nrule = \"guard=5um\"\n";
    let json = eval(spec).json();
    assert_eq!((&json["reason"], &json["limits"][0]["reason"]), (&near.clone().into(), &near.clone().into()));
    let csv = run(&["eval", "-", "--format", "csv"], spec);
    assert!(csv.stdout.contains(&near), "{}", csv.stdout);
    let passed = eval(&spec.replace("0.012", "0.02")).json();
    assert_eq!((&passed["verdict"], &passed["reason"]), (&"pass".into(), &Value::Null));

    let folder = Folder::new("reasons");
    let (spec_file, table) = (folder.path("spec.toml"), folder.path("parts.csv"));
    let pair = "[pair]\nnormal_pressure_angle = 20\n";
    let uncertain = spec.replace("0.01\n", "{ u = \"1 um\" }\n").replace("guard=5um", "iso14253");
    let needed = "the rule iso14253 needs an uncertainty of every value";
    for (text, rows, reasons) in [
        (spec.replace("rack_over_roller = 0.01\n", ""), "rack_over_roller [mm]\n0.01\n0.005\n", [&near, ""]),
        (format!("{pair}{uncertain}"), "rack_over_roller [mm],rack_pitch [mm]\n0.01,0.002\n0.005,0.001\n", [needed; 2]),
    ] {
        std::fs::write(&spec_file, &text).expect("written");
        std::fs::write(&table, rows).expect("written");
        for command in ["batch", "paste"] {
            let ended = run(&[command, &spec_file, &table, "--format", "csv"], "");
            let written: Vec<_> = ended.stdout.lines().skip(1).collect();
            assert_eq!(written.len(), 2, "{command}: {}", ended.stderr);
            for (row, reason) in written.iter().zip(reasons) {
                assert!(row.contains(reason) && row.contains("rule") != reason.is_empty(), "{command}: {row}");
            }
        }
    }
}

/// Of several verdicts the one that decides the exit status is the last line; each says what it is on.
#[test]
fn the_worst_verdict_is_said_last() {
    let spec = std::fs::read_to_string("examples/function-errors.toml").expect("it can be read");
    let spec = spec.replace("\"0.5 N m\"", "\"0.0001 N m\"") + "\ncenter_distance = \"±0.2\"\n";
    for command in ["eval", "mesh"] {
        let ended = run(&[command, "-"], &spec);
        let verdicts: Vec<_> = ended.stdout.lines().filter(|line| line.contains(": ")).collect();
        let verdicts: Vec<_> = verdicts.iter().filter_map(|line| line.split_once(": ")).map(|(word, _)| word).collect();
        assert_eq!(ended.code, Some(1), "{command}: {}", ended.stderr);
        assert!(verdicts.contains(&"PASS") && verdicts.last() == Some(&"FAIL"), "{command}: {}", ended.stdout);
    }
}

/// A formula that counts the ends of a face that the other part does not reach is said to leave its bound.
#[test]
fn a_formula_beyond_its_bound_is_said_to_be() {
    let spec = |width: &str| {
        let pair = PAPER.replace("face_width = 23.5", width);
        format!("{pair}[errors]\nrack_lead = \"6 arcmin\"\n[limits]\ncenter_distance = \"±0.2\"\n")
    };
    for (width, is_said) in [("face_width = 23.5", false), ("face_width = 12", true)] {
        let ended = run(&["eval", "-"], &spec(width));
        assert_eq!(ended.stdout.contains("counts the ends of its own face"), is_said, "{}", ended.stdout);
    }
}

/// The last line of `mesh` says by how much a limit is missed, as that of `eval` does.
#[test]
fn a_mesh_says_by_how_much_a_limit_is_missed() {
    let spec =
        format!("{PAPER}[errors]\nrack_over_roller = \"20 um\"\n[limits]\ncenter_distance = {{ upper = 0.015 }}\n");
    let ended = run(&["mesh", "-", "--to", "5"], &spec);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let last = "FAIL: ΔCD (exact mesh): +0.0200 mm is 0.0050 mm above the limit 0.015 mm (judged by the exact mesh of the known \
                teeth)\n";
    assert!(ended.stdout.ends_with(last), "{}", ended.stdout);
}

/// A limit that nothing judges is said in the result, and decides the exit status of every format.
#[test]
fn a_limit_that_is_not_judged_is_said_in_the_result() {
    let teeth = "space;over_pin_deviation [um];position_deviation [um]\n0;1;0\n1;2;0\n2;1;0\n";
    let folder = Folder::new("unjudged-teeth");
    let spec = folder.path("spec.toml");
    for limit in ["center_distance", "rack_pitch"] {
        let text = format!("[pair]\nnormal_module = 2\nnormal_pressure_angle = 19.9\n[limits]\n{limit} = \"±0.01\"\n");
        std::fs::write(&spec, text).expect("written");
        let ended = run(&["paste", &spec, "--format", "json"], teeth);
        assert_eq!(ended.code, Some(2), "{limit}: {}", ended.stderr);
        assert!(ended.stdout.contains("no limit is judged: teeth are judged by their exact mesh"), "{}", ended.stdout);
    }
    let single = format!("{PAPER}[errors]\nrack_pitch = \"12 um\"\n[limits]\nrack_pitch = \"±0.001\"\n");
    for options in [&[][..], &["--step", "1"], &["--format", "csv"], &["--step", "1", "--format", "csv"]] {
        let ended = run(&[&["mesh", "-", "--to", "3"], options].concat(), &single);
        assert_eq!(ended.code, Some(1), "{options:?}");
    }
}
