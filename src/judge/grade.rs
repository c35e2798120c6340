//! Grades from values: which grade a measured deviation reaches, and which grade stays within a ΔCD.
//!
//! `class --obtained` and `class --for-delta-cd` call it. It asks a standard for its permissible values grade by
//! grade; it knows no formula of ΔCD itself.

use super::class::NoEffect;
use super::{Combined, Interval, Limit, Stack, Verdict};
use crate::deviation::Part;
use crate::formula::PartDeviation;
use crate::judge::bound::Basis;
use crate::quantity::{Length, QuantityError};
use crate::standard::{Deviation, Permissible, Standard, StandardError, Wheel};

/// What a grade of a standard and its companion permits of a wheel.
#[derive(Debug, Clone, PartialEq)]
pub struct PermittedValues {
    /// The values, in the order of the deviations.
    pub values: Vec<Permissible>,
    /// Deviations without a value, and why.
    pub not_given: Vec<(Standard, Deviation, StandardError)>,
}

impl PermittedValues {
    /// All that a grade permits.
    ///
    /// # Errors
    /// [`StandardError`] if the wheel is outside a standard's scope, the standard does not have the grade, or there is no value.
    pub fn new(standard: Standard, grade: u8, wheel: &Wheel) -> Result<Self, StandardError> {
        let (mut values, mut not_given) = (Vec::new(), Vec::new());
        for one in [Some(standard), standard.companion()].into_iter().flatten() {
            for deviation in one.deviations() {
                match one.permissible(deviation, grade, wheel) {
                    Ok(permissible) => values.push(permissible),
                    Err(error) => not_given.push((one, deviation, error)),
                }
            }
        }
        // a size outside the standard's scope is refused; missing or unknown values are reported
        let fatal = not_given.iter().find(|(one, _, error)| match error {
            StandardError::OutOfScope { .. } => true,
            StandardError::Grade { .. } => *one == standard,
            _ => false,
        });
        // without any value: report the fault, else what is missing
        let nothing = || {
            let known = |error: &StandardError| !matches!(error, StandardError::Missing { .. });
            let first = not_given.iter().find(|(_, _, error)| known(error)).or(not_given.first());
            first.filter(|_| values.is_empty())
        };
        if let Some((_, _, error)) = fatal.or_else(nothing) {
            return Err(error.clone());
        }
        values.sort_by_key(|permissible| permissible.deviation);
        Ok(Self { values, not_given })
    }
}

/// A measured deviation and the grade that it reaches.
#[derive(Debug, Clone, PartialEq)]
pub struct ObtainedGrade {
    /// The part that it was measured on.
    pub part: Part,
    /// The deviation.
    pub deviation: Deviation,
    /// Its magnitude.
    pub measured: Length,
    /// Where the value comes from, in words.
    pub origin: String,
    /// The permissible value of the grade reached; `None` if it exceeds the coarsest one that is known.
    pub reached: Option<Permissible>,
    /// The coarsest permissible value that is known.
    pub coarsest: Permissible,
}

impl ObtainedGrade {
    /// Whether the value exceeds the grades that are known here, while the standard has coarser ones.
    #[must_use]
    pub fn is_beyond_what_is_known(&self) -> bool {
        self.reached.is_none() && self.coarsest.grade < *self.coarsest.standard.grades().end()
    }
}

/// The finest grade whose permissible value, as the standard rounds it, is at least `measured`.
///
/// # Errors
/// [`StandardError`] if the standard gives no value of any grade.
pub fn obtained(
    standard: Standard,
    part: Part,
    deviation: Deviation,
    measured: Length,
    origin: &str,
    wheel: &Wheel,
) -> Result<ObtainedGrade, StandardError> {
    let limiting = standard.that_limits(deviation).ok_or(StandardError::NoSuchDeviation { standard, deviation })?;
    let measured = measured.abs();
    let mut problem = StandardError::NoSuchDeviation { standard, deviation };
    let mut coarsest: Option<Permissible> = None;
    let mut reached: Option<Permissible> = None;
    for grade in limiting.grades() {
        match limiting.permissible(deviation, grade, wheel) {
            Ok(permissible) => {
                if reached.is_none() && measured <= permissible.length() {
                    reached = Some(permissible.clone());
                }
                coarsest = Some(permissible);
            }
            Err(error) => problem = error,
        }
    }
    let coarsest = coarsest.ok_or(problem)?;
    Ok(ObtainedGrade { part, deviation, measured, origin: origin.to_owned(), reached, coarsest })
}

/// The overall grade: the coarsest of those reached; `None` if a deviation is beyond every grade, or there is none.
#[must_use]
pub fn overall(obtained: &[ObtainedGrade]) -> Option<u8> {
    let grades: Option<Vec<u8>> =
        obtained.iter().map(|one| one.reached.as_ref().map(|permissible| permissible.grade)).collect();
    grades?.into_iter().max()
}

/// One grade and its ΔCD.
#[derive(Debug, Clone, PartialEq)]
pub struct GradeStep {
    /// The grade.
    pub grade: u8,
    /// The combination of the ΔCD of all deviations, or why there is none.
    pub combined: Result<Combined<Interval>, NoEffect>,
}

/// The grades of a standard against a limit of ΔCD.
#[derive(Debug, Clone, PartialEq)]
pub struct GradeSearch {
    /// The limit.
    pub limit: Length,
    /// Every grade, from the finest.
    pub steps: Vec<GradeStep>,
}

impl GradeSearch {
    /// Combines the tolerances that `errors` gives for each grade of `standard`, with what is known of the pair.
    ///
    /// # Errors
    /// [`QuantityError`] if a sum is beyond the largest length.
    pub fn new(
        standard: Standard,
        limit: Length,
        basis: &Basis,
        mut errors: impl FnMut(u8) -> Result<Vec<PartDeviation>, NoEffect>,
    ) -> Result<Self, QuantityError> {
        let mut steps = Vec::new();
        for grade in standard.grades() {
            let combined = match errors(grade) {
                Ok(errors) => Ok(basis.bound_of(&errors).combined.nearest()?),
                Err(reason) => Err(reason),
            };
            steps.push(GradeStep { grade, combined });
        }
        Ok(Self { limit, steps })
    }

    /// Why no grade can have a combination: the first error that is not of a grade.
    #[must_use]
    pub fn failure(&self) -> Option<&NoEffect> {
        self.steps.iter().filter_map(|step| step.combined.as_ref().err()).find(|error| !error.is_of_grade())
    }

    /// The coarsest grade whose combination does not exceed the limit.
    #[must_use]
    pub fn coarsest(&self, stack: Stack) -> Option<u8> {
        let limit = Limit::symmetric(self.limit);
        let is_within = |combined: &Combined<Interval>| {
            combined.interval(stack).is_ok_and(|interval| limit.judge(interval) == Verdict::Pass)
        };
        let within = self.steps.iter().filter(|step| step.combined.as_ref().is_ok_and(is_within));
        within.map(|step| step.grade).max()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::Law;

    fn wheel() -> Wheel {
        Wheel {
            normal_module: Some("10".parse().unwrap()),
            diameter: Some("1000".parse().unwrap()),
            ..Wheel::default()
        }
    }

    fn reached(measured: &str) -> Option<u8> {
        let standard = Standard::Iso1328Part1Of2013;
        let one = obtained(standard, Part::Pinion, Deviation::SinglePitch, measured.parse().unwrap(), "", &wheel());
        one.unwrap().reached.map(|permissible| permissible.grade)
    }

    #[test]
    fn a_value_on_the_permissible_one_is_inside() {
        // f_pT is exactly 10 µm at class 5, 5 µm at class 3, 80 µm at class 11
        assert_eq!(reached("10 um"), Some(5));
        assert_eq!(reached("-10 um"), Some(5));
        assert_eq!(reached("10.000001 um"), Some(6));
        assert_eq!(reached("5 um"), Some(3));
        assert_eq!(reached("0"), Some(1));
        assert_eq!(reached("80 um"), Some(11));
        assert_eq!(reached("80.0001 um"), None);
    }

    #[test]
    fn the_overall_grade_is_the_coarsest() {
        let standard = Standard::Iso1328Part1Of2013;
        let one = |measured: &str| {
            let measured = measured.parse().unwrap();
            obtained(standard, Part::Pinion, Deviation::SinglePitch, measured, "", &wheel()).unwrap()
        };
        assert_eq!(overall(&[one("5 um"), one("9 um")]), Some(5));
        assert_eq!(overall(&[one("5 um"), one("90 um")]), None);
        assert_eq!(overall(&[]), None);
    }

    /// Of DIN 3962 qualities 1 to 6 of a pitch are known, the coarsest with 7 µm; the standard has 12.
    #[test]
    fn beyond_what_is_known_is_not_beyond_the_standard() {
        let small = Wheel {
            normal_module: Some("1.9".parse().unwrap()),
            diameter: Some("14.7".parse().unwrap()),
            ..Wheel::default()
        };
        let beyond = |standard, measured: &str, wheel: &Wheel| {
            let measured = measured.parse().unwrap();
            let one = obtained(standard, Part::Pinion, Deviation::SinglePitch, measured, "", wheel).unwrap();
            one.is_beyond_what_is_known()
        };
        assert!(!beyond(Standard::Din3962, "7 um", &small) && beyond(Standard::Din3962, "7.001 um", &small));
        assert!(!beyond(Standard::Iso1328Part1Of2013, "90 um", &wheel()));
    }

    #[test]
    fn the_coarsest_grade_within_a_limit() {
        let standard = Standard::Iso1328Part1Of2013;
        let search = |limit: &str| {
            GradeSearch::new(standard, limit.parse().unwrap(), &Basis::default(), |grade| {
                let value = standard.permissible(Deviation::SinglePitch, grade, &wheel())?;
                let within = |law| PartDeviation::within(law, value.length());
                Ok(vec![within(Law::rack_over_roller()), within(Law::pinion_radial())])
            })
            .unwrap()
        };
        // two terms of 10 µm at class 5: together 20 µm, or 14.1 µm by RSS
        assert_eq!((search("20 um").coarsest(Stack::Range), search("20 um").coarsest(Stack::Rss)), (Some(5), Some(6)));
        assert_eq!(search("19.999 um").coarsest(Stack::Range), Some(4));
        assert_eq!((search("1 um").coarsest(Stack::Range), search("1 um").coarsest(Stack::Rss)), (None, None));
    }
}
