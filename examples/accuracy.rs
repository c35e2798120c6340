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
    println!("| formula | values compared | largest error in parts of 1e-12 mm + 8 ulp |");
    println!("|---|---:|---:|");
    for formula in formulas::ALL {
        let checked = formula();
        println!("| {} | {} | {:.2} |", checked.formula, checked.compared, checked.worst);
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
