//! The solver against an independent brute force on random pairs and deviations.
#![allow(missing_docs, clippy::pedantic, clippy::disallowed_methods)]

mod common;

use common::brute::Brute;
use common::random::{self, Random};
use rackmesh::mesh::{Mesh, Support};

/// The brute force's own error: golden sections stop at 2e-9 of a cell, and heights are quadratic there.
const ALLOWED_MM: f64 = 1e-7;

fn compare(seed: u64) -> Option<(f64, String)> {
    let mut random = Random(seed);
    let pair = random::pair(&mut random);
    let leads = random.chance(0.7);
    let rack = random::rack(&mut random, &pair, leads);
    let pinion = random::pinion(&mut random, &pair, leads);
    let stroke = random.range(-3.0, 8.0) * pair.rack().pitch_mm;
    let mesh = Mesh::new(pair, rack.clone(), pinion.clone(), Support::Fixed).unwrap();
    let point = mesh.at(stroke);
    let brute = Brute { pair: &pair, rack: &rack, pinion: &pinion };
    let middle = (stroke / pair.rack().pitch_mm).round() as i64;
    let reach = 3 + (pair.contact_ratio().total / 2.0).ceil() as i64;
    let teeth: Vec<i64> = (middle - reach..=middle + reach).collect();
    let start = point.map_or(0.0, |point| -point.transmission_error_rad);
    let reference = brute.center_distance(stroke, &teeth, start);
    match (point, reference) {
        (Ok(point), Some(a)) => {
            let unsettled = if point.converged() { 0.0 } else { f64::NAN };
            Some((point.center_distance_mm - a + unsettled, format!("seed {seed}: {point:?}\n{:?}", pair)))
        }
        (Err(_), None) => None,
        (point, reference) => panic!("seed {seed}: {point:?} against {reference:?}"),
    }
}

#[test]
fn random_pairs_agree_with_brute_force() {
    let long = std::env::var("RACKMESH_LONG_TESTS").is_ok_and(|v| v == "1");
    let first: u64 = std::env::var("RACKMESH_FIRST_SEED").ok().and_then(|v| v.parse().ok()).unwrap_or(1);
    let count = if long { 400 } else { 24 };
    // these once found peaks that the solver missed: corners of functions that are not concave, an involute that starts
    // at its base circle, almost no helix
    const ONCE_WRONG: [u64; 6] = [33, 35, 67, 2291, 2481, 384];
    let seeds: Vec<u64> = ONCE_WRONG.into_iter().chain(first..first + count).collect();
    let next = std::sync::atomic::AtomicUsize::new(0);
    let failures = std::sync::Mutex::new(Vec::new());
    let compared = std::sync::atomic::AtomicUsize::new(0);
    let worst = std::sync::Mutex::new(0.0_f64);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(&seed) = seeds.get(next.fetch_add(1, std::sync::atomic::Ordering::Relaxed)) {
                    if let Some((error, what)) = compare(seed) {
                        compared.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                        let mut worst = worst.lock().unwrap();
                        *worst = worst.max(error.abs());
                        if error.is_nan() || error.abs() > ALLOWED_MM {
                            failures.lock().unwrap().push(format!("{error:e} mm, {what}"));
                        }
                    }
                }
            });
        }
    });
    let failures = failures.into_inner().unwrap();
    println!("{} pairs compared, largest difference {:e} mm", compared.into_inner(), worst.into_inner().unwrap());
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}
