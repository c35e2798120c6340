//! Flanks with form: crowning, relief and slope. Called by [`FlankContact::touch`] and [`FlankContact::demand`] where a
//! pair has any; plain flanks never come here. The demand on a generator is still concave, but no longer piecewise
//! linear, so both maxima are searched without derivatives.

use super::{Bound, ContactKind, Coordinates, FlankContact, Generator, Line, Pose, Spot, Touch};

/// Flank form of both parts, as amounts along Z. Where the pinion's surface stands back it also does so from the rack's
/// tip plane, by `tip_share` of that.
#[derive(Debug, Clone, Copy)]
pub(in crate::mesh) struct Form {
    pub(in crate::mesh) rack_crowning: f64,
    pub(in crate::mesh) pinion_crowning: f64,
    pub(in crate::mesh) profile_slope: f64,
    pub(in crate::mesh) tip_relief: f64,
    pub(in crate::mesh) relief_start: f64,
    pub(in crate::mesh) tip: f64,
    pub(in crate::mesh) tip_share: f64,
}

impl FlankContact {
    /// The same with flank form: still concave in w, but no longer piecewise linear, so it is searched.
    pub(super) fn demand_with_form(
        &self,
        form: &Form,
        pose: &Pose,
        at: &Coordinates,
        flank: Line,
        tip: Line,
        (lo, hi): (Bound, Bound),
    ) -> Generator {
        let y = self.across_line(pose, at);
        let both = |w: f64| {
            let across = y.at(w) / self.across.half_width;
            let axial = w / self.half_face;
            let roll = (at.t0 + self.kappa * w - self.start_roll) / (self.tip_roll - self.start_roll);
            let plane = flank.at(w);
            let relief = if form.tip_relief > 0.0 {
                let height = plane + at.zeta.at(w);
                form.tip_relief * ((height - form.relief_start) / (form.tip - form.relief_start)).max(0.0)
            } else {
                0.0
            };
            let stands_back = form.pinion_crowning * axial * axial + form.profile_slope * roll;
            let formed = plane - form.rack_crowning * across * across - relief - stands_back;
            (formed, tip.at(w) - form.tip_share * stands_back)
        };
        let value = |w: f64| {
            let (on_flank, at_tip) = both(w);
            on_flank.min(at_tip)
        };
        let w = golden(lo.w, hi.w.max(lo.w), &value);
        let near = 1e-6 * self.half_face;
        let (on_flank, at_tip) = both(w);
        // where both ask for the same it is the edge between them, not the tip plane
        let same = 1e-9 * self.half_face;
        let (at_edge, on_tip) = ((on_flank - at_tip).abs() <= same, on_flank - at_tip > same);
        let kind = match (w - lo.w < near, hi.w - w < near) {
            (true, _) => lo.kind,
            (_, true) => hi.kind,
            _ if at_edge || on_tip => ContactKind::RackEdge,
            _ => ContactKind::Point,
        };
        Generator::Some { demand: on_flank.min(at_tip), slope: f64::NAN, rate: flank.p_rate, w, kind, on_tip }
    }

    /// Derivative-free maximum over generators, for flank form.
    pub(super) fn search(&self, pose: &Pose, lo: f64, hi: f64) -> Option<Touch> {
        let scale = self.base_radius;
        // generators off the flank rank below all others, the nearer ones higher
        let value = |delta: f64| match self.demand(pose, delta) {
            Generator::Some { demand, .. } => demand,
            Generator::None { gap, .. } => -1e3 * scale + 1e3 * gap,
        };
        let delta = golden(lo, hi, &value);
        match self.demand(pose, delta) {
            Generator::Some { demand, rate, kind, w, on_tip, .. } => {
                let spot = Spot { delta, w, kind, on_tip };
                Some(Touch { demand, rate, kind, spot, other: None, spread: 0.0, vertex: None, at_rack_edge: false })
            }
            Generator::None { .. } => None,
        }
    }
}

/// Maximum of a unimodal function by golden section. The value is good to rounding, the place to its root.
fn golden(lo: f64, hi: f64, value: &impl Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (lo, hi);
    let (mut x, mut y) = (b - RATIO * (b - a), a + RATIO * (b - a));
    let (mut fx, mut fy) = (value(x), value(y));
    // 0.618^75 = 2e-16
    for _ in 0..75 {
        if fx >= fy {
            b = y;
            (y, fy) = (x, fx);
            x = b - RATIO * (b - a);
            fx = value(x);
        } else {
            a = x;
            (x, fx) = (y, fy);
            y = a + RATIO * (b - a);
            fy = value(y);
        }
    }
    let middle = 0.5 * (a + b);
    let mut best = (middle, value(middle));
    for end in [lo, hi] {
        let at_end = value(end);
        if at_end > best.1 {
            best = (end, at_end);
        }
    }
    best.0
}
