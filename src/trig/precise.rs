//! Trigonometry of angles that are known exactly, to some 50 decimal digits.
//!
//! The formulas use it: with angles exact and functions this precise, a formula's result is the true
//! value rounded once. Angles are in degrees, as drawings give them, so that the exact values at 0°,
//! 30°, 45°, 60° and 90° come out exactly. Results have a relative error below 2⁻¹⁷⁰ (6e-52), for
//! angles as small as 5e-324° too.

use std::sync::LazyLock;

use dashu_int::IBig;

use crate::quantity::Rational;

/// Bits after the binary point in the series. Their terms and roundings number below 60, so the sums
/// are good to 2⁻¹⁸⁵.
const FRACTION_BITS: usize = 192;

/// Degrees to radians.
pub(crate) fn radians(degrees: &Rational) -> Rational {
    static PER_DEGREE: LazyLock<Rational> = LazyLock::new(|| Rational::pi() / &Rational::integer(180));
    degrees * &*PER_DEGREE
}

/// Sine of an angle in degrees. Domain: −90° to 90°.
pub(crate) fn sin(degrees: &Rational) -> Rational {
    if degrees.is_negative() {
        return -&sin(&degrees.abs());
    }
    if *degrees == 30 {
        return Rational::fraction(1, 2);
    }
    if *degrees > 45 {
        return cos_below_45(&(&Rational::integer(90) - degrees));
    }
    sin_below_45(degrees)
}

/// Cosine of an angle in degrees. Domain: −90° to 90°.
pub(crate) fn cos(degrees: &Rational) -> Rational {
    let degrees = degrees.abs();
    if degrees == 60 {
        return Rational::fraction(1, 2);
    }
    if degrees > 45 {
        return sin_below_45(&(&Rational::integer(90) - &degrees));
    }
    cos_below_45(&degrees)
}

/// Tangent of an angle in degrees. Domain: above −90°, below 90°.
pub(crate) fn tan(degrees: &Rational) -> Rational {
    if *degrees == 45 {
        return Rational::ONE;
    }
    &sin(degrees) / &cos(degrees)
}

/// Arc sine in degrees. Domain: −1 to 1; `None` outside it.
pub(crate) fn asin(x: &Rational) -> Option<Rational> {
    if x.is_negative() {
        return asin(&-x).map(|angle| -&angle);
    }
    if *x == 1 {
        return Some(Rational::integer(90));
    }
    // tan φ = x / √(1 - x²)
    let cosine = (&Rational::ONE - &x.square()).sqrt()?;
    Some(atan(&(x / &cosine)))
}

/// Arc tangent in degrees.
pub(crate) fn atan(t: &Rational) -> Rational {
    if t.is_negative() {
        return -&atan(&-t);
    }
    if *t == 1 {
        return Rational::integer(45);
    }
    if *t > 1 {
        return &Rational::integer(90) - &atan(&(&Rational::ONE / t));
    }
    let degree = &Rational::integer(180) / Rational::pi();
    // The first approximation has 50 correct bits, or is the tangent itself where that is as good.
    let start = if *t < Rational::fraction(1, 1_000_000_000) {
        t.clone()
    } else {
        Rational::from_shortest_decimal(libm::atan(t.to_f64())).unwrap_or_else(|| t.clone())
    };
    let mut angle = &start * &degree;
    // tan(φ - φ₀) = (t cos φ₀ - sin φ₀) / (cos φ₀ + t sin φ₀) = d, and φ - φ₀ = d within d³/3: the
    // number of correct bits trebles with each step.
    for _ in 0..3 {
        let (sine, cosine) = (sin(&angle), cos(&angle));
        let d = &(&(t * &cosine) - &sine) / &(&cosine + &(t * &sine));
        angle = (&angle + &(&d * &degree)).round_significant(60);
    }
    angle
}

/// Σ (−1)ⁿ x²ⁿ / (first·(first+1)·…): the cosine series for `first` = 1, that of sin(x)/x for 2.
fn series(degrees: &Rational, first: u32) -> Rational {
    let square = radians(degrees).square().to_fixed_point(FRACTION_BITS);
    let mut term = IBig::ONE << FRACTION_BITS;
    let mut sum = term.clone();
    let mut k = first;
    while term != IBig::ZERO {
        term = -((term * &square) >> FRACTION_BITS) / IBig::from(k * (k + 1));
        sum += &term;
        k += 2;
    }
    Rational::from_parts(sum, dashu_int::UBig::ONE << FRACTION_BITS)
}

fn sin_below_45(degrees: &Rational) -> Rational {
    &series(degrees, 2) * &radians(degrees)
}

fn cos_below_45(degrees: &Rational) -> Rational {
    series(degrees, 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decimal(text: &str) -> Rational {
        Rational::parse_decimal(text).unwrap()
    }

    /// Relative difference below 1e-50.
    fn close(a: &Rational, b: &Rational) -> bool {
        (a - b).abs() <= &b.abs() * &decimal("1e-50")
    }

    #[test]
    fn exact_where_the_value_is_rational() {
        assert_eq!(sin(&decimal("30")), decimal("0.5"));
        assert_eq!(sin(&decimal("-90")), decimal("-1"));
        assert_eq!(cos(&decimal("60")), decimal("0.5"));
        assert_eq!(cos(&decimal("-90")), Rational::ZERO);
        assert_eq!(tan(&decimal("45")), Rational::ONE);
        assert_eq!(sin(&Rational::ZERO), Rational::ZERO);
        assert_eq!(cos(&Rational::ZERO), Rational::ONE);
        assert_eq!(asin(&decimal("1")), Some(decimal("90")));
        assert_eq!(asin(&decimal("1.01")), None);
    }

    #[test]
    fn fifty_digits() {
        // tan² 30° = 1/3, cos² 45° = 1/2, sin 18° = (√5 - 1)/4
        assert!(close(&tan(&decimal("30")).square(), &Rational::fraction(1, 3)));
        assert!(close(&cos(&decimal("45")).square(), &Rational::fraction(1, 2)));
        let golden = &(&decimal("5").sqrt().unwrap() - &Rational::ONE) / &Rational::integer(4);
        assert!(close(&sin(&decimal("18")), &golden));
        assert!(close(&sin(&decimal("1e-300")), &radians(&decimal("1e-300"))));
    }

    #[test]
    fn inverses_return() {
        for text in ["1e-300", "1e-9", "0.25", "19.9", "44.999", "45.001", "60", "89.9", "-12.5"] {
            let angle = decimal(text);
            assert!(close(&atan(&tan(&angle)), &angle), "atan tan {text}");
            assert!(close(&asin(&sin(&angle)).unwrap(), &angle), "asin sin {text}");
        }
    }
}
