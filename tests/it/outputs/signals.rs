//! What a signal leaves of a file that is written.

use super::*;

fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill is there");
    assert!(status.success());
}

const SIGNALS: [(&str, i32); 3] = [("-INT", 130), ("-TERM", 143), ("-HUP", 129)];

/// Whether whoever started the tests has this signal ignored, which then holds for all.
fn is_ignored(signal: &str) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:").map(str::trim));
    signal == "-HUP" && mask.and_then(|mask| u64::from_str_radix(mask, 16).ok()).is_some_and(|mask| mask & 1 == 1)
}

/// Waits until the program sees signals, and then for some of its work.
fn wait_for_work(child: &Child) {
    let sees = |status: &str| {
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        caught.is_none_or(|mask| u64::from_str_radix(mask.trim(), 16).is_ok_and(|mask| mask & 2 != 0))
    };
    while fs::read_to_string(format!("/proc/{}/status", child.id())).is_ok_and(|status| !sees(&status)) {
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_millis(300));
}

/// Sends a signal to a command that would go on for long: it ends in time with the signal's status, and says so.
fn ends(mut child: Child, (signal, status): (&str, i32), what: &str) -> String {
    // a second, and as much for a machine that does other things
    const LONGEST: Duration = Duration::from_secs(2);
    // what it writes is not to wait for a reader
    let mut stdout = child.stdout.take().expect("stdout is piped");
    let reader = std::thread::spawn(move || std::io::copy(&mut stdout, &mut std::io::sink()));
    wait_for_work(&child);
    assert_eq!(child.try_wait().unwrap(), None, "{what}: it has ended by itself");
    let sent = Instant::now();
    send(signal, &child);
    let ended = child.wait().unwrap();
    let took = sent.elapsed();
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    reader.join().unwrap().unwrap();
    assert_eq!(ended.code(), Some(status), "{what} {signal}: {said}");
    assert!(took < LONGEST, "{what} {signal}: {took:?}");
    said
}

/// A signal before the first result, where a file that is read or written is a pipe that has no other end.
#[test]
fn an_interrupted_command_leaves_the_old_file() {
    for (written, signal) in tried().zip(SIGNALS.iter().cycle()).filter(|(_, signal)| !is_ignored(signal.0)) {
        let tried = Tried::new(written, "interrupted");
        let what = format!("{} {}", written.command, written.id);
        let pipe = if written.line.contains("SPEC") { tried.folder.join("spec.toml") } else { tried.out() };
        let _ = fs::remove_file(&pipe);
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        if pipe != tried.out() {
            fs::write(tried.out(), OLD).unwrap();
        }
        let before = tried.names();
        let said = ends(tried.command("", &tried.out()).spawn().unwrap(), *signal, &what);
        assert!(said.contains("interrupted before there was a result"), "{what}: {said}");
        if pipe != tried.out() {
            tried.holds(&before, "interrupted");
        }
        if written.id == "junit" {
            let report = fs::read_to_string(tried.out()).unwrap();
            assert!(report.contains("the run was interrupted") && report.contains("errors=\"1\""), "{report}");
        }
    }
}

/// What makes a command long, whatever it does there.
#[test]
fn a_signal_is_obeyed_wherever_the_time_goes() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("outputs-long");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    for pipe in ["rack.csv", "pipe.csv", "pipe.svg"] {
        assert!(Command::new("mkfifo").arg(path(pipe)).status().unwrap().success());
    }
    let spec = fs::read_to_string("examples/mesh.toml").unwrap();
    let (start, end) = (spec.find("[[rack.deviation]]").unwrap(), spec.find("[limits]").unwrap());
    let measured = (spec[..start].to_owned() + &spec[end..]).replace("[rack]", "[rack]\nmeasured = \"rack.csv\"");
    fs::write(path("measured.toml"), measured).unwrap();
    let rows = |from: u32, to: u32| (from..to).map(|row| format!("P{row},{}\n", row % 13)).collect::<Vec<_>>().concat();
    for (name, column) in [("parts.csv", "rack_pitch"), ("pinions.csv", "pinion_pitch")] {
        fs::write(path(name), format!("part_id,{column} [um]\n{}", rows(0, 20_000))).unwrap();
    }
    let commands = [
        "batch examples/mesh-errors.toml parts.csv --worst-teeth --partial -o rows.csv --junit report.xml",
        "batch examples/steering.toml parts.csv --partial -o pipe.csv",
        "batch examples/steering.toml pipe.csv --partial -o other.csv",
        "batch measured.toml pinions.csv --partial -o other.csv",
        "batch examples/uncertain.toml parts.csv --partial --monte-carlo 1000000 -o other.csv",
        "mesh measured.toml",
        "mesh examples/mesh.toml --plot pipe.svg",
        "mesh examples/mesh.toml --to 1e6",
        "mesh examples/mesh.toml --points 100000000 --format csv",
        "mesh examples/mesh.toml --points 100000000 --format json",
        "simulate examples/mesh.toml --step 0.0001 --plot run.svg",
        "simulate examples/mesh.toml --step 0.00001 --quasi-static",
        "monte-carlo examples/scatter.toml --racks 1000000 --study study.json",
        "monte-carlo examples/scatter.toml --racks 100 --to 100000",
        "monte-carlo examples/scatter.toml --racks 1000 --from 0 --to 2000 --contributions",
        "eval measured.toml",
        "sweep examples/mesh.toml --over=simulation.preload=1..900:1 --of simulate -o rows.csv --plot run.svg",
        "eval examples/uncertain.toml --monte-carlo 100000000",
        "measure examples/mesh.toml --last 5000000 --format csv",
        "report measured.toml -o page.html",
        "report examples/mesh.toml --to 1e6 -o page.html",
        "read pipe.csv",
        "paste examples/steering.toml pipe.csv -o page.html",
        "reproduce",
    ];
    for (line, signal) in commands.iter().zip(SIGNALS.iter().cycle()).filter(|(_, signal)| !is_ignored(signal.0)) {
        let _ = fs::write(path("study.json"), OLD);
        let mut command = Command::new(env!("CARGO_BIN_EXE_rackmesh"));
        let is_here = |word: &str| {
            word.starts_with(|c: char| c.is_ascii_alphabetic()) && !word.starts_with("examples/") && word.contains('.')
        };
        let words = line.split(' ').map(|word| if is_here(word) { path(word) } else { word.to_owned() });
        command.args(words).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        ends(command.spawn().unwrap(), *signal, line);
        assert_eq!(fs::read_to_string(path("study.json")).unwrap(), OLD, "{line}");
    }
    let report = fs::read_to_string(path("report.xml")).unwrap();
    assert!(report.contains("the run was interrupted"), "{report}");
    let complete = ["rows.csv", "other.csv", "page.html", "run.svg"].map(|name| folder.join(name).exists());
    assert_eq!(complete, [false; 4]);
    let names = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(names.filter(|name| name.starts_with('.')).count(), 0);
    fs::remove_dir_all(&folder).unwrap();
}

/// What an interrupted run has made stands beside the old file, whole as far as it goes.
#[test]
fn what_an_interrupted_run_has_made_is_kept() {
    /// A slow machine has made nothing after a second.
    const PAUSES: [u64; 6] = [0, 1, 2, 4, 8, 16];
    let kept = |written: &'static Written, line: &str, is_whole: fn(&str) -> bool| {
        let tried = Tried::new(written, "kept");
        let partial = tried.folder.join(format!("{}.partial", written.file));
        for pause in PAUSES {
            fs::write(tried.out(), OLD).unwrap();
            let mut command = Command::new(env!("CARGO_BIN_EXE_rackmesh"));
            command.args(line.split(' ')).arg(tried.out());
            let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
            wait_for_work(&child);
            std::thread::sleep(Duration::from_secs(pause));
            ends(child, SIGNALS[1], line);
            assert_eq!(fs::read_to_string(tried.out()).unwrap(), OLD, "{line}");
            if let Ok(made) = fs::read_to_string(&partial) {
                assert!(is_whole(&made), "{line}: {made}");
                return;
            }
        }
        panic!("{line}: nothing is kept");
    };
    let of = |id: &str, command: &str| {
        WRITTEN.iter().find(|written| (written.command, written.id) == (command, id)).expect("it is tried")
    };
    kept(of("plot", "simulate"), "simulate examples/mesh.toml --step 0.0001 --plot", |made| made.ends_with("</svg>\n"));
    let line = "sweep examples/mesh-errors.toml --over errors.rack_pitch=1..100000:0.5um --of mesh -o";
    kept(of("output", "sweep"), line, |made| made.starts_with("errors.rack_pitch_um,mean_mm,") && made.ends_with('\n'));
    let is_study = |made: &str| serde_json::from_str::<serde_json::Value>(made).is_ok();
    kept(of("study", "monte-carlo"), "monte-carlo examples/scatter.toml --racks 1000000 --study", is_study);
}

/// At most one file stays for each that is written, under a name that tells whose it is; the next run removes it.
#[test]
fn what_a_killed_run_leaves_is_removed_by_the_next() {
    let tried = Tried::new(&WRITTEN[0], "killed");
    for _ in 0..2 {
        let mut command = tried.command("", &tried.out());
        let mut child = command.arg("-").stdin(Stdio::piped()).spawn().unwrap();
        wait_for_work(&child);
        send("-KILL", &child);
        let process = child.id();
        child.wait().unwrap();
        let left: Vec<String> = tried.names().into_iter().filter_map(|name| name.into_string().ok()).collect();
        let left: Vec<_> = left.iter().filter(|name| name.starts_with(".out.csv.")).collect();
        assert_eq!(left.len(), 1, "{left:?}");
        assert!(
            left[0].starts_with(&format!(".out.csv.{process}-"))
                && Path::new(&left[0]).extension() == Some(OsStr::new("part")),
            "{left:?}"
        );
    }
    // two at once: one of both files, whole
    let both = [(); 2].map(|()| tried.command("", &tried.out()).spawn().unwrap());
    for child in both {
        child.wait_with_output().unwrap();
    }
    assert_eq!(fs::read_to_string(tried.out()).unwrap().lines().count(), 2);
    let expected = ["out", "out.csv", "parts.csv", "spec.toml"].map(OsString::from);
    assert_eq!(tried.names(), BTreeSet::from(expected));
}
