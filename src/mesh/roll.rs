//! The rack that may roll: the smallest centre distance over its roll. Called by the sampler for
//! [`Support::FreeRoll`](super::Support::FreeRoll); the fixed support never comes here.
//!
//! With a lead error the centre distance over the roll has two valleys, mirror images or nearly so: the range of rolls is
//! scanned, and every valley of the scan is refined by golden section.

use super::prepare::Roll;
use super::{MeshError, MeshPoint, Sampler};

/// Rolls considered, rad: enough to level a flank with a lead error of 1° at a pressure angle of 14°.
const LARGEST: f64 = 0.075;
/// Steps of the scan to each side.
const STEPS: i32 = 15;
/// Golden sections per valley: 0.618⁴⁰ of two steps is 4e-11 rad.
const SECTIONS: u32 = 40;

impl Sampler<'_> {
    pub(super) fn solve_rolling(&mut self, stroke_mm: f64, depth_mm: f64) -> Result<MeshPoint, MeshError> {
        let angle = |step: i32| LARGEST * f64::from(step) / f64::from(STEPS);
        let mut scan = Vec::new();
        let mut failure = None;
        for step in -STEPS..=STEPS {
            match self.at_roll(stroke_mm, angle(step), depth_mm) {
                Ok(point) => scan.push(Some(point.center_distance_mm)),
                Err(error) => {
                    failure = Some(error);
                    scan.push(None);
                }
            }
        }
        let mut best: Option<MeshPoint> = None;
        for (index, step) in (-STEPS..=STEPS).enumerate() {
            let Some(here) = scan[index] else { continue };
            let beside = |other: Option<usize>| {
                other.and_then(|i| scan.get(i).copied().flatten()).is_none_or(|value| value >= here)
            };
            if beside(index.checked_sub(1)) && beside(index.checked_add(1)) {
                let point = self.valley(stroke_mm, depth_mm, angle(step - 1), angle(step + 1))?;
                if best.is_none_or(|best| point.center_distance_mm < best.center_distance_mm) {
                    best = Some(point);
                }
            }
        }
        match (best, failure) {
            (Some(point), _) => Ok(point),
            (None, Some(error)) => Err(error),
            (None, None) => self.at_roll(stroke_mm, 0.0, depth_mm),
        }
    }

    fn valley(&mut self, stroke_mm: f64, depth_mm: f64, from: f64, to: f64) -> Result<MeshPoint, MeshError> {
        const RATIO: f64 = 0.618_033_988_749_894_9;
        let (mut a, mut b) = (from, to);
        let mut x = b - RATIO * (b - a);
        let mut y = a + RATIO * (b - a);
        let mut at_x = self.at_roll(stroke_mm, x, depth_mm)?;
        let mut at_y = self.at_roll(stroke_mm, y, depth_mm)?;
        for _ in 0..SECTIONS {
            if at_x.center_distance_mm <= at_y.center_distance_mm {
                b = y;
                (y, at_y) = (x, at_x);
                x = b - RATIO * (b - a);
                at_x = self.at_roll(stroke_mm, x, depth_mm)?;
            } else {
                a = x;
                (x, at_x) = (y, at_y);
                y = a + RATIO * (b - a);
                at_y = self.at_roll(stroke_mm, y, depth_mm)?;
            }
        }
        let flat = self.at_roll(stroke_mm, 0.0, depth_mm)?;
        let best = if at_x.center_distance_mm <= at_y.center_distance_mm { at_x } else { at_y };
        // an unrolled rack has full lines of contact, which a search from outside never quite meets
        Ok(if flat.center_distance_mm <= best.center_distance_mm { flat } else { best })
    }

    /// The solution at one roll. The rack's end faces are then inclined and cut the flanks at a place that depends on
    /// the centre distance; the dependence is weak, so substitution converges in a few rounds.
    fn at_roll(&mut self, stroke_mm: f64, angle: f64, depth_mm: f64) -> Result<MeshPoint, MeshError> {
        self.set_roll(Roll::new(angle, depth_mm));
        let mut point = self.solve(stroke_mm)?;
        for _ in 0..20 {
            let moved = (point.center_distance_mm - self.assumed).abs();
            self.assumed = point.center_distance_mm;
            if moved * angle.abs() <= 1e-14 * self.assumed.abs() {
                break;
            }
            point = self.solve(stroke_mm)?;
        }
        Ok(point)
    }
}
