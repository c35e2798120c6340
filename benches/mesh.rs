//! Positions per second of the exact mesh, and the error of adaptive curves at several tolerances.
#![allow(missing_docs)]

#[path = "../tests/it/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::time::Instant;

use common::brute::{Brute, Roll};
use common::kinds::teeth;
use common::random::{self, Random};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rackmesh::deviation::{
    PinionDeviation, PinionDeviationKind, PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks, ToothRange,
};
use rackmesh::gear::{Pair, PairData, PinionData, RackData};
use rackmesh::mesh::{Curve, Mesh, Sampler, Support};

/// A steering pair: m_n = 2, z = 8, β_p = 21°, straight rack.
fn pair() -> Pair {
    pair_with(0.0, 21.0, 8)
}

fn pair_with(rack_helix: f64, pinion_helix: f64, teeth: u32) -> Pair {
    let radians = |degrees: f64| degrees * std::f64::consts::PI / 180.0;
    let reference = 2.0 * f64::from(teeth) / rackmesh::trig::cos(radians(pinion_helix));
    Pair::new(&PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: radians(19.9),
        rack: RackData {
            helix_angle_rad: radians(rack_helix),
            face_width_mm: 19.7,
            addendum_mm: 1.7,
            tooth_thickness_mm: None,
        },
        pinion: PinionData {
            teeth,
            helix_angle_rad: radians(pinion_helix),
            profile_shift: 0.3,
            tip_diameter_mm: reference + 2.6,
            root_form_diameter_mm: (teeth == 8).then_some(16.2),
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

/// Positions per second on one core for pairs without a tilted flank, where gap functions are linear between changes of
/// contact: with each kind of deviation, of many shapes, with strokes far apart and close together; and the slowest of
/// random pairs with random deviations.
fn untilted(_: &mut Criterion) {
    use RackDeviationKind::{OverRoller, Pitch, Thickness};
    let (all, third, fourth_on) =
        (ToothRange::ALL, ToothRange::single(3).expect("small"), ToothRange::new(Some(4), None).expect("small"));
    let rack = |teeth, kind| vec![RackDeviation { teeth, kind }];
    let kinds = [
        ("nominal", pair(), Vec::new()),
        ("over-roller, from tooth 4 on", pair(), rack(fourth_on, OverRoller(0.02))),
        ("thickness of one tooth", pair(), rack(third, Thickness(0.02))),
        ("one pitch step", pair(), rack(third, Pitch(0.02))),
        ("accumulated pitch, from tooth 4 on", pair(), rack(fourth_on, Pitch(0.02))),
        ("accumulated pitch, every tooth", pair(), rack(all, Pitch(0.02))),
        ("the same, spur, z = 17", pair_with(0.0, 0.0, 17), rack(all, Pitch(0.02))),
        ("the same, parallel 20°, z = 30", pair_with(20.0, -20.0, 30), rack(all, Pitch(0.02))),
        ("the same, crossed 10° and 25°, z = 12", pair_with(10.0, 25.0, 12), rack(all, Pitch(0.02))),
        ("the same, crossed 10° and 25°, z = 30", pair_with(10.0, 25.0, 30), rack(all, Pitch(0.02))),
        ("the same, crossed 25° and 25°, z = 30", pair_with(25.0, 25.0, 30), rack(all, Pitch(0.02))),
        ("the same, crossed 30° and 30°, z = 60", pair_with(30.0, 30.0, 60), rack(all, Pitch(0.02))),
    ];
    println!("positions/s, one core                  0.1 mm apart   0.01 mm apart");
    for (name, pair, deviations) in kinds {
        let rack = RackFlanks::new(&pair, &deviations).expect("small deviations");
        let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::Fixed).expect("teeth in order");
        println!("{name:37} {:13.0} {:15.0}", rate(&mesh, 0.1, 200_000), rate(&mesh, 0.01, 200_000));
    }
    for (name, shares) in [("eccentric pinion, z = 8", [0.0, 0.03]), ("every pinion tooth and eccentric", [0.01, 0.03])]
    {
        let pair = pair();
        let teeth = (0..8).map(|tooth| PinionDeviation {
            teeth: ToothRange::of(tooth),
            kind: PinionDeviationKind::Shift(if tooth % 2 == 0 { shares[0] } else { -shares[0] }),
        });
        let all: Vec<_> = teeth.chain([PinionDeviation::eccentricity(shares[1], 3)]).collect();
        let pinion = PinionFlanks::new(&pair, &all).expect("small deviations");
        let mesh = Mesh::new(pair, RackFlanks::nominal(&pair), pinion, Support::Fixed).expect("teeth in order");
        println!("{name:37} {:13.0} {:15.0}", rate(&mesh, 0.1, 200_000), rate(&mesh, 0.01, 200_000));
    }
    let random = (1..=200).map(|seed| {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let (rack, pinion) = (random::rack(&mut random, &pair, false), random::pinion(&mut random, &pair, false));
        let mesh = Mesh::new(pair, rack, pinion, Support::Fixed).expect("teeth in order");
        (seed, rate(&mesh, 0.1, 4000), rate(&mesh, 0.01, 4000))
    });
    let random: Vec<(u64, f64, f64)> = random.collect();
    let slowest = random.iter().min_by(|a, b| a.1.min(a.2).total_cmp(&b.1.min(b.2))).expect("200 of them");
    let below = random.iter().filter(|(_, far, near)| far.min(*near) < 1e6).count();
    let name = format!("the slowest of 200 random ones, no. {}", slowest.0);
    println!("{name:37} {:13.0} {:15.0}", slowest.1, slowest.2);
    println!("{below} of 200 random ones below 1 000 000");
}

/// Positions per second with strokes a step apart; the best of five runs, since the others were disturbed.
fn rate(mesh: &Mesh, step: f64, positions: u32) -> f64 {
    let strokes: Vec<f64> = (0..positions).map(|i| (f64::from(i) * step) % 50.0).collect();
    let mut time = f64::INFINITY;
    for _ in 0..5 {
        let mut sampler = Sampler::new(mesh);
        let started = Instant::now();
        let sum: f64 = strokes.iter().map(|&s| sampler.at(black_box(s)).expect("contact").delta_cd_mm).sum();
        black_box(sum);
        time = time.min(started.elapsed().as_secs_f64());
    }
    f64::from(positions) / time
}

/// Run time against error: adaptive curves at several tolerances, and their largest error against the brute-force
/// solution of the tests, at strokes that no curve knows of. The brute force itself is good to 1e-9 mm or so.
fn curves(c: &mut Criterion) {
    let mesh = mesh(0.25 * std::f64::consts::PI / 180.0);
    let pair = *mesh.pair();
    let brute = Brute { pair: &pair, rack: mesh.rack(), pinion: mesh.pinion(), roll: Roll::default() };
    let strokes: Vec<f64> = (0..24).map(|i| 0.731 + f64::from(i) * 2.083).collect();
    let started = Instant::now();
    let reference: Vec<f64> = strokes
        .iter()
        .map(|&s| {
            let start = -mesh.at(s).expect("contact").transmission_error_rad;
            let a = brute.center_distance(s, &teeth(&pair, s), start).expect("contact");
            a - pair.nominal_center_distance_mm()
        })
        .collect();
    let each = started.elapsed().as_secs_f64() / strokes.len() as f64;
    println!("brute force: {each:.3} s for one position");
    println!("tolerance [mm]   points   solved   time [ms]   positions/s   largest error [mm]");
    let mut group = c.benchmark_group("curve");
    for tolerance in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9] {
        let mut time = f64::INFINITY;
        for _ in 0..5 {
            let started = Instant::now();
            black_box(mesh.curve(0.0, 50.0, black_box(tolerance)).expect("contact"));
            time = time.min(started.elapsed().as_secs_f64());
        }
        let curve = mesh.curve(0.0, 50.0, tolerance).expect("contact");
        let error = strokes.iter().zip(&reference).map(|(&s, &exact)| (joined(&curve, s) - exact).abs());
        let rate = curve.solved as f64 / time;
        println!(
            "{tolerance:14e} {:8} {:8} {:11.2} {rate:13.0} {:20.2e}",
            curve.points.len(),
            curve.solved,
            1e3 * time,
            error.fold(0.0, f64::max)
        );
        if tolerance > 5e-8 {
            group.bench_function(format!("{tolerance:e}"), |b| b.iter(|| mesh.curve(0.0, 50.0, black_box(tolerance))));
        }
    }
    group.finish();
}

/// ΔCD of a curve between its points, joined by straight lines.
fn joined(curve: &Curve, stroke_mm: f64) -> f64 {
    let after = curve.points.partition_point(|point| point.stroke_mm < stroke_mm).clamp(1, curve.points.len() - 1);
    let (p, q) = (&curve.points[after - 1], &curve.points[after]);
    let share = (stroke_mm - p.stroke_mm) / (q.stroke_mm - p.stroke_mm);
    p.delta_cd_mm + share * (q.delta_cd_mm - p.delta_cd_mm)
}

criterion_group!(benches, positions, untilted, curves);
criterion_main!(benches);
