//! What the program answers, frozen: a change that should not change any answer shows here if it does.
//!
//! Each file of `tests/goldens` holds command lines with their exit status, standard output and standard error: every
//! example and every spec of the tests, `calc`, the help, and random batches, mesh curves, simulations and reports.
//! Random inputs are made here from a seed, and only outputs are stored: of many rows every 50th, with counts, sums and
//! a digest of those up to the next.
//!
//! ```sh
//! RACKMESH_GOLDENS=compare cargo test --test it goldens   # lists what differs, and by how much
//! RACKMESH_GOLDENS=write cargo test --test it goldens     # after a wanted change
//! ```
//!
//! `RACKMESH_GOLDENS_PROGRAM` names another program to run. Without `RACKMESH_GOLDENS` nothing is compared.

mod compared;
mod lots;
mod short;

use compared::{compare, read, write};
use lots::{lot, lot_of_teeth, write_lot};
use short::{digest, shortened};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;

/// The name of a file of goldens, and the arguments of each run in it.
type Subject = (String, Vec<String>);
/// The text of each file of goldens, by its name.
type Answers = BTreeMap<String, String>;

/// Of many rows, how many make one that is stored.
const BLOCK: usize = 50;
/// Differing runs that are shown with their lines.
const SHOWN: usize = 20;

#[test]
fn every_answer_is_the_frozen_one() {
    let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/goldens");
    match std::env::var("RACKMESH_GOLDENS").unwrap_or_default().as_str() {
        "write" => write(&stored, &answers()),
        "compare" => compare(&read(&stored), &answers()),
        "" => println!("nothing is compared: set RACKMESH_GOLDENS to compare or write"),
        other => panic!("RACKMESH_GOLDENS is `{other}`: it can be compare or write"),
    }
}

fn answers() -> Answers {
    let inputs = Inputs::new();
    let subjects = Mutex::new(subjects(&inputs));
    let answers = Mutex::new(Answers::new());
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let next = subjects.lock().unwrap().pop();
                    let Some((name, runs)) = next else { break };
                    let text = runs.iter().map(|arguments| inputs.answer(arguments)).collect();
                    answers.lock().unwrap().insert(name, text);
                }
            });
        }
    });
    answers.into_inner().unwrap()
}

/// The folder that the program runs in: copies of the examples and specs, and what is made here.
struct Inputs(PathBuf);

impl Inputs {
    fn new() -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("goldens");
        let _ = std::fs::remove_dir_all(&folder);
        for from in ["examples", "tests/specs", "tests/pasted"] {
            std::fs::create_dir_all(folder.join(from)).unwrap();
            for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(from)).unwrap() {
                let path = entry.unwrap().path();
                std::fs::copy(&path, folder.join(from).join(path.file_name().unwrap())).unwrap();
            }
        }
        Self(folder)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).unwrap();
    }

    /// The names of the specs in a folder, without `.toml`.
    fn specs(&self, folder: &str) -> BTreeSet<String> {
        let files = std::fs::read_dir(self.0.join(folder)).unwrap();
        let names = files.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.filter_map(|name| Some(name.strip_suffix(".toml")?.to_owned())).collect()
    }

    fn run(&self, arguments: &str) -> Output {
        let program = std::env::var_os("RACKMESH_GOLDENS_PROGRAM");
        let mut command = Command::new(program.unwrap_or_else(|| env!("CARGO_BIN_EXE_rackmesh").into()));
        command.args(arguments.split_whitespace()).current_dir(&self.0).stdin(Stdio::null());
        command.env_clear().env("NO_COLOR", "1").env("COLUMNS", "100").env("TZ", "UTC");
        command.output().expect("the program starts")
    }

    /// One run as it is stored.
    fn answer(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        let exit = output.status.code().map_or("ended by a signal".to_owned(), |code| code.to_string());
        let mut text = format!("=== rackmesh {arguments}\n? {exit}\n");
        let mut words = arguments.split_whitespace();
        let takes_file = words.any(|word| ["-o", "--plot", "--junit", "--rejects"].contains(&word));
        let file = if takes_file { words.next() } else { None };
        let file = file.and_then(|file| std::fs::read(self.0.join(file)).ok()).unwrap_or_default();
        for (what, bytes) in [("file", file), ("stdout", output.stdout), ("stderr", output.stderr)] {
            if !bytes.is_empty() {
                let all = String::from_utf8_lossy(&bytes).replace(env!("CARGO_PKG_VERSION"), "VERSION");
                let all = without_times(&all);
                text += &format!("--- {what}\n{}\n", shortened(&all, arguments).trim_end_matches('\n'));
            }
        }
        text
    }
}

/// The text without how long tests of a JUnit report took.
fn without_times(text: &str) -> String {
    let mut parts = text.split(" time=\"");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once('"').map_or(part, |(_, rest)| rest))
}

// ---- what is run ---------------------------------------------------------------------------------------------------

fn subjects(inputs: &Inputs) -> Vec<Subject> {
    let mut subjects = vec![calc(), help(), explain(inputs), others()];
    subjects.extend(inputs.specs("examples").iter().map(|name| example(name)));
    subjects.extend(inputs.specs("tests/specs").iter().map(|name| spec_of_the_tests(name)));
    subjects.extend((0..20).map(|index| lot(inputs, index)));
    subjects.extend((0..4).map(|index| lot_of_teeth(inputs, index)));
    subjects.extend((0..100).map(|index| curve(inputs, index)));
    subjects.extend((0..20).map(|index| simulation(inputs, index)));
    subjects.extend((0..30).map(|index| page(inputs, index)));
    subjects
}

fn in_every_format(arguments: &str) -> [String; 4] {
    ["table", "json", "csv", "markdown"].map(|format| format!("{arguments} --format {format}"))
}

fn example(name: &str) -> Subject {
    let spec = format!("examples/{name}.toml");
    let mut runs = Vec::new();
    for command in [
        format!("eval {spec}"),
        format!("budget {spec}"),
        format!("mesh {spec}"),
        format!("measure {spec}"),
        format!("simulate {spec} --quasi-static --spacing 0.5"),
        format!("class --obtained {spec}"),
        format!("class --spec {spec} --standard iso1328-1:1995 --grade 7"),
        format!("monte-carlo {spec} --racks 20"),
        format!("batch {spec} examples/parts.csv --summary"),
        format!("paste {spec} examples/cmm-report.txt"),
    ] {
        runs.extend(in_every_format(&command));
    }
    for more in ["--stack worst", "--stack rss", "--model paper", "--rule iso14253", "--rule guard=5um", "--mesh"] {
        runs.push(format!("eval {spec} {more} --format json"));
    }
    for stack in ["worst", "rss", "simulation"] {
        runs.push(format!("budget {spec} --stack {stack} --delta-cd 60um --format json"));
    }
    runs.extend([
        format!("eval {spec} --monte-carlo 20000 --seed 5 --format json"),
        format!("budget {spec} --plot {name}-tornado.svg"),
        format!("mesh {spec} --plot {name}-curve.svg"),
        format!("measure {spec} --part pinion --format json"),
        format!("simulate {spec} --spacing 2 --format json"),
        format!("class --spec {spec} --part rack --diameter pinion --for-delta-cd 0.05 --format json"),
        format!("batch {spec} examples/parts.csv"),
        format!("batch {spec} examples/parts.csv --format jsonl --decimals full"),
        format!("batch {spec} examples/parts.csv --rejects {name}-rejects.csv --only-failures"),
        format!("batch {spec} examples/parts.csv --junit {name}.xml --annotations github --only-failures"),
        format!("paste {spec} examples/lot.dfq --format json"),
        format!("paste {spec} examples/spaces.txt --mesh --format json"),
        format!("paste {spec} examples/cmm-report.txt -o {name}.dfq"),
        format!("report {spec}"),
        format!("report {spec} examples/parts.csv"),
    ]);
    (format!("example-{name}"), runs)
}

fn spec_of_the_tests(name: &str) -> Subject {
    let spec = format!("tests/specs/{name}.toml");
    let mut runs = in_every_format(&format!("eval {spec}")).to_vec();
    for command in ["mesh --to 10", "measure", "budget", "class --obtained"] {
        runs.push(format!("{command} {spec} --format json"));
    }
    runs.push(format!("batch {spec} tests/pasted/teile.csv --decimal comma --summary --format json"));
    runs.push(format!("report {spec} --to 10"));
    (format!("spec-{name}"), runs)
}

fn calc() -> Subject {
    let mut runs = Vec::new();
    for formula in [
        "over-roller --measured 25.0131 --nominal 25",
        "over-roller --inverse 0.02",
        "radial --measured 8.512 --nominal 8.5",
        "radial --inverse 20um",
        "pitch 20um --pressure-angle 20 --helix-angle 12",
        "pitch -0.5mil --pressure-angle 20 --helix-angle 12 --model paper",
        "pitch --inverse 50um --pressure-angle 20 --helix-angle 12",
        "pinion-pitch 15um --pressure-angle 20 --helix-angle 25",
        "pinion-pitch --inverse 0.03 --pressure-angle 20 --helix-angle 25 --model paper",
        "lead 0.25deg --face-width 19.7 --pressure-angle 19.9",
        "lead 3arcmin --face-width 19.7 --pressure-angle 19.9 --helix-angle -8 --model paper",
        "lead --f-h-beta 8um --length 18 --face-width 19.7 --pressure-angle 19.9 --helix-angle -8",
        "lead --inverse 50um --face-width 19.7 --pressure-angle 19.9 --helix-angle -8",
        "pin --normal-module 2 --pressure-angle 20",
        "pin --normal-module 2 --pressure-angle 20 --tooth-thickness 3",
        "over-pin --normal-module 2 --pressure-angle 20 --pin 4 --datum 22",
        "over-pin --normal-module 2 --pressure-angle 20 --pin 3.5 --datum 22 --tooth-thickness 3.1",
        "roller-change --from 4 --to 3.5 --pressure-angle 20",
    ] {
        runs.extend(["", " --explain", " --unit um --decimals 3"].map(|more| format!("calc {formula}{more}")));
        runs.extend(in_every_format(&format!("calc {formula}")));
    }
    ("calc".to_owned(), runs)
}

fn help() -> Subject {
    let commands = "eval mesh monte-carlo measure batch paste report class simulate budget reproduce init explain schema \
                    completions man calc";
    let formulas = "over-roller pitch lead radial pinion-pitch pin over-pin roller-change";
    let mut runs = vec!["--help".to_owned(), "-h".to_owned()];
    runs.extend(commands.split_whitespace().flat_map(|command| [format!("{command} --help"), format!("{command} -h")]));
    runs.extend(formulas.split_whitespace().map(|formula| format!("calc {formula} --help")));
    ("help".to_owned(), runs)
}

fn explain(inputs: &Inputs) -> Subject {
    let list = String::from_utf8(inputs.run("explain").stdout).unwrap();
    let topics = list.lines().filter(|line| line.starts_with("  ")).filter_map(|line| line.split_whitespace().next());
    ("explain".to_owned(), topics.map(|topic| format!("explain {topic}")).collect())
}

fn others() -> Subject {
    let runs = [
        "schema",
        "init",
        "man",
        "completions fish",
        "reproduce --format json",
        "reproduce --format markdown",
        "paste examples/steering.toml tests/pasted/three-parts.txt --decimal comma --format json",
        "paste examples/steering.toml tests/pasted/teile.csv --format json",
        "paste examples/steering.toml tests/pasted/thousands.txt --decimal point --format csv",
    ];
    ("others".to_owned(), runs.map(str::to_owned).into())
}

// ---- random inputs -------------------------------------------------------------------------------------------------

/// SplitMix64.
struct Random(u64);

impl Random {
    fn of(name: &str) -> Self {
        Self(digest(name))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// An integer from the first to the last, both included.
    fn integer(&mut self, first: i32, last: i32) -> i32 {
        let count = u64::from(last.abs_diff(first)) + 1;
        first + i32::try_from(self.next() % count).unwrap()
    }

    /// A hundredth of such an integer.
    fn hundredths(&mut self, first: i32, last: i32) -> f64 {
        f64::from(self.integer(first, last)) / 100.0
    }

    fn one_in(&mut self, count: i32) -> bool {
        self.integer(1, count) == 1
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[usize::try_from(self.next() % from.len() as u64).unwrap()]
    }
}

/// The geometry of a pair, parallel or crossed, with modified flanks if wanted; and its number of teeth.
fn gear(random: &mut Random, modified: bool) -> (String, i32) {
    let (module, teeth) = (random.pick(&[1.0, 1.5, 2.0, 2.5]), random.integer(6, 24));
    let helix = if random.one_in(4) { 0 } else { random.integer(-30, 30) };
    let rack_helix = if random.one_in(2) { 0 } else { random.integer(-12, 12) };
    let (shift, tip) = if teeth < 12 { (0.3, random.hundredths(50, 70)) } else { (0.1, random.hundredths(75, 95)) };
    let squared = f64::from(helix * helix) * (std::f64::consts::PI / 180.0) * (std::f64::consts::PI / 180.0);
    // the cosine is near enough: the platform's own may differ in the last digit
    let reference = module * f64::from(teeth) / (1.0 - squared / 2.0 + squared * squared / 24.0);
    let mut text =
        format!("[pair]\nnormal_module = {module}\nnormal_pressure_angle = {}\n", random.hundredths(1700, 2300));
    text += &format!("[rack]\nhelix_angle = {rack_helix}\nface_width = {}\n", random.hundredths(1500, 2500));
    text += &format!("addendum = {:.3}\ndatum = 22\n", module * random.hundredths(80, 100));
    if modified {
        text += &format!("crowning = \"{} um\"\n", random.integer(1, 6));
        text += &format!("tip_relief = {{ amount = \"{} um\", start = {} }}\n", random.integer(2, 12), module / 2.0);
    }
    text += &format!("[pinion]\nteeth = {teeth}\nhelix_angle = {helix}\nprofile_shift = {shift}\n");
    text += &format!("face_width = {}\n", random.hundredths(2000, 3000));
    text += &format!("tip_diameter = {:.3}\n", reference + 2.0 * module * (shift + tip));
    if modified {
        text += &format!("crowning = \"2 um\"\nprofile_slope = \"{} um\"\n", random.integer(-3, 3));
    }
    (text, teeth)
}

/// Deviations of some teeth of both parts.
fn deviations(random: &mut Random, teeth: i32) -> String {
    let mut text = String::new();
    for _ in 0..random.integer(1, 4) {
        let range = random.pick(&["all", "2..", "5..", "3", "6", "1..=4", "5..=6"]);
        let key = random.pick(&["over_roller", "pitch", "shift", "thickness", "left", "right"]);
        text +=
            &format!("[[rack.deviation]]\nteeth = \"{range}\"\n{key} = \"{} um\"\n", random.hundredths(-2000, 2000));
        if random.one_in(3) {
            text += &format!("lead = \"{} arcmin\"\n", random.hundredths(-300, 300));
        }
    }
    for _ in 0..random.integer(0, 3) {
        let key = random.pick(&["shift", "thickness", "radial", "left", "right"]);
        let (tooth, amount) = (random.integer(0, teeth - 1), random.hundredths(-1000, 1000));
        text += &format!("[[pinion.deviation]]\nteeth = {tooth}\n{key} = \"{amount} um\"\n");
    }
    if random.one_in(3) {
        let amount = random.integer(1, 12);
        text += &format!("[[pinion.deviation]]\neccentricity = {{ amount = \"{amount} um\", tooth = 2 }}\n");
    }
    text
}

/// One value for each error, some with their uncertainty.
fn errors(random: &mut Random) -> String {
    let mut text = format!("[errors]\nrack_lead = \"{} arcmin\"\n", random.hundredths(-400, 400));
    for key in ["rack_over_roller", "rack_pitch", "pinion_radial", "pinion_pitch"] {
        let u = if random.one_in(2) { format!(", u = \"{} um\"", random.hundredths(20, 200)) } else { String::new() };
        text += &format!("{key} = {{ value = \"{} um\"{u} }}\n", random.hundredths(-2000, 2000));
    }
    text
}

fn limits(random: &mut Random) -> String {
    let (lower, upper) = (random.integer(-50, -20), random.integer(20, 60));
    format!("[limits]\ncenter_distance = {{ lower = \"{lower} um\", upper = \"{upper} um\" }}\n")
}

/// An exact mesh: every fourth with modified flanks, every tenth with a rack that may roll.
fn curve(inputs: &Inputs, index: usize) -> Subject {
    let name = format!("mesh-{index:02}");
    let mut random = Random::of(&name);
    let (modified, rolls, has_errors) = (index % 4 == 1, index % 10 == 9, index % 7 == 3);
    let (mut spec, teeth) = gear(&mut random, modified);
    spec += &if has_errors { errors(&mut random) } else { deviations(&mut random, teeth) };
    if rolls {
        spec += &format!("[support]\nroll = \"free\"\nroll_axis_depth = {}\n", random.integer(4, 12));
    }
    if index.is_multiple_of(3) {
        spec += &limits(&mut random);
    }
    inputs.write(&format!("{name}.toml"), &spec);
    let from = random.integer(-5, 5);
    let to = from + if modified && rolls { 2 } else { random.integer(6, 18) };
    let mut runs = vec![format!("mesh {name}.toml --from {from} --to {to} --format json")];
    runs.push(if has_errors {
        format!("eval {name}.toml --format csv")
    } else {
        format!("measure {name}.toml --format csv")
    });
    (name, runs)
}

/// A short simulation: in time or as equilibria, spheres or exact surfaces, slider or yoke, with and without friction.
fn simulation(inputs: &Inputs, index: usize) -> Subject {
    let name = format!("simulation-{index:02}");
    let mut random = Random::of(&name);
    let (mut spec, teeth) = gear(&mut random, index % 5 == 4);
    spec += &deviations(&mut random, teeth);
    if index % 6 == 5 {
        spec += "[support]\nroll = \"free\"\nroll_axis_depth = 8\n";
    }
    spec += &format!("[simulation]\nstroke = {}\npreload = \"{} N\"\n", random.integer(3, 6), random.integer(100, 900));
    spec += &format!(
        "contact = \"{}\"\nfriction = {}\n",
        random.pick(&["spheres", "analytic"]),
        random.pick(&[0.0, 0.0, 0.08])
    );
    spec += "profile_nodes = 24\nwidth_nodes = 32\nstrips = 32\n";
    if index % 4 == 2 {
        spec += "support = \"yoke\"\n[yoke]\npreload = \"700 N\"\nrate = \"120 N/mm\"\nclearance = \"0.12 mm\"\n";
    }
    inputs.write(&format!("{name}.toml"), &spec);
    let how = if index.is_multiple_of(2) { " --quasi-static" } else { "" };
    let runs = vec![format!("simulate {name}.toml{how} --spacing 0.25 --format json")];
    (name, runs)
}

/// A report, of one part or of a lot.
fn page(inputs: &Inputs, index: usize) -> Subject {
    let name = format!("report-{index:02}");
    let how = ["", " --stack worst", " --stack rss", " --model paper", " --rule guard=3um"][index % 5];
    let files = if index.is_multiple_of(2) {
        let mut random = Random::of(&name);
        let (gear, teeth) = gear(&mut random, index % 8 == 2);
        let deviations = if index.is_multiple_of(6) { deviations(&mut random, teeth) } else { String::new() };
        inputs.write(&format!("{name}.toml"), &[gear, deviations, errors(&mut random), limits(&mut random)].concat());
        format!("{name}.toml")
    } else {
        write_lot(inputs, &name, index % 3, 200);
        format!("{name}.toml {name}.csv")
    };
    (name, vec![format!("report {files} --to 20{how}")])
}

/// What a column of a table of parts holds: the error, the heading, its name in `[table.columns]` if the heading is not
/// understood, and in units of the last digit the nominal value and a micrometre (of an angle, what moves the centre
/// distance about as far); the last is the number of decimals.
type Column = (&'static str, &'static str, &'static str, i32, i32, u32);

// ---- what is stored ------------------------------------------------------------------------------------------------

// ---- comparison ----------------------------------------------------------------------------------------------------
