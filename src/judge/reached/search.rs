//! Which placements are worth an exact mesh: those with the best estimates by the sketch. Solves no mesh.

use std::collections::BTreeSet;

use super::placed::{FlankDemand, Placed};
use super::seat::{self, Run, Seat};
use super::sketch::{STEPS, Sketch};
use crate::judge::bound::{ExtendedError, GivenPair};
use crate::mesh::FlankSide;

/// Which end of the range is sought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RangeEnd {
    Lower,
    Upper,
}

impl RangeEnd {
    /// The search maximises this factor times ΔCD.
    pub(super) const fn sign(self) -> f64 {
        match self {
            Self::Lower => -1.0,
            Self::Upper => 1.0,
        }
    }
}

/// A placement of all errors with its estimate by the sketch.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    /// The stroke, in steps of the sketch.
    pub(super) stroke: i64,
    /// ΔCD, mm.
    pub(super) expected_mm: f64,
    /// The choice of each seat.
    choices: Vec<usize>,
}

pub(super) struct Search<'a> {
    errors: &'a [ExtendedError],
    sketch: &'a Sketch,
    /// Rack teeth that can carry.
    teeth: Vec<i64>,
    seats: Vec<Seat>,
    /// The effects of each seat's choices.
    effects: Vec<Vec<Flanks>>,
}

/// The demands of the rack teeth's flanks on both [`SIDES`].
struct Flanks([Vec<FlankDemand>; 2]);

/// The flanks that can carry at a stroke on both [`SIDES`].
struct Carrying {
    stroke: i64,
    flanks: [Vec<usize>; 2],
}

const SIDES: [FlankSide; 2] = [FlankSide::Right, FlankSide::Left];

impl Flanks {
    fn add(&mut self, other: &Self, times: f64) {
        let flanks = self.0.iter_mut().flatten().zip(other.0.iter().flatten());
        flanks.for_each(|(own, other)| own.add(other, times));
    }

    /// The key by which two choices differ at some flanks.
    fn key(&self, carrying: &Carrying) -> Vec<[u64; 3]> {
        let bits = |asked: &FlankDemand| {
            [asked.by_mm, asked.rack_turn_rad, asked.pinion_slope_mm].map(|v| (v + 0.0).to_bits())
        };
        let of_side = |(asked, carrying): (&Vec<FlankDemand>, &Vec<usize>)| -> Vec<_> {
            carrying.iter().map(|&index| bits(&asked[index])).collect()
        };
        self.0.iter().zip(&carrying.flanks).flat_map(of_side).collect()
    }
}

impl<'a> Search<'a> {
    pub(super) fn new(given: &GivenPair, errors: &'a [ExtendedError], sketch: &'a Sketch) -> Self {
        let teeth: Vec<i64> = sketch.teeth().collect();
        let mut seats = seat::seats(errors, &given.pair, &sketch.teeth());
        let nominal = Placed::new(&given.pair);
        let everywhere = Carrying { stroke: 0, flanks: SIDES.map(|_| (0..teeth.len()).collect()) };
        let effects = seats.iter_mut().map(|seat| {
            let (mut seen, mut effects) = (BTreeSet::new(), Vec::new());
            seat.choices.retain(|runs| {
                let mut placed = nominal.clone();
                seat::put(&mut placed, &errors[seat.error], runs);
                let flanks = Flanks(SIDES.map(|side| teeth.iter().map(|&tooth| placed.asked(side, tooth)).collect()));
                let is_new = seen.insert(flanks.key(&everywhere));
                if is_new {
                    effects.push(flanks);
                }
                is_new
            });
            effects
        });
        let effects = effects.collect();
        Self { errors, sketch, teeth, seats, effects }
    }

    /// Errors with their runs, in the order of the errors.
    pub(super) fn runs(&self, candidate: &Candidate) -> Vec<Vec<Run>> {
        let mut runs = vec![Vec::new(); self.errors.len()];
        for (seat, &choice) in self.seats.iter().zip(&candidate.choices) {
            runs[seat.error].extend_from_slice(&seat.choices[choice]);
        }
        runs
    }

    /// Up to so many different placements, the most promising one first.
    pub(super) fn candidates(&self, which: RangeEnd, count: usize) -> Vec<Candidate> {
        let mut candidates: Vec<Candidate> = (0..STEPS)
            .flat_map(|stroke| {
                let carrying = self.carrying(stroke);
                match which {
                    RangeEnd::Upper => self.highest(&carrying),
                    RangeEnd::Lower => self.lowest(&carrying).into_iter().collect(),
                }
            })
            .collect();
        let sign = which.sign();
        candidates.sort_by(|a, b| (sign * b.expected_mm).total_cmp(&(sign * a.expected_mm)));
        let mut seen = BTreeSet::new();
        candidates.retain(|candidate| seen.insert(candidate.choices.clone()));
        candidates.truncate(count);
        candidates
    }

    fn carrying(&self, stroke: i64) -> Carrying {
        let nothing = FlankDemand::default();
        let flanks = SIDES.map(|side| {
            let carries = |&index: &usize| self.sketch.asked(side, stroke, self.teeth[index], &nothing).is_some();
            (0..self.teeth.len()).filter(carries).collect()
        });
        Carrying { stroke, flanks }
    }

    /// The demand of a flank.
    fn asked(&self, side: FlankSide, stroke: i64, index: usize, asked: &FlankDemand) -> f64 {
        self.sketch.asked(side, stroke, self.teeth[index], asked).unwrap_or(f64::NEG_INFINITY)
    }

    /// The highest ΔCD for every two flanks that may carry together: only what each error adds to these two counts.
    fn highest(&self, carrying: &Carrying) -> Vec<Candidate> {
        let stroke = carrying.stroke;
        let one = |places: [usize; 2]| {
            let of = |effect: &Flanks| SIDES.map(|side| effect.0[side as usize][places[side as usize]]);
            let both = |asked: &[FlankDemand; 2]| {
                let [right, left] =
                    SIDES.map(|side| self.asked(side, stroke, places[side as usize], &asked[side as usize]));
                right + left
            };
            let added = |sums: &[FlankDemand; 2], effect: &Flanks| {
                let mut added = *sums;
                added.iter_mut().zip(of(effect)).for_each(|(sum, asked)| sum.add(&asked, 1.0));
                added
            };
            let mut sums = [FlankDemand::default(); 2];
            let mut choices = Vec::with_capacity(self.seats.len());
            for effects in &self.effects {
                let turns = effects.iter().any(|effect| of(effect).iter().any(FlankDemand::turns));
                let with = |effect: &Flanks| {
                    let [right, left] = of(effect);
                    if turns { both(&added(&sums, effect)) } else { right.by_mm + left.by_mm }
                };
                let choice = largest(effects.iter().map(with));
                sums = added(&sums, &effects[choice]);
                choices.push(choice);
            }
            Candidate { stroke, expected_mm: 0.5 * both(&sums), choices }
        };
        let [right, left] = &carrying.flanks;
        right.iter().flat_map(|&right| left.iter().map(move |&left| [right, left])).map(one).collect()
    }

    /// ΔCD at a stroke under some effects together, mm.
    fn delta_cd(&self, carrying: &Carrying, effects: &[&Flanks]) -> f64 {
        let [right, left] = SIDES.map(|side| {
            let asked = carrying.flanks[side as usize].iter().map(|&index| {
                let mut sum = FlankDemand::default();
                for effect in effects {
                    sum.add(&effect.0[side as usize][index], 1.0);
                }
                self.asked(side, carrying.stroke, index, &sum)
            });
            asked.fold(f64::NEG_INFINITY, f64::max)
        });
        0.5 * (right + left)
    }

    /// The placement with the lowest ΔCD at a stroke, searched from every two errors at their best.
    fn lowest(&self, carrying: &Carrying) -> Option<Candidate> {
        if carrying.flanks.iter().any(Vec::is_empty) {
            return None;
        }
        let open: Vec<Vec<usize>> = self.effects.iter().map(|effects| distinct(effects, carrying)).collect();
        let mut choices: Vec<usize> = vec![0; self.seats.len()];
        let mut lowest = self.descend(carrying, &open, &mut choices);
        for first in 0..self.seats.len() {
            for second in first + 1..self.seats.len() {
                let mut others = choices.clone();
                self.set_two(carrying, &open, &mut others, [first, second]);
                let found = self.descend(carrying, &open, &mut others);
                if found < lowest {
                    (lowest, choices) = (found, others);
                }
            }
        }
        Some(Candidate { stroke: carrying.stroke, expected_mm: lowest, choices })
    }

    /// The sum of the seats' effects.
    fn sum(&self, choices: &[usize]) -> Flanks {
        let mut sum = Flanks(SIDES.map(|_| vec![FlankDemand::default(); self.teeth.len()]));
        self.effects.iter().zip(choices).for_each(|(effects, &choice)| sum.add(&effects[choice], 1.0));
        sum
    }

    /// Changes the choice of one seat after the other as long as that lowers ΔCD, which is returned.
    fn descend(&self, carrying: &Carrying, open: &[Vec<usize>], choices: &mut [usize]) -> f64 {
        let mut lowest = self.delta_cd(carrying, &[&self.sum(choices)]);
        loop {
            let before = lowest;
            for (seat, effects) in self.effects.iter().enumerate() {
                let mut rest = self.sum(choices);
                rest.add(&effects[choices[seat]], -1.0);
                for &choice in &open[seat] {
                    let found = self.delta_cd(carrying, &[&rest, &effects[choice]]);
                    if found < lowest - LEAST_GAIN_MM {
                        (lowest, choices[seat]) = (found, choice);
                    }
                }
            }
            if lowest >= before {
                return lowest;
            }
        }
    }

    /// The best two choices together.
    fn set_two(&self, carrying: &Carrying, open: &[Vec<usize>], choices: &mut [usize], [first, second]: [usize; 2]) {
        let mut rest = self.sum(choices);
        rest.add(&self.effects[first][choices[first]], -1.0);
        rest.add(&self.effects[second][choices[second]], -1.0);
        let mut lowest = f64::INFINITY;
        for &one in &open[first] {
            for &other in &open[second] {
                let both = [&rest, &self.effects[first][one], &self.effects[second][other]];
                let found = self.delta_cd(carrying, &both);
                if found < lowest - LEAST_GAIN_MM {
                    (lowest, choices[first], choices[second]) = (found, one, other);
                }
            }
        }
    }
}

/// A gain below this, mm, does not count.
const LEAST_GAIN_MM: f64 = 1e-9;

/// The choices that differ at flanks that carry.
fn distinct(effects: &[Flanks], carrying: &Carrying) -> Vec<usize> {
    let mut seen = BTreeSet::new();
    (0..effects.len()).filter(|&index| seen.insert(effects[index].key(carrying))).collect()
}

/// The first of the choices that equal the best.
fn largest(values: impl Iterator<Item = f64>) -> usize {
    let mut best = (0, f64::NEG_INFINITY);
    for (index, value) in values.enumerate() {
        if value > best.1 + LEAST_GAIN_MM {
            best = (index, value);
        }
    }
    best.0
}
