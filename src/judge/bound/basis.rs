//! What is given of a pair besides its errors, ready for errors of any size. Made once for a spec; computes no range itself.

use std::sync::{Arc, OnceLock};

use super::known::KnownTeeth;
use super::single::range_of;
use super::sum::{Combined, bound, reached_at_least, together};
use super::{Bound, ErrorRange, ExtendedError, GivenPair, Knowledge, KnownPair, NoBound, OwnCurve, Range, Reach};
use crate::formula::PartDeviation;

/// What a bound rests on.
#[derive(Debug, Clone, Default)]
pub struct Basis {
    /// The pair's geometry.
    pub geometry: GivenGeometry,
    /// The curve of the pair without errors, if its geometry is not known.
    pub own_curve: OwnCurve,
    /// The curve of teeth that are known one by one; the errors are then those of the other part.
    pub known_teeth: Option<KnownTeeth>,
    /// The exact mesh of the errors and the known teeth together, where every error is on all teeth alike, so that nothing is
    /// left to place.
    pub all_placed: Option<Range>,
    /// Whether the rack is free to roll; for a known pair its support says so.
    pub rolls: bool,
    /// Normal module, if it is known without the geometry, mm.
    pub normal_module_mm: Option<f64>,
    /// Addendum of the rack, if it is known without the geometry, mm.
    pub addendum_mm: Option<f64>,
}

/// What is given of the pair's geometry.
#[derive(Debug, Clone, Default)]
pub enum GivenGeometry {
    /// Only what the laws of the errors need.
    #[default]
    Unknown,
    /// The statement that a tooth of the rack, and one of the pinion, always carries with both flanks: ε ≥ 1 + 2|c| and
    /// ε ≥ 1 + |1 − 2c|.
    BothFlanks,
    /// The whole geometry.
    Known(KnownPairs),
}

/// A pair with known geometry, with what follows from it for errors of each size, computed when it is first needed.
#[derive(Debug, Clone)]
pub struct KnownPairs {
    given: Arc<GivenPair>,
    steps: Arc<[OnceLock<Result<KnownPair, NoBound>>; STEPS]>,
}

/// Sizes of errors, mm: four steps until they are doubled, up to 1 m.
const SMALLEST_MM: [f64; 4] = [1e-3, 1.189_207_115e-3, 1.414_213_562e-3, 1.681_792_831e-3];
const STEPS: usize = 81;

/// The largest errors of a step, either way, and of the pinion alone.
fn reach(step: usize) -> Reach {
    let size = SMALLEST_MM[step % SMALLEST_MM.len()] * (1_u64 << (step / SMALLEST_MM.len())) as f64;
    Reach { range: Range { lower: -size, upper: size }, of_pinion_mm: size }
}

impl KnownPairs {
    /// A known pair for which nothing is computed yet.
    #[must_use]
    pub fn new(given: GivenPair) -> Self {
        Self { given: Arc::new(given), steps: Arc::new(std::array::from_fn(|_| OnceLock::new())) }
    }

    /// The pair.
    #[must_use]
    pub fn given(&self) -> &GivenPair {
        &self.given
    }

    /// What is known for these errors beside known teeth, from the smallest step that holds them: the answer for an error does
    /// not depend on earlier ones.
    ///
    /// # Errors
    /// [`NoBound`] if errors of this size leave no pair.
    pub(super) fn for_errors(
        &self,
        errors: &[ExtendedError],
        teeth: Option<KnownTeeth>,
    ) -> Result<&KnownPair, NoBound> {
        let least = reached_at_least(errors);
        let mut step = (0..STEPS).find(|&step| reach(step).range.upper >= least).ok_or(NoBound::BeyondReach)?;
        loop {
            let known = self.step(step)?;
            let reached = known.reached(errors).with(teeth);
            if known.reach.holds(&reached) {
                return Ok(known);
            }
            let wider = step + 1..STEPS;
            step = wider.into_iter().find(|&step| reach(step).holds(&reached)).ok_or(NoBound::BeyondReach)?;
        }
    }

    fn step(&self, step: usize) -> Result<&KnownPair, NoBound> {
        let known = self.steps[step].get_or_init(|| KnownPair::new(*self.given, reach(step)));
        known.as_ref().map_err(|open| *open)
    }
}

impl Basis {
    /// What is known, for these errors.
    ///
    /// # Errors
    /// [`NoBound`] as [`KnownPairs::for_errors`].
    pub(super) fn knowledge(&self, errors: &[ExtendedError]) -> Result<Knowledge<'_>, NoBound> {
        let pair = match &self.geometry {
            GivenGeometry::Unknown | GivenGeometry::BothFlanks => None,
            GivenGeometry::Known(pairs) => Some(pairs.for_errors(errors, self.known_teeth)?),
        };
        Ok(Knowledge { basis: self, pair })
    }

    /// The bound of some errors: on whatever teeth their extents allow, the exact mesh stays inside it.
    #[must_use]
    pub fn bound(&self, errors: &[ExtendedError]) -> Bound {
        if let ([], Some(teeth)) = (errors, self.known_teeth) {
            return Bound::of_known(teeth);
        }
        let bound = match self.knowledge(errors) {
            Ok(knowledge) => bound(errors, &knowledge),
            Err(open) => Bound::open(errors.len(), open),
        };
        // the effect of an error alone does not depend on the size of the others
        Bound { errors: errors.iter().map(|error| self.alone(error)).collect(), ..bound }
    }

    /// The bound of a part's errors.
    #[must_use]
    pub fn bound_of(&self, errors: &[PartDeviation]) -> Bound {
        let extended: Result<Vec<_>, _> = errors.iter().map(ExtendedError::of).collect();
        match extended {
            Ok(extended) => self.bound(&extended),
            Err(open) => Bound::open(errors.len(), open),
        }
    }

    /// What one error can do alone, the pair's own curve not counted.
    ///
    /// # Errors
    /// [`NoBound`] if there is no bound.
    pub fn alone(&self, error: &ExtendedError) -> Result<ErrorRange, NoBound> {
        range_of(error, &self.knowledge(std::slice::from_ref(error))?)
    }

    /// The sums of the bound, without each error's own range.
    #[must_use]
    pub fn together(&self, errors: &[ExtendedError]) -> Combined<Range> {
        match self.knowledge(errors) {
            Ok(knowledge) => together(errors, &knowledge),
            Err(open) => Combined { range: Err(open), rss: Err(open) },
        }
    }
}
