//! One length of many racks, counted: exact moments, exact extremes, and bins for quantiles. A study fills it.
//!
//! The content depends on the lengths only, not on their order or on ranges: sums are of whole numbers, and bins are the finest
//! for which [`MOST_BINS`] suffice. Each width is twice the one before, so that two bins make one of the next; the first
//! lengths never need wider bins than all together.

use std::collections::BTreeMap;

use super::range::StudyError;
#[cfg(feature = "report")]
use crate::quantity::LARGEST;
use crate::quantity::{femtometres, of_femtometres};
use crate::statistics::LengthMoments;

/// The most bins. Up to so many racks have exact quantiles, whatever their lengths.
pub const MOST_BINS: usize = 1 << 16;
/// The most doublings of a bin's width: one bin then takes all lengths of a sign.
#[cfg(feature = "report")]
const MOST_DOUBLINGS: u32 = 60;

/// Lengths on their grid, counted.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "report", serde(deny_unknown_fields))]
pub(super) struct Counts {
    racks: u64,
    /// Σx, in fm.
    #[cfg_attr(feature = "report", serde(with = "super::study::text"))]
    sum_fm: i128,
    /// Σx², in fm².
    #[cfg_attr(feature = "report", serde(with = "super::study::text"))]
    squares_fm2: i128,
    least_fm: i64,
    most_fm: i64,
    /// A bin is 2^doublings femtometres wide.
    doublings: u32,
    /// Counts by the number of the bin; bin 0 starts at 0.
    bins: BTreeMap<i64, u64>,
}

impl Default for Counts {
    fn default() -> Self {
        let (least_fm, most_fm) = (i64::MAX, i64::MIN);
        Self { racks: 0, sum_fm: 0, squares_fm2: 0, least_fm, most_fm, doublings: 0, bins: BTreeMap::new() }
    }
}

/// The lengths that a bin may hold, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) first_fm: i64,
    pub(super) last_fm: i64,
}

impl Span {
    /// Twice the middle: a whole number.
    pub(super) fn twice_middle_fm(self) -> i64 {
        self.first_fm + self.last_fm
    }
}

/// Lengths from and to the next place in a histogram.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Bin {
    /// Where it starts, mm.
    pub from_mm: f64,
    /// Where it ends, mm.
    pub to_mm: f64,
    /// How many racks are in it.
    pub racks: u64,
}

impl Counts {
    /// Counts a length in mm.
    pub(super) fn count(&mut self, length_mm: f64) -> Result<(), StudyError> {
        let fm = femtometres(length_mm).ok_or(StudyError::NoLength { length_mm })?;
        let one = Self {
            racks: 1,
            sum_fm: fm.into(),
            squares_fm2: i128::from(fm) * i128::from(fm),
            least_fm: fm,
            most_fm: fm,
            doublings: 0,
            bins: BTreeMap::from([(fm, 1)]),
        };
        if !self.takes(&one) {
            return Err(StudyError::TooMany);
        }
        self.merge(&one);
        Ok(())
    }

    /// Whether the sums with another count do not overflow.
    pub(super) fn takes(&self, other: &Self) -> bool {
        self.racks.checked_add(other.racks).is_some()
            && self.sum_fm.checked_add(other.sum_fm).is_some()
            && self.squares_fm2.checked_add(other.squares_fm2).is_some()
    }

    /// Adds the racks of another count.
    pub(super) fn merge(&mut self, other: &Self) {
        self.racks += other.racks;
        self.sum_fm += other.sum_fm;
        self.squares_fm2 += other.squares_fm2;
        self.least_fm = self.least_fm.min(other.least_fm);
        self.most_fm = self.most_fm.max(other.most_fm);
        self.widen(other.doublings);
        for (bin, count) in &other.bins {
            *self.bins.entry(bin >> (self.doublings - other.doublings)).or_default() += count;
            if self.bins.len() > MOST_BINS {
                self.widen(self.doublings + 1);
            }
        }
    }

    /// Widens the bins to at least this width, and to at most [`MOST_BINS`] of them.
    fn widen(&mut self, least_doublings: u32) {
        let mut least = least_doublings;
        while self.doublings < least {
            let by = least - self.doublings;
            let mut wider: Vec<(i64, u64)> = Vec::with_capacity(self.bins.len());
            for (bin, count) in std::mem::take(&mut self.bins) {
                match wider.last_mut().filter(|(last, _)| *last == bin >> by) {
                    Some((_, sum)) => *sum += count,
                    None => wider.push((bin >> by, count)),
                }
            }
            self.bins = wider.into_iter().collect();
            self.doublings = least;
            least += u32::from(self.bins.len() > MOST_BINS);
        }
    }

    pub(super) fn racks(&self) -> u64 {
        self.racks
    }

    #[cfg(test)]
    pub(super) fn bins_held(&self) -> usize {
        self.bins.len()
    }

    /// How far a quantile may be off, mm: half a bin; 0 where each bin is one length of the grid.
    pub(super) fn quantile_error_mm(&self) -> f64 {
        of_femtometres(0.5 * ((1_i64 << self.doublings) - 1) as f64)
    }

    pub(super) fn moments(&self) -> LengthMoments {
        LengthMoments { count: self.racks, sum_fm: self.sum_fm, squares_fm2: Some(self.squares_fm2) }
    }

    fn span(&self, bin: i64) -> Span {
        let first = bin << self.doublings;
        let last = first + ((1_i64 << self.doublings) - 1);
        Span { first_fm: first.max(self.least_fm), last_fm: last.min(self.most_fm) }
    }

    /// Where the value with this rank, from 1, lies; `None` if no value has it.
    pub(super) fn at_rank(&self, rank: u64) -> Option<Span> {
        let mut below = rank.checked_sub(1)?;
        for (bin, count) in &self.bins {
            if below < *count {
                return Some(self.span(*bin));
            }
            below -= count;
        }
        None
    }

    /// A place of each bin, fm, and how many are in it.
    pub(super) fn places(&self, of: impl Fn(Span) -> i64) -> Vec<(i64, u64)> {
        self.bins.iter().map(|(bin, count)| (of(self.span(*bin)), *count)).collect()
    }

    /// So many bins of the same width from the smallest to the largest value.
    pub(super) fn histogram(&self, bins: u32) -> Vec<Bin> {
        if self.racks == 0 {
            return Vec::new();
        }
        let (low, high) = (i128::from(self.least_fm), i128::from(self.most_fm));
        let bins = if low == high { 1 } else { i128::from(bins) };
        let edge = |bin: i128| of_femtometres(low as f64 + ((high - low) * bin) as f64 / bins as f64);
        let mut found: Vec<_> =
            (0..bins).map(|bin| Bin { from_mm: edge(bin), to_mm: edge(bin + 1), racks: 0 }).collect();
        for (bin, count) in &self.bins {
            let twice_from_low = i128::from(self.span(*bin).twice_middle_fm()) - 2 * low;
            let place = twice_from_low * bins / (2 * (high - low)).max(1);
            // the largest value ends the last bin
            found[(place as usize).min(bins as usize - 1)].racks += count;
        }
        found
    }

    /// Whether a count that was read could have been made by counting.
    #[cfg(feature = "report")]
    pub(super) fn is_sound(&self) -> bool {
        let (Some((first, _)), Some((last, _))) = (self.bins.first_key_value(), self.bins.last_key_value()) else {
            return *self == Self::default();
        };
        let counted = self.bins.values().try_fold(0_u64, |sum, count| sum.checked_add(*count));
        let reach = i128::from(self.least_fm).abs().max(i128::from(self.most_fm).abs());
        counted == Some(self.racks)
            && self.bins.values().all(|count| *count > 0)
            && self.bins.len() <= MOST_BINS
            && self.doublings <= MOST_DOUBLINGS
            && reach <= i128::from(LARGEST)
            && self.least_fm >> self.doublings == *first
            && self.most_fm >> self.doublings == *last
            && (0..=i128::from(self.racks).saturating_mul(reach * reach)).contains(&self.squares_fm2)
            && self.sum_fm >= i128::from(self.racks) * i128::from(self.least_fm)
            && self.sum_fm <= i128::from(self.racks) * i128::from(self.most_fm)
    }
}
