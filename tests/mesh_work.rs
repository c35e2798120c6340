//! What the solver does for random pairs, counted: guesses, bounds and hints change no result, but without them, or
//! with worse ones, there is more to do.
#![allow(missing_docs, clippy::pedantic, clippy::disallowed_methods)]

mod common;

use common::kinds::CASES;
use rackmesh::mesh::{Sampler, Support, Work};

/// Rotations tried, flank pairs in reach and searched, by kind of pair: from a fresh start each, and along strokes near
/// each other. The counts are the same on every machine.
const COUNTED: [(&str, [u64; 3], [u64; 3]); 7] = [
    ("spur", [944, 9211, 3225], [4020, 31513, 8376]),
    ("helical, parallel axes", [926, 9983, 3148], [3846, 34467, 8009]),
    ("crossed helical", [978, 11232, 3173], [4106, 38120, 8540]),
    ("crossed helical, lead errors", [1051, 11775, 4501], [4172, 40439, 13437]),
    ("crossed helical, flank form", [1185, 13310, 5289], [4745, 45082, 17036]),
    ("rack free to roll", [446, 5532, 2252], [1756, 20957, 7279]),
    ("rack free to roll, flank form", [236, 2536, 756], [1232, 12687, 3996]),
];

#[test]
fn no_more_is_done_than_was_counted() {
    let mut more = Vec::new();
    for ((kind, make), (name, fresh, along)) in CASES.into_iter().zip(COUNTED) {
        assert_eq!(kind, name);
        let mut counted = [[0; 3]; 2];
        for seed in 0..40 {
            let case = make(seed);
            let rolling = case.mesh.support() != Support::Fixed;
            if rolling && seed >= if kind.contains("form") { 1 } else { 3 } {
                break;
            }
            let pitch = case.mesh.pair().rack().pitch_mm;
            let mut add = |index: usize, work: Work| {
                for (sum, count) in counted[index].iter_mut().zip([work.rotations, work.in_reach, work.searched]) {
                    *sum += count;
                }
            };
            let mut walker = Sampler::new(&case.mesh);
            for step in 0..if rolling { 4 } else { 60 } {
                let stroke = case.stroke + 0.013 * f64::from(step) * pitch;
                let _ = walker.at(stroke);
                if step % 6 == 0 {
                    let mut sampler = Sampler::new(&case.mesh);
                    let _ = sampler.at(stroke);
                    add(0, sampler.work());
                }
            }
            add(1, walker.work());
        }
        // a little room for changes that move a result by rounding
        let exceeds = |counted: [u64; 3], known: [u64; 3]| {
            counted.iter().zip(known).any(|(&count, known)| 500 * count > 501 * known)
        };
        println!("    (\"{kind}\", {:?}, {:?}),", counted[0], counted[1]);
        if exceeds(counted[0], fresh) || exceeds(counted[1], along) {
            more.push(format!("{kind}: {counted:?}, counted before {fresh:?} {along:?}"));
        }
    }
    assert!(more.is_empty(), "{}", more.join("\n"));
}
