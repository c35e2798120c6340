//! The lowest roll by brute force, from values alone: no derivative, no tangent, no curvature. Slow.

use super::*;

/// Rolls of the first grid, and parts that an interval is divided into.
const FIRST: usize = 300;
const PARTS: usize = 8;
/// Down to this width intervals are divided wherever a lower roll may hide.
const NARROW: f64 = 1e-5;
/// A value may fall so many times as steeply as the steepest two neighbours of the first grid tell.
const STEEPER: f64 = 1.5;
/// The golden section ends at this width.
const WIDTH: f64 = 1e-12;

/// What each roll asks for: nothing where no rotation balances both sides.
struct Values<'a> {
    sampler: Sampler<'a>,
    stroke: f64,
    depth: f64,
}

impl Values<'_> {
    fn at(&mut self, angle: f64) -> f64 {
        let solved = self.sampler.at_roll(self.stroke, angle, self.depth);
        solved.ok().filter(Rolled::is_balanced).map_or(f64::INFINITY, |rolled| rolled.value)
    }

    /// The lowest of a valley between two rolls.
    fn bottom(&mut self, mut low: f64, mut high: f64) -> (f64, f64) {
        const GOLDEN: f64 = 0.381_966_011_250_105_1;
        let mut left = low + GOLDEN * (high - low);
        let mut right = high - GOLDEN * (high - low);
        let (mut on_left, mut on_right) = (self.at(left), self.at(right));
        while high - low > WIDTH {
            if on_left < on_right {
                (high, right, on_right) = (right, left, on_left);
                left = low + GOLDEN * (high - low);
                on_left = self.at(left);
            } else {
                (low, left, on_left) = (left, right, on_right);
                right = high - GOLDEN * (high - low);
                on_right = self.at(right);
            }
        }
        if on_left < on_right { (on_left, left) } else { (on_right, right) }
    }
}

/// The lowest centre distance of all rolls, and the roll; `None` if none balances.
pub(super) fn lowest(mesh: &Mesh, stroke: f64) -> Option<(f64, f64)> {
    let Support::FreeRoll { axis_depth_mm: depth } = mesh.support() else { unreachable!("it rolls") };
    let mut values = Values { sampler: Sampler::new(mesh), stroke, depth };
    let between = |low: f64, high: f64, parts: usize| {
        (0..=parts).map(move |part| low + (high - low) * part as f64 / parts as f64)
    };
    let grid: Vec<(f64, f64)> =
        between(-LARGEST_ROLL_RAD, LARGEST_ROLL_RAD, FIRST).map(|angle| (values.at(angle), angle)).collect();
    let steepness = |ends: &[(f64, f64)]| ((ends[1].0 - ends[0].0) / (ends[1].1 - ends[0].1)).abs();
    let steepest = STEEPER * grid.windows(2).map(steepness).filter(|slope| slope.is_finite()).fold(0.0, f64::max);
    let mut best = grid.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0)).filter(|best| best.0.is_finite())?;
    let mut rows = vec![grid];
    let mut width = 2.0 * LARGEST_ROLL_RAD / FIRST as f64;
    while width > NARROW {
        let may_hide = |ends: &[(f64, f64)], best: f64| ends[0].0.min(ends[1].0) - steepest * width <= best;
        let mut finer: Vec<Vec<(f64, f64)>> = Vec::new();
        for ends in rows.iter().flat_map(|row| row.windows(2)) {
            if !may_hide(ends, best.0) {
                continue;
            }
            let inner: Vec<_> = between(ends[0].1, ends[1].1, PARTS).map(|angle| (values.at(angle), angle)).collect();
            best = inner.iter().copied().fold(best, |a, b| if b.0 < a.0 { b } else { a });
            match finer.last_mut().filter(|row| row.last().is_some_and(|last| last.1 == inner[0].1)) {
                Some(row) => row.extend(&inner[1..]),
                None => finer.push(inner),
            }
        }
        rows = finer;
        width /= PARTS as f64;
    }
    for row in &rows {
        for (index, &(value, _)) in row.iter().enumerate() {
            let beside = [index.saturating_sub(1), (index + 1).min(row.len() - 1)].map(|beside| row[beside]);
            if value <= beside[0].0 && value <= beside[1].0 && value - steepest * width <= best.0 {
                let bottom = values.bottom(beside[0].1, beside[1].1);
                best = if bottom.0 < best.0 { bottom } else { best };
            }
        }
    }
    let level = values.at(0.0);
    Some(if level < best.0 { (level, 0.0) } else { best })
}
