//! Draws per second of the Monte Carlo simulation on the formulas (all five errors), and racks per second through the
//! exact mesh, on one thread and on all.
#![allow(missing_docs)]

use std::hint::black_box;
use std::sync::atomic::AtomicBool;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rackmesh::chance::racks::{RackRange, RackSettings, Racks, RacksError, Scatter};
use rackmesh::chance::{Settings, simulate_part};
use rackmesh::deviation::DeviationKind;
use rackmesh::formula::{Law, Model, PartDeviation};
use rackmesh::gear::{Pair, PairData, PinionData, RackData};
use rackmesh::judge::bound::Basis;
use rackmesh::judge::{Limit, LimitTarget, Stack};
use rackmesh::mesh::Mesh;
use rackmesh::quantity::{Angle, Length};
use rackmesh::uncertainty::{Influence, UncertainPart, Uncertainties, Uncertainty};

fn angle(text: &str) -> Angle {
    text.parse().expect("an angle")
}

fn length(text: &str) -> Length {
    text.parse().expect("a length")
}

fn errors() -> Vec<PartDeviation> {
    let (alpha, rack, pinion) = (angle("20"), angle("12"), angle("21"));
    let pitch = Law::rack_pitch(alpha, rack).expect("valid");
    let lead = Law::rack_lead(alpha, rack, length("19.7")).expect("valid");
    vec![
        PartDeviation::new(Law::rack_over_roller(), length("13 um")),
        PartDeviation::new(pitch, length("12 um")),
        PartDeviation::new(lead, angle("0.0255")),
        PartDeviation::new(Law::pinion_radial(), length("-4 um")),
        PartDeviation::new(Law::pinion_pitch(alpha, pinion).expect("valid"), length("9 um")),
    ]
}

fn draws(c: &mut Criterion) {
    const DRAWS: u64 = 2_000_000;
    let errors = errors();
    let basis = Basis::default();
    let part = UncertainPart {
        errors: &errors,
        over_pin: None,
        model: Model::Exact,
        stack: Stack::Range,
        basis: &basis,
        teeth: &[],
    };
    let limits = vec![(LimitTarget::CenterDistance, Limit::symmetric(length("0.05")))];
    let errors_only: Vec<_> =
        DeviationKind::ALL.into_iter().map(|kind| (Influence::Error(kind), Uncertainty::standard(0.0008))).collect();
    let mut with_gear = errors_only.clone();
    with_gear.push((Influence::NormalPressureAngle, Uncertainty::standard(0.02)));
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

/// Racks of a steering pair (m_n = 2, z = 8, β_p = 21°) over 50 mm of stroke, flanks not tilted.
fn racks(c: &mut Criterion) {
    const RACKS: u64 = 1000;
    let radians = |degrees: f64| degrees * std::f64::consts::PI / 180.0;
    let pair = Pair::new(&PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: radians(19.9),
        rack: RackData { helix_angle_rad: 0.0, face_width_mm: 19.7, addendum_mm: 1.7, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 8,
            helix_angle_rad: radians(21.0),
            profile_shift: 0.3,
            tip_diameter_mm: 19.738,
            root_form_diameter_mm: None,
            face_width_mm: 30.0,
            tooth_thickness_deviation_mm: 0.0,
        },
    });
    let base = Mesh::nominal(pair.expect("a valid pair")).expect("teeth in order");
    let plain = Scatter {
        rack_pitch: Some(Uncertainty::standard(0.004)),
        rack_thickness: Some(Uncertainty::standard(0.003)),
        pinion_pitch: Some(Uncertainty::standard(0.003)),
        ..Scatter::default()
    };
    let runout = Scatter { pinion_runout: Some(Uncertainty::standard(0.005)), ..plain };
    let mut group = c.benchmark_group("random racks over 50 mm");
    group.throughput(Throughput::Elements(RACKS)).sample_size(10);
    for (name, scatter) in [("pitch and thickness", plain), ("with runout", runout)] {
        for (cores, threads) in [("one thread", Some(1)), ("all cores", None)] {
            let stop = AtomicBool::new(false);
            let range = RackRange { first_rack: 0, racks: RACKS };
            let settings = RackSettings { seed: 1, range, from_mm: 0.0, to_mm: 50.0, threads };
            let racks = Racks { base: &base, scatter: &scatter, limit: None, yoke: None };
            group.bench_function(format!("{name}, {cores}"), |b| {
                let each = |_, _: &[_]| Ok::<_, RacksError>(());
                b.iter(|| black_box(&racks).study(&settings, &stop, each).1.expect("a result"));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, draws, racks);
criterion_main!(benches);
