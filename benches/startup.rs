//! Start-up: `rackmesh eval` on a small spec against a minimal program that parses the same spec.
//!
//! The minimal program is this file's own executable, called with `--baseline`: clap, serde and toml,
//! two formulas in plain f64, one line printed. Both are run in turn, and the ratio of their median wall
//! times is printed, with the peak memory of `rackmesh` (Linux).
//!
//! Run with `cargo bench --bench startup`.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use clap::Parser;

const SPEC: &str = "title = \"start-up\"\n[pair]\nnormal_pressure_angle = 20.0\n[rack]\nface_width = 19.7\n\
                    [errors]\nrack_pitch = 0.02\nrack_lead = 0.25\n";
const RUNS: usize = 300;

#[derive(Parser)]
struct Arguments {
    /// Act as the minimal program on this spec.
    #[arg(long)]
    baseline: Option<String>,
    /// `cargo bench` passes this on.
    #[arg(long)]
    bench: bool,
}

#[derive(serde::Deserialize)]
struct Spec {
    title: String,
    pair: Pair,
    rack: Rack,
    errors: Errors,
}

#[derive(serde::Deserialize)]
struct Pair {
    normal_pressure_angle: f64,
}

#[derive(serde::Deserialize)]
struct Rack {
    face_width: f64,
}

#[derive(serde::Deserialize)]
struct Errors {
    rack_pitch: f64,
    rack_lead: f64,
}

fn baseline(path: &str) {
    let text = std::fs::read_to_string(path).expect("the spec is there");
    let spec: Spec = toml::from_str(&text).expect("the spec is valid");
    let radians = std::f64::consts::PI / 180.0;
    let twice_tan = 2.0 * libm::tan(spec.pair.normal_pressure_angle * radians);
    let pitch = spec.errors.rack_pitch.abs() / twice_tan;
    let lead = spec.rack.face_width * libm::sin(spec.errors.rack_lead * radians).abs() / twice_tan;
    println!("{}: {pitch} {lead}", spec.title);
}

fn time(program: &str, arguments: &[&str]) -> Duration {
    let start = Instant::now();
    let status = Command::new(program).args(arguments).stdout(Stdio::null()).status().expect("it runs");
    assert!(status.success(), "{program} failed");
    start.elapsed()
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort_unstable();
    times[times.len() / 2]
}

/// Peak resident memory of a running program, sampled until it ends: its last `VmHWM` line, in KiB.
fn peak_kib(program: &str, arguments: &[&str]) -> Option<u64> {
    let mut child = Command::new(program).args(arguments).stdout(Stdio::null()).spawn().ok()?;
    let mut peak = None;
    while child.try_wait().ok()?.is_none() {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        peak = peak.max(line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok()));
    }
    peak
}

fn main() {
    let arguments = Arguments::parse();
    if let Some(path) = arguments.baseline {
        return baseline(&path);
    }
    let path = std::env::temp_dir().join(format!("rackmesh-startup-{}.toml", std::process::id()));
    std::fs::write(&path, SPEC).expect("the spec can be written");
    let spec = path.to_str().expect("the path is UTF-8");
    let own = std::env::current_exe().expect("this program has a path");
    let own = own.to_str().expect("the path is UTF-8");
    let rackmesh = env!("CARGO_BIN_EXE_rackmesh");

    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..RUNS {
        ours.push(time(rackmesh, &["eval", spec]));
        theirs.push(time(own, &["--baseline", spec]));
    }
    let (ours, theirs) = (median(ours), median(theirs));
    println!("eval of a small spec, median of {RUNS} runs in turn:");
    println!("  rackmesh          {ours:.2?}");
    println!("  minimal program   {theirs:.2?}");
    println!("  ratio             {:.2}", ours.as_secs_f64() / theirs.as_secs_f64());
    let peaks = (0..50).filter_map(|_| peak_kib(rackmesh, &["eval", spec]));
    if let Some(peak) = peaks.max() {
        println!("  rackmesh's memory {peak} KiB");
    }
    let _ = std::fs::remove_file(&path);
}
