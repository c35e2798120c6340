//! Where flanks that stand out from their neighbours carry: the more they stand out, the longer edges make their path of
//! contact. Made once for a pair; knows no error.

use super::field::{ContactPath, Field, line_distance, shift_rad, skew};
use super::profile::{Profile, Rolls};
use crate::gear::Pair;
use crate::trig;

/// Where a flank carries that stands out by `error` mm of centre distance more than its neighbours; edges lengthen its path.
#[derive(Debug)]
pub(super) struct Level {
    pub(super) error: f64,
    pub(super) field: Field,
    pub(super) path: ContactPath,
    /// The largest distance of its points of contact from the contact line, mm.
    pub(super) off_line: f64,
}

/// Levels in rising order, from flanks that do not stand out.
#[derive(Debug)]
pub(super) struct Levels(Vec<Level>);

/// The first level, mm, and the ratio from one to the next, up to four times the reach.
const FIRST_LEVEL_MM: f64 = 1e-5;
const LEVEL_RATIO: f64 = 1.2;
/// For lengths this near to a whole number of pitches the worse number is taken.
pub(super) const SLACK: f64 = 1e-9;

impl Levels {
    /// The levels of flanks that stand out up to four times the errors, which move ΔCD by `largest_mm` either way and lower it
    /// by up to `lowered_mm`.
    pub(super) fn new(pair: &Pair, lowered_mm: f64, largest_mm: f64) -> Self {
        let profile = Profile::new(pair, line_distance(pair), lowered_mm);
        let last = 4.0 * largest_mm;
        let shift = shift_rad(pair, largest_mm);
        let mut levels = Vec::new();
        let mut error = 0.0;
        loop {
            let carrying = profile.carrying(error);
            let rolls = Rolls { low: carrying.low - shift, high: carrying.high + shift };
            let off_line = 1.2 * profile.off_line(error);
            let wider = trig::sin(pair.shaft_angle_rad()).abs() * off_line + skew(pair, shift);
            let field = Field::new(pair, rolls, wider);
            let path = field.path();
            levels.push(Level { error, field, path, off_line });
            if error > last {
                return Self(levels);
            }
            error = if error == 0.0 { FIRST_LEVEL_MM } else { LEVEL_RATIO * error };
        }
    }

    /// Where flanks carry that stand out by up to `error` mm more than their neighbours.
    pub(super) fn level(&self, error: f64) -> &Level {
        self.0.iter().find(|level| level.error >= error).unwrap_or(&self.0[self.0.len() - 1])
    }

    /// The first level: flanks that do not stand out.
    pub(super) fn nominal(&self) -> &Level {
        &self.0[0]
    }

    /// The last level.
    pub(super) fn last(&self) -> &Level {
        &self.0[self.0.len() - 1]
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Level> {
        self.0.iter()
    }

    /// The least by which the two edges that end a path of at least the length `least` ask for less together: half of what each
    /// stands back. Infinite if no path is as long.
    pub(super) fn stands_back(&self, length: impl Fn(&ContactPath) -> f64, least: f64) -> f64 {
        let mut stands_back = f64::INFINITY;
        let before = |index: usize| if index == 0 { 0.0 } else { self.0[index - 1].error };
        for (index, one) in self.0.iter().enumerate() {
            // both ends of such a length are of one kind, so the length is the mean of those at both levels
            let long = |other: &Level| 0.5 * (length(&one.path) + length(&other.path)) + SLACK >= least;
            if let Some(other) = self.0.iter().position(long) {
                stands_back = stands_back.min(0.5 * (before(index) + before(other)));
            }
        }
        stands_back
    }
}
