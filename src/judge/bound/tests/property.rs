//! Errors on random teeth through the exact mesh: never outside their bound.

use std::collections::HashMap;

use super::random::{self, Drawn, Random};
use crate::gear::Pair;
use crate::judge::bound::{Basis, Bound, ExtendedError, GivenGeometry, GivenPair, KnownPairs, NoBound, Range};
use crate::judge::reached::placed::Placed;
use crate::mesh::{Ending, Mesh, Sampler, Support};
use crate::parallel;

/// Share of the pairs whose flanks have crowning, relief or a profile slope.
const WITH_FORM: f64 = 0.1;
/// What the mesh may leave a bound by, mm.
const TOLERANCE_MM: f64 = 1e-9;
/// Pairs of the default run, and of the long one.
const PAIRS: usize = 300;
const LONG: usize = 100_000;
/// One pair in so many has a rack that may roll.
const ROLLING: u64 = 40;

/// The lowest and highest ΔCD that the mesh has over the strokes on which placed teeth carry.
pub(in crate::judge) fn extremes(mesh: &Mesh, per_pitch: u32) -> Option<Range> {
    let pitch = mesh.pair().rack().pitch_mm;
    let mut sampler = Sampler::new(mesh);
    let mut at = |stroke: f64| {
        let point = sampler.at(stroke * pitch).ok()?;
        (matches!(point.ending, Ending::Converged | Ending::BracketExhausted) && point.residual_mm.abs() < 1e-10)
            .then_some(point.delta_cd_mm)
    };
    let count = 7 * per_pitch;
    let step = 1.0 / f64::from(per_pitch);
    let stroke = |index: u32| -1.5 + step * (f64::from(index) + 0.377);
    let values: Vec<Option<f64>> = (0..count).map(|index| at(stroke(index))).collect();
    let mut found = Range { lower: f64::INFINITY, upper: f64::NEG_INFINITY };
    for sign in [-1.0, 1.0] {
        let best = (0..count).filter_map(|index| Some((index, sign * values[index as usize]?)));
        let (index, mut value) = best.reduce(|a, b| if b.1 > a.1 { b } else { a })?;
        let (mut low, mut high) = (stroke(index) - step, stroke(index) + step);
        for _ in 0..12 {
            let inner = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            let [a, b] = inner.map(|stroke| at(stroke).map_or(f64::NEG_INFINITY, |found| sign * found));
            value = value.max(a).max(b);
            if a > b { high = inner[1] } else { low = inner[0] }
        }
        if sign > 0.0 { found.upper = value } else { found.lower = -value }
    }
    Some(found)
}

/// A pair and errors.
struct Case {
    given: GivenPair,
    drawn: Vec<Drawn>,
}

fn case(random: &mut Random, rolls: bool) -> Case {
    let pair = random::pair(random);
    let support = if rolls { Support::FreeRoll { axis_depth_mm: random.range(2.0, 12.0) } } else { Support::Fixed };
    let plain = GivenPair { support, ..GivenPair::plain(pair) };
    let given = if !rolls && random.chance(WITH_FORM) { random::with_form(random, plain) } else { plain };
    let count = 1 + random.below(4);
    let drawn = (0..count).map(|_| random::error(random, &pair)).collect();
    Case { given, drawn }
}

/// Whether flanks touch within what is assumed of a pair that is not known: a quarter of the face width.
fn is_as_high_as_assumed(pair: &Pair) -> bool {
    let rack = pair.rack();
    let below = pair.pinion().tip_radius_mm - pair.nominal_center_distance_mm();
    rack.addendum_mm.max(below) < 0.24 * rack.face_width_mm
}

pub(in crate::judge) fn outside(range: &Range, reached: &Range) -> f64 {
    (range.lower - reached.lower).max(reached.upper - range.upper)
}

/// Why the bound of a pair is not held against its mesh.
#[derive(Debug, PartialEq, Eq, Hash)]
enum NotHeld {
    /// It is open: nothing passes.
    Open(NoBound),
    /// Parts with these errors are no teeth.
    NoTeeth,
    /// No stroke is solved.
    NotSolved,
}

/// How far the mesh leaves the bounds of one seed, mm, with words.
fn check(seed: u64) -> Result<Vec<String>, NotHeld> {
    let mut random = Random(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ 0x5bd1_e995);
    let rolls = seed.is_multiple_of(ROLLING);
    let Case { given, drawn } = case(&mut random, rolls);
    let pair = given.pair;
    let errors: Vec<ExtendedError> = drawn.iter().map(|drawn| drawn.error).collect();
    let pairs = KnownPairs::new(given);
    let known = pairs.for_errors(&errors, None).map_err(NotHeld::Open)?;
    let with = |geometry| Basis { geometry, rolls, ..Basis::default() }.bound(&errors);
    let of_known = with(GivenGeometry::Known(pairs.clone()));
    // errors that bring ever more teeth into play are open
    let total = of_known.combined.range.map_err(NotHeld::Open)?;
    let mut wider: Vec<(&str, Bound)> = Vec::new();
    if known.carries_lines()
        && is_as_high_as_assumed(&pair)
        && (known.own.range.lower, known.own.upper_of_sunk_flanks) == (0.0, 0.0)
    {
        wider.push(("unknown", with(GivenGeometry::Unknown)));
        if known.line.has_both_flanks_of_a_pinion_tooth() && known.line.has_both_flanks_of_a_rack_tooth() {
            wider.push(("both flanks", with(GivenGeometry::BothFlanks)));
        }
    }
    let mut placed = Placed::new(&pair);
    for drawn in &drawn {
        placed.put(&mut random, drawn);
    }
    let mesh = placed.mesh(&given).map_err(|_| NotHeld::NoTeeth)?;
    let reached = extremes(&mesh, if rolls { 5 } else { 24 }).ok_or(NotHeld::NotSolved)?;
    let mut failures = Vec::new();
    let ranges = wider.iter().filter_map(|(name, bound)| Some((*name, bound.combined.range.ok()?)));
    for (name, range) in std::iter::once(("known", total)).chain(ranges) {
        let by = outside(&range, &reached);
        if by > TOLERANCE_MM {
            let errors: Vec<_> = drawn.iter().map(|one| format!("{:?}", one.error)).collect();
            failures.push(format!(
                "seed {seed} {name} by {:.3e}: reached {reached:?} of {range:?}; line {:?} nominal {:?} own {:?} z {} rolls {rolls} form {}\n   {}",
                by,
                known.line,
                known.nominal,
                known.own,
                pair.pinion().teeth,
                !given.rack_form.is_plain() || !given.pinion_form.is_plain(),
                errors.join("\n   ")
            ));
        }
    }
    Ok(failures)
}

/// `BOUND_PAIRS` and `BOUND_FROM` in the environment take as many pairs, from another seed on.
#[test]
fn no_placement_leaves_the_bound() {
    let long = std::env::var("RACKMESH_LONG_TESTS").is_ok_and(|value| value == "1");
    let pairs = std::env::var("BOUND_PAIRS").ok().and_then(|text| text.parse().ok());
    let pairs = pairs.unwrap_or(if long { LONG } else { PAIRS });
    let from: u64 = std::env::var("BOUND_FROM").ok().and_then(|text| text.parse().ok()).unwrap_or(0);
    let (results, _) = parallel::map(parallel::cores(), pairs, || (), |(), index| check(from + index as u64));
    let mut not_held = HashMap::<&NotHeld, usize>::new();
    results.iter().filter_map(|result| result.as_ref().err()).for_each(|why| *not_held.entry(why).or_default() += 1);
    let held = results.iter().flatten().count();
    let failures: Vec<&String> = results.iter().flatten().flatten().collect();
    println!("{held} of {pairs} pairs are held against their mesh, {} failures; {not_held:?}", failures.len());
    for failure in failures.iter().take(12) {
        println!("{failure}");
    }
    assert!(failures.is_empty() && 1000 * held >= 997 * pairs);
}
