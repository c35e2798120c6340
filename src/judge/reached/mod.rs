//! How far errors whose teeth are not known can really push ΔCD: the worst placements found, each in the exact mesh.
//!
//! This shows how much of a [bound](super::bound) is used. A placement beyond a limit proves that parts with these errors may
//! fail; a placement inside proves nothing.
//!
//! One mesh in which a single tooth stands out says what flanks ask for along their path of contact. From it the search
//! estimates each placement: for an upper end every error is put where it raises two flanks that carry together, for a lower
//! end where all flanks that carry sink. The few most promising placements are solved exactly, and only these count.
//!
//! Assumes a rack that does not roll. It must not know files, limits or reports.

pub(in crate::judge) mod placed;
mod search;
mod seat;
mod sketch;
#[cfg(test)]
mod tests;

pub use placed::{ReachedError, TEETH};
pub use seat::Run;

use super::bound::{ExtendedError, GivenPair};
use super::strokes::CurveExtreme;
use crate::deviation::{PinionFlanks, RackFlanks};
use crate::mesh::{MeshPoint, Support};
use placed::Placed;
use search::{Candidate, RangeEnd, Search};
use sketch::{Sketch, stroke};

/// How far some errors push ΔCD when they sit at the worst places found.
#[derive(Debug, Clone, PartialEq)]
pub struct Reached {
    /// The lowest ΔCD found, mm.
    pub lower_mm: f64,
    /// The highest ΔCD found, mm.
    pub upper_mm: f64,
    /// Exact meshes solved to find them.
    pub meshes: u32,
    /// The errors' places for the lowest ΔCD.
    pub lower: Placement,
    /// The errors' places for the highest ΔCD.
    pub upper: Placement,
}

/// Errors on teeth of both parts, for strokes within a few pitches of the named one.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// The stroke of the extreme, mm.
    pub stroke_mm: f64,
    /// The rack's flanks.
    pub rack: RackFlanks,
    /// The pinion's flanks.
    pub pinion: PinionFlanks,
    /// Where each error is, in the order given. An error without a run is on no tooth.
    pub errors: Vec<Vec<Run>>,
}

/// Placements that are solved for each end, at most.
const PLACEMENTS: usize = 8;
/// Range of strokes solved on either side of the expected one, pitches, and the tolerance of ΔCD, mm.
const NEAR: f64 = 0.1;
const TOLERANCE_MM: f64 = 1e-5;
/// Range and tolerance for the best placement.
const WIDE: f64 = 0.5;
const FINE_MM: f64 = 1e-7;

/// How far these errors push ΔCD of a pair, each on the worst teeth that its extent allows; `None` if the rack may roll.
/// Solves up to 19 meshes over parts of a pitch.
///
/// # Errors
/// [`ReachedError`] if the errors leave no mesh.
pub fn reached(errors: &[ExtendedError], given: &GivenPair) -> Result<Option<Reached>, ReachedError> {
    if given.support != Support::Fixed {
        return Ok(None);
    }
    let sketch = Sketch::new(given, errors)?;
    let search = Search::new(given, errors, &sketch);
    let mut solver = Solver { given, errors, search: &search, meshes: 1 };
    let (lower_mm, lower) = solver.end(RangeEnd::Lower)?;
    let (upper_mm, upper) = solver.end(RangeEnd::Upper)?;
    Ok(Some(Reached { lower_mm, upper_mm, meshes: solver.meshes, lower, upper }))
}

/// Solves candidates, and counts how many.
struct Solver<'a> {
    given: &'a GivenPair,
    errors: &'a [ExtendedError],
    search: &'a Search<'a>,
    meshes: u32,
}

impl Solver<'_> {
    /// One end and its placement. The candidates are solved in the order of their estimates, until no other is expected to be
    /// better.
    fn end(&mut self, which: RangeEnd) -> Result<(f64, Placement), ReachedError> {
        let sign = which.sign();
        let mut best: Option<(Candidate, CurveExtreme)> = None;
        let mut failure = ReachedError::Unsolved { stroke_mm: 0.0 };
        for candidate in self.search.candidates(which, PLACEMENTS) {
            let is_better =
                |value: f64| best.as_ref().is_none_or(|(_, found)| sign * (value - found.delta_cd_mm) > 0.0);
            if !is_better(candidate.expected_mm - sign * TOLERANCE_MM) {
                break;
            }
            match self.solve(&candidate, which, NEAR, TOLERANCE_MM) {
                Ok(found) if is_better(found.delta_cd_mm) => best = Some((candidate, found)),
                Ok(_) => {}
                Err(error) => failure = error,
            }
        }
        let Some((candidate, near)) = best else { return Err(failure) };
        let wide = self.solve(&candidate, which, WIDE, FINE_MM).unwrap_or(near);
        let found = if sign * (wide.delta_cd_mm - near.delta_cd_mm) > 0.0 { wide } else { near };
        let (rack, pinion) = self.placed(&candidate).flanks(self.given)?;
        let errors = self.search.runs(&candidate);
        Ok((found.delta_cd_mm, Placement { stroke_mm: found.stroke_mm, rack, pinion, errors }))
    }

    fn placed(&self, candidate: &Candidate) -> Placed {
        let mut placed = Placed::new(&self.given.pair);
        for (error, runs) in self.errors.iter().zip(self.search.runs(candidate)) {
            seat::put(&mut placed, error, &runs);
        }
        placed
    }

    /// The extreme within so many pitches of the expected stroke.
    fn solve(
        &mut self,
        candidate: &Candidate,
        which: RangeEnd,
        pitches: f64,
        tolerance_mm: f64,
    ) -> Result<CurveExtreme, ReachedError> {
        self.meshes += 1;
        let mesh = self.placed(candidate).mesh(self.given)?;
        let (pitch, stroke, sign) = (mesh.pair().rack().pitch_mm, stroke(candidate.stroke), which.sign());
        let curve = mesh.curve(pitch * (stroke - pitches), pitch * (stroke + pitches), tolerance_mm)?;
        let of = |point: &MeshPoint| CurveExtreme { stroke_mm: point.stroke_mm, delta_cd_mm: point.delta_cd_mm };
        let extremes = curve.points.iter().filter(|point| point.is_solved()).map(of);
        let extreme = extremes.max_by(|a, b| (sign * a.delta_cd_mm).total_cmp(&(sign * b.delta_cd_mm)));
        extreme.ok_or(ReachedError::Unsolved { stroke_mm: pitch * stroke })
    }
}
