//! Many parts, the law of each error made once: which of them keep ΔCD within a limit?
//!
//! Run with `cargo run --example check_parts`.

use rackmesh::evaluation::evaluate;
use rackmesh::formula::{Law, Model, PartDeviation};
use rackmesh::judge::bound::Basis;
use rackmesh::judge::{Limit, LimitTarget, Stack, Verdict};
use rackmesh::quantity::{Angle, Length};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let lead = Law::rack_lead("19.9 deg".parse()?, Angle::ZERO, "19.7 mm".parse()?)?;
    let limits = vec![(LimitTarget::CenterDistance, Limit::symmetric("0.05 mm".parse()?))];
    let nominal: Length = "25.0000".parse()?;

    for (part, over_roller, lead_error) in
        [("A1", "25.0131", "0.02 deg"), ("A2", "25.0400", "3 arcmin"), ("A3", "24.9980", "-0.1 mrad")]
    {
        let measured: Length = over_roller.parse()?;
        let errors = [
            PartDeviation::new(Law::rack_over_roller(), measured - nominal),
            PartDeviation::new(lead, lead_error.parse::<Angle>()?),
        ];
        let evaluation = evaluate(&errors, &limits, Model::Exact, Stack::Range, &Basis::default())?;
        let verdict = if evaluation.verdict == Some(Verdict::Pass) { "pass" } else { "FAIL" };
        println!("{part}: up to {:+.4} mm  {verdict}", evaluation.combined.range?.upper.mm());
    }
    Ok(())
}
