//! Known teeth of one part beside errors of the other: the exact mesh of both stays inside the curve and the raw ends.

use super::property::extremes;
use super::random::{self, Drawn, Random};
use crate::deviation::Part;
use crate::gear::Pair;
use crate::judge::bound::{Basis, GivenGeometry, GivenPair, KnownPairs, KnownTeeth, Range};
use crate::judge::reached::placed::Placed;
use crate::parallel;

const PAIRS: usize = 300;
/// What the extremes of a curve that is sampled may miss, mm.
const SAMPLED_MM: f64 = 2e-7;

fn errors_of(random: &mut Random, pair: &Pair, part: Part) -> Vec<Drawn> {
    let count = 1 + random.below(2) as usize;
    std::iter::repeat_with(|| random::error(random, pair))
        .filter(|drawn| drawn.error.part == part)
        .take(count)
        .collect()
}

/// Where the mesh ends and where the range does.
struct Tried {
    seed: u64,
    reached: Range,
    total: Range,
}

impl Tried {
    fn is_outside(&self) -> bool {
        (self.total.lower - self.reached.lower).max(self.reached.upper - self.total.upper) > SAMPLED_MM
    }
}

/// `None` if the pair does not mesh.
fn tried(seed: u64) -> Option<Tried> {
    let mut random = Random(seed ^ 0x6265_7369_6465_0000);
    let pair = random::pair(&mut random);
    let given = GivenPair::plain(pair);
    let (known_part, other) = if random.chance(0.5) { (Part::Rack, Part::Pinion) } else { (Part::Pinion, Part::Rack) };
    let (known, unknown) = (errors_of(&mut random, &pair, known_part), errors_of(&mut random, &pair, other));
    let mut placed = Placed::new(&pair);
    for drawn in &known {
        placed.put(&mut random, drawn);
    }
    let range = extremes(&placed.mesh(&given).ok()?, 48)?;
    let basis = Basis {
        geometry: GivenGeometry::Known(KnownPairs::new(given)),
        known_teeth: Some(KnownTeeth { range, solved: true }),
        ..Basis::default()
    };
    let errors: Vec<_> = unknown.iter().map(|drawn| drawn.error).collect();
    let total = basis.together(&errors).range.ok()?;
    for drawn in &unknown {
        placed.put(&mut random, drawn);
    }
    let reached = extremes(&placed.mesh(&given).ok()?, 48)?;
    Some(Tried { seed, reached, total })
}

#[test]
fn known_teeth_and_errors_of_the_other_part_stay_inside() {
    let (results, _) = parallel::map(parallel::cores(), PAIRS, || (), |(), index| tried(index as u64));
    let solved = results.iter().flatten().count();
    let outside: Vec<&Tried> = results.iter().flatten().filter(|tried| tried.is_outside()).collect();
    println!("{solved} of {PAIRS} pairs mesh, {} outside", outside.len());
    for Tried { seed, reached, total } in outside.iter().take(10) {
        println!("seed {seed}: {reached:?} of {total:?}");
    }
    assert!(outside.is_empty() && 10 * solved > 9 * PAIRS);
}
