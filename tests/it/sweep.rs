//! A row of a sweep is what the command says of that design, to the last digit, or why it says nothing.

use std::sync::Arc;

use rackmesh::batch::ResultValues;
use rackmesh::cli::{Answer, ColumnTable, HeldSpec, answer};
use serde_json::Value;

use crate::process::{Folder, run};

fn ask(command: &str, options: &[&str], example: &str) -> Result<Answer, String> {
    let name = format!("examples/{example}.toml");
    let text = std::fs::read_to_string(&name).unwrap();
    answer(command, options, HeldSpec { name, text }, &Arc::default()).map_err(|problem| problem.to_string())
}

fn swept(options: &[&str], example: &str) -> ColumnTable {
    ask("sweep", options, example).unwrap().table.unwrap()
}

/// What stands in a row and column: a number or a text, or nothing.
fn cell(table: &ColumnTable, name: &str, row: usize) -> Value {
    let column = table.columns.iter().position(|(known, _)| known == name).unwrap_or_else(|| panic!("{name}"));
    let column = &table.results.columns[column];
    match &column.values {
        _ if !column.has_value(row) => Value::Null,
        ResultValues::Numbers(numbers) => numbers[row].into(),
        ResultValues::Texts { .. } => String::from_utf8_lossy(column.text(row).unwrap()).into(),
        values => panic!("{values:?}"),
    }
}

/// Of an example and command: what is swept, and where results stand in the command's own answer.
type Case = (&'static str, &'static str, &'static [&'static str], &'static [(&'static str, &'static str)]);

#[test]
fn a_row_is_what_the_command_says_of_the_design() {
    const CASES: [Case; 5] = [
        // without a verdict
        (
            "mesh",
            "mesh",
            &["pair.normal_pressure_angle=19.9..20.3:0.2"],
            &[
                ("peak_to_peak_mm", "/summary/peak_to_peak_mm"),
                ("max_mm", "/summary/max_mm"),
                ("largest_rate", "/summary/largest_rate"),
                ("contact_ratio", "/geometry/contact_ratio"),
            ],
        ),
        (
            "eval",
            "mesh-errors",
            &["pinion.teeth=7,8", "errors.rack_pitch=5..15:5um"],
            &[
                ("delta_cd_rack_pitch_mm", "/contributions/1/delta_cd_mm"),
                ("range_lower_mm", "/combined/range_mm/lower"),
                ("reached_upper_mm", "/reached_mm/upper"),
                ("verdict", "/verdict"),
            ],
        ),
        (
            "mesh",
            "function",
            &["yoke.preload=300,800 N", "pair.normal_pressure_angle=20..20.5:0.5"],
            &[
                ("peak_to_peak_mm", "/summary/peak_to_peak_mm"),
                ("setting_to_mm", "/yoke/setting/to_mm"),
                ("torque_rising_fluctuation_n_m", "/yoke/torque_n_m/rising/fluctuation"),
                ("lift_off_force_n", "/yoke/lift_off_force_n"),
                ("verdict", "/verdict"),
            ],
        ),
        (
            "budget",
            "budget",
            &["rack.face_width=15..20:5"],
            &[("tolerance_rack_pitch_mm", "/tolerances/1/tolerance_mm")],
        ),
        (
            "eval",
            "uncertain",
            &["errors.rack_pitch={ value = \"12 um\", u = \"1 um\" },{ value = \"9 um\", u = \"2 um\" }"],
            &[("range_upper_mm", "/combined/range_mm/upper"), ("limits/center_distance/verdict", "/limits/0/verdict")],
        ),
    ];
    for (command, example, over, places) in CASES {
        let names: Vec<_> = places.iter().map(|(name, _)| *name).collect();
        let over_options = over.iter().flat_map(|over| ["--over", over]);
        let columns = names.join(",");
        let options: Vec<_> = over_options.chain(["--of", command, "--columns", &columns]).collect();
        let table = swept(&options, example);
        let rows: usize = table.results.rows;
        assert!(rows >= 2, "{example}");
        for row in 0..rows {
            let settings: Vec<_> = over
                .iter()
                .enumerate()
                .map(|(index, over)| {
                    let key = over.split('=').next().unwrap();
                    let (name, _) = &table.columns[index];
                    let unit = name.strip_prefix(key).unwrap().trim_start_matches('_');
                    match cell(&table, name, row) {
                        Value::String(text) => format!("{key}={text}"),
                        number => format!("{key}={} {unit}", number.as_f64().unwrap()).trim_end().to_owned(),
                    }
                })
                .collect();
            let options: Vec<_> = settings.iter().flat_map(|setting| ["--set", setting]).collect();
            let own = ask(command, &options, example).unwrap().json;
            for (name, place) in places {
                let expected = own.pointer(place).cloned().unwrap_or_default();
                assert_eq!(cell(&table, name, row), expected, "{example} {name} {settings:?}");
                assert_ne!(expected, Value::Null, "{example} {name}");
            }
        }
    }
}

#[test]
fn what_is_impossible_is_a_row_with_its_reason_and_no_value() {
    let table =
        swept(&["--over", "pair.normal_pressure_angle=-3,20,nonsense", "--columns", "range_upper_mm,reason"], "paper");
    let reasons = [0, 1, 2].map(|row| cell(&table, "reason", row));
    assert!(reasons[0].as_str().unwrap().contains("must be above 0°"), "{reasons:?}");
    assert!(reasons[2].as_str().unwrap().contains("not an angle"), "{reasons:?}");
    assert_eq!([0, 1, 2].map(|row| cell(&table, "range_upper_mm", row).is_null()), [true, false, true]);
    let none = ask("sweep", &["--over", "pair.normal_pressure_angle=-3,-2"], "paper").unwrap();
    assert_eq!((none.status, none.json["impossible"].as_u64()), (2, Some(2)));
    for options in [
        &["--over", "pair.presure=1,2"][..],
        &["--over", "pair.normal_pressure_angle=18..20"],
        &["--over", "rack.face_width=18,20", "--columns", "no_such_mm"],
        &["--over", "rack.face_width=18,20", "--", "--set", "rack.face_width=3"],
        &["--over", "rack.face_width=18,20", "--", "--format", "json"],
        &["--over", "rack.face_width=18,20", "--over", "rack.face_width=18,20"],
        &["--over", "rack.face_width=18,20", "--until", "range_upper_mm=0.05"],
    ] {
        assert!(ask("sweep", options, "paper").is_err(), "{options:?}");
    }
    for (example, options, shown) in [
        (
            "paper",
            &["--over", "errors.nonsense=1,2"][..],
            "1 | --over errors.nonsense=1,2\n  |               ^^^^^^^^ unknown key",
        ),
        (
            "paper",
            &["--set", "rack.face_width=3", "--over", "rack.face_width=18,20"],
            "1 | --over rack.face_width=18,20\n",
        ),
        (
            "mesh-errors",
            &["--over", "errors.rack_pitch.value=10,20um"],
            "that the spec has as a table, such as rack_pitch = {",
        ),
    ] {
        let spec = format!("examples/{example}.toml");
        let said = run(&[&["sweep", &spec], options].concat(), "");
        assert!(said.stderr.contains(shown) && !said.stderr.contains("--set KEY"), "{}", said.stderr);
    }
}

#[test]
fn the_value_of_a_key_is_found_at_which_a_result_is_reached() {
    let until = |value: f64| format!("range_upper_mm={value}");
    let options =
        |until: &str| ask("sweep", &["--over", "errors.rack_pitch=1..60um", "--until", until], "mesh-errors").unwrap();
    let found = options(&until(0.08));
    let table = found.table.unwrap();
    assert_eq!((found.status, table.results.rows), (0, 1));
    let upper = cell(&table, "range_upper_mm", 0).as_f64().unwrap();
    assert!((upper - 0.08).abs() < 1e-9, "{upper}");
    let never = options(&until(9.0));
    assert_eq!((never.status, never.table.unwrap().results.rows), (1, 0));
    assert!(never.warnings[0].message.contains("does not come to 9"));
    // most designs are refused, and it says why
    let over = "errors.rack_pitch=0..30";
    let refused = ask("sweep", &["--over", over, "--until", &until(9.0)], "mesh-errors").unwrap();
    let help = refused.warnings[0].help.clone().unwrap();
    assert!(
        help.contains(" of 17 designs have no answer; the first: ") && help.contains("is too large for a deviation"),
        "{help}"
    );
}

#[test]
fn a_picture_of_until_has_every_design_that_was_tried() {
    let folder = Folder::new("sweep-until");
    let path = folder.path("until.svg");
    let sweep =
        |options: &[&str]| run(&[&["sweep", "examples/mesh-errors.toml", "--plot", &path], options].concat(), "");
    let ended = sweep(&["--over", "errors.rack_pitch=1..60um", "--until", "range_upper_mm=0.08"]);
    assert_eq!((ended.code, ended.stdout.lines().count()), (Some(0), 2), "{}", ended.stderr);
    let drawn = std::fs::read_to_string(&path).unwrap();
    let lines = drawn.split("<path d=\"M").map(|line| line.split('"').next().unwrap().matches('L').count());
    assert_eq!(lines.max(), Some(16), "{drawn}");
    // a design alone is refused before it is solved, and the picture stays
    let ended = sweep(&["--over", "errors.rack_pitch=20um"]);
    assert_eq!((ended.code, &*ended.stdout), (Some(2), ""));
    assert!(ended.stderr.contains("of two designs or more"), "{}", ended.stderr);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), drawn);
}
