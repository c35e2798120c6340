//! Ranges of sizes: over one limit, up to and including the next.

/// A range of a table, over `over` and up to and including `up_to`; the first range of a table includes `over` too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SizeRange {
    /// The lower limit.
    pub over: f64,
    /// The upper limit.
    pub up_to: f64,
}

impl SizeRange {
    /// The geometric mean of the limits, √(over · up_to), which the formulas of the 1995 and 1997 editions take for the size.
    #[must_use]
    pub fn geometric_mean(&self) -> f64 {
        (self.over * self.up_to).sqrt()
    }
}

/// The limits of a table's ranges, ascending.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ranges(pub(super) &'static [f64]);

impl Ranges {
    /// The range in which a size lies; `None` outside the table.
    pub(super) fn of(self, size: f64) -> Option<SizeRange> {
        let is_in = |range: &&[f64]| size <= range[1];
        let range = self.0.windows(2).find(is_in).filter(|_| size >= self.0[0])?;
        Some(SizeRange { over: range[0], up_to: range[1] })
    }

    /// The table's ends in words: `5 to 10000`.
    pub(super) fn bound(self) -> String {
        match (self.0.first(), self.0.last()) {
            (Some(first), Some(last)) => format!("{first} to {last}"),
            _ => String::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_on_a_limit_belongs_to_the_lower_range() {
        let ranges = Ranges(&[5.0, 20.0, 50.0]);
        let up_to = |size: f64| ranges.of(size).map(|range| range.up_to);
        assert_eq!(up_to(5.0), Some(20.0));
        assert_eq!(up_to(20.0), Some(20.0));
        assert_eq!(up_to(20.000_000_000_001), Some(50.0));
        assert_eq!(up_to(50.0), Some(50.0));
        assert_eq!(up_to(4.999_999_999_999), None);
        assert_eq!(up_to(50.000_000_000_001), None);
        assert_eq!(ranges.bound(), "5 to 50");
    }

    #[test]
    fn means_are_geometric() {
        let range = SizeRange { over: 5.0, up_to: 20.0 };
        assert!((range.geometric_mean() - 10.0).abs() < 1e-15);
    }
}
