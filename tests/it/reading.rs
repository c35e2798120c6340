//! Nothing that looks like a measured value vanishes: each of these tables was once read in part and passed, or read in two
//! ways by two commands.

use std::path::PathBuf;
use std::process::Output;

use crate::process::{Folder, with_input as run};

/// examples/batch.toml without its `[table.columns]`.
fn spec(folder: &Folder) -> String {
    let example = std::fs::read_to_string("examples/batch.toml").unwrap();
    let (before, _) = example.split_once("[table.columns]").unwrap();
    folder.file("bn.toml", before.as_bytes())
}

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// The exit status, and what was said.
fn status(arguments: &[&str], input: &[u8]) -> (Option<i32>, String) {
    let output = run(arguments, input);
    (output.status.code(), said(&output))
}

#[test]
fn one_cell_is_one_number_in_every_command() {
    let folder = Folder::new("reading-numbers");
    let spec = folder
        .file("spec.toml", b"[pair]\nnormal_pressure_angle = 45\n[limits]\nrack_pitch = { lower = -10, upper = 10 }\n");
    // 1012 µm / (2 tan 45°)
    let table = "part_id;rack_pitch [um]\nP1;1012\nP2;0,5\n";
    let file = folder.file("lot.csv", table.as_bytes());
    for arguments in [vec!["batch", &spec, &file], vec!["paste", &spec, &file, "--format", "csv"]] {
        let (code, said) = status(&arguments, b"");
        assert_eq!(code, Some(0), "{said}");
        assert!(said.contains("P1,0.506") && said.contains("P2,0.00025"), "{said}");
    }
    // and refused where nothing does, unless the user says which it is
    let file = folder.file("lot.csv", b"part_id;rack_pitch [um]\nP1;1.012\nP2;2.117\n");
    for command in ["batch", "paste"] {
        let (code, said) = status(&[command, &spec, &file], b"");
        assert!(code == Some(2) && said.contains("`1.012`") && said.contains("nothing tells which"), "{said}");
        let (code, said) = status(&[command, &spec, &file, "--decimal", "point"], b"");
        assert_eq!(code, Some(0), "{said}");
    }
    let file = folder.file("lot.csv", b"part_id;rack_pitch [um]\nP1;2_5.01\nP2;2.17\n");
    for command in ["batch", "paste"] {
        let (code, said) = status(&[command, &spec, &file], b"");
        assert!(code == Some(2) && said.contains("2_5.01"), "{said}");
    }
}

#[test]
fn no_parts_are_no_pass() {
    let folder = Folder::new("reading-none");
    let spec = spec(&folder);
    for table in ["part_id,rack_over_roller,pinion_radial\n", ""] {
        for command in ["batch", "paste"] {
            let (code, said) = status(&[command, &spec], table.as_bytes());
            assert_eq!(code, Some(2), "{command} {table:?}: {said}");
        }
    }
}

#[test]
fn outputs_destroy_nothing() {
    let folder = Folder::new("reading-outputs");
    let spec = spec(&folder);
    let table = b"part_id,rack_over_roller,pinion_radial\nP1,25.001,8.501\n";
    let file = folder.file("lot.csv", table);
    for option in ["-o", "--rejects", "--junit"] {
        for target in [&file, &spec] {
            let before = std::fs::read(target).unwrap();
            let (code, said) = status(&["batch", &spec, &file, option, target, "--format", "csv"], b"");
            assert!(code == Some(2) && std::fs::read(target).unwrap() == before, "{option} {target}: {said}");
        }
    }
    let (code, said) = status(&["batch", &spec, &file, "-o", &folder.path("x.pdf")], b"");
    assert!(code == Some(2) && said.contains(".parquet"), "{said}");
    let both = folder.path("both.csv");
    let (code, said) = status(&["batch", &spec, &file, "-o", &both, "--rejects", &both], b"");
    assert_eq!(code, Some(2), "{said}");
    let parquet = folder.path("x.parquet");
    let bad = folder.file("bad.csv", b"part_id,rack_over_roller,pinion_radial,pitch [um]\nP1,25.001,8.501,3\n");
    let (code, _) = status(&["batch", &spec, &bad, "-o", &parquet], b"");
    assert!(code == Some(2) && !PathBuf::from(&parquet).exists());
    let (code, said) = status(&["batch", &spec, &file, "-o", &parquet], b"");
    assert_eq!(code, Some(0), "{said}");
    // a Parquet file is read as one
    let spec = folder.file("read.toml", b"[errors]\nrack_over_roller = { nominal = 25 }\n[table.columns]\nrack_over_roller = { name = \"delta_cd_rack_over_roller_mm\", kind = \"deviation\" }\n[limits]\ncenter_distance = { lower = -1, upper = 1 }\n");
    let (code, said) = status(
        &[
            "batch",
            &spec,
            &parquet,
            "--ignore",
            "margin_mm",
            "--ignore",
            "r*",
            "--ignore",
            "worst_case_*",
            "--ignore",
            "delta_cd_p*",
            "--ignore",
            "verdict",
        ],
        b"",
    );
    assert!(said.contains("Parquet"), "{code:?} {said}");
}

#[test]
fn what_the_spec_asks_for_and_the_table_lacks_leaves_the_sum_open() {
    let folder = Folder::new("reading-lacking");
    let text = "[errors]\nrack_over_roller = { nominal = 25 }\npinion_radial = \"4 um\"\n[limits]\ncenter_distance = { lower = -0.1, upper = 0.1 }\n";
    let spec = folder.file("spec.toml", text.as_bytes());
    let table = b"part_id,rack_over_roller\nP1,25.001\n";
    for command in ["batch", "paste"] {
        let (code, said) = status(&[command, &spec], table);
        assert!(code == Some(2) && said.contains("pinion_radial"), "{said}");
        let (code, said) = status(&[command, &spec, "--partial"], table);
        assert!(code == Some(0) && said.contains("--partial"), "{said}");
        let two = b"part_id,rack_over_roller\nP1,25.001\nP2,25.002\n";
        for table in [&table[..], two] {
            let (_, said) = status(&[command, &spec, "--partial", "--format", "csv"], table);
            assert!(said.contains(",judged_without\n") && said.contains(",pinion_radial\n"), "{said}");
            let file = folder.path(&format!("{command}.dfq"));
            let remark = |more: &[&str], remark: &str| {
                let (_, said) = status(&[&[command, spec.as_str(), "-o", &file], more].concat(), table);
                let written = std::fs::read_to_string(&file).expect("it is written");
                assert_eq!(written.lines().filter(|line| line.starts_with(remark)).count(), 1, "{said} {written}");
            };
            remark(&["--partial"], "K1900/1 judged without pinion_radial (--partial)");
            remark(&["--set", "errors.pinion_radial={value=4,every_part=true}"], "K1001/1");
        }
    }
    let every = text.replace("\"4 um\"", "{ value = \"4 um\", every_part = true }");
    let spec = folder.file("every.toml", every.as_bytes());
    let (code, said) = status(&["batch", &spec], table);
    assert!(code == Some(0) && said.contains("P1,0.001000,0.004000,0.001000,0.005000"), "{said}");
    let (code, said) = status(&["paste", &spec, "--format", "json"], table);
    assert!(code == Some(0) && said.contains("\"pinion_radial\""), "{said}");
}

#[test]
fn measured_teeth_replace_the_deviations_of_the_spec() {
    let folder = Folder::new("reading-teeth");
    let mesh = std::fs::read_to_string("examples/mesh.toml").unwrap();
    let spec = folder.file("mesh.toml", mesh.as_bytes());
    let row = |part: &str, space: i64| format!("{part},{space},{}\n", 10 + space);
    let rows = |parts: &[&str]| -> String {
        let head = "part_id,space,over_pin_deviation [um]\n".to_owned();
        parts.iter().fold(head, |table, part| (0..12).fold(table, |table, space| table + &row(part, space)))
    };
    // the table tells nothing of the pitches, of which the spec speaks
    let (code, open) = status(&["batch", &spec, "--teeth"], rows(&["A", "B"]).as_bytes());
    assert!(code == Some(2) && open.contains("the spec speaks of rack_pitch of the rack"), "{open}");
    let (code, apart) = status(&["batch", &spec, "--teeth", "--partial"], rows(&["A", "B"]).as_bytes());
    assert!(code.is_some() && apart.contains("2 parts"), "{apart}");
    // the rows of a part may stand anywhere
    let mut lines: Vec<String> = rows(&["A", "B"]).lines().map(str::to_owned).collect();
    let head = lines.remove(0);
    lines.sort_by_key(|line| line.split(',').nth(1).unwrap().parse::<i64>().unwrap());
    let mixed = format!("{head}\n{}\n", lines.join("\n"));
    let (_, mixed) = status(&["batch", &spec, "--teeth", "--partial"], mixed.as_bytes());
    let results = |said: &str| -> Vec<String> {
        said.lines().filter(|line| line.starts_with("A,") || line.starts_with("B,")).map(str::to_owned).collect()
    };
    assert_eq!(results(&apart), results(&mixed));
    // the spec's own deviations are not added, and only strokes are covered whose contacts were measured
    let (before, after) = mesh.split_once("[[rack.deviation]]").unwrap();
    let bare = format!("{before}{}", &after[after.find("[limits]").unwrap()..]);
    let bare = folder.file("bare.toml", bare.as_bytes());
    let (_, without) = status(&["batch", &bare, "--teeth"], rows(&["A", "B"]).as_bytes());
    assert_eq!(results(&apart), results(&without));
    assert!(apart.contains("strokes whose contacts were measured"), "{apart}");
}

#[test]
fn a_part_that_fails_counts_more_than_a_limit_that_is_not_judged() {
    let folder = Folder::new("reading-order");
    let spec = folder.file(
        "s.toml",
        b"[errors]\nrack_over_roller = { nominal = 25 }\n[limits]\ncenter_distance = { lower = -0.03, upper = 0.03 }\n\
          rack_over_roller = { lower = -0.03, upper = 0.03 }\npinion_radial = { lower = -0.03, upper = 0.03 }\n",
    );
    for (last, expected) in [("B;25,001", 1), ("B;n.a.", 2)] {
        let table = folder.file("lot.csv", format!("part;rack_over_roller\nA;25,060\n{last}\n").as_bytes());
        for command in ["batch", "paste"] {
            let (code, said) = status(&[command, &spec, &table], b"");
            assert_eq!(code, Some(expected), "{command}, {last}: {said}");
        }
    }
}

/// A pair whose rack is measured space by space.
const MEASURED_RACK: &str = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n\
    [rack]\nmeasured = \"rack.csv\"\nface_width = 19.7\naddendum = 1.70\ndatum = 22\npin = 4\n\
    [pinion]\nteeth = 8\nhelix_angle = 21\nprofile_shift = 0.3\nface_width = 30\ntip_diameter = 19.738\n\
    [limits]\ncenter_distance = { lower = -0.05, upper = 0.05 }\n";

#[test]
fn a_table_that_the_spec_names_is_read_aloud() {
    let folder = Folder::new("reading-named-table");
    let spec = folder.file("spec.toml", MEASURED_RACK.as_bytes());
    folder.file("rack.csv", "space;over_pin_deviation [µm]\n0;0\n1;1\n2;2\n3;0\n4;1\n5;2\n6;0\n7;1\n8;2\n".as_bytes());
    for command in ["eval", "mesh", "simulate"] {
        let told = run(&[command, &spec], b"");
        let stderr = String::from_utf8_lossy(&told.stderr);
        assert!(stderr.contains("read as semicolons"), "{command}: {stderr}");
    }
    let (_, json) = status(&["eval", &spec, "--format", "json"], b"");
    assert!(json.contains("\"reading\"") && json.contains("over_pin_deviation"), "{json}");
    let page = folder.path("page.html");
    run(&["report", &spec, "-o", &page], b"");
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("How the tables were read"));
}

/// Names with escape sequences, in a file of a few lines, are names.
#[test]
fn control_characters_of_names_are_read() {
    let folder = Folder::new("reading-control");
    let spec = folder
        .file("s.toml", b"[errors]\nrack_over_roller = { nominal = 25.0 }\n[limits]\ncenter_distance = \"+-0.1\"\n");
    let table =
        "part,Rack over roller [mm]\nR\u{1b}[31m1\u{1b}[0m,25.01\nR\u{12}2,25.01\n\"Teil \"\"x\"\"\nzwei\",25.01\n";
    let file = folder.file("ids.csv", table.as_bytes());
    let junit = said(&run(&["batch", &spec, &file, "--junit", "-", "-q", "-o", &folder.path("o.csv")], b""));
    assert!(junit.contains("tests=\"3\"") && !junit.contains(['\u{1b}', '\u{12}']), "{junit}");
    let nul = folder.file("nul.csv", table.replace('\u{12}', "\0").as_bytes());
    let refused = run(&["batch", &spec, &nul], b"");
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).contains("it holds bytes that no table has"), "{}", said(&refused));
}

/// What a pattern or the rule for all others must not leave out.
#[test]
fn a_rule_for_many_columns_takes_no_known_heading() {
    let folder = Folder::new("reading-known");
    let with = |name: &str, rule: &str| {
        let text = format!(
            "[errors]\nrack_over_roller = {{ nominal = 25.0 }}\n[limits]\ncenter_distance = \"±0.1\"\n[table]\n{rule}\n"
        );
        folder.file(name, text.as_bytes())
    };
    let file = folder.file("a.csv", "Teil;Rollenmaß [mm];Lage\nA;25,01;1\n".as_bytes());
    for (rule, code, expected) in [
        ("ignore = [\"Roll*\", \"Lage\"]", 2, "`Roll*` would leave out `Rollenmaß [mm]`"),
        ("others = \"ignore\"", 2, "column `Lage`"),
        ("others = \"ignore\"\nignore = [\"Lage\"]", 0, "pass"),
        ("ignore = [\"La*\"]", 0, "pass"),
    ] {
        let ended = run(&["batch", &with("s.toml", rule), &file], b"");
        assert_eq!(ended.status.code(), Some(code), "{rule}: {}", said(&ended));
        assert!(said(&ended).contains(expected), "{rule}: {}", said(&ended));
    }
}

/// A refusal is short, whatever is refused.
#[test]
fn a_refusal_shows_the_first_of_many_and_no_long_text() {
    let folder = Folder::new("reading-short");
    let spec = folder.file("s.toml", b"[errors]\nrack_over_roller = { nominal = 25.0 }\n");
    let long = "x".repeat(200_000);
    let (heading, unit) =
        (format!("Teil;Rollenmaß [mm];{long}\nA;25,01;1\n"), format!("Teil;Rollenmaß [{long}]\nA;25,01\n"));
    let many = (0..3000).fold(String::new(), |rows, n| rows + &format!("P{n};x\n"));
    let parts = (0..3001).fold(String::new(), |rows, n| rows + &format!("Teil-{n};25,01\n"));
    for (name, text, most) in [
        ("heading.csv", heading, 2_000),
        ("unit.csv", unit, 2_000),
        ("rows.csv", format!("Teil;Rollenmaß [mm]\n{parts}{many}"), 100_000),
    ] {
        let file = folder.file(name, text.as_bytes());
        let command = if name == "rows.csv" { "read" } else { "batch" };
        let (files, before) = ([&spec, &file], command == "read");
        let ended = run(&[command, files[usize::from(before)], files[usize::from(!before)]], b"");
        assert_eq!(ended.status.code(), Some(2), "{name}");
        assert!(said(&ended).len() < most, "{name}: {} bytes", said(&ended).len());
        assert!(!before || said(&ended).contains("and 2900 more like these"), "{name}");
    }
}

/// A heading or a characteristic that is too long to be read is no nameless one: no rule leaves it out.
#[test]
fn no_rule_leaves_out_what_is_too_long_to_be_read() {
    let folder = Folder::new("reading-long");
    let long = "x".repeat(1001);
    for (rule, name) in [("", "nameless.toml"), (&long[..], "named.toml")] {
        let spec = format!("[errors]\nrack_over_roller = {{ nominal = 25.0 }}\n[table]\nignore = [\"{rule}\"]\n");
        let spec = folder.file(name, spec.as_bytes());
        for (file, text) in [
            ("column.csv", format!("Teil;Rollenmaß [mm];{long}\nA;25,01;1\n")),
            ("row.csv", format!("Teil;Merkmal;Ist;Soll;Einheit\nA;Rollenmaß;25,01;25,0;mm\nA;{long};3,2;0;mm\n")),
        ] {
            let ended = run(&["batch", &spec, &folder.file(file, text.as_bytes())], b"");
            assert_eq!(ended.status.code(), Some(2), "{name} {file}: {}", said(&ended));
            assert!(said(&ended).contains("has 1001 bytes"), "{name} {file}: {}", said(&ended));
        }
    }
}
