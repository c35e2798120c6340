//! Where the pinion's rotation is expected at the next stroke. Called by the solver, which takes it as a guess to start
//! from; no result depends on it by more than rounding.

use super::Carrier;

/// A guess reaches this many times as far as the last two strokes are apart.
const FORESIGHT: f64 = 2.0;

/// The last solutions, for a guess at the next one: between changes of contact the rotation is smooth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trail {
    stroke: f64,
    offset: f64,
    /// The stroke before.
    before: f64,
    /// Divided differences of the offset; 0 as long as too few solutions have the same contacts.
    slope: f64,
    bend: f64,
    right: Carrier,
    left: Carrier,
}

impl Trail {
    /// The trail with one more solution.
    pub(super) fn extended(trail: Option<Self>, stroke: f64, offset: f64, right: Carrier, left: Carrier) -> Self {
        let mut here = Self { stroke, offset, before: stroke, slope: 0.0, bend: 0.0, right, left };
        if let Some(last) = trail
            && last.stroke != stroke
        {
            here.before = last.stroke;
            if last.right == right && last.left == left {
                here.slope = (offset - last.offset) / (stroke - last.stroke);
                if last.slope != 0.0 && last.before != stroke {
                    here.bend = (here.slope - last.slope) / (stroke - last.before);
                }
            }
        }
        here
    }

    /// The offset at a stroke nearby.
    pub(super) fn offset_at(&self, stroke: f64) -> Option<f64> {
        let by = stroke - self.stroke;
        let near = by.abs() <= FORESIGHT * (self.stroke - self.before).abs();
        near.then_some(self.offset + by * (self.slope + self.bend * (stroke - self.before)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::ContactKind;

    fn carrier(rack_tooth: i64) -> Carrier {
        Carrier { rack_tooth, pinion_tooth: 0, contact: ContactKind::Line }
    }

    #[test]
    fn a_parabola_goes_on() {
        let offset = |stroke: f64| 0.1 + 0.2 * stroke - 0.3 * stroke * stroke;
        let seen = [0.0, 0.1, 0.25];
        let trail = seen
            .iter()
            .fold(None, |trail, &stroke| Some(Trail::extended(trail, stroke, offset(stroke), carrier(1), carrier(1))));
        let trail = trail.expect("three solutions");
        for stroke in [0.3, 0.4, 0.2, 0.05] {
            let expected = trail.offset_at(stroke).expect("nearby");
            assert!((expected - offset(stroke)).abs() < 1e-15, "{stroke}: {expected}");
        }
        assert_eq!(trail.offset_at(0.6), None);
    }

    #[test]
    fn another_contact_begins_anew() {
        let trail = Trail::extended(None, 0.0, 0.0, carrier(1), carrier(1));
        assert_eq!(trail.offset_at(0.1), None, "a single solution says nothing of how far it holds");
        let trail = Trail::extended(Some(trail), 0.1, 1.0, carrier(1), carrier(1));
        let trail = Trail::extended(Some(trail), 0.2, 3.0, carrier(2), carrier(1));
        assert_eq!(trail.offset_at(0.3), Some(3.0));
        assert_eq!(trail.offset_at(0.2), Some(3.0));
    }

    #[test]
    fn the_same_stroke_again_divides_by_nothing() {
        let mut trail = None;
        for stroke in [0.0, 0.1, 0.1, 0.0, 0.1, 0.0, 0.0] {
            let next = Trail::extended(trail, stroke, 5.0, carrier(1), carrier(1));
            assert!(next.offset_at(stroke).is_none_or(|offset| offset == 5.0));
            trail = Some(next);
        }
    }
}
