//! Which placements are worth an exact mesh: those that the sketch expects most of. Solves no mesh.

use std::collections::BTreeSet;

use super::placed::{FlankDemand, Placed};
use super::seat::{self, Run, Seat, Window};
use super::sketch::{STEPS, Sketch};
use crate::judge::bound::{ExtendedError, GivenPair};

/// Which end of the range is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RangeEnd {
    Lower,
    Upper,
}

impl RangeEnd {
    /// What is looked for is the largest of this times ΔCD.
    pub(super) const fn sign(self) -> f64 {
        match self {
            Self::Lower => -1.0,
            Self::Upper => 1.0,
        }
    }
}

/// A placement of all errors, and what the sketch expects of it.
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
    /// Of each seat what its choices do.
    effects: Vec<Vec<Flanks>>,
}

/// What right and left flanks of the rack teeth ask for.
#[derive(Debug, Clone, PartialEq)]
struct Flanks {
    right: Vec<FlankDemand>,
    left: Vec<FlankDemand>,
}

/// The flanks that can carry at a stroke.
struct Carrying {
    stroke: i64,
    right: Vec<usize>,
    left: Vec<usize>,
}

impl Flanks {
    fn none(count: usize) -> Self {
        Self { right: vec![FlankDemand::default(); count], left: vec![FlankDemand::default(); count] }
    }

    fn add(&mut self, other: &Self, times: f64) {
        for (own, other) in [(&mut self.right, &other.right), (&mut self.left, &other.left)] {
            own.iter_mut().zip(other).for_each(|(own, other)| own.add(other, times));
        }
    }

    /// What tells two of them apart at some flanks.
    fn key(&self, carrying: &Carrying) -> Vec<[u64; 3]> {
        let bits = |asked: &FlankDemand| {
            [asked.by_mm, asked.rack_turn_rad, asked.pinion_slope_mm].map(|v| (v + 0.0).to_bits())
        };
        let right = carrying.right.iter().map(|&index| bits(&self.right[index]));
        right.chain(carrying.left.iter().map(|&index| bits(&self.left[index]))).collect()
    }
}

impl<'a> Search<'a> {
    pub(super) fn new(given: &GivenPair, errors: &'a [ExtendedError], sketch: &'a Sketch) -> Self {
        let teeth: Vec<i64> = sketch.teeth().collect();
        let window = Window { first: *sketch.teeth().start(), last: *sketch.teeth().end() };
        let mut seats = seat::seats(errors, &given.pair, window);
        let nominal = Placed::new(&given.pair);
        let everywhere = Carrying { stroke: 0, right: (0..teeth.len()).collect(), left: (0..teeth.len()).collect() };
        let effects = seats.iter_mut().map(|seat| {
            let (mut seen, mut effects) = (BTreeSet::new(), Vec::new());
            seat.choices.retain(|runs| {
                let mut placed = nominal.clone();
                seat::put(&mut placed, &errors[seat.error], runs);
                let right = teeth.iter().map(|&tooth| placed.asked_right(tooth)).collect();
                let left = teeth.iter().map(|&tooth| placed.asked_left(tooth)).collect();
                let flanks = Flanks { right, left };
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

    /// So many different placements, the most promising one first.
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
        let those = |carries: &dyn Fn(i64) -> bool| {
            self.teeth.iter().enumerate().filter(|&(_, &tooth)| carries(tooth)).map(|(index, _)| index).collect()
        };
        Carrying {
            stroke,
            right: those(&|tooth| self.sketch.right(stroke, tooth, &nothing).is_some()),
            left: those(&|tooth| self.sketch.left(stroke, tooth, &nothing).is_some()),
        }
    }

    /// What a right flank asks for.
    fn right(&self, stroke: i64, index: usize, asked: &FlankDemand) -> f64 {
        self.sketch.right(stroke, self.teeth[index], asked).unwrap_or(f64::NEG_INFINITY)
    }

    fn left(&self, stroke: i64, index: usize, asked: &FlankDemand) -> f64 {
        self.sketch.left(stroke, self.teeth[index], asked).unwrap_or(f64::NEG_INFINITY)
    }

    /// The highest ΔCD for each two flanks that may carry together: what each error adds to these two counts alone.
    fn highest(&self, carrying: &Carrying) -> Vec<Candidate> {
        let pairs = carrying.right.iter().flat_map(|&right| carrying.left.iter().map(move |&left| (right, left)));
        let stroke = carrying.stroke;
        let one = |(right, left): (usize, usize)| {
            let (mut of_right, mut of_left) = (FlankDemand::default(), FlankDemand::default());
            let mut choices = Vec::with_capacity(self.seats.len());
            for effects in &self.effects {
                let turns = effects.iter().any(|effect| effect.right[right].turns() || effect.left[left].turns());
                let with = |effect: &Flanks| {
                    if !turns {
                        return effect.right[right].by_mm + effect.left[left].by_mm;
                    }
                    let (mut a, mut b) = (of_right, of_left);
                    a.add(&effect.right[right], 1.0);
                    b.add(&effect.left[left], 1.0);
                    self.right(stroke, right, &a) + self.left(stroke, left, &b)
                };
                let choice = largest(effects.iter().map(with));
                of_right.add(&effects[choice].right[right], 1.0);
                of_left.add(&effects[choice].left[left], 1.0);
                choices.push(choice);
            }
            let expected_mm = 0.5 * (self.right(stroke, right, &of_right) + self.left(stroke, left, &of_left));
            Candidate { stroke, expected_mm, choices }
        };
        pairs.map(one).collect()
    }

    /// ΔCD at a stroke under some effects together, mm.
    fn delta_cd(&self, carrying: &Carrying, effects: &[&Flanks]) -> f64 {
        let sum = |of: &dyn Fn(&Flanks) -> FlankDemand| {
            let mut sum = FlankDemand::default();
            for effect in effects {
                sum.add(&of(effect), 1.0);
            }
            sum
        };
        let right = carrying.right.iter().map(|&index| {
            let asked = sum(&|effect| effect.right[index]);
            self.right(carrying.stroke, index, &asked)
        });
        let left = carrying.left.iter().map(|&index| {
            let asked = sum(&|effect| effect.left[index]);
            self.left(carrying.stroke, index, &asked)
        });
        0.5 * (right.fold(f64::NEG_INFINITY, f64::max) + left.fold(f64::NEG_INFINITY, f64::max))
    }

    /// The placement with the lowest ΔCD at a stroke that is found from any two errors at their best.
    fn lowest(&self, carrying: &Carrying) -> Option<Candidate> {
        if carrying.right.is_empty() || carrying.left.is_empty() {
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
        let mut sum = Flanks::none(self.teeth.len());
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

    /// The two choices that are best together.
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

/// Less than this, mm, is no gain.
const LEAST_GAIN_MM: f64 = 1e-9;

/// The choices that differ at flanks that carry.
fn distinct(effects: &[Flanks], carrying: &Carrying) -> Vec<usize> {
    let mut seen = BTreeSet::new();
    (0..effects.len()).filter(|&index| seen.insert(effects[index].key(carrying))).collect()
}

/// The first of those that are as good as the best.
fn largest(values: impl Iterator<Item = f64>) -> usize {
    let mut best = (0, f64::NEG_INFINITY);
    for (index, value) in values.enumerate() {
        if value > best.1 + LEAST_GAIN_MM {
            best = (index, value);
        }
    }
    best.0
}
