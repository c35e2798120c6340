//! How the demand of a flank pair changes with the rack's roll. Called once for each roll tried, at the contact that
//! was found; searches nothing.

use super::{Across, Bound, ContactKind, Coordinates, FlankContact, FormRates, Plane, Pose, Spot, Touch};

/// How a flank pair changes with the rack's roll.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::mesh) struct RollRates {
    pub(in crate::mesh) flank: Plane,
    pub(in crate::mesh) tip: Plane,
    /// `half_width` is not used.
    pub(in crate::mesh) across: Across,
    pub(in crate::mesh) per_shift: f64,
    pub(in crate::mesh) form: FormRates,
}

/// How a position changes: `pose.shift` by the roll, `pose.across` by the roll and by the centre distance.
#[derive(Debug, Clone, Copy)]
pub(in crate::mesh) struct PoseRates {
    pub(in crate::mesh) shift: f64,
    pub(in crate::mesh) across: [f64; 2],
}

impl FlankContact {
    /// The demand's derivatives by the rack's roll and by the centre distance that places its end faces.
    pub(in crate::mesh) fn roll_rate(
        &self,
        pose: &Pose,
        touch: &Touch,
        rates: &RollRates,
        moved: &PoseRates,
    ) -> [f64; 2] {
        let first = self.spot_roll_rate(pose, &touch.spot, rates, moved);
        let mut rate = match &touch.other {
            Some((spot, share)) => {
                let other = self.spot_roll_rate(pose, spot, rates, moved);
                [0, 1].map(|i| share * first[i] + (1.0 - share) * other[i])
            }
            None => first,
        };
        if let Some((delta, per_gap)) = touch.vertex {
            let at = self.coordinates(pose, delta);
            let (lo, hi) = self.interval(pose, &at);
            let y = self.across_line(pose, &at);
            let moving = |bound: &Bound| {
                let sweep = Self::sweep(&at, bound.w, rates, moved).map(|sweep| -sweep / y.q);
                if bound.kind == ContactKind::RackEndEdge { sweep } else { [0.0; 2] }
            };
            let (lo, hi) = (moving(&lo), moving(&hi));
            rate = [0, 1].map(|i| rate[i] + per_gap * (hi[i] - lo[i]));
        }
        rate
    }

    /// How the coordinate across the rack changes at a point of the pinion.
    pub(super) fn sweep(at: &Coordinates, w: f64, rates: &RollRates, moved: &PoseRates) -> [f64; 2] {
        let a = &rates.across;
        [a.t * at.xi.at(w) + a.z * at.zeta.at(w) + a.w * w + moved.across[0], moved.across[1]]
    }

    fn spot_roll_rate(&self, pose: &Pose, spot: &Spot, rates: &RollRates, moved: &PoseRates) -> [f64; 2] {
        if let Some(form) = &self.form {
            return self.formed_roll_rate(form, pose, spot.delta, rates, moved);
        }
        let at = self.coordinates(pose, spot.delta);
        let xi = at.xi.at(spot.w);
        let by_roll = |plane: &Plane| plane.d - plane.t * xi - plane.w * spot.w;
        let (on_flank, on_tip) = (by_roll(&rates.flank) + moved.shift, by_roll(&rates.tip));
        let flank = Self::plane(&self.flank, pose.shift, &at);
        let tip = Self::plane(&self.tip, 0.0, &at);
        let (line, rate) = if spot.is_on_tip() { (tip, on_tip) } else { (flank, on_flank) };
        match spot.kind {
            ContactKind::RackEndEdge => {
                let y = self.across_line(pose, &at);
                let sweep = Self::sweep(&at, spot.w, rates, moved);
                [rate - line.q * sweep[0] / y.q, -line.q * sweep[1] / y.q]
            }
            ContactKind::RackEdge => [on_flank + flank.q * (on_flank - on_tip) / (tip.q - flank.q), 0.0],
            _ => [rate, 0.0],
        }
    }
}
