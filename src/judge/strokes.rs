//! The strokes at which deviated teeth can carry, and the extremes of the exact mesh over them. Used where the teeth of both
//! parts are known; knows no limits.

use std::collections::BTreeSet;
use std::ops::Range as Strokes;

use crate::deviation::RackDeviation;
use crate::judge::bound::{KnownTeeth, Range};
use crate::mesh::{CarryingStrokes, Mesh, MeshError, MeshPoint, Support};

/// Why there are no strokes to judge.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StrokesError {
    /// Flanks that were not measured can carry at every stroke.
    #[error("there is no stroke at which every flank that can carry was measured: measure more spaces in a row")]
    NotMeasured,
    /// A space of a measured rack was left out between others.
    #[error(
        "space {space} of the rack was not measured, or not everything of it, as line {line} tells: measure it, or give \
         each run of spaces by itself; a column that nobody measured is left out with --ignore"
    )]
    Gap {
        /// The first of them.
        space: i64,
        /// The line of its row, or that of the next space.
        line: u64,
    },
    /// A tooth of a measured pinion was left out.
    #[error(
        "tooth {tooth} of the pinion was not measured, or not everything of it: a turn needs all {teeth}; a column that nobody \
         measured is left out with --ignore"
    )]
    Tooth {
        /// The first of them.
        tooth: i64,
        /// How many teeth the pinion has.
        teeth: u32,
    },
    /// The pair has no contact.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// The strokes, mm, at which a deviated tooth or one beside it can carry: around every tooth where the rack's deviations change,
/// and over a turn of the pinion if its teeth deviate. For a measured rack, the strokes at which every flank that can carry was
/// measured. `spaces` are the measured ones, empty without a table.
///
/// # Errors
/// [`StrokesError`] if measured spaces cover no stroke.
pub fn judged_strokes(
    mesh: &Mesh,
    rack: &[RackDeviation],
    spaces: &BTreeSet<i64>,
    pinion_deviates: bool,
) -> Result<Vec<Strokes<f64>>, StrokesError> {
    let pair = mesh.pair();
    let pitch = pair.rack().pitch_mm;
    let ratio = pair.contact_ratio();
    // a flank carries along its path of contact, and on edges beyond it
    let contact = ratio.offset.abs() + 0.5 * ratio.total + BEYOND_CONTACT;
    if let (Some(first), Some(last)) = (spaces.first(), spaces.last()) {
        let carrying = CarryingStrokes::of(pair)?;
        let at = |tooth: i64| tooth as f64 * pitch;
        let stretches = carrying.measured(spaces, at(*first) - contact * pitch, at(*last + 1) + contact * pitch);
        // the spaces stand in one row, and so do their strokes
        return if stretches.len() == 1 { Ok(stretches) } else { Err(StrokesError::NotMeasured) };
    }
    let turn = if pinion_deviates { f64::from(pair.pinion().teeth) } else { 0.0 };
    let ends = rack.iter().flat_map(|deviation| [deviation.teeth.first(), deviation.teeth.last()]);
    let reach = pitch * (contact + turn);
    let around = |tooth: i64| {
        let (nominal, flanks) = (tooth as f64 * pitch, mesh.rack().tooth(tooth));
        let [left, right] = [flanks.left.along_x_mm, flanks.right.along_x_mm];
        nominal + left.min(right).min(0.0) - reach..nominal + left.max(right).max(0.0) + reach
    };
    let mut windows: Vec<_> = ends.flatten().map(around).collect();
    windows.push(0.0..pitch * turn.max(contact));
    windows.sort_by(|a, b| a.start.total_cmp(&b.start));
    Ok(joined(windows.into_iter()))
}

/// Pitches by which judged strokes reach beyond the path of contact of a deviated tooth: up to one on its edges, where it stands
/// out far, and one for the teeth beside it.
const BEYOND_CONTACT: f64 = 2.0;

/// A lowest or highest ΔCD.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveExtreme {
    /// Where it is, mm.
    pub stroke_mm: f64,
    /// ΔCD there, mm.
    pub delta_cd_mm: f64,
}

/// Both extremes of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    /// The lowest ΔCD.
    pub lower: CurveExtreme,
    /// The highest one.
    pub upper: CurveExtreme,
    /// Whether every stroke is solved; if not, ΔCD may be lower or higher.
    pub solved: bool,
}

impl Default for Extremes {
    /// The extremes of no curve.
    fn default() -> Self {
        let none = |delta_cd_mm| CurveExtreme { stroke_mm: 0.0, delta_cd_mm };
        Self { lower: none(f64::INFINITY), upper: none(f64::NEG_INFINITY), solved: true }
    }
}

impl Extremes {
    /// Counts a point of a curve.
    fn take(&mut self, point: &MeshPoint) -> CurveExtreme {
        let MeshPoint { stroke_mm, delta_cd_mm, .. } = *point;
        self.solved &= point.is_solved();
        let here = CurveExtreme { stroke_mm, delta_cd_mm };
        if delta_cd_mm < self.lower.delta_cd_mm {
            self.lower = here;
        }
        if delta_cd_mm > self.upper.delta_cd_mm {
            self.upper = here;
        }
        here
    }

    /// The range that limits judge, mm, with what the coarse curve of a rack that may roll may miss.
    #[must_use]
    pub fn judged(&self, mesh: &Mesh) -> KnownTeeth {
        let missed_mm = if mesh.support() == Support::Fixed { 0.0 } else { ROLLING_TOLERANCE_MM };
        let judged = |mm: f64| (mm * JUDGED_PARTS).round() / JUDGED_PARTS;
        let Range { lower, upper } = self.range();
        let range = Range { lower: judged(lower - missed_mm), upper: judged(upper + missed_mm) };
        KnownTeeth { range, solved: self.solved }
    }

    /// From one to the other.
    #[must_use]
    pub const fn range(&self) -> Range {
        Range { lower: self.lower.delta_cd_mm, upper: self.upper.delta_cd_mm }
    }
}

/// Tolerances of the curve of known teeth, and of the slower curve of a rack that may roll, and the resolution of the judged
/// values.
const TOLERANCE_MM: f64 = 1e-7;
const ROLLING_TOLERANCE_MM: f64 = 1e-5;
const JUDGED_PARTS: f64 = 1e9;

/// The tolerance of the curve of known teeth between points, mm.
#[must_use]
pub fn tolerance_mm(mesh: &Mesh) -> f64 {
    if mesh.support() == Support::Fixed { TOLERANCE_MM } else { ROLLING_TOLERANCE_MM }
}

/// A curve is computed first with a tolerance so many times as large, then again where its extremes can be.
const COARSER: f64 = 100.0;

/// The lowest and the highest ΔCD over strokes, to a tolerance in mm. Only pieces of a curve that may hold an extreme are
/// kept.
///
/// # Errors
/// [`MeshError`] of a stroke that has no solution.
pub fn extremes(mesh: &Mesh, strokes: &[Strokes<f64>], tolerance_mm: f64) -> Result<Extremes, MeshError> {
    // where the rack may roll, a stroke costs more than the points that are saved
    let coarse_mm = if mesh.support() == Support::Fixed { COARSER * tolerance_mm } else { tolerance_mm };
    let mut found = Extremes::default();
    // between two points the curve leaves the chord by no more than the tolerance
    let may_hold = |[a, b]: &[CurveExtreme; 2], Range { lower, upper }: Range| {
        let (a, b) = (a.delta_cd_mm, b.delta_cd_mm);
        a.max(b) > upper - coarse_mm || a.min(b) < lower + coarse_mm
    };
    let mut chords = Vec::with_capacity(strokes.len());
    for window in strokes {
        let (mut before, mut of_window) = (None, Vec::new());
        mesh.curve_pieces(window.start, window.end, coarse_mm, |piece| -> Result<(), MeshError> {
            for point in &piece.points {
                let here = found.take(point);
                let chord = before.replace(here).map(|before| [before, here]);
                of_window.extend(chord.filter(|chord| coarse_mm > tolerance_mm && may_hold(chord, found.range())));
            }
            Ok(())
        })?;
        chords.push(of_window);
    }
    let coarse = found.range();
    for of_window in chords {
        let pieces = of_window.iter().filter(|chord| may_hold(chord, coarse));
        for piece in joined(pieces.map(|[a, b]| a.stroke_mm..b.stroke_mm)) {
            for point in &mesh.curve(piece.start, piece.end, tolerance_mm)?.points {
                found.take(point);
            }
        }
    }
    Ok(found)
}

/// Pieces in rising order; pieces that touch become one.
fn joined(pieces: impl Iterator<Item = Strokes<f64>>) -> Vec<Strokes<f64>> {
    let mut joined: Vec<Strokes<f64>> = Vec::new();
    for piece in pieces {
        match joined.last_mut() {
            Some(last) if piece.start <= last.end => last.end = last.end.max(piece.end),
            _ => joined.push(piece),
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::{PinionFlanks, RackDeviationKind, RackFlanks, ToothRange};

    fn deviated(rack: &[RackDeviation]) -> Mesh {
        let pair = crate::reproduction::pair().unwrap();
        let flanks = RackFlanks::new(&pair, rack).unwrap();
        Mesh::new(pair, flanks, PinionFlanks::nominal(&pair), Support::Fixed).unwrap()
    }

    /// Pitch errors add up, and what they move is judged where it is.
    #[test]
    fn teeth_far_from_their_places_are_judged() {
        let run = |last| {
            let teeth = ToothRange::new(Some(1), Some(last)).unwrap();
            [RackDeviation { teeth, kind: RackDeviationKind::Pitch(0.05) }]
        };
        let rack = run(800);
        let mesh = deviated(&rack);
        let strokes = judged_strokes(&mesh, &rack, &BTreeSet::new(), false).unwrap();
        let last = strokes.last().unwrap();
        let place = (800.0 * mesh.pair().rack().pitch_mm) + 40.0;
        assert!(last.start < place - 12.0 && place + 12.0 < last.end, "{strokes:?} {place}");
    }

    /// A step far along the rack is found at its place.
    #[test]
    fn a_step_at_any_tooth_is_judged() {
        let reached = |tooth: i64| {
            let teeth = ToothRange::new(Some(tooth), None).unwrap();
            let rack = [RackDeviation { teeth, kind: RackDeviationKind::Shift(0.02) }];
            let mesh = deviated(&rack);
            let strokes = judged_strokes(&mesh, &rack, &BTreeSet::new(), false).unwrap();
            extremes(&mesh, &strokes, 1e-7).unwrap().range()
        };
        let near = reached(4);
        assert!(near.upper > 0.02);
        for tooth in [-7, 40, 1000] {
            let far = reached(tooth);
            assert!((far.upper - near.upper).abs() < 1e-6 && (far.lower - near.lower).abs() < 1e-6, "{tooth}");
        }
    }

    #[test]
    fn windows_that_touch_are_one() {
        let of = |first, last| {
            let teeth = ToothRange::new(Some(first), Some(last)).unwrap();
            let rack = [RackDeviation { teeth, kind: RackDeviationKind::Shift(0.02) }];
            judged_strokes(&deviated(&rack), &rack, &BTreeSet::new(), false).unwrap().len()
        };
        assert_eq!((of(2, 3), of(100, 103), of(100, 200)), (1, 2, 3));
    }
}
