//! The bound of errors that are shares of given errors, for many shares: a table of each error's range. Simulations read it;
//! it computes no range of its own.

use super::known::Own;
use super::single::range_of;
use super::sum::{self, Sum};
use super::{Basis, ErrorRange, ExtendedError, Knowledge, NoBound, Range};
use crate::deviation::Part;
use crate::formula::PartDeviation;

/// Ranges of errors at shares −1 … +1 of their values.
#[derive(Debug, Clone)]
pub struct Scales {
    own: Own,
    errors: Vec<Scale>,
}

#[derive(Debug, Clone)]
struct Scale {
    part: Part,
    ranges: Vec<ErrorRange>,
}

/// Intervals of a table. Ranges are convex in the error between 0 and its value, except for the curvature of a lead's angle,
/// so chords contain them.
const INTERVALS: usize = 16;

impl Basis {
    /// The ranges of these errors, each at every share of its value.
    ///
    /// # Errors
    /// [`NoBound`] if there is no bound, or if the curve of the pair without errors is not known.
    pub fn scales(&self, errors: &[PartDeviation]) -> Result<Scales, NoBound> {
        let extended: Result<Vec<_>, _> = errors.iter().map(ExtendedError::of).collect();
        let extended = extended?;
        let knowledge = self.knowledge(&extended)?;
        let own = sum::own(&Sum::default(), &knowledge)?;
        let errors = extended.iter().map(|error| Scale::new(error, &knowledge)).collect::<Result<_, _>>()?;
        Ok(Scales { own, errors })
    }
}

impl Scale {
    fn new(error: &ExtendedError, knowledge: &Knowledge) -> Result<Self, NoBound> {
        let at = |index: usize| range_of(&error.scaled(index as f64 / (INTERVALS / 2) as f64 - 1.0), knowledge);
        Ok(Self { part: error.part, ranges: (0..=INTERVALS).map(at).collect::<Result<_, _>>()? })
    }

    fn at(&self, share: f64) -> ErrorRange {
        let place = ((share + 1.0) * (INTERVALS / 2) as f64).clamp(0.0, INTERVALS as f64);
        let index = (place as usize).min(INTERVALS - 1);
        let share = place - index as f64;
        let (a, b) = (&self.ranges[index], &self.ranges[index + 1]);
        let between = |a: f64, b: f64| a + share * (b - a);
        ErrorRange {
            raw_lower_mm: between(a.raw_lower_mm, b.raw_lower_mm),
            lower_mm: between(a.lower_mm, b.lower_mm),
            upper_mm: between(a.upper_mm, b.upper_mm),
            raw_upper_mm: between(a.raw_upper_mm, b.raw_upper_mm),
            upper_with_undercut_mm: a.upper_with_undercut_mm.max(b.upper_with_undercut_mm),
            in_contact: 0,
        }
    }
}

impl Scales {
    /// The bound of all errors, each at this share of its value.
    #[must_use]
    pub fn total(&self, shares: &[f64]) -> Range {
        let mut sum = Sum::default();
        for (scale, share) in self.errors.iter().zip(shares) {
            sum.add(scale.part, scale.at(*share));
        }
        sum.with_own(self.own)
    }
}
