//! How accurate everything is: the formulas against big floats, the exact mesh against brute force.
//!
//! `cargo run --release --example accuracy > benches/results/accuracy.md` writes the tables that the README shows;
//! tests hold the README to them and the solver to the table. Every case comes from a seed. The multibody model has its
//! orders of convergence against those that theory gives.

#[path = "../tests/it/common/mod.rs"]
mod common;

use common::formulas;

/// Random pairs of each kind; a rolling rack takes as long as twenty others.
const PAIRS: u64 = 100;
const ROLLING: u64 = 10;

fn main() {
    println!("| formula | values compared | largest error | its inverse and sensitivities |");
    println!("|---|---:|---:|---:|");
    for formula in formulas::ALL {
        let checked = formula();
        let values: u64 = checked.results.iter().map(|(_, values, _)| values).sum();
        let (own, derived): (Vec<_>, Vec<_>) = checked.results.iter().partition(|(result, ..)| {
            !result.contains("inverse") && !result.contains(", by ") && !result.contains("any")
        });
        let worst =
            |results: &[&(String, u64, f64)]| results.iter().fold(0.0_f64, |worst, (.., ulps)| worst.max(*ulps));
        let derived = if derived.is_empty() { "-".to_owned() } else { format!("{:.4} ulp", worst(&derived)) };
        println!("| {} | {values} | {:.4} ulp | {derived} |", checked.formula, worst(&own));
    }
    println!();
    println!("| exact mesh, random pairs | pairs | largest difference from brute force |");
    println!("|---|---:|---:|");
    for (kind, compare) in common::kinds::KINDS {
        let count = if kind.contains("roll") { ROLLING } else { PAIRS };
        let seeds: Vec<u64> = (1..=count).collect();
        let (compared, worst, failures) = common::kinds::run(&seeds, 1e-7, compare);
        assert!(failures.is_empty(), "{kind}:\n{}", failures.join("\n"));
        println!("| {kind} | {compared} | {worst:.0e} mm |");
    }
    println!();
    println!("| multibody model: error over | from | to | order | in theory |");
    println!("|---|---:|---:|---:|---:|");
    for convergence in common::convergence::all() {
        let [first, .., last] = convergence.errors[..] else { continue };
        let at = |(setting, error): (f64, f64)| format!("{:.1e} mm at {setting:.3} {}", error, convergence.unit);
        let (what, order, expected) = (convergence.what, convergence.order(), convergence.expected);
        println!("| {what} | {} | {} | {order:.2} | {expected:.2} |", at(first), at(last));
    }
}
