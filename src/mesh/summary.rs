#![doc = include_str!("summary.md")]
//!
//! Called by reports; computes from solved points only.

use super::{Curve, Mesh, MeshPoint};

/// A curve in a few numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// Mean of ΔCD over the stroke, mm.
    pub mean_mm: f64,
    /// Smallest ΔCD, mm.
    pub min_mm: f64,
    /// Stroke at which it is first reached, mm.
    pub min_stroke_mm: f64,
    /// Largest ΔCD, mm.
    pub max_mm: f64,
    /// Stroke at which it is first reached, mm.
    pub max_stroke_mm: f64,
    /// Largest − smallest ΔCD, mm: the pair's own variation. With a master for one part, over at least one turn of the
    /// pinion, this is the total radial composite deviation F_i'' of the other.
    pub peak_to_peak_mm: f64,
    /// Largest peak-to-peak of ΔCD within any stroke of one pitch, mm: the pair's own variation from tooth to tooth.
    pub tooth_to_tooth_mm: f64,
    /// Largest |dΔCD/ds| between neighbouring points.
    pub largest_rate: f64,
    /// Peak-to-peak of the transmission error, rad of the pinion.
    pub transmission_error_rad: f64,
    /// Peak-to-peak of the transmission error as travel of the rack, mm.
    pub transmission_error_mm: f64,
}

/// Extremes nearer to each other than this, mm, are the same: far above the rounding of a solution (1e-14) and
/// far below its accuracy (1e-9).
const TIE_MM: f64 = 1e-11;

impl Curve {
    /// The points with the smallest and the largest ΔCD; of values that differ by rounding only, the first
    /// stroke counts. `None` without points.
    #[must_use]
    pub fn extremes(&self) -> Option<[&MeshPoint; 2]> {
        let first = self.points.first()?;
        let values = || self.points.iter().map(|point| point.delta_cd_mm);
        let at =
            |value: f64| self.points.iter().find(|point| (point.delta_cd_mm - value).abs() <= TIE_MM).unwrap_or(first);
        Some([at(values().fold(f64::INFINITY, f64::min)), at(values().fold(f64::NEG_INFINITY, f64::max))])
    }

    /// Summarises the curve; `None` if it has no points.
    #[must_use]
    pub fn summary(&self, mesh: &Mesh) -> Option<Summary> {
        let first = self.points.first()?;
        let pitch = mesh.pair().rack().pitch_mm;
        let (mut te_low, mut te_high) = (first.transmission_error_rad, first.transmission_error_rad);
        let [low, high] = self.extremes()?;
        let (mut min_mm, mut max_mm) = (first.delta_cd_mm, first.delta_cd_mm);
        let mut area = 0.0;
        let mut largest_rate: f64 = 0.0;
        for point in &self.points {
            min_mm = min_mm.min(point.delta_cd_mm);
            max_mm = max_mm.max(point.delta_cd_mm);
            te_low = te_low.min(point.transmission_error_rad);
            te_high = te_high.max(point.transmission_error_rad);
        }
        for ends in self.points.windows(2) {
            let width = ends[1].stroke_mm - ends[0].stroke_mm;
            // from the first value, so that a constant curve has exactly its value as mean
            area +=
                width * 0.5 * ((ends[0].delta_cd_mm - first.delta_cd_mm) + (ends[1].delta_cd_mm - first.delta_cd_mm));
            // between closer points rounding hides the slope of the curve
            if width > 1e-5 * pitch {
                largest_rate = largest_rate.max(((ends[1].delta_cd_mm - ends[0].delta_cd_mm) / width).abs());
            }
        }
        let range = self.points.last().map_or(0.0, |last| last.stroke_mm - first.stroke_mm);
        let transmission_error_rad = te_high - te_low;
        Some(Summary {
            mean_mm: first.delta_cd_mm + if range > 0.0 { area / range } else { 0.0 },
            min_mm,
            min_stroke_mm: low.stroke_mm,
            max_mm,
            max_stroke_mm: high.stroke_mm,
            peak_to_peak_mm: max_mm - min_mm,
            tooth_to_tooth_mm: largest_swing(self.points.iter().map(|at| (at.stroke_mm, at.delta_cd_mm)), pitch),
            largest_rate,
            transmission_error_rad,
            transmission_error_mm: transmission_error_rad / mesh.pair().rotation_per_stroke_rad(),
        })
    }
}

/// Largest difference of two values whose places are at most a window apart, by two monotone queues; the places rise.
pub(crate) fn largest_swing(values: impl Iterator<Item = (f64, f64)>, window: f64) -> f64 {
    let mut swing: f64 = 0.0;
    let (mut lows, mut highs) = (std::collections::VecDeque::new(), std::collections::VecDeque::new());
    for (at, value) in values {
        while highs.back().is_some_and(|&(_, v)| v <= value) {
            highs.pop_back();
        }
        while lows.back().is_some_and(|&(_, v)| v >= value) {
            lows.pop_back();
        }
        highs.push_back((at, value));
        lows.push_back((at, value));
        for queue in [&mut lows, &mut highs] {
            while queue.front().is_some_and(|&(s, _)| s < at - window) {
                queue.pop_front();
            }
        }
        if let (Some(&(_, low)), Some(&(_, high))) = (lows.front(), highs.front()) {
            swing = swing.max(high - low);
        }
    }
    swing
}
