//! What a signal leaves: a block that is typed, racks, strokes, a page.

use super::*;

/// What is typed once the terminal shows something.
#[cfg(target_os = "linux")]
struct Step {
    shown: &'static str,
    typed: &'static str,
}

/// What a terminal shows of a command that is given this, and of the shell that reads on behind it.
#[cfg(target_os = "linux")]
fn on_terminal(arguments: &str, steps: &[Step]) -> String {
    let program = env!("CARGO_BIN_EXE_rackmesh");
    let shell = format!(
        "trap : INT; read go; '{program}' {arguments}; echo \"exit $?\"; while read line; do echo \"shell: $line\"; done"
    );
    let mut child = Command::new("script")
        .args(["--quiet", "--command", &shell, "/dev/null"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("script is there");
    let mut keys = child.stdin.take().expect("stdin is piped");
    let mut screen = child.stdout.take().expect("stdout is piped");
    let mut shown = Vec::new();
    for Step { shown: wanted, typed } in steps {
        while !String::from_utf8_lossy(&shown).contains(wanted) {
            let mut byte = [0];
            screen.read_exact(&mut byte).unwrap_or_else(|_| panic!("{wanted}: {}", String::from_utf8_lossy(&shown)));
            shown.extend(byte);
        }
        keys.write_all(typed.as_bytes()).expect("the terminal takes keys");
    }
    screen.read_to_end(&mut shown).expect("the terminal ends");
    assert!(child.wait().expect("the shell ends").success());
    String::from_utf8(shown).expect("the terminal shows UTF-8")
}

#[test]
#[cfg(target_os = "linux")]
fn a_page_is_not_for_a_terminal() {
    let steps = [Step { shown: "", typed: "go\n" }, Step { shown: "exit ", typed: "\x04" }];
    let shown = on_terminal("report examples/minimal.toml", &steps);
    assert!(shown.contains("-o page.html") && shown.contains("exit 2") && !shown.contains("<html"), "{shown}");
}

#[test]
#[cfg(target_os = "linux")]
fn ctrl_c_before_anything_is_typed_is_no_empty_block() {
    let steps = [
        Step { shown: "", typed: "go\n" },
        Step { shown: "Paste the values", typed: "\x03" },
        Step { shown: "exit ", typed: "\x04" },
    ];
    let shown = on_terminal("paste examples/minimal.toml", &steps);
    assert!(shown.contains("interrupted before there was a result") && shown.contains("exit 130"), "{shown}");
    assert!(!shown.contains("error"), "{shown}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_block_that_is_typed_ahead_is_not_left_for_the_shell() {
    for (arguments, reason) in [
        ("paste no-such-file.toml", "cannot read no-such-file.toml"),
        ("paste examples/minimal.toml --set errors.x=1", "has no key `x`"),
        ("paste examples/minimal.toml -o values.doc", "values.doc"),
    ] {
        let typed = "go\nover roller: 25.012 mm\n\ndp 12\n\x04after\n\x04";
        let shown = on_terminal(arguments, &[Step { shown: "", typed }]);
        assert!(shown.contains(reason) && shown.contains("exit 2"), "{shown}");
        assert_eq!(shown.matches("shell: ").count(), 1, "{shown}");
        assert!(shown.contains("shell: after"), "{shown}");
    }
    // who has typed nothing is not waited for
    let steps = [Step { shown: "", typed: "go\n" }, Step { shown: "exit 2", typed: "\x04" }];
    let shown = on_terminal("paste no-such-file.toml", &steps);
    assert!(!shown.contains("is not used"), "{shown}");
}

#[cfg(unix)]
fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill is there");
    assert!(status.success());
}

#[cfg(unix)]
fn pause() {
    std::thread::sleep(std::time::Duration::from_millis(500));
}

/// Waits until the program sees signals itself, where the system tells, and then for some of its work.
#[cfg(unix)]
fn pause_at_work(child: &Child) {
    const SIGINT: u64 = 1 << 1;
    let status = format!("/proc/{}/status", child.id());
    let sees_signals = |status: &str| {
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        caught.is_none_or(|mask| u64::from_str_radix(mask.trim(), 16).is_ok_and(|mask| mask & SIGINT != 0))
    };
    while std::fs::read_to_string(&status).is_ok_and(|status| !sees_signals(&status)) {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    pause();
}

#[test]
#[cfg(unix)]
fn racks_that_a_signal_ends_are_shown_and_said_to_be_some() {
    let run = |signal: &str, format: &str| {
        let arguments = ["monte-carlo", "examples/scatter.toml", "--racks", "300000", "--format", format];
        let child = rackmesh(&arguments).spawn().expect("the program starts");
        pause_at_work(&child);
        send(signal, &child);
        child.wait_with_output().expect("the program ends")
    };
    for (signal, status) in [("-INT", 130), ("-TERM", 143)] {
        let output = run(signal, "json");
        assert_eq!(output.status.code(), Some(status), "{signal}: {}", text(&output.stderr));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("the output is JSON");
        assert_eq!((&json["interrupted"], &json["verdict"]), (&true.into(), &serde_json::Value::Null));
        assert!(json["racks"].as_u64().is_some_and(|racks| 0 < racks && racks < 300_000), "{}", json["racks"]);
    }
    let table = run("-INT", "table");
    assert!(text(&table.stdout).contains("of the 300000 racks asked for"), "{}", text(&table.stdout));
    assert!(!text(&table.stdout).contains("PASS"), "{}", text(&table.stdout));
    let csv = run("-INT", "csv");
    assert!(text(&csv.stderr).contains("of 300000 racks"), "{}", text(&csv.stderr));
}

/// Ranges in files, merged in any order: the JSON of one run, bit for bit; the CSV of two ranges is that of one.
#[test]
fn racks_in_ranges_are_one_run() {
    let folder = Folder::new("ranges");
    let (spec, all) = ("examples/scatter.toml", folder.path("all.json"));
    let racks = |more: &[&str]| run(&[&["monte-carlo", spec], more].concat(), "");
    let range = |first: &str, count: &str, threads: &str| {
        let file = folder.path(&format!("{first}.json"));
        let ended = racks(&["--first-rack", first, "--racks", count, "--study", &file, "-j", threads, "-f", "csv"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        (file, ended.stdout)
    };
    let (one, [a, b, c]) = (
        racks(&["--racks", "90", "-f", "json"]),
        [("0", "17"), ("17", "43"), ("60", "30")].map(|(first, count)| range(first, count, "2")),
    );
    let csv = racks(&["--racks", "90", "-f", "csv", "-j", "1"]).stdout;
    let behind_header = |csv: &str| csv.split_once('\n').expect("there is a header").1.to_owned();
    assert_eq!(csv, a.1.clone() + &behind_header(&b.1) + &behind_header(&c.1));
    let merged = racks(&["--merge", &c.0, &a.0, &b.0, "-f", "json", "--study", &all]);
    assert_eq!((merged.code, &merged.stdout), (one.code, &one.stdout), "{}", merged.stderr);
    assert_eq!(racks(&["--merge", &all, "-f", "json"]).stdout, one.stdout);

    // a gap, told and counted; also one behind the last range
    let gap = racks(&["--merge", &a.0, &c.0, "-f", "json"]);
    assert_eq!(gap.code, Some(2), "{}", gap.stderr);
    let gap = gap.json();
    assert_eq!(
        (&gap["verdict"], &gap["interrupted"], &gap["racks"]),
        (&serde_json::Value::Null, &true.into(), &47.into())
    );
    assert_eq!(gap["missing"], serde_json::json!([{ "first_rack": 17, "racks": 43 }]));
    let behind = racks(&["--merge", &all, "--racks", "100"]);
    assert_eq!(behind.code, Some(2));
    assert!(behind.stdout.contains("missing: racks 90 … 99") && !behind.stdout.contains("PASS"), "{}", behind.stdout);

    let refused = |more: &[&str], says: &str| {
        let ended = racks(more);
        assert!(ended.code == Some(2) && ended.stderr.contains(says), "{} {}", ended.stdout, ended.stderr);
    };
    refused(&["--merge", &all, &a.0], "racks 0 … 16");
    refused(&["--merge", &a.0, "--racks", "5"], "are asked for");
    refused(&["--merge", &a.0, "--set", "scatter.rack_pitch=5um"], "fingerprint");
    refused(&["--merge", &a.0, "--study", &a.0], "written over");
    refused(&["--merge", spec], "cannot read the study");
    let seed = folder.path("seed.json");
    refused(&["--racks", "1", "--study", &seed, "--plot", &seed], "are the same file");
    assert_eq!(racks(&["--first-rack", "90", "--racks", "1", "--seed", "9", "--study", &seed]).code, Some(0));
    refused(&["--merge", &a.0, &seed], "the seed is");
    let text = std::fs::read_to_string(&a.0).expect("the study is there");
    std::fs::write(&seed, text.replacen("\"racks\":17", "\"racks\":16", 1)).expect("it can be written");
    refused(&["--merge", &seed], "damaged");
    std::fs::write(&seed, text.replacen(",\"inside\":17", "", 1)).expect("it can be written");
    refused(&["--merge", &seed], "damaged");
    refused(&["--first-rack", "18446744073709551615", "--racks", "2"], "for numbers that do not end beyond");
}

/// A rack that cannot be solved ends the run with its error; those before it are shown and kept.
#[test]
fn racks_before_one_that_fails_are_kept() {
    let folder = Folder::new("failing-rack");
    let file = folder.path("study.json");
    let racks = |more: &[&str]| {
        let wide = ["monte-carlo", "examples/scatter.toml", "--set", "scatter.rack_pitch=0.7 mm", "-f", "json"];
        run(&[&wide, more].concat(), "")
    };
    let ended = racks(&["--racks", "60", "--study", &file]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("error[no-mesh]: rack 25:"), "{}", ended.stderr);
    let shown = ended.json();
    assert_eq!((&shown["racks"], &shown["interrupted"]), (&25.into(), &true.into()));
    let kept = racks(&["--merge", &file]);
    assert_eq!(kept.json()["delta_cd"], shown["delta_cd"], "{}", kept.stderr);
}

#[test]
#[cfg(unix)]
fn strokes_that_a_signal_ends_are_whole_json_and_said_to_be_some() {
    let strokes = ["mesh", "examples/mesh.toml", "--points", "100000000", "--format", "json"];
    let mut child = rackmesh(&strokes).spawn().expect("the program starts");
    let mut json = vec![0; 100];
    let mut stdout = child.stdout.take().expect("stdout is piped");
    stdout.read_exact(&mut json).expect("there are points");
    send("-TERM", &child);
    stdout.read_to_end(&mut json).expect("stdout is read");
    assert_eq!(child.wait().expect("the program ends").code(), Some(143));
    let json: serde_json::Value = serde_json::from_slice(&json).expect("the output is JSON");
    assert_eq!(json["interrupted"], true);
    assert!(json["points"].as_array().is_some_and(|points| !points.is_empty()));
}

#[test]
#[cfg(unix)]
fn a_simulation_that_a_signal_ends_is_shown_up_to_there() {
    let arguments = ["simulate", "examples/mesh.toml", "--spacing", "0.0001", "--format", "json"];
    let mut child = rackmesh(&arguments).spawn().expect("the program starts");
    pause_at_work(&child);
    send("-INT", &child);
    let mut stdout = Vec::new();
    child.stdout.take().expect("stdout is piped").read_to_end(&mut stdout).expect("stdout is read");
    assert_eq!(child.wait().expect("the program ends").code(), Some(130));
    let json: serde_json::Value = serde_json::from_slice(&stdout).expect("the output is JSON");
    assert_eq!(json["end"], "interrupted");
}

/// A program that waits for its reader does not see the first signal; the second ends it all the same.
#[test]
#[cfg(unix)]
fn a_second_signal_ends_at_once() {
    for (signal, status) in [("-INT", 130), ("-TERM", 143)] {
        let strokes = ["mesh", "examples/mesh.toml", "--points", "100000000", "--format", "csv"];
        let mut child = rackmesh(&strokes).spawn().expect("the program starts");
        pause_at_work(&child);
        send("-INT", &child);
        pause();
        assert_eq!(child.try_wait().expect("the program is known"), None);
        send(signal, &child);
        assert_eq!(child.wait().expect("the program ends").code(), Some(status));
    }
}

#[test]
#[cfg(unix)]
fn a_picture_of_a_run_that_did_not_end_has_a_name_of_its_own() {
    let folder = Folder::new("partial");
    let picture = folder.path("run.svg");
    std::fs::write(&picture, "old").expect("the file can be written");
    let arguments = ["simulate", "examples/mesh.toml", "--spacing", "0.0001", "--plot", &picture];
    let child = rackmesh(&arguments).spawn().expect("the program starts");
    pause_at_work(&child);
    send("-INT", &child);
    let output = child.wait_with_output().expect("the program ends");
    assert_eq!(output.status.code(), Some(130));
    let messages = text(&output.stderr);
    assert!(messages.contains("run.svg.partial shows what was computed"), "{messages}");
    assert_eq!(std::fs::read_to_string(&picture).expect("the old picture is there"), "old");
    let partial = std::fs::read_to_string(folder.path("run.svg.partial")).expect("the other one is there, too");
    assert!(partial.starts_with("<svg"), "{partial}");
}

/// Whoever ends a run before its first result is told that there is none; the files that pipelines read say so, too.
#[test]
#[cfg(unix)]
fn a_run_that_a_signal_ends_before_its_first_result_says_so() {
    let folder = Folder::new("no-result");
    let (junit, pipe) = (folder.path("parts.xml"), folder.path("parts.csv"));
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo is there").success());
    let spec = "tests/specs/batch.toml";
    let [summary, rows] = [&["--summary", "-f", "json", "--junit", &junit][..], &["--junit", &junit]];
    let cases = [
        ("batch", "-", summary),
        ("batch", &pipe, summary),
        ("batch", &pipe, rows),
        ("paste", "-", &[]),
        ("paste", &pipe, &[]),
        ("read", &pipe, &[]),
    ];
    for ((command, file, more), (signal, status)) in cases.iter().zip([("-INT", 130), ("-TERM", 143)].iter().cycle()) {
        std::fs::write(&junit, "old").expect("it can be written");
        let child = rackmesh(&[&[command, spec, file], *more].concat()).spawn().expect("it starts");
        pause_at_work(&child);
        send(signal, &child);
        let ended = child.wait_with_output().expect("the program ends");
        let (stdout, stderr) = (text(&ended.stdout), text(&ended.stderr));
        assert_eq!(ended.status.code(), Some(*status), "{command} {file}: {stderr}");
        assert!(stderr.contains("interrupted before there was a result"), "{command} {file}: {stderr}");
        if *command == "batch" {
            let junit = std::fs::read_to_string(&junit).expect("the report is there");
            assert!(junit.contains("the run was interrupted") && junit.contains("errors=\"1\""), "{junit}");
        }
        if *more == summary {
            let summary: serde_json::Value = serde_json::from_str(stdout).expect("the summary is JSON");
            let facts = (&summary["interrupted"], &summary["complete"], &summary["verdict"]);
            assert_eq!(facts, (&true.into(), &false.into(), &serde_json::Value::Null));
        }
    }
}

/// The old page stays, and what was computed stands beside it.
#[test]
#[cfg(unix)]
fn a_report_that_a_signal_ends_leaves_the_old_page() {
    let folder = Folder::new("interrupted-report");
    let (table, page) = (folder.path("lot.csv"), folder.path("lot.html"));
    let rows = (0..1_500_000).map(|row| format!("P{row},25.01,0\n")).collect::<Vec<_>>().concat();
    std::fs::write(&table, "part_id,over_roller,dp\n".to_owned() + &rows).expect("it can be written");
    std::fs::write(&page, "old").expect("it can be written");
    let partial = folder.path("lot.html.partial");
    // a signal before the first row finds nothing to keep
    for pauses in 0..24 {
        let mut child =
            rackmesh(&["report", "tests/specs/batch.toml", &table, "-o", &page]).spawn().expect("it starts");
        pause_at_work(&child);
        (0..pauses).for_each(|_| pause());
        send("-INT", &child);
        let mut messages = String::new();
        child.stderr.take().expect("stderr is piped").read_to_string(&mut messages).expect("stderr is read");
        let code = child.wait().expect("the program ends").code();
        if code == Some(0) {
            // it was done before the signal
            std::fs::write(&page, "old").expect("it can be written");
            continue;
        }
        assert_eq!(code, Some(130), "{messages}");
        assert_eq!(std::fs::read_to_string(&page).expect("the page is there"), "old");
        if let Ok(kept) = std::fs::read_to_string(&partial) {
            assert!(messages.contains("lot.html.partial") && kept.contains("incomplete"), "{messages}");
            return;
        }
    }
    panic!("nothing is kept");
}
