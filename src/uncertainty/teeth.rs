//! For teeth that are known one by one: the derivatives of both extremes of their curve by uncertain values, as differences of
//! the exact mesh.

use std::ops::Range as Strokes;

use super::Influence;
use crate::judge::bound::Range;
use crate::judge::strokes::{CurveExtreme, Extremes, extremes};
use crate::mesh::{Mesh, MeshError};

/// The derivatives of both extremes of the curve of known teeth by x, mm per mm or per degree. If x stands for many values that
/// were measured one by one, each is the root of the sum of their squares. If other strokes may have the extreme, it is the
/// largest for these strokes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TeethSensitivity {
    /// The uncertain value x.
    pub source: Influence,
    /// The derivatives of the lowest and of the highest ΔCD.
    pub slope: Range,
    /// The numbers of other strokes that may have the lowest and the highest ΔCD, whatever x.
    pub rivals: [u32; 2],
}

/// A value, and meshes in which it is off.
#[derive(Debug, Clone)]
pub struct VariedTeeth {
    /// The value.
    pub source: Influence,
    /// Its standard uncertainty, mm or degrees.
    pub standard: f64,
    /// The deviation of the value, mm or degrees, and the mesh with it. Of several meshes, that in which an extreme changes most
    /// counts.
    pub off: Vec<(f64, Mesh)>,
}

/// Distance in pitches from an extreme's nominal stroke within which it is searched in a varied mesh.
const AROUND: f64 = 0.1;

/// The derivatives of a curve's extremes over some strokes by each source: the change of the extremes, mm, over the deviation of
/// a value, mm or degrees. Changes up to twice `tolerance_mm`, the tolerance of the curves, count as 0.
///
/// # Errors
/// [`MeshError`] if a stroke has no solution.
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
    /// The change of ΔCD there for a standard uncertainty of each value, mm.
    changes_mm: Vec<f64>,
}

/// Another stroke may have the extreme if ΔCD there is within this many standard uncertainties of it; the probability beyond is
/// 3 in 100,000.
const OVERTAKES: f64 = 4.0;

/// The strokes that may have the lowest and the highest ΔCD if the true values differ from the measured ones, the extreme itself
/// first. A tooth just below the highest one has its own uncertainty, and may in truth be the highest.
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
    /// Whether this stroke may have the extreme in place of another one; not where both change alike.
    fn overtakes(&self, above: &Self, sign: f64) -> bool {
        let by_value = self.changes_mm.iter().zip(&above.changes_mm);
        let u_mm = by_value.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        sign * (above.delta_cd_mm - self.delta_cd_mm) < OVERTAKES * u_mm
    }
}

/// The tolerance of the search for peaks over that for extremes.
const OF_PEAKS: f64 = 100.0;

/// Strokes in pieces of a pitch. No piece is reversed, although the start of the last one is rounded.
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

/// The rack teeth that can carry in a range of strokes.
fn carrying(mesh: &Mesh, range: &Strokes<f64>) -> impl Iterator<Item = i64> + use<> {
    let pitch = mesh.pair().rack().pitch_mm;
    let contact = (mesh.pair().contact_ratio().total + 2.0).ceil().max(3.0);
    (range.start / pitch - contact).floor() as i64..=(range.end / pitch + contact).ceil() as i64
}

/// The change of ΔCD at a stroke for a standard uncertainty of each value, mm.
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
