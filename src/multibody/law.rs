//! The contact force of one element. Called for every element that touches; knows no geometry.

use super::Parameters;

/// f = k δ^a + c sgn(δ') |δ'|^b δ^e, never pulling.
#[derive(Debug, Clone, Copy)]
pub(super) struct Law {
    stiffness: f64,
    a: f64,
    /// 1/(a + 1).
    per_energy: f64,
    damping: f64,
    b: f64,
    e: f64,
    /// μ and the speed at which it fades; `None` where there is no friction.
    pub(super) friction: Option<(f64, f64)>,
}

/// A force with its derivatives.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Force {
    pub(super) value: f64,
    pub(super) by_depth: f64,
    pub(super) by_rate: f64,
    /// Elastic energy stored, N mm.
    pub(super) energy: f64,
    /// Elastic part of the value.
    pub(super) elastic: f64,
}

/// x^(p − 1) for x > 0; square roots for the usual exponents, which cost a tenth of a general power.
fn power_below(x: f64, p: f64) -> f64 {
    if p == 1.5 {
        x.sqrt()
    } else if p == 1.0 {
        1.0
    } else if p == 2.0 {
        x
    } else if p == 2.5 {
        x * x.sqrt()
    } else {
        libm::pow(x, p - 1.0)
    }
}

/// x^p for x > 0.
fn power(x: f64, p: f64) -> f64 {
    x * power_below(x, p)
}

impl Law {
    pub(super) fn new(parameters: &Parameters) -> Self {
        Self {
            stiffness: parameters.stiffness,
            a: parameters.stiffness_exponent,
            per_energy: 1.0 / (parameters.stiffness_exponent + 1.0),
            damping: parameters.damping,
            b: parameters.damping_exponent,
            e: parameters.indentation_exponent,
            friction: (parameters.friction > 0.0).then_some((parameters.friction, parameters.friction_speed_mm_per_s)),
        }
    }

    /// The same law for bodies that approach infinitely slowly.
    pub(super) fn without_damping(mut self) -> Self {
        self.damping = 0.0;
        self
    }

    /// The same law for bodies at rest.
    pub(super) fn without_friction(mut self) -> Self {
        self.friction = None;
        self
    }

    /// The force at a penetration δ > 0 that grows at the rate δ'.
    #[inline]
    pub(super) fn force(&self, depth: f64, rate: f64) -> Force {
        let secant = self.stiffness * power_below(depth, self.a);
        let elastic = secant * depth;
        let by_depth = self.a * secant;
        let energy = elastic * depth * self.per_energy;
        if self.damping == 0.0 || rate == 0.0 && self.b > 1.0 {
            return Force { value: elastic, by_depth, by_rate: 0.0, energy, elastic };
        }
        let per_rate = self.damping * power(depth, self.e);
        let speed = rate.abs();
        let (damped, slope) = if self.b == 1.0 {
            (per_rate * rate, per_rate)
        } else {
            let magnitude = per_rate * power(speed, self.b);
            (magnitude.copysign(rate), self.b * magnitude / speed)
        };
        if elastic + damped <= 0.0 {
            return Force { energy, elastic, ..Force::default() };
        }
        Force { value: elastic + damped, by_depth: by_depth + self.e * damped / depth, by_rate: slope, energy, elastic }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_differences_and_nothing_pulls() {
        for (a, b, e) in [(1.0, 1.0, 1.0), (1.5, 1.0, 1.5), (2.5, 2.0, 1.2), (1.3, 1.7, 2.5)] {
            let parameters = Parameters {
                stiffness_exponent: a,
                damping_exponent: b,
                indentation_exponent: e,
                damping: 3e5,
                ..Parameters::default()
            };
            let law = Law::new(&parameters);
            for depth in [1e-6, 3e-4, 0.02] {
                for rate in [-40.0, -1e-3, 1e-3, 0.7, 300.0] {
                    let f = law.force(depth, rate);
                    assert!(f.value >= 0.0);
                    let (h, r) = (1e-6 * depth, 1e-6 * f64::abs(rate));
                    let by_depth = (law.force(depth + h, rate).value - law.force(depth - h, rate).value) / (2.0 * h);
                    let by_rate = (law.force(depth, rate + r).value - law.force(depth, rate - r).value) / (2.0 * r);
                    // a difference of two forces carries their rounding, over its step
                    let close = |x: f64, y: f64, step: f64| {
                        let rounding = 2.0 * f64::EPSILON * f.elastic.max(f.value) / step;
                        (x - y).abs() <= 1e-7 * (x.abs() + y.abs()) + rounding
                    };
                    assert!(close(f.by_depth, by_depth, h), "{a} {b} {e} {depth} {rate}: {} {by_depth}", f.by_depth);
                    assert!(close(f.by_rate, by_rate, r), "{a} {b} {e} {depth} {rate}: {} {by_rate}", f.by_rate);
                }
            }
        }
    }
}
