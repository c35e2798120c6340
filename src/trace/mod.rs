#![doc = include_str!("trace.md")]
//!
//! The command line reads the table and calls this room with a mesh and points.

mod curves;
mod diagnosis;
mod search;
mod sight;
mod smallest;
mod spectrum;
mod starts;
mod tooth_error;

pub use diagnosis::{Alternative, Diagnosis, FoundError, Unseen};
pub use search::{DiagnosisRequest, UNSEEN_MM, Watch};
pub use spectrum::{Order, Spectrum};
pub use tooth_error::{ToothError, ToothErrorKind};

use crate::linear::least_squares;
use crate::mesh::{Mesh, MeshError, Support, largest_swing};
use crate::trig;

/// A point of a measured curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TracePoint {
    /// The stroke, mm.
    pub stroke_mm: f64,
    /// ΔCD there, mm.
    pub delta_cd_mm: f64,
}

/// A fitted length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitted {
    /// The length, mm.
    pub value_mm: f64,
    /// Its standard uncertainty, mm, if the residuals of the fit are independent noise.
    pub uncertainty_mm: f64,
}

/// Offset and shift that place the computed curve on the measured one: measured(s) ≈ computed(s − shift) + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Added to ΔCD.
    pub offset: Fitted,
    /// Measured less computed stroke of one and the same place; `None` where the computed curve does not determine it: then it is 0.
    pub shift: Option<Fitted>,
    /// Whether the shift lies at an end of its range, ± half a pitch.
    pub at_an_end: bool,
}

impl Placement {
    /// The measured less the computed stroke, mm.
    #[must_use]
    pub fn shift_mm(&self) -> f64 {
        self.shift.map_or(0.0, |shift| shift.value_mm)
    }
}

/// The variation of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variation {
    /// Largest less smallest ΔCD, mm: with a master for the pinion, F_i″ of the rack.
    pub peak_to_peak_mm: f64,
    /// Largest less smallest ΔCD within a pitch, at its largest, mm: with a master for the pinion, f_i″ of the rack.
    pub tooth_to_tooth_mm: f64,
}

/// A measured curve on the computed one.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay {
    /// The measured points.
    pub points: Vec<TracePoint>,
    /// The computed curve, placed, at the measured points, mm.
    pub computed_mm: Vec<f64>,
    /// How the computed curve is placed; `None` if it is taken as it is.
    pub placement: Option<Placement>,
    /// Root of the mean square of measured less computed, mm.
    pub rms_mm: f64,
    /// The measured point that is farthest from the computed curve.
    pub farthest: TracePoint,
    /// Measured less computed there, mm.
    pub largest_mm: f64,
    /// The variations of the measured and of the computed curve, at the same strokes.
    pub variations: [Variation; 2],
    /// The orders of both curves; `None` where the points are too few, or cover no pitch.
    pub spectrum: Option<Spectrum>,
}

/// Why a measured curve cannot be laid on a computed one.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// There are too few points.
    #[error("a measured curve needs at least three points, not all at one stroke")]
    TooFewPoints,
    /// The errors found are too large for teeth.
    #[error("the errors that explain the curve are too large for teeth")]
    NoSuchErrors,
    /// The search was stopped.
    #[error("the search for errors of teeth was interrupted")]
    Interrupted,
    /// The mesh has no solution.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Chords of the computed curve, for a search; they deviate from it by no more than its tolerance.
pub(crate) struct Chords(Vec<(f64, f64)>);

impl Chords {
    /// The chords over a range of strokes, mm.
    pub(crate) fn of(mesh: &Mesh, from_mm: f64, to_mm: f64) -> Result<Self, MeshError> {
        let tolerance_mm = if mesh.support() == Support::Fixed { 1e-6 } else { 1e-5 };
        let curve = mesh.curve(from_mm, to_mm, tolerance_mm)?;
        Ok(Self(curve.points.iter().map(|point| (point.stroke_mm, point.delta_cd_mm)).collect()))
    }

    /// ΔCD, mm, and its slope at a stroke.
    pub(crate) fn at(&self, stroke_mm: f64) -> (f64, f64) {
        let behind = self.0.partition_point(|(stroke, _)| *stroke < stroke_mm).clamp(1, self.0.len().max(2) - 1);
        let (Some(a), Some(b)) = (self.0.get(behind - 1), self.0.get(behind)) else {
            return (self.0.first().map_or(0.0, |only| only.1), 0.0);
        };
        let slope = if b.0 > a.0 { (b.1 - a.1) / (b.0 - a.0) } else { 0.0 };
        (a.1 + slope * (stroke_mm - a.0), slope)
    }
}

/// ΔCD of the exact mesh at rising strokes, mm.
pub(crate) fn sampled(mesh: &Mesh, strokes_mm: &[f64]) -> Result<Vec<f64>, MeshError> {
    mesh.sample(strokes_mm).into_iter().map(|point| point.map(|point| point.delta_cd_mm)).collect()
}

impl Overlay {
    /// Lays measured points, whose strokes rise, on the curve of a mesh. With `fits`, offset and stroke shift are fitted by
    /// least squares, the shift within ± half a pitch.
    ///
    /// # Errors
    /// [`TraceError`] if there are fewer than three points, or a stroke has no mesh.
    pub fn of(mesh: &Mesh, points: &[TracePoint], fits: bool) -> Result<Self, TraceError> {
        let (Some(first), Some(last)) = (points.first(), points.last()) else { return Err(TraceError::TooFewPoints) };
        if points.len() < 3 || first.stroke_mm >= last.stroke_mm {
            return Err(TraceError::TooFewPoints);
        }
        let placement = if fits { Some(placement(mesh, points)?) } else { None };
        let shift_mm = placement.as_ref().map_or(0.0, Placement::shift_mm);
        let offset_mm = placement.as_ref().map_or(0.0, |placement| placement.offset.value_mm);
        let strokes: Vec<f64> = points.iter().map(|point| point.stroke_mm - shift_mm).collect();
        let computed_mm: Vec<f64> = sampled(mesh, &strokes)?.into_iter().map(|mm| mm + offset_mm).collect();
        let differences = points.iter().zip(&computed_mm).map(|(point, computed)| point.delta_cd_mm - computed);
        let rms_mm = (differences.clone().map(|mm| mm * mm).sum::<f64>() / points.len() as f64).sqrt();
        let farther = |a: &(&TracePoint, f64), b: &(&TracePoint, f64)| a.1.abs().total_cmp(&b.1.abs());
        let (farthest, largest_mm) = points.iter().zip(differences).max_by(farther).unwrap_or((first, 0.0));
        let pitch_mm = mesh.pair().rack().pitch_mm;
        let measured_mm: Vec<f64> = points.iter().map(|point| point.delta_cd_mm).collect();
        let variations = [&measured_mm, &computed_mm].map(|curve| variation(&strokes, curve, pitch_mm));
        let spectrum = Spectrum::of(&strokes, [&measured_mm, &computed_mm], pitch_mm, mesh.pair().pinion().teeth);
        let (points, farthest) = (points.to_vec(), *farthest);
        Ok(Self { points, computed_mm, placement, rms_mm, farthest, largest_mm, variations, spectrum })
    }

    /// The amplitude of a sine over a turn of the pinion in measured less computed, and the root of the mean square that it leaves,
    /// mm: an eccentricity e of the pinion moves ΔCD by ± e. `None` where the points cover less than a turn.
    fn once_a_turn(&self, turn_mm: f64) -> Option<[f64; 2]> {
        let (first, last) = (self.points.first()?.stroke_mm, self.points.last()?.stroke_mm);
        if last - first < turn_mm {
            return None;
        }
        let angles = self.points.iter().map(|point| std::f64::consts::TAU * point.stroke_mm / turn_mm);
        let (sines, cosines): (Vec<_>, Vec<_>) = angles.map(trig::sin_cos).unzip();
        let ones = vec![1.0; sines.len()];
        let constant = self.placement.iter().map(|_| ones.as_slice());
        let columns: Vec<&[f64]> = [&sines[..], &cosines].into_iter().chain(constant).collect();
        let fit = least_squares(&columns, &ones, &self.differences_mm().collect::<Vec<_>>())?;
        let (sine, cosine) = (fit.coefficients[0], fit.coefficients[1]);
        Some([(sine * sine + cosine * cosine).sqrt(), (fit.rest / ones.len() as f64).sqrt()])
    }

    /// Measured less computed at each point, mm.
    pub fn differences_mm(&self) -> impl Iterator<Item = f64> + '_ {
        self.points.iter().zip(&self.computed_mm).map(|(point, computed)| point.delta_cd_mm - computed)
    }
}

fn variation(strokes: &[f64], curve: &[f64], pitch_mm: f64) -> Variation {
    let (low, high) =
        curve.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), mm| (low.min(*mm), high.max(*mm)));
    let tooth_to_tooth_mm = largest_swing(strokes.iter().copied().zip(curve.iter().copied()), pitch_mm);
    Variation { peak_to_peak_mm: high - low, tooth_to_tooth_mm }
}

/// The offset and the stroke shift by least squares.
fn placement(mesh: &Mesh, points: &[TracePoint]) -> Result<Placement, MeshError> {
    /// The number of shifts tried in half a pitch; the best is refined.
    const TRIED: i32 = 32;
    /// A shift whose uncertainty is above this share of a pitch is not determined.
    const TOLD: f64 = 0.1;
    let pitch_mm = mesh.pair().rack().pitch_mm;
    let half = 0.5 * pitch_mm;
    let ends = [points.first(), points.last()].map(|end| end.map_or(0.0, |end| end.stroke_mm));
    let chords = Chords::of(mesh, ends[0] - half, ends[1] + half)?;
    let mean = |of: &dyn Fn(&TracePoint) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let rest = |shift_mm: f64| {
        let off = |point: &TracePoint| point.delta_cd_mm - chords.at(point.stroke_mm - shift_mm).0;
        let offset = mean(&off);
        mean(&|point| (off(point) - offset) * (off(point) - offset))
    };
    let step = half / f64::from(TRIED);
    let tried = (-TRIED..=TRIED).map(|index| f64::from(index) * step);
    // of shifts that fit equally well, the smallest
    let better = |a: &(f64, f64), b: &(f64, f64)| a.1.total_cmp(&b.1).then(a.0.abs().total_cmp(&b.0.abs()));
    let best = tried.map(|shift| (shift, rest(shift))).min_by(better).map_or(0.0, |(shift, _)| shift);
    let shift_mm = lowest(&rest, (best - step).max(-half), (best + step).min(half));
    let slopes: Vec<f64> = points.iter().map(|point| chords.at(point.stroke_mm - shift_mm).1).collect();
    let ones = vec![1.0; points.len()];
    let freedom = points.len().saturating_sub(2).max(1) as f64;
    let sigma_mm = |rest: f64| (rest * points.len() as f64 / freedom).sqrt();
    let told = least_squares(&[&ones, &slopes], &ones, &ones)
        .map(|fit| fit.inverse)
        .filter(|inverse| sigma_mm(rest(shift_mm)) * inverse[1][1].sqrt() < TOLD * pitch_mm);
    let placed = |shift_mm: f64, shift: Option<Fitted>, of_offset: f64| {
        let offset_mm = mean(&|point| point.delta_cd_mm - chords.at(point.stroke_mm - shift_mm).0);
        let offset = Fitted { value_mm: offset_mm, uncertainty_mm: sigma_mm(rest(shift_mm)) * of_offset.sqrt() };
        Placement { offset, shift, at_an_end: shift_mm.abs() > half - 0.01 * step }
    };
    Ok(match told {
        Some(inverse) => {
            let uncertainty_mm = sigma_mm(rest(shift_mm)) * inverse[1][1].sqrt();
            placed(shift_mm, Some(Fitted { value_mm: shift_mm, uncertainty_mm }), inverse[0][0])
        }
        None => placed(0.0, None, 1.0 / points.len() as f64),
    })
}

/// The place of the minimum of a function that falls and then rises, by the golden section.
pub(crate) fn lowest(of: &dyn Fn(f64) -> f64, mut from: f64, mut to: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let at = |from: f64, to: f64| [to - GOLDEN * (to - from), from + GOLDEN * (to - from)];
    let mut inner = at(from, to);
    let mut values = inner.map(of);
    for _ in 0..40 {
        if values[0] <= values[1] {
            to = inner[1];
            inner = [at(from, to)[0], inner[0]];
            values = [of(inner[0]), values[0]];
        } else {
            from = inner[0];
            inner = [inner[1], at(from, to)[1]];
            values = [values[1], of(inner[1])];
        }
    }
    0.5 * (from + to)
}
