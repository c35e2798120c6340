//! What a statistical sum holds: tolerances drawn tooth by tooth, through the exact mesh at random strokes.

use super::random::{self, Drawn, Random};
use crate::deviation::Part;
use crate::gear::Pair;
use crate::judge::bound::error::ErrorEffect;
use crate::judge::bound::{Basis, ExtendedError, Extent, GivenGeometry, GivenPair, KnownPairs, Range};
use crate::judge::reached::placed::{BySide, Placed};
use crate::mesh::{MeshPoint, Sampler};
use crate::parallel;

/// Specs of each mix in the ordinary run, and in the long one.
const SPECS: usize = 12;
const LONG: usize = 1_000;
/// Racks and strokes of each: where one value is that of a whole part, more racks.
const RACKS: [usize; 2] = [50, 400];
const STROKES: [usize; 2] = [16, 2];
/// The pitches that strokes are within, and those beside which the teeth lie that single errors are on.
const TRAVEL: (f64, f64) = (-20.0, 26.0);
const NEAR: (f64, f64) = (-2.0, 7.0);
/// Share of the values that lie inside.
const HELD: f64 = 0.99;

/// A value within ± a tolerance: normal, the tolerance three standard deviations, what is beyond sorted out.
fn normal(random: &mut Random, tolerance: f64) -> f64 {
    loop {
        let radius = (-2.0 * libm::log(1.0 - random.unit())).sqrt();
        let value = radius * libm::cos(std::f64::consts::TAU * random.unit()) / 3.0;
        if value.abs() <= 1.0 {
            return value * tolerance;
        }
    }
}

/// What a spec is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mix {
    /// Tolerances of every tooth, or of the total.
    Tolerances,
    /// The same and measured errors.
    WithMeasured,
    /// The same and tolerances of one tooth, a run, or all alike.
    WithAlike,
}

/// An error of any kind, on every tooth for itself or not.
fn of_each(random: &mut Random, pair: &Pair, each: bool) -> Drawn {
    loop {
        let drawn = random::error(random, pair);
        if matches!(drawn.error.extent, Extent::Each | Extent::Total) == each {
            return drawn;
        }
    }
}

/// A tolerance that becomes one from an end of its own to another.
fn shifted(random: &mut Random, drawn: Drawn) -> Drawn {
    let nearer = -random.range(-0.8, 1.0);
    let is_kept = drawn.error.extent == Extent::Total || drawn.cap.is_some() || random.chance(0.7);
    if is_kept { drawn } else { random::between(drawn, [nearer, 1.0]) }
}

/// Puts a tolerance on every tooth that it binds, each with its own value.
fn put(placed: &mut Placed, random: &mut Random, drawn: &Drawn) {
    let ExtendedError { part, effect, extent, .. } = drawn.error;
    let teeth: Vec<i64> = placed.teeth(part).collect();
    // values of the draw: of a pinion's lead, f_Hβ
    let ends = drawn.error.ends().map(|end| end * drawn.value / drawn.error.value);
    let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
    match effect {
        ErrorEffect::Size => {
            for &space in &teeth {
                let value = middle + normal(random, half);
                placed.raise_space(part, space, value);
            }
        }
        ErrorEffect::RackLead(_) | ErrorEffect::PinionLead { .. } => {
            for &tooth in &teeth {
                let by = BySide { left: middle + normal(random, half), right: middle + normal(random, half) };
                placed.turn(part, tooth, by);
            }
        }
        ErrorEffect::Pitch { .. } => {
            let sides = if extent == Extent::Total {
                [(); 2].map(|()| within(random, teeth.len(), drawn.value.abs(), part))
            } else {
                let sums = walk(random, teeth.len(), drawn, (middle, half));
                [sums.clone(), sums]
            };
            for (index, &tooth) in teeth.iter().enumerate() {
                placed.shift(part, tooth, BySide { left: sides[0][index], right: sides[1][index] });
            }
        }
    }
}

/// Places of one flank side within a total, about their mean.
fn within(random: &mut Random, count: usize, total: f64, part: Part) -> Vec<f64> {
    let total = normal(random, total).abs();
    let mut places: Vec<f64> = (0..count).map(|_| total * random.unit()).collect();
    if part == Part::Pinion {
        let mean = places.iter().sum::<f64>() / count as f64;
        for place in &mut places {
            *place -= mean;
        }
    }
    places
}

/// Places whose steps are normal; a turn closes, and a cap holds their total.
fn walk(random: &mut Random, count: usize, drawn: &Drawn, (middle, half): (f64, f64)) -> Vec<f64> {
    let part = drawn.error.part;
    let mut steps: Vec<f64> = (0..count).map(|_| middle + normal(random, half)).collect();
    let cap = drawn.cap.unwrap_or(f64::INFINITY);
    if part == Part::Pinion {
        let mean = steps.iter().sum::<f64>() / count as f64;
        for step in &mut steps {
            *step -= mean;
        }
        // within the tolerance still
        let largest = steps.iter().fold(half.max(1e-12), |largest, step| largest.max(step.abs()));
        for step in &mut steps {
            *step *= half / largest;
        }
    }
    let mut place = 0.0;
    let mut places: Vec<f64> = Vec::with_capacity(count);
    for step in steps {
        // a rack's step that would leave the total turns back
        let turns = part == Part::Rack && !(0.0..=cap).contains(&(place + step)) && cap.is_finite();
        place += if turns { -step } else { step };
        places.push(if part == Part::Rack && cap.is_finite() { place.clamp(0.0, cap) } else { place });
    }
    if part == Part::Pinion {
        let (low, high) =
            places.iter().fold((0.0_f64, 0.0_f64), |(low, high), &place| (low.min(place), high.max(place)));
        let share = (cap / (high - low).max(1e-12)).min(1.0);
        for place in &mut places {
            *place *= share;
        }
    }
    places
}

/// A spec and how many values of its meshes lie inside its statistical sum.
struct Covered {
    text: String,
    kind: usize,
    held: usize,
    values: usize,
    /// The width of the statistical sum as a share of that of the worst case.
    width: f64,
    /// How far values leave the worst case, mm.
    beyond: f64,
}

fn covered(seed: u64, mix: Mix) -> Option<Covered> {
    let mut random = Random(seed.wrapping_mul(0x9e6c_63d0_876a_68ee) ^ mix as u64);
    let pair = random::pair(&mut random);
    let given = GivenPair::plain(pair);
    let single = mix == Mix::Tolerances && seed.is_multiple_of(2);
    let count = if single { 1 } else { 1 + random.below(4) };
    let mut tolerances = Vec::new();
    for _ in 0..count {
        let drawn = of_each(&mut random, &pair, true);
        tolerances.push(shifted(&mut random, drawn));
    }
    let others = if mix == Mix::Tolerances { 0 } else { 1 + random.below(3) };
    let others: Vec<Drawn> = (0..others).map(|_| of_each(&mut random, &pair, false)).collect();
    let alike = mix == Mix::WithAlike;
    let of_other = |drawn: &Drawn| if alike { drawn.error.of_either_sign() } else { drawn.error };
    let errors: Vec<_> = tolerances.iter().map(|drawn| drawn.error).chain(others.iter().map(of_other)).collect();
    let geometry = GivenGeometry::Known(KnownPairs::new(given));
    let combined = Basis { geometry, ..Basis::default() }.together(&errors);
    let (range, rss): (Range, Range) = (combined.range.ok()?, combined.rss.ok()?);
    let (mut values, mut low, mut high, mut beyond) = (0, 0, 0, 0.0_f64);
    for _ in 0..RACKS[usize::from(alike)] {
        let mut placed = Placed::new(&pair);
        for drawn in &tolerances {
            put(&mut placed, &mut random, drawn);
        }
        for drawn in &others {
            let share = if alike { normal(&mut random, 1.0) } else { 1.0 };
            let error = drawn.error.with_value(share * drawn.error.value);
            placed.put(&mut random, &Drawn { error, value: share * drawn.value, ..*drawn });
        }
        let mesh = placed.mesh(&given).ok()?;
        let mut sampler = Sampler::new(&mesh);
        for _ in 0..STROKES[usize::from(alike)] {
            let (first, last) = if mix == Mix::Tolerances { TRAVEL } else { NEAR };
            let stroke = random.range(first, last) * pair.rack().pitch_mm;
            let Some(point) = sampler.at(stroke).ok().filter(MeshPoint::is_solved) else { continue };
            values += 1;
            beyond = beyond.max(point.delta_cd_mm - range.upper).max(range.lower - point.delta_cd_mm);
            low += usize::from(point.delta_cd_mm < rss.lower - 1e-9);
            high += usize::from(point.delta_cd_mm > rss.upper + 1e-9);
        }
    }
    let held = values - low - high;
    let text = format!(
        "seed {seed} {mix:?}: {held} of {values} ({low} below, {high} above), {rss:?} of {range:?}, ratio {:.2}\n    {}",
        pair.contact_ratio().total,
        errors.iter().map(|error| format!("{error:?}")).collect::<Vec<_>>().join("\n    ")
    );
    let kind = if single { super::tight::kind_of(&errors[0]) } else { 20 + mix as usize };
    let width = (rss.upper - rss.lower) / (range.upper - range.lower);
    Some(Covered { text, kind, held, values, width, beyond })
}

#[test]
fn a_statistical_sum_holds_99_of_100_values_of_every_spec() {
    let long = std::env::var("RACKMESH_LONG_TESTS").is_ok_and(|value| value == "1");
    let specs = std::env::var("COVERAGE_SPECS").ok().and_then(|text| text.parse().ok());
    let specs = specs.unwrap_or(if long { LONG } else { SPECS });
    let mixes = [Mix::Tolerances, Mix::WithMeasured, Mix::WithAlike];
    let one = |(): &mut (), index: usize| covered(index as u64 / 3, mixes[index % 3]);
    let (results, _) = parallel::map(parallel::cores(), mixes.len() * specs, || (), one);
    let mut results: Vec<Covered> = results.into_iter().flatten().collect();
    let share = |one: &Covered| one.held as f64 / one.values.max(1) as f64;
    results.sort_by(|a, b| share(a).total_cmp(&share(b)));
    for kind in 0..23 {
        let of_kind: Vec<_> = results.iter().filter(|one| one.kind == kind).collect();
        if of_kind.is_empty() {
            continue;
        }
        let n = of_kind.len() as f64;
        println!(
            "kind {kind}: {n} specs, least {:.4}, mean {:.4}, width {:.2} of the worst case; {} below",
            share(of_kind[0]),
            of_kind.iter().map(|one| share(one)).sum::<f64>() / n,
            of_kind.iter().map(|one| one.width).sum::<f64>() / n,
            of_kind.iter().filter(|one| share(one) < HELD).count()
        );
    }
    for one in results.iter().take_while(|one| share(one) < HELD).take(8) {
        println!("{}", one.text);
    }
    println!("{} of {} specs", results.len(), mixes.len() * specs);
    assert!(10 * results.len() >= 9 * mixes.len() * specs);
    assert!(results.iter().all(|one| share(one) >= HELD));
    let left = results.iter().find(|one| one.beyond > 1e-9);
    assert!(left.is_none(), "the worst case is left: {:?}", left.map(|one| (one.beyond, &one.text)));
}
