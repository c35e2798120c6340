//! One answer for one part: errors that are all on every tooth leave nothing to place, and the exact mesh judges them wherever
//! they stand.

use std::sync::Arc;

use rackmesh::batch::{ColumnEvaluator, ColumnPiece, Request, ResultValues};
use rackmesh::cli::{HeldSpec, answer};
use rackmesh::judge::bound::pinion_lead_angle_rad;
use rackmesh::spec::Spec;
use rackmesh::table::Stored;
use serde_json::Value;

use crate::common::is_long;
use crate::common::random::{self, Random};
use crate::process::{Folder, run};

/// Specs of the default run, and of the long one.
const SPECS: u64 = 24;
const LONG: u64 = 1_000;
/// One spec in so many has a rack that is free to roll, and one has form: these are slow. Only the long run has both at once.
const SLOW: u64 = 12;

/// A lead of the rack on all teeth whose bound is wide below, as its flanks are crowned.
const CROWNED: &str = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n\
    [rack]\nhelix_angle = 10\nface_width = 20\naddendum = 2\ncrowning = 0.005\n\
    [pinion]\nteeth = 8\nhelix_angle = 20\nprofile_shift = 0.4\nface_width = 30\ntip_diameter = 22\n";
const LIMITS: &str = "[limits]\ncenter_distance = { lower = -0.005, upper = 0.03 }\n";

fn ask(command: &str, options: &[&str], text: &str) -> Result<Value, String> {
    let spec = HeldSpec { name: "part.toml".to_owned(), text: text.to_owned() };
    answer(command, options, spec, &Arc::default()).map(|answer| answer.json).map_err(|problem| problem.to_string())
}

/// What is held against the limits, mm.
fn judged(json: &Value) -> (f64, f64) {
    let end = |name: &str| json["judged_mm"][name].as_f64().unwrap_or_else(|| panic!("{name}: {json}"));
    (end("lower"), end("upper"))
}

#[test]
fn a_lead_on_all_teeth_is_judged_by_the_mesh() {
    let errors = format!("{CROWNED}[errors]\nrack_lead = 0.05\n{LIMITS}");
    let teeth = format!("{CROWNED}[[rack.deviation]]\nteeth = \"all\"\nlead = 0.05\n{LIMITS}");
    let (eval, mesh) = (ask("eval", &[], &errors).unwrap(), ask("mesh", &["--to", "6.4"], &errors).unwrap());
    let known = ask("mesh", &["--to", "6.4"], &teeth).unwrap();
    for json in [&eval, &mesh, &known] {
        assert_eq!((&json["verdict"], &json["judged_by"]), (&"pass".into(), &"mesh".into()), "{json}");
        assert_eq!(json["judged_mm"], known["judged_mm"]);
    }
    let (lower, upper) = judged(&eval);
    assert!(0.0101 < lower && lower < upper && upper < 0.0103, "{lower} {upper}");
    // the bound stands beside, and nothing was searched
    assert!(eval["combined"]["range_mm"]["lower"].as_f64().unwrap() < -0.02);
    assert_eq!(eval["reached_mm"], Value::Null);
}

/// A tolerance of every part, with two ends or one, is no value of a part: one pasted part has the range, the verdict and
/// the limits' verdicts that a batch gives the same row, and the page on it tells of the same range.
#[test]
fn a_tolerance_of_every_part_is_none_of_its_values() {
    let folder = Folder::new("tolerance-of-every-part");
    let pair = "[pair]\nnormal_pressure_angle = 20\nnormal_module = 2\n[rack]\nface_width = 20\nhelix_angle = 10\n\
        [pinion]\nface_width = 30\nhelix_angle = 20\n";
    let limits = "[limits]\ncenter_distance = { lower = -0.02, upper = 0.002 }\n";
    let micrometres = "{ lower = \"-9 um\", upper = \"2 um\" }";
    for (kind, ends, extent) in [
        ("pinion_radial", micrometres, ""),
        ("pinion_radial", "{ lower = \"-9 um\", upper = \"9 um\" }", ""),
        ("pinion_radial", micrometres, ", extent = \"all\""),
        ("rack_pitch", micrometres, ", extent = \"one\""),
        ("rack_lead", "{ lower = -0.02, upper = 0.01 }", ""),
        ("pinion_lead", micrometres, ""),
    ] {
        let error = format!("[errors]\n{kind} = {{ value = {ends}, every_part = true{extent} }}\n");
        let column = "[table.columns]\npart_id = \"id\"\nrack_over_roller = { name = \"M\", unit = \"um\" }\n";
        let (spec, table) = (folder.path("spec.toml"), folder.path("parts.csv"));
        std::fs::write(&spec, format!("{pair}{error}{limits}{column}")).unwrap();
        std::fs::write(&table, "id,M\nA,1\n").unwrap();
        let rows = run(&["batch", &spec, &table, "-f", "json", "--decimals", "full"], "").json();
        let pasted = run(&["paste", &spec, &table, "-f", "json"], "").json();
        let range = |end: &str| pasted["combined"]["range_mm"][end].clone();
        assert_eq!(
            (&range("lower"), &range("upper"), &pasted["verdict"]),
            (&rows[0]["range_lower_mm"], &rows[0]["range_upper_mm"], &rows[0]["verdict"]),
            "{error}"
        );
        assert_eq!(pasted["limits"][0]["verdict"], pasted["verdict"], "{error}");
        if kind == "pinion_radial" && ends == micrometres {
            assert_eq!((range("lower").as_f64(), range("upper").as_f64()), (Some(-0.008), Some(0.003)));
            assert_eq!(pasted["verdict"], "fail");
            let page = folder.path("page.html");
            run(&["report", &spec, &table, "-o", &page], "");
            let page = std::fs::read_to_string(page).unwrap();
            assert!(page.contains("0.003") && !page.contains("0.01 mm"), "{page}");
        }
    }
}

/// A tolerance, one tooth and a pinion's pitch leave something to place.
#[test]
fn what_is_left_to_place_is_judged_by_the_bound() {
    for (error, judge) in [
        ("rack_lead = { value = 0.05, extent = \"part\" }", "bound"),
        ("rack_lead = { value = 0.05, extent = \"each\" }", "bound"),
        ("rack_pitch = \"5 um\"", "bound"),
        ("pinion_pitch = { value = \"5 um\", extent = \"all\" }", "bound"),
        ("rack_lead = 0.05\npinion_radial = \"5 um\"", "bound"),
        ("rack_lead = 0.05\npinion_radial = { value = \"5 um\", extent = \"all\" }", "mesh"),
        ("rack_pitch = { value = \"5 um\", extent = \"all\" }\npinion_lead = \"5 um\"", "mesh"),
        ("rack_over_roller = \"5 um\"", "mesh"),
    ] {
        let eval = ask("eval", &[], &format!("{CROWNED}[errors]\n{error}\n{LIMITS}")).unwrap();
        assert_eq!(eval["judged_by"], judge, "{error}");
    }
    // without all of the geometry there is no mesh
    let unknown = CROWNED.replace("tip_diameter = 22\n", "").replace("crowning = 0.005\n", "");
    let eval = ask("eval", &[], &format!("{unknown}[errors]\nrack_over_roller = \"5 um\"\n{LIMITS}")).unwrap();
    assert_eq!(eval["judged_by"], "bound");
}

/// Teeth of one part that are known one by one, and errors of the other one on all of its teeth, leave nothing either.
#[test]
fn known_teeth_and_errors_on_all_others_are_one_mesh() {
    let known = "[[pinion.deviation]]\nteeth = 3\nshift = 0.01\n";
    let errors = format!("{CROWNED}{known}[errors]\nrack_lead = 0.05\n{LIMITS}");
    let teeth = format!("{CROWNED}{known}[[rack.deviation]]\nteeth = \"all\"\nlead = 0.05\n{LIMITS}");
    let (eval, all) = (ask("eval", &[], &errors).unwrap(), ask("eval", &[], &teeth).unwrap());
    assert_eq!((&eval["judged_by"], &eval["judged_mm"]), (&"mesh".into(), &all["judged_mm"]));
}

/// A pair without contact is judged by the bound, which says why.
#[test]
fn a_mesh_without_an_answer_leaves_the_bound() {
    let apart = CROWNED.replace("tip_diameter = 22", "tip_diameter = 17.2").replace("addendum = 2", "addendum = 0.2");
    let spec = format!("{apart}[errors]\nrack_over_roller = \"5 um\"\n{LIMITS}");
    let ended = run(&["eval", "-"], &spec);
    assert!(ended.stdout.contains("the exact mesh has no answer, so the worst case judges"), "{}", ended.stdout);
}

/// The uncertainty of errors on all teeth counts at the ends of the mesh, that of what a nominal value is computed from, too.
#[test]
fn uncertain_errors_on_all_teeth_are_uncertain_in_the_mesh() {
    let with = |error: &str, limit: f64| {
        let text = format!("{CROWNED}[errors]\n{error}\n[limits]\ncenter_distance = {{ upper = {limit} }}\n");
        ask("eval", &["--rule", "iso14253"], &text).unwrap()
    };
    let lead = |u: f64| format!("rack_lead = {{ value = 0.05, u = {u} }}");
    let (_, upper) = judged(&with(&lead(0.001), 0.03));
    let slope = (judged(&with("rack_lead = { value = 0.051, u = 0.001 }", 0.03)).1 - upper) / 0.001;
    for (u, factor, verdict) in
        [(0.001, 1.9, "pass"), (0.001, 1.4, "indeterminate"), (0.001, -1.9, "fail"), (0.002, 1.9, "indeterminate")]
    {
        let json = with(&lead(u), upper + factor * slope * 0.001);
        assert_eq!(json["verdict"], verdict, "{u} {factor}");
    }
}

/// Errors as they stand in `[errors]`, and the same on every tooth.
struct Part {
    errors: Vec<(&'static str, f64)>,
    of_errors: String,
    of_teeth: String,
}

/// Errors of both parts on all teeth of a random pair; `None` if that is no pair.
fn part(random: &mut Random, rolls: bool, has_form: bool) -> Option<Part> {
    let pair = random::pair(random);
    let (rack, pinion) = (pair.rack(), pair.pinion());
    let mut text = format!(
        "[pair]\nnormal_module = {:.6}\nnormal_pressure_angle = {:.6}\n",
        pair.normal_module_mm(),
        pair.normal_pressure_angle_rad().to_degrees()
    );
    text += &format!(
        "[rack]\nhelix_angle = {:.6}\nface_width = {:.6}\naddendum = {:.6}\n",
        rack.helix_angle_rad.to_degrees(),
        rack.face_width_mm,
        rack.addendum_mm
    );
    if has_form {
        text += &format!("crowning = {:.6}\n", random.range(0.0, 0.01));
    }
    if has_form && random.chance(0.5) {
        let (amount, start) = (random.range(0.0, 0.01), random.range(0.0, 0.8) * rack.addendum_mm);
        text += &format!("tip_relief = {{ amount = {amount:.6}, start = {start:.6} }}\n");
    }
    text += &format!(
        "[pinion]\nteeth = {}\nhelix_angle = {:.6}\nprofile_shift = {:.6}\nface_width = {:.6}\ntip_diameter = {:.6}\n",
        pinion.teeth,
        pinion.helix_angle_rad.to_degrees(),
        pinion.profile_shift,
        pinion.face_width_mm,
        2.0 * pinion.tip_radius_mm
    );
    if has_form && random.chance(0.5) {
        text += &format!("profile_slope = {:.6}\n", random.range(-0.01, 0.01));
    }
    if rolls {
        text += &format!("[support]\nroll = \"free\"\nroll_axis_depth = {:.6}\n", random.range(2.0, 12.0));
    }
    let pair = Spec::parse("pair.toml", &text).and_then(|spec| spec.pair("the test")).ok()?;
    let mut part = Part { errors: Vec::new(), of_errors: format!("{text}[errors]\n"), of_teeth: text };
    for (key, deviation, largest) in [
        ("rack_over_roller", "[[rack.deviation]]\nteeth = \"all\"\nover_roller = ", 0.05),
        ("rack_pitch", "[[rack.deviation]]\nteeth = \"all\"\npitch = ", 0.01),
        ("rack_lead", "[[rack.deviation]]\nteeth = \"all\"\nlead = ", 0.1),
        ("pinion_radial", "[[pinion.deviation]]\nteeth = \"all\"\nradial = ", 0.05),
        ("pinion_lead", "[[pinion.deviation]]\nteeth = \"all\"\nlead = ", 0.03),
    ] {
        if random.chance(0.5) {
            continue;
        }
        let value = (random.range(-largest, largest) * 1e6).round() / 1e6;
        let on_teeth = if key == "pinion_lead" { pinion_lead_angle_rad(&pair, value).to_degrees() } else { value };
        part.errors.push((key, value));
        part.of_errors += &format!("{key} = {{ value = {value}, extent = \"all\" }}\n");
        part.of_teeth += &format!("{deviation}{on_teeth}\n");
    }
    (!part.errors.is_empty()).then_some(part)
}

/// The verdict on a part in a batch.
fn in_batch(part: &Part, text: &str) -> String {
    let spec = Arc::new(Spec::parse("part.toml", text).unwrap());
    let titles: Vec<_> = part
        .errors
        .iter()
        .map(|(key, _)| format!("{key} [{}]", if *key == "rack_lead" { "deg" } else { "mm" }))
        .collect();
    let values = part.errors.iter().map(|(_, value)| vec![*value]);
    let columns: Vec<_> = values.map(|value| Some(Stored::doubles(value))).collect();
    let piece = ColumnPiece { name: "lot", before: 0, titles: &titles, columns: &columns };
    let evaluated = ColumnEvaluator::new(&spec, &[], Request::default()).evaluate(&piece);
    let evaluated = evaluated.unwrap_or_else(|problem| panic!("{problem}: {text}"));
    let at = evaluated.columns.iter().position(|(name, _)| name == "verdict").unwrap();
    let ResultValues::Texts { bytes, .. } = &evaluated.results.columns[at].values else { panic!("it is text") };
    String::from_utf8(bytes.clone()).unwrap()
}

/// Limits 0.2 µm inside and outside of what the mesh of the same teeth has: `eval`, `mesh` and a batch say the same as
/// that mesh.
#[test]
fn eval_mesh_and_batch_never_differ() {
    const APART: f64 = 2e-4;
    let (mut held, mut unsolved) = (0, 0);
    for seed in 0..if is_long() { LONG } else { SPECS } {
        let mut random = Random(seed ^ 0x0a11_7ee7);
        let rolls = seed % SLOW == 0;
        let has_form = if is_long() { random.chance(0.5) } else { seed % SLOW == 5 };
        let Some(part) = part(&mut random, rolls, has_form) else { continue };
        let limits =
            |lower: f64, upper: f64| format!("[limits]\ncenter_distance = {{ lower = {lower}, upper = {upper} }}\n");
        let Ok(mesh) = ask("mesh", &["--to", "1"], &format!("{}{}", part.of_teeth, limits(-1.0, 1.0))) else {
            unsolved += 1;
            continue;
        };
        if mesh["judged_mm"].is_null() {
            unsolved += 1;
            continue;
        }
        held += 1;
        let (lower, upper) = judged(&mesh);
        let is_slow = !is_long() && (rolls || has_form);
        for (limits, expected) in [
            (limits(lower - APART, upper + APART), "pass"),
            (limits(lower + APART, upper + APART), "fail"),
            (limits(lower - APART, upper - APART), "fail"),
        ]
        .into_iter()
        .take(if is_slow { 1 } else { 3 })
        {
            let text = format!("{}{limits}", part.of_errors);
            let (eval, mesh) = (ask("eval", &[], &text).unwrap(), ask("mesh", &["--to", "1"], &text).unwrap());
            assert_eq!((&eval["verdict"], &mesh["verdict"]), (&expected.into(), &expected.into()), "{seed}: {text}");
            assert_eq!(
                (&eval["judged_by"], &eval["judged_mm"]),
                (&"mesh".into(), &mesh["judged_mm"]),
                "{seed}: {text}"
            );
            assert_eq!(in_batch(&part, &text), expected, "{seed}: {text}");
        }
    }
    assert!(held > 10 * unsolved && held >= 12, "{held} {unsolved}");
}

/// In a batch the printed range stays the bound, and the reason says what the mesh has.
#[test]
fn a_batch_meshes_what_its_bound_does_not_pass() {
    let folder = Folder::new("a_batch_meshes_what_its_bound_does_not_pass");
    let (spec, table) = (folder.path("spec.toml"), folder.path("parts.csv"));
    std::fs::write(&spec, format!("{CROWNED}[errors]\n{LIMITS}")).unwrap();
    std::fs::write(&table, "part_id,rack_lead [deg]\nA,0.001\nB,0.05\nC,0.5\nD,0.05\n").unwrap();
    let ended = run(&["batch", &spec, &table], "");
    let rows: Vec<Vec<_>> = ended.stdout.lines().map(|line| line.splitn(9, ',').collect()).collect();
    let at = |name: &str| rows[0].iter().position(|title| *title == name).unwrap();
    let column = |name: &str| rows[1..].iter().map(|row| row[at(name)]).collect::<Vec<_>>();
    assert_eq!(column("verdict"), ["pass", "pass", "fail", "pass"], "{}", ended.stdout);
    assert!(column("range_lower_mm")[1].starts_with("-0.024"), "{}", ended.stdout);
    let reasons = column("reason");
    assert_eq!(reasons[0], "");
    assert!(reasons[1].starts_with("judged by the exact mesh: ΔCD = 0.0101"), "{}", ended.stdout);
    assert_eq!(reasons[1], reasons[3]);
    assert_eq!(ended.code, Some(1));
    let summary = run(&["batch", &spec, &table, "--summary", "--format", "json"], "").json();
    assert_eq!((&summary["judged_by"], &summary["judged_by_mesh"]), (&"mesh".into(), &3.into()), "{summary}");
}
