//! Errors whose values differ from row to row of a table. Where the pair is not known, the effect of an error is proportional
//! to its size, by its sign, and is computed once. The results equal those of the bound.

use super::error::{ErrorEffect, RackLines};
use super::known::Own;
use super::lead;
use super::single::{assumed_height, range_of};
use super::sum::{Combined, Sum, larger, own, parts_with_several_leads};
use super::{Basis, ErrorRange, ExtendedError, GivenGeometry, Knowledge, NoBound, Range};

/// Errors whose values change, with what does not depend on the value.
#[derive(Debug, Clone)]
pub struct ChangingErrors<'a> {
    basis: &'a Basis,
    errors: Vec<ExtendedError>,
    in_proportion: Option<InProportion>,
}

/// Errors of a pair that is not known, whose effects are proportional to their sizes.
#[derive(Debug, Clone)]
struct InProportion {
    own: Own,
    /// The effect of one mm of each error, up and down.
    per_mm: Vec<[PerMm; 2]>,
}

/// What one mm of an error adds to the sums. For a pair that is not known, no upper end is lower than its raw one.
#[derive(Debug, Clone, Copy)]
struct PerMm {
    raw_lower: f64,
    raw_upper: f64,
    better: f64,
}

impl<'a> ChangingErrors<'a> {
    /// Errors of any value.
    #[must_use]
    pub fn new(basis: &'a Basis, errors: Vec<ExtendedError>) -> Self {
        let in_proportion = InProportion::of(&errors, &Knowledge { basis, pair: None });
        Self { basis, errors, in_proportion }
    }

    /// The errors with these values, mm or rad.
    #[must_use]
    pub fn with(&self, values: impl Iterator<Item = f64>) -> Vec<ExtendedError> {
        self.errors.iter().zip(values).map(|(error, value)| error.with_value(value)).collect()
    }

    /// Calls `take` with the joint range of all errors in each row, as [`Basis::together`]; `values` holds a column per error,
    /// mm or rad.
    #[inline]
    pub fn each_together(&self, rows: usize, values: &[Vec<f64>], mut take: impl FnMut(usize, Combined<Range>)) {
        let Some(InProportion { own, per_mm }) = &self.in_proportion else {
            return (0..rows).for_each(|row| {
                take(row, self.basis.together(&self.with(values.iter().map(|column| column[row]))));
            });
        };
        for start in (0..rows).step_by(STRIP) {
            let end = rows.min(start + STRIP);
            let mut sums = Sums::default();
            for ((error, per_mm), column) in self.errors.iter().zip(per_mm).zip(values) {
                let values = &column[start..end];
                match &error.effect {
                    ErrorEffect::RackLead(lines) => {
                        sums.add(values, per_mm, |value| size_of_lead(lines, error, value, self.basis));
                    }
                    _ => sums.add(values, per_mm, f64::abs),
                }
            }
            (start..end).for_each(|row| take(row, sums.together(row - start, *own)));
        }
    }
}

/// Rows that are summed together, so that the sums stay in the cache.
const STRIP: usize = 256;

/// The sums of some rows, column by column: several rows are added up at once.
struct Sums {
    raw_lower: [f64; STRIP],
    raw_upper: [f64; STRIP],
    better: [f64; STRIP],
}

impl Default for Sums {
    fn default() -> Self {
        let zeros = [0.0; STRIP];
        Self { raw_lower: zeros, raw_upper: zeros, better: zeros }
    }
}

impl Sums {
    /// Adds the effect of an error with these values, which is proportional to its size in mm, `size` of a value.
    #[inline]
    fn add(&mut self, values: &[f64], [above, below]: &[PerMm; 2], size: impl Fn(f64) -> f64) {
        for (row, value) in values.iter().enumerate().take(STRIP) {
            let (per_mm, size) = (if *value < 0.0 { below } else { above }, size(*value));
            self.raw_lower[row] += size * per_mm.raw_lower;
            self.raw_upper[row] += size * per_mm.raw_upper;
            self.better[row] = larger(self.better[row], size * per_mm.better);
        }
    }

    /// The joint range of all errors in a row.
    #[inline]
    fn together(&self, row: usize, own: Own) -> Combined<Range> {
        let mut sum = Sum::default();
        (sum.raw_lower, sum.raw_upper, sum.better) = (self.raw_lower[row], self.raw_upper[row], self.better[row]);
        Combined { range: Ok(sum.with_own(own)), rss: Err(NoBound::NothingScatters) }
    }
}

impl InProportion {
    /// `None` where ends are not proportional, or an error has none.
    fn of(errors: &[ExtendedError], knowledge: &Knowledge) -> Option<Self> {
        let is_any_pair = !matches!(knowledge.basis.geometry, GivenGeometry::Known(_))
            && knowledge.basis.known_teeth.is_none()
            && !knowledge.rolls()
            && parts_with_several_leads(errors) == [false; 2];
        let own = own(&Sum::default(), knowledge).ok().filter(|_| is_any_pair)?;
        let of = |error: &ExtendedError, value: f64| {
            let range = match error.effect {
                ErrorEffect::RackLead(_) => ErrorRange::either_way(1.0),
                _ => range_of(&error.with_value(value), knowledge).ok()?,
            };
            let ErrorRange { raw_lower_mm: raw_lower, raw_upper_mm: raw_upper, .. } = range;
            Some(PerMm { raw_lower, raw_upper, better: range.lower_mm - raw_lower })
        };
        let of_error = |error: &ExtendedError| {
            let is_capped = matches!(error.effect, ErrorEffect::Pitch { cap: Some(_), .. });
            let is_in_proportion = !is_capped && !error.is_tolerance();
            is_in_proportion.then(|| Some([of(error, 1.0)?, of(error, -1.0)?])).flatten()
        };
        Some(Self { own, per_mm: errors.iter().map(of_error).collect::<Option<_>>()? })
    }
}

/// The size of a lead of this value, mm: its effect on a pair that is not known is proportional to it.
#[inline(never)]
fn size_of_lead(lines: &RackLines, error: &ExtendedError, value: f64, basis: &Basis) -> f64 {
    let height = assumed_height(lines, &Knowledge { basis, pair: None }).mm;
    lead::most_of_any_pair(lead::values_of(&error.with_value(value), 1.0), Some(lines), height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::{DeviationKind, Extent};
    use crate::formula::Law;
    use crate::quantity::{Angle, Length};

    /// The same bits, whatever the kinds, extents and values are.
    #[test]
    fn changing_errors_do_what_errors_do() {
        let (alpha, beta): (Angle, Angle) = ("20".parse().unwrap(), "12".parse().unwrap());
        let laws = [
            Law::rack_over_roller(),
            Law::rack_pitch(alpha, beta).unwrap(),
            Law::rack_lead(alpha, beta, "19.8".parse().unwrap()).unwrap(),
            Law::pinion_radial(),
            Law::pinion_pitch(alpha, beta).unwrap(),
            Law::pinion_lead(alpha, beta).unwrap(),
        ];
        for geometry in [GivenGeometry::Unknown, GivenGeometry::BothFlanks] {
            for (extent, rolls) in Extent::EVERY.into_iter().flat_map(|extent| [(extent, false), (extent, true)]) {
                let basis = Basis { geometry: geometry.clone(), rolls, ..Basis::default() };
                let error = |law: Law| {
                    let zero = crate::deviation::DeviationValue::zero(law.kind());
                    ExtendedError::new(law, zero, extent).ok()
                };
                let errors: Vec<_> = laws.into_iter().filter_map(error).collect();
                let changing = ChangingErrors::new(&basis, errors.clone());
                let value = |row: usize, index: usize| {
                    let fm = (row as i64 * 37 + index as i64 * 101) % 83 * 700_000_001 - 29_000_000_000;
                    let is_angle = matches!(errors[index].effect, ErrorEffect::RackLead(_));
                    if is_angle { 0.1 * Length::from_fm(fm).mm() } else { Length::from_fm(fm).mm() }
                };
                let rows = STRIP + 50;
                let column = |index: usize| (0..rows).map(|row| value(row, index)).collect();
                let columns: Vec<Vec<f64>> = (0..errors.len()).map(column).collect();
                let mut next = 0;
                changing.each_together(rows, &columns, |row, together| {
                    let expected = basis.together(&changing.with(columns.iter().map(|column| column[row])));
                    assert_eq!((row, together), (next, expected), "{extent:?} {rolls}");
                    next += 1;
                });
                assert_eq!(next, rows);
            }
        }
        assert_eq!(laws.map(Law::kind), DeviationKind::ALL);
    }
}
