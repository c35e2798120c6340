//! The picture of the decision rules: what each makes of a ΔCD that is measured near its limit.
//!
//! `cargo run --example decision_rules > docs/decision-rules.svg` writes it; the continuous integration holds the file
//! to it. The upper limit is 0.05 mm and the standard uncertainty 1.5 µm.

use std::error::Error;

use rackmesh::judge::rule::{Ends, Rule, decide};
use rackmesh::judge::{Interval, Limit, Verdict};
use rackmesh::quantity::Length;
use rackmesh::report::chart::{Axis, Bar, Chart, Layer, Scale, Shape};

const LIMIT_MM: f64 = 0.05;
const STANDARD_MM: f64 = 0.0015;
/// What is shown to either side of the limit: so many steps of a tenth of a micrometre.
const STEPS: i64 = 60;
const STEP_MM: f64 = 1e-4;

fn main() -> Result<(), Box<dyn Error>> {
    let limit = Limit { lower: None, upper: Some(Length::from_mm(LIMIT_MM)?) };
    let rules =
        [("guard band of 4 µm", "guard=4um".parse()?), ("ISO 14253-1", Rule::Iso14253), ("simple", Rule::Simple)];
    let verdicts = [Verdict::Indeterminate, Verdict::Fail, Verdict::Pass];
    let mut layers: Vec<Layer> = Vec::new();
    for verdict in verdicts {
        let mut bars: Vec<Bar> = Vec::new();
        for (row, (_, rule)) in rules.iter().enumerate() {
            let mut reached = Vec::new();
            for step in -STEPS..STEPS {
                let measured = Length::from_mm(LIMIT_MM + (step as f64 + 0.5) * STEP_MM)?;
                let ends = Ends::value(measured.mm(), STANDARD_MM);
                if decide(rule, &limit, Interval::value(measured), Some(&ends), None)?.verdict == verdict {
                    reached.push(LIMIT_MM + step as f64 * STEP_MM);
                }
            }
            if let (Some(left), Some(last)) = (reached.first(), reached.last()) {
                let (low, high) = (row as f64 + 0.2, row as f64 + 0.8);
                bars.push(Bar { left: *left, right: last + STEP_MM, low, high, text: String::new() });
            }
        }
        layers.push(Layer::new(verdict.name(), Shape::Bars(bars)));
    }
    layers.push(Layer::new("upper limit", Shape::LimitsOnX(vec![LIMIT_MM])));
    let chart = Chart {
        title: "Near an upper limit of 0.05 mm, with u = 1.5 µm".to_owned(),
        x: Axis { label: "measured ΔCD [mm]".to_owned(), scale: Scale::Tight },
        y: Axis { label: "rule".to_owned(), scale: Scale::Names(rules.map(|(name, _)| name.to_owned()).into()) },
        layers,
        height: 280.0,
        ..Chart::default()
    };
    print!("{}", chart.svg().ok_or("there is nothing to show")?);
    Ok(())
}
