//! Where an error may be, by its extent: the choices of the search, and how a choice is put on the teeth. Knows no contact.

use std::ops::RangeInclusive;

use super::placed::{BySide, Placed, TEETH};
use crate::deviation::Extent;
use crate::deviation::Part;
use crate::gear::Pair;
use crate::judge::bound::ExtendedError;
use crate::judge::bound::error::ErrorEffect;
use crate::mesh::FlankSide;

/// A value on successive spaces, steps or teeth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// The first one. Space k lies after tooth k, step k is the pitch before tooth k. Numbers of a pinion continue around the
    /// turn: −1 is z − 1.
    pub first: i64,
    /// The last one, included.
    pub last: i64,
    /// The flanks that have the value: both if `None`. Right flanks of a pinion face higher tooth numbers.
    pub side: Option<FlankSide>,
    /// Height of a space, length of a step, or displacement of a flank with a total deviation (towards higher numbers), mm;
    /// turn of a rack's tooth line, rad; slope deviation f_Hβ of a pinion, mm.
    pub value: f64,
}

/// An error, or one flank side of it, and the places where it may be.
#[derive(Debug, Clone)]
pub(super) struct Seat {
    /// The index of the error.
    pub(super) error: usize,
    pub(super) choices: Vec<Vec<Run>>,
}

/// A rack's space, step or tooth that never carries at the strokes of the search, and the one after it.
const FAR: i64 = *TEETH.end() - 2;

/// What placing an error of one part needs.
struct Places {
    part: Part,
    /// Spaces or teeth that matter.
    teeth: RangeInclusive<i64>,
    /// Steps that matter.
    steps: RangeInclusive<i64>,
    /// Number of teeth of the pinion.
    z: i64,
}

impl Run {
    const fn of(first: i64, last: i64, value: f64) -> Self {
        Self { first, last, side: None, value }
    }

    const fn on(self, side: FlankSide) -> Self {
        Self { side: Some(side), ..self }
    }

    const fn count(&self) -> i64 {
        self.last - self.first + 1
    }

    fn by_side(&self) -> BySide {
        match self.side {
            None => BySide::both(self.value),
            Some(FlankSide::Left) => BySide { left: self.value, right: 0.0 },
            Some(FlankSide::Right) => BySide { left: 0.0, right: self.value },
        }
    }

    /// How far the steps move a tooth.
    fn moves(&self, tooth: i64) -> f64 {
        let steps = (tooth - self.first + 1).clamp(0, self.count().max(0)) as f64;
        steps * self.value
    }
}

/// The seats of every error, if these rack teeth can carry at the strokes of the search.
pub(super) fn seats(errors: &[ExtendedError], pair: &Pair, carrying: &RangeInclusive<i64>) -> Vec<Seat> {
    let seats = errors.iter().enumerate().flat_map(|(index, error)| {
        let choices = choices(error, &balance(errors, error), &Places::new(error.part, carrying, pair));
        choices.into_iter().map(move |choices| Seat { error: index, choices })
    });
    seats.collect()
}

/// The sign of a lead that cancels the leads on all teeth of the same part.
fn balance(errors: &[ExtendedError], error: &ExtendedError) -> Vec<f64> {
    if !error.effect.is_lead() {
        return Vec::new();
    }
    let is_like = |one: &&ExtendedError| one.part == error.part && one.extent == Extent::All && one.effect.is_lead();
    let sum: f64 = errors.iter().filter(is_like).map(|one| one.value).sum();
    let [least, most] = error.ends();
    vec![most, least, (-sum).clamp(least, most)]
}

/// The places of an error, or of its flank sides.
fn choices(error: &ExtendedError, leads: &[f64], places: &Places) -> Vec<Vec<Vec<Run>>> {
    if let Some(signs) = error.signs() {
        return vec![signs.iter().flat_map(|error| choices(error, leads, places)).flatten().collect()];
    }
    match error.effect {
        ErrorEffect::Size if error.extent == Extent::Each => {
            vec![error.ends().map(|value| vec![places.every(value)]).to_vec()]
        }
        ErrorEffect::Size => vec![places.of_teeth(error.value, error.extent)],
        ErrorEffect::Pitch { cap, .. } => places.of_pitch(error, cap),
        ErrorEffect::RackLead(_) | ErrorEffect::PinionLead { .. } => places.of_lead(error.value, error.extent, leads),
    }
}

impl Places {
    fn new(part: Part, carrying: &RangeInclusive<i64>, pair: &Pair) -> Self {
        let (first, last) = (*carrying.start(), *carrying.end());
        // space k lies between teeth k and k + 1; a rack tooth carries with pinion teeth k − 1 and k
        Self { part, teeth: first - 1..=last, steps: first..=last, z: i64::from(pair.pinion().teeth) }
    }

    /// A space or tooth that does not matter, if there is one.
    fn far(&self, near: &RangeInclusive<i64>, count: i64) -> Option<i64> {
        match self.part {
            Part::Rack => Some(FAR),
            Part::Pinion => {
                let others = self.z - (near.end() - near.start() + 1);
                (others >= count).then_some(near.end() + 1 + (others - count) / 2)
            }
        }
    }

    /// Each space or tooth that matters, and one that does not.
    fn single(&self, near: &RangeInclusive<i64>) -> Vec<i64> {
        let on_turn = |&place: &i64| self.part == Part::Rack || place - near.start() < self.z;
        near.clone().filter(on_turn).chain(self.far(near, 1)).collect()
    }

    /// All runs with a length between these two.
    fn runs(&self, near: &RangeInclusive<i64>, least: i64, value: f64) -> Vec<Run> {
        let most = if self.part == Part::Rack { i64::MAX } else { self.z - 1 };
        let mut runs = Vec::new();
        for first in near.clone() {
            let lasts = (first + least - 1..=*near.end()).take_while(|last| last - first < most);
            runs.extend(lasts.map(|last| Run::of(first, last, value)));
        }
        runs
    }

    fn every(&self, value: f64) -> Run {
        match self.part {
            Part::Rack => Run::of(*TEETH.start(), *TEETH.end(), value),
            Part::Pinion => Run::of(0, self.z - 1, value),
        }
    }

    /// The choices of a value that each space or tooth has for itself.
    fn of_teeth(&self, value: f64, extent: Extent) -> Vec<Vec<Run>> {
        let one = |run: Run| vec![run];
        match extent {
            Extent::One => self.single(&self.teeth).into_iter().map(|on| one(Run::of(on, on, value))).collect(),
            Extent::Part => {
                let far = self.far(&self.teeth, 2).map(|first| Run::of(first, first + 1, value));
                far.into_iter().chain(self.runs(&self.teeth, 2, value)).map(one).collect()
            }
            Extent::All => vec![one(self.every(value))],
            // each tooth has its own value, or both flank sides have: not one value
            Extent::Each | Extent::Total => Vec::new(),
        }
    }

    fn of_lead(&self, value: f64, extent: Extent, leads: &[f64]) -> Vec<Vec<Vec<Run>>> {
        if extent != Extent::Each {
            return vec![self.of_teeth(value, extent)];
        }
        let of_side = |side| leads.iter().map(|&lead| vec![self.every(lead).on(side)]).collect();
        [FlankSide::Left, FlankSide::Right].map(of_side).to_vec()
    }

    fn of_pitch(&self, error: &ExtendedError, cap: Option<f64>) -> Vec<Vec<Vec<Run>>> {
        let ExtendedError { value, extent, .. } = *error;
        if extent == Extent::Total {
            return [FlankSide::Left, FlankSide::Right].map(|side| self.of_total(value.abs(), side)).to_vec();
        }
        let mut choices = match (self.part, extent) {
            (Part::Rack, Extent::All) if cap.is_none() => vec![vec![self.every(value)]],
            (_, Extent::Each) => self.of_each_pitch(error.ends()),
            (Part::Rack, Extent::One) => {
                self.single(&self.steps).into_iter().map(|on| vec![Run::of(on, on, value)]).collect()
            }
            (Part::Rack, _) => {
                let runs = self.runs(&self.steps, 2, value);
                runs.into_iter().chain([Run::of(FAR, FAR + 1, value)]).map(|run| vec![run]).collect()
            }
            (Part::Pinion, Extent::One) => self.step_and_back(value),
            // the pitches of a pinion close over a turn, so they cannot all be off the same way
            (Part::Pinion, _) => self.there_and_back(value, 1..=self.z / 2),
        };
        if let Some(cap) = cap {
            for runs in &mut choices {
                limit(runs, cap);
            }
        }
        vec![choices]
    }

    /// A step of the pinion and another one that takes it back.
    fn step_and_back(&self, value: f64) -> Vec<Vec<Run>> {
        let mut steps = self.single(&self.steps);
        steps.extend(self.far(&self.steps, 2).map(|far| far + 1));
        let mut choices = Vec::new();
        for &there in &steps {
            let others = steps.iter().filter(|&&back| (back - there) % self.z != 0);
            choices.extend(others.map(|&back| vec![Run::of(there, there, value), Run::of(back, back, -value)]));
        }
        choices
    }

    /// Some steps of the pinion in line, and as many that take them back, at once or as late as possible.
    fn there_and_back(&self, value: f64, counts: RangeInclusive<i64>) -> Vec<Vec<Run>> {
        let near = self.steps.end() - self.steps.start() + 1;
        let mut choices = Vec::new();
        // runs longer than the window do not differ
        for count in counts.filter(|&count| count <= near + 1) {
            for first in self.steps.start() - self.z + 1..=*self.steps.end() {
                let mut backs = vec![first + count, first + self.z - count];
                backs.dedup();
                choices.extend(backs.into_iter().map(|back| {
                    vec![Run::of(first, first + count - 1, value), Run::of(back, back + count - 1, -value)]
                }));
            }
        }
        choices
    }

    /// Steps between two values: a run of one value among steps of the other value, or among nearly 0.
    fn of_each_pitch(&self, [least, most]: [f64; 2]) -> Vec<Vec<Run>> {
        let (first, last) = (*self.steps.start(), *self.steps.end());
        let nothing = 0.0_f64.clamp(least, most);
        let mut choices = if nothing == 0.0 { vec![Vec::new()] } else { Vec::new() };
        for run in [most, least].into_iter().flat_map(|value| self.runs(&self.steps, 1, value)) {
            for others in [nothing, least + most - run.value] {
                let runs = [Run::of(first, run.first - 1, others), run, Run::of(run.last + 1, last, others)];
                let runs = runs.into_iter().filter(|run| run.count() > 0 && run.value != 0.0).collect();
                choices.extend(self.closed(runs, [least, most]));
            }
        }
        if self.part == Part::Pinion {
            choices.extend(self.there_and_back(most.min(-least).max(0.0), 1..=self.z / 2));
        }
        choices
    }

    /// Adds the other steps of a turn, which take back the sum of these if they can.
    fn closed(&self, mut runs: Vec<Run>, [least, most]: [f64; 2]) -> Option<Vec<Run>> {
        if self.part == Part::Rack {
            return Some(runs);
        }
        let sum: f64 = runs.iter().map(|run| run.count() as f64 * run.value).sum();
        let back = Run::of(self.steps.end() + 1, self.steps.start() + self.z - 1, 0.0);
        let each = if sum == 0.0 { 0.0 } else { -sum / back.count().max(0) as f64 };
        ((least..=most).contains(&each) && back.count() >= 0).then(|| {
            runs.push(Run { value: each, ..back });
            runs
        })
    }

    /// Some teeth in line off by the whole deviation, on one flank side.
    fn of_total(&self, value: f64, side: FlankSide) -> Vec<Vec<Run>> {
        let runs = [value, -value].into_iter().flat_map(|value| self.runs(&self.teeth, 1, value));
        runs.map(|run| vec![run.on(side)]).chain([Vec::new()]).collect()
    }
}

/// Makes steps smaller until no two teeth are farther apart than the total deviation.
fn limit(runs: &mut [Run], cap: f64) {
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    let ends: Vec<i64> = runs.iter().map(|run| run.last).collect();
    for end in ends {
        let sum: f64 = runs.iter().map(|run| run.moves(end)).sum();
        (low, high) = (low.min(sum), high.max(sum));
    }
    let share = if high - low > cap { cap / (high - low) } else { 1.0 };
    for run in runs {
        run.value *= share;
    }
}

/// Puts an error on the teeth of a choice.
pub(super) fn put(placed: &mut Placed, error: &ExtendedError, runs: &[Run]) {
    let part = error.part;
    match error.effect {
        ErrorEffect::Size => {
            for run in runs {
                (run.first..=run.last).for_each(|space| placed.raise_space(part, space, run.value));
            }
        }
        ErrorEffect::Pitch { .. } if error.extent == Extent::Total => put_total(placed, part, runs),
        ErrorEffect::Pitch { .. } => put_steps(placed, part, runs),
        ErrorEffect::RackLead(_) | ErrorEffect::PinionLead { .. } => {
            for run in runs {
                (run.first..=run.last).for_each(|tooth| placed.turn(part, tooth, run.by_side()));
            }
        }
    }
}

/// Steps move all teeth after them; tooth 0 stays.
fn put_steps(placed: &mut Placed, part: Part, runs: &[Run]) {
    let teeth = placed.teeth(part);
    let count = teeth.end() - teeth.start() + 1;
    let first = match part {
        Part::Rack => *teeth.start(),
        Part::Pinion => runs.iter().map(|run| run.first).min().unwrap_or(0),
    };
    let sum = |tooth: i64| runs.iter().map(|run| run.moves(tooth)).sum::<f64>();
    let of_first = match part {
        Part::Rack => sum(0),
        Part::Pinion => sum(first + (-first).rem_euclid(count)),
    };
    for tooth in first..first + count {
        placed.shift(part, tooth, BySide::both(sum(tooth) - of_first));
    }
}

/// A pinion's total deviation is measured from the mean of the turn.
fn put_total(placed: &mut Placed, part: Part, runs: &[Run]) {
    for run in runs {
        let by = run.by_side();
        (run.first..=run.last).for_each(|tooth| placed.shift(part, tooth, by));
        if part == Part::Pinion {
            let teeth = placed.teeth(part);
            let share = run.count() as f64 / (teeth.end() + 1) as f64;
            let mean = BySide { left: -share * by.left, right: -share * by.right };
            teeth.for_each(|tooth| placed.shift(part, tooth, mean));
        }
    }
}
