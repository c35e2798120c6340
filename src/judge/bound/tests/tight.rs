//! One error alone at the worst places that a search finds: the upper end is reached.

use super::random::{self, Random};
use crate::judge::bound::sum::bound;
use crate::judge::bound::{Basis, ErrorRange, ExtendedError, Extent, GivenPair, Knowledge, KnownPairs};
use crate::judge::reached::reached;
use crate::parallel;

/// Pairs tried. Reached is what comes within 5 % of the error's upper end, and of what undercut lifts, or 0.1 µm.
const PAIRS: usize = 600;

struct Tried {
    text: String,
    kind: usize,
    reached: bool,
    plain: bool,
}

fn kind_of(error: &ExtendedError) -> usize {
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
