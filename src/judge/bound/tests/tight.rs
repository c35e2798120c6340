//! One error alone at the worst places that a search finds: the upper end is reached.

use super::random::{self, Random};
use crate::judge::bound::sum::bound;
use crate::judge::bound::{Basis, ErrorRange, ExtendedError, Extent, GivenGeometry, GivenPair, Knowledge, KnownPairs};
use crate::judge::reached::reached;
use crate::parallel;

/// Pairs tried. Reached is what comes within 5 % of the error's upper end, and of what undercut lifts, or 0.1 µm.
const PAIRS: usize = 240;

struct Tried {
    text: String,
    kind: usize,
    reached: bool,
    plain: bool,
}

pub(super) fn kind_of(error: &ExtendedError) -> usize {
    let text = format!("{:?}", error.effect);
    let unit = ["Size", "Pitch", "RackLead", "PinionLead"].iter().position(|name| text.starts_with(name)).unwrap();
    unit * 5 + Extent::EVERY.iter().position(|&extent| extent == error.extent).unwrap()
}

fn tried(seed: u64) -> Option<Tried> {
    let mut random = Random(seed ^ 0x7469_6768_7400_0000);
    let pair = random::pair(&mut random);
    let drawn = random::error(&mut random, &pair);
    let errors = [drawn.error];
    let pairs = KnownPairs::new(GivenPair::plain(pair));
    let known = pairs.for_errors(&errors, None).ok()?;
    if known.nominal.ratio < 1.1 {
        return None;
    }
    let knowledge = Knowledge { basis: &Basis::default(), pair: Some(known) };
    let bound = bound(&errors, &knowledge);
    let (total, ErrorRange { upper_mm, .. }) = (bound.combined.range.ok()?, bound.errors[0].ok()?);
    let highest = reached(&errors, &GivenPair::plain(pair)).ok()??.upper_mm;
    let short = total.upper - highest;
    let text = format!(
        "seed {seed}: {short:.6} short of {upper_mm:.6}; own {:?} path {:?} {:?}",
        known.own, known.nominal, drawn.error
    );
    let undercut = known.own.range.upper - known.own.of_lines;
    let plain = undercut < 1e-9;
    Some(Tried {
        plain,
        text,
        kind: kind_of(&drawn.error),
        reached: short <= (0.05 * (undercut + upper_mm).abs()).max(1e-4),
    })
}

#[test]
fn the_upper_end_of_one_error_is_reached() {
    let (results, _) = parallel::map(parallel::cores(), PAIRS, || (), |(), index| tried(index as u64));
    let results: Vec<Tried> = results.into_iter().flatten().collect();
    let reached = results.iter().filter(|tried| tried.reached).count();
    for kind in 0..20 {
        let of_kind: Vec<_> = results.iter().filter(|tried| tried.kind == kind).collect();
        let missed = of_kind.iter().filter(|tried| !tried.reached);
        println!("kind {kind}: {} of {} missed", missed.clone().count(), of_kind.len());
        missed.take(2).for_each(|tried| println!("   {}", tried.text));
    }
    let plain: Vec<_> = results.iter().filter(|tried| tried.plain).collect();
    println!("without undercut: {} of {}", plain.iter().filter(|tried| tried.reached).count(), plain.len());
    println!("{reached} of {} reach their upper end", results.len());
    assert!(10 * plain.iter().filter(|tried| tried.reached).count() >= 9 * plain.len());
    assert!(10 * reached >= 9 * results.len());
}

/// How wide the bound is against what a search reaches, of one error and of several: `stack.md` has these figures.
#[test]
fn how_tight_the_bound_of_several_errors_is() {
    const SPECS: usize = 60;
    let ratio = |count: u32, seed: usize| {
        let mut random = Random(seed as u64 ^ 0x6d61_6e79 ^ u64::from(count) << 32);
        let pair = random::pair(&mut random);
        let errors: Vec<_> = (0..count).map(|_| random::error(&mut random, &pair).error).collect();
        let given = GivenPair::plain(pair);
        let basis = Basis { geometry: GivenGeometry::Known(KnownPairs::new(given)), ..Basis::default() };
        let (range, found) = (basis.together(&errors).range.ok()?, reached(&errors, &given).ok()??);
        let width = found.upper_mm - found.lower_mm;
        (width > 1e-4).then_some((range.upper - range.lower) / width)
    };
    let long = std::env::var("RACKMESH_LONG_TESTS").is_ok_and(|value| value == "1");
    let specs = if long { 5 * SPECS } else { SPECS };
    for (count, most) in [(1, 1.1), (2, 1.5), (3, 1.8)] {
        let (ratios, _) = parallel::map(parallel::cores(), specs, || (), |(), seed| ratio(count, seed));
        let mut ratios: Vec<f64> = ratios.into_iter().flatten().collect();
        ratios.sort_by(f64::total_cmp);
        let at = |share: f64| ratios[(share * (ratios.len() - 1) as f64) as usize];
        println!(
            "{count} errors, {} specs: {:.2} {:.2} {:.2} {:.2}",
            ratios.len(),
            at(0.25),
            at(0.5),
            at(0.75),
            at(0.95)
        );
        assert!(at(0.5) <= most, "{count} errors: {}", at(0.5));
    }
}
