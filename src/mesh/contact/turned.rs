//! Sines and cosines of a generator's angle δ against the contact line. Called by the closed forms, which need them at
//! a few places of each flank pair and mostly for small angles; knows nothing of edges.

use super::FlankContact;
use crate::trig;

/// Up to this angle (rad) the series below hold to rounding: what they leave out is less than 1e-17 of their sums.
const SERIES: f64 = 0.3;

/// A generator, by its angle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turned {
    pub(super) delta: f64,
    /// sin δ, 1 − cos δ and δ − sin δ.
    pub(super) sin_delta: f64,
    pub(super) versine: f64,
    pub(super) lag: f64,
    /// Sine and cosine of γ = ν + δ.
    pub(super) sin: f64,
    pub(super) cos: f64,
}

impl FlankContact {
    pub(super) fn turned(&self, delta: f64) -> Turned {
        let (lag, versine) = if delta.abs() <= SERIES {
            let s = delta * delta;
            let lag = 1.0 / 6.0
                - s * (1.0 / 120.0
                    - s * (1.0 / 5040.0 - s * (1.0 / 362_880.0 - s * (1.0 / 39_916_800.0 - s / 6_227_020_800.0))));
            let versine = 0.5
                - s * (1.0 / 24.0
                    - s * (1.0 / 720.0 - s * (1.0 / 40_320.0 - s * (1.0 / 3_628_800.0 - s / 479_001_600.0))));
            (delta * s * lag, s * versine)
        } else {
            let (sin, cos) = trig::sin_cos(delta);
            (delta - sin, 1.0 - cos)
        };
        let sin_delta = delta - lag;
        Turned {
            delta,
            sin_delta,
            versine,
            lag,
            sin: self.sin_nu + (self.cos_nu * sin_delta - self.sin_nu * versine),
            cos: self.cos_nu - (self.sin_nu * sin_delta + self.cos_nu * versine),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_are_the_functions() {
        let nu = 0.35;
        let (sin_nu, cos_nu) = trig::sin_cos(nu);
        let contact = FlankContact { nu, sin_nu, cos_nu, ..FlankContact::default() };
        let mut worst = 0.0_f64;
        for step in -1000..=1000 {
            let delta = 4e-4 * f64::from(step);
            let turned = contact.turned(delta);
            let (half, (sin, cos)) = (trig::sin(0.5 * delta), trig::sin_cos(nu + delta));
            // the terms of δ − sin δ, each from the last, the smallest first
            let mut lag = 0.0;
            for term in (1..12).rev().map(|term| 2.0 * f64::from(term)) {
                lag = delta * delta / (term * (term + 1.0)) * (1.0 - lag);
            }
            for (found, expected, scale) in [
                (turned.lag, delta * lag, if delta.abs() <= SERIES { delta * lag } else { delta }),
                (turned.sin_delta, trig::sin(delta), delta),
                (turned.versine, 2.0 * half * half, delta * delta),
                (turned.sin, sin, 1.0),
                (turned.cos, cos, 1.0),
            ] {
                worst = worst.max((found - expected).abs() / scale.abs().max(f64::MIN_POSITIVE));
            }
        }
        println!("largest error {worst:e}");
        assert!(worst < 1e-15, "{worst:e}");
    }
}
