//! Values counted in bins, and the quantiles of these counts. The simulation fills it.

const BINS: usize = 16_384;

/// Counts of values in bins of equal width, with one more at either end for values beyond them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Histogram {
    low: f64,
    width: f64,
    per_unit: f64,
    counts: Vec<u32>,
    pub(super) extremes: (f64, f64),
}

impl Histogram {
    /// Bins from `low` to `high`; if these are equal, every other value lies beyond the bins.
    pub(super) fn new(low: f64, high: f64) -> Self {
        let bins = BINS as f64;
        let width = (high - low) / bins;
        let per_unit = 1.0 / width;
        Self { low, width, per_unit, counts: vec![0; BINS + 2], extremes: (f64::INFINITY, f64::NEG_INFINITY) }
    }

    pub(super) fn count(&mut self, values: &[f64]) {
        let (mut low, mut high) = self.extremes;
        for &value in values {
            low = low.min(value);
            high = high.max(value);
        }
        self.extremes = (low, high);
        if !self.per_unit.is_finite() {
            // a spread so small that its reciprocal overflows counts as 0
            for &value in values {
                let beyond = if value > self.low { BINS + 1 } else { usize::from(value == self.low) };
                self.counts[beyond] += 1;
            }
            return;
        }
        let top = (BINS + 1) as f64;
        for &value in values {
            // the clamp keeps the index inside the bins and turns NaN into 0
            let bin = ((value - self.low) * self.per_unit + 1.0).clamp(0.0, top);
            let bin = bin as usize;
            self.counts[bin.min(BINS + 1)] += 1;
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.extremes = (self.extremes.0.min(other.extremes.0), self.extremes.1.max(other.extremes.1));
        for (mine, theirs) in self.counts.iter_mut().zip(&other.counts) {
            *mine += theirs;
        }
    }

    fn total(&self) -> u64 {
        self.counts.iter().map(|&count| u64::from(count)).sum()
    }

    /// The edges of a bin, as far as values reach.
    fn edges(&self, bin: usize) -> (f64, f64) {
        let at = |edge: usize| self.low + self.width * edge as f64;
        let left = if bin == 0 { self.extremes.0 } else { at(bin - 1).max(self.extremes.0) };
        let right = if bin > BINS { self.extremes.1 } else { at(bin).min(self.extremes.1) };
        (left, right.max(left))
    }

    pub(super) fn quantile(&self, p: f64) -> f64 {
        let rank = p.clamp(0.0, 1.0) * self.total() as f64;
        let mut below = 0.0;
        let mut last = self.extremes.1;
        for (bin, &count) in self.counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let count = f64::from(count);
            let (left, right) = self.edges(bin);
            if below + count >= rank {
                return left + (right - left) * ((rank - below) / count);
            }
            below += count;
            last = right;
        }
        last
    }

    /// The shortest interval with a share `p` of the values: one end at the edge of a bin.
    pub(super) fn shortest(&self, p: f64) -> (f64, f64) {
        // the distribution function at the edges, as rank and value
        let mut points = vec![(0.0, self.extremes.0)];
        let mut below = 0.0;
        for (bin, &count) in self.counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let (left, right) = self.edges(bin);
            // values jump over empty bins
            if points.last().is_some_and(|(_, value)| *value < left) {
                points.push((below, left));
            }
            below += f64::from(count);
            points.push((below, right));
        }
        let needed = p * below;
        let mut best = (f64::INFINITY, self.extremes);
        let mut upper = 1;
        for &(rank, low) in &points {
            let target = rank + needed;
            if target > below {
                break;
            }
            while points[upper].0 < target {
                upper += 1;
            }
            let (a, b) = (points[upper - 1], points[upper]);
            let high = a.1 + (b.1 - a.1) * ((target - a.0) / (b.0 - a.0));
            if high - low < best.0 {
                best = (high - low, (low, high));
            }
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bins of width 1 from 0.
    fn histogram(values: &[(f64, usize)]) -> Histogram {
        let mut histogram = Histogram::new(0.0, 16_384.0);
        for (value, count) in values {
            histogram.count(&vec![*value; *count]);
        }
        histogram
    }

    /// Within a bin values are spread evenly, as far as they reach; beyond the bins up to the furthest one.
    #[test]
    fn quantiles_are_interpolated() {
        let even = histogram(&(0..1000_u32).map(|i| (f64::from(i) + 0.5, 1)).collect::<Vec<_>>());
        assert_eq!([0.0, 0.25, 0.5, 1.0].map(|p| even.quantile(p)), [0.5, 250.0, 500.0, 999.5]);
        let beyond = histogram(&[(16_383.5, 4), (20_000.0, 4)]);
        assert_eq!(beyond.quantile(0.25), 16_383.75);
        assert_eq!(beyond.quantile(0.75), 0.5 * (16_384.0 + 20_000.0));
        let below = histogram(&[(-10.0, 4), (0.25, 4)]);
        assert_eq!(below.quantile(0.25), -5.0);
    }

    /// Bins without a width, because the first values are all equal: other values still count.
    #[test]
    fn values_apart_from_bins_without_a_width() {
        let mut alike = Histogram::new(3.0, 3.0);
        alike.count(&[3.0; 90]);
        assert_eq!([0.0, 0.5, 1.0].map(|p| alike.quantile(p)), [3.0; 3]);
        assert_eq!(alike.shortest(0.95), (3.0, 3.0));
        alike.count(&[1.0, 2.0, 5.0, 7.0, 6.0, 5.5, 6.5, 4.0, 5.0, 7.0]);
        assert_eq!([0.0, 0.5, 0.92, 1.0].map(|p| alike.quantile(p)), [1.0, 3.0, 3.0, 7.0]);
        assert_eq!(alike.shortest(0.9), (3.0, 3.0));
        let (low, high) = alike.shortest(0.95);
        assert!(low <= 3.0 && high > 3.0, "{low} {high}");
    }

    #[test]
    fn the_shortest_interval() {
        // the dense end, on either side; nothing lies between
        let dense_first = histogram(&[(100.25, 50), (100.75, 45), (500.5, 5)]);
        assert_eq!(dense_first.shortest(0.95), (100.25, 101.0));
        let dense_last = histogram(&[(10.5, 5), (300.5, 50), (300.75, 45)]);
        assert_eq!(dense_last.shortest(0.95), (300.0, 300.75));
        // at least as many values as asked for
        let lone = histogram(&[(10.5, 5), (290.5, 1), (301.5, 94)]);
        assert_eq!(lone.shortest(0.95), (290.0, 301.5));
        // of equals the first
        let even =
            histogram(&(0..10_u32).map(|i| (f64::from(i) + 0.5, 100)).chain([(0.0, 1), (10.0, 1)]).collect::<Vec<_>>());
        let (low, high) = even.shortest(0.5);
        assert!(low == 0.0 && (high - 5.0).abs() < 0.02, "{low} {high}");
        assert_eq!(histogram(&[(5.5, 3)]).shortest(0.95), (5.5, 5.5));
        // half of the values end 40/90 of the way from the last bin to the furthest value
        let far = histogram(&[(16_383.5, 10), (20_000.0, 90)]);
        let (low, high) = far.shortest(0.5);
        assert!(low == 16_383.5 && (high - 16_384.0 - 3616.0 * 4.0 / 9.0).abs() < 1e-9, "{low} {high}");
    }

    /// p (1 − p)/n under the root, over the density: of a uniform distribution that is its width.
    #[test]
    fn the_errors_of_the_ends() {
        let even = histogram(&(0..1000_u32).map(|i| (f64::from(i) + 0.5, 10)).collect::<Vec<_>>());
        let simulation = crate::chance::Simulation::of(even, 500.0, 288.7, 10_000.0);
        let expected = 1000.0 * (0.025_f64 * 0.975 / 10_000.0).sqrt();
        assert!((simulation.end_errors.0 / expected - 1.0).abs() < 1e-9, "{:?}", simulation.end_errors);
        assert!((simulation.end_errors.1 / expected - 1.0).abs() < 1e-9, "{:?}", simulation.end_errors);
        let (low, high) = simulation.symmetric;
        assert!((low - 25.0).abs() < 1e-9 && (high - 975.0).abs() < 1e-9, "{low} {high}");
    }
}
