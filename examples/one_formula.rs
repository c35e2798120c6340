//! One formula: ΔCD of a pitch error, the largest error within a ΔCD, and the sensitivities.
//!
//! Run with `cargo run --example one_formula`.

use rackmesh::formula::{Model, RackPitch};
use rackmesh::quantity::LengthUnit;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let formula = RackPitch::new(&"20 deg".parse()?, &"12 deg".parse()?)?;
    let pitch_error = "20 um".parse()?;
    for model in [Model::Exact, Model::Paper] {
        let delta_cd = formula.delta_cd(&pitch_error, model)?;
        println!("{model} model: ΔCD = {:.3} µm", delta_cd.in_unit(LengthUnit::Micrometre));
    }

    let largest = formula.largest_error(&"50 um".parse()?, Model::Exact)?;
    println!("ΔCD stays within 50 µm up to |Δp| = {:.3} µm", largest.in_unit(LengthUnit::Micrometre));

    for sensitivity in formula.sensitivities(&pitch_error, Model::Exact)? {
        println!("∂ΔCD/∂{:?} = {:?}", sensitivity.input, sensitivity.value);
    }
    Ok(())
}
