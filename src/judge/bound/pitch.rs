//! How many steps between teeth can act at once. Read by the bound; knows counts only, no lengths of errors.

use super::{ContactPath, Extent};
use crate::deviation::Part;

/// How many times the value of one step ΔCD can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Steps {
    pub(super) raw: i32,
    pub(super) lower: i32,
    pub(super) upper: i32,
}

/// Counts at paths of contact this near to a whole number are taken for the worse.
const SLACK: f64 = 1e-9;

#[expect(clippy::cast_possible_truncation, reason = "a few teeth")]
fn whole(pitches: f64) -> i32 {
    pitches.floor().clamp(-1e6, 1e6) as i32
}

impl Steps {
    /// Without geometry only one step has a bound.
    pub(super) fn of_one(both_flanks: bool) -> Self {
        Self { raw: -1, lower: if both_flanks { 0 } else { -1 }, upper: 1 }
    }

    /// Of a path on which lines carry, if that is always so, and of one on which edges do.
    pub(super) fn new(part: Part, extent: Extent, grows: bool, line: Option<&ContactPath>, edge: &ContactPath) -> Self {
        let steps = match part {
            Part::Rack if extent != Extent::Each => Self::of_rack(grows, line, edge),
            Part::Rack => {
                let (one, other) = (Self::of_rack(true, line, edge), Self::of_rack(false, line, edge));
                let upper = one.upper.max(other.upper).max(0);
                let sinks = !line.is_some_and(ContactPath::has_both_flanks_of_a_rack_tooth);
                Self { raw: -upper, lower: if sinks { -upper } else { 0 }, upper }
            }
            Part::Pinion => {
                let (up, down) = (edge.ratio + 2.0 * edge.offset - 1.0, edge.ratio - 2.0 * edge.offset + 1.0);
                let upper = whole(up.max(down) + SLACK).max(0);
                let sinks = !line.is_some_and(ContactPath::has_both_flanks_of_a_pinion_tooth);
                Self { raw: -upper, lower: if sinks { -upper } else { 0 }, upper }
            }
        };
        match extent {
            Extent::One => steps.within(-1, 1),
            Extent::Part => steps.within(i32::MIN, i32::MAX),
            Extent::All | Extent::Each | Extent::Total => steps,
        }
    }

    /// Every pitch of the rack longer, or shorter: ΔCD is max R − min L steps, or max L − min R.
    fn of_rack(grows: bool, line: Option<&ContactPath>, edge: &ContactPath) -> Self {
        let sign = if grows { -1.0 } else { 1.0 };
        let raw = -whole(edge.ratio - sign * 2.0 * edge.offset + SLACK);
        let lower = line.map_or(raw, |line| whole(line.ratio + sign * 2.0 * line.offset - SLACK) - 1);
        Self { raw, lower: lower.max(raw), upper: whole(edge.ratio + sign * 2.0 * edge.offset + SLACK) }
    }

    /// The same where the steps need not act.
    fn within(self, least: i32, most: i32) -> Self {
        let limited = |count: i32| count.clamp(least, most);
        Self { raw: limited(self.raw.min(0)), lower: limited(self.lower.min(0)), upper: limited(self.upper.max(0)) }
    }
}
