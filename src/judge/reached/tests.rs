//! What is reached against closed forms, and against the bound.

use super::{Reached, reached};
use crate::deviation::Extent;
use crate::gear::Pair;
use crate::judge::bound::tests::random::{self, Random};
use crate::judge::bound::{Basis, ContactPath, ExtendedError, GivenGeometry, GivenPair, KnownPairs};
use crate::mesh::{Mesh, Support};
use crate::parallel;
use crate::reproduction;
use crate::trig;

/// Pairs of the default run, and of the long one.
const PAIRS: usize = 60;
const LONG: usize = 3_000;
/// What may be outside of the bound, and what a placement solved again may be off by, mm.
const TOLERANCE_MM: f64 = 1e-9;

fn error(pair: &Pair, kind: u32, extent: Extent, value: f64) -> ExtendedError {
    random::drawn(pair, kind, extent, value, None).error
}

fn of(pair: Pair, errors: &[ExtendedError]) -> Reached {
    reached(errors, &GivenPair::plain(pair)).unwrap().unwrap()
}

fn near(value: f64, expected: f64) {
    assert!((value - expected).abs() < 1e-6, "{value} {expected}");
}

/// Every rack pitch off by 12 µm on the paper's pair: as many steps add up as lines of contact reach, or one more on edges.
#[test]
fn every_pitch_of_the_papers_rack_adds_up() {
    let pair = reproduction::pair().unwrap();
    let step = 0.012 / (2.0 * trig::tan(19.9 * std::f64::consts::PI / 180.0));
    let path = ContactPath::nominal(&pair);
    for sign in [1.0, -1.0] {
        let count = (path.ratio - sign * 2.0 * path.offset).floor();
        let found = of(pair, &[error(&pair, 1, Extent::All, sign * 0.012)]);
        println!("{sign}: {} to {} of {count} steps of {step}", found.lower_mm, found.upper_mm);
        assert!(found.upper_mm > count * step - 1e-6 && found.upper_mm < (count + 1.0) * step);
    }
}

/// One pitch lifts by one step, and not at all where it does not carry.
#[test]
fn one_step_lifts_once() {
    let pair = reproduction::pair().unwrap();
    let found = of(pair, &[error(&pair, 1, Extent::One, 0.012)]);
    near(found.upper_mm, 0.012 / (2.0 * trig::tan(19.9 * std::f64::consts::PI / 180.0)));
    near(found.lower_mm, 0.0);
    assert!(found.meshes <= 20, "{}", found.meshes);
    let runs = &found.upper.errors[0];
    assert!(runs.len() == 1 && runs[0].first == runs[0].last && runs[0].value == 0.012, "{runs:?}");
}

/// A tolerance is put on with either sign.
#[test]
fn a_tolerance_reaches_what_either_sign_does() {
    let pair = reproduction::pair().unwrap();
    for (kind, extent) in [(0, Extent::All), (0, Extent::One), (1, Extent::All), (3, Extent::Part)] {
        let of_sign = |sign: f64| of(pair, &[error(&pair, kind, extent, sign * 0.012)]);
        let (found, one, other) =
            (of(pair, &[error(&pair, kind, extent, 0.012).of_either_sign()]), of_sign(1.0), of_sign(-1.0));
        near(found.lower_mm, one.lower_mm.min(other.lower_mm));
        near(found.upper_mm, one.upper_mm.max(other.upper_mm));
    }
}

/// Spaces that are higher: all of them, one of them, each of them either way.
#[test]
fn a_size_acts_as_its_extent_says() {
    let pair = reproduction::pair().unwrap();
    let ends = |kind, extent, value| {
        let found = of(pair, &[error(&pair, kind, extent, value)]);
        (found.lower_mm, found.upper_mm)
    };
    for kind in [0, 3] {
        for (extent, lower, upper) in [(Extent::All, 0.02, 0.02), (Extent::Each, -0.02, 0.02)] {
            let found = ends(kind, extent, 0.02);
            near(found.0, lower);
            near(found.1, upper);
        }
        let part = ends(kind, Extent::Part, 0.02);
        near(part.1, 0.02);
        let one = ends(kind, Extent::One, 0.02);
        near(one.0, 0.0);
        assert!(one.1 > 0.01 - 1e-6, "{one:?}");
    }
}

#[test]
fn nothing_is_searched_for_a_rack_that_may_roll() {
    let pair = reproduction::pair().unwrap();
    let given = GivenPair { support: Support::FreeRoll { axis_depth_mm: 8.0 }, ..GivenPair::plain(pair) };
    assert_eq!(reached(&[error(&pair, 1, Extent::One, 0.012)], &given), Ok(None));
}

/// What is wrong with one seed; `None` if the pair is not judged.
fn check(seed: u64) -> Option<Vec<String>> {
    let mut random = Random(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ 0x7265_6163_6865_6421);
    let pair = random::pair(&mut random);
    let plain = GivenPair::plain(pair);
    let given = if random.chance(0.1) { random::with_form(&mut random, plain) } else { plain };
    let count = 1 + random.below(3);
    let mut errors: Vec<ExtendedError> = (0..count).map(|_| random::error(&mut random, &pair).error).collect();
    if random.chance(0.25) {
        errors = errors.into_iter().map(ExtendedError::of_either_sign).collect();
    }
    let basis = Basis { geometry: GivenGeometry::Known(KnownPairs::new(given)), ..Basis::default() };
    let range = basis.together(&errors).range.ok()?;
    let found = match reached(&errors, &given) {
        Ok(found) => found?,
        Err(error) => return Some(vec![format!("seed {seed}: {error}")]),
    };
    let mut wrong = Vec::new();
    let outside = (range.lower - found.lower_mm).max(found.upper_mm - range.upper);
    if outside > TOLERANCE_MM || found.meshes > 20 {
        wrong.push(format!("seed {seed}: {outside:.3e} outside, {} meshes, {errors:?}", found.meshes));
    }
    for (end, delta_cd_mm) in [(found.lower, found.lower_mm), (found.upper, found.upper_mm)] {
        let again = Mesh::new(pair, end.rack, end.pinion, given.support).and_then(|mesh| mesh.at(end.stroke_mm));
        let off = again.map_or(f64::INFINITY, |point| (point.delta_cd_mm - delta_cd_mm).abs());
        if off > TOLERANCE_MM {
            wrong.push(format!("seed {seed}: solved again {off:.3e} off at {} mm", end.stroke_mm));
        }
    }
    Some(wrong)
}

/// Every placement that is tried is one that the extents allow.
#[test]
fn what_is_reached_stays_inside_the_bound() {
    let long = std::env::var("RACKMESH_LONG_TESTS").is_ok_and(|value| value == "1");
    let pairs = if long { LONG } else { PAIRS };
    let (results, _) = parallel::map(parallel::cores(), pairs, || (), |(), index| check(index as u64));
    let solved = results.iter().flatten().count();
    let wrong: Vec<&String> = results.iter().flatten().flatten().collect();
    println!("{solved} of {pairs} pairs judged, {} wrong", wrong.len());
    wrong.iter().take(12).for_each(|text| println!("{text}"));
    assert!(wrong.is_empty() && 10 * solved >= 9 * pairs);
}
