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
//! from either end. An interval whose bound is above the lowest bottom so far is finished; the others are divided where
//! the bounds of both ends meet. Where the same points touch at both ends the cubic through both values and slopes
//! bounds more closely. In an interval that falls at one end and rises at the other, the bottom is
//! narrowed down by the intersection of both tangents, which meets a kink quadratically, or by the secant of the
//! derivative where both ends have the same contacts.
//!
//! A bound needs no solution: at any rotation the tangents of both sides meet at what both ask for together, and teeth that
//! carried and known peaks are a lower bound of what a side asks for. So most rolls take one rotation, from what is
//! expected there ([`course`]), and only bottoms are solved with all teeth and all of their flanks; where that gives more
//! than the bound, the search goes on. The search begins around the last stroke's bottom: the result does not depend on
//! that by more than rounding, unless C is too small.
//!
//! C is not proven: a rack point at the distance ρ from the roll axis moves on a circle, which bends its height by ρ, the
//! pinion turns by some ρ/r_b for a unit of roll, which its involute turns into a height, and the slope and curvature of the
//! flank enter on top. It is taken as [`SAFETY`] · ρ (1 + ρ/r_b) with the largest such distance; without the second term wide
//! racks on slim pinions miss a valley now and then. A contact at the rack's tip edge or where the involute starts bends down
//! more sharply: from there C is 8 times as large. Where slopes show a larger curvature, that one counts. Where teeth hardly
//! enter and two rotations may hold the pinion, the centre distance bends down sharply from one to the other: there a valley
//! may be missed, by micrometres in pairs made for it.

pub(super) mod course;
mod valleys;

use self::course::{AROUND, Start};
use self::valleys::{Interval, Node, Rolled, SHORT, Search, TIE, is_apart, level_between, lowest_between, tangents};
use super::prepare::Roll;
use super::sampler::{Looks, Sampler};
use super::{Ending, MeshError, MeshPoint};

/// Rolls of a rack that is free to roll that are searched, rad: enough to level a flank with a lead error of 1° at a
/// pressure angle of 14°.
pub const LARGEST_ROLL_RAD: f64 = 0.075;
/// Intervals to begin with; an odd number, so that none ends at 0, where full lines of contact make a kink.
const INTERVALS: i32 = 7;
/// How far the centre distance may bend down, in units of ρ (1 + ρ/r_b).
const SAFETY: f64 = 20.0;
/// Intervals divided at one stroke; mostly fewer than 20 are, and 60 were the most among random pairs.
const MAX_DIVISIONS: u32 = 200;
/// Flank pairs searched at one stroke; mostly fewer than 1,000 are, and at most 3,200 on realistic random pairs.
const MAX_SEARCHES: u64 = 20_000;
/// The search goes on this far beside a bottom that is not known to be the lowest place there.
const BESIDE: f64 = 1e-5;
/// Most rotations for the bound at one roll, and most factors by which a bracket around the expected bottom grows.
const MOST_LOOKS: u32 = 4;
const MOST_GROWN: u32 = 4;
/// After so many bottoms at which something else asks for more, all of a stroke's rolls are solved.
const MOST_SURPRISES: u32 = 8;
/// What tangents leave out counts if it is more than this, mm, or than this share of what a roll is above the lowest bottom.
const LEFT_OUT: f64 = 1e-13;
const SHARE_LEFT_OUT: f64 = 0.02;
/// Evaluations of one valley; a bisection of the whole range to rounding takes 50.
const MAX_EVALUATIONS: u32 = 80;
/// Most rounds until the centre distance that places the end faces agrees with the result; two are usually enough.
const MAX_ROUNDS: u32 = 20;
/// At smaller rolls (rad) the slope needs the centre distance as well as the value needs it at this one.
const LEAST_LEVER: f64 = 1e-7;
/// Rounds after whose solve the sides are apart; after so many nothing better is expected.
const MAX_APART: u32 = 3;
/// Bottoms known to this much (mm) are known well enough; rounding of a position leaves up to 1e-12.
const LEVEL: f64 = 3e-12;
/// Bottoms this near to an unrolled rack may be it.
const FLAT: f64 = 1e-8;
/// Brackets of one and the same contact this short let the secant speak.
const SAME: f64 = 2e-3;

impl Sampler<'_> {
    /// The roll with the smallest centre distance.
    pub(super) fn solve_rolling(&mut self, stroke_mm: f64, depth_mm: f64) -> Result<MeshPoint, MeshError> {
        let mut found = self.lowest(stroke_mm, depth_mm, MAX_SEARCHES)?;
        if found.angle.abs() < FLAT {
            // an unrolled rack has full lines of contact, which a search from outside never quite meets
            found = found.or_level(self.at_roll(stroke_mm, 0.0, depth_mm)?);
        }
        if found.angle.abs() >= LARGEST_ROLL_RAD && found.slope * found.angle < 0.0 {
            // the centre distance still falls at the end of the range that is searched
            found.doubt();
        }
        Ok(found.point)
    }

    /// The lowest bottom of all valleys at a stroke, within a limit of searches of flank pairs; of several equally low ones the
    /// one with the smallest roll.
    fn lowest(&mut self, stroke_mm: f64, depth_mm: f64, searches: u64) -> Result<Rolled, MeshError> {
        let stroke = AtStroke { stroke_mm, depth_mm, most_searched: self.work.searched + searches };
        let mut search = Search { curvature: self.curvature(depth_mm), ..Search::default() };
        self.course.go_on();
        self.begin(&stroke, &mut search);
        let mut positions = 0;
        while let Some(Interval { low, high, meet, .. }) = search.lowest_interval() {
            if let Some([low, high]) = self.known(&stroke, &mut search, &[low, high]) {
                search.open(low, high);
            } else if let (Some(falling), Some(rising)) = (low.solution, high.solution)
                && (low.is_balanced() && falling.slope < 0.0)
                && (high.is_balanced() && rising.slope >= 0.0)
            {
                self.valley(&stroke, &mut search, [falling, rising]);
            } else {
                let middle = self.node(&stroke, &mut search, meet);
                search.open(low, middle);
                search.open(middle, high);
            }
            positions += 1;
            if positions > MAX_DIVISIONS || self.work.searched > stroke.most_searched {
                search.unfinished();
                break;
            }
        }
        let lowest = search.lowest()?;
        self.course.ends_at(lowest.angle);
        Ok(lowest)
    }

    /// The first intervals: around the bottom where the last stroke had it, or of the same width.
    fn begin(&mut self, stroke: &AtStroke, search: &mut Search) {
        if let Some([falling, rising]) = self.expected(stroke) {
            self.valley(stroke, search, [falling, rising]);
            let ends = [-LARGEST_ROLL_RAD, LARGEST_ROLL_RAD].map(|angle| self.node(stroke, search, angle));
            search.open(ends[0], Node::of(falling));
            search.open(Node::of(rising), ends[1]);
            return;
        }
        let angles =
            (0..=INTERVALS).map(|step| LARGEST_ROLL_RAD * f64::from(2 * step - INTERVALS) / f64::from(INTERVALS));
        let mut nodes: Vec<Node> = angles.map(|angle| self.node(stroke, search, angle)).collect();
        // racks of small teeth on wide faces may have a mesh only where they are hardly rolled
        let middle = nodes.len() / 2;
        if !(nodes[middle - 1].is_balanced() && nodes[middle].is_balanced()) {
            nodes.insert(middle, self.node(stroke, search, 0.5 * FLAT));
        }
        for pair in nodes.windows(2) {
            search.open(pair[0], pair[1]);
        }
    }

    /// A falling and a rising end around the bottom where the last stroke had it.
    fn expected(&mut self, stroke: &AtStroke) -> Option<[Rolled; 2]> {
        let (bottom, mut reach) = self.course.bottom()?;
        let mut near = self.at_least(stroke, bottom, None).ok().filter(Rolled::is_balanced)?;
        let outward = if near.slope < 0.0 { 1.0 } else { -1.0 };
        for _ in 0..MOST_GROWN {
            let angle = bottom + outward * reach;
            if angle.abs() >= LARGEST_ROLL_RAD {
                return None;
            }
            let far = self.at_least(stroke, angle, None).ok().filter(Rolled::is_balanced)?;
            match (outward > 0.0, far.slope >= 0.0) {
                (true, true) => return Some([near, far]),
                (false, false) => return Some([far, near]),
                _ => near = far,
            }
            reach *= 8.0;
        }
        None
    }

    /// Both ends of an interval, those solved that may be the lowest; `None` if they are known.
    fn known(&mut self, stroke: &AtStroke, search: &mut Search, ends: &[Node; 2]) -> Option<[Node; 2]> {
        let best = search.best?;
        let is_open = |node: &Node| node.solution.is_some_and(|rolled| !rolled.is_exact && rolled.value < best + TIE);
        ends.iter().any(is_open).then(|| {
            ends.map(|end| {
                if !is_open(&end) {
                    return end;
                }
                let solved = self.at_roll(stroke.stroke_mm, end.angle, stroke.depth_mm);
                search.node(end.angle, solved)
            })
        })
    }

    /// A roll of the search.
    fn node(&mut self, stroke: &AtStroke, search: &mut Search, angle: f64) -> Node {
        let solved = match search.best {
            Some(best) => self.at_least(stroke, angle, Some(best)),
            None => self.at_roll(stroke.stroke_mm, angle, stroke.depth_mm),
        };
        search.node(angle, solved)
    }

    /// A bottom between a falling and a rising end, and the intervals beside it that are left to search.
    fn valley(&mut self, stroke: &AtStroke, search: &mut Search, [falling, rising]: [Rolled; 2]) {
        let Narrowed { low, high, is_closed } = self.narrow([falling, rising], stroke);
        let bottom = if low.value <= high.value { low } else { high };
        let [from, to] = [falling, rising].map(Node::of);
        let angle = if is_closed { lowest_between(&low, &high).unwrap_or(bottom.angle) } else { bottom.angle };
        let is_solved = bottom.is_exact && angle == bottom.angle;
        let exact = if is_solved { Ok(bottom) } else { self.at_roll(stroke.stroke_mm, angle, stroke.depth_mm) };
        match exact {
            Ok(mut exact) if exact.is_balanced() && exact.value <= bottom.value + LEVEL => {
                if bottom.point.ending == Ending::RollNotFound {
                    exact.doubt();
                }
                search.found(exact.named_as(&low, &high));
                let [left, right] = if is_closed {
                    [low, high].map(|end| Node::of(Rolled { is_exact: true, ..end }))
                } else {
                    [-BESIDE, BESIDE].map(|beside| {
                        let angle = (exact.angle + beside).clamp(falling.angle, rising.angle);
                        self.node(stroke, search, angle)
                    })
                };
                search.open(from, left);
                search.open(right, to);
            }
            // another tooth or peak asks for more there
            exact => {
                self.course.surprises += 1;
                let middle = search.node(angle, exact);
                search.open(from, middle);
                search.open(middle, to);
            }
        }
    }

    /// The curvature C = [`SAFETY`] · ρ (1 + ρ/r_b), mm/rad².
    fn curvature(&self, depth_mm: f64) -> f64 {
        let distance = self.largest_distance(depth_mm);
        SAFETY * distance * (1.0 + distance / self.mesh.pair().pinion().base_radius_mm)
    }

    /// The largest distance ρ of a point of the rack's flanks from its roll axis, mm.
    fn largest_distance(&self, depth_mm: f64) -> f64 {
        let rack = self.mesh.pair().rack();
        let height = depth_mm.abs() + rack.addendum_mm.max(self.mesh.pair().normal_module_mm());
        (height * height + 0.25 * rack.face_width_mm * rack.face_width_mm).sqrt()
    }

    /// Both ends next to a bottom between a falling and a rising end, which need not be the lowest one there.
    fn narrow(&mut self, [mut low, mut high]: [Rolled; 2], stroke: &AtStroke) -> Narrowed {
        let mut is_closed = false;
        let mut run = 0_i32;
        let mut stalls = 0;
        for _ in 0..MAX_EVALUATIONS {
            let width = high.angle - low.angle;
            let (meet, bound) = tangents(&low, &high);
            let same = low.rolling.at == high.rolling.at;
            let near = if same { SAME } else { SHORT };
            if (width <= near && (low.value.min(high.value) - bound).abs() <= LEVEL) || width <= 1e-12 {
                is_closed = true;
                break;
            }
            let mut angle = if same {
                level_between(&low, &high)
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
            // where the mesh ends in between, take what is known so far
            let may = self.work.searched <= stroke.most_searched;
            let here = may.then(|| self.at_least(stroke, angle, None).ok()).flatten();
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
                return Narrowed { low: here, high: here, is_closed: true };
            }
            stalls = if high.angle - low.angle > 0.5 * width { stalls + 1 } else { 0 };
        }
        Narrowed { low, high, is_closed }
    }

    /// The solution at one roll. The rack's end faces are then inclined and cut the flanks at a place that depends on
    /// the centre distance; the dependence is weak and its derivative known, so one or two rounds of Newton's method
    /// do.
    fn at_roll(&mut self, stroke_mm: f64, angle: f64, depth_mm: f64) -> Result<Rolled, MeshError> {
        self.roll = Roll::new(angle, depth_mm);
        if let Some([turned, assumed]) = self.course.at(angle, AROUND) {
            (self.last, self.assumed) = (Some((turned, 0.0)), assumed);
        }
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
        let mut rolled = Rolled { angle, value: point.center_distance_mm, slope, point, rolling, is_exact: true };
        if !settled {
            rolled.doubt();
        }
        self.keep(&rolled);
        Ok(rolled)
    }

    /// A lower bound of the centre distance at a roll, by one rotation or a few, from what is expected there. If the lowest
    /// known bottom is given, the bound is only as exact as the comparison needs.
    fn at_least(&mut self, stroke: &AtStroke, angle: f64, best: Option<f64>) -> Result<Rolled, MeshError> {
        let AtStroke { stroke_mm, depth_mm, .. } = *stroke;
        let expected = self.course.at(angle, f64::INFINITY).filter(|_| self.course.surprises <= MOST_SURPRISES);
        if let Some([mut turned, assumed]) = expected {
            self.roll = Roll::new(angle, depth_mm);
            self.assumed = assumed;
            self.looks = Looks::AtPeaks;
            let reach = self.largest_distance(depth_mm) + self.constants.default_rate;
            let mut found = None;
            for _ in 0..MOST_LOOKS {
                let Ok(Some((point, [step, moved]))) = self.glimpse(stroke_mm, turned) else { break };
                let off = reach * step.abs() + (moved * angle).abs();
                let left_out = SAFETY * off * off / reach;
                if left_out <= LEFT_OUT
                    || best.is_some_and(|best| left_out <= SHARE_LEFT_OUT * (point.center_distance_mm - best))
                {
                    let slope = self.rolling.rate[0] / self.rolling.remaining();
                    let value = point.center_distance_mm - left_out;
                    self.assumed = point.center_distance_mm;
                    found = Some(Rolled { angle, value, slope, point, rolling: self.rolling, is_exact: false });
                    break;
                }
                turned += step;
                self.assumed += moved;
            }
            self.looks = Looks::Everywhere;
            if let Some(found) = found {
                self.keep(&found);
                return Ok(found);
            }
        }
        self.at_roll(stroke_mm, angle, depth_mm)
    }

    /// Keeps where a roll was solved.
    fn keep(&mut self, rolled: &Rolled) {
        // where nothing balances, nothing is known about the rotation at the next roll
        self.last = self.last.filter(|_| rolled.is_balanced());
        let Some((offset, displacement)) = self.last else { return };
        let turned = offset - displacement * self.constants.angle_per_mm;
        let turn = rolled.rolling.turn[0] + rolled.rolling.turn[1] * rolled.slope;
        let (at, rate) = ([turned, rolled.point.center_distance_mm], [turn, rolled.slope]);
        self.course.here.push(Start { angle: rolled.angle, at, rate });
    }
}

/// A stroke at which rolls are searched.
#[derive(Debug, Clone, Copy)]
struct AtStroke {
    stroke_mm: f64,
    depth_mm: f64,
    /// The search ends once so many flank pairs were searched.
    most_searched: u64,
}

/// Both ends next to a bottom, and whether nothing between them is lower.
struct Narrowed {
    low: Rolled,
    high: Rolled,
    is_closed: bool,
}

#[cfg(test)]
pub(super) mod tests;
