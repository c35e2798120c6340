//! Positions per second of the exact mesh, and the error of adaptive curves at several tolerances.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rackmesh::deviation::{
    PinionDeviation, PinionDeviationKind, PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks, ToothRange,
};
use rackmesh::gear::{Pair, PairData, PinionData, RackData};
use rackmesh::mesh::{Mesh, Sampler, Support};

/// A steering pair: m_n = 2, z = 8, β_p = 21°, straight rack.
fn pair() -> Pair {
    let radians = |degrees: f64| degrees * std::f64::consts::PI / 180.0;
    Pair::new(&PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: radians(19.9),
        rack: RackData { helix_angle_rad: 0.0, face_width_mm: 19.7, addendum_mm: 1.7, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 8,
            helix_angle_rad: radians(21.0),
            profile_shift: 0.3,
            tip_diameter_mm: 19.738,
            root_form_diameter_mm: Some(16.2),
            face_width_mm: 30.0,
            tooth_thickness_deviation_mm: 0.0,
        },
    })
    .expect("a valid pair")
}

/// The pair with a pitch error, shifted pinion teeth, and a lead error of the rack's teeth if asked for.
fn mesh(lead_rad: f64) -> Mesh {
    let pair = pair();
    let on_all = |kind| RackDeviation { teeth: ToothRange::ALL, kind };
    let mut rack = vec![on_all(RackDeviationKind::Pitch(0.02))];
    if lead_rad != 0.0 {
        rack.push(on_all(RackDeviationKind::Lead(lead_rad)));
    }
    let third = ToothRange::single(3).expect("a small index");
    let pinion = [PinionDeviation { teeth: third, kind: PinionDeviationKind::Shift(0.01) }];
    let rack = RackFlanks::new(&pair, &rack).expect("small deviations");
    let pinion = PinionFlanks::new(&pair, &pinion).expect("small deviations");
    Mesh::new(pair, rack, pinion, Support::Fixed).expect("teeth in order")
}

fn positions(c: &mut Criterion) {
    let strokes: Vec<f64> = (0..5000).map(|i| f64::from(i) * 0.01).collect();
    let mut group = c.benchmark_group("positions");
    group.throughput(Throughput::Elements(strokes.len() as u64));
    for (name, lead) in [("straight", 0.0), ("lead", 0.25 * std::f64::consts::PI / 180.0)] {
        let mesh = mesh(lead);
        group.bench_function(name, |b| {
            b.iter(|| {
                let mut sampler = Sampler::new(&mesh);
                strokes.iter().map(|&s| sampler.at(black_box(s)).expect("contact").delta_cd_mm).sum::<f64>()
            });
        });
        group.bench_function(format!("{name} on all cores"), |b| b.iter(|| mesh.sample(black_box(&strokes))));
    }
    group.finish();
}

fn curves(c: &mut Criterion) {
    let mesh = mesh(0.25 * std::f64::consts::PI / 180.0);
    let reference: Vec<_> = (0..20_001).map(|i| f64::from(i) * 0.0025).collect();
    let exact: Vec<f64> = mesh.sample(&reference).into_iter().map(|p| p.expect("contact").delta_cd_mm).collect();
    let mut group = c.benchmark_group("curve");
    for tolerance in [1e-3, 1e-4, 1e-5, 1e-6] {
        let curve = mesh.curve(0.0, 50.0, tolerance).expect("contact");
        let mut error: f64 = 0.0;
        let mut segment = 0;
        for (&s, &a) in reference.iter().zip(&exact) {
            while segment + 2 < curve.points.len() && curve.points[segment + 1].stroke_mm < s {
                segment += 1;
            }
            let (p, q) = (&curve.points[segment], &curve.points[segment + 1]);
            let t = (s - p.stroke_mm) / (q.stroke_mm - p.stroke_mm);
            error = error.max((p.delta_cd_mm + t * (q.delta_cd_mm - p.delta_cd_mm) - a).abs());
        }
        println!("tolerance {tolerance:e} mm: {} points, largest error {error:.2e} mm", curve.points.len());
        group.bench_function(format!("{tolerance:e}"), |b| b.iter(|| mesh.curve(0.0, 50.0, black_box(tolerance))));
    }
    group.finish();
}

criterion_group!(benches, positions, curves);
criterion_main!(benches);
