//! The derivatives of the curve of teeth that are known one by one by uncertain values: at both extremes, by differences of the
//! exact mesh.

use std::ops::Range as Strokes;

use super::Influence;
use crate::judge::bound::Range;
use crate::judge::strokes::{CurveExtreme, Extremes, extremes};
use crate::mesh::{Mesh, MeshError};

/// ∂(both extremes)/∂x of the curve of known teeth, mm per mm or per degree. If x stands for many values that were measured one
/// by one, it is the root of the sum of their squares; where other strokes rival an extreme, the largest of all of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TeethSensitivity {
    /// x
    pub source: Influence,
    /// The derivatives of the lowest and of the highest ΔCD.
    pub slope: Range,
    /// The number of other strokes that may hold the lowest and the highest ΔCD, whatever x.
    pub rivals: [u32; 2],
}

/// Meshes in which one value is off.
#[derive(Debug, Clone)]
pub struct VariedTeeth {
    /// What the value is.
    pub source: Influence,
    /// Its standard uncertainty, mm or degrees.
    pub standard: f64,
    /// By how much the value is off, mm or degrees, and the mesh. Of several, the one in which an extreme changes most counts.
    pub off: Vec<(f64, Mesh)>,
}

/// An extreme is searched within so many pitches of its place without the variation.
const AROUND: f64 = 0.1;

/// The derivatives of a curve's extremes over some strokes by each source: the change of the extremes if a value is off. Curves
/// have a tolerance in mm; differences up to twice that count as 0.
///
/// # Errors
/// [`MeshError`] of a stroke that has no solution.
pub fn teeth_sensitivities(
    mesh: &Mesh,
    at: &Extremes,
    strokes: &[Strokes<f64>],
    tolerance_mm: f64,
    varied: &[VariedTeeth],
) -> Result<Vec<TeethSensitivity>, MeshError> {
    if varied.is_empty() {
        return Ok(Vec::new());
    }
    let around = AROUND * mesh.pair().rack().pitch_mm;
    let windows = [at.lower, at.upper].map(|extreme| extreme.stroke_mm - around..extreme.stroke_mm + around);
    let ends = |mesh: &Mesh| -> Result<Range, MeshError> {
        let [lower, upper] = &windows;
        let lower = extremes(mesh, std::slice::from_ref(lower), tolerance_mm)?.lower.delta_cd_mm;
        let upper = extremes(mesh, std::slice::from_ref(upper), tolerance_mm)?.upper.delta_cd_mm;
        Ok(Range { lower, upper })
    };
    let centre = ends(mesh)?;
    let rivals = Rivals::find(mesh, at, strokes, tolerance_mm, varied)?;
    let mut found: Vec<TeethSensitivity> = Vec::new();
    for VariedTeeth { source, off, .. } in varied {
        let mut slope = Range::default();
        for (by, mesh) in off {
            let of_one = ends(mesh)?.with(centre, |off, centre| {
                let difference = off - centre;
                if difference.abs() > 2.0 * tolerance_mm { difference / by } else { 0.0 }
            });
            slope = slope.with(of_one, steeper);
        }
        match found.iter_mut().find(|known| known.source == *source) {
            Some(known) => known.slope = known.slope.with(slope, |a, b| (a * a + b * b).sqrt()),
            None => found.push(TeethSensitivity { source: *source, slope, rivals: rivals.counts() }),
        }
    }
    for known in &mut found {
        known.slope = known.slope.with(rivals.slope(known.source, varied), steeper);
    }
    Ok(found)
}

fn steeper(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}

/// A stroke at which a curve is lowest or highest nearby.
struct Peak {
    delta_cd_mm: f64,
    /// By how much ΔCD changes there with a standard uncertainty of each value, mm.
    changes_mm: Vec<f64>,
}

/// Another stroke holds the extreme if its values change against those of the extreme by so many standard uncertainties: 3
/// in 100,000.
const OVERTAKES: f64 = 4.0;

/// The strokes that may hold the lowest and the highest ΔCD if the true values differ from the measured ones, the extreme itself
/// first. A tooth just below the highest one, with its own uncertainty, may as well hold the highest ΔCD.
struct Rivals([Vec<Peak>; 2]);

impl Rivals {
    fn find(
        mesh: &Mesh,
        at: &Extremes,
        strokes: &[Strokes<f64>],
        tolerance_mm: f64,
        varied: &[VariedTeeth],
    ) -> Result<Self, MeshError> {
        let mut rivals = Self([Vec::new(), Vec::new()]);
        let all_alike = varied.iter().flat_map(|value| &value.off).all(|(_, off)| is_alike(off, strokes));
        if all_alike && is_alike(mesh, strokes) {
            return Ok(rivals);
        }
        let mut peaks = [vec![at.lower], vec![at.upper]];
        let pitch = mesh.pair().rack().pitch_mm;
        for piece in strokes.iter().flat_map(|range| pieces(range, pitch)) {
            let here = extremes(mesh, &[piece], OF_PEAKS * tolerance_mm)?;
            peaks[0].push(here.lower);
            peaks[1].push(here.upper);
        }
        for (kept, (peaks, sign)) in rivals.0.iter_mut().zip(peaks.iter_mut().zip([-1.0, 1.0])) {
            peaks[1..].sort_by(|a, b| (sign * b.delta_cd_mm).total_cmp(&(sign * a.delta_cd_mm)));
            for peak in peaks {
                let CurveExtreme { stroke_mm, delta_cd_mm } = *peak;
                let changes_mm = changes_mm(mesh, stroke_mm, varied)?;
                let peak = Peak { delta_cd_mm, changes_mm };
                if kept.iter().all(|above| peak.overtakes(above, sign)) {
                    kept.push(peak);
                }
            }
        }
        Ok(rivals)
    }

    fn counts(&self) -> [u32; 2] {
        [0, 1].map(|end| self.0[end].len().saturating_sub(1) as u32)
    }

    /// The largest slope of the rivals' ΔCD by one source.
    fn slope(&self, source: Influence, varied: &[VariedTeeth]) -> Range {
        let of_peak = |peak: &Peak| {
            let of_source = varied.iter().zip(&peak.changes_mm).filter(|(value, _)| value.source == source);
            of_source.map(|(value, change)| (change / value.standard) * (change / value.standard)).sum::<f64>().sqrt()
        };
        let [lower, upper] = [0, 1].map(|end| self.0[end].iter().skip(1).map(of_peak).fold(0.0, f64::max));
        Range { lower, upper }
    }
}

impl Peak {
    /// Whether this stroke may hold the extreme in place of another one; not where both change alike.
    fn overtakes(&self, above: &Self, sign: f64) -> bool {
        let by_value = self.changes_mm.iter().zip(&above.changes_mm);
        let u_mm = by_value.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        sign * (above.delta_cd_mm - self.delta_cd_mm) < OVERTAKES * u_mm
    }
}

/// Peaks are searched with a tolerance so many times that of extremes.
const OF_PEAKS: f64 = 100.0;

/// Strokes in pieces of a pitch; where the last one begins is rounded, and may lie behind the end otherwise.
fn pieces(range: &Strokes<f64>, pitch: f64) -> impl Iterator<Item = Strokes<f64>> {
    let (start, end) = (range.start, range.end);
    let count = ((end - start) / pitch).ceil().max(1.0) as u64;
    let at = move |index| if index < count { (start + index as f64 * pitch).min(end) } else { end };
    (0..count).map(move |index| at(index)..at(index + 1))
}

/// Whether all teeth of each part that can carry at these strokes deviate alike.
fn is_alike(mesh: &Mesh, strokes: &[Strokes<f64>]) -> bool {
    let teeth = mesh.pinion().teeth();
    let mut of_rack = strokes.iter().flat_map(|range| carrying(mesh, range)).map(|tooth| mesh.rack().tooth(tooth));
    let first = of_rack.next();
    of_rack.all(|tooth| Some(tooth) == first) && teeth.iter().all(|tooth| *tooth == teeth[0])
}

/// The rack's teeth that can carry at some strokes.
fn carrying(mesh: &Mesh, range: &Strokes<f64>) -> impl Iterator<Item = i64> + use<> {
    let pitch = mesh.pair().rack().pitch_mm;
    let contact = (mesh.pair().contact_ratio().total + 2.0).ceil().max(3.0);
    (range.start / pitch - contact).floor() as i64..=(range.end / pitch + contact).ceil() as i64
}

/// By how much ΔCD at a stroke changes with a standard uncertainty of each value, mm.
fn changes_mm(mesh: &Mesh, stroke_mm: f64, varied: &[VariedTeeth]) -> Result<Vec<f64>, MeshError> {
    let centre = mesh.at(stroke_mm)?.delta_cd_mm;
    let change = |value: &VariedTeeth| {
        let mut slope = 0.0;
        for (by, off) in &value.off {
            let same_pair = off.pair() == mesh.pair() && off.pinion() == mesh.pinion();
            let mut teeth = carrying(mesh, &(stroke_mm..stroke_mm));
            if !(same_pair && teeth.all(|tooth| off.rack().tooth(tooth) == mesh.rack().tooth(tooth))) {
                slope = steeper(slope, (off.at(stroke_mm)?.delta_cd_mm - centre) / by);
            }
        }
        Ok(slope * value.standard)
    };
    varied.iter().map(change).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_cover_strokes_and_none_is_reversed() {
        let pitch = std::f64::consts::PI * 1.5 / crate::trig::cos(10.0 * std::f64::consts::PI / 180.0);
        for contact in 1..60 {
            let range = (1.0 - f64::from(contact)) * pitch..(5.0 + f64::from(contact)) * pitch;
            let pieces: Vec<_> = pieces(&range, pitch).collect();
            assert!(pieces.iter().all(|piece| piece.start <= piece.end), "{contact}");
            assert_eq!((pieces[0].start, pieces.last().unwrap().end), (range.start, range.end));
            assert!(pieces.windows(2).all(|two| two[0].end == two[1].start), "{contact}");
        }
    }
}
