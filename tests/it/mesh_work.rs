//! What the solver does for random pairs, counted: guesses, bounds and hints change no result, but without them, or
//! with worse ones, there is more to do.
#![allow(clippy::pedantic, clippy::disallowed_methods)]

use crate::common::kinds::CASES;
use rackmesh::mesh::{Sampler, Support, Work};

/// Rotations tried, flank pairs in reach and flank pairs searched: from a fresh start each, and along strokes near each
/// other. The counts are the same on every machine.
type Counts = [[u64; 3]; 2];

/// So many pairs of a kind take no more than was counted once.
fn takes_no_more_than(counts: Counts, kind: &str, pairs: u64) {
    let (_, make) = CASES.into_iter().find(|(name, _)| *name == kind).unwrap();
    let mut counted = Counts::default();
    for seed in 0..pairs {
        let case = make(seed);
        let pitch = case.mesh.pair().rack().pitch_mm;
        let mut add = |index: usize, work: Work| {
            for (sum, count) in counted[index].iter_mut().zip([work.rotations, work.in_reach, work.searched]) {
                *sum += count;
            }
        };
        let mut walker = Sampler::new(&case.mesh);
        let steps = if case.mesh.support() == Support::Fixed { 60 } else { 4 };
        for step in 0..steps {
            let stroke = case.stroke + 0.013 * step as f64 * pitch;
            let _ = walker.at(stroke);
            if step % 6 == 0 {
                let mut sampler = Sampler::new(&case.mesh);
                let _ = sampler.at(stroke);
                add(0, sampler.work());
            }
        }
        let work = walker.work();
        assert_eq!(work.strokes, steps);
        assert!(work.strokes <= work.rotations && 2 * work.rotations <= work.in_reach, "{work:?}");
        assert!(work.prepared > 0 && 0 < work.searched && work.searched <= work.in_reach, "{work:?}");
        add(1, work);
    }
    println!("{kind}: {counted:?}");
    // a little room for changes that move a result by rounding
    let more = counted.iter().flatten().zip(counts.iter().flatten()).any(|(count, known)| 500 * count > 501 * known);
    assert!(!more, "{kind}: {counted:?}, counted before: {counts:?}");
}

#[test]
fn spur_pairs() {
    takes_no_more_than([[944, 9553, 3240], [4621, 46483, 9573]], "spur", 40);
}

#[test]
fn helical_pairs_on_parallel_axes() {
    takes_no_more_than([[926, 10465, 3148], [4395, 49443, 9108]], "helical, parallel axes", 40);
}

#[test]
fn crossed_pairs() {
    takes_no_more_than([[978, 11581, 3172], [4941, 57817, 10213]], "crossed helical", 40);
}

#[test]
fn crossed_pairs_with_lead_errors() {
    takes_no_more_than([[1035, 11993, 4433], [5510, 63782, 16307]], "crossed helical, lead errors", 40);
}

/// One rotation of each stroke looks at all of the flanks; the others look at their known peaks only.
#[test]
fn pairs_with_flank_form() {
    takes_no_more_than([[485, 2806, 1640], [1819, 11123, 5460]], "crossed helical, flank form", 8);
}

#[test]
fn rolling_racks() {
    takes_no_more_than([[431, 5698, 1742], [1670, 21620, 6607]], "rack free to roll", 3);
}

/// A flank without form bounds what one with form asks for: that is quicker than a search, and bounds it a little less.
#[test]
fn rolling_racks_with_flank_form() {
    takes_no_more_than([[209, 2487, 684], [1196, 13580, 3983]], "rack free to roll, flank form", 1);
}
