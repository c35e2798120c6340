//! Where a search begins: the stroke shifts at which a few errors, at a rough look, explain most.

use super::search::{FIRST_LOOK, Points, Search, Watch};
use super::sight::{Effects, Sight};
use super::tooth_error::ToothError;
use super::{Chords, TraceError};
use crate::parallel;

/// The stroke shifts that are looked at, both ends of ± half a pitch included. A search finds the shift from a step away.
pub(super) const SHIFTS: usize = 2 * FIRST_LOOK as usize + 1;

/// Curve and effects at even strokes, straight between them, so that they are solved once for all shifts.
struct Even {
    first_mm: f64,
    spacing_mm: f64,
    curve_mm: Vec<f64>,
    effects: Vec<(ToothError, Effects)>,
}

impl Even {
    /// A curve that is known at the even strokes, at other ones.
    fn at(&self, curve: &[f64], strokes_mm: &[f64]) -> Vec<f64> {
        let between = |stroke: &f64| {
            let place = ((stroke - self.first_mm) / self.spacing_mm).max(0.0);
            let behind = (place.floor() as usize).min(curve.len().saturating_sub(2));
            let [a, b] = [behind, behind + 1].map(|at| curve.get(at).copied().unwrap_or_default());
            a + (place - behind as f64) * (b - a)
        };
        strokes_mm.iter().map(between).collect()
    }
}

impl Search<'_> {
    /// Half a pitch, the range of the stroke shift, mm.
    pub(super) fn half_mm(&self) -> f64 {
        0.5 * self.mesh.pair().rack().pitch_mm
    }

    fn step_mm(&self) -> f64 {
        2.0 * self.half_mm() / (SHIFTS - 1) as f64
    }

    /// Whether two answers have as many errors, at stroke shifts that differ.
    pub(super) fn is_elsewhere(&self, other: &Self) -> bool {
        self.errors.len() == other.errors.len() && (self.shift_mm - other.shift_mm).abs() > self.step_mm()
    }

    /// The stroke shifts at which the search begins, the best first: those at which a few errors explain more than at the shifts
    /// beside, and nearly as much as anywhere. If none explains anything, the shift that is fitted without errors.
    pub(super) fn starts(&self, watch: &mut Watch<'_>) -> Result<Vec<f64>, TraceError> {
        /// The most shifts, and the share of what the best explains that another must.
        const MOST: usize = 4;
        const LEAST: f64 = 0.7;
        if !self.fits {
            return Ok(vec![self.shift_mm]);
        }
        let even = self.even(watch)?;
        let shift_mm = |at: usize| at as f64 * self.step_mm() - self.half_mm();
        let look = |(): &mut (), at: usize| self.rough_look(&even, shift_mm(at));
        let looked = parallel::map(parallel::cores(), SHIFTS, || (), look).0;
        let alone = looked.iter().map(|(alone, _)| *alone).fold(f64::INFINITY, f64::min);
        let best = looked.iter().map(|(_, cost)| *cost).fold(f64::INFINITY, f64::min);
        let cost = |at: Option<usize>| at.and_then(|at| looked.get(at)).map_or(f64::INFINITY, |(_, cost)| *cost);
        let is_lowest = |at: &usize| cost(Some(*at)) <= cost(at.checked_sub(1)).min(cost(Some(at + 1)));
        let explains = |at: &usize| best < alone && alone - cost(Some(*at)) >= LEAST * (alone - best);
        let mut lowest: Vec<usize> = (0..SHIFTS).filter(is_lowest).filter(explains).collect();
        lowest.sort_by(|a, b| cost(Some(*a)).total_cmp(&cost(Some(*b))));
        let near_fitted =
            |shift: f64| if (shift - self.shift_mm).abs() <= self.step_mm() { self.shift_mm } else { shift };
        let mut starts: Vec<f64> = lowest.into_iter().take(MOST).map(|at| near_fitted(shift_mm(at))).collect();
        starts.dedup();
        Ok(if starts.is_empty() { vec![self.shift_mm] } else { starts })
    }

    /// The curve and the effects of all errors over the strokes of all shifts.
    fn even(&self, watch: &mut Watch<'_>) -> Result<Even, TraceError> {
        let half_mm = self.half_mm();
        let spacing_mm = 2.0 * half_mm / f64::from(FIRST_LOOK);
        let [from, to] = [self.means.first(), self.means.last()].map(|end| end.map_or(0.0, |end| end.0));
        let count = ((to - from + 2.0 * half_mm) / spacing_mm).ceil() as usize;
        let measured = Chords(self.means.iter().map(|(stroke, mm, _)| (*stroke, *mm)).collect());
        let strokes = (0..=count).map(|at| from - half_mm + at as f64 * spacing_mm);
        let points: Points = strokes.map(|stroke| (stroke, measured.at(stroke.clamp(from, to)).0, 1.0)).collect();
        let candidates = self.within_reach([-half_mm, half_mm]);
        let wide = Self { shift_mm: 0.0, candidates, errors: Vec::new(), ..self.clone() };
        let sight = wide.sight(&[], &points, false)?;
        let effects = wide.screened(&[], &sight, |_| true, watch)?;
        Ok(Even { first_mm: from - half_mm, spacing_mm, curve_mm: sight.model_mm, effects })
    }

    /// χ² at a stroke shift without errors, and with a few that explain most, the threshold for each of them added. Their effects
    /// add up.
    fn rough_look(&self, even: &Even, shift_mm: f64) -> (f64, f64) {
        const MOST: usize = 4;
        let strokes: Vec<f64> = self.means.iter().map(|(stroke, ..)| stroke - shift_mm).collect();
        let measured: Vec<f64> = self.means.iter().map(|(_, mm, _)| *mm).collect();
        let weights: Vec<f64> = self.means.iter().map(|(.., count)| count / (self.noise_mm * self.noise_mm)).collect();
        let effects: Vec<_> =
            even.effects.iter().map(|(_, effects)| effects.moved(|curve| even.at(curve, &strokes))).collect();
        let offset = [vec![1.0; strokes.len()]];
        let sight = |model: Vec<f64>| Sight::new((strokes.clone(), model), &measured, weights.clone(), &offset);
        let mut looked = sight(even.at(&even.curve_mm, &strokes));
        let (alone, mut found) = (looked.chi_square(), 0);
        while found < MOST {
            let each = effects.iter().map(|effects| (effects, effects.best(&looked)));
            let best = each.max_by(|a, b| a.1.gain.total_cmp(&b.1.gain));
            let Some((effects, best)) = best.filter(|(_, best)| best.gain > self.threshold) else { break };
            let effect = effects.of(best.size_mm);
            looked = sight(looked.model_mm.iter().zip(effect).map(|(model, effect)| model + effect).collect());
            found += 1;
        }
        (alone, looked.chi_square() + self.threshold * found as f64)
    }
}
