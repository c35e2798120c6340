//! The centre distance over a range of strokes, with every kink. [`Mesh::curve`] makes it, reports and plots read it.

use std::collections::HashMap;

use super::{Carrier, Mesh, MeshError, MeshPoint, Sampler, Support};
use crate::parallel;

/// Where the carrying flank pair of one side, or the place on it, changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kink {
    /// Stroke, mm.
    pub stroke_mm: f64,
    /// ΔCD there, mm.
    pub delta_cd_mm: f64,
    /// Right and left carrier just before.
    pub before: (Carrier, Carrier),
    /// Right and left carrier just after.
    pub after: (Carrier, Carrier),
}

/// A curve whose points, joined by straight lines, lie within the tolerance of the exact one.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Solved strokes in rising order, both ends and both sides of every kink included.
    pub points: Vec<MeshPoint>,
    /// The kinks, in rising order.
    pub kinks: Vec<Kink>,
    /// The promised tolerance, mm.
    pub tolerance_mm: f64,
    /// How many strokes the search for kinks looked at; a stroke that repeats another one counts, too.
    pub solved: usize,
    /// Whether the tolerance holds everywhere; `false` if refining ended at [`Mesh::curve`]'s limit of work, or at a stroke
    /// whose residual is larger than the tolerance.
    pub resolved: bool,
}

/// First steps per pitch, a whole number: the curve then repeats where its teeth do. Every flank pair carries for a large
/// part of a pitch or not at all between such steps.
const STEPS_PER_PITCH: f64 = 32.0;
/// Kinks are located to this share of a pitch; the error in ΔCD is less by the jump in slope.
const KINK_WIDTH: f64 = 1e-10;
/// Points nearer than this share of a pitch to a kink are not worth keeping.
const CROWDED: f64 = 1e-6;
/// First steps that are refined together, on one core: the curve does not depend on how many cores there are. A rack
/// that may roll is solved at many rolls for each stroke. A pitch is whole blocks.
const BLOCK: usize = 32;
const ROLLING_BLOCK: usize = 8;
/// First steps that are solved and refined at a time: whole blocks, also of those that are solved together.
const PIECE: usize = 1 << 12;
/// Flank pairs that may be searched in refining, see [`searches`]: for kinks in each first step and in the whole curve,
/// and for bends in each first step at [`FINE`].
const FOR_KINKS: f64 = 10_000.0;
const FOR_KINKS_IN_ALL: f64 = 500_000.0;
const FOR_BENDS: f64 = 40_000.0;
/// A tolerance, mm, and how many times as many points finer ones are allowed.
const FINE: f64 = 1e-6;
const MOST_POINTS: f64 = 10.0;
/// First steps at most; longer ranges start coarser.
const MAX_STEPS: f64 = 4e6;
/// A last step may be longer by this share.
const LONGER: f64 = 1e-6;
/// Halvings of a first step at most: 2⁻³⁵ of 1/32 pitch is below the width of a kink.
const MAX_DEPTH: u32 = 36;

/// Halvings after which a kink may be called harmless: 1/(32·2¹²) of a pitch. Where the same teeth carry on, at another place
/// of their flanks, 1/(32·2⁴): of an edge near its end rounding says whether that is a corner, again and again.
const HARMLESS_DEPTH: u32 = 12;
const HARMLESS_PLACE_DEPTH: u32 = 4;
/// A kink is harmless if it bends the curve by less than this share of the tolerance between its neighbours.
const HARMLESS: f64 = 1e-3;

impl Mesh {
    /// The curve from one stroke to another, resolved so that no extreme is missed by more than the tolerance.
    ///
    /// Intervals are halved until their middle lies within half the tolerance of the chord, and wherever the carriers
    /// differ at the ends until the kink is located. Assumes that no pair carries for less than 1/64 of a pitch between
    /// two others.
    ///
    /// # Errors
    /// [`MeshError::EmptyRange`] unless `from_mm <= to_mm` and both are finite, [`MeshError::NotPositive`] for the
    /// tolerance, and whatever a stroke in the range gives.
    pub fn curve(&self, from_mm: f64, to_mm: f64, tolerance_mm: f64) -> Result<Curve, MeshError> {
        let mut curve = Curve { points: Vec::new(), kinks: Vec::new(), tolerance_mm, solved: 0, resolved: true };
        self.curve_pieces(from_mm, to_mm, tolerance_mm, |piece| -> Result<(), MeshError> {
            curve.points.extend(piece.points);
            curve.kinks.extend(piece.kinks);
            curve.solved += piece.solved;
            curve.resolved &= piece.resolved;
            Ok(())
        })?;
        Ok(curve)
    }

    /// The curve in pieces of some `PIECE` first steps, in rising order; each begins behind the last point of the one before.
    /// Memory does not depend on how long the stroke is.
    ///
    /// # Errors
    /// Those of [`Mesh::curve`], and the first one of `take`.
    pub fn curve_pieces<E: From<MeshError>>(
        &self,
        from_mm: f64,
        to_mm: f64,
        tolerance_mm: f64,
        mut take: impl FnMut(Curve) -> Result<(), E>,
    ) -> Result<(), E> {
        if !(from_mm <= to_mm && (to_mm - from_mm).is_finite()) {
            return Err(MeshError::EmptyRange { from_mm, to_mm }.into());
        }
        if !(tolerance_mm > 0.0 && tolerance_mm.is_finite()) {
            return Err(MeshError::NotPositive { what: "tolerance", value_mm: tolerance_mm }.into());
        }
        let steps = Steps::new(from_mm, to_mm, self.pair().rack().pitch_mm);
        let count = steps.count;
        let budget = searches(self.steps_to_a_block(), count.div_ceil(self.steps_to_a_block()), tolerance_mm);
        let mut first = self.solved(&steps, 0)?;
        for from in (0..count).step_by(PIECE) {
            let next = self.solved(&steps, from + PIECE)?;
            first.extend(next.first());
            let mut piece = self.refined(&steps, &first, tolerance_mm, budget)?;
            if from > 0 {
                piece.points.remove(0);
                piece.solved -= 1;
            }
            take(piece)?;
            first = next;
        }
        Ok(())
    }

    /// A piece of first steps.
    fn solved(&self, steps: &Steps, from: usize) -> Result<Vec<Solved>, MeshError> {
        let in_piece = steps.count.saturating_sub(from).min(PIECE);
        let is_last = |step: usize| from + step + 1 == steps.count;
        let alike = match steps.in_pitch {
            Some(in_pitch) => self.repeats(steps.at(from), in_piece.div_ceil(in_pitch)),
            None => Vec::new(),
        };
        let source = |step: usize| match steps.in_pitch {
            Some(in_pitch) if !is_last(step) => alike[step / in_pitch] * in_pitch + step % in_pitch,
            _ => step,
        };
        let own: Vec<usize> = (0..in_piece).filter(|&step| source(step) == step).collect();
        let strokes: Vec<f64> = own.iter().map(|&step| steps.at(from + step)).collect();
        let points: Vec<MeshPoint> = self.sample(&strokes).into_iter().collect::<Result<_, _>>()?;
        let solved = |step: usize| {
            let source = source(step);
            // every source is its own one
            let point = points[own.partition_point(|&own| own < source)];
            let moved = self.moved(&point, steps.pitches(source, step));
            Solved { point: MeshPoint { stroke_mm: steps.at(from + step), ..moved }, source: from + source }
        };
        Ok((0..in_piece).map(solved).collect())
    }

    fn steps_to_a_block(&self) -> usize {
        match self.support() {
            Support::Fixed => BLOCK,
            Support::FreeRoll { .. } => ROLLING_BLOCK,
        }
    }

    /// The curve through first steps that follow each other. Of blocks that repeat each other one is refined.
    fn refined(&self, steps: &Steps, first: &[Solved], tolerance_mm: f64, budget: f64) -> Result<Curve, MeshError> {
        let block = self.steps_to_a_block();
        let pitch = self.pair().rack().pitch_mm;
        let ends = |index: usize| &first[index * block..first.len().min((index + 1) * block + 1)];
        let mut own: Vec<usize> = Vec::new();
        let mut known: HashMap<Vec<usize>, usize> = HashMap::new();
        let mut of_kind = |index: usize| {
            let sources = ends(index).iter().map(|step| step.source).collect();
            *known.entry(sources).or_insert_with(|| {
                own.push(index);
                own.len() - 1
            })
        };
        let kinds: Vec<usize> = (0..first.len().div_ceil(block)).map(&mut of_kind).collect();
        let refined = |(): &mut (), kind: usize| {
            let ends = ends(own[kind]);
            let points = vec![ends[0].point];
            let curve = Curve { points, kinks: Vec::new(), tolerance_mm, solved: ends.len(), resolved: true };
            let mut refiner =
                Refiner { sampler: Sampler::impartial(self), tolerance: tolerance_mm, pitch, curve, budget };
            let mut refine = |ends: &[Solved]| refiner.refine(&ends[0].point, &ends[1].point, 0);
            ends.windows(2).try_for_each(&mut refine).map(|()| refiner.curve)
        };
        let blocks = parallel::map(parallel::cores(), own.len(), || (), refined).0;
        let blocks: Vec<Curve> = blocks.into_iter().collect::<Result<_, _>>()?;
        let points = vec![first[0].point];
        let mut curve = Curve { points, kinks: Vec::new(), tolerance_mm, solved: 1, resolved: true };
        for (index, kind) in kinds.into_iter().enumerate() {
            let pitches = steps.pitches(own[kind] * block, index * block);
            let block = &blocks[kind];
            // the first point of a piece is the last point of the one before
            curve.points.extend(block.points[1..].iter().map(|point| self.moved(point, pitches)));
            curve.kinks.extend(block.kinks.iter().map(|kink| self.moved_kink(kink, pitches)));
            curve.solved += block.solved - 1;
            curve.resolved &= block.resolved;
        }
        Ok(curve)
    }
}

/// The strokes with which a curve begins.
struct Steps {
    from_mm: f64,
    to_mm: f64,
    step_mm: f64,
    count: usize,
    /// Steps in a pitch, if that is a whole number.
    in_pitch: Option<usize>,
}

impl Steps {
    fn new(from_mm: f64, to_mm: f64, pitch_mm: f64) -> Self {
        let length = to_mm - from_mm;
        let steps = length / pitch_mm * STEPS_PER_PITCH;
        let is_even = (2.0..=MAX_STEPS).contains(&steps);
        // a last step that is longer by rounding is no step more
        let whole = if is_even { (steps - LONGER).ceil() } else { steps.clamp(2.0, MAX_STEPS) };
        let step_mm = if is_even { pitch_mm / STEPS_PER_PITCH } else { length / whole };
        let in_pitch = is_even.then_some(STEPS_PER_PITCH as usize);
        Self { from_mm, to_mm, step_mm, count: whole as usize + 1, in_pitch }
    }

    fn at(&self, step: usize) -> f64 {
        if step + 1 >= self.count { self.to_mm } else { self.from_mm + step as f64 * self.step_mm }
    }

    /// How many pitches one step is behind another one that it repeats.
    fn pitches(&self, source: usize, step: usize) -> i64 {
        self.in_pitch.map_or(0, |in_pitch| ((step - source) / in_pitch) as i64)
    }
}

/// A solved first step, and the number of the one whose solution it repeats, or its own.
#[derive(Clone, Copy)]
struct Solved {
    point: MeshPoint,
    source: usize,
}

/// How many flank pairs may be searched in refining a block: many times what realistic pairs take. The work for a kink does
/// not depend on the tolerance; the points for bends go with the inverse root of the tolerance.
fn searches(steps: usize, blocks: usize, tolerance_mm: f64) -> f64 {
    let (steps, blocks) = (steps as f64, blocks as f64);
    steps * (FOR_KINKS + FOR_BENDS * (FINE / tolerance_mm).sqrt().min(MOST_POINTS)) + FOR_KINKS_IN_ALL / blocks
}

struct Refiner<'a> {
    sampler: Sampler<'a>,
    tolerance: f64,
    pitch: f64,
    curve: Curve,
    /// Flank pairs that may be searched; keeps a curve that is rough at every scale from running forever.
    budget: f64,
}

impl Refiner<'_> {
    /// Adds the points after `a` up to `b`.
    fn refine(&mut self, a: &MeshPoint, b: &MeshPoint, depth: u32) -> Result<(), MeshError> {
        let width = b.stroke_mm - a.stroke_mm;
        let middle = a.stroke_mm + 0.5 * width;
        let kinked = a.right != b.right || a.left != b.left;
        let exhausted = depth >= MAX_DEPTH || middle <= a.stroke_mm || middle >= b.stroke_mm;
        let enough = if kinked { KINK_WIDTH } else { CROWDED };
        if exhausted || width <= enough * self.pitch {
            self.finish(a, b, kinked);
            return Ok(());
        }
        if self.sampler.work().searched as f64 >= self.budget {
            self.curve.resolved = false;
            self.keep(b, false);
            return Ok(());
        }
        self.curve.solved += 1;
        let m = self.sampler.at(middle)?;
        // where the residual of a solve is larger than the tolerance, halving resolves nothing
        if m.residual_mm.abs() > self.tolerance {
            self.curve.resolved = false;
            self.keep(&m, false);
            self.keep(b, false);
            return Ok(());
        }
        let sagitta = (m.delta_cd_mm - 0.5 * (a.delta_cd_mm + b.delta_cd_mm)).abs();
        let same = !kinked && m.right == a.right && m.left == a.left;
        if same && sagitta <= 0.5 * self.tolerance {
            self.keep(&m, false);
            self.keep(b, false);
            return Ok(());
        }
        // a kink that bends the curve by less than the tolerance is located well enough
        let teeth = |at: &MeshPoint| (at.right.rack_tooth, at.left.rack_tooth);
        let keeps_teeth = teeth(a) == teeth(&m) && teeth(&m) == teeth(b);
        let deep = if keeps_teeth { HARMLESS_PLACE_DEPTH } else { HARMLESS_DEPTH };
        if kinked && depth >= deep && sagitta <= HARMLESS * self.tolerance {
            self.finish(a, b, true);
            return Ok(());
        }
        self.refine(a, &m, depth + 1)?;
        self.refine(&m, b, depth + 1)
    }

    /// Nothing more is solved between `a` and `b`.
    fn finish(&mut self, a: &MeshPoint, b: &MeshPoint, kinked: bool) {
        if kinked {
            let (before, after) = ((a.right, a.left), (b.right, b.left));
            self.curve.kinks.push(Kink { stroke_mm: b.stroke_mm, delta_cd_mm: b.delta_cd_mm, before, after });
        }
        self.keep(b, kinked);
    }

    fn keep(&mut self, point: &MeshPoint, must: bool) {
        let crowded =
            self.curve.points.last().is_some_and(|last| point.stroke_mm - last.stroke_mm < CROWDED * self.pitch);
        if must || !crowded {
            self.curve.points.push(*point);
        } else if let Some(last) = self.curve.points.last_mut()
            && self.curve.kinks.last().is_none_or(|kink| kink.stroke_mm != last.stroke_mm)
        {
            // of crowded points keep the last, so that an end or the near side of a kink is never lost
            *last = *point;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The work that a curve may take goes with its length and with the inverse root of its tolerance, within bounds.
    #[test]
    fn a_curve_may_take_as_many_searches_as_its_points_need() {
        let near = |found: f64, expected: f64| (found - expected).abs() <= 1e-9 * expected;
        assert!(near(searches(64, 4, FINE), 64.0 * (FOR_KINKS + FOR_BENDS) + FOR_KINKS_IN_ALL / 4.0));
        assert!(near(searches(8, 1, 100.0 * FINE), 8.0 * (FOR_KINKS + FOR_BENDS / 10.0) + FOR_KINKS_IN_ALL));
        let finest = 8.0 * (FOR_KINKS + FOR_BENDS * MOST_POINTS) + FOR_KINKS_IN_ALL;
        assert!(near(searches(8, 1, FINE / 100.0), finest) && near(searches(8, 1, f64::MIN_POSITIVE), finest));
    }
}
