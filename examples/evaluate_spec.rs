//! A spec from a string: its errors evaluated, combined and judged.
//!
//! Run with `cargo run --example evaluate_spec`.

use rackmesh::evaluation::evaluate;
use rackmesh::formula::Model;
use rackmesh::judge::Stack;
use rackmesh::spec::Spec;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let spec = Spec::parse(
        "lot7.toml",
        r#"
            [pair]
            normal_pressure_angle = 20
            [errors]
            rack_over_roller = { measured = 25.013, nominal = 25.000 }
            rack_pitch = "12 um"
            [limits]
            center_distance = "±0.03"
        "#,
    )?;
    let evaluation = evaluate(&spec.part_deviations()?, &spec.limits(), Model::Exact, Stack::Range, &spec.basis()?)?;
    for contribution in &evaluation.contributions {
        println!("{}: {:.4} mm", contribution.kind, contribution.exact.mm());
    }
    let range = evaluation.combined.interval(evaluation.stack)?;
    println!("ΔCD from {:.4} to {:.4} mm: {:?}", range.lower.mm(), range.upper.mm(), evaluation.verdict);
    Ok(())
}
