//! Measured numbers in the README are copied from the files that the examples wrote, and never typed.
//!
//! `RACKMESH_UPDATE=1 cargo test --test it readme` copies them anew.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// Holds the README's text between `<!-- name -->` and `<!-- end -->` against `text`, or replaces it.
fn check(name: &str, text: &str) {
    // the tests run side by side, and each replaces its own part
    static ONE_AT_A_TIME: std::sync::Mutex<()> = std::sync::Mutex::new(());
    let _one = ONE_AT_A_TIME.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let path = root().join("README.md");
    let readme = std::fs::read_to_string(&path).unwrap();
    let begin = format!("<!-- {name} -->\n");
    let start = readme.find(&begin).unwrap_or_else(|| panic!("README.md has no {begin}")) + begin.len();
    let end = start + readme[start..].find("<!-- end -->").unwrap();
    if std::env::var_os("RACKMESH_UPDATE").is_some() {
        std::fs::write(&path, format!("{}{text}{}", &readme[..start], &readme[end..])).unwrap();
    } else {
        assert_eq!(&readme[start..end], text, "RACKMESH_UPDATE=1 cargo test --test it readme copies the numbers anew");
    }
}

/// A number of the file with two digits: 3.5 µs, 0.12 s; 1.4 µm, 0.03 nm.
fn in_words(value: f64, unit: &str) -> String {
    let (size, prefix) = [(1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p")]
        .into_iter()
        .find(|(size, _)| value >= 0.999 * size)
        .unwrap_or((1e-12, "p"));
    let value = value / size;
    let decimals = if value >= 10.0 {
        0
    } else if value >= 1.0 {
        1
    } else {
        2
    };
    format!("{value:.decimals$} {prefix}{unit}")
}

/// Case, run time in s, error in mm.
type Measured<'a> = (&'a str, f64, f64);

#[test]
fn run_time_and_error() {
    let file = std::fs::read_to_string(root().join("benches/results/run-time-and-error.csv")).unwrap();
    let mut rows: BTreeMap<(&str, &str), Vec<Measured<'_>>> = BTreeMap::new();
    for line in file.lines().skip(1) {
        let cells: Vec<_> = line.split(',').collect();
        let [case, model, setting, time, error, _] = cells[..] else { panic!("{line}") };
        rows.entry((model, setting)).or_default().push((case, time.parse().unwrap(), error.parse().unwrap()));
    }
    let mut table =
        "| model | setting | run time | error: over-roller | pitch | lead |\n|---|---|---|---|---|---|\n".to_owned();
    for key in [
        ("formula", "exact model"),
        ("exact mesh", "tolerance 1e-3"),
        ("exact mesh", "tolerance 1e-6"),
        ("equilibrium (spheres)", "48 × 96 spheres"),
        ("equilibrium (exact surfaces)", "64 strips"),
        ("in time (spheres)", "48 × 96 spheres"),
        ("in time (spheres)", "96 × 192 spheres"),
    ] {
        let cases = &rows[&key];
        let names: Vec<_> = cases.iter().map(|case| case.0).collect();
        assert_eq!(names, ["over-roller", "pitch", "lead"]);
        let (fastest, slowest) =
            cases.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), case| (low.min(case.1), high.max(case.1)));
        let errors: Vec<_> = cases
            .iter()
            .map(|case| if case.2 < 1e-11 { "none".to_owned() } else { in_words(1e-3 * case.2, "m") })
            .collect();
        let time = format!("{} … {}", in_words(fastest, "s"), in_words(slowest, "s"));
        table.push_str(&format!("| {} | {} | {time} | {} |\n", key.0, key.1, errors.join(" | ")));
    }
    check("run time and error", &table);
}

#[test]
fn accuracy() {
    let written = std::fs::read_to_string(root().join("benches/results/accuracy.md")).unwrap();
    check("accuracy", &written);
    // the promise of src/formula/precision.md, which rounding to the last digit nearly fills by half
    let formulas = written.lines().take_while(|line| !line.is_empty()).skip(2);
    let errors = formulas.map(|line| line.trim_end_matches(" |").rsplit(' ').next().unwrap().parse::<f64>().unwrap());
    let worst = errors.fold(0.0, f64::max);
    assert!(worst > 0.4 && worst <= 1.0, "{worst}");
}
