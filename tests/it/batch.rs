//! `rackmesh batch` as a process: whatever file a table comes in, what becomes of bad rows, exit statuses.

mod files;

use files::utf16;
use std::fmt::Write as _;
use std::io::{Read as _, Write as _};
use std::path::PathBuf;
use std::process::{Command, Output};

use crate::process::{rackmesh, text, with_input};

const SPEC: &str = "tests/specs/batch.toml";
const TABLE: &str = "part_id,over_roller,dp [µm]\nP1,25.0131,10\nP2,25.0601,-5\nP3,24.98,0\n";
const ROWS: &str = "part_id,delta_cd_rack_over_roller_mm,delta_cd_rack_pitch_mm,range_lower_mm,range_upper_mm,rss_lower_mm,rss_upper_mm,margin_mm,verdict,reason\n\
                    P1,0.013100,0.013737,-0.000637,0.026837,,,0.023163,pass,\n\
                    P2,0.060100,0.006869,0.053231,0.066969,,,-0.016969,fail,ΔCD (worst case) is 0.0170 mm above the limit 0.05 mm\n\
                    P3,-0.020000,0.000000,-0.020000,-0.020000,,,0.030000,pass,\n";

fn batch(arguments: &[&str], input: &[u8]) -> Output {
    with_input(&[&["batch"], arguments].concat(), input)
}

/// A file of its own for one test.
fn path(name: &str) -> String {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("batch");
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    folder.join(name).to_str().expect("the path is UTF-8").to_owned()
}

/// A part with tolerances of ±0 has no statistical sum and is judged by its worst case, as `eval` does.
#[test]
fn a_part_without_anything_that_scatters_has_no_statistical_sum() {
    let (spec, table) = (path("scatters.toml"), path("scatters.csv"));
    let each = "[errors]\nrack_over_roller = { extent = \"each\" }\n[limits]\ncenter_distance = \"±0.01\"\n";
    std::fs::write(&spec, each).expect("written");
    std::fs::write(&table, "part_id,rack_over_roller [mm]\nA,0.005\nB,0\n").expect("written");
    let ended = batch(&[&spec, &table, "--stack", "rss", "-f", "json"], b"");
    let rows: serde_json::Value =
        serde_json::from_slice(&ended.stdout).unwrap_or_else(|_| panic!("{}", text(&ended.stderr)));
    let row = |index: usize| {
        let row = &rows[index];
        (row["rss_upper_mm"].as_f64(), row["margin_mm"].as_f64(), row["verdict"].clone())
    };
    assert_eq!(row(0), (Some(0.005), Some(0.005), "pass".into()));
    assert_eq!(row(1), (None, Some(0.01), "pass".into()));
}

#[test]
fn bad_rows_are_reported_kept_and_counted() {
    let rejects = path("rejects.csv");
    let table =
        "part_id,over_roller,dp [µm]\nP1,25,0\nP2,abc,0\n\nP3,25\n\"P\n4\",,0\nP5,25,1,2\nP6,25,\"nan\"\nP7,25,0\n";
    let output = batch(&[SPEC, "-", "--rejects", &rejects], table.as_bytes());
    let messages = text(&output.stderr);
    for line in [
        "<stdin>:3: error[bad-row]: record 2 (part P2), column `over_roller`: `abc` is not a number alone",
        "<stdin>:5: error[bad-row]: record 3 (part P3), column `dp [µm]`: there is no value for rack pitch: a part is judged by all its values",
        "<stdin>:6: error[bad-row]: record 4 (part P\\u000a4), column `over_roller`: there is no value for rack over-roller: a part is judged by all its values",
        "<stdin>:8: error[bad-row]: record 5: `2` stands in column 4, which has no heading: ignore = [\"column 4\"] leaves it out: `P5 25 1 2`",
        "<stdin>:9: error[bad-row]: record 6 (part P6), column `dp [µm]`: there is no value for rack pitch (`nan`): a part is judged by all its values",
        "7 rows: 2 pass, 0 fail, 5 rejected; 1 blank line",
    ] {
        assert!(messages.lines().any(|message| message == line), "{line}\n{messages}");
    }
    assert_eq!(output.status.code(), Some(2));
    let kept = std::fs::read_to_string(&rejects).unwrap();
    let expected = "part_id,over_roller,dp [µm]\nP2,abc,0\nP3,25\n\"P\n4\",,0\nP5,25,1,2\nP6,25,\"nan\"\n";
    assert_eq!(kept, expected);
    let strict = batch(&[SPEC, "--strict"], table.as_bytes());
    assert_eq!(strict.status.code(), Some(2));
    assert!(text(&strict.stderr).contains("2 rows: 1 pass, 0 fail, 1 rejected"), "{}", text(&strict.stderr));
    assert_eq!(text(&strict.stdout).lines().count(), 2);
    let (rows, junit) = (path("strict.csv"), path("strict.xml"));
    std::fs::write(&rows, "old").unwrap();
    let summary = batch(&[SPEC, "--strict", "--summary", "--format", "json", "--junit", &junit], table.as_bytes());
    let summary: serde_json::Value = serde_json::from_slice(&summary.stdout).expect("the summary is JSON");
    assert_eq!((&summary["complete"], &summary["interrupted"]), (&false.into(), &false.into()));
    assert!(std::fs::read_to_string(&junit).unwrap().contains("type=\"incomplete\""));
    let strict = batch(&[SPEC, "--strict", "-o", &rows], table.as_bytes());
    assert!(text(&strict.stderr).contains("strict.csv.partial"), "{}", text(&strict.stderr));
    assert_eq!(std::fs::read_to_string(&rows).unwrap(), "old");
    let unclosed = batch(&[SPEC], b"part_id,over_roller,dp\nP1,25,0\nP2,\"25,0\n");
    assert_eq!(unclosed.status.code(), Some(2));
    assert!(
        text(&unclosed.stderr).contains(":3: error[bad-row]: record 2: a quote is not closed"),
        "{}",
        text(&unclosed.stderr)
    );
    // in the code of the table, too
    batch(&[SPEC, "--rejects", &rejects], &utf16(table, false));
    assert_eq!(std::fs::read(&rejects).unwrap(), utf16(expected, false));
}

/// Rows behind the one that ends a run are in no count and in no statistics, however many workers have read on.
#[test]
fn statistics_end_where_the_run_does() {
    let mut table = "part_id,over_roller,dp\nP0,abc,0\n".to_owned();
    for row in 0..100_000 {
        let _ = writeln!(table, "P{row},25.01,0");
    }
    let options = [SPEC, "--strict", "--summary", "--format", "json", "--threads", "4"];
    let output = batch(&options, table.as_bytes());
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).expect("the summary is JSON");
    assert_eq!(summary["counts"]["rows"], 1, "{summary}");
    for quantity in summary["results"].as_array().unwrap() {
        assert_eq!(quantity["count"], 0, "{quantity}");
    }
}

#[test]
fn many_bad_rows_are_counted_and_some_shown() {
    let mut table = TABLE.to_owned();
    for row in 0..5000 {
        let _ = writeln!(table, "X{row},?,0");
    }
    let output = batch(&[SPEC, "--only-failures", "--columns", "part_id"], table.as_bytes());
    let messages = text(&output.stderr);
    assert_eq!(messages.matches("error[bad-row]").count(), 10, "{messages}");
    assert!(messages.contains("… and 4,990 more rejected"), "{messages}");
    assert!(messages.contains("5,003 rows: 2 pass, 1 fail, 5,000 rejected"), "{messages}");
    assert_eq!(text(&output.stdout), "part_id\nP2\n");
}

#[test]
fn what_a_message_shows_of_a_field_is_short_and_as_written() {
    let long = "x".repeat(200_000);
    let escape = '\u{1b}';
    let table = format!("part_id;over_roller;dp\nA;{long};0\nB;{escape}[31m7;0\nC;25,01;0\nD;25,0 {long};0\n");
    let output = batch(&[SPEC, "--columns", "part_id"], table.as_bytes());
    let messages = text(&output.stderr);
    assert!(messages.len() < 1500 && !messages.contains(escape), "{messages}");
    assert!(messages.contains(&format!("`{}…` is not a number", &long[..60])), "{messages}");
    assert!(messages.contains("`\\u001b[31m7` is not a number alone\n"), "{messages}");
    let comma = batch(&[SPEC, "--decimal", "comma"], b"part_id;over_roller;dp\nA;25,01;0\nB;1,2,3;0\n");
    let messages = text(&comma.stderr);
    assert!(messages.contains("`1,2,3` is not a number with a decimal comma\n"), "{messages}");
}

#[test]
fn a_table_of_no_row_or_one_is_summed_up_in_plain_words() {
    let none = batch(&[SPEC, "--summary"], b"part_id,over_roller,dp\n");
    assert!(
        text(&none.stderr).contains("there is no part in the tables, so none was checked"),
        "{}",
        text(&none.stderr)
    );
    assert_eq!(none.status.code(), Some(2));
    let one = batch(&[SPEC, "--summary"], b"part_id,over_roller,dp\nA,25,0\n");
    let page = text(&one.stdout);
    assert!(page.contains("\n1 part is too few for capability indices"), "{page}");
    assert!(
        page.ends_with(
            "PASS: the part is inside the limits if the error-free pair has ΔCD = 0 (judged by the worst case)\n"
        ),
        "{page}"
    );
}

#[test]
#[cfg(unix)]
fn ctrl_c_ends_with_what_is_there() {
    let mut child = rackmesh(&["batch", SPEC, "--summary", "--format", "json"]).spawn().expect("the program starts");
    let mut stdin = child.stdin.take().expect("stdin is piped");
    let mut table = "part_id,over_roller,dp\n".to_owned();
    for row in 0..60_000 {
        let _ = writeln!(table, "P{row},25.01,0");
    }
    stdin.write_all(table.as_bytes()).unwrap();
    stdin.flush().unwrap();
    // the pipe stays open: only the signal can end it
    std::thread::sleep(std::time::Duration::from_millis(700));
    let signal = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill is there");
    assert!(signal.success());
    let mut summary = String::new();
    child.stdout.take().expect("stdout is piped").read_to_string(&mut summary).expect("stdout is read");
    assert_eq!(child.wait().expect("the program ends").code(), Some(130));
    drop(stdin);
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("the summary is JSON");
    assert_eq!((&summary["interrupted"], &summary["complete"]), (&true.into(), &false.into()));
    let rows = summary["counts"]["rows"].as_u64().expect("a count");
    assert!(rows > 0 && rows <= 60_000, "{rows}");
    assert_eq!(summary["counts"]["pass"], rows);
    assert_eq!(summary["results"][0]["count"], rows);
}

/// cos β_b / (2 sin α_n) = 1.341678 at α_n = 20°, β_p = 25°; without its part f_Hβ is the rack's.
#[test]
fn a_lead_of_the_pinion_has_its_column() {
    let spec = path("pinion-lead.toml");
    let text_of = |columns: &str| {
        format!(
            "[pair]\nnormal_pressure_angle = 20\n[pinion]\nhelix_angle = 25\n[limits]\npinion_lead = \"±15 um\"\n{columns}"
        )
    };
    std::fs::write(&spec, text_of("")).expect("it can be written");
    let rows = "part_id,delta_cd_pinion_lead_mm,range_lower_mm,range_upper_mm,rss_lower_mm,rss_upper_mm,margin_mm,verdict,reason\n\
                P1,0.010733,-0.010733,0.010733,,,0.004267,pass,\n\
                P2,0.016100,-0.016100,0.016100,,,-0.001100,fail,ΔCD of pinion lead is 0.0011 mm above the limit 0.015 mm\n";
    let table = |name: &str| format!("part_id;{name}\nP1;8\nP2;-12\n");
    for name in ["Flankenlinienabweichung Ritzel [µm]", "pinion_lead [um]"] {
        let found = batch(&[&spec, "-"], table(name).as_bytes());
        assert_eq!((text(&found.stdout), found.status.code()), (rows, Some(1)), "{}", text(&found.stderr));
    }
    std::fs::write(&spec, text_of("[table.columns]\npinion_lead = { name = \"fHb\", unit = \"um\" }\n"))
        .expect("it can be written");
    let named = batch(&[&spec, "-"], table("fHb").as_bytes());
    assert_eq!(text(&named.stdout), rows, "{}", text(&named.stderr));
    let of_rack = batch(&[&spec, "-"], table("fHβ [mrad]").as_bytes());
    assert!(!text(&of_rack.stdout).contains("pinion_lead"), "{}", text(&of_rack.stdout));
}

#[test]
fn exit_statuses() {
    let header = "part_id,over_roller,dp\n";
    for (rows, status) in [("P1,25,0\n", 0), ("P1,25,0\nP2,26,0\n", 1), ("P1,x,0\nP2,26,0\n", 2), ("", 2)] {
        assert_eq!(batch(&[SPEC], [header, rows].concat().as_bytes()).status.code(), Some(status), "{rows}");
    }
    let near = batch(&[SPEC, "--rule", "guard=10um"], [header, "P1,25.045,0\n"].concat().as_bytes());
    assert_eq!(near.status.code(), Some(3), "{}", text(&near.stderr));
    assert_eq!(batch(&[SPEC, "no-such-file.csv"], b"").status.code(), Some(2));
    assert_eq!(batch(&[SPEC], b"").status.code(), Some(2));
    assert_eq!(batch(&[SPEC], b"a,b\n1,2\n").status.code(), Some(2));
}

#[test]
fn several_tables_and_what_pipelines_show() {
    let (first, second, third) = (path("first.csv"), path("second.csv"), path("third.csv"));
    std::fs::write(&first, TABLE).unwrap();
    // other order, other separator
    std::fs::write(&second, "dp [µm];part_id;over_roller\n10,0x;Q1;25,4\n10,0;Q2 <&>;25,4\n").unwrap();
    std::fs::write(&third, "part_id,other\nR1,1\n").unwrap();
    let junit = path("parts.xml");
    let output =
        batch(&[SPEC, &first, &third, &second, "--format", "jsonl", "--junit", &junit, "--annotations", "github"], b"");
    assert_eq!(output.status.code(), Some(2));
    let rows: Vec<serde_json::Value> =
        text(&output.stdout).lines().map(|line| serde_json::from_str(line).expect("a row is JSON")).collect();
    let of = |row: usize, name: &str| rows[row][name].clone();
    assert_eq!((of(0, "part_id"), of(0, "range_lower_mm")), ("P1".into(), (-0.000_637).into()));
    assert_eq!((of(3, "part_id"), of(3, "delta_cd_rack_over_roller_mm")), ("Q2 <&>".into(), 0.4.into()));
    assert_eq!(of(3, "verdict"), "fail");
    let messages = text(&output.stderr);
    assert!(messages.contains("there is no `over_roller`, which the contract names as rack_over_roller"), "{messages}");
    assert!(messages.contains("5 rows: 2 pass, 2 fail, 1 rejected"), "{messages}");
    assert!(
        messages.lines().any(|line| line.starts_with("::error file=") && line.contains("line=3,title=part P2::ΔCD"))
    );
    assert!(
        messages.contains(",line=2,title=record 1 rejected::record 1 (part Q1), column `dp [µm]`: `10,0x`"),
        "{messages}"
    );
    assert!(messages.contains("::error title=rackmesh batch::a table was not read to its end"), "{messages}");
    assert!(messages.contains("::notice title=rackmesh batch::5 rows: 2 pass, 2 fail"), "{messages}");
    let junit = std::fs::read_to_string(&junit).unwrap();
    assert!(junit.contains("tests=\"7\" failures=\"2\" errors=\"3\" time=\""), "{junit}");
    assert!(junit.contains("name=\"Q2 &lt;&amp;&gt;\""), "{junit}");
    // the attributes that every pipeline's schema has
    let case = junit.lines().filter(|line| line.starts_with("<testcase"));
    assert!(case.clone().all(|line| !line.contains(" file=") && !line.contains(" line=")), "{junit}");
}

#[test]
fn an_error_that_the_table_lacks_leaves_the_sum_open_everywhere() {
    let (table, junit) = (path("lacking.csv"), path("lacking.xml"));
    std::fs::write(&table, "part_id,rack_over_roller,rack_pitch [um]\nP1,25.01,3\n").unwrap();
    let run = |more: &[&str]| batch(&[&["examples/steering.toml", &table][..], more].concat(), b"");
    let open = run(&["--junit", &junit, "--annotations", "github"]);
    assert_eq!(open.status.code(), Some(2));
    let rows = text(&open.stdout);
    assert!(rows.ends_with(",,\"not judged: the spec asks for rack_lead, and the table has none\"\n"), "{rows}");
    for words in
        ["the tables lack rack_lead", "every_part = true", "--partial", "::error title=rackmesh batch::the limit"]
    {
        assert!(text(&open.stderr).contains(words), "{words}: {}", text(&open.stderr));
    }
    let junit = std::fs::read_to_string(&junit).unwrap();
    assert!(junit.contains("errors=\"1\"") && junit.contains("<error type=\"unjudged\""), "{junit}");
    let summary = run(&["--summary"]);
    assert!(text(&summary.stdout).contains("\nNo verdict: the limit on centre distance"), "{}", text(&summary.stdout));
    let json: serde_json::Value = serde_json::from_slice(&run(&["--summary", "--format", "json"]).stdout).unwrap();
    assert_eq!(json["unjudged_limits"], serde_json::json!(["center_distance"]));
    let partial = run(&["--summary", "--partial"]);
    assert_eq!(partial.status.code(), Some(0));
    assert!(text(&partial.stdout).ends_with("(judged by the worst case); judged without rack lead\n"));
}

#[test]
fn parts_with_their_teeth_go_through_the_exact_mesh() {
    let mut table = "part_id;space;over_pin_deviation [um];position_deviation [um]\n".to_owned();
    for part in ["A", "B"] {
        for space in -3..9 {
            let _ = writeln!(table, "{part};{space};{};0", if part == "A" { 10 } else { 80 });
        }
    }
    table.push_str("C;0;x;0\nC;1;0;0\nD;0;1\n");
    let rejects = path("teeth.csv");
    let arguments = ["tests/specs/teeth.toml", "--teeth", "--to", "20", "--rejects", &rejects, "--decimals", "5"];
    let output = batch(&arguments, table.as_bytes());
    let messages = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{messages}");
    // every space over by the same is a shift of the pitch line
    let rows = "part_id,mean_delta_cd_mm,min_delta_cd_mm,max_delta_cd_mm,peak_to_peak_mm,tooth_to_tooth_mm,lower_mm,upper_mm,margin_mm,verdict,reason,from_stroke_mm,to_stroke_mm\n\
                A,0.01000,0.01000,0.01000,0.00000,0.00000,0.01000,0.01000,0.05000,pass,,0.00000,20.00000\n\
                B,0.08000,0.08000,0.08000,0.00000,0.00000,0.08000,0.08000,-0.02000,fail,ΔCD is 0.0200 mm above the limit 0.06 mm,0.00000,20.00000\n";
    assert_eq!(text(&output.stdout), rows, "{messages}");
    assert!(
        messages.contains("<stdin>:26: error[bad-row]: record 25 (part C): column `over_pin_deviation [um]`: `x`"),
        "{messages}"
    );
    assert!(
        messages.contains("<stdin>:28: error[bad-row]: record 27 (part D): space 0 of the rack was not measured"),
        "{messages}"
    );
    assert!(messages.contains("4 parts: 1 pass, 1 fail, 2 rejected"), "{messages}");
    let kept = std::fs::read_to_string(&rejects).unwrap();
    assert!(kept.ends_with("[um]\nC;0;x;0\nC;1;0;0\nD;0;1\n"), "{kept}");
}

/// A table for people has what decides, an array of JSON the rows of the lines.
#[test]
fn rows_as_a_table_and_as_an_array() {
    let table = batch(&[SPEC, "--format", "table", "-q"], TABLE.as_bytes());
    let shown = " part  ΔCD from   ΔCD to   margin  limit  verdict  reason
           [mm]     [mm]     [mm]
────────────────────────────────────────────────────────────────────────────────────────────────────────
 P1     -0.0006  +0.0268  +0.0232  upper  pass
 P2     +0.0532  +0.0670  -0.0170  upper  fail     ΔCD (worst case) is 0.0170 mm above the limit 0.05 mm
 P3     -0.0200  -0.0200  +0.0300  lower  pass
";
    assert_eq!(text(&table.stdout), shown);
    let array = batch(&[SPEC, "--format", "json"], TABLE.as_bytes());
    let lines = batch(&[SPEC, "--format", "jsonl"], TABLE.as_bytes());
    let array: Vec<serde_json::Value> = serde_json::from_slice(&array.stdout).expect("an array");
    let lines = text(&lines.stdout).lines().map(|line| serde_json::from_str(line).expect("an object"));
    assert_eq!(array, lines.collect::<Vec<serde_json::Value>>());
    let none = batch(&[SPEC, "--format", "json"], b"part_id,over_roller,dp\n");
    assert_eq!(text(&none.stdout), "[]\n");
}

/// The capability of all errors together is that of the end that is nearer to its limit.
#[test]
fn capability_looks_at_both_limits() {
    for shift in [-20, 20] {
        let mut rows = "part_id,over_roller,dp\n".to_owned();
        for part in 0..40 {
            let over_roller = 25_000 + shift + part * 7 % 11;
            let _ = writeln!(rows, "P{part},{}.{:03},0.00{}", over_roller / 1000, over_roller % 1000, part % 5);
        }
        let ended = batch(&[SPEC, "--summary", "--format", "json"], rows.as_bytes());
        let json: serde_json::Value = serde_json::from_slice(&ended.stdout).expect("JSON");
        let results = json["results"].as_array().expect("results");
        let of = |name: &str, key: &str| {
            let result = results.iter().find(|result| result["name"] == name).expect(name);
            result.pointer(key).and_then(serde_json::Value::as_f64).expect(key)
        };
        let index = |name, sign: f64| (0.05 - sign * of(name, "/mean_mm")) / (3.0 * of(name, "/standard_deviation_mm"));
        let (lower, upper) = (index("range_lower_mm", -1.0), index("range_upper_mm", 1.0));
        let ppk = json["capability"]["ppk"]["value"].as_f64().expect("an index");
        assert!((ppk - lower.min(upper)).abs() < 1e-9 * ppk && (lower < upper) == (shift < 0), "{ppk} {lower} {upper}");
        assert!((of("range_lower_mm", "/ppk/value") - lower).abs() < 1e-9 * lower);
    }
}

/// Whoever looks at the first line only gets the verdict of all parts, and the other files.
#[test]
fn a_reader_that_has_seen_enough_changes_no_verdict() {
    let (table, junit, rejects) = (path("long.csv"), path("closed.xml"), path("closed.csv"));
    let mut rows = "part_id,over_roller,dp\n".to_owned();
    for row in 0..20_000 {
        let _ = writeln!(rows, "P{row},25,0");
    }
    for (last, status) in [("P,26,0\n", 1), ("P,x,0\n", 2), ("P,25,0\n", 0)] {
        std::fs::write(&table, rows.clone() + last).unwrap();
        let _ = std::fs::remove_file(&junit);
        let arguments = ["batch", SPEC, &table, "--quiet", "--junit", &junit, "--rejects", &rejects];
        let mut child = rackmesh(&arguments).spawn().expect("the program starts");
        drop(child.stdout.take());
        let ended = child.wait_with_output().expect("the program ends");
        assert_eq!(ended.status.code(), Some(status), "{}", text(&ended.stderr));
        assert!(!text(&ended.stderr).to_lowercase().contains("pipe"), "{}", text(&ended.stderr));
        assert!(std::fs::read_to_string(&junit).unwrap().contains("name=\"rows\" value=\"20001\""));
        assert_eq!(std::fs::read_to_string(&rejects).unwrap().contains("P,x,0"), status == 2);
    }
}

/// What files say where the spec is silent holds for their own parts only.
#[test]
fn files_with_limits_of_their_own_are_not_judged_together() {
    let spec = path("silent.toml");
    std::fs::write(&spec, "[pair]\nnormal_pressure_angle = 20\n").unwrap();
    let file = |name: &str, more: &str| {
        let header = "K0100 1\nK2002/1 Teilungsabweichung Zahnstange\nK2142/1 um\n";
        std::fs::write(path(name), format!("{header}{more}\n10\u{14}0\n")).unwrap();
        path(name)
    };
    let (wide, narrow) = (file("wide.dfq", "K2111/1 20"), file("narrow.dfq", "K2111/1 5"));
    assert_eq!(batch(&[&spec, &wide, &wide], b"").status.code(), Some(0));
    assert_eq!(batch(&[&spec, &narrow], b"").status.code(), Some(1));
    let refused = batch(&[&spec, &wide, &narrow], b"");
    let said = "wide.dfq and ";
    assert!(text(&refused.stderr).contains(said) && text(&refused.stderr).contains("limits of its ΔCD at most"));
    assert_eq!(refused.status.code(), Some(2));
    let (sure, unsure) = (file("sure.dfq", "K2106/1 1"), file("unsure.dfq", "K2106/1 10"));
    let refused = batch(&[&spec, &sure, &unsure, "--rule", "iso14253"], b"");
    assert!(text(&refused.stderr).contains("standard uncertainties 0.0005 and 0.005"), "{}", text(&refused.stderr));
    assert_eq!(refused.status.code(), Some(2));
}
