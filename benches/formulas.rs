//! What a formula costs: the exact one on rational numbers, its inverse and sensitivities, the same prepared for many
//! parts, and five errors combined and judged.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use rackmesh::decision::{Limit, LimitTarget, Stack, evaluate};
use rackmesh::formula::over_pin::OverPin;
use rackmesh::formula::{
    Model, PartError, PartFormula, PinionPitch, Prepared, RackLead, RackPitch, ideal_pin, over_roller, pinion_radial,
    roller_change,
};
use rackmesh::quantity::{Angle, Length};

fn angle(text: &str) -> Angle {
    text.parse().expect("an angle")
}

fn length(text: &str) -> Length {
    text.parse().expect("a length")
}

/// What is asked of one part: formulas made and evaluated, every digit right.
fn exact(c: &mut Criterion) {
    let (alpha, beta, module) = (angle("20"), angle("12"), length("2"));
    let (error, lead_error, bound) = (length("12 um"), angle("0.0255"), length("0.02"));
    let pitch = RackPitch::new(&alpha, &beta).expect("valid");
    let pinion_pitch = PinionPitch::new(&alpha, &beta).expect("valid");
    let lead = RackLead::new(&alpha, &beta, &length("19.7")).expect("valid");
    let over_pin = OverPin {
        normal_module: module.clone(),
        normal_pressure_angle: alpha.clone(),
        tooth_thickness: None,
        pin_diameter: length("3.5"),
        datum: length("25"),
    };
    let model = Model::Exact;

    let mut group = c.benchmark_group("exact");
    group.bench_function("rack-over-roller", |b| b.iter(|| over_roller::delta_cd(black_box(&error))));
    group.bench_function("rack-pitch", |b| b.iter(|| pitch.delta_cd(black_box(&error), model)));
    group.bench_function("rack-lead", |b| b.iter(|| lead.delta_cd(black_box(&lead_error), model)));
    group.bench_function("pinion-radial", |b| b.iter(|| pinion_radial::delta_cd(black_box(&error))));
    group.bench_function("pinion-pitch", |b| b.iter(|| pinion_pitch.delta_cd(black_box(&error), model)));
    group.bench_function("ideal-pin", |b| b.iter(|| ideal_pin::diameter(black_box(&module), &alpha, None)));
    group.bench_function("over-pin", |b| b.iter(|| black_box(&over_pin).measure()));
    group.bench_function("roller-change", |b| {
        b.iter(|| roller_change::difference(black_box(&length("3.5")), &length("4"), &alpha));
    });
    group.finish();

    let mut group = c.benchmark_group("made for a gear");
    group.bench_function("rack-pitch", |b| b.iter(|| RackPitch::new(black_box(&alpha), &beta)));
    group.bench_function("rack-lead", |b| b.iter(|| RackLead::new(black_box(&alpha), &beta, &length("19.7"))));
    group.finish();

    let mut group = c.benchmark_group("largest error");
    group.bench_function("rack-pitch", |b| b.iter(|| pitch.largest_error(black_box(&bound), model)));
    group.bench_function("rack-lead", |b| b.iter(|| lead.largest_error(black_box(&bound), model)));
    group.finish();

    let mut group = c.benchmark_group("sensitivities");
    group.bench_function("rack-pitch", |b| b.iter(|| pitch.sensitivities(black_box(&error), model)));
    group.bench_function("rack-lead", |b| b.iter(|| lead.sensitivities(black_box(&lead_error), model)));
    group.finish();
}

/// The same for the million parts of a batch.
fn prepared(c: &mut Criterion) {
    let (alpha, beta) = (angle("20"), angle("12"));
    let pitch = PartFormula::RackPitch(RackPitch::new(&alpha, &beta).expect("valid"));
    let lead = PartFormula::RackLead(RackLead::new(&alpha, &beta, &length("19.7")).expect("valid"));
    let [pitch, lead] = [pitch, lead].map(|formula| Prepared::new(&formula, Model::Exact));
    let mut group = c.benchmark_group("prepared");
    group.bench_function("rack-pitch, double precision", |b| b.iter(|| pitch.delta_cd_mm(black_box(0.012))));
    group.bench_function("rack-pitch, units of 1e-15 mm", |b| b.iter(|| pitch.fixed(black_box(12_000_000_000_000))));
    group.bench_function("rack-lead, double precision", |b| b.iter(|| lead.delta_cd_mm(black_box(0.0255))));
    group.bench_function("rack-lead, units of 1e-15 mm", |b| b.iter(|| lead.fixed_from_degrees(black_box(0.0255))));
    group.finish();
}

/// Five errors of a part, combined and held against a limit, as `eval` does it.
fn evaluation(c: &mut Criterion) {
    let (alpha, beta) = (angle("20"), angle("12"));
    let lead = RackLead::new(&alpha, &beta, &length("19.7")).expect("valid");
    let errors = [
        PartError::RackOverRoller(length("13 um")),
        PartError::RackPitch(length("12 um"), RackPitch::new(&alpha, &beta).expect("valid")),
        PartError::RackLead(angle("0.0255"), lead),
        PartError::PinionRadial(length("-4 um")),
        PartError::PinionPitch(length("9 um"), PinionPitch::new(&alpha, &beta).expect("valid")),
    ];
    let limits = vec![(LimitTarget::CenterDistance, Limit::symmetric(&length("0.05")))];
    c.bench_function("five errors, combined and judged", |b| {
        b.iter(|| evaluate(black_box(&errors), &limits, Model::Exact, Stack::Range));
    });
}

criterion_group!(benches, exact, prepared, evaluation);
criterion_main!(benches);
