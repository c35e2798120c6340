//! Where the pinion's rotation is expected at the next stroke. Written and read by the solver, kept by its sampler.

use super::Carrier;

/// The last solutions with the same carriers, for a guess at the next one: between changes of contact the rotation is smooth.
/// No result depends on it by more than rounding; without it a fixed rack takes a rotation more for most strokes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Trail {
    carriers: Option<[Carrier; 2]>,
    /// Strokes and rotations, the last one first.
    solved: [Option<(f64, f64)>; 3],
}

/// A guess reaches this many times as far as the last two strokes are apart.
const FORESIGHT: f64 = 2.0;

impl Trail {
    pub(super) fn add(&mut self, stroke: f64, offset: f64, carriers: [Carrier; 2]) {
        if self.carriers != Some(carriers) {
            *self = Self { carriers: Some(carriers), ..Self::default() };
        }
        let [last, earlier, _] = self.solved;
        self.solved = [Some((stroke, offset)), last, earlier];
    }

    /// The rotation that the parabola through them has at a stroke nearby.
    pub(super) fn at(&self, stroke: f64) -> Option<f64> {
        let [(s0, at0), (s1, at1)] = [self.solved[0]?, self.solved[1]?];
        let slope = (at0 - at1) / (s0 - s1);
        let bend = self.solved[2].map_or(0.0, |(s2, at2)| (slope - (at1 - at2) / (s1 - s2)) / (s0 - s2));
        let expected = at0 + (stroke - s0) * (slope + bend * (stroke - s1));
        ((stroke - s0).abs() <= FORESIGHT * (s0 - s1).abs() && expected.is_finite()).then_some(expected)
    }
}
