//! Draws per second of the Monte Carlo simulation: all five errors, on one thread and on all.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rackmesh::decision::monte_carlo::{Settings, simulate_part};
use rackmesh::decision::uncertainty::{Part, Source, Uncertainties, Uncertainty};
use rackmesh::decision::{Limit, LimitTarget, Stack};
use rackmesh::deviation::ErrorKind;
use rackmesh::formula::{Model, PartError, PinionPitch, RackLead, RackPitch};
use rackmesh::quantity::{Angle, Length};

fn angle(text: &str) -> Angle {
    text.parse().expect("an angle")
}

fn length(text: &str) -> Length {
    text.parse().expect("a length")
}

fn errors() -> Vec<PartError> {
    let (alpha, rack, pinion) = (angle("20"), angle("12"), angle("21"));
    let pitch = RackPitch::new(&alpha, &rack).expect("valid");
    let lead = RackLead::new(&alpha, &rack, &length("19.7")).expect("valid");
    vec![
        PartError::RackOverRoller(length("13 um")),
        PartError::RackPitch(length("12 um"), pitch),
        PartError::RackLead(angle("0.0255"), lead),
        PartError::PinionRadial(length("-4 um")),
        PartError::PinionPitch(length("9 um"), PinionPitch::new(&alpha, &pinion).expect("valid")),
    ]
}

fn draws(c: &mut Criterion) {
    const DRAWS: u64 = 2_000_000;
    let errors = errors();
    let part = Part { errors: &errors, over_pin: None, model: Model::Exact, stack: Stack::Range };
    let limits = vec![(LimitTarget::CenterDistance, Limit::symmetric(&length("0.05")))];
    let errors_only: Vec<_> =
        ErrorKind::ALL.into_iter().map(|kind| (Source::Error(kind), Uncertainty::standard(0.0008))).collect();
    let mut with_gear = errors_only.clone();
    with_gear.push((Source::NormalPressureAngle, Uncertainty::standard(0.02)));
    let mut group = c.benchmark_group("draws of five errors");
    group.throughput(Throughput::Elements(DRAWS)).sample_size(10);
    for (name, inputs) in [("errors", errors_only), ("errors and pressure angle", with_gear)] {
        let uncertainties = Uncertainties::new(inputs, &[]).expect("valid");
        for (cores, threads) in [("one thread", Some(1)), ("all cores", None)] {
            let settings = Settings { draws: Some(DRAWS), threads, ..Settings::default() };
            group.bench_function(format!("{name}, {cores}"), |b| {
                b.iter(|| simulate_part(black_box(&part), &uncertainties, &limits, &settings).expect("a result"));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, draws);
criterion_main!(benches);
