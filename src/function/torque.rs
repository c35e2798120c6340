//! The forces at one stroke: the yoke's force, the pinion's torque, and the lift-off force.

use super::Yoke;
use crate::gear::Pair;
use crate::mesh::{MeshPoint, Rates};
use crate::trig;

/// Play and forces at a stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtStroke {
    /// Play J, mm; `None` if no play is set.
    pub play_mm: Option<f64>,
    /// The forces; `None` without a preload, or where the mesh has no rates.
    pub forces: Option<ForcesAt>,
}

/// Forces at a stroke; torques are those at the pinion with no load on the rack.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ForcesAt {
    /// Force F of the yoke, N.
    pub yoke_n: f64,
    /// F dΔCD/dθ, N m: the torque that lifts the yoke as s rises.
    pub lifting_n_m: f64,
    /// μ_y F ds/dθ, N m: friction of the yoke on the rack.
    pub yoke_friction_n_m: f64,
    /// μ_m Σ N_i v_i/v_rack ds/dθ, N m: friction at the teeth.
    pub tooth_friction_n_m: f64,
    /// Torque as s rises, N m: the sum of the three and T_0.
    pub rising_n_m: f64,
    /// Torque as s falls, N m: the sum with the first term negative.
    pub falling_n_m: f64,
    /// Force F_x along the rack at which one side of the teeth unloads, N.
    pub lift_off_n: f64,
}

/// A yoke with its play set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SetYoke {
    pub(super) yoke: Yoke,
    /// ΔCD(s_0), mm.
    pub(super) at_mm: f64,
    pub(super) play_mm: Option<f64>,
    /// Lift-off force over the yoke's force, F_x / F.
    pub(super) lift_off: f64,
}

/// N mm in a N m.
pub(super) const N_MM: f64 = 1000.0;

impl SetYoke {
    /// Play and forces at a solved stroke.
    pub(super) fn at(&self, point: &MeshPoint, rates: Option<Rates>) -> AtStroke {
        let Yoke { preload_n, rate_n_per_mm, yoke_friction, tooth_friction, bearing_torque_n_m, .. } = self.yoke;
        let moved = point.delta_cd_mm - self.at_mm;
        let forces = preload_n.zip(rates).map(|(preload, rates)| {
            let yoke_n = (preload + rate_n_per_mm.unwrap_or(0.0) * moved).max(0.0);
            // the torque of a force along the rack, N m
            let torque = |force: f64| force / rates.pinion_angle / N_MM;
            let lifting_n_m = torque(yoke_n * rates.delta_cd);
            let yoke_friction_n_m = torque(yoke_n * yoke_friction.unwrap_or(0.0));
            let tooth_friction_n_m = torque(yoke_n * tooth_friction.unwrap_or(0.0) * rates.sliding);
            let resting = yoke_friction_n_m + tooth_friction_n_m + bearing_torque_n_m.unwrap_or(0.0);
            ForcesAt {
                yoke_n,
                lifting_n_m,
                yoke_friction_n_m,
                tooth_friction_n_m,
                rising_n_m: resting + lifting_n_m,
                falling_n_m: resting - lifting_n_m,
                lift_off_n: yoke_n * self.lift_off,
            }
        });
        AtStroke { play_mm: self.play_mm.map(|play| play - moved), forces }
    }
}

/// Force along the rack at which one side of the teeth unloads, over the force of the yoke: F_x / F = cot(α_x + ρ′), at least
/// 0, with tan α_x = tan α_n / cos β_r and tan ρ′ = μ / √(1 − cos²α_n sin²β_r).
///
/// `friction` is the coefficient of friction μ at the teeth; a positive one helps the rack to climb. Without friction the ratio
/// is cos β_r / tan α_n.
///
/// Source: equilibrium of the rack when one flank alone carries, with the force N along its normal
/// (cos β_r cos α_n, …, sin α_n) and μ N along (sin α_n, …, −cos β_r cos α_n) / √(1 − cos²α_n sin²β_r).
#[must_use]
pub fn lift_off_per_newton(pair: &Pair, friction: f64) -> f64 {
    let (sin_n, cos_n) = trig::sin_cos(pair.normal_pressure_angle_rad());
    let (sin_b, cos_b) = trig::sin_cos(pair.rack().helix_angle_rad);
    let (climb, lift) = (cos_b * cos_n, sin_n);
    let share = friction / (1.0 - cos_n * cos_n * sin_b * sin_b).sqrt();
    ((climb - share * lift) / (lift + share * climb)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::example;

    /// 20°, a straight rack, 500 N: with μ = 0.08, without friction, and with friction against the climb.
    #[test]
    fn lift_off_is_that_of_a_wedge() {
        let mut data = example(20, 0.0, 0.2);
        data.normal_pressure_angle_rad = 20.0 * std::f64::consts::PI / 180.0;
        let pair = Pair::new(&data).unwrap();
        let found = [0.08, 0.0, -0.08].map(|friction| (500.0 * lift_off_per_newton(&pair, friction)).round());
        assert_eq!(found, [1093.0, 1374.0, 1812.0]);
        assert_eq!(lift_off_per_newton(&pair, 3.0), 0.0);
        // a helix on the rack makes the flank steeper along the rack
        let pair = Pair::new(&example(20, 0.5, 0.2)).unwrap();
        let tan_x = trig::tan(pair.normal_pressure_angle_rad()) / trig::cos(0.5);
        assert!((lift_off_per_newton(&pair, 0.0) * tan_x - 1.0).abs() < 1e-14);
    }
}
