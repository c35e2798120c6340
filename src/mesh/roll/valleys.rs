//! What is known of the valleys of the centre distance over the roll at one stroke: the rolls that were solved, the
//! intervals between them, and a lower bound in each. The search in [`roll`](super) writes it; it solves nothing.

use crate::mesh::contact::Surface;
use crate::mesh::sampler::{Contact, Rolling};
use crate::mesh::{ContactKind, Ending, MeshError, MeshPoint};

/// Intervals between a roll with a mesh and one without are divided down to this, to find where the mesh ends.
pub(super) const SMALLEST_GAP: f64 = 1e-10;
/// Fourth derivatives of one contact's centre distance by the roll are less than so many times the second ones.
pub(super) const FOURTH: f64 = 1000.0;
/// Sides that are this far apart (mm) where the solve ends meet at no rotation.
pub(super) const APART: f64 = 1e-6;
/// A contact at the rack's tip edge or where the involute starts bends down this much more than others.
const SHARP: f64 = 8.0;
/// From rolls this far apart the slopes tell the curvature; a curvature so many times as large is allowed for.
const TELLING: f64 = 5e-4;
const BENDS_MORE: f64 = 1.5;
/// Valleys as deep within this (mm): the first one is taken, so that the roll does not flicker.
pub(super) const TIE: f64 = 1e-11;
/// Positions equally low belong to one valley if their rolls are this near.
const ONE_VALLEY: f64 = 1e-5;
/// In brackets this short the tangents at both ends stand for the two sides of a kink: the square of its length times any
/// curvature is negligible.
pub(super) const SHORT: f64 = 2e-7;

/// The solution at one roll.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rolled {
    pub(super) angle: f64,
    pub(super) value: f64,
    pub(super) slope: f64,
    pub(super) point: MeshPoint,
    pub(super) rolling: Rolling,
    /// Whether this is the solution at the roll; if not, it is a lower bound.
    pub(super) is_exact: bool,
}

impl Rolled {
    /// Whether a rotation was found at which both sides balance, or at least change places.
    pub(super) fn is_balanced(&self) -> bool {
        self.point.ending != Ending::Unbalanced
    }

    /// Whether a contact is at the rack's tip edge, where the smaller demand of two planes counts, or where the involute
    /// starts, whose curvature has no bound on the base circle.
    fn bends_sharply(&self) -> bool {
        let is_sharp = |kind: &ContactKind| matches!(kind, ContactKind::RackEdge | ContactKind::RootEdge);
        let bends = |at: &Contact| at.surface == Surface::Tip || at.edges.iter().flatten().any(is_sharp);
        self.rolling.at.is_some_and(|at| at.iter().any(bends))
    }

    /// The position of the rack without roll, if it is as low.
    pub(super) fn or_level(self, level: Self) -> Self {
        if level.is_balanced() && level.value <= self.value + TIE { level } else { self }
    }

    /// At a kink the contacts of either side could be named: take those of the lower roll, so that names do not flicker.
    pub(super) fn named_as(mut self, low: &Self, high: &Self) -> Self {
        if low.rolling.at != high.rolling.at {
            self.point.right = low.point.right;
            self.point.left = low.point.left;
        }
        self
    }

    pub(super) fn is_nearer_to_balance(&self, other: &Self) -> bool {
        self.point.residual_mm.abs() < other.point.residual_mm.abs()
    }

    /// A lower bound of the centre distance within so much beside this roll.
    fn lowest_beside(&self, width: f64, curvature: f64) -> f64 {
        self.value - (self.slope.abs() + 0.5 * curvature * width) * width
    }

    /// Marks the position as not known to be the lowest.
    pub(super) fn doubt(&mut self) {
        if self.point.ending == Ending::Converged {
            self.point.ending = Ending::RollNotFound;
        }
    }
}

/// A roll, and the solution there if there is a mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub(super) angle: f64,
    pub(super) solution: Option<Rolled>,
}

impl Node {
    pub(super) fn of(solution: Rolled) -> Self {
        Self { angle: solution.angle, solution: Some(solution) }
    }

    pub(super) fn is_balanced(&self) -> bool {
        self.solution.as_ref().is_some_and(Rolled::is_balanced)
    }
}

/// Two neighbouring rolls, with a lower bound of the centre distance between them and the roll where it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval {
    pub(super) low: Node,
    pub(super) high: Node,
    pub(super) meet: f64,
    pub(super) bound: f64,
}

/// What is known of the valleys at one stroke.
#[derive(Debug, Default)]
pub(super) struct Search {
    /// The assumed curvature C, mm/rad².
    pub(super) curvature: f64,
    /// The smallest centre distance so far, mm.
    pub(super) best: Option<f64>,
    /// The positions that were the lowest when they were found.
    pub(super) lowest: Vec<Rolled>,
    /// Intervals that may hold a lower one.
    pub(super) intervals: Vec<Interval>,
    /// If no position is known: why there is no mesh at some roll, and the position nearest to balance.
    pub(super) failure: Option<MeshError>,
    pub(super) unbalanced: Option<Rolled>,
}

impl Search {
    pub(super) fn node(&mut self, angle: f64, solved: Result<Rolled, MeshError>) -> Node {
        match solved {
            Ok(solution) => {
                if solution.is_balanced() {
                    if solution.is_exact {
                        self.found(solution);
                    }
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

    pub(super) fn found(&mut self, at: Rolled) {
        if self.best.is_none_or(|best| at.value < best + TIE) {
            self.best = Some(self.best.map_or(at.value, |best| best.min(at.value)));
            self.lowest.push(at);
        }
    }

    pub(super) fn open(&mut self, low: Node, high: Node) {
        self.learn(&low, &high);
        let ends = [low.solution, high.solution];
        let is_sharp = ends.iter().flatten().any(Rolled::bends_sharply);
        let curvature = self.curvature * if is_sharp { SHARP } else { 1.0 };
        let width = high.angle - low.angle;
        let middle = low.angle + 0.5 * width;
        let (meet, bound) = match (low.solution, high.solution) {
            _ if !(low.is_balanced() || high.is_balanced()) => return,
            (Some(_), Some(_)) if width <= SHORT => return,
            (Some(low), Some(high)) => {
                let ends = [low, high].into_iter().filter(|end| !end.is_exact).map(|end| end.value);
                let (meet, bound) = lower_bound(&low, &high, curvature);
                let bound = if bound.is_finite() { bound.max(smooth_bound(&low, &high, curvature)) } else { bound };
                let bound = ends.fold(bound, f64::min);
                (meet.clamp(low.angle + 0.1 * width, high.angle - 0.1 * width), bound)
            }
            // the mesh ends in this interval, perhaps below every position found
            _ if width <= SMALLEST_GAP => return,
            (Some(end), None) | (None, Some(end)) => (middle, end.lowest_beside(width, curvature)),
            (None, None) => return,
        };
        self.intervals.push(Interval { low, high, meet, bound });
    }

    /// Slopes that fall between two rolls give a lower bound of the curvature: where it is more than assumed, all intervals are
    /// bounded again.
    fn learn(&mut self, low: &Node, high: &Node) {
        let (Some(from), Some(to)) = (low.solution, high.solution) else { return };
        let width = to.angle - from.angle;
        let bend = BENDS_MORE * (from.slope - to.slope) / width;
        if width >= TELLING && bend > self.curvature && from.is_balanced() && to.is_balanced() {
            self.curvature = bend;
            for Interval { low, high, .. } in std::mem::take(&mut self.intervals) {
                self.open(low, high);
            }
        }
    }

    /// The interval with the lowest bound, if the bound is below the lowest position found.
    pub(super) fn lowest_interval(&mut self) -> Option<Interval> {
        let bounds = self.intervals.iter().map(|interval| interval.bound).enumerate();
        let (index, bound) = bounds.min_by(|a, b| a.1.total_cmp(&b.1))?;
        self.best.is_none_or(|best| bound < best + TIE).then(|| self.intervals.swap_remove(index))
    }

    /// Marks the result as not known to be the lowest.
    pub(super) fn unfinished(&mut self) {
        self.lowest.iter_mut().for_each(Rolled::doubt);
    }

    pub(super) fn lowest(self) -> Result<Rolled, MeshError> {
        let best = self.best.unwrap_or(f64::INFINITY);
        let lowest = || self.lowest.iter().filter(|position| position.value <= best + TIE);
        let first = lowest().map(|position| position.angle).fold(f64::INFINITY, f64::min);
        let lowest = lowest().filter(|position| position.angle <= first + ONE_VALLEY).copied();
        match (lowest.min_by(|a, b| a.value.total_cmp(&b.value)), self.failure, self.unbalanced) {
            (Some(lowest), ..) => Ok(lowest),
            (None, Some(failure), _) => Err(failure),
            (None, None, Some(unbalanced)) => Ok(unbalanced),
            (None, None, None) => unreachable!("every position is a solution or a failure"),
        }
    }
}

/// Where the tangents of a falling and a rising end meet, and the centre distance there.
pub(super) fn tangents(low: &Rolled, high: &Rolled) -> (f64, f64) {
    let width = high.angle - low.angle;
    let meet = low.angle + ((high.value - low.value) - high.slope * width) / (low.slope - high.slope);
    (meet, low.value + low.slope * (meet - low.angle))
}

/// Whether no rotation balances both sides.
pub(super) fn is_apart(point: &MeshPoint) -> bool {
    point.residual_mm.abs() > APART
}

/// Where the bounds from both ends of an interval meet, and the centre distance there. Next to a roll at which no rotation
/// balances both sides the derivatives say little: there the bound is what the steeper end allows below the lower one.
pub(super) fn lower_bound(low: &Rolled, high: &Rolled, curvature: f64) -> (f64, f64) {
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
            // the curvature is larger than assumed: nothing is known of what lies between
            f64::NEG_INFINITY
        };
        (low.angle + 0.5 * width, bound)
    }
}

/// A lower bound between two rolls with the same contact. The centre distance follows the cubic through both values and
/// slopes, except for x² (w − x)²/24 times its fourth derivative, which is less than x² w²/24 times it from either end to
/// the middle.
pub(super) fn smooth_bound(low: &Rolled, high: &Rolled, curvature: f64) -> f64 {
    let width = high.angle - low.angle;
    if low.rolling.at != high.rolling.at || is_apart(&low.point) || is_apart(&high.point) {
        return f64::NEG_INFINITY;
    }
    let bend = curvature + ((high.slope - low.slope) / width).abs();
    let off = FOURTH * bend * width * width / 24.0;
    let half = |from: &Rolled, to: &Rolled, toward: f64| {
        let (rise, s0, s1) = (to.value - from.value, toward * from.slope * width, toward * to.slope * width);
        // a + b t + c t² + d t³ for t from 0 to 1/2
        let (b, c, d) = (s0, 3.0 * rise - 2.0 * s0 - s1 - off * width * width, s0 + s1 - 2.0 * rise);
        let at = |t: f64| from.value + t * (b + t * (c + t * d));
        let root = (c * c - 3.0 * b * d).sqrt();
        let far = -(c + root.copysign(c));
        let turns = [far / (3.0 * d), b / far].into_iter().filter(|t| *t > 0.0 && *t < 0.5);
        turns.map(at).fold(at(0.5), f64::min)
    };
    half(low, high, 1.0).min(half(high, low, -1.0))
}

/// Where the centre distance is level, by the derivatives of two ends with the same contact.
pub(super) fn level_between(low: &Rolled, high: &Rolled) -> f64 {
    low.angle - (high.angle - low.angle) * low.slope / (high.slope - low.slope)
}

/// The lowest place between two ends next to a bottom, with one kink or none.
pub(super) fn lowest_between(low: &Rolled, high: &Rolled) -> Option<f64> {
    let angle = if low.rolling.at == high.rolling.at { level_between(low, high) } else { tangents(low, high).0 };
    (low.angle..=high.angle).contains(&angle).then_some(angle)
}
