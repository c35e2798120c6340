//! Distance of a sphere's centre from a patch of the rack's flank: face, edge or vertex. Called for spheres that may
//! touch; knows no mechanics.
//!
//! Over a face the distance is the signed one from its plane. Beyond an edge, with the height h over the plane and the
//! distance e of the foot point from the patch, it is √(h² + e²), and with h_0 = max(h, R/2)
//!
//! ```text
//! distance = √(h_0² + e²) + h − h_0,
//! ```
//!
//! the same thing for any sphere that is not pressed in by half its radius, and a continuous continuation for those
//! that are (spheres shrink to points at the base circle). It never lies below h, so a sphere whose height
//! over the plane exceeds R is clear of the patch: the bound by which spheres are culled.

use crate::linear::{dot, increase};

/// A distance with its first and second derivatives by the centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Distance {
    pub(super) value: f64,
    pub(super) gradient: [f64; 3],
    pub(super) hessian: [[f64; 3]; 3],
}

fn sub(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The unit normal of a triangle.
pub(super) fn normal(corners: &[[f64; 3]; 3]) -> [f64; 3] {
    let n = cross(&sub(&corners[1], &corners[0]), &sub(&corners[2], &corners[0]));
    let length = dot(&n, &n).sqrt();
    n.map(|v| v / length)
}

/// How a foot point lies beyond the nearest point of a polygon's edges.
#[derive(Clone, Copy)]
struct Beyond {
    square: f64,
    offset: [f64; 3],
    at_vertex: bool,
}

/// Distance of `center` from a convex plane polygon with its corners counterclockwise about `normal`; `None` if the
/// foot point is further than `reach` beyond its edges.
pub(super) fn polygon(
    corners: &[[f64; 3]],
    normal: &[f64; 3],
    center: &[f64; 3],
    radius: f64,
    reach: f64,
) -> Option<Distance> {
    let height = dot(normal, &sub(center, &corners[0]));
    let foot: [f64; 3] = std::array::from_fn(|axis| center[axis] - height * normal[axis]);
    let mut nearest: Option<Beyond> = None;
    for (index, from) in corners.iter().enumerate() {
        let along = sub(&corners[(index + 1) % corners.len()], from);
        let to_foot = sub(&foot, from);
        if dot(&cross(&along, &to_foot), normal) >= 0.0 {
            continue;
        }
        let share = dot(&along, &to_foot) / dot(&along, &along);
        let clamped = share.clamp(0.0, 1.0);
        let offset: [f64; 3] = std::array::from_fn(|axis| to_foot[axis] - clamped * along[axis]);
        let square = dot(&offset, &offset);
        if nearest.is_none_or(|nearest| square < nearest.square) {
            nearest = Some(Beyond { square, offset, at_vertex: share != clamped });
        }
    }
    let face = Distance { value: height, gradient: *normal, hessian: [[0.0; 3]; 3] };
    let Some(Beyond { square, offset, at_vertex }) = nearest.filter(|nearest| nearest.square != 0.0) else {
        return Some(face);
    };
    let beyond = square.sqrt();
    if beyond > reach {
        return None;
    }
    let outward = offset.map(|v| v / beyond);
    let floor = height.max(0.5 * radius);
    let slant = (floor * floor + beyond * beyond).sqrt();
    let (sin, cos) = (beyond / slant, floor / slant);
    let up = if height >= floor { cos } else { 1.0 };
    let gradient = std::array::from_fn(|axis| up * normal[axis] + sin * outward[axis]);
    let mut distance = Distance { value: slant + height - floor, gradient, hessian: [[0.0; 3]; 3] };
    increase(&mut distance.hessian, |i, j| cos * cos / slant * outward[i] * outward[j]);
    if height >= floor {
        increase(&mut distance.hessian, |i, j| {
            let mixed = normal[i] * outward[j] + outward[i] * normal[j];
            (sin * sin * normal[i] * normal[j] - sin * cos * mixed) / slant
        });
    }
    if at_vertex {
        let across = cross(normal, &outward);
        increase(&mut distance.hessian, |i, j| 1.0 / slant * across[i] * across[j]);
    }
    Some(distance)
}

/// Whether the distance certainly exceeds `left` for a centre at a height over the plane whose foot is at least
/// `beyond` outside the patch: √(h_0² + e²) + h − h_0 ≥ left, squared and with room for rounding.
pub(super) fn clear(height: f64, beyond: f64, radius: f64, left: f64) -> bool {
    let floor = height.max(0.5 * radius);
    let needed = left + floor - height;
    beyond * beyond > (needed - floor) * (needed + floor) * (1.0 + 1e-9) + 1e-12
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    const UP: [f64; 3] = [0.0, 0.0, 1.0];

    fn at(center: [f64; 3]) -> Distance {
        polygon(&SQUARE, &UP, &center, 0.4, 9.0).unwrap()
    }

    #[test]
    fn face_edge_and_vertex_are_true_distances() {
        assert_eq!(at([1.0, 0.5, 0.3]).value, 0.3);
        assert!((at([1.0, -0.3, 0.4]).value - 0.5).abs() < 1e-15);
        assert!((at([2.3, 1.4, 1.2]).value - 1.3).abs() < 1e-15);
        assert!(polygon(&SQUARE, &UP, &[5.0, 0.5, 0.1], 0.4, 1.0).is_none());
    }

    #[test]
    fn what_is_called_clear_is_clear() {
        let mut seen = [0, 0];
        for step in 0..2000 {
            let beyond = 1e-4 * f64::from(step % 100);
            for height in [0.39999, 0.3999, 0.35, 0.1, -0.05] {
                let far = clear(height, beyond, 0.4, 0.4);
                let touches = at([1.0, -beyond, height]).value < 0.4;
                assert!(!(far && touches), "{height} {beyond}");
                seen[usize::from(far)] += 1;
            }
        }
        assert!(seen[0] > 0 && seen[1] > 0);
    }

    #[test]
    fn derivatives_agree_with_differences() {
        for center in [[1.0, -0.3, 0.4], [2.3, 1.4, 1.2], [2.2, 0.4, -0.1], [-0.1, -0.2, 0.05], [0.3, 0.4, 0.2]] {
            let d = at(center);
            for axis in 0..3 {
                let h = 1e-6;
                let (mut up, mut down) = (center, center);
                up[axis] += h;
                down[axis] -= h;
                let (up, down) = (at(up), at(down));
                assert!((d.gradient[axis] - (up.value - down.value) / (2.0 * h)).abs() < 1e-8, "{center:?}");
                for other in 0..3 {
                    let difference = (up.gradient[other] - down.gradient[other]) / (2.0 * h);
                    assert!((d.hessian[axis][other] - difference).abs() < 1e-7, "{center:?} {axis} {other}");
                }
            }
        }
    }

    #[test]
    fn distance_is_continuous_over_every_edge_and_never_below_the_plane() {
        for height in [0.35, 0.2, 0.1, -0.05] {
            let mut last = at([1.0, 0.2, height]).value;
            for step in 1..400 {
                let value = at([1.0 + 0.004 * f64::from(step), 0.2 - 0.002 * f64::from(step), height]).value;
                assert!((value - last).abs() < 0.005 && value >= height);
                last = value;
            }
        }
    }
}
