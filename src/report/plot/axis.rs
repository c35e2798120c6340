//! A linear axis with round tick marks, found without the platform's logarithm, and a logarithmic one. Called by the
//! plots.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

/// A linear axis from one value to another.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    from: f64,
    to: f64,
    /// Decimals of the labels.
    decimals: usize,
}

impl Axis {
    pub(super) const fn new((from, to): (f64, f64), decimals: usize) -> Self {
        Self { from, to, decimals }
    }
}

/// Multiples of 1, 2 or 5 times a power of ten within the range, at most `most` of them.
fn ticks(from: f64, to: f64, most: usize) -> Vec<f64> {
    let width = to - from;
    if !(width > 0.0 && width.is_finite()) || most == 0 {
        return Vec::new();
    }
    let least_step = width / most as f64;
    let mut decade = 1.0;
    while decade > least_step {
        decade /= 10.0;
    }
    while decade * 10.0 <= least_step {
        decade *= 10.0;
    }
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|n| n * decade).find(|step| *step >= least_step);
    let step = step.unwrap_or(10.0 * decade);
    let first = (from / step).ceil();
    (0..=most)
        .map(|index| {
            let multiple = first + index as f64;
            multiple * step
        })
        .take_while(|tick| *tick <= to + 1e-9 * step)
        .collect()
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let share = (value - self.from) / (self.to - self.from);
        let (low, high) = (f64::from(limit.0), f64::from(limit.1));
        // a pixel; far outside the picture is outside all the same

        (low + share * (high - low)).round().clamp(-1e6, 1e6) as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        ticks(self.from, self.to, hint.max_num_points())
    }

    fn range(&self) -> Range<f64> {
        self.from..self.to
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        format!("{value:.*}", self.decimals)
    }
}

/// A logarithmic axis over whole decades.
#[derive(Debug, Clone)]
pub(super) struct LogAxis {
    /// Exponents of ten.
    from: i32,
    to: i32,
}

impl LogAxis {
    /// The whole decades that hold everything from the lowest to the highest (both positive).
    pub(super) fn around((low, high): (f64, f64)) -> Self {
        let (from, to) = (libm::log10(low).floor() as i32, libm::log10(high).ceil() as i32);
        Self { from, to: to.max(from + 1) }
    }
}

impl Ranged for LogAxis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let share = (libm::log10(*value) - f64::from(self.from)) / f64::from(self.to - self.from);
        let (low, high) = (f64::from(limit.0), f64::from(limit.1));

        (low + share * (high - low)).round().clamp(-1e6, 1e6) as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let most = i32::try_from(hint.max_num_points()).unwrap_or(i32::MAX).max(2);
        let every = (self.to - self.from).unsigned_abs().div_ceil(most.unsigned_abs()).max(1);
        (self.from..=self.to).step_by(every as usize).map(|exponent| libm::exp10(f64::from(exponent))).collect()
    }

    fn range(&self) -> Range<f64> {
        libm::exp10(f64::from(self.from))..libm::exp10(f64::from(self.to))
    }
}

impl ValueFormatter<f64> for LogAxis {
    fn format_ext(&self, value: &f64) -> String {
        format!("1e{:.0}", libm::log10(*value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(ticks(0.0, 50.0, 12), [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0]);
        assert_eq!(ticks(-0.003, 0.012, 4).len(), 3);
        assert_eq!(ticks(1.0, 1.0, 4), [0.0; 0]);
        assert_eq!(ticks(0.0, f64::INFINITY, 4), [0.0; 0]);
        for (from, to) in [(0.0, 1e-12), (1e9, 1e9 + 3.0), (-7e20, 8e20)] {
            let found = ticks(from, to, 9);
            assert!((2..=10).contains(&found.len()), "{found:?}");
        }
    }
}
