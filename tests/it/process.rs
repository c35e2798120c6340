//! What transcripts cannot show: standard input, closed pipes, files that are written.

mod signals;

use std::io::{Read as _, Write as _};
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};

pub(crate) fn rackmesh(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rackmesh"));
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

pub(crate) fn with_input(arguments: &[&str], input: &[u8]) -> Output {
    let mut child = rackmesh(arguments).spawn().expect("the program starts");
    let mut stdin = child.stdin.take().expect("stdin is piped");
    let input = input.to_vec();
    // the program may refuse the input before it has read all of it
    let feeder = std::thread::spawn(move || drop(stdin.write_all(&input)));
    let output = child.wait_with_output().expect("the program ends");
    feeder.join().expect("the input is fed");
    output
}

pub(crate) fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("output is UTF-8")
}

/// How a command ended and what it wrote.
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Ended {
    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}: {} {}", self.stdout, self.stderr))
    }
}

pub(crate) fn run(arguments: &[&str], input: &str) -> Ended {
    let output = with_input(arguments, input.as_bytes());
    let text = |bytes| String::from_utf8(bytes).expect("output is UTF-8");
    Ended { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

/// A folder of its own for one test, removed at the end.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).expect("the folder can be made");
        Self(folder)
    }

    pub(crate) fn path(&self, file: &str) -> String {
        self.0.join(file).to_str().expect("the path is UTF-8").to_owned()
    }

    /// A file of this name with these contents.
    pub(crate) fn file(&self, name: &str, contents: impl AsRef<[u8]>) -> String {
        std::fs::write(self.0.join(name), contents).expect("the file can be written");
        self.path(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn a_spec_from_standard_input() {
    let output = with_input(&["eval", "-", "--format", "json"], b"[errors]\nrack_over_roller = 0.01\n");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("the output is JSON");
    assert_eq!(json["contributions"][0]["delta_cd_mm"], 0.01);
    assert_eq!(json["verdict"], serde_json::Value::Null);
}

#[test]
fn a_byte_order_mark_and_windows_line_ends_are_no_obstacle() {
    let spec = "\u{feff}[errors]\r\nrack_over_roller = 0,01\r\n";
    let output = with_input(&["eval", "-"], spec.as_bytes());
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("<stdin>:2:21"), "{}", text(&output.stderr));
    let output = with_input(&["eval", "-"], spec.replace(',', ".").as_bytes());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

#[test]
fn what_is_not_text_is_refused() {
    let output = with_input(&["eval", "-"], b"title = \"\xff\"");
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("not text in UTF-8 (byte 9)"), "{}", text(&output.stderr));
}

#[test]
fn deep_nesting_is_an_error_and_no_crash() {
    let spec = format!("title = {}{}", "[".repeat(100_000), "]".repeat(100_000));
    let output = with_input(&["eval", "-"], spec.as_bytes());
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
}

#[test]
fn a_closed_pipe_is_success() {
    for arguments in [&["schema"][..], &["eval", "examples/steering.toml"], &["explain"], &["--help"]] {
        let mut child: Child = rackmesh(arguments).spawn().expect("the program starts");
        drop(child.stdout.take());
        let mut messages = String::new();
        child.stderr.take().expect("stderr is piped").read_to_string(&mut messages).expect("stderr is read");
        let status = child.wait().expect("the program ends");
        // a spec outside its limits still says so
        let expected = if arguments[0] == "eval" { [Some(0), Some(1)] } else { [Some(0); 2] };
        assert!(expected.contains(&status.code()), "{arguments:?}: {status:?} {messages}");
        assert_eq!(messages, "", "{arguments:?}");
    }
}

#[test]
fn colour_only_when_asked_or_on_a_terminal() {
    let colored = |arguments: &[&str]| text(&with_input(arguments, b"").stdout).contains('\u{1b}');
    assert!(!colored(&["eval", "examples/steering.toml"]));
    assert!(colored(&["eval", "examples/steering.toml", "--color", "always"]));
    let output = rackmesh(&["eval", "examples/steering.toml", "--color", "never"])
        .env("CLICOLOR_FORCE", "1")
        .output()
        .expect("the program runs");
    assert!(!text(&output.stdout).contains('\u{1b}'));
}

#[test]
fn what_init_writes_can_be_evaluated_and_is_not_overwritten() {
    let folder = Folder::new("init");
    let spec = folder.path("rack.toml");
    assert_eq!(with_input(&["init", &spec], b"").status.code(), Some(0));
    let evaluated = with_input(&["eval", &spec], b"");
    assert_eq!(evaluated.status.code(), Some(0), "{}", text(&evaluated.stderr));
    let again = with_input(&["init", &spec], b"");
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("--force"), "{}", text(&again.stderr));
    assert_eq!(with_input(&["init", &spec, "--force"], b"").status.code(), Some(0));
}

#[test]
fn measured_values_fed_back_give_the_same_curve() {
    let folder = Folder::new("measured");
    let spec = std::fs::read_to_string("examples/mesh.toml").expect("the example is there");
    let table = with_input(&["measure", "examples/mesh.toml", "--format", "csv"], b"");
    std::fs::write(folder.path("rack.csv"), &table.stdout).expect("the table can be written");
    let (start, end) = (spec.find("[[rack.deviation]]").expect("deviations"), spec.find("[limits]").expect("limits"));
    let measured = (spec[..start].to_owned() + &spec[end..]).replace("[rack]", "[rack]\nmeasured = \"rack.csv\"");
    std::fs::write(folder.path("measured.toml"), measured).expect("the spec can be written");
    let curve = |spec: &str| {
        let output = with_input(&["mesh", spec, "--step", "0.5", "--format", "csv"], b"");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let rows = text(&output.stdout).lines().skip(1).map(|line| {
            let cells: Vec<_> = line.split(',').collect();
            cells[1].parse::<f64>().expect("ΔCD is a number")
        });
        rows.collect::<Vec<_>>()
    };
    let (given, again) = (curve("examples/mesh.toml"), curve(&folder.path("measured.toml")));
    assert_eq!(given.len(), 101);
    assert!(given.iter().any(|delta_cd| *delta_cd > 0.04));
    for (a, b) in given.iter().zip(&again) {
        assert!((a - b).abs() < 1e-11, "{a} {b}");
    }
}

#[test]
fn plots_are_written_as_svg() {
    let folder = Folder::new("plots");
    for file in ["curve.svg", "CURVE.SVG"] {
        let output = with_input(&["mesh", "examples/mesh.toml", "--plot", &folder.path(file)], b"");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(std::fs::read(folder.path(file)).expect("the plot is there").starts_with(b"<svg"), "{file}");
    }
}

#[test]
fn manual_pages_and_completions_come_for_every_subcommand() {
    let folder = Folder::new("man");
    assert_eq!(with_input(&["man", "--dir", &folder.path("man1")], b"").status.code(), Some(0));
    for page in ["rackmesh.1", "rackmesh-eval.1", "rackmesh-calc-pitch.1"] {
        assert!(std::fs::exists(folder.path("man1/") + page).expect("the folder is read"), "{page}");
    }
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = with_input(&["completions", shell], b"");
        assert!(text(&script.stdout).contains("reproduce"), "{shell}");
    }
}

/// Rows are written as they are solved, in order, by as many cores as there are; a program that reads the first ones
/// may go away.
#[test]
fn a_long_list_of_strokes_comes_in_order_and_whole() {
    let mesh = |format: &str| {
        let arguments = ["mesh", "examples/mesh.toml", "--from", "-1", "--to", "60", "--points", "40001"];
        let output = rackmesh(&arguments).args(["--format", format]).output().expect("the program runs");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        output.stdout
    };
    let csv = mesh("csv");
    let rows: Vec<&str> = text(&csv).lines().collect();
    assert_eq!(rows.len(), 40_002);
    assert!(rows[1].starts_with("-1,") && rows[40_001].starts_with("60,"), "{} {}", rows[1], rows[40_001]);
    let json: serde_json::Value = serde_json::from_slice(&mesh("json")).expect("the output is JSON");
    assert_eq!(json["unconverged"], 0);
    let points = json["points"].as_array().expect("an array");
    assert_eq!(points.len(), 40_001);
    for (row, point) in rows[1..].iter().zip(points) {
        let field = |index: usize| row.split(',').nth(index).and_then(|field| field.parse::<f64>().ok());
        assert_eq!((field(0), field(1)), (point["stroke_mm"].as_f64(), point["delta_cd_mm"].as_f64()));
    }

    // a list that goes on for hours ends with its reader
    let mut child = rackmesh(&["mesh", "examples/mesh.toml", "--points", "100000000", "--format", "csv"])
        .spawn()
        .expect("the program starts");
    let mut start = [0; 9];
    child.stdout.take().expect("stdout is piped").read_exact(&mut start).expect("there is a header");
    assert_eq!(&start, b"stroke_mm");
    assert_eq!(child.wait().expect("the program ends").code(), Some(0));
}

/// A page of a table is about its parts: a sample in the spec that fails is none of them.
#[test]
fn a_page_is_about_the_measured_parts() {
    let folder = Folder::new("measured-parts");
    let (spec, table) = (folder.path("spec.toml"), folder.path("lot.csv"));
    let written = "title = \"part 0417\"\n[pair]\nnormal_pressure_angle = 20\n[errors]\n\
                rack_over_roller = { measured = 25.9, nominal = 25 }\nrack_pitch = \"12 um\"\n\
                [limits]\ncenter_distance = \"±0.05\"\nrack_pitch = \"±0.02\"\n\
                [table.columns]\ninspector = \"Prüfer\"\n";
    std::fs::write(&spec, written).expect("written");
    let rows = |parts: std::ops::Range<i32>| -> String {
        let row = |part| format!("0{part},25.0{},{},Frey\n", part % 10, part % 7);
        "part_id,rack_over_roller,rack_pitch [um],Prüfer\n".to_owned() + &parts.map(row).collect::<String>()
    };
    let page = |more: &[&str], status: i32| {
        let ended = with_input(&[&["report", &spec, &table][..], more].concat(), b"");
        let batch = with_input(&["batch", &spec, &table, "-q"], b"");
        assert_eq!((ended.status.code(), batch.status.code()), (Some(status), Some(status)), "{}", text(&ended.stderr));
        String::from_utf8(ended.stdout).expect("a page is text")
    };
    std::fs::write(&table, rows(418..419)).expect("written");
    let one = page(&["--set", "report.date=2026-11-27", "--set", "report.order=4711"], 1);
    // measured, nominal, deviation, ΔCD, margin
    let shown = [
        "<h1>Part 0418</h1>",
        "<dt>date</dt><dd>2026-11-27</dd>",
        "<dt>inspector</dt><dd>Frey</dd>",
        "<dt>order</dt><dd>4711</dd>",
        "<span>Signature</span>",
        "<td class=\"n\">25.0800 mm</td><td class=\"n\">25.0000 mm</td><td class=\"n\">+80.0 µm</td><td class=\"n\">+0.0800</td>",
        "ΔCD (worst case) is 0.0369 mm above the limit 0.05 mm",
    ];
    for shown in shown {
        assert!(one.contains(shown), "{shown}: {one}");
    }
    std::fs::write(&table, rows(430..434)).expect("written");
    let lot = page(&[], 0);
    assert!(lot.contains("class=\"verdict pass\"") && lot.contains("<h1>4 parts: "), "{lot}");
    std::fs::write(&table, rows(400..460)).expect("written");
    let [worst, all] = [page(&[], 1), page(&["--all-parts"], 1)];
    let listed = |page: &str| page.matches("<tr><th scope=\"row\">04").count();
    assert_eq!([listed(&worst), listed(&all)], [10, 60]);
    for page in [&one, &lot, &worst, &all] {
        assert!(!page.contains("<h1>part 0417") && !page.contains("25.9000"), "{page}");
        assert_eq!(page.matches("<p class=\"verdict").count(), 1);
    }
}

#[test]
fn a_report_is_one_page_with_everything() {
    let folder = Folder::new("report");
    let page = folder.path("page.html");
    std::fs::write(
        folder.path("lot.csv"),
        "part_id,rack_over_roller,rack_pitch [um]\nP1,25.01,3\nP<2>,25.09,1\nP3,x,2\n",
    )
    .expect("the table can be written");
    let lot = folder.path("lot.csv");
    let arguments = ["report", "examples/steering.toml", &lot, "--partial"];
    let output = with_input(&[&arguments[..], &["-o", &page]].concat(), b"");
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("`rack_over_roller`"), "{}", text(&output.stderr));
    let html = std::fs::read_to_string(&page).expect("the page is there");
    let title = format!("<h1>2 parts: {lot}</h1>");
    for part in [
        title.as_str(),
        "class=\"verdict fail\"",
        "; judged without rack lead",
        "How the tables were read",
        "by its key",
        "Histogram",
        "Run chart",
        "P&lt;2&gt;",
        "SHA-256",
        "not read: ",
    ] {
        assert!(html.contains(part), "{part}");
    }
    for never in ["<script", "http://", "https://", "P<2>", "NaN"] {
        assert!(!html.contains(never), "{never}");
    }
    assert_eq!(html.matches("<table").count(), html.matches("<caption>").count());
    assert_eq!(html.matches("<p class=\"verdict").count(), 1);
    // the same page again, byte for byte
    assert_eq!(with_input(&arguments, b"").stdout, html.as_bytes());
    // standard input is a table, too, and has a hash
    let table = std::fs::read(&lot).expect("the table is there");
    let piped = with_input(&["report", "examples/steering.toml", "-", "--partial"], &table);
    let named = html.replace(&lot, "&lt;stdin&gt;");
    assert_eq!(text(&piped.stdout), named, "{}", text(&piped.stderr));
    // an error that the table lacks leaves the verdict open, and the page says so above everything else
    let open = with_input(&arguments[..3], b"");
    assert_eq!(open.status.code(), Some(2));
    let headline = "<p class=\"verdict open\"><b>NO VERDICT</b>the limit on centre distance is not judged";
    assert!(text(&open.stdout).contains(headline), "{}", text(&open.stdout));
}

#[test]
fn a_workbook_and_statistics_software_get_the_results_of_a_batch() {
    let folder = Folder::new("office");
    let rows = text(&with_input(&["batch", "examples/steering.toml", "examples/lot.dfq"], b"").stdout).to_owned();
    assert!(rows.contains("P-0001,0.013000,"), "{rows}");
    for file in ["results.xlsx", "results.dfq"] {
        let output =
            with_input(&["batch", "examples/steering.toml", "examples/lot.dfq", "-o", &folder.path(file)], b"");
        assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    }
    let back = std::fs::read(folder.path("results.dfq")).expect("the file is there");
    assert!(back.starts_with(b"K0100 "), "{}", text(&back));
}

#[test]
fn a_typed_block_and_a_piped_one() {
    let output =
        with_input(&["paste", "examples/minimal.toml", "--as", "rack_over_roller", "--format", "csv"], b"25,013\n");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("0.013"), "{}", text(&output.stdout));
    // Latin-1, as a clipboard of an old program has it
    let output = with_input(&["paste", "examples/steering.toml", "--format", "csv"], b"rack_pitch [\xb5m]\n12,5\n");
    assert!(text(&output.stdout).contains("0.0125"), "{}", text(&output.stdout));
}

#[test]
fn what_is_read_is_not_written_over() {
    let folder = Folder::new("over");
    let spec = folder.path("spec.svg");
    let text_of_spec = std::fs::read_to_string("examples/mesh.toml").expect("the spec is there");
    let before = text_of_spec + "\n[scatter]\nrack_pitch = \"4 um\"\n";
    std::fs::write(&spec, &before).expect("the spec can be written");
    // links, and all other commands: in `outputs`
    let output = with_input(&["mesh", &spec, "--plot", &folder.path("./spec.svg")], b"");
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("would be written over"), "{}", text(&output.stderr));
    assert!(output.stdout.is_empty());
    assert_eq!(std::fs::read_to_string(&spec).expect("the spec is there"), before);
    // an ending that nothing is written for is said before anything is computed
    for file in ["run.png", "run.pdf", "run", "-"] {
        let output = with_input(&["simulate", "examples/mesh.toml", "--plot", &folder.path(file)], b"");
        assert!(text(&output.stderr).contains("write a name that ends in .svg"), "{}", text(&output.stderr));
        assert!(output.stdout.is_empty());
    }
}

#[test]
#[cfg(unix)]
fn pipes_and_standard_output_are_written_as_they_are() {
    let folder = Folder::new("pipes");
    let paste = ["paste", "examples/minimal.toml", "--as", "rack_over_roller", "-o"];
    let output = with_input(&[&paste[..], &["/dev/stdout"]].concat(), b"25.013\n");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(text(&output.stdout).matches("rack over-roller").count(), 2, "{}", text(&output.stdout));

    let pipe = folder.path("rows.csv");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo is there").success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read_to_string(pipe).expect("the pipe is read")
    });
    let output = with_input(&[&paste[..], &[&pipe]].concat(), b"25.013\n");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(reader.join().expect("the pipe is read").starts_with("kind,name"));
    assert!(!std::fs::metadata(&pipe).expect("the pipe is there").is_file());
}

/// What a table contradicts is said before teeth are solved: here they cannot be, for the pair has no geometry.
#[test]
fn a_part_that_is_given_both_ways_is_refused_before_its_teeth_are_solved() {
    let folder = Folder::new("both-ways");
    let (spec, table) = (folder.path("rack.toml"), folder.path("parts.csv"));
    let text = "[[rack.deviation]]\nteeth = \"4..\"\npitch = \"+20 um\"\n";
    std::fs::write(&spec, text).expect("the spec can be written");
    std::fs::write(&table, "part_id,rack_pitch [um]\nP1,3\nP2,4\n").expect("the table can be written");
    for command in ["batch", "paste"] {
        let ended = run(&[command, &spec, &table], "");
        assert_eq!(ended.code, Some(2), "{command}");
        assert!(ended.stderr.contains("error[bad-error-entry]: the rack is given both ways"), "{}", ended.stderr);
    }
}
