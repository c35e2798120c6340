//! What a formula costs: value, inverse and sensitivities of the laws, and five errors combined and judged.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use rackmesh::evaluation::evaluate;
use rackmesh::formula::over_pin::OverPin;
use rackmesh::formula::{Law, Model, PartDeviation, ideal_pin, roller_change};
use rackmesh::judge::bound::Basis;
use rackmesh::judge::{Limit, LimitTarget, Stack};
use rackmesh::quantity::{Angle, Length};

fn angle(text: &str) -> Angle {
    text.parse().expect("an angle")
}

fn length(text: &str) -> Length {
    text.parse().expect("a length")
}

/// ΔCD of one error, which law it takes, the largest error within a ΔCD, and the sensitivities.
fn laws(c: &mut Criterion) {
    let (alpha, beta, module) = (angle("20"), angle("12"), length("2"));
    let (error, lead_error, bound) = (length("12 um"), angle("0.0255"), length("0.02"));
    let pitch = Law::rack_pitch(alpha, beta).expect("valid");
    let lead = Law::rack_lead(alpha, beta, length("19.7")).expect("valid");
    let over_pin = OverPin {
        normal_module: module,
        normal_pressure_angle: alpha,
        tooth_thickness: None,
        pin_diameter: length("3.5"),
        datum: length("25"),
    };
    let model = Model::Exact;

    let mut group = c.benchmark_group("ΔCD");
    group.bench_function("rack-pitch", |b| b.iter(|| pitch.delta_cd(black_box(error), model)));
    group.bench_function("rack-lead", |b| b.iter(|| lead.delta_cd(black_box(lead_error), model)));
    group.bench_function("rack-lead, drawn", |b| b.iter(|| lead.delta_cd_mm(black_box(0.0255), model)));
    group.bench_function("ideal-pin", |b| b.iter(|| ideal_pin::diameter(black_box(module), alpha, None)));
    group.bench_function("over-pin", |b| b.iter(|| black_box(&over_pin).measure()));
    group.bench_function("roller-change", |b| {
        b.iter(|| roller_change::difference(black_box(length("3.5")), length("4"), alpha));
    });
    group.finish();

    let mut group = c.benchmark_group("made for a gear");
    group.bench_function("rack-pitch", |b| b.iter(|| Law::rack_pitch(black_box(alpha), beta)));
    group.bench_function("rack-lead", |b| b.iter(|| Law::rack_lead(black_box(alpha), beta, length("19.7"))));
    group.finish();

    let mut group = c.benchmark_group("largest error");
    group.bench_function("rack-pitch", |b| b.iter(|| pitch.largest_error(black_box(bound), model)));
    group.bench_function("rack-lead", |b| b.iter(|| lead.largest_error(black_box(bound), model)));
    group.finish();

    let mut group = c.benchmark_group("sensitivities");
    group.bench_function("rack-pitch", |b| b.iter(|| pitch.sensitivities(black_box(error), model)));
    group.bench_function("rack-lead", |b| b.iter(|| lead.sensitivities(black_box(lead_error), model)));
    group.finish();
}

/// Five errors of a part, combined and held against a limit, as `eval` does it.
fn evaluation(c: &mut Criterion) {
    let (alpha, beta) = (angle("20"), angle("12"));
    let lead = Law::rack_lead(alpha, beta, length("19.7")).expect("valid");
    let errors = [
        PartDeviation::new(Law::rack_over_roller(), length("13 um")),
        PartDeviation::new(Law::rack_pitch(alpha, beta).expect("valid"), length("12 um")),
        PartDeviation::new(lead, angle("0.0255")),
        PartDeviation::new(Law::pinion_radial(), length("-4 um")),
        PartDeviation::new(Law::pinion_pitch(alpha, beta).expect("valid"), length("9 um")),
    ];
    let limits = vec![(LimitTarget::CenterDistance, Limit::symmetric(length("0.05")))];
    let basis = Basis::default();
    c.bench_function("five errors, combined and judged", |b| {
        b.iter(|| evaluate(black_box(&errors), &limits, Model::Exact, Stack::Range, &basis));
    });
}

criterion_group!(benches, laws, evaluation);
criterion_main!(benches);
