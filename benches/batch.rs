//! `rackmesh batch` against an ordinary program on the csv crate: CPU time for each row, side by side.
//!
//! The ordinary program is this file's own executable, called with `--baseline`: the csv crate, `f64` parsing
//! and formatting, fixed columns, one thread, no checks. Both read the same table and write as many columns.
//! CPU time is user and system time of the child (Linux); runs alternate, and the median counts. Then the
//! summary, ten times the rows, and the table packed.
//!
//! Run with `cargo bench --bench batch`.

use std::io::{BufWriter, Write as _};
use std::process::{Command, Stdio};
use std::time::Instant;

const SPEC: &str = "[pair]\nnormal_pressure_angle = 20\n[rack]\nface_width = 19.8\n[limits]\ncenter_distance = \"±0.15\"\n\
                    [errors]\nrack_over_roller = { nominal = 25.0 }\npinion_radial = { nominal = 8.5 }\n\
                    [table.columns]\nrack_over_roller = { name = \"over_roller\", unit = \"mm\" }\n\
                    rack_pitch = { name = \"dp\", unit = \"mm\" }\nrack_lead = { name = \"dbeta\", unit = \"deg\" }\n\
                    pinion_radial = { name = \"radial\", unit = \"mm\" }\npinion_pitch = { name = \"dfp\", unit = \"mm\" }\n";
/// Nine columns, as the other program writes.
const COLUMNS: &str = "part_id,delta_cd_rack_over_roller_mm,delta_cd_rack_pitch_mm,delta_cd_rack_lead_mm,\
                       delta_cd_pinion_radial_mm,delta_cd_pinion_pitch_mm,range_lower_mm,range_upper_mm,verdict";
const RUNS: usize = 5;
const MILLION: u64 = 1_000_000;

/// A table of deterministic random parts.
fn write_table(path: &str, rows: u64) {
    let file = std::fs::File::create(path).expect("the table can be written");
    let mut out = BufWriter::with_capacity(1 << 20, file);
    let mut state = 20_261_121u64;
    let mut random = move |most: i64| {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        let below = z % (2 * most.unsigned_abs() + 1);
        i64::try_from(below).expect("small") - most
    };
    let decimal = |value: i64| {
        let sign = if value < 0 { "-" } else { "" };
        format!("{sign}{}.{:04}", value.abs() / 10_000, value.abs() % 10_000)
    };
    writeln!(out, "part_id,over_roller,dp,dbeta,radial,dfp").expect("the table can be written");
    for part in 1..=rows {
        let (a, b, c, d, e) = (random(200), random(200), random(2500), random(200), random(200));
        let cells = [decimal(250_000 + a), decimal(b), decimal(c), decimal(85_000 + d), decimal(e)];
        writeln!(out, "P{part:07},{}", cells.join(",")).expect("the table can be written");
    }
    out.flush().expect("the table can be written");
}

fn baseline(input: &str, output: &str) {
    let mut reader = csv::Reader::from_path(input).expect("the table is there");
    let mut out = BufWriter::with_capacity(1 << 16, std::fs::File::create(output).expect("a file"));
    writeln!(out, "part_id,d1,d2,d3,d4,d5,lower,upper,pass").expect("written");
    let radians = std::f64::consts::PI / 180.0;
    let twice_tan = 2.0 * libm::tan(20.0 * radians);
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).expect("a record") {
        let field = |index: usize| record[index].parse::<f64>().expect("a number");
        let over_roller = field(1) - 25.0;
        let pitch = field(2).abs() / twice_tan;
        let turn = field(3) * radians;
        let lead = (19.8 * libm::sin(turn) / twice_tan).abs();
        // a turned tooth line at the end of the face, a quarter of the face width from the reference plane
        let turned = lead / libm::cos(turn) + 4.95 * (1.0 / libm::cos(turn) - 1.0);
        let radial = field(4) - 8.5;
        let pinion = field(5).abs() / twice_tan;
        let either_way = pitch + turned + pinion;
        let (lower, upper) = (over_roller + radial.min(0.0) - either_way, over_roller + radial.max(0.0) + either_way);
        let pass = u8::from(lower >= -0.15 && upper <= 0.15);
        let id = &record[0];
        writeln!(
            out,
            "{id},{over_roller:.6},{pitch:.6},{lead:.6},{radial:.6},{pinion:.6},{lower:.6},{upper:.6},{pass}"
        )
        .expect("written");
    }
    out.flush().expect("written");
}

/// What running a program took.
#[derive(Clone, Copy)]
struct Cost {
    cpu_seconds: f64,
    wall_seconds: f64,
    peak_kib: u64,
}

/// CPU time of all children so far, in clock ticks of a hundredth of a second.
fn children_ticks() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<_> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |index: usize| fields.get(index).and_then(|field| field.parse::<f64>().ok()).unwrap_or(0.0);
    // cutime and cstime are the fields 16 and 17, and what follows the name starts at field 3
    ticks(13) + ticks(14)
}

fn cost(program: &str, arguments: &[&str]) -> Cost {
    let before = children_ticks();
    let start = Instant::now();
    let mut child = Command::new(program)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let mut peak_kib = 0;
    while child.try_wait().expect("the program is waited for").is_none() {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        peak_kib = peak_kib.max(peak.and_then(|peak| peak.trim().trim_end_matches(" kB").parse().ok()).unwrap_or(0));
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let wall_seconds = start.elapsed().as_secs_f64();
    Cost { cpu_seconds: (children_ticks() - before) / 100.0, wall_seconds, peak_kib }
}

/// The median by CPU time of runs in turn.
fn in_turn(jobs: &[(&str, &str, Vec<&str>)]) -> Vec<Cost> {
    let mut costs = vec![Vec::new(); jobs.len()];
    for _ in 0..RUNS {
        for ((_, program, arguments), costs) in jobs.iter().zip(&mut costs) {
            costs.push(cost(program, arguments));
        }
    }
    costs
        .into_iter()
        .map(|mut costs| {
            costs.sort_by(|a, b| a.cpu_seconds.total_cmp(&b.cpu_seconds));
            costs[RUNS / 2]
        })
        .collect()
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, flag, input, output] = arguments.as_slice()
        && flag == "--baseline"
    {
        return baseline(input, output);
    }
    let folder = std::env::temp_dir().join(format!("rackmesh-batch-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    let path = |name: &str| folder.join(name).to_str().expect("the path is UTF-8").to_owned();
    let (spec, table, long, output) = (path("spec.toml"), path("1e6.csv"), path("1e7.csv"), path("out.csv"));
    std::fs::write(&spec, SPEC).expect("the spec can be written");
    write_table(&table, MILLION);
    write_table(&long, 10 * MILLION);
    let own = std::env::current_exe().expect("this program has a path");
    let own = own.to_str().expect("the path is UTF-8");
    let rackmesh = env!("CARGO_BIN_EXE_rackmesh");
    let rows = |table, extra: &[&'static str]| {
        let mut arguments: Vec<&str> = vec!["batch", &spec, table, "-o", &output, "--columns", COLUMNS];
        arguments.extend(extra);
        arguments
    };
    let jobs = [
        ("csv crate, no checks", own, vec!["--baseline", &table, &output]),
        ("rackmesh", rackmesh, rows(&table, &[])),
        ("rackmesh, one thread", rackmesh, rows(&table, &["--threads", "1"])),
        ("rackmesh, ten times the rows", rackmesh, rows(&long, &[])),
        ("rackmesh --summary, one thread", rackmesh, vec!["batch", &spec, &table, "--summary", "--threads", "1"]),
    ];
    let costs = in_turn(&jobs);
    println!("{:32} {:>11} {:>13} {:>9} {:>8}", "", "CPU µs/row", "rows/s", "peak MiB", "ratio");
    for ((name, ..), cost) in jobs.iter().zip(&costs) {
        let rows = if name.contains("ten times") { 1e7 } else { 1e6 };
        let peak_mib = cost.peak_kib as f64 / 1024.0;
        println!(
            "{name:32} {:11.3} {:13.0} {:9.1} {:8.2}",
            1e6 * cost.cpu_seconds / rows,
            rows / cost.wall_seconds,
            peak_mib,
            cost.cpu_seconds / rows / (costs[0].cpu_seconds / 1e6)
        );
    }
    let _ = std::fs::remove_dir_all(&folder);
}
