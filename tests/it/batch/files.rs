//! Whatever file a table comes in, and into which its results go.

use super::*;

pub(super) fn utf16(text: &str, big_endian: bool) -> Vec<u8> {
    let units = std::iter::once(0xfeff).chain(text.encode_utf16());
    units.flat_map(|unit: u16| if big_endian { unit.to_be_bytes() } else { unit.to_le_bytes() }).collect()
}

pub(super) fn latin1(text: &str) -> Vec<u8> {
    text.chars().map(|c| u8::try_from(u32::from(c)).expect("Latin-1")).collect()
}

#[test]
fn whatever_file_a_table_comes_in() {
    let quoted = TABLE.replace("P1", "\"P1\"").replace("25.0131", "\"25.0131\"");
    for (what, bytes) in [
        ("UTF-8", TABLE.as_bytes().to_vec()),
        ("UTF-8 with a mark", ["\u{feff}", TABLE].concat().into_bytes()),
        ("UTF-16, little endian", utf16(TABLE, false)),
        ("UTF-16, big endian", utf16(TABLE, true)),
        ("UTF-16 without a mark", utf16(TABLE, false)[2..].to_vec()),
        ("Latin-1", latin1(TABLE)),
        ("CRLF", TABLE.replace('\n', "\r\n").into_bytes()),
        ("CR", TABLE.replace('\n', "\r").into_bytes()),
        ("no final newline", TABLE.trim_end().as_bytes().to_vec()),
        ("blank lines", TABLE.replace('\n', "\n\n\r\n").into_bytes()),
        ("quotes", quoted.into_bytes()),
        ("semicolons", TABLE.replace(',', ";").into_bytes()),
        ("tabs", TABLE.replace(',', "\t").into_bytes()),
        ("a stated separator", ["sep=|\r\n", &TABLE.replace(',', "|")].concat().into_bytes()),
        ("blanks and signs", TABLE.replace("25.0131", " +25.0131 ").into_bytes()),
    ] {
        let output = batch(&[SPEC], &bytes);
        assert_eq!(text(&output.stdout), ROWS, "{what}: {}", text(&output.stderr));
        assert_eq!(output.status.code(), Some(1), "{what}");
    }
    let comma = TABLE.replace(',', ";").replace('.', ",");
    for options in [&[SPEC][..], &[SPEC, "--decimal", "comma"]] {
        assert_eq!(text(&batch(options, comma.as_bytes()).stdout), ROWS);
    }
    // what could be a decimal or a thousands mark is nobody's guess
    let open = "part_id;over_roller;dp [µm]\nP1;25;1,234\n";
    let output = batch(&[SPEC], open.as_bytes());
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("`1,234`"), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("decimal = \"comma\""), "{}", text(&output.stderr));
    let told = batch(&[SPEC, "--decimal", "comma"], open.as_bytes());
    assert!(text(&told.stdout).contains("P1,0.000000,0.001695,"), "{}", text(&told.stdout));
}

#[test]
fn packed_files_by_name_and_by_their_first_bytes() {
    let table = path("parts.csv");
    std::fs::write(&table, TABLE).unwrap();
    for suffix in ["gz", "zst"] {
        let packed = path(&format!("rows.csv.{suffix}"));
        let output = batch(&[SPEC, &table, "-o", &packed], b"");
        assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
        let bytes = std::fs::read(&packed).unwrap();
        assert!(!bytes.starts_with(b"part_id"), "{suffix}");
        // what was packed is a table again: ΔCD as deviations, from standard input
        let again =
            batch(&["tests/specs/batch-again.toml", "--columns", "part_id,delta_cd_rack_over_roller_mm"], &bytes);
        assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));
        let rows = "part_id,delta_cd_rack_over_roller_mm\nP1,0.013100\nP2,0.060100\nP3,-0.020000\n";
        assert_eq!(text(&again.stdout), rows);
        // cut off in the middle: said, and not taken for the end
        let cut = batch(&["tests/specs/batch-again.toml"], &bytes[..bytes.len() - 9]);
        assert_eq!(cut.status.code(), Some(2), "{suffix}");
        assert!(text(&cut.stderr).contains("cannot read"), "{}", text(&cut.stderr));
    }
}

#[test]
fn standard_input_may_stand_behind_a_file() {
    let table = path("before-stdin.csv");
    std::fs::write(&table, TABLE).unwrap();
    let output = batch(&[SPEC, &table, "-"], TABLE.as_bytes());
    let (header, rows) = ROWS.split_once('\n').expect("rows have a header");
    assert_eq!(text(&output.stdout), format!("{header}\n{rows}{rows}"), "{}", text(&output.stderr));
}

#[test]
fn parquet_holds_what_csv_holds() {
    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    let file = path("rows.parquet");
    let output = batch(&[SPEC, "-o", &file], TABLE.as_bytes());
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let reader = SerializedFileReader::new(std::fs::File::open(&file).unwrap()).unwrap();
    let mut lines = ROWS.lines();
    let names: Vec<_> = lines.next().unwrap().split(',').collect();
    let mut rows = reader.get_row_iter(None).unwrap();
    for line in lines {
        let row = rows.next().unwrap().unwrap();
        for ((name, field), (expected, cell)) in row.get_column_iter().zip(names.iter().zip(line.split(','))) {
            assert_eq!(name, expected);
            match field {
                parquet::record::Field::Double(number) => assert_eq!(*number, cell.parse::<f64>().unwrap(), "{line}"),
                parquet::record::Field::Null => assert_eq!(cell, "", "{line}"),
                field => assert_eq!(field.to_string(), format!("\"{cell}\""), "{line}"),
            }
        }
    }
    assert!(rows.next().is_none());
}

/// A workbook has the table's own columns beside the results, headings in words, a filter, and a sheet of notes.
#[test]
fn a_workbook_has_the_columns_of_the_table() {
    use calamine::{Reader as _, Xlsx, open_workbook};
    let (table, file) = (path("remarks.csv"), path("remarks.xlsx"));
    std::fs::write(
        &table,
        "Remark,part_id,over_roller,dp [µm]\nfine,1.50,25.0131,10\n=1+1,12345678901234567,25.0601,-5\n",
    )
    .unwrap();
    let ended = batch(&[SPEC, &table, "--ignore", "Remark", "-o", &file], b"");
    assert_eq!(ended.status.code(), Some(1), "{}", text(&ended.stderr));
    let mut book: Xlsx<_> = open_workbook(&file).expect("a workbook");
    assert_eq!(book.sheet_names(), ["rackmesh", "notes"]);
    let cells = |book: &mut Xlsx<_>, sheet: &str| -> Vec<Vec<String>> {
        let range = book.worksheet_range(sheet).expect("the sheet");
        range.rows().map(|row| row.iter().map(ToString::to_string).collect()).collect()
    };
    let rows = cells(&mut book, "rackmesh");
    assert_eq!(rows[0][..5], ["part", "Remark", "over_roller", "dp [µm]", "ΔCD of rack over-roller\n[mm]"]);
    assert_eq!(rows[1][0], "1.50");
    assert_eq!(rows[2][..5], ["12345678901234567", "=1+1", "25.0601", "-5", "0.0601"]);
    let verdict = rows[0].iter().position(|heading| heading == "verdict").expect("it has one");
    assert_eq!((rows[1][verdict].as_str(), rows[2][verdict].as_str()), ("pass", "fail"));
    let notes = cells(&mut book, "notes").concat().join("\n");
    assert!(notes.starts_with("2 rows: 1 pass, 1 fail\n") && notes.contains("left out: `Remark`"), "{notes}");
    let mut files = zip::ZipArchive::new(std::fs::File::open(&file).unwrap()).expect("an archive");
    let mut sheet = String::new();
    files.by_name("xl/worksheets/sheet1.xml").expect("the sheet").read_to_string(&mut sheet).unwrap();
    assert!(sheet.contains("<autoFilter ref=\"A1:"), "{sheet}");
}

#[test]
fn what_a_file_cannot_hold_is_refused() {
    for (options, expected) in [
        (&["--columns", "verdict,part_id,verdict"][..], "--columns names `verdict` twice"),
        (&["--rejects", &path("rejects.parquet")], "rejected rows are written as lines of text, and not as .parquet"),
    ] {
        let refused = batch(&[&[SPEC], options].concat(), TABLE.as_bytes());
        assert!(text(&refused.stderr).contains(expected), "{}", text(&refused.stderr));
        assert_eq!((refused.status.code(), text(&refused.stdout)), (Some(2), ""));
    }
    assert!(!std::path::Path::new(&path("rejects.parquet")).exists());
}

/// As many tests as parts; what is not annotated is counted.
#[test]
fn a_junit_report_counts_parts() {
    let junit = path("counted.xml");
    let mut rows = "part_id,over_roller,dp\n".to_owned();
    for part in 0..2500 {
        let _ = writeln!(rows, "P{part},{},0", if part % 100 == 0 { "26" } else { "25" });
    }
    rows.push_str("bad,x,0\n");
    let ended = batch(&[SPEC, "--junit", &junit, "--annotations", "github"], rows.as_bytes());
    let report = std::fs::read_to_string(&junit).expect("it is written");
    assert!(report.contains("tests=\"2501\" failures=\"25\" errors=\"1\" skipped=\"0\" time=\""), "{report}");
    assert_eq!(report.matches("<testcase ").count(), 2501);
    assert_eq!(report.matches("<failure ").count(), 25);
    let messages = text(&ended.stderr);
    assert!(messages.contains("; 15 more parts that do not pass without an annotation"), "{messages}");
}

#[test]
fn a_field_of_100_mb_is_refused_in_little_memory() {
    let mut child = rackmesh(&["batch", SPEC]).spawn().expect("the program starts");
    let mut stdin = child.stdin.take().expect("stdin is piped");
    stdin.write_all(TABLE.as_bytes()).unwrap();
    stdin.write_all(b"P4,\"").unwrap();
    let megabyte = vec![b'7'; 1 << 20];
    for _ in 0..100 {
        stdin.write_all(&megabyte).unwrap();
    }
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    stdin.write_all(b"\",0\nP5,25,0\n").unwrap();
    drop(stdin);
    let output = child.wait_with_output().expect("the program ends");
    assert!(text(&output.stderr).contains("the row is longer than 256 KiB"), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("5 rows: 3 pass, 1 fail, 1 rejected"), "{}", text(&output.stderr));
    assert!(text(&output.stdout).ends_with("P5,0.000000,0.000000,0.000000,0.000000,,,0.050000,pass,\n"));
    // what the program holds in the middle of the field; the pages of its own file are larger in a test build
    if let Some(held) = status.lines().find_map(|line| line.strip_prefix("RssAnon:")) {
        let kib: u64 = held.trim().trim_end_matches(" kB").parse().expect("a number");
        assert!(kib < 8 << 10, "{kib} KiB");
    }
}

/// A pipeline shows why a run has no result: in the report, and at the file or the line of the spec.
#[test]
fn a_run_that_fails_says_why_where_pipelines_look() {
    let (spec, bad, junit) = (path("misspelt.toml"), path("other, table.csv"), path("failed.xml"));
    std::fs::write(&spec, "[errors]\nrack_pich = \"5 um\"\n").unwrap();
    std::fs::write(&bad, "part_id,a<b\n1,2\n").unwrap();
    let good = path("good.csv");
    std::fs::write(&good, TABLE).unwrap();
    let named = |name: &str| name.replace(',', "%2C");
    let whole = [
        (vec![spec.as_str(), &good], format!("::error file={spec},line=2,title=unknown-key::"), "no key `rack_pich`"),
        (vec![SPEC, &bad], format!("::error file={},title=not-understood::", named(&bad)), "column `a&lt;b`: 2"),
        (vec![SPEC, "no-such.csv"], "::error file=no-such.csv,title=file-access::".to_owned(), "cannot read no-such"),
        (vec![SPEC, &good, "--no-such"], "::error title=usage::".to_owned(), "unexpected argument"),
        (
            vec![SPEC, &good, "no-such.csv"],
            "::error file=no-such.csv,title=file-access::".to_owned(),
            "cannot read no-such",
        ),
    ];
    for (arguments, annotation, why) in whole {
        let ended = batch(&[&arguments[..], &["--annotations", "github", "--junit", &junit]].concat(), b"");
        let (messages, report) = (text(&ended.stderr), std::fs::read_to_string(&junit).unwrap());
        assert_eq!(ended.status.code(), Some(2), "{messages}");
        assert!(messages.lines().any(|line| line.starts_with(&annotation)), "{annotation}: {messages}");
        assert!(report.contains("<error type=") && report.contains(why), "{why}: {report}");
    }
}

/// A container may have no folder for temporary files.
#[test]
#[cfg(unix)]
fn a_workbook_and_a_report_need_no_folder_for_temporary_files() {
    let (book, junit) = (path("no-tmp.xlsx"), path("no-tmp.xml"));
    let run = |book: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rackmesh"));
        command.args(["batch", SPEC, &path("no-tmp.csv"), "-o", book, "--junit", &junit]);
        command.env("TMPDIR", path("no-such-folder")).output().unwrap()
    };
    std::fs::write(path("no-tmp.csv"), TABLE).unwrap();
    let ended = run(&book);
    assert!(std::fs::read(&book).is_ok_and(|bytes| bytes.starts_with(b"PK")), "{}", text(&ended.stderr));
    assert!(std::fs::read_to_string(&junit).unwrap().contains("<testcase "));
}

/// The hooks of pre-commit as they are called: one evaluates, the other takes specs of batches, too.
#[test]
#[cfg(unix)]
fn a_hook_takes_the_specs_that_it_is_for() {
    let manifest = include_str!("../../../.pre-commit-hooks.yaml");
    let entry = |id: &str| {
        let hook = manifest.split("- id: ").find(|hook| hook.lines().next() == Some(id)).unwrap();
        hook.lines().find_map(|line| line.trim().strip_prefix("entry: ")).unwrap().to_owned()
    };
    let program = std::path::Path::new(env!("CARGO_BIN_EXE_rackmesh")).parent().unwrap();
    let run = |id: &str, specs: &str| {
        let line = format!("PATH={}:$PATH; {} {specs}", program.display(), entry(id));
        Command::new("sh").args(["-c", &line]).output().unwrap().status.code()
    };
    let bad = path("bad.batch.toml");
    std::fs::write(&bad, "[errors]\nrack_pich = \"5 um\"\n").unwrap();
    assert_eq!(run("rackmesh-eval", "examples/minimal.toml examples/steering.toml"), Some(0));
    assert_eq!(run("rackmesh-eval", "examples/batch.toml"), Some(1));
    assert_eq!(run("rackmesh-batch", "examples/batch.toml examples/steering.toml"), Some(0));
    assert_eq!(run("rackmesh-batch", &format!("{bad} examples/batch.toml")), Some(1));
}
