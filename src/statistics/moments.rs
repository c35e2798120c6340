//! Exact moments of lengths on their grid: they do not depend on the order, and hold for a spread that is small against the mean.

#[cfg(feature = "batch")]
use crate::quantity::Length;

/// How many lengths there are, their sum and that of their squares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct LengthMoments {
    pub(crate) count: u64,
    /// Σx, fm.
    pub(crate) sum_fm: i128,
    /// Σx², fm²; `None` where it is too large to be held.
    pub(crate) squares_fm2: Option<i128>,
}

impl Default for LengthMoments {
    /// Of no lengths.
    fn default() -> Self {
        Self { count: 0, sum_fm: 0, squares_fm2: Some(0) }
    }
}

impl LengthMoments {
    /// The moments of some lengths.
    #[cfg(feature = "batch")]
    pub(crate) fn of(lengths: &[Length]) -> Self {
        /// The squares of so many of the largest length can be added.
        const ADDED: usize = 128;
        let fm = |length: &Length| i128::from(length.fm());
        let squares = |lengths: &[Length]| lengths.iter().map(|length| fm(length) * fm(length)).sum::<i128>();
        let squares_fm2 = lengths.chunks(ADDED).map(squares).try_fold(0_i128, i128::checked_add);
        Self { count: lengths.len() as u64, sum_fm: lengths.iter().map(fm).sum(), squares_fm2 }
    }

    /// Adds other lengths.
    #[cfg(feature = "batch")]
    pub(crate) fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.sum_fm += other.sum_fm;
        let squares = self.squares_fm2.zip(other.squares_fm2);
        self.squares_fm2 = squares.and_then(|(squares, more)| squares.checked_add(more));
    }

    /// The mean, fm; `None` without lengths.
    pub(crate) fn mean_fm(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum_fm as f64 / self.count as f64)
    }

    /// The standard deviation s (of a sample, with n - 1), fm; `None` below two lengths, or without the sum of squares.
    ///
    /// Σ(x − m)² = Σx² − q (Σx + r) − r²/n, where the mean m is q and r/n: no digit is lost.
    pub(crate) fn standard_deviation_fm(&self) -> Option<f64> {
        let squares = self.squares_fm2.filter(|_| self.count > 1)?;
        let (whole, rest) = (self.sum_fm.div_euclid(self.count.into()), self.sum_fm.rem_euclid(self.count.into()));
        // steps may wrap, the result does not: it lies between 0 and Σx² + n
        let about_whole = squares.wrapping_sub(whole.wrapping_mul(self.sum_fm.wrapping_add(rest)));
        let about_mean = about_whole as f64 - rest as f64 * (rest as f64 / self.count as f64);
        Some((about_mean.max(0.0) / (self.count - 1) as f64).sqrt())
    }
}
