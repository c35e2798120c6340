//! Which strokes a measured rack covers: those at which every flank that can carry was measured. Used for tables of a
//! rack's spaces: a space that was not measured is not taken as nominal, and its strokes are not judged.
//!
//! A flank of tooth k carries at strokes from k p_x + s_1 to k p_x + s_2, whatever its deviation, as long as that is small:
//! s_1 and s_2 are found on the mesh of a nominal pair, on a fixed support, in which that flank stands out by 0.1 mm.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::{FlankSide, Mesh, MeshError, Support};
use crate::deviation::{PinionFlanks, RackFlanks, RackTooth};
use crate::gear::Pair;

/// How far the flank stands out, mm: more than any measured flank does.
const PROUD_MM: f64 = 0.1;
/// Strokes that are tried in each pitch.
const STEPS: i32 = 64;

/// Where the flanks of a rack tooth can carry, relative to the stroke k p_x of tooth k, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct CarryingStrokes {
    right: Range<f64>,
    left: Range<f64>,
    pitch_mm: f64,
}

impl CarryingStrokes {
    /// The strokes at which the flanks of a pair carry.
    ///
    /// # Errors
    /// Whatever the mesh of the pair gives.
    pub fn of(pair: &Pair) -> Result<Self, MeshError> {
        let right = carrying(pair, FlankSide::Right, PROUD_MM)?;
        let left = carrying(pair, FlankSide::Left, PROUD_MM)?;
        Ok(Self { right, left, pitch_mm: pair.rack().pitch_mm })
    }

    /// The strokes from `from_mm` to `to_mm` at which every flank that can carry bounds one of the `spaces`. Space j lies
    /// between the right flank of tooth j and the left one of tooth j + 1.
    #[must_use]
    pub fn measured(&self, spaces: &BTreeSet<i64>, from_mm: f64, to_mm: f64) -> Vec<Range<f64>> {
        let mut covered = vec![from_mm..to_mm];
        for (strokes, of_space) in [(&self.right, 0), (&self.left, -1)] {
            let (first, last) = (
                ((from_mm - strokes.end) / self.pitch_mm).floor() as i64,
                ((to_mm - strokes.start) / self.pitch_mm).ceil() as i64,
            );
            for tooth in (first..=last).filter(|tooth| !spaces.contains(&(tooth + of_space))) {
                let at = tooth as f64 * self.pitch_mm;
                covered =
                    covered.into_iter().flat_map(|part| without(part, at + strokes.start..at + strokes.end)).collect();
            }
        }
        covered
    }
}

/// A range less another one.
fn without(range: Range<f64>, taken: Range<f64>) -> impl Iterator<Item = Range<f64>> {
    let before = range.start..range.end.min(taken.start);
    let after = range.start.max(taken.end)..range.end;
    [before, after].into_iter().filter(|part| part.start < part.end)
}

/// The strokes at which a flank of tooth 0 that stands out carries; either end may be up to one step too far.
fn carrying(pair: &Pair, side: FlankSide, proud_mm: f64) -> Result<Range<f64>, MeshError> {
    let mut tooth = RackTooth::default();
    match side {
        FlankSide::Right => tooth.right.along_x_mm = proud_mm,
        FlankSide::Left => tooth.left.along_x_mm = -proud_mm,
    }
    let Ok(rack) = RackFlanks::nominal(pair).with_measured(&BTreeMap::from([(0, tooth)])) else {
        unreachable!("a flank may stand out by so little")
    };
    let mesh = Mesh::new(*pair, rack, PinionFlanks::nominal(pair), Support::Fixed)?;
    let step = pair.rack().pitch_mm / f64::from(STEPS);
    let reach = (pair.contact_ratio().total + 2.0).ceil().clamp(2.0, 100.0) as i32 * STEPS;
    let strokes: Vec<f64> = (-reach..=reach).map(|index| f64::from(index) * step).collect();
    let mut range = f64::INFINITY..f64::NEG_INFINITY;
    for point in mesh.sample(&strokes) {
        let point = point?;
        let carrier = if side == FlankSide::Right { point.right } else { point.left };
        if carrier.rack_tooth == 0 {
            range = range.start.min(point.stroke_mm - step)..range.end.max(point.stroke_mm + step);
        }
    }
    Ok(range)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::{PairData, example};

    /// A flank that hardly stands out carries along the pair's path of contact: the right one at c ± ε/2, the left one at
    /// −c ± ε/2.
    #[test]
    fn flanks_carry_along_the_path_of_contact() {
        let examples = [(20, 0.0, 0.0), (20, 0.0, 0.4), (20, -0.3, 0.4), (12, 0.2, 0.3), (20, -0.35, 0.35)];
        let examples = examples.map(|(teeth, rack, pinion)| {
            let data = PairData { normal_pressure_angle_rad: 0.35, ..example(teeth, rack, pinion) };
            Pair::new(&data).expect("a valid pair")
        });
        let paper = crate::reproduction::pair().expect("a valid pair");
        for pair in examples.into_iter().chain([paper]) {
            let (ratio, pitch) = (pair.contact_ratio(), pair.rack().pitch_mm);
            for (side, offset) in [(FlankSide::Right, ratio.offset), (FlankSide::Left, -ratio.offset)] {
                let carried = carrying(&pair, side, 1e-5).expect("a mesh");
                let path = (offset - 0.5 * ratio.total)..(offset + 0.5 * ratio.total);
                for (found, end) in [(carried.start, path.start), (carried.end, path.end)] {
                    let steps = f64::from(STEPS) * (found / pitch - end).abs();
                    assert!(steps < 1.5, "{side:?}: {found} for {end} of {ratio:?}");
                }
            }
        }
    }

    #[test]
    fn a_range_less_another() {
        let less = |taken: Range<f64>| without(0.0..10.0, taken).collect::<Vec<_>>();
        assert_eq!(less(2.0..3.0), [0.0..2.0, 3.0..10.0]);
        assert_eq!(less(-1.0..3.0), [3.0..10.0]);
        assert_eq!(less(-1.0..30.0), []);
        assert_eq!(less(20.0..30.0), [0.0..10.0]);
    }
}
