//! The exact rigid mesh beside a simulation: what the compliant model should tend to. Called by the reports and the
//! tests; solves nothing of its own.

use super::Steady;
use crate::mesh::{Mesh, MeshPoint, Support};
use crate::trig;

/// The curve is followed this closely, that of a rack that may roll, which is slow, less.
const TOLERANCE_MM: f64 = 1e-7;
const ROLLING_TOLERANCE_MM: f64 = 1e-6;

/// The mean ΔCD of the exact mesh over the strokes of a steady value, mm; `None` where the mesh has no solution, or none
/// that is certain. Where all teeth are alike one pitch stands for the others.
#[must_use]
pub fn exact_mean_mm(mesh: &Mesh, steady: &Steady) -> Option<f64> {
    let (from_mm, to_mm) = one_pitch(mesh, steady).unwrap_or((steady.from_mm, steady.to_mm));
    let tolerance_mm = if mesh.support() == Support::Fixed { TOLERANCE_MM } else { ROLLING_TOLERANCE_MM };
    let curve = mesh.curve(from_mm, to_mm, tolerance_mm).ok()?;
    let is_solved = curve.points.iter().all(MeshPoint::is_solved);
    Some(curve.summary(mesh).filter(|_| is_solved)?.mean_mm)
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

    /// One pitch of a lead deviation stands for three, and is the same to what a few points cost.
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
