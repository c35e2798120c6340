//! The exact rigid mesh beside a simulation: what the compliant model should tend to. Called by the reports and the
//! tests; solves nothing of its own.

use super::Steady;
use crate::mesh::{Mesh, MeshPoint};

/// Cells per pitch at first: a tooth's passage takes several.
const CELLS_PER_PITCH: f64 = 48.0;
/// Cells at most, at first.
const MOST: f64 = 1e6;
/// How often a cell may be halved.
const HALVINGS: u32 = 4;
/// A cell whose middle lies this near to its chord (mm) is straight enough: the mean is then right to as much.
const STRAIGHT: f64 = 2e-7;

/// A cell's ends: strokes and ΔCD.
type Cell = [(f64, f64); 2];

/// The mean ΔCD of the exact mesh over the strokes of a steady value, mm; `None` where the mesh has no solution.
///
/// By trapezoids over the 48th part of a pitch, which are halved up to four times where the curve bends: right to a few
/// nanometres where it jumps.
#[must_use]
pub fn exact_mean_mm(mesh: &Mesh, steady: &Steady) -> Option<f64> {
    let length = steady.to_mm - steady.from_mm;
    let solve = |strokes: &[f64]| -> Option<Vec<f64>> {
        mesh.sample(strokes)
            .into_iter()
            .map(|point| point.ok().map(|MeshPoint { delta_cd_mm, .. }| delta_cd_mm))
            .collect()
    };
    let count = (length / mesh.pair().rack().pitch_mm * CELLS_PER_PITCH).ceil().clamp(1.0, MOST);
    // whole and at most a million
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let strokes: Vec<f64> =
        (0..=count as u32).map(|index| steady.from_mm + length * f64::from(index) / count).collect();
    let values = solve(&strokes)?;
    if length <= 0.0 {
        return values.first().copied();
    }
    let bends = |index: usize| {
        index > 0
            && index + 1 < values.len()
            && (0.5 * (values[index - 1] + values[index + 1]) - values[index]).abs() > STRAIGHT
    };
    let (mut sum, mut bent): (f64, Vec<Cell>) = (0.0, Vec::new());
    let mut add = |[(from, start), (to, end)]: Cell| sum += 0.5 * (start + end) * (to - from);
    for index in 1..values.len() {
        let cell = [(strokes[index - 1], values[index - 1]), (strokes[index], values[index])];
        if bends(index - 1) || bends(index) { bent.push(cell) } else { add(cell) }
    }
    for _ in 0..HALVINGS {
        let middles: Vec<f64> = bent.iter().map(|[(from, _), (to, _)]| 0.5 * (from + to)).collect();
        let found = solve(&middles)?;
        let mut next = Vec::new();
        for ((cell, middle), value) in bent.iter().zip(middles).zip(found) {
            let halves = [[cell[0], (middle, value)], [(middle, value), cell[1]]];
            if (0.5 * (cell[0].1 + cell[1].1) - value).abs() > STRAIGHT {
                next.extend(halves);
            } else {
                halves.into_iter().for_each(&mut add);
            }
        }
        bent = next;
    }
    // what is still bent takes the value in its middle: beside a jump at an end of the range the curve is not drawn in
    let middles: Vec<f64> = bent.iter().map(|[(from, _), (to, _)]| 0.5 * (from + to)).collect();
    let widths = bent.iter().map(|[(from, _), (to, _)]| to - from);
    sum += solve(&middles)?.into_iter().zip(widths).map(|(value, width)| value * width).sum::<f64>();
    Some(sum / length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::{PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks};
    use crate::mesh::Support;
    use crate::reproduction;

    /// Against the midpoint rule over steps of a hundredth of a micrometre of mean.
    #[test]
    fn the_mean_is_that_of_many_points() {
        let pair = reproduction::pair().unwrap();
        let teeth = "4..".parse().unwrap();
        for kind in [RackDeviationKind::Pitch(0.02), RackDeviationKind::Lead(0.004)] {
            let rack = RackFlanks::new(&pair, &[RackDeviation { teeth, kind }]).unwrap();
            let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::Fixed).unwrap();
            let steady = Steady {
                delta_cd_mm: 0.0,
                ripple_mm: 0.0,
                indentation_mm: 0.0,
                from_mm: 14.3,
                to_mm: 33.2,
                pitches: 3,
            };
            let strokes: Vec<f64> = (0..40_000).map(|i| 14.3 + 18.9 * (f64::from(i) + 0.5) / 40_000.0).collect();
            let many =
                mesh.sample(&strokes).into_iter().map(|point| point.unwrap().delta_cd_mm).sum::<f64>() / 40_000.0;
            let mean = exact_mean_mm(&mesh, &steady).unwrap();
            assert!((mean - many).abs() < 1e-5, "{mean} {many}");
            println!("{:e}", mean - many);
        }
    }
}
