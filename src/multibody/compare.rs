//! The exact rigid mesh beside a simulation: what the compliant model should tend to. Called by the reports and the
//! tests; solves nothing of its own.

use super::Steady;
use crate::mesh::Mesh;

/// The mean ΔCD of the exact mesh over the strokes of a steady value, mm; `None` where the mesh has no solution.
///
/// By the midpoint rule over equal steps of at most 0.02 mm, which is right to a few nanometres where the curve jumps.
#[must_use]
pub fn exact_mean_mm(mesh: &Mesh, steady: &Steady) -> Option<f64> {
    const STEP_MM: f64 = 0.02;
    const MOST: f64 = 1e6;
    let length = steady.to_mm - steady.from_mm;
    let count = (length / STEP_MM).ceil().clamp(1.0, MOST);
    // whole and at most a million
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let strokes: Vec<f64> =
        (0..count as u32).map(|index| steady.from_mm + length * (f64::from(index) + 0.5) / count).collect();
    let points = mesh.sample(&strokes);
    let sum = points.into_iter().try_fold(0.0, |sum, point| Some(sum + point.ok()?.delta_cd_mm))?;
    Some(sum / count)
}
