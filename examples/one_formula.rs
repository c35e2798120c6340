//! One formula: ΔCD of a pitch error, the largest error within a ΔCD, and the sensitivities.
//!
//! Run with `cargo run --example one_formula`.

use rackmesh::formula::{Law, Model};
use rackmesh::quantity::{Length, LengthUnit};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let law = Law::rack_pitch("20 deg".parse()?, "12 deg".parse()?)?;
    let pitch_error: Length = "20 um".parse()?;
    for model in [Model::Exact, Model::Paper] {
        let delta_cd = law.delta_cd(pitch_error, model)?;
        println!("{model} model: ΔCD = {:.3} µm", delta_cd.in_unit(LengthUnit::Micrometre));
    }

    let largest = law.largest_error("50 um".parse()?, Model::Exact)?;
    println!("ΔCD stays within 50 µm up to |Δp| = {largest}");

    for sensitivity in law.sensitivities(pitch_error, Model::Exact)? {
        println!("∂ΔCD/∂{:?} = {:?}", sensitivity.input, sensitivity.value);
    }
    Ok(())
}
