//! What a verdict rests on: a range that holds wherever errors sit, or no verdict.

mod batches;
mod budgets;
mod said;
mod status;
mod uncertain;

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
            measured.stderr.starts_with("note: ")
                && measured.stderr.contains("teeth on which a search finds the largest"),
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
        assert!(
            json["notes"][0].as_str().is_some_and(|note| note.contains("teeth on which a search finds the largest")),
            "{json}"
        );
        let far = run(&["measure", "-", "--last", "40"], &spec);
        assert_eq!((far.code, far.stdout.as_str()), (Some(2), ""), "{}", far.stderr);
    }
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
