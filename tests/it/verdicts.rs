//! What a verdict rests on: a range that holds wherever errors sit, or no verdict.

use serde_json::Value;

use crate::process::{Ended, Folder, run};

/// The range of all errors, mm.
fn range(ended: &Ended) -> (f64, f64) {
    let range = &ended.json()["combined"]["range_mm"];
    let end = |name: &str| range[name].as_f64().unwrap_or_else(|| panic!("{name}: {}", ended.stdout));
    (end("lower"), end("upper"))
}

fn eval(spec: &str) -> Ended {
    run(&["eval", "-", "--format", "json"], spec)
}

/// The lowest and the highest ΔCD of the exact mesh, mm.
fn mesh_range(spec: &str) -> (f64, f64) {
    let ended = run(&["mesh", "-", "--format", "json"], spec);
    let summary = &ended.json()["summary"];
    let end = |name: &str| summary[name].as_f64().unwrap_or_else(|| panic!("{name}: {}", ended.stdout));
    (end("min_mm"), end("max_mm"))
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 5e-10, "{found} {expected}");
}

/// The pair fitted to the paper's Table 1.
const PAPER: &str = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 19.9\n[rack]\nface_width = 19.7\naddendum = 1.7\n\
    [pinion]\nteeth = 8\nhelix_angle = 21\nprofile_shift = 0.3\nface_width = 23.5\ntip_diameter = 19.738\n";

/// A spur pair.
fn spur(teeth: u32, shift: f64, addendum: f64, tip_diameter: f64) -> String {
    format!(
        "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nface_width = 20\naddendum = {addendum}\n\
         [pinion]\nteeth = {teeth}\nprofile_shift = {shift}\nface_width = 20\ntip_diameter = {tip_diameter}\n"
    )
}

/// 1/(2 tan 20°)
const GAIN_AT_20_DEG: f64 = 1.373_738_709_727_311;

/// One low space of the pinion need not be where the teeth touch: it takes nothing off what the rack lifts.
#[test]
fn a_low_space_does_not_make_up_for_a_high_rack() {
    let spec = |limit: &str| {
        format!(
            "[errors]\nrack_over_roller = \"13 um\"\npinion_radial = \"-4 um\"\n[limits]\ncenter_distance = {{ upper = {limit} }}\n"
        )
    };
    let failed = eval(&spec("0.010"));
    assert_eq!((failed.code, &failed.json()["verdict"]), (Some(1), &"fail".into()));
    assert_eq!(range(&failed), (0.009, 0.013));
    assert_eq!(eval(&spec("0.013")).code, Some(0));
    // a pinion that is small all round does
    let all = spec("0.010").replace("\"-4 um\"", "{ value = \"-4 um\", extent = \"all\" }");
    assert_eq!((eval(&all).code, range(&eval(&all))), (Some(0), (0.009, 0.009)));
}

/// Every pitch of the rack longer, or shorter, by 10 µm.
fn every_pitch(value: &str) -> String {
    format!(
        "[errors]\nrack_pitch = {{ value = \"{value}\", extent = \"all\" }}\n[limits]\ncenter_distance = \"±0.02\"\n"
    )
}

/// Of a pair that is not known nobody can say how many pitches add up.
#[test]
fn pitches_of_every_tooth_are_open_without_the_pair() {
    let spec = format!("[pair]\nnormal_pressure_angle = 19.9\n{}", every_pitch("10 um"));
    let ended = eval(&spec);
    let json = ended.json();
    assert_eq!((&json["verdict"], &json["combined"]["range_mm"]), (&Value::Null, &Value::Null));
    for format in ["json", "table", "csv", "markdown"] {
        assert_eq!(run(&["eval", "-", "--format", format], &spec).code, Some(2), "{format}");
    }
    let page = run(&["eval", "-"], &spec).stdout;
    assert!(page.contains("\nNo verdict: errors of many pitches add up over the teeth in contact"), "{page}");
    for key in [
        "pair.normal_module",
        "rack.face_width",
        "rack.addendum",
        "pinion.teeth",
        "pinion.tip_diameter",
        "pinion.face_width",
    ] {
        assert!(page.contains(&format!("`{key}`")), "{key}: {page}");
    }
    assert!(!page.contains("`pair.normal_pressure_angle`"), "{page}");
}

/// With ε = 2.24 and c = 0.18 pitches longer pitches add up to ⌊ε − 2c⌋ = 1 step at most and none at least, shorter ones
/// to ⌊ε + 2c⌋ = 2 and one; so does the exact mesh.
#[test]
fn pitches_of_every_tooth_have_a_range_with_the_pair() {
    // 1/(2 tan 19.9°)
    let step = 0.010 * 1.381_234_751_649_849;
    for (value, least, most, code) in [("10 um", 0.0, step, 0), ("-10 um", step, 2.0 * step, 1)] {
        let ended = eval(&format!("{PAPER}{}", every_pitch(value)));
        assert_eq!(ended.code, Some(code), "{}", ended.stdout);
        // what edges do is searched to 10 nm
        let (lower, upper) = range(&ended);
        assert!((least - 1e-5..=least + 1e-9).contains(&lower), "{lower} {least}");
        assert!((most - 1e-9..=most + 1e-5).contains(&upper), "{upper} {most}");
        let mesh = format!("{PAPER}[[rack.deviation]]\nteeth = \"all\"\npitch = \"{value}\"\n");
        let (lowest, highest) = mesh_range(&mesh);
        assert!((lowest - least).abs() < 1e-7 && (highest - most).abs() < 1e-7, "{value}: {lowest} … {highest}");
    }
}

/// With short rack teeth one step that is longer lets the pinion sink by as much as it can push it up.
#[test]
fn a_step_can_sink_the_pinion() {
    let spec = |limit: &str| {
        format!(
            "{}[errors]\nrack_pitch = \"20 um\"\n[limits]\ncenter_distance = {{ lower = {limit} }}\n",
            spur(20, 0.0, 1.0, 44.0)
        )
    };
    let failed = eval(&spec("-0.01"));
    assert_eq!((failed.code, &failed.json()["verdict"]), (Some(1), &"fail".into()), "{}", failed.stdout);
    near(range(&failed).0, -0.020 * GAIN_AT_20_DEG);
    assert_eq!(eval(&spec("-0.0275")).code, Some(0));
}

/// Undercut moves the centre distance without any error.
#[test]
fn undercut_counts_without_an_error() {
    let spec = |limit: &str| {
        format!("{}[errors]\nrack_pitch = 0\n[limits]\ncenter_distance = \"{limit}\"\n", spur(6, 0.4, 2.0, 17.6))
    };
    let failed = eval(&spec("±1 um"));
    assert_eq!((failed.code, &failed.json()["verdict"]), (Some(1), &"fail".into()), "{}", failed.stdout);
    let (lower, upper) = range(&failed);
    assert!(lower <= 0.0 && upper > 0.005 && upper < 0.02, "{lower} {upper}");
    assert_eq!(eval(&spec("±0.02")).code, Some(0));
}

/// The paper's lead formula of a helical rack is too small by cos β_r: its value is shown, the range judges.
#[test]
fn the_papers_model_is_shown_and_not_believed() {
    let gear = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nhelix_angle = 30\nface_width = 20\naddendum = 2\n\
                [pinion]\nteeth = 20\nhelix_angle = -30\nface_width = 30\ntip_diameter = 50.188\n";
    let spec = format!("{gear}[errors]\nrack_lead = 0.1\n[limits]\ncenter_distance = \"±0.05\"\n");
    let ended = run(&["eval", "-", "--model", "paper", "--format", "json"], &spec);
    let contribution = &ended.json()["contributions"][0];
    assert_eq!(format!("{:.4}", contribution["delta_cd_mm"].as_f64().expect("a number")), "0.0480");
    assert_eq!((ended.code, &ended.json()["verdict"]), (Some(1), &"fail".into()), "{}", ended.stdout);
    let (_, most) = mesh_range(&format!("{gear}[[rack.deviation]]\nteeth = \"all\"\nlead = 0.1\n"));
    assert!(most > 0.05 && most <= range(&ended).1 + 1e-9, "{most} {}", ended.stdout);
    // nor is it without the pair
    let alone = "[pair]\nnormal_pressure_angle = 20\n[rack]\nhelix_angle = 30\nface_width = 20\n";
    let spec = spec.replace(gear, alone);
    assert_eq!(run(&["eval", "-", "--model", "paper"], &spec).code, Some(1));
}

#[test]
fn extents_that_make_no_sense_are_refused() {
    for (entry, place, words) in [
        (
            "rack_over_roller = { value = 0.01, extent = \"total\" }",
            "<stdin>:2:",
            "`rack_over_roller.extent`: only a pitch",
        ),
        ("pinion_radial = { value = 0.01, extent = \"total\" }", "<stdin>:2:", "only a pitch has a total"),
        ("rack_lead = { value = 0.01, extent = \"total\" }", "<stdin>:2:", "only a pitch has a total"),
        (
            "rack_pitch = { value = 0.01, extent = \"some\" }",
            "<stdin>:2:",
            "`some` is not an extent; write `one`, `part`",
        ),
        ("rack_pitch = { value = 0.01, extent = 3 }", "<stdin>:2:", "text in quotes is needed"),
    ] {
        let spec = format!("[errors]\n{entry}\n[pair]\nnormal_pressure_angle = 20\n[rack]\nface_width = 20\n");
        let ended = run(&["eval", "-"], &spec);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{entry}");
        assert!(ended.stderr.contains(place) && ended.stderr.contains(words), "{entry}: {}", ended.stderr);
    }
    let total = "[pair]\nnormal_pressure_angle = 20\n[errors]\nrack_pitch = { value = 0.01, extent = \"total\" }\n";
    assert_eq!(eval(total).code, Some(0));
}

/// A row of a table is judged as the spec with its values is, on a known pair and on one that is not.
#[test]
fn a_batch_gives_the_verdicts_of_eval() {
    let rows = [
        ["0.010", "0.012", "-0.004", "0.009"],
        ["0.020", "-0.020", "0.008", "-0.020"],
        ["-0.030", "0.001", "0.030", "0"],
        ["0", "0", "0", "0"],
        ["0.0331", "0.0002", "-0.031", "0.0005"],
    ];
    let keys = ["rack_over_roller", "rack_pitch", "pinion_radial", "pinion_pitch"];
    let table: String = std::iter::once(format!("part_id,{}\n", keys.join(",")))
        .chain(rows.iter().enumerate().map(|(part, row)| format!("P{part},{}\n", row.join(","))))
        .collect();
    let limits = "[limits]\ncenter_distance = \"±0.04\"\n";
    let folder = Folder::new("verdicts");
    let mut seen = Vec::new();
    for pair in [PAPER, "[pair]\nnormal_pressure_angle = 19.9\n"] {
        for extent in ["one", "each"] {
            let entry = |value: &str| format!("{{ {value}extent = \"{extent}\" }}");
            let spec = format!("{pair}[errors]\nrack_pitch = {}\n{limits}", entry(""));
            let spec_file = folder.path("spec.toml");
            std::fs::write(&spec_file, &spec).expect("written");
            let batch = run(&["batch", &spec_file, "-", "--format", "jsonl"], &table);
            let lines: Vec<Value> =
                batch.stdout.lines().map(|line| serde_json::from_str(line).expect("a row is JSON")).collect();
            assert_eq!(lines.len(), rows.len(), "{}", batch.stderr);
            for (line, row) in lines.iter().zip(rows) {
                let errors = format!(
                    "[errors]\nrack_over_roller = {}\nrack_pitch = {}\npinion_radial = {}\npinion_pitch = {}\n",
                    row[0],
                    entry(&format!("value = {}, ", row[1])),
                    row[2],
                    row[3]
                );
                let one = eval(&format!("{pair}{errors}{limits}")).json();
                assert_eq!(line["verdict"], one["verdict"], "{pair} {extent} {row:?}: {line} {one}");
                seen.push(one["verdict"].clone());
            }
        }
    }
    for verdict in ["pass".into(), "fail".into(), Value::Null] {
        assert!(seen.contains(&verdict), "{verdict}: {seen:?}");
    }
}

/// What is written of a column's values holds for each of them, in every command that reads tables.
#[test]
fn a_column_says_on_which_teeth_its_values_are() {
    let folder = Folder::new("column-extents");
    let (file, table) = (folder.path("spec.toml"), folder.path("parts.csv"));
    std::fs::write(&table, "part_id,fp max\nA,0.012\n").expect("written");
    let write = |errors: &str| {
        let columns = "[table.columns]\nrack_pitch = { name = \"fp max\", unit = \"mm\", extent = \"each\" }\n";
        let text = format!("{PAPER}[errors]\n{errors}\n{columns}[limits]\ncenter_distance = \"±0.04\"\n");
        std::fs::write(&file, text).expect("written");
    };
    let every_part = "pinion_pitch = { value = 0.005, every_part = true }";
    let expected =
        eval(&format!("{PAPER}[errors]\nrack_pitch = {{ value = 0.012, extent = \"each\" }}\npinion_pitch = 0.005\n"));
    // beside a value, `[errors]` says of that value where it is, and nothing of the column's
    for beside in ["", "rack_pitch = { value = 0.001, extent = \"one\" }", "rack_pitch = { extent = \"each\" }"] {
        write(&format!("{every_part}\n{beside}"));
        let batch = run(&["batch", &file, &table, "--format", "jsonl", "--decimals", "full"], "");
        assert_eq!(batch.code, Some(0), "{}", batch.stderr);
        let row = batch.json();
        let ranges =
            (row["range_lower_mm"].as_f64().expect("a number"), row["range_upper_mm"].as_f64().expect("a number"));
        assert_eq!(ranges, range(&expected), "{beside}");
        assert!(batch.stderr.contains("note: extent: rack_pitch each (every pitch, any sign)\n"), "{}", batch.stderr);
        let paste = run(&["paste", &file, &table, "--format", "json"], "");
        assert_eq!(range(&paste), range(&expected), "{beside}");
        let json = paste.json();
        assert_eq!([&json["contributions"][0]["extent"], &json["contributions"][1]["extent"]], ["each", "one"]);
    }
    let page = run(&["report", &file, &table], "").stdout;
    assert!(page.contains("extent: rack_pitch each (every pitch, any sign)"), "{page}");
}

/// A value that every part has is where `[errors]` says, not where a column says that the table lacks.
#[test]
fn a_column_that_is_not_there_says_nothing() {
    let folder = Folder::new("column-extents-lacking");
    let (file, table) = (folder.path("spec.toml"), folder.path("parts.csv"));
    std::fs::write(&table, "part_id,rack_over_roller\nA,0.012\n").expect("written");
    let text = "[errors]\npinion_radial = { value = 0.004, every_part = true }\n[table.columns]\npinion_radial = { extent = \"all\" }\n";
    std::fs::write(&file, text).expect("written");
    let ranges = (0.012, 0.016);
    let row = run(&["batch", &file, &table, "--format", "jsonl"], "").json();
    assert_eq!((row["range_lower_mm"].as_f64(), row["range_upper_mm"].as_f64()), (Some(ranges.0), Some(ranges.1)));
    assert_eq!(range(&run(&["paste", &file, &table, "--format", "json"], "")), ranges);
}

/// Of the values of a table the spec says one thing.
#[test]
fn columns_and_errors_say_the_same() {
    let folder = Folder::new("column-extents-contradicted");
    let (file, table) = (folder.path("spec.toml"), folder.path("parts.csv"));
    std::fs::write(&table, "part_id,rack_pitch\nA,0.012\n").expect("written");
    for entry in ["{ extent = \"one\" }", "{ nominal = 0, extent = \"one\" }", "{ u = \"1 um\", extent = \"one\" }"] {
        let text =
            format!("{PAPER}[errors]\nrack_pitch = {entry}\n[table.columns]\nrack_pitch = {{ extent = \"each\" }}\n");
        std::fs::write(&file, &text).expect("written");
        for command in ["batch", "paste", "report"] {
            let ended = run(&[command, &file, &table], "");
            let why = "`errors.rack_pitch.extent` is \"one\" and `table.columns.rack_pitch.extent` is \"each\"";
            assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{command} {entry}");
            assert!(ended.stderr.contains(why) && ended.stderr.contains("spec.toml:16:25"), "{}", ended.stderr);
        }
    }
    let total = "[table.columns]\nrack_over_roller = { extent = \"total\" }\n";
    std::fs::write(&file, total).expect("written");
    let ended = run(&["batch", &file, &table], "");
    assert!(ended.stderr.contains("spec.toml:2:31"), "{}", ended.stderr);
    assert!(ended.stderr.contains("`rack_over_roller.extent`: only a pitch"), "{}", ended.stderr);
}

/// A budget grants what `eval` passes on the same teeth, with either sign.
#[test]
fn a_budget_is_of_the_teeth_that_it_says() {
    let limits = "[limits]\ncenter_distance = \"±0.05\"\n";
    let budget = format!(
        "{PAPER}[budget]\nrack_over_roller = {{ value = \"10 um\", extent = \"all\" }}\nrack_pitch = {{ weight = 2, extent = \"one\" }}\n\
         pinion_pitch = {{ extent = \"part\" }}\n{limits}"
    );
    let ended = run(&["budget", "-", "--format", "json"], &budget);
    let json = ended.json();
    let upper = json["worst_case_mm"]["upper"].as_f64().expect("a number");
    assert!(ended.code == Some(0) && upper <= 0.05 && upper > 0.05 - 1e-7, "{}", ended.stdout);
    let lines = json["tolerances"].as_array().expect("a list");
    assert_eq!(lines.iter().map(|line| line["extent"].clone()).collect::<Vec<_>>(), ["all", "one", "part"]);
    for (sign, factor, code) in [("", 1.0, 0), ("-", 1.0, 0), ("", 1.02, 1)] {
        let errors: Vec<_> = lines
            .iter()
            .map(|line| {
                let value = factor * line["tolerance_mm"].as_f64().expect("a number");
                format!(
                    "{} = {{ value = {sign}{value}, extent = {} }}\n",
                    line["error"].as_str().expect("a text"),
                    line["extent"]
                )
            })
            .collect();
        let errors = errors.concat();
        assert_eq!(eval(&format!("{PAPER}[errors]\n{errors}{limits}")).code, Some(code), "{errors}");
    }
    let page = run(&["budget", "-"], &budget).stdout;
    assert!(page.contains("  a run of pitches\n") && page.contains("  one pitch\n"), "{page}");
    // where a single pitch is off there is a bound without the pair
    let unknown = "[pair]\nnormal_pressure_angle = 20\n[budget]\nrack_pitch = { extent = \"one\" }\n";
    assert_eq!(run(&["budget", "-"], &format!("{unknown}{limits}")).code, Some(0));
    let each = run(&["budget", "-"], &format!("{unknown}{limits}").replace("one", "each"));
    assert!(each.code == Some(2) && each.stderr.contains("pair.normal_module"), "{}", each.stderr);
}

/// What the mesh reaches with the tolerances that a budget grants is what it reaches with them in `eval`.
#[test]
fn a_budget_says_what_its_tolerances_reach() {
    let limits = "[limits]\ncenter_distance = \"±0.05\"\n";
    let entries = "[budget]\nrack_over_roller = \"10 um\"\nrack_pitch = \"free\"\npinion_radial = { weight = 2 }\n";
    let budget = format!("{PAPER}{entries}{limits}");
    let of = |arguments: &[&str], spec: &str| run(&[&["budget", "-"], arguments].concat(), spec);
    let ended = of(&["--format", "json"], &budget);
    let json = ended.json();
    let ends = |of: &Value| (of["lower"].as_f64().expect("a number"), of["upper"].as_f64().expect("a number"));
    let (reached, bound) = (ends(&json["reached_mm"]), ends(&json["worst_case_mm"]));
    assert!(bound.0 <= reached.0 && reached.0 < 0.0 && 0.0 < reached.1 && reached.1 <= bound.1, "{}", ended.stdout);
    let lines = json["tolerances"].as_array().expect("a list").iter();
    let errors: Vec<_> = lines
        .map(|line| {
            format!(
                "{} = {{ value = {}, extent = \"each\" }}\n",
                line["error"].as_str().expect("a key"),
                line["tolerance_mm"]
            )
        })
        .collect();
    let evaluated = eval(&format!("{PAPER}[errors]\n{}{limits}", errors.concat())).json();
    assert_eq!(json["reached_mm"], evaluated["reached_mm"]);
    assert_eq!(json["notes"], evaluated["notes"]);
    let page = of(&[], &budget).stdout;
    let line = format!("\nreached: {:.4} … +{:.4} mm, of the worst case's ", reached.0, reached.1);
    assert_eq!(page.matches(&line).count(), 1, "{line} {page}");

    let not_reached = |arguments: &[&str], spec: &str, code: i32| {
        let ended = of(&[&["--format", "json"], arguments].concat(), spec);
        assert_eq!((ended.code, &ended.json()["reached_mm"]), (Some(code), &Value::Null), "{}", ended.stdout);
        let page = of(arguments, spec).stdout;
        assert!(!page.contains("reached"), "{page}");
        page
    };
    not_reached(&["--no-mesh"], &budget, 0);
    not_reached(&[], &format!("{budget}[support]\nroll = \"free\"\nroll_axis_depth = 8\n"), 0);
    // what is not granted reaches nothing
    not_reached(&[], &budget.replace("10 um", "60 um"), 1);
    let unknown = budget.replace("tip_diameter = 19.738\n", "").replace("\"free\"", "{ extent = \"one\" }");
    let page = not_reached(&[], &unknown, 0);
    let missing = "note: Geometry incomplete, the bound is wider than it need be: add `pinion.tip_diameter`";
    assert_eq!(page.matches(missing).count(), 1, "{page}");
}

/// One error on its teeth: `calc` says what `eval` says of the same error where nothing else is known.
#[test]
fn one_error_is_on_the_teeth_that_it_is_said_to_be() {
    let pitch = ["calc", "pitch", "12um", "--pressure-angle", "20", "--helix-angle", "12"];
    let lead = ["calc", "lead", "0.1", "--pressure-angle", "20", "--face-width", "20"];
    let radial = ["calc", "radial", "--measured", "8.4", "--nominal", "8.404"];
    let gear = "[pair]\nnormal_pressure_angle = 20\n[rack]\n";
    let specs = [
        (&pitch[..], format!("{gear}helix_angle = 12\n[errors]\nrack_pitch = {{ value = \"12 um\"")),
        (&lead[..], format!("{gear}face_width = 20\n[errors]\nrack_lead = {{ value = 0.1")),
        (&radial[..], "[errors]\npinion_radial = { measured = 8.4, nominal = 8.404".to_owned()),
    ];
    for (arguments, spec) in &specs {
        for extent in [None, Some("one"), Some("part"), Some("all"), Some("each"), Some("total")] {
            let entry = extent.map_or_else(String::new, |extent| format!(", extent = \"{extent}\""));
            let evaluated = eval(&format!("{spec}{entry} }}\n"));
            let option = extent.map_or_else(Vec::new, |extent| vec!["--extent", extent]);
            let ended = run(&[*arguments, &["--format", "json"], &option].concat(), "");
            if evaluated.stdout.is_empty() {
                assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{arguments:?} {extent:?}");
                let why = "only a pitch has a total cumulative deviation";
                assert!(ended.stderr.contains(why) && evaluated.stderr.contains(why), "{}", ended.stderr);
                continue;
            }
            let (json, evaluated) = (ended.json(), evaluated.json());
            let contribution = &evaluated["contributions"][0];
            for key in ["extent", "range_mm"] {
                assert_eq!(json[key], contribution[key], "{arguments:?} {extent:?}");
            }
            // a calculation has no spec whose keys it could name
            let names_key =
                |note: &Value| ["`pair.", "[pair]", "extent ="].iter().any(|key| note.to_string().contains(key));
            let notes = |answer: &Value| answer["notes"].as_array().cloned().unwrap_or_default();
            let said = notes(&json);
            assert!(!said.iter().any(names_key), "{arguments:?} {extent:?}: {said:?}");
            for note in notes(&evaluated).into_iter().filter(|note| !names_key(note)) {
                assert!(said.contains(&note), "{arguments:?} {extent:?}: {note} of {said:?}");
            }
            let is_open = contribution["range_mm"].is_null();
            assert_eq!(ended.code, Some(if is_open { 2 } else { 0 }), "{arguments:?} {extent:?}");
        }
    }
    // the number stays alone on standard output
    let ended = run(&[&pitch[..], &["--extent", "one", "--unit", "um", "--decimals", "1"]].concat(), "");
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(0), "16.1 um\n"));
    assert!(ended.stderr.contains("\nworst case: -16.1 … +16.1 um (one pitch)\n"), "{}", ended.stderr);
    let ended = run(&[&pitch[..], &["--extent", "each"]].concat(), "");
    assert_eq!(ended.code, Some(2));
    assert!(
        ended.stderr.contains("\nworst case: open (every pitch, any sign): errors of many pitches"),
        "{}",
        ended.stderr
    );
    assert!(ended.stderr.contains("`rackmesh eval` takes a spec with it"), "{}", ended.stderr);
    let ended = run(&["calc", "radial", "-4um", "--extent", "part", "--format", "csv"], "");
    assert!(
        ended.stdout.ends_with(",extent,lower_mm,upper_mm\npinion-radial,,-0.004,-0.004,mm,part,-0.004,0\n"),
        "{}",
        ended.stdout
    );
    // what is asked for is no error on any teeth
    assert_eq!(run(&["calc", "radial", "--inverse", "4um", "--extent", "one"], "").code, Some(2));
}

/// Parts without a range are no parts that pass: the exit status, the summary and what pipelines read say so, and why.
#[test]
fn a_batch_without_ranges_does_not_pass() {
    let folder = Folder::new("open-batch");
    let (spec, table, junit) = (folder.path("spec.toml"), folder.path("parts.csv"), folder.path("parts.xml"));
    let text = "[pair]\nnormal_pressure_angle = 20\n[errors]\nrack_pitch = { extent = \"all\" }\n[limits]\ncenter_distance = \"±0.05\"\n";
    std::fs::write(&table, "part_id,rack_pitch\nA,0.001\nB,0\n").expect("written");
    for (text, stack) in
        [(text.to_owned(), "range"), (text.to_owned(), "rss"), (text.replace("center_distance", "rack_pitch"), "range")]
    {
        std::fs::write(&spec, &text).expect("written");
        let ended = run(&["batch", &spec, &table, "--stack", stack, "--junit", &junit, "--annotations", "github"], "");
        assert_eq!(ended.code, Some(2), "{stack}: {}", ended.stderr);
        let why = "errors of many pitches add up over the teeth in contact: the pair's geometry is missing: `pair.normal_module`";
        assert!(ended.stderr.contains(why), "{}", ended.stderr);
        let open = "2 parts have no range to hold against a limit";
        assert!(ended.stderr.contains(&format!("::error title=rackmesh batch::{open}")), "{}", ended.stderr);
        let junit = std::fs::read_to_string(&junit).expect("written");
        assert!(junit.contains("errors=\"1\"") && junit.contains(open), "{junit}");
        let summary = run(&["batch", &spec, &table, "--stack", stack, "--summary"], "");
        assert_eq!(summary.code, Some(2));
        assert!(summary.stdout.ends_with(&format!("No verdict: {open}\n")), "{}", summary.stdout);
    }
    // without a limit nothing is left open
    std::fs::write(&spec, text.split("[limits]").next().expect("the first part")).expect("written");
    assert_eq!(run(&["batch", &spec, &table], "").code, Some(0));
}

/// Near a face width at which one more step comes to carry, its uncertainty is that of the jump, and no pass is certain.
#[test]
fn uncertain_sizes_of_the_pair_count() {
    let spec = |width: &str| {
        let pair = PAPER.replace("face_width = 19.7", &format!("face_width = {{ value = {width}, u = 0.1 }}"));
        let pair = pair.replace("face_width = 23.5", "face_width = 30");
        format!(
            "{pair}[errors]\nrack_pitch = {{ value = \"10 um\", u = \"0.03 um\", extent = \"each\" }}\n\
             [limits]\ncenter_distance = {{ upper = 0.0285 }}\nrack_pitch = {{ upper = 0.0285 }}\n[decision]\nrule = \"iso14253\"\n"
        )
    };
    for draws in [&[][..], &["--monte-carlo", "2e4"]] {
        let of = |width| run(&[&["eval", "-", "--format", "json"], draws].concat(), &spec(width));
        assert_eq!(of("19.7").json()["verdict"], "pass", "{draws:?}");
        let near = of("23.75").json();
        assert_eq!(near["verdict"], "indeterminate", "{draws:?} {near}");
        assert!(near["limits"].as_array().is_some_and(|limits| limits.iter().all(|limit| limit["verdict"] != "pass")));
    }
}

/// A size on one space lifts the upper end where it stands out, and does nothing where it sinks: measured just below zero it
/// may be either.
#[test]
fn a_size_near_zero_is_uncertain_to_the_side_where_it_acts() {
    let limits = ["center_distance", "pinion_radial"].map(|on| format!("{on} = {{ upper = 0.002 }}\n"));
    for (pair, limit) in ["", PAPER].into_iter().flat_map(|pair| limits.iter().map(move |limit| (pair, limit))) {
        let spec = |value: &str| {
            format!(
                "{pair}[errors]\npinion_radial = {{ value = \"{value} um\", u = \"5 um\", extent = \"one\" }}\n\
                 [limits]\n{limit}[decision]\nrule = \"iso14253\"\n"
            )
        };
        for draws in [&[][..], &["--monte-carlo", "2e4"]] {
            let of = |value| run(&[&["eval", "-", "--format", "json"], draws].concat(), &spec(value)).json();
            assert_eq!(of("-1")["verdict"], "indeterminate", "{limit} {draws:?}");
            assert_eq!(of("-40")["verdict"], "pass", "{limit} {draws:?}");
        }
    }
}

/// Within the uncertainty of a step one more tooth comes to carry, so that the lower end jumps: the limit lies between, and a
/// quarter of 20,000 draws is beyond it.
#[test]
fn an_error_near_a_jump_of_the_bound_is_uncertain_by_the_jump() {
    let spec = "[pair]\nnormal_module = 1\nnormal_pressure_angle = 20\n[rack]\nhelix_angle = -7.355\nface_width = 6.59\n\
        addendum = 0.6281\n[pinion]\nteeth = 8\nhelix_angle = 0\nprofile_shift = 0.5\nface_width = 9.227\ntip_diameter = 10.7021\n\
        [errors]\nrack_over_roller = { value = \"-7.246 um\", extent = \"each\", u = 0 }\n\
        rack_pitch = { value = \"-19.772 um\", extent = \"one\", u = \"3.71 um\" }\n[decision]\nrule = \"iso14253\"\n[limits]\n";
    let of = |limit: &str, draws: &[&str]| {
        let spec = format!("{spec}center_distance = {{ lower = {limit} }}\n");
        run(&[&["eval", "-", "--format", "json"], draws].concat(), &spec).json()
    };
    let drawn = of("-0.022", &["--monte-carlo", "2e4"]);
    let conformance = drawn["limits"][0]["decision"]["conformance_probability"].as_f64().unwrap();
    assert!((0.7..0.85).contains(&conformance), "{conformance}");
    for draws in [&[][..], &["--monte-carlo", "2e4"]] {
        assert_eq!(of("-0.022", draws)["verdict"], "indeterminate", "{draws:?}");
        assert_eq!(of("-0.03", draws)["verdict"], "pass", "{draws:?}");
    }
}

/// A rack that may roll and has no error sinks by nothing: a limit of 0 is met.
#[test]
fn a_rolling_rack_without_errors_is_at_nought() {
    let spec = format!(
        "{PAPER}[support]\nroll = \"free\"\nroll_axis_depth = 10\n[errors]\nrack_over_roller = 0\n[limits]\ncenter_distance = \"±0\"\n"
    );
    let ended = eval(&spec);
    assert_eq!((ended.code, range(&ended)), (Some(0), (0.0, 0.0)), "{}", ended.stdout);
}

/// Without one key of the geometry, what the spec says of its pair counts all the same: thicker teeth shift ΔCD, form and
/// undercut leave the verdict open.
#[test]
fn an_incomplete_pair_is_not_taken_to_be_perfect() {
    let complete = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nface_width = 20\naddendum = 1.7\n\
        [pinion]\nteeth = 12\nhelix_angle = 20\nprofile_shift = 0.2\nface_width = 25\ntip_diameter = 30\n\
        [errors]\nrack_over_roller = \"5 um\"\n[limits]\ncenter_distance = \"±0.02\"\n";
    let incomplete = complete.replace("tip_diameter = 30\n", "");
    let with = |spec: &str, set: &[&str]| {
        let options = set.iter().flat_map(|key| ["--set", key]);
        run(&["eval", "-", "--format", "json"].into_iter().chain(options).collect::<Vec<_>>(), spec)
    };
    assert_eq!(with(&incomplete, &[]).code, Some(0));
    for thicker in ["rack.tooth_thickness=3.2", "pinion.tooth_thickness_deviation=80um"] {
        let (of_all, of_part) = (with(complete, &[thicker]), with(&incomplete, &[thicker]));
        assert_eq!((of_all.code, of_part.code), (Some(1), Some(1)), "{thicker}");
        near(range(&of_part).1, range(&of_all).1);
    }
    let thick = with(&incomplete, &["pair.normal_module=2.01", "rack.tooth_thickness=3.2"]);
    near(range(&thick).1, 0.005 + GAIN_AT_20_DEG * (3.2 - 2.01 * std::f64::consts::FRAC_PI_2));
    for unknown in [
        "pinion.profile_slope=-60um",
        "rack.crowning=5um",
        "rack.tip_relief={amount=\"5um\",start=1}",
        "pinion.teeth=5",
        "rack.addendum=2.8",
        "rack.tooth_thickness={value=3.1415927,u=\"10um\"}",
        "pinion.tooth_thickness_deviation=1um pair.normal_pressure_angle={value=20,u=0.1}",
    ] {
        let open = with(&incomplete, &unknown.split(' ').collect::<Vec<_>>());
        assert_eq!((open.code, &open.json()["verdict"]), (Some(2), &Value::Null), "{unknown}: {}", open.stdout);
        assert!(
            open.stdout.contains("there is no worst case without the pair's geometry"),
            "{unknown}: {}",
            open.stdout
        );
    }
    let budget = format!("{incomplete}[budget]\nrack_over_roller = \"free\"\n");
    let budget =
        run(&["budget", "-", "--set", "rack.tooth_thickness=3.2"], &budget.replace("rack_over_roller = \"5 um\"", ""));
    assert!(budget.stderr.contains("leaves nothing to distribute"), "{}", budget.stderr);
}

/// An uncertain tooth thickness moves the whole curve; behind a computed nominal measure it moves nothing.
#[test]
fn an_uncertain_thickness_counts() {
    let spec = |error: &str| {
        format!(
            "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nface_width = 20\naddendum = 1.7\n\
             tooth_thickness = {{ value = 3.1415927, u = \"10 um\" }}\ndatum = 21.9486\n\
             [pinion]\nteeth = 12\nhelix_angle = 20\nprofile_shift = 0.2\nface_width = 25\ntip_diameter = 30\n\
             [errors]\nrack_over_roller = {error}\n[limits]\ncenter_distance = \"±0.0065\"\n[decision]\nrule = \"iso14253\"\n"
        )
    };
    let standard_mm = |ended: &Ended| {
        let json = ended.json();
        let results = json["uncertainty"]["results"].as_array().unwrap_or_else(|| panic!("{}", ended.stdout));
        let upper = results.iter().find(|result| result["of"] == "upper").unwrap();
        upper["standard_uncertainty_mm"].as_f64().unwrap()
    };
    let stated = eval(&spec("{ value = \"5 um\", u = \"0.5 um\" }"));
    assert_eq!(stated.code, Some(3), "{}", stated.stdout);
    let expected = (0.01_f64 * GAIN_AT_20_DEG * 0.01 * GAIN_AT_20_DEG + 0.0005 * 0.0005).sqrt();
    assert!((standard_mm(&stated) / expected - 1.0).abs() < 1e-6, "{}", stated.stdout);
    for tip in ["", "tip_diameter = 30\n"] {
        let measured = spec("{ measured = 25.476, roller = 4 }").replace("tip_diameter = 30\n", tip);
        let measured = eval(&measured);
        assert!(standard_mm(&measured) < 1e-9, "{}", measured.stdout);
    }
}

/// What random racks are not held against leaves them without a pass, and errors of an extent are on the worst teeth.
#[test]
fn random_racks_pass_nothing_that_they_do_not_judge() {
    let spec =
        format!("{PAPER}[scatter]\nrack_thickness = \"0.001 um\"\n[limits]\ncenter_distance = {{ upper = 0.020 }}\n");
    let drawn = |more: &str| run(&["monte-carlo", "-", "--racks", "20", "--format", "json"], &format!("{spec}{more}"));
    let verdict = |ended: &Ended| (ended.code, ended.json()["verdict"].clone());
    assert_eq!(verdict(&drawn("")), (Some(0), "pass".into()));
    let guarded = drawn("[decision]\nrule = \"guard=1um\"\n");
    assert_eq!(verdict(&guarded), (Some(2), Value::Null), "{}", guarded.stdout);
    assert!(guarded.stdout.contains("not judged: the decision rule guard=0.001 mm"), "{}", guarded.stdout);
    let of_error = drawn("rack_pitch = \"±0.01\"\n[errors]\nrack_pitch = \"5 um\"\n");
    assert_eq!(verdict(&of_error), (Some(2), Value::Null), "{}", of_error.stdout);
    let alone = spec.replace("center_distance = { upper = 0.020 }", "rack_pitch = \"±0.01\"");
    let alone = run(&["monte-carlo", "-", "--racks", "20", "--format", "json"], &alone);
    assert_eq!(verdict(&alone), (Some(2), Value::Null), "{}", alone.stdout);
    // the reason is no note that --quiet leaves out
    let reason = "not judged: limits on single errors (rack pitch), for the deviations of teeth are drawn";
    assert_eq!(alone.json()["reason"], reason);
    let more = "rack_pitch = \"±0.01\"\n[errors]\nrack_pitch = \"5 um\"\n";
    let quiet = run(&["monte-carlo", "-", "--racks", "20", "-q"], &format!("{spec}{more}"));
    assert!(quiet.stdout.ends_with(&format!("; {reason}\n")), "{}", quiet.stdout);
    // two steps add up, which one alone would hide
    let each = drawn("[errors]\nrack_pitch = { value = \"10um\", extent = \"each\" }\n");
    assert_eq!(verdict(&each), (Some(1), "fail".into()), "{}", each.stdout);
}

/// Tolerances that a budget grants pass by the rule that parts are judged by.
#[test]
fn a_budget_keeps_its_guard_band() {
    let spec = format!(
        "{PAPER}[budget]\nrack_over_roller = \"free\"\n[limits]\ncenter_distance = \"±0.03\"\n[decision]\nrule = \"guard=5um\"\n"
    );
    let ended = run(&["budget", "-", "--format", "json"], &spec);
    let granted = ended.json()["tolerances"][0]["tolerance_mm"].as_f64().unwrap_or_else(|| panic!("{}", ended.stdout));
    assert!((granted - 0.025).abs() < 1e-6, "{granted}");
    assert!(ended.stdout.contains("limits are narrowed by the guard band"), "{}", ended.stdout);
}

/// What the virtual machine measures of errors without teeth is the worst placement, and no milder one.
#[test]
fn errors_that_are_measured_virtually_are_on_the_worst_teeth() {
    let folder = Folder::new("verdicts-measure");
    let (path, table) = (folder.path("spec.toml"), folder.path("rack.csv"));
    let limit = "[limits]\ncenter_distance = { upper = 0.02 }\n";
    for pitch in ["{ value = \"12 um\", extent = \"each\" }", "{ value = \"12 um\", extent = \"total\" }"] {
        let spec = format!("{PAPER}[errors]\nrack_pitch = {pitch}\n{limit}");
        std::fs::write(&path, &spec).expect("written");
        let measured = run(&["measure", &path, "--format", "csv"], "");
        assert_eq!(measured.code, Some(0), "{}", measured.stderr);
        assert!(
            measured.stderr.starts_with("note: ") && measured.stderr.contains("worst teeth"),
            "{}",
            measured.stderr
        );
        std::fs::write(&table, &measured.stdout).expect("written");
        std::fs::write(&path, format!("{PAPER}{limit}").replace("[rack]\n", "[rack]\nmeasured = \"rack.csv\"\n"))
            .expect("written");
        let judged = run(&["eval", &path, "--format", "json"], "");
        assert_eq!(judged.code, Some(1), "{}", judged.stdout);
        assert!(range(&judged).1 >= mesh_range(&spec).1 - 1e-6, "{pitch}: {}", judged.stdout);
        let json = run(&["measure", "-", "--format", "json"], &spec).json();
        assert!(json["notes"][0].as_str().is_some_and(|note| note.contains("worst teeth")), "{json}");
        let far = run(&["measure", "-", "--last", "40"], &spec);
        assert_eq!((far.code, far.stdout.as_str()), (Some(2), ""), "{}", far.stderr);
    }
}

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

/// An uncertainty of 0 widens no limit.
#[test]
fn a_rule_needs_an_uncertainty_above_zero() {
    let spec = "[errors]\nrack_over_roller = { value = \"20 um\", u = 0 }\n[limits]\ncenter_distance = \"±0.05\"\n";
    let ended = run(&["eval", "-", "--rule", "iso14253"], spec);
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("needs an uncertainty above 0, and the spec gives none"), "{}", ended.stderr);
    // the values of a table stand in the table: the remedy puts none beside the uncertainty
    let spec = "[limits]\ncenter_distance = \"±0.05\"\n[decision]\nrule = \"iso14253\"\n";
    let folder = Folder::new("remedy");
    let path = folder.path("spec.toml");
    std::fs::write(&path, spec).expect("written");
    for command in ["batch", "paste"] {
        let ended = run(&[command, &path, "-"], "part_id,rack_over_roller [mm]\nA,0.01\n");
        assert_eq!(ended.code, Some(2), "{command}");
        assert!(ended.stderr.contains("such as `rack_pitch = { u = "), "{command}: {}", ended.stderr);
    }
}

/// A value without an uncertainty leaves the verdict of a rule that needs one open, wherever it is asked for; `u = 0` says that
/// it is exact.
#[test]
fn a_rule_needs_an_uncertainty_of_every_value() {
    let folder = Folder::new("every-uncertainty");
    let (path, table) = (folder.path("spec.toml"), folder.path("part.csv"));
    std::fs::write(&table, "part_id,rack_over_roller [um],rack_pitch [um]\nA,13,12\n").expect("written");
    for (pitch, code, reason) in [
        ("\"12 um\"", 2, "the rule iso14253 needs an uncertainty of every value"),
        ("{ value = \"12 um\", u = 0 }", 0, ""),
    ] {
        let spec = format!(
            "[pair]\nnormal_pressure_angle = 20\n[errors]\nrack_over_roller = {{ value = \"13 um\", u = \"2 um\" }}\n\
             rack_pitch = {pitch}\n[limits]\ncenter_distance = {{ lower = -0.03, upper = 0.034 }}\n[decision]\nrule = \"iso14253\"\n"
        );
        std::fs::write(&path, spec).expect("written");
        for command in [
            &["eval", &path, "--format", "csv"][..],
            &["batch", &path, &table],
            &["paste", &path, &table, "--format", "csv"],
        ] {
            let ended = run(command, "");
            assert_eq!(ended.code, Some(code), "{command:?}: {}", ended.stderr);
            assert!(ended.stdout.contains(reason), "{command:?}: {}", ended.stdout);
        }
        let page = run(&["report", &path], "");
        assert_eq!((page.code, page.stdout.contains(reason)), (Some(code), true), "{}", page.stderr);
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

/// Where an uncertainty leads to where no bound is known, the range has none: it is shown, and a rule that needs one leaves it open.
#[test]
fn a_bound_that_ends_within_an_uncertainty_has_none() {
    let spec = |values: [&str; 3]| {
        let [lead, radial, pitch] = values;
        format!(
            "[pair]\nnormal_module = 3\nnormal_pressure_angle = 20\n[rack]\nhelix_angle = -30\nface_width = 27\naddendum = 2.7\n\
             tip_relief = {{ amount = \"15 um\", start = 1.35 }}\n[pinion]\nteeth = 6\nhelix_angle = 25\nprofile_shift = -0.1\n\
             tip_diameter = 25.2608\nface_width = 12\n[errors]\npinion_lead = {{ {lead}extent = \"one\", u = \"2 um\" }}\n\
             pinion_radial = {{ {radial}extent = \"all\", u = \"0.5 um\" }}\n\
             pinion_pitch = {{ {pitch}extent = \"all\", u = \"1 um\" }}\n[limits]\ncenter_distance = \"±0.5\"\n"
        )
    };
    let folder = Folder::new("open-within");
    let (path, table) = (folder.path("spec.toml"), folder.path("parts.csv"));
    std::fs::write(&path, spec([""; 3])).expect("written");
    let rows = "part_id,pinion_lead [um],pinion_radial [um],pinion_pitch [um]\nP0,-2.4,-5.98,-9.39\n";
    std::fs::write(&table, rows).expect("written");
    let of_eval = spec(["value = \"-2.4 um\", ", "value = \"-5.98 um\", ", "value = \"-9.39 um\", "]);
    for (rule, code, verdict) in [("guard=3um", 0, "pass".into()), ("iso14253", 2, Value::Null)] {
        let ended = run(&["batch", &path, &table, "--format", "jsonl", "--rule", rule], "");
        assert_eq!(ended.code, Some(code), "{rule}: {}", ended.stderr);
        for line in ended.stdout.lines() {
            let row: Value = serde_json::from_str(line).expect(line);
            assert!(
                row["range_lower_mm"].is_number() && row["range_lower_standard_uncertainty_mm"].is_null(),
                "{line}"
            );
            assert_eq!((&row["verdict"], &row["conformance_probability"]), (&verdict, &Value::Null), "{line}");
            assert_eq!(row["reason"].is_null(), code == 0, "{line}");
        }
    }
    let summary = run(&["batch", &path, &table, "--summary", "--format", "json"], "");
    assert!(!summary.stdout.contains("e+") && summary.code == Some(0), "{}", summary.stdout);
    let ended = run(&["eval", "-", "--format", "json", "--rule", "iso14253", "--no-worst-teeth"], &of_eval);
    let json = ended.json();
    assert_eq!((ended.code, &json["verdict"]), (Some(2), &Value::Null), "{}", ended.stderr);
    assert!(json["combined"]["range_mm"]["lower"].is_number(), "{json}");
    assert!(json["notes"].to_string().contains("no bound of ΔCD is known where errors.p"), "{json}");
}

/// Two pitches near 0 that move against each other: their sum is certain, and that of their magnitudes is not.
#[test]
fn correlated_values_near_zero_prove_nothing() {
    let spec = "[pair]\nnormal_pressure_angle = 20\n[errors]\nrack_pitch = { value = 0, u = \"1 um\" }\n\
        pinion_pitch = { value = 0, u = \"1 um\" }\n[decision]\nrule = \"iso14253\"\n\
        [limits]\ncenter_distance = { upper = 0.002 }\n[[correlation]]\n\
        between = [\"errors.rack_pitch\", \"errors.pinion_pitch\"]\ncoefficient = -1\n";
    let ended = eval(spec);
    assert_eq!(ended.code, Some(3), "{}{}", ended.stdout, ended.stderr);
}

/// A roll axis without a word on whether the rack may roll about it.
#[test]
fn a_roll_axis_needs_roll() {
    let spec = |roll: &str| format!("[support]\nroll_axis_depth = 8\n{roll}[errors]\nrack_over_roller = \"20 um\"\n");
    let ended = eval(&spec(""));
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    assert!(ended.stderr.contains("add `roll = \"free\"` or `roll = \"fixed\"` below [support]"), "{}", ended.stderr);
    assert_eq!(eval(&spec("roll = \"fixed\"\n")).code, Some(0));
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

/// The last line of `mesh` says by how much a limit is missed, as that of `eval` does.
#[test]
fn a_mesh_says_by_how_much_a_limit_is_missed() {
    let spec =
        format!("{PAPER}[errors]\nrack_over_roller = \"20 um\"\n[limits]\ncenter_distance = {{ upper = 0.015 }}\n");
    let ended = run(&["mesh", "-", "--to", "5"], &spec);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let last = "FAIL: ΔCD (worst case): +0.0200 mm is 0.0050 mm above the limit 0.015 mm (judged by the exact mesh of the known \
                teeth)\n";
    assert!(ended.stdout.ends_with(last), "{}", ended.stdout);
}

/// A rule decides about single errors where their sum is open, too.
#[test]
fn a_rule_holds_where_the_sum_is_open() {
    let spec = "[pair]\nnormal_pressure_angle = 20\n[errors]\nrack_over_roller = { value = \"12 um\", u = \"1 um\" }\n\
        rack_pitch = { value = \"3 um\", extent = \"each\" }\n[limits]\nrack_over_roller = \"±0.013\"\n";
    for (rule, code, verdict) in
        [("simple", 0, "pass".into()), ("guard=5um", 3, "indeterminate".into()), ("iso14253", 2, Value::Null)]
    {
        let ended = run(&["eval", "-", "--format", "json", "--rule", rule], spec);
        assert_eq!((ended.code, &ended.json()["verdict"]), (Some(code), &verdict), "{rule}");
        assert_eq!(ended.json()["reason"].is_null(), code == 0, "{rule}");
    }
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
