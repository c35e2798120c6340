//! A formula prepared for many errors: whatever is constant for a gear is computed once.
//!
//! The batch engine, tolerance budgets and Monte Carlo call it where the exact formulas
//! ([`PartFormula`]) would take a thousand times as long. It gives ΔCD in two ways, each with a proven
//! bound on its error, and what the bound cannot decide is left to the exact formula:
//!
//! - [`Prepared::delta_cd_mm`]: in double precision, within [`Prepared::RELATIVE_ERROR`];
//! - [`Prepared::fixed`], [`Prepared::fixed_from_degrees`]: in integers of 1e-15 mm ([`Fixed`]), in which decimal
//!   measurements, their differences and sums are exact.
//!
//! It must not decide a rounding or a verdict that lies within the bound.

use super::{Model, PartFormula};
use crate::deviation::{ErrorKind, ErrorValue};
use crate::quantity::{DomainError, Length, Rational};
use crate::trig;

/// A length in integers of 1e-15 mm, and how far from it the true value can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fixed {
    /// The length, 1e-15 mm.
    pub units: i64,
    /// The true value lies within this many units; 0 if the length is exact.
    pub bound: i64,
}

impl Fixed {
    /// Decimals of a millimetre.
    pub const DECIMALS: u32 = 15;
    /// Units in a millimetre.
    pub const PER_MM: i64 = 1_000_000_000_000_000;
    /// Magnitudes stay below this (1153 mm), so that the sum of one per kind of error does not overflow.
    pub const LARGEST: i64 = 1 << 60;

    /// A length known exactly; `None` beyond [`LARGEST`](Self::LARGEST).
    #[must_use]
    pub const fn exact(units: i64) -> Option<Self> {
        if units.unsigned_abs() <= Self::LARGEST.unsigned_abs() { Some(Self { units, bound: 0 }) } else { None }
    }
}

/// How ΔCD depends on the error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shape {
    /// ΔCD is the error.
    Shift,
    /// ΔCD = gain |e|.
    Step,
    /// ΔCD = gain |sin Δβ|.
    Sine,
    /// ΔCD = gain |tan Δβ|.
    Tangent,
}

/// A formula for one gear and model, ready for many errors; see the module.
#[derive(Debug, Clone)]
pub struct Prepared {
    formula: PartFormula,
    model: Model,
    shape: Shape,
    /// mm per mm, or mm per unit of sine or tangent
    gain: f64,
    /// The gain as whole + fraction / 2⁶⁴, rounded down; `None` if it is too large for that.
    fixed_gain: Option<(u64, u64)>,
    /// Whether that is the gain itself.
    gain_is_dyadic: bool,
}

/// Degrees to radians.
const RADIANS: f64 = std::f64::consts::PI / 180.0;

/// Up to this angle (degrees) a short series is as good as the function.
const SERIES_DEGREES: f64 = 2.0;

impl Prepared {
    /// Bound on the relative error of [`delta_cd_mm`](Self::delta_cd_mm): 8 half-ulps. Gain, conversion to
    /// radians (two roundings), function (two), and the two products are seven.
    pub const RELATIVE_ERROR: f64 = 4.0 * f64::EPSILON;

    /// Prepares a formula.
    #[must_use]
    pub fn new(formula: &PartFormula, model: Model) -> Self {
        let (shape, gain) = match formula {
            PartFormula::RackOverRoller | PartFormula::PinionRadial => (Shape::Shift, Rational::ONE),
            PartFormula::RackPitch(formula) => (Shape::Step, formula.gain(model).clone()),
            PartFormula::PinionPitch(formula) => (Shape::Step, formula.gain(model).clone()),
            PartFormula::RackLead(formula) => {
                let shape = if model == Model::Exact { Shape::Sine } else { Shape::Tangent };
                (shape, formula.gain(model).clone())
            }
        };
        // functions have 50 digits: a gain such as 3/4 at 30° is that only after rounding
        let rounded = gain.round_significant(45);
        let (fixed_gain, gain_is_dyadic) = fixed_point(&rounded);
        Self { formula: formula.clone(), model, shape, gain: gain.to_f64(), fixed_gain, gain_is_dyadic }
    }

    /// The kind of error.
    #[must_use]
    pub const fn kind(&self) -> ErrorKind {
        self.formula.kind()
    }

    /// The formula behind it.
    #[must_use]
    pub const fn formula(&self) -> &PartFormula {
        &self.formula
    }

    /// The model.
    #[must_use]
    pub const fn model(&self) -> Model {
        self.model
    }

    /// ΔCD in mm of an error in mm, or in degrees for a lead error: within
    /// [`RELATIVE_ERROR`](Self::RELATIVE_ERROR) of the formula for angles up to 45°.
    #[must_use]
    #[inline]
    pub fn delta_cd_mm(&self, error: f64) -> f64 {
        match self.shape {
            Shape::Shift => error,
            Shape::Step => error.abs() * self.gain,
            Shape::Sine => sine(error.abs()) * self.gain,
            Shape::Tangent => tangent(error.abs()) * self.gain,
        }
    }

    /// ∂ΔCD/∂error in mm per mm, or mm per degree; with the sign of the error, and one-sided (positive) at
    /// the kink of a magnitude at 0.
    #[must_use]
    pub fn slope(&self, error: f64) -> f64 {
        let sign = if error < 0.0 { -1.0 } else { 1.0 };
        match self.shape {
            Shape::Shift => 1.0,
            Shape::Step => sign * self.gain,
            Shape::Sine => sign * self.gain * RADIANS * trig::cos(error * RADIANS),
            Shape::Tangent => {
                let cosine = trig::cos(error * RADIANS);
                sign * self.gain * RADIANS / (cosine * cosine)
            }
        }
    }

    /// The error, mm or degrees, of which ΔCD is `delta_cd_mm`: the non-negative one where there are two.
    /// `None` if there is none: a negative ΔCD of a pitch or lead error, or one that no lead error reaches.
    #[must_use]
    pub fn error_of(&self, delta_cd_mm: f64) -> Option<f64> {
        let error = match self.shape {
            Shape::Shift => return Some(delta_cd_mm),
            _ if delta_cd_mm < 0.0 => return None,
            Shape::Step => delta_cd_mm / self.gain,
            Shape::Sine if delta_cd_mm >= self.gain => return None,
            Shape::Sine => trig::asin(delta_cd_mm / self.gain) / RADIANS,
            Shape::Tangent => trig::atan(delta_cd_mm / self.gain) / RADIANS,
        };
        error.is_finite().then_some(error)
    }

    /// ΔCD of an error in units of 1e-15 mm. `None` for a lead error, or beyond [`Fixed::LARGEST`].
    #[must_use]
    #[inline]
    pub fn fixed(&self, error: i64) -> Option<Fixed> {
        match self.shape {
            Shape::Shift => Fixed::exact(error),
            Shape::Step => {
                let (whole, fraction) = self.fixed_gain?;
                let magnitude = error.unsigned_abs();
                let product = u128::from(magnitude) * u128::from(fraction);
                #[expect(clippy::cast_possible_truncation, reason = "the high and the low half of the product")]
                let (high, low) = ((product >> 64) as u64, product as u64);
                let units = magnitude.checked_mul(whole)?.checked_add(high)?;
                let units = i64::try_from(units).ok().filter(|units| *units < Fixed::LARGEST)?;
                if magnitude == 0 || (self.gain_is_dyadic && low == 0) {
                    return Some(Fixed { units, bound: 0 });
                }
                // the product was cut by less than 1, and so was the gain's share: the value is in (units, units + 2)
                Some(Fixed { units: units + 1, bound: 1 })
            }
            Shape::Sine | Shape::Tangent => None,
        }
    }

    /// ΔCD of a lead error in degrees that is known to three half-ulps. `None` for other errors, for
    /// angles outside the formula's domain or beyond 45° (where the tangent magnifies errors), or beyond
    /// [`Fixed::LARGEST`].
    #[must_use]
    #[inline]
    pub fn fixed_from_degrees(&self, degrees: f64) -> Option<Fixed> {
        const LARGEST: f64 = 1_152_921_504_606_846_976.0;
        const PER_MM: f64 = 1e15;
        // 8 half-ulps of delta_cd_mm, 3 of the angle (magnified by π/2 at most), 1 of the product: below 16
        const BOUND: f64 = 8.0 * f64::EPSILON;
        let degrees = degrees.abs();
        let delta_cd = match self.shape {
            Shape::Shift | Shape::Step => return None,
            _ if degrees == 0.0 => return Some(Fixed { units: 0, bound: 0 }),
            _ if degrees.is_nan() || degrees > 45.0 => return None,
            Shape::Sine => sine(degrees) * self.gain,
            Shape::Tangent => tangent(degrees) * self.gain,
        };
        let units = delta_cd * PER_MM;
        if units.is_nan() || units >= LARGEST {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, reason = "below 2⁶⁰")]
        Some(Fixed { units: (units + 0.5) as i64, bound: (units * BOUND) as i64 + 2 })
    }

    /// ΔCD by the exact formula.
    ///
    /// # Errors
    /// [`DomainError`] as the formula's own; `Ok(None)` if the value is of the wrong dimension.
    pub fn exact(&self, error: &ErrorValue) -> Result<Option<Length>, DomainError> {
        self.formula.of(error).map(|error| error.delta_cd(self.model)).transpose()
    }
}

/// sin of an angle of 0° to 90°: two roundings beside those of the angle in radians.
#[inline]
fn sine(degrees: f64) -> f64 {
    let x = degrees * RADIANS;
    if degrees > SERIES_DEGREES {
        return trig::sin(x);
    }
    // the next term is below 1e-17 of it
    let t = x * x;
    x * (1.0 - t * (1.0 / 6.0 - t * (1.0 / 120.0 - t * (1.0 / 5040.0))))
}

/// tan of an angle of 0° to 45°, as [`sine`].
#[inline]
fn tangent(degrees: f64) -> f64 {
    // the next term, 1382/155925 x¹¹, is below 3e-17 of it
    const SERIES: [f64; 4] = [1.0 / 3.0, 2.0 / 15.0, 17.0 / 315.0, 62.0 / 2835.0];
    let x = degrees * RADIANS;
    if degrees > SERIES_DEGREES {
        return trig::tan(x);
    }
    let t = x * x;
    x * (1.0 + SERIES.iter().rev().fold(0.0, |sum, coefficient| t * (coefficient + sum)))
}

/// A gain as whole + fraction / 2⁶⁴, and whether nothing was cut off.
fn fixed_point(gain: &Rational) -> (Option<(u64, u64)>, bool) {
    // beyond this a µm would be a metre
    const LARGEST: u64 = 1 << 20;
    let scaled = gain.to_fixed_point(64);
    let dyadic = Rational::from_parts(scaled.clone(), dashu_int::UBig::ONE << 64) == *gain;
    let Ok(scaled) = u128::try_from(scaled) else { return (None, false) };
    #[expect(clippy::cast_possible_truncation, reason = "the high and the low half")]
    let (whole, fraction) = ((scaled >> 64) as u64, scaled as u64);
    ((whole < LARGEST).then_some((whole, fraction)), dyadic)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::formula::{PinionPitch, RackLead, RackPitch};
    use crate::quantity::Angle;

    fn angle(text: &str) -> Angle {
        text.parse().unwrap()
    }

    /// A length or angle of so many units of 1e-15.
    fn value(kind: ErrorKind, units: i64) -> ErrorValue {
        let exact = Rational::fraction(units, Fixed::PER_MM.unsigned_abs());
        match kind {
            ErrorKind::RackLead => ErrorValue::Angle(Angle::from_exact_degrees(exact, "test").unwrap()),
            _ => ErrorValue::Length(Length::from_exact_mm(exact, "test").unwrap()),
        }
    }

    fn formulas(alpha: &str, beta: &str) -> Vec<PartFormula> {
        let (alpha, beta) = (angle(alpha), angle(beta));
        vec![
            PartFormula::RackOverRoller,
            PartFormula::RackPitch(RackPitch::new(&alpha, &beta).unwrap()),
            PartFormula::RackLead(RackLead::new(&alpha, &beta, &"19.7".parse().unwrap()).unwrap()),
            PartFormula::PinionPitch(PinionPitch::new(&alpha, &beta).unwrap()),
        ]
    }

    /// Both fast ways against the exact one, for an error of so many units.
    fn check(prepared: &Prepared, units: i64) {
        #[expect(clippy::cast_precision_loss, reason = "one of the three roundings that the bound allows for")]
        let base = units as f64 * 1e-15;
        let exact = prepared.exact(&value(prepared.kind(), units)).unwrap().unwrap();
        let scale = Rational::integer(Fixed::PER_MM);
        let fixed = if prepared.kind() == ErrorKind::RackLead {
            prepared.fixed_from_degrees(base)
        } else {
            prepared.fixed(units)
        };
        let fixed = fixed.expect("in range");
        let off = (&(exact.exact_mm() * &scale) - &Rational::integer(fixed.units)).abs();
        assert!(off <= Rational::integer(fixed.bound), "{prepared:?} {units}: off by {} of {fixed:?}", off.to_f64());
        // the error itself is rounded three times to become an f64
        let allowed = exact.mm().abs() * (Prepared::RELATIVE_ERROR + 6.0 * f64::EPSILON);
        assert!((prepared.delta_cd_mm(base) - exact.mm()).abs() <= allowed, "{prepared:?} {units}");
    }

    #[test]
    fn the_bounds_hold_on_a_grid() {
        for (alpha, beta) in [("20", "0"), ("19.9", "-21.5"), ("30", "30"), ("45", "0"), ("5", "44")] {
            for formula in formulas(alpha, beta) {
                for model in [Model::Exact, Model::Paper] {
                    let prepared = Prepared::new(&formula, model);
                    for step in 0..48 {
                        let units = (13_100_000_007 << (step / 2)) / 7 * if step % 2 == 0 { 1 } else { -1 };
                        check(&prepared, units);
                    }
                    for units in [0, 1, -1, 1_999_999_999_999_999, 2_000_000_000_000_001, 40_000_000_000_000_000] {
                        check(&prepared, units);
                    }
                }
            }
        }
    }

    proptest! {
        #[test]
        fn the_bounds_hold(units in -44_000_000_000_000_000i64..44_000_000_000_000_000, shift in 0u32..40) {
            for formula in formulas("20", "12.5") {
                for model in [Model::Exact, Model::Paper] {
                    check(&Prepared::new(&formula, model), units >> shift);
                }
            }
        }
    }

    #[test]
    fn a_rational_gain_is_exact() {
        // cos 30° / (2 tan 30°) = 3/4
        let formula = PartFormula::RackPitch(RackPitch::new(&angle("30"), &angle("30")).unwrap());
        let prepared = Prepared::new(&formula, Model::Exact);
        assert_eq!(prepared.fixed(4_000), Some(Fixed { units: 3_000, bound: 0 }));
        assert_eq!(prepared.fixed(-4_001), Some(Fixed { units: 3_001, bound: 1 }));
    }

    #[test]
    fn inverse_and_slope() {
        for formula in formulas("20", "15") {
            for model in [Model::Exact, Model::Paper] {
                let prepared = Prepared::new(&formula, model);
                for error in [1e-6, 0.013, 0.4, 12.0] {
                    let back = prepared.error_of(prepared.delta_cd_mm(error)).unwrap();
                    assert!((back - error).abs() <= 1e-14 * error, "{prepared:?} {error} {back}");
                    let step = 1e-6 * error;
                    let secant =
                        (prepared.delta_cd_mm(error + step) - prepared.delta_cd_mm(error - step)) / (2.0 * step);
                    assert!((prepared.slope(error) - secant).abs() <= 1e-8 * secant.abs(), "{prepared:?} {error}");
                }
            }
        }
        let lead = Prepared::new(&formulas("20", "0")[2], Model::Exact);
        assert_eq!((lead.error_of(-0.1), lead.error_of(1e3)), (None, None));
        // 90° is outside its domain
        assert_eq!(lead.error_of(lead.delta_cd_mm(90.0)), None);
        assert!(lead.slope(-0.1) < 0.0 && lead.slope(0.0) > 0.0);
        let pitch = Prepared::new(&formulas("20", "0")[1], Model::Exact);
        assert_eq!(pitch.error_of(0.0), Some(0.0));
    }

    #[test]
    fn what_is_out_of_range_is_left_to_the_exact_formula() {
        let [shift, step, lead, _] = &formulas("20", "0")[..] else { unreachable!() };
        let prepared = |formula: &PartFormula| Prepared::new(formula, Model::Paper);
        assert_eq!(prepared(shift).fixed(i64::MIN), None);
        assert_eq!(prepared(step).fixed(i64::MAX), None);
        assert_eq!(prepared(lead).fixed(1), None);
        for degrees in [45.1, f64::NAN, f64::INFINITY] {
            assert_eq!(prepared(lead).fixed_from_degrees(degrees), None);
        }
        assert_eq!(prepared(lead).fixed_from_degrees(0.0), Some(Fixed { units: 0, bound: 0 }));
        assert!(prepared(lead).fixed_from_degrees(45.0).is_some());
        // a rack a hundred metres wide turned by 40° would be beyond the largest number of units
        let wide = RackLead::new(&angle("20"), &Angle::ZERO, &"1e5".parse().unwrap()).unwrap();
        assert_eq!(prepared(&PartFormula::RackLead(wide)).fixed_from_degrees(40.0), None);
        // what is as large as the largest is beyond it: half of 2⁶¹
        let half = PartFormula::RackPitch(RackPitch::new(&angle("45"), &Angle::ZERO).unwrap());
        assert_eq!(prepared(&half).fixed(1 << 61), None);
        assert_eq!(prepared(&half).fixed((1 << 61) - 2), Some(Fixed { units: Fixed::LARGEST - 1, bound: 0 }));
        assert_eq!(Fixed::exact(-(1 << 60)), Some(Fixed { units: -(1 << 60), bound: 0 }));
        assert_eq!(Fixed::exact((1 << 60) + 1), None);
        assert_eq!(fixed_point(&Rational::integer(1 << 20)), (None, true));
        assert_eq!(fixed_point(&Rational::integer((1 << 20) - 1)), (Some(((1 << 20) - 1, 0)), true));
        let tiny = PartFormula::RackPitch(RackPitch::new(&angle("1e-300"), &Angle::ZERO).unwrap());
        assert_eq!(prepared(&tiny).fixed(1), None);
    }

    /// Seven roundings of half an ulp, and one to spare.
    #[test]
    fn the_bound_is_eight_half_ulps() {
        assert_eq!(Prepared::RELATIVE_ERROR, 8.0 * (0.5 * f64::EPSILON));
    }

    /// The series and the functions, in ulps of 2⁻⁵² of the value.
    #[test]
    fn sine_and_tangent_to_the_last_digits() {
        for step in 1..=4000 {
            let degrees = 0.002 * f64::from(step);
            let x = degrees * RADIANS;
            for (value, expected) in [(sine(degrees), trig::sin(x)), (tangent(degrees), trig::tan(x))] {
                assert!((value / expected - 1.0).abs() <= 2.0 * f64::EPSILON, "{degrees}° {value} {expected}");
            }
        }
    }

    #[test]
    fn units_are_the_nearest() {
        let lead = Prepared::new(&formulas("20", "0")[2], Model::Exact);
        for step in 1..200 {
            let degrees = 1e-12 * f64::from(step);
            let units = lead.delta_cd_mm(degrees) * 1e15;
            let fixed = lead.fixed_from_degrees(degrees).unwrap();
            #[expect(clippy::cast_precision_loss, reason = "below 2⁵³")]
            let off = fixed.units as f64 - units;
            assert!(off.abs() <= 0.5 && fixed.bound >= 1, "{degrees}: {fixed:?} {units}");
        }
    }
}
