//! A yoke on parts of tables: each is judged as `mesh` and `eval` judge it alone, and one plug serves as many as can be.

use std::fmt::Write as _;

use serde_json::Value;

use crate::process::{Ended, Folder, run};

const PAIR: &str = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 19.9\n[rack]\nface_width = 19.7\naddendum = 1.7\n\
    travel = { from = 20, to = 60 }\n[pinion]\nteeth = 8\nhelix_angle = 21\nprofile_shift = 0.3\nface_width = 23.5\n\
    tip_diameter = 19.738\n[yoke]\npreload = \"500 N\"\nrate = \"100 N/mm\"\nset_at = 30\nthread_pitch = \"1.5 mm\"\n\
    friction = { yoke = 0.1, teeth = 0.08 }\n";
const LIMITS: &str = "[limits]\nyoke_play = { lower = \"0.01 mm\", upper = \"0.10 mm\" }\n\
    torque_fluctuation = { upper = \"0.5 N m\" }\nlift_off_force = { lower = \"1 kN\" }\n";

/// Spaces −2 to 15 of racks whose deviations grow, µm.
fn racks(count: i64) -> String {
    let mut table = "part_id,space,over_pin_deviation [um],position_deviation [um]\n".to_owned();
    for rack in 0..count {
        for space in -2..16_i64 {
            let wild = |salt: i64| (space * space * 7 + space * 13 + rack * salt).rem_euclid(21) - 10;
            let _ = writeln!(table, "R{rack},{space},{},{}", rack * wild(5) / 2, rack * wild(11) / 2);
        }
    }
    table
}

/// The rows of one rack, without its name.
fn rows_of(table: &str, name: &str) -> String {
    let rows =
        table.lines().filter_map(|line| line.split_once(',').filter(|(part, _)| [name, "part_id"].contains(part)));
    rows.flat_map(|(_, row)| [row, "\n"]).collect()
}

fn write(folder: &Folder, name: &str, text: &str) -> String {
    let path = folder.path(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn batch(folder: &Folder, spec: &str, table: &str, more: &[&str]) -> Ended {
    let (spec, table) = (write(folder, "spec.toml", spec), write(folder, "parts.csv", table));
    run(&[&["batch", &spec, &table], more].concat(), "")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The figures of a row and those of `mesh` or `eval`, by name.
fn same_figures(row: &Value, yoke: &Value) {
    let torque = |direction: &str, of: &str| &yoke["torque_n_m"][direction][of];
    let mut pairs = vec![
        ("variation_mm".to_owned(), &yoke["variation_mm"]),
        ("smallest_play_mm".to_owned(), &yoke["smallest_play_mm"]),
        ("largest_play_mm".to_owned(), &yoke["largest_play_mm"]),
        ("lift_off_force_n".to_owned(), &yoke["lift_off_force_n"]),
    ];
    for end in ["from_mm", "to_mm", "from_deg", "to_deg"] {
        pairs.push((format!("setting_{end}"), &yoke["setting"][end]));
    }
    for direction in ["rising", "falling"] {
        for of in ["mean", "smallest", "largest", "fluctuation"] {
            pairs.push((format!("torque_{direction}_{of}_n_m"), torque(direction, of)));
        }
    }
    for (name, expected) in pairs {
        match (row[&name].as_f64(), expected.as_f64()) {
            (Some(found), Some(expected)) => assert!((found - expected).abs() < 1e-9, "{name}: {found} {expected}"),
            (found, expected) => assert_eq!(found, expected, "{name}"),
        }
    }
    for limit in yoke["limits"].as_array().unwrap() {
        let name = format!("{}_verdict", limit["on"].as_str().unwrap());
        assert_eq!(row[&name], limit["verdict"], "{name}");
    }
}

#[test]
fn each_rack_is_what_the_mesh_says_of_it_and_one_plug_suits_the_most() {
    let folder = Folder::new("function-racks");
    let (spec, table) = (format!("{PAIR}{LIMITS}"), racks(7));
    let rows = batch(&folder, &spec, &table, &["--teeth", "-f", "json", "--decimals", "full"]);
    assert_eq!(rows.code, Some(1), "{}", rows.stderr);
    let rows = rows.json();
    let rows = rows.as_array().unwrap();
    for row in rows {
        let name = row["part_id"].as_str().unwrap();
        let beside = spec.replace("[rack]\n", "[rack]\nmeasured = \"one.csv\"\n");
        let rows = rows_of(&table, name);
        write(&folder, "one.csv", &rows);
        let alone = run(&["mesh", &write(&folder, "one.toml", &beside), "-f", "json"], "").json();
        same_figures(row, &alone["yoke"]);
        assert_eq!(row["verdict"], alone["verdict"], "{name}");
        let pasted = run(&["paste", &folder.path("spec.toml"), "-f", "json"], &rows).json();
        same_figures(row, &pasted["mesh"]["yoke"]);
        assert_eq!(pasted["mesh"]["yoke"]["judged_by"], "mesh");
    }
    let settings: Vec<_> =
        rows.iter().filter_map(|row| Some((row["setting_from_mm"].as_f64()?, number(&row["setting_to_mm"])))).collect();
    let none = rows.iter().filter(|row| row["yoke_play_verdict"] == "fail").count();
    assert!(none > 0 && settings.len() > 2, "{none} {}", settings.len());
    let suits = |play: f64| settings.iter().filter(|(from, to)| *from <= play && play <= *to).count();
    let most = settings.iter().map(|(from, _)| suits(*from)).max().unwrap();
    let summary = batch(&folder, &spec, &table, &["--teeth", "--summary", "-f", "json"]).json();
    let (lot, shared) = (&summary["yoke"], &summary["yoke"]["shared_setting"]);
    assert_eq!((&lot["parts"], &lot["without_setting"]), (&rows.len().into(), &none.into()));
    assert_eq!((&shared["parts"], number(&shared["share"])), (&most.into(), most as f64 / rows.len() as f64));
    for end in ["from_mm", "recommended_mm", "to_mm"] {
        assert_eq!(suits(number(&shared[end])), most, "{end}");
    }
    assert!((number(&shared["recommended_deg"]) - 240.0 * number(&shared["recommended_mm"])).abs() < 1e-9);
    let page = folder.path("lot.html");
    let report = run(&["report", &folder.path("spec.toml"), &folder.path("parts.csv"), "--teeth", "-o", &page], "");
    assert_eq!(report.code, Some(1), "{}", report.stderr);
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("position that suits the most parts") && page.contains("yoke of part"));
}

/// A limit of which too little is known is open in each row, and no run passes.
#[test]
fn what_is_not_known_of_a_part_leaves_its_yoke_open() {
    let folder = Folder::new("function-open");
    let table = racks(1);
    let open = |spec: &str, more: &[&str], why: &str| {
        let rows = batch(&folder, spec, &table, &[&["--teeth", "-f", "json"], more].concat());
        assert_eq!(rows.code, Some(2), "{why}: {} {}", rows.stdout, rows.stderr);
        let row = &rows.json()[0];
        assert!(row["verdict"].is_null() && row["reason"].as_str().unwrap().contains(why), "{why}: {row}");
        let pasted = run(&[&["paste", &folder.path("spec.toml"), "-f", "json"], more].concat(), &rows_of(&table, "R0"));
        assert_eq!(pasted.code, Some(2), "{why}: {} {}", pasted.stdout, pasted.stderr);
        let yoke = &pasted.json()["mesh"]["yoke"];
        let mut limits = yoke["limits"].as_array().unwrap().iter();
        assert!(
            limits.any(|limit| limit["reason"].as_str().is_some_and(|reason| reason.contains(why))),
            "{why}: {yoke}"
        );
    };
    let spec = format!("{PAIR}{LIMITS}");
    let judged = batch(&folder, &spec, &table, &["--teeth"]);
    assert!(judged.code == Some(0) && judged.stderr.contains("suits 1 of 1 part,"), "{}", judged.stderr);
    open(&spec.replace("to = 60", "to = 200"), &[], "were not measured");
    open(&spec.replace("set_at = 30", "set_at = 300"), &[], "were not measured");
    open(&spec.replace("travel = { from = 20, to = 60 }\n", ""), &[], "rack.travel");
    open(&spec.replace("rate = \"100 N/mm\"\n", ""), &[], "yoke.rate");
    open(&format!("{spec}[decision]\nrule = \"guard=0.001\"\n"), &[], "uncertainty");
    // errors of the other part: on all teeth they are known, elsewhere the bound proves what it can
    let with = |error: &str| format!("{spec}[errors]\n{error}\n");
    open(&with("pinion_radial = \"5 um\""), &[], "not judged without pinion_radial");
    open(
        &with("pinion_pitch = { value = \"9 um\", every_part = true }"),
        &[],
        "fluctuation of the pinion torque: not proven",
    );
    let all = with("pinion_radial = { value = \"5 um\", every_part = true, extent = \"all\" }");
    let judged = batch(&folder, &all, &table, &["--teeth"]);
    assert_eq!(judged.code, Some(0), "{} {}", judged.stdout, judged.stderr);
}

/// Values of whole parts: sizes on all teeth are judged by the mesh and drop out of the play; a step is left to place.
#[test]
fn whole_parts_are_judged_as_eval_judges_them() {
    let folder = Folder::new("function-whole");
    let spec =
        |errors: &str| format!("{}[errors]\n{errors}\n{LIMITS}", PAIR.replace("set_at = 30", "set_at = \"tightest\""));
    let sizes = |over: &str, radial: &str| {
        format!(
            "rack_over_roller = {{ value = \"{over}\", extent = \"all\" }}\npinion_radial = {{ value = \"{radial}\", extent = \"all\" }}"
        )
    };
    let table = "part_id,rack_over_roller [um],pinion_radial [um]\nA,13,5\nB,-40,100\n";
    let rows = batch(&folder, &spec(&sizes("0 um", "0 um")), table, &["-f", "json", "--decimals", "full"]);
    assert_eq!(rows.code, Some(0), "{} {}", rows.stdout, rows.stderr);
    let rows = rows.json();
    for (row, (over, radial)) in rows.as_array().unwrap().iter().zip([("13 um", "5 um"), ("-40 um", "100 um")]) {
        let alone = run(&["eval", &write(&folder, "one.toml", &spec(&sizes(over, radial))), "-f", "json"], "").json();
        same_figures(row, &alone["yoke"]);
        assert_eq!(alone["yoke"]["judged_by"], "mesh");
        assert!(number(&row["variation_mm"]) < 1e-11, "{row}");
    }
    let pasted = run(&["paste", &folder.path("spec.toml"), "-f", "json"], table).json();
    for (part, row) in pasted["parts"].as_array().unwrap().iter().zip(rows.as_array().unwrap()) {
        same_figures(row, &part["yoke"]);
    }
    let steps = "rack_over_roller = { value = \"0 um\", extent = \"all\" }\nrack_pitch = \"0 um\"";
    let table = "part_id,rack_over_roller [um],rack_pitch [um]\nA,13,5\nB,13,200\n";
    let rows = batch(&folder, &spec(steps), table, &["-f", "json"]);
    assert_eq!(rows.code, Some(2), "{}", rows.stderr);
    let rows = rows.json();
    let verdicts = |row: usize| {
        ["yoke_play", "torque_fluctuation", "lift_off_force"]
            .map(|on| rows[row][format!("{on}_verdict")].as_str().map(str::to_owned))
    };
    let pass = || Some("pass".to_owned());
    assert_eq!((verdicts(0), verdicts(1)), ([pass(), None, pass()], [None, None, pass()]));
    assert!(rows[0]["verdict"].is_null() && rows[1]["verdict"].is_null());
    let placed = steps.replacen("0 um", "13 um", 1).replacen("rack_pitch = \"0 um", "rack_pitch = \"5 um", 1);
    let alone = run(&["eval", &write(&folder, "one.toml", &spec(&placed)), "-f", "json"], "").json();
    let pasted = run(&["paste", &folder.path("spec.toml"), "-f", "json"], table).json();
    for yoke in [&alone["yoke"], &pasted["parts"][0]["yoke"]] {
        assert_eq!(yoke["judged_by"], "bound");
        let same = |column: &str, value: &Value| {
            assert!((number(&rows[0][column]) - number(value)).abs() < 1e-6, "{column}: {} {value}", rows[0][column]);
        };
        same("variation_at_most_mm", &yoke["variation_at_most_mm"]);
        same("lift_off_force_at_least_n", &yoke["lift_off_force_n"]);
        for end in ["from_mm", "to_mm", "from_deg", "to_deg"] {
            same(&format!("safe_setting_{end}"), &yoke["safe_setting"][end]);
        }
    }
    assert!(rows[1]["safe_setting_from_mm"].is_null(), "{}", rows[1]);
}

/// Racks drawn at random: the best plug, shares and distributions are those of their list, ranges merge to one run, and each
/// limit is judged of every rack.
#[test]
fn random_racks_say_what_their_yoke_does() {
    let folder = Folder::new("random-yokes");
    let scatter = "[scatter]\nrack_over_roller = \"30 um\"\n";
    let spec = write(&folder, "spec.toml", &format!("{PAIR}{LIMITS}{scatter}"));
    let racks = |more: &[&str]| run(&[&["monte-carlo", &spec], more].concat(), "");
    let one = racks(&["--racks", "40", "-f", "json"]);
    assert_eq!(one.code, Some(1), "{}", one.stderr);
    let files = [("0", "13"), ("13", "27")].map(|(first, count)| {
        let file = folder.path(&format!("{first}.json"));
        racks(&["--first-rack", first, "--racks", count, "--study", &file, "-j", "1"]);
        file
    });
    let merged = racks(&["--merge", &files[1], &files[0], "-f", "json"]);
    assert_eq!((merged.code, &merged.stdout), (one.code, &one.stdout), "{}", merged.stderr);
    let other = racks(&["--merge", &files[0], "--set", "yoke.rate=101 N/mm"]);
    assert!(other.code == Some(2) && other.stderr.contains("fingerprint"), "{}", other.stderr);
    let json = one.json();
    let yoke = &json["yoke"];

    let csv = racks(&["--racks", "40", "-f", "csv"]).stdout;
    let rows: Vec<Vec<Option<f64>>> =
        csv.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().ok()).collect()).collect();
    let column = |name: &str| csv.lines().next().unwrap().split(',').position(|title| title == name).expect(name);
    let of = |name: &str| rows.iter().map(|row| row[column(name)]).collect::<Vec<_>>();
    let (from, to) = (of("setting_from_mm"), of("setting_to_mm"));
    let without = from.iter().filter(|from| from.is_none()).count();
    assert_eq!((&yoke["racks"], &yoke["without_setting"]["racks"]), (&40.into(), &without.into()));
    assert!(without > 0 && without < 30, "{without}");
    // a setting is there where the variation fits the window
    for (variation, from) in of("peak_to_peak_mm").iter().zip(&from) {
        assert_eq!(from.is_some(), variation.unwrap() <= 0.09);
    }
    let suited = |at: f64| {
        let suits =
            |(from, to): (&Option<f64>, &Option<f64>)| from.zip(*to).is_some_and(|(from, to)| from <= at && at <= to);
        from.iter().zip(&to).filter(|ends| suits(*ends)).count()
    };
    let most = from.iter().flatten().map(|from| suited(*from)).max().unwrap();
    let shared = &yoke["shared_setting"];
    assert_eq!(shared["suits"]["racks"], most);
    for end in ["from_mm", "to_mm", "recommended_mm"] {
        assert_eq!(suited(number(&shared[end])), most, "{end}");
    }
    assert!((number(&shared["from_deg"]) - 240.0 * number(&shared["from_mm"])).abs() < 1e-9);
    let [share, lower, upper] = ["share", "lower", "upper"].map(|name| number(&shared["suits"][name]));
    assert!((share - most as f64 / 40.0).abs() < 1e-15 && lower < share && share <= upper, "{lower} {share} {upper}");
    // so few racks do not tell where the best one is
    assert!(shared["confidence_interval"].is_null());
    for (name, values) in
        [("torque_fluctuation", of("torque_fluctuation_n_m")), ("lift_off_force", of("lift_off_force_n"))]
    {
        let unit = if name == "lift_off_force" { "n" } else { "n_m" };
        let mean = values.iter().flatten().sum::<f64>() / 40.0;
        assert!((number(&yoke[name][format!("mean_{unit}")]) / mean - 1.0).abs() < 1e-9, "{name}");
        let mut sorted: Vec<_> = values.into_iter().flatten().collect();
        sorted.sort_by(f64::total_cmp);
        let median = &yoke[name]["quantiles"][3];
        assert!((number(&median[format!("value_{unit}")]) / sorted[19] - 1.0).abs() < 1e-9, "{name} {median}");
    }
    let kept = |on: &str| {
        let limits = yoke["limits"].as_array().unwrap();
        limits.iter().find(|limit| limit["on"] == on).expect(on)["inside_limit"]["racks"].as_u64().unwrap()
    };
    assert_eq!(kept("yoke_play"), 40 - without as u64);
    assert_eq!(
        kept("torque_fluctuation"),
        of("torque_fluctuation_n_m").iter().flatten().filter(|n_m| **n_m <= 0.5).count() as u64
    );
    assert_eq!(
        kept("lift_off_force"),
        of("lift_off_force_n").iter().flatten().filter(|n| **n >= 1000.0).count() as u64
    );

    // a limit that lacks a key is open, and names it
    let open = racks(&["--racks", "3", "-f", "json", "--set", "limits.pinion_torque={ upper = \"9 N m\" }"]);
    assert!(open.json()["notes"].to_string().contains("yoke.bearing_torque"), "{}", open.stdout);
    // many racks tell where the best setting is
    let many = racks(&["--racks", "600", "-f", "json", "--to", "26"]).json();
    let shared = &many["yoke"]["shared_setting"];
    let interval = &shared["confidence_interval"];
    assert!(number(&interval["from_mm"]) <= number(&shared["from_mm"]), "{shared}");
    assert!(number(&interval["to_mm"]) >= number(&shared["to_mm"]), "{shared}");
}

/// Each random rack is solved by its curve, also about a stroke to set at beyond the travel; without a yoke the same racks come.
#[test]
fn random_racks_are_the_same_racks_with_a_yoke() {
    let scatter = "[scatter]\nrack_pitch = \"5 um\"\npinion_runout = \"8 um\"\n";
    let bare = PAIR.split("[yoke]").next().unwrap();
    let listed = |spec: &str| {
        let ended = run(&["monte-carlo", "-", "--racks", "6", "-f", "csv"], spec);
        let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        ended.stdout.lines().skip(1).map(row).collect::<Vec<Vec<f64>>>()
    };
    let (with, without) = (listed(&format!("{PAIR}{scatter}")), listed(&format!("{bare}{scatter}")));
    assert_eq!((with.len(), without.len()), (6, 6));
    for (with, without) in with.iter().zip(&without) {
        for (found, expected) in with[1..5].iter().zip(&without[1..5]) {
            assert!((found - expected).abs() < 4e-4, "{with:?} {without:?}");
        }
        // equal steps meet no more than what the curve has
        assert!(with[2] >= without[2] - 1e-9, "{with:?} {without:?}");
    }
    let far = run(
        &["monte-carlo", "-", "--racks", "6"],
        &format!("{}{LIMITS}{scatter}", PAIR.replace("set_at = 30", "set_at = -150")),
    );
    assert!(far.stdout.contains("setting that suits the most racks"), "{} {}", far.stdout, far.stderr);
}
