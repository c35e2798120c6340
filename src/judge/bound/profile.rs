//! The demand of one flank pair where its contact line lies beyond its flanks: at the pinion's tip, at the start of the
//! involute, at the rack's tip edge. Used to lengthen a path of contact and to bound what undercut lifts. Knows no face
//! width, because that only removes points of contact.
//!
//! A flank pair whose contact line would lie at the roll angle t asks for ν(t) more than that line:
//!
//! ```text
//! ν(t) = max over δ of min(A, B),     τ = t + δ between the involute's start and the tip
//! A = r_b/sin α_t · (δ − sin δ − τ (1 − cos δ))                      by the rack's flank
//! B = h − a + r_b (cos(α_t + δ) + τ sin(α_t + δ))                     by the rack's tip plane
//! ```

use crate::gear::Pair;
use crate::trig;

/// The profiles of a pair at a centre distance.
#[derive(Debug, Clone, Copy)]
pub(in crate::judge) struct Profile {
    base_radius: f64,
    alpha_t: f64,
    start_roll: f64,
    tip_roll: f64,
    /// Rack addendum less centre distance, mm.
    tip_plane: f64,
    /// Factor of the demand at the tip plane.
    tip_counts: f64,
}

/// Roll angles are searched this far beyond a flank's ends, rad: farther out its neighbours carry.
const FAR: f64 = 1.0;
/// Halvings of a search: to 1e-9 rad, rounded to the safe side.
const HALVINGS: u32 = 32;

impl Profile {
    /// The profiles of a pair at a centre distance, with rack teeth that stand out more by `deeper_mm`.
    pub(in crate::judge) fn new(pair: &Pair, center_distance_mm: f64, deeper_mm: f64) -> Self {
        let pinion = pair.pinion();
        Self {
            base_radius: pinion.base_radius_mm,
            alpha_t: pinion.transverse_pressure_angle_rad,
            start_roll: pinion.start_roll_rad,
            tip_roll: pinion.tip_roll_rad,
            tip_plane: pair.rack().addendum_mm + deeper_mm - center_distance_mm,
            tip_counts: 1.0,
        }
    }

    /// The profiles of one side of a pair whose other side touches at least along its lines. Both sides share the demand of their
    /// flanks, but not that of the tip plane, which therefore counts twice.
    pub(in crate::judge) fn beside_lines(self) -> Self {
        Self { tip_counts: 2.0, ..self }
    }

    fn by_flank(&self, roll: f64, delta: f64) -> f64 {
        let (sin, cos) = trig::sin_cos(delta);
        self.base_radius / trig::sin(self.alpha_t) * (delta - sin - roll * (1.0 - cos))
    }

    fn by_tip(&self, roll: f64, delta: f64) -> f64 {
        let (sin, cos) = trig::sin_cos(self.alpha_t + delta);
        self.tip_counts * (self.tip_plane + self.base_radius * (cos + roll * sin))
    }

    /// ν: what the flank pair asks for beyond its contact line at the roll angle t. Past the generator nearest to the line, A
    /// falls and B rises, so the maximum is where they meet.
    pub(in crate::judge) fn beyond_line(&self, t: f64) -> f64 {
        let first = 0.0_f64.clamp(self.start_roll - t, self.tip_roll - t);
        let last = (self.tip_roll - t).min(1.0);
        let ends = |delta: f64| (self.by_flank(t + delta, delta), self.by_tip(t + delta, delta));
        let (flank, tip) = ends(first);
        if tip >= flank || last <= first {
            return flank.min(tip);
        }
        let Rolls { low, high } = end_between(first, last, |delta| {
            let (flank, tip) = ends(delta);
            tip < flank
        });
        // the larger of both at either end: on the safe side
        ends(low).0.min(ends(high).1)
    }

    /// The lowest roll angle of the contact line: the involute's start or the rack's tip edge.
    pub(in crate::judge) fn lowest_line(&self) -> f64 {
        let (sin, cos) = trig::sin_cos(self.alpha_t);
        let rack_tip = (-self.tip_plane / self.base_radius - cos) / sin;
        rack_tip.max(self.start_roll)
    }

    /// The largest ν: above 0 where the rack reaches below the base circle. It is reached at the start of the involute, where
    /// flank and tip plane ask for the same: a higher point of the involute loses more by A than it gains by B.
    pub(in crate::judge) fn largest_excess(&self) -> f64 {
        self.highest_line().map_or(0.0, |roll| self.by_flank(self.start_roll, self.start_roll - roll).max(0.0))
    }

    /// The roll angle of the contact line at which a flank pair asks for most beyond it; `None` if it never asks for more.
    fn highest_line(&self) -> Option<f64> {
        let flank = |delta: f64| self.by_flank(self.start_roll, delta).max(0.0);
        let reaches = |delta: f64| self.by_tip(self.start_roll, delta) >= flank(delta);
        reaches(0.0).then(|| self.start_roll - last_within(FAR, reaches))
    }

    /// The largest ν of contact lines between two roll angles: it falls on either side of its peak.
    pub(in crate::judge) fn most_beyond(&self, rolls: Rolls) -> f64 {
        match self.highest_line() {
            Some(peak) if rolls.low <= peak && peak <= rolls.high => self.largest_excess(),
            _ => self.beyond_line(rolls.low).max(self.beyond_line(rolls.high)),
        }
    }

    /// The roll angles of contact lines at which a flank pair still carries that stands out by `error` mm more than its
    /// neighbours: ν ≥ −error.
    pub(in crate::judge) fn carrying(&self, error: f64) -> Rolls {
        let carries = |t: f64| self.beyond_line(t) >= -error;
        let lowest = self.lowest_carrying(error);
        Rolls {
            low: lowest - last_within(FAR, |beyond| carries(lowest - beyond)),
            high: self.tip_roll + last_within(FAR, |beyond| carries(self.tip_roll + beyond)),
        }
    }

    /// A roll angle from which on ν only falls towards lower ones: where the start of the involute stands back from the
    /// rack's tip plane by `error`, if it stands back from the flank by no more, as it may again below the base circle.
    fn lowest_carrying(&self, error: f64) -> f64 {
        let reaches = |delta: f64| self.by_tip(self.start_roll, delta) >= -error;
        if !reaches(0.0) {
            return self.lowest_line();
        }
        let roll = self.start_roll - last_within(FAR, reaches);
        if self.beyond_line(roll) >= -error { roll } else { self.lowest_line() }
    }

    /// The largest distance of a point of contact from the contact line when the pair carries so, mm.
    pub(in crate::judge) fn off_line(&self, error: f64) -> f64 {
        let scale = self.base_radius / trig::sin(self.alpha_t);
        self.base_radius * (2.0 * error * self.tip_roll.max(0.1) / scale).sqrt()
    }
}

/// The end of the range from 0 in which a condition holds, rounded up.
fn last_within(farthest: f64, holds: impl Fn(f64) -> bool) -> f64 {
    end_between(0.0, farthest, holds).high
}

/// The end of the range in which a condition holds, from below and from above: it holds at the first roll angle and not at
/// the last.
fn end_between(first: f64, last: f64, holds: impl Fn(f64) -> bool) -> Rolls {
    let (mut low, mut high) = (first, last);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Rolls { low, high }
}

/// Roll angles from one to another.
#[derive(Debug, Clone, Copy)]
pub(in crate::judge) struct Rolls {
    pub(in crate::judge) low: f64,
    pub(in crate::judge) high: f64,
}
