//! What is kept of many racks: counts that merge to the same bits however racks are cut into ranges. Made of results by a
//! run, merged by whoever has several; it draws and solves nothing.

use std::fmt::{self, Write as _};

use super::counts::Counts;
use super::range::{RackRange, StudyError};
use super::yoke::YokeStudy;
use super::{RackResult, RackSettings, Racks};
use crate::judge::Limit;
use crate::quantity::{Length, tidy};

/// What the racks of a study are of: only studies of the same may be merged.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "report", serde(deny_unknown_fields))]
pub struct StudyOf {
    /// The version of the program that solved them.
    pub version: String,
    /// Of teeth, deviations, scatter and limit: the same for the same, whatever the text of the spec.
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

/// A study of racks with limits counts those inside, one of racks with a yoke what that does.
const COUNTED_OTHERS: &str =
    "it counts the racks inside limits, or their yokes, that are not those of its racks, or does not";

/// How ΔCD of many racks is distributed, and which racks these are.
///
/// It holds exact sums of the lengths on their grid of 1e-12 mm and of their squares, exact extremes, and counts in bins:
/// [`MOST_BINS`](super::MOST_BINS) at the most for each length, one to each length of the grid while these suffice, and
/// else as narrow as they can be. What it holds is a function of its racks: ranges and the order of
/// [`RacksStudy::merge`] change no bit.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "report", serde(deny_unknown_fields))]
pub struct RacksStudy {
    of: StudyOf,
    asked: RackRange,
    /// Apart from each other and in order.
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

    /// Adds the racks of another study of the same. What is asked for reaches from the first rack to the last one that
    /// either was asked for.
    ///
    /// # Errors
    /// [`StudyError`] if the other is of something else, has a rack that this one has, or if sums are too large; then
    /// this one is as it was.
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

    /// Says which racks are asked for, in place of what the ranges were.
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

    /// Whether it counts what racks with or without a limit and a yoke have.
    fn counts_as(&self, has_limit: bool, has_yoke: bool) -> bool {
        (self.inside.is_some(), self.yoke.is_some()) == (has_limit, has_yoke)
    }

    /// What its racks are of.
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

    /// The racks that are asked for and not there.
    #[must_use]
    pub fn missing(&self) -> Vec<RackRange> {
        let starts = std::iter::once(self.asked.first_rack).chain(self.ranges.iter().map(|range| range.end()));
        let ends = self.ranges.iter().map(|range| range.first_rack).chain(std::iter::once(self.asked.end()));
        starts.zip(ends).map(|(start, end)| RackRange::between(start, end)).filter(|gap| gap.racks > 0).collect()
    }

    /// Refuses what no run has made: for what was read.
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
    /// Whether it stays within the limits along the whole stroke.
    fn is_inside(&self, limit: &Limit) -> bool {
        limit.lower.map(Length::mm).is_none_or(|lower| lower <= tidy(self.min_mm))
            && limit.upper.map(Length::mm).is_none_or(|upper| tidy(self.max_mm) <= upper)
    }
}

/// The racks in both.
fn common(a: RackRange, b: RackRange) -> Option<RackRange> {
    let range = RackRange::between(a.first_rack.max(b.first_rack), a.end().min(b.end()));
    (range.racks > 0).then_some(range)
}

/// In order, and one where they touch.
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
mod tests {
    use proptest::prelude::*;

    use super::super::counts::MOST_BINS;
    use super::super::{RackYoke, RacksSummary};
    use super::*;
    use crate::function::Setting;
    use crate::judge::Verdict;
    use crate::trig;

    fn study_of(seed: u64) -> StudyOf {
        let (version, fingerprint) = ("1".to_owned(), "teeth".to_owned());
        StudyOf { version, fingerprint, seed, from_mm: 0.0, to_mm: 50.0 }
    }

    /// Lengths that no two racks share, spread over a twentieth of a millimetre.
    fn result(rack: u64) -> RackResult {
        let place = 0.02 * trig::sin((rack as f64) * 0.618_033_9);
        let setting = Setting { from_mm: 0.03 + place, to_mm: (!rack.is_multiple_of(3)).then_some(0.06 + 0.7 * place) };
        let yoke = RackYoke {
            settings: (!rack.is_multiple_of(5)).then(|| (!rack.is_multiple_of(7)).then_some(setting)),
            fluctuation_n_m: Some(0.5 + place),
            lift_off_n: Some(2000.0 + 1000.0 * place),
            verdicts: [None; 4],
        };
        RackResult { mean_mm: place, min_mm: place - 0.01, max_mm: 1.3 * place + 0.015, yoke: Some(yoke) }
    }

    fn limit() -> Limit {
        Limit { lower: None, upper: Some("0.04".parse().unwrap()) }
    }

    fn range(first_rack: u64, end: u64) -> RacksStudy {
        let results: Vec<_> = (first_rack..end).map(result).collect();
        RacksStudy::of(study_of(1), first_rack, &results, Some(&limit())).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2))]

        /// Any cuts, merged in any order and grouping: also where lengths need wider bins than those of a part.
        #[test]
        fn ranges_merge_to_what_one_run_has(
            cuts in proptest::collection::vec(0..70_000_u64, 0..6),
            order in any::<u64>(),
            is_grouped in any::<bool>(),
        ) {
            let mut cuts = cuts;
            cuts.extend([0, 70_000]);
            cuts.sort_unstable();
            let mut parts: Vec<_> = cuts.windows(2).filter(|two| two[0] < two[1]).map(|two| range(two[0], two[1])).collect();
            parts.sort_by_key(|part| part.asked().first_rack.wrapping_add(order).wrapping_mul(order | 1));
            let tail = parts.split_off(if is_grouped { parts.len() / 2 } else { parts.len() - 1 });
            let merged = |parts: &[RacksStudy]| {
                parts.split_first().map(|(first, others)| {
                    others.iter().fold(first.clone(), |mut all, part| {
                        all.merge(part).unwrap();
                        all
                    })
                })
            };
            let mut all = merged(&tail).unwrap();
            if let Some(head) = merged(&parts) {
                all.merge(&head).unwrap();
            }
            let one = range(0, 70_000);
            prop_assert!(one.mean.quantile_error_mm() > 0.0);
            prop_assert_eq!(RacksSummary::of(&all), RacksSummary::of(&one));
            prop_assert!(all == one);
        }
    }

    #[test]
    fn quantiles_are_as_exact_as_they_say() {
        for racks in [1, 2, 1000, MOST_BINS as u64, 70_000] {
            let study = range(0, racks);
            let mut sorted: Vec<f64> = (0..racks).map(|rack| tidy(result(rack).mean_mm)).collect();
            sorted.sort_unstable_by(f64::total_cmp);
            let summary = RacksSummary::of(&study).unwrap();
            let error = summary.mean.quantile_error_mm;
            assert_eq!(error > 0.0, racks > MOST_BINS as u64, "{racks}: {error}");
            // 0.04 mm in 2^15 bins at the least
            assert!(error <= 0.5 * 0.04 / 32_768.0, "{error}");
            for quantile in &summary.mean.quantiles {
                let rank = ((racks as f64 * quantile.share).ceil() as usize).max(1);
                let away = (quantile.value_mm - sorted[rank - 1]).abs();
                assert!(away <= error * (1.0 + 1e-9), "{racks}: {quantile:?} {away}");
            }
            let mean = sorted.iter().sum::<f64>() / racks as f64;
            let squares = sorted.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
            assert!((summary.mean.mean_mm - mean).abs() < 2e-12);
            match summary.mean.standard_deviation_mm {
                Some(found) => assert!((found - (squares / (racks as f64 - 1.0)).sqrt()).abs() < 2e-12),
                None => assert_eq!(racks, 1),
            }
            assert_eq!(summary.mean.histogram.iter().map(|bin| bin.racks).sum::<u64>(), racks);
            assert_eq!(summary.mean.histogram[0].from_mm, sorted[0]);
        }
    }

    /// More results than there are bins, each of its own length: what is held is that of so many bins.
    #[test]
    fn memory_does_not_grow_with_the_racks() {
        let mut study = RacksStudy::new(study_of(1), RackRange { first_rack: 0, racks: 300_000 }, true, true);
        for first in (0..300_000).step_by(20_000) {
            study.merge(&range(first, first + 20_000)).unwrap();
            for counts in [&study.mean, &study.peak_to_peak, &study.smallest, &study.largest] {
                assert!(counts.bins_held() <= MOST_BINS);
            }
        }
        assert_eq!((study.racks(), study.missing()), (300_000, Vec::new()));
        assert_eq!(study.ranges.len(), 1);
    }

    #[test]
    fn what_does_not_belong_together_is_refused_and_changes_nothing() {
        let mut study = range(0, 100);
        let before = study.clone();
        let refused = study.merge(&range(50, 150)).unwrap_err();
        assert_eq!(refused, StudyError::Overlap { both: RackRange { first_rack: 50, racks: 50 } });
        assert!(refused.to_string().contains("racks 50 … 99"), "{refused}");
        let other = RacksStudy::of(study_of(2), 100, &[result(100)], Some(&limit())).unwrap();
        let refused = study.merge(&other).unwrap_err().to_string();
        assert!(refused.contains("the seed is 1 in one and 2 in the other"), "{refused}");
        let fingerprint = "other teeth".to_owned();
        let other = RacksStudy::of(StudyOf { fingerprint, ..study_of(1) }, 100, &[result(100)], None).unwrap();
        assert!(study.merge(&other).unwrap_err().to_string().contains("fingerprint is teeth"));
        assert!(study == before);
        let without_count = RacksStudy { inside: None, ..range(100, 150) };
        assert!(matches!(study.merge(&without_count), Err(StudyError::Damaged { .. })));
        assert!(study == before);
        let far = RackResult { mean_mm: 1e300, ..result(0) };
        let refused = RacksStudy::of(study_of(1), 0, &[far], None).unwrap_err();
        assert_eq!(refused, StudyError::NoLength { length_mm: 1e300 });
        let far = RackResult { mean_mm: 1e5, ..result(0) };
        let refused = RacksStudy::of(study_of(1), 0, &vec![far; 20_000], None).unwrap_err();
        assert_eq!(refused, StudyError::TooMany);
    }

    #[test]
    fn a_gap_leaves_the_verdict_open_and_a_rack_outside_fails_all_the_same() {
        let mut study = range(0, 10);
        study.merge(&range(30, 40)).unwrap();
        let summary = RacksSummary::of(&study).unwrap();
        let gap = RackRange { first_rack: 10, racks: 20 };
        let is_inside = |rack| tidy(result(rack).max_mm) <= 0.04;
        assert!((0..10).chain(30..40).any(|rack| !is_inside(rack)));
        assert_eq!((summary.missing, summary.verdict), (vec![gap], Some(Verdict::Fail)));
        let calm = |first, count| {
            let calm = RackResult { max_mm: 0.03, ..result(0) };
            RacksStudy::of(study_of(1), first, &vec![calm; count], Some(&limit())).unwrap()
        };
        let mut study = calm(0, 10);
        assert_eq!(RacksSummary::of(&study).unwrap().verdict, Some(Verdict::Pass));
        study.merge(&calm(30, 10)).unwrap();
        assert_eq!(RacksSummary::of(&study).unwrap().verdict, None);
        study.merge(&calm(10, 20)).unwrap();
        assert_eq!(RacksSummary::of(&study).unwrap().verdict, Some(Verdict::Pass));
        study.ask(RackRange { first_rack: 0, racks: 50 }).unwrap();
        assert_eq!(RacksSummary::of(&study).unwrap().verdict, None);
        assert!(study.ask(RackRange { first_rack: 1, racks: 50 }).is_err());
    }
}
