//! The exact rigid mesh beside a simulation: the limit of the compliant model. Reports and tests call it.

use super::Steady;
use crate::mesh::{Mesh, MeshError, MeshPoint};
use crate::trig;

/// Cells per pitch at first: a tooth's passage takes several.
const CELLS_PER_PITCH: f64 = 24.0;
/// Cells at most, at first.
const MOST: f64 = 1e6;
/// How often a cell may be halved.
const HALVINGS: u32 = 4;
/// Tolerance (mm) for the distance of a cell from a straight line, and for the difference of the means of a cell and of its
/// halves: the mean has this error.
const STRAIGHT: f64 = 2e-7;

/// A cell's ends and middle: strokes and ΔCD.
#[derive(Debug, Clone, Copy)]
struct Cell {
    from: (f64, f64),
    mid: (f64, f64),
    to: (f64, f64),
}

impl Cell {
    fn width(&self) -> f64 {
        self.to.0 - self.from.0
    }

    /// By Simpson's rule.
    fn integral(&self) -> f64 {
        self.width() * (self.from.1 + 4.0 * self.mid.1 + self.to.1) / 6.0
    }
}

/// The mean ΔCD of the exact mesh over the strokes of a steady value, mm; `None` where the mesh has no solution, or none
/// that is certain.
///
/// By trapezoids over the 24th part of a pitch, and where the curve bends by Simpson's rule, over cells that are halved
/// up to four times until it agrees with that over the halves: right to a few nanometres where it jumps. Where all
/// teeth are alike one pitch stands for the others.
#[must_use]
pub fn exact_mean_mm(mesh: &Mesh, steady: &Steady) -> Option<f64> {
    let (from_mm, to_mm) = one_pitch(mesh, steady).unwrap_or((steady.from_mm, steady.to_mm));
    let length = to_mm - from_mm;
    let solve = |strokes: &[f64]| -> Option<Vec<f64>> {
        let solved = |point: Result<MeshPoint, MeshError>| Some(point.ok().filter(MeshPoint::is_solved)?.delta_cd_mm);
        mesh.sample(strokes).into_iter().map(solved).collect()
    };
    let count = (length / mesh.pair().rack().pitch_mm * CELLS_PER_PITCH).ceil().clamp(1.0, MOST);
    // whole and at most a million
    let strokes: Vec<f64> = (0..=count as u32).map(|index| from_mm + length * f64::from(index) / count).collect();
    let values = solve(&strokes)?;
    if length <= 0.0 {
        return values.first().copied();
    }
    let bends = |index: usize| {
        index > 0
            && index + 1 < values.len()
            && (0.5 * (values[index - 1] + values[index + 1]) - values[index]).abs() > STRAIGHT
    };
    let (mut sum, mut bent) = (0.0, Vec::new());
    for index in 1..values.len() {
        let [from, to] = [index - 1, index].map(|index| (strokes[index], values[index]));
        if bends(index - 1) || bends(index) {
            bent.push([from, to]);
        } else {
            sum += 0.5 * (from.1 + to.1) * (to.0 - from.0);
        }
    }
    let with_middles = |ends: &[[(f64, f64); 2]]| -> Option<Vec<Cell>> {
        let middles: Vec<f64> = ends.iter().map(|[from, to]| 0.5 * (from.0 + to.0)).collect();
        let found = solve(&middles)?;
        let middles = middles.into_iter().zip(found);
        Some(ends.iter().zip(middles).map(|(&[from, to], mid)| Cell { from, mid, to }).collect())
    };
    let mut cells = with_middles(&bent)?;
    for _ in 0..HALVINGS {
        let halves: Vec<_> = cells.iter().flat_map(|cell| [[cell.from, cell.mid], [cell.mid, cell.to]]).collect();
        let halves = with_middles(&halves)?;
        let mut next = Vec::new();
        for (cell, halves) in cells.iter().zip(halves.chunks(2)) {
            let finer: f64 = halves.iter().map(Cell::integral).sum();
            if (finer - cell.integral()).abs() > STRAIGHT * cell.width() {
                next.extend_from_slice(halves);
            } else {
                sum += finer;
            }
        }
        cells = next;
    }
    // a cell that is still bent takes the value in its middle, so that a jump at an end of the range does not count
    sum += cells.iter().map(|cell| cell.mid.1 * cell.width()).sum::<f64>();
    Some(sum / length)
}

/// A pitch whose mean is that of all whole pitches of a steady value, if its teeth are alike: those within reach of the
/// pinion over that pitch, and those that come under it over the others.
fn one_pitch(mesh: &Mesh, steady: &Steady) -> Option<(f64, f64)> {
    let (pair, pinion) = (mesh.pair(), mesh.pinion());
    let (p, rack) = (pair.pinion(), pair.rack());
    let uniform = pinion.teeth().windows(2).all(|two| two[0] == two[1]) && pinion.eccentricity_mm() == (0.0, 0.0);
    if steady.pitches < 2 || !uniform {
        return None;
    }
    let pitch = rack.pitch_mm;
    // no pinion point within the rack's height is further off, with room for ΔCD; a tooth is half a pitch wide to each
    // side at most, as rounding to tooth numbers has it
    let height = pair.nominal_center_distance_mm() - rack.addendum_mm - 0.1 * pair.normal_module_mm();
    let across = (p.tip_radius_mm * p.tip_radius_mm - height * height).max(0.0).sqrt();
    let askew = p.face_width_mm * trig::sin(pair.shaft_angle_rad()).abs()
        + rack.face_width_mm * trig::tan(rack.helix_angle_rad).abs();
    let reach = across + 0.5 * askew;
    let tooth = |stroke: f64| (stroke / pitch).round() as i64;
    let first = mesh.rack().tooth(tooth(steady.to_mm));
    let alike = |from: f64, to: f64| (tooth(from)..=tooth(to)).all(|index| mesh.rack().tooth(index) == first);
    if !alike(steady.from_mm, steady.to_mm) {
        return None;
    }
    (0..steady.pitches).find_map(|k| {
        let to = steady.to_mm - f64::from(k) * pitch;
        alike(to - pitch - reach, to + reach).then_some((to - pitch, to))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::{PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks};
    use crate::mesh::Support;
    use crate::reproduction;

    /// One pitch of a lead deviation stands for three, with the same mean, at the cost of a few points.
    #[test]
    fn one_pitch_stands_for_alike_ones() {
        let pair = reproduction::pair().unwrap();
        let teeth = "4..".parse().unwrap();
        let rack = RackFlanks::new(&pair, &[RackDeviation { teeth, kind: RackDeviationKind::Lead(0.004) }]).unwrap();
        let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::Fixed).unwrap();
        let pitch = pair.rack().pitch_mm;
        let over = |from_mm: f64, pitches: u32| Steady {
            delta_cd_mm: 0.0,
            ripple_mm: 0.0,
            indentation_mm: 0.0,
            from_mm,
            to_mm: from_mm + f64::from(pitches) * pitch,
            pitches,
        };
        assert_eq!(one_pitch(&mesh, &over(10.0, 3)), None, "both kinds of teeth");
        let whole = over(32.0, 3);
        assert!(one_pitch(&mesh, &whole).is_some());
        let parts = (0..3).map(|k| exact_mean_mm(&mesh, &over(32.0 + f64::from(k) * pitch, 1)).unwrap());
        let mean = exact_mean_mm(&mesh, &whole).unwrap();
        assert!((parts.sum::<f64>() / 3.0 - mean).abs() < 1e-8);
    }

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
