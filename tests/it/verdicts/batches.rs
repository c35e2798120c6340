//! Verdicts of a batch are those of `eval`, on the teeth that its columns say.

use super::*;

/// A row of a table is judged as the spec with its values is, on a known pair and on one that is not.
#[test]
fn a_batch_gives_the_verdicts_of_eval() {
    let rows = [
        ["0.010", "0.012", "-0.004", "0.009"],
        ["0.020", "-0.020", "0.008", "-0.020"],
        ["-0.030", "0.001", "0.030", "0"],
        ["0", "0", "0", "0"],
        ["0.0331", "0.0002", "-0.031", "0.0005"],
    ];
    let keys = ["rack_over_roller", "rack_pitch", "pinion_radial", "pinion_pitch"];
    let table: String = std::iter::once(format!("part_id,{}\n", keys.join(",")))
        .chain(rows.iter().enumerate().map(|(part, row)| format!("P{part},{}\n", row.join(","))))
        .collect();
    let limits = "[limits]\ncenter_distance = \"±0.04\"\n";
    let folder = Folder::new("verdicts");
    let mut seen = Vec::new();
    for pair in [PAPER, "[pair]\nnormal_pressure_angle = 19.9\n"] {
        for extent in ["one", "each"] {
            let entry = |value: &str| format!("{{ {value}extent = \"{extent}\" }}");
            let spec = format!("{pair}[errors]\nrack_pitch = {}\n{limits}", entry(""));
            let spec_file = folder.path("spec.toml");
            std::fs::write(&spec_file, &spec).expect("written");
            let batch = run(&["batch", &spec_file, "-", "--format", "jsonl"], &table);
            let lines: Vec<Value> =
                batch.stdout.lines().map(|line| serde_json::from_str(line).expect("a row is JSON")).collect();
            assert_eq!(lines.len(), rows.len(), "{}", batch.stderr);
            for (line, row) in lines.iter().zip(rows) {
                let errors = format!(
                    "[errors]\nrack_over_roller = {}\nrack_pitch = {}\npinion_radial = {}\npinion_pitch = {}\n",
                    row[0],
                    entry(&format!("value = {}, ", row[1])),
                    row[2],
                    row[3]
                );
                let one = eval(&format!("{pair}{errors}{limits}")).json();
                assert_eq!(line["verdict"], one["verdict"], "{pair} {extent} {row:?}: {line} {one}");
                seen.push(one["verdict"].clone());
            }
        }
    }
    for verdict in ["pass".into(), "fail".into(), Value::Null] {
        assert!(seen.contains(&verdict), "{verdict}: {seen:?}");
    }
}

/// What is written of a column's values holds for each of them, in every command that reads tables.
#[test]
fn a_column_says_on_which_teeth_its_values_are() {
    let folder = Folder::new("column-extents");
    let (file, table) = (folder.path("spec.toml"), folder.path("parts.csv"));
    std::fs::write(&table, "part_id,fp max\nA,0.012\n").expect("written");
    let write = |errors: &str| {
        let columns = "[table.columns]\nrack_pitch = { name = \"fp max\", unit = \"mm\", extent = \"each\" }\n";
        let text = format!("{PAPER}[errors]\n{errors}\n{columns}[limits]\ncenter_distance = \"±0.04\"\n");
        std::fs::write(&file, text).expect("written");
    };
    let every_part = "pinion_pitch = { value = 0.005, every_part = true }";
    let expected =
        eval(&format!("{PAPER}[errors]\nrack_pitch = {{ value = 0.012, extent = \"each\" }}\npinion_pitch = 0.005\n"));
    // beside a value, `[errors]` says of that value where it is, and nothing of the column's
    for beside in ["", "rack_pitch = { value = 0.001, extent = \"one\" }", "rack_pitch = { extent = \"each\" }"] {
        write(&format!("{every_part}\n{beside}"));
        let batch = run(&["batch", &file, &table, "--format", "jsonl", "--decimals", "full"], "");
        assert_eq!(batch.code, Some(0), "{}", batch.stderr);
        let row = batch.json();
        let ranges =
            (row["range_lower_mm"].as_f64().expect("a number"), row["range_upper_mm"].as_f64().expect("a number"));
        assert_eq!(ranges, range(&expected), "{beside}");
        assert!(batch.stderr.contains("note: extent: rack_pitch each (every pitch, any sign)\n"), "{}", batch.stderr);
        let paste = run(&["paste", &file, &table, "--format", "json"], "");
        assert_eq!(range(&paste), range(&expected), "{beside}");
        let json = paste.json();
        assert_eq!([&json["contributions"][0]["extent"], &json["contributions"][1]["extent"]], ["each", "one"]);
    }
    let page = run(&["report", &file, &table], "").stdout;
    assert!(page.contains("extent: rack_pitch each (every pitch, any sign)"), "{page}");
}

/// A value that every part has is where `[errors]` says, not where a column says that the table lacks.
#[test]
fn a_column_that_is_not_there_says_nothing() {
    let folder = Folder::new("column-extents-lacking");
    let (file, table) = (folder.path("spec.toml"), folder.path("parts.csv"));
    std::fs::write(&table, "part_id,rack_over_roller\nA,0.012\n").expect("written");
    let text = "[errors]\npinion_radial = { value = 0.004, every_part = true }\n[table.columns]\npinion_radial = { extent = \"all\" }\n";
    std::fs::write(&file, text).expect("written");
    let ranges = (0.012, 0.016);
    let row = run(&["batch", &file, &table, "--format", "jsonl"], "").json();
    assert_eq!((row["range_lower_mm"].as_f64(), row["range_upper_mm"].as_f64()), (Some(ranges.0), Some(ranges.1)));
    assert_eq!(range(&run(&["paste", &file, &table, "--format", "json"], "")), ranges);
}

/// Of the values of a table the spec says one thing.
#[test]
fn columns_and_errors_say_the_same() {
    let folder = Folder::new("column-extents-contradicted");
    let (file, table) = (folder.path("spec.toml"), folder.path("parts.csv"));
    std::fs::write(&table, "part_id,rack_pitch\nA,0.012\n").expect("written");
    for entry in ["{ extent = \"one\" }", "{ nominal = 0, extent = \"one\" }", "{ u = \"1 um\", extent = \"one\" }"] {
        let text =
            format!("{PAPER}[errors]\nrack_pitch = {entry}\n[table.columns]\nrack_pitch = {{ extent = \"each\" }}\n");
        std::fs::write(&file, &text).expect("written");
        for command in ["batch", "paste", "report"] {
            let ended = run(&[command, &file, &table], "");
            let why = "`errors.rack_pitch.extent` is \"one\" and `table.columns.rack_pitch.extent` is \"each\"";
            assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{command} {entry}");
            assert!(ended.stderr.contains(why) && ended.stderr.contains("spec.toml:16:25"), "{}", ended.stderr);
        }
    }
    let total = "[table.columns]\nrack_over_roller = { extent = \"total\" }\n";
    std::fs::write(&file, total).expect("written");
    let ended = run(&["batch", &file, &table], "");
    assert!(ended.stderr.contains("spec.toml:2:31"), "{}", ended.stderr);
    assert!(ended.stderr.contains("`rack_over_roller.extent`: only a pitch"), "{}", ended.stderr);
}

/// Parts without a range are no parts that pass: the exit status, the summary and what pipelines read say so, and why.
#[test]
fn a_batch_without_ranges_does_not_pass() {
    let folder = Folder::new("open-batch");
    let (spec, table, junit) = (folder.path("spec.toml"), folder.path("parts.csv"), folder.path("parts.xml"));
    let text = "[pair]\nnormal_pressure_angle = 20\n[errors]\nrack_pitch = { extent = \"all\" }\n[limits]\ncenter_distance = \"±0.05\"\n";
    std::fs::write(&table, "part_id,rack_pitch\nA,0.001\nB,0\n").expect("written");
    for (text, stack) in
        [(text.to_owned(), "range"), (text.to_owned(), "rss"), (text.replace("center_distance", "rack_pitch"), "range")]
    {
        std::fs::write(&spec, &text).expect("written");
        let ended = run(&["batch", &spec, &table, "--stack", stack, "--junit", &junit, "--annotations", "github"], "");
        assert_eq!(ended.code, Some(2), "{stack}: {}", ended.stderr);
        let why = "errors of many pitches add up over the teeth in contact: the pair's geometry is missing: `pair.normal_module`";
        assert!(ended.stderr.contains(why), "{}", ended.stderr);
        let open = "2 parts have no range to hold against a limit";
        assert!(ended.stderr.contains(&format!("::error title=rackmesh batch::{open}")), "{}", ended.stderr);
        let junit = std::fs::read_to_string(&junit).expect("written");
        assert!(junit.contains("errors=\"1\"") && junit.contains(open), "{junit}");
        let summary = run(&["batch", &spec, &table, "--stack", stack, "--summary"], "");
        assert_eq!(summary.code, Some(2));
        let last = summary.stdout.lines().last().unwrap_or_default();
        assert!(last.starts_with(&format!("No verdict: {open}: A: not judged: ")), "{}", summary.stdout);
    }
    // without a limit nothing is left open
    std::fs::write(&spec, text.split("[limits]").next().expect("the first part")).expect("written");
    assert_eq!(run(&["batch", &spec, &table], "").code, Some(0));
}
