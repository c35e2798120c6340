#![allow(missing_docs, clippy::pedantic, clippy::disallowed_methods)]
mod common;
use common::brute::Brute;
use common::random::{self, Random};
use rackmesh::mesh::{Mesh, Support};
#[test]
fn dbg() {
    for seed in [2291u64, 2481] {
    let mut random = Random(seed);
    let pair = random::pair(&mut random);
    let leads = random.chance(0.7);
    let rack = random::rack(&mut random, &pair, leads);
    let pinion = random::pinion(&mut random, &pair, leads);
    let stroke = random.range(-3.0, 8.0) * pair.rack().pitch_mm;
    let mesh = Mesh::new(pair, rack.clone(), pinion.clone(), Support::Fixed).unwrap();
    let point = mesh.at(stroke).unwrap();
    let brute = Brute { pair: &pair, rack: &rack, pinion: &pinion };
    println!("a {} {:?} {:?} w {:?}", point.center_distance_mm, point.right, point.left, pair.warnings());
    for side in [-1.0, 1.0] { for i in -3..12 { 
        println!("side {side} tooth {i} {:.7}  {:?}", brute.demand(stroke, side, -point.transmission_error_rad, &[i]), rack.tooth(i)); } }
    }
}
