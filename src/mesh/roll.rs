//! The rack that may roll: the smallest centre distance over its roll. Called by the sampler for
//! [`Support::FreeRoll`](super::Support::FreeRoll); the fixed support never comes here.
//!
//! The centre distance over the roll is the largest of many smooth functions, one for each pair of points that can
//! touch, so it is smooth but for kinks where another flank pair, or the other end of the same one, takes over; its
//! derivative is known ([`FlankContact::roll_rate`](super::contact)). With a lead error it has two valleys, mirror
//! images or nearly so, where teeth change for a short while three or more, and their bottoms mostly are kinks: one
//! flank then lies flat on the pinion's.
//!
//! All of them are found by bounds. None of those functions f bends down by more than a curvature C, so that over an
//! interval
//!
//! ```text
//! f(φ) ≥ f(φ_0) + f'(φ_0) (φ − φ_0) − C/2 (φ − φ_0)²
//! ```
//!
//! from either end; an interval whose bound is above the lowest bottom so far is done with, and the others are divided
//! where the bounds of both ends meet. In an interval that falls at one end and rises at the other, the bottom is
//! narrowed down by the intersection of both tangents, which meets a kink quadratically, or by the secant of the
//! derivative where both ends have the same contacts. What is found at a stroke does not depend on the strokes solved before.
//!
//! C is not proven: a rack point at the distance ρ from the roll axis moves on a circle, which bends its height by ρ,
//! and the slope and curvature of the flank that it touches enter on top. It is taken as [`SAFETY`] times the largest
//! such distance; a fifth of that misses a valley now and then, three times as much finds no other. Where teeth hardly
//! enter and two rotations may hold the pinion, the centre distance bends down sharply from one to the other: there a
//! valley may be missed, by micrometres in pairs made for it.

use super::prepare::Roll;
use super::sampler::{Rolling, Sampler};
use super::{Ending, MeshError, MeshPoint};

/// Rolls of a rack that is free to roll that are searched, rad: enough to level a flank with a lead error of 1° at a
/// pressure angle of 14°.
pub const LARGEST_ROLL_RAD: f64 = 0.075;
/// Intervals to begin with; an odd number, so that none ends at 0, where full lines of contact make a kink.
const INTERVALS: i32 = 7;
/// Intervals between a roll with a mesh and one without are divided down to this, to find where the mesh ends.
const SMALLEST_GAP: f64 = 1e-6;
/// How far the centre distance may bend down, in units of the largest distance from the roll axis.
const SAFETY: f64 = 20.0;
/// Intervals divided at one stroke; mostly fewer than 20 are, and 60 were the most among random pairs.
const MAX_DIVISIONS: u32 = 200;
/// Flank pairs searched at one stroke; mostly fewer than 1,000 are, and on random pairs as one would build them 3,200 were
/// the most.
const MAX_SEARCHES: u64 = 20_000;
/// The search goes on this far beside a bottom.
const BESIDE: f64 = 1e-5;
/// Evaluations of one valley; a bisection of the whole range to rounding takes 50.
const MAX_EVALUATIONS: u32 = 80;
/// Rounds until the centre distance that the end faces are placed with is the one that follows; two mostly do.
const MAX_ROUNDS: u32 = 20;
/// At smaller rolls (rad) the slope needs the centre distance as well as the value needs it at this one.
const LEAST_LEVER: f64 = 1e-7;
/// Sides that are this far apart (mm) where the solve ends meet at no rotation; after so many such rounds nothing better
/// is expected.
const APART: f64 = 1e-6;
const MAX_APART: u32 = 3;
/// Bottoms known to this much (mm) are known well enough; rounding of a position leaves up to 1e-12.
const LEVEL: f64 = 3e-12;
/// Valleys as deep within this (mm): the first one is taken, so that the roll does not flicker.
const TIE: f64 = 1e-11;
/// Bottoms this near to an unrolled rack may be it.
const FLAT: f64 = 1e-8;
/// Brackets of one and the same contact this short let the secant speak.
const SAME: f64 = 2e-3;
/// Brackets this short let the tangents at both ends speak for the two sides of a kink: its square times any
/// curvature is below [`LEVEL`].
const SHORT: f64 = 2e-7;

/// The solution at one roll.
#[derive(Debug, Clone, Copy)]
struct Rolled {
    angle: f64,
    value: f64,
    slope: f64,
    point: MeshPoint,
    rolling: Rolling,
}

impl Rolled {
    /// Whether a rotation was found at which both sides balance, or at least change places.
    fn is_balanced(&self) -> bool {
        self.point.ending != Ending::Unbalanced
    }

    /// The rack that is not rolled, if it is as low.
    fn or_level(self, level: Self) -> Self {
        if level.is_balanced() && level.value <= self.value + TIE { level } else { self }
    }

    fn is_nearer_to_balance(&self, other: &Self) -> bool {
        self.point.residual_mm.abs() < other.point.residual_mm.abs()
    }

    /// It is not known to be the lowest.
    fn doubt(&mut self) {
        if self.point.ending == Ending::Converged {
            self.point.ending = Ending::RollNotFound;
        }
    }
}

impl Sampler<'_> {
    /// The roll with the smallest centre distance.
    pub(super) fn solve_rolling(&mut self, stroke_mm: f64, depth_mm: f64) -> Result<MeshPoint, MeshError> {
        let mut found = self.lowest(stroke_mm, depth_mm, MAX_SEARCHES)?;
        if found.angle.abs() < FLAT {
            // an unrolled rack has full lines of contact, which a search from outside never quite meets
            found = found.or_level(self.at_roll(stroke_mm, 0.0, depth_mm)?);
        }
        if found.angle.abs() >= LARGEST_ROLL_RAD && found.slope * found.angle < 0.0 {
            // it goes on falling where no search was made
            found.doubt();
        }
        Ok(found.point)
    }

    /// The lowest bottom of all valleys at a stroke, as far as so many searches of flank pairs tell; of several as deep the
    /// one with the smallest roll.
    fn lowest(&mut self, stroke_mm: f64, depth_mm: f64, searches: u64) -> Result<Rolled, MeshError> {
        let curvature = self.curvature(depth_mm);
        let most_searched = self.work.searched + searches;
        let mut search = Search::default();
        let angles =
            (0..=INTERVALS).map(|step| LARGEST_ROLL_RAD * f64::from(2 * step - INTERVALS) / f64::from(INTERVALS));
        let mut nodes: Vec<Node> =
            angles.map(|angle| search.node(angle, self.at_roll(stroke_mm, angle, depth_mm))).collect();
        // racks of small teeth on wide faces may have a mesh only where they are hardly rolled
        let middle = nodes.len() / 2;
        if !(nodes[middle - 1].is_balanced() && nodes[middle].is_balanced()) {
            let angle = 0.5 * FLAT;
            nodes.insert(middle, search.node(angle, self.at_roll(stroke_mm, angle, depth_mm)));
        }
        for pair in nodes.windows(2) {
            search.open(pair[0], pair[1], curvature);
        }
        let mut positions = 0;
        while let Some(Interval { low, high, meet, .. }) = search.lowest_interval() {
            if let (Some(falling), Some(rising)) = (low.solution, high.solution)
                && (low.is_balanced() && falling.slope < 0.0)
                && (high.is_balanced() && rising.slope >= 0.0)
            {
                let bottom = self.narrow([falling, rising], stroke_mm, depth_mm, most_searched);
                search.found(bottom);
                let (left, right) = (bottom.angle - BESIDE, bottom.angle + BESIDE);
                if left > low.angle {
                    let left = search.node(left, self.at_roll(stroke_mm, left, depth_mm));
                    search.open(low, left, curvature);
                }
                if right < high.angle {
                    let right = search.node(right, self.at_roll(stroke_mm, right, depth_mm));
                    search.open(right, high, curvature);
                }
            } else {
                let middle = search.node(meet, self.at_roll(stroke_mm, meet, depth_mm));
                search.open(low, middle, curvature);
                search.open(middle, high, curvature);
            }
            positions += 1;
            if positions > MAX_DIVISIONS || self.work.searched > most_searched {
                search.unfinished();
                break;
            }
        }
        search.lowest()
    }

    /// What no centre distance bends down by, mm/rad²: the largest distance of a point of the rack's flanks from its roll
    /// axis, with [`SAFETY`].
    fn curvature(&self, depth_mm: f64) -> f64 {
        let rack = self.mesh.pair().rack();
        let height = depth_mm.abs() + rack.addendum_mm.max(self.mesh.pair().normal_module_mm());
        SAFETY * (height * height + 0.25 * rack.face_width_mm * rack.face_width_mm).sqrt()
    }

    /// A bottom between a falling and a rising end, which need not be the lowest one there.
    fn narrow(
        &mut self,
        [mut low, mut high]: [Rolled; 2],
        stroke_mm: f64,
        depth_mm: f64,
        most_searched: u64,
    ) -> Rolled {
        let mut run = 0_i32;
        let mut stalls = 0;
        for _ in 0..MAX_EVALUATIONS {
            let width = high.angle - low.angle;
            let (meet, bound) = tangents(&low, &high);
            let same = low.rolling.at == high.rolling.at;
            let near = if same { SAME } else { SHORT };
            if (width <= near && (low.value.min(high.value) - bound).abs() <= LEVEL) || width <= 1e-12 {
                break;
            }
            let mut angle = if same {
                low.angle - width * low.slope / (high.slope - low.slope)
            } else {
                // from one side: step over the kink, so that the other side comes close too
                match run {
                    1.. => (1.5 * meet - 0.5 * low.angle).max(meet + 0.4 * SHORT),
                    ..=-1 => (1.5 * meet - 0.5 * high.angle).min(meet - 0.4 * SHORT),
                    _ => meet,
                }
            };
            if stalls >= 2 || !(angle > low.angle && angle < high.angle) {
                stalls = 0;
                angle = low.angle + 0.5 * width;
            }
            if angle <= low.angle || angle >= high.angle {
                break;
            }
            // where the mesh ends in between, what is known so far counts
            let may = self.work.searched <= most_searched;
            let here = may.then(|| self.at_roll(stroke_mm, angle, depth_mm).ok()).flatten();
            let Some(here) = here.filter(Rolled::is_balanced) else {
                low.doubt();
                high.doubt();
                break;
            };
            if here.slope < 0.0 {
                low = here;
                run = run.max(0) + 1;
            } else if here.slope > 0.0 {
                high = here;
                run = run.min(0) - 1;
            } else {
                return here;
            }
            stalls = if high.angle - low.angle > 0.5 * width { stalls + 1 } else { 0 };
        }
        // at a kink either side's contacts could be named; always those of the lower roll, so that names do not flicker
        let mut bottom = if low.value <= high.value { low } else { high };
        if low.rolling.at != high.rolling.at {
            bottom.point.right = low.point.right;
            bottom.point.left = low.point.left;
        }
        bottom
    }

    /// The solution at one roll. The rack's end faces are then inclined and cut the flanks at a place that depends on
    /// the centre distance; the dependence is weak and its derivative known, so one or two rounds of Newton's method
    /// do.
    fn at_roll(&mut self, stroke_mm: f64, angle: f64, depth_mm: f64) -> Result<Rolled, MeshError> {
        self.roll = Roll::new(angle, depth_mm);
        let mut point = self.solve(stroke_mm)?;
        let nominal = self.mesh.pair().nominal_center_distance_mm();
        let mut apart = 0;
        let mut settled = false;
        for _ in 0..MAX_ROUNDS {
            if point.ending == Ending::Unbalanced {
                break;
            }
            let moved = point.center_distance_mm - self.assumed;
            self.assumed += moved / self.rolling.remaining();
            if moved.abs() * angle.abs().max(LEAST_LEVER) <= 1e-9 {
                point.center_distance_mm = self.assumed;
                point.delta_cd_mm = self.assumed - nominal;
                settled = true;
                break;
            }
            apart += u32::from(is_apart(&point));
            if apart >= MAX_APART {
                break;
            }
            point = self.solve(stroke_mm)?;
        }
        let rolling = self.rolling;
        let slope = rolling.rate[0] / rolling.remaining();
        let mut rolled = Rolled { angle, value: point.center_distance_mm, slope, point, rolling };
        if !settled {
            rolled.doubt();
        }
        Ok(rolled)
    }
}

/// A roll, and the solution there if there is a mesh.
#[derive(Debug, Clone, Copy)]
struct Node {
    angle: f64,
    solution: Option<Rolled>,
}

impl Node {
    fn is_balanced(&self) -> bool {
        self.solution.as_ref().is_some_and(Rolled::is_balanced)
    }
}

/// Two neighbouring rolls, with a lower bound of the centre distance between them and the roll where it is.
#[derive(Debug, Clone, Copy)]
struct Interval {
    low: Node,
    high: Node,
    meet: f64,
    bound: f64,
}

/// What is known of the valleys at one stroke.
#[derive(Debug, Default)]
struct Search {
    /// The smallest centre distance so far, mm.
    best: Option<f64>,
    /// The positions that were the lowest when they were found.
    lowest: Vec<Rolled>,
    /// Intervals that may hold a lower one.
    intervals: Vec<Interval>,
    /// If there is none: why there is no mesh at some roll, and the position that was nearest to balance.
    failure: Option<MeshError>,
    unbalanced: Option<Rolled>,
}

impl Search {
    fn node(&mut self, angle: f64, solved: Result<Rolled, MeshError>) -> Node {
        match solved {
            Ok(solution) => {
                if solution.is_balanced() {
                    self.found(solution);
                } else if self.unbalanced.is_none_or(|nearest| solution.is_nearer_to_balance(&nearest)) {
                    self.unbalanced = Some(solution);
                }
                Node { angle, solution: Some(solution) }
            }
            Err(error) => {
                self.failure = Some(error);
                Node { angle, solution: None }
            }
        }
    }

    fn found(&mut self, at: Rolled) {
        if self.best.is_none_or(|best| at.value < best + TIE) {
            self.best = Some(self.best.map_or(at.value, |best| best.min(at.value)));
            self.lowest.push(at);
        }
    }

    fn open(&mut self, low: Node, high: Node, curvature: f64) {
        let width = high.angle - low.angle;
        let middle = low.angle + 0.5 * width;
        let (meet, bound) = match (low.solution, high.solution) {
            _ if !(low.is_balanced() || high.is_balanced()) => return,
            (Some(_), Some(_)) if width <= SHORT => return,
            (Some(low), Some(high)) => {
                let (meet, bound) = lower_bound(&low, &high, curvature);
                (meet.clamp(low.angle + 0.1 * width, high.angle - 0.1 * width), bound)
            }
            // the mesh ends in here, perhaps below all that was found
            _ if width <= SMALLEST_GAP => return,
            _ => (middle, f64::NEG_INFINITY),
        };
        self.intervals.push(Interval { low, high, meet, bound });
    }

    /// The interval with the lowest bound, if that is below what was found.
    fn lowest_interval(&mut self) -> Option<Interval> {
        let bounds = self.intervals.iter().map(|interval| interval.bound).enumerate();
        let (index, bound) = bounds.min_by(|a, b| a.1.total_cmp(&b.1))?;
        self.best.is_none_or(|best| bound < best + TIE).then(|| self.intervals.swap_remove(index))
    }

    /// What was found is not known to be the lowest.
    fn unfinished(&mut self) {
        self.lowest.iter_mut().for_each(Rolled::doubt);
    }

    fn lowest(self) -> Result<Rolled, MeshError> {
        let best = self.best.unwrap_or(f64::INFINITY);
        let lowest = self.lowest.into_iter().filter(|position| position.value <= best + TIE);
        match (lowest.min_by(|a, b| a.angle.total_cmp(&b.angle)), self.failure, self.unbalanced) {
            (Some(lowest), ..) => Ok(lowest),
            (None, Some(failure), _) => Err(failure),
            (None, None, Some(unbalanced)) => Ok(unbalanced),
            (None, None, None) => unreachable!("every position is a solution or a failure"),
        }
    }
}

/// Where the tangents of a falling and a rising end meet, and how low that is.
fn tangents(low: &Rolled, high: &Rolled) -> (f64, f64) {
    let width = high.angle - low.angle;
    let meet = low.angle + ((high.value - low.value) - high.slope * width) / (low.slope - high.slope);
    (meet, low.value + low.slope * (meet - low.angle))
}

/// Whether no rotation balances both sides.
fn is_apart(point: &MeshPoint) -> bool {
    point.residual_mm.abs() > APART
}

/// Where the bounds from both ends of an interval meet, and how low that is; next to a roll at which no rotation balances
/// both sides the derivatives say little, and it is what the steeper end allows below the lower one.
fn lower_bound(low: &Rolled, high: &Rolled, curvature: f64) -> (f64, f64) {
    let width = high.angle - low.angle;
    // both parabolas have the same square: their difference is a straight line
    let apart = low.value - high.value + (high.slope + 0.5 * curvature * width) * width;
    let from_low = apart / (high.slope - low.slope + curvature * width);
    if from_low > 0.0 && from_low < width {
        let bound = low.value + (low.slope - 0.5 * curvature * from_low) * from_low;
        (low.angle + from_low, bound)
    } else {
        let steepest = low.slope.abs().max(high.slope.abs());
        let bound = if is_apart(&low.point) || is_apart(&high.point) {
            low.value.min(high.value) - (steepest + 0.5 * curvature * width) * width
        } else {
            // it bends down by more than was thought: nothing is known of what lies between
            f64::NEG_INFINITY
        };
        (low.angle + 0.5 * width, bound)
    }
}

#[cfg(test)]
pub(super) mod tests;
