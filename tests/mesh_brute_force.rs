//! The solver against an independent brute force on random pairs and deviations.
#![allow(missing_docs, clippy::pedantic, clippy::disallowed_methods)]

mod common;

use common::kinds::{KINDS, compare, compare_formed, compare_rolling, run};

/// The brute force's own error: golden sections stop at 2e-9 of a cell, and heights are quadratic there.
const ALLOWED_MM: f64 = 1e-7;

fn long() -> bool {
    std::env::var("RACKMESH_LONG_TESTS").is_ok_and(|v| v == "1")
}

#[test]
fn random_pairs_agree_with_brute_force() {
    let first: u64 = std::env::var("RACKMESH_FIRST_SEED").ok().and_then(|v| v.parse().ok()).unwrap_or(1);
    let count = if long() { 400 } else { 24 };
    // these once found peaks that the solver missed: corners of functions that are not concave, an involute that starts
    // at its base circle, almost no helix
    const ONCE_WRONG: [u64; 6] = [33, 35, 67, 2291, 2481, 384];
    let seeds: Vec<u64> = ONCE_WRONG.into_iter().chain(first..first + count).collect();
    let (compared, worst, failures) = run(&seeds, ALLOWED_MM, compare);
    println!("{compared} pairs compared, largest difference {worst:e} mm");
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn flank_form_agrees_with_brute_force() {
    // at this one both sides touch at the rack's tip edges, which was taken for its tip planes
    let seeds: Vec<u64> = std::iter::once(19).chain(1..if long() { 200 } else { 9 }).collect();
    let (compared, worst, failures) = run(&seeds, 1e-7, compare_formed);
    println!("{compared} pairs with flank form compared, largest difference {worst:e} mm");
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn a_rolling_rack_agrees_with_brute_force_at_every_roll() {
    let first: u64 = std::env::var("RACKMESH_FIRST_SEED").ok().and_then(|v| v.parse().ok()).unwrap_or(1);
    // at this one the derivative by the roll was that of a point that stays, at a vertex that moves
    let seeds: Vec<u64> = std::iter::once(129).chain(first..first + if long() { 30 } else { 1 }).collect();
    let (compared, worst, failures) =
        run(&seeds, 1e-7, |seed| compare_rolling(seed, if long() { 21 } else { 5 }, false));
    println!("{compared} rolling racks compared, largest difference {worst:e} mm");
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn a_rolling_rack_with_flank_form_agrees_with_brute_force_at_every_roll() {
    let first: u64 = std::env::var("RACKMESH_FIRST_SEED").ok().and_then(|v| v.parse().ok()).unwrap_or(1);
    let seeds: Vec<u64> = (first..first + if long() { 30 } else { 2 }).collect();
    let (compared, worst, failures) =
        run(&seeds, 1e-7, |seed| compare_rolling(seed, if long() { 21 } else { 5 }, true));
    println!("{compared} rolling racks with flank form compared, largest difference {worst:e} mm");
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}

/// Parallel axes, an involute from the base circle: where that edge leaves the rack's face the demand's derivative is
/// zero, and the search once took this corner for the highest point, 55 µm too low.
#[test]
fn a_corner_on_the_base_circle_is_no_peak() {
    let (name, compare) = common::kinds::KINDS[1];
    assert_eq!(name, "helical, parallel axes");
    let (difference, case) = compare(26).expect("it has contact");
    assert!(difference.abs() <= 1e-9, "{difference:e}: {case}");
}

/// The first pairs of each kind again: none is worse than the README's table says.
#[test]
fn the_accuracy_that_is_written_is_true() {
    let written = include_str!("../benches/results/accuracy.md");
    for (kind, compare) in KINDS {
        let row = written.lines().find(|line| line.starts_with(&format!("| {kind} |"))).expect(kind);
        let worst = row.split(" | ").nth(2).and_then(|cell| cell.strip_suffix(" mm |")).expect(row);
        let worst: f64 = worst.parse().expect(row);
        assert!(worst < 1e-9, "{row}");
        let seeds: Vec<u64> = if kind.contains("roll") { vec![1] } else { (1..=4).collect() };
        let (_, found, failures) = run(&seeds, ALLOWED_MM, compare);
        // one digit is written, rounded
        assert!(failures.is_empty() && found <= 1.5 * worst, "{row}: {found:e}");
    }
}
