//! Distribution functions and quantiles: normal, Student's t, χ², bivariate normal. Called by uncertainties, decision
//! rules and capability; knows nothing of gears.
//!
//! Everything rests on the pure-Rust `libm` (erf, erfc) and `special` (incomplete beta and gamma functions), so that
//! results are the same bits on every platform. Accuracy: distribution functions to 1e-14 absolute, the normal one to
//! 1e-15 relative, quantiles as far as those allow; the tests hold them against printed tables and against each other.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use special::{Beta as _, Gamma as _};

use crate::trig;

/// Above this many degrees of freedom Student's distribution is expanded about the normal one: the incomplete beta
/// function takes time in proportion to them.
const EXPANDED: f64 = 1000.0;

/// Φ(z): the probability that a standard normal variable is at most `z`.
#[must_use]
pub fn normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

/// φ(z): the density of the standard normal distribution.
#[must_use]
pub fn normal_density(z: f64) -> f64 {
    libm::exp(-0.5 * z * z) / TAU.sqrt()
}

/// z with Φ(z) = `p`; infinite at 0 and 1, NaN outside.
#[must_use]
pub fn normal_quantile(p: f64) -> f64 {
    if !(0.0..=1.0).contains(&p) {
        return f64::NAN;
    }
    if p == 0.0 || p == 1.0 {
        return if p == 0.0 { f64::NEG_INFINITY } else { f64::INFINITY };
    }
    if p > 0.5 {
        return -normal_quantile(1.0 - p);
    }
    // Abramowitz and Stegun 26.2.23, good to 4.5e-4, then Halley's method, which triples the digits each time: twice
    // are enough
    let t = (-2.0 * libm::log(p)).sqrt();
    let mut z =
        (2.515_517 + t * (0.802_853 + t * 0.010_328)) / (1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308))) - t;
    for _ in 0..2 {
        let step = (normal_cdf(z) - p) / normal_density(z);
        if step.is_finite() {
            z -= step / (1.0 + 0.5 * z * step);
        }
    }
    z
}

/// The probability that Student's t with `dof` degrees of freedom is at most `t`.
///
/// Source: P = 1 − I_x(ν/2, 1/2)/2 with x = ν/(ν + t²) for t ≥ 0.
#[must_use]
pub fn student_cdf(t: f64, dof: f64) -> f64 {
    if dof > EXPANDED {
        /// Beyond so many standard deviations the probability is 0 or 1 to the last digit.
        const FURTHEST: f64 = 39.0;
        if t.abs() > FURTHEST {
            return normal_cdf(t);
        }
        // the derivative is 1 to within 1/ν: each step gains three digits and more
        let z = (0..6).fold(t, |z, _| z - (expanded_student_quantile(z, dof) - t));
        return normal_cdf(z);
    }
    let (a, b) = (0.5 * dof, 0.5);
    let tail = 0.5 * (dof / (dof + t * t)).inc_beta(a, b, a.ln_beta(b));
    if t >= 0.0 { 1.0 - tail } else { tail }
}

/// t with [`student_cdf`] = `p`.
#[must_use]
pub fn student_quantile(p: f64, dof: f64) -> f64 {
    if dof.is_infinite() || !(p > 0.0 && p < 1.0) {
        return normal_quantile(p);
    }
    if p < 0.5 {
        return -student_quantile(1.0 - p, dof);
    }
    if dof > EXPANDED {
        return expanded_student_quantile(normal_quantile(p), dof);
    }
    // the upper tail, so that p near 1 keeps its digits
    rising(|t| p - student_cdf(t, dof))
}

/// Student's t from the normal quantile z, by falling powers of ν.
///
/// Source: Abramowitz and Stegun, 26.7.5; the first term left out is below 1e-13 for the ν and z that it is asked for,
/// while the incomplete beta function takes time in proportion to ν.
fn expanded_student_quantile(z: f64, dof: f64) -> f64 {
    let s = z * z;
    let terms = [
        z * (s + 1.0) / 4.0,
        z * ((5.0 * s + 16.0) * s + 3.0) / 96.0,
        z * (((3.0 * s + 19.0) * s + 17.0) * s - 15.0) / 384.0,
        z * ((((79.0 * s + 776.0) * s + 1482.0) * s - 1920.0) * s - 945.0) / 92_160.0,
    ];
    z + terms.iter().rev().fold(0.0, |sum, term| (sum + term) / dof)
}

/// The probability that χ² with `dof` degrees of freedom is at most `x`.
#[must_use]
pub fn chi_square_cdf(x: f64, dof: f64) -> f64 {
    if x <= 0.0 { 0.0 } else { (0.5 * x).inc_gamma(0.5 * dof) }
}

/// x with [`chi_square_cdf`] = `p`.
#[must_use]
pub fn chi_square_quantile(p: f64, dof: f64) -> f64 {
    rising(|x| p - chi_square_cdf(x, dof))
}

/// I_p(a, b): the distribution function of the beta distribution.
#[must_use]
pub fn beta_cdf(p: f64, a: f64, b: f64) -> f64 {
    if p <= 0.0 {
        0.0
    } else if p >= 1.0 {
        1.0
    } else {
        p.inc_beta(a, b, a.ln_beta(b))
    }
}

/// p with [`beta_cdf`] = `share`.
#[must_use]
pub fn beta_quantile(share: f64, a: f64, b: f64) -> f64 {
    rising(|p| share - beta_cdf(p, a, b)).min(1.0)
}

/// The largest x from 0 at which `missing`, which falls as x rises, is still positive.
fn rising(missing: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while missing(high) > 0.0 && high < 1e300 {
        high *= 2.0;
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if missing(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// P(X ≤ h and Y ≤ k) of two standard normal variables with correlation `rho`.
///
/// Source: Φ(h) Φ(k) + 1/(2π) ∫ exp(−(h² − 2 h k sin θ + k²)/(2 cos² θ)) dθ from 0 to arcsin ρ (Plackett 1954; Drezner
/// and Wesolowsky 1990), integrated to 1e-12.
#[must_use]
pub fn bivariate_normal_cdf(h: f64, k: f64, rho: f64) -> f64 {
    if h == f64::INFINITY {
        return normal_cdf(k);
    }
    if k == f64::INFINITY {
        return normal_cdf(h);
    }
    if h == f64::NEG_INFINITY || k == f64::NEG_INFINITY {
        return 0.0;
    }
    if rho >= 1.0 {
        return normal_cdf(h.min(k));
    }
    if rho <= -1.0 {
        return (normal_cdf(h) - normal_cdf(-k)).max(0.0);
    }
    let integrand = |theta: f64| {
        // the largest correlation below 1 leaves a cosine of 1.5e-8
        let (sin, cos) = trig::sin_cos(theta);
        libm::exp(-(h * h - 2.0 * h * k * sin + k * k) / (2.0 * cos * cos))
    };
    let end = trig::asin(rho);
    // eight pieces at first, so that a narrow peak is not stepped over
    let pieces = (0_u32..8).map(|i| {
        let at = |i: u32| end * (f64::from(i) / 8.0);
        let (a, b) = (at(i), at(i + 1));
        let ends = (integrand(a), integrand(0.5 * (a + b)), integrand(b));
        simpson(&integrand, a, b, ends, 1e-12, 30)
    });
    (normal_cdf(h) * normal_cdf(k) + pieces.sum::<f64>() / (2.0 * PI)).clamp(0.0, 1.0)
}

fn simpson(f: &impl Fn(f64) -> f64, a: f64, b: f64, (fa, fm, fb): (f64, f64, f64), tolerance: f64, depth: u32) -> f64 {
    let m = 0.5 * (a + b);
    let (fl, fr) = (f(0.5 * (a + m)), f(0.5 * (m + b)));
    let whole = (b - a) / 6.0 * (fa + 4.0 * fm + fb);
    let (left, right) = ((m - a) / 6.0 * (fa + 4.0 * fl + fm), (b - m) / 6.0 * (fm + 4.0 * fr + fb));
    let error = left + right - whole;
    let Some(depth) = depth.checked_sub(1).filter(|_| error.abs() > 15.0 * tolerance) else {
        return left + right + error / 15.0;
    };
    let half = 0.5 * tolerance;
    simpson(f, a, m, (fa, fl, fm), half, depth) + simpson(f, m, b, (fm, fr, fb), half, depth)
}

/// Mean and standard deviation of |X| for a normal X: the folded normal distribution.
///
/// Source: E|X| = σ √(2/π) exp(−μ²/(2σ²)) + μ erf(μ/(σ√2)), E|X|² = μ² + σ² (Leone, Nelson and Nottingham 1961).
/// Tests of magnitudes compare with it.
#[cfg(test)]
pub(crate) fn folded_normal(mean: f64, deviation: f64) -> (f64, f64) {
    if deviation <= 0.0 {
        return (mean.abs(), 0.0);
    }
    let z = mean / deviation;
    let folded = deviation * (2.0 / PI).sqrt() * libm::exp(-0.5 * z * z) + mean * libm::erf(z * FRAC_1_SQRT_2);
    (folded, (mean * mean + deviation * deviation - folded * folded).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_quantiles_as_printed_and_back() {
        for (p, z) in [(0.975, 1.959_963_984_540_054), (0.95, 1.644_853_626_951_472_2), (0.5, 0.0), (0.001, -3.090_232)]
        {
            assert!((normal_quantile(p) - z).abs() < 1e-6, "{p}");
        }
        assert!((normal_quantile(0.975) - 1.959_963_984_540_054).abs() < 1e-14);
        for exponent in 1..300 {
            let p = libm::pow(10.0, -f64::from(exponent));
            assert!((normal_cdf(normal_quantile(p)) / p - 1.0).abs() < 1e-12, "1e-{exponent}");
        }
        assert!(normal_quantile(1.5).is_nan());
        assert_eq!((normal_quantile(0.0), normal_quantile(1.0)), (f64::NEG_INFINITY, f64::INFINITY));
    }

    #[test]
    fn student_quantiles_below_the_middle_and_at_the_ends() {
        for dof in [3.0, 5000.0, f64::INFINITY] {
            assert!((student_quantile(0.025, dof) + student_quantile(0.975, dof)).abs() < 1e-12, "{dof}");
            assert!(student_quantile(0.5, dof).abs() < 1e-12, "{dof}");
            assert_eq!(student_quantile(0.0, dof), f64::NEG_INFINITY, "{dof}");
            assert_eq!(student_quantile(1.0, dof), f64::INFINITY, "{dof}");
        }
        // χ² of one degree of freedom is the square of a normal variable, Student's t of one is Cauchy's
        assert!((student_quantile(0.75, 1.0) - 1.0).abs() < 1e-12);
        assert!((chi_square_quantile(0.95, 1.0).sqrt() - normal_quantile(0.975)).abs() < 1e-12);
    }

    /// All four terms of the expansion, where they are large enough to be seen.
    #[test]
    fn the_expansion_of_students_quantile() {
        for p in [0.75, 0.9] {
            let expanded = expanded_student_quantile(normal_quantile(p), 100.0);
            assert!((expanded - student_quantile(p, 100.0)).abs() < 2e-11, "{p} {expanded}");
        }
    }

    /// The furthest quantiles that are asked for lie far above the first step of the search.
    #[test]
    fn quantiles_far_from_zero() {
        assert!((chi_square_quantile(0.5, 1e6) - 1e6 + 2.0 / 3.0).abs() < 1e-2);
        assert!((beta_quantile(0.5, 2.0, 2.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn student_quantiles_of_jcgm_100_table_g2() {
        // JCGM 100:2008, Table G.2: two-sided factors for 95 %, 95.45 % and 99 %
        for (dof, p95, p9545, p99) in [
            (1.0, 12.71, 13.97, 63.66),
            (2.0, 4.30, 4.53, 9.92),
            (3.0, 3.18, 3.31, 5.84),
            (5.0, 2.57, 2.65, 4.03),
            (10.0, 2.23, 2.28, 3.17),
            (20.0, 2.09, 2.13, 2.85),
            (50.0, 2.01, 2.05, 2.68),
            (f64::INFINITY, 1.960, 2.000, 2.576),
        ] {
            for (confidence, printed) in [(0.95, p95), (0.9545, p9545), (0.99, p99)] {
                let t = student_quantile(0.5 + 0.5 * confidence, dof);
                let rounding = if dof.is_finite() { 0.005_001 } else { 0.000_51 };
                assert!((t - printed).abs() < rounding, "{dof} {confidence}: {t}");
            }
        }
    }

    #[test]
    fn many_degrees_of_freedom_take_no_time_and_meet_few() {
        for p in [0.6, 0.975, 0.977_249_868, 0.999] {
            let (few, many) = (student_quantile(p, EXPANDED), student_quantile(p, EXPANDED.next_up()));
            assert!((few - many).abs() < 1e-11, "{p}: {few} {many}");
            // no sum over the degrees of freedom would end
            for dof in [1e4, 1e8, 1e15, 1e300] {
                let t = student_quantile(p, dof);
                assert!(t >= normal_quantile(p) && t < few, "{p} {dof}");
                assert!((student_cdf(t, dof) - p).abs() < 1e-14, "{p} {dof}");
            }
        }
        for t in [-1e6, -50.0, 0.0, 50.0, 1e300] {
            let expected = if t == 0.0 { 0.5 } else { f64::from(u8::from(t > 0.0)) };
            assert_eq!(student_cdf(t, 1e6), expected, "{t}");
        }
    }

    #[test]
    fn chi_square_quantiles_as_printed() {
        for (p, dof, printed) in [(0.95, 1.0, 3.841), (0.025, 10.0, 3.247), (0.975, 10.0, 20.483), (0.5, 100.0, 99.334)]
        {
            assert!((chi_square_quantile(p, dof) - printed).abs() < 0.000_51, "{p} {dof}");
        }
    }

    #[test]
    fn two_normal_variables() {
        for rho in [-1.0, -0.9999, -0.95, -0.5, 0.0, 0.3, 0.9, 0.99, 0.999_999, 1.0] {
            // Sheppard: P(X ≤ 0 and Y ≤ 0) = 1/4 + arcsin ρ / (2π)
            let quarter = 0.25 + trig::asin(rho) / TAU;
            assert!((bivariate_normal_cdf(0.0, 0.0, rho) - quarter).abs() < 1e-11, "{rho}");
            for (h, k) in [(-1.0, 0.5), (2.0, 1.99), (0.3, -2.5), (4.0, 1.0)] {
                // what X ≤ h and Y ≤ k leaves of X ≤ h is X ≤ h and −Y ≤ −k
                let both = bivariate_normal_cdf(h, k, rho) + bivariate_normal_cdf(h, -k, -rho);
                assert!((both - normal_cdf(h)).abs() < 1e-10, "{h} {k} {rho}");
            }
        }
        let independent = bivariate_normal_cdf(1.0, 2.0, 0.0);
        assert!((independent - normal_cdf(1.0) * normal_cdf(2.0)).abs() < 1e-15);
    }

    /// P(X ≤ h and Y ≤ k) to twenty digits, from ∫ φ(x) Φ((k − ρx)/√(1 − ρ²)) dx up to h, taken with thirty.
    #[test]
    fn two_normal_variables_to_the_last_digits() {
        for (h, k, rho, expected) in [
            (0.5, -0.25, 0.75, 0.379_659_403_511_303_7),
            (1.0, 2.0, -0.875, 0.818_594_614_148_522_2),
            (-1.5, -1.25, 0.968_75, 0.063_592_946_866_664_37),
            (3.0, 2.5, 0.5, 0.992_661_199_936_854_6),
            (-3.0, -3.0, 0.9375, 0.000_750_380_021_130_520_6),
            (1.25, 1.25, -0.999_023_437_5, 0.788_700_452_666_289_5),
        ] {
            let found = bivariate_normal_cdf(h, k, rho);
            assert!((found - expected).abs() < 1e-14, "{h} {k} {rho}: {found} {expected}");
        }
    }

    /// What is sure or impossible for one of two leaves the other or nothing.
    #[test]
    fn two_normal_variables_of_which_one_is_without_bound() {
        let (never, always) = (f64::NEG_INFINITY, f64::INFINITY);
        for rho in [-1.0, -0.5, 0.0, 0.75, 1.0] {
            for (h, k) in [(never, 0.5), (0.5, never), (never, never), (never, always), (always, never)] {
                assert_eq!(bivariate_normal_cdf(h, k, rho), 0.0, "{h} {k} {rho}");
            }
            for (h, k) in [(always, 0.5), (0.5, always)] {
                assert_eq!(bivariate_normal_cdf(h, k, rho), normal_cdf(0.5), "{h} {k} {rho}");
            }
            assert_eq!(bivariate_normal_cdf(always, always, rho), 1.0);
        }
    }

    /// No number is asked for once, not bisected without end.
    #[test]
    fn what_is_no_number_has_no_probability() {
        for (h, k, rho) in [(f64::NAN, 0.5, 0.25), (0.5, f64::NAN, -0.25), (1.0, 0.5, f64::NAN)] {
            assert!(bivariate_normal_cdf(h, k, rho).is_nan());
        }
    }

    #[test]
    fn folding_far_from_zero_changes_nothing_and_at_zero_halves() {
        let (mean, deviation) = folded_normal(-10.0, 1.0);
        assert!((mean - 10.0).abs() < 1e-12 && (deviation - 1.0).abs() < 1e-12);
        let (mean, deviation) = folded_normal(0.0, 3.0);
        assert!((mean - 3.0 * (2.0 / PI).sqrt()).abs() < 1e-12);
        assert!((deviation - 3.0 * (1.0 - 2.0 / PI).sqrt()).abs() < 1e-12);
    }
}
