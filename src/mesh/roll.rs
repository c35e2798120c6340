//! The rack that may roll: the smallest centre distance over its roll. Called by the sampler for
//! [`Support::FreeRoll`](super::Support::FreeRoll); the fixed support never comes here.
//!
//! The centre distance over the roll is smooth but for kinks where another flank pair, or the other end of the
//! same one, takes over; its derivative is known ([`FlankContact::roll_rate`](super::contact)). With a lead error it has two
//! valleys, mirror images or nearly so, and their bottoms mostly are kinks: one flank then lies flat on the pinion's.
//!
//! At strokes on a fixed grid the whole range of rolls is scanned for changes of the derivative's sign, so that which
//! valleys are known at a stroke does not depend on the strokes solved before. In between each valley's bottom
//! is followed: a step past it, then the intersection of both tangents, which meets a kink quadratically, or the secant
//! of the derivative where both ends have the same contacts.

use super::prepare::Roll;
use super::solve::Rolling;
use super::{Ending, MeshError, MeshPoint, Sampler};

/// Rolls considered, rad: enough to level a flank with a lead error of 1° at a pressure angle of 14°.
const LARGEST: f64 = 0.075;
/// Steps of the scan; an odd number, so that none lands on 0, where full lines of contact make a kink.
const STEPS: i32 = 31;
/// Scans per pitch.
const SCANS_PER_PITCH: f64 = 16.0;
/// Evaluations of one valley; a bisection of the whole range to rounding takes 50.
const MAX_EVALUATIONS: u32 = 80;
/// First step off a valley that was followed.
const FIRST_STEP: f64 = 8e-8;
/// Bottoms known to this much (mm) are known well enough; rounding of a position leaves up to 1e-12.
const LEVEL: f64 = 3e-12;
/// Valleys as deep within this (mm): the first one is taken, so that the roll does not flicker.
const TIE: f64 = 1e-11;
/// Bottoms this near to an unrolled rack may be it.
const FLAT: f64 = 1e-8;
/// Bottoms of neighbouring scans this near are the same valley.
const SAME: f64 = 2e-3;
/// Brackets this short let the tangents at both ends speak for the two sides of a kink: its square times any
/// curvature is below [`LEVEL`].
const SHORT: f64 = 2e-7;

/// The valleys at the two scanned strokes around the last stroke.
#[derive(Debug, Clone, Default)]
pub(super) struct Valleys {
    scans: [Option<Scan>; 2],
    /// Rack teeth that carried at the last stroke: of teeth that ask for the same they come first.
    carried: [i64; 2],
}

#[derive(Debug, Clone)]
struct Scan {
    index: i64,
    /// Roll of every bottom, rising.
    bottoms: Vec<f64>,
}

/// The solution at one roll.
#[derive(Debug, Clone, Copy)]
struct Rolled {
    angle: f64,
    value: f64,
    slope: f64,
    point: MeshPoint,
    rolling: Rolling,
}

impl Sampler<'_> {
    pub(super) fn solve_rolling(&mut self, stroke_mm: f64, depth_mm: f64) -> Result<MeshPoint, MeshError> {
        let step = self.mesh.pair().rack().pitch_mm / SCANS_PER_PITCH;
        let place = stroke_mm / step;
        let mut starts = Vec::new();
        if place.abs() < 1e15 {
            #[allow(clippy::cast_possible_truncation)] // within 1e15
            let index = place.floor() as i64;
            let (before, after) = (self.scanned(index, step, depth_mm), self.scanned(index + 1, step, depth_mm));
            starts = merged(&before, &after, place - place.floor());
        }
        if starts.is_empty() {
            starts = self.scan(stroke_mm, depth_mm)?;
        }
        let mut best: Option<Rolled> = None;
        for &start in &starts {
            let at = self.at_roll(stroke_mm, start, depth_mm)?;
            let bottom = self.follow(at, stroke_mm, depth_mm)?;
            if best.is_none_or(|best| bottom.value < best.value - TIE) {
                best = Some(bottom);
            }
        }
        if best.is_none_or(|best| best.angle.abs() < FLAT) {
            // an unrolled rack has full lines of contact, which a search from outside never quite meets
            let flat = self.at_roll(stroke_mm, 0.0, depth_mm)?;
            if best.is_none_or(|best| flat.value <= best.value + TIE) {
                best = Some(flat);
            }
        }
        let point = best.map_or_else(|| self.solve(stroke_mm), |best| Ok(best.point))?;
        self.valleys.carried = [point.right.rack_tooth, point.left.rack_tooth];
        Ok(point)
    }

    /// The bottoms at a stroke of the grid; none where there is no mesh.
    fn scanned(&mut self, index: i64, step: f64, depth_mm: f64) -> Vec<f64> {
        if let Some(scan) = self.valleys.scans.iter().flatten().find(|scan| scan.index == index) {
            return scan.bottoms.clone();
        }
        #[allow(clippy::cast_precision_loss)] // within 1e15
        let bottoms = self.scan(index as f64 * step, depth_mm).unwrap_or_default();
        #[allow(clippy::cast_sign_loss, clippy::cast_possible_truncation)] // 0 or 1
        let slot = index.rem_euclid(2) as usize;
        self.valleys.scans[slot] = Some(Scan { index, bottoms: bottoms.clone() });
        bottoms
    }

    /// The bottoms of all valleys at a stroke.
    fn scan(&mut self, stroke_mm: f64, depth_mm: f64) -> Result<Vec<f64>, MeshError> {
        let mut bottoms = Vec::new();
        let mut failure = None;
        let mut before: Option<Rolled> = None;
        for step in 0..=STEPS {
            let angle = LARGEST * f64::from(2 * step - STEPS) / f64::from(STEPS);
            let here = match self.at_roll(stroke_mm, angle, depth_mm) {
                Ok(here) => Some(here),
                Err(error) => {
                    failure = Some(error);
                    None
                }
            };
            if let Some(here) = here {
                match before {
                    Some(before) if before.slope < 0.0 && here.slope >= 0.0 => {
                        bottoms.push(self.narrow(before, here, stroke_mm, depth_mm)?.angle);
                    }
                    // no mesh beyond, or the end of the range
                    None if here.slope >= 0.0 => bottoms.push(here.angle),
                    _ => {}
                }
            }
            if let Some(before) = before
                && before.slope < 0.0
                && here.is_none()
            {
                bottoms.push(before.angle);
            }
            before = here;
        }
        if let Some(last) = before
            && last.slope < 0.0
        {
            bottoms.push(last.angle);
        }
        match failure {
            Some(error) if bottoms.is_empty() => Err(error),
            _ => Ok(bottoms),
        }
    }

    /// The bottom of the valley on whose slope `from` is.
    fn follow(&mut self, from: Rolled, stroke_mm: f64, depth_mm: f64) -> Result<Rolled, MeshError> {
        if from.slope == 0.0 {
            return Ok(from);
        }
        let down = -from.slope.signum();
        let (mut at, mut step) = (from, FIRST_STEP);
        loop {
            let angle = (at.angle + down * step).clamp(-LARGEST, LARGEST);
            if angle == at.angle {
                return Ok(at);
            }
            let next = match self.at_roll(stroke_mm, angle, depth_mm) {
                Ok(next) => next,
                // no mesh there: creep up to where it ends
                Err(_) if step > FIRST_STEP => {
                    step *= 0.125;
                    if step < FIRST_STEP {
                        return Ok(at);
                    }
                    continue;
                }
                Err(_) => return Ok(at),
            };
            if next.slope * down >= 0.0 {
                let (low, high) = if down > 0.0 { (at, next) } else { (next, at) };
                return self.narrow(low, high, stroke_mm, depth_mm);
            }
            at = next;
            step *= 8.0;
        }
    }

    /// The bottom between a falling and a rising end.
    fn narrow(
        &mut self,
        mut low: Rolled,
        mut high: Rolled,
        stroke_mm: f64,
        depth_mm: f64,
    ) -> Result<Rolled, MeshError> {
        let mut best = if low.value <= high.value { low } else { high };
        let mut run = 0_i32;
        let mut stalls = 0;
        for _ in 0..MAX_EVALUATIONS {
            let width = high.angle - low.angle;
            let meet = low.angle + ((high.value - low.value) - high.slope * width) / (low.slope - high.slope);
            let bound = low.value + low.slope * (meet - low.angle);
            let same = low.rolling.at == high.rolling.at;
            let near = if same { SAME } else { SHORT };
            if (width <= near && (best.value - bound).abs() <= LEVEL) || width <= 1e-12 {
                break;
            }
            let mut angle = if same {
                low.angle - width * low.slope / (high.slope - low.slope)
            } else {
                // from one side: step over the kink, so that the other side comes close too
                match run {
                    1.. => (1.5 * meet - 0.5 * low.angle).max(meet + 0.4 * SHORT),
                    ..=-1 => (1.5 * meet - 0.5 * high.angle).min(meet - 0.4 * SHORT),
                    _ => meet,
                }
            };
            if stalls >= 2 || !(angle > low.angle && angle < high.angle) {
                stalls = 0;
                angle = low.angle + 0.5 * width;
            }
            if angle <= low.angle || angle >= high.angle {
                break;
            }
            let here = self.at_roll(stroke_mm, angle, depth_mm)?;
            if here.value < best.value {
                best = here;
            }
            if here.slope < 0.0 {
                low = here;
                run = run.max(0) + 1;
            } else if here.slope > 0.0 {
                high = here;
                run = run.min(0) - 1;
            } else {
                return Ok(here);
            }
            stalls = if high.angle - low.angle > 0.5 * width { stalls + 1 } else { 0 };
        }
        // at a kink either side's contacts could be named; always those of the lower roll, so that names do not flicker
        let below = if low.rolling.at == high.rolling.at { best } else { low };
        best.point.right = below.point.right;
        best.point.left = below.point.left;
        Ok(best)
    }

    /// The solution at one roll. The rack's end faces are then inclined and cut the flanks at a place that depends on
    /// the centre distance; the dependence is weak and its derivative known, so one or two rounds of Newton's method do.
    fn at_roll(&mut self, stroke_mm: f64, angle: f64, depth_mm: f64) -> Result<Rolled, MeshError> {
        self.set_roll(Roll::new(angle, depth_mm));
        self.carried = self.valleys.carried;
        let mut point = self.solve(stroke_mm)?;
        let nominal = self.mesh.pair().nominal_center_distance_mm();
        let mut settled = false;
        for _ in 0..20 {
            let moved = point.center_distance_mm - self.assumed;
            let feedback = self.rolling.rate[1];
            let feedback = if feedback.abs() < 0.5 { feedback } else { 0.0 };
            let newton = self.assumed + moved / (1.0 - feedback);
            if (moved * angle).abs() <= 1e-9 {
                point.center_distance_mm = newton;
                point.delta_cd_mm = newton - nominal;
                settled = true;
            }
            self.assumed = newton;
            if settled {
                break;
            }
            point = self.solve(stroke_mm)?;
        }
        if !settled {
            point.ending = Ending::IterationLimit;
        }
        let rolling = self.rolling;
        let slope = rolling.rate[0] / (1.0 - if rolling.rate[1].abs() < 0.5 { rolling.rate[1] } else { 0.0 });
        Ok(Rolled { angle, value: point.center_distance_mm, slope, point, rolling })
    }
}

/// Where to look for bottoms between two scans: what both know lies between, what one knows stays.
fn merged(before: &[f64], after: &[f64], share: f64) -> Vec<f64> {
    let mut starts = Vec::new();
    let mut rest = after.to_vec();
    for &roll in before {
        let near = rest.iter().position(|&other| (other - roll).abs() <= SAME);
        starts.push(near.map_or(roll, |near| roll + (rest.remove(near) - roll) * share));
    }
    starts.extend(rest);
    starts.sort_unstable_by(f64::total_cmp);
    starts
}
