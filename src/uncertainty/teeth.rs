//! How the curve of teeth that are known one by one follows from uncertain values: at both of its extremes, by differences
//! of the exact mesh.

use super::Influence;
use crate::judge::bound::Range;
use crate::judge::strokes::{Extremes, extremes};
use crate::mesh::{Mesh, MeshError};

/// ∂(both extremes)/∂x of what known teeth do, mm per mm or per degree. Where x stands for many values that were measured
/// one by one, the root of the sum of their squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TeethSensitivity {
    /// x
    pub source: Influence,
    /// Of the lowest and of the highest ΔCD.
    pub slope: Range,
}

/// Meshes in which one value is off.
#[derive(Debug, Clone)]
pub struct VariedTeeth {
    /// What the value is.
    pub source: Influence,
    /// By how much it is off, mm or degrees, and the mesh: of several the one counts in which an extreme changes most.
    pub off: Vec<(f64, Mesh)>,
}

/// An extreme is looked for so many pitches around where it is without the variation.
const AROUND: f64 = 0.1;

/// The derivatives of a curve's extremes by each source: what its extremes become if a value is off, less
/// what they are. Curves are followed to a tolerance in mm, and differences up to twice that are none.
///
/// # Errors
/// [`MeshError`] of a stroke that has no solution.
pub fn teeth_sensitivities(
    mesh: &Mesh,
    at: &Extremes,
    tolerance_mm: f64,
    varied: &[VariedTeeth],
) -> Result<Vec<TeethSensitivity>, MeshError> {
    let around = AROUND * mesh.pair().rack().pitch_mm;
    let windows = [at.lower, at.upper].map(|extreme| extreme.stroke_mm - around..extreme.stroke_mm + around);
    let ends = |mesh: &Mesh| -> Result<Range, MeshError> {
        let [lower, upper] = &windows;
        let lower = extremes(mesh, std::slice::from_ref(lower), tolerance_mm)?.lower.delta_cd_mm;
        let upper = extremes(mesh, std::slice::from_ref(upper), tolerance_mm)?.upper.delta_cd_mm;
        Ok(Range { lower, upper })
    };
    let centre = ends(mesh)?;
    let mut found: Vec<TeethSensitivity> = Vec::new();
    for VariedTeeth { source, off } in varied {
        let mut slope = Range::default();
        for (by, mesh) in off {
            let of_one = ends(mesh)?.with(centre, |off, centre| {
                let difference = off - centre;
                if difference.abs() > 2.0 * tolerance_mm { difference / by } else { 0.0 }
            });
            slope = slope.with(of_one, |a, b| if b.abs() > a.abs() { b } else { a });
        }
        match found.iter_mut().find(|known| known.source == *source) {
            Some(known) => known.slope = known.slope.with(slope, |a, b| (a * a + b * b).sqrt()),
            None => found.push(TeethSensitivity { source: *source, slope }),
        }
    }
    Ok(found)
}
