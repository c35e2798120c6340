//! Random numbers: a generator per block, and the distributions drawn from it. Only simulations call it.
//!
//! Every block of draws has its own generator, seeded from the run's seed and the block's number, so that the draws are
//! the same whichever thread makes them. The generator is xoshiro256++ (Blackman and Vigna 2019), from its reference
//! crate. The normal distribution is drawn by the ziggurat method (Marsaglia and Tsang 2000) with 256 layers, here
//! because other implementations take exponentials from the platform, whose bits differ.

use std::f64::consts::TAU;

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng as _, SeedableRng as _};

use crate::trig;
use crate::uncertainty::{Distribution, Uncertainty};

/// Where the base layer's tail starts, for 256 layers of equal area.
const TAIL: f64 = 3.654_152_885_361_009;
const LAYERS: usize = 256;

/// The layers of the ziggurat, from the base upwards.
#[derive(Debug)]
pub(crate) struct Ziggurat {
    /// Right edges, falling; the first is that of a rectangle with the area of the base layer and its tail.
    x: [f64; LAYERS + 1],
    /// exp(−x²/2) at these.
    f: [f64; LAYERS + 1],
}

impl Ziggurat {
    pub(crate) fn new() -> Self {
        let density = |x: f64| libm::exp(-0.5 * x * x);
        let tail = (TAU / 4.0).sqrt() * libm::erfc(TAIL * std::f64::consts::FRAC_1_SQRT_2);
        let area = TAIL * density(TAIL) + tail;
        let (mut x, mut f) = ([0.0; LAYERS + 1], [0.0; LAYERS + 1]);
        x[0] = area / density(TAIL);
        x[1] = TAIL;
        for i in 2..LAYERS {
            let height = density(x[i - 1]) + area / x[i - 1];
            x[i] = (-2.0 * libm::log(height.min(1.0))).sqrt();
        }
        for i in 0..=LAYERS {
            f[i] = density(x[i]);
        }
        Self { x, f }
    }
}

/// The generator of one block.
#[derive(Debug)]
pub(crate) struct Random {
    generator: Xoshiro256PlusPlus,
}

/// Mixes the bits of a counter: the finaliser of SplitMix64.
const fn mixed(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

impl Random {
    /// The generator of block `block` of the run with `seed`.
    pub(crate) fn of_block(seed: u64, block: u64) -> Self {
        // seed and block must not show in each other's bits: each word is hashed with both
        let mut bytes = [0; 32];
        let mut state = mixed(seed.wrapping_add(0x9e37_79b9_7f4a_7c15));
        for (word, chunk) in (1_u64..).zip(bytes.chunks_exact_mut(8)) {
            state = mixed(state ^ mixed(block.wrapping_mul(4).wrapping_add(word)));
            chunk.copy_from_slice(&state.to_le_bytes());
        }
        Self { generator: Xoshiro256PlusPlus::from_seed(bytes) }
    }

    fn bits(&mut self) -> u64 {
        self.generator.next_u64()
    }

    /// Uniform in [0, 1), 53 bits.
    #[inline]
    pub(crate) fn uniform(&mut self) -> f64 {
        let value = (self.bits() >> 11) as f64;
        value * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Uniform in (0, 1).
    fn open_uniform(&mut self) -> f64 {
        self.uniform() + 0.5 / 9_007_199_254_740_992.0
    }

    /// Standard normal.
    #[inline]
    pub(crate) fn normal(&mut self, ziggurat: &Ziggurat) -> f64 {
        loop {
            let bits = self.bits();
            let layer = (bits & 0xff) as usize;
            // the high 53 bits, signed: uniform in [−1, 1)
            let u = ((bits as i64) >> 11) as f64 * (1.0 / 4_503_599_627_370_496.0);
            let x = u * ziggurat.x[layer];
            if x.abs() < ziggurat.x[layer + 1] {
                return x;
            }
            if let Some(x) = self.beside(ziggurat, layer, x) {
                return x;
            }
        }
    }

    /// The rare cases: the tail, and the edge of a layer.
    #[cold]
    fn beside(&mut self, ziggurat: &Ziggurat, layer: usize, x: f64) -> Option<f64> {
        if layer == 0 {
            loop {
                let beyond = -libm::log(self.open_uniform()) / TAIL;
                let height = -libm::log(self.open_uniform());
                if 2.0 * height > beyond * beyond {
                    return Some((TAIL + beyond).copysign(x));
                }
            }
        }
        let (below, above) = (ziggurat.f[layer], ziggurat.f[layer + 1]);
        let height = below + (above - below) * self.uniform();
        (height < libm::exp(-0.5 * x * x)).then_some(x)
    }

    /// Student's t by Bailey's polar method (1994).
    pub(crate) fn student(&mut self, dof: f64) -> f64 {
        loop {
            let (u, v) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let w = u * u + v * v;
            if w > 0.0 && w <= 1.0 {
                return u * (dof * (libm::pow(w, -2.0 / dof) - 1.0) / w).sqrt();
            }
        }
    }

    /// About 0, as an uncertainty says that it is spread; normal whatever its degrees of freedom.
    #[inline]
    pub(crate) fn spread(&mut self, uncertainty: &Uncertainty, ziggurat: &Ziggurat) -> f64 {
        let half = uncertainty.standard * uncertainty.distribution.half_width();
        match uncertainty.distribution {
            Distribution::Normal => uncertainty.standard * self.normal(ziggurat),
            Distribution::Rectangular => half * (2.0 * self.uniform() - 1.0),
            Distribution::Triangular => half * self.triangular(),
            Distribution::Arcsine => half * self.arcsine(),
        }
    }

    /// Of half-width 1, falling linearly from 0.
    pub(crate) fn triangular(&mut self) -> f64 {
        self.uniform() + self.uniform() - 1.0
    }

    /// Of half-width 1, as of a sine wave.
    pub(crate) fn arcsine(&mut self) -> f64 {
        trig::sin(TAU * self.uniform())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::{normal_cdf, student_cdf};

    /// The largest distance of the empirical distribution from `cdf`, times √n: beyond 1.95 once in a thousand.
    fn kolmogorov(mut values: Vec<f64>, cdf: impl Fn(f64) -> f64) -> f64 {
        values.sort_unstable_by(f64::total_cmp);
        let n = values.len() as f64;
        let mut distance: f64 = 0.0;
        let mut i = 0.0;
        for value in values {
            let p = cdf(value);
            distance = distance.max((p - i / n).abs()).max((p - (i + 1.0) / n).abs());
            i += 1.0;
        }
        distance * n.sqrt()
    }

    #[test]
    fn the_layers_close_at_the_top() {
        let ziggurat = Ziggurat::new();
        // the last layer's area reaches up to the density's peak
        let area = ziggurat.x[0] * ziggurat.f[1];
        assert!((ziggurat.f[LAYERS - 1] + area / ziggurat.x[LAYERS - 1] - 1.0).abs() < 1e-9);
        assert!(ziggurat.x.windows(2).all(|pair| pair[0] > pair[1]));
    }

    #[test]
    fn drawn_values_follow_their_distributions() {
        let ziggurat = Ziggurat::new();
        let mut random = Random::of_block(1, 7);
        let mut draw = |f: &mut dyn FnMut(&mut Random) -> f64| (0..200_000).map(|_| f(&mut random)).collect::<Vec<_>>();
        let normal = draw(&mut |random| random.normal(&ziggurat));
        assert!(kolmogorov(normal.clone(), normal_cdf) < 1.95);
        // the tail beyond the base layer is drawn on its own
        let tail = normal.iter().filter(|x| x.abs() > TAIL).count();
        assert!((20..90).contains(&tail), "{tail} of 52 expected");
        assert!(kolmogorov(draw(&mut |random| random.student(4.0)), |t| student_cdf(t, 4.0)) < 1.95);
        assert!(kolmogorov(draw(&mut Random::uniform), |x| x) < 1.95);
        let triangular = |x: f64| if x < 0.0 { 0.5 * (1.0 + x) * (1.0 + x) } else { 1.0 - 0.5 * (1.0 - x) * (1.0 - x) };
        assert!(kolmogorov(draw(&mut Random::triangular), triangular) < 1.95);
        assert!(kolmogorov(draw(&mut Random::arcsine), |x| 0.5 + 2.0 * trig::asin(x) / TAU) < 1.95);
    }

    #[test]
    fn blocks_and_seeds_are_unrelated() {
        let first = |seed, block| Random::of_block(seed, block).bits();
        let mut seen: Vec<u64> = (0..100).flat_map(|seed| (0..100).map(move |block| first(seed, block))).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 10_000);
    }
}
