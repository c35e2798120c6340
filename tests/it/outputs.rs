//! Every file that a command writes: complete, or the old one and what there is beside it, whatever ends the run.

#![cfg(target_os = "linux")]

mod signals;

use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::{Read as _, Write as _};
use std::os::unix::ffi::OsStrExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// How an option or a positional that takes a file to write is tried.
struct Written {
    command: &'static str,
    /// As clap calls it.
    id: &'static str,
    /// What is written behind the name of the program: `SPEC` and `TABLE` are read, `OUT` is written.
    line: &'static str,
    /// The example that is the spec.
    spec: &'static str,
    /// The name of what is written; in a folder, which `OUT` then is, the first file.
    file: &'static str,
    in_folder: bool,
}

const fn file(
    command: &'static str,
    id: &'static str,
    line: &'static str,
    spec: &'static str,
    file: &'static str,
) -> Written {
    Written { command, id, line, spec, file, in_folder: false }
}

const WRITTEN: [Written; 17] = [
    file("batch", "output", "batch SPEC TABLE --partial -o OUT", "steering", "out.csv"),
    file("batch", "rejects", "batch SPEC TABLE --partial --rejects OUT", "steering", "out.csv"),
    file("batch", "junit", "batch SPEC TABLE --partial --junit OUT", "steering", "out.xml"),
    file("paste", "output", "paste SPEC TABLE --partial -o OUT", "steering", "out.html"),
    file("report", "output", "report SPEC -o OUT", "steering", "out.html"),
    file("eval", "plot", "eval SPEC --plot OUT", "mesh-errors", "out.svg"),
    file("mesh", "plot", "mesh SPEC --plot OUT", "mesh", "out.svg"),
    file("simulate", "plot", "simulate SPEC --plot OUT", "mesh", "out.svg"),
    file("budget", "plot", "budget SPEC --plot OUT", "budget", "out.svg"),
    file("monte-carlo", "plot", "monte-carlo SPEC --racks 3 --plot OUT", "scatter", "out.svg"),
    file("monte-carlo", "study", "monte-carlo SPEC --racks 3 --study OUT", "scatter", "out.json"),
    file("sweep", "output", "sweep SPEC --over errors.rack_pitch=1..3:1um -o OUT", "mesh-errors", "out.csv"),
    file("sweep", "plot", "sweep SPEC --over errors.rack_pitch=1..3:1um --plot OUT", "mesh-errors", "out.svg"),
    file("compare", "plot", "compare SPEC SPEC --plot OUT", "mesh-errors", "out.svg"),
    file("init", "file", "init OUT --force", "mesh", "out.toml"),
    Written { in_folder: true, ..file("man", "dir", "man --dir OUT", "mesh", "rackmesh-batch.1") },
    // drawn after a quarter of a minute: that it is written by the same means is all that is tried
    Written { in_folder: true, ..file("reproduce", "plots", "", "mesh", "pitch-plus.svg") },
];

/// Those that are read.
const READ: [&str; 8] = ["spec", "measured", "specs", "files", "file", "layout", "merge", "obtained"];

const OLD: &str = "<testsuites> of an older run\n";

/// A folder with the spec and a table, removed at the end.
struct Tried<'w> {
    written: &'w Written,
    folder: PathBuf,
}

impl Drop for Tried<'_> {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

impl<'w> Tried<'w> {
    fn new(written: &'w Written, name: &str) -> Self {
        let name = format!("outputs-{name}-{}-{}", written.command, written.id);
        let tried = Self { written, folder: PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name) };
        let _ = fs::remove_dir_all(&tried.folder);
        fs::create_dir_all(tried.folder.join("out")).unwrap();
        let example = format!("examples/{}.toml", written.spec);
        fs::copy(example, tried.folder.join("spec.toml")).unwrap();
        fs::write(tried.folder.join("parts.csv"), "part_id,rack_pitch [um]\nP1,3\nP2,x\n").unwrap();
        tried
    }

    fn out(&self) -> PathBuf {
        self.folder.join(if self.written.in_folder { "out/" } else { "" }).join(self.written.file)
    }

    /// The command, behind these words of a shell.
    fn command(&self, before: &str, out: &Path) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", &format!("{before} exec \"$@\""), "sh", env!("CARGO_BIN_EXE_rackmesh")]);
        for word in self.written.line.split(' ') {
            command.arg(match word {
                "SPEC" => self.folder.join("spec.toml").into_os_string(),
                "TABLE" => self.folder.join("parts.csv").into_os_string(),
                "OUT" if self.written.in_folder => out.parent().unwrap().as_os_str().to_owned(),
                "OUT" => out.as_os_str().to_owned(),
                word => OsString::from(word),
            });
        }
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn run(&self, before: &str) -> Output {
        self.command(before, &self.out()).output().expect("the program runs")
    }

    fn names(&self) -> BTreeSet<OsString> {
        let folder = self.out().parent().unwrap().to_owned();
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect()
    }

    /// The old file is there, or of a JUnit report one that is no old one, and nothing else has come but partial files.
    fn holds(&self, before: &BTreeSet<OsString>, why: &str) {
        let what = format!("{} {}: {why}", self.written.command, self.written.id);
        if self.written.id == "junit" {
            // without room for a report there is none
            assert_ne!(fs::read_to_string(self.out()).unwrap_or_default(), OLD, "{what}");
        } else {
            assert_eq!(fs::read_to_string(self.out()).unwrap(), OLD, "{what}");
        }
        let is_new = |name: &&OsString| !before.contains(*name) && !name.as_bytes().ends_with(b".partial");
        let new: Vec<_> = self.names().iter().filter(is_new).cloned().collect();
        // the other pages of a folder are complete
        assert!(new.is_empty() || self.written.in_folder, "{what}: {new:?}");
    }
}

fn tried() -> impl Iterator<Item = &'static Written> {
    WRITTEN.iter().filter(|written| !written.line.is_empty())
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Walks the commands: each argument that takes a file is tried here, or is read.
#[test]
fn every_argument_that_takes_a_file_to_write_is_tried() {
    fn walk(command: &clap::Command, found: &mut BTreeSet<(String, String)>) {
        for argument in command.get_arguments() {
            let is_path = argument.get_value_parser().type_id() == clap::builder::ValueParser::path_buf().type_id();
            let id = argument.get_id().as_str();
            // what takes any text is no file
            let is_named = ["FILE", "FOLDER", "DIR"].iter().any(|name| {
                argument.get_value_names().is_some_and(|names| names.iter().any(|known| known.as_str() == *name))
            });
            assert!(is_path || !is_named, "{} {id} takes a file that has to have a name in UTF-8", command.get_name());
            if is_path && !READ.contains(&id) || (command.get_name(), id) == ("init", "file") {
                found.insert((command.get_name().to_owned(), id.to_owned()));
            }
        }
        command.get_subcommands().for_each(|subcommand| walk(subcommand, found));
    }
    let mut command = rackmesh::cli::command();
    command.build();
    let mut found = BTreeSet::new();
    walk(&command, &mut found);
    let known = WRITTEN.iter().map(|written| (written.command.to_owned(), written.id.to_owned())).collect();
    assert_eq!(found, known);
}

#[test]
fn a_full_disk_leaves_the_old_file_and_is_said_by_name() {
    for written in tried() {
        let tried = Tried::new(written, "full");
        fs::write(tried.out(), OLD).unwrap();
        let before = tried.names();
        // no file may have a byte, and the signal for that is handled
        let output = tried.run("ulimit -f 0;");
        let what = format!("{} {}: {}", written.command, written.id, stderr(&output));
        assert_eq!(output.status.code(), Some(2), "{what}");
        let said = if written.in_folder { "cannot write" } else { written.file };
        assert!(what.contains("cannot write ") && what.contains(said), "{what}");
        tried.holds(&before, "full disk");

        fs::remove_file(tried.out()).ok();
        std::os::unix::fs::symlink("/dev/full", tried.out()).unwrap();
        let output = tried.run("");
        let what = format!("{} {}: {}", written.command, written.id, stderr(&output));
        assert_eq!(output.status.code(), Some(2), "{what}");
        assert!(what.contains("cannot write ") && what.contains(written.file), "{what}");
    }
}

/// The rows of a workbook wait in a temporary file: a disk that is full there leaves the old file, too.
#[test]
fn a_workbook_that_has_no_room_for_its_rows_leaves_the_old_file() {
    let written = WRITTEN.iter().find(|written| (written.command, written.id) == ("batch", "output")).unwrap();
    let tried = Tried::new(written, "no-room");
    let (rows, book) = (tried.folder.join("rows.csv"), tried.folder.join("book.xlsx"));
    let lines = (0..5_000).map(|part| format!("P{part},25.01,0\n")).collect::<Vec<_>>().concat();
    fs::write(&rows, format!("part_id,over_roller,dp\n{lines}")).unwrap();
    fs::write(&book, OLD).unwrap();
    let line = format!(
        "ulimit -f 64; {} batch {}/tests/specs/batch.toml rows.csv -o book.xlsx",
        env!("CARGO_BIN_EXE_rackmesh"),
        env!("CARGO_MANIFEST_DIR")
    );
    let output = Command::new("sh").args(["-c", &line]).current_dir(&tried.folder).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("cannot write book.xlsx: the temporary file"), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(&book).unwrap(), OLD);
}

#[test]
fn what_is_read_is_not_written() {
    for written in tried().filter(|written| written.line.contains("SPEC")) {
        let tried = Tried::new(written, "input");
        let spec = tried.folder.join("spec.toml");
        let text = fs::read(&spec).unwrap();
        for link in [false, true] {
            let _ = fs::remove_file(tried.out());
            if link { fs::hard_link(&spec, tried.out()) } else { std::os::unix::fs::symlink(&spec, tried.out()) }
                .unwrap();
            let output = tried.run("");
            assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
            assert!(stderr(&output).contains("would be written over"), "{}: {}", written.id, stderr(&output));
            assert_eq!(fs::read(&spec).unwrap(), text, "{}", written.id);
        }
    }
}

#[test]
fn names_that_are_no_text_are_written_and_shown() {
    for written in tried() {
        let tried = Tried::new(written, "bytes");
        let named = |name: &str| OsString::from_iter([OsStr::from_bytes(b"n\xff-"), OsStr::new(name)]);
        let out = if written.in_folder {
            tried.folder.join(named("out")).join(written.file)
        } else {
            tried.folder.join(named(written.file))
        };
        fs::rename(tried.folder.join("spec.toml"), tried.folder.join(named("spec.toml"))).unwrap();
        fs::rename(tried.folder.join("parts.csv"), tried.folder.join(named("parts.csv"))).unwrap();
        std::os::unix::fs::symlink(tried.folder.join(named("spec.toml")), tried.folder.join("spec.toml")).unwrap();
        let mut command = tried.command("", &out);
        let parts = [named("spec.toml"), named("parts.csv")];
        let words: Vec<OsString> = command.get_args().map(OsStr::to_owned).collect();
        let of = |word: &OsString| parts.iter().find(|part| word.as_bytes().ends_with(&part.as_bytes()[3..]));
        let words =
            words.iter().map(|word| of(word).map_or_else(|| word.clone(), |part| tried.folder.join(part).into()));
        command = Command::new("sh");
        let output = command.args(words).stdin(Stdio::null()).output().unwrap();
        assert!(output.status.code().is_some_and(|code| code <= 3), "{}: {}", written.id, stderr(&output));
        assert!(out.exists(), "{} {}: {}", written.command, written.id, stderr(&output));
        assert!(!stderr(&output).contains("UTF-8"), "{}", stderr(&output));
    }
}

/// Whoever cannot be told the result is told so.
#[test]
fn standard_output_that_is_full_is_a_failure() {
    for line in ["--help", "--version", "eval --help", "schema", "init", "man", "completions bash", "explain pitch"] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_rackmesh"));
        let output = command.args(line.split(' ')).stdout(full).stderr(Stdio::piped()).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{line}: {}", stderr(&output));
        assert!(stderr(&output).contains("cannot write standard output"), "{line}: {}", stderr(&output));
    }
}

/// The status of random racks is that of all of them, whoever reads their list.
#[test]
fn a_list_of_racks_that_is_not_read_to_its_end_keeps_its_status() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rackmesh"));
    command.args(["monte-carlo", "examples/scatter.toml", "--racks", "200", "--format", "csv"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""));
}

/// A report of an older run does not stay where pipelines look for that of a run that failed.
#[test]
fn a_junit_report_is_never_that_of_an_older_run() {
    let tried = Tried::new(&WRITTEN[2], "junit");
    let spec = tried.folder.join("spec.toml");
    let run = |text: &[u8], more: &[&str]| {
        fs::write(&spec, text).unwrap();
        fs::write(tried.out(), OLD).unwrap();
        let mut command = tried.command("", &tried.out());
        let code = command.args(more).output().unwrap().status.code();
        (code, fs::read_to_string(tried.out()).unwrap())
    };
    let good = fs::read("examples/steering.toml").unwrap();
    let failures: [(&[u8], &[&str]); 4] = [
        (b"[errors", &[]),
        (&good, &["--columns", "none"]),
        (&good, &["no-such.csv", "--no-option"]),
        (&good, &["-j"]),
    ];
    for (text, more) in failures {
        let (code, report) = run(text, more);
        assert!(code == Some(2) && report.contains("<error type=\"incomplete\""), "{more:?}: {report}");
    }
    // what is no report is no older one
    let spec_as_report = tried.command("", &spec).output().unwrap();
    assert_eq!(spec_as_report.status.code(), Some(2));
    assert_eq!(fs::read(&spec).unwrap(), good);
    let mut table = fs::File::create(tried.out()).unwrap();
    table.write_all(b"part_id,rack_pitch\n").unwrap();
    assert_eq!(tried.command("", &tried.out()).arg("--no-option").output().unwrap().status.code(), Some(2));
    assert_eq!(fs::read(tried.out()).unwrap(), b"part_id,rack_pitch\n");
}
