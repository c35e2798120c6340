//! The peaks of a flank with form over its generators: those that are known, and those that show on a grid.
//!
//! Those that show between the lines of a grid are climbed as those of plain flanks are. The grid is narrowed where the
//! demand is not seen to be concave. That does not show every peak: the long form of this module's tests counts the random
//! contacts that have a higher one.
//!
//! The whole flank is searched once for each result, and on the way there only its known [`Peaks`]: any place gives a lower
//! bound of the flank's demand, so a position that balances some places, and at which no other place asks for more, is the
//! solution.

use std::iter::once;

use super::super::climb::{Sample, Search};
use super::super::{FlankContact, Generator, Pose, Range, Touch};

/// Parts into which each half of a flank is divided to find its peaks, and the finer ones where no generator has points over
/// the rack.
const GRIDS: [u32; 2] = [6, 32];

/// How often such a part is halved where its ends do not tell whether a peak lies between.
const DIVISIONS: u32 = 4;

/// The search for others goes on at these distances on either side of a peak, rad. Peaks at both ends of a generator may be
/// that near to each other.
const BESIDE: [f64; 6] = [1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.03];

/// Places on neighbouring generators that are this share of half the face apart may be those of two peaks, one at each end.
const FAR: f64 = 0.1;

/// Between two generators the other end may ask for more by this share of r_b / sin ν and of their distance's square.
const BEND: f64 = 0.125;

/// Peaks of a flank that are kept for the next position.
const KEPT: usize = 3;

/// Peaks nearer to each other (rad) are one.
const ONE_PEAK: f64 = 1e-9;

/// The generators where a flank's peaks were when they were looked for last, the highest first.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::mesh) struct Peaks {
    at: [Option<f64>; KEPT],
    /// Whether the whole flank was searched: otherwise an empty list says nothing.
    pub(in crate::mesh) are_known: bool,
}

impl Peaks {
    /// The highest of these peaks.
    fn of(mut found: Vec<Touch>) -> Self {
        found.sort_by(|a, b| b.demand.total_cmp(&a.demand));
        let mut peaks = Self { are_known: true, ..Self::default() };
        for Touch { spot, .. } in found {
            peaks.add(spot.delta);
        }
        peaks
    }

    /// Keeps one more peak; returns whether it is a new one and there is room.
    fn add(&mut self, delta: f64) -> bool {
        let is_known = self.at.iter().flatten().any(|known| (known - delta).abs() <= ONE_PEAK);
        match self.at.iter_mut().find(|peak| peak.is_none()) {
            Some(free) if !is_known => {
                *free = Some(delta);
                true
            }
            _ => false,
        }
    }
}

impl FlankContact {
    /// The largest demand over the generators of the flank, and its peaks.
    pub(in crate::mesh) fn touch_with_form(&self, pose: &Pose, peaks: &mut Peaks) -> Option<Touch> {
        peaks.are_known = true;
        let flank = self.generators(pose)?;
        let known = self.climbed(pose, flank, f64::NEG_INFINITY, peaks);
        GRIDS.into_iter().find_map(|cells| self.highest(pose, flank, cells, known, peaks))
    }

    /// The largest demand at the known peaks, which follow the position: a lower bound of the flank's demand. `None` if no peak
    /// is known or left.
    pub(in crate::mesh) fn touch_at_peaks(&self, pose: &Pose, floor: f64, peaks: &mut Peaks) -> Option<Touch> {
        self.climbed(pose, self.generators(pose)?, floor, peaks)
    }

    /// The highest of the known peaks, each moved to its present place; a peak that merges with one before it keeps its old
    /// place.
    fn climbed(&self, pose: &Pose, flank: Range, mut floor: f64, peaks: &mut Peaks) -> Option<Touch> {
        let (mut best, mut moved) = (None::<Touch>, Peaks { at: [None; KEPT], ..*peaks });
        for start in peaks.at.into_iter().flatten() {
            let touch = self.climb(pose, &Search { range: flank, flank, floor, start: Some(start), known: None });
            if !touch.is_some_and(|touch| moved.add(touch.spot.delta)) {
                moved.add(start);
            }
            let Some(touch) = touch else { continue };
            if best.is_none_or(|best| touch.demand > best.demand) {
                floor = floor.max(touch.demand);
                best = Some(touch);
            }
        }
        *peaks = moved;
        best
    }

    /// The highest of the known peaks and of those that show on a grid.
    fn highest(&self, pose: &Pose, flank: Range, cells: u32, known: Option<Touch>, peaks: &mut Peaks) -> Option<Touch> {
        let Range { lo, hi } = flank;
        let sample = |x: f64| Sample { x, generator: self.demand(pose, x) };
        let (mut best, mut found) = (None::<Touch>, Vec::new());
        let mut consider = |range: Range, start, known| {
            let touch = self.climb(pose, &Search { range, flank, floor: f64::NEG_INFINITY, start, known });
            if let Some(touch) = touch {
                found.push(touch);
                if best.is_none_or(|best| touch.demand > best.demand) {
                    best = Some(touch);
                }
            }
            touch.map(|touch| touch.spot.delta)
        };
        // narrower near the contact line of plain flanks, where most peaks are
        let middle = 0.0_f64.clamp(lo, hi);
        let place = |end: f64, i: u32| {
            if i == cells { end } else { middle + (end - middle) * f64::from(i * i) / f64::from(cells * cells) }
        };
        let before = (1..=cells).rev().map(|i| place(lo, i));
        let after = (1..=cells).map(|i| place(hi, i));
        let places = before.filter(|&x| x < middle).chain([middle]).chain(after.filter(|&x| x > middle));
        let samples: Vec<Sample> = places.map(sample).collect();
        let floor = samples.iter().map(Sample::demand).fold(f64::NEG_INFINITY, f64::max);
        if samples[0].slope() < 0.0 {
            consider(Range { lo, hi: lo }, None, None);
        }
        if samples[samples.len() - 1].slope() > 0.0 {
            consider(Range { lo: hi, hi }, None, None);
        }
        let mut between: Vec<(Sample, Sample, u32)> = samples.windows(2).map(|ends| (ends[0], ends[1], 0)).collect();
        while let Some((low, high, depth)) = between.pop() {
            if let Some(delta) = low.peak_before(&high) {
                let peak = consider(Range { lo: low.x, hi: high.x }, Some(delta), Some([low, high]));
                // there may be another peak on either side
                if let Some(peak) = peak.filter(|_| depth < DIVISIONS) {
                    let before = BESIDE.iter().rev().map(|beside| peak - beside);
                    let places = before.chain(BESIDE.iter().map(|beside| peak + beside));
                    let within = places.filter(|&x| low.x < x && x < high.x).map(sample);
                    let row: Vec<Sample> = once(low).chain(within).chain(once(high)).collect();
                    let cells = row.windows(2).map(|ends| (ends[0], ends[1], depth + 1));
                    between.extend(cells.filter(|(low, high, _)| !(low.x < peak && peak < high.x)));
                }
            } else if depth < DIVISIONS && low.hides(&high, floor, FAR * self.half_face, BEND * self.scale) {
                let middle = sample(low.x + 0.5 * (high.x - low.x));
                between.extend([(low, middle, depth + 1), (middle, high, depth + 1)]);
            }
        }
        let best = match known {
            Some(known) if best.is_none_or(|best| known.demand > best.demand) => Some(known),
            _ => best,
        };
        found.extend(known);
        *peaks = Peaks::of(found);
        best
    }
}

impl Sample {
    fn demand(&self) -> f64 {
        match self.generator {
            Generator::Some { demand, .. } => demand,
            Generator::None { .. } => f64::NEG_INFINITY,
        }
    }

    /// Where to look first for a peak between this generator and the next one; `None` if none shows.
    fn peak_before(&self, next: &Self) -> Option<f64> {
        let middle = self.x + 0.5 * (next.x - self.x);
        match (self.generator, next.generator) {
            (Generator::Some { slope: before, .. }, Generator::Some { slope: after, .. }) => {
                let share = before / (before - after);
                (before >= 0.0 && after <= 0.0)
                    .then(|| if share.is_nan() { middle } else { self.x + share * (next.x - self.x) })
            }
            // where the flank begins
            (Generator::None { .. }, Generator::Some { slope, .. }) => (slope <= 0.0).then_some(middle),
            (Generator::Some { slope, .. }, Generator::None { .. }) => (slope >= 0.0).then_some(middle),
            (Generator::None { slope: before, .. }, Generator::None { slope: after, .. }) => {
                (before >= 0.0 && after <= 0.0).then_some(middle)
            }
        }
    }

    /// Whether a peak higher than `floor` may lie between this generator and the next one though none shows: where
    /// another edge or surface takes over, or the flank begins or ends, or where the tangents do not bound what lies
    /// between as those of a concave function do, or where the other end of a generator asks for almost as much.
    fn hides(&self, next: &Self, floor: f64, far: f64, bend: f64) -> bool {
        let width = next.x - self.x;
        match (self.generator, next.generator) {
            (
                Generator::Some { demand: here, slope: before, w, rival, .. },
                Generator::Some { demand: there, slope: after, w: next_w, rival: next_rival, .. },
            ) => {
                let is_one = self.is_as(next) && (next_w - w).abs() <= far;
                let mean = (there - here) / width;
                let steepest = before.abs().max(after.abs());
                let less = (here - rival).min(there - next_rival);
                let is_concave = is_one && before >= mean && mean >= after && less > bend * width * width;
                here.max(there) + steepest * width > floor && !is_concave
            }
            (Generator::None { .. }, Generator::None { .. }) => false,
            _ => true,
        }
    }
}
