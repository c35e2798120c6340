//! Teeth that are known one by one: who judges them, what counts beside them, and their uncertainty.

mod grades;

use std::fmt::Write as _;

use crate::process::{Ended, Folder, run};

/// 1/(2 tan 19.9°)
const GAIN: f64 = 1.381_234_75;

const PAIR: &str = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 19.9\n[rack]\nface_width = 19.7\naddendum = 1.7\n\
    [pinion]\nteeth = 8\nhelix_angle = 21\nprofile_shift = 0.3\nface_width = 30\ntip_diameter = 19.738\n";
const LIMIT: &str = "[limits]\ncenter_distance = \"±0.03\"\n";

/// Twelve spaces that are all right, but for what a function says of their position, µm.
fn spaces(position: impl Fn(i64) -> i64) -> String {
    let mut table = "space,over_pin_deviation [um],position_deviation [um]\n".to_owned();
    for space in 0..12 {
        let _ = writeln!(table, "{space},0,{}", position(space));
    }
    table
}

fn batch(folder: &Folder, spec: &str, table: &str, more: &[&str]) -> Ended {
    let (spec_path, table_path) = (folder.path("spec.toml"), folder.path("spaces.csv"));
    std::fs::write(&spec_path, spec).unwrap();
    std::fs::write(&table_path, table).unwrap();
    run(&[&["batch", &spec_path, &table_path, "--teeth"], more].concat(), "")
}

fn paste(folder: &Folder, spec: &str, table: &str, more: &[&str]) -> Ended {
    let spec_path = folder.path("spec.toml");
    std::fs::write(&spec_path, spec).unwrap();
    run(&[&["paste", &spec_path], more].concat(), table)
}

/// A pinion that sits 200 µm high under a rack that is all right.
#[test]
fn errors_of_the_other_part_count_or_nothing_passes() {
    let folder = Folder::new("teeth-other-part");
    let with = |error: &str| format!("{PAIR}[errors]\npinion_radial = {error}\n{LIMIT}");
    let (asked, of_every) = (with("\"200 um\""), with("{ value = \"200 um\", every_part = true }"));
    let table = spaces(|_| 0);
    for command in [batch, paste] {
        let open = command(&folder, &asked, &table, &[]);
        assert_eq!(open.code, Some(2), "{} {}", open.stdout, open.stderr);
        assert!(
            format!("{}{}", open.stdout, open.stderr).contains("the spec asks for pinion_radial"),
            "{}",
            open.stderr
        );
        let failed = command(&folder, &of_every, &table, &[]);
        assert_eq!(failed.code, Some(1), "{} {}", failed.stdout, failed.stderr);
        let partial = command(&folder, &asked, &table, &["--partial"]);
        assert_eq!(partial.code, Some(0), "{} {}", partial.stdout, partial.stderr);
        assert!(format!("{}{}", partial.stdout, partial.stderr).contains("judged without pinion_radial"));
    }
}

/// What the spec says of the measured part and its table does not tell is not dropped.
#[test]
fn what_the_table_of_a_part_does_not_tell_is_open() {
    let folder = Folder::new("teeth-not-in-table");
    let said = [
        ("rack_lead", "[errors]\nrack_lead = \"0.5 deg\"\n"),
        ("rack_lead", "[errors]\nrack_lead = { value = \"0.5 deg\", every_part = true }\n"),
        ("rack_lead", "[[rack.deviation]]\nteeth = \"0..=3\"\nlead = \"0.5 deg\"\n"),
    ];
    for command in [batch, paste] {
        for (kind, errors) in said {
            let spec = format!("{PAIR}{errors}{LIMIT}");
            let open = command(&folder, &spec, &spaces(|_| 0), &[]);
            assert_eq!(open.code, Some(2), "{errors}: {} {}", open.stdout, open.stderr);
            let said = format!("{}{}", open.stdout, open.stderr);
            assert!(said.contains(&format!("the spec speaks of {kind} of the rack")), "{said}");
            let partial = command(&folder, &spec, &spaces(|_| 0), &["--partial"]);
            assert_eq!(partial.code, Some(0), "{errors}: {} {}", partial.stdout, partial.stderr);
        }
        let told = format!("{PAIR}[errors]\nrack_pitch = \"500 um\"\n{LIMIT}");
        let passed = command(&folder, &told, &spaces(|_| 0), &[]);
        assert_eq!(passed.code, Some(0), "{} {}", passed.stdout, passed.stderr);
    }
}

/// A cell that is empty in the middle of a table is not taken for a value that is right.
#[test]
fn a_tooth_that_was_not_measured_passes_nowhere() {
    let folder = Folder::new("teeth-hole");
    let without = |table: &str, row: &str, cut: &str| table.replace(row, cut);
    let racks = [without(&spaces(|_| 0), "\n5,0,0\n", "\n5,0,\n"), without(&spaces(|_| 0), "\n5,0,0\n", "\n")];
    let mut whole = "tooth,radial_deviation [um],position_deviation [um]\n".to_owned();
    (0..8).for_each(|tooth| writeln!(whole, "{tooth},0,0").unwrap());
    let pinions = [without(&whole, "\n4,0,0\n", "\n4,0,\n"), without(&whole, "\n4,0,0\n", "\n")];
    let spec = format!("{PAIR}{LIMIT}");
    assert_eq!(paste(&folder, &spec, &whole, &[]).code, Some(0));
    assert_eq!(batch(&folder, &spec, &whole, &[]).code, Some(0));
    for (part, table) in racks.iter().map(|table| ("rack", table)).chain(pinions.iter().map(|table| ("pinion", table)))
    {
        passes_nowhere(&folder, part, table);
    }
}

/// A table of a part by every command that judges teeth: none says a verdict.
fn passes_nowhere(folder: &Folder, part: &str, table: &str) {
    let spec = format!("{PAIR}{LIMIT}");
    let is_open = |command: &str, ended: &Ended| {
        assert_eq!(ended.code, Some(2), "{command} {table}: {} {}", ended.stdout, ended.stderr);
    };
    is_open("batch", &batch(folder, &spec, table, &[]));
    is_open("paste", &paste(folder, &spec, table, &[]));
    is_open("report", &run(&["report", &folder.path("spec.toml"), &folder.path("spaces.csv"), "--teeth"], ""));
    std::fs::write(folder.path("measured.csv"), table).unwrap();
    let beside = spec.replace(&format!("[{part}]\n"), &format!("[{part}]\nmeasured = \"measured.csv\"\n"));
    std::fs::write(folder.path("beside.toml"), beside).unwrap();
    for command in ["eval", "mesh"] {
        is_open(command, &run(&[command, &folder.path("beside.toml")], ""));
    }
}

/// Spaces 0 to 4 that are all right, and rows of others.
fn spaces_and(others: &[&str]) -> String {
    let table: Vec<_> = spaces(|_| 0).lines().take(6).map(str::to_owned).collect();
    format!("{}\n{}\n", table.join("\n"), others.join("\n"))
}

/// Values behind a gap count, however few they are.
#[test]
fn a_gap_leaves_no_verdict_however_short_the_runs_are() {
    let folder = Folder::new("teeth-gap");
    for others in [&["6,500,500", "7,500,500"][..], &["6,500,500"], &["-3,500,500"], &["6,0,0", "7,0,0", "8,,500"]] {
        passes_nowhere(&folder, "rack", &spaces_and(others));
    }
    // a value in one column only is no measured space at the end, either; a row without any value is none at all
    passes_nowhere(&folder, "rack", &spaces_and(&["5,n.a.,500"]));
    let passed = batch(&folder, &format!("{PAIR}{LIMIT}"), &spaces_and(&["5,,", "6,n.a.,n.a."]), &[]);
    assert_eq!(passed.code, Some(0), "{} {}", passed.stdout, passed.stderr);
}

/// A quantity that nobody measured is not zero.
#[test]
fn a_column_without_a_value_leaves_no_verdict() {
    let folder = Folder::new("teeth-no-value");
    let rack = spaces(|_| 0);
    passes_nowhere(&folder, "rack", &rack.replace(",0,", ",n.a.,"));
    passes_nowhere(&folder, "rack", &rack.replace(",0\n", ",\n"));
    for (radial, position) in [("n.a.", "0"), ("0", "")] {
        let mut pinion = "tooth,radial_deviation [um],position_deviation [um]\n".to_owned();
        (0..8).for_each(|tooth| writeln!(pinion, "{tooth},{radial},{position}").unwrap());
        passes_nowhere(&folder, "pinion", &pinion);
    }
    let rows = |part: &str, over_pin: &str| -> String {
        (0..12).map(|space| format!("{part},{space},{over_pin},0\n")).collect::<Vec<_>>().concat()
    };
    let lot = format!(
        "part_id,space,over_pin_deviation [um],position_deviation [um]\n{}{}{}",
        rows("A", "0"),
        rows("B", "-"),
        rows("C", "0")
    );
    let ended = batch(&folder, &format!("{PAIR}{LIMIT}"), &lot, &[]);
    assert_eq!(ended.code, Some(2), "{} {}", ended.stdout, ended.stderr);
    assert!(ended.stderr.contains("2 pass") && ended.stderr.contains("1 rejected"), "{}", ended.stderr);
}

/// A date in the column of numbers costs no time, and its line is named.
#[test]
fn a_number_that_no_space_has_is_refused() {
    let folder = Folder::new("teeth-far");
    let spec = format!("{PAIR}{LIMIT}");
    for far in ["20260401123", "-9223372036854775808", "9223372036854775807"] {
        let ended = batch(&folder, &spec, &spaces_and(&[&format!("{far},0,0")]), &[]);
        assert_eq!(ended.code, Some(2), "{} {}", ended.stdout, ended.stderr);
        assert!(ended.stderr.contains("spaces.csv:7") && ended.stderr.contains(far), "{}", ended.stderr);
        passes_nowhere(&folder, "rack", &spaces_and(&[&format!("{far},0,0")]));
    }
    passes_nowhere(&folder, "rack", &spaces_and(&["90000,0,0"]));
}

/// Rows that are teeth are no parts.
#[test]
fn a_table_that_numbers_teeth_is_none_of_parts() {
    let folder = Folder::new("teeth-no-parts");
    let spec_path = folder.path("spec.toml");
    std::fs::write(&spec_path, format!("{PAIR}{LIMIT}")).unwrap();
    for (heading, told) in [
        ("part_id;Zahn;Teilung Zahnstange [µm]", "position_deviation"),
        ("part_id;Lücke;Teilung Zahnstange [µm]", "position_deviation"),
        ("part_id;Zahn-Nr.;Teilungsabweichung Ritzel [µm]", "left_pitch or right_pitch"),
        ("part_id;Lücke;Rollenmaß Abw. [µm]", ""),
    ] {
        let mut table = format!("{heading}\n");
        (1..=9).for_each(|tooth| writeln!(table, "A;{tooth};3").unwrap());
        let table_path = folder.path("teeth.csv");
        std::fs::write(&table_path, table).unwrap();
        let ended = run(&["batch", &spec_path, &table_path], "");
        assert_eq!(ended.code, Some(2), "{heading}: {} {}", ended.stdout, ended.stderr);
        assert!(ended.stdout.is_empty() && ended.stderr.contains("--teeth"), "{heading}: {}", ended.stderr);
        let with_teeth = run(&["batch", &spec_path, &table_path, "--teeth"], "");
        let code = if told.is_empty() { 0 } else { 2 };
        assert_eq!(with_teeth.code, Some(code), "{heading}: {} {}", with_teeth.stdout, with_teeth.stderr);
        assert!(with_teeth.stderr.contains(told), "{heading}: {}", with_teeth.stderr);
    }
}

/// Two columns of one size, and one that nobody owns, end the run.
#[test]
fn what_stands_beside_a_value_of_a_space_needs_an_owner() {
    let folder = Folder::new("teeth-beside");
    let spec = format!("{PAIR}{LIMIT}");
    for (heading, row, told) in [
        ("over_pin [mm],over_pin_deviation [um]", "25,300", "`rack.pin` is missing"),
        ("over_pin [mm],nominal [mm]", "25,24.7", "column `nominal [mm]`"),
        ("over_pin_deviation [um],M [mm]", "0,25", "column `M [mm]`"),
    ] {
        let mut table = format!("space,{heading}\n");
        (0..9).for_each(|space| writeln!(table, "{space},{row}").unwrap());
        let ended = batch(&folder, &spec, &table, &[]);
        assert_eq!(ended.code, Some(2), "{heading}: {} {}", ended.stdout, ended.stderr);
        assert!(ended.stderr.contains(told), "{heading}: {}", ended.stderr);
    }
}

/// The strokes between two halves of a part are judged, or nothing of it passes.
#[test]
fn a_part_stands_in_one_table() {
    let folder = Folder::new("teeth-two-tables");
    let (spec, first, second) = (folder.path("spec.toml"), folder.path("s1.csv"), folder.path("s2.csv"));
    std::fs::write(&spec, format!("{PAIR}{LIMIT}")).unwrap();
    let half = |part: &str, from: i64, position: i64| {
        let header = "part_id,space,over_pin_deviation [um],position_deviation [um]\n";
        (from..from + 5).fold(header.to_owned(), |table, space| format!("{table}{part},{space},0,{position}\n"))
    };
    std::fs::write(&first, half("A", 0, 0)).unwrap();
    std::fs::write(&second, half("A", 5, 60)).unwrap();
    for command in [&["batch", &spec, &first, &second, "--teeth"][..], &["report", &spec, &first, &second, "--teeth"]] {
        let ended = run(command, "");
        assert_eq!(ended.code, Some(2), "{} {}", ended.stdout, ended.stderr);
        assert!(ended.stderr.contains("s2.csv has rows of this part, too"), "{}", ended.stderr);
        assert!(!ended.stdout.contains(",pass"), "{}", ended.stdout);
    }
    std::fs::write(&second, half("B", 0, 0)).unwrap();
    assert_eq!(run(&["batch", &spec, &first, &second, "--teeth"], "").code, Some(0));
    // without names, each file is a part of its own
    for path in [&first, &second] {
        std::fs::write(path, spaces(|_| 0)).unwrap();
    }
    let ended = run(&["batch", &spec, &first, &second, "--teeth"], "");
    assert_eq!((ended.code, ended.stdout.matches("pass").count()), (Some(0), 2), "{}", ended.stdout);
}

/// The rows of a part may stand anywhere, so all are kept: those of some ten thousand parts.
#[test]
fn more_teeth_than_are_kept_are_refused() {
    let folder = Folder::new("teeth-many");
    let header = "part_id,space,over_pin_deviation [um]\n".to_owned();
    let table = (0..50_000).fold(header, |table, part| table + &format!("P{part},0,0\n"));
    let ended = batch(&folder, &format!("{PAIR}{LIMIT}"), &table, &[]);
    assert_eq!((ended.code, &*ended.stdout), (Some(2), ""), "{}", ended.stderr);
    assert!(ended.stderr.contains("the rows of teeth up to here take more than 40 MiB"), "{}", ended.stderr);
}

/// X and P are names of parts, and not of columns.
#[test]
fn parts_may_be_called_like_columns() {
    let folder = Folder::new("teeth-names");
    for parts in [&["X"][..], &["P"], &["M"], &["X", "P", "M"], &["A", "X"]] {
        let mut table = "part_id,tooth,radial_deviation [um]\n".to_owned();
        for part in parts {
            (0..8).for_each(|tooth| writeln!(table, "{part},{tooth},1").unwrap());
        }
        let ended = batch(&folder, &format!("{PAIR}{LIMIT}"), &table, &[]);
        assert_eq!(ended.code, Some(0), "{table} {} {}", ended.stdout, ended.stderr);
        assert_eq!(ended.stdout.matches("pass").count(), parts.len(), "{}", ended.stdout);
    }
}

/// A stroke that ends before it begins is no fault of the parts.
#[test]
fn strokes_the_wrong_way_round_are_refused() {
    let folder = Folder::new("teeth-from-to");
    let ended = batch(&folder, &format!("{PAIR}{LIMIT}"), &spaces(|_| 0), &["--from", "10", "--to", "5"]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    assert!(ended.stderr.contains("error[usage]: --from 10 lies beyond --to 5"), "{}", ended.stderr);
}

/// Rejected rows stand as they stood.
#[test]
fn rejected_teeth_keep_their_encoding() {
    let folder = Folder::new("teeth-utf16");
    let (spec, table, rejects) = (folder.path("spec.toml"), folder.path("spaces.csv"), folder.path("rejects.csv"));
    std::fs::write(&spec, format!("{PAIR}{LIMIT}")).unwrap();
    let utf16: Vec<u8> =
        format!("\u{feff}{}", spaces_and(&["7,0,0"])).encode_utf16().flat_map(u16::to_le_bytes).collect();
    std::fs::write(&table, &utf16).unwrap();
    let ended = run(&["batch", &spec, &table, "--teeth", "--rejects", &rejects], "");
    assert_eq!(ended.code, Some(2), "{} {}", ended.stdout, ended.stderr);
    assert_eq!(std::fs::read(&rejects).unwrap(), utf16);
}

/// A limit on one error of the other part is judged, too, and one on what was measured tooth by tooth is open.
#[test]
fn every_limit_counts() {
    let folder = Folder::new("teeth-limits");
    let with = |limit: &str| {
        format!("{PAIR}[errors]\npinion_radial = {{ value = \"20 um\", every_part = true }}\n{LIMIT}{limit}")
    };
    for command in [batch, paste] {
        for (limit, code) in
            [("pinion_radial = \"±0.01\"", 1), ("pinion_radial = \"±0.03\"", 0), ("rack_pitch = \"±0.03\"", 2)]
        {
            let ended = command(&folder, &with(limit), &spaces(|_| 0), &[]);
            assert_eq!(ended.code, Some(code), "{limit}: {} {}", ended.stdout, ended.stderr);
        }
    }
}

/// A step of 40 µm at the tenth space, behind the strokes that are listed.
#[test]
fn strokes_that_are_not_listed_are_judged() {
    let folder = Folder::new("teeth-all-strokes");
    let table = spaces(|space| if space < 9 { 0 } else { 40 });
    let ended = batch(&folder, &format!("{PAIR}{LIMIT}"), &table, &["--to", "20"]);
    assert_eq!(ended.code, Some(1), "{} {}", ended.stdout, ended.stderr);
    let row = ended.stdout.lines().nth(1).unwrap();
    assert!(row.contains("fail"), "{row}");
}

/// Every pitch off by 12 µm: the formula has one step, the mesh as many as are in contact.
#[test]
fn a_pasted_rack_is_judged_by_its_mesh() {
    let folder = Folder::new("teeth-pasted");
    let limit = "[limits]\ncenter_distance = \"±0.02\"\n";
    let table = spaces(|space| -12 * space);
    let ended = paste(&folder, &format!("{PAIR}{limit}"), &table, &[]);
    assert_eq!(ended.code, Some(1), "{} {}", ended.stdout, ended.stderr);
    // without geometry there is no mesh, and without a mesh no verdict
    let bare = format!("[pair]\nnormal_module = 2\nnormal_pressure_angle = 19.9\n{limit}");
    let open = paste(&folder, &bare, &table, &[]);
    assert_eq!(open.code, Some(2), "{} {}", open.stdout, open.stderr);
    assert!(open.stderr.contains("`rack.face_width`"), "{}", open.stderr);
}

/// One step of 20 µm between known teeth, u = 2 µm: u(ΔCD) = u / (2 tan α).
#[test]
fn the_uncertainty_of_known_teeth_goes_through_the_mesh() {
    let spec = |rule: &str| {
        format!(
            "{PAIR}[[rack.deviation]]\nteeth = \"5\"\npitch = \"20 um\"\n[errors]\nrack_pitch = {{ u = \"2 um\" }}\n{LIMIT}{rule}"
        )
    };
    let ended = run(&["eval", "-", "--format", "json"], &spec(""));
    let json = ended.json();
    let results = json["uncertainty"]["results"].as_array().unwrap();
    let upper = results.iter().find(|result| result["of"] == "upper").unwrap_or_else(|| panic!("{results:#?}"));
    let standard = upper["standard_uncertainty_mm"].as_f64().unwrap_or_else(|| panic!("{upper:#}"));
    assert!((standard - 0.002 * GAIN).abs() < 1e-6, "{standard}");
    // 27.6 µm and 1.65 times 2.8 µm are too near to 30 µm, for both commands alike
    let by_rule = spec("[decision]\nrule = \"iso14253\"\n");
    for command in ["eval", "mesh"] {
        let ended = run(&[command, "-"], &by_rule);
        assert_eq!(ended.code, Some(3), "{command}: {} {}", ended.stdout, ended.stderr);
    }
}

/// The same of measured spaces, each with its own uncertainty: a step lies between two of them.
#[test]
fn the_uncertainty_of_measured_spaces_is_that_of_each() {
    let folder = Folder::new("teeth-uncertain");
    let spec = |u: &str| {
        format!("{PAIR}[errors]\nrack_over_roller = {{ u = \"0.1 um\" }}\nrack_pitch = {{ u = \"{u} um\" }}\n{LIMIT}")
    };
    let table = spaces(|space| if space < 6 { 0 } else { -18 });
    for (u, code) in [("0.5", 0), ("3", 3)] {
        let ended = batch(&folder, &spec(u), &table, &["--rule", "iso14253"]);
        assert_eq!(ended.code, Some(code), "{u}: {} {}", ended.stdout, ended.stderr);
    }
    // the table has over-pin values, too, and a rule that needs an uncertainty passes nothing without
    let half = format!("{PAIR}[errors]\nrack_pitch = {{ u = \"0.5 um\" }}\n{LIMIT}");
    for (more, code) in [(&[][..], 2), (&["--partial"][..], 0)] {
        let ended = batch(&folder, &half, &table, &[&["--rule", "iso14253"], more].concat());
        assert_eq!(ended.code, Some(code), "{} {}", ended.stdout, ended.stderr);
        assert!(ended.stderr.contains("rack_over_roller"), "{}", ended.stderr);
    }
    let certain = format!("{PAIR}{LIMIT}");
    let refused = batch(&folder, &certain, &table, &["--rule", "iso14253"]);
    assert_eq!(refused.code, Some(2), "{} {}", refused.stdout, refused.stderr);
}

/// Positions of pins and leads of a pinion are computed as its other values are.
#[test]
fn a_pasted_pinion_has_the_range_of_its_positions_and_leads() {
    let folder = Folder::new("pasted-pinion");
    let table = "tooth,position [um],lead [deg]\n0,0,0.02\n1,2,0\n2,4,0\n3,6,0\n4,8,0\n5,10,0\n6,12,0\n7,14,0\n";
    let ended = paste(&folder, PAIR, table, &["--format", "json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let upper = ended.json()["formula_range_mm"]["upper"].as_f64().unwrap();
    // cos 21°
    let pitch = 0.014 * GAIN * 0.933_580_426;
    assert!(upper > pitch + 0.01 && upper < pitch + 0.02, "{upper}");
    let pair = PAIR.replace("teeth = 8\n", "");
    let refused = paste(&folder, &pair, table, &[]);
    assert_eq!(refused.code, Some(2), "{}", refused.stdout);
}

/// A lead of a rack, a position or lead of a pinion that no part has, or hardly any.
#[test]
fn every_measured_value_is_doubted() {
    let folder = Folder::new("doubted-rows");
    let solved = |part: &str, table: &str| {
        let spec_path = folder.path("mesh.toml");
        std::fs::write(folder.path("table.csv"), table).unwrap();
        std::fs::write(
            &spec_path,
            PAIR.replace(&format!("[{part}]\n"), &format!("[{part}]\nmeasured = \"table.csv\"\n")),
        )
        .unwrap();
        run(&["mesh", &spec_path, "--to", "10"], "")
    };
    let turn = |first: &str| {
        let others: String = (1..8).fold(String::new(), |text, tooth| format!("{text}{tooth},0\n"));
        format!("tooth,position [mm]\n0,{first}\n{others}")
    };
    for (part, table, what) in [
        ("rack", "space,lead [deg]\n0,5\n1,0\n2,0\n", "large for a lead error"),
        ("rack", "space,position_deviation [mm]\n0,0.6\n1,0\n2,0\n", "large for a deviation"),
        ("pinion", &*turn("0.6"), "large for a deviation"),
    ] {
        let doubted = solved(part, table);
        assert!(format!("{}{}", doubted.stdout, doubted.stderr).contains(what), "{}{}", doubted.stdout, doubted.stderr);
    }
    let refused = solved("pinion", &turn("6"));
    assert!(refused.code == Some(2) && refused.stderr.contains("line 2: position deviation"), "{}", refused.stderr);
}
