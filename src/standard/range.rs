//! Ranges of sizes: over one limit, up to and including the next. Asked by the files of the standards; extrapolates
//! nothing.

/// A range of a table, over `over` and up to and including `up_to`; the first range of a table includes both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SizeRange {
    /// The lower limit.
    pub over: f64,
    /// The upper limit.
    pub up_to: f64,
}

impl SizeRange {
    /// The geometric mean of the limits, which the formulas of the 1995 and 1997 editions take for the size.
    #[must_use]
    pub fn geometric_mean(&self) -> f64 {
        (self.over * self.up_to).sqrt()
    }
}

/// The limits of a table's ranges, ascending.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ranges(pub(super) &'static [&'static str]);

impl Ranges {
    /// The range in which a size lies; `None` outside the table.
    pub(super) fn of(self, size: f64) -> Option<SizeRange> {
        let limits: Vec<f64> = self.0.iter().map(|limit| decimal(limit)).collect();
        if size < *limits.first()? {
            return None;
        }
        let index = limits.iter().skip(1).position(|limit| size <= *limit)?;
        Some(SizeRange { over: limits[index], up_to: limits[index + 1] })
    }

    /// The table's ends in words: `5 to 10000`.
    pub(super) fn bound(self) -> String {
        match (self.0.first(), self.0.last()) {
            (Some(first), Some(last)) => format!("{first} to {last}"),
            _ => String::new(),
        }
    }
}

/// A decimal number of the source text.
///
/// # Panics
/// If it is none: such numbers are written in the source code, never read, and the tests use all of them.
pub(super) fn decimal(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("{text} is a decimal number of a standard's table"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_on_a_limit_belongs_to_the_lower_range() {
        let ranges = Ranges(&["5", "20", "50"]);
        let up_to = |size: &str| ranges.of(decimal(size)).map(|range| range.up_to);
        assert_eq!(up_to("5"), Some(20.0));
        assert_eq!(up_to("20"), Some(20.0));
        assert_eq!(up_to("20.000000000001"), Some(50.0));
        assert_eq!(up_to("50"), Some(50.0));
        assert_eq!(up_to("4.999999999999"), None);
        assert_eq!(up_to("50.000000000001"), None);
        assert_eq!(ranges.bound(), "5 to 50");
    }

    #[test]
    fn means_are_geometric() {
        let range = SizeRange { over: decimal("5"), up_to: decimal("20") };
        assert!((range.geometric_mean() - 10.0).abs() < 1e-15);
    }
}
