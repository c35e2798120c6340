//! Known teeth of one part beside errors of the other: the exact mesh of both stays inside the curve and the raw ends.

use super::property::extremes;
use super::random::{self, Drawn, Random};
use crate::deviation::Part;
use crate::gear::Pair;
use crate::judge::bound::{Basis, GivenGeometry, GivenPair, KnownPairs, KnownTeeth};
use crate::judge::reached::placed::Placed;
use crate::parallel;

const PAIRS: usize = 2_000;
/// What the extremes of a curve that is sampled may miss, mm.
const SAMPLED_MM: f64 = 2e-7;

fn errors_of(random: &mut Random, pair: &Pair, part: Part) -> Vec<Drawn> {
    let count = 1 + random.below(2) as usize;
    std::iter::repeat_with(|| random::error(random, pair))
        .filter(|drawn| drawn.error.part() == part)
        .take(count)
        .collect()
}

/// How far the mesh leaves the range, with words; `None` if the pair does not mesh.
#[expect(clippy::option_option, reason = "tells a pair that does not mesh from one that stays inside")]
fn check(seed: u64) -> Option<Option<String>> {
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
        known_teeth: Some(KnownTeeth { range }),
        ..Basis::default()
    };
    let errors: Vec<_> = unknown.iter().map(|drawn| drawn.error).collect();
    let total = basis.total(&errors).ok()?;
    for drawn in &unknown {
        placed.put(&mut random, drawn);
    }
    let reached = extremes(&placed.mesh(&given).ok()?, 48)?;
    let by = (total.lower - reached.lower).max(reached.upper - total.upper);
    Some((by > SAMPLED_MM).then(|| format!("seed {seed} by {by:.3e}: {reached:?} of {total:?} beside {range:?}")))
}

#[test]
fn known_teeth_and_errors_of_the_other_part_stay_inside() {
    let (results, _) = parallel::map(parallel::cores(), PAIRS, || (), |(), index| check(index as u64));
    let solved = results.iter().flatten().count();
    let outside: Vec<&String> = results.iter().flatten().flatten().collect();
    println!("{solved} of {PAIRS} pairs mesh, {} outside", outside.len());
    outside.iter().take(10).for_each(|text| println!("{text}"));
    assert!(outside.is_empty() && 10 * solved > 9 * PAIRS);
}
