//! A quick bound that shows whether a flank pair can carry at all. The solver calls it for every pair in reach, and most
//! end here without a search. Without it random racks take 3.9 times as long, with the bound of the last section alone,
//! which holds for any flank, 3.0 times. The setting and the names are those of [`corner`](super::corner).
//!
//! No point of the flank asks for more than the end E(τ) of its tip edge, where δ < 0 there, or of its root edge, where
//! δ > 0. By how much δ misses 0 follows from where the contact line leaves the flank: at the roll angle τ the line
//! would need ν − c = τ − κ w with w at the end of the pinion's face, or at the end of the rack's, which at another
//! δ lies elsewhere by no more than |t| r_a δ/W. Beyond an edge by e the flank's plane asks for less by
//!
//! ```text
//! (r_b/sin ν) (τ (1 − cos e) + e − sin e) beyond the tip,   (r_b/sin ν) (τ (1 − cos e) − e + sin e) below the root,
//! ```
//!
//! and wherever tan(δ/2) < τ the latter is at least 2 tan(e/2) − e ≥ e³/12. Both grow with e there.
//!
//! Instead of the root's roll angle a larger one τ_m ≤ tan ν may be taken at which the rack's tip plane asks on the
//! contact line for no more than the mark, d + r_b (cos ν + τ_m sin ν). Where τ < τ_m it asks for less on the line,
//! still less where δ > 0, and where δ < 0, between the line and an E(τ) that meets it below τ_m, for no more than at
//! that meeting point: see [`rack_corner`](super::rack_corner). And where tan(δ/2) ≥ τ it asks for d + r_b (cos ν − τ
//! sin ν) at most, as on the line at −τ_0.

use super::{FlankContact, Pose};

/// Constants of the quick bound of a flank pair.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::mesh) struct Reach {
    /// κ w at the end of the pinion's face.
    face: f64,
    /// κ w at the end of the rack's face that limits the tip edge, where the line meets it.
    tip: f64,
    /// κ w at the end of the rack's face at a roll angle towards the root: a constant, and its growth with the roll angle.
    root: [f64; 2],
    /// Least share of δ per distance of the line beyond the rack's face.
    share: f64,
    tan_nu: f64,
    /// 1/(r_b sin ν).
    per_height: f64,
}

impl FlankContact {
    pub(super) fn reach(&self, tip_radius: f64, eccentricity: f64) -> Reach {
        let (kappa, across) = (self.kappa.abs(), &self.across);
        // the end where w has the sign of `side`, with the eccentric offset in favour
        let end = |side: f64| {
            let t = side.signum() * across.t * self.base_radius;
            let widest = across.half_width + (across.t * eccentricity).abs();
            let per_width = kappa / across.w;
            [per_width * (widest - t * self.sin_nu), per_width * t * self.cos_nu]
        };
        let tip = end(-self.kappa);
        Reach {
            face: kappa * self.half_face,
            tip: tip[0] + tip[1] * self.tip_roll,
            root: end(self.kappa),
            share: 1.0 / (1.0 + kappa * across.t.abs() * tip_radius / across.w),
            tan_nu: self.sin_nu / self.cos_nu,
            per_height: 1.0 / (self.base_radius * self.sin_nu),
        }
    }

    /// Whether no point of this flank, whose end is known, asks for more than the mark.
    pub(super) fn reaches_no(&self, pose: &Pose, mark: f64) -> bool {
        let Reach { face, tip, root, share, tan_nu, per_height } = self.reach;
        let line = self.unbounded(pose);
        if line - self.far_loss > mark {
            return false;
        }
        let low = (mark - self.tip.d + pose.offset.1) * per_height - 1.0 / tan_nu;
        // where tan(δ/2) ≥ τ the tip plane asks for as much at most as it does on the line at −τ_0
        let kept_out = low >= -self.start_roll;
        if line <= mark && kept_out {
            return true;
        }
        let roll = self.nu - pose.c;
        let beyond_tip = (roll - self.tip_roll - face).max((roll - self.tip_roll - tip) * share);
        if beyond_tip > 0.0 {
            return line - self.scale * clearance(self.tip_roll, beyond_tip.min(1.0)) <= mark;
        }
        let start = self.start_roll.max(low.min(tan_nu));
        let below = (start - face - roll).max((start - (root[0] + root[1] * start) - roll) * share);
        if below <= 0.0 {
            return false;
        }
        let e = below.min(1.0);
        let loss = (clearance(start, e) - e * e * e / 6.0).max(e * e * e / 12.0);
        kept_out && line - self.scale * loss <= mark
    }

    /// Whether this pair certainly asks for no more than the mark.
    pub(in crate::mesh) fn stays_below(&self, pose: &Pose, mark: f64) -> bool {
        if self.slides { self.reaches_no(pose, mark) } else { self.bound_by_involute(pose) <= mark }
    }

    /// The bound for any flank: at each w the best generator is δ = 0, and where that lies off the involute by the roll
    /// angle η, the edge asks for less by (r_b/sin ν)(τ η²/2 + …).
    fn bound_by_involute(&self, pose: &Pose) -> f64 {
        let roll = self.nu - pose.c;
        let reach = self.kappa.abs() * self.w_extent;
        let beyond_tip = roll - reach - self.tip_roll;
        let loss = if beyond_tip > 0.0 {
            clearance(self.tip_roll, beyond_tip.min(1.0))
        } else {
            // along the involute's start g falls with δ up to tan(δ/2) = τ_0 and rises from there: it is largest at an end
            let start = |e: f64| clearance(self.start_roll, e) - e * e * e / 6.0;
            let below = self.start_roll - roll;
            start((below - reach).clamp(0.0, 1.0)).min(start((below + reach).max(0.0)))
        };
        let slope = self.form.map_or(0.0, |form| (-form.pinion.profile_slope_mm).max(0.0) * form.per_normal);
        self.unbounded(pose) + self.tilt.abs() * self.w_extent - self.scale * loss + slope
    }
}

/// What the edge at a roll angle stays clear of the contact line's generator by, beyond it by e, in units of r_b/sin ν,
/// but for e³/6.
fn clearance(roll: f64, e: f64) -> f64 {
    e * e * (roll * (0.5 - e * e / 24.0))
}
