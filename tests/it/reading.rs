//! Nothing that looks like a measured value vanishes: each of these tables was once read in part and passed, or read in two
//! ways by two commands.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

/// examples/batch.toml without its `[batch.columns]`.
fn spec(folder: &Folder) -> String {
    let example = std::fs::read_to_string("examples/batch.toml").unwrap();
    let (before, _) = example.split_once("[batch.columns]").unwrap();
    folder.file("bn.toml", before.as_bytes())
}

/// A folder of its own for one test, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("reading").join(name);
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    fn file(&self, name: &str, bytes: &[u8]) -> String {
        std::fs::write(self.0.join(name), bytes).unwrap();
        self.path(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn run(arguments: &[&str], input: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_rackmesh"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_vec();
    let feeder = std::thread::spawn(move || drop(stdin.write_all(&input)));
    let output = child.wait_with_output().unwrap();
    feeder.join().unwrap();
    output
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
fn a_column_that_is_not_understood_ends_the_run() {
    let folder = Folder::new("columns");
    let spec = spec(&folder);
    for column in ["rack_pich [um]", "pitch [um]", "erreur de pas [um]", "Teilung [µm]", "xyz [um]"] {
        let table = format!("part_id,rack_over_roller,pinion_radial,{column}\nP1,25.001,8.501,200\n");
        let file = folder.file("lot.csv", table.as_bytes());
        let page = folder.path("page.html");
        for arguments in [
            vec!["batch", &spec, &file],
            vec!["paste", &spec, &file],
            vec!["report", &spec, &file, "-o", &page],
            vec!["read", &file, &spec],
        ] {
            let (code, said) = status(&arguments, b"");
            let (name, _) = column.split_once(' ').unwrap();
            assert_eq!(code, Some(2), "{arguments:?} {column}: {said}");
            assert!(said.contains(name), "{arguments:?} {column}: {said}");
        }
    }
    // all of them at once, with both remedies
    let table = "part_id,rack_over_roller,pinion_radial,rack_pich [um],gap width [mm]\nP1,25.001,8.501,200,3.1\n";
    let (code, said) = status(&["batch", &spec], table.as_bytes());
    assert_eq!(code, Some(2), "{said}");
    for words in
        ["rack_pich [um]", "gap width [mm]", "200", "near rack_pitch", "[batch.columns]", "ignore = [", "--ignore"]
    {
        assert!(said.contains(words), "{words}: {said}");
    }
    let (code, said) = status(&["batch", &spec, "--ignore", "gap*", "--ignore", "rack_pich"], table.as_bytes());
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("not used: `rack_pich [um]`, `gap width [mm]`"), "{said}");
}

#[test]
fn a_characteristic_that_is_not_understood_ends_the_run() {
    let folder = Folder::new("characteristics");
    let spec = spec(&folder);
    let lot = "K0100 3\nK2002/1 rack_over_roller\nK2142/1 mm\nK2002/2 pinion_radial\nK2142/2 mm\n\
               K2002/3 fp Zahnstange links\nK2142/3 um\n25.001\u{f}8.501\u{f}200\n";
    let file = folder.file("lot.dfq", lot.as_bytes());
    let (code, said) = status(&["batch", &spec, &file], b"");
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("fp Zahnstange links"), "{said}");
    // a name in the spec finds its characteristic, and only values that count are judged
    let spec = folder.file(
        "my.toml",
        b"[errors]\nrack_over_roller = { nominal = 25 }\n[limits]\ncenter_distance = { lower = -0.1, upper = 0.1 }\n[batch.columns]\n\
          rack_over_roller = { name = \"MyRoll\" }\n",
    );
    for (attribute, code) in [("0", 0), ("129", 2), ("255", 2), ("256", 2), ("290", 2), ("77", 2)] {
        let lot = format!("K0100 1\nK2002/1 MyRoll\nK2142/1 mm\n25.001\u{14}0\n25.002\u{14}{attribute}\n");
        let file = folder.file("lot.dfq", lot.as_bytes());
        let (found, said) = status(&["batch", &spec, &file], b"");
        assert_eq!(found, Some(code), "{attribute}: {said}");
        assert_eq!(code == 0, !said.contains(&format!("attribute {attribute}")), "{attribute}: {said}");
    }
}

#[test]
fn one_cell_is_one_number_in_every_command() {
    let folder = Folder::new("numbers");
    let spec = folder
        .file("spec.toml", b"[pair]\nnormal_pressure_angle = 45\n[limits]\nrack_pitch = { lower = -10, upper = 10 }\n");
    // 1012 µm / (2 tan 45°), where another cell proves the comma
    let table = "part_id;rack_pitch [um]\nP1;1.012\nP2;0,5\n";
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
        assert!(code == Some(2) && said.contains("`1.012`") && said.contains("--decimal comma"), "{said}");
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
fn a_later_contradiction_ends_the_run() {
    let folder = Folder::new("contradiction");
    let spec = folder
        .file("spec.toml", b"[pair]\nnormal_pressure_angle = 45\n[limits]\nrack_pitch = { lower = -10, upper = 10 }\n");
    let mut table = "part_id;rack_pitch [um]\n".to_owned();
    for part in 0..20_000 {
        table.push_str(&format!("P{part};1.5\n"));
    }
    table.push_str("Q;2,5\n");
    let file = folder.file("lot.csv", table.as_bytes());
    let partial = folder.path("rows.csv");
    let (code, said) = status(&["batch", &spec, &file, "-o", &partial], b"");
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("line 20002") && said.contains("`2,5`"), "{said}");
    assert!(!PathBuf::from(&partial).exists() && said.contains("rows.csv.partial"), "{said}");
}

#[test]
fn lines_of_a_pasted_block_are_not_dropped() {
    let folder = Folder::new("lines");
    let spec = folder.file(
        "spec.toml",
        b"[pair]\nnormal_pressure_angle = 20\n[rack]\nface_width = 19.7\n[errors]\nrack_over_roller = { nominal = 25 }\n\
          [limits]\ncenter_distance = { lower = -0.03, upper = 0.05 }\n",
    );
    for line in ["Teilungsabw. Zahnstange fp 0,1200", "fHβ [µm] 80", "003 Pitch error of rack 0.2100 mm"] {
        let block = format!("Rollenmaß 25,016 mm\n{line}\n");
        let (code, said) = status(&["paste", &spec], block.as_bytes());
        assert!(code != Some(0), "{line}: {said}");
    }
    for unit in ["[nm]", "[cm]", "(micron)", "[1/1000 mm]", "/µm", "[㎛]"] {
        let block = format!("Rollenmaß [mm]\tTeilung Zahnstange {unit}\n25,0161\t12\n");
        let (code, said) = status(&["paste", &spec, "--format", "json"], block.as_bytes());
        let expected = match unit {
            "[nm]" => 0.000_012,
            "[cm]" => 120.0,
            _ => 0.012,
        };
        assert!(said.contains(&format!("\"deviation_mm\": {expected}")) || code == Some(2), "{unit}: {said}");
    }
    // nominal values and tolerances are no parts, and a deviation that contradicts is refused
    let block = "Merkmal\tSoll\tOG\tUG\tTeil 1\tTeil 2\nRollenmaß [mm]\t25,000\t0,03\t-0,03\t25,016\t25,0131\n";
    let (code, said) = status(&["paste", &spec, "--format", "csv"], block.as_bytes());
    assert!(code == Some(0) && said.contains("Teil 1,0.016") && said.contains("Teil 2,0.0131"), "{said}");
    assert_eq!(said.matches("pass").count(), 2, "{said}");
    let block = "Merkmal\tNennmaß\tIstmaß\tAbweichung\tEinheit\nRollenmaß\t25,000\t25,016\t0,061\tmm\n";
    for command in ["paste", "batch"] {
        let (code, said) = status(&[command, &spec], block.as_bytes());
        assert!(code == Some(2) && said.contains("0.061"), "{said}");
    }
}

#[test]
fn no_parts_are_no_pass() {
    let folder = Folder::new("none");
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
    let folder = Folder::new("outputs");
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
    let spec = folder.file("read.toml", b"[errors]\nrack_over_roller = { nominal = 25 }\n[batch.columns]\nrack_over_roller = { name = \"delta_cd_rack_over_roller_mm\", kind = \"deviation\" }\n[limits]\ncenter_distance = { lower = -1, upper = 1 }\n");
    let (code, said) = status(
        &["batch", &spec, &parquet, "--ignore", "r*", "--ignore", "worst_case_*", "--ignore", "delta_cd_p*"],
        b"",
    );
    assert!(said.contains("Parquet"), "{code:?} {said}");
}

#[test]
fn what_was_assumed_reaches_every_output() {
    let folder = Folder::new("notes");
    let spec = spec(&folder);
    let table = b"part_id,rack_over_roller,pinion_radial,Operator\nP1,25.001,8.501,Kim\nP1,25.002,8.502,Kim\n";
    let file = folder.file("lot.csv", table);
    let (page, junit) = (folder.path("page.html"), folder.path("junit.xml"));
    let summary = run(&["batch", &spec, &file, "--summary", "--format", "json", "--junit", &junit], b"");
    assert_eq!(status(&["report", &spec, &file, "-o", &page], b"").0, Some(0));
    let pasted = run(&["paste", &spec, &file, "--format", "json"], b"");
    let written = [page, junit].map(|path| std::fs::read_to_string(path).unwrap());
    let [page, junit] = written;
    let (summary, pasted) = (String::from_utf8(summary.stdout).unwrap(), String::from_utf8(pasted.stdout).unwrap());
    for (what, text) in [("JSON", &summary), ("JUnit", &junit), ("page", &page), ("paste", &pasted)] {
        assert!(
            text.contains("assumed") && text.contains("Operator") && text.contains("would narrow"),
            "{what}: {text}"
        );
    }
    for (what, text) in [("JSON", &summary), ("JUnit", &junit), ("page", &page)] {
        assert!(text.contains("two parts have the name"), "{what}: {text}");
    }
    for arguments in [&["batch"][..], &["batch", "--summary"], &["report"], &["paste"]] {
        let quiet = run(&[arguments, &[&spec, &file, "-q"]].concat(), b"");
        let warned = String::from_utf8_lossy(&quiet.stderr);
        assert!(warned.contains("two parts have the name"), "{arguments:?}: {warned}");
    }
    let json: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(json["reading"][0]["columns"][1]["role"], "rack_over_roller");
}

#[test]
fn the_mapping_of_several_files_can_be_pasted() {
    let folder = Folder::new("mapping");
    let spec = spec(&folder);
    let table = |file: &str, roller: &str| {
        folder.file(file, format!("Teil;{roller} [mm];Pinion pitch error [um]\n{file}1;25,001;3,5\n").as_bytes())
    };
    let files = [table("a.csv", "Rollenmaß"), table("b.csv", "Rollenmaß"), table("c.csv", "over roller")];
    let read = run(&["read", &spec, &files[0], &files[1], &files[2], "--format", "json"], b"");
    let read: serde_json::Value = serde_json::from_slice(&read.stdout).unwrap();
    let text = std::fs::read_to_string(&spec).unwrap();
    let mapped = format!("{text}\n{}\n", read["table"].as_str().unwrap());
    // one name of two is none for a contract, and the dictionary knows both
    assert!(mapped.contains("name = \"Pinion pitch error\"") && !mapped.contains("name = \"over roller\""), "{mapped}");
    let mapped = folder.file("mapped.toml", mapped.as_bytes());
    let (code, said) = status(&["batch", &mapped, &files[0], &files[1], &files[2], "--partial"], b"");
    assert_eq!(code, Some(0), "{said}");
}

#[test]
fn what_the_spec_asks_for_and_the_table_lacks_leaves_the_sum_open() {
    let folder = Folder::new("lacking");
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
    let folder = Folder::new("teeth");
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

/// A workbook with a table on its first sheet, and other cells on its second.
fn with_second_sheet(folder: &Folder, other: &[&[&str]]) -> String {
    let mut book = rust_xlsxwriter::Workbook::new();
    for rows in [&[&["part", "M [mm]"][..], &["A", "25.001"]][..], other] {
        let sheet = book.add_worksheet();
        for (row, cells) in (0..).zip(rows) {
            for (column, cell) in (0..).zip(*cells) {
                match cell.parse::<f64>() {
                    Ok(number) => sheet.write_number(row, column, number).unwrap(),
                    Err(_) => sheet.write_string(row, column, *cell).unwrap(),
                };
            }
        }
    }
    let path = folder.path("lot.xlsx");
    book.save(&path).unwrap();
    path
}

#[test]
fn numbers_on_another_sheet_count() {
    let folder = Folder::new("sheets");
    let spec = folder.file(
        "s.toml",
        b"[errors]\nrack_over_roller = { nominal = 25 }\n[limits]\ncenter_distance = { lower = -0.03, upper = 0.03 }\n",
    );
    let others: [(&[&[&str]], i32); 7] = [
        (&[&["B", "25,060 mm"]], 2),
        (&[&["Serial", "Value"], &["B", "25.06"]], 2),
        (&[&["B", "25.06"]], 2),
        (&[&["25.06"]], 2),
        (&[&["Temp", "20.5"], &["Operator", "x"], &["Page", "2"]], 0),
        (&[&["part", "Temperature"], &["B", "20.5"]], 0),
        (&[&["Mean", "25.001"], &["Remarks", "none"]], 0),
    ];
    for (other, expected) in others {
        let book = with_second_sheet(&folder, other);
        let (code, said) = status(&["batch", &spec, &book], b"");
        assert_eq!(code, Some(expected), "{other:?}: {said}");
        for told in [["--sheet", "Sheet1"], ["--ignore", "Sheet2"]] {
            let (code, said) = status(&["batch", &spec, &book, told[0], told[1]], b"");
            assert_eq!(code, Some(0), "{other:?} {told:?}: {said}");
        }
    }
}

#[test]
fn a_part_that_fails_counts_more_than_a_limit_that_is_not_judged() {
    let folder = Folder::new("order");
    let spec = folder.file(
        "s.toml",
        b"[errors]\nrack_over_roller = { nominal = 25 }\n[limits]\ncenter_distance = { lower = -0.03, upper = 0.03 }\n\
          rack_over_roller = { lower = -0.03, upper = 0.03 }\npinion_radial = { lower = -0.03, upper = 0.03 }\n",
    );
    for (last, expected) in [("B;25,001", 1), ("B;n.a.", 2)] {
        let table = folder.file("lot.csv", format!("part;M [mm]\nA;25,060\n{last}\n").as_bytes());
        for command in ["batch", "paste"] {
            let (code, said) = status(&[command, &spec, &table], b"");
            assert_eq!(code, Some(expected), "{command}, {last}: {said}");
        }
    }
}

#[test]
fn many_lines_without_numbers_take_no_time() {
    let table = "Sehr geehrte Damen und Herren\n".repeat(3000) + "part;M [mm]\nA;25,001\n";
    let folder = Folder::new("salutations");
    let spec = spec(&folder);
    let start = std::time::Instant::now();
    let (code, said) = status(&["batch", &spec, "--partial"], table.as_bytes());
    assert_eq!(code, Some(0), "{said}");
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

/// A pair whose rack is measured space by space.
const MEASURED_RACK: &str = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n\
    [rack]\nmeasured = \"rack.csv\"\nface_width = 19.7\naddendum = 1.70\ndatum = 22\npin = 4\n\
    [pinion]\nteeth = 8\nhelix_angle = 21\nprofile_shift = 0.3\nface_width = 30\ntip_diameter = 19.738\n\
    [limits]\ncenter_distance = { lower = -0.05, upper = 0.05 }\n";

#[test]
fn a_table_that_the_spec_names_is_read_aloud() {
    let folder = Folder::new("named-table");
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

#[test]
fn what_is_said_against_a_part_is_named_however_far_down_it_stands() {
    let folder = Folder::new("far-down");
    let spec = spec(&folder);
    for (heading, ok, said) in [("Status", "ok", "rework"), ("Bemerkung", "", "NOK"), ("Ausschuss", "", "x")] {
        let mut table = format!("part_id;rack_over_roller [mm];{heading}\n");
        for part in 0..9000 {
            table += &format!("P{part};25.00{};{}\n", part % 10, if part == 8000 { said } else { ok });
        }
        let file = folder.file("lot.csv", table.as_bytes());
        let quiet = run(&["batch", &spec, &file, "--partial", "-q", "--only-failures"], b"");
        let warned = String::from_utf8_lossy(&quiet.stderr);
        assert!(warned.contains(&format!("`{heading}` says `{said}`")), "{heading}: {warned}");
    }
    // a summary that leaves out its notes does not leave out the warning
    let file = folder.file("few.csv", b"part_id;rack_over_roller [mm];Bemerkung\nP1;25.001;NOK\n");
    for format in ["table", "markdown", "csv"] {
        let quiet = run(&["batch", &spec, &file, "--partial", "-q", "--summary", "-f", format], b"");
        let warned = String::from_utf8_lossy(&quiet.stderr);
        assert!(warned.contains("`Bemerkung` says `NOK`"), "{format}: {warned}");
    }
    // the first of each column
    let mut table = "part_id;rack_over_roller [mm];Status;Bemerkung\n".to_owned();
    for part in 0..9000 {
        table += &format!("P{part};25.00{};{}\n", part % 10, if part == 8000 { "rework;NOK" } else { "ok;" });
    }
    let (_, said) = status(&["batch", &spec, &folder.file("two.csv", table.as_bytes()), "--partial"], b"");
    assert!(said.contains("`Status` says `rework`") && said.contains("`Bemerkung` says `NOK`"));
}

#[test]
fn what_is_said_of_all_parts_is_held_against_them_however_far_down_it_stands() {
    let folder = Folder::new("of-all");
    let spec = spec(&folder);
    let table = |last: &str| {
        let parts = (0..9000).map(|part| format!("P{part};25.0{}\n", 10 + part % 5));
        format!("part_id;rack_over_roller [mm]\n{}{last}\n", parts.collect::<String>())
    };
    for (last, expected) in [
        ("Max;25.014", 0),
        ("Mean;25.0121", 0),
        ("Range;0.004", 0),
        ("Max;25.412", 2),
        ("Mean;25.005", 2),
        ("Range;0.4", 2),
        ("Sollwerte", 2),
        ("Ausschuss;", 2),
    ] {
        let table = folder.file("lot.csv", table(last).as_bytes());
        let (code, said) = status(&["batch", &spec, &table, "--summary", "--partial"], b"");
        assert_eq!(code, Some(expected), "{last}: {said}");
        let last = last.trim_end_matches(';').replace(';', " ");
        assert!(expected == 0 || said.contains(&last) && said.contains("line 9002"), "{last}: {said}");
    }
}

#[test]
fn a_row_that_is_said_to_be_of_the_other_part_ends_the_run_however_far_down_it_stands() {
    let folder = Folder::new("other-part");
    let spec = spec(&folder);
    for (last, expected) in [("Zahnstange LH", 0), ("Ritzel LH", 2)] {
        let parts = (0..9000).map(|part| format!("P{part};Zahnstange;25.011\n")).collect::<Vec<_>>().concat();
        let table = format!("part_id;Benennung;Rollenmaß [mm]\n{parts}P9000;{last};25.012\n");
        let (code, said) =
            status(&["batch", &spec, &folder.file("lot.csv", table.as_bytes()), "--summary", "--partial"], b"");
        assert_eq!(code, Some(expected), "{last}: {said}");
        assert!(expected == 0 || said.contains("line 9002") && said.contains("`Ritzel LH`"), "{said}");
    }
}

#[test]
fn what_a_workbook_strikes_through_in_part_or_says_in_a_text_box_is_seen() {
    let folder = Folder::new("struck-in-part");
    let spec = spec(&folder);
    let struck = rust_xlsxwriter::Format::new().set_font_strikethrough();
    let plain = rust_xlsxwriter::Format::new();
    for (value, name, text_box, said, expected) in [
        (true, false, "", "~~25.011~~", Some(2)),
        (false, true, "", "says `~~P2~~`", Some(0)),
        (false, false, "P2 = 25.412", "25.412", Some(2)),
        (false, false, "Messung ungültig", "`text box` says `Messung ungültig`", Some(0)),
    ] {
        let mut book = rust_xlsxwriter::Workbook::new();
        let sheet = book.add_worksheet();
        sheet.write_string(0, 0, "part_id").unwrap().write_string(0, 1, "rack_over_roller [mm]").unwrap();
        sheet.write_string(1, 0, "P1").unwrap().write_number(1, 1, 25.012).unwrap();
        for (column, text, is_struck) in [(0, "P2", name), (1, "25.011", value)] {
            let (first, rest) = text.split_at(1);
            let font = if is_struck { &struck } else { &plain };
            sheet.write_rich_string(2, column, &[(font, first), (font, rest)]).unwrap();
        }
        if !text_box.is_empty() {
            sheet.insert_shape(5, 5, &rust_xlsxwriter::Shape::textbox().set_text(text_box)).unwrap();
        }
        let table = folder.path("lot.xlsx");
        book.save(&table).unwrap();
        let (code, answer) = status(&["batch", &spec, &table, "--partial"], b"");
        assert_eq!(code, expected, "{said}: {answer}");
        assert!(answer.contains(said), "{said}: {answer}");
    }
}
