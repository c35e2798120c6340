//! Statistics of a column of results in one pass and bounded memory.
//!
//! Count, smallest, largest, sum and sum of squares are exact, in integers of 1e-12 mm: mean and standard
//! deviation are rounded once, do not depend on the order or number of workers, and do not lose digits
//! where the spread is small against the mean. Quantiles come from a histogram whose bins are at most 1/1024 of their values
//! wide, so they are within 0.05 % of a value. The test for a normal distribution needs the values themselves, which are
//! kept up to a limit.

use crate::quantity::{FM_PER_MM, Length, tidy};
use crate::statistics::capability::{FEWEST_PARTS, Normality};
use crate::statistics::{LengthMoments, quantile_place};

/// Bits of a magnitude behind its leading one that tell its bin: bins are 1/1024 of their values wide at most.
const BIN_BITS: u32 = 10;

/// The most values that are kept and tested for a normal distribution.
pub const MOST_TESTED: usize = 100_000;

/// Statistics of values given some at a time.
#[derive(Debug, Clone)]
pub struct Statistics {
    moments: LengthMoments,
    smallest: i64,
    largest: i64,
    histogram: Histogram,
    /// The values, 1e-12 mm; `None` where they are not wanted, or too many.
    values: Option<Vec<i64>>,
    /// Sum of the variances that measuring contributes, in (1e-12 mm)², and the number of values in it.
    gauge: (u128, u64),
    /// The differences from value to value, where they are wanted.
    pub(super) moving: MovingRange,
}

/// The differences of successive values, for a chunk of them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MovingRange {
    /// The first and the last value.
    ends: Option<(i64, i64)>,
    sum: u128,
    count: u64,
}

impl MovingRange {
    /// Takes the next value.
    #[inline]
    pub(super) fn add(&mut self, value: Length) {
        self.take(value.fm());
    }

    #[inline]
    fn take(&mut self, units: i64) {
        if let Some((_, last)) = &mut self.ends {
            self.sum += u128::from(last.abs_diff(units));
            self.count += 1;
            *last = units;
        } else {
            self.ends = Some((units, units));
        }
    }

    /// Takes the values that follow.
    pub(super) fn join(&mut self, next: &Self) {
        let Some((first, last)) = next.ends else { return };
        self.take(first);
        self.sum += next.sum;
        self.count += next.count;
        if let Some(ends) = &mut self.ends {
            ends.1 = last;
        }
    }
}

/// The quantiles that are reported.
pub const QUANTILES: [f64; 9] = [0.00135, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 0.99865];

impl Default for Statistics {
    /// Statistics without values.
    fn default() -> Self {
        Self {
            moments: LengthMoments::default(),
            smallest: i64::MAX,
            largest: i64::MIN,
            histogram: Histogram::default(),
            values: None,
            gauge: (0, 0),
            moving: MovingRange::default(),
        }
    }
}

impl Statistics {
    /// Statistics without values so far, which keep each value.
    pub(super) fn of_kept_values() -> Self {
        Self { values: Some(Vec::new()), ..Self::default() }
    }

    /// Keeps more values, if values are kept and these are not too many.
    fn keep(&mut self, more: impl ExactSizeIterator<Item = i64>) {
        self.values = self.values.take().filter(|values| values.len() + more.len() <= MOST_TESTED);
        self.values.iter_mut().for_each(|values| values.reserve(more.len()));
        if let Some(values) = &mut self.values {
            values.extend(more);
        }
    }

    /// Takes values.
    pub(super) fn add(&mut self, values: &[Length]) {
        self.moments.merge(&LengthMoments::of(values));
        let (mut smallest, mut largest) = (self.smallest, self.largest);
        for units in values.iter().map(|value| value.fm()) {
            (smallest, largest) = (smallest.min(units), largest.max(units));
            self.histogram.add(units);
        }
        (self.smallest, self.largest) = (smallest, largest);
        self.keep(values.iter().map(|value| value.fm()));
    }

    /// Takes the contribution of measuring to the variance of a value, mm².
    pub(super) fn add_gauge(&mut self, variance_mm2: f64) {
        /// (1e-12 mm)² in a mm².
        const SCALE: f64 = 1e24;
        let units = (variance_mm2 * SCALE) as u128;
        self.gauge = (self.gauge.0.saturating_add(units), self.gauge.1 + 1);
    }

    /// The standard uncertainty of a value from measuring alone, mm: the root of the mean of the variances; `None`
    /// where no uncertainty is given.
    #[must_use]
    pub fn gauge_mm(&self) -> Option<f64> {
        let (sum, count) = self.gauge;
        (count > 0).then(|| 1e-12 * (sum as f64 / count as f64).sqrt())
    }

    /// The mean moving range, of the magnitudes of the differences of successive values, mm; `None` where these are not wanted,
    /// or with fewer than two values.
    #[must_use]
    pub fn moving_range_mm(&self) -> Option<f64> {
        let MovingRange { sum, count, .. } = self.moving;
        (count > 0).then(|| 1e-12 * (sum as f64 / count as f64))
    }

    /// Whether the values look normally distributed; `None` where there are fewer than ten or more than
    /// [`MOST_TESTED`], or where they are all the same.
    #[must_use]
    pub fn normality(&self) -> Option<Normality> {
        let (mean, deviation) = self.moments.mean_fm().zip(self.moments.standard_deviation_fm())?;
        let kept = self.values.as_ref().filter(|values| values.len() >= FEWEST_PARTS && deviation > 0.0)?;
        let mut values: Vec<_> = kept.iter().map(|value| *value as f64).collect();
        Some(Normality::of_values(&mut values, mean, deviation))
    }

    /// Merges another one.
    pub(super) fn merge(&mut self, other: &Self) {
        self.smallest = self.smallest.min(other.smallest);
        self.largest = self.largest.max(other.largest);
        self.moments.merge(&other.moments);
        self.gauge = (self.gauge.0.saturating_add(other.gauge.0), self.gauge.1 + other.gauge.1);
        match &other.values {
            Some(more) => self.keep(more.iter().copied()),
            None => self.values = None,
        }
        if other.count() > 0 {
            self.histogram.merge(&other.histogram, other.smallest, other.largest);
        }
    }

    /// How many values there are.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.moments.count
    }

    /// The smallest value, mm; `None` without values.
    #[must_use]
    pub fn min_mm(&self) -> Option<f64> {
        (self.count() > 0).then(|| millimetres(self.smallest))
    }

    /// The largest value, mm.
    #[must_use]
    pub fn max_mm(&self) -> Option<f64> {
        (self.count() > 0).then(|| millimetres(self.largest))
    }

    /// The mean, mm.
    #[must_use]
    pub fn mean_mm(&self) -> Option<f64> {
        self.moments.mean_fm().map(|mean| mean / FM_PER_MM)
    }

    /// The standard deviation s (of a sample, with n - 1), mm; `None` below two values, or if they are so large that
    /// their squares cannot be summed.
    #[must_use]
    pub fn standard_deviation_mm(&self) -> Option<f64> {
        self.moments.standard_deviation_fm().map(|deviation| deviation / FM_PER_MM)
    }

    /// The quantile of a share `q`, mm: interpolated between the order statistics about rank 1 + (n − 1) q, each to 0.05 %.
    #[must_use]
    pub fn quantile_mm(&self, q: f64) -> Option<f64> {
        if self.count() == 0 {
            return None;
        }
        let (before, share) = quantile_place(q, self.count());
        let low = self.order_statistic_mm(before);
        Some(if share > 0.0 { tidy(low + share * (self.order_statistic_mm(before + 1) - low)) } else { low })
    }

    /// The value that so many values lie before, mm, to 0.05 %; the smallest and the largest are exact.
    fn order_statistic_mm(&self, before: u64) -> f64 {
        let (smallest, largest) = (millimetres(self.smallest), millimetres(self.largest));
        if before == 0 {
            return smallest;
        }
        if before + 1 >= self.count() {
            return largest;
        }
        let mut counted = 0;
        let reaches = |&(_, count): &(f64, u64)| {
            counted += count;
            counted > before
        };
        self.bins().find(reaches).map_or(largest, |(value, _)| value.clamp(smallest, largest))
    }

    /// The middle of each bin that is not empty, mm, and its count.
    fn bins(&self) -> impl Iterator<Item = (f64, u64)> {
        self.histogram.between(self.smallest, self.largest)
    }

    /// The values between two ends (mm) counted in bins of equal width; a value within 0.05 % of the edge of
    /// a bin may be counted in its neighbour.
    #[must_use]
    pub fn histogram(&self, from_mm: f64, to_mm: f64, bins: usize) -> Vec<u64> {
        let mut counts = vec![0; bins];
        for (value, count) in self.bins() {
            // the middle of a quantile's bin may lie beyond the values
            let value = value.clamp(millimetres(self.smallest), millimetres(self.largest));
            let bin = ((value - from_mm) / (to_mm - from_mm) * bins as f64).floor() as i64;
            // the upper end belongs to the last bin, and rounding takes nothing beyond it
            let bin = usize::try_from(bin).ok().filter(|_| value <= to_mm).map(|bin| bin.min(bins.saturating_sub(1)));
            if let Some(counted) = bin.and_then(|bin| counts.get_mut(bin)) {
                *counted += count;
            }
        }
        counts
    }
}

fn millimetres(units: i64) -> f64 {
    units as f64 / FM_PER_MM
}

/// Counts of values by their sign, their power of two and [`BIN_BITS`] more: the leading bits of a double. Only pages of memory
/// whose bins occur are there.
#[derive(Debug, Clone)]
struct Histogram {
    counts: Vec<u64>,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { counts: vec![0; 2 * Self::ZERO + 1] }
    }
}

impl Histogram {
    /// The bin of 0; those of negative values lie below it.
    const ZERO: usize = (i64::BITS as usize) << BIN_BITS;
    /// Bits of a double behind those that tell its bin.
    const REST: u32 = f64::MANTISSA_DIGITS - 1 - BIN_BITS;
    /// The leading bits of 1.0, less one, for 0 has a bin of its own.
    const BEFORE_ONE: u64 = (1.0_f64.to_bits() >> Self::REST) - 1;

    #[inline]
    fn bin(value: i64) -> usize {
        let leading = (value as f64).abs().to_bits() >> Self::REST;
        let from_zero = leading.saturating_sub(Self::BEFORE_ONE) as usize;
        if value < 0 { Self::ZERO - from_zero } else { Self::ZERO + from_zero }
    }

    /// The middle of a bin, mm.
    fn middle(bin: usize) -> f64 {
        let from_zero = bin.abs_diff(Self::ZERO) as u64;
        if from_zero == 0 {
            return 0.0;
        }
        let edge = |from_zero: u64| f64::from_bits((from_zero + Self::BEFORE_ONE) << Self::REST);
        let (low, high) = (edge(from_zero), edge(from_zero + 1));
        // a narrow bin holds a single whole number, its lowest
        let middle = if high - low > 1.0 { 0.5 * (low + high) } else { low };
        (if bin < Self::ZERO { -middle } else { middle }) / FM_PER_MM
    }

    #[inline]
    fn add(&mut self, value: i64) {
        self.counts[Self::bin(value)] += 1;
    }

    /// Takes the counts of another, whose values reach from the smallest to the largest.
    fn merge(&mut self, other: &Self, smallest: i64, largest: i64) {
        let bins = Self::bin(smallest)..=Self::bin(largest);
        // pages that are never written take no memory
        let filled = self.counts[bins.clone()].iter_mut().zip(&other.counts[bins]).filter(|(_, more)| **more > 0);
        filled.for_each(|(count, more)| *count += more);
    }

    /// The middle of each bin that is not empty, mm, and its count, where the values reach from the smallest to the largest.
    fn between(&self, smallest: i64, largest: i64) -> impl Iterator<Item = (f64, u64)> {
        let first = Self::bin(smallest);
        let counts = self.counts.get(first..=Self::bin(largest)).unwrap_or_default();
        let filled = counts.iter().enumerate().filter(|(_, count)| **count > 0);
        filled.map(move |(index, count)| (Self::middle(first + index), *count))
    }
}

#[cfg(test)]
mod tests;
