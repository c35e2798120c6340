//! Making a contract is pleasant: what `read` proposes closes a table, in one go, and what it writes changes nothing else.

mod details;
mod kept;

use std::path::Path;
use std::process::Output;

use crate::process::{Folder, with_input};

pub(crate) const SPEC: &str = "# drawing 4711\n[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[errors]\n\
                    rack_over_roller = { nominal = 25 }   # as drawn\nrack_pitch = { u = \"0.5 um\" }\n[limits]\ncenter_distance = \"±0.5\"\n";
const NAMES: &str = "Teil;Rollenmaß [mm];Teilungsabweichung Zahnstange [µm]";

fn run(arguments: &[&str]) -> Output {
    with_input(arguments, b"")
}

pub(crate) fn status(arguments: &[&str]) -> (i32, String) {
    let output = run(arguments);
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    (output.status.code().unwrap(), said)
}

/// The `[table]` that `read` shows.
fn block(files: &[&str], spec: &str) -> String {
    let output = run(&[&["read"], files, &["--spec", spec, "--format", "json"]].concat());
    let json: serde_json::Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    json["table"].as_str().unwrap().to_owned()
}

/// How many rules a contract has: entries of lists, columns and keys.
fn rules(block: &str) -> usize {
    let table = block.parse::<toml::Table>().unwrap();
    let count = |value: &toml::Value| match value {
        toml::Value::Array(list) => list.len(),
        toml::Value::Table(columns) => columns.len(),
        _ => 1,
    };
    table["table"].as_table().unwrap().values().map(count).sum()
}

struct Export {
    what: &'static str,
    files: Vec<String>,
    /// What a person has to say: comments that are uncommented.
    choices: &'static [&'static str],
    rules: usize,
    /// The exit status of `batch`.
    status: i32,
}

fn export(what: &'static str, rules: usize, table: &str) -> Export {
    Export { what, files: vec![table.to_owned()], choices: &[], rules, status: 0 }
}

fn everyday() -> Vec<Export> {
    let inspected = |who: &str, day: u32| format!("Prüfer: {who}\nDatum: {day}.03.2026\n{NAMES}\nP{day};25,011;3,1\n");
    let many: Vec<String> =
        (1..=500).map(|part| format!("P{part};25,011;3,1;{}i.O.\n", if part == 417 { "n." } else { "" })).collect();
    let many = many.concat();
    let foreign = (1..=20).map(|column| format!(";Wert {column}")).collect::<Vec<_>>().concat();
    vec![
        export(
            "trailing separators",
            3,
            "Teil;Rollenmaß [mm];Teilungsabweichung Zahnstange [µm];;\nP1;25,011;3,1;;\nP2;25,004;-2,2;;\n",
        ),
        export(
            "index column of a data frame",
            4,
            ",part_id,rack_over_roller,rack_pitch\n0,P1,25.011,0.0031\n1,P2,25.004,-0.0022\n",
        ),
        export("units row", 3, "Teil;Rollenmaß;Teilungsabweichung Zahnstange\n;mm;µm\nP1;25,011;3,1\nP2;25,004;-2,2\n"),
        export(
            "units row of foreign columns",
            5,
            "Teil;Rollenmaß;Teilungsabweichung Zahnstange;Temp;Kraft\n;mm;µm;°C;N\nP1;25,011;3,1;20;5\nP2;25,004;-2,2;21;5\n",
        ),
        export(
            "units row of a guess",
            4,
            "Teil;Rollenmaß;CHR_017;Temp\n;mm;µm;°C\nP1;25,011;3,1;20\nP2;25,004;-2,2;21\n",
        ),
        export(
            "a column at the end without a heading",
            4,
            "Teil;Rollenmaß [mm];Teilungsabweichung Zahnstange [µm];;\nP1;25,011;3,1;;x\nP2;25,004;-2,2;;\n",
        ),
        export(
            "parts in lines above",
            3,
            "Teil: P1\nRollenmaß [mm];Teilungsabweichung Zahnstange [µm]\n25,011;3,1\nTeil: P2\n\
             Rollenmaß [mm];Teilungsabweichung Zahnstange [µm]\n25,004;3,1\n",
        ),
        export(
            "headings on each page",
            4,
            &format!("Seite 1 von 2\n{NAMES}\nP1;25,011;3,1\nSeite 2 von 2\n{NAMES}\nP2;25,004;-2,2\n"),
        ),
        Export {
            files: vec![inspected("Huber", 12), inspected("Meier", 13)],
            ..export("dates and inspectors change", 5, "")
        },
        export(
            "statistics below",
            6,
            &format!(
                "{NAMES}\nP1;25,011;3,1\nP2;25,004;-2,2\nMittelwert;25,008;0,5\nMax;25,011;3,1\nStdAbw;0,004;2,6\n"
            ),
        ),
        Export { status: 1, ..export("one n.i.O. in 500", 4, &format!("{NAMES};Bewertung\n{many}")) },
        Export {
            choices: &["repeats = \"last\""],
            ..export("a part measured twice", 4, &format!("{NAMES}\nP1;25,011;3,1\nP2;25,404;-2,2\nP2;25,004;-2,2\n"))
        },
        export(
            "headings and limits on each page",
            11,
            &["1", "2"]
                .map(|page| {
                    format!(
                        "Messprotokoll;;\nZeichnung;4711;Index C\nMerkmal;Maß;Abweichung\nSeite;{page};2\nSoll;25;0\nTol;0,03;15\n\
                         {NAMES}\nP{page}1;25,011;1,1\nP{page}2;25,012;2,1\nMittelwert;25,0;0\n\n"
                    )
                })
                .concat(),
        ),
        Export {
            choices: &["rack_pitch = { name = \"CHR_018\"", "others = \"ignore\""],
            ..export(
                "twenty foreign columns and an error among them",
                4,
                &format!(
                    "Teil;Rollenmaß [mm];CHR_017;CHR_018{foreign}\nP1;25,011;3,1;2,2{0}\nP2;25,004;-2,2;0,4{0}\n",
                    ";1".repeat(20)
                ),
            )
        },
        export("sep=;", 3, &format!("sep=;\n{NAMES}\nP1;25,011;3,1\n")),
        export(
            "twenty foreign columns",
            23,
            &format!("{NAMES}{foreign}\nP1;25,011;3,1{0}\nP2;25,004;-2,2{0}\n", ";1".repeat(20)),
        ),
    ]
}

/// `cargo test --test it everyday -- --nocapture` prints how many rules and commands each export takes.
#[test]
fn everyday_exports_are_closed_by_one_command() {
    for export in everyday() {
        let folder = Folder::new(&format!("proposals-{}", export.what).replace(['=', ';'], "-"));
        let spec = folder.file("rack.toml", SPEC);
        let files: Vec<String> =
            export.files.iter().enumerate().map(|(at, text)| folder.file(&format!("lot{at}.csv"), text)).collect();
        let files: Vec<&str> = files.iter().map(String::as_str).collect();
        let mut table = block(&files, &spec);
        let mut commands = 1;
        for choice in export.choices {
            assert!(table.contains(&format!("# {choice}")), "{}: {table}", export.what);
            table = table.replacen(&format!("# {choice}"), choice, 1);
            commands += 1;
        }
        folder.file("rack.toml", format!("{SPEC}\n{table}"));
        let (code, said) = status(&[&["batch", &spec][..], &files].concat());
        assert_eq!(code, export.status, "{}: {table}\n{said}", export.what);
        assert_eq!(rules(&table), export.rules, "{}: {table}", export.what);
        println!("{}: {} rules, {commands} commands", export.what, export.rules);
    }
}

#[test]
fn a_contract_of_two_files_fits_the_next() {
    let folder = Folder::new("proposals-third");
    let spec = folder.file("rack.toml", SPEC);
    let file = |name: &str, who: &str| {
        folder.file(name, format!("Prüfer: {who}\nWerk Ulm\nDatum: 1{}.03.2026\n{NAMES}\nP1;25,011;3,1\n", who.len()))
    };
    let (one, other, third) = (file("a.csv", "Huber"), file("b.csv", "Meierle"), file("c.csv", "Ortner"));
    let (code, said) = status(&["read", &one, &other, &spec, "--write", "--yes"]);
    assert_eq!(code, 0, "{said}");
    let written = std::fs::read_to_string(&spec).unwrap();
    assert!(written.starts_with(SPEC) && written.contains("[\"Prüfer: *\", \"Werk Ulm\", \"Datum: #\"]"), "{written}");
    assert_eq!(status(&["batch", &spec, &third]).0, 0);
    assert_eq!(status(&["read", "--check", &third, &spec]).0, 0);
    // once is enough
    assert_eq!(status(&["read", &one, &other, &spec, "--write", "--yes"]).0, 0);
    assert_eq!(std::fs::read_to_string(&spec).unwrap(), written);
}

#[test]
fn yes_writes_what_is_exact_and_a_word_accepts_a_guess() {
    let folder = Folder::new("proposals-yes");
    let text = SPEC.replace('\n', "\r\n");
    let spec = folder.file("rack.toml", &text);
    let file = folder
        .file("a.csv", "Protokoll 7\nTeil;Rollenmaß [mm];CHR_017;Temp [°C]\nP1;25,011;3,1;20,1\nMax;25,011;3,1;20,1\n");
    let written = || std::fs::read_to_string(&spec).unwrap();
    let (code, said) = status(&["read", &file, &spec, "--write"]);
    assert!(code == 2 && said.contains("--yes") && written() == text, "{said}");
    let (code, said) = status(&["read", &file, &spec, "--write", "--yes"]);
    assert_eq!(code, 2, "{said}");
    for line in [
        "  \"Protokoll 7\",\r\n",
        "  # a guess: any number there:\r\n  # \"Protokoll #\",\r\n",
        "only column of numbers that can be it:\r\n# rack_pitch = { name = \"CHR_017\", unit = \"um\" }\r\n",
    ] {
        assert!(written().starts_with(&text) && written().contains(line), "{line}: {}", written());
    }
    assert_eq!(status(&["schema"]).0, 0);
    assert_eq!(status(&["read", "--check", &file, &spec]).0, 2);
    let (code, said) = status(&["read", &file, &spec, "--write", "--yes", "--accept", "rack_pitch=CHR_017"]);
    assert!(
        code == 0 && written().contains("\r\nrack_pitch = { name = \"CHR_017\", unit = \"um\" }\r\n"),
        "{said}{}",
        written()
    );
    assert_eq!(status(&["batch", &spec, &file]).0, 0);
    assert!(written().lines().all(|line| !line.ends_with('\r')) && !written().replace("\r\n", "").contains('\n'));
    // a changed export
    let changed = folder.file("b.csv", "Protokoll 7\nTeil;Rollenmaß [mm];Spindel;Temp [°C]\nP1;25,011;4;20,1\n");
    let (code, said) = status(&["read", "--check", &changed, &spec]);
    assert!(
        code == 2 && said.contains("new column \"Spindel\"") && said.contains("column \"CHR_017\" is gone"),
        "{said}"
    );
}

/// Few texts may be decisions, also where all are the same: they wait for a person.
#[test]
fn what_may_decide_waits_for_a_person() {
    for texts in [["i.O.", "i.O."], ["ok", "Ausschuss"], ["i.O.", "n.i.O."]] {
        let folder = Folder::new("proposals-decides");
        let table = format!("{NAMES};Bewertung\nP1;25,011;3,1;{}\nP2;25,004;-2,2;{}\n", texts[0], texts[1]);
        let (spec, file) = (folder.file("rack.toml", SPEC), folder.file("a.csv", &table));
        assert_eq!(status(&["read", &file, &spec, "--write", "--yes"]).0, 2, "{texts:?}");
        assert_eq!(status(&["batch", &spec, &file]).0, 2, "{texts:?}");
    }
    let folder = Folder::new("proposals-decided");
    let table = format!("{NAMES};Maschine\nP1;25,011;3,1;M3\nP2;25,004;-2,2;M3\n");
    let (spec, file) = (folder.file("rack.toml", SPEC), folder.file("a.csv", &table));
    let (code, said) = status(&["read", &file, &spec, "--write", "--yes", "--accept", "ignore=Maschine"]);
    assert_eq!(code, 0, "{said}");
    assert_eq!(status(&["batch", &spec, &file]).0, 0);
}

/// A column that may be an error of the spec is left out by a person, and by nobody else.
#[test]
fn what_may_be_an_error_of_the_spec_waits_for_a_person() {
    let folder = Folder::new("proposals-error");
    let (spec, file) = (
        folder.file("rack.toml", SPEC),
        folder.file("a.csv", "Teil;Rollenmaß [mm];CHR_017;CHR_018\nP1;25,011;3,1;2,2\nP2;25,004;-2,2;0,4\n"),
    );
    let written = || std::fs::read_to_string(&spec).unwrap();
    assert_eq!(status(&["read", &file, &spec, "--write", "--yes"]).0, 2);
    assert!(
        written().contains("# \"CHR_017\",") && written().contains("# rack_pitch = { name = \"CHR_018\""),
        "{}",
        written()
    );
    assert_eq!(status(&["batch", &spec, &file]).0, 2);
    let accepted = ["--accept", "rack_pitch=CHR_018", "--accept", "ignore=CHR_017"];
    folder.file("rack.toml", SPEC);
    let (code, said) = status(&[&["read", &file, &spec, "--write", "--yes"][..], &accepted].concat());
    let units = written().contains("# rack_pitch = { name = \"CHR_018\", unit");
    assert!(code == 0 || units, "{said}{}", written());
    // the rule for all others takes no column while an error has none
    let others = format!("{SPEC}\n[table]\nothers = \"ignore\"\n");
    folder.file("rack.toml", &others);
    let (code, said) = status(&["batch", &spec, &file]);
    assert!(code == 2 && said.contains("column `CHR_017`") && said.contains("column `CHR_018`"), "{said}");
    folder
        .file("rack.toml", format!("{others}[table.columns]\nrack_pitch = {{ name = \"CHR_017\", unit = \"um\" }}\n"));
    let (code, said) = status(&["batch", &spec, &file]);
    assert_eq!(code, 0, "{said}");
}

/// Nobody writes more rules than a person reads.
#[test]
fn a_thousand_rules_are_the_most() {
    let folder = Folder::new("proposals-rules");
    let file = folder.file("a.csv", format!("{NAMES}\nP1;25,011;3,1\n"));
    for list in ["ignore", "ignore_lines", "comments"] {
        let rules = |count: usize| {
            let all: Vec<String> = (0..count).map(|rule| format!("\"Zeile {rule}\"")).collect();
            folder.file("rack.toml", format!("{SPEC}\n[table]\n{list} = [{}]\n", all.join(", ")))
        };
        let (code, said) = status(&["batch", &rules(1001), &file]);
        assert!(code == 2 && said.contains(&format!("`{list}` has 1001 rules")) && said.contains("Temp*"), "{said}");
        assert_eq!(status(&["batch", &rules(1000), &file]).0, 0);
    }
}

/// A spec that ends without a line end still does.
#[test]
fn a_spec_ends_as_it_did() {
    let folder = Folder::new("proposals-end");
    let file = folder.file("a.csv", format!("{NAMES};Temp\nP1;25,011;3,1;20,1\n"));
    for text in [SPEC.trim_end().to_owned(), SPEC.to_owned(), format!("{SPEC}\n[table]\nignore = []")] {
        let spec = folder.file("rack.toml", &text);
        assert_eq!(status(&["read", &file, &spec, "--write", "--yes"]).0, 0);
        let written = std::fs::read_to_string(&spec).unwrap();
        assert!(written.contains("Temp") && written.starts_with(SPEC.trim_end()), "{written}");
        assert_eq!(written.ends_with('\n'), text.ends_with('\n'), "{written:?}");
    }
}

/// What was said of a workbook or a text on the command line stands in the contract, too.
#[test]
fn where_the_table_stands_is_written() {
    let folder = Folder::new("proposals-where");
    let (spec, file) = (folder.file("rack.toml", SPEC), folder.path("lot.xlsx"));
    let mut book = rust_xlsxwriter::Workbook::new();
    book.add_worksheet().set_name("Deckblatt").unwrap().write_string(0, 0, "Auftrag 7").unwrap();
    let sheet = book.add_worksheet().set_name("Lot").unwrap();
    sheet.write_string(0, 0, "Lot 7").unwrap();
    for (column, (name, value)) in (1..).zip([("Rollenmaß [mm]", 25.011), ("Teilungsabweichung Zahnstange [µm]", 3.1)])
    {
        sheet.write_string(2, column, name).unwrap().write_number(3, column, value).unwrap();
    }
    book.save(&file).unwrap();
    let (code, said) = status(&["batch", &spec, &file]);
    assert!(code == 2 && said.contains("  # say which:\n  # sheet = \"Deckblatt\"\n  # sheet = \"Lot\"\n"), "{said}");
    let told = ["--sheet", "Lot", "--range", "B3:C9"];
    let (code, said) = status(&[&["read", &file, &spec, "--write", "--yes"][..], &told].concat());
    let written = std::fs::read_to_string(&spec).unwrap();
    assert!(code == 0 && written.contains("sheet = \"Lot\"\nrange = \"B3:C9\"\n"), "{said}{written}");
    assert_eq!(status(&["batch", &spec, &file]).0, 0);
    assert_eq!(status(&["read", "--check", &file, &spec]).0, 0);
}

/// The roles that the dictionary finds of characteristics, spaces and teeth are written, too.
#[test]
fn roles_of_characteristics_and_teeth_are_written() {
    for (table, lines) in [
        (
            "Teil;Merkmal;Soll;Ist;Einheit\nP1;Rollenmaß;25,000;25,011;mm\nP2;Rollenmaß;25,000;25,004;mm\n",
            &[
                "part_id = \"Teil\"",
                "name = \"Merkmal\"",
                "nominal = \"Soll\"",
                "actual = \"Ist\"",
                "unit = \"Einheit\"",
                "rack_over_roller = { name = \"Rollenmaß\", unit = \"mm\" }",
            ][..],
        ),
        (
            "Teil;Lücke;over_pin_deviation [um];position_deviation [um]\nP1;0;1,5;0\nP1;1;2,5;-1,5\n",
            &["space = \"Lücke\"", "over_pin = { name = \"over_pin_deviation\", unit = \"µm\" }"],
        ),
    ] {
        let folder = Folder::new("proposals-roles");
        let (spec, file) = (folder.file("rack.toml", SPEC), folder.file("a.csv", table));
        let written = || std::fs::read_to_string(&spec).unwrap();
        let write = || assert_eq!(status(&["read", &file, &spec, "--write", "--yes"]).0, 0, "{table}");
        write();
        let once = written();
        for line in lines {
            assert!(once.contains(&format!("{line}\n")), "{line}: {once}");
        }
        write();
        assert_eq!((written(), status(&["read", "--check", &file, &spec]).0), (once, 0));
    }
}

/// The remedy of a row that is no part is whole: with it the next run has a verdict.
#[test]
fn the_remedy_of_a_row_closes_it() {
    let folder = Folder::new("proposals-remedy");
    let table = "part_id,rack_over_roller,rack_pitch\nP1,25.011,0.0031\nMittelwert,25.011,0.0031\nMax,,\n".to_owned();
    let table = table + &"word ".repeat(300) + ",,\n";
    let (spec, file) = (folder.file("rack.toml", SPEC), folder.file("a.csv", &table));
    let (code, said) = status(&["batch", &spec, &file]);
    let rules: Vec<&str> = said
        .lines()
        .filter_map(|line| line.split_once("ignore_lines = [")?.1.rsplit_once(']'))
        .map(|(rule, _)| rule)
        .collect();
    assert_eq!((code, rules.len()), (2, 1), "{said}");
    folder.file("rack.toml", format!("{SPEC}\n[table]\nignore_lines = [{}]\n", rules.join(", ")));
    let (code, said) = status(&["batch", &spec, &file]);
    assert_eq!(code, 0, "{said}");
}

/// For each table of the corpus that has a meaning: what is proposed closes it, but for what a person has to choose.
#[test]
fn proposals_close() {
    const SHARE: usize = 16;
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tables");
    let manifest: toml::Table = std::fs::read_to_string(corpus.join("cases.toml")).unwrap().parse().unwrap();
    let text = |case: &toml::Value, key: &str| case.get(key).and_then(toml::Value::as_str).map(str::to_owned);
    let has_meaning = |case: &&toml::Value| {
        text(case, "outcome").is_some_and(|outcome| outcome != "refused")
            && text(case, "command").is_some_and(|command| command == "batch")
            && text(case, "file").is_some_and(|file| [".csv", ".xlsx", ".tsv"].iter().any(|end| file.ends_with(end)))
            && case.get("options").is_none()
    };
    let cases: Vec<_> = manifest["case"].as_array().unwrap().iter().filter(has_meaning).collect();
    let step = if std::env::var_os("RACKMESH_LONG_TESTS").is_some() { 1 } else { SHARE };
    let (mut closed, mut chosen, mut open) = (0, 0, Vec::new());
    for (at, case) in cases.iter().enumerate().step_by(step) {
        let folder = Folder::new(&format!("corpus-{at}"));
        let file = corpus.join(text(case, "file").unwrap()).display().to_string();
        let spec_text = std::fs::read_to_string(corpus.join(text(case, "spec").unwrap())).unwrap();
        let spec = folder.file("rack.toml", &spec_text);
        if spec_text.contains("[batch")
            || spec_text.contains("[table")
            || !run(&["read", &file, &spec]).stdout.is_empty() && block(&[&file], &spec).is_empty()
        {
            continue;
        }
        let table = block(&[&file], &spec);
        folder.file("rack.toml", format!("{spec_text}\n{table}"));
        let (code, said) = status(&["read", "--check", &file, &spec]);
        if code == 0 {
            closed += 1;
        } else if table.lines().any(|line| line.trim_start().starts_with('#') && line.contains("say w")) {
            chosen += 1;
        } else {
            open.push(format!("{file}: {said}\n{table}"));
        }
    }
    println!("{closed} closed, {chosen} wait for a choice, {} open", open.len());
    assert!(closed > 0 && open.is_empty(), "{}", open.join("\n"));
}
