//! The counts of many racks, which merge to the same bits however racks are cut into ranges. It draws and solves nothing.

use std::fmt::{self, Write as _};

use super::counts::Counts;
use super::range::{RackRange, StudyError};
use super::yoke::YokeStudy;
use super::{RackResult, RackSettings, Racks};
use crate::judge::Limit;
use crate::quantity::{Length, tidy};

/// The identity of a study: only studies with the same identity may be merged.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "report", serde(deny_unknown_fields))]
pub struct StudyOf {
    /// The version of the program that solved them.
    pub version: String,
    /// A hash of teeth, deviations, scatter and limit: equal for equal ones, whatever the text of the spec.
    pub fingerprint: String,
    /// The seed.
    #[cfg_attr(feature = "report", serde(with = "text"))]
    pub seed: u64,
    /// First stroke, mm.
    #[cfg_attr(feature = "report", serde(with = "text"))]
    pub from_mm: f64,
    /// Last stroke, mm.
    #[cfg_attr(feature = "report", serde(with = "text"))]
    pub to_mm: f64,
}

impl StudyOf {
    pub(super) fn new(racks: &Racks<'_>, settings: &RackSettings) -> Self {
        let RackSettings { seed, from_mm, to_mm, .. } = *settings;
        let Racks { base, scatter, limit, yoke } = racks;
        let mut print = Fingerprint::default();
        // it takes all text
        let _ = write!(print, "{base:?} {scatter:?} {limit:?}");
        if let Some(yoke) = yoke {
            let _ = write!(print, " {yoke:?}");
        }
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Self { version, fingerprint: format!("{:032x}", print.0), seed, from_mm, to_mm }
    }

    fn refuse_other(&self, other: &Self) -> Result<(), StudyError> {
        let stroke = |of: &Self| format!("{} … {} mm", of.from_mm, of.to_mm);
        let seed = |of: &Self| of.seed.to_string();
        let facts = [
            ("seed", seed(self), seed(other)),
            ("stroke", stroke(self), stroke(other)),
            ("version of rackmesh", self.version.clone(), other.version.clone()),
            ("spec's fingerprint", self.fingerprint.clone(), other.fingerprint.clone()),
        ];
        match facts.into_iter().find(|(_, here, there)| here != there) {
            Some((what, here, there)) => Err(StudyError::Other { what, here, there }),
            None => Ok(()),
        }
    }
}

/// FNV-1a of 128 bits, of all text that is written to it.
struct Fingerprint(u128);

impl Default for Fingerprint {
    fn default() -> Self {
        Self(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }
}

impl fmt::Write for Fingerprint {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        const PRIME: u128 = (1 << 88) + 0x13b;
        self.0 = text.bytes().fold(self.0, |hash, byte| (hash ^ u128::from(byte)).wrapping_mul(PRIME));
        Ok(())
    }
}

/// A study with limits counts the racks inside, one with a yoke the yoke's figures.
const COUNTED_OTHERS: &str =
    "it counts the racks inside limits, or their yokes, that are not those of its racks, or does not";

/// How ΔCD of many racks is distributed, and which racks these are.
///
/// It holds exact sums of the lengths on their grid of 1e-12 mm and of their squares, exact extremes, and counts in bins:
/// at most [`MOST_BINS`](super::MOST_BINS) for each length, one to each length of the grid while these suffice, else as narrow
/// as possible. The content is a function of the racks: ranges and the order of [`RacksStudy::merge`] change no bit.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "report", serde(deny_unknown_fields))]
pub struct RacksStudy {
    of: StudyOf,
    asked: RackRange,
    /// The ranges, disjoint and in order.
    ranges: Vec<RackRange>,
    /// The racks within the limits; `None` without limits.
    pub(super) inside: Option<u64>,
    pub(super) mean: Counts,
    pub(super) peak_to_peak: Counts,
    pub(super) smallest: Counts,
    pub(super) largest: Counts,
    /// `None` without a yoke.
    #[cfg_attr(feature = "report", serde(default, skip_serializing_if = "Option::is_none"))]
    pub(super) yoke: Option<YokeStudy>,
}

impl RacksStudy {
    /// A study without racks, of those `asked` for.
    pub(super) fn new(of: StudyOf, asked: RackRange, has_limit: bool, has_yoke: bool) -> Self {
        Self {
            of,
            asked,
            ranges: Vec::new(),
            inside: has_limit.then_some(0),
            mean: Counts::default(),
            peak_to_peak: Counts::default(),
            smallest: Counts::default(),
            largest: Counts::default(),
            yoke: has_yoke.then(YokeStudy::default),
        }
    }

    fn counts(&self) -> [&Counts; 4] {
        [&self.mean, &self.peak_to_peak, &self.smallest, &self.largest]
    }

    fn counts_mut(&mut self) -> [&mut Counts; 4] {
        [&mut self.mean, &mut self.peak_to_peak, &mut self.smallest, &mut self.largest]
    }

    /// The study of successive racks.
    ///
    /// # Errors
    /// [`StudyError`] if a ΔCD is no length, or if sums are too large.
    pub fn of(of: StudyOf, first_rack: u64, results: &[RackResult], limit: Option<&Limit>) -> Result<Self, StudyError> {
        let range = RackRange { first_rack, racks: results.len() as u64 };
        let mut study = Self::new(of, range, limit.is_some(), results.iter().any(|result| result.yoke.is_some()));
        study.ranges.extend((range.racks > 0).then_some(range));
        for result in results {
            let RackResult { mean_mm, min_mm, max_mm, yoke } = *result;
            let lengths_mm = [mean_mm, result.peak_to_peak_mm(), min_mm, max_mm];
            study.counts_mut().into_iter().zip(lengths_mm).try_for_each(|(counts, length)| counts.count(length))?;
            study.yoke.iter_mut().zip(yoke).try_for_each(|(study, yoke)| study.count(&yoke))?;
        }
        study.inside = limit.map(|limit| results.iter().filter(|result| result.is_inside(limit)).count() as u64);
        Ok(study)
    }

    /// Adds the racks of another study with the same identity. The racks asked for then reach from the first to the last one of
    /// both.
    ///
    /// # Errors
    /// [`StudyError`] if the other one has another identity or a rack in common, or if sums are too large; this one is then
    /// unchanged.
    pub fn merge(&mut self, other: &Self) -> Result<(), StudyError> {
        self.of.refuse_other(&other.of)?;
        if !self.counts_as(other.inside.is_some(), other.yoke.is_some()) {
            return Err(StudyError::Damaged { what: COUNTED_OTHERS });
        }
        let both = self.ranges.iter().flat_map(|mine| other.ranges.iter().map(|theirs| common(*mine, *theirs)));
        if let Some(both) = both.into_iter().flatten().next() {
            return Err(StudyError::Overlap { both });
        }
        let takes = self.counts().into_iter().zip(other.counts()).all(|(mine, theirs)| mine.takes(theirs));
        let mut yokes = self.yoke.iter().zip(&other.yoke);
        if !takes || yokes.any(|(mine, theirs)| !mine.takes(theirs)) {
            return Err(StudyError::TooMany);
        }
        for (mine, theirs) in self.counts_mut().into_iter().zip(other.counts()) {
            mine.merge(theirs);
        }
        self.yoke.iter_mut().zip(&other.yoke).for_each(|(mine, theirs)| mine.merge(theirs));
        self.inside = self.inside.zip(other.inside).map(|(mine, theirs)| mine + theirs);
        self.ranges = joined(self.ranges.iter().chain(&other.ranges).copied().collect());
        let (mine, theirs) = (self.asked, other.asked);
        self.asked = RackRange::between(mine.first_rack.min(theirs.first_rack), mine.end().max(theirs.end()));
        Ok(())
    }

    /// Sets the racks that are asked for, in place of those of the ranges.
    ///
    /// # Errors
    /// [`StudyError::NotAsked`] if it has others.
    pub fn ask(&mut self, asked: RackRange) -> Result<(), StudyError> {
        let is_other = |has: &&RackRange| has.first_rack < asked.first_rack || has.end() > asked.end();
        if let Some(has) = self.ranges.iter().find(is_other) {
            return Err(StudyError::NotAsked { has: *has, asked });
        }
        self.asked = asked;
        Ok(())
    }

    /// Refuses a study that is not of these racks, whatever their seed and stroke.
    ///
    /// # Errors
    /// [`StudyError`] says what differs.
    pub fn refuse_other_racks(&self, racks: &Racks<'_>) -> Result<(), StudyError> {
        let StudyOf { seed, from_mm, to_mm, .. } = self.of;
        let settings = RackSettings { seed, range: self.asked, from_mm, to_mm, threads: None };
        StudyOf::new(racks, &settings).refuse_other(&self.of)?;
        if !self.counts_as(racks.limit.is_some(), racks.yoke.is_some()) {
            return Err(StudyError::Damaged { what: COUNTED_OTHERS });
        }
        Ok(())
    }

    /// Whether its counts match a limit and a yoke, present or not.
    fn counts_as(&self, has_limit: bool, has_yoke: bool) -> bool {
        (self.inside.is_some(), self.yoke.is_some()) == (has_limit, has_yoke)
    }

    /// The identity of its racks.
    #[must_use]
    pub fn study_of(&self) -> &StudyOf {
        &self.of
    }

    /// How many racks it has.
    #[must_use]
    pub fn racks(&self) -> u64 {
        self.mean.racks()
    }

    /// The racks that are asked for.
    #[must_use]
    pub fn asked(&self) -> RackRange {
        self.asked
    }

    /// The racks that are asked for and missing.
    #[must_use]
    pub fn missing(&self) -> Vec<RackRange> {
        let starts = std::iter::once(self.asked.first_rack).chain(self.ranges.iter().map(|range| range.end()));
        let ends = self.ranges.iter().map(|range| range.first_rack).chain(std::iter::once(self.asked.end()));
        starts.zip(ends).map(|(start, end)| RackRange::between(start, end)).filter(|gap| gap.racks > 0).collect()
    }

    /// Refuses a study that was read and that no run can have made.
    ///
    /// # Errors
    /// [`StudyError::Damaged`] says what does not agree.
    #[cfg(feature = "report")]
    pub(crate) fn check(&self) -> Result<(), StudyError> {
        let damaged = |what| Err(StudyError::Damaged { what });
        let all = self.counts();
        let is_whole = |range: &RackRange| range.racks > 0 && range.first_rack.checked_add(range.racks).is_some();
        if !all.iter().all(|counts| counts.is_sound()) {
            return damaged("counts, sums and extremes do not belong together");
        }
        let in_order = self.ranges.windows(2).all(|two| two[0].end() < two[1].first_rack);
        if !in_order || !self.ranges.iter().all(is_whole) || !is_whole(&self.asked) {
            return damaged("its ranges of racks are not apart and in order");
        }
        if self.ranges.iter().any(|range| common(*range, self.asked) != Some(*range)) {
            return damaged("it has racks that were not asked for");
        }
        let racks: u64 = self.ranges.iter().map(|range| range.racks).sum();
        if all.iter().any(|counts| counts.racks() != racks)
            || self.inside.is_some_and(|inside| inside > racks)
            || self.yoke.as_ref().is_some_and(|yoke| !yoke.is_sound(racks))
        {
            return damaged("its ranges and its counts have different numbers of racks");
        }
        Ok(())
    }
}

impl RackResult {
    /// Whether a rack stays within the limits along the whole stroke.
    pub(super) fn is_inside(&self, limit: &Limit) -> bool {
        limit.lower.map(Length::mm).is_none_or(|lower| lower <= tidy(self.min_mm))
            && limit.upper.map(Length::mm).is_none_or(|upper| tidy(self.max_mm) <= upper)
    }
}

/// The racks in both.
fn common(a: RackRange, b: RackRange) -> Option<RackRange> {
    let range = RackRange::between(a.first_rack.max(b.first_rack), a.end().min(b.end()));
    (range.racks > 0).then_some(range)
}

/// The ranges in order; ranges that touch become one.
fn joined(mut ranges: Vec<RackRange>) -> Vec<RackRange> {
    ranges.sort_unstable_by_key(|range| range.first_rack);
    let mut all: Vec<RackRange> = Vec::with_capacity(ranges.len());
    for range in ranges {
        match all.last_mut().filter(|last| last.end() == range.first_rack) {
            Some(last) => last.racks += range.racks,
            None => all.push(range),
        }
    }
    all
}

/// Numbers as text: programs keep no more than 53 bits of those of JSON.
#[cfg(feature = "report")]
pub(super) mod text {
    use std::fmt::Display;
    use std::str::FromStr;

    use serde::de::Error as _;
    use serde::{Deserialize as _, Deserializer, Serializer};

    pub(crate) fn serialize<T: Display, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(value)
    }

    pub(crate) fn deserialize<'de, T: FromStr<Err: Display>, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<T, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests;
