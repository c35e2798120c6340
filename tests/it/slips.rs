//! What a first user gets wrong, or reads first: each slip is answered with its cause and what to write.

use crate::process::{Folder, run};

const PITCH: &str = "[pair]\nnormal_pressure_angle = 20\n[errors]\nrack_pitch = { value = \"12 um\", u = \"1 um\" }\n";

/// Runs a command on a spec, which stands for `-`; what it ends with and prints.
fn said(arguments: &[&str], spec: &str) -> (i32, String) {
    let ended = run(arguments, spec);
    (ended.code.unwrap_or(-1), ended.stdout + &ended.stderr)
}

#[test]
fn a_quantity_of_the_yoke_is_not_drawn_without_one() {
    let folder = Folder::new("plot-of");
    let picture = folder.path("c.svg");
    for (what, needs) in [("torque", "it needs `preload` below [yoke]"), ("play", "it needs [yoke]")] {
        let (code, text) = said(&["mesh", "examples/mesh.toml", "--plot", &picture, "--plot-of", what], "");
        assert!(code == 2 && text.contains(needs), "{code} {text}");
    }
    assert!(!std::fs::exists(&picture).unwrap());
}

#[test]
fn a_guard_band_of_millimetres_says_its_unit() {
    let (code, text) = said(&["eval", "-", "--rule", "guard=5"], PITCH);
    assert!(code == 2 && text.contains("if that is µm, write 5um; if not, write the unit: guard=5mm"), "{text}");
    for rule in ["guard=5mm", "guard=5um", "guard=0.005"] {
        assert_eq!(said(&["eval", "-", "--rule", rule], PITCH).0, 0, "{rule}");
    }
}

/// Where nothing scatters there is no statistical sum, nor an uncertainty of one.
#[test]
fn an_uncertainty_is_that_of_what_is_judged() {
    let (_, text) = said(&["eval", "-", "--stack", "rss"], PITCH);
    assert!(text.contains("worst case, lower end") && !text.contains("statistical (RSS)"), "{text}");
}

#[test]
fn the_last_line_names_every_limit_that_fails() {
    let spec =
        "[errors]\nrack_over_roller = \"30 um\"\n[limits]\ncenter_distance = \"±0.02\"\nrack_over_roller = \"±0.01\"\n";
    let (code, text) = said(&["eval", "-"], spec);
    let last = text.lines().rfind(|line| line.starts_with("FAIL")).unwrap_or_default();
    assert_eq!(code, 1);
    assert!(last.contains("above the limit 0.02 mm; ΔCD of rack over-roller: ") && last.contains("0.01 mm"), "{last}");
}

/// A table where a spec is meant and a spec where a table is, by what they hold.
#[test]
fn a_table_is_no_spec_and_a_spec_no_table() {
    for arguments in [&["eval", "examples/parts.csv"][..], &["batch", "examples/parts.csv", "examples/batch.toml"]] {
        let (code, text) = said(arguments, "");
        assert!(code == 2 && text.contains("examples/parts.csv is a table, and not a spec"), "{text}");
    }
    let (code, text) = said(&["batch", "examples/batch.toml", "examples/minimal.toml"], "");
    assert!(code == 2 && text.contains("examples/minimal.toml is a spec, and not a table"), "{text}");
    // a misspelt spec stays one
    assert!(said(&["eval", "-"], "[errors]\nrack_pitch\n").1.contains("toml-syntax"));
    assert!(!said(&["eval", "-"], "[errors]\nrack_pitch\n").1.contains("a table"));
}

#[test]
fn a_decimal_comma_is_told_wherever_it_stands() {
    for value in [
        "0,013",
        "{ measured = 25,013, nominal = 25 }",
        "{ nominal = 25, measured = 25,013 }",
        "{ values = [25,013, 25,01] }",
    ] {
        let (_, text) = said(&["eval", "-"], &format!("[errors]\nrack_over_roller = {value}\n"));
        assert!(text.contains("numbers take a decimal point, not a comma"), "{value}: {text}");
    }
    for value in ["{ values = [1,2,x] }", "{ values = [1,2,3 }", "20 um"] {
        let (_, text) = said(&["eval", "-"], &format!("[errors]\nrack_over_roller = {value}\n"));
        assert!(text.contains("toml-syntax") && !text.contains("decimal point"), "{value}: {text}");
    }
}

/// All keys that a class needs come at once, as far as they do not depend on a key that is missing.
#[test]
fn a_class_names_all_keys_that_it_lacks() {
    let classes = "[errors]\nrack_pitch = { class = 7 }\npinion_pitch = { class = 6 }\n";
    let standard = format!("{classes}[tolerance]\nstandard = \"iso1328-1:1995\"\n");
    let keys = ["pair.normal_module", "pair.normal_pressure_angle", "pinion.teeth", "tolerance.diameter"];
    for (spec, more) in [(classes, "tolerance.standard"), (standard.as_str(), "tolerance.diameter")] {
        let (code, text) = said(&["eval", "-"], spec);
        let missing = |key: &str| text.matches(&format!("`{key}` is missing")).count() == 1;
        assert!(code == 2 && keys.into_iter().chain([more]).all(missing), "{text}");
    }
}

#[test]
fn a_comparison_says_why_a_spec_has_no_verdict() {
    let lacking = PITCH.replace("rack_pitch", "rack_lead = \"2 arcmin\"\nrack_pitch");
    let (_, text) = said(&["compare", "examples/minimal.toml", "-"], &lacking);
    assert!(text.contains("No verdict: <stdin>: no result: `rack.face_width` is missing"), "{text}");
    assert!(!text.contains("no limit is given"), "{text}");
}

/// A file or a pipe takes pages of 80 columns; tables stay Markdown.
#[test]
fn a_page_in_a_pipe_has_short_lines() {
    for topic in ["worst-case", "rack-pitch", "yoke", "rule"] {
        let (_, text) = said(&["explain", topic], "");
        let long = text.lines().filter(|line| !line.starts_with(['|', ' '])).find(|line| line.chars().count() > 80);
        assert_eq!(long, None, "{topic}");
        assert!(!text.contains(".rs`"), "{topic}");
    }
}

/// An option that `-h` leaves out is described in the page, and in no example of `-h`.
#[test]
fn manual_pages_describe_every_option_and_short_examples_use_listed_ones() {
    let folder = Folder::new("man-options");
    run(&["man", "--dir", &folder.path("man1")], "");
    let mut pages = 0;
    for entry in std::fs::read_dir(folder.path("man1")).unwrap() {
        let page = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        let lines: Vec<_> = page.lines().collect();
        let bare = lines.windows(3).find(|three| three[0] == ".TP" && three[2].is_empty());
        assert_eq!(bare, None);
        pages += 1;
    }
    assert!(pages > 20, "{pages}");
    for command in ["batch", "paste", "mesh", "monte-carlo", "sweep", "report"] {
        let short = said(&[command, "-h"], "").1;
        let (options, examples) = short.split_once("Examples:").unwrap_or((&short, ""));
        // behind `--` are those of another command
        let own = examples.lines().filter_map(|line| line.split(" -- ").next()).flat_map(str::split_whitespace);
        for option in own.filter(|word| word.len() > 2 && word.starts_with("--")) {
            assert!(options.contains(option), "{command}: {option}: {short}");
        }
    }
}

#[test]
fn a_budget_says_first_what_it_leaves_out() {
    let (_, text) = said(&["budget", "examples/uncertain.toml", "--no-worst-teeth"], "");
    let mut first = text.lines().filter(|line| line.starts_with("note: ")).take(2);
    assert!(first.any(|note| note.contains("no part of the budget: the values of [errors]")), "{text}");
}

/// Deviations below the heading of a measured value: each row says why it is no part, and no rule would leave it out.
#[test]
fn rows_far_from_the_nominal_value_are_told_and_not_left_out() {
    let table = "part_id,rack_over_roller [mm],pinion_radial [mm],Remark\nA-0418,25.011,-0.004,ok\nA-0419,25.006,0.002,rechecked\n";
    let (_, text) = said(&["read", "-", "examples/steering.toml"], table);
    assert!(text.contains("line 2: -0.004 mm is far from the nominal value 8.5 mm"), "{text}");
    assert!(!text.contains("ignore_lines"), "{text}");
}
