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

const COLUMNS: [&[Column]; 5] = [
    &[
        ("rack_over_roller", "M [mm]", "M", 250_000, 10, 4),
        ("rack_over_roller", "rack_over_roller [um]", "", 0, 10, 1),
        ("rack_over_roller", "Rollenmaß [mm]", "", 25_000_000, 1000, 6),
    ],
    &[
        ("rack_pitch", "dp [µm]", "dp", 0, 10, 1),
        ("rack_pitch", "rack_pitch_mm", "", 0, 100, 5),
        ("rack_pitch", "Teilungsabweichung Zahnstange [µm]", "", 0, 100, 2),
    ],
    &[
        ("rack_lead", "rack_lead [arcmin]", "", 0, 10, 2),
        ("rack_lead", "lead (deg)", "lead", 0, 15, 4),
        ("rack_lead", "lead [mrad]", "lead", 0, 30, 3),
    ],
    &[("pinion_radial", "r [mm]", "r", 85_000, 10, 4), ("pinion_radial", "pinion_radial_um", "", 0, 100, 2)],
    &[("pinion_pitch", "pinion_pitch [um]", "", 0, 10, 1), ("pinion_pitch", "fp [mm]", "fp", 0, 10, 4)],
];

/// A number of units of the last digit.
fn decimal(units: i32, decimals: u32) -> String {
    format!("{:.*}", decimals as usize, f64::from(units) / f64::from(10_i32.pow(decimals)))
}

/// Writes a spec, a table with a row per part, and one with the first 250 rows. Some parts are exactly on a limit, some
/// cells are not numbers. The kind says which separator the table has; kind 3 has decimal commas. True if the values
/// have uncertainties.
fn write_lot(inputs: &Inputs, name: &str, kind: usize, parts: usize) -> bool {
    let mut random = Random::of(name);
    let separator = [",", ";", "\t", ";"][kind];
    let mut columns = vec![random.pick(COLUMNS[0])];
    for more in &COLUMNS[1..] {
        if !random.one_in(3) {
            columns.push(random.pick(more));
        }
    }
    let limits = [random.integer(-40, -20), random.integer(30, 60)];
    let uncertain = random.one_in(3);
    inputs.write(&format!("{name}.toml"), &spec_of_lot(&mut random, &columns, limits, uncertain));
    let headings: Vec<_> = columns.iter().map(|column| column.1).collect();
    let mut rows = vec![format!("part_id{separator}{}{separator}remark\n", headings.join(separator))];
    for part in 0..parts {
        let on_limit = if random.one_in(25) { Some(random.pick(&limits)) } else { None };
        let cells: Vec<_> = columns.iter().map(|column| cell(&mut random, column, on_limit)).collect();
        let cells = if kind == 3 { cells.join(separator).replace('.', ",") } else { cells.join(separator) };
        let remark = if random.one_in(50) { "\"re-cut, 2nd shift; see note\"" } else { "" };
        rows.push(format!("P{part:04}{separator}{cells}{separator}{remark}\n"));
    }
    inputs.write(&format!("{name}.csv"), &rows.concat());
    inputs.write(&format!("{name}-few.csv"), &rows[..parts.min(251)].concat());
    uncertain
}

/// A cell; with a limit in µm the rack's over-roller error is exactly that and nothing else deviates.
fn cell(random: &mut Random, &(key, _, _, nominal, micrometre, decimals): &Column, on_limit: Option<i32>) -> String {
    if random.one_in(400) {
        return random.pick(&["", "-", "abc", "24.99?", "nan", "1e999", "12 parsec", "--3", "0x1f"]).to_owned();
    }
    let bell = random.integer(-15, 15) * micrometre + random.integer(-10 * micrometre, 10 * micrometre);
    let deviation = match on_limit {
        Some(limit) if key == "rack_over_roller" => limit * micrometre,
        Some(_) => 0,
        None => bell,
    };
    decimal(nominal + deviation, decimals)
}

fn spec_of_lot(random: &mut Random, columns: &[Column], [lower, upper]: [i32; 2], uncertain: bool) -> String {
    let (rack_helix, pinion_helix) = (random.pick(&[0, 0, 5, -12]), random.pick(&[0, 15, 25, -21]));
    let mut spec = format!("title = \"a lot\"\n[pair]\nnormal_pressure_angle = {}\n", random.hundredths(1700, 2300));
    spec += &format!("[rack]\nhelix_angle = {rack_helix}\nface_width = 19.7\n[pinion]\nhelix_angle = {pinion_helix}\n");
    spec += &format!("[limits]\ncenter_distance = {{ lower = \"{lower} um\", upper = \"{upper} um\" }}\n");
    if random.one_in(3) {
        spec += "rack_over_roller = \"±0.02\"\n";
    }
    let (mut errors, mut names) = ("[errors]\n".to_owned(), "[table.columns]\npart_id = \"part_id\"\n".to_owned());
    for &(key, _, name, nominal, _, decimals) in columns {
        let u = if uncertain && key != "rack_lead" {
            format!("u = \"{} um\"", random.hundredths(20, 200))
        } else {
            String::new()
        };
        let nominal = if nominal == 0 { String::new() } else { format!("nominal = {}", decimal(nominal, decimals)) };
        let comma = if u.is_empty() || nominal.is_empty() { "" } else { ", " };
        if !(u.is_empty() && nominal.is_empty()) {
            errors += &format!("{key} = {{ {nominal}{comma}{u} }}\n");
        }
        if !name.is_empty() {
            names += &format!("{key} = {{ name = \"{name}\" }}\n");
        }
    }
    spec + &errors + &names
}

/// 5000 parts, and 250 of them with all digits.
fn lot(inputs: &Inputs, index: usize) -> Subject {
    let name = format!("lot-{index:02}");
    let uncertain = write_lot(inputs, &name, index % 4, 5000);
    let (stack, model) = (["range", "worst", "rss"][index % 3], ["exact", "paper"][index / 3 % 2]);
    let rule = if uncertain { " --rule iso14253" } else { ["", " --rule guard=5um"][index % 2] };
    let comma = if index % 4 == 3 { " --decimal comma" } else { "" };
    let how = format!("--stack {stack} --model {model}{rule}{comma}");
    let runs = [
        format!("batch {name}.toml {name}.csv {how}"),
        format!("batch {name}.toml {name}.csv {how} --summary --format json"),
        format!("batch {name}.toml {name}-few.csv {how} --decimals full"),
        format!("batch {name}.toml {name}-few.csv {how} --only-failures --format jsonl"),
        format!(
            "batch {name}.toml {name}-few.csv {how} --rejects {name}-rejects.csv --format tsv --columns part_id,verdict"
        ),
    ];
    (name, runs.into())
}

/// 25 racks with a row per space, through the exact mesh.
fn lot_of_teeth(inputs: &Inputs, index: usize) -> Subject {
    let name = format!("teeth-{index}");
    let mut random = Random::of(&name);
    inputs.write(&format!("{name}.toml"), &(gear(&mut random, false).0 + &limits(&mut random)));
    let mut table =
        "part_id,space,over_pin_deviation [um],position_deviation [um],lead_deviation [arcmin]\n".to_owned();
    for part in 0..25 {
        for space in -4..=8 {
            let lead = if index % 2 == 1 { random.hundredths(-100, 100) } else { 0.0 };
            let (over_pin, position) = (random.hundredths(-1000, 1000), random.hundredths(-500, 500));
            table += &format!("R{part},{space},{over_pin},{position},{lead}\n");
        }
    }
    inputs.write(&format!("{name}.csv"), &table);
    let batch = format!("batch {name}.toml {name}.csv --teeth --to 10");
    (name, vec![format!("{batch} --decimals full"), format!("{batch} --summary --format json")])
}

// ---- what is stored ------------------------------------------------------------------------------------------------

/// FNV-1a.
fn digest(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// What is stored of a text.
fn shortened(text: &str, arguments: &str) -> String {
    let is_table = arguments.contains("--format csv") || arguments.starts_with("batch");
    if text.starts_with("<!DOCTYPE") {
        page_text(text)
    } else if text.starts_with("<svg") {
        drawing(text)
    } else if text.starts_with("{\n") {
        in_blocks(&folded(text), |line| line.trim_start().starts_with('{') && line.ends_with(['}', ',']))
    } else if is_table && !arguments.contains("--decimals full") {
        let lines: Vec<_> = text.lines().map(str::to_owned).collect();
        in_blocks(&lines, |line| line.contains(|c: char| c.is_ascii_digit()) && !line.starts_with("error"))
    } else {
        text.to_owned()
    }
}

/// JSON with every innermost object and array on one line.
fn folded(json: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut innermost = None;
    for line in json.lines() {
        let closes = line.trim_start().starts_with(['}', ']']);
        if let Some(open) = innermost.take_if(|_| closes) {
            let within: Vec<_> = lines.drain(open + 1..).collect();
            for part in within.iter().map(String::as_str).chain([line]) {
                lines[open] += " ";
                lines[open] += part.trim_start();
            }
        } else {
            innermost = if line.ends_with(['{', '[']) { Some(lines.len()) } else { innermost };
            lines.push(line.to_owned());
        }
    }
    lines
}

/// The lines, with many rows as blocks: the first row, then counts, sums and a digest of all rows of the block.
fn in_blocks(lines: &[String], is_row: impl Fn(&str) -> bool) -> String {
    let mut text = String::new();
    for run in lines.chunk_by(|a, b| is_row(a) == is_row(b)) {
        if run.len() <= BLOCK || !is_row(&run[0]) {
            text += &(run.join("\n") + "\n");
        } else {
            for rows in run.chunks(BLOCK) {
                text += &format!("{}\n    {}\n", rows[0], summary(&rows.join("\n")));
            }
        }
    }
    text
}

/// How many rows and verdicts, the sums of the rows' first, second … numbers, and the digest.
fn summary(rows: &str) -> String {
    let mut sums: Vec<f64> = Vec::new();
    for row in rows.lines() {
        let (_, numbers) = skeleton(row);
        sums.resize(sums.len().max(numbers.len()), 0.0);
        sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
    }
    let mut text = format!("{} rows", rows.lines().count());
    for verdict in ["pass", "fail", "indeterminate"].iter().filter(|verdict| rows.contains(**verdict)) {
        text += &format!(", {} {verdict}", rows.matches(verdict).count());
    }
    text += ", sums";
    for sum in sums {
        text += &format!(" {}", format!("{sum:.9}").trim_end_matches('0').trim_end_matches('.'));
    }
    format!("{text}, fnv_{:016x}", digest(rows))
}

/// The texts of a page, and of each drawing a summary.
fn page_text(html: &str) -> String {
    let (mut text, mut rest) = (String::new(), html);
    while let Some(start) = ["<style", "<svg"].iter().filter_map(|tag| rest.find(tag)).min() {
        let end = start + ["</style>", "</svg>"].iter().filter_map(|tag| rest[start..].find(tag)).min().unwrap();
        text += &rest[..start];
        if rest[start..].starts_with("<svg") {
            text += &drawing(&rest[start..end]);
        }
        rest = &rest[end..];
    }
    let text = without_tags(&(text + rest));
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    format!("{}\npage fnv_{:016x}\n", lines.collect::<Vec<_>>().join("\n"), digest(html))
}

/// The texts of a drawing, how many numbers it has, and their sum.
fn drawing(svg: &str) -> String {
    let (_, numbers) = skeleton(&svg.replace(char::is_alphabetic, " "));
    let texts = without_tags(svg).split_whitespace().collect::<Vec<_>>().join(" ");
    let sum: f64 = numbers.iter().sum();
    format!("drawing: {texts}\n{} numbers, sum {sum:.3}, fnv_{:016x}\n", numbers.len(), digest(svg))
}

fn without_tags(html: &str) -> String {
    let texts = html.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text));
    texts.map(|text| if text.ends_with('\n') { text.to_owned() } else { format!("{text} ") }).collect()
}

// ---- comparison ----------------------------------------------------------------------------------------------------

fn write(folder: &Path, answers: &Answers) {
    let _ = std::fs::remove_dir_all(folder);
    std::fs::create_dir_all(folder).unwrap();
    for (name, text) in answers {
        std::fs::write(folder.join(format!("{name}.txt")), text).unwrap();
    }
}

fn read(folder: &Path) -> Answers {
    let files = std::fs::read_dir(folder).expect("tests/goldens has been written").map(|file| file.unwrap().path());
    let name = |file: &Path| file.file_stem().unwrap().to_str().unwrap().to_owned();
    files.map(|file| (name(&file), std::fs::read_to_string(&file).unwrap())).collect()
}

/// Every run by its file and command line.
fn runs(answers: &Answers) -> BTreeMap<(&str, &str), &str> {
    let mut runs = BTreeMap::new();
    for (name, text) in answers {
        for run in text.split("=== rackmesh ").skip(1) {
            let (command, output) = run.split_once('\n').unwrap();
            runs.insert((name.as_str(), command), output);
        }
    }
    runs
}

/// Prints every run that differs, the first ones with their lines, and fails if there is any.
fn compare(stored: &Answers, answers: &Answers) {
    let (before, now) = (runs(stored), runs(answers));
    let keys: BTreeSet<_> = before.keys().chain(now.keys()).collect();
    let mut differing = 0;
    for key in &keys {
        let (kind, lines) = match (before.get(key), now.get(key)) {
            (Some(before), Some(now)) if before == now => continue,
            (Some(before), Some(now)) => (difference(before, now), differing_lines(before, now)),
            (Some(_), None) => ("not run any more".to_owned(), String::new()),
            (None, _) => ("not stored yet".to_owned(), String::new()),
        };
        differing += 1;
        println!("{}: rackmesh {}: {kind}", key.0, key.1);
        if differing <= SHOWN {
            print!("{lines}");
        }
    }
    assert!(differing == 0, "{differing} of {} answers are not those in tests/goldens", keys.len());
}

/// What kind of difference it is, and how large where only numbers differ.
fn difference(before: &str, now: &str) -> String {
    let exit = |text: &str| text.lines().next().unwrap_or_default().to_owned();
    if exit(before) != exit(now) {
        return format!("exit status `{}` is now `{}`", exit(before), exit(now));
    }
    let ((text_before, before), (text_now, now)) = (skeleton(before), skeleton(now));
    if text_before != text_now {
        return "the text differs".to_owned();
    }
    let (mut count, mut absolute, mut relative) = (0, 0.0_f64, 0.0_f64);
    for (a, b) in before.iter().zip(&now).filter(|(a, b)| a != b) {
        count += 1;
        absolute = absolute.max((a - b).abs());
        relative = relative.max((a - b).abs() / a.abs().max(b.abs()));
    }
    match count {
        0 => "only digests or spaces differ: something between the stored rows".to_owned(),
        _ => format!("{count} of {} numbers differ, by at most {absolute:.2e}, relatively {relative:.2e}", now.len()),
    }
}

/// The first lines that differ, from shortly before the difference.
fn differing_lines(before: &str, now: &str) -> String {
    let count = before.lines().count().max(now.lines().count());
    let padded = |text: &str| -> Vec<String> {
        text.lines().chain(std::iter::repeat("")).take(count).map(str::to_owned).collect()
    };
    let (before, now) = (padded(before), padded(now));
    let mut text = String::new();
    for (before, now) in before.iter().zip(&now).filter(|(before, now)| before != now).take(3) {
        let same = before.chars().zip(now.chars()).take_while(|(a, b)| a == b).count();
        for (sign, line) in [('-', before), ('+', now)] {
            let part: String = line.chars().skip(same.saturating_sub(60)).take(160).collect();
            text += &format!("  {sign} {part}\n");
        }
    }
    text
}

/// A text without its numbers, digests and repeated spaces, and its numbers. Digits within a word are no number.
fn skeleton(text: &str) -> (String, Vec<f64>) {
    let (mut words, mut numbers, mut rest) = (String::new(), Vec::new(), text);
    while let Some(first) = rest.chars().next() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let end = match first {
            '0'..='9' => number_length(rest),
            _ if is_word(first) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
            _ => first.len_utf8(),
        };
        let token = &rest[..end];
        if first.is_ascii_digit() {
            let negative = words.ends_with('-');
            if negative || words.ends_with('+') {
                words.pop();
            }
            let magnitude: f64 = token.parse().unwrap();
            numbers.push(if negative { -magnitude } else { magnitude });
            words.push('#');
        } else if token.starts_with("fnv_") {
            words += "fnv_";
        } else if token != " " || !words.ends_with(' ') {
            words += token;
        }
        rest = &rest[end..];
    }
    (words, numbers)
}

/// How many bytes the number has that a text starts with.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| from + text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let mut end = digits(0);
    if text[end..].starts_with('.') {
        end = if digits(end + 1) > end + 1 { digits(end + 1) } else { end };
    }
    let exponent = text[end..].strip_prefix('e').map_or(0, |rest| 1 + usize::from(rest.starts_with(['-', '+'])));
    if exponent > 0 && digits(end + exponent) > end + exponent { digits(end + exponent) } else { end }
}
