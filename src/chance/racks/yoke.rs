//! Counts of a yoke's figures on many racks, which merge to the same bits in any order. A study fills them, its summary reads
//! them; they solve nothing.

use super::counts::Counts;
use super::range::StudyError;
use crate::function::{JudgedYoke, Setting, Shared, Target, YokeJudge, most_shared, shared_by};
use crate::judge::Verdict;

/// How random racks with a yoke are judged.
#[derive(Debug, Clone, Copy)]
pub struct RacksYoke<'a> {
    /// The yoke and its limits.
    pub judge: &'a YokeJudge,
    /// Whether every flank that carries was measured, of parts that were.
    pub is_measured: bool,
}

/// The figures of a yoke on one rack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RackYoke {
    /// Plays that keep the window: `Some(None)` if none does, `None` if that is not known.
    pub settings: Option<Option<Setting>>,
    /// Fluctuation of the pinion's torque, the larger one of both directions, N m.
    pub fluctuation_n_m: Option<f64>,
    /// The least force along the stroke at which a flank unloads, N.
    pub lift_off_n: Option<f64>,
    /// The verdicts on the limits, in the order of [`Target::ALL`].
    pub verdicts: [Option<Verdict>; Target::ALL.len()],
}

impl From<&JudgedYoke> for RackYoke {
    fn from(yoke: &JudgedYoke) -> Self {
        let forces = yoke.function.as_ref().and_then(|function| function.forces.as_ref());
        Self {
            settings: yoke.settings_known(),
            fluctuation_n_m: forces.map(|at| at.rising.fluctuation_n_m().max(at.falling.fluctuation_n_m())),
            lift_off_n: forces.map(|at| at.lift_off_n.smallest),
            verdicts: Target::ALL.map(|on| yoke.verdict_on(on)),
        }
    }
}

/// Newtons of a kilonewton: forces are counted in kN, so that the squares of many have room.
pub(super) const N: f64 = 1000.0;

/// Counts of a yoke's figures on the racks of a study.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "report", serde(deny_unknown_fields))]
pub(super) struct YokeStudy {
    /// Racks that no setting suits.
    pub(super) without: u64,
    /// The smallest play that suits each of the others, mm.
    starts: Counts,
    /// The largest play of racks that have one, mm.
    ends: Counts,
    /// N m.
    pub(super) fluctuation: Counts,
    /// kN.
    pub(super) lift_off: Counts,
    /// Racks that keep each limit.
    kept: [u64; Target::ALL.len()],
    /// Racks that do not keep each limit.
    broken: [u64; Target::ALL.len()],
}

impl YokeStudy {
    fn counts(&self) -> [&Counts; 4] {
        [&self.starts, &self.ends, &self.fluctuation, &self.lift_off]
    }

    /// Counts a rack.
    pub(super) fn count(&mut self, yoke: &RackYoke) -> Result<(), StudyError> {
        match yoke.settings {
            Some(Some(Setting { from_mm, to_mm })) => {
                self.starts.count(from_mm)?;
                to_mm.map_or(Ok(()), |to| self.ends.count(to))?;
            }
            Some(None) => self.without += 1,
            None => {}
        }
        yoke.fluctuation_n_m.map_or(Ok(()), |n_m| self.fluctuation.count(n_m))?;
        yoke.lift_off_n.map_or(Ok(()), |n| self.lift_off.count(n / N))?;
        for ((verdict, kept), broken) in yoke.verdicts.iter().zip(&mut self.kept).zip(&mut self.broken) {
            *kept += u64::from(*verdict == Some(Verdict::Pass));
            *broken += u64::from(verdict.is_some_and(|verdict| verdict != Verdict::Pass));
        }
        Ok(())
    }

    /// Whether the sums with another study do not overflow.
    pub(super) fn takes(&self, other: &Self) -> bool {
        self.counts().into_iter().zip(other.counts()).all(|(mine, theirs)| mine.takes(theirs))
    }

    /// Adds the racks of another study.
    pub(super) fn merge(&mut self, other: &Self) {
        let mine = [&mut self.starts, &mut self.ends, &mut self.fluctuation, &mut self.lift_off];
        mine.into_iter().zip(other.counts()).for_each(|(mine, theirs)| mine.merge(theirs));
        self.without += other.without;
        let mine = self.kept.iter_mut().chain(&mut self.broken);
        mine.zip(other.kept.iter().chain(&other.broken)).for_each(|(mine, theirs)| *mine += theirs);
    }

    /// Racks that keep each limit, and those that do not.
    pub(super) fn by_limit(&self) -> [(u64, u64); Target::ALL.len()] {
        std::array::from_fn(|index| (self.kept[index], self.broken[index]))
    }

    /// The same of the limits that any rack was judged by.
    pub(super) fn judged(&self) -> impl Iterator<Item = (u64, u64)> {
        self.by_limit().into_iter().filter(|(kept, broken)| kept + broken > 0)
    }

    /// The number of racks with known settings.
    pub(super) fn known(&self) -> u64 {
        self.without + self.starts.racks()
    }

    /// The settings that suit the most racks. Ends of bins are rounded so that no rack counts that is not suited.
    pub(super) fn shared(&self) -> Option<Shared> {
        most_shared(&self.starts.places(|span| span.last_fm), &self.ends.places(|span| span.first_fm))
    }

    /// From the first to the last setting that suits so many racks.
    pub(super) fn shared_by(&self, racks: u64) -> Option<Setting> {
        let ends = self.ends.places(|span| span.last_fm);
        let (from_mm, to_mm) = shared_by(&self.starts.places(|span| span.first_fm), &ends, racks)?;
        Some(Setting { from_mm, to_mm })
    }

    /// Whether counts that were read could have been made from so many racks.
    #[cfg(feature = "report")]
    pub(super) fn is_sound(&self, racks: u64) -> bool {
        let sum = |a: u64, b: u64| a.checked_add(b).is_some_and(|sum| sum <= racks);
        self.counts().iter().all(|counts| counts.is_sound() && counts.racks() <= racks)
            && sum(self.without, self.starts.racks())
            && self.ends.racks() <= self.starts.racks()
            && self.kept.iter().zip(&self.broken).all(|(kept, broken)| sum(*kept, *broken))
    }
}
