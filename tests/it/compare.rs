//! Specs are compared by what they mean, and their results are those of the commands.

use std::path::Path;
use std::sync::Arc;

use rackmesh::cli::{Answer, HeldSpec, answer, compare};
use rackmesh::spec::Spec;
use serde_json::Value;

fn held(name: &str) -> HeldSpec {
    let name = format!("examples/{name}.toml");
    let text = std::fs::read_to_string(&name).unwrap();
    HeldSpec { name, text }
}

fn compared(specs: &[(&str, &[&str])], options: &[&str]) -> Answer {
    let of =
        |(name, settings): &(&str, &[&str])| (held(name), settings.iter().map(|text| (*text).to_owned()).collect());
    compare(options, specs.iter().map(of).collect(), &Arc::default()).unwrap()
}

/// The values under a name of `differences` or `results`.
fn values<'a>(answer: &'a Answer, list: &str, name: &str) -> Option<&'a Vec<Value>> {
    let key = if list == "differences" { "key" } else { "name" };
    let records = answer.json[list].as_array().unwrap();
    records.iter().find(|record| record[key] == name).map(|record| record["values"].as_array().unwrap())
}

#[test]
fn the_same_in_other_units_is_no_difference() {
    let other = [
        "pair.normal_pressure_angle=1194 arcmin",
        "rack.face_width={ value = \"1.97 cm\" }",
        "errors.rack_pitch=0.020 mm",
        "errors.rack_lead=3 arcmin",
        "limits.center_distance={ lower = \"-80 um\", upper = 0.08 }",
        "title=another",
        "report.part=7",
    ];
    let same = compared(&[("mesh-errors", &[]), ("mesh-errors", &other)], &[]);
    assert_eq!(same.json["differences"], serde_json::json!([]), "{}", same.markdown);
    for record in same.json["results"].as_array().unwrap() {
        assert_eq!(record["values"][0], record["values"][1], "{record}");
    }
    let differing = compared(&[("mesh-errors", &[]), ("mesh-errors", &["errors.rack_pitch=21 um"])], &[]);
    let [difference] = &differing.json["differences"].as_array().unwrap()[..] else { panic!("{}", differing.json) };
    assert_eq!(*difference, serde_json::json!({ "key": "errors.rack_pitch", "values": ["0.02 mm", "0.021 mm"] }));
}

#[test]
fn results_are_those_of_the_commands_and_the_worst_status_counts() {
    let specs: [(&str, &[&str]); 3] = [("mesh-errors", &[]), ("function", &[]), ("minimal", &[])];
    let all = compared(&specs, &["--from=0", "--to=20"]);
    assert_eq!(all.status, 1);
    for (index, (name, _)) in specs.into_iter().enumerate() {
        let eval = answer("eval", &[], held(name), &Arc::default()).unwrap();
        assert_eq!(all.json["specs"][index]["exit_status"], eval.status, "{name}");
        for (result, place) in [
            ("delta_cd_rack_pitch_mm", "/contributions/1/delta_cd_mm"),
            ("range_upper_mm", "/combined/range_mm/upper"),
            ("largest_play_mm", "/yoke/largest_play_mm"),
            ("verdict", "/verdict"),
        ] {
            let expected = eval.json.pointer(place).cloned().unwrap_or_default();
            assert_eq!(values(&all, "results", result).unwrap()[index], expected, "{name} {result}");
        }
        let mesh = answer("mesh", &["--from=0", "--to=20"], held(name), &Arc::default());
        let expected = mesh.map_or(Value::Null, |mesh| mesh.json["summary"]["peak_to_peak_mm"].clone());
        assert_eq!(values(&all, "results", "mesh_peak_to_peak_mm").unwrap()[index], expected, "{name}");
    }
    assert_eq!(all.json["specs"][1]["outside"], serde_json::json!(["pinion torque", "torque fluctuation"]));
    assert!(all.json["specs"][2]["notes"][0].as_str().unwrap().starts_with("no mesh: it needs `"));
    assert!(all.svg.unwrap().contains("mesh-errors.toml"));
    let failed = compared(&[("minimal", &[]), ("minimal", &["limits.center_distance=±0.01"])], &[]);
    assert_eq!(failed.json["specs"][1]["outside"], serde_json::json!(["center distance"]));
    // an open verdict is worse than a pass
    let open: [(&str, &[&str]); 2] = [("minimal", &[]), ("minimal", &["limits.rack_pitch=±0.01"])];
    assert_eq!(compared(&open, &[]).status, 2);
}

#[test]
fn limits_that_differ_are_drawn_with_their_spec() {
    let drawn =
        |limits: &str| compared(&[("mesh-errors", &[]), ("mesh", &[limits])], &["--from=0", "--to=8"]).svg.unwrap();
    let same = drawn("limits.center_distance=±0.08");
    assert!(same.contains(">limits<") && !same.contains("limits of"), "{same}");
    let differing = drawn("limits.center_distance=±0.05");
    for label in ["limits of mesh-errors.toml: -0.0800, +0.0800 mm", "limits of mesh.toml: -0.0500, +0.0500 mm"] {
        assert!(differing.contains(label), "{label}: {differing}");
    }
}

#[test]
fn every_key_of_a_spec_is_compared() {
    let text = std::fs::read_to_string("examples/everything.toml").unwrap();
    let spec = Spec::parse("examples/everything.toml", &text).unwrap();
    let written = spec.written(Path::new("examples/everything.toml")).unwrap();
    let lines = text.lines().map(str::trim).filter(|line| !line.starts_with('#'));
    let (mut section, mut count) = (String::new(), 0);
    for line in lines {
        if let Some(name) = line.strip_prefix('[') {
            section = name.trim_start_matches('[').split(']').next().unwrap().to_owned();
        } else if let Some((key, _)) = line.split_once(" = ") {
            let is_it = |(path, _): &(String, String)| {
                let path = path.replace("[1]", "").replace("[2]", "").replace("[3]", "");
                path.starts_with(format!("{section}.{key}").trim_start_matches('.'))
            };
            assert!(written.iter().any(is_it), "{section}.{key}");
            count += 1;
        }
    }
    assert!(count > 60, "{count}");
}
