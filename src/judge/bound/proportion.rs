//! Errors of which each row of a table has other values. What grows in proportion to its value, by its sign, is computed
//! once: where the pair is not known, all but the lead of the rack. Gives the same numbers as the bound of the errors as they are.

use super::error::ErrorEffect;
use super::single::range_of;
use super::sum::{Acting, Combined, together};
use super::{Basis, ErrorRange, ExtendedError, Extent, Knowledge, NoBound, Range};

/// Errors whose values change, and what follows from each whatever its value.
#[derive(Debug, Clone)]
pub struct ChangingErrors<'a> {
    basis: &'a Basis,
    errors: Vec<ExtendedError>,
    /// What one mm of each error does up and down, where its ends are in proportion.
    per_mm: Vec<Option<[Acting; 2]>>,
}

impl<'a> ChangingErrors<'a> {
    /// Errors of any value.
    #[must_use]
    pub fn new(basis: &'a Basis, errors: Vec<ExtendedError>) -> Self {
        let per_mm = errors.iter().map(|error| per_mm(error, basis)).collect();
        Self { basis, errors, per_mm }
    }

    /// The errors with their last values.
    #[must_use]
    pub fn errors(&self) -> &[ExtendedError] {
        &self.errors
    }

    /// Gives the error with this index another value, mm or rad.
    #[inline]
    pub fn set(&mut self, index: usize, value: f64) {
        self.errors[index].value = value;
    }

    /// What one error can do alone, as [`Basis::alone`].
    ///
    /// # Errors
    /// [`NoBound`] if there is no bound.
    pub fn alone(&self, index: usize) -> Result<ErrorRange, NoBound> {
        self.basis.alone(&self.errors[index])
    }

    /// What all can do, as [`Basis::together`].
    #[must_use]
    #[inline]
    pub fn together(&self) -> Combined<Range> {
        let knowledge = match self.basis.knowledge(&self.errors) {
            Ok(knowledge) => knowledge,
            Err(open) => return Combined { range: Err(open), rss: Err(open) },
        };
        together(&self.errors, &knowledge, |index, error| match &self.per_mm[index] {
            Some(per_mm) => per_mm[usize::from(error.value < 0.0)].scaled(error.value.abs()),
            None => Acting::of(error, &knowledge),
        })
    }
}

/// What one mm of an error does with either sign; `None` where its ends are not in proportion to it.
fn per_mm(error: &ExtendedError, basis: &Basis) -> Option<[Acting; 2]> {
    let knowledge = Knowledge { basis, pair: None };
    let is_capped = matches!(error.effect, ErrorEffect::Pitch { cap: Some(_), .. });
    let is_in_proportion = matches!(basis.geometry, super::GivenGeometry::Unknown | super::GivenGeometry::BothFlanks)
        && !knowledge.rolls()
        && !is_capped
        && !error.either_sign
        && matches!(error.extent, Extent::One | Extent::Part | Extent::All)
        && !matches!(error.effect, ErrorEffect::RackLead(_));
    let of = |value| Acting::of(&error.with_value(value), &knowledge);
    (is_in_proportion && range_of(error, &knowledge).is_ok()).then(|| [of(1.0), of(-1.0)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::DeviationKind;
    use crate::formula::Law;
    use crate::judge::bound::GivenGeometry;
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
                let mut changing = ChangingErrors::new(&basis, errors.clone());
                for round in 0..50_i64 {
                    for (index, error) in errors.iter().enumerate() {
                        let value =
                            Length::from_fm((round * 37 + index as i64 * 101) % 83 * 700_000_001 - 29_000_000_000);
                        let is_angle = matches!(error.effect, ErrorEffect::RackLead(_));
                        changing.set(index, if is_angle { 0.1 * value.mm() } else { value.mm() });
                    }
                    assert_eq!(changing.together(), basis.together(changing.errors()), "{extent:?} {rolls}");
                }
            }
        }
        assert_eq!(laws.map(Law::kind), DeviationKind::ALL);
    }
}
