//! A tolerance inside another one never has a wider bound, and what parts within it do never leaves its bound.

use super::property::{extremes, outside};
use super::random::{self, Drawn, Random};
use crate::judge::bound::{Basis, ErrorRange, Extent, GivenGeometry, GivenPair, KnownPairs, Range};
use crate::judge::reached::placed::Placed;
use crate::judge::reached::reached;
use crate::mesh::Support;
use crate::parallel;

/// Pairs of the default run, and of the long one.
const PAIRS: usize = 60;
const LONG: usize = 6_000;
/// One pair in so many has a rack that may roll.
const ROLLING: u64 = 60;
/// What the mesh may leave a bound by, and a bound another one, mm.
const TOLERANCE_MM: f64 = 1e-9;
/// The same where the pair's own curve is computed for errors of each size, to a tolerance of its own.
const OF_CURVES_MM: f64 = 2e-6;

/// A tolerance, and one inside it, of which an end may be the same, or both.
fn nested(random: &mut Random, drawn: Drawn) -> [Drawn; 2] {
    if drawn.error.extent == Extent::Total || random.chance(0.2) {
        return [drawn; 2];
    }
    let other = if random.chance(0.4) { -1.0 } else { random.range(-1.0, 1.0) };
    let mut inside = |end: f64| if random.chance(0.3) { end } else { random.range(other, 1.0) };
    let (a, b) = (inside(other), inside(1.0));
    let of = |ends| random::between(drawn, ends);
    let [outer, inner] = [of([other, 1.0]), of([a.min(b), a.max(b)])];
    [outer, inner].map(|drawn| Drawn { error: drawn.error.of_either_sign(), ..drawn })
}

/// A part within the tolerances: where all have one value, any of theirs.
fn put(placed: &mut Placed, random: &mut Random, drawn: &Drawn) {
    let [lower, upper] = drawn.error.ends();
    let value = [lower, upper, random.range(lower, upper)][random.below(3) as usize];
    let measured = drawn.error.signs().map(|[error, _]| error.with_value(value));
    placed.put(random, &measured.map_or(*drawn, |error| Drawn { error, value, ..*drawn }));
}

fn check(seed: u64) -> Option<Vec<String>> {
    let mut random = Random(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ 0x6e65_7374_6564_0000);
    let pair = random::pair(&mut random);
    let rolls = seed.is_multiple_of(ROLLING);
    let support = if rolls { Support::FreeRoll { axis_depth_mm: random.range(2.0, 12.0) } } else { Support::Fixed };
    let plain = GivenPair { support, ..GivenPair::plain(pair) };
    let given = if !rolls && random.chance(0.1) { random::with_form(&mut random, plain) } else { plain };
    let count = 1 + random.below(3);
    let drawn: Vec<_> = (0..count).map(|_| random::error(&mut random, &pair)).collect();
    let tolerances: Vec<_> = drawn.into_iter().map(|drawn| nested(&mut random, drawn)).collect();
    let [outer, inner] = [0, 1].map(|which| tolerances.iter().map(|both| both[which].error).collect::<Vec<_>>());
    let known = Basis { geometry: GivenGeometry::Known(KnownPairs::new(given)), ..Basis::default() };
    let both_flanks = Basis { geometry: GivenGeometry::BothFlanks, ..Basis::default() };
    let mut wrong = Vec::new();
    for (basis, tolerance) in [(&known, OF_CURVES_MM), (&Basis::default(), TOLERANCE_MM), (&both_flanks, TOLERANCE_MM)]
    {
        let alone = outer.iter().zip(&inner).map(|(outer, inner)| {
            let of = |error| basis.alone(error).map(ErrorRange::alone);
            (of(outer), of(inner))
        });
        let together = (basis.together(&outer).range, basis.together(&inner).range);
        for (index, (outer, inner)) in alone.chain([together]).enumerate() {
            let Ok(outer) = outer else { continue };
            let by = inner.map_or(f64::INFINITY, |inner| outside(&outer, &inner));
            if by > tolerance {
                wrong.push(format!("seed {seed} {index} by {by:.3e}: {inner:?} of {outer:?}; {tolerances:#?}"));
            }
        }
    }
    let bound: Range = known.together(&inner).range.ok()?;
    let mut placed = Placed::new(&pair);
    for [_, drawn] in &tolerances {
        put(&mut placed, &mut random, drawn);
    }
    let mesh = placed.mesh(&given).ok()?;
    let of_mesh = extremes(&mesh, if rolls { 5 } else { 24 })?;
    let found = reached(&inner, &given).ok()?;
    let found = found.map_or(of_mesh, |found| Range { lower: found.lower_mm, upper: found.upper_mm });
    for (what, range) in [("mesh", of_mesh), ("reached", found)] {
        let by = outside(&bound, &range);
        if by > TOLERANCE_MM {
            wrong.push(format!("seed {seed} {what} by {by:.3e}: {range:?} of {bound:?}; {inner:#?}"));
        }
    }
    Some(wrong)
}

/// `NESTED_PAIRS` and `NESTED_FROM` in the environment take as many pairs, from another seed on.
#[test]
fn a_tolerance_inside_another_one_is_bounded_inside_it() {
    let of = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let long = of("RACKMESH_LONG_TESTS") == Some(1);
    let pairs = of("NESTED_PAIRS").map_or(if long { LONG } else { PAIRS }, |pairs| pairs as usize);
    let from = of("NESTED_FROM").unwrap_or(0);
    let (results, _) = parallel::map(parallel::cores(), pairs, || (), |(), index| check(from + index as u64));
    let held = results.iter().flatten().count();
    let wrong: Vec<&String> = results.iter().flatten().flatten().collect();
    println!("{held} of {pairs} pairs are held against their mesh, {} wrong", wrong.len());
    wrong.iter().take(12).for_each(|text| println!("{text}"));
    assert!(wrong.is_empty() && 10 * held >= 9 * pairs);
}
