//! One setting of the plug for many parts. Each part has an interval of settings; a sweep over the intervals' ends finds the
//! setting that the most parts share. Called for lots and for random racks.

use std::collections::BTreeMap;

use super::play::Setting;
use crate::quantity::{femtometres, of_femtometres};

/// A place, fm, and the number of intervals that start or end there.
type At = (i64, u64);

/// The settings of many parts, counted by the ends of their intervals.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Settings {
    /// The number of parts whose settings are known.
    pub parts: u64,
    /// The number of these that no setting suits.
    pub without: u64,
    starts: BTreeMap<i64, u64>,
    ends: BTreeMap<i64, u64>,
}

/// The settings that the most parts share, mm; each of them suits the same number of parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shared {
    /// The smallest.
    pub from_mm: f64,
    /// The largest; `None` if nothing limits it.
    pub to_mm: Option<f64>,
    /// The number of parts that they suit.
    pub parts: u64,
}

impl Settings {
    /// Counts the settings of a part.
    pub fn add(&mut self, setting: Option<Setting>) {
        self.parts += 1;
        let Some(Setting { from_mm, to_mm }) = setting else {
            self.without += 1;
            return;
        };
        // an end beyond the largest length counts as unlimited
        let place = |mm: f64| femtometres(mm).unwrap_or(if mm < 0.0 { i64::MIN } else { i64::MAX });
        *self.starts.entry(place(from_mm)).or_default() += 1;
        if let Some(to_mm) = to_mm {
            *self.ends.entry(place(to_mm)).or_default() += 1;
        }
    }

    /// Adds the counts of other parts.
    pub fn merge(&mut self, other: &Self) {
        self.parts += other.parts;
        self.without += other.without;
        for (mine, theirs) in [(&mut self.starts, &other.starts), (&mut self.ends, &other.ends)] {
            for (place, count) in theirs {
                *mine.entry(*place).or_default() += count;
            }
        }
    }

    /// The settings that the most parts share; of several, the widest, and of those the first. `None` if no part has any.
    #[must_use]
    pub fn shared(&self) -> Option<Shared> {
        let of = |ends: &BTreeMap<i64, u64>| ends.iter().map(|(place, count)| (*place, *count)).collect::<Vec<_>>();
        most_shared(&of(&self.starts), &of(&self.ends))
    }
}

impl Shared {
    /// The settings as those of one part.
    #[must_use]
    pub fn as_setting(&self) -> Setting {
        Setting { from_mm: self.from_mm, to_mm: self.to_mm }
    }

    /// The middle, farthest from both ends; the smallest if nothing limits the largest.
    #[must_use]
    pub fn middle_mm(&self) -> f64 {
        self.to_mm.map_or(self.from_mm, |to| 0.5 * (self.from_mm + to))
    }
}

/// For each start: the place, the next end, if there is one, and how many intervals cover the places between. Both lists are
/// in order; an interval contains its ends.
fn covered(starts: &[At], ends: &[At]) -> Vec<(i64, Option<i64>, i128)> {
    let (mut covered, mut ended, mut all) = (0, 0, Vec::with_capacity(starts.len()));
    for (start, count) in starts {
        while let Some((_, count)) = ends.get(ended).filter(|(end, _)| end < start) {
            covered -= i128::from(*count);
            ended += 1;
        }
        covered += i128::from(*count);
        all.push((*start, ends.get(ended).map(|(end, _)| *end), covered));
    }
    all
}

/// The places that the most intervals cover; of several, the widest, and of those the first.
pub(crate) fn most_shared(starts: &[At], ends: &[At]) -> Option<Shared> {
    let width = |from: i64, to: Option<i64>| to.map_or(i128::MAX, |to| i128::from(to) - i128::from(from));
    let best = covered(starts, ends).into_iter().reduce(|best, next| {
        let rank = |(from, to, count): (i64, Option<i64>, i128)| (count, width(from, to));
        if rank(next) > rank(best) { next } else { best }
    });
    let mm = |place: i64| of_femtometres(place as f64);
    best.map(|(from, to, count)| Shared {
        from_mm: mm(from),
        to_mm: to.map(mm),
        parts: u64::try_from(count).unwrap_or_default(),
    })
}

/// The first and the last place that at least `least` intervals cover, mm; `None` if there is none.
pub(crate) fn shared_by(starts: &[At], ends: &[At], least: u64) -> Option<(f64, Option<f64>)> {
    let enough: Vec<_> = covered(starts, ends).into_iter().filter(|(.., count)| *count >= least.into()).collect();
    let (first, last) = (enough.first()?, enough.last()?);
    // behind the last start with enough intervals, each end leaves fewer, until they are too few
    let mut left = last.2;
    let behind = ends.iter().filter(|(end, _)| *end >= last.0);
    let end = behind.into_iter().find(|(_, count)| {
        left -= i128::from(*count);
        left < i128::from(least)
    });
    let mm = |place: i64| of_femtometres(place as f64);
    Some((mm(first.0), end.map(|(end, _)| mm(*end))))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        /// No place is in more intervals than those found, and each place found is in as many.
        #[test]
        fn no_place_suits_more(intervals in prop::collection::vec((0..60_i32, 0..25_i32), 1..40), share in 0.0..1.0_f64) {
            let intervals: Vec<_> = intervals.iter().map(|(from, width)| (*from, from + width)).collect();
            let mut settings = Settings::default();
            settings.add(None);
            for (from, to) in &intervals {
                settings.add(Some(Setting { from_mm: f64::from(*from), to_mm: Some(f64::from(*to)) }));
            }
            let at = |place: f64| {
                intervals.iter().filter(|(from, to)| f64::from(*from) <= place && place <= f64::from(*to)).count()
            };
            let places: Vec<_> = (0..180).map(|half| 0.5 * f64::from(half)).collect();
            let most = places.iter().map(|place| at(*place)).max().unwrap();
            let Shared { from_mm, to_mm, parts } = settings.shared().unwrap();
            let to_mm = to_mm.unwrap();
            prop_assert_eq!((settings.parts, settings.without), (intervals.len() as u64 + 1, 1));
            prop_assert_eq!(parts as usize, most);
            prop_assert_eq!((at(from_mm), at(0.5 * (from_mm + to_mm)), at(to_mm)), (most, most, most));
            let widest = |from: f64| places.iter().copied().filter(|to| *to >= from).take_while(|to| at(*to) == most).last();
            let longest = places.iter().filter(|from| at(**from) == most).map(|from| widest(*from).unwrap() - from);
            prop_assert_eq!(longest.reduce(f64::max), Some(to_mm - from_mm));
            // every place that suits enough intervals lies within the hull, and the ends of the hull suit enough
            let least = (most as f64 * share).ceil().max(1.0) as usize;
            let lists = |ends: &BTreeMap<i64, u64>| ends.iter().map(|(place, count)| (*place, *count)).collect::<Vec<_>>();
            let (first, last) = shared_by(&lists(&settings.starts), &lists(&settings.ends), least as u64).unwrap();
            let enough: Vec<_> = places.iter().copied().filter(|place| at(*place) >= least).collect();
            prop_assert_eq!((Some(&first), last.as_ref()), (enough.first(), enough.last()));
            let mut halves = [Settings::default(), Settings::default()];
            halves[0].add(None);
            for (index, (from, to)) in intervals.iter().enumerate() {
                let setting = Setting { from_mm: f64::from(*from), to_mm: Some(f64::from(*to)) };
                halves[index % 2].add(Some(setting));
            }
            let [mut one, other] = halves;
            one.merge(&other);
            prop_assert!(one == settings);
        }
    }

    #[test]
    fn a_setting_without_an_upper_end_goes_on() {
        let mut settings = Settings::default();
        assert_eq!(settings.shared(), None);
        settings.add(None);
        assert_eq!(settings.shared(), None);
        settings.add(Some(Setting { from_mm: 0.02, to_mm: None }));
        settings.add(Some(Setting { from_mm: 0.01, to_mm: Some(0.03) }));
        assert_eq!(settings.shared(), Some(Shared { from_mm: 0.02, to_mm: Some(0.03), parts: 2 }));
        settings.add(Some(Setting { from_mm: 0.05, to_mm: None }));
        settings.add(Some(Setting { from_mm: 0.06, to_mm: None }));
        assert_eq!(settings.shared(), Some(Shared { from_mm: 0.06, to_mm: None, parts: 3 }));
    }
}
