//! A measured curve on the computed one: where it lies, how both vary, and what is refused.

use std::sync::Arc;

use rackmesh::cli::{HeldSpec, answer};
use serde_json::Value;

use crate::process::run;

const SPEC: &str = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 19.9\n[rack]\nface_width = 19.7\naddendum = 1.70\n\
                    [pinion]\nteeth = 8\nhelix_angle = 21\nprofile_shift = 0.3\nface_width = 30\ntip_diameter = 19.738\n";
const ERRORS: &str =
    "[[rack.deviation]]\nteeth = 4\nthickness = \"20 um\"\n[[rack.deviation]]\nteeth = 6\nright = \"-12 um\"\n";

fn ask(spec: &str, options: &[&str]) -> Result<Value, String> {
    let spec = HeldSpec { name: "spec.toml".to_owned(), text: spec.to_owned() };
    answer("mesh", options, spec, &Arc::default()).map(|answer| answer.json).map_err(|problem| problem.to_string())
}

/// ΔCD of a spec at irregular strokes.
fn computed(spec: &str, strokes: &[f64]) -> Vec<f64> {
    let spec = rackmesh::spec::Spec::parse("spec.toml", spec).unwrap();
    let mesh = spec.mesh(&rackmesh::spec::MeasuredTables::default()).unwrap().mesh;
    mesh.sample(strokes).into_iter().map(|point| point.unwrap().delta_cd_mm).collect()
}

fn strokes() -> Vec<f64> {
    (0..500).map(|at| 2.0 + 0.2 * f64::from(at) + 0.01 * f64::from(at % 7)).collect()
}

fn table(folder: &tempfile::TempDir, text: &str) -> String {
    let path = folder.path().join("trace.csv");
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

fn number(value: &Value, place: &str) -> f64 {
    value.pointer(place).and_then(Value::as_f64).unwrap_or_else(|| panic!("{place}: {value}"))
}

/// The offset and the stroke shift that a curve was moved by are found, and without a fit it stays where it is.
#[test]
fn a_moved_curve_is_laid_back() {
    let folder = tempfile::tempdir().unwrap();
    let spec = SPEC.to_owned() + ERRORS;
    let strokes = strokes();
    let moved: Vec<f64> = strokes.iter().map(|stroke| stroke + 0.73).collect();
    let rows: Vec<String> = strokes
        .iter()
        .zip(computed(&spec, &moved))
        .map(|(stroke, mm)| format!("{stroke:.2};{:.3}", 1000.0 * (mm + 0.0123)))
        .collect();
    let path = table(&folder, &format!("Hub [mm];ΔCD [µm]\n{}\n", rows.join("\n")));
    let all = ask(&spec, &["--measured", &path]).unwrap();
    assert!((number(&all, "/measured/offset/value_mm") - 0.0123).abs() < 1e-6);
    assert!((number(&all, "/measured/stroke_shift/value_mm") + 0.73).abs() < 1e-4);
    assert!(number(&all, "/measured/rms_difference_mm") < 1e-6);
    let both = ["measured", "computed"].map(|curve| number(&all, &format!("/measured/{curve}/tooth_to_tooth_mm")));
    assert!((both[0] - both[1]).abs() < 2e-6 && both[0] > 0.02, "{both:?}");
    assert_eq!(all["measured"]["measured"]["orders"].as_array().unwrap().len(), 24);
    assert_eq!(all["measured"]["points"].as_array().unwrap().len(), 500);
    let unfitted = ask(&spec, &["--measured", &path, "--no-fit"]).unwrap();
    assert_eq!(unfitted["measured"]["offset"], Value::Null);
    assert!(number(&unfitted, "/measured/rms_difference_mm") > 0.01);
}

/// A column without an owner, a row that is no point, a table without ΔCD; values that are missing are left out.
#[test]
fn a_trace_is_read_by_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    let of = |text: &str, options: &[&str]| {
        let path = table(&folder, text);
        ask(SPEC, &[&["--measured", &path], options].concat())
    };
    let rows = "0;0,001;20,1\n1;0,002;20,2\n2;0,001;20,1\n3;n.a.;20,1\n";
    let refused = of(&format!("stroke [mm];delta_cd [mm];Temp\n{rows}"), &[]).unwrap_err();
    assert!(refused.contains("Temp"), "{refused}");
    let read = of(&format!("stroke [mm];delta_cd [mm];Temp\n{rows}"), &["--ignore", "Temp"]).unwrap();
    assert_eq!(read["measured"]["points"].as_array().unwrap().len(), 3);
    assert!(read["measured"]["notes"][0].as_str().unwrap().starts_with("1 of the rows"), "{read}");
    for (text, said) in [
        ("stroke [mm],Weg2\n0,1\n1,2\n2,3\n", "delta_cd"),
        ("stroke [mm],delta_cd [mm]\n0,0.1\n1,x\n2,0.1\n", "line 3"),
        ("stroke [mm],delta_cd\n0,0.1\n0,0.2\n", "two points"),
        ("stroke,ΔCD\n0,0.1\n1,0.2\n", "unit"),
    ] {
        let refused = of(text, &["--ignore", "Weg2"]).unwrap_err();
        assert!(refused.contains(said), "{said}: {refused}");
    }
    let named = SPEC.to_owned()
        + "[table.columns]\nstroke = { name = \"X\", unit = \"mm\" }\ndelta_cd = { name = \"Y\", unit = \"um\" }\n";
    let path = table(&folder, "X,Y\n0,1\n1,2.5\n2,1\n3,1\n");
    let read = ask(&named, &["--measured", &path]).unwrap();
    assert_eq!(read["measured"]["points"][1]["measured_mm"], 0.0025);
}

/// Points of a trace of a turn of the pinion, and of two.
const TURN: i32 = 503;
const TWO_TURNS: i32 = 1005;

/// A trace of a spec with errors, with 1 µm of noise at 0.1 mm and an offset, on a gauge whose strokes are larger than the
/// computed ones.
fn noisy_from(errors: &str, seed: u64, count: i32, shift_mm: f64) -> String {
    noisy_of(&(SPEC.to_owned() + errors), seed, count, [shift_mm, 0.0042])
}

fn noisy_of(spec: &str, seed: u64, count: i32, [shift_mm, offset_mm]: [f64; 2]) -> String {
    let mut state = seed;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let strokes: Vec<f64> = (0..=count).map(|at| 0.1 * f64::from(at)).collect();
    let rows = strokes.iter().zip(computed(spec, &strokes)).map(|(stroke, mm)| {
        // near enough to the normal distribution
        let noise = (0..12).map(|_| unit()).sum::<f64>() - 6.0;
        format!("{:.1},{:.5}\n", stroke + shift_mm, mm + offset_mm + 0.001 * noise)
    });
    std::iter::once("stroke,delta_cd\n".to_owned()).chain(rows).collect()
}

fn rack(tooth: i64, key: &str, um: i64) -> String {
    format!("[[rack.deviation]]\nteeth = {tooth}\n{key} = \"{um} um\"\n")
}

/// An error of a tooth: part, kind, tooth, size in µm.
type Error = (&'static str, &'static str, i64, f64);

/// Whether an error is this answer or one of its alternatives, its size within 2 µm.
fn is_named(found: &Value, (part, kind, tooth, um): Error) -> bool {
    let others = found["alternatives"].as_array().into_iter().flatten();
    std::iter::once(found).chain(others).any(|one| {
        let is_it = one["part"] == part && one["kind"] == kind && one["tooth"] == tooth;
        is_it && (1000.0 * number(one, "/value_mm") - um).abs() <= 2.0
    })
}

/// What is found in a trace of the spec with some errors.
fn diagnosed(errors: &str, seed: u64, count: i32, shift_mm: f64) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let path = table(&folder, &noisy_from(errors, seed, count, shift_mm));
    ask(SPEC, &["--measured", &path, "--diagnose"]).unwrap()
}

/// Errors with the same curve are one answer, whichever of them the rack has: thickness e and over-roller e/(2 tan α_n), right
/// and shift of one tooth, a rack tooth and a pinion space where the trace has one turn.
#[test]
fn errors_with_the_same_curve_are_alternatives() {
    // 2 tan 19.9°
    const TWICE: f64 = 0.724;
    let cases: [(&str, i64, i64, i32, [Error; 2]); 5] = [
        ("thickness", 5, 20, TWO_TURNS, [("rack", "thickness", 5, 20.0), ("rack", "over_roller", 5, 20.0 / TWICE)]),
        ("over_roller", 9, 30, TWO_TURNS, [("rack", "over_roller", 9, 30.0), ("rack", "thickness", 9, 30.0 * TWICE)]),
        ("right", 9, 15, TWO_TURNS, [("rack", "right", 9, 15.0), ("rack", "shift", 9, 15.0)]),
        ("shift", 7, -18, TWO_TURNS, [("rack", "shift", 7, -18.0), ("rack", "left", 7, 18.0)]),
        ("over_roller", 4, 25, TURN, [("rack", "over_roller", 4, 25.0), ("pinion", "radial", 3, 25.0)]),
    ];
    for (at, (kind, tooth, um, count, expected)) in cases.into_iter().enumerate() {
        let answer = diagnosed(&rack(tooth, kind, um), at as u64 + 11, count, 0.0);
        let found = answer["diagnosis"].as_array().unwrap();
        assert_eq!(found.len(), 1, "{kind}: {found:?}");
        assert!(expected.iter().all(|error| is_named(&found[0], *error)), "{expected:?}: {found:?}");
        let noise = number(&answer, "/measured/explained/noise_mm");
        assert!((noise - 0.001).abs() < 1.5e-4 && number(&answer, "/measured/explained/rms_left_mm") < 1.1 * noise);
    }
    let radial = diagnosed("[[pinion.deviation]]\nteeth = 3\nradial = \"14 um\"\n", 4, TWO_TURNS, 0.0);
    assert!(is_named(&radial["diagnosis"][0], ("pinion", "radial", 3, 14.0)), "{}", radial["diagnosis"]);
}

/// Without an error there is none, and what the curve cannot tell is said.
#[test]
fn a_curve_without_an_error_gets_none() {
    let none = diagnosed("", 6, TWO_TURNS, 0.0);
    assert_eq!(none["diagnosis"].as_array().unwrap().len(), 0);
    let unseen = none["measured"]["explained"]["unseen"].as_array().unwrap();
    let thin = unseen.iter().find(|of| of["part"] == "rack" && of["kind"] == "thickness" && of["sign"] == "-");
    assert!(thin.is_some_and(|of| of["teeth"].as_array().unwrap().contains(&7.into())), "{unseen:?}");
}

/// Errors of several teeth that are together what an eccentricity of the pinion is are called that, and have no sizes that hold.
#[test]
fn an_eccentricity_is_no_set_of_teeth() {
    let folder = tempfile::tempdir().unwrap();
    let eccentric = SPEC.to_owned() + "[[pinion.deviation]]\neccentricity = { amount = \"15 um\", tooth = 2 }\n";
    let trace = noisy_of(&eccentric, 8, TWO_TURNS, [0.0, 0.0042]);
    let few: Vec<&str> = trace.lines().step_by(20).collect();
    let path = table(&folder, &few.join("\n"));
    let answer = ask(SPEC, &["--measured", &path, "--diagnose"]).unwrap();
    assert!((number(&answer, "/measured/explained/eccentricity_mm") - 0.015).abs() < 1e-3);
    let found = answer["diagnosis"].as_array().unwrap();
    assert!(
        found.len() > 1 && found.iter().all(|one| one["interval_mm"] == serde_json::json!([null, null])),
        "{found:?}"
    );
}

/// Where a thin tooth leaves its work to its neighbours, every larger error has the same curve: one end of the size is open, and the
/// value is near the other one, however large the error is.
#[test]
fn a_size_that_shows_on_one_side_has_one_end() {
    const RELIEVED: &str = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nface_width = 20\naddendum = 1.6\n\
                            tip_relief = { amount = \"15 um\", start = 0.4 }\n[pinion]\nteeth = 9\nhelix_angle = 15\nprofile_shift = 0.3\n\
                            face_width = 26\ntip_diameter = 23.2\nprofile_slope = \"6 um\"\n";
    let folder = tempfile::tempdir().unwrap();
    let size = |um: i64| {
        let path = table(&folder, &noisy_of(&(RELIEVED.to_owned() + &rack(3, "over_roller", um)), 41, 380, [0.0; 2]));
        let answer = ask(RELIEVED, &["--measured", &path, "--diagnose", "--no-fit"]).unwrap();
        let found = &answer["diagnosis"][0];
        let others = found["alternatives"].as_array().into_iter().flatten();
        let is_it = |one: &&Value| one["kind"] == "over_roller" && one["tooth"] == 3;
        let one = std::iter::once(found).chain(others).find(is_it).unwrap_or_else(|| panic!("{um}: {answer}"));
        let [value, end] = ["/value_mm", "/interval_mm/1"].map(|place| number(one, place));
        assert!(one["interval_mm"][0].is_null() && value < end && end < 0.0, "{um}: {one}");
        value
    };
    let [first, second] = [-50, -120].map(size);
    assert!((first - second).abs() < 1e-3 && (-0.03..-0.02).contains(&first), "{first} {second}");
}

/// Two errors are two answers. A gauge whose stroke begins anywhere within half a pitch does not change them, and the shift has
/// one sign: measured less computed.
#[test]
fn a_stroke_shift_does_not_change_the_teeth() {
    for (shift_mm, errors) in [
        (2.0, [("rack", "thickness", 7, 22.0), ("rack", "right", 12, 14.0)]),
        (-2.6, [("rack", "thickness", 4, 25.0), ("rack", "left", 11, 16.0)]),
    ] {
        let written: String = errors.iter().map(|(_, kind, tooth, um)| rack(*tooth, kind, *um as i64)).collect();
        let answer = diagnosed(&written, 31, TWO_TURNS, shift_mm);
        let found = answer["diagnosis"].as_array().unwrap();
        assert!(found.len() == 2 && found.iter().zip(errors).all(|(one, error)| is_named(one, error)), "{found:?}");
        let told = number(&answer, "/measured/explained/stroke_shift_mm");
        assert!((told - shift_mm).abs() < 0.05, "{told} for {shift_mm}");
    }
}

/// Errors that are together what one is are that one, and an error that explains a part of two gives way to them.
#[test]
fn the_set_is_the_smallest() {
    for ([first, second], seed) in [([(13, "23.5"), (4, "19")], 6), ([(3, "11.8"), (12, "10.3")], 10)] {
        let thick =
            |(tooth, um): (i64, &str)| format!("[[rack.deviation]]\nteeth = {tooth}\nthickness = \"{um} um\"\n");
        let answer = diagnosed(&(thick(first) + &thick(second)), seed, TWO_TURNS, 0.0);
        let teeth: Vec<_> =
            answer["diagnosis"].as_array().unwrap().iter().map(|one| one["tooth"].as_i64().unwrap()).collect();
        assert_eq!(teeth, [first.0, second.0], "{}", answer["diagnosis"]);
    }
}

/// A measured stretch does not shrink the travel over which a yoke is judged.
#[test]
fn a_short_measured_curve_leaves_the_yoke_its_travel() {
    let trace = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("short-trace.csv");
    let rows = (0..24).map(|at| format!("{},{}\n", 40.0 + 0.25 * f64::from(at), at % 3)).collect::<Vec<_>>().concat();
    std::fs::write(&trace, format!("stroke [mm],delta_cd [um]\n{rows}")).unwrap();
    let path = trace.to_string_lossy();
    let [alone, beside] = [vec![], vec!["--measured", &path]].map(|more| {
        let ended = run(&[vec!["mesh", "examples/function.toml", "--format", "json"], more].concat(), "");
        (ended.code, ended.json()["yoke"].clone())
    });
    assert_eq!(alone.0, beside.0);
    assert_eq!(alone.1["torque_n_m"], beside.1["torque_n_m"]);
    assert_eq!(alone.1["setting"], beside.1["setting"]);
}
